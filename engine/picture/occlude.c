/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* Soft shadow in hollows: how much of the half space above a pixel is shut in by what the picture
 * shows around it. Each pixel looks at places on a spiral, rotated from pixel to pixel in a pattern
 * of 4 x 4; averaging over 4 x 4 neighbours of like depth then removes the pattern. */
#include <math.h>
#include <string.h>

#include "picture/internal.h"

enum { PLACES = 20, PATTERN = 4 };

typedef struct job {
  bwi_image *image;
  double radius;
  float place[PATTERN * PATTERN][PLACES][2];
  float *shut, *smooth; /* per pixel: 0 open, 1 shut */
} job;

static bw_status look_around(void *data, int64_t begin, int64_t end, int worker) {
  job *j = (job *)data;
  const bwi_image *image = j->image;
  const float radius = (float)j->radius;
  (void)worker;
  for (int64_t y = begin; y < end; y++)
    for (int x = 0; x < image->width; x++) {
      size_t at = (size_t)y * (size_t)image->width + (size_t)x;
      float z = image->depth[at], sum = 0;
      const float *n = image->normal + 3 * at;
      const float(*place)[2] = (const float(*)[2])j->place[(y % PATTERN) * PATTERN + x % PATTERN];
      j->shut[at] = 0;
      if (z == -HUGE_VALF || image->finish[at] == BWI_GHOST || image->finish[at] == BWI_TUBE)
        continue;
      for (int p = 0; p < PLACES; p++) {
        int px = x + (int)lrintf(place[p][0]), py = (int)y + (int)lrintf(place[p][1]);
        if (px < 0 || py < 0 || px >= image->width || py >= image->height)
          continue;
        float dz = image->depth[(size_t)py * (size_t)image->width + (size_t)px] - z;
        if (!(dz > -radius)) /* also where nothing is */
          continue;
        float dx = (float)(px - x), dy = (float)(y - py);
        float square = dx * dx + dy * dy + dz * dz + 1e-6f;
        float rise = (dx * n[0] + dy * n[1] + dz * n[2]) / sqrtf(square) - 0.08f;
        if (rise > 0) /* what is far in front casts no soft shadow */
          sum += rise / (1 + square / (radius * radius));
      }
      sum *= 2.6f / PLACES;
      j->shut[at] = sum > 1 ? 1 : sum;
    }
  return BW_OK;
}

static bw_status smooth_rows(void *data, int64_t begin, int64_t end, int worker) {
  job *j = (job *)data;
  const bwi_image *image = j->image;
  const float reach = (float)(0.15 * j->radius);
  (void)worker;
  for (int64_t y = begin; y < end; y++)
    for (int x = 0; x < image->width; x++) {
      size_t at = (size_t)y * (size_t)image->width + (size_t)x;
      float z = image->depth[at], sum = j->shut[at];
      int count = 1;
      j->smooth[at] = 0;
      if (z == -HUGE_VALF)
        continue;
      for (int dy = -2; dy < 2; dy++)
        for (int dx = -2; dx < 2; dx++) {
          int64_t py = y + dy, px = x + dx;
          if ((dx == 0 && dy == 0) || px < 0 || py < 0 || px >= image->width || py >= image->height)
            continue;
          size_t p = (size_t)py * (size_t)image->width + (size_t)px;
          if (fabsf(image->depth[p] - z) < reach) {
            sum += j->shut[p];
            count++;
          }
        }
      j->smooth[at] = sum / (float)count;
    }
  return BW_OK;
}

bw_status bwi_occlude(bw_context *context, bwi_image *image, double radius) {
  size_t pixels = (size_t)image->width * (size_t)image->height;
  bw_status status = BW_OK;
  job *j = BW_NEW0(context, job, 1);
  if (!j)
    return BW_MEMORY;
  j->image = image;
  j->radius = radius;
  j->shut = BW_NEW(context, float, pixels);
  j->smooth = BW_NEW(context, float, pixels);
  BW_TRY_MEMORY(j->shut && j->smooth);
  for (int cell = 0; cell < PATTERN * PATTERN; cell++)
    for (int p = 0; p < PLACES; p++) {
      double fraction = (p + (cell * 7 % 16 + 0.5) / 16) / PLACES;
      double angle = 2.399963229728653 * p + 6.283185307179586 * (cell * 5 % 16) / 16;
      double away = radius * pow(fraction, 0.75) + 1;
      j->place[cell][p][0] = (float)(away * cos(angle));
      j->place[cell][p][1] = (float)(away * sin(angle));
    }
  BW_TRY(bw_parallel(context, image->height, 8, look_around, j));
  BW_TRY(bw_parallel(context, image->height, 8, smooth_rows, j));
  for (size_t i = 0; i < pixels; i++)
    for (int k = 0; k < 3; k++) {
      double kept = image->colour[4 * i + (size_t)k] * (1 - 0.75 * (double)j->smooth[i]);
      image->colour[4 * i + (size_t)k] = (unsigned char)(kept + 0.5);
    }
done:
  bw_free(j->shut);
  bw_free(j->smooth);
  bw_free(j);
  return status;
}
