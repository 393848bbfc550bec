/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* hex8 at finite strain. Patch test: where the boundary is displaced by any affine map, everything
 * is exact. Manufactured solution: a smooth displacement is chosen, the body force that it needs
 * follows from the law, and the error must fall with the power of the cell size that theory
 * gives: 2 in L2, 1 in the gradient. */
#include "nonlinear/whole.h"

static bool on_boundary(const bw_grid *grid, int32_t node) {
  double x[3], low[3], high[3];
  bw_grid_position(grid, node, x);
  bw_grid_box(grid, low, high);
  for (int d = 0; d < 3; d++)
    if (x[d] < low[d] + 1e-9 || x[d] > high[d] - 1e-9)
      return true;
  return false;
}

static void hold_at(bw_context *context, bw_load_case *load_case, int32_t node, const double u[3]) {
  const bool fixed[3] = {true, true, true};
  check_ok(context, bw_load_case_fix(context, load_case, 1, &node, fixed, u));
}

static void test_patch(void **state) {
  bw_context *context = check_context(state);
  const double f[9] = {1.25, 0.3, -0.1, 0.15, 0.85, 0.2, -0.2, 0.1, 1.1};
  const double size[3] = {1, 0.7, 0.5};
  double volume = size[0] * size[1] * size[2];
  for (int kind = 0; kind < 2 * BW_LAWS; kind++) {
    int law = kind % BW_LAWS;
    bool b_bar = kind >= BW_LAWS;
    body b = body_box(context, 4, 3, 3, size[0], size[1], size[2], (bw_law)law, 1e6, 0.3, 0);
    if (b_bar)
      body_take_b_bar(context, &b, (bw_law)law, 1e6, 0.3);
    bw_load_case *load_case;
    check_ok(context, bw_load_case_create(context, b.grid, &load_case));
    double mu = 1e6 / 2.6, lambda = 0.3e6 / (1.3 * 0.4), energy, p[9], u[3], x[3];
    for (int32_t i = 0; i < b.nodes; i++) {
      bw_grid_position(b.grid, i, x);
      for (int c = 0; c < 3; c++)
        u[c] = bw_dot(f + 3 * (size_t)c, x) - x[c];
      if (on_boundary(b.grid, i))
        hold_at(context, load_case, i, u);
    }
    bw_solid_static *result = solve(context, &b, load_case, 1);
    double worst = 0;
    for (int32_t i = 0; i < b.nodes; i++) {
      bw_grid_position(b.grid, i, x);
      for (int c = 0; c < 3; c++)
        worst = fmax(worst,
                     fabs(result->displacement[3 * i + c] - (bw_dot(f + 3 * (size_t)c, x) - x[c])));
    }
    assert_true(bw_law_evaluate((bw_law)law, mu, lambda, f, false, &energy, p, NULL));
    printf("VERIFY | patch test of hex8%s, %s | largest deviation (m) | 0 | %.1e | 1e-9 | exact\n",
           b_bar ? " with B-bar" : "", bw_law_word((bw_law)law), worst);
    check_near(worst, 0, 1e-9);
    check_near(result->energy, volume * energy, 1e-8 * volume * energy);
    /* what holds the max x side is the stress times its area; edges belong to two sides, so the
       whole is looked at: sum of x_i r_j over the boundary is V P_ji */
    double moment[9] = {0};
    for (int32_t i = 0; i < b.nodes; i++) {
      bw_grid_position(b.grid, i, x);
      for (int k = 0; k < 9; k++)
        moment[k] += result->reaction[3 * i + k / 3] * x[k % 3];
    }
    for (int k = 0; k < 9; k++)
      check_near(moment[k], volume * p[k], 1e-8 * volume * 1e6);
    bw_release(result);
    bw_release(load_case);
    body_release(&b);
  }
}

/* u_i = A_i sin(k_i . x + phase_i) */
static const double amplitude[3] = {0.12, 0.09, -0.07};
static const double wave[3][3] = {{1.1, 1.6, -0.4}, {-1.5, 1.3, 0.7}, {0.8, -1.3, 1.2}};
static const double phase[3] = {0.3, 1.1, -0.5};

static void exact(const double x[3], double u[3], double f[9]) {
  for (int i = 0; i < 3; i++) {
    double t = bw_dot(wave[i], x) + phase[i];
    u[i] = amplitude[i] * sin(t);
    for (int j = 0; j < 3; j++)
      f[3 * i + j] = (i == j) + amplitude[i] * wave[i][j] * cos(t);
  }
}

/* b_i = -dP_ij / dX_j = -A_(ij)(kl) d_l d_j u_k */
static void body_force(bw_law law, double mu, double lambda, const double x[3], double b[3]) {
  double u[3], f[9], energy, stress[9], tangent[81];
  exact(x, u, f);
  assert_true(bw_law_evaluate(law, mu, lambda, f, false, &energy, stress, tangent));
  for (int i = 0; i < 3; i++) {
    b[i] = 0;
    for (int k = 0; k < 3; k++) {
      double second = -amplitude[k] * sin(bw_dot(wave[k], x) + phase[k]);
      for (int j = 0; j < 3; j++)
        for (int l = 0; l < 3; l++)
          b[i] -= tangent[9 * (3 * i + j) + 3 * k + l] * second * wave[k][j] * wave[k][l];
    }
  }
}

static const double gauss[3] = {0.1127016653792583, 0.5, 0.8872983346207417};
static const double gauss_weight[3] = {5.0 / 18, 8.0 / 18, 5.0 / 18};

/* Values of the corner functions at a point of the unit cube, and their gradients. */
static void shape_at(const double at[3], double value[8], double gradient[24]) {
  for (int c = 0; c < 8; c++) {
    double factor[3], slope[3];
    for (int d = 0; d < 3; d++) {
      factor[d] = c >> d & 1 ? at[d] : 1 - at[d];
      slope[d] = c >> d & 1 ? 1 : -1;
    }
    value[c] = factor[0] * factor[1] * factor[2];
    for (int d = 0; d < 3; d++)
      gradient[3 * c + d] = slope[d] * factor[(d + 1) % 3] * factor[(d + 2) % 3];
  }
}

/* Runs over 3 x 3 x 3 points of every element: adds the forces of the body force (result NULL), or
 * the squares of the errors. */
static void integrate(const bw_grid *grid, bw_law law, double *force, const bw_solid_static *result,
                      double *l2, double *h1) {
  double volume = grid->spacing[0] * grid->spacing[1] * grid->spacing[2];
  for (int32_t e = 0; e < grid->element_count; e++)
    for (int q = 0; q < 27; q++) {
      const int place[3] = {q % 3, q / 3 % 3, q / 9};
      const double at[3] = {gauss[place[0]], gauss[place[1]], gauss[place[2]]};
      double weight =
          volume * gauss_weight[place[0]] * gauss_weight[place[1]] * gauss_weight[place[2]];
      const int32_t *corner = grid->element + 8 * (int64_t)e;
      double value[8], gradient[24], x[3], b[3], u[3], f[9];
      shape_at(at, value, gradient);
      bw_grid_position(grid, corner[0], x);
      for (int d = 0; d < 3; d++)
        x[d] += at[d] * grid->spacing[d];
      if (!result) {
        body_force(law, 1e6 / 2.6, 0.3e6 / (1.3 * 0.4), x, b);
        for (int c = 0; c < 8; c++)
          for (int d = 0; d < 3; d++)
            force[3 * (int64_t)corner[c] + d] += weight * value[c] * b[d];
        continue;
      }
      exact(x, u, f);
      for (int i = 0; i < 3; i++) {
        double off = -u[i], slope[3];
        for (int j = 0; j < 3; j++)
          slope[j] = (i == j) - f[3 * i + j];
        for (int c = 0; c < 8; c++) {
          double of_corner = result->displacement[3 * (int64_t)corner[c] + i];
          off += value[c] * of_corner;
          for (int j = 0; j < 3; j++)
            slope[j] += gradient[3 * c + j] / grid->spacing[j] * of_corner;
        }
        *l2 += weight * off * off;
        *h1 += weight * bw_dot(slope, slope);
      }
    }
}

static void errors(bw_context *context, bw_law law, int cells, double *l2, double *h1) {
  body b = body_box(context, cells, cells, cells, 1, 1, 1, law, 1e6, 0.3, 0);
  bw_load_case *load_case;
  check_ok(context, bw_load_case_create(context, b.grid, &load_case));
  for (int32_t i = 0; i < b.nodes; i++) {
    double x[3], u[3], f[9];
    bw_grid_position(b.grid, i, x);
    exact(x, u, f);
    if (on_boundary(b.grid, i))
      hold_at(context, load_case, i, u);
  }
  integrate(b.grid, law, load_case->force, NULL, NULL, NULL);
  bw_solid_static *result = solve(context, &b, load_case, 1);
  *l2 = *h1 = 0;
  integrate(b.grid, law, NULL, result, l2, h1);
  *l2 = sqrt(*l2);
  *h1 = sqrt(*h1);
  bw_release(result);
  bw_release(load_case);
  body_release(&b);
}

static void test_manufactured(void **state) {
  bw_context *context = check_context(state);
  for (int law = 0; law < BW_LAWS; law++) {
    double l2[3], h1[3];
    for (int r = 1; r < 3; r++)
      errors(context, (bw_law)law, 3 << r, &l2[r], &h1[r]);
    double l2_order = log2(l2[1] / l2[2]), h1_order = log2(h1[1] / h1[2]);
    printf("VERIFY | manufactured solution, hex8, %s | order in L2 | 2 | %.2f | 0.15 | theory\n",
           bw_law_word((bw_law)law), l2_order);
    printf("VERIFY | manufactured solution, hex8, %s | order in the gradient | 1 | %.2f | 0.15 | "
           "theory\n",
           bw_law_word((bw_law)law), h1_order);
    check_near(l2_order, 2, 0.15);
    check_near(h1_order, 1, 0.15);
  }
}

check_main(check_test(test_patch), check_test(test_manufactured))
