/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* Which elements hang together. */
#include "grid/internal.h"

/* Groups are numbered by their first element. */
bw_status bw_grid_components(bw_context *context, const bw_grid *grid, int32_t *group,
                             int32_t *count) {
  int32_t found = 0, n = grid->element_count;
  int32_t *own = group ? group : BW_NEW(context, int32_t, n);
  int32_t *queue = BW_NEW(context, int32_t, n);
  if (!own || !queue) {
    bw_free(queue);
    if (!group)
      bw_free(own);
    return BW_MEMORY;
  }
  for (int32_t e = 0; e < n; e++)
    own[e] = -1;
  for (int32_t first = 0; first < n; first++) {
    int32_t head = 0, tail = 0;
    if (own[first] >= 0)
      continue;
    own[first] = found;
    queue[tail++] = first;
    while (head < tail) {
      int32_t place[3];
      bwi_grid_place(grid->cells, grid->cell[queue[head++]], place);
      /* Elements that share a node are the 26 around a cell. */
      for (int i = 0; i < 27; i++) {
        int64_t at = 0;
        bool inside = true;
        for (int d = 2, offset = i; d >= 0; d--, offset /= 3) {
          int32_t x = place[d] + offset % 3 - 1;
          inside &= x >= 0 && x < grid->cells[d];
          at = at * grid->cells[d] + x;
        }
        int32_t other = inside ? grid->at[at] : -1;
        if (other >= 0 && own[other] < 0) {
          own[other] = found;
          queue[tail++] = other;
        }
      }
    }
    found++;
  }
  *count = found;
  bw_free(queue);
  if (!group)
    bw_free(own);
  return BW_OK;
}
