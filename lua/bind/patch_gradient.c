/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* How the judged stress of a patch changes with the shape: what lua/barwright/advice.lua needs. */
#include "bind.h"

#include <string.h>

static const double *check_rows(lua_State *L, int index, const char *what, int columns,
                                int64_t rows) {
  int64_t given;
  const double *data = lbw_to_doubles(L, index, what, columns, &given);
  if (given != rows)
    lbw_error(L, "%s: %d rows expected, got %d", what, (int)rows, (int)given);
  return data;
}

/* patch_functional(system, radius, node, slope): nodal forces of the functional of the
 * displacement, its derivative by the nodal forces of the load */
static int patch_functional(lua_State *L) {
  const bw_system *system = (const bw_system *)lbw_check(L, 1, &lbw_system_class);
  const bw_mesh *mesh = system->mesh;
  lua_settop(L, 4);
  double radius = lbw_check_real(L, 2, "radius");
  int64_t node = lbw_check_index(L, 3, "node", mesh->node_count);
  const double *slope = check_rows(L, 4, "slope", 6, 1);
  double *force = (double *)lbw_push_array(L, BW_F64, mesh->node_count, 3)->data;
  double *by_force = (double *)lbw_push_array(L, BW_F64, mesh->node_count, 3)->data;
  return lbw_leave(L,
                   bw_patch_functional(lbw_enter(L), mesh, system->material, system->dof_map,
                                       radius, (int32_t)node, slope, force, by_force),
                   2);
}

/* patch_gradient(basis, system, {radius, node, slope, displacement, adjoint, pressure, price}):
 * a row for every node, the value */
static int patch_gradient(lua_State *L) {
  bw_patch_state state;
  static const lbw_option list[] = {{"radius", LBW_REAL, offsetof(bw_patch_state, radius)},
                                    {"price", LBW_REAL, offsetof(bw_patch_state, price)},
                                    {"node", LBW_OTHER, 0},
                                    {"slope", LBW_OTHER, 0},
                                    {"displacement", LBW_OTHER, 0},
                                    {"adjoint", LBW_OTHER, 0},
                                    {"pressure", LBW_OTHER, 0},
                                    {NULL, LBW_OTHER, 0}};
  const bw_pressure_basis *basis =
      (const bw_pressure_basis *)lbw_check(L, 1, &lbw_pressure_basis_class);
  const bw_system *system = (const bw_system *)lbw_check(L, 2, &lbw_system_class);
  const bw_mesh *mesh = basis->mesh;
  double value = 0;
  lbw_argument_check(L, system->mesh == mesh, 2, "a system of the same mesh expected");
  memset(&state, 0, sizeof state);
  state.basis = basis;
  state.dof_map = system->dof_map;
  lua_settop(L, 3);
  lbw_options(L, 3, "patch_gradient", list, &state);
  lbw_option_get(L, 3, "node"); /* 4 */
  state.node = (int32_t)lbw_check_index(L, 4, "node", mesh->node_count);
  lbw_option_get(L, 3, "slope"); /* 5 */
  memcpy(state.slope, check_rows(L, 5, "slope", 6, 1), sizeof state.slope);
  luaL_checkstack(L, 12, NULL);
  lua_settop(L, 5);
  lbw_option_get(L, 3, "displacement");
  lbw_option_get(L, 3, "adjoint");
  lbw_option_get(L, 3, "pressure");
  state.displacement = check_rows(L, 6, "displacement", 3, mesh->node_count);
  state.adjoint = check_rows(L, 7, "adjoint", 3, mesh->node_count);
  state.pressure = check_rows(L, 8, "pressure", 1, basis->count);
  double *out = (double *)lbw_push_array(L, BW_F64, mesh->node_count, 3)->data;
  bw_status status =
      bw_patch_shape_gradient(lbw_enter(L), mesh, system->material, &state, &value, out);
  lua_pushnumber(L, value);
  return lbw_leave(L, status, 2);
}

typedef bw_status nodal_map(bw_context *context, const bw_mesh *mesh, double *values);

static int mapped(lua_State *L, nodal_map *function) {
  const bw_mesh *mesh = (const bw_mesh *)lbw_check(L, 1, &lbw_mesh_class);
  const double *given = check_rows(L, 2, "values", 3, mesh->node_count);
  size_t size = 3 * (size_t)mesh->node_count * sizeof *given;
  double *out = (double *)lbw_push_array(L, BW_F64, mesh->node_count, 3)->data;
  memcpy(out, given, size);
  return lbw_leave(L, function(lbw_enter(L), mesh, out), 1);
}

/* boundary_extend(mesh, motion): that of the boundary nodes, extended into the body */
static int boundary_extend(lua_State *L) {
  return mapped(L, bw_boundary_extend);
}

/* boundary_gather(mesh, gradient): by the boundary nodes, which inner nodes follow */
static int boundary_gather(lua_State *L) {
  return mapped(L, bw_boundary_gather);
}

/* priced_load(system, basis, objective, {pressure, force, force_is_max}): the pressure of
 * basis:maximise, the value, and the multipliers: the rigid-body motion of the balance (a row for
 * every node) and the price of the total force */
static int priced_load(lua_State *L) {
  bw_worst_load_options options;
  static const lbw_option list[] = {
      {"pressure", LBW_REAL, offsetof(bw_worst_load_options, pressure)},
      {"force", LBW_REAL, offsetof(bw_worst_load_options, force)},
      {"force_is_max", LBW_BOOLEAN, offsetof(bw_worst_load_options, force_is_max)},
      {NULL, LBW_OTHER, 0}};
  const bw_system *system = (const bw_system *)lbw_check(L, 1, &lbw_system_class);
  const bw_pressure_basis *basis =
      (const bw_pressure_basis *)lbw_check(L, 2, &lbw_pressure_basis_class);
  lbw_argument_check(L, system->mesh == basis->mesh, 2, "a basis of the same mesh expected");
  memset(&options, 0, sizeof options);
  lua_settop(L, 4);
  lbw_options(L, 4, "priced_load", list, &options);
  const double *objective = check_rows(L, 3, "objective", 1, basis->count);
  int motions = system->dof_map->rigid_mode_count;
  int64_t nodes = basis->mesh->node_count;
  double *dual = (double *)lua_newuserdatauv(L, ((size_t)motions + 1) * sizeof *dual, 0);
  double *pressure = (double *)lbw_push_array(L, BW_F64, basis->count, 1)->data, value = 0;
  lua_pushnil(L); /* the value's place */
  double *motion = (double *)lbw_push_array(L, BW_F64, nodes, 3)->data;
  bw_status status = bw_worst_loads(lbw_enter(L), basis, system->dof_map, &options, 1, objective,
                                    pressure, &value, dual, NULL);
  memset(motion, 0, 3 * (size_t)nodes * sizeof *motion);
  if (status == BW_OK)
    bw_rigid_modes_add(system->dof_map, dual, motion);
  lua_pushnumber(L, value);
  lua_replace(L, -3);
  lua_pushnumber(L, status == BW_OK ? dual[motions] : 0);
  return lbw_leave(L, status, 4);
}

void lbw_open_patch_gradient(lua_State *L) {
  static const luaL_Reg functions[] = {
      {"patch_functional", patch_functional}, {"patch_gradient", patch_gradient},
      {"boundary_extend", boundary_extend},   {"boundary_gather", boundary_gather},
      {"priced_load", priced_load},           {NULL, NULL}};
  luaL_setfuncs(L, functions, 0);
}
