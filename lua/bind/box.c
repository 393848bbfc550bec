/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* Boxes: userdata with one engine object each, their classes, and the collector's account.
 *
 * Lua's collector sees only the few bytes of a box. lbw_box_account tells it the rest: a step of
 * the collector as large as the object, and a full collection when the bytes held by open boxes
 * have doubled since the last one. */
#include "bind.h"

#include <stdio.h>
#include <string.h>

enum { STEP_BYTES = 1 << 16 };
static const size_t full_collection_margin = (size_t)64 << 20;

/* The box at index if it is one, of whatever class. */
static lbw_box *any_box(lua_State *L, int index) {
  lbw_box *box = NULL;
  index = lua_absindex(L, index);
  if (lua_type(L, index) == LUA_TUSERDATA && lua_getmetatable(L, index)) {
    lua_pushliteral(L, "__class");
    if (lua_rawget(L, -2) == LUA_TLIGHTUSERDATA)
      box = (lbw_box *)lua_touserdata(L, index);
    lua_pop(L, 2);
  }
  return box;
}

const char *lbw_type_name(lua_State *L, int index) {
  lbw_box *box = any_box(L, index);
  return box ? box->class->name : luaL_typename(L, index);
}

static lbw_box *box_of(lua_State *L, int index, const lbw_class *class) {
  lbw_box *box = any_box(L, index);
  return box && box->class == class ? box : NULL;
}

const void *lbw_test(lua_State *L, int index, const lbw_class *class) {
  lbw_box *box = box_of(L, index, class);
  return box ? box->object : NULL;
}

lbw_box *lbw_check_box(lua_State *L, int argument, const lbw_class *class) {
  lbw_box *box = box_of(L, argument, class);
  if (!box)
    lbw_argument_error(
        L, argument,
        lua_pushfstring(L, "%s expected, got %s", class->name, lbw_type_name(L, argument)));
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
  bw_release(extra);
  bw_release(object);
}

/* The metatable is open to scripts, so even its functions are called with anything. */
static lbw_box *self_box(lua_State *L) {
  lbw_box *box = any_box(L, 1);
  lbw_argument_check(L, box, 1, "an object of barwright expected");
  return box;
}

static int box_gc(lua_State *L) {
  lbw_box_close(L, self_box(L));
  return 0;
}

/* object:close(), and the end of a <close> variable's scope */
static int box_close(lua_State *L) {
  lbw_box *box = self_box(L);
  if (lbw_state_of(L)->running)
    return lbw_error(L, "the engine is busy: nothing may be closed by a function that it calls");
  lbw_box_close(L, box);
  lua_pushnil(L);
  lua_setiuservalue(L, 1, 1);
  return 0;
}

/* upvalue: the class's own, for open ones, or nil */
static int box_tostring(lua_State *L) {
  lbw_box *box = self_box(L);
  if (box->object && lua_isfunction(L, lua_upvalueindex(1))) {
    lua_settop(L, 1);
    lua_pushvalue(L, lua_upvalueindex(1));
    lua_insert(L, 1);
    lua_call(L, 1, 1);
    return 1;
  }
  lua_pushfstring(L, "%s%s", box->class->name, box->object ? "" : " (closed)");
  return 1;
}

static int box_equal(lua_State *L) {
  lbw_box *a = any_box(L, 1), *b = any_box(L, 2);
  lua_pushboolean(L, a && b && a->object && a->object == b->object);
  return 1;
}

static const char *const *names_in(lua_State *L, int methods, int properties, size_t *count) {
  size_t n = 0;
  const int tables[2] = {methods, properties};
  for (int t = 0; t < 2; t++)
    for (lua_pushnil(L); lua_next(L, tables[t]); lua_pop(L, 1))
      n++;
  const char **name = (const char **)lua_newuserdatauv(L, (n + 1) * sizeof *name, 0);
  n = 0;
  for (int t = 0; t < 2; t++)
    for (lua_pushnil(L); lua_next(L, tables[t]); lua_pop(L, 1))
      if (lua_type(L, -2) == LUA_TSTRING && strncmp(lua_tostring(L, -2), "__", 2) != 0)
        name[n++] = lua_tostring(L, -2);
  *count = n;
  return name;
}

static int unknown_field(lua_State *L, lbw_box *box) {
  if (lua_type(L, 2) != LUA_TSTRING)
    return lbw_error(L, "a %s cannot be indexed with %s", box->class->name, lbw_type_name(L, 2));
  size_t count;
  const char *const *name = names_in(L, lua_upvalueindex(1), lua_upvalueindex(2), &count);
  const char *wrong = lua_tostring(L, 2);
  return lbw_error(L, "a %s has no '%s': %s", box->class->name, wrong,
                   lbw_suggestion(L, wrong, name, count));
}

/* upvalues: methods, properties, the class's own __index or nil */
static int box_index(lua_State *L) {
  lbw_box *box = self_box(L);
  lua_settop(L, 2);
  lua_pushvalue(L, 2);
  if (lua_rawget(L, lua_upvalueindex(1)) != LUA_TNIL)
    return 1;
  lua_pop(L, 1);
  lua_pushvalue(L, 2);
  if (lua_rawget(L, lua_upvalueindex(2)) != LUA_TNIL) {
    if (!box->object)
      return lbw_error(L, "this %s is closed", box->class->name);
    lua_pushvalue(L, 1);
    lua_call(L, 1, 1);
    return 1;
  }
  lua_pop(L, 1);
  if (lua_isfunction(L, lua_upvalueindex(3)) && lua_type(L, 2) != LUA_TSTRING) {
    lua_pushvalue(L, lua_upvalueindex(3));
    lua_insert(L, 1);
    lua_call(L, 2, 1);
    return 1;
  }
  return unknown_field(L, box);
}

static int box_newindex(lua_State *L) {
  lbw_box *box = self_box(L);
  return lbw_error(L, "a %s cannot be changed by assignment", box->class->name);
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

/* The metatable: the class itself under __class, methods and properties as plain tables under
 * __methods and __properties, so that completion and the tests can list them and the Lua layer add
 * to them. */
void lbw_class_register(lua_State *L, const lbw_class *class) {
  static const luaL_Reg common[] = {{"__gc", box_gc},
                                    {"__close", box_close},
                                    {"__eq", box_equal},
                                    {"__newindex", box_newindex},
                                    {NULL, NULL}};
  lua_newtable(L);
  luaL_setfuncs(L, common, 0);
  lua_pushfstring(L, "barwright.%s", class->name);
  lua_setfield(L, -2, "__name");
  lua_pushlightuserdata(L, (void *)class);
  lua_setfield(L, -2, "__class");
  if (class->meta)
    luaL_setfuncs(L, class->meta, 0);
  lua_getfield(L, -1, "__tostring");
  lua_pushcclosure(L, box_tostring, 1);
  lua_setfield(L, -2, "__tostring");
  lua_newtable(L);
  luaL_setfuncs(L, class->methods, 0);
  lua_pushcfunction(L, box_close);
  lua_setfield(L, -2, "close");
  lua_pushvalue(L, -1);
  lua_setfield(L, -3, "__methods");
  lua_newtable(L);
  luaL_setfuncs(L, class->properties, 0);
  lua_pushvalue(L, -1);
  lua_setfield(L, -4, "__properties");
  lua_getfield(L, -3, "__index"); /* the class's own, for numbers */
  lua_pushcclosure(L, box_index, 3);
  lua_setfield(L, -2, "__index");
  lua_pushvalue(L, -1);
  lua_rawsetp(L, LUA_REGISTRYINDEX, class);
  if (lua_getfield(L, -2, "classes") == LUA_TTABLE) {
    lua_pushvalue(L, -2);
    lua_setfield(L, -2, class->name);
  }
  lua_pop(L, 2);
}

void lbw_add_methods(lua_State *L, const lbw_class *class, const luaL_Reg *methods) {
  lua_rawgetp(L, LUA_REGISTRYINDEX, class);
  lua_getfield(L, -1, "__methods");
  luaL_setfuncs(L, methods, 0);
  lua_pop(L, 2);
}
