/* flow: incompressible flow and heat in the plane on triangle meshes that follow an outline
 * (responsive, section 4): Galerkin with SUPG and PSPG stabilisation (Tezduyar et al. 1992). */
#ifndef BARWRIGHT_FLOW_H
#define BARWRIGHT_FLOW_H

#include "barwright/responsive.h"

#ifdef __cplusplus
extern "C" {
#endif

/* A fluid and its conditions; bw_flow_create copies it with its conditions. */
typedef struct bw_flow_description {
  double density;     /* (kg/m3) > 0 */
  double viscosity;   /* (Pa s) dynamic, > 0 */
  double diffusivity; /* (m2/s) alpha of heat (eqs. 6 to 8); 0: no heat */
  double expansion;   /* (1/K) beta */
  double reference;   /* (K) T0, the temperature without buoyancy */
  double gravity[2];  /* (m/s2) */
  /* BW_PRESCRIBED: components 0, 1 velocity, 2 pressure, 3 temperature; outflow without tractions
     where nothing is prescribed. Without a prescribed pressure and without an outflow the mean
     pressure is 0. Heat: BW_TRACTION of component 3 is a flux into the fluid, BW_CONVECTION one of
     coefficient (value - T); where neither is and no temperature is prescribed, none passes. */
  int32_t condition_count;
  const bw_condition *condition; /* condition_count of them */
} bw_flow_description;

/* How a step is done. */
typedef struct bw_flow_options {
  double step;      /* (s) default 0: steady; 0 or more */
  int bdf;          /* 1: implicit Euler, or 2: second order (default; 1 in the first step and after
                       a reconstruction) */
  int iterations;   /* of Picard/Newton per step; default 1 for time steps (velocity extrapolated),
                       30 for steady, which 0 stands for; 0 or more */
  double tolerance; /* (-) relative change of the solution at which a steady or iterated step is
                     done; default 1e-8, > 0 */
  bool ale; /* nodes that moved since the last step carry a mesh velocity; default false: the
               shape is changed between steps, as in the paper */
  bw_lagged_factor_options linear; /* default tolerance 1e-6 */
} bw_flow_options;
BW_API void bw_flow_options_default(bw_flow_options *options);

/* A fluid on a mesh that follows an outline. Mutable. */
typedef struct bw_flow {
  bw_object object;
  int components; /* 3, or 4 with heat: velocity x, y, pressure, temperature */
  /* Of the present state; they live until the next operation that succeeds. */
  const bw_plane_mesh *mesh; /* order 1 */
  const double *state;       /* (any, node_count x components) m/s, m/s, Pa, K */
  const double *before;      /* (any, node_count x components) of the step before */
  double time;               /* (s) since its creation */
  struct bwi_flow *inner;
} bw_flow;
/* A flow at rest, at the reference temperature, on a mesh of order 1. BW_INVALID names a constant
 * or condition that does not fit, BW_LIMIT a mesh too large. */
BW_API bw_status bw_flow_create(bw_context *context, const bw_plane_mesh *mesh,
                                const bw_flow_description *description, bw_flow **flow);
/* Continues on another mesh of the same problem; velocity, pressure and temperature are
 * interpolated (bw_plane_transfer). What is reused is added to `reuse`, which may be NULL. */
BW_API bw_status bw_flow_follow(bw_context *context, bw_flow *flow, const bw_plane_mesh *mesh,
                                bw_plane_reuse *reuse);
/* One implicit time step, or the steady state. BW_CONVERGENCE where no steady state was found or
 * the equations were not solved, BW_SINGULAR where they have no solution, BW_GEOMETRY for an
 * inverted element; all leave the state as it was. `options` and `reuse` may be NULL. */
BW_API bw_status bw_flow_step(bw_context *context, bw_flow *flow, const bw_flow_options *options,
                              bw_plane_reuse *reuse);
/* The state of a flow, an immutable object. Returning to it restores mesh, fields, time and the
 * start of the next step bit for bit, and fails only for the state of another flow. The operations
 * of a flow replace its present state at their end: those that fail change nothing. */
typedef struct bw_flow_state bw_flow_state;
/* The state of a flow, one reference to be released. */
BW_API const bw_flow_state *bw_flow_keep(const bw_flow *flow);
/* Returns a flow to a state of its own. */
BW_API bw_status bw_flow_return(bw_context *context, bw_flow *flow, const bw_flow_state *state);
/* Checks its parts against each other. */
BW_API bw_status bw_flow_check(bw_context *context, const bw_flow *flow);

/* The force (N/m), per depth, of the fluid on the segments of a `tag` (-1: all), as the reaction of
 * the discrete equations: the consistent one, twice the order of integrating stresses. Functions of
 * conditions are called again. BW_INVALID before the first step on a mesh. */
BW_API bw_status bw_flow_force(bw_context *context, const bw_flow *flow, int32_t tag,
                               double force[2]);
/* The *heat (K m2/s) that flows into the fluid through the segments of a `tag` (-1: all), in W/m
 * over density times heat capacity: reactions where temperatures are prescribed, fluxes and
 * convection. As bw_flow_force. */
BW_API bw_status bw_flow_heat(bw_context *context, const bw_flow *flow, int32_t tag, double *heat);
/* Velocity, pressure (and temperature) at a place, or at the nearest one of the mesh: values (any,
 * components). */
BW_API bw_status bw_flow_at(bw_context *context, const bw_flow *flow, const double at[2],
                            double *values);
/* The vorticity at the nodes: vorticity (1/s, node_count). */
BW_API bw_status bw_flow_vorticity(bw_context *context, const bw_flow *flow, double *vorticity);

/* The frequency (Hz) of a signal (any, count) sampled at equal steps, step (s), by upward crossings
 * of its mean over the last `periods` whole periods; 0 where there is none. */
BW_API double bw_flow_frequency(int64_t count, const double *signal, double step, int periods);

#ifdef __cplusplus
}
#endif
#endif
