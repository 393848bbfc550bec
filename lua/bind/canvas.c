/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* bw.canvas(width, height, options): drawings of lines, markers, text, images, as SVG or PNG. */
#include "bind.h"

#include <math.h>
#include <string.h>

static bw_canvas *self(lua_State *L) {
  return (bw_canvas *)(uintptr_t)lbw_check(L, 1, &lbw_canvas_class);
}

/* The canvas itself comes back, so that calls can be chained. */
static int leave(lua_State *L, bw_status status) {
  lua_pushvalue(L, 1);
  return lbw_leave(L, status, 1);
}

/* ---- colours, pens, points ------------------------------------------------------------------- */

/* "#rrggbb" or "#rrggbbaa" */
static bool parse_colour(const char *text, double colour[4]) {
  static const char digits[] = "0123456789abcdef";
  size_t length = strlen(text);
  if (text[0] != '#' || (length != 7 && length != 9))
    return false;
  colour[3] = 1;
  for (size_t i = 1; i < length; i += 2) {
    int value = 0;
    for (size_t k = i; k < i + 2; k++) {
      char c = text[k] >= 'A' && text[k] <= 'F' ? (char)(text[k] - 'A' + 'a') : text[k];
      const char *at = strchr(digits, c);
      if (!at)
        return false;
      value = 16 * value + (int)(at - digits);
    }
    colour[i / 2] = value / 255.0;
  }
  return true;
}

static void colour_option(lua_State *L, int index, const char *function, const char *key,
                          double colour[4]) {
  int type = lbw_option_get(L, index, key);
  if (type != LUA_TNIL && (type != LUA_TSTRING || !parse_colour(lua_tostring(L, -1), colour)))
    lbw_option_refused(L, function, key, "a colour \"#rrggbb\" or \"#rrggbbaa\"");
  lua_pop(L, 1);
}

static void dash_option(lua_State *L, int index, const char *function, double dash[4]) {
  if (lbw_option_get(L, index, "dash") != LUA_TNIL) {
    size_t count = lua_istable(L, -1) ? lua_rawlen(L, -1) : 0;
    if (count != 2 && count != 4)
      lbw_option_refused(L, function, "dash", "lengths {on, off} or {on, off, on, off}");
    for (size_t i = 0; i < count; i++) {
      if (lua_rawgeti(L, -1, (lua_Integer)i + 1) != LUA_TNUMBER)
        lbw_option_refused(L, function, "dash", "numbers");
      dash[i] = lua_tonumber(L, -1);
      lua_pop(L, 1);
    }
  }
  lua_pop(L, 1);
}

static bw_pen read_pen(lua_State *L, int index, const char *function) {
  static const lbw_option list[] = {{"fill", LBW_OTHER, 0},
                                    {"stroke", LBW_OTHER, 0},
                                    {"dash", LBW_OTHER, 0},
                                    {"width", LBW_REAL, offsetof(bw_pen, width)},
                                    {"round", LBW_BOOLEAN, offsetof(bw_pen, round)},
                                    {NULL, LBW_OTHER, 0}};
  bw_pen pen = {.width = 1};
  lbw_options(L, index, function, list, &pen);
  colour_option(L, index, function, "fill", pen.fill);
  colour_option(L, index, function, "stroke", pen.stroke);
  dash_option(L, index, function, pen.dash);
  return pen;
}

/* Rows of two numbers, or a flat list x, y, x, y, ...; what is pushed stays. */
static const double *read_points(lua_State *L, int index, const char *function, int64_t *count) {
  bool flat = false;
  if (lua_istable(L, index)) {
    flat = lua_rawgeti(L, index, 1) == LUA_TNUMBER;
    lua_pop(L, 1);
  }
  const double *point = lbw_to_doubles(L, index, function, flat ? 1 : 2, count);
  if (flat && *count % 2 != 0)
    lbw_error(L, "%s: an even number of values expected in the list x, y, x, y, ..., got %I",
              function, (LUAI_UACINT)*count);
  *count = flat ? *count / 2 : *count;
  return point;
}

/* Four arguments x, y, width, height */
static void read_box(lua_State *L, int first, double box[4]) {
  static const char *const what[4] = {"x", "y", "width", "height"};
  for (int k = 0; k < 4; k++)
    box[k] = lbw_check_real(L, first + k, what[k]);
}

/* ---- drawing --------------------------------------------------------------------------------- */

static int draw_points(lua_State *L, const char *function, bool closed) {
  bw_canvas *canvas = self(L);
  lua_settop(L, 3);
  bw_pen pen = read_pen(L, 3, function);
  int64_t count;
  const double *point = read_points(L, 2, function, &count);
  return leave(L, bw_canvas_line(lbw_enter(L), canvas, &pen, closed, count, point));
}

/* canvas:line(points, pen) */
static int canvas_line(lua_State *L) {
  return draw_points(L, "line", false);
}

/* canvas:polygon(points, pen) */
static int canvas_polygon(lua_State *L) {
  return draw_points(L, "polygon", true);
}

/* canvas:rectangle(x, y, width, height, pen, radius) */
static int canvas_rectangle(lua_State *L) {
  bw_canvas *canvas = self(L);
  double box[4];
  read_box(L, 2, box);
  bw_pen pen = read_pen(L, 6, "rectangle");
  double radius = lua_isnoneornil(L, 7) ? 0 : lbw_check_real(L, 7, "radius");
  return leave(L, bw_canvas_rectangle(lbw_enter(L), canvas, &pen, box, radius));
}

/* A list of texts or falses into a userdata that is pushed. */
static const char *const *read_notes(lua_State *L, int index, int64_t count) {
  if (lua_isnoneornil(L, index))
    return NULL;
  lbw_check_type(L, index, LUA_TTABLE);
  const char **note = (const char **)lua_newuserdatauv(L, ((size_t)count + 1) * sizeof *note, 0);
  for (int64_t i = 0; i < count; i++) {
    int type = lua_rawgeti(L, index, i + 1);
    if (type != LUA_TSTRING && lua_toboolean(L, -1))
      lbw_error(L, "markers: notes: strings expected, got %s at %I", lbw_got(L, -1),
                (LUAI_UACINT)i + 1);
    note[i] = type == LUA_TSTRING ? lua_tostring(L, -1) : NULL; /* held by the list */
    lua_pop(L, 1);
  }
  return note;
}

/* canvas:markers(kind, size, points, pen, notes) */
static int canvas_markers(lua_State *L) {
  static const char *const kinds[] = {"disc",          "square", "diamond", "triangle",
                                      "triangle_down", "cross",  "plus",    NULL};
  bw_canvas *canvas = self(L);
  bw_marker kind = (bw_marker)lbw_check_word(L, 2, kinds);
  double size = lbw_check_real(L, 3, "size");
  lua_settop(L, 6);
  bw_pen pen = read_pen(L, 5, "markers");
  int64_t count;
  const double *point = read_points(L, 4, "markers", &count);
  const char *const *note = read_notes(L, 6, count);
  return leave(L, bw_canvas_markers(lbw_enter(L), canvas, &pen, kind, size, count, point, note));
}

/* canvas:text(text, x, y, {size, align, angle, colour, bold, halo}) */
static int canvas_text(lua_State *L) {
  static const lbw_option list[] = {{"size", LBW_REAL, offsetof(bw_label, size)},
                                    {"align", LBW_REAL, offsetof(bw_label, align)},
                                    {"angle", LBW_REAL, offsetof(bw_label, angle)},
                                    {"colour", LBW_OTHER, 0},
                                    {"bold", LBW_BOOLEAN, offsetof(bw_label, bold)},
                                    {"halo", LBW_BOOLEAN, offsetof(bw_label, halo)},
                                    {NULL, LBW_OTHER, 0}};
  bw_canvas *canvas = self(L);
  const char *text = lbw_check_text(L, 2, NULL);
  bw_label label = {.size = 12, .colour = {0, 0, 0, 1}};
  label.x = lbw_check_real(L, 3, "x");
  label.y = lbw_check_real(L, 4, "y");
  lbw_options(L, 5, "text", list, &label);
  colour_option(L, 5, "text", "colour", label.colour);
  return leave(L, bw_canvas_text(lbw_enter(L), canvas, &label, text));
}

/* canvas:text_width(text, size, bold): pixels */
static int canvas_text_width(lua_State *L) {
  const bw_canvas *canvas = self(L);
  const char *text = lbw_check_text(L, 2, NULL);
  double size = lbw_check_real(L, 3, "size"), width;
  bw_status status =
      bw_canvas_text_width(lbw_enter(L), canvas, size, lua_toboolean(L, 4), text, &width);
  lua_pushnumber(L, width);
  return lbw_leave(L, status, 1);
}

/* canvas:enter(x, y, width, height, {x, y, width, height} or nil) */
static int canvas_enter(lua_State *L) {
  bw_canvas *canvas = self(L);
  double box[4], view[4];
  read_box(L, 2, box);
  bool changes = !lua_isnoneornil(L, 6);
  if (changes) {
    lbw_check_type(L, 6, LUA_TTABLE);
    for (int k = 0; k < 4; k++) {
      lua_rawgeti(L, 6, k + 1);
      view[k] = lbw_check_real(L, -1, "view");
    }
  }
  return leave(L, bw_canvas_enter(lbw_enter(L), canvas, box, changes ? view : NULL));
}

/* canvas:leave() */
static int canvas_leave(lua_State *L) {
  bw_canvas *canvas = self(L);
  return leave(L, bw_canvas_leave(lbw_enter(L), canvas));
}

/* canvas:image(path, x, y, width, height) */
static int canvas_image(lua_State *L) {
  bw_canvas *canvas = self(L);
  const char *path = lbw_check_text(L, 2, NULL);
  double box[4];
  read_box(L, 3, box);
  return leave(L, bw_canvas_image(lbw_enter(L), canvas, box, path));
}

/* canvas:pixels(bytes, columns, x, y, width, height): rows of red, green, blue from the top */
static int canvas_pixels(lua_State *L) {
  bw_canvas *canvas = self(L);
  size_t length;
  const char *bytes = lbw_check_text(L, 2, &length);
  lua_Integer columns = lbw_check_integer(L, 3);
  double box[4];
  read_box(L, 4, box);
  if (columns < 1 || columns > 20000 || length == 0 || length % (3 * (size_t)columns) != 0 ||
      length / (3 * (size_t)columns) > 20000)
    return lbw_error(
        L, "pixels: a whole number of rows expected, of %I pixels of 3 bytes, got %I bytes",
        (LUAI_UACINT)columns, (LUAI_UACINT)length);
  int rows = (int)(length / (3 * (size_t)columns));
  return leave(L, bw_canvas_pixels(lbw_enter(L), canvas, box, (int)columns, rows,
                                   (const unsigned char *)bytes));
}

/* ---- out of it ------------------------------------------------------------------------------- */

typedef struct output {
  double scale;
  bool outlines;
} output;

static const lbw_option output_list[] = {{"scale", LBW_REAL, offsetof(output, scale)},
                                         {"outlines", LBW_BOOLEAN, offsetof(output, outlines)},
                                         {NULL, LBW_OTHER, 0}};

/* canvas:write(path, {scale, outlines}) */
static int canvas_write(lua_State *L) {
  const bw_canvas *canvas = self(L);
  const char *path = lbw_check_text(L, 2, NULL);
  output out = {.scale = 2, .outlines = true};
  lbw_options(L, 3, "write", output_list, &out);
  bw_status status = bw_canvas_write(lbw_enter(L), canvas, out.scale, out.outlines, path);
  lua_pushboolean(L, 1);
  return lbw_leave(L, status, 1);
}

static int push_text(lua_State *L) {
  lua_pushlstring(L, (const char *)lua_touserdata(L, 1), (size_t)lua_tointeger(L, 2));
  return 1;
}

/* canvas:svg({outlines}) */
static int canvas_svg(lua_State *L) {
  const bw_canvas *canvas = self(L);
  output out = {.scale = 1};
  lbw_options(L, 2, "svg", output_list + 1, &out);
  char *text = NULL;
  size_t length = 0;
  bw_status status = bw_canvas_svg(lbw_enter(L), canvas, out.outlines, &text, &length);
  if (status != BW_OK)
    return lbw_leave(L, status, 0);
  /* Lua may run out of memory: the text is released first */
  lua_pushcfunction(L, push_text);
  lua_pushlightuserdata(L, text);
  lua_pushinteger(L, (lua_Integer)length);
  int pushed = lua_pcall(L, 2, 1, 0);
  bw_free(text);
  int results = lbw_leave(L, status, 1);
  return pushed == LUA_OK ? results : lua_error(L);
}

static int canvas_width(lua_State *L) {
  double size[2];
  bw_canvas_size(self(L), size);
  lua_pushnumber(L, size[0]);
  return 1;
}

static int canvas_height(lua_State *L) {
  double size[2];
  bw_canvas_size(self(L), size);
  lua_pushnumber(L, size[1]);
  return 1;
}

static const luaL_Reg methods[] = {{"line", canvas_line},
                                   {"polygon", canvas_polygon},
                                   {"rectangle", canvas_rectangle},
                                   {"markers", canvas_markers},
                                   {"text", canvas_text},
                                   {"text_width", canvas_text_width},
                                   {"enter", canvas_enter},
                                   {"leave", canvas_leave},
                                   {"image", canvas_image},
                                   {"pixels", canvas_pixels},
                                   {"write", canvas_write},
                                   {"svg", canvas_svg},
                                   {NULL, NULL}};
static const luaL_Reg properties[] = {
    {"width", canvas_width}, {"height", canvas_height}, {NULL, NULL}};
static const luaL_Reg meta[] = {{NULL, NULL}};
const lbw_class lbw_canvas_class = {"canvas", methods, properties, meta, NULL};

/* canvas(width, height, {name}) */
static int canvas_new(lua_State *L) {
  static const lbw_option list[] = {{"name", LBW_OTHER, 0}, {NULL, LBW_OTHER, 0}};
  double width = lbw_check_real(L, 1, "width"), height = lbw_check_real(L, 2, "height");
  lua_settop(L, 3);
  lbw_options(L, 3, "canvas", list, NULL);
  int type = lbw_option_get(L, 3, "name");
  if (type != LUA_TSTRING && type != LUA_TNIL)
    return lbw_option_refused(L, "canvas", "name", "a string");
  const char *name = lua_tostring(L, -1);
  lbw_box *box = lbw_box_new(L, &lbw_canvas_class);
  bw_canvas *canvas = NULL;
  bw_status status = bw_canvas_create(lbw_enter(L), width, height, name, &canvas);
  return lbw_leave_object(L, box, canvas, status);
}

void lbw_open_canvas(lua_State *L) {
  lbw_class_register(L, &lbw_canvas_class);
  lua_pushcfunction(L, canvas_new);
  lua_setfield(L, -2, "canvas");
}
