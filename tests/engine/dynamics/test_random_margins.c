/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* Random vibration against strength and fatigue: closed forms, random numbers, rainflow counting.
 */
#include "bodies.h"

#include "barwright/analysis.h"
#include "barwright/dynamics.h"
#include "dynamics/exceedance.h"

/* Of covariances that stay as they are. */
static bwi_exceedance exceed(int n, const double *position, const double *velocity,
                             const double *cross, double level) {
  double copy[3][25];
  bwi_exceedance e;
  for (int k = 0; k < n * n; k++) {
    copy[0][k] = position[k];
    copy[1][k] = velocity ? velocity[k] : 0;
    copy[2][k] = cross ? cross[k] : 0;
  }
  assert_true(bwi_exceedance_of(n, copy[0], copy[1], copy[2], level, &e));
  return e;
}

static double beyond(int n, const double *lambda, double x) {
  double position[25] = {0};
  for (int i = 0; i < n; i++)
    position[i * n + i] = lambda[i];
  return exceed(n, position, NULL, NULL, sqrt(x)).probability;
}

/* The mean over directions of the whitened plane. */
static double in_a_plane(double a, double b, double x) {
  double sum = 0;
  for (int k = 0; k < 2000; k++) {
    double c = cos((k + 0.5) * M_PI / 2000), s = sin((k + 0.5) * M_PI / 2000);
    sum += exp(-x / (2 * (a * c * c + b * s * s))) / 2000;
  }
  return sum;
}

/* Chi squares of one to five, in closed form; to 30 deviations all digits stay. */
static void probabilities(void **state) {
  (void)state;
  const double one[5] = {1, 1, 1, 1, 1}, line[5] = {4e12};
  for (int k = 0; k < 60; k++) {
    double r = 0.02 * pow(1.13, k), x = r * r, e = exp(-x / 2), tail = erfc(r / sqrt(2));
    const double expected[5] = {tail, e, tail + sqrt(2 * x / M_PI) * e, e * (1 + x / 2),
                                tail + sqrt(2 * x / M_PI) * e * (1 + x / 3)};
    for (int n = 1; n <= 5; n++)
      check_near(beyond(n, one, x), expected[n - 1], 1e-11 * expected[n - 1]);
    check_near(beyond(5, line, 4e12 * x), tail, 1e-11 * tail);
    for (double b = 0.999999; b > 1e-9; b *= 0.37) {
      const double pair[2] = {b, 1}, twice[5] = {1, b, 1, b, 0};
      double plane = in_a_plane(1, b, x), sum = b < 0.9 ? (e - b * exp(-x / 2 / b)) / (1 - b) : -1;
      if (b > 1e-4) /* else the sum over directions is too coarse */
        check_near(beyond(2, pair, x), plane, 1e-9 * plane);
      if (sum > 0)
        check_near(beyond(5, twice, x), sum, 1e-9 * sum);
    }
  }
  assert_true(beyond(5, line, 1e300) == 0);
  assert_true(beyond(3, one, 1e-300) == 1);
  const double none[2] = {0, 0};
  assert_true(beyond(2, none, 1) == 0);
}

/* A process of N components as a sum of ellipses at three frequencies. */
enum { N = 4, WAVES = 3 };
typedef struct process {
  double a[WAVES][N], b[WAVES][N], omega[WAVES];
  double position[N * N], velocity[N * N], cross[N * N];
} process;

static process random_process(uint64_t seed) {
  process p = {.omega = {2, 5, 11}};
  double value[2 * WAVES * N];
  random_field(seed, 2 * WAVES * N, value);
  for (int w = 0; w < WAVES; w++)
    for (int i = 0; i < N; i++) {
      p.a[w][i] = value[2 * (w * N + i)] / (1 + i);
      p.b[w][i] = value[2 * (w * N + i) + 1] / (1 + i);
    }
  for (int w = 0; w < WAVES; w++)
    for (int i = 0; i < N; i++)
      for (int j = 0; j < N; j++) {
        double sum = p.a[w][i] * p.a[w][j] + p.b[w][i] * p.b[w][j];
        p.position[j * N + i] += sum;
        p.velocity[j * N + i] += p.omega[w] * p.omega[w] * sum;
        p.cross[j * N + i] += p.omega[w] * (p.a[w][i] * p.b[w][j] - p.b[w][i] * p.a[w][j]);
      }
  return p;
}

/* y . y and y . y_t of random waves. */
static void draw(const process *p, bw_random *random, double *square, double *product) {
  double y[N] = {0}, v[N] = {0};
  *square = *product = 0;
  for (int w = 0; w < WAVES; w++) {
    double c = bw_random_normal(random), s = bw_random_normal(random);
    for (int i = 0; i < N; i++) {
      y[i] += p->a[w][i] * c + p->b[w][i] * s;
      v[i] += p->omega[w] * (p->a[w][i] * s - p->b[w][i] * c);
    }
  }
  for (int i = 0; i < N; i++) {
    *square += y[i] * y[i];
    *product += y[i] * v[i];
  }
}

/* Probability and rate against random numbers: the rate bounds E|y . y_t| at the level, and is not
 * 26 % more than it where the deviations do not depend on the place (Schwarz). */
static void random_numbers(void **state) {
  (void)state;
  enum { DRAWS = 1000000 };
  for (uint64_t seed = 1; seed <= 3; seed++) {
    process p = random_process(seed);
    bw_random random;
    double trace = 0, outside = 0, sum = 0, band = 0.02;
    for (int i = 0; i < N; i++)
      trace += p.position[i * N + i];
    double x = 2.5 * trace;
    bwi_exceedance e = exceed(N, p.position, p.velocity, p.cross, sqrt(x));
    bw_random_seed(&random, 100 + seed);
    for (int k = 0; k < DRAWS; k++) {
      double square, product;
      draw(&p, &random, &square, &product);
      outside += square > x;
      sum += fabs(square - x) < band * x ? fabs(product) : 0;
    }
    double q = e.probability, rate = sum / DRAWS / (2 * band * x);
    check_near(outside / DRAWS, q, 4 * sqrt(q * (1 - q) / DRAWS));
    assert_true(e.rate > 0.98 * rate); /* 2 %: 4 deviations of some 40,000 draws in the band */
    assert_true(e.rate < 1.26 * 1.02 * rate);
  }
}

/* Rice's rate of one component; that of the envelope of a process that turns. */
static void rates(void **state) {
  (void)state;
  for (double r = 0.1; r < 30; r *= 1.7) {
    const double s = 9, v = 50, circle[4] = {1, 0, 0, 1}, fast[4] = {7, 0, 0, 7},
                 turning[4] = {0, 2, -2, 0};
    double expected = sqrt(v / s) / M_PI * exp(-r * r / 2);
    check_near(exceed(1, &s, &v, NULL, 3 * r).rate, expected, 1e-10 * expected);
    expected = r * sqrt((7 - 4) / (2 * M_PI)) * exp(-r * r / 2);
    check_near(exceed(2, circle, fast, turning, r).rate, expected, 1e-10 * expected);
    /* units: stress times 1e6, time times 1e3 */
    process p = random_process(5), q = p;
    for (int k = 0; k < N * N; k++) {
      q.position[k] *= 1e12;
      q.velocity[k] *= 1e6;
      q.cross[k] *= 1e9;
    }
    bwi_exceedance a = exceed(N, p.position, p.velocity, p.cross, r);
    bwi_exceedance b = exceed(N, q.position, q.velocity, q.cross, 1e6 * r);
    check_near(b.probability, a.probability, 1e-9 * a.probability);
    check_near(1e3 * b.rate, a.rate, 1e-9 * a.rate);
  }
}

/* ---- fatigue --------------------------------------------------------------------------------- */

static double oscillator(double f) {
  return 1 / (pow(1 - f * f, 2) + pow(0.1 * f, 2));
}
static double two_peaks(double f) {
  return oscillator(f) + 0.05 * oscillator(f / 4);
}
static double flat(double f) {
  return f > 0.5 && f < 6 ? 1 : 0;
}

/* A sum of waves of random phases and its spectral moments. */
enum { WAVE = 2500, SAMPLES = 100000 };
static const double dt = 0.015;
static void signal_of(uint64_t seed, double (*density)(double), double *value, double moment[4]) {
  double df = 8.0 / WAVE;
  bw_random random;
  bw_random_seed(&random, seed);
  memset(moment, 0, 4 * sizeof *moment);
  memset(value, 0, SAMPLES * sizeof *value);
  for (int w = 0; w < WAVE; w++) {
    double f = (w + bw_random_uniform(&random)) * df, s = density(f) * df;
    double phase = 2 * M_PI * bw_random_uniform(&random);
    double a = sqrt(2 * s) * cos(phase), b = sqrt(2 * s) * sin(phase);
    double c = cos(2 * M_PI * f * dt), d = sin(2 * M_PI * f * dt);
    for (int t = 0; s > 0 && t < SAMPLES; t++) {
      double turned = c * a - d * b;
      value[t] += a;
      b = d * a + c * b;
      a = turned;
    }
    for (int k = 0; k < 4; k++)
      moment[k] += s * pow(f, k < 3 ? k : 4);
  }
}

/* Damage per time of cycles. */
static double by_rainflow(const bw_life_curve *curve, const bw_cycle *cycle, int64_t n) {
  double damage = 0;
  for (int64_t k = 0; k < n; k++)
    if (cycle[k].range / 2 > curve->limit)
      damage += cycle[k].count * pow(cycle[k].range / 2 / curve->amplitude, curve->exponent);
  return damage / curve->cycles / (SAMPLES * dt);
}

static double damage_by(bw_context *context, const bw_life_curve *curve, bw_spectral_method method,
                        const double moment[4]) {
  double rate = -1;
  check_ok(context, bw_spectral_damage(context, curve, method, moment, &rate));
  return rate;
}

/* Of each density 6000 s of signals, whose damage at the exponent 5 scatters by some 5 %. */
static void spectral_damage(void **state) {
  bw_context *context = check_context(state);
  enum { SEEDS = 4 };
  double (*densities[3])(double) = {oscillator, two_peaks, flat}, *value = numbers(SAMPLES);
  for (int d = 0; d < 3; d++) {
    double m[4], counted[4] = {0};
    bw_life_curve curves[4];
    for (uint64_t seed = 1; seed <= SEEDS; seed++) {
      bw_cycle *cycle = NULL;
      int64_t n = 0;
      signal_of(seed, densities[d], value, m);
      check_ok(context, bw_rainflow(context, SAMPLES, value, &cycle, &n));
      for (int c = 0; c < 4; c++) {
        curves[c] = (bw_life_curve){.amplitude = 3, .cycles = 1e6, .exponent = c % 2 ? 3 : 5};
        curves[c].limit = c / 2 * 1.5 * sqrt(m[0]);
        counted[c] += by_rainflow(&curves[c], cycle, n) / SEEDS;
      }
      bw_free(cycle);
    }
    for (int c = 0; c < 4; c++) {
      double tovo = damage_by(context, &curves[c], BW_TOVO_BENASCIUTTI, m);
      check_near(tovo / counted[c], 1, 0.2);
      check_near(damage_by(context, &curves[c], BW_DIRLIK, m) / counted[c], 1, 0.15);
      check_near(damage_by(context, &curves[c], BW_WIRSCHING_LIGHT, m) / counted[c], 1, 0.3);
      assert_true(tovo <= damage_by(context, &curves[c], BW_NARROW_BAND, m));
      /* stress times 100, then frequencies times 10 */
      bw_life_curve large = curves[c];
      large.amplitude *= 100;
      large.limit *= 100;
      const double scaled[4] = {1e4 * m[0], 1e5 * m[1], 1e6 * m[2], 1e8 * m[3]};
      check_near(damage_by(context, &large, BW_TOVO_BENASCIUTTI, scaled), 10 * tovo, 1e-10 * tovo);
    }
  }
  free(value);
}

/* A narrow band has Rayleigh's peaks: 2 of the curve's damages at exponent 2, and with a limit the
 * incomplete gamma function. */
static void narrow_band(void **state) {
  bw_context *context = check_context(state);
  const double m[4] = {9, 9 * 4, 9 * 16, 9 * 256};
  bw_life_curve curve = {.amplitude = 3, .cycles = 10, .exponent = 2};
  for (int method = BW_TOVO_BENASCIUTTI; method <= BW_NARROW_BAND; method++)
    check_near(damage_by(context, &curve, (bw_spectral_method)method, m), 4 * 2.0 / 10, 1e-10);
  for (double limit = 0.1; limit < 60; limit *= 1.5) {
    double x = limit * limit / 18, expected = 4 * 2.0 / 10 * (1 + x) * exp(-x);
    curve.limit = limit;
    check_near(damage_by(context, &curve, BW_NARROW_BAND, m), expected, 1e-12 * expected + 1e-300);
  }
  curve.strength = 1;
  double rate;
  check_fails(context, BW_INVALID, "the mean 0",
              bw_spectral_damage(context, &curve, BW_DIRLIK, m, &rate));
  curve = (bw_life_curve){.amplitude = 1, .cycles = 1, .exponent = 3};
  const double none[4] = {0}, minus[4] = {1, -1, 1, 1};
  assert_true(damage_by(context, &curve, BW_DIRLIK, none) == 0);
  check_fails(context, BW_INVALID, "spectral moment 2",
              bw_spectral_damage(context, &curve, BW_DIRLIK, minus, &rate));
}

/* ---- bodies ---------------------------------------------------------------------------------- */

static const double force[3] = {-100, 200, 300};

/* Von Mises stress as a vector of another basis than that of the engine. */
static void components(const double *s, double y[5]) {
  y[0] = sqrt(0.75) * (s[2] - s[1]);
  y[1] = 0.5 * (2 * s[0] - s[1] - s[2]);
  y[2] = sqrt(3.0) * s[5];
  y[3] = -sqrt(3.0) * s[3];
  y[4] = sqrt(3.0) * s[4];
}

/* Probabilities, rates and moments are those of sums over many frequencies of the fields. */
static void fields(void **state) {
  bw_context *context = check_context(state);
  enum { STEPS = 3000 };
  bw_mesh *mesh = body_box(context, 0.3, 0.05, 0.04, 3, 1, 1, 2);
  bw_model *model = body_bar(context, mesh, 0.3, force);
  int nodes = mesh->node_count;
  const double at[2] = {100, 2500}, density[2] = {1e3, 1e3};
  bw_harmonic_options options;
  bw_harmonic_options_default(&options);
  options.to = 2500;
  options.damping.loss = 0.06;
  bw_harmonic *h = NULL;
  check_ok(context, bw_harmonic_of_model(context, model, NULL, &options, NULL, &h));
  double *probability = numbers(nodes), *rate = numbers(nodes), *used = numbers(nodes),
         *more = numbers(nodes), *damage = numbers(nodes), *moment = numbers(4 * nodes),
         *mises = numbers(nodes), *re = numbers(6 * nodes), *im = numbers(6 * nodes);
  double *sum = numbers(75 * (int64_t)nodes), *powers = numbers(4 * (int64_t)nodes);
  check_ok(context, bw_harmonic_random(context, h, 2, at, density, NULL, mises, NULL, NULL));
  double most = 0;
  for (int i = 0; i < nodes; i++)
    most = fmax(most, mises[i]);
  double strength = 2.5 * most;
  bw_life_curve curve = {.amplitude = most, .cycles = 1e6, .exponent = 4};
  check_ok(context, bw_harmonic_margins(context, h, 2, at, density, strength, 3, probability, rate,
                                        used, more));
  check_ok(context, bw_harmonic_random_damage(context, h, 2, at, density, &curve, damage, moment));
  for (int k = 0; k < STEPS; k++) {
    double f = 100 + 2400 * (k + 0.5) / STEPS, w = 2 * M_PI * f, weight = 1e3 * 2400.0 / STEPS;
    check_ok(context, bw_harmonic_stress(context, h, f, re, im, NULL));
    for (int i = 0; i < nodes; i++) {
      double a[5], b[5], *own = sum + 75 * i, square = 0;
      components(re + 6 * i, a);
      components(im + 6 * i, b);
      for (int q = 0; q < 5; q++)
        for (int p = 0; p < 5; p++) {
          double product = weight * (a[p] * a[q] + b[p] * b[q]);
          square += p == q ? product : 0;
          own[5 * q + p] += product;
          own[25 + 5 * q + p] += w * w * product;
          own[50 + 5 * q + p] += w * weight * (a[p] * b[q] - b[p] * a[q]);
        }
      for (int m = 0; m < 4; m++)
        powers[4 * i + m] += square * pow(f, m < 3 ? m : 4);
    }
  }
  int turning = 0;
  for (int i = 0; i < nodes; i++) {
    double *own = sum + 75 * i;
    for (int m = 0; m < 4; m++)
      check_near(moment[4 * i + m], powers[4 * i + m], 1e-3 * powers[4 * i + m]);
    check_near(moment[4 * i], mises[i] * mises[i], 1e-9 * mises[i] * mises[i]);
    check_near(used[i], 3 * mises[i] / strength, 1e-9);
    bwi_exceedance e = exceed(5, own, own + 25, own + 50, strength);
    bwi_exceedance still = exceed(5, own, own + 25, NULL, strength);
    check_near(probability[i], e.probability, 0.01 * e.probability + 1e-30);
    check_near(rate[i], e.rate, 0.01 * e.rate + 1e-30);
    turning += fabs(still.rate - e.rate) > 0.03 * e.rate; /* the cross covariances count */
    check_near(more[i], exceed(5, own, own + 25, own + 50, 3 * mises[i]).probability,
               0.01 * more[i]);
    /* one component has 0.0027, more of them less */
    assert_true(more[i] < 0.0028 && more[i] > 1e-7);
    double one = damage_by(context, &curve, BW_DIRLIK, moment + 4 * i);
    check_near(damage[i], one, 1e-12 * one);
  }
  assert_true(turning > 0);
  /* the material's strength, 400 MPa, in the place of none */
  check_ok(context,
           bw_harmonic_margins(context, h, 2, at, density, 0, 1, probability, rate, used, more));
  for (int i = 0; i < nodes; i++)
    check_near(used[i], mises[i] / 4e8, 1e-12);
#define REFUSED(what, strength, sigma)                                                             \
  check_fails(context, BW_INVALID, what,                                                           \
              bw_harmonic_margins(context, h, 2, at, density, strength, sigma, probability, rate,  \
                                  used, more))
  REFUSED("strength is -1", -1, 3);
  REFUSED("sigma is 0", 1, 0);
#undef REFUSED
  void *none = NULL;
  check_ok(context, bw_set_threads(context, 1));
  check_allocations(
      context, none,
      bw_harmonic_margins(context, h, 2, at, density, strength, 3, probability, rate, used, more));
  check_allocations(context, none,
                    bw_harmonic_random_damage(context, h, 2, at, density, &curve, damage, moment));
  free(probability);
  free(rate);
  free(used);
  free(more);
  free(damage);
  free(moment);
  free(mises);
  free(re);
  free(im);
  free(sum);
  free(powers);
  bw_release(h);
  bw_release(model);
  bw_release(mesh);
}

int main(void) {
  const struct CMUnitTest tests[] = {check_test(probabilities), check_test(random_numbers),
                                     check_test(rates),         check_test(spectral_damage),
                                     check_test(narrow_band),   check_test(fields)};
  return cmocka_run_group_tests(tests, NULL, NULL);
}
