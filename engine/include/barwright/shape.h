/* shape: skeletons, skinning weights, subdomains, poses, inverse kinematics, repair of edited
 * meshes (the paper agile, sections 3 and 4, and what it calls future work). */
#ifndef BARWRIGHT_SHAPE_H
#define BARWRIGHT_SHAPE_H

#include "barwright/eigen.h"
#include "barwright/incremental.h"

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
  double *joint;       /* (m, joint_count x 3) */
  bw_name *joint_name; /* joint_count names */
  int32_t *bone;       /* (index, bone_count x 2) */
  bw_name *bone_name;  /* bone_count names */
  int32_t *parent;     /* (index, bone_count) the bone whose tail is this one's head, or -1 */
  int32_t root;        /* a joint */
} bw_skeleton;

/* From `joints` joints, joint (m, joints x 3), and `bones` bones, bone (index, bones x 2) of
 * joints, in either direction. Names may be NULL, or have empty entries. `root`: a joint, or -1:
 * the joint whose farthest joint along the tree is nearest. BW_INVALID names the bone or joint: not
 * connected, a cycle, a bone of no length, an index out of range, a name used twice. BW_LIMIT
 * beyond 2^29 - 1 joints. */
BW_API bw_status bw_skeleton_create(bw_context *context, int64_t joints, const double *joint,
                                    const bw_name *joint_name, int64_t bones, const int32_t *bone,
                                    const bw_name *bone_name, int32_t root, bw_skeleton **skeleton);
/* The joint of a name, or -1. */
BW_API int32_t bw_skeleton_find_joint(const bw_skeleton *skeleton, const char *name);
/* The bone of a name, or -1. */
BW_API int32_t bw_skeleton_find_bone(const bw_skeleton *skeleton, const char *name);

/* How a skeleton is extracted. */
typedef struct bw_skeleton_options {
  int bones;    /* wanted, 0 to 500; default 0: by the shape's branches and bends */
  double prune; /* (-) a branch that reaches no farther out of its junction than this many times the
                   junction's local radius is left out; default 1.5, 0 or more */
  double bend;  /* (-) largest distance of a bone from the curve in local radii; default 0.5, > 0 */
  double minutes; /* (minutes) of the contraction, in a child process; default 5, > 0 */
} bw_skeleton_options;
BW_API void bw_skeleton_options_default(bw_skeleton_options *options);
/* CGAL's mean-curvature skeleton of a closed surface, pruned and simplified into joints and bones,
 * numbered from the root (the middle joint) outwards, long limbs first. All joints lie inside;
 * those at the ends of limbs half a radius below the surface. A cycle (a ring) is cut open at its
 * place farthest from the root, with a warning. An open or badly connected surface is repaired
 * first, with a warning; one of several shells or without size is BW_GEOMETRY, BW_LIMIT where time
 * runs out. Starts processes. `options` may be NULL. */
BW_API bw_status bw_skeleton_extract(bw_context *context, const bw_surface *surface,
                                     const bw_skeleton_options *options, bw_skeleton **skeleton);

/* Reads a file in trivial graph format: "number x y z [name]" per joint, "#", "from to [name]" per
 * bone. Lengths are multiplied by unit (m), that of the file. The root is the joint from which all
 * bones point away, else the middle one. BW_FORMAT with the line for anything else, BW_LIMIT for
 * too many joints. */
BW_API bw_status bw_skeleton_read_tgf(bw_context *context, const char *path, double unit,
                                      bw_skeleton **skeleton);
/* Writes such a file, lengths divided by unit (m). Bones point away from the root. */
BW_API bw_status bw_skeleton_write_tgf(bw_context *context, const bw_skeleton *skeleton,
                                       const char *path, double unit);

/* Edits; each gives a new skeleton and leaves the old one. */

/* A joint on a `bone` at a fraction (-) of its length, above 0 and below 1: the bone keeps its name
 * on the side of its head. */
BW_API bw_status bw_skeleton_insert_joint(bw_context *context, const bw_skeleton *skeleton,
                                          int32_t bone, double fraction, const char *name,
                                          bw_skeleton **out);
/* A `joint` at another place. */
BW_API bw_status bw_skeleton_move_joint(bw_context *context, const bw_skeleton *skeleton,
                                        int32_t joint, const double at[3], bw_skeleton **out);
/* Two bones `a` and `b` that meet at a joint of no other bone become one, with the name of the
 * first. Where that joint was the root, the other end of the first is. */
BW_API bw_status bw_skeleton_merge_bones(bw_context *context, const bw_skeleton *skeleton,
                                         int32_t a, int32_t b, bw_skeleton **out);
/* Leaves out a `bone` and all below it; BW_INVALID where nothing would be left. */
BW_API bw_status bw_skeleton_remove_bone(bw_context *context, const bw_skeleton *skeleton,
                                         int32_t bone, bw_skeleton **out);
/* The same with another `joint` as the root. */
BW_API bw_status bw_skeleton_with_root(bw_context *context, const bw_skeleton *skeleton,
                                       int32_t joint, bw_skeleton **out);
/* The rest frame of every bone, frame (-, bone_count x 9), rows are its axes: x along the bone, y
 * and z across it (y is the global axis least along the bone, made orthogonal), right-handed. */
BW_API void bw_skeleton_frames(const bw_skeleton *skeleton, double *frame);

/* ---- skinning weights ------------------------------------------------------------------------ */

/* How weights fall off; all zeros are the defaults. */
typedef struct bw_weights_options {
  /* (-) of the exchange with the bones: along the surface a weight falls from 0.95 to 0.05 in 4.6 /
   * sqrt(heat) distances to the bone, 0 or more; 0: 20, one such distance (Pinocchio: 1) */
  double heat;
} bw_weights_options;
/* How much each bone moves each node: weight (-, node_count x bone_count), non-negative, each row
 * summing to one (checked: BW_INTERNAL otherwise). On the surface the heat equilibrium of Baran and
 * Popovic,
 * (-Laplace + H) w = H p with H = heat / d^2 to the nearest bones that are visible from a surface
 * point. Inside, a Laplace solve with these as boundary values (eq. 2 of agile). Negative values,
 * which cotangents can cause, are set to 0 and rows scaled. Mid-edge nodes get the mean of their
 * edge's ends. BW_SINGULAR where the Laplacian's factor fails, BW_LIMIT for one too large.
 * `options` may be NULL. */
BW_API bw_status bw_skinning_weights(bw_context *context, const bw_mesh *mesh,
                                     const bw_skeleton *skeleton, const bw_weights_options *options,
                                     double *weight);

/* ---- subdomains (agile, section 4) ----------------------------------------------------------- */

/* Subdomains cut further, for the equations: elements of one region joined through faces, those of
 * type F where their corners follow the same set of bones. Few of a blended subdomain's bones
 * matter at any place, so that an edit changes some of its stiffness subdomains and leaves the
 * others; and each is of one material. A subdomain of type R is one stiffness subdomain in each
 * connected piece of a region. They are numbered by subdomain. bw_subdomains owns the lists. */
typedef struct bw_stiffness_subdomains {
  int32_t count;
  int32_t *of_element; /* (index, element_count) */
  int32_t *parent;     /* (index, count) the subdomain that each is part of, ascending */
  int32_t *bone_start; /* (index, count + 1) of the bones its corners follow, ascending */
  int32_t *bone;       /* (index, bone_start[count]) */
  int32_t *of_node; /* (index, node_count) that whose frame a node goes with: that of type R if any,
                       else one whose first bone all stiffness subdomains at the node follow, where
                       there is one, and of these that of the fewest bones */
} bw_stiffness_subdomains;

/* The subdomains of an edit session, which bones pose and scale. Type R follows one bone; type F
 * is between several and is blended. They are numbered with all of type R first, by bone.
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
  int32_t *element_subdomain;  /* (index, element_count) */
  int32_t *elements;           /* (count) number of elements in each */
  int32_t *bone_of;            /* (index, count) the bone of a type R subdomain, -1 for type F */
  int32_t *bone_start;     /* (index, count + 1) of the bones each subdomain follows, ascending */
  int32_t *bone;           /* (index, bone_start[count]) */
  int32_t *adjacent_start; /* (index, count + 1) of the subdomains that share a node, ascending */
  int32_t *adjacent;       /* (index, adjacent_start[count]) */
  int32_t *node_subdomain; /* (index, node_count) the subdomain whose frame a node goes with: the
                              one of type R if any, else the one of type F */
  uint8_t *interface;      /* (node_count) 1 where elements of several subdomains meet */
  /* (index, node_count + 1) Of the bones that move each corner node, with weights summing to one;
   * empty for mid-edge nodes */
  int64_t *influence_start;
  int32_t *influence_bone;           /* (index, influence_start[node_count]) */
  double *influence_weight;          /* (-, influence_start[node_count]) */
  bw_stiffness_subdomains stiffness; /* the parts for the equations */
} bw_subdomains;

/* How subdomains are found; all zeros are the defaults. */
typedef struct bw_subdomains_options {
  double threshold;             /* (-) mean weight from which an element is of type R; 0: 0.95 */
  const double *bone_threshold; /* (-, bone_count) instead of it, where not 0; may be NULL */
  /* (-) Where bones are short for the body's thickness no weight comes near one. So that a bone
   * still has a subdomain, its threshold is lowered (with a warning) to what this fraction, by
   * volume, of the elements that it moves most reach; not below a bone_threshold of its own. 0:
   * 0.35; negative: never, as the paper. */
  double fraction;
} bw_subdomains_options;
/* Region growing through faces from the element of the highest mean weight of each bone; what is
 * left is grouped by faces (and through shared nodes that no type R subdomain has). Type F is
 * blended by weights from Laplace solves with ones and zeros on the interfaces. weight (-,
 * node_count x bone_count) as from bw_skinning_weights. A bone without a subdomain gives a warning.
 * BW_CONVERGENCE where a Laplace solve fails. `options` may be NULL. */
BW_API bw_status bw_subdomains_create(bw_context *context, const bw_mesh *mesh,
                                      const bw_skeleton *skeleton, const double *weight,
                                      const bw_subdomains_options *options,
                                      bw_subdomains **subdomains);
/* Assigns elements, element (index, count), to the type R subdomain of a `bone`, or (bone -1) takes
 * them out of type R. BW_INVALID names the element when the subdomain would be disconnected or
 * touch another bone's. */
BW_API bw_status bw_subdomains_assign(bw_context *context, const bw_subdomains *subdomains,
                                      int64_t count, const int32_t *element, int32_t bone,
                                      bw_subdomains **changed);
/* `count` subdomains from labels: element_subdomain (index, element_count) as numbered in bone_of
 * (index, count), -1 for type F. For meshes refilled in a session. BW_INVALID where an invariant
 * does not hold. */
BW_API bw_status bw_subdomains_from_labels(bw_context *context, const bw_mesh *mesh,
                                           const bw_skeleton *skeleton, int32_t count,
                                           const int32_t *bone_of, const int32_t *element_subdomain,
                                           bw_subdomains **subdomains);

/* Whether the invariants hold, for tests and debuggers: BW_INVALID or BW_INTERNAL names the first
 * element or node where they do not. */
BW_API bw_status bw_subdomains_check(bw_context *context, const bw_subdomains *subdomains);

/* The subdomains on `mesh`, which bw_mesh_refill made of the shape posed by map (m, bone_count x
 * 12) with replace (element_count before; whole subdomains of type F), node_from (index,
 * node_count) and element_from (index, element_count). Kept nodes keep their places at rest and
 * what moves them; a new one gets weights from Laplace on `mesh` and the place at rest that its own
 * blended map, of these maps, takes to where it is. The rest mesh of these subdomains
 * carries positions: elements in it may be inverted. BW_GEOMETRY where the blended map is
 * singular. */
BW_API bw_status bw_subdomains_refilled(bw_context *context, const bw_subdomains *subdomains,
                                        const double *map, const uint8_t *replace,
                                        const bw_mesh *mesh, const int32_t *node_from,
                                        const int32_t *element_from, bw_subdomains **refilled);

/* ---- poses ----------------------------------------------------------------------------------- */

/* What an edit does to one bone, relative to rest: about its head, in its rest frame. A bone
 * inherits the rotation of its parent and begins at the parent's moved tail; it does not inherit
 * scale. */
typedef struct bw_bone_pose {
  double rotation[9];    /* (-) orthonormal, global directions at rest: x -> rotation x */
  double scale[3];       /* (-) along the bone's own axes (bw_skeleton_frames), positive */
  double translation[3]; /* (m) of the head, in the parent's moved directions */
} bw_bone_pose;
/* Writes the pose of a bone at rest. */
BW_API void bw_bone_pose_rest(bw_bone_pose *pose);
/* Forward kinematics of pose[bone_count]: map (m, bone_count x 12), rows of [A | b] with A (-),
 * rest -> posed; rotation (-, bone_count x 9), that in A (A = rotation F^T S F with F the rest
 * frame). Either may be NULL. */
BW_API bw_status bw_pose_maps(bw_context *context, const bw_skeleton *skeleton,
                              const bw_bone_pose *pose, double *map, double *rotation);
/* Posed joints under map (m, bone_count x 12): joint (m, joint_count x 3), the heads of the root's
 * bones, else tails. */
BW_API void bw_pose_joints(const bw_skeleton *skeleton, const double *map, double *joint);
/* Posed nodes under map (m, bone_count x 12): node (m, node_count x 3), corners blended, mid-edge
 * nodes at midpoints. */
BW_API bw_status bw_pose_nodes(bw_context *context, const bw_subdomains *subdomains,
                               const double *map, double *node);
/* The surface that the mesh of the subdomains was made from, under map (m, bone_count x 12): its
 * own points first, in their order, each moved by the maps of the nodes around it, interpolated.
 * Its edges are split where within a triangle the map differs by more than `tolerance` (m), 0: 1e-4
 * of the surface's size, from its interpolation, and where a narrow triangle would fold over. Edges
 * in flat parts that bend are flipped. *moved (m), which may be NULL, is how far a point moved at
 * most. BW_EMPTY without facets, BW_LIMIT where it would have more than 2^31 / 3 of them. */
BW_API bw_status bw_pose_surface(bw_context *context, const bw_subdomains *subdomains,
                                 const double *map, const bw_surface *surface, double tolerance,
                                 bw_surface **posed, double *moved);
/* d node / d scale[axis] of one `bone` (agile, eq. 20: node positions are linear in the scales):
 * derivative (m, node_count x 3). */
BW_API bw_status bw_pose_derivative(bw_context *context, const bw_subdomains *subdomains,
                                    const bw_bone_pose *pose, int32_t bone, int axis,
                                    double *derivative);

/* How each stiffness subdomain moved since rest, motion[stiffness.count], by map (m, bone_count x
 * 12) and rotation (-, bone_count x 9) of bw_pose_maps: see bw_subdomain_motion (assemble.h). One
 * all of whose bones moved by one affine map moves with it as a whole. Its frame is the rotation of
 * its first bone. */
BW_API bw_status bw_pose_motion(bw_context *context, const bw_subdomains *subdomains,
                                const double *map, const double *rotation,
                                bw_subdomain_motion *motion);

/* ---- inverse kinematics ---------------------------------------------------------------------- */

/* How far a bone may rotate relative to its parent (a root bone: to rest). */
typedef struct bw_joint_limit {
  double swing; /* (rad) largest angle from the direction that follows the parent, 0 to pi */
  double twist_min, twist_max; /* (rad) about the bone's own axis, -pi to pi */
} bw_joint_limit;
/* Writes limits that allow every rotation. */
BW_API void bw_joint_limit_none(bw_joint_limit *limit);
/* A point of a bone and where it shall be. */
typedef struct bw_reach_target {
  int32_t bone; /* (index) */
  double along; /* (-) which point of the bone: 0 head, 1 tail */
  double at[3];
  double weight;      /* (-) > 0; 1 is usual */
  int32_t chain_from; /* the first bone of the chain that may turn, or -1: up to the root */
} bw_reach_target;
/* What inverse kinematics reached. */
typedef struct bw_reach_report {
  double distance; /* (m) largest one left over all targets */
  int iterations;  /* how many */
  bool reached;    /* within the tolerance; else the best pose within the limits */
} bw_reach_report;
/* Rotates the bones of the chains of `count` targets so that all are met at once, as nearly as the
 * limits allow (damped least squares on the rotations, projected on the limits). limit[bone_count]
 * may be NULL. tolerance (m), 0: 1e-6 of the skeleton's size. pose[bone_count] is the initial guess
 * on entry. */
BW_API bw_status bw_pose_reach(bw_context *context, const bw_skeleton *skeleton,
                               const bw_joint_limit *limit, int count,
                               const bw_reach_target *target, double tolerance, bw_bone_pose *pose,
                               bw_reach_report *report);

/* ---- repair of an edited mesh ---------------------------------------------------------------- */

/* What a repair found and did. */
typedef struct bw_mesh_repair_report {
  int32_t inverted;                 /* elements of no positive volume (or below the floor) before */
  int32_t worst;                    /* (index) the worst element before, or -1 */
  double worst_before, worst_after; /* (-) smallest bw_shape_quality (1: regular, <= 0: inverted) */
  int32_t moved;  /* nodes moved by relaxation, or elements replaced by refilling */
  int iterations; /* of relaxation */
} bw_mesh_repair_report;
/* Mean ratio quality (-) of the straight tetrahedron with corners a, b, c, d (m, 3): 12 (3V)^(2/3)
 * / sum of squared edge lengths, signed by the volume; 1 for a regular one. */
BW_API double bw_shape_quality(const double *a, const double *b, const double *c, const double *d);
/* Inverted (or, with floor (-) > 0, poorer than that) elements of the mesh's topology at positions,
 * node (m, node_count x 3): their number, and the worst. */
BW_API void bw_mesh_shape_check(const bw_mesh *mesh, const double *node, double floor,
                                bw_mesh_repair_report *report);
/* Moves nodes, node (m, node_count x 3), with may_move (node_count) not 0 (corners off the
 * boundary; others are left) until no element is inverted and the worst quality stops growing:
 * local untangling of the worst elements' neighbourhoods. Mid-edge nodes stay at midpoints.
 * BW_GEOMETRY, the worst element named, when it cannot; `node` is then as it was. */
BW_API bw_status bw_mesh_relax(bw_context *context, const bw_mesh *mesh, const uint8_t *may_move,
                               double *node, bw_mesh_repair_report *report);
/* New tetrahedra by TetGen in the part of the mesh with replace (element_count) not 0, at
 * positions, node (m, node_count x 3): the facets between it and the rest, and those on the
 * boundary, stay exactly. The boundary facets of `refilled` are those of `mesh`, in the same order,
 * with the same positions. Boundary and kept nodes come first. node_from (index, node_count of
 * refilled) is the old node or -1, element_from (index, element_count of refilled) the old element
 * (kept ones, in order, first) or -1 - k with k the part's component (face-connected parts of
 * `replace`, by lowest element); release both with bw_free. BW_GEOMETRY when the part's own
 * boundary intersects itself or an element outside of it is inverted, BW_EMPTY when nothing is to
 * be replaced, BW_LIMIT where time or memory run out. */
BW_API bw_status bw_mesh_refill(bw_context *context, const bw_mesh *mesh, const double *node,
                                const uint8_t *replace, bw_mesh **refilled, int32_t **node_from,
                                int32_t **element_from);

#ifdef __cplusplus
}
#endif
#endif
