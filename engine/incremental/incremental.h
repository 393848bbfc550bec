/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* What the files incremental*.c share: the inside of a system that follows edits.
 *
 * Invariants. DOF map and stiffness are of the model last synchronised. The factor, where there
 * is one, fits the present unknowns. It is that of the stiffness when it was last updated; since
 * then the subdomains marked in `touched` have changed in the frames of their nodes, and no others:
 * with no mark it is the factor of the present stiffness, whatever has turned. It is always applied
 * in the present frames. */
#ifndef BWI_INCREMENTAL_INCREMENTAL_H
#define BWI_INCREMENTAL_INCREMENTAL_H

#include "barwright/incremental.h"
#include "base/cost.h"
#include "linear/pcg.h"
#include "linear/two_level.h"
#include "statics/internal.h"

typedef struct bwi_incremental {
  const bw_model *rest;  /* retained: all subdomains at rest */
  const bw_model *model; /* retained: last synchronised */
  bool rotate_material;
  int32_t subdomain_count;
  int32_t *element_subdomain, *node_subdomain;
  bw_edits edits;               /* count 0: none are known */
  int32_t *edit_start, *edit;   /* what `edits` points to */
  bw_subdomain_motion *motion;  /* subdomain_count: since rest */
  double *frame;                /* subdomain_count x 9: those of `motion` */
  double *supports;             /* rows of the DOF map that are supports' x 9: as last reported */
  bwi_factor *factor;           /* or NULL */
  int wanted_bits;              /* of its numbers, asked for: 32, 64; 0: as is cheaper */
  bw_backend wanted_backend;    /* asked for; BW_BACKEND_AUTO: that of the factor there is */
  bw_ordering wanted_ordering;  /* asked for; BW_ORDERING_AUTO: that of the factor there is */
  bool double_only;             /* single precision failed for this body */
  double refinements;           /* iterations with a factor in single precision, when last solved */
  bwi_elimination_reach *reach; /* of the factor's symbolic; or NULL */
  uint8_t *touched;             /* subdomain_count */
  const bw_mesh *factored;      /* retained: the shape the factor was last updated with */
  const bw_material *factored_material; /* retained: and the material then */
  double *factored_frame;               /* subdomain_count x 9: and the frames then */
  /* iterations with the factor as it is */
  double iteration_ratio; /* iterations needed over predicted, when last iterated */
  uint8_t *iterated_on;   /* subdomain_count: what was touched then */
  double spent;           /* s of the reference machine on iterations since the last edit */
  /* what solves without the factor; made and followed when first needed at a shape */
  bwi_two_level *two_level;
  bool two_level_known, two_level_usable; /* of the present shape */
  double two_level_ratio[2]; /* iterations needed over predicted, when last used: from nothing,
                                  from a solution near by; 0: not yet */
  uint8_t *latest;           /* subdomain_count: touched since the system was last solved */
  bool answered;             /* it was solved since the last update */
  double excess_seconds;     /* s: what solutions by two-level PCG cost more than updating a factor
                                would have cost that had always been, since it last was */
  double change; /* of the touched subdomains' shape since it was factored; negative: not known */
} bwi_incremental;

/* Whether there is a factor that can be used, and whether it is that of the present stiffness. */
bool bwi_incremental_usable(const bw_incremental_system *incremental);
bool bwi_incremental_current(const bw_incremental_system *incremental);

/* ---- incremental_solve.c --------------------------------------------------------------------- */

/* How a solver works. */
typedef enum bwi_incremental_way {
  BWI_AUTO,     /* what costs least, by operations and bytes, counted */
  BWI_REFACTOR, /* the supernodes that the edits touched, and their ancestors */
  BWI_ITERATE,  /* conjugate gradients, preconditioned by the factor as it is */
  BWI_FULL,     /* every supernode again: for checks and baselines */
  BWI_PCG       /* two-level PCG: needs no factor */
} bwi_incremental_way;
/* Writes what solved the equations. */
void bwi_incremental_note(bwi_incremental_way way, bw_reuse *reuse);

/* ---- incremental_update.c -------------------------------------------------------------------- */

/* The frames of supports as they are, seen from the subdomains of their nodes (`frame`: the
 * subdomains' frames): rotations are measured against these. Release with bw_free. */
bw_status bwi_incremental_supports(bw_context *context, const bw_incremental_system *incremental,
                                   const bw_dof_map *dof_map, const double *frame,
                                   double **reported);

/* Whether an element's elasticity is another than when the factor was last updated, but for turns
 * of a material that turns with its subdomain. Both where there is a factored shape. */
bool bwi_incremental_other_material(const bwi_incremental *inner, int64_t element,
                                    const bw_material **before, const bw_material **now);

/* ---- incremental_factor.c -------------------------------------------------------------------- */

/* Update the factor, all of it where `full`. On failure it is not usable. Where single
 * precision breaks down, it is made in double precision. */
bw_status bwi_incremental_factor(bw_context *context, bw_incremental_system *incremental, bool full,
                                 bw_reuse *reuse);

/* Single precision failed: the factor is in double precision from now on. */
bw_status bwi_incremental_use_double(bw_context *context, bw_incremental_system *incremental,
                                     bw_reuse *reuse);

/* ---- incremental_precision.c ----------------------------------------------------------------- */

/* *bits: 32 or 64, that of the factor there is, or 0; becomes what the factor is to be. */
bw_status bwi_incremental_choose_bits(bw_context *context, const bw_incremental_system *incremental,
                                      const bwi_elimination_reach *reach, int *bits);
/* Iterations to be expected with the factor of the present shape: 0 in double precision. */
double bwi_incremental_refinements(const bw_incremental_system *incremental, double tolerance);

/* ---- incremental_predict.c ------------------------------------------------------------------- */

#define BWI_INCREMENTAL_TOLERANCE 1e-10 /* of iterations, where none is given */
/* What the ways to solve would cost, in seconds of the reference machine. */
typedef struct bwi_incremental_cost {
  double refactor, iterate; /* for all right-hand sides, and those still to come */
  double one_iteration;     /* of all right-hand sides together, without those to come */
  double iterations;        /* predicted */
  double factor; /* what the bound was multiplied by: iteration_ratio or max_iteration_ratio */
  double again;  /* refactor, had the factor been current before the last edit */
  bool near;     /* a guess has done a part of it */
  double pcg;    /* by two-level PCG, for all right-hand sides; INFINITY: there are none */
  double one_pcg_iteration, pcg_iterations;
} bwi_incremental_cost;
void bwi_incremental_predict(bw_incremental_system *incremental,
                             const bw_incremental_options *options, double tolerance, int64_t count,
                             bwi_incremental_cost *cost);

/* ---- initial_guess.c ------------------------------------------------------------------------- */

/* What is left to iterate where options->guess has fields near the solution. Without any, only the
 * tolerance is set. Release with bwi_initial_guess_clear. */
typedef struct bwi_initial_guess {
  double *guess, *force; /* by right-hand side: where to begin, and f - K guess */
  double *load, *energy; /* see bwi_pcg */
  double tolerance;      /* of the side that has farthest to go, relative to what is left of it */
} bwi_initial_guess;
bw_status bwi_initial_guess_make(bw_context *context, const bw_incremental_system *incremental,
                                 const bw_incremental_options *options, int64_t count,
                                 const double *force, bwi_initial_guess *left);
void bwi_initial_guess_clear(bwi_initial_guess *left);

/* ---- incremental_pcg.c ----------------------------------------------------------------------- */

/* Whether the body can be solved by two-level PCG. */
bool bwi_incremental_has_two_level(const bw_incremental_system *incremental);
/* That, in `displacement`, where the balanced force is, beginning where `left` says; as few
 * iterations as `limit` may not be enough: then *converged is false, `displacement` still the
 * force. */
bw_status bwi_incremental_by_two_level(bw_context *context, bw_incremental_system *incremental,
                                       const bw_incremental_options *options, int limit,
                                       const bwi_initial_guess *left, int64_t count,
                                       double *displacement, int *iterations, bool *converged);

/* ---- incremental_check.c --------------------------------------------------------------------- */

/* Compare stiffness and solution with those of a full refactorisation: BW_INTERNAL. */
bw_status bwi_incremental_check(bw_context *context, const bw_incremental_system *incremental,
                                double tolerance, int64_t count, const double *force,
                                const double *displacement, bw_reuse *reuse);

#endif
