/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* Few representatives for many materials: farthest-point sampling. */
#include <math.h>
#include <string.h>

#include "metamaterial/levels.h"

bw_status bwi_cover_begin(bw_context *context, int32_t count, bwi_cover *cover) {
  memset(cover, 0, sizeof *cover);
  cover->context = context;
  cover->count = count;
  cover->coordinate = BW_NEW0(context, float, (int64_t)count *BWI_FEATURES);
  cover->mask = BW_NEW0(context, uint64_t, count);
  cover->distance = BW_NEW(context, float, count);
  cover->nearest = BW_NEW(context, int32_t, count);
  if (!cover->coordinate || !cover->mask || !cover->distance || !cover->nearest) {
    bwi_cover_clear(cover);
    return BW_MEMORY;
  }
  for (int32_t i = 0; i < count; i++) {
    cover->distance[i] = INFINITY;
    cover->nearest[i] = -1;
  }
  return BW_OK;
}

void bwi_cover_clear(bwi_cover *cover) {
  bw_free(cover->coordinate);
  bw_free(cover->mask);
  bw_free(cover->distance);
  bw_free(cover->nearest);
  memset(cover, 0, sizeof *cover);
}

typedef struct addition {
  bwi_cover *cover;
  const float *coordinate;
  uint64_t mask;
  int32_t representative;
} addition;

static bw_status add_some(void *data, int64_t begin, int64_t end, int worker) {
  const addition *it = (const addition *)data;
  bwi_cover *cover = it->cover;
  (void)worker;
  for (int64_t i = begin; i < end; i++) {
    const float *at = cover->coordinate + BWI_FEATURES * i;
    float sum = 0;
    if (cover->mask[i] & ~it->mask)
      continue;
    for (int k = 0; k < BWI_FEATURES; k++)
      sum += (at[k] - it->coordinate[k]) * (at[k] - it->coordinate[k]);
    if (sum < cover->distance[i]) {
      cover->distance[i] = sum;
      cover->nearest[i] = it->representative;
    }
  }
  return BW_OK;
}

bw_status bwi_cover_add(bwi_cover *cover, const float coordinate[BWI_FEATURES], uint64_t mask,
                        int32_t representative) {
  addition it = {cover, coordinate, mask, representative};
  return bw_parallel(cover->context, cover->count, 4096, add_some, &it);
}

int32_t bwi_cover_farthest(const bwi_cover *cover, uint64_t mask, const uint8_t *images,
                           int32_t available) {
  int32_t farthest = -1;
  float max = 0;
  for (int32_t i = 0; i < cover->count; i++)
    if (cover->distance[i] > max && !(mask & ~cover->mask[i]) &&
        (!images || images[i] <= available)) {
      max = cover->distance[i];
      farthest = i;
    }
  return farthest;
}

void bwi_cover_measure(const bwi_cover *cover, float *typical, float *max) {
  double sum = 0, worst = 0;
  for (int32_t i = 0; i < cover->count; i++) {
    sum += cover->distance[i];
    worst = fmax(worst, cover->distance[i]);
  }
  *typical = (float)sqrt(sum / BWI_FEATURES / (cover->count > 0 ? cover->count : 1));
  *max = (float)sqrt(worst / BWI_FEATURES);
}
