/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* core.job and core.wait: Lua functions in forked child processes.
 *
 * The child goes on inside of core.job, on the same Lua state: it calls the function, sends the
 * string that it returns, and leaves without finalisers. Objects of the script are there as they
 * were; what the function changes is seen by nobody else. */
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "bind.h"

/* ---- the child ------------------------------------------------------------------------------- */

typedef struct child {
  lua_State *L;
  int work; /* its place on the stack */
} child;

/* The traceback goes to the job's output; the message alone to the starter. */
static int note_traceback(lua_State *L) {
  const char *message = luaL_tolstring(L, 1, NULL);
  luaL_traceback(L, L, message, 1);
  fprintf(stderr, "%s\n", lua_tostring(L, -1));
  lua_settop(L, 2);
  return 1;
}

static bw_status status_of_word(const char *word) {
  for (int status = BW_INVALID; status <= BW_INTERNAL; status++)
    if (strcmp(word, bw_status_word((bw_status)status)) == 0)
      return (bw_status)status;
  return BW_OK;
}

/* Numbers and texts of the table at `index`; its status is the cause of the job's. */
static void copy_details(lua_State *L, int index, bw_context *context) {
  for (lua_pushnil(L); lua_next(L, index); lua_pop(L, 1)) {
    if (lua_type(L, -2) != LUA_TSTRING || strcmp(lua_tostring(L, -2), "cause") == 0)
      continue;
    const char *key = lua_tostring(L, -2);
    if (strcmp(key, "status") == 0)
      key = "cause";
    if (lua_type(L, -1) == LUA_TNUMBER)
      bw_detail_number(context, key, lua_tonumber(L, -1));
    else if (lua_type(L, -1) == LUA_TSTRING)
      bw_detail_text(context, key, lua_tostring(L, -1));
  }
}

/* What the function said of its failure, for the starter. What the engine said last and the script
 * passed on without details has a cause all the same. Memory that ran out is a status of its own;
 * the rest is not: the starter calls it failed. `details`: the place of a table, or of anything. */
static bw_status fail(lua_State *L, const char *message, int details) {
  lbw_state *state = lbw_state_of(L);
  bw_context *context = state->context;
  bw_status cause = BW_OK;
  const char *reported = bw_message(context);
  bool table = lua_istable(L, details);
  if (table) {
    if (lbw_option_get(L, details, "status") == LUA_TSTRING)
      cause = status_of_word(lua_tostring(L, -1));
    lua_pop(L, 1);
  } else if (message && reported[0] && strstr(message, reported))
    cause = state->last_failure;
  bw_status status = cause == BW_MEMORY ? BW_MEMORY : BW_INTERNAL;
  bw_fail(context, status, "%s", message ? message : "the job's function failed without a message");
  if (cause != BW_OK)
    bw_detail_text(context, "cause", bw_status_word(cause));
  if (table)
    copy_details(L, details, context);
  return status;
}

/* (function, stream), protected: the status */
static int run(lua_State *L) {
  bw_job_stream *out = (bw_job_stream *)lua_touserdata(L, 2);
  lbw_forked(L, bw_job_progress, out);
  lua_settop(L, 2);
  lua_pushvalue(L, 1);
  lua_call(L, 0, 3);
  bw_status status;
  size_t length;
  if (lua_type(L, 3) == LUA_TSTRING) {
    const char *bytes = lua_tolstring(L, 3, &length);
    status = bw_job_write(out, bytes, length);
  } else if (lua_isnil(L, 3) && !lua_isnil(L, 4))
    status = fail(L, luaL_tolstring(L, 4, NULL), 5);
  else {
    lua_pushfstring(L, "a job's function must return a string, or nil and a message, not %s",
                    lbw_type_name(L, 3));
    status = fail(L, lua_tostring(L, -1), 5);
  }
  lua_pushinteger(L, status);
  return 1;
}

static bw_status child_work(bw_context *context, void *data, bw_job_stream *out) {
  const child *c = (const child *)data;
  lua_State *L = c->L;
  lua_pushcfunction(L, note_traceback);
  int handler = lua_gettop(L);
  lua_pushcfunction(L, run);
  lua_pushvalue(L, c->work);
  lua_pushlightuserdata(L, out);
  lbw_state *state = lbw_state_of(L);
  lbw_guard guard;
  lbw_guard_begin(state, &guard, true);
  int failure = lua_pcall(L, 2, 1, handler);
  lbw_guard_end(state, &guard);
  state->running = 0;
  if (failure == LUA_OK)
    return (bw_status)lua_tointeger(L, -1);
  if (failure == LUA_ERRMEM)
    return bw_fail(context, BW_MEMORY, "Lua has not enough memory");
  return fail(L, lua_tostring(L, -1), lua_gettop(L));
}

/* ---- the starter ----------------------------------------------------------------------------- */

static const char *text_option(lua_State *L, const char *key) {
  int type = lbw_option_get(L, 2, key); /* the table keeps it alive */
  if (type != LUA_TSTRING && type != LUA_TNIL)
    lbw_option_refused(L, "job", key, "a string");
  const char *text = lua_tostring(L, -1);
  lua_pop(L, 1);
  return text;
}

/* job(function, {name, output, seconds, processor_seconds, bytes}) */
static int core_job(lua_State *L) {
  static const lbw_option list[] = {
      {"name", LBW_OTHER, 0},
      {"output", LBW_OTHER, 0},
      {"seconds", LBW_REAL, offsetof(bw_job_options, seconds)},
      {"processor_seconds", LBW_REAL, offsetof(bw_job_options, processor_seconds)},
      {"bytes", LBW_REAL, offsetof(bw_job_options, bytes)},
      {NULL, LBW_OTHER, 0}};
  lua_settop(L, 2);
  lbw_check_type(L, 1, LUA_TFUNCTION);
  bw_job_options options = {0};
  lbw_options(L, 2, "job", list, &options);
  options.name = text_option(L, "name");
  options.output = text_option(L, "output");
  if (options.seconds < 0 || options.processor_seconds < 0 || options.bytes < 0)
    return lbw_error(
        L, "job: limits of at least 0 expected, got %s: leave one out, or give 0, for none",
        lbw_quantity(fmin(options.seconds, fmin(options.processor_seconds, options.bytes)), "")
            .text);
  luaL_checkstack(L, 20, "too many values");
  lbw_box *box = lbw_box_new(L, &lbw_job_class);
  child c = {L, 1};
  bw_job *job = NULL;
  bw_context *context = lbw_enter(L);
  bw_status status = bw_may_start(context, "a job: its memory and time would not be the script's");
  if (status == BW_OK)
    status = bw_job_start(context, &options, child_work, &c, &job);
  return lbw_leave_object(L, box, job, status);
}

/* wait(jobs, seconds): the place of one that has ended, or nil */
static int core_wait(lua_State *L) {
  lua_settop(L, 2);
  lbw_check_type(L, 1, LUA_TTABLE);
  double seconds = lbw_number_or(L, 2, INFINITY);
  size_t count = lua_rawlen(L, 1);
  lbw_argument_check(L, count <= 100000, 1, "at most 100000 jobs expected");
  bw_job **jobs = (bw_job **)lua_newuserdatauv(L, (count + 1) * sizeof *jobs, 0);
  for (size_t i = 0; i < count; i++) {
    lua_rawgeti(L, 1, (lua_Integer)i + 1);
    jobs[i] = (bw_job *)lbw_test(L, -1, &lbw_job_class);
    if (!jobs[i])
      return lbw_error(L, "wait: a list of open jobs expected, got %s at %d", lbw_got(L, -1),
                       (int)i + 1);
    lua_pop(L, 1);
  }
  int which = -1;
  int failed = lbw_leave(L, bw_jobs_wait(lbw_enter(L), (int)count, jobs, seconds, &which), 0);
  if (failed)
    return failed;
  if (which < 0) {
    lua_pushnil(L);
    return 1;
  }
  lua_rawgeti(L, 1, which + 1);
  lbw_box_account(L, lbw_check_box(L, -1, &lbw_job_class)); /* its result has come */
  lua_pushinteger(L, which + 1);
  return 1;
}

/* ---- the class ------------------------------------------------------------------------------- */

static bw_job *self(lua_State *L) {
  return (bw_job *)lbw_check(L, 1, &lbw_job_class);
}

static bw_job_usage usage_of(lua_State *L) {
  bw_job_usage usage;
  bw_job_read_usage(self(L), &usage);
  return usage;
}

static const char *word_of(bw_job_state state) {
  static const char *const word[] = {"running", "done",  "failed",   "crashed",
                                     "limit",   "limit", "cancelled"};
  return word[state];
}

/* job:result() */
static int job_result(lua_State *L) {
  const bw_job *job = self(L);
  const unsigned char *bytes = NULL;
  size_t length = 0;
  bw_context *context = lbw_enter(L);
  bw_status status = bw_job_result(context, job, &bytes, &length);
  bw_job_usage usage;
  bw_job_read_usage(job, &usage);
  if (status == BW_OK) {
    lbw_leave(L, status, 0);
    lua_pushlstring(L, (const char *)bytes, length);
    return 1;
  }
  bw_detail_text(context, "status", word_of(usage.state));
  if (usage.state == BW_JOB_CRASHED && usage.signal == 0)
    bw_detail_number(context, "signal", 0);
  return lbw_leave(L, status, 0);
}

/* job:cancel() */
static int job_cancel(lua_State *L) {
  bw_job_cancel(self(L));
  return 0;
}

LBW_PUSH(job_name, lua_pushstring(L, bw_job_name(self(L))))
LBW_PUSH(job_state, lua_pushstring(L, word_of(usage_of(L).state)))
LBW_PUSH(job_seconds, lua_pushnumber(L, usage_of(L).seconds))

/* Of a job that has ended; nil before. */
static int push_when_ended(lua_State *L, double value) {
  if (usage_of(L).state == BW_JOB_RUNNING)
    lua_pushnil(L);
  else
    lua_pushnumber(L, value);
  return 1;
}

static int job_processor_seconds(lua_State *L) {
  return push_when_ended(L, usage_of(L).processor_seconds);
}

static int job_peak_bytes(lua_State *L) {
  return push_when_ended(L, usage_of(L).peak_bytes);
}

LBW_PUSH(job_stage, lua_pushstring(L, usage_of(L).stage))
LBW_PUSH(job_fraction, lua_pushnumber(L, usage_of(L).fraction))

static int job_tostring(lua_State *L) {
  bw_job_usage usage = usage_of(L);
  char text[240];
  if (usage.state == BW_JOB_RUNNING && usage.stage[0])
    snprintf(text, sizeof text, "job: %s, running for %s: %s, %d %%", bw_job_name(self(L)),
             lbw_quantity(usage.seconds, "s").text, usage.stage, (int)(100 * usage.fraction));
  else
    snprintf(text, sizeof text, "job: %s, %s%s %s", bw_job_name(self(L)), word_of(usage.state),
             usage.state == BW_JOB_RUNNING ? " for" : " after",
             lbw_quantity(usage.seconds, "s").text);
  lua_pushstring(L, text);
  return 1;
}

static const luaL_Reg methods[] = {{"result", job_result}, {"cancel", job_cancel}, {NULL, NULL}};
static const luaL_Reg properties[] = {{"name", job_name},
                                      {"state", job_state},
                                      {"seconds", job_seconds},
                                      {"processor_seconds", job_processor_seconds},
                                      {"peak_bytes", job_peak_bytes},
                                      {"stage", job_stage},
                                      {"fraction", job_fraction},
                                      {NULL, NULL}};
static const luaL_Reg meta[] = {{"__tostring", job_tostring}, {NULL, NULL}};
const lbw_class lbw_job_class = {"job", methods, properties, meta, NULL};

void lbw_open_job(lua_State *L) {
  static const luaL_Reg functions[] = {{"job", core_job}, {"wait", core_wait}, {NULL, NULL}};
  lbw_class_register(L, &lbw_job_class);
  luaL_setfuncs(L, functions, 0);
}
