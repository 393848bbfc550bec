/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* Rotations of joints as quaternions (w, x, y, z), and their limits, for inverse kinematics. */
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

/* Turns that a joint at its limits must not make: unit vectors, at right angles to each other (in
 * the directions q is given in), with the sign of the parts along them that are barred (0: both).
 */
typedef struct bwi_bars {
  int count;
  double axis[3][3];
  int sign[3];
} bwi_bars;
void bwi_limit_bars(const bw_joint_limit *limit, const double direction[3], const double q[4],
                    bwi_bars *bars);

#endif
