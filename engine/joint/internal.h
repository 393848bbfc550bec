/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* What the files of joint share. */
#ifndef BWI_JOINT_INTERNAL_H
#define BWI_JOINT_INTERNAL_H

#include "barwright/assemble.h"
#include "barwright/joint.h"
#include "model/internal.h"

/* Constraints C x = d that reduced the unknowns once more, and what gives their multipliers R from
 * the residual of the equations before: C_p^T R = (T^T (K u - f) - P^T (load - S q))_p, at as many
 * pivot unknowns p as there are constraints. */
typedef struct bwi_eliminated {
  int count;
  int *component;        /* count: which component of which point (6 p + k) is prescribed */
  bw_sparse_matrix *row; /* count x 3 node_count: of T^T */
  double *point;         /* count x 6 point_count: of P^T */
  double *square;        /* count x count: C_p^T */
} bwi_eliminated;

/* The displacements that supports, bonds and couplings allow: u = T x + g, and those of remote
 * points: q = P x + h. */
typedef struct bwi_reduction {
  bool with_zeros; /* products keep entries that are 0: their pattern is that of the mesh and T */
  bw_dof_map *dof_map;          /* of the bodies apart */
  const bw_bond **bond_of;      /* node_count: the bond in which a node follows, or NULL */
  int32_t *row_of;              /* node_count: its row there */
  const bw_bond *bond;          /* of the model */
  int32_t *shortening;          /* of each bond: the column of one that is free, or -1 */
  const bw_coupling *coupling;  /* of the model */
  int point_count;              /* couplings */
  int32_t *coupling_of;         /* node_count: the rigid coupling of a node, or -1 */
  int32_t *unknown;             /* node_count x 3, in the nodes' frames: the column, or -1; */
  int32_t *point_unknown;       /* point_count x 6, of rigid ones; all before pivots are gone */
  int32_t unknown_count;        /* columns */
  bw_sparse_matrix *t;          /* 3 node_count x unknown_count, global directions; of complex
                                   displacements twice as many rows: real and imaginary parts */
  bw_sparse_matrix *transposed; /* T^T */
  double *g;                    /* 3 node_count */
  bw_sparse_matrix *p;          /* 6 point_count x unknown_count, or NULL without points */
  double *h;                    /* 6 point_count */
  bwi_eliminated gone;
} bwi_reduction;
/* Clear with bwi_reduction_clear in any case. Refers to the bonds and couplings
 * of the model. `locked`: bonds with a given preload keep their shortening. */
bw_status bwi_reduction_open(bw_context *context, const bw_model *model, bool locked,
                             bwi_reduction *reduction);
void bwi_reduction_clear(bwi_reduction *reduction);
/* Fills bond_of and row_of. BW_INVALID for a node that follows in two bonds, and for one that
 * follows and is followed. */
bw_status bwi_reduction_followers(bw_context *context, const bw_model *model,
                                  bwi_reduction *reduction);

/* T^T A T, or the sum of those of both parts of T, of a block matrix, `block` 9 or 1 numbers for
 * each block of the pattern as bw_block_multiply takes them. Symmetric to the last bit. */
bw_status bwi_reduce_matrix(bw_context *context, const bwi_reduction *reduction,
                            const bw_block_pattern *pattern, const double *values, int block,
                            bw_sparse_matrix **reduced);

/* Adds masses (block 1) or springs (9) to a matrix. The nodes of a facet are those of an element:
 * the pattern has their blocks. */
void bwi_add_attachments(const bw_model *model, const bw_block_pattern *pattern, int block,
                         double *values);
/* Whether something attaches the model to the ground by springs. */
bool bwi_has_springs(const bw_model *model);

/* Moves forces (node_count x 3) at nodes that follow in bonds to the nodes that they follow. */
void bwi_reduction_move(const bwi_reduction *reduction, double *force);

/* ---- preload.c ------------------------------------------------------------------------------- */

/* Adds what given preloads exert to nodal forces (node_count x 3). BW_INVALID for a section of
 * which each node has a support. */
bw_status bwi_preload_add(bw_context *context, const bw_model *model, const bwi_reduction *r,
                          double *force);
/* The preloads and shortenings, from the forces of the bonds. */
void bwi_preload_results(const bw_model *model, const bwi_reduction *r, const double *displacement,
                         bw_joint_force *result);

/* ---- points.c, eliminate.c ------------------------------------------------------------------- */

/* BW_INVALID for a node of a rigid coupling that a support or a bond moves otherwise. */
bw_status bwi_points_check(bw_context *context, const bw_model *model, const bwi_reduction *r);
/* BW_UNSUPPORTED, and why, for a remote point with a prescribed motion that is not zero. */
bw_status bwi_points_refuse_motion(bw_context *context, const bw_model *model, const char *why);
/* P and h, from T and g; then prescribed values of distributed couplings leave T and P. */
bw_status bwi_points_open(bw_context *context, bwi_reduction *r);
/* Adds the springs (else the masses) of remote points to a reduced matrix, which is replaced. */
bw_status bwi_points_add(bw_context *context, const bwi_reduction *r, bool springs,
                         bw_sparse_matrix **matrix);
/* Adds P^T s P of one point, which couples all nodes of a distributed one. */
bw_status bwi_points_add_one(bw_context *context, const bwi_reduction *r, int point,
                             const double s[6][6], bw_sparse_matrix **matrix);
/* b += P^T (load - S h), with the weight of masses in `gravity` (m/s2). */
void bwi_points_load(const bwi_reduction *r, const double gravity[3], double *b);
/* Motions of the points and what they exert: of distributed ones from the residual K u - f in
 * `force` (node_count x 3), in which what they exert is then left out. */
bw_status bwi_points_spread(bw_context *context, const bwi_reduction *r, const double gravity[3],
                            const double *x, double *force, bw_coupling_result *result);
/* Takes what prescribed components of distributed points exert off such a residual, which has
 * their loads, springs and masses already. */
bw_status bwi_points_react(bw_context *context, const bwi_reduction *r, double *force);
/* The same of rigid ones, after bwi_reduction_move. What they exert on each of their nodes goes to
 * `joint` (N, node_count x 3). */
void bwi_points_gather(const bwi_reduction *r, double *force, bw_coupling_result *result,
                       double *joint);
/* force += factor D^T load, with the mean motion D u of the nodes of a coupling. */
void bwi_point_exert(const bw_coupling *coupling, double factor, const double load[6],
                     double *force);
bool bwi_point_has_springs(const bw_remote_point *point);
/* Whether modes need a density. */
bool bwi_point_has_mass(const bw_remote_point *point);

/* Constraints of x: `count` rows (count x unknown_count) with values d reduce T, g, P and h. Each
 * one is of a prescribed component (6 p + k). BW_INVALID where one depends on the others. Changes
 * rows and d. */
bw_status bwi_eliminate(bw_context *context, bwi_reduction *r, int count, const int *component,
                        double *rows, double *d);

/* The equations of a joined model. */
typedef struct bwi_joined_equations {
  bwi_reduction reduction;
  bw_block_pattern *pattern;
  double *stiffness;          /* with springs */
  bw_operator *k;             /* T^T K T */
  const bw_operator *inverse; /* borrowed: of k, or NULL; */
  const uint8_t *held;        /* borrowed: of k where these unknowns are held, or NULL, */
  const double *place;        /* borrowed: their values; 0 at others */
  int rigid_count;
  int32_t rigid_body;
} bwi_joined_equations;
/* Clear with bwi_joined_clear in any case; `locked` as bwi_reduction_open. `known`: the stiffness
 * of the model's bodies apart, or NULL. */
bw_status bwi_joined_open(bw_context *context, const bw_model *model, bool locked,
                          const bw_subdomain_stiffness *known, bwi_joined_equations *q);
/* The static solution from open equations; `start` (s): when they were begun. */
bw_status bwi_joined_static(bw_context *context, const bw_model *model,
                            const bw_statics_options *options, const bwi_joined_equations *q,
                            double start, bw_static **out);
/* BW_UNSUPPORTED for options that joined models do not know. */
bw_status bwi_joined_check_options(bw_context *context, const bw_statics_options *options);
void bwi_joined_clear(bwi_joined_equations *q);
/* T^T A T of values on the pattern, `block` 9 or 1 numbers for each of its blocks. */
bw_status bwi_joined_operator(bw_context *context, const bwi_joined_equations *q,
                              const double *values, int block, const char *name, bw_operator **out);
/* The lowest eigenpairs of K and M: those of the rigid-body modes and options->count more. */
bw_status bwi_joined_pairs(bw_context *context, const bw_modes_options *options, int rigid_count,
                           const bw_operator *k, const bw_operator *m, bw_eigenpairs **pairs);
/* BW_SINGULAR for a residual that is negative where the elimination failed, or too large. */
bw_status bwi_joined_check_residual(bw_context *context, double residual);
/* Adds the stiffness that levers of remote points have by the load of a static solution, whose
 * model has not changed, to T^T K_sigma T. BW_UNSUPPORTED for a moment about which it is not
 * symmetric. */
bw_status bwi_levers_add(bw_context *context, const bw_static *solution,
                         const bwi_joined_equations *q, bw_sparse_matrix **matrix);
/* BW_UNCONSTRAINED, with what moves. */
bw_status bwi_joined_fail_free(bw_context *context, const bwi_joined_equations *q);

#endif
