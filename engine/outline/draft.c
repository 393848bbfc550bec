/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* Outlines put together piece by piece: what edits and readers do before bw_outline_create looks at
 * the whole. Numbers that come back after a failure are 0 and used for nothing. */
#include <string.h>

#include "outline/internal.h"

void bwi_draft_init(bwi_draft *draft, bw_context *context) {
  *draft = (bwi_draft){.context = context};
}

void bwi_draft_clear(bwi_draft *draft) {
  bw_free(draft->point);
  bw_free(draft->segment);
  bw_free(draft->loop);
  bw_free(draft->tag);
  bwi_draft_init(draft, draft->context);
}

static bool grow(bwi_draft *draft, void **list, size_t *capacity, size_t count, size_t extra,
                 size_t size) {
  if (draft->status == BW_OK && count + extra > INT32_MAX / 2)
    draft->status =
        bw_fail(draft->context, BW_LIMIT,
                "an outline of more than %d points: simplify it or split it", INT32_MAX / 2);
  if (draft->status == BW_OK && !bw_grow(draft->context, list, capacity, count, extra, size))
    draft->status = BW_MEMORY;
  return draft->status == BW_OK;
}

int32_t bwi_draft_point(bwi_draft *draft, const double at[2]) {
  if (!grow(draft, (void **)&draft->point, &draft->point_capacity, 2 * draft->points, 2,
            sizeof *draft->point))
    return 0;
  memcpy(draft->point + 2 * draft->points, at, 2 * sizeof *at);
  return (int32_t)draft->points++;
}

void bwi_draft_segment(bwi_draft *draft, int32_t start, int32_t control1, int32_t control2,
                       int32_t end, int32_t tag) {
  if (!grow(draft, (void **)&draft->segment, &draft->segment_capacity, draft->segments, 1,
            sizeof *draft->segment))
    return;
  draft->segment[draft->segments++] = (bw_segment){{start, control1, control2, end}, tag};
  draft->loop[draft->loops - 1].count++;
}

bw_name bwi_name(const char *text, size_t length) {
  bw_name name = {""};
  if (length > BW_NAME - 1) {
    length = BW_NAME - 1;
    while (length > 0 && ((unsigned char)text[length] & 0xC0) == 0x80)
      length--;
  }
  memcpy(name.text, text, length);
  return name;
}

bw_loop *bwi_draft_loop(bwi_draft *draft, const char *name, int32_t region) {
  static bw_loop nothing;
  if (!grow(draft, (void **)&draft->loop, &draft->loop_capacity, draft->loops, 1,
            sizeof *draft->loop))
    return &nothing;
  bw_loop *loop = &draft->loop[draft->loops++];
  *loop = (bw_loop){.first = (int32_t)draft->segments, .region = region, .parent = -1};
  loop->name = bwi_name(name, strlen(name));
  return loop;
}

int32_t bwi_draft_tag(bwi_draft *draft, const char *name) {
  bw_name tag = bwi_name(name, strlen(name));
  for (size_t t = 0; t < draft->tags; t++)
    if (strcmp(draft->tag[t].text, tag.text) == 0)
      return (int32_t)t;
  if (!grow(draft, (void **)&draft->tag, &draft->tag_capacity, draft->tags, 1, sizeof *draft->tag))
    return 0;
  draft->tag[draft->tags] = tag;
  return (int32_t)draft->tags++;
}

void bwi_draft_copy(bwi_draft *draft, const bw_outline *o) {
  size_t segments = (size_t)o->segment_count, loops = (size_t)o->loop_count;
  size_t tags = (size_t)o->tag_count;
  if (!grow(draft, (void **)&draft->segment, &draft->segment_capacity, 0, segments,
            sizeof *draft->segment) ||
      !grow(draft, (void **)&draft->loop, &draft->loop_capacity, 0, loops, sizeof *draft->loop) ||
      !grow(draft, (void **)&draft->tag, &draft->tag_capacity, 0, tags, sizeof *draft->tag))
    return;
  memcpy(draft->segment, o->segment, segments * sizeof *draft->segment);
  memcpy(draft->loop, o->loop, loops * sizeof *draft->loop);
  memcpy(draft->tag, o->tag, tags * sizeof *draft->tag);
  draft->segments = segments;
  draft->loops = loops;
  draft->tags = tags;
}

bw_status bwi_draft_finish(bwi_draft *draft, bw_outline **outline) {
  if (draft->status != BW_OK)
    return draft->status;
  return bw_outline_create(draft->context, (int32_t)draft->points, draft->point,
                           (int32_t)draft->segments, draft->segment, (int32_t)draft->loops,
                           draft->loop, (int32_t)draft->tags, draft->tag, outline);
}
