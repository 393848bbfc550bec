/* responsive: equations on plane meshes that follow an outline, with lagged factors reused; elastic
 * sheets (static, transient, large-deflection) and plates with natural modes. */
#ifndef BARWRIGHT_RESPONSIVE_H
#define BARWRIGHT_RESPONSIVE_H

#include "barwright/element.h"
#include "barwright/material.h"
#include "barwright/plane.h"

#ifdef __cplusplus
extern "C" {
#endif

/* ---- matrices on a plane mesh -------------------------------------------------------------- */

/* Block sparsity pattern of a plane mesh: full rows, ascending, and for every block the
 * contributions (element, local pair) that are added into it: gathered, never scattered, so that
 * the bits do not depend on threads. Values belong to whoever assembles: `components`^2 numbers per
 * block, row by row. Depends on topology only. */
typedef struct bw_plane_pattern {
  bw_object object;
  const bw_plane_topology *topology; /* retained */
  int32_t node_count;
  int64_t block_count;
  int64_t *start;        /* node_count + 1 */
  int32_t *column;       /* block_count */
  int64_t *diagonal;     /* node_count: where the block (i, i) is */
  int64_t *mirror;       /* block_count: where the block (j, i) of a block (i, j) is */
  int64_t *gather_start; /* block_count + 1 */
  int32_t *gather_element;
  uint8_t *gather_local; /* a * 6 + b */
} bw_plane_pattern;
BW_API bw_status bw_plane_pattern_create(bw_context *context, const bw_plane_topology *topology,
                                         bw_plane_pattern **pattern);
/* Add the elements' matrices (element_count x (n c) x (n c), row by row, unknown = node c +
 * component; only as many elements at a time as the caller likes: `element_matrix` fills one) into
 * values (zeroed first). */
typedef bw_status bw_element_matrix(void *data, int32_t element, double *matrix);
BW_API bw_status bw_plane_assemble(bw_context *context, const bw_plane_pattern *pattern,
                                   int components, bw_element_matrix *element_matrix, void *data,
                                   double *values);
/* y = A x */
BW_API bw_status bw_plane_multiply(bw_context *context, const bw_plane_pattern *pattern,
                                   int components, const double *values, const double *x,
                                   double *y);
/* Prescribed unknowns (held[i] != 0): their rows and columns become those of the identity times the
 * mean size of the component's diagonal entries, and `rhs` (may be NULL) follows, so that the
 * number of unknowns never changes. */
BW_API bw_status bw_plane_prescribe(bw_context *context, const bw_plane_pattern *pattern,
                                    int components, const uint8_t *held, const double *prescribed,
                                    double *values, double *rhs);

/* ---- lagged factors (responsive, sections 3.2 and 3.3)
 * --------------------------------------------
 *
 * Solves A x = b with what is left of an earlier factorisation: conjugate gradients on a Cholesky
 * factor for symmetric positive definite matrices, BiCGSTAB on an LU factor for others. The
 * paper uses ILU(k); a complete factor costs little in the plane and keeps its worth for longer. */
typedef enum bw_lagged_factor_method {
  BW_LAGGED_FACTOR_AUTO, /* by predicted cost: operations and bytes counted, and the iterations that
                    recent solves took; never time measured */
  BW_LAGGED_FACTOR_ITERATE,  /* on the factor as it is, as long as it converges */
  BW_LAGGED_FACTOR_REFACTOR, /* numbers anew, analysis kept */
  BW_LAGGED_FACTOR_FULL      /* analysis too: for baselines */
} bw_lagged_factor_method;
typedef struct bw_lagged_factor_options {
  bw_lagged_factor_method method;
  double tolerance; /* relative residual |b - A x| / |b|; default 1e-8 */
  int iterations;   /* before refactoring; default 60 */
} bw_lagged_factor_options;
BW_API void bw_lagged_factor_options_default(bw_lagged_factor_options *options);
/* What one solve, or one frame of an application, reused and what it cost. Sums over the solves of
 * a frame; clear with memset before. */
typedef struct bw_plane_reuse {
  bw_level level; /* of the mesh in this frame */
  bool pattern;   /* of A: kept */
  bool factor;    /* B: kept (lagged) */
  bool solution;  /* x: used as the first guess */
  int analyses, factorisations, solves, iterations;
  double residual;                            /* the largest, relative, as reached */
  double predicted_iterate, predicted_factor; /* s, of the model's machine */
  double seconds_mesh, seconds_assemble, seconds_factor, seconds_solve;
} bw_plane_reuse;

typedef struct bw_lagged_factor bw_lagged_factor; /* mutable; one thread at a time */
/* 1 to 4 components at a node, 1 to 3 where symmetric. */
BW_API bw_status bw_lagged_factor_create(bw_context *context, bool symmetric, int components,
                                         bw_lagged_factor **lagged);
BW_API void bw_lagged_factor_free(bw_lagged_factor *lagged);
/* x: the first guess on entry, the solution on return. The factor and its elimination order are
 * kept as long as the pattern's nodes are the same object, the analysis as long as its topology is.
 * BW_SINGULAR, or BW_CONVERGENCE with the residual reached; x is then as it was. `options` and
 * `kept` may be NULL; `kept` is added to. */
BW_API bw_status bw_lagged_factor_solve(bw_context *context, bw_lagged_factor *lagged,
                                        const bw_plane_pattern *pattern, const double *values,
                                        const double *rhs, double *x,
                                        const bw_lagged_factor_options *options,
                                        bw_plane_reuse *kept);
/* Apply the factor alone (z = B r, current or lagged): for eigenvalue iterations. */
BW_API bw_status bw_lagged_factor_apply(bw_context *context, bw_lagged_factor *lagged,
                                        const double *r, double *z);
/* Drop everything kept. */
BW_API void bw_lagged_factor_reset(bw_lagged_factor *lagged);

/* ---- conditions by tag -------------------------------------------------------------------------
 */

/* A value over place and time. */
typedef double bw_plane_function(void *data, const double at[2], double time);
typedef enum bw_condition_kind {
  BW_PRESCRIBED, /* component = value on the nodes of the segments */
  BW_TRACTION,   /* component = value per length and thickness (Pa) on the segments; component 3:
                    heat that comes in, over density times heat capacity (K m/s) */
  BW_PRESSURE,   /* along the inner normal (Pa); component not used */
  BW_CONVECTION /* flows: heat coefficient (value - temperature) per length comes in; component 3 */
} bw_condition_kind;
/* Conditions sit on tags, so that they follow the outline through every level. */
typedef struct bw_condition {
  int32_t tag; /* of the outline; -1: every segment */
  bw_condition_kind kind;
  int component; /* 0 x, 1 y; flow: 2 pressure, 3 temperature */
  double value;
  bw_plane_function *function; /* in place of value; may be NULL */
  void *data;
  double coefficient; /* of convection, over density times heat capacity (m/s) */
  int32_t order;      /* of prescribed values that conflict at a node, the highest order decides */
} bw_condition;
/* held and prescribed (node_count x components) at a time. A component that any tag of a node
 * prescribes is prescribed. Where tags of one order prescribe different values, the displacement or
 * velocity nearest to 0 holds (0 between values of both signs), and the middle of temperatures.
 * Conflicts are reported unless *reported, which is then set; `reported` may be NULL. */
BW_API bw_status bw_conditions_prescribe(bw_context *context, const bw_plane_mesh *mesh,
                                         int components, int32_t count,
                                         const bw_condition *condition, double time, uint8_t *held,
                                         double *prescribed, bool *reported);
/* Consistent nodal forces of tractions and pressures, times thickness. */
BW_API bw_status bw_conditions_force(bw_context *context, const bw_plane_mesh *mesh, int components,
                                     int32_t count, const bw_condition *condition, double time,
                                     double thickness, double *force);

/* ---- elastic sheets
 * -------------------------------------------------------------------------------- */

typedef struct bw_sheet_section {
  const bw_material *material; /* isotropic or orthotropic with an axis along z; retained */
  double thickness;            /* m; plane strain: per this depth */
  bool plane_strain;
} bw_sheet_section;
typedef struct bw_sheet_description {
  int32_t section_count; /* 1, or one per region */
  const bw_sheet_section *section;
  int32_t condition_count;
  const bw_condition *condition;
  double gravity[2]; /* m/s2 */
} bw_sheet_description;

/* A sheet on a mesh that follows an outline: holds matrices, factor and solution from frame to
 * frame. Mutable. */
typedef struct bw_sheet {
  bw_object object;
  /* Of the state that stands; they live until the next operation that succeeds. */
  const bw_plane_mesh *mesh;
  const double *displacement;            /* node_count x 2: of the last solution; zero at first */
  const double *velocity, *acceleration; /* of transient sheets; NULL otherwise */
  double time;
  struct bwi_sheet *inner;
} bw_sheet;
BW_API bw_status bw_sheet_create(bw_context *context, const bw_plane_mesh *mesh,
                                 const bw_sheet_description *description, bw_sheet **sheet);
/* Go over to another mesh of the same problem; the solution is carried over (bw_plane_transfer).
 * Conditions go by the names of their tags: the outline may be another one. On failure all is as it
 * was. */
BW_API bw_status bw_sheet_follow(bw_context *context, bw_sheet *sheet, const bw_plane_mesh *mesh,
                                 bw_plane_reuse *kept);
/* What a sheet is at, an immutable object: bw_release gives it up. Keeping it copies nothing;
 * returning to it brings back mesh, fields and time bit for bit, and fails only for the state of a
 * sheet with other conditions. A sheet's operations put a new state in the place of the one that
 * stands when all is done: those that fail change nothing. */
typedef struct bw_sheet_state bw_sheet_state;
BW_API const bw_sheet_state *bw_sheet_keep(const bw_sheet *sheet);
BW_API bw_status bw_sheet_return(bw_context *context, bw_sheet *sheet, const bw_sheet_state *state);
/* Whether its parts belong together: see bw_plane_mesh_check. */
BW_API bw_status bw_sheet_check(bw_context *context, const bw_sheet *sheet);
/* (e) Linear statics. BW_UNCONSTRAINED when rigid-body modes are unconstrained. */
BW_API bw_status bw_sheet_static(bw_context *context, bw_sheet *sheet,
                                 const bw_lagged_factor_options *options, bw_plane_reuse *kept);
/* (a) One Newmark step of rho u'' + c = div sigma (eqs. 1, 2): beta, gamma (defaults 1/4, 1/2),
 * Rayleigh damping. Prescribed displacements are of the ground, as functions of time (read at the
 * new time and a step before and after it, at 0 and after; never below 0); the other conditions'
 * functions are read at the new time. */
typedef struct bw_newmark {
  double step, beta, gamma;
  double damping_mass, damping_stiffness;
} bw_newmark;
BW_API void bw_newmark_default(bw_newmark *newmark);
BW_API bw_status bw_sheet_shake(bw_context *context, bw_sheet *sheet, const bw_newmark *newmark,
                                const bw_lagged_factor_options *options, bw_plane_reuse *kept);
/* (b) St. Venant-Kirchhoff statics (eq. 3) by Newton's method with a line search on the energy,
 * from the last solution; load steps where Newton fails from there. BW_CONVERGENCE says how far the
 * load went. */
typedef struct bw_bend_options {
  double tolerance; /* |residual| / |load|; default 1e-8 */
  int iterations;   /* of one load step; default 30 */
  int load_steps;   /* at most; default 64 */
  bw_lagged_factor_options linear;
} bw_bend_options;
BW_API void bw_bend_options_default(bw_bend_options *options);
typedef struct bw_bend_report {
  int iterations, load_steps;
  double residual, energy;
} bw_bend_report;
BW_API bw_status bw_sheet_bend(bw_context *context, bw_sheet *sheet, const bw_bend_options *options,
                               bw_bend_report *report, bw_plane_reuse *kept);
/* Stress xx yy xy zz at element points averaged to nodes (node_count x 4; Cauchy stress after
 * bw_sheet_bend) and von Mises (node_count); either may be NULL. */
BW_API bw_status bw_sheet_stress(bw_context *context, const bw_sheet *sheet, double *stress,
                                 double *von_mises);
/* Zienkiewicz-Zhu estimate of the relative error in energy. */
BW_API bw_status bw_sheet_error(bw_context *context, const bw_sheet *sheet, double *relative);
/* J = (integral of von Mises^p / area)^(1/p), which tends to the largest stress from below as p
 * grows (1 to 1000), and dJ / d node positions (node_count x 2; NULL: J alone), exact, by one
 * adjoint solve on the current factor: for shape optimisation. After bw_sheet_static on the same
 * mesh. Values of conditions that are functions of place are taken to go with their nodes. */
BW_API bw_status bw_sheet_stress_gradient(bw_context *context, bw_sheet *sheet, double p,
                                          double *norm, double *gradient);

/* ---- plates that ring (responsive, appendix A)
 * --------------------------------------------------------- */

/* The outline extruded to a plate, as Reissner-Mindlin triangles that do not lock: deflection and
 * two rotations at each node. Mutable; holds factor, modes and rigid-body motions from frame to
 * frame.
 */
typedef struct bw_plate {
  bw_object object;
  const bw_material *material;
  double thickness;
  /* Of the state that stands; they live until the next operation that succeeds. */
  const bw_plane_mesh *mesh; /* order 2 */
  int mode_count;
  const double *frequency; /* Hz, ascending, elastic modes only */
  const double *shape;     /* mode_count x node_count x 3: deflection, rotations; mass norm 1, the
                              largest deflection positive */
  const double *residual;  /* sqrt(r . B r / lambda): error in the energy norm, B the factor used */
  struct bwi_plate *inner;
} bw_plate;
BW_API bw_status bw_plate_create(bw_context *context, const bw_plane_mesh *mesh,
                                 const bw_material *material, double thickness, bw_plate **plate);
BW_API bw_status bw_plate_follow(bw_context *context, bw_plate *plate, const bw_plane_mesh *mesh,
                                 bw_plane_reuse *kept);
/* What a plate is at, an immutable object: bw_release gives it up. Keeping it copies nothing;
 * returning to it brings back mesh and modes bit for bit. A plate's operations put a new state in
 * the place of the one that stands when all is done: those that fail change nothing. */
typedef struct bw_plate_state bw_plate_state;
BW_API const bw_plate_state *bw_plate_keep(const bw_plate *plate);
BW_API bw_status bw_plate_return(bw_context *context, bw_plate *plate, const bw_plate_state *state);
BW_API bw_status bw_plate_check(bw_context *context, const bw_plate *plate);
typedef struct bw_plate_options {
  int modes;        /* default 1 */
  double tolerance; /* of `residual`; the frequency's error is its square; default 1e-6 */
  bool scratch;     /* random start, fresh factor: for checks and baselines */
} bw_plate_options;
BW_API void bw_plate_options_default(bw_plate_options *options);
/* Rayleigh-Ritz iteration with the rigid-body motions projected out, from the last frame's modes on
 * the last frame's factor; with a fresh factor at least as fast as inverse iteration.
 * BW_CONVERGENCE leaves the plate as it was. */
BW_API bw_status bw_plate_solve(bw_context *context, bw_plate *plate,
                                const bw_plate_options *options, bw_plane_reuse *kept);
/* d frequency[mode] / d node positions (node_count x 2), Hz/m. */
BW_API bw_status bw_plate_gradient(bw_context *context, const bw_plate *plate, int mode,
                                   double *gradient);
/* What a stroke at a place sounds like: modes k in proportion to their deflection there, each dying
 * away as exp(-pi loss f t), softened by the mallet's time of contact. Scaled so that the loudest
 * sample is 0.9; `sample` has room for seconds * rate (rounded down) numbers. */
typedef struct bw_tone {
  double at[2];   /* of the stroke; nan: where the lowest mode deflects most */
  double loss;    /* loss factor of material and mounting; default 0.002 */
  double contact; /* s; default 0.3e-3 */
  double seconds; /* default 2 */
  int32_t rate;   /* samples per second; default 44100 */
} bw_tone;
BW_API void bw_tone_default(bw_tone *tone);
BW_API bw_status bw_plate_tone(bw_context *context, const bw_plate *plate, const bw_tone *tone,
                               double *sample);
/* How loudly each mode sounds in it (mode_count numbers): with its sign, the loudest 1 in size. */
BW_API bw_status bw_plate_gains(bw_context *context, const bw_plate *plate, const bw_tone *tone,
                                double *gain);
/* Where the mode's deflection vanishes: pieces of line, 4 numbers each (x0 y0 x1 y1); free with
 * bw_free. For the mounting holes. */
BW_API bw_status bw_plate_nodal_lines(bw_context *context, const bw_plate *plate, int mode,
                                      int32_t *count, double **lines);
/* The lowest frequencies of motion in the plane of the plate (plane stress, free), to see whether
 * one lies below: `count` of them. */
BW_API bw_status bw_plate_inplane(bw_context *context, const bw_plate *plate, int count,
                                  double *frequency);
#ifdef __cplusplus
}
#endif
#endif
