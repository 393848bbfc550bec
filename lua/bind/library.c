/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* bw.metamaterial: libraries of coarse materials, and grids coarsened by them. */
#include "solid.h"

#include <stdio.h>
#include <string.h>

static const bw_library *self(lua_State *L) {
  return (const bw_library *)lbw_check(L, 1, &lbw_library_class);
}

static const lbw_option library_options[] = {
    {"levels", LBW_INT, offsetof(bw_library_options, levels)},
    {"voids", LBW_BOOLEAN, offsetof(bw_library_options, voids)},
    {"directions", LBW_INT, offsetof(bw_library_options, directions)},
    {"magnitudes", LBW_INT, offsetof(bw_library_options, magnitudes)},
    {"stretches", LBW_INT, offsetof(bw_library_options, stretches)},
    {"fibres", LBW_INT, offsetof(bw_library_options, fibres)},
    {"strain", LBW_REAL, offsetof(bw_library_options, strain)},
    {"ridge", LBW_REAL, offsetof(bw_library_options, ridge)},
    {"representatives", LBW_INT, offsetof(bw_library_options, representatives)},
    {"seed", LBW_SEED, offsetof(bw_library_options, seed)},
    {"checkpoint", LBW_OTHER, 0},
    {NULL, LBW_OTHER, 0}};

/* The path stays on the stack. */
static const char *checkpoint_of(lua_State *L, int arg, const char *function) {
  int type = lbw_option_get(L, arg, "checkpoint");
  if (type != LUA_TNIL && type != LUA_TSTRING)
    lbw_option_refused(L, function, "checkpoint", "a path");
  return type == LUA_TNIL ? NULL : lua_tostring(L, -1);
}

/* metamaterial.build(material table, options) */
static int library_build(lua_State *L) {
  lua_settop(L, 2);
  bw_library_options options;
  bw_library_options_default(&options);
  lbw_options(L, 2, "metamaterial.build", library_options, &options);
  const char *checkpoint = checkpoint_of(L, 2, "metamaterial.build");
  const bw_material_table *material_table = lbw_check_material_table(L, 1, "metamaterial.build");
  lbw_box *box = lbw_box_new(L, &lbw_library_class);
  bw_library *library = NULL;
  bw_status status = bw_library_build(lbw_enter(L), material_table, &options, checkpoint, &library);
  return lbw_leave_object(L, box, library, status);
}

static const lbw_option grow_options[] = {
    {"levels", LBW_INT, 0}, {"checkpoint", LBW_OTHER, 0}, {NULL, LBW_OTHER, 0}};

/* metamaterial.grow(library | material table, grid, options): of a material table, with the options
 * of a library too, nothing but the grid's blocks. */
static int library_grow(lua_State *L) {
  static const char function[] = "metamaterial.grow";
  lua_settop(L, 3);
  const bw_grid *grid = (const bw_grid *)lbw_check(L, 2, &lbw_grid_class);
  const bw_library *of = (const bw_library *)lbw_test(L, 1, &lbw_library_class);
  bw_library_options options;
  int levels = 1;
  bw_library_options_default(&options);
  if (of) {
    lbw_options(L, 3, function, grow_options, &levels);
  } else {
    lbw_options(L, 3, function, library_options, &options);
    levels = options.levels;
  }
  if (levels < 1 || levels > 2)
    return lbw_error(L, "%s: option 'levels': 1 or 2 expected, got %d", function, levels);
  options.levels = 0;
  const char *checkpoint = checkpoint_of(L, 3, function);
  const bw_material_table *material_table =
      of ? of->material_table : lbw_check_material_table(L, 1, function);
  lbw_box *box = lbw_box_new(L, &lbw_library_class);
  bw_library *library = NULL, *empty = NULL;
  bw_context *context = lbw_enter(L);
  bw_status status = of ? BW_OK : bw_library_build(context, material_table, &options, NULL, &empty);
  if (status == BW_OK)
    status = bw_library_grow(context, of ? of : empty, material_table, grid, levels, checkpoint,
                             &library);
  bw_release(empty);
  return lbw_leave_object(L, box, library, status);
}

/* metamaterial.read(path) */
static int library_read(lua_State *L) {
  const char *path = lbw_check_text(L, 1, NULL);
  lbw_box *box = lbw_box_new(L, &lbw_library_class);
  bw_library *library = NULL;
  bw_status status = bw_library_read(lbw_enter(L), path, &library);
  return lbw_leave_object(L, box, library, status);
}

/* library:write(path) */
static int library_write(lua_State *L) {
  const bw_library *library = self(L);
  const char *path = lbw_check_text(L, 2, NULL);
  lua_settop(L, 1);
  return lbw_leave(L, bw_library_write(lbw_enter(L), library, path), 1);
}

/* library:material(key): 8 or 64 numbers, 0 for void; the material and the number of its fit */
static int library_material(lua_State *L) {
  const bw_library *library = self(L);
  int32_t key[64], fit = 0;
  lbw_check_type(L, 2, LUA_TTABLE);
  size_t count = lua_rawlen(L, 2);
  if (count != 8 && count != 64)
    return lbw_error(L, "key: 8 materials expected, or 64 for level 2, got %d", (int)count);
  for (size_t i = 0; i < count; i++) {
    lua_rawgeti(L, 2, (lua_Integer)i + 1);
    int whole;
    lua_Integer value = lua_tointegerx(L, -1, &whole);
    if (!whole || value < 0 || value > INT32_MAX)
      return lbw_error(L, "key: entry %d: a whole number expected, 0 for void, got %s", (int)i + 1,
                       luaL_tolstring(L, -1, NULL));
    key[i] = (int32_t)value;
    lua_pop(L, 1);
  }
  lbw_box *box = lbw_box_new(L, &lbw_solid_material_class);
  bw_solid_material *material = NULL;
  bw_status status =
      bw_library_material(lbw_enter(L), library, count == 8 ? 1 : 2, key, &material, &fit);
  lbw_box_fill(L, box, material);
  if (status == BW_OK)
    lua_pushinteger(L, fit + 1);
  return lbw_leave(L, status, status == BW_OK ? 2 : 1);
}

static int library_tostring(lua_State *L) {
  const bw_library *library = self(L);
  char *text = NULL;
  bw_status status = bw_library_describe(lbw_enter(L), library, &text);
  luaL_Buffer buffer;
  luaL_buffinit(L, &buffer);
  luaL_addstring(&buffer, text ? text : "library");
  bw_free(text);
  luaL_pushresult(&buffer);
  lbw_leave_or_raise(L, status);
  return 1;
}

LBW_PUSH(library_levels, lua_pushinteger(L, self(L)->levels))
LBW_PUSH(library_seconds, lua_pushnumber(L, self(L)->seconds))

/* grown: how many blocks of each level were fitted for grids */
static int library_grown(lua_State *L) {
  lua_createtable(L, 2, 0);
  for (int l = 0; l < 2; l++) {
    lua_pushinteger(L, self(L)->grown_count[l]);
    lua_rawseti(L, -2, l + 1);
  }
  return 1;
}

LBW_PUSH(library_palette, lbw_push(L, &lbw_material_table_class, self(L)->material_table))

/* errors: for each level a list of rows {median, worst, naive_median, naive_worst, force,
 * naive_force, samples}, one for each fit */
static int library_errors(lua_State *L) {
  const bw_library *library = self(L);
  lua_createtable(L, library->levels, 0);
  for (int l = 0; l < library->levels; l++) {
    lua_createtable(L, library->fit_count[l], 0);
    for (int32_t i = 0; i < library->fit_count[l]; i++) {
      const bw_fit_error *e = &library->error[l][i];
      lua_createtable(L, 0, 7);
#define SET(name)                                                                                  \
  lua_pushnumber(L, (double)e->name);                                                              \
  lua_setfield(L, -2, #name)
      SET(median);
      SET(worst);
      SET(naive_median);
      SET(naive_worst);
      SET(force);
      SET(naive_force);
      SET(samples);
#undef SET
      lua_rawseti(L, -2, i + 1);
    }
    lua_rawseti(L, -2, l + 1);
  }
  return 1;
}

static const luaL_Reg methods[] = {
    {"write", library_write}, {"material", library_material}, {NULL, NULL}};
static const luaL_Reg properties[] = {{"levels", library_levels},     {"seconds", library_seconds},
                                      {"materials", library_palette}, {"errors", library_errors},
                                      {"grown", library_grown},       {NULL, NULL}};
static const luaL_Reg meta[] = {{"__tostring", library_tostring}, {NULL, NULL}};
const lbw_class lbw_library_class = {"library", methods, properties, meta, NULL};

/* ---- coarse grids ---------------------------------------------------------------------------- */

static const bw_coarse *self_coarse(lua_State *L) {
  return (const bw_coarse *)lbw_check(L, 1, &lbw_coarse_class);
}

/* metamaterial.coarsen(grid, material table, library | "naive" | "average", levels) */
static int coarse_create(lua_State *L) {
  static const char *const words[] = {"naive", "average", NULL};
  lua_settop(L, 4);
  const bw_grid *grid = (const bw_grid *)lbw_check(L, 1, &lbw_grid_class);
  const bw_library *library = NULL;
  bw_coarse_method method = BW_COARSE_LOOKUP;
  if (lua_type(L, 3) == LUA_TUSERDATA)
    library = (const bw_library *)lbw_check(L, 3, &lbw_library_class);
  else
    method = lbw_check_word(L, 3, words) == 0 ? BW_COARSE_NAIVE : BW_COARSE_AVERAGE;
  lua_Integer levels = lbw_integer_or(L, 4, 1);
  lbw_argument_check(L, levels >= 1 && levels <= 2, 4, "1 or 2 levels expected");
  const bw_material_table *material_table = lbw_check_material_table(L, 2, "coarsen");
  lbw_box *box = lbw_box_new(L, &lbw_coarse_class);
  bw_coarse *coarse = NULL;
  bw_status status =
      bw_coarsen(lbw_enter(L), method, library, material_table, grid, (int)levels, &coarse);
  return lbw_leave_object(L, box, coarse, status);
}

/* coarse:follow(grid) */
static int coarse_follow(lua_State *L) {
  const bw_coarse *coarse = self_coarse(L);
  const bw_grid *grid = (const bw_grid *)lbw_check(L, 2, &lbw_grid_class);
  lbw_box *box = lbw_box_new(L, &lbw_coarse_class);
  bw_coarse *followed = NULL;
  bw_status status = bw_coarse_follow(lbw_enter(L), coarse, grid, &followed);
  return lbw_leave_object(L, box, followed, status);
}

/* coarse:to_fine(displacement) */
static int coarse_to_fine(lua_State *L) {
  const bw_coarse *coarse = self_coarse(L);
  const double *u = lbw_read_displacement(L, 2, "displacement", coarse->grid);
  if (!u)
    return lbw_error(L, "to_fine: displacement: an array of %d x 3 expected, got nil",
                     (int)coarse->grid->node_count);
  bw_array *fine = lbw_push_array(L, BW_F64, coarse->fine->node_count, 3);
  bw_coarse_to_fine(coarse, u, (double *)fine->data);
  return 1;
}

/* coarse:coarsening(level) */
static int coarse_coarsening(lua_State *L) {
  const bw_coarse *coarse = self_coarse(L);
  int64_t level = lbw_check_index(L, 2, "level", coarse->levels);
  lbw_push(L, &lbw_coarsening_class, coarse->coarsening[level]);
  return 1;
}

LBW_PUSH(coarse_grid, lbw_push(L, &lbw_grid_class, self_coarse(L)->grid))
LBW_PUSH(coarse_fine, lbw_push(L, &lbw_grid_class, self_coarse(L)->fine))
LBW_PUSH(coarse_material_table,
         lbw_push(L, &lbw_material_table_class, self_coarse(L)->material_table))
LBW_PUSH(coarse_levels, lua_pushinteger(L, self_coarse(L)->levels))
LBW_PUSH(coarse_looked_up, lua_pushinteger(L, self_coarse(L)->looked_up))

static int coarse_seconds(lua_State *L) {
  const bw_coarse *coarse = self_coarse(L);
  lua_pushnumber(L, coarse->seconds_lattice + coarse->seconds_lookup);
  return 1;
}

static int coarse_tostring(lua_State *L) {
  const bw_coarse *c = self_coarse(L);
  char text[200];
  snprintf(text, sizeof text,
           "coarse grid: %d elements for %d fine ones, %d materials, %lld blocks looked up",
           (int)c->grid->element_count, (int)c->fine->element_count,
           (int)c->material_table->count - 1, (long long)c->looked_up);
  lua_pushstring(L, text);
  return 1;
}

static const luaL_Reg coarse_methods[] = {{"follow", coarse_follow},
                                          {"to_fine", coarse_to_fine},
                                          {"coarsening", coarse_coarsening},
                                          {NULL, NULL}};
static const luaL_Reg coarse_properties[] = {{"grid", coarse_grid},
                                             {"fine", coarse_fine},
                                             {"materials", coarse_material_table},
                                             {"levels", coarse_levels},
                                             {"looked_up", coarse_looked_up},
                                             {"seconds", coarse_seconds},
                                             {NULL, NULL}};
static const luaL_Reg coarse_meta[] = {{"__tostring", coarse_tostring}, {NULL, NULL}};
const lbw_class lbw_coarse_class = {"coarse_grid", coarse_methods, coarse_properties, coarse_meta,
                                    NULL};

/* One level of it, to hand on. */
static const luaL_Reg none[] = {{NULL, NULL}};
const lbw_class lbw_coarsening_class = {"coarsening", none, none, none, NULL};

void lbw_open_library(lua_State *L) {
  static const luaL_Reg functions[] = {{"build", library_build},
                                       {"grow", library_grow},
                                       {"read", library_read},
                                       {"coarsen", coarse_create},
                                       {NULL, NULL}};
  lbw_class_register(L, &lbw_library_class);
  lbw_class_register(L, &lbw_coarse_class);
  lbw_class_register(L, &lbw_coarsening_class);
  lua_newtable(L);
  luaL_setfuncs(L, functions, 0);
  lua_setfield(L, -2, "metamaterial");
}
