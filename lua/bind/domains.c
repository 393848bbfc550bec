/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* Skinning weights, and a mesh cut into domains along a skeleton. domains[i] is a table about the
 * i-th domain. */
#include "bind.h"

#include <stdio.h>
#include <string.h>

static const bw_domains *self(lua_State *L) {
  return (const bw_domains *)lbw_check(L, 1, &lbw_domains_class);
}

static int leave(lua_State *L, lbw_box *box, const bw_domains *domains, bw_status status) {
  lbw_box_fill(L, box, domains);
  return lbw_leave(L, status, 1);
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

/* domains(mesh, skeleton, weights, {threshold, share, bone_threshold = one for every bone, 0: the
 * common}) */
static int core_domains(lua_State *L) {
  static const lbw_option list[] = {
      {"threshold", LBW_REAL, offsetof(bw_domains_options, threshold)},
      {"share", LBW_REAL, offsetof(bw_domains_options, share)},
      {"bone_threshold", LBW_OTHER, 0},
      {NULL, LBW_OTHER, 0}};
  const bw_mesh *mesh = (const bw_mesh *)lbw_check(L, 1, &lbw_mesh_class);
  const bw_skeleton *skeleton = check_skeleton(L, 2);
  lua_settop(L, 4);
  int64_t rows;
  double *weight = lbw_to_doubles(L, 3, "weights", skeleton->bone_count, &rows);
  lbw_argument_check(L, rows == mesh->node_count, 3, "weights: a row for every node expected");
  bw_domains_options options = {0};
  lbw_options(L, 4, "domains", list, &options);
  if (lbw_option_get(L, 4, "bone_threshold") != LUA_TNIL) {
    options.bone_threshold = lbw_to_doubles(L, -1, "bone_threshold", 1, &rows);
    if (rows != skeleton->bone_count)
      return lbw_option_error(L, "domains", "bone_threshold", "one for every bone expected");
  }
  lbw_box *box = lbw_box_new(L, &lbw_domains_class);
  bw_domains *out = NULL;
  bw_status status = bw_domains_create(lbw_enter(L), mesh, skeleton, weight, &options, &out);
  return leave(L, box, out, status);
}

/* domains_from_labels(mesh, skeleton, bones, labels): bones of the domains (0: blended), the domain
 * of every element */
static int core_domains_from_labels(lua_State *L) {
  const bw_mesh *mesh = (const bw_mesh *)lbw_check(L, 1, &lbw_mesh_class);
  const bw_skeleton *skeleton = check_skeleton(L, 2);
  int64_t domains, labels;
  lua_settop(L, 4);
  double *given = lbw_to_doubles(L, 3, "bones", 1, &domains);
  lbw_argument_check(L, domains >= 1, 3, "bones: one for every domain expected");
  int32_t *bone_of = (int32_t *)lua_newuserdatauv(L, (size_t)domains * sizeof *bone_of, 0);
  for (int64_t i = 0; i < domains; i++) {
    lbw_argument_check(L, given[i] >= 0 && given[i] <= skeleton->bone_count, 3,
                       "bones: numbers of bones, 0 for a blended domain, expected");
    bone_of[i] = (int32_t)given[i] - 1;
  }
  int32_t *label = lbw_to_indices(L, 4, "labels", 1, &labels);
  lbw_argument_check(L, labels == mesh->element_count, 4, "labels: one for every element expected");
  lbw_box *box = lbw_box_new(L, &lbw_domains_class);
  bw_domains *out = NULL;
  bw_status status =
      bw_domains_from_labels(lbw_enter(L), mesh, skeleton, (int32_t)domains, bone_of, label, &out);
  return leave(L, box, out, status);
}

/* domains:assign(elements, bone): without a bone they are taken out of type R */
static int domains_assign(lua_State *L) {
  const bw_domains *domains = self(L);
  int64_t count;
  lua_settop(L, 3);
  int32_t bone = lua_isnil(L, 3) ? -1 : lbw_check_bone(L, 3, domains->skeleton);
  int32_t *element = lbw_to_indices(L, 2, "elements", 1, &count);
  lbw_box *box = lbw_box_new(L, &lbw_domains_class);
  bw_domains *out = NULL;
  bw_status status = bw_domains_assign(lbw_enter(L), domains, count, element, bone, &out);
  return leave(L, box, out, status);
}

/* Numbers as mesh:refill gives them, from 1 to `most` or (0 and below) as they are, in a userdata
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

/* domains:refilled(maps, mask, mesh, node_from, element_from): on what mesh:refill made */
static int domains_refilled(lua_State *L) {
  const bw_domains *domains = self(L);
  const bw_mesh *old = domains->mesh;
  int64_t rows;
  lua_settop(L, 6);
  double *map = lbw_to_doubles(L, 2, "maps", 12, &rows);
  lbw_argument_check(L, rows == domains->skeleton->bone_count, 2,
                     "maps: a row for every bone expected");
  uint8_t *replace = lbw_to_mask(L, 3, "mask", old->element_count);
  const bw_mesh *mesh = (const bw_mesh *)lbw_check(L, 4, &lbw_mesh_class);
  int32_t *node_from = origins(L, 5, "node_from", mesh->node_count, old->node_count);
  int32_t *element_from = origins(L, 6, "element_from", mesh->element_count, old->element_count);
  for (int32_t i = 0; i < mesh->node_count; i++)
    node_from[i]--;
  for (int32_t e = 0; e < mesh->element_count; e++)
    element_from[e] -= element_from[e] > 0;
  lbw_box *box = lbw_box_new(L, &lbw_domains_class);
  bw_domains *out = NULL;
  bw_status status =
      bw_domains_refilled(lbw_enter(L), domains, map, replace, mesh, node_from, element_from, &out);
  return leave(L, box, out, status);
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

/* domains:touched(mask) */
static int domains_touched(lua_State *L) {
  const bw_domains *domains = self(L);
  return push_touched(L, domains->mesh, domains->count, domains->element_domain);
}

/* domains:pieces_touched(mask) */
static int domains_pieces_touched(lua_State *L) {
  const bw_domains *domains = self(L);
  return push_touched(L, domains->mesh, domains->piece_count, domains->element_piece);
}

/* ---- views ----------------------------------------------------------------------------------- */

/* domains[i]: {index, type = "R" | "F", bone, bones = {names}, elements, adjacent = {numbers}} */
static int domains_index(lua_State *L) {
  const bw_domains *domains = self(L);
  if (lua_type(L, 2) != LUA_TNUMBER)
    return 0;
  lua_Integer i = lbw_check_integer(L, 2);
  if (i < 1 || i > domains->count)
    return 0; /* ends ipairs */
  i--;
  const bw_name *name = domains->skeleton->bone_name;
  lua_createtable(L, 0, 6);
  lua_pushinteger(L, i + 1);
  lua_setfield(L, -2, "index");
  lua_pushstring(L, i < domains->rigid_count ? "R" : "F");
  lua_setfield(L, -2, "type");
  if (domains->bone_of[i] >= 0) {
    lua_pushstring(L, name[domains->bone_of[i]].text);
    lua_setfield(L, -2, "bone");
  }
  lua_newtable(L);
  for (int32_t k = domains->bone_start[i], n = 0; k < domains->bone_start[i + 1]; k++) {
    lua_pushstring(L, name[domains->bone[k]].text);
    lua_rawseti(L, -2, ++n);
  }
  lua_setfield(L, -2, "bones");
  lua_pushinteger(L, domains->elements[i]);
  lua_setfield(L, -2, "elements");
  lua_newtable(L);
  for (int32_t k = domains->adjacent_start[i], n = 0; k < domains->adjacent_start[i + 1]; k++) {
    lua_pushinteger(L, (lua_Integer)domains->adjacent[k] + 1);
    lua_rawseti(L, -2, ++n);
  }
  lua_setfield(L, -2, "adjacent");
  return 1;
}

static int domains_length(lua_State *L) {
  lua_pushinteger(L, self(L)->count);
  return 1;
}

static int domains_rigid_count(lua_State *L) {
  lua_pushinteger(L, self(L)->rigid_count);
  return 1;
}

static int domains_piece_count(lua_State *L) {
  lua_pushinteger(L, self(L)->piece_count);
  return 1;
}

/* The numbers of the bones that each piece follows, as a list of lists. */
static int domains_piece_bones(lua_State *L) {
  const bw_domains *domains = self(L);
  lua_createtable(L, domains->piece_count, 0);
  for (int32_t p = 0; p < domains->piece_count; p++) {
    int32_t first = domains->piece_bone_start[p], end = domains->piece_bone_start[p + 1];
    lua_createtable(L, end - first, 0);
    for (int32_t k = first; k < end; k++) {
      lua_pushinteger(L, (lua_Integer)domains->piece_bone[k] + 1);
      lua_rawseti(L, -2, k - first + 1);
    }
    lua_rawseti(L, -2, p + 1);
  }
  return 1;
}

static int domains_mesh(lua_State *L) {
  lbw_push(L, &lbw_mesh_class, self(L)->mesh);
  return 1;
}

static int domains_skeleton(lua_State *L) {
  lbw_push(L, &lbw_skeleton_class, self(L)->skeleton);
  return 1;
}

static int domains_element_domain(lua_State *L) {
  const bw_domains *domains = self(L);
  return lbw_push_indices(L, domains->mesh->element_count, 1, domains->element_domain);
}

static int domains_node_domain(lua_State *L) {
  const bw_domains *domains = self(L);
  return lbw_push_indices(L, domains->mesh->node_count, 1, domains->node_domain);
}

static int domains_element_piece(lua_State *L) {
  const bw_domains *domains = self(L);
  return lbw_push_indices(L, domains->mesh->element_count, 1, domains->element_piece);
}

static int domains_node_piece(lua_State *L) {
  const bw_domains *domains = self(L);
  return lbw_push_indices(L, domains->mesh->node_count, 1, domains->node_piece);
}

static int domains_interface(lua_State *L) {
  const bw_domains *domains = self(L);
  return lbw_push_borrowed(L, BW_U8, domains->mesh->node_count, 1, domains->interface, domains);
}

static int domains_tostring(lua_State *L) {
  const bw_domains *domains = (const bw_domains *)lbw_check(L, 1, &lbw_domains_class);
  int64_t blended = 0;
  for (int32_t d = domains->rigid_count; d < domains->count; d++)
    blended += domains->elements[d];
  char text[200];
  snprintf(text, sizeof text,
           "%d domains: %d that follow a bone and %d blended between bones, with %lld of %d "
           "elements",
           (int)domains->count, (int)domains->rigid_count,
           (int)(domains->count - domains->rigid_count), (long long)blended,
           (int)domains->mesh->element_count);
  lua_pushstring(L, text);
  return 1;
}

static const luaL_Reg methods[] = {{"assign", domains_assign},
                                   {"refilled", domains_refilled},
                                   {"touched", domains_touched},
                                   {"pieces_touched", domains_pieces_touched},
                                   {NULL, NULL}};
static const luaL_Reg properties[] = {{"count", domains_length},
                                      {"rigid_count", domains_rigid_count},
                                      {"mesh", domains_mesh},
                                      {"skeleton", domains_skeleton},
                                      {"element_domain", domains_element_domain},
                                      {"node_domain", domains_node_domain},
                                      {"piece_count", domains_piece_count},
                                      {"piece_bones", domains_piece_bones},
                                      {"element_piece", domains_element_piece},
                                      {"node_piece", domains_node_piece},
                                      {"interface", domains_interface},
                                      {NULL, NULL}};
static const luaL_Reg meta[] = {{"__index", domains_index},
                                {"__len", domains_length},
                                {"__tostring", domains_tostring},
                                {NULL, NULL}};
const lbw_class lbw_domains_class = {"domains", methods, properties, meta, NULL};

void lbw_open_domains(lua_State *L) {
  static const luaL_Reg functions[] = {{"skinning_weights", core_skinning_weights},
                                       {"domains", core_domains},
                                       {"domains_from_labels", core_domains_from_labels},
                                       {NULL, NULL}};
  lbw_class_register(L, &lbw_domains_class);
  luaL_setfuncs(L, functions, 0);
}
