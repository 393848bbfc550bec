/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* Newton's method for one solid under one case: what its files share.
 *
 *   newton_state.c    energy, forces and residual at one load factor
 *   newton_tangent.c  the tangent, and solving with it
 *   newton_search.c   how far to go along a direction
 *   newton_saddle.c   leaving equilibria that are not stable
 *   newton_choice.c   a factor or conjugate gradients
 *   newton.c          equilibrium at one load factor
 *   statics.c         load steps, results, messages */
#ifndef BWI_NONLINEAR_NEWTON_H
#define BWI_NONLINEAR_NEWTON_H

#include "nonlinear/contact_plane.h"
#include "nonlinear/direct.h"
#include "nonlinear/load_case.h"
#include "nonlinear/precondition.h"

/* What solutions by conjugate gradients needed, those of solids with so many elements. */
typedef struct bwi_cg_statistics {
  int64_t elements;
  double solutions, iterations; /* with the guess that was there before */
  double taken;                 /* without it */
  double nepers;                /* by how many factors of e they brought residuals down */
} bwi_cg_statistics;

/* What is kept between solves. */
struct bw_newton {
  bw_object object;
  bwi_direct *direct;
  double *stiffness; /* 9 numbers for each of `block_count` */
  int64_t block_count;
  bw_solid_linear *linear; /* of linear_of (retained), or NULL */
  const bw_solid *linear_of;
  bwi_cg_statistics cg_statistics;
};

/* What may be added to the potential: 1/2 (u - centre) . Q (u - centre) + force . (u - centre),
 * Q = of_mass M + of_stiffness K. A step in time has one; nothing need be constrained then, and any
 * state without a residual is its solution. */
typedef struct bwi_quadratic {
  const double *centre, *force; /* node_count x 3 */
  double of_mass;               /* 1/s2 */
  double of_stiffness;
  const double *stiffness; /* K, 9 per block of the pattern, */
  const bw_solid_linear
      *linear;          /* or element by element where the Newton state is iterative; or NULL */
  double *workspace[2]; /* node_count x 3 */
} bwi_quadratic;

/* Energy and forces at displacements u. */
typedef struct bwi_energy_forces {
  double *u;
  double *internal; /* gradient of the energy of strain and of the quadratic term */
  double *load;     /* all else, contact planes included */
  double *contact;  /* of contact planes alone, or NULL */
  double energy;    /* of strain */
  double contact_energy, quadratic_energy;
  double quadratic_size; /* norm of the quadratic term's gradient */
  int64_t contacts;
  bw_solid_shape shape;
} bwi_energy_forces;

/* How the tangent is made definite. */
typedef enum bwi_tangent {
  BWI_PLAIN,     /* not at all */
  BWI_PROJECTED, /* point by point: negative eigenvalues become zero */
  BWI_SHIFTED    /* by adding to its diagonal, as little as will do */
} bwi_tangent;

/* How linear equations are solved, as a bw_solver says it. */
typedef struct bwi_newton_plan {
  bool iterative, two_level; /* by conjugate gradients; over coarse solids */
  bool by_cost;              /* only as long as that costs less than factors */
  double tolerance;          /* of conjugate gradients; 0: by Eisenstat and Walker */
  int max_iterations;
} bwi_newton_plan;

/* BW_INVALID for a solver that Newton's method does not take. `nodes` of the solid, `coarse_count`
 * coarse ones below it. */
bw_status bwi_newton_plan_make(bw_context *context, const bw_solver *solver, int coarse_count,
                               int32_t nodes, bwi_newton_plan *plan);

/* What there is to choose from: seconds of a machine by count (newton_choice.c). */
typedef struct bwi_choice {
  bool open;             /* or there is no choice */
  double factor;         /* a tangent factored and solved with; 0: not analysed yet */
  double set, iteration; /* the cycle for a tangent, an iteration with it */
} bwi_choice;

/* Why an equilibrium was not found. */
typedef enum bwi_obstacle {
  BWI_NO_OBSTACLE,
  BWI_ITERATIONS, /* as many as allowed in a load step */
  BWI_WORK,       /* or in all load steps */
  BWI_SEARCH,     /* no step along a direction lowers the potential */
  BWI_CREEPING,   /* one short step follows on another */
  BWI_INVERTING,  /* moving what is constrained would invert elements */
  BWI_UNSTABLE,   /* from one unstable equilibrium to the next */
  BWI_STIFFNESS,  /* no tangent to solve with: something is free to move */
  BWI_CRUSHED,    /* none with any shift: elements are badly out of shape */
  BWI_INVERTED    /* an equilibrium, with inverted elements */
} bwi_obstacle;
const char *bwi_obstacle_text(bwi_obstacle obstacle); /* "the iterations did not suffice" */

typedef struct bwi_newton_state {
  bw_context *context;
  const bw_solid *solid;
  const bw_load_case *load_case;
  bw_newton *newton;
  const bw_newton_options *options;
  bwi_newton_plan plan;     /* of options->solver */
  int64_t size;             /* 3 node_count */
  int64_t free;             /* components that are not constrained */
  double *dead;             /* dead loads at full */
  double *begin;            /* displacements at load factor 0, or NULL: rest */
  double *initial_residual; /* what is out of balance there under full loads, or NULL. Balanced at
                   load factor 0, it goes to zero: at load factor s, 1 - s of it is left */
  bool follows;             /* the case has follower pressures */
  double *follower;         /* 9 per block: what follower pressures add to the tangent, or NULL */
  bwi_contact *contact;     /* or NULL */
  const bwi_quadratic *quadratic; /* or NULL */
  double load;
  double reached; /* load factor of the last equilibrium, for progress */
  bwi_energy_forces now, trial;
  double *blocks;                      /* 9 per node: diagonal of the last tangent */
  double *residual, *direction, *work; /* size each */
  double reference,
      noise;       /* forces that residuals are taken relative to, and what rounding leaves */
  double elastic;  /* the tangent's diagonal times a cell's side squared, J: the energy of strains
                      of one */
  double relative; /* the residual now */
  bwi_tangent tangent; /* the last one */
  bool have_tangent;
  double step;            /* the last length along a direction */
  double projected_shift; /* that of projected tangents, which followers may need; or 0 */
  double shift; /* of the last shifted tangent that was definite, over the diagonal's mean; or 0 */
  bool iterative; /* solutions by conjugate gradients, without a matrix */
  bool negative;  /* the last of those met a direction of negative curvature */
  bwi_choice choice;
  bwi_precondition *precondition;
  bool stiffness_current; /* the stiffness kept is the plain one at now.u, without contact */
  double previous;        /* the residual one iteration before, for how exactly to solve */
  bool undecided;         /* whether the last equilibrium is stable was not found out */
  /* of a failed equilibrium */
  bwi_obstacle obstacle;
  double part; /* how much of the movement of what is constrained was possible; 0: not known */
  bw_newton_report *report;
  size_t history_capacity;
} bwi_newton_state;

/* BW_INVALID for a case of another grid and for options out of range, BW_UNCONSTRAINED where
 * nothing holds. */
bw_status bwi_newton_check(bw_context *context, const bw_solid *solid,
                           const bw_load_case *load_case, const bw_newton_options *options);
/* Room for a Newton state whose context, solid, case, newton, options and report are set; it begins
 * at rest, at load factor 0. The contact is not made. */
bw_status bwi_newton_state_create(bwi_newton_state *state);
/* What solved the linear equations, for the result. */
void bwi_newton_state_report(const bwi_newton_state *state, bw_solver_report *report);
void bwi_newton_state_clear(bwi_newton_state *state);

/* The quadratic term's energy at at->u; its gradient is added to at->internal (quadratic.c). */
bw_status bwi_quadratic_evaluate(bwi_newton_state *state, bwi_energy_forces *at);
/* Its second derivatives, added to the stiffness kept and to the Newton state's blocks. Of
 * iterative states bwi_solid_linear_add takes care. */
void bwi_quadratic_stiffness(bwi_newton_state *state);

bw_status bwi_energy_forces_create(bw_context *context, int64_t size, bool contact,
                                   bwi_energy_forces *at);
void bwi_energy_forces_clear(bwi_energy_forces *at);
/* Energy and forces at at->u under the load factor of the Newton state. Nothing but at->shape is to
 * be used where that says undefined, or where energy or forces are not finite. */
bw_status bwi_newton_state_balance(bwi_newton_state *state, bwi_energy_forces *at);
/* The trial becomes the state now, and the other way round. */
void bwi_newton_state_accept(bwi_newton_state *state);
/* Residual (0 where constrained), its size relative to the forces at work, and what those are. */
void bwi_newton_state_measure(bwi_newton_state *state);
static inline double bwi_newton_state_target(const bwi_newton_state *state, int64_t i) {
  double from = state->begin ? state->begin[i] : 0;
  return state->load >= 1 ? state->load_case->value[i]
                          : from + state->load * (state->load_case->value[i] - from);
}
double bwi_newton_state_dot(const bwi_newton_state *state, const double *a,
                            const double *b); /* free components */

/* What is left of the iterations that all load steps may take together, as a part of them and in
 * iterations of conjugate gradients. */
double bwi_newton_left(const bwi_newton_state *state, int64_t *of_cg);
/* Equilibrium at `load` from state->now.u, which is left where it ends. BW_OK with *found
 * false and state->obstacle where there is none to be found. */
bw_status bwi_newton_equilibrium(bwi_newton_state *state, double load, bool *found);

/* Node blocks of the plain stiffness at state->now.u to state->blocks. */
bw_status bwi_tangent_blocks(bwi_newton_state *state);
/* The tangent at state->now.u. *definite false: nothing to solve with; for kinds but
 * BWI_PLAIN that is a solid which can move freely, or numbers that are not finite. */
bw_status bwi_tangent_set(bwi_newton_state *state, bwi_tangent kind, bool *definite);
/* A shifted tangent that a solution without a matrix found not to be definite: more of a shift.
 * *stiffer false: there is none such, or no more to be had. */
bw_status bwi_tangent_stiffen(bwi_newton_state *state, bool *stiffer);
/* The same tangent for the points that will push after state->direction (contact_plane.h);
 * *changed false: they are those that it is for. */
bw_status bwi_tangent_predict_contact(bwi_newton_state *state, bool *changed, bool *definite);
/* y = K x with all components, followers left out where that is without a matrix. */
bw_status bwi_tangent_multiply(bwi_newton_state *state, const double *x, double *y);
/* K d = f for free components, to a relative tolerance where that is iterative; *iterations (may be
 * NULL) gets those. With follower pressures their derivative is a part of K. */
bw_status bwi_tangent_solve(bwi_newton_state *state, const double *force, double tolerance,
                            double *displacement, int32_t *iterations);

/* What the choice is about, where the options leave one; begins the statistics. */
void bwi_choice_begin(bwi_newton_state *state);
void bwi_choice_learn(bwi_newton_state *state, int32_t iterations, double residual);
int32_t bwi_choice_limit(const bwi_newton_state *state); /* iterations that a solution may take */
/* Whether a factor is cheaper: for a tangent to solve with, to see that it is definite. */
bw_status bwi_choice_factor(bwi_newton_state *state, bool *factor);
bw_status bwi_choice_factor_search(bwi_newton_state *state, bool *factor);

/* Go along state->direction, along which the potential falls by `slope` < 0 at first: Newton
 * state->now becomes a state that is lower, *step says how far; 0: none was found, and nothing
 * changed. */
bw_status bwi_newton_search(bwi_newton_state *state, double slope, double *step);
/* The largest part of d, up to 1, with which no neo-Hookean point (`all`: no point) loses its
 * volume. */
bw_status bwi_newton_cap(bw_context *context, const bw_solid *solid, const double *u,
                         const double *d, bool all, double *part);

/* At an equilibrium whose tangent is not positive definite: go to a state of lower potential.
 * *lower false: there is none, or, with *decided false too, the iterations allowed did not tell. */
bw_status bwi_newton_leave(bwi_newton_state *state, bool *lower, bool *decided);

#endif
