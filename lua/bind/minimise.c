/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* core.minimise: NLopt's minimisers of Lua functions.
 *
 * The functions may call the engine: between two of NLopt's steps nothing of it is at work, so they
 * run under an open guard. They run protected; an error is kept on the stack, the
 * minimiser told to stop, and the error raised when it has. */
#include <math.h>
#include <string.h>

#include "bind.h"

typedef struct request {
  lua_State *L;
  int functions; /* the place on the stack of the objective; constraints follow */
  int error;     /* the place for an error value */
  bool failed;
  int n;
  const char *method;
} request;

typedef struct asked {
  const request *request;
  int which;
  const double *x;
  double *value, *gradient;
} asked;

static int number_expected(lua_State *L, const char *name, int which) {
  if (which == 0)
    return lbw_error(L, "minimise: the objective must return a number, got %s", name);
  return lbw_error(L, "minimise: constraint %d must return a number, got %s", which, name);
}

/* (asked, function), protected */
static int call(lua_State *L) {
  const asked *a = (const asked *)lua_touserdata(L, 1);
  int n = a->request->n;
  lua_settop(L, 2);
  lua_createtable(L, n, 0);
  for (int i = 0; i < n; i++) {
    lua_pushnumber(L, a->x[i]);
    lua_rawseti(L, -2, i + 1);
  }
  lua_call(L, 1, 2);
  if (lua_type(L, 2) != LUA_TNUMBER)
    return number_expected(L, lbw_got(L, 2), a->which);
  *a->value = lua_tonumber(L, 2);
  if (!a->gradient)
    return 0;
  if (lua_isnil(L, 3))
    return lbw_error(L,
                     "minimise: %s needs gradients: a function returns its value and a list of "
                     "%d derivatives",
                     a->request->method, n);
  int64_t rows;
  const double *gradient = lbw_to_doubles(L, 3, "gradient", 1, &rows);
  if (rows != n)
    return lbw_error(L, "minimise: a gradient of %d numbers expected, got %d", n, (int)rows);
  memcpy(a->gradient, gradient, (size_t)n * sizeof *gradient);
  return 0;
}

static bw_status ask(bw_context *context, void *data, int which, const double *x, double *value,
                     double *gradient) {
  request *r = (request *)data;
  lua_State *L = r->L;
  lbw_state *state = lbw_state_of(L);
  asked a = {r, which, x, value, gradient};
  lua_pushcfunction(L, call);
  lua_pushlightuserdata(L, &a);
  lua_pushvalue(L, r->functions + which);
  lbw_guard guard;
  lbw_guard_begin(state, &guard, true);
  int failure = lua_pcall(L, 2, 0, 0);
  lbw_guard_end(state, &guard);
  if (failure == LUA_OK)
    return BW_OK;
  lua_replace(L, r->error);
  r->failed = true;
  return bw_fail(context, BW_CANCELLED, "a function to be minimised failed");
}

/* ---- options --------------------------------------------------------------------------------- */

/* options[key] as n numbers in a userdata that is pushed; NULL (and nil) where it is not given. A
 * nil within a list cannot be told from its end: infinite bounds are written as -math.huge. */
static double *numbers(lua_State *L, const char *key, int64_t *n) {
  int64_t rows;
  if (lbw_option_get(L, 1, key) == LUA_TNIL)
    return NULL;
  double *data = lbw_to_doubles(L, -1, key, 1, &rows);
  lua_remove(L, -2);
  if (*n >= 0 && rows != *n)
    lbw_error(L, "minimise: option '%s': %d numbers expected, got %d", key, (int)*n, (int)rows);
  *n = rows;
  return data;
}

/* The midpoint between the bounds, where there is no start. */
static double *start_of(lua_State *L, int64_t n, const double *min, const double *max) {
  double *x = (double *)lua_newuserdatauv(L, (size_t)(n + 1) * sizeof *x, 0);
  if (!min || !max)
    lbw_option_missing(L, "minimise", "start", ": it is needed where a variable has no bounds");
  for (int64_t i = 0; i < n; i++) {
    x[i] = min[i] + (max[i] - min[i]) / 2;
    if (!isfinite(x[i]))
      lbw_option_missing(L, "minimise", "start", ": it is needed where a bound is infinite");
  }
  return x;
}

static int push_functions(lua_State *L) {
  if (lbw_option_get(L, 1, "objective") != LUA_TFUNCTION)
    lbw_option_refused(L, "minimise", "objective", "a function of x");
  int type = lbw_option_get(L, 1, "constraints");
  if (type != LUA_TNIL && type != LUA_TTABLE)
    lbw_option_refused(L, "minimise", "constraints", "a list of functions of x");
  int list = lua_gettop(L), count = type == LUA_TNIL ? 0 : (int)lua_rawlen(L, list);
  luaL_checkstack(L, count + 20, "too many constraints");
  for (int i = 1; i <= count; i++)
    if (lua_rawgeti(L, list, i) != LUA_TFUNCTION)
      lbw_option_refused(L, "minimise", "constraints", "functions of x");
  lua_remove(L, list);
  return count;
}

static void push_report(lua_State *L, const bw_minimise_result *result) {
  lua_createtable(L, 0, 4);
  lua_pushstring(L, bw_minimise_end_word(result->end));
  lua_setfield(L, -2, "why");
  lua_pushinteger(L, (lua_Integer)result->evaluations);
  lua_setfield(L, -2, "evaluations");
  lua_pushnumber(L, result->violation);
  lua_setfield(L, -2, "violation");
  lua_pushboolean(L, result->end == BW_END_TOLERANCE || result->end == BW_END_GOOD_ENOUGH ||
                         result->end == BW_END_ROUNDOFF);
  lua_setfield(L, -2, "converged");
}

/* minimise{method, start, min, max, objective, constraints, tolerance, value_tolerance,
 * constraint_tolerance, good_enough, evaluations, population, step, seed}: x, value, {why,
 * evaluations, violation, converged} */
static int core_minimise(lua_State *L) {
  static const lbw_option list[] = {
      {"method", LBW_OTHER, 0},
      {"start", LBW_OTHER, 0},
      {"min", LBW_OTHER, 0},
      {"max", LBW_OTHER, 0},
      {"objective", LBW_OTHER, 0},
      {"constraints", LBW_OTHER, 0},
      {"step", LBW_OTHER, 0},
      {"tolerance", LBW_REAL, offsetof(bw_minimise_options, tolerance)},
      {"value_tolerance", LBW_REAL, offsetof(bw_minimise_options, value_tolerance)},
      {"constraint_tolerance", LBW_REAL, offsetof(bw_minimise_options, constraint_tolerance)},
      {"good_enough", LBW_REAL, offsetof(bw_minimise_options, good_enough)},
      {"evaluations", LBW_COUNT, offsetof(bw_minimise_options, evaluations)},
      {"population", LBW_INT, offsetof(bw_minimise_options, population)},
      {"seed", LBW_SEED, offsetof(bw_minimise_options, seed)},
      {NULL, LBW_OTHER, 0}};
  enum { MAX_WORDS = 32 };
  const char *words[MAX_WORDS + 1] = {NULL};
  for (int i = 0; i < MAX_WORDS && bw_minimiser_word((bw_minimiser)i); i++)
    words[i] = bw_minimiser_word((bw_minimiser)i);
  lbw_check_type(L, 1, LUA_TTABLE);
  lua_settop(L, 1);
  luaL_checkstack(L, 40, "too many values");
  bw_minimise_options options;
  bw_minimise_options_default(&options);
  lbw_options(L, 1, "minimise", list, &options);
  options.method =
      (bw_minimiser)lbw_word_option(L, 1, "minimise", "method", words, (int)options.method);
  int64_t n = -1;
  double *min = numbers(L, "min", &n), *max = numbers(L, "max", &n);
  double *start = numbers(L, "start", &n);
  options.step = numbers(L, "step", &n);
  if (n < 1 || n > 100000)
    return lbw_error(L, "minimise: option 'start': a list of 1 to 100000 numbers expected, got %I",
                     (LUAI_UACINT)(n < 0 ? 0 : n));
  double *x = start ? start : start_of(L, n, min, max);
  lua_pushnil(L);
  request r = {.L = L, .error = lua_gettop(L), .n = (int)n};
  r.method = bw_minimiser_word(options.method);
  r.functions = r.error + 1;
  int constraints = push_functions(L);
  bw_minimise_result result = {0};
  bw_status status =
      bw_minimise(lbw_enter(L), (int)n, x, min, max, constraints, ask, &r, &options, &result);
  if (r.failed) {
    lbw_state_of(L)->running = 0;
    lua_settop(L, r.error);
    return lua_error(L);
  }
  if (status != BW_OK)
    return lbw_leave(L, status, 0);
  lbw_leave(L, status, 0);
  lua_createtable(L, (int)n, 0);
  for (int i = 0; i < n; i++) {
    lua_pushnumber(L, x[i]);
    lua_rawseti(L, -2, i + 1);
  }
  lua_pushnumber(L, result.value);
  push_report(L, &result);
  return 3;
}

void lbw_open_minimise(lua_State *L) {
  static const luaL_Reg functions[] = {{"minimise", core_minimise}, {NULL, NULL}};
  luaL_setfuncs(L, functions, 0);
}
