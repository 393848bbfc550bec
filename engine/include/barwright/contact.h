/* contact: bodies that touch rigid surfaces or each other, without friction or with Coulomb's
 * (docs/theory/contact.md). */
#ifndef BARWRIGHT_CONTACT_H
#define BARWRIGHT_CONTACT_H

#include "barwright/statics.h"

#ifdef __cplusplus
extern "C" {
#endif

/* What a rigid surface is. */
typedef enum bw_rigid_kind {
  BW_RIGID_PLANE,   /* the body stays on the side of the normal */
  BW_RIGID_SPHERE,  /* the body stays outside, or inside */
  BW_RIGID_CYLINDER /* likewise, of infinite length */
} bw_rigid_kind;
/* A rigid surface. It does not change. */
typedef struct bw_rigid_surface {
  bw_object object;
  bw_rigid_kind kind;  /* by which the others are read */
  double point[3];     /* (m) of the plane, the centre, or a point of the axis */
  double direction[3]; /* (-) of length 1: the plane's normal, or the axis; 0 of a sphere */
  double radius;       /* (m) 0 of a plane */
  bool inside;         /* the body is inside of the sphere or cylinder */
  bool placed;         /* `point` was given; else it is the origin, and in a drop the body's centre
                          of mass */
} bw_rigid_surface;
/* A plane through `point` (m), or NULL, with a normal of any length towards the body. BW_INVALID
 * for a normal of no length or numbers that are not finite. */
BW_API bw_status bw_rigid_plane(bw_context *context, const double point[3], const double normal[3],
                                bw_rigid_surface **surface);
/* A sphere about `centre` (m), or NULL, of `radius` (m); `inside`: the body is in it. BW_INVALID
 * for a radius that is not positive or numbers that are not finite. */
BW_API bw_status bw_rigid_sphere(bw_context *context, const double centre[3], double radius,
                                 bool inside, bw_rigid_surface **surface);
/* A cylinder of `radius` (m) about the axis through `point` (m), or NULL, along `axis`, of any
 * length; `inside`: the body is in it. BW_INVALID as bw_rigid_plane and bw_rigid_sphere. */
BW_API bw_status bw_rigid_cylinder(bw_context *context, const double point[3], const double axis[3],
                                   double radius, bool inside, bw_rigid_surface **surface);

/* Facets that may touch a rigid surface, or facets of another part of the mesh. */
typedef struct bw_contact_pair {
  const bw_selection *on;       /* retained by results; with facets. Pressure is on these */
  const bw_rigid_surface *with; /* retained by results; or NULL */
  const bw_selection *against;  /* retained by results; else: with facets that face those of `on` */
  double interference; /* (m) by which gaps are smaller than in the mesh, any sign; default 0 */
  double friction;     /* (-) Coulomb's coefficient of friction, 0 to 100; default 0 */
  bool smooth; /* gaps are those between round faces through the corners, whose normals are means
                  over the facets of a selection that differ by less than 35 degrees; default
                  false: as the facets are */
} bw_contact_pair;
/* A body in contact. It does not change. */
typedef struct bw_contact bw_contact;

/* How contact is found. */
typedef struct bw_contact_options {
  const bw_solver *solver; /* as of bw_system_of_model; borrowed; default NULL */
  double tolerance;        /* (-) mean gap of an active candidate on a curved surface over the
                              largest displacement by the pressure; above 0 and below 1; default
                              1e-6 */
  int max_iterations;      /* (count) of linearisations in each step, 1 or more; default 30 */
  int steps; /* (count) in which the loads grow in proportion, 1 or more; default 1. With friction
                the result depends on the path of the loads */
  bool finite_sliding;     /* between parts: what faces what is found in the displaced shape, again
                              until it stays; default false. Rotations stay small */
  const bw_contact *after; /* with friction, borrowed: the path goes on from the loads, the place
                              and the slip of this contact with the same pairs; default NULL: at
                              rest, without load */
} bw_contact_options;
/* The defaults. */
BW_API void bw_contact_options_default(bw_contact_options *options);

/* What a pair does. */
typedef struct bw_contact_state {
  double area;        /* (m2) that carries pressure; its border is known to within one element */
  double force[3];    /* (N) on the body at the selected facets, with friction */
  double moment[3];   /* (N m) about the origin */
  double pressure;    /* (Pa) the largest */
  int32_t node;       /* (index) where that is; -1 of an open pair */
  double gap;         /* (m) the smallest of an open pair, 0 of a closed one */
  double penetration; /* (m) the deepest point of the rule: gaps are zero in the mean alone */
  int32_t candidates, active; /* (count) corners of the facets, and those that carry pressure */
  double friction[3];         /* (N) the part of `force` that is friction */
  double stick_area;          /* (m2) the part of `area` that sticks; 0 without friction */
  double slip;                /* (m) the largest at a corner that touches, summed over the steps */
  double work;                /* (J) that friction took, over all steps */
} bw_contact_state;
/* What a node of the facets does. */
typedef enum bw_contact_status {
  BW_CONTACT_OPEN,   /* it carries no pressure */
  BW_CONTACT_STICKS, /* it carries pressure and does not slip */
  BW_CONTACT_SLIPS   /* as all that touches without friction */
} bw_contact_status;

struct bw_contact {
  bw_object object;
  const bw_model *model; /* retained */
  bw_static *solution;   /* retained: of the model with the contact's forces as a load */
  int pair_count;
  bw_contact_pair *pair;   /* (pair_count) */
  bw_contact_state *state; /* (pair_count) */
  double *pressure; /* (Pa, node_count) 0 where nothing touches; at mid-edge nodes the mean of
                       the corners; the larger where pairs meet */
  double *gap; /* (m, node_count) of the deformed body at the nodes of `on`, negative inside of the
                  surface; against facets the mean gap at the corners; infinite at the others */
  bool has_friction;   /* in some pair; else what follows up to `status` is NULL */
  double *traction;    /* (Pa, node_count x 3) friction on the facets `on`, as `pressure` */
  double *slip;        /* (m, node_count x 3) of the corners of `on` against what they touch, in the
                          mean, summed over the steps in which they slip; 0 at mid-edge nodes */
  double *corner_slip; /* (m, candidates x 3) the same by candidates of all pairs */
  double *work;        /* (J, pair_count) that friction took */
  bw_static *start;    /* retained: the solution without contact, */
  const struct bwi_joined_solution *joined; /* and what its system has of a joined model, or NULL */
  uint8_t *status; /* (node_count) bw_contact_status of the corners of `on` */
  int steps;       /* in which the loads grew, with those of the contact before */
  int iterations;  /* linearisations */
  int changes;     /* of the active set: candidates that entered or left it */
  int solves;      /* right-hand sides solved for */
  double rotation; /* (rad) the largest of a body, by least squares over its nodes */
  int free_count;  /* motions along which nothing decides the position */
  char *free_text; /* these motions, one in each line; "" without */
  char *notes; /* what the result leaves undecided and what is beyond its theory: the warnings of
                  bw_contact_solve, one in each line; "" without */
  bw_solver_report report; /* of the equations */
};
/* A model in contact by pair (pair_count, 1 or more), for small strains and rotations, and for
 * small sliding unless `finite_sliding`. Of a joined model by the factor of a solver NULL or
 * Cholesky; the static solution has what its joints exert.
 * `given` as of bw_system_of_model; unused for a joined model. `options` may be NULL. A warning
 * names pairs that stay open or penetrate for want of smaller facets, motions and pressures that
 * nothing decides, and rotations that are not small. BW_UNCONSTRAINED where neither supports nor
 * contact balance the load, and for loads of bw_statics that no support takes; BW_CONVERGENCE where
 * the linearisation of curved surfaces or the active set do not come to an end, and where friction
 * finds no equilibrium; BW_INVALID for a selection of another mesh, a pair without exactly one of
 * `with` and `against`, which may have no node in common with `on`, facets of which none faces
 * those, facets that a bond joins, an `after` of another mesh, material, facets, joints or
 * supported nodes or without friction, and where supports press the body into a surface; BW_EMPTY
 * for a selection without a facet, BW_LIMIT for a body that rotates by more than 0.2 rad in finite
 * sliding, for more than 8000 unknowns of corners that touch, one each or three with friction, or
 * 6000 free rigid-body modes, 200 of a joined model, BW_UNSUPPORTED for an external solver, and for
 * a sector and a solver without a factor of a joined one; those of bw_statics, bw_joined_system and
 * bw_system_solve. */
BW_API bw_status bw_contact_solve(bw_context *context, const bw_model *model, int pair_count,
                                  const bw_contact_pair *pair, bw_system *given,
                                  const bw_contact_options *options, bw_contact **contact);

/* Parts in contact without friction under many loads: the equations without contact, and the
 * compliance of all corners that may touch. It does not change. */
typedef struct bw_contact_system {
  bw_object object;
  const bw_model *model; /* retained */
  bw_system *system;     /* retained: the equations without contact */
  int pair_count;
  bw_contact_pair *pair; /* (pair_count) */
  int count;             /* candidates: corners of the facets that supports let move */
  bool closed;           /* all of them touch without a load: no gap, no interference */
  bw_selection *cuts;    /* retained: facets that face over more than half of their area, nearer
                                  than their size, what they may touch; or NULL */
  struct bwi_contact_rows *rows; /* the conditions, */
  int32_t *row;                  /* (index, count) which of them are of candidates, */
  double *gap;                   /* (m3, count) gaps without a load, times areas, */
  double *s;                     /* (any, count x count) and the compliance */
} bw_contact_system;
/* For a model by pair (pair_count, 1 or more); `solver` and `given` as of bw_system_of_model; of
 * joined models as of bw_joined_system. Sliding is small. Loads of the model are left out.
 * BW_UNSUPPORTED for friction, curved rigid surfaces, prescribed displacements other than zero and
 * a solver that is not BW_SOLVER_CHOLESKY, BW_UNCONSTRAINED where supports and bonds leave a
 * rigid-body motion free, BW_INVALID where they constrain all corners and for pairs that
 * bw_contact_solve refuses, BW_EMPTY for a selection without a facet, BW_LIMIT for more than 8000
 * corners; those of bw_system_of_model and bw_system_factor, or bw_joined_system. */
BW_API bw_status bw_contact_system_create(bw_context *context, const bw_model *model,
                                          int pair_count, const bw_contact_pair *pair,
                                          const bw_solver *solver, bw_system *given,
                                          bw_contact_system **result);
/* For `count` loads, force (N, count x node_count x 3): displacement (m, count x node_count x 3),
 * which may be the same block, and state (count x contact->count), which may be NULL: 1 where a
 * candidate carries pressure. Each is the solution with contact, by two solutions with the factor.
 * BW_CONVERGENCE where rounding keeps the candidates changing, BW_SINGULAR where their compliance
 * is; those of bw_system_solve. */
BW_API bw_status bw_contact_system_solve(bw_context *context, const bw_contact_system *contact,
                                         int count, const double *force, double *displacement,
                                         uint8_t *state);
/* The equations in which the candidates of `state` (contact->count) that are not 0 have no gap,
 * whichever sign their pressure has, and the others are open. Those whose gap others decide are
 * left out. The equations retain `contact`, whose factor they use. */
BW_API bw_status bw_contact_system_in_state(bw_context *context, bw_contact_system *contact,
                                            const uint8_t *state, bw_system **system);

#ifdef __cplusplus
}
#endif
#endif
