/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* Grids as VTU files, cells of type 12: VTK's hexahedron runs around the low face, then around the
 * high one, where corners here run x fastest. */
#include "io/vtu.h"
#include "grid/internal.h"

#include <string.h>

enum { HEXAHEDRON = 12 };

bw_status bw_grid_write_vtu(bw_context *context, const bw_grid *grid, const char *path,
                            int field_count, const bw_field *fields) {
  static const int order[8] = {0, 1, 3, 2, 4, 5, 7, 6};
  bw_status status = BW_OK;
  bw_array *fraction = NULL;
  double *point = BW_NEW(context, double, 3 * (int64_t)grid->node_count);
  int32_t *cell = BW_NEW(context, int32_t, 8 * (int64_t)grid->element_count);
  bw_field *list = BW_NEW0(context, bw_field, (size_t)field_count + 1);
  BW_TRY_MEMORY(point && cell && list);
  for (int32_t n = 0; n < grid->node_count; n++)
    bw_grid_position(grid, n, point + 3 * (int64_t)n);
  for (int64_t e = 0; e < grid->element_count; e++)
    for (int c = 0; c < 8; c++)
      cell[8 * e + c] = grid->element[8 * e + order[c]];
  for (int i = 0; i < field_count; i++)
    list[i] = fields[i];
  if (grid->fraction) {
    BW_TRY(
        bw_array_borrow(context, BW_F64, grid->element_count, 1, grid->fraction, grid, &fraction));
    list[field_count++] = (bw_field){"fraction", BW_ON_ELEMENTS, fraction};
  }
  bwi_vtu_cells cells = {
      grid->node_count, grid->element_count, point,       8,    HEXAHEDRON, cell,
      grid->material,   "material",          field_count, list, 0,          NULL};
  BW_TRY(bwi_vtu_write_cells(context, &cells, path));
done:
  bw_release(fraction);
  bw_free(point);
  bw_free(cell);
  bw_free(list);
  return status;
}
