/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* How blocks of rows are found and factored (smoother_blocks.h). */
#include "linear/smoother_blocks.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/dense.h"
#include "base/union_find.h"

/* Nodes in a block that is no line, at most; blocks handed to a thread at once. */
enum { MOST = 16, GRAIN = 64 };

/* Nodes are strongly coupled where |K_ij|^2 >= STRONG^2 |K_ii| |K_jj|. In elements as thick as wide
 * few are; along the thickness of flat ones the ratio is 0.5 to 0.8, along fibres 0.4 to 0.6. */
#define STRONG 0.4
/* Strong couplings of a node on average, above which they are in no direction, as in nearly
 * incompressible bodies. There are no lines then, and only elements that are nearly flat have
 * couplings above the second ratio. */
#define MOST_COUPLINGS 1
#define STRONGER 0.6
/* Nodes in a line on average, from which on a body consists of columns. */
#define MEAN_SIZE 2
/* Of a pivot over its diagonal entry, at least. */
#define WEAKEST 1e-13

/* ---- which nodes ----------------------------------------------------------------------------- */

typedef struct coupling {
  double square; /* of the ratio */
  int32_t i, j;
} coupling;

static int stronger_first(const void *a, const void *b) {
  const coupling *x = a, *y = b;
  if (x->square != y->square)
    return x->square > y->square ? -1 : 1;
  if (x->i != y->i)
    return x->i < y->i ? -1 : 1;
  return (x->j > y->j) - (x->j < y->j);
}

static double square_of(const double *block) {
  return bwi_dot(9, block, block);
}

typedef struct norms {
  const bw_block_pattern *pattern;
  double *square;  /* by block */
  double *largest; /* by node: diagonal entry */
} norms;

static void take_norms(void *data, int64_t i, const double *row) {
  const norms *n = data;
  int64_t begin = n->pattern->start[i], end = n->pattern->start[i + 1];
  for (int64_t p = begin; p < end; p++)
    n->square[p] = square_of(row + 9 * (p - begin));
  const double *own = row + 9 * (end - 1 - begin);
  n->largest[i] = fmax(own[0], fmax(own[4], own[8]));
}

/* Those of at least a ratio, or their number alone where list is NULL; own: by node, the norm of
 * its block. */
static int64_t list_couplings(const bw_block_pattern *pattern, const double *squares,
                              const double *own, double ratio, coupling *list) {
  int64_t count = 0;
  for (int32_t i = 0; i < pattern->node_count; i++)
    for (int64_t p = pattern->start[i]; p < pattern->start[i + 1] - 1; p++) {
      int32_t j = pattern->column[p];
      double square = squares[p];
      if (!(square >= ratio * ratio * own[i] * own[j]))
        continue;
      if (list)
        list[count] = (coupling){square / (own[i] * own[j]), i, j};
      count++;
    }
  return count;
}

/* Sets of nodes, joined by the strongest couplings first: of at most MOST, or lines (`lines`),
 * which are joined end to end. */
static void join(const coupling *list, int64_t count, bool lines, int32_t nodes, int32_t *parent,
                 int32_t *size, int32_t *degree) {
  for (int32_t i = 0; i < nodes; i++) {
    parent[i] = i;
    size[i] = 1;
    degree[i] = 0;
  }
  for (int64_t k = 0; k < count; k++) {
    int32_t i = list[k].i, j = list[k].j;
    int32_t a = bwi_set_root(parent, i), b = bwi_set_root(parent, j), sum = size[a] + size[b];
    if (a == b || (sum > MOST && !(lines && degree[i] < 2 && degree[j] < 2)))
      continue;
    size[bwi_set_join(parent, a, b)] = sum;
    degree[i]++;
    degree[j]++;
  }
}

/* Sets are numbered by their lowest nodes, and their members listed. */
static void list_members(int32_t nodes, int32_t *parent, bwi_node_blocks *blocks) {
  blocks->count = 0;
  for (int32_t i = 0; i < nodes; i++) { /* a root is the lowest of its set */
    int32_t root = bwi_set_root(parent, i);
    blocks->of[i] = root == i ? blocks->count++ : blocks->of[root];
  }
  memset(blocks->start, 0, ((size_t)nodes + 1) * sizeof *blocks->start);
  for (int32_t i = 0; i < nodes; i++)
    blocks->start[blocks->of[i] + 1]++;
  for (int32_t b = 0; b < blocks->count; b++)
    blocks->start[b + 1] += blocks->start[b];
  for (int32_t i = nodes - 1; i >= 0; i--) /* the ends come down to the starts */
    blocks->member[--blocks->start[blocks->of[i] + 1]] = i;
  memmove(blocks->start, blocks->start + 1, (size_t)blocks->count * sizeof *blocks->start);
  blocks->start[blocks->count] = nodes;
}

/* Members of a block by their distance (in edges of the pattern) from the first; seen: by node. */
static void spread(const bw_block_pattern *pattern, const bwi_node_blocks *blocks, int32_t b,
                   int32_t mark, int32_t *seen) {
  int32_t *member = blocks->member, end = blocks->start[b];
  seen[member[end++]] = mark;
  for (int32_t at = blocks->start[b]; at < end; at++)
    BWI_FOR_NEIGHBOURS(pattern, member[at], {
      if (blocks->of[j] == b && seen[j] != mark) {
        seen[j] = mark;
        member[end++] = j;
      }
    });
}

/* Blocks in L of a block's factor; place: by node, where it is among the members. */
static int64_t envelope_of(const bw_block_pattern *pattern, const bwi_node_blocks *blocks,
                           int32_t b, int32_t *place) {
  int64_t sum = 0;
  for (int32_t m = blocks->start[b]; m < blocks->start[b + 1]; m++)
    place[blocks->member[m]] = m;
  for (int32_t m = blocks->start[b]; m < blocks->start[b + 1]; m++) {
    int32_t first = m;
    BWI_FOR_NEIGHBOURS(pattern, blocks->member[m],
                       { first = blocks->of[j] == b && place[j] < first ? place[j] : first; });
    sum += m - first;
  }
  return sum;
}

/* Members from one end to the other. Lines whose L has many entries, since they are folded, are cut
 * into blocks of MOST nodes. `work`: by node. */
static void lay_out(const bw_block_pattern *pattern, bwi_node_blocks *blocks, int32_t *work) {
  int32_t nodes = pattern->node_count, whole = blocks->count, cuts = 0;
  for (int32_t i = 0; i < nodes; i++)
    work[i] = -1;
  for (int32_t b = 0; b < whole; b++) {
    int32_t begin = blocks->start[b], size = blocks->start[b + 1] - begin;
    if (size < 3)
      continue;
    spread(pattern, blocks, b, -2, work);
    int32_t last = blocks->member[begin + size - 1];
    blocks->member[begin] = last; /* the others are found again */
    spread(pattern, blocks, b, -3, work);
    if (size > MOST && envelope_of(pattern, blocks, b, work) > MOST * (int64_t)size)
      for (int32_t m = begin + MOST; m < begin + size; m++) {
        cuts += (m - begin) % MOST == 0;
        blocks->of[blocks->member[m]] = whole + cuts - 1;
      }
  }
  if (cuts == 0)
    return;
  blocks->count = 0; /* members are in place; blocks are numbered again */
  for (int32_t m = 0, before = -1; m < nodes; m++) {
    int32_t i = blocks->member[m];
    if (blocks->of[i] != before)
      blocks->start[blocks->count++] = m;
    before = blocks->of[i];
    blocks->of[i] = blocks->count - 1;
  }
  blocks->start[blocks->count] = nodes;
}

void bwi_node_blocks_clear(bwi_node_blocks *blocks) {
  bw_free(blocks->of);
  bw_free(blocks->start);
  bw_free(blocks->member);
}

bw_status bwi_node_blocks_find(bw_context *context, const bw_block_pattern *pattern,
                               const bwi_stiffness *stiffness, bwi_node_blocks *blocks) {
  bw_status status = BW_OK;
  int32_t nodes = pattern->node_count;
  int64_t count = 0;
  double ratio = STRONG;
  coupling *list = NULL;
  double *own = BW_NEW(context, double, nodes);
  norms n = {pattern, BW_NEW(context, double, stiffness ? pattern->block_count : 1), own};
  int32_t *size = BW_NEW(context, int32_t, nodes), *parent = BW_NEW(context, int32_t, nodes);
  blocks->of = BW_NEW(context, int32_t, nodes);
  blocks->start = BW_NEW(context, int32_t, (int64_t)nodes + 1);
  blocks->member = BW_NEW(context, int32_t, nodes);
  BW_TRY_MEMORY(own && n.square && size && parent && blocks->of && blocks->start && blocks->member);
  if (stiffness)
    BW_TRY(bwi_stiffness_rows(context, pattern, stiffness, take_norms, &n));
  for (int64_t i = 0; i < nodes && stiffness; i++) {
    blocks->largest = fmax(blocks->largest, own[i]);
    own[i] = sqrt(n.square[pattern->start[i + 1] - 1]);
  }
  count = stiffness ? list_couplings(pattern, n.square, own, ratio, NULL) : 0;
  blocks->lines = count <= MOST_COUPLINGS * (int64_t)nodes;
  if (!blocks->lines) {
    ratio = STRONGER;
    count = list_couplings(pattern, n.square, own, ratio, NULL);
  }
  list = BW_NEW(context, coupling, count + 1);
  BW_TRY_MEMORY(list);
  if (stiffness)
    list_couplings(pattern, n.square, own, ratio, list);
  qsort(list, (size_t)count, sizeof *list, stronger_first);
  join(list, count, blocks->lines, nodes, parent, size, blocks->member);
  list_members(nodes, parent, blocks);
  lay_out(pattern, blocks, size);
done:
  bw_free(list);
  bw_free(n.square);
  bw_free(own);
  bw_free(size);
  bw_free(parent);
  return status;
}

/* ---- which rows ------------------------------------------------------------------------------ */

static bw_status end_outside(bw_context *context, const bwi_smoother *s, bwi_smoother_part *part) {
  part->within = BW_NEW(context, int64_t, s->count);
  if (!part->within)
    return BW_MEMORY;
  for (int32_t block = 0; block < s->block_count; block++)
    for (int32_t k = s->block_start[block]; k < s->block_start[block + 1]; k++) {
      int64_t end = part->start[k + 1]; /* columns ascend: those of the block are the last */
      while (end > part->start[k] && part->column[end - 1] >= s->block_start[block])
        end--;
      part->within[k] = end;
      if (end < part->start[k + 1] && part->column[end] < s->envelope[k])
        s->envelope[k] = part->column[end];
    }
  part->outside = part->within;
  return BW_OK;
}

bw_status bwi_smoother_set_blocks(bw_context *context, bwi_smoother *s,
                                  const bwi_node_blocks *blocks) {
  bw_status status = BW_OK;
  s->columns = blocks->lines && s->count >= MEAN_SIZE * (int64_t)blocks->count;
  s->block_start = BW_NEW(context, int32_t, s->count + 1);
  s->envelope = BW_NEW(context, int32_t, s->count);
  s->factor_start = BW_NEW(context, int64_t, (int64_t)s->count + 1);
  if (!s->block_start || !s->envelope || !s->factor_start)
    return BW_MEMORY;
  for (int32_t k = 0, chunk = 0; k < s->count; k++) {
    s->envelope[k] = k;
    if (k > 0 && blocks->of[s->node[k]] == blocks->of[s->node[k - 1]])
      continue;
    while (chunk <= s->chunk_count && s->chunk_start[chunk] <= k) /* no chunk cuts a block */
      s->chunk_block[chunk++] = s->block_count;
    s->block_start[s->block_count++] = k;
  }
  for (int32_t chunk = 0; chunk <= s->chunk_count; chunk++)
    if (s->chunk_start[chunk] == s->count)
      s->chunk_block[chunk] = s->block_count;
  s->block_start[s->block_count] = s->count;
  BW_TRY(end_outside(context, s, &s->even));
  BW_TRY(end_outside(context, s, &s->odd));
  s->factor_start[0] = 0;
  for (int32_t k = 0; k < s->count; k++)
    s->factor_start[k + 1] = s->factor_start[k] + k - s->envelope[k];
  s->factor = BW_NEW(context, float, 9 * s->factor_start[s->count] + BWI_SMOOTHER_SPARE);
  if (!s->factor)
    status = BW_MEMORY;
done:
  return status;
}

/* ---- factors --------------------------------------------------------------------------------- */

typedef struct factoring {
  bwi_smoother *s;
  const bw_dof_map *dof_map;
  double *within;
  int64_t longest;  /* block */
  double *inverses; /* workers x longest x 9 */
} factoring;

/* c -= a b^T */
static void subtract_product(const double *a, const double *b, double *c) {
  for (int i = 0; i < 3; i++)
    for (int j = 0; j < 3; j++)
      c[3 * i + j] -= bw_dot(a + 3 * i, b + 3 * j);
}

/* Components that are no unknowns have zero rows and columns in the inverses of D, which keeps them
 * out of the rest. */
static void factor_block(const factoring *v, int32_t begin, int32_t end, double *inverse) {
  const unsigned states = 1u << BW_DOF_UNKNOWN | 1u << BW_DOF_ISOSTATIC;
  bwi_smoother *s = v->s;
  const int64_t *start = s->factor_start;
  const int32_t *envelope = s->envelope;
  for (int32_t k = begin; k < end; k++) {
    const double *own = s->diagonal + 6 * (int64_t)k;
    double *row = v->within + 9 * start[k];
    double d[9] = {own[0], own[1], own[2], own[1], own[3], own[4], own[2], own[4], own[5]};
    for (int c = 0; c < 9; c++)
      d[c] /= s->unit;
    double trace = d[0] + d[4] + d[8];
    for (int32_t j = envelope[k]; j < k; j++) { /* L D of row k */
      const double *other = v->within + 9 * start[j];
      int32_t m = envelope[j] > envelope[k] ? envelope[j] : envelope[k];
      for (; m < j; m++)
        subtract_product(row + 9 * (m - envelope[k]), other + 9 * (m - envelope[j]),
                         row + 9 * (j - envelope[k]));
    }
    for (int32_t j = envelope[k]; j < k; j++) {
      double *at = row + 9 * (j - envelope[k]), whole[9];
      memcpy(whole, at, sizeof whole);
      bwi_multiply(3, 3, 3, whole, inverse + 9 * (j - begin), at);
      subtract_product(at, whole, d);
      for (int c = 0; c < 9; c++)
        s->factor[9 * (start[k] + j - envelope[k]) + c] = (float)at[3 * (c % 3) + c / 3];
    }
    bool sound =
        d[0] + d[4] + d[8] > WEAKEST * trace &&
        bwi_invert_node_block(v->dof_map, s->node[k], states, 0, d, inverse + 9 * (k - begin));
    for (int c = 0; c < 9; c++)
      s->inverse[9 * (int64_t)k + c] =
          sound ? (float)(inverse[9 * (k - begin) + 3 * (c % 3) + c / 3] / s->unit) : NAN;
    if (!sound)
      return;
  }
}

static bw_status factor_blocks(void *data, int64_t begin, int64_t end, int worker) {
  const factoring *v = data;
  for (int64_t b = begin; b < end; b++) {
    int32_t first = v->s->block_start[b], last = v->s->block_start[b + 1];
    if (last > first + 1)
      factor_block(v, first, last, v->inverses + 9 * v->longest * worker);
  }
  return BW_OK;
}

bw_status bwi_smoother_factor_blocks(bw_context *context, bwi_smoother *s, double *within,
                                     const bw_dof_map *dof_map) {
  factoring v = {.s = s, .dof_map = dof_map, .within = within};
  for (int32_t b = 0; b < s->block_count; b++) {
    int64_t rows = s->block_start[b + 1] - s->block_start[b];
    v.longest = rows > v.longest ? rows : v.longest;
  }
  v.inverses = BW_NEW(context, double, 9 * bw_threads(context) * v.longest);
  if (!v.inverses)
    return BW_MEMORY;
  bw_status status = bw_parallel(context, s->block_count, GRAIN, factor_blocks, &v);
  bw_free(v.inverses);
  return status;
}
