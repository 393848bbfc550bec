/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* A fluid on a mesh that follows an outline: its life, and going over to another mesh. */
#include <math.h>
#include <string.h>

#include "flow/internal.h"
#include "responsive/internal.h"

void bwi_flow_room_clear(bwi_flow_room *room) {
  bw_free(room->block);
  bw_free(room->vector);
  bw_free(room->values);
  bw_free(room->system);
  bw_free(room->load);
  bw_free(room->rhs);
  bw_free(room->prescribed);
  bw_free(room->solution);
  bw_free(room->history);
  bw_free(room->convect);
  bw_free(room->laplacian);
  bw_free(room->held);
  *room = (bwi_flow_room){0};
}

bw_status bwi_flow_room_make(bw_context *context, const bw_plane_graph *graph, int components,
                             bwi_flow_room *room) {
  size_t entries = (size_t)graph->pair_count * (size_t)(components * components);
  size_t unknowns = (size_t)graph->node_count * (size_t)components;
  *room = (bwi_flow_room){
      .block = BW_NEW(context, double, bwi_plane_room(graph, components)),
      .vector =
          BW_NEW(context, double, 3 * (size_t)components * (size_t)graph->topology->element_count),
      .values = BW_NEW(context, double, entries),
      .system = BW_NEW(context, double, entries),
      .load = BW_NEW(context, double, unknowns),
      .rhs = BW_NEW(context, double, unknowns),
      .prescribed = BW_NEW(context, double, unknowns),
      .solution = BW_NEW(context, double, unknowns),
      .history = BW_NEW(context, double, unknowns),
      .convect = BW_NEW(context, double, 2 * (size_t)graph->node_count),
      .laplacian = BW_NEW(context, double, 3 * (size_t)graph->topology->element_count),
      .held = BW_NEW(context, uint8_t, unknowns),
  };
  if (room->block && room->vector && room->values && room->system && room->load && room->rhs &&
      room->prescribed && room->solution && room->history && room->convect && room->laplacian &&
      room->held)
    return BW_OK;
  bwi_flow_room_clear(room);
  return BW_MEMORY;
}

static void flow_destroy(void *object) {
  bw_flow *flow = object;
  struct bwi_flow *in = flow->inner;
  if (in) {
    bw_free(in->condition);
    bw_release(in->graph);
    bw_plane_locator_free(in->locator);
    bw_stale_free(in->stale);
    bwi_flow_room_clear(&in->room);
    bw_free(in->reaction);
    bw_free(in->old_point);
    bw_free(in->older_point);
    bw_free(in);
  }
  bw_release(flow->mesh);
  bw_free(flow->state);
  bw_free(flow->before);
  bw_free(flow);
}

static size_t flow_bytes(const void *object) {
  const bw_flow *flow = object;
  size_t square = (size_t)(flow->components * flow->components);
  size_t nodes = (size_t)flow->mesh->topology->nodes->node_count;
  size_t elements = (size_t)flow->mesh->topology->element_count;
  return sizeof *flow + (2 * square * (size_t)flow->inner->graph->pair_count +
                         8 * nodes * (size_t)flow->components +
                         bwi_plane_room(flow->inner->graph, flow->components) + 12 * elements) *
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
                     i + 1, c->component, components);
    if (c->kind == BW_CONVECTION &&
        (c->component != 3 || !(c->coefficient >= 0) || !isfinite(c->coefficient)))
      return bw_fail(context, BW_INVALID,
                     "condition %d is convection: it is on component 3, the temperature, not %d, "
                     "with a coefficient of at least 0 m/s, not %g",
                     i + 1, c->component, c->coefficient);
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
  flow->mesh = bw_retain(mesh);
  flow->components = description->diffusivity > 0 ? 4 : 3;
  in->about = *description;
  in->condition = BW_NEW(context, bw_condition, description->condition_count);
  size_t unknowns = (size_t)mesh->topology->nodes->node_count * (size_t)flow->components;
  flow->state = BW_NEW0(context, double, unknowns);
  flow->before = BW_NEW0(context, double, unknowns);
  in->reaction = BW_NEW0(context, double, unknowns);
  if (!in->condition || !flow->state || !flow->before || !in->reaction) {
    status = BW_MEMORY;
    goto done;
  }
  if (description->condition_count > 0)
    memcpy(in->condition, description->condition,
           (size_t)description->condition_count * sizeof *in->condition);
  in->about.condition = in->condition;
  in->known = 1;
  if (flow->components == 4)
    for (size_t i = 3; i < unknowns; i += 4)
      flow->state[i] = description->reference;
  BW_TRY(bw_stale_create(context, false, flow->components, &in->stale));
  BW_TRY(bw_plane_graph_create(context, mesh->topology, &in->graph));
  BW_TRY(bwi_flow_room_make(context, in->graph, flow->components, &in->room));
done:
  if (status == BW_OK)
    *result = flow;
  else
    bw_release(flow);
  return status;
}

static void exchange(double **a, double **b) {
  double *t = *a;
  *a = *b;
  *b = t;
}

/* Everything is made beside what there is, and takes its place at the end. */
bw_status bw_flow_follow(bw_context *context, bw_flow *flow, const bw_plane_mesh *mesh,
                         bw_kept *kept) {
  bw_status status = BW_OK;
  struct bwi_flow *in = flow->inner;
  const bw_plane_topology *before = flow->mesh->topology, *now = mesh->topology;
  bool same_topology = now == before, same_nodes = now->nodes == before->nodes;
  bw_plane_graph *graph = NULL;
  bwi_flow_room room = {0};
  double *state = NULL, *earlier = NULL, *reaction = NULL, *old = NULL;
  bw_condition *conditions = NULL;
  int c = flow->components;
  size_t nodes = (size_t)now->nodes->node_count;
  double started = bw_seconds();
  BW_TRY(check_mesh(context, mesh));
  state = BW_NEW(context, double, nodes *(size_t)c);
  earlier = BW_NEW(context, double, nodes *(size_t)c);
  reaction = BW_NEW0(context, double, nodes *(size_t)c);
  if (same_nodes)
    old = BW_NEW(context, double, 2 * nodes);
  if (!state || !earlier || !reaction || (same_nodes && !old)) {
    status = BW_MEMORY;
    goto done;
  }
  if (!same_nodes) /* it may be quite another outline, with the same tags in another order */
    BW_TRY(bwi_conditions_renamed(context, flow->mesh->outline, mesh->outline,
                                  in->about.condition_count, in->condition, &conditions));
  BW_TRY(bw_plane_carry(context, flow->mesh, mesh, c, flow->state, state));
  BW_TRY(bw_plane_carry(context, flow->mesh, mesh, c, flow->before, earlier));
  if (!same_topology) {
    BW_TRY(bw_plane_graph_create(context, now, &graph));
    BW_TRY(bwi_flow_room_make(context, graph, c, &room));
  }
  /* Several moves between two steps: the mesh velocity is of all of them. */
  if (same_nodes)
    memcpy(old, in->old_point ? in->old_point : flow->mesh->point, 2 * nodes * sizeof *old);
  if (!same_topology) {
    bw_plane_graph *former = in->graph;
    in->graph = graph;
    graph = former;
    bwi_flow_room former_room = in->room;
    in->room = room;
    room = former_room;
  }
  if (conditions) {
    bw_condition *former = in->condition;
    in->about.condition = in->condition = conditions;
    conditions = former;
  }
  exchange(&flow->state, &state);
  exchange(&flow->before, &earlier);
  exchange(&in->reaction, &reaction);
  exchange(&in->old_point, &old);
  in->reacted = false;
  if (!same_nodes) {
    bw_free(in->older_point);
    in->older_point = NULL;
    in->known = 1; /* interpolated fields are not free of divergence: damp by implicit Euler */
  }
  bw_plane_locator_free(in->locator);
  in->locator = NULL;
  bw_retain(mesh);
  bw_release(flow->mesh);
  flow->mesh = mesh;
  if (kept) {
    kept->pattern = same_topology;
    kept->solution = true;
    kept->seconds_assemble += bw_seconds() - started;
  }
done:
  bw_release(graph);
  bw_free(conditions);
  bwi_flow_room_clear(&room);
  bw_free(state);
  bw_free(earlier);
  bw_free(reaction);
  bw_free(old);
  return status;
}
