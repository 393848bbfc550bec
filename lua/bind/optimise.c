/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* What the scaling optimisation asks of the engine: how stresses change with the shape, and small
 * quadratic programs. */
#include "bind.h"

#include <math.h>
#include <string.h>

/* ---- stress gradients ------------------------------------------------------------------------ */

typedef struct solver {
  bw_system *system;                  /* either this */
  bw_incremental_system *incremental; /* or this */
  bw_incremental_options options;
  double *adjoint; /* where the next ones go, or NULL */
} solver;

static bw_status solve(void *data, bw_context *context, int64_t count, const double *force,
                       double *displacement) {
  solver *s = (solver *)data;
  bw_status status = s->system ? bw_system_solve(context, s->system, count, force, displacement)
                               : bw_incremental_system_solve(context, s->incremental, &s->options,
                                                             count, force, displacement, NULL);
  const bw_mesh *mesh = s->system ? s->system->mesh : s->incremental->system->mesh;
  if (s->adjoint && status == BW_OK) {
    size_t size = (size_t)count * 3 * (size_t)mesh->node_count;
    memcpy(s->adjoint, displacement, size * sizeof *displacement);
    s->adjoint += size;
  }
  return status;
}

typedef struct request {
  const bw_model *model;
  solver solver;
  const bw_dof_map *dof_map;
  double *displacement;
  int32_t *node;
  int64_t count;
} request;

/* The arguments model, system or incremental system, displacement, nodes; options at `options`. */
static request check_request(lua_State *L, int options) {
  static const lbw_option list[] = {
      {"tolerance", LBW_REAL, offsetof(bw_incremental_options, tolerance)},
      {"solver", LBW_OTHER, 0},
      {"guess", LBW_OTHER, 0},
      {"max_iteration_ratio", LBW_REAL, offsetof(bw_incremental_options, max_iteration_ratio)},
      {"energy", LBW_BOOLEAN, offsetof(bw_incremental_options, energy)},
      {NULL, LBW_OTHER, 0}};
  request r = {.model = (const bw_model *)lbw_check(L, 1, &lbw_model_class)};
  bw_incremental_options_default(&r.solver.options);
  lbw_options(L, options, "von_mises_slopes", list, &r.solver.options);
  r.solver.options.solver = lbw_solver_option(L, options, "von_mises_slopes");
  r.solver.incremental = (bw_incremental_system *)lbw_test(L, 2, &lbw_incremental_system_class);
  if (r.solver.incremental)
    r.dof_map = r.solver.incremental->system->dof_map;
  else {
    r.solver.system = (bw_system *)lbw_check(L, 2, &lbw_system_class);
    r.dof_map = r.solver.system->dof_map;
  }
  int32_t nodes = r.model->mesh->node_count;
  int64_t rows;
  lbw_argument_check(L, r.dof_map->mesh->node_count == nodes, 2, "a system of the model expected");
  lbw_read_guess(L, options, "von_mises_slopes", nodes, &r.solver.options);
  r.displacement = lbw_to_doubles(L, 3, "displacement", 3, &rows);
  lbw_check_rows(L, 3, "displacement", rows, nodes, "node");
  r.node = lbw_to_indices(L, 4, "nodes", 1, &r.count);
  for (int64_t i = 0; i < r.count; i++)
    lbw_argument_check(L, r.node[i] < nodes, 4, "nodes: numbers of the mesh's nodes expected");
  return r;
}

/* von_mises_gradient(model, system, displacement, nodes, {tolerance, guess}): the stress at the
 * nodes; its derivative by the position of every node, a block of node_count rows for each of the
 * nodes */
static int core_gradient(lua_State *L) {
  lua_settop(L, 5);
  request r = check_request(L, 5);
  int64_t all = r.model->mesh->node_count;
  double *value = (double *)lbw_push_array(L, BW_F64, r.count, 1)->data;
  double *gradient = (double *)lbw_push_array(L, BW_F64, r.count * all, 3)->data;
  return lbw_leave(L,
                   bw_von_mises_gradient(lbw_enter(L), r.model, r.dof_map, r.displacement, solve,
                                         &r.solver, r.count, r.node, NULL, value, gradient),
                   2);
}

/* von_mises_slopes(model, system, displacement, nodes, {motions}, {tolerance, guess}): the stress
 * at the nodes; its change, a row for each of the nodes, a column for each of the motions (a row
 * for every node of the mesh); the adjoint displacements, a block of node_count rows for each node
 */
static int core_slopes(lua_State *L) {
  enum { AT_ONCE = 8 };
  lua_settop(L, 6);
  request r = check_request(L, 6);
  int64_t all = 3 * (int64_t)r.model->mesh->node_count, rows;
  lbw_check_type(L, 5, LUA_TTABLE);
  int motions = (int)lua_rawlen(L, 5);
  luaL_checkstack(L, motions + 10, "too many motions");
  const double **motion =
      (const double **)lua_newuserdatauv(L, (size_t)(motions + 1) * sizeof *motion, 0);
  for (int m = 0; m < motions; m++) {
    lua_rawgeti(L, 5, m + 1);
    motion[m] = lbw_to_doubles(L, -1, "motions", 3, &rows);
    lbw_check_rows(L, 5, "motions", rows, all / 3, "node");
    lua_remove(L, -2);
  }
  double *value = (double *)lbw_push_array(L, BW_F64, r.count, 1)->data;
  double *slope = (double *)lbw_push_array(L, BW_F64, r.count, motions)->data;
  r.solver.adjoint = (double *)lbw_push_array(L, BW_F64, r.count * all / 3, 3)->data;
  bw_status status = BW_OK;
  bw_context *context = lbw_enter(L);
  double *gradient = BW_NEW(context, double, all *(r.count < AT_ONCE ? r.count : AT_ONCE));
  uint8_t *wanted = BW_NEW0(context, uint8_t, all / 3);
  if (!gradient || !wanted)
    status = BW_MEMORY;
  for (int m = 0; m < motions && status == BW_OK; m++)
    for (int64_t j = 0; j < all; j++)
      wanted[j / 3] |= motion[m][j] != 0;
  for (int64_t i = 0; i < r.count && status == BW_OK; i += AT_ONCE) {
    int64_t count = r.count - i < AT_ONCE ? r.count - i : AT_ONCE;
    status = bw_von_mises_gradient(context, r.model, r.dof_map, r.displacement, solve, &r.solver,
                                   count, r.node + i, wanted, value + i, gradient);
    for (int64_t k = 0; k < count && status == BW_OK; k++)
      for (int m = 0; m < motions; m++) {
        double sum = 0;
        for (int64_t j = 0; j < all; j++)
          if (wanted[j / 3])
            sum += gradient[all * k + j] * motion[m][j];
        slope[(i + k) * motions + m] = sum;
      }
  }
  bw_free(gradient);
  bw_free(wanted);
  return lbw_leave(L, status, 3);
}

/* corner_nodes(mesh): their numbers, ascending */
static int core_corner_nodes(lua_State *L) {
  const bw_mesh *mesh = (const bw_mesh *)lbw_check(L, 1, &lbw_mesh_class);
  uint8_t *corner = (uint8_t *)lua_newuserdatauv(L, (size_t)mesh->node_count + 1, 0);
  memset(corner, 0, (size_t)mesh->node_count);
  for (int64_t e = 0; e < mesh->element_count; e++)
    for (int a = 0; a < 4; a++)
      corner[mesh->element[e * mesh->nodes_per_element + a]] = 1;
  int64_t count = 0;
  for (int32_t i = 0; i < mesh->node_count; i++)
    count += corner[i];
  int32_t *out = (int32_t *)lbw_push_array(L, BW_I32, count, 1)->data;
  for (int32_t i = 0; i < mesh->node_count; i++)
    if (corner[i])
      *out++ = i + 1;
  return 1;
}

/* ---- quadratic programs -------------------------------------------------------------------- */

/* options[key] as `rows` x `columns` numbers in a userdata that is pushed; where it is not given,
 * all are `otherwise`, unless that is NaN. */
static double *numbers(lua_State *L, const char *key, int64_t rows, int64_t columns,
                       double otherwise) {
  double *data = NULL;
  int64_t given = rows;
  if (lbw_option_get(L, 1, key) != LUA_TNIL)
    data = lbw_to_doubles(L, -1, key, columns, &given);
  else if (rows * columns == 0 || !isnan(otherwise)) {
    data = (double *)lua_newuserdatauv(L, (size_t)(rows * columns + 1) * sizeof *data, 0);
    for (int64_t i = 0; i < rows * columns; i++)
      data[i] = otherwise;
  } else
    lbw_option_missing(L, "quadratic_program", key, "");
  if (given != rows)
    lbw_error(L, "quadratic_program: option '%s': %I rows expected, got %I", key, (LUAI_UACINT)rows,
              (LUAI_UACINT)given);
  return data;
}

static int64_t length_of(lua_State *L, const char *key) {
  int64_t count = 0;
  if (lbw_option_get(L, 1, key) != LUA_TNIL)
    lbw_to_doubles(L, -1, key, 1, &count);
  return count;
}

/* quadratic_program{H =, g =, A =, b =, min =, max =}: x, violation, multipliers */
static int core_program(lua_State *L) {
  static const lbw_option list[] = {
      {"H", LBW_OTHER, 0},   {"g", LBW_OTHER, 0},   {"A", LBW_OTHER, 0}, {"b", LBW_OTHER, 0},
      {"min", LBW_OTHER, 0}, {"max", LBW_OTHER, 0}, {NULL, LBW_OTHER, 0}};
  lbw_check_type(L, 1, LUA_TTABLE);
  lua_settop(L, 1);
  luaL_checkstack(L, 20, "too many values");
  lbw_options(L, 1, "quadratic_program", list, NULL);
  int64_t n = length_of(L, "g"), m = length_of(L, "b");
  if (n < 1 || n > 1000 || m > 10000)
    return lbw_error(
        L,
        "quadratic_program: 1 to 1000 unknowns (g) and at most 10000 rows (b) expected, "
        "got %I and %I",
        (LUAI_UACINT)n, (LUAI_UACINT)m);
  double *H = numbers(L, "H", n, n, NAN), *g = numbers(L, "g", n, 1, NAN);
  double *A = numbers(L, "A", m, n, NAN), *b = numbers(L, "b", m, 1, NAN);
  double *min = numbers(L, "min", n, 1, -INFINITY), *max = numbers(L, "max", n, 1, INFINITY);
  double *x = (double *)lbw_push_array(L, BW_F64, n, 1)->data;
  int at = lua_gettop(L);
  double *multiplier = (double *)lbw_push_array(L, BW_F64, m, 1)->data, violation = 0;
  bw_status status = bw_quadratic_program(lbw_enter(L), (int)n, H, g, (int)m, A, b, min, max, x,
                                          &violation, multiplier);
  lua_pushvalue(L, at);
  lua_pushnumber(L, violation);
  lua_pushvalue(L, at + 1);
  return lbw_leave(L, status, 3);
}

void lbw_open_optimise(lua_State *L) {
  static const luaL_Reg functions[] = {{"von_mises_gradient", core_gradient},
                                       {"von_mises_slopes", core_slopes},
                                       {"quadratic_program", core_program},
                                       {"corner_nodes", core_corner_nodes},
                                       {NULL, NULL}};
  luaL_setfuncs(L, functions, 0);
}
