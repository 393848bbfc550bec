/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* Motion of solids against closed forms: free fall, one mode with and without damping, momentum,
 * angular momentum, energy, order in the step; and what must hold of any step. */
#include <complex.h>

#include "nonlinear/whole.h"
#include "solver_by.h"

#define PI 3.14159265358979323846

static bw_transient_options options_of(bw_transient_scheme scheme, double step) {
  bw_transient_options options;
  bw_transient_options_default(&options);
  options.scheme = scheme;
  options.step = step;
  options.tolerance = 1e-13;
  return options;
}

static bw_load_case *case_of(bw_context *context, const body *b) {
  bw_load_case *load_case;
  check_ok(context, bw_load_case_create(context, b->grid, &load_case));
  return load_case;
}

static bw_solid_transient *motion_of(bw_context *context, const body *b,
                                     const bw_load_case *load_case,
                                     const bw_transient_options *options, const double *u,
                                     const double *v) {
  bw_solid_transient *motion;
  check_ok(context,
           bw_solid_transient_create(context, b->solid, load_case, options, u, v, &motion));
  return motion;
}

static void steps(bw_context *context, bw_solid_transient *motion, int count) {
  for (int k = 0; k < count; k++)
    check_ok(context, bw_solid_transient_step(context, motion));
}

static double sum_of(const bw_solid_transient *m) {
  return m->kinetic + m->strain + m->potential + m->dissipated;
}

/* Sum of m v, and of x cross m v. */
static void momenta(const bw_solid_transient *m, double linear[3], double angular[3]) {
  memset(linear, 0, 3 * sizeof *linear);
  memset(angular, 0, 3 * sizeof *angular);
  for (int32_t i = 0; i < m->solid->grid->node_count; i++) {
    double x[3], p[3], l[3];
    bw_grid_position(m->solid->grid, i, x);
    for (int c = 0; c < 3; c++) {
      x[c] += m->displacement[3 * i + c];
      p[c] = m->solid->mass[i] * m->velocity[3 * i + c];
      linear[c] += p[c];
    }
    bw_cross(x, p, l);
    for (int c = 0; c < 3; c++)
      angular[c] += l[c];
  }
}

/* A free body under gravity with a velocity of its own: Newmark is on the parabola, implicit Euler
 * on h^2 n (n + 1) / 2 in place of t^2 / 2. */
static void test_free_fall(void **state) {
  bw_context *context = check_context(state);
  body b = body_box(context, 2, 1, 1, 2, 1, 1, BW_NEO_HOOKEAN, 1e5, 0.3, 1000);
  bw_load_case *load_case = case_of(context, &b);
  load_case->gravity[2] = -9.81;
  double *v = BW_NEW(context, double, 3 * b.nodes);
  for (int32_t i = 0; i < b.nodes; i++)
    v[3 * i] = 2, v[3 * i + 1] = 0, v[3 * i + 2] = 3;
  for (int scheme = 0; scheme < 2; scheme++) {
    double h = 0.01, n = 50, t = n * h;
    bw_transient_options options = options_of((bw_transient_scheme)scheme, h);
    bw_solid_transient *m = motion_of(context, &b, load_case, &options, NULL, v);
    double first = sum_of(m);
    check_near(m->kinetic, 0.5 * 2000 * 13, 1e-8);
    steps(context, m, (int)n);
    assert_int_equal(m->steps, n);
    check_near(m->time, t, 1e-12);
    double half = scheme == BW_NEWMARK ? t * t / 2 : h * h * n * (n + 1) / 2;
    for (int32_t i = 0; i < b.nodes; i++) {
      check_near(m->displacement[3 * i], 2 * t, 1e-10);
      check_near(m->displacement[3 * i + 1], 0, 1e-10);
      check_near(m->displacement[3 * i + 2], 3 * t - 9.81 * half, 1e-10);
      check_near(m->velocity[3 * i + 2], 3 - 9.81 * t, 1e-9);
      check_near(m->acceleration[3 * i + 2], -9.81, 1e-7);
    }
    check_near(m->strain, 0, 1e-9);
    check_near(m->potential, 2000 * 9.81 * (3 * t - 9.81 * half), 1e-6);
    check_near(sum_of(m), first, 1e-6);
    if (scheme == BW_NEWMARK)
      check_near(m->dissipated, 0, 1e-6);
    else
      check_near(m->dissipated, 2000 * 9.81 * 9.81 * h * h * n / 2, 1e-6);
    bw_release(m);
  }
  bw_free(v);
  bw_release(load_case);
  body_release(&b);
}

/* Memory that was in use before does not show: blocks of all sizes are filled with large numbers
 * and given back before every step. */
static void test_used_memory(void **state) {
  bw_context *context = check_context(state);
  body b = body_box(context, 2, 2, 4, 0.1, 0.1, 0.2, BW_NEO_HOOKEAN, 1e6, 0.3, 1000);
  bw_load_case *load_case = case_of(context, &b);
  hold_side(context, load_case, 2, 0, 7, 0, 0, 0);
  double *v = BW_NEW0(context, double, 3 * b.nodes);
  for (int32_t i = 9; i < b.nodes; i++)
    v[3 * i + 2] = 1;
  bw_transient_options options = options_of(BW_IMPLICIT_EULER, 0.01);
  double last[2];
  for (int used = 0; used < 2; used++) {
    bw_solid_transient *m = motion_of(context, &b, load_case, &options, NULL, v);
    for (int k = 0; k < 2; k++) {
      double *block[64];
      for (int j = 0; used && j < 64; j++) {
        size_t count = (size_t)(j / 2 + 1) * (size_t)b.nodes;
        block[j] = BW_NEW(context, double, count);
        for (size_t i = 0; i < count; i++)
          block[j][i] = 1e200;
      }
      for (int j = 0; used && j < 64; j++)
        bw_free(block[j]);
      steps(context, m, 1);
    }
    assert_true(m->strain > 1e-3 && m->newton.iterations > 0);
    last[used] = m->strain;
    bw_release(m);
  }
  assert_true(last[0] == last[1]);
  bw_free(v);
  bw_release(load_case);
  body_release(&b);
}

/* One element column of the corotated law without Poisson's effect, constrained at its foot and
 * pulled along its axis: P = E (s - 1), a linear spring at any amplitude, k = E A / L, with half of
 * the mass at the top. One step multiplies the mode's amplitude by (1 + z/2) / (1 - z/2), or by
 * 1 / (1 - z), z = h lambda, lambda^2 + (am + ak w^2) lambda + w^2 = 0. */
static void spring(bw_context *context, bw_transient_scheme scheme, double am, double ak,
                   double h) {
  double young = 3e4, density = 500, length = 0.5, start = 0.2;
  body b = body_box(context, 1, 1, 1, 0.3, 0.2, length, BW_COROTATED, young, 0, density);
  bw_load_case *load_case = case_of(context, &b);
  hold_side(context, load_case, 2, 0, 7, 0, 0, 0);
  double *u = BW_NEW0(context, double, 3 * b.nodes);
  for (int32_t i = 4; i < 8; i++)
    u[3 * i + 2] = start * length;
  bw_transient_options options = options_of(scheme, h);
  options.mass_damping = am;
  options.stiffness_damping = ak;
  bw_solid_transient *m = motion_of(context, &b, load_case, &options, u, NULL);
  double w2 = 2 * young / (density * length * length), damping = am + ak * w2;
  check_near(m->acceleration[3 * 5 + 2], -w2 * start * length, 1e-9 * w2);
  check_near(m->strain, 0.5 * young * start * start * 0.3 * 0.2 * length, 1e-9);
  double first = sum_of(m);
  /* x = c1 m1^n + c2 m2^n with the start at rest */
  double complex root = csqrt(damping * damping / 4 - w2), one = 1;
  double complex l1 = -damping / 2 + root, l2 = -damping / 2 - root;
  double complex f1 = scheme == BW_NEWMARK ? (one + h * l1 / 2) / (one - h * l1 / 2)
                                           : one / (one - h * l1),
                 f2 = scheme == BW_NEWMARK ? (one + h * l2 / 2) / (one - h * l2 / 2)
                                           : one / (one - h * l2);
  double complex c1 = -l2 / (l1 - l2), c2 = l1 / (l1 - l2);
  for (int k = 1; k <= 40; k++) {
    steps(context, m, 1);
    double x = creal(c1 * cpow(f1, k) + c2 * cpow(f2, k)) * start * length;
    double y = creal(l1 * c1 * cpow(f1, k) + l2 * c2 * cpow(f2, k)) * start * length;
    for (int32_t i = 4; i < 8; i++) {
      check_near(m->displacement[3 * i + 2], x, 1e-9 * start);
      check_near(m->velocity[3 * i + 2], y, 1e-9 * start * sqrt(w2));
      check_near(m->displacement[3 * i], 0, 1e-11);
    }
    check_near(sum_of(m), first, 1e-9 * first);
    if (scheme == BW_NEWMARK && damping == 0)
      check_near(m->kinetic + m->strain, first, 1e-9 * first);
  }
  bw_release(m);
  bw_free(u);
  bw_release(load_case);
  body_release(&b);
}

static void test_spring(void **state) {
  bw_context *context = check_context(state);
  for (int scheme = 0; scheme < 2; scheme++) {
    spring(context, (bw_transient_scheme)scheme, 0, 0, 0.01); /* period 0.287 s */
    spring(context, (bw_transient_scheme)scheme, 0, 0, 0.2);
    spring(context, (bw_transient_scheme)scheme, 3, 0, 0.01);
    spring(context, (bw_transient_scheme)scheme, 0, 0.01, 0.01);
    spring(context, (bw_transient_scheme)scheme, 3, 0.2, 0.01); /* more than critical */
  }
}

/* A bar constrained at one end, its free end thrown sidewise: large motions. The tip's place after
 * a given time, and the largest swing of the energy on the way. */
typedef struct swing {
  double tip[3], drift, lost;
} swing;

static swing thrown(bw_context *context, bw_law law, bw_transient_scheme scheme, int count,
                    double tolerance, int iterations) {
  body b = body_box(context, 4, 1, 1, 1, 0.25, 0.25, law, 1e5, 0.3, 1000);
  bw_load_case *load_case = case_of(context, &b);
  hold_side(context, load_case, 0, 0, 7, 0, 0, 0);
  double *v = BW_NEW0(context, double, 3 * b.nodes);
  for (int32_t i = 0; i < b.nodes; i++) {
    double x[3];
    bw_grid_position(b.grid, i, x);
    v[3 * i + 1] = 4 * x[0] * x[0];
    v[3 * i + 2] = 2 * x[0] * x[0];
  }
  bw_transient_options options = options_of(scheme, 0.1 / count);
  options.tolerance = tolerance;
  options.iterations = iterations;
  bw_solid_transient *m = motion_of(context, &b, load_case, &options, NULL, v);
  swing s = {.drift = 0};
  double first = m->kinetic + m->strain, last = first, full = sum_of(m);
  for (int k = 0; k < count; k++) {
    steps(context, m, 1);
    double now = m->kinetic + m->strain;
    s.drift = fmax(s.drift, fabs(now / first - 1));
    if (scheme == BW_IMPLICIT_EULER)
      assert_true(now <= last * (1 + 1e-12));
    check_near(sum_of(m), full, 1e-12 * full);
    last = now;
  }
  s.lost = 1 - last / first;
  memcpy(s.tip, m->displacement + 3 * (int64_t)node_near(b.grid, 1, 0, 0), sizeof s.tip);
  assert_true(fabs(s.tip[1]) > 0.15);
  bw_free(v);
  bw_release(m);
  bw_release(load_case);
  body_release(&b);
  return s;
}

static double apart(const double a[3], const double b[3]) {
  double d[3] = {a[0] - b[0], a[1] - b[1], a[2] - b[2]};
  return bw_norm(d);
}

static void test_order(void **state) {
  bw_context *context = check_context(state);
  swing fine = thrown(context, BW_NEO_HOOKEAN, BW_NEWMARK, 320, 1e-11, 30);
  swing a = thrown(context, BW_NEO_HOOKEAN, BW_NEWMARK, 20, 1e-11, 30),
        c = thrown(context, BW_NEO_HOOKEAN, BW_NEWMARK, 40, 1e-11, 30);
  double order = log2(apart(a.tip, fine.tip) / apart(c.tip, fine.tip));
  double energy = log2(a.drift / c.drift);
  printf("VERIFY | motion of a thrown bar, Newmark | order in the step | 2 | %.2f | 0.2 | theory\n",
         order);
  printf("VERIFY | motion of a thrown bar, Newmark | order of the swing of energy | 2 | %.2f | 0.3 "
         "| theory\n",
         energy);
  check_near(order, 2, 0.2);
  check_near(energy, 2, 0.3);
  assert_true(c.drift < 0.02);
  /* Implicit Euler and its one linear solve a step: order 1 */
  for (int iterations = 1; iterations <= 30; iterations += 29) {
    a = thrown(context, BW_NEO_HOOKEAN, BW_IMPLICIT_EULER, 80, 1e-11, iterations);
    c = thrown(context, BW_NEO_HOOKEAN, BW_IMPLICIT_EULER, 160, 1e-11, iterations);
    order = log2(apart(a.tip, fine.tip) / apart(c.tip, fine.tip));
    printf("VERIFY | motion of a thrown bar, implicit Euler%s | order in the step | 1 | %.2f | 0.2 "
           "| theory\n",
           iterations == 1 ? ", linearly" : "", order);
    check_near(order, 1, 0.2);
    assert_true(c.lost > 0 && c.lost < a.lost);
  }
}

/* The other laws keep the energy as well, through a long motion. */
static void test_energy(void **state) {
  bw_context *context = check_context(state);
  for (int law = 0; law < BW_LAWS; law++) {
    swing s = thrown(context, (bw_law)law, BW_NEWMARK, 60, 1e-10, 30);
    assert_true(s.drift < 0.02);
    s = thrown(context, (bw_law)law, BW_IMPLICIT_EULER, 30, 1e-10, 30);
    assert_true(s.lost > 0);
  }
}

/* Elements of many points, each with a law, constants and fibres of its own, as coarse solids have
 * them, keep energy, momentum and books in the same way. */
static void test_metamaterial(void **state) {
  bw_context *context = check_context(state);
  const double origin[3] = {0, 0, 0}, spacing[3] = {0.2, 0.2, 0.2};
  const int32_t cells[3] = {3, 1, 1};
  enum { POINTS = 64 };
  uint8_t law[POINTS];
  double mu[POINTS], lambda[POINTS], stiffness[POINTS], fibre[3 * POINTS], max[2];
  bw_random random;
  bw_random_seed(&random, 8);
  for (int p = 0; p < POINTS; p++) {
    law[p] = BW_NEO_HOOKEAN;
    mu[p] = 2e4 * (1 + bw_random_uniform(&random));
    lambda[p] = 3e4 * (1 + bw_random_uniform(&random));
    stiffness[p] = 5e4 * bw_random_uniform(&random);
    double a = 7 * bw_random_uniform(&random), z = 2 * bw_random_uniform(&random) - 1;
    fibre[3 * p] = sqrt(1 - z * z) * cos(a);
    fibre[3 * p + 1] = sqrt(1 - z * z) * sin(a);
    fibre[3 * p + 2] = z;
  }
  bw_rule *rule;
  bw_solid_material *material;
  body b = {.grid = NULL};
  check_ok(context, bw_rule_create(context, 2, &rule));
  assert_int_equal(rule->count, POINTS);
  check_ok(context, bw_solid_material_points(context, "mixed", rule, 1000, law, mu, lambda, 1,
                                             stiffness, fibre, &material));
  check_ok(context, bw_grid_create(context, origin, spacing, cells, NULL, NULL, &b.grid));
  check_ok(context,
           bw_material_table_create(context, 2, (const bw_solid_material *const[]){material},
                                    &b.material_table));
  check_ok(context, bw_solid_create(context, b.grid, b.material_table, NULL, &b.solid));
  b.nodes = b.grid->node_count;
  bw_load_case *load_case = case_of(context, &b);
  double *v = BW_NEW(context, double, 3 * b.nodes);
  for (int32_t i = 0; i < 3 * b.nodes; i++)
    v[i] = bw_random_uniform(&random) - 0.5 + (i % 3 == 0);
  for (int r = 0; r < 2; r++) {
    bw_transient_options options = options_of(BW_NEWMARK, 2e-3 / (1 << r));
    options.tolerance = 1e-10;
    bw_solid_transient *m = motion_of(context, &b, load_case, &options, NULL, v);
    double first = m->kinetic + m->strain, p0[3], p[3], l[3];
    momenta(m, p0, l);
    max[r] = 0;
    for (int k = 0; k < 40 << r; k++) {
      steps(context, m, 1);
      max[r] = fmax(max[r], fabs((m->kinetic + m->strain) / first - 1));
    }
    momenta(m, p, l);
    for (int c = 0; c < 3; c++)
      check_near(p[c], p0[c], 1e-7 * bw_norm(p0));
    bw_release(m);
  }
  printf("VERIFY | free body of 64 points an element, with fibres, Newmark | order of the swing of "
         "energy | 2 | %.2f | 0.4 | theory\n",
         log2(max[0] / max[1]));
  assert_true(max[0] < 0.02);
  check_near(log2(max[0] / max[1]), 2, 0.4);
  bw_free(v);
  bw_release(rule);
  bw_release(material);
  bw_release(load_case);
  body_release(&b);
}

/* A column of four elements that are linear springs, all four modes at once: Newmark keeps the
 * energy of linear motion to rounding. */
static void test_linear_energy(void **state) {
  bw_context *context = check_context(state);
  body b = body_box(context, 1, 1, 4, 0.1, 0.1, 1, BW_COROTATED, 1e5, 0, 1000);
  bw_load_case *load_case = case_of(context, &b);
  hold_side(context, load_case, 2, 0, 7, 0, 0, 0);
  double *u = BW_NEW0(context, double, 3 * b.nodes);
  bw_random random;
  bw_random_seed(&random, 3);
  for (int layer = 1; layer <= 4; layer++) {
    double z = 0.04 * (bw_random_uniform(&random) - 0.5);
    for (int i = 0; i < 4; i++)
      u[3 * (4 * layer + i) + 2] = z;
  }
  bw_transient_options options = options_of(BW_NEWMARK, 0.01);
  bw_solid_transient *m = motion_of(context, &b, load_case, &options, u, NULL);
  double first = m->kinetic + m->strain, max = 0;
  for (int k = 0; k < 300; k++) {
    steps(context, m, 1);
    max = fmax(max, fabs((m->kinetic + m->strain) / first - 1));
  }
  printf("VERIFY | linear motion, Newmark | change of energy in 300 steps | 0 | %.1e | 1e-10 | "
         "theory\n",
         max);
  assert_true(first > 0 && max < 1e-10);
  bw_release(m);
  bw_free(u);
  bw_release(load_case);
  body_release(&b);
}

/* The lowest axial mode of a rod constrained at one end, period 4 L / c: lumped masses make it
 * w = (2 c / l) sin(k l / 2), Newmark's steps tan(theta / 2) = w h / 2. Cells and step halved
 * together, the phase after a period is in error by a quarter. */
static void test_rod(void **state) {
  bw_context *context = check_context(state);
  double young = 4e5, density = 1000, length = 1, c = sqrt(young / density),
         period = 4 * length / c;
  double k = PI / (2 * length), error[2];
  for (int r = 0; r < 2; r++) {
    int cells = 8 << r, count = 32 << r;
    body b = body_box(context, 1, 1, cells, 0.1, 0.1, length, BW_COROTATED, young, 0, density);
    bw_load_case *load_case = case_of(context, &b);
    hold_side(context, load_case, 2, 0, 7, 0, 0, 0);
    double *u = BW_NEW0(context, double, 3 * b.nodes);
    for (int32_t i = 0; i < b.nodes; i++) {
      double x[3];
      bw_grid_position(b.grid, i, x);
      u[3 * i + 2] = 1e-3 * sin(k * x[2]);
    }
    bw_transient_options options = options_of(BW_NEWMARK, period / count);
    bw_solid_transient *m = motion_of(context, &b, load_case, &options, u, NULL);
    double w = 2 * c * cells / length * sin(k * length / cells / 2);
    double theta = 2 * atan(w * options.step / 2);
    double tip = 1e-3;
    for (int n = 1; n <= count; n++) {
      steps(context, m, 1);
      tip = m->displacement[3 * (b.nodes - 1) + 2];
      check_near(tip, 1e-3 * cos(theta * n), 1e-12);
    }
    error[r] = 2 * PI - theta * count;
    check_near(acos(fmin(1, tip / 1e-3)), fabs(error[r]), 1e-5);
    bw_free(u);
    bw_release(m);
    bw_release(load_case);
    body_release(&b);
  }
  double order = log2(error[0] / error[1]);
  printf(
      "VERIFY | lowest axial mode of a rod, Newmark | order of its period in cells and step | 2 | "
      "%.2f | 0.05 | theory\n",
      order);
  check_near(order, 2, 0.05);
}

/* A free block that a pressure takes hold of from all sides at once rings about the shape that it
 * has at rest under it. The pressure follows the shape, and its potential is p times the volume:
 * the books change by just that, as far as the trapezoidal rule finds the work. */
static void test_pressed(void **state) {
  bw_context *context = check_context(state);
  body b = body_box(context, 2, 2, 2, 0.2, 0.2, 0.2, BW_NEO_HOOKEAN, 1e5, 0.3, 1000);
  bw_surface *surface;
  bw_embedding *embedding;
  int32_t *node;
  double error[2], pressure = 2e4;
  check_ok(context, bw_grid_surface(context, b.grid, &surface, &node));
  check_ok(context, bw_embedding_create(context, b.grid, surface->point_count, surface->point, 0.1,
                                        &embedding));
  double *all = BW_NEW(context, double, surface->triangle_count);
  for (int64_t t = 0; t < surface->triangle_count; t++)
    all[t] = pressure;
  for (int r = 0; r < 2; r++) {
    bw_load_case *load_case = case_of(context, &b);
    check_ok(context, bw_load_case_pressure(context, load_case, embedding, surface->triangle_count,
                                            surface->triangle, all, true));
    bw_transient_options options = options_of(BW_NEWMARK, 2e-3 / (1 << r));
    options.tolerance = 1e-10;
    bw_solid_transient *m = motion_of(context, &b, load_case, &options, NULL, NULL);
    double min = 1, worst = 0;
    for (int k = 0; k < 20 << r; k++) {
      steps(context, m, 1);
      double volume = 0;
      for (int64_t t = 0; t < surface->triangle_count; t++) {
        double x[3][3], area[3];
        for (int c = 0; c < 3; c++) {
          int32_t i = node[surface->triangle[3 * t + c]];
          bw_grid_position(b.grid, i, x[c]);
          for (int d = 0; d < 3; d++)
            x[c][d] += m->displacement[3 * i + d];
        }
        bw_cross(x[1], x[2], area);
        volume += bw_dot(x[0], area) / 6;
      }
      min = fmin(min, volume / 8e-3);
      double work = pressure * (8e-3 - volume);
      worst = fmax(worst, fabs(sum_of(m) - work) / (pressure * 8e-3));
      double total = m->kinetic + m->strain;
      assert_true(total < 1.2 * work + 1e-9);
    }
    error[r] = worst;
    assert_true(min < 0.75 && min > 0.5);
    assert_true(worst < 5e-3);
    bw_release(m);
    bw_release(load_case);
  }
  check_near(log2(error[0] / error[1]), 2, 0.3);
  bw_free(all);
  bw_free(node);
  bw_release(surface);
  bw_release(embedding);
  body_release(&b);
}

/* A free body, turning, stretched and flying. Momentum stays; Newmark keeps
 * L + h^2/4 sum m v x a, and implicit Euler loses h^2 sum m v x a of L in every step. */
static void test_momenta(void **state) {
  bw_context *context = check_context(state);
  body b = body_box(context, 3, 2, 1, 0.3, 0.2, 0.1, BW_FIXED_COROTATED, 2e5, 0.3, 1000);
  bw_load_case *load_case = case_of(context, &b);
  double *u = BW_NEW(context, double, 6 * b.nodes), *v = u + 3 * b.nodes;
  const double middle[3] = {0.15, 0.1, 0.05};
  for (int scheme = 0; scheme < 2; scheme++) {
    /* Newmark's body is stretched, flies and tumbles; implicit Euler's only turns about an axis of
       its own, for a closed form of what it loses */
    bool whole = scheme == BW_NEWMARK;
    double h = 5e-3;
    const double omega[3] = {whole ? 3 : 0, whole ? -5 : 0, 8};
    for (int32_t i = 0; i < b.nodes; i++) {
      double x[3], y[3];
      bw_grid_position(b.grid, i, x);
      for (int c = 0; c < 3; c++)
        y[c] = x[c] - middle[c];
      u[3 * i] = whole ? 0.05 * x[0] + 0.1 * x[1] : 0;
      u[3 * i + 1] = whole ? -0.03 * x[1] * x[0] : 0;
      u[3 * i + 2] = 0;
      bw_cross(omega, y, v + 3 * i);
      v[3 * i + 1] += whole ? 2 : 0;
    }
    bw_transient_options options = options_of((bw_transient_scheme)scheme, h);
    bw_solid_transient *m = motion_of(context, &b, load_case, &options, u, v);
    double p0[3], l0[3], p[3], l[3], kept0[3] = {0, 0, 0};
    momenta(m, p0, l0);
    for (int k = 0; k <= 40; k++) {
      if (k)
        steps(context, m, 1);
      momenta(m, p, l);
      double turn[3] = {0, 0, 0};
      for (int32_t i = 0; i < b.nodes; i++) {
        double cross[3];
        bw_cross(m->velocity + 3 * i, m->acceleration + 3 * i, cross);
        for (int c = 0; c < 3; c++)
          turn[c] += m->solid->mass[i] * cross[c];
      }
      for (int c = 0; c < 3; c++) {
        check_near(p[c], p0[c], 1e-9 * (bw_norm(p0) + bw_norm(l0)));
        double kept = scheme == BW_NEWMARK ? l[c] + h * h / 4 * turn[c] : l[c];
        if (k == 0)
          kept0[c] = kept;
        else if (scheme == BW_IMPLICIT_EULER)
          kept0[c] -= h * h * turn[c];
        check_near(kept, kept0[c], 1e-9 * bw_norm(l0));
      }
    }
    double left = bw_norm(l) / bw_norm(l0);
    if (whole) {
      printf(
          "VERIFY | tumbling body, Newmark | angular momentum after 40 steps | 1 | %.5f | 0.002 | "
          "theory\n",
          left);
      check_near(left, 1, 2e-3);
    } else { /* dL/dt = -w^2 h L */
      double theory = 1 / sqrt(1 + 2 * 64 * h * m->time);
      printf(
          "VERIFY | turning body, implicit Euler | angular momentum after 40 steps | %.4f | %.4f | "
          "0.005 | theory\n",
          theory, left);
      check_near(left, theory, 5e-3);
    }
    bw_release(m);
  }
  bw_free(u);
  bw_release(load_case);
  body_release(&b);
}

/* With implicit Euler and strong damping the motion ends in the static equilibrium. */
static void test_comes_to_rest(void **state) {
  bw_context *context = check_context(state);
  body b = body_box(context, 4, 1, 1, 1, 0.25, 0.25, BW_NEO_HOOKEAN, 1e5, 0.3, 1000);
  bw_load_case *load_case = case_of(context, &b);
  hold_side(context, load_case, 0, 0, 7, 0, 0, 0);
  push_side(context, load_case, 0, 1, 0, 0, 60);
  load_case->gravity[1] = -2;
  bw_solid_static *rest = solve(context, &b, load_case, 1);
  bw_transient_options options = options_of(BW_IMPLICIT_EULER, 0.2);
  options.mass_damping = 1;
  options.tolerance = 1e-10;
  bw_solid_transient *m = motion_of(context, &b, load_case, &options, NULL, NULL);
  double first = sum_of(m);
  steps(context, m, 120);
  double size = 0;
  for (int32_t i = 0; i < 3 * b.nodes; i++)
    size = fmax(size, fabs(rest->displacement[i]));
  for (int32_t i = 0; i < 3 * b.nodes; i++)
    check_near(m->displacement[i], rest->displacement[i], 1e-6 * size);
  check_near(m->strain, rest->energy, 1e-5 * rest->energy);
  check_near(m->kinetic, 0, 1e-8);
  check_near(sum_of(m), first, 1e-8);
  assert_true(m->dissipated > 0);
  bw_release(rest);
  bw_release(m);
  bw_release(load_case);
  body_release(&b);
}

/* A block falls on a floor: nothing passes through it, the energy never grows, and at last the
 * block lies there. */
static void test_contact_plane(void **state) {
  bw_context *context = check_context(state);
  body b = body_box(context, 2, 2, 2, 0.2, 0.2, 0.2, BW_NEO_HOOKEAN, 1e5, 0.3, 1000);
  const double point[3] = {0, 0, -0.1}, up[3] = {0, 0, 1}, stay[3] = {0, 0, 0};
  for (int scheme = 0; scheme < 2; scheme++) {
    bw_load_case *load_case = case_of(context, &b);
    load_case->gravity[2] = -9.81;
    check_ok(context, bw_load_case_contact_plane(context, load_case, point, up, stay, NULL, NULL));
    bw_transient_options options = options_of((bw_transient_scheme)scheme, 2e-3);
    options.tolerance = 1e-8;
    options.mass_damping = scheme == BW_NEWMARK ? 4 : 0;

    bw_solid_transient *m = motion_of(context, &b, load_case, &options, NULL, NULL);
    double full = sum_of(m), last = m->kinetic + m->strain + m->potential, first = m->potential;
    double size = 8 * 9.81 * 0.1; /* weight times fall */
    for (int k = 0; k < 250; k++) {
      steps(context, m, 1);
      double now = m->kinetic + m->strain + m->potential;
      assert_true(now < last + 2e-3 * size);
      last = now;
      for (int32_t i = 0; i < b.nodes; i++) {
        double x[3];
        bw_grid_position(b.grid, i, x);
        assert_true(x[2] + m->displacement[3 * i + 2] > -0.1 - 1e-4);
      }
      check_near(sum_of(m), full, 1e-9 * size);
    }
    check_near(m->potential - first, -size, 0.15 * size);
    bw_release(m);
    bw_release(load_case);
  }
  body_release(&b);
}

/* Held nodes, and those that the case displaces, are where the case wants them, from the start. */
static void test_held(void **state) {
  bw_context *context = check_context(state);
  body b = body_box(context, 2, 1, 1, 2, 1, 1, BW_ST_VENANT_KIRCHHOFF, 1e5, 0.3, 1000);
  bw_load_case *load_case = case_of(context, &b);
  hold_side(context, load_case, 0, 0, 7, 0, 0, 0);
  hold_side(context, load_case, 0, 2, 1, 0.1, 0, 0);
  double *v = BW_NEW(context, double, 3 * b.nodes);
  for (int32_t i = 0; i < 3 * b.nodes; i++)
    v[i] = 0.5;
  bw_transient_options options = options_of(BW_NEWMARK, 1e-3);
  bw_solid_transient *m = motion_of(context, &b, load_case, &options, NULL, v);
  for (int k = 0; k < 5; k++) {
    for (int32_t i = 0; i < b.nodes; i++) {
      double x[3];
      bw_grid_position(b.grid, i, x);
      for (int c = 0; c < 3; c++)
        if (x[0] == 0 || (x[0] == 2 && c == 0)) {
          assert_true(m->displacement[3 * i + c] == (x[0] == 2 ? 0.1 : 0));
          assert_true(m->velocity[3 * i + c] == 0 && m->acceleration[3 * i + c] == 0);
        }
    }
    steps(context, m, 1);
  }
  bw_free(v);
  bw_release(m);
  bw_release(load_case);
  body_release(&b);
}

static bw_solid_transient *copy_of_motion(bw_context *context, const body *b,
                                          const bw_load_case *load_case, int iterations) {
  bw_transient_options options = options_of(BW_NEWMARK, 0.02);
  options.iterations = iterations;
  options.stiffness_damping = 1e-3;
  double *v = BW_NEW0(context, double, 3 * b->nodes);
  for (int32_t i = 0; i < b->nodes; i++) {
    double x[3];
    bw_grid_position(b->grid, i, x);
    v[3 * i + 1] = 3 * x[0];
  }
  bw_solid_transient *m = motion_of(context, b, load_case, &options, NULL, v);
  bw_free(v);
  return m;
}

/* A step that fails leaves everything as it was, and the next one goes on from there. */
static void test_failure(void **state) {
  bw_context *context = check_context(state);
  body b = body_box(context, 3, 1, 1, 1, 0.3, 0.3, BW_NEO_HOOKEAN, 1e5, 0.3, 1000);
  bw_load_case *load_case = case_of(context, &b);
  hold_side(context, load_case, 0, 0, 7, 0, 0, 0);
  bw_solid_transient *m = copy_of_motion(context, &b, load_case, 30), *other;
  other = copy_of_motion(context, &b, load_case, 30);
  steps(context, m, 2);
  steps(context, other, 2);
  size_t bytes = 3 * (size_t)b.nodes * sizeof(double);
  for (int way = 0; way < 2; way++) {
    if (way == 0) {
      m->options.iterations = 2;
      m->options.step = 0.5;
      check_fails(context, BW_CONVERGENCE, "step", bw_solid_transient_step(context, m));
      m->options.iterations = 30;
      m->options.step = 0.02;
    } else {
      bw_cancel(context);
      check_fails(context, BW_CANCELLED, "", bw_solid_transient_step(context, m));
      bw_clear_cancel(context);
    }
    assert_memory_equal(m->displacement, other->displacement, bytes);
    assert_memory_equal(m->velocity, other->velocity, bytes);
    assert_memory_equal(m->acceleration, other->acceleration, bytes);
    assert_true(m->time == other->time && m->steps == other->steps);
    assert_true(m->kinetic == other->kinetic && m->strain == other->strain &&
                m->potential == other->potential && m->dissipated == other->dissipated);
    steps(context, m, 1);
    steps(context, other, 1);
    assert_memory_equal(m->displacement, other->displacement, bytes);
  }
  bw_release(m);
  bw_release(other);
  bw_release(load_case);
  body_release(&b);
}

static void test_refused(void **state) {
  bw_context *context = check_context(state);
  body b = body_box(context, 1, 1, 1, 1, 1, 1, BW_NEO_HOOKEAN, 1, 0.3, 1);
  body light = body_box(context, 1, 1, 1, 1, 1, 1, BW_NEO_HOOKEAN, 1, 0.3, 0);
  body larger = body_box(context, 2, 1, 1, 1, 1, 1, BW_NEO_HOOKEAN, 1, 0.3, 1);
  bw_load_case *load_case = case_of(context, &b), *of_light = case_of(context, &light);
  bw_solid_transient *m;
  bw_transient_options options;
  bw_transient_options_default(&options);
  check_fails(context, BW_INVALID, "density",
              bw_solid_transient_create(context, light.solid, of_light, NULL, NULL, NULL, &m));
  check_fails(context, BW_INVALID, "grid",
              bw_solid_transient_create(context, larger.solid, load_case, NULL, NULL, NULL, &m));
  const struct {
    const char *text;
    bw_transient_options options;
  } wrong[] = {{"step", {.step = 0}},
               {"step", {.step = NAN}},
               {"damping", {.step = 1, .mass_damping = -1}},
               {"damping", {.step = 1, .stiffness_damping = INFINITY}},
               {"beta", {.step = 1, .scheme = BW_NEWMARK, .beta = 0, .gamma = 0.5}},
               {"gamma", {.step = 1, .scheme = BW_NEWMARK, .beta = 0.25, .gamma = 0.4}},
               {"beta", {.step = 1, .scheme = BW_NEWMARK, .beta = 0.2, .gamma = 0.9}},
               {"scheme", {.step = 1, .scheme = (bw_transient_scheme)7}}};
  for (size_t k = 0; k < sizeof wrong / sizeof *wrong; k++) {
    bw_transient_options it = wrong[k].options;
    it.tolerance = options.tolerance;
    it.iterations = options.iterations;
    check_fails(context, BW_INVALID, wrong[k].text,
                bw_solid_transient_create(context, b.solid, load_case, &it, NULL, NULL, &m));
  }
  double u[24] = {0};
  u[5] = NAN;
  check_fails(context, BW_INVALID, "node 2",
              bw_solid_transient_create(context, b.solid, load_case, NULL, NULL, u, &m));
  u[5] = 0;
  for (int i = 4; i < 8; i++)
    u[3 * i + 2] = -1.5; /* turned inside out */
  check_fails(context, BW_GEOMETRY, "element 1",
              bw_solid_transient_create(context, b.solid, load_case, NULL, u, NULL, &m));
  bw_release(load_case);
  bw_release(of_light);
  body_release(&b);
  body_release(&light);
  body_release(&larger);
}

/* Without a matrix the same motion, with either damping and a floor. */
static void test_without_matrix(void **state) {
  bw_context *context = check_context(state);
  body b = body_box(context, 5, 3, 3, 0.5, 0.3, 0.3, BW_FIXED_COROTATED, 1e5, 0.3, 1000);
  const double point[3] = {0, 0, -0.02}, up[3] = {0, 0, 1}, stay[3] = {0, 0, 0};
  bw_load_case *load_case = case_of(context, &b);
  hold_side(context, load_case, 0, 0, 7, 0, 0, 0);
  check_ok(context, bw_load_case_contact_plane(context, load_case, point, up, stay, NULL, NULL));
  load_case->gravity[2] = -30;
  bw_solid_transient *m[2];
  for (int k = 0; k < 2; k++) {
    bw_transient_options options = options_of(BW_NEWMARK, 4e-3);
    bw_solver *solver = newton_solver(context, k ? NEWTON_JACOBI : NEWTON_DIRECT);
    options.solver = solver;
    options.mass_damping = 2;
    options.stiffness_damping = 2e-3;
    options.tolerance = 1e-10;
    m[k] = motion_of(context, &b, load_case, &options, NULL, NULL);
    bw_release(solver);                           /* the motion keeps it */
    assert_string_equal(m[k]->report.solver, ""); /* nothing is solved yet */
    steps(context, m[k], 25);
    assert_string_equal(m[k]->report.solver, k ? "pcg" : "cholesky");
    assert_string_equal(m[k]->report.preconditioner, k ? "jacobi" : "");
    assert_int_equal(m[k]->report.iterations, m[k]->newton.cg_iterations);
  }
  int32_t tip = node_near(b.grid, 0.5, 0, 0);
  check_near(m[0]->displacement[3 * tip + 2], -0.02, 1e-8); /* lies on the floor */
  for (int32_t i = 0; i < 3 * b.nodes; i++) {
    check_near(m[1]->displacement[i], m[0]->displacement[i], 1e-8);
    check_near(m[1]->velocity[i], m[0]->velocity[i], 1e-5);
  }
  assert_true(m[1]->newton.cg_iterations > 0 && m[1]->newton.factorisations == 0);
  bw_release(m[0]);
  bw_release(m[1]);
  bw_release(load_case);
  body_release(&b);
}

static void test_threads(void **state) {
  bw_context *context = check_context(state);
  body b = body_box(context, 6, 4, 4, 1, 0.6, 0.6, BW_NEO_HOOKEAN, 1e5, 0.3, 1000);
  bw_load_case *load_case = case_of(context, &b);
  hold_side(context, load_case, 0, 0, 7, 0, 0, 0);
  load_case->gravity[1] = -9.81;
  bw_solid_transient *m[2];
  for (int k = 0; k < 2; k++) {
    check_ok(context, bw_set_threads(context, k ? 3 : 1));
    m[k] = copy_of_motion(context, &b, load_case, 30);
    m[k]->options.tolerance = 1e-8;
    steps(context, m[k], 3);
  }
  size_t bytes = 3 * (size_t)b.nodes * sizeof(double);
  assert_memory_equal(m[0]->displacement, m[1]->displacement, bytes);
  assert_memory_equal(m[0]->velocity, m[1]->velocity, bytes);
  assert_true(m[0]->strain == m[1]->strain && m[0]->kinetic == m[1]->kinetic &&
              m[0]->dissipated == m[1]->dissipated);
  bw_release(m[0]);
  bw_release(m[1]);
  bw_release(load_case);
  body_release(&b);
}

static void test_memory(void **state) {
  bw_context *context = check_context(state);
  check_ok(context, bw_set_threads(context, 1));
  body b = body_box(context, 2, 1, 1, 1, 0.3, 0.3, BW_NEO_HOOKEAN, 1e5, 0.3, 1000);
  bw_load_case *load_case = case_of(context, &b);
  hold_side(context, load_case, 0, 0, 7, 0, 0, 0);
  bw_transient_options options = options_of(BW_NEWMARK, 0.02);
  options.stiffness_damping = 1e-3;
  options.tolerance = 1e-8;
  check_each_allocation(context, status, 1) {
    bw_solid_transient *m = NULL;
    status = bw_solid_transient_create(context, b.solid, load_case, &options, NULL, NULL, &m);
    assert_true(status == BW_OK || (status == BW_MEMORY && !m));
    bw_release(m);
  }
  load_case->gravity[1] = -9.81;
  const double point[3] = {0, -1e-3, 0}, up[3] = {0, 1, 0}, stay[3] = {0, 0, 0};
  check_ok(context, bw_load_case_contact_plane(context, load_case, point, up, stay, NULL, NULL));
  for (int way = 0; way < 2; way++) {
    bw_solver *solver = newton_solver(context, way ? NEWTON_JACOBI : NEWTON_DIRECT);
    options.solver = solver;
    bw_solid_transient *plain = motion_of(context, &b, load_case, &options, NULL, NULL);
    steps(context, plain, 2);
    assert_true(plain->newton.contacts > 0);
    bw_status status = BW_MEMORY;
    for (int n = 1; status != BW_OK; n++) {
      bw_solid_transient *m = motion_of(context, &b, load_case, &options, NULL, NULL);
      bw_fail_allocation(n, true);
      status = bw_solid_transient_step(context, m);
      bw_fail_allocation(0, false);
      assert_true(status == BW_OK || status == BW_MEMORY);
      assert_true(n < 5000);
      steps(context, m, status == BW_OK ? 1 : 2); /* it goes on where it was */
      assert_memory_equal(m->displacement, plain->displacement,
                          3 * (size_t)b.nodes * sizeof(double));
      bw_release(m);
    }
    bw_release(plain);
    bw_release(solver);
  }
  bw_release(load_case);
  body_release(&b);
}

check_main(check_test(test_free_fall), check_test(test_spring), check_test(test_order),
           check_test(test_energy), check_test(test_metamaterial), check_test(test_momenta),
           check_test(test_linear_energy), check_test(test_rod), check_test(test_pressed),
           check_test(test_held), check_test(test_comes_to_rest), check_test(test_contact_plane),
           check_test(test_failure), check_test(test_refused), check_test(test_threads),
           check_test(test_without_matrix), check_test(test_used_memory), check_test(test_memory))
