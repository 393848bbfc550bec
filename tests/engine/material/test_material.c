/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* Material laws: closed forms, the reciprocal relation, positive definiteness, rotations, strength
 * by direction. */
#include "check.h"

static void make(bw_context *context, bw_material **material) {
  bw_orthotropic c = {.name = "test",
                      .young = {3e9, 2e9, 1e9},
                      .poisson = {0.35, 0.12, 0.3},
                      .shear = {0.7e9, 0.5e9, 0.9e9},
                      .strength = {30e6, 20e6, 10e6},
                      .density = 1100};
  check_ok(context, bw_material_orthotropic(context, &c, material));
}

/* elasticity times compliance is the identity */
static void check_inverse(const bw_material *m) {
  for (int i = 0; i < 6; i++)
    for (int j = 0; j < 6; j++) {
      double sum = 0;
      for (int k = 0; k < 6; k++)
        sum += m->elasticity[6 * i + k] * m->compliance[6 * k + j];
      check_near(sum, i == j, 1e-13);
      assert_true(m->elasticity[6 * i + j] == m->elasticity[6 * j + i]);
      assert_true(m->compliance[6 * i + j] == m->compliance[6 * j + i]);
    }
}

static void isotropic_constants(void **state) {
  bw_context *context = check_context(state);
  bw_material *m = NULL;
  bw_isotropic c = {"steel", 210e9, 0.3, 7850, 0, 0, 0};
  check_ok(context, bw_material_isotropic(context, &c, &m));
  check_near(m->lame_mu, 210e9 / 2.6, 1);
  check_near(m->lame_lambda, 210e9 * 0.3 / (1.3 * 0.4), 1);
  check_near(m->elasticity[0], m->lame_lambda + 2 * m->lame_mu, 1);
  check_inverse(m);
  double stress[6] = {1e6, 0, 0, 0, 0, 0};
  check_near(bw_material_utilisation(m, stress), 0, 0); /* strength not known */
  bw_release(m);
}

static void isotropic_refusals(void **state) {
  bw_context *context = check_context(state);
  bw_material *m = NULL;
  const double bad_young[] = {0, -1, NAN, INFINITY};
  for (int i = 0; i < 4; i++) {
    bw_isotropic c = {"x", bad_young[i], 0.3, 0, 0, 0, 0};
    check_fails(context, BW_INVALID, "Young", bw_material_isotropic(context, &c, &m));
  }
  const double bad_poisson[] = {0.5, -1, 0.7, NAN};
  for (int i = 0; i < 4; i++) {
    bw_isotropic c = {"x", 1e9, bad_poisson[i], 0, 0, 0, 0};
    check_fails(context, BW_INVALID, "Poisson", bw_material_isotropic(context, &c, &m));
  }
  bw_isotropic heavy = {"x", 1e9, 0.3, -3, 0, 0, 0}, weak = {"x", 1e9, 0.3, 0, NAN, 0, 0};
  check_fails(context, BW_INVALID, "density", bw_material_isotropic(context, &heavy, &m));
  check_fails(context, BW_INVALID, "strength", bw_material_isotropic(context, &weak, &m));
  assert_null(m);
}

/* The paper's compliance: uniaxial stress along i gives strain 1/Y_i, and -nu_ij/Y_i along j. */
static void orthotropic_compliance(void **state) {
  bw_context *context = check_context(state);
  bw_material *m = NULL;
  make(context, &m);
  const double *s = m->compliance;
  check_near(s[0] * 3e9, 1, 1e-14);
  check_near(s[7] * 2e9, 1, 1e-14);
  check_near(s[14] * 1e9, 1, 1e-14);
  check_near(s[6 * 2 + 1] * 2e9, -0.35, 1e-14); /* load 2, contraction 3: nu23 */
  check_near(s[6 * 0 + 2] * 1e9, -0.12, 1e-14); /* load 3, contraction 1: nu31 */
  check_near(s[6 * 1 + 0] * 3e9, -0.3, 1e-14);  /* load 1, contraction 2: nu12 */
  check_near(s[21] * 0.7e9, 1, 1e-14);
  check_near(s[28] * 0.5e9, 1, 1e-14);
  check_near(s[35] * 0.9e9, 1, 1e-14);
  check_inverse(m);
  bw_release(m);
}

static void orthotropic_with_equal_constants_is_isotropic(void **state) {
  bw_context *context = check_context(state);
  bw_material *m = NULL, *iso = NULL;
  double a = 0.7;
  bw_orthotropic c = {.young = {2e9, 2e9, 2e9},
                      .poisson = {0.3, 0.3, 0.3},
                      .axes = {cos(a), sin(a), 0, -sin(a), cos(a), 0, 0, 0, 1}};
  bw_isotropic i = {"iso", 2e9, 0.3, 0, 0, 0, 0};
  check_ok(context, bw_material_orthotropic(context, &c, &m));
  check_ok(context, bw_material_isotropic(context, &i, &iso));
  /* the paper's shear formula gives Y / (2 (1 + nu)) */
  check_near(m->shear[0], iso->lame_mu, 1e-6);
  for (int k = 0; k < 36; k++)
    check_near(m->elasticity[k], iso->elasticity[k], 1e-14 * 2e9);
  bw_release(m);
  bw_release(iso);
}

static void reciprocal_relation(void **state) {
  bw_context *context = check_context(state);
  bw_material *m = NULL;
  bw_orthotropic c = {.name = "test", .young = {3e9, 2e9, 1e9}, .poisson_t = {0.1, 0.36, 0.2}};
  check_ok(context, bw_material_orthotropic(context, &c, &m));
  check_near(m->poisson[0], 0.1 * 2 / 1, 1e-15);  /* nu23 = nu32 Y2/Y3 */
  check_near(m->poisson[1], 0.36 * 1 / 3, 1e-15); /* nu31 = nu13 Y3/Y1 */
  check_near(m->poisson[2], 0.2 * 3 / 2, 1e-15);  /* nu12 = nu21 Y1/Y2 */
  bw_release(m);
  c.poisson[2] = 0.3; /* both, and they agree */
  check_ok(context, bw_material_orthotropic(context, &c, &m));
  bw_release(m);
  c.poisson[2] = 0.2;
  m = NULL;
  check_fails(context, BW_INVALID, "nu12 = 0.2 and nu21 = 0.2 contradict",
              bw_material_orthotropic(context, &c, &m));
  assert_null(m);
}

static void indefinite_constants_are_refused(void **state) {
  bw_context *context = check_context(state);
  bw_material *m = NULL;
  bw_orthotropic pairwise = {.young = {1e9, 4e9, 1e9}, .poisson = {0, 0, 0.6}, .shear = {1, 1, 1}};
  check_fails(context, BW_INVALID, "nu12 = 0.6", bw_material_orthotropic(context, &pairwise, &m));
  /* every pair is fine, all three together are not: 1 - 3 nu^2 - 2 nu^3 = -0.1 */
  bw_orthotropic whole = {.young = {1e9, 1e9, 1e9}, .poisson = {0.52, 0.52, 0.52}};
  check_fails(context, BW_INVALID, "positive definite",
              bw_material_orthotropic(context, &whole, &m));
  bw_orthotropic shear = {.young = {1e9, 1e9, 1e9}, .shear = {1e9, -1, 1e9}};
  check_fails(context, BW_INVALID, "G31", bw_material_orthotropic(context, &shear, &m));
  bw_orthotropic young = {.young = {1e9, 0, 1e9}};
  check_fails(context, BW_INVALID, "Y2", bw_material_orthotropic(context, &young, &m));
  assert_null(m);
}

static void axes_must_be_a_rotation(void **state) {
  bw_context *context = check_context(state);
  bw_material *m = NULL;
  bw_orthotropic mirrored = {.young = {1e9, 1e9, 1e9}, .axes = {1, 0, 0, 0, 1, 0, 0, 0, -1}};
  check_fails(context, BW_INVALID, "left-handed", bw_material_orthotropic(context, &mirrored, &m));
  bw_orthotropic skew = {.young = {1e9, 1e9, 1e9}, .axes = {1, 0, 0, 0.1, 1, 0, 0, 0, 1}};
  check_fails(context, BW_INVALID, "right angles", bw_material_orthotropic(context, &skew, &m));
  bw_orthotropic nan = {.young = {1e9, 1e9, 1e9}, .axes = {NAN, 0, 0, 0, 1, 0, 0, 0, 1}};
  check_fails(context, BW_INVALID, "unit vectors", bw_material_orthotropic(context, &nan, &m));
  assert_null(m);
}

/* Energy is a scalar: e' C' e' with the strain turned along equals e C e. Four quarter turns give
 * the material back. */
static void rotation_carries_the_law_along(void **state) {
  bw_context *context = check_context(state);
  bw_material *m = NULL, *turned = NULL;
  make(context, &m);
  double a = 0.3, b = 1.1, ca = cos(a), sa = sin(a), cb = cos(b), sb = sin(b);
  double r[9] = {ca, -sa * cb, sa * sb, sa, ca * cb, -ca * sb, 0, sb, cb};
  check_ok(context, bw_material_rotated(context, m, r, &turned));
  double t[3][3] = {{1, 0.4, -0.2}, {0.4, -0.5, 0.3}, {-0.2, 0.3, 0.7}}, u[3][3];
  for (int i = 0; i < 3; i++)
    for (int j = 0; j < 3; j++) {
      u[i][j] = 0;
      for (int k = 0; k < 3; k++)
        for (int l = 0; l < 3; l++)
          u[i][j] += r[3 * i + k] * r[3 * j + l] * t[k][l];
    }
  double e[2][6], energy[2] = {0};
  for (int w = 0; w < 2; w++) {
    double(*s)[3] = w ? u : t;
    double six[6] = {s[0][0], s[1][1], s[2][2], 2 * s[1][2], 2 * s[2][0], 2 * s[0][1]};
    memcpy(e[w], six, sizeof six);
    const double *c = w ? turned->elasticity : m->elasticity;
    for (int i = 0; i < 6; i++)
      for (int j = 0; j < 6; j++)
        energy[w] += six[i] * c[6 * i + j] * six[j];
  }
  check_near(energy[1], energy[0], 1e-13 * energy[0]);
  check_inverse(turned);
  bw_release(turned);

  double quarter[9] = {0, -1, 0, 1, 0, 0, 0, 0, 1};
  bw_material *now = bw_retain(m);
  for (int i = 0; i < 4; i++) {
    bw_material *next = NULL;
    check_ok(context, bw_material_rotated(context, now, quarter, &next));
    bw_release(now);
    now = next;
    if (i == 0) { /* axis 1 now points along y: Y1 is found there */
      check_near(now->compliance[7] * 3e9, 1, 1e-14);
      check_near(now->compliance[0] * 2e9, 1, 1e-14);
    }
  }
  assert_memory_equal(now->elasticity, m->elasticity, sizeof m->elasticity);
  bw_release(now);
  bw_release(m);
}

static void strength_by_direction(void **state) {
  bw_context *context = check_context(state);
  bw_material *m = NULL;
  make(context, &m);
  double x[3] = {2, 0, 0}, y[3] = {0, -1, 0}, xy[3] = {1, 1, 0};
  check_near(bw_material_strength(m, x), 30e6, 1e-6);
  check_near(bw_material_strength(m, y), 20e6, 1e-6);
  check_near(bw_material_strength(m, xy), sqrt(2 / (1 / 900e12 + 1 / 400e12)), 1e-6);

  double pull[6] = {15e6, 0, 0, 0, 0, 0}, push[6] = {15e6, 0, -8e6, 0, 0, 0};
  check_near(bw_material_utilisation(m, pull), 0.5, 1e-12);
  check_near(bw_material_utilisation(m, push), 0.8, 1e-12);
  /* equal principal stresses: the weakest direction of their plane, of space */
  double disc[6] = {5e6, 5e6, 0, 0, 0, 0}, ball[6] = {5e6, 5e6, 5e6, 0, 0, 0}, none[6] = {0};
  check_near(bw_material_utilisation(m, disc), 0.25, 1e-12);
  check_near(bw_material_utilisation(m, ball), 0.5, 1e-12);
  check_near(bw_material_utilisation(m, none), 0, 0);
  bw_release(m);
}

static void numbers_out_of_range_are_refused(void **state) {
  bw_context *context = check_context(state);
  bw_material *m = NULL;
  bw_isotropic soft = {"x", 1e-310, 0.3, 0, 0, 0, 0}, hard = {"x", 1e308, 0.4999, 0, 0, 0, 0};
  check_fails(context, BW_INVALID, "range", bw_material_isotropic(context, &soft, &m));
  check_fails(context, BW_INVALID, "range", bw_material_isotropic(context, &hard, &m));
  bw_orthotropic c = {.young = {1e308, 1e308, 1e308}, .poisson = {0.499, 0.499, 0.499}};
  check_fails(context, BW_INVALID, "range", bw_material_orthotropic(context, &c, &m));
  assert_null(m);
}

/* Every element has the matrices of the material rotated for it, also once all is turned again. */
static void turned_by_element(void **state) {
  bw_context *context = check_context(state);
  const double turn[2][9] = {{0, -1, 0, 1, 0, 0, 0, 0, 1}, {0.6, 0, 0.8, 0, 1, 0, -0.8, 0, 0.6}};
  const int32_t group[3] = {1, 0, 1}, beyond[3] = {0, 2, 1};
  const double mirror[18] = {1, 0, 0, 0, 1, 0, 0, 0, -1, 1, 0, 0, 0, 1, 0, 0, 0, 1};
  bw_material *m = NULL, *steel = NULL, *turned = NULL, *again = NULL, *one = NULL;
  check_ok(context, bw_material_named(context, "zp150", &m));
  check_ok(context, bw_material_rotated_by_element(context, m, 3, 2, group, turn[0], &turned));
  for (int e = 0; e < 3; e++) {
    check_ok(context, bw_material_rotated(context, m, turn[group[e]], &one));
    for (int k = 0; k < 36; k++) {
      check_near(bw_material_elasticity(turned, e)[k], one->elasticity[k], 0);
      check_near(bw_material_compliance(turned, e)[k], one->compliance[k], 0);
    }
    bw_release(one);
  }
  check_ok(context, bw_material_rotated(context, turned, turn[0], &again));
  const double *second = again->parts->rotation + 9 * again->parts->of_element[0];
  for (int r = 0; r < 3; r++)
    for (int c = 0; c < 3; c++) {
      double want = 0;
      for (int k = 0; k < 3; k++)
        want += turn[0][3 * r + k] * turn[1][3 * k + c];
      check_near(second[3 * r + c], want, 1e-15);
    }
  assert_ptr_equal(bw_material_unrotated(again, 0), m);
  assert_true(bw_bytes(turned) > bw_bytes(m));
  check_ok(context, bw_material_rotated_by_element(context, turned, 3, 2, group, turn[0], &one));
  for (int r = 0; r < 3; r++) /* twice by the group of element 2 */
    for (int c = 0; c < 3; c++) {
      double want = 0;
      for (int k = 0; k < 3; k++)
        want += turn[0][3 * r + k] * turn[0][3 * k + c];
      check_near(one->parts->rotation[9 * one->parts->of_element[1] + 3 * r + c], want, 1e-15);
    }
  bw_release(one);
  check_fails(context, BW_INVALID, "element 2 is in group 3",
              bw_material_rotated_by_element(context, m, 3, 2, beyond, turn[0], &one));
  check_fails(context, BW_INVALID, "left-handed",
              bw_material_rotated_by_element(context, m, 3, 2, group, mirror, &one));
  check_fails(context, BW_INVALID, "each of 3 elements", bw_material_fits(context, turned, 4));
  check_ok(context, bw_material_named(context, "steel", &steel));
  check_ok(context, bw_material_rotated_by_element(context, steel, 3, 2, group, turn[0], &one));
  assert_ptr_equal(one, steel); /* no direction differs from another */
  bw_release(one);
  bw_release(steel);
  bw_release(again);
  bw_release(turned);
  bw_release(m);
}

/* Stiffened groups of a material whose parts are turned: each element's moduli are multiplied. */
static void stiffened_groups(void **state) {
  bw_context *context = check_context(state);
  const double turn[18] = {0, -1, 0, 1, 0, 0, 0, 0, 1, 0.6, 0, 0.8, 0, 1, 0, -0.8, 0, 0.6};
  const int32_t group[4] = {0, 1, 1, 0}, of[4] = {0, 0, 1, 1}, no[4] = {0, 0, 2, 1};
  const double factor[2] = {1, 2.5}, none[2] = {1, 0};
  bw_material *wood = NULL, *turned = NULL, *stiff = NULL;
  check_ok(context, bw_material_named(context, "zp150", &wood));
  check_ok(context, bw_material_rotated_by_element(context, wood, 4, 2, group, turn, &turned));
  check_ok(context, bw_material_stiffened(context, turned, 4, 2, of, factor, &stiff));
  for (int64_t e = 0; e < 4; e++)
    for (int k = 0; k < 36; k++)
      check_near(bw_material_elasticity(stiff, e)[k],
                 factor[of[e]] * bw_material_elasticity(turned, e)[k], 0);
  assert_int_equal(bw_material_stiffened(context, turned, 4, 2, of, none, &stiff), BW_INVALID);
  assert_int_equal(bw_material_stiffened(context, turned, 4, 2, no, factor, &stiff), BW_INVALID);
  assert_int_equal(bw_material_stiffened(context, turned, 3, 2, of, factor, &stiff), BW_INVALID);
  bw_release(stiff);
  stiff = NULL;
  check_allocations(context, stiff,
                    bw_material_stiffened(context, turned, 4, 2, of, factor, &stiff));
  bw_release(turned);
  bw_release(wood);
}

/* Several materials: each element has its own, also turned, formulated and on other elements; the
 * whole has what the parts agree in, and the least density and strength. */
static void several_materials(void **state) {
  bw_context *context = check_context(state);
  const double turn[18] = {0, -1, 0, 1, 0, 0, 0, 0, 1, 0.6, 0, 0.8, 0, 1, 0, -0.8, 0, 0.6};
  const int32_t of[4] = {1, 0, 2, 1}, beyond[4] = {0, 1, 3, 0}, group[4] = {0, 0, 1, 1};
  const int32_t from[6] = {3, 3, 2, 1, 0, 2}, no[2] = {0, 4};
  bw_material *wood = NULL, *steel = NULL, *pla = NULL, *all = NULL, *turned = NULL, *b_bar = NULL;
  bw_material *carried = NULL, *one = NULL, *none = NULL;
  check_ok(context, bw_material_named(context, "zp150", &wood));
  check_ok(context, bw_material_named(context, "steel", &steel));
  check_ok(context, bw_material_named(context, "pla", &pla));
  const bw_material *part[3] = {steel, wood, pla};
  check_ok(context, bw_material_by_element(context, 4, 3, of, part, &all));
  assert_true(bw_material_mixed(all));
  assert_string_equal(all->name, "steel + zp150 + pla");
  check_near(all->density, fmin(steel->density, fmin(wood->density, pla->density)), 0);
  check_near(all->young[0], 0, 0);
  for (int e = 0; e < 4; e++)
    assert_ptr_equal(bw_material_of(all, e), part[of[e]]);
  check_ok(context, bw_material_carried(context, all, 6, from, &carried));
  for (int e = 0; e < 6; e++)
    assert_ptr_equal(bw_material_of(carried, e), part[of[from[e]]]);
  check_ok(context, bw_material_rotated_by_element(context, all, 4, 2, group, turn, &turned));
  assert_ptr_equal(bw_material_of(turned, 1), steel); /* no direction differs from another */
  assert_ptr_equal(bw_material_unrotated(turned, 3), wood);
  check_ok(context, bw_material_rotated(context, wood, turn + 9, &one));
  assert_memory_equal(bw_material_elasticity(turned, 3), one->elasticity, sizeof one->elasticity);
  check_ok(context, bw_material_formulated(context, turned, BW_B_BAR, &b_bar));
  for (int e = 0; e < 4; e++) {
    assert_int_equal(bw_material_of(b_bar, e)->formulation, BW_B_BAR);
    assert_memory_equal(bw_material_elasticity(b_bar, e), bw_material_elasticity(turned, e),
                        36 * sizeof(double));
  }
  assert_ptr_equal(bw_material_unrotated(b_bar, 0), bw_material_unrotated(b_bar, 3));
  part[2] = all;
  check_fails(context, BW_INVALID, "give its parts",
              bw_material_by_element(context, 4, 3, of, part, &none));
  part[2] = bw_material_of(b_bar, 2);
  check_fails(context, BW_INVALID, "different formulations",
              bw_material_by_element(context, 4, 3, of, part, &none));
  check_fails(context, BW_INVALID, "element 3 is in part 4: the parts are 1 to 3",
              bw_material_by_element(context, 4, 3, beyond, part, &none));
  check_fails(context, BW_INVALID, "element 2 is in element before 5",
              bw_material_carried(context, all, 2, no, &none));
  bw_release(one);
  part[1] = part[2] = steel;
  check_ok(context, bw_material_by_element(context, 4, 3, of, part, &one));
  assert_ptr_equal(one, steel);
  bw_release(one);
  bw_release(carried);
  bw_release(b_bar);
  bw_release(turned);
  bw_release(all);
  bw_release(pla);
  bw_release(steel);
  bw_release(wood);
}

static void out_of_memory(void **state) {
  bw_context *context = check_context(state);
  double quarter[9] = {0, -1, 0, 1, 0, 0, 0, 0, 1};
  check_each_allocation(context, status, 2) {
    bw_material *m = NULL, *turned = NULL, *by_element = NULL;
    const int32_t group[2] = {0, 0};
    status = bw_material_named(context, "zp150", &m);
    if (status == BW_OK)
      status = bw_material_rotated_by_element(context, m, 2, 1, group, quarter, &by_element);
    if (status == BW_OK)
      status = bw_material_rotated(context, by_element, quarter, &turned);
    bw_release(m);
    bw_release(by_element);
    bw_release(turned);
  }
}

check_main(check_test(isotropic_constants), check_test(isotropic_refusals),
           check_test(orthotropic_compliance),
           check_test(orthotropic_with_equal_constants_is_isotropic),
           check_test(reciprocal_relation), check_test(indefinite_constants_are_refused),
           check_test(axes_must_be_a_rotation), check_test(rotation_carries_the_law_along),
           check_test(strength_by_direction), check_test(numbers_out_of_range_are_refused),
           check_test(turned_by_element), check_test(stiffened_groups),
           check_test(several_materials), check_test(out_of_memory))
