/* shape: skeletons, skinning weights, subdomains, poses, inverse kinematics, repair of edited
 * meshes (the paper agile, sections 3 and 4, and what it calls future work). */
#ifndef BARWRIGHT_SHAPE_H
#define BARWRIGHT_SHAPE_H

#include "barwright/solve.h"

#ifdef __cplusplus
extern "C" {
#endif

/* ---- skeletons ------------------------------------------------------------------------------- */

/* A tree of joints joined by bones. Immutable. Bones are ordered so that a parent comes before its
 * children; bone b runs from joint bone[2 b] (its head, nearer the root) to bone[2 b + 1] (its
 * tail). Names are unique; where none is given, "joint 3" and "bone 2" (counting from 1). */
typedef struct bw_skeleton {
  bw_object object;
  int32_t joint_count, bone_count;
  double *joint; /* joint_count x 3 */
  bw_name *joint_name;
  int32_t *bone; /* bone_count x 2 */
  bw_name *bone_name;
  int32_t *parent; /* bone_count: the bone whose tail is this one's head, or -1 */
  int32_t root;    /* a joint */
} bw_skeleton;

/* From joints (joints x 3) and bones (bones x 2 joints, either way round). Names may be NULL, or
 * have empty entries. `root`: a joint, or -1: the joint whose farthest joint along the tree is
 * nearest. BW_INVALID names the bone or joint: not connected, a cycle, a bone of no length, an
 * index out of range, a name used twice. */
BW_API bw_status bw_skeleton_create(bw_context *context, int64_t joints, const double *joint,
                                    const bw_name *joint_name, int64_t bones, const int32_t *bone,
                                    const bw_name *bone_name, int32_t root, bw_skeleton **skeleton);
BW_API int32_t bw_skeleton_find_joint(const bw_skeleton *skeleton, const char *name); /* or -1 */
BW_API int32_t bw_skeleton_find_bone(const bw_skeleton *skeleton, const char *name);

typedef struct bw_skeleton_options {
  int bones;      /* wanted; 0: as many as the shape's branches and bends ask for */
  double prune;   /* a branch that reaches no farther out of its junction than this many times the
                     junction's local radius is left out; default 1.5 */
  double bend;    /* a bone strays at most this many local radii from the curve; default 0.5 */
  double minutes; /* of the contraction, in a child process; default 5 */
} bw_skeleton_options;
BW_API void bw_skeleton_options_default(bw_skeleton_options *options);
/* CGAL's mean-curvature skeleton of a closed surface, pruned and simplified into joints and bones,
 * numbered from the root (the middle joint) outwards, long limbs first. All joints lie inside;
 * those at the ends of limbs half a radius below the surface. A cycle (a ring) is cut open at its
 * place farthest from the root, with a warning. An open or badly connected surface is repaired
 * first, with a warning; one of several shells is BW_GEOMETRY. */
BW_API bw_status bw_skeleton_extract(bw_context *context, const bw_surface *surface,
                                     const bw_skeleton_options *options, bw_skeleton **skeleton);

/* Trivial graph format: "number x y z [name]" per joint, "#", "from to [name]" per bone. Lengths
 * are multiplied by `unit` (m per unit of the file) on reading, divided on writing. Bones are
 * written pointing away from the root, which tells it when they are read again. */
BW_API bw_status bw_skeleton_read_tgf(bw_context *context, const char *path, double unit,
                                      bw_skeleton **skeleton);
BW_API bw_status bw_skeleton_write_tgf(bw_context *context, const bw_skeleton *skeleton,
                                       const char *path, double unit);

/* Edits; each gives a new skeleton and leaves the old one. */
/* A joint on a bone at `fraction` (0 to 1) of its length: the bone keeps its name on the side of
 * its head. */
BW_API bw_status bw_skeleton_insert_joint(bw_context *context, const bw_skeleton *skeleton,
                                          int32_t bone, double fraction, const char *name,
                                          bw_skeleton **out);
BW_API bw_status bw_skeleton_move_joint(bw_context *context, const bw_skeleton *skeleton,
                                        int32_t joint, const double at[3], bw_skeleton **out);
/* Two bones that meet at a joint of no other bone become one, with the name of the first. Where
 * that joint was the root, the other end of the first is. */
BW_API bw_status bw_skeleton_merge_bones(bw_context *context, const bw_skeleton *skeleton,
                                         int32_t a, int32_t b, bw_skeleton **out);
/* Leave out a bone and all below it. */
BW_API bw_status bw_skeleton_remove_bone(bw_context *context, const bw_skeleton *skeleton,
                                         int32_t bone, bw_skeleton **out);
BW_API bw_status bw_skeleton_with_root(bw_context *context, const bw_skeleton *skeleton,
                                       int32_t joint, bw_skeleton **out);
/* The rest frame of every bone, bone_count x 9, rows are its axes: x along the bone, y and z across
 * it (y is the global axis least along the bone, made orthogonal), right-handed. */
BW_API void bw_skeleton_frames(const bw_skeleton *skeleton, double *frame);

/* ---- skinning weights --------------------------------------------------------------------------
 */

typedef struct bw_weights_options {
  /* of the exchange with the bones: along the surface a weight falls from 0.95 to 0.05 in 4.6 /
   * sqrt(heat) distances to the bone; 0: 20, one such distance (Pinocchio: 1) */
  double heat;
} bw_weights_options;
/* How much each bone moves each node: node_count x bone_count, non-negative, each row summing to
 * one (checked: BW_INTERNAL otherwise). On the surface the heat equilibrium of Baran and Popovic,
 * (-Laplace + H) w = H p with H = heat / d^2 to the nearest bones that a surface point sees;
 * inside, a Laplace solve with these as boundary values (eq. 2 of agile); negative values, which
 * cotangents can cause, are cut and rows scaled. Mid-edge nodes get the mean of their edge's ends.
 */
BW_API bw_status bw_skinning_weights(bw_context *context, const bw_mesh *mesh,
                                     const bw_skeleton *skeleton, const bw_weights_options *options,
                                     double *weight);

/* ---- subdomains (agile, section 4)
 * ----------------------------------------------------------------
 */

/* Subdomains cut further, for the equations: elements joined through faces whose corners follow the
 * same set of bones. Few of a blended subdomain's bones matter at any place, so that an edit
 * changes some of its stiffness subdomains and leaves the others. A subdomain of type R is one
 * stiffness subdomain, of its own number; the others come after, by subdomain. */
typedef struct bw_stiffness_subdomains {
  int32_t count;
  int32_t *of_element; /* element_count */
  int32_t *parent;     /* count: the subdomain that each is part of, ascending */
  int32_t *bone_start; /* count + 1: the bones its corners follow, ascending */
  int32_t *bone;
  int32_t *of_node; /* node_count: that whose frame a node goes with: that of type R if any, else
                       one whose first bone all stiffness subdomains at the node follow, where there
                       is one, and of these that of the fewest bones */
} bw_stiffness_subdomains;

/* The subdomains of an edit session, which bones pose and scale. Type R follows one bone; type F
 * lies between several and is blended. They are numbered with all of type R first, by bone.
 * Immutable.
 *
 * Invariants: every element belongs to one subdomain; a type R subdomain is connected through
 * faces; two type R subdomains share no node; subdomains of type F share only nodes of type R
 * subdomains. So the posed mesh is continuous whatever the bones do. */
typedef struct bw_subdomains {
  bw_object object;
  const bw_mesh *mesh;         /* retained: the rest shape */
  const bw_skeleton *skeleton; /* retained */
  int32_t count, rigid_count;  /* all, and those of type R */
  int32_t *element_subdomain;  /* element_count */
  int32_t *elements;           /* count: number of elements in each */
  int32_t *bone_of;            /* count: the bone of a type R subdomain, -1 for type F */
  int32_t *bone_start;         /* count + 1: the bones each subdomain follows, ascending */
  int32_t *bone;
  int32_t *adjacent_start; /* count + 1: subdomains that share a node, ascending */
  int32_t *adjacent;
  int32_t *node_subdomain; /* node_count: the subdomain whose frame a node goes with: the one of
                              type R if any, else the one of type F */
  uint8_t *interface;      /* node_count: 1 where elements of several subdomains meet */
  /* what moves each corner node: bones and weights summing to one; empty for mid-edge nodes */
  int64_t *influence_start; /* node_count + 1 */
  int32_t *influence_bone;
  double *influence_weight;
  bw_stiffness_subdomains stiffness;
} bw_subdomains;

typedef struct bw_subdomains_options {
  double threshold;             /* mean weight from which an element is of type R; 0: 0.95 */
  const double *bone_threshold; /* bone_count: instead of it, where not 0; may be NULL */
  /* Where bones are short for the body's thickness no weight comes near one. So that a bone has a
   * subdomain all the same, its threshold is lowered (with a warning) to what this share, by
   * volume, of the elements that it moves most reach; not below a bone_threshold of its own. 0:
   * 0.35; negative: never, as the paper. */
  double share;
} bw_subdomains_options;
/* Region growing through faces from the element of the highest mean weight of each bone; what is
 * left is grouped by faces (and through shared nodes that no type R subdomain has). Type F is
 * blended by weights from Laplace solves with ones and zeros on the interfaces. `weight` as from
 * bw_skinning_weights. A bone without a subdomain gets a warning. */
BW_API bw_status bw_subdomains_create(bw_context *context, const bw_mesh *mesh,
                                      const bw_skeleton *skeleton, const double *weight,
                                      const bw_subdomains_options *options,
                                      bw_subdomains **subdomains);
/* Give elements to a bone's type R subdomain, or (bone -1) take them out of type R. BW_INVALID
 * names the element when the subdomain would fall apart or touch another bone's. */
BW_API bw_status bw_subdomains_assign(bw_context *context, const bw_subdomains *subdomains,
                                      int64_t count, const int32_t *element, int32_t bone,
                                      bw_subdomains **changed);
/* The same subdomains from labels: element_subdomain as numbered in `bone_of` (count entries). For
 * meshes refilled in a session. */
BW_API bw_status bw_subdomains_from_labels(bw_context *context, const bw_mesh *mesh,
                                           const bw_skeleton *skeleton, int32_t count,
                                           const int32_t *bone_of, const int32_t *element_subdomain,
                                           bw_subdomains **subdomains);

/* Whether the invariants hold, for tests and debuggers: BW_INVALID or BW_INTERNAL names the first
 * element or node where they do not. */
BW_API bw_status bw_subdomains_check(bw_context *context, const bw_subdomains *subdomains);

/* The subdomains on `mesh`, which bw_mesh_refill made of the posed shape with `replace` (whole
 * subdomains of type F), node_from and element_from. Kept nodes keep their places at rest and what
 * moves them; a new one gets weights from Laplace on `mesh` and the place at rest that its own
 * blended map, of the bones' maps at hand, takes to where it is. The rest mesh of these subdomains
 * carries positions: elements in it may be inverted. BW_GEOMETRY where bones blend to a plane. */
BW_API bw_status bw_subdomains_refilled(bw_context *context, const bw_subdomains *subdomains,
                                        const double *map, const uint8_t *replace,
                                        const bw_mesh *mesh, const int32_t *node_from,
                                        const int32_t *element_from, bw_subdomains **refilled);

/* ---- poses ----------------------------------------------------------------------------------- */

/* What an edit does to one bone, relative to rest: about its head, in its rest frame. A bone takes
 * over the rotation of its parent and hangs at the parent's moved tail; scale is not taken over. */
typedef struct bw_bone_pose {
  double rotation[9];    /* orthonormal, global directions at rest: x -> rotation x */
  double scale[3];       /* along the bone's own axes (bw_skeleton_frames), positive */
  double translation[3]; /* of the head, m, in the parent's moved directions */
} bw_bone_pose;
BW_API void bw_bone_pose_rest(bw_bone_pose *pose);
/* Forward kinematics. map: bone_count x 12, rows of [A | b], rest -> posed; rotation: bone_count x
 * 9, the rotation in A (A = rotation F^T S F with F the rest frame). Either may be NULL. */
BW_API bw_status bw_pose_maps(bw_context *context, const bw_skeleton *skeleton,
                              const bw_bone_pose *pose, double *map, double *rotation);
/* Posed joints, joint_count x 3 (the root's bones' heads, else tails). */
BW_API void bw_pose_joints(const bw_skeleton *skeleton, const double *map, double *joint);
/* Posed nodes, node_count x 3: corners blended, mid-edge nodes at midpoints. */
BW_API bw_status bw_pose_nodes(bw_context *context, const bw_subdomains *subdomains,
                               const double *map, double *node);
/* d node / d scale[axis] of one bone (agile, eq. 20: node positions are linear in the scales):
 * node_count x 3. */
BW_API bw_status bw_pose_derivative(bw_context *context, const bw_subdomains *subdomains,
                                    const bw_bone_pose *pose, int32_t bone, int axis,
                                    double *derivative);

/* How each stiffness subdomain moved since rest (stiffness.count): see bw_subdomain_motion
 * (assemble.h). One all of whose bones moved by one affine map moves with it as a whole. Its frame
 * is the rotation of its first bone. */
BW_API bw_status bw_pose_motion(bw_context *context, const bw_subdomains *subdomains,
                                const double *map, const double *rotation,
                                bw_subdomain_motion *motion);

/* ---- inverse kinematics ---------------------------------------------------------------------- */

/* How far a bone may turn against its parent (of a root bone: against rest), radians. */
typedef struct bw_joint_limit {
  double swing;     /* largest angle between the bone and where its parent would carry it */
  double twist_min; /* about the bone's own axis */
  double twist_max;
} bw_joint_limit;
BW_API void bw_joint_limit_none(bw_joint_limit *limit);
typedef struct bw_reach_target {
  int32_t bone;
  double along; /* which point of the bone: 0 head, 1 tail */
  double at[3];
  double weight;      /* default 1 */
  int32_t chain_from; /* the first bone of the chain that may turn, or -1: up to the root */
} bw_reach_target;
typedef struct bw_reach_report {
  double distance; /* the largest left over all targets, m */
  int iterations;
  bool reached; /* within the tolerance; else the best pose within the limits */
} bw_reach_report;
/* Turn the bones of the chains so that all targets are met at once, as nearly as the limits allow
 * (damped least squares on the rotations, projected on the limits). `limit` may be NULL. tolerance
 * 0: 1e-6 of the skeleton's size. */
BW_API bw_status bw_pose_reach(bw_context *context, const bw_skeleton *skeleton,
                               const bw_joint_limit *limit, int count,
                               const bw_reach_target *target, double tolerance, bw_bone_pose *pose,
                               bw_reach_report *report);

/* ---- repair of an edited mesh
 * --------------------------------------------------------------------
 */

typedef struct bw_mesh_repair_report {
  int32_t inverted;                 /* elements of no positive volume (or below the floor) before */
  int32_t worst;                    /* the worst element before, or -1 */
  double worst_before, worst_after; /* smallest shape quality: 3 (1: regular, <= 0: inverted):
                                       bw_shape_quality */
  int32_t moved; /* nodes moved by relaxation, or elements replaced by refilling */
  int iterations;
} bw_mesh_repair_report;
/* Mean ratio quality of the straight tetrahedron: 12 (3V)^(2/3) / sum of squared edge lengths,
 * signed by the volume; 1 for a regular one. */
BW_API double bw_shape_quality(const double *a, const double *b, const double *c, const double *d);
/* Inverted (or, with floor > 0, poorer than `floor`) elements of `mesh`'s topology at the positions
 * `node`: count, and the worst. */
BW_API void bw_mesh_shape_check(const bw_mesh *mesh, const double *node, double floor,
                                bw_mesh_repair_report *report);
/* Move nodes with may_move (corners off the boundary; others are left) until no element is inverted
 * and the worst quality stops growing: local untangling of the worst elements' neighbourhoods.
 * Mid-edge nodes stay at midpoints. BW_GEOMETRY, the worst element named, when it cannot; `node` is
 * then as it was. */
BW_API bw_status bw_mesh_relax(bw_context *context, const bw_mesh *mesh, const uint8_t *may_move,
                               double *node, bw_mesh_repair_report *report);
/* New tetrahedra by TetGen in the part of the mesh with replace[e] != 0, at the positions `node`:
 * the facets between it and the rest, and those on the boundary, stay exactly. The boundary facets
 * of `refilled` are those of `mesh`, in the same order, with the same positions; boundary and kept
 * nodes come first: node_from[i] is the old node or -1; element_from[e] the old element (kept ones,
 * in order, first) or -1 - k with k the part's component (face-connected parts of `replace`, by
 * lowest element). BW_GEOMETRY when the part's own boundary intersects itself. Blocks for bw_free.
 */
BW_API bw_status bw_mesh_refill(bw_context *context, const bw_mesh *mesh, const double *node,
                                const uint8_t *replace, bw_mesh **refilled, int32_t **node_from,
                                int32_t **element_from);

#ifdef __cplusplus
}
#endif
#endif
