/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* The program barwright: runs a command, a script or statements, or opens a prompt, with the module
 * built in. Commands are Lua: lua/barwright/command.
 *
 * Ctrl-C: while the engine works, the first one asks it to stop; the call returns nil, "cancelled"
 * and the script can keep what is done. Otherwise, and the second time, an error is raised at the
 * next step of the script. The program then ends with status 130. A third one ends it at once. */
#include "program.h"

#include <errno.h>
#include <locale.h>
#include <lualib.h>
#include <malloc.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

enum { INTERRUPTED = 130 };

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
    bw_temporaries_abandon();
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
  bw_temporaries_abandon();
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
    else if (failure == LUA_ERRMEM)
      program_out_of_memory();
    else
      fprintf(stderr, "barwright: %s\n", lua_tostring(L, -1));
    lua_pop(L, 1);
  }
  return !failure;
}

/* ---- running --------------------------------------------------------------------------------- */

/* The exit status. */
static int run(lua_State *L, const program_command *c) {
  program_set_arguments(L, c);
  if (!program_set_library(L, c))
    return EXIT_FAILURE;
  if (c->version || c->help)
    return program_report(L, c->help) ? EXIT_SUCCESS : EXIT_FAILURE;
  bool prompt = c->prompt || (!c->script && !c->statements);
  if (c->stress) {
    /* No pause, and a step as large as the heap: every allocation runs a whole cycle. */
    lua_gc(L, LUA_GCINC, 0, 1000, 100);
    lua_gc(L, LUA_GCSETPAUSE, 0);
  }
  program_catch_interrupt(L);
  if (c->mpi && !program_join_ranks(L))
    return EXIT_FAILURE;
  bool ok = !(c->statements || prompt) || program_load_module(L);
  if (ok && c->statements)
    ok = program_run_statements(L, c->statements);
  int code = ok ? EXIT_SUCCESS : EXIT_FAILURE;
  if (ok && c->script)
    code = program_run_word(L, c);
  if (prompt && !engine->stopping) {
    program_prompt(L);
    return EXIT_SUCCESS;
  }
  return code;
}

/* Fields of megabytes come and go with every solution: memory that was given back to the system
 * each time would come back as pages to be cleared, a tenth of an optimisation. */
static void keep_freed_memory(void) {
  mallopt(M_MMAP_THRESHOLD, 32 << 20); /* the most that there can be */
  mallopt(M_TRIM_THRESHOLD, 256 << 20);
}

/* What a script printed may be lost without a word: its exit status says so. A command has told. */
static int all_written(int status) {
  bool lost = ferror(stdout) != 0;
  errno = 0;
  lost = fflush(stdout) != 0 || lost;
  if (!lost || status != EXIT_SUCCESS)
    return status;
  fprintf(stderr, "barwright: standard output: %s\n",
          errno ? strerror(errno) : "not all could be written");
  return PROGRAM_NO_FILE;
}

/* The engine takes what it can use of it, and all processors otherwise. */
static bool threads_can_be_read(void) {
  const char *text = getenv("BARWRIGHT_THREADS");
  char *end;
  if (!text || !text[0] || (strtol(text, &end, 10) >= 1 && *end == '\0'))
    return true;
  fprintf(stderr, "barwright: BARWRIGHT_THREADS: a number of threads expected, got '%s'\n", text);
  return false;
}

int main(int argc, char **argv) {
  program_command c;
  keep_freed_memory();
  /* A file that may not grow further is a failure to write, which can be reported. The program says
   * so, not the library, whose host may want it otherwise. */
  signal(SIGXFSZ, SIG_IGN);
  if (!program_read_command(argc, argv, &c) || !threads_can_be_read())
    return PROGRAM_MISUSED;
  if (c.limits.sandbox || c.limits.memory > 0 || c.limits.seconds > 0) {
    int status = program_watch(&c.limits);
    if (status != PROGRAM_CHILD)
      return status;
  }
  setlocale(LC_CTYPE, ""); /* for editing lines of UTF-8; numbers stay with the C locale */
  lua_State *L = program_new_state(&c.limits);
  if (!L) {
    program_out_of_memory();
    return EXIT_FAILURE;
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
  return all_written(status);
}
