/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* The bound of the error of a linear solve from its residual. */
#include "body_system.h"
#include "pressed.h"

#include "analysis/solve_error.h"

static double shear_norm(const double s[6]) {
  return sqrt(s[0] * s[0] + s[1] * s[1] + s[2] * s[2] +
              2 * (s[3] * s[3] + s[4] * s[4] + s[5] * s[5]));
}

/* A displacement is off by a known field: the energy of this field and the stresses that it causes
 * are within the bound, and for the lowest mode the bound is not far above. */
static void residual_bounds_error(void **state) {
  bw_context *context = check_context(state);
  for (int kind = 0; kind < 4; kind++) {
    int order = kind < 2 ? 1 : 2;
    bw_mesh *mesh = make_box(context, 1, 0.3, 0.2, 5, 2, 1, order);
    pressed_body s;
    bw_system *system;
    bwi_solve_error error;
    bw_modes *modes;
    bw_modes_options options;
    pressed_open(context, &s, mesh, kind % 2 == 1, 0, 3);
    check_ok(context, body_system(context, mesh, s.material, s.dof_map, NULL, &system));
    check_ok(context, bwi_solve_error_open(context, system, &error));
    bw_modes_options_default(&options);
    options.count = 3;
    check_ok(context, bw_modes_elastic(context, system, &options, &modes));
    size_t n = 3 * (size_t)mesh->node_count;
    double *force = BW_NEW0(context, double, n), *u = BW_NEW(context, double, n);
    double *off = BW_NEW(context, double, n), *work = BW_NEW(context, double, 2 * n);
    double *stress = BW_NEW(context, double, 6 * (size_t)mesh->element_count);
    double *pressure = pressed_objective(context, &s, 1);
    bw_pressure_force(s.basis, pressure, force);
    bw_free(pressure);
    check_ok(context, bw_system_solve(context, system, 1, force, u));
    double exact = bwi_solve_error_energy(&error, force, u, work);
    for (int m = 0; m < modes->count; m++) {
      double share = 1e-3, energy = share * sqrt(modes->eigenvalue[m]);
      const double *shape = modes->shape + (size_t)m * n;
      for (size_t i = 0; i < n; i++)
        off[i] = u[i] + share * shape[i];
      double bound = bwi_solve_error_energy(&error, force, off, work);
      assert_true(bound >= energy);
      if (m == 0)
        assert_true(bound <= 6 * energy + 2 * exact);
      check_ok(context, bw_element_stress(context, mesh, s.material, shape, stress));
      for (int32_t e = 0; e < mesh->element_count; e++)
        assert_true(share * shear_norm(stress + 6 * e) <=
                    bwi_stress_per_energy(system, e) * energy * (1 + 1e-9));
    }
    bw_free(force);
    bw_free(u);
    bw_free(off);
    bw_free(work);
    bw_free(stress);
    bw_release(modes);
    bwi_solve_error_close(&error);
    bw_release(system);
    pressed_close(&s);
    bw_release(mesh);
  }
}

check_main(check_test(residual_bounds_error))
