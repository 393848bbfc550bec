/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* Whether segments cross, touch, or come closer than the gap: certified, not sampled.
 *
 * Two curves that are no neighbours are apart when their hulls are, seen along an axis or along the
 * normal of a chord, by more than the gap; otherwise the more curved one is halved. The sag falls
 * to a quarter with each half, so that after some fifteen halvings both are lines to within an
 * eighth of the gap, and the distance of two lines decides.
 *
 * Neighbours share an end P and are never apart. But when there is a direction in which one climbs
 * all the way to P and the other all the way from P (all control vectors of their hodographs lie in
 * one half plane), they share nothing else. Halving about P leads there unless the angle between
 * them is zero, which is refused. A curve by itself is simple when its own hodograph lies in a half
 * plane; otherwise its halves are looked at, and as neighbours.
 *
 * Loops of one or two segments are cut, so that two pieces never share both ends. Pairs come from a
 * sweep over the boxes: for the few hundred segments of a drawing all of it takes microseconds. */
#include <float.h>
#include <math.h>
#include <stdlib.h>

#include "outline/internal.h"

typedef struct piece {
  bwi_outline_curve curve;
  double low[2], high[2];
  int32_t segment, loop;
  int32_t next; /* the piece that begins where this one ends */
} piece;

typedef enum kind { APART, CROSSES, TOUCHES, TURNS_BACK } kind;

typedef struct contact {
  double gap;
  kind kind;
  double at[2];
} contact;

double bwi_outline_gap(int32_t count, const double *point) {
  double low[2] = {point[0], point[1]}, high[2] = {point[0], point[1]}, max = 0;
  for (int64_t i = 0; i < count; i++)
    for (int k = 0; k < 2; k++) {
      double x = point[2 * i + k];
      low[k] = fmin(low[k], x);
      high[k] = fmax(high[k], x);
      max = fmax(max, fabs(x));
    }
  return BW_OUTLINE_GAP * fmax(max, hypot(high[0] - low[0], high[1] - low[1]));
}

/* ---- two lines ------------------------------------------------------------------------------- */

static double turn(const double a[2], const double b[2], const double c[2]) {
  return (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]);
}

/* The square of the distance of p from ab; `near` is the nearest place on ab. */
static double distance2(const double p[2], const double a[2], const double b[2], double near[2]) {
  double d[2] = {b[0] - a[0], b[1] - a[1]}, e[2] = {p[0] - a[0], p[1] - a[1]};
  double length2 = d[0] * d[0] + d[1] * d[1];
  double t = length2 > 0 ? (d[0] * e[0] + d[1] * e[1]) / length2 : 0;
  t = t < 0 ? 0 : t > 1 ? 1 : t;
  double x = e[0] - t * d[0], y = e[1] - t * d[1];
  near[0] = a[0] + t * d[0];
  near[1] = a[1] + t * d[1];
  return x * x + y * y;
}

/* Rounding may take a crossing at the very end of a line for none; the distance of that end from
 * the other line is then far below the gap. */
static bool lines_apart(contact *c, const double a[2], const double b[2], const double p[2],
                        const double q[2]) {
  double ap = turn(a, b, p), aq = turn(a, b, q), pa = turn(p, q, a), pb = turn(p, q, b);
  if (((ap > 0 && aq < 0) || (ap < 0 && aq > 0)) && ((pa > 0 && pb < 0) || (pa < 0 && pb > 0))) {
    double t = pa / (pa - pb);
    c->kind = CROSSES;
    for (int k = 0; k < 2; k++)
      c->at[k] = a[k] + t * (b[k] - a[k]);
    return false;
  }
  const double *end[4] = {a, b, p, q};
  for (int i = 0; i < 4; i++) {
    double near[2];
    if (distance2(end[i], i < 2 ? p : a, i < 2 ? q : b, near) <= c->gap * c->gap) {
      c->kind = TOUCHES;
      c->at[0] = (end[i][0] + near[0]) / 2;
      c->at[1] = (end[i][1] + near[1]) / 2;
      return false;
    }
  }
  return true;
}

/* ---- two curves ------------------------------------------------------------------------------ */

/* Whether the hulls are more than the gap apart along the normal of a's chord. */
static bool beside_chord(const bwi_outline_curve *a, const bwi_outline_curve *b, double gap) {
  const double *from = a->point[0], *to = a->point[a->count - 1];
  double n[2] = {from[1] - to[1], to[0] - from[0]}, length = sqrt(n[0] * n[0] + n[1] * n[1]);
  if (!(length > 0))
    return false;
  double low[2] = {DBL_MAX, DBL_MAX}, high[2] = {-DBL_MAX, -DBL_MAX};
  const bwi_outline_curve *curve[2] = {a, b};
  for (int j = 0; j < 2; j++)
    for (int i = 0; i < curve[j]->count; i++) {
      const double *p = curve[j]->point[i];
      double h = n[0] * (p[0] - from[0]) + n[1] * (p[1] - from[1]);
      low[j] = fmin(low[j], h);
      high[j] = fmax(high[j], h);
    }
  return low[0] - high[1] > gap * length || low[1] - high[0] > gap * length;
}

static bool boxes_apart(const double low_a[2], const double high_a[2], const double low_b[2],
                        const double high_b[2], double gap) {
  for (int k = 0; k < 2; k++)
    if (low_a[k] - high_b[k] > gap || low_b[k] - high_a[k] > gap)
      return true;
  return false;
}

static bool apart(contact *c, const bwi_outline_curve *a, const bwi_outline_curve *b) {
  double low[2][2], high[2][2];
  bwi_curve_hull(a, low[0], high[0]);
  bwi_curve_hull(b, low[1], high[1]);
  if (boxes_apart(low[0], high[0], low[1], high[1], c->gap) || beside_chord(a, b, c->gap) ||
      beside_chord(b, a, c->gap))
    return true;
  double sag_a = bwi_curve_sag(a), sag_b = bwi_curve_sag(b);
  if (fmax(sag_a, sag_b) <= c->gap / 8)
    return lines_apart(c, a->point[0], a->point[a->count - 1], b->point[0], b->point[b->count - 1]);
  bwi_outline_curve half[2];
  const bwi_outline_curve *other = sag_a >= sag_b ? b : a;
  bwi_curve_split(sag_a >= sag_b ? a : b, 0.5, &half[0], &half[1]);
  return apart(c, &half[0], other) && apart(c, &half[1], other);
}

/* ---- neighbours and single curves ------------------------------------------------------------ */

/* Angles between neighbours below this are zero. */
static const double smallest_angle = 1e-6;

/* Control vectors shorter than this part of the gap have no direction: where a control point lies
 * on its end, the curve starts towards the other one. */
static const double no_direction = 1e-3;

/* The sum of a curve's unit control vectors, as a unit vector; zero when there is none. */
static void heading(const bwi_outline_curve *curve, double gap, double d[2]) {
  d[0] = d[1] = 0;
  for (int i = 0; i + 1 < curve->count; i++) {
    double x = curve->point[i + 1][0] - curve->point[i][0];
    double y = curve->point[i + 1][1] - curve->point[i][1], length = sqrt(x * x + y * y);
    if (length > no_direction * gap) {
      d[0] += x / length;
      d[1] += y / length;
    }
  }
  double length = sqrt(d[0] * d[0] + d[1] * d[1]);
  if (length > 0) {
    d[0] /= length;
    d[1] /= length;
  }
}

/* Whether all control vectors go up in direction d. */
static bool climbs(const bwi_outline_curve *curve, double gap, const double d[2]) {
  bool any = false;
  for (int i = 0; i + 1 < curve->count; i++) {
    double x = curve->point[i + 1][0] - curve->point[i][0];
    double y = curve->point[i + 1][1] - curve->point[i][1], length = sqrt(x * x + y * y);
    if (length <= no_direction * gap)
      continue;
    if (d[0] * x + d[1] * y < smallest_angle / 2 * length)
      return false;
    any = true;
  }
  return any;
}

static bool below(const bwi_outline_curve *curve, double size) {
  double low[2], high[2];
  bwi_curve_hull(curve, low, high);
  return high[0] - low[0] <= size && high[1] - low[1] <= size;
}

static bool turns_back(contact *c, const double at[2]) {
  c->kind = TURNS_BACK;
  c->at[0] = at[0];
  c->at[1] = at[1];
  return false;
}

/* a ends where b begins. */
static bool meet_once(contact *c, const bwi_outline_curve *a, const bwi_outline_curve *b) {
  double d[2], e[2];
  heading(a, c->gap, d);
  heading(b, c->gap, e);
  d[0] += e[0];
  d[1] += e[1];
  double length = sqrt(d[0] * d[0] + d[1] * d[1]);
  if (length > 0) {
    d[0] /= length;
    d[1] /= length;
    if (climbs(a, c->gap, d) && climbs(b, c->gap, d))
      return true;
  }
  /* Two lines do not change by halving. */
  if ((a->count == 2 && b->count == 2) || (below(a, c->gap) && below(b, c->gap)))
    return turns_back(c, b->point[0]);
  bwi_outline_curve a1, a2, b1, b2;
  bwi_curve_split(a, 0.5, &a1, &a2);
  bwi_curve_split(b, 0.5, &b1, &b2);
  return meet_once(c, &a2, &b1) && apart(c, &a1, &b1) && apart(c, &a1, &b2) && apart(c, &a2, &b2);
}

static bool simple(contact *c, const bwi_outline_curve *curve) {
  double d[2];
  if (curve->count == 2)
    return true;
  heading(curve, c->gap, d);
  if (climbs(curve, c->gap, d))
    return true;
  if (below(curve, c->gap))
    return turns_back(c, curve->point[0]);
  bwi_outline_curve left, right;
  bwi_curve_split(curve, 0.5, &left, &right);
  return simple(c, &left) && simple(c, &right) && meet_once(c, &left, &right);
}

/* ---- all pieces ------------------------------------------------------------------------------ */

/* Into how many pieces the segments of a loop are cut. */
static int cuts(const bw_loop *loop) {
  return loop->count == 1 ? 4 : loop->count == 2 ? 2 : 1;
}

static int32_t cut_loop(const double *point, const bw_loop *loop, int32_t number,
                        const bw_segment *segment, piece *pieces, int32_t count) {
  int32_t first = count;
  int parts = cuts(loop);
  for (int32_t s = loop->first; s < loop->first + loop->count; s++) {
    bwi_outline_curve rest = bwi_curve_of(point, &segment[s]);
    for (int k = parts; k >= 1; k--) {
      piece *p = &pieces[count++];
      p->segment = s;
      p->loop = number;
      p->next = count;
      if (k > 1) {
        bwi_outline_curve whole = rest;
        bwi_curve_split(&whole, 1.0 / k, &p->curve, &rest);
      } else {
        p->curve = rest;
      }
      bwi_curve_hull(&p->curve, p->low, p->high);
    }
  }
  pieces[count - 1].next = first;
  return count;
}

static bw_status fail_contact(bw_context *context, const contact *c, const bw_loop *loop,
                              const piece *a, const piece *b) {
  const double x = c->at[0], y = c->at[1];
  const char *name = loop[a->loop].name.text, *other = loop[b->loop].name.text;
  int first = a->segment + 1, second = b->segment + 1;
  if (a->segment == b->segment && c->kind == TURNS_BACK)
    bw_fail(context, BW_GEOMETRY, "segment %d of loop '%s' has a cusp at (%g, %g) m", first, name,
            x, y);
  else if (a->segment == b->segment)
    bw_fail(context, BW_GEOMETRY, "segment %d of loop '%s' crosses itself at (%g, %g) m", first,
            name, x, y);
  else if (c->kind == TURNS_BACK)
    bw_fail(context, BW_GEOMETRY,
            "segment %d of loop '%s' turns back on segment %d at (%g, %g) m: there is no angle "
            "between them",
            first, name, second, x, y);
  else if (c->kind == TOUCHES)
    bw_fail(
        context, BW_GEOMETRY,
        "segment %d of loop '%s' touches segment %d of loop '%s' at (%g, %g) m: at least %.3g m "
        "apart expected",
        first, name, second, other, x, y, c->gap);
  else
    bw_fail(context, BW_GEOMETRY,
            "segment %d of loop '%s' crosses segment %d of loop '%s' at (%g, %g) m", first, name,
            second, other, x, y);
  bw_detail_number(context, "segment", first);
  bw_detail_number(context, "other_segment", second);
  bw_detail_text(context, "loop", name);
  bw_detail_text(context, "other_loop", other);
  bw_detail_number(context, "x", x);
  bw_detail_number(context, "y", y);
  return BW_GEOMETRY;
}

static bw_status check_length(bw_context *context, const piece *p, const bw_loop *loop,
                              double gap) {
  if (!below(&p->curve, gap))
    return BW_OK;
  const double *at = p->curve.point[0];
  const char *name = loop[p->loop].name.text;
  bw_fail(context, BW_GEOMETRY,
          "segment %d of loop '%s' has no length: its points all lie at (%g, %g) m, within %.3g m",
          p->segment + 1, name, at[0], at[1], gap);
  bw_detail_number(context, "segment", p->segment + 1);
  bw_detail_text(context, "loop", name);
  bw_detail_number(context, "x", at[0]);
  bw_detail_number(context, "y", at[1]);
  return BW_GEOMETRY;
}

typedef struct start {
  double low;
  int32_t piece;
} start;

static int by_start(const void *a, const void *b) {
  const start *p = a, *q = b;
  if (p->low != q->low)
    return p->low < q->low ? -1 : 1;
  return p->piece < q->piece ? -1 : p->piece > q->piece;
}

/* The axis along which the boxes overlap least. */
static int sweep_axis(const piece *pieces, int32_t count) {
  double width[2] = {0, 0}, low[2] = {DBL_MAX, DBL_MAX}, high[2] = {-DBL_MAX, -DBL_MAX};
  for (int32_t i = 0; i < count; i++)
    for (int k = 0; k < 2; k++) {
      width[k] += pieces[i].high[k] - pieces[i].low[k];
      low[k] = fmin(low[k], pieces[i].low[k]);
      high[k] = fmax(high[k], pieces[i].high[k]);
    }
  return width[1] * (high[0] - low[0]) < width[0] * (high[1] - low[1]);
}

static bw_status check_pair(bw_context *context, contact *c, const bw_loop *loop,
                            const piece *pieces, const piece *p, const piece *q) {
  bool ok = &pieces[p->next] == q   ? meet_once(c, &p->curve, &q->curve)
            : &pieces[q->next] == p ? meet_once(c, &q->curve, &p->curve)
                                    : apart(c, &p->curve, &q->curve);
  if (ok)
    return BW_OK;
  return fail_contact(context, c, loop, p->segment <= q->segment ? p : q,
                      p->segment <= q->segment ? q : p);
}

bw_status bwi_outline_check_crossings(bw_context *context, const double *point, double gap,
                                      int32_t loops, const bw_loop *loop,
                                      const bw_segment *segment) {
  bw_status status = BW_OK;
  int32_t count = 0;
  size_t capacity = 0;
  contact c = {.gap = gap};
  for (int32_t l = 0; l < loops; l++)
    capacity += (size_t)loop[l].count * (size_t)cuts(&loop[l]);
  piece *pieces = BW_NEW(context, piece, capacity);
  start *order = BW_NEW(context, start, capacity);
  BW_TRY_MEMORY(pieces && order);
  for (int32_t l = 0; l < loops; l++)
    count = cut_loop(point, &loop[l], l, segment, pieces, count);
  for (int32_t i = 0; i < count; i++) {
    BW_TRY(check_length(context, &pieces[i], loop, gap));
    if (!simple(&c, &pieces[i].curve))
      BW_TRY(fail_contact(context, &c, loop, &pieces[i], &pieces[i]));
  }
  int axis = sweep_axis(pieces, count);
  for (int32_t i = 0; i < count; i++)
    order[i] = (start){pieces[i].low[axis], i};
  qsort(order, (size_t)count, sizeof *order, by_start);
  for (int32_t i = 0; i < count; i++) {
    const piece *p = &pieces[order[i].piece];
    for (int32_t j = i + 1; j < count && order[j].low <= p->high[axis] + gap; j++) {
      const piece *q = &pieces[order[j].piece];
      if (!boxes_apart(p->low, p->high, q->low, q->high, gap))
        BW_TRY(check_pair(context, &c, loop, pieces, p, q));
    }
    if (i % 1024 == 1023)
      BW_TRY(bw_check_cancel(context));
  }
done:
  bw_free(order);
  bw_free(pieces);
  return status;
}
