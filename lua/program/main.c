/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* The program barwright: runs a command, a script or statements, or opens a prompt, with the module
 * built in. Commands are Lua: lua/barwright/command.
 *
 * Ctrl-C: while the engine works, the first one asks it to stop; the call returns nil, "cancelled"
 * and the script can keep what is done. Otherwise, and the second time, an error is raised at the
 * next step of the script. The program then ends with status 130. A third one ends it at once. */
#include "program.h"

#include <limits.h>
#include <locale.h>
#include <lualib.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

enum { MISUSED = 2, INTERRUPTED = 130 };

static lua_State *interrupted_state; /* whose script the handler stops */
static lbw_state *engine;
static volatile sig_atomic_t interrupts;

static void stop(lua_State *L, lua_Debug *ar) {
  (void)ar;
  lua_sethook(L, NULL, 0, 0);
  luaL_error(L, "interrupted");
}

/* Calls only what is safe in a handler: bw_cancel sets a flag, and so does lua_sethook. */
static void on_interrupt(int number) {
  (void)number;
  interrupts++;
  engine->stopping = 1;
  if (interrupts > 2) {
    bw_writers_abandon();
    _exit(INTERRUPTED);
  }
  bool waiting = engine->running != 0;
  if (waiting)
    bw_cancel(engine->context);
  if (!waiting || interrupts > 1) {
    int mask = LUA_MASKCALL | LUA_MASKRET | LUA_MASKLINE | LUA_MASKCOUNT;
    lua_sethook(interrupted_state, stop, mask, 1);
  }
}

/* Told to end: no half-written file stays behind. */
static void on_termination(int number) {
  bw_writers_abandon();
  signal(number, SIG_DFL);
  raise(number);
}

void program_catch_interrupt(lua_State *L) {
  struct sigaction action;
  memset(&action, 0, sizeof action);
  action.sa_handler = on_interrupt;
  sigemptyset(&action.sa_mask);
  interrupted_state = L;
  interrupts = 0;
  sigaction(SIGINT, &action, NULL);
}

void program_ignore_interrupt(void) {
  signal(SIGINT, SIG_DFL);
  if (engine)
    bw_clear_cancel(engine->context);
  if (interrupted_state)
    lua_sethook(interrupted_state, NULL, 0, 0);
}

static int with_traceback(lua_State *L) {
  const char *message = lua_tostring(L, 1);
  if (!message) {
    if (luaL_callmeta(L, 1, "__tostring"))
      message = lua_tostring(L, -1);
    else
      message = lua_pushfstring(L, "(error object is a %s value)", luaL_typename(L, 1));
  }
  luaL_traceback(L, L, message, 1);
  return 1;
}

bool program_call(lua_State *L, int arguments, int results) {
  int base = lua_gettop(L) - arguments;
  lua_pushcfunction(L, with_traceback);
  lua_insert(L, base);
  int failure = lua_pcall(L, arguments, results, base);
  lua_remove(L, base);
  program_progress_clear();
  if (failure) {
    if (engine->stopping)
      fprintf(stderr, "barwright: interrupted\n");
    else
      fprintf(stderr, "barwright: %s\n", lua_tostring(L, -1));
    lua_pop(L, 1);
  }
  return !failure;
}

/* ---- where the Lua files are ----------------------------------------------------------------- */

static bool readable(const char *folder, const char *file) {
  char path[PATH_MAX + 64];
  int length = snprintf(path, sizeof path, "%s/%s", folder, file);
  return length > 0 && (size_t)length < sizeof path && access(path, R_OK) == 0;
}

/* Beside the program (a build tree), else under the prefix it lies in, else where it was meant to
 * be installed. Goes before what LUA_PATH says: the program and its Lua files belong together. */
static void set_path(lua_State *L) {
  char self[PATH_MAX];
  ssize_t length = readlink("/proc/self/exe", self, sizeof self - 1);
  const char *folder = BARWRIGHT_LUA_FOLDER, *modules = BARWRIGHT_MODULE_FOLDER "/..";
  if (length > 0) {
    self[length] = 0;
    char *slash = strrchr(self, '/');
    if (slash)
      *slash = 0;
    const char *build = lua_pushfstring(L, "%s/lua", self);
    const char *installed = lua_pushfstring(L, "%s/../share/lua/5.4", self);
    if (readable(build, "barwright/init.lua"))
      folder = modules = build;
    else if (readable(installed, "barwright/init.lua")) {
      folder = installed;
      modules = lua_pushfstring(L, "%s/" BARWRIGHT_MODULES_FROM_BIN, self);
    }
  }
  lua_getglobal(L, "package");
  lua_getfield(L, -1, "path");
  lua_pushfstring(L, "%s/?.lua;%s/?/init.lua;%s", folder, folder, lua_tostring(L, -1));
  lua_setfield(L, -3, "path");
  lua_pop(L, 1);
  lua_getfield(L, -1, "cpath"); /* barwright.core is in the program; barwright.mpi is a file */
  lua_pushfstring(L, "%s/?.so;%s", modules, lua_tostring(L, -1));
  lua_setfield(L, -3, "cpath");
  lua_settop(L, 0);
}

/* ---- the command line ------------------------------------------------------------------------ */

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

/* Loads the module and sets the global bw, as `local bw = require "barwright"` would. */
static int load_module(lua_State *L) {
  lua_getglobal(L, "require");
  lua_pushliteral(L, "barwright");
  lua_call(L, 1, 1);
  lua_setglobal(L, "bw");
  return 0;
}

typedef struct command {
  const char *statements, *script;
  int script_at, count;
  char **value;
  bool prompt, stress, mpi, version, help;
} command;

static bool read_command(int argc, char **argv, command *c) {
  c->count = argc;
  c->value = argv;
  int i = 1;
  for (; i < argc && argv[i][0] == '-' && argv[i][1]; i++) {
    if (strcmp(argv[i], "-e") == 0 && i + 1 < argc)
      c->statements = argv[++i];
    else if (strcmp(argv[i], "-i") == 0)
      c->prompt = true;
    else if (strcmp(argv[i], "--gc-stress") == 0)
      c->stress = true;
    else if (strcmp(argv[i], "--mpi") == 0)
      c->mpi = true;
    else if (strcmp(argv[i], "--version") == 0 || strcmp(argv[i], "-v") == 0)
      c->version = true;
    else if (strcmp(argv[i], "--help") == 0 || strcmp(argv[i], "-h") == 0)
      c->help = true;
    else if (strcmp(argv[i], "--") == 0) {
      i++;
      break;
    } else {
      static const char *const known[] = {"-e",    "-i",        "--gc-stress",
                                          "--mpi", "--version", "--help"};
      fprintf(stderr, "barwright: unknown option '%s': did you mean '%s'?\n", argv[i],
              lbw_nearest(argv[i], known, 6));
      return false;
    }
  }
  c->script_at = i;
  c->script = i < argc ? argv[i] : NULL;
  return true;
}

/* arg[0] the script, arg[1].. its arguments, negative what stands before, as in lua. */
static void set_arguments(lua_State *L, const command *c) {
  lua_createtable(L, c->count, 1);
  int zero = c->script ? c->script_at : 0;
  for (int i = 0; i < c->count; i++) {
    lua_pushstring(L, c->value[i]);
    lua_rawseti(L, -2, i - zero);
  }
  lua_setglobal(L, "arg");
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

static bool run_script(lua_State *L, const command *c) {
  const char *path = strcmp(c->script, "-") == 0 ? NULL : c->script;
  if (!loaded(L, luaL_loadfilex(L, path, "t")))
    return false;
  int arguments = c->count - c->script_at - 1;
  luaL_checkstack(L, arguments + 4, "too many arguments");
  for (int i = 0; i < arguments; i++)
    lua_pushstring(L, c->value[c->script_at + 1 + i]);
  return program_call(L, arguments, 0);
}

static bool run_statements(lua_State *L, const char *text) {
  return loaded(L, luaL_loadbufferx(L, text, strlen(text), "=(command line)", "t")) &&
         program_call(L, 0, 0);
}

/* name: what barwright.command says of it: true when it is a command; else a name that is near */
static int is_command(lua_State *L) {
  lua_getglobal(L, "require");
  lua_pushliteral(L, "barwright.command");
  lua_call(L, 1, 1);
  lua_getfield(L, -1, "known");
  lua_pushvalue(L, 1);
  lua_call(L, 1, 1);
  if (lua_toboolean(L, -1))
    return 1;
  lua_getfield(L, -2, "nearest");
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

/* A word without a dot or a slash is the name of a command, if there is one; else a script. */
static int run_word(lua_State *L, const command *c) {
  if (strpbrk(c->script, "./") || strcmp(c->script, "-") == 0)
    return run_script(L, c) ? EXIT_SUCCESS : EXIT_FAILURE;
  lua_pushcfunction(L, is_command);
  lua_pushstring(L, c->script);
  if (!program_call(L, 1, 1))
    return EXIT_FAILURE;
  if (!lua_isboolean(L, -1)) {
    if (access(c->script, F_OK) == 0)
      return run_script(L, c) ? EXIT_SUCCESS : EXIT_FAILURE;
    fprintf(stderr,
            "barwright: there is no command '%s' and no file: did you mean 'barwright %s'?\n",
            c->script, lua_tostring(L, -1));
    return MISUSED;
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

/* --mpi: on rank 0 goes on; on the other ranks works for that one, and ends with it. */
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

/* The exit code. */
static int run(lua_State *L, const command *c) {
  set_path(L);
  set_arguments(L, c);
  if (c->version || c->help) {
    lua_pushcfunction(L, c->help ? print_help : print_version);
    return program_call(L, 0, 0) ? EXIT_SUCCESS : EXIT_FAILURE;
  }
  bool prompt = c->prompt || (!c->script && !c->statements);
  if (c->stress) {
    /* No pause, and a step as large as the heap: every allocation runs a whole cycle. */
    lua_gc(L, LUA_GCINC, 0, 1000, 100);
    lua_gc(L, LUA_GCSETPAUSE, 0);
  }
  program_catch_interrupt(L);
  bool fine = true;
  if (c->mpi) {
    lua_pushcfunction(L, join_ranks);
    fine = program_call(L, 0, 0);
    if (!fine)
      return EXIT_FAILURE;
  }
  if (c->statements || prompt) {
    lua_pushcfunction(L, load_module);
    fine = program_call(L, 0, 0);
  }
  if (fine && c->statements)
    fine = run_statements(L, c->statements);
  int code = fine ? EXIT_SUCCESS : EXIT_FAILURE;
  if (fine && c->script)
    code = run_word(L, c);
  if (prompt && !engine->stopping) {
    program_prompt(L);
    return EXIT_SUCCESS;
  }
  return code;
}

int main(int argc, char **argv) {
  command c;
  memset(&c, 0, sizeof c);
  if (!read_command(argc, argv, &c))
    return MISUSED;
  setlocale(LC_CTYPE, ""); /* for editing lines of UTF-8; numbers stay with the C locale */
  lua_State *L = luaL_newstate();
  if (!L) {
    fprintf(stderr, "barwright: not enough memory\n");
    return 1;
  }
  luaL_openlibs(L);
  engine = lbw_state_of(L);
  luaL_getsubtable(L, LUA_REGISTRYINDEX, LUA_PRELOAD_TABLE);
  lua_pushcfunction(L, luaopen_barwright_core);
  lua_setfield(L, -2, "barwright.core");
  lua_settop(L, 0);
  const char *quiet = getenv("BARWRIGHT_QUIET");
  if (!quiet || strcmp(quiet, "1") != 0)
    engine->progress = program_progress;
  signal(SIGTERM, on_termination);
  signal(SIGHUP, on_termination);
  int status = run(L, &c);
  if (engine->stopping)
    status = INTERRUPTED;
  program_ignore_interrupt();
  program_progress_clear();
  lua_close(L);
  return status;
}
