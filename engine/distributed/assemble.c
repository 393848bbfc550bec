/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* The rank's rows of K and M, from the engine's own assembly. All elements around its nodes are
 * there, so the rows are complete and nothing is sent. */
#include <string.h>

#include "barwright/job.h"
#include "distributed/internal.h"

/* ---- how many -------------------------------------------------------------------------------- */

/* Blocks of each of the rank's rows whose columns are its own, and those of others; with `upper`
 * those of the upper triangle. `max` is of all. */
static bw_status count_blocks(bw_context *context, const bwd_local_mesh *local, bool upper,
                              int32_t *own, int32_t *other, int32_t *max) {
  bw_status status = BW_OK;
  const struct bwd_local_counts *n = &local->count;
  int width = n->nodes_per_element;
  int64_t *start = NULL;
  int32_t *around = NULL; /* elements of each own node */
  int32_t *seen = BW_NEW(context, int32_t, n->nodes);
  if (!seen)
    return BW_MEMORY;
  for (int32_t i = 0; i < n->nodes; i++)
    seen[i] = i < n->owned ? i : -1;
  BW_TRY(bwd_group_elements(context, n->elements, width, local->element, seen, n->owned, &start,
                            &around));
  memset(seen, -1, (size_t)n->nodes * sizeof *seen);
  *max = 0;
  for (int32_t i = 0; i < n->owned; i++) {
    int32_t all = own[i] = other[i] = 0;
    for (int64_t k = start[i]; k < start[i + 1]; k++) {
      const int32_t *node = local->element + (int64_t)around[k] * width;
      for (int a = 0; a < width; a++)
        if (seen[node[a]] != i) {
          seen[node[a]] = i;
          all++;
          if (!upper || local->row[node[a]] >= local->row[i])
            (node[a] < n->owned ? own : other)[i]++;
        }
    }
    *max = all > *max ? all : *max;
  }
done:
  bw_free(start);
  bw_free(around);
  bw_free(seen);
  return status;
}

/* The upper triangle in blocks of 3 x 3, or by entries with `width` of them for each block in a
 * row. */
static bw_status create_matrix(bw_context *context, int32_t rows, const int32_t *own,
                               const int32_t *other, bool blocked, int width, Mat *matrix) {
  bw_status status = BW_OK;
  PetscInt local = 3 * rows;
  PetscInt *diagonal = BW_NEW(context, PetscInt, local);
  PetscInt *off = BW_NEW(context, PetscInt, local);
  if (!diagonal || !off)
    status = BW_MEMORY;
  else
    for (PetscInt i = 0; i < (blocked ? rows : local); i++) {
      diagonal[i] = blocked ? own[i] : width * own[i / 3];
      off[i] = blocked ? other[i] : width * other[i / 3];
    }
  BW_TRY(bwd_agree(context, status));
  BWD_TRY(MatCreate(PETSC_COMM_WORLD, matrix));
  BWD_TRY(MatSetSizes(*matrix, local, local, PETSC_DETERMINE, PETSC_DETERMINE));
  BWD_TRY(MatSetBlockSize(*matrix, 3));
  BWD_TRY(MatSetType(*matrix, blocked ? MATSBAIJ : MATAIJ));
  /* Each of these does nothing to a matrix of another type. */
  BWD_TRY(MatSeqAIJSetPreallocation(*matrix, 0, diagonal));
  BWD_TRY(MatMPIAIJSetPreallocation(*matrix, 0, diagonal, 0, off));
  BWD_TRY(MatSeqSBAIJSetPreallocation(*matrix, 3, 0, diagonal));
  BWD_TRY(MatMPISBAIJSetPreallocation(*matrix, 3, 0, diagonal, 0, off));
  BWD_TRY(MatSetOption(*matrix, MAT_NEW_NONZERO_ALLOCATION_ERR, PETSC_TRUE));
  BWD_TRY(MatSetOption(*matrix, MAT_SYMMETRIC, PETSC_TRUE));
done:
  bw_free(diagonal);
  bw_free(off);
  return status;
}

/* What the matrices take is known before they are created. */
bw_status bwd_matrices_create(bw_context *context, const bwd_local_mesh *local, bool blocked,
                              int mass_width, Mat *stiffness, Mat *mass, int32_t *max) {
  bw_status status = BW_OK;
  int32_t rows = local->count.owned;
  int32_t *own = BW_NEW(context, int32_t, 2 * (int64_t)rows); /* of K, then of M */
  int32_t *other = BW_NEW(context, int32_t, 2 * (int64_t)rows);
  int64_t entries = 0, mass_entries = 0;
  if (!own || !other)
    status = BW_MEMORY;
  else
    status = count_blocks(context, local, blocked, own, other, max);
  if (status == BW_OK && mass_width)
    status = count_blocks(context, local, false, own + rows, other + rows, max);
  for (int32_t i = 0; status == BW_OK && i < rows; i++) {
    entries += 9 * ((int64_t)own[i] + other[i]);
    if (mass_width)
      mass_entries += mass_width * ((int64_t)own[rows + i] + other[rows + i]);
  }
  double available = bw_available_memory();
  double bytes = (blocked ? 76 / 9.0 : 12) * (double)entries + 12 * (double)mass_entries;
  int64_t larger = entries > mass_entries ? entries : mass_entries;
  if (larger > INT32_MAX)
    status = bw_fail(context, BW_LIMIT,
                     "rank %d would have %lld entries of the matrix; PETSc's 32-bit numbers count "
                     "to %d. Use more ranks",
                     bw_world_rank(), (long long)larger, INT32_MAX);
  else if (bytes * bwd_ranks_together() > available)
    status = bw_fail(context, BW_MEMORY,
                     "the matrices of rank %d take %.3g GB, and %.3g GB are free for the %d ranks "
                     "on its machine. Use more ranks on other machines",
                     bw_world_rank(), bytes / 1e9, available / 1e9, bwd_ranks_together());
  BW_TRY(bwd_agree(context, status));
  BW_TRY(create_matrix(context, rows, own, other, blocked, 3, stiffness));
  if (mass_width)
    BW_TRY(create_matrix(context, rows, own + rows, other + rows, false, mass_width == 9 ? 3 : 1,
                         mass));
done:
  bw_free(own);
  bw_free(other);
  return status;
}

/* ---- blocks ---------------------------------------------------------------------------------- */

/* A block of a row: `transposed` when it is stored as (column, row). Nodes by their local numbers.
 */
typedef struct neighbour {
  int32_t node;
  int64_t index;
  bool transposed;
} neighbour;

/* block = F_i K_ij F_j^T without prescribed components. */
static void stiffness_block(const bwd_piece *piece, int32_t i, const neighbour *n,
                            double block[9]) {
  const bwd_local_mesh *local = piece->local;
  const double *value = piece->stiffness + 9 * n->index;
  const double *left = bwd_local_frame(local, i), *right = bwd_local_frame(local, n->node);
  double k[9];
  for (int r = 0; r < 3; r++)
    for (int c = 0; c < 3; c++)
      k[3 * r + c] = n->transposed ? value[3 * c + r] : value[3 * r + c];
  if (right) {
    double rotated[9];
    for (int r = 0; r < 3; r++)
      bwd_into_frame(right, k + 3 * r, rotated + 3 * r);
    memcpy(k, rotated, sizeof k);
  }
  if (left) {
    double rotated[9];
    for (int r = 0; r < 3; r++)
      for (int c = 0; c < 3; c++)
        rotated[3 * r + c] =
            left[3 * r] * k[c] + left[3 * r + 1] * k[3 + c] + left[3 * r + 2] * k[6 + c];
    memcpy(k, rotated, sizeof k);
  }
  const uint8_t *row = local->state + 3 * (int64_t)i;
  const uint8_t *column = local->state + 3 * (int64_t)n->node;
  for (int r = 0; r < 3; r++)
    for (int c = 0; c < 3; c++) {
      bool diagonal = n->node == i && r == c;
      bool keep = diagonal || (row[r] != BW_DOF_PRESCRIBED && column[c] != BW_DOF_PRESCRIBED);
      block[3 * r + c] = keep ? k[3 * r + c] : 0;
    }
}

static void mass_block(const bwd_piece *piece, int32_t i, const neighbour *n, double block[9]) {
  const bwd_local_mesh *local = piece->local;
  double m = piece->mass[n->index];
  const uint8_t *row = local->state + 3 * (int64_t)i;
  const uint8_t *column = local->state + 3 * (int64_t)n->node;
  const double *left = bwd_local_frame(local, i), *right = bwd_local_frame(local, n->node);
  static const double global[9] = {1, 0, 0, 0, 1, 0, 0, 0, 1};
  left = left ? left : global;
  right = right ? right : global;
  for (int r = 0; r < 3; r++)
    for (int c = 0; c < 3; c++) {
      bool keep = row[r] != BW_DOF_PRESCRIBED && column[c] != BW_DOF_PRESCRIBED;
      double rotation = left == right ? r == c : bw_dot(left + 3 * r, right + 3 * c);
      block[3 * r + c] = keep ? m * rotation : 0;
    }
}

/* ---- rows ------------------------------------------------------------------------------------ */

typedef struct insertion {
  Mat stiffness, mass;
  int mass_width;
  neighbour *list;  /* max */
  PetscInt *column; /* max */
  double *value;    /* 9 x max */
  bool upper;       /* K has the upper triangle alone */
  int32_t rows;     /* done */
} insertion;

static int32_t row_neighbours(const bwd_piece *piece, int32_t i, neighbour *list) {
  const bw_block_pattern *pattern = piece->pattern;
  int32_t count = 0;
  for (int64_t k = pattern->start[i]; k < pattern->start[i + 1]; k++)
    list[count++] = (neighbour){piece->node[pattern->column[k]], k, false};
  for (int64_t k = pattern->upper_start[i]; k < pattern->upper_start[i + 1]; k++)
    list[count++] =
        (neighbour){piece->node[pattern->upper_row[k]], bw_upper_block(pattern, k), true};
  return count;
}

/* A row of M: whole blocks where there are frames, else their diagonals. */
static bw_status insert_mass(bw_context *context, const insertion *in, const bwd_piece *piece,
                             int32_t node, int32_t count) {
  bw_status status = BW_OK;
  PetscInt row = piece->local->row[node];
  double block[9];
  if (in->mass_width == 9) {
    for (int32_t n = 0; n < count; n++) {
      mass_block(piece, node, &in->list[n], block);
      for (int r = 0; r < 3; r++)
        memcpy(in->value + (int64_t)r * 3 * count + 3 * n, block + 3 * r, 3 * sizeof *block);
    }
    BWD_TRY(MatSetValuesBlocked(in->mass, 1, &row, count, in->column, in->value, INSERT_VALUES));
    return status;
  }
  for (int32_t n = 0; n < count; n++) {
    mass_block(piece, node, &in->list[n], block);
    for (int c = 0; c < 3; c++)
      in->value[(int64_t)c * count + n] = block[4 * c];
    in->column[n] *= 3;
  }
  for (int c = 0; c < 3; c++) {
    PetscInt one = 3 * row + c;
    BWD_TRY(MatSetValues(in->mass, 1, &one, count, in->column, in->value + (int64_t)c * count,
                         INSERT_VALUES));
    for (int32_t n = 0; n < count; n++)
      in->column[n]++;
  }
done:
  return status;
}

static bw_status insert(bw_context *context, void *data, const bwd_piece *piece) {
  bw_status status = BW_OK;
  insertion *in = data;
  const bwd_local_mesh *local = piece->local;
  for (int32_t i = 0; i < piece->rows; i++) {
    int32_t node = piece->first + i, count = row_neighbours(piece, i, in->list), kept = 0, k = 0;
    PetscInt row = local->row[node];
    for (int32_t n = 0; n < count; n++) {
      in->column[n] = local->row[in->list[n].node];
      kept += !in->upper || in->column[n] >= row;
    }
    if (piece->mass) {
      BW_TRY(insert_mass(context, in, piece, node, count));
      for (int32_t n = 0; n < count; n++)
        in->column[n] = local->row[in->list[n].node];
    }
    for (int32_t n = 0; n < count; n++) {
      double block[9];
      if (in->upper && in->column[n] < row)
        continue;
      stiffness_block(piece, node, &in->list[n], block);
      for (int r = 0; r < 3; r++)
        memcpy(in->value + (int64_t)r * 3 * kept + 3 * k, block + 3 * r, 3 * sizeof *block);
      in->column[k++] = in->column[n];
    }
    BWD_TRY(
        MatSetValuesBlocked(in->stiffness, 1, &row, kept, in->column, in->value, INSERT_VALUES));
  }
  in->rows += piece->rows;
  if (bw_world_rank() == 0)
    bw_progress(context, "assembly", (double)in->rows / local->count.owned);
done:
  return status;
}

bw_status bwd_assemble(bw_context *context, const bwd_local_mesh *local, int mass_width,
                       int32_t max, Mat stiffness, Mat mass) {
  bw_status status = BW_OK;
  insertion in = {.stiffness = stiffness,
                  .mass = mass,
                  .mass_width = mass_width,
                  .list = BW_NEW(context, neighbour, max),
                  .column = BW_NEW(context, PetscInt, max),
                  .value = BW_NEW(context, double, 9 * (int64_t)max)};
  PetscBool upper;
  BWD_TRY(PetscObjectTypeCompareAny((PetscObject)stiffness, &upper, MATSEQSBAIJ, MATMPISBAIJ, ""));
  in.upper = upper;
  status = in.list && in.column && in.value
               ? bwd_for_pieces(context, local, mass_width > 0, insert, &in)
               : BW_MEMORY;
  BW_TRY(bwd_agree(context, status));
  BWD_TRY(MatAssemblyBegin(stiffness, MAT_FINAL_ASSEMBLY));
  BWD_TRY(MatAssemblyEnd(stiffness, MAT_FINAL_ASSEMBLY));
  if (mass_width) {
    BWD_TRY(MatAssemblyBegin(mass, MAT_FINAL_ASSEMBLY));
    BWD_TRY(MatAssemblyEnd(mass, MAT_FINAL_ASSEMBLY));
  }
done:
  bw_free(in.list);
  bw_free(in.column);
  bw_free(in.value);
  return status;
}
