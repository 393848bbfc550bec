/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* What the files of the model share. */
#ifndef BW_MODEL_INTERNAL_H
#define BW_MODEL_INTERNAL_H

#include "barwright/element.h"
#include "barwright/model.h"
#include "base/box_tree.h"

/* ---- model.c --------------------------------------------------------------------------------- */

/* Add a support as it is; measure a load and add it. Selections and arrays are retained. */
bw_status bwi_model_add_support(bw_context *context, bw_model *model, const bw_support *support);
bw_status bwi_model_add_load(bw_context *context, bw_model *model, bw_load *load);
/* Removes the supports behind the first `kept`. */
void bwi_model_drop_supports(bw_model *model, int kept);
/* Whether a support (points: may hold a node set) or a load acts on this selection. */
bw_status bwi_check_selection(bw_context *context, const bw_model *model, const bw_selection *on,
                              bool points, const char *what);

/* ---- refined.c ------------------------------------------------------------------------------- */

/* A selection of the mesh before on a refined one (or one of its topology). */
bw_status bwi_refined_selection(bw_context *context, const bw_refinement *refinement,
                                const bw_mesh *mesh, const bw_selection *on,
                                bw_selection **refined);
/* Values at nodes: interpolated, or only where a node was, 0 at the others. */
bw_status bwi_refined_array(bw_context *context, const bw_refinement *refinement,
                            const bw_mesh *from, const bw_mesh *mesh, const bw_array *array,
                            bool interpolated, bw_array **refined);

/* ---- constraint.c -------------------------------------------------------------------------- */

/* What the supports constrain at each node: an orthonormal set of directions with values. */
typedef struct bwi_constraint {
  int32_t node;
  int count;              /* 1..3 */
  double direction[3][3]; /* orthonormal */
  double value[3];        /* displacement along each */
} bwi_constraint;
/* The constrained nodes of a model, ascending. Release with bw_free. */
bw_status bwi_node_constraints(bw_context *context, const bw_model *model, int32_t *count,
                               bwi_constraint **constraint);

/* ---- bond.c, bonded.c ----------------------------------------------------------------------- */

/* Fails with `status`: the node, where it is, and what is wrong with it. */
bw_status bwi_fail_node(bw_context *context, const bw_mesh *mesh, int32_t node, bw_status status,
                        const char *what);
/* BW_UNSUPPORTED for the first bond with a preload, which `why` goes on from. */
bw_status bwi_model_refuse_preloads(bw_context *context, const bw_model *model, const char *why);
/* What bw_model_bond adds; retains the selections. Clear with bwi_bond_clear. */
bw_status bwi_bond_make(bw_context *context, const bw_selection *a, const bw_selection *b,
                        double gap, bw_bond *bond);
void bwi_bond_clear(bw_bond *bond);
/* The DOF map of a model as if it had no bonds and springs: its bodies may be free one by one. */
bw_status bwi_dof_map_apart(bw_context *context, const bw_model *model, bw_dof_map **dof_map);
/* The rigid-body modes of bodies that bonds join: how many supports and springs leave, and the body
 * that moves most in one of them (-1 without). A gap does not count. Bonds with a given preload let
 * their sides move along the normal, unless they are `locked`. */
bw_status bwi_bonded_rigid_modes(bw_context *context, const bw_model *model,
                                 const bw_dof_map *dof_map, bool locked, int *count, int32_t *body);
/* The displacements of these modes, preloads not locked (m, *count x node_count x 3), not
 * orthogonal; release with bw_free. */
bw_status bwi_bonded_rigid_fields(bw_context *context, const bw_model *model,
                                  const bw_dof_map *dof_map, int *count, double **field);
/* Motions of rigid bodies, six for each, and the sum of squares of conditions on them. */
typedef struct bwi_motions {
  const bw_dof_map *dof_map;
  int count;      /* of motions */
  int bodies;     /* of these the first, of bodies; then those of remote points and preloads */
  int first;      /* of those that rows are added to */
  double *square; /* count x count */
  double *row;    /* count: a condition, 0 between them */
  double *vector; /* count x count */
} bwi_motions;
/* Clear with bwi_motions_clear in any case. */
bw_status bwi_motions_open(bw_context *context, const bw_dof_map *dof_map, int count,
                           bwi_motions *m);
void bwi_motions_clear(bwi_motions *m);
/* row += factor d . (motions of a body at x) */
void bwi_add_motion(const bwi_motions *m, int32_t body, const double x[3], const double d[3],
                    double factor);
/* Adds the row to the squares. */
void bwi_take_row(const bwi_motions *m);
/* Conditions of supports, and of a spring: that it is left alone. */
void bwi_take_supports(const bwi_motions *m, int32_t count, const bwi_constraint *constraint);
void bwi_take_spring(const bwi_motions *m, const bw_attachment *spring);
/* Conditions of a bond; `sliding`: the place in a row of a shortening that is free, or -1. */
void bwi_take_bond(const bwi_motions *m, const bw_bond *bond, int64_t sliding);
/* How many motions fulfil the conditions, and the body that moves most in one of them (-1 without).
 */
void bwi_count_rigid_modes(const bwi_motions *m, int *count, int32_t *body);

/* ---- cyclic.c, cyclic_rigid.c ---------------------------------------------------------------- */

/* The rotation by so many sectors. */
void bwi_cyclic_rotation(const bw_cyclic *cyclic, int turns, double rotation[9]);
/* out = rotation v, which may be one; and of a place, about the axis. */
void bwi_rotate(const double rotation[9], const double v[3], double out[3]);
void bwi_cyclic_place(const bw_cyclic *cyclic, const double rotation[9], const double x[3],
                      double out[3]);
/* BW_INVALID where supports, or loads, are not the same in all sectors. */
bw_status bwi_cyclic_check_supports(bw_context *context, const bw_model *model);
bw_status bwi_cyclic_check_loads(bw_context *context, const bw_model *model);
/* 1 where displacements with so many nodal diameters are real, 2 with an imaginary part. */
int bwi_cyclic_parts(const bw_cyclic *cyclic, int diameter);
/* The phase exp(2 pi i turns / count): cosine and sine. */
void bwi_cyclic_phase(const bw_cyclic *cyclic, int64_t turns, double *c, double *s);
/* The rigid-body modes with so many nodal diameters; others as bwi_bonded_rigid_modes. */
bw_status bwi_cyclic_rigid_modes(bw_context *context, const bw_model *model,
                                 const bw_dof_map *dof_map, int diameter, int *count,
                                 int32_t *body);

/* ---- attachment.c ---------------------------------------------------------------------------- */

/* An attachment is the sum of these parts. */
int32_t bwi_attachment_parts(const bw_attachment *attachment);
/* The nodes of a part, and what they share (count x count, of the whole). */
int bwi_attachment_part(const bw_attachment *attachment, int32_t part, const int32_t **node,
                        double share[36]);
typedef void bwi_add_force(void *data, int32_t node, const double force[3]);
/* Calls `add` with forces at nodes: factor, by component, times the attachment's shares of a field
 * (node_count x 3), or where that is NULL of a constant one. */
void bwi_attachment_apply(const bw_attachment *attachment, const double factor[3],
                          const double *field, const double constant[3], bwi_add_force *add,
                          void *data);

/* ---- coupling.c ------------------------------------------------------------------------------ */

/* What bw_model_couple adds; retains the selection. Clear with bwi_coupling_clear. */
bw_status bwi_coupling_make(bw_context *context, const bw_model *model, const bw_selection *on,
                            const bw_remote_point *point, bw_coupling *coupling);
void bwi_coupling_clear(bw_coupling *coupling);

/* ---- moments.c, rigid.c, rigid_modes.c ----------------------------------------------------- */

/* The volume's moments of every body: fills body_volume, body_centre and weight (which must have
 * room) and inertia, component_count x 9: 1/V integral of |y|^2 1 - y y^T, y = x - centre. */
bw_status bwi_moments(bw_context *context, bw_dof_map *dof_map, const bw_material *material,
                      double *inertia);

/* m = integral of N and q = integral of N x (4 numbers per node) of one element. */
void bwi_element_moments(int order, const double (*x)[3], double volume, double (*moment)[4]);

/* The motions of one body that `row_count` rows of constrained components leave free. A row is
 * [direction, y x direction / length] with y from the body's centre. At most 6; fills motion[]. */
int bwi_rigid_modes(const bw_dof_map *dof_map, int32_t component, const double inertia[9],
                    double length, int64_t row_count, const double (*row)[6],
                    bw_rigid_mode *motion);

/* The motion sum a[m] r[m] of the body that it moves most, in words: to three digits, so that a
 * translation with a thousandth of a rotation is a translation. */
void bwi_describe_motion(const bw_dof_map *dof_map, const double *a, char *text, size_t size);

/* u = r(x) */
void bwi_motion_at(const bw_rigid_mode *motion, const double x[3], double u[3]);

/* ---- dof_map.c, isostatic.c ------------------------------------------------------------------ */

/* What a DOF map of an edited shape follows. */
typedef struct bwi_follow {
  /* of the same topology, or NULL: its isostatic constraints stay where they serve */
  const bw_dof_map *previous;
  int32_t subdomain_count;
  const int32_t *node_subdomain;
  const double *frame; /* subdomain_count x 9 */
} bwi_follow;
/* The DOF map of what is constrained; `material` (bodies weigh by volume) and `follow` may be NULL.
 */
bw_status bwi_number(bw_context *context, const bw_mesh *mesh, const bw_material *material,
                     int32_t constraint_count, const bwi_constraint *constraint,
                     const bwi_follow *follow, bw_dof_map **dof_map);
/* The displacement direction of component k at a node. */
void bwi_direction_of(const bw_dof_map *dof_map, int32_t node, int k, double d[3]);
/* Isostatic constraints of a body: as many components of its nodes as there are modes, such that no
 * mode vanishes at all of them. */
typedef struct bwi_isostatic_choice {
  const bw_dof_map *dof_map;
  int count;
  const bw_rigid_mode *mode; /* count */
  const double *centre;      /* of the nodes, */
  double length;             /* and their radius of gyration */
  int64_t node_count;
  const int32_t *node;
  /* Whether component k at node[at] may be constrained; `former`: and was, in a former shape. */
  bool (*open)(const void *data, int64_t at, int k, bool former);
  const void *data;
  bool former;      /* there was one */
  int64_t at[6];    /* what was chosen: places in `node`, */
  int component[6]; /* and components there */
} bwi_isostatic_choice;
/* False where the modes cannot be told apart at what may be constrained. */
bool bwi_choose_isostatic(bwi_isostatic_choice *choice);
/* Mark the isostatic constraints of a body that has `count` rigid-body modes and the radius of
 * gyration `length`. */
bw_status bwi_add_isostatic(bw_context *context, bw_dof_map *dof_map, int32_t body, int count,
                            const bw_rigid_mode *motion, double length, const bw_dof_map *previous);

/* ---- facet.c --------------------------------------------------------------------------------- */

/* The normal of a boundary facet at barycentric coordinates, of the size of twice the area that a
 * unit of parameter area covers. */
void bwi_boundary_normal(const bw_mesh *mesh, int32_t facet, const double barycentric[3],
                         double normal[3]);
/* The same at the facet's own node k: corners 0..2, mid-edge nodes 3..5. */
void bwi_boundary_normal_at(const bw_mesh *mesh, int32_t facet, int k, double normal[3]);
/* All mid-edge nodes at the midpoints of their edges (true for order 1). */
bool bwi_boundary_is_straight(const bw_mesh *mesh, int32_t facet);

/* The box of a boundary facet's corners. */
void bwi_boundary_box(const bw_mesh *mesh, int32_t facet, double *min, double *max);
/* The barycentric coordinates of the place nearest to p on the triangle of a boundary facet's
 * corners; returns the squared distance (m2). */
double bwi_boundary_nearest(const bw_mesh *mesh, int32_t facet, const double *p, double weight[3]);

/* Facets face each other where the cosine of their normals is below this. */
#define BWI_FACING (-0.5)
/* BW_INVALID where two selections of a mesh have a common node; `what` is as "the bond: a bond
 * joins". */
bw_status bwi_check_sides(bw_context *context, const bw_selection *a, const bw_selection *b,
                          const char *what);

/* ---- overlap.c ------------------------------------------------------------------------------ */

/* Where facets of two surfaces lie on each other. */
typedef struct bwi_overlaps {
  bw_context *context;
  const bw_mesh *mesh;
  const bw_selection *a;
  double gap;       /* (m) up to which facets overlap */
  double largest;   /* (m) the largest gap that was found */
  double area;      /* (m2) of the plane of the facet that was looked at last */
  double normal[3]; /* (-) of that plane, outwards */
  bwi_box_tree tree;
  double min[3], max[3]; /* (m) the box of that facet, larger by the gap */
  size_t near_count, capacity;
  int32_t *near; /* facets of side b whose boxes meet it */
  int points;
  double point[BW_QUADRATURE_POINTS][3], weight[BW_QUADRATURE_POINTS];
} bwi_overlaps;
/* A point of an overlap; products of two functions of facets are exact on plane ones. */
typedef struct bwi_overlap_point {
  int32_t facet;             /* of side b */
  double other_area;         /* (m2) of the plane of that facet */
  double at[3], other_at[3]; /* barycentric, of the facets of side a and b */
  double weight;             /* (m2) in the plane of the facet of side a */
} bwi_overlap_point;
typedef bw_status bwi_overlap_function(void *data, const bwi_overlap_point *point);
/* `gap`: below 0 a twentieth of the mean edge; `what`: as in bwi_check_sides. Clear the result with
 * bwi_overlaps_clear, also on failure. */
bw_status bwi_overlaps_open(bw_context *context, const bw_selection *a, const bw_selection *b,
                            double gap, const char *what, bwi_overlaps *overlaps);
void bwi_overlaps_clear(bwi_overlaps *overlaps);
/* Visits the overlaps of a facet of side a, those with one facet of side b one after the other. */
bw_status bwi_overlaps_of(bwi_overlaps *overlaps, int32_t facet, bwi_overlap_function *visit,
                          void *data);
/* BW_GEOMETRY: that the sides of `what` do not touch, and how far they are from each other. */
bw_status bwi_overlaps_fail_apart(bwi_overlaps *overlaps, const char *what);

/* Integration points of a facet: at most BW_QUADRATURE_POINTS. */
typedef struct bwi_boundary_point {
  double shape[6]; /* of the facet's nodes */
  double at[3];
  double area[3]; /* weight times outward vector area: sums to the facet's */
} bwi_boundary_point;
int bwi_boundary_points(const bw_mesh *mesh, int32_t facet, bwi_boundary_point *point);
/* The same of a facet of these nodes (nodes_per_facet), which may lie inside. */
int bwi_facet_points(const bw_mesh *mesh, const int32_t *node, bwi_boundary_point *point);

/* The boundary facets at each mesh node: list[start[i]] .. list[start[i + 1] - 1] are
 * facet * 8 + index of the node in the facet, ascending. */
typedef struct bwi_facet_incidence {
  int64_t *start, *list;
} bwi_facet_incidence;
bw_status bwi_facet_incidence_of(bw_context *context, const bw_mesh *mesh,
                                 bwi_facet_incidence *incidence);
void bwi_facet_incidence_clear(bwi_facet_incidence *incidence);

/* ---- loads.c --------------------------------------------------------------------------------- */

/* Fills area, resultant and moment. */
bw_status bwi_load_measure(bw_context *context, const bw_model *model, bw_load *load);
/* As bw_model_force_vector; gravity and temperature are left out when `volume` is false. */
bw_status bwi_force_vector(bw_context *context, const bw_model *model, bool volume, double *force);
/* The sum of the gravity loads of a model (m/s2). */
void bwi_sum_gravity(const bw_model *model, double gravity[3]);

/* Consistent nodal forces of one load, node_count x 3 (overwritten). */
bw_status bwi_load_force(bw_context *context, const bw_model *model, const bw_load *load,
                         double *force);

/* Consistent nodal forces of all loads on the elements that are not 0 in `only` (element_count) and
 * on their facets, node_count x 3 (overwritten). Nodal forces belong to no element. */
bw_status bwi_force_of_elements(bw_context *context, const bw_model *model, const uint8_t *only,
                                double *force);

/* ---- material_by_region.c -------------------------------------------------------------------- */

/* The material with that of the elements of a region (-1: all) replaced, in the same formulation.
 */
bw_status bwi_material_region_changed(bw_context *context, const bw_mesh *mesh,
                                      const bw_material *material, int32_t region,
                                      const bw_material *other, bw_material **changed);
/* A material on a mesh with other elements, each of which is as those of its region were. Within a
 * region it has to be the same (BW_UNSUPPORTED), and regions are known by their names. */
bw_status bwi_material_carry_by_region(bw_context *context, const bw_material *material,
                                       const bw_mesh *before, const bw_mesh *mesh,
                                       bw_material **carried);

/* ---- thermal.c ------------------------------------------------------------------------------- */

/* Whether it has loads of temperature. */
bool bwi_model_expands(const bw_model *model);
/* The coefficient of expansion (1/K) that a load of temperature has in an element. */
double bwi_expansion(const bw_model *model, const bw_load *load, int64_t element);
/* BW_INVALID where the temperature changes and no element expands; a warning for each region that
 * does not beside others that do. change (K, node_count x 1). */
bw_status bwi_check_expansion(bw_context *context, const bw_mesh *mesh, const bw_material *material,
                              const bw_array *change);
/* Adds to `stress` (Voigt) what free expansion would not have at a point of an element. */
void bwi_thermal_stress_at(const bw_model *model, int32_t element, const double at[4],
                           double stress[6]);
/* Nodal forces of one element that expands. */
void bwi_thermal_force(const bw_model *model, const bw_load *load, int32_t element,
                       double (*force)[3]);

/* ---- select.c -------------------------------------------------------------------------------- */

/* A selection of what the masks mark (facet: facet_count, node: node_count; with the nodes of the
 * facets). When that is nothing: BW_EMPTY with `what` was asked for, the mesh's box and, when
 * nearest >= 0, node `nearest` at `distance` from fulfilling it. */
bw_status bwi_selection_make(bw_context *context, const bw_mesh *mesh, const uint8_t *facet,
                             const uint8_t *node, const char *what, int32_t nearest,
                             double distance, bw_selection **selection);

/* A selection of just these facets and nodes (both ascending, copied) of another mesh whose
 * boundary has them. */
bw_status bwi_selection_copy(bw_context *context, const bw_mesh *mesh, int32_t facet_count,
                             const int32_t *facet, int32_t node_count, const int32_t *node,
                             bw_selection **selection);

/* ---- text.c ---------------------------------------------------------------------------------- */

/* A growing text in a bw_alloc block. */
typedef struct bwi_text {
  bw_context *context;
  char *bytes;
  size_t count, capacity;
  bool failed;
} bwi_text;
void bwi_text_add(bwi_text *text, const char *string);
/* A number with `digits` significant ones, the point a '.' in any locale; what is below `zero` is
 * written as 0. */
void bwi_text_number(bwi_text *text, double value, int digits, double zero);
void bwi_text_integer(bwi_text *text, int64_t value);
/* "(x, y, z)" */
void bwi_text_vector(bwi_text *text, const double v[3], int digits, double zero);
/* "(x, y, z)" into a fixed buffer. */
void bwi_vector_string(char *buffer, size_t size, const double v[3], int digits, double zero);
void bwi_number_string(char *buffer, size_t size, double value, int digits, double zero);

#endif
