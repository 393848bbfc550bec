/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* How the rows of smoother.h are ordered, and what stands in them. */
#include <math.h>
#include <string.h>

#include "assemble/internal.h"
#include "linear/smoother_blocks.h"

enum { ROWS = BWI_SMOOTHER_ROWS };

/* ---- the matrix ---------------------------------------------------------------------------- */

typedef struct taking {
  bwi_smoother *s;
  const double *stiffness;
  const bw_dof_map *dof_map;
} taking;

static const int of_six[6] = {0, 1, 2, 4, 5, 8}; /* of the nine of a block */

static void take_even(const taking *t, int64_t k, int64_t e) {
  const bwi_smoother_part *even = &t->s->even;
  bool across;
  const double *block = t->stiffness + 9 * bwi_smoother_block(t->s, even, k, e, &across);
  for (int c = 0; c < 6; c++) {
    int n = of_six[c];
    double number = 0.5 * t->s->unit * (block[n] + block[3 * (n % 3) + n / 3]);
    even->value[6 * e + c] = bwi_smoother_halves(number, &even->rest[6 * e + c]);
  }
}

static void take_odd(const taking *t, int64_t k, int64_t e) {
  const bwi_smoother_part *odd = &t->s->odd;
  bool across;
  const double *block = t->stiffness + 9 * bwi_smoother_block(t->s, odd, k, e, &across);
  for (int c = 0; c < 9; c++) {
    uint32_t rest;
    double number = t->s->unit * block[across ? c : 3 * (c % 3) + c / 3];
    odd->value[9 * e + c] = bwi_smoother_halves(number, odd->rest ? &odd->rest[9 * e + c] : &rest);
  }
}

/* The blocks on and left of the diagonal; an inverse that there is not is NAN. */
static bw_status take(void *data, int64_t begin, int64_t end, int worker) {
  (void)worker;
  const taking *t = data;
  const bwi_smoother *s = t->s;
  for (int64_t k = begin; k < end; k++) {
    int64_t i = s->node[k];
    const double *own = t->stiffness + 9 * (s->pattern->start[i + 1] - 1); /* the last of its row */
    double inverse[9];
    bool sound = bwi_invert_node_block(t->dof_map, i, 1u << BW_DOF_UNKNOWN | 1u << BW_DOF_ISOSTATIC,
                                       0, own, inverse);
    for (int c = 0; c < 9; c++)
      s->inverse[9 * k + c] = sound ? (float)(inverse[3 * (c % 3) + c / 3] / s->unit) : NAN;
    for (int c = 0; c < 6; c++)
      s->diagonal[6 * k + c] = s->unit * own[of_six[c]];
    for (int64_t e = s->even.start[k]; e < s->even.start[k + 1]; e++)
      take_even(t, k, e);
    for (int64_t e = s->odd.start[k]; e < s->odd.start[k + 1]; e++)
      take_odd(t, k, e);
  }
  return BW_OK;
}

bw_status bwi_smoother_follow(bw_context *context, bwi_smoother *s, const double *stiffness,
                              const bw_dof_map *dof_map, bool *usable) {
  bw_status status = BW_OK;
  double max = 0;
  int exponent = 0;
  *usable = false;
  for (int64_t i = 0; i < s->count; i++)
    for (int d = 0; d < 9; d += 4)
      max = fmax(max, stiffness[9 * (s->pattern->start[i + 1] - 1) + d]);
  if (!(max > 0) || !isfinite(max))
    return BW_OK;
  frexp(max, &exponent);
  s->unit = ldexp(1, -exponent);
  taking t = {s, stiffness, dof_map};
  BW_TRY(bw_parallel(context, s->count, ROWS, take, &t));
  *usable = true;
  for (int64_t k = 0; k < s->count; k++)
    *usable &= isfinite(s->inverse[9 * k]) != 0;
  if (s->block_start && *usable)
    BW_TRY(bwi_smoother_invert_blocks(context, s, stiffness, dof_map, usable));
done:
  return status;
}

/* ---- the order ----------------------------------------------------------------------------- */

/* Calls what follows for every neighbour j of node i, its block and whether that is of row j. */
#define FOR_NEIGHBOURS(pattern, i, body)                                                           \
  do {                                                                                             \
    for (int64_t p_ = (pattern)->start[i]; p_ < (pattern)->start[(i) + 1] - 1; p_++) {             \
      int32_t j = (pattern)->column[p_];                                                           \
      body                                                                                         \
    }                                                                                              \
    for (int64_t u_ = (pattern)->upper_start[i]; u_ < (pattern)->upper_start[(i) + 1]; u_++) {     \
      int32_t j = (pattern)->upper_row[u_];                                                        \
      body                                                                                         \
    }                                                                                              \
  } while (0)

/* Nodes by their distance (in edges of the pattern) from one, into order[begin ...]: its body.
 * Returns the end. */
static int32_t spread_from(const bw_block_pattern *pattern, int32_t from, int32_t begin,
                           int32_t mark, int32_t *seen, int32_t *order) {
  int32_t end = begin;
  order[end++] = from;
  seen[from] = mark;
  for (int32_t at = begin; at < end; at++)
    FOR_NEIGHBOURS(pattern, order[at], {
      if (seen[j] != mark) {
        seen[j] = mark;
        order[end++] = j;
      }
    });
  return end;
}

static int32_t chunk_at(int64_t at, int32_t count, int32_t chunks) {
  return (int32_t)(at * chunks / count);
}

/* Whether node i has a neighbour in a later chunk. */
static bool is_between(const bw_block_pattern *pattern, int32_t i, const int32_t *at,
                       int32_t chunks) {
  int32_t count = pattern->node_count, own = chunk_at(at[i], count, chunks);
  FOR_NEIGHBOURS(pattern, i, {
    if (chunk_at(at[j], count, chunks) > own)
      return true;
  });
  return false;
}

/* From nodes by distance (`at`: the inverse) to the order of rows, in as many chunks as leave few
 * nodes between them, whose rows are swept one after the other. */
static void cut(bwi_smoother *s, const int32_t *near, const int32_t *at) {
  int32_t chunks = BWI_SMOOTHER_MAX_CHUNKS, row = 0, chunk = -1;
  for (; chunks > 1; chunks /= 2) {
    int32_t shared = 0;
    for (int32_t i = 0; i < s->count; i++)
      shared += is_between(s->pattern, i, at, chunks);
    if (shared < s->count / 8)
      break;
  }
  s->chunk_count = chunks;
  for (int pass = 0; pass < 2; pass++)
    for (int32_t k = 0; k < s->count; k++) {
      while (pass == 0 && chunk < chunk_at(k, s->count, chunks))
        s->chunk_start[++chunk] = row;
      if (is_between(s->pattern, near[k], at, chunks) == (pass == 1))
        s->node[row++] = near[k];
      if (pass == 0 && k == s->count - 1)
        while (chunk < chunks)
          s->chunk_start[++chunk] = row;
    }
  for (int32_t k = 0; k < s->count; k++)
    s->row_of[s->node[k]] = k;
}

/* `block_of`: of nodes, where *blocks. */
static bw_status order_nodes(bw_context *context, bwi_smoother *s, const double *stiffness,
                             int32_t *block_of, bool *blocks) {
  bw_status status = BW_OK;
  int32_t *near = BW_NEW(context, int32_t, s->count), *at = BW_NEW0(context, int32_t, s->count);
  if (!near || !at) {
    status = BW_MEMORY;
    goto done;
  }
  for (int32_t i = 0, end = 0; i < s->count; i++)
    if (at[i] == 0) { /* a body, from one end of it: the node farthest from any */
      int32_t last = spread_from(s->pattern, i, end, 1, at, near);
      end = spread_from(s->pattern, near[last - 1], end, 2, at, near);
    }
  if (stiffness)
    BW_TRY(bwi_smoother_find_blocks(context, s->pattern, stiffness, near, block_of, blocks));
  for (int32_t k = 0; k < s->count; k++)
    at[near[k]] = k;
  cut(s, near, at);
done:
  bw_free(near);
  bw_free(at);
  return status;
}

/* ---- rows ---------------------------------------------------------------------------------- */

typedef struct entry {
  int32_t column;
  bool odd;
  uint16_t place;
} entry;

static void sort_row(entry *row, int64_t count) {
  for (int64_t i = 1; i < count; i++) {
    entry one = row[i];
    int64_t k = i;
    for (; k > 0 && row[k - 1].column > one.column; k--)
      row[k] = row[k - 1];
    row[k] = one;
  }
}

static bw_status make_part(bw_context *context, bwi_smoother_part *part, int64_t rows,
                           int64_t entries, int numbers, bool products) {
  part->start = BW_NEW0(context, int64_t, rows + 1);
  part->column = BW_NEW(context, int32_t, entries + 1);
  part->place = BW_NEW(context, uint16_t, entries + 1);
  part->value = BW_NEW0(context, float, numbers *entries + BWI_SMOOTHER_SPARE);
  part->outside = part->start + 1;
  part->rest = BW_NEW0(context, uint32_t, numbers * entries + BWI_SMOOTHER_SPARE);
  return part->start && part->column && part->place && part->value && (part->rest || !products)
             ? BW_OK
             : BW_MEMORY;
}

static void free_part(bwi_smoother_part *part) {
  bw_free(part->start);
  bw_free(part->within);
  bw_free(part->column);
  bw_free(part->place);
  bw_free(part->value);
  bw_free(part->rest);
}

/* Entries of all rows; `odd`: by block; row: room for one. */
static void list_rows(bwi_smoother *s, const uint8_t *odd, entry *row) {
  const bw_block_pattern *pattern = s->pattern;
  bwi_smoother_part *parts[2] = {&s->even, &s->odd};
  for (int32_t k = 0; k < s->count; k++) {
    int32_t i = s->node[k];
    int64_t count = 0;
    uint16_t place = 0;
    for (int64_t p = pattern->start[i]; p < pattern->start[i + 1] - 1; p++, place++)
      if (s->row_of[pattern->column[p]] < k)
        row[count++] = (entry){s->row_of[pattern->column[p]], odd[p], place};
    for (int64_t u = pattern->upper_start[i]; u < pattern->upper_start[i + 1]; u++, place++)
      if (s->row_of[pattern->upper_row[u]] < k)
        row[count++] =
            (entry){s->row_of[pattern->upper_row[u]], odd[pattern->upper_block[u]], place};
    sort_row(row, count);
    for (int n = 0; n < 2; n++)
      parts[n]->start[k + 1] = parts[n]->start[k];
    for (int64_t e = 0; e < count; e++) {
      bwi_smoother_part *part = parts[row[e].odd];
      int64_t at = part->start[k + 1]++;
      part->column[at] = row[e].column;
      part->place[at] = row[e].place;
    }
  }
}

static bw_status make_rows(bw_context *context, bwi_smoother *s, const bw_mesh *mesh, bool even) {
  bw_status status = BW_OK;
  const bw_block_pattern *pattern = s->pattern;
  int64_t blocks = pattern->block_count, longest = 0, entries[2] = {0, 0};
  uint8_t *odd = BW_NEW(context, uint8_t, blocks);
  entry *row = NULL;
  if (!odd)
    return BW_MEMORY;
  memset(odd, !even, (size_t)blocks);
  if (even)
    bwi_block_pattern_mark_surface(pattern, mesh, odd);
  for (int64_t i = 0; i < s->count; i++) {
    int64_t length = pattern->start[i + 1] - pattern->start[i] + pattern->upper_start[i + 1] -
                     pattern->upper_start[i];
    longest = length > longest ? length : longest;
    for (int64_t p = pattern->start[i]; p < pattern->start[i + 1] - 1; p++)
      entries[odd[p]]++;
  }
  if (longest > UINT16_MAX) {
    status = bw_fail(context, BW_LIMIT,
                     "a node shares elements with %lld others: fewer than 65536 are possible",
                     (long long)longest - 1);
    goto done;
  }
  row = BW_NEW(context, entry, longest + 1);
  if (!row) {
    status = BW_MEMORY;
    goto done;
  }
  BW_TRY(make_part(context, &s->even, s->count, entries[0], 6, mesh != NULL));
  BW_TRY(make_part(context, &s->odd, s->count, entries[1], 9, mesh != NULL));
  list_rows(s, odd, row);
done:
  bw_free(odd);
  bw_free(row);
  return status;
}

/* ---- life ---------------------------------------------------------------------------------- */

static void smoother_destroy(void *object) {
  bwi_smoother *s = object;
  bw_release(s->pattern);
  bw_free(s->node);
  bw_free(s->row_of);
  free_part(&s->even);
  free_part(&s->odd);
  bw_free(s->inverse);
  bw_free(s->diagonal);
  bw_free(s->block_start);
  bw_free(s->inverse_start);
  bw_free(s->block_inverse);
  bw_free(s);
}

static size_t part_bytes(const bwi_smoother_part *part, size_t rows, size_t numbers) {
  size_t entries = part->start ? (size_t)part->start[rows] : 0;
  return (rows + 1) * sizeof *part->start +
         entries * (sizeof *part->column + sizeof *part->place +
                    numbers * (sizeof *part->value + (part->rest ? sizeof *part->rest : 0)));
}

/* The pattern is its user's. */
static size_t smoother_bytes(const void *object) {
  const bwi_smoother *s = object;
  size_t rows = (size_t)s->count;
  size_t blocks = s->block_start ? (size_t)s->inverse_start[s->block_count] * sizeof(float) +
                                       rows * (3 * sizeof(int64_t) + sizeof(int32_t))
                                 : 0;
  return sizeof *s + blocks +
         rows * (2 * sizeof(int32_t) + 9 * sizeof(float) + 6 * sizeof(double)) +
         part_bytes(&s->even, rows, 6) + part_bytes(&s->odd, rows, 9);
}

static const bw_kind smoother_kind = {"smoother", smoother_destroy, smoother_bytes};

bw_status bwi_smoother_create(bw_context *context, const bw_mesh *mesh,
                              const bw_block_pattern *pattern, bool even, const double *stiffness,
                              bwi_smoother **out) {
  bw_status status = BW_OK;
  bool blocks = false;
  int32_t *block_of = NULL;
  bwi_smoother *s = BW_NEW0(context, bwi_smoother, 1);
  if (!s)
    return BW_MEMORY;
  bw_object_init(s, &smoother_kind);
  s->pattern = bw_retain(pattern);
  s->count = pattern->node_count;
  s->node = BW_NEW(context, int32_t, s->count);
  s->row_of = BW_NEW(context, int32_t, s->count);
  s->inverse = BW_NEW0(context, float, 9 * (int64_t)s->count + BWI_SMOOTHER_SPARE);
  s->diagonal = BW_NEW0(context, double, 6 * (int64_t)s->count + BWI_SMOOTHER_SPARE);
  block_of = BW_NEW(context, int32_t, s->count);
  if (!s->node || !s->row_of || !s->inverse || !s->diagonal || !block_of) {
    status = BW_MEMORY;
    goto done;
  }
  BW_TRY(order_nodes(context, s, stiffness, block_of, &blocks));
  BW_TRY(make_rows(context, s, mesh, even));
  if (blocks)
    BW_TRY(bwi_smoother_set_blocks(context, s, block_of));
done:
  bw_free(block_of);
  if (status == BW_OK)
    *out = s;
  else
    bw_release(s);
  return status;
}
