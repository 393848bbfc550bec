/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* A flow's state, kept and given back bit for bit. Solving again would take as long as the first
 * time, and may end elsewhere: a steady flow need not be the only one. */
#include <string.h>

#include "flow/internal.h"

struct bw_flow_state {
  bw_object object;
  const bw_plane_mesh *mesh;   /* retained */
  const bw_plane_graph *graph; /* retained */
  int components, condition_count, known;
  bool reacted;
  double time, last_step;
  bw_condition
      *condition; /* whose tags are those of the mesh's outline; its functions are not called */
  double *state, *before, *reaction;
  double *old_point, *older_point; /* NULL where the flow has none */
};

static void destroy(void *object) {
  bw_flow_state *s = object;
  bw_release(s->mesh);
  bw_release(s->graph);
  bw_free(s->condition);
  bw_free(s->state);
  bw_free(s->before);
  bw_free(s->reaction);
  bw_free(s->old_point);
  bw_free(s->older_point);
  bw_free(s);
}

static size_t bytes(const void *object) {
  const bw_flow_state *s = object;
  size_t nodes = (size_t)s->mesh->topology->nodes->node_count;
  return sizeof *s + nodes * sizeof(double) * (3 * (size_t)s->components + 4);
}

static const bw_kind kind = {"flow state", destroy, bytes};

/* A copy of a block, or of none. */
static bw_status copy(bw_context *context, const double *from, size_t count, double **to) {
  *to = NULL;
  if (!from)
    return BW_OK;
  *to = BW_NEW(context, double, count);
  if (!*to)
    return BW_MEMORY;
  memcpy(*to, from, count * sizeof **to);
  return BW_OK;
}

bw_status bw_flow_keep(bw_context *context, const bw_flow *flow, bw_flow_state **out) {
  bw_status status = BW_OK;
  const struct bwi_flow *in = flow->inner;
  size_t nodes = (size_t)flow->mesh->topology->nodes->node_count;
  size_t unknowns = nodes * (size_t)flow->components;
  bw_flow_state *s = BW_NEW0(context, bw_flow_state, 1);
  if (!s)
    return BW_MEMORY;
  bw_object_init(s, &kind);
  s->mesh = bw_retain(flow->mesh);
  s->graph = bw_retain(in->graph);
  s->components = flow->components;
  s->condition_count = in->about.condition_count;
  s->known = in->known;
  s->reacted = in->reacted;
  s->time = flow->time;
  s->last_step = in->last_step;
  s->condition = BW_NEW(context, bw_condition, s->condition_count);
  if (!s->condition) {
    status = BW_MEMORY;
    goto done;
  }
  if (s->condition_count > 0)
    memcpy(s->condition, in->condition, (size_t)s->condition_count * sizeof *s->condition);
  BW_TRY(copy(context, flow->state, unknowns, &s->state));
  BW_TRY(copy(context, flow->before, unknowns, &s->before));
  BW_TRY(copy(context, in->reaction, unknowns, &s->reaction));
  BW_TRY(copy(context, in->old_point, 2 * nodes, &s->old_point));
  BW_TRY(copy(context, in->older_point, 2 * nodes, &s->older_point));
done:
  if (status == BW_OK)
    *out = s;
  else
    bw_release(s);
  return status;
}

const bw_plane_mesh *bw_flow_state_mesh(const bw_flow_state *state) {
  return state->mesh;
}

static void exchange(double **a, double **b) {
  double *t = *a;
  *a = *b;
  *b = t;
}

/* Conditions stay the flow's own but for their tags: what was kept may outlive its flow, and what
 * their functions stand on. */
static bool fits(const bw_flow *flow, const bw_flow_state *s) {
  const struct bwi_flow *in = flow->inner;
  if (s->components != flow->components || s->condition_count != in->about.condition_count)
    return false;
  for (int i = 0; i < s->condition_count; i++)
    if (s->condition[i].kind != in->condition[i].kind ||
        s->condition[i].component != in->condition[i].component)
      return false;
  return true;
}

bw_status bw_flow_return(bw_context *context, bw_flow *flow, const bw_flow_state *s) {
  bw_status status = BW_OK;
  struct bwi_flow *in = flow->inner;
  size_t nodes = (size_t)s->mesh->topology->nodes->node_count;
  size_t unknowns = nodes * (size_t)s->components;
  bwi_flow_room room = {0};
  double *state = NULL, *before = NULL, *reaction = NULL, *old = NULL, *older = NULL;
  if (!fits(flow, s))
    return bw_fail(context, BW_INVALID, "the state that was kept is of another flow");
  BW_TRY(copy(context, s->state, unknowns, &state));
  BW_TRY(copy(context, s->before, unknowns, &before));
  BW_TRY(copy(context, s->reaction, unknowns, &reaction));
  BW_TRY(copy(context, s->old_point, 2 * nodes, &old));
  BW_TRY(copy(context, s->older_point, 2 * nodes, &older));
  if (s->graph != in->graph) {
    BW_TRY(bwi_flow_room_make(context, s->graph, s->components, &room));
    bwi_flow_room former = in->room;
    in->room = room;
    room = former;
    bw_retain(s->graph);
    bw_release(in->graph);
    in->graph = (bw_plane_graph *)s->graph;
  }
  exchange(&flow->state, &state);
  exchange(&flow->before, &before);
  exchange(&in->reaction, &reaction);
  exchange(&in->old_point, &old);
  exchange(&in->older_point, &older);
  for (int i = 0; i < s->condition_count; i++)
    in->condition[i].tag = s->condition[i].tag;
  in->known = s->known;
  in->reacted = s->reacted;
  in->last_step = s->last_step;
  flow->time = s->time;
  bw_plane_locator_free(in->locator);
  in->locator = NULL;
  bw_retain(s->mesh);
  bw_release(flow->mesh);
  flow->mesh = s->mesh;
done:
  bwi_flow_room_clear(&room);
  bw_free(state);
  bw_free(before);
  bw_free(reaction);
  bw_free(old);
  bw_free(older);
  return status;
}
