/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* What the files of drop/ share. */
#ifndef BWI_DROP_INTERNAL_H
#define BWI_DROP_INTERNAL_H

#include "barwright/drop.h"

/* ---- motion.c -------------------------------------------------------------------------------- */

/* A rigid body that carries modes. Vectors are those of space, but for `inverse`. */
typedef struct bwi_drop_motion {
  int modes;
  double mass, gravity[3];
  double inertia[9], inverse[9]; /* about the centre of mass, in the body's frame */
  double time, centre[3], velocity[3];
  double turn[9];          /* takes vectors of the body to space */
  double momentum[3];      /* angular, about the centre of mass */
  double damped;           /* (J) */
  double *omega, *damping; /* (modes) rad/s, and c of q'' + c q' + omega^2 q */
  double *q, *rate;        /* (modes) */
  double step;             /* of `map` */
  double *map;             /* (modes x 4) of (q, q') over a step */
} bwi_drop_motion;
/* With the `count` lowest modes. */
bw_status bwi_drop_motion_create(bw_context *context, const bw_modes *modes, int count,
                                 const bw_damping *damping, bwi_drop_motion *motion);
void bwi_drop_motion_clear(bwi_drop_motion *motion);
/* The state of `from`, of the same body. */
void bwi_drop_motion_copy(const bwi_drop_motion *from, bwi_drop_motion *to);
void bwi_drop_spin(const bwi_drop_motion *motion, double spin[3]);
/* Free flight over a step. */
void bwi_drop_drift(bwi_drop_motion *motion, double step);

/* ---- the run --------------------------------------------------------------------------------- */

/* Points of the body that may touch, and how the modes move them. */
typedef struct bwi_drop_points {
  int32_t count;
  int32_t *node;     /* (count) */
  double *at;        /* (count x 3) from the centre of mass */
  double *area;      /* (count x 3) outward area of the facets around */
  double *basis;     /* (count x 3 x modes) */
  double *mode_size; /* (modes) the longest motion of a point */
  double radius;     /* of the body about its centre of mass */
} bwi_drop_points;

/* The contact of one impact: w = gap + S force >= 0, force >= 0, w force = 0. Of `known` points
 * what the modes leave of the compliance is there; the first `count` of them are candidates. */
typedef struct bwi_drop_touch {
  int count, known;
  int32_t *point;                  /* (known) */
  double *push;                    /* (known x 3) the force of size 1, in the body's frame */
  double *whole;                   /* (known) the compliance of the point, modes included */
  double *flexibility;             /* (known x known) what the modes leave */
  double largest;                  /* of its diagonal entries, also of points known before */
  double *s;                       /* (count x count) */
  double *gap, *force, *w, *slack; /* (count) */
  double *normal, *arm;            /* (count x 3) in space; arm from the centre of mass */
  uint8_t *active;                 /* (count) */
  int capacity;                    /* of candidates */
  int32_t *place;                  /* (points) among the known ones, or -1 */
  int32_t *near;                   /* (points) */
  int32_t near_count;              /* which are within `limit` */
  double limit, traveled;          /* of the gap; and by how much it may have changed since */
  double stiffest;                 /* (rad/s) of the contact on the rigid body and the modes */
  int stiffest_of;                 /* candidates */
} bwi_drop_touch;

typedef struct bwi_drop_run {
  const bw_model *model;
  bw_system *system;
  const bw_modes *modes;
  bw_drop_options options;
  bw_rigid_surface onto; /* where the body of the mesh touches it */
  double depth;          /* (m) of it between nodes then */
  double origin[3];      /* centre of mass in the mesh */
  double margin;         /* of the gap, within which points become candidates with others */
  double slack;          /* (m) penetration that is none */
  double beyond;         /* the longest motion by contact over its bound, of one impact */
  bwi_drop_points points;
  bwi_drop_motion motion;
  bwi_drop_touch touch;
  struct bwi_drop_sampled *sampled; /* (options.impacts) */
  int sampled_count;
  int solves;
} bwi_drop_run;

/* ---- memory.c -------------------------------------------------------------------------------- */

/* BW_MEMORY where there is no room for so many numbers of eight bytes. `what`: plural. */
bw_status bwi_drop_check_memory(bw_context *context, double numbers, const char *what,
                                const char *advice);

/* ---- points.c -------------------------------------------------------------------------------- */

bw_status bwi_drop_points_create(bw_context *context, bwi_drop_run *run);
void bwi_drop_points_clear(bwi_drop_points *points);
/* A vector of the body's frame in space, and back. */
void bwi_drop_to_space(const double turn[9], const double body[3], double space[3]);
void bwi_drop_to_body(const double turn[9], const double space[3], double body[3]);
/* The gap of a point of the rigid body. */
double bwi_drop_rigid_gap_at(const bwi_drop_run *run, int32_t point);
/* The gap where the modes have a point, with normal and arm in space. */
double bwi_drop_gap_at(const bwi_drop_run *run, int32_t point, double normal[3], double arm[3]);
/* Whether the body is between a point and the obstacle: others touch before it. */
bool bwi_drop_faces_away(const bwi_drop_run *run, int32_t point, const double normal[3]);
/* The smallest gap of the points without deformation; and that over the plane across a normal on
 * the obstacle, all of which is below. */
double bwi_drop_rigid_gap(const bwi_drop_run *run);
double bwi_drop_plane_gap(const bwi_drop_run *run, const double normal[3]);

/* ---- flexibility.c --------------------------------------------------------------------------- */

/* force^T S force (J). */
double bwi_drop_contact_energy(const bwi_drop_touch *touch);
/* Bound of how far the contact moves a point, beside the modes, at forces with force^T S force. */
double bwi_drop_contact_reach(const bwi_drop_touch *touch, double energy);
/* The normal at a point, in the body's frame. */
void bwi_drop_push(const bwi_drop_run *run, int32_t point, double push[3]);
/* (modes) a unit force `push` at a point on the modes. */
void bwi_drop_modal_force(const bwi_drop_run *run, int32_t point, const double push[3],
                          double *force);
/* Makes `more` points of `near` known, and those nearest to the obstacle; candidates stay. */
bw_status bwi_drop_know(bw_context *context, bwi_drop_run *run, int more, const int32_t *which);
/* Makes a known point the last candidate, known for its present normal. The caller has grown what
 * candidates have. */
void bwi_drop_promote(bwi_drop_touch *touch, int32_t point);

/* ---- touch.c --------------------------------------------------------------------------------- */

bw_status bwi_drop_touch_create(bw_context *context, const bwi_drop_run *run,
                                bwi_drop_touch *touch);
void bwi_drop_touch_clear(bwi_drop_touch *touch);
/* The forces of contact in the present position. */
bw_status bwi_drop_touch_find(bw_context *context, bwi_drop_run *run);
/* Their sum. */
void bwi_drop_force(const bwi_drop_run *run, double force[3]);
/* The angle in the body between the normals and those that the compliance has, at most. */
double bwi_drop_turn(const bwi_drop_run *run);
/* The impulse of these forces over a time. */
void bwi_drop_kick(bwi_drop_run *run, double time);
/* Bounds of how far a point may be from where the rigid body has it, now and in free flight from
 * here on, and of how fast. */
double bwi_drop_reach(const bwi_drop_run *run);
double bwi_drop_speed(const bwi_drop_run *run);

/* ---- place.c --------------------------------------------------------------------------------- */

/* Where the body meets the obstacle, once its centre of mass is known. BW_GEOMETRY where it misses,
 * BW_LIMIT for elements that are too large for the obstacle. */
bw_status bwi_drop_place(bw_context *context, bwi_drop_run *run);

/* ---- record.c -------------------------------------------------------------------------------- */

/* Parts of the energy (J). */
typedef struct bwi_drop_energy {
  double motion, vibration, strain, potential;
} bwi_drop_energy;
bwi_drop_energy bwi_drop_energy_of(const bwi_drop_run *run);

/* Rows at every `stride`-th step; when `capacity` are there, every second one goes. */
typedef struct bwi_drop_rows {
  int capacity, count, width;
  int64_t stride, seen;
  double *row; /* (capacity x width) */
} bwi_drop_rows;
bw_status bwi_drop_rows_create(bw_context *context, int capacity, int width, bwi_drop_rows *rows);
/* Where the row of this step goes, or NULL. */
double *bwi_drop_rows_next(bwi_drop_rows *rows);

/* States of an impact at even times, for its stress. */
typedef struct bwi_drop_state {
  double time;
  double reach; /* (m) bwi_drop_contact_reach */
  int count;    /* of forces */
  double *data; /* modes, then forces */
} bwi_drop_state;
typedef struct bwi_drop_states {
  int capacity, count;
  int64_t stride, seen;
  bwi_drop_state *state; /* (capacity) */
} bwi_drop_states;
bw_status bwi_drop_states_take(bw_context *context, const bwi_drop_run *run,
                               bwi_drop_states *states);
void bwi_drop_states_empty(bwi_drop_states *states);
/* The states of one impact whose stresses are in the result, and the forces of size 1. */
typedef struct bwi_drop_sampled {
  bwi_drop_states states;
  int count;      /* candidates */
  int32_t *point; /* (count) */
  double *push;   /* (count x 3) */
} bwi_drop_sampled;
/* Adds the stresses of the states to the result, and with `history` moves them to `sampled`. */
bw_status bwi_drop_states_stress(bw_context *context, bwi_drop_run *run, bwi_drop_states *states,
                                 bw_drop *drop);
/* The stress of the element of the peak in all states, once no other can have the peak. */
bw_status bwi_drop_peak_history(bw_context *context, bwi_drop_run *run, bw_drop *drop);
void bwi_drop_sampled_clear(bwi_drop_run *run);

#endif
