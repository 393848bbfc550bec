/* transient: a linear body in time, under loads and supports that change
 * (docs/theory/transient.md).
 */
#ifndef BARWRIGHT_TRANSIENT_H
#define BARWRIGHT_TRANSIENT_H

#include "barwright/dynamics.h"
#include "barwright/statics.h"

#ifdef __cplusplus
extern "C" {
#endif

/* How a linear body is followed in time. Pointers are borrowed. */
typedef struct bw_linear_transient_options {
  double step;  /* (s) of time, above 0; no default. With `error` that of the first step */
  double rho;   /* (-) spectral radius at infinite frequency: 1 damps no motion, 0 takes the
                   fastest away in one step; default 0.9, 0 to 1 */
  double error; /* (-) of the displacement in a step, relative to its largest norm in the mass:
                   steps have `step` times powers of 2, 2^-10 to 2^6, and those of a larger
                   error are taken again; default 0: all have one length; 0 to below 1 */
  bw_damping damping;    /* mass and stiffness, with modes a ratio too */
  const bw_modes *modes; /* elastic modes of the model: the motion is the sum of these and of
                            rigid-body motions, and the static displacement of what they leave out;
                            default NULL: direct integration */
  const int32_t *support_motion; /* (index, support_count) the history that each support follows;
                                    default NULL: the first one */
  const int32_t *point_motion; /* (index, coupling_count) the history that the prescribed motion of
                                  each remote point follows; default NULL: the first one */
  const double *displacement;  /* (m, node_count x 3) at the start; default NULL: 0 */
  const double *velocity;      /* (m/s, node_count x 3) at the start; default NULL: 0 */
} bw_linear_transient_options;
BW_API void bw_linear_transient_options_default(bw_linear_transient_options *options);

/* What multiplies loads and prescribed displacements at a time. */
typedef struct bw_transient_factors {
  const double *load;    /* (-, load_count) of each load of the model; NULL: 1. Borrowed */
  const double *point;   /* (-, coupling_count) of each point's load; NULL: 1. Borrowed */
  const double *support; /* (any, n x 3) of the n histories that supports follow: the factor
                            (-), its first (1/s) and its second derivative in time (1/s2);
                            NULL: 1, at rest. Borrowed */
  /* of steps that adapt: what a step from factor to factor does not see */
  const double *load_missed; /* (-, load_count) mean of each load's factor in the step less that of
                                its ends, or its magnitude; NULL: 0. Borrowed */
  const double
      *point_missed; /* (-, coupling_count) the same of each point's load; NULL: 0. Borrowed */
  const double *support_missed; /* (-, n) the largest such difference of each history of
                                   supports; NULL: 0. Borrowed */
} bw_transient_factors;

struct bwi_linear_transient;
/* A linear body in time, at the present step. Mutable: the revision moves with each step. */
typedef struct bw_linear_transient {
  bw_object object;
  const bw_model *model; /* retained */
  double step;           /* (s) of the next one */
  double time;           /* (s) now, 0 at the start */
  int64_t steps;         /* (count) taken */
  int64_t rejected;      /* (count) computed, and taken again with a shorter length */
  int64_t coarse;        /* (count) of the shortest length, with a larger error than asked for */
  int factors;           /* (count) made; the last 6 lengths are kept */
  double error;          /* (-) of the displacement now, relative to its largest norm in the mass:
                            estimated, 0 where steps do not adapt */
  double *displacement;  /* (m, node_count x 3) */
  double *velocity;      /* (m/s, node_count x 3) */
  double *acceleration;  /* (m/s2, node_count x 3) */
  double *reaction;      /* (N, node_count x 3) of supports at prescribed components, 0 elsewhere */
  double initial;        /* (J) kinetic and strain energy at the start */
  double kinetic;        /* (J) kinetic energy */
  double strain;         /* (J) strain energy */
  double work;           /* (J) done by loads and supports since the start */
  double damped;         /* (J) that the damping took since the start */
  bw_solver_report report;            /* of the factor made last; seconds of all */
  struct bwi_linear_transient *inner; /* the engine's own */
} bw_linear_transient;
/* A body at time 0, by the generalised-alpha method of Chung and Hulbert, J. Appl. Mech. 60 (1993)
 * 371-375, equations 14 to 25, or by modal superposition, exact for loads that are linear within a
 * step. `given` (may be NULL): equations of the model, whose matrices and
 * elimination order serve again. `now` (may be NULL: all loads 1, supports at their values and at
 * rest): factors at the start. A warning says what modes, or supports and joints, leave out of the
 * displacement and the velocity at the start, where that is above 1 % in the norm of the mass. The
 * static part of a load that acts then is there at once with modes. The model must not change
 * afterwards. initial + work = kinetic + strain + damped, but for what the scheme itself takes
 * away. Masses and springs of attachments and couplings are in all energies. Displacements that
 * follow different histories add up: BW_INVALID where two of them prescribe a component, unless
 * both are 0 there. With modes a joined model must not move freely. BW_UNSUPPORTED for cyclic
 * symmetry, for preloads, and with modes for supports that move a body that is free or has
 * stiffness damping. BW_INVALID for numbers outside their ranges, a material without density and
 * modes of another model, BW_UNSUPPORTED for temperature loads and other damping; BW_MEMORY, before
 * it is allocated, for a factor larger than what is free, BW_CONVERGENCE where the first
 * acceleration is not found; those of bw_dof_map_create and bw_system_factor. */
BW_API bw_status bw_linear_transient_create(bw_context *context, const bw_model *model,
                                            bw_system *given,
                                            const bw_linear_transient_options *options,
                                            const bw_transient_factors *now,
                                            bw_linear_transient **transient);
/* One step, to the time at which the factors are `next` (NULL as above). Where steps adapt it may
 * be rejected: `rejected` rises, not `steps`, and a shorter `step` from the same time comes next.
 * The error is that of Zienkiewicz and Xie, Earthquake Engng. Struct. Dyn. 20 (1991) 871-887, for
 * generalised-alpha (docs/theory/transient.md). BW_INVALID where supports or loads were added since
 * the start, for factors that are not finite, and where the energies would not be, as for steps of
 * an absurd length: it stays as it was. BW_MEMORY as above, for a further factor. */
BW_API bw_status bw_linear_transient_step(bw_context *context, bw_linear_transient *transient,
                                          const bw_transient_factors *next);
/* How steps of direct integration resolve a motion (docs/theory/transient.md). */
typedef struct bw_motion_resolution {
  double
      steps; /* (count) per period of the motion, in the mean over its strain energy; 0: unknown */
  double error; /* (-) by which its periods are too long, estimated */
} bw_motion_resolution;
/* Of all steps until now, with a warning where the error is above 3 %. Unknown where steps adapt,
 * which have an error of their own, with modes, which are exact for loads that are linear within a
 * step, for few steps of less than one period and for
 * rigid motions. */
BW_API bw_motion_resolution bw_linear_transient_resolution(bw_context *context,
                                                           const bw_linear_transient *transient);
/* The present displacement as the static solution of the loads less the forces of inertia and of
 * damping: for stresses, files and pictures. It does not change with later steps, and has no forces
 * of joints. */
BW_API bw_status bw_linear_transient_static(bw_context *context,
                                            const bw_linear_transient *transient,
                                            bw_static **result);

#ifdef __cplusplus
}
#endif
#endif
