/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* Between fields (a number per node and component) and right-hand sides in elimination order, those
 * of one unknown next to each other. */
#include <math.h>

#include "linear/internal.h"

typedef struct transfer {
  const bwi_symbolic *symbolic;
  const bw_dof_map *dof_map;
  int width, used; /* right-hand sides in a row, and how many are real */
  const double *force;
  double *displacement;
  real *x;
  double unit[BWI_MAX_WIDTH]; /* powers of two that bring the sides into the range of float */
  double back[BWI_MAX_WIDTH]; /* and what undoes them in the solutions */
} transfer;

static const double *frame_at(const transfer *move, int64_t node) {
  const bw_dof_map *dof_map = move->dof_map;
  if (!dof_map || dof_map->frame_count == 0 || dof_map->frame_of[node] < 0)
    return NULL;
  return dof_map->frame + 9 * (int64_t)dof_map->frame_of[node];
}

static bw_status gather(void *data, int64_t begin, int64_t end, int worker) {
  (void)worker;
  const transfer *move = data;
  int components = move->symbolic->components, width = move->width;
  int64_t size = (int64_t)move->symbolic->order->node_count * components;
  for (int64_t node = begin; node < end; node++) {
    const int32_t *at = move->symbolic->at + node * components;
    const double *frame = frame_at(move, node);
    for (int c = 0; c < components; c++) {
      if (at[c] < 0)
        continue;
      real *x = move->x + (int64_t)at[c] * width;
      for (int k = 0; k < move->used; k++) {
        const double *f = move->force + k * size + node * components;
        x[k] = (real)(move->unit[k] * (frame ? bw_dot(frame + 3 * c, f) : f[c]));
      }
      for (int k = move->used; k < width; k++)
        x[k] = 0;
    }
  }
  return BW_OK;
}

static bw_status scatter(void *data, int64_t begin, int64_t end, int worker) {
  (void)worker;
  const transfer *move = data;
  int components = move->symbolic->components, width = move->width;
  int64_t size = (int64_t)move->symbolic->order->node_count * components;
  for (int64_t node = begin; node < end; node++) {
    const int32_t *at = move->symbolic->at + node * components;
    const double *frame = frame_at(move, node);
    for (int k = 0; k < move->used; k++) {
      double *u = move->displacement + k * size + node * components, local[3] = {0, 0, 0};
      for (int c = 0; c < components; c++)
        local[c] = at[c] < 0 ? 0 : move->back[k] * (double)move->x[(int64_t)at[c] * width + k];
      for (int c = 0; c < components; c++)
        u[c] = frame ? frame[c] * local[0] + frame[3 + c] * local[1] + frame[6 + c] * local[2]
                     : local[c];
    }
  }
  return BW_OK;
}

/* Brings the largest component of a side to between 1/2 and 1; the factor is that of the matrix
 * times its own unit. */
static void choose_units(const bwi_factor *factor, int64_t size, transfer *move) {
  for (int k = 0; k < move->used; k++) {
    double max = 0;
    int exponent = 0;
    for (int64_t i = 0; sizeof(real) < sizeof(double) && i < size; i++)
      max = fmax(max, fabs(move->force[k * size + i]));
    if (max > 0 && isfinite(max))
      frexp(fmax(max, 1e-300), &exponent);
    move->unit[k] = ldexp(1, -exponent);
    move->back[k] = ldexp(factor->unit, exponent);
  }
}

bw_status bwi_solve_fields_of(bw_context *context, const bwi_factor *factor,
                              const bw_dof_map *dof_map, int64_t count, const double *force,
                              double *displacement) {
  bw_status status = BW_OK;
  const bwi_symbolic *symbolic = factor->symbolic;
  int64_t nodes = symbolic->order->node_count, size = nodes * symbolic->components;
  int max = 1;
  while (max < BWI_MAX_WIDTH && max < count)
    max *= 2;
  transfer move = {.symbolic = symbolic, .dof_map = dof_map};
  move.x = BW_NEW(context, real, (int64_t)symbolic->unknowns * max);
  if (!move.x)
    return BW_MEMORY;
  for (int64_t done_count = 0; done_count < count; done_count += move.used) {
    int64_t left = count - done_count;
    move.width = 1;
    while (move.width < BWI_MAX_WIDTH && move.width < left)
      move.width *= 2;
    move.used = (int)(left < move.width ? left : move.width);
    move.force = force + done_count * size;
    move.displacement = displacement + done_count * size;
    BW_TRY(bw_check_cancel(context));
    choose_units(factor, size, &move);
    BW_TRY(bw_parallel(context, nodes, 2048, gather, &move));
    BW_TRY(factor->kernels->solve(context, factor, move.width, move.x));
    BW_TRY(bw_parallel(context, nodes, 2048, scatter, &move));
  }
done:
  bw_free(move.x);
  return status;
}

const bwi_kernels KERNELS = {.backend = "multifrontal",
                             .bits = 8 * sizeof(real),
                             .size = sizeof(real),
                             .entries = bwi_matrix_to_panel,
                             .child = bwi_add_child,
                             .eliminate = bwi_front_eliminate,
                             .solve = bwi_factor_solve,
                             .solve_fields = bwi_solve_fields_of};
