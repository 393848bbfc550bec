/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* barwright.mpi: the face of libbarwright_distributed, for lua/barwright/distributed.lua. A module
 * of its own, so that nothing else loads MPI; it shares only libbarwright with barwright.core. */
#include <lauxlib.h>
#include <lua.h>
#include <math.h>
#include <string.h>

#include "barwright/distributed.h"

static const char context_key; /* registry: a userdata that holds the context */

static int context_gc(lua_State *L) {
  bw_context **held = (bw_context **)lua_touserdata(L, 1);
  bw_context_destroy(*held);
  *held = NULL;
  return 0;
}

static bw_context *context_of(lua_State *L) {
  lua_rawgetp(L, LUA_REGISTRYINDEX, &context_key);
  bw_context **held = (bw_context **)lua_touserdata(L, -1);
  lua_pop(L, 1);
  return *held;
}

/* nil, message, {status = , ...} */
static int failed(lua_State *L, bw_context *context, bw_status status) {
  const char *key, *text;
  double number;
  lua_pushnil(L);
  lua_pushstring(L, bw_message(context));
  lua_createtable(L, 0, 2);
  lua_pushstring(L, bw_status_word(status));
  lua_setfield(L, -2, "status");
  for (int i = 0; bw_detail(context, i, &key, &number, &text); i++) {
    if (text)
      lua_pushstring(L, text);
    else
      lua_pushnumber(L, number);
    lua_setfield(L, -2, key);
  }
  return 3;
}

/* start(together): this rank, number of ranks */
static int mpi_start(lua_State *L) {
  bw_context *context = context_of(L);
  bw_status status = bw_world_start(context, lua_toboolean(L, 1));
  if (status != BW_OK)
    return failed(L, context, status);
  lua_pushinteger(L, bw_world_rank());
  lua_pushinteger(L, bw_world_size());
  return 2;
}

static int mpi_rank(lua_State *L) {
  lua_pushinteger(L, bw_world_rank());
  return 1;
}

static int mpi_size(lua_State *L) {
  lua_pushinteger(L, bw_world_size());
  return 1;
}

/* serve(): true when rank 0 has left */
static int mpi_serve(lua_State *L) {
  bw_context *context = context_of(L);
  bw_status status = bw_world_serve(context);
  if (status != BW_OK)
    return failed(L, context, status);
  lua_pushboolean(L, 1);
  return 1;
}

/* send(rank, tag, bytes): true */
static int mpi_send(lua_State *L) {
  bw_context *context = context_of(L);
  size_t count;
  int rank = (int)luaL_checkinteger(L, 1), tag = (int)luaL_checkinteger(L, 2);
  const char *bytes = luaL_checklstring(L, 3, &count);
  bw_status status = bw_world_send(context, rank, tag, bytes, count);
  if (status != BW_OK)
    return failed(L, context, status);
  lua_pushboolean(L, 1);
  return 1;
}

static int push_bytes(lua_State *L) {
  lua_pushlstring(L, (const char *)lua_touserdata(L, 1), (size_t)lua_tointeger(L, 2));
  return 1;
}

/* receive(seconds): rank, tag, bytes; or nil when none came in time */
static int mpi_receive(lua_State *L) {
  bw_context *context = context_of(L);
  double seconds = luaL_optnumber(L, 1, -1);
  int rank = 0, tag = 0;
  unsigned char *bytes = NULL;
  size_t count = 0;
  bw_status status = bw_world_receive(context, seconds, &rank, &tag, &bytes, &count);
  if (status != BW_OK)
    return failed(L, context, status);
  if (!bytes) {
    lua_pushnil(L);
    return 1;
  }
  lua_pushinteger(L, rank);
  lua_pushinteger(L, tag);
  lua_pushcfunction(L, push_bytes); /* protected: the bytes are not Lua's */
  lua_pushlightuserdata(L, bytes);
  lua_pushinteger(L, (lua_Integer)count);
  int failure = lua_pcall(L, 2, 1, 0);
  bw_free(bytes);
  return failure ? lua_error(L) : 3;
}

static int mpi_abort(lua_State *L) {
  bw_world_abort(luaL_checkstring(L, 1));
  return 0;
}

static int mpi_versions(lua_State *L) {
  bw_context *context = context_of(L);
  char *text = NULL;
  bw_status status = bw_world_versions(context, &text);
  if (status != BW_OK)
    return failed(L, context, status);
  lua_pushstring(L, text);
  bw_free(text);
  return 1;
}

int luaopen_barwright_mpi(lua_State *L);
int luaopen_barwright_mpi(lua_State *L) {
  static const luaL_Reg functions[] = {
      {"start", mpi_start}, {"rank", mpi_rank},         {"size", mpi_size},
      {"serve", mpi_serve}, {"send", mpi_send},         {"receive", mpi_receive},
      {"abort", mpi_abort}, {"versions", mpi_versions}, {NULL, NULL}};
  bw_context **held = (bw_context **)lua_newuserdatauv(L, sizeof *held, 0);
  *held = NULL;
  lua_createtable(L, 0, 1);
  lua_pushcfunction(L, context_gc);
  lua_setfield(L, -2, "__gc");
  lua_setmetatable(L, -2);
  *held = bw_context_create();
  if (!*held)
    return luaL_error(L, "not enough memory");
  lua_rawsetp(L, LUA_REGISTRYINDEX, &context_key);
  luaL_newlib(L, functions);
  return 1;
}
