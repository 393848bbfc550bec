/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* Slender solids against the theory of rods. Fully integrated hexahedra resist bending too much: an
 * element of length l and depth t by the factor 1 + (G / E) (l / t)^2, which is the error seen, and
 * falls with order 2. Poisson's ratio is 0, where a rod's section need not bulge and rod theory is
 * exact up to shear and stretching. */
#include "nonlinear/direct.h"
#include "nonlinear/whole.h"

#define PI 3.14159265358979323846

static const double young = 1e6, side = 0.05;

static double inertia(void) {
  return side * side * side * side / 12;
}

/* Largest load of a column, constrained at its foot, for which the straight state is stable: where
 * the tangent there loses definiteness, by bisection. The corotated law shortens it linearly. */
static double column_load(bw_context *context, int cells, double length) {
  body b = body_box(context, cells, 1, 1, length, side, side, BW_COROTATED, young, 0, 0);
  bwi_direct *direct;
  check_ok(context, bwi_direct_create(context, &direct));
  double *u = BW_NEW0(context, double, 3 * b.nodes);
  double *stiffness = BW_NEW(context, double, 9 * b.solid->pattern->block_count);
  uint8_t *constrained = BW_NEW0(context, uint8_t, 3 * b.nodes);
  double low = 0, high = 0.01; /* shortening */
  for (int32_t i = 0; i < b.nodes; i++) {
    double x[3];
    bw_grid_position(b.grid, i, x);
    for (int c = 0; c < 3; c++)
      constrained[3 * i + c] = x[0] < 1e-9;
  }
  for (int k = 0; k < 22; k++) {
    double at = (low + high) / 2, x[3];
    bw_solid_shape shape;
    bool definite;
    for (int32_t i = 0; i < b.nodes; i++) {
      bw_grid_position(b.grid, i, x);
      u[3 * i] = -at * x[0];
    }
    check_ok(context, bw_solid_evaluate(context, b.solid, u, false, NULL, NULL, stiffness, &shape));
    check_ok(context, bwi_direct_factor(context, direct, b.solid->pattern, constrained, stiffness,
                                        &definite, NULL));
    *(definite ? &low : &high) = at;
  }
  assert_true(low > 0 && high < 0.01);
  bwi_direct_destroy(direct);
  bw_free(u);
  bw_free(stiffness);
  bw_free(constrained);
  body_release(&b);
  return young * side * side * low;
}

static void test_column(void **state) {
  bw_context *context = check_context(state);
  double length = 1, load[3];
  double euler = PI * PI * young * inertia() / (4 * length * length);
  /* Engesser: shear makes it softer; the section stays plane in these elements, so that its whole
     area shears. And the column has become shorter, and as much stiffer, by P / EA. */
  double shear = euler / (1 + euler / (young / 2 * side * side));
  for (int k = 0; k < 3; k++) {
    int cells = 40 << k;
    load[k] = column_load(context, cells, length);
    double ratio = length / (cells * side), locked = euler * (1 + 0.5 * ratio * ratio);
    printf("VERIFY | column of %d hex8 along, one across | buckling load over Euler's | %.5f | "
           "%.5f | 0.005 | Euler, with what the elements add by theory\n",
           cells, locked / euler, load[k] / euler);
    check_near(load[k] / locked, 1, 5e-3);
  }
  double limit = load[2] + (load[2] - load[1]) / 3;
  double order = log2((load[0] - load[1]) / (load[1] - load[2]));
  printf(
      "VERIFY | column, cells to zero | buckling load over Euler's with shear | 1 | %.5f | 0.002 "
      "| Engesser\n",
      limit / shear);
  printf("VERIFY | column | order of the buckling load | 2 | %.2f | 0.1 | theory\n", order);
  check_near(order, 2, 0.1);
  check_near(limit / shear, 1, 2e-3);
}

/* The tip of a cantilever under a load across that keeps its direction. */
static void bend(bw_context *context, int cells, double length, double load, double *w, double *u) {
  body b = body_box(context, cells, 1, 1, length, side, side, BW_COROTATED, young, 0, 0);
  bw_load_case *load_case;
  check_ok(context, bw_load_case_create(context, b.grid, &load_case));
  hold_side(context, load_case, 0, 0, 7, 0, 0, 0);
  push_side(context, load_case, 0, length, 0, 0, load * young * inertia() / (length * length));
  bw_newton_options options;
  bw_solid_static *result = NULL;
  bw_newton_options_default(&options);
  options.tolerance = 1e-8;
  check_ok(context, bw_solid_statics(context, b.solid, load_case, NULL, &options, &result));
  *w = *u = 0;
  for (int k = 0; k < 4; k++) {
    const double *at = result->displacement +
                       3 * (int64_t)node_near(b.grid, length, side * (k & 1), side * (k >> 1));
    *w += at[2] / 4 / length;
    *u -= at[0] / 4 / length;
  }
  bw_release(result);
  bw_release(load_case);
  body_release(&b);
}

static void test_elastica(void **state) {
  bw_context *context = check_context(state);
  static const double load[3] = {1, 4, 10}, across[3] = {0.30172077, 0.66996418, 0.81060902},
                      along[3] = {0.05643324, 0.32894124, 0.55499560};
  double length = 2; /* 40 sides */
  for (int k = 0; k < 3; k++) {
    double w[2], u[2];
    for (int r = 0; r < 2; r++)
      bend(context, 120 << r, length, load[k], &w[r], &u[r]);
    double w_limit = w[1] + (w[1] - w[0]) / 3, u_limit = u[1] + (u[1] - u[0]) / 3;
    printf(
        "VERIFY | cantilever, P L^2 / EI = %g, 240 hex8 | w / L | %.6f | %.6f | 2 %% | elastica\n",
        load[k], across[k], w[1]);
    printf("VERIFY | the same, cells to zero | w / L | %.6f | %.6f | 0.3 %% | elastica\n",
           across[k], w_limit);
    printf("VERIFY | the same, cells to zero | u / L | %.6f | %.6f | 0.5 %% | elastica\n", along[k],
           u_limit);
    check_near(w[1] / across[k], 1, 0.02);
    check_near(w_limit / across[k], 1, 3e-3);
    check_near(u_limit / along[k], 1, 5e-3);
  }
}

/* A column under a little more than it carries straight: nothing pushes it to a side, and it is
 * found bent all the same, about its weaker axis. With the angle a at its tip, k = sin(a / 2): P /
 * P_Euler = (2 K(k) / pi)^2, w / L = 2 k / K, u / L = 2 - 2 E(k) / K; a = 60 degrees. The
 * deflection changes fast with the load there, so the load is taken relative to what the elements
 * make of the stiffness. */
static void test_buckled(void **state) {
  bw_context *context = check_context(state);
  const double first = 1.685750354812596,
               second = 1.467462209339427; /* K and E at sin 30 degrees */
  enum { CELLS = 160 };
  double length = 2, tip[3] = {0}, cell = length / CELLS / side;
  double load = first * first * young * 2 * inertia() / (length * length) * (1 + cell * cell / 2);
  body b = body_box(context, CELLS, 1, 1, length, 2 * side, side, BW_COROTATED, young, 0, 0);
  bw_load_case *load_case;
  check_ok(context, bw_load_case_create(context, b.grid, &load_case));
  hold_side(context, load_case, 0, 0, 7, 0, 0, 0);
  push_side(context, load_case, 0, length, -load, 0, 0);
  bw_newton_options options;
  bw_solid_static *result = NULL;
  bw_newton_options_default(&options);
  options.tolerance = 1e-8;
  options.iterations = 200;
  check_ok(context, bw_solid_statics(context, b.solid, load_case, NULL, &options, &result));
  for (int k = 0; k < 4; k++)
    for (int d = 0; d < 3; d++) {
      int32_t node = node_near(b.grid, length, 2 * side * (k & 1), side * (k >> 1));
      tip[d] += result->displacement[3 * (int64_t)node + d] / 4 / length;
    }
  double w = fabs(tip[2]), u = -tip[0];
  printf(
      "VERIFY | column that buckled by itself, 160 hex8, P = 1.152 P Euler | w / L | %.4f | %.4f "
      "| 1.5 %% | elastica\n",
      1 / first, w);
  printf("VERIFY | the same | u / L | %.4f | %.4f | 3 %% | elastica\n", 2 - 2 * second / first, u);
  check_near(tip[1], 0, 1e-6);
  check_near(w * first, 1, 0.015);
  check_near(u / (2 - 2 * second / first), 1, 0.03);
  bw_release(result);
  bw_release(load_case);
  body_release(&b);
}

check_main(check_test(test_column), check_test(test_elastica), check_test(test_buckled))
