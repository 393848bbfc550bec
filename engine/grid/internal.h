/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* Places in the lattice of a grid. */
#ifndef BWI_GRID_INTERNAL_H
#define BWI_GRID_INTERNAL_H

#include "barwright/grid.h"

static inline int64_t bwi_grid_cells(const int32_t cells[3]) {
  return (int64_t)cells[0] * cells[1] * cells[2];
}
static inline int64_t bwi_grid_points(const int32_t cells[3]) {
  return ((int64_t)cells[0] + 1) * ((int64_t)cells[1] + 1) * ((int64_t)cells[2] + 1);
}
/* (i, j, k) of a cell, and of a lattice point: numbers below 2^31, so that short divisions do. */
static inline void bwi_grid_place(const int32_t cells[3], int64_t cell, int32_t place[3]) {
  uint32_t wide = (uint32_t)cells[0], high = (uint32_t)cells[1];
  uint32_t row = (uint32_t)cell / wide, layer = row / high;
  place[0] = (int32_t)((uint32_t)cell - row * wide);
  place[1] = (int32_t)(row - layer * high);
  place[2] = (int32_t)layer;
}
static inline void bwi_grid_lattice(const int32_t cells[3], int64_t point, int32_t place[3]) {
  int32_t points[3] = {cells[0] + 1, cells[1] + 1, cells[2] + 1};
  bwi_grid_place(points, point, place);
}
/* The lattice point at corner c of a cell. */
static inline int64_t bwi_grid_corner(const int32_t cells[3], int64_t cell, int c) {
  int32_t place[3];
  bwi_grid_place(cells, cell, place);
  return place[0] + (c & 1) +
         ((int64_t)cells[0] + 1) *
             (place[1] + (c >> 1 & 1) + ((int64_t)cells[1] + 1) * (place[2] + (c >> 2 & 1)));
}

/* From the lattice point at corner 0 of a cell to the one at corner c. */
static inline void bwi_grid_corner_steps(const int32_t cells[3], int64_t step[8]) {
  for (int c = 0; c < 8; c++)
    step[c] =
        (c & 1) + ((int64_t)cells[0] + 1) * ((c >> 1 & 1) + ((int64_t)cells[1] + 1) * (c >> 2 & 1));
}

/* The same elements at the same places: what was made for one grid is meant for the other. */
static inline bool bwi_grid_same_places(const bw_grid *a, const bw_grid *b) {
  bool same = true;
  for (int d = 0; d < 3; d++)
    same = same && a->origin[d] == b->origin[d] && a->spacing[d] == b->spacing[d];
  return same && bw_grid_same_elements(a, b);
}

/* Corners of side 0..5 (min x, max x, min y, ...) of a cell, counter-clockwise seen from
 * outside. */
extern const int bwi_grid_side_corner[6][4];
/* Whether an element has no neighbour on a side. */
bool bwi_grid_side_is_free(const bw_grid *grid, int32_t element, int side);

#endif
