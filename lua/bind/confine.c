/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* core.may_use, core.confined, core.sandbox: what a script in a sandbox may use. */
#include "bind.h"

/* may_use(path, "read" | "write" | "replace"): true, or nil, message, details */
static int core_may_use(lua_State *L) {
  static const char *const words[] = {"read", "write", "replace", NULL};
  const char *path = lbw_check_text(L, 1, NULL);
  int use = lbw_check_word(L, 2, words);
  bw_status status = bw_may_use(lbw_enter(L), path, (bw_use)use);
  lua_pushboolean(L, 1);
  return lbw_leave(L, status, 1);
}

/* confined(): the folder, or nil */
static int core_confined(lua_State *L) {
  lua_pushstring(L, bw_confined_to());
  return 1;
}

/* sandbox(): {folder, landlock (the kernel's version of it, 0: none), calls (filtered)}, or nil.
 * The program leaves it in the registry. */
static int core_sandbox(lua_State *L) {
  if (lua_getfield(L, LUA_REGISTRYINDEX, "barwright.sandbox") != LUA_TTABLE)
    return 1;
  lua_createtable(L, 0, 3);
  for (lua_pushnil(L); lua_next(L, -3); lua_pop(L, 1)) {
    lua_pushvalue(L, -2);
    lua_pushvalue(L, -2);
    lua_rawset(L, -5);
  }
  return 1;
}

void lbw_open_confine(lua_State *L) {
  static const luaL_Reg functions[] = {{"may_use", core_may_use},
                                       {"confined", core_confined},
                                       {"sandbox", core_sandbox},
                                       {NULL, NULL}};
  luaL_setfuncs(L, functions, 0);
}
