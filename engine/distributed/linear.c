/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* K u = f: conjugate gradients preconditioned by algebraic multigrid (PETSc's GAMG), or a Cholesky
 * factor spread over the ranks (MUMPS).
 *
 * Multigrid by smoothed aggregation needs to know what elements cannot feel: the six rigid-body
 * motions at all nodes, zero at prescribed components. A body that moves freely is solved as it is,
 * without isostatic constraints: K is singular, its null space is given, the force is balanced, and
 * conjugate gradients stay in the complement. (Isostatic constraints make the matrix regular, but
 * one to six eigenvalues very small, and each costs iterations.) A factor needs them. */
#include <math.h>
#include <string.h>

#include "distributed/internal.h"

enum { CANCEL_EVERY = 8 };

/* One of the rigid-body motions of the whole about its middle, at the rank's nodes, for multigrid:
 * zero where nothing is solved for. */
static bw_status rigid_vector(bw_context *context, const bwd_system *system, int which,
                              Vec vector) {
  bw_status status = BW_OK;
  const bwd_local_mesh *local = &system->mesh;
  double axis[3] = {0, 0, 0}, *own = NULL;
  axis[which % 3] = 1;
  BWD_TRY(VecGetArray(vector, &own));
  for (int32_t i = 0; i < system->local; i++) {
    double at[3], arm[3];
    memcpy(at, axis, sizeof at);
    if (which >= 3) {
      for (int c = 0; c < 3; c++)
        arm[c] = local->node[3 * (int64_t)i + c] - system->middle[c];
      bw_cross(axis, arm, at);
    }
    bwd_into_frame(bwd_local_frame(local, i), at, own + 3 * (int64_t)i);
  }
  BWD_TRY(VecRestoreArray(vector, &own));
  BWD_TRY(VecPointwiseMult(vector, vector, system->mask));
done:
  return status;
}

/* The first `known` of the vectors are orthonormal; so is vector[known] in the end. */
static bw_status orthonormalise(bw_context *context, int known, Vec *vector) {
  bw_status status = BW_OK;
  for (int pass = 0; pass < 2; pass++)
    for (int j = 0; j < known; j++) {
      PetscScalar dot;
      BWD_TRY(VecDot(vector[known], vector[j], &dot));
      BWD_TRY(VecAXPY(vector[known], -dot, vector[j]));
    }
  BWD_TRY(VecNormalize(vector[known], NULL));
done:
  return status;
}

/* A vector of the system, or what of it is at corners. */
static bw_status copy_level(bw_context *context, const bwd_linear_elements *linear, Vec from,
                            Vec to) {
  return linear ? bwd_linear_elements_inject(context, linear, from, to)
                : bwd_petsc_status(context, VecCopy(from, to));
}

/* For the matrix of the system, or with `linear` for that of the linear elements. */
static bw_status near_null_space(bw_context *context, bwd_system *system,
                                 const bwd_linear_elements *linear) {
  bw_status status = BW_OK;
  enum { RIGID = 6 };
  Mat matrix = linear ? linear->K : system->K;
  Vec *rigid = NULL, shape = NULL;
  MatNullSpace space = NULL;
  BWD_TRY(MatCreateVecs(matrix, &shape, NULL));
  BWD_TRY(VecDuplicateVecs(shape, RIGID, &rigid));
  for (int k = 0; k < RIGID; k++) {
    BW_TRY(rigid_vector(context, system, k, system->displacement));
    BW_TRY(copy_level(context, linear, system->displacement, rigid[k]));
    BW_TRY(orthonormalise(context, k, rigid));
  }
  BWD_TRY(MatNullSpaceCreate(PETSC_COMM_WORLD, PETSC_FALSE, RIGID, rigid, &space));
  BWD_TRY(MatSetNearNullSpace(matrix, space));
done:
  MatNullSpaceDestroy(&space);
  VecDestroyVecs(RIGID, &rigid);
  VecDestroy(&shape);
  return status;
}

/* The rigid-body modes, orthonormal as PETSc wants them. */
static bw_status null_space(bw_context *context, bwd_system *system,
                            const bwd_linear_elements *linear) {
  bw_status status = BW_OK;
  Mat matrix = linear ? linear->K : system->K;
  Vec *basis = NULL, shape = NULL;
  MatNullSpace space = NULL;
  if (system->motions == 0) {
    if (linear || !system->two_level) /* a matrix in blocks does not know the option */
      BWD_TRY(MatSetOption(matrix, MAT_SPD, PETSC_TRUE));
    return status;
  }
  BWD_TRY(MatCreateVecs(matrix, &shape, NULL));
  BWD_TRY(VecDuplicateVecs(shape, system->motions, &basis));
  for (int k = 0; k < system->motions; k++) {
    BW_TRY(copy_level(context, linear, system->motion[k], basis[k]));
    BW_TRY(orthonormalise(context, k, basis));
  }
  BWD_TRY(MatNullSpaceCreate(PETSC_COMM_WORLD, PETSC_FALSE, system->motions, basis, &space));
  BWD_TRY(MatSetNullSpace(matrix, space));
done:
  MatNullSpaceDestroy(&space);
  VecDestroyVecs(system->motions, &basis);
  VecDestroy(&shape);
  return status;
}

/* K with the isostatic components decoupled. */
static bw_status decouple_isostatic(bw_context *context, bwd_system *system) {
  bw_status status = BW_OK;
  PetscInt *row = BW_NEW(context, PetscInt, 3 * (int64_t)system->local);
  PetscInt count = 0;
  const double *mask = NULL;
  Vec main = NULL;
  BW_TRY(bwd_agree(context, row ? BW_OK : BW_MEMORY));
  BWD_TRY(VecDuplicate(system->force, &main));
  BWD_TRY(MatGetDiagonal(system->K, main));
  PetscReal size;
  BWD_TRY(VecNorm(main, NORM_INFINITY, &size));
  BWD_TRY(VecGetArrayRead(system->mask, &mask));
  for (PetscInt i = 0; i < 3 * system->local; i++)
    if (mask[i] == 0)
      row[count++] = 3 * system->first + i;
  BWD_TRY(VecRestoreArrayRead(system->mask, &mask));
  BWD_TRY(MatDuplicate(system->K, MAT_COPY_VALUES, &system->isostatic));
  BWD_TRY(MatZeroRowsColumns(system->isostatic, count, row, size, NULL, NULL));
done:
  VecDestroy(&main);
  bw_free(row);
  return status;
}

/* ---- stopping -------------------------------------------------------------------------------- */

typedef struct watch {
  bw_context *context;
  bwd_system *system;
  PetscReal first;
  void *test; /* PETSc's own data */
} watch;

static PetscErrorCode watch_destroy(void *data) {
  watch *w = data;
  PetscErrorCode code = KSPConvergedDefaultDestroy(w->test);
  bw_free(w);
  return code;
}

/* PETSc's own test; now and then it asks for cancelling and reports progress. */
static PetscErrorCode converged(KSP solver, PetscInt iteration, PetscReal norm,
                                KSPConvergedReason *reason, void *data) {
  watch *w = data;
  PetscErrorCode code = KSPConvergedDefault(solver, iteration, norm, reason, w->test);
  if (code != 0)
    return code;
  if (iteration == 0)
    w->first = norm;
  if (*reason == KSP_CONVERGED_ITERATING && iteration % CANCEL_EVERY == 0) {
    PetscReal wanted = -log(w->system->tolerance);
    if (w->system->rank == 0 && w->first > 0 && norm > 0 && wanted > 0)
      bw_progress(w->context, "conjugate gradients",
                  fmin(0.99, fmax(0, log(w->first / norm) / wanted)));
    if (bwd_cancelled(w->context))      /* the progress function may have cancelled */
      *reason = KSP_DIVERGED_BREAKDOWN; /* distinguished by the flag */
  }
  return 0;
}

/* ---- making ---------------------------------------------------------------------------------- */

/* Aggregates of neighbours of neighbours on the finest level, as Vanek, Mandel and Brezina have
 * them: twice the iterations of aggregates of neighbours, for a sixth of the setup and half of the
 * memory (46,875 unknowns of tet10, 1e-8: 31 iterations and 2.0 s for 20 and 8.2 s). Who sets an
 * option in PETSC_OPTIONS is obeyed. */
static bw_status multigrid_defaults(bw_context *context) {
  bw_status status = BW_OK;
  static const char *const list[][2] = {
      {"-barwright_pc_gamg_square_graph", "1"},           /* before PETSc 3.18 */
      {"-barwright_pc_gamg_aggressive_coarsening", "1"},  /* the same, later */
      {"-barwright_mg_coarse_pc_gamg_square_graph", "1"}, /* below linear elements */
      {"-barwright_mg_coarse_pc_gamg_aggressive_coarsening", "1"},
      {"-barwright_mg_levels_1_esteig_ksp_type", "cg"}, /* GMRES would keep ten vectors more */
  };
  for (size_t k = 0; k < sizeof list / sizeof *list; k++) {
    PetscBool set;
    BWD_TRY(PetscOptionsHasName(NULL, NULL, list[k][0], &set));
    if (!set)
      BWD_TRY(PetscOptionsSetValue(NULL, list[k][0], list[k][1]));
  }
done:
  return status;
}

/* What the setup of multigrid leaves behind for a matrix with other values, which never comes: the
 * factors of its products, and the vectors that eigenvalues were estimated with. */
static bw_status forget_setup(bw_context *context, PC multigrid) {
  bw_status status = BW_OK;
  PetscInt levels = 0;
  BWD_TRY(PCMGGetLevels(multigrid, &levels));
  for (PetscInt l = 0; l < levels; l++) {
    KSP smoother;
    Mat matrix = NULL, interpolation = NULL;
    BWD_TRY(PCMGGetSmoother(multigrid, l, &smoother));
    BWD_TRY(KSPGetOperators(smoother, &matrix, NULL));
    BWD_TRY(MatProductClear(matrix));
    if (l == 0)
      continue;
    BWD_TRY(PCMGGetInterpolation(multigrid, l, &interpolation));
    BWD_TRY(MatProductClear(interpolation));
    BWD_TRY(KSPChebyshevEstEigSet(smoother, 0, 0, 0, 0)); /* nothing where it is another one */
  }
done:
  return status;
}

static bw_status begin_solver(bw_context *context, bwd_system *system) {
  bw_status status = BW_OK;
  if (!system->solver) {
    BWD_TRY(KSPCreate(PETSC_COMM_WORLD, &system->solver));
    BWD_TRY(KSPSetOptionsPrefix(system->solver, "barwright_"));
  }
done:
  return status;
}

bw_status bwd_coarse_create(bw_context *context, bwd_system *system) {
  bw_status status = BW_OK;
  double begin = bw_seconds();
  bwd_linear_elements linear = {0};
  KSP coarse, smoother;
  PC pc, below, point;
  if (system->rank == 0)
    bw_progress(context, "multigrid", 0);
  BW_TRY(begin_solver(context, system));
  BW_TRY(multigrid_defaults(context));
  BWD_TRY(KSPGetPC(system->solver, &pc));
  BW_TRY(bwd_linear_elements_create(context, system, &linear));
  BW_TRY(near_null_space(context, system, &linear));
  BW_TRY(null_space(context, system, &linear));
  BWD_TRY(PCSetType(pc, PCMG));
  BWD_TRY(PCMGSetLevels(pc, 2, NULL));
  BWD_TRY(PCMGSetInterpolation(pc, 1, linear.interpolation));
  BWD_TRY(PCMGGetCoarseSolve(pc, &coarse));
  BWD_TRY(KSPSetOperators(coarse, linear.K, linear.K));
  BWD_TRY(KSPSetType(coarse, KSPPREONLY));
  BWD_TRY(KSPGetPC(coarse, &below));
  BWD_TRY(PCSetType(below, PCGAMG));
  BWD_TRY(KSPSetFromOptions(coarse));
  BWD_TRY(KSPSetUp(coarse));
  BW_TRY(forget_setup(context, below));
  BWD_TRY(PCMGGetSmoother(pc, 1, &smoother));
  BWD_TRY(KSPSetType(smoother, KSPCHEBYSHEV));
  BWD_TRY(KSPSetTolerances(smoother, PETSC_DEFAULT, PETSC_DEFAULT, PETSC_DEFAULT, 2));
  BWD_TRY(KSPGetPC(smoother, &point));
  BWD_TRY(PCSetType(point, PCJACOBI));
done:
  bwd_linear_elements_clear(&linear);
  system->seconds_setup += bw_seconds() - begin;
  return status;
}

static bw_status with_multigrid(bw_context *context, bwd_system *system, double rtol) {
  bw_status status = BW_OK;
  PC pc;
  watch *w = BW_NEW0(context, watch, 1);
  BW_TRY(bwd_agree(context, w ? BW_OK : BW_MEMORY));
  *w = (watch){.context = context, .system = system};
  BW_TRY(null_space(context, system, NULL));
  BWD_TRY(KSPSetOperators(system->solver, system->K, system->K));
  BWD_TRY(KSPSetType(system->solver, KSPCG));
  BWD_TRY(KSPSetNormType(system->solver, KSP_NORM_UNPRECONDITIONED));
  BWD_TRY(KSPSetComputeEigenvalues(system->solver, PETSC_TRUE)); /* for bwd_energy_error */
  BWD_TRY(KSPSetTolerances(system->solver, rtol, 0, 1e10, system->max_iterations));
  BWD_TRY(KSPConvergedDefaultCreate(&w->test));
  BWD_TRY(KSPSetConvergenceTest(system->solver, converged, w, watch_destroy));
  w = NULL;
  if (!system->two_level) {
    BW_TRY(multigrid_defaults(context));
    BW_TRY(near_null_space(context, system, NULL));
    BWD_TRY(KSPGetPC(system->solver, &pc));
    BWD_TRY(PCSetType(pc, PCGAMG));
  }
done:
  bw_free(w);
  return status;
}

static bw_status with_factor(bw_context *context, bwd_system *system, int percent) {
  bw_status status = BW_OK;
  PC pc;
  Mat factor;
  if (system->motions > 0 && !system->isostatic)
    BW_TRY(decouple_isostatic(context, system));
  Mat matrix = system->isostatic ? system->isostatic : system->K;
  BWD_TRY(MatSetOption(matrix, MAT_SPD, PETSC_TRUE));
  BWD_TRY(KSPSetOperators(system->solver, matrix, matrix));
  BWD_TRY(KSPSetType(system->solver, KSPPREONLY));
  BWD_TRY(KSPGetPC(system->solver, &pc));
  BWD_TRY(PCSetType(pc, PCCHOLESKY));
  BWD_TRY(PCFactorSetMatSolverType(pc, MATSOLVERMUMPS));
  BWD_TRY(PCFactorSetUpMatSolverType(pc));
  BWD_TRY(PCFactorGetMatrix(pc, &factor));
  BWD_TRY(MatMumpsSetIcntl(factor, 14, percent));
done:
  return status;
}

/* What PETSc keeps as the reason of a factor that could not be made. */
static bw_status factor_failed(bw_context *context, const bwd_system *system) {
  PC pc;
  PCFailedReason reason = PC_NOERROR;
  KSPGetPC(system->solver, &pc);
  PCGetFailedReason(pc, &reason);
  if (reason == PC_FACTOR_OUTMEMORY)
    return bw_fail(context, BW_MEMORY, "memory ran out in the factorisation on %d ranks",
                   system->ranks);
  if (reason == PC_NOERROR)
    return BW_OK;
  return bw_fail(context, BW_SINGULAR,
                 "the stiffness is singular, or so nearly that double precision cannot tell, "
                 "although the body cannot move freely: parts that touch only in a node or an edge "
                 "rotate there. Join the parts properly, or mesh again; without an external solver "
                 "the message names the node");
}

/* MUMPS plans its memory before it factors, and with several ranks it may need more: percent of
 * room beside the plan. */
static const int memory_percent[] = {30, 100, 400};
enum { TRIES = 3 };

/* Too little room, in MUMPS's numbers for it; not the system's memory. */
static bool wants_memory(Mat factor) {
  PetscInt code = 0;
  if (MatMumpsGetInfog(factor, 1, &code) != 0)
    return false;
  return code == -8 || code == -9 || code == -11 || code == -12 || code == -14 || code == -15;
}

static bw_status set_up(bw_context *context, bwd_system *system, double rtol, int percent) {
  bw_status status = BW_OK;
  PC pc;
  PetscBool multigrid;
  BW_TRY(begin_solver(context, system));
  if (system->direct)
    BW_TRY(with_factor(context, system, percent));
  else
    BW_TRY(with_multigrid(context, system, rtol));
  BWD_TRY(KSPSetFromOptions(system->solver)); /* PETSC_OPTIONS="-barwright_..." for who knows */
  BWD_TRY(KSPSetUp(system->solver));
  BWD_TRY(KSPGetPC(system->solver, &pc));
  BWD_TRY(PetscObjectTypeCompareAny((PetscObject)pc, &multigrid, PCMG, PCGAMG, ""));
  if (multigrid)
    BW_TRY(forget_setup(context, pc));
done:
  return status;
}

bw_status bwd_solver_create(bw_context *context, bwd_system *system, double rtol) {
  bw_status status = BW_OK;
  double begin = bw_seconds();
  if (system->ready) {
    BWD_TRY(KSPSetTolerances(system->solver, rtol, 0, 1e10, system->max_iterations));
    return status;
  }
  if (system->rank == 0)
    bw_progress(context, system->direct ? "factorisation" : "multigrid", 0);
  BW_TRY(set_up(context, system, rtol, memory_percent[0]));
  for (int k = 1; k < TRIES && system->direct; k++) {
    PC pc;
    Mat factor;
    BWD_TRY(KSPGetPC(system->solver, &pc));
    BWD_TRY(PCFactorGetMatrix(pc, &factor));
    if (!wants_memory(factor))
      break;
    BWD_TRY(KSPDestroy(&system->solver));
    BW_TRY(set_up(context, system, rtol, memory_percent[k]));
  }
  BW_TRY(factor_failed(context, system));
  system->ready = true;
done:
  system->seconds_setup += bw_seconds() - begin;
  return status;
}

/* ---- solving --------------------------------------------------------------------------------- */

bw_status bwd_solver_apply(bw_context *context, bwd_system *system, Vec force, Vec displacement) {
  bw_status status = BW_OK;
  KSPConvergedReason reason;
  PetscInt iterations = 0;
  double begin = bw_seconds();
  BWD_TRY(VecPointwiseMult(force, force, system->mask));
  if (!system->direct && system->motions > 0) {
    MatNullSpace space;
    BWD_TRY(MatGetNullSpace(system->K, &space));
    BWD_TRY(MatNullSpaceRemove(space, force));
  }
  BWD_TRY(KSPSolve(system->solver, force, displacement));
  BWD_TRY(KSPGetConvergedReason(system->solver, &reason));
  BWD_TRY(KSPGetIterationNumber(system->solver, &iterations));
  if (!system->direct)
    system->iterations += (int)iterations;
  if (reason > 0)
    goto done;
  if (bwd_cancelled(context)) {
    bw_check_cancel(context);
    status = bw_fail(context, BW_CANCELLED, "cancelled");
  } else if (reason == KSP_DIVERGED_ITS) {
    status = bw_fail(context, BW_CONVERGENCE,
                     "conjugate gradients have not converged in %d iterations. Thin parts and poor "
                     "elements make convergence slow: allow more iterations, give a larger "
                     "tolerance, or a Cholesky factor",
                     (int)iterations);
    bw_detail_number(context, "iterations", (double)iterations);
  } else {
    BW_TRY(factor_failed(context, system));
    status = bw_fail(context, BW_CONVERGENCE, "PETSc's solver stopped after %d iterations: %s",
                     (int)iterations, KSPConvergedReasons[reason]);
    bw_detail_number(context, "iterations", (double)iterations);
  }
done:
  system->seconds_solve += bw_seconds() - begin;
  return status;
}

/* With the residual r, the preconditioner B and the lowest eigenvalue of B K, of which the
 * coefficients of conjugate gradients give an estimate, the error e has
 *     e . K e = r . K^-1 r <= r . B r / lowest. */
bw_status bwd_energy_error(bw_context *context, bwd_system *system) {
  bw_status status = BW_OK;
  PC pc;
  Vec preconditioned = NULL, residual = system->force, displacement = system->displacement;
  PetscScalar work = 0, energy = 0;
  PetscReal largest = 0, lowest = 0;
  PetscInt iterations = 0;
  BWD_TRY(KSPGetIterationNumber(system->solver, &iterations));
  if (system->direct || iterations == 0)
    return status;
  BWD_TRY(KSPComputeExtremeSingularValues(system->solver, &largest, &lowest));
  BWD_TRY(VecDot(system->force, displacement, &work));
  BWD_TRY(VecScale(displacement, -1));
  BWD_TRY(MatMultAdd(system->K, displacement, system->force, residual));
  BWD_TRY(VecScale(displacement, -1));
  BWD_TRY(VecDuplicate(residual, &preconditioned));
  BWD_TRY(KSPGetPC(system->solver, &pc));
  BWD_TRY(PCApply(pc, residual, preconditioned));
  BWD_TRY(VecDot(residual, preconditioned, &energy));
  if (work > 0 && lowest > 0)
    system->energy_error = fmax(system->energy_error, sqrt(fmax(0, energy) / lowest / work));
done:
  VecDestroy(&preconditioned);
  return status;
}

/* ---- counting -------------------------------------------------------------------------------- */

bw_status bwd_count_below(bw_context *context, bwd_system *system, double sigma, int64_t *count,
                          bool *trusted) {
  bw_status status = BW_OK;
  Mat shifted = NULL, factor = NULL;
  PetscInt negative = 0, zero = 0, positive = 0;
  *trusted = false;
  BWD_TRY(MatDuplicate(system->K, MAT_COPY_VALUES, &shifted));
  BWD_TRY(MatAXPY(shifted, -sigma, system->M, SUBSET_NONZERO_PATTERN));
  BWD_TRY(MatSetOption(shifted, MAT_SPD, PETSC_FALSE));
  BWD_TRY(MatSetOption(shifted, MAT_SYMMETRIC, PETSC_TRUE));
  for (int k = 0; k < TRIES; k++) {
    MatFactorInfo info;
    MatFactorError error;
    BWD_TRY(MatDestroy(&factor));
    BWD_TRY(MatGetFactor(shifted, MATSOLVERMUMPS, MAT_FACTOR_CHOLESKY, &factor));
    BWD_TRY(MatMumpsSetIcntl(factor, 13,
                             1)); /* the root on one rank: else its pivots are not counted */
    BWD_TRY(MatMumpsSetIcntl(factor, 24, 1)); /* pivots near zero are reported */
    BWD_TRY(MatMumpsSetIcntl(factor, 14, memory_percent[k]));
    BWD_TRY(MatFactorInfoInitialize(&info));
    BWD_TRY(MatCholeskyFactorSymbolic(factor, shifted, NULL, &info));
    BWD_TRY(MatCholeskyFactorNumeric(factor, shifted, &info));
    BWD_TRY(MatFactorGetError(factor, &error));
    if (error == MAT_FACTOR_NOERROR) {
      BWD_TRY(MatGetInertia(factor, &negative, &zero, &positive));
      *trusted = zero == 0;
    } else if (wants_memory(factor))
      continue;
    break;
  }
  *count = negative - system->motions;
done:
  MatDestroy(&factor);
  MatDestroy(&shifted);
  return status;
}
