/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* A system that follows edits: made, and brought to another shape. */
#include <string.h>

#include "solve/local.h"

/* ---- the view ------------------------------------------------------------------------------ */

/* What the local system shows as a bw_system: it keeps the stiffness alive that it points into. */
typedef struct view {
  bw_system system;
  const bw_domain_stiffness *stiffness;
} view;

static void view_destroy(void *object) {
  view *v = object;
  bw_release(v->system.mesh);
  bw_release(v->system.material);
  bw_release(v->system.numbering);
  bw_release(v->system.graph);
  bw_release(v->system.factor);
  bw_release(v->stiffness);
  bw_free(v->system.mass);
  bw_free(v);
}

static const bw_kind view_kind = {"system", view_destroy, NULL};

/* Takes the stiffness over. */
static void view_stiffness(bw_local_system *local, bw_domain_stiffness *stiffness) {
  view *v = (view *)local->system;
  bw_retain(stiffness);
  bw_release(v->stiffness);
  v->stiffness = stiffness;
  v->system.stiffness = stiffness->values;
  bw_release(local->stiffness);
  local->stiffness = stiffness;
}

/* ---- life ---------------------------------------------------------------------------------- */

static void inner_free(bwi_local *inner) {
  if (!inner)
    return;
  bw_release(inner->rest);
  bw_release(inner->model);
  bw_free(inner->element_domain);
  bw_free(inner->node_domain);
  bw_free(inner->motion);
  bw_free(inner->frame);
  bw_free(inner->framed);
  bw_free(inner->touched);
  bw_free(inner->factored_frame);
  bw_release(inner->factored);
  bw_release(inner->reach);
  bw_release(inner->factor);
  bw_free(inner);
}

static void local_destroy(void *object) {
  bw_local_system *local = object;
  bw_release(local->system);
  bw_release(local->stiffness);
  inner_free(local->inner);
  bw_free(local);
}

void bw_local_system_memory(const bw_local_system *local, size_t *factor, size_t *updates) {
  size_t work = 0;
  *factor = *updates = 0;
  if (local->inner->factor) {
    const bwi_symbolic *symbolic = local->inner->factor->symbolic;
    *factor = (size_t)symbolic->panel[symbolic->order->super_count] * sizeof(double);
    bwi_factor_kept_bytes(local->inner->factor, updates, &work);
  }
}

static size_t local_bytes(const void *object) {
  const bw_local_system *local = object;
  return sizeof *local + bw_bytes(local->stiffness) + bw_bytes(local->system->graph) +
         bw_bytes(local->inner->factor);
}

static const bw_kind local_kind = {"local system", local_destroy, local_bytes};

static bw_status inner_create(bw_context *context, const bw_model *model, bool material_turns,
                              int32_t domain_count, const int32_t *element_domain,
                              const int32_t *node_domain, bwi_local **out) {
  size_t elements = (size_t)model->mesh->element_count, nodes = (size_t)model->mesh->node_count;
  size_t domains = (size_t)domain_count;
  bwi_local *inner = BW_NEW0(context, bwi_local, 1);
  if (!inner)
    return BW_MEMORY;
  inner->rest = bw_retain(model);
  inner->model = bw_retain(model);
  inner->material_turns = material_turns;
  inner->domain_count = domain_count;
  inner->element_domain = BW_NEW(context, int32_t, elements);
  inner->node_domain = BW_NEW(context, int32_t, nodes);
  inner->motion = BW_NEW0(context, bw_domain_motion, domains);
  inner->frame = BW_NEW(context, double, 9 * domains);
  inner->factored_frame = BW_NEW0(context, double, 9 * domains);
  inner->framed = BW_NEW(context, int32_t, nodes);
  inner->touched = BW_NEW0(context, uint8_t, domains);
  inner->experience = 1;
  if (!inner->element_domain || !inner->node_domain || !inner->motion || !inner->frame ||
      !inner->factored_frame || !inner->framed || !inner->touched) {
    inner_free(inner);
    return BW_MEMORY;
  }
  memcpy(inner->element_domain, element_domain, elements * sizeof *element_domain);
  memcpy(inner->node_domain, node_domain, nodes * sizeof *node_domain);
  for (size_t d = 0; d < domains; d++) {
    bw_domain_motion_rest(&inner->motion[d]);
    memcpy(inner->frame + 9 * d, inner->motion[d].frame, 9 * sizeof *inner->frame);
  }
  *out = inner;
  return BW_OK;
}

static bw_status check_domains(bw_context *context, const bw_mesh *mesh, int32_t domain_count,
                               const int32_t *element_domain, const int32_t *node_domain) {
  if (domain_count < 1)
    return bw_fail(context, BW_INVALID, "a body is cut into at least one domain, not %d",
                   domain_count);
  for (int32_t e = 0; e < mesh->element_count; e++)
    if (element_domain[e] < 0 || element_domain[e] >= domain_count)
      return bw_fail(context, BW_INVALID, "element %d is in domain %d of %d", e,
                     element_domain[e] + 1, domain_count);
  for (int32_t i = 0; i < mesh->node_count; i++)
    if (node_domain[i] < -1 || node_domain[i] >= domain_count)
      return bw_fail(context, BW_INVALID, "node %d goes with domain %d of %d", i,
                     node_domain[i] + 1, domain_count);
  return BW_OK;
}

static bw_status view_create(bw_context *context, const bw_model *model, bw_system **out) {
  view *made = BW_NEW0(context, view, 1);
  if (!made)
    return BW_MEMORY;
  bw_object_init(made, &view_kind);
  made->system.mesh = bw_retain(model->mesh);
  made->system.material = bw_retain(model->material);
  made->system.density = model->material->density > 0 ? model->material->density : 1;
  *out = &made->system;
  return BW_OK;
}

/* The domain in whose frame each node's unknowns are taken: rows of supports come first. */
static void framed_by(const bw_numbering *numbering, int32_t domain_count, int32_t *framed) {
  int32_t supports = numbering->frame_count - domain_count;
  for (int32_t i = 0; i < numbering->mesh->node_count; i++)
    framed[i] = numbering->frame_of[i] >= supports ? numbering->frame_of[i] - supports : -1;
}

bw_status bw_local_system_create(bw_context *context, const bw_model *model, bool material_turns,
                                 int32_t domain_count, const int32_t *element_domain,
                                 const int32_t *node_domain, bw_local_system **out) {
  bw_status status = BW_OK;
  bw_local_system *local = NULL;
  bw_numbering *numbering = NULL;
  bw_domain_stiffness *stiffness = NULL;
  bool same;
  BW_TRY(check_domains(context, model->mesh, domain_count, element_domain, node_domain));
  local = BW_NEW0(context, bw_local_system, 1);
  if (!local)
    return BW_MEMORY;
  bw_object_init(local, &local_kind);
  BW_TRY(view_create(context, model, &local->system));
  BW_TRY(inner_create(context, model, material_turns, domain_count, element_domain, node_domain,
                      &local->inner));
  bwi_local *inner = local->inner;
  bw_system *system = local->system;
  BW_TRY(bw_numbering_follow(context, model, NULL, domain_count, node_domain, inner->frame, &same,
                             &numbering));
  system->numbering = numbering;
  framed_by(numbering, domain_count, inner->framed);
  double start = bw_seconds();
  BW_TRY(bw_graph_create(context, model->mesh, &system->graph));
  system->times.graph = bw_seconds() - start;
  start = bw_seconds();
  BW_TRY(bw_domain_stiffness_create(context, system->graph, model->mesh, model->material,
                                    material_turns, domain_count, element_domain, inner->framed,
                                    &stiffness));
  view_stiffness(local, stiffness);
  system->times.stiffness = bw_seconds() - start;
  BW_TRY(bwi_local_factor(context, local, false, NULL));
done:
  if (status == BW_OK)
    *out = local;
  else
    bw_release(local);
  return status;
}

/* ---- following an edit --------------------------------------------------------------------- */

static bw_status check_model(bw_context *context, const bw_local_system *local,
                             const bw_model *model) {
  const bw_mesh *mesh = model->mesh, *rest = local->inner->rest->mesh;
  if (!bwi_same_topology(mesh, rest))
    return bw_fail(context, BW_INVALID,
                   "the edited model has a mesh of %d nodes and %d elements, the system one of %d "
                   "and %d: the elements must be the same",
                   mesh->node_count, mesh->element_count, rest->node_count, rest->element_count);
  if (model->material != local->inner->rest->material)
    return bw_fail(context, BW_INVALID,
                   "the edited model has another material than the system that is to follow it");
  return BW_OK;
}

/* Domains of the elements around nodes whose support has turned: entries change there although the
 * domain's own frame does not. */
static void touch_turned_supports(const bw_numbering *before, const bw_numbering *now,
                                  int32_t domain_count, const int32_t *element_domain,
                                  uint8_t *touched) {
  const bw_mesh *mesh = now->mesh;
  int32_t old_supports = before->frame_count - domain_count;
  int32_t supports = now->frame_count - domain_count;
  for (int64_t e = 0; supports + old_supports > 0 && e < mesh->element_count; e++)
    for (int a = 0; a < mesh->nodes_per_element; a++) {
      int32_t node = mesh->element[e * mesh->nodes_per_element + a];
      int32_t was = before->frame_of[node], is = now->frame_of[node];
      bool held = is >= 0 && is < supports, was_held = was >= 0 && was < old_supports;
      if (held != was_held ||
          (held && memcmp(before->frame + 9 * (size_t)was, now->frame + 9 * (size_t)is,
                          9 * sizeof *now->frame) != 0))
        touched[element_domain[e]] = 1;
    }
}

bw_status bw_local_system_update(bw_context *context, bw_local_system *local, const bw_model *model,
                                 const bw_domain_motion *motion, bw_reuse *reuse) {
  bw_status status = BW_OK;
  bwi_local *inner = local->inner;
  bw_system *system = local->system;
  size_t domains = (size_t)inner->domain_count, nodes = (size_t)inner->rest->mesh->node_count;
  bw_numbering *numbering = NULL;
  bw_domain_stiffness *anew = NULL;
  bw_domain_change change;
  int32_t *framed = NULL;
  bool same;
  double start = bw_seconds();
  double *frame = BW_NEW(context, double, 9 * domains);
  uint8_t *touched = BW_NEW0(context, uint8_t, domains);
  if (!frame || !touched) {
    status = BW_MEMORY;
    goto done;
  }
  BW_TRY(check_model(context, local, model));
  for (size_t d = 0; d < domains; d++)
    memcpy(frame + 9 * d, motion[d].frame, 9 * sizeof *frame);
  BW_TRY(bw_numbering_follow(context, model, system->numbering, inner->domain_count,
                             inner->node_domain, frame, &same, &numbering));
  if (same) {
    touch_turned_supports(system->numbering, numbering, inner->domain_count, inner->element_domain,
                          touched);
    BW_TRY(bw_domain_stiffness_update(context, local->stiffness, model->mesh, motion, &change));
  } else { /* other nodes have directions of their own: what the stiffness knows of them is void */
    framed = BW_NEW(context, int32_t, nodes);
    if (!framed) {
      status = BW_MEMORY;
      goto done;
    }
    framed_by(numbering, inner->domain_count, framed);
    BW_TRY(bw_domain_stiffness_create(context, system->graph, inner->rest->mesh,
                                      inner->rest->material, inner->material_turns,
                                      inner->domain_count, inner->element_domain, framed, &anew));
    BW_TRY(bw_domain_stiffness_update(context, anew, model->mesh, motion, &change));
  }

  /* From here on nothing fails. */
  if (same) {
    for (size_t d = 0; d < domains; d++)
      touched[d] |= local->stiffness->changed[d];
  } else {
    view_stiffness(local, anew);
    anew = NULL;
    memcpy(inner->framed, framed, nodes * sizeof *framed);
    bw_release(inner->factor);
    inner->factor = NULL;
    memset(touched, 1, domains);
  }
  int32_t count = 0;
  for (size_t d = 0; d < domains; d++) {
    count += touched[d];
    inner->touched[d] |= touched[d];
  }
  memcpy(inner->motion, motion, domains * sizeof *motion);
  memcpy(inner->frame, frame, 9 * domains * sizeof *frame);
  inner->spent = 0;
  bw_retain(model);
  bw_release(inner->model);
  inner->model = model;
  bw_retain(model->mesh);
  bw_release(system->mesh);
  system->mesh = model->mesh;
  bw_release(system->numbering);
  system->numbering = numbering;
  numbering = NULL;
  bw_release(system->factor);
  system->factor = NULL;
  local->object.revision++;
  if (reuse) {
    int32_t left = inner->domain_count - count;
    *reuse = (bw_reuse){.pattern = true, .ordering = true, .domains = inner->domain_count};
    reuse->domains_touched = count;
    reuse->domains_kept = change.kept < left ? change.kept : left;
    reuse->domains_turned = left - reuse->domains_kept;
    reuse->seconds_stiffness = bw_seconds() - start;
  }
done:
  bw_free(frame);
  bw_free(touched);
  bw_free(framed);
  bw_release(numbering);
  bw_release(anew);
  return status;
}
