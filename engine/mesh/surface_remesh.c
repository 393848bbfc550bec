/* Isotropic remeshing: triangles of a wanted size that follow a surface.
 *
 * Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later.
 *
 * Rounds of: split edges longer than 4/3 of the wanted length, collapse those shorter than 4/5,
 * flip where the smallest angle grows, move points towards the middle of their neighbours and back
 * onto the surface (Botsch and Kobbelt, A remeshing approach to multiresolution modeling, 2004).
 * Every change is refused that turns a facet over, leaves the surface by more than a tenth of the
 * wanted length there (or the tolerance), or merges sharp edges. An edge that stays short because
 * its collapse is refused marks a feature smaller than the wanted length: the length wanted there
 * is taken down to suit, and grows from there by at most a half of the distance. The result is
 * checked; where it cuts itself the same is done around the cut, and all starts again. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "barwright/mesh.h"
#include "mesh/remesh_mesh.h"
#include "mesh/surface_cgal.h"
#include "mesh/surface_internal.h"
#include "mesh/surface_topology.h"
#include "mesh/surface_tree.h"

static const double longest = 4.0 / 3, shortest = 4.0 / 5; /* of the wanted length */
static const double growth = 0.5;                          /* of the wanted length, per distance */
static const double finest = 1.0 / 12;                     /* of the edge length asked for */
static const double turn = 0.5; /* cosine of the largest turn of a facet in one change */

void bw_remesh_options_default(bw_remesh_options *options) {
  *options = (bw_remesh_options){.sharp_angle = 40 * 3.14159265358979323846 / 180, .iterations = 5};
}

/* A place where edges must be finer than asked for. */
typedef struct fine_place {
  double at[3], size;
} fine_place;

typedef struct remesher {
  bw_context *context;
  const bw_surface *original;
  bwi_changing *mesh;
  bwi_tree *tree, *creases;
  int32_t *crease; /* sharp edges of the original as triangles a b b */
  double length, tolerance;
  double tiny;        /* edges so short go even where they are features */
  double most_facets; /* no more edges are split beyond */
  double *room; /* per facet of the original: how far what lies opposite is, inside or outside */
  fine_place *fine;
  size_t fine_count, fine_capacity;
} remesher;

/* ---- measures ------------------------------------------------------------------------------ */

static double distance(const double a[3], const double b[3]) {
  double d[3] = {b[0] - a[0], b[1] - a[1], b[2] - a[2]};
  return bw_norm(d);
}

static double side_length(const bwi_changing *mesh, int32_t side) {
  return distance(bwi_at(mesh, bwi_from(mesh, side)), bwi_at(mesh, bwi_to(mesh, side)));
}

static double wanted(const bwi_changing *mesh, int32_t side) {
  return 0.5 * (mesh->size[bwi_from(mesh, side)] + mesh->size[bwi_to(mesh, side)]);
}

static void normal_of(const double a[3], const double b[3], const double c[3], double n[3]) {
  double u[3], v[3];
  for (int k = 0; k < 3; k++) {
    u[k] = b[k] - a[k];
    v[k] = c[k] - a[k];
  }
  bw_cross(u, v, n);
}

/* 4 sqrt(3) area over the sum of squared sides: 1 for an equilateral triangle, 0 for a flat one. */
static double quality(const double a[3], const double b[3], const double c[3]) {
  double n[3], ab = distance(a, b), bc = distance(b, c), ca = distance(c, a);
  normal_of(a, b, c, n);
  double sum = ab * ab + bc * bc + ca * ca;
  return sum > 0 ? 3.4641016151377544 * bw_norm(n) / sum : 0;
}

static bool turned_over(const double before[3], const double after[3]) {
  return bw_dot(before, after) <= turn * bw_norm(before) * bw_norm(after);
}

/* How far the surface may be left near a point. */
static double slack(const remesher *r, double size) {
  double tenth = 0.1 * fmax(size, 0.25 * r->length);
  return tenth < r->tolerance ? tenth : r->tolerance;
}

static bool near_surface(const remesher *r, const double x[3], double limit) {
  double place[3];
  int32_t facet;
  double far = bwi_tree_nearest(r->tree, x, -1, limit * limit, place, &facet);
  if (far > limit * limit)
    return false;
  double close = fmax(0.2 * r->room[facet], 0.01 * r->length);
  if (close >= limit || far <= close * close)
    return true;
  far = bwi_tree_nearest(r->tree, x, facet, 0, place, &facet);
  close = fmax(0.2 * r->room[facet], 0.01 * r->length);
  return far <= close * close;
}

static bool near_crease(const remesher *r, const double a[3], const double b[3], double limit) {
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

static bool facet_near_surface(const remesher *r, const double a[3], const double b[3],
                               const double c[3], double limit) {
  double middle[3], ab[3], ca[3];
  for (int k = 0; k < 3; k++) {
    middle[k] = (a[k] + b[k] + c[k]) / 3;
    ab[k] = 0.5 * (a[k] + b[k]);
    ca[k] = 0.5 * (a[k] + c[k]);
  }
  return near_surface(r, middle, limit) && near_surface(r, ab, limit) && near_surface(r, ca, limit);
}

static double size_near(const remesher *r, const double x[3]) {
  double size = r->length;
  for (size_t i = 0; i < r->fine_count; i++)
    size = fmin(size, r->fine[i].size + growth * distance(x, r->fine[i].at));
  return size;
}

/* ---- split ---------------------------------------------------------------------------------- */

/* Is a side, relative to what is wanted, the longest of both facets along it? Splitting others
 * first would leave ever thinner triangles. */
static bool is_longest(const bwi_changing *mesh, int32_t side, double ratio) {
  int32_t other = mesh->opposite[side];
  const int32_t sides[4] = {bwi_next(side), bwi_previous(side), bwi_next(other),
                            bwi_previous(other)};
  for (int k = 0; k < 4; k++)
    if (side_length(mesh, sides[k]) > 1.0001 * ratio * wanted(mesh, sides[k]))
      return false;
  return true;
}

/* Long loops look up now and then. */
static bw_status look_up(const remesher *r, size_t step) {
  return step % 1024 == 0 ? bw_check_cancel(r->context) : BW_OK;
}

static bw_status split_long(remesher *r) {
  bwi_changing *mesh = r->mesh;
  bw_status status = BW_OK;
  for (int pass = 0; pass < 100; pass++) {
    int64_t splits = 0;
    int32_t sides = 3 * (int32_t)mesh->facet_count;
    if ((double)mesh->facet_count > r->most_facets)
      break; /* needles that come out of needles: better too long than without end */
    for (int32_t s = 0; s < sides; s++) {
      BW_TRY(look_up(r, (size_t)s));
      if (mesh->corner[s] < 0 || s > mesh->opposite[s])
        continue;
      double ratio = side_length(mesh, s) / wanted(mesh, s);
      if (ratio <= longest || !is_longest(mesh, s, ratio))
        continue;
      double at[3];
      int32_t made;
      const double *a = bwi_at(mesh, bwi_from(mesh, s)), *b = bwi_at(mesh, bwi_to(mesh, s));
      for (int k = 0; k < 3; k++)
        at[k] = 0.5 * (a[k] + b[k]);
      BW_TRY(bwi_split(mesh, s, at, &made));
      mesh->size[made] = fmin(mesh->size[made], size_near(r, at));
      splits++;
    }
    if (splits == 0)
      break;
  }
done:
  return status;
}

/* ---- collapse ------------------------------------------------------------------------------ */

typedef enum verdict { FINE, REFUSED, FEATURE } verdict;

/* May the start of a side go to its end? FEATURE: no, because something small would be lost. */
static verdict judge_collapse(const remesher *r, int32_t side, bool coarse) {
  const bwi_changing *mesh = r->mesh;
  int32_t a = bwi_from(mesh, side), b = bwi_to(mesh, side);
  bool tiny = side_length(mesh, side) < r->tiny;
  if (!tiny &&
      (mesh->fixed[a] == BWI_CORNER || (mesh->fixed[a] == BWI_CREASE && !mesh->sharp[side])))
    return FEATURE;
  if (!bwi_may_collapse(mesh, side))
    return FEATURE;
  const double *xa = bwi_at(mesh, a), *xb = bwi_at(mesh, b);
  double limit = slack(r, fmin(mesh->size[a], mesh->size[b])), nearest = HUGE_VAL;
  double worst_before = 1, worst_after = 1;
  bool too_long = false;
  /* Very short edges may go at the price of long ones, which are split again. */
  double most = side_length(mesh, side) < 0.4 * wanted(mesh, side) ? 1.25 * longest : longest;
  int32_t s = bwi_around(mesh, side);
  for (; s != side; s = bwi_around(mesh, s)) {
    int32_t q = bwi_to(mesh, s), p = bwi_to(mesh, bwi_next(s));
    if (mesh->sharp[s] && !tiny) {
      if (!near_crease(r, xb, bwi_at(mesh, q), limit))
        return FEATURE;
    }
    if (q == b || p == b)
      continue;
    const double *xq = bwi_at(mesh, q), *xp = bwi_at(mesh, p);
    double before[3], after[3], place[3];
    double quality_before = quality(xa, xq, xp), quality_after = quality(xb, xq, xp);
    worst_before = fmin(worst_before, quality_before);
    worst_after = fmin(worst_after, quality_after);
    normal_of(xa, xq, xp, before);
    normal_of(xb, xq, xp, after);
    if (quality_before > 1e-6 && turned_over(before, after))
      return FEATURE;
    double reach = distance(xb, xq);
    if (reach > most * 0.5 * (mesh->size[b] + mesh->size[q]) && reach > distance(xa, xq))
      too_long = true;
    nearest = fmin(nearest, bwi_nearest_on_triangle(xa, xb, xq, xp, place));
  }
  if (coarse ? worst_after < 1e-4 && worst_after < worst_before
             : too_long || (worst_after < 0.1 && worst_after < 0.5 * worst_before))
    return REFUSED;
  if (nearest > limit * limit)
    return FEATURE;
  for (s = bwi_around(mesh, side); s != side; s = bwi_around(mesh, s)) {
    int32_t q = bwi_to(mesh, s), p = bwi_to(mesh, bwi_next(s));
    if (q != b && p != b && !facet_near_surface(r, xb, bwi_at(mesh, q), bwi_at(mesh, p), limit))
      return FEATURE;
  }
  return FINE;
}

typedef struct short_side {
  double ratio;
  int32_t side, from, to; /* the ends tell whether the side is still the same edge */
} short_side;

static int by_ratio(const void *a, const void *b) {
  const short_side *x = (const short_side *)a, *y = (const short_side *)b;
  if (x->ratio != y->ratio)
    return x->ratio < y->ratio ? -1 : 1;
  return (x->side > y->side) - (x->side < y->side);
}

/* Collapse what may be, shortest first. With `learn`, note where features keep edges short. */
static bw_status collapse_short(remesher *r, bool coarse, bool learn) {
  bwi_changing *mesh = r->mesh;
  bw_status status = BW_OK;
  short_side *list = NULL;
  size_t capacity = 0;
  for (int pass = 0; pass < 6; pass++) {
    size_t count = 0;
    int64_t done_count = 0;
    for (int32_t s = 0; s < 3 * (int32_t)mesh->facet_count; s++) {
      if (mesh->corner[s] < 0 || s > mesh->opposite[s])
        continue;
      double ratio = side_length(mesh, s) / wanted(mesh, s);
      if (ratio >= shortest)
        continue;
      if (!bw_grow(r->context, (void **)&list, &capacity, count, 1, sizeof *list)) {
        status = BW_MEMORY;
        goto done;
      }
      list[count++] = (short_side){ratio, s, bwi_from(mesh, s), bwi_to(mesh, s)};
    }
    if (count > 1)
      qsort(list, count, sizeof *list, by_ratio);
    BW_TRY(bw_check_cancel(r->context));
    for (size_t i = 0; i < count; i++) {
      int32_t s = list[i].side;
      BW_TRY(look_up(r, i));
      if (mesh->corner[s] != list[i].from || bwi_to(mesh, s) != list[i].to ||
          side_length(mesh, s) >= shortest * wanted(mesh, s))
        continue;
      int32_t o = mesh->opposite[s];
      /* the freer end goes */
      if (mesh->fixed[bwi_from(mesh, s)] > mesh->fixed[bwi_from(mesh, o)]) {
        int32_t keep = s;
        s = o;
        o = keep;
      }
      verdict there = judge_collapse(r, s, coarse), back = REFUSED;
      if (there != FINE) {
        back = judge_collapse(r, o, coarse);
        s = o;
      }
      if (there == FINE || back == FINE) {
        int32_t b = bwi_to(mesh, s);
        mesh->size[b] = fmin(mesh->size[b], mesh->size[bwi_from(mesh, s)]);
        if (mesh->fixed[bwi_from(mesh, s)] > mesh->fixed[b])
          mesh->fixed[b] = mesh->fixed[bwi_from(mesh, s)];
        bwi_collapse(mesh, s);
        done_count++;
      } else if (learn && there == FEATURE && back == FEATURE && pass == 0) {
        double size = fmax(1.8 * side_length(mesh, s), finest * r->length);
        int32_t ends[2] = {bwi_from(mesh, s), bwi_to(mesh, s)};
        for (int k = 0; k < 2; k++)
          mesh->size[ends[k]] = fmin(mesh->size[ends[k]], size);
      }
    }
    if (done_count == 0)
      break;
  }
done:
  bw_free(list);
  return status;
}

/* Let the wanted length grow no faster than it may. */
static void grade(bwi_changing *mesh) {
  for (int sweep = 0; sweep < 20; sweep++) {
    bool changed = false;
    for (int32_t s = 0; s < 3 * (int32_t)mesh->facet_count; s++) {
      if (mesh->corner[s] < 0)
        continue;
      int32_t a = bwi_from(mesh, s), b = bwi_to(mesh, s);
      double most = mesh->size[a] + growth * side_length(mesh, s);
      if (mesh->size[b] > 1.0001 * most) {
        mesh->size[b] = most;
        changed = true;
      }
    }
    if (!changed)
      break;
  }
}

/* ---- flip ---------------------------------------------------------------------------------- */

/* The smallest of the three angles, by its cosine: the larger the cosine, the smaller the angle. */
static double sharpest(const double a[3], const double b[3], const double c[3]) {
  const double *x[3] = {a, b, c};
  double worst = -1;
  for (int k = 0; k < 3; k++) {
    double u[3], v[3];
    for (int i = 0; i < 3; i++) {
      u[i] = x[(k + 1) % 3][i] - x[k][i];
      v[i] = x[(k + 2) % 3][i] - x[k][i];
    }
    double size = bw_norm(u) * bw_norm(v), cosine = size > 0 ? bw_dot(u, v) / size : 1;
    worst = cosine > worst ? cosine : worst;
  }
  return worst;
}

static bool flip_helps(const remesher *r, int32_t side) {
  const bwi_changing *mesh = r->mesh;
  if (mesh->sharp[side])
    return false;
  int32_t other = mesh->opposite[side];
  int32_t ia = bwi_from(mesh, side), ib = bwi_to(mesh, side), ic = bwi_to(mesh, bwi_next(side)),
          id = bwi_to(mesh, bwi_next(other));
  const double *a = bwi_at(mesh, ia), *b = bwi_at(mesh, ib), *c = bwi_at(mesh, ic),
               *d = bwi_at(mesh, id);
  double before = fmax(sharpest(a, b, c), sharpest(b, a, d));
  double after = fmax(sharpest(d, c, a), sharpest(c, d, b));
  if (after >= before - 1e-6 || !bwi_may_flip(mesh, side))
    return false;
  double old[2][3], made[2][3];
  normal_of(a, b, c, old[0]);
  normal_of(b, a, d, old[1]);
  normal_of(d, c, a, made[0]);
  normal_of(c, d, b, made[1]);
  bool flat[2] = {quality(a, b, c) < 1e-6,
                  quality(b, a, d) < 1e-6}; /* direction not to be trusted */
  for (int i = 0; i < 2; i++)
    for (int k = 0; k < 2; k++)
      if (!flat[i] && turned_over(old[i], made[k]))
        return false;
  if ((flat[0] && flat[1]) || bw_dot(made[0], made[1]) <= 0)
    return false;
  /* On a plane nothing moves; elsewhere the new edge may not leave the surface. */
  double straight = bw_dot(old[0], old[1]) / (bw_norm(old[0]) * bw_norm(old[1]));
  if (!flat[0] && !flat[1] && straight > 1 - 1e-10)
    return true;
  double limit =
      slack(r, fmin(fmin(mesh->size[ia], mesh->size[ib]), fmin(mesh->size[ic], mesh->size[id])));
  return facet_near_surface(r, c, d, a, limit) && facet_near_surface(r, c, d, b, limit);
}

static bw_status flip_edges(remesher *r, int passes) {
  bwi_changing *mesh = r->mesh;
  for (int pass = 0; pass < passes; pass++) {
    int64_t flips = 0;
    bw_status status = bw_check_cancel(r->context);
    if (status != BW_OK)
      return status;
    for (int32_t s = 0; s < 3 * (int32_t)mesh->facet_count; s++) {
      if ((status = look_up(r, (size_t)s)) != BW_OK)
        return status;
      if (mesh->corner[s] >= 0 && s < mesh->opposite[s] && flip_helps(r, s)) {
        bwi_flip(mesh, s);
        flips++;
      }
    }
    if (flips == 0)
      break;
  }
  return BW_OK;
}

/* ---- relax --------------------------------------------------------------------------------- */

/* Where a point would like to be: the middle of its facets' middles weighted by area; on a crease,
 * of its two neighbours there. */
static bool wish(const bwi_changing *mesh, int32_t p, double out[3]) {
  int32_t start = mesh->side[p], s = start;
  double weight = 0, sum[3] = {0, 0, 0};
  if (mesh->fixed[p] == BWI_CORNER)
    return false;
  do {
    if (mesh->fixed[p] == BWI_CREASE) {
      if (mesh->sharp[s]) {
        double size = mesh->size[bwi_to(mesh, s)];
        for (int k = 0; k < 3; k++)
          sum[k] += bwi_at(mesh, bwi_to(mesh, s))[k] / size;
        weight += 1 / size;
      }
    } else {
      const double *a = bwi_at(mesh, p), *b = bwi_at(mesh, bwi_to(mesh, s)),
                   *c = bwi_at(mesh, bwi_to(mesh, bwi_next(s)));
      double n[3];
      normal_of(a, b, c, n);
      double size = (mesh->size[bwi_to(mesh, s)] + mesh->size[bwi_to(mesh, bwi_next(s))]);
      double area = bw_norm(n) / (size * size);
      for (int k = 0; k < 3; k++)
        sum[k] += area * (a[k] + b[k] + c[k]) / 3;
      weight += area;
    }
    s = bwi_around(mesh, s);
  } while (s != start);
  if (!(weight > 0))
    return false;
  for (int k = 0; k < 3; k++)
    out[k] = sum[k] / weight;
  return true;
}

static bool move_is_fine(const remesher *r, int32_t p, const double to[3]) {
  const bwi_changing *mesh = r->mesh;
  const double *from = bwi_at(mesh, p);
  double worst_before = 1, worst_after = 1, limit = slack(r, mesh->size[p]);
  int32_t start = mesh->side[p], s = start;
  do {
    const double *b = bwi_at(mesh, bwi_to(mesh, s)), *c = bwi_at(mesh, bwi_to(mesh, bwi_next(s)));
    double before[3], after[3], quality_before = quality(from, b, c);
    normal_of(from, b, c, before);
    normal_of(to, b, c, after);
    if (quality_before > 1e-6 && turned_over(before, after))
      return false;
    worst_before = fmin(worst_before, quality_before);
    worst_after = fmin(worst_after, quality(to, b, c));
    s = bwi_around(mesh, s);
  } while (s != start);
  if (worst_after < 0.5 && worst_after < worst_before)
    return false;
  do {
    if (!facet_near_surface(r, to, bwi_at(mesh, bwi_to(mesh, s)),
                            bwi_at(mesh, bwi_to(mesh, bwi_next(s))), limit))
      return false;
    if (mesh->sharp[s] && !near_crease(r, to, bwi_at(mesh, bwi_to(mesh, s)), limit))
      return false;
    s = bwi_around(mesh, s);
  } while (s != start);
  return true;
}

static bw_status relax(remesher *r) {
  bwi_changing *mesh = r->mesh;
  for (int32_t p = 0; p < (int32_t)mesh->point_count; p++) {
    double to[3], place[3];
    int32_t facet;
    if (p % 4096 == 0) {
      bw_status status = bw_check_cancel(r->context);
      if (status != BW_OK)
        return status;
    }
    if (mesh->side[p] < 0 || !wish(mesh, p, to))
      continue;
    const bwi_tree *tree = mesh->fixed[p] == BWI_CREASE ? r->creases : r->tree;
    bwi_tree_nearest(tree, to, -1, 0, place, &facet);
    if (facet >= 0 && distance(bwi_at(mesh, p), place) > 1e-3 * mesh->size[p] &&
        move_is_fine(r, p, place))
      memcpy(bwi_at(mesh, p), place, sizeof place);
  }
  return BW_OK;
}

/* ---- the whole ----------------------------------------------------------------------------- */

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
static bw_status find_room(void *data, int64_t begin, int64_t end, int worker) {
  remesher *r = (remesher *)data;
  (void)worker;
  for (int64_t t = begin; t < end; t++) {
    double n[3], middle[3] = {0}, far[3];
    bwi_facet_normal(r->original->point, r->original->triangle + 3 * t, n);
    double length = bw_norm(n);
    r->room[t] = 5 * r->length;
    for (int k = 0; k < 9; k++)
      middle[k % 3] +=
          r->original->point[3 * (int64_t)r->original->triangle[3 * t + k / 3] + k % 3] / 3;
    for (int way = -1; way < 2 && length > 0; way += 2) {
      double along[3];
      for (int k = 0; k < 3; k++) {
        along[k] = way * n[k] / length;
        far[k] = middle[k] + 5 * r->length * along[k];
      }
      ray shot = {r->original, middle, along, (int32_t)t, r->room[t]};
      bwi_tree_on_segment(r->tree, middle, far, hit, &shot);
      r->room[t] = shot.hit;
    }
  }
  return BW_OK;
}

static bw_status find_creases(remesher *r) {
  const bwi_changing *mesh = r->mesh;
  bw_status status = BW_OK;
  int64_t count = 0;
  r->crease = BW_NEW(r->context, int32_t, 9 * mesh->facet_count + 3);
  if (!r->crease)
    return BW_MEMORY;
  for (int32_t s = 0; s < 3 * (int32_t)mesh->facet_count; s++)
    if (mesh->sharp[s] && s < mesh->opposite[s]) {
      int32_t *t = r->crease + 3 * count++;
      t[0] = bwi_from(mesh, s);
      t[1] = t[2] = bwi_to(mesh, s);
    }
  BW_TRY(bwi_tree_create(r->context, r->original->point, count, r->crease, NULL, &r->creases));
done:
  return status;
}

static bw_status run(remesher *r, const bw_remesh_options *options, bw_surface **made) {
  bw_status status = BW_OK;
  bwi_changing_free(r->mesh);
  r->mesh = NULL;
  BW_TRY(bwi_changing_create(r->context, r->original, options->sharp_angle, &r->mesh));
  if (!r->creases)
    BW_TRY(find_creases(r));
  for (size_t p = 0; p < r->mesh->point_count; p++)
    r->mesh->size[p] = size_near(r, r->mesh->point + 3 * p);
  BW_TRY(flip_edges(r, 10));
  for (int i = 0; i < options->iterations; i++) {
    bw_progress(r->context, "remeshing", (double)i / options->iterations);
    BW_TRY(collapse_short(r, i == 0, i > 0));
    grade(r->mesh);
    BW_TRY(split_long(r));
    BW_TRY(collapse_short(r, false, i > 0));
    BW_TRY(flip_edges(r, 4));
    BW_TRY(relax(r));
    BW_TRY(flip_edges(r, 2));
  }
  BW_TRY(bwi_changing_surface(r->mesh, r->original->group != NULL, made));
done:
  return status;
}

/* Ask for finer edges where the result cuts itself. */
static bw_status refine_cuts(remesher *r, const bw_surface *made, const bw_surface_report *report) {
  for (int64_t i = 0; i < report->defect_count; i++) {
    const bw_defect *defect = &report->defect[i];
    if (defect->kind != BW_DEFECT_SELF_INTERSECTION)
      continue;
    if (!bw_grow(r->context, (void **)&r->fine, &r->fine_capacity, r->fine_count, 1,
                 sizeof *r->fine))
      return BW_MEMORY;
    fine_place *place = &r->fine[r->fine_count++];
    const int32_t *corner = made->triangle + 3 * (int64_t)defect->facet;
    double size = 0;
    for (int k = 0; k < 3; k++)
      size = fmax(size, distance(made->point + 3 * (int64_t)corner[k],
                                 made->point + 3 * (int64_t)corner[(k + 1) % 3]));
    memcpy(place->at, defect->at, sizeof place->at);
    place->size = fmax(0.4 * size, finest * r->length);
  }
  return BW_OK;
}

/* Take the last intersections out, where that makes the result sound. */
static bw_status resolve(remesher *r, bw_surface **made, bw_surface_report *report, double *moved) {
  bw_surface *next = NULL;
  bw_surface_report after = {0};
  bw_status status = bwi_cgal_surface(r->context, "taking out self-intersections", 60,
                                      bwi_cgal_resolve, *made, &next);
  if (status != BW_OK && status != BW_MEMORY && status != BW_CANCELLED) {
    bw_clear_failure(r->context); /* it was worth a try */
    return BW_OK;
  }
  if (status != BW_OK)
    goto done;
  BW_TRY(bw_surface_check(r->context, next, 0, &after));
  if (!after.sound)
    goto done;
  BW_TRY(bwi_take_groups(r->context, *made, next));
  BW_TRY(bw_surface_distance(r->context, r->original, next, moved));
  bw_release(*made);
  *made = next;
  next = NULL;
  bw_surface_report_clear(report);
  *report = after;
done:
  bw_release(next);
  return status;
}

bw_status bw_surface_remesh(bw_context *context, const bw_surface *surface,
                            const bw_remesh_options *given, bw_surface **remeshed,
                            bw_shape_log *log) {
  bw_status status = BW_OK;
  bw_remesh_options options;
  bw_surface *welded = NULL, *made = NULL;
  bw_surface_report report = {0};
  remesher r = {.context = context};
  double moved = 0;
  if (given)
    options = *given;
  else
    bw_remesh_options_default(&options);
  if (!(options.edge_length >= 0) || options.triangles < 0 || !(options.sharp_angle > 0) ||
      options.iterations < 1 || options.iterations > 100 || !(options.tolerance >= 0))
    return bw_fail(
        context, BW_INVALID,
        "remeshing options: edge_length %g m, triangles %lld, sharp_angle %g, iterations "
        "%d, tolerance %g m",
        options.edge_length, (long long)options.triangles, options.sharp_angle, options.iterations,
        options.tolerance);
  BW_TRY(bw_surface_weld(context, surface, 0, &welded));
  BW_TRY(bw_surface_check(context, welded, 1, &report));
  if (!report.closed || report.count[BW_DEFECT_MISORIENTED_EDGE] ||
      report.count[BW_DEFECT_NONMANIFOLD_POINT] || report.count[BW_DEFECT_DUPLICATE_FACET]) {
    status = bw_fail(context, BW_GEOMETRY,
                     "remeshing needs a closed manifold surface; this one has %lld open, %lld "
                     "non-manifold and %lld misoriented edges: repair it first",
                     (long long)report.count[BW_DEFECT_OPEN_EDGE],
                     (long long)report.count[BW_DEFECT_NONMANIFOLD_EDGE],
                     (long long)report.count[BW_DEFECT_MISORIENTED_EDGE]);
    goto done;
  }
  int64_t wanted_count = options.triangles > 0 ? options.triangles : welded->triangle_count;
  r.length = options.edge_length > 0 ? options.edge_length
                                     : sqrt(4 / sqrt(3.0) * report.area / (double)wanted_count);
  r.tolerance = options.tolerance > 0 ? options.tolerance : 0.25 * r.length;
  if (report.area / (r.length * r.length) > 2e8) {
    status = bw_fail(context, BW_LIMIT,
                     "edges of %g m would cut this surface of %g m2 into more than 100 million "
                     "facets",
                     r.length, report.area);
    goto done;
  }
  r.most_facets = 8.0 * welded->triangle_count + 400 * report.area / (r.length * r.length) + 1e4;
  r.tiny = fmin(0.03 * r.length, 0.3 * r.tolerance);
  bool sound_before = report.sound;
  int attempt = 0;
  r.original = welded;
  BW_TRY(bwi_tree_create(context, welded->point, welded->triangle_count, welded->triangle, NULL,
                         &r.tree));
  r.room = BW_NEW(context, double, welded->triangle_count);
  if (!r.room) {
    status = BW_MEMORY;
    goto done;
  }
  BW_TRY(bw_parallel(context, welded->triangle_count, 512, find_room, &r));
  for (; attempt < 5; attempt++) {
    bw_release(made);
    made = NULL;
    BW_TRY(run(&r, &options, &made));
    bw_surface_report_clear(&report);
    BW_TRY(bw_surface_check(context, made, 1000, &report));
    BW_TRY(bw_surface_distance(context, welded, made, &moved));
    if (attempt > 0 && sound_before && !report.sound)
      BW_TRY(resolve(&r, &made, &report, &moved));
    if ((report.sound || !sound_before) && moved <= 1.0001 * r.tolerance)
      break;
    BW_TRY(refine_cuts(&r, made, &report));
    if (moved > r.tolerance)
      r.tolerance *= 0.5;
  }
  if (attempt == 5) {
    status = bw_fail(context, BW_GEOMETRY,
                     "remeshing with edges of %g m failed: %lld self-intersections, moved by %g m; "
                     "ask for shorter edges",
                     r.length, (long long)report.count[BW_DEFECT_SELF_INTERSECTION], moved);
    goto done;
  }
  bw_shape_log_add(log, "remesh", made->triangle_count, moved,
                   "%d facets where there were %d, edges of about %.3g m%s", made->triangle_count,
                   surface->triangle_count, r.length,
                   attempt ? ", finer where the surface is near itself" : "");
  *remeshed = made;
  made = NULL;
done:
  bw_surface_report_clear(&report);
  bw_release(made);
  bw_release(welded);
  bwi_changing_free(r.mesh);
  bwi_tree_free(r.tree);
  bwi_tree_free(r.creases);
  bw_free(r.crease);
  bw_free(r.fine);
  bw_free(r.room);
  return status;
}
