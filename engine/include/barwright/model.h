/* model: selections on a mesh, supports, loads, DOF maps, rigid-body modes. */
#ifndef BARWRIGHT_MODEL_H
#define BARWRIGHT_MODEL_H

#include "barwright/io.h"
#include "barwright/material.h"
#include "barwright/matrix.h"

#ifdef __cplusplus
extern "C" {
#endif

/* ---- selections ---------------------------------------------------------------------------- */

/* Boundary facets and boundary nodes of a mesh, both ascending. A geometric selection holds the
 * boundary nodes that fulfil it and the facets all of whose corners do; one of facets has their
 * nodes. An empty selection (no node) is BW_EMPTY: the message gives the box of the mesh and
 * the distance of the nearest node. */
typedef struct bw_selection {
  bw_object object;
  const bw_mesh *mesh; /* retained */
  int32_t facet_count, node_count;
  int32_t *facet; /* (index, facet_count) boundary facets */
  int32_t *node;  /* (index, node_count) mesh nodes */
  bool node_set;  /* chosen as single nodes: supports may fix points and edges */
  /* (m2) Of a geometric selection: the area of the facets outside of it that lie along the border
   * of the shape asked for, nearer to it than a twentieth of their size. A face that is not quite
   * flat loses such facets: a support or load warns where they are more than a tenth of the
   * whole. */
  double missed_area;
} bw_selection;

/* The whole boundary. BW_EMPTY where there is none. */
BW_API bw_status bw_select_all(bw_context *context, const bw_mesh *mesh, bw_selection **selection);
/* What lies in a box, its surface included. BW_EMPTY without a node, as all selections. */
BW_API bw_status bw_select_box(bw_context *context, const bw_mesh *mesh, const double min[3],
                               const double max[3], bw_selection **selection);
/* Nodes with (x - point) . normal <= tolerance (m), 0 or more, for the normal at unit length. */
BW_API bw_status bw_select_half_space(bw_context *context, const bw_mesh *mesh,
                                      const double point[3], const double normal[3],
                                      double tolerance, bw_selection **selection);
/* Nodes with |(x - point) . normal| <= tolerance (m), 0 or more, for the normal at unit length. */
BW_API bw_status bw_select_plane(bw_context *context, const bw_mesh *mesh, const double point[3],
                                 const double normal[3], double tolerance,
                                 bw_selection **selection);
/* What lies in a ball. */
BW_API bw_status bw_select_sphere(bw_context *context, const bw_mesh *mesh, const double centre[3],
                                  double radius, bw_selection **selection);
/* Facets whose outward normal is within `angle` of `direction`. */
BW_API bw_status bw_select_normal_cone(bw_context *context, const bw_mesh *mesh,
                                       const double direction[3], double angle,
                                       bw_selection **selection);
/* Facets reached from the one nearest to `point` without crossing an edge whose facets' normals
 * differ by more than `angle`. */
BW_API bw_status bw_select_patch(bw_context *context, const bw_mesh *mesh, const double point[3],
                                 double angle, bw_selection **selection);
/* The `count` boundary nodes nearest to a point (and the facets they span): a node set. */
BW_API bw_status bw_select_nearest(bw_context *context, const bw_mesh *mesh, const double point[3],
                                   int32_t count, bw_selection **selection);
/* By masks, not 0 where chosen: facet_mask (facet_count) or node_mask (node_count); either may be
 * NULL. A mask of nodes alone makes a node set. BW_EMPTY where nothing is chosen. */
BW_API bw_status bw_select_mask(bw_context *context, const bw_mesh *mesh, const uint8_t *facet_mask,
                                const uint8_t *node_mask, bw_selection **selection);
/* The boundary facets of the elements of a region, which is an index into mesh->regions; their
 * nodes with them. BW_EMPTY where it has none. */
BW_API bw_status bw_select_region(bw_context *context, const bw_mesh *mesh, int32_t region,
                                  bw_selection **selection);
/* How two selections are combined. */
typedef enum bw_set_operation {
  BW_UNION,        /* what is in a or b */
  BW_INTERSECTION, /* what is in both */
  BW_DIFFERENCE    /* what is in a and not in b */
} bw_set_operation;
/* Facets and nodes are combined each by themselves, and the nodes of the facets that stay are kept:
 * the difference of the boundary and a foot still has the nodes on the foot's rim. BW_EMPTY where
 * nothing is left. */
BW_API bw_status bw_select_combine(bw_context *context, const bw_selection *a,
                                   const bw_selection *b, bw_set_operation operation,
                                   bw_selection **selection);
/* The same facets and nodes as a node set, for supports on points and edges. */
BW_API bw_status bw_select_node_set(bw_context *context, const bw_selection *from,
                                    bw_selection **selection);
/* The area (m2) of its facets. */
BW_API double bw_selection_area(const bw_selection *selection);
/* The centroid of its area; without facets the mean of its nodes. */
BW_API void bw_selection_centre(const bw_selection *selection, double centre[3]);
/* The mean outward normal of its facets. */
BW_API void bw_selection_normal(const bw_selection *selection, double normal[3]);

/* ---- models -------------------------------------------------------------------------------- */

/* What a load is. */
typedef enum bw_load_kind {
  BW_LOAD_PRESSURE,   /* Pa, positive pushes inwards */
  BW_LOAD_TRACTION,   /* Pa, a vector per area */
  BW_LOAD_FORCE,      /* N, the total, spread evenly over the area */
  BW_LOAD_TORQUE,     /* N m, by tangential traction proportional to the distance from `about` */
  BW_LOAD_GRAVITY,    /* m/s2 on the whole body */
  BW_LOAD_NODAL,      /* N at single nodes */
  BW_LOAD_TEMPERATURE /* K at nodes: thermal expansion of the whole body */
} bw_load_kind;

/* A load of a model. */
typedef struct bw_load {
  bw_load_kind kind;      /* by which the others are read */
  const bw_selection *on; /* retained; NULL for gravity, nodal forces and temperatures */
  double vector[3];       /* (any) in the unit of the kind; a pressure is in vector[0] */
  double about[3];        /* (m) of a torque; of a couple the centre of the area */
  const bw_array *nodal;  /* node_count x 3 (N) or x 1 (K), a copy of the model's own */
  bool by_material;       /* of temperatures: each element expands as its material does */
  double expansion;       /* (1/K) else the coefficient of linear expansion of all elements */
  double area;            /* (m2) of the selection */
  double resultant[3];    /* (N) */
  double moment[3];       /* (N m) about the origin */
} bw_load;

/* Of what plane a support is. */
typedef enum bw_symmetry {
  BW_NO_SYMMETRY,  /* of none */
  BW_SYMMETRIC,    /* of symmetry: fixed along its normal */
  BW_ANTISYMMETRIC /* of antisymmetry: one of two supports, fixed along directions in it */
} bw_symmetry;
/* A support of a model. */
typedef struct bw_support {
  const bw_selection *on; /* retained */
  bool slide;       /* constrained along `normal` only (zero normal: the facets' own normals) */
  bool fixed[3];    /* else: which directions are constrained */
  double normal[3]; /* (-) of a slide */
  double value[3];  /* (m) prescribed displacement */
  const bw_array *field; /* instead: node_count x 3 (m), a copy of the model's own; or NULL */
  bw_symmetry symmetry;  /* of a slide: whether it is of a plane of symmetry */
} bw_support;

/* What pulls the sides of a bond together, as in the shank of a bolt that was cut. */
typedef enum bw_preload_kind {
  BW_NO_PRELOAD,        /* it does not */
  BW_PRELOAD_FORCE,     /* N, positive pulls: whatever other loads act */
  BW_PRELOAD_SHORTENING /* m, by which the sides overlap along the normal */
} bw_preload_kind;

/* A bond of two surfaces whose meshes need not match: each node of side a follows nodes of side b
 * (docs/theory/joints.md). The model releases what it points to. */
typedef struct bw_bond {
  const bw_selection *a, *b;   /* retained: the side that follows, and the one that it follows */
  double asked_gap;            /* (m) what was asked for, or below 0 */
  const bw_selection *covered; /* retained: facets of both sides that are bonded over more than
                                  half of their area, or NULL */
  double area;                 /* (m2) of side a that is bonded */
  double gap;                  /* (m) the largest one between what is bonded */
  bw_preload_kind preload;     /* how it pulls */
  double pull;                 /* (any) in the unit of the kind */
  double normal[3];            /* (-) of side a, outwards, where it pulls */
  int32_t node_count;          /* of side a that follow */
  int32_t *node;               /* (index, node_count) these nodes, ascending */
  double *node_area;           /* (m2, node_count) of their functions over what is bonded */
  double *node_normal;       /* (m2, node_count x 3) of their functions times the normal of side a,
                                outwards */
  bw_sparse_matrix *follows; /* (-, node_count x the mesh's) their displacements from those of
                                      all nodes; each row sums to 1 */
} bw_bond;

/* A mass, or a spring to the ground, of a selection: spread evenly over its area, or without facets
 * over its nodes. */
typedef struct bw_attachment {
  const bw_selection *on; /* retained */
  double mass;            /* (kg) in all; 0 for a spring */
  double stiffness[3];    /* (N/m) in all, along x, y and z; 0 for a mass */
  double area;            /* (m2) of the selection */
} bw_attachment;

/* How the nodes of a face and a remote point move together. */
typedef enum bw_coupling_kind {
  BW_RIGID,      /* all nodes move as a rigid body with the point */
  BW_DISTRIBUTED /* the point moves as the face does in the mean, and the face can deform */
} bw_coupling_kind;

/* What acts on a remote point and holds it. Components are those of translations along x, y and z,
 * then of rotations about them. */
typedef struct bw_remote_point {
  bw_coupling_kind kind;  /* how the face follows */
  double at[3];           /* (m) where it is */
  double load[6];         /* (N, N m) force, and moment about the point */
  double mass;            /* (kg) 0 or more */
  double inertia[9];      /* (kg m2) about the point, symmetric and not negative; of a body on it */
  double spring[6];       /* (N/m, N m/rad) to the ground, 0 or more */
  bool fixed[6];          /* which components have a prescribed value */
  double displacement[6]; /* (m, rad) these values */
} bw_remote_point;

/* A coupling of a face, or of a node set, with a remote point (docs/theory/joints.md). The model
 * releases what it points to. */
typedef struct bw_coupling {
  const bw_selection *on; /* retained */
  bw_remote_point point;  /* as given */
  double area;            /* (m2) of the selection */
  double reach;           /* (m) radius of gyration of its nodes about the point */
  int32_t node_count;     /* nodes that are coupled */
  int32_t *node;          /* (index, node_count) these nodes, ascending */
  double *mean;           /* (-, 1/m, 6 x 3 node_count) displacement and rotation of the point from
                             the displacements of the nodes */
} bw_coupling;

/* The cyclic symmetry of a sector: the whole is `count` of them about an axis
 * (docs/theory/symmetry.md). */
typedef struct bw_cyclic {
  bw_object object;
  const bw_selection *low, *high; /* retained: the face that turns into the other one */
  int count;                      /* of sectors */
  double point[3];                /* (m) on the axis */
  double axis[3];                 /* (-) of length 1: by 2 pi / count about it low becomes high */
  double distance;                /* (m) the largest one between nodes that match */
  int32_t axis_count;             /* of nodes on the axis, which both faces have */
  int32_t *partner; /* (index, node_count) of a node of the high face: its node of the low face, on
                       the axis itself; -1 of others */
} bw_cyclic;

/* A mesh with material, supports, loads, bonds, attachments and couplings. Mutable: its object's
 * revision grows with every one added, and when its material is turned. */
typedef struct bw_model {
  bw_object object;
  const bw_mesh *mesh;         /* retained */
  const bw_material *material; /* retained */
  int load_count, support_count, bond_count, attachment_count, coupling_count;
  bw_load *load;             /* load_count loads */
  bw_support *support;       /* support_count supports */
  bw_bond *bond;             /* bond_count bonds */
  bw_attachment *attachment; /* attachment_count masses and springs */
  bw_coupling *coupling;     /* coupling_count couplings with remote points */
  const bw_cyclic *cyclic;   /* retained; NULL: it is the whole */
} bw_model;
/* Whether it has bonds, attachments, couplings or a cyclic symmetry: the functions of joint.h know
 * its equations. Harmonic responses and response spectra (dynamics.h), transients
 * (transient.h) and the worst case take those of a model that is no sector. Other functions that
 * need its equations refuse it. */
static inline bool bw_model_joined(const bw_model *model) {
  return model->bond_count > 0 || model->attachment_count > 0 || model->coupling_count > 0 ||
         model->cyclic;
}

/* BW_UNSUPPORTED for a joined model, with a sentence that says what joins it: what needs the
 * equations otherwise than the functions of joint.h asks this before its work. */
BW_API bw_status bw_model_refuse_joints(bw_context *context, const bw_model *model);

/* The facets that are no outer surface of the body: planes of symmetry and antisymmetry, what bonds
 * cover, and the faces between sectors. *cuts: a selection, or NULL where there are none. */
BW_API bw_status bw_model_cuts(bw_context *context, const bw_model *model, bw_selection **cuts);

/* The material of a mesh with regions, part (mesh->region_count) for each of them in order. One
 * material for all where the parts are one. BW_INVALID for a mesh without regions, and for a region
 * of which the part is NULL. */
BW_API bw_status bw_material_by_region(bw_context *context, const bw_mesh *mesh,
                                       const bw_material *const *part, bw_material **material);
/* A model without supports and loads. BW_INVALID for a material with parts (material.h) that is of
 * another mesh, BW_GEOMETRY where bodies of the mesh overlap in more than a tenth of the smaller
 * one (bw_mesh_overlaps_find). Bodies that overlap visibly, by more than a twentieth of an edge,
 * give a warning. */
BW_API bw_status bw_model_create(bw_context *context, const bw_mesh *mesh,
                                 const bw_material *material, bw_model **model);
/* Gives the elements of a region (index; -1: all elements) another material, without parts. Their
 * formulation stays. BW_INVALID for a region that is not there and a material with parts. */
BW_API bw_status bw_model_set_material(bw_context *context, bw_model *model, int32_t region,
                                       const bw_material *material);
/* Turns the model's material by element (bw_material_rotated_by_element): those of group of_element
 * (index, element_count) by the rotation (-, group_count x 9) of their group. */
BW_API bw_status bw_model_rotate_material(bw_context *context, bw_model *model, int32_t group_count,
                                          const int32_t *of_element, const double *rotation);
/* The formulation of the model's elements; BW_INVALID for B-bar on linear elements. */
BW_API bw_status bw_model_formulate(bw_context *context, bw_model *model,
                                    bw_formulation formulation);

/* A support or load on a selection without a facet is BW_EMPTY, but for a support on a node set:
 * the nodes that a geometric selection finds on a face that is not quite flat are points, and the
 * stress at points has no limit. */

/* Constrains all displacements of a selection. BW_EMPTY as above. */
BW_API bw_status bw_model_fix(bw_context *context, bw_model *model, const bw_selection *on);
/* Constrains the displacements of a selection along a normal; NULL: along that of each node's
 * facets. BW_EMPTY as above. */
BW_API bw_status bw_model_slide(bw_context *context, bw_model *model, const bw_selection *on,
                                const double normal[3]);
/* Makes a plane face a plane of symmetry (the displacement along its normal is 0) or of
 * antisymmetry (those in the plane are 0). The supports are slides along the normal of the face, or
 * along two directions across it. Loads, mass, reactions and modes are those of the part that is
 * modelled. BW_EMPTY for a selection without a facet, BW_GEOMETRY for one that is not plane (with
 * the deviation), BW_INVALID for another kind. */
BW_API bw_status bw_model_symmetry(bw_context *context, bw_model *model, const bw_selection *on,
                                   bw_symmetry kind);
/* Prescribes displacements of value (m), NULL for 0, in the global directions that are `fixed`.
 * BW_INVALID without one, BW_EMPTY as above. */
BW_API bw_status bw_model_prescribe(bw_context *context, bw_model *model, const bw_selection *on,
                                    const bool fixed[3], const double value[3]);
/* Adds an acceleration (m/s2) of the whole body. BW_INVALID for a material without density. */
BW_API bw_status bw_model_gravity(bw_context *context, bw_model *model,
                                  const double acceleration[3]);
/* Adds a pressure, positive inwards. BW_EMPTY as above. */
BW_API bw_status bw_model_pressure(bw_context *context, bw_model *model, const bw_selection *on,
                                   double pressure);
/* Adds a traction (Pa), a force for each area in a global direction. BW_EMPTY as above. */
BW_API bw_status bw_model_traction(bw_context *context, bw_model *model, const bw_selection *on,
                                   const double traction[3]);
/* Adds a total force, spread evenly over the area. BW_EMPTY as above, BW_GEOMETRY for facets
 * without area. */
BW_API bw_status bw_model_force(bw_context *context, bw_model *model, const bw_selection *on,
                                const double force[3]);
/* Adds a torque (N m). With `about` (m) NULL: a couple, which has this moment about every point and
 * no net force. About a point: the traction turns about it, and has a net force where the area's
 * centre is elsewhere. BW_EMPTY as above, BW_GEOMETRY for facets without a lever about it. */
BW_API bw_status bw_model_torque(bw_context *context, bw_model *model, const bw_selection *on,
                                 const double torque[3], const double about[3]);
/* Adds forces at nodes, rows of an array of node_count x 3 (N), which is copied. */
BW_API bw_status bw_model_nodal_forces(bw_context *context, bw_model *model, const bw_array *force);
/* As bw_model_prescribe in the directions that are `fixed`, each node with its own value: rows of
 * `field`, node_count x 3 (m), which is copied. BW_EMPTY as above. */
BW_API bw_status bw_model_prescribe_field(bw_context *context, bw_model *model,
                                          const bw_selection *on, const bool fixed[3],
                                          const bw_array *field);
/* Adds a change of temperature at the nodes, an array of node_count x 1 (K), which is copied, of a
 * body with a coefficient of *expansion (1/K) alike in all directions; NULL: that of each element's
 * material. Stresses of such a model: bw_static_stress (analysis.h). */
BW_API bw_status bw_model_temperature(bw_context *context, bw_model *model, const bw_array *change,
                                      const double *expansion);
/* Bonds two surfaces of the mesh: side a follows side b where they touch, or are no more than `gap`
 * (m) apart; below 0: a twentieth of the mean edge of the finer side. Constant stress passes
 * through a plane bond exactly. bw_model_joined says what knows such a model. BW_EMPTY for a side
 * without a facet, BW_INVALID for a node on both sides and a gap that is no number, BW_GEOMETRY for
 * sides that do not touch (with the distance) and facets of side a that side b hardly covers;
 * those of bw_model_preload. */
BW_API bw_status bw_model_bond(bw_context *context, bw_model *model, const bw_selection *a,
                               const bw_selection *b, double gap);
/* The same, with the same `gap` (m) and statuses, and a preload across the section, which is plane:
 * side a moves by the shortening against side b along its outward normal, all nodes alike. `pull`
 * (any) is in the unit of the kind. BW_EMPTY for a side without a facet, BW_INVALID also for a
 * `pull` that is no number and a preload of 0 or below, BW_GEOMETRY also for a section that is not
 * plane to a thousandth, BW_UNSUPPORTED for a sector of cyclic symmetry. */
BW_API bw_status bw_model_preload(bw_context *context, bw_model *model, const bw_selection *a,
                                  const bw_selection *b, double gap, bw_preload_kind kind,
                                  double pull);
/* Removes all bonds. */
BW_API void bw_model_clear_bonds(bw_model *model);
/* Attaches a mass (kg), spread evenly over the area of a selection, or of a node set without facets
 * over its nodes. It has no stiffness. Gravity acts on it, and modes move it. BW_EMPTY as for
 * supports, BW_INVALID for a mass that is not positive, BW_GEOMETRY for facets without area.
 * bw_model_joined says what knows such a model. */
BW_API bw_status bw_model_attach_mass(bw_context *context, bw_model *model, const bw_selection *on,
                                      double mass);
/* Attaches springs to the ground in the same way: stiffness (N/m) in all, along x, y and z, 0 or
 * more. BW_INVALID where one is negative or all are 0, BW_EMPTY as for supports, BW_GEOMETRY for
 * facets without area. */
BW_API bw_status bw_model_attach_spring(bw_context *context, bw_model *model,
                                        const bw_selection *on, const double stiffness[3]);
/* Removes all masses and springs. */
BW_API bw_status bw_model_clear_attachments(bw_context *context, bw_model *model);
/* Couples the nodes of a face, or of a node set without facets, with a remote point, which is
 * copied. Gravity acts on its mass. bw_model_joined says what knows such a model. BW_EMPTY as for
 * supports.
 * BW_INVALID for a node in two rigid couplings, numbers that are not finite, springs and masses
 * below 0, and an inertia that is not symmetric or negative. BW_GEOMETRY for facets without area,
 * and for nodes on one line: they leave the rotation about it undefined, and for a point farther
 * from the face than 10000 times the smallest radius of gyration of the face. BW_UNSUPPORTED for a
 * sector of cyclic symmetry. */
BW_API bw_status bw_model_couple(bw_context *context, bw_model *model, const bw_selection *on,
                                 const bw_remote_point *point);
/* Removes all couplings. */
BW_API bw_status bw_model_clear_couplings(bw_context *context, bw_model *model);
/* Makes the body one of `count` equal sectors about an axis through `point` (m) along `axis` (-, of
 * any length but 0). Its face `low`, turned by 2 pi / count, is its face `high`: nodes and facets
 * match one to one. The axis may look either way. Loads, masses and results are those of the
 * sector. joint.h has static solutions and modes of such a model; other functions refuse one where
 * they need its equations. BW_EMPTY for a selection without a facet, BW_INVALID for fewer than two
 * sectors, for an axis without direction and where the model has a cyclic symmetry, BW_GEOMETRY for
 * faces that do not match (with angle or distance), and an axis that passes elements away from
 * their edges, BW_UNSUPPORTED for a model with preloads or couplings. */
BW_API bw_status bw_model_cyclic(bw_context *context, bw_model *model, const bw_selection *low,
                                 const bw_selection *high, int count, const double axis[3],
                                 const double point[3]);
/* Removes the cyclic symmetry. */
BW_API void bw_model_clear_cyclic(bw_model *model);
/* A place where stresses, or fluxes of heat, are recovered: a node, as one of the materials around
 * it sees it. */
typedef struct bw_stress_point {
  int32_t node;                /* (index) */
  int32_t next;                /* (index) another point at the node, of another material, or -1 */
  const bw_material *material; /* the elements', unrotated; lives as long as the material */
} bw_stress_point;
/* All places where stresses are recovered. The first node_count points are the nodes themselves. On
 * an interface between materials a node has one more point behind these for each further
 * material. */
typedef struct bw_stress_points {
  int32_t count;          /* of points; the nodes' where there is one material */
  bw_stress_point *point; /* (count) or NULL: there is one material */
  int32_t *of_corner;     /* (index, element_count x nodes_per_element) the points of the elements'
                             nodes, or NULL: they are the nodes */
} bw_stress_points;
/* The points of a material's mesh; release them with bw_stress_points_clear. BW_INVALID for a
 * material of another mesh, BW_LIMIT for more than 2^31 - 1. */
BW_API bw_status bw_stress_points_create(bw_context *context, const bw_mesh *mesh,
                                         const bw_material *material, bw_stress_points *points);
BW_API void bw_stress_points_clear(bw_stress_points *points);
/* The point of an element's a-th node. */
static inline int32_t bw_stress_point_of(const bw_stress_points *points, const bw_mesh *mesh,
                                         int64_t element, int a) {
  int64_t corner = element * mesh->nodes_per_element + a;
  return points->of_corner ? points->of_corner[corner] : mesh->element[corner];
}
/* The node of point i. */
static inline int32_t bw_stress_point_node(const bw_stress_points *points, int32_t i) {
  return points->point ? points->point[i].node : i;
}
/* Whether an element around the node of point i is of its material. */
static inline bool bw_stress_point_has(const bw_stress_points *points, int32_t i,
                                       const bw_material *material, int64_t element) {
  return !points->point || points->point[i].material == bw_material_unrotated(material, element);
}

/* Stress that free expansion would not have, C : (alpha dT 1), summed over the temperature loads:
 * stress (Pa, count x 6) at points, or where `at` is NULL means of elements (element_count x 6). */
BW_API bw_status bw_model_thermal_stress(bw_context *context, const bw_model *model,
                                         const bw_stress_points *at, double *stress);
/* The same material, supports and loads on a mesh of the same topology (an edited shape):
 * selections keep their facets and nodes, so that supports and loads follow the surface. Areas,
 * resultants and normals are those of the new shape; forces and gravity keep their directions.
 * BW_INVALID for another topology. BW_GEOMETRY for a force on facets that have lost their area,
 * BW_UNSUPPORTED as bw_model_transferred. */
BW_API bw_status bw_model_moved(bw_context *context, const bw_model *model, const bw_mesh *mesh,
                                bw_model **moved);
/* The same on a mesh whose boundary facets are those of the model's mesh in the same order (a
 * refilled one), with the old node of each one in node_from (index, node_count), or -1. Loads on
 * inner nodes that are gone, temperatures that vary and a material that differs within a region of
 * the mesh are BW_UNSUPPORTED. */
BW_API bw_status bw_model_transferred(bw_context *context, const bw_model *model,
                                      const bw_mesh *mesh, const int32_t *node_from,
                                      bw_model **transferred);
/* The same on a refined mesh (bw_mesh_refine of the model's mesh) or on one of its topology that
 * was moved: facets of supports and loads become the facets inside of them, fields at nodes are
 * interpolated. `also`: further selections, carried the same way into also_refined (the caller's
 * references). BW_UNSUPPORTED as bw_model_transferred. */
BW_API bw_status bw_model_refined(bw_context *context, const bw_model *model,
                                  const bw_refinement *refinement, const bw_mesh *mesh,
                                  int also_count, const bw_selection *const *also,
                                  bw_selection **also_refined, bw_model **refined);
/* Removes all supports. */
BW_API void bw_model_clear_supports(bw_model *model);
/* Removes all loads. */
BW_API void bw_model_clear_loads(bw_model *model);
/* Consistent nodal forces of all loads, force (N, node_count x 3). BW_GEOMETRY for a load on facets
 * without area or lever. */
BW_API bw_status bw_model_force_vector(bw_context *context, const bw_model *model, double *force);
/* Several lines of *text on mesh, material, each support and each load with area and resultant.
 * Release it with bw_free. */
BW_API bw_status bw_model_describe(bw_context *context, const bw_model *model, char **text);
/* As an .inp for CalculiX; `modes` > 0: a frequency step, else a static one, in which isostatic
 * constraints hold a free body: a warning says so. BW_UNSUPPORTED for an oblique slide at a node
 * that is moved, for temperatures with an expansion of their own beside those of the material, and
 * for joints that a deck cannot have; BW_UNCONSTRAINED for joined bodies in a static step. */
BW_API bw_status bw_model_write_inp(bw_context *context, const bw_model *model, const char *path,
                                    int modes);

/* ---- rigid-body motions and unknowns --------------------------------------------------------- */

/* A rigid-body motion u(x) = translation + rotation x (x - centre) of one body (component). For a
 * rotation the centre is the point of its axis nearest to the body's centre of volume, and the
 * translation is the part along the axis (zero, unless the supports leave a screw motion). */
typedef struct bw_rigid_mode {
  int32_t component; /* (index) the body, or -1: all bodies, joined, move by it as one */
  double centre[3];
  double translation[3]; /* (m) per unit of the mode */
  double rotation[3];    /* (rad) per unit of the mode */
  char text[256]; /* "translation along (0, 0, 1)", "rotation about the axis through (...) along
                     (...)" */
} bw_rigid_mode;

/* Which unknowns there are. At every node the three displacement components are taken in a frame
 * (the global one, unless an oblique slide needs another); each is an unknown, prescribed (often to
 * zero), or an isostatic constraint. A body whose supports leave rigid-body motions free has as
 * many isostatic constraints as there are rigid-body modes, at well-chosen components, which adds
 * no stress when the load is balanced.
 *
 * The rigid-body modes are orthonormal in the inner product of their body
 *     <r, s> = 1/V integral of r . s over the body = r^T W s,
 * where V is the body's volume and W = M/V its consistent mass matrix at unit total mass. So a
 * translation moves by 1 m, and a rotation turns by 1/radius of gyration. With R the motions as
 * columns, R^T W R = 1: f - W R (R^T f) is f balanced by inertia, u - R (R^T W u) is u free of
 * rigid-body motion. */
typedef struct bw_dof_map {
  bw_object object;
  const bw_mesh *mesh; /* retained */
  int32_t unknown_count;
  int32_t *unknown;  /* (index, node_count x 3) the unknown, or -1 */
  uint8_t *state;    /* (node_count x 3) bw_dof_state */
  int32_t *frame_of; /* (index, node_count) row of `frame`, or -1 for the global frame */
  int32_t frame_count;
  double *frame;             /* (-, frame_count x 9) rows are the frame's directions */
  double *value;             /* (m, node_count x 3) prescribed value in the frame; 0 elsewhere */
  bool prescribed;           /* some value is not zero */
  int32_t rigid_mode_count;  /* unconstrained rigid-body modes of all bodies, body by body */
  bw_rigid_mode *rigid_mode; /* rigid_mode_count modes */
  int32_t *rigid_mode_start; /* (index, component_count + 1) the modes of each body */
  int32_t *body_start;       /* (index, component_count + 1) the nodes of each body in body_node */
  int32_t *body_node;        /* (index, node_count) ascending for each body */
  double *body_volume;       /* (m3, component_count) */
  double *body_centre;       /* (m, component_count x 3) centres of volume */
  double *weight; /* (any, node_count x 4) integral of the shape function over V (-), and of the
                     shape function times (x - body centre) over V (m): all that W R needs. NULL
                     without rigid-body modes */
} bw_dof_map;
/* What a displacement component of a node is. */
typedef enum bw_dof_state {
  BW_DOF_UNKNOWN,    /* an unknown of the equations */
  BW_DOF_PRESCRIBED, /* given by a support */
  BW_DOF_ISOSTATIC   /* zero, in place of a rigid-body mode */
} bw_dof_state;
/* From a model's supports. Contradicting prescriptions are BW_INVALID, more than 2^31 - 1
 * components BW_LIMIT, a model with bonds BW_UNSUPPORTED. */
BW_API bw_status bw_dof_map_create(bw_context *context, const bw_model *model,
                                   bw_dof_map **dof_map);
/* Without any support: every body unconstrained. BW_LIMIT as bw_dof_map_create. */
BW_API bw_status bw_dof_map_unconstrained(bw_context *context, const bw_mesh *mesh,
                                          bw_dof_map **dof_map);
/* The DOF map of an edited model, with the unknowns of `previous` (its isostatic constraints too,
 * unless they have become poor on the new shape). The unknowns of nodes that no support constrains,
 * or that are constrained in all directions, are taken in the frame of their subdomain:
 * node_subdomain (index, node_count), -1: none, frame (-, subdomain_count x 9), rows are
 * directions. Isostatic constraints turn with these. Nodes constrained in some directions keep the
 * frame of their support. The frames of the subdomains are the last subdomain_count rows of the DOF
 * map's. previous may be NULL. *same says whether state and unknown are those of `previous`. */
BW_API bw_status bw_dof_map_follow(bw_context *context, const bw_model *model,
                                   const bw_dof_map *previous, int32_t subdomain_count,
                                   const int32_t *node_subdomain, const double *frame, bool *same,
                                   bw_dof_map **dof_map);
/* Whether the loads reach the body, before a static solution: BW_INVALID when the supports fix the
 * whole boundary at zero (unless temperatures or nodal forces act), or when a load acts on
 * supports only. A load of which a part of the area lies on supports is a warning with the
 * fraction; so is any where some prescribed displacement is not zero. A model on which nothing acts
 * is a warning, too. */
BW_API bw_status bw_model_check_absorbed(bw_context *context, const bw_model *model,
                                         const bw_dof_map *dof_map);
/* The rigid-body modes as *text, for messages: "3 rigid-body modes are unconstrained: ...". Release
 * it with bw_free. */
BW_API bw_status bw_dof_map_describe_rigid_modes(bw_context *context, const bw_dof_map *dof_map,
                                                 char **text);

/* Force and displacement are node_count x 3 in global directions; a has rigid_mode_count numbers.
 * These allocate nothing and may run from any thread. */
/* a (any, rigid_mode_count) = R^T f for force (any, node_count x 3), a plain sum over the nodes. */
BW_API void bw_rigid_modes_dot(const bw_dof_map *dof_map, const double *force, double *a);
/* a (any, rigid_mode_count) = R^T W u for displacement (m, node_count x 3). */
BW_API void bw_rigid_modes_measure(const bw_dof_map *dof_map, const double *displacement,
                                   double *a);
/* u += R a for displacement (m, node_count x 3) and a (any, rigid_mode_count). */
BW_API void bw_rigid_modes_add(const bw_dof_map *dof_map, const double *a, double *displacement);
/* f = W R a for a (any, rigid_mode_count): force (any, node_count x 3), overwritten. */
BW_API void bw_rigid_modes_weighted(const bw_dof_map *dof_map, const double *a, double *force);
/* f -= W R (R^T f): force (N, node_count x 3) balanced by inertia. */
BW_API void bw_rigid_modes_balance(const bw_dof_map *dof_map, double *force);
/* u -= R (R^T W u): displacement (m, node_count x 3) without rigid-body motion. */
BW_API void bw_rigid_modes_remove(const bw_dof_map *dof_map, double *displacement);

#ifdef __cplusplus
}
#endif
#endif
