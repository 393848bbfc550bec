/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* Grids with other materials in some cells. */
#include "grid/internal.h"

static bw_status check_edit(bw_context *context, const bw_grid *grid, int64_t count,
                            const int32_t *cell, const int32_t *material) {
  int64_t cells = bwi_grid_cells(grid->cells);
  for (int64_t i = 0; i < count; i++) {
    if (cell[i] < 0 || cell[i] >= cells)
      return bw_fail(context, BW_INVALID, "cell %lld: the grid has cells 1 to %lld",
                     (long long)cell[i] + 1, (long long)cells);
    if (material[i] < 0)
      return bw_fail(context, BW_INVALID, "cell %lld has material %d; 0 (void) is the least",
                     (long long)cell[i] + 1, (int)material[i]);
  }
  return BW_OK;
}

static bool changes(const bw_grid *grid, const int32_t *material) {
  int64_t cells = bwi_grid_cells(grid->cells);
  for (int64_t c = 0; c < cells; c++)
    if (material[c] != (grid->at[c] < 0 ? 0 : grid->material[grid->at[c]]))
      return true;
  return false;
}

bw_status bw_grid_edited(bw_context *context, const bw_grid *grid, int64_t count,
                         const int32_t *cell, const int32_t *material, bw_grid **edited) {
  bw_status status = check_edit(context, grid, count, cell, material);
  if (status != BW_OK)
    return status;
  int64_t cells = bwi_grid_cells(grid->cells);
  int32_t *now = BW_NEW0(context, int32_t, cells);
  double *fraction = grid->fraction ? BW_NEW(context, double, cells) : NULL;
  if (!now || (grid->fraction && !fraction)) {
    status = BW_MEMORY;
    goto done;
  }
  for (int64_t c = 0; fraction && c < cells; c++)
    fraction[c] = 1;
  for (int32_t e = 0; e < grid->element_count; e++) {
    now[grid->cell[e]] = grid->material[e];
    if (fraction)
      fraction[grid->cell[e]] = grid->fraction[e];
  }
  for (int64_t i = 0; i < count; i++)
    now[cell[i]] = material[i];
  if (changes(grid, now))
    BW_TRY(
        bw_grid_create(context, grid->origin, grid->spacing, grid->cells, now, fraction, edited));
  else
    *edited = (bw_grid *)bw_retain(grid);
done:
  bw_free(now);
  bw_free(fraction);
  return status;
}
