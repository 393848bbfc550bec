/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* Errors of misuse, in C and (as core.raise) in the library's Lua files. Their message begins with
 * the line of the script that went wrong: the first one on the way out that is neither in C nor in
 * the library. Lua's own luaL_error and its relatives would name the library's line instead. */
#include "bind.h"

#include <stdarg.h>
#include <string.h>

static const char library_key; /* registry: what the sources of the library's chunks begin with */

static bool starts_with(const char *text, const char *beginning) {
  return strncmp(text, beginning, strlen(beginning)) == 0;
}

/* Pushes "script.lua:12: "; "" where nothing but the library is on the way out. */
static void push_position(lua_State *L) {
  lua_Debug at;
  const char *library =
      lua_rawgetp(L, LUA_REGISTRYINDEX, &library_key) == LUA_TSTRING ? lua_tostring(L, -1) : NULL;
  for (int level = 1; lua_getstack(L, level, &at); level++) {
    lua_getinfo(L, "Sl", &at);
    if (at.currentline > 0 && !(library && starts_with(at.source, library))) {
      lua_pushfstring(L, "%s:%d: ", at.short_src, at.currentline);
      lua_remove(L, -2);
      return;
    }
  }
  lua_pushliteral(L, "");
  lua_remove(L, -2);
}

int lbw_error(lua_State *L, const char *format, ...) {
  va_list arguments;
  va_start(arguments, format);
  push_position(L);
  lua_pushvfstring(L, format, arguments);
  va_end(arguments);
  lua_concat(L, 2);
  return lua_error(L);
}

/* A bound function is called by its guard, which is what the script calls. */
static bool called_by_guard(lua_State *L, lua_Debug *caller) {
  if (!lua_getstack(L, 1, caller))
    return false;
  lua_getinfo(L, "nf", caller);
  bool guard = lua_tocfunction(L, -1) == lbw_guarded;
  lua_pop(L, 1);
  return guard;
}

/* The function that the script called, by its name there, or NULL; *method: with a colon. */
static const char *called_name(lua_State *L, bool *method) {
  lua_Debug called = {0};
  if (!called_by_guard(L, &called) && lua_getstack(L, 0, &called))
    lua_getinfo(L, "n", &called);
  *method = called.name && strcmp(called.namewhat, "method") == 0;
  return called.name;
}

/* Whether the text begins with the argument's name: "force: ...". */
static bool names_argument(const char *text) {
  size_t length = strspn(text, "abcdefghijklmnopqrstuvwxyz_");
  return length > 0 && starts_with(text + length, ": ");
}

int lbw_argument_error(lua_State *L, int argument, const char *text) {
  bool method;
  const char *name = called_name(L, &method);
  argument -= method;
  const bool named = argument == 0 || names_argument(text);
  if (!name)
    return named ? lbw_error(L, "%s", text) : lbw_error(L, "argument %d: %s", argument, text);
  return named ? lbw_error(L, "%s: %s", name, text)
               : lbw_error(L, "%s: argument %d: %s", name, argument, text);
}

int lbw_class_error(lua_State *L, int argument, const lbw_class *class) {
  bool method, of_class = false;
  const char *name = called_name(L, &method);
  const char *got = lbw_got(L, argument); /* first: what is pushed may lie where it is missing */
  const char *text = lua_pushfstring(L, "%s expected, got %s", lbw_spoken(L, class->name), got);
  for (const luaL_Reg *m = class->methods; m->name; m++)
    of_class = of_class || (name && strcmp(m->name, name) == 0);
  if (argument == 1 && of_class && !method)
    return lbw_error(L, "%s: %s: call it with a colon, as in %s:%s(...)", name, text, class->name,
                     name);
  return lbw_argument_error(L, argument, text);
}

const char *lbw_spoken(lua_State *L, const char *name) {
  size_t length = strlen(name);
  /* not: basis, canvas */
  bool plural = length > 1 && name[length - 1] == 's' && !strchr("ia", name[length - 2]);
  const char *article = plural ? "" : name[0] && strchr("aeiou", name[0]) ? "an " : "a ";
  return lua_pushfstring(L, "%s%s", article, luaL_gsub(L, name, "_", " "));
}

static const char *rows_text(lua_State *L, const char *what, int64_t rows, int64_t expected,
                             const char *each) {
  return lua_pushfstring(L, "%s: %I rows expected, one for each %s, got %I", what,
                         (LUAI_UACINT)expected, each, (LUAI_UACINT)rows);
}

void lbw_check_rows(lua_State *L, int argument, const char *what, int64_t rows, int64_t expected,
                    const char *each) {
  if (rows != expected)
    lbw_argument_error(L, argument, rows_text(L, what, rows, expected, each));
}

void lbw_require_rows(lua_State *L, const char *what, int64_t rows, int64_t expected,
                      const char *each) {
  if (rows != expected)
    lbw_error(L, "%s", rows_text(L, what, rows, expected, each));
}

static const char *got_string(lua_State *L, int index) {
  enum { SHOWN = 40 };
  size_t length, shown = 0;
  const char *text = lua_tolstring(L, index, &length);
  char copy[SHOWN + 1];
  for (; shown < length && shown < SHOWN; shown++)
    copy[shown] = (unsigned char)text[shown] < ' ' ? '?' : text[shown];
  if (shown < length) /* no part of a character at the end */
    while (shown > 0 && ((unsigned char)text[shown] & 0xc0) == 0x80)
      shown--;
  copy[shown] = 0;
  return lua_pushfstring(L, "string '%s%s'", copy, shown < length ? "..." : "");
}

const char *lbw_got(lua_State *L, int index) {
  index = lua_absindex(L, index);
  switch (lua_type(L, index)) {
  case LUA_TNONE:
    return lua_pushliteral(L, "no value");
  case LUA_TNUMBER:
    lua_pushvalue(L, index);
    return lua_tostring(L, -1);
  case LUA_TBOOLEAN:
    return lua_pushstring(L, lua_toboolean(L, index) ? "true" : "false");
  case LUA_TSTRING:
    return got_string(L, index);
  default: {
    const bw_array *array = (const bw_array *)lbw_test(L, index, &lbw_array_class);
    return array ? lua_pushfstring(L, "array of %I x %I", (LUAI_UACINT)array->rows,
                                   (LUAI_UACINT)array->columns)
                 : lua_pushstring(L, lbw_type_name(L, index));
  }
  }
}

int lbw_argument_refused(lua_State *L, int argument, const char *text) {
  static const char word[] = "expected";
  const size_t length = strlen(text), end = sizeof word - 1;
  const int type = lua_type(L, argument);
  const bool tells = type != LUA_TTABLE && type != LUA_TFUNCTION &&
                     (type != LUA_TUSERDATA || lbw_test(L, argument, &lbw_array_class));
  if (tells && length >= end && strcmp(text + length - end, word) == 0)
    text = lua_pushfstring(L, "%s, got %s", text, lbw_got(L, argument));
  return lbw_argument_error(L, argument, text);
}

static int type_error(lua_State *L, int argument, const char *expected) {
  return lbw_argument_error(
      L, argument, lua_pushfstring(L, "%s expected, got %s", expected, lbw_got(L, argument)));
}

void lbw_check_type(lua_State *L, int argument, int type) {
  if (lua_type(L, argument) != type) {
    const char *got = lbw_got(L, argument);
    lbw_argument_error(L, argument,
                       lua_pushfstring(L, "a %s expected, got %s", lua_typename(L, type), got));
  }
}

const char *lbw_check_text(lua_State *L, int argument, size_t *length) {
  size_t size = 0;
  const char *text = lua_tolstring(L, argument, &size);
  if (!text)
    type_error(L, argument, "a string");
  else if (!length && strlen(text) != size) /* C would see the beginning alone */
    lbw_argument_error(L, argument, "a string without zero bytes expected");
  if (length)
    *length = size;
  return text;
}

lua_Integer lbw_check_integer(lua_State *L, int argument) {
  int is_integer;
  lua_Integer value = lua_tointegerx(L, argument, &is_integer);
  if (!is_integer)
    type_error(L, argument, "a whole number");
  return value;
}

lua_Integer lbw_integer_or(lua_State *L, int argument, lua_Integer otherwise) {
  return lua_isnoneornil(L, argument) ? otherwise : lbw_check_integer(L, argument);
}

double lbw_check_number(lua_State *L, int argument) {
  int is_number;
  double value = lua_tonumberx(L, argument, &is_number);
  if (!is_number)
    type_error(L, argument, "a number");
  return value;
}

double lbw_number_or(lua_State *L, int argument, double otherwise) {
  return lua_isnoneornil(L, argument) ? otherwise : lbw_check_number(L, argument);
}

int lbw_check_word(lua_State *L, int argument, const char *const words[]) {
  if (lua_isnoneornil(L, argument))
    return 0;
  const char *word = lbw_check_text(L, argument, NULL);
  int count = 0;
  for (; words[count]; count++)
    if (strcmp(words[count], word) == 0)
      return count;
  return lbw_argument_error(L, argument,
                            lua_pushfstring(L, "'%s' is not known: %s", word,
                                            lbw_suggestion(L, word, words, (size_t)count)));
}

/* raise(message) */
static int core_raise(lua_State *L) {
  return lbw_error(L, "%s", lbw_check_text(L, 1, NULL));
}

/* got(value): what a message says was found */
static int core_got(lua_State *L) {
  lbw_got(L, 1);
  return 1;
}

/* spoken(name): how a message names a class or a type */
static int core_spoken(lua_State *L) {
  lbw_spoken(L, lbw_check_text(L, 1, NULL));
  return 1;
}

/* library(): the folder of the file that calls holds the library */
static int core_library(lua_State *L) {
  lua_Debug at;
  int level = 1;
  do { /* past the guard */
    if (!lua_getstack(L, level++, &at))
      return 0;
    lua_getinfo(L, "S", &at);
  } while (at.what[0] == 'C');
  const char *end = at.source[0] == '@' ? strrchr(at.source, '/') : NULL;
  if (end) {
    lua_pushlstring(L, at.source, (size_t)(end - at.source) + 1);
    lua_rawsetp(L, LUA_REGISTRYINDEX, &library_key);
  }
  return 0;
}

void lbw_open_raise(lua_State *L) {
  static const luaL_Reg functions[] = {{"raise", core_raise},
                                       {"got", core_got},
                                       {"spoken", core_spoken},
                                       {"library", core_library},
                                       {NULL, NULL}};
  luaL_setfuncs(L, functions, 0);
}
