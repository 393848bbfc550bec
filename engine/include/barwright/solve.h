/* solve: factorisation, static solutions, modes. */
#ifndef BARWRIGHT_SOLVE_H
#define BARWRIGHT_SOLVE_H

#include "barwright/assemble.h"

#ifdef __cplusplus
extern "C" {
#endif

/* Where the time of a system went. */
typedef struct bw_solve_times {
  double pattern, stiffness, order, factor, pcg, solve; /* (s) spent so far */
  int64_t factor_entries;                               /* of L; 0 where there is no factor */
  double factor_flops;                                  /* (-) operations of the factorisation */
} bw_solve_times;

/* The equations of a body: stiffness, mass, DOF map and the factor of the reduced stiffness. One
 * factor serves statics, modes, objectives and stresses. Solves may not run on one system from two
 * threads at once (the context is busy); a solve itself uses all threads. The equations never
 * change; only how they are solved may. Those that bw_statics made for two-level PCG have no factor
 * and no mass until bw_system_factor is called, or a static solution finds that by now a factor
 * would have been cheaper. */
typedef struct bw_system bw_system;
struct bwi_factor;
struct bwi_two_level_solver;
struct bw_system {
  bw_object object;
  const bw_mesh *mesh;         /* retained */
  const bw_material *material; /* retained */
  const bw_dof_map *dof_map;   /* retained */
  bw_block_pattern *pattern;   /* retained */
  double *stiffness;           /* (N/m, block_count x 9) */
  double
      *mass; /* (kg, block_count) with density 1 when the material has none; NULL without factor */
  double density;
  struct bwi_factor *factor;              /* or NULL */
  struct bwi_two_level_solver *two_level; /* or NULL */
  bw_solve_times times;                   /* of all that was computed */
};
/* Assembles and factors. `previous` (may be NULL): a system of the same topology whose pattern,
 * ordering and analysis are reused where they fit. BW_SINGULAR when a constrained body's matrix is
 * not positive definite, BW_GEOMETRY for an inverted element, BW_LIMIT for a factor with too many
 * entries, BW_MEMORY as bw_system_factor. */
BW_API bw_status bw_system_create(bw_context *context, const bw_mesh *mesh,
                                  const bw_material *material, const bw_dof_map *dof_map,
                                  const bw_system *previous, bw_system **system);
/* The equations of a model, with mass and factor: `given` (may be NULL), retained, where its mesh,
 * material and supports are the model's; else new ones, with `given` as `previous`. Prescribed
 * values may differ: they act on right-hand sides alone. BW_SINGULAR as in bw_system_create. */
BW_API bw_status bw_system_of_model(bw_context *context, const bw_model *model, bw_system *given,
                                    bw_system **system);
/* Mass and factor, where the system has none yet: then it is one as bw_system_create makes it. On
 * failure it is as it was. BW_MEMORY, before any is allocated, where the factor is larger than what
 * is free (bw_available_memory); BW_SINGULAR and BW_LIMIT as bw_system_create. */
BW_API bw_status bw_system_factor(bw_context *context, bw_system *system);
/* u = K^-1 f for homogeneous supports, `count` right-hand sides at once: force (N, count x
 * node_count x 3), displacement (m, count x node_count x 3), which may be the same block. Changes
 * only the system's workspace. BW_INVALID for a system without a factor. Where rigid-body modes are
 * unconstrained, the force is first balanced by inertia (f - M r <r, f>; no change for a balanced
 * force) and the displacement made free of rigid-body motion (eq. 5 of worst-case): u = P K^+ P^T
 * f, symmetric. */
BW_API bw_status bw_system_solve(bw_context *context, bw_system *system, int64_t count,
                                 const double *force, double *displacement);

/* ---- statics --------------------------------------------------------------------------------- */

/* How a static solution is found. */
typedef enum bw_statics_method {
  BW_STATICS_AUTO,   /* the factor, unless it would be expensive or large and PCG is not */
  BW_STATICS_FACTOR, /* a sparse factor of the stiffness, which other solutions and modes can use */
  BW_STATICS_PCG     /* conjugate gradients with the two-level preconditioner of a smoother and the
                        linear elements on the same corners: a tenth of the memory. For quadratic
                        elements and supports that constrain all rigid-body modes (BW_INVALID
                        otherwise) */
} bw_statics_method;

/* How a static solution was found. */
typedef struct bw_statics_report {
  bw_statics_method method; /* BW_STATICS_FACTOR or BW_STATICS_PCG; BW_STATICS_AUTO: by an edit
                               session or an external solver */
  int iterations;           /* by two-level PCG; where the method is the factor: those that did not
                               converge */
  int32_t coarse_unknowns;  /* of the linear elements that were factored; 0 by factor */
  double factor_flops; /* (-) operations of the factor: counted, or where there is none predicted
                          from those of the linear elements */
  double factor_bytes; /* (bytes) of the factor, likewise */
  double predicted_factor, predicted_pcg; /* (s) of the model's machine, by which the method was
                                             chosen; 0 where there was no choice */
} bw_statics_report;

/* A static solution. */
typedef struct bw_static {
  bw_object object;
  const bw_model *model;               /* retained */
  bw_system *system;                   /* retained; NULL: of an edit session */
  double *displacement;                /* (m, node_count x 3) */
  double *force;                       /* (N, node_count x 3) applied */
  double *reaction;                    /* (N, node_count x 3) K u - f at prescribed components, 0
                                          elsewhere */
  double energy;                       /* (J) strain energy */
  double residual;                     /* (-) |K u - f| at unknowns over |f| */
  struct bw_external_report *external; /* of an external solver, or NULL */
  bw_statics_report report;            /* how it was found */
} bw_static;
/* How a static solution is to be found. */
typedef struct bw_statics_options {
  bool
      inertia_relief; /* balance a load on a free body by inertia instead of refusing; default no */
  double tolerance;   /* (-) a load is balanced when its part along rigid-body modes is below this
                       fraction of its size; default 1e-6, > 0 */
  bw_statics_method method; /* of bw_statics alone, like what follows; default BW_STATICS_AUTO */
  int iterations;           /* by two-level PCG, at most; default 2000, 1 or more */
  double memory; /* (bytes) that a factor may take, 0 or more; default 0: bw_available_memory */
} bw_statics_options;
/* The static solution of a model. `options` may be NULL. BW_UNCONSTRAINED names the unconstrained
 * rigid-body modes when the load is not balanced against them; BW_SINGULAR when the stiffness is
 * not positive definite or the solution is not finite; BW_INVALID when no load reaches the body
 * (bw_model_check_absorbed). `system` may be NULL or the system of an earlier solve (reused when
 * mesh, material and supports are the same; it may gain a factor, or lose what it has to solve by
 * two-level PCG).
 *
 * By BW_STATICS_AUTO, a static solution is by a factor where there is one already, or where that
 * counts as cheap (less than five seconds of the model's machine). So it is where PCG does not
 * apply or would cost more than half as much. Else it is by two-level PCG, and also where the
 * factor would take more than four gigabytes or more than `memory`. Costs are operations and bytes,
 * counted, over the rates of one fixed machine, so that the choice is the same everywhere. The
 * costs of solutions by two-level PCG are added up: when the next one would make their sum more
 * than the factor, that is made. Where iterating does not converge, a factor takes its place, and a
 * warning says so; BW_CONVERGENCE where there is no memory for one, or the method is
 * BW_STATICS_PCG. */
BW_API bw_status bw_statics(bw_context *context, const bw_model *model, bw_system *system,
                            const bw_statics_options *options, bw_static **result);

/* ---- a system that follows edits (agile, section 6, and beyond) ------------------------------ */

/* How the equations of an edited shape are solved. */
typedef enum bw_incremental_method {
  BW_INCREMENTAL_AUTO, /* by predicted cost: operations and bytes counted, never time measured */
  BW_INCREMENTAL_REFACTOR, /* the supernodes that the edits touched, and their ancestors */
  BW_INCREMENTAL_ITERATE,  /* conjugate gradients, preconditioned by the factor as it is */
  BW_INCREMENTAL_FULL,     /* every supernode again: for checks and baselines */
  BW_INCREMENTAL_PCG       /* as BW_STATICS_PCG: needs no factor */
} bw_incremental_method;

/* What an update and a solve reused and what they cost. */
typedef struct bw_reuse {
  bool pattern, ordering;       /* kept */
  int32_t subdomains;           /* in all */
  int32_t subdomains_reused;    /* no entry of theirs was written */
  int32_t subdomains_rotated;   /* written, but unchanged in their own frames */
  int32_t subdomains_changed;   /* changed: evaluated by polynomials or gathered */
  bw_incremental_method method; /* BW_INCREMENTAL_REFACTOR (also where nothing had to be done),
                           _ITERATE, _SCRATCH     or _PCG */
  double factor_reused;         /* (-) fraction of the factor's work that was not done again */
  int iterations;  /* of conjugate gradients with a factor of a former shape, or by two-level PCG,
                      in all solves since the update */
  int precision;   /* bits of the factor's numbers: 64, or 32 */
  int refinements; /* iterations that made solutions with a factor of 32 bits as exact as
                      asked for, in all solves since the update */
  double predicted_refactor, predicted_iterate, predicted_pcg; /* (s) of the model's machine; 0 for
                                                                a method that is not applicable */
  double seconds_unknowns; /* (s) following the supports and the frames of the unknowns */
  double seconds_stiffness, seconds_factor, seconds_solve; /* (s) of the parts */
  double difference_stiffness, difference_solution; /* (-) with `check`: the largest found, relative
                                                       to the largest entry and displacement */
} bw_reuse;

/* How the equations of an edited shape are to be solved. */
typedef struct bw_incremental_options {
  bw_incremental_method method; /* default BW_INCREMENTAL_AUTO */
  double tolerance; /* (-) of conjugate gradients, relative residual; default 1e-10, above 0, below
                       1 */
  int precision;    /* of the factor: 32 or 64 bits; default 0: by predicted cost. Solutions are in
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
/* The edits to be expected, borrowed, by the subdomains that they touch: those of subdomain d are
 * edit[start[d]] to edit[start[d + 1] - 1], numbers from 0 to count - 1 (bones, mostly). */
typedef struct bw_edits {
  int32_t count;
  const int32_t *start; /* (index, subdomain_count + 1) */
  const int32_t *edit;  /* (index, start[subdomain_count]) */
} bw_edits;
/* `subdomain_count` subdomains by element, element_subdomain (index, element_count), and by node,
 * node_subdomain (index, node_count), as in bw_subdomains; all at rest in the model's mesh.
 * `rotate_material`: an orthotropic material's axes turn with the frames of the subdomains, and
 * models that are followed come with their material turned so (bw_model_rotate_material). The
 * elimination order takes account of the edits (NULL: of each subdomain by itself). Those of
 * bw_system_create and bw_subdomain_stiffness_create. */
BW_API bw_status bw_incremental_system_create(bw_context *context, const bw_model *model,
                                              bool rotate_material, int32_t subdomain_count,
                                              const int32_t *element_subdomain,
                                              const int32_t *node_subdomain, const bw_edits *edits,
                                              bw_incremental_system **incremental);
/* Follow an edit: `model` is the edited one (bw_model_moved). Where the supports are no longer the
 * same, the next solve factors from scratch. On failure the shape is as it was; those of
 * bw_subdomain_stiffness_update. */
BW_API bw_status bw_incremental_system_update(bw_context *context,
                                              bw_incremental_system *incremental,
                                              const bw_model *model,
                                              const bw_subdomain_motion *motion, bw_reuse *reuse);
/* u = K^-1 f as bw_system_solve for force (N, count x node_count x 3) and displacement (m, count x
 * node_count x 3), by the given or the cheapest method. BW_CONVERGENCE where a given iteration
 * does not converge, BW_SINGULAR where the factor fails. `options` may be NULL; `reuse`
 * (may be NULL) is completed, not cleared. */
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

/* ---- modes --------------------------------------------------------------------------------- */

/* How modes are found. */
typedef struct bw_modes_options {
  int count;        /* modes wanted; default 15, 1 or more */
  double tolerance; /* (-) relative residual; default 1e-8, above 0 and below 1 */
  bool sturm;    /* count eigenvalues below the last one from an indefinite factor; default true */
  uint64_t seed; /* of the start vector; default 1 */
} bw_modes_options;
BW_API void bw_modes_options_default(bw_modes_options *options);

/* Modes of a body. */
typedef struct bw_modes {
  bw_object object;
  const bw_mesh *mesh;         /* retained */
  const bw_material *material; /* retained; NULL for Laplacian modes */
  int count;
  int components;     /* 3: elastic modes; 1: Laplacian modes */
  int rigid_count;    /* rigid-body modes recognised and left out */
  double *eigenvalue; /* ((rad/s)^2, count) ascending; for the Laplacian 1/m2 */
  double *frequency;  /* (Hz, count) NULL for Laplacian modes and where the density is not known */
  double *shape; /* (any, count x node_count x components) mass-normalised (M-norm 1); sign fixed:
                    the largest component is positive */
  double *residual; /* (-, count) |K u - lambda M u| / |lambda M u|; rounding of K u alone shows in
                       very thin shapes, where the eigenvalue is far more exact than this */
  int solves;       /* right-hand sides solved for, in blocks of eight */
  int recovered;    /* modes found only after the Sturm count showed that they were missing */
  bool counted;     /* the Sturm count confirmed that none is missing */
  struct bw_external_report *external; /* of an external solver, or NULL */
} bw_modes;
/* The lowest elastic modes K u = lambda M u (consistent mass) by block Lanczos on the inverse, with
 * the system's own factor; unconstrained rigid-body modes are projected out exactly. Fewer than
 * wanted where the body has fewer. BW_CONVERGENCE where the iteration does not reach the
 * tolerance, BW_LIMIT for too many modes. `options` may be NULL. */
BW_API bw_status bw_modes_elastic(bw_context *context, bw_system *system,
                                  const bw_modes_options *options, bw_modes **modes);
/* The lowest nonconstant modes of the scalar Laplacian on the mesh (free boundary), section 4 of
 * worst-case. `pattern`: of the mesh. BW_SINGULAR where its factor fails, BW_GEOMETRY for an
 * inverted element, and as bw_modes_elastic. */
BW_API bw_status bw_modes_laplacian(bw_context *context, const bw_mesh *mesh,
                                    const bw_block_pattern *pattern,
                                    const bw_modes_options *options, bw_modes **modes);

/* ---- external solvers --------------------------------------------------------- */

/* Systems that are too large for a factor on one machine are given to a solver that works on
 * several: engine/distributed, a library of its own over MPI, PETSc and SLEPc, which the engine
 * does not link. Who loads it registers it here. Matrix, right-hand side and the check of what
 * comes back are the engine's. */
/* How an external solver works. */
typedef enum bw_external_method {
  BW_EXTERNAL_AUTO, /* statics: CG; modes: CHOLESKY */
  BW_EXTERNAL_CG,   /* conjugate gradients with algebraic multigrid over the rigid-body motions */
  BW_EXTERNAL_CHOLESKY /* a factor, spread over the processes */
} bw_external_method;
/* How an external solver is to work. */
typedef struct bw_external_options {
  bw_external_method method; /* default BW_EXTERNAL_AUTO */
  double rtol;    /* (-) |K u - f| / |f| to be reached; default 1e-10, above 0 and below 1 */
  int iterations; /* of conjugate gradients, at most; default 2000, 1 or more */
} bw_external_options;
BW_API void bw_external_options_default(bw_external_options *options);

/* What an external solver did. */
typedef struct bw_external_report {
  char method[96];           /* "conjugate gradients, GAMG" */
  int ranks;                 /* processes */
  int iterations;            /* of conjugate gradients, in all solves */
  double send, setup, solve; /* (s) matrix to the ranks; multigrid or factor; solves */
  double processor; /* (s) of all processes while the system was open, waiting in MPI included */
  double bytes,
      largest; /* (bytes) memory of all processes at their peaks, of the largest of them */
} bw_external_report;

/* Equations for an external solver; all is borrowed while the system is open. K and M have the
 * block sparsity pattern; the DOF map says which components are unknowns, and in which frames. */
typedef struct bw_external_matrix {
  const bw_dof_map *dof_map;
  const bw_block_pattern *pattern;
  const double *stiffness; /* (N/m, block_count x 9) */
  const double *mass;      /* (kg, block_count) or NULL: no modes wanted */
} bw_external_matrix;

/* What it finds; the lists are allocated with bw_alloc for the caller, who releases them. */
typedef struct bw_external_modes {
  int count;
  double *value;  /* ((rad/s)^2, count) ascending */
  double *vector; /* (any, count x node_count x 3) global directions, M-norm 1, without rigid-body
                     motion */
  int solves, recovered; /* as in bw_modes */
  bool counted;          /* as in bw_modes */
} bw_external_modes;

/* An external solver. One system is open at a time. After a failure of any of these the system is
 * closed. */
typedef struct bw_external {
  /* Takes the matrix, and sets up multigrid or factor. */
  bw_status (*open)(bw_context *context, const bw_external_matrix *matrix,
                    const bw_external_options *options);
  /* Fields as those of bw_system_solve, the force balanced already; displacement up to a rigid-body
   * motion. */
  bw_status (*solve)(bw_context *context, const double *force, double *displacement);
  /* The lowest elastic modes. */
  bw_status (*modes)(bw_context *context, const bw_modes_options *options,
                     bw_external_modes *modes);
  /* Releases the system, and reports on it. */
  void (*close)(bw_context *context, bw_external_report *report);
} bw_external;
/* Registers a solver for the process, borrowed until the next registration; NULL: none. */
BW_API void bw_external_register(const bw_external *external);
/* The registered solver, borrowed, or NULL. */
BW_API const bw_external *bw_external_registered(void);

/* As bw_statics: BW_UNSUPPORTED when none is registered, BW_CONVERGENCE when the residual, computed
 * with the engine's own K, is above the tolerance, BW_UNCONSTRAINED as there, and the solver's
 * own statuses. result->system is NULL. */
BW_API bw_status bw_statics_external(bw_context *context, const bw_model *model,
                                     const bw_statics_options *statics,
                                     const bw_external_options *options, bw_static **result);
/* As bw_modes_elastic: BW_UNSUPPORTED when none is registered, and the solver's own statuses. */
BW_API bw_status bw_modes_external(bw_context *context, const bw_model *model,
                                   const bw_modes_options *options,
                                   const bw_external_options *external, bw_modes **modes);

/* A *text with name and version of the BLAS in use, the thread libraries, CHOLMOD, METIS, GLPK...:
 * one line each; it warns of a BLAS known to be slow here (OpenMP variant). Release it with
 * bw_free. */
BW_API bw_status bw_library_versions(bw_context *context, char **text);

#ifdef __cplusplus
}
#endif
#endif
