/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* The matrices of a system by compressed rows, and vectors of its unknowns. */
#include <string.h>

#include "linear/internal.h"

typedef struct copy {
  const bw_system *system;
  const bw_dof_map *dof_map; /* NULL: all components, without frames */
  const double *mass;        /* NULL: the stiffness */
  int64_t *start;            /* rows + 1 */
  int32_t *column;
  double *value;
} copy;

/* The number of component k of a node, or -1. */
static int32_t number_of(const copy *c, int32_t node, int k) {
  return c->dof_map ? c->dof_map->unknown[3 * (int64_t)node + k] : 3 * node + k;
}

/* A stored block, row >= column by nodes, in the frames of its nodes. Of blocks on the diagonal the
 * lower triangle counts: rounding in frames must not make the matrix unsymmetric. */
static void block_of(const copy *c, int64_t index, int32_t row, int32_t column, double block[9]) {
  if (c->mass) {
    memset(block, 0, 9 * sizeof *block);
    for (int k = 0; k < 3; k++)
      block[4 * k] = c->mass[index];
  } else {
    memcpy(block, c->system->stiffness + 9 * index, 9 * sizeof *block);
  }
  if (c->dof_map && c->dof_map->frame_count > 0)
    bwi_rotate_block(c->dof_map, row, column, block);
  if (row == column)
    for (int i = 0; i < 3; i++)
      for (int j = 0; j < i; j++)
        block[3 * j + i] = block[3 * i + j];
}

static int32_t unknowns_of(const copy *c, int32_t node) {
  int32_t count = 0;
  for (int k = 0; k < 3; k++)
    count += number_of(c, node, k) >= 0;
  return count;
}

static void count_entries(const copy *c, int64_t rows) {
  const bw_block_pattern *p = c->system->pattern;
  memset(c->start, 0, ((size_t)rows + 1) * sizeof *c->start);
  for (int32_t i = 0; i < p->node_count; i++) {
    int64_t count = 0;
    for (int64_t b = p->start[i]; b < p->start[i + 1]; b++)
      count += unknowns_of(c, p->column[b]);
    for (int64_t b = p->upper_start[i]; b < p->upper_start[i + 1]; b++)
      count += unknowns_of(c, p->upper_row[b]);
    for (int k = 0; k < 3; k++)
      if (number_of(c, i, k) >= 0)
        c->start[number_of(c, i, k) + 1] = count;
  }
  for (int64_t i = 0; i < rows; i++)
    c->start[i + 1] += c->start[i];
}

/* Appends the part of a block that belongs to the rows of node i; `at`: where each row goes on. */
static void append(const copy *c, int64_t at[3], int32_t i, int32_t other, const double block[9],
                   bool transposed) {
  for (int r = 0; r < 3; r++) {
    if (number_of(c, i, r) < 0)
      continue;
    for (int s = 0; s < 3; s++) {
      int32_t column = number_of(c, other, s);
      if (column < 0)
        continue;
      c->column[at[r]] = column;
      c->value[at[r]++] = block[transposed ? 3 * s + r : 3 * r + s];
    }
  }
}

static bw_status fill_rows(void *data, int64_t begin, int64_t end, int worker) {
  const copy *c = (const copy *)data;
  const bw_block_pattern *p = c->system->pattern;
  double block[9];
  (void)worker;
  for (int32_t i = (int32_t)begin; i < end; i++) {
    int64_t at[3];
    for (int k = 0; k < 3; k++)
      at[k] = number_of(c, i, k) >= 0 ? c->start[number_of(c, i, k)] : 0;
    for (int64_t b = p->start[i]; b < p->start[i + 1]; b++) {
      block_of(c, b, i, p->column[b], block);
      append(c, at, i, p->column[b], block, false);
    }
    for (int64_t b = p->upper_start[i]; b < p->upper_start[i + 1]; b++) {
      block_of(c, bw_upper_block(p, b), p->upper_row[b], i, block);
      append(c, at, i, p->upper_row[b], block, true);
    }
  }
  return BW_OK;
}

bw_status bw_system_matrix(bw_context *context, bw_system *system, bw_system_part part, bool whole,
                           bw_sparse_matrix **matrix) {
  enum { NODES_PER_CHUNK = 512 };
  bw_status status = BW_OK;
  copy c = {.system = system, .dof_map = whole ? NULL : system->dof_map};
  int64_t rows = whole ? 3 * (int64_t)system->mesh->node_count : system->dof_map->unknown_count;
  BW_TRY(bw_system_stiffness(context, system));
  if (part != BW_STIFFNESS && part != BW_MASS)
    return bw_fail(context, BW_INVALID, "part %d of a system is not known", (int)part);
  if (part == BW_MASS && !system->mass)
    return bw_fail(context, BW_INVALID, "the system has no mass yet: it was made for one solution");
  if (rows >= INT32_MAX)
    return bw_fail(context, BW_LIMIT, "a matrix of %lld rows: fewer than 2^31 - 1 are possible",
                   (long long)rows);
  c.mass = part == BW_MASS ? system->mass : NULL;
  c.start = BW_NEW(context, int64_t, rows + 1);
  if (!c.start)
    return BW_MEMORY;
  count_entries(&c, rows);
  c.column = BW_NEW(context, int32_t, c.start[rows] + 1);
  c.value = BW_NEW(context, double, c.start[rows] + 1);
  BW_TRY_MEMORY(c.column && c.value);
  BW_TRY(bw_parallel(context, system->mesh->node_count, NODES_PER_CHUNK, fill_rows, &c));
  BW_TRY(bw_sparse_matrix_adopt(context, (int32_t)rows, (int32_t)rows, c.start, c.column, c.value,
                                matrix));
  c = (copy){0};
done:
  bw_free(c.start);
  bw_free(c.column);
  bw_free(c.value);
  return status;
}

/* Component k of a vector at a node, in the node's frame. */
static double along(const bw_dof_map *dof_map, int32_t node, int k, const double v[3]) {
  int32_t frame = dof_map->frame_of[node];
  return frame < 0 ? v[k] : bw_dot(dof_map->frame + 9 * (int64_t)frame + 3 * k, v);
}

void bw_system_displacement(const bw_system *system, const double *x, double *displacement) {
  const bw_dof_map *dof_map = system->dof_map;
  for (int32_t i = 0; i < system->mesh->node_count; i++) {
    double local[3], *u = displacement + 3 * (int64_t)i;
    int32_t frame = dof_map->frame_of[i];
    for (int k = 0; k < 3; k++) {
      int32_t unknown = dof_map->unknown[3 * (int64_t)i + k];
      local[k] = unknown < 0 ? dof_map->value[3 * (int64_t)i + k] : x[unknown];
    }
    for (int k = 0; k < 3; k++) {
      u[k] = frame < 0 ? local[k] : 0;
      for (int r = 0; r < 3 && frame >= 0; r++)
        u[k] += dof_map->frame[9 * (int64_t)frame + 3 * r + k] * local[r];
    }
  }
}

bw_status bw_system_right_hand_side(bw_context *context, bw_system *system, const double *force,
                                    double *b) {
  const bw_dof_map *dof_map = system->dof_map;
  bw_status status = BW_OK;
  size_t n = 3 * (size_t)system->mesh->node_count;
  double *rest = BW_NEW(context, double, n);
  double *u = BW_NEW(context, double, n), *product = BW_NEW(context, double, n);
  BW_TRY_MEMORY(rest && u && product);
  memcpy(rest, force, n * sizeof *rest);
  if (dof_map->prescribed) {
    BW_TRY(bwi_need_equations(context, system));
    bwi_prescribed_field(dof_map, u);
    BW_TRY(bwi_system_multiply(context, system, 1, u, product, NULL));
    for (size_t k = 0; k < n; k++)
      rest[k] -= product[k];
  }
  for (int32_t i = 0; i < system->mesh->node_count; i++)
    for (int k = 0; k < 3; k++) {
      int32_t unknown = dof_map->unknown[3 * (int64_t)i + k];
      if (unknown >= 0)
        b[unknown] = along(dof_map, i, k, rest + 3 * (int64_t)i);
    }
done:
  bw_free(rest);
  bw_free(u);
  bw_free(product);
  return status;
}
