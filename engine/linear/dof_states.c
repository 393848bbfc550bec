/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* Fields in global directions, seen through the states of a DOF map. */
#include <string.h>

#include "linear/internal.h"

/* What the frame's directions with `keep` see of a vector at a node. */
static void keep_at_node(const bw_dof_map *dof_map, int64_t node, const bool keep[3],
                         double *vector) {
  int32_t row = dof_map->frame_of[node];
  if (row < 0) {
    for (int c = 0; c < 3; c++)
      if (!keep[c])
        vector[c] = 0;
    return;
  }
  const double *frame = dof_map->frame + 9 * (int64_t)row;
  double kept[3] = {0, 0, 0};
  for (int c = 0; c < 3; c++)
    if (keep[c]) {
      double part = bw_dot(frame + 3 * c, vector);
      for (int d = 0; d < 3; d++)
        kept[d] += part * frame[3 * c + d];
    }
  memcpy(vector, kept, sizeof kept);
}

void bwi_keep_states(const bw_dof_map *dof_map, unsigned states, double *field) {
  for (int64_t i = 0; i < dof_map->mesh->node_count; i++) {
    bool keep[3];
    for (int c = 0; c < 3; c++)
      keep[c] = states >> dof_map->state[3 * i + c] & 1;
    if (!keep[0] || !keep[1] || !keep[2])
      keep_at_node(dof_map, i, keep, field + 3 * i);
  }
}

void bwi_prescribed_field(const bw_dof_map *dof_map, double *field) {
  for (int64_t i = 0; i < dof_map->mesh->node_count; i++) {
    const double *value = dof_map->value + 3 * i;
    int32_t row = dof_map->frame_of[i];
    const double *frame = row < 0 ? NULL : dof_map->frame + 9 * (int64_t)row;
    for (int c = 0; c < 3; c++)
      field[3 * i + c] =
          frame ? frame[c] * value[0] + frame[3 + c] * value[1] + frame[6 + c] * value[2]
                : value[c];
  }
}

void bwi_project_unknowns(const bw_dof_map *dof_map, int64_t node, const double *f, double out[3]) {
  int32_t row = dof_map->frame_of[node];
  const uint8_t *state = dof_map->state + 3 * node;
  bool prescribed = state[0] == BW_DOF_PRESCRIBED || state[1] == BW_DOF_PRESCRIBED ||
                    state[2] == BW_DOF_PRESCRIBED;
  if (row < 0 || !prescribed) {
    for (int d = 0; d < 3; d++)
      out[d] = state[d] == BW_DOF_PRESCRIBED ? 0 : f[d];
    return;
  }
  const double *frame = dof_map->frame + 9 * (int64_t)row, from[3] = {f[0], f[1], f[2]};
  out[0] = out[1] = out[2] = 0;
  for (int c = 0; c < 3; c++) {
    double along = state[c] == BW_DOF_PRESCRIBED ? 0 : bw_dot(frame + 3 * c, from);
    for (int d = 0; d < 3; d++)
      out[d] += along * frame[3 * c + d];
  }
}

bool bwi_same_supports(const bw_dof_map *a, const bw_dof_map *b) {
  if (a == b)
    return true;
  size_t nodes = (size_t)a->mesh->node_count;
  return a->mesh->node_count == b->mesh->node_count && a->frame_count == b->frame_count &&
         a->rigid_mode_count == b->rigid_mode_count && memcmp(a->state, b->state, 3 * nodes) == 0 &&
         memcmp(a->frame_of, b->frame_of, nodes * sizeof(int32_t)) == 0 &&
         (a->frame_count == 0 ||
          memcmp(a->frame, b->frame, 9 * (size_t)a->frame_count * sizeof(double)) == 0);
}
