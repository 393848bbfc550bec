/* drop: a body that falls and hits a rigid obstacle, in time (docs/theory/drop.md). */
#ifndef BARWRIGHT_DROP_H
#define BARWRIGHT_DROP_H

#include "barwright/contact.h"
#include "barwright/dynamics.h"

#ifdef __cplusplus
extern "C" {
#endif

/* How a body is dropped. The mesh shows its attitude when it touches. Pointers are borrowed. */
typedef struct bw_drop_options {
  double height;  /* (m) of the fall until it touches, 0 or more; default 1 */
  double speed;   /* (m/s) along `down` when it touches, in place of the height; default 0: by the
                     height; 0 or more */
  double gravity; /* (m/s2) along `down`, 0 or more; default 9.80665 */
  double down[3]; /* (-) where it falls, of any length; default 0 0 -1 */
  double spin[3]; /* (rad/s) angular velocity when it touches; default 0 */
  const bw_rigid_surface *onto; /* default NULL: a plane across `down`. It is moved along `down` to
                                   where the body touches it; one without a place is put below the
                                   centre of mass. The body is outside of it */
  bw_damping damping;           /* ratio and stiffness alone; default none */
  const bw_modes *modes; /* elastic modes of the model; default NULL: the lowest 40, or half of
                            those of a small mesh */
  int impacts; /* (count) that are followed, 1 or more; default 1. One is over when no force has
                  acted for a period of the lowest mode */
  double time; /* (s) at which it ends at the latest, 0 or more; default 0: no limit */
  double tolerance; /* (-) error of the energy over the kinetic energy when it touches, for which
                       steps are halved; above 0; default 1e-3 */
  int samples; /* (count) of the stress in each impact, at least, 0 or more; default 100; 0: none */
  bool history; /* `peak_stress` of the result, for six solutions; default true */
  bool fewer;   /* drop it again with half of the modes: `fewer` of the result; default false */
} bw_drop_options;
BW_API void bw_drop_options_default(bw_drop_options *options);

/* One impact. */
typedef struct bw_drop_impact {
  double time;      /* (s) of the first force */
  double duration;  /* (s) from the first force to the last */
  double force;     /* (N) the largest force of the contact: the sum over its nodes */
  double peak_time; /* (s) when that is */
  double impulse;   /* (N s) size of the impulse of the contact */
  double area;      /* (m2) the largest area of facets around nodes in contact, seen along the
                       force */
  double turn;      /* (rad) by which a normal of the contact turns in the body, at most */
  double place[3];  /* (m, in the mesh) of the node that touches first */
  int32_t contacts; /* (count) of nodes that touch or come near */
} bw_drop_impact;

/* A drop. It does not change. The time is 0 when the body touches, and positions are those of the
 * mesh then. */
typedef struct bw_drop bw_drop;
struct bw_drop {
  bw_object object;
  const bw_model *model;  /* retained */
  bw_modes *modes;        /* retained */
  int mode_count;         /* (count) of the lowest of them that were taken */
  bw_drop *fewer;         /* the same with half of them, whose changes show an error of the
                             modes that are left out; NULL where none was asked for, and where it
                             fails */
  bw_rigid_surface *onto; /* retained: the obstacle where the body of the mesh touches it */
  double depth;           /* (m) of the obstacle between nodes then: nodes alone touch */
  double mass;            /* (kg) */
  double speed;           /* (m/s) when it touches */
  double energy;          /* (J) kinetic energy when it touches */
  int impact_count;       /* (count) that began */
  bw_drop_impact *impact; /* (impact_count) */
  int row_count;          /* (count) of the history */
  double *time;           /* (s, row_count) */
  double *force;          /* (N, row_count) of the contact */
  double *motion;         /* (J, row_count) kinetic energy of the motion as a rigid body */
  double *vibration;      /* (J, row_count) kinetic energy of the modes */
  double *strain;         /* (J, row_count) strain energy, that of the contact included */
  double *potential;      /* (J, row_count) of the weight, 0 when the body touches */
  double *damped;         /* (J, row_count) that the damping took */
  double error;           /* (-) largest error of their sum over `energy` */
  int sample_count;       /* (count) of stresses */
  double *sample;         /* (s, sample_count) when they were taken */
  double *sample_stress;  /* (Pa, sample_count) the largest principal stress of any element */
  double *stress;      /* (Pa, element_count) the largest principal stress over the samples, or NULL
                          without */
  double *utilisation; /* (-, element_count) the largest over the samples; NULL without samples or
                          strength */
  double peak;         /* (Pa) the largest stress of all, 0 without samples */
  int32_t peak_element; /* (index) where it is, -1 without samples */
  double peak_time;     /* (s) when */
  double *peak_stress;  /* (Pa, sample_count) the largest principal stress of that element; NULL
                           without samples or `history` */
  double *displacement; /* (m, node_count x 3) of the deformation then, in the frame that moves with
                           the body; NULL without samples */
  double velocity[3];   /* (m/s) of the centre of mass at the end */
  double spin[3];       /* (rad/s) angular velocity at the end */
  double step;          /* (s) the shortest */
  int64_t steps;        /* (count) of them, those that were repeated included */
  int solves;           /* right-hand sides, those that half a solution is enough for included */
};
/* Drops a model's body, linear elastic about its motion as a rigid body, without friction. `given`
 * and *system as in bw_modes_of_model: the modes, the equations and their factor serve any number
 * of drops. A warning says when the normals turn so far in the body during an impact that the
 * compliance of the contact changes, and when the contact moves a point farther than the estimate
 * within which points are looked for: with `samples` alone this is known. BW_INVALID for options
 * outside their ranges, a body without density, with supports or loads, or of several parts, and
 * for modes of another model or all that a mesh has; BW_UNSUPPORTED for a surface that the body is
 * inside of, other damping, bonds and attachments; BW_GEOMETRY for a body that misses the obstacle;
 * BW_LIMIT for an obstacle that goes deeper between nodes than a tenth of its radius, more than
 * 2000 nodes that touch in one impact, more than 6000 with those that come near, or an impact
 * without end, BW_SINGULAR and BW_CONVERGENCE where the forces of contact are not found or the
 * energy is not kept; BW_MEMORY where modes, compliances or samples of the stress do not fit, with
 * their size; those of bw_modes_of_model. */
BW_API bw_status bw_drop_of_model(bw_context *context, const bw_model *model, bw_system *given,
                                  const bw_drop_options *options, bw_system **system,
                                  bw_drop **drop);
/* Which of `count` drops, options (count), miss their obstacle: misses (count). It makes no
 * equations and no modes, so that what bw_drop_of_model refuses in any of many drops is known
 * before the work of the first. BW_GEOMETRY where all of them miss; for options, body and place
 * those of bw_drop_of_model. */
BW_API bw_status bw_drop_misses(bw_context *context, const bw_model *model, int count,
                                const bw_drop_options *options, bool *misses);

#ifdef __cplusplus
}
#endif
#endif
