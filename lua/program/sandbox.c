/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* The sandbox's first wall: what Lua itself could open, start or reach.
 *
 * The tables io, os, package and debug stay, with functions of these names that use the engine's
 * bw_open and its relatives, or refuse. Where an original is still called, it is left in the
 * upvalue of a C function, which nothing that a script has can read: debug keeps traceback and what
 * getinfo tells of places. Chunks are loaded as text alone, since bytecode can do anything to the
 * process that runs it. A refusal is nil and a message, as of a file that cannot be opened, or an
 * error where Lua's own function raises. The engine judges paths by itself. */
#include "program.h"

#include <errno.h>
#include <fcntl.h>
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
static const char *check(lua_State *L, int argument, bw_use use) {
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

static int close_stream(lua_State *L) {
  luaL_Stream *stream = (luaL_Stream *)luaL_checkudata(L, 1, LUA_FILEHANDLE);
  return luaL_fileresult(L, fclose(stream->f) == 0, NULL);
}

/* The flags of open for a mode as Lua knows them: [rwa]%+?b*. -1: it is none. */
static int flags_of(const char *mode) {
  static const struct {
    char letter;
    int flags;
  } known[] = {{'r', 0}, {'w', O_CREAT | O_TRUNC}, {'a', O_CREAT | O_APPEND}};
  bool both = mode[0] && mode[1] == '+';
  const char *rest = mode + (mode[0] != 0) + both;
  for (int i = 0; i < 3; i++)
    if (mode[0] == known[i].letter && strspn(rest, "b") == strlen(rest))
      return known[i].flags | (both ? O_RDWR : mode[0] == 'r' ? O_RDONLY : O_WRONLY);
  return -1;
}

/* Pushes the file under the name that is the argument; else nil, a message and a number. */
static int open_stream(lua_State *L, int argument, const char *mode) {
  int flags = flags_of(mode);
  bool reads = (flags & O_ACCMODE) == O_RDONLY;
  const char *message = check(L, argument, reads ? BW_TO_READ : BW_TO_WRITE);
  if (message)
    return refuse(L, message);
  const char *path = lua_tostring(L, argument);
  luaL_Stream *stream = (luaL_Stream *)lua_newuserdatauv(L, sizeof *stream, 0);
  stream->closef = NULL; /* until there is one, it counts as closed */
  luaL_setmetatable(L, LUA_FILEHANDLE);
  int file = bw_open(path, flags, 0666);
  if (file < 0)
    return luaL_fileresult(L, 0, path);
  stream->f = fdopen(file, mode);
  if (!stream->f) {
    int failed = luaL_fileresult(L, 0, path);
    close(file);
    return failed;
  }
  stream->closef = close_stream;
  return 1;
}

/* The same, raising what is wrong. */
static void open_or_raise(lua_State *L, int argument, const char *mode) {
  if (open_stream(L, argument, mode) != 1)
    luaL_error(L, "%s", lua_tostring(L, -2));
}

static int io_open(lua_State *L) {
  const char *mode = luaL_optstring(L, 2, "r");
  luaL_argcheck(L, flags_of(mode) >= 0, 2, "invalid mode");
  return open_stream(L, 1, mode);
}

/* Of a file by its name: an iterator, nil, nil, and the file, which the loop closes. */
static int io_lines(lua_State *L) {
  if (lua_isnoneornil(L, 1))
    return pass(L);
  int formats = lua_gettop(L) - 1;
  luaL_checkstack(L, formats + 8, "too many arguments");
  open_or_raise(L, 1, "r");
  int file = lua_gettop(L);
  lua_getfield(L, file, "lines");
  lua_pushvalue(L, file);
  for (int i = 0; i < formats; i++)
    lua_pushvalue(L, 2 + i);
  lua_call(L, formats + 1, 1);
  lua_pushnil(L);
  lua_pushnil(L);
  lua_pushvalue(L, file);
  return 4;
}

/* What Lua would take for a name is opened here; the original gets a file. */
static int io_redirect(lua_State *L, const char *mode) {
  if (lua_isstring(L, 1)) {
    lua_settop(L, 1);
    open_or_raise(L, 1, mode);
    lua_replace(L, 1);
  }
  return pass(L);
}

static int io_input(lua_State *L) {
  return io_redirect(L, "r");
}

static int io_output(lua_State *L) {
  return io_redirect(L, "w");
}

static int os_remove(lua_State *L) {
  const char *message = check(L, 1, BW_TO_REPLACE);
  if (message)
    return refuse(L, message);
  const char *path = lua_tostring(L, 1);
  return luaL_fileresult(L, bw_remove(path) == 0, path);
}

static int os_rename(lua_State *L) {
  const char *message = check(L, 1, BW_TO_REPLACE);
  message = message ? message : check(L, 2, BW_TO_REPLACE);
  if (message)
    return refuse(L, message);
  return luaL_fileresult(L, bw_rename(lua_tostring(L, 1), lua_tostring(L, 2)) == 0, NULL);
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

/* Pushes the chunk of a file as luaL_loadfilex does, or a message: true where there is one. A first
 * line that begins with # is none of Lua's, nor is the mark of UTF-8. */
static bool load_path(lua_State *L, int argument) {
  size_t count, skipped = 0;
  unsigned char *bytes;
  if (check(L, argument, BW_TO_READ))
    return false;
  const char *path = lua_tostring(L, argument), *name = lua_pushfstring(L, "@%s", path);
  if (bw_read_file(judging, path, &bytes, &count) != BW_OK) {
    lua_pushstring(L, bw_message(judging));
    bw_clear_failure(judging);
    return false;
  }
  if (count >= 3 && memcmp(bytes, "\xEF\xBB\xBF", 3) == 0)
    skipped = 3;
  if (skipped < count && bytes[skipped] == '#')
    while (skipped < count && bytes[skipped] != '\n')
      skipped++;
  int failure = luaL_loadbufferx(L, (const char *)bytes + skipped, count - skipped, name, "t");
  bw_free(bytes);
  return failure == LUA_OK;
}

/* The same; without a name, that of standard input. */
static bool load_chunk(lua_State *L) {
  return lua_isnoneornil(L, 1) ? luaL_loadfilex(L, NULL, "t") == LUA_OK : load_path(L, 1);
}

/* loadfile(path, mode, environment) */
static int load_file(lua_State *L) {
  bool environment = !lua_isnone(L, 3);
  lua_settop(L, 3);
  if (!load_chunk(L)) {
    lua_pushnil(L);
    lua_insert(L, -2);
    return 2;
  }
  if (environment) {
    lua_pushvalue(L, 3);
    if (!lua_setupvalue(L, -2, 1))
      lua_pop(L, 1);
  }
  return 1;
}

static int continued(lua_State *L, int status, lua_KContext context) {
  (void)status, (void)context;
  return lua_gettop(L) - 1;
}

/* dofile(path) */
static int do_file(lua_State *L) {
  lua_settop(L, 1);
  if (!load_chunk(L))
    return lua_error(L);
  lua_replace(L, 1); /* so that its results are all that is above */
  lua_settop(L, 1);
  lua_pushvalue(L, 1);
  lua_callk(L, 0, LUA_MULTRET, 0, continued);
  return continued(L, 0, 0);
}

/* ---- require --------------------------------------------------------------------------------- */

static bool readable(const char *path) {
  bool ok = bw_may_use(judging, path, BW_TO_READ) == BW_OK && access(path, R_OK) == 0;
  bw_clear_failure(judging);
  return ok;
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
  int file = lua_gettop(L);
  if (!load_path(L, file))
    return luaL_error(L, "error loading module '%s' from file '%s':\n\t%s", name,
                      lua_tostring(L, file), lua_tostring(L, -1));
  lua_pushvalue(L, file);
  return 2; /* the loader, the file */
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

static void set(lua_State *L, const char *name, lua_CFunction function) {
  lua_pushcfunction(L, function);
  lua_setfield(L, -2, name);
}

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
  set(L, "open", io_open);
  wrap(L, "lines", io_lines);
  wrap(L, "input", io_input);
  wrap(L, "output", io_output);
  set(L, "popen", io_popen);
  set(L, "tmpfile", io_tmpfile);
  refuse_others(L, "io", io_kept);
  lua_getglobal(L, "os");
  set(L, "remove", os_remove);
  set(L, "rename", os_rename);
  wrap(L, "getenv", os_getenv);
  wrap(L, "setlocale", os_setlocale);
  set(L, "tmpname", os_tmpname);
  set(L, "execute", os_execute);
  refuse_others(L, "os", os_kept);
  lua_getglobal(L, "debug");
  wrap(L, "getinfo", debug_getinfo);
  refuse_others(L, "debug", debug_kept);
  close_package(L);
  lua_pushglobaltable(L);
  wrap(L, "load", load_text);
  set(L, "loadfile", load_file);
  set(L, "dofile", do_file);
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
  fprintf(stderr, "barwright: the sandbox cannot be set up: %s\n", lua_tostring(L, -1));
  return false;
}
