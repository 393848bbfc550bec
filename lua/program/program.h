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

/* The prompt: reads statements until the end of input. */
void program_prompt(lua_State *L);

/* Shows progress on standard error: a line that is written over on a terminal, one line a minute
 * elsewhere. */
bw_progress_function program_progress;
/* Ends a line that progress has left open. */
void program_progress_clear(void);

#endif
