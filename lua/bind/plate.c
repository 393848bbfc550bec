/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* Plates and their modes. A box holds a plate and, as its second reference, the mesh motion of its
 * mesh. What makes an instrument of it is Lua (lua/barwright/metallophone.lua). */
#include "follow.h"

#include <math.h>
#include <string.h>

static bw_plate *self(lua_State *L) {
  return (bw_plate *)lbw_check(L, 1, &lbw_plate_class);
}

static const bw_mesh_motion *mesh_motion_of(lua_State *L) {
  return (const bw_mesh_motion *)lbw_check_box(L, 1, &lbw_plate_class)->extra;
}

static int64_t nodes_of(const bw_plate *plate) {
  return plate->mesh->topology->nodes->node_count;
}

typedef struct plate_description {
  const bw_material *material;
  double thickness;
} plate_description;

static bw_status create(bw_context *context, const bw_plane_mesh *mesh, const void *description,
                        void **body) {
  const plate_description *d = (const plate_description *)description;
  bw_plate *plate = NULL;
  bw_status status = bw_plate_create(context, mesh, d->material, d->thickness, &plate);
  *body = plate;
  return status;
}

/* plate.create(outline, fill, follow, material, thickness) */
static int plate_create(lua_State *L) {
  lua_settop(L, 5);
  const bw_outline *outline = (const bw_outline *)lbw_check(L, 1, &lbw_outline_class);
  bw_follow_options follow;
  lbw_read_follow(L, 3, "plate", &follow);
  lbw_read_fill(L, 2, "plate", &follow.fill);
  follow.fill.order = 2;
  const plate_description description = {
      (const bw_material *)lbw_check(L, 4, &lbw_material_class),
      lbw_check_real(L, 5, "thickness"),
  };
  return lbw_follow_create(L, &lbw_plate_class, outline, &follow, 0, create, &description);
}

static bw_status follow_mesh(bw_context *context, void *plate, const bw_plane_mesh *mesh,
                             bw_plane_reuse *reuse) {
  return bw_plate_follow(context, (bw_plate *)plate, mesh, reuse);
}

static const void *keep(const void *plate) {
  return bw_plate_keep((const bw_plate *)plate);
}

static bw_status restore(bw_context *context, void *plate, const void *state) {
  return bw_plate_return(context, (bw_plate *)plate, (const bw_plate_state *)state);
}

static bw_status check(bw_context *context, const void *plate) {
  return bw_plate_check(context, (const bw_plate *)plate);
}

static const bw_plane_mesh *mesh_of(const void *plate) {
  return ((const bw_plate *)plate)->mesh;
}

static const lbw_followed followed = {&lbw_plate_class, follow_mesh, keep, restore, check, mesh_of};

/* plate:follow(frame, outline) */
static int plate_follow(lua_State *L) {
  return lbw_follow(L, &followed);
}

/* plate:save(), plate:restore(state) */
static int plate_save(lua_State *L) {
  return lbw_followed_keep(L, &followed);
}
static int plate_restore(lua_State *L) {
  return lbw_followed_return(L, &followed);
}
static int plate_check(lua_State *L) {
  return lbw_followed_check(L, &followed);
}

/* plate:solve(frame, {modes, tolerance, solver, max_lag, full}) */
static int plate_solve(lua_State *L) {
  static const lbw_option list[] = {{"modes", LBW_INT, offsetof(bw_plate_options, modes)},
                                    {"tolerance", LBW_REAL, offsetof(bw_plate_options, tolerance)},
                                    {"solver", LBW_OTHER, 0},
                                    {"max_lag", LBW_INT, offsetof(bw_plate_options, max_lag)},
                                    {"full", LBW_BOOLEAN, offsetof(bw_plate_options, full)},
                                    {NULL, LBW_OTHER, 0}};
  bw_plate *plate = self(L);
  lua_settop(L, 3);
  lbw_check_type(L, 2, LUA_TTABLE);
  bw_plate_options options;
  bw_plane_reuse reuse;
  bw_plate_options_default(&options);
  lbw_options(L, 3, "solve", list, &options);
  options.solver = lbw_eigensolver_option(L, 3, "solve");
  lbw_load_plane_reuse(L, 2, &reuse);
  bw_status status = bw_plate_solve(lbw_enter(L), plate, &options, &reuse);
  return lbw_leave_frame(L, &lbw_plate_class, status, &reuse);
}

/* Numbers change in place from frame to frame: each is a copy of its moment. */
static int push_copy(lua_State *L, int64_t rows, int64_t columns, const double *data) {
  bw_array *array = lbw_push_array(L, BW_F64, rows, columns);
  if (rows > 0)
    memcpy(array->data, data, (size_t)(rows * columns) * sizeof *data);
  return 1;
}

static int plate_frequencies(lua_State *L) {
  return push_copy(L, self(L)->mode_count, 1, self(L)->frequency);
}

static int mode_argument(lua_State *L, const bw_plate *plate) {
  return lua_isnoneornil(L, 2) ? 0 : (int)lbw_check_index(L, 2, "mode", plate->mode_count);
}

/* plate:mode(k): deflection and two rotations at every node */
static int plate_mode(lua_State *L) {
  const bw_plate *plate = self(L);
  int mode = mode_argument(L, plate);
  if (plate->mode_count == 0)
    return lbw_error(L, "mode: the plate has no modes: solve first");
  return push_copy(L, nodes_of(plate), 3, plate->shape + mode * 3 * nodes_of(plate));
}

/* plate:gradient(k): Hz/m by the outline's points */
static int plate_gradient(lua_State *L) {
  bw_status status = BW_OK;
  const bw_plate *plate = self(L);
  int mode = mode_argument(L, plate);
  lua_settop(L, 1);
  bw_array *nodes = lbw_push_array(L, BW_F64, nodes_of(plate), 2);
  bw_array *points = lbw_push_array(L, BW_F64, plate->mesh->outline->point_count, 2);
  bw_context *context = lbw_enter(L);
  BW_TRY(bw_plate_gradient(context, plate, mode, (double *)nodes->data));
  BW_TRY(bw_mesh_motion_pull_back(context, (bw_mesh_motion *)mesh_motion_of(L), plate->mesh,
                                  (const double *)nodes->data, (double *)points->data));
done:
  lua_settop(L, 3);
  return lbw_leave(L, status, 1);
}

/* plate:nodal_lines(k): rows x0 y0 x1 y1 */
static int plate_nodal_lines(lua_State *L) {
  const bw_plate *plate = self(L);
  int mode = mode_argument(L, plate);
  int32_t count = 0;
  double *lines = NULL;
  bw_array *array = NULL;
  bw_context *context = lbw_enter(L);
  bw_status status = bw_plate_nodal_lines(context, plate, mode, &count, &lines);
  if (status == BW_OK)
    status = bw_array_adopt(context, BW_F64, count, 4, lines, &array);
  if (status != BW_OK)
    bw_free(lines);
  lbw_leave_or_raise(L, status);
  lbw_push(L, &lbw_array_class, array);
  bw_release(array);
  return 1;
}

/* {at, loss, contact, seconds, rate} at 2, or none */
static void read_tone(lua_State *L, bw_tone *tone) {
  static const lbw_option list[] = {{"loss", LBW_REAL, offsetof(bw_tone, loss)},
                                    {"contact", LBW_REAL, offsetof(bw_tone, contact)},
                                    {"seconds", LBW_REAL, offsetof(bw_tone, seconds)},
                                    {"rate", LBW_INT, offsetof(bw_tone, rate)},
                                    {"at", LBW_OTHER, 0},
                                    {NULL, LBW_OTHER, 0}};
  lua_settop(L, 2);
  bw_tone_default(tone);
  lbw_options(L, 2, "tone", list, tone);
  if (lbw_option_get(L, 2, "at") != LUA_TNIL) {
    lbw_check_type(L, -1, LUA_TTABLE);
    for (int i = 0; i < 2; i++) {
      lua_rawgeti(L, -1, i + 1);
      tone->at[i] = lbw_check_real(L, -1, "at");
      lua_pop(L, 1);
    }
  }
  lua_settop(L, 2);
}

/* plate:tone(options): samples */
static int plate_tone(lua_State *L) {
  const bw_plate *plate = self(L);
  bw_tone tone;
  read_tone(L, &tone);
  if (!(tone.seconds > 0) || !(tone.seconds <= 600))
    return lbw_error(L, "tone: option 'seconds': a time above 0 and at most 600 s expected, got %s",
                     lbw_quantity(tone.seconds, "s").text);
  bw_array *array = lbw_push_array(L, BW_F64, (int64_t)(tone.seconds * tone.rate), 1);
  bw_status status = bw_plate_tone(lbw_enter(L), plate, &tone, (double *)array->data);
  return lbw_leave(L, status, 1);
}

/* plate:gains(options): how loudly each mode sounds */
static int plate_gains(lua_State *L) {
  const bw_plate *plate = self(L);
  bw_tone tone;
  read_tone(L, &tone);
  bw_array *array = lbw_push_array(L, BW_F64, plate->mode_count, 1);
  bw_status status = bw_plate_gains(lbw_enter(L), plate, &tone, (double *)array->data);
  return lbw_leave(L, status, 1);
}

/* plate:inplane(count): frequencies of vibrations within the plane */
static int plate_inplane(lua_State *L) {
  const bw_plate *plate = self(L);
  int count = (int)lbw_integer_or(L, 2, 1);
  if (count < 1 || count > 1000)
    return lbw_argument_refused(L, 2, "a number of modes from 1 to 1000 expected");
  bw_array *array = lbw_push_array(L, BW_F64, count, 1);
  bw_status status = bw_plate_inplane(lbw_enter(L), plate, count, (double *)array->data);
  return lbw_leave(L, status, 1);
}

static int plate_points(lua_State *L) {
  const bw_plane_mesh *mesh = self(L)->mesh;
  return lbw_push_borrowed(L, BW_F64, mesh->topology->nodes->node_count, 2, mesh->point, mesh);
}

static int plate_elements(lua_State *L) {
  const bw_plane_topology *topology = self(L)->mesh->topology;
  return lbw_push_indices(L, topology->element_count, 6, topology->element);
}

static int plate_counts(lua_State *L) {
  const bw_plane_topology *topology = self(L)->mesh->topology;
  lua_pushinteger(L, topology->element_count);
  lua_pushinteger(L, topology->nodes->node_count);
  return 2;
}

LBW_PUSH(plate_outline, lbw_push(L, &lbw_outline_class, self(L)->mesh->outline))
LBW_PUSH(plate_thickness, lua_pushnumber(L, self(L)->thickness))

/* wav_write(path, rate, samples) */
static int wav_write(lua_State *L) {
  const char *path = lbw_check_text(L, 1, NULL);
  int64_t rows = 0;
  int rate = (int)lbw_check_integer(L, 2);
  const double *sample = lbw_to_doubles(L, 3, "samples", 1, &rows);
  bw_status status = bw_wav_write(lbw_enter(L), path, rate, rows, sample);
  lua_pushboolean(L, true);
  return lbw_leave(L, status, 1);
}

static const luaL_Reg methods[] = {{"follow", plate_follow},
                                   {"save", plate_save},
                                   {"restore", plate_restore},
                                   {"check", plate_check},
                                   {"solve", plate_solve},
                                   {"mode", plate_mode},
                                   {"gradient", plate_gradient},
                                   {"nodal_lines", plate_nodal_lines},
                                   {"tone", plate_tone},
                                   {"gains", plate_gains},
                                   {"inplane", plate_inplane},
                                   {"counts", plate_counts},
                                   {NULL, NULL}};
static const luaL_Reg properties[] = {
    {"frequencies", plate_frequencies}, {"points", plate_points},
    {"elements", plate_elements},       {"outline", plate_outline},
    {"thickness", plate_thickness},     {NULL, NULL}};
static const luaL_Reg meta[] = {{NULL, NULL}};
const lbw_class lbw_plate_class = {"plate", methods, properties, meta, NULL};

void lbw_open_plate(lua_State *L) {
  static const luaL_Reg functions[] = {{"create", plate_create}, {NULL, NULL}};
  lbw_class_register(L, &lbw_plate_class);
  lua_newtable(L);
  luaL_setfuncs(L, functions, 0);
  lua_setfield(L, -2, "plate");
  lua_pushcfunction(L, wav_write);
  lua_setfield(L, -2, "wav_write");
}
