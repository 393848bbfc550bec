/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* Names of faces on surfaces and meshes, and triangles between polygons. */
#include "bind.h"

#include <string.h>

enum { LBW_FACE_NAMES = 10000 }; /* of one body by formula */

static int push_names(lua_State *L, const bw_face_names *names) {
  lua_createtable(L, names ? names->count : 0, 0);
  for (int32_t i = 0; names && i < names->count; i++) {
    lua_pushstring(L, names->name[i].text);
    lua_rawseti(L, -2, i + 1);
  }
  return 1;
}

/* surface:face_names() */
int lbw_surface_face_names(lua_State *L) {
  return push_names(L, ((const bw_surface *)lbw_check(L, 1, &lbw_surface_class))->names);
}

/* surface:curved_faces(): the names of faces that have facets of curved ones */
int lbw_surface_curved_faces(lua_State *L) {
  const bw_face_names *names = ((const bw_surface *)lbw_check(L, 1, &lbw_surface_class))->names;
  lua_Integer count = 0;
  lua_newtable(L);
  for (int32_t i = 0; names && i < names->count; i++)
    if (names->curved[i]) {
      lua_pushstring(L, names->name[i].text);
      lua_rawseti(L, -2, ++count);
    }
  return 1;
}

/* mesh:face_names() */
int lbw_mesh_face_names(lua_State *L) {
  return push_names(L, ((const bw_mesh *)lbw_check(L, 1, &lbw_mesh_class))->names);
}

/* The list of names at `index`, in a userdata that is pushed. */
bw_name *lbw_to_names(lua_State *L, int index, const char *what, int32_t *count) {
  index = lua_absindex(L, index);
  if (!lua_istable(L, index))
    lbw_error(L, "%s: a list of names expected, got %s", what, lbw_got(L, index));
  const size_t all = (size_t)lua_rawlen(L, index);
  lbw_argument_check(L, all < INT32_MAX, index, "a shorter list expected");
  bw_name *name = (bw_name *)lua_newuserdatauv(L, (all + 1) * sizeof *name, 0);
  for (size_t i = 0; i < all; i++) {
    lua_rawgeti(L, index, (lua_Integer)i + 1);
    lbw_read_name(L, -1, what, &name[i]);
    lua_pop(L, 1);
  }
  *count = (int32_t)all;
  return name;
}

/* The same facets; those of the face `old`, or all where it is NULL, have a new name. */
static bw_status rename_faces(bw_context *context, const bw_surface *surface, const bw_name *fresh,
                              const char *old, bw_surface **named) {
  const int32_t known = surface->names ? surface->names->count : 0;
  bw_status status = BW_OK;
  bw_face_names *names = NULL;
  bool some = false;
  int32_t *group = BW_NEW0(context, int32_t, surface->triangle_count);
  bw_name *list = BW_NEW0(context, bw_name, known + 1);
  uint8_t *curved = BW_NEW0(context, uint8_t, known + 1);
  BW_TRY_MEMORY(group && list && curved);
  list[0] = *fresh;
  for (int32_t i = 0; i < known; i++)
    curved[old ? i : 0] |= surface->names->curved[i];
  for (int32_t i = 0; old && i < known; i++) {
    list[i] = surface->names->name[i];
    if (bw_face_names_is(surface->names, i, old)) {
      list[i] = *fresh;
      some = true;
    }
  }
  if (old && !some)
    BW_TRY(bw_fail(context, BW_EMPTY, "named: no face has the name '%s'", old));
  BW_TRY(bw_face_names_create(context, old ? known : 1, list, curved, &names));
  BW_TRY(bw_surface_with_names(context, surface, old ? NULL : group, names, named));
done:
  bw_free(group);
  bw_free(list);
  bw_free(curved);
  bw_release(names);
  return status;
}

/* surface:named(name, face) */
int lbw_surface_named(lua_State *L) {
  const bw_surface *surface = (const bw_surface *)lbw_check(L, 1, &lbw_surface_class);
  bw_name name;
  lua_settop(L, 3);
  lbw_read_name(L, 2, "named: name", &name);
  lbw_argument_check(L, name.text[0], 2, "name: a text that is not empty expected");
  const char *face = lua_isnil(L, 3) ? NULL : lbw_check_text(L, 3, NULL);
  lbw_box *box = lbw_box_new(L, &lbw_surface_class);
  bw_surface *out = NULL;
  bw_status status = rename_faces(lbw_enter(L), surface, &name, face, &out);
  return lbw_leave_object(L, box, out, status);
}

/* The number from 0 of the name on the top of the stack, which goes, in the list of those seen; -1
 * for none. `table` has the numbers by name. */
static int32_t number_of_name(lua_State *L, int table, bw_name *list, int32_t *count) {
  if (lua_isnil(L, -1)) {
    lua_pop(L, 1);
    return -1;
  }
  if (lua_type(L, -1) != LUA_TSTRING)
    lbw_error(L,
              "surface.implicit: a function of x, y, z: the name of a face or nil expected as its "
              "second result, got %s",
              lbw_got(L, -1));
  lua_pushvalue(L, -1);
  if (lua_rawget(L, table) == LUA_TNIL) {
    lua_pop(L, 1);
    if (*count == LBW_FACE_NAMES)
      lbw_error(L, "surface.implicit: more than %d names of faces", LBW_FACE_NAMES);
    lbw_read_name(L, -1, "surface.implicit: the name of a face", &list[*count]);
    lua_pushvalue(L, -1);
    lua_pushinteger(L, (*count)++);
    lua_rawset(L, table);
    lua_pushinteger(L, *count - 1);
  }
  int32_t number = (int32_t)lua_tointeger(L, -1);
  lua_pop(L, 2);
  return number;
}

void lbw_name_facets(lua_State *L, int function, lbw_box *box) {
  const bw_surface *surface = (const bw_surface *)box->object;
  const int32_t facets = surface->triangle_count;
  const int top = lua_gettop(L);
  int32_t count = 0;
  int32_t *group = (int32_t *)lua_newuserdatauv(L, (size_t)facets * sizeof *group, 0);
  bw_name *list = (bw_name *)lua_newuserdatauv(L, LBW_FACE_NAMES * sizeof *list, 0);
  lua_newtable(L);
  const int table = lua_gettop(L);
  for (int32_t t = 0; t < facets; t++) {
    const int32_t *c = surface->triangle + 3 * (size_t)t;
    lua_pushvalue(L, function);
    for (size_t k = 0; k < 3; k++) {
      double sum = 0;
      for (int i = 0; i < 3; i++)
        sum += surface->point[3 * (size_t)c[i] + k];
      lua_pushnumber(L, sum / 3);
    }
    lua_call(L, 3, 2);
    group[t] = number_of_name(L, table, list, &count);
    lua_pop(L, 1);
  }
  if (count > 0) {
    bw_face_names *names = NULL;
    bw_surface *named = NULL;
    bw_status status;
    for (int32_t t = 0; t < facets; t++) /* behind the names: facets without one */
      group[t] = group[t] < 0 ? count : group[t];
    bw_context *context = lbw_enter(L);
    BW_TRY(bw_face_names_create(context, count, list, NULL, &names));
    BW_TRY(bw_surface_with_names(context, surface, group, names, &named));
  done:
    bw_release(names);
    if (status == BW_OK) {
      bw_release(surface);
      lbw_box_fill(L, box, named);
    }
    lbw_leave_or_raise(L, status);
  }
  lua_settop(L, top);
}

/* polygon_triangles{points, points, ...}: the triangles inside an odd number of polygons, by
 * numbers of all points one list behind the other */
int lbw_polygon_triangles(lua_State *L) {
  lbw_check_type(L, 1, LUA_TTABLE);
  lua_settop(L, 1);
  const lua_Integer count = (lua_Integer)lua_rawlen(L, 1);
  lbw_argument_check(L, count > 0 && count < 1000000, 1, "1 to 999999 polygons expected");
  int32_t *start = (int32_t *)lua_newuserdatauv(L, (size_t)(count + 1) * sizeof *start, 0);
  int64_t all = 0;
  start[0] = 0;
  for (lua_Integer p = 0; p < count; p++) {
    lua_rawgeti(L, 1, p + 1);
    all += lua_istable(L, -1) ? (int64_t)lua_rawlen(L, -1) : 0;
    lbw_argument_check(L, lua_istable(L, -1) && all < INT32_MAX, 1, "lists of points expected");
    start[p + 1] = (int32_t)all;
    lua_pop(L, 1);
  }
  double *point = (double *)lua_newuserdatauv(L, (size_t)(2 * all + 1) * sizeof *point, 0);
  for (lua_Integer p = 0; p < count; p++) {
    lua_rawgeti(L, 1, p + 1);
    for (int32_t i = start[p]; i < start[p + 1]; i++) {
      lua_rawgeti(L, -1, i - start[p] + 1);
      for (int k = 0; k < 2; k++) {
        lua_rawgeti(L, -1, k + 1);
        point[2 * (int64_t)i + k] = lua_tonumber(L, -1);
        lua_pop(L, 1);
      }
      lua_pop(L, 1);
    }
    lua_pop(L, 1);
  }
  lbw_box *box = lbw_box_new(L, &lbw_array_class);
  int32_t *triangle = NULL;
  int64_t triangles = 0;
  bw_array *array = NULL;
  bw_context *context = lbw_enter(L);
  bw_status status =
      bw_polygons_triangles(context, (int32_t)count, start, point, &triangle, &triangles);
  for (int64_t i = 0; i < 3 * triangles; i++)
    triangle[i]++;
  if (status == BW_OK)
    status = bw_array_adopt(context, BW_I32, triangles, 3, triangle, &array);
  if (status != BW_OK)
    bw_free(triangle);
  return lbw_leave_object(L, box, array, status);
}
