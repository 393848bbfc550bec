/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* What is read off a flow: forces and heat as reactions, values at places, vorticity, the frequency
 * of a signal. */
#include <math.h>
#include <string.h>

#include "flow/internal.h"

/* Sum of a component of the reactions over the nodes of a tag, each node once: those of its
 * sides. */
static bw_status sum_reactions(bw_context *context, const bw_flow *flow, int32_t tag, int component,
                               double *sum) {
  const bw_plane_topology *topology = flow->mesh->topology;
  const bw_outline *outline = flow->mesh->outline;
  int64_t nodes = topology->nodes->node_count;
  if (!flow->inner->now->reacted)
    return bw_fail(
        context, BW_INVALID,
        "no solution on the present mesh: forces and heat are reactions of a time step or "
        "of a steady state, so do one first");
  if (tag < -1 || tag >= outline->tag_count)
    return bw_fail(context, BW_INVALID, "tag %d: the outline has tags 1 to %d", tag + 1,
                   outline->tag_count);
  uint8_t *seen = BW_NEW0(context, uint8_t, nodes);
  if (!seen)
    return BW_MEMORY;
  *sum = 0;
  for (int64_t k = 0; k < topology->side_count; k++) {
    if (tag >= 0 && outline->segment[topology->side_segment[k]].tag != tag)
      continue;
    for (int end = 0; end < 2; end++) {
      int64_t node = topology->side[2 * k + end];
      if (!seen[node])
        *sum += flow->inner->now->reaction[flow->components * node + component];
      seen[node] = 1;
    }
  }
  bw_free(seen);
  return BW_OK;
}

bw_status bw_flow_force(bw_context *context, const bw_flow *flow, int32_t tag, double force[2]) {
  bw_status status = BW_OK;
  double sum[2];
  for (int d = 0; d < 2; d++)
    BW_TRY(sum_reactions(context, flow, tag, d, &sum[d]));
  for (int d = 0; d < 2; d++)
    force[d] = -sum[d]; /* the reaction is what the wall does to the fluid */
done:
  return status;
}

bw_status bw_flow_heat(bw_context *context, const bw_flow *flow, int32_t tag, double *heat) {
  bw_status status = BW_OK;
  if (flow->components < 4)
    return bw_fail(context, BW_INVALID, "the flow carries no heat: its diffusivity is 0");
  /* A corner's reaction belongs to the side whose temperature is prescribed. */
  bool fixed_temperature = false;
  for (int32_t i = 0; i < flow->inner->about.condition_count && !fixed_temperature; i++) {
    const bw_condition *c = &flow->inner->condition[i];
    fixed_temperature =
        c->kind == BW_PRESCRIBED && c->component == 3 && (tag < 0 || c->tag < 0 || c->tag == tag);
  }
  double reactions = 0, natural = 0;
  BW_TRY(sum_reactions(context, flow, tag, 3, &reactions));
  BW_TRY(bwi_flow_boundary_heat(context, flow, tag, &natural));
  *heat = (fixed_temperature ? reactions : 0) + natural;
done:
  return status;
}

bw_status bw_flow_at(bw_context *context, const bw_flow *flow, const double at[2], double *values) {
  bw_status status = BW_OK;
  struct bwi_flow *in = flow->inner;
  double weight[3], outside;
  if (!in->locator)
    BW_TRY(bw_plane_locator_create(context, flow->mesh, &in->locator));
  int32_t element = bw_plane_locate(in->locator, at, weight, &outside);
  const int32_t *node = flow->mesh->topology->element + 3 * (int64_t)element;
  int c = flow->components;
  for (int d = 0; d < c; d++) {
    values[d] = 0;
    for (int i = 0; i < 3; i++)
      values[d] += weight[i] * flow->state[c * (int64_t)node[i] + d];
  }
done:
  return status;
}

bw_status bw_flow_vorticity(bw_context *context, const bw_flow *flow, double *vorticity) {
  const bw_plane_topology *topology = flow->mesh->topology;
  int64_t nodes = topology->nodes->node_count;
  int c = flow->components;
  double *weight = BW_NEW0(context, double, nodes);
  if (!weight)
    return BW_MEMORY;
  memset(vorticity, 0, (size_t)nodes * sizeof *vorticity);
  for (int64_t k = 0; k < topology->element_count; k++) {
    const int32_t *node = topology->element + 3 * k;
    double turn = 0, twice = 0;
    for (int i = 0; i < 3; i++) {
      const double *b = flow->mesh->point + 2 * (int64_t)node[(i + 1) % 3];
      const double *d = flow->mesh->point + 2 * (int64_t)node[(i + 2) % 3];
      const double *u = flow->state + c * (int64_t)node[i];
      turn += u[1] * (b[1] - d[1]) - u[0] * (d[0] - b[0]); /* twice the area times dv/dx - du/dy */
      twice += b[0] * d[1] - d[0] * b[1];
    }
    for (int i = 0; i < 3; i++) {
      vorticity[node[i]] += turn;
      weight[node[i]] += twice;
    }
  }
  for (int64_t i = 0; i < nodes; i++)
    vorticity[i] /= weight[i];
  bw_free(weight);
  return BW_OK;
}

double bw_flow_frequency(int64_t count, const double *signal, double step, int periods) {
  double mean = 0, first = 0, last = 0;
  int crossings = 0;
  for (int64_t i = 0; i < count; i++)
    mean += signal[i] / (double)count;
  for (int64_t i = count - 1; i > 0 && crossings <= periods; i--)
    if (signal[i - 1] < mean && signal[i] >= mean) {
      double at = (double)i - (signal[i] - mean) / (signal[i] - signal[i - 1]);
      if (crossings++ == 0)
        last = at;
      first = at;
    }
  return crossings > 1 ? (crossings - 1) / ((last - first) * step) : 0;
}
