/* Pairs of facets that cut each other.
 *
 * Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later.
 *
 * Which test a pair needs depends on how many corners it shares:
 *   none   they meet when a side of one meets the other (closed sets; a triangle that lies within
 *          the other is met by its sides);
 *   one    the meeting of two triangles is convex and holds the shared corner; if it holds another
 *          point, the way there from the corner leaves one of the triangles through the side
 *          opposite of the corner while inside the other: so those two sides are tested;
 *   two    they meet beyond the shared side only when folded flat onto each other: in one plane,
 *          with the third corners on the same side;
 *   three  the same triangle: reported as a duplicate, not as an intersection. */
#include <stdlib.h>
#include <string.h>

#include "mesh/predicates.h"
#include "mesh/surface_topology.h"

enum { GRAIN = 256, MAX_FOUND = 1000, REPORTED = 64 };

static const double *at(const bwi_topology *topology, int32_t point) {
  return topology->point + 3 * (int64_t)point;
}

static bool folded(const bwi_topology *topology, int32_t from, int32_t to, int32_t c, int32_t d) {
  const double *p = at(topology, from), *q = at(topology, to), *x = at(topology, c),
               *y = at(topology, d);
  if (bwi_orient3(p, q, x, y) != 0)
    return false;
  int axis = bwi_projection(p, q, x);
  return axis >= 0 && bwi_orient_seen(axis, p, q, x) == bwi_orient_seen(axis, p, q, y);
}

static bool meet(const bwi_topology *topology, int32_t a, int32_t b) {
  const int32_t *ca = topology->corner + 3 * (int64_t)a, *cb = topology->corner + 3 * (int64_t)b;
  const double *xa[3], *xb[3];
  int shared = 0, lone_a = 0, lone_b = 0, sum_a = 0, sum_b = 0;
  for (int i = 0; i < 3; i++) {
    xa[i] = at(topology, ca[i]);
    xb[i] = at(topology, cb[i]);
    for (int k = 0; k < 3; k++)
      if (ca[i] == cb[k]) {
        shared++;
        lone_a = i;
        lone_b = k;
        sum_a += i;
        sum_b += k;
      }
  }
  switch (shared) {
  case 0:
    for (int i = 0; i < 3; i++)
      if (bwi_segment_meets_triangle(xa[i], xa[(i + 1) % 3], xb[0], xb[1], xb[2]) ||
          bwi_segment_meets_triangle(xb[i], xb[(i + 1) % 3], xa[0], xa[1], xa[2]))
        return true;
    return false;
  case 1:
    return bwi_segment_meets_triangle(xa[(lone_a + 1) % 3], xa[(lone_a + 2) % 3], xb[0], xb[1],
                                      xb[2]) ||
           bwi_segment_meets_triangle(xb[(lone_b + 1) % 3], xb[(lone_b + 2) % 3], xa[0], xa[1],
                                      xa[2]);
  case 2: {
    int ka = 3 - sum_a, kb = 3 - sum_b; /* the corners not shared */
    return folded(topology, ca[(ka + 1) % 3], ca[(ka + 2) % 3], ca[ka], cb[kb]);
  }
  default:
    return false;
  }
}

typedef struct search {
  bw_context *context;
  const bwi_topology *topology;
  const bwi_tree *tree;
  const uint8_t *skip;
  struct chunk {
    bwi_pair *pair;
    size_t count, capacity;
  } * chunk;
} search;

typedef struct one_search {
  search *all;
  struct chunk *chunk;
  int32_t facet;
  int found;
  bw_status status;
} one_search;

static bool visit(void *data, int32_t other) {
  one_search *one = (one_search *)data;
  if (other <= one->facet || !meet(one->all->topology, one->facet, other))
    return true;
  struct chunk *chunk = one->chunk;
  if (!bw_grow(one->all->context, (void **)&chunk->pair, &chunk->capacity, chunk->count, 1,
               sizeof *chunk->pair)) {
    one->status = BW_MEMORY;
    return false;
  }
  chunk->pair[chunk->count++] = (bwi_pair){one->facet, other};
  return ++one->found < MAX_FOUND;
}

static int by_second(const void *a, const void *b) {
  int32_t x = ((const bwi_pair *)a)->second, y = ((const bwi_pair *)b)->second;
  return (x > y) - (x < y);
}

static bw_status search_chunk(void *data, int64_t begin, int64_t end, int worker) {
  search *all = (search *)data;
  (void)worker;
  if (begin > 0 && begin % (REPORTED * GRAIN) == 0) /* the caller may cancel then */
    bw_progress(all->context, "intersections", (double)begin / (double)all->topology->facets);
  bw_status status = bw_check_cancel(all->context);
  struct chunk *chunk = &all->chunk[begin / GRAIN];
  for (int64_t t = begin; t < end && status == BW_OK; t++) {
    if (all->skip[t])
      continue;
    double low[3], high[3];
    for (int k = 0; k < 3; k++) {
      low[k] = high[k] = at(all->topology, all->topology->corner[3 * t])[k];
      for (int i = 1; i < 3; i++) {
        double x = at(all->topology, all->topology->corner[3 * t + i])[k];
        low[k] = x < low[k] ? x : low[k];
        high[k] = x > high[k] ? x : high[k];
      }
    }
    size_t before = chunk->count;
    one_search one = {all, chunk, (int32_t)t, 0, BW_OK};
    bwi_tree_in_box(all->tree, low, high, visit, &one);
    status = one.status;
    if (chunk->count - before > 1)
      qsort(chunk->pair + before, chunk->count - before, sizeof *chunk->pair, by_second);
  }
  return status;
}

bw_status bwi_intersections(bw_context *context, const bwi_topology *topology, const uint8_t *skip,
                            bwi_pair **pairs, int64_t *count) {
  bw_status status = BW_OK;
  bwi_tree *tree = NULL;
  bwi_pair *list = NULL;
  size_t total = 0, chunks = (size_t)topology->facets / GRAIN + 1;
  search all = {context, topology, NULL, skip, NULL};
  all.chunk = BW_NEW0(context, struct chunk, chunks);
  if (!all.chunk)
    return BW_MEMORY;
  BW_TRY(
      bwi_tree_create(context, topology->point, topology->facets, topology->corner, skip, &tree));
  all.tree = tree;
  BW_TRY(bw_parallel(context, topology->facets, GRAIN, search_chunk, &all));
  for (size_t i = 0; i < chunks; i++)
    total += all.chunk[i].count;
  list = BW_NEW(context, bwi_pair, total);
  BW_TRY_MEMORY(list);
  total = 0;
  for (size_t i = 0; i < chunks; i++) {
    if (all.chunk[i].count)
      memcpy(list + total, all.chunk[i].pair, all.chunk[i].count * sizeof *list);
    total += all.chunk[i].count;
  }
  *pairs = list;
  *count = (int64_t)total;
done:
  for (size_t i = 0; i < chunks; i++)
    bw_free(all.chunk[i].pair);
  bw_free(all.chunk);
  bwi_tree_destroy(tree);
  return status;
}
