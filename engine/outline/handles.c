/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* What moves with a handle: a vertex with the control points beside it, so that the directions of
 * the curves there stay; a segment; a loop with all that lies in it; a point alone. */
#include <string.h>

#include "outline/internal.h"

/* The vertex at which a segment begins, and the control points beside it. */
static void take_vertex(const bw_outline *outline, const bw_loop *loop, int32_t segment,
                        double *weight) {
  const int32_t *out = outline->segment[segment].point;
  const int32_t *in = outline->segment[bwi_previous_segment(loop, segment)].point;
  weight[out[0]] = 1;
  if (out[1] >= 0)
    weight[out[1]] = 1;
  if (in[2] >= 0)
    weight[in[2]] = 1;
}

bw_status bw_outline_handle(bw_context *context, const bw_outline *outline, bw_handle_kind kind,
                            int32_t index, double *weight) {
  bw_status status = BW_OK;
  int32_t segment = index;
  if (kind == BW_HANDLE_VERTEX)
    BW_TRY(bwi_check_vertex(context, outline, index, &segment));
  else if (kind == BW_HANDLE_SEGMENT)
    BW_TRY(bwi_check_segment(context, outline, index));
  else if (kind == BW_HANDLE_LOOP)
    BW_TRY(bwi_check_loop(context, outline, index));
  else if (index < 0 || index >= outline->point_count)
    return bw_fail(context, BW_INVALID, "point %lld: the outline has points 1 to %d",
                   (long long)index + 1, outline->point_count);
  memset(weight, 0, (size_t)outline->point_count * sizeof *weight);
  if (kind == BW_HANDLE_POINT) {
    weight[index] = 1;
    return BW_OK;
  }
  if (kind == BW_HANDLE_LOOP) {
    for (int32_t l = 0; l < outline->loop_count; l++)
      for (int32_t s = 0; bwi_lies_in(outline, l, index) && s < outline->loop[l].count; s++)
        take_vertex(outline, &outline->loop[l], outline->loop[l].first + s, weight);
    return BW_OK;
  }
  const bw_loop *loop = &outline->loop[bw_segment_loop(outline, segment)];
  take_vertex(outline, loop, segment, weight);
  if (kind == BW_HANDLE_SEGMENT)
    take_vertex(outline, loop, bwi_next_segment(loop, segment), weight);
done:
  return status;
}
