/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* Between the files of distributed/.
 *
 * Every operation is one function that all ranks run (collective). On rank 0 it is called by the
 * engine through bw_external; the others are in bw_world_serve and run it when rank 0's command
 * arrives. What only rank 0 knows (matrix, fields) is given to the function there, NULL elsewhere.
 *
 * Failures. Between two agreements (bwd_agree) a rank may fail by itself; at the agreement all
 * learn of it, and all leave the operation with the same status and message. A rank that fails in
 * the middle of a library's own collective work cannot be waited for: the others sit in a call that
 * never ends. So who comes to an agreement with a failure, and finds after a minute that not all
 * have come, ends the run. */
#ifndef BWD_INTERNAL_H
#define BWD_INTERNAL_H

#include <mpi.h>
#include <petscksp.h>

#include "barwright/distributed.h"

/* ---- world.c --------------------------------------------------------------------------------- */

typedef enum bwd_operation { BWD_OPEN = 1, BWD_SOLVE, BWD_MODES, BWD_CLOSE, BWD_END } bwd_operation;

/* For commands, matrices and fields; byte strings of the caller's have another one. */
MPI_Comm bwd_comm(void);
/* On rank 0: let the others run the operation too. Starts PETSc on first use. */
bw_status bwd_command(bw_context *context, bwd_operation operation);
/* PETSc and SLEPc, on all ranks at once. */
bw_status bwd_libraries(bw_context *context);
/* OK when all ranks come with OK; else the status and message of one that failed, everywhere. */
bw_status bwd_agree(bw_context *context, bw_status status);
/* Has rank 0 been asked to stop? The same answer on all ranks. */
bool bwd_cancelled(bw_context *context);
/* Wait without burning the processor: call again and again; the pauses grow to a millisecond. */
typedef struct bwd_backoff {
  int rounds;
  double since;
} bwd_backoff;
void bwd_pause(bwd_backoff *backoff);

/* A PETSc call inside a function with `status`, `context` and a label done. */
bw_status bwd_petsc_status(bw_context *context, PetscErrorCode code);
#define BWD_TRY(call) BW_TRY(bwd_petsc_status(context, (call)))

/* ---- a system spread over the ranks ---------------------------------------------------------- */

/* Unknowns: three at each node, in the node's frame; nodes are renumbered, those of a rank next to
 * each other. Prescribed components stay in K as decoupled equations with K's own diagonal (so that
 * blocks are 3 x 3 throughout, which multigrid wants) and are zero in M; isostatic
 * ones are ordinary. */
typedef struct bwd_system {
  int rank, ranks;
  int32_t nodes, first, local; /* all; those of this rank */
  bw_external_options options;
  bool direct; /* by a factor */
  int motions;
  int mass_width; /* numbers of M sent per block: 0, 3 (the block's diagonal), 9 */
  Mat K, M;
  Mat isostatic; /* K with the isostatic components decoupled too, or NULL: for a factor */
  Vec force, displacement;
  Vec mask;               /* 1 at the components solved for */
  Vec *motion, *weighted; /* R and W R */
  KSP solver;
  int iterations;
  double seconds_send, seconds_setup, seconds_solve;
  double processor; /* of this process when the system was opened */
  /* Rank 0 alone: */
  const bw_external_matrix *matrix;
  int32_t *row_of;     /* nodes: the row of each */
  int32_t *start;      /* ranks + 1: first row of each rank; on every rank */
  int *counts, *where; /* ranks: numbers of a field and where they begin */
  double *field;       /* 3 x nodes: a field in frames, by row */
} bwd_system;

/* partition.c: nodes to ranks by METIS, few neighbours across; within a rank, neighbours near each
 * other. row_of (node_count) and start (ranks + 1) are filled. */
bw_status bwd_partition(bw_context *context, const bw_block_pattern *pattern, int ranks,
                        int32_t *row_of, int32_t *start);

/* distribute.c: sizes, K, M, mask, motions, to all ranks. Collective, as all below. */
bw_status bwd_distribute(bw_context *context, bwd_system *system);
/* rows.c: the entries of K and M; `max` is the largest number of blocks in a row. */
bw_status bwd_send_rows(bw_context *context, bwd_system *system, int32_t max);

/* fields.c: a field in global directions of rank 0 to a vector, and back. */
bw_status bwd_scatter(bw_context *context, bwd_system *system, const double *field, Vec vector);
bw_status bwd_gather(bw_context *context, bwd_system *system, Vec vector, double *field);
/* The numbers in `system->field` of rank 0, by row and in frames, to a vector. */
bw_status bwd_spread(bw_context *context, bwd_system *system, Vec vector);
/* A node's frame, rows are directions; NULL: the global one. */
const double *bwd_frame_at(const bw_dof_map *dof_map, int64_t node);
void bwd_into_frame(const double *frame, const double *global, double *own);

/* linear.c */
bw_status bwd_solver_create(bw_context *context, bwd_system *system, double rtol);
/* displacement = K^-1 force in the system's vectors or others of their shape; the force is masked
 * in place. */
bw_status bwd_solver_apply(bw_context *context, bwd_system *system, Vec force, Vec displacement);
/* Eigenvalues of K x = lambda M x below sigma, without the rigid-body motions; *trusted: no pivot
 * was in doubt. */
bw_status bwd_count_below(bw_context *context, bwd_system *system, double sigma, int64_t *count,
                          bool *trusted);

/* modes.c: `modes` on rank 0, NULL elsewhere. */
bw_status bwd_modes(bw_context *context, bwd_system *system, const bw_modes_options *options,
                    bw_external_modes *modes);

/* external.c: one operation on this rank; arguments on rank 0, NULL elsewhere. */
bw_status bwd_run_open(bw_context *context, const bw_external_matrix *matrix,
                       const bw_external_options *options);
bw_status bwd_run_solve(bw_context *context, const double *force, double *displacement);
bw_status bwd_run_modes(bw_context *context, const bw_modes_options *options,
                        bw_external_modes *modes);
void bwd_run_close(bw_context *context, bw_external_report *report);
extern const bw_external bwd_external;

#endif
