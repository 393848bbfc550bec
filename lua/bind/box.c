/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* Boxes: userdata with one engine object each, and the collector's account.
 *
 * Lua's collector sees only the few bytes of a box. lbw_box_account reports the rest: a step of
 * the collector as large as the object, and a full collection when the bytes held by open boxes
 * have doubled since the last one. */
#include "bind.h"

enum { STEP_BYTES = 1 << 16 };
static const size_t full_collection_margin = (size_t)64 << 20;

/* A box has the metatable that the registry keeps for its class. What a script writes into tables
 * decides nothing. */
static lbw_box *box_of(lua_State *L, int index, const lbw_class *class) {
  lbw_box *box = NULL;
  if (lua_type(L, index) == LUA_TUSERDATA && lua_getmetatable(L, index)) {
    lua_rawgetp(L, LUA_REGISTRYINDEX, class);
    if (lua_rawequal(L, -1, -2))
      box = (lbw_box *)lua_touserdata(L, lua_absindex(L, index - (index < 0 ? 2 : 0)));
    lua_pop(L, 2);
  }
  return box;
}

lbw_box *lbw_any_box(lua_State *L, int index) {
  const lbw_class *class = NULL;
  if (lua_type(L, index) == LUA_TUSERDATA && lua_getmetatable(L, index)) {
    lua_rawgetp(L, LUA_REGISTRYINDEX, &lbw_classes_key);
    lua_insert(L, -2);
    if (lua_rawget(L, -2) == LUA_TLIGHTUSERDATA)
      class = (const lbw_class *)lua_touserdata(L, -1);
    lua_pop(L, 2);
  }
  return class ? (lbw_box *)lua_touserdata(L, index) : NULL;
}

const char *lbw_type_name(lua_State *L, int index) {
  lbw_box *box = lbw_any_box(L, index);
  return box ? box->class->name : luaL_typename(L, index);
}

const void *lbw_test(lua_State *L, int index, const lbw_class *class) {
  lbw_box *box = box_of(L, index, class);
  return box ? box->object : NULL;
}

lbw_box *lbw_check_box(lua_State *L, int argument, const lbw_class *class) {
  lbw_box *box = box_of(L, argument, class);
  if (!box)
    lbw_class_error(L, argument, class);
  else if (!box->object)
    lbw_argument_error(L, argument, lua_pushfstring(L, "this %s is closed", class->name));
  return box;
}

const void *lbw_check(lua_State *L, int argument, const lbw_class *class) {
  return lbw_check_box(L, argument, class)->object;
}

lbw_box *lbw_box_new(lua_State *L, const lbw_class *class) {
  lbw_box *box = (lbw_box *)lua_newuserdatauv(L, sizeof *box, 1);
  *box = (lbw_box){.class = class};
  lua_rawgetp(L, LUA_REGISTRYINDEX, class);
  lua_setmetatable(L, -2);
  return box;
}

void lbw_box_account(lua_State *L, lbw_box *box) {
  lbw_state *state = lbw_state_of(L);
  size_t before = box->bytes;
  box->bytes = box->class->bytes ? box->class->bytes(box->object) : bw_bytes(box->object);
  if (box->extra)
    box->bytes += bw_bytes(box->extra);
  state->external += box->bytes - before;
  if (box->bytes <= before + STEP_BYTES || state->running)
    return;
  if (state->external > 2 * state->external_after + full_collection_margin) {
    lua_gc(L, LUA_GCCOLLECT);
    state->external_after = state->external;
  } else {
    size_t kilobytes = (box->bytes - before) / 1024;
    lua_gc(L, LUA_GCSTEP, kilobytes > 1 << 20 ? 1 << 20 : (int)kilobytes);
  }
}

void lbw_box_fill(lua_State *L, lbw_box *box, const void *object) {
  box->object = object;
  /* The engine has returned: what follows may raise, and may run the collector and with it
   * finalisers. The box is on the stack, so it stays. */
  lbw_state_of(L)->running = 0;
  if (object)
    lbw_box_account(L, box);
}

int lbw_leave_object(lua_State *L, lbw_box *box, const void *object, bw_status status) {
  lbw_box_fill(L, box, object);
  return lbw_leave(L, status, 1);
}

void lbw_push(lua_State *L, const lbw_class *class, const void *object) {
  lbw_box *box = lbw_box_new(L, class); /* may raise: the reference is taken after it */
  lbw_box_fill(L, box, bw_retain(object));
}

void lbw_box_close(lua_State *L, lbw_box *box) {
  lbw_state *state = lbw_state_of(L);
  state->external -= box->bytes;
  box->bytes = 0;
  const void *object = box->object, *extra = box->extra;
  box->object = box->extra = NULL;
  lbw_release_unused(state, extra);
  lbw_release_unused(state, object);
}

int lbw_cached(lua_State *L, const char *key, lua_CFunction compute) {
  if (lua_getiuservalue(L, 1, 1) != LUA_TTABLE) {
    lua_pop(L, 1);
    lua_newtable(L);
    lua_pushvalue(L, -1);
    lua_setiuservalue(L, 1, 1);
  }
  if (lua_getfield(L, -1, key) != LUA_TNIL)
    return 1;
  lua_pop(L, 1);
  lua_pushcfunction(L, compute);
  lua_pushvalue(L, 1);
  lua_call(L, 1, 1);
  lua_pushvalue(L, -1);
  lua_setfield(L, -3, key);
  return 1;
}
