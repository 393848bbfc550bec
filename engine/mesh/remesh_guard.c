/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* What a change of the remeshed surface must not do: leave the surface, leave a crease, or come
 * near what lies opposite; and what remeshing as a whole may take. */
#include "mesh/remesh.h"
#include "mesh/surface_internal.h"
#include "mesh/tetgen_run.h"

bw_status bwi_remesh_check(const bwi_remesher *r) {
  if (r->mesh && (double)r->mesh->facet_count * BWI_REMESH_BYTES_OF_FACET > r->memory) {
    bw_fail(r->context, BW_LIMIT,
            "remeshing needs more than the %.3g bytes it may use: ask for longer edges, or raise "
            "memory_limit",
            r->memory);
    bw_detail_text(r->context, "limit", "memory");
    return BW_LIMIT;
  }
  if (r->max_checks > 0 && ++*r->checks > r->max_checks) {
    bw_fail(r->context, BW_LIMIT,
            "remeshing with edges of %g m took more than the %lld steps it may use: ask for longer "
            "edges",
            r->length, (long long)r->max_checks << BWI_REMESH_CHECK_BITS);
    bw_detail_text(r->context, "limit", "steps");
    return BW_LIMIT;
  }
  bw_progress(r->context, "remeshing", r->fraction); /* who is shown it may cancel */
  return bwi_time_limit_check(r->context, &r->time);
}

/* How far the surface may be left near a point. */
double bwi_remesh_slack(const bwi_remesher *r, double size) {
  double tenth = 0.1 * fmax(size, 0.25 * r->length);
  return tenth < r->tolerance ? tenth : r->tolerance;
}

static bool remesh_near_surface(const bwi_remesher *r, const double x[3], double limit) {
  double place[3];
  int32_t facet;
  double far = bwi_tree_nearest(r->tree, x, -1, limit * limit, place, &facet);
  if (far > limit * limit)
    return false;
  double close = fmax(0.2 * r->clearance[facet], 0.01 * r->length);
  if (close >= limit || far <= close * close)
    return true;
  far = bwi_tree_nearest(r->tree, x, facet, 0, place, &facet);
  close = fmax(0.2 * r->clearance[facet], 0.01 * r->length);
  return far <= close * close;
}

bool bwi_remesh_near_crease(const bwi_remesher *r, const double a[3], const double b[3],
                            double limit) {
  for (int i = 1; i < 4; i++) {
    double x[3], place[3];
    int32_t facet;
    for (int k = 0; k < 3; k++)
      x[k] = a[k] + 0.25 * i * (b[k] - a[k]);
    if (bwi_tree_nearest(r->creases, x, -1, limit * limit, place, &facet) > limit * limit)
      return false;
  }
  return true;
}

bool bwi_remesh_facet_near_surface(const bwi_remesher *r, const double a[3], const double b[3],
                                   const double c[3], double limit) {
  double middle[3], ab[3], ca[3];
  for (int k = 0; k < 3; k++) {
    middle[k] = (a[k] + b[k] + c[k]) / 3;
    ab[k] = 0.5 * (a[k] + b[k]);
    ca[k] = 0.5 * (a[k] + c[k]);
  }
  return remesh_near_surface(r, middle, limit) && remesh_near_surface(r, ab, limit) &&
         remesh_near_surface(r, ca, limit);
}

double bwi_remesh_size_near(const bwi_remesher *r, const double x[3]) {
  double size = r->length;
  for (size_t i = 0; i < r->fine_count; i++)
    size = fmin(size, r->fine_points[i].size + growth * distance(x, r->fine_points[i].at));
  double bound = r->sizes ? bwi_size_at(r->sizes, x) : 0;
  return bound > 0 ? fmin(size, bound) : size;
}

typedef struct ray {
  const bw_surface *surface;
  const double *from, *along; /* a unit vector */
  int32_t own;
  double hit; /* the nearest so far */
} ray;

static bool hit(void *data, int32_t facet) {
  ray *shot = (ray *)data;
  if (facet == shot->own)
    return true;
  const int32_t *corner = shot->surface->triangle + 3 * (int64_t)facet;
  const double *a = shot->surface->point + 3 * (int64_t)corner[0],
               *b = shot->surface->point + 3 * (int64_t)corner[1],
               *c = shot->surface->point + 3 * (int64_t)corner[2];
  double u[3], v[3], w[3], n[3], p[3], q[3];
  for (int k = 0; k < 3; k++) {
    u[k] = b[k] - a[k];
    v[k] = c[k] - a[k];
    w[k] = shot->from[k] - a[k];
  }
  bw_cross(u, v, n);
  double speed = bw_dot(n, shot->along);
  if (speed == 0)
    return true;
  double t = -bw_dot(n, w) / speed;
  for (int k = 0; k < 3; k++)
    p[k] = w[k] + t * shot->along[k];
  bw_cross(p, v, q);
  double s = bw_dot(q, n) / bw_dot(n, n);
  bw_cross(u, p, q);
  double o = bw_dot(q, n) / bw_dot(n, n);
  if (t > 0 && t < shot->hit && s >= 0 && o >= 0 && s + o <= 1)
    shot->hit = t;
  return true;
}

/* Look from the middle of each facet straight in and straight out. */
bw_status bwi_remesh_find_clearance(void *data, int64_t begin, int64_t end, int worker) {
  bwi_remesher *r = (bwi_remesher *)data;
  (void)worker;
  for (int64_t t = begin; t < end; t++) {
    double n[3], middle[3] = {0}, far[3];
    bwi_facet_normal(r->original->point, r->original->triangle + 3 * t, n);
    double length = bw_norm(n);
    r->clearance[t] = 5 * r->length;
    for (int k = 0; k < 9; k++)
      middle[k % 3] +=
          r->original->point[3 * (int64_t)r->original->triangle[3 * t + k / 3] + k % 3] / 3;
    for (int way = -1; way < 2 && length > 0; way += 2) {
      double along[3];
      for (int k = 0; k < 3; k++) {
        along[k] = way * n[k] / length;
        far[k] = middle[k] + 5 * r->length * along[k];
      }
      ray shot = {r->original, middle, along, (int32_t)t, r->clearance[t]};
      bwi_tree_on_segment(r->tree, middle, far, hit, &shot);
      r->clearance[t] = shot.hit;
    }
  }
  return BW_OK;
}
