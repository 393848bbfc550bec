/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* Area, perimeter, centroid, second moments and box of the material.
 *
 * Green's theorem turns integrals over the inside into integrals along the boundary,
 *   A = ∮ x dy, ∫ x = ∮ x^2/2 dy, ∫ y = -∮ y^2/2 dx, ∫ y^2 = -∮ y^3/3 dx, ∫ x^2 = ∮ x^3/3 dy,
 *   ∫ xy = ∮ x^2 y/2 dy,
 * whose integrands on a cubic are polynomials of degree 11 at most: Gauss's rule of six points is
 * exact for them. A change δ of the boundary changes the area by ∮ (δx dy - δy dx), which gives the
 * gradient. The length of a cubic has no closed form: it is halved until two rules agree. */
#include <float.h>
#include <math.h>
#include <string.h>

#include "outline/internal.h"

enum { RULE = 6 };
/* On 0..1, symmetric. */
static const double gauss_at[RULE] = {0.033765242898423986, 0.16939530676686774,
                                      0.38069040695840155,  0.61930959304159845,
                                      0.83060469323313226,  0.96623475710157601};
static const double gauss_weight[RULE] = {0.085662246189585173, 0.18038078652406930,
                                          0.23395696728634552,  0.23395696728634552,
                                          0.18038078652406930,  0.085662246189585173};

/* Integrals over the inside of a closed loop relative to `origin`: 1, x, y, y^2, x^2, xy; negative
 * for clockwise loops. */
static void loop_moments(const double *point, const bw_loop *loop, const bw_segment *segment,
                         const double origin[2], double moment[6]) {
  memset(moment, 0, 6 * sizeof *moment);
  for (int32_t s = loop->first; s < loop->first + loop->count; s++) {
    bwi_outline_curve curve = bwi_curve_of(point, &segment[s]);
    for (int i = 0; i < curve.count; i++)
      for (int k = 0; k < 2; k++)
        curve.point[i][k] -= origin[k];
    for (int g = 0; g < RULE; g++) {
      double at[2], d[2];
      bwi_curve_at(&curve, gauss_at[g], at, d, NULL);
      double x = at[0], y = at[1], dx = gauss_weight[g] * d[0], dy = gauss_weight[g] * d[1];
      moment[0] += (x * dy - y * dx) / 2;
      moment[1] += x * x / 2 * dy;
      moment[2] -= y * y / 2 * dx;
      moment[3] -= y * y * y / 3 * dx;
      moment[4] += x * x * x / 3 * dy;
      moment[5] += x * x * y / 2 * dy;
    }
  }
}

static double cross(const double *a, const double *b) {
  return a[0] * b[1] - a[1] * b[0];
}

/* The integral of B_i B_j' over a cubic in closed form, relative to the loop's first point. */
double bwi_loop_area(const double *point, const bw_loop *loop, const bw_segment *segment) {
  const double *origin = point + 2 * (int64_t)segment[loop->first].point[0];
  double area = 0;
  for (int32_t s = loop->first; s < loop->first + loop->count; s++) {
    bwi_outline_curve curve = bwi_curve_of(point, &segment[s]);
    double(*p)[2] = curve.point;
    for (int i = 0; i < curve.count; i++)
      for (int k = 0; k < 2; k++)
        p[i][k] -= origin[k];
    if (curve.count == 2)
      area += cross(p[0], p[1]) / 2;
    else
      area += (6 * cross(p[0], p[1]) + 3 * cross(p[0], p[2]) + cross(p[0], p[3]) +
               3 * cross(p[1], p[2]) + 3 * cross(p[1], p[3]) + 6 * cross(p[2], p[3])) /
              20;
  }
  return area;
}

/* 1, 0 or -1: how the signed area of a loop enters that of a region, or of the material (-1). */
static int loop_weight(const bw_outline *outline, int32_t loop, int32_t region) {
  const bw_loop *l = &outline->loop[loop];
  int32_t around = l->parent < 0 ? -1 : outline->loop[l->parent].region;
  if (region < 0)
    return l->region >= 0 && around >= 0 ? 0 : 1;
  int weight = l->region == region;
  if (around == region)
    weight += l->region < 0 ? 1 : -1;
  return weight;
}

/* ---- length ---------------------------------------------------------------------------------- */

static double gauss_length(const bwi_outline_curve *curve) {
  double sum = 0;
  for (int g = 0; g < RULE; g++) {
    double d[2];
    bwi_curve_at(curve, gauss_at[g], NULL, d, NULL);
    sum += gauss_weight[g] * sqrt(d[0] * d[0] + d[1] * d[1]);
  }
  return sum;
}

static double halved_length(const bwi_outline_curve *curve, double whole, double tolerance,
                            int depth) {
  bwi_outline_curve left, right;
  bwi_curve_split(curve, 0.5, &left, &right);
  double a = gauss_length(&left), b = gauss_length(&right);
  if (depth == 0 || fabs(a + b - whole) <= tolerance)
    return a + b;
  return halved_length(&left, a, tolerance, depth - 1) +
         halved_length(&right, b, tolerance, depth - 1);
}

/* Far from the origin lengths are rounded like coordinates: no halving would get below that. */
double bwi_curve_length(const bwi_outline_curve *curve) {
  double whole = gauss_length(curve), farthest = 0;
  if (curve->count == 2)
    return whole;
  for (int i = 0; i < curve->count; i++)
    farthest = fmax(farthest, fmax(fabs(curve->point[i][0]), fabs(curve->point[i][1])));
  return halved_length(curve, whole, fmax(1e-13 * whole, 16 * DBL_EPSILON * farthest), 24);
}

double bw_segment_length(const bw_outline *outline, int32_t segment) {
  bwi_outline_curve curve = bwi_curve_of(outline->point, &outline->segment[segment]);
  return bwi_curve_length(&curve);
}

/* ---- measures -------------------------------------------------------------------------------- */

static bw_status check_region(bw_context *context, const bw_outline *outline, int32_t region) {
  if (region >= -1 && region < outline->region_count)
    return BW_OK;
  return bw_fail(context, BW_INVALID,
                 "region %d of an outline: the regions are 1 to %d, and 0 stands for all",
                 region + 1, outline->region_count);
}

bw_status bw_outline_measure(bw_context *context, const bw_outline *outline, int32_t region,
                             bw_outline_measures *measures) {
  bw_status status = check_region(context, outline, region);
  if (status != BW_OK)
    return status;
  bw_outline_measures m = {.min = {DBL_MAX, DBL_MAX}, .max = {-DBL_MAX, -DBL_MAX}};
  double origin[2], sum[6] = {0};
  for (int32_t l = 0; l < outline->loop_count; l++) {
    const bw_loop *loop = &outline->loop[l];
    if (loop_weight(outline, l, region) == 0)
      continue;
    for (int32_t s = loop->first; s < loop->first + loop->count; s++) {
      bwi_outline_curve curve = bwi_curve_of(outline->point, &outline->segment[s]);
      double low[2], high[2];
      bwi_curve_box(&curve, low, high);
      for (int k = 0; k < 2; k++) {
        m.min[k] = fmin(m.min[k], low[k]);
        m.max[k] = fmax(m.max[k], high[k]);
      }
      m.perimeter += bwi_curve_length(&curve);
    }
  }
  for (int k = 0; k < 2; k++)
    origin[k] = m.min[k] + (m.max[k] - m.min[k]) / 2;
  for (int32_t l = 0; l < outline->loop_count; l++) {
    int weight = loop_weight(outline, l, region);
    double moment[6];
    if (weight == 0)
      continue;
    loop_moments(outline->point, &outline->loop[l], outline->segment, origin, moment);
    for (int i = 0; i < 6; i++)
      sum[i] += weight * moment[i];
  }
  double x = sum[1] / sum[0], y = sum[2] / sum[0];
  m.area = sum[0];
  m.centroid[0] = origin[0] + x;
  m.centroid[1] = origin[1] + y;
  m.second_moment[0] = sum[3] - sum[0] * y * y;
  m.second_moment[1] = sum[4] - sum[0] * x * x;
  m.second_moment[2] = sum[5] - sum[0] * x * y;
  *measures = m;
  return BW_OK;
}

bw_status bw_outline_area_gradient(bw_context *context, const bw_outline *outline,
                                   double *gradient) {
  (void)context;
  memset(gradient, 0, 2 * (size_t)outline->point_count * sizeof *gradient);
  for (int32_t l = 0; l < outline->loop_count; l++) {
    int weight = loop_weight(outline, l, -1);
    const bw_loop *loop = &outline->loop[l];
    for (int32_t s = loop->first; weight && s < loop->first + loop->count; s++)
      for (int g = 0; g < RULE; g++) {
        double at[2], d[2], basis[4];
        bw_outline_evaluate(outline, s, gauss_at[g], at, d, NULL);
        bw_outline_basis(outline, s, gauss_at[g], basis);
        for (int i = 0; i < 4; i++) {
          int32_t p = outline->segment[s].point[i];
          if (p < 0)
            continue;
          gradient[2 * (int64_t)p] += gauss_weight[g] * basis[i] * d[1];
          gradient[2 * (int64_t)p + 1] -= gauss_weight[g] * basis[i] * d[0];
        }
      }
  }
  return BW_OK;
}
