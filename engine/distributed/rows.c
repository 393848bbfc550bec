/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* Rows of K and M from rank 0 to the ranks, in pieces of a few megabytes: rank 0 never
 * holds a second copy of K, and no message has more bytes than an int can count. */
#include <string.h>

#include "distributed/internal.h"

enum { ROW_TAG = 2, PIECE_BLOCKS = 32768 };

/* A run of rows: per row its number of blocks; per block its column; per row its 3 x 3n numbers
 * of K, row by row, and `mass_width` numbers per block of M. */
typedef struct piece {
  int32_t rows, blocks;
  int32_t *length, *column;
  double *stiffness, *mass;
} piece;

static size_t piece_bytes(const bwd_system *system, int64_t blocks) {
  return (size_t)blocks * (9 + (size_t)system->mass_width) * sizeof(double) +
         (2 + 2 * (size_t)blocks) * sizeof(int32_t);
}

/* Where the parts lie in a buffer: numbers first, for their alignment. Every row has a block. */
static void lay_out(const bwd_system *system, void *buffer, int64_t capacity, piece *p) {
  double *numbers = buffer;
  p->stiffness = numbers;
  p->mass = numbers + 9 * capacity;
  int32_t *words = (int32_t *)(p->mass + system->mass_width * capacity);
  p->length = words + 2;
  p->column = p->length + capacity;
}

/* An index and the block it stands for, seen from the row: `transposed` when stored as (k, i). */
typedef struct neighbour {
  int32_t column, node;
  int64_t index;
  bool transposed;
} neighbour;

static int32_t row_neighbours(const bwd_system *system, int32_t node, neighbour *list) {
  const bw_block_pattern *pattern = system->matrix->pattern;
  int32_t count = 0;
  for (int64_t k = pattern->start[node]; k < pattern->start[node + 1]; k++)
    list[count++] = (neighbour){system->row_of[pattern->column[k]], pattern->column[k], k, false};
  for (int64_t k = pattern->upper_start[node]; k < pattern->upper_start[node + 1]; k++)
    list[count++] = (neighbour){system->row_of[pattern->upper_row[k]], pattern->upper_row[k],
                                pattern->upper_block[k], true};
  for (int32_t a = 1; a < count; a++) { /* a few dozen */
    neighbour moving = list[a];
    int32_t b = a;
    for (; b > 0 && list[b - 1].column > moving.column; b--)
      list[b] = list[b - 1];
    list[b] = moving;
  }
  return count;
}

/* block = F_i K_ij F_j^T without prescribed components. */
static void stiffness_block(const bwd_system *system, int32_t i, const neighbour *n,
                            double block[9]) {
  const bw_dof_map *dof_map = system->matrix->dof_map;
  const double *value = system->matrix->stiffness + 9 * n->index;
  const double *left = bwd_frame_at(dof_map, i), *right = bwd_frame_at(dof_map, n->node);
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
  const uint8_t *row = dof_map->state + 3 * (int64_t)i;
  const uint8_t *column = dof_map->state + 3 * (int64_t)n->node;
  for (int r = 0; r < 3; r++)
    for (int c = 0; c < 3; c++) {
      bool diagonal = n->node == i && r == c;
      bool keep = diagonal || (row[r] != BW_DOF_PRESCRIBED && column[c] != BW_DOF_PRESCRIBED);
      block[3 * r + c] = keep ? k[3 * r + c] : 0;
    }
}

static void mass_block(const bwd_system *system, int32_t i, const neighbour *n, double *block) {
  const bw_dof_map *dof_map = system->matrix->dof_map;
  double m = system->matrix->mass[n->index];
  const uint8_t *row = dof_map->state + 3 * (int64_t)i;
  const uint8_t *column = dof_map->state + 3 * (int64_t)n->node;
  const double *left = bwd_frame_at(dof_map, i), *right = bwd_frame_at(dof_map, n->node);
  static const double global[9] = {1, 0, 0, 0, 1, 0, 0, 0, 1};
  left = left ? left : global;
  right = right ? right : global;
  for (int r = 0; r < 3; r++)
    for (int c = 0; c < 3; c++) {
      bool keep = row[r] != BW_DOF_PRESCRIBED && column[c] != BW_DOF_PRESCRIBED;
      double value = keep ? m * (left == right ? r == c : bw_dot(left + 3 * r, right + 3 * c)) : 0;
      if (system->mass_width == 9)
        block[3 * r + c] = value;
      else if (r == c)
        block[r] = value;
    }
}

/* Rows from `next` on, up to `end`, as many as fit. */
static void pack(const bwd_system *system, const int32_t *node_at, int32_t *next, int32_t end,
                 int64_t capacity, neighbour *list, piece *p) {
  p->rows = p->blocks = 0;
  for (; *next < end; (*next)++) {
    int32_t node = node_at[*next];
    const bw_block_pattern *pattern = system->matrix->pattern;
    int64_t expected = pattern->start[node + 1] - pattern->start[node] +
                       pattern->upper_start[node + 1] - pattern->upper_start[node];
    if (p->blocks + expected > capacity)
      return;
    int32_t count = row_neighbours(system, node, list);
    double *k = p->stiffness + 9 * (int64_t)p->blocks;
    for (int32_t n = 0; n < count; n++) {
      double block[9];
      stiffness_block(system, node, &list[n], block);
      for (int r = 0; r < 3; r++)
        memcpy(k + (int64_t)r * 3 * count + 3 * n, block + 3 * r, 3 * sizeof *k);
      p->column[p->blocks + n] = list[n].column;
      if (system->mass_width)
        mass_block(system, node, &list[n], p->mass + system->mass_width * ((int64_t)p->blocks + n));
    }
    p->length[p->rows++] = count;
    p->blocks += count;
  }
}

static bw_status insert_mass(bw_context *context, bwd_system *system, int32_t row, int32_t count,
                             const int32_t *column, const double *mass, PetscInt *at,
                             double *value) {
  bw_status status = BW_OK;
  if (system->mass_width == 9) {
    for (int32_t n = 0; n < count; n++)
      for (int r = 0; r < 3; r++)
        memcpy(value + (int64_t)r * 3 * count + 3 * n, mass + 9 * (int64_t)n + 3 * r,
               3 * sizeof *value);
    BWD_TRY(MatSetValuesBlocked(system->M, 1, &row, count, column, value, INSERT_VALUES));
    return status;
  }
  for (int c = 0; c < 3; c++) {
    PetscInt one = 3 * row + c;
    for (int32_t n = 0; n < count; n++) {
      at[n] = 3 * column[n] + c;
      value[n] = mass[3 * (int64_t)n + c];
    }
    BWD_TRY(MatSetValues(system->M, 1, &one, count, at, value, INSERT_VALUES));
  }
done:
  return status;
}

static bw_status insert(bw_context *context, bwd_system *system, const piece *p, int32_t row,
                        int32_t max, PetscInt *at, double *value) {
  bw_status status = BW_OK;
  int64_t block = 0;
  for (int32_t i = 0; i < p->rows; i++, row++) {
    int32_t count = p->length[i];
    if (count > max)
      return bw_fail(context, BW_INTERNAL, "a row of %d blocks was received; at most %d expected",
                     count, max);
    BWD_TRY(MatSetValuesBlocked(system->K, 1, &row, count, p->column + block,
                                p->stiffness + 9 * block, INSERT_VALUES));
    if (system->mass_width)
      BW_TRY(insert_mass(context, system, row, count, p->column + block,
                         p->mass + system->mass_width * block, at, value));
    block += count;
  }
done:
  return status;
}

/* All rows: rank 0 packs, sends and inserts its own; the others receive and insert. A rank that
 * fails goes on receiving, so that rank 0 is not stopped in a send. */
bw_status bwd_send_rows(bw_context *context, bwd_system *system, int32_t max) {
  bw_status status = BW_OK;
  int64_t capacity = max > PIECE_BLOCKS ? max : PIECE_BLOCKS;
  size_t bytes = piece_bytes(system, capacity);
  char *buffer = BW_NEW(context, char, bytes);
  PetscInt *at = BW_NEW(context, PetscInt, max);
  double *value = BW_NEW(context, double, 9 * (int64_t)max);
  neighbour *list = NULL;
  int32_t *node_at = NULL;
  piece p = {0};
  if (!buffer || !at || !value)
    status = BW_MEMORY;
  if (system->rank == 0 && status == BW_OK) {
    list = BW_NEW(context, neighbour, max);
    node_at = BW_NEW(context, int32_t, system->nodes);
    if (!list || !node_at)
      status = BW_MEMORY;
  }
  BW_TRY(bwd_agree(context, status)); /* from here on every rank has room */
  lay_out(system, buffer, capacity, &p);
  int32_t *head = p.length - 2;
  if (system->rank == 0) {
    for (int32_t i = 0; i < system->nodes; i++)
      node_at[system->row_of[i]] = i;
    for (int r = 0; r < system->ranks; r++) {
      int32_t next = system->start[r], end = system->start[r + 1];
      while (next < end) {
        int32_t first = next;
        pack(system, node_at, &next, end, capacity, list, &p);
        head[0] = p.rows;
        head[1] = p.blocks;
        if (r > 0)
          MPI_Send(buffer, (int)bytes, MPI_BYTE, r, ROW_TAG, bwd_comm());
        else if (status == BW_OK)
          status = insert(context, system, &p, first, max, at, value);
      }
    }
  } else {
    int32_t row = system->first, end = row + system->local;
    while (row < end) {
      bwd_backoff backoff = {0};
      for (int there = 0;;) {
        MPI_Iprobe(0, ROW_TAG, bwd_comm(), &there, MPI_STATUS_IGNORE);
        if (there)
          break;
        bwd_pause(&backoff);
      }
      MPI_Recv(buffer, (int)bytes, MPI_BYTE, 0, ROW_TAG, bwd_comm(), MPI_STATUS_IGNORE);
      p.rows = head[0];
      p.blocks = head[1];
      if (status == BW_OK)
        status = insert(context, system, &p, row, max, at, value);
      row += p.rows;
    }
  }
  status = bwd_agree(context, status);
done:
  bw_free(buffer);
  bw_free(at);
  bw_free(value);
  bw_free(list);
  bw_free(node_at);
  return status;
}
