/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* The BLAS and LAPACK routines in use, by their Fortran names (32-bit integers, column-major).
 *
 * barwright makes its own threads: every BLAS call runs on the calling thread (one BLAS thread,
 * between bwi_blas_enter and bwi_blas_leave), and large products are cut into tiles that do not
 * depend on the number of threads. That is what makes results bitwise the same for any thread
 * count. CHOLMOD's factorisation alone leaves its threads to the BLAS (cholmod.c). */
#ifndef BWI_LINEAR_BLAS_H
#define BWI_LINEAR_BLAS_H

#include "barwright/base.h"

#include "base/blas.h"

void dgemm_(const char *, const char *, const int *, const int *, const int *, const double *,
            const double *, const int *, const double *, const int *, const double *, double *,
            const int *);
void sgemm_(const char *, const char *, const int *, const int *, const int *, const float *,
            const float *, const int *, const float *, const int *, const float *, float *,
            const int *);
void dsyrk_(const char *, const char *, const int *, const int *, const double *, const double *,
            const int *, const double *, double *, const int *);
void ssyrk_(const char *, const char *, const int *, const int *, const float *, const float *,
            const int *, const float *, float *, const int *);
void dtrsm_(const char *, const char *, const char *, const char *, const int *, const int *,
            const double *, const double *, const int *, double *, const int *);
void dpotrf_(const char *, const int *, double *, const int *, int *);
void spotrf_(const char *, const int *, float *, const int *, int *);
void dsygv_(const int *, const char *, const char *, const int *, double *, const int *, double *,
            const int *, double *, double *, const int *, int *);
void dgesv_(const int *, const int *, double *, const int *, int *, double *, const int *, int *);
void dgetrf_(const int *, const int *, double *, const int *, int *, int *);
void dgetrs_(const char *, const int *, const int *, const double *, const int *, const int *,
             double *, const int *, int *);
void dgesvd_(const char *, const char *, const int *, const int *, double *, const int *, double *,
             double *, const int *, double *, const int *, double *, const int *, int *);
void dsyev_(const char *, const char *, const int *, double *, const int *, double *, double *,
            const int *, int *);

/* BW_MEMORY where the address space has no room for the buffers that OpenBLAS takes, one per
 * thread: under a limit (ulimit -v) it would wait for them for ever. Checked until it has once
 * passed. */
bw_status bwi_blas_check_memory(bw_context *context, int threads);

#endif
