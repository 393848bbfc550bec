/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* Classes: the metatables of boxes.
 *
 * A metatable never reaches a script (__metatable), so its functions are called by Lua alone. What
 * the Lua files of the library extend is the class's description, core.classes[name] = {name,
 * methods, properties, tostring}. Whatever is written there, every function of C in it checks its
 * box and is guarded (guard.c). */
#include "bind.h"

#include <string.h>

const char lbw_classes_key; /* registry: metatable -> class */

static lbw_box *self_box(lua_State *L) {
  lbw_box *box = lbw_any_box(L, 1);
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
  if (lbw_busy(lbw_state_of(L)))
    return lbw_error(L, "the engine is busy: nothing may be closed by a function that it calls");
  lbw_box_close(L, box);
  lua_pushnil(L);
  lua_setiuservalue(L, 1, 1);
  return 0;
}

/* upvalue: the class's description. Its tostring is called for open boxes. */
static int box_tostring(lua_State *L) {
  lbw_box *box = self_box(L);
  if (box->object && lua_getfield(L, lua_upvalueindex(1), "tostring") == LUA_TFUNCTION) {
    lua_pushvalue(L, 1);
    lua_call(L, 1, 1);
    return 1;
  }
  lua_pushfstring(L, "%s%s", box->class->name, box->object ? "" : " (closed)");
  return 1;
}

static int box_equal(lua_State *L) {
  lbw_box *a = lbw_any_box(L, 1), *b = lbw_any_box(L, 2);
  lua_pushboolean(L, a && b && a->object && a->object == b->object);
  return 1;
}

static const char *const *names_in(lua_State *L, int methods, int properties, size_t *count) {
  size_t n = 0;
  const int tables[2] = {methods, properties};
  for (int t = 0; t < 2; t++)
    for (lua_pushnil(L); lua_next(L, tables[t]); lua_pop(L, 1))
      n++;
  const size_t capacity = n; /* a finaliser may add names meanwhile */
  const char **name = (const char **)lua_newuserdatauv(L, (capacity + 1) * sizeof *name, 0);
  n = 0;
  for (int t = 0; t < 2; t++)
    for (lua_pushnil(L); lua_next(L, tables[t]); lua_pop(L, 1))
      if (n < capacity && lua_type(L, -2) == LUA_TSTRING &&
          strncmp(lua_tostring(L, -2), "__", 2) != 0)
        name[n++] = lua_tostring(L, -2);
  *count = n;
  return name;
}

static int unknown_field(lua_State *L, lbw_box *box) {
  if (lua_type(L, 2) != LUA_TSTRING)
    return lbw_error(L, "%s: a name expected in brackets, got %s", lbw_spoken(L, box->class->name),
                     lbw_got(L, 2));
  size_t count;
  const char *const *name = names_in(L, lua_upvalueindex(1), lua_upvalueindex(2), &count);
  const char *wrong = lua_tostring(L, 2);
  return lbw_error(L, "%s has no '%s': %s", lbw_spoken(L, box->class->name), wrong,
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
  return lbw_error(L, "%s cannot be changed by assignment", lbw_spoken(L, box->class->name));
}

/* Adds functions of C, checked and guarded, to the table on the top of the stack. */
static void add_functions(lua_State *L, const luaL_Reg *functions, const lbw_class *class) {
  for (; functions->name; functions++) {
    lbw_push_guarded(L, functions->func, class);
    lua_setfield(L, -2, functions->name);
  }
}

/* Adds the class to core.classes; `core` is the module's place on the stack. The description is on
 * the top. */
static void list_class(lua_State *L, const lbw_class *class, int core) {
  if (lua_getfield(L, core, "classes") == LUA_TTABLE) {
    lua_pushvalue(L, -2);
    lua_setfield(L, -2, class->name);
  }
  lua_pop(L, 1);
}

void lbw_class_register(lua_State *L, const lbw_class *class) {
  static const luaL_Reg common[] = {{"__gc", box_gc},
                                    {"__close", box_close},
                                    {"__eq", box_equal},
                                    {"__newindex", box_newindex},
                                    {NULL, NULL}};
  int core = lua_gettop(L), description = core + 1, meta = core + 2;
  lua_newtable(L);
  lua_pushstring(L, class->name);
  lua_setfield(L, description, "name");
  lua_newtable(L);
  luaL_setfuncs(L, common, 0);
  if (class->meta)
    add_functions(L, class->meta, class);
  lua_pushfstring(L, "barwright.%s", class->name);
  lua_pushvalue(L, -1);
  lua_setfield(L, meta, "__name");
  lua_setfield(L, meta, "__metatable");
  lua_getfield(L, meta, "__tostring");
  lua_setfield(L, description, "tostring");
  lua_pushvalue(L, description);
  lua_pushcclosure(L, box_tostring, 1);
  lua_setfield(L, meta, "__tostring");
  lua_newtable(L);
  add_functions(L, class->methods, class);
  lua_pushcfunction(L, box_close);
  lua_setfield(L, -2, "close");
  lua_pushvalue(L, -1);
  lua_setfield(L, description, "methods");
  lua_pushvalue(L, -1);
  lua_setfield(L, meta, "__methods"); /* for completion in the prompt */
  lua_newtable(L);
  add_functions(L, class->properties, class);
  lua_pushvalue(L, -1);
  lua_setfield(L, description, "properties");
  lua_pushvalue(L, -1);
  lua_setfield(L, meta, "__properties");
  lua_getfield(L, meta, "__index"); /* the class's own, for numbers */
  lua_pushcclosure(L, box_index, 3);
  lua_setfield(L, meta, "__index");
  lua_pushvalue(L, meta);
  lua_rawsetp(L, LUA_REGISTRYINDEX, class);
  if (lua_rawgetp(L, LUA_REGISTRYINDEX, &lbw_classes_key) != LUA_TTABLE) {
    lua_pop(L, 1);
    lua_newtable(L);
    lua_pushvalue(L, -1);
    lua_rawsetp(L, LUA_REGISTRYINDEX, &lbw_classes_key);
  }
  lua_pushvalue(L, meta);
  lua_pushlightuserdata(L, (void *)class);
  lua_rawset(L, -3);
  lua_settop(L, description);
  list_class(L, class, core);
  lua_settop(L, core);
}

void lbw_add_methods(lua_State *L, const lbw_class *class, const luaL_Reg *methods) {
  lua_getfield(L, -1, "classes");
  lua_getfield(L, -1, class->name);
  lua_getfield(L, -1, "methods");
  add_functions(L, methods, class);
  lua_pop(L, 3);
}

void lbw_add_operators(lua_State *L, const lbw_class *class, const luaL_Reg *operators) {
  lua_rawgetp(L, LUA_REGISTRYINDEX, class);
  add_functions(L, operators, NULL); /* either operand may be the box */
  lua_pop(L, 1);
}

/* class_name(value): "mesh", "array", ...; nil for what is no object of the engine */
static int core_class_name(lua_State *L) {
  lbw_box *box = lbw_any_box(L, 1);
  if (box)
    lua_pushstring(L, box->class->name);
  else
    lua_pushnil(L);
  return 1;
}

void lbw_open_classes(lua_State *L) {
  lua_newtable(L);
  lua_setfield(L, -2, "classes");
  lua_pushcfunction(L, core_class_name);
  lua_setfield(L, -2, "class_name");
}
