/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* Resultant arrows: nothing is lost, patches stay apart, the two faces of a plate do not cancel. */
#include "bodies.h"

static void patches_become_arrows(void **state) {
  bw_context *context = check_context(state);
  bw_mesh *mesh = make_box(context, 2, 1, 0.05, 40, 20, 1, 1);
  bw_pressure_basis *basis = NULL;
  check_ok(context, bw_pressure_basis_create(context, mesh, NULL, &basis));
  double *p = BW_NEW(context, double, basis->count), total[3] = {0, 0, 0}, sum[3] = {0, 0, 0};
  double *force = BW_NEW(context, double, 3 * (size_t)mesh->node_count), area = 0;
  /* A patch of radius 0.15 on top at (0.5, 0.5), one below at the same place, one on top at x
   * = 1.5. */
  for (int32_t j = 0; j < basis->count; j++) {
    const double *x = mesh->node + 3 * basis->node[j];
    bool left = hypot(x[0] - 0.5, x[1] - 0.5) < 0.15, right = hypot(x[0] - 1.5, x[1] - 0.5) < 0.15;
    p[j] = left && x[2] > 0.025 ? 3e4 : left ? 1e4 : right && x[2] > 0.025 ? 2e4 : 0;
    area += p[j] > 0 ? basis->area[j] : 0;
  }
  bw_pressure_force(basis, p, force);
  for (int32_t i = 0; i < 3 * mesh->node_count; i++)
    total[i % 3] += force[i];
  int count = 0;
  bw_arrow *arrow = NULL;
  check_ok(context, bw_resultant_arrows(context, basis, p, 0.35, &count, &arrow));
  assert_int_equal(count, 3);
  const double at[3][4] = {{0.5, 0.5, 0.05, -1}, {1.5, 0.5, 0.05, -1}, {0.5, 0.5, 0, 1}};
  for (int i = 0; i < 3; i++) {
    for (int k = 0; k < 3; k++) {
      sum[k] += arrow[i].force[k];
      check_near(arrow[i].at[k], at[i][k], 1e-12 + (k < 2 ? 0.03 : 0));
    }
    assert_true(arrow[i].force[2] * at[i][3] > 0);
    area -= arrow[i].area;
  }
  check_near(area, 0, 1e-12);
  for (int k = 0; k < 3; k++)
    check_near(sum[k], total[k], 1e-9);
  bw_free(arrow);
  /* However small the radius, and however large, nothing is lost. */
  for (int trial = 0; trial < 4; trial++) {
    const double radius[4] = {1e-9, 0.06, 0, 100};
    check_ok(context, bw_resultant_arrows(context, basis, p, radius[trial], &count, &arrow));
    for (int k = 0; k < 3; k++) {
      double s = 0;
      for (int i = 0; i < count; i++)
        s += arrow[i].force[k];
      check_near(s, total[k], 1e-9);
    }
    if (trial == 3)
      assert_int_equal(count, 2);
    bw_free(arrow);
  }
  memset(p, 0, (size_t)basis->count * sizeof *p);
  check_ok(context, bw_resultant_arrows(context, basis, p, 0.1, &count, &arrow));
  assert_int_equal(count, 0);
  bw_free(arrow);
  check_fails(context, BW_INVALID, "radius",
              bw_resultant_arrows(context, basis, p, -1, &count, &arrow));
  p[3] = INFINITY;
  check_fails(context, BW_INVALID, "pressure 4",
              bw_resultant_arrows(context, basis, p, 1, &count, &arrow));
  bw_free(p);
  bw_free(force);
  bw_release(basis);
  bw_release(mesh);
}

check_main(check_test(patches_become_arrows))
