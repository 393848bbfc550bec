/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* Regions of grids: grid:nodes(region), grid:cells_in(region), and what grid:set takes. */
#include "grid.h"

#include <math.h>

/* {point, normal} */
static void pair_option(lua_State *L, int index, const char *function, const char *key,
                        double point[3], double normal[3]) {
  bool ok = lua_istable(L, index) && lua_rawlen(L, index) == 2;
  for (int i = 0; i < 2 && ok; i++) {
    lua_rawgeti(L, index, i + 1);
    ok = lbw_to_vector(L, -1, i ? normal : point);
    lua_pop(L, 1);
  }
  if (!ok)
    lbw_option_refused(L, function, key, "a point and a normal {{x, y, z}, {x, y, z}}");
}

static void read_where(lua_State *L, int index, const char *function, lbw_region *out) {
  out->field = lbw_field_read(L, index, function);
  out->region.parts |= BW_WHERE;
  out->region.where = lbw_field_value;
  out->region.where_data = out->field;
}

static void read_inside(lua_State *L, int index, const char *function, lbw_region *out) {
  out->region.surface = (const bw_surface *)lbw_test(L, index, &lbw_surface_class);
  if (!out->region.surface)
    lbw_option_refused(L, function, "inside", "a surface");
  out->region.parts |= BW_IN_SURFACE;
}

static void read_table(lua_State *L, int index, const char *function, lbw_region *out) {
  static const lbw_option list[] = {{"min", LBW_VECTOR, offsetof(bw_region, min)},
                                    {"max", LBW_VECTOR, offsetof(bw_region, max)},
                                    {"centre", LBW_VECTOR, offsetof(bw_region, centre)},
                                    {"radius", LBW_REAL, offsetof(bw_region, radius)},
                                    {"within", LBW_REAL, offsetof(bw_region, within)},
                                    {"box", LBW_OTHER, 0},
                                    {"plane", LBW_OTHER, 0},
                                    {"beyond", LBW_OTHER, 0},
                                    {"side", LBW_OTHER, 0},
                                    {"boundary", LBW_OTHER, 0},
                                    {"inside", LBW_OTHER, 0},
                                    {"where", LBW_OTHER, 0},
                                    {NULL, LBW_OTHER, 0}};
  static const char *const sides[] = {"min x", "max x", "min y", "max y", "min z", "max z", NULL};
  bw_region *r = &out->region;
  bool given = false;
  for (int d = 0; d < 3; d++) {
    r->min[d] = -INFINITY;
    r->max[d] = INFINITY;
  }
  lbw_options(L, index, function, list, r);
  for (int d = 0; d < 3; d++)
    given |= r->min[d] != -INFINITY || r->max[d] != INFINITY;
  if (lbw_option_get(L, index, "box") != LUA_TNIL) {
    pair_option(L, lua_gettop(L), function, "box", r->min, r->max);
    given = true;
  }
  r->parts |= given ? BW_IN_BOX : 0;
  bool centred = lbw_option_get(L, index, "centre") != LUA_TNIL;
  if (centred != (lbw_option_get(L, index, "radius") != LUA_TNIL))
    lbw_option_missing(L, function, centred ? "radius" : "centre",
                       centred ? " beside 'centre'" : " beside 'radius'");
  r->parts |= centred ? BW_IN_BALL : 0;
  if (lbw_option_get(L, index, "plane") != LUA_TNIL) {
    pair_option(L, lua_gettop(L), function, "plane", r->plane_point, r->plane_normal);
    r->parts |= BW_ON_PLANE;
  }
  if (lbw_option_get(L, index, "beyond") != LUA_TNIL) {
    pair_option(L, lua_gettop(L), function, "beyond", r->beyond_point, r->beyond_normal);
    r->parts |= BW_BEYOND;
  }
  r->side = lbw_word_option(L, index, function, "side", sides, -1);
  r->parts |= r->side >= 0 ? BW_ON_SIDE : 0;
  if (lbw_option_get(L, index, "boundary") != LUA_TNIL) {
    if (!lua_isboolean(L, -1))
      lbw_option_refused(L, function, "boundary", "true or false");
    r->parts |= lua_toboolean(L, -1) ? BW_ON_BOUNDARY : 0;
  }
  if (lbw_option_get(L, index, "inside") != LUA_TNIL)
    read_inside(L, -1, function, out);
  if (lbw_option_get(L, index, "where") != LUA_TNIL)
    read_where(L, -1, function, out);
}

void lbw_read_region(lua_State *L, int index, const char *function, lbw_region *out) {
  *out = (lbw_region){0};
  index = lua_absindex(L, index);
  luaL_checkstack(L, 30, "too many values");
  if (lua_istable(L, index))
    read_table(L, index, function, out);
  else if (lbw_test(L, index, &lbw_surface_class))
    read_inside(L, index, function, out);
  else if (lua_isfunction(L, index) || lua_type(L, index) == LUA_TSTRING)
    read_where(L, index, function, out);
  else
    lbw_error(L,
              "%s: a region expected: {min =, max =}, {centre =, radius =}, {side = \"min x\"}, a "
              "function of x, y, z, a formula, or a surface, got %s",
              function, lbw_got(L, index));
}

bw_status lbw_region_cells(bw_context *context, const bw_grid *grid, const lbw_region *region,
                           bool voids, int32_t **cell, int32_t *count) {
  if (region->field)
    lbw_field_begin(region->field, context);
  bw_status status = bw_grid_cells(context, grid, &region->region, voids, cell, count);
  if (region->field)
    lbw_field_end(region->field, context);
  return status;
}

bw_status lbw_region_nodes(bw_context *context, const bw_grid *grid, const lbw_region *region,
                           int32_t **node, int32_t *count) {
  if (region->field)
    lbw_field_begin(region->field, context);
  bw_status status = bw_grid_nodes(context, grid, &region->region, node, count);
  if (region->field)
    lbw_field_end(region->field, context);
  return status;
}

/* The list, counted from 1, as an array; takes it over. */
static int leave(lua_State *L, bw_context *context, lbw_box *box, int32_t *list, int32_t count,
                 bw_status status) {
  bw_array *array = NULL;
  for (int32_t i = 0; i < count && status == BW_OK; i++)
    list[i]++;
  if (status == BW_OK)
    status = bw_array_adopt(context, BW_I32, count, 1, list, &array);
  if (status != BW_OK)
    bw_free(list);
  return lbw_leave_object(L, box, array, status);
}

/* grid:nodes(region): numbers of nodes */
static int grid_nodes(lua_State *L) {
  const bw_grid *grid = (const bw_grid *)lbw_check(L, 1, &lbw_grid_class);
  lbw_region region;
  int32_t *node = NULL, count = 0;
  lua_settop(L, 2);
  lbw_read_region(L, 2, "nodes", &region);
  lbw_box *box = lbw_box_new(L, &lbw_array_class);
  bw_context *context = lbw_enter(L);
  bw_status status = lbw_region_nodes(context, grid, &region, &node, &count);
  return leave(L, context, box, node, count, status);
}

/* grid:cells_in(region, {void}): numbers of cells */
static int grid_cells_in(lua_State *L) {
  static const lbw_option list[] = {{"void", LBW_BOOLEAN, 0}, {NULL, LBW_OTHER, 0}};
  const bw_grid *grid = (const bw_grid *)lbw_check(L, 1, &lbw_grid_class);
  lbw_region region;
  int32_t *cell = NULL, count = 0;
  bool voids = false;
  lua_settop(L, 3);
  lbw_options(L, 3, "cells_in", list, &voids);
  lbw_read_region(L, 2, "cells_in", &region);
  lbw_box *box = lbw_box_new(L, &lbw_array_class);
  bw_context *context = lbw_enter(L);
  bw_status status = lbw_region_cells(context, grid, &region, voids, &cell, &count);
  return leave(L, context, box, cell, count, status);
}

void lbw_open_region(lua_State *L) {
  static const luaL_Reg methods[] = {
      {"nodes", grid_nodes}, {"cells_in", grid_cells_in}, {NULL, NULL}};
  lbw_add_methods(L, &lbw_grid_class, methods);
}
