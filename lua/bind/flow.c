/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* Flows that follow an outline. A box holds a flow and, as its second reference, the mesh motion of
 * its mesh. Names for options and conditions are Lua (lua/barwright/flows.lua). */
#include "condition.h"
#include "follow.h"

static bw_flow *self(lua_State *L) {
  return (bw_flow *)lbw_check(L, 1, &lbw_flow_class);
}

static bw_status create(bw_context *context, const bw_plane_mesh *mesh, const void *description,
                        void **body) {
  bw_flow *flow = NULL;
  bw_status status = bw_flow_create(context, mesh, (const bw_flow_description *)description, &flow);
  *body = flow;
  return status;
}

/* flow.create(outline, fill, follow, description, conditions) */
static int flow_create(lua_State *L) {
  static const lbw_option list[] = {
      {"density", LBW_REAL, offsetof(bw_flow_description, density)},
      {"viscosity", LBW_REAL, offsetof(bw_flow_description, viscosity)},
      {"diffusivity", LBW_REAL, offsetof(bw_flow_description, diffusivity)},
      {"expansion", LBW_REAL, offsetof(bw_flow_description, expansion)},
      {"reference", LBW_REAL, offsetof(bw_flow_description, reference)},
      {"gravity", LBW_OTHER, 0},
      {NULL, LBW_OTHER, 0}};
  lua_settop(L, 5);
  const bw_outline *outline = (const bw_outline *)lbw_check(L, 1, &lbw_outline_class);
  bw_follow_options follow;
  bw_flow_description description = {0};
  lbw_read_follow(L, 3, "flow", &follow);
  lbw_read_fill(L, 2, "flow", &follow.fill);
  lbw_options(L, 4, "flow", list, &description);
  if (lbw_option_get(L, 4, "gravity") == LUA_TTABLE)
    for (int i = 0; i < 2; i++) {
      lua_rawgeti(L, -1, i + 1);
      description.gravity[i] = lua_tonumber(L, -1);
      lua_pop(L, 1);
    }
  lbw_conditions *conditions = lbw_conditions_read(L, 5, "conditions", outline);
  int place = lua_gettop(L);
  description.condition = lbw_conditions_list(conditions, &description.condition_count);
  lbw_conditions_size(conditions, &follow.fill);
  return lbw_follow_create(L, &lbw_flow_class, outline, &follow, place, create, &description);
}

/* ---- following and stepping ------------------------------------------------------------------ */

static bw_status follow_mesh(bw_context *context, void *flow, const bw_plane_mesh *mesh,
                             bw_plane_reuse *reuse) {
  return bw_flow_follow(context, (bw_flow *)flow, mesh, reuse);
}

static const void *keep(const void *flow) {
  return bw_flow_keep((const bw_flow *)flow);
}

static bw_status restore(bw_context *context, void *flow, const void *state) {
  return bw_flow_return(context, (bw_flow *)flow, (const bw_flow_state *)state);
}

static bw_status check(bw_context *context, const void *flow) {
  return bw_flow_check(context, (const bw_flow *)flow);
}

static const bw_plane_mesh *mesh_of(const void *flow) {
  return ((const bw_flow *)flow)->mesh;
}

static const lbw_followed followed = {&lbw_flow_class, follow_mesh, keep, restore, check, mesh_of};

/* flow:follow(frame, outline) */
static int flow_follow(lua_State *L) {
  return lbw_follow(L, &followed);
}

/* flow:save(), flow:restore(state) */
static int flow_save(lua_State *L) {
  return lbw_followed_keep(L, &followed);
}
static int flow_restore(lua_State *L) {
  return lbw_followed_return(L, &followed);
}
static int flow_check(lua_State *L) {
  return lbw_followed_check(L, &followed);
}

/* flow:step(frame, {solver, max_lag}, options, steps): option "step" 0: to the steady state */
static int flow_step(lua_State *L) {
  static const lbw_option list[] = {{"step", LBW_REAL, offsetof(bw_flow_options, step)},
                                    {"bdf", LBW_INT, offsetof(bw_flow_options, bdf)},
                                    {"iterations", LBW_INT, offsetof(bw_flow_options, iterations)},
                                    {"tolerance", LBW_REAL, offsetof(bw_flow_options, tolerance)},
                                    {"ale", LBW_BOOLEAN, offsetof(bw_flow_options, ale)},
                                    {NULL, LBW_OTHER, 0}};
  bw_status status = BW_OK;
  bw_flow *flow = self(L);
  lua_settop(L, 5);
  lbw_check_type(L, 2, LUA_TTABLE);
  bw_flow_options options;
  bw_plane_reuse reuse;
  bw_flow_options_default(&options);
  lbw_read_lagged_factor(L, 3, "step", &options.linear);
  lbw_options(L, 4, "step", list, &options);
  lua_Integer steps = lbw_integer_or(L, 5, 1);
  lbw_load_plane_reuse(L, 2, &reuse);
  lbw_conditions_begin(L, 1);
  bw_context *context = lbw_enter(L);
  const bw_flow_state *before = bw_flow_keep(flow);
  for (lua_Integer i = 0; i < steps; i++) {
    if (steps > 1)
      bw_progress(context, "time steps", (double)i / (double)steps);
    BW_TRY(bw_check_cancel(context));
    BW_TRY(bw_flow_step(context, flow, &options, &reuse));
  }
done:
  if (status != BW_OK) /* all steps or none; its own state: it cannot fail */
    (void)bw_flow_return(context, flow, before);
  bw_release(before);
  return lbw_leave_frame(L, &lbw_flow_class, status, &reuse);
}

/* ---- results --------------------------------------------------------------------------------- */

static int32_t nodes_of(const bw_flow *flow) {
  return flow->mesh->topology->nodes->node_count;
}

static int32_t check_tag(lua_State *L, int index, const bw_flow *flow) {
  const bw_outline *outline = flow->mesh->outline;
  const char *text = lbw_check_text(L, index, NULL);
  int32_t tag = bw_outline_find_tag(outline, text);
  if (tag < 0) {
    const char **name =
        (const char **)lua_newuserdatauv(L, ((size_t)outline->tag_count + 1) * sizeof *name, 0);
    for (int32_t t = 0; t < outline->tag_count; t++)
      name[t] = outline->tag[t].text;
    lbw_error(L, "the outline has no tag '%s': %s", text,
              lbw_suggestion(L, text, name, (size_t)outline->tag_count));
  }
  return tag;
}

/* flow:force(tag) */
static int flow_force(lua_State *L) {
  const bw_flow *flow = self(L);
  int32_t tag = check_tag(L, 2, flow);
  double force[2] = {0, 0};
  bw_status status = bw_flow_force(lbw_enter(L), flow, tag, force);
  lbw_leave_or_raise(L, status);
  lua_pushnumber(L, force[0]);
  lua_pushnumber(L, force[1]);
  return 2;
}

/* flow:heat(tag) */
static int flow_heat(lua_State *L) {
  const bw_flow *flow = self(L);
  int32_t tag = check_tag(L, 2, flow);
  double heat = 0;
  lbw_conditions_begin(L, 1);
  bw_status status = bw_flow_heat(lbw_enter(L), flow, tag, &heat);
  lbw_leave_or_raise(L, status);
  lua_pushnumber(L, heat);
  return 1;
}

/* flow:at(x, y): velocity x, y, pressure and temperature, if there is one */
static int flow_at(lua_State *L) {
  const bw_flow *flow = self(L);
  const double at[2] = {lbw_check_real(L, 2, "x"), lbw_check_real(L, 3, "y")};
  double value[4] = {0};
  bw_status status = bw_flow_at(lbw_enter(L), flow, at, value);
  lbw_leave_or_raise(L, status);
  for (int i = 0; i < flow->components; i++)
    lua_pushnumber(L, value[i]);
  return flow->components;
}

/* Components `first` and on of the state, as it is now. */
static int push_part(lua_State *L, int first, int count) {
  const bw_flow *flow = self(L);
  if (first + count > flow->components) {
    lua_pushnil(L);
    return 1;
  }
  bw_array *array = lbw_push_array(L, BW_F64, nodes_of(flow), count);
  double *out = (double *)array->data;
  for (int64_t i = 0; i < nodes_of(flow); i++)
    for (int d = 0; d < count; d++)
      out[count * i + d] = flow->state[flow->components * i + first + d];
  return 1;
}

static int flow_velocity(lua_State *L) {
  return push_part(L, 0, 2);
}
static int flow_pressure(lua_State *L) {
  return push_part(L, 2, 1);
}
static int flow_temperature(lua_State *L) {
  return push_part(L, 3, 1);
}

static int flow_vorticity(lua_State *L) {
  const bw_flow *flow = self(L);
  bw_array *array = lbw_push_array(L, BW_F64, nodes_of(flow), 1);
  bw_status status = bw_flow_vorticity(lbw_enter(L), flow, (double *)array->data);
  lbw_leave_or_raise(L, status);
  return 1;
}

static int flow_points(lua_State *L) {
  const bw_plane_mesh *mesh = self(L)->mesh;
  return lbw_push_borrowed(L, BW_F64, mesh->topology->nodes->node_count, 2, mesh->point, mesh);
}

static int flow_elements(lua_State *L) {
  const bw_plane_topology *topology = self(L)->mesh->topology;
  return lbw_push_indices(L, topology->element_count, 3, topology->element);
}

static int flow_counts(lua_State *L) {
  lua_pushinteger(L, self(L)->mesh->topology->element_count);
  lua_pushinteger(L, nodes_of(self(L)));
  return 2;
}

LBW_PUSH(flow_time, lua_pushnumber(L, self(L)->time))
LBW_PUSH(flow_outline, lbw_push(L, &lbw_outline_class, self(L)->mesh->outline))

/* flow.frequency(signal, step, periods) */
static int flow_frequency(lua_State *L) {
  lbw_check_type(L, 1, LUA_TTABLE);
  lua_Integer count = (lua_Integer)lua_rawlen(L, 1), periods = lbw_check_integer(L, 3);
  double step = lbw_check_number(L, 2);
  double *signal = (double *)lua_newuserdatauv(L, ((size_t)count + 1) * sizeof *signal, 0);
  for (lua_Integer i = 0; i < count; i++) {
    if (lua_rawgeti(L, 1, i + 1) != LUA_TNUMBER)
      lbw_error(L, "a signal: entry %I: a number expected, got %s", i + 1, lbw_got(L, -1));
    signal[i] = lua_tonumber(L, -1);
    lua_pop(L, 1);
  }
  lua_pushnumber(L, bw_flow_frequency(count, signal, step, (int)periods));
  return 1;
}

static const luaL_Reg methods[] = {{"follow", flow_follow}, {"step", flow_step},
                                   {"force", flow_force},   {"heat", flow_heat},
                                   {"at", flow_at},         {"counts", flow_counts},
                                   {"save", flow_save},     {"restore", flow_restore},
                                   {"check", flow_check},   {NULL, NULL}};
static const luaL_Reg properties[] = {
    {"velocity", flow_velocity},   {"pressure", flow_pressure}, {"temperature", flow_temperature},
    {"vorticity", flow_vorticity}, {"points", flow_points},     {"elements", flow_elements},
    {"time", flow_time},           {"outline", flow_outline},   {NULL, NULL}};
static const luaL_Reg meta[] = {{NULL, NULL}};
const lbw_class lbw_flow_class = {"flow", methods, properties, meta, NULL};

void lbw_open_flow(lua_State *L) {
  static const luaL_Reg functions[] = {
      {"create", flow_create}, {"frequency", flow_frequency}, {NULL, NULL}};
  lbw_class_register(L, &lbw_flow_class);
  lua_newtable(L);
  luaL_setfuncs(L, functions, 0);
  lua_setfield(L, -2, "flow");
}
