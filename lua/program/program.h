/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* Between the files of the program. */
#ifndef PROGRAM_H
#define PROGRAM_H

#include "bind.h"

/* Runs the function with its arguments on the stack, with a traceback on an error, which is
 * printed. False after an error. */
bool program_call(lua_State *L, int arguments, int results);
/* While a script runs, Ctrl-C stops it (see main.c). */
void program_catch_interrupt(lua_State *L);
void program_ignore_interrupt(void);

/* ---- limits (limits.c) ---- */

typedef struct program_limits {
  const char *sandbox; /* the folder, or NULL */
  double memory;       /* bytes; 0: no limit */
  double seconds;      /* 0: no limit */
} program_limits;
enum { PROGRAM_CHILD = -1, PROGRAM_MISUSED = 2, PROGRAM_NO_FILE = 3, PROGRAM_OVERDUE = 124 };
/* Forks: in the child PROGRAM_CHILD, with its memory limited; in the parent, once the child has
 * ended, the exit status. */
int program_watch(const program_limits *limits);
/* NULL where there is no memory. */
lua_State *program_new_state(const program_limits *limits);
void program_out_of_memory(void);
/* "200M", "2G"; "60", "5min" */
bool program_read_bytes(const char *text, double *bytes);
bool program_read_seconds(const char *text, double *seconds);

/* ---- the command line (command_line.c) ---- */

typedef struct program_command {
  const char *statements, *script; /* the script may be the name of a command */
  int script_at, count;
  char **value;
  bool prompt, stress, mpi, version, help;
  program_limits limits;
} program_command;
/* False, with a message printed, where it is misused. */
bool program_read_command(int argc, char **argv, program_command *c);

/* ---- what runs (script.c) ---- */

/* arg[0] the script, arg[1].. its arguments, negative what stands before, as in lua. */
void program_set_arguments(lua_State *L, const program_command *c);
/* Each of these prints what went wrong, and is false then. */
bool program_report(lua_State *L, bool help); /* else versions */
bool program_join_ranks(lua_State *L);  /* goes on at rank 0; the others work for it, and end */
bool program_load_module(lua_State *L); /* the global bw */
bool program_run_statements(lua_State *L, const char *text);
/* A word without a dot or a slash is the name of a command, if there is one; else a script. The
 * exit status. */
int program_run_word(lua_State *L, const program_command *c);

/* ---- the library and the sandbox (library.c, sandbox.c, kernel.c) ---- */

/* Where require finds the library's files; and enters the sandbox, where one is asked for. False,
 * with a message printed, where it cannot be put up. */
bool program_set_library(lua_State *L, const program_command *c);

/* Closes what Lua could open. False, with a message printed, when memory is out. */
bool program_close_lua(lua_State *L);
typedef struct program_walls {
  int landlock; /* the kernel's version of it; 0: none */
  bool calls;   /* system calls are filtered */
} program_walls;
/* `readable`: files and folders beside the folder, ended by NULL. */
program_walls program_close_kernel(const char *folder, const char *const *readable);

/* The prompt: reads statements until the end of input. */
void program_prompt(lua_State *L);

/* Shows progress on standard error: a line that is written over on a terminal, one line a minute
 * elsewhere. */
bw_progress_function program_progress;
/* Ends a line that progress has left open. */
void program_progress_clear(void);

#endif
