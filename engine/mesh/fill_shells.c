/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* Cavities of a surface of several shells. A shell's depth is the number of other shells around it;
 * odd depths bound cavities. Containment is decided by the solid angle that a shell fills seen from
 * a point of the other: 4 pi or nothing, with no special cases on edges. A point inside a cavity is
 * the middle of a ray from one of its facets to whatever it meets first; of several rays the
 * longest, so that the point keeps its distance from every facet. */
#include "base/union_find.h"
#include "mesh/fill_internal.h"

#include <math.h>
#include <string.h>

typedef struct shell {
  int64_t first, count; /* its triangles in `order` */
  double low[3], high[3];
  double volume;
  int32_t largest; /* its triangle of largest area */
  int depth;
} shell;

typedef struct shells {
  const bw_surface *surface;
  int32_t count;
  shell *shell;
  int32_t *order; /* triangles by shell */
} shells;

static void corners(const bw_surface *surface, int32_t triangle, const double *x[3]) {
  for (int k = 0; k < 3; k++)
    x[k] = surface->point + 3 * (size_t)surface->triangle[3 * (size_t)triangle + (size_t)k];
}

static void normal_of(const bw_surface *surface, int32_t triangle, double centre[3],
                      double normal[3]) {
  const double *x[3];
  double a[3], b[3];
  corners(surface, triangle, x);
  for (int k = 0; k < 3; k++) {
    a[k] = x[1][k] - x[0][k];
    b[k] = x[2][k] - x[0][k];
    centre[k] = (x[0][k] + x[1][k] + x[2][k]) / 3;
  }
  bw_cross(a, b, normal);
}

/* Shells: triangles connected through points, in the order of their first triangles. */
static bw_status find_shells(bw_context *context, shells *all) {
  const bw_surface *surface = all->surface;
  bw_status status = BW_OK;
  int32_t *parent = BW_NEW(context, int32_t, surface->point_count);
  int32_t *number = BW_NEW(context, int32_t, surface->point_count);
  all->order = BW_NEW(context, int32_t, surface->triangle_count);
  BW_TRY_MEMORY(parent && number && all->order);
  for (int32_t i = 0; i < surface->point_count; i++) {
    parent[i] = i;
    number[i] = -1;
  }
  for (int32_t i = 0; i < surface->triangle_count; i++)
    for (size_t k = 1; k < 3; k++)
      bwi_set_join(parent, surface->triangle[3 * (size_t)i], surface->triangle[3 * (size_t)i + k]);
  for (int32_t i = 0; i < surface->triangle_count; i++) {
    int32_t root = bwi_set_root(parent, surface->triangle[3 * (size_t)i]);
    if (number[root] < 0)
      number[root] = all->count++;
  }
  all->shell = BW_NEW0(context, shell, all->count);
  BW_TRY_MEMORY(all->shell);
  for (int32_t i = 0; i < surface->triangle_count; i++)
    all->shell[number[bwi_set_root(parent, surface->triangle[3 * (size_t)i])]].count++;
  for (int32_t s = 1; s < all->count; s++)
    all->shell[s].first = all->shell[s - 1].first + all->shell[s - 1].count;
  for (int32_t s = 0; s < all->count; s++)
    all->shell[s].count = 0;
  for (int32_t i = 0; i < surface->triangle_count; i++) {
    shell *one = &all->shell[number[bwi_set_root(parent, surface->triangle[3 * (size_t)i])]];
    all->order[one->first + one->count++] = i;
  }
done:
  bw_free(parent);
  bw_free(number);
  return status;
}

static void measure_shell(const shells *all, shell *one) {
  double best = -1;
  for (int k = 0; k < 3; k++) {
    one->low[k] = INFINITY;
    one->high[k] = -INFINITY;
  }
  const double *origin = NULL;
  for (int64_t i = one->first; i < one->first + one->count; i++) {
    const double *x[3];
    double centre[3], normal[3], arm[3];
    corners(all->surface, all->order[i], x);
    normal_of(all->surface, all->order[i], centre, normal);
    if (!origin)
      origin = x[0];
    for (int c = 0; c < 3; c++)
      for (int k = 0; k < 3; k++) {
        one->low[k] = fmin(one->low[k], x[c][k]);
        one->high[k] = fmax(one->high[k], x[c][k]);
      }
    for (int k = 0; k < 3; k++)
      arm[k] = centre[k] - origin[k];
    one->volume += bw_dot(arm, normal) / 6;
    if (bw_dot(normal, normal) > best) {
      best = bw_dot(normal, normal);
      one->largest = all->order[i];
    }
  }
}

/* Is p inside the shell? The sum of the solid angles of its triangles, by van Oosterom's
 * formula. */
static bool holds(const shells *all, const shell *one, const double p[3]) {
  for (int k = 0; k < 3; k++)
    if (p[k] < one->low[k] || p[k] > one->high[k])
      return false;
  double sum = 0;
  for (int64_t i = one->first; i < one->first + one->count; i++) {
    const double *x[3];
    double r[3][3], length[3], c[3];
    corners(all->surface, all->order[i], x);
    for (int j = 0; j < 3; j++) {
      for (int k = 0; k < 3; k++)
        r[j][k] = x[j][k] - p[k];
      length[j] = bw_norm(r[j]);
    }
    bw_cross(r[1], r[2], c);
    double upper = bw_dot(r[0], c);
    double lower = length[0] * length[1] * length[2] + bw_dot(r[0], r[1]) * length[2] +
                   bw_dot(r[1], r[2]) * length[0] + bw_dot(r[2], r[0]) * length[1];
    sum += 2 * atan2(upper, lower);
  }
  return fabs(sum) > 6.28; /* 4 pi inside, 0 outside */
}

/* How far a ray runs before it meets a triangle other than `from`, edges and corners included. */
static double first_hit(const bw_surface *surface, const double start[3], const double ray[3],
                        int32_t from) {
  double nearest = INFINITY;
  for (int32_t i = 0; i < surface->triangle_count; i++) {
    if (i == from)
      continue;
    const double *x[3];
    double a[3], b[3], s[3], p[3], q[3];
    corners(surface, i, x);
    for (int k = 0; k < 3; k++) {
      a[k] = x[1][k] - x[0][k];
      b[k] = x[2][k] - x[0][k];
      s[k] = start[k] - x[0][k];
    }
    bw_cross(ray, b, p);
    double determinant = bw_dot(a, p);
    if (determinant == 0)
      continue;
    bw_cross(s, a, q);
    double u = bw_dot(s, p) / determinant, v = bw_dot(ray, q) / determinant;
    double t = bw_dot(b, q) / determinant;
    if (u >= -1e-9 && v >= -1e-9 && u + v <= 1 + 1e-9 && t > 0 && t < nearest)
      nearest = t;
  }
  return nearest;
}

/* A point inside the shell and outside everything within it. */
static bw_status point_inside(bw_context *context, const shells *all, const shell *one,
                              double at[3]) {
  enum { RAYS = 12 };
  double best = 0;
  for (int ray = 0; ray < RAYS; ray++) {
    int32_t triangle = one->largest; /* that one, and others spread over the shell */
    if (ray > 0)
      triangle = all->order[one->first + (one->count - 1) * (ray - 1) / (RAYS - 1)];
    double centre[3], normal[3];
    normal_of(all->surface, triangle, centre, normal);
    double length = bw_norm(normal) * (one->volume > 0 ? -1 : 1);
    if (length == 0)
      continue;
    for (int k = 0; k < 3; k++)
      normal[k] /= length;
    double run = first_hit(all->surface, centre, normal, triangle);
    if (!(run > best) || !isfinite(run))
      continue;
    best = run;
    for (int k = 0; k < 3; k++)
      at[k] = centre[k] + normal[k] * run / 2;
  }
  if (best > 0)
    return BW_OK;
  double centre[3], normal[3];
  normal_of(all->surface, one->largest, centre, normal);
  return bw_fail(context, BW_GEOMETRY,
                 "no point was found inside the cavity of %lld facets near (%g, %g, %g) m",
                 (long long)one->count, centre[0], centre[1], centre[2]);
}

bw_status bwi_find_cavities(bw_context *context, const bw_surface *surface, double **hole,
                            int32_t *holes) {
  bw_status status = BW_OK;
  shells all = {.surface = surface};
  double *list = NULL;
  int32_t count = 0;
  BW_TRY(find_shells(context, &all));
  if (all.count > 1) {
    for (int32_t s = 0; s < all.count; s++)
      measure_shell(&all, &all.shell[s]);
    for (int32_t s = 0; s < all.count; s++) {
      double centre[3], normal[3];
      normal_of(surface, all.shell[s].largest, centre, normal);
      for (int32_t other = 0; other < all.count; other++)
        if (other != s && holds(&all, &all.shell[other], centre))
          all.shell[s].depth++;
      count += all.shell[s].depth % 2;
      BW_TRY(bw_check_cancel(context));
    }
  }
  list = BW_NEW(context, double, 3 * (size_t)count);
  BW_TRY_MEMORY(list);
  int32_t at = 0;
  for (int32_t s = 0; s < all.count; s++)
    if (all.shell[s].depth % 2) {
      BW_TRY(point_inside(context, &all, &all.shell[s], list + 3 * (size_t)at));
      at++;
      BW_TRY(bw_check_cancel(context));
    }
  *hole = list;
  *holes = count;
  list = NULL;
done:
  bw_free(list);
  bw_free(all.shell);
  bw_free(all.order);
  return status;
}
