/* dynamics: how a linear body answers forces that change in time (docs/theory/dynamics.md). */
#ifndef BARWRIGHT_DYNAMICS_H
#define BARWRIGHT_DYNAMICS_H

#include "barwright/eigen.h"

#ifdef __cplusplus
extern "C" {
#endif

/* How a body loses energy as it vibrates. The parts add up. */
typedef struct bw_damping {
  double ratio;     /* (-) of the critical damping, the same in each mode; default 0, 0 to below 1 */
  double mass;      /* (1/s) a of C = a M + b K (Rayleigh); default 0, 0 or more */
  double stiffness; /* (s) b of C = a M + b K; default 0, 0 or more */
  double loss;      /* (-) loss factor h of the stiffness (1 + i h) K; default 0, 0 or more */
} bw_damping;

#ifdef __cplusplus
}
#endif
#endif
