/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* The prompt: lines edited by readline, statements over several lines, values printed, history
 * kept, names completed: globals, fields of tables, methods and properties of objects. */
#include "program.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include <readline/history.h>
#include <readline/readline.h>

static lua_State *completing; /* readline's callbacks take no argument of ours */

/* ---- completion ------------------------------------------------------------------------------ */

static void add_keys(lua_State *L, const char *start, char separator) {
  if (!lua_istable(L, -1))
    return;
  size_t length = strlen(start);
  for (lua_pushnil(L); lua_next(L, -2); lua_pop(L, 1)) {
    if (lua_type(L, -2) != LUA_TSTRING)
      continue;
    const char *name = lua_tostring(L, -2);
    if (strncmp(name, start, length) != 0 || (name[0] == '_' && start[0] != '_'))
      continue;
    if (separator == ':' && !lua_isfunction(L, -1))
      continue;
    lua_pushvalue(L, -2);
    lua_pushboolean(L, 1);
    lua_rawset(L, 1); /* the set of candidates */
  }
}

/* The names of the value on the top: its own keys, and those of its metatable. */
static void add_names(lua_State *L, const char *start, char separator) {
  add_keys(L, start, separator);
  if (!lua_getmetatable(L, -1))
    return;
  static const char *const parts[] = {"__methods", "__properties", "__index"};
  for (int i = 0; i < 3; i++) {
    if (separator == ':' && i == 1)
      continue;
    lua_pushstring(L, parts[i]);
    lua_rawget(L, -2);
    add_keys(L, start, separator);
    lua_pop(L, 1);
  }
  lua_pop(L, 1);
}

/* Argument: the word, such as "mesh.boundary:ne". Returns the set of candidates and the word's part
 * up to the last separator. Steps through fields, so a property may be computed; errors end it. */
static int candidates(lua_State *L) {
  const char *word = lua_tostring(L, 1);
  lua_newtable(L);
  lua_insert(L, 1);
  lua_pushglobaltable(L);
  char separator = '.';
  const char *start = word;
  for (const char *at = strpbrk(start, ".:"); at; at = strpbrk(start, ".:")) {
    lua_pushlstring(L, start, (size_t)(at - start));
    lua_gettable(L, -2);
    separator = *at;
    start = at + 1;
  }
  add_names(L, start, separator);
  lua_pushvalue(L, 1);
  lua_pushinteger(L, start - word);
  return 2;
}

static char **found; /* malloced words, ended by NULL */
static size_t found_count, found_next;

static void find(const char *word) {
  lua_State *L = completing;
  found_count = found_next = 0;
  free(found);
  found = NULL;
  int top = lua_gettop(L);
  lua_pushcfunction(L, candidates);
  lua_pushstring(L, word);
  if (lua_pcall(L, 1, 2, 0) == LUA_OK) {
    size_t prefix = (size_t)lua_tointeger(L, -1), count = 0;
    lua_pop(L, 1);
    for (lua_pushnil(L); lua_next(L, -2); lua_pop(L, 1))
      count++;
    found = (char **)calloc(count + 1, sizeof *found);
    for (lua_pushnil(L); found && lua_next(L, -2); lua_pop(L, 1)) {
      const char *name = lua_tostring(L, -2);
      char *whole = (char *)malloc(prefix + strlen(name) + 1);
      if (whole) {
        memcpy(whole, word, prefix);
        strcpy(whole + prefix, name);
        found[found_count++] = whole;
      }
    }
  }
  lua_settop(L, top);
}

static char *next_word(const char *word, int state) {
  if (state == 0)
    find(word);
  return found && found_next < found_count ? found[found_next++] : NULL;
}

static char **complete(const char *word, int start, int end) {
  (void)start;
  (void)end;
  rl_attempted_completion_over = 1; /* never file names */
  rl_completion_append_character = 0;
  return rl_completion_matches(word, next_word);
}

/* ---- history --------------------------------------------------------------------------------- */

/* $XDG_STATE_HOME/barwright_history, else ~/.barwright_history */
static const char *history_path(lua_State *L) {
  const char *state = getenv("XDG_STATE_HOME"), *home = getenv("HOME");
  if (state && state[0])
    return lua_pushfstring(L, "%s/barwright_history", state);
  return home && home[0] ? lua_pushfstring(L, "%s/.barwright_history", home) : NULL;
}

/* ---- reading and running --------------------------------------------------------------------- */

static char *read_line(const char *prompt) {
  if (isatty(STDIN_FILENO))
    return readline(prompt);
  char *line = NULL;
  size_t size = 0;
  ssize_t length = getline(&line, &size, stdin);
  if (length < 0) {
    free(line);
    return NULL;
  }
  if (length > 0 && line[length - 1] == '\n')
    line[length - 1] = 0;
  return line;
}

/* A chunk that fails for its end is only begun. */
static bool is_incomplete(lua_State *L) {
  const char *message = lua_tostring(L, -1);
  size_t length = strlen(message);
  return length >= 5 && strcmp(message + length - 5, "<eof>") == 0;
}

/* As an expression whose values are printed, else as statements; never as bytecode. The text is on
 * the top and is replaced by the function, or by a message. */
static int load_text(lua_State *L) {
  const char *text = lua_tostring(L, -1);
  const char *expression = lua_pushfstring(L, "return %s", text);
  if (luaL_loadbufferx(L, expression, strlen(expression), "=prompt", "t") == LUA_OK) {
    lua_replace(L, -3);
    lua_pop(L, 1);
    return LUA_OK;
  }
  lua_pop(L, 2);
  int status = luaL_loadbufferx(L, text, strlen(text), "=prompt", "t");
  lua_remove(L, -2);
  return status;
}

/* Reads lines until they are whole. Leaves a function or a message; -1 at the end of input. */
static int read_statement(lua_State *L) {
  char *line = read_line("> ");
  if (!line)
    return -1;
  lua_pushstring(L, line);
  free(line);
  for (;;) {
    lua_pushvalue(L, -1);
    int status = load_text(L);
    if (status != LUA_ERRSYNTAX || !is_incomplete(L) || !(line = read_line(">> "))) {
      if (isatty(STDIN_FILENO) && lua_tostring(L, -2)[0])
        add_history(lua_tostring(L, -2));
      lua_remove(L, -2);
      return status;
    }
    lua_pop(L, 1);
    lua_pushfstring(L, "%s\n%s", lua_tostring(L, -1), line);
    lua_remove(L, -2);
    free(line);
  }
}

/* print(...), and where the first value is nil and a message follows, that message is what counts
 */
static void print_values(lua_State *L, int count) {
  luaL_checkstack(L, LUA_MINSTACK, "too many values to print");
  lua_getglobal(L, "print");
  lua_insert(L, -count - 1);
  program_call(L, count, 0);
}

void program_prompt(lua_State *L) {
  completing = L;
  rl_readline_name = "barwright";
  rl_attempted_completion_function = complete;
  rl_basic_word_break_characters = " \t\n\"\\'`@$><=;|&{(+-*/^#~,[";
  const char *history = history_path(L);
  bool terminal = isatty(STDIN_FILENO);
  if (terminal) {
    printf("barwright " BW_VERSION "; the module is bw; end with Ctrl-D\n");
    if (history)
      read_history(history);
  }
  int base = lua_gettop(L);
  int status;
  program_ignore_interrupt();
  lbw_state_of(L)->echo = true; /* a script takes the warnings itself */
  while ((status = read_statement(L)) >= 0) {
    if (status == LUA_OK) {
      program_catch_interrupt(L);
      if (program_call(L, 0, LUA_MULTRET) && lua_gettop(L) > base)
        print_values(L, lua_gettop(L) - base);
      program_ignore_interrupt();
      lbw_state_of(L)->stopping = 0;
    } else
      fprintf(stderr, "%s\n", lua_tostring(L, -1));
    lua_settop(L, base);
  }
  if (terminal) {
    putchar('\n');
    if (history) {
      mode_t mask = umask(077);
      stifle_history(2000);
      write_history(history);
      umask(mask);
    }
  }
}
