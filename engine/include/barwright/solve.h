/* solve: factorisation, static solutions, modes. */
#ifndef BARWRIGHT_SOLVE_H
#define BARWRIGHT_SOLVE_H

#include "barwright/assemble.h"

#ifdef __cplusplus
extern "C" {
#endif

typedef struct bw_solve_times {
  double graph, stiffness, order, factor, solve; /* seconds spent so far */
  int64_t factor_entries;                        /* of L */
  double factor_flops;
} bw_solve_times;

/* The equations of a body: stiffness, mass, numbering and the factor of the reduced stiffness. One
 * factor serves statics, modes, objectives and stresses. Immutable once made: solves may not run
 * on one system from two threads at once (the context is busy); a solve itself uses all threads. */
typedef struct bw_system bw_system;
struct bwi_factor;
struct bw_system {
  bw_object object;
  const bw_mesh *mesh;           /* retained */
  const bw_material *material;   /* retained */
  const bw_numbering *numbering; /* retained */
  bw_graph *graph;               /* retained */
  double *stiffness;             /* 9 per pair */
  double *mass; /* 1 per pair, times density (density 1 when the material has none) */
  double density;
  struct bwi_factor *factor;
  bw_solve_times times;
};
/* `previous` (may be NULL): a system of the same topology whose graph, ordering and analysis are
 * reused where they fit. BW_SINGULAR when a held body's matrix is not positive definite. */
bw_status bw_system_create(bw_context *context, const bw_mesh *mesh, const bw_material *material,
                           const bw_numbering *numbering, const bw_system *previous,
                           bw_system **system);
/* u = K^-1 f for homogeneous supports, `count` right-hand sides at once (node_count x 3 each, one
 * after the other; force and displacement may be the same block). Where rigid motions are free, the
 * force is first balanced by inertia (f - M r <r, f>; no change for a balanced force) and the
 * displacement made free of rigid motion (eq. 5 of worst-case): u = P K^+ P^T f, symmetric. */
bw_status bw_system_solve(bw_context *context, bw_system *system, int64_t count,
                          const double *force, double *displacement);

/* ---- statics --------------------------------------------------------------------------------- */

typedef struct bw_static {
  bw_object object;
  const bw_model *model; /* retained */
  bw_system *system;     /* retained */
  double *displacement;  /* node_count x 3 */
  double *force;         /* node_count x 3: applied */
  double *reaction;      /* node_count x 3: K u - f at held components, 0 elsewhere */
  double energy;         /* strain energy, J */
  double residual;       /* |K u - f| at unknowns over |f| */
} bw_static;
typedef struct bw_statics_options {
  bool
      inertia_relief; /* balance a load on a free body by inertia instead of refusing; default no */
  double tolerance;   /* a load is balanced when its part along free motions is below this fraction
                         of its size; default 1e-6 */
} bw_statics_options;
/* BW_FREE names the free rigid motions when the load is not balanced against them. `system` may be
 * NULL or the system of an earlier solve (reused when mesh, material and supports are the same). */
bw_status bw_statics(bw_context *context, const bw_model *model, bw_system *system,
                     const bw_statics_options *options, bw_static **result);

/* ---- modes --------------------------------------------------------------------------------- */

typedef struct bw_modes_options {
  int count;        /* elastic modes wanted; default 15 */
  double tolerance; /* relative residual; default 1e-8 */
  bool sturm;    /* count eigenvalues below the last one from an indefinite factor; default true */
  uint64_t seed; /* of the start vector */
} bw_modes_options;
void bw_modes_options_default(bw_modes_options *options);

typedef struct bw_modes {
  bw_object object;
  const bw_mesh *mesh; /* retained */
  int count;
  int components;     /* 3: elastic modes; 1: Laplacian modes */
  int rigid_count;    /* rigid motions recognised and left out */
  double *eigenvalue; /* (rad/s)^2, ascending; for the Laplacian 1/m2 */
  double *frequency;  /* Hz; NULL for Laplacian modes and where the density is not known */
  double *shape;      /* count x node_count x components, mass-normalised (M-norm 1); sign fixed:
                         the largest component is positive */
  double *residual;   /* |K u - lambda M u| / |lambda M u|; rounding of K u alone shows in very thin
                         shapes, where the eigenvalue is far more exact than this */
  int solves;         /* right-hand sides solved for, in blocks of eight */
  int recovered;      /* modes found only after the Sturm count called for them */
  bool counted;       /* the Sturm count confirmed that none is missing */
} bw_modes;
/* The lowest elastic modes K u = lambda M u (consistent mass) by block Lanczos on the inverse, with
 * the system's own factor; free rigid motions are projected out exactly. Fewer than asked for where
 * the body has fewer. */
bw_status bw_modes_elastic(bw_context *context, bw_system *system, const bw_modes_options *options,
                           bw_modes **modes);
/* The lowest nonconstant modes of the scalar Laplacian on the mesh (free boundary), section 4 of
 * worst-case. */
bw_status bw_modes_laplacian(bw_context *context, const bw_mesh *mesh, const bw_graph *graph,
                             const bw_modes_options *options, bw_modes **modes);

/* Name and version of the BLAS in use, the thread libraries, CHOLMOD, METIS, GLPK...: one line
 * each. A BLAS known to be slow here (OpenMP variant) is said. Release with bw_free. */
bw_status bw_library_versions(bw_context *context, char **text);

#ifdef __cplusplus
}
#endif
#endif
