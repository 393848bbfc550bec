/* buckling: the load factors at which a static solution becomes unstable. */
#ifndef BARWRIGHT_BUCKLING_H
#define BARWRIGHT_BUCKLING_H

#include "barwright/analysis.h"
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

/* The derivative of x . K_sigma(u) y by u, for shapes x and y (m, node_count x 3), which may be the
 * same: nodal forces, gradient (N m, node_count x 3), overwritten. Without temperatures it is
 * linear: gradient . u = x . K_sigma(u) y. *work (J): x . K y. BW_GEOMETRY for an inverted
 * element; BW_INVALID for a material of another mesh. */
BW_API bw_status bw_stress_stiffness_gradient(bw_context *context, const bw_mesh *mesh,
                                              const bw_material *material, const double *x,
                                              const double *y, double *gradient, double *work);

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
  bool loads_turn;              /* the loads of a body that can move freely turn with its mean
                                   rotation; default false: such a body is refused */
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
 * move, unless its loads turn with it, BW_UNSUPPORTED for a joined model (bw_model_joined), a
 * solution in contact and a solution without equations in this process (of an external solver or an
 * edit session) and for SLEPc, BW_INVALID where the load causes no stress, BW_LIMIT for too many
 * load factors; those of bw_system_factor and bw_modes_elastic. */
BW_API bw_status bw_buckling_of_static(bw_context *context, const bw_static *solution,
                                       const bw_buckling_options *options, bw_buckling **buckling);
/* The same of a displacement (m, node_count x 3) of a system's equations, without temperatures. The
 * system gains a factor where it has none. BW_INVALID for equations of an edit session without a
 * factor; BW_UNCONSTRAINED and others as bw_buckling_of_static. */
BW_API bw_status bw_buckling_of_displacement(bw_context *context, bw_system *system,
                                             const double *displacement,
                                             const bw_buckling_options *options,
                                             bw_buckling **buckling);
/* Where searches for the worst load begin. */
typedef struct bw_buckling_starts_options {
  bw_worst_load_options loads; /* which are admissible */
  bool reversed;               /* negative factors: the loads pull; default false */
  int restarts;                /* random combinations of the shapes, 0 or more; default 48 */
  uint64_t seed;               /* of these; default 1 */
} bw_buckling_starts_options;
BW_API void bw_buckling_starts_options_default(bw_buckling_starts_options *options);
/* Admissible loads that are likely to buckle a body, by an ascent of the largest 1 / lambda among
 * combinations of given shapes (m, count x node_count x 3; count 1 to 60), which must be free of
 * rigid-body motion (docs/theory/stability.md, "Worst-case buckling"). At most `wanted` different
 * ones, by descending value: *found of them, pressure (Pa, wanted x basis->count) and value (-,
 * wanted), which 1 / lambda of the load reaches at least. *report, which may be NULL: of the linear
 * programs. BW_INVALID for too many shapes, and where no shape has strain energy; those of
 * bw_worst_loads. */
BW_API bw_status bw_buckling_starts(bw_context *context, bw_system *system,
                                    const bw_pressure_basis *basis,
                                    const bw_buckling_starts_options *options, int count,
                                    const double *shapes, int wanted, int *found, double *pressure,
                                    double *value, bw_solver_report *report);
/* By how much every factor is too large in size on this mesh, relative (-, buckling->count) to it,
 * by the recovered stress of its shape, as bw_modes_error. The error of the stress that K_sigma is
 * made of is not in it. */
BW_API bw_status bw_buckling_error(bw_context *context, const bw_buckling *buckling,
                                   double *relative);

#ifdef __cplusplus
}
#endif
#endif
