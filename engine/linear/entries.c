/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* Matrix entries, from the blocks of a pattern. */
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
