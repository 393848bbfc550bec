/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* Inverse kinematics, shared by its files: rotations of joints as quaternions (w, x, y, z), their
 * limits, and what is being solved. */
#ifndef BWI_SHAPE_REACH_H
#define BWI_SHAPE_REACH_H

#include "barwright/shape.h"

void bwi_quaternion_of(const double rotation[9], double q[4]);
void bwi_quaternion_rotation(const double q[4], double rotation[9]);
/* The turn by |turn| radians about turn, after q. */
void bwi_quaternion_turn(const double turn[3], double q[4]);

/* r = swing twist: the twist turns about the bone's rest direction, the swing carries that
 * direction to where r does, along the shortest arc. Both in radians, twist in [-pi, pi]. */
void bwi_swing_twist(const double q[4], const double direction[3], double *swing, double *twist);
/* The nearest within the limits, swing and twist each by itself; true when something changed. */
bool bwi_limit_rotation(const bw_joint_limit *limit, const double direction[3], double q[4]);

/* How far a small turn may go: its part along each axis (unit vectors at right angles to each
 * other, in the directions q is given in) from low to high. */
typedef struct bwi_bars {
  int count;
  double axis[3][3];
  double low[3], high[3];
} bwi_bars;
void bwi_limit_bars(const bw_joint_limit *limit, const double direction[3], const double q[4],
                    bwi_bars *bars);

/* What is being solved. Lengths are in units of the skeleton's size; the bones of the chains are
 * numbered by slots, parents first. */
typedef struct bwi_reach {
  bw_context *context;
  const bw_skeleton *skeleton;
  const bw_joint_limit *limit; /* per bone, or NULL */
  int count;
  const bw_reach_target *target;
  double size, tolerance;
  int32_t slots;
  int32_t *bone_of_slot, *slot_of_bone; /* -1: does not turn */
  uint8_t *in_chain;                    /* count x slots */
  double *direction;                    /* slots x 3: rest directions of the bones */
  bwi_bars *bars;                       /* slots, in world directions */
  int8_t *barred;                       /* slots x 3: 1 at the high end, -1 at the low one */
  bw_bone_pose *pose, *trial;           /* bone_count */
  double *turn, *trial_turn;            /* slots x 4: quaternions of pose, trial */
  double *map, *rotation;               /* of the pose evaluated last */
  double *trial_map, *trial_rotation;
  double *gradient, *hessian, *matrix, *step, *fixed; /* 3 slots (squared) */
} bwi_reach;

/* Descends from r->pose: the best pose found, the largest distance left, iterations added. */
bw_status bwi_reach_descend(bwi_reach *r, bw_bone_pose *best, double *distance, int *iterations);
/* What the limits leave of a turn at the present pose. */
void bwi_reach_find_bars(const bwi_reach *r);
/* The step for r->gradient and r->hessian, within the bars; false when the matrix with the damping
 * is not positive definite. */
bool bwi_reach_step(const bwi_reach *r, double damping);
bool bwi_reach_is_minimum(const bwi_reach *r, double damping); /* with what is barred now */

#endif
