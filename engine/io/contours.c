/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* Lines and curves of a drawing as its reader comes to them, through the transformation in force.
 *
 * Invariant: edges of a piece follow each other in the list, and each begins where the one before
 * ends, up to rounding. */
#include "io/contours.h"

#include <math.h>
#include <string.h>

void bwi_contours_init(bwi_contours *c, bw_context *context, const char *name) {
  memset(c, 0, sizeof *c);
  c->context = context;
  c->name = name;
  c->matrix[0] = c->matrix[3] = 1;
  bwi_draft_init(&c->draft, context);
}

void bwi_contours_clear(bwi_contours *c) {
  bw_free(c->edge);
  bw_free(c->piece);
  bwi_draft_clear(&c->draft);
  memset(c, 0, sizeof *c);
}

/* ---- adding --------------------------------------------------------------------------------- */

static void transform(const bwi_contours *c, const double from[2], double to[2]) {
  const double *m = c->matrix;
  double x = m[0] * from[0] + m[2] * from[1] + m[4], y = m[1] * from[0] + m[3] * from[1] + m[5];
  to[0] = x;
  to[1] = y;
}

void bwi_contours_begin(bwi_contours *c, const double at[2], const bw_name *name, int32_t region,
                        int64_t line) {
  if (c->status == BW_OK &&
      !bw_grow(c->context, (void **)&c->piece, &c->piece_capacity, c->pieces, 1, sizeof *c->piece))
    c->status = BW_MEMORY;
  if (c->status != BW_OK)
    return;
  c->piece[c->pieces++] = (bwi_contour_piece){
      .first = c->edges, .region = region, .line = line, .name = name ? *name : (bw_name){""}};
  memcpy(c->start, at, sizeof c->start);
  memcpy(c->at, at, sizeof c->at);
}

static void add(bwi_contours *c, int count, const double *const point[4]) {
  if (c->status == BW_OK &&
      !bw_grow(c->context, (void **)&c->edge, &c->edge_capacity, c->edges, 1, sizeof *c->edge))
    c->status = BW_MEMORY;
  if (c->status != BW_OK)
    return;
  bwi_contour_edge *edge = &c->edge[c->edges++];
  edge->tag = c->tag;
  edge->curve.count = count;
  for (int i = 0; i < count; i++)
    transform(c, point[i], edge->curve.point[i]);
  memcpy(c->at, point[count - 1], sizeof c->at);
  c->piece[c->pieces - 1].count++;
}

void bwi_contours_line(bwi_contours *c, const double to[2]) {
  const double at[2] = {c->at[0], c->at[1]};
  add(c, 2, (const double *const[4]){at, to});
}

void bwi_contours_cubic(bwi_contours *c, const double control1[2], const double control2[2],
                        const double to[2]) {
  const double at[2] = {c->at[0], c->at[1]};
  add(c, 4, (const double *const[4]){at, control1, control2, to});
}

void bwi_contours_quadratic(bwi_contours *c, const double control[2], const double to[2]) {
  double a[2], b[2];
  for (int k = 0; k < 2; k++) {
    a[k] = c->at[k] + (control[k] - c->at[k]) * 2 / 3;
    b[k] = to[k] + (control[k] - to[k]) * 2 / 3;
  }
  bwi_contours_cubic(c, a, b, to);
}

void bwi_contours_arc(bwi_contours *c, const double centre[2], const double u[2], const double v[2],
                      double from, double to) {
  const double pi = 3.14159265358979323846;
  int pieces = (int)fmax(1, ceil(fmin(fabs(to - from) / (pi / 4), 1e3) - 1e-9));
  double step = (to - from) / pieces, k = 4.0 / 3 * tan(step / 4);
  for (int i = 0; i < pieces; i++) {
    double point[3][2];
    double a = from + i * step, b = from + (i + 1) * step;
    for (int j = 0; j < 2; j++) {
      point[0][j] = c->at[j] + k * (-sin(a) * u[j] + cos(a) * v[j]);
      point[2][j] = centre[j] + cos(b) * u[j] + sin(b) * v[j];
      point[1][j] = point[2][j] - k * (-sin(b) * u[j] + cos(b) * v[j]);
    }
    bwi_contours_cubic(c, point[0], point[1], point[2]);
  }
}

void bwi_contours_bulge(bwi_contours *c, const double to[2], double bulge) {
  double chord[2] = {to[0] - c->at[0], to[1] - c->at[1]};
  if (fabs(bulge) < 1e-12 || !(hypot(chord[0], chord[1]) > 0)) {
    bwi_contours_line(c, to);
    return;
  }
  double up = (1 - bulge * bulge) / (4 * bulge), end[2] = {to[0], to[1]};
  double centre[2] = {(c->at[0] + to[0]) / 2 - up * chord[1],
                      (c->at[1] + to[1]) / 2 + up * chord[0]};
  double u[2] = {c->at[0] - centre[0], c->at[1] - centre[1]}, v[2] = {-u[1], u[0]};
  bwi_contours_arc(c, centre, u, v, 0, 4 * atan(bulge));
  if (c->status == BW_OK) {
    bwi_outline_curve *last = &c->edge[c->edges - 1].curve;
    transform(c, end, last->point[3]);
    memcpy(c->at, end, sizeof end);
  }
}

void bwi_contours_end(bwi_contours *c, bool close) {
  if (c->status != BW_OK)
    return;
  if (c->piece[c->pieces - 1].count == 0) { /* a place alone */
    c->pieces--;
    return;
  }
  if (close) {
    const double start[2] = {c->start[0], c->start[1]};
    bwi_contours_line(c, start);
    if (c->status == BW_OK)
      c->piece[c->pieces - 1].closed = true;
  }
}
