/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* model:deposit: bodies that are laid down layer by layer. */
#include "bind.h"

#include <math.h>

static const bw_deposition *self(lua_State *L) {
  return (const bw_deposition *)lbw_check(L, 1, &lbw_deposition_class);
}

/* The option `layer`, one for each element, or room for it; it stays on the stack. */
static int32_t *read_layers(lua_State *L, const bw_mesh *mesh, int32_t *count) {
  int64_t rows;
  if (lbw_option_get(L, 2, "layer") == LUA_TNIL)
    return (int32_t *)lua_newuserdatauv(L, (size_t)mesh->element_count * sizeof(int32_t) + 1, 0);
  int32_t *layer = lbw_to_indices(L, lua_gettop(L), "deposit: option 'layer'", 1, &rows);
  if (rows != mesh->element_count)
    lbw_error(L, "deposit: option 'layer': %d rows expected, one for each element, got %d",
              (int)mesh->element_count, (int)rows);
  for (int64_t e = 0; e < rows; e++)
    if (layer[e] >= *count)
      *count = layer[e] < INT32_MAX ? layer[e] + 1 : layer[e];
  return layer;
}

/* The option `change`, a number or one for each node; it stays on the stack. */
static const double *read_change(lua_State *L, const bw_mesh *mesh) {
  int64_t rows;
  int type = lbw_option_get(L, 2, "change");
  if (type == LUA_TNIL)
    lbw_option_missing(L, "deposit", "change", "");
  if (type == LUA_TNUMBER) {
    double one = lua_tonumber(L, -1);
    double *change =
        (double *)lua_newuserdatauv(L, (size_t)mesh->node_count * sizeof *change + 1, 0);
    for (int32_t i = 0; i < mesh->node_count; i++)
      change[i] = one;
    return change;
  }
  const double *change = lbw_to_doubles(L, lua_gettop(L), "deposit: option 'change'", 1, &rows);
  if (rows != mesh->node_count)
    lbw_error(L,
              "deposit: option 'change': a number or %d rows expected, one for each node, got %d",
              (int)mesh->node_count, (int)rows);
  return change;
}

typedef struct by_height {
  int layers;
  double direction[3];
} by_height;

/* model:deposit{layers, direction, layer, change, solver} */
static int model_deposit(lua_State *L) {
  static const lbw_option list[] = {{"layers", LBW_INT, offsetof(by_height, layers)},
                                    {"direction", LBW_VECTOR, offsetof(by_height, direction)},
                                    {"layer", LBW_OTHER, 0},
                                    {"change", LBW_OTHER, 0},
                                    {"solver", LBW_OTHER, 0},
                                    {NULL, LBW_OTHER, 0}};
  by_height o = {0, {0, 0, 1}};
  bw_deposition_options options = {0};
  const bw_model *model = (const bw_model *)lbw_check(L, 1, &lbw_model_class);
  lbw_check_type(L, 2, LUA_TTABLE);
  lua_settop(L, 2);
  lbw_options(L, 2, "deposit", list, &o);
  bool counted = lbw_option_get(L, 2, "layers") != LUA_TNIL;
  bool given = lbw_option_get(L, 2, "layer") != LUA_TNIL;
  if (counted == given)
    return lbw_error(L, "deposit: one of the options 'layers' and 'layer' expected, got %s",
                     counted ? "both" : "none");
  if (given && lbw_option_get(L, 2, "direction") != LUA_TNIL)
    return lbw_error(L, "deposit: option 'direction': it goes with 'layers', not with 'layer'");
  options.solver = lbw_solver_option(L, 2, "deposit");
  options.layer_count = o.layers;
  int32_t *layer = read_layers(L, model->mesh, &options.layer_count);
  options.layer = layer;
  options.change = read_change(L, model->mesh);
  lbw_box *box = lbw_box_new(L, &lbw_deposition_class);
  bw_context *context = lbw_enter(L);
  bw_deposition *deposition = NULL;
  bw_status status =
      given ? BW_OK : bw_deposition_layers(context, model->mesh, o.direction, o.layers, layer);
  if (status == BW_OK)
    status = bw_deposit(context, model, &options, &deposition);
  return lbw_leave_object(L, box, deposition, status);
}

/* deposition:release(model, {solver}) */
static int deposition_release(lua_State *L) {
  static const lbw_option list[] = {{"solver", LBW_OTHER, 0}, {NULL, LBW_OTHER, 0}};
  const bw_deposition *deposition = self(L);
  const bw_model *model = (const bw_model *)lbw_check(L, 2, &lbw_model_class);
  bw_deposition *released = NULL;
  lua_settop(L, 3);
  lbw_options(L, 3, "release", list, &released);
  const bw_solver *solver = lbw_solver_option(L, 3, "release");
  lbw_box *box = lbw_box_new(L, &lbw_deposition_class);
  bw_status status = bw_deposition_release(lbw_enter(L), deposition, model, solver, &released);
  return lbw_leave_object(L, box, released, status);
}

static int deposition_displacement(lua_State *L) {
  const bw_deposition *d = self(L);
  return lbw_push_borrowed(L, BW_F64, d->model->mesh->node_count, 3, d->displacement, d);
}

static int deposition_element_stress(lua_State *L) {
  const bw_deposition *d = self(L);
  return lbw_push_borrowed(L, BW_F64, d->model->mesh->element_count, 6, d->element_stress, d);
}

static int deposition_element_von_mises(lua_State *L) {
  const bw_deposition *d = self(L);
  int64_t count = d->model->mesh->element_count;
  double *out = (double *)lbw_push_array(L, BW_F64, count, 1)->data;
  return lbw_leave(L, bw_von_mises_field(lbw_enter(L), count, d->element_stress, out), 1);
}

static int deposition_reaction(lua_State *L) {
  const bw_deposition *d = self(L);
  return lbw_push_borrowed(L, BW_F64, d->model->mesh->node_count, 3, d->reaction, d);
}

static int deposition_layer(lua_State *L) {
  const bw_deposition *d = self(L);
  return lbw_push_indices(L, d->model->mesh->element_count, 1, d->layer);
}

static int deposition_layers(lua_State *L) {
  lua_pushinteger(L, self(L)->layer_count);
  return 1;
}

static int deposition_postponed(lua_State *L) {
  lua_pushinteger(L, self(L)->postponed);
  return 1;
}

static int deposition_postponed_volume(lua_State *L) {
  lua_pushnumber(L, self(L)->postponed_volume);
  return 1;
}

static int deposition_residual(lua_State *L) {
  lua_pushnumber(L, self(L)->residual);
  return 1;
}

static int deposition_mesh(lua_State *L) {
  lbw_push(L, &lbw_mesh_class, self(L)->model->mesh);
  return 1;
}

static int deposition_tostring(lua_State *L) {
  const bw_deposition *d = (const bw_deposition *)lbw_check(L, 1, &lbw_deposition_class);
  const bw_mesh *mesh = d->model->mesh;
  double moved = 0, stress = 0, size;
  for (int64_t i = 0; i < mesh->node_count; i++) {
    const double *u = d->displacement + 3 * i;
    moved = fmax(moved, sqrt(u[0] * u[0] + u[1] * u[1] + u[2] * u[2]));
  }
  for (int64_t e = 0; e < mesh->element_count; e++) {
    const double *s = d->element_stress + 6 * e;
    size = (s[0] - s[1]) * (s[0] - s[1]) + (s[1] - s[2]) * (s[1] - s[2]) +
           (s[2] - s[0]) * (s[2] - s[0]) + 6 * (s[3] * s[3] + s[4] * s[4] + s[5] * s[5]);
    stress = fmax(stress, sqrt(size / 2));
  }
  lua_pushfstring(L,
                  "deposition in %d layer%s: von Mises stress up to %s, displacement up to %s; "
                  "linear elasticity without yielding, " LBW_ERROR_UNKNOWN,
                  d->layer_count, d->layer_count == 1 ? "" : "s", lbw_quantity(stress, "Pa").text,
                  lbw_quantity(moved, "m").text);
  return 1;
}

static const luaL_Reg methods[] = {{"release", deposition_release}, {NULL, NULL}};
static const luaL_Reg properties[] = {{"displacement", deposition_displacement},
                                      {"element_stress", deposition_element_stress},
                                      {"element_von_mises", deposition_element_von_mises},
                                      {"reaction", deposition_reaction},
                                      {"layer", deposition_layer},
                                      {"layers", deposition_layers},
                                      {"postponed", deposition_postponed},
                                      {"postponed_volume", deposition_postponed_volume},
                                      {"residual", deposition_residual},
                                      {"mesh", deposition_mesh},
                                      {NULL, NULL}};
static const luaL_Reg meta[] = {{"__tostring", deposition_tostring}, {NULL, NULL}};
const lbw_class lbw_deposition_class = {"deposition", methods, properties, meta, NULL};

void lbw_open_deposition(lua_State *L) {
  static const luaL_Reg of_model[] = {{"deposit", model_deposit}, {NULL, NULL}};
  lbw_class_register(L, &lbw_deposition_class);
  lbw_add_methods(L, &lbw_model_class, of_model);
}
