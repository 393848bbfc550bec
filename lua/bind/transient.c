/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* Solids in motion. */
#include "solid.h"

#include <stdio.h>
#include <string.h>

static bw_solid_transient *self(lua_State *L) {
  return (bw_solid_transient *)lbw_check(L, 1, &lbw_solid_transient_class);
}

/* solid:transient(case, options, displacement | nil, velocity | nil) */
static int transient_create(lua_State *L) {
  static const lbw_option list[] = {
      {"step", LBW_REAL, offsetof(bw_transient_options, step)},
      {"mass_damping", LBW_REAL, offsetof(bw_transient_options, mass_damping)},
      {"stiffness_damping", LBW_REAL, offsetof(bw_transient_options, stiffness_damping)},
      {"beta", LBW_REAL, offsetof(bw_transient_options, beta)},
      {"gamma", LBW_REAL, offsetof(bw_transient_options, gamma)},
      {"tolerance", LBW_REAL, offsetof(bw_transient_options, tolerance)},
      {"iterations", LBW_INT, offsetof(bw_transient_options, iterations)},
      {"allow_inverted", LBW_BOOLEAN, offsetof(bw_transient_options, allow_inverted)},
      {"scheme", LBW_OTHER, 0},
      {"solver", LBW_OTHER, 0},
      {NULL, LBW_OTHER, 0}};
  static const char *const schemes[] = {"implicit_euler", "newmark", NULL};
  lua_settop(L, 5);
  const bw_solid *solid = (const bw_solid *)lbw_check(L, 1, &lbw_solid_class);
  const bw_load_case *load_case = (const bw_load_case *)lbw_check(L, 2, &lbw_load_case_class);
  bw_transient_options options;
  bw_transient_options_default(&options);
  lbw_options(L, 3, "transient", list, &options);
  options.scheme = (bw_transient_scheme)lbw_word_option(L, 3, "transient", "scheme", schemes, 0);
  options.solver = lbw_solver_option(L, 3, "transient");
  const double *u = lbw_read_displacement(L, 4, "displacement", solid->grid);
  const double *v = lbw_read_displacement(L, 5, "velocity", solid->grid);
  lbw_box *box = lbw_box_new(L, &lbw_solid_transient_class);
  bw_solid_transient *motion = NULL;
  bw_status status =
      bw_solid_transient_create(lbw_enter(L), solid, load_case, &options, u, v, &motion);
  return lbw_leave_object(L, box, motion, status);
}

/* motion:step(count | nil): the motion itself */
static int motion_step(lua_State *L) {
  lbw_box *box = lbw_check_box(L, 1, &lbw_solid_transient_class);
  bw_solid_transient *motion = self(L);
  lua_Integer count = lbw_integer_or(L, 2, 1);
  lbw_argument_check(L, count >= 0, 2, "a number of steps of at least 0 expected");
  lua_settop(L, 1);
  bw_status status = bw_solid_transient_advance(lbw_enter(L), motion, count);
  int results = lbw_leave(L, status, 1);
  lbw_box_account(L, box); /* factors and matrices come with the first step */
  return results;
}

/* motion:check(): itself, where its parts belong together; raises otherwise */
static int motion_check(lua_State *L) {
  bw_solid_transient *motion = self(L);
  lbw_leave_or_raise(L, bw_solid_transient_check(lbw_enter(L), motion));
  lua_settop(L, 1);
  return 1;
}

/* Fields change in place: each is a copy of its moment. */
static int push_field(lua_State *L, const bw_solid_transient *motion, const double *field) {
  int64_t nodes = motion->solid->grid->node_count;
  bw_array *array = lbw_push_array(L, BW_F64, nodes, 3);
  memcpy(array->data, field, 3 * (size_t)nodes * sizeof *field);
  return 1;
}

static int motion_displacement(lua_State *L) {
  return push_field(L, self(L), self(L)->displacement);
}
static int motion_velocity(lua_State *L) {
  return push_field(L, self(L), self(L)->velocity);
}
static int motion_acceleration(lua_State *L) {
  return push_field(L, self(L), self(L)->acceleration);
}

LBW_PUSH(motion_time, lua_pushnumber(L, self(L)->time))
LBW_PUSH(motion_kinetic, lua_pushnumber(L, self(L)->kinetic))
LBW_PUSH(motion_strain, lua_pushnumber(L, self(L)->strain))
LBW_PUSH(motion_potential, lua_pushnumber(L, self(L)->potential))
LBW_PUSH(motion_dissipated, lua_pushnumber(L, self(L)->dissipated))
LBW_PUSH(motion_steps, lua_pushinteger(L, self(L)->steps))
LBW_PUSH(motion_newton, lbw_push_newton_report(L, &self(L)->newton))

/* Of the last step; nil before the first. */
static int motion_report(lua_State *L) {
  if (!lbw_has_report(&self(L)->report))
    return 0;
  lbw_push_report(L, &self(L)->report);
  return 1;
}

static int motion_tostring(lua_State *L) {
  const bw_solid_transient *m = self(L);
  char text[260];
  snprintf(text, sizeof text, "motion at %s after %lld steps: kinetic energy %s, strain energy %s",
           lbw_quantity(m->time, "s").text, (long long)m->steps, lbw_quantity(m->kinetic, "J").text,
           lbw_quantity(m->strain, "J").text);
  lua_pushstring(L, text);
  if (!lbw_has_report(&m->report))
    return 1;
  lua_pushstring(L, "; ");
  lbw_push_report(L, &m->report);
  luaL_tolstring(L, -1, NULL);
  lua_remove(L, -2);
  lua_concat(L, 3);
  return 1;
}

static const luaL_Reg methods[] = {{"step", motion_step}, {"check", motion_check}, {NULL, NULL}};
static const luaL_Reg properties[] = {{"time", motion_time},
                                      {"steps", motion_steps},
                                      {"displacement", motion_displacement},
                                      {"velocity", motion_velocity},
                                      {"acceleration", motion_acceleration},
                                      {"kinetic", motion_kinetic},
                                      {"strain", motion_strain},
                                      {"potential", motion_potential},
                                      {"dissipated", motion_dissipated},
                                      {"newton", motion_newton},
                                      {"report", motion_report},
                                      {NULL, NULL}};
static const luaL_Reg meta[] = {{"__tostring", motion_tostring}, {NULL, NULL}};
const lbw_class lbw_solid_transient_class = {"solid_transient", methods, properties, meta, NULL};

void lbw_open_transient(lua_State *L) {
  static const luaL_Reg of_solids[] = {{"transient", transient_create}, {NULL, NULL}};
  lbw_class_register(L, &lbw_solid_transient_class);
  lbw_add_methods(L, &lbw_solid_class, of_solids);
}
