/* dynamics: how a linear body answers forces that change in time (docs/theory/dynamics.md). */
#ifndef BARWRIGHT_DYNAMICS_H
#define BARWRIGHT_DYNAMICS_H

#include "barwright/eigen.h"
#include "barwright/statics.h"

#ifdef __cplusplus
extern "C" {
#endif

/* How a body loses energy as it vibrates. The parts add up. */
typedef struct bw_damping {
  double ratio; /* (-) of the critical damping, the same in each mode; default 0, 0 to below 1 */
  double mass;  /* (1/s) a of C = a M + b K (Rayleigh); default 0, 0 or more */
  double stiffness; /* (s) b of C = a M + b K; default 0, 0 or more */
  double loss;      /* (-) loss factor h of the stiffness (1 + i h) K; default 0, 0 or more */
} bw_damping;

/* ---- harmonic response ----------------------------------------------------------------------- */

/* What a harmonic response is asked for. Pointers are borrowed. */
typedef struct bw_harmonic_options {
  int frequency_count;     /* (count) default 0: `from`, `to` and where the response is sharp */
  const double *frequency; /* (Hz, frequency_count) in any order, 0 or more; default NULL */
  double from, to;         /* (Hz) in their place: default 0, 0 or more; `to` above `from` */
  int modes;   /* (count) of the basis; default 0: all below 1.5 times the highest frequency */
  int vectors; /* (count) of residual vectors at most; default 40, 0: none, up to 400 */
  double
      tolerance; /* (-) as far as residual vectors reduce the error; default 1e-8, 0 to below 1 */
  bw_damping damping;           /* default: none */
  const double *region_loss;    /* (-, mesh->region_count) loss factors of the regions, which add to
                                   that of the damping; default NULL: none; 0 or more */
  double base[3];               /* (m/s2) amplitude of the supports' acceleration; default 0 */
  const bw_eigensolver *solver; /* of the modes; default NULL: automatic. SLEPc does not serve */
} bw_harmonic_options;
BW_API void bw_harmonic_options_default(bw_harmonic_options *options);

/* The response to loads F cos(omega t) as a sum of vectors: modes, then residual vectors. They are
 * orthogonal by stiffness and mass, so that each answers like a body of one unknown. */
typedef struct bw_harmonic {
  bw_object object;
  const bw_model *model; /* retained */
  bw_modes *modes;       /* retained; the first vectors are its shapes */
  bw_damping damping;
  double base[3];      /* (m/s2) */
  int frequency_count; /* (count) */
  double *frequency;   /* (Hz, frequency_count) ascending */
  double *error; /* (-, frequency_count) of the displacement, in energy, over the displacement: a
                    bound where the modes are counted, but for the rounding and the modes' own */
  int count;     /* (count) of vectors, modes->count of them modes */
  double *loss;  /* (-, count) loss factor of each vector: that of the damping, and those of regions
                    by their parts of its strain energy (Johnson and Kienholz, AIAA J. 20, 1982) */
  double *eigenvalue; /* ((rad/s)^2, count) of each vector */
  double *load;       /* (any, count) vector . F, of vectors of unit modal mass */
  double *tail;       /* (any, count) by which the error is found */
  double *residual;   /* (any, count - modes->count x node_count x 3) residual vectors */
  double remainder;   /* (any) without residual vectors: what the modes leave of the load, in the
                         norm of the inverse of K; else 0 */
  double bound;       /* (any) no eigenvalue that is missing has a larger inverse */
  int solves;         /* (count) right-hand sides that residual vectors took */
  int coupling_count; /* of the model's couplings */
  double *point;      /* (m, coupling_count x 3) where their remote points are */
  double *motion; /* (any, count x coupling_count x 6) displacement and rotation of these points in
                     each vector */
  struct bwi_coupling *coupling; /* the engine's own: loss of regions, by which the vectors are not
                                    independent; they are orthogonal by stiffness alone then, and
                                    `tail` and `remainder` are 0. NULL: none */
} bw_harmonic;
/* The harmonic response of a model: its loads, those of remote points too, are the amplitudes, in
 * one phase, and less M times the base's acceleration. The base holds supports, springs, and what
 * of remote points is prescribed. Displacements are relative to it. Bonds keep the shortening of
 * their preloads. The basis are modes and residual vectors by Lanczos's method on what the modes
 * leave of the load (docs/theory/dynamics.md). `given` and *system as in bw_modes_of_model.
 * BW_UNCONSTRAINED for a body that supports leave free to move, BW_UNSUPPORTED for temperatures,
 * prescribed displacements, sectors of cyclic symmetry and SLEPc, BW_INVALID for a body without
 * density, a load of zero, losses of regions on a mesh without regions, frequencies that need more
 * than 2000 modes, where `modes` is 0, and options outside their ranges; BW_SINGULAR as
 * bw_harmonic_coordinates; those of bw_modes_of_model, bw_joined_modes and bw_system_factor.
 */
BW_API bw_status bw_harmonic_of_model(bw_context *context, const bw_model *model, bw_system *given,
                                      const bw_harmonic_options *options, bw_system **system,
                                      bw_harmonic **harmonic);
/* The vectors' factors at a frequency (Hz): coordinate (any, count x 2), real and imaginary; *error
 * (-) may be NULL. BW_SINGULAR at the frequency of a mode that nothing damps, BW_INVALID for a
 * negative one and one beyond those that the response was made for. */
BW_API bw_status bw_harmonic_coordinates(bw_context *context, const bw_harmonic *harmonic,
                                         double frequency, double *coordinate, double *error);
/* The displacement Re(u e^(i omega t)) at a frequency (Hz): real and imaginary (m, node_count x 3).
 * Those of bw_harmonic_coordinates. */
BW_API bw_status bw_harmonic_displacement(bw_context *context, const bw_harmonic *harmonic,
                                          double frequency, double *real, double *imaginary);
/* The displacement of a node over frequencies, frequency (Hz, count): response (m, count x 6), real
 * then imaginary part. BW_INVALID for a node that the mesh does not have; those of
 * bw_harmonic_coordinates. */
BW_API bw_status bw_harmonic_curve(bw_context *context, const bw_harmonic *harmonic, int32_t node,
                                   int count, const double *frequency, double *response);
/* The motion of the remote point of a coupling (index) over frequencies, frequency (Hz, count):
 * response (m, rad, count x 12), displacement and rotation, real parts then imaginary ones.
 * BW_INVALID for a coupling that the model does not have; those of bw_harmonic_coordinates. */
BW_API bw_status bw_harmonic_point_curve(bw_context *context, const bw_harmonic *harmonic,
                                         int coupling, int count, const double *frequency,
                                         double *response);
/* The stress at nodes at a frequency (Hz): real and imaginary (Pa, node_count x 6), and von_mises
 * (Pa, node_count), the largest over a period; where materials meet, that of the material with the
 * largest one. Each may be NULL. Those of bw_harmonic_coordinates. */
BW_API bw_status bw_harmonic_stress(bw_context *context, const bw_harmonic *harmonic,
                                    double frequency, double *real, double *imaginary,
                                    double *von_mises);

/* What an envelope is of. */
typedef enum bw_harmonic_field {
  BW_HARMONIC_DISPLACEMENT, /* (m) its length */
  BW_HARMONIC_VON_MISES     /* (Pa) */
} bw_harmonic_field;
/* The largest of a field over the phase and over frequencies, frequency (Hz, count): value (any,
 * node_count), in m or Pa, and at (Hz, node_count), the frequency of it; peak (any, count), the
 * largest over the nodes at each frequency, and node (index, count) where that is. The first of
 * equal ones. Each may be NULL. The values are those of bw_harmonic_stress up to rounding; the
 * field of each vector is computed once, and kept meanwhile. BW_INVALID for no frequency; those of
 * bw_harmonic_coordinates. */
BW_API bw_status bw_harmonic_envelope(bw_context *context, const bw_harmonic *harmonic,
                                      bw_harmonic_field what, int count, const double *frequency,
                                      double *value, double *at, double *peak, int32_t *node);

/* ---- random vibration ------------------------------------------------------------------------ */

/* Root mean squares of the response where the loads, and the base's acceleration, are multiplied by
 * one random process in time, stationary and of mean 0. Its one-sided power spectral density is
 * given by `count` points, frequency (Hz, count) ascending and density (any, count), 1/Hz: straight
 * lines on logarithmic axes, or on linear ones where a number is 0; nothing outside. displacement
 * (m, node_count x 3) and von_mises (Pa, node_count), of the mean square of von Mises stress
 * (Segalman, Fulcher, Reese, Field, SAND98-0260, 1998); motion (m, rad, coupling_count x 6), the
 * displacement and rotation of remote points; *error (-) of the displacement, in energy, as of the
 * harmonic response. Each may be NULL. BW_SINGULAR for a mode or residual vector in the
 * range that nothing damps (a ratio damps modes alone), BW_INVALID for points that do not ascend,
 * reach beyond the response's highest frequency, or are negative. */
BW_API bw_status bw_harmonic_random(bw_context *context, const bw_harmonic *harmonic, int count,
                                    const double *frequency, const double *density,
                                    double *displacement, double *von_mises, double *motion,
                                    double *error);

/* How far random vibration stays from a strength (Pa), or for 0 from that of each material
 * (docs/theory/dynamics.md): the process of bw_harmonic_random, frequency (Hz, count) and density
 * (any, count), taken as Gaussian. probability (-, node_count) that von Mises stress exceeds the
 * strength at an instant, by the distribution of its quadratic form; rate (1/s, node_count) of
 * upcrossings through it, an upper bound, which is Rice's where one component of stress acts; used
 * (-, node_count), sigma (-) times the root mean square over the strength; beyond (-, node_count),
 * the probability that von Mises stress exceeds sigma times its root mean square. Where materials
 * meet, the largest counts. Static stresses are not in it. BW_INVALID for a strength below 0, a
 * sigma that is not above 0, and for strength 0 where a material has no strength that is one
 * number; those of bw_harmonic_random. */
BW_API bw_status bw_harmonic_margins(bw_context *context, const bw_harmonic *harmonic, int count,
                                     const double *frequency, const double *density,
                                     double strength, double sigma, double *probability,
                                     double *rate, double *used, double *beyond);

/* ---- response spectrum ----------------------------------------------------------------------- */

/* How the largest responses of modes, which differ in time, are combined. */
typedef enum bw_combination {
  BW_CQC,     /* complete quadratic: by the correlation of modes */
  BW_SRSS,    /* root of the sum of squares: for frequencies far apart */
  BW_ABSOLUTE /* sum of magnitudes: a bound */
} bw_combination;
/* What a response spectrum is asked for. Pointers are borrowed. */
typedef struct bw_response_spectrum_options {
  int count;                  /* (count) of points, 2 or more; no default */
  const double *frequency;    /* (Hz, count) ascending, above 0 */
  const double *acceleration; /* (m/s2, count) largest absolute acceleration of an oscillator of
                                 that frequency on the base, above 0: straight lines on logarithmic
                                 axes; the last is that of the base itself */
  double direction[3]; /* (-) of the base's acceleration, of any length above 0; no default */
  double
      ratio; /* (-) of the critical damping, that of the points; default 0.05, above 0 to below 1 */
  bw_combination combination; /* default BW_CQC */
  bool missing_mass; /* with the static response of what the modes leave out; default true */
  const bw_eigensolver *solver; /* of the modes; default NULL: automatic. SLEPc does not serve */
  bw_modes *modes; /* elastic modes of the model, the last one at or above the last point, unless
                      these are all; retained; default NULL: by `solver` */
} bw_response_spectrum_options;
BW_API void bw_response_spectrum_options_default(bw_response_spectrum_options *options);

/* The largest response of a body whose supports are shaken, by the modes up to the last point. */
typedef struct bw_response_spectrum {
  bw_object object;
  const bw_model *model; /* retained */
  uint64_t revision;     /* of the model when the response was made */
  bw_modes *modes;       /* retained; the first `count` of them are in the response */
  bw_combination combination;
  double ratio;           /* (-) */
  double direction[3];    /* (-) of length 1 */
  int count;              /* (count) of modes up to the last point */
  double *participation;  /* (any, count) phi . M r of modes of unit modal mass */
  double *effective_mass; /* (kg, count) its square */
  double *acceleration;   /* (m/s2, count) of the spectrum */
  double mass;            /* (kg) of the body and what is attached */
  double missing_mass;    /* (kg) which the modes leave out */
  double base;            /* (m/s2) the acceleration that it has; 0: the response lacks it */
  double *displacement;   /* (m, node_count x 3) of each component, relative to the supports */
  double *von_mises;      /* (Pa, node_count) by the quadratic form of von Mises stress */
  double base_force[3];   /* (N) on the supports and springs */
  int coupling_count;     /* of the model's couplings */
  double *point; /* (m, rad, coupling_count x 6) of remote points: displacement, rotation */
} bw_response_spectrum;
/* Of a model, whose loads are not in it, as a warning says (docs/theory/dynamics.md). Another one
 * says where no mode is up to the last point. `given` and *system as in bw_modes_of_model.
 * BW_INVALID for options outside their ranges, for given modes that are others or end below the
 * last point, and where the first mode is below the first point;
 * else those of bw_harmonic_of_model. */
BW_API bw_status bw_response_spectrum_of_model(bw_context *context, const bw_model *model,
                                               bw_system *given,
                                               const bw_response_spectrum_options *options,
                                               bw_system **system, bw_response_spectrum **response);

/* ---- fatigue --------------------------------------------------------------------------------- */

/* A cycle of a history. */
typedef struct bw_cycle {
  double range; /* (any) from its lowest to its highest value */
  double mean;  /* (any) between these */
  double count; /* (-) 1, or 0.5 of a half cycle */
} bw_cycle;
/* The cycles of a history (any, count) by rainflow counting (ASTM E1049-85, section 5.4.4), in the
 * order in which they close, then the half cycles that are left: *cycle (any, *cycle_count), which
 * bw_free releases. BW_INVALID for a value that is not finite. */
BW_API bw_status bw_rainflow(bw_context *context, int64_t count, const double *history,
                             bw_cycle **cycle, int64_t *cycle_count);

/* A stress-life curve N = cycles (amplitude / a)^exponent (Basquin) of fully reversed stress. */
typedef struct bw_life_curve {
  double amplitude; /* (Pa) a point of the curve; default 0, above 0 */
  double cycles;    /* (-) its life; default 1e6, above 0 */
  double exponent;  /* (-) default 5, 1 or more */
  double limit;     /* (Pa) smaller amplitudes do no damage; default 0, 0 or more */
  double strength;  /* (Pa) a mean stress above 0 raises the amplitude by 1 / (1 - mean / strength)
                       (Goodman); default 0: it does not; 0 or more */
} bw_life_curve;
BW_API void bw_life_curve_default(bw_life_curve *curve);
/* Damage of one pass of a history at `place_count` places, by Miner's sum over the rainflow cycles
 * of the signed von Mises stress (docs/theory/dynamics.md). The stress is the sum over case_count
 * load cases of stress[c] (Pa, place_count x 6) times factor (-, steps x case_count): damage (-,
 * place_count), infinite where the mean stress reaches the strength. BW_INVALID for numbers of the
 * curve outside their ranges, and a stress or factor that is not finite. */
BW_API bw_status bw_fatigue_damage(bw_context *context, const bw_life_curve *curve,
                                   int64_t place_count, int case_count, const double *const *stress,
                                   int64_t steps, const double *factor, double *damage);
/* The same of case_count static solutions on one mesh, with a factor (-, steps x case_count) each:
 * damage (-, node_count) at its nodes. Where materials meet, stresses of each are summed by
 * themselves, and the largest damage counts. BW_INVALID also for solutions on other meshes or with
 * other regions of one material, and BW_LIMIT as bw_stress_points_create. */
BW_API bw_status bw_static_damage(bw_context *context, const bw_life_curve *curve, int case_count,
                                  const bw_static *const *result, int64_t steps,
                                  const double *factor, double *damage);

/* How the damage of a random stress follows from its spectral moments. */
typedef enum bw_spectral_method {
  BW_TOVO_BENASCIUTTI, /* Benasciutti and Tovo, International Journal of Fatigue 27, 2005 */
  BW_DIRLIK,           /* Dirlik, thesis, Warwick 1985 */
  BW_WIRSCHING_LIGHT,  /* Wirsching and Light, Journal of the Structural Division 106, 1980: for
                          exponents from 3 to 6 */
  BW_NARROW_BAND       /* each upcrossing of 0 is a cycle, as high as its peak */
} bw_spectral_method;
/* The damage per time, *rate (1/s), of a stationary Gaussian stress of mean 0. moment (any): the
 * spectral moments m0 (Pa2), m1 (Pa2 Hz), m2 (Pa2 Hz2), m4 (Pa2 Hz4), integrals of f^n S(f). 0
 * where one of them is 0. BW_INVALID for numbers of the curve outside their ranges, for one with a
 * strength, and for moments that are negative or not finite. */
BW_API bw_status bw_spectral_damage(bw_context *context, const bw_life_curve *curve,
                                    bw_spectral_method method, const double moment[4],
                                    double *rate);
/* The same at nodes under the random vibration of bw_harmonic_random, frequency (Hz, count) and
 * density (any, count), of a stress whose density is that of von Mises stress's mean square
 * (Preumont and Piefort, Journal of Vibration and Acoustics 116, 1994), by BW_DIRLIK: rate (1/s,
 * node_count) and moment (any, node_count x 4). Where materials meet, the largest counts. Those of
 * bw_spectral_damage and bw_harmonic_random. */
BW_API bw_status bw_harmonic_random_damage(bw_context *context, const bw_harmonic *harmonic,
                                           int count, const double *frequency,
                                           const double *density, const bw_life_curve *curve,
                                           double *rate, double *moment);

#ifdef __cplusplus
}
#endif
#endif
