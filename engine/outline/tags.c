/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* Tags changed: a new outline, since the topology includes the tags. */
#include <string.h>

#include "outline/internal.h"

bw_status bw_outline_tagged(bw_context *context, const bw_outline *outline, int32_t segments,
                            const int32_t *segment, const char *tag, bw_outline **tagged) {
  bwi_draft draft;
  bw_status status = BW_OK;
  bwi_draft_init(&draft, context);
  if (!tag[0] || strlen(tag) >= BW_NAME)
    return bw_fail(context, BW_INVALID, "the tag '%s': a name of 1 to %d bytes expected", tag,
                   BW_NAME - 1);
  for (int32_t i = 0; i < segments; i++)
    BW_TRY(bwi_check_segment(context, outline, segment[i]));
  bwi_draft_copy(&draft, outline);
  for (int64_t i = 0; i < outline->point_count; i++)
    bwi_draft_point(&draft, outline->point + 2 * i);
  int32_t number = bwi_draft_tag(&draft, tag);
  for (int32_t i = 0; i < segments && draft.status == BW_OK; i++)
    draft.segment[segment[i]].tag = number;
  status = bwi_draft_finish(&draft, tagged);
done:
  bwi_draft_clear(&draft);
  return status;
}
