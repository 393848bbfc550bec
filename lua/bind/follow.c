/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* Frames, and the options of meshes that follow an outline. */
#include "follow.h"

#include "condition.h"

#include <string.h>

static const char *const level_words[] = {"none", "relocation", "reconnecting", "reconstruction",
                                          NULL};

/* ---- reuse statistics ------------------------------------------------------------------------ */

#define REUSE_KEYS(BOOLEAN, INTEGER, NUMBER)                                                       \
  BOOLEAN(pattern)                                                                                 \
  BOOLEAN(factor)                                                                                  \
  BOOLEAN(solution)                                                                                \
  INTEGER(analyses)                                                                                \
  INTEGER(factorisations)                                                                          \
  INTEGER(solves)                                                                                  \
  INTEGER(iterations)                                                                              \
  NUMBER(residual)                                                                                 \
  NUMBER(seconds_mesh)                                                                             \
  NUMBER(seconds_assemble)                                                                         \
  NUMBER(seconds_factor)                                                                           \
  NUMBER(seconds_solve)

/* Writes into the table at `index`. */
static void store_reuse(lua_State *L, int index, const bw_plane_reuse *reuse) {
  index = lua_absindex(L, index);
#define BOOLEAN(key) (lua_pushboolean(L, reuse->key), lua_setfield(L, index, #key));
#define INTEGER(key) (lua_pushinteger(L, reuse->key), lua_setfield(L, index, #key));
#define NUMBER(key) (lua_pushnumber(L, reuse->key), lua_setfield(L, index, #key));
  REUSE_KEYS(BOOLEAN, INTEGER, NUMBER)
#undef BOOLEAN
#undef INTEGER
#undef NUMBER
  lua_pushstring(L, level_words[reuse->level]);
  lua_setfield(L, index, "level");
  if (lbw_has_report(&reuse->report)) {
    lbw_push_report(L, &reuse->report);
    lua_setfield(L, index, "report");
  }
}

/* The figures of a former call's report, which the next solution adds to. */
static void load_report(lua_State *L, int index, bw_solver_report *report) {
  double *const figure[] = {&report->predicted_cost, &report->rival_cost, &report->flops,
                            &report->bytes, &report->seconds};
  static const char *const key[] = {"predicted_cost", "rival_cost", "flops", "bytes", "seconds"};
  if (lua_getfield(L, index, "report") == LUA_TTABLE)
    for (size_t k = 0; k < sizeof key / sizeof *key; k++) {
      lua_getfield(L, -1, key[k]);
      *figure[k] = lua_tonumber(L, -1);
      lua_pop(L, 1);
    }
  lua_pop(L, 1);
}

/* Reads back what a former call of the same frame wrote; the table's level is a word. */
void lbw_load_plane_reuse(lua_State *L, int index, bw_plane_reuse *reuse) {
  memset(reuse, 0, sizeof *reuse);
#define BOOLEAN(key)                                                                               \
  (lua_getfield(L, index, #key), reuse->key = lua_toboolean(L, -1), lua_pop(L, 1));
#define INTEGER(key)                                                                               \
  (lua_getfield(L, index, #key), reuse->key = (int)lua_tointeger(L, -1), lua_pop(L, 1));
#define NUMBER(key) (lua_getfield(L, index, #key), reuse->key = lua_tonumber(L, -1), lua_pop(L, 1));
  REUSE_KEYS(BOOLEAN, INTEGER, NUMBER)
#undef BOOLEAN
#undef INTEGER
#undef NUMBER
  reuse->level = (bw_level)lbw_word_option(L, index, "reused", "level", level_words, 0);
  load_report(L, index, &reuse->report);
}

int lbw_leave_frame(lua_State *L, const lbw_class *class, bw_status status,
                    const bw_plane_reuse *reuse) {
  lua_pushvalue(L, 2);
  int results = lbw_leave(L, status, 1);
  if (status == BW_OK) {
    store_reuse(L, 2, reuse);
    lbw_box_account(L, lbw_check_box(L, 1, class));
  }
  return results;
}

/* ---- options --------------------------------------------------------------------------------- */

void lbw_check_one_size(lua_State *L, int index, const char *function, const char *size) {
  if (!lua_istable(L, index))
    return;
  int number = lbw_option_get(L, index, "elements"), length = lbw_option_get(L, index, size);
  lua_pop(L, 2);
  if (number != LUA_TNIL && length != LUA_TNIL)
    lbw_error(L,
              "%s: options 'elements' and '%s' both set the size of the elements: give one of them",
              function, size);
}

void lbw_read_fill(lua_State *L, int index, const char *function, bw_plane_options *fill) {
  static const lbw_option list[] = {
      {"order", LBW_INT, offsetof(bw_plane_options, order)},
      {"size", LBW_REAL, offsetof(bw_plane_options, size)},
      {"elements", LBW_INT, offsetof(bw_plane_options, elements)},
      {"minimum_angle", LBW_REAL, offsetof(bw_plane_options, minimum_angle)},
      {"curvature", LBW_REAL, offsetof(bw_plane_options, curvature)},
      {NULL, LBW_OTHER, 0}};
  bw_plane_options_default(fill);
  lbw_options(L, index, function, list, fill);
  lbw_check_one_size(L, index, function, "size");
}

void lbw_read_follow(lua_State *L, int index, const char *function, bw_follow_options *follow) {
  static const char *const ways[] = {"harmonic", "springs", NULL};
  static const lbw_option list[] = {{"distorted", LBW_REAL, offsetof(bw_follow_options, distorted)},
                                    {"rebuild", LBW_REAL, offsetof(bw_follow_options, rebuild)},
                                    {"rounds", LBW_INT, offsetof(bw_follow_options, rounds)},
                                    {"relocation", LBW_OTHER, 0},
                                    {"level", LBW_OTHER, 0},
                                    {NULL, LBW_OTHER, 0}};
  bw_follow_options_default(follow);
  lbw_options(L, index, function, list, follow);
  follow->relocation = (bw_relocation)lbw_word_option(L, index, function, "relocation", ways, 0);
  follow->force = (bw_level)lbw_word_option(L, index, function, "level", level_words, 0);
}

void lbw_read_lagged_factor(lua_State *L, int index, const char *function,
                            bw_lagged_factor_options *options) {
  static const lbw_option list[] = {
      {"solver", LBW_OTHER, 0},
      {"max_lag", LBW_INT, offsetof(bw_lagged_factor_options, max_lag)},
      {NULL, LBW_OTHER, 0}};
  lbw_options(L, index, function, list, options);
  options->solver = lbw_solver_option(L, index, function);
}

/* ---- making and following -------------------------------------------------------------------- */

int lbw_follow_create(lua_State *L, const lbw_class *class, const bw_outline *outline,
                      const bw_follow_options *follow, int conditions, lbw_create_function *create,
                      const void *description) {
  bw_status status = BW_OK;
  bw_plane_mesh *mesh = NULL;
  bw_mesh_motion *motion = NULL;
  void *body = NULL;
  lbw_box *box = lbw_box_new(L, class);
  int made = lua_gettop(L);
  if (conditions != 0) {
    lbw_conditions_keep(L, made, conditions);
    lbw_conditions_begin(L, made);
  }
  bw_context *context = lbw_enter(L);
  BW_TRY(bw_plane_fill(context, outline, &follow->fill, &mesh));
  BW_TRY(bw_mesh_motion_create(context, mesh, follow, &motion));
  BW_TRY(create(context, mesh, description, &body));
done:
  bw_release(mesh);
  if (status == BW_OK)
    box->extra = motion;
  else
    bw_release(motion);
  lbw_box_fill(L, box, body);
  lua_pushvalue(L, made);
  return lbw_leave(L, status, 1);
}

int lbw_follow(lua_State *L, const lbw_followed *followed) {
  bw_status status = BW_OK;
  lbw_box *box = lbw_check_box(L, 1, followed->class);
  bw_mesh_motion *motion = (bw_mesh_motion *)box->extra;
  lbw_check_type(L, 2, LUA_TTABLE);
  const bw_outline *outline = (const bw_outline *)lbw_check(L, 3, &lbw_outline_class);
  bw_follow_report report = {0};
  bw_plane_reuse reuse;
  lbw_load_plane_reuse(L, 2, &reuse);
  lua_settop(L, 3);
  lbw_conditions_begin(L, 1); /* the mesh's size may be a function */
  bw_context *context = lbw_enter(L);
  const bw_mesh_motion_state *before = bw_mesh_motion_keep(motion);
  BW_TRY(bw_mesh_motion_follow(context, motion, outline, &report));
  reuse.level = report.level;
  reuse.seconds_mesh += report.seconds;
  if ((status = followed->follow(context, (void *)box->object, motion->mesh, &reuse)) != BW_OK)
    (void)bw_mesh_motion_return(context, motion, before); /* its own state: it cannot fail */
done:
  bw_release(before);
  if (lbw_leave_frame(L, followed->class, status, &reuse) != 1)
    return 3;
  lua_pushinteger(L, report.flips);
  lua_setfield(L, 2, "flips");
  lua_pushnumber(L, report.worst);
  lua_setfield(L, 2, "quality");
  lua_settop(L, 2);
  return 1;
}

/* ---- states ---------------------------------------------------------------------------------- */

/* A box of a state holds the body's and, as its second reference, the mesh motion's; its user value
 * is the class of the bodies that may return to it. */
static const luaL_Reg none[] = {{NULL, NULL}};
static const lbw_class state_class = {"state", none, none, none, NULL};

int lbw_followed_keep(lua_State *L, const lbw_followed *followed) {
  const lbw_box *body = lbw_check_box(L, 1, followed->class);
  lbw_box *box = lbw_box_new(L, &state_class);
  lua_pushlightuserdata(L, (void *)followed->class);
  lua_setiuservalue(L, -2, 1);
  box->extra = bw_mesh_motion_keep((const bw_mesh_motion *)body->extra);
  lbw_box_fill(L, box, followed->keep(body->object));
  return 1;
}

int lbw_followed_return(lua_State *L, const lbw_followed *followed) {
  bw_status status = BW_OK;
  lbw_box *body = lbw_check_box(L, 1, followed->class);
  const lbw_box *state = lbw_check_box(L, 2, &state_class);
  bw_mesh_motion *motion = (bw_mesh_motion *)body->extra;
  lua_settop(L, 2);
  lua_getiuservalue(L, 2, 1);
  if (lua_touserdata(L, -1) != (void *)followed->class)
    lbw_error(L, "restore: the state of a %s expected, got that of another analysis",
              followed->class->name);
  lua_settop(L, 1);
  bw_context *context = lbw_enter(L);
  const bw_mesh_motion_state *before = bw_mesh_motion_keep(motion);
  BW_TRY(bw_mesh_motion_return(context, motion, (const bw_mesh_motion_state *)state->extra));
  if ((status = followed->restore(context, (void *)body->object, state->object)) != BW_OK)
    (void)bw_mesh_motion_return(context, motion, before);
done:
  bw_release(before);
  return lbw_leave(L, status, 1);
}

int lbw_followed_check(lua_State *L, const lbw_followed *followed) {
  bw_status status = BW_OK;
  const lbw_box *box = lbw_check_box(L, 1, followed->class);
  const bw_mesh_motion *motion = (const bw_mesh_motion *)box->extra;
  bw_context *context = lbw_enter(L);
  BW_TRY(bw_mesh_motion_check(context, motion));
  BW_TRY(followed->check(context, box->object));
  if (followed->mesh(box->object) != motion->mesh)
    status = bw_fail(context, BW_INTERNAL, "an analysis is on another mesh than its mesh motion");
done:
  lbw_leave_or_raise(L, status);
  lua_settop(L, 1);
  return 1;
}

void lbw_open_follow(lua_State *L) {
  lbw_class_register(L, &state_class);
}
