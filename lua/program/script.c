/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* What runs: scripts, statements, commands (which are Lua: lua/barwright/command). */
#include "program.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>
#include <unistd.h>

void program_set_arguments(lua_State *L, const program_command *c) {
  lua_createtable(L, c->count, 1);
  int zero = c->script ? c->script_at : 0;
  for (int i = 0; i < c->count; i++) {
    lua_pushstring(L, c->value[i]);
    lua_rawseti(L, -2, i - zero);
  }
  lua_setglobal(L, "arg");
}

/* What the commands are is known in Lua. */
static int print_help(lua_State *L) {
  lua_getglobal(L, "require");
  lua_pushliteral(L, "barwright.command");
  lua_call(L, 1, 1);
  lua_getfield(L, -1, "help");
  lua_call(L, 0, 1);
  puts(lua_tostring(L, -1));
  return 0;
}

static int print_version(lua_State *L) {
  lua_getglobal(L, "require");
  lua_pushliteral(L, "barwright.core");
  lua_call(L, 1, 1);
  lua_getfield(L, -1, "version");
  lua_getfield(L, -2, "commit");
  const char *commit = lua_tostring(L, -1);
  printf("barwright %s%s%s%s\n", lua_tostring(L, -2), commit[0] ? " (" : "", commit,
         commit[0] ? ")" : "");
  lua_getfield(L, -3, "library_versions");
  lua_call(L, 0, 1);
  if (lua_isstring(L, -1))
    fputs(lua_tostring(L, -1), stdout);
  printf("%s\n", LUA_RELEASE);
  return 0;
}

bool program_report(lua_State *L, bool help) {
  lua_pushcfunction(L, help ? print_help : print_version);
  return program_call(L, 0, 0);
}

static int load_module(lua_State *L) {
  lua_getglobal(L, "require");
  lua_pushliteral(L, "barwright");
  lua_call(L, 1, 1);
  lua_setglobal(L, "bw");
  return 0;
}

bool program_load_module(lua_State *L) {
  lua_pushcfunction(L, load_module);
  return program_call(L, 0, 0);
}

/* Scripts are text: bytecode can do anything to the process that runs it. */
static bool loaded(lua_State *L, int failure) {
  if (failure == LUA_OK)
    return true;
  const char *message = lua_tostring(L, -1);
  fprintf(stderr, "barwright: %s%s\n", message,
          strstr(message, "attempt to load a binary chunk")
              ? ": a script is loaded as text only, a precompiled one (luac) is refused"
              : "");
  return false;
}

/* The exit status. */
static int run_script(lua_State *L, const program_command *c) {
  const char *path = strcmp(c->script, "-") == 0 ? NULL : c->script;
  int failure = luaL_loadfilex(L, path, "t");
  if (!loaded(L, failure))
    return failure == LUA_ERRFILE ? PROGRAM_NO_FILE : EXIT_FAILURE;
  int arguments = c->count - c->script_at - 1;
  luaL_checkstack(L, arguments + 4, "too many arguments");
  for (int i = 0; i < arguments; i++)
    lua_pushstring(L, c->value[c->script_at + 1 + i]);
  return program_call(L, arguments, 0) ? EXIT_SUCCESS : EXIT_FAILURE;
}

bool program_run_statements(lua_State *L, const char *text) {
  return loaded(L, luaL_loadbufferx(L, text, strlen(text), "=(command line)", "t")) &&
         program_call(L, 0, 0);
}

/* name: what barwright.command says of it: true when it is a command; else what it may be meant for
 */
static int is_command(lua_State *L) {
  lua_getglobal(L, "require");
  lua_pushliteral(L, "barwright.command");
  lua_call(L, 1, 1);
  lua_getfield(L, -1, "known");
  lua_pushvalue(L, 1);
  lua_call(L, 1, 1);
  if (lua_toboolean(L, -1))
    return 1;
  lua_getfield(L, -2, "suggestion");
  lua_pushvalue(L, 1);
  lua_call(L, 1, 1);
  return 1;
}

/* barwright NAME ...: the exit code of barwright.command.run(NAME, ...). */
static int call_command(lua_State *L) {
  int words = lua_gettop(L);
  lua_getglobal(L, "require");
  lua_pushliteral(L, "barwright.command");
  lua_call(L, 1, 1);
  lua_getfield(L, -1, "run");
  lua_insert(L, 1);
  lua_pop(L, 1);
  lua_call(L, words, 1);
  return 1;
}

/* A model where a script is expected: by its ending. */
static bool is_model(const char *path) {
  static const char *const endings[] = {".stl",  ".obj",  ".off",  ".ply", ".msh",  ".vtu",
                                        ".pvtu", ".mesh", ".inp",  ".svg", ".dxf",  ".3mf",
                                        ".glb",  ".gltf", ".step", ".stp", ".iges", ".igs"};
  const char *ending = strrchr(path, '.');
  for (size_t i = 0; ending && i < sizeof endings / sizeof *endings; i++)
    if (strcasecmp(ending, endings[i]) == 0)
      return true;
  return false;
}

int program_run_word(lua_State *L, const program_command *c) {
  if (is_model(c->script)) {
    fprintf(stderr, "barwright: %s is no script: `barwright check %s` describes it\n", c->script,
            c->script);
    return PROGRAM_MISUSED;
  }
  if (strpbrk(c->script, "./") || strcmp(c->script, "-") == 0)
    return run_script(L, c);
  lua_pushcfunction(L, is_command);
  lua_pushstring(L, c->script);
  if (!program_call(L, 1, 1))
    return EXIT_FAILURE;
  if (!lua_isboolean(L, -1)) {
    if (access(c->script, F_OK) == 0)
      return run_script(L, c);
    fprintf(stderr, "barwright: there is no command '%s' and no file: %s\n", c->script,
            lua_tostring(L, -1));
    return PROGRAM_MISUSED;
  }
  lua_pop(L, 1);
  int words = c->count - c->script_at;
  luaL_checkstack(L, words + 8, "too many arguments");
  lua_pushcfunction(L, call_command);
  for (int i = 0; i < words; i++)
    lua_pushstring(L, c->value[c->script_at + i]);
  if (!program_call(L, words, 1))
    return EXIT_FAILURE;
  int code = (int)lua_tointeger(L, -1);
  lua_pop(L, 1);
  return code;
}

static int join_ranks(lua_State *L) {
  lua_getglobal(L, "require");
  lua_pushliteral(L, "barwright.distributed");
  lua_call(L, 1, 1);
  lua_getfield(L, -1, "start");
  lua_call(L, 0, 2);
  if (lua_isnil(L, -2))
    return lua_error(L);
  return 0;
}

bool program_join_ranks(lua_State *L) {
  lua_pushcfunction(L, join_ranks);
  return program_call(L, 0, 0);
}
