/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* The thread pool. Work is cut into chunks whose borders do not depend on the number of threads;
 * workers take chunks from a shared counter. Invariant: a job's chunks are all finished, and no
 * worker holds the job, when bw_parallel returns. */
#include "base/internal.h"

#include <pthread.h>
#include <stdlib.h>
#include <unistd.h>

typedef struct job {
  bw_body *body;
  void *data;
  int64_t count, grain, chunks;
  int64_t next;         /* the chunk to take next; atomic */
  int64_t failed_chunk; /* lowest failing chunk, guarded by the pool's lock */
  bw_status status;
} job;

typedef struct worker_start {
  bwi_pool *pool;
  int worker;
} worker_start;

struct bwi_pool {
  pthread_mutex_t lock;
  pthread_cond_t wake, done;
  int threads; /* extra ones */
  pthread_t *thread;
  worker_start *start; /* one per extra thread; lives as long as the pool does */
  job *current;
  uint64_t generation;
  int busy; /* workers inside the current job */
  bool stopping;
};

static _Thread_local bool on_pool_thread;
static _Thread_local bool inside_body;

bool bwi_on_pool_thread(void) {
  return on_pool_thread;
}

int bwi_default_threads(void) {
  const char *wish = getenv("BARWRIGHT_THREADS");
  long threads = wish ? strtol(wish, NULL, 10) : 0;
  if (threads < 1)
    threads = sysconf(_SC_NPROCESSORS_ONLN);
  if (threads < 1)
    threads = 1;
  return threads > BWI_MOST_THREADS ? BWI_MOST_THREADS : (int)threads;
}

static void record_failure(bwi_pool *pool, job *work, int64_t chunk, bw_status status) {
  if (pool)
    pthread_mutex_lock(&pool->lock);
  if (chunk < work->failed_chunk) {
    work->failed_chunk = chunk;
    work->status = status;
  }
  /* Later chunks need not run; earlier ones, already taken, still decide the status. */
  __atomic_store_n(&work->next, work->chunks, __ATOMIC_RELAXED);
  if (pool)
    pthread_mutex_unlock(&pool->lock);
}

static void work_on(bwi_pool *pool, job *work, int worker) {
  bool before = inside_body;
  inside_body = true;
  for (;;) {
    int64_t chunk = __atomic_fetch_add(&work->next, 1, __ATOMIC_RELAXED);
    if (chunk >= work->chunks)
      break;
    int64_t begin = chunk * work->grain;
    int64_t end = work->count - begin < work->grain ? work->count : begin + work->grain;
    bw_status status = work->body(work->data, begin, end, worker);
    if (status != BW_OK)
      record_failure(pool, work, chunk, status);
  }
  inside_body = before;
}

static void *worker_main(void *data) {
  const worker_start *start = (const worker_start *)data;
  bwi_pool *pool = start->pool;
  on_pool_thread = true;
  uint64_t seen = 0;
  pthread_mutex_lock(&pool->lock);
  for (;;) {
    while (!pool->stopping && (pool->generation == seen || !pool->current))
      pthread_cond_wait(&pool->wake, &pool->lock);
    if (pool->stopping)
      break;
    seen = pool->generation;
    job *work = pool->current;
    pool->busy++;
    pthread_mutex_unlock(&pool->lock);
    work_on(pool, work, start->worker);
    pthread_mutex_lock(&pool->lock);
    if (--pool->busy == 0)
      pthread_cond_broadcast(&pool->done);
  }
  pthread_mutex_unlock(&pool->lock);
  return NULL;
}

bwi_pool *bwi_pool_create(int extra_threads) {
  bwi_pool *pool = BW_NEW0(NULL, bwi_pool, 1);
  if (!pool)
    return NULL;
  pool->thread = BW_NEW0(NULL, pthread_t, extra_threads);
  pool->start = BW_NEW0(NULL, worker_start, extra_threads);
  if (!pool->thread || !pool->start) {
    bw_free(pool->thread);
    bw_free(pool->start);
    bw_free(pool);
    return NULL;
  }
  pthread_mutex_init(&pool->lock, NULL);
  pthread_cond_init(&pool->wake, NULL);
  pthread_cond_init(&pool->done, NULL);
  for (int i = 0; i < extra_threads; i++) {
    pool->start[i].pool = pool;
    pool->start[i].worker = i + 1;
    if (pthread_create(&pool->thread[i], NULL, worker_main, &pool->start[i]) != 0)
      break;
    pool->threads++;
  }
  return pool;
}

void bwi_pool_destroy(bwi_pool *pool) {
  if (!pool)
    return;
  pthread_mutex_lock(&pool->lock);
  pool->stopping = true;
  pthread_cond_broadcast(&pool->wake);
  pthread_mutex_unlock(&pool->lock);
  for (int i = 0; i < pool->threads; i++)
    pthread_join(pool->thread[i], NULL);
  pthread_cond_destroy(&pool->wake);
  pthread_cond_destroy(&pool->done);
  pthread_mutex_destroy(&pool->lock);
  bw_free(pool->thread);
  bw_free(pool->start);
  bw_free(pool);
}

void bwi_pool_forget(bwi_pool *pool) {
  on_pool_thread = false;
  inside_body = false;
  if (!pool)
    return;
  /* To destroy the condition would wait for its waiters. */
  bw_free(pool->thread);
  bw_free(pool->start);
  bw_free(pool);
}

bw_status bw_parallel(bw_context *context, int64_t count, int64_t grain, bw_body *body,
                      void *data) {
  if (count <= 0)
    return BW_OK;
  if (grain < 1)
    grain = 1;
  int64_t chunks = count / grain + (count % grain != 0);
  job work = {body, data, count, grain, chunks, 0, INT64_MAX, BW_OK};
  bwi_pool *pool = chunks > 1 && !inside_body && context ? bwi_context_pool(context) : NULL;
  if (!pool) {
    work_on(NULL, &work, 0);
    return work.status;
  }
  pthread_mutex_lock(&pool->lock);
  pool->current = &work;
  pool->generation++;
  pthread_cond_broadcast(&pool->wake);
  pthread_mutex_unlock(&pool->lock);
  work_on(pool, &work, 0);
  pthread_mutex_lock(&pool->lock);
  pool->current = NULL;
  while (pool->busy > 0)
    pthread_cond_wait(&pool->done, &pool->lock);
  pthread_mutex_unlock(&pool->lock);
  return work.status;
}
