/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* The library of materials: the worst-case paper's values, and a source for every number. */
#include "check.h"

static void library_has_the_papers_values(void **state) {
  bw_context *context = check_context(state);
  bw_material *m = NULL;
  check_ok(context, bw_material_named(context, "zp150", &m));
  assert_false(m->isotropic);
  check_near(m->young[0], 1.22e9, 0);
  check_near(m->young[2], 0.234e9, 0);
  check_near(m->young_value[1].scatter, 0.07e9, 0);
  /* G_xy = Ex Ey / (Ex + Ey + 2 Ey nu_xy), and alike for yz and xz, with 0.3 in all three */
  double x = 1.22e9, y = 0.68e9, z = 0.234e9;
  check_near(m->shear[2], x * y / (x + y + 0.6 * y), 1e-3);
  check_near(m->shear[0], y * z / (y + z + 0.6 * z), 1e-3);
  check_near(m->shear[1], x * z / (x + z + 0.6 * z), 1e-3);
  check_near(m->poisson[2], 0.3, 1e-15);
  check_near(m->poisson[0], 0.3, 1e-15);
  check_near(m->poisson[1] * x / z, 0.3, 1e-15); /* nu13 */
  bw_release(m);

  check_ok(context, bw_material_named(context, "green_state_stainless_steel", &m));
  check_near(m->young[0], 3.59e9, 0);
  check_near(m->strength[0], 6.88e6, 0);
  check_near(m->strength_value[0].scatter, 0.62e6, 0);
  assert_string_equal(m->name, "green_state_stainless_steel");
  bw_release(m);
  check_fails(context, BW_INVALID, "zp150", bw_material_named(context, "unobtainium", &m));
}

/* Values a reader can look up. */
static void well_known_values(void **state) {
  bw_context *context = check_context(state);
  static const struct {
    const char *name;
    double young, poisson, density, strength;
  } known[] = {
      {"steel", 210e9, 0.3, 7850, 235e6},
      {"aluminium", 70e9, 0.3, 2700, 240e6},
      {"pla", 3.6e9, 0.36, 1240, 53e6},
  };
  for (int i = 0; i < 3; i++) {
    bw_material *m = NULL;
    check_ok(context, bw_material_named(context, known[i].name, &m));
    assert_true(m->isotropic);
    check_near(m->young[0], known[i].young, 0);
    check_near(m->poisson[0], known[i].poisson, 0);
    check_near(m->density, known[i].density, 0);
    check_near(m->strength[2], known[i].strength, 0);
    bw_release(m);
  }
}

/* L = (K_Ic / strength)^2 / pi */
static void critical_distances(void **state) {
  bw_context *context = check_context(state);
  bw_material *m = NULL;
  check_ok(context, bw_material_named(context, "aluminium", &m));
  check_near(m->toughness, 29e6, 0);
  check_near(bw_material_critical_distance(m), 29. * 29 / 240 / 240 / 3.14159265358979324, 1e-15);
  bw_value L = bw_material_critical_distance_value(m);
  check_near(L.mean, bw_material_critical_distance(m), 0);
  check_near(L.scatter, 2 * L.mean * 3.8 / 29, 1e-12 * L.mean); /* no scatter of the strength */
  assert_non_null(L.source);
  bw_release(m);
  /* of a library's strength with scatter too, the largest counts */
  check_ok(context, bw_material_named(context, "steel", &m));
  m->strength_value[0].scatter = 0.1 * m->strength[0];
  L = bw_material_critical_distance_value(m);
  check_near(L.scatter, 2 * L.mean * hypot(11.8 / 61.5, 0.1), 1e-12 * L.mean);
  bw_release(m);
  check_ok(context, bw_material_named(context, "pla", &m));
  check_near(bw_material_critical_distance(m), 0, 0);
  bw_release(m);
  const bw_isotropic bad = {.name = "x", .young = 1, .toughness = -1};
  check_fails(context, BW_INVALID, "fracture toughness is -1",
              bw_material_isotropic(context, &bad, &m));
}

static void every_library_value_names_its_source(void **state) {
  bw_context *context = check_context(state);
  assert_null(bw_material_library_name(-1));
  assert_null(bw_material_library_name(bw_material_library_count()));
  for (int i = 0; i < bw_material_library_count(); i++) {
    bw_material *m = NULL;
    check_ok(context, bw_material_named(context, bw_material_library_name(i), &m));
    for (int k = 0; k < 6; k++) { /* elasticity times compliance is the identity */
      double sum = 0;
      for (int j = 0; j < 6; j++)
        sum += m->elasticity[6 * k + j] * m->compliance[6 * j + k];
      check_near(sum, 1, 1e-13);
    }
    assert_true(m->density > 0 && m->density == m->density_value.mean);
    assert_non_null(m->density_value.source);
    for (int k = 0; k < 3; k++) {
      assert_non_null(m->young_value[k].source);
      assert_non_null(m->poisson_value[k].source);
      assert_non_null(m->strength_value[k].source);
      assert_true(m->young_value[k].mean == m->young[k]);
      assert_true(m->strength_value[k].mean == m->strength[k]);
    }
    /* a fracture toughness comes with source and scatter, or not at all */
    assert_true((m->toughness > 0) == (m->toughness_value.source != NULL));
    assert_true((m->toughness > 0) == (m->toughness_value.scatter > 0));
    bw_release(m);
  }
}

check_main(check_test(library_has_the_papers_values), check_test(well_known_values),
           check_test(critical_distances), check_test(every_library_value_names_its_source))
