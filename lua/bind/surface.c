/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* bw.surface: reading, making, checking and changing triangle surfaces. */
#include "bind.h"

#include <math.h>
#include <stddef.h>
#include <stdio.h>
#include <string.h>
#include <strings.h>

#include "barwright/boolean.h"
#include "barwright/sample.h"
#include "barwright/surface_file.h"

static const bw_surface *self(lua_State *L) {
  return (const bw_surface *)lbw_check(L, 1, &lbw_surface_class);
}

/* ---- files ----------------------------------------------------------------------------------- */

static void push_read_info(lua_State *L, const bw_read_info *info, double unit) {
  lua_createtable(L, 0, 5);
  lua_pushstring(L, info->format);
  lua_setfield(L, -2, "format");
  lua_pushinteger(L, info->polygons);
  lua_setfield(L, -2, "polygons");
  lua_pushinteger(L, info->skipped);
  lua_setfield(L, -2, "skipped");
  lua_pushinteger(L, info->group_count);
  lua_setfield(L, -2, "groups");
  lua_pushnumber(L, unit);
  lua_setfield(L, -2, "metres_per_unit");
  if (info->group_name) {
    lua_createtable(L, info->group_count, 0);
    for (int i = 0; i < info->group_count; i++) {
      lua_pushstring(L, info->group_name[i].text);
      lua_rawseti(L, -2, i + 1);
    }
    lua_setfield(L, -2, "group_names");
  }
}

/* Whether the failure names a file that OpenCASCADE reads. */
static bool is_cad(const bw_context *context) {
  const char *key, *text;
  double number;
  for (int i = 0; bw_detail(context, i, &key, &number, &text); i++)
    if (strcmp(key, "cad") == 0)
      return true;
  return false;
}

/* surface.read(path, {unit, tolerance, angle}) */
static int surface_read(lua_State *L) {
  static const lbw_option options[] = {{"unit", LBW_OTHER, 0},
                                       {"tolerance", LBW_REAL, offsetof(bw_cad_options, tolerance)},
                                       {"angle", LBW_REAL, offsetof(bw_cad_options, angle)},
                                       {NULL, LBW_OTHER, 0}};
  const char *path = lbw_check_text(L, 1, NULL);
  bw_cad_options cad = {0};
  lbw_options(L, 2, "surface.read", options, &cad);
  double unit = cad.unit = lbw_unit_option(L, 2, "surface.read", 0); /* 0: none is given */
  lbw_box *box = lbw_box_new(L, &lbw_surface_class);
  bw_surface *read = NULL, *scaled = NULL;
  bw_read_info info = {0};
  bw_status status;
  bw_context *context = lbw_enter(L);
  BW_TRY(bw_surface_read(context, path, &read, &info));
  if (unit == 0)
    unit = info.unit > 0 ? info.unit : lbw_unit_of_path(path);
  status = bw_surface_scale(context, read, unit, &scaled);
done:
  bw_release(read);
  if (status == BW_FORMAT && is_cad(context)) {
    lbw_leave(L, BW_OK, 0);
    return lbw_cad_read(L, path, &cad);
  }
  lbw_box_fill(L, box, scaled);
  push_read_info(L, &info, unit);
  bw_free(info.group_name);
  return lbw_leave(L, status, 2);
}

/* Whether a path ends so, in any case of letters. */
static bool has_ending(const char *path, const char *ending) {
  size_t length = strlen(path), own = strlen(ending);
  return length > own && strcasecmp(path + length - own, ending) == 0;
}

typedef struct written {
  bool ascii, flat;
  double min, max; /* of the colours; NAN: those of the values */
} written;

/* The colours of option 'values', on the stack, as pictures have them; NULL: none. */
static unsigned char *read_colours(lua_State *L, const bw_surface *surface, const written *w,
                                   bool *on_facets) {
  int64_t rows;
  if (lbw_option_get(L, 3, "values") == LUA_TNIL)
    return NULL;
  const double *value = lbw_to_doubles(L, -1, "write: values", 1, &rows);
  *on_facets = rows == surface->triangle_count && rows != surface->point_count;
  if (!*on_facets && rows != surface->point_count)
    lbw_error(L, "write: values: a row for each of %d points or %d facets expected, got %I rows",
              (int)surface->point_count, (int)surface->triangle_count, (LUAI_UACINT)rows);
  double least = HUGE_VAL, greatest = -HUGE_VAL;
  for (int64_t i = 0; i < rows; i++)
    if (isfinite(value[i])) {
      least = value[i] < least ? value[i] : least;
      greatest = value[i] > greatest ? value[i] : greatest;
    }
  const double min = isnan(w->min) ? least : w->min, max = isnan(w->max) ? greatest : w->max;
  unsigned char *colour = (unsigned char *)lua_newuserdatauv(L, 3 * (size_t)rows + 1, 0);
  for (int64_t i = 0; i < rows; i++)
    bw_colour(isfinite(value[i]) ? (max > min ? (value[i] - min) / (max - min) : 0) : (double)NAN,
              colour + 3 * i);
  return colour;
}

/* surface:write(path, {unit, ascii, fields, values, min, max, flat}) */
static int surface_write(lua_State *L) {
  static const lbw_option list[] = {{"unit", LBW_OTHER, 0},
                                    {"fields", LBW_OTHER, 0},
                                    {"values", LBW_OTHER, 0},
                                    {"ascii", LBW_BOOLEAN, offsetof(written, ascii)},
                                    {"min", LBW_REAL, offsetof(written, min)},
                                    {"max", LBW_REAL, offsetof(written, max)},
                                    {"flat", LBW_BOOLEAN, offsetof(written, flat)},
                                    {NULL, LBW_OTHER, 0}};
  const bw_surface *surface = self(L);
  const char *path = lbw_check_text(L, 2, NULL);
  written w = {.min = NAN, .max = NAN};
  lua_settop(L, 3);
  lbw_options(L, 3, "write", list, &w);
  double unit = lbw_unit_option(L, 3, "write", lbw_unit_of_path(path));
  if (has_ending(path, ".glb") && unit != 1)
    return lbw_error(L, "write: option 'unit': glTF files are in metres: leave it out");
  bw_surface_write_options options = {.ascii = w.ascii, .unit = unit, .flat = w.flat};
  options.colour = read_colours(L, surface, &w, &options.colour_on_facets);
  lbw_option_get(L, 3, "fields");
  options.fields = lbw_fields(L, -1, "write", surface->point_count, surface->triangle_count,
                              &options.field_count);
  bw_surface *scaled = NULL;
  bw_status status;
  bw_context *context = lbw_enter(L);
  BW_TRY(bw_surface_scale(context, surface, 1 / unit, &scaled));
  status = bw_surface_write_with(context, scaled, path, &options);
done:
  bw_release(scaled);
  lua_pushboolean(L, 1);
  return lbw_leave(L, status, 1);
}

/* ---- making ---------------------------------------------------------------------------------- */

/* Which names are among those of the option `curved_faces`, in a userdata that is pushed; or NULL.
 */
static uint8_t *read_curved(lua_State *L, const bw_name *name, int32_t names) {
  if (lbw_option_get(L, 1, "curved_faces") == LUA_TNIL)
    return NULL;
  int32_t count;
  const bw_name *given = lbw_to_names(L, -1, "surface.new: curved_faces", &count);
  uint8_t *curved = (uint8_t *)lua_newuserdatauv(L, (size_t)names + 1, 0);
  memset(curved, 0, (size_t)names + 1);
  for (int32_t k = 0; k < count; k++) {
    bool some = false;
    for (int32_t i = 0; i < names; i++)
      if (strcmp(name[i].text, given[k].text) == 0) {
        curved[i] = 1;
        some = true;
      }
    if (!some)
      lbw_error(L, "surface.new: option 'curved_faces': '%s' is not among 'face_names'",
                given[k].text);
  }
  return curved;
}

/* surface.new{points, triangles, groups, face_names, curved_faces}: metres, numbers from 1 */
static int surface_new(lua_State *L) {
  static const lbw_option options[] = {{"points", LBW_OTHER, 0},       {"triangles", LBW_OTHER, 0},
                                       {"groups", LBW_OTHER, 0},       {"face_names", LBW_OTHER, 0},
                                       {"curved_faces", LBW_OTHER, 0}, {NULL, LBW_OTHER, 0}};
  lbw_check_type(L, 1, LUA_TTABLE);
  lua_settop(L, 1);
  lbw_options(L, 1, "surface.new", options, NULL);
  int64_t points, triangles, groups = 0;
  lbw_option_get(L, 1, "points");
  double *point = lbw_to_doubles(L, -1, "surface.new: points", 3, &points);
  lbw_option_get(L, 1, "triangles");
  int32_t *triangle = lbw_to_indices(L, -1, "surface.new: triangles", 3, &triangles);
  int32_t *group = NULL;
  if (lbw_option_get(L, 1, "groups") != LUA_TNIL) {
    group = lbw_to_indices(L, -1, "surface.new: groups", 1, &groups);
    lbw_require_rows(L, "surface.new: groups", groups, triangles, "triangle");
  }
  bw_name *name = NULL;
  int32_t names = 0;
  if (lbw_option_get(L, 1, "face_names") != LUA_TNIL) {
    if (!group)
      lbw_error(L, "surface.new: option 'face_names': only with 'groups', which they are names of");
    name = lbw_to_names(L, -1, "surface.new: face_names", &names);
  }
  uint8_t *curved = read_curved(L, name, names);
  lbw_box *box = lbw_box_new(L, &lbw_surface_class);
  bw_surface *out = NULL;
  bw_context *context = lbw_enter(L);
  bw_status status = bw_surface_copy(context, points, point, triangles, triangle, group, &out);
  if (status == BW_OK && name)
    status = bw_face_names_create(context, names, name, curved, &out->names);
  if (status != BW_OK) {
    bw_release(out);
    out = NULL;
  }
  return lbw_leave_object(L, box, out, status);
}

typedef struct shape {
  double min[3], max[3], centre[3], base[3], axis[3];
  double radius;
  int subdivisions, segments, cells;
} shape;

static void need(lua_State *L, int index, const char *function, const char *key) {
  if (lbw_option_get(L, index, key) == LUA_TNIL)
    lbw_option_missing(L, function, key, "");
  lua_pop(L, 1);
}

/* surface.box{min, max} */
static int surface_box_shape(lua_State *L) {
  static const lbw_option options[] = {{"min", LBW_VECTOR, offsetof(shape, min)},
                                       {"max", LBW_VECTOR, offsetof(shape, max)},
                                       {NULL, LBW_OTHER, 0}};
  shape s = {0};
  lbw_options(L, 1, "surface.box", options, &s);
  need(L, 1, "surface.box", "max");
  lbw_box *box = lbw_box_new(L, &lbw_surface_class);
  bw_surface *out = NULL;
  bw_status status = bw_surface_box_shape(lbw_enter(L), s.min, s.max, &out);
  return lbw_leave_object(L, box, out, status);
}

/* surface.sphere{centre, radius, subdivisions} */
static int surface_sphere(lua_State *L) {
  static const lbw_option options[] = {{"centre", LBW_VECTOR, offsetof(shape, centre)},
                                       {"radius", LBW_REAL, offsetof(shape, radius)},
                                       {"subdivisions", LBW_INT, offsetof(shape, subdivisions)},
                                       {NULL, LBW_OTHER, 0}};
  shape s = {.subdivisions = 3};
  lbw_options(L, 1, "surface.sphere", options, &s);
  need(L, 1, "surface.sphere", "radius");
  lbw_box *box = lbw_box_new(L, &lbw_surface_class);
  bw_surface *out = NULL;
  bw_status status =
      bw_surface_sphere_shape(lbw_enter(L), s.centre, s.radius, s.subdivisions, &out);
  return lbw_leave_object(L, box, out, status);
}

/* surface.cylinder{base, axis, radius, segments}: the axis' length is the height */
static int surface_cylinder(lua_State *L) {
  static const lbw_option options[] = {{"base", LBW_VECTOR, offsetof(shape, base)},
                                       {"axis", LBW_VECTOR, offsetof(shape, axis)},
                                       {"radius", LBW_REAL, offsetof(shape, radius)},
                                       {"segments", LBW_INT, offsetof(shape, segments)},
                                       {NULL, LBW_OTHER, 0}};
  shape s = {.segments = 48};
  lbw_options(L, 1, "surface.cylinder", options, &s);
  need(L, 1, "surface.cylinder", "axis");
  need(L, 1, "surface.cylinder", "radius");
  lbw_box *box = lbw_box_new(L, &lbw_surface_class);
  bw_surface *out = NULL;
  bw_status status =
      bw_surface_cylinder_shape(lbw_enter(L), s.base, s.axis, s.radius, s.segments, &out);
  return lbw_leave_object(L, box, out, status);
}

/* surface.implicit(value, {min, max, cells}): the zero set of a function of x, y, z or a formula
 * in them that is negative inside */
static int surface_implicit(lua_State *L) {
  static const lbw_option options[] = {{"min", LBW_VECTOR, offsetof(shape, min)},
                                       {"max", LBW_VECTOR, offsetof(shape, max)},
                                       {"cells", LBW_INT, offsetof(shape, cells)},
                                       {NULL, LBW_OTHER, 0}};
  shape s = {.cells = 32};
  lua_settop(L, 2);
  lbw_options(L, 2, "surface.implicit", options, &s);
  need(L, 2, "surface.implicit", "min");
  need(L, 2, "surface.implicit", "max");
  lbw_field *field = lbw_field_read(L, 1, "surface.implicit");
  lbw_box *box = lbw_box_new(L, &lbw_surface_class);
  bw_surface *out = NULL;
  bw_context *context = lbw_enter(L);
  lbw_field_begin(field, context);
  bw_status status =
      bw_surface_implicit(context, s.min, s.max, s.cells, lbw_field_value, field, &out);
  lbw_field_end(field, context);
  int results = lbw_leave_object(L, box, out, status);
  if (status == BW_OK && lua_isfunction(L, 1))
    lbw_name_facets(L, 1, box);
  return results;
}

/* ---- changing -------------------------------------------------------------------------------- */

static int surface_scale(lua_State *L) {
  const bw_surface *surface = self(L);
  double factor = lbw_check_real(L, 2, "factor");
  lbw_box *box = lbw_box_new(L, &lbw_surface_class);
  bw_surface *out = NULL;
  bw_status status = bw_surface_scale(lbw_enter(L), surface, factor, &out);
  return lbw_leave_object(L, box, out, status);
}

static int transformed(lua_State *L, const bw_surface *surface, const double matrix[12]) {
  lbw_box *box = lbw_box_new(L, &lbw_surface_class);
  bw_surface *out = NULL;
  bw_status status = bw_surface_transform(lbw_enter(L), surface, matrix, &out);
  return lbw_leave_object(L, box, out, status);
}

/* surface:transform{{a11, a12, a13, b1}, ...} */
static int surface_transform(lua_State *L) {
  const bw_surface *surface = self(L);
  double matrix[12];
  lbw_check_matrix(L, 2, "matrix", 3, 4, matrix);
  return transformed(L, surface, matrix);
}

static int surface_translate(lua_State *L) {
  const bw_surface *surface = self(L);
  double by[3];
  lbw_check_vector(L, 2, "by", by);
  const double matrix[12] = {1, 0, 0, by[0], 0, 1, 0, by[1], 0, 0, 1, by[2]};
  return transformed(L, surface, matrix);
}

/* surface:rotate(axis, angle, centre): radians, right-handed */
static int surface_rotate(lua_State *L) {
  const bw_surface *surface = self(L);
  double axis[3], centre[3] = {0, 0, 0}, matrix[12];
  lbw_check_vector(L, 2, "axis", axis);
  double angle = lbw_check_real(L, 3, "angle"), length = bw_norm(axis);
  if (!lua_isnoneornil(L, 4))
    lbw_check_vector(L, 4, "centre", centre);
  lbw_argument_check(L, length > 0, 2, "axis: a vector other than 0 expected");
  double c = cos(angle), s = sin(angle);
  for (int i = 0; i < 3; i++)
    axis[i] /= length;
  for (int i = 0; i < 3; i++)
    for (int j = 0; j < 3; j++) {
      int k = 3 - i - j; /* the third one, when i and j differ */
      double cross = i == j ? 0 : ((j - i + 3) % 3 == 1 ? -axis[k] : axis[k]);
      matrix[4 * i + j] = (i == j ? c : 0) + (1 - c) * axis[i] * axis[j] + s * cross;
    }
  for (int i = 0; i < 3; i++)
    matrix[4 * i + 3] = centre[i] - bw_dot(&matrix[4 * i], centre);
  return transformed(L, surface, matrix);
}

static int surface_weld(lua_State *L) {
  const bw_surface *surface = self(L);
  double tolerance = lua_isnoneornil(L, 2) ? 0 : lbw_check_real(L, 2, "tolerance");
  lbw_box *box = lbw_box_new(L, &lbw_surface_class);
  bw_surface *out = NULL;
  bw_status status = bw_surface_weld(lbw_enter(L), surface, tolerance, &out);
  return lbw_leave_object(L, box, out, status);
}

/* surface:orient(): surface, number of facets turned */
static int surface_orient(lua_State *L) {
  const bw_surface *surface = self(L);
  lbw_box *box = lbw_box_new(L, &lbw_surface_class);
  bw_surface *out = NULL;
  int64_t flipped = 0;
  bw_status status = bw_surface_orient(lbw_enter(L), surface, &out, &flipped);
  lbw_box_fill(L, box, out);
  lua_pushinteger(L, flipped);
  return lbw_leave(L, status, 2);
}

static int leave_with_log(lua_State *L, lbw_box *box, const bw_surface *surface,
                          const bw_shape_log *log, bw_status status) {
  lbw_box_fill(L, box, surface);
  lbw_push_shape_log(L, log);
  return lbw_leave(L, status, 2);
}

static int surface_repair(lua_State *L) {
  static const lbw_option list[] = {
      {"weld", LBW_REAL, offsetof(bw_repair_options, weld)},
      {"fill_holes", LBW_BOOLEAN, offsetof(bw_repair_options, fill_holes)},
      {"intersections", LBW_BOOLEAN, offsetof(bw_repair_options, intersections)},
      {"wrap", LBW_BOOLEAN, offsetof(bw_repair_options, wrap)},
      {"wrap_alpha", LBW_REAL, offsetof(bw_repair_options, wrap_alpha)},
      {"wrap_offset", LBW_REAL, offsetof(bw_repair_options, wrap_offset)},
      {"time_limit", LBW_REAL, offsetof(bw_repair_options, time_limit)},
      {"memory_limit", LBW_REAL, offsetof(bw_repair_options, memory_limit)},
      {NULL, LBW_OTHER, 0}};
  const bw_surface *surface = self(L);
  bw_repair_options options;
  bw_repair_options_default(&options);
  lbw_options(L, 2, "repair", list, &options);
  lbw_box *box = lbw_box_new(L, &lbw_surface_class);
  bw_surface *out = NULL;
  bw_shape_log log = {0};
  bw_status status = bw_surface_repair(lbw_enter(L), surface, &options, &out, &log);
  return leave_with_log(L, box, out, &log, status);
}

static int surface_remesh(lua_State *L) {
  static const lbw_option list[] = {
      {"edge_length", LBW_REAL, offsetof(bw_remesh_options, edge_length)},
      {"triangles", LBW_COUNT, offsetof(bw_remesh_options, triangles)},
      {"sharp_angle", LBW_REAL, offsetof(bw_remesh_options, sharp_angle)},
      {"iterations", LBW_INT, offsetof(bw_remesh_options, iterations)},
      {"tolerance", LBW_REAL, offsetof(bw_remesh_options, tolerance)},
      {"time_limit", LBW_REAL, offsetof(bw_remesh_options, time_limit)},
      {"memory_limit", LBW_REAL, offsetof(bw_remesh_options, memory_limit)},
      {NULL, LBW_OTHER, 0}};
  const bw_surface *surface = self(L);
  bw_remesh_options options;
  bw_remesh_options_default(&options);
  lbw_options(L, 2, "remesh", list, &options);
  lbw_box *box = lbw_box_new(L, &lbw_surface_class);
  bw_surface *out = NULL;
  bw_shape_log log = {0};
  bw_status status = bw_surface_remesh(lbw_enter(L), surface, &options, &out, &log);
  return leave_with_log(L, box, out, &log, status);
}

static int surface_wrap(lua_State *L) {
  static const lbw_option list[] = {
      {"alpha", LBW_REAL, offsetof(bw_wrap_options, alpha)},
      {"offset", LBW_REAL, offsetof(bw_wrap_options, offset)},
      {"time_limit", LBW_REAL, offsetof(bw_wrap_options, time_limit)},
      {"memory_limit", LBW_REAL, offsetof(bw_wrap_options, memory_limit)},
      {NULL, LBW_OTHER, 0}};
  const bw_surface *surface = self(L);
  bw_wrap_options options;
  bw_wrap_options_default(&options);
  lbw_options(L, 2, "wrap", list, &options);
  lbw_box *box = lbw_box_new(L, &lbw_surface_class);
  bw_surface *out = NULL;
  bw_shape_log log = {0};
  bw_status status = bw_surface_wrap(lbw_enter(L), surface, &options, &out, &log);
  return leave_with_log(L, box, out, &log, status);
}

/* surface:distance(points): of each; surface:distance(surface): the largest, both ways */
static int surface_distance(lua_State *L) {
  const bw_surface *surface = self(L);
  if (!lbw_test(L, 2, &lbw_surface_class)) {
    int64_t rows;
    lua_settop(L, 2);
    const double *point = lbw_to_doubles(L, 2, "points", 3, &rows);
    bw_array *offset = lbw_push_array(L, BW_F64, rows, 1);
    return lbw_leave(
        L, bw_surface_offsets(lbw_enter(L), surface, rows, point, (double *)offset->data), 1);
  }
  const bw_surface *other = (const bw_surface *)lbw_check(L, 2, &lbw_surface_class);
  double distance = 0;
  bw_status status = bw_surface_distance(lbw_enter(L), surface, other, &distance);
  lua_pushnumber(L, distance);
  return lbw_leave(L, status, 1);
}

/* surface:nearest(points): the nearest triangle of each, the place on it, and how far that is */
static int surface_nearest(lua_State *L) {
  const bw_surface *surface = self(L);
  int64_t rows;
  lua_settop(L, 2);
  const double *point = lbw_to_doubles(L, 2, "points", 3, &rows);
  int32_t *facet = (int32_t *)lbw_push_array(L, BW_I32, rows, 1)->data;
  double *place = (double *)lbw_push_array(L, BW_F64, rows, 3)->data;
  double *distance = (double *)lbw_push_array(L, BW_F64, rows, 1)->data;
  bw_status status = bw_surface_nearest(lbw_enter(L), surface, rows, point, facet, place, distance);
  for (int64_t i = 0; i < rows && status == BW_OK; i++)
    facet[i]++;
  return lbw_leave(L, status, 3);
}

/* ---- two bodies ------------------------------------------------------------------------------ */

static int combined(lua_State *L, bw_boolean operation) {
  const bw_surface *first = self(L);
  const bw_surface *second = (const bw_surface *)lbw_check(L, 2, &lbw_surface_class);
  lbw_box *box = lbw_box_new(L, &lbw_surface_class);
  bw_surface *out = NULL;
  bw_status status = bw_surface_boolean(lbw_enter(L), first, second, operation, &out);
  return lbw_leave_object(L, box, out, status);
}

static int surface_union(lua_State *L) {
  return combined(L, BW_BOOLEAN_UNION);
}

static int surface_difference(lua_State *L) {
  return combined(L, BW_BOOLEAN_DIFFERENCE);
}

static int surface_intersection(lua_State *L) {
  return combined(L, BW_BOOLEAN_INTERSECTION);
}

/* surface:groups_on(mesh): the group of every facet of the mesh's boundary */
static int surface_groups_on(lua_State *L) {
  const bw_surface *surface = self(L);
  const bw_mesh *mesh = (const bw_mesh *)lbw_check(L, 2, &lbw_mesh_class);
  if (!surface->group)
    return lbw_error(L, "groups_on: the surface has no groups: surface:named gives it one");
  int32_t *group = (int32_t *)lbw_push_array(L, BW_I32, mesh->facet_count, 1)->data;
  bw_status status = bw_groups_on_mesh(lbw_enter(L), surface, mesh, group);
  for (int32_t t = 0; t < mesh->facet_count && status == BW_OK; t++)
    group[t]++;
  return lbw_leave(L, status, 1);
}

/* ---- checking -------------------------------------------------------------------------------- */

static void push_report(lua_State *L, const bw_surface_report *report) {
  lua_createtable(L, 0, 12);
  lua_createtable(L, 0, BW_DEFECT_KINDS);
  for (int k = 0; k < BW_DEFECT_KINDS; k++) {
    lua_pushinteger(L, report->count[k]);
    lua_setfield(L, -2, bw_defect_word((bw_defect_kind)k));
  }
  lua_setfield(L, -2, "count");
  lua_pushinteger(L, report->holes);
  lua_setfield(L, -2, "holes");
  lua_pushinteger(L, report->shells);
  lua_setfield(L, -2, "shells");
  lua_pushboolean(L, report->closed);
  lua_setfield(L, -2, "closed");
  lua_pushboolean(L, report->oriented);
  lua_setfield(L, -2, "oriented");
  lua_pushboolean(L, report->sound);
  lua_setfield(L, -2, "sound");
  lua_pushnumber(L, report->volume);
  lua_setfield(L, -2, "volume");
  lua_pushnumber(L, report->area);
  lua_setfield(L, -2, "area");
  lbw_push_box(L, report->min, report->max);
  lua_setfield(L, -2, "box");
  lua_createtable(L, (int)report->defect_count, 0);
  for (int64_t i = 0; i < report->defect_count; i++) {
    const bw_defect *defect = &report->defect[i];
    lua_createtable(L, 0, 4);
    lua_pushstring(L, bw_defect_word(defect->kind));
    lua_setfield(L, -2, "kind");
    lua_pushinteger(L, (lua_Integer)defect->facet + 1);
    lua_setfield(L, -2, "facet");
    if (defect->other >= 0) {
      lua_pushinteger(L, (lua_Integer)defect->other + 1);
      lua_setfield(L, -2, "other");
    }
    lbw_push_vector(L, defect->at);
    lua_setfield(L, -2, "at");
    lua_rawseti(L, -2, i + 1);
  }
  lua_setfield(L, -2, "defects");
  luaL_setmetatable(L, "barwright.surface_report");
}

/* The report's list of defects must go even when building the table runs out of memory. */
static int report_protected(lua_State *L) {
  push_report(L, (const bw_surface_report *)lua_touserdata(L, 1));
  return 1;
}

/* surface:check{limit}: a table */
static int surface_check(lua_State *L) {
  int64_t limit = 20;
  static const lbw_option list[] = {{"limit", LBW_COUNT, 0}, {NULL, LBW_OTHER, 0}};
  const bw_surface *surface = self(L);
  lbw_options(L, 2, "check", list, &limit);
  bw_surface_report report;
  memset(&report, 0, sizeof report);
  lua_pushcfunction(L, report_protected);
  lua_pushlightuserdata(L, &report);
  bw_status status = bw_surface_check(lbw_enter(L), surface, limit, &report);
  if (status != BW_OK)
    return lbw_leave(L, status, 0);
  int failure = lua_pcall(L, 1, 1, 0);
  bw_surface_report_clear(&report);
  lbw_leave_or_raise(L, BW_OK);
  return failure ? lua_error(L) : 1;
}

/* ---- properties ------------------------------------------------------------------------------ */

static int surface_points(lua_State *L) {
  const bw_surface *surface = self(L);
  return lbw_push_borrowed(L, BW_F64, surface->point_count, 3, surface->point, surface);
}

static int surface_triangles(lua_State *L) {
  const bw_surface *surface = self(L);
  return lbw_push_indices(L, surface->triangle_count, 3, surface->triangle);
}

static int surface_groups(lua_State *L) {
  const bw_surface *surface = self(L);
  if (!surface->group)
    return 0;
  return lbw_push_indices(L, surface->triangle_count, 1, surface->group);
}

LBW_PUSH(surface_point_count, lua_pushinteger(L, self(L)->point_count))
LBW_PUSH(surface_triangle_count, lua_pushinteger(L, self(L)->triangle_count))
LBW_PUSH(surface_area, lua_pushnumber(L, bw_surface_area(self(L))))
LBW_PUSH(surface_volume, lua_pushnumber(L, bw_surface_volume(self(L))))

static int surface_box(lua_State *L) {
  double min[3], max[3];
  bw_surface_box(self(L), min, max);
  lbw_push_box(L, min, max);
  return 1;
}

static int surface_tostring(lua_State *L) {
  const bw_surface *surface = (const bw_surface *)lbw_check(L, 1, &lbw_surface_class);
  double min[3], max[3];
  bw_surface_box(surface, min, max);
  lbw_push_box_text(L, min, max);
  lua_pushfstring(L, "surface of %d triangles and %d points, %s", (int)surface->triangle_count,
                  (int)surface->point_count, lua_tostring(L, -1));
  lbw_add_faces(L, surface);
  return 1;
}

int lbw_push_boundary(lua_State *L, const void *body, lbw_boundary *boundary) {
  lbw_box *box = lbw_box_new(L, &lbw_surface_class);
  lbw_box *nodes = lbw_box_new(L, &lbw_array_class);
  bw_surface *out = NULL;
  bw_array *array = NULL;
  int32_t *node = NULL;
  bw_status status;
  bw_context *context = lbw_enter(L);
  BW_TRY(boundary(context, body, &out, &node));
  for (int32_t i = 0; i < out->point_count; i++)
    node[i]++;
  BW_TRY(bw_array_adopt(context, BW_I32, out->point_count, 1, node, &array));
  node = NULL;
done:
  bw_free(node);
  if (status != BW_OK) {
    bw_release(out);
    out = NULL;
  }
  nodes->object = array;
  lbw_box_fill(L, box, out);
  lbw_box_account(L, nodes);
  return lbw_leave(L, status, 2);
}

static const luaL_Reg methods[] = {{"write", surface_write},
                                   {"check", surface_check},
                                   {"repair", surface_repair},
                                   {"remesh", surface_remesh},
                                   {"wrap", surface_wrap},
                                   {"orient", surface_orient},
                                   {"weld", surface_weld},
                                   {"scale", surface_scale},
                                   {"transform", surface_transform},
                                   {"translate", surface_translate},
                                   {"rotate", surface_rotate},
                                   {"distance", surface_distance},
                                   {"nearest", surface_nearest},
                                   {"faces", lbw_surface_faces},
                                   {"union", surface_union},
                                   {"difference", surface_difference},
                                   {"intersection", surface_intersection},
                                   {"groups_on", surface_groups_on},
                                   {"named", lbw_surface_named},
                                   {"face_names", lbw_surface_face_names},
                                   {"curved_faces", lbw_surface_curved_faces},
                                   {NULL, NULL}};
static const luaL_Reg properties[] = {{"points", surface_points},
                                      {"triangles", surface_triangles},
                                      {"groups", surface_groups},
                                      {"point_count", surface_point_count},
                                      {"triangle_count", surface_triangle_count},
                                      {"area", surface_area},
                                      {"volume", surface_volume},
                                      {"box", surface_box},
                                      {NULL, NULL}};
static const luaL_Reg meta[] = {{"__tostring", surface_tostring}, {NULL, NULL}};
const lbw_class lbw_surface_class = {"surface", methods, properties, meta, NULL};

void lbw_open_surface(lua_State *L) {
  static const luaL_Reg functions[] = {{"read", surface_read},
                                       {"new", surface_new},
                                       {"box", surface_box_shape},
                                       {"sphere", surface_sphere},
                                       {"cylinder", surface_cylinder},
                                       {"implicit", surface_implicit},
                                       {NULL, NULL}};
  lbw_class_register(L, &lbw_surface_class);
  lua_newtable(L);
  luaL_setfuncs(L, functions, 0);
  lua_setfield(L, -2, "surface");
}
