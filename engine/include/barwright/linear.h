/* linear: the equations of a body, their factorisation and preconditioners. */
#ifndef BARWRIGHT_LINEAR_H
#define BARWRIGHT_LINEAR_H

#include "barwright/assemble.h"
#include "barwright/matrix.h"
#include "barwright/report.h"

#ifdef __cplusplus
extern "C" {
#endif

/* ---- linear solvers -------------------------------------------------------------------------- */

/* What a linear solver, or a preconditioner, is. */
typedef enum bw_solver_kind {
  BW_SOLVER_CHOLESKY,  /* a sparse factor K = L L^T */
  BW_SOLVER_PCG,       /* conjugate gradients with a preconditioner */
  BW_SOLVER_TWO_LEVEL, /* preconditioner: a smoother and the linear elements on the same corners.
                          For quadratic elements */
  BW_SOLVER_AMG,       /* preconditioner: algebraic multigrid by smoothed aggregation, the engine's
                          own or of the external solver */
  BW_SOLVER_JACOBI,    /* preconditioner: the inverse of the blocks of the nodes */
  BW_SOLVER_LU,        /* a sparse factor A = L U, of the unsymmetric equations of flows */
  BW_SOLVER_BICGSTAB   /* stabilised biconjugate gradients on such a factor (van der Vorst 1992) */
} bw_solver_kind;

/* Who computes a factor or a multigrid hierarchy. */
typedef enum bw_backend {
  BW_BACKEND_AUTO,         /* the default of docs/benchmarks.md */
  BW_BACKEND_MULTIFRONTAL, /* the engine's factor: partial refactorisation, single precision, the
                              same bits on any number of threads */
  BW_BACKEND_CHOLMOD,      /* CHOLMOD's supernodal factor: always whole and in double precision. Its
                              last bits depend on the number of threads, and it cannot be
                              interrupted */
  BW_BACKEND_PETSC         /* the registered external solver (bw_external): a factor spread over the
                              processes, or multigrid */
} bw_backend;

/* The elimination order of a factor. */
typedef enum bw_ordering {
  BW_ORDERING_AUTO,   /* nested dissection */
  BW_ORDERING_METIS,  /* nested dissection of the nodes */
  BW_ORDERING_AMD,    /* approximate minimum degree of the nodes */
  BW_ORDERING_BACKEND /* the backend's own: CHOLMOD takes the better of AMD and METIS on the
                         unknowns; the engine's factor nested dissection */
} bw_ordering;

typedef struct bw_solver bw_solver;
/* Which solver, and how it works; zeros mean the defaults. */
typedef struct bw_solver_options {
  bw_solver_kind kind;  /* default BW_SOLVER_CHOLESKY */
  bw_backend backend;   /* of a factor; of BW_SOLVER_AMG: BW_BACKEND_AUTO, the engine's own, or
                           BW_BACKEND_PETSC; default BW_BACKEND_AUTO */
  bw_ordering ordering; /* of a factor; default BW_ORDERING_AUTO */
  int precision; /* of a factor's numbers, 32 or 64 bits; default 0: 64, in systems that follow
                    edits by predicted cost. Solutions are in double precision in any case: a
                    factor of 32 bits is refined by conjugate gradients */
  bool full;     /* of a factor that follows edits or an outline: computed again as a whole, where
                    a part or the former analysis would do; default false */
  const bw_solver *preconditioner; /* retained; of BW_SOLVER_PCG: BW_SOLVER_TWO_LEVEL, _AMG,
                                      _JACOBI, or _CHOLESKY (of a former shape, or of 32 bits);
                                      default NULL: two-level. Of BW_SOLVER_BICGSTAB:
                                      BW_SOLVER_LU, as is NULL */
  double tolerance;   /* (-) of PCG and BiCGSTAB: relative residual, below 1; default 0: 1e-10, in
                         Newton's method by Eisenstat and Walker, of plane meshes as
                         bw_lagged_factor_options has it. Of bw_system_solve: error in energy over
                         that of the solution; default 0: 1e-8 */
  int max_iterations; /* (count) of PCG and BiCGSTAB; default 0: 2000, in Newton's method 10000, of
                         plane meshes 60 */
} bw_solver_options;

/* A linear solver: a description that never changes, made once and handed to whatever solves. A
 * NULL solver means that it is chosen by counted operations and bytes. */
struct bw_solver {
  bw_object object;
  bw_solver_options options; /* as they were given */
};
/* Makes a *solver. BW_INVALID for numbers outside their ranges, options that the kind does not
 * have, and what its backend does not serve. */
BW_API bw_status bw_solver_create(bw_context *context, const bw_solver_options *options,
                                  bw_solver **solver);
enum { BW_SOLVER_TEXT = 320 /* bytes of any solver's description, with the final 0 */ };
/* Writes text (BW_SOLVER_TEXT) such as "pcg (two_level, tolerance 1e-08)"; of NULL "auto". */
BW_API void bw_solver_describe(const bw_solver *solver, char text[BW_SOLVER_TEXT]);
/* The word of a backend ("cholmod"), of an ordering ("metis"), of a kind ("two_level"). */
BW_API const char *bw_backend_word(bw_backend backend);
BW_API const char *bw_ordering_word(bw_ordering ordering);
BW_API const char *bw_solver_word(bw_solver_kind kind);

/* ---- systems ----------------------------------------------------------------------------------
 */

/* Where the time of a system went. */
typedef struct bw_solve_times {
  double pattern, stiffness, order, factor, pcg, solve; /* (s) spent so far */
  int64_t factor_entries;                               /* of L; 0 where there is no factor */
  double factor_flops;                                  /* (-) operations of the factorisation */
  double factor_reused; /* (-) fraction of these that the factor of former equations had done */
  int32_t elements;     /* (count) whose stiffness was computed */
} bw_solve_times;

/* The equations of a body: stiffness, mass, DOF map and the factor of the reduced stiffness, or the
 * preconditioner of PCG in its place. One of them serves statics, modes, objectives and stresses.
 * Solves may not run on one system from two threads at once (the context is busy); a solve itself
 * uses all threads. The equations never change; only how they are solved may. Those that bw_statics
 * made for PCG have no factor and no mass until bw_system_factor is called, or a static solution
 * finds that by now a factor would have been cheaper. */
typedef struct bw_system bw_system;
struct bwi_factor;
struct bwi_two_level_solver;
struct bwi_preconditioner;
struct bwi_external;
struct bwi_former;
struct bw_system {
  bw_object object;
  const bw_mesh *mesh;         /* retained */
  const bw_material *material; /* retained */
  const bw_dof_map *dof_map;   /* retained */
  bw_block_pattern *pattern;   /* retained */
  double *stiffness;           /* (N/m, block_count x 9) or NULL: bw_system_stiffness makes it */
  double
      *mass; /* (kg, block_count) with density 1 when the material has none; NULL without factor */
  struct bwi_factor *factor;                 /* or NULL */
  struct bwi_two_level_solver *two_level;    /* or NULL */
  struct bwi_preconditioner *preconditioner; /* of PCG with another one, or NULL */
  struct bwi_external *external; /* at the external solver: this process has neither pattern nor
                                    matrices; else NULL */
  const struct bw_external_report *external_report; /* what that did, or NULL */
  const bw_operator *solution; /* retained: u = P K^+ P^T f of a joined model (bw_joined_system), in
                                  the place of pattern, matrices and factor; else NULL */
  struct bwi_former *former;   /* what equations of other values left, until there is a factor or a
                                  preconditioner; or NULL */
  struct bwi_relaxed *relaxed; /* retained: what compliances of free bodies take, once there were
                                  any; or NULL */
  bw_system *shared;       /* retained: that whose stiffness and mass these are, as only prescribed
                              displacements differ; or NULL */
  bool iterative;          /* bw_system_solve is by PCG */
  const bw_solver *solver; /* retained: of bw_system_of_model, where it is iterative; or NULL */
  bw_solve_times times;    /* of all that was computed */
  bw_solver_report report; /* how bw_system_solve solves, and what solutions took since
                              bw_system_of_model; its `solver` is NULL before */
};
/* The equations of a model, with what `solver` needs to solve them for many right-hand sides:
 * `given` (may be NULL), retained, where its mesh, material and supports are the model's; else new
 * ones, with its pattern, ordering and analysis where they fit. Where only prescribed displacements
 * differ, the new ones share its matrices and its factor.
 *
 * Where `given` has the same elements at other positions or of another material, only those that
 * differ are assembled. Where they are few and the supports are the same, its factor serves too:
 * the first time the new factor is kept so that from then on, only what such changes reach is
 * factored again. times.elements and times.factor_reused say how much that saved; the solutions are
 * the same to the bit. `given` itself stays as it is.
 *
 * Without a solver (NULL) a factor is made, with the mass, unless it is predicted to take more than
 * four gigabytes or more than the memory that is free: then it is PCG, with the two-level
 * preconditioner on quadratic elements and multigrid on linear ones. Where that does not converge,
 * bw_system_solve makes a factor, where there is memory, and warns.
 *
 * BW_GEOMETRY for an inverted element; those of bw_system_factor where a factor is made; BW_INVALID
 * for a preconditioner in the place of a solver and for two_level on linear elements.
 *
 * With a solver of the backend BW_BACKEND_PETSC the equations are at the external solver, which
 * distributes the mesh when they are first used. BW_UNSUPPORTED where none is registered. */
BW_API bw_status bw_system_of_model(bw_context *context, const bw_model *model,
                                    const bw_solver *solver, bw_system *given, bw_system **system);
/* The stiffness, where the system has none yet: two-level PCG on straight tet10 of one material
 * does without it. BW_GEOMETRY for an inverted element, BW_UNSUPPORTED for equations at the
 * external solver. */
BW_API bw_status bw_system_stiffness(bw_context *context, bw_system *system);
/* Mass and factor, where the system has none yet, and solves by it. On failure it is as it was.
 * BW_MEMORY, before any is allocated, where the factor is larger than what is free
 * (bw_available_memory); BW_SINGULAR when a constrained body's matrix is not positive definite,
 * BW_LIMIT for a factor with too many entries, BW_UNSUPPORTED for equations at the external solver.
 */
BW_API bw_status bw_system_factor(bw_context *context, bw_system *system);
/* u = K^-1 f for homogeneous supports, `count` right-hand sides at once: force (N, count x
 * node_count x 3), displacement (m, count x node_count x 3), which may be the same block. Changes
 * only the system's workspace and its report. BW_INVALID for a system without a factor that is not
 * iterative, BW_CONVERGENCE for one that is where PCG does not reach its tolerance; the
 * statuses of an external solver. Where
 * rigid-body modes are unconstrained, the force is first balanced by inertia (f - M r <r, f>; no
 * change for a balanced force) and the displacement made free of rigid-body motion (eq. 5 of
 * worst-case): u = P K^+ P^T f, symmetric; by PCG, to its tolerance. */
BW_API bw_status bw_system_solve(bw_context *context, bw_system *system, int64_t count,
                                 const double *force, double *displacement);

/* Which matrix of a system. */
typedef enum bw_system_part {
  BW_STIFFNESS, /* K (N/m) */
  BW_MASS       /* M (kg), consistent */
} bw_system_part;
/* A copy of K or M as a sparse matrix, symmetric to the last bit. Rows and columns are the unknowns
 * of the DOF map in its order; at nodes with a frame they are components along the frame. With
 * `whole` they are all components instead, 3 node + 0, 1, 2 along x, y, z, without supports. On a
 * body with unconstrained rigid-body modes the unknowns lack its isostatic constraints, so that the
 * matrix of the unknowns is positive definite. BW_INVALID for the mass of a system that has none
 * yet, BW_UNSUPPORTED for equations at the external solver, BW_LIMIT for 2^31 - 1 rows. */
BW_API bw_status bw_system_matrix(bw_context *context, bw_system *system, bw_system_part part,
                                  bool whole, bw_sparse_matrix **matrix);
/* The right-hand side of the unknowns for nodal forces, force (N, node_count x 3): b (N,
 * unknown_count), with what prescribed displacements cause taken off, so that K x = b. */
BW_API bw_status bw_system_right_hand_side(bw_context *context, bw_system *system,
                                           const double *force, double *b);
/* The displacement (m, node_count x 3) of unknowns x (m, unknown_count), with the prescribed
 * components. */
BW_API void bw_system_displacement(const bw_system *system, const double *x, double *displacement);

/* ---- matrices and operators --------------------------------------------------------------------
 */

/* How A x = b is solved. Pointers are borrowed. */
typedef struct bw_linear_solve_options {
  const bw_solver *solver; /* BW_SOLVER_CHOLESKY, for sparse matrices, or BW_SOLVER_PCG; default
                              NULL: a factor of a sparse matrix, else PCG, and PCG where a
                              preconditioner is given */
  const bw_operator *preconditioner; /* of PCG, of the same size: near the inverse of A, symmetric
                                        and positive definite; default NULL: what the solver names,
                                        of the matrix (a factor or BW_SOLVER_JACOBI); where it names
                                        none BW_SOLVER_JACOBI, and none for an operator */
  const double *guess;               /* (any, count x size) where PCG begins; default NULL: 0 */
} bw_linear_solve_options;
/* Solves A x = b with a symmetric positive definite A for `count` right-hand sides, one after the
 * other: b (any, count x size), x (any, count x size), another block. `options` and *report may be
 * NULL. The residual of each is below the solver's tolerance (default 1e-10) relative to its b, or
 * what rounding leaves of a factor's. BW_SINGULAR for a matrix or operator that is not positive
 * definite, BW_CONVERGENCE where PCG does not reach the tolerance, with x as far as it came,
 * BW_INVALID for numbers that are not finite, sizes that differ, a matrix or operator that is not
 * symmetric (an operator is tried where PCG fails), a preconditioner given twice, a factor of an
 * operator, and a preconditioner without PCG; BW_UNSUPPORTED for preconditioners of bodies and the
 * backend PETSc, BW_LIMIT for a factor with too many entries, BW_MEMORY before any is allocated
 * where it is larger than what is free. Those of the operators' functions. */
BW_API bw_status bw_linear_solve(bw_context *context, const bw_operator *a,
                                 const bw_linear_solve_options *options, int64_t count,
                                 const double *b, double *x, bw_solver_report *report);
/* The inverse of a symmetric positive definite matrix as an operator: by a factor that `solver`
 * describes (BW_SOLVER_CHOLESKY; NULL: the default), or of the diagonal alone (BW_SOLVER_JACOBI).
 * It solves for further right-hand sides, and preconditions similar matrices. It may not be applied
 * from two threads at once. BW_SINGULAR for a matrix that is not positive definite, BW_UNSUPPORTED
 * for preconditioners of bodies and the backend PETSc, BW_INVALID for one that is not symmetric and
 * for BW_SOLVER_PCG, BW_LIMIT and BW_MEMORY as bw_linear_solve. */
BW_API bw_status bw_operator_inverse(bw_context *context, const bw_sparse_matrix *matrix,
                                     const bw_solver *solver, bw_operator **result);

/* The edits to be expected, borrowed, by the subdomains that they touch: those of subdomain d are
 * edit[start[d]] to edit[start[d + 1] - 1], numbers from 0 to count - 1 (bones, mostly). */
typedef struct bw_edits {
  int32_t count;
  const int32_t *start; /* (index, subdomain_count + 1) */
  const int32_t *edit;  /* (index, start[subdomain_count]) */
} bw_edits;

/* A *text with name and version of the BLAS in use, the thread libraries, CHOLMOD, METIS, GLPK...:
 * one line each; it warns of a BLAS known to be slow here (OpenMP variant). Release it with
 * bw_free. */
BW_API bw_status bw_library_versions(bw_context *context, char **text);

#ifdef __cplusplus
}
#endif
#endif
