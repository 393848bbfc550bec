/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* What the files of heat share. */
#ifndef BARWRIGHT_HEAT_INTERNAL_H
#define BARWRIGHT_HEAT_INTERNAL_H

#include "assemble/internal.h"
#include "barwright/heat.h"
#include "matrix/sparse.h"

/* ---- element.c ------------------------------------------------------------------------------- */

/* The conductivity tensor (W/(m K), row by row) of an element, without its table's factor. All that
 * knows materials is here. */
void bwi_heat_conductivity(const bw_material *material, int64_t element, double tensor[9]);
/* Whether conductivity depends on temperature anywhere. */
bool bwi_heat_varies(const bw_material *material);
/* Adds the matrix of conduction at these temperatures to values (W/K, block_count). */
bw_status bwi_heat_conduct(bw_context *context, const bw_block_pattern *pattern,
                           const bw_mesh *mesh, const bw_material *material,
                           const double *temperature, double *values);
/* The sum of the integrals of N_a times a nodal field (or 1, of NULL): load (m3, node_count). */
bw_status bwi_heat_volume(bw_context *context, const bw_mesh *mesh, const bw_array *nodal,
                          double *load);

/* ---- boundary.c ------------------------------------------------------------------------------ */

/* Whether a condition is a film: its flux depends on the temperature. */
bool bwi_heat_is_film(const bw_heat_condition *condition);
/* Whether it joins two surfaces: contact or a bond. What passes is no part of the balance. */
bool bwi_heat_joins(const bw_heat_condition *condition);
/* Adds the heat into nodes (W, node_count) by a condition on the boundary at these temperatures,
 * and returns its sum. BW_INVALID for radiation at a temperature below absolute zero. */
bw_status bwi_heat_boundary(bw_context *context, const bw_mesh *mesh,
                            const bw_heat_condition *condition, const double *temperature,
                            double *in, double *sum);
/* Adds the slope of a film, the heat that goes out for each kelvin, to values (W/K, block_count).
 */
void bwi_heat_film(const bw_block_pattern *pattern, const bw_mesh *mesh,
                   const bw_heat_condition *condition, const double *temperature, double *values);
/* Where block (i, j) is, if both share an element; else another one. */
int64_t bwi_heat_block(const bw_block_pattern *pattern, int32_t i, int32_t j);

/* ---- contact.c ------------------------------------------------------------------------------- */

/* Finds joint and size of contact. BW_GEOMETRY where the surfaces do not touch, BW_INVALID where
 * they have a node in common. What it made is the condition's also on failure. */
bw_status bwi_heat_pair(bw_context *context, const bw_mesh *mesh, bw_heat_condition *condition);
/* As bwi_heat_boundary: what comes into `on` goes out of `with`; *sum is of `on`. */
void bwi_heat_contact(const bw_heat_condition *condition, const double *temperature, double *in,
                      double *sum);
/* Adds what a contact has between nodes of an element to values (W/K, block_count), and what joins
 * others to cross. */
bw_status bwi_heat_join(bw_context *context, const bw_block_pattern *pattern,
                        const bw_heat_condition *condition, double *values, bwi_entries *cross);
/* Finds bond and size. Those of bwi_heat_pair, and BW_INVALID for a node that follows others in two
 * bonds, or follows nodes that follow others. */
bw_status bwi_heat_bond(bw_context *context, const bw_heat *heat, bw_heat_condition *condition);
/* Releases joint and bond. */
void bwi_heat_unpair(bw_heat_condition *condition);

/* ---- system.c -------------------------------------------------------------------------------- */

/* The equations of a body: q(T) + r = C dT/dt, with q the heat that flows into the nodes by
 * conditions and conduction, and r the reactions where temperatures are prescribed. */
typedef struct bwi_heat_system {
  const bw_heat *heat; /* borrowed */
  bw_heat_options options;
  bw_solver *solver; /* what the matrices are solved by, of a kind that is not left open */
  bw_block_pattern *pattern;
  int32_t unknowns;
  int32_t *unknown;   /* (index, node_count) its unknown, or -1 where the temperature is prescribed,
                         or follows others in a bond */
  int32_t *prescribe; /* (index, node_count) the condition that prescribes it, or -1 */
  int32_t *node;      /* (index, unknowns) */
  double *conduction; /* (W/K, block_count), at `conducted` where it depends on the temperature */
  double *films;      /* (W/K, block_count) of convection and contact; or NULL */
  bwi_entries cross;  /* (W/K) of nodes that contact joins, and that share no element */
  bw_sparse_matrix *expand; /* node_count x unknowns: temperatures from unknowns, apart from
                               prescribed ones; NULL without contact and bonds */
  double *through;          /* (W, condition_count) by bonds into their sides `on` */
  double *capacity;         /* (J/K, block_count), or NULL */
  double *volume; /* (m3, node_count) of sources and powers in the volume, one after the other */
  bool radiates, by_temperature;
  bw_operator *matrix; /* of the unknowns, of the last solution, which had this rate and part */
  double rate, part;
  bw_operator *inverse; /* near that of the matrix; kept while it serves */
  int served;           /* iterations of its first solution */
  bw_solver_report report;
} bwi_heat_system;
bw_status bwi_heat_system_open(bw_context *context, const bw_heat *heat,
                               const bw_heat_options *options, bool transient, bool lumped,
                               bwi_heat_system *system);
void bwi_heat_system_close(bwi_heat_system *system);
/* Writes the prescribed temperatures, and those that follow others. */
void bwi_heat_prescribe(const bwi_heat_system *system, double *temperature);
/* q (W, node_count) at these temperatures, and what each condition gives, heat_in (W,
 * condition_count), 0 of prescribed temperatures. */
bw_status bwi_heat_inflow(bw_context *context, bwi_heat_system *system, const double *temperature,
                          double *q, double *heat_in);
/* One step in time, or the steady state: T with
 *   rate C (T - base) = part q(T) + rest   where the temperature is not prescribed. */
typedef struct bwi_heat_task {
  double rate;        /* (1/s) 0: steady */
  const double *base; /* (K, node_count) or NULL */
  double part;        /* (-) */
  const double *rest; /* (W, node_count) or NULL */
} bwi_heat_task;
/* From temperature (K, node_count) on; q and heat_in are those of the solution, and remainder (W,
 * node_count) is rate C (T - base) - part q - rest, in which the reactions are left: that of nodes
 * that follow others is moved to these. */
bw_status bwi_heat_solve(bw_context *context, bwi_heat_system *system, const bwi_heat_task *task,
                         double *temperature, double *q, double *heat_in, double *remainder,
                         double *stored, int *iterations, double *change);
/* The dual temperatures z (K/W, node_count) of the temperature at a node: by the matrix at these
 * temperatures, those of the last solution. */
bw_status bwi_heat_dual(bw_context *context, bwi_heat_system *system, const double *temperature,
                        int32_t node, double *z);
/* A solution without temperatures. */
bw_status bwi_heat_solution_create(bw_context *context, const bw_heat *heat,
                                   bw_heat_solution **solution);
/* The highest temperature, without an error. */
void bwi_heat_find_highest(bw_heat_solution *solution);
/* Reactions, the highest temperature, and the balance of all. heat_in has what conditions give
 * without reactions. */
void bwi_heat_balance(const bwi_heat_system *system, const double *remainder,
                      bw_heat_solution *solution);

/* ---- flux.c ---------------------------------------------------------------------------------- */

/* The estimate of the error (K) of the highest temperature, of which `dual` (K/W, node_count) is
 * the dual: the product of both fields' recovered errors at its node, and what is above the node.
 */
bw_status bwi_heat_highest_error(bw_context *context, const bw_heat_solution *solution,
                                 const double *dual, double *error);

/* ---- precondition.c -------------------------------------------------------------------------- */

/* Jacobi and the linear functions of the corners, for tet10: z = D^-1 r + P (P^T A P)^-1 P^T r. The
 * matrix is that of the unknowns. */
bw_status bwi_heat_two_level(bw_context *context, const bwi_heat_system *system,
                             const bw_sparse_matrix *matrix, bw_operator **result);

#endif
