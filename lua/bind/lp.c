/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* bw.lp: solvers of linear programs, as descriptions that other functions take. */
#include "bind.h"

#include <string.h>

static const bw_lp_solver *self(lua_State *L) {
  return (const bw_lp_solver *)lbw_check(L, 1, &lbw_lp_solver_class);
}

typedef bw_status make(bw_context *context, const bw_lp_options *options, bw_lp_solver **solver);

static int create(lua_State *L, const char *function, make *of) {
  static const lbw_option list[] = {
      {"max_iterations", LBW_INT, offsetof(bw_lp_options, max_iterations)}, {NULL, LBW_OTHER, 0}};
  bw_lp_options options;
  memset(&options, 0, sizeof options);
  lua_settop(L, 1);
  lbw_options(L, 1, function, list, &options);
  lbw_box *box = lbw_box_new(L, &lbw_lp_solver_class);
  bw_lp_solver *solver = NULL;
  bw_status status = of(lbw_enter(L), &options, &solver);
  return lbw_leave_object(L, box, solver, status);
}

/* lp.dual_simplex{max_iterations} */
static int lp_dual_simplex(lua_State *L) {
  return create(L, "lp.dual_simplex", bw_lp_dual_simplex);
}

/* lp.glpk{max_iterations} */
static int lp_glpk(lua_State *L) {
  return create(L, "lp.glpk", bw_lp_glpk);
}

const bw_lp_solver *lbw_lp_option(lua_State *L, int index, const char *function) {
  return (const bw_lp_solver *)lbw_object_option(
      L, index, function, "lp", &lbw_lp_solver_class,
      "bw.lp.dual_simplex {}, bw.lp.glpk {} or \"auto\"");
}

static int solver_tostring(lua_State *L) {
  const bw_lp_solver *solver = self(L);
  if (solver->max_iterations > 0)
    lua_pushfstring(L, "linear programs by %s, %d iteration%s at most", solver->name,
                    solver->max_iterations, solver->max_iterations == 1 ? "" : "s");
  else
    lua_pushfstring(L, "linear programs by %s", solver->name);
  return 1;
}

LBW_PUSH(solver_name, lua_pushstring(L, self(L)->name))
LBW_PUSH(solver_max_iterations, lua_pushinteger(L, self(L)->max_iterations))

static const luaL_Reg no_methods[] = {{NULL, NULL}};
static const luaL_Reg properties[] = {
    {"name", solver_name}, {"max_iterations", solver_max_iterations}, {NULL, NULL}};
static const luaL_Reg meta[] = {{"__tostring", solver_tostring}, {NULL, NULL}};
const lbw_class lbw_lp_solver_class = {"linear_program_solver", no_methods, properties, meta, NULL};

void lbw_open_lp(lua_State *L) {
  static const luaL_Reg functions[] = {
      {"dual_simplex", lp_dual_simplex}, {"glpk", lp_glpk}, {NULL, NULL}};
  lbw_class_register(L, &lbw_lp_solver_class);
  luaL_newlib(L, functions);
  lua_setfield(L, -2, "lp");
}
