/* flow: incompressible flow and heat in the plane on triangle meshes that follow an outline
 * (responsive, section 4): Galerkin with SUPG and PSPG stabilisation (Tezduyar et al. 1992). */
#ifndef BARWRIGHT_FLOW_H
#define BARWRIGHT_FLOW_H

#include "barwright/responsive.h"

#ifdef __cplusplus
extern "C" {
#endif

typedef struct bw_flow_description {
  double density, viscosity; /* kg/m3, Pa s (dynamic) */
  /* with heat (eqs. 6 to 8); diffusivity 0: none */
  double diffusivity; /* alpha, m2/s */
  double expansion;   /* beta, 1/K */
  double reference;   /* T0, K */
  double gravity[2];
  /* BW_PRESCRIBED: components 0, 1 velocity, 2 pressure, 3 temperature; outflow without tractions
     where nothing is prescribed. Without a prescribed pressure and without an outflow the mean
     pressure is 0. Heat: BW_TRACTION of component 3 is a flux into the fluid, BW_CONVECTION one of
     coefficient (value - T); where neither is and no temperature is prescribed, none passes. */
  int32_t condition_count;
  const bw_condition *condition;
} bw_flow_description;

typedef struct bw_flow_options {
  double step;      /* s; 0: steady */
  int bdf;          /* 1: implicit Euler, 2: second order (default; 1 in the first step and after a
                       reconstruction's carry-over) */
  int iterations;   /* of Picard/Newton per step; default 1 for time steps (velocity extrapolated),
                       30 for steady */
  double tolerance; /* relative change of the solution at which a steady or iterated step is done;
                       default 1e-8 */
  bool ale; /* nodes that moved since the last step carry a mesh velocity; default false: the
               shape is changed between steps, as in the paper */
  bw_lagged_factor_options linear; /* default tolerance 1e-6 */
} bw_flow_options;
BW_API void bw_flow_options_default(bw_flow_options *options);

/* A fluid on a mesh that follows an outline. Mutable. */
typedef struct bw_flow {
  bw_object object;
  int components; /* 3, or 4 with heat: velocity x, y, pressure, temperature */
  /* Of the state that stands; they live until the next operation that succeeds. */
  const bw_plane_mesh *mesh; /* order 1 */
  const double *state;       /* node_count x components */
  const double *before;      /* of the step before */
  double time;
  struct bwi_flow *inner;
} bw_flow;
BW_API bw_status bw_flow_create(bw_context *context, const bw_plane_mesh *mesh,
                                const bw_flow_description *description, bw_flow **flow);
BW_API bw_status bw_flow_follow(bw_context *context, bw_flow *flow, const bw_plane_mesh *mesh,
                                bw_plane_reuse *kept);
/* One implicit time step, or the steady state. BW_CONVERGENCE leaves the state as it was. */
BW_API bw_status bw_flow_step(bw_context *context, bw_flow *flow, const bw_flow_options *options,
                              bw_plane_reuse *kept);
/* What a flow is at, an immutable object: bw_release gives it up. Keeping it copies nothing;
 * returning to it brings back mesh, fields, time and what the next step starts from bit for bit,
 * and fails only for the state of another flow. A flow's operations put a new state in the place of
 * the one that stands when all is done: those that fail change nothing. */
typedef struct bw_flow_state bw_flow_state;
BW_API const bw_flow_state *bw_flow_keep(const bw_flow *flow);
/* The mesh that it was kept on. */
BW_API const bw_plane_mesh *bw_flow_state_mesh(const bw_flow_state *state);
BW_API bw_status bw_flow_return(bw_context *context, bw_flow *flow, const bw_flow_state *state);
/* Whether its parts belong together: see bw_plane_mesh_check. */
BW_API bw_status bw_flow_check(bw_context *context, const bw_flow *flow);

/* Force of the fluid on the segments of a tag, per depth (N/m), as the reaction of the discrete
 * equations (the consistent one, twice the order of integrating stresses), and heat flow into the
 * fluid through them (W/m over density times heat capacity: K m2/s): reactions where temperatures
 * are prescribed, and what fluxes and convection bring. Functions of conditions are asked again. */
BW_API bw_status bw_flow_force(bw_context *context, const bw_flow *flow, int32_t tag,
                               double force[2]);
BW_API bw_status bw_flow_heat(bw_context *context, const bw_flow *flow, int32_t tag, double *heat);
/* Velocity, pressure (and temperature) at a place (`components` numbers). */
BW_API bw_status bw_flow_at(bw_context *context, const bw_flow *flow, const double at[2],
                            double *values);
/* Vorticity at the nodes, stream function (zero at the lowest node of the boundary). */
BW_API bw_status bw_flow_vorticity(bw_context *context, const bw_flow *flow, double *vorticity);

/* Frequency of a signal sampled at equal steps, by zero crossings about its mean over the last
 * `periods` whole periods; 0 where there is none. */
BW_API double bw_flow_frequency(int64_t count, const double *signal, double step, int periods);

#ifdef __cplusplus
}
#endif
#endif
