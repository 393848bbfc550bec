/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* bw.model: a mesh of a material, its supports and its loads. The box keeps the last system (the
 * equations and their factor), so that what follows a solve reuses it. */
#include "bind.h"

#include <stdio.h>
#include <string.h>

static bw_model *self(lua_State *L) {
  return (bw_model *)lbw_check(L, 1, &lbw_model_class);
}

/* The result of a method that changes the model: the model itself, so that calls can be chained. */
static int leave_self(lua_State *L, bw_status status) {
  lua_pushvalue(L, 1);
  return lbw_leave(L, status, 1);
}

static const bw_selection *check_selection(lua_State *L, int argument) {
  return (const bw_selection *)lbw_check(L, argument, &lbw_selection_class);
}

static bool option_present(lua_State *L, const char *key) {
  bool present = lbw_option_get(L, 2, key) != LUA_TNIL;
  lua_pop(L, 1);
  return present;
}

static const bw_selection *selection_option(lua_State *L, const char *function, const char *key) {
  lbw_option_get(L, 2, key);
  const bw_selection *on = (const bw_selection *)lbw_test(L, -1, &lbw_selection_class);
  if (!on)
    lbw_option_refused(L, function, key, "an open selection");
  return on; /* the table of options keeps it */
}

static const char *const formulations[] = {"standard", "b_bar", NULL};

/* model{mesh, material or materials, formulation} */
static int model_new(lua_State *L) {
  static const lbw_option list[] = {{"mesh", LBW_OTHER, 0},
                                    {"material", LBW_OTHER, 0},
                                    {"materials", LBW_OTHER, 0},
                                    {"formulation", LBW_OTHER, 0},
                                    {NULL, LBW_OTHER, 0}};
  lbw_check_type(L, 1, LUA_TTABLE);
  lua_settop(L, 1);
  lbw_options(L, 1, "model", list, NULL);
  const bw_material *material;
  const bw_mesh *mesh = lbw_check_body(L, "model", &material);
  bw_formulation formulation = (bw_formulation)lbw_word_option(
      L, 1, "model", "formulation", formulations, (int)material->formulation);
  lbw_box *box = lbw_box_new(L, &lbw_model_class);
  bw_model *model = NULL;
  bw_context *context = lbw_enter(L);
  bw_status status = bw_model_create(context, mesh, material, &model);
  lbw_box_fill(L, box, model);
  if (status == BW_OK && formulation != material->formulation)
    status = bw_model_formulate(context, model, formulation);
  if (status == BW_GEOMETRY)
    lbw_leave_or_raise(L, status);
  return lbw_leave(L, status, 1);
}

/* ---- supports -------------------------------------------------------------------------------- */

static const char *const symmetries[] = {"symmetric", "antisymmetric", NULL};

/* model:fix(selection) */
static int model_fix(lua_State *L) {
  bw_model *model = self(L);
  const bw_selection *on = check_selection(L, 2);
  return leave_self(L, bw_model_fix(lbw_enter(L), model, on));
}

/* model:slide(selection, normal): free along the surface, or across `normal` */
static int model_slide(lua_State *L) {
  bw_model *model = self(L);
  const bw_selection *on = check_selection(L, 2);
  double normal[3];
  bool given = !lua_isnoneornil(L, 3);
  if (given)
    lbw_check_vector(L, 3, "normal", normal);
  return leave_self(L, bw_model_slide(lbw_enter(L), model, on, given ? normal : NULL));
}

/* model:symmetry(selection, kind): a plane of symmetry or antisymmetry */
static int model_symmetry(lua_State *L) {
  bw_model *model = self(L);
  const bw_selection *on = check_selection(L, 2);
  int kind = BW_SYMMETRIC;
  if (!lua_isnoneornil(L, 3))
    kind += lbw_check_word(L, 3, symmetries);
  return leave_self(L, bw_model_symmetry(lbw_enter(L), model, on, (bw_symmetry)kind));
}

/* model:prescribe(selection, {x, y, z}): metres; false leaves a direction free.
 * model:prescribe(selection, field): a row of three for every node of the mesh */
static int model_prescribe(lua_State *L) {
  bw_model *model = self(L);
  const bw_selection *on = check_selection(L, 2);
  bool fixed[3] = {true, true, true};
  double value[3] = {0, 0, 0};
  const bw_array *field = (const bw_array *)lbw_test(L, 3, &lbw_array_class);
  if (field) {
    lbw_argument_check(L, field->columns == 3, 3,
                       "displacement: an array of three columns expected");
    lbw_check_rows(L, 3, "displacement", field->rows, model->mesh->node_count, "node");
    return leave_self(L, bw_model_prescribe_field(lbw_enter(L), model, on, fixed, field));
  }
  bool fits = lua_istable(L, 3) && lua_rawlen(L, 3) == 3;
  for (int i = 0; i < 3 && fits; i++) {
    int type = lua_rawgeti(L, 3, i + 1);
    fixed[i] = type == LUA_TNUMBER;
    value[i] = fixed[i] ? lua_tonumber(L, -1) : 0;
    fits = fixed[i] || (type == LUA_TBOOLEAN && !lua_toboolean(L, -1));
    lua_pop(L, 1);
  }
  lbw_argument_check(
      L, fits, 3,
      "displacement: {x, y, z} in metres, false where a direction is free, or an array of three "
      "columns expected");
  return leave_self(L, bw_model_prescribe(lbw_enter(L), model, on, fixed, value));
}

static int model_clear_supports(lua_State *L) {
  bw_model_clear_supports(self(L));
  lua_settop(L, 1);
  return 1;
}

/* ---- bonds ----------------------------------------------------------------------------------- */

/* model:bond{a = selection, b = selection, gap = , preload = or shortening = } */
static int model_bond(lua_State *L) {
  struct bond {
    double gap, preload, shortening;
  } bond = {.gap = -1};
  static const lbw_option list[] = {{"a", LBW_OTHER, 0},
                                    {"b", LBW_OTHER, 0},
                                    {"gap", LBW_REAL, offsetof(struct bond, gap)},
                                    {"preload", LBW_REAL, offsetof(struct bond, preload)},
                                    {"shortening", LBW_REAL, offsetof(struct bond, shortening)},
                                    {NULL, LBW_OTHER, 0}};
  bw_model *model = self(L);
  lbw_check_type(L, 2, LUA_TTABLE);
  lua_settop(L, 2);
  lbw_options(L, 2, "bond", list, &bond);
  if (lbw_option_get(L, 2, "gap") != LUA_TNIL && bond.gap < 0)
    return lbw_error(L, "bond: option 'gap': 0 or more expected");
  bool preload = option_present(L, "preload"), shortening = option_present(L, "shortening");
  if (preload && shortening)
    return lbw_error(L, "bond: one of the options 'preload' and 'shortening' expected, not both");
  const bw_selection *a = selection_option(L, "bond", "a"), *b = selection_option(L, "bond", "b");
  bw_preload_kind kind = preload      ? BW_PRELOAD_FORCE
                         : shortening ? BW_PRELOAD_SHORTENING
                                      : BW_NO_PRELOAD;
  return leave_self(L, bw_model_preload(lbw_enter(L), model, a, b, bond.gap, kind,
                                        preload ? bond.preload : bond.shortening));
}

static int model_clear_bonds(lua_State *L) {
  bw_model_clear_bonds(self(L));
  lua_settop(L, 1);
  return 1;
}

/* ---- attachments ----------------------------------------------------------------------------- */

/* model:attach{on = selection, mass = } or model:attach{on = selection, spring = {x, y, z}} */
static int model_attach(lua_State *L) {
  struct attach {
    double mass, spring[3];
  } attach = {0};
  static const lbw_option list[] = {{"on", LBW_OTHER, 0},
                                    {"mass", LBW_REAL, offsetof(struct attach, mass)},
                                    {"spring", LBW_VECTOR, offsetof(struct attach, spring)},
                                    {NULL, LBW_OTHER, 0}};
  bw_model *model = self(L);
  lbw_check_type(L, 2, LUA_TTABLE);
  lua_settop(L, 2);
  lbw_options(L, 2, "attach", list, &attach);
  bool mass = option_present(L, "mass");
  if (mass == option_present(L, "spring"))
    return lbw_error(L, "attach: one of the options 'mass' and 'spring' expected");
  const bw_selection *on = selection_option(L, "attach", "on");
  bw_context *context = lbw_enter(L);
  return leave_self(L, mass ? bw_model_attach_mass(context, model, on, attach.mass)
                            : bw_model_attach_spring(context, model, on, attach.spring));
}

static int model_clear_attachments(lua_State *L) {
  bw_model *model = self(L);
  return leave_self(L, bw_model_clear_attachments(lbw_enter(L), model));
}

/* ---- couplings ------------------------------------------------------------------------------- */

static const char *const coupling_kinds[] = {"rigid", "distributed", NULL};

/* Numbers for what is prescribed, false for what is free. */
static void read_prescribed(lua_State *L, const char *key, const char *unit, bool *fixed,
                            double *value) {
  int type = lbw_option_get(L, 2, key);
  bool fits = type == LUA_TNIL || (type == LUA_TTABLE && lua_rawlen(L, -1) == 3);
  for (int i = 0; type == LUA_TTABLE && fits && i < 3; i++) {
    int of = lua_rawgeti(L, -1, i + 1);
    fixed[i] = of == LUA_TNUMBER;
    value[i] = fixed[i] ? lua_tonumber(L, -1) : 0;
    fits = fixed[i] || (of == LUA_TBOOLEAN && !lua_toboolean(L, -1));
    lua_pop(L, 1);
  }
  if (!fits) {
    lua_pushfstring(L, "{x, y, z} in %s, false where a component is free,", unit);
    lua_insert(L, -2);
    lbw_option_refused(L, "couple", key, lua_tostring(L, -2));
  }
  lua_pop(L, 1);
}

/* {xx, yy, zz} or {xx, yy, zz, yz, zx, xy} */
static void read_inertia(lua_State *L, double inertia[9]) {
  static const int place[6][2] = {{0, 0}, {4, 4}, {8, 8}, {5, 7}, {2, 6}, {1, 3}};
  int type = lbw_option_get(L, 2, "inertia");
  lua_Unsigned count = type == LUA_TTABLE ? lua_rawlen(L, -1) : 0;
  bool fits = type == LUA_TNIL || count == 3 || count == 6;
  for (lua_Unsigned i = 0; fits && i < count; i++) {
    fits = lua_rawgeti(L, -1, (lua_Integer)i + 1) == LUA_TNUMBER;
    inertia[place[i][0]] = inertia[place[i][1]] = lua_tonumber(L, -1);
    lua_pop(L, 1);
  }
  if (!fits)
    lbw_option_refused(L, "couple", "inertia", "three or six numbers {xx, yy, zz, yz, zx, xy}");
  lua_pop(L, 1);
}

/* model:couple{on, kind, at, force, moment, mass, inertia, spring, rotational_spring, displacement,
 * rotation} */
static int model_couple(lua_State *L) {
  bw_remote_point point = {0};
  static const lbw_option list[] = {
      {"on", LBW_OTHER, 0},
      {"kind", LBW_OTHER, 0},
      {"at", LBW_VECTOR, offsetof(bw_remote_point, at)},
      {"force", LBW_VECTOR, offsetof(bw_remote_point, load)},
      {"moment", LBW_VECTOR, offsetof(bw_remote_point, load) + 3 * sizeof(double)},
      {"mass", LBW_REAL, offsetof(bw_remote_point, mass)},
      {"inertia", LBW_OTHER, 0},
      {"spring", LBW_VECTOR, offsetof(bw_remote_point, spring)},
      {"rotational_spring", LBW_VECTOR, offsetof(bw_remote_point, spring) + 3 * sizeof(double)},
      {"displacement", LBW_OTHER, 0},
      {"rotation", LBW_OTHER, 0},
      {NULL, LBW_OTHER, 0}};
  bw_model *model = self(L);
  lbw_check_type(L, 2, LUA_TTABLE);
  lua_settop(L, 2);
  lbw_options(L, 2, "couple", list, &point);
  point.kind =
      (bw_coupling_kind)lbw_word_option(L, 2, "couple", "kind", coupling_kinds, BW_DISTRIBUTED);
  read_prescribed(L, "displacement", "metres", point.fixed, point.displacement);
  read_prescribed(L, "rotation", "radians", point.fixed + 3, point.displacement + 3);
  read_inertia(L, point.inertia);
  bool placed = option_present(L, "at");
  const bw_selection *on = selection_option(L, "couple", "on");
  if (!placed)
    bw_selection_centre(on, point.at);
  return leave_self(L, bw_model_couple(lbw_enter(L), model, on, &point));
}

static int model_clear_couplings(lua_State *L) {
  bw_model *model = self(L);
  return leave_self(L, bw_model_clear_couplings(lbw_enter(L), model));
}

/* ---- cyclic symmetry ------------------------------------------------------------------------- */

/* model:cyclic{low = selection, high = selection, count = , axis = , about = } */
static int model_cyclic(lua_State *L) {
  struct cyclic {
    int count;
    double axis[3], about[3];
  } cyclic = {.axis = {0, 0, 1}};
  static const lbw_option list[] = {{"low", LBW_OTHER, 0},
                                    {"high", LBW_OTHER, 0},
                                    {"count", LBW_INT, offsetof(struct cyclic, count)},
                                    {"axis", LBW_VECTOR, offsetof(struct cyclic, axis)},
                                    {"about", LBW_VECTOR, offsetof(struct cyclic, about)},
                                    {NULL, LBW_OTHER, 0}};
  bw_model *model = self(L);
  lbw_check_type(L, 2, LUA_TTABLE);
  lua_settop(L, 2);
  lbw_options(L, 2, "cyclic", list, &cyclic);
  if (!option_present(L, "count"))
    return lbw_error(L, "cyclic: option 'count' is missing: the number of sectors of the whole");
  const bw_selection *low = selection_option(L, "cyclic", "low"),
                     *high = selection_option(L, "cyclic", "high");
  return leave_self(
      L, bw_model_cyclic(lbw_enter(L), model, low, high, cyclic.count, cyclic.axis, cyclic.about));
}

/* model:whole() */
static int model_whole(lua_State *L) {
  const bw_model *sector = self(L);
  lbw_box *box = lbw_box_new(L, &lbw_model_class);
  bw_model *whole = NULL;
  bw_status status = bw_model_whole(lbw_enter(L), sector, &whole);
  lbw_box_fill(L, box, whole);
  return lbw_leave(L, status, 1);
}

static int model_clear_cyclic(lua_State *L) {
  bw_model_clear_cyclic(self(L));
  lua_settop(L, 1);
  return 1;
}

/* ---- loads ----------------------------------------------------------------------------------- */

/* model:gravity{x, y, z} */
static int model_gravity(lua_State *L) {
  bw_model *model = self(L);
  double acceleration[3];
  lbw_check_vector(L, 2, "acceleration", acceleration);
  return leave_self(L, bw_model_gravity(lbw_enter(L), model, acceleration));
}

enum load_bit {
  PRESSURE = 1,
  FORCE = 2,
  TRACTION = 4,
  TORQUE = 8,
  NODAL = 16,
  ABOUT = 32,
  NET_FORCE = 64
};

/* model:load{on = selection, force = | traction = | pressure = | torque =, about =,
 * net_force = } or model:load{nodal = array} */
static int model_load(lua_State *L) {
  struct load {
    double pressure, force[3], traction[3], torque[3], about[3];
    bool net_force;
  } load = {.net_force = false};
  static const lbw_option list[] = {{"on", LBW_OTHER, 0},
                                    {"pressure", LBW_REAL, offsetof(struct load, pressure)},
                                    {"force", LBW_VECTOR, offsetof(struct load, force)},
                                    {"traction", LBW_VECTOR, offsetof(struct load, traction)},
                                    {"torque", LBW_VECTOR, offsetof(struct load, torque)},
                                    {"about", LBW_VECTOR, offsetof(struct load, about)},
                                    {"net_force", LBW_BOOLEAN, offsetof(struct load, net_force)},
                                    {"nodal", LBW_OTHER, 0},
                                    {NULL, LBW_OTHER, 0}};
  static const char *const kinds[] = {"pressure", "force", "traction", "torque",
                                      "nodal",    "about", "net_force"};
  bw_model *model = self(L);
  lbw_check_type(L, 2, LUA_TTABLE);
  lua_settop(L, 2);
  lbw_options(L, 2, "load", list, &load);
  int given = 0;
  for (int i = 0; i < 7; i++)
    given |= option_present(L, kinds[i]) << i;
  int kind = given & ~(ABOUT | NET_FORCE);
  if (kind == 0 || (kind & (kind - 1)))
    return lbw_error(
        L,
        "load: one of the options 'force', 'traction', 'pressure', 'torque' and 'nodal' expected");
  if ((given & ABOUT) && kind != TORQUE)
    return lbw_error(L, "load: option 'about' goes with 'torque' only");
  if ((given & NET_FORCE) && kind != TORQUE)
    return lbw_error(L, "load: option 'net_force' goes with 'torque' only");
  if (load.net_force && !(given & ABOUT))
    return lbw_error(L,
                     "load: option 'net_force' needs the point of the torque: about = {x, y, z}");
  if (kind == NODAL) {
    lbw_option_get(L, 2, "nodal");
    const bw_array *nodal = (const bw_array *)lbw_test(L, -1, &lbw_array_class);
    if (!nodal || nodal->rows != model->mesh->node_count || nodal->columns != 3)
      return lbw_error(
          L, "load: option 'nodal': an array of %d x 3 expected, a row for each node, got %s",
          (int)model->mesh->node_count, lbw_got(L, -1));
    return leave_self(L, bw_model_nodal_forces(lbw_enter(L), model, nodal));
  }
  lbw_option_get(L, 2, "on");
  const bw_selection *on = (const bw_selection *)lbw_test(L, -1, &lbw_selection_class);
  if (!on)
    return lbw_error(L, "load: option 'on': an open selection expected, got %s", lbw_got(L, -1));
  bw_context *context = lbw_enter(L);
  bw_status status;
  if (kind == PRESSURE)
    status = bw_model_pressure(context, model, on, load.pressure);
  else if (kind == FORCE)
    status = bw_model_force(context, model, on, load.force);
  else if (kind == TRACTION)
    status = bw_model_traction(context, model, on, load.traction);
  else
    status = bw_model_torque(context, model, on, load.torque, load.net_force ? load.about : NULL);
  return leave_self(L, status);
}

/* model:temperature(change, expansion): kelvin at every node, or one number for all; 1/K, without
 * it those of the materials */
static int model_temperature(lua_State *L) {
  bw_model *model = self(L);
  bool given = !lua_isnoneornil(L, 3);
  double expansion = given ? lbw_check_real(L, 3, "expansion") : 0;
  lua_settop(L, 3);
  if (lua_type(L, 2) == LUA_TNUMBER) {
    double change = lua_tonumber(L, 2);
    double *out = (double *)lbw_push_array(L, BW_F64, model->mesh->node_count, 1)->data;
    for (int32_t i = 0; i < model->mesh->node_count; i++)
      out[i] = change;
    lua_replace(L, 2);
  }
  const bw_array *change = lbw_check_array(L, 2, "change");
  lbw_check_rows(L, 2, "change", change->rows, model->mesh->node_count, "node");
  lbw_argument_check(L, change->columns == 1, 2, "change: an array of one column expected");
  return leave_self(L,
                    bw_model_temperature(lbw_enter(L), model, change, given ? &expansion : NULL));
}

static int model_clear_loads(lua_State *L) {
  bw_model_clear_loads(self(L));
  lua_settop(L, 1);
  return 1;
}

/* ---- asking ---------------------------------------------------------------------------------- */

static int model_write_inp(lua_State *L) {
  int modes = 0;
  static const lbw_option list[] = {{"modes", LBW_INT, 0}, {NULL, LBW_OTHER, 0}};
  bw_model *model = self(L);
  const char *path = lbw_check_text(L, 2, NULL);
  lbw_options(L, 3, "write_inp", list, &modes);
  bw_status status = bw_model_write_inp(lbw_enter(L), model, path, modes);
  lua_pushboolean(L, 1);
  return lbw_leave(L, status, 1);
}

/* model:force_vector(): consistent nodal forces of all loads */
static int model_force_vector(lua_State *L) {
  bw_model *model = self(L);
  bw_array *force = lbw_push_array(L, BW_F64, model->mesh->node_count, 3);
  return lbw_leave(L, bw_model_force_vector(lbw_enter(L), model, (double *)force->data), 1);
}

static int push_motions(lua_State *L) {
  const bw_dof_map *dof_map = (const bw_dof_map *)lua_touserdata(L, 1);
  lua_createtable(L, dof_map->rigid_mode_count, 0);
  for (int32_t m = 0; m < dof_map->rigid_mode_count; m++) {
    const bw_rigid_mode *motion = &dof_map->rigid_mode[m];
    lua_createtable(L, 0, 5);
    lua_pushinteger(L, (lua_Integer)motion->component + 1);
    lua_setfield(L, -2, "component");
    lbw_push_vector(L, motion->centre);
    lua_setfield(L, -2, "centre");
    lbw_push_vector(L, motion->translation);
    lua_setfield(L, -2, "translation");
    lbw_push_vector(L, motion->rotation);
    lua_setfield(L, -2, "rotation");
    lua_pushstring(L, motion->text);
    lua_setfield(L, -2, "text");
    lua_rawseti(L, -2, m + 1);
  }
  return 1;
}

/* model:rigid_modes(): the rigid-body modes that the supports do not prevent */
static int model_rigid_modes(lua_State *L) {
  bw_model *model = self(L);
  bw_dof_map *dof_map = NULL;
  bw_status status = bw_dof_map_create(lbw_enter(L), model, &dof_map);
  if (status != BW_OK)
    return lbw_leave(L, status, 0);
  lbw_state_of(L)->running = 0;
  lua_pushcfunction(L, push_motions);
  lua_pushlightuserdata(L, dof_map);
  int failure = lua_pcall(L, 1, 1, 0);
  bw_release(dof_map);
  return failure ? lua_error(L) : lbw_leave(L, BW_OK, 1);
}

/* ---- the system ------------------------------------------------------------------------------ */

/* An option that only some of the solvers have. */
static void check_belongs(lua_State *L, const char *function, const char *key, bool belongs,
                          const char *to) {
  if (!belongs && lbw_option_get(L, 2, key) != LUA_TNIL)
    lbw_error(L, "%s: option '%s' goes with %s only", function, key, to);
  lua_settop(L, 2);
}

/* Loads barwright.distributed, which registers the solver. On failure nil, message, details are on
 * the stack. */
static bool external_ready(lua_State *L) {
  int top = lua_gettop(L);
  lua_getglobal(L, "require");
  lua_pushliteral(L, "barwright.distributed");
  int failure = lua_pcall(L, 1, 1, 0);
  if (failure == LUA_OK) {
    lua_getfield(L, -1, "ready");
    lua_call(L, 0, 3);
    if (!lua_isnil(L, -3)) {
      lua_settop(L, top);
      return true;
    }
    lua_remove(L, top + 1);
    return false;
  }
  lua_pushnil(L);
  lua_insert(L, -2);
  lua_createtable(L, 0, 1);
  lua_pushstring(L, bw_status_word(BW_UNSUPPORTED));
  lua_setfield(L, -2, "status");
  return false;
}

/* The equations that may be reused: the model's own, or else those of the option `former`. */
static bw_system *former(lua_State *L, const lbw_box *model, const char *function) {
  bw_system *system = (bw_system *)model->extra;
  int kind = lbw_option_get(L, 2, "former");
  const bw_static *solution = (const bw_static *)lbw_test(L, -1, &lbw_static_class);
  if (kind != LUA_TNIL && !system) {
    system = (bw_system *)lbw_test(L, -1, &lbw_system_class);
    if (lbw_test(L, -1, &lbw_model_class))
      system = (bw_system *)((const lbw_box *)lua_touserdata(L, -1))->extra;
    else if (solution)
      system = solution->system;
    else if (!system)
      lbw_option_refused(L, function, "former", "a part, a static solution or a system");
  }
  lua_settop(L, 2); /* the table of options keeps it */
  return system;
}

/* model:solve{inertia_relief, balance_tolerance, solver, memory_limit, write, former} */
static int model_solve(lua_State *L) {
  static const lbw_option list[] = {
      {"inertia_relief", LBW_BOOLEAN, offsetof(bw_statics_options, inertia_relief)},
      {"balance_tolerance", LBW_REAL, offsetof(bw_statics_options, tolerance)},
      {"memory_limit", LBW_REAL, offsetof(bw_statics_options, memory)},
      {"solver", LBW_OTHER, 0},
      {"write", LBW_OTHER, 0},
      {"former", LBW_OTHER, 0},
      {NULL, LBW_OTHER, 0}};
  bw_statics_options options = {.tolerance = 1e-6};
  lbw_box *model = lbw_check_box(L, 1, &lbw_model_class);
  lua_settop(L, 2);
  lbw_options(L, 2, "solve", list, &options);
  options.solver = lbw_solver_option(L, 2, "solve");
  bool external = lbw_solver_is_external(options.solver);
  bool factor = options.solver && options.solver->options.kind == BW_SOLVER_CHOLESKY && !external;
  check_belongs(L, "solve", "memory_limit", !options.solver || factor,
                "a factor on this machine (bw.solver.cholesky), or no solver");
  check_belongs(L, "solve", "write", external,
                "a solver of the backend petsc; others: static:write");
  if (external && lbw_option_get(L, 2, "write") != LUA_TNIL) {
    if (lua_type(L, -1) != LUA_TSTRING)
      lbw_option_refused(L, "solve", "write", "the path of a .pvtu file");
    options.output = lua_tostring(L, -1); /* the table of options keeps it */
  }
  bw_system *given = former(L, model, "solve");
  if (external && !external_ready(L))
    return 3;
  lbw_box *box = lbw_box_new(L, &lbw_static_class);
  bw_static *result = NULL;
  const bw_model *of = (const bw_model *)model->object;
  bw_context *context = lbw_enter(L);
  bw_status status = bw_model_joined(of) ? bw_joined_statics(context, of, &options, &result)
                                         : bw_statics(context, of, given, &options, &result);
  if (status == BW_OK && result->system && result->system != model->extra) {
    bw_release(model->extra);
    model->extra = bw_retain(result->system);
  }
  lbw_box_fill(L, box, result);
  if (status == BW_OK)
    lbw_box_account(L, model);
  return lbw_leave(L, status, 1);
}

/* The option `nodal_diameter`: "all" or a number of them. */
static int nodal_diameter(lua_State *L, const bw_cyclic *cyclic, bool laplacian) {
  int type = lbw_option_get(L, 2, "nodal_diameter"), whole = 0;
  int64_t value = lua_tointegerx(L, -1, &whole);
  const char *word = type == LUA_TSTRING ? lua_tostring(L, -1) : "";
  if (cyclic && laplacian)
    return lbw_error(L, "modes: modes of the Laplacian know no cyclic symmetry: leave 'laplacian' "
                        "out, or clear the cyclic symmetry");
  if (type != LUA_TNIL && !cyclic)
    return lbw_error(L, "modes: option 'nodal_diameter' goes with cyclic symmetry only: give the "
                        "model one with cyclic");
  bool all = type == LUA_TNIL || strcmp(word, "all") == 0;
  if (!all && !(type == LUA_TNUMBER && whole && value >= 0 && value <= INT32_MAX))
    lbw_option_refused(L, "modes", "nodal_diameter", "\"all\" or an integer, 0 or more");
  lua_settop(L, 2);
  return all ? -1 : (int)value;
}

/* model:modes{count, tolerance, sturm, seed, laplacian, solver, former, nodal_diameter} */
static int model_modes(lua_State *L) {
  struct opts {
    bw_modes_options options;
    bool laplacian;
  } opts = {.laplacian = false};
  static const lbw_option list[] = {
      {"count", LBW_INT, offsetof(struct opts, options.count)},
      {"tolerance", LBW_REAL, offsetof(struct opts, options.tolerance)},
      {"sturm", LBW_BOOLEAN, offsetof(struct opts, options.sturm)},
      {"seed", LBW_SEED, offsetof(struct opts, options.seed)},
      {"laplacian", LBW_BOOLEAN, offsetof(struct opts, laplacian)},
      {"nodal_diameter", LBW_OTHER, 0},
      {"solver", LBW_OTHER, 0},
      {"former", LBW_OTHER, 0},
      {NULL, LBW_OTHER, 0}};
  lbw_box *model = lbw_check_box(L, 1, &lbw_model_class);
  lua_settop(L, 2);
  bw_modes_options_default(&opts.options);
  lbw_options(L, 2, "modes", list, &opts);
  opts.options.nodal_diameter =
      nodal_diameter(L, ((const bw_model *)model->object)->cyclic, opts.laplacian);
  const bw_eigensolver *solver = lbw_eigensolver_option(L, 2, "modes");
  bool external = solver && solver->options.kind == BW_EIGENSOLVER_SLEPC;
  if (external && opts.laplacian)
    return lbw_error(L, "modes: eigensolver slepc does not compute modes of the Laplacian: leave "
                        "out 'laplacian' or 'solver'");
  if (external && !external_ready(L))
    return 3;
  opts.options.solver = solver;
  bw_system *given = former(L, model, "modes");
  lbw_box *box = lbw_box_new(L, &lbw_modes_class);
  const bw_model *of = (const bw_model *)model->object;
  bw_system *system = NULL;
  bw_modes *modes = NULL;
  bw_status status;
  bw_context *context = lbw_enter(L);
  if (opts.laplacian) {
    bw_block_pattern *pattern =
        given && given->mesh == of->mesh ? (bw_block_pattern *)bw_retain(given->pattern) : NULL;
    status = pattern ? BW_OK : bw_block_pattern_create(context, of->mesh, &pattern);
    if (status == BW_OK)
      status = bw_modes_laplacian(context, of->mesh, pattern, &opts.options, &modes);
    bw_release(pattern);
  } else if (bw_model_joined(of))
    status = bw_joined_modes(context, of, &opts.options, &modes);
  else {
    status = bw_modes_of_model(context, of, given, &opts.options, &system, &modes);
    if (system) {
      bw_release(model->extra);
      model->extra = system;
    }
  }
  lbw_box_fill(L, box, modes);
  lbw_box_account(L, model);
  return lbw_leave(L, status, 1);
}

/* model:system{solver, former}: the equations, those it has or new ones that reuse what they can,
 * ready for many right-hand sides. The model's box holds the reference. */
static int model_system(lua_State *L) {
  static const lbw_option list[] = {
      {"solver", LBW_OTHER, 0}, {"former", LBW_OTHER, 0}, {NULL, LBW_OTHER, 0}};
  lbw_box *model = lbw_check_box(L, 1, &lbw_model_class);
  lua_settop(L, 2);
  lbw_options(L, 2, "system", list, NULL);
  const bw_solver *solver = lbw_solver_option(L, 2, "system");
  bw_system *given = former(L, model, "system");
  if (lbw_solver_is_external(solver) && !external_ready(L))
    return 3;
  lbw_box *box = lbw_box_new(L, &lbw_system_class);
  bw_system *system = NULL;
  bw_status status =
      bw_system_of_model(lbw_enter(L), (const bw_model *)model->object, solver, given, &system);
  if (status == BW_OK) {
    bw_release(model->extra);
    model->extra = bw_retain(system);
  }
  lbw_box_fill(L, box, system);
  lbw_box_account(L, model);
  return lbw_leave(L, status, 1);
}

/* ---- properties ------------------------------------------------------------------------------ */

LBW_PUSH(model_mesh, lbw_push(L, &lbw_mesh_class, self(L)->mesh))
LBW_PUSH(model_material, lbw_push(L, &lbw_material_class, self(L)->material))

static int model_loads(lua_State *L) {
  static const char *const kind[] = {"pressure", "traction", "force",      "torque",
                                     "gravity",  "nodal",    "temperature"};
  const bw_model *model = self(L);
  lua_createtable(L, model->load_count, 0);
  for (int i = 0; i < model->load_count; i++) {
    const bw_load *load = &model->load[i];
    lua_createtable(L, 0, 5);
    lua_pushstring(L, kind[load->kind]);
    lua_setfield(L, -2, "kind");
    if (load->kind == BW_LOAD_PRESSURE) {
      lua_pushnumber(L, load->vector[0]);
      lua_setfield(L, -2, "value");
    } else if (load->kind != BW_LOAD_NODAL && load->kind != BW_LOAD_TEMPERATURE) {
      lbw_push_vector(L, load->vector);
      lua_setfield(L, -2, "value");
    }
    lua_pushnumber(L, load->area);
    lua_setfield(L, -2, "area");
    lbw_push_vector(L, load->resultant);
    lua_setfield(L, -2, "resultant");
    lbw_push_vector(L, load->moment);
    lua_setfield(L, -2, "moment");
    lua_rawseti(L, -2, i + 1);
  }
  return 1;
}

static int model_supports(lua_State *L) {
  const bw_model *model = self(L);
  lua_createtable(L, model->support_count, 0);
  for (int i = 0; i < model->support_count; i++) {
    const bw_support *support = &model->support[i];
    lua_createtable(L, 0, 3);
    lbw_push(L, &lbw_selection_class, support->on);
    lua_setfield(L, -2, "on");
    lua_pushboolean(L, support->slide);
    lua_setfield(L, -2, "slide");
    lua_createtable(L, 3, 0);
    for (int k = 0; k < 3; k++) {
      if (support->fixed[k] && !support->slide)
        lua_pushnumber(L, support->value[k]);
      else
        lua_pushboolean(L, 0);
      lua_rawseti(L, -2, k + 1);
    }
    lua_setfield(L, -2, "displacement");
    if (support->slide && bw_norm(support->normal) > 0) {
      lbw_push_vector(L, support->normal);
      lua_setfield(L, -2, "direction");
    }
    if (support->symmetry != BW_NO_SYMMETRY) {
      lua_pushstring(L, symmetries[support->symmetry - BW_SYMMETRIC]);
      lua_setfield(L, -2, "symmetry");
    }
    lua_rawseti(L, -2, i + 1);
  }
  return 1;
}

static int model_bonds(lua_State *L) {
  const bw_model *model = self(L);
  lua_createtable(L, model->bond_count, 0);
  for (int i = 0; i < model->bond_count; i++) {
    const bw_bond *bond = &model->bond[i];
    lua_createtable(L, 0, 5);
    lbw_push(L, &lbw_selection_class, bond->a);
    lua_setfield(L, -2, "a");
    lbw_push(L, &lbw_selection_class, bond->b);
    lua_setfield(L, -2, "b");
    lua_pushnumber(L, bond->area);
    lua_setfield(L, -2, "area");
    lua_pushnumber(L, bond->gap);
    lua_setfield(L, -2, "gap");
    lua_pushinteger(L, bond->node_count);
    lua_setfield(L, -2, "node_count");
    if (bond->preload != BW_NO_PRELOAD) {
      lua_pushnumber(L, bond->pull);
      lua_setfield(L, -2, bond->preload == BW_PRELOAD_FORCE ? "preload" : "shortening");
    }
    lua_rawseti(L, -2, i + 1);
  }
  return 1;
}

static int model_attachments(lua_State *L) {
  const bw_model *model = self(L);
  lua_createtable(L, model->attachment_count, 0);
  for (int i = 0; i < model->attachment_count; i++) {
    const bw_attachment *attachment = &model->attachment[i];
    lua_createtable(L, 0, 3);
    lbw_push(L, &lbw_selection_class, attachment->on);
    lua_setfield(L, -2, "on");
    lua_pushnumber(L, attachment->area);
    lua_setfield(L, -2, "area");
    if (attachment->mass > 0) {
      lua_pushnumber(L, attachment->mass);
      lua_setfield(L, -2, "mass");
    } else {
      lbw_push_vector(L, attachment->stiffness);
      lua_setfield(L, -2, "spring");
    }
    lua_rawseti(L, -2, i + 1);
  }
  return 1;
}

static int model_couplings(lua_State *L) {
  const bw_model *model = self(L);
  lua_createtable(L, model->coupling_count, 0);
  for (int i = 0; i < model->coupling_count; i++) {
    const bw_coupling *coupling = &model->coupling[i];
    lua_createtable(L, 0, 7);
    lbw_push(L, &lbw_selection_class, coupling->on);
    lua_setfield(L, -2, "on");
    lua_pushstring(L, coupling_kinds[coupling->point.kind]);
    lua_setfield(L, -2, "kind");
    lbw_push_vector(L, coupling->point.at);
    lua_setfield(L, -2, "at");
    lua_pushnumber(L, coupling->area);
    lua_setfield(L, -2, "area");
    lua_pushinteger(L, coupling->node_count);
    lua_setfield(L, -2, "node_count");
    lbw_push_vector(L, coupling->point.load);
    lua_setfield(L, -2, "force");
    lbw_push_vector(L, coupling->point.load + 3);
    lua_setfield(L, -2, "moment");
    lua_rawseti(L, -2, i + 1);
  }
  return 1;
}

/* The cyclic symmetry, or nil. */
static int model_cyclic_symmetry(lua_State *L) {
  const bw_cyclic *cyclic = self(L)->cyclic;
  if (!cyclic)
    return 0;
  lua_createtable(L, 0, 7);
  lbw_push(L, &lbw_selection_class, cyclic->low);
  lua_setfield(L, -2, "low");
  lbw_push(L, &lbw_selection_class, cyclic->high);
  lua_setfield(L, -2, "high");
  lua_pushinteger(L, cyclic->count);
  lua_setfield(L, -2, "count");
  lbw_push_vector(L, cyclic->axis);
  lua_setfield(L, -2, "axis");
  lbw_push_vector(L, cyclic->point);
  lua_setfield(L, -2, "about");
  lua_pushnumber(L, cyclic->distance);
  lua_setfield(L, -2, "distance");
  lua_pushinteger(L, cyclic->axis_count);
  lua_setfield(L, -2, "axis_node_count");
  return 1;
}

static int model_tostring(lua_State *L) {
  const bw_model *model = (const bw_model *)lbw_check(L, 1, &lbw_model_class);
  lbw_state *state = lbw_state_of(L);
  char *text = NULL;
  if (state->running || bw_model_describe(lbw_enter(L), model, &text) != BW_OK) {
    lua_pushliteral(L, "model");
    if (state->caller == L)
      state->running = 0;
    return 1;
  }
  lbw_leave_or_raise(L, BW_OK);
  luaL_Buffer buffer;
  luaL_buffinit(L, &buffer);
  size_t length = strlen(text);
  while (length > 0 && text[length - 1] == '\n')
    length--;
  luaL_addlstring(&buffer, text, length);
  bw_free(text);
  luaL_pushresult(&buffer);
  return 1;
}

LBW_PUSH(model_formulation, lua_pushstring(L, formulations[self(L)->material->formulation]))

/* What warns of volumetric locking, or nil. */
LBW_PUSH(model_locking, lua_pushstring(L, bw_locking(self(L)->mesh, self(L)->material)))

static const luaL_Reg methods[] = {{"fix", model_fix},
                                   {"slide", model_slide},
                                   {"symmetry", model_symmetry},
                                   {"prescribe", model_prescribe},
                                   {"clear_supports", model_clear_supports},
                                   {"bond", model_bond},
                                   {"clear_bonds", model_clear_bonds},
                                   {"attach", model_attach},
                                   {"clear_attachments", model_clear_attachments},
                                   {"couple", model_couple},
                                   {"clear_couplings", model_clear_couplings},
                                   {"cyclic", model_cyclic},
                                   {"clear_cyclic", model_clear_cyclic},
                                   {"whole", model_whole},
                                   {"gravity", model_gravity},
                                   {"load", model_load},
                                   {"temperature", model_temperature},
                                   {"clear_loads", model_clear_loads},
                                   {"write_inp", model_write_inp},
                                   {"force_vector", model_force_vector},
                                   {"rigid_modes", model_rigid_modes},
                                   {"solve", model_solve},
                                   {"modes", model_modes},
                                   {"system", model_system},
                                   {NULL, NULL}};
static const luaL_Reg properties[] = {{"mesh", model_mesh},
                                      {"material", model_material},
                                      {"formulation", model_formulation},
                                      {"locking", model_locking},
                                      {"loads", model_loads},
                                      {"supports", model_supports},
                                      {"bonds", model_bonds},
                                      {"attachments", model_attachments},
                                      {"couplings", model_couplings},
                                      {"cyclic_symmetry", model_cyclic_symmetry},
                                      {NULL, NULL}};
static const luaL_Reg meta[] = {{"__tostring", model_tostring}, {NULL, NULL}};
const lbw_class lbw_model_class = {"model", methods, properties, meta, NULL};

/* is_joined(model): whether it has bonds, attachments, couplings or is a sector */
static int core_is_joined(lua_State *L) {
  lua_pushboolean(L, bw_model_joined((const bw_model *)lbw_check(L, 1, &lbw_model_class)));
  return 1;
}

/* refuse_joints(model): true for a model without bonds, attachments, couplings and sectors */
static int core_refuse_joints(lua_State *L) {
  const bw_model *model = self(L);
  lua_pushboolean(L, 1);
  return lbw_leave(L, bw_model_refuse_joints(lbw_enter(L), model), 1);
}

/* joined_system(model, {solver}): the equations of a joined model for many loads */
static int core_joined_system(lua_State *L) {
  static const lbw_option list[] = {{"solver", LBW_OTHER, 0}, {NULL, LBW_OTHER, 0}};
  const bw_model *model = self(L);
  lua_settop(L, 2);
  lbw_options(L, 2, "joined_system", list, NULL);
  const bw_solver *solver = lbw_solver_option(L, 2, "joined_system");
  lbw_box *box = lbw_box_new(L, &lbw_system_class);
  bw_system *system = NULL;
  bw_status status = bw_joined_system(lbw_enter(L), model, solver, &system);
  return lbw_leave_object(L, box, system, status);
}

/* cuts(model): what of its boundary is no surface, since a plane of symmetry or a bond covers it;
 * or nil */
static int core_cuts(lua_State *L) {
  const bw_model *model = self(L);
  lbw_box *box = lbw_box_new(L, &lbw_selection_class);
  bw_selection *cuts = NULL;
  bw_status status = bw_model_cuts(lbw_enter(L), model, &cuts);
  if (status == BW_OK && !cuts) {
    lua_pushnil(L);
    return lbw_leave(L, status, 1);
  }
  return lbw_leave_object(L, box, cuts, status);
}

void lbw_open_model(lua_State *L) {
  lbw_class_register(L, &lbw_model_class);
  lua_pushcfunction(L, model_new);
  lua_setfield(L, -2, "model");
  lua_pushcfunction(L, core_refuse_joints);
  lua_setfield(L, -2, "refuse_joints");
  lua_pushcfunction(L, core_is_joined);
  lua_setfield(L, -2, "is_joined");
  lua_pushcfunction(L, core_joined_system);
  lua_setfield(L, -2, "joined_system");
  lua_pushcfunction(L, core_cuts);
  lua_setfield(L, -2, "cuts");
}
