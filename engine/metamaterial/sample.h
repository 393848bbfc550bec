/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* A block under forces: its equilibria as samples of its energy. */
#ifndef BWI_METAMATERIAL_SAMPLE_H
#define BWI_METAMATERIAL_SAMPLE_H

#include "metamaterial/axes.h"

enum { BWI_UNKNOWNS = BWI_SHAPES + BWI_PERIODIC, BWI_STRIDE = 40 }; /* filled up to eights */

/* An equilibrium: coordinates of the coarse shape, energy, and forces conjugate to the coordinates,
 * of a block of volume 1. */
typedef struct bwi_sample {
  double coordinate[BWI_SHAPES], energy, force[BWI_SHAPES];
} bwi_sample;

/* A block whose unknowns are the 18 coordinates and the periodic fluctuations. */
typedef struct bwi_sampler {
  bwi_block block;
  double map[8][BWI_COARSE][BWI_STRIDE]; /* corners of each child from the unknowns */
  double weak[BWI_UNKNOWNS][BWI_STRIDE]; /* what holds void */
  double gradient[9 * BWI_SHAPES * BWI_OCTANTS];
  /* of one evaluation */
  double energy, residual[BWI_STRIDE], tangent[BWI_UNKNOWNS][BWI_STRIDE];
  double factor[BWI_UNKNOWNS * BWI_UNKNOWNS], step[BWI_STRIDE], trial[BWI_STRIDE];
  double half[BWI_COARSE][BWI_STRIDE], full[BWI_COARSE][BWI_COARSE];
} bwi_sampler;

void bwi_sampler_set(bwi_sampler *sampler, const bwi_block *block, const bwi_condensed *condensed,
                     const bwi_frame18 *frame);
/* Equilibria along one random direction of force, at `magnitudes` even steps up to about `strain`
 * in linear elasticity. Returns how many were found: all, or those before the block refused. */
int bwi_sample_direction(bwi_sampler *sampler, const bwi_frame18 *frame, double strain,
                         int magnitudes, bw_random *random, bwi_sample *sample);

#endif
