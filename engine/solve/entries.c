/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* Matrix entries, from the pairs of a graph to the panels of a factor. */
#include <math.h>
#include <string.h>

#include "solve/internal.h"

/* block = F_row block F_column^T for nodes with frames of their own */
static void turn_block(const bw_numbering *numbering, int32_t row, int32_t column, double *block) {
  double half[9];
  if (numbering->frame_of[row] >= 0) {
    const double *frame = numbering->frame + 9 * (int64_t)numbering->frame_of[row];
    for (int i = 0; i < 3; i++)
      for (int j = 0; j < 3; j++)
        half[3 * i + j] = frame[3 * i] * block[j] + frame[3 * i + 1] * block[3 + j] +
                          frame[3 * i + 2] * block[6 + j];
    memcpy(block, half, sizeof half);
  }
  if (numbering->frame_of[column] >= 0) {
    const double *frame = numbering->frame + 9 * (int64_t)numbering->frame_of[column];
    for (int i = 0; i < 3; i++)
      for (int j = 0; j < 3; j++)
        half[3 * i + j] = block[3 * i] * frame[3 * j] + block[3 * i + 1] * frame[3 * j + 1] +
                          block[3 * i + 2] * frame[3 * j + 2];
    memcpy(block, half, sizeof half);
  }
}

void bwi_matrix_block(const bwi_matrix *matrix, int components, int64_t pair, bool transpose,
                      int32_t row, int32_t column, double *block) {
  int square = components * components;
  const double *entry = matrix->stiffness + square * pair;
  for (int i = 0; i < components; i++)
    for (int j = 0; j < components; j++)
      block[components * i + j] = entry[transpose ? components * j + i : components * i + j];
  double mass = matrix->mass ? matrix->shift * matrix->mass[pair] : 0;
  for (int i = 0; i < components; i++)
    block[(components + 1) * i] += mass;
  if (matrix->numbering && matrix->numbering->frame_count > 0)
    turn_block(matrix->numbering, row, column, block);
}

/* Add the entries of pair `pair` to the panel: rows of mesh node `row`, columns of `column`. */
static void add_pair(const bwi_symbolic *symbolic, const bwi_matrix *matrix, int64_t pair,
                     bool transpose, int32_t row, int32_t column, int32_t row_offset,
                     int32_t column_offset, double *panel, int32_t ld, double *scale) {
  int components = symbolic->components;
  double block[9];
  bwi_matrix_block(matrix, components, pair, transpose, row, column, block);
  double mass = matrix->mass ? fabs(matrix->shift * matrix->mass[pair]) : 0;
  const int32_t *at = symbolic->at;
  for (int j = 0, b = 0; j < components; j++) {
    if (at[(int64_t)column * components + j] < 0)
      continue;
    double *target = panel + (int64_t)(column_offset + b) * ld + row_offset;
    for (int i = 0, a = 0; i < components; i++)
      if (at[(int64_t)row * components + i] >= 0) {
        target[a] += block[components * i + j];
        if (row == column && i == j)
          scale[column_offset + b] = fabs(block[components * i + j]) + 2 * mass;
        a++;
      }
    b++;
  }
}

void bwi_matrix_to_panel(const bwi_symbolic *symbolic, const bwi_matrix *matrix, int32_t s,
                         const int32_t *local, double *panel, double *scale) {
  const bwi_order *order = symbolic->order;
  const bw_graph *graph = matrix->graph;
  int32_t ld = symbolic->rows[s];
  for (int32_t p = order->super[s]; p < order->super[s + 1]; p++) {
    int32_t node = order->node_at[p];
    for (int64_t k = graph->start[node]; k < graph->start[node + 1]; k++) {
      int32_t other = graph->column[k];
      if (order->place[other] >= p)
        add_pair(symbolic, matrix, k, true, other, node, local[order->place[other]], local[p],
                 panel, ld, scale);
    }
    for (int64_t k = graph->upper_start[node]; k < graph->upper_start[node + 1]; k++) {
      int32_t other = graph->upper_row[k];
      if (order->place[other] >= p)
        add_pair(symbolic, matrix, graph->upper_pair[k], false, other, node,
                 local[order->place[other]], local[p], panel, ld, scale);
    }
  }
}
