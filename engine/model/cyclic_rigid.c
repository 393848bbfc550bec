/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* The rigid-body modes of a wheel of sectors, by the number of nodal diameters: the motions of the
 * sector's bodies, with real and imaginary parts, that agree with supports and springs and turn
 * from one face into the other. */
#include <math.h>

#include "model/internal.h"

int bwi_cyclic_parts(const bw_cyclic *cyclic, int diameter) {
  return diameter == 0 || 2 * diameter == cyclic->count ? 1 : 2;
}

void bwi_cyclic_phase(const bw_cyclic *cyclic, int64_t turns, double *c, double *s) {
  int64_t count = cyclic->count, left = turns % count;
  double angle = 6.28318530717958647692 * (double)left / (double)count;
  *c = 2 * left == count ? -1 : cos(angle);
  *s = 2 * left == count ? 0 : sin(angle);
}

/* Along d at a node, `part` 0 of the real part of the motion, 1 of the imaginary one. */
static void add(const bwi_motions *m, int part, int32_t node, const double d[3], double factor) {
  const bw_mesh *mesh = m->dof_map->mesh;
  bwi_motions own = *m;
  own.first = 6 * part * mesh->component_count;
  bwi_add_motion(&own, mesh->component[node], mesh->node + 3 * (int64_t)node, d, factor);
}

/* u_high = exp(i diameter angle) R u_low, component by component. */
static void take_pair(const bwi_motions *m, const bw_cyclic *cyclic, int diameter, int32_t high) {
  int32_t low = cyclic->partner[high];
  int parts = bwi_cyclic_parts(cyclic, diameter);
  double rotation[9], c, s;
  bwi_cyclic_rotation(cyclic, 1, rotation);
  bwi_cyclic_phase(cyclic, diameter, &c, &s);
  for (int k = 0; k < 3; k++)
    for (int part = 0; part < parts; part++) {
      const double d[3] = {k == 0, k == 1, k == 2};
      add(m, part, high, d, 1);
      add(m, part, low, rotation + 3 * k, -c);
      if (parts == 2)
        add(m, 1 - part, low, rotation + 3 * k, part == 0 ? s : -s);
      bwi_take_row(m);
    }
}

bw_status bwi_cyclic_rigid_modes(bw_context *context, const bw_model *model,
                                 const bw_dof_map *dof_map, int diameter, int *count,
                                 int32_t *body) {
  bw_status status = BW_OK;
  int32_t constrained = 0, bodies = dof_map->mesh->component_count;
  int parts = bwi_cyclic_parts(model->cyclic, diameter);
  bwi_constraint *constraint = NULL;
  bwi_motions m = {0};
  BW_TRY(bwi_motions_open(context, dof_map, 6 * parts * bodies, &m));
  BW_TRY(bwi_node_constraints(context, model, &constrained, &constraint));
  for (int part = 0; part < parts; part++) {
    bwi_motions own = m;
    own.first = 6 * part * bodies;
    bwi_take_supports(&own, constrained, constraint);
    for (int i = 0; i < model->attachment_count; i++)
      bwi_take_spring(&own, &model->attachment[i]);
    for (int i = 0; i < model->bond_count; i++)
      bwi_take_bond(&own, &model->bond[i], -1);
  }
  for (int32_t i = 0; i < dof_map->mesh->node_count; i++)
    if (model->cyclic->partner[i] >= 0)
      take_pair(&m, model->cyclic, diameter, i);
  bwi_count_rigid_modes(&m, count, body);
done:
  bwi_motions_clear(&m);
  bw_free(constraint);
  return status;
}
