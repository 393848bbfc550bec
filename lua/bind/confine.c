/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* core.may_use, core.confined, core.make_folder: files, for a script in a sandbox and outside. */
#include "bind.h"

#include <errno.h>
#include <string.h>
#include <sys/stat.h>

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

static bw_status make(bw_context *context, const char *path) {
  struct stat about;
  bw_status status = bw_may_use(context, path, BW_TO_WRITE);
  if (status != BW_OK)
    return status;
  if (mkdir(path, 0777) == 0 ||
      (errno == EEXIST && stat(path, &about) == 0 && S_ISDIR(about.st_mode)))
    return BW_OK;
  status = bw_fail(context, BW_IO, "%s: cannot be made as a folder: %s", path, strerror(errno));
  bw_detail_text(context, "file", path);
  return status;
}

/* make_folder(path): with the folders that it lies in; true also where it is there already */
static int core_make_folder(lua_State *L) {
  size_t length;
  const char *path = lbw_check_text(L, 1, &length);
  lbw_argument_check(L, length > 0 && strlen(path) == length, 1, "a path expected");
  char *part = (char *)lua_newuserdatauv(L, length + 1, 0);
  bw_status status = BW_OK;
  bw_context *context = lbw_enter(L);
  for (size_t i = 1; i <= length && status == BW_OK; i++) {
    struct stat about;
    if (path[i] != '/' && path[i] != 0)
      continue;
    memcpy(part, path, i);
    part[i] = 0;
    if (path[i] == 0 || stat(part, &about) != 0)
      status = make(context, part);
  }
  lua_pushboolean(L, 1);
  return lbw_leave(L, status, 1);
}

void lbw_open_confine(lua_State *L) {
  static const luaL_Reg functions[] = {{"may_use", core_may_use},
                                       {"confined", core_confined},
                                       {"sandbox", core_sandbox},
                                       {"make_folder", core_make_folder},
                                       {NULL, NULL}};
  luaL_setfuncs(L, functions, 0);
}
