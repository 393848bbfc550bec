/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* What the residual of a linear solve says of the error of the stress.
 *
 * Let d be the error of a displacement, K d = r with the residual r. Of an element of the volume V
 * with the mean stress s and the mean strain C^-1 s,
 *     V s . C^-1 s <= d . K d,   so   |s| <= sqrt(c / V) sqrt(d . K d),
 * c being the largest eigenvalue of C on symmetric tensors. With the lowest eigenvalue lambda of
 * K v = lambda M v and M >= theta D, D the diagonal of M,
 *     d . K d = r . K^-1 r <= r . M^-1 r / lambda <= r . D^-1 r / (lambda theta).
 * On a body that is free r is in balance, and lambda the lowest eigenvalue that is not zero. */
#include "analysis/solve_error.h"

#include "barwright/eigen.h"
#include "linear/internal.h"
#include "qp/nearest_point.h"

#include <float.h>
#include <math.h>
#include <string.h>

/* The modes' tolerance is far smaller than the fraction of the lowest eigenvalue that is left
 * out. */
static const double LOWEST_FRACTION = 0.99;
/* Of the balance of a load, as a fraction of its largest force. */
static const double BALANCE_ROUNDING = 512 * DBL_EPSILON;

/* theta: M_e - theta D_e is positive definite for every element, and so for the sum. */
static bw_status fraction_of_diagonal(bw_context *context, const bw_mesh *mesh, double *theta) {
  int n = mesh->nodes_per_element;
  double mass[100], rest[100], x[10][3];
  *theta = 0.25;
  for (int64_t e = 0; e < mesh->element_count; e++) {
    for (int a = 0; a < n; a++)
      memcpy(x[a], mesh->node + 3 * (int64_t)mesh->element[e * n + a], sizeof x[a]);
    bw_element_mass(mesh->order, (const double(*)[3])x, mass);
    bool fits = false;
    while (!fits && *theta > 1e-6) {
      memcpy(rest, mass, sizeof(double) * (size_t)(n * n));
      for (int a = 0; a < n; a++)
        rest[a * n + a] -= *theta * mass[a * n + a];
      fits = bwi_cholesky(n, rest, 1e-12);
      *theta = fits ? *theta : *theta / 2;
    }
    if (!fits)
      return bw_fail(context, BW_CONVERGENCE,
                     "the mass matrix of element %lld is nearly singular, so the error of the "
                     "linear solves is not known",
                     (long long)e + 1);
  }
  return BW_OK;
}

bw_status bwi_solve_error_open(bw_context *context, bw_system *system, bwi_solve_error *error) {
  bw_status status = BW_OK;
  const bw_block_pattern *pattern = system->pattern;
  bw_modes *modes = NULL;
  bw_modes_options options;
  *error = (bwi_solve_error){.system = system};
  BW_TRY(bw_system_stiffness(context, system));
  error->compliance = BW_NEW0(context, double, pattern->node_count);
  if (!error->compliance)
    return BW_MEMORY;
  if (system->dof_map->unknown_count == 0)
    goto done; /* nothing moves, and nothing errs */
  bw_modes_options_default(&options);
  options.count = 1;
  options.sturm = true;
  BW_TRY(bw_modes_elastic(context, system, &options, &modes));
  if (modes->count == 0)
    goto done;
  if (!modes->counted || !(modes->eigenvalue[0] > 0))
    BW_TRY(bw_fail(context, BW_CONVERGENCE,
                   "the lowest eigenvalue of the body could not be confirmed, so the error of "
                   "the linear solves is not known"));
  double theta;
  BW_TRY(fraction_of_diagonal(context, system->mesh, &theta));
  double scale = LOWEST_FRACTION * modes->eigenvalue[0] * theta;
  for (int32_t i = 0; i < pattern->node_count; i++)
    error->compliance[i] = 1 / (scale * system->mass[pattern->start[i + 1] - 1]);
done:
  bw_release(modes);
  return status;
}

void bwi_solve_error_close(bwi_solve_error *error) {
  bw_free(error->compliance);
}

/* rest -= K u and size += |K| |u|. */
static void multiply(const bw_system *system, const double *u, double *rest, double *size) {
  const bw_block_pattern *pattern = system->pattern;
  for (int64_t i = 0; i < pattern->node_count; i++)
    for (int64_t k = pattern->start[i]; k < pattern->start[i + 1]; k++) {
      int64_t j = pattern->column[k];
      for (int a = 0; a < 3; a++)
        for (int b = 0; b < 3; b++) {
          double value = system->stiffness[9 * k + 3 * a + b];
          rest[3 * i + a] -= value * u[3 * j + b];
          size[3 * i + a] += fabs(value * u[3 * j + b]);
          if (j != i) {
            rest[3 * j + b] -= value * u[3 * i + a];
            size[3 * j + b] += fabs(value * u[3 * i + a]);
          }
        }
    }
}

double bwi_solve_error_energy(const bwi_solve_error *error, const double *force,
                              const double *displacement, double *work) {
  const bw_block_pattern *pattern = error->system->pattern;
  size_t nodes = (size_t)pattern->node_count;
  double load = 0, energy = 0, *size = work + 3 * nodes;
  for (size_t i = 0; i < 3 * nodes; i++) {
    load = fmax(load, fabs(force[i]));
    work[i] = force[i];
    size[i] = fabs(force[i]);
  }
  multiply(error->system, displacement, work, size);
  bw_rigid_modes_balance(error->system->dof_map, work);
  bwi_keep_states(error->system->dof_map, 1u << BW_DOF_UNKNOWN | 1u << BW_DOF_ISOSTATIC, work);
  for (size_t i = 0; i < nodes; i++) {
    int64_t neighbours = pattern->start[i + 1] - pattern->start[i] + pattern->upper_start[i + 1] -
                         pattern->upper_start[i];
    double rounding = (3.0 * (double)neighbours + 4) * DBL_EPSILON; /* twice that of the sum */
    for (size_t c = 0; c < 3; c++) {
      double max = fabs(work[3 * i + c]) + rounding * size[3 * i + c] + BALANCE_ROUNDING * load;
      energy += max * max * error->compliance[i];
    }
  }
  return sqrt(energy);
}

/* Sums of absolute values of the rows of C, on tensors whose shears count twice, bound its largest
 * eigenvalue. */
double bwi_stress_per_energy(const bw_system *system, int64_t element) {
  const double *c = bw_material_elasticity(system->material, element);
  const bw_mesh *mesh = system->mesh;
  double max = 0, volume = 0, mass[100], x[10][3];
  int n = mesh->nodes_per_element;
  for (int i = 0; i < 6; i++) {
    double sum = 0;
    for (int j = 0; j < 6; j++)
      sum += fabs(c[6 * i + j]) * (i < 3 ? 1 : sqrt(2)) * (j < 3 ? 1 : sqrt(2));
    max = fmax(max, sum);
  }
  for (int a = 0; a < n; a++)
    memcpy(x[a], mesh->node + 3 * (int64_t)mesh->element[element * n + a], sizeof x[a]);
  bw_element_mass(mesh->order, (const double(*)[3])x, mass);
  for (int i = 0; i < n * n; i++)
    volume += mass[i];
  return sqrt(max / volume);
}
