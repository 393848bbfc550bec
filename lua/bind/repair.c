/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* What an edit does to a mesh and to the model on it: quality of elements at moved nodes, relaxing,
 * refilling, supports and loads that go along. These are methods of meshes and models. */
#include "bind.h"

#include <string.h>

static const bw_mesh *check_mesh(lua_State *L) {
  return (const bw_mesh *)lbw_check(L, 1, &lbw_mesh_class);
}

/* The positions at `argument`, a row for every node, in a userdata that is pushed. */
static double *check_nodes(lua_State *L, int argument, const bw_mesh *mesh) {
  int64_t rows;
  double *node = lbw_to_doubles(L, argument, "nodes", 3, &rows);
  lbw_check_rows(L, argument, "nodes", rows, mesh->node_count, "node");
  return node;
}

static int push_report(lua_State *L, const bw_mesh_repair_report *report) {
  lua_createtable(L, 0, 6);
  lua_pushinteger(L, report->inverted);
  lua_setfield(L, -2, "inverted");
  lua_pushinteger(L, (lua_Integer)report->worst + 1);
  lua_setfield(L, -2, "worst");
  lua_pushnumber(L, report->worst_before);
  lua_setfield(L, -2, "worst_before");
  lua_pushnumber(L, report->worst_after);
  lua_setfield(L, -2, "worst_after");
  lua_pushinteger(L, report->moved);
  lua_setfield(L, -2, "moved");
  lua_pushinteger(L, report->iterations);
  lua_setfield(L, -2, "iterations");
  return 1;
}

/* mesh:shapes(nodes): the mean ratio quality of every element, of the mesh's own nodes or others */
static int mesh_shapes(lua_State *L) {
  const bw_mesh *mesh = check_mesh(L);
  lua_settop(L, 2);
  const double *node = lua_isnil(L, 2) ? mesh->node : check_nodes(L, 2, mesh);
  double *out = (double *)lbw_push_array(L, BW_F64, mesh->element_count, 1)->data;
  for (int64_t e = 0; e < mesh->element_count; e++) {
    const int32_t *corner = mesh->element + e * mesh->nodes_per_element;
    out[e] = bw_shape_quality(node + 3 * (int64_t)corner[0], node + 3 * (int64_t)corner[1],
                              node + 3 * (int64_t)corner[2], node + 3 * (int64_t)corner[3]);
  }
  return 1;
}

/* mesh:shape_check(nodes, floor): how many elements are inverted or poorer than the floor, and the
 * worst */
static int mesh_shape_check(lua_State *L) {
  const bw_mesh *mesh = check_mesh(L);
  double floor = lua_isnoneornil(L, 3) ? 0 : lbw_check_real(L, 3, "floor");
  const double *node = check_nodes(L, 2, mesh);
  bw_mesh_repair_report report;
  memset(&report, 0, sizeof report);
  bw_mesh_shape_check(mesh, node, floor, &report);
  return push_report(L, &report);
}

/* mesh:relax(nodes, mask of those that may move): nodes, report */
static int mesh_relax(lua_State *L) {
  const bw_mesh *mesh = check_mesh(L);
  const double *node = check_nodes(L, 2, mesh);
  const uint8_t *may_move = lbw_to_mask(L, 3, "mask", mesh->node_count);
  double *out = (double *)lbw_push_array(L, BW_F64, mesh->node_count, 3)->data;
  memcpy(out, node, 3 * (size_t)mesh->node_count * sizeof *out);
  bw_mesh_repair_report report;
  memset(&report, 0, sizeof report);
  bw_status status = bw_mesh_relax(lbw_enter(L), mesh, may_move, out, &report);
  if (status != BW_OK)
    return lbw_leave(L, status, 1);
  lbw_leave_or_raise(L, BW_OK);
  push_report(L, &report);
  return 2;
}

/* mesh:refill(nodes, mask of elements): mesh, the old node of every node (0: new), the old element
 * of every element (negative: the number of its component) */
static int mesh_refill(lua_State *L) {
  const bw_mesh *mesh = check_mesh(L);
  const double *node = check_nodes(L, 2, mesh);
  const uint8_t *replace = lbw_to_mask(L, 3, "mask", mesh->element_count);
  lbw_box *box = lbw_box_new(L, &lbw_mesh_class);
  lbw_box *nodes = lbw_box_new(L, &lbw_array_class);
  lbw_box *elements = lbw_box_new(L, &lbw_array_class);
  bw_mesh *refilled = NULL;
  int32_t *node_from = NULL, *element_from = NULL;
  bw_array *node_array = NULL, *element_array = NULL;
  bw_status status;
  bw_context *context = lbw_enter(L);
  BW_TRY(bw_mesh_refill(context, mesh, node, replace, &refilled, &node_from, &element_from));
  for (int32_t i = 0; i < refilled->node_count; i++)
    node_from[i]++;
  for (int32_t e = 0; e < refilled->element_count; e++)
    element_from[e] += element_from[e] >= 0;
  BW_TRY(bw_array_adopt(context, BW_I32, refilled->node_count, 1, node_from, &node_array));
  node_from = NULL;
  BW_TRY(bw_array_adopt(context, BW_I32, refilled->element_count, 1, element_from, &element_array));
  element_from = NULL;
done:
  bw_free(node_from);
  bw_free(element_from);
  nodes->object = node_array;
  elements->object = element_array;
  if (status != BW_OK) {
    bw_release(refilled);
    refilled = NULL;
  }
  lbw_box_fill(L, box, refilled);
  if (node_array)
    lbw_box_account(L, nodes);
  if (element_array)
    lbw_box_account(L, elements);
  return lbw_leave(L, status, 3);
}

/* model:moved(mesh): the same supports and loads on a mesh of the same topology */
static int model_moved(lua_State *L) {
  const bw_model *model = (const bw_model *)lbw_check(L, 1, &lbw_model_class);
  const bw_mesh *mesh = (const bw_mesh *)lbw_check(L, 2, &lbw_mesh_class);
  lbw_box *box = lbw_box_new(L, &lbw_model_class);
  bw_model *out = NULL;
  bw_status status = bw_model_moved(lbw_enter(L), model, mesh, &out);
  return lbw_leave_object(L, box, out, status);
}

/* model:transferred(mesh, the old node of every node): on a refilled mesh */
static int model_transferred(lua_State *L) {
  const bw_model *model = (const bw_model *)lbw_check(L, 1, &lbw_model_class);
  const bw_mesh *mesh = (const bw_mesh *)lbw_check(L, 2, &lbw_mesh_class);
  const bw_array *from = lbw_check_array(L, 3, "node_from");
  lbw_check_rows(L, 3, "node_from", from->rows, mesh->node_count, "node");
  lbw_argument_check(L, from->columns == 1, 3, "node_from: an array of one column expected");
  int32_t *node_from =
      (int32_t *)lua_newuserdatauv(L, ((size_t)from->rows + 1) * sizeof *node_from, 0);
  for (int64_t i = 0; i < from->rows; i++) {
    double old = bw_array_get(from, i, 0);
    lbw_argument_check(L, old >= 0 && old <= model->mesh->node_count, 3,
                       "node_from: numbers of the model's nodes, 0 for new ones, expected");
    node_from[i] = (int32_t)old - 1;
  }
  lbw_box *box = lbw_box_new(L, &lbw_model_class);
  bw_model *out = NULL;
  bw_status status = bw_model_transferred(lbw_enter(L), model, mesh, node_from, &out);
  return lbw_leave_object(L, box, out, status);
}

void lbw_open_repair(lua_State *L) {
  static const luaL_Reg of_mesh[] = {{"shapes", mesh_shapes},
                                     {"shape_check", mesh_shape_check},
                                     {"relax", mesh_relax},
                                     {"refill", mesh_refill},
                                     {NULL, NULL}};
  static const luaL_Reg of_model[] = {
      {"moved", model_moved}, {"transferred", model_transferred}, {NULL, NULL}};
  lbw_add_methods(L, &lbw_mesh_class, of_mesh);
  lbw_add_methods(L, &lbw_model_class, of_model);
}
