/* external: solvers outside of the engine, over several processes. */
#ifndef BARWRIGHT_EXTERNAL_H
#define BARWRIGHT_EXTERNAL_H

#include "barwright/eigen.h"
#include "barwright/statics.h"

#ifdef __cplusplus
extern "C" {
#endif

/* Systems that are too large for one machine are given to a solver that works on several:
 * engine/distributed, a library of its own over MPI, PETSc and SLEPc, which the engine does not
 * link. Who loads it registers it here. It assembles by itself, with the engine's routines, and
 * multiplies by what it assembles; the check of what comes back is the engine's. */

/* (-) Relative residual that an external solver reaches where the bw_solver leaves it open. */
#define BW_EXTERNAL_TOLERANCE 1e-10
enum { BW_EXTERNAL_ITERATIONS = 2000 /* of conjugate gradients at most, likewise */ };

/* What an external solver did. */
typedef struct bw_external_report {
  int ranks;                           /* processes */
  int iterations;                      /* of conjugate gradients, in all solves */
  double send, assembly, setup, solve; /* (s) mesh to the ranks; matrices; multigrid or factor;
                                          solves */
  double processor; /* (s) of all processes while the system was open, waiting in MPI included */
  double bytes,
      largest; /* (bytes) memory of all processes at their peaks, of the largest of them */
} bw_external_report;

/* What an external solver is to assemble; all is borrowed while the system is open. The DOF map
 * says which components are unknowns, and in which frames. */
typedef struct bw_external_problem {
  const bw_model *model; /* its mesh and material */
  const bw_dof_map *dof_map;
  bool mass; /* assemble M too: modes are wanted */
} bw_external_problem;

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
  /* Distributes the mesh and assembles. `solver`, read while this runs, is of the backend
   * BW_BACKEND_PETSC: BW_SOLVER_CHOLESKY, a factor spread over the processes, or BW_SOLVER_PCG with
   * algebraic multigrid over the rigid-body motions. Modes solve their inner systems with it. */
  bw_status (*open)(bw_context *context, const bw_external_problem *problem,
                    const bw_solver *solver);
  /* kx = K x and, unless mx is NULL, mx = M x, of `count` fields (any, count x node_count x 3) at
   * all components, prescribed or not, without use of the matrices that it solves with. magnitude
   * (any, count): the Euclidean norm of what the diagonal blocks contribute to K x, each entry's
   * terms without their signs, from which rounding errors follow; may be NULL. */
  bw_status (*multiply)(bw_context *context, int count, const double *x, double *kx, double *mx,
                        double *magnitude);
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

/* As bw_modes_elastic, with what options->solver says of SLEPc: BW_UNSUPPORTED when no solver is
 * registered, and the solver's own statuses. */
BW_API bw_status bw_modes_external(bw_context *context, const bw_model *model,
                                   const bw_modes_options *options, bw_modes **modes);
/* The modes of a model by any eigensolver. `given` as in bw_system_of_model; `*system` (may be
 * NULL) is the one that was used, also where modes fail, or NULL where the solver needs none. Those
 * of bw_system_of_model, bw_modes_elastic and bw_modes_external, BW_UNSUPPORTED where no external
 * solver is registered. */
BW_API bw_status bw_modes_of_model(bw_context *context, const bw_model *model, bw_system *given,
                                   const bw_modes_options *options, bw_system **system,
                                   bw_modes **modes);

#ifdef __cplusplus
}
#endif
#endif
