/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* Modes K x = lambda M x by SLEPc's Krylov-Schur method on Op = P K^-1 P^T M, as the engine's own
 * Lanczos does: symmetric in the inner product of M, 1/lambda on elastic modes, 0 on rigid-body
 * motions, so that free bodies need nothing special. K^-1 is the factor, or conjugate gradients to
 * a tolerance far below that of the modes. */
#include <math.h>
#include <slepceps.h>
#include <string.h>

#include "distributed/internal.h"

enum { FURTHER = 4, RECOVERIES = 4 };

typedef struct elastic {
  bw_context *context;
  bwd_system *system;
  Vec work;
  bw_status status; /* of an apply that failed */
  int solves, expected;
  char stage[24]; /* of progress */
} elastic;

/* a = basis^T v; v -= other a */
static bw_status take_off(bw_context *context, int count, Vec *basis, Vec *other, Vec v) {
  bw_status status = BW_OK;
  PetscScalar *part = BW_NEW(context, PetscScalar, count);
  if (!part)
    return BW_MEMORY; /* a few numbers: reported at the next agreement */
  BWD_TRY(VecMDot(v, count, basis, part));
  for (int k = 0; k < count; k++)
    part[k] = -part[k];
  BWD_TRY(VecMAXPY(v, count, part, other));
done:
  bw_free(part);
  return status;
}

/* u = P K^-1 P^T f; f is changed. */
static bw_status invert(elastic *e, Vec f, Vec u) {
  bw_status status = BW_OK;
  bw_context *context = e->context;
  bwd_system *s = e->system;
  if (s->motions > 0) /* P^T f = f - W R (R^T f) */
    BW_TRY(take_off(context, s->motions, s->motion, s->weighted, f));
  BW_TRY(bwd_solver_apply(context, s, f, u));
  if (s->motions > 0) /* P u = u - R (W R)^T u */
    BW_TRY(take_off(context, s->motions, s->weighted, s->motion, u));
  e->solves++;
  if (s->rank == 0)
    bw_progress(context, e->stage, fmin(0.95, (double)e->solves / e->expected));
  if (bwd_cancelled(context))
    status = bw_fail(context, BW_CANCELLED, "cancelled");
done:
  return status;
}

static bw_status apply(elastic *e, Vec x, Vec y) {
  bw_status status = BW_OK;
  bw_context *context = e->context;
  BWD_TRY(MatMult(e->system->M, x, e->work));
  BW_TRY(invert(e, e->work, y));
done:
  return status;
}

/* SLEPc's shift and invert at 0 multiplies by M and asks for K^-1: here it is. */
static PetscErrorCode shell_apply(PC pc, Vec f, Vec u) {
  elastic *e;
  PetscErrorCode code = PCShellGetContext(pc, &e);
  if (code == 0)
    code = VecCopy(f, e->work);
  if (code == 0) {
    e->status = invert(e, e->work, u);
    if (e->status != BW_OK)
      code = PETSC_ERR_USER;
  }
  return code;
}

/* ---- a set of modes -------------------------------------------------------------------------- */

typedef struct set {
  int count, capacity;
  double *theta; /* descending */
  Vec *vector;   /* M-orthonormal */
} set;

static void set_clear(set *s) {
  VecDestroyVecs(s->capacity, &s->vector);
  bw_free(s->theta);
  *s = (set){0};
}

static bw_status set_create(bw_context *context, bwd_system *system, int capacity, set *s) {
  bw_status status = BW_OK;
  *s = (set){.capacity = capacity, .theta = BW_NEW(context, double, capacity)};
  BW_TRY(bwd_agree(context, s->theta ? BW_OK : BW_MEMORY));
  BWD_TRY(VecDuplicateVecs(system->force, capacity, &s->vector));
done:
  return status;
}

/* The first vector: the same for any number of ranks. */
static bw_status random_start(elastic *e, uint64_t seed, Vec start) {
  bw_status status = BW_OK;
  bw_context *context = e->context;
  bwd_system *system = e->system;
  double *field = NULL;
  Vec random = NULL;
  if (system->rank == 0) {
    field = BW_NEW(context, double, 3 * (int64_t)system->nodes);
    if (!field)
      status = BW_MEMORY;
  }
  BW_TRY(bwd_agree(context, status));
  if (system->rank == 0) {
    bw_random generator;
    bw_random_seed(&generator, seed);
    for (int64_t i = 0; i < 3 * (int64_t)system->nodes; i++)
      field[i] = bw_random_normal(&generator);
  }
  BWD_TRY(VecDuplicate(start, &random));
  BW_TRY(bwd_scatter(context, system, field, random));
  BW_TRY(apply(e, random, start)); /* zero at prescribed components, no rigid-body motion */
done:
  VecDestroy(&random);
  bw_free(field);
  return status;
}

/* Modes orthogonal to those in `known`, lowest first, appended to `found`. */
static bw_status search(elastic *e, int wanted, double tolerance, uint64_t seed, const set *known,
                        set *found) {
  bw_status status = BW_OK;
  bw_context *context = e->context;
  bwd_system *system = e->system;
  EPS solver = NULL;
  ST st;
  KSP inner;
  PC shell;
  Vec start = NULL;
  PetscInt converged = 0;
  BWD_TRY(VecDuplicate(system->force, &start));
  BW_TRY(random_start(e, seed, start));
  BWD_TRY(EPSCreate(PETSC_COMM_WORLD, &solver));
  BWD_TRY(EPSSetOptionsPrefix(solver, "barwright_"));
  BWD_TRY(EPSSetOperators(solver, system->K, system->M));
  BWD_TRY(EPSSetProblemType(solver, EPS_GHEP));
  BWD_TRY(EPSSetType(solver, EPSKRYLOVSCHUR));
  BWD_TRY(EPSSetWhichEigenpairs(solver, EPS_TARGET_MAGNITUDE));
  BWD_TRY(EPSSetTarget(solver, 0));
  BWD_TRY(EPSSetDimensions(solver, wanted, PETSC_DEFAULT, PETSC_DEFAULT));
  BWD_TRY(EPSSetTolerances(solver, tolerance, 1000));
  BWD_TRY(EPSSetPurify(solver, PETSC_FALSE)); /* start and Op are clean of prescribed components */
  BWD_TRY(EPSGetST(solver, &st));
  BWD_TRY(STSetType(st, STSINVERT));
  BWD_TRY(STSetMatMode(st, ST_MATMODE_SHELL)); /* no copy of K */
  BWD_TRY(STGetKSP(st, &inner));
  BWD_TRY(KSPSetType(inner, KSPPREONLY));
  BWD_TRY(KSPGetPC(inner, &shell));
  BWD_TRY(PCSetType(shell, PCSHELL));
  BWD_TRY(PCShellSetContext(shell, e));
  BWD_TRY(PCShellSetApply(shell, shell_apply));
  BWD_TRY(EPSSetInitialSpace(solver, 1, &start));
  if (known->count > 0)
    BWD_TRY(EPSSetDeflationSpace(solver, known->count, known->vector));
  BWD_TRY(EPSSetFromOptions(solver));
  PetscErrorCode code = EPSSolve(solver);
  if (code != 0) {
    status = e->status != BW_OK ? e->status : bwd_petsc_status(context, code);
    goto done;
  }
  BWD_TRY(EPSGetConverged(solver, &converged));
  for (PetscInt k = 0; k < converged && found->count < found->capacity; k++) {
    PetscScalar lambda;
    BWD_TRY(EPSGetEigenpair(solver, k, &lambda, NULL, found->vector[found->count], NULL));
    if (lambda > 0)
      found->theta[found->count++] = 1 / lambda;
  }
done:
  EPSDestroy(&solver);
  VecDestroy(&start);
  return status;
}

/* ---- refinement ------------------------------------------------------------------------------ */

static bw_status orthonormalise(elastic *e, int count, Vec *vector) {
  bw_status status = BW_OK;
  bw_context *context = e->context;
  PetscScalar *part = BW_NEW(context, PetscScalar, count);
  BW_TRY(bwd_agree(context, part ? BW_OK : BW_MEMORY));
  for (int k = 0; k < count; k++)
    for (int pass = 0; pass < 2; pass++) {
      PetscScalar norm;
      BWD_TRY(MatMult(e->system->M, vector[k], e->work));
      if (k > 0) {
        BWD_TRY(VecMDot(e->work, k, vector, part));
        for (int j = 0; j < k; j++)
          part[j] = -part[j];
        BWD_TRY(VecMAXPY(vector[k], k, part, vector));
        BWD_TRY(MatMult(e->system->M, vector[k], e->work));
      }
      BWD_TRY(VecDot(vector[k], e->work, &norm));
      if (!(norm > 0)) {
        status = bw_fail(
            context, BW_CONVERGENCE,
            "the modes found are linearly dependent: ask for fewer modes, or a smaller tolerance");
        goto done;
      }
      BWD_TRY(VecScale(vector[k], 1 / sqrt(norm)));
    }
done:
  bw_free(part);
  return status;
}

void dsyev_(const char *job, const char *triangle, const int *n, double *a, const int *stride,
            double *value, double *work, const int *length, int *info);

/* Once more through Op, which divides what is left of high modes by their eigenvalues, and turned
 * within their span: X M-orthonormal, Y = Op X, X^T M Y = Q theta Q^T, X <- Y Q. Sorts, too. */
static bw_status refine(elastic *e, set *s) {
  bw_status status = BW_OK;
  bw_context *context = e->context;
  int count = s->count, length = 8 * count + 64, info = 0;
  double *gram = BW_NEW(context, double, (int64_t)count *count);
  double *theta = BW_NEW(context, double, count);
  double *work = BW_NEW(context, double, length);
  Vec *image = NULL;
  BW_TRY(bwd_agree(context, gram && theta && work ? BW_OK : BW_MEMORY));
  BWD_TRY(VecDuplicateVecs(e->work, count, &image));
  BW_TRY(orthonormalise(e, count, s->vector));
  for (int k = 0; k < count; k++) {
    BW_TRY(apply(e, s->vector[k], image[k]));
    BWD_TRY(MatMult(e->system->M, image[k], e->work));
    BWD_TRY(VecMDot(e->work, count, s->vector, gram + (int64_t)k * count));
  }
  for (int i = 0; i < count; i++)
    for (int j = 0; j < i; j++) {
      double mean = 0.5 * (gram[i * count + j] + gram[j * count + i]);
      gram[i * count + j] = gram[j * count + i] = -mean;
    }
  for (int i = 0; i < count; i++)
    gram[i * count + i] *= -1; /* so that the largest theta comes first */
  if (e->system->rank == 0)
    dsyev_("V", "L", &count, gram, &count, theta, work, &length, &info);
  MPI_Bcast(gram, count * count, MPI_DOUBLE, 0, bwd_comm());
  MPI_Bcast(theta, count, MPI_DOUBLE, 0, bwd_comm());
  MPI_Bcast(&info, 1, MPI_INT, 0, bwd_comm());
  if (info != 0) {
    status = bw_fail(context, BW_CONVERGENCE,
                     "the Rayleigh-Ritz step on %d modes failed: LAPACK's dsyev returned %d", count,
                     info);
    goto done;
  }
  for (int k = 0; k < count; k++) {
    BWD_TRY(VecSet(s->vector[k], 0));
    BWD_TRY(VecMAXPY(s->vector[k], count, gram + (int64_t)k * count, image));
    s->theta[k] = -theta[k];
  }
  BW_TRY(orthonormalise(e, count, s->vector));
done:
  VecDestroyVecs(count, &image);
  bw_free(gram);
  bw_free(theta);
  bw_free(work);
  return status;
}

/* ---- none missing? --------------------------------------------------------------------------- */

/* The index after the cluster of the last wanted mode, and a shift in the gap there; 0: no gap
 * among those known. */
static int find_gap(const set *s, int wanted, double fraction, double *shift) {
  for (int n = wanted; n < s->count; n++) {
    double low = 1 / s->theta[n - 1], high = 1 / s->theta[n];
    if (high - low > 1e-4 * low) {
      *shift = low + fraction * fmin(high - low, 0.03 * low);
      return n;
    }
  }
  return 0;
}

/* As the engine's own: a count of eigenvalues below a gap, and a search for what is missing. */
static bw_status check_count(elastic *e, const bw_modes_options *options, int wanted,
                             double tolerance, set *s, int *recovered, bool *counted) {
  bw_status status = BW_OK;
  bw_context *context = e->context;
  for (int attempt = 0; attempt < RECOVERIES; attempt++) {
    double shift = 0;
    int64_t below = 0;
    bool trusted = false;
    int n = find_gap(s, wanted, 0.3 + 0.1 * attempt, &shift);
    if (n == 0)
      return BW_OK;
    BW_TRY(bwd_count_below(context, e->system, shift, &below, &trusted));
    if (!trusted || below < n)
      continue;
    if (below == n) {
      *counted = true;
      return BW_OK;
    }
    int missing = (int)(below - n), before = s->count;
    if (s->capacity - s->count < missing) { /* room: those above the gap go */
      s->count = n;
      before = n;
    }
    if (s->capacity - s->count < missing)
      return BW_OK;
    BW_TRY(search(e, missing, tolerance, options->seed + 1 + (uint64_t)attempt, s, s));
    if (s->count == before)
      return BW_OK;
    *recovered += missing;
    BW_TRY(refine(e, s));
  }
done:
  return status;
}

/* ---- all of it ------------------------------------------------------------------------------- */

static bw_status deliver(bw_context *context, bwd_system *system, const set *s, int count,
                         bw_external_modes *modes) {
  bw_status status = BW_OK;
  int64_t size = 3 * (int64_t)system->nodes;
  if (modes) {
    modes->value = BW_NEW(context, double, count);
    modes->vector = BW_NEW(context, double, count *size);
    if (!modes->value || !modes->vector)
      status = BW_MEMORY;
  }
  BW_TRY(bwd_agree(context, status));
  for (int k = 0; k < count; k++) {
    BW_TRY(bwd_gather(context, system, s->vector[k], modes ? modes->vector + k * size : NULL));
    if (modes)
      modes->value[k] = 1 / s->theta[k];
  }
  if (modes)
    modes->count = count;
done:
  if (modes && status != BW_OK) {
    bw_free(modes->value);
    bw_free(modes->vector);
    modes->value = modes->vector = NULL;
  }
  return status;
}

bw_status bwd_modes(bw_context *context, bwd_system *system, const bw_modes_options *given,
                    bw_external_modes *modes) {
  bw_status status = BW_OK;
  bw_modes_options options = {0};
  elastic e = {.context = context, .system = system};
  set found = {0}, none = {0};
  int dimension = 0, recovered = 0;
  bool counted = false;
  if (given) {
    options = *given;
    dimension = system->problem->dof_map->unknown_count;
  }
  MPI_Bcast(&options, sizeof options, MPI_BYTE, 0, bwd_comm());
  MPI_Bcast(&dimension, 1, MPI_INT, 0, bwd_comm());
  int count = options.count < dimension ? options.count : dimension;
  int wanted = count + FURTHER < dimension ? count + FURTHER : dimension;
  double tolerance = fmin(1e-2 * options.tolerance, 1e-8);
  e.expected = 4 * wanted + 30;
  snprintf(e.stage, sizeof e.stage, "%d mode%s", count, count == 1 ? "" : "s");
  if (count > 0) {
    BWD_TRY(VecDuplicate(system->force, &e.work));
    BW_TRY(bwd_solver_create(context, system, fmin(1e-2 * options.tolerance, 1e-9)));
    BW_TRY(set_create(context, system, wanted + 2 * FURTHER, &found));
    BW_TRY(search(&e, wanted, tolerance, options.seed, &none, &found));
    if (found.count > 0)
      BW_TRY(refine(&e, &found));
    if (options.sturm && system->direct)
      BW_TRY(check_count(&e, &options, count < found.count ? count : found.count, tolerance, &found,
                         &recovered, &counted));
  }
  if (found.count < count && found.count < dimension) {
    status = bw_fail(context, BW_CONVERGENCE, "%d of %d modes were found: %s", found.count, count,
                     "SLEPc's solver stopped");
    goto done;
  }
  BW_TRY(deliver(context, system, &found, found.count < count ? found.count : count, modes));
  if (modes) {
    modes->solves = e.solves;
    modes->recovered = recovered;
    modes->counted = counted;
  }
done:
  set_clear(&found);
  VecDestroy(&e.work);
  return status;
}
