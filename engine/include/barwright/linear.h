/* linear: the equations of a body, their factorisation and preconditioners. */
#ifndef BARWRIGHT_LINEAR_H
#define BARWRIGHT_LINEAR_H

#include "barwright/assemble.h"
#include "barwright/report.h"

#ifdef __cplusplus
extern "C" {
#endif

/* Where the time of a system went. */
typedef struct bw_solve_times {
  double pattern, stiffness, order, factor, pcg, solve; /* (s) spent so far */
  int64_t factor_entries;                               /* of L; 0 where there is no factor */
  double factor_flops;                                  /* (-) operations of the factorisation */
} bw_solve_times;

/* The equations of a body: stiffness, mass, DOF map and the factor of the reduced stiffness. One
 * factor serves statics, modes, objectives and stresses. Solves may not run on one system from two
 * threads at once (the context is busy); a solve itself uses all threads. The equations never
 * change; only how they are solved may. Those that bw_statics made for two-level PCG have no factor
 * and no mass until bw_system_factor is called, or a static solution finds that by now a factor
 * would have been cheaper. */
typedef struct bw_system bw_system;
struct bwi_factor;
struct bwi_two_level_solver;
struct bw_system {
  bw_object object;
  const bw_mesh *mesh;         /* retained */
  const bw_material *material; /* retained */
  const bw_dof_map *dof_map;   /* retained */
  bw_block_pattern *pattern;   /* retained */
  double *stiffness;           /* (N/m, block_count x 9) */
  double
      *mass; /* (kg, block_count) with density 1 when the material has none; NULL without factor */
  double density;
  struct bwi_factor *factor;              /* or NULL */
  struct bwi_two_level_solver *two_level; /* or NULL */
  bw_solve_times times;                   /* of all that was computed */
};
/* Assembles and factors. `previous` (may be NULL): a system of the same topology whose pattern,
 * ordering and analysis are reused where they fit. BW_SINGULAR when a constrained body's matrix is
 * not positive definite, BW_GEOMETRY for an inverted element, BW_LIMIT for a factor with too many
 * entries, BW_MEMORY as bw_system_factor. */
BW_API bw_status bw_system_create(bw_context *context, const bw_mesh *mesh,
                                  const bw_material *material, const bw_dof_map *dof_map,
                                  const bw_system *previous, bw_system **system);
/* The equations of a model, with mass and factor: `given` (may be NULL), retained, where its mesh,
 * material and supports are the model's; else new ones, with `given` as `previous`. Prescribed
 * values may differ: they act on right-hand sides alone. BW_SINGULAR as in bw_system_create. */
BW_API bw_status bw_system_of_model(bw_context *context, const bw_model *model, bw_system *given,
                                    bw_system **system);
/* Mass and factor, where the system has none yet: then it is one as bw_system_create makes it. On
 * failure it is as it was. BW_MEMORY, before any is allocated, where the factor is larger than what
 * is free (bw_available_memory); BW_SINGULAR and BW_LIMIT as bw_system_create. */
BW_API bw_status bw_system_factor(bw_context *context, bw_system *system);
/* u = K^-1 f for homogeneous supports, `count` right-hand sides at once: force (N, count x
 * node_count x 3), displacement (m, count x node_count x 3), which may be the same block. Changes
 * only the system's workspace. BW_INVALID for a system without a factor. Where rigid-body modes are
 * unconstrained, the force is first balanced by inertia (f - M r <r, f>; no change for a balanced
 * force) and the displacement made free of rigid-body motion (eq. 5 of worst-case): u = P K^+ P^T
 * f, symmetric. */
BW_API bw_status bw_system_solve(bw_context *context, bw_system *system, int64_t count,
                                 const double *force, double *displacement);

/* The edits to be expected, borrowed, by the subdomains that they touch: those of subdomain d are
 * edit[start[d]] to edit[start[d + 1] - 1], numbers from 0 to count - 1 (bones, mostly). */
typedef struct bw_edits {
  int32_t count;
  const int32_t *start; /* (index, subdomain_count + 1) */
  const int32_t *edit;  /* (index, start[subdomain_count]) */
} bw_edits;

/* A *text with name and version of the BLAS in use, the thread libraries, CHOLMOD, METIS, GLPK...:
 * one line each; it warns of a BLAS known to be slow here (OpenMP variant). Release it with
 * bw_free. */
BW_API bw_status bw_library_versions(bw_context *context, char **text);

#ifdef __cplusplus
}
#endif
#endif
