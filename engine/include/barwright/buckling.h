/* buckling: the load factors at which a static solution becomes unstable. */
#ifndef BARWRIGHT_BUCKLING_H
#define BARWRIGHT_BUCKLING_H

#include "barwright/eigen.h"
#include "barwright/statics.h"

#ifdef __cplusplus
extern "C" {
#endif

/* Initial-stress stiffness K_sigma of the stress that `displacement` (m, node_count x 3) and the
 * model's temperatures cause: values (N/m, block_count), each times the 3x3 identity. The
 * quadrature is that of the stiffness. `pattern`: of the model's mesh. BW_INVALID where the
 * displacement causes no stress beyond its rounding, BW_GEOMETRY for an inverted element. */
BW_API bw_status bw_stress_stiffness(bw_context *context, const bw_block_pattern *pattern,
                                     const bw_model *model, const double *displacement,
                                     double *values);

/* Which load factors are wanted. */
typedef enum bw_buckling_sign {
  BW_BUCKLING_EITHER,   /* the nearest to zero */
  BW_BUCKLING_POSITIVE, /* of the load as it is */
  BW_BUCKLING_NEGATIVE  /* of the reversed load */
} bw_buckling_sign;
/* How load factors are found. */
typedef struct bw_buckling_options {
  int count;                    /* load factors wanted; default 4, 1 to 500 */
  bw_buckling_sign sign;        /* default BW_BUCKLING_EITHER */
  double tolerance;             /* (-) as in bw_modes_options; default 1e-8, above 0 and below 1 */
  bool sturm;                   /* count the load factors from indefinite factors; default true */
  uint64_t seed;                /* of the start vectors; default 1 */
  const bw_eigensolver *solver; /* borrowed; default NULL: automatic. SLEPc does not serve */
} bw_buckling_options;
BW_API void bw_buckling_options_default(bw_buckling_options *options);

/* Load factors and buckling shapes. */
typedef struct bw_buckling {
  bw_object object;
  const bw_model *model; /* retained */
  int count;             /* fewer than wanted where the search ended before */
  double *factor;        /* (-, count) ascending by size; of one size, the positive one first */
  double *error;         /* (-, count) an exact factor of this mesh lies within this distance */
  double *shape;   /* (m, count x node_count x 3) the largest displacement of a node is 1 m; the
                      largest component is positive */
  bool counted;    /* a Sturm count confirmed that none of a size below `searched` is missing */
  double searched; /* (-) to this size the wanted factors were searched for */
  int solves;      /* right-hand sides solved for, those of products with the inverse too */
  int recovered;   /* pairs found only after the Sturm count showed that they were missing */
  bw_solver_report report; /* how they were found */
} bw_buckling;
/* The load factors lambda of smallest size, and their shapes, (K + lambda K_sigma) phi = 0, with
 * K_sigma of the solution's stress, by the squares of the factors (docs/theory/stability.md). All
 * loads, temperatures and prescribed displacements of the model grow by the factor. Loads keep
 * their directions. `options` may be NULL. BW_UNCONSTRAINED for a body that supports leave free to
 * move, BW_UNSUPPORTED for a joined model (bw_model_joined) and a solution without equations in
 * this process (of an external solver or an edit session) and for SLEPc, BW_INVALID where the load
 * causes no stress, BW_LIMIT for too many load factors; those of bw_system_factor and
 * bw_modes_elastic. */
BW_API bw_status bw_buckling_of_static(bw_context *context, const bw_static *solution,
                                       const bw_buckling_options *options, bw_buckling **buckling);
/* By how much every factor is too large in size on this mesh, relative (-, buckling->count) to it,
 * by the recovered stress of its shape, as bw_modes_error. The error of the stress that K_sigma is
 * made of is not in it. */
BW_API bw_status bw_buckling_error(bw_context *context, const bw_buckling *buckling,
                                   double *relative);

#ifdef __cplusplus
}
#endif
#endif
