/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* The modes of a plate: rigid-body motions projected out (responsive, appendix A), the last frame's
 * modes as the start, the last frame's factor as the preconditioner. */
#include <limits.h>
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "responsive/plate.h"

enum { RIGID = BWI_PLANE_MOTIONS, GUARDS = 2, ROUNDS = 400, PAST = 2 };

void bw_plate_options_default(bw_plate_options *options) {
  *options = (bw_plate_options){.modes = 1, .tolerance = 1e-6, .max_lag = INT_MAX};
}

typedef struct problem {
  const bw_plate *plate;
  const double *rotation; /* from the factor's shape to this one; NULL: they are the same */
  double *workspace;      /* one vector */
} problem;

static bw_status times_stiffness(bw_context *context, const void *data, const double *x,
                                 double *y) {
  const bwi_plate_matrices *m = ((const problem *)data)->plate->inner->now->matrices;
  return bw_plane_multiply(context, m->pattern, 3, m->stiffness, x, y);
}

static bw_status times_mass(bw_context *context, const void *data, const double *x, double *y) {
  return bwi_plate_multiply_mass(context, ((const problem *)data)->plate, x, y);
}

static bw_status precondition(bw_context *context, const void *data, const double *x, double *y) {
  const problem *p = data;
  bwi_lagged *factor = p->plate->inner->factor;
  int64_t nodes = p->plate->mesh->topology->nodes->node_count;
  if (!p->rotation)
    return bwi_lagged_apply(context, factor, false, x, y);
  memcpy(p->workspace, x, (size_t)(3 * nodes) * sizeof *x);
  bwi_plate_rotate(nodes, p->rotation, true, p->workspace);
  bw_status status = bwi_lagged_apply(context, factor, true, p->workspace, y);
  if (status == BW_OK)
    bwi_plate_rotate(nodes, p->rotation, false, y);
  return status;
}

/* One deflection and two tilts (grad w + b = 0). */
static void rigid_motions(const bw_plate *plate, double *rigid) {
  int64_t nodes = plate->mesh->topology->nodes->node_count, n = 3 * nodes;
  const double *x = plate->mesh->point;
  double middle[2] = {0};
  for (int64_t i = 0; i < nodes; i++)
    for (int c = 0; c < 2; c++)
      middle[c] += x[2 * i + c] / (double)nodes;
  memset(rigid, 0, (size_t)(RIGID * n) * sizeof *rigid);
  for (int64_t i = 0; i < nodes; i++) {
    rigid[3 * i] = 1;
    for (int c = 0; c < 2; c++) {
      rigid[(1 + c) * n + 3 * i] = x[2 * i + c] - middle[c];
      rigid[(1 + c) * n + 3 * i + 1 + c] = -1;
    }
  }
}

/* The largest deflection positive. */
static void fix_sign(double *shape, int64_t nodes) {
  int64_t largest = 0;
  for (int64_t i = 1; i < nodes; i++)
    if (fabs(shape[3 * i]) > fabs(shape[3 * largest]) * (1 + 1e-9))
      largest = i;
  if (shape[3 * largest] < 0)
    for (int64_t i = 0; i < 3 * nodes; i++)
      shape[i] = -shape[i];
}

static bw_status refactor(bw_context *context, const bw_plate *plate, bool full,
                          bw_plane_reuse *reuse) {
  struct bwi_plate *in = plate->inner;
  const bwi_plate_matrices *m = in->now->matrices;
  double before = bw_seconds();
  bwi_lagged_work work;
  size_t numbers = 2 * (size_t)plate->mesh->topology->nodes->node_count;
  double *origin = BW_NEW(context, double, numbers);
  if (!origin)
    return BW_MEMORY;
  memcpy(origin, plate->mesh->point, numbers * sizeof *origin);
  bw_free(in->origin);
  in->origin = origin;
  if (full)
    bwi_lagged_reset(in->factor);
  in->factored = false;
  bw_status status = bwi_lagged_factor(context, in->factor, m->pattern, m->shifted, &work);
  in->factored = status == BW_OK;
  in->lag = 0;
  in->factor_bytes = work.bytes;
  reuse->report.flops += work.flops;
  reuse->analyses += work.analysed;
  reuse->factorisations++;
  reuse->seconds_factor += bw_seconds() - before;
  return status;
}

/* The initial vectors, in `vector`: the shapes of the last solution, which are the newest of the
 * past too, and behind them those before: *former, or NULL. Returns how many are of the past. */
static int begin_vectors(const bw_plate *plate, const bw_plate_options *options, int block,
                         double *vector, const double **former) {
  const bw_plate_state *now = plate->inner->now;
  int64_t n = 3 * (int64_t)plate->mesh->topology->nodes->node_count;
  int begun = now->known - now->past, past = 0;
  *former = NULL;
  if (options->full || begun == 0)
    return 0;
  memcpy(vector, plate->shape, (size_t)((begun < block ? begun : block) * n) * sizeof *vector);
  size_t bytes = (size_t)(options->modes * n) * sizeof *vector;
  if (begun >= options->modes) {
    memcpy(vector + block * n, plate->shape, bytes);
    past = options->modes;
    if (plate->mode_count == options->modes && now->past > 0)
      *former = plate->shape + begun * n;
  }
  if (*former) {
    memcpy(vector + (block + past) * n, *former, bytes);
    past += options->modes;
  }
  return past;
}

/* Modes with the factor that is there, or a new one where there is none or it takes too long. */
static bw_status find_modes(bw_context *context, const bw_plate *plate,
                            const bw_plate_options *options, int block, const double *former,
                            double *vector, double *value, double *residual,
                            bw_plane_reuse *reuse) {
  bw_status status = BW_OK;
  struct bwi_plate *in = plate->inner;
  int64_t nodes = plate->mesh->topology->nodes->node_count, n = 3 * nodes;
  double *rigid = BW_NEW(context, double, 2 * RIGID * n), *rotation = NULL;
  const char *reason =
      options->full                 ? "a new factor was asked for"
      : !in->factored               ? "there is no factor of this mesh yet"
      : in->lag >= options->max_lag ? "the factor has served as many solutions as max_lag allows"
      : in->last > 2 * in->first_iterations + 6 ? "iterations on the lagged factor were many"
                                                : NULL;
  bool fresh = reason != NULL;
  int iterations = 0;
  if (!rigid)
    return BW_MEMORY;
  if (fresh)
    BW_TRY(refactor(context, plate, options->full, reuse));
  reuse->factor = !fresh;
  double before = bw_seconds();
  problem data = {plate, NULL, NULL};
  bwi_free_body body = {.size = n,
                        .data = &data,
                        .stiffness = times_stiffness,
                        .mass = times_mass,
                        .precondition = precondition,
                        .rigid = rigid};
  rigid_motions(plate, rigid);
  BW_TRY(bwi_free_body_begin(context, &body));
  if (!fresh) {
    rotation = BW_NEW(context, double, 7 * nodes);
    BW_TRY_MEMORY(rotation);
    BW_TRY(bwi_plate_rotations(context, &in->reference, plate->mesh->topology, in->origin,
                               plate->mesh->point, rotation));
    data.rotation = rotation;
    data.workspace = rotation + 4 * nodes;
  }
  const bwi_eigen_problem eigen = bwi_free_body_problem(&body);
  bwi_eigen_near near = {.wanted = options->modes,
                         .block = block,
                         .start = vector,
                         .more_count = former ? in->now->past : 0,
                         .more = former,
                         .tolerance = options->tolerance,
                         .limit = fresh ? ROUNDS : 2 * in->first_iterations + 20};
  status = bwi_eigen_follow(context, &eigen, &near, vector, value, residual, &iterations);
  if (status == BW_CONVERGENCE && !fresh) {
    bw_clear_failure(context);
    BW_TRY(refactor(context, plate, false, reuse));
    fresh = true;
    reason = "iterations on the lagged factor did not converge";
    data.rotation = NULL;
    reuse->factor = false;
    near.limit = ROUNDS;
    status = bwi_eigen_follow(context, &eigen, &near, vector, value, residual, &iterations);
  }
  BW_TRY(status);
  in->last = iterations;
  if (fresh)
    in->first_iterations = iterations;
  else
    in->lag++;
  reuse->iterations += iterations;
  reuse->solves++;
  reuse->seconds_solve += bw_seconds() - before;
  snprintf(reuse->report.reason, sizeof reuse->report.reason, "%s",
           reason ? reason : "plates are solved on the lagged factor while iterations are few");
done:
  bw_free(rigid);
  bw_free(rotation);
  return status;
}

/* The reason is there already. */
static void fill_report(const bw_plate *plate, double seconds, bw_plane_reuse *reuse) {
  bw_solver_report *report = &reuse->report;
  report->solver = "lobpcg";
  report->backend = bw_backend_word(BW_BACKEND_MULTIFRONTAL);
  report->preconditioner = bw_solver_word(BW_SOLVER_CHOLESKY);
  report->bytes = fmax(report->bytes, plate->inner->factor_bytes);
  report->seconds += seconds;
  report->iterations = reuse->iterations;
  report->residual = reuse->residual;
  report->reused = fmax(0, 1 - (double)reuse->factorisations / reuse->solves);
}

bw_status bw_plate_solve(bw_context *context, bw_plate *plate, const bw_plate_options *given,
                         bw_plane_reuse *reuse) {
  bw_status status = BW_OK;
  bw_plate_options options;
  bw_plate_options_default(&options);
  if (given)
    options = *given;
  bw_plate_state *next = NULL;
  int64_t nodes = plate->mesh->topology->nodes->node_count, n = 3 * nodes;
  bw_plane_reuse none = {0};
  double start = bw_seconds();
  reuse = bwi_reuse_of(reuse, &none);
  if (options.modes < 1 || options.modes >= n - GUARDS - RIGID)
    return bw_fail(context, BW_INVALID,
                   "%d modes requested of a plate with %lld unknowns: from 1 to %lld expected",
                   options.modes, (long long)n, (long long)(n - GUARDS - RIGID - 1));
  if (!(options.tolerance > 0) || options.max_lag < 0)
    return bw_fail(context, BW_INVALID,
                   "a tolerance of %g and a lag of at most %d solutions: above 0, and 0 or more, "
                   "expected",
                   options.tolerance, options.max_lag);
  const bw_eigensolver_options *e = options.solver ? &options.solver->options : NULL;
  if (e &&
      ((e->kind != BW_EIGENSOLVER_LOBPCG && e->kind != BW_EIGENSOLVER_AUTO) || e->preconditioner))
    return bw_fail(context, BW_INVALID,
                   "the eigensolver %s%s does not serve plates that follow an outline: give lobpcg "
                   "without further options",
                   bw_eigensolver_name(options.solver),
                   e->preconditioner ? " with a preconditioner" : "");
  int block = options.modes + GUARDS;
  double *vector = BW_NEW0(context, double, (block + PAST * options.modes) * n),
         *value = BW_NEW(context, double, block), *frequency = BW_NEW(context, double, block),
         *residual = BW_NEW(context, double, block);
  BW_TRY_MEMORY(vector && value && frequency && residual);
  const double *former;
  int past = begin_vectors(plate, &options, block, vector, &former);
  BW_TRY(find_modes(context, plate, &options, block, former, vector, value, residual, reuse));
  for (int k = 0; k < block; k++)
    fix_sign(vector + k * n, nodes);
  for (int k = 0; k < options.modes; k++) {
    frequency[k] = sqrt(fmax(value[k], 0)) / (2 * 3.14159265358979323846);
    reuse->residual = fmax(reuse->residual, residual[k]);
  }
  BW_TRY(bwi_plate_blank(context, plate->mesh, plate->inner->now->matrices, &next));
  next->shape = vector;
  next->frequency = frequency;
  next->residual = residual;
  vector = frequency = residual = NULL;
  next->mode_count = options.modes;
  next->known = block + past;
  next->past = past;
  BW_TRY(bwi_plate_commit(context, plate, next));
  fill_report(plate, bw_seconds() - start, reuse);
done:
  bw_release(next);
  bw_free(vector);
  bw_free(value);
  bw_free(frequency);
  bw_free(residual);
  return status;
}
