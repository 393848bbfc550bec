/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* Preconditioners of conjugate gradients that a bw_solver describes: block Jacobi over the nodes,
 * algebraic multigrid, and factors (pcg.h). */
#include "linear/pcg.h"

#include <string.h>

static void preconditioner_destroy(void *object) {
  bwi_preconditioner *m = object;
  bw_release(m->solver);
  bw_release(m->dof_map);
  bw_release(m->factor);
  bw_release(m->amg);
  bw_free(m->block);
  bw_free(m);
}

static size_t preconditioner_bytes(const void *object) {
  const bwi_preconditioner *m = object;
  size_t blocks = m->block ? 9 * (size_t)m->dof_map->mesh->node_count : 0;
  return sizeof *m + bw_bytes(m->factor) + bw_bytes(m->amg) + blocks * sizeof(double);
}

static const bw_kind preconditioner_kind = {"preconditioner", preconditioner_destroy,
                                            preconditioner_bytes};

const bwi_kernels *bwi_kernels_of(const bw_solver *solver) {
  if (solver && solver->options.backend == BW_BACKEND_CHOLMOD)
    return &bwi_kernels_cholmod;
  if (solver && solver->options.precision == 32)
    return &bwi_kernels_single;
  return &bwi_kernels_double;
}

/* ---- block Jacobi ---------------------------------------------------------------------------- */

/* A pivot below this fraction of its diagonal entry has no digits left (as in front.c). */
#define WEAKEST 1e-13

typedef struct blocks {
  const bwi_matrix *matrix;
  double *block;
  int32_t bad; /* the first node whose block is not positive definite, or INT32_MAX */
} blocks;

static bw_status invert_blocks(void *data, int64_t begin, int64_t end, int worker) {
  (void)worker;
  blocks *b = data;
  for (int64_t i = begin; i < end; i++) {
    int64_t diagonal = b->matrix->pattern->start[i + 1] - 1; /* the last of its row */
    if (!bwi_invert_node_block(b->matrix->dof_map, i, 1u << BW_DOF_UNKNOWN, WEAKEST,
                               b->matrix->stiffness + 9 * diagonal, b->block + 9 * i)) {
      int32_t old = __atomic_load_n(&b->bad, __ATOMIC_RELAXED);
      while (i < old && !__atomic_compare_exchange_n(&b->bad, &old, (int32_t)i, false,
                                                     __ATOMIC_RELAXED, __ATOMIC_RELAXED))
        ;
    }
  }
  return BW_OK;
}

enum { GRAIN = 2048 };

static bw_status make_blocks(bw_context *context, const bwi_matrix *matrix, bwi_preconditioner *m,
                             int32_t *bad_node) {
  int64_t nodes = matrix->pattern->node_count;
  blocks b = {.matrix = matrix, .bad = INT32_MAX};
  m->block = b.block = BW_NEW(context, double, 9 * nodes);
  if (!b.block)
    return BW_MEMORY;
  bw_status status = bw_parallel(context, nodes, GRAIN, invert_blocks, &b);
  if (status != BW_OK || b.bad == INT32_MAX)
    return status;
  *bad_node = b.bad;
  return bw_fail(context, BW_SINGULAR, "the block of node %d is not positive definite", b.bad + 1);
}

typedef struct application {
  const bwi_preconditioner *m;
  int64_t count, size;
  const double *r;
  double *z;
} application;

static bw_status apply_blocks(void *data, int64_t begin, int64_t end, int worker) {
  (void)worker;
  const application *a = data;
  for (int64_t i = begin; i < end; i++)
    for (int64_t k = 0; k < a->count; k++) {
      const double *block = a->m->block + 9 * i, *r = a->r + k * a->size + 3 * i;
      double *z = a->z + k * a->size + 3 * i;
      for (int c = 0; c < 3; c++)
        z[c] = bw_dot(block + 3 * c, r);
    }
  return BW_OK;
}

/* ---- any of them ----------------------------------------------------------------------------- */

bw_status bwi_preconditioner_create(bw_context *context, const bw_solver *solver,
                                    const bwi_matrix *matrix, bwi_symbolic *symbolic,
                                    bwi_preconditioner **out, int32_t *bad_node) {
  bw_status status = BW_OK;
  bwi_preconditioner *m = BW_NEW0(context, bwi_preconditioner, 1);
  if (!m)
    return BW_MEMORY;
  bw_object_init(m, &preconditioner_kind);
  m->solver = bw_retain(solver);
  m->dof_map = bw_retain(matrix->dof_map);
  if (solver->options.kind == BW_SOLVER_JACOBI)
    BW_TRY(make_blocks(context, matrix, m, bad_node));
  else if (solver->options.kind == BW_SOLVER_AMG)
    BW_TRY(bwi_amg_create(context, matrix, true, &m->amg));
  else
    BW_TRY(bwi_factor_create_in(context, symbolic, matrix, NULL, bwi_kernels_of(solver), &m->factor,
                                bad_node));
done:
  if (status == BW_OK)
    *out = m;
  else
    bw_release(m);
  return status;
}

bool bwi_preconditioner_serves(const bwi_preconditioner *m, const bw_solver *solver) {
  bool amg = !solver || solver->options.kind == BW_SOLVER_AMG;
  return m && (m->solver == solver || (m->amg && amg));
}

bw_status bwi_factor_precondition(bw_context *context, void *data, int64_t count, const double *r,
                                  double *z) {
  const bwi_factor_preconditioner *m = data;
  return bwi_solve_fields(context, m->factor, m->dof_map, count, r, z);
}

bw_status bwi_preconditioner_apply(bw_context *context, void *data, int64_t count, const double *r,
                                   double *z) {
  const bwi_preconditioner *m = data;
  int64_t nodes = m->dof_map->mesh->node_count;
  if (m->factor)
    return bwi_solve_fields(context, m->factor, m->dof_map, count, r, z);
  if (m->amg)
    return bwi_amg_apply(context, m->amg, count, r, z);
  application a = {.m = m, .count = count, .size = 3 * nodes, .r = r, .z = z};
  return bw_parallel(context, nodes, GRAIN, apply_blocks, &a);
}
