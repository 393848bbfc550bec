/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* Symmetries of the cube, orbits of keys, and materials that are turned. */
#include "check.h"

#include "metamaterial/keys.h"

/* The symmetries form a group that acts on octants and vectors alike. */
static void test_group(void **state) {
  (void)state;
  int images[48][8];
  for (int s = 0; s < 48; s++) {
    bwi_symmetry a = bwi_symmetry_of(s);
    bool seen[8] = {false};
    for (int c = 0; c < 8; c++) {
      images[s][c] = bwi_symmetry_octant(a, c);
      assert_false(seen[images[s][c]]);
      seen[images[s][c]] = true;
      double from[3], to[3];
      for (int d = 0; d < 3; d++)
        from[d] = (c >> d & 1) - 0.5;
      bwi_symmetry_vector(a, from, to);
      for (int d = 0; d < 3; d++)
        assert_true(to[d] == (images[s][c] >> d & 1) - 0.5);
    }
    for (int t = 0; t < s; t++)
      assert_memory_not_equal(images[s], images[t], sizeof images[s]);
    assert_int_equal(bwi_symmetry_after(bwi_symmetry_inverse(s), s), 0);
    assert_int_equal(bwi_symmetry_after(s, bwi_symmetry_inverse(s)), 0);
  }
  for (int s = 0; s < 48; s++)
    for (int t = 0; t < 48; t++)
      for (int c = 0; c < 8; c++)
        assert_int_equal(images[bwi_symmetry_after(s, t)][c], images[s][images[t][c]]);
}

/* Burnside: colourings of a cube's corners with n colours, up to all 48 symmetries. */
static int64_t burnside(int n) {
  int64_t sum = 0;
  for (int s = 0; s < 48; s++) {
    int64_t fixed = 1;
    bool seen[8] = {false};
    for (int c = 0; c < 8; c++) {
      if (seen[c])
        continue;
      fixed *= n;
      for (int d = c; !seen[d]; d = bwi_symmetry_octant(bwi_symmetry_of(s), d))
        seen[d] = true;
    }
    sum += fixed;
  }
  return sum / 48;
}

static void test_orbits(void **state) {
  bw_context *context = check_context(state);
  bwi_keys *keys;
  assert_int_equal(burnside(3), 267);
  assert_int_equal(burnside(4), 1996);
  for (int base = 2; base <= 5; base++) {
    for (int voids = 0; voids < 2; voids++) {
      check_ok(context, bwi_keys_create(context, base, voids, true, &keys));
      assert_int_equal(keys->orbit_count, voids ? burnside(base) - 1 : burnside(base - 1));
      assert_int_equal(keys->orbit[0], -1);
      for (int32_t code = 1; code < keys->code_count; code++) {
        int32_t key[8], first[8], turned[8];
        bool empty = false;
        bwi_key_of(base, code, key);
        assert_int_equal(bwi_key_code(base, key), code);
        for (int c = 0; c < 8; c++)
          empty = empty || key[c] == 0;
        if (empty && !voids) {
          assert_int_equal(keys->orbit[code], -1);
          continue;
        }
        int32_t orbit = keys->orbit[code];
        assert_true(orbit >= 0 && keys->first[orbit] <= code);
        bwi_key_of(base, keys->first[orbit], first);
        bwi_symmetry_key(keys->symmetry[code], 8, first, turned);
        assert_memory_equal(turned, key, sizeof key);
      }
      bwi_keys_destroy(keys);
    }
  }
  check_fails(context, BW_LIMIT, "up to 7 materials",
              bwi_keys_create(context, 9, true, true, &keys));
  check_fails(context, BW_LIMIT, "up to 7 materials",
              bwi_keys_create(context, INT32_MAX, true, true, &keys));
  check_each_allocation(context, status, 1) {
    status = bwi_keys_create(context, 3, true, true, &keys);
  }
  bwi_keys_destroy(keys);
}

static bw_solid_material *random_material(bw_context *context, bw_random *random, int level,
                                          int fibres) {
  uint8_t law[64];
  double mu[64], lambda[64], stiffness[192], fibre[576], spread[3];
  bw_rule *rule;
  bw_solid_material *material;
  for (int d = 0; d < 3; d++)
    spread[d] = 0.5 + 0.5 * bw_random_uniform(random);
  check_ok(context, bw_rule_create_spread(context, level, spread, &rule));
  for (int p = 0; p < rule->count; p++) {
    law[p] = (uint8_t)(bw_random_bits(random) % BW_LAWS);
    mu[p] = bw_random_uniform(random);
    lambda[p] = bw_random_uniform(random);
  }
  for (int k = 0; k < rule->count * fibres; k++) {
    stiffness[k] = bw_random_uniform(random);
    for (int d = 0; d < 3; d++)
      fibre[3 * k + d] = bw_random_normal(random);
    double length = bw_norm(fibre + 3 * k);
    for (int d = 0; d < 3; d++)
      fibre[3 * k + d] /= length;
  }
  check_ok(context, bw_solid_material_points(context, "random", rule, 1000, law, mu, lambda, fibres,
                                             stiffness, fibre, &material));
  bw_release(rule);
  return material;
}

/* Energy of a unit cube whose corners are moved by u, by the definition. */
static double energy(const bw_solid_material *m, const double u[24]) {
  double sum = 0;
  for (int p = 0; p < m->rule->count; p++) {
    double f[9] = {1, 0, 0, 0, 1, 0, 0, 0, 1}, w;
    for (int c = 0; c < 8; c++)
      for (int i = 0; i < 3; i++)
        for (int j = 0; j < 3; j++)
          f[3 * i + j] += u[3 * c + i] * m->rule->gradient[24 * p + 3 * c + j];
    assert_true(
        bw_law_evaluate((bw_law)m->law[p], m->mu[p], m->lambda[p], f, false, &w, NULL, NULL));
    for (int k = 0; k < m->fibre_count; k++)
      bw_fibre_add(m->fibre_stiffness[p * m->fibre_count + k],
                   m->fibre + 3 * (p * m->fibre_count + k), f, false, &w, NULL, NULL);
    sum += m->rule->weight[p] * w;
  }
  return sum;
}

/* The turned material, deformed by the turned displacements, stores the same energy. */
static void test_turned(void **state) {
  bw_context *context = check_context(state);
  bw_random random;
  bw_random_seed(&random, 4);
  for (int round = 0; round < 4; round++) {
    bw_solid_material *m = random_material(context, &random, 1 + round % 2, round), *turned, *back;
    double u[24], v[24];
    for (int i = 0; i < 24; i++)
      u[i] = 0.1 * bw_random_normal(&random);
    double before = energy(m, u);
    for (int s = 0; s < 48; s++) {
      bwi_symmetry a = bwi_symmetry_of(s);
      for (int c = 0; c < 8; c++)
        bwi_symmetry_vector(a, u + 3 * c, v + 3 * bwi_symmetry_octant(a, c));
      check_ok(context, bwi_material_transformed(context, m, s, &turned));
      check_near(energy(turned, v) / before, 1, 1e-12);
      check_ok(context, bwi_material_transformed(context, turned, bwi_symmetry_inverse(s), &back));
      assert_memory_equal(back->mu, m->mu, (size_t)m->rule->count * sizeof(double));
      assert_memory_equal(back->rule->spread, m->rule->spread, sizeof m->rule->spread);
      bw_release(back);
      bw_release(turned);
    }
    bw_release(m);
  }
}

static void test_stiffness(void **state) {
  (void)state;
  double k[576], turned[576], u[24], v[24];
  bw_random random;
  bw_random_seed(&random, 6);
  for (int i = 0; i < 24; i++) {
    u[i] = bw_random_normal(&random);
    for (int j = 0; j <= i; j++)
      k[24 * i + j] = k[24 * j + i] = bw_random_normal(&random);
  }
  for (int s = 0; s < 48; s++) {
    bwi_symmetry a = bwi_symmetry_of(s);
    double before = 0, after = 0;
    for (int c = 0; c < 8; c++)
      bwi_symmetry_vector(a, u + 3 * c, v + 3 * bwi_symmetry_octant(a, c));
    bwi_symmetry_stiffness(s, k, turned);
    for (int i = 0; i < 24; i++)
      for (int j = 0; j < 24; j++) {
        before += u[i] * k[24 * i + j] * u[j];
        after += v[i] * turned[24 * i + j] * v[j];
      }
    check_near(after, before, 1e-12 * (1 + fabs(before)));
  }
}

check_main(check_test(test_group), check_test(test_orbits), check_test(test_turned),
           check_test(test_stiffness))
