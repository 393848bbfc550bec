/* finite: geometrically nonlinear statics of tetrahedra, at finite displacements and rotations. */
#ifndef BARWRIGHT_FINITE_H
#define BARWRIGHT_FINITE_H

#include "barwright/analysis.h"
#include "barwright/statics.h"

#ifdef __cplusplus
extern "C" {
#endif

/* Internal forces of a deformed state: force (N, node_count x 3), the derivative of the strain
 * energy by the displacement (m, node_count x 3), with temperatures times `factor` (-). *energy
 * (J): with temperatures without the part that does not depend on the displacement. tangent (N/m,
 * block_count x 9) of the `pattern` of the model's mesh, or NULL: the derivative of the forces.
 * St. Venant-Kirchhoff law (docs/theory/finite.md). BW_GEOMETRY for an element that is inverted
 * where it is not deformed, or by the displacement. */
BW_API bw_status bw_finite_forces(bw_context *context, const bw_model *model,
                                  const bw_block_pattern *pattern, const double *displacement,
                                  double factor, double *energy, double *force, double *tangent);
/* Cauchy stress of a deformed state, as bw_nodal_stress averages it: stress (Pa, node_count x 6)
 * with on_nodes, else the mean of each element by its deformed volume (element_count x 6). The
 * displacement (m, node_count x 3) and `factor` (-) as above. BW_GEOMETRY as above. */
BW_API bw_status bw_finite_stress(bw_context *context, const bw_model *model,
                                  const double *displacement, double factor, bool on_nodes,
                                  double *stress);

/* How geometrically nonlinear statics go. */
typedef struct bw_nonlinear_options {
  double factor;   /* (-) load factor at which it ends; default 1, above 0 */
  int steps;       /* (count) a step changes the load factor by at most factor / steps;
                      default 10, 1 to 100000 */
  bool arc_length; /* passes limit points: the length of a step of displacements is given, not
                      its load; default false */
  int max_steps;   /* (count) it ends after so many; default 500, 1 to 100000 */
  double
      displacement; /* (m) it ends where a node has moved farther, 0 or more; default 0: no limit */
  double tolerance; /* (-) residual over load and reactions; default 1e-8, above 0 and below 1 */
  int max_iterations; /* (count) of Newton's method in a step, before it is cut; default 20, 2 to
                         1000 */
  int monitor_count;  /* (count) of nodes; default 0: the one that moves most at first */
  const int32_t *monitor; /* (index, monitor_count) nodes whose displacements are kept; borrowed */
} bw_nonlinear_options;
BW_API void bw_nonlinear_options_default(bw_nonlinear_options *options);

/* Why it ended. */
typedef enum bw_nonlinear_end {
  BW_NONLINEAR_FACTOR,       /* at the load factor that was asked for */
  BW_NONLINEAR_DISPLACEMENT, /* a node has moved as far as it may */
  BW_NONLINEAR_STEPS         /* after the largest number of steps */
} bw_nonlinear_end;
/* A state in equilibrium on the way. */
typedef struct bw_nonlinear_step {
  double factor;       /* (-) load factor */
  double residual;     /* (-) over load and reactions */
  double energy;       /* (J) strain energy, as bw_finite_forces has it */
  double displacement; /* (m) the largest of a node */
  double strain;       /* (-) the largest size of the Green-Lagrange strain in an element */
  int iterations;      /* (count) of Newton's method, those of steps that were cut too */
  int cuts;            /* (count) how often the step was cut */
  int32_t negative;    /* (count) negative pivots of the tangent: directions in which it is
                          unstable */
  bool counted;        /* no pivot was so small that rounding chose its sign */
} bw_nonlinear_step;
/* Geometrically nonlinear statics: the steps and the last state. */
typedef struct bw_nonlinear {
  bw_object object;
  const bw_model *model;   /* retained */
  bw_nonlinear_end end;    /* why it ended */
  int count;               /* of steps */
  bw_nonlinear_step *step; /* count steps */
  int monitor_count;       /* of nodes */
  int32_t *monitor;        /* (index, monitor_count) nodes */
  double *monitored;       /* (m, count x monitor_count x 3) their displacements, step by step */
  double *displacement;    /* (m, node_count x 3) of the last state */
  double *reaction;        /* (N, node_count x 3) of the last state at prescribed components */
  double *force;           /* (N, node_count x 3) that is applied at load factor 1 */
  bw_solver_report report; /* how it was found */
} bw_nonlinear;
/* Equilibrium under the model's loads, temperatures and prescribed displacements, all times a load
 * factor that grows from 0: large displacements and rotations, small strains. Loads keep their
 * directions and sizes, pressures too. Newton's method with a step that is cut where it does not
 * converge; with arc_length by Crisfield's method (Computers & Structures 13, 1981) on the
 * displacements of all unknowns. `options` may be NULL. BW_CONVERGENCE says at which load factor no
 * state was found, and where the residual is largest; BW_UNSUPPORTED for a joined model,
 * BW_UNCONSTRAINED for a body that supports leave free to move, BW_INVALID for options outside
 * their ranges and where nothing acts, BW_SINGULAR where the stiffness at the beginning, or the
 * tangent at a state, is singular, BW_GEOMETRY for an element that is inverted before or by the
 * deformation, BW_MEMORY before any is allocated where the factor is larger than what is free. */
BW_API bw_status bw_nonlinear_statics(bw_context *context, const bw_model *model,
                                      const bw_nonlinear_options *options, bw_nonlinear **result);

#ifdef __cplusplus
}
#endif
#endif
