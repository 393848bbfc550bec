/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* Push-pin pulling: one vertex goes where it is pulled, pinned ones stay, and the control polygon
 * between follows as rigidly as possible, after Igarashi, Moscovich and Hughes (2005): first a
 * shape that may scale, then one whose edges have their lengths again.
 *
 * On a curve both steps have closed forms. With points and edges as complex numbers, edge d_i
 * becomes z_i d_i, where z_i turns and scales it. Step one makes z as even along the curve as it
 * can be: min sum w_i |z_{i+1} - z_i|^2, w_i one over the distance of the edges' midpoints, with z
 * = 1 in the curve beyond the ends of the chain where that stays, subject to sum of z_i d_i from
 * the left end to the vertex = the way between them as pulled, and the same from the vertex to the
 * right end. That is a real tridiagonal matrix with two complex constraints. Step two gives each
 * edge its length, in the direction of z_i d_i, and spreads what is then missing between the fixed
 * points over the edges by length, which is the least-squares fit. */
#include <math.h>
#include <string.h>

#include "outline/internal.h"

typedef struct complex2 {
  double x, y;
} complex2;

static complex2 times(complex2 a, complex2 b) {
  return (complex2){a.x * b.x - a.y * b.y, a.x * b.y + a.y * b.x};
}

static complex2 conjugate(complex2 a) {
  return (complex2){a.x, -a.y};
}

/* The points from one fixed vertex over the pulled one to the next fixed one. */
typedef struct chain {
  int32_t count;   /* of points: edges are one fewer */
  int32_t pulled;  /* index of the vertex in the chain */
  bool ends_fixed; /* the curve beyond the ends stays: the ends are not hinges */
  int32_t *point;  /* count */
  complex2 *edge;  /* count - 1 */
  double *length;
} chain;

/* ---- which points follow --------------------------------------------------------------------- */

static bool is_pin(int32_t pins, const int32_t *pin, int32_t point) {
  for (int32_t i = 0; i < pins; i++)
    if (pin[i] == point)
      return true;
  return false;
}

/* How many segments it is from the pulled vertex to the end of the chain on one side: up to a pin,
 * or to the first vertex at or beyond the reach; the whole loop: no end on that side. */
static int32_t count_side(const bw_outline *outline, const bw_loop *loop, int32_t segment,
                          bool forward, int32_t pins, const int32_t *pin, double reach) {
  double way = 0;
  int32_t s = forward ? segment : bwi_previous_segment(loop, segment);
  for (int32_t n = 1; n < loop->count; n++) {
    bwi_outline_curve curve = bwi_curve_of(outline->point, &outline->segment[s]);
    way += bwi_curve_length(&curve);
    if (is_pin(pins, pin, outline->segment[s].point[forward ? 3 : 0]) ||
        (reach > 0 && way >= reach))
      return n;
    s = forward ? bwi_next_segment(loop, s) : bwi_previous_segment(loop, s);
  }
  return loop->count;
}

/* Both sides of a loop of `count` segments. Where they would overlap, or one has no end, the chain
 * goes once around: from the end that there is, or from the vertex farthest off, to itself. */
static void choose_sides(int32_t count, int32_t *left, int32_t *right, bool *ends_fixed) {
  if (*left == count && *right == count) /* nothing fixes the loop */
    return;
  *ends_fixed = *left + *right < count;
  if (*left + *right <= count)
    return;
  if (*left == count)
    *left = count - *right;
  else if (*right == count)
    *right = count - *left;
  else
    *left = count - (*right = count / 2);
}

static bw_status build_chain(bw_context *context, const bw_outline *outline, const bw_loop *loop,
                             int32_t segment, int32_t left, int32_t right, chain *c) {
  size_t capacity = 3 * ((size_t)left + (size_t)right) + 1;
  c->point = BW_NEW(context, int32_t, capacity);
  c->edge = BW_NEW(context, complex2, capacity);
  c->length = BW_NEW(context, double, capacity);
  if (!c->point || !c->edge || !c->length)
    return BW_MEMORY;
  int32_t s = segment;
  for (int32_t i = 0; i < left; i++)
    s = bwi_previous_segment(loop, s);
  for (int32_t i = 0; i < left + right; i++) {
    if (i == left)
      c->pulled = c->count;
    for (int k = 0; k < 3; k++)
      if (outline->segment[s].point[k] >= 0)
        c->point[c->count++] = outline->segment[s].point[k];
    s = bwi_next_segment(loop, s);
  }
  c->point[c->count++] = outline->segment[s].point[0];
  for (int32_t i = 0; i + 1 < c->count; i++) {
    const double *p = outline->point + 2 * (int64_t)c->point[i];
    const double *q = outline->point + 2 * (int64_t)c->point[i + 1];
    c->edge[i] = (complex2){q[0] - p[0], q[1] - p[1]};
    c->length[i] = hypot(c->edge[i].x, c->edge[i].y);
  }
  return BW_OK;
}

static void clear_chain(chain *c) {
  bw_free(c->point);
  bw_free(c->edge);
  bw_free(c->length);
}

/* ---- step one -------------------------------------------------------------------------------- */

/* Factor a symmetric tridiagonal matrix in place: `diagonal` becomes pivots, `off` multipliers. */
static void factor_tridiagonal(int32_t n, double *diagonal, double *off) {
  for (int32_t i = 0; i + 1 < n; i++) {
    double m = off[i] / diagonal[i];
    diagonal[i + 1] -= m * off[i];
    off[i] = m;
  }
}

static void solve_tridiagonal(int32_t n, const double *pivot, const double *multiplier,
                              complex2 *x) {
  for (int32_t i = 0; i + 1 < n; i++) {
    x[i + 1].x -= multiplier[i] * x[i].x;
    x[i + 1].y -= multiplier[i] * x[i].y;
  }
  for (int32_t i = n - 1; i >= 0; i--) {
    x[i].x /= pivot[i];
    x[i].y /= pivot[i];
    if (i + 1 < n) {
      x[i].x -= multiplier[i] * x[i + 1].x;
      x[i].y -= multiplier[i] * x[i + 1].y;
    }
  }
}

/* z = 1 + W^-1 conj(d) (lambda_1 on the left, lambda_2 on the right), the lambdas such that the
 * ways are right: `extra` is by how much each differs from what it was. Work: x 2 edges, and
 * weights. */
static void even_factors(const chain *c, const complex2 extra[2], complex2 *z, complex2 *work,
                         double *diagonal, double *off) {
  int32_t n = c->count - 1;
  double total = 0;
  for (int32_t i = 0; i < n; i++)
    total += c->length[i];
  double min = 1e-9 * total;
  for (int32_t i = 0; i < n; i++)
    diagonal[i] = 1e-6 / total; /* a chain of hinges does not fix its rotation otherwise */
  for (int32_t i = 0; i + 1 < n; i++) {
    double w = 2 / fmax(c->length[i] + c->length[i + 1], min);
    diagonal[i] += w;
    diagonal[i + 1] += w;
    off[i] = -w;
  }
  if (c->ends_fixed) {
    diagonal[0] += 2 / fmax(c->length[0], min);
    diagonal[n - 1] += 2 / fmax(c->length[n - 1], min);
  }
  factor_tridiagonal(n, diagonal, off);
  complex2 *side[2] = {work, work + n}, gram[2][2] = {{{0, 0}}};
  for (int k = 0; k < 2; k++) {
    for (int32_t i = 0; i < n; i++)
      side[k][i] = (i >= c->pulled) == (k == 1) ? conjugate(c->edge[i]) : (complex2){0, 0};
    solve_tridiagonal(n, diagonal, off, side[k]);
    for (int32_t i = 0; i < n; i++) {
      complex2 *to = &gram[i >= c->pulled][k], add = times(c->edge[i], side[k][i]);
      to->x += add.x;
      to->y += add.y;
    }
  }
  /* The Gram matrix is Hermitian with real positive diagonal. */
  complex2 cross = gram[0][1];
  double determinant = gram[0][0].x * gram[1][1].x - (cross.x * cross.x + cross.y * cross.y);
  complex2 a = times(cross, extra[1]), b = times(conjugate(cross), extra[0]);
  complex2 lambda[2] = {{(gram[1][1].x * extra[0].x - a.x) / determinant,
                         (gram[1][1].x * extra[0].y - a.y) / determinant},
                        {(gram[0][0].x * extra[1].x - b.x) / determinant,
                         (gram[0][0].x * extra[1].y - b.y) / determinant}};
  for (int32_t i = 0; i < n; i++) {
    complex2 p = times(side[0][i], lambda[0]), q = times(side[1][i], lambda[1]);
    z[i] = (complex2){1 + p.x + q.x, p.y + q.y};
  }
}

/* ---- step two -------------------------------------------------------------------------------- */

/* Points of edges [from, to) laid out from `start`, ending at `end`. */
static void lay_out(const chain *c, const complex2 *z, int32_t from, int32_t to, complex2 start,
                    complex2 end, double *point) {
  complex2 at = start;
  double total = 0, way = 0;
  for (int pass = 0; pass < 2; pass++) {
    complex2 missing = {end.x - at.x, end.y - at.y}; /* in the second pass */
    at = start;
    for (int32_t i = from; i < to; i++) {
      complex2 rotated = times(z[i], c->edge[i]);
      double size = hypot(rotated.x, rotated.y);
      double scale = size > 0 ? c->length[i] / size : 0;
      if (pass == 0)
        total += c->length[i];
      at.x += scale * rotated.x;
      at.y += scale * rotated.y;
      way += pass == 1 ? c->length[i] : 0;
      if (pass == 1 && i + 1 < to) {
        double *p = point + 2 * (int64_t)c->point[i + 1];
        p[0] = at.x + missing.x * way / total;
        p[1] = at.y + missing.y * way / total;
      }
    }
  }
}

static bw_status pull_chain(bw_context *context, const chain *c, const double to[2],
                            double *point) {
  size_t n = (size_t)c->count;
  bw_status status = BW_OK;
  complex2 *work = BW_NEW(context, complex2, 3 * n);
  double *matrix = BW_NEW(context, double, 2 * n);
  BW_TRY_MEMORY(work && matrix);
  double *vertex = point + 2 * (int64_t)c->point[c->pulled];
  const double *first = point + 2 * (int64_t)c->point[0];
  const double *last = point + 2 * (int64_t)c->point[c->count - 1];
  complex2 start = {first[0], first[1]}, end = {last[0], last[1]}, pulled = {to[0], to[1]};
  complex2 way = {to[0] - vertex[0], to[1] - vertex[1]};
  complex2 extra[2] = {way, {-way.x, -way.y}};
  even_factors(c, extra, work, work + n, matrix, matrix + n);
  lay_out(c, work, 0, c->pulled, start, pulled, point);
  lay_out(c, work, c->pulled, c->count - 1, pulled, end, point);
  vertex[0] = to[0];
  vertex[1] = to[1];
done:
  bw_free(matrix);
  bw_free(work);
  return status;
}

bw_status bw_outline_pulled(bw_context *context, const bw_outline *outline, int32_t vertex,
                            const double to[2], int32_t pins, const int32_t *pin, double reach,
                            bw_outline **pulled) {
  bw_status status = BW_OK;
  chain c = {0};
  double *point = NULL;
  int32_t segment, other;
  BW_TRY(bwi_check_vertex(context, outline, vertex, &segment));
  for (int32_t i = 0; i < pins; i++)
    BW_TRY(bwi_check_vertex(context, outline, pin[i], &other));
  if (is_pin(pins, pin, vertex))
    BW_TRY(bw_fail(context, BW_INVALID, "point %d is pulled and pinned too: leave one of them out",
                   vertex + 1));
  if (!isfinite(to[0]) || !isfinite(to[1]) || !(reach >= 0) || !isfinite(reach))
    BW_TRY(bw_fail(
        context, BW_INVALID,
        "pulling to (%g, %g) m with reach %g m: finite numbers expected, the reach at least 0",
        to[0], to[1], reach));
  point = BW_NEW(context, double, 2 * (size_t)outline->point_count);
  BW_TRY_MEMORY(point);
  memcpy(point, outline->point, 2 * (size_t)outline->point_count * sizeof *point);
  int32_t l = bw_segment_loop(outline, segment);
  const bw_loop *loop = &outline->loop[l];
  int32_t left = count_side(outline, loop, segment, false, pins, pin, reach);
  int32_t right = count_side(outline, loop, segment, true, pins, pin, reach);
  choose_sides(loop->count, &left, &right, &c.ends_fixed);
  if (left == loop->count && right == loop->count) {
    /* Nothing fixes the loop: it moves as a rigid body. */
    const double *at = outline->point + 2 * (int64_t)vertex;
    for (int32_t s = loop->first; s < loop->first + loop->count; s++)
      for (int i = 0; i < 3; i++)
        for (int k = 0; k < 2 && outline->segment[s].point[i] >= 0; k++)
          point[2 * (int64_t)outline->segment[s].point[i] + k] += to[k] - at[k];
  } else {
    BW_TRY(build_chain(context, outline, loop, segment, left, right, &c));
    BW_TRY(pull_chain(context, &c, to, point));
  }
  BW_TRY(bw_outline_moved(context, outline, point, pulled));
done:
  clear_chain(&c);
  bw_free(point);
  return status;
}
