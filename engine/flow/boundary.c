/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* Conditions on the boundary that are not prescribed values: tractions, heat fluxes, convection
 *
 *   alpha dT/dn = flux,   alpha dT/dn = coefficient (value - T),
 *
 * n outwards, everything over density times heat capacity. Integrated by Gauss's rule of three
 * points on each side, which is exact for linear T and a value that is a polynomial of degree 4. */
#include <math.h>

#include "flow/internal.h"
#include "responsive/internal.h"

enum { HEAT = 3, WIDTH = 2 };

/* A point on a side. */
typedef struct point {
  double shape[WIDTH], weight, value;
} point;

static bw_status point_at(bw_context *context, const bw_plane_mesh *mesh, const bw_condition *c,
                          const int32_t *node, int q, double time, point *p) {
  double n[3], slope[3], at[2], along[2];
  bwi_side_shape(WIDTH, bwi_side_at[q], n, slope);
  bwi_side_place(mesh, node, WIDTH, n, slope, at, along);
  for (int a = 0; a < WIDTH; a++)
    p->shape[a] = n[a];
  p->weight = bwi_side_weight[q] * hypot(along[0], along[1]);
  return bwi_condition_value(context, c, at, time, &p->value);
}

static bw_status convect(bw_context *context, bw_flow *flow, const bw_condition *c, double time) {
  bw_status status = BW_OK;
  struct bwi_flow *in = flow->inner;
  const bw_plane_topology *topology = flow->mesh->topology;
  int k = flow->components;
  for (int32_t s = 0; s < topology->side_count; s++) {
    const int32_t *node = topology->side + WIDTH * (int64_t)s;
    if (!bwi_condition_applies(flow->mesh, c, s))
      continue;
    for (int q = 0; q < BWI_SIDE_POINTS; q++) {
      point p;
      BW_TRY(point_at(context, flow->mesh, c, node, q, time, &p));
      for (int a = 0; a < WIDTH; a++) {
        double test = c->coefficient * p.weight * p.shape[a];
        in->workspace.load[k * (int64_t)node[a] + HEAT] += test * p.value;
        for (int b = 0; b < WIDTH; b++)
          in->workspace
              .values[k * (k * bwi_plane_block_index(in->now->pattern, node[a], node[b]) + HEAT) +
                      HEAT] += test * p.shape[b];
      }
    }
  }
done:
  return status;
}

bw_status bwi_flow_boundary(bw_context *context, bw_flow *flow, double time) {
  bw_status status = BW_OK;
  struct bwi_flow *in = flow->inner;
  const bw_flow_description *about = &in->about;
  size_t unknowns = (size_t)in->now->pattern->node_count * (size_t)flow->components;
  BW_TRY(bw_conditions_force(context, flow->mesh, flow->components, about->condition_count,
                             about->condition, time, 1, in->workspace.rhs));
  for (size_t i = 0; i < unknowns; i++)
    in->workspace.load[i] += in->workspace.rhs[i];
  for (int32_t i = 0; i < about->condition_count; i++)
    if (about->condition[i].kind == BW_CONVECTION)
      BW_TRY(convect(context, flow, &about->condition[i], time));
done:
  return status;
}

bw_status bwi_flow_boundary_heat(bw_context *context, const bw_flow *flow, int32_t tag,
                                 double *heat) {
  bw_status status = BW_OK;
  const bw_plane_topology *topology = flow->mesh->topology;
  const bw_flow_description *about = &flow->inner->about;
  *heat = 0;
  for (int32_t i = 0; i < about->condition_count; i++) {
    const bw_condition *c = &about->condition[i];
    bool convects = c->kind == BW_CONVECTION;
    if (!convects && !(c->kind == BW_TRACTION && c->component == HEAT))
      continue;
    for (int32_t s = 0; s < topology->side_count; s++) {
      const int32_t *node = topology->side + WIDTH * (int64_t)s;
      int32_t of = flow->mesh->outline->segment[topology->side_segment[s]].tag;
      if ((tag >= 0 && of != tag) || !bwi_condition_applies(flow->mesh, c, s))
        continue;
      for (int q = 0; q < BWI_SIDE_POINTS; q++) {
        point p;
        BW_TRY(point_at(context, flow->mesh, c, node, q, flow->time, &p));
        for (int a = 0; a < WIDTH && convects; a++)
          p.value -= p.shape[a] * flow->state[flow->components * (int64_t)node[a] + HEAT];
        *heat += p.weight * p.value * (convects ? c->coefficient : 1);
      }
    }
  }
done:
  return status;
}
