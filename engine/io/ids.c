/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* Files number nodes and elements as they like. Mostly the numbers run on by one, which needs no
 * table; else they are sorted once and looked up by bisection. */
#include "io/raw.h"

#include <stdlib.h>

typedef struct pair {
  int64_t id;
  int32_t place;
} pair;

static int compare_pairs(const void *a, const void *b) {
  const pair *x = (const pair *)a, *y = (const pair *)b;
  return x->id != y->id ? (x->id > y->id) - (x->id < y->id)
                        : (x->place > y->place) - (x->place < y->place);
}

bw_status bwi_ids_build(bw_context *context, int64_t *id, size_t count, bwi_ids *ids,
                        int64_t *twice) {
  *ids = (bwi_ids){count, id, NULL};
  bool running = true;
  for (size_t i = 0; i < count && running; i++)
    running = (uint64_t)id[i] == (uint64_t)id[0] + i;
  if (running)
    return BW_OK;
  bw_status status = BW_OK;
  pair *list = BW_NEW(context, pair, count);
  ids->place = BW_NEW(context, int32_t, count);
  BW_TRY_MEMORY(list && ids->place);
  for (size_t i = 0; i < count; i++)
    list[i] = (pair){id[i], (int32_t)i};
  qsort(list, count, sizeof *list, compare_pairs);
  for (size_t i = 0; i < count; i++) {
    id[i] = list[i].id;
    ids->place[i] = list[i].place;
    if (i > 0 && id[i] == id[i - 1]) {
      *twice = id[i];
      status = BW_FORMAT;
      goto done;
    }
  }
done:
  bw_free(list);
  if (status != BW_OK)
    bwi_ids_clear(ids);
  return status;
}

int32_t bwi_ids_find(const bwi_ids *ids, int64_t id) {
  if (ids->count == 0)
    return -1;
  if (!ids->place) {
    uint64_t place = (uint64_t)id - (uint64_t)ids->id[0];
    return place < ids->count ? (int32_t)place : -1;
  }
  size_t low = 0, high = ids->count;
  while (low < high) {
    size_t middle = low + (high - low) / 2;
    if (ids->id[middle] < id)
      low = middle + 1;
    else
      high = middle;
  }
  return low < ids->count && ids->id[low] == id ? ids->place[low] : -1;
}

void bwi_ids_clear(bwi_ids *ids) {
  bw_free(ids->id);
  bw_free(ids->place);
  *ids = (bwi_ids){0, NULL, NULL};
}
