/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* bw.mesh: filling, reading, writing, changing, measuring and searching tetrahedral meshes. */
#include "bind.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static const bw_mesh *self(lua_State *L) {
  return (const bw_mesh *)lbw_check(L, 1, &lbw_mesh_class);
}

/* ---- filling --------------------------------------------------------------------------------- */

static void push_fill_log(lua_State *L, const bw_fill_log *log) {
  lbw_push_shape_log(L, &log->shape);
  lua_pushboolean(L, log->repaired);
  lua_setfield(L, -2, "repaired");
  lua_pushnumber(L, log->surface_moved);
  lua_setfield(L, -2, "surface_moved");
  lua_pushnumber(L, log->edge_length);
  lua_setfield(L, -2, "edge_length");
  lua_pushinteger(L, log->attempts);
  lua_setfield(L, -2, "attempts");
  lua_pushnumber(L, log->seconds_repair);
  lua_setfield(L, -2, "seconds_repair");
  lua_pushnumber(L, log->seconds_remesh);
  lua_setfield(L, -2, "seconds_remesh");
  lua_pushnumber(L, log->seconds_fill);
  lua_setfield(L, -2, "seconds_fill");
}

/* {{at = {x, y, z}, radius = , length = }, ...} into a userdata that is pushed */
static bw_size_point *read_size_points(lua_State *L, int index, int64_t *count) {
  static const lbw_option list[] = {{"at", LBW_VECTOR, offsetof(bw_size_point, at)},
                                    {"radius", LBW_REAL, offsetof(bw_size_point, radius)},
                                    {"length", LBW_REAL, offsetof(bw_size_point, length)},
                                    {NULL, LBW_OTHER, 0}};
  if (!lua_istable(L, index))
    lbw_error(L, "mesh.fill: option 'near': a list of {at =, radius =, length =} expected, got %s",
              lbw_got(L, index));
  *count = (int64_t)lua_rawlen(L, index);
  bw_size_point *point =
      (bw_size_point *)lua_newuserdatauv(L, (size_t)(*count + 1) * sizeof *point, 0);
  for (int64_t i = 0; i < *count; i++) {
    point[i] = (bw_size_point){{0, 0, 0}, 0, 0};
    lua_rawgeti(L, index, i + 1);
    lbw_options(L, -1, "mesh.fill: near", list, &point[i]);
    lua_pop(L, 1);
    if (!(point[i].length > 0))
      lbw_error(L, "mesh.fill: near: point %d: a length above 0 expected, got %s", (int)i + 1,
                lbw_quantity(point[i].length, "m").text);
  }
  return point;
}

/* The options near and size; what they need is pushed. The field is NULL without size. */
static lbw_field *read_sizes(lua_State *L, int index, bw_fill_options *options) {
  lbw_field *field = NULL;
  if (lbw_option_get(L, index, "near") != LUA_TNIL)
    options->size_point = read_size_points(L, lua_gettop(L), &options->size_point_count);
  if (lbw_option_get(L, index, "size") != LUA_TNIL) {
    field = lbw_field_read(L, -1, "mesh.fill: size");
    options->size = lbw_field_value;
    options->size_data = field;
  }
  return field;
}

static int by_name(const void *a, const void *b) {
  return strcmp(((const bw_fill_part *)a)->name.text, ((const bw_fill_part *)b)->name.text);
}

/* {name = surface, ...} into a userdata that is pushed, in the order of the names. */
static bw_fill_part *read_parts(lua_State *L, int index, int32_t *count) {
  *count = 0;
  lbw_check_type(L, index, LUA_TTABLE);
  for (lua_pushnil(L); lua_next(L, index); lua_pop(L, 1))
    ++*count;
  bw_fill_part *part = (bw_fill_part *)lua_newuserdatauv(L, ((size_t)*count + 1) * sizeof *part, 0);
  int32_t at = 0;
  for (lua_pushnil(L); lua_next(L, index); lua_pop(L, 1), at++) {
    lbw_read_name(L, -2, "mesh.fill_parts: part", &part[at].name);
    part[at].surface = (const bw_surface *)lbw_test(L, -1, &lbw_surface_class);
    if (!part[at].surface)
      lbw_error(L, "mesh.fill_parts: part '%s': a surface expected, got %s", part[at].name.text,
                lbw_got(L, -1));
  }
  lbw_argument_check(L, *count > 0, index, "at least one part {name = surface} expected");
  qsort(part, (size_t)*count, sizeof *part, by_name);
  return part;
}

/* mesh.fill_parts({name = surface, ...}, options): mesh */
static int mesh_fill_parts(lua_State *L) {
  struct parts {
    bw_fill_options fill;
    double merge;
  } options = {.merge = 0};
  static const lbw_option list[] = {
      {"order", LBW_INT, offsetof(struct parts, fill.order)},
      {"edge_length", LBW_REAL, offsetof(struct parts, fill.edge_length)},
      {"max_volume", LBW_REAL, offsetof(struct parts, fill.max_volume)},
      {"radius_edge", LBW_REAL, offsetof(struct parts, fill.radius_edge)},
      {"dihedral", LBW_REAL, offsetof(struct parts, fill.dihedral)},
      {"keep_surface", LBW_BOOLEAN, offsetof(struct parts, fill.keep_surface)},
      {"time_limit", LBW_REAL, offsetof(struct parts, fill.time_limit)},
      {"memory_limit", LBW_REAL, offsetof(struct parts, fill.memory_limit)},
      {"merge", LBW_REAL, offsetof(struct parts, merge)},
      {"near", LBW_OTHER, 0},
      {"size", LBW_OTHER, 0},
      {NULL, LBW_OTHER, 0}};
  int32_t count;
  lua_settop(L, 2);
  bw_fill_options_default(&options.fill);
  lbw_options(L, 2, "mesh.fill_parts", list, &options);
  bw_fill_part *part = read_parts(L, 1, &count);
  lbw_field *field = read_sizes(L, 2, &options.fill);
  lbw_box *box = lbw_box_new(L, &lbw_mesh_class);
  bw_mesh *mesh = NULL;
  bw_context *context = lbw_enter(L);
  if (field)
    lbw_field_begin(field, context);
  bw_status status = bw_mesh_fill_parts(context, count, part, options.merge, &options.fill, &mesh);
  if (field)
    lbw_field_end(field, context);
  return lbw_leave_object(L, box, mesh, status);
}

/* mesh.fill(surface, options): mesh, log */
static int mesh_fill(lua_State *L) {
  static const lbw_option list[] = {
      {"order", LBW_INT, offsetof(bw_fill_options, order)},
      {"elements", LBW_COUNT, offsetof(bw_fill_options, elements)},
      {"edge_length", LBW_REAL, offsetof(bw_fill_options, edge_length)},
      {"surface_tolerance", LBW_REAL, offsetof(bw_fill_options, surface_tolerance)},
      {"max_volume", LBW_REAL, offsetof(bw_fill_options, max_volume)},
      {"radius_edge", LBW_REAL, offsetof(bw_fill_options, radius_edge)},
      {"dihedral", LBW_REAL, offsetof(bw_fill_options, dihedral)},
      {"keep_surface", LBW_BOOLEAN, offsetof(bw_fill_options, keep_surface)},
      {"remesh", LBW_BOOLEAN, offsetof(bw_fill_options, remesh)},
      {"repair", LBW_BOOLEAN, offsetof(bw_fill_options, repair)},
      {"sharp_angle", LBW_REAL, offsetof(bw_fill_options, sharp_angle)},
      {"time_limit", LBW_REAL, offsetof(bw_fill_options, time_limit)},
      {"memory_limit", LBW_REAL, offsetof(bw_fill_options, memory_limit)},
      {"tolerance", LBW_REAL, offsetof(bw_fill_options, tolerance)},
      {"near", LBW_OTHER, 0},
      {"size", LBW_OTHER, 0},
      {NULL, LBW_OTHER, 0}};
  const bw_surface *surface = (const bw_surface *)lbw_check(L, 1, &lbw_surface_class);
  bw_fill_options options;
  bw_fill_options_default(&options);
  lua_settop(L, 2);
  lbw_options(L, 2, "mesh.fill", list, &options);
  lbw_field *field = read_sizes(L, 2, &options);
  lbw_box *box = lbw_box_new(L, &lbw_mesh_class);
  bw_mesh *mesh = NULL;
  bw_fill_log log;
  memset(&log, 0, sizeof log);
  bw_context *context = lbw_enter(L);
  if (field)
    lbw_field_begin(field, context);
  bw_status status = bw_mesh_fill(context, surface, &options, &mesh, &log);
  if (field)
    lbw_field_end(field, context);
  lbw_box_fill(L, box, mesh);
  push_fill_log(L, &log);
  return lbw_leave(L, status, 2);
}

/* ---- files ----------------------------------------------------------------------------------- */

/* The read file's fields, sets and format as a table; runs protected. */
static int push_file(lua_State *L) {
  bw_mesh_file *file = (bw_mesh_file *)lua_touserdata(L, 1);
  lua_createtable(L, 0, 5);
  lua_newtable(L);
  for (int i = 0; i < file->field_count; i++) {
    lbw_push(L, &lbw_array_class, file->field_array[i]);
    lua_setfield(L, -2, file->field_name[i]);
  }
  lua_setfield(L, -2, "fields");
  lua_newtable(L);
  for (int i = 0; i < file->set_count; i++) {
    lua_createtable(L, 0, 1);
    lbw_push_indices(L, file->set[i].count, 1, file->set[i].member);
    lua_setfield(L, -2, file->set[i].of_elements ? "elements" : "nodes");
    lua_setfield(L, -2, file->set[i].name);
  }
  lua_setfield(L, -2, "sets");
  lua_pushstring(L, file->info.format);
  lua_setfield(L, -2, "format");
  lua_pushinteger(L, file->info.skipped);
  lua_setfield(L, -2, "skipped");
  if (file->node_from) {
    lbw_push_indices(L, file->mesh->node_count, 1, file->node_from);
    lua_setfield(L, -2, "node_from");
    lbw_push_indices(L, file->mesh->element_count, 1, file->element_from);
    lua_setfield(L, -2, "element_from");
  }
  return 1;
}

static bw_status scale_mesh(bw_context *context, const bw_mesh *mesh, double factor,
                            bw_mesh **scaled) {
  if (factor == 1) {
    *scaled = (bw_mesh *)bw_retain(mesh);
    return BW_OK;
  }
  double *node = BW_NEW(context, double, 3 * (size_t)mesh->node_count);
  if (!node)
    return BW_MEMORY;
  for (int64_t i = 0; i < 3 * (int64_t)mesh->node_count; i++)
    node[i] = factor * mesh->node[i];
  bw_status status = bw_mesh_moved(context, mesh, node, scaled);
  bw_free(node);
  return status;
}

/* The option renumber: true, false, or "auto". */
static bw_renumber renumber_option(lua_State *L, int index) {
  int type = lbw_option_get(L, index, "renumber");
  bw_renumber when = BW_RENUMBER_AUTO;
  if (type == LUA_TBOOLEAN)
    when = lua_toboolean(L, -1) ? BW_RENUMBER_ALWAYS : BW_RENUMBER_NEVER;
  else if (type != LUA_TNIL && (type != LUA_TSTRING || strcmp(lua_tostring(L, -1), "auto") != 0))
    lbw_option_refused(L, "mesh.read", "renumber", "true, false or 'auto'");
  lua_pop(L, 1);
  return when;
}

/* mesh.read(path, {unit, renumber}): mesh, what else the file holds */
static int mesh_read(lua_State *L) {
  static const lbw_option list[] = {
      {"unit", LBW_OTHER, 0}, {"renumber", LBW_OTHER, 0}, {NULL, LBW_OTHER, 0}};
  const char *path = lbw_check_text(L, 1, NULL);
  lbw_options(L, 2, "mesh.read", list, NULL);
  double unit = lbw_unit_option(L, 2, "mesh.read", 1);
  bw_renumber when = renumber_option(L, 2);
  lbw_box *box = lbw_box_new(L, &lbw_mesh_class);
  bw_mesh_file file;
  memset(&file, 0, sizeof file);
  bw_mesh *mesh = NULL;
  lua_pushcfunction(L, push_file);
  lua_pushlightuserdata(L, &file);
  bw_status status;
  bw_context *context = lbw_enter(L);
  BW_TRY(bw_mesh_read(context, path, &file));
  BW_TRY(bw_mesh_file_renumber(context, &file, when));
  BW_TRY(scale_mesh(context, file.mesh, unit, &mesh));
done:
  lbw_state_of(L)->running = 0;
  box->object = mesh;
  int failure = status == BW_OK ? lua_pcall(L, 1, 1, 0) : 0;
  bw_mesh_file_clear(&file);
  if (status != BW_OK)
    lua_pop(L, 2);
  lbw_box_fill(L, box, mesh);
  if (failure)
    return lua_error(L);
  if (status != BW_OK)
    return lbw_leave(L, status, 0);
  return lbw_leave(L, status, 2);
}

/* mesh:write(path, {fields, unit, version}) */
static int mesh_write(lua_State *L) {
  static const lbw_option list[] = {{"fields", LBW_OTHER, 0},
                                    {"unit", LBW_OTHER, 0},
                                    {"version", LBW_OTHER, 0},
                                    {NULL, LBW_OTHER, 0}};
  const bw_mesh *mesh = self(L);
  const char *path = lbw_check_text(L, 2, NULL);
  lua_settop(L, 3);
  lbw_options(L, 3, "write", list, NULL);
  double unit = lbw_unit_option(L, 3, "write", 1);
  static const char *const versions[] = {"4.1", "2.2", NULL};
  bool old = lbw_word_option(L, 3, "write", "version", versions, 0) == 1;
  lbw_option_get(L, 3, "fields");
  int count;
  bw_field *field = lbw_fields(L, -1, "write", mesh->node_count, mesh->element_count, &count);
  bw_mesh *scaled = NULL;
  bw_status status;
  bw_context *context = lbw_enter(L);
  BW_TRY(scale_mesh(context, mesh, 1 / unit, &scaled));
  status = old ? bw_msh22_write(context, scaled, path, count, field)
               : bw_mesh_write(context, scaled, path, count, field);
done:
  bw_release(scaled);
  lua_pushboolean(L, 1);
  return lbw_leave(L, status, 1);
}

/* ---- making ---------------------------------------------------------------------------------- */

/* mesh.new{nodes, elements, order, regions}: metres, numbers from 1; regions: a tag per element */
static int mesh_new(lua_State *L) {
  static const lbw_option list[] = {{"nodes", LBW_OTHER, 0},   {"elements", LBW_OTHER, 0},
                                    {"regions", LBW_OTHER, 0}, {"region_names", LBW_OTHER, 0},
                                    {"order", LBW_INT, 0},     {NULL, LBW_OTHER, 0}};
  lbw_check_type(L, 1, LUA_TTABLE);
  lua_settop(L, 1);
  int order = 1;
  lbw_options(L, 1, "mesh.new", list, &order);
  if (order != 1 && order != 2)
    return lbw_error(L, "mesh.new: option 'order': 1 or 2 expected, got %d", order);
  int64_t nodes, elements;
  lbw_option_get(L, 1, "nodes");
  double *node = lbw_to_doubles(L, -1, "mesh.new: nodes", 3, &nodes);
  lbw_option_get(L, 1, "elements");
  int32_t *element = lbw_to_indices(L, -1, "mesh.new: elements", order == 1 ? 4 : 10, &elements);
  int32_t *tag = NULL, named_count = 0;
  if (lbw_option_get(L, 1, "regions") != LUA_TNIL)
    tag = lbw_to_tags(L, -1, "mesh.new: regions", elements);
  lbw_option_get(L, 1, "region_names");
  bw_mesh_region *named =
      lbw_read_region_names(L, lua_gettop(L), "mesh.new: region_names", &named_count);
  lbw_box *box = lbw_box_new(L, &lbw_mesh_class);
  bw_mesh *out = NULL;
  bw_mesh_regions table = {0, NULL, NULL};
  bw_context *context = lbw_enter(L);
  bw_status status = BW_OK;
  if (tag)
    BW_TRY(bw_mesh_regions_by_tag(context, elements, tag, named_count, named, &table));
  status = bw_mesh_copy(context, order, nodes, node, elements, element, &table, &out);
done:
  bw_mesh_regions_clear(&table);
  return lbw_leave_object(L, box, out, status);
}

/* mesh.box{min, max, cells = {nx, ny, nz}, order} */
static int mesh_box_grid(lua_State *L) {
  struct grid {
    double min[3], max[3], cells[3];
    int order;
  } grid = {{0, 0, 0}, {1, 1, 1}, {1, 1, 1}, 1};
  static const lbw_option list[] = {{"min", LBW_VECTOR, offsetof(struct grid, min)},
                                    {"max", LBW_VECTOR, offsetof(struct grid, max)},
                                    {"cells", LBW_VECTOR, offsetof(struct grid, cells)},
                                    {"order", LBW_INT, offsetof(struct grid, order)},
                                    {NULL, LBW_OTHER, 0}};
  lbw_check_type(L, 1, LUA_TTABLE);
  lbw_options(L, 1, "mesh.box", list, &grid);
  int cells[3];
  for (int i = 0; i < 3; i++) {
    if (grid.cells[i] != floor(grid.cells[i]) || grid.cells[i] < 1 || grid.cells[i] > 1e6)
      return lbw_error(L, "mesh.box: option 'cells': three whole numbers from 1 expected, got %s",
                       lbw_quantity(grid.cells[i], "").text);
    cells[i] = (int)grid.cells[i];
  }
  lbw_box *box = lbw_box_new(L, &lbw_mesh_class);
  bw_mesh *out = NULL;
  bw_status status = bw_mesh_box_grid(lbw_enter(L), grid.min, grid.max, cells, grid.order, &out);
  return lbw_leave_object(L, box, out, status);
}

/* ---- changing -------------------------------------------------------------------------------- */

static int mesh_with_order(lua_State *L) {
  const bw_mesh *mesh = self(L);
  lua_Integer order = lbw_check_integer(L, 2);
  lbw_argument_check(L, order == 1 || order == 2, 2, "an order of 1 or 2 expected");
  lbw_box *box = lbw_box_new(L, &lbw_mesh_class);
  bw_mesh *out = NULL;
  bw_status status = bw_mesh_with_order(lbw_enter(L), mesh, (int)order, &out);
  return lbw_leave_object(L, box, out, status);
}

static int mesh_moved(lua_State *L) {
  const bw_mesh *mesh = self(L);
  int64_t rows;
  double *node = lbw_to_doubles(L, 2, "nodes", 3, &rows);
  lbw_check_rows(L, 2, "nodes", rows, mesh->node_count, "node");
  lbw_box *box = lbw_box_new(L, &lbw_mesh_class);
  bw_mesh *out = NULL;
  bw_status status = bw_mesh_moved(lbw_enter(L), mesh, node, &out);
  return lbw_leave_object(L, box, out, status);
}

/* mesh:subset(mask): the elements whose mask is not 0 */
static int mesh_subset(lua_State *L) {
  const bw_mesh *mesh = self(L);
  uint8_t *keep = lbw_to_mask(L, 2, "mask", mesh->element_count);
  lbw_box *box = lbw_box_new(L, &lbw_mesh_class);
  bw_mesh *out = NULL;
  bw_status status = bw_mesh_subset(lbw_enter(L), mesh, keep, &out);
  return lbw_leave_object(L, box, out, status);
}

/* mesh:renumbered(): the mesh, the old numbers of its nodes, of its elements */
static int mesh_renumbered(lua_State *L) {
  const bw_mesh *mesh = self(L);
  lbw_box *box = lbw_box_new(L, &lbw_mesh_class);
  int32_t *numbers[2] = {NULL, NULL}, counts[2] = {mesh->node_count, mesh->element_count};
  int32_t *to[2];
  for (int n = 0; n < 2; n++)
    to[n] = (int32_t *)lbw_push_array(L, BW_I32, counts[n], 1)->data;
  bw_mesh *out = NULL;
  bw_status status = bw_mesh_renumbered(lbw_enter(L), mesh, &numbers[0], &numbers[1], &out);
  for (int n = 0; n < 2; n++) {
    for (int32_t i = 0; i < counts[n] && status == BW_OK; i++)
      to[n][i] = numbers[n][i] + 1;
    bw_free(numbers[n]);
  }
  lbw_box_fill(L, box, out);
  return lbw_leave(L, status, 3);
}

static bw_status boundary_of(bw_context *context, const void *mesh, bw_surface **surface,
                             int32_t **node) {
  return bw_mesh_boundary(context, (const bw_mesh *)mesh, surface, node);
}

/* mesh:surface(): surface, the mesh node of every point */
static int mesh_surface(lua_State *L) {
  return lbw_push_boundary(L, self(L), boundary_of);
}

/* ---- searching and measuring ----------------------------------------------------------------- */

static const lbw_class locator_class;

/* The locator is built on first use and kept with the box. */
static int make_locator(lua_State *L) {
  const bw_mesh *mesh = self(L);
  lbw_box *box = lbw_box_new(L, &locator_class);
  bw_locator *locator = NULL;
  bw_status status = bw_locator_create(lbw_enter(L), mesh, &locator);
  lbw_box_fill(L, box, locator);
  lbw_leave_or_raise(L, status);
  return 1;
}

/* mesh:locate(point): element, its barycentric weights, whether the point lies inside */
static int mesh_locate(lua_State *L) {
  const bw_mesh *mesh = self(L);
  double point[3], weight[4] = {0, 0, 0, 0};
  bool inside = false;
  lbw_check_vector(L, 2, "point", point);
  lbw_cached(L, "locator", make_locator);
  const bw_locator *locator = (const bw_locator *)lbw_test(L, -1, &locator_class);
  int32_t element = bw_locator_find(locator, point, weight, &inside);
  (void)mesh;
  lua_pushinteger(L, (lua_Integer)element + 1);
  lua_createtable(L, 4, 0);
  for (int i = 0; i < 4; i++) {
    lua_pushnumber(L, weight[i]);
    lua_rawseti(L, -2, i + 1);
  }
  lua_pushboolean(L, inside);
  return 3;
}

/* mesh:sample(values, points): values at points, and how far these lie outside of the mesh */
static int mesh_sample(lua_State *L) {
  const bw_mesh *mesh = self(L);
  const bw_array *values = (const bw_array *)lbw_check(L, 2, &lbw_array_class);
  int64_t rows, count;
  lbw_check_rows(L, 2, "values", values->rows, mesh->node_count, "node");
  const double *value = lbw_to_doubles(L, 2, "values", (int)values->columns, &rows);
  const double *point = lbw_to_doubles(L, 3, "points", 3, &count);
  lbw_cached(L, "locator", make_locator);
  const bw_locator *locator = (const bw_locator *)lbw_test(L, -1, &locator_class);
  double *out = (double *)lbw_push_array(L, BW_F64, count, values->columns)->data;
  double *outside = (double *)lbw_push_array(L, BW_F64, count, 1)->data;
  return lbw_leave(L,
                   bw_mesh_sample(lbw_enter(L), mesh, locator, (int)values->columns, value, count,
                                  point, out, outside),
                   2);
}

static int mesh_quality(lua_State *L) {
  bw_mesh_quality quality;
  bw_mesh_quality_of(self(L), &quality);
  lua_createtable(L, 0, 7);
  lua_pushnumber(L, quality.dihedral_min);
  lua_setfield(L, -2, "dihedral_min");
  lua_pushnumber(L, quality.dihedral_max);
  lua_setfield(L, -2, "dihedral_max");
  lua_pushnumber(L, quality.radius_edge_max);
  lua_setfield(L, -2, "radius_edge_max");
  lua_pushnumber(L, quality.aspect_max);
  lua_setfield(L, -2, "aspect_max");
  lua_pushnumber(L, quality.volume_min);
  lua_setfield(L, -2, "volume_min");
  lua_pushnumber(L, quality.volume_max);
  lua_setfield(L, -2, "volume_max");
  lua_pushinteger(L, (lua_Integer)quality.worst + 1);
  lua_setfield(L, -2, "worst");
  return 1;
}

/* mesh:to_nodes(values, how): values of elements brought to nodes: "mean" by volume, or "max": the
 * largest of the elements that meet at the node, so that no peak is lost */
static int mesh_to_nodes(lua_State *L) {
  static const char *const hows[] = {"mean", "max", NULL};
  const bw_mesh *mesh = self(L);
  const bw_array *value = lbw_check_array(L, 2, "values");
  bool mean = lbw_check_word(L, 3, hows) == 0;
  lbw_check_rows(L, 2, "values", value->rows, mesh->element_count, "element");
  double *weight = (double *)lua_newuserdatauv(L, (size_t)mesh->node_count * sizeof *weight + 1, 0);
  memset(weight, 0, (size_t)mesh->node_count * sizeof *weight);
  int64_t columns = value->columns;
  double *out = (double *)lbw_push_array(L, BW_F64, mesh->node_count, columns)->data;
  for (int64_t e = 0; e < mesh->element_count; e++)
    for (int a = 0; a < mesh->nodes_per_element; a++) {
      int32_t node = mesh->element[e * mesh->nodes_per_element + a];
      for (int64_t j = 0; j < columns; j++) {
        double v = bw_array_get(value, e, j), *at = &out[node * columns + j];
        if (mean)
          *at += mesh->volume[e] * v;
        else if (weight[node] == 0 || v > *at)
          *at = v;
      }
      weight[node] += mesh->volume[e];
    }
  for (int64_t i = 0; mean && i < mesh->node_count; i++)
    for (int64_t j = 0; j < columns; j++)
      out[i * columns + j] /= weight[i];
  return 1;
}

/* ---- properties ------------------------------------------------------------------------------ */

static int mesh_nodes(lua_State *L) {
  const bw_mesh *mesh = self(L);
  return lbw_push_borrowed(L, BW_F64, mesh->node_count, 3, mesh->node, mesh);
}

static int mesh_elements(lua_State *L) {
  const bw_mesh *mesh = self(L);
  return lbw_push_indices(L, mesh->element_count, mesh->nodes_per_element, mesh->element);
}

static int mesh_volumes(lua_State *L) {
  const bw_mesh *mesh = self(L);
  return lbw_push_borrowed(L, BW_F64, mesh->element_count, 1, mesh->volume, mesh);
}

static int compute_node_volumes(lua_State *L) {
  const bw_mesh *mesh = self(L);
  double *out = (double *)lbw_push_array(L, BW_F64, mesh->node_count, 1)->data;
  lbw_leave_or_raise(L, bw_lumped_mass(lbw_enter(L), mesh, NULL, out));
  return 1;
}

/* Every node's share of the volume (lumped mass of density 1): weights for values at nodes. */
static int mesh_node_volumes(lua_State *L) {
  return lbw_cached(L, "node_volumes", compute_node_volumes);
}

static int mesh_facets(lua_State *L) {
  const bw_mesh *mesh = self(L);
  return lbw_push_indices(L, mesh->facet_count, mesh->nodes_per_facet, mesh->facet);
}

static int mesh_facet_elements(lua_State *L) {
  const bw_mesh *mesh = self(L);
  return lbw_push_indices(L, mesh->facet_count, 1, mesh->facet_element);
}

static int mesh_neighbours(lua_State *L) {
  const bw_mesh *mesh = self(L);
  return lbw_push_indices(L, mesh->element_count, 4, mesh->neighbour);
}

static int mesh_components(lua_State *L) {
  const bw_mesh *mesh = self(L);
  return lbw_push_indices(L, mesh->node_count, 1, mesh->component);
}

LBW_PUSH(mesh_order, lua_pushinteger(L, self(L)->order))
LBW_PUSH(mesh_node_count, lua_pushinteger(L, self(L)->node_count))
LBW_PUSH(mesh_element_count, lua_pushinteger(L, self(L)->element_count))
LBW_PUSH(mesh_facet_count, lua_pushinteger(L, self(L)->facet_count))
LBW_PUSH(mesh_component_count, lua_pushinteger(L, self(L)->component_count))
LBW_PUSH(mesh_volume, lua_pushnumber(L, bw_mesh_volume(self(L))))

/* How far filling moved the surface. */
LBW_PUSH(mesh_surface_moved, lua_pushnumber(L, self(L)->surface_moved))

static int mesh_box(lua_State *L) {
  double min[3], max[3];
  bw_mesh_box(self(L), min, max);
  lbw_push_box(L, min, max);
  return 1;
}

static int mesh_boundary(lua_State *L) {
  const bw_mesh *mesh = self(L);
  lbw_box *box = lbw_box_new(L, &lbw_selection_class);
  bw_selection *all = NULL;
  bw_status status = bw_select_all(lbw_enter(L), mesh, &all);
  lbw_box_fill(L, box, all);
  lbw_leave_or_raise(L, status);
  return 1;
}

static int mesh_tostring(lua_State *L) {
  const bw_mesh *mesh = (const bw_mesh *)lbw_check(L, 1, &lbw_mesh_class);
  double min[3], max[3];
  bw_mesh_box(mesh, min, max);
  lbw_push_box_text(L, min, max);
  const char *box = lua_tostring(L, -1);
  const char *bodies = mesh->component_count > 1
                           ? lua_pushfstring(L, ", %d bodies", (int)mesh->component_count)
                           : "";
  const char *regions = lbw_region_text(L, mesh);
  char moved[96] = "";
  if (mesh->surface_moved > 0)
    snprintf(moved, sizeof moved, ", surface moved by up to %s",
             lbw_quantity(mesh->surface_moved, "m").text);
  lua_pushfstring(L, "mesh of %d tet%d and %d nodes, %s%s%s%s", (int)mesh->element_count,
                  mesh->nodes_per_element, (int)mesh->node_count, box, bodies, regions, moved);
  return 1;
}

static const luaL_Reg methods[] = {{"write", mesh_write},
                                   {"with_order", mesh_with_order},
                                   {"moved", mesh_moved},
                                   {"subset", mesh_subset},
                                   {"renumbered", mesh_renumbered},
                                   {"surface", mesh_surface},
                                   {"curved", lbw_mesh_curved},
                                   {"faces", lbw_mesh_faces},
                                   {"face_names", lbw_mesh_face_names},
                                   {"region", lbw_mesh_region},
                                   {"with_regions", lbw_mesh_with_regions},
                                   {"split", lbw_mesh_split},
                                   {"interface", lbw_mesh_interface},
                                   {"separated", lbw_mesh_separated},
                                   {"overlaps", lbw_mesh_overlaps},
                                   {"locate", mesh_locate},
                                   {"sample", mesh_sample},
                                   {"quality", mesh_quality},
                                   {"to_nodes", mesh_to_nodes},
                                   {NULL, NULL}};
static const luaL_Reg properties[] = {{"nodes", mesh_nodes},
                                      {"elements", mesh_elements},
                                      {"regions", lbw_mesh_regions},
                                      {"element_regions", lbw_mesh_element_regions},
                                      {"volumes", mesh_volumes},
                                      {"node_volumes", mesh_node_volumes},
                                      {"facets", mesh_facets},
                                      {"facet_elements", mesh_facet_elements},
                                      {"neighbours", mesh_neighbours},
                                      {"components", mesh_components},
                                      {"order", mesh_order},
                                      {"node_count", mesh_node_count},
                                      {"element_count", mesh_element_count},
                                      {"facet_count", mesh_facet_count},
                                      {"component_count", mesh_component_count},
                                      {"volume", mesh_volume},
                                      {"surface_moved", mesh_surface_moved},
                                      {"box", mesh_box},
                                      {"boundary", mesh_boundary},
                                      {NULL, NULL}};
static const luaL_Reg meta[] = {{"__tostring", mesh_tostring}, {NULL, NULL}};
const lbw_class lbw_mesh_class = {"mesh", methods, properties, meta, NULL};

static const luaL_Reg nothing[] = {{NULL, NULL}};
static const lbw_class locator_class = {"locator", nothing, nothing, NULL, NULL};

void lbw_open_mesh(lua_State *L) {
  static const luaL_Reg functions[] = {{"fill", mesh_fill},    {"fill_parts", mesh_fill_parts},
                                       {"read", mesh_read},    {"new", mesh_new},
                                       {"box", mesh_box_grid}, {NULL, NULL}};
  lbw_class_register(L, &lbw_mesh_class);
  lbw_class_register(L, &locator_class);
  lua_newtable(L);
  luaL_setfuncs(L, functions, 0);
  lua_setfield(L, -2, "mesh");
  lua_pushcfunction(L, lbw_polygon_triangles);
  lua_setfield(L, -2, "polygon_triangles");
  lua_pushcfunction(L, lbw_face_labels);
  lua_setfield(L, -2, "face_labels");
}
