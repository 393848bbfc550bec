/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* A fluid on a mesh that follows an outline: its life, and going over to another mesh. */
#include <math.h>
#include <string.h>

#include "flow/internal.h"
#include "responsive/internal.h"

static void flow_destroy(void *object) {
  bw_flow *flow = object;
  struct bwi_flow *in = flow->inner;
  if (in) {
    bw_free(in->condition);
    bw_release(in->now);
    bw_plane_locator_destroy(in->locator);
    bw_lagged_factor_destroy(in->lagged);
    bwi_flow_workspace_clear(&in->workspace);
    bw_free(in);
  }
  bw_free(flow);
}

static size_t flow_bytes(const void *object) {
  const bw_flow *flow = object;
  size_t square = (size_t)(flow->components * flow->components);
  size_t nodes = (size_t)flow->mesh->topology->nodes->node_count;
  size_t elements = (size_t)flow->mesh->topology->element_count;
  return sizeof *flow +
         (2 * square * (size_t)flow->inner->now->pattern->block_count +
          8 * nodes * (size_t)flow->components +
          bwi_plane_workspace_size(flow->inner->now->pattern, flow->components) + 12 * elements) *
             sizeof(double);
}

static const bw_kind flow_kind = {"flow", flow_destroy, flow_bytes};

static bw_status check_description(bw_context *context, const bw_flow_description *d) {
  if (!(d->density > 0) || !(d->viscosity > 0))
    return bw_fail(context, BW_INVALID,
                   "a fluid needs a density and a viscosity above 0, not %g kg/m3 and %g Pa s",
                   d->density, d->viscosity);
  if (!(d->diffusivity >= 0) || !isfinite(d->expansion) || !isfinite(d->reference) ||
      !isfinite(d->gravity[0]) || !isfinite(d->gravity[1]))
    return bw_fail(context, BW_INVALID,
                   "a diffusivity of at least 0 and finite expansion, reference and gravity are "
                   "needed, not %g, %g, %g, (%g, %g)",
                   d->diffusivity, d->expansion, d->reference, d->gravity[0], d->gravity[1]);
  int components = d->diffusivity > 0 ? 4 : 3;
  for (int i = 0; i < d->condition_count; i++) {
    const bw_condition *c = &d->condition[i];
    if (c->kind != BW_PRESSURE && (c->component < 0 || c->component >= components))
      return bw_fail(context, BW_INVALID,
                     c->component == 3 ? "a condition of heat is given, but the fluid has no "
                                         "diffusivity: give one, in m2/s"
                                       : "condition %d is on component %d of a fluid with %d",
                     i + 1, c->component + 1, components);
    if (c->kind == BW_CONVECTION &&
        (c->component != 3 || !(c->coefficient >= 0) || !isfinite(c->coefficient)))
      return bw_fail(
          context, BW_INVALID,
          "condition %d is convection: it must be on component 4, the temperature, not %d, "
          "with a coefficient of at least 0 m/s, not %g",
          i + 1, c->component + 1, c->coefficient);
  }
  return BW_OK;
}

static bw_status check_mesh(bw_context *context, const bw_plane_mesh *mesh) {
  if (mesh->topology->nodes->order != 1)
    return bw_fail(context, BW_INVALID,
                   "a flow needs three-node triangles: fill the outline with order 1");
  return BW_OK;
}

bw_status bw_flow_create(bw_context *context, const bw_plane_mesh *mesh,
                         const bw_flow_description *description, bw_flow **result) {
  bw_status status = BW_OK;
  bw_flow *flow = NULL;
  struct bwi_flow *in = NULL;
  bw_plane_pattern *pattern = NULL;
  bw_flow_state *first = NULL;
  BW_TRY(check_description(context, description));
  BW_TRY(check_mesh(context, mesh));
  flow = BW_NEW0(context, bw_flow, 1);
  in = BW_NEW0(context, struct bwi_flow, 1);
  if (!flow || !in) {
    bw_free(flow);
    bw_free(in);
    return BW_MEMORY;
  }
  bw_object_init(flow, &flow_kind);
  flow->inner = in;
  flow->components = description->diffusivity > 0 ? 4 : 3;
  in->about = *description;
  BW_TRY(bwi_conditions_copy(context, description->condition_count, description->condition,
                             &in->condition));
  in->about.condition = in->condition;
  BW_TRY(bw_lagged_factor_create(context, false, flow->components, &in->lagged));
  BW_TRY(bw_plane_pattern_create(context, mesh->topology, &pattern));
  BW_TRY(bwi_flow_blank(context, flow, mesh, pattern, &first));
  size_t unknowns = (size_t)mesh->topology->nodes->node_count * (size_t)flow->components;
  first->state = BW_NEW0(context, double, unknowns);
  first->before = BW_NEW0(context, double, unknowns);
  first->reaction = BW_NEW0(context, double, unknowns);
  BW_TRY_MEMORY(first->state && first->before && first->reaction);
  if (flow->components == 4)
    for (size_t i = 3; i < unknowns; i += 4)
      first->state[i] = description->reference;
  bwi_flow_adopt(flow, first);
done:
  bw_release(pattern);
  bw_release(first);
  if (status == BW_OK)
    *result = flow;
  else
    bw_release(flow);
  return status;
}

/* Everything is made beside what there is, and takes its place at the end. */
bw_status bw_flow_follow(bw_context *context, bw_flow *flow, const bw_plane_mesh *mesh,
                         bw_plane_reuse *reuse) {
  bw_status status = BW_OK;
  const struct bwi_flow *in = flow->inner;
  const bw_flow_state *now = in->now;
  const bw_plane_topology *before = flow->mesh->topology, *after = mesh->topology;
  bool same_topology = after == before, same_nodes = after->nodes == before->nodes;
  const bw_plane_pattern *pattern = NULL;
  bw_flow_state *next = NULL;
  bw_condition *conditions = NULL;
  int c = flow->components;
  size_t nodes = (size_t)after->nodes->node_count;
  double started = bw_seconds();
  BW_TRY(check_mesh(context, mesh));
  if (same_topology) {
    pattern = bw_retain(now->pattern);
  } else {
    bw_plane_pattern *made = NULL;
    BW_TRY(bw_plane_pattern_create(context, after, &made));
    pattern = made;
  }
  BW_TRY(bwi_flow_blank(context, flow, mesh, pattern, &next));
  next->state = BW_NEW(context, double, nodes *(size_t)c);
  next->before = BW_NEW(context, double, nodes *(size_t)c);
  next->reaction = BW_NEW0(context, double, nodes *(size_t)c);
  if (same_nodes)
    next->old_point = BW_NEW(context, double, 2 * nodes);
  if (same_nodes && now->older_point)
    next->older_point = BW_NEW(context, double, 2 * nodes);
  BW_TRY_MEMORY(next->state && next->before && next->reaction && (!same_nodes || next->old_point) &&
                (!same_nodes || !now->older_point || next->older_point));
  if (!same_nodes) { /* it may be quite another outline, with the same tags in another order */
    BW_TRY(bwi_conditions_renamed(context, flow->mesh->outline, mesh->outline,
                                  in->about.condition_count, in->condition, &conditions));
    for (int i = 0; i < next->condition_count; i++)
      next->condition[i] = conditions[i];
  }
  BW_TRY(bw_plane_transfer(context, flow->mesh, mesh, c, flow->state, next->state));
  BW_TRY(bw_plane_transfer(context, flow->mesh, mesh, c, flow->before, next->before));
  next->last_step = now->last_step;
  /* Interpolated fields are not free of divergence: known stays 1, damp by implicit Euler. */
  if (same_nodes) {
    next->known = now->known;
    /* Several moves between two steps: the mesh velocity is of all of them. */
    memcpy(next->old_point, now->old_point ? now->old_point : flow->mesh->point,
           2 * nodes * sizeof(double));
    if (now->older_point)
      memcpy(next->older_point, now->older_point, 2 * nodes * sizeof(double));
  }
  BW_TRY(bwi_flow_commit(context, flow, next));
  if (reuse) {
    reuse->pattern = same_topology;
    reuse->solution = true;
    reuse->seconds_assemble += bw_seconds() - started;
  }
done:
  bw_release(pattern);
  bw_release(next);
  bw_free(conditions);
  return status;
}
