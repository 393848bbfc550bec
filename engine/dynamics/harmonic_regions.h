/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* Loss factors of regions, which couple the vectors of a harmonic response. */
#ifndef BWI_DYNAMICS_HARMONIC_REGIONS_H
#define BWI_DYNAMICS_HARMONIC_REGIONS_H

#include "barwright/dynamics.h"
#include "dynamics/equations.h"

typedef struct bwi_coupling bwi_coupling;

/* Fills h->loss of the modes by options->region_loss; force (node_count x 3).  h->coupling is made.
 */
bw_status bwi_coupling_create(bw_context *context, const bwi_equations *equations,
                              const bw_harmonic_options *options, const double *force,
                              bw_harmonic *h);
/* Vectors until the error at the frequencies of h is below the tolerance: fills the arrays of h. */
bw_status bwi_coupling_grow(bw_context *context, const bwi_equations *equations,
                            const bw_harmonic_options *options, bw_harmonic *h);
/* As bw_harmonic_coordinates. */
bw_status bwi_coupling_coordinates(bw_context *context, const bw_harmonic *h, double omega,
                                   double *coordinate, double *error);
void bwi_coupling_destroy(bwi_coupling *coupling);
size_t bwi_coupling_bytes(const bwi_coupling *coupling);

#endif
