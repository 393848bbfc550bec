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
#include "barwright/eigen.h"

/* ---- world.c --------------------------------------------------------------------------------- */

typedef enum bwd_operation {
  BWD_OPEN = 1,
  BWD_MULTIPLY,
  BWD_SOLVE,
  BWD_MODES,
  BWD_WRITE,
  BWD_REPORT,
  BWD_CLOSE,
  BWD_END
} bwd_operation;

/* For commands, matrices and fields; byte strings of the caller's have another one. */
MPI_Comm bwd_comm(void);
/* How many ranks share this machine, and so its memory and processors. */
int bwd_ranks_together(void);
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

/* ---- the mesh of a rank ------------------------------------------------------------------------
 */

/* Which rank has what; on rank 0 while local meshes are made. */
typedef struct bwd_partition {
  int32_t *rank_of_element; /* element_count: each element belongs to one rank */
  int32_t *owner;           /* node_count: the rank that has the node's row */
  int32_t *row_of;          /* node_count */
  int32_t *start;           /* ranks + 1: first row of each rank; borrowed */
} bwd_partition;
/* partition.c: elements to ranks by METIS, with few faces between ranks, and nodes to ranks of
 * their elements. `start` (ranks + 1) is filled too. */
bw_status bwd_partition_create(bw_context *context, const bw_mesh *mesh, int ranks, int32_t *start,
                               bwd_partition *partition);
void bwd_partition_clear(bwd_partition *partition);
/* Elements by the groups of their nodes, group_of (by node; -1: none). An element is in the list of
 * each group that one of its nodes has: (*list)[(*first)[g]] to (*list)[(*first)[g + 1] - 1],
 * ascending. The caller frees both arrays, after a failure too. */
bw_status bwd_group_elements(bw_context *context, int32_t elements, int width,
                             const int32_t *element, const int32_t *group_of, int32_t groups,
                             int64_t **first, int32_t **list);

/* Constants of a material, as they are sent. */
typedef struct bwd_material {
  bool isotropic;
  int formulation;
  double density, young[3], poisson[3], shear[3], axes[9];
} bwd_material;

/* What a rank has of mesh and supports: all elements with one of its nodes, so that it assembles
 * its rows by itself. Its own nodes come first, in the order of their rows; behind them are the
 * ghost nodes, which other ranks own. Elements keep the order of the mesh: every entry of K is the
 * sum of the same numbers in the same order on any number of ranks. */
typedef struct bwd_local_mesh {
  struct bwd_local_counts {
    int32_t order, nodes_per_element, elements, nodes, owned, frames, parts;
  } count;
  int32_t *element; /* (local index, elements x nodes_per_element) */
  uint8_t *mine;    /* (elements) 1: this rank's by the partition, where each element counts once */
  int32_t *part;    /* (elements) of a material with parts, or NULL */
  bwd_material *kind;    /* (parts) unrotated */
  double *rotation;      /* (parts x 9) by which each is turned */
  double *node;          /* (m, nodes x 3) */
  int32_t *row;          /* (nodes) */
  uint8_t *state;        /* (nodes x 3) bw_dof_state */
  int32_t *frame_of;     /* (nodes) row of `frame` or -1; NULL without frames */
  double *frame;         /* (frames x 9) */
  bw_material *material; /* of all elements */
} bwd_local_mesh;
/* local_mesh.c: from rank 0, where `problem` and `partition` are given, to all ranks. Collective.
 */
bw_status bwd_local_mesh_distribute(bw_context *context, const bw_external_problem *problem,
                                    const bwd_partition *partition, const bwd_material *material,
                                    bwd_local_mesh *local);
/* The material of the local elements: of their parts, or `all` where there are none. */
bw_status bwd_local_material(bw_context *context, bwd_local_mesh *local, const bwd_material *all);
/* The arrays for `local->count`. */
bw_status bwd_local_mesh_allocate(bw_context *context, bwd_local_mesh *local);
void bwd_local_mesh_clear(bwd_local_mesh *local);
/* A node's frame, rows are directions; NULL: the global one. */
const double *bwd_local_frame(const bwd_local_mesh *local, int32_t node);
void bwd_material_read(const bw_material *material, bwd_material *constants);
bw_status bwd_material_create(bw_context *context, const bwd_material *constants,
                              bw_material **material);

/* ---- a system spread over the ranks ---------------------------------------------------------- */

/* Unknowns: three at each node, in the node's frame; nodes are renumbered, those of a rank next to
 * each other. Prescribed components stay in K as decoupled equations with K's own diagonal (so that
 * blocks are 3 x 3 throughout, which multigrid wants) and are zero in M; isostatic
 * ones are ordinary. */
typedef struct bwd_system {
  int rank, ranks;
  int32_t nodes, first, local; /* all; those of this rank */
  double tolerance;            /* (-) of conjugate gradients, */
  int max_iterations;
  bool direct;    /* by a factor */
  bool two_level; /* by conjugate gradients over linear elements */
  int motions;
  int mass_width;   /* numbers of M per block: 0, 3 (the block's diagonal), 9 */
  double middle[3]; /* (m) mean of all nodes */
  bwd_local_mesh mesh;
  Mat K, M;
  Mat isostatic; /* K with the isostatic components decoupled too, or NULL: for a factor */
  Vec force, displacement;
  Vec mask;               /* 1 at the components solved for */
  Vec *motion, *weighted; /* R and W R */
  Vec ghosted;            /* of this rank: a field at its own nodes and ghost nodes */
  VecScatter to_ghosted;
  KSP solver;
  bool ready; /* the solver is complete, from its first use on, which gives the tolerance */
  int iterations;
  double energy_error; /* (-) the largest of bwd_energy_error */
  double seconds_send, seconds_assembly, seconds_setup, seconds_solve;
  double processor; /* of this process when the system was opened */
  int32_t *start;   /* ranks + 1: first row of each rank */
  /* Rank 0 alone: */
  const bw_external_problem *problem;
  int32_t *row_of;     /* nodes: the row of each */
  int *counts, *where; /* ranks: numbers of a field and where they begin */
  double *field;       /* 3 x nodes: a field in frames, by row */
} bwd_system;

/* distribute.c: sizes, local meshes, K, M, mask, motions, to all ranks. Collective, as all below.
 */
bw_status bwd_distribute(bw_context *context, bwd_system *system);

/* assemble.c: K, and M unless mass_width (as in bwd_system) is 0, without entries; `max` is the
 * largest number of blocks in a row. `blocked`: the upper triangle of K with one index for each
 * block, which GAMG does not accept: 76 bytes for a pair of blocks where entries take 216. M has
 * all blocks. BW_LIMIT for more entries than PETSc counts, BW_MEMORY where they do not fit. */
bw_status bwd_matrices_create(bw_context *context, const bwd_local_mesh *local, bool blocked,
                              int mass_width, Mat *stiffness, Mat *mass, int32_t *max);
/* The rows of K and M, by the engine's assembly of a piece of the local mesh at a time. */
bw_status bwd_assemble(bw_context *context, const bwd_local_mesh *local, int mass_width,
                       int32_t max, Mat stiffness, Mat mass);
/* multiply.c: bw_external.multiply; fields on rank 0, NULL elsewhere. */
bw_status bwd_multiply(bw_context *context, bwd_system *system, int count, const double *x,
                       double *kx, double *mx, double *magnitude);

/* pieces.c: a piece of the local mesh: some of its rows, with all elements around them. */
typedef struct bwd_piece {
  const bwd_local_mesh *local;
  int32_t first, rows; /* own nodes, by local number */
  int32_t *node;       /* (mesh->node_count) local numbers; the first `rows` are the piece's rows */
  bw_mesh *mesh;
  bw_block_pattern *pattern;
  double *stiffness; /* (N/m, block_count x 9) */
  double *mass;      /* (kg, block_count) or NULL */
} bwd_piece;
/* Assembles piece by piece and calls `visit` with each. A piece lives during the call: no rank has
 * K a second time. */
bw_status bwd_for_pieces(bw_context *context, const bwd_local_mesh *local, bool mass,
                         bw_status (*visit)(bw_context *context, void *data,
                                            const bwd_piece *piece),
                         void *data);

/* linear_elements.c: linear elements on the corners of quadratic ones, for multigrid. */
typedef struct bwd_linear_elements {
  Mat K, interpolation;
  int32_t count, *node; /* the rank's own corners, in the order of their rows: local numbers */
} bwd_linear_elements;
/* Whether they serve as the coarse level of this system. The same answer on all ranks. */
bool bwd_has_linear_elements(const bwd_system *system);
bw_status bwd_linear_elements_create(bw_context *context, bwd_system *system,
                                     bwd_linear_elements *linear);
/* The values of a vector at the corners. */
bw_status bwd_linear_elements_inject(bw_context *context, const bwd_linear_elements *linear,
                                     Vec fine, Vec corners);
void bwd_linear_elements_clear(bwd_linear_elements *linear);

/* fields.c: a field in global directions of rank 0 to a vector, and back. */
bw_status bwd_scatter(bw_context *context, bwd_system *system, const double *field, Vec vector);
bw_status bwd_gather(bw_context *context, bwd_system *system, Vec vector, double *field);
/* A node's frame, rows are directions; NULL: the global one. */
const double *bwd_frame_at(const bw_dof_map *dof_map, int64_t node);
void bwd_into_frame(const double *frame, const double *global, double *own);
void bwd_out_of_frame(const double *frame, const double *own, double *global);
/* Numbers that stand by row in `field` of rank 0's system, as they are, to a vector. */
bw_status bwd_spread(bw_context *context, bwd_system *system, Vec vector);
/* A vector as it is at the rank's own nodes and ghost nodes: (local->count.nodes x 3), as it is,
 * and in global directions. */
bw_status bwd_local_values(bw_context *context, bwd_system *system, Vec vector, double *field);
bw_status bwd_ghosted(bw_context *context, bwd_system *system, Vec vector, double *field);

/* linear.c: the multigrid of the linear elements, before there is K. */
bw_status bwd_coarse_create(bw_context *context, bwd_system *system);
/* The rest, at the first call; then the tolerance alone. */
bw_status bwd_solver_create(bw_context *context, bwd_system *system, double rtol);
/* displacement = K^-1 force in the system's vectors or others of their shape; the force is masked
 * in place. */
bw_status bwd_solver_apply(bw_context *context, bwd_system *system, Vec force, Vec displacement);
/* After a solution by conjugate gradients for the system's own vectors: an estimate of its relative
 * error in energy. The force becomes the residual. Nothing after a factor. */
bw_status bwd_energy_error(bw_context *context, bwd_system *system);
/* Eigenvalues of K x = lambda M x below sigma, without the rigid-body motions; *trusted: no pivot
 * was in doubt. */
bw_status bwd_count_below(bw_context *context, bwd_system *system, double sigma, int64_t *count,
                          bool *trusted);

/* modes.c: `modes` on rank 0, NULL elsewhere. */
bw_status bwd_modes(bw_context *context, bwd_system *system, const bw_modes_options *options,
                    bw_external_modes *modes);

/* write.c: bw_external.write; `output` on rank 0, NULL elsewhere. */
bw_status bwd_write(bw_context *context, bwd_system *system, const bw_external_output *output);

/* external.c: one operation on this rank; arguments on rank 0, NULL elsewhere. */
bw_status bwd_run_open(bw_context *context, const bw_external_problem *problem,
                       const bw_solver *solver);
bw_status bwd_run_multiply(bw_context *context, int count, const double *x, double *kx, double *mx,
                           double *magnitude);
bw_status bwd_run_solve(bw_context *context, int count, const double *force, double *displacement);
bw_status bwd_run_modes(bw_context *context, const bw_modes_options *options,
                        bw_external_modes *modes);
bw_status bwd_run_write(bw_context *context, const bw_external_output *output);
void bwd_run_report(bw_external_report *report);
void bwd_run_close(void);
extern const bw_external bwd_external;

#endif
