/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* What the files of base share. */
#ifndef BARWRIGHT_BASE_INTERNAL_H
#define BARWRIGHT_BASE_INTERNAL_H

#include "barwright/base.h"

/* A pool of extra threads; the caller of bw_parallel works along. */
typedef struct bwi_pool bwi_pool;
bwi_pool *bwi_pool_create(int extra_threads); /* NULL: no memory, work runs serially */
void bwi_pool_destroy(bwi_pool *pool);
/* In a forked child, which has no threads: frees what the pool holds without waiting for them. */
void bwi_pool_forget(bwi_pool *pool);
bwi_pool *bwi_context_pool(bw_context *context);
bool bwi_on_pool_thread(void);

/* What went wrong. */
enum { BWI_MESSAGE_BYTES = 2048, BWI_DETAIL_COUNT = 12, BWI_DETAIL_BYTES = 256 };
typedef struct bwi_detail {
  char key[32];
  bool is_text;
  double number;
  char text[BWI_DETAIL_BYTES];
} bwi_detail;
typedef struct bwi_failure {
  char message[BWI_MESSAGE_BYTES];
  int detail_count;
  bwi_detail detail[BWI_DETAIL_COUNT];
} bwi_failure;
/* From here on failures that this thread records in the context go to `failure`, which is emptied;
 * (NULL, NULL): to the context again. */
void bwi_failure_aside(bw_context *context, bwi_failure *failure);
/* What was recorded aside becomes the context's. */
void bwi_failure_adopt(bw_context *context, const bwi_failure *failure);

/* Each thread that calls BLAS takes a buffer of 128 MB of OpenBLAS, which has a limited
 * number of them and waits for ever when none is free. */
enum { BWI_MAX_THREADS = 64 };
int bwi_default_threads(void);

#endif
