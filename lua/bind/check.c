/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* Arguments and options: vectors, indices, axes, tables of options with their known keys. */
#include "bind.h"

#include <limits.h>
#include <math.h>
#include <string.h>

bool lbw_to_vector(lua_State *L, int index, double vector[3]) {
  index = lua_absindex(L, index);
  const bw_array *array = (const bw_array *)lbw_test(L, index, &lbw_array_class);
  if (array) {
    if (array->rows * array->columns != 3)
      return false;
    for (int i = 0; i < 3; i++)
      vector[i] = array->columns == 1 ? bw_array_get(array, i, 0) : bw_array_get(array, 0, i);
    return true;
  }
  if (!lua_istable(L, index) || lua_rawlen(L, index) != 3)
    return false;
  for (int i = 0; i < 3; i++) {
    bool number = lua_rawgeti(L, index, i + 1) == LUA_TNUMBER;
    vector[i] = lua_tonumber(L, -1);
    lua_pop(L, 1);
    if (!number || !isfinite(vector[i]))
      return false;
  }
  return true;
}

void lbw_check_vector(lua_State *L, int argument, const char *what, double vector[3]) {
  if (!lbw_to_vector(L, argument, vector))
    lbw_argument_error(L, argument,
                       lua_pushfstring(L, "%s: three finite numbers {x, y, z} expected, got %s",
                                       what, lbw_got(L, argument)));
}

void lbw_check_pair(lua_State *L, int index, const char *what, double pair[2]) {
  bool ok = lua_istable(L, index) && lua_rawlen(L, index) == 2;
  index = lua_absindex(L, index);
  for (int i = 0; i < 2 && ok; i++) {
    ok = lua_rawgeti(L, index, i + 1) == LUA_TNUMBER && isfinite(lua_tonumber(L, -1));
    pair[i] = lua_tonumber(L, -1);
    lua_pop(L, 1);
  }
  if (!ok)
    lbw_error(L, "%s: two finite numbers {x, y} expected, got %s", what, lbw_got(L, index));
}

void lbw_push_vector(lua_State *L, const double vector[3]) {
  lua_createtable(L, 3, 0);
  for (int i = 0; i < 3; i++) {
    lua_pushnumber(L, vector[i]);
    lua_rawseti(L, -2, i + 1);
  }
}

static int text_of(lua_State *L) {
  lua_pushvalue(L, lua_upvalueindex(1));
  return 1;
}

void lbw_prints(lua_State *L) {
  lua_createtable(L, 0, 1);
  lua_insert(L, -2);
  lua_pushcclosure(L, text_of, 1);
  lua_setfield(L, -2, "__tostring");
  lua_setmetatable(L, -2);
}

double lbw_check_real(lua_State *L, int argument, const char *what) {
  if (lua_type(L, argument) != LUA_TNUMBER)
    lbw_argument_error(
        L, argument,
        lua_pushfstring(L, "%s: a number expected, got %s", what, lbw_got(L, argument)));
  double value = lua_tonumber(L, argument);
  if (!isfinite(value))
    lbw_argument_error(
        L, argument,
        lua_pushfstring(L, "%s: a finite number expected, got %s", what, lbw_got(L, argument)));
  return value;
}

int64_t lbw_check_index(lua_State *L, int argument, const char *what, int64_t count) {
  int is_integer = 0;
  lua_Integer value =
      lua_type(L, argument) == LUA_TNUMBER ? lua_tointegerx(L, argument, &is_integer) : 0;
  if (!is_integer || value < 1 || value > count) { /* often a table's field: no argument number */
    const char *got = lbw_got(L, argument);
    if (count == 0)
      lbw_error(L, "%s: there is none, got %s", what, got);
    lbw_error(L, "%s: a number from 1 to %I expected, got %s", what, (LUAI_UACINT)count, got);
  }
  return value - 1;
}

void lbw_read_name(lua_State *L, int index, const char *what, bw_name *name) {
  size_t length = 0;
  const char *text = lua_type(L, index) == LUA_TSTRING ? lua_tolstring(L, index, &length) : NULL;
  if (!text || length >= BW_NAME || strlen(text) != length)
    lbw_error(L, "%s: a name of at most %d bytes, without zeros, expected, got %s", what,
              BW_NAME - 1, lbw_got(L, index));
  memset(name, 0, sizeof *name);
  memcpy(name->text, text, length);
}

int lbw_check_axis(lua_State *L, int argument) {
  if (lua_type(L, argument) == LUA_TSTRING) {
    const char *name = lua_tostring(L, argument);
    if (strlen(name) == 1 && name[0] >= 'x' && name[0] <= 'z')
      return name[0] - 'x';
  } else if (lua_isinteger(L, argument)) {
    lua_Integer axis = lua_tointeger(L, argument);
    if (axis >= 1 && axis <= 3)
      return (int)axis - 1;
  }
  return lbw_argument_refused(L, argument, "an axis, 1, 2, 3 or \"x\", \"y\", \"z\", expected");
}

void lbw_check_matrix(lua_State *L, int argument, const char *what, int rows, int columns,
                      double *matrix) {
  int64_t count = 0;
  argument = lua_absindex(L, argument);
  double *data = NULL;
  if (lua_istable(L, argument) && (int)lua_rawlen(L, argument) == rows * columns) {
    data = lbw_to_doubles(L, argument, what, 1, &count);
    count /= columns;
  } else if (lua_istable(L, argument) || lbw_test(L, argument, &lbw_array_class)) {
    data = lbw_to_doubles(L, argument, what, columns, &count);
  } else {
    lbw_argument_error(L, argument,
                       lua_pushfstring(L, "%s: %d rows of %d numbers expected, got %s", what, rows,
                                       columns, lbw_got(L, argument)));
  }
  if (count != rows)
    lbw_error(L, "%s: %d rows of %d numbers expected, got %I rows", what, rows, columns,
              (LUAI_UACINT)count);
  memcpy(matrix, data, sizeof *matrix * (size_t)(rows * columns));
  lua_pop(L, 1);
}

const void *lbw_object_option(lua_State *L, int index, const char *function, const char *key,
                              const lbw_class *class, const char *expected) {
  int type = lbw_option_get(L, index, key);
  const void *object = lbw_test(L, -1, class);
  const lbw_box *box = lbw_any_box(L, -1);
  if (!object && box && box->class == class)
    lbw_error(L, "%s: option '%s': this %s is closed", function, key, class->name);
  bool is_auto = type == LUA_TSTRING && strcmp(lua_tostring(L, -1), "auto") == 0;
  if (!object && !is_auto && type != LUA_TNIL)
    lbw_option_refused(L, function, key, expected);
  lua_pop(L, 1);
  return object;
}

int lbw_option_missing(lua_State *L, const char *function, const char *key, const char *why) {
  return lbw_error(L, "%s: option '%s' is missing%s", function, key, why);
}

int lbw_option_refused(lua_State *L, const char *function, const char *key, const char *expected) {
  const lbw_box *box = lbw_any_box(L, -1);
  if (box && !box->object)
    return lbw_error(L, "%s: option '%s': this %s is closed", function, key, box->class->name);
  return lbw_error(L, "%s: option '%s': %s expected, got %s", function, key, expected,
                   lbw_got(L, -1));
}

/* The value is on the top of the stack. */
static void read_option(lua_State *L, const char *function, const lbw_option *option, char *into) {
  void *place = into + option->offset;
  int is_integer = 0;
  lua_Integer integer = lua_type(L, -1) == LUA_TNUMBER ? lua_tointegerx(L, -1, &is_integer) : 0;
  switch (option->type) {
  case LBW_BOOLEAN:
    if (!lua_isboolean(L, -1))
      lbw_option_refused(L, function, option->key, "true or false");
    *(bool *)place = lua_toboolean(L, -1);
    break;
  case LBW_REAL:
    if (lua_type(L, -1) != LUA_TNUMBER || !isfinite(lua_tonumber(L, -1)))
      lbw_option_refused(L, function, option->key, "a finite number");
    *(double *)place = lua_tonumber(L, -1);
    break;
  case LBW_INT:
    if (!is_integer || integer < INT_MIN || integer > INT_MAX)
      lbw_option_refused(L, function, option->key, "a whole number");
    *(int *)place = (int)integer;
    break;
  case LBW_COUNT:
    if (!is_integer || integer < 0)
      lbw_option_refused(L, function, option->key, "a whole number of at least 0");
    *(int64_t *)place = integer;
    break;
  case LBW_SEED:
    if (!is_integer)
      lbw_option_refused(L, function, option->key, "a whole number");
    *(uint64_t *)place = (uint64_t)integer;
    break;
  case LBW_VECTOR:
    if (!lbw_to_vector(L, -1, (double *)place))
      lbw_option_refused(L, function, option->key, "three finite numbers {x, y, z}");
    break;
  case LBW_OTHER:
    break;
  }
}

/* Whether the key on the top of the stack is of an option. */
static bool is_known(lua_State *L, const lbw_option *option) {
  if (lua_type(L, -1) != LUA_TSTRING)
    return false;
  while (option->key && strcmp(option->key, lua_tostring(L, -1)) != 0)
    option++;
  return option->key != NULL;
}

/* The wrong key is on the top of the stack. */
static void unknown_option(lua_State *L, const char *function, const lbw_option *options) {
  if (lua_type(L, -1) != LUA_TSTRING)
    lbw_error(L, "%s: named options expected, {name = value}, got a value at %s", function,
              luaL_tolstring(L, -1, NULL));
  const char *name[64];
  size_t count = 0;
  for (const lbw_option *option = options; option->key && count < 64; option++)
    name[count++] = option->key;
  const char *wrong = lua_tostring(L, -1);
  lbw_error(L, "%s: unknown option '%s': %s", function, wrong,
            lbw_suggestion(L, wrong, name, count));
}

/* Raises for a key without a name, or for the first unknown one in the alphabet: the order of the
 * table depends on the seed of Lua's hashes. */
static void check_keys(lua_State *L, int index, const char *function, const lbw_option *options) {
  lua_pushnil(L); /* the wrong key */
  for (lua_pushnil(L); lua_next(L, index);) {
    lua_pop(L, 1);
    if (is_known(L, options))
      continue;
    if (lua_type(L, -1) != LUA_TSTRING)
      unknown_option(L, function, options);
    if (lua_isnil(L, -2) || strcmp(lua_tostring(L, -1), lua_tostring(L, -2)) < 0) {
      lua_pushvalue(L, -1);
      lua_replace(L, -3);
    }
  }
  if (!lua_isnil(L, -1))
    unknown_option(L, function, options);
  lua_pop(L, 1);
}

void lbw_options(lua_State *L, int index, const char *function, const lbw_option *options,
                 void *into) {
  if (lua_isnoneornil(L, index))
    return;
  if (!lua_istable(L, index))
    lbw_error(L, "%s: a table of options expected, got %s", function, lbw_got(L, index));
  index = lua_absindex(L, index);
  check_keys(L, index, function, options);
  for (const lbw_option *option = options; option->key; option++) {
    if (lbw_option_get(L, index, option->key) != LUA_TNIL)
      read_option(L, function, option, (char *)into);
    lua_pop(L, 1);
  }
}

int lbw_option_get(lua_State *L, int index, const char *key) {
  if (!lua_istable(L, index)) {
    lua_pushnil(L);
    return LUA_TNIL;
  }
  index = lua_absindex(L, index);
  lua_pushstring(L, key);
  return lua_rawget(L, index); /* raw, as lbw_options: no foreign code runs in between */
}

int lbw_word_option(lua_State *L, int index, const char *function, const char *key,
                    const char *const words[], int otherwise) {
  int type = lbw_option_get(L, index, key), found = otherwise;
  if (type != LUA_TNIL) {
    size_t count = 0;
    found = -1;
    for (; words[count]; count++)
      if (type == LUA_TSTRING && strcmp(words[count], lua_tostring(L, -1)) == 0)
        found = (int)count;
    if (found < 0) {
      const char *wrong = luaL_tolstring(L, -1, NULL);
      lbw_error(L, "%s: option '%s': '%s' is not known: %s", function, key, wrong,
                lbw_suggestion(L, wrong, words, count));
    }
  }
  lua_pop(L, 1);
  return found;
}
