/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* The linear program (14) of worst-case in scaled form.
 *
 * The fraction t_j = A_j p_j / F_tot of the total force is what pressure j carries, and
 * u_j = A_j p_max / F_tot. With friction a node has a group of columns. The rows before the last
 * balance force and moment, body by body, and are orthonormalised (weights A_j): a column has
 * entries of order one only in the rows of its own body. Rows that every pressure fulfils anyway (a
 * sphere's moments) are dropped. Columns are permuted: levels are nested samples of the boundary,
 * and inside a level columns are sorted by body into segments. */
#ifndef BARWRIGHT_ANALYSIS_LOAD_PROGRAM_H
#define BARWRIGHT_ANALYSIS_LOAD_PROGRAM_H

#include "barwright/analysis.h"
#include "lp/solver.h"

/* Whether a rigid-body mode of `component`, or of all bodies (-1), moves a body. */
static inline bool bwi_moves(int32_t component, int32_t body) {
  return component < 0 || component == body;
}

/* Balance rows of one body, or of all that are joined: kept scaled rows = transform (rows x
 * motions) times raw rows, a raw row being <motion, G e_j> / A_j. */
typedef struct bwi_balance {
  int32_t component, motions, row, rows;
  int32_t motion[BWI_LOCAL_ROWS];
  double transform[BWI_LOCAL_ROWS][BWI_LOCAL_ROWS];
} bwi_balance;

typedef struct bwi_load_program {
  bwi_linear_program lp; /* rows: those of balance kept, and that of the fractions */
  int32_t
      *source;  /* columns: number of the pressure, -1 for the slack of a force that may be less */
  double *area; /* columns: A of the pressure; 1 for the slack */
  int32_t body_count;
  bwi_balance *body;
  int32_t rigid_mode_count;
  double force, pressure; /* F_tot, p_max */
} bwi_load_program;

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

bw_status bwi_load_program_create(bw_context *context, const bw_pressure_basis *basis,
                                  const bw_dof_map *dof_map, const bw_worst_load_options *options,
                                  bwi_load_program **program);
void bwi_load_program_destroy(bwi_load_program *program);

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
/* *sum += what has been solved so far; by which solver, and what was solved with it: `counts` of
 * several that share options, or NULL: its own. */
void bwi_loads_count(const bwi_loads *loads, bwi_lp_counts *sum);
void bwi_loads_report(const bwi_loads *loads, const bwi_lp_counts *counts,
                      bw_solver_report *report);
void bwi_loads_destroy(bwi_loads *loads);

#endif
