/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* Selections on the boundary of a mesh: mesh.boundary and what is chosen from it.
 *
 * A geometric method chooses within the selection it is called on: foot:near(p, r) holds what lies
 * in foot and near p. An empty choice raises. */
#include "bind.h"
#include "formula/expression.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static const bw_selection *self(lua_State *L) {
  return (const bw_selection *)lbw_check(L, 1, &lbw_selection_class);
}

static bool is_all(const bw_selection *selection) {
  return selection->facet_count == selection->mesh->facet_count &&
         selection->node_count == selection->mesh->boundary_node_count;
}

/* Between lbw_enter and the end of a method: `chosen` on the whole boundary (or NULL with a failed
 * status) is cut down to the selection the method was called on. */
static int leave_within(lua_State *L, lbw_box *box, bw_context *context, bw_selection *chosen,
                        bw_status status) {
  const bw_selection *from = self(L);
  bw_selection *out = NULL;
  if (status == BW_OK && !is_all(from)) {
    status = bw_select_combine(context, from, chosen, BW_INTERSECTION, &out);
    bw_release(chosen);
  } else
    out = chosen;
  lbw_box_fill(L, box, status == BW_OK ? out : NULL);
  return lbw_leave(L, status, 1);
}

/* selection:below(axis, coordinate), selection:above(axis, coordinate) */
static int half_space(lua_State *L, double sign) {
  const bw_mesh *mesh = self(L)->mesh;
  int axis = lbw_check_axis(L, 2);
  double point[3] = {0, 0, 0}, normal[3] = {0, 0, 0};
  point[axis] = lbw_check_real(L, 3, "coordinate");
  normal[axis] = sign;
  lbw_box *box = lbw_box_new(L, &lbw_selection_class);
  bw_selection *chosen = NULL;
  bw_context *context = lbw_enter(L);
  bw_status status = bw_select_half_space(context, mesh, point, normal, 0, &chosen);
  return leave_within(L, box, context, chosen, status);
}

static int select_below(lua_State *L) {
  return half_space(L, 1);
}
static int select_above(lua_State *L) {
  return half_space(L, -1);
}

/* selection:box(min, max) */
static int select_box(lua_State *L) {
  const bw_mesh *mesh = self(L)->mesh;
  double min[3], max[3];
  lbw_check_vector(L, 2, "min", min);
  lbw_check_vector(L, 3, "max", max);
  lbw_box *box = lbw_box_new(L, &lbw_selection_class);
  bw_selection *chosen = NULL;
  bw_context *context = lbw_enter(L);
  bw_status status = bw_select_box(context, mesh, min, max, &chosen);
  return leave_within(L, box, context, chosen, status);
}

/* The tolerance of a plane that a user means exactly: rounding of coordinates read from a file. */
static double default_tolerance(const bw_mesh *mesh) {
  double min[3], max[3];
  bw_mesh_box(mesh, min, max);
  double size[3] = {max[0] - min[0], max[1] - min[1], max[2] - min[2]};
  return 1e-6 * bw_norm(size);
}

/* selection:plane(point, normal, tolerance): near the plane on both sides */
static int select_plane(lua_State *L) {
  const bw_mesh *mesh = self(L)->mesh;
  double point[3], normal[3];
  lbw_check_vector(L, 2, "point", point);
  lbw_check_vector(L, 3, "normal", normal);
  double tolerance =
      lua_isnoneornil(L, 4) ? default_tolerance(mesh) : lbw_check_real(L, 4, "tolerance");
  lbw_box *box = lbw_box_new(L, &lbw_selection_class);
  bw_selection *chosen = NULL;
  bw_context *context = lbw_enter(L);
  bw_status status = bw_select_plane(context, mesh, point, normal, tolerance, &chosen);
  return leave_within(L, box, context, chosen, status);
}

/* selection:beyond(point, normal): on the side the normal points to */
static int select_beyond(lua_State *L) {
  const bw_mesh *mesh = self(L)->mesh;
  double point[3], normal[3];
  lbw_check_vector(L, 2, "point", point);
  lbw_check_vector(L, 3, "normal", normal);
  for (int i = 0; i < 3; i++)
    normal[i] = -normal[i];
  lbw_box *box = lbw_box_new(L, &lbw_selection_class);
  bw_selection *chosen = NULL;
  bw_context *context = lbw_enter(L);
  bw_status status = bw_select_half_space(context, mesh, point, normal, 0, &chosen);
  return leave_within(L, box, context, chosen, status);
}

/* selection:near(point, radius), the same as selection:sphere(centre, radius) */
static int select_near(lua_State *L) {
  const bw_mesh *mesh = self(L)->mesh;
  double centre[3];
  lbw_check_vector(L, 2, "point", centre);
  double radius = lbw_check_real(L, 3, "radius");
  lbw_box *box = lbw_box_new(L, &lbw_selection_class);
  bw_selection *chosen = NULL;
  bw_context *context = lbw_enter(L);
  bw_status status = bw_select_sphere(context, mesh, centre, radius, &chosen);
  return leave_within(L, box, context, chosen, status);
}

/* selection:facing(direction, angle): facets whose outward normal is within the angle (radians,
 * 1e-3 when left out) */
static int select_facing(lua_State *L) {
  const bw_mesh *mesh = self(L)->mesh;
  double direction[3];
  lbw_check_vector(L, 2, "direction", direction);
  double angle = lua_isnoneornil(L, 3) ? 1e-3 : lbw_check_real(L, 3, "angle");
  lbw_box *box = lbw_box_new(L, &lbw_selection_class);
  bw_selection *chosen = NULL;
  bw_context *context = lbw_enter(L);
  bw_status status = bw_select_normal_cone(context, mesh, direction, angle, &chosen);
  return leave_within(L, box, context, chosen, status);
}

/* selection:patch(point, angle): what hangs together without an edge sharper than the angle */
static int select_patch(lua_State *L) {
  const bw_mesh *mesh = self(L)->mesh;
  double point[3];
  lbw_check_vector(L, 2, "point", point);
  double angle =
      lua_isnoneornil(L, 3) ? 30 * 3.14159265358979323846 / 180 : lbw_check_real(L, 3, "angle");
  lbw_box *box = lbw_box_new(L, &lbw_selection_class);
  bw_selection *chosen = NULL;
  bw_context *context = lbw_enter(L);
  bw_status status = bw_select_patch(context, mesh, point, angle, &chosen);
  return leave_within(L, box, context, chosen, status);
}

typedef struct distant {
  double distance;
  int32_t node;
} distant;

static int compare_distance(const void *a, const void *b) {
  const distant *x = (const distant *)a, *y = (const distant *)b;
  int order = (x->distance > y->distance) - (x->distance < y->distance);
  return order ? order : (x->node > y->node) - (x->node < y->node);
}

/* A mask of the `count` nodes of a selection nearest to a point, in a userdata that is pushed. */
static const uint8_t *nearest_mask(lua_State *L, const bw_selection *from, const double point[3],
                                   lua_Integer count) {
  const bw_mesh *mesh = from->mesh;
  distant *list = (distant *)lua_newuserdatauv(L, ((size_t)from->node_count + 1) * sizeof *list, 0);
  uint8_t *mask = (uint8_t *)lua_newuserdatauv(L, (size_t)mesh->node_count + 1, 0);
  memset(mask, 0, (size_t)mesh->node_count);
  for (int32_t i = 0; i < from->node_count; i++) {
    const double *at = mesh->node + 3 * (int64_t)from->node[i];
    double away[3] = {at[0] - point[0], at[1] - point[1], at[2] - point[2]};
    list[i] = (distant){bw_norm(away), from->node[i]};
  }
  qsort(list, (size_t)from->node_count, sizeof *list, compare_distance);
  for (int32_t i = 0; i < from->node_count && i < count; i++)
    mask[list[i].node] = 1;
  return mask;
}

/* selection:nearest(point, count): of its nodes */
static int select_nearest(lua_State *L) {
  const bw_selection *from = self(L);
  double point[3];
  lbw_check_vector(L, 2, "point", point);
  lua_Integer count = lbw_integer_or(L, 3, 1);
  lbw_argument_check(L, count >= 1 && count <= INT32_MAX, 3, "a count of 1 or more expected");
  lua_settop(L, 3);
  const uint8_t *mask = is_all(from) ? NULL : nearest_mask(L, from, point, count);
  lbw_box *box = lbw_box_new(L, &lbw_selection_class);
  bw_selection *chosen = NULL;
  bw_context *context = lbw_enter(L);
  bw_status status = mask ? bw_select_mask(context, from->mesh, NULL, mask, &chosen)
                          : bw_select_nearest(context, from->mesh, point, (int32_t)count, &chosen);
  return leave_within(L, box, context, chosen, status);
}

/* ---- where ----------------------------------------------------------------------------------- */

static uint8_t *mask_by_formula(lua_State *L, const bw_mesh *mesh, const char *text) {
  static const char *const names[3] = {"x", "y", "z"};
  lbw_variable variable[3];
  for (int i = 0; i < 3; i++)
    variable[i] = (lbw_variable){.name = names[i],
                                 .type = BW_F64,
                                 .rows = mesh->node_count,
                                 .columns = 1,
                                 .row_stride = 3 * sizeof(double),
                                 .data = mesh->node + i};
  lbw_expression formula;
  char error[256];
  if (!lbw_expression_compile(text, variable, 3, &formula, error, sizeof error))
    lbw_error(L, "where: %s", error);
  uint8_t *mask = (uint8_t *)lua_newuserdatauv(L, (size_t)mesh->node_count + 1, 0);
  double block[LBW_BLOCK];
  for (int64_t first = 0; first < mesh->node_count; first += LBW_BLOCK) {
    int count = (int)(mesh->node_count - first < LBW_BLOCK ? mesh->node_count - first : LBW_BLOCK);
    lbw_expression_block(&formula, first, count, 0, block);
    for (int i = 0; i < count; i++)
      mask[first + i] = block[i] != 0;
  }
  return mask;
}

static uint8_t *mask_by_function(lua_State *L, const bw_mesh *mesh, int function) {
  uint8_t *mask = (uint8_t *)lua_newuserdatauv(L, (size_t)mesh->node_count + 1, 0);
  memset(mask, 0, (size_t)mesh->node_count);
  lbw_push(L, &lbw_mesh_class, mesh); /* whatever the function closes, the mesh stays */
  for (int32_t i = 0; i < mesh->boundary_node_count; i++) {
    int32_t node = mesh->boundary_node[i];
    lua_pushvalue(L, function);
    for (int k = 0; k < 3; k++)
      lua_pushnumber(L, mesh->node[3 * (int64_t)node + k]);
    lua_call(L, 3, 1);
    mask[node] = lua_toboolean(L, -1);
    lua_pop(L, 1);
  }
  return mask;
}

/* selection:where(predicate): a formula in x, y, z ("x^2 + y^2 < 1e-4"), a mask over facets or
 * nodes, or a function of x, y, z called once for every boundary node */
static int select_where(lua_State *L) {
  const bw_mesh *mesh = self(L)->mesh;
  const uint8_t *nodes = NULL, *facets = NULL;
  lua_settop(L, 2);
  bool predicate = !lbw_test(L, 2, &lbw_array_class); /* asks for a place, not for single nodes */
  if (lua_type(L, 2) == LUA_TSTRING)
    nodes = mask_by_formula(L, mesh, lua_tostring(L, 2));
  else if (lua_isfunction(L, 2))
    nodes = mask_by_function(L, mesh, 2);
  else {
    const bw_array *mask = (const bw_array *)lbw_test(L, 2, &lbw_array_class);
    lbw_argument_check(L, mask, 2,
                       "predicate: a formula, a mask over nodes or facets, or a function expected");
    if (mask->rows == mesh->facet_count && mask->rows != mesh->node_count)
      facets = lbw_to_mask(L, 2, "mask over facets", mesh->facet_count);
    else
      nodes = lbw_to_mask(L, 2, "mask over nodes", mesh->node_count);
  }
  mesh = self(L)->mesh;
  lbw_box *box = lbw_box_new(L, &lbw_selection_class);
  bw_selection *chosen = NULL;
  bw_context *context = lbw_enter(L);
  bw_status status = bw_select_mask(context, mesh, facets, nodes, &chosen);
  if (status == BW_OK && predicate)
    chosen->node_set = false;
  return leave_within(L, box, context, chosen, status);
}

/* selection:region(name): facets of the region's elements */
static int select_region(lua_State *L) {
  const bw_mesh *mesh = self(L)->mesh;
  int32_t region = lbw_check_region(L, 2, mesh);
  lbw_box *box = lbw_box_new(L, &lbw_selection_class);
  bw_selection *chosen = NULL;
  bw_context *context = lbw_enter(L);
  bw_status status = bw_select_region(context, mesh, region, &chosen);
  return leave_within(L, box, context, chosen, status);
}

/* ---- sets ------------------------------------------------------------------------------------ */

static int combine(lua_State *L, bw_set_operation operation) {
  const bw_selection *a = self(L);
  const bw_selection *b = (const bw_selection *)lbw_check(L, 2, &lbw_selection_class);
  lbw_argument_check(L, a->mesh == b->mesh, 2, "both selections must be of the same mesh");
  lbw_box *box = lbw_box_new(L, &lbw_selection_class);
  bw_selection *out = NULL;
  bw_status status = bw_select_combine(lbw_enter(L), a, b, operation, &out);
  return lbw_leave_object(L, box, out, status);
}

static int select_union(lua_State *L) {
  return combine(L, BW_UNION);
}
static int select_intersection(lua_State *L) {
  return combine(L, BW_INTERSECTION);
}
static int select_difference(lua_State *L) {
  return combine(L, BW_DIFFERENCE);
}

/* selection:node_set(): the same, for supports on points and edges */
static int select_node_set(lua_State *L) {
  const bw_selection *from = self(L);
  lbw_box *box = lbw_box_new(L, &lbw_selection_class);
  bw_selection *out = NULL;
  bw_status status = bw_select_node_set(lbw_enter(L), from, &out);
  return lbw_leave_object(L, box, out, status);
}

/* ---- properties ------------------------------------------------------------------------------ */

static int selection_nodes(lua_State *L) {
  const bw_selection *selection = self(L);
  return lbw_push_indices(L, selection->node_count, 1, selection->node);
}

static int selection_facets(lua_State *L) {
  const bw_selection *selection = self(L);
  return lbw_push_indices(L, selection->facet_count, 1, selection->facet);
}

LBW_PUSH(selection_node_count, lua_pushinteger(L, self(L)->node_count))
LBW_PUSH(selection_facet_count, lua_pushinteger(L, self(L)->facet_count))
LBW_PUSH(selection_area, lua_pushnumber(L, bw_selection_area(self(L))))

static int selection_centre(lua_State *L) {
  double centre[3];
  bw_selection_centre(self(L), centre);
  lbw_push_vector(L, centre);
  return 1;
}

static int selection_normal(lua_State *L) {
  double normal[3];
  bw_selection_normal(self(L), normal);
  lbw_push_vector(L, normal);
  return 1;
}

LBW_PUSH(selection_mesh, lbw_push(L, &lbw_mesh_class, self(L)->mesh))

static int selection_tostring(lua_State *L) {
  const bw_selection *selection = (const bw_selection *)lbw_check(L, 1, &lbw_selection_class);
  double centre[3];
  bw_selection_centre(selection, centre);
  char text[160];
  snprintf(text, sizeof text, "selection of %d facets and %d nodes, %s about %s",
           (int)selection->facet_count, (int)selection->node_count,
           lbw_quantity(bw_selection_area(selection), "m2").text, lbw_point(centre).text);
  lua_pushstring(L, text);
  return 1;
}

static const luaL_Reg methods[] = {{"below", select_below},
                                   {"above", select_above},
                                   {"box", select_box},
                                   {"plane", select_plane},
                                   {"beyond", select_beyond},
                                   {"near", select_near},
                                   {"sphere", select_near},
                                   {"facing", select_facing},
                                   {"patch", select_patch},
                                   {"nearest", select_nearest},
                                   {"where", select_where},
                                   {"region", select_region},
                                   {"face", lbw_selection_face},
                                   {"node_set", select_node_set},
                                   {"union", select_union},
                                   {"intersection", select_intersection},
                                   {"difference", select_difference},
                                   {NULL, NULL}};
static const luaL_Reg properties[] = {{"nodes", selection_nodes},
                                      {"facets", selection_facets},
                                      {"node_count", selection_node_count},
                                      {"facet_count", selection_facet_count},
                                      {"area", selection_area},
                                      {"centre", selection_centre},
                                      {"normal", selection_normal},
                                      {"mesh", selection_mesh},
                                      {NULL, NULL}};
static const luaL_Reg meta[] = {{"__bor", select_union},
                                {"__band", select_intersection},
                                {"__sub", select_difference},
                                {"__tostring", selection_tostring},
                                {NULL, NULL}};
const lbw_class lbw_selection_class = {"selection", methods, properties, meta, NULL};

void lbw_open_selection(lua_State *L) {
  lbw_class_register(L, &lbw_selection_class);
}
