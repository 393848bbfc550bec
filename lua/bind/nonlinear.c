/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* model:nonlinear, and the states that it goes through. */
#include "bind.h"

#include <math.h>
#include <stdio.h>

static const bw_nonlinear *self(lua_State *L) {
  return (const bw_nonlinear *)lbw_check(L, 1, &lbw_nonlinear_class);
}

/* The nodes nearest to the points of the option "monitor", in a userdata that is pushed. */
static void read_monitor(lua_State *L, int index, const bw_mesh *mesh,
                         bw_nonlinear_options *options) {
  int64_t count;
  if (lbw_option_get(L, index, "monitor") == LUA_TNIL)
    return;
  const double *at = lbw_to_doubles(L, -1, "option 'monitor'", 3, &count);
  if (count < 1 || count > 1000)
    lbw_error(L, "nonlinear: option 'monitor': 1 to 1000 points {x, y, z} expected, got %d",
              (int)count);
  int32_t *node = (int32_t *)lua_newuserdatauv(L, (size_t)count * sizeof *node, 0);
  for (int64_t k = 0; k < count; k++) {
    double least = INFINITY;
    node[k] = 0;
    for (int64_t i = 0; i < mesh->node_count; i++) {
      const double *x = mesh->node + 3 * i, *p = at + 3 * k;
      double d = (x[0] - p[0]) * (x[0] - p[0]) + (x[1] - p[1]) * (x[1] - p[1]) +
                 (x[2] - p[2]) * (x[2] - p[2]);
      if (d < least) {
        least = d;
        node[k] = (int32_t)i;
      }
    }
  }
  options->monitor_count = (int)count;
  options->monitor = node;
}

/* {factor, steps, arc_length, max_steps, displacement, tolerance, max_iterations, monitor} */
static int model_nonlinear(lua_State *L) {
  static const lbw_option list[] = {
      {"factor", LBW_REAL, offsetof(bw_nonlinear_options, factor)},
      {"steps", LBW_INT, offsetof(bw_nonlinear_options, steps)},
      {"arc_length", LBW_BOOLEAN, offsetof(bw_nonlinear_options, arc_length)},
      {"max_steps", LBW_INT, offsetof(bw_nonlinear_options, max_steps)},
      {"displacement", LBW_REAL, offsetof(bw_nonlinear_options, displacement)},
      {"tolerance", LBW_REAL, offsetof(bw_nonlinear_options, tolerance)},
      {"max_iterations", LBW_INT, offsetof(bw_nonlinear_options, max_iterations)},
      {"monitor", LBW_OTHER, 0},
      {NULL, LBW_OTHER, 0}};
  const bw_model *model = (const bw_model *)lbw_check(L, 1, &lbw_model_class);
  bw_nonlinear_options options;
  lua_settop(L, 2);
  bw_nonlinear_options_default(&options);
  lbw_options(L, 2, "nonlinear", list, &options);
  read_monitor(L, 2, model->mesh, &options);
  lbw_box *box = lbw_box_new(L, &lbw_nonlinear_class);
  bw_nonlinear *path = NULL;
  bw_status status = bw_nonlinear_statics(lbw_enter(L), model, &options, &path);
  return lbw_leave_object(L, box, path, status);
}

/* A column of the steps as an array. */
#define COLUMN(name, field)                                                                        \
  static int nonlinear_##name(lua_State *L) {                                                      \
    const bw_nonlinear *path = self(L);                                                            \
    double *out = (double *)lbw_push_array(L, BW_F64, path->count, 1)->data;                       \
    for (int k = 0; k < path->count; k++)                                                          \
      out[k] = (double)path->step[k].field;                                                        \
    return 1;                                                                                      \
  }
COLUMN(factors, factor)
COLUMN(residuals, residual)
COLUMN(energies, energy)
COLUMN(largest_strains, strain)
COLUMN(largest_displacements, displacement)
COLUMN(iterations, iterations)
COLUMN(cuts, cuts)
COLUMN(negative_pivots, negative)
#undef COLUMN

static int nonlinear_counted(lua_State *L) {
  const bw_nonlinear *path = self(L);
  bool counted = true;
  for (int k = 0; k < path->count; k++)
    counted &= path->step[k].counted;
  lua_pushboolean(L, counted);
  return 1;
}

static int nonlinear_factor(lua_State *L) {
  lua_pushnumber(L, self(L)->step[self(L)->count - 1].factor);
  return 1;
}

static int nonlinear_count(lua_State *L) {
  lua_pushinteger(L, self(L)->count);
  return 1;
}

static int nonlinear_ended(lua_State *L) {
  static const char *const words[] = {"factor", "displacement", "steps"};
  lua_pushstring(L, words[self(L)->end]);
  return 1;
}

static int nonlinear_displacement(lua_State *L) {
  const bw_nonlinear *path = self(L);
  return lbw_push_borrowed(L, BW_F64, path->model->mesh->node_count, 3, path->displacement, path);
}

static int nonlinear_reaction(lua_State *L) {
  const bw_nonlinear *path = self(L);
  return lbw_push_borrowed(L, BW_F64, path->model->mesh->node_count, 3, path->reaction, path);
}

/* The places of the monitored nodes. */
static int nonlinear_monitors(lua_State *L) {
  const bw_nonlinear *path = self(L);
  double *out = (double *)lbw_push_array(L, BW_F64, path->monitor_count, 3)->data;
  for (int k = 0; k < 3 * path->monitor_count; k++)
    out[k] = path->model->mesh->node[3 * (int64_t)path->monitor[k / 3] + k % 3];
  return 1;
}

/* nonlinear:path(i): displacement of a monitored node, a row for each step */
static int nonlinear_path(lua_State *L) {
  const bw_nonlinear *path = self(L);
  int64_t i = lua_isnoneornil(L, 2) ? 0 : lbw_check_index(L, 2, "monitor", path->monitor_count);
  double *out = (double *)lbw_push_array(L, BW_F64, path->count, 3)->data;
  for (int k = 0; k < 3 * path->count; k++)
    out[k] = path->monitored[3 * (k / 3 * (int64_t)path->monitor_count + i) + k % 3];
  return 1;
}

static int stress_of(lua_State *L, bool on_nodes, bool von_mises) {
  const bw_nonlinear *path = self(L);
  const bw_mesh *mesh = path->model->mesh;
  int64_t rows = on_nodes ? mesh->node_count : mesh->element_count;
  double *stress = (double *)lbw_push_array(L, BW_F64, rows, 6)->data;
  double *out = von_mises ? (double *)lbw_push_array(L, BW_F64, rows, 1)->data : NULL;
  bw_context *context = lbw_enter(L);
  bw_status status = bw_finite_stress(context, path->model, path->displacement,
                                      path->step[path->count - 1].factor, on_nodes, stress);
  if (status == BW_OK && von_mises)
    status = bw_von_mises_field(context, rows, stress, out);
  return lbw_leave(L, status, 1);
}

static int nonlinear_stress(lua_State *L) {
  return stress_of(L, true, false);
}
static int nonlinear_element_stress(lua_State *L) {
  return stress_of(L, false, false);
}
static int nonlinear_von_mises(lua_State *L) {
  return stress_of(L, true, true);
}
static int nonlinear_element_von_mises(lua_State *L) {
  return stress_of(L, false, true);
}

static int nonlinear_mesh(lua_State *L) {
  lbw_push(L, &lbw_mesh_class, self(L)->model->mesh);
  return 1;
}

static int nonlinear_report(lua_State *L) {
  lbw_push_report(L, &self(L)->report);
  return 1;
}

/* Beyond it the elasticity of small strains is no law of a real material. */
static const double LARGE_STRAIN = 0.05;

static const luaL_Reg methods[] = {{"path", nonlinear_path}, {NULL, NULL}};
static const luaL_Reg properties[] = {{"factors", nonlinear_factors},
                                      {"factor", nonlinear_factor},
                                      {"residuals", nonlinear_residuals},
                                      {"energies", nonlinear_energies},
                                      {"largest_strains", nonlinear_largest_strains},
                                      {"largest_displacements", nonlinear_largest_displacements},
                                      {"iterations", nonlinear_iterations},
                                      {"cuts", nonlinear_cuts},
                                      {"negative_pivots", nonlinear_negative_pivots},
                                      {"counted", nonlinear_counted},
                                      {"count", nonlinear_count},
                                      {"ended", nonlinear_ended},
                                      {"displacement", nonlinear_displacement},
                                      {"reaction", nonlinear_reaction},
                                      {"monitors", nonlinear_monitors},
                                      {"stress", nonlinear_stress},
                                      {"element_stress", nonlinear_element_stress},
                                      {"von_mises", nonlinear_von_mises},
                                      {"element_von_mises", nonlinear_element_von_mises},
                                      {"mesh", nonlinear_mesh},
                                      {"report", nonlinear_report},
                                      {NULL, NULL}};
/* One line each: the way, the last state, stability, what is assumed. */
static int nonlinear_tostring(lua_State *L) {
  static const char *const ends[] = {"", ", where a node has moved as far as it may",
                                     ", the largest number of steps"};
  const bw_nonlinear *path = (const bw_nonlinear *)lbw_check(L, 1, &lbw_nonlinear_class);
  const bw_nonlinear_step *last = &path->step[path->count - 1];
  int most = 0, unstable = -1, unsure = 0, top = 0;
  char text[1200];
  for (int k = 0; k < path->count; k++) {
    most = path->step[k].negative > most ? path->step[k].negative : most;
    unstable = unstable < 0 && path->step[k].negative > 0 ? k : unstable;
    unsure += !path->step[k].counted;
    top = path->step[k].factor > path->step[top].factor ? k : top;
  }
  int used = snprintf(text, sizeof text,
                      "geometrically nonlinear statics: %d step%s to load factor %.4g%s; %d "
                      "iterations, residual %.1e of load and reactions",
                      path->count, path->count == 1 ? "" : "s", last->factor, ends[path->end],
                      path->report.iterations, last->residual);
#define ADD(...) used += snprintf(text + used, sizeof text - (size_t)used, __VA_ARGS__)
  if (top < path->count - 1)
    ADD("\n  largest load factor: %.4g in step %d", path->step[top].factor, top + 1);
  ADD("\n  last state: largest displacement %s, largest strain in an element %.2g %%%s",
      lbw_quantity(last->displacement, "m").text, 100 * last->strain,
      last->strain > LARGE_STRAIN ? ", where the law of small strains is not to be trusted" : "");
  if (most == 0)
    ADD("\n  stable in each step: no negative pivots");
  else
    ADD("\n  unstable from step %d on, load factor %.4g: up to %d negative pivot%s, %d at the end",
        unstable + 1, path->step[unstable].factor, most, most == 1 ? "" : "s", last->negative);
  if (unsure > 0)
    ADD(" (uncertain in %d step%s: a pivot was near zero)", unsure, unsure == 1 ? "" : "s");
  ADD("\n  dead loads, small strains; the error of the mesh is unknown: compare two meshes");
#undef ADD
  lua_pushlstring(L, text, (size_t)used);
  return 1;
}

static const luaL_Reg meta[] = {
    {"__len", nonlinear_count}, {"__tostring", nonlinear_tostring}, {NULL, NULL}};
const lbw_class lbw_nonlinear_class = {"nonlinear", methods, properties, meta, NULL};

void lbw_open_nonlinear(lua_State *L) {
  static const luaL_Reg of_model[] = {{"nonlinear", model_nonlinear}, {NULL, NULL}};
  lbw_class_register(L, &lbw_nonlinear_class);
  lbw_add_methods(L, &lbw_model_class, of_model);
}
