/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* Fits of planes, spheres, cylinders and cones to points with normals.
 *
 * A start comes from linear least squares: of the points (sphere, circle) and of the normals, which
 * are perpendicular to the axis of a cylinder and at one angle to that of a cone. Gauss-Newton
 * steps on the distances follow. The points are the corners of facets, which lie on the primitive
 * itself in surfaces made from CAD models, while facets between them cut it short. */
#include "mesh/faces_internal.h"

#include <math.h>
#include <string.h>

enum { MAX_TERMS = 6, STEPS = 12 };

/* A x = b by elimination with pivots; false when singular. A (n x n) and b are overwritten. */
static bool solve(int n, double a[MAX_TERMS][MAX_TERMS], double b[MAX_TERMS]) {
  double scale = 0;
  for (int i = 0; i < n; i++)
    scale = fmax(scale, fabs(a[i][i]));
  for (int k = 0; k < n; k++) {
    int best = k;
    for (int i = k + 1; i < n; i++)
      if (fabs(a[i][k]) > fabs(a[best][k]))
        best = i;
    if (!(fabs(a[best][k]) > 1e-13 * scale))
      return false;
    for (int j = 0; j < n; j++) {
      double keep = a[k][j];
      a[k][j] = a[best][j];
      a[best][j] = keep;
    }
    double keep = b[k];
    b[k] = b[best];
    b[best] = keep;
    for (int i = k + 1; i < n; i++) {
      double factor = a[i][k] / a[k][k];
      for (int j = k; j < n; j++)
        a[i][j] -= factor * a[k][j];
      b[i] -= factor * b[k];
    }
  }
  for (int k = n - 1; k >= 0; k--) {
    for (int j = k + 1; j < n; j++)
      b[k] -= a[k][j] * b[j];
    b[k] /= a[k][k];
  }
  return true;
}

/* Adds a row of a least squares problem to the normal equations. */
static void add_row(int n, const double *row, double right, double a[MAX_TERMS][MAX_TERMS],
                    double b[MAX_TERMS]) {
  for (int i = 0; i < n; i++) {
    for (int j = 0; j < n; j++)
      a[i][j] += row[i] * row[j];
    b[i] += row[i] * right;
  }
}

static void centroid_of(const bwi_cloud *cloud, double middle[3], double *size) {
  memset(middle, 0, 3 * sizeof *middle);
  for (int64_t i = 0; i < 3 * cloud->points; i++)
    middle[i % 3] += cloud->point[i] / (double)cloud->points;
  *size = 0;
  for (int64_t i = 0; i < cloud->points; i++) {
    double d[3];
    for (int k = 0; k < 3; k++)
      d[k] = cloud->point[3 * i + k] - middle[k];
    *size = fmax(*size, bw_norm(d));
  }
}

double bw_face_distance(const bw_face *face, const double x[3], double gradient[3]) {
  double d[3], g[3] = {0, 0, 0}, value = 0;
  for (int k = 0; k < 3; k++)
    d[k] = x[k] - face->point[k];
  if (face->kind == BW_FACE_PLANE) {
    value = bw_dot(d, face->axis);
    memcpy(g, face->axis, sizeof g);
  } else if (face->kind != BW_FACE_FREE) {
    double along = face->kind == BW_FACE_SPHERE ? 0 : bw_dot(d, face->axis);
    for (int k = 0; k < 3; k++)
      g[k] = d[k] - along * face->axis[k];
    double far = bw_norm(g), steep = sqrt(1 + face->slope * face->slope);
    for (int k = 0; k < 3; k++)
      g[k] = ((far > 0 ? g[k] / far : 0) - face->slope * face->axis[k]) / steep;
    value = (far - face->radius - face->slope * along) / steep;
  }
  if (gradient)
    memcpy(gradient, g, sizeof g);
  return value;
}

static bool fit_plane(const bwi_cloud *cloud, bw_face *face) {
  double mean[3] = {0}, spread[6] = {0}, value[3], vector[9], size, out[3] = {0};
  centroid_of(cloud, mean, &size);
  for (int64_t i = 0; i < cloud->points; i++) {
    double d[3];
    for (int k = 0; k < 3; k++)
      d[k] = (cloud->point[3 * i + k] - mean[k]) / size;
    const double now[6] = {d[0] * d[0], d[1] * d[1], d[2] * d[2],
                           d[1] * d[2], d[0] * d[2], d[0] * d[1]};
    for (int k = 0; k < 6; k++)
      spread[k] += now[k];
  }
  bw_eigen3(spread, value, vector);
  for (int64_t f = 0; f < cloud->facets; f++)
    for (int k = 0; k < 3; k++)
      out[k] += cloud->area[f] * cloud->normal[3 * f + k];
  double sign = bw_dot(out, vector + 6) < 0 ? -1 : 1;
  for (int k = 0; k < 3; k++) {
    face->axis[k] = sign * vector[6 + k];
    face->point[k] = mean[k];
  }
  return true;
}

static bool fit_sphere(const bwi_cloud *cloud, bw_face *face) {
  double a[MAX_TERMS][MAX_TERMS] = {{0}}, b[MAX_TERMS] = {0}, mean[3], size;
  centroid_of(cloud, mean, &size);
  for (int64_t i = 0; i < cloud->points; i++) { /* |y|^2 = 2 c . y + k, y in units of the size */
    double row[4];
    for (int k = 0; k < 3; k++)
      row[k] = (cloud->point[3 * i + k] - mean[k]) / size;
    double square = bw_dot(row, row);
    row[3] = 1;
    add_row(4, row, square, a, b);
  }
  if (!solve(4, a, b))
    return false;
  double square = b[3];
  for (int k = 0; k < 3; k++) {
    square += b[k] * b[k] / 4;
    face->point[k] = mean[k] + size * b[k] / 2;
  }
  face->radius = size * sqrt(fmax(square, 0));
  return square > 0;
}

/* The direction that all normals are perpendicular to, or, centred, at one angle to. */
static void axis_of(const bwi_cloud *cloud, bool centred, double axis[3]) {
  double spread[6] = {0}, mean[3] = {0}, whole = 0, value[3], vector[9];
  for (int64_t f = 0; f < cloud->facets; f++) {
    whole += cloud->area[f];
    for (int k = 0; k < 3; k++)
      mean[k] += cloud->area[f] * cloud->normal[3 * f + k];
  }
  for (int64_t f = 0; f < cloud->facets; f++) {
    double n[3];
    for (int k = 0; k < 3; k++)
      n[k] = cloud->normal[3 * f + k] - (centred ? mean[k] / whole : 0);
    const double now[6] = {n[0] * n[0], n[1] * n[1], n[2] * n[2],
                           n[1] * n[2], n[0] * n[2], n[0] * n[1]};
    for (int k = 0; k < 6; k++)
      spread[k] += cloud->area[f] / whole * now[k];
  }
  bw_eigen3(spread, value, vector);
  memcpy(axis, vector + 6, 3 * sizeof *axis);
}

/* Start of a cylinder or cone around its axis: r^2 - s^2 t^2 = 2 c . y + k + p t. */
static bool start_round(const bwi_cloud *cloud, bw_face *face, double slope) {
  double a[MAX_TERMS][MAX_TERMS] = {{0}}, b[MAX_TERMS] = {0}, mean[3], size, u[3], v[3];
  int n = slope == 0 ? 3 : 4;
  centroid_of(cloud, mean, &size);
  bw_across(face->axis, u, v);
  for (int64_t i = 0; i < cloud->points; i++) {
    double y[3];
    for (int k = 0; k < 3; k++)
      y[k] = (cloud->point[3 * i + k] - mean[k]) / size;
    double t = bw_dot(y, face->axis), row[4] = {bw_dot(y, u), bw_dot(y, v), 1, t};
    add_row(n, row, row[0] * row[0] + row[1] * row[1] - slope * slope * t * t, a, b);
  }
  if (!solve(n, a, b))
    return false;
  double square = b[2] + (b[0] * b[0] + b[1] * b[1]) / 4;
  if (!(square > 0))
    return false;
  for (int k = 0; k < 3; k++)
    face->point[k] = mean[k] + size * (b[0] * u[k] + b[1] * v[k]) / 2;
  face->radius = size * sqrt(square);
  face->slope = slope;
  return true;
}

/* Gauss-Newton on the distances: place across the axis, its tilt, radius and, of a cone, slope. */
static bool refine_round(const bwi_cloud *cloud, bw_face *face) {
  int n = face->kind == BW_FACE_CONE ? 6 : 5;
  for (int step = 0; step < STEPS; step++) {
    double a[MAX_TERMS][MAX_TERMS] = {{0}}, b[MAX_TERMS] = {0}, u[3], v[3], largest = 0;
    double steep = sqrt(1 + face->slope * face->slope), unit = face->radius;
    bw_across(face->axis, u, v);
    for (int64_t i = 0; i < cloud->points; i++) {
      double g[3], d[3], out[3];
      double value = bw_face_distance(face, cloud->point + 3 * i, g);
      for (int k = 0; k < 3; k++)
        d[k] = cloud->point[3 * i + k] - face->point[k];
      double t = bw_dot(d, face->axis);
      for (int k = 0; k < 3; k++)
        out[k] = d[k] - t * face->axis[k];
      double far = bw_norm(out), eu = far > 0 ? bw_dot(out, u) / far : 0;
      double ev = far > 0 ? bw_dot(out, v) / far : 0;
      /* axis + alpha u + beta v: far changes by -t (alpha eu + beta ev), t by far (...) */
      double tilt = -(t + face->slope * far);
      double row[6] = {
          -eu / steep, -ev / steep,      tilt * eu / steep / unit, tilt * ev / steep / unit,
          -1 / steep,  -t / steep / unit};
      add_row(n, row, -value, a, b);
    }
    for (int i = 0; i < n; i++) /* a little damping: directions that no point holds stay */
      a[i][i] *= 1 + 1e-12;
    if (!solve(n, a, b))
      return step > 0;
    for (int k = 0; k < 3; k++) {
      face->point[k] += b[0] * u[k] + b[1] * v[k];
      face->axis[k] += (b[2] * u[k] + b[3] * v[k]) / unit;
    }
    double size = bw_norm(face->axis);
    for (int k = 0; k < 3; k++)
      face->axis[k] /= size;
    face->radius += b[4];
    if (n == 6)
      face->slope += b[5] / unit;
    for (int i = 0; i < n; i++)
      largest = fmax(largest, fabs(b[i]));
    if (!isfinite(largest) || !(face->radius > 0))
      return false;
    if (largest < 1e-14 * unit)
      break;
  }
  return true;
}

static bool fit_round(const bwi_cloud *cloud, bw_face *face) {
  axis_of(cloud, face->kind == BW_FACE_CONE, face->axis);
  double slope = 0;
  if (face->kind == BW_FACE_CONE) {
    double mean = 0, whole = 0;
    for (int64_t f = 0; f < cloud->facets; f++) {
      mean += cloud->area[f] * bw_dot(cloud->normal + 3 * f, face->axis);
      whole += cloud->area[f];
    }
    mean /= whole;
    if (fabs(mean) < 0.01 || fabs(mean) > 0.999)
      return false;
    slope = fabs(mean) / sqrt(1 - mean * mean);
    /* outward normals lean against the axis where the radius grows; inward ones along it */
    bw_face other = *face;
    bool one = start_round(cloud, face, slope) && refine_round(cloud, face);
    bool two = start_round(cloud, &other, -slope) && refine_round(cloud, &other);
    double far[2] = {0, 0};
    for (int64_t i = 0; i < cloud->points; i++) {
      far[0] = fmax(far[0], fabs(bw_face_distance(face, cloud->point + 3 * i, NULL)));
      far[1] = fmax(far[1], fabs(bw_face_distance(&other, cloud->point + 3 * i, NULL)));
    }
    if (two && (!one || far[1] < far[0]))
      *face = other;
    return (one || two) && fabs(face->slope) > 1e-3;
  }
  return start_round(cloud, face, 0) && refine_round(cloud, face);
}

bool bwi_face_fit(const bwi_cloud *cloud, bw_face_kind kind, bw_face *face) {
  static const int min[] = {3, 6, 7, 5};
  bool fits = false;
  *face = (bw_face){.kind = kind};
  if (kind == BW_FACE_FREE || cloud->points < min[kind])
    return kind == BW_FACE_FREE;
  if (kind == BW_FACE_PLANE)
    fits = fit_plane(cloud, face);
  else if (kind == BW_FACE_SPHERE)
    fits = fit_sphere(cloud, face);
  else
    fits = fit_round(cloud, face);
  for (int64_t i = 0; fits && i < cloud->points; i++)
    face->residual = fmax(face->residual, fabs(bw_face_distance(face, cloud->point + 3 * i, NULL)));
  return fits && isfinite(face->residual);
}
