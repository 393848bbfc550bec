/* analysis: stresses, error estimate, weak regions, worst loads, brute force, drops. */
#ifndef BARWRIGHT_ANALYSIS_H
#define BARWRIGHT_ANALYSIS_H

#include "barwright/lp.h"
#include "barwright/shape.h"

#ifdef __cplusplus
extern "C" {
#endif

/* ---- stress fields: tensors xx yy zz yz zx xy ---------------------------------------------- */

/* Mean stress of every element (exact for tet4; the volume mean for tet10) under displacement (m,
 * node_count x 3): stress (Pa, element_count x 6). */
BW_API bw_status bw_element_stress(bw_context *context, const bw_mesh *mesh,
                                   const bw_material *material, const double *displacement,
                                   double *stress);
/* Stress at nodes under displacement (m, node_count x 3): the stresses of the elements around a
 * node, each at the node itself, averaged by volume: stress (Pa, node_count x 6). Where materials
 * meet, stresses are averaged in each of them, and that with the largest von Mises stress counts.
 */
BW_API bw_status bw_nodal_stress(bw_context *context, const bw_mesh *mesh,
                                 const bw_material *material, const double *displacement,
                                 double *stress);
/* Stress of a static solution, that of thermal expansion subtracted: stress (Pa, node_count x 6) as
 * bw_nodal_stress with on_nodes, else (element_count x 6) as bw_element_stress. */
BW_API bw_status bw_static_stress(bw_context *context, const bw_static *result, bool on_nodes,
                                  double *stress);
/* The same of displacement (m, node_count x 3) at points, stress (Pa, points->count x 6): where
 * materials meet, those on each side. */
BW_API bw_status bw_point_stress(bw_context *context, const bw_mesh *mesh,
                                 const bw_material *material, const double *displacement,
                                 const bw_stress_points *points, double *stress);
/* The same of a static solution, stress (Pa, points->count x 6), that of thermal expansion
 * subtracted. */
BW_API bw_status bw_static_point_stress(bw_context *context, const bw_static *result,
                                        const bw_stress_points *points, double *stress);
/* What two regions exert on each other. */
typedef struct bw_interface_force {
  double area;      /* (m2) of the interface, 0 where the regions do not touch */
  double force[3];  /* (N) on region a; region b has the opposite one */
  double moment[3]; /* (N m) the same about the origin */
  int32_t shared;   /* (count) nodes of the interface that a third region, a support or a joint
                       holds, too */
  double imbalance; /* (-) at the other nodes, the sum of the sizes of what the two regions lack to
                       equilibrium over that of their forces */
} bw_interface_force;
/* Tractions of region b on region a, indices into mesh->regions, from the nodal forces of the
 * elements of both (docs/theory/elements.md#interface-tractions). At nodes of their interface, 0
 * elsewhere: traction (Pa, node_count x 3), normal (Pa, node_count) positive in tension, shear (Pa,
 * node_count) the size of the rest. Mid-edge nodes have the means of their ends. BW_INVALID for
 * regions that are none, and for a model that has changed since, BW_UNSUPPORTED for a
 * sector of cyclic symmetry and for an instant of a transient with other loads than its model. */
BW_API bw_status bw_interface_traction(bw_context *context, const bw_static *result, int32_t a,
                                       int32_t b, double *traction, double *normal, double *shear,
                                       bw_interface_force *sum);
/* Strain energy of every element under displacement (m, node_count x 3): energy (J,
 * element_count). */
BW_API bw_status bw_element_energy(bw_context *context, const bw_mesh *mesh,
                                   const bw_material *material, const double *displacement,
                                   double *energy);
/* Row-wise over `count` tensors, stress (Pa, count x 6): von_mises (Pa, count). */
BW_API bw_status bw_von_mises_field(bw_context *context, int64_t count, const double *stress,
                                    double *von_mises);
/* Principal stresses of tensors, stress (Pa, count x 6): values (Pa, count x 3), descending, and
 * directions (-, count x 9), unit vectors in rows, or NULL. */
BW_API bw_status bw_principal_field(bw_context *context, int64_t count, const double *stress,
                                    double *values, double *directions);
/* max_i |sigma_i| (worst-case eq. 6) of tensors, stress (Pa, count x 6): value (Pa, count). */
BW_API bw_status bw_max_principal_field(bw_context *context, int64_t count, const double *stress,
                                        double *value);
/* bw_material_utilisation of tensors, stress (Pa, count x 6): value (-, count). With a material
 * that has parts they are those of all elements, in order (BW_INVALID else). */
BW_API bw_status bw_utilisation_field(bw_context *context, const bw_material *material,
                                      int64_t count, const double *stress, double *value);
/* Zienkiewicz and Zhu's estimate for displacement (m, node_count x 3): error energy of every
 * element against the averaged nodal stress, element (J, element_count), which may be NULL.
 * *relative (-) is the estimated energy-norm error over the energy norm of the solution. For tet10
 * it has the factor 1.5 of the agile paper (section 8), without which it is too small. */
BW_API bw_status bw_error_estimate(bw_context *context, const bw_mesh *mesh,
                                   const bw_material *material, const double *displacement,
                                   double *element, double *relative);

/* Superconvergent patch recovery (Zienkiewicz and Zhu 1992): at every corner a polynomial of the
 * elements' order fits the stresses inside of the elements around it; mid-edge nodes take the mean
 * of both ends. Under displacement (m, node_count x 3): stress (Pa, node_count x 6). Where
 * materials meet, elements of each are fitted by themselves, and the one with the largest von Mises
 * stress counts. BW_INVALID and BW_LIMIT as bw_stress_points_create. */
BW_API bw_status bw_recovered_stress(bw_context *context, const bw_mesh *mesh,
                                     const bw_material *material, const double *displacement,
                                     double *stress);
/* The recovered error in a goal: the integral over every element, element (any, element_count), of
 * e_u . D^-1 e_z with e = N sigma* - sigma of a primal and a dual displacement, primal (m,
 * node_count x 3) and dual (any, node_count x 3), sigma* as bw_recovered_stress, by the element's
 * material. Their sum estimates J(u) - J(u_h) for the functional J that z is the dual of
 * (docs/theory/error_control.md). */
BW_API bw_status bw_error_product(bw_context *context, const bw_mesh *mesh,
                                  const bw_material *material, const double *primal,
                                  const double *dual, double *element);
/* Nodal forces, force (any, node_count x 3), of the functional sum over i of weight_i .
 * sigma(node_i), its derivative by the displacement, with sigma as bw_nodal_stress, node (index,
 * count) and weight (any, count x 6). BW_UNSUPPORTED for a node between two materials. */
BW_API bw_status bw_stress_functional(bw_context *context, const bw_mesh *mesh,
                                      const bw_material *material, int64_t count,
                                      const int32_t *node, const double *weight, double *force);

/* By how much the Rayleigh quotient of a shape (any, node_count x 3) is too high, *relative (-) to
 * it, by its recovered stress (docs/theory/error_control.md). */
BW_API bw_status bw_shape_error(bw_context *context, const bw_mesh *mesh,
                                const bw_material *material, const double *shape, double *relative);
/* By how much each eigenvalue is too high, relative (-, modes->count) to it, by recovered stress
 * (docs/theory/error_control.md). BW_INVALID for Laplacian modes, BW_UNSUPPORTED for a sector's. */
BW_API bw_status bw_modes_error(bw_context *context, const bw_modes *modes, double *relative);
/* The nodal forces of a displacement (m, node_count x 3), K u: force (N, node_count x 3). */
BW_API bw_status bw_internal_force(bw_context *context, const bw_mesh *mesh,
                                   const bw_material *material, const double *displacement,
                                   double *force);
/* The largest concave angle, *kink (rad), by which the normals of boundary facets differ at the
 * nodes of the facets around a boundary node, of those below limit (rad). It is 0 on flat and on
 * resolved round faces, and at inner nodes; where facets represent a round face it is the angle
 * between them. */
BW_API bw_status bw_boundary_kink(bw_context *context, const bw_mesh *mesh, int32_t node,
                                  double limit, double *kink);

/* Stress at the three corners of every facet, stress (Pa, facet_count x 3 x 6), by the displacement
 * (m, node_count x 3) of the facet's own nodes and the traction that acts on the surface
 * (docs/theory/breaking_force.md). force (N, node_count x 3): the nodal forces of that traction,
 * without reactions of supports; NULL: none. */
BW_API bw_status bw_surface_stress(bw_context *context, const bw_mesh *mesh,
                                   const bw_material *material, const double *displacement,
                                   const double *force, double *stress);
/* The mean of a field of facets' corners, value (any, facet_count x 3 x columns), linear between
 * them, over the boundary that connected facets reach within `radius` of each boundary node,
 * weighted by area and 1 - (distance / radius)^2: mean (any, node_count x columns). Where the mesh
 * is too coarse for the radius, the mean by area over the facets around the node. Facets that the
 * DOF map (may be NULL) constrains in all directions do not count; 0 at inner nodes and inside of
 * such supports. */
BW_API bw_status bw_surface_mean(bw_context *context, const bw_mesh *mesh,
                                 const bw_dof_map *dof_map, double radius, int columns,
                                 const double *value, double *mean);

/* ---- how stresses change with the shape (agile, section 7) ----------------------------------- */

/* Solves K x = f for `count` right-hand sides, force (any, count x node_count x 3), displacement
 * (any, count x node_count x 3): bw_system_solve or bw_incremental_system_solve. */
typedef bw_status bw_solve_function(void *data, bw_context *context, int64_t count,
                                    const double *force, double *displacement);
/* The nodal von Mises stress, von_mises (Pa, count), as bw_static_stress and bw_von_mises_field
 * give it under displacement (m, node_count x 3), at nodes, node (index, count). Its derivative by
 * every corner node's position, gradient (Pa/m, count x node_count x 3), takes one adjoint solve
 * each: d sigma = gradient : d x along any change of shape that keeps edges straight. The
 * contributions of mid-edge nodes are added to those of their edge's ends. Loads count too: those
 * on areas, and gravity, change with the shape. For a free body the balance by inertia is part of
 * it. Where the stress is zero, so is its gradient. Prescribed displacements do not change. wanted
 * (node_count), which may be NULL: which nodes will move; elsewhere the gradient is of no meaning.
 * Straight elements only. BW_UNSUPPORTED: a body of several materials, a slide along the surface's
 * own normals, a body with supports whose load acts on a rigid-body mode, the B-bar formulation. */
BW_API bw_status bw_von_mises_gradient(bw_context *context, const bw_model *model,
                                       const bw_dof_map *dof_map, const double *displacement,
                                       bw_solve_function *solve, void *data, int64_t count,
                                       const int32_t *node, const uint8_t *wanted,
                                       double *von_mises, double *gradient);

/* slope (any) . m, with m the bw_surface_mean of bw_surface_stress around a boundary node, as a
 * functional of the displacement: its nodal forces, force (any, node_count x 3), and its derivative
 * by the nodal forces of the load, by_force (any, node_count x 3); see docs/theory/strengthen.md.
 * BW_INVALID for inner nodes. */
BW_API bw_status bw_patch_functional(bw_context *context, const bw_mesh *mesh,
                                     const bw_material *material, const bw_dof_map *dof_map,
                                     double radius, int32_t node, const double slope[6],
                                     double *force, double *by_force);
/* A solution and its adjoint for the mean stress of a patch; all is borrowed. */
typedef struct bw_patch_state {
  const bw_dof_map *dof_map;             /* supports; may be NULL */
  int32_t node;                          /* in the middle of the patch */
  double radius;                         /* (m) of the patch */
  double slope[6];                       /* (-) by the six components of the mean stress */
  const double *displacement;            /* (m, node_count x 3) u */
  const double *adjoint;                 /* (any, node_count x 3) lambda */
  const struct bw_pressure_basis *basis; /* without friction */
  const double *pressure;                /* (Pa, basis->count) p */
  double price;                          /* (any) multiplier of the total of the pressure */
} bw_patch_state;
/* The derivative, gradient (any, node_count x 3), of
 *     slope . m(u, G p) + lambda . (G p - K u) - price * integral of p
 * by the position of every node, mid-edge ones too, with nodal values of u and lambda and all p
 * constant. With K u = G p, K lambda = bw_patch_functional less the rigid-body motion of the
 * balance's multipliers, it is the derivative of the largest value over admissible p. *value (any):
 * slope . m. Curved elements count as they are. BW_UNSUPPORTED for the B-bar formulation and
 * pressures with friction. */
BW_API bw_status bw_patch_shape_gradient(bw_context *context, const bw_mesh *mesh,
                                         const bw_material *material, const bw_patch_state *state,
                                         double *value, double *gradient);

/* A motion (m, node_count x 3) of the boundary extended into the body, in place: inner nodes follow
 * by repeated averaging over their neighbours. */
BW_API bw_status bw_boundary_extend(bw_context *context, const bw_mesh *mesh, double *motion);
/* The transpose, in place: a derivative by the position of every node, covector (any, node_count x
 * 3), becomes that by the boundary nodes, which inner nodes follow; 0 at inner nodes. */
BW_API bw_status bw_boundary_gather(bw_context *context, const bw_mesh *mesh, double *covector);

/* ---- weak regions (worst-case, section 4) -------------------------------------------------- */

/* What elements are chosen by. */
typedef enum bw_weak_measure {
  BW_WEAK_STRESS, /* the principal stress of largest magnitude */
  BW_WEAK_ENERGY  /* the strain energy density */
} bw_weak_measure;
/* What a linear program maximises in a region. */
typedef enum bw_worst_target {
  BW_WORST_STRESS,       /* the trace of the stress: one weight per element */
  BW_WORST_DISPLACEMENT, /* the displacement: a vector per element */
  BW_WORST_DIRECTION     /* the normal stress in a direction: a symmetric tensor per element */
} bw_worst_target;

/* How regions are found. */
typedef struct bw_weak_options {
  bw_weak_measure measure; /* what the threshold is on; default stress (max principal) */
  double fraction;         /* epsilon, of the volume; default 0.025, above 0, to 1 */
  int regions;             /* per mode; default 5, 1 to 100000 */
  bw_worst_target target; /* stress (default): w from the modal stress; displacement: from the modal
                             motion */
} bw_weak_options;
BW_API void bw_weak_options_default(bw_weak_options *options);

/* Connected elements with the weights of their objective; bw_weak_regions owns the lists. */
typedef struct bw_weak_region {
  int mode;         /* 0-based; -1 for a region that no mode gave */
  int rank;         /* 0-based, by energy */
  int32_t count;    /* elements */
  int32_t *element; /* (index, count) */
  double *weight;   /* (any, count) signed (stress), count x 3 (displacement) or x 6 (direction) */
  int32_t *corner;  /* (count) 3 facet + its corner, where the surface stress counts; NULL: the mean
                       stress of the element does */
  double volume;    /* (m3) */
  double energy;    /* (any) strain energy of the mode in it */
  double peak;      /* (any) largest value of the measure */
} bw_weak_region;
/* The regions of a mesh. */
typedef struct bw_weak_regions {
  bw_object object;
  const bw_mesh *mesh;     /* retained */
  bw_weak_options options; /* that they were found by */
  int count;
  bw_weak_region *region; /* by mode, then rank */
} bw_weak_regions;
/* The regions of all modes (elastic or Laplacian). BW_EMPTY where no mode has strain energy,
 * BW_UNSUPPORTED for the displacement target with Laplacian modes, and for modes of a sector. */
BW_API bw_status bw_weak_regions_find(bw_context *context, const bw_mesh *mesh,
                                      const bw_material *material, const bw_modes *modes,
                                      const bw_weak_options *options, bw_weak_regions **regions);
/* `count` elements, element (index, count), or NULL for all, as regions of their own with the
 * weight sign (-),
 * not 0: brute force. */
BW_API bw_status bw_weak_regions_single(bw_context *context, const bw_mesh *mesh, int64_t count,
                                        const int32_t *element, double sign,
                                        bw_weak_regions **regions);
/* Elements, element (index, count), as regions of their own whose objective is the mean normal
 * stress s n . sigma n of the element, n the direction and s the sign of the principal stress of
 * largest magnitude of its stress (Pa, count x 6). A maximisation of it keeps or raises that
 * principal stress. */
BW_API bw_status bw_weak_regions_directed(bw_context *context, const bw_mesh *mesh, int64_t count,
                                          const int32_t *element, const double *stress,
                                          bw_weak_regions **regions);
/* The boundary nodes nearest to points, point (m, count x 3), that have a patch: those that are not
 * in the inside of a support. node (index, count), the lowest of equally near ones. `dof_map` may
 * be NULL: nothing is constrained. BW_EMPTY where supports constrain the whole boundary, BW_INVALID
 * for a point that is not finite. */
BW_API bw_status bw_nearest_patch_nodes(bw_context *context, const bw_mesh *mesh,
                                        const bw_dof_map *dof_map, int64_t count,
                                        const double *point, int32_t *node);
/* Patches of the boundary as regions: those of bw_surface_mean around boundary nodes, node (index,
 * count). The objective is s n . m n, m the bw_surface_mean of bw_surface_stress, n and s of stress
 * (Pa, count x 6) as bw_weak_regions_directed. Their elements are those behind the corners of
 * facets. */
BW_API bw_status bw_weak_regions_patches(bw_context *context, const bw_mesh *mesh,
                                         const bw_dof_map *dof_map, double radius, int64_t count,
                                         const int32_t *node, const double *stress,
                                         bw_weak_regions **regions);
/* B^T D^T V w of one region: right_hand_side (any, node_count x 3) of eq. 15, overwritten. */
BW_API bw_status bw_region_objective(bw_context *context, const bw_weak_regions *regions,
                                     int region, const bw_material *material,
                                     double *right_hand_side);
/* The part of the objective that depends on the nodal forces of a load by their traction in the
 * patch of a region: its derivative is added to by_force (any, node_count x 3). Zero but for
 * patches. */
BW_API bw_status bw_region_by_force(bw_context *context, const bw_weak_regions *regions, int region,
                                    const bw_material *material, double *by_force);

/* ---- worst loads (worst-case, eq. 14) ------------------------------------------------------ */

/* Pressures at boundary corner nodes, linear over facets, or constant on cells of facets.
 * force = G p (N A of eq. 10, consistent also for tet10). With friction every pressure has one
 * column for each facet of its cone, and the pressure is their sum. Column k has a tangential force
 * of friction times the pressure, in the k-th of so many directions around the circle. */
typedef struct bw_pressure_basis {
  bw_object object;
  const bw_mesh *mesh; /* retained */
  int32_t count;       /* n_b: columns */
  int32_t directions;  /* columns of a pressure, one after the other: 1 without friction */
  int32_t *node;  /* (index, count) of each pressure; of a cell, that in or next to its middle */
  double *at;     /* (m, count x 3) that node's place, or the middle of the cell */
  double *area;   /* (m2, count) A: integral of the pressure's function: hat, or one on a cell */
  int64_t *start; /* (index, count + 1) first entry of each column of G */
  int32_t *row;   /* (index, start[count]) the node of each entry */
  double *coefficient; /* (m2, start[count] x 3) of each entry */
  bool complete;       /* no surface is forbidden or cut: uniform pressure is possible */
  /* Pressures of facets; NULL with friction, and where the basis is not of a whole boundary. */
  uint8_t *parts;        /* (facet_count) 0, or its edges are divided by so many: parts^2 cells */
  int64_t *facet_start;  /* (index, facet_count + 1) first pressure of each facet */
  int32_t *facet_column; /* (index, facet_start[facet_count]) its column, -1: forbidden */
} bw_pressure_basis;
enum { BW_MAX_FRICTION_FACETS = 64 /* of bw_pressure_options.friction_facets */ };
/* Where pressures act; all zeros are the defaults. */
typedef struct bw_pressure_options {
  /* No pressure on these facets (NULL: none are forbidden). That at corner nodes falls to zero over
   * the facets around. BW_EMPTY when no surface is left. */
  const bw_selection *forbidden;
  /* No surface at all, but cuts (NULL: none): planes of symmetry, what bonds cover. They take no
   * pressure, and those at the nodes around act on the other facets there. */
  const bw_selection *cuts;
  /* (m) 0: pressures at corner nodes; else constant on cells of facets whose edges are at most so
   * long, but not shorter than a sixteenth of the facet's. */
  double spacing;
  double friction;     /* (-) Coulomb's coefficient; 0: none; to 100 */
  int friction_facets; /* m of 3 to BW_MAX_FRICTION_FACETS of the pyramid in the cone: it holds the
                        * cone of friction cos(pi/m) */
} bw_pressure_options;
/* The pressures of a mesh. `options` may be NULL: all of the boundary, no friction. BW_EMPTY where
 * no surface is left or the forbidden one has no facet, BW_UNSUPPORTED for a spacing that makes too
 * many cells. */
BW_API bw_status bw_pressure_basis_create(bw_context *context, const bw_mesh *mesh,
                                          const bw_pressure_options *options,
                                          bw_pressure_basis **basis);
/* force (N, node_count x 3), overwritten, = G p for pressure (Pa, basis->count). */
BW_API void bw_pressure_force(const bw_pressure_basis *basis, const double *pressure,
                              double *force);
/* f (any, basis->count) = G^T q for q (any, node_count x 3). */
BW_API void bw_pressure_gradient(const bw_pressure_basis *basis, const double *q, double *f);

/* Which loads are admissible, and how the worst is found. */
typedef struct bw_worst_load_options {
  double pressure;   /* (Pa) p_max */
  double force;      /* (N) F_tot */
  bool force_is_max; /* the total force may also be smaller; default false: fixed */
  bool one_sign;     /* bw_worst_case_run only: maximise each region's objective as its weights are
                        signed; default false: whichever sign reaches more, a mode's sign being
                        arbitrary */
  const bw_lp_solver *lp; /* of the linear programs; default NULL: chosen */
  int hands;       /* the pressure lies within so many patches of the boundary, to BW_MAX_HANDS; 0:
                      anywhere */
  bool other_sign; /* bw_worst_case_run only, with one_sign: maximises the opposite of the
                      functionals instead; default false */
  /* bw_worst_case_run only: gives the displacements (m, count x node_count x 3) of loads that were
   * found, in the place of their forces (N), where these are not linear in the load; default NULL:
   * the system's. */
  bw_status (*respond)(bw_context *context, void *data, int count, double *block);
  void *respond_data; /* its `data` */
  /* (Pa, regions->count x basis->count) bw_worst_case_run only: loads in the place of those that
   * linear programs find, one for each region; default NULL */
  const double *given;
  double hand_area; /* (m2) of the disc that a patch is: the nodes nearer than its radius to the
                       patch's centre whose normals are within 60 degrees of the centre's */
} bw_worst_load_options;
enum { BW_MAX_HANDS = 16 /* of bw_worst_load_options.hands */ };
/* For `count` objectives f, objective (any, count x basis->count): the pressures p, pressure (Pa,
 * count x basis->count), that maximise f . p, and value (any, count), f . p. Objectives are worked
 * on in parallel. Balance rows are those of the DOF map's rigid-body modes; the pressures of a
 * node's columns add up to p_max at most. BW_INFEASIBLE says which bound excludes every load; where
 * the basis is not complete, balance may as well: then the message has the largest total force.
 * BW_CONVERGENCE where no solver finds an optimum, BW_UNSUPPORTED for supports that prescribe a
 * displacement other than zero. Every answer fulfils balance to 1e-9 of the force and its duality
 * gap is below 1e-8. dual (any, count x (rigid_mode_count + 1)), which may be NULL: multipliers y,
 * so that with reduced costs d_j = f_j - sum_m y_m <motion m, G e_j> - y_last A_j the optimum is
 * y_last F_tot + p_max sum_j max(0, d_j). *report, which may be NULL: of the linear programs. */
BW_API bw_status bw_worst_loads(bw_context *context, const bw_pressure_basis *basis,
                                const bw_dof_map *dof_map, const bw_worst_load_options *options,
                                int64_t count, const double *objective, double *pressure,
                                double *value, double *dual, bw_solver_report *report);

/* The worst load of a region; all arrays live during the call only. */
typedef struct bw_worst_case_visit {
  int region;                  /* (index) */
  const double *pressure;      /* (Pa, basis->count) */
  const double *displacement;  /* (m, node_count x 3) */
  const double *stress;        /* (Pa, element_count x 6) */
  const double *max_principal; /* (Pa, element_count) */
  double objective;            /* (any) of the linear program */
  double solve_error; /* (Pa) estimate of what the error of the last solve does to the stress
                         where max_principal is largest; 0 by a factor */
  bool flipped;       /* reached with the opposite signs of the weights */
  double seconds;     /* the region's share of its batch */
} bw_worst_case_visit;
/* Regions -> right-hand sides -> solves -> linear programs -> solves -> stresses, in batches of
 * `batch` (0: 16 by a factor, 24 by iterations) with progress "worst loads". `visit` is called in
 * region order; a status other than BW_OK ends the run. *report, which may be NULL: of the linear
 * programs. Those of bw_worst_loads. */
BW_API bw_status bw_worst_case_run(bw_context *context, bw_system *system,
                                   const bw_pressure_basis *basis, const bw_weak_regions *regions,
                                   const bw_worst_load_options *options, int batch,
                                   bw_status (*visit)(void *data, const bw_worst_case_visit *visit),
                                   void *data, bw_solver_report *report);

/* Targets that a load can stress; bw_screening_clear releases them. */
typedef struct bw_screening {
  int32_t count;
  int32_t *target;         /* (index, count) elements, or nodes in the centres of patches */
  double *stress;          /* (Pa, count x 6) */
  bw_solver_report report; /* of the linear programs */
} bw_screening;
/* Screening: which targets a load can stress most, estimated for all of them with pressures that
 * are constant over `patches` patches of the boundary (more where the balance rows need more). Such
 * pressures are admissible, so `stress` (the target's stress under the best of them that was
 * found) is a lower bound; where the basis is not complete, the total force of these pressures may
 * be smaller, and `stress` is an estimate. Targets are all elements; with a
 * `radius` (m) they are the patches of bw_surface_mean around the corners of facets, of which no
 * two within the radius get linear programs. The linear programs are solved for the `wanted`
 * targets of the largest knapsack bound; the results are by descending principal stress. Those of
 * bw_worst_loads. */
BW_API bw_status bw_worst_screening(bw_context *context, bw_system *system,
                                    const bw_pressure_basis *basis,
                                    const bw_worst_load_options *options, int32_t patches,
                                    double radius, int32_t wanted, bw_screening *screening);
BW_API void bw_screening_clear(bw_screening *screening);

/* An upper bound of the stress and the largest stress found. */
typedef struct bw_worst_bound {
  double upper;            /* (Pa) no admissible pressure exceeds it, up to rounding */
  double largest;          /* (Pa) the incumbent, or a larger stress that was found */
  int32_t element;         /* where that larger one is; -1: the incumbent is */
  double stress[6];        /* of that element then */
  int64_t linear_programs; /* linear programs solved */
  bw_solver_report report; /* of them; largest of all threads' sums */
} bw_worst_bound;
/* What proves the bound: in every leaf a set of directions of an element with multipliers whose
 * dual value is at most `bound`. The leaves of an element cover all directions. Numbers of a leaf:
 * vectors of an exponent e and whole numbers k, which mean k 2^e. For all directions (cell 0) six
 * vectors of multipliers of the rigid-body modes, one for each component xx yy zz yz zx xy of
 * stress, and a vector of one, the multiplier of the total force. For a triangle the motions'
 * vector and the total's, for the positive and then the negative sign. Faces of the icosahedron
 * have the cells BW_FIRST_FACE + 0 to 9; the four parts of cell c are 4 c + 0 to 3. */
typedef struct bw_bound_leaf {
  int32_t element;
  int64_t cell;  /* which directions it covers */
  double bound;  /* (Pa) of the stress in them */
  int64_t start; /* its first number */
} bw_bound_leaf;
enum { BW_FIRST_FACE = 10 /* cell of the first face of the icosahedron */ };
/* The leaves of all elements; bw_bound_leaves_clear releases them. */
typedef struct bw_bound_leaves {
  size_t count, number_count, leaf_capacity, number_capacity; /* used and allocated */
  bw_bound_leaf *leaf;                                        /* count leaves */
  int32_t *number; /* (number_count) of all leaves, one after the other */
} bw_bound_leaves;
BW_API void bw_bound_leaves_clear(bw_bound_leaves *leaves);
/* An upper bound of the principal stress of largest magnitude (mean over an element) that any
 * admissible pressure causes in any element of this mesh, by branch and bound over elements and
 * directions. Hands do not count: pressure may act anywhere. incumbent (Pa): a stress known to be
 * reached. Ends when `upper` is within the relative tolerance (-), 0.001 to 0.5, of the largest
 * stress found. One solve for each pressure, or several where displacements of all nodes under all
 * pressures take more than a quarter of the free memory (512 MB to 4 GB). leaves: NULL, or an empty
 * list that is filled; the caller clears it, also after a failure. Those of bw_worst_loads. */
BW_API bw_status bw_worst_bound_find(bw_context *context, bw_system *system,
                                     const bw_pressure_basis *basis,
                                     const bw_worst_load_options *options, double incumbent,
                                     double tolerance, bw_worst_bound *bound,
                                     bw_bound_leaves *leaves);

/* The resultant of a cluster of loaded nodes. */
typedef struct bw_arrow {
  double at[3], force[3];
  double area; /* (m2) loaded */
} bw_arrow;
/* Sums the forces of a pressure (Pa, basis->count) into a few arrows, largest first: clusters of
 * loaded nodes within `radius` (0: a twentieth of the box diagonal) whose forces have the same
 * direction. Together they are the whole force. *arrows is NULL when nothing is loaded; release it
 * with bw_free. */
BW_API bw_status bw_resultant_arrows(bw_context *context, const bw_pressure_basis *basis,
                                     const double *pressure, double radius, int *count,
                                     bw_arrow **arrows);

/* ---- drop test (worst-case, section 5) ----------------------------------------------------- */

/* How a body is dropped. */
typedef struct bw_drop_test_options {
  int64_t drops;     /* default 2000, 1 to 1e8 */
  double height;     /* (m) default 1, > 0 */
  double peg_radius; /* (m) of the peg, 0 or more; 0 (default): 2 % of the box diagonal */
  double duration;   /* (s) of the contact; the mean force is 2 m_e v / duration with the effective
                        mass m_e of the body at the contact; default 1e-3, > 0 */
  uint64_t seed;     /* of attitudes and places; default 0 */
} bw_drop_test_options;
BW_API void bw_drop_test_options_default(bw_drop_test_options *options);
/* What drops cause; bw_drop_test_result_clear releases it. */
typedef struct bw_drop_test_result {
  double *exceedance; /* (-, element_count) fraction of drops whose stress is beyond the strength:
                         whose utilisation exceeds one, or, where no strength is known, whose max
                         principal stress exceeds `threshold` */
  double *mean_peak;  /* (Pa, element_count) mean over drops of the max principal stress */
  double *contact;    /* (m, drops x 3) place of the contact */
  double *force;      /* (N, drops) */
  double *direction;  /* (-, drops x 3) unit, of the impulse on the body, along the peg's normal */
  double *resultant;  /* (N, drops x 3) sum of the nodal forces */
  int32_t *nodes;     /* (drops) how many nodes the contact acts on */
  double *area;       /* (m2, drops) of the contact as seen along the force */
  double *peak;       /* (Pa, drops) largest stress */
  double threshold;   /* (Pa) the 97.5th percentile by volume of the first 200 drops' stresses; 0
                         when the strength is known */
  int64_t drops;      /* how many */
} bw_drop_test_result;
/* Drops a body on a peg. BW_INVALID for one with supports or without density. `options` may be
 * NULL. */
BW_API bw_status bw_drop_test(bw_context *context, bw_system *system,
                              const bw_drop_test_options *options, bw_drop_test_result *result);
BW_API void bw_drop_test_result_clear(bw_drop_test_result *result);

/* Spearman's rank correlation *rho (-) of two series a and b (any, count), ties averaged. */
BW_API bw_status bw_rank_correlation(bw_context *context, int64_t count, const double *a,
                                     const double *b, double *rho);
/* The same *rho (-) of a and b (any, count) with weight (any, count), areas or volumes: a sample of
 * twice the weight counts as two. */
BW_API bw_status bw_weighted_rank_correlation(bw_context *context, int64_t count, const double *a,
                                              const double *b, const double *weight, double *rho);
/* The *quantile (any) at p (-), 0 to 1, of value (any, count) with weight (any, count), such as
 * volumes; e.g. 0.9975 in figure 7. */
BW_API bw_status bw_weighted_quantile(bw_context *context, int64_t count, const double *value,
                                      const double *weight, double p, double *quantile);

#ifdef __cplusplus
}
#endif
#endif
