/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* A Reissner-Mindlin triangle that does not lock: MITC7 (Bathe, Brezzi, Fortin). Deflection from
 * six nodes, rotations from six nodes and a cubic bubble, covariant shear strains interpolated in
 * the rotated Raviart-Thomas space of lowest order but one,
 *
 *   g_xi  = a1 + b1 xi + c1 eta + eta (d xi + e eta)
 *   g_eta = a2 + b2 xi + c2 eta - xi  (d xi + e eta),
 *
 * from their tangential values at two Gauss points of each edge and their two means. Gradients of
 * quadratic deflections are in that space, so a thin plate can bend without shear. In reference
 * coordinates, so that sides may be curved. docs/theory/responsive.md, "Plate modes". */
#include "responsive/plate.h"

#include <math.h>
#include <string.h>

/* ---- the law ------------------------------------------------------------------------------- */

static void inverse2(const double a[4], double inverse[4]) {
  double d = a[0] * a[3] - a[1] * a[2];
  inverse[0] = a[3] / d;
  inverse[1] = -a[1] / d;
  inverse[2] = -a[2] / d;
  inverse[3] = a[0] / d;
}

bw_status bwi_plate_law_create(bw_context *context, const bw_material *material, double thickness,
                               bwi_plate_law *law) {
  if (!(thickness > 0) || !isfinite(thickness))
    return bw_fail(context, BW_INVALID, "a plate needs a thickness above 0, not %g m", thickness);
  if (!(material->density > 0))
    return bw_fail(context, BW_INVALID, "material '%s' has no density: modes need one, in kg/m3",
                   material->name);
  if (material->parts)
    return bw_fail(context, BW_INVALID,
                   "material '%s' has axes by element of a solid mesh: the triangles of a plate "
                   "are other elements. Give the material with one set of axes",
                   material->name);
  static const int in[3] = {0, 1, 5}, across[2] = {4, 3}; /* xx yy xy; zx yz */
  const double *s = material->compliance;
  for (int i = 0; i < 3; i++)
    for (int j = 0; j < 2; j++) {
      double coupled = s[6 * in[i] + across[j]];
      if (coupled * coupled > 1e-12 * s[7 * in[i]] * s[7 * across[j]])
        return bw_fail(context, BW_INVALID,
                       "material '%s' couples stresses in the plane with shear across it: one of "
                       "its axes must be the plate's normal, z",
                       material->name);
    }
  double plane[9], q[9], cross[4], g[4];
  for (int i = 0; i < 3; i++)
    for (int j = 0; j < 3; j++)
      plane[3 * i + j] = s[6 * in[i] + in[j]];
  for (int i = 0; i < 2; i++)
    for (int j = 0; j < 2; j++)
      cross[2 * i + j] = s[6 * across[i] + across[j]];
  bw_inverse3(plane, q);
  inverse2(cross, g);
  double h = thickness;
  for (int i = 0; i < 9; i++)
    law->bending[i] = h * h * h / 12 * q[i];
  for (int i = 0; i < 4; i++)
    law->shear[i] = 5.0 / 6 * h * g[i];
  law->mass = material->density * h;
  law->inertia = material->density * h * h * h / 12;
  return BW_OK;
}

/* ---- the reference triangle ------------------------------------------------------------------ */

static void shape_at(const double l[3], double value[7], double slope[2][7]) {
  /* d l0 = -d xi - d eta, d l1 = d xi, d l2 = d eta */
  static const double dl[2][3] = {{-1, 1, 0}, {-1, 0, 1}};
  for (int i = 0; i < 3; i++) {
    int j = (i + 1) % 3;
    value[i] = l[i] * (2 * l[i] - 1);
    value[3 + i] = 4 * l[i] * l[j];
    for (int d = 0; d < 2; d++) {
      slope[d][i] = (4 * l[i] - 1) * dl[d][i];
      slope[d][3 + i] = 4 * (l[i] * dl[d][j] + l[j] * dl[d][i]);
    }
  }
  value[6] = 27 * l[0] * l[1] * l[2];
  for (int d = 0; d < 2; d++)
    slope[d][6] = 27 * (dl[d][0] * l[1] * l[2] + l[0] * dl[d][1] * l[2] + l[0] * l[1] * dl[d][2]);
}

/* The eight functions of the interpolation: rows g_xi, g_eta at a point. */
static void interpolation(double xi, double eta, double row[2][8]) {
  const double at[2][8] = {{1, xi, eta, 0, 0, 0, eta * xi, eta * eta},
                           {0, 0, 0, 1, xi, eta, -xi * xi, -xi * eta}};
  memcpy(row, at, sizeof at);
}

static void invert8(double a[8][8], double inverse[8][8]) {
  memset(inverse, 0, 64 * sizeof(double));
  for (int i = 0; i < 8; i++)
    inverse[i][i] = 1;
  for (int k = 0; k < 8; k++) {
    int pivot = k;
    for (int i = k + 1; i < 8; i++)
      if (fabs(a[i][k]) > fabs(a[pivot][k]))
        pivot = i;
    for (int j = 0; j < 8; j++) {
      double t = a[k][j];
      a[k][j] = a[pivot][j];
      a[pivot][j] = t;
      t = inverse[k][j];
      inverse[k][j] = inverse[pivot][j];
      inverse[pivot][j] = t;
    }
    double scale = 1 / a[k][k];
    for (int j = 0; j < 8; j++) {
      a[k][j] *= scale;
      inverse[k][j] *= scale;
    }
    for (int i = 0; i < 8; i++) {
      double factor = i == k ? 0 : a[i][k];
      for (int j = 0; j < 8 && factor != 0; j++) {
        a[i][j] -= factor * a[k][j];
        inverse[i][j] -= factor * inverse[k][j];
      }
    }
  }
}

/* One evaluation of covariant shear at a point, weighted into condition `row`. */
static void tie_at(bwi_plate_reference *r, int k, int row, const double l[3], double weight_xi,
                   double weight_eta, double condition[8][8]) {
  double slope[2][7], at[2][8];
  shape_at(l, r->tie[k].value, slope);
  for (int d = 0; d < 2; d++)
    memcpy(r->tie[k].slope[d], slope[d], 6 * sizeof(double));
  /* the bubble has slopes of its own only in curvatures: shear holds rotations, not their slopes */
  r->tie[k].row = row;
  r->tie[k].weight[0] = weight_xi;
  r->tie[k].weight[1] = weight_eta;
  interpolation(l[1], l[2], at);
  for (int j = 0; j < 8; j++)
    condition[row][j] += weight_xi * at[0][j] + weight_eta * at[1][j];
}

void bwi_plate_reference_fill(bwi_plate_reference *r) {
  double point[BW_QUADRATURE_POINTS][3], weight[BW_QUADRATURE_POINTS];
  r->points = bw_triangle_quadrature(5, point, weight);
  for (int p = 0; p < r->points; p++) {
    r->weight[p] = weight[p] / 2;
    shape_at(point[p], r->value[p], r->slope[p]);
  }
  static const double corner[6][3] = {{1, 0, 0},   {0, 1, 0},   {0, 0, 1},
                                      {.5, .5, 0}, {0, .5, .5}, {.5, 0, .5}};
  for (int a = 0; a < 6; a++) {
    double value[7], slope[2][7];
    shape_at(corner[a], value, slope);
    for (int d = 0; d < 2; d++)
      memcpy(r->node_slope[a][d], slope[d], 6 * sizeof(double));
  }
  double condition[8][8] = {{0}}, inverse[8][8];
  double gauss[2] = {(1 - 1 / sqrt(3.0)) / 2, (1 + 1 / sqrt(3.0)) / 2};
  for (int s = 0; s < 2; s++) {
    double t = gauss[s];
    tie_at(r, s, s, (double[3]){1 - t, t, 0}, 1, 0, condition);
    tie_at(r, 2 + s, 2 + s, (double[3]){0, 1 - t, t}, -1, 1, condition);
    tie_at(r, 4 + s, 4 + s, (double[3]){1 - t, 0, t}, 0, 1, condition);
  }
  for (int p = 0; p < r->points; p++) { /* both means from one evaluation: see bwi rows 6 and 7 */
    tie_at(r, 6 + p, 6, point[p], weight[p], 0, condition);
    double at[2][8];
    interpolation(point[p][1], point[p][2], at);
    for (int j = 0; j < 8; j++)
      condition[7][j] += weight[p] * at[1][j];
  }
  invert8(condition, inverse);
  for (int p = 0; p < r->points; p++) {
    double at[2][8];
    interpolation(point[p][1], point[p][2], at);
    for (int d = 0; d < 2; d++)
      for (int k = 0; k < 8; k++) {
        double sum = 0;
        for (int j = 0; j < 8; j++)
          sum += at[d][j] * inverse[j][k];
        r->field[p][d][k] = sum;
      }
  }
}

/* ---- an element ------------------------------------------------------------------------------ */

/* Numbers in a row over the 20 unknowns, the last of them zero: whole vector registers. */
enum { ROW = 24 };

/* Rows d x / d xi, d x / d eta; the determinant comes back. */
static double jacobian(const double slope[2][7], const double x[6][2], double j[4]) {
  for (int d = 0; d < 2; d++)
    for (int c = 0; c < 2; c++) {
      double sum = 0;
      for (int a = 0; a < 6; a++)
        sum += slope[d][a] * x[a][c];
      j[2 * d + c] = sum;
    }
  return j[0] * j[3] - j[1] * j[2];
}

/* The 8 conditions as rows over the 20 unknowns: covariant shear g_d = w,d + b . x,d. */
static void tying_rows(const bwi_plate_reference *r, const double x[6][2], double row[8][ROW]) {
  memset(row, 0, 8 * ROW * sizeof(double));
  for (int k = 0; k < 6 + r->points; k++) {
    const double *value = r->tie[k].value;
    double j[4];
    for (int d = 0; d < 2; d++)
      for (int c = 0; c < 2; c++) {
        double sum = 0;
        for (int a = 0; a < 6; a++)
          sum += r->tie[k].slope[d][a] * x[a][c];
        j[2 * d + c] = sum;
      }
    for (int d = 0; d < 2; d++) {
      /* the means: xi into row 6, eta into row 7, with one weight */
      double weight = k < 6 ? r->tie[k].weight[d] : r->tie[k].weight[0];
      double *to = row[k < 6 ? r->tie[k].row : 6 + d];
      if (weight == 0)
        continue;
      for (int a = 0; a < 6; a++) {
        to[3 * a] += weight * r->tie[k].slope[d][a];
        to[3 * a + 1] += weight * value[a] * j[2 * d];
        to[3 * a + 2] += weight * value[a] * j[2 * d + 1];
      }
      to[18] += weight * value[6] * j[2 * d];
      to[19] += weight * value[6] * j[2 * d + 1];
    }
  }
}

/* Where the rotation of function a (6: the bubble) stands among the unknowns. */
static inline int rotation(int a) {
  return a < 6 ? 3 * a + 1 : 18;
}

/* Rows of strains at all points, of their stresses times weights of the quadrature. */
enum { STRAINS = 5 };
typedef double eight __attribute__((vector_size(64), aligned(8), may_alias));
typedef struct point_rows {
  double strain[BWI_PLATE_POINTS * STRAINS][ROW], stress[BWI_PLATE_POINTS * STRAINS][ROW];
} point_rows;

/* Stresses of the strains (three curvatures, two shears) of one point. */
static void add_stresses(const bwi_plate_law *law, double weight, const double (*b)[ROW],
                         double (*db)[ROW]) {
  for (int u = 0; u < ROW; u++) {
    for (int i = 0; i < 3; i++)
      db[i][u] = weight * (law->bending[3 * i] * b[0][u] + law->bending[3 * i + 1] * b[1][u] +
                           law->bending[3 * i + 2] * b[2][u]);
    for (int i = 0; i < 2; i++)
      db[3 + i][u] = weight * (law->shear[2 * i] * b[3][u] + law->shear[2 * i + 1] * b[4][u]);
  }
}

/* k = sum of strain^T stress, in the upper triangle and some of the lower: a part of four rows and
 * eight columns stays in registers while all points are added. */
static void add_points(const point_rows *rows, int count, double k[20][ROW]) {
  for (int u = 0; u < 20; u += 4)
    for (int v = u / 8 * 8; v < ROW; v += 8) {
      eight sum[4] = {{0}};
      for (int p = 0; p < count; p++) {
        const double *b = rows->strain[p] + u;
        const eight db = *(const eight *)(rows->stress[p] + v);
        for (int i = 0; i < 4; i++)
          sum[i] += b[i] * db;
      }
      for (int i = 0; i < 4; i++)
        *(eight *)(k[u + i] + v) = sum[i];
    }
}

double bwi_plate_stiffness(const bwi_plate_reference *r, const bwi_plate_law *law,
                           const double x[6][2], double *stiffness, double *bubble) {
  double k[20][ROW], tying[8][ROW], smallest = INFINITY;
  point_rows rows;
  tying_rows(r, x, tying);
  for (int p = 0; p < r->points; p++) {
    double j[4], to[4];
    double det = jacobian(r->slope[p], x, j);
    smallest = fmin(smallest, det);
    if (!(det > 0))
      return det;
    inverse2(j, to); /* gradient = to * reference slopes */
    double(*strain)[ROW] = rows.strain + STRAINS * p, reference[2][ROW] = {{0}};
    memset(strain, 0, STRAINS * sizeof *strain);
    for (int a = 0; a < 7; a++) {
      double gx = to[0] * r->slope[p][0][a] + to[1] * r->slope[p][1][a];
      double gy = to[2] * r->slope[p][0][a] + to[3] * r->slope[p][1][a];
      int b = rotation(a);
      strain[0][b] = gx;
      strain[1][b + 1] = gy;
      strain[2][b] = gy;
      strain[2][b + 1] = gx;
    }
    for (int d = 0; d < 2; d++)
      for (int i = 0; i < 8; i++)
        for (int u = 0; u < ROW; u++)
          reference[d][u] += r->field[p][d][i] * tying[i][u];
    for (int c = 0; c < 2; c++)
      for (int u = 0; u < ROW; u++)
        strain[3 + c][u] = to[2 * c] * reference[0][u] + to[2 * c + 1] * reference[1][u];
    add_stresses(law, r->weight[p] * det, strain, rows.stress + STRAINS * p);
  }
  add_points(&rows, STRAINS * r->points, k);
  /* condensation: the bubble carries no mass, so that it follows the nodes at once */
  double own[4] = {k[18][18], k[18][19], k[18][19], k[19][19]}, inverse[4], follow[2][18];
  inverse2(own, inverse);
  for (int c = 0; c < 2; c++)
    for (int u = 0; u < 18; u++)
      follow[c][u] = -(inverse[2 * c] * k[u][18] + inverse[2 * c + 1] * k[u][19]);
  for (int u = 0; u < 18; u++)
    for (int v = u; v < 18; v++) /* the same bits on both sides of the diagonal */
      stiffness[18 * u + v] = stiffness[18 * v + u] =
          k[u][v] + k[u][18] * follow[0][v] + k[u][19] * follow[1][v];
  if (bubble)
    memcpy(bubble, follow, sizeof follow);
  return smallest;
}

void bwi_plate_mass(const bwi_plate_reference *r, const double x[6][2], double *mass) {
  memset(mass, 0, 36 * sizeof *mass);
  for (int p = 0; p < r->points; p++) {
    double j[4];
    double weight = r->weight[p] * jacobian(r->slope[p], x, j);
    for (int a = 0; a < 6; a++)
      for (int b = 0; b < 6; b++)
        mass[6 * a + b] += weight * r->value[p][a] * r->value[p][b];
  }
}

static double quadratic_form(const double *d, int n, const double *e) {
  double sum = 0;
  for (int i = 0; i < n; i++)
    for (int k = 0; k < n; k++)
      sum += e[i] * d[n * i + k] * e[k];
  return sum;
}

void bwi_plate_energies(const bwi_plate_reference *r, const bwi_plate_law *law,
                        const double x[6][2], const double u[20], double *elastic,
                        double *kinetic) {
  double tying[8][ROW], condition[8];
  tying_rows(r, x, tying);
  for (int i = 0; i < 8; i++) {
    double sum = 0;
    for (int k = 0; k < 20; k++)
      sum += tying[i][k] * u[k];
    condition[i] = sum;
  }
  *elastic = *kinetic = 0;
  for (int p = 0; p < r->points; p++) {
    double j[4], to[4];
    double det = jacobian(r->slope[p], x, j);
    inverse2(j, to);
    double curvature[3] = {0}, moved[3] = {0}, reference[2] = {0}, shear[2];
    for (int a = 0; a < 7; a++) {
      double gx = to[0] * r->slope[p][0][a] + to[1] * r->slope[p][1][a];
      double gy = to[2] * r->slope[p][0][a] + to[3] * r->slope[p][1][a];
      const double *b = u + rotation(a);
      curvature[0] += gx * b[0];
      curvature[1] += gy * b[1];
      curvature[2] += gy * b[0] + gx * b[1];
    }
    for (int a = 0; a < 6; a++)
      for (int c = 0; c < 3; c++)
        moved[c] += r->value[p][a] * u[3 * a + c];
    for (int d = 0; d < 2; d++)
      for (int i = 0; i < 8; i++)
        reference[d] += r->field[p][d][i] * condition[i];
    for (int c = 0; c < 2; c++)
      shear[c] = to[2 * c] * reference[0] + to[2 * c + 1] * reference[1];
    double weight = r->weight[p] * det;
    *elastic += weight *
                (quadratic_form(law->bending, 3, curvature) + quadratic_form(law->shear, 2, shear));
    *kinetic += weight * (law->mass * moved[0] * moved[0] +
                          law->inertia * (moved[1] * moved[1] + moved[2] * moved[2]));
  }
}
