/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* Static solutions and modes by an external solver. Residuals are computed here, from products
 * with the engine's own matrices, whatever the solver says. */
#include <float.h>
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "barwright/external.h"
#include "eigen/modes.h"
#include "statics/internal.h"

static const bw_external *registered;

void bw_external_register(const bw_external *external) {
  registered = external;
}

const bw_external *bw_external_registered(void) {
  return registered;
}

static bw_status check_registered(bw_context *context) {
  return registered ? BW_OK
                    : bw_fail(context, BW_UNSUPPORTED,
                              "no external solver is loaded: require \"barwright.distributed\"");
}

/* A problem while the solver has it. */
typedef struct equations {
  bw_external_problem problem;
  bw_dof_map *dof_map;
  bool open; /* false after a failure: the solver has closed it */
} equations;

static bw_status open_system(bw_context *context, const bw_model *model, bool mass,
                             const bw_solver *solver, equations *e) {
  e->problem = (bw_external_problem){.model = model, .dof_map = e->dof_map, .mass = mass};
  bw_status status = registered->open(context, &e->problem, solver);
  e->open = status == BW_OK;
  return status;
}

static void clear(bw_context *context, equations *e, bw_external_report *report) {
  if (e->open)
    registered->close(context, report);
  e->open = false;
  bw_release(e->dof_map);
}

static bw_status multiply(bw_context *context, equations *e, int count, const double *x, double *kx,
                          double *mx, double *magnitude) {
  bw_status status = registered->multiply(context, count, x, kx, mx, magnitude);
  if (status != BW_OK)
    e->open = false;
  return status;
}

/* ---- statics --------------------------------------------------------------------------------- */

/* (-) relative residual that a solver is to reach. */
static double tolerance_of(const bw_solver *solver) {
  return solver->options.tolerance > 0 ? solver->options.tolerance : BW_EXTERNAL_TOLERANCE;
}

static bw_status solve(bw_context *context, void *data, const double *force, double *displacement) {
  equations *e = data;
  bw_status status = registered->solve(context, force, displacement);
  if (status != BW_OK)
    e->open = false;
  return status;
}

/* As bwi_residual_noise. */
static bw_status multiply_one(bw_context *context, void *data, const double *x, double *product,
                              double *noise) {
  double magnitude = 0;
  bw_status status = multiply(context, data, 1, x, product, NULL, &magnitude);
  if (noise)
    *noise = BWI_RESIDUAL_NOISE * DBL_EPSILON * magnitude;
  return status;
}

static double norm(const double *a, int64_t size) {
  double sum = 0;
  for (int64_t i = 0; i < size; i++)
    sum += a[i] * a[i];
  return sqrt(sum);
}

/* The residual is above what was asked for. It stands where rounding alone leaves as much: of K u,
 * or of a load that inertia balances to nothing (a body that falls). */
static bw_status check(bw_context *context, equations *e, const bw_solver *solver,
                       const bw_static *result) {
  bw_status status = BW_OK;
  double noise = 0;
  int64_t size = 3 * (int64_t)e->dof_map->mesh->node_count;
  double *residual = BW_NEW(context, double, size);
  double *product = BW_NEW(context, double, size);
  if (!residual || !product) {
    status = BW_MEMORY;
    goto done;
  }
  memcpy(residual, result->force, (size_t)size * sizeof *residual);
  if (e->dof_map->rigid_mode_count > 0)
    bw_rigid_modes_balance(e->dof_map, residual);
  BW_TRY(multiply_one(context, e, result->displacement, product, &noise));
  for (int64_t i = 0; i < size; i++)
    residual[i] -= product[i];
  bwi_keep_states(e->dof_map, 1u << BW_DOF_UNKNOWN | 1u << BW_DOF_ISOSTATIC, residual);
  double remaining = norm(residual, size);
  bool product_rounding = result->residual < 1e-6 && remaining < 10 * noise;
  bool nothing_to_solve = remaining < 1e-13 * norm(result->force, size);
  if (!product_rounding && !nothing_to_solve) {
    status =
        bw_fail(context, BW_CONVERGENCE,
                "the residual of the solution is %.2e of the load; %.2e was requested. %s",
                result->residual, tolerance_of(solver),
                solver->options.kind == BW_SOLVER_PCG
                    ? "Give a larger tolerance, or the solver cholesky"
                    : "The factor lost these digits: the body is nearly a mechanism, or its "
                      "elements are very flat. Give pcg with amg of the backend petsc, or mesh "
                      "again");
    bw_detail_number(context, "residual", result->residual);
  }
done:
  bw_free(residual);
  bw_free(product);
  return status;
}

static void fill_report(const bw_solver *solver, bw_static *result) {
  const bw_external_report *external = result->external;
  bw_solver_report *report = &result->report;
  report->solver = bw_solver_word(solver->options.kind);
  report->backend = bw_backend_word(BW_BACKEND_PETSC);
  if (solver->options.kind == BW_SOLVER_PCG)
    report->preconditioner = bw_solver_word(BW_SOLVER_AMG);
  report->iterations = external->iterations;
  report->bytes = external->bytes;
  report->residual = result->residual;
  snprintf(report->reason, sizeof report->reason, "it was given");
}

bw_status bwi_statics_external(bw_context *context, const bw_model *model,
                               const bw_statics_options *statics, bw_static **out) {
  bw_status status = BW_OK;
  const double tolerance = tolerance_of(statics->solver);
  equations e = {0};
  bw_static *result = NULL;
  double start = bw_seconds();
  BW_TRY(check_registered(context));
  BW_TRY(bw_dof_map_create(context, model, &e.dof_map));
  BW_TRY(bwi_static_begin(context, model, statics, e.dof_map, &result));
  result->external = BW_NEW0(context, bw_external_report, 1);
  if (!result->external) {
    status = BW_MEMORY;
    goto done;
  }
  BW_TRY(open_system(context, model, false, statics->solver, &e));
  bwi_static_solver solver = {
      .solve = solve, .multiply = multiply_one, .data = &e, .refine_to = tolerance};
  BW_TRY(bwi_static_solve(context, e.dof_map, NULL, NULL, &solver, result));
  if (result->residual > tolerance)
    BW_TRY(check(context, &e, statics->solver, result));
done:
  clear(context, &e, result ? result->external : NULL);
  if (status == BW_OK) {
    fill_report(statics->solver, result);
    result->report.seconds = bw_seconds() - start;
    *out = result;
  } else
    bw_release(result);
  return status;
}

/* ---- modes ----------------------------------------------------------------------------------- */

enum { RESIDUALS_AT_ONCE = 4 };

/* |K x - lambda M x| / |lambda M x| at the unknowns. */
static bw_status residuals(bw_context *context, equations *e, int count, const double *value,
                           const double *vector, double *residual) {
  bw_status status = BW_OK;
  const unsigned kept = 1u << BW_DOF_UNKNOWN | 1u << BW_DOF_ISOSTATIC;
  int64_t size = 3 * (int64_t)e->dof_map->mesh->node_count;
  double *kx = BW_NEW(context, double, RESIDUALS_AT_ONCE *size);
  double *mx = BW_NEW(context, double, RESIDUALS_AT_ONCE *size);
  if (!kx || !mx) {
    status = BW_MEMORY;
    goto done;
  }
  for (int first = 0; first < count; first += RESIDUALS_AT_ONCE) {
    int batch = count - first < RESIDUALS_AT_ONCE ? count - first : RESIDUALS_AT_ONCE;
    BW_TRY(multiply(context, e, batch, vector + first * size, kx, mx, NULL));
    for (int k = 0; k < batch; k++) {
      double *a = kx + k * size, *b = mx + k * size;
      bwi_keep_states(e->dof_map, kept, a);
      bwi_keep_states(e->dof_map, kept, b);
      double difference = 0, whole = 0;
      for (int64_t i = 0; i < size; i++) {
        double m = value[first + k] * b[i], d = a[i] - m;
        difference += d * d;
        whole += m * m;
      }
      residual[first + k] = whole > 0 ? sqrt(difference / whole) : 0;
    }
  }
done:
  bw_free(kx);
  bw_free(mx);
  return status;
}

bw_status bw_modes_external(bw_context *context, const bw_model *model,
                            const bw_modes_options *options, bw_modes **modes) {
  bw_status status = BW_OK;
  bw_modes_options opts;
  static const bw_solver factor = {
      .options = {.kind = BW_SOLVER_CHOLESKY, .backend = BW_BACKEND_PETSC}};
  const bw_solver *inner = options && options->solver ? options->solver->options.inner : NULL;
  equations e = {0};
  bw_external_modes found = {0};
  bwi_eigen_result result = {0};
  bw_external_report *report = NULL;
  double start = bw_seconds();
  BW_TRY(bwi_modes_options_check(context, options, &opts));
  BW_TRY(check_registered(context));
  report = BW_NEW0(context, bw_external_report, 1);
  if (!report) {
    status = BW_MEMORY;
    goto done;
  }
  BW_TRY(bw_dof_map_create(context, model, &e.dof_map));
  BW_TRY(open_system(context, model, true, inner ? inner : &factor, &e));
  status = registered->modes(context, &opts, &found);
  e.open = status == BW_OK;
  result = (bwi_eigen_result){
      .count = found.count,
      .value = found.value,
      .vector = found.vector,
      .solves = found.solves,
      .recovered = found.recovered,
      .counted = found.counted,
      .report = {.solver = "slepc", .backend = "", .preconditioner = "", .reason = "it was given"}};
  if (status != BW_OK)
    goto done;
  result.residual = BW_NEW(context, double, found.count);
  if (!result.residual) {
    status = BW_MEMORY;
    goto done;
  }
  BW_TRY(residuals(context, &e, result.count, result.value, result.vector, result.residual));
  for (int k = 0; k < result.count; k++)
    result.report.residual = fmax(result.report.residual, result.residual[k]);
  BW_TRY(bwi_modes_from(context, model->mesh, model->material, e.dof_map->rigid_mode_count, &result,
                        modes));
done:
  clear(context, &e, report);
  bwi_eigen_result_clear(&result);
  if (status == BW_OK) {
    (*modes)->external = report;
    (*modes)->report.bytes = report->bytes;
    (*modes)->report.seconds = bw_seconds() - start;
  } else
    bw_free(report);
  return status;
}

bw_status bw_modes_of_model(bw_context *context, const bw_model *model, bw_system *given,
                            const bw_modes_options *options, bw_system **system, bw_modes **modes) {
  const bw_eigensolver *solver = options ? options->solver : NULL;
  if (system)
    *system = NULL;
  if (solver && solver->options.kind == BW_EIGENSOLVER_SLEPC)
    return bw_modes_external(context, model, options, modes);
  return bwi_modes_of_model(context, model, given, options, system, modes);
}
