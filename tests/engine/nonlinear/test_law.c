/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* Laws at a point: derivatives against differences, frame indifference, projection against a
 * general 9x9 eigensolver, closed forms, small strains. */
#include "check.h"
#include "nonlinear/law.h"

static const double mu = 0.4, lambda = 0.6;

static void multiply(const double a[9], const double b[9], double c[9]) {
  for (int i = 0; i < 3; i++)
    for (int j = 0; j < 3; j++) {
      double sum = 0;
      for (int k = 0; k < 3; k++)
        sum += a[3 * i + k] * b[3 * k + j];
      c[3 * i + j] = sum;
    }
}

static void rotation(bw_random *random, double r[9]) {
  double q[4], norm = 0;
  for (int i = 0; i < 4; i++) {
    q[i] = bw_random_normal(random);
    norm += q[i] * q[i];
  }
  for (int i = 0; i < 4; i++)
    q[i] /= sqrt(norm);
  double w = q[0], x = q[1], y = q[2], z = q[3];
  double m[9] = {1 - 2 * (y * y + z * z), 2 * (x * y - w * z),     2 * (x * z + w * y),
                 2 * (x * y + w * z),     1 - 2 * (x * x + z * z), 2 * (y * z - w * x),
                 2 * (x * z - w * y),     2 * (y * z + w * x),     1 - 2 * (x * x + y * y)};
  memcpy(r, m, sizeof m);
}

/* U diag(s) V^T with random rotations. */
static void with_stretches(bw_random *random, double a, double b, double c, double f[9]) {
  double u[9], v[9], s[9] = {a, 0, 0, 0, b, 0, 0, 0, c}, t[9];
  rotation(random, u);
  rotation(random, v);
  multiply(u, s, t);
  multiply(t, v, f);
}

/* Deformations of every sort; the last ones turn inside out. `count` of them with J > 0. */
enum { SHAPES = 14, UPRIGHT = 10 };
static void shape(int number, double f[9]) {
  static const double s[SHAPES][3] = {
      {1, 1, 1},      {1.1, 0.9, 1.05}, {2, 2, 0.5},    {0.7, 0.7, 0.7},  {3, 1, 0.2},
      {1.5, 1e-3, 1}, {0.4, 0.3, 0.2},  {5, 4, 3},      {1.000001, 1, 1}, {1e-2, 1e-2, 2},
      {1, 1, -0.3},   {0.9, 0.5, -0.4}, {2, 1.5, -1.2}, {0.3, 0.2, -0.1}};
  bw_random random;
  bw_random_seed(&random, 7 + (uint64_t)number);
  with_stretches(&random, s[number][0], s[number][1], s[number][2], f);
  if (number == 0) {
    memset(f, 0, 9 * sizeof *f);
    f[0] = f[4] = f[8] = 1;
  }
}

static double size_of(const double *x, int count) {
  double sum = 0;
  for (int i = 0; i < count; i++)
    sum += x[i] * x[i];
  return sqrt(sum);
}

/* Eigenvalues of a symmetric 9x9 by Jacobi's rotations, vectors in columns: slow and general. */
static void eigen9(const double a[81], double value[9], double vector[81]) {
  double m[81];
  memcpy(m, a, sizeof m);
  for (int i = 0; i < 81; i++)
    vector[i] = i % 10 == 0;
  for (int sweep = 0; sweep < 60; sweep++)
    for (int p = 0; p < 9; p++)
      for (int q = p + 1; q < 9; q++) {
        if (fabs(m[9 * p + q]) < 1e-300)
          continue;
        double angle = 0.5 * atan2(2 * m[9 * p + q], m[10 * q] - m[10 * p]);
        double c = cos(angle), s = sin(angle);
        for (int i = 0; i < 9; i++) {
          double x = m[9 * i + p], y = m[9 * i + q];
          m[9 * i + p] = c * x - s * y;
          m[9 * i + q] = s * x + c * y;
          x = vector[9 * i + p], y = vector[9 * i + q];
          vector[9 * i + p] = c * x - s * y;
          vector[9 * i + q] = s * x + c * y;
        }
        for (int i = 0; i < 9; i++) {
          double x = m[9 * p + i], y = m[9 * q + i];
          m[9 * p + i] = c * x - s * y;
          m[9 * q + i] = s * x + c * y;
        }
      }
  for (int i = 0; i < 9; i++)
    value[i] = m[10 * i];
}

static void test_singular_values(void **state) {
  (void)state;
  static const double rank[5][9] = {{0},
                                    {1, 2, 3, 2, 4, 6, -1, -2, -3},
                                    {0, 0, 0, 0, 0, 0, 0, 0, -2},
                                    {1, 0, 0, 0, 1, 0, 0, 0, 0},
                                    {-1, 0, 0, 0, -1, 0, 0, 0, -1}};
  for (int n = 0; n < SHAPES + 5 + 200; n++) {
    double f[9], u[9], s[3], v[9], sv[9], back[9], cross[3];
    if (n < SHAPES)
      shape(n, f);
    else if (n < SHAPES + 5)
      memcpy(f, rank[n - SHAPES], sizeof f);
    else {
      bw_random random;
      bw_random_seed(&random, (uint64_t)n);
      for (int i = 0; i < 9; i++)
        f[i] = bw_random_normal(&random) * (n % 3 ? 1 : 1e-6);
    }
    bw_svd3(f, u, s, v);
    for (int i = 0; i < 3; i++)
      for (int j = 0; j < 3; j++)
        sv[3 * i + j] = s[i] * v[3 * j + i];
    multiply(u, sv, back);
    for (int i = 0; i < 9; i++)
      check_near(back[i], f[i], 4e-15 * size_of(f, 9));
    for (int side = 0; side < 2; side++) {
      const double *m = side ? v : u;
      double column[3][3];
      for (int i = 0; i < 9; i++)
        column[i % 3][i / 3] = m[i];
      bw_cross(column[0], column[1], cross);
      check_near(bw_dot(cross, column[2]), 1, 4e-15);
      for (int i = 0; i < 3; i++)
        for (int j = 0; j <= i; j++)
          check_near(bw_dot(column[i], column[j]), i == j, 4e-15);
    }
    assert_true(s[0] >= s[1] && s[1] >= fabs(s[2]) * (1 - 1e-15));
  }
}

/* Gradient and tangent against central differences, everywhere that a law is smooth. */
static void test_derivatives(void **state) {
  (void)state;
  for (int law = 0; law < BW_LAWS; law++)
    for (int n = 0; n < (law == BW_NEO_HOOKEAN ? UPRIGHT : SHAPES); n++) {
      double f[9], stress[9], tangent[81], energy, s[3], u[9], v[9];
      shape(n, f);
      bw_svd3(f, u, s, v);
      assert_true(bw_law_evaluate((bw_law)law, mu, lambda, f, false, &energy, stress, tangent));
      double step = 1e-6 * fabs(s[2]), scale = size_of(tangent, 81);
      double rounding = 1e-14 * (fabs(energy) + size_of(stress, 9) * size_of(f, 9));
      for (int k = 0; k < 9; k++) {
        double moved[9], up, down, stress_up[9], stress_down[9];
        memcpy(moved, f, sizeof f);
        moved[k] = f[k] + step;
        assert_true(bw_law_evaluate((bw_law)law, mu, lambda, moved, false, &up, stress_up, NULL));
        moved[k] = f[k] - step;
        assert_true(
            bw_law_evaluate((bw_law)law, mu, lambda, moved, false, &down, stress_down, NULL));
        check_near((up - down) / (2 * step), stress[k],
                   1e-7 * size_of(stress, 9) + 1e-10 * scale + rounding / step);
        for (int i = 0; i < 9; i++)
          check_near((stress_up[i] - stress_down[i]) / (2 * step), tangent[9 * i + k],
                     3e-6 * scale);
      }
      for (int i = 0; i < 9; i++)
        for (int k = 0; k < i; k++)
          assert_true(tangent[9 * i + k] == tangent[9 * k + i]);
    }
}

/* W(Q F) = W(F) = W(F Q), P(Q F) = Q P(F). */
static void test_objectivity(void **state) {
  (void)state;
  bw_random random;
  bw_random_seed(&random, 3);
  for (int law = 0; law < BW_LAWS; law++)
    for (int n = 0; n < (law == BW_NEO_HOOKEAN ? UPRIGHT : SHAPES); n++) {
      double f[9], q[9], turned[9], other[9], p[9], p_turned[9], expected[9], w, w2, w3;
      shape(n, f);
      rotation(&random, q);
      multiply(q, f, turned);
      multiply(f, q, other);
      assert_true(bw_law_evaluate((bw_law)law, mu, lambda, f, false, &w, p, NULL));
      assert_true(bw_law_evaluate((bw_law)law, mu, lambda, turned, false, &w2, p_turned, NULL));
      assert_true(bw_law_evaluate((bw_law)law, mu, lambda, other, false, &w3, NULL, NULL));
      double rounding = 5e-14 * (fabs(w) + size_of(p, 9) * size_of(f, 9) + 1);
      check_near(w2, w, rounding);
      check_near(w3, w, rounding);
      multiply(q, p, expected);
      for (int i = 0; i < 9; i++)
        check_near(p_turned[i], expected[i], 1e-11 * size_of(p, 9) + 1e-14);
    }
  double r[9], energy, stress[9];
  rotation(&random, r);
  for (int law = 0; law < BW_LAWS; law++) { /* no energy in a rotation */
    assert_true(bw_law_evaluate((bw_law)law, mu, lambda, r, false, &energy, stress, NULL));
    check_near(energy, 0, 1e-15);
    check_near(size_of(stress, 9), 0, 1e-14);
  }
}

/* The projected tangent is what a general eigensolver makes of the tangent; a tangent without
 * negative eigenvalues stays. */
static void test_projection(void **state) {
  (void)state;
  int indefinite = 0, sound = 0;
  for (int law = 0; law < BW_LAWS; law++)
    for (int n = 0; n < (law == BW_NEO_HOOKEAN ? UPRIGHT : SHAPES); n++) {
      double f[9], energy, stress[9], plain[81], projected[81], value[9], vector[81];
      shape(n, f);
      bw_law_evaluate((bw_law)law, mu, lambda, f, false, &energy, stress, plain);
      bw_law_evaluate((bw_law)law, mu, lambda, f, true, &energy, stress, projected);
      eigen9(plain, value, vector);
      double scale = size_of(plain, 81), min = value[0];
      for (int i = 1; i < 9; i++)
        min = fmin(min, value[i]);
      indefinite += min < -1e-9 * scale;
      sound += min > 1e-9 * scale;
      for (int i = 0; i < 9; i++)
        for (int k = 0; k < 9; k++) {
          double expected = 0;
          for (int m = 0; m < 9; m++)
            expected += fmax(value[m], 0) * vector[9 * i + m] * vector[9 * k + m];
          check_near(projected[9 * i + k], expected, 1e-11 * scale);
        }
    }
  assert_true(indefinite > 10 && sound > 5);
}

/* All laws have the linear elasticity of Lame's constants at rest. */
static void test_linear(void **state) {
  (void)state;
  double f[9] = {1, 0, 0, 0, 1, 0, 0, 0, 1}, energy, stress[9], a[81];
  for (int law = 0; law < BW_LAWS; law++) {
    assert_true(bw_law_evaluate((bw_law)law, mu, lambda, f, false, &energy, stress, a));
    for (int m = 0; m < 9; m++)
      for (int n = 0; n < 9; n++) {
        int i = m / 3, j = m % 3, k = n / 3, l = n % 3;
        check_near(a[9 * m + n],
                   mu * ((i == k && j == l) + (i == l && j == k)) + lambda * (i == j && k == l),
                   1e-15);
      }
  }
}

/* Strains of 1e-9: the energy keeps its digits where it is written in F - 1. In the lanes that is
 * given as it is; h is symmetric up to second order. */
static void test_small_strains(void **state) {
  (void)state;
  for (int law = 0; law < 2; law++) {
    bwi_lanes h[9], c[2] = {BWI_ALL(mu), BWI_ALL(lambda)};
    static const double e[9] = {1e-9, 2e-9, 0, -1e-9, 3e-9, 1e-9, 5e-10, 0, -2e-9};
    double square = 0, trace = e[0] + e[4] + e[8];
    for (int i = 0; i < 9; i++) {
      double symmetric = 0.5 * (e[i] + e[3 * (i % 3) + i / 3]);
      h[i] = BWI_ALL(e[i]);
      square += symmetric * symmetric;
    }
    bwi_response out;
    bwi_law((bw_law)law, &c[0], &c[1], h, BWI_STRESS, false, &out);
    double expected = mu * square + 0.5 * lambda * trace * trace;
    check_near(out.energy[0], expected, 1e-8 * expected);
    for (int i = 0; i < 9; i++)
      check_near(out.stress[i][3],
                 mu * (e[i] + e[3 * (i % 3) + i / 3]) + (i % 4 == 0 ? lambda * trace : 0), 1e-16);
  }
}

/* The logarithm inside, through W = lambda (ln J)^2 / 2, at J from 1e-5, below which F - 1 has
 * lost digits of F, to 1e27. */
static void test_logarithm(void **state) {
  (void)state;
  for (int n = -300; n <= 300; n++) {
    double j = pow(1.7, n / 2.5) * (1 + 1e-3 * n), f[9] = {j, 0, 0, 0, 1, 0, 0, 0, 1}, energy;
    if (!(j > 1e-5))
      continue;
    assert_true(bw_law_evaluate(BW_NEO_HOOKEAN, 0, 2, f, false, &energy, NULL, NULL));
    check_near(sqrt(energy), fabs(log(j)), 1e-15 * fabs(log(j)) + 1e-16 / j);
  }
}

/* The law exists for det F > 0 only; nothing that is fed in does harm. */
static void test_domain(void **state) {
  (void)state;
  double energy, stress[9], tangent[81];
  for (int n = UPRIGHT; n < SHAPES; n++) {
    double f[9];
    shape(n, f);
    assert_false(bw_law_evaluate(BW_NEO_HOOKEAN, mu, lambda, f, true, &energy, stress, tangent));
  }
  double odd[4][9] = {{0}, {NAN, 0, 0, 0, 1, 0, 0, 0, 1}, {INFINITY, 0, 0, 0, 1, 0, 0, 0, 1}, {0}};
  for (int i = 0; i < 9; i++)
    odd[3][i] = 1e200 * (i + 1);
  for (int n = 0; n < 4; n++) {
    assert_false(
        bw_law_evaluate(BW_NEO_HOOKEAN, mu, lambda, odd[n], true, &energy, stress, tangent));
    for (int law = 1; law < BW_LAWS; law++)
      bw_law_evaluate((bw_law)law, mu, lambda, odd[n], true, &energy, stress, tangent);
  }
  double flat[9] = {1, 0, 0, 0, 1, 0, 0, 0, 0};
  for (int law = 1; law < BW_LAWS; law++) {
    assert_true(bw_law_evaluate((bw_law)law, mu, lambda, flat, true, &energy, stress, tangent));
    assert_true(isfinite(energy) && isfinite(size_of(stress, 9)) && isfinite(size_of(tangent, 81)));
  }
}

/* Stretch along x with free sides: the lateral stretch by bisection. Values of P / E. */
static double free_sides(bw_law law, double poisson, double stretch) {
  double m = 1 / (2 * (1 + poisson)), l = poisson / ((1 + poisson) * (1 - 2 * poisson));
  double low = 0.2, high = 2.5, stress[9], energy;
  for (int i = 0; i < 200; i++) {
    double side = 0.5 * (low + high), f[9] = {stretch, 0, 0, 0, side, 0, 0, 0, side};
    assert_true(bw_law_evaluate(law, m, l, f, false, &energy, stress, NULL));
    *(stress[4] > 0 ? &high : &low) = side;
  }
  return stress[0];
}

static void test_closed_forms(void **state) {
  (void)state;
  /* neo-Hookean, E = 1: the exact roots of the lateral equation */
  static const double uniaxial[][3] = {
      {0.3, 0.5, -0.9353520568881573},  {0.3, 0.7, -0.4052304243142689},
      {0.3, 1.1, 0.09307743218408615},  {0.3, 2.0, 0.646744660173608},
      {0.3, 3.0, 1.093141437317265},    {0.45, 0.5, -1.0861028086215598},
      {0.45, 1.5, 0.35861435192004726}, {0.45, 3.0, 0.9933355757150086},
  };
  for (size_t i = 0; i < sizeof uniaxial / sizeof *uniaxial; i++)
    check_near(free_sides(BW_NEO_HOOKEAN, uniaxial[i][0], uniaxial[i][1]), uniaxial[i][2], 1e-9);
  /* St. Venant-Kirchhoff: P = E l (l^2 - 1) / 2 */
  for (double l = 0.6; l < 2.1; l += 0.1)
    check_near(free_sides(BW_ST_VENANT_KIRCHHOFF, 0.3, l), l * (l * l - 1) / 2, 1e-9);
  /* corotated: linear elasticity in the stretches, P = E (l - 1) */
  for (double l = 0.6; l < 2.1; l += 0.1)
    check_near(free_sides(BW_COROTATED, 0.3, l), l - 1, 1e-9);
  /* neo-Hookean, simple shear: sigma_12 = mu gamma, sigma_11 = mu gamma^2, the others 0 */
  for (double gamma = 0.1; gamma < 1.05; gamma += 0.1) {
    double f[9] = {1, gamma, 0, 0, 1, 0, 0, 0, 1}, stress[9], sigma[9], energy, t[9];
    for (int i = 0; i < 9; i++)
      t[i] = f[3 * (i % 3) + i / 3];
    assert_true(bw_law_evaluate(BW_NEO_HOOKEAN, mu, lambda, f, false, &energy, stress, NULL));
    multiply(stress, t, sigma);
    const double expected[9] = {mu * gamma * gamma, mu * gamma, 0, mu * gamma, 0, 0, 0, 0, 0};
    for (int i = 0; i < 9; i++)
      check_near(sigma[i], expected[i], 1e-15);
  }
}

static void test_fibre(void **state) {
  (void)state;
  bw_random random;
  bw_random_seed(&random, 11);
  for (int n = 0; n < SHAPES; n++) {
    double f[9], v[3], w[3], c = 0.7, energy = 0, stress[9] = {0}, tangent[81] = {0};
    double projected[81] = {0}, value[9], vector[81];
    shape(n, f);
    for (int i = 0; i < 3; i++)
      v[i] = bw_random_normal(&random);
    double norm = bw_norm(v);
    for (int i = 0; i < 3; i++)
      v[i] /= norm;
    for (int i = 0; i < 3; i++)
      w[i] = bw_dot(f + 3 * (size_t)i, v);
    bw_fibre_add(c, v, f, false, &energy, stress, tangent);
    check_near(energy, c * (bw_norm(w) - 1) * (bw_norm(w) - 1), 1e-15 * (1 + energy));
    double step = 1e-6, scale = size_of(tangent, 81);
    for (int k = 0; k < 9; k++) {
      double moved[9], up = 0, down = 0, more[9] = {0}, less[9] = {0};
      memcpy(moved, f, sizeof f);
      moved[k] = f[k] + step;
      bw_fibre_add(c, v, moved, false, &up, more, NULL);
      moved[k] = f[k] - step;
      bw_fibre_add(c, v, moved, false, &down, less, NULL);
      check_near((up - down) / (2 * step), stress[k], 1e-8);
      for (int i = 0; i < 9; i++)
        check_near((more[i] - less[i]) / (2 * step), tangent[9 * i + k], 1e-6 * (1 + scale));
    }
    energy = 0;
    bw_fibre_add(c, v, f, true, &energy, NULL, projected);
    eigen9(tangent, value, vector);
    for (int i = 0; i < 9; i++)
      for (int k = 0; k < 9; k++) {
        double expected = 0;
        for (int m = 0; m < 9; m++)
          expected += fmax(value[m], 0) * vector[9 * i + m] * vector[9 * k + m];
        check_near(projected[9 * i + k], expected, 1e-12 * (1 + scale));
      }
  }
}

/* A point's numbers do not depend on its company in the other lanes. */
static void test_company(void **state) {
  (void)state;
  for (int law = 0; law < BW_LAWS; law++)
    for (int project = 0; project < 2; project++) {
      bwi_lanes h[9], c[2] = {BWI_ALL(mu), BWI_ALL(lambda)};
      bwi_response together;
      for (int lane = 0; lane < BWI_LANES; lane++) {
        double f[9];
        shape(lane == 3 ? 12 : lane, f);
        for (int i = 0; i < 9; i++)
          h[i][lane] = i % 4 == 0 ? f[i] - 1 : f[i];
      }
      bwi_law((bw_law)law, &c[0], &c[1], h, BWI_TANGENT, project, &together);
      for (int lane = 0; lane < BWI_LANES; lane++) {
        double f[9], energy, stress[9], tangent[81];
        shape(lane == 3 ? 12 : lane, f);
        bool defined =
            bw_law_evaluate((bw_law)law, mu, lambda, f, project, &energy, stress, tangent);
        assert_true(defined == (together.defined[lane] != 0));
        if (!defined)
          continue;
        assert_true(energy == together.energy[lane]);
        for (int i = 0; i < 9; i++)
          assert_true(stress[i] == together.stress[i][lane]);
        for (int i = 0; i < 81; i++)
          assert_true(tangent[i] == together.tangent[i][lane]);
      }
    }
}

check_main(check_test(test_singular_values), check_test(test_derivatives),
           check_test(test_objectivity), check_test(test_projection), check_test(test_linear),
           check_test(test_small_strains), check_test(test_logarithm), check_test(test_domain),
           check_test(test_closed_forms), check_test(test_fibre), check_test(test_company))
