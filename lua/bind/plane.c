/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* bw.plane: triangle meshes of outlines. What follows an outline is in mesh_motion.c. */
#include "bind.h"
#include "follow.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

static const bw_plane_mesh *self(lua_State *L) {
  return (const bw_plane_mesh *)lbw_check(L, 1, &lbw_plane_mesh_class);
}

/* ---- making ---------------------------------------------------------------------------------- */

static double field_value(void *data, const double at[2]) {
  double place[3] = {at[0], at[1], 0};
  return lbw_field_value(data, place);
}

void lbw_read_plane_options(lua_State *L, int index, const char *function,
                            bw_plane_options *options, lbw_field **field) {
  static const lbw_option list[] = {
      {"order", LBW_INT, offsetof(bw_plane_options, order)},
      {"size", LBW_REAL, offsetof(bw_plane_options, size)},
      {"elements", LBW_INT, offsetof(bw_plane_options, elements)},
      {"minimum_angle", LBW_REAL, offsetof(bw_plane_options, minimum_angle)},
      {"curvature", LBW_REAL, offsetof(bw_plane_options, curvature)},
      {"limit", LBW_INT, offsetof(bw_plane_options, limit)},
      {"time_limit", LBW_REAL, offsetof(bw_plane_options, time_limit)},
      {"memory_limit", LBW_REAL, offsetof(bw_plane_options, memory_limit)},
      {"field", LBW_OTHER, 0},
      {NULL, LBW_OTHER, 0}};
  lbw_options(L, index, function, list, options);
  lbw_check_one_size(L, index, function, "size");
  lbw_check_one_size(L, index, function, "field");
  *field = NULL;
  if (lua_istable(L, index) && lbw_option_get(L, index, "field") != LUA_TNIL) {
    *field = lbw_field_read(L, -1, function); /* the value stays below it */
    options->field = field_value;
    options->field_data = *field;
  } else {
    lua_pushnil(L);
  }
}

/* plane.fill(outline, options) */
static int plane_fill(lua_State *L) {
  const bw_outline *outline = (const bw_outline *)lbw_check(L, 1, &lbw_outline_class);
  bw_plane_options options;
  bw_plane_options_default(&options);
  lbw_field *field;
  lua_settop(L, 2);
  lbw_read_plane_options(L, 2, "plane.fill", &options, &field);
  lbw_box *box = lbw_box_new(L, &lbw_plane_mesh_class);
  bw_plane_mesh *out = NULL;
  bw_context *context = lbw_enter(L);
  if (field)
    lbw_field_begin(field, context);
  bw_status status = bw_plane_fill(context, outline, &options, &out);
  if (field)
    lbw_field_end(field, context);
  return lbw_leave_object(L, box, out, status);
}

/* plane.new{points, elements, regions, order}: its boundary becomes the outline; with outline,
 * edges (0: inside) and parameters, nodes lie on that. */
static int plane_new(lua_State *L) {
  static const lbw_option list[] = {{"points", LBW_OTHER, 0},  {"elements", LBW_OTHER, 0},
                                    {"regions", LBW_OTHER, 0}, {"outline", LBW_OTHER, 0},
                                    {"edges", LBW_OTHER, 0},   {"parameters", LBW_OTHER, 0},
                                    {"order", LBW_INT, 0},     {NULL, LBW_OTHER, 0}};
  lbw_check_type(L, 1, LUA_TTABLE);
  lua_settop(L, 1);
  int order = 1;
  lbw_options(L, 1, "plane.new", list, &order);
  if (order != 1 && order != 2)
    return lbw_error(L, "plane.new: option 'order': 1 or 2 expected, got %d", order);
  int64_t nodes, elements, rows;
  lbw_option_get(L, 1, "points");
  double *point = lbw_to_doubles(L, -1, "plane.new: points", 2, &nodes);
  lbw_option_get(L, 1, "elements");
  int32_t *element = lbw_to_indices(L, -1, "plane.new: elements", order == 1 ? 3 : 6, &elements);
  int32_t *region = NULL, *segment = NULL;
  double *parameter = NULL;
  if (nodes > INT32_MAX || elements > INT32_MAX / 6)
    return lbw_error(L, "plane.new: too many nodes or elements");
  if (lbw_option_get(L, 1, "regions") != LUA_TNIL) {
    region = lbw_to_indices(L, -1, "plane.new: regions", 1, &rows);
    lbw_require_rows(L, "plane.new: regions", rows, elements, "element");
  }
  const bw_outline *outline = NULL;
  if (lbw_option_get(L, 1, "outline") != LUA_TNIL) {
    outline = (const bw_outline *)lbw_test(L, -1, &lbw_outline_class);
    if (!outline)
      return lbw_option_refused(L, "plane.new", "outline", "an outline");
    lbw_option_get(L, 1, "edges");
    double *edge = lbw_to_doubles(L, -1, "plane.new: edges", 1, &rows);
    lbw_require_rows(L, "plane.new: edges", rows, nodes, "point");
    segment = (int32_t *)lua_newuserdatauv(L, (size_t)(nodes + 1) * sizeof *segment, 0);
    for (int64_t i = 0; i < nodes; i++) {
      if (!(edge[i] >= 0 && edge[i] <= outline->segment_count && edge[i] == floor(edge[i])))
        return lbw_error(
            L, "plane.new: edges: point %d: a number from 0 (inside) to %d expected, got %s",
            (int)i + 1, (int)outline->segment_count, lbw_quantity(edge[i], "").text);
      segment[i] = (int32_t)edge[i] - 1;
    }
    lbw_option_get(L, 1, "parameters");
    parameter = lbw_to_doubles(L, -1, "plane.new: parameters", 1, &rows);
    lbw_require_rows(L, "plane.new: parameters", rows, nodes, "point");
  }
  lbw_box *box = lbw_box_new(L, &lbw_plane_mesh_class);
  bw_plane_mesh *out = NULL;
  bw_context *context = lbw_enter(L);
  bw_status status = outline
                         ? bw_plane_mesh_on(context, outline, order, (int32_t)nodes, point, segment,
                                            parameter, (int32_t)elements, element, region, &out)
                         : bw_plane_mesh_copy(context, order, (int32_t)nodes, point,
                                              (int32_t)elements, element, region, &out);
  return lbw_leave_object(L, box, out, status);
}

/* plane.rectangle{min, max, cells = {nx, ny}, order, diagonal} */
static int plane_rectangle(lua_State *L) {
  static const lbw_option list[] = {{"min", LBW_OTHER, 0},   {"max", LBW_OTHER, 0},
                                    {"cells", LBW_OTHER, 0}, {"diagonal", LBW_OTHER, 0},
                                    {"order", LBW_INT, 0},   {NULL, LBW_OTHER, 0}};
  static const char *const diagonals[] = {"right", "left", "union jack", NULL};
  double min[2] = {0, 0}, max[2] = {1, 1}, cells[2] = {1, 1};
  double *const pair[3] = {min, max, cells};
  int order = 1;
  lbw_check_type(L, 1, LUA_TTABLE);
  lbw_options(L, 1, "plane.rectangle", list, &order);
  for (int i = 0; i < 3; i++)
    if (lbw_option_get(L, 1, list[i].key) != LUA_TNIL)
      lbw_check_pair(L, -1, list[i].key, pair[i]);
  for (int i = 0; i < 2; i++)
    if (cells[i] != floor(cells[i]) || cells[i] < 1 || cells[i] > 1e6)
      return lbw_error(
          L, "plane.rectangle: option 'cells': two whole numbers above 0 expected, got %s",
          lbw_quantity(cells[i], "").text);
  int diagonal = lbw_word_option(L, 1, "plane.rectangle", "diagonal", diagonals, 0);
  lbw_box *box = lbw_box_new(L, &lbw_plane_mesh_class);
  bw_plane_mesh *out = NULL;
  bw_status status = bw_plane_rectangle(lbw_enter(L), order, min, max, (int32_t)cells[0],
                                        (int32_t)cells[1], (bw_diagonal)diagonal, &out);
  return lbw_leave_object(L, box, out, status);
}

/* mesh:moved(outline, points) */
static int plane_moved(lua_State *L) {
  const bw_plane_mesh *mesh = self(L);
  const bw_outline *outline = (const bw_outline *)lbw_check(L, 2, &lbw_outline_class);
  int64_t rows;
  double *point = lbw_to_doubles(L, 3, "points", 2, &rows);
  lbw_check_rows(L, 3, "points", rows, mesh->topology->nodes->node_count, "node");
  lbw_box *box = lbw_box_new(L, &lbw_plane_mesh_class);
  bw_plane_mesh *out = NULL;
  bw_status status = bw_plane_mesh_moved(lbw_enter(L), mesh, outline, point, &out);
  return lbw_leave_object(L, box, out, status);
}

/* ---- fields, places, files ------------------------------------------------------------------- */

/* mesh:transfer(to, values): values at the nodes of `to` */
static int plane_transfer(lua_State *L) {
  const bw_plane_mesh *from = self(L);
  const bw_plane_mesh *to = (const bw_plane_mesh *)lbw_check(L, 2, &lbw_plane_mesh_class);
  int64_t rows;
  const bw_array *given = lbw_check_array(L, 3, "values");
  lbw_check_rows(L, 3, "values", given->rows, from->topology->nodes->node_count, "node");
  int components = (int)given->columns;
  double *value = lbw_to_doubles(L, 3, "values", 0, &rows);
  bw_array *transferred = lbw_push_array(L, BW_F64, to->topology->nodes->node_count, components);
  bw_status status =
      bw_plane_transfer(lbw_enter(L), from, to, components, value, (double *)transferred->data);
  return lbw_leave(L, status, 1);
}

typedef struct locator_box {
  bw_plane_locator *locator;
} locator_box;

static int free_locator(lua_State *L) {
  locator_box *held = (locator_box *)lua_touserdata(L, 1);
  bw_plane_locator_destroy(held->locator);
  held->locator = NULL;
  return 0;
}

static int make_locator(lua_State *L) {
  const bw_plane_mesh *mesh = self(L);
  locator_box *held = (locator_box *)lua_newuserdatauv(L, sizeof *held, 0);
  held->locator = NULL;
  if (luaL_newmetatable(L, "barwright.plane_locator")) {
    lua_pushcfunction(L, free_locator);
    lua_setfield(L, -2, "__gc");
  }
  lua_setmetatable(L, -2);
  bw_status status = bw_plane_locator_create(lbw_enter(L), mesh, &held->locator);
  lbw_leave_or_raise(L, status);
  return 1;
}

/* mesh:locate({x, y}): element, barycentric coordinates, distance when outside (0: inside) */
static int plane_locate(lua_State *L) {
  double at[2], weight[3] = {0, 0, 0}, outside = 0;
  self(L);
  lbw_check_pair(L, 2, "locate", at);
  lua_settop(L, 2);
  lbw_cached(L, "locator", make_locator);
  locator_box *held = (locator_box *)lua_touserdata(L, -1);
  int32_t element = bw_plane_locate(held->locator, at, weight, &outside);
  lua_pushinteger(L, (lua_Integer)element + 1);
  lua_createtable(L, 3, 0);
  for (int i = 0; i < 3; i++) {
    lua_pushnumber(L, weight[i]);
    lua_rawseti(L, -2, i + 1);
  }
  lua_pushnumber(L, outside);
  return 3;
}

/* mesh:write(path, {fields}) */
static int plane_write(lua_State *L) {
  static const lbw_option list[] = {{"fields", LBW_OTHER, 0}, {NULL, LBW_OTHER, 0}};
  const bw_plane_mesh *mesh = self(L);
  const char *path = lbw_check_text(L, 2, NULL);
  size_t length = strlen(path);
  lbw_argument_check(L, length > 4 && !strcmp(path + length - 4, ".vtu"), 2,
                     "a path that ends in .vtu expected");
  lua_settop(L, 3);
  lbw_options(L, 3, "write", list, NULL);
  lbw_option_get(L, 3, "fields");
  int count;
  bw_field *field = lbw_fields(L, -1, "write", mesh->topology->nodes->node_count,
                               mesh->topology->element_count, &count);
  bw_status status = bw_plane_write_vtu(lbw_enter(L), mesh, path, count, field);
  lua_pushboolean(L, 1);
  return lbw_leave(L, status, 1);
}

/* ---- what it is ------------------------------------------------------------------------------ */

void lbw_push_plane_quality(lua_State *L, const bw_plane_mesh *mesh) {
  bw_plane_quality q;
  bw_plane_measure(mesh, &q);
  lua_createtable(L, 0, 7);
  lua_pushnumber(L, q.worst);
  lua_setfield(L, -2, "worst");
  lua_pushinteger(L, (lua_Integer)q.worst_element + 1);
  lua_setfield(L, -2, "worst_element");
  lua_pushnumber(L, q.mean);
  lua_setfield(L, -2, "mean");
  lua_pushnumber(L, q.smallest_angle);
  lua_setfield(L, -2, "smallest_angle");
  lua_pushnumber(L, q.largest_angle);
  lua_setfield(L, -2, "largest_angle");
  lua_pushnumber(L, q.area);
  lua_setfield(L, -2, "area");
  lua_pushinteger(L, q.inverted);
  lua_setfield(L, -2, "inverted");
}

LBW_PUSH(plane_quality, lbw_push_plane_quality(L, self(L)))

static int plane_element_quality(lua_State *L) {
  const bw_plane_mesh *mesh = self(L);
  int32_t count = mesh->topology->element_count;
  double *out = (double *)lbw_push_array(L, BW_F64, count, 1)->data;
  for (int32_t e = 0; e < count; e++)
    out[e] = bw_plane_element_quality(mesh, e);
  return 1;
}

static int plane_points(lua_State *L) {
  const bw_plane_mesh *mesh = self(L);
  return lbw_push_borrowed(L, BW_F64, mesh->topology->nodes->node_count, 2, mesh->point, mesh);
}

static int plane_elements(lua_State *L) {
  const bw_plane_topology *t = self(L)->topology;
  return lbw_push_indices(L, t->element_count, t->nodes->order == 2 ? 6 : 3, t->element);
}

static int plane_regions(lua_State *L) {
  const bw_plane_topology *t = self(L)->topology;
  return lbw_push_indices(L, t->element_count, 1, t->region);
}

static int plane_neighbours(lua_State *L) {
  const bw_plane_topology *t = self(L)->topology;
  return lbw_push_indices(L, t->element_count, 3, t->neighbour);
}

static int plane_sides(lua_State *L) {
  const bw_plane_topology *t = self(L)->topology;
  return lbw_push_indices(L, t->side_count, t->nodes->order == 2 ? 3 : 2, t->side);
}

static int plane_side_elements(lua_State *L) {
  const bw_plane_topology *t = self(L)->topology;
  return lbw_push_indices(L, t->side_count, 2, t->side_element);
}

static int plane_side_edges(lua_State *L) {
  const bw_plane_topology *t = self(L)->topology;
  return lbw_push_indices(L, t->side_count, 1, t->side_segment);
}

static int plane_node_edges(lua_State *L) {
  const bw_plane_nodes *nodes = self(L)->topology->nodes;
  return lbw_push_indices(L, nodes->node_count, 1, nodes->segment);
}

static int plane_node_parameters(lua_State *L) {
  const bw_plane_nodes *nodes = self(L)->topology->nodes;
  return lbw_push_borrowed(L, BW_F64, nodes->node_count, 1, nodes->parameter, nodes);
}

LBW_PUSH(plane_order, lua_pushinteger(L, self(L)->topology->nodes->order))
LBW_PUSH(plane_node_count, lua_pushinteger(L, self(L)->topology->nodes->node_count))
LBW_PUSH(plane_corner_count, lua_pushinteger(L, self(L)->topology->nodes->corner_count))
LBW_PUSH(plane_element_count, lua_pushinteger(L, self(L)->topology->element_count))
LBW_PUSH(plane_outline, lbw_push(L, &lbw_outline_class, self(L)->outline))

/* mesh:shares(other): "topology", "nodes" or nil */
static int plane_shares(lua_State *L) {
  const bw_plane_topology *a = self(L)->topology;
  const bw_plane_topology *b =
      ((const bw_plane_mesh *)lbw_check(L, 2, &lbw_plane_mesh_class))->topology;
  if (a == b)
    lua_pushliteral(L, "topology");
  else if (a->nodes == b->nodes)
    lua_pushliteral(L, "nodes");
  else
    lua_pushnil(L);
  return 1;
}

static int plane_tostring(lua_State *L) {
  const bw_plane_mesh *mesh = (const bw_plane_mesh *)lbw_check(L, 1, &lbw_plane_mesh_class);
  bw_plane_quality q;
  char text[160];
  bw_plane_measure(mesh, &q);
  snprintf(text, sizeof text, "plane mesh: %d triangles of order %d, %d nodes, worst quality %.2f",
           mesh->topology->element_count, mesh->topology->nodes->order,
           mesh->topology->nodes->node_count, q.worst);
  lua_pushstring(L, text);
  return 1;
}

/* With topology and nodes, which the meshes of a mesh motion share: they count more than once. */
static size_t plane_bytes(const void *object) {
  const bw_plane_mesh *mesh = (const bw_plane_mesh *)object;
  return bw_bytes(mesh) + bw_bytes(mesh->topology) + bw_bytes(mesh->topology->nodes);
}

static const luaL_Reg methods[] = {{"moved", plane_moved},   {"transfer", plane_transfer},
                                   {"locate", plane_locate}, {"write", plane_write},
                                   {"shares", plane_shares}, {NULL, NULL}};
static const luaL_Reg properties[] = {{"points", plane_points},
                                      {"elements", plane_elements},
                                      {"regions", plane_regions},
                                      {"neighbours", plane_neighbours},
                                      {"sides", plane_sides},
                                      {"side_elements", plane_side_elements},
                                      {"side_edges", plane_side_edges},
                                      {"node_edges", plane_node_edges},
                                      {"node_parameters", plane_node_parameters},
                                      {"order", plane_order},
                                      {"node_count", plane_node_count},
                                      {"corner_count", plane_corner_count},
                                      {"element_count", plane_element_count},
                                      {"outline", plane_outline},
                                      {"quality", plane_quality},
                                      {"element_quality", plane_element_quality},
                                      {NULL, NULL}};
static const luaL_Reg meta[] = {{"__tostring", plane_tostring}, {NULL, NULL}};
const lbw_class lbw_plane_mesh_class = {"plane_mesh", methods, properties, meta, plane_bytes};

void lbw_open_plane(lua_State *L) {
  static const luaL_Reg functions[] = {
      {"fill", plane_fill}, {"new", plane_new}, {"rectangle", plane_rectangle}, {NULL, NULL}};
  lbw_class_register(L, &lbw_plane_mesh_class);
  lua_newtable(L);
  luaL_setfuncs(L, functions, 0);
  lua_setfield(L, -2, "plane");
}
