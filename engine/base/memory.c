/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* Allocation: overflow-checked, counted, and made to fail on request for tests. The counters are
 * process-wide, so that a test can compare them around any piece of work. */
#include "base/pages.h"

#include <fcntl.h>
#include <glob.h>
#include <stdlib.h>
#include <sys/mman.h>
#include <unistd.h>

static int64_t live_blocks;
static int64_t allocations;
static int64_t failing_at; /* 0: never; counts down to 1 */
static int failing_repeats;

int64_t bw_live_blocks(void) {
  return __atomic_load_n(&live_blocks, __ATOMIC_RELAXED);
}

int64_t bw_allocation_count(void) {
  return __atomic_load_n(&allocations, __ATOMIC_RELAXED);
}

void bw_fail_allocation(int64_t n, bool repeat) {
  __atomic_store_n(&failing_repeats, repeat ? 1 : 0, __ATOMIC_RELAXED);
  __atomic_store_n(&failing_at, n, __ATOMIC_RELAXED);
}

static bool refuse(void) {
  __atomic_add_fetch(&allocations, 1, __ATOMIC_RELAXED);
  if (__atomic_load_n(&failing_at, __ATOMIC_RELAXED) <= 0)
    return false;
  if (__atomic_sub_fetch(&failing_at, 1, __ATOMIC_RELAXED) > 0)
    return false;
  if (__atomic_load_n(&failing_repeats, __ATOMIC_RELAXED))
    __atomic_store_n(&failing_at, 1, __ATOMIC_RELAXED);
  return true;
}

static void *no_memory(bw_context *context, size_t count, size_t size) {
  bw_fail(context, BW_MEMORY, "out of memory: %zu items of %zu bytes were asked for", count, size);
  return NULL;
}

static bool too_big(size_t count, size_t size) {
  size_t bytes;
  return __builtin_mul_overflow(count, size, &bytes) || bytes > PTRDIFF_MAX;
}

/* Zero bytes give a valid pointer too. */
static size_t at_least_one(size_t bytes) {
  return bytes > 0 ? bytes : 1;
}

/* Large blocks in large pages, where the system has them: what streams through memory would
 * otherwise spend a third of its time on finding pages. Only advice: it may be refused. */
static void *advised(void *block, size_t bytes) {
#ifdef MADV_HUGEPAGE
  const uintptr_t large = (size_t)2 << 20;
  uintptr_t begin = ((uintptr_t)block + large - 1) & ~(large - 1);
  uintptr_t end = ((uintptr_t)block + bytes) & ~(large - 1);
  if (block && bytes >= 4 * large && begin < end)
    madvise((void *)begin, end - begin, MADV_HUGEPAGE);
#else
  (void)bytes;
#endif
  return block;
}

static void *allocate(bw_context *context, size_t count, size_t size, bool large_pages) {
  if (too_big(count, size) || refuse())
    return no_memory(context, count, size);
  void *block = malloc(at_least_one(count * size));
  if (!block)
    return no_memory(context, count, size);
  __atomic_add_fetch(&live_blocks, 1, __ATOMIC_RELAXED);
  return large_pages ? advised(block, count * size) : block;
}

void *bw_alloc(bw_context *context, size_t count, size_t size) {
  return allocate(context, count, size, true);
}

/* Whether this is a virtual machine whose host takes free large pages back: a balloon of virtio
 * with the feature of number 5, VIRTIO_BALLOON_F_REPORTING. */
static bool look_for_reporting(void) {
  enum { REPORTING = 5 };
  char feature[REPORTING + 1];
  glob_t found;
  bool reporting = false;
  if (glob("/sys/bus/virtio/drivers/virtio_balloon/virtio*/features", 0, NULL, &found) != 0)
    return false;
  for (size_t i = 0; i < found.gl_pathc; i++) {
    int file = open(found.gl_pathv[i], O_RDONLY | O_CLOEXEC);
    reporting |= file >= 0 && read(file, feature, sizeof feature) == (ssize_t)sizeof feature &&
                 feature[REPORTING] == '1';
    if (file >= 0)
      close(file);
  }
  globfree(&found);
  return reporting;
}

void *bwi_alloc_once(bw_context *context, size_t count, size_t size) {
  static int reporting = -1; /* not looked for yet; atomic */
  int known = __atomic_load_n(&reporting, __ATOMIC_RELAXED);
  if (known < 0) {
    known = look_for_reporting();
    __atomic_store_n(&reporting, known, __ATOMIC_RELAXED);
  }
  return allocate(context, count, size, !known);
}

void *bw_calloc(bw_context *context, size_t count, size_t size) {
  if (too_big(count, size) || refuse())
    return no_memory(context, count, size);
  void *block = advised(calloc(1, at_least_one(count * size)), count * size);
  if (!block)
    return no_memory(context, count, size);
  __atomic_add_fetch(&live_blocks, 1, __ATOMIC_RELAXED);
  return block;
}

void *bw_resize(bw_context *context, void *block, size_t count, size_t size) {
  if (!block)
    return bw_alloc(context, count, size);
  if (too_big(count, size) || refuse())
    return no_memory(context, count, size);
  void *larger = advised(realloc(block, at_least_one(count * size)), count * size);
  return larger ? larger : no_memory(context, count, size);
}

void bw_free(void *block) {
  if (!block)
    return;
  __atomic_sub_fetch(&live_blocks, 1, __ATOMIC_RELAXED);
  free(block);
}

bool bw_grow(bw_context *context, void **list, size_t *capacity, size_t count, size_t extra,
             size_t size) {
  if (*list && count + extra <= *capacity)
    return true;
  size_t wanted = *capacity ? *capacity : 16;
  while (wanted < count + extra) {
    if (wanted > SIZE_MAX / 2) {
      no_memory(context, count, size);
      return false;
    }
    wanted *= 2;
  }
  void *larger = bw_resize(context, *list, wanted, size);
  if (!larger)
    return false;
  *list = larger;
  *capacity = wanted;
  return true;
}
