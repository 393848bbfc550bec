/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* plane.mesh_motion: meshes that follow their outlines. */
#include "bind.h"

#include <string.h>

static bw_mesh_motion *self(lua_State *L) {
  return (bw_mesh_motion *)lbw_check(L, 1, &lbw_mesh_motion_class);
}

static const char *const levels[] = {"none", "relocation", "reconnecting", "reconstruction", NULL};

/* ---- the size field of reconstructions: a value kept beside the box, by its address -------- */

static int field_key;

static void keep_field(lua_State *L, int box) {
  box = lua_absindex(L, box); /* the value is on the top */
  if (lua_rawgetp(L, LUA_REGISTRYINDEX, &field_key) != LUA_TTABLE) {
    lua_pop(L, 1);
    lua_newtable(L);
    lua_newtable(L);
    lua_pushliteral(L, "k");
    lua_setfield(L, -2, "__mode");
    lua_setmetatable(L, -2);
    lua_pushvalue(L, -1);
    lua_rawsetp(L, LUA_REGISTRYINDEX, &field_key);
  }
  lua_pushvalue(L, box);
  lua_pushvalue(L, -3);
  lua_rawset(L, -3);
  lua_pop(L, 2);
}

/* Pushes the value, and the field read from it. */
static lbw_field *kept_field(lua_State *L, int box) {
  box = lua_absindex(L, box);
  if (lua_rawgetp(L, LUA_REGISTRYINDEX, &field_key) != LUA_TTABLE) {
    lua_pushnil(L);
    return NULL;
  }
  lua_pushvalue(L, box);
  if (lua_rawget(L, -2) == LUA_TNIL)
    return NULL;
  return lbw_field_read(L, -1, "plane.mesh_motion: field");
}

/* plane.mesh_motion(mesh, options) */
static int plane_mesh_motion(lua_State *L) {
  static const lbw_option list[] = {{"rounds", LBW_INT, offsetof(bw_follow_options, rounds)},
                                    {"distorted", LBW_REAL, offsetof(bw_follow_options, distorted)},
                                    {"rebuild", LBW_REAL, offsetof(bw_follow_options, rebuild)},
                                    {"relocation", LBW_OTHER, 0},
                                    {"force", LBW_OTHER, 0},
                                    {"fill", LBW_OTHER, 0},
                                    {NULL, LBW_OTHER, 0}};
  static const char *const relocations[] = {"harmonic", "springs", NULL};
  const bw_plane_mesh *mesh = (const bw_plane_mesh *)lbw_check(L, 1, &lbw_plane_mesh_class);
  bw_follow_options options;
  bw_follow_options_default(&options);
  lua_settop(L, 2);
  lbw_options(L, 2, "plane.mesh_motion", list, &options);
  options.relocation =
      (bw_relocation)lbw_word_option(L, 2, "plane.mesh_motion", "relocation", relocations, 0);
  options.force = (bw_level)lbw_word_option(L, 2, "plane.mesh_motion", "force", levels, 0);
  lbw_field *field = NULL;
  int kind = lbw_option_get(L, 2, "fill");
  if (kind != LUA_TNIL && kind != LUA_TTABLE)
    return lbw_option_refused(L, "plane.mesh_motion", "fill", "a table of options of plane.fill");
  int fill = lua_gettop(L);
  lbw_read_plane_options(L, fill, "plane.mesh_motion: fill", &options.fill, &field);
  lbw_box *box = lbw_box_new(L, &lbw_mesh_motion_class);
  if (field) {
    lua_getfield(L, fill, "field");
    keep_field(L, -2);
  }
  bw_mesh_motion *out = NULL;
  bw_status status = bw_mesh_motion_create(lbw_enter(L), mesh, &options, &out);
  if (out)
    out->options.fill.field_data = NULL; /* read again for each call */
  return lbw_leave_object(L, box, out, status);
}

static void push_report(lua_State *L, const bw_follow_report *report) {
  lua_createtable(L, 0, 6);
  lua_pushstring(L, levels[report->level]);
  lua_setfield(L, -2, "level");
  lua_pushinteger(L, report->flips);
  lua_setfield(L, -2, "flips");
  lua_pushnumber(L, report->worst);
  lua_setfield(L, -2, "worst");
  lua_pushinteger(L, (lua_Integer)report->worst_element + 1);
  lua_setfield(L, -2, "worst_element");
  lua_pushboolean(L, report->restored);
  lua_setfield(L, -2, "restored");
  lua_pushnumber(L, report->seconds);
  lua_setfield(L, -2, "seconds");
}

/* motion:follow(outline): report */
static int motion_follow(lua_State *L) {
  bw_mesh_motion *motion = self(L);
  const bw_outline *outline = (const bw_outline *)lbw_check(L, 2, &lbw_outline_class);
  bw_follow_report report = {BW_LEVEL_NONE, 0, 0, 0, false, 0};
  lua_settop(L, 2);
  lbw_field *field = motion->options.fill.field ? kept_field(L, 1) : NULL;
  motion->options.fill.field_data = field;
  bw_context *context = lbw_enter(L);
  if (field)
    lbw_field_begin(field, context);
  bw_status status = bw_mesh_motion_follow(context, motion, outline, &report);
  if (field)
    lbw_field_end(field, context);
  motion->options.fill.field_data = NULL;
  push_report(L, &report);
  return lbw_leave(L, status, 1);
}

/* motion:pull_back(gradient): of the outline's points, from that of nodes */
static int motion_pull_back(lua_State *L) {
  bw_mesh_motion *motion = self(L);
  int64_t rows;
  double *gradient = lbw_to_doubles(L, 2, "gradient", 2, &rows);
  lbw_check_rows(L, 2, "gradient", rows, motion->mesh->topology->nodes->node_count, "node");
  bw_array *out = lbw_push_array(L, BW_F64, motion->mesh->outline->point_count, 2);
  bw_status status =
      bw_mesh_motion_pull_back(lbw_enter(L), motion, motion->mesh, gradient, (double *)out->data);
  return lbw_leave(L, status, 1);
}

/* motion:check(): itself, where its parts belong together; raises otherwise */
static int motion_check(lua_State *L) {
  const bw_mesh_motion *motion = self(L);
  lbw_leave_or_raise(L, bw_mesh_motion_check(lbw_enter(L), motion));
  lua_settop(L, 1);
  return 1;
}

LBW_PUSH(motion_mesh, lbw_push(L, &lbw_plane_mesh_class, self(L)->mesh))
LBW_PUSH(motion_outline, lbw_push(L, &lbw_outline_class, self(L)->mesh->outline))

static const luaL_Reg methods[] = {{"follow", motion_follow},
                                   {"pull_back", motion_pull_back},
                                   {"check", motion_check},
                                   {NULL, NULL}};
static const luaL_Reg properties[] = {
    {"mesh", motion_mesh}, {"outline", motion_outline}, {NULL, NULL}};
static const luaL_Reg meta[] = {{NULL, NULL}};
const lbw_class lbw_mesh_motion_class = {"mesh motion", methods, properties, meta, NULL};

void lbw_open_mesh_motion(lua_State *L) {
  lbw_class_register(L, &lbw_mesh_motion_class);
  lua_getfield(L, -1, "plane");
  lua_pushcfunction(L, plane_mesh_motion);
  lua_setfield(L, -2, "mesh_motion");
  lua_pop(L, 1);
}
