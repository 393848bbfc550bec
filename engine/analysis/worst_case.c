/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* The worst-case run: for every weak region its functional, one adjoint solve, the linear program,
 * one solve under the optimal pressure, the stresses that it causes.
 *
 * All with one factor or one preconditioner, a batch of regions at a time: solves take many
 * right-hand sides at once, everything between them runs over the regions in parallel. Memory is
 * that of one batch whatever the number of regions. */
#include "analysis/load_program.h"
#include "analysis/solve_error.h"
#include "linear/system_solver.h"

#include <math.h>
#include <string.h>

/* Regions at once: multiples of what a factor, and what iterations, solve for side by side. */
enum { FACTOR_BATCH = BWI_MAX_WIDTH, ITERATIVE_BATCH = 2 * BWI_SMOOTHER_SIDES };
/* Stresses of several regions are worked on side by side while they fit in this many bytes; of
 * bigger meshes one at a time, with all threads. */
static const size_t side_by_side = (size_t)64 << 20;

typedef struct run {
  bw_context *context;
  bw_system *system;
  const bw_pressure_basis *basis;
  const bw_weak_regions *regions;
  const bw_worst_load_options *options;
  int first, count, signs; /* of the batch */
  double *block;           /* batch x node_count x 3: forces, adjoints, forces, displacements */
  double *objective;       /* batch x signs x pressures */
  double *pressure;        /* the same */
  double *value;           /* batch x signs */
  double *stress;          /* group x element_count x 6 */
  double *principal;       /* group x element_count */
  int group, group_first, group_count;
} run;

static double *block_of(const run *r, int64_t i) {
  return r->block + (size_t)i * 3 * (size_t)r->system->mesh->node_count;
}

/* The opposite sign is the only one. */
static bool is_opposite(const run *r) {
  return r->signs == 1 && r->options->other_sign;
}

static bw_status functional_body(void *data, int64_t begin, int64_t end, int worker) {
  const run *r = (const run *)data;
  bw_status status = BW_OK;
  (void)worker;
  for (int64_t i = begin; i < end; i++)
    BW_TRY(bw_region_objective(r->context, r->regions, r->first + (int)i, r->system->material,
                               block_of(r, i)));
done:
  return status;
}

static bw_status gradient_body(void *data, int64_t begin, int64_t end, int worker) {
  const run *r = (const run *)data;
  size_t n = (size_t)r->basis->count;
  bw_status status = BW_OK;
  (void)worker;
  for (int64_t i = begin; i < end; i++) {
    BW_TRY(bw_region_by_force(r->context, r->regions, r->first + (int)i, r->system->material,
                              block_of(r, i)));
    double *f = r->objective + (size_t)i * (size_t)r->signs * n;
    bw_pressure_gradient(r->basis, block_of(r, i), f);
    for (size_t j = 0; j < n && r->signs == 2; j++)
      f[n + j] = -f[j];
    for (size_t j = 0; j < n && is_opposite(r); j++)
      f[j] = -f[j];
  }
done:
  return status;
}

/* The sign that reaches more. */
static int chosen(const run *r, int64_t i) {
  return r->signs == 2 && r->value[2 * i + 1] > r->value[2 * i];
}

static const double *pressure_of(const run *r, int64_t i) {
  return r->pressure +
         ((size_t)i * (size_t)r->signs + (size_t)chosen(r, i)) * (size_t)r->basis->count;
}

static bw_status force_body(void *data, int64_t begin, int64_t end, int worker) {
  const run *r = (const run *)data;
  (void)worker;
  for (int64_t i = begin; i < end; i++)
    bw_pressure_force(r->basis, pressure_of(r, i), block_of(r, i));
  return BW_OK;
}

static bw_status stress_body(void *data, int64_t begin, int64_t end, int worker) {
  const run *r = (const run *)data;
  bw_status status = BW_OK;
  int64_t elements = r->system->mesh->element_count;
  (void)worker;
  for (int64_t g = begin; g < end; g++) {
    double *stress = r->stress + 6 * (size_t)(g * elements);
    BW_TRY(bw_element_stress(r->context, r->system->mesh, r->system->material,
                             block_of(r, r->group_first + g), stress));
    BW_TRY(bw_max_principal_field(r->context, elements, stress, r->principal + g * elements));
  }
done:
  return status;
}

/* Of the displacement u, the error d has at most the solver's tolerance times the energy u . K u,
 * which is the work of the pressure; the objective is not needed any more. */
static double solve_error(const run *r, int64_t i, const double *max_principal) {
  double tolerance = bwi_solve_tolerance(r->system), work = 0;
  int64_t peak = 0;
  if (tolerance == 0)
    return 0;
  for (int64_t e = 1; e < r->system->mesh->element_count; e++)
    peak = max_principal[e] > max_principal[peak] ? e : peak;
  const double *pressure = pressure_of(r, i);
  double *slope = r->objective + (size_t)i * (size_t)r->signs * (size_t)r->basis->count;
  bw_pressure_gradient(r->basis, block_of(r, i), slope);
  for (int32_t j = 0; j < r->basis->count; j++)
    work += slope[j] * pressure[j];
  return bwi_stress_per_energy(r->system, peak) * tolerance * sqrt(fmax(0, work));
}

/* The loads of the batch, by linear programs. */
static bw_status find_loads(run *r, bwi_loads *loads) {
  bw_status status = BW_OK;
  bw_context *context = r->context;
  BW_TRY(bw_parallel(context, r->count, 1, functional_body, r));
  BW_TRY(bw_system_solve(context, r->system, r->count, r->block, r->block));
  BW_TRY(bw_parallel(context, r->count, 1, gradient_body, r));
  BW_TRY(bwi_loads_solve(context, loads, (int64_t)r->count * r->signs, r->objective, r->pressure,
                         r->value, NULL));
done:
  return status;
}

/* Those that are given. */
static bw_status take_given(run *r) {
  size_t size = (size_t)r->basis->count * sizeof *r->pressure;
  for (int i = 0; i < r->count; i++) {
    for (int k = 0; k < r->signs; k++) {
      memcpy(r->pressure + (size_t)(i * r->signs + k) * (size_t)r->basis->count,
             r->options->given + (size_t)(r->first + i) * (size_t)r->basis->count, size);
      r->value[i * r->signs + k] = 0;
    }
  }
  return BW_OK;
}

static bw_status run_batch(run *r, bwi_loads *loads,
                           bw_status (*visit)(void *data, const bw_worst_case_visit *visit),
                           void *data) {
  bw_status status = BW_OK;
  bw_context *context = r->context;
  int64_t elements = r->system->mesh->element_count;
  double start = bw_seconds();
  BW_TRY(r->options->given ? take_given(r) : find_loads(r, loads));
  BW_TRY(bw_parallel(context, r->count, 1, force_body, r));
  BW_TRY(r->options->respond
             ? r->options->respond(context, r->options->respond_data, r->count, r->block)
             : bw_system_solve(context, r->system, r->count, r->block, r->block));
  double each = (bw_seconds() - start) / r->count;
  for (int first = 0; first < r->count; first += r->group) {
    r->group_first = first;
    r->group_count = r->count - first < r->group ? r->count - first : r->group;
    start = bw_seconds();
    BW_TRY(bw_check_cancel(context));
    /* A single one is called outside bw_parallel, so that its own loops may use all threads. */
    BW_TRY(r->group_count == 1 ? stress_body(r, 0, 1, 0)
                               : bw_parallel(context, r->group_count, 1, stress_body, r));
    double seconds = each + (bw_seconds() - start) / r->group_count;
    for (int g = 0; g < r->group_count; g++) {
      int i = first + g;
      int sign = chosen(r, i);
      bw_worst_case_visit v = {.region = r->first + i,
                               .pressure = pressure_of(r, i),
                               .displacement = block_of(r, i),
                               .stress = r->stress + 6 * (size_t)(g * elements),
                               .max_principal = r->principal + g * elements,
                               .objective = r->value[i * r->signs + sign],
                               .solve_error = solve_error(r, i, r->principal + g * elements),
                               .flipped = sign == 1 || is_opposite(r),
                               .seconds = seconds};
      BW_TRY(visit(data, &v));
    }
  }
done:
  return status;
}

bw_status bw_worst_case_run(bw_context *context, bw_system *system, const bw_pressure_basis *basis,
                            const bw_weak_regions *regions, const bw_worst_load_options *options,
                            int batch,
                            bw_status (*visit)(void *data, const bw_worst_case_visit *visit),
                            void *data, bw_solver_report *report) {
  bw_status status = BW_OK;
  bwi_loads *loads = NULL;
  run r = {
      .context = context, .system = system, .basis = basis, .regions = regions, .options = options};
  size_t nodes = (size_t)system->mesh->node_count, elements = (size_t)system->mesh->element_count;
  if (basis->mesh->node_count != system->mesh->node_count ||
      regions->mesh->node_count != system->mesh->node_count)
    return bw_fail(context, BW_INVALID,
                   "pressures of %d nodes and regions of %d nodes for a system of %d nodes: they "
                   "must be of the same mesh",
                   basis->mesh->node_count, regions->mesh->node_count, system->mesh->node_count);
  if (batch < 0)
    return bw_fail(context, BW_INVALID, "a batch of %d regions", batch);
  if (batch == 0)
    batch = system->iterative ? ITERATIVE_BATCH : FACTOR_BATCH;
  if (batch > regions->count)
    batch = regions->count;
  r.signs = options->one_sign ? 1 : 2;
  size_t fit = side_by_side / (elements * 7 * sizeof(double));
  r.group = fit < 1 ? 1 : fit < (size_t)batch ? (int)fit : batch;
  BW_TRY(bwi_loads_create(context, basis, system->dof_map, options, &loads));
  size_t programs = (size_t)batch * (size_t)r.signs;
  r.block = BW_NEW(context, double, (size_t)batch * 3 * nodes);
  r.objective = BW_NEW(context, double, programs *(size_t)basis->count);
  r.pressure = BW_NEW(context, double, programs *(size_t)basis->count);
  r.value = BW_NEW(context, double, programs);
  r.stress = BW_NEW(context, double, (size_t)r.group *elements * 6);
  r.principal = BW_NEW(context, double, (size_t)r.group *elements);
  BW_TRY_MEMORY(r.block && r.objective && r.pressure && r.value && r.stress && r.principal);
  for (r.first = 0; r.first < regions->count; r.first += batch) {
    bw_progress(context, "worst loads", (double)r.first / regions->count);
    BW_TRY(bw_check_cancel(context));
    r.count = regions->count - r.first < batch ? regions->count - r.first : batch;
    BW_TRY(run_batch(&r, loads, visit, data));
  }
  bw_progress(context, "worst loads", 1);
  if (report)
    bwi_loads_report(loads, NULL, report);
done:
  bwi_loads_destroy(loads);
  bw_free(r.block);
  bw_free(r.objective);
  bw_free(r.pressure);
  bw_free(r.value);
  bw_free(r.stress);
  bw_free(r.principal);
  return status;
}
