/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* A loop more or fewer. Points and segments of what stays keep their order; points and regions
 * close up. */
#include <string.h>

#include "outline/internal.h"

bw_status bw_outline_with_loop(bw_context *context, const bw_outline *outline, int32_t points,
                               const double *point, int32_t segments, const bw_segment *segment,
                               const bw_loop *loop, bw_outline **larger) {
  bwi_draft draft;
  bwi_draft_init(&draft, context);
  bwi_draft_copy(&draft, outline);
  for (int64_t i = 0; i < outline->point_count; i++)
    bwi_draft_point(&draft, outline->point + 2 * i);
  for (int64_t i = 0; i < points; i++)
    bwi_draft_point(&draft, point + 2 * i);
  bw_loop *added = bwi_draft_loop(&draft, "", loop->region);
  added->name = loop->name;
  for (int32_t s = 0; s < segments; s++) {
    int32_t p[4];
    for (int i = 0; i < 4; i++) {
      p[i] = segment[s].point[i];
      if (p[i] >= 0 && p[i] < points)
        p[i] += outline->point_count;
      else if (p[i] >= 0 || i % 3 == 0)
        p[i] = INT32_MAX; /* refused by its number */
    }
    bwi_draft_segment(&draft, p[0], p[1], p[2], p[3], segment[s].tag);
  }
  bw_status status = bwi_draft_finish(&draft, larger);
  bwi_draft_clear(&draft);
  return status;
}

/* Regions renumbered, without those that no loop has any more. */
static void close_regions(bwi_draft *draft) {
  int32_t next = 0, max = -1;
  for (size_t l = 0; l < draft->loops; l++)
    max = draft->loop[l].region > max ? draft->loop[l].region : max;
  for (int32_t r = 0; r <= max; r++) {
    bool used = false;
    for (size_t l = 0; l < draft->loops; l++)
      if (draft->loop[l].region == r) {
        draft->loop[l].region = next;
        used = true;
      }
    next += used;
  }
}

bw_status bw_outline_without_loop(bw_context *context, const bw_outline *outline, int32_t loop,
                                  bw_outline **smaller) {
  bwi_draft draft;
  bwi_draft_init(&draft, context);
  int32_t *number = NULL;
  bw_status status = bwi_check_loop(context, outline, loop);
  if (status != BW_OK)
    return status;
  number = BW_NEW(context, int32_t, outline->point_count);
  if (!number)
    return BW_MEMORY;
  memset(number, 0xFF, (size_t)outline->point_count * sizeof *number);
  for (int32_t l = 0; l < outline->loop_count; l++)
    for (int32_t s = 0; !bwi_lies_in(outline, l, loop) && s < outline->loop[l].count; s++)
      for (int i = 0; i < 3; i++) {
        int32_t p = outline->segment[outline->loop[l].first + s].point[i];
        if (p >= 0)
          number[p] = 0;
      }
  for (int64_t p = 0; p < outline->point_count; p++)
    if (number[p] == 0)
      number[p] = bwi_draft_point(&draft, outline->point + 2 * p);
  for (int32_t t = 0; t < outline->tag_count; t++)
    bwi_draft_tag(&draft, outline->tag[t].text);
  for (int32_t l = 0; l < outline->loop_count; l++) {
    const bw_loop *from = &outline->loop[l];
    if (bwi_lies_in(outline, l, loop))
      continue;
    bwi_draft_loop(&draft, from->name.text, from->region);
    for (int32_t s = from->first; s < from->first + from->count; s++) {
      const int32_t *p = outline->segment[s].point;
      bool line = p[1] < 0;
      bwi_draft_segment(&draft, number[p[0]], line ? -1 : number[p[1]], line ? -1 : number[p[2]],
                        number[p[3]], outline->segment[s].tag);
    }
  }
  if (draft.status == BW_OK && draft.loops == 0)
    draft.status = bw_fail(context, BW_GEOMETRY, "without loop '%s' nothing would be left",
                           outline->loop[loop].name.text);
  close_regions(&draft);
  status = bwi_draft_finish(&draft, smaller);
  bw_free(number);
  bwi_draft_clear(&draft);
  return status;
}
