/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* Bodies whose sides are not the grid's: cut cells count by the part inside. Cook's membrane at
 * finite strain, plane strain, against values of quadratic elements that follow its sides; a hollow
 * sphere blown up by a pressure that follows, against the equation of its radius. */
#include "nonlinear/whole.h"

/* ---- Cook's membrane: corners (0, 0), (48, 44), (48, 60), (0, 44) ---------------------------- */

/* The part of a column of width h at x where y < bottom + slope x, counted in [y, y + h]: by many
 * strips, exact enough. */
static double below(double x, double y, double h, double bottom, double slope) {
  double sum = 0;
  const int strips = 64;
  for (int s = 0; s < strips; s++) {
    double edge = bottom + slope * (x + (s + 0.5) / strips * h);
    sum += fmin(fmax(edge - y, 0), h);
  }
  return sum / (strips * h);
}

static bw_grid *membrane(bw_context *context, int cells) {
  double h = 48.0 / cells;
  const int32_t count[3] = {cells, cells / 4 * 5, 1};
  const double origin[3] = {0, 0, 0}, spacing[3] = {h, h, 1};
  size_t all = (size_t)count[0] * (size_t)count[1];
  double *fraction = BW_NEW(context, double, all);
  int32_t *material = BW_NEW(context, int32_t, all);
  bw_grid *grid;
  for (size_t k = 0; k < all; k++) {
    double x = (double)(k % (size_t)cells) * h, y = (double)(k / (size_t)cells) * h;
    double part = below(x, y, h, 44, 16.0 / 48) - below(x, y, h, 0, 44.0 / 48);
    material[k] = part > 1e-3;
    fraction[k] = material[k] ? fmin(part, 1) : 1;
  }
  check_ok(context, bw_grid_create(context, origin, spacing, count, material, fraction, &grid));
  bw_free(fraction);
  bw_free(material);
  return grid;
}

static double cook(bw_context *context, bw_law law, double nu, int cells) {
  body b = body_of(context, membrane(context, cells), law, 240.565, nu, 0);
  bw_load_case *load_case;
  check_near(bw_grid_volume(b.grid), 48 * (44 + 16) / 2, 0.05);
  check_ok(context, bw_load_case_create(context, b.grid, &load_case));
  hold_side(context, load_case, 0, 0, 7, 0, 0, 0);
  const bool plane[3] = {false, false, true};
  const double zero[3] = {0, 0, 0}, force[3] = {0, 100, 0};
  int32_t *edge = BW_NEW(context, int32_t, b.nodes);
  int64_t count = 0;
  for (int32_t i = 0; i < b.nodes; i++) {
    double x[3];
    bw_grid_position(b.grid, i, x);
    check_ok(context, bw_load_case_fix(context, load_case, 1, &i, plane, zero));
    if (x[0] > 48 - 1e-6 && x[1] > 44 - 1e-6)
      edge[count++] = i;
  }
  check_ok(context, bw_load_case_force(context, load_case, count, edge, force));
  bw_newton_options options;
  bw_solid_static *result = NULL;
  bw_newton_options_default(&options);
  check_ok(context, bw_solid_statics(context, b.solid, load_case, NULL, &options, &result));
  double y = result->displacement[3 * (int64_t)node_near(b.grid, 48, 52, 0) + 1];
  bw_free(edge);
  bw_release(result);
  bw_release(load_case);
  body_release(&b);
  return y;
}

static void test_cook(void **state) {
  bw_context *context = check_context(state);
  bool full = getenv("BARWRIGHT_FULL") != NULL;
  const struct {
    bw_law law;
    double poisson, value;
  } of[3] = {{BW_NEO_HOOKEAN, 0.3, 7.892},
             {BW_ST_VENANT_KIRCHHOFF, 0.3, 7.627},
             {BW_NEO_HOOKEAN, 0.4, 7.514}};
  for (int k = 0; k < 3; k++)
    for (int r = 0; r < (full ? 4 : 2); r++) {
      double y = cook(context, of[k].law, of[k].poisson, 24 << r), value = of[k].value;
      printf(
          "VERIFY | Cook's membrane, %s, nu = %g, %d cells along | uy at (48, 52) | %.3f | %.4f | "
          "%s | quadratic elements\n",
          bw_law_word(of[k].law), of[k].poisson, 24 << r, value, y, r < 2 ? "2 %" : "0.7 %");
      check_near(y / value, 1, r < 2 ? 0.02 : 0.007);
    }
  /* Nearly incompressible, these elements lock: nobody should take them for rubber that hardly
     changes its volume. The value is from the literature. */
  double locked = cook(context, BW_NEO_HOOKEAN, 0.4999, 48);
  printf("VERIFY | Cook's membrane, neo_hookean, nu = 0.4999, 48 cells: locks | uy at (48, 52) | "
         "6.9 | "
         "%.4f | below | literature\n",
         locked);
  assert_true(locked > 1 && locked < 6.5);
}

/* ---- a hollow sphere ----------------------------------------------------------------------- */

static const double young = 1e6, poisson = 0.3, inner = 0.5, outer = 1;

/* Radial and hoop first Piola-Kirchhoff stress of the neo-Hookean law at r', r / R. */
static void sphere_stress(double radial, double hoop, double *p, double *q) {
  double mu = young / (2 * (1 + poisson)),
         lambda = young * poisson / ((1 + poisson) * (1 - 2 * poisson));
  double j = log(radial) + 2 * log(hoop);
  *p = mu * (radial - 1 / radial) + lambda * j / radial;
  *q = mu * (hoop - 1 / hoop) + lambda * j / hoop;
}

/* r' for which the radial stress is p at a hoop stretch. */
static double radial_of(double p, double hoop) {
  double low = 1e-3, high = 10;
  for (int k = 0; k < 100; k++) {
    double at = (low + high) / 2, now, other;
    sphere_stress(at, hoop, &now, &other);
    *(now > p ? &high : &low) = at;
  }
  return low;
}

/* dP/dR = 2 (Q - P) / R from the inside, where r = start and P = -pressure (r / R)^2; what remains
 * of P at the outside. *end: r there. */
static double shoot(double pressure, double start, double *end) {
  const int steps = 400;
  double h = (outer - inner) / steps, r = start;
  double p = -pressure * (r / inner) * (r / inner);
  for (int k = 0; k < steps; k++) {
    double kr[4], kp[4];
    for (int s = 0; s < 4; s++) { /* Runge and Kutta */
      double part = s == 0 ? 0 : s == 3 ? h : h / 2, at = inner + k * h + part;
      double r_at = r + part * (s ? kr[s - 1] : 0), p_at = p + part * (s ? kp[s - 1] : 0), hoop, q;
      kr[s] = radial_of(p_at, r_at / at);
      sphere_stress(kr[s], r_at / at, &hoop, &q);
      kp[s] = 2 * (q - p_at) / at;
    }
    r += h / 6 * (kr[0] + 2 * kr[1] + 2 * kr[2] + kr[3]);
    p += h / 6 * (kp[0] + 2 * kp[1] + 2 * kp[2] + kp[3]);
  }
  *end = r;
  return p;
}

static void radii(double pressure, double *inside, double *outside) {
  double low = inner, high = 1.6 * inner;
  for (int k = 0; k < 60; k++) {
    double at = (low + high) / 2;
    *(shoot(pressure, at, outside) > 0 ? &high : &low) = at;
  }
  *inside = low;
}

/* An eighth of the sphere. */
static bw_grid *eighth(bw_context *context, int cells) {
  double h = outer / cells;
  const int32_t count[3] = {cells, cells, cells};
  const double origin[3] = {0, 0, 0}, spacing[3] = {h, h, h};
  size_t all = (size_t)cells * (size_t)cells * (size_t)cells;
  double *fraction = BW_NEW(context, double, all);
  int32_t *material = BW_NEW(context, int32_t, all);
  bw_grid *grid;
  const int fine = 8;
  for (size_t k = 0; k < all; k++) {
    int inside = 0;
    size_t n = (size_t)cells;
    for (int s = 0; s < fine * fine * fine; s++) {
      double x[3] = {((double)(k % n) + (s % fine + 0.5) / fine) * h,
                     ((double)(k / n % n) + (s / fine % fine + 0.5) / fine) * h,
                     ((double)(k / n / n) + (s / fine / fine + 0.5) / fine) * h};
      double r = bw_norm(x);
      inside += r > inner && r < outer;
    }
    material[k] = inside > 0;
    fraction[k] = inside > 0 ? (double)inside / (fine * fine * fine) : 1;
  }
  check_ok(context, bw_grid_create(context, origin, spacing, count, material, fraction, &grid));
  bw_free(fraction);
  bw_free(material);
  return grid;
}

/* Mean radii of the inner and outer surface, by points on them that go along. */
static void blow(bw_context *context, int cells, double pressure, double *inside, double *outside) {
  body b = body_of(context, eighth(context, cells), BW_NEO_HOOKEAN, young, poisson, 0);
  /* the inner surface: triangles of an octahedron's face, divided and lifted to the sphere */
  enum { PARTS = 24, POINTS = (PARTS + 1) * (PARTS + 2) / 2 };
  static double point[2][3 * POINTS];
  static int32_t triangle[3 * PARTS * PARTS];
  int32_t number[PARTS + 1][PARTS + 1], points = 0;
  int64_t triangles = 0;
  for (int i = 0; i <= PARTS; i++)
    for (int j = 0; i + j <= PARTS; j++) {
      double x[3] = {i, j, PARTS - i - j}, length = bw_norm(x);
      for (int d = 0; d < 3; d++) {
        point[0][3 * points + d] = x[d] / length * inner;
        point[1][3 * points + d] = x[d] / length * outer;
      }
      number[i][j] = points++;
    }
  for (int i = 0; i < PARTS; i++)
    for (int j = 0; i + j < PARTS; j++)
      for (int up = 0; up < (i + j + 1 < PARTS ? 2 : 1); up++) {
        /* counter-clockwise seen from the hollow: pressure pushes away from the centre */
        const int32_t of[2][3] = {
            {number[i][j], number[i][j + 1], number[i + 1][j]},
            {up ? number[i + 1][j] : 0, up ? number[i][j + 1] : 0, up ? number[i + 1][j + 1] : 0}};
        memcpy(triangle + 3 * triangles++, of[up], sizeof of[up]);
      }
  double e1[3], e2[3], n[3]; /* the first one's normal should point to the centre */
  for (int d = 0; d < 3; d++) {
    e1[d] = point[0][3 * triangle[1] + d] - point[0][3 * triangle[0] + d];
    e2[d] = point[0][3 * triangle[2] + d] - point[0][3 * triangle[0] + d];
  }
  bw_cross(e1, e2, n);
  if (bw_dot(n, point[0] + 3 * triangle[0]) > 0)
    for (int64_t t = 0; t < triangles; t++) {
      int32_t other = triangle[3 * t + 1];
      triangle[3 * t + 1] = triangle[3 * t + 2];
      triangle[3 * t + 2] = other;
    }
  bw_embedding *embedding[2];
  bw_load_case *load_case;
  double *all = BW_NEW(context, double, triangles);
  for (int64_t t = 0; t < triangles; t++)
    all[t] = pressure;
  for (int k = 0; k < 2; k++)
    check_ok(context, bw_embedding_create(context, b.grid, points, point[k], 2, &embedding[k]));
  check_ok(context, bw_load_case_create(context, b.grid, &load_case));
  check_ok(context,
           bw_load_case_pressure(context, load_case, embedding[0], triangles, triangle, all, true));
  for (int d = 0; d < 3; d++)
    hold_side(context, load_case, d, 0, 1 << d, 0, 0, 0);
  bw_newton_options options;
  bw_solid_static *result = NULL;
  bw_newton_options_default(&options);
  check_ok(context, bw_solid_statics(context, b.solid, load_case, NULL, &options, &result));
  static double moved[3 * POINTS];
  double mean[2] = {0};
  for (int k = 0; k < 2; k++) {
    bw_embedding_values(embedding[k], 3, result->displacement, moved);
    for (int32_t p = 0; p < points; p++) {
      double x[3];
      for (int d = 0; d < 3; d++)
        x[d] = point[k][3 * p + d] + moved[3 * p + d];
      mean[k] += bw_norm(x) / points;
    }
    bw_release(embedding[k]);
  }
  *inside = mean[0];
  *outside = mean[1];
  bw_free(all);
  bw_release(result);
  bw_release(load_case);
  body_release(&b);
}

static void test_sphere(void **state) {
  bw_context *context = check_context(state);
  bool full = getenv("BARWRIGHT_FULL") != NULL;
  double pressure = 0.2 * young, exact[2], value[2];
  radii(pressure, &exact[0], &exact[1]);
  assert_true(exact[0] > 1.1 * inner);
  for (int cells = 8; cells <= (full ? 16 : 8); cells *= 2) {
    blow(context, cells, pressure, &value[0], &value[1]);
    for (int k = 0; k < 2; k++) {
      double at = k ? outer : inner, grown = (value[k] - at) / (exact[k] - at);
      printf("VERIFY | hollow sphere blown up, %d cells along the radius | growth of its %s radius "
             "(m) | %.6f | %.6f | 6 %% | equation of the radius\n",
             cells, k ? "outer" : "inner", exact[k] - at, value[k] - at);
      check_near(grown, 1, 0.06);
    }
  }
}

check_main(check_test(test_cook), check_test(test_sphere))
