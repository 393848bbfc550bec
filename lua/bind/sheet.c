/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* Elastic sheets that follow an outline. A box holds a sheet and, as its second reference, the
 * mesh motion of its mesh. The applications, with names for options and conditions, are Lua
 * (lua/barwright/responsive.lua). */
#include "condition.h"
#include "follow.h"

#include <math.h>
#include <string.h>

static bw_sheet *self(lua_State *L) {
  return (bw_sheet *)lbw_check(L, 1, &lbw_sheet_class);
}

static bw_mesh_motion *mesh_motion_of(lua_State *L) {
  return (bw_mesh_motion *)lbw_check_box(L, 1, &lbw_sheet_class)->extra;
}

/* {{material = , thickness = , strain = }} */
static bw_sheet_section *read_sections(lua_State *L, int index, int32_t *count) {
  lbw_check_type(L, index, LUA_TTABLE);
  *count = (int32_t)lua_rawlen(L, index);
  bw_sheet_section *section =
      (bw_sheet_section *)lua_newuserdatauv(L, ((size_t)*count + 1) * sizeof *section, 0);
  for (int32_t i = 0; i < *count; i++) {
    lua_rawgeti(L, index, i + 1);
    lua_getfield(L, -1, "material");
    section[i].material = (const bw_material *)lbw_test(L, -1, &lbw_material_class);
    if (!section[i].material)
      lbw_error(L, "sheet: a material expected, got %s", lbw_got(L, -1));
    lua_getfield(L, -2, "thickness");
    section[i].thickness = lua_tonumber(L, -1);
    lua_getfield(L, -3, "strain");
    section[i].plane_strain = lua_toboolean(L, -1);
    lua_pop(L, 4);
  }
  return section;
}

static bw_status create(bw_context *context, const bw_plane_mesh *mesh, const void *description,
                        void **body) {
  bw_sheet *sheet = NULL;
  bw_status status =
      bw_sheet_create(context, mesh, (const bw_sheet_description *)description, &sheet);
  *body = sheet;
  return status;
}

/* sheet.create(outline, fill, follow, sections, conditions, gravity) */
static int sheet_create(lua_State *L) {
  lua_settop(L, 6);
  const bw_outline *outline = (const bw_outline *)lbw_check(L, 1, &lbw_outline_class);
  bw_follow_options follow;
  bw_sheet_description description = {0};
  lbw_read_follow(L, 3, "sheet", &follow);
  lbw_read_fill(L, 2, "sheet", &follow.fill);
  description.section = read_sections(L, 4, &description.section_count);
  lbw_conditions *conditions = lbw_conditions_read(L, 5, "conditions", outline);
  int place = lua_gettop(L);
  description.condition = lbw_conditions_list(conditions, &description.condition_count);
  lbw_conditions_size(conditions, &follow.fill);
  for (int i = 0; i < 2; i++) {
    lua_rawgeti(L, 6, i + 1);
    description.gravity[i] = lua_tonumber(L, -1);
    lua_pop(L, 1);
  }
  return lbw_follow_create(L, &lbw_sheet_class, outline, &follow, place, create, &description);
}

/* ---- following and solving ------------------------------------------------------------------- */

static bw_status follow_mesh(bw_context *context, void *sheet, const bw_plane_mesh *mesh,
                             bw_plane_reuse *reuse) {
  return bw_sheet_follow(context, (bw_sheet *)sheet, mesh, reuse);
}

static const void *keep(const void *sheet) {
  return bw_sheet_keep((const bw_sheet *)sheet);
}

static bw_status restore(bw_context *context, void *sheet, const void *state) {
  return bw_sheet_return(context, (bw_sheet *)sheet, (const bw_sheet_state *)state);
}

static bw_status check(bw_context *context, const void *sheet) {
  return bw_sheet_check(context, (const bw_sheet *)sheet);
}

static const bw_plane_mesh *mesh_of(const void *sheet) {
  return ((const bw_sheet *)sheet)->mesh;
}

static const lbw_followed followed = {&lbw_sheet_class, follow_mesh, keep, restore, check, mesh_of};

/* sheet:follow(frame, outline) */
static int sheet_follow(lua_State *L) {
  return lbw_follow(L, &followed);
}

/* sheet:save(), sheet:restore(state) */
static int sheet_save(lua_State *L) {
  return lbw_followed_keep(L, &followed);
}
static int sheet_restore(lua_State *L) {
  return lbw_followed_return(L, &followed);
}
static int sheet_check(lua_State *L) {
  return lbw_followed_check(L, &followed);
}

/* sheet:static(frame, {solver, max_lag}) */
static int sheet_static(lua_State *L) {
  bw_sheet *sheet = self(L);
  lua_settop(L, 3);
  lbw_check_type(L, 2, LUA_TTABLE);
  bw_lagged_factor_options options;
  bw_plane_reuse reuse;
  bw_lagged_factor_options_default(&options);
  lbw_read_lagged_factor(L, 3, "solve", &options);
  lbw_load_plane_reuse(L, 2, &reuse);
  lbw_conditions_begin(L, 1);
  bw_status status = bw_sheet_static(lbw_enter(L), sheet, &options, &reuse);
  return lbw_leave_frame(L, &lbw_sheet_class, status, &reuse);
}

/* sheet:transient(frame, {solver, max_lag}, newmark, steps) */
static int sheet_transient(lua_State *L) {
  static const lbw_option list[] = {
      {"step", LBW_REAL, offsetof(bw_newmark, step)},
      {"beta", LBW_REAL, offsetof(bw_newmark, beta)},
      {"gamma", LBW_REAL, offsetof(bw_newmark, gamma)},
      {"damping_mass", LBW_REAL, offsetof(bw_newmark, damping_mass)},
      {"damping_stiffness", LBW_REAL, offsetof(bw_newmark, damping_stiffness)},
      {NULL, LBW_OTHER, 0}};
  bw_status status = BW_OK;
  bw_sheet *sheet = self(L);
  lua_settop(L, 5);
  lbw_check_type(L, 2, LUA_TTABLE);
  bw_lagged_factor_options options;
  bw_newmark newmark;
  bw_plane_reuse reuse;
  bw_lagged_factor_options_default(&options);
  lbw_read_lagged_factor(L, 3, "step", &options);
  bw_newmark_default(&newmark);
  lbw_options(L, 4, "step", list, &newmark);
  lua_Integer steps = lbw_integer_or(L, 5, 1);
  lbw_load_plane_reuse(L, 2, &reuse);
  lbw_conditions_begin(L, 1);
  bw_context *context = lbw_enter(L);
  const bw_sheet_state *before = bw_sheet_keep(sheet);
  for (lua_Integer i = 0; i < steps; i++) {
    if (steps > 1)
      bw_progress(context, "time steps", (double)i / (double)steps);
    BW_TRY(bw_check_cancel(context));
    BW_TRY(bw_sheet_transient(context, sheet, &newmark, &options, &reuse));
  }
done:
  if (status != BW_OK) /* all steps or none; its own state: it cannot fail */
    (void)bw_sheet_return(context, sheet, before);
  bw_release(before);
  return lbw_leave_frame(L, &lbw_sheet_class, status, &reuse);
}

/* sheet:large_deflection(frame, {solver, max_lag}, newton) */
static int sheet_large_deflection(lua_State *L) {
  static const lbw_option list[] = {
      {"tolerance", LBW_REAL, offsetof(bw_large_deflection_options, tolerance)},
      {"iterations", LBW_INT, offsetof(bw_large_deflection_options, iterations)},
      {"load_steps", LBW_INT, offsetof(bw_large_deflection_options, load_steps)},
      {NULL, LBW_OTHER, 0}};
  bw_sheet *sheet = self(L);
  lua_settop(L, 4);
  lbw_check_type(L, 2, LUA_TTABLE);
  bw_large_deflection_options options;
  bw_large_deflection_report report = {0};
  bw_plane_reuse reuse;
  bw_large_deflection_options_default(&options);
  lbw_options(L, 4, "solve", list, &options);
  lbw_read_lagged_factor(L, 3, "solve", &options.linear);
  lbw_load_plane_reuse(L, 2, &reuse);
  lbw_conditions_begin(L, 1);
  bw_status status = bw_sheet_large_deflection(lbw_enter(L), sheet, &options, &report, &reuse);
  int results = lbw_leave_frame(L, &lbw_sheet_class, status, &reuse);
  if (status == BW_OK) {
    lua_pushinteger(L, report.iterations);
    lua_setfield(L, 2, "newton_iterations");
    lua_pushinteger(L, report.load_steps);
    lua_setfield(L, 2, "load_steps");
    lua_pushnumber(L, report.energy);
    lua_setfield(L, 2, "energy");
  }
  return results;
}

/* ---- results --------------------------------------------------------------------------------- */

static int32_t nodes_of(const bw_sheet *sheet) {
  return sheet->mesh->topology->nodes->node_count;
}

/* Fields change in place: each is a copy of its moment. */
static int push_field(lua_State *L, const bw_sheet *sheet, const double *field) {
  if (!field) {
    lua_pushnil(L);
    return 1;
  }
  bw_array *array = lbw_push_array(L, BW_F64, nodes_of(sheet), 2);
  memcpy(array->data, field, 2 * (size_t)nodes_of(sheet) * sizeof(double));
  return 1;
}

static int sheet_displacement(lua_State *L) {
  return push_field(L, self(L), self(L)->displacement);
}
static int sheet_velocity(lua_State *L) {
  return push_field(L, self(L), self(L)->velocity);
}
static int sheet_acceleration(lua_State *L) {
  return push_field(L, self(L), self(L)->acceleration);
}

static int sheet_stress(lua_State *L) {
  const bw_sheet *sheet = self(L);
  bw_array *array = lbw_push_array(L, BW_F64, nodes_of(sheet), 4);
  bw_status status = bw_sheet_stress(lbw_enter(L), sheet, (double *)array->data, NULL);
  lbw_leave_or_raise(L, status);
  return 1;
}

static int sheet_von_mises(lua_State *L) {
  const bw_sheet *sheet = self(L);
  bw_array *array = lbw_push_array(L, BW_F64, nodes_of(sheet), 1);
  bw_status status = bw_sheet_stress(lbw_enter(L), sheet, NULL, (double *)array->data);
  lbw_leave_or_raise(L, status);
  return 1;
}

static int sheet_error(lua_State *L) {
  const bw_sheet *sheet = self(L);
  double relative = 0;
  bw_status status = bw_sheet_error(lbw_enter(L), sheet, &relative);
  lbw_leave_or_raise(L, status);
  lua_pushnumber(L, relative);
  return 1;
}

static int sheet_points(lua_State *L) {
  const bw_plane_mesh *mesh = self(L)->mesh;
  return lbw_push_borrowed(L, BW_F64, mesh->topology->nodes->node_count, 2, mesh->point, mesh);
}

static int sheet_elements(lua_State *L) {
  const bw_plane_topology *topology = self(L)->mesh->topology;
  return lbw_push_indices(L, topology->element_count, topology->nodes->order == 1 ? 3 : 6,
                          topology->element);
}

static int sheet_counts(lua_State *L) {
  const bw_plane_topology *topology = self(L)->mesh->topology;
  lua_pushinteger(L, topology->element_count);
  lua_pushinteger(L, topology->nodes->node_count);
  return 2;
}

LBW_PUSH(sheet_order, lua_pushinteger(L, self(L)->mesh->topology->nodes->order))
LBW_PUSH(sheet_time, lua_pushnumber(L, self(L)->time))
LBW_PUSH(sheet_outline, lbw_push(L, &lbw_outline_class, self(L)->mesh->outline))
LBW_PUSH(sheet_mesh, lbw_push(L, &lbw_plane_mesh_class, self(L)->mesh))

/* sheet:stress_norm(p): the norm, and its gradient by the outline's points */
static int sheet_stress_norm(lua_State *L) {
  bw_status status = BW_OK;
  bw_sheet *sheet = self(L);
  bw_mesh_motion *motion = mesh_motion_of(L);
  double p = lbw_check_number(L, 2), norm = 0;
  lua_settop(L, 2);
  bw_array *nodes = lbw_push_array(L, BW_F64, nodes_of(sheet), 2);
  bw_array *points = lbw_push_array(L, BW_F64, sheet->mesh->outline->point_count, 2);
  lbw_conditions_begin(L, 1);
  bw_context *context = lbw_enter(L);
  BW_TRY(bw_sheet_stress_gradient(context, sheet, p, &norm, (double *)nodes->data));
  BW_TRY(bw_mesh_motion_pull_back(context, motion, sheet->mesh, (const double *)nodes->data,
                                  (double *)points->data));
done:
  lua_pushnumber(L, norm);
  lua_pushvalue(L, 4);
  lua_pushvalue(L, 3);
  return lbw_leave(L, status, 3);
}

static const luaL_Reg methods[] = {
    {"follow", sheet_follow},           {"static", sheet_static},
    {"transient", sheet_transient},     {"large_deflection", sheet_large_deflection},
    {"stress_norm", sheet_stress_norm}, {"save", sheet_save},
    {"restore", sheet_restore},         {"check", sheet_check},
    {"counts", sheet_counts},           {NULL, NULL}};
static const luaL_Reg properties[] = {{"displacement", sheet_displacement},
                                      {"velocity", sheet_velocity},
                                      {"acceleration", sheet_acceleration},
                                      {"stress", sheet_stress},
                                      {"von_mises", sheet_von_mises},
                                      {"error_estimate", sheet_error},
                                      {"mesh", sheet_mesh},
                                      {"points", sheet_points},
                                      {"elements", sheet_elements},
                                      {"order", sheet_order},
                                      {"time", sheet_time},
                                      {"outline", sheet_outline},
                                      {NULL, NULL}};
static const luaL_Reg meta[] = {{NULL, NULL}};
const lbw_class lbw_sheet_class = {"sheet", methods, properties, meta, NULL};

void lbw_open_sheet(lua_State *L) {
  static const luaL_Reg functions[] = {{"create", sheet_create}, {NULL, NULL}};
  lbw_class_register(L, &lbw_sheet_class);
  lua_newtable(L);
  luaL_setfuncs(L, functions, 0);
  lua_setfield(L, -2, "sheet");
}
