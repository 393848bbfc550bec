/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* bw.solver: linear solvers and preconditioners as objects, and the option "solver" of whatever
 * solves. */
#include "bind.h"

static const bw_solver *self(lua_State *L) {
  return (const bw_solver *)lbw_check(L, 1, &lbw_solver_class);
}

static const char *const backends[] = {"auto", "multifrontal", "cholmod", "petsc", NULL};
static const char *const orderings[] = {"auto", "metis", "amd", "backend", NULL};

static int create(lua_State *L, const bw_solver_options *options) {
  lbw_box *box = lbw_box_new(L, &lbw_solver_class);
  bw_solver *solver = NULL;
  bw_status status = bw_solver_create(lbw_enter(L), options, &solver);
  return lbw_leave_object(L, box, solver, status);
}

/* solver.cholesky{backend, ordering, precision, full} */
static int solver_cholesky(lua_State *L) {
  static const lbw_option list[] = {{"backend", LBW_OTHER, 0},
                                    {"ordering", LBW_OTHER, 0},
                                    {"precision", LBW_INT, offsetof(bw_solver_options, precision)},
                                    {"full", LBW_BOOLEAN, offsetof(bw_solver_options, full)},
                                    {NULL, LBW_OTHER, 0}};
  bw_solver_options options = {.kind = BW_SOLVER_CHOLESKY};
  lua_settop(L, 1);
  lbw_options(L, 1, "solver.cholesky", list, &options);
  options.backend =
      (bw_backend)lbw_word_option(L, 1, "solver.cholesky", "backend", backends, BW_BACKEND_AUTO);
  options.ordering = (bw_ordering)lbw_word_option(L, 1, "solver.cholesky", "ordering", orderings,
                                                  BW_ORDERING_AUTO);
  return create(L, &options);
}

/* {preconditioner, tolerance, max_iterations} */
static int iterative(lua_State *L, bw_solver_kind kind, const char *function) {
  static const lbw_option list[] = {
      {"preconditioner", LBW_OTHER, 0},
      {"tolerance", LBW_REAL, offsetof(bw_solver_options, tolerance)},
      {"max_iterations", LBW_INT, offsetof(bw_solver_options, max_iterations)},
      {NULL, LBW_OTHER, 0}};
  bw_solver_options options = {.kind = kind};
  lua_settop(L, 1);
  lbw_options(L, 1, function, list, &options);
  if (options.max_iterations < 1 && lbw_option_get(L, 1, "max_iterations") != LUA_TNIL)
    lbw_option_refused(L, function, "max_iterations", "an integer of 1 or more");
  if (!(options.tolerance > 0) && lbw_option_get(L, 1, "tolerance") != LUA_TNIL)
    lbw_option_refused(L, function, "tolerance", "a number above 0 and below 1");
  lua_settop(L, 1);
  options.preconditioner = (const bw_solver *)lbw_object_option(
      L, 1, function, "preconditioner", &lbw_solver_class, "a solver of bw.solver");
  return create(L, &options);
}

static int solver_pcg(lua_State *L) {
  return iterative(L, BW_SOLVER_PCG, "solver.pcg");
}

static int solver_bicgstab(lua_State *L) {
  return iterative(L, BW_SOLVER_BICGSTAB, "solver.bicgstab");
}

/* Those without options but `full`. */
static int plain(lua_State *L, bw_solver_kind kind, const char *function, bool full) {
  static const lbw_option list[] = {{"full", LBW_BOOLEAN, offsetof(bw_solver_options, full)},
                                    {NULL, LBW_OTHER, 0}};
  bw_solver_options options = {.kind = kind};
  lua_settop(L, 1);
  lbw_options(L, 1, function, full ? list : list + 1, &options);
  return create(L, &options);
}

static int solver_lu(lua_State *L) {
  return plain(L, BW_SOLVER_LU, "solver.lu", true);
}

static int solver_two_level(lua_State *L) {
  return plain(L, BW_SOLVER_TWO_LEVEL, "solver.two_level", false);
}

static int solver_jacobi(lua_State *L) {
  return plain(L, BW_SOLVER_JACOBI, "solver.jacobi", false);
}

/* solver.amg{backend} */
static int solver_amg(lua_State *L) {
  static const lbw_option list[] = {{"backend", LBW_OTHER, 0}, {NULL, LBW_OTHER, 0}};
  static const char *const words[] = {"auto", "petsc", NULL};
  bw_solver_options options = {.kind = BW_SOLVER_AMG};
  lua_settop(L, 1);
  lbw_options(L, 1, "solver.amg", list, &options);
  if (lbw_word_option(L, 1, "solver.amg", "backend", words, 0) > 0)
    options.backend = BW_BACKEND_PETSC;
  return create(L, &options);
}

/* ---- the option ------------------------------------------------------------------------------ */

const bw_solver *lbw_solver_option(lua_State *L, int index, const char *function) {
  return (const bw_solver *)lbw_object_option(L, index, function, "solver", &lbw_solver_class,
                                              LBW_SOLVER_EXPECTED);
}

bool lbw_solver_is_external(const bw_solver *solver) {
  if (solver && solver->options.kind == BW_SOLVER_PCG)
    solver = solver->options.preconditioner;
  return solver && solver->options.backend == BW_BACKEND_PETSC;
}

/* ---- properties ------------------------------------------------------------------------------ */

static int get_kind(lua_State *L) {
  lua_pushstring(L, bw_solver_word(self(L)->options.kind));
  return 1;
}

static bool has_factor(const bw_solver *solver) {
  return solver->options.kind == BW_SOLVER_CHOLESKY;
}

static int get_backend(lua_State *L) {
  const bw_solver *solver = self(L);
  if (!has_factor(solver) && solver->options.kind != BW_SOLVER_AMG)
    return 0;
  lua_pushstring(L, bw_backend_word(solver->options.backend));
  return 1;
}

static int get_ordering(lua_State *L) {
  if (!has_factor(self(L)))
    return 0;
  lua_pushstring(L, bw_ordering_word(self(L)->options.ordering));
  return 1;
}

static int get_precision(lua_State *L) {
  if (self(L)->options.precision == 0)
    return 0;
  lua_pushinteger(L, self(L)->options.precision);
  return 1;
}

static int get_full(lua_State *L) {
  if (!has_factor(self(L)) && self(L)->options.kind != BW_SOLVER_LU)
    return 0;
  lua_pushboolean(L, self(L)->options.full);
  return 1;
}

static int get_preconditioner(lua_State *L) {
  if (!self(L)->options.preconditioner)
    return 0;
  lbw_push(L, &lbw_solver_class, self(L)->options.preconditioner);
  return 1;
}

static int get_tolerance(lua_State *L) {
  if (!(self(L)->options.tolerance > 0))
    return 0;
  lua_pushnumber(L, self(L)->options.tolerance);
  return 1;
}

static int get_max_iterations(lua_State *L) {
  if (self(L)->options.max_iterations == 0)
    return 0;
  lua_pushinteger(L, self(L)->options.max_iterations);
  return 1;
}

static int solver_tostring(lua_State *L) {
  char text[BW_SOLVER_TEXT];
  bw_solver_describe(self(L), text);
  lua_pushstring(L, text);
  return 1;
}

static const luaL_Reg methods[] = {{NULL, NULL}};
static const luaL_Reg properties[] = {{"kind", get_kind},
                                      {"backend", get_backend},
                                      {"ordering", get_ordering},
                                      {"precision", get_precision},
                                      {"full", get_full},
                                      {"preconditioner", get_preconditioner},
                                      {"tolerance", get_tolerance},
                                      {"max_iterations", get_max_iterations},
                                      {NULL, NULL}};
static const luaL_Reg meta[] = {{"__tostring", solver_tostring}, {NULL, NULL}};
const lbw_class lbw_solver_class = {"solver", methods, properties, meta, NULL};

void lbw_open_solver(lua_State *L) {
  static const luaL_Reg functions[] = {{"cholesky", solver_cholesky},   {"pcg", solver_pcg},
                                       {"two_level", solver_two_level}, {"amg", solver_amg},
                                       {"jacobi", solver_jacobi},       {"lu", solver_lu},
                                       {"bicgstab", solver_bicgstab},   {NULL, NULL}};
  lbw_class_register(L, &lbw_solver_class);
  lua_newtable(L);
  luaL_setfuncs(L, functions, 0);
  lua_setfield(L, -2, "solver");
}
