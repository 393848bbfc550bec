/* incremental: systems that follow edits, partial refactorisation, lagged factors. */
#ifndef BARWRIGHT_INCREMENTAL_H
#define BARWRIGHT_INCREMENTAL_H

#include "barwright/plane_matrix.h"
#include "barwright/statics.h"

#ifdef __cplusplus
extern "C" {
#endif

/* ---- a system that follows edits (agile, section 6, and beyond) ------------------------------ */

/* What an update and a solve reused and what they cost. */
typedef struct bw_reuse {
  bool pattern, ordering;     /* kept */
  int32_t subdomains;         /* in all */
  int32_t subdomains_reused;  /* no entry of theirs was written */
  int32_t subdomains_rotated; /* written, but unchanged in their own frames */
  int32_t subdomains_changed; /* changed: evaluated by polynomials or gathered */
  const char *solver;         /* "cholesky": the supernodes that edits touched, and their
                                 ancestors (also where nothing had to be done); or "pcg"; static,
                                 NULL before a solution */
  const char *preconditioner; /* of "pcg": "cholesky", the factor as it was, or "two_level"; ""
                                 otherwise; static, NULL before a solution */
  bool full;                  /* every supernode was computed again */
  double factor_reused;       /* (-) fraction of the factor's work that was not done again */
  int iterations;  /* of conjugate gradients with a factor of a former shape, or by two-level PCG,
                      in all solves since the update */
  int precision;   /* bits of the factor's numbers: 64, or 32 */
  int refinements; /* iterations that made solutions with a factor of 32 bits as exact as
                      asked for, in all solves since the update */
  double predicted_refactor, predicted_iterate,
      predicted_pcg;       /* (s) of the reference machine; 0 for
                            a method that is not applicable */
  double seconds_unknowns; /* (s) following the supports and the frames of the unknowns */
  double seconds_stiffness, seconds_factor, seconds_solve; /* (s) of the parts */
  double difference_stiffness, difference_solution; /* (-) with `check`: the largest found, relative
                                                       to the largest entry and displacement */
} bw_reuse;

/* How the equations of an edited shape are to be solved. */
typedef struct bw_incremental_options {
  /* Borrowed. BW_SOLVER_CHOLESKY: the factor, of which the parts that edits reach are computed
     again, or with `full` all; by BW_BACKEND_CHOLMOD always all. BW_SOLVER_PCG: over two levels, or
     with a factor (that of a former shape, as it is). Default NULL: by predicted cost, operations
     and bytes counted, never time measured */
  const bw_solver *solver;
  double tolerance; /* (-) of conjugate gradients, relative residual, below 1; the looser of this
                       and of a solver that is given; default 0: the solver's, or 1e-10 */
  int precision;    /* of the factor, where the solver leaves it open: 32 or 64 bits; default 0: by
                       predicted cost. Solutions are in
                       double precision in any case: with a factor in single precision, which takes
                       half the time and half the memory, by conjugate gradients on the matrix in
                       double precision. Where it breaks down or iterations are many, the factor is
                       made in double precision, and stays so */
  bool check; /* compare stiffness and solution with those of a full refactorisation: BW_INTERNAL
               when they differ (1e-12, 1e-8); default false */
  int guess_count;
  /* (m, guess_count pointers to node_count x 3) Fields near the solutions (of shapes near this
     one), borrowed: iterating begins at the combination of them that is nearest in energy. A direct
     solution in double precision ignores them. */
  const double *const *guess;
  int further; /* for the choice by cost: right-hand sides to come, 0 or more; default 0 */
  double max_iteration_ratio; /* (-) for the choice by cost: the largest iteration ratio that is
                                 assumed, 0 or more; default 0: that of recent solutions */
  /* Iterations end when the error in energy alone is below the tolerance, relative to the
     solution's: for values that are means over many elements. Residuals, which single elements may
     dominate, do not count. Default false. */
  bool energy;
} bw_incremental_options;
BW_API void bw_incremental_options_default(bw_incremental_options *options);

/* The equations of a body cut into subdomains, updated through edits of its shape. Mutable:
 * one owner, one thread at a time. `system` is a view for what takes a bw_system: its mesh,
 * dof_map and stiffness are of the shape last synchronised; factor and mass are so only
 * after bw_incremental_system_refactor (NULL, or of no use, otherwise), the factor in double
 * precision; none outlives the next update. */
typedef struct bw_incremental_system {
  bw_object object;
  bw_system *system;                 /* owned */
  bw_subdomain_stiffness *stiffness; /* owned */
  struct bwi_incremental *inner;
} bw_incremental_system;
/* `subdomain_count` subdomains by element, element_subdomain (index, element_count), and by node,
 * node_subdomain (index, node_count), as in bw_subdomains; all at rest in the model's mesh.
 * `rotate_material`: an orthotropic material's axes turn with the frames of the subdomains, and
 * models that are followed come with their material turned so (bw_model_rotate_material). The
 * elimination order takes account of the edits (NULL: of each subdomain by itself). Those of
 * bw_system_factor and bw_subdomain_stiffness_create. */
BW_API bw_status bw_incremental_system_create(bw_context *context, const bw_model *model,
                                              bool rotate_material, int32_t subdomain_count,
                                              const int32_t *element_subdomain,
                                              const int32_t *node_subdomain, const bw_edits *edits,
                                              bw_incremental_system **incremental);
/* Follow an edit: `model` is the edited one (bw_model_moved), the material of which may be another
 * in any subdomain (bw_subdomain_stiffness_follows). Where the supports are no longer the
 * same, the next solve factors from scratch. On failure the shape is as it was; those of
 * bw_subdomain_stiffness_update. */
BW_API bw_status bw_incremental_system_update(bw_context *context,
                                              bw_incremental_system *incremental,
                                              const bw_model *model,
                                              const bw_subdomain_motion *motion, bw_reuse *reuse);
/* u = K^-1 f as bw_system_solve for force (N, count x node_count x 3) and displacement (m, count x
 * node_count x 3), by the given or the cheapest solver. BW_CONVERGENCE where a given iteration
 * does not converge, BW_SINGULAR where the factor fails, BW_UNSUPPORTED for block Jacobi, algebraic
 * multigrid and the backend BW_BACKEND_PETSC. `options` may be NULL; `reuse` (may be NULL) is
 * completed, not cleared. */
BW_API bw_status bw_incremental_system_solve(bw_context *context,
                                             bw_incremental_system *incremental,
                                             const bw_incremental_options *options, int64_t count,
                                             const double *force, double *displacement,
                                             bw_reuse *reuse);
/* Updates the factor, and that of the view: where the system keeps its own in single precision,
 * that is another one, factored from scratch. BW_SINGULAR as bw_incremental_system_solve. */
BW_API bw_status bw_incremental_system_refactor(bw_context *context,
                                                bw_incremental_system *incremental,
                                                bw_reuse *reuse);
/* The static solution of the model that was last synchronised, as bw_statics; result->system is
 * NULL. Those of bw_incremental_system_solve; BW_UNCONSTRAINED as bw_statics. */
BW_API bw_status bw_incremental_statics(bw_context *context, bw_incremental_system *incremental,
                                        const bw_model *model, const bw_statics_options *statics,
                                        const bw_incremental_options *options, bw_static **result,
                                        bw_reuse *reuse);
/* Bytes of the *factor, and of the update matrices kept beside it, *updates. */
BW_API void bw_incremental_system_memory(const bw_incremental_system *incremental, size_t *factor,
                                         size_t *updates);
/* Bytes of the two-level preconditioner; 0 until it is first used. */
BW_API size_t bw_incremental_system_two_level_bytes(const bw_incremental_system *incremental);

/* ---- lagged factors (responsive, sections 3.2 and 3.3) ----------------------------------------
 *
 * Solves A x = b with what is left of an earlier factorisation: conjugate gradients on a Cholesky
 * factor for symmetric positive definite matrices, BiCGSTAB on an LU factor for others. The
 * paper uses ILU(k); a complete factor costs little in the plane and remains useful for longer. */

/* How equations are solved. */
typedef struct bw_lagged_factor_options {
  /* Borrowed. BW_SOLVER_CHOLESKY, of flows BW_SOLVER_LU: factored each time, with `full` analysed
     each time too. BW_SOLVER_PCG with the preconditioner BW_SOLVER_CHOLESKY, of flows
     BW_SOLVER_BICGSTAB: iterations on the factor that is there as long as they converge within
     max_iterations, by default 60. Default NULL: whichever of both is predicted to cost less, by
     operations and bytes, counted, and by the iterations that recent solutions took */
  const bw_solver *solver;
  double tolerance; /* (-) relative residual |b - A x| / |b|; default 1e-8, > 0; that of a solver
                       which has one takes its place */
  int max_lag; /* solutions that a factor may serve beyond the one that it was computed for, 0 or
                  more; default INT_MAX */
} bw_lagged_factor_options;
BW_API void bw_lagged_factor_options_default(bw_lagged_factor_options *options);
/* What one solve, or one frame of an application, reused and what it cost. Sums over the solves of
 * a frame; clear with memset before. */
typedef struct bw_plane_reuse {
  bw_level level;                                   /* of the mesh in this frame */
  bool pattern;                                     /* of A: kept */
  bool factor;                                      /* B: kept (lagged) */
  bool solution;                                    /* x: used as the first guess */
  int analyses, factorisations, solves, iterations; /* how many */
  double residual;                                  /* (-) the largest, relative, as reached */
  double seconds_mesh, seconds_assemble, seconds_factor, seconds_solve; /* (s) of the parts */
  bw_solver_report report; /* of the solutions: words of the last one, costs and operations in all,
                              the largest residual and memory */
} bw_plane_reuse;

/* A factor of a former matrix. Mutable; one thread at a time. bw_lagged_factor_destroy releases
 * it. */
typedef struct bw_lagged_factor bw_lagged_factor;
/* For 1 to 4 components at a node, 1 to 3 where `symmetric`. */
BW_API bw_status bw_lagged_factor_create(bw_context *context, bool symmetric, int components,
                                         bw_lagged_factor **lagged);
BW_API void bw_lagged_factor_destroy(bw_lagged_factor *lagged);
/* Solves A x = b for values (any, block_count x components x components) and rhs (any, node_count x
 * components). x (any, node_count x components) is the initial guess on entry, the solution on
 * return. The factor and its elimination order are kept as long as the pattern's nodes are the same
 * object, the analysis as long as its topology is. BW_SINGULAR, or BW_CONVERGENCE with the residual
 * reached; x is then as it was. BW_INVALID for a solver that does not serve these equations.
 * `options` and `reuse` may be NULL; `reuse` is added to. */
BW_API bw_status bw_lagged_factor_solve(bw_context *context, bw_lagged_factor *lagged,
                                        const bw_plane_pattern *pattern, const double *values,
                                        const double *rhs, double *x,
                                        const bw_lagged_factor_options *options,
                                        bw_plane_reuse *reuse);
/* Applies the factor alone, current or lagged: z (any, node_count x components) = B r (any,
 * node_count x components), for eigenvalue iterations. Only after a solution. */
BW_API bw_status bw_lagged_factor_apply(bw_context *context, bw_lagged_factor *lagged,
                                        const double *r, double *z);
/* Releases factor, analysis and pattern: the next solve begins from scratch. */
BW_API void bw_lagged_factor_reset(bw_lagged_factor *lagged);

#ifdef __cplusplus
}
#endif
#endif
