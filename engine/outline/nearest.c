/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* The nearest place on an outline. A cubic is halved where its hull is nearer than the best place
 * so far, until it is straight enough for its chord to tell; a few steps of Newton's method on (B -
 * at) B' = 0 then give t to the last digits. */
#include <float.h>
#include <math.h>

#include "outline/internal.h"

typedef struct search {
  const double *at;
  double min, t; /* square of the distance so far, and where */
} search;

static double hull_distance2(const bwi_outline_curve *curve, const double at[2]) {
  double low[2], high[2], sum = 0;
  bwi_curve_hull(curve, low, high);
  for (int k = 0; k < 2; k++) {
    double off = fmax(0, fmax(low[k] - at[k], at[k] - high[k]));
    sum += off * off;
  }
  return sum;
}

static void try_chord(search *s, const bwi_outline_curve *piece, double from, double to) {
  const double *p = piece->point[0], *q = piece->point[piece->count - 1];
  double d[2] = {q[0] - p[0], q[1] - p[1]}, e[2] = {s->at[0] - p[0], s->at[1] - p[1]};
  double length2 = d[0] * d[0] + d[1] * d[1];
  double u = length2 > 0 ? (d[0] * e[0] + d[1] * e[1]) / length2 : 0;
  u = u < 0 ? 0 : u > 1 ? 1 : u;
  double x = e[0] - u * d[0], y = e[1] - u * d[1];
  if (x * x + y * y < s->min) {
    s->min = x * x + y * y;
    s->t = from + u * (to - from);
  }
}

static void descend(search *s, const bwi_outline_curve *piece, double from, double to,
                    double flat) {
  if (hull_distance2(piece, s->at) >= s->min)
    return;
  if (bwi_curve_sag(piece) <= flat) {
    try_chord(s, piece, from, to);
    return;
  }
  bwi_outline_curve half[2];
  bwi_curve_split(piece, 0.5, &half[0], &half[1]);
  double middle = (from + to) / 2;
  int first = hull_distance2(&half[0], s->at) <= hull_distance2(&half[1], s->at) ? 0 : 1;
  for (int i = 0; i < 2; i++) {
    int side = i == 0 ? first : 1 - first;
    descend(s, &half[side], side ? middle : from, side ? to : middle, flat);
  }
}

static double place_distance(const bwi_outline_curve *curve, const double at[2], double t) {
  double p[2];
  bwi_curve_at(curve, t, p, NULL, NULL);
  return hypot(p[0] - at[0], p[1] - at[1]);
}

static double polish(const bwi_outline_curve *curve, const double at[2], double t) {
  double best = place_distance(curve, at, t);
  for (int i = 0; i < 8; i++) {
    double p[2], d[2], s[2];
    bwi_curve_at(curve, t, p, d, s);
    double off[2] = {p[0] - at[0], p[1] - at[1]};
    double slope = off[0] * d[0] + off[1] * d[1];
    double bend = d[0] * d[0] + d[1] * d[1] + off[0] * s[0] + off[1] * s[1];
    if (!(bend > 0))
      break;
    double next = fmin(1, fmax(0, t - slope / bend)), distance = place_distance(curve, at, next);
    if (next == t || distance > best)
      break;
    t = next;
    best = distance;
  }
  return t;
}

static bw_outline_place nearest_on(const bw_outline *outline, int32_t segment, const double at[2],
                                   double within) {
  bwi_outline_curve curve = bwi_curve_of(outline->point, &outline->segment[segment]);
  double low[2], high[2];
  bwi_curve_hull(&curve, low, high);
  search s = {at, within, -1};
  descend(&s, &curve, 0, 1, 1e-4 * hypot(high[0] - low[0], high[1] - low[1]));
  bw_outline_place place = {segment, s.t, DBL_MAX};
  if (s.t >= 0) {
    place.t = polish(&curve, at, s.t);
    place.distance = place_distance(&curve, at, place.t);
  }
  return place;
}

bw_outline_place bw_segment_nearest(const bw_outline *outline, int32_t segment,
                                    const double at[2]) {
  return nearest_on(outline, segment, at, DBL_MAX);
}

/* Chords are off by their sag, so that each segment gets a little more room than the best so
 * far. */
bw_outline_place bw_outline_nearest(const bw_outline *outline, const double at[2]) {
  bw_outline_place best = {0, 0, DBL_MAX};
  for (int32_t s = 0; s < outline->segment_count; s++) {
    double low[2], high[2];
    bwi_outline_curve curve = bwi_curve_of(outline->point, &outline->segment[s]);
    bwi_curve_hull(&curve, low, high);
    double reach = best.distance + 2e-4 * hypot(high[0] - low[0], high[1] - low[1]);
    bw_outline_place place = nearest_on(outline, s, at, s == 0 ? DBL_MAX : reach * reach);
    if (place.distance < best.distance)
      best = place;
  }
  return best;
}
