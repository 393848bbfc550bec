/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* K x and M x of whole fields, with matrices that the engine assembles again piece by piece: the
 * check of what PETSc gives does not use PETSc's matrix, and takes no memory for another one. */
#include <math.h>
#include <string.h>

#include "distributed/internal.h"

enum { BATCH = 8 }; /* fields for which a piece is assembled once */

typedef struct products {
  const bwd_local_mesh *local;
  int count;
  double *x;             /* count x nodes x 3, at own nodes and ghost nodes */
  double *kx, *mx;       /* count x owned x 3; mx may be NULL */
  double squares[BATCH]; /* of the terms of the diagonal blocks */
} products;

/* The terms that the diagonal blocks contribute to K x, squared and summed. */
static double diagonal_squares(const bwd_piece *piece, const double *x) {
  double sum = 0;
  for (int32_t i = 0; i < piece->rows; i++) {
    const double *k = piece->stiffness + 9 * (piece->pattern->start[i + 1] - 1);
    const double *v = x + 3 * (int64_t)i;
    for (int c = 0; c < 3; c++) {
      double term = fabs(k[3 * c] * v[0]) + fabs(k[3 * c + 1] * v[1]) + fabs(k[3 * c + 2] * v[2]);
      sum += term * term;
    }
  }
  return sum;
}

static bw_status multiply_piece(bw_context *context, void *data, const bwd_piece *piece) {
  bw_status status = BW_OK;
  products *p = data;
  int64_t nodes = piece->mesh->node_count, owned = p->local->count.owned;
  double *x = BW_NEW(context, double, 3 * nodes * p->count);
  double *y = BW_NEW(context, double, 3 * nodes * p->count);
  BW_TRY_MEMORY(x && y);
  for (int v = 0; v < p->count; v++) {
    const double *from = p->x + 3 * (int64_t)v * p->local->count.nodes;
    for (int64_t i = 0; i < nodes; i++)
      memcpy(x + 3 * (v * nodes + i), from + 3 * (int64_t)piece->node[i], 3 * sizeof *x);
    p->squares[v] += diagonal_squares(piece, x + 3 * v * nodes);
  }
  for (int which = 0; which < (p->mx ? 2 : 1); which++) {
    double *to = which == 0 ? p->kx : p->mx;
    BW_TRY(bw_block_multiply(context, piece->pattern, which == 0 ? piece->stiffness : piece->mass,
                             which == 0 ? 9 : 1, 3, p->count, x, y));
    for (int v = 0; v < p->count; v++)
      memcpy(to + 3 * (v * owned + piece->first), y + 3 * v * nodes,
             3 * (size_t)piece->rows * sizeof *y);
  }
done:
  bw_free(x);
  bw_free(y);
  return status;
}

/* The rank's rows of a product, in global directions, to a field of rank 0. */
static bw_status deliver(bw_context *context, bwd_system *system, const double *rows,
                         double *field) {
  bw_status status = BW_OK;
  double *own = NULL;
  BWD_TRY(VecGetArray(system->displacement, &own));
  for (int32_t i = 0; i < system->local; i++)
    bwd_into_frame(bwd_local_frame(&system->mesh, i), rows + 3 * (int64_t)i, own + 3 * (int64_t)i);
  BWD_TRY(VecRestoreArray(system->displacement, &own));
  BW_TRY(bwd_gather(context, system, system->displacement, field));
done:
  return status;
}

static bw_status multiply_batch(bw_context *context, bwd_system *system, products *p,
                                const double *x, double *kx, double *mx, double *magnitude) {
  bw_status status = BW_OK;
  int64_t size = 3 * (int64_t)system->nodes, local = 3 * (int64_t)system->mesh.count.nodes;
  int64_t owned = 3 * (int64_t)system->local;
  double sum[BATCH];
  for (int v = 0; v < p->count; v++) {
    p->squares[v] = 0;
    BW_TRY(bwd_scatter(context, system, x ? x + v * size : NULL, system->displacement));
    BW_TRY(bwd_ghosted(context, system, system->displacement, p->x + v * local));
  }
  BW_TRY(
      bwd_agree(context, bwd_for_pieces(context, &system->mesh, p->mx != NULL, multiply_piece, p)));
  MPI_Reduce(p->squares, sum, p->count, MPI_DOUBLE, MPI_SUM, 0, bwd_comm());
  for (int v = 0; v < p->count; v++) {
    BW_TRY(deliver(context, system, p->kx + v * owned, kx ? kx + v * size : NULL));
    if (p->mx)
      BW_TRY(deliver(context, system, p->mx + v * owned, mx ? mx + v * size : NULL));
    if (magnitude)
      magnitude[v] = sqrt(sum[v]);
  }
done:
  return status;
}

bw_status bwd_multiply(bw_context *context, bwd_system *system, int count, const double *x,
                       double *kx, double *mx, double *magnitude) {
  bw_status status = BW_OK;
  int word[2] = {count, mx != NULL};
  int64_t size = 3 * (int64_t)system->nodes;
  MPI_Bcast(word, 2, MPI_INT, 0, bwd_comm());
  count = word[0];
  int batch = count < BATCH ? count : BATCH;
  products p = {.local = &system->mesh};
  p.x = BW_NEW(context, double, 3 * (int64_t)system->mesh.count.nodes * batch);
  p.kx = BW_NEW(context, double, 3 * (int64_t)system->local * batch);
  if (word[1])
    p.mx = BW_NEW(context, double, 3 * (int64_t)system->local * batch);
  BW_TRY(bwd_agree(context, p.x && p.kx && (p.mx || !word[1]) ? BW_OK : BW_MEMORY));
  for (int v = 0; v < count; v += BATCH) {
    p.count = count - v < BATCH ? count - v : BATCH;
    BW_TRY(multiply_batch(context, system, &p, x ? x + v * size : NULL, kx ? kx + v * size : NULL,
                          mx ? mx + v * size : NULL, magnitude ? magnitude + v : NULL));
  }
done:
  bw_free(p.x);
  bw_free(p.kx);
  bw_free(p.mx);
  return status;
}
