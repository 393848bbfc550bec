/* Which shells lie inside which.
 *
 * Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later.
 *
 * From a few facets of each shell a segment goes to a place outside everything. It crosses each
 * other shell an odd number of times where the facet lies inside that shell. Crossings are decided
 * exactly; where the segment touches a corner or side of a facet it is given another direction. A
 * shell counts as inside another one only when all its samples say so, so that shells that merely
 * overlap are not taken for nested. */
#include <math.h>
#include <string.h>

#include "mesh/predicates.h"
#include "mesh/surface_internal.h"
#include "mesh/surface_topology.h"

enum { SAMPLES = 5, DIRECTIONS = 12 };

typedef struct crossing {
  const bwi_topology *topology;
  double p[3], q[3];
  int32_t own; /* the shell the segment starts from */
  bool unclear;
  int32_t *hits; /* shells crossed, one entry per crossing */
  size_t count, capacity;
  bw_context *context;
  bw_status status;
} crossing;

static bool cross(void *data, int32_t facet) {
  crossing *c = (crossing *)data;
  const bwi_topology *topology = c->topology;
  int32_t shell = topology->shell[facet];
  if (shell == c->own)
    return true;
  const int32_t *corner = topology->corner + 3 * (int64_t)facet;
  const double *x[3];
  for (int k = 0; k < 3; k++)
    x[k] = topology->point + 3 * (int64_t)corner[k];
  int sp = bwi_orient3(x[0], x[1], x[2], c->p), sq = bwi_orient3(x[0], x[1], x[2], c->q);
  if (sp * sq > 0)
    return true;
  int s = bwi_orient3(c->p, c->q, x[0], x[1]), t = bwi_orient3(c->p, c->q, x[1], x[2]),
      u = bwi_orient3(c->p, c->q, x[2], x[0]);
  bool some_positive = s > 0 || t > 0 || u > 0, some_negative = s < 0 || t < 0 || u < 0;
  if (some_positive && some_negative)
    return true;
  if (sp == 0 || sq == 0 || s == 0 || t == 0 || u == 0) {
    c->unclear = true;
    return false;
  }
  if (!bw_grow(c->context, (void **)&c->hits, &c->capacity, c->count, 1, sizeof *c->hits)) {
    c->status = BW_MEMORY;
    return false;
  }
  c->hits[c->count++] = shell;
  return true;
}

/* The shells that a segment from a point to the outside crosses. */
static bw_status count_crossings(crossing *c, const bwi_tree *tree, const double from[3],
                                 double size) {
  double *p = c->p, *q = c->q;
  memcpy(p, from, 3 * sizeof *p);
  for (int d = 0; d < DIRECTIONS; d++) {
    /* directions on a spiral: none lies along a grid or a plane of symmetry */
    double z = 0.83 - 1.61 * (d + 0.37) / DIRECTIONS, r = sqrt(1 - z * z),
           turn = 2.399963 * d + 0.7321;
    q[0] = p[0] + 2 * size * r * cos(turn);
    q[1] = p[1] + 2 * size * r * sin(turn);
    q[2] = p[2] + 2 * size * z;
    c->count = 0;
    c->unclear = false;
    c->status = BW_OK;
    bwi_tree_on_segment(tree, p, q, cross, c);
    if (c->status != BW_OK || !c->unclear)
      break;
  }
  return c->status;
}

static void facet_centroid(const double *point, const int32_t *corner, double middle[3]) {
  for (int i = 0; i < 3; i++)
    middle[i] = (point[3 * (int64_t)corner[0] + i] + point[3 * (int64_t)corner[1] + i] +
                 point[3 * (int64_t)corner[2] + i]) /
                3;
}

bw_status bwi_shell_depths(bw_context *context, const bwi_topology *topology, const uint8_t *closed,
                           const uint8_t *skip, int32_t *depth) {
  bw_status status = BW_OK;
  bwi_tree *tree = NULL;
  int32_t *list = NULL; /* shells that hold a sample of the one in question */
  size_t list_capacity = 0;
  int32_t shells = topology->shells;
  crossing c = {.topology = topology, .context = context};
  double low[3] = {HUGE_VAL, HUGE_VAL, HUGE_VAL}, high[3] = {-HUGE_VAL, -HUGE_VAL, -HUGE_VAL};
  memset(depth, 0, (size_t)shells * sizeof *depth);
  if (shells < 2)
    return BW_OK;
  int32_t *facets = BW_NEW0(context, int32_t, shells); /* of each shell */
  int32_t *sample = BW_NEW(context, int32_t, (size_t)shells * SAMPLES);
  int32_t *inside = BW_NEW0(context, int32_t, shells); /* samples inside each shell */
  int32_t *seen = BW_NEW0(context, int32_t, shells);
  uint8_t *no_wall = BW_NEW(context, uint8_t, topology->facets);
  BW_TRY_MEMORY(facets && sample && inside && seen && no_wall);
  for (int32_t t = 0; t < topology->facets; t++) {
    int32_t s = topology->shell[t];
    no_wall[t] = skip[t] || s < 0 || !closed[s];
    if (s >= 0 && !skip[t])
      facets[s]++;
  }
  /* samples spread over the numbers of each shell's facets */
  for (int32_t t = 0; t < topology->facets; t++) {
    int32_t s = topology->shell[t];
    if (s < 0 || skip[t])
      continue;
    for (int k = 0; k < SAMPLES; k++)
      if (seen[s] == (int64_t)facets[s] * k / SAMPLES)
        sample[SAMPLES * (int64_t)s + k] = t;
    seen[s]++;
  }
  for (int64_t i = 0; i < topology->points; i++)
    for (int k = 0; k < 3; k++) {
      low[k] = fmin(low[k], topology->point[3 * i + k]);
      high[k] = fmax(high[k], topology->point[3 * i + k]);
    }
  double size = (high[0] - low[0]) + (high[1] - low[1]) + (high[2] - low[2]);
  BW_TRY(bwi_tree_create(context, topology->point, topology->facets, topology->corner, no_wall,
                         &tree));
  memset(seen, 0, (size_t)shells * sizeof *seen);
  for (int32_t s = 0; s < shells; s++) {
    if (!facets[s])
      continue;
    BW_TRY(bw_check_cancel(context));
    int decided = 0;
    size_t listed = 0;
    c.own = s;
    for (int k = 0; k < SAMPLES; k++) {
      double middle[3];
      int64_t facet = sample[SAMPLES * (int64_t)s + k];
      facet_centroid(topology->point, topology->corner + 3 * facet, middle);
      BW_TRY(count_crossings(&c, tree, middle, size));
      if (c.unclear)
        continue; /* the sample touches another shell whatever the direction: it says nothing */
      decided++;
      for (size_t i = 0; i < c.count; i++)
        seen[c.hits[i]] ^= 1;
      for (size_t i = 0; i < c.count; i++) {
        int32_t shell = c.hits[i];
        if (!seen[shell])
          continue;
        seen[shell] = 0;
        if (inside[shell]++ > 0)
          continue;
        BW_TRY_MEMORY(bw_grow(context, (void **)&list, &list_capacity, listed, 1, sizeof *list));
        list[listed++] = shell;
      }
    }
    for (size_t i = 0; i < listed; i++) {
      depth[s] += inside[list[i]] == decided;
      inside[list[i]] = 0;
    }
  }
done:
  bw_free(facets);
  bw_free(sample);
  bw_free(inside);
  bw_free(seen);
  bw_free(no_wall);
  bw_free(c.hits);
  bw_free(list);
  bwi_tree_destroy(tree);
  return status;
}

bw_status bwi_inside(bw_context *context, const bwi_topology *topology, const bwi_tree *tree,
                     const double x[3], double size, bool *inside, bool *unclear) {
  crossing c = {.context = context, .topology = topology, .own = -1};
  bw_status status = count_crossings(&c, tree, x, size);
  *unclear = c.unclear;
  *inside = !c.unclear && c.count % 2 == 1;
  bw_free(c.hits);
  return status;
}

bw_status bwi_moved_outside(bw_context *context, const bw_surface *before, const bw_surface *after,
                            double *moved) {
  bw_status status = BW_OK;
  bwi_topology *topology = NULL;
  bwi_tree *tree = NULL;
  uint8_t *flat = NULL;
  double worst = 0, size = 2 * (bwi_surface_diagonal(before) + bwi_surface_diagonal(after));
  int32_t hint = -1;
  BW_TRY(bwi_one_sided_distance(context, after, before, &worst));
  BW_TRY(bwi_topology_create(context, after, &topology));
  flat = BW_NEW(context, uint8_t, topology->facets);
  BW_TRY_MEMORY(flat);
  BW_TRY(bwi_flat_facets(context, topology, flat));
  BW_TRY(
      bwi_tree_create(context, topology->point, topology->facets, topology->corner, flat, &tree));
  for (int64_t t = 0; t < before->triangle_count; t++) {
    const int32_t *corner = before->triangle + 3 * t;
    if (t % 1024 == 0)
      BW_TRY(bw_check_cancel(context));
    for (int s = 0; s < 4; s++) { /* the middle, and points near the corners */
      double x[3], place[3];
      facet_centroid(before->point, corner, x);
      for (int k = 0; k < 3 && s > 0; k++)
        x[k] += 0.99 * (before->point[3 * (int64_t)corner[s - 1] + k] - x[k]);
      double far = bwi_tree_nearest(tree, x, hint, worst * worst, place, &hint);
      if (far <= worst * worst)
        continue;
      bool inside, unclear;
      BW_TRY(bwi_inside(context, topology, tree, x, size, &inside, &unclear));
      if (!inside)
        worst = sqrt(far);
    }
  }
  *moved = bwi_above_rounding(before, worst);
done:
  bwi_topology_destroy(topology);
  bwi_tree_destroy(tree);
  bw_free(flat);
  return status;
}
