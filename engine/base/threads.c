/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* The thread pool. Work is cut into chunks whose borders do not depend on the number of threads;
 * workers take chunks from a shared counter. Invariant: a job's chunks are all finished, and no
 * worker holds the job, when bw_parallel returns. Chunks are taken in ascending order and one that
 * was taken is finished: the lowest chunk that fails is the same on any number of threads, and
 * status and message are its own. */
#include "base/internal.h"

#include <pthread.h>
#include <stdlib.h>
#include <unistd.h>

typedef struct job {
  bw_body *body;
  void *data;
  int64_t count, grain, chunks;
  int64_t next; /* the chunk to take next; atomic */
  int64_t
      failed_chunk; /* lowest failing chunk; this and what follows: guarded by the pool's lock */
  bw_status status;
  bw_context *context;
  bwi_failure failure;
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
  const char *opts = getenv("BARWRIGHT_THREADS");
  long threads = opts ? strtol(opts, NULL, 10) : 0;
  if (threads < 1)
    threads = sysconf(_SC_NPROCESSORS_ONLN);
  if (threads < 1)
    threads = 1;
  return threads > BWI_MAX_THREADS ? BWI_MAX_THREADS : (int)threads;
}

static void record_failure(bwi_pool *pool, job *work, int64_t chunk, bw_status status,
                           const bwi_failure *failure) {
  pthread_mutex_lock(&pool->lock);
  if (chunk < work->failed_chunk) {
    work->failed_chunk = chunk;
    work->status = status;
    work->failure = *failure;
  }
  /* Later chunks need not run; earlier ones, already taken, still decide the status. */
  __atomic_store_n(&work->next, work->chunks, __ATOMIC_RELAXED);
  pthread_mutex_unlock(&pool->lock);
}

static void work_on(bwi_pool *pool, job *work, int worker) {
  bwi_failure failure;
  inside_body = true;
  for (;;) {
    int64_t chunk = __atomic_fetch_add(&work->next, 1, __ATOMIC_RELAXED);
    if (chunk >= work->chunks)
      break;
    int64_t begin = chunk * work->grain;
    int64_t end = work->count - begin < work->grain ? work->count : begin + work->grain;
    bwi_failure_aside(work->context, &failure);
    bw_status status = work->body(work->data, begin, end, worker);
    if (status != BW_OK)
      record_failure(pool, work, chunk, status, &failure);
  }
  bwi_failure_aside(NULL, NULL);
  inside_body = false;
}

/* Without threads: chunk after chunk up to the first that fails, recorded where failures are. */
static bw_status work_alone(int64_t count, int64_t grain, int64_t chunks, bw_body *body,
                            void *data) {
  bool before = inside_body;
  bw_status status = BW_OK;
  inside_body = true;
  for (int64_t chunk = 0; chunk < chunks && status == BW_OK; chunk++) {
    int64_t begin = chunk * grain;
    status = body(data, begin, count - begin < grain ? count : begin + grain, 0);
  }
  inside_body = before;
  return status;
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
  bwi_pool *pool = chunks > 1 && !inside_body && context ? bwi_context_pool(context) : NULL;
  if (!pool)
    return work_alone(count, grain, chunks, body, data);
  job work = {.body = body,
              .data = data,
              .count = count,
              .grain = grain,
              .chunks = chunks,
              .failed_chunk = INT64_MAX,
              .status = BW_OK,
              .context = context};
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
  if (work.status != BW_OK)
    bwi_failure_adopt(context, &work.failure);
  return work.status;
}
