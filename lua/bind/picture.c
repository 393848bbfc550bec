/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* picture(surface, path, options): a shaded picture of a surface with values, as PNG. */
#include "bind.h"

#include <string.h>

typedef struct opts {
  bw_picture_options options;
} opts;

static const lbw_option list[] = {{"width", LBW_INT, offsetof(opts, options.width)},
                                  {"height", LBW_INT, offsetof(opts, options.height)},
                                  {"direction", LBW_VECTOR, offsetof(opts, options.direction)},
                                  {"up", LBW_VECTOR, offsetof(opts, options.up)},
                                  {"zoom", LBW_REAL, offsetof(opts, options.zoom)},
                                  {"scale", LBW_REAL, offsetof(opts, options.scale)},
                                  {"min", LBW_REAL, offsetof(opts, options.min)},
                                  {"max", LBW_REAL, offsetof(opts, options.max)},
                                  {"edges", LBW_BOOLEAN, offsetof(opts, options.edges)},
                                  {"deformation", LBW_REAL, offsetof(opts, options.deformation)},
                                  {"ghost", LBW_BOOLEAN, offsetof(opts, options.ghost)},
                                  {"title", LBW_OTHER, 0},
                                  {"unit", LBW_OTHER, 0},
                                  {"values", LBW_OTHER, 0},
                                  {"displacement", LBW_OTHER, 0},
                                  {"arrows", LBW_OTHER, 0},
                                  {"lines", LBW_OTHER, 0},
                                  {"line_name", LBW_OTHER, 0},
                                  {"labels", LBW_OTHER, 0},
                                  {NULL, LBW_OTHER, 0}};

static const char *text_option(lua_State *L, const char *key) {
  int type = lbw_option_get(L, 3, key);
  if (type != LUA_TSTRING && type != LUA_TNIL)
    lbw_option_refused(L, "picture", key, "a string");
  return lua_tostring(L, -1); /* stays on the stack */
}

static bw_arrow *read_arrows(lua_State *L, int *count) {
  static const lbw_option keys[] = {{"at", LBW_VECTOR, offsetof(bw_arrow, at)},
                                    {"force", LBW_VECTOR, offsetof(bw_arrow, force)},
                                    {"area", LBW_REAL, offsetof(bw_arrow, area)},
                                    {NULL, LBW_OTHER, 0}};
  if (!lua_istable(L, -1))
    lbw_option_refused(L, "picture", "arrows", "a list of {at =, force =}");
  size_t length = lua_rawlen(L, -1);
  *count = length < 10000 ? (int)length : 10000;
  int from = lua_gettop(L);
  bw_arrow *arrow = (bw_arrow *)lua_newuserdatauv(L, ((size_t)*count + 1) * sizeof *arrow, 0);
  for (int i = 0; i < *count; i++) {
    memset(&arrow[i], 0, sizeof arrow[i]);
    lua_rawgeti(L, from, i + 1);
    lbw_options(L, -1, "picture: arrows", keys, &arrow[i]);
    lua_pop(L, 1);
  }
  return arrow;
}

/* A list of lists of points, on top of the stack; what is read stays there. */
static bw_picture_line *read_lines(lua_State *L, int *count) {
  if (!lua_istable(L, -1))
    lbw_option_refused(L, "picture", "lines", "a list of lists of points");
  size_t length = lua_rawlen(L, -1);
  if (length > 100000)
    lbw_error(L, "picture: option 'lines': at most 100000 lines expected, got %I",
              (LUAI_UACINT)length);
  *count = (int)length;
  int from = lua_gettop(L);
  bw_picture_line *line =
      (bw_picture_line *)lua_newuserdatauv(L, ((size_t)*count + 1) * sizeof *line, 0);
  lua_createtable(L, *count, 0); /* keeps their points */
  for (int i = 0; i < *count; i++) {
    int64_t rows;
    lua_rawgeti(L, from, i + 1);
    line[i].point = lbw_to_doubles(L, -1, "picture: lines", 3, &rows);
    line[i].count = (int)rows;
    lua_rawseti(L, -3, i + 1);
    lua_pop(L, 1);
  }
  return line;
}

/* A list of {at =, text =} on top of the stack. */
static bw_picture_label *read_labels(lua_State *L, int *count) {
  static const lbw_option keys[] = {{"at", LBW_VECTOR, offsetof(bw_picture_label, at)},
                                    {"text", LBW_OTHER, 0},
                                    {NULL, LBW_OTHER, 0}};
  size_t length = lua_istable(L, -1) ? lua_rawlen(L, -1) : SIZE_MAX;
  if (length > 10000)
    lbw_option_refused(L, "picture", "labels", "a list of at most 10000 {at =, text =}");
  *count = (int)length;
  int from = lua_gettop(L);
  bw_picture_label *label =
      (bw_picture_label *)lua_newuserdatauv(L, (length + 1) * sizeof *label, 0);
  lua_createtable(L, *count, 0); /* keeps their texts */
  for (int i = 0; i < *count; i++) {
    lua_rawgeti(L, from, i + 1);
    lbw_options(L, -1, "picture: labels", keys, &label[i]);
    if (lbw_option_get(L, -1, "text") != LUA_TSTRING)
      lbw_error(L, "picture: option 'labels': label %d: a string 'text' expected, got %s", i + 1,
                lbw_got(L, -1));
    label[i].text = lua_tostring(L, -1);
    lua_rawseti(L, -3, i + 1);
    lua_pop(L, 1);
  }
  return label;
}

/* What is drawn: options at 3 of a surface at 1; its strings and arrays stay on the stack. */
typedef struct drawn {
  const bw_surface *surface;
  const double *value;
  bool on_facets;
  opts opts;
} drawn;

static void read_drawn(lua_State *L, drawn *d) {
  const bw_surface *surface = (const bw_surface *)lbw_check(L, 1, &lbw_surface_class);
  memset(d, 0, sizeof *d);
  d->surface = surface;
  bw_picture_options *options = &d->opts.options;
  bw_picture_options_default(options);
  lua_settop(L, 3);
  lbw_options(L, 3, "picture", list, &d->opts);
  luaL_checkstack(L, 20, "too many values");
  if (text_option(L, "title"))
    options->title = lua_tostring(L, -1);
  if (text_option(L, "unit"))
    options->unit = lua_tostring(L, -1);
  int64_t rows;
  if (lbw_option_get(L, 3, "values") != LUA_TNIL) {
    d->value = lbw_to_doubles(L, -1, "picture: values", 1, &rows);
    d->on_facets = rows == surface->triangle_count && rows != surface->point_count;
    if (!d->on_facets && rows != surface->point_count)
      lbw_error(L,
                "picture: values: a row for each of %d points or %d facets expected, got %I rows",
                (int)surface->point_count, (int)surface->triangle_count, (LUAI_UACINT)rows);
  }
  if (lbw_option_get(L, 3, "displacement") != LUA_TNIL) {
    options->displacement = lbw_to_doubles(L, -1, "picture: displacement", 3, &rows);
    lbw_require_rows(L, "picture: displacement", rows, surface->point_count, "point");
  }
  if (lbw_option_get(L, 3, "arrows") != LUA_TNIL)
    options->arrow = read_arrows(L, &options->arrow_count);
  if (lbw_option_get(L, 3, "lines") != LUA_TNIL)
    options->line = read_lines(L, &options->line_count);
  if (text_option(L, "line_name"))
    options->line_name = lua_tostring(L, -1);
  if (lbw_option_get(L, 3, "labels") != LUA_TNIL)
    options->label = read_labels(L, &options->label_count);
}

static int picture(lua_State *L) {
  const char *path = lbw_check_text(L, 2, NULL);
  drawn d;
  read_drawn(L, &d);
  lua_pushboolean(L, 1);
  bw_status status =
      bw_picture_surface(lbw_enter(L), d.surface, d.value, d.on_facets, &d.opts.options, path);
  return lbw_leave(L, status, 1);
}

/* picture_direction(surface, nil, options): {x, y, z}, from the body to the viewer of the picture
 */
static int picture_direction(lua_State *L) {
  drawn d;
  double direction[3] = {0, 0, 0};
  read_drawn(L, &d);
  bw_status status = bw_picture_direction(lbw_enter(L), d.surface, d.value, d.on_facets,
                                          &d.opts.options, direction);
  lua_createtable(L, 3, 0);
  for (int k = 0; k < 3; k++) {
    lua_pushnumber(L, direction[k]);
    lua_rawseti(L, -2, k + 1);
  }
  return lbw_leave(L, status, 1);
}

/* colour(t): red, green, blue from 0 to 255 */
static int colour(lua_State *L) {
  unsigned char rgb[3];
  bw_colour(lbw_check_real(L, 1, "t"), rgb);
  for (int i = 0; i < 3; i++)
    lua_pushinteger(L, rgb[i]);
  return 3;
}

void lbw_open_picture(lua_State *L) {
  static const luaL_Reg functions[] = {{"picture", picture},
                                       {"picture_direction", picture_direction},
                                       {"colour", colour},
                                       {NULL, NULL}};
  luaL_setfuncs(L, functions, 0);
}
