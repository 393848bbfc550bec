/* A closed triangle mesh that can be changed.
 *
 * Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
#include "mesh/remesh_mesh.h"

#include <math.h>
#include <string.h>

#include "mesh/surface_internal.h"
#include "mesh/surface_topology.h"

void bwi_changing_destroy(bwi_changing *mesh) {
  if (!mesh)
    return;
  bw_free(mesh->point);
  bw_free(mesh->size);
  bw_free(mesh->fixed);
  bw_free(mesh->side);
  bw_free(mesh->corner);
  bw_free(mesh->opposite);
  bw_free(mesh->sharp);
  bw_free(mesh->group);
  bw_free(mesh);
}

/* Room for more points and facets; all arrays grow together. */
static bw_status reserve(bwi_changing *mesh, size_t points, size_t facets) {
  bw_context *context = mesh->context;
  if (mesh->point_count + points > mesh->point_capacity) {
    size_t capacity = 2 * (mesh->point_count + points);
    void *block;
#define GROW(list, width)                                                                          \
  do {                                                                                             \
    block = bw_resize(context, mesh->list, capacity * (width), sizeof *mesh->list);                \
    if (!block)                                                                                    \
      return BW_MEMORY;                                                                            \
    mesh->list = block;                                                                            \
  } while (0)
    GROW(point, 3);
    GROW(size, 1);
    GROW(fixed, 1);
    GROW(side, 1);
    mesh->point_capacity = capacity;
  }
  if (mesh->facet_count + facets > mesh->facet_capacity) {
    size_t capacity = 2 * (mesh->facet_count + facets);
    void *block;
    if (capacity > INT32_MAX / 3)
      return bw_fail(context, BW_LIMIT,
                     "remeshing needs more than %d facets: give a larger edge length",
                     INT32_MAX / 3);
    GROW(corner, 3);
    GROW(opposite, 3);
    GROW(sharp, 3);
    GROW(group, 1);
    mesh->facet_capacity = capacity;
  }
  return BW_OK;
#undef GROW
}

static double angle_between(const bwi_changing *mesh, int32_t s, int32_t t) {
  double m[3], n[3], c[3];
  bwi_facet_normal(mesh->point, mesh->corner + s / 3 * 3, m);
  bwi_facet_normal(mesh->point, mesh->corner + t / 3 * 3, n);
  bw_cross(m, n, c);
  return atan2(bw_norm(c), bw_dot(m, n));
}

void bwi_changing_classify(bwi_changing *mesh) {
  for (int32_t p = 0; p < (int32_t)mesh->point_count; p++) {
    int32_t start = mesh->side[p], s = start, ends[2] = {0, 0};
    int count = 0;
    do {
      if (mesh->sharp[s]) {
        if (count < 2)
          ends[count] = bwi_to(mesh, s);
        count++;
      }
      s = bwi_around(mesh, s);
    } while (s != start);
    mesh->fixed[p] = count == 0 ? BWI_FREE : BWI_CORNER;
    if (count == 2) {
      double u[3], v[3];
      for (int k = 0; k < 3; k++) {
        u[k] = bwi_at(mesh, p)[k] - bwi_at(mesh, ends[0])[k];
        v[k] = bwi_at(mesh, ends[1])[k] - bwi_at(mesh, p)[k];
      }
      if (bw_dot(u, v) > 0.75 * bw_norm(u) * bw_norm(v)) /* turns by less than 41 degrees */
        mesh->fixed[p] = BWI_CREASE;
    }
  }
}

bw_status bwi_changing_create(bw_context *context, const bw_surface *surface, double sharp_angle,
                              bwi_changing **out) {
  bw_status status = BW_OK;
  bwi_topology *topology = NULL;
  bwi_changing *mesh = BW_NEW0(context, bwi_changing, 1);
  if (!mesh)
    return BW_MEMORY;
  mesh->context = context;
  size_t points = (size_t)surface->point_count, facets = (size_t)surface->triangle_count;
  BW_TRY(reserve(mesh, points, facets));
  BW_TRY(bwi_topology_create(context, surface, &topology));
  mesh->point_count = points;
  mesh->facet_count = facets;
  memcpy(mesh->point, surface->point, 3 * points * sizeof *mesh->point);
  memcpy(mesh->corner, surface->triangle, 3 * facets * sizeof *mesh->corner);
  if (surface->group)
    memcpy(mesh->group, surface->group, facets * sizeof *mesh->group);
  else
    memset(mesh->group, 0, facets * sizeof *mesh->group);
  for (int32_t s = 0; s < 3 * (int32_t)facets; s++)
    mesh->side[mesh->corner[s]] = s;
  for (int64_t e = 0; e < topology->edges; e++) {
    int64_t first = topology->start[e];
    int32_t s = (int32_t)topology->side[first], t = (int32_t)topology->side[first + 1];
    if (topology->start[e + 1] - first != 2 || mesh->corner[s] == mesh->corner[t])
      BW_TRY(bw_fail(context, BW_INTERNAL, "remeshing met an edge that is not manifold"));
    mesh->opposite[s] = t;
    mesh->opposite[t] = s;
    mesh->sharp[s] = mesh->sharp[t] = angle_between(mesh, s, t) > sharp_angle;
  }
  bwi_changing_classify(mesh);
  *out = mesh;
  mesh = NULL;
done:
  bwi_topology_destroy(topology);
  bwi_changing_destroy(mesh);
  return status;
}

bw_status bwi_changing_surface(const bwi_changing *mesh, bool groups, bw_surface **surface) {
  bw_status status = BW_OK;
  int64_t points = 0, facets = 0;
  int32_t *number = BW_NEW(mesh->context, int32_t, mesh->point_count);
  double *point = BW_NEW(mesh->context, double, 3 * mesh->point_count);
  int32_t *triangle = BW_NEW(mesh->context, int32_t, 3 * mesh->facet_count);
  int32_t *group = groups ? BW_NEW(mesh->context, int32_t, mesh->facet_count) : NULL;
  BW_TRY_MEMORY(number && point && triangle && (!groups || group));
  for (size_t p = 0; p < mesh->point_count; p++)
    if (mesh->side[p] >= 0) {
      memcpy(point + 3 * points, mesh->point + 3 * p, 3 * sizeof *point);
      number[p] = (int32_t)points++;
    }
  for (size_t t = 0; t < mesh->facet_count; t++) {
    if (mesh->corner[3 * t] < 0)
      continue;
    for (int k = 0; k < 3; k++)
      triangle[3 * facets + k] = number[mesh->corner[3 * t + (size_t)k]];
    if (group)
      group[facets] = mesh->group[t];
    facets++;
  }
  BW_TRY(bw_surface_copy(mesh->context, points, point, facets, triangle, group, surface));
done:
  bw_free(number);
  bw_free(point);
  bw_free(triangle);
  bw_free(group);
  return status;
}

static void join(bwi_changing *mesh, int32_t s, int32_t t, uint8_t sharp) {
  mesh->opposite[s] = t;
  mesh->opposite[t] = s;
  mesh->sharp[s] = mesh->sharp[t] = sharp;
}

/*        c                     c
 *      /   \                 / | \
 *     /  s  \      s: a-b   /t0|t1\      t0 = (a m c), the old facet; t1 = (m b c), new
 *    a ----- b     ->      a --m-- b     o0 = (m a d), the old opposite with b -> m ...
 *     \  o  /               \  |  /
 *      \   /                 \ | /
 *        d                     d                                                          */
bw_status bwi_split(bwi_changing *mesh, int32_t side, const double at[3], int32_t *made) {
  bw_status status = reserve(mesh, 1, 2);
  if (status != BW_OK)
    return status;
  int32_t other = mesh->opposite[side];
  int32_t a = bwi_from(mesh, side), b = bwi_to(mesh, side);
  int32_t s1 = bwi_next(side), o1 = bwi_next(other), o2 = bwi_previous(other);
  int32_t c = bwi_to(mesh, s1), d = bwi_to(mesh, o1);
  int32_t m = (int32_t)mesh->point_count++;
  int32_t t = 3 * (int32_t)mesh->facet_count, u = t + 3; /* the new facets' first sides */
  mesh->facet_count += 2;
  uint8_t sharp = mesh->sharp[side];
  memcpy(bwi_at(mesh, m), at, 3 * sizeof *at);
  mesh->size[m] = 0.5 * (mesh->size[a] + mesh->size[b]);
  mesh->fixed[m] = sharp ? BWI_CREASE : BWI_FREE;
  mesh->group[t / 3] = mesh->group[side / 3];
  mesh->group[u / 3] = mesh->group[other / 3];
  int32_t bc = mesh->opposite[s1], db = mesh->opposite[o2];
  uint8_t bc_sharp = mesh->sharp[s1], db_sharp = mesh->sharp[o2];
  /* side: a-m, s1: m-c, s2: c-a */
  mesh->corner[s1] = m;
  /* t: m-b, b-c, c-m */
  mesh->corner[t] = m;
  mesh->corner[t + 1] = b;
  mesh->corner[t + 2] = c;
  /* other was b-a, a-d, d-b: it becomes m-a, a-d, d-m */
  mesh->corner[other] = m;
  /* u: b-m, m-d, d-b */
  mesh->corner[u] = b;
  mesh->corner[u + 1] = m;
  mesh->corner[u + 2] = d;
  join(mesh, side, other, sharp);
  join(mesh, t, u, sharp);
  join(mesh, s1, t + 2, 0);
  join(mesh, o2, u + 1, 0);
  join(mesh, t + 1, bc, bc_sharp);
  join(mesh, u + 2, db, db_sharp);
  mesh->side[m] = t;
  mesh->side[b] = t + 1;
  mesh->side[c] = t + 2;
  mesh->side[d] = u + 2;
  mesh->side[a] = side;
  *made = m;
  return BW_OK;
}

static bool neighbours(const bwi_changing *mesh, int32_t a, int32_t b) {
  int32_t start = mesh->side[a], s = start;
  do {
    if (bwi_to(mesh, s) == b)
      return true;
    s = bwi_around(mesh, s);
  } while (s != start);
  return false;
}

static int valence(const bwi_changing *mesh, int32_t point) {
  int count = 0;
  int32_t start = mesh->side[point], s = start;
  do {
    count++;
    s = bwi_around(mesh, s);
  } while (s != start);
  return count;
}

bool bwi_may_collapse(const bwi_changing *mesh, int32_t side) {
  int32_t other = mesh->opposite[side];
  int32_t a = bwi_from(mesh, side), b = bwi_to(mesh, side);
  int32_t c = bwi_to(mesh, bwi_next(side)), d = bwi_to(mesh, bwi_next(other));
  if (c == d || valence(mesh, c) <= 3 || valence(mesh, d) <= 3)
    return false;
  /* The ends may have no neighbours in common but c and d. */
  int32_t start = mesh->side[a], s = start;
  do {
    int32_t p = bwi_to(mesh, s);
    if (p != b && p != c && p != d && neighbours(mesh, b, p))
      return false;
    s = bwi_around(mesh, s);
  } while (s != start);
  return true;
}

void bwi_collapse(bwi_changing *mesh, int32_t side) {
  int32_t other = mesh->opposite[side];
  int32_t a = bwi_from(mesh, side), b = bwi_to(mesh, side);
  int32_t s1 = bwi_next(side), s2 = bwi_previous(side);
  int32_t o1 = bwi_next(other), o2 = bwi_previous(other);
  int32_t c = bwi_to(mesh, s1), d = bwi_to(mesh, o1);
  int32_t start = side, s = start;
  do {
    int32_t next = bwi_around(mesh, s);
    mesh->corner[s] = b;
    s = next;
  } while (s != start);
  /* the edges a-c and b-c become one; so do a-d and b-d */
  int32_t bc = mesh->opposite[s1], ca = mesh->opposite[s2];
  int32_t ad = mesh->opposite[o1], db = mesh->opposite[o2];
  join(mesh, bc, ca, mesh->sharp[bc] | mesh->sharp[ca]);
  join(mesh, ad, db, mesh->sharp[ad] | mesh->sharp[db]);
  mesh->side[b] = ca; /* a-c, now b-c */
  mesh->side[c] = bc; /* c-b */
  mesh->side[d] = ad; /* d-a, now d-b */
  mesh->side[a] = -1;
  for (int k = 0; k < 3; k++) {
    mesh->corner[side / 3 * 3 + k] = -1;
    mesh->corner[other / 3 * 3 + k] = -1;
  }
}

bool bwi_may_flip(const bwi_changing *mesh, int32_t side) {
  int32_t other = mesh->opposite[side];
  int32_t a = bwi_from(mesh, side), b = bwi_to(mesh, side);
  int32_t c = bwi_to(mesh, bwi_next(side)), d = bwi_to(mesh, bwi_next(other));
  return !mesh->sharp[side] && c != d && !neighbours(mesh, c, d) && valence(mesh, a) > 3 &&
         valence(mesh, b) > 3;
}

void bwi_flip(bwi_changing *mesh, int32_t side) {
  int32_t other = mesh->opposite[side];
  int32_t a = bwi_from(mesh, side), b = bwi_to(mesh, side);
  int32_t s1 = bwi_next(side), s2 = bwi_previous(side);
  int32_t o1 = bwi_next(other), o2 = bwi_previous(other);
  int32_t c = bwi_to(mesh, s1), d = bwi_to(mesh, o1);
  int32_t bc = mesh->opposite[s1], ca = mesh->opposite[s2];
  int32_t ad = mesh->opposite[o1], db = mesh->opposite[o2];
  uint8_t bc_sharp = mesh->sharp[s1], ca_sharp = mesh->sharp[s2], ad_sharp = mesh->sharp[o1],
          db_sharp = mesh->sharp[o2];
  /* side: d-c, s1: c-a, s2: a-d;  other: c-d, o1: d-b, o2: b-c */
  mesh->corner[side] = d;
  mesh->corner[s1] = c;
  mesh->corner[s2] = a;
  mesh->corner[other] = c;
  mesh->corner[o1] = d;
  mesh->corner[o2] = b;
  join(mesh, side, other, 0);
  join(mesh, s1, ca, ca_sharp);
  join(mesh, s2, ad, ad_sharp);
  join(mesh, o1, db, db_sharp);
  join(mesh, o2, bc, bc_sharp);
  mesh->side[a] = s2;
  mesh->side[b] = o2;
  mesh->side[c] = s1;
  mesh->side[d] = o1;
}
