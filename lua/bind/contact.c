/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* bw.rigid: rigid surfaces; model:contact, and what it finds. */
#include "bind.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

/* ---- rigid surfaces -------------------------------------------------------------------------- */

static const bw_rigid_surface *surface_self(lua_State *L) {
  return (const bw_rigid_surface *)lbw_check(L, 1, &lbw_rigid_surface_class);
}

/* What the options of the three have. */
typedef struct shape {
  double at[3], direction[3], radius;
  bool inside;
  const double *place; /* `at`, or NULL where it is left out */
} shape;

static void read_shape(lua_State *L, const char *function, const lbw_option *list,
                       const char *place, const char *first, const char *second, shape *s) {
  lbw_check_type(L, 1, LUA_TTABLE);
  lua_settop(L, 1);
  lbw_options(L, 1, function, list, s);
  const char *const needed[] = {first, second};
  for (int k = 0; k < 2; k++)
    if (needed[k] && lbw_option_get(L, 1, needed[k]) == LUA_TNIL)
      lbw_option_missing(L, function, needed[k], "");
  s->place = lbw_option_get(L, 1, place) == LUA_TNIL ? NULL : s->at;
  lua_settop(L, 1);
}

/* rigid.plane{point, normal} */
static int rigid_plane(lua_State *L) {
  static const lbw_option list[] = {{"point", LBW_VECTOR, offsetof(shape, at)},
                                    {"normal", LBW_VECTOR, offsetof(shape, direction)},
                                    {NULL, LBW_OTHER, 0}};
  shape s = {0};
  bw_rigid_surface *surface = NULL;
  read_shape(L, "rigid.plane", list, "point", "normal", NULL, &s);
  lbw_box *box = lbw_box_new(L, &lbw_rigid_surface_class);
  bw_status status = bw_rigid_plane(lbw_enter(L), s.place, s.direction, &surface);
  return lbw_leave_object(L, box, surface, status);
}

/* rigid.sphere{centre, radius, inside} */
static int rigid_sphere(lua_State *L) {
  static const lbw_option list[] = {{"centre", LBW_VECTOR, offsetof(shape, at)},
                                    {"radius", LBW_REAL, offsetof(shape, radius)},
                                    {"inside", LBW_BOOLEAN, offsetof(shape, inside)},
                                    {NULL, LBW_OTHER, 0}};
  shape s = {0};
  bw_rigid_surface *surface = NULL;
  read_shape(L, "rigid.sphere", list, "centre", "radius", NULL, &s);
  lbw_box *box = lbw_box_new(L, &lbw_rigid_surface_class);
  bw_status status = bw_rigid_sphere(lbw_enter(L), s.place, s.radius, s.inside, &surface);
  return lbw_leave_object(L, box, surface, status);
}

/* rigid.cylinder{point, axis, radius, inside} */
static int rigid_cylinder(lua_State *L) {
  static const lbw_option list[] = {{"point", LBW_VECTOR, offsetof(shape, at)},
                                    {"axis", LBW_VECTOR, offsetof(shape, direction)},
                                    {"radius", LBW_REAL, offsetof(shape, radius)},
                                    {"inside", LBW_BOOLEAN, offsetof(shape, inside)},
                                    {NULL, LBW_OTHER, 0}};
  shape s = {0};
  bw_rigid_surface *surface = NULL;
  read_shape(L, "rigid.cylinder", list, "point", "axis", "radius", &s);
  lbw_box *box = lbw_box_new(L, &lbw_rigid_surface_class);
  bw_status status =
      bw_rigid_cylinder(lbw_enter(L), s.place, s.direction, s.radius, s.inside, &surface);
  return lbw_leave_object(L, box, surface, status);
}

static int surface_kind(lua_State *L) {
  static const char *const words[] = {"plane", "sphere", "cylinder"};
  lua_pushstring(L, words[surface_self(L)->kind]);
  return 1;
}

static int surface_point(lua_State *L) {
  lbw_push_vector(L, surface_self(L)->point);
  return 1;
}

static int surface_direction(lua_State *L) {
  const bw_rigid_surface *surface = surface_self(L);
  if (surface->kind == BW_RIGID_SPHERE)
    lua_pushnil(L);
  else
    lbw_push_vector(L, surface->direction);
  return 1;
}

static int surface_radius(lua_State *L) {
  const bw_rigid_surface *surface = surface_self(L);
  if (surface->kind == BW_RIGID_PLANE)
    lua_pushnil(L);
  else
    lua_pushnumber(L, surface->radius);
  return 1;
}

static int surface_inside(lua_State *L) {
  lua_pushboolean(L, surface_self(L)->inside);
  return 1;
}

static int surface_placed(lua_State *L) {
  lua_pushboolean(L, surface_self(L)->placed);
  return 1;
}

static int surface_tostring(lua_State *L) {
  const bw_rigid_surface *s = surface_self(L);
  lbw_text at = lbw_point(s->point), along = lbw_direction(s->direction);
  lbw_text radius = lbw_quantity(s->radius, "m");
  const char *side = s->inside ? ", body inside" : "";
  if (s->kind == BW_RIGID_PLANE)
    lua_pushfstring(L, "rigid plane through %s, normal %s", at.text, along.text);
  else if (s->kind == BW_RIGID_SPHERE)
    lua_pushfstring(L, "rigid sphere about %s, radius %s%s", at.text, radius.text, side);
  else
    lua_pushfstring(L, "rigid cylinder about %s along %s, radius %s%s", at.text, along.text,
                    radius.text, side);
  return 1;
}

/* ---- contact --------------------------------------------------------------------------------- */

static const bw_contact *self(lua_State *L) {
  return (const bw_contact *)lbw_check(L, 1, &lbw_contact_class);
}

/* The pair of the table on the top of the stack, item i of the list. */
static bw_contact_pair read_pair(lua_State *L, const char *where, int i) {
  static const lbw_option list[] = {
      {"on", LBW_OTHER, 0},
      {"with", LBW_OTHER, 0},
      {"interference", LBW_REAL, offsetof(bw_contact_pair, interference)},
      {"friction", LBW_REAL, offsetof(bw_contact_pair, friction)},
      {"smooth", LBW_BOOLEAN, offsetof(bw_contact_pair, smooth)},
      {NULL, LBW_OTHER, 0}};
  char function[60];
  bw_contact_pair pair = {0};
  int top = lua_gettop(L);
  snprintf(function, sizeof function, "%s: pair %d", where, i);
  if (!lua_istable(L, top))
    lbw_error(L, "%s: a table {on = , with = } expected, got %s", function, lbw_got(L, top));
  lbw_options(L, top, function, list, &pair);
  pair.on = (const bw_selection *)lbw_object_option(L, top, function, "on", &lbw_selection_class,
                                                    "an open selection");
  if (!pair.on)
    lbw_option_missing(L, function, "on", "");
  if (lbw_option_get(L, top, "with") == LUA_TNIL)
    lbw_option_missing(L, function, "with", "");
  pair.against = (const bw_selection *)lbw_test(L, -1, &lbw_selection_class);
  pair.with = (const bw_rigid_surface *)lbw_test(L, -1, &lbw_rigid_surface_class);
  if (!pair.against && !pair.with)
    lbw_option_refused(L, function, "with", "a surface of bw.rigid, or an open selection");
  lua_settop(L, top);
  return pair;
}

bw_contact_pair *lbw_contact_pairs(lua_State *L, int index, const char *where, int *count) {
  *count = (int)lua_rawlen(L, index);
  if (*count == 0)
    lbw_error(L, "%s: a list of pairs {{on = , with = }, ...} expected", where);
  bw_contact_pair *pair = (bw_contact_pair *)lua_newuserdatauv(L, (size_t)*count * sizeof *pair, 0);
  for (int i = 0; i < *count; i++) {
    lua_rawgeti(L, index, i + 1);
    pair[i] = read_pair(L, where, i + 1);
    lua_pop(L, 1);
  }
  return pair;
}

/* model:contact(pairs, {solver, tolerance, max_iterations, steps, finite_sliding, after}) */
static int model_contact(lua_State *L) {
  static const lbw_option list[] = {
      {"solver", LBW_OTHER, 0},
      {"tolerance", LBW_REAL, offsetof(bw_contact_options, tolerance)},
      {"max_iterations", LBW_INT, offsetof(bw_contact_options, max_iterations)},
      {"steps", LBW_INT, offsetof(bw_contact_options, steps)},
      {"finite_sliding", LBW_BOOLEAN, offsetof(bw_contact_options, finite_sliding)},
      {"after", LBW_OTHER, 0},
      {NULL, LBW_OTHER, 0}};
  bw_contact_options options;
  bw_contact_options_default(&options);
  lbw_box *model = lbw_check_box(L, 1, &lbw_model_class);
  lbw_check_type(L, 2, LUA_TTABLE);
  lua_settop(L, 3);
  lbw_options(L, 3, "contact", list, &options);
  options.solver = lbw_solver_option(L, 3, "contact");
  options.after = (const bw_contact *)lbw_object_option(L, 3, "contact", "after",
                                                        &lbw_contact_class, "an open contact");
  int count;
  bw_contact_pair *pair = lbw_contact_pairs(L, 2, "contact", &count);
  lbw_box *box = lbw_box_new(L, &lbw_contact_class);
  bw_contact *contact = NULL;
  bw_status status = bw_contact_solve(lbw_enter(L), (const bw_model *)model->object, count, pair,
                                      (bw_system *)model->extra, &options, &contact);
  if (status == BW_OK && contact->solution->system && contact->solution->system != model->extra) {
    bw_release(model->extra);
    model->extra = bw_retain(contact->solution->system);
  }
  lbw_box_fill(L, box, contact);
  if (status == BW_OK)
    lbw_box_account(L, model);
  return lbw_leave(L, status, 1);
}

static int contact_static(lua_State *L) {
  lbw_push(L, &lbw_static_class, self(L)->solution);
  return 1;
}

static int contact_mesh(lua_State *L) {
  lbw_push(L, &lbw_mesh_class, self(L)->model->mesh);
  return 1;
}

static int contact_pressure(lua_State *L) {
  const bw_contact *contact = self(L);
  return lbw_push_borrowed(L, BW_F64, contact->model->mesh->node_count, 1, contact->pressure,
                           contact);
}

static int contact_gap(lua_State *L) {
  const bw_contact *contact = self(L);
  return lbw_push_borrowed(L, BW_F64, contact->model->mesh->node_count, 1, contact->gap, contact);
}

/* The array with `columns` numbers for each node, or nil without friction. */
static int push_friction(lua_State *L, bw_type type, int columns, void *data) {
  const bw_contact *contact = self(L);
  if (contact->has_friction)
    return lbw_push_borrowed(L, type, contact->model->mesh->node_count, columns, data, contact);
  lua_pushnil(L);
  return 1;
}

static int contact_traction(lua_State *L) {
  return push_friction(L, BW_F64, 3, self(L)->traction);
}

static int contact_slip(lua_State *L) {
  return push_friction(L, BW_F64, 3, self(L)->slip);
}

static int contact_status(lua_State *L) {
  return push_friction(L, BW_U8, 1, self(L)->status);
}

static void set_number(lua_State *L, const char *key, double value) {
  lua_pushnumber(L, value);
  lua_setfield(L, -2, key);
}

/* A force of a pair; what is rounding beside its pressure is 0. */
static lbw_text force_text(const bw_contact_state *state, const double force[3]) {
  double shown[3];
  for (int k = 0; k < 3; k++)
    shown[k] = fabs(force[k]) < 1e-9 * state->pressure * state->area ? 0 : force[k];
  return lbw_triple(shown, 1, "N");
}

/* Pushes what print says of a pair. */
static void push_pair_text(lua_State *L, const bw_contact *contact, int i) {
  const bw_contact_state *state = &contact->state[i];
  if (state->active == 0 && state->penetration > 0)
    lua_pushliteral(L, "undecided");
  else if (state->active == 0 && state->gap == 0)
    lua_pushliteral(L, "touches without pressure");
  else if (state->active == 0)
    lua_pushfstring(L, "open by %s", lbw_quantity(state->gap, "m").text);
  else
    lua_pushfstring(L, "%s on %s, at most %s at %s, penetrates by up to %s; " LBW_ERROR_UNKNOWN,
                    force_text(state, state->force).text, lbw_quantity(state->area, "m2").text,
                    lbw_quantity(state->pressure, "Pa").text,
                    lbw_point(contact->model->mesh->node + 3 * (int64_t)state->node).text,
                    lbw_quantity(state->penetration, "m").text);
  if (state->active == 0 || contact->pair[i].friction == 0)
    return;
  lua_pushfstring(L,
                  "\n    friction %f: %s of it, sticks on %s, slips by up to %s, took "
                  "%s; " LBW_ERROR_UNKNOWN,
                  contact->pair[i].friction, force_text(state, state->friction).text,
                  lbw_quantity(state->stick_area, "m2").text, lbw_quantity(state->slip, "m").text,
                  lbw_quantity(state->work, "J").text);
  lua_concat(L, 2);
}

static int contact_pairs(lua_State *L) {
  const bw_contact *contact = self(L);
  lua_createtable(L, contact->pair_count, 0);
  for (int i = 0; i < contact->pair_count; i++) {
    const bw_contact_state *state = &contact->state[i];
    lua_createtable(L, 0, 14);
    set_number(L, "area", state->area);
    set_number(L, "pressure", state->pressure);
    set_number(L, "gap", state->gap);
    set_number(L, "penetration", state->penetration);
    lbw_push_vector(L, state->force);
    lua_setfield(L, -2, "force");
    lbw_push_vector(L, state->moment);
    lua_setfield(L, -2, "moment");
    if (state->node >= 0) {
      lbw_push_vector(L, contact->model->mesh->node + 3 * (int64_t)state->node);
      lua_setfield(L, -2, "at");
    }
    if (contact->pair[i].friction > 0) {
      lbw_push_vector(L, state->friction);
      lua_setfield(L, -2, "friction");
      set_number(L, "stick_area", state->stick_area);
      set_number(L, "slip", state->slip);
      set_number(L, "work", state->work);
    }
    lua_pushinteger(L, state->candidates);
    lua_setfield(L, -2, "candidates");
    lua_pushinteger(L, state->active);
    lua_setfield(L, -2, "active");
    push_pair_text(L, contact, i);
    lbw_prints(L);
    lua_rawseti(L, -2, i + 1);
  }
  return 1;
}

static int contact_undetermined(lua_State *L) {
  const char *text = self(L)->free_text;
  lua_newtable(L);
  for (int i = 1; *text; i++) {
    size_t length = strcspn(text, "\n");
    lua_pushlstring(L, text, length);
    lua_rawseti(L, -2, i);
    text += length + (text[length] == '\n');
  }
  return 1;
}

#define INTEGER(name, field)                                                                       \
  static int name(lua_State *L) {                                                                  \
    lua_pushinteger(L, self(L)->field);                                                            \
    return 1;                                                                                      \
  }
INTEGER(contact_iterations, iterations)
INTEGER(contact_changes, changes)
INTEGER(contact_solves, solves)
INTEGER(contact_steps, steps)
#undef INTEGER

static int contact_rotation(lua_State *L) {
  lua_pushnumber(L, self(L)->rotation);
  return 1;
}

static int contact_report(lua_State *L) {
  lbw_push_report(L, &self(L)->report);
  return 1;
}

static int contact_tostring(lua_State *L) {
  const bw_contact *contact = self(L);
  luaL_Buffer text;
  luaL_buffinit(L, &text);
  lua_pushfstring(L,
                  "contact with%s friction, %d pair%s, %d iteration%s, %d changes of the active "
                  "set, %d solves",
                  contact->has_friction ? "" : "out", contact->pair_count,
                  contact->pair_count == 1 ? "" : "s", contact->iterations,
                  contact->iterations == 1 ? "" : "s", contact->changes, contact->solves);
  luaL_addvalue(&text);
  if (contact->has_friction) {
    lua_pushfstring(L, "\n  loads in %d step%s; with friction the result depends on their path",
                    contact->steps, contact->steps == 1 ? "" : "s");
    luaL_addvalue(&text);
  }
  for (int i = 0; i < contact->pair_count; i++) {
    lua_pushfstring(L, "\n  pair %d: ", i + 1);
    luaL_addvalue(&text);
    push_pair_text(L, contact, i);
    luaL_addvalue(&text);
  }
  lbw_add_joints(L, &text, contact->solution);
  for (const char *line = contact->notes; *line;) {
    size_t length = strcspn(line, "\n");
    luaL_addstring(&text, "\n  ");
    luaL_addlstring(&text, line, length);
    line += length + (line[length] == '\n');
  }
  luaL_pushresult(&text);
  return 1;
}

static const luaL_Reg no_methods[] = {{NULL, NULL}};
static const luaL_Reg surface_properties[] = {{"kind", surface_kind},
                                              {"point", surface_point},
                                              {"direction", surface_direction},
                                              {"radius", surface_radius},
                                              {"inside", surface_inside},
                                              {"placed", surface_placed},
                                              {NULL, NULL}};
static const luaL_Reg surface_meta[] = {{"__tostring", surface_tostring}, {NULL, NULL}};
const lbw_class lbw_rigid_surface_class = {"rigid_surface", no_methods, surface_properties,
                                           surface_meta, NULL};
static const luaL_Reg properties[] = {
    {"static", contact_static},         {"mesh", contact_mesh},
    {"pressure", contact_pressure},     {"gap", contact_gap},
    {"traction", contact_traction},     {"slip", contact_slip},
    {"status", contact_status},         {"steps", contact_steps},
    {"pairs", contact_pairs},           {"undetermined", contact_undetermined},
    {"iterations", contact_iterations}, {"changes", contact_changes},
    {"rotation", contact_rotation},     {"solves", contact_solves},
    {"report", contact_report},         {NULL, NULL}};
static const luaL_Reg meta[] = {{"__tostring", contact_tostring}, {NULL, NULL}};
const lbw_class lbw_contact_class = {"contact", no_methods, properties, meta, NULL};

void lbw_open_contact(lua_State *L) {
  static const luaL_Reg functions[] = {
      {"plane", rigid_plane}, {"sphere", rigid_sphere}, {"cylinder", rigid_cylinder}, {NULL, NULL}};
  static const luaL_Reg of_model[] = {{"contact", model_contact}, {NULL, NULL}};
  lbw_class_register(L, &lbw_rigid_surface_class);
  lbw_class_register(L, &lbw_contact_class);
  lbw_add_methods(L, &lbw_model_class, of_model);
  luaL_newlib(L, functions);
  lua_setfield(L, -2, "rigid");
}
