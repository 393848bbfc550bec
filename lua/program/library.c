/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* Where the library's Lua files are, and the sandbox, which leaves them readable. */
#include "program.h"

#include <limits.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

enum { LONG_PATH = PATH_MAX + 64 };

static bool readable(const char *folder, const char *file) {
  char path[LONG_PATH + 64];
  int length = snprintf(path, sizeof path, "%s/%s", folder, file);
  return length > 0 && (size_t)length < sizeof path && access(path, R_OK) == 0;
}

/* Lua files, and the folder in which the folder barwright has those that are compiled: beside the
 * program (a build tree), else under the prefix it lies in, else where it was meant to be
 * installed. */
static void find(char files[LONG_PATH], char modules[LONG_PATH]) {
  char self[PATH_MAX];
  ssize_t length = readlink("/proc/self/exe", self, sizeof self - 1);
  snprintf(files, LONG_PATH, "%s", BARWRIGHT_LUA_FOLDER);
  snprintf(modules, LONG_PATH, "%s/..", BARWRIGHT_MODULE_FOLDER);
  if (length <= 0)
    return;
  self[length] = 0;
  char *slash = strrchr(self, '/');
  if (slash)
    *slash = 0;
  char build[LONG_PATH], installed[LONG_PATH];
  snprintf(build, sizeof build, "%s/lua", self);
  snprintf(installed, sizeof installed, "%s/../share/lua/5.4", self);
  if (readable(build, "barwright/init.lua")) {
    snprintf(files, LONG_PATH, "%s", build);
    snprintf(modules, LONG_PATH, "%s", build);
  } else if (readable(installed, "barwright/init.lua")) {
    snprintf(files, LONG_PATH, "%s", installed);
    snprintf(modules, LONG_PATH, "%s/%s", self, BARWRIGHT_MODULES_FROM_BIN);
  }
}

/* Goes before what LUA_PATH says: the program and its Lua files belong together. barwright.core is
 * in the program; barwright.mpi is a file. */
static void set_path(lua_State *L, const char *files, const char *modules) {
  lua_getglobal(L, "package");
  lua_getfield(L, -1, "path");
  lua_pushfstring(L, "%s/?.lua;%s/?/init.lua;%s", files, files, lua_tostring(L, -1));
  lua_setfield(L, -3, "path");
  lua_pop(L, 1);
  lua_getfield(L, -1, "cpath");
  lua_pushfstring(L, "%s/?.so;%s", modules, lua_tostring(L, -1));
  lua_setfield(L, -3, "cpath");
  lua_settop(L, 0);
}

/* ---- the sandbox ----------------------------------------------------------------------------- */

/* The folder that a file lies in, links followed; false when it is not there. */
static bool home_of(const char *folder, const char *file, char real[PATH_MAX]) {
  char path[LONG_PATH + 64];
  snprintf(path, sizeof path, "%s/%s", folder, file);
  if (!realpath(path, real))
    return false;
  char *slash = strrchr(real, '/');
  if (slash && slash != real)
    *slash = 0;
  return true;
}

/* What can be read beside the folder: the library, and the script itself. In a build tree the
 * library's files are links into the source tree, and bundles of pages lie beside its folder. */
enum { PLACES = 6 };
static int find_readable(const char *files, const char *script, char place[PLACES][PATH_MAX]) {
  static const char *const known[] = {"barwright/init.lua", "barwright/report.html",
                                      "../web/live.js"};
  char own[LONG_PATH + 16];
  int places = 0;
  snprintf(own, sizeof own, "%s/barwright", files);
  if (realpath(own, place[places]))
    places++;
  for (size_t i = 0; i < sizeof known / sizeof *known; i++)
    if (home_of(files, known[i], place[places]))
      places++;
  if (script && access(script, R_OK) == 0 && realpath(script, place[places]))
    places++;
  return places;
}

/* bw.sandbox() shows it. */
static void keep_walls(lua_State *L, program_walls walls) {
  lua_createtable(L, 0, 3);
  lua_pushstring(L, bw_confined_to());
  lua_setfield(L, -2, "folder");
  lua_pushinteger(L, walls.landlock);
  lua_setfield(L, -2, "landlock");
  lua_pushboolean(L, walls.calls);
  lua_setfield(L, -2, "calls");
  lua_setfield(L, LUA_REGISTRYINDEX, "barwright.sandbox");
}

/* Both walls, before any script and any of the library's own Lua files. */
static bool enter_sandbox(lua_State *L, const char *files, const program_command *c) {
  static char place[PLACES][PATH_MAX];
  const char *list[PLACES + 1] = {NULL};
  bw_context *context = lbw_state_of(L)->context;
  bw_status status = BW_OK;
  int places = find_readable(files, c->script, place);
  for (int i = 0; i < places && status == BW_OK; i++) {
    list[i] = place[i];
    status = bw_confine_read_also(context, place[i]);
  }
  if (status == BW_OK)
    status = bw_confine(context, c->limits.sandbox);
  if (status != BW_OK) {
    fprintf(stderr, "barwright: --sandbox: %s\n", bw_message(context));
    return false;
  }
  program_walls walls = program_close_kernel(bw_confined_to(), list);
  if (!walls.landlock)
    fputs("barwright: this kernel has no Landlock: the sandbox stands on barwright's own checks\n",
          stderr);
  keep_walls(L, walls);
  return program_close_lua(L);
}

bool program_set_library(lua_State *L, const program_command *c) {
  char files[LONG_PATH], modules[LONG_PATH];
  find(files, modules);
  set_path(L, files, modules);
  return !c->limits.sandbox || enter_sandbox(L, files, c);
}
