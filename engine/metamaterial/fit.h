/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* The constants of a coarse cell, from samples of its block. */
#ifndef BWI_METAMATERIAL_FIT_H
#define BWI_METAMATERIAL_FIT_H

#include "metamaterial/sample.h"

/* Improves axes->constant, which linear elasticity gave. Laws are those of the octants. */
void bwi_fit_constants(const bwi_frame18 *frame, const bwi_base *base, const uint8_t law[8],
                       const bwi_sample *sample, int count, double ridge, bwi_axes_work *work,
                       bwi_axes *axes);

#endif
