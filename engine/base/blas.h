/* One thread for OpenBLAS while the engine uses it, and no longer: the number of its threads is the
 * setting of the whole process, and the program around the engine may have chosen another one.
 *
 * Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
#ifndef BARWRIGHT_BASE_BLAS_H
#define BARWRIGHT_BASE_BLAS_H

/* From the first enter to the last leave of all threads OpenBLAS has one thread; then it has as
 * many as before. Cheap. */
void bwi_blas_enter(void);
void bwi_blas_leave(void);

/* Between enter and leave, for a library that leaves its threads to the BLAS: OpenBLAS has as many,
 * where nobody else has entered, until somebody does or the caller leaves. */
void bwi_blas_widen(int threads);

/* In a forked child of a process that has entered: one thread for good. */
void bwi_blas_forked(void);

#endif
