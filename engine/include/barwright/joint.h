/* joint: static solutions, modes and load factors of models with bonds, attached masses and
 * springs, and remote points (docs/theory/joints.md). */
#ifndef BARWRIGHT_JOINT_H
#define BARWRIGHT_JOINT_H

#include "barwright/buckling.h"
#include "barwright/eigen.h"
#include "barwright/statics.h"

#ifdef __cplusplus
extern "C" {
#endif

/* The static solution of a model with bonds, attachments and couplings, or without: T^T K T x = T^T
 * (f - K g) for the displacements u = T x + g that bonds and supports allow. By a factor, or as
 * options->solver says of sparse matrices (bw_linear_solve); of the other options only `tolerance`
 * is looked at. result->system is NULL. BW_UNCONSTRAINED where supports, bonds and springs leave
 * rigid-body modes, BW_SINGULAR for springs too soft beside the body, BW_INVALID for a node that
 * follows others in two bonds, or follows nodes that follow others, for one of a rigid coupling
 * that a support or a bond moves otherwise, and for prescribed values of a remote point that are
 * over-constrained, BW_LIMIT for more than 2000 nodes of a distributed coupling with springs, a
 * mass or prescribed values; and those of bw_linear_solve. `options` may be NULL. */
BW_API bw_status bw_joined_statics(bw_context *context, const bw_model *model,
                                   const bw_statics_options *options, bw_static **result);
/* Its lowest modes: those of T^T K T and T^T M T. Rigid-body modes are left out. BW_INVALID as
 * bw_joined_statics, and for masses without a density of the material; and those of
 * bw_eigen_solve. `options` may be NULL. */
BW_API bw_status bw_joined_modes(bw_context *context, const bw_model *model,
                                 const bw_modes_options *options, bw_modes **modes);
/* Load factors of its static solution, with those of T^T K T and T^T K_sigma T, as
 * bw_buckling_of_static. Springs and bonds have no stress of their own. BW_UNSUPPORTED for a model
 * with couplings, BW_INVALID for one that has changed since; those of bw_joined_statics and
 * bw_buckling_of_static. `options` may be NULL.
 */
BW_API bw_status bw_joined_buckling(bw_context *context, const bw_static *solution,
                                    const bw_buckling_options *options, bw_buckling **buckling);

#ifdef __cplusplus
}
#endif
#endif
