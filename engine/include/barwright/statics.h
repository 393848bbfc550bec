/* statics: static solutions of a model. */
#ifndef BARWRIGHT_STATICS_H
#define BARWRIGHT_STATICS_H

#include "barwright/linear.h"

#ifdef __cplusplus
extern "C" {
#endif

/* What a bond transmits to its side a (side b has the opposite), or an attachment to the body. */
typedef struct bw_joint_force {
  double force[3];   /* (N) */
  double moment[3];  /* (N m) about the origin */
  bool preloaded;    /* a bond with a preload or a shortening */
  double preload;    /* (N) that pulls the sides of a bond with a preload together; else 0 */
  double shortening; /* (m) of such a bond; else 0 */
} bw_joint_force;

/* What a coupling does. Components are those of translations, then of rotations, along the axes;
 * moments are about the remote point. */
typedef struct bw_coupling_result {
  double displacement[6]; /* (m, rad) of the remote point */
  double load[6];         /* (N, N m) that it exerts on the body */
  double reaction[6];     /* (N, N m) that holds the point where it has prescribed values; else 0 */
} bw_coupling_result;

/* A static solution. */
typedef struct bw_static {
  bw_object object;
  const bw_model *model;               /* retained */
  uint64_t revision;                   /* of the model when it was solved */
  bw_system *system;                   /* retained; NULL: of an edit session */
  const bw_cyclic *cyclic;             /* retained, of a sector; NULL: of the whole */
  double *displacement;                /* (m, node_count x 3) */
  double *force;                       /* (N, node_count x 3) applied */
  double *reaction;                    /* (N, node_count x 3) K u - f at prescribed components, 0
                                          elsewhere */
  int bond_count;                      /* of the model's bonds */
  bw_joint_force *bond;                /* bond_count, or NULL */
  int attachment_count;                /* of the model's masses and springs */
  bw_joint_force *attachment;          /* attachment_count, or NULL: a spring's force, a mass's
                                          weight (which `force` contains) */
  int coupling_count;                  /* of the model's couplings */
  bw_coupling_result *coupling;        /* coupling_count, or NULL; `force` is without their loads */
  double *joint_force;                 /* (N, node_count x 3) of bonds at the nodes that follow, of
                                          rigid couplings at theirs, 0 elsewhere; NULL without */
  double energy;                       /* (J) strain energy */
  double residual;                     /* (-) |K u - f| at unknowns over |f| */
  bool in_contact;                     /* forces of contact are among the loads */
  struct bw_external_report *external; /* of an external solver, or NULL */
  bw_solver_report report;             /* how it was found */
} bw_static;
/* How a static solution is to be found. */
typedef struct bw_statics_options {
  bool
      inertia_relief; /* balance a load on a free body by inertia instead of refusing; default no */
  double tolerance;   /* (-) a load is balanced when its part along rigid-body modes is below this
                       fraction of its size; default 1e-6, > 0 */
  const bw_solver *solver; /* of bw_statics alone, like what follows; borrowed; default NULL: chosen
                              by counted cost */
  double memory; /* (bytes) that a factor may take, 0 or more; default 0: bw_available_memory */
  const char *output; /* path of a .pvtu file, of solvers over several processes: each writes a
                         piece of the solution and its stresses; borrowed; default NULL: none */
} bw_statics_options;
/* The static solution of a model. `options` may be NULL. BW_UNCONSTRAINED names the unconstrained
 * rigid-body modes when the load is not balanced against them; BW_SINGULAR when the stiffness is
 * not positive definite, the solution is not finite, or its residual is above a tenth of the load
 * and above the tolerance; BW_INVALID when no load reaches the body (bw_model_check_absorbed).
 * `system` may be NULL or the system of an earlier solve (reused when mesh, material and supports
 * are the same; it may gain a factor, which then takes the place of PCG).
 *
 * Without a solver, a static solution is by a factor where there is one already, or where that
 * counts as cheap (less than one second of the reference machine), or where PCG would cost more
 * than half as much. Else it is by PCG, with the two-level preconditioner on quadratic elements and
 * multigrid on linear ones, and also where the factor would take more than four gigabytes or more
 * than `memory`. Costs are operations and bytes, counted, over the rates of one fixed machine, so
 * that the choice is the same everywhere. The costs of solutions by PCG are added up: when the next
 * one would make their sum more than the factor, that is made. Where iterating does not converge, a
 * factor takes its place, and a warning says so; BW_CONVERGENCE where there is no memory for one,
 * or the solver is given.
 *
 * Solvers of the backend BW_BACKEND_PETSC work on all processes: BW_UNSUPPORTED when none is
 * registered, BW_CONVERGENCE when the residual, computed with the engine's own K, is above the
 * tolerance, and the solver's own statuses; result->system is NULL. With `output` BW_UNSUPPORTED
 * where temperatures act, and the statuses of bw_mesh_write and bw_pvtu_piece_path. */
BW_API bw_status bw_statics(bw_context *context, const bw_model *model, bw_system *system,
                            const bw_statics_options *options, bw_static **result);

#ifdef __cplusplus
}
#endif
#endif
