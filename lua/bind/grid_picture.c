/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* grid:picture(path, options), picture_grids(path, panels, options): grids side by side;
 * animation(path, pictures, options). */
#include "grid.h"

#include <string.h>

static const char *text_option(lua_State *L, int index, const char *function, const char *key) {
  int type = lbw_option_get(L, index, key);
  if (type != LUA_TSTRING && type != LUA_TNIL)
    lbw_option_refused(L, function, key, "a string");
  return lua_tostring(L, -1); /* stays on the stack */
}

/* {title, displacement, values, embedding} at `index` for a grid. What is pushed must stay. */
static void read_panel(lua_State *L, int index, const char *function, bw_grid_panel *panel) {
  int64_t rows;
  const bw_grid *grid = panel->grid;
  if (lbw_option_get(L, index, "embedding") != LUA_TNIL) {
    panel->embedding = (const bw_embedding *)lbw_test(L, -1, &lbw_embedding_class);
    panel->surface =
        panel->embedding ? (const bw_surface *)((lbw_box *)lua_touserdata(L, -1))->extra : NULL;
    if (!panel->surface)
      lbw_option_refused(L, function, "embedding", "an embedding of a surface, from grid:embed,");
  }
  if (lbw_option_get(L, index, "displacement") != LUA_TNIL) {
    panel->displacement = lbw_to_doubles(L, -1, "displacement", 3, &rows);
    lbw_require_rows(L, lua_pushfstring(L, "%s: displacement", function), rows, grid->node_count,
                     "node");
    lua_pop(L, 1);
  }
  if (lbw_option_get(L, index, "values") != LUA_TNIL) {
    panel->value = lbw_to_doubles(L, -1, "values", 1, &rows);
    panel->on_elements = rows == grid->element_count && rows != grid->node_count;
    if (!panel->on_elements && rows != grid->node_count)
      lbw_error(L, "%s: values: a row for each of %d nodes or %d elements expected, got %I rows",
                function, (int)grid->node_count, (int)grid->element_count, (LUAI_UACINT)rows);
  }
}

/* {"steel", "rubber"} */
static void read_names(lua_State *L, int index, const char *function,
                       bw_grid_picture_options *options) {
  if (lbw_option_get(L, index, "names") == LUA_TNIL)
    return;
  if (!lua_istable(L, -1))
    lbw_option_refused(L, function, "names", "a list of the materials' names");
  int from = lua_gettop(L);
  int count = (int)lua_rawlen(L, from);
  const char **name = (const char **)lua_newuserdatauv(L, ((size_t)count + 1) * sizeof *name, 0);
  for (int i = 0; i < count; i++) {
    if (lua_rawgeti(L, from, i + 1) != LUA_TSTRING)
      lbw_option_refused(L, function, "names", "a list of the materials' names");
    name[i] = lua_tostring(L, -1); /* held by the list */
    lua_pop(L, 1);
  }
  options->name_count = count;
  options->name = name;
}

#define SHARED                                                                                     \
  {"width", LBW_INT, offsetof(bw_grid_picture_options, width)},                                    \
      {"height", LBW_INT, offsetof(bw_grid_picture_options, height)},                              \
      {"columns", LBW_INT, offsetof(bw_grid_picture_options, columns)},                            \
      {"direction", LBW_VECTOR, offsetof(bw_grid_picture_options, direction)},                     \
      {"up", LBW_VECTOR, offsetof(bw_grid_picture_options, up)},                                   \
      {"zoom", LBW_REAL, offsetof(bw_grid_picture_options, zoom)},                                 \
      {"min", LBW_REAL, offsetof(bw_grid_picture_options, min)},                                   \
      {"max", LBW_REAL, offsetof(bw_grid_picture_options, max)},                                   \
      {"scale", LBW_REAL, offsetof(bw_grid_picture_options, scale)},                               \
      {"deformation", LBW_REAL, offsetof(bw_grid_picture_options, deformation)},                   \
      {"edges", LBW_BOOLEAN, offsetof(bw_grid_picture_options, edges)},                            \
      {"ghost", LBW_BOOLEAN, offsetof(bw_grid_picture_options, ghost)}, {"title", LBW_OTHER, 0},   \
      {"unit", LBW_OTHER, 0}, {"names", LBW_OTHER, 0}, {                                           \
    "view", LBW_OTHER, 0                                                                           \
  }

/* view = {min, max}: the box to be seen */
static void read_others(lua_State *L, int index, const char *function,
                        bw_grid_picture_options *options) {
  options->title = text_option(L, index, function, "title");
  options->unit = text_option(L, index, function, "unit");
  read_names(L, index, function, options);
  if (lbw_option_get(L, index, "view") != LUA_TNIL) {
    bool fine = lua_istable(L, -1) && lua_rawlen(L, -1) == 2;
    int view = lua_gettop(L);
    for (int i = 0; i < 2 && fine; i++) {
      lua_rawgeti(L, view, i + 1);
      fine = lbw_to_vector(L, -1, i ? options->view_max : options->view_min);
      lua_pop(L, 1);
    }
    if (!fine)
      lbw_option_refused(L, function, "view", "two corners {{x, y, z}, {x, y, z}}");
  }
}

/* grid:picture(path, {title, displacement, values, ...}) */
static int grid_picture(lua_State *L) {
  static const lbw_option list[] = {SHARED,
                                    {"displacement", LBW_OTHER, 0},
                                    {"values", LBW_OTHER, 0},
                                    {"embedding", LBW_OTHER, 0},
                                    {NULL, LBW_OTHER, 0}};
  bw_grid_panel panel = {.grid = (const bw_grid *)lbw_check(L, 1, &lbw_grid_class)};
  const char *path = lbw_check_text(L, 2, NULL);
  bw_grid_picture_options options;
  bw_grid_picture_options_default(&options);
  options.width = 1000;
  options.height = 800;
  lua_settop(L, 3);
  luaL_checkstack(L, 20, "too many values");
  lbw_options(L, 3, "picture", list, &options);
  read_others(L, 3, "picture", &options);
  read_panel(L, 3, "picture", &panel);
  lua_pushboolean(L, 1);
  return lbw_leave(L, bw_picture_grids(lbw_enter(L), 1, &panel, &options, path), 1);
}

/* picture_grids(path, {{grid, title, displacement, values}, ...}, options) */
static int picture_grids(lua_State *L) {
  enum { MAX_PANELS = 64 };
  static const lbw_option list[] = {SHARED, {NULL, LBW_OTHER, 0}};
  static const lbw_option keys[] = {{"grid", LBW_OTHER, 0},         {"title", LBW_OTHER, 0},
                                    {"displacement", LBW_OTHER, 0}, {"values", LBW_OTHER, 0},
                                    {"embedding", LBW_OTHER, 0},    {NULL, LBW_OTHER, 0}};
  const char *path = lbw_check_text(L, 1, NULL);
  lbw_check_type(L, 2, LUA_TTABLE);
  bw_grid_picture_options options;
  bw_grid_picture_options_default(&options);
  lua_settop(L, 3);
  lbw_options(L, 3, "grid.picture", list, &options);
  luaL_checkstack(L, 30 + 8 * MAX_PANELS, "too many values");
  read_others(L, 3, "grid.picture", &options);
  bw_grid_panel panel[MAX_PANELS];
  memset(panel, 0, sizeof panel);
  size_t count = lua_rawlen(L, 2);
  if (count < 1 || count > MAX_PANELS)
    return lbw_error(L, "grid.picture: a list of 1 to %d panels {grid =, title =} expected, got %I",
                     MAX_PANELS, (LUAI_UACINT)count);
  for (size_t i = 0; i < count; i++) {
    if (lua_rawgeti(L, 2, (lua_Integer)i + 1) != LUA_TTABLE)
      return lbw_error(L, "grid.picture: panel %d: {grid =, title =} expected, got %s", (int)i + 1,
                       lbw_got(L, -1));
    int index = lua_gettop(L);
    lbw_options(L, index, "grid.picture: panel", keys, NULL);
    lbw_option_get(L, index, "grid");
    panel[i].grid = (const bw_grid *)lbw_test(L, -1, &lbw_grid_class);
    if (!panel[i].grid)
      return lbw_option_refused(L, "grid.picture: panel", "grid", "a grid");
    panel[i].title = text_option(L, index, "grid.picture: panel", "title");
    read_panel(L, index, "grid.picture: panel", &panel[i]);
  }
  lua_pushboolean(L, 1);
  return lbw_leave(L, bw_picture_grids(lbw_enter(L), (int)count, panel, &options, path), 1);
}

/* animation(path, pictures, {seconds, rounds}) */
static int animation(lua_State *L) {
  struct opts {
    double seconds;
    int rounds;
  } opts = {0.05, 0};
  static const lbw_option list[] = {{"seconds", LBW_REAL, offsetof(struct opts, seconds)},
                                    {"rounds", LBW_INT, offsetof(struct opts, rounds)},
                                    {NULL, LBW_OTHER, 0}};
  const char *path = lbw_check_text(L, 1, NULL);
  lbw_check_type(L, 2, LUA_TTABLE);
  lua_settop(L, 3);
  lbw_options(L, 3, "animation", list, &opts);
  int count = (int)lua_rawlen(L, 2);
  const char **png = (const char **)lua_newuserdatauv(L, ((size_t)count + 1) * sizeof *png, 0);
  for (int i = 0; i < count; i++) {
    if (lua_rawgeti(L, 2, i + 1) != LUA_TSTRING)
      return lbw_error(L, "animation: picture %d: the path of a PNG file expected, got %s", i + 1,
                       lbw_got(L, -1));
    png[i] = lua_tostring(L, -1); /* held by the list */
    lua_pop(L, 1);
  }
  lua_pushboolean(L, 1);
  return lbw_leave(L, bw_animation_write(lbw_enter(L), count, png, opts.seconds, opts.rounds, path),
                   1);
}

/* Adds the method, and functions to the table on the top. */
void lbw_open_grid_picture(lua_State *L) {
  static const luaL_Reg methods[] = {{"picture", grid_picture}, {NULL, NULL}};
  static const luaL_Reg functions[] = {{"animation", animation}, {NULL, NULL}};
  lbw_add_methods(L, &lbw_grid_class, methods);
  luaL_setfuncs(L, functions, 0);
  lua_getfield(L, -1, "grid");
  lua_pushcfunction(L, picture_grids);
  lua_setfield(L, -2, "picture");
  lua_pop(L, 1);
}
