/* eigen: the lowest modes of a body. */
#ifndef BARWRIGHT_EIGEN_H
#define BARWRIGHT_EIGEN_H

#include "barwright/linear.h"
#include "barwright/report.h"

#ifdef __cplusplus
extern "C" {
#endif

/* ---- eigensolvers ---------------------------------------------------------------------------- */

/* A method for the lowest modes. */
typedef enum bw_eigensolver_kind {
  BW_EIGENSOLVER_AUTO,    /* LANCZOS */
  BW_EIGENSOLVER_LANCZOS, /* block Lanczos on the inverse: eight right-hand sides at a time */
  BW_EIGENSOLVER_ARPACK,  /* ARPACK-ng: implicitly restarted Lanczos on the inverse, one right-hand
                             side at a time. Its state is one for the process: a run waits until
                             that of another thread has ended */
  BW_EIGENSOLVER_LOBPCG,  /* locally optimal block preconditioned conjugate gradients: by a factor
                             where there is one, else by the two-level preconditioner for quadratic
                             elements and multigrid for linear ones */
  BW_EIGENSOLVER_SLEPC    /* SLEPc on several processes: the registered bw_external */
} bw_eigensolver_kind;
/* How an eigensolver works. */
typedef struct bw_eigensolver_options {
  bw_eigensolver_kind kind; /* default BW_EIGENSOLVER_AUTO */
  int basis; /* vectors of the Krylov space, LANCZOS and ARPACK; default 0: three times the modes
                and 48, or twice the modes and 20; otherwise at least the modes and 16, or 2 */
  const bw_solver *preconditioner; /* LOBPCG, retained: BW_SOLVER_TWO_LEVEL, for quadratic elements,
                                      or BW_SOLVER_AMG, the engine's; default NULL: as said there */
  const bw_solver *inner; /* SLEPC, retained: of its inner systems, of the backend BW_BACKEND_PETSC:
                             BW_SOLVER_CHOLESKY, or BW_SOLVER_PCG with algebraic multigrid, where
                             none counts the eigenvalues; default NULL: the former */
} bw_eigensolver_options;
BW_API void bw_eigensolver_options_default(bw_eigensolver_options *options);

/* An immutable description of an eigensolver, for any number of solutions. */
typedef struct bw_eigensolver {
  bw_object object;
  bw_eigensolver_options options; /* as given, or the default */
} bw_eigensolver;
/* `options` may be NULL. BW_INVALID for numbers outside their ranges, another preconditioner, and
 * an inner solver that does not serve. */
BW_API bw_status bw_eigensolver_create(bw_context *context, const bw_eigensolver_options *options,
                                       bw_eigensolver **solver);
/* "auto", "lanczos", "arpack", "lobpcg" or "slepc": static. NULL is automatic. */
BW_API const char *bw_eigensolver_name(const bw_eigensolver *solver);

/* ---- modes --------------------------------------------------------------------------------- */

/* How modes are found. */
typedef struct bw_modes_options {
  int count;        /* modes wanted; default 15, 1 or more */
  double tolerance; /* (-) relative residual; default 1e-8, above 0 and below 1 */
  bool sturm;    /* count eigenvalues below the last one from an indefinite factor; default true */
  uint64_t seed; /* of the start vector; default 1 */
  const bw_eigensolver *solver; /* borrowed; default NULL: automatic */
  int nodal_diameter; /* of a sector of cyclic symmetry: modes with so many nodal diameters, 0 or
                         more, at most half the sectors; default -1: the lowest of all */
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
  int solves;       /* right-hand sides solved for */
  int recovered;    /* modes found only after the Sturm count showed that they were missing */
  bool counted;     /* the Sturm count confirmed that none is missing */
  bool tested;      /* without a factor: an iteration from random vectors, orthogonal to the modes,
                       found none below the last */
  bw_solver_report report;             /* how they were found */
  struct bw_external_report *external; /* of an external solver, or NULL */
  const bw_cyclic *cyclic; /* retained, of a sector; NULL: of the whole, also what follows */
  int *nodal_diameter;     /* (count) of each mode */
  double *quadrature; /* (any, count x node_count x 3) the imaginary part of the shape, of which
                         `shape` is the real one; the M-norm of both together is 1 */
} bw_modes;
/* The lowest elastic modes K u = lambda M u (consistent mass) on the inverse, with the system's own
 * factor; unconstrained rigid-body modes are projected out exactly. Fewer than wanted where the
 * body has fewer. BW_CONVERGENCE where the iteration does not reach the tolerance; LOBPCG takes a
 * residual below 1e-4 that no longer falls, with a warning. BW_LIMIT for too many modes,
 * BW_UNSUPPORTED for SLEPC without an external solver that has the equations, BW_INVALID for
 * another eigensolver where it has them. `options` may be NULL. */
BW_API bw_status bw_modes_elastic(bw_context *context, bw_system *system,
                                  const bw_modes_options *options, bw_modes **modes);
/* The modes of a model by any eigensolver. `given` as in bw_system_of_model; `*system` (may be
 * NULL) is the one that was used, also where modes fail, or NULL where the external solver
 * has the equations. Equations at the external solver are taken by SLEPc, which may be left out
 * then. Those of bw_system_of_model and bw_modes_elastic, BW_UNSUPPORTED where no external solver
 * is registered, and that solver's own statuses. */
BW_API bw_status bw_modes_of_model(bw_context *context, const bw_model *model, bw_system *given,
                                   const bw_modes_options *options, bw_system **system,
                                   bw_modes **modes);
/* The lowest nonconstant modes of the scalar Laplacian on the mesh (free boundary), section 4 of
 * worst-case. `pattern`: of the mesh. BW_SINGULAR where its factor fails, BW_GEOMETRY for an
 * inverted element, and as bw_modes_elastic. */
BW_API bw_status bw_modes_laplacian(bw_context *context, const bw_mesh *mesh,
                                    const bw_block_pattern *pattern,
                                    const bw_modes_options *options, bw_modes **modes);

/* ---- matrices and operators ------------------------------------------------------------------ */

/* How the eigenpairs of K x = lambda M x are found. Pointers are borrowed. */
typedef struct bw_eigen_solve_options {
  int count;                    /* pairs wanted; default 6, 1 or more */
  double tolerance;             /* (-) relative residual; default 1e-8, above 0 and below 1 */
  bool test;                    /* look for pairs that are missing; default true */
  uint64_t seed;                /* of the start vectors; default 1 */
  double shift;                 /* (any) sigma, below all eigenvalues: K - sigma M must be positive
                                   definite; default 0 */
  const bw_eigensolver *solver; /* default NULL: block Lanczos where K - sigma M is a sparse matrix
                                   that can be factored, else LOBPCG */
  const bw_operator *preconditioner; /* of LOBPCG: near the inverse of K - sigma M, symmetric and
                                        positive definite; default NULL: the inverse of the diagonal
                                        of a matrix, none for an operator */
} bw_eigen_solve_options;
BW_API void bw_eigen_solve_options_default(bw_eigen_solve_options *options);

/* The smallest eigenvalues of K x = lambda M x and their vectors. */
typedef struct bw_eigenpairs {
  bw_object object;
  int count;
  int64_t size;     /* of a vector */
  double *value;    /* (any, count) ascending */
  double *vector;   /* (any, count x size) of M-norm 1, M-orthogonal; the largest component is
                       positive */
  double *residual; /* (-, count) |K x - lambda M x| / |(lambda - sigma) M x| */
  double *error;    /* (any, count) an eigenvalue lies within this distance of the value: the
                       residual in the norm of the inverse of M (Parlett, The Symmetric
                       Eigenvalue Problem, chapter 15), but for rounding */
  int recovered;    /* pairs found only after the test showed that they were missing */
  bool counted;     /* the Sturm count confirmed that none is missing */
  bool tested;      /* an iteration from random vectors found none below the last */
  bw_solver_report report; /* how they were found */
} bw_eigenpairs;
/* The smallest eigenpairs of symmetric K and M; mass NULL: the identity. LANCZOS and ARPACK work on
 * the inverse, which needs sparse matrices; LOBPCG needs products alone. Fewer than wanted where
 * there are fewer. BW_SINGULAR where K - sigma M or M is not positive definite, BW_CONVERGENCE
 * where the iteration does not reach the tolerance, BW_INVALID for options outside their ranges,
 * sizes that differ, a matrix or operator that is not symmetric, and one that has to be factored
 * but is no matrix; BW_UNSUPPORTED for SLEPC and preconditioners of bodies, BW_LIMIT for too many
 * pairs or entries of a factor, BW_MEMORY before any is allocated where it is larger than what is
 * free. Those of the operators' functions. `options` may be NULL. */
BW_API bw_status bw_eigen_solve(bw_context *context, const bw_operator *stiffness,
                                const bw_operator *mass, const bw_eigen_solve_options *options,
                                bw_eigenpairs **pairs);

#ifdef __cplusplus
}
#endif
#endif
