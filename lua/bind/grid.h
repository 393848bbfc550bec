/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* Between grid.c, region.c and embedding.c. */
#ifndef LBW_GRID_H
#define LBW_GRID_H

#include "bind.h"

typedef struct lbw_region {
  bw_region region;
  lbw_field *field; /* of its `where`, or NULL */
} lbw_region;
/* A function or formula (where it is not 0), a surface (inside), or a table of parts. What is
 * pushed must stay. */
void lbw_read_region(lua_State *L, int index, const char *function, lbw_region *region);
/* bw_grid_cells and bw_grid_nodes with the field begun and ended. */
bw_status lbw_region_cells(bw_context *context, const bw_grid *grid, const lbw_region *region,
                           bool voids, int32_t **cell, int32_t *count);
bw_status lbw_region_nodes(bw_context *context, const bw_grid *grid, const lbw_region *region,
                           int32_t **node, int32_t *count);

/* Add their methods to the registered grid class. */
void lbw_open_region(lua_State *L);
void lbw_open_embedding(lua_State *L);
void lbw_open_grid_picture(lua_State *L);

#endif
