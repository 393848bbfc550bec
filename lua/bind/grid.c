/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* bw.grid: hexahedral grids: boxes, voxels of surfaces, edits, coarse counterparts. What is chosen
 * by geometry is in region.c, what is embedded in embedding.c. */
#include "grid.h"
#include "bind.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>

/* Beyond this (3 GB, were all of them elements) a mistyped spacing is likelier than intent. */
#define MAX_CELLS 67108864.0

static const bw_grid *self(lua_State *L) {
  return (const bw_grid *)lbw_check(L, 1, &lbw_grid_class);
}

/* ---- materials ------------------------------------------------------------------------------- */

/* A number, a function, a formula, or a list with one for each of `count` cells. What is pushed
 * must stay. */
typedef struct source {
  lbw_field *field;
  int32_t *list;
} source;

static source read_source(lua_State *L, int index, const char *what, int64_t count) {
  source s = {NULL, NULL};
  index = lua_absindex(L, index);
  if (!lua_istable(L, index) && !lbw_test(L, index, &lbw_array_class)) {
    s.field = lbw_field_read(L, index, what);
    return s;
  }
  int64_t rows;
  double *value = lbw_to_doubles(L, index, what, 1, &rows);
  if (count < 0)
    lbw_error(
        L,
        "%s: a number, a function of x, y, z or a formula expected, got a list, whose order is "
        "not known here",
        what);
  if (rows != count)
    lbw_error(L, "%s: %I entries expected, one for each cell, got %I", what, (LUAI_UACINT)count,
              (LUAI_UACINT)rows);
  s.list = (int32_t *)lua_newuserdatauv(L, (size_t)(count + 1) * sizeof *s.list, 0);
  for (int64_t i = 0; i < count; i++) {
    if (!(value[i] >= 0 && value[i] <= INT32_MAX && value[i] == floor(value[i])))
      lbw_error(L, "%s: entry %I: a whole number expected, 0 for void, got %f", what,
                (LUAI_UACINT)i + 1, value[i]);
    s.list[i] = (int32_t)value[i];
  }
  return s;
}

static bw_status materials_of(bw_context *context, const source *s, const double origin[3],
                              const double spacing[3], const int32_t cells[3], int64_t count,
                              const int32_t *cell, int32_t *material) {
  if (s->list) {
    memcpy(material, s->list, (size_t)count * sizeof *material);
    return BW_OK;
  }
  lbw_field_begin(s->field, context);
  bw_status status = bw_cell_materials(context, origin, spacing, cells, count, cell,
                                       lbw_field_value, s->field, material);
  lbw_field_end(s->field, context);
  return status;
}

/* ---- making ---------------------------------------------------------------------------------- */

/* {x, y, z} or one number for all three; false: nothing there. */
static bool triple_option(lua_State *L, const char *function, const char *key, double out[3]) {
  int type = lbw_option_get(L, 1, key);
  bool given = type != LUA_TNIL;
  if (type == LUA_TNUMBER)
    out[0] = out[1] = out[2] = lua_tonumber(L, -1);
  else if (given && !lbw_to_vector(L, -1, out))
    lbw_option_refused(L, function, key, "a number or three {x, y, z}");
  lua_pop(L, 1);
  return given;
}

/* grid.box{size or max, min, cells, spacing, material} */
static int grid_box(lua_State *L) {
  static const lbw_option list[] = {{"min", LBW_OTHER, 0},     {"max", LBW_OTHER, 0},
                                    {"size", LBW_OTHER, 0},    {"cells", LBW_OTHER, 0},
                                    {"spacing", LBW_OTHER, 0}, {"material", LBW_OTHER, 0},
                                    {NULL, LBW_OTHER, 0}};
  double min[3] = {0, 0, 0}, max[3], size[3], counts[3], spacing[3];
  int32_t cells[3];
  lbw_check_type(L, 1, LUA_TTABLE);
  lua_settop(L, 1);
  lbw_options(L, 1, "grid.box", list, NULL);
  triple_option(L, "grid.box", "min", min);
  bool sized = triple_option(L, "grid.box", "size", size);
  if (triple_option(L, "grid.box", "max", max)) {
    if (sized)
      return lbw_error(L, "grid.box: one of the options 'size' and 'max' expected, got both");
    for (int d = 0; d < 3; d++)
      size[d] = max[d] - min[d];
    sized = true;
  }
  bool counted = triple_option(L, "grid.box", "cells", counts);
  bool spaced = triple_option(L, "grid.box", "spacing", spacing);
  if (sized + counted + spaced != 2)
    return lbw_error(
        L, "grid.box: two of the options 'size' (or 'max'), 'cells' and 'spacing' expected, got %d",
        sized + counted + spaced);
  static const char *const axis[] = {"x", "y", "z"};
  double all = 1;
  for (int d = 0; d < 3; d++) {
    if (!counted)
      counts[d] = round(size[d] / spacing[d]);
    if (!counted && !(fabs(size[d] / spacing[d] - counts[d]) < 1e-6))
      return lbw_error(
          L, "grid.box: a whole number of cells expected along %s, got %s in cells of %s", axis[d],
          lbw_quantity(size[d], "m").text, lbw_quantity(spacing[d], "m").text);
    if (!(counts[d] >= 1 && counts[d] <= 1e9 && counts[d] == floor(counts[d])))
      return lbw_error(L, "grid.box: a whole number of cells from 1 expected along %s, got %s",
                       axis[d], lbw_quantity(counts[d], "").text);
    if (sized && !(size[d] > 0))
      return lbw_error(L, "grid.box: a size above 0 expected along %s, got %s", axis[d],
                       lbw_quantity(size[d], "m").text);
    if (sized)
      spacing[d] = size[d] / counts[d];
    cells[d] = (int32_t)counts[d];
    all *= counts[d];
  }
  if (all > MAX_CELLS)
    return lbw_error(L, "grid.box: at most 2^26 cells expected, got %d x %d x %d", (int)cells[0],
                     (int)cells[1], (int)cells[2]);
  int64_t count = (int64_t)all;
  if (lbw_option_get(L, 1, "material") == LUA_TNIL) {
    lua_pop(L, 1);
    lua_pushinteger(L, 1);
  }
  source s = read_source(L, -1, "grid.box: material", count);
  lbw_box *box = lbw_box_new(L, &lbw_grid_class);
  bw_grid *out = NULL;
  bw_status status;
  bw_context *context = lbw_enter(L);
  int32_t *material = BW_NEW(context, int32_t, count);
  BW_TRY_MEMORY(material);
  BW_TRY(materials_of(context, &s, min, spacing, cells, count, NULL, material));
  BW_TRY(bw_grid_create(context, min, spacing, cells, material, NULL, &out));
done:
  bw_free(material);
  return lbw_leave_object(L, box, out, status);
}

/* The grid with these materials in its cells. */
static bw_status assign(bw_context *context, const bw_grid *grid, const source *s, int64_t count,
                        const int32_t *cell, bw_grid **out) {
  bw_status status;
  int32_t *material = BW_NEW(context, int32_t, count);
  if (!material)
    return BW_MEMORY;
  BW_TRY(materials_of(context, s, grid->origin, grid->spacing, grid->cells, count, cell, material));
  BW_TRY(bw_grid_edited(context, grid, count, cell, material, out));
done:
  bw_free(material);
  return status;
}

/* grid.voxels(surface, {spacing or cells, material, least, whole, multiple}) */
static int grid_voxels(lua_State *L) {
  static const lbw_option list[] = {
      {"spacing", LBW_REAL, offsetof(bw_voxel_options, spacing)},
      {"cells", LBW_INT, offsetof(bw_voxel_options, cells)},
      {"min_fraction", LBW_REAL, offsetof(bw_voxel_options, min_fraction)},
      {"whole", LBW_BOOLEAN, offsetof(bw_voxel_options, whole)},
      {"multiple", LBW_INT, offsetof(bw_voxel_options, multiple)},
      {"material", LBW_OTHER, 0},
      {NULL, LBW_OTHER, 0}};
  const bw_surface *surface = (const bw_surface *)lbw_check(L, 1, &lbw_surface_class);
  bw_voxel_options options;
  bw_voxel_options_default(&options);
  lua_settop(L, 2);
  lbw_options(L, 2, "grid.voxels", list, &options);
  source s = {NULL, NULL};
  if (lbw_option_get(L, 2, "material") != LUA_TNIL)
    s = read_source(L, -1, "grid.voxels: material", -1);
  lbw_box *box = lbw_box_new(L, &lbw_grid_class);
  bw_grid *full = NULL, *out = NULL;
  bw_status status;
  bw_context *context = lbw_enter(L);
  BW_TRY(bw_grid_of_surface(context, surface, &options, &full));
  if (s.field)
    BW_TRY(assign(context, full, &s, full->element_count, full->cell, &out));
  else
    out = (bw_grid *)bw_retain(full);
done:
  bw_release(full);
  return lbw_leave_object(L, box, out, status);
}

/* ---- edits ----------------------------------------------------------------------------------- */

/* A cell's number, or a list of them: in a userdata that is pushed; NULL: something else. */
static int32_t *read_cells(lua_State *L, int index, const bw_grid *grid, int64_t *count) {
  int64_t all = (int64_t)grid->cells[0] * grid->cells[1] * grid->cells[2];
  int32_t *cell = NULL;
  if (lua_type(L, index) == LUA_TNUMBER) {
    cell = (int32_t *)lua_newuserdatauv(L, sizeof *cell, 0);
    *cell = (int32_t)lbw_check_index(L, index, "cell", all);
    *count = 1;
  } else if (lbw_test(L, index, &lbw_array_class) ||
             (lua_istable(L, index) && lua_rawlen(L, index) > 0)) {
    cell = lbw_to_indices(L, index, "cells", 1, count);
  }
  return cell;
}

/* grid:set(cells or region, material, {void}): another grid */
static int grid_set(lua_State *L) {
  static const lbw_option list[] = {{"void", LBW_BOOLEAN, 0}, {NULL, LBW_OTHER, 0}};
  const bw_grid *grid = self(L);
  int64_t count = -1;
  lua_settop(L, 4);
  bool voids = false;
  lbw_options(L, 4, "set", list, &voids);
  lbw_region region = {0};
  int32_t *cell = read_cells(L, 2, grid, &count), *chosen = NULL, found;
  if (!cell)
    lbw_read_region(L, 2, "set", &region);
  if (lua_isnil(L, 3))
    return lbw_argument_error(L, 3,
                              "a number of a material (0: void), a function of x, y, z, a formula, "
                              "or with cells a list expected, got nil");
  source s = read_source(L, 3, "set: material", count);
  lbw_box *box = lbw_box_new(L, &lbw_grid_class);
  bw_grid *out = NULL;
  bw_status status;
  bw_context *context = lbw_enter(L);
  if (!cell) {
    BW_TRY(lbw_region_cells(context, grid, &region, voids, &chosen, &found));
    count = found;
  }
  BW_TRY(assign(context, grid, &s, count, cell ? cell : chosen, &out));
done:
  bw_free(chosen);
  return lbw_leave_object(L, box, out, status);
}

/* grid:coarse(levels): 2 x 2 x 2 cells become one, so many times; and the coarse element of each
 * element */
static int grid_coarse(lua_State *L) {
  const bw_grid *grid = self(L), *now = grid;
  lua_Integer levels = lbw_integer_or(L, 2, 1);
  lbw_argument_check(L, levels >= 1 && levels <= 30, 2, "levels from 1 to 30 expected");
  lbw_box *box = lbw_box_new(L, &lbw_grid_class);
  int32_t *parent = (int32_t *)lbw_push_array(L, BW_I32, grid->element_count, 1)->data;
  bw_coarsening *it = NULL;
  bw_status status = BW_OK;
  bw_context *context = lbw_enter(L);
  for (int32_t e = 0; e < grid->element_count; e++)
    parent[e] = e;
  bw_retain(now);
  for (lua_Integer level = 0; level < levels; level++) {
    BW_TRY(bw_coarsening_create(context, now, &it));
    for (int32_t e = 0; e < grid->element_count; e++)
      parent[e] = it->parent[parent[e]];
    bw_release(now);
    now = (const bw_grid *)bw_retain(it->coarse);
    bw_release(it);
  }
  for (int32_t e = 0; e < grid->element_count; e++)
    parent[e]++;
done:
  if (status != BW_OK) {
    bw_release(now);
    now = NULL;
  }
  lbw_box_fill(L, box, now);
  return lbw_leave(L, status, 2);
}

/* ---- what it is ------------------------------------------------------------------------------ */

static bw_status boundary_of(bw_context *context, const void *grid, bw_surface **surface,
                             int32_t **node) {
  return bw_grid_surface(context, (const bw_grid *)grid, surface, node);
}

/* grid:surface(): its boundary, and the node of every point */
static int grid_surface(lua_State *L) {
  return lbw_push_boundary(L, self(L), boundary_of);
}

/* grid:components(): how many bodies, and which one each element belongs to */
static int grid_components(lua_State *L) {
  const bw_grid *grid = self(L);
  int32_t count = 0;
  lua_settop(L, 1);
  int32_t *group = (int32_t *)lbw_push_array(L, BW_I32, grid->element_count, 1)->data;
  bw_status status = bw_grid_components(lbw_enter(L), grid, group, &count);
  for (int32_t e = 0; e < grid->element_count && status == BW_OK; e++)
    group[e]++;
  lua_pushinteger(L, count);
  lua_insert(L, -2);
  return lbw_leave(L, status, 2);
}

/* grid:write(path, {fields}) */
static int grid_write(lua_State *L) {
  static const lbw_option list[] = {{"fields", LBW_OTHER, 0}, {NULL, LBW_OTHER, 0}};
  const bw_grid *grid = self(L);
  const char *path = lbw_check_text(L, 2, NULL);
  size_t length = strlen(path);
  lua_settop(L, 3);
  lbw_options(L, 3, "write", list, NULL);
  if (length < 4 || strcasecmp(path + length - 4, ".vtu") != 0)
    return lbw_argument_refused(L, 2, "a path that ends in .vtu expected");
  lbw_option_get(L, 3, "fields");
  int count;
  bw_field *field = lbw_fields(L, -1, "write", grid->node_count, grid->element_count, &count);
  lua_pushboolean(L, 1);
  return lbw_leave(L, bw_grid_write_vtu(lbw_enter(L), grid, path, count, field), 1);
}

/* grid:difference(u, v): mean distance of the nodes moved by u and by v, over the longest side */
static int grid_difference(lua_State *L) {
  const bw_grid *grid = self(L);
  const double *field[2];
  lua_settop(L, 3);
  for (int i = 0; i < 2; i++) {
    int64_t rows;
    field[i] = lbw_to_doubles(L, i + 2, "displacements", 3, &rows);
    lbw_check_rows(L, i + 2, "displacements", rows, grid->node_count, "node");
  }
  lua_pushnumber(L, bw_grid_difference(grid, field[0], field[1]));
  return 1;
}

static int grid_same_elements(lua_State *L) {
  lua_pushboolean(
      L, bw_grid_same_elements(self(L), (const bw_grid *)lbw_check(L, 2, &lbw_grid_class)));
  return 1;
}

static int make_points(lua_State *L) {
  const bw_grid *grid = self(L);
  double *at = (double *)lbw_push_array(L, BW_F64, grid->node_count, 3)->data;
  for (int32_t n = 0; n < grid->node_count; n++)
    bw_grid_position(grid, n, at + 3 * (int64_t)n);
  return 1;
}

static int grid_points(lua_State *L) {
  return lbw_cached(L, "points", make_points);
}

static int grid_elements(lua_State *L) {
  const bw_grid *grid = self(L);
  return lbw_push_indices(L, grid->element_count, 8, grid->element);
}

static int grid_element_cells(lua_State *L) {
  const bw_grid *grid = self(L);
  return lbw_push_indices(L, grid->element_count, 1, grid->cell);
}

static int grid_materials(lua_State *L) {
  const bw_grid *grid = self(L);
  return lbw_push_borrowed(L, BW_I32, grid->element_count, 1, grid->material, grid);
}

static int grid_fractions(lua_State *L) {
  const bw_grid *grid = self(L);
  if (grid->fraction)
    return lbw_push_borrowed(L, BW_F64, grid->element_count, 1, grid->fraction, grid);
  double *fraction = (double *)lbw_push_array(L, BW_F64, grid->element_count, 1)->data;
  for (int32_t e = 0; e < grid->element_count; e++)
    fraction[e] = 1;
  return 1;
}

LBW_PUSH(grid_element_count, lua_pushinteger(L, self(L)->element_count))
LBW_PUSH(grid_node_count, lua_pushinteger(L, self(L)->node_count))

static int grid_cells(lua_State *L) {
  const bw_grid *grid = self(L);
  lua_createtable(L, 3, 0);
  for (int d = 0; d < 3; d++) {
    lua_pushinteger(L, grid->cells[d]);
    lua_rawseti(L, -2, d + 1);
  }
  return 1;
}

LBW_PUSH(grid_spacing, lbw_push_vector(L, self(L)->spacing))
LBW_PUSH(grid_origin, lbw_push_vector(L, self(L)->origin))

static int grid_bounds(lua_State *L) {
  double min[3], max[3];
  bw_grid_box(self(L), min, max);
  lbw_push_box(L, min, max);
  return 1;
}

LBW_PUSH(grid_volume, lua_pushnumber(L, bw_grid_volume(self(L))))

/* {[material] = number of elements} */
static int grid_material_counts(lua_State *L) {
  const bw_grid *grid = self(L);
  lua_newtable(L);
  for (int32_t e = 0, run; e < grid->element_count; e += run) {
    int32_t material = grid->material[e];
    for (run = 1; e + run < grid->element_count && grid->material[e + run] == material;)
      run++;
    lua_rawgeti(L, -1, material);
    lua_Integer count = lua_tointeger(L, -1) + run;
    lua_pop(L, 1);
    lua_pushinteger(L, count);
    lua_rawseti(L, -2, material);
  }
  return 1;
}

static int grid_tostring(lua_State *L) {
  const bw_grid *grid = self(L);
  double min[3], max[3];
  char text[200];
  int32_t largest = 0, cut = 0;
  for (int32_t e = 0; e < grid->element_count; e++) {
    largest = grid->material[e] > largest ? grid->material[e] : largest;
    cut += grid->fraction && grid->fraction[e] < 1;
  }
  snprintf(text, sizeof text, "grid: %d x %d x %d cells, %d elements", (int)grid->cells[0],
           (int)grid->cells[1], (int)grid->cells[2], (int)grid->element_count);
  lua_pushstring(L, text);
  if (cut) {
    snprintf(text, sizeof text, " (%d cut)", (int)cut);
    lua_pushstring(L, text);
  } else {
    lua_pushliteral(L, "");
  }
  snprintf(text, sizeof text, ", %d nodes, %s %d, ", (int)grid->node_count,
           largest > 1 ? "materials up to" : "material", (int)largest);
  lua_pushstring(L, text);
  bw_grid_box(grid, min, max);
  lbw_push_box_text(L, min, max);
  lua_concat(L, 4);
  return 1;
}

static const luaL_Reg methods[] = {{"set", grid_set},
                                   {"coarse", grid_coarse},
                                   {"surface", grid_surface},
                                   {"components", grid_components},
                                   {"write", grid_write},
                                   {"difference", grid_difference},
                                   {"same_elements", grid_same_elements},
                                   {NULL, NULL}};
static const luaL_Reg properties[] = {{"points", grid_points},
                                      {"elements", grid_elements},
                                      {"element_cells", grid_element_cells},
                                      {"materials", grid_materials},
                                      {"fractions", grid_fractions},
                                      {"element_count", grid_element_count},
                                      {"node_count", grid_node_count},
                                      {"cells", grid_cells},
                                      {"spacing", grid_spacing},
                                      {"origin", grid_origin},
                                      {"box", grid_bounds},
                                      {"volume", grid_volume},
                                      {"material_counts", grid_material_counts},
                                      {NULL, NULL}};
static const luaL_Reg meta[] = {{"__tostring", grid_tostring}, {NULL, NULL}};
const lbw_class lbw_grid_class = {"grid", methods, properties, meta, NULL};

void lbw_open_grid(lua_State *L) {
  static const luaL_Reg functions[] = {{"box", grid_box}, {"voxels", grid_voxels}, {NULL, NULL}};
  lbw_class_register(L, &lbw_grid_class);
  lbw_open_region(L);
  lbw_open_embedding(L);
  lua_newtable(L);
  luaL_setfuncs(L, functions, 0);
  lua_setfield(L, -2, "grid");
  lbw_open_grid_picture(L);
}
