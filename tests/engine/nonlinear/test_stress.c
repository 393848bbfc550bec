/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* Cauchy stress of elements and nodes. */
#include "nonlinear/solids.h"

/* Simple shear of a neo-Hookean block, turned afterwards: sigma_12 = mu gamma, sigma_11 = mu
 * gamma^2 in the axes that turned, everything else 0, at every element and node. */
static void test_shear(void **state) {
  bw_context *context = check_context(state);
  const int32_t cells[3] = {3, 2, 2};
  const double gamma = 0.5, c = cos(0.8), s = sin(0.8);
  const double r[9] = {c, -s, 0, s, c, 0, 0, 0, 1};
  bw_solid_material *one = solids_simple(context, BW_NEO_HOOKEAN);
  const double mu = one->mu[0];
  const double own[9] = {mu * gamma * gamma, mu * gamma, 0, mu * gamma, 0, 0, 0, 0, 0};
  const double shear[9] = {1, gamma, 0, 0, 1, 0, 0, 0, 1};
  double h[9], sigma[9];
  for (int i = 0; i < 3; i++)
    for (int j = 0; j < 3; j++) {
      h[3 * i + j] = -(i == j);
      sigma[3 * i + j] = 0;
      for (int k = 0; k < 3; k++) {
        h[3 * i + j] += r[3 * i + k] * shear[3 * k + j];
        for (int l = 0; l < 3; l++)
          sigma[3 * i + j] += r[3 * i + k] * own[3 * k + l] * r[3 * j + l];
      }
    }
  const double expected[6] = {sigma[0], sigma[4], sigma[8], sigma[5], sigma[2], sigma[1]};
  bw_solid *solid = solids_create(context, cells, 1, &one, NULL, NULL);
  double *u = solids_displacement(solid, h, 0);
  double *at = solids_numbers(6 * solid->grid->element_count);
  double *node = solids_numbers(6 * solid->grid->node_count);
  check_ok(context, bw_solid_stress(context, solid, u, at, node));
  for (int32_t e = 0; e < solid->grid->element_count; e++)
    for (int k = 0; k < 6; k++)
      check_near(at[6 * e + k], expected[k], 1e-14);
  for (int32_t i = 0; i < solid->grid->node_count; i++)
    for (int k = 0; k < 6; k++)
      check_near(node[6 * i + k], expected[k], 1e-14);
  free(u), free(at), free(node);
  bw_release(solid);
}

/* Two materials side by side under the same strain: a node between them has the mean of the two by
 * volume, where the cells are parts. */
static void test_means(void **state) {
  bw_context *context = check_context(state);
  const int32_t cells[3] = {2, 1, 1}, material[2] = {1, 2};
  const double stretch[9] = {0.2, 0, 0, 0, 0, 0, 0, 0, 0}, fraction[2] = {1, 0.25};
  bw_solid_material *both[2] = {solids_simple(context, BW_COROTATED),
                                solids_simple(context, BW_ST_VENANT_KIRCHHOFF)};
  bw_solid *solid = solids_create(context, cells, 2, both, material, fraction);
  double *u = solids_displacement(solid, stretch, 0), at[12], node[72];
  check_ok(context, bw_solid_stress(context, solid, u, at, node));
  /* mu = 1, lambda = 1.5; sigma_xx = P_xx here, as J = F_11 */
  check_near(at[0], 2 * 0.2 + 1.5 * 0.2, 1e-14);
  check_near(at[6], 1.2 * (2 * 0.22 + 1.5 * 0.22), 1e-14);
  check_near(node[0], at[0], 1e-15);
  check_near(node[6], (at[0] + 0.25 * at[6]) / 1.25, 1e-15);
  check_near(node[12], at[6], 1e-15);
  check_ok(context, bw_solid_stress(context, solid, u, NULL, node));
  check_near(node[12], at[6], 1e-15);
  free(u);
  bw_release(solid);
}

check_main(check_test(test_shear), check_test(test_means))
