/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* What the files of linear/ share. Three objects, each depending on the one before:
 *
 *   bwi_order     nodes in elimination order and the supernodes of the factor, on nodes. Depends on
 *                 topology and on which nodes take part.
 *   bwi_symbolic  the same expanded to unknowns (1 to 3 at a node), and the plan of the work.
 *   bwi_factor    the numbers: L (and signs) with A = L S L^T, S = diag(+-1), S = I when A is
 *                 positive definite.
 *
 * Positions: a node's place in the elimination order. Unknowns are numbered by position, those of
 * one node next to each other, so a row list on nodes says everything about rows. */
#ifndef BWI_LINEAR_INTERNAL_H
#define BWI_LINEAR_INTERNAL_H

#include "barwright/linear.h"
#include "linear/real.h"

/* ---- order --------------------------------------------------------------------------------- */

typedef struct bwi_order {
  bw_object object;
  bw_ordering ordering; /* that was asked for: METIS, AMD or BACKEND (the nodes are in METIS's);
                           AUTO: made for edits by subdomains */
  int32_t node_count;   /* of the mesh */
  int32_t size;         /* nodes that take part */
  int32_t *node_at;     /* size: mesh node at each position */
  int32_t *position;    /* node_count: position of each mesh node, or -1 */
  int32_t super_count;
  int32_t *super;     /* super_count + 1: first position of each supernode */
  int32_t *parent;    /* super_count: parent supernode (larger), or -1 */
  int64_t *row_start; /* super_count + 1 */
  int32_t *row;       /* positions of each supernode's rows, ascending, its own columns first */
} bwi_order;

/* An order of the nodes with take[node] != 0 (NULL: all), and CHOLMOD's supernodal analysis of
 * it. */
bw_status bwi_order_create_by(bw_context *context, const bw_block_pattern *pattern,
                              const uint8_t *take, bw_ordering ordering, bwi_order **order);
/* The same by nested dissection. */
bw_status bwi_order_create(bw_context *context, const bw_block_pattern *pattern,
                           const uint8_t *take, bwi_order **order);

/* An order for edits subdomain by subdomain: of several candidates the one in which an edit (NULL:
 * of one subdomain) touches the least work, without making the whole factor much costlier. */
bw_status bwi_order_create_subdomains(bw_context *context, const bw_block_pattern *pattern,
                                      const uint8_t *take, const bw_mesh *mesh,
                                      int32_t subdomain_count, const int32_t *element_subdomain,
                                      const bw_edits *edits, bwi_order **order);

/* ---- symbolic ------------------------------------------------------------------------------ */

/* A subtree of the supernodal tree, worked on by one thread; its supernodes are consecutive. */
typedef struct bwi_task {
  int32_t first, root; /* supernodes first..root */
  double flops;
  int64_t stack; /* numbers needed for its stack of update matrices */
  int64_t own;   /* where its root's update matrix goes, in a block that outlives the stack */
} bwi_task;

/* How the work on a set of supernodes (closed under going to the parent) is shared out: subtrees,
 * each for one thread, and a top whose fronts are cut into tiles. */
typedef struct bwi_plan {
  int32_t task_count; /* subtrees, largest first */
  bwi_task *task;
  int32_t top_count; /* supernodes above all tasks, ascending */
  int32_t *top;
  int64_t top_stack; /* numbers needed for the stack of the top */
  int64_t own;       /* numbers in the update matrices of the tasks' roots */
  int32_t *task_of;  /* super_count: task whose root this is, or -1 */
  double flops;
} bwi_plan;

typedef struct bwi_symbolic {
  bw_object object;
  bwi_order *order; /* retained */
  int components;   /* of the field: 1 to 3 */
  int32_t unknowns;
  int32_t *first;              /* order->size + 1: first unknown at each position */
  int32_t *at;                 /* node_count x components: unknown in elimination order, or -1 */
  int64_t *panel;              /* super_count + 1: where each supernode's panel starts in L */
  int32_t *rows;               /* super_count: unknowns in the row list (pivots included) */
  int64_t max_rows, max_panel; /* over all supernodes */
  bwi_plan plan;               /* of all supernodes */
  double flops;
} bwi_symbolic;

/* `unknown`: node_count x components, >= 0 where there is an unknown (which number does not
 * matter). Nodes with unknowns must be in the order. */
bw_status bwi_symbolic_create(bw_context *context, bwi_order *order, int components,
                              const int32_t *unknown, bwi_symbolic **symbolic);
/* Whether `symbolic` was made for just these unknowns. */
bool bwi_symbolic_fits(const bwi_symbolic *symbolic, int components, const int32_t *unknown);
static inline int32_t bwi_pivots(const bwi_symbolic *symbolic, int32_t s) {
  const bwi_order *o = symbolic->order;
  return symbolic->first[o->super[s + 1]] - symbolic->first[o->super[s]];
}
/* The unknowns of a supernode's rows below its pivots, ascending; how many. */
static inline int32_t bwi_outer_unknowns(const bwi_symbolic *symbolic, int32_t s,
                                         int32_t *unknown) {
  const bwi_order *o = symbolic->order;
  int32_t count = 0;
  int64_t begin = o->row_start[s] + o->super[s + 1] - o->super[s];
  for (int64_t k = begin; k < o->row_start[s + 1]; k++)
    for (int32_t u = symbolic->first[o->row[k]]; u < symbolic->first[o->row[k] + 1]; u++)
      unknown[count++] = u;
  return count;
}

/* Work of one supernode's front. */
double bwi_front_flops(const bwi_symbolic *symbolic, int32_t s);
/* `wanted`: super_count, closed under going to the parent (NULL: all). `keep`: update matrices that
 * have a place of their own (NULL: none). Clear in any case. */
bw_status bwi_plan_create(bw_context *context, const bwi_symbolic *symbolic, const uint8_t *wanted,
                          const uint8_t *keep, bwi_plan *plan);
void bwi_plan_clear(bwi_plan *plan);

/* ---- which subdomains reach which supernodes (elimination_reach.c) --------------------------- */

/* A matrix entry is of the subdomains whose elements contribute to its block of nodes; it sits in
 * the supernode of the node eliminated first. */
typedef struct bwi_elimination_reach {
  bw_object object;
  const bwi_symbolic *symbolic; /* retained */
  int32_t subdomain_count;
  int words;     /* of 64 subdomains */
  uint64_t *set; /* super_count x words: subdomains that contribute to the columns of the supernode
                    or of any below it */
  uint8_t *keep; /* super_count: its update matrix is kept, its set differs from its parent's */
  int64_t kept_numbers; /* in all those update matrices */
  int32_t *part;        /* order->size: subdomain of an element by its position eliminated first, of
                           bwi_elimination_reach_create_by_plan; else NULL */
} bwi_elimination_reach;
bw_status bwi_elimination_reach_create(bw_context *context, bwi_symbolic *symbolic,
                                       const bw_mesh *mesh, int32_t subdomain_count,
                                       const int32_t *element_subdomain,
                                       bwi_elimination_reach **reach);
/* For changes anywhere: each task of the symbolic's plan is a subdomain, and each supernode above
 * them. */
bw_status bwi_elimination_reach_create_by_plan(bw_context *context, bwi_symbolic *symbolic,
                                               const bw_mesh *mesh, bwi_elimination_reach **reach);
/* Of such a reach: marks the subdomains of the elements that are not 0 in `changed`. */
void bwi_elimination_reach_touch(const bwi_elimination_reach *reach, const bw_mesh *mesh,
                                 const uint8_t *changed, uint8_t *touched_subdomain);
/* Of one subdomain that is everything: for factors made again as a whole, in place. */
bw_status bwi_elimination_reach_create_whole(bw_context *context, bwi_symbolic *symbolic,
                                             bwi_elimination_reach **reach);
/* wanted: super_count, 1 where the set meets touched_subdomain (subdomain_count). Returns the
 * work. */
double bwi_elimination_reach_supernodes(const bwi_elimination_reach *reach,
                                        const uint8_t *touched_subdomain, uint8_t *wanted);
/* The work that refactoring for these subdomains would take. */
double bwi_elimination_reach_flops(const bwi_elimination_reach *reach,
                                   const uint8_t *touched_subdomain);

/* ---- factor -------------------------------------------------------------------------------- */

/* The matrix stiffness + shift * mass on a pattern's blocks, in frames where dof_map asks. */
typedef struct bwi_matrix {
  const bw_block_pattern *pattern;
  const double *stiffness; /* components^2 per block */
  const double *mass;      /* 1 per block, or NULL */
  double shift;
  const bw_dof_map *dof_map; /* for its frames; NULL: global */
  double memory;             /* bytes that a factor may take; 0: what is free */
  bool even;                 /* most blocks are symmetric in themselves (smoother.h) */
} bwi_matrix;

/* The entries of a block, row by row (entries.c): for `transpose`, the block's column is the row
 * wanted. */
void bwi_matrix_block(const bwi_matrix *matrix, int components, int64_t index, bool transpose,
                      int32_t row, int32_t column, double *block);

/* block = F_row block F_column^T for nodes with frames of their own. */
void bwi_rotate_block(const bw_dof_map *dof_map, int32_t row, int32_t column, double *block);

/* The inverse of a node's diagonal block on its components whose state's bit (1u << bw_dof_state)
 * is in `states`, 0 on the others: F^T (F K F^T)^-1 F with the directions of these components for
 * rows of F. Block and inverse are in global directions. False where a pivot is not positive, or
 * not above `weakest` of its diagonal entry. */
bool bwi_invert_node_block(const bw_dof_map *dof_map, int64_t node, unsigned states, double weakest,
                           const double *block, double inverse[9]);

/* The factor of a matrix in single precision is that of `unit` times the matrix, a power of two
 * that brings entries of any units into the range of float; in double precision `unit` is 1. */
typedef struct bwi_factor {
  bw_object object;
  bwi_symbolic *symbolic; /* retained */
  const struct bwi_kernels *kernels;
  void *value; /* panels, column-major, one leading dimension per supernode; NULL: CHOLMOD's */
  struct bwi_cholmod *cholmod; /* its factor, of bwi_kernels_cholmod alone, or NULL */
  double unit;
  int64_t negative;               /* negative pivots */
  uint8_t *minus;                 /* unknowns: 1 where a pivot is negative, in a factor L S L^T;
                                     NULL: it is L L^T */
  struct bwi_refactor_data *kept; /* of a factor that can be updated in part, or NULL */
  bool broken;                    /* of such a factor: the last update failed */
} bwi_factor;

/* A = L L^T. *bad_node (may be NULL) is the mesh node of the failing pivot when BW_SINGULAR. */
bw_status bwi_factor_create(bw_context *context, bwi_symbolic *symbolic, const bwi_matrix *matrix,
                            bwi_factor **factor, int32_t *bad_node);
/* The same by these kernels, keeping the update matrices that `reach` (retained; NULL: none) names
 * and the memory that updates work in. */
bw_status bwi_factor_create_in(bw_context *context, bwi_symbolic *symbolic,
                               const bwi_matrix *matrix, bwi_elimination_reach *reach,
                               const struct bwi_kernels *kernels, bwi_factor **factor,
                               int32_t *bad_node);
/* A = L S L^T with S = diag(+-1), of an indefinite matrix, without pivoting: *trusted as in
 * bwi_count_negative. Solutions lose as many digits as the weakest pivot has lost. BW_SINGULAR for
 * a pivot that is zero. */
bw_status bwi_factor_create_indefinite(bw_context *context, bwi_symbolic *symbolic,
                                       const bwi_matrix *matrix, bwi_factor **factor, bool *trusted,
                                       int32_t *bad_node);
/* Factor again, in place, what entries of the touched subdomains (NULL: all) reach (CHOLMOD: all,
 * where they reach anything): the same bits as a full refactorisation, when only entries of theirs
 * have changed since. *flops (may be NULL): work done. On failure, BW_CANCELLED included, the
 * factor is broken: solves refuse it, an update of all subdomains (NULL) repairs it. *bad_node as
 * above. */
bw_status bwi_factor_update(bw_context *context, bwi_factor *factor, const bwi_matrix *matrix,
                            const uint8_t *touched_subdomain, double *flops, int32_t *bad_node);
/* A factor with update matrices, of which all that the touched subdomains reach is computed; the
 * rest is copied from `former`, which has them too. *flops: work done. Statuses and *bad_node as
 * there. */
bw_status bwi_factor_create_updated(bw_context *context, const bwi_factor *former,
                                    const bwi_matrix *matrix, const uint8_t *touched_subdomain,
                                    double *flops, bwi_factor **factor, int32_t *bad_node);
/* By what a factor can be updated in part; NULL: it cannot. */
bwi_elimination_reach *bwi_factor_reach(const bwi_factor *factor);
/* Gives back the memory that updates work in, until the next one. */
void bwi_factor_release_work(bwi_factor *factor);
/* Bytes of L; operations of the factorisation. */
size_t bwi_factor_bytes(const bwi_factor *factor);
int64_t bwi_factor_entries(const bwi_factor *factor);
double bwi_factor_flops(const bwi_factor *factor);
/* Bytes of the update matrices kept, and of the memory kept to work in. */
void bwi_factor_update_bytes(const bwi_factor *factor, size_t *updates, size_t *work);
/* The number of negative eigenvalues of A, by L S L^T without keeping L. *trusted is false where a
 * pivot was so small that rounding may have chosen its sign. */
bw_status bwi_count_negative(bw_context *context, bwi_symbolic *symbolic, const bwi_matrix *matrix,
                             int64_t *negative, bool *trusted);
/* x = (unit A)^-1 x for `width` right-hand sides next to each other: unknowns x width, row by row.
 * Width 1, 2, 4, 8 or 16. The numbers of x must be those of the factor. */
bw_status bwi_factor_solve(bw_context *context, const bwi_factor *factor, int width, void *x);
enum { BWI_MAX_WIDTH = 16 };

/* ---- dense kernels (front.c) --------------------------------------------------------------- */

/* An update matrix is a lower triangle kept as columns of tiles: block column c holds the rows from
 * its diagonal tile down, column-major. That is half of a square, and each tile is a plain
 * matrix. */
enum { BWI_TILE = 512 };
/* Numbers in the update matrix of `outer` rows. */
static inline int64_t bwi_update_size(int64_t outer) {
  int64_t full = outer / BWI_TILE, rest = outer % BWI_TILE;
  return BWI_TILE * (full * outer - BWI_TILE * (full * (full - 1) / 2)) + rest * rest;
}
/* Where row 0 of a column would be: the pointer plus a row at or below the diagonal is an entry. */
static inline int64_t bwi_update_column(int64_t outer, int64_t column) {
  int64_t c = column / BWI_TILE, before = c * BWI_TILE;
  return BWI_TILE * (c * outer - BWI_TILE * (c * (c - 1) / 2)) +
         (column - before) * (outer - before) - before;
}

typedef struct bwi_front {
  int rows, pivots;    /* the panel is rows x pivots, column-major, leading dimension rows */
  void *panel;         /* assembled in, L out */
  void *update;        /* of rows - pivots: assembled in, Schur complement out */
  const double *scale; /* pivots: size of each diagonal entry before elimination */
  bool signs;          /* allow negative pivots */
  uint8_t *minus;      /* pivots: set to 1 where one is negative; or NULL */
  /* out */
  int negative;
  int failed; /* first pivot that is not positive (signs false), or -1 */
  int weak;   /* a pivot lost nearly all its digits, or -1 */
} bwi_front;

/* Rows of a child that are next to each other in the parent too. */
typedef struct bwi_run {
  int32_t from, to, length;
} bwi_run;

/* ---- kernels for either precision (real.h) --------------------------------------------------- */

/* Add the entries of supernode s, times `unit`, to its panel. local: row of each position in it;
 * scale: size of each pivot's diagonal entry (front_assemble.c). */
void bwi_matrix_to_panel(const bwi_symbolic *symbolic, const bwi_matrix *matrix, double unit,
                         int32_t s, const int32_t *local, void *panel, double *scale);
/* Add the update matrix of a child to the front (panel and update matrix) of supernode s, whose
 * rows are `local` by position; runs: room for the child's rows. */
bw_status bwi_add_child(bw_context *context, const bwi_symbolic *symbolic, int32_t s, int32_t child,
                        const void *of_child, const int32_t *local, bwi_run *runs, void *panel,
                        void *update);
/* Eliminate the pivots. Tiles run through bw_parallel where there are several (front.c). */
bw_status bwi_front_eliminate(bw_context *context, bwi_front *front);
/* bwi_solve_fields for a factor of such numbers (fields.c). */
bw_status bwi_solve_fields_of(bw_context *context, const bwi_factor *factor,
                              const bw_dof_map *dof_map, int64_t count, const double *force,
                              double *displacement);

typedef struct bwi_kernels {
  const char *backend;
  int bits;    /* of a number: 64 or 32 */
  size_t size; /* its bytes */
  void (*entries)(const bwi_symbolic *, const bwi_matrix *, double, int32_t, const int32_t *,
                  void *, double *);
  bw_status (*child)(bw_context *, const bwi_symbolic *, int32_t, int32_t, const void *,
                     const int32_t *, bwi_run *, void *, void *);
  bw_status (*eliminate)(bw_context *, bwi_front *);
  bw_status (*solve)(bw_context *, const bwi_factor *, int, void *);
  bw_status (*solve_fields)(bw_context *, const bwi_factor *, const bw_dof_map *, int64_t,
                            const double *, double *);
} bwi_kernels;
extern const bwi_kernels bwi_kernels_double, bwi_kernels_single;
extern const bwi_kernels bwi_kernels_cholmod; /* linear/cholmod.h: it serves all that a factor does
                                                 except single precision and partial updates */

/* ---- fields and unknowns (fields.c) -------------------------------------------------------- */

/* displacement = A^-1 force for fields (node_count x components each, one after the other; the two
 * may be the same block): 0 where there is no unknown. Frames by `dof_map`, NULL: global. With a
 * factor in single precision, to its digits. */
bw_status bwi_solve_fields(bw_context *context, const bwi_factor *factor, const bw_dof_map *dof_map,
                           int64_t count, const double *force, double *displacement);

/* ---- states (dof_states.c) ----------------------------------------------------------------- */

/* Zero the components of a global field whose state's bit (1u << bw_dof_state) is not in
 * `states`, in each node's frame. */
void bwi_keep_states(const bw_dof_map *dof_map, unsigned states, double *field);
/* What of a vector at a node is along its unknowns, isostatic constraints among them; the two may
 * be the same. */
void bwi_project_unknowns(const bw_dof_map *dof_map, int64_t node, const double *f, double out[3]);
/* The prescribed values as a global field, 0 elsewhere. */
void bwi_prescribed_field(const bw_dof_map *dof_map, double *field);
/* ---- systems (system.c) -------------------------------------------------------------------- */

/* Block sparsity pattern: no stiffness, no mass, no factor yet. `previous` (may be NULL), of the
 * same topology, gives its pattern, what has not changed of its stiffness where it has one, and
 * what its factor leaves. */
bw_status bwi_system_begin(bw_context *context, const bw_mesh *mesh, const bw_material *material,
                           const bw_dof_map *dof_map, const bw_system *previous,
                           bw_system **system);
/* bw_system_factor by a solver (NULL: the default), which may replace the factor that there is,
 * with what of an order fits (or NULL), and the bytes that a factor may take. */
bw_status bwi_system_factor(bw_context *context, bw_system *system, const bw_solver *solver,
                            bwi_symbolic *old, double available);
/* What solves the equations: a factor, PCG with two levels, or PCG with another preconditioner. */
typedef enum bwi_way { BWI_BY_FACTOR, BWI_BY_TWO_LEVEL, BWI_BY_PCG } bwi_way;
/* Names, operations and memory of what solves a system, and of what was chosen by cost (`solver` is
 * NULL) the predictions. */
void bwi_report_way(const bw_system *system, bwi_way way, const bw_solver *solver,
                    bw_solver_report *report);
/* Begins the report of a system. */
void bwi_system_report(bw_system *system, bwi_way way, const bw_solver *solver, const char *reason);
/* Gives the system its preconditioner for PCG, block Jacobi, multigrid (NULL) or a factor, where it
 * is not what the system has. Statuses as there. */
bw_status bwi_system_precondition(bw_context *context, bw_system *system, const bw_solver *solver,
                                  bwi_symbolic *old, double available);

/* A system that an operator of 3 node_count rows solves, which it retains. */
bw_status bwi_system_by_operator(bw_context *context, const bw_model *model,
                                 const bw_dof_map *dof_map, const bw_operator *solution,
                                 bw_system **out);

/* The equations of a model at the external solver: no pattern, no stiffness. */
bw_status bwi_system_begin_external(bw_context *context, const bw_model *model,
                                    const bw_dof_map *dof_map, const bw_solver *solver,
                                    bw_system **system);
/* y = K x for `count` fields, and *noise (may be NULL, else of one field) as bwi_residual_noise has
 * it: by elements where the system has no stiffness but a preconditioner that multiplies so; else
 * by the stiffness, which is made where there is none. */
bw_status bwi_system_multiply(bw_context *context, bw_system *system, int64_t count,
                              const double *x, double *y, double *noise);
/* What is left of the equations that a system was made from, with other positions, materials or
 * supports (system_former.c). */
typedef struct bwi_former {
  bw_object object;
  bwi_factor *factor; /* retained: of the same supports; or NULL */
  uint8_t *changed;   /* element_count: contributes other numbers than then */
} bwi_former;
/* Compares the equations with those of `previous` and takes over what has not changed. */
bw_status bwi_system_take_over(bw_context *context, const bw_system *previous, bw_system *system);
/* The factor of a system, in part from that of the former one where this saves much of the work.
 * Statuses and *bad_node as bwi_factor_create. */
bw_status bwi_system_factorise(bw_context *context, bw_system *system, bwi_symbolic *symbolic,
                               const bwi_matrix *matrix, const struct bwi_kernels *kernels,
                               bwi_factor **factor, int32_t *bad_node);
/* Nothing else is taken from the former equations. */
void bwi_system_forget(bw_system *system);
/* The mass, where the system has none yet. */
bw_status bwi_system_mass(bw_context *context, bw_system *system);

/* Whether elements of the one material contribute the same bits to the stiffness as of the other.
 */
bool bwi_same_stiffness(const bw_material *a, const bw_material *b);
/* Same supports: a system made for one dof_map serves the other. */
bool bwi_same_supports(const bw_dof_map *a, const bw_dof_map *b);
/* The system of a model with this DOF map: one on the same mesh, material and supports. */
bool bwi_system_serves(const bw_system *system, const bw_model *model, const bw_dof_map *dof_map);
/* A system that serves the DOF map, with its prescribed displacements: `given`, retained, or one
 * that shares its matrices and what solves them. `given` stays as it is: others may hold it. NULL
 * for a view of other displacements, whose matrices change. */
bw_status bwi_system_following(bw_context *context, bw_system *given, const bw_dof_map *dof_map,
                               bw_system **system);
/* Whether a system on this mesh may take over pattern and order of one (may be NULL). */
bool bwi_system_reusable(const bw_system *system, const bw_mesh *mesh);
/* Whether the equations of a model are those of a system at the external solver, with this solver
 * (NULL: any). */
bool bwi_external_serves(const bw_system *system, const bw_model *model, const bw_dof_map *dof_map,
                         const bw_solver *solver);
/* BW_UNSUPPORTED for equations at the external solver, which this process does not have, and for
 * those of a joined model, which an operator solves. */
bw_status bwi_need_equations(bw_context *context, const bw_system *system);
/* The same elements on the same nodes. */
bool bwi_same_topology(const bw_mesh *a, const bw_mesh *b);
/* The expanded order for a DOF map's unknowns, with what of `old` (may be NULL) fits. With
 * element_subdomain (may be NULL) a new order is made for edits by subdomains, unless `ordering`
 * asks for another. */
bw_status bwi_symbolic_for(bw_context *context, const bw_block_pattern *pattern,
                           const bw_dof_map *dof_map, bw_ordering ordering, int32_t subdomain_count,
                           const int32_t *element_subdomain, const bw_edits *edits,
                           bwi_symbolic *old, bwi_symbolic **symbolic);
/* Bytes that making a factor of doubles takes, at their peak. */
double bwi_factor_peak_bytes(const bwi_symbolic *symbolic, int threads);
/* f -= W R (R^T f), and u -= R (R^T W u), of several fields; nothing where no motion is free. */
bw_status bwi_balance_fields(bw_context *context, const bw_dof_map *dof_map, int64_t count,
                             double *force);
bw_status bwi_steady_fields(bw_context *context, const bw_dof_map *dof_map, int64_t count,
                            double *displacement);
/* BW_INVALID for the view of an incremental system whose factor is not current. */
bw_status bwi_need_factor(bw_context *context, const bw_system *system);
/* BW_SINGULAR at a node, in words for the user. */
bw_status bwi_fail_singular(bw_context *context, const bw_mesh *mesh, int32_t node);

/* Refinement of a static solution stops below this relative residual, or when it no longer helps.
 */
#define BWI_REFINE_TO 1e-10

/* The size to which rounding lets the residual f - K u fall: what doubles leave of the terms of
 * K u, taken from its diagonal blocks. */
#define BWI_RESIDUAL_NOISE 3.0
double bwi_residual_noise(const bw_block_pattern *pattern, const double *stiffness,
                          const double *u);

#endif
