/* Taking surfaces from CGAL's children.
 *
 * Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
#include "mesh/surface_cgal.h"

#include <string.h>

bw_status bwi_cgal_surface(bw_context *context, const char *what, const bwi_child_limits *limits,
                           bwi_child_work *work, void *job, bw_surface **surface) {
  bw_status status = BW_OK;
  unsigned char *bytes = NULL;
  size_t count = 0;
  int64_t head[2] = {0, 0};
  double *point = NULL;
  int32_t *triangle = NULL, *group = NULL;
  BW_TRY(bwi_child_run(context, what, limits, work, job, &bytes, &count));
  if (count >= sizeof head)
    memcpy(head, bytes, sizeof head);
  const bool fits = count >= sizeof head && head[0] >= 0 && head[1] >= 0 && head[0] <= INT32_MAX &&
                    head[1] <= INT32_MAX;
  const size_t bare = !fits ? 0
                            : sizeof head + (size_t)head[0] * 3 * sizeof *point +
                                  (size_t)head[1] * 3 * sizeof *triangle;
  const bool grouped = fits && head[1] > 0 && count == bare + (size_t)head[1] * sizeof *group;
  if (!fits || (count != bare && !grouped))
    BW_TRY(
        bw_fail(context, BW_INTERNAL, "%s returned %zu bytes that are not a surface", what, count));
  point = BW_NEW(context, double, (size_t)head[0] * 3);
  triangle = BW_NEW(context, int32_t, (size_t)head[1] * 3);
  if (grouped)
    group = BW_NEW(context, int32_t, (size_t)head[1]);
  BW_TRY_MEMORY(point && triangle && (!grouped || group));
  const unsigned char *at = bytes + sizeof head;
  memcpy(point, at, (size_t)head[0] * 3 * sizeof *point);
  memcpy(triangle, at + (size_t)head[0] * 3 * sizeof *point,
         (size_t)head[1] * 3 * sizeof *triangle);
  if (grouped)
    memcpy(group, bytes + bare, (size_t)head[1] * sizeof *group);
  BW_TRY(bw_surface_adopt(context, head[0], point, head[1], triangle, group, surface));
  point = NULL;
  triangle = group = NULL;
done:
  bw_free(bytes);
  bw_free(point);
  bw_free(triangle);
  bw_free(group);
  return status;
}
