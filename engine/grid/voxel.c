/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* Grids of what a closed surface holds: a lattice around its box; cells with enough inside. */
#include "grid/internal.h"

#include <math.h>
#include <string.h>

/* Sides that are longer than so many cells by less than this still fit. */
#define FITS 1e-9
/* More cells than this take more memory than a mistyped spacing should. */
#define MAX_CELLS 268435456.0

void bw_voxel_options_default(bw_voxel_options *options) {
  memset(options, 0, sizeof *options);
  options->cells = 32;
  options->min_fraction = 0.05;
  options->material = 1;
  options->multiple = 1;
}

static bw_status check(bw_context *context, const bw_voxel_options *o) {
  if (!isfinite(o->spacing) || o->spacing < 0)
    return bw_fail(context, BW_INVALID, "cells of %g m; the spacing must be positive", o->spacing);
  if (o->spacing == 0 && o->cells < 1)
    return bw_fail(context, BW_INVALID,
                   "%d cells along the longest side; at least one is needed, or a spacing",
                   (int)o->cells);
  if (!(o->min_fraction >= 0 && o->min_fraction <= 1))
    return bw_fail(context, BW_INVALID,
                   "the smallest fraction of a cell, %g, must lie between 0 and 1",
                   o->min_fraction);
  if (o->material < 1)
    return bw_fail(context, BW_INVALID, "material %d: at least 1 expected (0 is void)",
                   (int)o->material);
  if (o->multiple < 1)
    return bw_fail(context, BW_INVALID, "cells in multiples of %d: at least 1 expected",
                   (int)o->multiple);
  return BW_OK;
}

static double up_to_multiple(double cells, int32_t multiple) {
  return ceil(cells / multiple) * multiple;
}

static bw_status lattice(bw_context *context, const bw_surface *surface, const bw_voxel_options *o,
                         double origin[3], double spacing[3], int32_t cells[3]) {
  double low[3], high[3], longest = 0, count[3];
  bw_surface_box(surface, low, high);
  for (int d = 0; d < 3; d++)
    longest = fmax(longest, high[d] - low[d]);
  if (!(longest > 0) || !isfinite(longest))
    return bw_fail(context, BW_GEOMETRY, "the surface has no size: its box is %g m long", longest);
  double side = o->spacing > 0 ? o->spacing : longest / up_to_multiple(o->cells, o->multiple);
  for (int d = 0; d < 3; d++)
    count[d] = up_to_multiple(fmax(ceil((high[d] - low[d]) / side - FITS), 1), o->multiple);
  double all = count[0] * count[1] * count[2];
  if (!(all <= MAX_CELLS)) {
    bw_status status =
        bw_fail(context, BW_LIMIT,
                "cells of %g m in a box of %g x %g x %g m make %.3g cells, more than %.3g: take "
                "larger cells",
                side, high[0] - low[0], high[1] - low[1], high[2] - low[2], all, MAX_CELLS);
    bw_detail_number(context, "cells", all);
    return status;
  }
  for (int d = 0; d < 3; d++) {
    spacing[d] = side;
    cells[d] = (int32_t)count[d];
    double slack = count[d] * side - (high[d] - low[d]);
    origin[d] = low[d] - (slack > FITS * side ? slack / 2 : 0);
  }
  return BW_OK;
}

/* Warns of parts that thin places have cut off: nothing constrains them. */
static bw_status warn_of_parts(bw_context *context, const bw_grid *grid) {
  bw_status status = BW_OK;
  int32_t *size = NULL, parts, min = INT32_MAX, max = 0;
  int32_t *group = BW_NEW(context, int32_t, grid->element_count);
  if (!group)
    return BW_MEMORY;
  BW_TRY(bw_grid_components(context, grid, group, &parts));
  if (parts == 1)
    goto done;
  size = BW_NEW0(context, int32_t, parts);
  BW_TRY_MEMORY(size);
  for (int32_t e = 0; e < grid->element_count; e++)
    size[group[e]]++;
  for (int32_t i = 0; i < parts; i++) {
    min = size[i] < min ? size[i] : min;
    max = size[i] > max ? size[i] : max;
  }
  bw_warn(context,
          "the grid is in %d parts that share no node, of %d to %d elements: smaller cells, or a "
          "smaller minimum fraction, keep thin places connected",
          (int)parts, (int)min, (int)max);
done:
  bw_free(group);
  bw_free(size);
  return status;
}

bw_status bw_grid_of_surface(bw_context *context, const bw_surface *surface,
                             const bw_voxel_options *options, bw_grid **out) {
  bw_grid *grid = NULL;
  bw_voxel_options usual;
  double origin[3], spacing[3], *fraction = NULL, max = 0;
  int32_t cells[3], *material = NULL;
  bw_status status = BW_OK;
  int64_t all, held = 0;
  if (!options) {
    bw_voxel_options_default(&usual);
    options = &usual;
  }
  BW_TRY(check(context, options));
  BW_TRY(lattice(context, surface, options, origin, spacing, cells));
  all = bwi_grid_cells(cells);
  fraction = BW_NEW(context, double, all);
  material = BW_NEW(context, int32_t, all);
  BW_TRY_MEMORY(fraction && material);
  BW_TRY(bw_grid_fractions(context, surface, origin, spacing, cells, fraction));
  for (int64_t c = 0; c < all; c++) {
    max = fmax(max, fraction[c]);
    material[c] = fraction[c] > 0 && fraction[c] >= options->min_fraction ? options->material : 0;
    held += material[c] > 0;
  }
  if (max == 0)
    BW_TRY(bw_fail(context, BW_GEOMETRY,
                   "the surface encloses nothing that cells of %g m would hold: its volume is %g "
                   "m3",
                   spacing[0], bw_surface_volume(surface)));
  if (held == 0)
    BW_TRY(bw_fail(context, BW_EMPTY,
                   "no cell of %g m has a volume fraction above %.3g inside the surface, and the "
                   "minimum fraction is %g: take smaller cells or a smaller minimum fraction",
                   spacing[0], max, options->min_fraction));
  BW_TRY(bw_grid_create(context, origin, spacing, cells, material, options->whole ? NULL : fraction,
                        &grid));
  BW_TRY(warn_of_parts(context, grid));
  *out = grid;
  grid = NULL;
done:
  bw_release(grid);
  bw_free(fraction);
  bw_free(material);
  return status;
}
