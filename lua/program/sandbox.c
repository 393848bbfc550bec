/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* The sandbox's first wall: what Lua itself could open, start or reach.
 *
 * The tables io, os, package and debug stay, with functions of these names that ask bw_may_use
 * before the original is called, or refuse. The originals are left in upvalues of C functions,
 * which nothing that a script has can read: debug keeps traceback and what getinfo tells of places.
 * Chunks are loaded as text alone, since bytecode can do anything to the process that runs it. A
 * refusal is nil and a message, as of a file that cannot be opened, or an error where Lua's own
 * function raises. The engine asks bw_may_use by itself. */
#include "program.h"

#include <errno.h>
#include <lualib.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

/* Of its own: these functions may run while the engine calls a function of the script. */
static bw_context *judging;

/* nil, message, errno: as io and os functions fail */
static int refuse(lua_State *L, const char *message) {
  lua_pushnil(L);
  lua_pushstring(L, message);
  lua_pushinteger(L, EACCES);
  return 3;
}

/* The engine's sentence on the path; NULL where it may be used. Names with a zero byte would be cut
 * short by the C library. */
static const char *judge(lua_State *L, int argument, bw_use use) {
  size_t length;
  const char *path = luaL_checklstring(L, argument, &length);
  if (strlen(path) != length)
    return lua_pushfstring(L, "a name with a zero byte: refused in the sandbox");
  if (bw_may_use(judging, path, use) == BW_OK)
    return NULL;
  const char *message = lua_pushstring(L, bw_message(judging));
  bw_clear_failure(judging);
  return message;
}

/* Calls the original in the first upvalue with all arguments. */
static int pass(lua_State *L) {
  int count = lua_gettop(L);
  lua_pushvalue(L, lua_upvalueindex(1));
  lua_insert(L, 1);
  lua_call(L, count, LUA_MULTRET);
  return lua_gettop(L);
}

/* ---- io and os ------------------------------------------------------------------------------- */

static int io_open(lua_State *L) {
  const char *mode = luaL_optstring(L, 2, "r");
  const char *message =
      judge(L, 1, mode[0] == 'r' && !strchr(mode, '+') ? BW_TO_READ : BW_TO_WRITE);
  return message ? refuse(L, message) : pass(L);
}

static int io_lines(lua_State *L) {
  const char *message = lua_isnoneornil(L, 1) ? NULL : judge(L, 1, BW_TO_READ);
  return message ? luaL_error(L, "%s", message) : pass(L);
}

static int io_redirect(lua_State *L, bw_use use) {
  const char *message = lua_type(L, 1) == LUA_TSTRING ? judge(L, 1, use) : NULL;
  return message ? luaL_error(L, "%s", message) : pass(L);
}

static int io_input(lua_State *L) {
  return io_redirect(L, BW_TO_READ);
}

static int io_output(lua_State *L) {
  return io_redirect(L, BW_TO_WRITE);
}

static int os_remove(lua_State *L) {
  const char *message = judge(L, 1, BW_TO_REPLACE);
  return message ? refuse(L, message) : pass(L);
}

static int os_rename(lua_State *L) {
  const char *message = judge(L, 1, BW_TO_REPLACE);
  message = message ? message : judge(L, 2, BW_TO_REPLACE);
  return message ? refuse(L, message) : pass(L);
}

/* A file in the folder. */
static int os_tmpname(lua_State *L) {
  char path[4200];
  snprintf(path, sizeof path, "%s/lua_XXXXXX", bw_confined_to());
  int file = mkstemp(path);
  if (file < 0)
    return luaL_error(L, "unable to generate a unique filename");
  close(file);
  lua_pushstring(L, path);
  return 1;
}

/* The environment may hold what is nobody's business; barwright's own variables are not. */
static int os_getenv(lua_State *L) {
  const char *name = luaL_checkstring(L, 1);
  lua_settop(L, 1);
  if (strncmp(name, "BARWRIGHT_", 10) != 0) {
    lua_pushnil(L);
    return 1;
  }
  return pass(L);
}

/* Only asking: how numbers are written concerns the whole process. */
static int os_setlocale(lua_State *L) {
  if (!lua_isnoneornil(L, 1)) {
    lua_pushnil(L);
    return 1;
  }
  return pass(L);
}

/* Without a command: is there a shell? */
static int os_execute(lua_State *L) {
  if (lua_isnoneornil(L, 1)) {
    lua_pushboolean(L, 0);
    return 1;
  }
  return refuse(L, "os.execute: no program is started in the sandbox");
}

static int io_popen(lua_State *L) {
  return refuse(L, "io.popen: no program is started in the sandbox");
}

static int io_tmpfile(lua_State *L) {
  return refuse(L, "io.tmpfile: refused in the sandbox; os.tmpname names a file in its folder");
}

/* Upvalue: the name. */
static int never(lua_State *L) {
  return luaL_error(L, "%s: refused in the sandbox", lua_tostring(L, lua_upvalueindex(1)));
}

/* ---- chunks ---------------------------------------------------------------------------------- */

/* load(chunk, name, mode, environment): the mode is "t" */
static int load_text(lua_State *L) {
  bool environment = !lua_isnone(L, 4);
  lua_settop(L, environment ? 4 : 3);
  lua_pushliteral(L, "t");
  lua_replace(L, 3);
  return pass(L);
}

/* loadfile(path, mode, environment) */
static int load_file(lua_State *L) {
  bool environment = !lua_isnone(L, 3);
  const char *message = lua_isnoneornil(L, 1) ? NULL : judge(L, 1, BW_TO_READ);
  if (message) {
    lua_pushnil(L);
    lua_pushstring(L, message);
    return 2;
  }
  lua_settop(L, environment ? 3 : 2);
  lua_pushliteral(L, "t");
  lua_replace(L, 2);
  return pass(L);
}

static int continued(lua_State *L, int status, lua_KContext context) {
  (void)status, (void)context;
  return lua_gettop(L) - 1;
}

/* dofile(path) */
static int do_file(lua_State *L) {
  const char *message = lua_isnoneornil(L, 1) ? NULL : judge(L, 1, BW_TO_READ);
  if (message)
    return luaL_error(L, "%s", message);
  const char *path = luaL_optstring(L, 1, NULL);
  lua_settop(L, 1);
  if (luaL_loadfilex(L, path, "t") != LUA_OK)
    return lua_error(L);
  lua_callk(L, 0, LUA_MULTRET, 0, continued);
  return continued(L, 0, 0);
}

/* ---- require --------------------------------------------------------------------------------- */

static bool readable(const char *path) {
  bool fine = bw_may_use(judging, path, BW_TO_READ) == BW_OK && access(path, R_OK) == 0;
  bw_clear_failure(judging);
  return fine;
}

/* searchpath(name, path, separator, replacement), where nothing outside is so much as looked for */
static int search_path(lua_State *L) {
  const char *name = luaL_checkstring(L, 1), *path = luaL_checkstring(L, 2);
  const char *separator = luaL_optstring(L, 3, "."), *replacement = luaL_optstring(L, 4, "/");
  if (separator[0])
    name = luaL_gsub(L, name, separator, replacement);
  luaL_Buffer missing;
  luaL_buffinit(L, &missing);
  const char *before = "";
  while (*path) {
    const char *end = strchr(path, ';');
    size_t length = end ? (size_t)(end - path) : strlen(path);
    lua_pushlstring(L, path, length);
    const char *file = luaL_gsub(L, lua_tostring(L, -1), "?", name);
    lua_remove(L, -2);
    if (length > 0 && readable(file))
      return 1;
    if (length > 0) {
      lua_pushfstring(L, "%sno file '%s'", before, file);
      before = "\n\t";
      lua_remove(L, -2);
      luaL_addvalue(&missing);
    } else
      lua_pop(L, 1);
    path += length + (end ? 1 : 0);
  }
  luaL_pushresult(&missing);
  lua_pushnil(L);
  lua_insert(L, -2);
  return 2;
}

/* Upvalue: the table package. */
static int search_lua(lua_State *L) {
  const char *name = luaL_checkstring(L, 1);
  lua_pushcfunction(L, search_path);
  lua_pushstring(L, name);
  if (lua_getfield(L, lua_upvalueindex(1), "path") != LUA_TSTRING)
    return luaL_error(L, "'package.path' must be a string");
  lua_call(L, 2, 2);
  if (lua_isnil(L, -2))
    return 1; /* what was looked for */
  lua_pop(L, 1);
  if (luaL_loadfilex(L, lua_tostring(L, -1), "t") != LUA_OK)
    return luaL_error(L, "error loading module '%s' from file '%s':\n\t%s", name,
                      lua_tostring(L, -2), lua_tostring(L, -1));
  lua_insert(L, -2); /* the loader, the file */
  return 2;
}

/* ---- debug ----------------------------------------------------------------------------------- */

/* getinfo([thread,] level or function, what): places and names, no functions and no variables */
static int debug_getinfo(lua_State *L) {
  int at = lua_isthread(L, 1) ? 3 : 2;
  const char *what = luaL_optstring(L, at, "Slnt");
  char kept[16];
  size_t count = 0;
  for (; *what && count < sizeof kept - 1; what++)
    if (strchr("Slntu", *what) && !memchr(kept, *what, count))
      kept[count++] = *what;
  kept[count] = 0;
  lua_settop(L, at - 1);
  if (at == 2 && lua_type(L, 1) == LUA_TNUMBER) { /* this function is a level of its own */
    lua_Integer level = luaL_checkinteger(L, 1);
    lua_pushinteger(L, level > 0 ? level + 1 : level);
    lua_replace(L, 1);
  }
  lua_pushstring(L, kept);
  return pass(L);
}

/* ---- putting it up --------------------------------------------------------------------------- */

/* table.name = function with the original as its upvalue; the table is on the top. */
static void wrap(lua_State *L, const char *name, lua_CFunction function) {
  lua_getfield(L, -1, name);
  lua_pushcclosure(L, function, 1);
  lua_setfield(L, -2, name);
}

/* Every function of the table on the top that is not in the list refuses. */
static void refuse_others(lua_State *L, const char *table, const char *const kept[]) {
  lua_newtable(L); /* names first: a table must not change while it is walked */
  for (lua_pushnil(L); lua_next(L, -3); lua_pop(L, 1)) {
    bool keep = lua_type(L, -2) != LUA_TSTRING || !lua_isfunction(L, -1);
    for (int i = 0; kept[i] && !keep; i++)
      keep = strcmp(lua_tostring(L, -2), kept[i]) == 0;
    if (!keep) {
      lua_pushvalue(L, -2);
      lua_rawseti(L, -4, (lua_Integer)lua_rawlen(L, -4) + 1);
    }
  }
  for (lua_Integer i = 1; lua_rawgeti(L, -1, i) == LUA_TSTRING; i++) {
    lua_pushfstring(L, "%s.%s", table, lua_tostring(L, -1));
    lua_pushcclosure(L, never, 1);
    lua_settable(L, -4);
  }
  lua_pop(L, 2); /* nil, the names */
}

static void close_package(lua_State *L) {
  static const char *const kept[] = {"searchpath", NULL};
  lua_getglobal(L, "package");
  lua_pushcfunction(L, search_path);
  lua_setfield(L, -2, "searchpath");
  refuse_others(L, "package", kept);
  lua_pushliteral(L, "");
  lua_setfield(L, -2, "cpath");
  /* The table that require reads, not another one: preload first, then Lua files, and no more. */
  lua_getfield(L, -1, "searchers");
  lua_pushvalue(L, -2);
  lua_pushcclosure(L, search_lua, 1);
  lua_rawseti(L, -2, 2);
  for (lua_Integer i = (lua_Integer)lua_rawlen(L, -1); i > 2; i--) {
    lua_pushnil(L);
    lua_rawseti(L, -2, i);
  }
  lua_pop(L, 2);
}

/* The global functions and the tables of the standard library. Raises when memory is out. */
static int put_up(lua_State *L) {
  static const char *const io_kept[] = {"open",  "lines", "input", "output",  "read", "write",
                                        "close", "type",  "popen", "tmpfile", NULL};
  static const char *const os_kept[] = {"remove",    "rename",   "tmpname", "getenv",
                                        "setlocale", "execute",  "clock",   "date",
                                        "time",      "difftime", "exit",    NULL};
  static const char *const debug_kept[] = {"traceback", "getinfo", NULL};
  lua_getglobal(L, "io");
  wrap(L, "open", io_open);
  wrap(L, "lines", io_lines);
  wrap(L, "input", io_input);
  wrap(L, "output", io_output);
  lua_pushcfunction(L, io_popen);
  lua_setfield(L, -2, "popen");
  lua_pushcfunction(L, io_tmpfile);
  lua_setfield(L, -2, "tmpfile");
  refuse_others(L, "io", io_kept);
  lua_getglobal(L, "os");
  wrap(L, "remove", os_remove);
  wrap(L, "rename", os_rename);
  wrap(L, "getenv", os_getenv);
  wrap(L, "setlocale", os_setlocale);
  lua_pushcfunction(L, os_tmpname);
  lua_setfield(L, -2, "tmpname");
  lua_pushcfunction(L, os_execute);
  lua_setfield(L, -2, "execute");
  refuse_others(L, "os", os_kept);
  lua_getglobal(L, "debug");
  wrap(L, "getinfo", debug_getinfo);
  refuse_others(L, "debug", debug_kept);
  close_package(L);
  lua_pushglobaltable(L);
  wrap(L, "load", load_text);
  wrap(L, "loadfile", load_file);
  lua_pushcfunction(L, do_file);
  lua_setfield(L, -2, "dofile");
  return 0;
}

bool program_close_lua(lua_State *L) {
  judging = bw_context_create();
  if (!judging) {
    program_out_of_memory();
    return false;
  }
  lua_pushcfunction(L, put_up);
  if (lua_pcall(L, 0, 0, 0) == LUA_OK)
    return true;
  fprintf(stderr, "barwright: the sandbox cannot be put up: %s\n", lua_tostring(L, -1));
  return false;
}
