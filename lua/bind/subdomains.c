/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* Skinning weights, and a mesh cut into subdomains along a skeleton. subdomains[i] is a table about
 * the i-th subdomain. */
#include "bind.h"

#include <stdio.h>
#include <string.h>

static const bw_subdomains *self(lua_State *L) {
  return (const bw_subdomains *)lbw_check(L, 1, &lbw_subdomains_class);
}

static const bw_skeleton *check_skeleton(lua_State *L, int argument) {
  return (const bw_skeleton *)lbw_check(L, argument, &lbw_skeleton_class);
}

/* skinning_weights(mesh, skeleton, {heat}): a row for every node, a column for every bone */
static int core_skinning_weights(lua_State *L) {
  static const lbw_option list[] = {{"heat", LBW_REAL, offsetof(bw_weights_options, heat)},
                                    {NULL, LBW_OTHER, 0}};
  const bw_mesh *mesh = (const bw_mesh *)lbw_check(L, 1, &lbw_mesh_class);
  const bw_skeleton *skeleton = check_skeleton(L, 2);
  bw_weights_options options = {0};
  lbw_options(L, 3, "skinning_weights", list, &options);
  double *out = (double *)lbw_push_array(L, BW_F64, mesh->node_count, skeleton->bone_count)->data;
  return lbw_leave(L, bw_skinning_weights(lbw_enter(L), mesh, skeleton, &options, out), 1);
}

/* subdomains(mesh, skeleton, weights, {threshold, fraction, bone_threshold = one for every bone,
 * 0: the common}) */
static int core_subdomains(lua_State *L) {
  static const lbw_option list[] = {
      {"threshold", LBW_REAL, offsetof(bw_subdomains_options, threshold)},
      {"fraction", LBW_REAL, offsetof(bw_subdomains_options, fraction)},
      {"bone_threshold", LBW_OTHER, 0},
      {NULL, LBW_OTHER, 0}};
  const bw_mesh *mesh = (const bw_mesh *)lbw_check(L, 1, &lbw_mesh_class);
  const bw_skeleton *skeleton = check_skeleton(L, 2);
  lua_settop(L, 4);
  int64_t rows;
  double *weight = lbw_to_doubles(L, 3, "weights", skeleton->bone_count, &rows);
  lbw_check_rows(L, 3, "weights", rows, mesh->node_count, "node");
  bw_subdomains_options options = {0};
  lbw_options(L, 4, "subdomains", list, &options);
  if (lbw_option_get(L, 4, "bone_threshold") != LUA_TNIL) {
    options.bone_threshold = lbw_to_doubles(L, -1, "bone_threshold", 1, &rows);
    lbw_require_rows(L, "subdomains: bone_threshold", rows, skeleton->bone_count, "bone");
  }
  lbw_box *box = lbw_box_new(L, &lbw_subdomains_class);
  bw_subdomains *out = NULL;
  bw_status status = bw_subdomains_create(lbw_enter(L), mesh, skeleton, weight, &options, &out);
  return lbw_leave_object(L, box, out, status);
}

/* subdomains:assign(elements, bone): without a bone they are taken out of type R */
static int subdomains_assign(lua_State *L) {
  const bw_subdomains *subdomains = self(L);
  int64_t count;
  lua_settop(L, 3);
  int32_t bone = lua_isnil(L, 3) ? -1 : lbw_check_bone(L, 3, subdomains->skeleton);
  int32_t *element = lbw_to_indices(L, 2, "elements", 1, &count);
  lbw_box *box = lbw_box_new(L, &lbw_subdomains_class);
  bw_subdomains *out = NULL;
  bw_status status = bw_subdomains_assign(lbw_enter(L), subdomains, count, element, bone, &out);
  return lbw_leave_object(L, box, out, status);
}

/* Numbers as mesh:refill gives them, from 1 to `max` or (0 and below) as they are, in a userdata
 * that is pushed. */
static int32_t *origins(lua_State *L, int argument, const char *what, int64_t rows, int32_t max) {
  const bw_array *array = lbw_check_array(L, argument, what);
  lbw_argument_check(L, array->rows == rows && array->columns == 1, argument,
                     "numbers as mesh:refill gives them expected");
  int32_t *from = (int32_t *)lua_newuserdatauv(L, ((size_t)rows + 1) * sizeof *from, 0);
  for (int64_t i = 0; i < rows; i++) {
    double value = bw_array_get(array, i, 0);
    lbw_argument_check(L, value >= -INT32_MAX && value <= max, argument,
                       "numbers as mesh:refill gives them expected");
    from[i] = (int32_t)value;
  }
  return from;
}

/* subdomains:refilled(maps, mask, mesh, node_from, element_from): on what mesh:refill made */
static int subdomains_refilled(lua_State *L) {
  const bw_subdomains *subdomains = self(L);
  const bw_mesh *old = subdomains->mesh;
  int64_t rows;
  lua_settop(L, 6);
  double *map = lbw_to_doubles(L, 2, "maps", 12, &rows);
  lbw_check_rows(L, 2, "maps", rows, subdomains->skeleton->bone_count, "bone");
  uint8_t *replace = lbw_to_mask(L, 3, "mask", old->element_count);
  const bw_mesh *mesh = (const bw_mesh *)lbw_check(L, 4, &lbw_mesh_class);
  int32_t *node_from = origins(L, 5, "node_from", mesh->node_count, old->node_count);
  int32_t *element_from = origins(L, 6, "element_from", mesh->element_count, old->element_count);
  for (int32_t i = 0; i < mesh->node_count; i++)
    node_from[i]--;
  for (int32_t e = 0; e < mesh->element_count; e++)
    element_from[e] -= element_from[e] > 0;
  lbw_box *box = lbw_box_new(L, &lbw_subdomains_class);
  bw_subdomains *out = NULL;
  bw_status status = bw_subdomains_refilled(lbw_enter(L), subdomains, map, replace, mesh, node_from,
                                            element_from, &out);
  return lbw_leave_object(L, box, out, status);
}

/* The numbers of the parts (labels of elements below `count`) with an element that has a node whose
 * mask, the second argument, is not 0. */
static int push_touched(lua_State *L, const bw_mesh *mesh, int32_t count, const int32_t *label) {
  uint8_t *mask = lbw_to_mask(L, 2, "mask", mesh->node_count);
  uint8_t *touched = (uint8_t *)lua_newuserdatauv(L, (size_t)count + 1, 0);
  memset(touched, 0, (size_t)count);
  for (int64_t e = 0; e < mesh->element_count; e++)
    for (int a = 0; a < mesh->nodes_per_element; a++)
      if (mask[mesh->element[e * mesh->nodes_per_element + a]])
        touched[label[e]] = 1;
  lua_newtable(L);
  for (int32_t i = 0, n = 0; i < count; i++)
    if (touched[i]) {
      lua_pushinteger(L, (lua_Integer)i + 1);
      lua_rawseti(L, -2, ++n);
    }
  return 1;
}

/* subdomains:touched(mask) */
static int subdomains_touched(lua_State *L) {
  const bw_subdomains *subdomains = self(L);
  return push_touched(L, subdomains->mesh, subdomains->count, subdomains->element_subdomain);
}

/* subdomains:stiffness_subdomains_touched(mask) */
static int subdomains_stiffness_subdomains_touched(lua_State *L) {
  const bw_subdomains *subdomains = self(L);
  return push_touched(L, subdomains->mesh, subdomains->stiffness.count,
                      subdomains->stiffness.of_element);
}

/* ---- views ----------------------------------------------------------------------------------- */

/* subdomains[i]: {index, type = "R" | "F", bone, bones = {names}, elements,
 * adjacent = {numbers}} */
static int subdomains_index(lua_State *L) {
  const bw_subdomains *subdomains = self(L);
  if (lua_type(L, 2) != LUA_TNUMBER)
    return 0;
  lua_Integer i = lbw_check_integer(L, 2);
  if (i < 1 || i > subdomains->count)
    return 0; /* ends ipairs */
  i--;
  const bw_name *name = subdomains->skeleton->bone_name;
  lua_createtable(L, 0, 6);
  lua_pushinteger(L, i + 1);
  lua_setfield(L, -2, "index");
  lua_pushstring(L, i < subdomains->rigid_count ? "R" : "F");
  lua_setfield(L, -2, "type");
  if (subdomains->bone_of[i] >= 0) {
    lua_pushstring(L, name[subdomains->bone_of[i]].text);
    lua_setfield(L, -2, "bone");
  }
  lua_newtable(L);
  for (int32_t k = subdomains->bone_start[i], n = 0; k < subdomains->bone_start[i + 1]; k++) {
    lua_pushstring(L, name[subdomains->bone[k]].text);
    lua_rawseti(L, -2, ++n);
  }
  lua_setfield(L, -2, "bones");
  lua_pushinteger(L, subdomains->elements[i]);
  lua_setfield(L, -2, "elements");
  lua_newtable(L);
  for (int32_t k = subdomains->adjacent_start[i], n = 0; k < subdomains->adjacent_start[i + 1];
       k++) {
    lua_pushinteger(L, (lua_Integer)subdomains->adjacent[k] + 1);
    lua_rawseti(L, -2, ++n);
  }
  lua_setfield(L, -2, "adjacent");
  return 1;
}

LBW_PUSH(subdomains_length, lua_pushinteger(L, self(L)->count))
LBW_PUSH(subdomains_rigid_count, lua_pushinteger(L, self(L)->rigid_count))
LBW_PUSH(subdomains_stiffness_subdomain_count, lua_pushinteger(L, self(L)->stiffness.count))

/* The numbers of the bones that each stiffness subdomain follows, as a list of lists. */
static int subdomains_stiffness_subdomain_bones(lua_State *L) {
  const bw_subdomains *subdomains = self(L);
  lua_createtable(L, subdomains->stiffness.count, 0);
  for (int32_t p = 0; p < subdomains->stiffness.count; p++) {
    int32_t first = subdomains->stiffness.bone_start[p],
            end = subdomains->stiffness.bone_start[p + 1];
    lua_createtable(L, end - first, 0);
    for (int32_t k = first; k < end; k++) {
      lua_pushinteger(L, (lua_Integer)subdomains->stiffness.bone[k] + 1);
      lua_rawseti(L, -2, k - first + 1);
    }
    lua_rawseti(L, -2, p + 1);
  }
  return 1;
}

LBW_PUSH(subdomains_mesh, lbw_push(L, &lbw_mesh_class, self(L)->mesh))
LBW_PUSH(subdomains_skeleton, lbw_push(L, &lbw_skeleton_class, self(L)->skeleton))

static int subdomains_element_subdomain(lua_State *L) {
  const bw_subdomains *subdomains = self(L);
  return lbw_push_indices(L, subdomains->mesh->element_count, 1, subdomains->element_subdomain);
}

static int subdomains_node_subdomain(lua_State *L) {
  const bw_subdomains *subdomains = self(L);
  return lbw_push_indices(L, subdomains->mesh->node_count, 1, subdomains->node_subdomain);
}

static int subdomains_element_stiffness_subdomain(lua_State *L) {
  const bw_subdomains *subdomains = self(L);
  return lbw_push_indices(L, subdomains->mesh->element_count, 1, subdomains->stiffness.of_element);
}

static int subdomains_node_stiffness_subdomain(lua_State *L) {
  const bw_subdomains *subdomains = self(L);
  return lbw_push_indices(L, subdomains->mesh->node_count, 1, subdomains->stiffness.of_node);
}

static int subdomains_interface(lua_State *L) {
  const bw_subdomains *subdomains = self(L);
  return lbw_push_borrowed(L, BW_U8, subdomains->mesh->node_count, 1, subdomains->interface,
                           subdomains);
}

static int subdomains_tostring(lua_State *L) {
  const bw_subdomains *subdomains = (const bw_subdomains *)lbw_check(L, 1, &lbw_subdomains_class);
  int64_t blended = 0;
  for (int32_t d = subdomains->rigid_count; d < subdomains->count; d++)
    blended += subdomains->elements[d];
  char text[200];
  snprintf(text, sizeof text,
           "%d subdomains: %d that follow a bone and %d blended between bones, with %lld of %d "
           "elements",
           (int)subdomains->count, (int)subdomains->rigid_count,
           (int)(subdomains->count - subdomains->rigid_count), (long long)blended,
           (int)subdomains->mesh->element_count);
  lua_pushstring(L, text);
  return 1;
}

static const luaL_Reg methods[] = {
    {"assign", subdomains_assign},
    {"refilled", subdomains_refilled},
    {"touched", subdomains_touched},
    {"stiffness_subdomains_touched", subdomains_stiffness_subdomains_touched},
    {NULL, NULL}};
static const luaL_Reg properties[] = {
    {"count", subdomains_length},
    {"rigid_count", subdomains_rigid_count},
    {"mesh", subdomains_mesh},
    {"skeleton", subdomains_skeleton},
    {"element_subdomain", subdomains_element_subdomain},
    {"node_subdomain", subdomains_node_subdomain},
    {"stiffness_subdomain_count", subdomains_stiffness_subdomain_count},
    {"stiffness_subdomain_bones", subdomains_stiffness_subdomain_bones},
    {"element_stiffness_subdomain", subdomains_element_stiffness_subdomain},
    {"node_stiffness_subdomain", subdomains_node_stiffness_subdomain},
    {"interface", subdomains_interface},
    {NULL, NULL}};
static const luaL_Reg meta[] = {{"__index", subdomains_index},
                                {"__len", subdomains_length},
                                {"__tostring", subdomains_tostring},
                                {NULL, NULL}};
const lbw_class lbw_subdomains_class = {"subdomains", methods, properties, meta, NULL};

void lbw_open_subdomains(lua_State *L) {
  static const luaL_Reg functions[] = {
      {"skinning_weights", core_skinning_weights}, {"subdomains", core_subdomains}, {NULL, NULL}};
  lbw_class_register(L, &lbw_subdomains_class);
  luaL_setfuncs(L, functions, 0);
}
