/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* How the rows of smoother.h are ordered, and what stands in them. */
#include <math.h>
#include <string.h>

#include "assemble/internal.h"
#include "linear/element_product.h"
#include "linear/smoother_blocks.h"

enum { ROWS = BWI_SMOOTHER_ROWS };

/* ---- the matrix ---------------------------------------------------------------------------- */

typedef struct taking {
  bwi_smoother *s;
  const bw_dof_map *dof_map;
  double *within; /* K within blocks, where factors come from; NULL: without blocks */
} taking;

static const int of_six[6] = {0, 1, 2, 4, 5, 8}; /* of the nine of a block */

static void put(bwi_smoother_part *part, int64_t at, double number) {
  uint32_t rest;
  part->value[at] = bwi_smoother_halves(number, part->rest ? &part->rest[at] : &rest);
}

/* The entry of a row in a column, or -1. */
static int64_t entry_at(const bwi_smoother_part *part, int64_t row, int32_t column) {
  int64_t begin = part->start[row], end = part->start[row + 1];
  while (end - begin > 1) {
    int64_t middle = begin + (end - begin) / 2;
    begin = part->column[middle] <= column ? middle : begin;
    end = part->column[middle] <= column ? end : middle;
  }
  return begin < end && part->column[begin] == column ? begin : -1;
}

/* K of row k and the column c before it. */
static void take_block(const taking *t, int32_t k, int32_t c, const double block[9]) {
  bwi_smoother *s = t->s;
  int64_t e = entry_at(&s->even, k, c);
  if (e >= 0)
    for (int n = 0; n < 6; n++) {
      int m = of_six[n];
      put(&s->even, 6 * e + n, 0.5 * s->unit * (block[m] + block[3 * (m % 3) + m / 3]));
    }
  else {
    e = entry_at(&s->odd, k, c);
    for (int n = 0; n < 9; n++)
      put(&s->odd, 9 * e + n, s->unit * block[3 * (n % 3) + n / 3]);
  }
  if (t->within && c >= s->envelope[k])
    memcpy(t->within + 9 * (s->factor_start[k] + c - s->envelope[k]), block, 9 * sizeof *block);
}

/* Row i of K: every block goes to one place, whichever thread has it. An inverse that there is not
 * is NAN. */
static void take(void *data, int64_t i, const double *row) {
  const taking *t = data;
  const bwi_smoother *s = t->s;
  const bw_block_pattern *pattern = s->pattern;
  int32_t k = s->row_of[i];
  for (int64_t p = pattern->start[i]; p < pattern->start[i + 1] - 1; p++, row += 9) {
    int32_t other = s->row_of[pattern->column[p]];
    double across[9];
    if (other < k) {
      take_block(t, k, other, row);
      continue;
    }
    for (int n = 0; n < 9; n++)
      across[n] = row[3 * (n % 3) + n / 3];
    take_block(t, other, k, across);
  }
  double inverse[9];
  bool sound = bwi_invert_node_block(t->dof_map, i, 1u << BW_DOF_UNKNOWN | 1u << BW_DOF_ISOSTATIC,
                                     0, row, inverse);
  for (int n = 0; n < 9; n++)
    s->inverse[9 * (int64_t)k + n] = sound ? (float)(inverse[3 * (n % 3) + n / 3] / s->unit) : NAN;
  for (int n = 0; n < 6; n++)
    s->diagonal[6 * (int64_t)k + n] = s->unit * row[of_six[n]];
}

static double largest_of_diagonal(const bw_block_pattern *pattern, const double *values) {
  double largest = 0;
  for (int64_t i = 0; i < pattern->node_count; i++)
    for (int d = 0; d < 9; d += 4)
      largest = fmax(largest, values[9 * (pattern->start[i + 1] - 1) + d]);
  return largest;
}

/* 0 where there is none. */
static double unit_for(double largest) {
  int exponent = 0;
  frexp(largest, &exponent);
  return largest > 0 && isfinite(largest) ? ldexp(1, -exponent) : 0;
}

bw_status bwi_smoother_follow(bw_context *context, bwi_smoother *s, const bwi_stiffness *stiffness,
                              const bw_dof_map *dof_map, bool *usable) {
  bw_status status = BW_OK;
  taking t = {.s = s, .dof_map = dof_map};
  *usable = false;
  if (stiffness->values)
    s->unit = unit_for(largest_of_diagonal(s->pattern, stiffness->values));
  if (!(s->unit > 0))
    return BW_OK;
  if (s->block_start) {
    t.within = BW_NEW0(context, double, 9 * s->factor_start[s->count]);
    BW_TRY_MEMORY(t.within);
  }
  BW_TRY(bwi_stiffness_rows(context, s->pattern, stiffness, take, &t));
  if (s->block_start)
    BW_TRY(bwi_smoother_factor_blocks(context, s, t.within, dof_map));
  *usable = true;
  for (int64_t k = 0; k < s->count; k++)
    *usable &= isfinite(s->inverse[9 * k]) != 0;
done:
  bw_free(t.within);
  return status;
}

bw_status bwi_smoother_follow_elements(bw_context *context, bwi_smoother *s, const bw_mesh *mesh,
                                       const bw_material *material, bool *usable) {
  bw_status status = BW_OK;
  bw_release(s->elements);
  s->elements = NULL;
  *usable = true;
  if (!s->by_elements)
    return BW_OK;
  BW_TRY(bwi_element_product_serves(context, mesh, material, usable));
  if (*usable)
    BW_TRY(bwi_element_product_create(context, s, mesh, material, &s->elements));
done:
  return status;
}

/* ---- the order ----------------------------------------------------------------------------- */

typedef struct ordering {
  const bw_block_pattern *pattern;
  bwi_node_blocks blocks;
  int32_t *near;    /* nodes by distance, blocks together */
  int32_t *at;      /* by node: the place of its block in `near`; before, marks of nodes seen */
  uint8_t *chunk;   /* by node */
  uint8_t *between; /* by node: its block has a neighbour in a later chunk */
} ordering;

/* The nodes of a block, marked and added to `near`; returns the end. */
static int32_t append(const ordering *o, int32_t node, int32_t end, int32_t mark) {
  int32_t b = o->blocks.of[node];
  for (int32_t m = o->blocks.start[b]; m < o->blocks.start[b + 1]; m++) {
    o->at[o->blocks.member[m]] = mark;
    o->near[end++] = o->blocks.member[m];
  }
  return end;
}

/* Nodes by their distance (in edges of the pattern, blocks as one) from one, into near[begin ...]:
 * its body. Returns the end. */
static int32_t spread_from(const ordering *o, int32_t from, int32_t begin, int32_t mark) {
  int32_t end = append(o, from, begin, mark);
  for (int32_t k = begin; k < end; k++)
    BWI_FOR_NEIGHBOURS(o->pattern, o->near[k], {
      if (o->at[j] != mark)
        end = append(o, j, end, mark);
    });
  return end;
}

/* Whether node i has a neighbour in a later chunk. */
static bool is_between(const ordering *o, int32_t i) {
  BWI_FOR_NEIGHBOURS(o->pattern, i, {
    if (o->chunk[j] > o->chunk[i])
      return true;
  });
  return false;
}

/* Cuts into so many chunks; how many nodes are between them. */
static int32_t find_between(const ordering *o, int32_t chunks) {
  int32_t count = o->pattern->node_count, sum = 0;
  for (int32_t i = 0; i < count; i++)
    o->chunk[i] = (uint8_t)((int64_t)o->at[i] * chunks / count);
  for (int32_t k = 0, end; k < count; k = end) {
    bool any = false;
    for (end = k; end < count && o->at[o->near[end]] == k; end++)
      any = any || is_between(o, o->near[end]);
    for (int32_t m = k; m < end; m++)
      o->between[o->near[m]] = any;
    sum += any ? end - k : 0;
  }
  return sum;
}

/* From nodes by distance to the order of rows, in as many chunks as leave few nodes between them,
 * whose rows are swept one after the other. */
static void cut(bwi_smoother *s, const ordering *o) {
  int32_t chunks = BWI_SMOOTHER_MAX_CHUNKS, row = 0;
  while (find_between(o, chunks) >= s->count / 8 && chunks > 1)
    chunks /= 2;
  s->chunk_count = chunks;
  for (int pass = 0; pass < 2; pass++) {
    int32_t chunk = 0, *start = pass == 0 ? s->chunk_start : s->between_start;
    for (int32_t k = 0; k < s->count; k++) {
      while (chunk <= o->chunk[o->near[k]])
        start[chunk++] = row;
      if (o->between[o->near[k]] == (pass == 1))
        s->node[row++] = o->near[k];
    }
    while (chunk <= chunks)
      start[chunk++] = row;
  }
  for (int32_t k = 0; k < s->count; k++)
    s->row_of[s->node[k]] = k;
}

/* `o`: zero; its blocks are wanted later. */
static bw_status order_nodes(bw_context *context, bwi_smoother *s, const bwi_stiffness *stiffness,
                             ordering *o) {
  bw_status status = BW_OK;
  o->pattern = s->pattern;
  o->near = BW_NEW(context, int32_t, s->count);
  o->at = BW_NEW0(context, int32_t, s->count);
  o->chunk = BW_NEW(context, uint8_t, s->count);
  o->between = BW_NEW(context, uint8_t, s->count);
  if (!o->near || !o->at || !o->chunk || !o->between)
    return BW_MEMORY;
  BW_TRY(bwi_node_blocks_find(context, s->pattern, stiffness, &o->blocks));
  s->unit = unit_for(o->blocks.largest);
  for (int32_t i = 0, end = 0; i < s->count; i++)
    if (o->at[i] == 0) { /* a body, from one end of it: the node farthest from any */
      int32_t last = spread_from(o, i, end, 1);
      end = spread_from(o, o->near[last - 1], end, 2);
    }
  for (int32_t k = 0, first = 0; k < s->count; k++) {
    first = k > 0 && o->blocks.of[o->near[k]] == o->blocks.of[o->near[k - 1]] ? first : k;
    o->at[o->near[k]] = first;
  }
  cut(s, o);
done:
  return status;
}

/* ---- rows ---------------------------------------------------------------------------------- */

typedef struct entry {
  int32_t column;
  bool odd;
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
  part->value = BW_NEW0(context, float, numbers *entries + BWI_SMOOTHER_SPARE);
  part->outside = part->start + 1;
  if (products)
    part->rest = BW_NEW0(context, uint32_t, numbers * entries + BWI_SMOOTHER_SPARE);
  return part->start && part->column && part->value && (part->rest || !products) ? BW_OK
                                                                                 : BW_MEMORY;
}

static void free_part(bwi_smoother_part *part) {
  bw_free(part->start);
  bw_free(part->within);
  bw_free(part->column);
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
    for (int64_t p = pattern->start[i]; p < pattern->start[i + 1] - 1; p++)
      if (s->row_of[pattern->column[p]] < k)
        row[count++] = (entry){s->row_of[pattern->column[p]], odd[p]};
    for (int64_t u = pattern->upper_start[i]; u < pattern->upper_start[i + 1]; u++)
      if (s->row_of[pattern->upper_row[u]] < k)
        row[count++] = (entry){s->row_of[pattern->upper_row[u]], odd[bw_upper_block(pattern, u)]};
    sort_row(row, count);
    for (int n = 0; n < 2; n++)
      parts[n]->start[k + 1] = parts[n]->start[k];
    for (int64_t e = 0; e < count; e++) {
      bwi_smoother_part *part = parts[row[e].odd];
      int64_t at = part->start[k + 1]++;
      part->column[at] = row[e].column;
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
  row = BW_NEW(context, entry, longest + 1);
  BW_TRY_MEMORY(row);
  BW_TRY(make_part(context, &s->even, s->count, entries[0], 6, mesh && !s->by_elements));
  BW_TRY(make_part(context, &s->odd, s->count, entries[1], 9, mesh && !s->by_elements));
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
  bw_free(s->envelope);
  bw_free(s->factor_start);
  bw_free(s->factor);
  bw_release(s->elements);
  bw_free(s);
}

static size_t part_bytes(const bwi_smoother_part *part, size_t rows, size_t numbers) {
  size_t entries = part->start ? (size_t)part->start[rows] : 0;
  return (rows + 1) * sizeof *part->start +
         entries * (sizeof *part->column +
                    numbers * (sizeof *part->value + (part->rest ? sizeof *part->rest : 0)));
}

/* The pattern is its user's. */
static size_t smoother_bytes(const void *object) {
  const bwi_smoother *s = object;
  size_t rows = (size_t)s->count;
  size_t blocks = s->block_start ? (size_t)s->factor_start[s->count] * 9 * sizeof(float) +
                                       rows * (3 * sizeof(int64_t) + 2 * sizeof(int32_t))
                                 : 0;
  return sizeof *s + blocks + bw_bytes(s->elements) +
         rows * (2 * sizeof(int32_t) + 9 * sizeof(float) + 6 * sizeof(double)) +
         part_bytes(&s->even, rows, 6) + part_bytes(&s->odd, rows, 9);
}

static const bw_kind smoother_kind = {"smoother", smoother_destroy, smoother_bytes};

bw_status bwi_smoother_create(bw_context *context, const bw_mesh *mesh,
                              const bw_block_pattern *pattern, bool even, bool by_elements,
                              const bwi_stiffness *stiffness, bwi_smoother **out) {
  bw_status status = BW_OK;
  ordering o = {0};
  bwi_smoother *s = BW_NEW0(context, bwi_smoother, 1);
  if (!s)
    return BW_MEMORY;
  bw_object_init(s, &smoother_kind);
  s->pattern = bw_retain(pattern);
  s->count = pattern->node_count;
  s->by_elements = by_elements;
  s->node = BW_NEW(context, int32_t, s->count);
  s->row_of = BW_NEW(context, int32_t, s->count);
  s->inverse = BW_NEW0(context, float, 9 * (int64_t)s->count + BWI_SMOOTHER_SPARE);
  s->diagonal = BW_NEW0(context, double, 6 * (int64_t)s->count + BWI_SMOOTHER_SPARE);
  BW_TRY_MEMORY(s->node && s->row_of && s->inverse && s->diagonal);
  BW_TRY(order_nodes(context, s, stiffness, &o));
  BW_TRY(make_rows(context, s, mesh, even));
  if (o.blocks.count < s->count)
    BW_TRY(bwi_smoother_set_blocks(context, s, &o.blocks));
done:
  bwi_node_blocks_clear(&o.blocks);
  bw_free(o.near);
  bw_free(o.at);
  bw_free(o.chunk);
  bw_free(o.between);
  if (status == BW_OK)
    *out = s;
  else
    bw_release(s);
  return status;
}

void bwi_smoother_keep(const bwi_smoother *s, const bw_dof_map *dof_map, int32_t count,
                       const int32_t *row, int width, float *field) {
  for (int32_t h = 0; h < count; h++) {
    float *x = field + 3 * (int64_t)width * row[h];
    for (int f = 0; f < width; f++) {
      double value[3] = {x[f], x[width + f], x[2 * width + f]};
      bwi_project_unknowns(dof_map, s->node[row[h]], value, value);
      for (int d = 0; d < 3; d++)
        x[d * width + f] = (float)value[d];
    }
  }
}
