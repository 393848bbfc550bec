/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* Bonds with a preload: u_a = F u_b + s n. A given preload N does the work N s. Because all nodes
 * of side a that follow have the same s, forces N n and -N n F at one of them do the same work. */
#include "joint/internal.h"

/* The first node of side a in no support, as its row of the bond, or -1. */
static int32_t free_row(const bwi_reduction *r, const bw_bond *bond) {
  for (int32_t i = 0; i < bond->node_count; i++) {
    const uint8_t *at = r->dof_map->state + 3 * (int64_t)bond->node[i];
    if (at[0] != BW_DOF_PRESCRIBED && at[1] != BW_DOF_PRESCRIBED && at[2] != BW_DOF_PRESCRIBED)
      return i;
  }
  return -1;
}

bw_status bwi_preload_add(bw_context *context, const bw_model *model, const bwi_reduction *r,
                          double *force) {
  for (int b = 0; b < model->bond_count; b++) {
    const bw_bond *bond = &model->bond[b];
    const bw_sparse_matrix *f = bond->follows;
    if (bond->preload == BW_NO_PRELOAD)
      continue;
    int32_t row = free_row(r, bond);
    if (row < 0)
      return bw_fail(context, BW_INVALID,
                     "supports hold all %d nodes of side a of bond %d, across which there is a "
                     "preload: they would take it; hold less of the section",
                     bond->node_count, b + 1);
    for (int c = 0; c < 3 && bond->preload == BW_PRELOAD_FORCE; c++) {
      force[3 * (int64_t)bond->node[row] + c] += bond->pull * bond->normal[c];
      for (int64_t e = f->start[row]; e < f->start[row + 1]; e++)
        force[3 * (int64_t)f->column[e] + c] -= bond->pull * bond->normal[c] * f->value[e];
    }
  }
  return BW_OK;
}

void bwi_preload_results(const bw_model *model, const bwi_reduction *r, const double *displacement,
                         bw_joint_force *result) {
  for (int b = 0; b < model->bond_count; b++) {
    const bw_bond *bond = &model->bond[b];
    const bw_sparse_matrix *f = bond->follows;
    if (bond->preload == BW_NO_PRELOAD)
      continue;
    int32_t row = free_row(r, bond);
    const double *u = displacement + 3 * (int64_t)bond->node[row];
    result[b].preloaded = true;
    result[b].preload = bw_dot(bond->normal, result[b].force);
    result[b].shortening = bw_dot(bond->normal, u);
    for (int64_t e = f->start[row]; e < f->start[row + 1]; e++)
      result[b].shortening -=
          f->value[e] * bw_dot(bond->normal, displacement + 3 * (int64_t)f->column[e]);
  }
}
