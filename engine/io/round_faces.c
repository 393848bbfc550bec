/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* The round faces of a closed surface: what round_faces.h says.
 *
 * Three strips side by side, which turn by the same angle, give a cylinder or a cone. Neighbours
 * that lie on it follow. A chain is what the border of two flat faces has from one kept point to
 * the next. */
#include "io/round_faces.h"

#include <math.h>
#include <string.h>

#include "barwright/base.h"

/* The cosine of the largest turn from strip to strip: a circle has at least nine chords. */
#define TURN 0.766 /* 40 degrees */

typedef struct finder {
  bwi_flat_faces *s;
  double tolerance;
  int64_t *start;   /* per face: where its facets begin, and one more */
  int32_t *facet;   /* by face */
  double *normal;   /* 3 per face, of length 1 */
  int32_t *list;    /* room for faces */
  int32_t capacity; /* of the cylinders and cones */
} finder;

static const double *point_of(const bwi_flat_faces *s, int32_t point) {
  return s->topology->point + 3 * (size_t)point;
}

static void minus(const double a[3], const double b[3], double c[3]) {
  for (int k = 0; k < 3; k++)
    c[k] = a[k] - b[k];
}

/* The length that a vector had; it has length 1 then. */
static double make_unit(double x[3]) {
  double length = bw_norm(x);
  for (int k = 0; k < 3 && length > 0; k++)
    x[k] /= length;
  return length;
}

/* Where a point lies: how far along the axis, how far from it, and in which direction (of length
 * 1).
 */
static void place_of(const bwi_round *round, const double at[3], double *along, double *away,
                     double direction[3]) {
  minus(at, round->origin, direction);
  *along = bw_dot(direction, round->axis);
  for (int k = 0; k < 3; k++)
    direction[k] -= *along * round->axis[k];
  *away = make_unit(direction);
}

static bool lies_on(const finder *f, const bwi_round *round, double along, double away) {
  return fabs(away - (round->radius + round->slope * along)) <= f->tolerance;
}

double bwi_round_circle(const bwi_round *round, const double at[3], double centre[3]) {
  double along, away, direction[3];
  place_of(round, at, &along, &away, direction);
  for (int k = 0; k < 3; k++)
    centre[k] = round->origin[k] + along * round->axis[k];
  return round->radius + round->slope * along;
}

/* ---- chains of a face ------------------------------------------------------------------------ */

typedef struct chain {
  int32_t from, to;
  int32_t other; /* the face on the other side */
} chain;

/* The next chain of a face; *at: a number of a side among those of its facets, 0 at first. */
static bool next_chain(const finder *f, int32_t face, int64_t *at, chain *found) {
  const bwi_flat_faces *s = f->s;
  const bwi_topology *t = s->topology;
  for (; *at < 3 * (f->start[face + 1] - f->start[face]); ++*at) {
    int64_t side = 3 * (int64_t)f->facet[f->start[face] + *at / 3] + *at % 3;
    if (!bwi_flat_is_border(s, side) || !s->kept[bwi_side_from(t, side)])
      continue;
    found->from = bwi_side_from(t, side);
    found->other = s->face_of[bwi_flat_opposite(t, side) / 3];
    while (!s->kept[bwi_side_to(t, side)])
      side = bwi_flat_next(s, side);
    found->to = bwi_side_to(t, side);
    ++*at;
    return true;
  }
  return false;
}

static bool is_curved(const finder *f, int32_t face) {
  const bw_surface *surface = f->s->surface;
  int32_t group = surface->group[f->s->seed[face]];
  return group >= 0 && group < surface->names->count && surface->names->curved[group];
}

static bool may_join(const finder *f, int32_t face, int32_t other) {
  const bw_surface *surface = f->s->surface;
  return surface->group[f->s->seed[face]] == surface->group[f->s->seed[other]] &&
         f->s->round_of[other] < 0;
}

/* ---- cylinders and cones --------------------------------------------------------------------- */

/* The cylinder through two edges and a corner. */
static bool fit_cylinder(const finder *f, const chain *ab, const chain *bc, int32_t a,
                         bwi_round *round) {
  const double *p = point_of(f->s, ab->from);
  double u[3] = {0}, v[3], w[3], most = 0;
  minus(point_of(f->s, ab->to), p, round->axis);
  make_unit(round->axis);
  chain side;
  for (int64_t at = 0; next_chain(f, a, &at, &side);) { /* the corner farthest from the edge */
    double x[3];
    minus(point_of(f->s, side.from), p, x);
    double along = bw_dot(x, round->axis);
    for (int k = 0; k < 3; k++)
      x[k] -= along * round->axis[k];
    if (bw_norm(x) > most) {
      most = bw_norm(x);
      memcpy(u, x, sizeof x);
    }
  }
  minus(point_of(f->s, bc->from), p, v);
  double along = bw_dot(v, round->axis), uv[3];
  for (int k = 0; k < 3; k++)
    v[k] -= along * round->axis[k];
  bw_cross(u, v, uv);
  double area = bw_dot(uv, uv);
  if (!(area > 0))
    return false;
  for (int k = 0; k < 3; k++)
    w[k] = bw_dot(u, u) * v[k] - bw_dot(v, v) * u[k];
  bw_cross(w, uv, u);
  for (int k = 0; k < 3; k++) {
    u[k] /= 2 * area;
    round->origin[k] = p[k] + u[k];
  }
  round->radius = bw_norm(u);
  round->slope = 0;
  return true;
}

/* The cone of three planes (normal, point), whose apex they have in common, and of the points p and
 * q. Its axis is known. */
static bool fit_cone(const double *normal[3], const double *at[3], const double *p, const double *q,
                     bwi_round *round) {
  double cross[3][3], apex[3], from[3], to[3];
  for (int i = 0; i < 3; i++)
    bw_cross(normal[(i + 1) % 3], normal[(i + 2) % 3], cross[i]);
  const double bottom = bw_dot(cross[0], normal[0]);
  memcpy(apex, p, sizeof apex);
  for (int i = 0; i < 3; i++) {
    minus(at[i], p, from);
    const double step = bw_dot(from, normal[i]) / bottom;
    if (!isfinite(step))
      return false;
    for (int k = 0; k < 3; k++)
      apex[k] += step * cross[i][k];
  }
  minus(p, apex, from);
  minus(q, apex, to);
  const double *far = bw_norm(from) > bw_norm(to) ? from : to;
  double along = bw_dot(far, round->axis);
  for (int k = 0; k < 3; k++) {
    round->axis[k] *= along < 0 ? -1 : 1;
    round->origin[k] = apex[k] + fabs(along) * round->axis[k];
    from[k] = apex[k] + far[k] - round->origin[k];
  }
  round->radius = bw_norm(from);
  round->slope = round->radius / fabs(along);
  return round->slope > 1e-6 && round->slope < 1e6;
}

static double angle(const double *a, const double *b) {
  double cross[3];
  bw_cross(a, b, cross);
  return atan2(bw_norm(cross), bw_dot(a, b));
}

/* The cylinder or cone of three strips side by side. */
static bool fit(const finder *f, int32_t a, int32_t b, const chain *ab, const chain *bc,
                bwi_round *round) {
  const double *na = f->normal + 3 * (size_t)a, *nb = f->normal + 3 * (size_t)b,
               *nc = f->normal + 3 * (size_t)bc->other;
  double u[3], v[3], along, away, direction[3];
  if (bw_dot(na, nb) < TURN || bw_dot(nb, nc) < TURN || fabs(angle(na, nb) - angle(nb, nc)) > 1e-6)
    return false;
  *round = (bwi_round){.apex = -1};
  minus(nb, na, u);
  minus(nc, nb, v);
  bw_cross(u, v, round->axis);
  if (!(make_unit(round->axis) > 0))
    return false;
  if (!(fabs(bw_dot(nb, round->axis)) < 1e-6
            ? fit_cylinder(f, ab, bc, a, round)
            : fit_cone((const double *[]){na, nb, nc},
                       (const double *[]){point_of(f->s, ab->from), point_of(f->s, ab->from),
                                          point_of(f->s, bc->from)},
                       point_of(f->s, ab->from), point_of(f->s, ab->to), round)))
    return false;
  place_of(round, point_of(f->s, ab->from), &along, &away, direction);
  round->outward = bw_dot(direction, nb) > 0;
  return true;
}

/* Whether a flat face is a strip of a cylinder or cone. */
static bool is_strip(const finder *f, const bwi_round *round, int32_t face) {
  const double *n = f->normal + 3 * (size_t)face;
  /* along the axis, the normal of a cone has the sine of half its angle */
  double lean = -round->slope / sqrt(1 + round->slope * round->slope) * (round->outward ? 1 : -1);
  bool any = false;
  chain side;
  for (int64_t at = 0; next_chain(f, face, &at, &side);) {
    const double *p = point_of(f->s, side.from), *q = point_of(f->s, side.to);
    double along[2], away[2], direction[2][3], between[3];
    place_of(round, p, &along[0], &away[0], direction[0]);
    place_of(round, q, &along[1], &away[1], direction[1]);
    minus(q, p, between);
    if (!lies_on(f, round, along[0], away[0]) || !(bw_norm(between) > 10 * f->tolerance))
      return false;
    if (fabs(along[1] - along[0]) > f->tolerance) { /* a line of it; the apex has no direction */
      minus(direction[1], direction[0], between);
      if (fmin(away[0], away[1]) > f->tolerance && bw_norm(between) * away[0] > f->tolerance)
        return false;
      continue;
    }
    if (bw_dot(direction[0], direction[1]) < TURN ||
        (bw_dot(n, direction[0]) > 0) != round->outward)
      return false;
    /* chords of a circle are nearer to the axis than the circle: the plane leans a little less */
    double half = sqrt(0.5 * (1 + bw_dot(direction[0], direction[1])));
    double slope = round->slope * half;
    lean = -slope / sqrt(1 + slope * slope) * (round->outward ? 1 : -1);
    any = true;
  }
  return any && fabs(bw_dot(n, round->axis) - lean) < 1e-5;
}

/* Gives the number of a cylinder or cone to the strips that are joined with one; how many. */
static int32_t grow(const finder *f, int32_t number, int32_t seed) {
  bwi_flat_faces *s = f->s;
  const bwi_round *round = &s->round[number];
  int32_t count = 0;
  if (!is_strip(f, round, seed))
    return 0;
  s->round_of[seed] = number;
  f->list[count++] = seed;
  for (int32_t i = 0; i < count; i++) {
    chain side;
    for (int64_t at = 0; next_chain(f, f->list[i], &at, &side);)
      if (may_join(f, seed, side.other) && is_strip(f, round, side.other)) {
        s->round_of[side.other] = number;
        f->list[count++] = side.other;
      }
  }
  return count;
}

static void ungrow(const finder *f, int32_t count) {
  for (int32_t i = 0; i < count; i++)
    f->s->round_of[f->list[i]] = -1;
}

/* The cone of three of its `count` strips that lie far apart: the axis of three neighbours is wrong
 * by rounding over the cube of their turn. Fits until no more strips lie on it. */
static int32_t grow_cone(const finder *f, int32_t number, int32_t seed, int32_t count) {
  bwi_flat_faces *s = f->s;
  for (int32_t more = count + 1; count >= 6 && more > count;) {
    const bwi_round former = s->round[number];
    bwi_round *round = &s->round[number];
    const int32_t far[3] = {f->list[0], f->list[count / 3], f->list[2 * count / 3]};
    const double *normal[3], *at[3];
    chain side[3];
    double u[3], v[3];
    for (int i = 0; i < 3; i++) {
      int64_t first = 0;
      next_chain(f, far[i], &first, &side[i]);
      normal[i] = f->normal + 3 * (size_t)far[i];
      at[i] = point_of(s, side[i].from);
    }
    minus(normal[1], normal[0], u);
    minus(normal[2], normal[0], v);
    bw_cross(u, v, round->axis);
    bool fits =
        make_unit(round->axis) > 0 && fit_cone(normal, at, at[0], point_of(s, side[0].to), round);
    ungrow(f, count);
    more = fits ? grow(f, number, seed) : 0;
    if (more < count) {
      ungrow(f, more);
      *round = former;
      return grow(f, number, seed);
    }
    if (more == count)
      return count;
    count = more;
    more = count + 1;
  }
  return count;
}

/* The cosine of the angle that a strip spans about the axis. */
static double span(const finder *f, const bwi_round *round, int32_t face) {
  double along[2], away[2], direction[2][3], least = 1;
  chain side;
  for (int64_t at = 0; next_chain(f, face, &at, &side);) {
    place_of(round, point_of(f->s, side.from), &along[0], &away[0], direction[0]);
    place_of(round, point_of(f->s, side.to), &along[1], &away[1], direction[1]);
    least = fmin(least, bw_dot(direction[0], direction[1]));
  }
  return least;
}

/* Whether the strips are as wide as each other. Three in a symmetric place of any curve lie on a
 * circle. */
static bool are_alike(const finder *f, const bwi_round *round, int32_t count) {
  for (int32_t i = 1; i < count; i++)
    if (fabs(acos(fmin(1, span(f, round, f->list[i]))) -
             acos(fmin(1, span(f, round, f->list[0])))) > 1e-6)
      return false;
  return true;
}

static bw_status add_round(finder *f, const bwi_round *round) {
  bwi_flat_faces *s = f->s;
  if (s->round_count == f->capacity) {
    int32_t capacity = 2 * f->capacity + 16;
    bwi_round *more = BW_NEW(s->context, bwi_round, capacity);
    if (!more)
      return BW_MEMORY;
    if (s->round_count > 0)
      memcpy(more, s->round, (size_t)s->round_count * sizeof *more);
    bw_free(s->round);
    s->round = more;
    f->capacity = capacity;
  }
  s->round[s->round_count++] = *round;
  return BW_OK;
}

/* The cylinder or cone of a face and two others behind each other, the first that is one. */
static bw_status try_face(finder *f, int32_t a) {
  bwi_flat_faces *s = f->s;
  bw_status status = BW_OK;
  chain ab, bc;
  for (int64_t i = 0; s->round_of[a] < 0 && next_chain(f, a, &i, &ab);) {
    const int32_t b = ab.other;
    if (b == a || !may_join(f, a, b))
      continue;
    for (int64_t k = 0; s->round_of[a] < 0 && next_chain(f, b, &k, &bc);) {
      bwi_round round;
      if (bc.other == a || bc.other == b || !may_join(f, a, bc.other) ||
          !fit(f, a, b, &ab, &bc, &round))
        continue;
      BW_TRY(add_round(f, &round));
      int32_t count = grow(f, s->round_count - 1, a);
      if (round.slope > 0)
        count = grow_cone(f, s->round_count - 1, a, count);
      if (count > 3 || (count == 3 && are_alike(f, &round, count)))
        continue;
      ungrow(f, count);
      s->round_count--;
    }
  }
done:
  return status;
}

/* ---- neighbours ------------------------------------------------------------------------------ */

/* Whether a chord of a strip may become an arc. */
static bool may_bend(const finder *f, const bwi_round *round, const chain *chord) {
  const bwi_flat_faces *s = f->s;
  double cross[3], own[3], theirs[3], apart[3];
  const double *p = point_of(s, chord->from), *q = point_of(s, chord->to);
  int32_t other = s->round_of[chord->other];
  if (other < 0) { /* a plane across the axis */
    bw_cross(f->normal + 3 * (size_t)chord->other, round->axis, cross);
    return bw_norm(cross) * bwi_round_circle(round, p, own) <= 10 * f->tolerance;
  }
  const bwi_round *next = &s->round[other];
  bwi_round_circle(round, p, own);
  bwi_round_circle(next, p, theirs);
  minus(own, theirs, apart);
  return next == round ||
         (bw_norm(apart) <= 10 * f->tolerance && bwi_flat_is_across(next, p, q, f->tolerance));
}

/* Strips of which a chord cannot become an arc stay flat, and so on. */
static bw_status drop_strips(const finder *f) {
  bwi_flat_faces *s = f->s;
  bw_status status = BW_OK;
  for (bool changed = true; changed;) {
    changed = false;
    BW_TRY(bw_check_cancel(s->context));
    for (int32_t face = 0; face < s->face_count; face++) {
      chain side;
      for (int64_t at = 0; s->round_of[face] >= 0 && next_chain(f, face, &at, &side);) {
        const bwi_round *round = &s->round[s->round_of[face]];
        if (bwi_flat_is_across(round, point_of(s, side.from), point_of(s, side.to), f->tolerance) &&
            !may_bend(f, round, &side)) {
          s->round_of[face] = -1;
          changed = true;
        }
      }
    }
  }
done:
  return status;
}

/* ---- one face for joined strips -------------------------------------------------------------- */

/* Strips that are joined, and lie on one cylinder or cone, get the number of one new face. */
static void number_strips(const finder *f, int32_t *fresh, int32_t seed, int32_t number) {
  int32_t count = 0;
  fresh[seed] = number;
  f->list[count++] = seed;
  for (int32_t i = 0; i < count; i++) {
    chain side;
    for (int64_t at = 0; next_chain(f, f->list[i], &at, &side);)
      if (fresh[side.other] < 0 && f->s->round_of[side.other] == f->s->round_of[seed]) {
        fresh[side.other] = number;
        f->list[count++] = side.other;
      }
  }
}

/* The points of cones that lie within their faces. */
static void find_apexes(const finder *f) {
  bwi_flat_faces *s = f->s;
  const bwi_topology *t = s->topology;
  for (int k = 0; k < 2; k++)
    for (int64_t side = 0; side < 3 * (int64_t)t->facets; side++) {
      const int32_t face = s->face_of[side / 3], from = bwi_side_from(t, side);
      const int32_t number = face < 0 ? -1 : s->round_of[face];
      double along, away, direction[3];
      if (number < 0 || s->round[number].slope == 0)
        continue;
      place_of(&s->round[number], point_of(s, from), &along, &away, direction);
      if (k == 0 && away <= f->tolerance)
        s->round[number].apex = from;
      if (k == 1 && from == s->round[number].apex && bwi_flat_is_border(s, side))
        s->round[number].apex = -1;
    }
}

static bw_status join_strips(finder *f) {
  bw_status status = BW_OK;
  bwi_flat_faces *s = f->s;
  int32_t count = 0, rounds = 0;
  int32_t *fresh = BW_NEW(s->context, int32_t, s->face_count + 1);
  bwi_round *round = BW_NEW(s->context, bwi_round, s->face_count + 1);
  BW_TRY_MEMORY(fresh && round);
  for (int32_t face = 0; face < s->face_count; face++)
    fresh[face] = -1;
  for (int32_t face = 0; face < s->face_count; face++) {
    if (fresh[face] >= 0)
      continue;
    if (s->round_of[face] >= 0)
      number_strips(f, fresh, face, count);
    else
      fresh[face] = count;
    count++;
  }
  for (int32_t face = 0, known = 0; face < s->face_count; face++) {
    if (fresh[face] < known)
      continue;
    s->seed[known] = s->seed[face];
    if (s->round_of[face] >= 0)
      round[rounds] = s->round[s->round_of[face]];
    s->round_of[known++] = s->round_of[face] < 0 ? -1 : rounds++;
  }
  for (int32_t i = 0; i < s->topology->facets; i++)
    s->face_of[i] = s->face_of[i] < 0 ? -1 : fresh[s->face_of[i]];
  s->face_count = count;
  bw_free(s->round);
  s->round = round;
  s->round_count = rounds;
  round = NULL;
  find_apexes(f);
done:
  bw_free(fresh);
  bw_free(round);
  return status;
}

static bw_status list_facets(finder *f) {
  bwi_flat_faces *s = f->s;
  const int32_t facets = s->topology->facets;
  f->start = BW_NEW0(s->context, int64_t, (size_t)s->face_count + 2);
  f->facet = BW_NEW(s->context, int32_t, facets + 1);
  f->normal = BW_NEW(s->context, double, 3 * (size_t)s->face_count + 1);
  f->list = BW_NEW(s->context, int32_t, s->face_count + 1);
  s->round_of = BW_NEW(s->context, int32_t, s->face_count + 1);
  if (!f->start || !f->facet || !f->normal || !f->list || !s->round_of)
    return BW_MEMORY;
  for (int32_t i = 0; i < facets; i++)
    if (s->face_of[i] >= 0)
      f->start[s->face_of[i] + 2]++;
  for (int32_t face = 0; face < s->face_count; face++) {
    f->start[face + 2] += f->start[face + 1];
    s->round_of[face] = -1;
    bwi_flat_normal(s->topology, s->seed[face], f->normal + 3 * (size_t)face);
    make_unit(f->normal + 3 * (size_t)face);
  }
  for (int32_t i = 0; i < facets; i++)
    if (s->face_of[i] >= 0)
      f->facet[f->start[s->face_of[i] + 1]++] = i;
  return BW_OK;
}

/* Whether the surface has names of curved faces. */
static bool has_curved(const bw_surface *surface) {
  for (int32_t i = 0; surface->names && i < surface->names->count; i++)
    if (surface->names->curved[i])
      return true;
  return false;
}

bw_status bwi_round_faces_find(bwi_flat_faces *s) {
  bw_status status = BW_OK;
  finder f = {.s = s, .tolerance = ROUND / FLAT * s->tolerance};
  if (!has_curved(s->surface))
    return BW_OK;
  BW_TRY(list_facets(&f));
  for (int32_t face = 0; face < s->face_count; face++) {
    if (face % 4096 == 0)
      BW_TRY(bw_check_cancel(s->context));
    if (s->round_of[face] < 0 && is_curved(&f, face))
      BW_TRY(try_face(&f, face));
  }
  BW_TRY(drop_strips(&f));
  BW_TRY(join_strips(&f));
done:
  bw_free(f.start);
  bw_free(f.facet);
  bw_free(f.normal);
  bw_free(f.list);
  return status;
}
