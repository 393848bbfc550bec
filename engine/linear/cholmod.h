/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* CHOLMOD's numeric supernodal factorisation as a backend of bwi_factor (Chen, Davis, Hager and
 * Rajamanickam, ACM Trans. Math. Softw. 35 (2008)). It gives the numbers of A = L L^T; the order
 * and the numbers of the unknowns are those of the bwi_symbolic, so that what CHOLMOD does not
 * serve (the Sturm count) is done by the engine on the same order. */
#ifndef BWI_LINEAR_CHOLMOD_H
#define BWI_LINEAR_CHOLMOD_H

#include "linear/internal.h"

typedef struct bwi_cholmod bwi_cholmod;

/* CHOLMOD's analysis: of the order of `symbolic`, or where that asks for the backend's, of the
 * better of AMD and METIS on the unknowns. BW_MEMORY, before any is allocated, where L is larger
 * than what is free. Release with bwi_cholmod_destroy. */
bw_status bwi_cholmod_create(bw_context *context, const bwi_symbolic *symbolic,
                             const bwi_matrix *matrix, bwi_cholmod **cholmod);
/* The numbers of L, for a matrix with the pattern of the analysis. BW_SINGULAR where the matrix is
 * not positive definite, or a pivot has no digits left; *bad is that unknown. CHOLMOD cannot be
 * interrupted: a cancellation ends this behind it. The numbers of the matrix are given back unless
 * `keep`: then the next call need not allocate them. */
bw_status bwi_cholmod_factorise(bw_context *context, bwi_cholmod *cholmod,
                                const bwi_symbolic *symbolic, const bwi_matrix *matrix, bool keep,
                                int32_t *bad);
/* Bytes of L; operations of its factorisation. */
size_t bwi_cholmod_bytes(const bwi_cholmod *cholmod);
/* Of the factor. */
size_t bwi_cholmod_entries(const bwi_cholmod *cholmod);
double bwi_cholmod_flops(const bwi_cholmod *cholmod);
void bwi_cholmod_destroy(bwi_cholmod *cholmod);

#endif
