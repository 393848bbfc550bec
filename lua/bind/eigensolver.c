/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* bw.eigensolver: eigensolvers as descriptions that other functions take. */
#include "bind.h"

#include <stdio.h>

static const bw_eigensolver *self(lua_State *L) {
  return (const bw_eigensolver *)lbw_check(L, 1, &lbw_eigensolver_class);
}

static int create(lua_State *L, const bw_eigensolver_options *options) {
  lbw_box *box = lbw_box_new(L, &lbw_eigensolver_class);
  bw_eigensolver *solver = NULL;
  bw_status status = bw_eigensolver_create(lbw_enter(L), options, &solver);
  return lbw_leave_object(L, box, solver, status);
}

/* Those on the factor of the system: {basis} */
static int on_factor(lua_State *L, const char *function, bw_eigensolver_kind kind) {
  static const lbw_option list[] = {{"basis", LBW_INT, offsetof(bw_eigensolver_options, basis)},
                                    {NULL, LBW_OTHER, 0}};
  bw_eigensolver_options options;
  bw_eigensolver_options_default(&options);
  options.kind = kind;
  lua_settop(L, 1);
  lbw_options(L, 1, function, list, &options);
  return create(L, &options);
}

static int eigensolver_lanczos(lua_State *L) {
  return on_factor(L, "eigensolver.lanczos", BW_EIGENSOLVER_LANCZOS);
}

static int eigensolver_arpack(lua_State *L) {
  return on_factor(L, "eigensolver.arpack", BW_EIGENSOLVER_ARPACK);
}

/* eigensolver.lobpcg{preconditioner} */
static int eigensolver_lobpcg(lua_State *L) {
  static const lbw_option list[] = {{"preconditioner", LBW_OTHER, 0}, {NULL, LBW_OTHER, 0}};
  bw_eigensolver_options options;
  bw_eigensolver_options_default(&options);
  options.kind = BW_EIGENSOLVER_LOBPCG;
  lua_settop(L, 1);
  lbw_options(L, 1, "eigensolver.lobpcg", list, &options);
  options.preconditioner = (const bw_solver *)lbw_object_option(
      L, 1, "eigensolver.lobpcg", "preconditioner", &lbw_solver_class,
      "bw.solver.two_level, bw.solver.amg or \"auto\"");
  return create(L, &options);
}

/* eigensolver.slepc{inner} */
static int eigensolver_slepc(lua_State *L) {
  static const lbw_option list[] = {{"inner", LBW_OTHER, 0}, {NULL, LBW_OTHER, 0}};
  bw_eigensolver_options options;
  bw_eigensolver_options_default(&options);
  options.kind = BW_EIGENSOLVER_SLEPC;
  lua_settop(L, 1);
  lbw_options(L, 1, "eigensolver.slepc", list, &options);
  options.inner = (const bw_solver *)lbw_object_option(L, 1, "eigensolver.slepc", "inner",
                                                       &lbw_solver_class, LBW_SOLVER_EXPECTED);
  return create(L, &options);
}

const bw_eigensolver *lbw_eigensolver_option(lua_State *L, int index, const char *function) {
  return (const bw_eigensolver *)lbw_object_option(
      L, index, function, "solver", &lbw_eigensolver_class,
      "an eigensolver (bw.eigensolver.lanczos {}) or \"auto\"");
}

static int solver_tostring(lua_State *L) {
  const bw_eigensolver *solver = self(L);
  const bw_eigensolver_options *options = &solver->options;
  char text[BW_SOLVER_TEXT + 60], inner[BW_SOLVER_TEXT];
  bw_solver_describe(options->inner, inner);
  if (options->inner)
    snprintf(text, sizeof text, "eigensolver slepc, inner systems by %s", inner);
  else if (options->preconditioner)
    snprintf(text, sizeof text, "eigensolver %s, preconditioner %s", bw_eigensolver_name(solver),
             bw_solver_word(options->preconditioner->options.kind));
  else if (options->basis > 0)
    snprintf(text, sizeof text, "eigensolver %s, %d basis vectors", bw_eigensolver_name(solver),
             options->basis);
  else
    snprintf(text, sizeof text, "eigensolver %s", bw_eigensolver_name(solver));
  lua_pushstring(L, text);
  return 1;
}

static int solver_name(lua_State *L) {
  lua_pushstring(L, bw_eigensolver_name(self(L)));
  return 1;
}

static const luaL_Reg no_methods[] = {{NULL, NULL}};
static const luaL_Reg properties[] = {{"name", solver_name}, {NULL, NULL}};
static const luaL_Reg meta[] = {{"__tostring", solver_tostring}, {NULL, NULL}};
const lbw_class lbw_eigensolver_class = {"eigensolver", no_methods, properties, meta, NULL};

void lbw_open_eigensolver(lua_State *L) {
  static const luaL_Reg functions[] = {{"lanczos", eigensolver_lanczos},
                                       {"arpack", eigensolver_arpack},
                                       {"lobpcg", eigensolver_lobpcg},
                                       {"slepc", eigensolver_slepc},
                                       {NULL, NULL}};
  lbw_class_register(L, &lbw_eigensolver_class);
  luaL_newlib(L, functions);
  lua_setfield(L, -2, "eigensolver");
}
