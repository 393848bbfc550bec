/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* The motion of a body as a sum of its modes, with the static part of what they leave out. */
#ifndef BWI_DYNAMICS_TRANSIENT_MODES_H
#define BWI_DYNAMICS_TRANSIENT_MODES_H

#include "barwright/transient.h"
#include "dynamics/equations.h"

struct bwi_modal_motion;
/* The factor of load k of a model, and behind its loads of the load of a remote point. */
static inline double bwi_load_factor(const bw_transient_factors *f, int loads, int k) {
  const double *of = k < loads ? f->load : f->point;
  return of ? of[k < loads ? k : k - loads] : 1;
}
/* A field of a motion: displacement, velocity, acceleration, and d with M d the force of damping.
 */
typedef struct bwi_motion_fields {
  double *u, *v, *a, *d;
} bwi_motion_fields;

/* `load`: blocks of nodal forces, of the loads and the remote points of the model; `prescribed`:
 * the displacements that follow each of `motions` histories, NULL where they are 0. */
bw_status bwi_modal_motion_create(bw_context *context, const bw_model *model,
                                  const bwi_equations *equations,
                                  const bw_linear_transient_options *options, const double *load,
                                  int motions, double *const *prescribed,
                                  struct bwi_modal_motion **motion);
/* The state at the start, from the fields u and v of the options, with a warning where it is not
 * what they say. */
bw_status bwi_modal_motion_start(bw_context *context, struct bwi_modal_motion *motion,
                                 const bwi_equations *equations,
                                 const bw_linear_transient_options *options,
                                 const bw_transient_factors *now, const bwi_motion_fields *fields);
/* The fields at the end of a step; the motion itself goes there with bwi_modal_motion_accept. */
void bwi_modal_motion_step(struct bwi_modal_motion *motion, const bw_transient_factors *next,
                           const bwi_motion_fields *fields);
void bwi_modal_motion_accept(struct bwi_modal_motion *motion);
void bwi_modal_motion_destroy(struct bwi_modal_motion *motion);
size_t bwi_modal_motion_bytes(const struct bwi_modal_motion *motion);

#endif
