/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* The part of a fit that linear elasticity decides: where points are, and which way fibres go. */
#ifndef BWI_METAMATERIAL_AXES_H
#define BWI_METAMATERIAL_AXES_H

#include "metamaterial/block.h"

enum {
  BWI_OCTANTS = 8,
  BWI_FIBRES = 3,
  BWI_DIRECTIONS = 16, /* candidates at a point */
  BWI_CONSTANTS = BWI_OCTANTS * (2 + BWI_FIBRES)
};
#define BWI_GRADIENT_WEIGHT 0.25 /* of the gradients of strain against the strains */

/* Shapes of a block are given by 18 coordinates in which its stiffness is nearly the identity:
 * unit coordinates have like energies. The first six are uniform strains, the others have
 * gradients of strain. (Nearly: shapes that meet no resistance are bounded by a little added.) */
typedef struct bwi_frame18 {
  double shape[BWI_COARSE * BWI_SHAPES];  /* coarse functions x coordinates */
  double target[BWI_SHAPES * BWI_SHAPES]; /* the block's stiffness */
  double weight[BWI_SHAPES];              /* 1, and BWI_GRADIENT_WEIGHT */
} bwi_frame18;

/* What the children are, octant by octant. */
typedef struct bwi_base {
  double mu[BWI_OCTANTS], lambda[BWI_OCTANTS];         /* 0: void */
  double mean_mu, mean_lambda;                         /* of those that are not void */
  double min_mu[BWI_OCTANTS], min_lambda[BWI_OCTANTS]; /* what a point is given at least */
} bwi_base;

/* Symmetries of the cube (bits as their numbers) that take the block into itself. Constants that
 * they take into each other are one variable. */
typedef struct bwi_ties {
  int constants, variables;
  int32_t variable[BWI_OCTANTS * (2 + BWI_DIRECTIONS)]; /* of each constant; -1: none, it is zero */
  int32_t group[BWI_OCTANTS * (2 + BWI_DIRECTIONS)];    /* of a variable: octants that go into each
                                                           other; -1 where it is no fibre */
  int32_t size[BWI_OCTANTS * (2 + BWI_DIRECTIONS)];     /* its fibres at one point */
} bwi_ties;

/* Directions and their number at each point, while choosing. */
typedef struct bwi_candidates {
  int count;
  double direction[BWI_OCTANTS][BWI_DIRECTIONS][3]; /* zero: none */
  bwi_ties ties;
} bwi_candidates;

#define BWI_SAME_DIRECTION 0.999 /* cosine */
void bwi_tie(uint64_t symmetries, bwi_candidates *candidates);

/* Constants are in this order: 8 mu, 8 lambda, then 8 of each fibre. */
typedef struct bwi_axes {
  double spread;
  int fibres;
  double direction[BWI_OCTANTS][BWI_FIBRES][3]; /* zero where a point has fewer */
  bwi_ties ties;
  double constant[BWI_CONSTANTS];
  double response[BWI_SHAPES * BWI_SHAPES]; /* stiffness of the coarse cell with them */
} bwi_axes;

typedef struct bwi_axes_work {
  double column[BWI_OCTANTS * (2 + BWI_DIRECTIONS)][BWI_SHAPES * (BWI_SHAPES + 1) / 2];
  double tied[BWI_OCTANTS * (2 + BWI_DIRECTIONS) * BWI_OCTANTS * (2 + BWI_DIRECTIONS)];
  double tied_side[BWI_OCTANTS * (2 + BWI_DIRECTIONS)], value[BWI_OCTANTS * (2 + BWI_DIRECTIONS)];
  double gram[BWI_OCTANTS * (2 + BWI_DIRECTIONS) * BWI_OCTANTS * (2 + BWI_DIRECTIONS)];
  double side[BWI_OCTANTS * (2 + BWI_DIRECTIONS)], x[BWI_OCTANTS * (2 + BWI_DIRECTIONS)];
  double nnls[(BWI_OCTANTS * (2 + BWI_DIRECTIONS)) * (BWI_OCTANTS * (2 + BWI_DIRECTIONS) + 3)];
} bwi_axes_work;

void bwi_frame18_of(const bwi_condensed *condensed, const bwi_base *base, bwi_frame18 *frame);
/* Displacement gradient (9) at a point of the unit cube for each coordinate: 9 x 18. */
void bwi_frame18_gradient(const bwi_frame18 *frame, const double at[3],
                          double gradient[9 * BWI_SHAPES]);
/* Strains xx yy zz yz zx xy (engineering shears) from displacement gradients: 6 x 18. */
void bwi_point_strains(const double *gradient, double *strain);
/* The stretch of a fibre for each coordinate. */
void bwi_fibre_strain(const double v[3], const double *strain, double *along);
/* matrix (18 x 18) += factor v v^T */
void bwi_add_square(double factor, const double *v, double *matrix);
/* Adds the stiffness of a point with constants mu, lambda. */
void bwi_add_isotropic(double mu, double lambda, const double *strain, double *matrix);
#define BWI_FLOOR 1e-3 /* stiffness added, against a cell of mean constants */
/* Octant k's point. */
void bwi_octant_point(int octant, double spread, double at[3]);
/* The metric in which stiffnesses R and the target differ by the logarithm of their ratio, to
 * first order: T = R^(-1/4), with small eigenvalues bounded. */
void bwi_metric(const double response[BWI_SHAPES * BWI_SHAPES],
                double metric[BWI_SHAPES * BWI_SHAPES]);
/* What changing constants relative to their size costs, by `ridge`: added to gram and side. */
void bwi_ridge(const bwi_base *base, double ridge, int count, double *gram, double *side);
/* Minimum of x^T gram x / 2 - side^T x over constants that are tied, are what they must be at
 * least, and have no more than `limit` fibres at a point; into work->x. gram and side (of all
 * constants) may be work's own. */
void bwi_tied_min(const bwi_ties *ties, const bwi_base *base, const double *gram,
                  const double *side, int limit, bwi_axes_work *work);
/* Chooses them; `stretches` and `fibres` as in bw_library_options. */
void bwi_axes_choose(const bwi_frame18 *frame, const bwi_base *base, uint64_t symmetries,
                     int stretches, int fibres, double ridge, bwi_axes_work *work, bwi_axes *axes);
/* Sets the response to that of the constants. */
void bwi_axes_response(const bwi_frame18 *frame, bwi_axes *axes);

#endif
