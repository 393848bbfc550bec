/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* What the files of contact/ share. */
#ifndef BWI_CONTACT_INTERNAL_H
#define BWI_CONTACT_INTERNAL_H

#include <math.h>

#include "barwright/contact.h"
#include "barwright/statics.h"
#include "joint/joined_solution.h"
#include "linear/compliance.h"

/* ---- rigid_surface.c ------------------------------------------------------------------------- */

/* A copy. */
bw_status bwi_rigid_create(bw_context *context, const bw_rigid_surface *like,
                           bw_rigid_surface **surface);
/* The gap at x, negative inside of the obstacle, and the outward normal of the nearest point. */
double bwi_rigid_gap(const bw_rigid_surface *surface, const double x[3], double normal[3]);
/* How far x goes along a direction of length 1 until it meets the surface from outside, of any
 * sign; infinite where it misses. */
double bwi_rigid_travel(const bw_rigid_surface *surface, const double x[3], const double way[3]);
/* How deep a triangle reaches into a sphere or cylinder, negative outside of it; 0 of a plane. With
 * a way (or NULL): as seen along it. */
double bwi_rigid_depth(const bw_rigid_surface *surface, const double *const corner[3],
                       const double *way);

/* ---- contact_rows.c -------------------------------------------------------------------------- */

/* A point of the rule on a selected facet. */
typedef struct bwi_contact_point {
  int32_t facet;
  int32_t pair;
  int32_t candidate[3]; /* of the facet's corners, */
  double hat[3];        /* and their hat functions */
  double shape[6];      /* of the facet's nodes */
  double area;          /* weight times area; in finite sliding 0 where it faces nothing: */
  double whole;         /* else it is this */
  double normal[3];     /* outward from the obstacle, where the point is now */
  double gap;           /* there */
  int32_t opposite;     /* against facets: that which the point faces, */
  double far[6];        /* the shapes of its nodes there, */
  double apart;         /* and the gap without displacement; in finite sliding: now */
} bwi_contact_point;

/* The rows B of all pairs: a candidate is a corner of the facets of one pair. It has a row along
 * the normal, and with friction two along its tangents. */
typedef struct bwi_contact_rows {
  const bw_mesh *mesh;
  int pair_count;
  const bw_contact_pair *pair;
  bool finite;   /* what points face is found where they are now */
  int32_t count; /* of candidates, pair by pair, by ascending nodes */
  int32_t *node; /* (count) */
  int32_t *of;   /* (count) the pair */
  double *area;  /* (count) integral of the hat function; 0: it faces nothing */
  double *whole; /* (count) the same of all points; NULL without finite sliding */
  int32_t row_count;
  int32_t *first; /* (count + 1) row of each candidate, which is that along the normal */
  double
      *tangent; /* (count x 6) two of each, of length 1 and orthogonal; unused without friction */
  int64_t point_count;
  bwi_contact_point *point;
  double *height;    /* (facet_count of the mesh x 3) of round faces over the facets' edges */
  int64_t *touching; /* (3 x point_count) 3 x point + corner, by candidates */
  int64_t *start;    /* (row_count + 1) entries of each row of B: */
  int32_t *column;   /* a node, */
  double *value;     /* (entries x 3) and what B has there */
} bwi_contact_rows;
/* Copies that retain what the pairs have, into `copy` (pair_count). */
void bwi_contact_pairs_retain(int pair_count, const bw_contact_pair *pair, bw_contact_pair *copy);
/* Frees such copies; nothing for NULL. */
void bwi_contact_pairs_release(int pair_count, bw_contact_pair *copy);
/* BW_INVALID for a selection of another mesh and for facets that a bond joins, BW_EMPTY for a
 * selection without a facet. */
bw_status bwi_contact_rows_create(bw_context *context, const bw_model *model, int pair_count,
                                  const bw_contact_pair *pair, bool finite, bwi_contact_rows *rows);
void bwi_contact_rows_clear(bwi_contact_rows *rows);
/* Takes normals and gaps where the displacement brings the points, and B there; gap (row_count) are
 * their integrals with the hat functions, 0 along tangents. */
bw_status bwi_contact_rows_linearise(bw_context *context, bwi_contact_rows *rows,
                                     const double *displacement, double *gap);
/* S = B G B^T of the rows in `row` (count), as bwi_compliance_of. */
bw_status bwi_contact_rows_compliance(bw_context *context, const bwi_contact_rows *rows,
                                      bw_system *system, int count, const int32_t *row, int first,
                                      bwi_half_solves *kept, double *s);
/* gap (row_count) = B u. */
void bwi_contact_rows_measure(const bwi_contact_rows *rows, const double *u, double *gap);
/* force (node_count x 3) = B^T p for p (row_count). */
void bwi_contact_rows_force(const bwi_contact_rows *rows, const double *p, double *force);
/* The same of one pair, on its facets `on` alone, of friction alone or in all. */
void bwi_contact_rows_pair_force(const bwi_contact_rows *rows, int pair, bool friction,
                                 const double *p, double *force);

/* (m) How far a point of a pair under pressure is displaced along what it touches. */
double bwi_contact_rows_slid(const bwi_contact_rows *rows, int pair, const double *p,
                             const double *u);

/* ---- opposite_facets.c ----------------------------------------------------------------------- */

/* Finds what the points of a pair against facets face in the shape of `mesh`, which may have
 * moved; -1: nothing. */
bw_status bwi_contact_find_opposite(bw_context *context, const bw_mesh *mesh,
                                    const bw_contact_pair *pair, bool moved, int64_t count,
                                    bwi_contact_point *point);

/* ---- smooth_faces.c -------------------------------------------------------------------------- */

/* The heights (m) of round faces over the middles of the edges of the facets of a selection, edge
 * k from corner k to the next, outward: into `height` (facet_count of the mesh x 3). */
bw_status bwi_contact_take_heights(bw_context *context, const bw_mesh *mesh, const bw_selection *on,
                                   double *height);
/* (m) By how much the gap at a point is larger between round faces. */
double bwi_contact_smoothing(const bw_mesh *mesh, const double *height,
                             const bwi_contact_point *point);

/* ---- complementarity.c ----------------------------------------------------------------------- */

/* Find p >= 0 and a with w = q + S p + E a >= 0, p w = 0, E^T p + load = epsilon (a - centre). */
typedef struct bwi_complementarity {
  int count, motions;
  const double *s;      /* (count x count) symmetric, positive definite but for rounding */
  const double *q;      /* (count) */
  const double *e;      /* (count x motions) */
  const double *load;   /* (motions) */
  const double *centre; /* (motions) */
  double epsilon;       /* above 0 where there are motions */
  const double *slack;  /* (count) w above -slack counts as 0 */
  uint8_t *active;      /* (count) where it begins, and the result */
  double *p, *w;        /* (count) */
  double *a;            /* (motions) */
  double *h;            /* (motions x motions) E_A^T S_AA^-1 E_A */
  int changes;          /* grows by candidates that changed sides */
} bwi_complementarity;
/* BW_CONVERGENCE where rounding keeps the candidates changing. */
bw_status bwi_complementarity_solve(bw_context *context, bwi_complementarity *problem);

/* ---- friction.c ------------------------------------------------------------------------------ */

/* What a candidate does. */
typedef enum bwi_contact_status { BWI_OPEN, BWI_STICKS, BWI_SLIPS } bwi_contact_status;

/* Coulomb's law on the rows of candidates: find p and a with w = q + S p + E a and
 * E^T p + load = epsilon (a - centre). The first row of a candidate is as in bwi_complementarity;
 * its two others, where it has friction, are tangential: |t| <= friction p, and w is 0 or against t
 * on the cone. */
typedef struct bwi_friction {
  int count, rows, motions;
  const int32_t *first;   /* (count + 1) row of each candidate */
  const double *friction; /* (count) */
  const double *s;        /* (rows x rows) as there, like what follows */
  const double *q;        /* (rows) */
  const double *e;        /* (rows x motions) */
  const double *load, *centre;
  double epsilon;
  bool patient;        /* takes long before it fails */
  const double *slack; /* (count) of rows along normals */
  uint8_t *state;      /* (count) the result: bwi_contact_status */
  double *p;           /* (rows) where it begins, and the result */
  double *a;           /* (motions) likewise */
  double *h;           /* (motions x motions) by which forces on motions grow with these */
  int changes;         /* grows by candidates that changed their state */
  int worst;           /* of BW_CONVERGENCE: the candidate that is farthest from its law, */
  double change;       /* and by how much, over the largest pressure */
} bwi_friction;
/* BW_CONVERGENCE, without a message, where no equilibrium is found. */
bw_status bwi_friction_solve(bw_context *context, bwi_friction *problem);

/* ---- rigid_start.c --------------------------------------------------------------------------- */

/* Motions a of rigid bodies on springs of stiffness (N/m3) at the rows, whose gaps are q + E a and
 * whose areas are area. */
typedef struct bwi_rigid_start {
  int count, motions;
  const double *q, *e, *area; /* as in bwi_complementarity; (count) */
  const uint8_t *pulls;       /* (count) springs along tangents, which pull too */
  const double *load;         /* (motions) */
  double stiffness;
  double *a;      /* (motions) the result */
  double scale;   /* the result: a mean stiffness (N/m) of the motions on the springs in touch */
  double *unheld; /* (motions) the part of the load that nothing holds */
  bool held;      /* there is none */
  double reach;   /* (m) a motion that the load reaches against the softest springs */
} bwi_rigid_start;
bw_status bwi_rigid_start_find(bw_context *context, bwi_rigid_start *start);

/* ---- contact.c ------------------------------------------------------------------------------- */

/* The state of a solution: u = u_0 + G B^T p + R a. */
typedef struct bwi_contact_problem {
  const bw_model *model;
  const bw_contact_options *options;
  bw_system *system;
  const bwi_joined_solution *joined; /* borrowed from the system: of a joined model, or NULL */
  bw_static *start;                  /* the solution without contact */
  int step;                          /* of options->steps, from 1 */
  bwi_contact_rows rows;
  int count, motions;
  bool curved;     /* rigid surfaces are */
  bool finite;     /* sliding between parts */
  double facet;    /* (m) size of their facets */
  double young;    /* of the first element, to tell sizes */
  double *base;    /* (node_count x 3) u_0: that of the loads of this step */
  double *load;    /* (motions) R^T f of this step */
  double *a;       /* (motions) */
  double *q;       /* (rows) gaps of u_0; slip of u_0 since the step before */
  double *e;       /* (rows x motions) */
  double *p;       /* (rows) */
  double *w;       /* (rows) gaps and slip */
  double *now;     /* (node_count x 3) u */
  double *pressed; /* (node_count x 3) G B^T p */
  double *before;  /* (node_count x 3) u after the step before; NULL without friction */
  double *slip;    /* (count x 3) summed over the steps, in the mean; NULL without friction */
  double *work;    /* (pair_count) of friction, summed over the steps */
  int working;     /* candidates in the working set, */
  int32_t *member; /* (count) which, */
  int32_t *place;  /* (count) their place in it, or -1, */
  uint8_t *active; /* (count) by place: not 0, or with friction bwi_contact_status, */
  int row_count;   /* their rows, */
  int32_t *row;    /* (rows) which, */
  double *s;       /* (row_count x row_count) and their part of S, */
  bwi_half_solves halves;  /* with what more rows take */
  double elastic;          /* the largest mean displacement that pressure causes at a candidate */
  double rounded;          /* (m) of gaps between coordinates */
  double epsilon, softest; /* springs on motions */
  bool last_try;           /* springs are not made stiffer */
  double *h;               /* (motions x motions) */
  int iterations, changes, solves;
} bwi_contact_problem;
static inline int64_t bwi_contact_size(const bwi_contact_problem *problem) {
  return 3 * (int64_t)problem->model->mesh->node_count;
}
/* (m) Penetration that is none. */
static inline double bwi_contact_small_gap(const bwi_contact_problem *problem) {
  return fmax(1e-8 * problem->elastic, problem->rounded);
}
/* Of the load: what springs on motions may carry in the end. */
#define BWI_CONTACT_BALANCED 1e-6

/* ---- bodies.c -------------------------------------------------------------------------------- */

/* Equations, motions, and the solution without contact. */
bw_status bwi_contact_bodies_open(bw_context *context, bwi_contact_problem *problem,
                                  bw_system *given);
/* As bw_rigid_modes_dot, bw_rigid_modes_measure, bw_rigid_modes_add and bwi_describe_motion. */
void bwi_contact_motions_dot(const bwi_contact_problem *problem, const double *force, double *a);
void bwi_contact_motions_measure(const bwi_contact_problem *problem, const double *u, double *a);
void bwi_contact_motions_add(const bwi_contact_problem *problem, const double *a, double *u);
bw_status bwi_contact_motions_describe(bw_context *context, const bwi_contact_problem *problem,
                                       const double *a, char *text, size_t size);
/* The static solution of the model with the contact's forces among its loads. */
bw_status bwi_contact_bodies_static(bw_context *context, const bwi_contact_problem *problem,
                                    const bw_model *loaded, bw_static **result);

/* ---- working_set.c --------------------------------------------------------------------------- */

/* Solves the problem on the working set: pressures and motions. */
bw_status bwi_contact_solve_working(bw_context *context, bwi_contact_problem *problem,
                                    const double *centre);
/* The displacement by the pressures, and the gaps of all candidates. */
bw_status bwi_contact_measure_all(bw_context *context, bwi_contact_problem *problem);
/* Takes in the deepest of those outside that penetrate; *added: how many.
 * BW_INVALID where supports prevent a pair from opening, BW_LIMIT for too many candidates. */
bw_status bwi_contact_take_deepest(bw_context *context, bwi_contact_problem *problem, int *added);
/* S about the present normals, of the candidates with pressure alone. */
bw_status bwi_contact_renew(bw_context *context, bwi_contact_problem *problem);

/* ---- smooth_faces.c -------------------------------------------------------------------------- */

/* Of the largest displacement by the pressure: changes of gaps that are looked at. */
#define BWI_CONTACT_ROUNDS 0.01
/* The pressures (Pa, count) on the working set were facets round, with friction as it is, and the
 * mean changes of gaps (m, count). BW_CONVERGENCE as bwi_complementarity_solve. */
bw_status bwi_contact_round_pressure(bw_context *context, const bwi_contact_problem *c,
                                     double *change, double *pressure);

/* ---- contact_result.c ------------------------------------------------------------------------ */

/* What the solved problem says: a new object, and warnings. */
bw_status bwi_contact_take_result(bw_context *context, bwi_contact_problem *problem,
                                  bw_contact **contact);

#endif
