/* external: solvers outside of the engine, over several processes. */
#ifndef BARWRIGHT_EXTERNAL_H
#define BARWRIGHT_EXTERNAL_H

#include "barwright/linear.h"

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
  int ranks;           /* processes */
  int iterations;      /* of conjugate gradients, in all solves */
  double energy_error; /* (-) estimated error of a solution over the solution, both in
                          energy, the largest of all solves; 0: by a factor */
  double send, assembly, setup, solve; /* (s) mesh to the ranks; matrices; multigrid or factor;
                                          solves */
  double processor; /* (s) of all processes while the system was open, waiting in MPI included */
  double bytes,
      largest; /* (bytes) memory of all processes at their peaks, of the largest of them */
} bw_external_report;

/* What an external solver is to assemble; all is borrowed while the system is open. The DOF map
 * says which components are unknowns, and in which frames. */
typedef struct bw_external_problem {
  const bw_material *material;
  const bw_dof_map *dof_map; /* and its mesh */
  bool mass;                 /* assemble M too: modes are wanted */
} bw_external_problem;

struct bw_modes_options;
/* What it finds; the lists are allocated with bw_alloc for the caller, who releases them. */
typedef struct bw_external_modes {
  int count;
  double *value;  /* ((rad/s)^2, count) ascending */
  double *vector; /* (any, count x node_count x 3) global directions, M-norm 1, without rigid-body
                     motion */
  int solves, recovered; /* as in bw_modes */
  bool counted;          /* as in bw_modes */
} bw_external_modes;

/* Fields of a body that the processes of an external solver write. */
typedef struct bw_external_output {
  const char *path;           /* of the .pvtu file, borrowed */
  int count;                  /* of fields */
  const char *const *name;    /* (count) of at most BW_EXTERNAL_NAME - 1 bytes, borrowed */
  const double *const *field; /* (any, count of node_count x 3) global directions, borrowed */
  /* Which of the fields has stresses, which are written too: at nodes (stress, von_mises,
   * max_principal) and of elements (element_stress); -1: none. */
  int displacement;
} bw_external_output;
enum { BW_EXTERNAL_NAME = 64 /* bytes of a name, its end included */ };

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
  /* `count` fields as those of bw_system_solve, the forces balanced already; displacements up to a
   * rigid-body motion. The two may be the same block. */
  bw_status (*solve)(bw_context *context, int count, const double *force, double *displacement);
  /* The lowest elastic modes. */
  bw_status (*modes)(bw_context *context, const struct bw_modes_options *options,
                     bw_external_modes *modes);
  /* Each process writes a piece of a .pvtu file, of the elements and fields that it has, and the
   * one that calls the file that names the pieces. Where one fails, no file of the result is left.
   * The matrices are released before: the system has only `report` and `close` after it. */
  bw_status (*write)(bw_context *context, const bw_external_output *output);
  /* What it did since it was opened. */
  void (*report)(bw_context *context, bw_external_report *report);
  /* Releases the system. */
  void (*close)(void);
} bw_external;
/* Registers a solver for the process, borrowed until the next registration; NULL: none. */
BW_API void bw_external_register(const bw_external *external);

#ifdef __cplusplus
}
#endif
#endif
