/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* Systems that follow edits: the equations of a body cut into subdomains, updated, and what
 * an update and a solve reused, as a table. The box's second reference is to the subdomains. */
#include "bind.h"

#include <stdio.h>
#include <string.h>

static bw_incremental_system *self(lua_State *L) {
  return (bw_incremental_system *)lbw_check(L, 1, &lbw_incremental_system_class);
}

static int32_t subdomain_count(lua_State *L) {
  const lbw_box *box = lbw_check_box(L, 1, &lbw_incremental_system_class);
  return ((const bw_subdomains *)box->extra)->stiffness.count;
}

/* ---- what was reused ------------------------------------------------------------------------- */

/* The subdomains of an incremental system are the stiffness subdomains of bw_subdomains. */
#define KEYS_OF_REUSE(BOOLEAN, INTEGER, NUMBER)                                                    \
  BOOLEAN(pattern, pattern)                                                                        \
  BOOLEAN(ordering, ordering)                                                                      \
  BOOLEAN(full, full)                                                                              \
  INTEGER(subdomains, subdomains)                                                                  \
  INTEGER(subdomains_reused, subdomains_reused)                                                    \
  INTEGER(subdomains_rotated, subdomains_rotated)                                                  \
  INTEGER(subdomains_changed, subdomains_changed)                                                  \
  NUMBER(factor_reused, factor_reused)                                                             \
  INTEGER(iterations, iterations)                                                                  \
  INTEGER(precision, precision)                                                                    \
  INTEGER(refinements, refinements)                                                                \
  NUMBER(predicted_refactor, predicted_refactor)                                                   \
  NUMBER(predicted_iterate, predicted_iterate)                                                     \
  NUMBER(predicted_pcg, predicted_pcg)                                                             \
  NUMBER(seconds_unknowns, seconds_unknowns)                                                       \
  NUMBER(seconds_stiffness, seconds_stiffness)                                                     \
  NUMBER(seconds_factor, seconds_factor)                                                           \
  NUMBER(seconds_solve, seconds_solve)                                                             \
  NUMBER(difference_stiffness, difference_stiffness)                                               \
  NUMBER(difference_solution, difference_solution)

/* Writes into the table on the top. */
static void store_reuse(lua_State *L, const bw_reuse *reuse) {
#define BOOLEAN(field, key) (lua_pushboolean(L, reuse->field), lua_setfield(L, -2, #key));
#define INTEGER(field, key) (lua_pushinteger(L, reuse->field), lua_setfield(L, -2, #key));
#define NUMBER(field, key) (lua_pushnumber(L, reuse->field), lua_setfield(L, -2, #key));
  KEYS_OF_REUSE(BOOLEAN, INTEGER, NUMBER)
#undef BOOLEAN
#undef INTEGER
#undef NUMBER
  if (reuse->solver) {
    lua_pushstring(L, reuse->solver);
    lua_setfield(L, -2, "solver");
    lua_pushstring(L, *reuse->preconditioner ? reuse->preconditioner : NULL);
    lua_setfield(L, -2, "preconditioner");
  }
}

/* Reads back what store_reuse wrote, so that a solve completes what an update began. */
static void load_reuse(lua_State *L, int index, bw_reuse *reuse) {
#define BOOLEAN(field, key) (lua_getfield(L, index, #key), reuse->field = lua_toboolean(L, -1));
#define INTEGER(field, key)                                                                        \
  (lua_getfield(L, index, #key), reuse->field = (int32_t)lua_tointeger(L, -1));
#define NUMBER(field, key) (lua_getfield(L, index, #key), reuse->field = lua_tonumber(L, -1));
  int top = lua_gettop(L);
  luaL_checkstack(L, 28, "too many values");
  KEYS_OF_REUSE(BOOLEAN, INTEGER, NUMBER)
#undef BOOLEAN
#undef INTEGER
#undef NUMBER
  lua_settop(L, top);
}

/* Makes the table at `index` (nil: a new one) the place of the answer; pushes it, and reads it. */
static void begin_reuse(lua_State *L, int index, bw_reuse *reuse) {
  memset(reuse, 0, sizeof *reuse);
  if (lua_istable(L, index)) {
    load_reuse(L, index, reuse);
    lua_pushvalue(L, index);
  } else {
    lua_createtable(L, 0, 20);
    luaL_setmetatable(L, "barwright.reuse");
  }
}

/* The end of a call that completes a reuse table, which lies on the top of the stack. */
static int leave_with_reuse(lua_State *L, bw_status status, const bw_reuse *reuse, lbw_box *own,
                            int results) {
  if (status != BW_OK)
    return lbw_leave(L, status, results);
  lbw_leave_or_raise(L, BW_OK);
  store_reuse(L, reuse);
  lbw_box_account(L, own);
  return results;
}

/* ---- making, following, solving -------------------------------------------------------------- */

/* rotate_material(model, subdomains, motion): model; its material turned as each subdomain lies by
 * rows as those of subdomains:motion */
static int core_rotate_material(lua_State *L) {
  bw_model *model = (bw_model *)lbw_check(L, 1, &lbw_model_class);
  const bw_subdomains *subdomains = (const bw_subdomains *)lbw_check(L, 2, &lbw_subdomains_class);
  lbw_argument_check(L, subdomains->mesh->element_count == model->mesh->element_count, 2,
                     "subdomains of the model's mesh expected");
  const bw_subdomain_motion *motion = lbw_read_motion(L, 3, subdomains->stiffness.count);
  double *turn =
      (double *)lua_newuserdatauv(L, (size_t)subdomains->stiffness.count * 9 * sizeof *turn, 0);
  for (int32_t p = 0; p < subdomains->stiffness.count; p++)
    for (int r = 0; r < 3; r++)
      for (int c = 0; c < 3; c++)
        turn[9 * (size_t)p + (size_t)(3 * r + c)] = motion[p].frame[3 * c + r];
  bw_status status = bw_model_rotate_material(lbw_enter(L), model, subdomains->stiffness.count,
                                              subdomains->stiffness.of_element, turn);
  lua_pushvalue(L, 1);
  return lbw_leave(L, status, 1);
}

/* set_material(model, material, region or nil): model; the elements of a region, or all, of another
 * material */
static int core_set_material(lua_State *L) {
  bw_model *model = (bw_model *)lbw_check(L, 1, &lbw_model_class);
  const bw_material *material = (const bw_material *)lbw_check(L, 2, &lbw_material_class);
  int32_t region = lua_isnoneornil(L, 3) ? -1 : lbw_check_region(L, 3, model->mesh);
  bw_status status = bw_model_set_material(lbw_enter(L), model, region, material);
  lua_pushvalue(L, 1);
  return lbw_leave(L, status, 1);
}

static const bw_subdomains *check_subdomains(lua_State *L, int index, const bw_mesh *mesh) {
  const bw_subdomains *subdomains =
      (const bw_subdomains *)lbw_check(L, index, &lbw_subdomains_class);
  lbw_argument_check(L,
                     subdomains->mesh->node_count == mesh->node_count &&
                         subdomains->mesh->element_count == mesh->element_count,
                     index, "subdomains of the model's mesh expected");
  return subdomains;
}

/* Whether an update can follow the material of the model that is the second argument. */
static int push_follows(lua_State *L, const bw_mesh *mesh,
                        const bw_subdomain_stiffness *stiffness) {
  const bw_model *model = (const bw_model *)lbw_check(L, 2, &lbw_model_class);
  lbw_argument_check(L, model->mesh->element_count == mesh->element_count, 2,
                     "a model of the same topology expected");
  lua_pushboolean(L, bw_subdomain_stiffness_follows(stiffness, model->material));
  return 1;
}

/* incremental_system(model, subdomains, rotate_material): the model at the shape that later motions
 * count from */
static int core_incremental_system(lua_State *L) {
  const bw_model *model = (const bw_model *)lbw_check(L, 1, &lbw_model_class);
  const bw_subdomains *subdomains = check_subdomains(L, 2, model->mesh);
  lbw_box *box = lbw_box_new(L, &lbw_incremental_system_class);
  bw_incremental_system *incremental = NULL;
  bool rotate_material = lua_toboolean(L, 3);
  bw_edits edits = {subdomains->skeleton->bone_count, subdomains->stiffness.bone_start,
                    subdomains->stiffness.bone};
  bw_status status = bw_incremental_system_create(
      lbw_enter(L), model, rotate_material, subdomains->stiffness.count,
      subdomains->stiffness.of_element, subdomains->stiffness.of_node, &edits, &incremental);
  if (incremental)
    box->extra = bw_retain(subdomains);
  return lbw_leave_object(L, box, incremental, status);
}

/* incremental:update(model, motion): reuse */
static int incremental_update(lua_State *L) {
  lbw_box *box = lbw_check_box(L, 1, &lbw_incremental_system_class);
  bw_incremental_system *incremental = self(L);
  const bw_model *model = (const bw_model *)lbw_check(L, 2, &lbw_model_class);
  lbw_argument_check(L, model->mesh->node_count == incremental->system->mesh->node_count, 2,
                     "a model of the same topology expected");
  bw_subdomain_motion *motion = lbw_read_motion(L, 3, subdomain_count(L));
  bw_reuse reuse;
  begin_reuse(L, 0, &reuse);
  bw_status status = bw_incremental_system_update(lbw_enter(L), incremental, model, motion, &reuse);
  return leave_with_reuse(L, status, &reuse, box, 1);
}

/* incremental:follows(model): whether the model's material can be followed by an update */
static int incremental_follows(lua_State *L) {
  const bw_incremental_system *incremental = self(L);
  return push_follows(L, incremental->system->mesh, incremental->stiffness);
}

void lbw_read_guess(lua_State *L, int index, const char *function, int64_t nodes,
                    bw_incremental_options *options) {
  enum { MAX_COUNT = 64 };
  int type = lbw_option_get(L, index, "guess"), list = lua_gettop(L);
  if (type == LUA_TNIL)
    return;
  lua_Integer count = type == LUA_TTABLE ? (lua_Integer)lua_rawlen(L, list) : MAX_COUNT + 1;
  if (count > MAX_COUNT)
    lbw_option_refused(L, function, "guess", "a list of at most 64 fields");
  luaL_checkstack(L, (int)count + 10, "too many values");
  const double **field =
      (const double **)lua_newuserdatauv(L, (size_t)(count + 1) * sizeof *field, 0);
  for (lua_Integer k = 0; k < count; k++) {
    int64_t rows;
    lua_rawgeti(L, list, k + 1);
    field[k] = lbw_to_doubles(L, -1, "guess", 3, &rows);
    lbw_require_rows(L, lua_pushfstring(L, "%s: guess: field %I", function, (LUAI_UACINT)k + 1),
                     rows, nodes, "node");
    lua_pop(L, 1);
    lua_remove(L, -2);
  }
  options->guess_count = (int)count;
  options->guess = field;
}

static void read_options(lua_State *L, int index, const char *function, int64_t nodes,
                         bw_incremental_options *incremental, bw_statics_options *statics) {
  struct opts {
    bw_incremental_options incremental;
    bw_statics_options statics;
  } opts;
  static const lbw_option list[] = {
      {"solver", LBW_OTHER, 0},
      {"tolerance", LBW_REAL, offsetof(struct opts, incremental.tolerance)},
      {"check", LBW_BOOLEAN, offsetof(struct opts, incremental.check)},
      {"guess", LBW_OTHER, 0},
      {"further", LBW_INT, offsetof(struct opts, incremental.further)},
      {"max_iteration_ratio", LBW_REAL, offsetof(struct opts, incremental.max_iteration_ratio)},
      {"energy", LBW_BOOLEAN, offsetof(struct opts, incremental.energy)},
      {"precision", LBW_INT, offsetof(struct opts, incremental.precision)},
      {"inertia_relief", LBW_BOOLEAN, offsetof(struct opts, statics.inertia_relief)},
      {"balance_tolerance", LBW_REAL, offsetof(struct opts, statics.tolerance)},
      {NULL, LBW_OTHER, 0}};
  bw_incremental_options_default(&opts.incremental);
  opts.statics = (bw_statics_options){.tolerance = 1e-6};
  lbw_options(L, index, function, list, &opts);
  opts.incremental.solver = lbw_solver_option(L, index, function);
  lbw_read_guess(L, index, function, nodes, &opts.incremental);
  *incremental = opts.incremental;
  *statics = opts.statics;
}

/* incremental:statics(model, options, reuse or nil): static, reuse */
static int incremental_statics(lua_State *L) {
  lbw_box *own = lbw_check_box(L, 1, &lbw_incremental_system_class);
  bw_incremental_system *incremental = self(L);
  const bw_model *model = (const bw_model *)lbw_check(L, 2, &lbw_model_class);
  bw_incremental_options options;
  bw_statics_options statics;
  lua_settop(L, 4);
  read_options(L, 3, "solve", incremental->system->mesh->node_count, &options, &statics);
  lbw_box *box = lbw_box_new(L, &lbw_static_class);
  bw_reuse reuse;
  begin_reuse(L, 4, &reuse);
  bw_static *result = NULL;
  bw_status status =
      bw_incremental_statics(lbw_enter(L), incremental, model, &statics, &options, &result, &reuse);
  lbw_box_fill(L, box, result);
  return leave_with_reuse(L, status, &reuse, own, 2);
}

/* incremental:solve(force, options, reuse or nil): displacement, reuse */
static int incremental_solve(lua_State *L) {
  lbw_box *own = lbw_check_box(L, 1, &lbw_incremental_system_class);
  bw_incremental_system *incremental = self(L);
  bw_incremental_options options;
  bw_statics_options statics;
  int64_t rows;
  lua_settop(L, 4);
  read_options(L, 3, "solve", incremental->system->mesh->node_count, &options, &statics);
  double *force = lbw_to_doubles(L, 2, "force", 3, &rows);
  lbw_check_rows(L, 2, "force", rows, incremental->system->mesh->node_count, "node");
  double *out = (double *)lbw_push_array(L, BW_F64, rows, 3)->data;
  bw_reuse reuse;
  begin_reuse(L, 4, &reuse);
  bw_status status =
      bw_incremental_system_solve(lbw_enter(L), incremental, &options, 1, force, out, &reuse);
  return leave_with_reuse(L, status, &reuse, own, 2);
}

/* incremental:refactor(reuse or nil): reuse */
static int incremental_refactor(lua_State *L) {
  lbw_box *own = lbw_check_box(L, 1, &lbw_incremental_system_class);
  bw_reuse reuse;
  lua_settop(L, 2);
  begin_reuse(L, 2, &reuse);
  bw_status status = bw_incremental_system_refactor(lbw_enter(L), self(L), &reuse);
  return leave_with_reuse(L, status, &reuse, own, 1);
}

/* incremental:view(): its equations as a system, the factor updated. Of no use after the next
 * update. */
static int incremental_view(lua_State *L) {
  lbw_box *own = lbw_check_box(L, 1, &lbw_incremental_system_class);
  bw_incremental_system *incremental = self(L);
  lbw_box *box = lbw_box_new(L, &lbw_system_class);
  bw_status status = bw_incremental_system_refactor(lbw_enter(L), incremental, NULL);
  lbw_box_fill(L, box, status == BW_OK ? bw_retain(incremental->system) : NULL);
  lbw_box_account(L, own);
  return lbw_leave(L, status, 1);
}

/* ---- views ----------------------------------------------------------------------------------- */

/* incremental:memory(): bytes of the factor, of the update matrices, of the subdomains'
 * coefficients, of the two-level preconditioner */
static int incremental_memory(lua_State *L) {
  const bw_incremental_system *incremental = self(L);
  size_t factor = 0, updates = 0;
  bw_incremental_system_memory(incremental, &factor, &updates);
  lua_pushinteger(L, (lua_Integer)factor);
  lua_pushinteger(L, (lua_Integer)updates);
  lua_pushinteger(L, incremental->stiffness
                         ? (lua_Integer)bw_subdomain_stiffness_bytes(incremental->stiffness)
                         : 0);
  lua_pushinteger(L, (lua_Integer)bw_incremental_system_two_level_bytes(incremental));
  return 4;
}

LBW_PUSH(incremental_unknown_count, lua_pushinteger(L, self(L)->system->dof_map->unknown_count))
LBW_PUSH(incremental_subdomain_count, lua_pushinteger(L, subdomain_count(L)))

static int incremental_tostring(lua_State *L) {
  const bw_incremental_system *incremental =
      (const bw_incremental_system *)lbw_check(L, 1, &lbw_incremental_system_class);
  size_t factor = 0, updates = 0;
  bw_incremental_system_memory(incremental, &factor, &updates);
  char text[200];
  snprintf(text, sizeof text,
           "incremental system of %d unknowns in %d subdomains, factor of %s, %s kept "
           "for updates",
           (int)incremental->system->dof_map->unknown_count,
           (int)incremental->stiffness->subdomain_count, lbw_quantity((double)factor, "B").text,
           lbw_quantity((double)updates, "B").text);
  lua_pushstring(L, text);
  return 1;
}

static const luaL_Reg methods[] = {
    {"update", incremental_update},   {"solve", incremental_solve},
    {"statics", incremental_statics}, {"refactor", incremental_refactor},
    {"follows", incremental_follows}, {"view", incremental_view},
    {"memory", incremental_memory},   {NULL, NULL}};
static const luaL_Reg properties[] = {{"unknown_count", incremental_unknown_count},
                                      {"subdomain_count", incremental_subdomain_count},
                                      {NULL, NULL}};
static const luaL_Reg meta[] = {{"__tostring", incremental_tostring}, {NULL, NULL}};
const lbw_class lbw_incremental_system_class = {"incremental_system", methods, properties, meta,
                                                NULL};

/* ---- joined models --------------------------------------------------------------------------- */

static bw_joined_incremental *joined_self(lua_State *L) {
  return (bw_joined_incremental *)lbw_check(L, 1, &lbw_joined_incremental_class);
}

/* joined_incremental_system(model, subdomains, rotate_material): as incremental_system, of a joined
 * model */
static int core_joined_incremental(lua_State *L) {
  const bw_model *model = (const bw_model *)lbw_check(L, 1, &lbw_model_class);
  const bw_subdomains *subdomains = check_subdomains(L, 2, model->mesh);
  lbw_box *box = lbw_box_new(L, &lbw_joined_incremental_class);
  bw_joined_incremental *joined = NULL;
  bool rotate_material = lua_toboolean(L, 3);
  bw_status status = bw_joined_incremental_create(
      lbw_enter(L), model, rotate_material, subdomains->stiffness.count,
      subdomains->stiffness.of_element, subdomains->stiffness.of_node, &joined);
  return lbw_leave_object(L, box, joined, status);
}

/* joined:update(model, motion): reuse */
static int joined_update(lua_State *L) {
  lbw_box *box = lbw_check_box(L, 1, &lbw_joined_incremental_class);
  bw_joined_incremental *joined = joined_self(L);
  const bw_model *model = (const bw_model *)lbw_check(L, 2, &lbw_model_class);
  bw_subdomain_motion *motion =
      lbw_read_motion(L, 3, bw_joined_incremental_stiffness(joined)->subdomain_count);
  bw_reuse reuse;
  begin_reuse(L, 0, &reuse);
  bw_status status = bw_joined_incremental_update(lbw_enter(L), joined, model, motion, &reuse);
  return leave_with_reuse(L, status, &reuse, box, 1);
}

/* joined:follows(model): whether the model's material can be followed by an update */
static int joined_follows(lua_State *L) {
  const bw_joined_incremental *joined = joined_self(L);
  return push_follows(L, bw_joined_incremental_mesh(joined),
                      bw_joined_incremental_stiffness(joined));
}

/* joined:statics(model, options, reuse or nil): static, reuse */
static int joined_statics(lua_State *L) {
  lbw_box *own = lbw_check_box(L, 1, &lbw_joined_incremental_class);
  bw_joined_incremental *joined = joined_self(L);
  const bw_model *model = (const bw_model *)lbw_check(L, 2, &lbw_model_class);
  bw_incremental_options options;
  bw_statics_options statics;
  lua_settop(L, 4);
  read_options(L, 3, "solve", model->mesh->node_count, &options, &statics);
  statics.solver = options.solver;
  lbw_box *box = lbw_box_new(L, &lbw_static_class);
  bw_reuse reuse;
  begin_reuse(L, 4, &reuse);
  bw_static *result = NULL;
  bw_status status = bw_joined_incremental_statics(lbw_enter(L), joined, model, &statics,
                                                   options.check, &result, &reuse);
  lbw_box_fill(L, box, result);
  return leave_with_reuse(L, status, &reuse, own, 2);
}

LBW_PUSH(joined_subdomain_count,
         lua_pushinteger(L, bw_joined_incremental_stiffness(joined_self(L))->subdomain_count))

static int joined_tostring(lua_State *L) {
  const bw_joined_incremental *joined = joined_self(L);
  lua_pushfstring(L, "incremental system of a joined model, %d nodes in %d subdomains",
                  (int)bw_joined_incremental_mesh(joined)->node_count,
                  (int)bw_joined_incremental_stiffness(joined)->subdomain_count);
  return 1;
}

static const luaL_Reg joined_methods[] = {{"update", joined_update},
                                          {"statics", joined_statics},
                                          {"follows", joined_follows},
                                          {NULL, NULL}};
static const luaL_Reg joined_properties[] = {{"subdomain_count", joined_subdomain_count},
                                             {NULL, NULL}};
static const luaL_Reg joined_meta[] = {{"__tostring", joined_tostring}, {NULL, NULL}};
const lbw_class lbw_joined_incremental_class = {"joined_incremental_system", joined_methods,
                                                joined_properties, joined_meta, NULL};

void lbw_open_incremental(lua_State *L) {
  lbw_class_register(L, &lbw_incremental_system_class);
  lbw_class_register(L, &lbw_joined_incremental_class);
  lua_getfield(L, -1, "tables");
  luaL_newmetatable(L, "barwright.reuse");
  lua_setfield(L, -2, "reuse");
  lua_pop(L, 1);
  lua_pushcfunction(L, core_rotate_material);
  lua_setfield(L, -2, "rotate_material");
  lua_pushcfunction(L, core_set_material);
  lua_setfield(L, -2, "set_material");
  lua_pushcfunction(L, core_incremental_system);
  lua_setfield(L, -2, "incremental_system");
  lua_pushcfunction(L, core_joined_incremental);
  lua_setfield(L, -2, "joined_incremental_system");
}
