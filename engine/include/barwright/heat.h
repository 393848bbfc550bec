/* heat: conduction in tetrahedral meshes, steady and in time (docs/theory/heat.md). */
#ifndef BARWRIGHT_HEAT_H
#define BARWRIGHT_HEAT_H

#include "barwright/linear.h"

#ifdef __cplusplus
extern "C" {
#endif

/* What a condition of heat is. */
typedef enum bw_heat_kind {
  BW_HEAT_TEMPERATURE, /* a prescribed temperature: value (K) */
  BW_HEAT_FLUX,        /* a flux into the body: value (W/m2) */
  BW_HEAT_POWER,       /* a total power, spread evenly over area or volume: value (W) */
  BW_HEAT_SOURCE,      /* a source in the whole body: value (W/m3) */
  BW_HEAT_CONVECTION,  /* a flux coefficient (value - T) into the body: value (K) of the ambient */
  BW_HEAT_RADIATION,   /* a flux emissivity sigma (value^4 - T^4): value (K) of what is around, from
                          absolute zero, as all temperatures of such a body */
  BW_HEAT_CONTACT, /* a flux coefficient (T' - T) from the surface `with` at the same place, where
                      it is T': no value */
  BW_HEAT_BOND     /* the same temperature as the surface `with` at the same place has: no value */
} bw_heat_kind;
/* The constant of Stefan and Boltzmann (W/(m2 K4)), exact by the SI of 2019. */
#define BW_STEFAN_BOLTZMANN 5.670374419e-8

/* A condition of heat. */
typedef struct bw_heat_condition {
  bw_heat_kind kind;        /* by which the others are read */
  const bw_selection *on;   /* retained; NULL, the whole volume, of a source or power */
  double value;             /* (any) in the unit of the kind */
  const bw_selection *with; /* of contact and bonds, retained: a surface without a node of `on`,
                               whose facets lie on those of `on`; nodes need not match. Of a bond
                               the side that is followed */
  double coefficient; /* (W/(m2 K)) of convection, 0 or more; of contact its conductance, above 0;
                         (-) the emissivity, 0 to 1 */
  double about;       /* (K) radiation is linearised about it; default 0: it is not */
  const bw_array *nodal; /* node_count x 1 (-), a copy: by which the value of a temperature or a
                            source is multiplied at each node; or NULL: 1 */
  double size; /* (m2) of the selection, of its part in contact or bonded, or (m3) of the volume;
                  set when it is added */
  double gap;  /* (m) between facets that contact or a bond joins, 0 or more; default 0: up to a
                  twentieth of the mean edge */
  bw_sparse_matrix *joint; /* (m2, node_count x node_count) of contact: the integral of the square
                              of the jump; set when it is added, lives as long as the body */
  bw_bond *bond;           /* of a bond; set when it is added, lives as long as the body */
} bw_heat_condition;

/* A mesh with a material and conditions of heat. Mutable: its object's revision grows with each
 * condition. Where nothing is given no heat passes. */
typedef struct bw_heat {
  bw_object object;
  const bw_mesh *mesh;         /* retained */
  const bw_material *material; /* retained */
  int condition_count;
  bw_heat_condition *condition; /* condition_count of them */
} bw_heat;
/* A body without conditions. BW_INVALID for a material without conductivity, or one rotated by
 * element for another mesh, BW_GEOMETRY where bodies overlap as for bw_model_create. */
BW_API bw_status bw_heat_create(bw_context *context, const bw_mesh *mesh,
                                const bw_material *material, bw_heat **heat);
/* Adds a condition. Where several prescribe the temperature of a node, the last one counts.
 * BW_INVALID for numbers outside their ranges, for a node on both sides of contact or a bond, for a
 * conductance of contact above 1e9 conductivities over the length of a facet, and for a node that
 * follows others in two bonds, or follows nodes that follow others; BW_EMPTY for a selection
 * without a facet, but for a temperature on a node set; BW_GEOMETRY for facets without area, for
 * surfaces that do not touch, and for facets of `on` that `with` hardly covers in a bond. */
BW_API bw_status bw_heat_add(bw_context *context, bw_heat *heat,
                             const bw_heat_condition *condition);
/* Gives condition `index` another value (any). BW_INVALID for one that is not finite,
 * and for contact and bonds. */
BW_API bw_status bw_heat_set_value(bw_context *context, bw_heat *heat, int index, double value);

/* How the equations are solved. */
typedef struct bw_heat_options {
  const bw_solver *solver; /* BW_SOLVER_CHOLESKY; BW_SOLVER_PCG with BW_SOLVER_TWO_LEVEL (tet10) or
                              _JACOBI; default NULL: a factor up to 100,000 unknowns, else PCG */
  double tolerance;   /* (-) change of the temperature in an iteration over the largest temperature,
                         at which radiation and conductivity by temperature are done; above 0 and
                         below 1; default 1e-10 */
  int max_iterations; /* (count) of these iterations, 1 or more; default 100 */
  const double *guess; /* (K, node_count) where they begin; default NULL */
  bool error; /* of a steady state: estimate the error of the highest temperature, by one more
                 solution of the linear system; default false */
} bw_heat_options;
/* The defaults. */
BW_API void bw_heat_options_default(bw_heat_options *options);

/* A field of temperatures. It does not change. */
typedef struct bw_heat_solution {
  bw_object object;
  const bw_mesh *mesh;         /* retained */
  const bw_material *material; /* retained */
  double time;                 /* (s) 0 of a steady one */
  double *temperature;         /* (K, node_count) */
  double *reaction; /* (W, node_count) heat into the body where temperatures are prescribed */
  int condition_count;
  double *heat_in;  /* (W, condition_count) into the body by each condition; by contact and bonds
                       from `with` to `on`, which the balance leaves out */
  double stored;    /* (W) that the body takes up; 0 of a steady one */
  double imbalance; /* (W) what goes in, less what is stored */
  double
      throughput; /* (W) the sum of all that goes in, by nodes where temperatures are prescribed */
  double highest; /* (K) the highest temperature at a node */
  int32_t highest_node; /* (index) where it is */
  double highest_error; /* (K) estimate of its error; below 0: not estimated */
  int iterations;       /* of radiation and conductivity; 1 of a linear problem */
  double change;        /* (-) the last one, as bw_heat_options.tolerance; 0 of a linear problem */
  bw_solver_report report; /* of the linear systems */
} bw_heat_solution;
/* The steady state. BW_UNCONSTRAINED where a body has neither a prescribed temperature nor
 * convection nor radiation nor contact or a bond with a body that has one; BW_CONVERGENCE where the
 * iterations do not reach their tolerance; BW_UNSUPPORTED for a solver that does not serve,
 * BW_INVALID for temperatures below absolute zero with radiation, BW_GEOMETRY for an inverted
 * element; those of bw_linear_solve. `options` may be NULL. */
BW_API bw_status bw_heat_steady(bw_context *context, const bw_heat *heat,
                                const bw_heat_options *options, bw_heat_solution **solution);

/* Flux at nodes by averages over the elements around each, flux (W/m2, node_count x 3). Averages
 * are over elements of one material: on an interface a node has the larger flux of its sides. */
BW_API bw_status bw_heat_flux(bw_context *context, const bw_heat_solution *solution, double *flux);
/* The mean flux of every element: flux (W/m2, element_count x 3). */
BW_API bw_status bw_heat_element_flux(bw_context *context, const bw_heat_solution *solution,
                                      double *flux);
/* The error estimate of Zienkiewicz and Zhu (1987) of the flux: its square in each element, element
 * (W K, element_count), which may be NULL, and *relative (-) to the norm of the whole. */
BW_API bw_status bw_heat_error(bw_context *context, const bw_heat_solution *solution,
                               double *element, double *relative);

/* How time is stepped. */
typedef enum bw_heat_scheme {
  BW_HEAT_EULER,          /* backward Euler: of first order, and never oscillates in time */
  BW_HEAT_CRANK_NICOLSON, /* of second order; the first two steps are by backward Euler (Rannacher
                             1984) */
  BW_HEAT_BDF2            /* of second order, damps; the first step is by backward Euler */
} bw_heat_scheme;
/* How heat spreads in time. */
typedef struct bw_heat_transient_options {
  bw_heat_scheme scheme; /* default BW_HEAT_EULER */
  bool lumped;           /* capacity at nodes, for tet4 only; default false: consistent */
  bw_heat_options steps; /* of each step; its guess is not used */
} bw_heat_transient_options;
/* A body whose temperature changes. Mutable. */
typedef struct bw_heat_transient {
  bw_object object;
  const bw_heat *heat;         /* retained; its values may change between steps */
  const bw_heat_solution *now; /* retained: the present state */
  int64_t steps;               /* that were taken */
  double error; /* (K) estimate of the error of the last step alone, the largest at a node; 0 where
                   there is none yet */
  struct bwi_heat_transient *inner;
} bw_heat_transient;
/* A body at time 0 with temperatures `initial` (K, node_count); prescribed ones apply from the
 * start. `options` may be NULL. BW_INVALID for a material without density or heat capacity, and for
 * a lumped capacity of tet10; BW_UNSUPPORTED as bw_heat_steady, and for steps with `error`. */
BW_API bw_status bw_heat_transient_create(bw_context *context, const bw_heat *heat,
                                          const double *initial,
                                          const bw_heat_transient_options *options,
                                          bw_heat_transient **transient);
/* A step of `step` (s) to where the conditions have the values that they have now. With `limit` (K)
 * above 0, a step whose error is larger is not taken: *taken is false then, and nothing changes but
 * `error`. `taken` may be NULL. BW_INVALID where conditions were added since; those of
 * bw_heat_steady. */
BW_API bw_status bw_heat_transient_step(bw_context *context, bw_heat_transient *transient,
                                        double step, double limit, bool *taken);

#ifdef __cplusplus
}
#endif
#endif
