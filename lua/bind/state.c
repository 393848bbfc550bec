/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* The one context of a Lua state: entering and leaving the engine, failures as nil, message,
 * details or as raised errors, progress and callbacks. */
#include "bind.h"

#include <math.h>
#include <stdio.h>
#include <unistd.h>

static const char state_key;    /* registry: the state's userdata */
static const char error_key;    /* registry: the error value of a callback that failed */
static const char progress_key; /* registry: the script's progress function */

static int state_gc(lua_State *L) {
  lbw_state *state = (lbw_state *)lua_touserdata(L, 1);
  bw_context_destroy(state->context);
  state->context = NULL;
  return 0;
}

lbw_state *lbw_state_of(lua_State *L) {
  if (lua_rawgetp(L, LUA_REGISTRYINDEX, &state_key) == LUA_TUSERDATA) {
    lbw_state *state = (lbw_state *)lua_touserdata(L, -1);
    lua_pop(L, 1);
    return state;
  }
  lua_pop(L, 1);
  lbw_state *state = (lbw_state *)lua_newuserdatauv(L, sizeof *state, 0);
  *state = (lbw_state){0};
  /* This is the first object that is marked for finalisation, so the context goes last. */
  lua_createtable(L, 0, 1);
  lua_pushcfunction(L, state_gc);
  lua_setfield(L, -2, "__gc");
  lua_setmetatable(L, -2);
  state->context = bw_context_create();
  if (!state->context)
    lbw_error(L, "not enough memory for a context");
  lua_pushboolean(L, false);
  lua_rawsetp(L, LUA_REGISTRYINDEX, &error_key);
  lua_rawsetp(L, LUA_REGISTRYINDEX, &state_key);
  return state;
}

bw_context *lbw_enter(lua_State *L) {
  lbw_state *state = lbw_state_of(L);
  if (!state->context)
    lbw_error(L, "the engine has been shut down");
  if (state->running)
    lbw_error(L, "the engine is busy: a function that it calls may not call it");
  luaL_checkstack(L, 12, "too many values");
  bw_clear_failure(state->context);
  state->caller = L;
  state->callback_failed = false;
  state->running = 1;
  return state->context;
}

static void echo_warnings(lbw_state *state) {
  for (int i = 0; bw_warning_at(state->context, i); i++)
    fprintf(stderr, "barwright: %s\n", bw_warning_at(state->context, i));
  bw_clear_warnings(state->context);
}

/* Raises the error of a callback, if there was one. What was asked of this call is not of the next.
 */
static void finish(lua_State *L, lbw_state *state) {
  state->running = 0;
  state->caller = NULL;
  if (state->asked && !state->stopping)
    bw_clear_cancel(state->context);
  state->asked = false;
  if (state->echo && bw_warning_at(state->context, 0))
    echo_warnings(state);
  if (state->callback_failed) {
    state->callback_failed = false;
    bw_clear_cancel(state->context);
    lua_rawgetp(L, LUA_REGISTRYINDEX, &error_key);
    lua_pushboolean(L, false); /* not nil: to keep an error must not need memory */
    lua_rawsetp(L, LUA_REGISTRYINDEX, &error_key);
    lua_error(L);
  }
}

static void push_details(lua_State *L, bw_context *context, bw_status status) {
  lua_createtable(L, 0, 4);
  lua_pushstring(L, bw_status_word(status));
  lua_setfield(L, -2, "status");
  const char *key, *text;
  double number;
  for (int i = 0; bw_detail(context, i, &key, &number, &text); i++) {
    if (text)
      lua_pushstring(L, text);
    else if (number == floor(number) && fabs(number) < 9e15)
      lua_pushinteger(L, (lua_Integer)number);
    else
      lua_pushnumber(L, number);
    lua_setfield(L, -2, key);
  }
}

static const char *message_of(bw_context *context, bw_status status) {
  const char *message = bw_message(context);
  return message[0] ? message : bw_status_word(status);
}

int lbw_leave(lua_State *L, bw_status status, int results) {
  lbw_state *state = lbw_state_of(L);
  finish(L, state);
  if (status == BW_OK)
    return results;
  state->last_failure = status;
  if (status == BW_INVALID || status == BW_EMPTY)
    return lbw_error(L, "%s", message_of(state->context, status));
  if (status == BW_CANCELLED)
    bw_clear_cancel(state->context);
  lua_pop(L, results);
  lua_pushnil(L);
  lua_pushstring(L, message_of(state->context, status));
  push_details(L, state->context, status);
  return 3;
}

void lbw_leave_or_raise(lua_State *L, bw_status status) {
  lbw_state *state = lbw_state_of(L);
  finish(L, state);
  if (status == BW_CANCELLED)
    bw_clear_cancel(state->context);
  state->last_failure = status;
  if (status != BW_OK)
    lbw_error(L, "%s", message_of(state->context, status));
}

/* ---- callbacks ------------------------------------------------------------------------------- */

void lbw_keep_error(lbw_state *state) {
  lua_rawsetp(state->caller, LUA_REGISTRYINDEX, &error_key);
  state->callback_failed = true;
  bw_cancel(state->context);
}

/* (function, x, y, z), protected: the number that it returns */
static int call_field(lua_State *L) {
  lua_call(L, 3, 1);
  if (lua_isboolean(L, -1)) /* as in formulas */
    lua_pushnumber(L, lua_toboolean(L, -1));
  else if (!lua_isnumber(L, -1))
    return lbw_error(L, "a function of x, y, z: a number expected as its result, got %s",
                     lbw_got(L, -1));
  return 1;
}

double lbw_call_field(lbw_state *state, int function, const double at[3], double otherwise) {
  lua_State *L = state->caller;
  if (state->callback_failed)
    return otherwise;
  lua_pushcfunction(L, call_field);
  lua_pushvalue(L, function);
  for (int i = 0; i < 3; i++)
    lua_pushnumber(L, at[i]);
  if (lua_pcall(L, 4, 1, 0) != LUA_OK) {
    lbw_keep_error(state);
    return otherwise;
  }
  double value = lua_tonumber(L, -1);
  lua_pop(L, 1);
  return value;
}

/* (function, stage as light userdata, fraction): protected, because the copy of the text may find
 * no memory. */
static int call_progress(lua_State *L) {
  lua_pushstring(L, (const char *)lua_touserdata(L, 2));
  lua_replace(L, 2);
  lua_call(L, 2, 1);
  return 1;
}

/* The engine's progress: to the script's function, else to the program's line. */
static void on_progress(void *data, const char *stage, double fraction) {
  lbw_state *state = (lbw_state *)data;
  lua_State *L = state->caller;
  if (!L || state->callback_failed)
    return;
  if (lua_rawgetp(L, LUA_REGISTRYINDEX, &progress_key) != LUA_TFUNCTION) {
    lua_pop(L, 1);
    if (state->progress)
      state->progress(state->progress_data, stage, fraction);
    return;
  }
  lua_pushcfunction(L, call_progress);
  lua_insert(L, -2);
  lua_pushlightuserdata(L, (void *)stage);
  lua_pushnumber(L, fraction);
  state->reporting = true;
  int failure = lua_pcall(L, 3, 1, 0);
  state->reporting = false;
  if (failure != LUA_OK) {
    lbw_keep_error(state);
    return;
  }
  /* Returning false asks the engine to stop. */
  if (lua_isboolean(L, -1) && !lua_toboolean(L, -1)) {
    state->asked = true;
    bw_cancel(state->context);
  }
  lua_pop(L, 1);
}

void lbw_forked(lua_State *L, bw_progress_function *progress, void *data) {
  lbw_state *state = lbw_state_of(L);
  state->running = 0;
  state->stopping = 0;
  state->caller = NULL;
  state->reporting = false;
  state->echo = false;
  state->progress = progress;
  state->progress_data = data;
  state->last_failure = BW_OK;
  lua_sethook(L, NULL, 0, 0);
  lua_pushnil(L);
  lua_rawsetp(L, LUA_REGISTRYINDEX, &progress_key);
  bw_set_progress(state->context, on_progress, state);
}

/* bw.progress(function | nil): the function in force before */
static int core_progress(lua_State *L) {
  lbw_state *state = lbw_state_of(L);
  if (!lua_isnoneornil(L, 1))
    lbw_check_type(L, 1, LUA_TFUNCTION);
  lua_settop(L, 1);
  lua_rawgetp(L, LUA_REGISTRYINDEX, &progress_key);
  lua_insert(L, 1);
  lua_rawsetp(L, LUA_REGISTRYINDEX, &progress_key);
  bw_set_progress(state->context, on_progress, state);
  return 1;
}

/* report_progress(stage, fraction): of work in Lua. True, or nil, message, details where the
 * progress function asks to stop: the caller ends its work then. Inside of a progress function: to
 * the program's line, so that a function can show what the engine tells in other words. */
static int core_report_progress(lua_State *L) {
  lbw_state *state = lbw_state_of(L);
  const char *stage = lbw_check_text(L, 1, NULL);
  double fraction = lbw_check_number(L, 2);
  if (state->reporting && state->progress)
    state->progress(state->progress_data, stage, fraction);
  lua_pushboolean(L, true);
  if (state->running || state->reporting)
    return 1;
  state->caller = L;
  state->callback_failed = false;
  on_progress(state, stage, fraction);
  return lbw_leave(L, state->asked ? bw_check_cancel(state->context) : BW_OK, 1);
}

static int core_threads(lua_State *L) {
  if (!lua_isnoneornil(L, 1)) {
    lua_Integer n = lbw_check_integer(L, 1);
    lbw_argument_check(L, n >= 1 && n <= 64, 1, "a number of threads from 1 to 64 expected");
    lbw_leave_or_raise(L, bw_set_threads(lbw_enter(L), (int)n));
  }
  lua_pushinteger(L, bw_threads(lbw_state_of(L)->context));
  return 1;
}

static int core_warnings(lua_State *L) {
  bw_context *context = lbw_state_of(L)->context;
  lua_newtable(L);
  for (int i = 0; bw_warning_at(context, i); i++) {
    lua_pushstring(L, bw_warning_at(context, i));
    lua_rawseti(L, -2, i + 1);
  }
  bw_clear_warnings(context);
  return 1;
}

/* warn(text): what a caller is to know of work that went well */
static int core_warn(lua_State *L) {
  const char *text = lbw_check_text(L, 1, NULL);
  bw_warn(lbw_enter(L), "%s", text);
  return lbw_leave(L, BW_OK, 0);
}

/* terminal(input): whether standard output is a terminal; with true, whether standard input is. */
LBW_PUSH(core_terminal,
         lua_pushboolean(L, isatty(lua_toboolean(L, 1) ? STDIN_FILENO : STDOUT_FILENO)))

LBW_PUSH(core_interrupted, lua_pushboolean(L, lbw_state_of(L)->stopping))
LBW_PUSH(core_seconds, lua_pushnumber(L, bw_seconds()))

static int core_sha256(lua_State *L) {
  const char *path = lbw_check_text(L, 1, NULL);
  char digest[65] = "";
  bw_status status = bw_sha256_file(lbw_enter(L), path, digest);
  lua_pushstring(L, digest);
  return lbw_leave(L, status, 1);
}

/* write_file(path, text): beside the target, then renamed */
static int core_write_file(lua_State *L) {
  const char *path = lbw_check_text(L, 1, NULL);
  size_t length;
  const char *text = lbw_check_text(L, 2, &length);
  bw_writer *writer = NULL;
  bw_status status;
  bw_context *context = lbw_enter(L);
  BW_TRY(bw_writer_open(context, path, &writer));
  BW_TRY(bw_writer_bytes(writer, text, length));
  status = bw_writer_commit(writer);
  writer = NULL;
done:
  bw_writer_discard(writer);
  lua_pushboolean(L, 1);
  return lbw_leave(L, status, 1);
}

static int core_external(lua_State *L) {
  lua_pushinteger(L, (lua_Integer)lbw_state_of(L)->external);
  lua_pushinteger(L, (lua_Integer)bw_live_blocks());
  return 2;
}

/* fail_allocation(n, repeat): for tests */
static int core_fail_allocation(lua_State *L) {
  bw_fail_allocation((int64_t)lbw_check_integer(L, 1), lua_toboolean(L, 2));
  return 0;
}

static int core_library_versions(lua_State *L) {
  char *text = NULL;
  bw_status status = bw_library_versions(lbw_enter(L), &text);
  /* A plain copy could raise before the text is released. */
  luaL_Buffer buffer;
  luaL_buffinit(L, &buffer);
  luaL_addstring(&buffer, text ? text : "");
  bw_free(text);
  luaL_pushresult(&buffer);
  return lbw_leave(L, status, 1);
}

static const luaL_Reg functions[] = {{"progress", core_progress},
                                     {"report_progress", core_report_progress},
                                     {"threads", core_threads},
                                     {"warn", core_warn},
                                     {"warnings", core_warnings},
                                     {"terminal", core_terminal},
                                     {"interrupted", core_interrupted},
                                     {"seconds", core_seconds},
                                     {"sha256", core_sha256},
                                     {"write_file", core_write_file},
                                     {"external", core_external},
                                     {"fail_allocation", core_fail_allocation},
                                     {"library_versions", core_library_versions},
                                     {NULL, NULL}};

#ifndef BARWRIGHT_COMMIT
#define BARWRIGHT_COMMIT ""
#endif

__attribute__((visibility("default"))) int luaopen_barwright_core(lua_State *L) {
  lbw_state *state = lbw_state_of(L);
  bw_set_progress(state->context, on_progress, state);
  lua_newtable(L);
  luaL_setfuncs(L, functions, 0);
  lua_pushstring(L, BW_VERSION);
  lua_setfield(L, -2, "version");
  lua_pushstring(L, BARWRIGHT_COMMIT);
  lua_setfield(L, -2, "commit");
  lua_newtable(L); /* metatables of tables that the engine's answers come in */
  luaL_newmetatable(L, "barwright.shape_log");
  lua_setfield(L, -2, "shape_log");
  luaL_newmetatable(L, "barwright.surface_report");
  lua_setfield(L, -2, "surface_report");
  lua_setfield(L, -2, "tables");
  lbw_open_classes(L);
  lbw_open_raise(L);
  lbw_open_quantity(L);
  lbw_open_suggestions(L);
  lbw_open_array(L);
  lbw_open_surface(L);
  lbw_open_thickness(L);
  lbw_open_confine(L);
  lbw_open_mesh(L);
  lbw_open_selection(L);
  lbw_open_material(L);
  lbw_open_report(L);
  lbw_open_solver(L);
  lbw_open_lp(L);
  lbw_open_eigensolver(L);
  lbw_open_model(L);
  lbw_open_solve(L);
  lbw_open_sparse_matrix(L);
  lbw_open_operator(L);
  lbw_open_worst(L);
  lbw_open_patch_gradient(L);
  lbw_open_picture(L);
  lbw_open_canvas(L);
  lbw_open_skeleton(L);
  lbw_open_subdomains(L);
  lbw_open_pose(L);
  lbw_open_repair(L);
  lbw_open_refine(L);
  lbw_open_buckling(L);
  lbw_open_nonlinear(L);
  lbw_open_deposition(L);
  lbw_open_harmonic(L);
  lbw_open_response_spectrum(L);
  lbw_open_contact(L);
  lbw_open_contact_system(L);
  lbw_open_drop(L);
  lbw_open_fatigue(L);
  lbw_open_singular(L);
  lbw_open_incremental(L);
  lbw_open_optimise(L);
  lbw_open_live(L);
  lbw_open_outline(L);
  lbw_open_follow(L);
  lbw_open_sheet(L);
  lbw_open_plane(L);
  lbw_open_mesh_motion(L);
  lbw_open_flow(L);
  lbw_open_heat(L);
  lbw_open_linear_transient(L);
  lbw_open_plate(L);
  lbw_open_grid(L);
  lbw_open_job(L);
  lbw_open_database(L);
  lbw_open_sobol(L);
  lbw_open_minimise(L);
  lbw_open_solid_material(L);
  lbw_open_solid(L);
  lbw_open_transient(L);
  lbw_open_library(L);
  lbw_open_files(L);
  /* The functions of classes are guarded already, but for close. */
  lua_getfield(L, -1, "classes");
  lua_pushnil(L);
  lua_setfield(L, -3, "classes");
  lbw_guard_functions(L, -2);
  lua_setfield(L, -2, "classes");
  return 1;
}
