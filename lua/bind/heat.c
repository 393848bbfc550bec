/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* bw.heat: conduction in a mesh, its conditions, steady states, and heat in time. */
#include "bind.h"

#include <stdio.h>
#include <string.h>

static bw_heat *self(lua_State *L) {
  return (bw_heat *)lbw_check(L, 1, &lbw_heat_class);
}

static int leave_self(lua_State *L, bw_status status) {
  lua_pushvalue(L, 1);
  return lbw_leave(L, status, 1);
}

/* heat{mesh, material or materials} */
static int heat_new(lua_State *L) {
  static const lbw_option list[] = {{"mesh", LBW_OTHER, 0},
                                    {"material", LBW_OTHER, 0},
                                    {"materials", LBW_OTHER, 0},
                                    {NULL, LBW_OTHER, 0}};
  lbw_check_type(L, 1, LUA_TTABLE);
  lua_settop(L, 1);
  lbw_options(L, 1, "heat", list, NULL);
  const bw_material *material;
  const bw_mesh *mesh = lbw_check_body(L, "heat", &material);
  lbw_box *box = lbw_box_new(L, &lbw_heat_class);
  bw_heat *heat = NULL;
  bw_status status = bw_heat_create(lbw_enter(L), mesh, material, &heat);
  if (status == BW_GEOMETRY)
    lbw_leave_or_raise(L, status);
  return lbw_leave_object(L, box, heat, status);
}

/* An array with a number for each node, or NULL. */
static const bw_array *nodal(lua_State *L, int index, const bw_heat *heat, const char *what) {
  const bw_array *array = (const bw_array *)lbw_test(L, index, &lbw_array_class);
  if (array && (array->rows != heat->mesh->node_count || array->columns != 1))
    lbw_error(L, "%s: an array of %d x 1 expected, a row for each node, got %s", what,
              (int)heat->mesh->node_count, lbw_got(L, index));
  return array;
}

/* heat:prescribe(selection, temperature): a number, or an array over nodes */
static int heat_prescribe(lua_State *L) {
  bw_heat *heat = self(L);
  bw_heat_condition condition = {.kind = BW_HEAT_TEMPERATURE, .value = 1};
  condition.on = (const bw_selection *)lbw_check(L, 2, &lbw_selection_class);
  condition.nodal = nodal(L, 3, heat, "prescribe: temperature");
  if (!condition.nodal)
    condition.value = lbw_check_real(L, 3, "temperature");
  return leave_self(L, bw_heat_add(lbw_enter(L), heat, &condition));
}

/* The numbers of a table that is the option `key`. */
static void read_film(lua_State *L, const char *key, const char *coefficient,
                      bw_heat_condition *condition) {
  char function[40];
  const lbw_option list[] = {{coefficient, LBW_REAL, offsetof(bw_heat_condition, coefficient)},
                             {"temperature", LBW_REAL, offsetof(bw_heat_condition, value)},
                             {"about", LBW_REAL, offsetof(bw_heat_condition, about)},
                             {NULL, LBW_OTHER, 0}};
  snprintf(function, sizeof function, "load: %s", key);
  int top = lua_gettop(L);
  if (lbw_option_get(L, 2, key) != LUA_TTABLE)
    lbw_option_refused(L, "load", key, "a table");
  lbw_options(L, top + 1, function, list, condition);
  if (lbw_option_get(L, top + 1, coefficient) == LUA_TNIL)
    lbw_option_missing(L, function, coefficient, "");
  if (lbw_option_get(L, top + 1, "temperature") == LUA_TNIL)
    lbw_option_missing(L, function, "temperature", "");
  lua_settop(L, top);
}

/* An option gap, which is 0 or left out for the default. */
static void check_gap(lua_State *L, int table, const char *function, double gap) {
  if (lbw_option_get(L, table, "gap") != LUA_TNIL && !(gap > 0))
    lbw_error(L, "%s: option 'gap': a number above 0 expected", function);
  lua_pop(L, 1);
}

/* The option contact = {with, conductance, gap}. */
static void read_contact(lua_State *L, bw_heat_condition *condition) {
  static const lbw_option list[] = {
      {"with", LBW_OTHER, 0},
      {"conductance", LBW_REAL, offsetof(bw_heat_condition, coefficient)},
      {"gap", LBW_REAL, offsetof(bw_heat_condition, gap)},
      {NULL, LBW_OTHER, 0}};
  int top = lua_gettop(L);
  if (lbw_option_get(L, 2, "contact") != LUA_TTABLE)
    lbw_option_refused(L, "load", "contact", "a table");
  lbw_options(L, top + 1, "load: contact", list, condition);
  if (lbw_option_get(L, top + 1, "conductance") == LUA_TNIL)
    lbw_option_missing(L, "load: contact", "conductance", "");
  check_gap(L, top + 1, "load: contact", condition->gap);
  condition->with = (const bw_selection *)lbw_object_option(
      L, top + 1, "load: contact", "with", &lbw_selection_class, "an open selection");
  if (!condition->with)
    lbw_option_missing(L, "load: contact", "with", "");
  lua_settop(L, top);
}

/* heat:load{on, heat_flux = | power = | source = | convection = {coefficient, temperature} |
 * radiation = {emissivity, temperature, about} | contact = {with, conductance, gap}} */
static int heat_load(lua_State *L) {
  static const char *const kinds[] = {NULL,         "heat_flux", "power",  "source",
                                      "convection", "radiation", "contact"};
  double value[4] = {0};
  static const lbw_option list[] = {{"on", LBW_OTHER, 0},         {"heat_flux", LBW_REAL, 8},
                                    {"power", LBW_REAL, 16},      {"source", LBW_OTHER, 0},
                                    {"convection", LBW_OTHER, 0}, {"radiation", LBW_OTHER, 0},
                                    {"contact", LBW_OTHER, 0},    {NULL, LBW_OTHER, 0}};
  bw_heat *heat = self(L);
  bw_heat_condition condition = {0};
  int given = 0;
  lbw_check_type(L, 2, LUA_TTABLE);
  lua_settop(L, 2);
  lbw_options(L, 2, "load", list, value);
  for (int k = BW_HEAT_FLUX; k <= BW_HEAT_CONTACT; k++) {
    if (lbw_option_get(L, 2, kinds[k]) != LUA_TNIL) {
      condition.kind = (bw_heat_kind)k;
      given++;
    }
    lua_settop(L, 2);
  }
  if (given != 1)
    return lbw_error(L, "load: one of the options 'heat_flux', 'power', 'source', 'convection', "
                        "'radiation' and 'contact' expected");
  condition.on = (const bw_selection *)lbw_object_option(L, 2, "load", "on", &lbw_selection_class,
                                                         "an open selection");
  if (condition.kind == BW_HEAT_CONVECTION)
    read_film(L, "convection", "coefficient", &condition);
  else if (condition.kind == BW_HEAT_RADIATION)
    read_film(L, "radiation", "emissivity", &condition);
  else if (condition.kind == BW_HEAT_CONTACT)
    read_contact(L, &condition);
  else if (condition.kind != BW_HEAT_SOURCE)
    condition.value = value[condition.kind];
  else if (lbw_option_get(L, 2, "source") == LUA_TNUMBER)
    condition.value = lua_tonumber(L, -1);
  else {
    condition.value = 1;
    condition.nodal = nodal(L, -1, heat, "load: option 'source'");
    if (!condition.nodal)
      return lbw_option_refused(L, "load", "source", "a number or an array over nodes");
  }
  return leave_self(L, bw_heat_add(lbw_enter(L), heat, &condition));
}

/* heat:bond{a, b, gap} */
static int heat_bond(lua_State *L) {
  static const lbw_option list[] = {{"a", LBW_OTHER, 0},
                                    {"b", LBW_OTHER, 0},
                                    {"gap", LBW_REAL, offsetof(bw_heat_condition, gap)},
                                    {NULL, LBW_OTHER, 0}};
  bw_heat *heat = self(L);
  bw_heat_condition condition = {.kind = BW_HEAT_BOND};
  lbw_check_type(L, 2, LUA_TTABLE);
  lua_settop(L, 2);
  lbw_options(L, 2, "bond", list, &condition);
  check_gap(L, 2, "bond", condition.gap);
  condition.on = (const bw_selection *)lbw_object_option(L, 2, "bond", "a", &lbw_selection_class,
                                                         "an open selection");
  condition.with = (const bw_selection *)lbw_object_option(L, 2, "bond", "b", &lbw_selection_class,
                                                           "an open selection");
  if (!condition.on || !condition.with)
    return lbw_option_missing(L, "bond", condition.on ? "b" : "a", "");
  return leave_self(L, bw_heat_add(lbw_enter(L), heat, &condition));
}

/* heat:set(condition, value) */
static int heat_set(lua_State *L) {
  bw_heat *heat = self(L);
  int64_t index = lbw_check_index(L, 2, "condition", heat->condition_count);
  double value = lbw_check_real(L, 3, "value");
  return leave_self(L, bw_heat_set_value(lbw_enter(L), heat, (int)index, value));
}

/* heat:solve{solver, tolerance, max_iterations} */
static int heat_solve(lua_State *L) {
  static const lbw_option list[] = {
      {"tolerance", LBW_REAL, offsetof(bw_heat_options, tolerance)},
      {"max_iterations", LBW_INT, offsetof(bw_heat_options, max_iterations)},
      {"error", LBW_BOOLEAN, offsetof(bw_heat_options, error)},
      {"solver", LBW_OTHER, 0},
      {NULL, LBW_OTHER, 0}};
  const bw_heat *heat = self(L);
  bw_heat_options options;
  bw_heat_options_default(&options);
  lua_settop(L, 2);
  lbw_options(L, 2, "solve", list, &options);
  options.solver = lbw_solver_option(L, 2, "solve");
  lbw_box *box = lbw_box_new(L, &lbw_heat_solution_class);
  bw_heat_solution *solution = NULL;
  bw_status status = bw_heat_steady(lbw_enter(L), heat, &options, &solution);
  return lbw_leave_object(L, box, solution, status);
}

/* heat:transient{initial, scheme, lumped, solver, tolerance, max_iterations} */
static int heat_transient(lua_State *L) {
  static const lbw_option list[] = {
      {"lumped", LBW_BOOLEAN, offsetof(bw_heat_transient_options, lumped)},
      {"tolerance", LBW_REAL, offsetof(bw_heat_transient_options, steps.tolerance)},
      {"max_iterations", LBW_INT, offsetof(bw_heat_transient_options, steps.max_iterations)},
      {"error", LBW_BOOLEAN, offsetof(bw_heat_transient_options, steps.error)},
      {"initial", LBW_OTHER, 0},
      {"scheme", LBW_OTHER, 0},
      {"solver", LBW_OTHER, 0},
      {NULL, LBW_OTHER, 0}};
  static const char *const schemes[] = {"backward_euler", "crank_nicolson", "bdf2", NULL};
  const bw_heat *heat = self(L);
  bw_heat_transient_options options;
  memset(&options, 0, sizeof options);
  bw_heat_options_default(&options.steps);
  lbw_check_type(L, 2, LUA_TTABLE);
  lua_settop(L, 2);
  lbw_options(L, 2, "transient", list, &options);
  options.scheme = (bw_heat_scheme)lbw_word_option(L, 2, "transient", "scheme", schemes, 0);
  options.steps.solver = lbw_solver_option(L, 2, "transient");
  int32_t n = heat->mesh->node_count;
  int type = lbw_option_get(L, 2, "initial");
  int at = lua_gettop(L);
  const bw_array *field = nodal(L, at, heat, "transient: option 'initial'");
  if (type == LUA_TNIL)
    return lbw_option_missing(L, "transient", "initial", "");
  if (!field && type != LUA_TNUMBER)
    return lbw_option_refused(L, "transient", "initial", "a number or an array over nodes");
  double number = field ? 0 : lua_tonumber(L, at);
  double *initial = (double *)lbw_push_array(L, BW_F64, n, 1)->data;
  for (int32_t i = 0; i < n; i++)
    initial[i] = field ? bw_array_get(field, i, 0) : number;
  lbw_box *box = lbw_box_new(L, &lbw_heat_transient_class);
  bw_heat_transient *transient = NULL;
  bw_status status = bw_heat_transient_create(lbw_enter(L), heat, initial, &options, &transient);
  return lbw_leave_object(L, box, transient, status);
}

LBW_PUSH(heat_mesh, lbw_push(L, &lbw_mesh_class, self(L)->mesh))
LBW_PUSH(heat_material, lbw_push(L, &lbw_material_class, self(L)->material))
LBW_PUSH(heat_conditions, lua_pushinteger(L, self(L)->condition_count))

static const char *const spoken[] = {"prescribed temperature",
                                     "heat flux",
                                     "power",
                                     "source",
                                     "convection",
                                     "radiation",
                                     "contact",
                                     "bond"};
static const char *const unit[] = {"K", "W/m2", "W", "W/m3", "K", "K", "W/(m2 K)"};

static int heat_tostring(lua_State *L) {
  const bw_heat *heat = self(L);
  luaL_Buffer buffer;
  char text[200];
  luaL_buffinit(L, &buffer);
  snprintf(text, sizeof text, "heat in %s, %d nodes, %d condition%s", heat->material->name,
           (int)heat->mesh->node_count, heat->condition_count,
           heat->condition_count == 1 ? "" : "s");
  luaL_addstring(&buffer, text);
  for (int i = 0; i < heat->condition_count; i++) {
    const bw_heat_condition *c = &heat->condition[i];
    lbw_text value =
        c->kind == BW_HEAT_BOND
            ? (lbw_text){""}
            : lbw_quantity(c->kind == BW_HEAT_CONTACT ? c->coefficient : c->value, unit[c->kind]);
    snprintf(text, sizeof text, "\n  %d: %s%s%s%s on %s", i + 1, spoken[c->kind],
             value.text[0] ? " " : "", value.text, c->nodal ? " times a field" : "",
             lbw_quantity(c->size, c->on ? "m2" : "m3").text);
    luaL_addstring(&buffer, text);
    if (c->with) {
      snprintf(text, sizeof text, " of %s", lbw_quantity(bw_selection_area(c->on), "m2").text);
      luaL_addstring(&buffer, text);
    }
    if (c->kind == BW_HEAT_CONVECTION || c->kind == BW_HEAT_RADIATION) {
      snprintf(text, sizeof text, ", %s %s",
               c->kind == BW_HEAT_CONVECTION ? "coefficient" : "emissivity",
               lbw_quantity(c->coefficient, c->kind == BW_HEAT_CONVECTION ? "W/(m2 K)" : "").text);
      luaL_addstring(&buffer, text);
    }
  }
  luaL_pushresult(&buffer);
  return 1;
}

static const luaL_Reg methods[] = {{"prescribe", heat_prescribe},
                                   {"load", heat_load},
                                   {"bond", heat_bond},
                                   {"set", heat_set},
                                   {"solve", heat_solve},
                                   {"transient", heat_transient},
                                   {NULL, NULL}};
static const luaL_Reg properties[] = {{"mesh", heat_mesh},
                                      {"material", heat_material},
                                      {"condition_count", heat_conditions},
                                      {NULL, NULL}};
static const luaL_Reg meta[] = {{"__tostring", heat_tostring}, {NULL, NULL}};
const lbw_class lbw_heat_class = {"heat", methods, properties, meta, NULL};

/* ---- solutions ------------------------------------------------------------------------------- */

static const bw_heat_solution *solution_self(lua_State *L) {
  return (const bw_heat_solution *)lbw_check(L, 1, &lbw_heat_solution_class);
}

LBW_PUSH(solution_mesh, lbw_push(L, &lbw_mesh_class, solution_self(L)->mesh))

static int solution_temperature(lua_State *L) {
  const bw_heat_solution *s = solution_self(L);
  return lbw_push_borrowed(L, BW_F64, s->mesh->node_count, 1, s->temperature, s);
}

static int solution_reaction(lua_State *L) {
  const bw_heat_solution *s = solution_self(L);
  return lbw_push_borrowed(L, BW_F64, s->mesh->node_count, 1, s->reaction, s);
}

static int solution_heat_in(lua_State *L) {
  const bw_heat_solution *s = solution_self(L);
  return lbw_push_borrowed(L, BW_F64, s->condition_count, 1, s->heat_in, s);
}

static int solution_flux(lua_State *L) {
  const bw_heat_solution *s = solution_self(L);
  double *out = (double *)lbw_push_array(L, BW_F64, s->mesh->node_count, 3)->data;
  return lbw_leave(L, bw_heat_flux(lbw_enter(L), s, out), 1);
}

static int solution_element_flux(lua_State *L) {
  const bw_heat_solution *s = solution_self(L);
  double *out = (double *)lbw_push_array(L, BW_F64, s->mesh->element_count, 3)->data;
  return lbw_leave(L, bw_heat_element_flux(lbw_enter(L), s, out), 1);
}

/* solution:error_estimate(): relative, in the norm of the flux */
static int solution_error(lua_State *L) {
  double relative = 0;
  bw_status status = bw_heat_error(lbw_enter(L), solution_self(L), NULL, &relative);
  lua_pushnumber(L, relative);
  return lbw_leave(L, status, 1);
}

LBW_PUSH(solution_highest, lua_pushnumber(L, solution_self(L)->highest))
LBW_PUSH(solution_highest_node, lua_pushinteger(L, solution_self(L)->highest_node + 1))

static int solution_highest_error(lua_State *L) {
  if (solution_self(L)->highest_error < 0)
    return 0;
  lua_pushnumber(L, solution_self(L)->highest_error);
  return 1;
}

LBW_PUSH(solution_time, lua_pushnumber(L, solution_self(L)->time))
LBW_PUSH(solution_stored, lua_pushnumber(L, solution_self(L)->stored))
LBW_PUSH(solution_imbalance, lua_pushnumber(L, solution_self(L)->imbalance))
LBW_PUSH(solution_iterations, lua_pushinteger(L, solution_self(L)->iterations))

static int solution_report(lua_State *L) {
  if (!lbw_has_report(&solution_self(L)->report))
    return 0;
  lbw_push_report(L, &solution_self(L)->report);
  return 1;
}

static int solution_tostring(lua_State *L) {
  const bw_heat_solution *s = solution_self(L);
  double low = s->highest;
  char text[400], error[100] = "at nodes, error not estimated";
  for (int32_t i = 0; i < s->mesh->node_count; i++)
    low = s->temperature[i] < low ? s->temperature[i] : low;
  if (s->highest_error >= 0)
    snprintf(error, sizeof error, "the highest with an estimated error of %s",
             lbw_quantity(s->highest_error, "K").text);
  snprintf(text, sizeof text,
           "temperatures from %.6g to %.6g K (%s); heat in %s, stored %s, balance %.1e W; %d "
           "iteration%s",
           low, s->highest, error, lbw_quantity(s->throughput, "W").text,
           lbw_quantity(s->stored, "W").text, s->imbalance, s->iterations,
           s->iterations == 1 ? "" : "s");
  lua_pushstring(L, text);
  return 1;
}

static const luaL_Reg solution_methods[] = {{"error_estimate", solution_error}, {NULL, NULL}};
static const luaL_Reg solution_properties[] = {{"mesh", solution_mesh},
                                               {"time", solution_time},
                                               {"temperature", solution_temperature},
                                               {"highest", solution_highest},
                                               {"highest_node", solution_highest_node},
                                               {"highest_error", solution_highest_error},
                                               {"flux", solution_flux},
                                               {"element_flux", solution_element_flux},
                                               {"reaction", solution_reaction},
                                               {"heat_in", solution_heat_in},
                                               {"stored", solution_stored},
                                               {"imbalance", solution_imbalance},
                                               {"iterations", solution_iterations},
                                               {"report", solution_report},
                                               {NULL, NULL}};
static const luaL_Reg solution_meta[] = {{"__tostring", solution_tostring}, {NULL, NULL}};
const lbw_class lbw_heat_solution_class = {"heat_solution", solution_methods, solution_properties,
                                           solution_meta, NULL};

/* ---- heat in time ---------------------------------------------------------------------------- */

static bw_heat_transient *transient_self(lua_State *L) {
  return (bw_heat_transient *)lbw_check(L, 1, &lbw_heat_transient_class);
}

/* transient:step(seconds, limit | nil): whether it was taken */
static int transient_step(lua_State *L) {
  bw_heat_transient *transient = transient_self(L);
  double step = lbw_check_real(L, 2, "seconds");
  double limit = lua_isnoneornil(L, 3) ? 0 : lbw_check_real(L, 3, "limit");
  bool taken = false;
  bw_status status = bw_heat_transient_step(lbw_enter(L), transient, step, limit, &taken);
  lua_pushboolean(L, taken);
  return lbw_leave(L, status, 1);
}

LBW_PUSH(transient_now, lbw_push(L, &lbw_heat_solution_class, transient_self(L)->now))
LBW_PUSH(transient_heat, lbw_push(L, &lbw_heat_class, transient_self(L)->heat))
LBW_PUSH(transient_steps, lua_pushinteger(L, (lua_Integer)transient_self(L)->steps))
LBW_PUSH(transient_time, lua_pushnumber(L, transient_self(L)->now->time))
LBW_PUSH(transient_error, lua_pushnumber(L, transient_self(L)->error))

static int transient_tostring(lua_State *L) {
  const bw_heat_transient *t = transient_self(L);
  char text[120];
  snprintf(text, sizeof text, "heat at %s after %lld steps", lbw_quantity(t->now->time, "s").text,
           (long long)t->steps);
  lua_pushstring(L, text);
  return 1;
}

static const luaL_Reg transient_methods[] = {{"step", transient_step}, {NULL, NULL}};
static const luaL_Reg transient_properties[] = {
    {"now", transient_now},     {"heat", transient_heat},   {"time", transient_time},
    {"steps", transient_steps}, {"error", transient_error}, {NULL, NULL}};
static const luaL_Reg transient_meta[] = {{"__tostring", transient_tostring}, {NULL, NULL}};
const lbw_class lbw_heat_transient_class = {"heat_transient", transient_methods,
                                            transient_properties, transient_meta, NULL};

void lbw_open_heat(lua_State *L) {
  static const luaL_Reg functions[] = {{"heat", heat_new}, {NULL, NULL}};
  lbw_class_register(L, &lbw_heat_class);
  lbw_class_register(L, &lbw_heat_solution_class);
  lbw_class_register(L, &lbw_heat_transient_class);
  luaL_setfuncs(L, functions, 0);
}
