/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* The linear program (14) of worst-case in scaled form, and its solvers.
 *
 *     maximise c . t   subject to   A t = b,  0 <= t <= u,  b = (0, ..., 0, 1)
 *
 * t_j = A_j p_j / F_tot is the fraction of the total force that pressure j carries, u_j = A_j p_max
 * / F_tot. With friction a node has a group of columns; then u bounds the sum of each group. The
 * last row of A is all ones: the fractions add up to one. The rows before it balance force and
 * moment, body by body, and are orthonormalised (weights A_j): a column has entries of order one
 * only in the rows of its own body. Rows that every pressure fulfils anyway (a sphere's moments)
 * are dropped. Columns are permuted: levels are nested samples of the boundary, coarse first, and
 * inside a level columns are sorted by body into segments. */
#ifndef BARWRIGHT_ANALYSIS_LINEAR_PROGRAM_H
#define BARWRIGHT_ANALYSIS_LINEAR_PROGRAM_H

#include "barwright/analysis.h"

enum { BWI_LOCAL_ROWS = 6, BWI_TWO_LEVEL = 8 };

/* Columns begin..end-1 have their local rows 0..rows-1 at global rows row.. */
typedef struct bwi_segment {
  int32_t begin, end, row, rows;
} bwi_segment;

/* Balance rows of one body: kept scaled rows = transform (rows x motions) times raw rows, a raw row
 * being <motion, G e_j> / A_j. */
typedef struct bwi_balance {
  int32_t component, motions, row, rows;
  int32_t motion[BWI_LOCAL_ROWS];
  double transform[BWI_LOCAL_ROWS][BWI_LOCAL_ROWS];
} bwi_balance;

typedef struct bwi_linear_program {
  int32_t rows;         /* balance rows kept, and the row of shares */
  int32_t columns;      /* pressures, and a slack when the force may be smaller */
  int32_t directions;   /* columns of a node: 1 without friction */
  int32_t groups;       /* nodes, and the slack */
  int32_t *group_start; /* groups + 1: columns of each */
  int32_t *group;       /* columns */
  double *entry;        /* BWI_LOCAL_ROWS x columns: local row l of column j at [l * columns + j] */
  double *upper;        /* columns */
  int32_t *source;      /* columns: number of the pressure, -1 for the slack */
  double *area;         /* columns: A of the pressure; 1 for the slack */
  int32_t *first_row, *row_count; /* columns: where the local rows stand */
  int32_t segment_count;
  bwi_segment *segment;
  int levels;
  int32_t level_end[BWI_TWO_LEVEL];      /* columns of levels 0..k: whole groups */
  int32_t level_segments[BWI_TWO_LEVEL]; /* their segments */
  int32_t body_count;
  bwi_balance *body;
  int32_t rigid_mode_count;
  double force, pressure; /* F_tot, p_max */
} bwi_linear_program;

/* x_u cross x_v of a facet of six nodes at a point: twice n dA over the part of the plane. */
void bwi_area_vector(const double (*x)[3], const double barycentric[3], double normal[3]);

/* Work of a unit pressure of each column on each rigid-body motion: motions x columns. */
void bwi_column_motions(const bw_pressure_basis *basis, const bw_dof_map *dof_map, double *work);

/* The columns of a basis without friction, each for the facets of the friction cone. */
bw_status bwi_pressure_with_friction(bw_context *context, const bw_pressure_basis *plain,
                                     const bw_pressure_options *options, bw_pressure_basis **basis);

/* A basis without columns, to be filled: released as every other. */
bw_status bwi_pressure_basis_empty(bw_context *context, const bw_mesh *mesh,
                                   bw_pressure_basis **basis);

bw_status bwi_linear_program_create(bw_context *context, const bw_pressure_basis *basis,
                                    const bw_dof_map *dof_map, const bw_worst_load_options *options,
                                    bwi_linear_program **program);
void bwi_linear_program_destroy(bwi_linear_program *program);

/* Where a solver ended: `rows` basic columns (-1 - r: the unit column of row r, for a row without a
 * basic column of its own) and for the others whether they sit at their upper bound. In a group one
 * column at most is at the upper bound: it carries what the group's basic columns leave of it. */
typedef struct bwi_vertex {
  int32_t *basic;
  uint8_t *at_upper;
  int iterations;
} bwi_vertex;

/* The exact solution at a vertex: basic values and multipliers by a dense factor of the basis.
 * `fraction` has `columns` entries, `multiplier` has `rows`. Says how far the vertex is from being
 * optimal: violation of bounds and rows (fractions), and the duality gap over |c| . t. */
typedef struct bwi_solution {
  double *fraction, *multiplier;
  double value, violation, gap;
} bwi_solution;
bw_status bwi_linear_program_evaluate(bw_context *context, const bwi_linear_program *program,
                                      const double *cost, const bwi_vertex *vertex,
                                      bwi_solution *solution);

/* A bound of  max gain . t,  sum t = 1,  0 <= t <= upper:  x + sum upper max(0, gain - x), for any
 * multiplier x. That of so many halvings exceeds the maximum by at most the range of the gains
 * times 2^-halvings. */
double bwi_knapsack_value(int32_t count, const double *gain, const double *upper, double x);
double bwi_knapsack_multiplier(int32_t count, const double *gain, const double *upper,
                               int halvings);
double bwi_knapsack(int32_t count, const double *gain, const double *upper, int halvings);

/* Solve a dense system in place by elimination with column pivoting; false when singular. */
bool bwi_dense_factor(int32_t n, double *a, int32_t *pivot);
void bwi_dense_solve(int32_t n, const double *a, const int32_t *pivot, double *x);
void bwi_dense_solve_transposed(int32_t n, const double *a, const int32_t *pivot, double *x);

/* GLPK. `attempt` 0: dual simplex with the bound-flipping ratio test; 1: the same after scaling,
 * textbook ratio test; 2: primal simplex. */
typedef struct bwi_glpk bwi_glpk;
bw_status bwi_glpk_create(bw_context *context, const bwi_linear_program *program, bwi_glpk **glpk);
bw_status bwi_glpk_solve(bw_context *context, bwi_glpk *glpk, const double *cost, int attempt,
                         bwi_vertex *vertex);
void bwi_glpk_destroy(bwi_glpk *glpk); /* in the thread that created it */

/* The dual simplex method of our own (dual_simplex.c), also for columns in groups. */
typedef struct bwi_simplex bwi_simplex;
bw_status bwi_simplex_create(bw_context *context, const bwi_linear_program *program,
                             bwi_simplex **simplex);
bw_status bwi_simplex_solve(bw_context *context, bwi_simplex *simplex, const double *cost,
                            bool sampled, bwi_vertex *vertex);
void bwi_simplex_destroy(bwi_simplex *simplex);

/* Where the dual function bends along a line: its slope grows by `slope` after `step`. */
typedef struct bwi_breakpoint {
  double step, slope;
  int32_t column; /* or any number that orders breakpoints */
} bwi_breakpoint;
bool bwi_sooner(const bwi_breakpoint *a, const bwi_breakpoint *b);
/* Bring to the front the first breakpoints whose slopes reach `wanted`, the last of them at the end
 * of these; returns their number, or -1 when all together do not. */
int32_t bwi_select_breakpoints(bwi_breakpoint *list, int32_t count, double wanted);

/* Loads of few hands (hands.c): for an objective with the best pressure of the linear program and
 * its multipliers, the best pressure that was found within `options->hands` patches, and its
 * value. */
typedef struct bwi_hands bwi_hands;
/* The patch around each node: its nodes ascending in member[start[g]] to start[g + 1], *member to
 * be freed also on failure; and the nodes' mean normals. */
bw_status bwi_hand_patches(bw_context *context, const bw_pressure_basis *basis, double radius,
                           double *normal, int64_t *start, int32_t **member);
bw_status bwi_hands_create(bw_context *context, const bw_pressure_basis *basis,
                           const bw_dof_map *dof_map, const bw_worst_load_options *options,
                           bwi_hands **hands);
bw_status bwi_hands_solve(bw_context *context, const bwi_hands *hands, const double *objective,
                          const double *dual, double *pressure, double *value);
void bwi_hands_destroy(bwi_hands *hands);

/* The linear program with solvers and scratch memory per thread, for many batches of objectives
 * (worst_loads.c; see bw_worst_loads). */
typedef struct bwi_loads bwi_loads;
bw_status bwi_loads_create(bw_context *context, const bw_pressure_basis *basis,
                           const bw_dof_map *dof_map, const bw_worst_load_options *options,
                           bwi_loads **loads);
bw_status bwi_loads_solve(bw_context *context, bwi_loads *loads, int64_t count,
                          const double *objective, double *pressure, double *value, double *dual);
void bwi_loads_destroy(bwi_loads *loads);

#endif
