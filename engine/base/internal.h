/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* What the files of base share. */
#ifndef BARWRIGHT_BASE_INTERNAL_H
#define BARWRIGHT_BASE_INTERNAL_H

#include "barwright/base.h"

/* A pool of extra threads; the caller of bw_parallel works along. */
typedef struct bwi_pool bwi_pool;
bwi_pool *bwi_pool_create(int extra_threads); /* NULL: no memory, work runs serially */
void bwi_pool_destroy(bwi_pool *pool);
/* In a forked child, where the threads are not: frees what the pool holds without waiting for them.
 */
void bwi_pool_forget(bwi_pool *pool);
bwi_pool *bwi_context_pool(bw_context *context);
bool bwi_on_pool_thread(void);
/* Each thread that calls BLAS takes a buffer of 128 MB of OpenBLAS, which has room for few and
 * waits for ever when it gets none. */
enum { BWI_MOST_THREADS = 64 };
int bwi_default_threads(void);

#endif
