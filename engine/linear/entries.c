/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* Matrix entries, from the blocks of a pattern. */
#include <math.h>
#include <string.h>

#include "linear/internal.h"

void bwi_rotate_block(const bw_dof_map *dof_map, int32_t row, int32_t column, double *block) {
  double half[9];
  if (dof_map->frame_of[row] >= 0) {
    const double *frame = dof_map->frame + 9 * (int64_t)dof_map->frame_of[row];
    for (int i = 0; i < 3; i++)
      for (int j = 0; j < 3; j++)
        half[3 * i + j] = frame[3 * i] * block[j] + frame[3 * i + 1] * block[3 + j] +
                          frame[3 * i + 2] * block[6 + j];
    memcpy(block, half, sizeof half);
  }
  if (dof_map->frame_of[column] >= 0) {
    const double *frame = dof_map->frame + 9 * (int64_t)dof_map->frame_of[column];
    for (int i = 0; i < 3; i++)
      for (int j = 0; j < 3; j++)
        half[3 * i + j] = block[3 * i] * frame[3 * j] + block[3 * i + 1] * frame[3 * j + 1] +
                          block[3 * i + 2] * frame[3 * j + 2];
    memcpy(block, half, sizeof half);
  }
}

void bwi_matrix_block(const bwi_matrix *matrix, int components, int64_t index, bool transpose,
                      int32_t row, int32_t column, double *block) {
  int square = components * components;
  const double *entry = matrix->stiffness + square * index;
  for (int i = 0; i < components; i++)
    for (int j = 0; j < components; j++)
      block[components * i + j] = entry[transpose ? components * j + i : components * i + j];
  double mass = matrix->mass ? matrix->shift * matrix->mass[index] : 0;
  for (int i = 0; i < components; i++)
    block[(components + 1) * i] += mass;
  if (matrix->dof_map && matrix->dof_map->frame_count > 0)
    bwi_rotate_block(matrix->dof_map, row, column, block);
}

bool bwi_invert_node_block(const bw_dof_map *dof_map, int64_t node, unsigned states, double weakest,
                           const double *block, double inverse[9]) {
  static const double global[9] = {1, 0, 0, 0, 1, 0, 0, 0, 1};
  int32_t row = dof_map->frame_of[node];
  const double *frame = row < 0 ? global : dof_map->frame + 9 * (int64_t)row;
  int count = 0;
  double f[3][3], a[3][3], b[3][3] = {{0}}, least[3];
  for (int k = 0; k < 3; k++)
    if (states >> dof_map->state[3 * node + k] & 1)
      memcpy(f[count++], frame + 3 * k, sizeof f[0]);
  for (int p = 0; p < count; p++)
    for (int q = 0; q < count; q++) {
      a[p][q] = 0;
      for (int i = 0; i < 3; i++)
        a[p][q] += f[p][i] * bw_dot(block + 3 * i, f[q]);
      b[p][q] = p == q;
    }
  for (int k = 0; k < count; k++)
    least[k] = weakest * fabs(a[k][k]);
  for (int k = 0; k < count; k++) { /* pivots of a positive definite matrix are positive */
    double pivot = a[k][k];
    if (!(pivot > least[k]) || !isfinite(pivot))
      return false;
    for (int q = 0; q < count; q++) {
      a[k][q] /= pivot;
      b[k][q] /= pivot;
    }
    for (int p = 0; p < count; p++) {
      double factor = p == k ? 0 : a[p][k];
      for (int q = 0; q < count; q++) {
        a[p][q] -= factor * a[k][q];
        b[p][q] -= factor * b[k][q];
      }
    }
  }
  memset(inverse, 0, 9 * sizeof *inverse);
  for (int p = 0; p < count; p++)
    for (int q = 0; q < count; q++)
      for (int i = 0; i < 3; i++)
        for (int j = 0; j < 3; j++)
          inverse[3 * i + j] += f[p][i] * b[p][q] * f[q][j];
  return true;
}
