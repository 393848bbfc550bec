/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* Which points of a surface make an object of their own in formats that have several. */
#include "io/surface_write.h"

#include <string.h>

bw_status bwi_surface_objects(bw_context *context, const bw_surface *surface, int32_t *object_of,
                              int32_t *count) {
  bw_status status = BW_OK;
  *count = 1;
  memset(object_of, 0, (size_t)surface->point_count * sizeof *object_of);
  if (!surface->group)
    return BW_OK;
  int32_t least = surface->group[0], most = least;
  for (int32_t i = 0; i < surface->triangle_count; i++) {
    least = surface->group[i] < least ? surface->group[i] : least;
    most = surface->group[i] > most ? surface->group[i] : most;
  }
  if ((int64_t)most - least >= surface->triangle_count)
    return BW_OK;
  int32_t *number = BW_NEW0(context, int32_t, most - least + 1);
  BW_TRY_MEMORY(number);
  for (int32_t i = 0; i < surface->point_count; i++)
    object_of[i] = -1;
  *count = 0;
  for (int32_t i = 0; i < surface->triangle_count; i++) {
    int32_t *own = &number[surface->group[i] - least];
    if (*own == 0)
      *own = ++*count;
    for (int k = 0; k < 3; k++) {
      int32_t *of = &object_of[surface->triangle[3 * (size_t)i + (size_t)k]];
      if (*of >= 0 && *of != *own - 1) {
        memset(object_of, 0, (size_t)surface->point_count * sizeof *object_of);
        *count = 1;
        goto done;
      }
      *of = *own - 1;
    }
  }
done:
  bw_free(number);
  return status;
}
