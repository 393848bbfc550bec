/* OpenBLAS's number of threads. See blas.h.
 *
 * Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
#include "base/blas.h"

#include <pthread.h>

void openblas_set_num_threads(int);
int openblas_get_num_threads(void);

static pthread_mutex_t lock = PTHREAD_MUTEX_INITIALIZER;
static int inside, before; /* how many have entered; threads to go back to */

void bwi_blas_enter(void) {
  pthread_mutex_lock(&lock);
  if (inside++ == 0)
    before = openblas_get_num_threads();
  if (openblas_get_num_threads() != 1)
    openblas_set_num_threads(1);
  pthread_mutex_unlock(&lock);
}

void bwi_blas_widen(int threads) {
  pthread_mutex_lock(&lock);
  if (inside == 1 && threads != 1)
    openblas_set_num_threads(threads);
  pthread_mutex_unlock(&lock);
}

void bwi_blas_leave(void) {
  pthread_mutex_lock(&lock);
  if (--inside == 0 && openblas_get_num_threads() != before)
    openblas_set_num_threads(before);
  pthread_mutex_unlock(&lock);
}

void bwi_blas_forked(void) {
  pthread_mutex_init(&lock, NULL); /* another thread may have held it */
  inside = 1;
  before = 1;
}
