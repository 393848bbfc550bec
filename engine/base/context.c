/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* The context: last failure with its details, warnings, progress, cancelling, and the thread pool.
 * Failures may be recorded from pool threads, so the record is guarded by a lock. */
#include "base/internal.h"
#include "base/job.h"
#include "base/warning.h"

#include <pthread.h>
#include <stdio.h>
#include <string.h>
#include <time.h>

enum { WARNING_COUNT = 64 };

struct bw_context {
  pthread_mutex_t lock;
  bwi_failure failure;
  int warning_count;
  char *warning[WARNING_COUNT];
  const char *warning_format[WARNING_COUNT]; /* of bwi_warn_largest; else NULL */
  double warning_value[WARNING_COUNT];
  bw_progress_function *progress;
  void *progress_data;
  bw_name stage; /* of the last report, and how far it was */
  double fraction;
  int cancel; /* accessed with __atomic builtins */
  bwi_pool *pool;
  int threads;
};

const char *bw_status_word(bw_status status) {
  static const char *const word[] = {"ok",        "invalid",     "memory",     "io",
                                     "format",    "geometry",    "empty",      "unconstrained",
                                     "singular",  "convergence", "infeasible", "limit",
                                     "cancelled", "unsupported", "internal"};
  if (status == BW_BROKEN)
    return "broken";
  return (int)status >= 0 && (size_t)status < sizeof word / sizeof *word ? word[status] : "unknown";
}

bw_context *bw_context_create(void) {
  bw_context *context = BW_NEW0(NULL, bw_context, 1);
  if (!context)
    return NULL;
  pthread_mutex_init(&context->lock, NULL);
  context->threads = bwi_default_threads();
  return context;
}

void bw_context_destroy(bw_context *context) {
  if (!context)
    return;
  bwi_pool_destroy(context->pool);
  bw_clear_warnings(context);
  pthread_mutex_destroy(&context->lock);
  bw_free(context);
}

/* While a chunk of a parallel loop runs, its thread records failures of the loop's context here. */
static _Thread_local bw_context *aside_of;
static _Thread_local bwi_failure *aside;

static bwi_failure *failure_of(bw_context *context) {
  return context == aside_of ? aside : &context->failure;
}

void bwi_failure_aside(bw_context *context, bwi_failure *failure) {
  aside_of = context;
  aside = failure;
  if (failure) {
    failure->message[0] = 0;
    failure->detail_count = 0;
  }
}

void bwi_failure_adopt(bw_context *context, const bwi_failure *failure) {
  if (!failure->message[0])
    return; /* it was recorded elsewhere, or not at all */
  bwi_failure *into = failure_of(context);
  pthread_mutex_lock(&context->lock);
  *into = *failure;
  pthread_mutex_unlock(&context->lock);
}

bw_status bw_fail(bw_context *context, bw_status status, const char *format, ...) {
  if (!context)
    return status;
  /* Composed aside: an argument may be the present message itself. */
  char text[BWI_MESSAGE_BYTES];
  va_list arguments;
  va_start(arguments, format);
  vsnprintf(text, sizeof text, format, arguments);
  va_end(arguments);
  pthread_mutex_lock(&context->lock);
  bwi_failure *failure = failure_of(context);
  memcpy(failure->message, text, sizeof text);
  failure->detail_count = 0;
  pthread_mutex_unlock(&context->lock);
  return status;
}

/* The entry for a key, new or again; NULL when there is no room. */
static bwi_detail *detail_entry(bwi_failure *failure, const char *key) {
  for (int i = 0; i < failure->detail_count; i++)
    if (strcmp(failure->detail[i].key, key) == 0)
      return &failure->detail[i];
  if (failure->detail_count == BWI_DETAIL_COUNT)
    return NULL;
  bwi_detail *entry = &failure->detail[failure->detail_count++];
  snprintf(entry->key, sizeof entry->key, "%s", key);
  return entry;
}

static void set_detail(bw_context *context, const char *key, double number, const char *text) {
  if (!context)
    return;
  pthread_mutex_lock(&context->lock);
  bwi_detail *entry = detail_entry(failure_of(context), key);
  if (entry) {
    entry->is_text = text != NULL;
    entry->number = number;
    if (text)
      snprintf(entry->text, sizeof entry->text, "%s", text);
  }
  pthread_mutex_unlock(&context->lock);
}

void bw_detail_number(bw_context *context, const char *key, double value) {
  set_detail(context, key, value, NULL);
}

void bw_detail_text(bw_context *context, const char *key, const char *value) {
  set_detail(context, key, 0, value);
}

const char *bw_message(const bw_context *context) {
  return context ? failure_of((bw_context *)context)->message : "";
}

bool bw_detail(const bw_context *context, int i, const char **key, double *number,
               const char **text) {
  const bwi_failure *failure = context ? failure_of((bw_context *)context) : NULL;
  if (!failure || i < 0 || i >= failure->detail_count)
    return false;
  const bwi_detail *entry = &failure->detail[i];
  *key = entry->key;
  *number = entry->number;
  *text = entry->is_text ? entry->text : NULL;
  return true;
}

void bw_clear_failure(bw_context *context) {
  bwi_failure *failure = failure_of(context);
  failure->message[0] = 0;
  failure->detail_count = 0;
}

void bw_set_progress(bw_context *context, bw_progress_function *function, void *data) {
  context->progress = function;
  context->progress_data = data;
}

void bw_progress(bw_context *context, const char *stage, double fraction) {
  /* Pool threads have no business in the caller's callback. */
  if (!context || !context->progress || bwi_on_pool_thread())
    return;
  snprintf(context->stage.text, sizeof context->stage.text, "%s", stage);
  context->fraction = fraction;
  context->progress(context->progress_data, stage, fraction);
}

void bwi_progress_again(bw_context *context) {
  if (context && context->progress && context->stage.text[0] && !bwi_on_pool_thread())
    context->progress(context->progress_data, context->stage.text, context->fraction);
}

void bw_cancel(bw_context *context) {
  __atomic_store_n(&context->cancel, 1, __ATOMIC_RELAXED);
}

void bw_clear_cancel(bw_context *context) {
  __atomic_store_n(&context->cancel, 0, __ATOMIC_RELAXED);
}

bool bw_cancelled(const bw_context *context) {
  return context && __atomic_load_n(&context->cancel, __ATOMIC_RELAXED) != 0;
}

bw_status bw_check_cancel(bw_context *context) {
  return bw_cancelled(context) ? bw_fail(context, BW_CANCELLED, "cancelled") : BW_OK;
}

/* A warning that is recorded already is not recorded again. Where the memory or the list is
 * exhausted a warning is left out, and no failure is recorded. */
static void add_warning(bw_context *context, const char *format, double value, const char *text) {
  int at = 0;
  pthread_mutex_lock(&context->lock);
  while (at < context->warning_count && strcmp(context->warning[at], text) != 0 &&
         (!format || context->warning_format[at] != format))
    at++;
  const bool known = at < context->warning_count;
  char *copy = at < WARNING_COUNT && (!known || value > context->warning_value[at])
                   ? BW_NEW(NULL, char, strlen(text) + 1)
                   : NULL;
  if (copy) {
    memcpy(copy, text, strlen(text) + 1);
    if (known)
      bw_free(context->warning[at]);
    context->warning[at] = copy;
    context->warning_format[at] = format;
    context->warning_value[at] = value;
    context->warning_count += !known;
  }
  pthread_mutex_unlock(&context->lock);
}

enum { WARNING_LENGTH = 1024 };

static void write_warning(bw_context *context, const char *key, double value, const char *format,
                          va_list arguments) {
  if (!context)
    return;
  char text[WARNING_LENGTH];
  vsnprintf(text, sizeof text, format, arguments);
  add_warning(context, key, value, text);
}

void bw_warn(bw_context *context, const char *format, ...) {
  va_list arguments;
  va_start(arguments, format);
  write_warning(context, NULL, 0, format, arguments);
  va_end(arguments);
}

void bwi_warn_largest(bw_context *context, double value, const char *format, ...) {
  va_list arguments;
  va_start(arguments, format);
  write_warning(context, format, value, format, arguments);
  va_end(arguments);
}

const char *bw_warning_at(const bw_context *context, int i) {
  return i >= 0 && i < context->warning_count ? context->warning[i] : NULL;
}

void bw_clear_warnings(bw_context *context) {
  for (int i = 0; i < context->warning_count; i++)
    bw_free(context->warning[i]);
  context->warning_count = 0;
}

double bw_seconds(void) {
  struct timespec now;
  clock_gettime(CLOCK_MONOTONIC, &now);
  return (double)now.tv_sec + 1e-9 * (double)now.tv_nsec;
}

int bw_threads(const bw_context *context) {
  return context ? context->threads : 1;
}

bw_status bw_set_threads(bw_context *context, int threads) {
  if (threads < 1 || threads > BWI_MAX_THREADS)
    return bw_fail(context, BW_INVALID, "%d threads: expected a number from 1 to %d", threads,
                   BWI_MAX_THREADS);
  if (threads != context->threads) {
    bwi_pool_destroy(context->pool);
    context->pool = NULL;
    context->threads = threads;
  }
  return BW_OK;
}

bwi_pool *bwi_context_pool(bw_context *context) {
  if (!context->pool && context->threads > 1)
    context->pool = bwi_pool_create(context->threads - 1);
  return context->pool;
}

void bwi_context_forked(bw_context *context) {
  pthread_mutex_init(&context->lock, NULL);
  bwi_pool_forget(context->pool);
  context->pool = NULL;
  context->threads = 1;
  context->progress = NULL;
  bw_clear_cancel(context);
  bw_clear_failure(context);
  bw_clear_warnings(context);
}
