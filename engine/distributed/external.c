/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* The solver that the engine sees (bw_external): each operation begins on rank 0 with a command to
 * the others, runs on all, and ends with an agreement. */
#include <sys/resource.h>

#include "distributed/internal.h"

static bwd_system *current;

/* What takes most of the memory. */
static void release_matrices(bwd_system *system) {
  KSPDestroy(&system->solver);
  MatDestroy(&system->K);
  MatDestroy(&system->M);
  MatDestroy(&system->isostatic);
}

static void destroy(bwd_system *system) {
  if (!system)
    return;
  release_matrices(system);
  VecDestroy(&system->force);
  VecDestroy(&system->displacement);
  VecDestroy(&system->mask);
  VecDestroyVecs(system->motions, &system->motion);
  VecDestroyVecs(system->motions, &system->weighted);
  VecDestroy(&system->ghosted);
  VecScatterDestroy(&system->to_ghosted);
  bwd_local_mesh_clear(&system->mesh);
  bw_free(system->row_of);
  bw_free(system->start);
  bw_free(system->counts);
  bw_free(system->where);
  bw_free(system->field);
  bw_free(system);
}

static double processor_seconds(const struct rusage *usage) {
  return (double)(usage->ru_utime.tv_sec + usage->ru_stime.tv_sec) +
         1e-6 * (double)(usage->ru_utime.tv_usec + usage->ru_stime.tv_usec);
}

static bw_status ended(bw_context *context, bw_status status) {
  status = bwd_agree(context, status);
  if (status != BW_OK) {
    destroy(current);
    current = NULL;
  }
  return status;
}

bw_status bwd_run_open(bw_context *context, const bw_external_problem *problem,
                       const bw_solver *solver) {
  bw_status status = BW_OK;
  destroy(current);
  current = BW_NEW0(context, bwd_system, 1);
  BW_TRY(bwd_agree(context, current ? BW_OK : BW_MEMORY));
  BW_TRY(bwd_libraries(context));
  struct rusage usage;
  getrusage(RUSAGE_SELF, &usage);
  current->processor = processor_seconds(&usage);
  current->rank = bw_world_rank();
  current->ranks = bw_world_size();
  current->problem = problem;
  if (solver) { /* on rank 0, which tells the others */
    const bw_solver_options *o = &solver->options;
    current->direct = o->kind == BW_SOLVER_CHOLESKY;
    current->tolerance = o->tolerance > 0 ? o->tolerance : BW_EXTERNAL_TOLERANCE;
    current->max_iterations = o->max_iterations > 0 ? o->max_iterations : BW_EXTERNAL_ITERATIONS;
  }
  BW_TRY(bwd_distribute(context, current));
done:
  return ended(context, status);
}

bw_status bwd_run_multiply(bw_context *context, int count, const double *x, double *kx, double *mx,
                           double *magnitude) {
  return ended(context, bwd_multiply(context, current, count, x, kx, mx, magnitude));
}

/* One right-hand side after the other: what is gathered is one vector at a time. */
bw_status bwd_run_solve(bw_context *context, int count, const double *force, double *displacement) {
  bw_status status = BW_OK;
  int64_t size = 3 * (int64_t)current->nodes;
  MPI_Bcast(&count, 1, MPI_INT, 0, bwd_comm());
  BW_TRY(bwd_solver_create(context, current, 0.5 * current->tolerance));
  for (int k = 0; k < count; k++) {
    BW_TRY(bwd_scatter(context, current, force ? force + k * size : NULL, current->force));
    BW_TRY(bwd_solver_apply(context, current, current->force, current->displacement));
    BW_TRY(bwd_energy_error(context, current));
    BW_TRY(bwd_gather(context, current, current->displacement,
                      displacement ? displacement + k * size : NULL));
    if (bwd_cancelled(context)) {
      status = bw_fail(context, BW_CANCELLED, "cancelled");
      break;
    }
  }
done:
  return ended(context, status);
}

bw_status bwd_run_modes(bw_context *context, const bw_modes_options *options,
                        bw_external_modes *modes) {
  return ended(context, bwd_modes(context, current, options, modes));
}

bw_status bwd_run_write(bw_context *context, const bw_external_output *output) {
  release_matrices(current);
  return ended(context, bwd_write(context, current, output));
}

void bwd_run_report(bw_external_report *report) {
  struct rusage usage;
  getrusage(RUSAGE_SELF, &usage);
  double own[2] = {1024.0 * (double)usage.ru_maxrss, processor_seconds(&usage)};
  double sum[2] = {0, 0}, max = 0;
  if (current)
    own[1] -= current->processor;
  MPI_Reduce(own, sum, 2, MPI_DOUBLE, MPI_SUM, 0, bwd_comm());
  MPI_Reduce(own, &max, 1, MPI_DOUBLE, MPI_MAX, 0, bwd_comm());
  if (report && current)
    *report = (bw_external_report){.ranks = current->ranks,
                                   .iterations = current->iterations,
                                   .energy_error = current->energy_error,
                                   .send = current->seconds_send,
                                   .assembly = current->seconds_assembly,
                                   .setup = current->seconds_setup,
                                   .solve = current->seconds_solve,
                                   .processor = sum[1],
                                   .bytes = sum[0],
                                   .largest = max};
}

void bwd_run_close(void) {
  destroy(current);
  current = NULL;
}

/* ---- on rank 0 ------------------------------------------------------------------------------- */

static bw_status external_open(bw_context *context, const bw_external_problem *problem,
                               const bw_solver *solver) {
  bw_status status = bwd_command(context, BWD_OPEN);
  return status == BW_OK ? bwd_run_open(context, problem, solver) : status;
}

static bw_status external_multiply(bw_context *context, int count, const double *x, double *kx,
                                   double *mx, double *magnitude) {
  bw_status status = bwd_command(context, BWD_MULTIPLY);
  return status == BW_OK ? bwd_run_multiply(context, count, x, kx, mx, magnitude) : status;
}

static bw_status external_solve(bw_context *context, int count, const double *force,
                                double *displacement) {
  bw_status status = bwd_command(context, BWD_SOLVE);
  return status == BW_OK ? bwd_run_solve(context, count, force, displacement) : status;
}

static bw_status external_modes(bw_context *context, const bw_modes_options *options,
                                bw_external_modes *modes) {
  bw_status status = bwd_command(context, BWD_MODES);
  return status == BW_OK ? bwd_run_modes(context, options, modes) : status;
}

static bw_status external_write(bw_context *context, const bw_external_output *output) {
  bw_status status = bwd_command(context, BWD_WRITE);
  return status == BW_OK ? bwd_run_write(context, output) : status;
}

static void external_report(bw_context *context, bw_external_report *report) {
  if (bwd_command(context, BWD_REPORT) == BW_OK)
    bwd_run_report(report);
}

static void external_close(void) {
  if (bwd_command(NULL, BWD_CLOSE) == BW_OK)
    bwd_run_close();
}

const bw_external bwd_external = {.open = external_open,
                                  .multiply = external_multiply,
                                  .solve = external_solve,
                                  .modes = external_modes,
                                  .write = external_write,
                                  .report = external_report,
                                  .close = external_close};
