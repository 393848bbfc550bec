/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* Load factors and buckling shapes of static solutions. */
#include "bind.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

static const bw_buckling *self(lua_State *L) {
  return (const bw_buckling *)lbw_check(L, 1, &lbw_buckling_class);
}

/* Options {count, sign, tolerance, sturm, seed, loads_turn, solver} at a place of the stack. */
static bw_buckling_options read_options(lua_State *L, int index) {
  static const lbw_option list[] = {
      {"count", LBW_INT, offsetof(bw_buckling_options, count)},
      {"sign", LBW_OTHER, 0},
      {"tolerance", LBW_REAL, offsetof(bw_buckling_options, tolerance)},
      {"sturm", LBW_BOOLEAN, offsetof(bw_buckling_options, sturm)},
      {"seed", LBW_SEED, offsetof(bw_buckling_options, seed)},
      {"loads_turn", LBW_BOOLEAN, offsetof(bw_buckling_options, loads_turn)},
      {"solver", LBW_OTHER, 0},
      {NULL, LBW_OTHER, 0}};
  static const char *const signs[] = {"either", "positive", "negative", NULL};
  bw_buckling_options options;
  lua_settop(L, index);
  bw_buckling_options_default(&options);
  lbw_options(L, index, "buckling", list, &options);
  options.sign =
      (bw_buckling_sign)lbw_word_option(L, index, "buckling", "sign", signs, BW_BUCKLING_EITHER);
  options.solver = lbw_eigensolver_option(L, index, "buckling");
  return options;
}

/* static:buckling{...} */
static int static_buckling(lua_State *L) {
  const bw_static *solution = (const bw_static *)lbw_check(L, 1, &lbw_static_class);
  bw_buckling_options options = read_options(L, 2);
  lbw_box *box = lbw_box_new(L, &lbw_buckling_class);
  bw_buckling *buckling = NULL;
  bw_context *context = lbw_enter(L);
  bw_status status = bw_model_joined(solution->model)
                         ? bw_joined_buckling(context, solution, &options, &buckling)
                         : bw_buckling_of_static(context, solution, &options, &buckling);
  return lbw_leave_object(L, box, buckling, status);
}

/* system:buckling(displacement, {...}) */
static int system_buckling(lua_State *L) {
  bw_system *system = (bw_system *)lbw_check(L, 1, &lbw_system_class);
  bw_buckling_options options = read_options(L, 3);
  int64_t rows;
  const double *displacement = lbw_to_doubles(L, 2, "displacement", 3, &rows);
  lbw_check_rows(L, 2, "displacement", rows, system->mesh->node_count, "node");
  lbw_box *box = lbw_box_new(L, &lbw_buckling_class);
  bw_buckling *buckling = NULL;
  bw_status status =
      bw_buckling_of_displacement(lbw_enter(L), system, displacement, &options, &buckling);
  return lbw_leave_object(L, box, buckling, status);
}

/* stress_stiffness_gradient(system, shape): nodal forces, a row of three for every node, and the
 * work shape . K shape */
static int stress_stiffness_gradient(lua_State *L) {
  const bw_system *system = (const bw_system *)lbw_check(L, 1, &lbw_system_class);
  int64_t rows;
  const double *x = lbw_to_doubles(L, 2, "shape", 3, &rows);
  lbw_check_rows(L, 2, "shape", rows, system->mesh->node_count, "node");
  double *out = (double *)lbw_push_array(L, BW_F64, rows, 3)->data, work = 0;
  bw_status status =
      bw_stress_stiffness_gradient(lbw_enter(L), system->mesh, system->material, x, x, out, &work);
  int results = lbw_leave(L, status, 1);
  if (status != BW_OK)
    return results;
  lua_pushnumber(L, work);
  return 2;
}

/* buckling_starts(system, basis, {shapes}, {pressure, force, force_is_max, hands, hand_area, lp,
 * reversed, restarts, seed, wanted}): {pressures, values, report} with a row for each load */
static int buckling_starts(lua_State *L) {
  struct opts {
    bw_buckling_starts_options of;
    int wanted;
  } opts;
  static const lbw_option list[] = {
      {"pressure", LBW_REAL, offsetof(struct opts, of.loads.pressure)},
      {"force", LBW_REAL, offsetof(struct opts, of.loads.force)},
      {"force_is_max", LBW_BOOLEAN, offsetof(struct opts, of.loads.force_is_max)},
      {"hands", LBW_INT, offsetof(struct opts, of.loads.hands)},
      {"hand_area", LBW_REAL, offsetof(struct opts, of.loads.hand_area)},
      {"lp", LBW_OTHER, 0},
      {"reversed", LBW_BOOLEAN, offsetof(struct opts, of.reversed)},
      {"restarts", LBW_INT, offsetof(struct opts, of.restarts)},
      {"seed", LBW_SEED, offsetof(struct opts, of.seed)},
      {"wanted", LBW_INT, offsetof(struct opts, wanted)},
      {NULL, LBW_OTHER, 0}};
  bw_system *system = (bw_system *)lbw_check(L, 1, &lbw_system_class);
  const bw_pressure_basis *basis =
      (const bw_pressure_basis *)lbw_check(L, 2, &lbw_pressure_basis_class);
  int64_t nodes = system->mesh->node_count, rows;
  lbw_argument_check(L, basis->mesh == system->mesh, 2,
                     "a pressure basis of the same mesh expected");
  lbw_argument_check(L, lua_istable(L, 3), 3, "a list of shapes expected");
  bw_buckling_starts_options_default(&opts.of);
  opts.wanted = 1;
  lua_settop(L, 4);
  lbw_options(L, 4, "buckling_starts", list, &opts);
  opts.of.loads.lp = lbw_lp_option(L, 4, "buckling_starts");
  lbw_argument_check(L, opts.wanted >= 1 && opts.wanted <= 10000, 4, "wanted: 1 to 10000 expected");
  int64_t count = (int64_t)lua_rawlen(L, 3);
  lbw_argument_check(L, count <= 60, 3, "60 shapes at most expected");
  size_t size = 3 * (size_t)nodes * sizeof(double);
  char *block = (char *)lua_newuserdatauv(L, (size_t)count * size + 1, 0); /* 5 */
  for (int64_t i = 0; i < count; i++) {
    lua_rawgeti(L, 3, i + 1);
    const double *shape = lbw_to_doubles(L, 6, "shape", 3, &rows);
    lbw_check_rows(L, 6, "shape", rows, nodes, "node");
    memcpy(block + (size_t)i * size, shape, size);
    lua_settop(L, 5);
  }
  double *pressure = (double *)lua_newuserdatauv(
      L, (size_t)opts.wanted * ((size_t)basis->count + 1) * sizeof(double), 0); /* 6 */
  double *value = pressure + (size_t)opts.wanted * (size_t)basis->count;
  int found = 0;
  bw_solver_report report;
  bw_status status = bw_buckling_starts(lbw_enter(L), system, basis, &opts.of, (int)count,
                                        (const double *)(void *)block, opts.wanted, &found,
                                        pressure, value, &report);
  int results = lbw_leave(L, status, 0);
  if (status != BW_OK)
    return results;
  lua_createtable(L, 0, 3); /* 7 */
  double *to = (double *)lbw_push_array(L, BW_F64, found, basis->count)->data;
  lua_setfield(L, 7, "pressures");
  double *values = (double *)lbw_push_array(L, BW_F64, found, 1)->data;
  lua_setfield(L, 7, "values");
  if (found > 0) {
    memcpy(to, pressure, (size_t)found * (size_t)basis->count * sizeof *to);
    memcpy(values, value, (size_t)found * sizeof *values);
  }
  lbw_push_report(L, &report);
  lua_setfield(L, 7, "report");
  return 1;
}

/* buckling:shape(i): a view, a row for every node */
static int buckling_shape(lua_State *L) {
  const bw_buckling *buckling = self(L);
  int64_t i = lbw_check_index(L, 2, "load factor", buckling->count);
  int64_t nodes = buckling->model->mesh->node_count;
  return lbw_push_borrowed(L, BW_F64, nodes, 3, buckling->shape + i * 3 * nodes, buckling);
}

/* buckling:error_estimate(): the relative error by the mesh, by factor */
static int buckling_error_estimate(lua_State *L) {
  const bw_buckling *buckling = self(L);
  double *out = (double *)lbw_push_array(L, BW_F64, buckling->count, 1)->data;
  return lbw_leave(L, bw_buckling_error(lbw_enter(L), buckling, out), 1);
}

static int buckling_factors(lua_State *L) {
  return lbw_push_borrowed(L, BW_F64, self(L)->count, 1, self(L)->factor, self(L));
}

static int buckling_errors(lua_State *L) {
  return lbw_push_borrowed(L, BW_F64, self(L)->count, 1, self(L)->error, self(L));
}

/* The smallest positive factor, or nil. */
static int buckling_factor(lua_State *L) {
  const bw_buckling *buckling = self(L);
  for (int k = 0; k < buckling->count; k++)
    if (buckling->factor[k] > 0) {
      lua_pushnumber(L, buckling->factor[k]);
      return 1;
    }
  lua_pushnil(L);
  return 1;
}

static int buckling_searched(lua_State *L) {
  lua_pushnumber(L, self(L)->searched);
  return 1;
}

static int buckling_counted(lua_State *L) {
  lua_pushboolean(L, self(L)->counted);
  return 1;
}

#define INTEGER(name, field)                                                                       \
  static int name(lua_State *L) {                                                                  \
    lua_pushinteger(L, self(L)->field);                                                            \
    return 1;                                                                                      \
  }
INTEGER(buckling_count, count)
INTEGER(buckling_solves, solves)
INTEGER(buckling_recovered, recovered)
#undef INTEGER

static int buckling_mesh(lua_State *L) {
  lbw_push(L, &lbw_mesh_class, self(L)->model->mesh);
  return 1;
}

static int buckling_report(lua_State *L) {
  lbw_push_report(L, &self(L)->report);
  return 1;
}

static int buckling_tostring(lua_State *L) {
  const bw_buckling *buckling = (const bw_buckling *)lbw_check(L, 1, &lbw_buckling_class);
  const char *known = buckling->counted ? "counted: none is missing" : "not counted";
  char text[300];
  int n = buckling->count;
  if (n == 0) {
    snprintf(text, sizeof text, "no load factor of the wanted sign to %.4g times the load (%s)",
             buckling->searched, buckling->counted ? "counted" : "not counted");
    lua_pushstring(L, text);
    return 1;
  }
  double relative[500], largest = 0;
  bw_status status = bw_buckling_error(lbw_enter(L), buckling, relative);
  for (int k = 0; k < n && status == BW_OK; k++)
    largest = fmax(largest, relative[k]);
  lbw_leave_or_raise(L, status);
  snprintf(
      text, sizeof text,
      "%d load factor%s by %s, %.4g to %.4g, %s; the shapes' mesh makes them too large by about "
      "%.2g %% at most",
      n, n == 1 ? "" : "s", buckling->report.solver, buckling->factor[0], buckling->factor[n - 1],
      known, 100 * largest);
  lua_pushstring(L, text);
  return 1;
}

static const luaL_Reg methods[] = {
    {"shape", buckling_shape}, {"error_estimate", buckling_error_estimate}, {NULL, NULL}};
static const luaL_Reg properties[] = {{"factors", buckling_factors},
                                      {"factor", buckling_factor},
                                      {"errors", buckling_errors},
                                      {"count", buckling_count},
                                      {"counted", buckling_counted},
                                      {"searched", buckling_searched},
                                      {"solves", buckling_solves},
                                      {"recovered", buckling_recovered},
                                      {"mesh", buckling_mesh},
                                      {"report", buckling_report},
                                      {NULL, NULL}};
static const luaL_Reg meta[] = {
    {"__len", buckling_count}, {"__tostring", buckling_tostring}, {NULL, NULL}};
const lbw_class lbw_buckling_class = {"buckling", methods, properties, meta, NULL};

void lbw_open_buckling(lua_State *L) {
  static const luaL_Reg of_static[] = {{"buckling", static_buckling}, {NULL, NULL}};
  static const luaL_Reg of_system[] = {{"buckling", system_buckling}, {NULL, NULL}};
  static const luaL_Reg functions[] = {{"stress_stiffness_gradient", stress_stiffness_gradient},
                                       {"buckling_starts", buckling_starts},
                                       {NULL, NULL}};
  lbw_class_register(L, &lbw_buckling_class);
  lbw_add_methods(L, &lbw_static_class, of_static);
  lbw_add_methods(L, &lbw_system_class, of_system);
  luaL_setfuncs(L, functions, 0);
}
