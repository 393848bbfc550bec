/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* Places in the order of a Morton curve: what is near is mostly near in the list. */
#include "plane/internal.h"

#include <math.h>
#include <stdlib.h>

typedef struct keyed {
  uint64_t key;
  int32_t item;
} keyed;

static int by_key(const void *a, const void *b) {
  const keyed *p = a, *q = b;
  if (p->key != q->key)
    return p->key < q->key ? -1 : 1;
  return (p->item > q->item) - (p->item < q->item);
}

/* Every second bit: the lowest 32 bits of v spread out. */
static uint64_t spread(uint64_t v) {
  v = (v | v << 16) & 0x0000ffff0000ffff;
  v = (v | v << 8) & 0x00ff00ff00ff00ff;
  v = (v | v << 4) & 0x0f0f0f0f0f0f0f0f;
  v = (v | v << 2) & 0x3333333333333333;
  v = (v | v << 1) & 0x5555555555555555;
  return v;
}

bw_status bwi_order_places(bw_context *context, int32_t count, const double *place,
                           int32_t *order) {
  double low[2] = {INFINITY, INFINITY}, size = 0;
  keyed *list = BW_NEW(context, keyed, count);
  if (!list)
    return BW_MEMORY;
  for (size_t k = 0; k < 2; k++) {
    double high = -INFINITY;
    for (int32_t i = 0; i < count; i++) {
      low[k] = fmin(low[k], place[2 * (size_t)i + k]);
      high = fmax(high, place[2 * (size_t)i + k]);
    }
    size = fmax(size, high - low[k]);
  }
  double scale = size > 0 ? 4294967295.0 / size : 0;
  for (int32_t i = 0; i < count; i++) {
    list[i].item = i;
    list[i].key = spread((uint64_t)((place[2 * (size_t)i] - low[0]) * scale)) |
                  spread((uint64_t)((place[2 * (size_t)i + 1] - low[1]) * scale)) << 1;
  }
  qsort(list, (size_t)count, sizeof *list, by_key);
  for (int32_t i = 0; i < count; i++)
    order[i] = list[i].item;
  bw_free(list);
  return BW_OK;
}
