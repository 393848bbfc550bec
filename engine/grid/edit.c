/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* Grids with other materials in some cells. */
#include "grid/internal.h"

#include <string.h>

static bw_status check_edit(bw_context *context, const bw_grid *grid, int64_t count,
                            const int32_t *cell, const int32_t *material) {
  int64_t cells = bwi_grid_cells(grid->cells);
  for (int64_t i = 0; i < count; i++) {
    if (cell[i] < 0 || cell[i] >= cells)
      return bw_fail(context, BW_INVALID, "cell %lld: the grid has cells 1 to %lld",
                     (long long)cell[i] + 1, (long long)cells);
    if (material[i] < 0)
      return bw_fail(context, BW_INVALID, "cell %lld has material %d: at least 0 (void) expected",
                     (long long)cell[i] + 1, (int)material[i]);
  }
  return BW_OK;
}

/* Whether each named cell keeps being an element, or void. Of a cell named twice the last counts,
 * so that one that comes and goes is taken for a change here: slower, not wrong. */
static bool same_elements(const bw_grid *grid, int64_t count, const int32_t *cell,
                          const int32_t *material) {
  for (int64_t i = 0; i < count; i++)
    if ((grid->at[cell[i]] >= 0) != (material[i] > 0))
      return false;
  return true;
}

static bw_status change_materials(bw_context *context, const bw_grid *grid, int64_t count,
                                  const int32_t *cell, const int32_t *material, bw_grid **edited) {
  bw_status status = BW_OK;
  size_t bytes = (size_t)grid->element_count * sizeof(int32_t);
  int32_t *now = BW_NEW(context, int32_t, grid->element_count);
  if (!now)
    return BW_MEMORY;
  memcpy(now, grid->material, bytes);
  for (int64_t i = 0; i < count; i++)
    if (material[i] > 0)
      now[grid->at[cell[i]]] = material[i];
  if (memcmp(now, grid->material, bytes) != 0)
    BW_TRY(bw_grid_with_materials(context, grid, now, edited));
  else
    *edited = (bw_grid *)bw_retain(grid);
done:
  bw_free(now);
  return status;
}

static bw_status change_elements(bw_context *context, const bw_grid *grid, int64_t count,
                                 const int32_t *cell, const int32_t *material, bw_grid **edited) {
  bw_status status = BW_OK;
  int64_t cells = bwi_grid_cells(grid->cells);
  int32_t *now = BW_NEW0(context, int32_t, cells);
  double *fraction = grid->fraction ? BW_NEW(context, double, cells) : NULL;
  BW_TRY_MEMORY(now && (!grid->fraction || fraction));
  for (int64_t c = 0; fraction && c < cells; c++)
    fraction[c] = 1;
  for (int32_t e = 0; e < grid->element_count; e++) {
    now[grid->cell[e]] = grid->material[e];
    if (fraction)
      fraction[grid->cell[e]] = grid->fraction[e];
  }
  for (int64_t i = 0; i < count; i++)
    now[cell[i]] = material[i];
  BW_TRY(bw_grid_create(context, grid->origin, grid->spacing, grid->cells, now, fraction, edited));
done:
  bw_free(now);
  bw_free(fraction);
  return status;
}

bw_status bw_grid_edited(bw_context *context, const bw_grid *grid, int64_t count,
                         const int32_t *cell, const int32_t *material, bw_grid **edited) {
  bw_status status = check_edit(context, grid, count, cell, material);
  if (status != BW_OK)
    return status;
  if (same_elements(grid, count, cell, material))
    return change_materials(context, grid, count, cell, material, edited);
  return change_elements(context, grid, count, cell, material, edited);
}
