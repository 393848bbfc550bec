/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* bw.surface.read of STEP and IGES: loads the reader, and tells what the file says. */
#include "bind.h"

/* Loads barwright.cad, which registers the reader. On failure nil, message, details are on the
 * stack. */
static bool ready(lua_State *L) {
  lua_getglobal(L, "require");
  lua_pushliteral(L, "barwright.cad");
  if (lua_pcall(L, 1, 0, 0) == LUA_OK)
    return true;
  lua_pushnil(L);
  lua_insert(L, -2);
  lua_createtable(L, 0, 1);
  lua_pushstring(L, bw_status_word(BW_UNSUPPORTED));
  lua_setfield(L, -2, "status");
  return false;
}

static void push_body(lua_State *L, const bw_cad_body *body) {
  lua_createtable(L, 0, 5);
  lua_pushstring(L, body->name);
  lua_setfield(L, -2, "name");
  lua_pushboolean(L, body->closed);
  lua_setfield(L, -2, "closed");
  if (body->closed) {
    lua_pushnumber(L, body->volume);
    lua_setfield(L, -2, "volume");
  }
  lua_pushnumber(L, body->area);
  lua_setfield(L, -2, "area");
  lbw_push(L, &lbw_surface_class, body->surface);
  lua_setfield(L, -2, "surface");
}

static void push_face(lua_State *L, const bw_cad_face *face) {
  lua_createtable(L, 0, 5);
  lua_pushstring(L, face->name);
  lua_setfield(L, -2, "name");
  lua_pushstring(L, bw_cad_kind_word(face->kind));
  lua_setfield(L, -2, "kind");
  lua_pushinteger(L, face->body + (lua_Integer)1);
  lua_setfield(L, -2, "body");
  lua_pushnumber(L, face->area);
  lua_setfield(L, -2, "area");
  if (face->radius > 0) {
    lua_pushnumber(L, face->radius);
    lua_setfield(L, -2, "radius");
  }
}

/* (bw_cad_file *): surface, info; protected, so that the file is released */
static int push_file(lua_State *L) {
  const bw_cad_file *file = (const bw_cad_file *)lua_touserdata(L, 1);
  double volume = 0, area = 0;
  bool closed = true;
  lbw_push(L, &lbw_surface_class, file->surface);
  lua_createtable(L, 0, 10);
  lua_pushstring(L, file->format);
  lua_setfield(L, -2, "format");
  lua_pushinteger(L, 0);
  lua_setfield(L, -2, "polygons");
  lua_pushinteger(L, 0);
  lua_setfield(L, -2, "skipped");
  lua_pushinteger(L, file->face_count);
  lua_setfield(L, -2, "groups");
  lua_pushnumber(L, file->metres_per_unit);
  lua_setfield(L, -2, "metres_per_unit");
  lua_createtable(L, (int)file->body_count, 0);
  for (int32_t i = 0; i < file->body_count; i++) {
    push_body(L, &file->body[i]);
    lua_rawseti(L, -2, i + (lua_Integer)1);
    volume += file->body[i].volume;
    area += file->body[i].area;
    closed = closed && file->body[i].closed;
  }
  lua_setfield(L, -2, "bodies");
  lua_createtable(L, (int)file->face_count, 0);
  for (int32_t i = 0; i < file->face_count; i++) {
    push_face(L, &file->face[i]);
    lua_rawseti(L, -2, i + (lua_Integer)1);
  }
  lua_setfield(L, -2, "faces");
  if (closed) {
    lua_pushnumber(L, volume);
    lua_setfield(L, -2, "exact_volume");
  }
  lua_pushnumber(L, area);
  lua_setfield(L, -2, "exact_area");
  return 2;
}

int lbw_cad_read(lua_State *L, const char *path, const bw_cad_options *options) {
  if (!(options->tolerance >= 0) || !(options->angle >= 0))
    return lbw_error(L, "surface.read: options 'tolerance' and 'angle': above 0 expected");
  if (!ready(L))
    return 3;
  bw_cad_file file = {0};
  lua_pushcfunction(L, push_file);
  lua_pushlightuserdata(L, &file);
  bw_status status = bw_cad_read(lbw_enter(L), path, options, &file);
  if (status != BW_OK) {
    lua_pop(L, 2);
    return lbw_leave(L, status, 0);
  }
  lbw_state_of(L)->running = 0;
  int failure = lua_pcall(L, 1, 2, 0);
  bw_cad_file_clear(&file);
  return failure ? lua_error(L) : lbw_leave(L, BW_OK, 2);
}
