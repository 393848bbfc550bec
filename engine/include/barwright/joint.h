/* joint: static solutions, modes and load factors of models with bonds, attached masses and
 * springs, and remote points (docs/theory/joints.md), and of sectors of cyclic symmetry
 * (docs/theory/symmetry.md). */
#ifndef BARWRIGHT_JOINT_H
#define BARWRIGHT_JOINT_H

#include "barwright/analysis.h"
#include "barwright/buckling.h"
#include "barwright/eigen.h"
#include "barwright/incremental.h"
#include "barwright/statics.h"

#ifdef __cplusplus
extern "C" {
#endif

/* The static solution of a model with bonds, attachments and couplings, or without: T^T K T x = T^T
 * (f - K g) for the displacements u = T x + g that bonds and supports allow. By a factor, or as
 * options->solver says of sparse matrices (bw_linear_solve); of the other options only `tolerance`
 * is looked at. result->system is NULL. BW_UNSUPPORTED for inertia relief, BW_UNCONSTRAINED where
 * supports, bonds and springs leave rigid-body modes, BW_SINGULAR for springs too soft beside the
 * body, BW_INVALID for a node that follows others in two bonds, or follows nodes that follow
 * others, for one of a rigid coupling that a support or a bond moves otherwise, for prescribed
 * values of a remote point that are over-constrained, and for supports and loads of a sector that
 * differ from sector to sector, BW_LIMIT for more than 2000 nodes of a distributed coupling with
 * springs, a mass or prescribed values, BW_UNSUPPORTED for bonds of a sector that reach a cut; and
 * those of bw_linear_solve. `options` may be NULL. */
BW_API bw_status bw_joined_statics(bw_context *context, const bw_model *model,
                                   const bw_statics_options *options, bw_static **result);
/* Its lowest modes: those of T^T K T and T^T M T, of a sector for each number of nodal diameters.
 * Rigid-body modes are left out. BW_INVALID as bw_joined_statics, for masses without a density of
 * the material, and for too many nodal diameters; and those of bw_eigen_solve. `options` may be
 * NULL. */
BW_API bw_status bw_joined_modes(bw_context *context, const bw_model *model,
                                 const bw_modes_options *options, bw_modes **modes);
/* Load factors of its static solution, with those of T^T K T and T^T K_sigma T, as
 * bw_buckling_of_static. Springs and bonds have no stress of their own. Forces of remote points
 * keep their direction, on levers that turn. BW_UNSUPPORTED for a moment about a remote point that
 * can turn about both axes across it and for a state of a motion of a model with couplings,
 * BW_LIMIT for more than 2000 nodes of a distributed coupling with a lever, BW_INVALID for one that
 * has changed since; those of bw_joined_statics and bw_buckling_of_static. `options` may be NULL.
 */
BW_API bw_status bw_joined_buckling(bw_context *context, const bw_static *solution,
                                    const bw_buckling_options *options, bw_buckling **buckling);

/* The equations of a joined model for many right-hand sides: bw_system_solve gives u = P S P^T f of
 * forces at its nodes, with S = T (T^T K T)^-1 T^T. Rigid-body modes are those of all bodies
 * together, which P takes off; the mean that is taken off is that of the volume. `solver`: a
 * factor, or NULL. The system has no matrices and no modes: bw_joined_modes has these. BW_INVALID
 * as bw_joined_statics. BW_UNCONSTRAINED for bodies that move against one another, BW_GEOMETRY for
 * bonds across gaps that resist a rigid-body mode, BW_UNSUPPORTED for a sector, another solver, and
 * what strains the body without a force: preloads and prescribed displacements. BW_SINGULAR as
 * bw_joined_statics. */
BW_API bw_status bw_joined_system(bw_context *context, const bw_model *model,
                                  const bw_solver *solver, bw_system **system);

/* The equations of a joined body cut into subdomains, updated through edits of its shape. Mutable:
 * one owner, one thread at a time. The stiffness of the bodies apart follows the edits subdomain by
 * subdomain. T and T^T K T are of the shape and the joints as they are: the factor is recomputed
 * where an entry of T^T K T changed, in the former elimination order where its pattern did not. An
 * object: bw_retain, bw_release. */
typedef struct bw_joined_incremental bw_joined_incremental;
/* `subdomain_count` subdomains by element, element_subdomain (index, element_count), and by node,
 * node_subdomain (index, node_count), and `rotate_material` as bw_incremental_system_create takes
 * them; the caller's reference. Those of bw_subdomain_stiffness_create; BW_UNSUPPORTED for a
 * sector. */
BW_API bw_status bw_joined_incremental_create(bw_context *context, const bw_model *model,
                                              bool rotate_material, int32_t subdomain_count,
                                              const int32_t *element_subdomain,
                                              const int32_t *node_subdomain,
                                              bw_joined_incremental **joined);
/* The mesh that was last followed; borrowed. */
BW_API const bw_mesh *bw_joined_incremental_mesh(const bw_joined_incremental *joined);
/* The stiffness of the bodies apart on it; borrowed. */
BW_API const bw_subdomain_stiffness *
bw_joined_incremental_stiffness(const bw_joined_incremental *joined);
/* Follow an edit, as bw_incremental_system_update; the joints of the edited model may be others. */
BW_API bw_status bw_joined_incremental_update(bw_context *context, bw_joined_incremental *joined,
                                              const bw_model *model,
                                              const bw_subdomain_motion *motion, bw_reuse *reuse);
/* The static solution of the model that was last synchronised, as bw_joined_statics: by the kept
 * factor, or where options->solver is given, by that. BW_INVALID for another model. With `check`,
 * the displacement is compared with that of bw_joined_statics: BW_INTERNAL where they differ by
 * more than 1e-8 of the largest. Completes *reuse. */
BW_API bw_status bw_joined_incremental_statics(bw_context *context, bw_joined_incremental *joined,
                                               const bw_model *model,
                                               const bw_statics_options *options, bool check,
                                               bw_static **result, bw_reuse *reuse);

/* What exerts a traction. */
typedef enum bw_joint_kind {
  BW_JOINT_BOND,       /* a bond, on its side a */
  BW_JOINT_ATTACHMENT, /* a spring, or the weight of a mass */
  BW_JOINT_COUPLING,   /* a remote point, on its face */
  BW_JOINT_SUPPORT     /* a support, also a plane of symmetry */
} bw_joint_kind;
/* The traction that joint or support `index` (from 0) of its kind exerts on the body, as of
 * bw_interface_traction, and its sum: traction (Pa, node_count x 3), normal (Pa, node_count)
 * positive in tension, shear (Pa, node_count). sum->shared counts the nodes of a bond that a
 * support constrains too, of which its part is left out, and those of a support at which the
 * reaction is of other supports too, and counts whole; sum->imbalance is 0. BW_INVALID for a model
 * that has changed since and one without this joint, BW_UNSUPPORTED for one on nodes without
 * facets, for joints in an instant of a transient and in the whole of a sector, and for supports
 * that meet a cut of a sector (docs/theory/joints.md#tractions-of-joints). */
BW_API bw_status bw_joint_traction(bw_context *context, const bw_static *result, bw_joint_kind kind,
                                   int index, double *traction, double *normal, double *shear,
                                   bw_interface_force *sum);

/* ---- cyclic symmetry ------------------------------------------------------------------------- */

/* The model of the whole wheel of a sector, without cyclic symmetry. Its nodes are the sector's but
 * those of the high face, turned sector by sector, then those on the axis. The material turns with
 * the sectors, and so do supports, bonds, attachments and loads. BW_INVALID for a model without
 * cyclic symmetry, BW_LIMIT for more than 2^31 - 1 nodes, BW_UNSUPPORTED for displacements that are
 * prescribed by a field or in some directions only, and for springs that differ along x, y and z;
 * and those of bw_mesh_adopt and of the functions that add supports, bonds, attachments and loads.
 */
BW_API bw_status bw_model_whole(bw_context *context, const bw_model *sector, bw_model **whole);
/* The static solution of the whole wheel from that of its sector. BW_INVALID for a solution that is
 * no sector's or whose model has changed, and those of bw_model_whole. */
BW_API bw_status bw_static_whole(bw_context *context, const bw_static *sector, bw_static **whole);
/* The modes of the whole wheel from those of its sector, on the same mesh, of M-norm 1. BW_INVALID
 * and BW_LIMIT as bw_static_whole. */
BW_API bw_status bw_modes_whole(bw_context *context, const bw_modes *sector, bw_modes **whole);

#ifdef __cplusplus
}
#endif
#endif
