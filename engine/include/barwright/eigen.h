/* eigen: the lowest modes of a body. */
#ifndef BARWRIGHT_EIGEN_H
#define BARWRIGHT_EIGEN_H

#include "barwright/linear.h"

#ifdef __cplusplus
extern "C" {
#endif

/* How modes are found. */
typedef struct bw_modes_options {
  int count;        /* modes wanted; default 15, 1 or more */
  double tolerance; /* (-) relative residual; default 1e-8, above 0 and below 1 */
  bool sturm;    /* count eigenvalues below the last one from an indefinite factor; default true */
  uint64_t seed; /* of the start vector; default 1 */
} bw_modes_options;
BW_API void bw_modes_options_default(bw_modes_options *options);

/* Modes of a body. */
typedef struct bw_modes {
  bw_object object;
  const bw_mesh *mesh;         /* retained */
  const bw_material *material; /* retained; NULL for Laplacian modes */
  int count;
  int components;     /* 3: elastic modes; 1: Laplacian modes */
  int rigid_count;    /* rigid-body modes recognised and left out */
  double *eigenvalue; /* ((rad/s)^2, count) ascending; for the Laplacian 1/m2 */
  double *frequency;  /* (Hz, count) NULL for Laplacian modes and where the density is not known */
  double *shape; /* (any, count x node_count x components) mass-normalised (M-norm 1); sign fixed:
                    the largest component is positive */
  double *residual; /* (-, count) |K u - lambda M u| / |lambda M u|; rounding of K u alone shows in
                       very thin shapes, where the eigenvalue is far more exact than this */
  int solves;       /* right-hand sides solved for, in blocks of eight */
  int recovered;    /* modes found only after the Sturm count showed that they were missing */
  bool counted;     /* the Sturm count confirmed that none is missing */
  struct bw_external_report *external; /* of an external solver, or NULL */
} bw_modes;
/* The lowest elastic modes K u = lambda M u (consistent mass) by block Lanczos on the inverse, with
 * the system's own factor; unconstrained rigid-body modes are projected out exactly. Fewer than
 * wanted where the body has fewer. BW_CONVERGENCE where the iteration does not reach the
 * tolerance, BW_LIMIT for too many modes. `options` may be NULL. */
BW_API bw_status bw_modes_elastic(bw_context *context, bw_system *system,
                                  const bw_modes_options *options, bw_modes **modes);
/* The lowest nonconstant modes of the scalar Laplacian on the mesh (free boundary), section 4 of
 * worst-case. `pattern`: of the mesh. BW_SINGULAR where its factor fails, BW_GEOMETRY for an
 * inverted element, and as bw_modes_elastic. */
BW_API bw_status bw_modes_laplacian(bw_context *context, const bw_mesh *mesh,
                                    const bw_block_pattern *pattern,
                                    const bw_modes_options *options, bw_modes **modes);

#ifdef __cplusplus
}
#endif
#endif
