/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* Materials of elements: Lame's constants, what counts as uniform, what is refused, material
 * tables. */
#include "nonlinear/solids.h"

static void test_constants(void **state) {
  bw_context *context = check_context(state);
  bw_solid_material *m = NULL;
  check_ok(context,
           bw_solid_material_create(context, NULL, BW_FIXED_COROTATED, 2.6e6, 0.3, 900, &m));
  assert_string_equal(m->name, "fixed_corotated");
  assert_true(m->uniform && m->fibre_count == 0 && m->density == 900 && m->rule->count == 8);
  for (int q = 0; q < 8; q++) {
    assert_int_equal(m->law[q], BW_FIXED_COROTATED);
    check_near(m->mu[q], 1e6, 1e-8);
    check_near(m->lambda[q], 1.5e6, 1e-8);
  }
  assert_true(bw_bytes(m) >= sizeof *m + 8 * 17);
  bw_release(m);
  m = solids_mixed(context, BW_COROTATED, 1, 1, 3);
  assert_true(!m->uniform && m->fibre_count == 1);
  bw_release(m);
}

static void test_refused(void **state) {
  bw_context *context = check_context(state);
  bw_solid_material *m = NULL;
  check_fails(context, BW_INVALID, "Young's modulus is -1",
              bw_solid_material_create(context, "it", BW_COROTATED, -1, 0.3, 0, &m));
  check_fails(context, BW_INVALID, "Young's modulus",
              bw_solid_material_create(context, "it", BW_COROTATED, NAN, 0.3, 0, &m));
  check_fails(context, BW_INVALID, "below 0.5",
              bw_solid_material_create(context, "it", BW_COROTATED, 1, 0.5, 0, &m));
  check_fails(context, BW_INVALID, "above -1",
              bw_solid_material_create(context, "it", BW_COROTATED, 1, -1, 0, &m));
  check_fails(context, BW_INVALID, "density is -3",
              bw_solid_material_create(context, "it", BW_COROTATED, 1, 0.3, -3, &m));
  check_fails(context, BW_INVALID, "no law 17",
              bw_solid_material_create(context, "it", (bw_law)17, 1, 0.3, 0, &m));
  bw_rule *rule = NULL;
  uint8_t law[8] = {0};
  double mu[8] = {1, 1, 1, 1, 1, 1, 1, 1}, lambda[8] = {0}, stiffness[8] = {0}, v[24];
  check_ok(context, bw_rule_create(context, 1, &rule));
  for (int i = 0; i < 24; i++)
    v[i] = i % 3 == 0;
  mu[4] = -1;
  check_fails(context, BW_INVALID, "point 5",
              bw_solid_material_points(context, "it", rule, 0, law, mu, lambda, 0, NULL, NULL, &m));
  mu[4] = 1;
  lambda[2] = -1;
  check_fails(context, BW_INVALID, "point 3",
              bw_solid_material_points(context, "it", rule, 0, law, mu, lambda, 0, NULL, NULL, &m));
  lambda[2] = 0;
  law[7] = BW_LAWS;
  check_fails(context, BW_INVALID, "point 8",
              bw_solid_material_points(context, "it", rule, 0, law, mu, lambda, 0, NULL, NULL, &m));
  law[7] = 0;
  v[3] = 1.01;
  check_fails(
      context, BW_INVALID, "length 1.01",
      bw_solid_material_points(context, "it", rule, 0, law, mu, lambda, 1, stiffness, v, &m));
  v[3] = 1;
  stiffness[6] = -2;
  check_fails(
      context, BW_INVALID, "stiffness -2",
      bw_solid_material_points(context, "it", rule, 0, law, mu, lambda, 1, stiffness, v, &m));
  check_fails(
      context, BW_INVALID, "4 fibres",
      bw_solid_material_points(context, "it", rule, 0, law, mu, lambda, 4, stiffness, v, &m));
  assert_null(m);
  bw_release(rule);
}

static void test_material_table(void **state) {
  bw_context *context = check_context(state);
  bw_material_table *material_table = NULL;
  check_fails(context, BW_INVALID, "beside void",
              bw_material_table_create(context, 1, NULL, &material_table));
  check_each_allocation(context, status, 1) {
    bw_solid_material *m = NULL;
    status = bw_solid_material_create(context, "it", BW_NEO_HOOKEAN, 1, 0.3, 0, &m);
    if (status == BW_OK)
      status = bw_material_table_create(context, 2, (const bw_solid_material *const *)&m,
                                        &material_table);
    bw_release(m);
  }
  assert_null(material_table->material[0]);
  assert_string_equal(material_table->material[1]->name, "it");
  bw_release(material_table);
}

check_main(check_test(test_constants), check_test(test_refused), check_test(test_material_table))
