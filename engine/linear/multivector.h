/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
#ifndef BWI_LINEAR_MULTIVECTOR_H
#define BWI_LINEAR_MULTIVECTOR_H

#include "barwright/base.h"

/* c = a^T b, a_count x b_count, column-major */
bw_status bwi_multi_dot(bw_context *context, int64_t size, int a_count, const double *a,
                        int b_count, const double *b, double *c);
/* c = alpha a w + beta c, with w a_count x b_count, column-major */
bw_status bwi_multi_combine(bw_context *context, int64_t size, int a_count, const double *a,
                            int b_count, const double *weights, int weights_ld, double alpha,
                            double beta, double *c);

#endif
