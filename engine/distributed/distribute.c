/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* A system of rank 0 to all ranks: what each must know, its matrices, masks and motions. */
#include <string.h>

#include "distributed/internal.h"

/* Blocks of each row whose columns are on its own rank, and on others. */
static bw_status count_blocks(bw_context *context, bwd_system *system, int32_t **own,
                              int32_t **other, int32_t *max) {
  const bw_block_pattern *pattern = system->matrix->pattern;
  int32_t *a = *own = BW_NEW0(context, int32_t, system->nodes);
  int32_t *b = *other = BW_NEW0(context, int32_t, system->nodes);
  int32_t *rank_of = BW_NEW(context, int32_t, system->nodes); /* by row */
  if (!a || !b || !rank_of) {
    bw_free(rank_of);
    return BW_MEMORY;
  }
  for (int r = 0; r < system->ranks; r++)
    for (int32_t i = system->start[r]; i < system->start[r + 1]; i++)
      rank_of[i] = r;
  for (int32_t i = 0; i < system->nodes; i++) {
    int32_t row = system->row_of[i];
    for (int64_t k = pattern->start[i]; k < pattern->start[i + 1]; k++) {
      int32_t column = system->row_of[pattern->column[k]];
      int32_t *count = rank_of[row] == rank_of[column] ? a : b;
      count[row]++;
      if (column != row)
        count[column]++;
    }
  }
  *max = 0;
  for (int32_t i = 0; i < system->nodes; i++)
    *max = a[i] + b[i] > *max ? a[i] + b[i] : *max;
  bw_free(rank_of);
  return BW_OK;
}

static bw_status create_matrix(bw_context *context, bwd_system *system, const int32_t *own,
                               const int32_t *other, int width, Mat *matrix) {
  bw_status status = BW_OK;
  PetscInt local = 3 * system->local, size = 3 * system->nodes;
  PetscInt *diagonal = BW_NEW(context, PetscInt, local);
  PetscInt *off = BW_NEW(context, PetscInt, local);
  if (!diagonal || !off)
    status = BW_MEMORY;
  else
    for (PetscInt i = 0; i < local; i++) {
      diagonal[i] = width * own[i / 3];
      off[i] = width * other[i / 3];
    }
  BW_TRY(bwd_agree(context, status));
  BWD_TRY(MatCreate(PETSC_COMM_WORLD, matrix));
  BWD_TRY(MatSetSizes(*matrix, local, local, size, size));
  BWD_TRY(MatSetBlockSize(*matrix, 3));
  BWD_TRY(MatSetType(*matrix, MATAIJ));
  if (system->ranks == 1)
    BWD_TRY(MatSeqAIJSetPreallocation(*matrix, 0, diagonal));
  else
    BWD_TRY(MatMPIAIJSetPreallocation(*matrix, 0, diagonal, 0, off));
  BWD_TRY(MatSetOption(*matrix, MAT_NEW_NONZERO_ALLOCATION_ERR, PETSC_TRUE));
  BWD_TRY(MatSetOption(*matrix, MAT_SYMMETRIC, PETSC_TRUE));
done:
  bw_free(diagonal);
  bw_free(off);
  return status;
}

/* What every rank must know before the rows come. */
typedef struct plan {
  int32_t nodes, motions, max;
  int mass_width, method, iterations;
  double rtol;
} plan;

static bw_status make_plan(bw_context *context, bwd_system *system, int32_t **own, int32_t **other,
                           plan *p) {
  bw_status status = BW_OK;
  const bw_external_matrix *m = system->matrix;
  system->nodes = m->pattern->node_count;
  if (system->nodes > INT32_MAX / 3 - 1)
    return bw_fail(context, BW_LIMIT,
                   "%d nodes: PETSc's 32-bit numbers allow %d at most; take larger elements",
                   (int)system->nodes, INT32_MAX / 3 - 1);
  system->row_of = BW_NEW(context, int32_t, system->nodes);
  system->field = BW_NEW(context, double, 3 * (int64_t)system->nodes);
  system->counts = BW_NEW(context, int, system->ranks);
  system->where = BW_NEW(context, int, system->ranks);
  if (!system->row_of || !system->field || !system->counts || !system->where)
    return BW_MEMORY;
  BW_TRY(bwd_partition(context, m->pattern, system->ranks, system->row_of, system->start));
  BW_TRY(count_blocks(context, system, own, other, &p->max));
  for (int r = 0; r < system->ranks; r++) {
    int64_t entries = 0;
    for (int32_t i = system->start[r]; i < system->start[r + 1]; i++)
      entries += 9 * ((int64_t)(*own)[i] + (*other)[i]);
    if (entries > INT32_MAX)
      return bw_fail(context, BW_LIMIT,
                     "rank %d would have %lld entries of the matrix; PETSc's 32-bit numbers count "
                     "to %d. Use more ranks",
                     r, (long long)entries, INT32_MAX);
    system->counts[r] = 3 * (system->start[r + 1] - system->start[r]);
    system->where[r] = 3 * system->start[r];
  }
  p->nodes = system->nodes;
  p->motions = m->dof_map->rigid_mode_count;
  p->mass_width = !m->mass ? 0 : m->dof_map->frame_count > 0 ? 9 : 3;
  p->method = system->options.method;
  p->iterations = system->options.iterations;
  p->rtol = system->options.rtol;
done:
  return status;
}

/* The rigid-body motions R and W R of rank 0's DOF map. */
static bw_status distribute_motions(bw_context *context, bwd_system *system) {
  bw_status status = BW_OK;
  double *field = NULL, *one = NULL;
  if (system->motions == 0)
    return BW_OK;
  if (system->rank == 0) {
    field = BW_NEW(context, double, 3 * (int64_t)system->nodes);
    one = BW_NEW0(context, double, system->motions);
    if (!field || !one)
      status = BW_MEMORY;
  }
  BW_TRY(bwd_agree(context, status));
  BWD_TRY(VecDuplicateVecs(system->force, system->motions, &system->motion));
  BWD_TRY(VecDuplicateVecs(system->force, system->motions, &system->weighted));
  for (int m = 0; m < system->motions; m++) {
    if (system->rank == 0) {
      const bw_dof_map *dof_map = system->matrix->dof_map;
      one[m] = 1;
      memset(field, 0, 3 * (size_t)system->nodes * sizeof *field);
      bw_rigid_modes_add(dof_map, one, field);
    }
    BW_TRY(bwd_scatter(context, system, field, system->motion[m]));
    if (system->rank == 0) {
      bw_rigid_modes_weighted(system->matrix->dof_map, one, field);
      one[m] = 0;
    }
    BW_TRY(bwd_scatter(context, system, field, system->weighted[m]));
  }
done:
  bw_free(field);
  bw_free(one);
  return status;
}

/* 1 where a component is solved for. */
static bw_status distribute_mask(bw_context *context, bwd_system *system) {
  if (system->rank == 0) {
    const bw_dof_map *dof_map = system->matrix->dof_map;
    for (int64_t i = 0; i < system->nodes; i++)
      for (int c = 0; c < 3; c++) {
        uint8_t state = dof_map->state[3 * i + c];
        bool solved = state == BW_DOF_UNKNOWN || (state == BW_DOF_ISOSTATIC && !system->direct);
        system->field[3 * (int64_t)system->row_of[i] + c] = solved;
      }
  }
  return bwd_spread(context, system, system->mask);
}

bw_status bwd_distribute(bw_context *context, bwd_system *system) {
  bw_status status = BW_OK;
  int32_t *own = NULL, *other = NULL, *own_all = NULL, *other_all = NULL;
  plan p = {0};
  double begin = bw_seconds();
  system->start = BW_NEW0(context, int32_t, (int64_t)system->ranks + 1);
  if (!system->start)
    status = BW_MEMORY;
  else if (system->rank == 0)
    status = make_plan(context, system, &own_all, &other_all, &p);
  BW_TRY(bwd_agree(context, status));
  MPI_Bcast(&p, sizeof p, MPI_BYTE, 0, bwd_comm());
  MPI_Bcast(system->start, system->ranks + 1, MPI_INT, 0, bwd_comm());
  system->nodes = p.nodes;
  system->motions = p.motions;
  system->mass_width = p.mass_width;
  system->options =
      (bw_external_options){.method = p.method, .iterations = p.iterations, .rtol = p.rtol};
  system->direct = p.method == BW_EXTERNAL_CHOLESKY;
  system->first = system->start[system->rank];
  system->local = system->start[system->rank + 1] - system->first;

  own = BW_NEW(context, int32_t, system->local);
  other = BW_NEW(context, int32_t, system->local);
  BW_TRY(bwd_agree(context, own && other ? BW_OK : BW_MEMORY));
  int *nodes_of = system->counts, *begin_of = system->where; /* a third of what they hold */
  for (int r = 0; system->rank == 0 && r < system->ranks; r++) {
    nodes_of[r] /= 3;
    begin_of[r] /= 3;
  }
  MPI_Scatterv(own_all, nodes_of, begin_of, MPI_INT, own, system->local, MPI_INT, 0, bwd_comm());
  MPI_Scatterv(other_all, nodes_of, begin_of, MPI_INT, other, system->local, MPI_INT, 0,
               bwd_comm());
  for (int r = 0; system->rank == 0 && r < system->ranks; r++) {
    nodes_of[r] *= 3;
    begin_of[r] *= 3;
  }
  BW_TRY(create_matrix(context, system, own, other, 3, &system->K));
  if (system->mass_width)
    BW_TRY(create_matrix(context, system, own, other, system->mass_width == 9 ? 3 : 1, &system->M));
  BW_TRY(bwd_send_rows(context, system, p.max));
  BWD_TRY(MatAssemblyBegin(system->K, MAT_FINAL_ASSEMBLY));
  BWD_TRY(MatAssemblyEnd(system->K, MAT_FINAL_ASSEMBLY));
  if (system->M) {
    BWD_TRY(MatAssemblyBegin(system->M, MAT_FINAL_ASSEMBLY));
    BWD_TRY(MatAssemblyEnd(system->M, MAT_FINAL_ASSEMBLY));
  }
  BWD_TRY(MatCreateVecs(system->K, &system->displacement, &system->force));
  BWD_TRY(VecDuplicate(system->force, &system->mask));
  BW_TRY(distribute_mask(context, system));
  BW_TRY(distribute_motions(context, system));
  system->seconds_send = bw_seconds() - begin;
done:
  bw_free(own);
  bw_free(other);
  bw_free(own_all);
  bw_free(other_all);
  return status;
}
