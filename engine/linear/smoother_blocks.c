/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* How blocks of rows are found and inverted (smoother_blocks.h). */
#include "linear/smoother_blocks.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/dense.h"
#include "base/union_find.h"

enum { MOST = BWI_SMOOTHER_BLOCK, GRAIN = 64 };

/* Nodes are strongly coupled where |K_ij|^2 >= STRONG^2 |K_ii| |K_jj|. In elements as thick as wide
 * few are; along the thickness of flat ones the ratio is 0.5 to 0.8. */
#define STRONG 0.4
/* Nodes in a block on average, below which blocks do not pay; strong couplings of a node, above
 * which they are in no direction, as in nearly incompressible bodies. */
#define MEAN_SIZE 2
#define MOST_COUPLINGS 1

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

/* Those above STRONG, at most `room` of them; own: by node, the norm of its block. Returns the
 * number of all, or more than `room`. */
static int64_t list_couplings(const bw_block_pattern *pattern, const double *stiffness,
                              const double *own, int64_t room, coupling *list) {
  int64_t count = 0;
  for (int32_t i = 0; i < pattern->node_count; i++)
    for (int64_t p = pattern->start[i]; p < pattern->start[i + 1] - 1; p++) {
      int32_t j = pattern->column[p];
      double square = square_of(stiffness + 9 * p), least = STRONG * STRONG * own[i] * own[j];
      if (!(square >= least))
        continue;
      if (count == room)
        return room + 1;
      list[count++] = (coupling){square / (own[i] * own[j]), i, j};
    }
  return count;
}

/* Sets of at most MOST nodes, joined by the strongest couplings first; returns their number. */
static int32_t join(const coupling *list, int64_t count, int32_t nodes, int32_t *parent,
                    int32_t *size) {
  int32_t sets = nodes;
  for (int32_t i = 0; i < nodes; i++) {
    parent[i] = i;
    size[i] = 1;
  }
  for (int64_t k = 0; k < count; k++) {
    int32_t a = bwi_set_root(parent, list[k].i), b = bwi_set_root(parent, list[k].j);
    if (a == b || size[a] + size[b] > MOST)
      continue;
    int32_t sum = size[a] + size[b];
    size[bwi_set_join(parent, a, b)] = sum;
    sets--;
  }
  return sets;
}

/* Nodes in the order of `near`, each followed by the others of its set. */
static void gather(int32_t nodes, int32_t *parent, int32_t *size, int32_t *near, int32_t *start,
                   int32_t *list) {
  int32_t next = 0;
  for (int32_t i = 0; i < nodes; i++)
    start[i] = -1;
  for (int32_t k = 0; k < nodes; k++) {
    int32_t root = bwi_set_root(parent, near[k]);
    if (start[root] < 0) {
      start[root] = next;
      next += size[root];
    }
    list[start[root]++] = near[k];
  }
  memcpy(near, list, (size_t)nodes * sizeof *near);
}

bw_status bwi_smoother_find_blocks(bw_context *context, const bw_block_pattern *pattern,
                                   const double *stiffness, int32_t *near, int32_t *block_of,
                                   bool *any) {
  bw_status status = BW_OK;
  int32_t nodes = pattern->node_count;
  int64_t most = MOST_COUPLINGS * (int64_t)nodes, count = 0;
  coupling *list = BW_NEW(context, coupling, most);
  double *own = BW_NEW(context, double, nodes);
  int32_t *size = BW_NEW(context, int32_t, nodes), *start = BW_NEW(context, int32_t, nodes);
  int32_t *gathered = BW_NEW(context, int32_t, nodes), *parent = BW_NEW(context, int32_t, nodes);
  *any = false;
  if (!list || !own || !size || !start || !gathered || !parent) {
    status = BW_MEMORY;
    goto done;
  }
  for (int64_t i = 0; i < nodes; i++)
    own[i] = sqrt(square_of(stiffness + 9 * (pattern->start[i + 1] - 1)));
  count = list_couplings(pattern, stiffness, own, most, list);
  if (count > most || MEAN_SIZE * (nodes - count) > nodes) /* each joins two sets at most */
    goto done;
  qsort(list, (size_t)count, sizeof *list, stronger_first);
  *any = MEAN_SIZE * join(list, count, nodes, parent, size) <= nodes;
  if (*any) {
    gather(nodes, parent, size, near, start, gathered);
    for (int32_t i = 0; i < nodes; i++)
      block_of[i] = bwi_set_root(parent, i);
  }
done:
  bw_free(list);
  bw_free(own);
  bw_free(size);
  bw_free(start);
  bw_free(gathered);
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
    }
  part->outside = part->within;
  return BW_OK;
}

bw_status bwi_smoother_set_blocks(bw_context *context, bwi_smoother *s, const int32_t *block_of) {
  bw_status status = BW_OK;
  int64_t numbers = 0;
  s->block_start = BW_NEW(context, int32_t, s->count + 1);
  s->inverse_start = BW_NEW(context, int64_t, s->count + 1);
  if (!s->block_start || !s->inverse_start)
    return BW_MEMORY;
  for (int32_t k = 0, chunk = 0; k < s->count; k++) {
    bool begins = k == 0 || block_of[s->node[k]] != block_of[s->node[k - 1]];
    while (chunk <= s->chunk_count && s->chunk_start[chunk] <= k) { /* a chunk cuts a block */
      begins |= s->chunk_start[chunk] == k;
      s->chunk_block[chunk++] = begins ? s->block_count : s->block_count - 1;
    }
    if (begins)
      s->block_start[s->block_count++] = k;
  }
  for (int32_t chunk = 0; chunk <= s->chunk_count; chunk++)
    if (s->chunk_start[chunk] == s->count)
      s->chunk_block[chunk] = s->block_count;
  s->block_start[s->block_count] = s->count;
  for (int32_t b = 0; b < s->block_count; b++) {
    int64_t size = 3 * (int64_t)(s->block_start[b + 1] - s->block_start[b]);
    s->inverse_start[b] = numbers;
    numbers += size * size;
  }
  s->inverse_start[s->block_count] = numbers;
  s->block_inverse = BW_NEW(context, float, numbers + BWI_SMOOTHER_SPARE);
  if (!s->block_inverse)
    return BW_MEMORY;
  BW_TRY(end_outside(context, s, &s->even));
  BW_TRY(end_outside(context, s, &s->odd));
done:
  return status;
}

/* ---- inverses -------------------------------------------------------------------------------- */

typedef struct inverting {
  bwi_smoother *s;
  const double *stiffness;
  const bw_dof_map *dof_map;
} inverting;

/* a (n x n) += the block of two nodes, from row r and column c on. */
static void place(const bwi_smoother *s, const double *stored, bool across, int n, int r, int c,
                  double *a) {
  for (int i = 0; i < 3; i++)
    for (int j = 0; j < 3; j++) {
      double entry = s->unit * stored[across ? 3 * j + i : 3 * i + j];
      a[(3 * r + i) * n + 3 * c + j] = entry;
      a[(3 * c + j) * n + 3 * r + i] = entry;
    }
}

/* K of a block's nodes. */
static void collect(const inverting *v, int32_t first, int32_t end, int n, double *a) {
  const bwi_smoother *s = v->s;
  memset(a, 0, (size_t)(n * n) * sizeof *a);
  for (int32_t k = first; k < end; k++) {
    int64_t i = s->node[k];
    place(s, v->stiffness + 9 * (s->pattern->start[i + 1] - 1), false, n, k - first, k - first, a);
    const bwi_smoother_part *parts[2] = {&s->even, &s->odd};
    for (int part = 0; part < 2; part++)
      for (int64_t e = parts[part]->outside[k]; e < parts[part]->start[k + 1]; e++) {
        bool across;
        int64_t block = bwi_smoother_block(s, parts[part], k, e, &across);
        place(s, v->stiffness + 9 * block, across, n, k - first, parts[part]->column[e] - first, a);
      }
  }
}

/* Rows, then columns, of a block at the unknowns of their nodes; `scale` along the others. */
static void keep_unknowns(const inverting *v, int32_t first, int32_t end, int n, double scale,
                          double *a) {
  for (int32_t k = first; k < end; k++) {
    int64_t node = v->s->node[k];
    int at = 3 * (k - first);
    for (int across = 0; across < 2; across++)
      for (int i = 0; i < n; i++) {
        double x[3];
        for (int d = 0; d < 3; d++)
          x[d] = a[across ? (at + d) * n + i : i * n + at + d];
        bwi_project_unknowns(v->dof_map, node, x, x);
        for (int d = 0; d < 3; d++)
          a[across ? (at + d) * n + i : i * n + at + d] = x[d];
      }
    for (int d = 0; d < 3 && scale > 0; d++) {
      double unit[3] = {d == 0, d == 1, d == 2}, kept[3];
      bwi_project_unknowns(v->dof_map, node, unit, kept);
      for (int c = 0; c < 3; c++)
        a[(at + d) * n + at + c] += scale * (unit[c] - kept[c]);
    }
  }
}

static bw_status invert(void *data, int64_t begin, int64_t end, int worker) {
  (void)worker;
  const inverting *v = data;
  bwi_smoother *s = v->s;
  double a[9 * MOST * MOST], inverse[9 * MOST * MOST], column[3 * MOST];
  for (int64_t b = begin; b < end; b++) {
    int32_t first = s->block_start[b], last = s->block_start[b + 1];
    int n = 3 * (last - first);
    float *out = s->block_inverse + s->inverse_start[b];
    collect(v, first, last, n, a);
    keep_unknowns(v, first, last, n, 1, a); /* the largest diagonal entry is near 1 */
    if (!bwi_cholesky(n, a, 1e-13)) {
      out[0] = NAN;
      continue;
    }
    for (int j = 0; j < n; j++) {
      memset(column, 0, sizeof column);
      column[j] = 1;
      bwi_lower_solve(n, a, column);
      bwi_upper_solve(n, a, column);
      for (int i = 0; i < n; i++)
        inverse[j * n + i] = column[i];
    }
    keep_unknowns(v, first, last, n, 0, inverse);
    for (int i = 0; i < n * n; i++)
      out[i] = (float)inverse[i];
  }
  return BW_OK;
}

bw_status bwi_smoother_invert_blocks(bw_context *context, bwi_smoother *s, const double *stiffness,
                                     const bw_dof_map *dof_map, bool *usable) {
  inverting v = {s, stiffness, dof_map};
  bw_status status = bw_parallel(context, s->block_count, GRAIN, invert, &v);
  for (int32_t b = 0; b < s->block_count && status == BW_OK; b++)
    *usable &= isfinite(s->block_inverse[s->inverse_start[b]]) != 0;
  return status;
}
