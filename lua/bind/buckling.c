/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* Load factors and buckling shapes of static solutions. */
#include "bind.h"

#include <math.h>
#include <stdio.h>

static const bw_buckling *self(lua_State *L) {
  return (const bw_buckling *)lbw_check(L, 1, &lbw_buckling_class);
}

/* static:buckling{count, sign, tolerance, sturm, seed, solver} */
static int static_buckling(lua_State *L) {
  static const lbw_option list[] = {
      {"count", LBW_INT, offsetof(bw_buckling_options, count)},
      {"sign", LBW_OTHER, 0},
      {"tolerance", LBW_REAL, offsetof(bw_buckling_options, tolerance)},
      {"sturm", LBW_BOOLEAN, offsetof(bw_buckling_options, sturm)},
      {"seed", LBW_SEED, offsetof(bw_buckling_options, seed)},
      {"solver", LBW_OTHER, 0},
      {NULL, LBW_OTHER, 0}};
  static const char *const signs[] = {"either", "positive", "negative", NULL};
  const bw_static *solution = (const bw_static *)lbw_check(L, 1, &lbw_static_class);
  lua_settop(L, 2);
  bw_buckling_options options;
  bw_buckling_options_default(&options);
  lbw_options(L, 2, "buckling", list, &options);
  options.sign =
      (bw_buckling_sign)lbw_word_option(L, 2, "buckling", "sign", signs, BW_BUCKLING_EITHER);
  options.solver = lbw_eigensolver_option(L, 2, "buckling");
  lbw_box *box = lbw_box_new(L, &lbw_buckling_class);
  bw_buckling *buckling = NULL;
  bw_status status = bw_buckling_of_static(lbw_enter(L), solution, &options, &buckling);
  return lbw_leave_object(L, box, buckling, status);
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
      "%d load factors by %s, %.4g to %.4g, %s; the shapes' mesh makes them too large by about "
      "%.2g %% at most",
      n, buckling->report.solver, buckling->factor[0], buckling->factor[n - 1], known,
      100 * largest);
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
  lbw_class_register(L, &lbw_buckling_class);
  lbw_add_methods(L, &lbw_static_class, of_static);
}
