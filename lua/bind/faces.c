/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* Faces of surfaces and of meshes' boundaries: surface:faces(), selection:face(which). */
#include "bind.h"

#include <stdio.h>
#include <string.h>

/* "plane 2": the second largest plane. */
static void name_of(const bw_faces *faces, int32_t face, char *name, size_t size) {
  int number = 1;
  for (int32_t i = 0; i < face; i++)
    number += faces->face[i].kind == faces->face[face].kind;
  snprintf(name, size, "%s %d", bw_face_word(faces->face[face].kind), number);
}

static void push_face(lua_State *L, const bw_faces *faces, int32_t i) {
  const bw_face *face = &faces->face[i];
  char name[40];
  name_of(faces, i, name, sizeof name);
  lua_createtable(L, 0, 11);
  lua_pushstring(L, name);
  lua_setfield(L, -2, "name");
  lua_pushstring(L, bw_face_word(face->kind));
  lua_setfield(L, -2, "kind");
  lua_pushnumber(L, face->area);
  lua_setfield(L, -2, "area");
  lua_pushinteger(L, face->triangle_count);
  lua_setfield(L, -2, "triangle_count");
  lbw_push_vector(L, face->centre);
  lua_setfield(L, -2, "centre");
  lbw_push_vector(L, face->normal);
  lua_setfield(L, -2, "normal");
  if (face->kind == BW_FACE_FREE)
    return;
  lbw_push_vector(L, face->point);
  lua_setfield(L, -2, "point");
  lua_pushnumber(L, face->residual);
  lua_setfield(L, -2, "residual");
  if (face->kind != BW_FACE_SPHERE) {
    lbw_push_vector(L, face->axis);
    lua_setfield(L, -2, "axis");
  }
  if (face->kind != BW_FACE_PLANE) {
    lua_pushnumber(L, face->radius);
    lua_setfield(L, -2, "radius");
  }
  if (face->kind == BW_FACE_CONE) {
    lua_pushnumber(L, face->slope);
    lua_setfield(L, -2, "slope");
  }
}

static int push_faces(lua_State *L) {
  const bw_faces *faces = (const bw_faces *)lua_touserdata(L, 1);
  lua_createtable(L, faces->count, 0);
  for (int32_t i = 0; i < faces->count; i++) {
    push_face(L, faces, i);
    lua_rawseti(L, -2, i + 1);
  }
  return 1;
}

/* Ends a call of the engine with a list of faces, which are released. */
static int leave_faces(lua_State *L, bw_status status, bw_faces *faces) {
  if (status != BW_OK)
    return lbw_leave(L, status, 0);
  lbw_state_of(L)->running = 0;
  lua_pushcfunction(L, push_faces);
  lua_pushlightuserdata(L, faces);
  int failure = lua_pcall(L, 1, 1, 0);
  bw_release(faces);
  return failure ? lua_error(L) : lbw_leave(L, BW_OK, 1);
}

/* surface:faces{angle}: a list by descending area, the number of every triangle's face */
int lbw_surface_faces(lua_State *L) {
  static const lbw_option list[] = {{"angle", LBW_REAL, 0}, {NULL, LBW_OTHER, 0}};
  const bw_surface *surface = (const bw_surface *)lbw_check(L, 1, &lbw_surface_class);
  double angle = 0;
  bw_faces *faces = NULL;
  lbw_options(L, 2, "faces", list, &angle);
  int32_t *number = (int32_t *)lbw_push_array(L, BW_I32, surface->triangle_count, 1)->data;
  bw_status status = bw_faces_find(lbw_enter(L), surface, angle, &faces);
  for (int32_t t = 0; t < surface->triangle_count && status == BW_OK; t++)
    number[t] = faces->of_triangle[t] + 1;
  int results = leave_faces(L, status, faces);
  if (results > 1)
    return results;
  lua_insert(L, -2);
  return 2;
}

/* Which face: by number, by name, or the nearest to a point. */
typedef struct opts {
  lua_Integer number;
  char name[BW_NAME];
  bool near;
  double point[3];
} opts;

static opts read_opts(lua_State *L) {
  opts w = {0};
  static const lbw_option list[] = {{"near", LBW_VECTOR, offsetof(opts, point)},
                                    {NULL, LBW_OTHER, 0}};
  lua_settop(L, 2);
  if (lua_istable(L, 2)) {
    lbw_options(L, 2, "face", list, &w);
    w.near = lbw_option_get(L, 2, "near") != LUA_TNIL;
    lbw_argument_check(L, w.near, 2, "which: {near = {x, y, z}} expected");
  } else if (lua_type(L, 2) == LUA_TSTRING)
    snprintf(w.name, sizeof w.name, "%s", lua_tostring(L, 2));
  else {
    w.number = lbw_integer_or(L, 2, 0);
    lbw_argument_check(L, w.number >= 1, 2,
                       "which: a number of 1 or more, a name, or {near = {x, y, z}} expected");
  }
  lua_settop(L, 2);
  return w;
}

static int32_t find_face(const bw_faces *faces, const bw_surface *surface, const opts *w) {
  char name[40];
  if (w->near)
    return bw_faces_near(faces, surface, w->point);
  if (!w->name[0])
    return w->number <= faces->count ? (int32_t)w->number - 1 : -1;
  for (int32_t i = 0; i < faces->count; i++) {
    name_of(faces, i, name, sizeof name);
    if (strcmp(name, w->name) == 0)
      return i;
  }
  return -1;
}

/* Marks the facets of a face that has this name since its surface was made. */
static bool mark_named(const bw_mesh *mesh, const char *name, uint8_t *mask) {
  bool some = false;
  for (int32_t t = 0; t < mesh->facet_count; t++) {
    mask[t] = mesh->names && bw_face_names_is(mesh->names, mesh->facet_group[t], name);
    some = some || mask[t];
  }
  return some;
}

/* ", or 'top', or 'bolt hole'" */
static void list_names(const bw_face_names *names, char *text, size_t size) {
  size_t used = 0;
  for (int32_t i = 0; names && i < names->count && used + BW_NAME + 8 < size; i++)
    if (names->name[i].text[0])
      used += (size_t)snprintf(text + used, size - used, ", or '%s'", names->name[i].text);
}

static bw_status select_face(bw_context *context, const bw_mesh *mesh, const opts *w, uint8_t *mask,
                             bw_selection **chosen) {
  bw_surface *surface = NULL;
  bw_faces *faces = NULL;
  bw_status status;
  if (w->name[0] && mark_named(mesh, w->name, mask))
    return bw_select_mask(context, mesh, mask, NULL, chosen);
  BW_TRY(bw_mesh_boundary(context, mesh, &surface, NULL));
  BW_TRY(bw_faces_find(context, surface, 0, &faces));
  int32_t face = find_face(faces, surface, w);
  if (face < 0) {
    char asked[BW_NAME + 2], known[400] = "";
    if (w->name[0])
      snprintf(asked, sizeof asked, "'%s'", w->name);
    else
      snprintf(asked, sizeof asked, "%lld", (long long)w->number);
    list_names(mesh->names, known, sizeof known);
    status = bw_fail(context, BW_EMPTY,
                     "the boundary has no face %s: the name of one of its %d faces, or a number "
                     "from 1 to %d, expected%s; print(mesh:surface()) lists them",
                     asked, faces->count, faces->count, known);
    goto done;
  }
  for (int32_t t = 0; t < mesh->facet_count; t++)
    mask[t] = faces->of_triangle[t] == face;
  status = bw_select_mask(context, mesh, mask, NULL, chosen);
done:
  bw_release(surface);
  bw_release(faces);
  return status;
}

/* selection:face(which): the face of the mesh's boundary, within the selection */
int lbw_selection_face(lua_State *L) {
  const bw_selection *from = (const bw_selection *)lbw_check(L, 1, &lbw_selection_class);
  opts w = read_opts(L);
  bw_selection *chosen = NULL, *within = NULL;
  uint8_t *mask = (uint8_t *)lua_newuserdatauv(L, (size_t)from->mesh->facet_count + 1, 0);
  lbw_box *box = lbw_box_new(L, &lbw_selection_class);
  bw_context *context = lbw_enter(L);
  bw_status status;
  BW_TRY(select_face(context, from->mesh, &w, mask, &chosen));
  status = bw_select_combine(context, from, chosen, BW_INTERSECTION, &within);
done:
  bw_release(chosen);
  return lbw_leave_object(L, box, within, status);
}

/* The areas of the faces of a surface on the boundary of a mesh: `area` of the faces. */
static bw_status areas_on_mesh(bw_context *context, const bw_surface *surface, const bw_mesh *mesh,
                               bw_faces **out) {
  bw_status status = BW_OK;
  bw_faces *faces = NULL;
  bw_selection *chosen = NULL;
  int32_t *label = BW_NEW(context, int32_t, mesh->facet_count);
  uint8_t *mask = BW_NEW(context, uint8_t, mesh->facet_count);
  BW_TRY_MEMORY(label && mask);
  BW_TRY(bw_faces_find(context, surface, 0, &faces));
  BW_TRY(bw_faces_on_mesh(context, surface, faces, mesh, label));
  for (int32_t i = 0; i < faces->count; i++) {
    bool some = false;
    faces->face[i].triangle_count = 0;
    faces->face[i].area = 0;
    for (int32_t t = 0; t < mesh->facet_count; t++) {
      mask[t] = label[t] == i;
      faces->face[i].triangle_count += mask[t];
      some = some || mask[t];
    }
    if (!some)
      continue;
    BW_TRY(bw_select_mask(context, mesh, mask, NULL, &chosen));
    faces->face[i].area = bw_selection_area(chosen);
    bw_release(chosen);
    chosen = NULL;
  }
  *out = faces;
  faces = NULL;
done:
  bw_release(faces);
  bw_free(label);
  bw_free(mask);
  return status;
}

/* mesh:faces(surface): the list of surface:faces() with areas and facets of the mesh's boundary */
int lbw_mesh_faces(lua_State *L) {
  const bw_mesh *mesh = (const bw_mesh *)lbw_check(L, 1, &lbw_mesh_class);
  const bw_surface *surface = (const bw_surface *)lbw_check(L, 2, &lbw_surface_class);
  bw_faces *faces = NULL;
  bw_status status = areas_on_mesh(lbw_enter(L), surface, mesh, &faces);
  return leave_faces(L, status, faces);
}

/* face_labels(surface, labels, body): the label of each facet of a mesh's boundary, or of each
 * triangle of another surface, from that of the triangle of the surface that it lies on; 0 where it
 * is not clear. Labels are 1 or more. */
int lbw_face_labels(lua_State *L) {
  const bw_surface *surface = (const bw_surface *)lbw_check(L, 1, &lbw_surface_class);
  const bw_array *labels = lbw_check_array(L, 2, "labels");
  const bool on_mesh = lbw_test(L, 3, &lbw_mesh_class) != NULL;
  const void *body = lbw_check(L, 3, on_mesh ? &lbw_mesh_class : &lbw_surface_class);
  int32_t count =
      on_mesh ? ((const bw_mesh *)body)->facet_count : ((const bw_surface *)body)->triangle_count;
  lbw_argument_check(L,
                     labels->type == BW_I32 && labels->rows == surface->triangle_count &&
                         labels->columns == 1 && labels->row_stride == (ptrdiff_t)sizeof(int32_t),
                     2, "labels: whole numbers, one for each triangle, expected");
  const bw_faces faces = {.triangle_count = surface->triangle_count,
                          .of_triangle = (int32_t *)labels->data};
  int32_t *label = (int32_t *)lbw_push_array(L, BW_I32, count, 1)->data;
  bw_context *context = lbw_enter(L);
  bw_status status =
      on_mesh ? bw_faces_on_mesh(context, surface, &faces, (const bw_mesh *)body, label)
              : bw_faces_on_surface(context, surface, &faces, (const bw_surface *)body, label);
  for (int32_t t = 0; t < count && status == BW_OK; t++)
    label[t] = label[t] < 0 ? 0 : label[t];
  return lbw_leave(L, status, 1);
}

/* mesh:curved(surface): mesh, how many mid-edge nodes lie on round faces now */
int lbw_mesh_curved(lua_State *L) {
  const bw_mesh *mesh = (const bw_mesh *)lbw_check(L, 1, &lbw_mesh_class);
  const bw_surface *surface = (const bw_surface *)lbw_check(L, 2, &lbw_surface_class);
  lbw_box *box = lbw_box_new(L, &lbw_mesh_class);
  bw_mesh *out = NULL;
  int64_t count = 0;
  bw_status status = bw_mesh_curved(lbw_enter(L), mesh, surface, &out, &count);
  lbw_box_fill(L, box, out);
  lua_pushinteger(L, count);
  return lbw_leave(L, status, 2);
}

/* ---- what print shows ------------------------------------------------------------------------ */

enum { LINES = 12, MAX_TRIANGLES = 200000 };

static int add_lines(lua_State *L) {
  const bw_faces *faces = (const bw_faces *)lua_touserdata(L, 2);
  luaL_Buffer buffer;
  lua_settop(L, 2);
  luaL_buffinit(L, &buffer);
  luaL_addstring(&buffer, lua_tostring(L, 1));
  for (int32_t i = 0; i < faces->count && i < LINES; i++) {
    const bw_face *face = &faces->face[i];
    char line[240], name[40];
    name_of(faces, i, name, sizeof name);
    snprintf(line, sizeof line, "\n  %-12s %s at %s", name, lbw_quantity(face->area, "m2").text,
             lbw_point(face->centre).text);
    luaL_addstring(&buffer, line);
    if (face->kind == BW_FACE_PLANE)
      snprintf(line, sizeof line, ", normal %s", lbw_direction(face->axis).text);
    else if (face->kind == BW_FACE_SPHERE)
      snprintf(line, sizeof line, ", radius %s", lbw_quantity(face->radius, "m").text);
    else if (face->kind != BW_FACE_FREE)
      snprintf(line, sizeof line, ", radius %s, axis %s", lbw_quantity(face->radius, "m").text,
               lbw_direction(face->axis).text);
    else
      line[0] = 0;
    luaL_addstring(&buffer, line);
  }
  if (faces->count > LINES)
    lua_pushfstring(L, "\n  and %d more faces", (int)faces->count - LINES);
  else
    lua_pushliteral(L, "");
  luaL_addvalue(&buffer);
  luaL_pushresult(&buffer);
  return 1;
}

void lbw_add_faces(lua_State *L, const bw_surface *surface) {
  bw_faces *faces = NULL;
  if (lbw_state_of(L)->running || surface->triangle_count > MAX_TRIANGLES)
    return;
  bw_context *context = lbw_enter(L);
  if (bw_faces_find(context, surface, 0, &faces) != BW_OK)
    bw_clear_failure(context);
  lbw_leave(L, BW_OK, 0);
  if (!faces)
    return;
  lua_pushcfunction(L, add_lines);
  lua_insert(L, -2);
  lua_pushlightuserdata(L, faces);
  int failure = lua_pcall(L, 2, 1, 0);
  bw_release(faces);
  if (failure)
    lua_error(L);
}
