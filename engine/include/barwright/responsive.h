/* responsive: equations on plane meshes that follow an outline, with lagged factors reused; elastic
 * sheets (static, transient, large-deflection) and plates with natural modes. */
#ifndef BARWRIGHT_RESPONSIVE_H
#define BARWRIGHT_RESPONSIVE_H

#include "barwright/eigen.h"
#include "barwright/element.h"
#include "barwright/incremental.h"
#include "barwright/material.h"

#ifdef __cplusplus
extern "C" {
#endif

/* ---- conditions by tag ----------------------------------------------------------------------- */

/* A value (any) over place and time, in the unit of the condition. */
typedef double bw_plane_function(void *data, const double at[2], double time);
/* What a condition prescribes. */
typedef enum bw_condition_kind {
  BW_PRESCRIBED, /* component = value on the nodes of the segments */
  BW_TRACTION,   /* component = value per length and thickness (Pa) on the segments; component 3:
                    heat that comes in, over density times heat capacity (K m/s) */
  BW_PRESSURE,   /* along the inner normal (Pa); component not used */
  BW_CONVECTION /* flows: heat coefficient (value - temperature) per length comes in; component 3 */
} bw_condition_kind;
/* Conditions sit on tags, so that they follow the outline through every level. */
typedef struct bw_condition {
  int32_t tag;                 /* of the outline; -1: every segment */
  bw_condition_kind kind;      /* what it prescribes */
  int component;               /* 0 x, 1 y; flow: 2 pressure, 3 temperature */
  double value;                /* (any) by the kind: m, m/s, Pa, K, K m/s */
  bw_plane_function *function; /* in place of value; may be NULL. Called as long as what has the
                                  condition lives, on the thread of the caller */
  void *data;                  /* borrowed as long */
  double coefficient;          /* (m/s) of convection, over density times heat capacity */
  int32_t order; /* of prescribed values that conflict at a node, the highest order decides */
} bw_condition;
/* is_prescribed (node_count x components) and prescribed (any, node_count x components) at a time.
 * A component that any tag of a node prescribes is prescribed. Where tags of one order prescribe
 * different values, the displacement or velocity nearest to 0 holds (0 between values of both
 * signs), and the middle of temperatures. Conflicts give a warning unless *reported, which is then
 * set; `reported` may be NULL. */
BW_API bw_status bw_conditions_prescribe(bw_context *context, const bw_plane_mesh *mesh,
                                         int components, int32_t count,
                                         const bw_condition *condition, double time,
                                         uint8_t *is_prescribed, double *prescribed,
                                         bool *reported);
/* Consistent nodal forces of tractions and pressures, times thickness: force (N, node_count x
 * components), overwritten. */
BW_API bw_status bw_conditions_force(bw_context *context, const bw_plane_mesh *mesh, int components,
                                     int32_t count, const bw_condition *condition, double time,
                                     double thickness, double *force);

/* ---- elastic sheets -------------------------------------------------------------------------- */

/* What a region of a sheet is made of. */
typedef struct bw_sheet_section {
  const bw_material *material; /* isotropic or orthotropic with an axis along z; retained */
  double thickness;            /* (m) plane strain: per this depth */
  bool plane_strain;           /* else plane stress */
} bw_sheet_section;
/* A sheet; bw_sheet_create copies the lists. */
typedef struct bw_sheet_description {
  int32_t section_count;           /* 1, or one per region */
  const bw_sheet_section *section; /* section_count of them */
  int32_t condition_count;
  const bw_condition *condition; /* condition_count of them */
  double gravity[2];             /* (m/s2) */
} bw_sheet_description;

/* A sheet on a mesh that follows an outline: holds matrices, factor and solution from frame to
 * frame. Mutable. */
typedef struct bw_sheet {
  bw_object object;
  /* Of the present state; they live until the next operation that succeeds. */
  const bw_plane_mesh *mesh;
  const double *displacement; /* (m, node_count x 2) of the last solution; zero at first */
  const double *velocity;     /* (m/s, node_count x 2) of transient sheets; NULL otherwise */
  const double *acceleration; /* (m/s2, node_count x 2) of transient sheets; NULL otherwise */
  double time;                /* (s) of transient sheets */
  struct bwi_sheet *inner;
} bw_sheet;
/* A sheet at rest. BW_INVALID names a section or condition that does not fit, BW_EMPTY a tag that
 * no segment has, BW_UNSUPPORTED a material without an axis along z. */
BW_API bw_status bw_sheet_create(bw_context *context, const bw_plane_mesh *mesh,
                                 const bw_sheet_description *description, bw_sheet **sheet);
/* Continues on another mesh of the same problem; the solution is transferred (bw_plane_transfer).
 * Conditions apply by the names of their tags: the outline may be another one. On failure the sheet
 * is unchanged; BW_EMPTY where no segment has the tag of a condition. */
BW_API bw_status bw_sheet_follow(bw_context *context, bw_sheet *sheet, const bw_plane_mesh *mesh,
                                 bw_plane_reuse *reuse);
/* The state of a sheet, an immutable object. Returning to it restores mesh, fields and time bit for
 * bit, and fails only for the state of a sheet with other conditions. The operations of a sheet
 * replace its present state at their end: those that fail change nothing. */
typedef struct bw_sheet_state bw_sheet_state;
/* The state of a sheet, one reference to be released. */
BW_API const bw_sheet_state *bw_sheet_keep(const bw_sheet *sheet);
/* Returns a sheet to a state. */
BW_API bw_status bw_sheet_return(bw_context *context, bw_sheet *sheet, const bw_sheet_state *state);
/* Checks its parts against each other. */
BW_API bw_status bw_sheet_check(bw_context *context, const bw_sheet *sheet);
/* (e) Linear statics. BW_UNCONSTRAINED when rigid-body modes are unconstrained; and those of
 * bw_lagged_factor_solve. `options` and `reuse` may be NULL. */
BW_API bw_status bw_sheet_static(bw_context *context, bw_sheet *sheet,
                                 const bw_lagged_factor_options *options, bw_plane_reuse *reuse);
/* Newmark's method with Rayleigh damping. */
typedef struct bw_newmark {
  double step;              /* (s) default 1e-3, > 0 */
  double beta;              /* (-) default 1/4, gamma / 2 or more */
  double gamma;             /* (-) default 1/2 or more */
  double damping_mass;      /* (1/s) of the mass; default 0, 0 or more */
  double damping_stiffness; /* (s) of the stiffness; default 0, 0 or more */
} bw_newmark;
BW_API void bw_newmark_default(bw_newmark *newmark);
/* (a) One Newmark step of rho u'' + c = div sigma (eqs. 1, 2). Prescribed displacements are of the
 * ground, as functions of time (read at the new time and a step before and after it, at 0 and
 * after; never below 0); the other conditions' functions are read at the new time. Those of
 * bw_lagged_factor_solve. `newmark`, `options` and `reuse` may be NULL. */
BW_API bw_status bw_sheet_transient(bw_context *context, bw_sheet *sheet, const bw_newmark *newmark,
                                    const bw_lagged_factor_options *options, bw_plane_reuse *reuse);
/* How Newton's method proceeds. */
typedef struct bw_large_deflection_options {
  double tolerance;                /* (-) |residual| / |load|; default 1e-8, > 0 */
  int iterations;                  /* of one load step; default 30, 1 or more */
  int load_steps;                  /* at most; default 64, 1 or more */
  bw_lagged_factor_options linear; /* of each iteration */
} bw_large_deflection_options;
BW_API void bw_large_deflection_options_default(bw_large_deflection_options *options);
/* What Newton's method did. */
typedef struct bw_large_deflection_report {
  int iterations, load_steps; /* how many */
  double residual;            /* (-) |residual| / |load| reached */
  double energy;              /* (J) strain energy */
} bw_large_deflection_report;
/* (b) St. Venant-Kirchhoff statics (eq. 3) by Newton's method with a line search on the energy,
 * from the last solution; load steps where Newton fails from there. BW_CONVERGENCE says how far the
 * load went, BW_UNCONSTRAINED that rigid-body modes are unconstrained. `options`, `report` and
 * `reuse` may be NULL. */
BW_API bw_status bw_sheet_large_deflection(bw_context *context, bw_sheet *sheet,
                                           const bw_large_deflection_options *options,
                                           bw_large_deflection_report *report,
                                           bw_plane_reuse *reuse);
/* Stress xx yy xy zz at element points averaged to nodes, stress (Pa, node_count x 4), Cauchy
 * stress after bw_sheet_large_deflection, and von_mises (Pa, node_count); either may be NULL. */
BW_API bw_status bw_sheet_stress(bw_context *context, const bw_sheet *sheet, double *stress,
                                 double *von_mises);
/* Zienkiewicz and Zhu's estimate of the error in the energy norm, *relative (-) to that of solution
 * and error. */
BW_API bw_status bw_sheet_error(bw_context *context, const bw_sheet *sheet, double *relative);
/* The p-norm of stress, *norm (Pa), J = (integral of von Mises^p / area)^(1/p), which tends to the
 * largest stress from below as p (-) grows (1 to 1000). dJ / d node positions, gradient (Pa/m,
 * node_count x 2), which may be NULL, is exact and takes one adjoint solve on the current factor.
 * For shape optimisation. After bw_sheet_static on the same mesh (BW_INVALID else). Those of
 * bw_lagged_factor_solve. Values of conditions that are functions of place are taken to go with
 * their nodes. */
BW_API bw_status bw_sheet_stress_gradient(bw_context *context, bw_sheet *sheet, double p,
                                          double *norm, double *gradient);

/* ---- plates that ring (responsive, appendix A) ----------------------------------------------- */

/* The outline extruded to a plate, as Reissner-Mindlin triangles that do not lock: deflection and
 * two rotations at each node. Mutable; holds factor, modes and rigid-body motions from frame to
 * frame. */
typedef struct bw_plate {
  bw_object object;
  const bw_material *material; /* retained */
  double thickness;            /* (m) */
  /* Of the present state; they live until the next operation that succeeds. */
  const bw_plane_mesh *mesh; /* order 2 */
  int mode_count;
  const double *frequency; /* (Hz, mode_count) ascending, elastic modes only */
  const double *shape; /* (any, mode_count x node_count x 3) deflection, rotations; mass norm 1, the
                          largest deflection positive */
  const double *residual; /* (-, mode_count) sqrt(r . B r / lambda): error in the energy norm, B the
                             factor used */
  struct bwi_plate *inner;
} bw_plate;
/* A plate without modes yet, on a mesh of order 2. BW_GEOMETRY for an inverted element, BW_LIMIT
 * for a mesh too large. */
BW_API bw_status bw_plate_create(bw_context *context, const bw_plane_mesh *mesh,
                                 const bw_material *material, double thickness, bw_plate **plate);
/* Continues on another mesh; the modes are transferred (bw_plane_transfer) as the initial guess of
 * the next solution. Those of bw_plate_create. `reuse` may be NULL. */
BW_API bw_status bw_plate_follow(bw_context *context, bw_plate *plate, const bw_plane_mesh *mesh,
                                 bw_plane_reuse *reuse);
/* The state of a plate, an immutable object. Returning to it restores mesh and modes bit for bit.
 * The operations of a plate replace its present state at their end: those that fail change
 * nothing. */
typedef struct bw_plate_state bw_plate_state;
/* The state of a plate, one reference to be released. */
BW_API const bw_plate_state *bw_plate_keep(const bw_plate *plate);
/* Returns a plate to a state. */
BW_API bw_status bw_plate_return(bw_context *context, bw_plate *plate, const bw_plate_state *state);
BW_API bw_status bw_plate_check(bw_context *context, const bw_plate *plate);
/* How modes are found. */
typedef struct bw_plate_options {
  int modes;        /* default 1, 1 or more, fewer than the unknowns */
  double tolerance; /* (-) of `residual`; the frequency's error is its square; default 1e-6, > 0 */
  const bw_eigensolver *solver; /* borrowed: BW_EIGENSOLVER_LOBPCG, or NULL, the default: automatic,
                                   which is the same */
  int max_lag;                  /* as in bw_lagged_factor_options: 0 or more; default INT_MAX */
  bool full; /* random start, new factor: for checks and baselines; default false */
} bw_plate_options;
BW_API void bw_plate_options_default(bw_plate_options *options);
/* LOBPCG with the rigid-body motions projected out, from the last frame's modes on the last frame's
 * factor; with a fresh factor at least as fast as inverse iteration. BW_INVALID for another
 * eigensolver. BW_CONVERGENCE where it does not reach the tolerance and BW_SINGULAR where the
 * factor fails leave the plate as it was. `options` and `reuse` may be NULL. */
BW_API bw_status bw_plate_solve(bw_context *context, bw_plate *plate,
                                const bw_plate_options *options, bw_plane_reuse *reuse);
/* d frequency[mode] / d node positions: gradient (Hz/m, node_count x 2). */
BW_API bw_status bw_plate_gradient(bw_context *context, const bw_plate *plate, int mode,
                                   double *gradient);
/* A stroke and its recording. */
typedef struct bw_tone {
  double at[2];   /* of the stroke; default nan: where the lowest mode deflects most */
  double loss;    /* (-) loss factor of material and mounting; default 0.002, > 0 */
  double contact; /* (s) of the mallet; default 0.3e-3, 0 or more */
  double seconds; /* default 2, > 0 */
  int32_t rate;   /* samples per second; default 44100, 1000 or more */
} bw_tone;
BW_API void bw_tone_default(bw_tone *tone);
/* The sound of a stroke at a place: modes k in proportion to their deflection there, each with the
 * decay exp(-pi loss f t), softened by the mallet's time of contact. Scaled so that the loudest
 * sample is 0.9: sample (-, seconds * rate rounded down). `tone` may be NULL. */
BW_API bw_status bw_plate_tone(bw_context *context, const bw_plate *plate, const bw_tone *tone,
                               double *sample);
/* The amplitude of each mode in it: gain (-, mode_count), signed, the largest 1 in size. */
BW_API bw_status bw_plate_gains(bw_context *context, const bw_plate *plate, const bw_tone *tone,
                                double *gain);
/* Where the deflection of a `mode` vanishes: lines (m, count x 4), pieces x0 y0 x1 y1, to be
 * released with bw_free. For the mounting holes. */
BW_API bw_status bw_plate_nodal_lines(bw_context *context, const bw_plate *plate, int mode,
                                      int32_t *count, double **lines);
/* The lowest frequencies of motion in the plane of the plate (plane stress, free), to see whether
 * one lies below: frequency (Hz, count). BW_CONVERGENCE and BW_SINGULAR as bw_plate_solve. */
BW_API bw_status bw_plate_inplane(bw_context *context, const bw_plate *plate, int count,
                                  double *frequency);
#ifdef __cplusplus
}
#endif
#endif
