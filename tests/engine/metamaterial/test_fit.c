/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* Fits of blocks: what must come out exactly, what closed forms say, what symmetry demands. */
#include "check.h"
#include "metamaterial/internal.h"
#include "metamaterial/keys.h"
#include "metamaterial/nnls.h"

enum { MATERIALS = 4 };

typedef struct kit {
  bw_solid_material *material[MATERIALS]; /* 0: void; 1e5, 1e6, 1e7 Pa */
  bw_library_options options;
  bwi_fit_workspace *workspace;
} kit;

static kit kit_of(bw_context *context, int directions) {
  kit k = {.options = {.directions = directions,
                       .magnitudes = 5,
                       .stretches = 100,
                       .fibres = 3,
                       .strain = 0.1,
                       .ridge = 0.01}};
  for (int i = 1; i < MATERIALS; i++)
    check_ok(context, bw_solid_material_create(context, "it", BW_NEO_HOOKEAN, 1e4 * pow(10, i),
                                               0.45, 1000, &k.material[i]));
  check_ok(context, bwi_fit_workspace_create(context, &k.options, &k.workspace));
  return k;
}

static void kit_free(kit *k) {
  for (int i = 0; i < MATERIALS; i++)
    bw_release(k->material[i]);
  bwi_fit_workspace_destroy(k->workspace);
}

static bwi_block block_of(const kit *k, const char *key) {
  bwi_block block = {.size = {2, 2, 2}};
  for (int c = 0; c < 8; c++)
    block.child[c] = k->material[key[c] - '0'];
  return block;
}

static bw_solid_material *fit(bw_context *context, kit *k, const char *key, bw_fit_error *error) {
  bwi_block block = block_of(k, key);
  bw_solid_material *fitted = NULL;
  check_ok(context, bwi_fit(context, &block, &k->options, 7, k->workspace, &fitted, error));
  return fitted;
}

/* Strain energy of a unit cell whose corners follow a uniform small strain, times 2. */
static double modulus(const bw_solid_material *m, const double strain[9]) {
  double stiffness[576], u[24], sum = 0;
  bwi_material_stiffness(m, stiffness);
  for (int c = 0; c < 8; c++)
    for (int i = 0; i < 3; i++) {
      u[3 * c + i] = 0;
      for (int j = 0; j < 3; j++)
        u[3 * c + i] += strain[3 * i + j] * (c >> j & 1);
    }
  for (int i = 0; i < 24; i++)
    for (int j = 0; j < 24; j++)
      sum += u[i] * stiffness[24 * i + j] * u[j];
  return sum;
}

/* A negative Poisson's ratio is beyond constants that are not negative: the naive material stays,
 * which a block of one material is. */
static void an_auxetic_block_is_left_as_it_is(void **state) {
  bw_context *context = check_context(state);
  kit k = kit_of(context, 20);
  bw_fit_error error;
  bw_release(k.material[1]);
  check_ok(context, bw_solid_material_create(context, "auxetic", BW_NEO_HOOKEAN, 1e5, -0.5, 1000,
                                             &k.material[1]));
  bw_solid_material *fitted = fit(context, &k, "11111111", &error);
  for (int p = 0; p < 8; p++) {
    assert_true(fitted->mu[p] == k.material[1]->mu[p]);
    assert_true(fitted->lambda[p] == k.material[1]->lambda[p]);
  }
  assert_int_equal(fitted->fibre_count, 0);
  assert_true(error.median == error.naive_median && error.force == error.naive_force);
  bw_release(fitted);
  kit_free(&k);
}

static void a_homogeneous_block_keeps_its_moduli(void **state) {
  bw_context *context = check_context(state);
  kit k = kit_of(context, 40);
  bw_fit_error error;
  bw_solid_material *fitted = fit(context, &k, "22222222", &error);
  const double stretch[9] = {1}, shear[9] = {0, 0.5, 0, 0.5, 0, 0, 0, 0, 0};
  const double swell[9] = {1, 0, 0, 0, 1, 0, 0, 0, 1};
  check_near(modulus(fitted, stretch) / modulus(k.material[2], stretch), 1, 0.04);
  check_near(modulus(fitted, shear) / modulus(k.material[2], shear), 1, 0.04);
  check_near(modulus(fitted, swell) / modulus(k.material[2], swell), 1, 0.04);
  assert_true(error.median < 0.03);
  assert_true(error.median < error.naive_median / 3);
  assert_true(error.force < error.naive_force / 2);
  assert_int_equal(fitted->rule->count, 8);
  assert_true(fitted->rule->spread[0] < 1); /* bends more easily than a trilinear cell */
  check_near(fitted->density, 1000, 1e-9);
  bw_release(fitted);
  kit_free(&k);
}

/* Layers normal to z of M' = lambda + 2 mu each half: in series across and in shear across; in
 * parallel along. Plane strain of a laminate: C33 = <1/M'>^-1, C44 = <1/mu>^-1, C66 = <mu>,
 * C11 = <4 mu (lambda + mu) / M'> + <lambda / M'>^2 <1/M'>^-1. */
static void layers_are_a_laminate(void **state) {
  bw_context *context = check_context(state);
  kit k = kit_of(context, 60);
  bw_fit_error error;
  bw_solid_material *fitted = fit(context, &k, "11113333", &error);
  double mu[2] = {k.material[1]->mu[0], k.material[3]->mu[0]};
  double lambda[2] = {k.material[1]->lambda[0], k.material[3]->lambda[0]};
  double series = 0, shear = 0, along = 0, plane = 0, coupling = 0;
  for (int i = 0; i < 2; i++) {
    double m = lambda[i] + 2 * mu[i];
    series += 0.5 / m;
    shear += 0.5 / mu[i];
    along += 0.5 * mu[i];
    plane += 0.5 * 4 * mu[i] * (lambda[i] + mu[i]) / m;
    coupling += 0.5 * lambda[i] / m;
  }
  const double across[9] = {0, 0, 0, 0, 0, 0, 0, 0, 1}, out[9] = {0, 0, 0.5, 0, 0, 0, 0.5, 0, 0};
  const double in[9] = {0, 0.5, 0, 0.5, 0, 0, 0, 0, 0}, x[9] = {1};
  check_near(modulus(fitted, across) * series, 1, 0.25);
  check_near(modulus(fitted, out) * shear, 1, 0.3);
  check_near(modulus(fitted, in) / along, 1, 0.15);
  check_near(modulus(fitted, x) / (plane + coupling * coupling / series), 1, 0.15);
  /* naive: everything in parallel */
  assert_true(modulus(k.material[3], across) / 2 * series > 20);
  assert_true(error.median < 0.1 && error.median < error.naive_median / 50);
  bw_release(fitted);
  kit_free(&k);
}

/* The stiffness that the linear part of a fit aims at is exact for a laminate. */
static void condensing_is_exact_for_laminates(void **state) {
  bw_context *context = check_context(state);
  kit k = kit_of(context, 1);
  double own[2][576], block[576];
  const double *child[8];
  const int32_t size[3] = {2, 2, 2};
  bwi_material_stiffness(k.material[1], own[0]);
  bwi_material_stiffness(k.material[3], own[1]);
  for (int c = 0; c < 8; c++)
    child[c] = own[c >> 2];
  bwi_block_stiffness(size, child, block);
  double u[24] = {0}, sum = 0, m[2];
  for (int c = 4; c < 8; c++)
    u[3 * c + 2] = 1; /* cells of side 1: strain 1/2 in a volume of 8 */
  for (int i = 0; i < 24; i++)
    for (int j = 0; j < 24; j++)
      sum += u[i] * block[24 * i + j] * u[j];
  for (int i = 0; i < 2; i++)
    m[i] = k.material[2 * i + 1]->lambda[0] + 2 * k.material[2 * i + 1]->mu[0];
  check_near(sum / 2 * (0.5 / m[0] + 0.5 / m[1]), 1, 1e-6);
  kit_free(&k);
}

static void fits_beat_naive_coarsening(void **state) {
  bw_context *context = check_context(state);
  kit k = kit_of(context, 40);
  static const char *const key[] = {"11111113", "11331133", "13311331", "12312312", "11113333"};
  for (size_t i = 0; i < sizeof key / sizeof *key; i++) {
    bw_fit_error error;
    bw_solid_material *fitted = fit(context, &k, key[i], &error);
    if (!(error.median < error.naive_median / 3) || !(error.force < error.naive_force / 3))
      fail_msg("%s: energy %g, naive %g; force %g, naive %g", key[i], error.median,
               error.naive_median, error.force, error.naive_force);
    assert_true(error.samples > 150);
    bw_release(fitted);
  }
  kit_free(&k);
}

/* A block that a symmetry leaves alone gives a material that it leaves alone; a mirrored block's
 * linear response is the mirrored one's. */
static void symmetries_are_kept(void **state) {
  bw_context *context = check_context(state);
  kit k = kit_of(context, 20);
  static const char *const key[] = {"22222222", "11113333", "13311331", "11111113"};
  for (size_t i = 0; i < sizeof key / sizeof *key; i++) {
    bw_solid_material *fitted = fit(context, &k, key[i], NULL);
    double stiffness[576], turned[576];
    int kept = 0;
    bwi_material_stiffness(fitted, stiffness);
    for (int s = 0; s < BWI_SYMMETRIES; s++) {
      bool same = true;
      for (int c = 0; c < 8; c++)
        same = same && key[i][c] == key[i][bwi_symmetry_octant(bwi_symmetry_of(s), c)];
      if (!same)
        continue;
      kept++;
      bwi_symmetry_stiffness(s, stiffness, turned);
      for (int j = 0; j < 576; j++)
        check_near(turned[j], stiffness[j], 1e-7 * stiffness[0]);
    }
    assert_true(kept > 1);
    bw_release(fitted);
  }
  kit_free(&k);
}

static void the_same_again(void **state) {
  bw_context *context = check_context(state);
  kit k = kit_of(context, 20);
  bw_fit_error error[2];
  bw_solid_material *first = fit(context, &k, "12312312", &error[0]);
  bw_release(fit(context, &k, "11113333", NULL)); /* the workspace remembers nothing */
  bw_solid_material *second = fit(context, &k, "12312312", &error[1]);
  assert_memory_equal(first->mu, second->mu, 8 * sizeof(double));
  assert_memory_equal(first->lambda, second->lambda, 8 * sizeof(double));
  assert_int_equal(first->fibre_count, second->fibre_count);
  assert_memory_equal(first->fibre_stiffness, second->fibre_stiffness,
                      8 * (size_t)first->fibre_count * sizeof(double));
  assert_memory_equal(&error[0], &error[1], sizeof error[0]);
  bw_release(first);
  bw_release(second);
  kit_free(&k);
}

static void blocks_with_void(void **state) {
  bw_context *context = check_context(state);
  kit k = kit_of(context, 12);
  static const char *const key[] = {"22220000", "20000000", "22202220",
                                    "20000002" /* a corner holds them */, "30000200" /* an edge */};
  for (size_t i = 0; i < sizeof key / sizeof *key; i++) {
    bw_fit_error error;
    bw_solid_material *fitted = fit(context, &k, key[i], &error);
    for (int p = 0; p < 8; p++) {
      assert_true(fitted->mu[p] > 0 && isfinite(fitted->mu[p]));
      assert_true(isfinite(fitted->lambda[p]));
      assert_int_equal(fitted->law[p], key[i][p] == '0' ? BWI_VOID_LAW : BW_NEO_HOOKEAN);
    }
    assert_true(isfinite(error.median) && isfinite(error.worst));
    bw_release(fitted);
  }
  bwi_block block = block_of(&k, "00000000");
  bw_solid_material *none = NULL;
  check_fails(context, BW_EMPTY, "void",
              bwi_fit(context, &block, &k.options, 1, k.workspace, &none, NULL));
  check_fails(context, BW_EMPTY, "void", bwi_fit_naive(context, &block, &none));
  block.size[0] = 1;
  check_fails(context, BW_INVALID, "1 x 2 x 2",
              bwi_fit(context, &block, &k.options, 1, k.workspace, &none, NULL));
  assert_null(none);
  kit_free(&k);
}

/* Fitted materials are children again. */
static void blocks_of_fitted_materials(void **state) {
  bw_context *context = check_context(state);
  kit k = kit_of(context, 20);
  bw_solid_material *layers = fit(context, &k, "11113333", NULL), *coarse = NULL, *naive = NULL;
  bw_fit_error error;
  bwi_block block = {.size = {2, 2, 2}};
  for (int c = 0; c < 8; c++)
    block.child[c] = layers;
  check_ok(context, bwi_fit(context, &block, &k.options, 3, k.workspace, &coarse, &error));
  check_ok(context, bwi_fit_naive(context, &block, &naive));
  assert_int_equal(coarse->rule->count, 8);
  assert_int_equal(naive->rule->count, 64);
  const double in[9] = {0, 0.5, 0, 0.5, 0, 0, 0, 0, 0}, x[9] = {1};
  check_near(modulus(coarse, in) / modulus(layers, in), 1, 0.1);
  check_near(modulus(coarse, x) / modulus(layers, x), 1, 0.1);
  assert_true(error.median < error.naive_median);
  bw_release(coarse);
  bw_release(naive);
  bw_release(layers);
  kit_free(&k);
}

static void other_laws(void **state) {
  bw_context *context = check_context(state);
  kit k = kit_of(context, 15);
  for (int law = BW_ST_VENANT_KIRCHHOFF; law < BW_LAWS; law++) {
    bw_solid_material *own[2], *fitted = NULL;
    bwi_block block = {.size = {2, 2, 2}};
    bw_fit_error error;
    for (int i = 0; i < 2; i++)
      check_ok(context, bw_solid_material_create(context, "own", (bw_law)law, i ? 1e7 : 1e6, 0.3, 0,
                                                 &own[i]));
    for (int c = 0; c < 8; c++)
      block.child[c] = own[c & 1];
    check_ok(context, bwi_fit(context, &block, &k.options, 3, k.workspace, &fitted, &error));
    assert_int_equal(fitted->law[0], law);
    assert_true(error.median < 0.15 && error.median < error.naive_median / 3);
    bw_release(fitted);
    bw_release(own[0]);
    bw_release(own[1]);
  }
  kit_free(&k);
}

static void memory_that_runs_out(void **state) {
  bw_context *context = check_context(state);
  kit k = kit_of(context, 2);
  bwi_block block = block_of(&k, "12121212");
  bool passed = false;
  for (int64_t n = 1; n < 200 && !passed; n++) {
    bwi_fit_workspace *workspace = NULL;
    bw_solid_material *fitted = NULL;
    bw_fit_error error;
    bw_fail_allocation(n, true);
    bw_status status = bwi_fit_workspace_create(context, &k.options, &workspace);
    if (status == BW_OK)
      status = bwi_fit(context, &block, &k.options, 1, workspace, &fitted, &error);
    bw_fail_allocation(0, false);
    passed = status == BW_OK;
    assert_true(passed || status == BW_MEMORY);
    assert_true(passed == (fitted != NULL));
    bw_release(fitted);
    bwi_fit_workspace_destroy(workspace);
  }
  assert_true(passed);
  kit_free(&k);
}

/* ---- non-negative least squares -------------------------------------------------------------- */

/* Karush, Kuhn and Tucker: x >= 0, no slope where x > 0, none upwards where x = 0. */
static void nnls_is_optimal(void **state) {
  (void)state;
  enum { ROWS = 30, MAX = 20 };
  bw_random random;
  bw_random_seed(&random, 5);
  for (int trial = 0; trial < 50; trial++) {
    int n = 1 + trial % MAX;
    double a[ROWS][MAX], b[ROWS], g[MAX * MAX], h[MAX], x[MAX], work[BWI_NNLS_WORK(MAX)];
    for (int r = 0; r < ROWS; r++) {
      b[r] = bw_random_normal(&random);
      for (int j = 0; j < n; j++)
        a[r][j] = bw_random_normal(&random) + (trial % 3 == 0 ? 3 : 0); /* nearly parallel, too */
    }
    for (int i = 0; i < n; i++) {
      h[i] = 0;
      for (int j = 0; j < n; j++)
        g[i * n + j] = 0;
      for (int r = 0; r < ROWS; r++) {
        h[i] += a[r][i] * b[r];
        for (int j = 0; j < n; j++)
          g[i * n + j] += a[r][i] * a[r][j];
      }
    }
    bwi_nnls(n, g, h, NULL, NULL, 0, x, work);
    for (int i = 0; i < n; i++) {
      double slope = -h[i];
      for (int j = 0; j < n; j++)
        slope += g[i * n + j] * x[j];
      assert_true(x[i] >= 0);
      if (x[i] > 0)
        check_near(slope, 0, 1e-8);
      else
        assert_true(slope > -1e-6);
    }
  }
}

static void nnls_keeps_the_limit(void **state) {
  (void)state;
  /* three equal, orthogonal columns in one group that holds two, sizes 1 1 2 */
  const double g[9] = {1, 0, 0, 0, 1, 0, 0, 0, 1}, h[3] = {3, 2, 2.5};
  const int32_t group[3] = {0, 0, 0}, size[3] = {1, 1, 2};
  double x[3], work[BWI_NNLS_WORK(3)];
  bwi_nnls(3, g, h, group, size, 2, x, work);
  check_near(x[0], 3, 1e-12);
  check_near(x[1], 2, 1e-12);
  check_near(x[2], 0, 0);
  bwi_nnls(3, g, h, group, size, 4, x, work);
  check_near(x[2], 2.5, 1e-12);
}

check_main(check_test(an_auxetic_block_is_left_as_it_is),
           check_test(a_homogeneous_block_keeps_its_moduli), check_test(layers_are_a_laminate),
           check_test(condensing_is_exact_for_laminates), check_test(fits_beat_naive_coarsening),
           check_test(symmetries_are_kept), check_test(the_same_again),
           check_test(blocks_with_void), check_test(blocks_of_fitted_materials),
           check_test(other_laws), check_test(memory_that_runs_out), check_test(nnls_is_optimal),
           check_test(nnls_keeps_the_limit))
