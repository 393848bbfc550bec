/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* Outlines: making, moving, edits, measures, views. bw.outline itself, which reads loops as lists
 * of points, is Lua (lua/barwright/outline.lua). Points, edges and loops are numbered from 1; edges
 * through all loops, and vertex n is where edge n begins. */
#include "bind.h"

#include <math.h>
#include <string.h>

static const bw_outline *self(lua_State *L) {
  return (const bw_outline *)lbw_check(L, 1, &lbw_outline_class);
}

/* ---- arguments ------------------------------------------------------------------------------- */

static int32_t check_loop(lua_State *L, int index, const bw_outline *outline) {
  if (lua_type(L, index) != LUA_TSTRING)
    return (int32_t)lbw_check_index(L, index, "loop", outline->loop_count);
  const char *wanted = lua_tostring(L, index);
  int32_t found = bw_outline_find_loop(outline, wanted);
  if (found >= 0)
    return found;
  size_t count = (size_t)outline->loop_count;
  const char **name = (const char **)lua_newuserdatauv(L, count * sizeof *name, 0);
  for (size_t l = 0; l < count; l++)
    name[l] = outline->loop[l].name.text;
  lbw_error(L, "there is no loop '%s': %s", wanted, lbw_suggestion(L, wanted, name, count));
  return -1;
}

static int32_t check_edge(lua_State *L, int index, const bw_outline *outline) {
  return (int32_t)lbw_check_index(L, index, "edge", outline->segment_count);
}

static int32_t vertex_of(const bw_outline *outline, int32_t edge) {
  return outline->segment[edge].point[0];
}

static int32_t check_vertex(lua_State *L, int index, const bw_outline *outline) {
  return vertex_of(outline, (int32_t)lbw_check_index(L, index, "vertex", outline->segment_count));
}

/* A handle {vertex = n}, {edge = n}, {edge = n, control = 1 or 2} or {loop = name}; with a loop
 * beside them, vertex and edge count from that loop's first. */
static bw_handle_kind check_handle(lua_State *L, int index, const bw_outline *outline,
                                   int32_t *number) {
  static const lbw_option list[] = {{"vertex", LBW_OTHER, 0},
                                    {"edge", LBW_OTHER, 0},
                                    {"loop", LBW_OTHER, 0},
                                    {"control", LBW_OTHER, 0},
                                    {NULL, LBW_OTHER, 0}};
  lbw_check_type(L, index, LUA_TTABLE);
  lbw_options(L, index, "handle", list, NULL);
  bool vertex = lbw_option_get(L, index, "vertex") != LUA_TNIL;
  bool edge = lbw_option_get(L, index, "edge") != LUA_TNIL;
  bool loop = lbw_option_get(L, index, "loop") != LUA_TNIL;
  if ((vertex && edge) || !(vertex || edge || loop))
    lbw_error(L, "handle: {vertex = n}, {edge = n} or {loop = name} expected, got %s",
              vertex && edge ? "a vertex and an edge" : "none of them");
  int32_t l = loop ? check_loop(L, -1, outline) : -1;
  if (!vertex && !edge) {
    *number = l;
    return BW_HANDLE_LOOP;
  }
  int32_t first = loop ? outline->loop[l].first : 0;
  int32_t count = loop ? outline->loop[l].count : outline->segment_count;
  lua_pushvalue(L, vertex ? -3 : -2);
  int32_t n = first + (int32_t)lbw_check_index(L, lua_gettop(L), vertex ? "vertex" : "edge", count);
  *number = vertex ? vertex_of(outline, n) : n;
  if (lbw_option_get(L, index, "control") != LUA_TNIL) {
    int which = 1 + (int)lbw_check_index(L, lua_gettop(L), "control", 2);
    if (vertex || outline->segment[n].point[1] < 0)
      lbw_error(L, "handle: option 'control': an edge that is a curve expected, got %s",
                vertex ? "a vertex" : "a straight edge");
    *number = outline->segment[n].point[which];
    return BW_HANDLE_POINT;
  }
  return vertex ? BW_HANDLE_VERTEX : BW_HANDLE_SEGMENT;
}

/* ---- making ---------------------------------------------------------------------------------- */

/* Rows of start, first control, second control, end, tag, from 1; controls 0 for a line. */
static bw_segment *read_segments(lua_State *L, int index, int64_t *count) {
  int64_t rows;
  double *row = lbw_to_doubles(L, index, "outline: segments", 5, &rows);
  bw_segment *segment = (bw_segment *)lua_newuserdatauv(L, ((size_t)rows + 1) * sizeof *segment, 0);
  for (int64_t i = 0; i < rows; i++) {
    int32_t value[5];
    for (int k = 0; k < 5; k++) {
      double number = row[5 * i + k];
      if (!(number >= 0 && number < INT32_MAX && number == floor(number)))
        lbw_error(L, "outline: segment %I: a whole number of at least 0 expected, got %s",
                  (LUAI_UACINT)(i + 1), lbw_quantity(number, "").text);
      value[k] = (int32_t)number - 1;
    }
    segment[i] = (bw_segment){{value[0], value[1], value[2], value[3]}, value[4]};
  }
  *count = rows;
  return segment;
}

static lua_Integer integer_field(lua_State *L, int index, const char *key) {
  lua_getfield(L, index, key);
  int ok;
  lua_Integer value = lua_tointegerx(L, -1, &ok);
  if (!ok || value < 0 || value > INT32_MAX)
    lbw_error(L, "outline: loop: %s: a whole number of at least 0 expected, got %s", key,
              lbw_got(L, -1));
  lua_pop(L, 1);
  return value;
}

/* {count = , region = (0: a hole), name = } */
static void read_loop(lua_State *L, int index, bw_loop *loop) {
  index = lua_absindex(L, index);
  lbw_check_type(L, index, LUA_TTABLE);
  memset(loop, 0, sizeof *loop);
  loop->count = (int32_t)integer_field(L, index, "count");
  loop->region = (int32_t)integer_field(L, index, "region") - 1;
  loop->parent = -1;
  if (lua_getfield(L, index, "name") != LUA_TNIL)
    lbw_read_name(L, -1, "outline: name of a loop", &loop->name);
  lua_pop(L, 1);
}

/* outline.make(points, segments, loops, tag names) */
static int outline_make(lua_State *L) {
  int64_t points, segments;
  lua_settop(L, 4);
  double *point = lbw_to_doubles(L, 1, "outline: points", 2, &points);
  bw_segment *segment = read_segments(L, 2, &segments);
  lbw_check_type(L, 3, LUA_TTABLE);
  lbw_check_type(L, 4, LUA_TTABLE);
  size_t loops = lua_rawlen(L, 3), tags = lua_rawlen(L, 4);
  if (points >= INT32_MAX || segments >= INT32_MAX || loops >= INT32_MAX || tags >= INT32_MAX)
    return lbw_error(L, "outline: too many points");
  bw_loop *loop = (bw_loop *)lua_newuserdatauv(L, (loops + 1) * sizeof *loop, 0);
  bw_name *tag = (bw_name *)lua_newuserdatauv(L, (tags + 1) * sizeof *tag, 0);
  int64_t first = 0;
  for (size_t l = 0; l < loops; l++) {
    lua_rawgeti(L, 3, (lua_Integer)l + 1);
    read_loop(L, -1, &loop[l]);
    lua_pop(L, 1);
    loop[l].first = (int32_t)first;
    first += loop[l].count;
    if (first > segments)
      return lbw_error(L, "outline: the loops name more segments than there are");
  }
  for (size_t t = 0; t < tags; t++) {
    lua_rawgeti(L, 4, (lua_Integer)t + 1);
    lbw_read_name(L, -1, "outline: tag", &tag[t]);
    lua_pop(L, 1);
  }
  lbw_box *box = lbw_box_new(L, &lbw_outline_class);
  bw_outline *out = NULL;
  bw_status status = bw_outline_create(lbw_enter(L), (int32_t)points, point, (int32_t)segments,
                                       segment, (int32_t)loops, loop, (int32_t)tags, tag, &out);
  return lbw_leave_object(L, box, out, status);
}

/* outline.read(path, {unit, tolerance}): the outline, {format, skipped} */
static int outline_read(lua_State *L) {
  static const lbw_option list[] = {
      {"unit", LBW_OTHER, 0},
      {"tolerance", LBW_REAL, offsetof(bw_outline_read_options, tolerance)},
      {NULL, LBW_OTHER, 0}};
  const char *path = lbw_check_text(L, 1, NULL);
  bw_outline_read_options options = {0, 0};
  lbw_options(L, 2, "outline.read", list, &options);
  options.unit = lbw_unit_option(L, 2, "outline.read", 0);
  lbw_box *box = lbw_box_new(L, &lbw_outline_class);
  bw_outline *out = NULL;
  bw_read_info info = {0};
  bw_status status = bw_outline_read(lbw_enter(L), path, &options, &out, &info);
  lbw_box_fill(L, box, out);
  lua_createtable(L, 0, 2);
  lua_pushstring(L, info.format);
  lua_setfield(L, -2, "format");
  lua_pushinteger(L, info.skipped);
  lua_setfield(L, -2, "skipped");
  return lbw_leave(L, status, 2);
}

/* outline:write(path): .svg or .dxf, in millimetres */
static int outline_write(lua_State *L) {
  const bw_outline *outline = self(L);
  const char *path = lbw_check_text(L, 2, NULL);
  bw_status status = bw_outline_write(lbw_enter(L), outline, path);
  lua_pushboolean(L, 1);
  return lbw_leave(L, status, 1);
}

/* outline:picture(path, {width, height, numbers}): PNG */
static int outline_picture(lua_State *L) {
  struct {
    int width, height;
    bool numbers;
  } opts = {1200, 900, false};
  static const lbw_option list[] = {{"width", LBW_INT, 0},
                                    {"height", LBW_INT, sizeof(int)},
                                    {"numbers", LBW_BOOLEAN, 2 * sizeof(int)},
                                    {NULL, LBW_OTHER, 0}};
  const bw_outline *outline = self(L);
  const char *path = lbw_check_text(L, 2, NULL);
  lbw_options(L, 3, "picture", list, &opts);
  bw_status status =
      bw_picture_outline(lbw_enter(L), outline, opts.width, opts.height, opts.numbers, path);
  lua_pushboolean(L, 1);
  return lbw_leave(L, status, 1);
}

/* ---- moving and editing: each gives a new outline -------------------------------------------- */

/* outline:with_points(points): the same segments with other points, vertices and control points */
static int outline_with_points(lua_State *L) {
  const bw_outline *outline = self(L);
  int64_t rows;
  double *point = lbw_to_doubles(L, 2, "with_points", 2, &rows);
  if (rows != outline->point_count)
    return lbw_error(L, "with_points: %d points expected, got %I", outline->point_count,
                     (LUAI_UACINT)rows);
  lbw_box *box = lbw_box_new(L, &lbw_outline_class);
  bw_outline *out = NULL;
  bw_status status = bw_outline_moved(lbw_enter(L), outline, point, &out);
  return lbw_leave_object(L, box, out, status);
}

/* outline:moved(handle, {dx, dy}) */
static int outline_moved(lua_State *L) {
  const bw_outline *outline = self(L);
  lua_settop(L, 3);
  double by[2];
  int32_t number;
  bw_handle_kind kind = check_handle(L, 2, outline, &number);
  lbw_check_pair(L, 3, "moved", by);
  size_t points = (size_t)outline->point_count;
  double *weight = (double *)lua_newuserdatauv(L, 3 * points * sizeof *weight, 0);
  double *point = weight + points;
  lbw_box *box = lbw_box_new(L, &lbw_outline_class);
  bw_outline *out = NULL;
  bw_context *context = lbw_enter(L);
  bw_status status = bw_outline_handle(context, outline, kind, number, weight);
  for (size_t i = 0; status == BW_OK && i < 2 * points; i++)
    point[i] = outline->point[i] + weight[i / 2] * by[i % 2];
  if (status == BW_OK)
    status = bw_outline_moved(context, outline, point, &out);
  return lbw_leave_object(L, box, out, status);
}

/* outline:weights(handle): how far each point goes with a handle */
static int outline_weights(lua_State *L) {
  const bw_outline *outline = self(L);
  int32_t number;
  bw_handle_kind kind = check_handle(L, 2, outline, &number);
  double *weight = (double *)lbw_push_array(L, BW_F64, outline->point_count, 1)->data;
  bw_status status = bw_outline_handle(lbw_enter(L), outline, kind, number, weight);
  return lbw_leave(L, status, 1);
}

/* outline:with_loop(points, segments, {region, name}): segments as those of make */
static int outline_with_loop(lua_State *L) {
  const bw_outline *outline = self(L);
  int64_t points, segments;
  bw_loop loop;
  lua_settop(L, 4);
  double *point = lbw_to_doubles(L, 2, "with_loop: points", 2, &points);
  bw_segment *segment = read_segments(L, 3, &segments);
  read_loop(L, 4, &loop);
  lbw_box *box = lbw_box_new(L, &lbw_outline_class);
  bw_outline *out = NULL;
  bw_status status = bw_outline_with_loop(lbw_enter(L), outline, (int32_t)points, point,
                                          (int32_t)segments, segment, &loop, &out);
  return lbw_leave_object(L, box, out, status);
}

/* outline:without(loop) */
static int outline_without(lua_State *L) {
  const bw_outline *outline = self(L);
  int32_t loop = check_loop(L, 2, outline);
  lbw_box *box = lbw_box_new(L, &lbw_outline_class);
  bw_outline *out = NULL;
  bw_status status = bw_outline_without_loop(lbw_enter(L), outline, loop, &out);
  return lbw_leave_object(L, box, out, status);
}

/* outline:smooth{loop, strength, rounds, corner}: corner in degrees */
static int outline_smooth(lua_State *L) {
  struct {
    double strength, corner;
    int rounds;
  } opts = {0.5, 30, 1};
  static const lbw_option list[] = {{"loop", LBW_OTHER, 0},
                                    {"strength", LBW_REAL, 0},
                                    {"corner", LBW_REAL, sizeof(double)},
                                    {"rounds", LBW_INT, 2 * sizeof(double)},
                                    {NULL, LBW_OTHER, 0}};
  const bw_outline *outline = self(L);
  lua_settop(L, 2);
  lbw_options(L, 2, "smooth", list, &opts);
  int32_t loop = lbw_option_get(L, 2, "loop") == LUA_TNIL ? -1 : check_loop(L, 3, outline);
  int32_t first = loop < 0 ? 0 : loop, last = loop < 0 ? outline->loop_count - 1 : loop;
  lbw_box *box = lbw_box_new(L, &lbw_outline_class);
  bw_outline *out = bw_retain(outline);
  bw_status status = BW_OK;
  bw_context *context = lbw_enter(L);
  for (int32_t l = first; status == BW_OK && l <= last; l++) {
    bw_outline *next = NULL;
    status = bw_outline_smoothed(context, out, l, opts.strength, opts.rounds,
                                 opts.corner * (acos(-1) / 180), &next);
    bw_release(out);
    out = next;
  }
  return lbw_leave_object(L, box, out, status);
}

/* outline:pull(vertex, {x, y}, {pins = {vertices}, reach = }) */
static int outline_pull(lua_State *L) {
  double reach = 0;
  static const lbw_option list[] = {
      {"pins", LBW_OTHER, 0}, {"reach", LBW_REAL, 0}, {NULL, LBW_OTHER, 0}};
  const bw_outline *outline = self(L);
  lua_settop(L, 4);
  int32_t vertex = check_vertex(L, 2, outline);
  double to[2];
  lbw_check_pair(L, 3, "pull", to);
  lbw_options(L, 4, "pull", list, &reach);
  int64_t pins = 0;
  int32_t *pin = NULL;
  if (lbw_option_get(L, 4, "pins") != LUA_TNIL)
    pin = lbw_to_indices(L, -1, "pull: pins", 1, &pins);
  for (int64_t i = 0; i < pins; i++) {
    if (pin[i] < 0 || pin[i] >= outline->segment_count)
      return lbw_error(L, "pull: pins: vertices from 1 to %d expected, got %d",
                       outline->segment_count, (int)pin[i] + 1);
    pin[i] = vertex_of(outline, pin[i]);
  }
  lbw_box *box = lbw_box_new(L, &lbw_outline_class);
  bw_outline *out = NULL;
  bw_status status =
      bw_outline_pulled(lbw_enter(L), outline, vertex, to, (int32_t)pins, pin, reach, &out);
  return lbw_leave_object(L, box, out, status);
}

/* outline:split(edge, t) */
static int outline_split(lua_State *L) {
  const bw_outline *outline = self(L);
  int32_t edge = check_edge(L, 2, outline);
  double t = lua_isnoneornil(L, 3) ? 0.5 : lbw_check_real(L, 3, "t");
  lbw_box *box = lbw_box_new(L, &lbw_outline_class);
  bw_outline *out = NULL;
  bw_status status = bw_outline_split(lbw_enter(L), outline, edge, t, &out);
  return lbw_leave_object(L, box, out, status);
}

/* outline:join(vertex) */
static int outline_join(lua_State *L) {
  const bw_outline *outline = self(L);
  int32_t vertex = check_vertex(L, 2, outline);
  lbw_box *box = lbw_box_new(L, &lbw_outline_class);
  bw_outline *out = NULL;
  bw_status status = bw_outline_joined(lbw_enter(L), outline, vertex, &out);
  return lbw_leave_object(L, box, out, status);
}

/* outline:with_tag(name, edges) */
static int outline_with_tag(lua_State *L) {
  const bw_outline *outline = self(L);
  const char *name = lbw_check_text(L, 2, NULL);
  int64_t count;
  int32_t *edge = lbw_to_indices(L, 3, "with_tag: edges", 1, &count);
  lbw_box *box = lbw_box_new(L, &lbw_outline_class);
  bw_outline *out = NULL;
  bw_status status = bw_outline_tagged(lbw_enter(L), outline, (int32_t)count, edge, name, &out);
  return lbw_leave_object(L, box, out, status);
}

/* ---- measures and places --------------------------------------------------------------------- */

static void push_pair(lua_State *L, const double pair[2]) {
  lua_createtable(L, 2, 0);
  for (int i = 0; i < 2; i++) {
    lua_pushnumber(L, pair[i]);
    lua_rawseti(L, -2, i + 1);
  }
}

static void measure(lua_State *L, int32_t region, bw_outline_measures *measures) {
  const bw_outline *outline = self(L);
  lbw_leave_or_raise(L, bw_outline_measure(lbw_enter(L), outline, region, measures));
}

static void push_min_max(lua_State *L, const double min[2], const double max[2]) {
  lua_createtable(L, 0, 2);
  push_pair(L, min);
  lua_setfield(L, -2, "min");
  push_pair(L, max);
  lua_setfield(L, -2, "max");
}

static void push_second_moment(lua_State *L, const double moment[3]) {
  static const char *const key[3] = {"xx", "yy", "xy"};
  lua_createtable(L, 0, 3);
  for (int i = 0; i < 3; i++) {
    lua_pushnumber(L, moment[i]);
    lua_setfield(L, -2, key[i]);
  }
}

/* outline:measure(region): {area, perimeter, centroid, second_moment, box} */
static int outline_measure(lua_State *L) {
  bw_outline_measures m;
  const bw_outline *outline = self(L);
  bool all = lua_isnoneornil(L, 2);
  measure(L, all ? -1 : (int32_t)lbw_check_index(L, 2, "region", outline->region_count), &m);
  lua_createtable(L, 0, 5);
  lua_pushnumber(L, m.area);
  lua_setfield(L, -2, "area");
  lua_pushnumber(L, m.perimeter);
  lua_setfield(L, -2, "perimeter");
  push_pair(L, m.centroid);
  lua_setfield(L, -2, "centroid");
  push_second_moment(L, m.second_moment);
  lua_setfield(L, -2, "second_moment");
  push_min_max(L, m.min, m.max);
  lua_setfield(L, -2, "box");
  return 1;
}

static int outline_area(lua_State *L) {
  bw_outline_measures m;
  measure(L, -1, &m);
  lua_pushnumber(L, m.area);
  return 1;
}

static int outline_perimeter(lua_State *L) {
  bw_outline_measures m;
  measure(L, -1, &m);
  lua_pushnumber(L, m.perimeter);
  return 1;
}

static int outline_centroid(lua_State *L) {
  bw_outline_measures m;
  measure(L, -1, &m);
  push_pair(L, m.centroid);
  return 1;
}

static int outline_second_moment(lua_State *L) {
  bw_outline_measures m;
  measure(L, -1, &m);
  push_second_moment(L, m.second_moment);
  return 1;
}

static int outline_box(lua_State *L) {
  bw_outline_measures m;
  measure(L, -1, &m);
  push_min_max(L, m.min, m.max);
  return 1;
}

/* The gradient of the area by the points */
static int outline_area_gradient(lua_State *L) {
  const bw_outline *outline = self(L);
  double *out = (double *)lbw_push_array(L, BW_F64, outline->point_count, 2)->data;
  lbw_leave_or_raise(L, bw_outline_area_gradient(lbw_enter(L), outline, out));
  return 1;
}

/* outline:at(edge, t): {x, y}, {dx, dy} */
static int outline_at(lua_State *L) {
  const bw_outline *outline = self(L);
  int32_t edge = check_edge(L, 2, outline);
  double t = lbw_check_real(L, 3, "t"), at[2], derivative[2];
  bw_outline_evaluate(outline, edge, t, at, derivative, NULL);
  push_pair(L, at);
  push_pair(L, derivative);
  return 2;
}

/* outline:nearest({x, y}): {edge, t, distance, at, vertex}: the vertex is the nearer end */
static int outline_nearest(lua_State *L) {
  const bw_outline *outline = self(L);
  double at[2], place[2];
  lbw_check_pair(L, 2, "nearest", at);
  bw_outline_place found = bw_outline_nearest(outline, at);
  bw_outline_evaluate(outline, found.segment, found.t, place, NULL, NULL);
  const bw_loop *loop = &outline->loop[bw_segment_loop(outline, found.segment)];
  int32_t next = found.segment + 1 < loop->first + loop->count ? found.segment + 1 : loop->first;
  int32_t nearer = found.segment;
  double min = HUGE_VAL;
  for (int i = 0; i < 2; i++) {
    int32_t s = i == 0 ? found.segment : next;
    const double *p = outline->point + 2 * (int64_t)vertex_of(outline, s);
    double distance = hypot(p[0] - at[0], p[1] - at[1]);
    if (distance < min) {
      min = distance;
      nearer = s;
    }
  }
  lua_createtable(L, 0, 6);
  lua_pushinteger(L, (lua_Integer)found.segment + 1);
  lua_setfield(L, -2, "edge");
  lua_pushinteger(L, (lua_Integer)nearer + 1);
  lua_setfield(L, -2, "vertex");
  lua_pushstring(L, loop->name.text);
  lua_setfield(L, -2, "loop");
  lua_pushnumber(L, found.t);
  lua_setfield(L, -2, "t");
  lua_pushnumber(L, found.distance);
  lua_setfield(L, -2, "distance");
  push_pair(L, place);
  lua_setfield(L, -2, "at");
  return 1;
}

/* outline:polygons(tolerance): {array of points, ...}, one for every loop */
static int outline_polygons(lua_State *L) {
  const bw_outline *outline = self(L);
  double tolerance = lua_isnoneornil(L, 2) ? 0 : lbw_check_real(L, 2, "tolerance");
  if (lua_isnoneornil(L, 2)) {
    bw_outline_measures m;
    measure(L, -1, &m);
    tolerance = 1e-4 * hypot(m.max[0] - m.min[0], m.max[1] - m.min[1]);
  }
  size_t loops = (size_t)outline->loop_count;
  lua_createtable(L, outline->loop_count, 0);
  lbw_box **box = (lbw_box **)lua_newuserdatauv(L, loops * sizeof *box, 0);
  for (size_t l = 0; l < loops; l++) {
    box[l] = lbw_box_new(L, &lbw_array_class);
    lua_rawseti(L, -3, (lua_Integer)l + 1);
  }
  bw_polygons polygons = {0};
  bw_context *context = lbw_enter(L);
  bw_status status = bw_outline_flatten(context, outline, tolerance, &polygons);
  for (size_t l = 0; l < loops && status == BW_OK; l++) {
    int32_t first = polygons.start[l], count = polygons.start[l + 1] - first;
    bw_array *array = NULL;
    status = bw_array_create(context, BW_F64, count, 2, &array);
    if (status == BW_OK)
      memcpy(array->data, polygons.point + 2 * (int64_t)first,
             2 * (size_t)count * sizeof *polygons.point);
    box[l]->object = array;
  }
  bw_polygons_clear(&polygons);
  lua_pop(L, 1); /* the list of boxes, which are in the table */
  return lbw_leave(L, status, 1);
}

/* ---- views ----------------------------------------------------------------------------------- */

static int outline_points(lua_State *L) {
  const bw_outline *outline = self(L);
  return lbw_push_borrowed(L, BW_F64, outline->point_count, 2, outline->point, outline);
}

static int outline_vertices(lua_State *L) {
  const bw_outline *outline = self(L);
  double *out = (double *)lbw_push_array(L, BW_F64, outline->segment_count, 2)->data;
  for (int32_t s = 0; s < outline->segment_count; s++)
    memcpy(out + 2 * (int64_t)s, outline->point + 2 * (int64_t)vertex_of(outline, s),
           2 * sizeof *out);
  return 1;
}

static int outline_segments(lua_State *L) {
  const bw_outline *outline = self(L);
  int32_t *out = (int32_t *)lbw_push_array(L, BW_I32, outline->segment_count, 5)->data;
  for (int32_t s = 0; s < outline->segment_count; s++) {
    for (int k = 0; k < 4; k++)
      out[5 * (int64_t)s + k] = outline->segment[s].point[k] + 1;
    out[5 * (int64_t)s + 4] = outline->segment[s].tag + 1;
  }
  return 1;
}

/* {{name, region (0: a hole), first, count, parent (name)}, ...} */
static int outline_loops(lua_State *L) {
  const bw_outline *outline = self(L);
  lua_createtable(L, outline->loop_count, 0);
  for (int32_t l = 0; l < outline->loop_count; l++) {
    const bw_loop *loop = &outline->loop[l];
    lua_createtable(L, 0, 6);
    lua_pushstring(L, loop->name.text);
    lua_setfield(L, -2, "name");
    lua_pushboolean(L, loop->region < 0);
    lua_setfield(L, -2, "hole");
    if (loop->region >= 0) {
      lua_pushinteger(L, (lua_Integer)loop->region + 1);
      lua_setfield(L, -2, "region");
    }
    lua_pushinteger(L, (lua_Integer)loop->first + 1);
    lua_setfield(L, -2, "first");
    lua_pushinteger(L, loop->count);
    lua_setfield(L, -2, "count");
    if (loop->parent >= 0) {
      lua_pushstring(L, outline->loop[loop->parent].name.text);
      lua_setfield(L, -2, "parent");
    }
    lua_rawseti(L, -2, l + 1);
  }
  return 1;
}

static int outline_tags(lua_State *L) {
  const bw_outline *outline = self(L);
  lua_createtable(L, outline->tag_count, 0);
  for (int32_t t = 0; t < outline->tag_count; t++) {
    lua_pushstring(L, outline->tag[t].text);
    lua_rawseti(L, -2, t + 1);
  }
  return 1;
}

/* outline:edge(n): {tag, loop, from, to, control = {c1, c2}, length, box} */
static int outline_edge(lua_State *L) {
  const bw_outline *outline = self(L);
  int32_t edge = check_edge(L, 2, outline);
  const bw_segment *segment = &outline->segment[edge];
  double min[2], max[2];
  lua_createtable(L, 0, 7);
  lua_pushstring(L, outline->tag[segment->tag].text);
  lua_setfield(L, -2, "tag");
  lua_pushstring(L, outline->loop[bw_segment_loop(outline, edge)].name.text);
  lua_setfield(L, -2, "loop");
  push_pair(L, outline->point + 2 * (int64_t)segment->point[0]);
  lua_setfield(L, -2, "from");
  push_pair(L, outline->point + 2 * (int64_t)segment->point[3]);
  lua_setfield(L, -2, "to");
  if (segment->point[1] >= 0) {
    lua_createtable(L, 2, 0);
    for (int k = 1; k < 3; k++) {
      push_pair(L, outline->point + 2 * (int64_t)segment->point[k]);
      lua_rawseti(L, -2, k);
    }
    lua_setfield(L, -2, "control");
  }
  lua_pushnumber(L, bw_segment_length(outline, edge));
  lua_setfield(L, -2, "length");
  bw_segment_box(outline, edge, min, max);
  push_min_max(L, min, max);
  lua_setfield(L, -2, "box");
  return 1;
}

/* outline:edge_distance(edge, {x, y}) */
static int outline_edge_distance(lua_State *L) {
  const bw_outline *outline = self(L);
  int32_t edge = check_edge(L, 2, outline);
  double at[2];
  lbw_check_pair(L, 3, "edge_distance", at);
  lua_pushnumber(L, bw_segment_nearest(outline, edge, at).distance);
  return 1;
}

LBW_PUSH(outline_edge_count, lua_pushinteger(L, self(L)->segment_count))
LBW_PUSH(outline_region_count, lua_pushinteger(L, self(L)->region_count))

/* outline:same_topology(other) */
static int outline_same_topology(lua_State *L) {
  const bw_outline *other = (const bw_outline *)lbw_check(L, 2, &lbw_outline_class);
  lua_pushboolean(L, bw_outline_same_topology(self(L), other));
  return 1;
}

static const luaL_Reg methods[] = {{"write", outline_write},
                                   {"picture", outline_picture},
                                   {"with_points", outline_with_points},
                                   {"moved", outline_moved},
                                   {"weights", outline_weights},
                                   {"with_loop", outline_with_loop},
                                   {"without", outline_without},
                                   {"smooth", outline_smooth},
                                   {"pull", outline_pull},
                                   {"split", outline_split},
                                   {"join", outline_join},
                                   {"with_tag", outline_with_tag},
                                   {"measure", outline_measure},
                                   {"at", outline_at},
                                   {"nearest", outline_nearest},
                                   {"polygons", outline_polygons},
                                   {"edge", outline_edge},
                                   {"edge_distance", outline_edge_distance},
                                   {"same_topology", outline_same_topology},
                                   {NULL, NULL}};
static const luaL_Reg properties[] = {{"area", outline_area},
                                      {"perimeter", outline_perimeter},
                                      {"centroid", outline_centroid},
                                      {"second_moment", outline_second_moment},
                                      {"box", outline_box},
                                      {"area_gradient", outline_area_gradient},
                                      {"points", outline_points},
                                      {"vertices", outline_vertices},
                                      {"segments", outline_segments},
                                      {"loops", outline_loops},
                                      {"tags", outline_tags},
                                      {"edge_count", outline_edge_count},
                                      {"region_count", outline_region_count},
                                      {NULL, NULL}};
static const luaL_Reg meta[] = {{NULL, NULL}};
const lbw_class lbw_outline_class = {"outline", methods, properties, meta, NULL};

void lbw_open_outline(lua_State *L) {
  static const luaL_Reg functions[] = {
      {"make", outline_make}, {"read", outline_read}, {NULL, NULL}};
  lbw_class_register(L, &lbw_outline_class);
  lua_newtable(L);
  luaL_setfuncs(L, functions, 0);
  lua_setfield(L, -2, "outline");
}
