/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* Linear bodies in time. */
#include "bind.h"

#include <stdio.h>
#include <string.h>

static bw_linear_transient *self(lua_State *L) {
  return (bw_linear_transient *)lbw_check(L, 1, &lbw_linear_transient_class);
}

static const double *read_list(lua_State *L, int index, int32_t loads) {
  int64_t rows;
  const double *value = lbw_to_doubles(L, index, "factors", 1, &rows);
  lbw_require_rows(L, "factors", rows, loads, "load");
  return value;
}

/* Factors from a list of numbers, one for each load and each coupling, and rows of the factor of
 * each history of supports with its derivatives; then, or nil, lists of what a step does not see.
 */
static bw_transient_factors read_factors(lua_State *L, int first, const bw_model *model) {
  bool sees = lua_isnoneornil(L, first + 2);
  int32_t loads = model->load_count, all = loads + model->coupling_count;
  int64_t rows;
  const double *factor = read_list(L, first, all),
               *missed = sees ? NULL : read_list(L, first + 2, all);
  return (bw_transient_factors){
      .load = factor,
      .point = factor ? factor + loads : NULL,
      .support = lbw_to_doubles(L, first + 1, "factors", 3, &rows),
      .load_missed = missed,
      .point_missed = missed ? missed + loads : NULL,
      .support_missed = sees ? NULL : lbw_to_doubles(L, first + 3, "factors", 1, &rows)};
}

static const double *read_field(lua_State *L, int index, const char *what, const bw_mesh *mesh) {
  int64_t rows;
  if (lua_isnoneornil(L, index))
    return NULL;
  const double *field = lbw_to_doubles(L, index, what, 3, &rows);
  lbw_require_rows(L, what, rows, mesh->node_count, "node");
  return field;
}

/* linear_transient(model, {step, rho, error, damping, modes}, displacement, velocity, numbers of
 * histories of supports, of remote points, factors of loads, rows of histories) */
static int core_linear_transient(lua_State *L) {
  static const lbw_option list[] = {
      {"step", LBW_REAL, offsetof(bw_linear_transient_options, step)},
      {"rho", LBW_REAL, offsetof(bw_linear_transient_options, rho)},
      {"error", LBW_REAL, offsetof(bw_linear_transient_options, error)},
      {"damping", LBW_OTHER, 0},
      {"modes", LBW_OTHER, 0},
      {NULL, LBW_OTHER, 0}};
  lbw_box *own = lbw_check_box(L, 1, &lbw_model_class);
  const bw_model *model = (const bw_model *)own->object;
  bw_linear_transient_options options;
  bw_linear_transient_options_default(&options);
  lua_settop(L, 10);
  lbw_options(L, 2, "transient", list, &options);
  lbw_damping_option(L, 2, "transient", &options.damping, NULL, NULL);
  lua_pop(L, 1);
  if (lbw_option_get(L, 2, "modes") != LUA_TNIL)
    options.modes = (const bw_modes *)lbw_test(L, -1, &lbw_modes_class); /* the table keeps it */
  lua_settop(L, 10);
  options.displacement = read_field(L, 3, "transient: option 'initial': displacement", model->mesh);
  options.velocity = read_field(L, 4, "transient: option 'initial': velocity", model->mesh);
  int64_t rows;
  options.support_motion = lbw_to_indices(L, 5, "histories", 1, &rows);
  lbw_require_rows(L, "histories", rows, model->support_count, "support");
  options.point_motion = lbw_to_indices(L, 6, "histories", 1, &rows);
  lbw_require_rows(L, "histories", rows, model->coupling_count, "coupling");
  const bw_transient_factors now = read_factors(L, 7, model);
  lbw_box *box = lbw_box_new(L, &lbw_linear_transient_class);
  bw_linear_transient *transient = NULL;
  bw_status status = bw_linear_transient_create(lbw_enter(L), model, (bw_system *)own->extra,
                                                &options, &now, &transient);
  return lbw_leave_object(L, box, transient, status);
}

/* linear_transient_step(transient, factors of loads, rows of histories of supports, what the step
 * misses of loads or nil, of histories of supports): whether it stands */
static int core_linear_transient_step(lua_State *L) {
  lbw_box *box = lbw_check_box(L, 1, &lbw_linear_transient_class);
  bw_linear_transient *transient = (bw_linear_transient *)box->object;
  int64_t steps = transient->steps;
  int factors = transient->factors;
  lua_settop(L, 5);
  const bw_transient_factors next = read_factors(L, 2, transient->model);
  bw_status status = bw_linear_transient_step(lbw_enter(L), transient, &next);
  if (transient->factors > factors)
    lbw_box_account(L, box); /* it has grown */
  lua_pushboolean(L, transient->steps > steps);
  return lbw_leave(L, status, 1);
}

/* linear_transient_resolution(transient): steps per period, error of the period, or nothing */
static int core_linear_transient_resolution(lua_State *L) {
  const bw_linear_transient *transient = self(L);
  bw_motion_resolution r = bw_linear_transient_resolution(lbw_enter(L), transient);
  lua_pushnumber(L, r.steps);
  lua_pushnumber(L, r.error);
  return lbw_leave(L, BW_OK, r.steps > 0 ? 2 : 0);
}

/* transient:static(): the present displacement as a static solution */
static int transient_static(lua_State *L) {
  const bw_linear_transient *transient = self(L);
  lbw_box *box = lbw_box_new(L, &lbw_static_class);
  bw_static *result = NULL;
  bw_status status = bw_linear_transient_static(lbw_enter(L), transient, &result);
  return lbw_leave_object(L, box, result, status);
}

/* Copies: the next step writes elsewhere. */
#define FIELD(name)                                                                                \
  static int transient_##name(lua_State *L) {                                                      \
    const bw_linear_transient *t = self(L);                                                        \
    int64_t nodes = t->model->mesh->node_count;                                                    \
    memcpy(lbw_push_array(L, BW_F64, nodes, 3)->data, t->name,                                     \
           3 * (size_t)nodes * sizeof(double));                                                    \
    return 1;                                                                                      \
  }
FIELD(displacement)
FIELD(velocity)
FIELD(acceleration)
FIELD(reaction)
#undef FIELD

#define NUMBER(name, value)                                                                        \
  static int transient_##name(lua_State *L) {                                                      \
    const bw_linear_transient *t = self(L);                                                        \
    lua_pushnumber(L, value);                                                                      \
    return 1;                                                                                      \
  }
NUMBER(time, t->time)
NUMBER(error, t->error)
NUMBER(step_length, t->step)
NUMBER(initial_energy, t->initial)
NUMBER(kinetic_energy, t->kinetic)
NUMBER(strain_energy, t->strain)
NUMBER(work, t->work)
NUMBER(damping_energy, t->damped)
NUMBER(lost_energy, t->initial + t->work - t->kinetic - t->strain - t->damped)
#undef NUMBER

#define COUNT(name, value)                                                                         \
  static int transient_##name(lua_State *L) {                                                      \
    const bw_linear_transient *t = self(L);                                                        \
    lua_pushinteger(L, (lua_Integer)value);                                                        \
    return 1;                                                                                      \
  }
COUNT(steps, t->steps)
COUNT(rejected_steps, t->rejected)
COUNT(coarse_steps, t->coarse)
COUNT(factors, t->factors)
COUNT(load_count, t->model->load_count)
COUNT(coupling_count, t->model->coupling_count)
#undef COUNT

static int transient_mesh(lua_State *L) {
  lbw_push(L, &lbw_mesh_class, self(L)->model->mesh);
  return 1;
}

static int transient_report(lua_State *L) {
  lbw_push_report(L, &self(L)->report);
  return 1;
}

static int transient_tostring(lua_State *L) {
  const bw_linear_transient *t =
      (const bw_linear_transient *)lbw_check(L, 1, &lbw_linear_transient_class);
  char text[600];
  snprintf(
      text, sizeof text,
      "motion at %s after %lld steps of %s: kinetic energy %s, strain energy %s, work of loads "
      "and supports %s, taken by damping %s, by the scheme %s",
      lbw_quantity(t->time, "s").text, (long long)t->steps, lbw_quantity(t->step, "s").text,
      lbw_quantity(t->kinetic, "J").text, lbw_quantity(t->strain, "J").text,
      lbw_quantity(t->work, "J").text, lbw_quantity(t->damped, "J").text,
      lbw_quantity(t->initial + t->work - t->kinetic - t->strain - t->damped, "J").text);
  lua_pushstring(L, text);
  return 1;
}

static const luaL_Reg methods[] = {{"static", transient_static}, {NULL, NULL}};
static const luaL_Reg properties[] = {{"displacement", transient_displacement},
                                      {"velocity", transient_velocity},
                                      {"acceleration", transient_acceleration},
                                      {"reaction", transient_reaction},
                                      {"time", transient_time},
                                      {"step_length", transient_step_length},
                                      {"steps", transient_steps},
                                      {"rejected_steps", transient_rejected_steps},
                                      {"coarse_steps", transient_coarse_steps},
                                      {"factors", transient_factors},
                                      {"error", transient_error},
                                      {"load_count", transient_load_count},
                                      {"coupling_count", transient_coupling_count},
                                      {"initial_energy", transient_initial_energy},
                                      {"kinetic_energy", transient_kinetic_energy},
                                      {"strain_energy", transient_strain_energy},
                                      {"work", transient_work},
                                      {"damping_energy", transient_damping_energy},
                                      {"lost_energy", transient_lost_energy},
                                      {"mesh", transient_mesh},
                                      {"report", transient_report},
                                      {NULL, NULL}};
static const luaL_Reg meta[] = {{"__tostring", transient_tostring}, {NULL, NULL}};
const lbw_class lbw_linear_transient_class = {"linear_transient", methods, properties, meta, NULL};

void lbw_open_linear_transient(lua_State *L) {
  static const luaL_Reg functions[] = {
      {"linear_transient", core_linear_transient},
      {"linear_transient_step", core_linear_transient_step},
      {"linear_transient_resolution", core_linear_transient_resolution},
      {NULL, NULL}};
  lbw_class_register(L, &lbw_linear_transient_class);
  luaL_setfuncs(L, functions, 0);
}
