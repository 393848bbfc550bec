/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* Harmonic responses of models. */
#include "bind.h"

#include <math.h>
#include <stdio.h>

static const bw_harmonic *self(lua_State *L) {
  return (const bw_harmonic *)lbw_check(L, 1, &lbw_harmonic_class);
}

/* The table of loss factors by the names of regions at the top of the stack, which is replaced by
 * them in the order of the regions. */
static const double *read_region_loss(lua_State *L, const bw_mesh *mesh, const char *function) {
  size_t count = (size_t)mesh->region_count;
  int table = lua_gettop(L);
  double *loss = (double *)lua_newuserdatauv(L, (count + 1) * sizeof *loss, 0);
  for (size_t i = 0; i < count; i++)
    loss[i] = 0;
  for (lua_pushnil(L); lua_next(L, table); lua_pop(L, 1)) {
    if (lua_type(L, -2) != LUA_TSTRING)
      lbw_error(L, "%s: damping: option 'loss': names of regions expected, got %s", function,
                lbw_got(L, -2));
    int32_t region = lbw_check_region(L, lua_gettop(L) - 1, mesh);
    if (lua_type(L, -1) != LUA_TNUMBER)
      lbw_error(L, "%s: damping: option 'loss': a number for region '%s' expected, got %s",
                function, mesh->regions[region].name.text, lbw_got(L, -1));
    loss[region] = lua_tonumber(L, -1);
  }
  lua_replace(L, table);
  return loss;
}

void lbw_damping_option(lua_State *L, int index, const char *function, bw_damping *damping,
                        const bw_mesh *mesh, const double **region_loss) {
  lbw_option list[] = {{"ratio", LBW_REAL, offsetof(bw_damping, ratio)},
                       {"mass", LBW_REAL, offsetof(bw_damping, mass)},
                       {"stiffness", LBW_REAL, offsetof(bw_damping, stiffness)},
                       {"loss", LBW_REAL, offsetof(bw_damping, loss)},
                       {NULL, LBW_OTHER, 0}};
  char inner[100];
  int type = lbw_option_get(L, index, "damping"), table = lua_gettop(L);
  snprintf(inner, sizeof inner, "%s: damping", function);
  if (type != LUA_TTABLE && type != LUA_TNIL)
    lbw_option_refused(L, function, "damping",
                       "a table with ratio, mass, stiffness or loss, such as {ratio = 0.02}");
  if (mesh && lbw_option_get(L, table, "loss") == LUA_TTABLE) {
    *region_loss = read_region_loss(L, mesh, function);
    list[3].type = LBW_OTHER;
  }
  if (type == LUA_TTABLE)
    lbw_options(L, table, inner, list, damping);
  lua_settop(L, mesh ? table + 1 : table);
  if (mesh)
    lua_remove(L, table);
}

const double *lbw_to_points(lua_State *L, int index, const char *what, int64_t *count) {
  const double *row = lbw_to_doubles(L, index, what, 2, count);
  if (*count > 1000000)
    lbw_error(L, "%s: at most 1000000 points expected", what);
  double *column = (double *)lua_newuserdatauv(L, (size_t)*count * 2 * sizeof(double) + 1, 0);
  for (int64_t i = 0; i < *count; i++) {
    column[i] = row[2 * i];
    column[*count + i] = row[2 * i + 1];
  }
  return column;
}

/* model:harmonic{frequencies or range, modes, residual_vectors, tolerance, damping, base, solver}
 */
static int model_harmonic(lua_State *L) {
  static const lbw_option list[] = {
      {"frequencies", LBW_OTHER, 0},
      {"range", LBW_OTHER, 0},
      {"modes", LBW_INT, offsetof(bw_harmonic_options, modes)},
      {"residual_vectors", LBW_INT, offsetof(bw_harmonic_options, vectors)},
      {"tolerance", LBW_REAL, offsetof(bw_harmonic_options, tolerance)},
      {"damping", LBW_OTHER, 0},
      {"base", LBW_VECTOR, offsetof(bw_harmonic_options, base)},
      {"solver", LBW_OTHER, 0},
      {NULL, LBW_OTHER, 0}};
  lbw_box *model = lbw_check_box(L, 1, &lbw_model_class);
  bw_harmonic_options options;
  int64_t count;
  lua_settop(L, 2);
  bw_harmonic_options_default(&options);
  lbw_options(L, 2, "harmonic", list, &options);
  lbw_damping_option(L, 2, "harmonic", &options.damping, ((const bw_model *)model->object)->mesh,
                     &options.region_loss);
  options.solver = lbw_eigensolver_option(L, 2, "harmonic");
  lua_settop(L, 3); /* the memory of the regions' losses */
  bool has_list = lbw_option_get(L, 2, "frequencies") != LUA_TNIL;
  bool has_range = lbw_option_get(L, 2, "range") != LUA_TNIL;
  if (has_list == has_range)
    return lbw_error(L,
                     "harmonic: either 'frequencies', a list in Hz, or 'range', {from, to} in Hz, "
                     "expected");
  const double *number = lbw_to_doubles(
      L, has_list ? 4 : 5, has_list ? "harmonic: option 'frequencies'" : "harmonic: option 'range'",
      1, &count);
  if (has_range && count != 2)
    return lbw_error(L, "harmonic: option 'range': two frequencies {from, to} in Hz expected");
  if (has_range) {
    options.from = number[0];
    options.to = number[1];
  } else {
    if (count < 1 || count > 1000000)
      return lbw_error(L, "harmonic: option 'frequencies': 1 to 1000000 numbers expected");
    options.frequency = number; /* its userdata is on the stack */
    options.frequency_count = (int)count;
  }
  lbw_box *box = lbw_box_new(L, &lbw_harmonic_class);
  bw_system *system = NULL;
  bw_harmonic *harmonic = NULL;
  bw_status status = bw_harmonic_of_model(lbw_enter(L), (const bw_model *)model->object,
                                          (bw_system *)model->extra, &options, &system, &harmonic);
  if (system) {
    bw_release(model->extra);
    model->extra = system;
  }
  lbw_box_fill(L, box, harmonic);
  lbw_box_account(L, model);
  return lbw_leave(L, status, 1);
}

/* harmonic:displacement(frequency): real and imaginary part */
static int harmonic_displacement(lua_State *L) {
  const bw_harmonic *h = self(L);
  double frequency = lbw_check_real(L, 2, "frequency");
  int64_t nodes = h->model->mesh->node_count;
  double *real = (double *)lbw_push_array(L, BW_F64, nodes, 3)->data;
  double *imaginary = (double *)lbw_push_array(L, BW_F64, nodes, 3)->data;
  return lbw_leave(L, bw_harmonic_displacement(lbw_enter(L), h, frequency, real, imaginary), 2);
}

/* harmonic:stress(frequency): real and imaginary part */
static int harmonic_stress(lua_State *L) {
  const bw_harmonic *h = self(L);
  double frequency = lbw_check_real(L, 2, "frequency");
  int64_t nodes = h->model->mesh->node_count;
  double *real = (double *)lbw_push_array(L, BW_F64, nodes, 6)->data;
  double *imaginary = (double *)lbw_push_array(L, BW_F64, nodes, 6)->data;
  return lbw_leave(L, bw_harmonic_stress(lbw_enter(L), h, frequency, real, imaginary, NULL), 2);
}

/* harmonic:von_mises(frequency): the largest over a period */
static int harmonic_von_mises(lua_State *L) {
  const bw_harmonic *h = self(L);
  double frequency = lbw_check_real(L, 2, "frequency");
  double *out = (double *)lbw_push_array(L, BW_F64, h->model->mesh->node_count, 1)->data;
  return lbw_leave(L, bw_harmonic_stress(lbw_enter(L), h, frequency, NULL, NULL, out), 1);
}

/* The frequencies of argument 3, or those of the response: 1 to a million. */
static const double *frequencies_of(lua_State *L, const bw_harmonic *h, const char *what,
                                    int64_t *count) {
  const double *frequency = h->frequency;
  *count = h->frequency_count;
  if (!lua_isnil(L, 3))
    frequency = lbw_to_doubles(L, 3, what, 1, count);
  if (*count < 1 || *count > 1000000)
    lbw_error(L, "%s: 1 to 1000000 frequencies expected", what);
  return frequency;
}

/* harmonic:at_node(node, frequencies): a row for each frequency, real then imaginary part */
static int harmonic_at_node(lua_State *L) {
  const bw_harmonic *h = self(L);
  int64_t node = lbw_check_index(L, 2, "node", h->model->mesh->node_count), count;
  lua_settop(L, 3);
  const double *frequency = frequencies_of(L, h, "at_node: frequencies", &count);
  double *out = (double *)lbw_push_array(L, BW_F64, count, 6)->data;
  return lbw_leave(L, bw_harmonic_curve(lbw_enter(L), h, (int32_t)node, (int)count, frequency, out),
                   1);
}

/* harmonic:at_coupling(coupling, frequencies): a row for each frequency: displacement and rotation
 * of the remote point, real then imaginary part; and where it is */
static int harmonic_at_coupling(lua_State *L) {
  const bw_harmonic *h = self(L);
  int64_t coupling = lbw_check_index(L, 2, "coupling", h->coupling_count), count;
  lua_settop(L, 3);
  const double *frequency = frequencies_of(L, h, "at_coupling: frequencies", &count);
  double *out = (double *)lbw_push_array(L, BW_F64, count, 12)->data;
  lbw_push_vector(L, h->point + 3 * coupling);
  return lbw_leave(
      L, bw_harmonic_point_curve(lbw_enter(L), h, (int)coupling, (int)count, frequency, out), 2);
}

/* harmonic:envelope(of_stress, frequencies): of von Mises stress, else of displacement, the largest
 * at each node and its frequency, and the largest at each frequency and its node */
static int harmonic_envelope(lua_State *L) {
  const bw_harmonic *h = self(L);
  bool of_stress = lua_toboolean(L, 2);
  int64_t nodes = h->model->mesh->node_count, count;
  lua_settop(L, 3);
  const double *frequency = frequencies_of(L, h, "envelope: option 'frequencies'", &count);
  double *value = (double *)lbw_push_array(L, BW_F64, nodes, 1)->data;
  double *at = (double *)lbw_push_array(L, BW_F64, nodes, 1)->data;
  double *peak = (double *)lbw_push_array(L, BW_F64, count, 1)->data;
  int32_t *place = (int32_t *)lbw_push_array(L, BW_I32, count, 1)->data;
  bw_status status = bw_harmonic_envelope(
      lbw_enter(L), h, of_stress ? BW_HARMONIC_VON_MISES : BW_HARMONIC_DISPLACEMENT, (int)count,
      frequency, value, at, peak, place);
  for (int64_t i = 0; i < count; i++)
    place[i]++;
  return lbw_leave(L, status, 4);
}

/* harmonic:random(psd), rows {Hz, density}: root mean squares of displacement and von Mises stress,
 * root mean squares of remote points (coupling_count x 6), and the error */
static int harmonic_random(lua_State *L) {
  const bw_harmonic *h = self(L);
  int64_t nodes = h->model->mesh->node_count, count;
  lua_settop(L, 2);
  const double *frequency = lbw_to_points(L, 2, "random: option 'psd'", &count);
  double *displacement = (double *)lbw_push_array(L, BW_F64, nodes, 3)->data;
  double *von_mises = (double *)lbw_push_array(L, BW_F64, nodes, 1)->data, error = 0;
  double *motion = (double *)lbw_push_array(L, BW_F64, h->coupling_count, 6)->data;
  bw_status status = bw_harmonic_random(lbw_enter(L), h, (int)count, frequency, frequency + count,
                                        displacement, von_mises, motion, &error);
  lua_pushnumber(L, error);
  return lbw_leave(L, status, 4);
}

/* harmonic:random_margins(psd, strength, sigma): probability, rate of upcrossings, used part of the
 * strength and probability beyond sigma, per node. strength 0: that of the material */
static int harmonic_random_margins(lua_State *L) {
  const bw_harmonic *h = self(L);
  int64_t nodes = h->model->mesh->node_count, count;
  double strength = lbw_check_real(L, 3, "margins: option 'strength'");
  double sigma = lbw_check_real(L, 4, "margins: option 'sigma'"), *out[4];
  lua_settop(L, 4);
  const double *frequency = lbw_to_points(L, 2, "random: option 'psd'", &count);
  for (int k = 0; k < 4; k++)
    out[k] = (double *)lbw_push_array(L, BW_F64, nodes, 1)->data;
  bw_status status = bw_harmonic_margins(lbw_enter(L), h, (int)count, frequency, frequency + count,
                                         strength, sigma, out[0], out[1], out[2], out[3]);
  return lbw_leave(L, status, 4);
}

/* harmonic:random_damage(psd, curve): damage per time and spectral moments, per node */
static int harmonic_random_damage(lua_State *L) {
  const bw_harmonic *h = self(L);
  int64_t nodes = h->model->mesh->node_count, count;
  bw_life_curve curve;
  lua_settop(L, 3);
  lbw_check_life_curve(L, 3, &curve);
  const double *frequency = lbw_to_points(L, 2, "random: option 'psd'", &count);
  double *rate = (double *)lbw_push_array(L, BW_F64, nodes, 1)->data;
  double *moment = (double *)lbw_push_array(L, BW_F64, nodes, 4)->data;
  bw_status status = bw_harmonic_random_damage(lbw_enter(L), h, (int)count, frequency,
                                               frequency + count, &curve, rate, moment);
  return lbw_leave(L, status, 2);
}

static int harmonic_frequencies(lua_State *L) {
  return lbw_push_borrowed(L, BW_F64, self(L)->frequency_count, 1, self(L)->frequency, self(L));
}

static int harmonic_errors(lua_State *L) {
  return lbw_push_borrowed(L, BW_F64, self(L)->frequency_count, 1, self(L)->error, self(L));
}

static int harmonic_losses(lua_State *L) {
  return lbw_push_borrowed(L, BW_F64, self(L)->modes->count, 1, self(L)->loss, self(L));
}

static int harmonic_modes(lua_State *L) {
  lbw_push(L, &lbw_modes_class, self(L)->modes);
  return 1;
}

static int harmonic_mesh(lua_State *L) {
  lbw_push(L, &lbw_mesh_class, self(L)->model->mesh);
  return 1;
}

static int harmonic_residual_vectors(lua_State *L) {
  lua_pushinteger(L, self(L)->count - self(L)->modes->count);
  return 1;
}

static int harmonic_solves(lua_State *L) {
  lua_pushinteger(L, self(L)->solves);
  return 1;
}

static bool is_damped(const bw_harmonic *h) {
  bool damped = h->damping.ratio > 0 || h->damping.mass > 0 || h->damping.stiffness > 0 ||
                h->damping.loss > 0;
  for (int k = 0; k < h->modes->count; k++)
    damped = damped || h->loss[k] > 0;
  return damped;
}

static int harmonic_damped(lua_State *L) {
  lua_pushboolean(L, is_damped(self(L)));
  return 1;
}

static int harmonic_tostring(lua_State *L) {
  const bw_harmonic *h = (const bw_harmonic *)lbw_check(L, 1, &lbw_harmonic_class);
  int modes = h->modes->count;
  double largest = 0;
  char text[400], error[80] = "unknown";
  for (int k = 0; k < h->frequency_count; k++)
    largest = fmax(largest, h->error[k]);
  if (isfinite(largest))
    snprintf(error, sizeof error, "%s %.1e of the displacement, in energy",
             h->modes->counted ? "at most" : "about", largest);
  snprintf(text, sizeof text,
           "harmonic response at %d frequencies, %.4g to %.4g Hz, by %d modes (%s) and %d residual "
           "vectors%s; error of the equations %s; error of the mesh unknown",
           h->frequency_count, h->frequency[0], h->frequency[h->frequency_count - 1], modes,
           h->modes->counted ? "counted: none is missing" : "not counted", h->count - modes,
           is_damped(h) ? "" : "; without damping: at a natural frequency it has no limit", error);
  lua_pushstring(L, text);
  return 1;
}

static const luaL_Reg methods[] = {{"displacement", harmonic_displacement},
                                   {"stress", harmonic_stress},
                                   {"von_mises", harmonic_von_mises},
                                   {"at_node", harmonic_at_node},
                                   {"at_coupling", harmonic_at_coupling},
                                   {"envelope", harmonic_envelope},
                                   {"random", harmonic_random},
                                   {"random_margins", harmonic_random_margins},
                                   {"random_damage", harmonic_random_damage},
                                   {NULL, NULL}};
static const luaL_Reg properties[] = {{"frequencies", harmonic_frequencies},
                                      {"errors", harmonic_errors},
                                      {"losses", harmonic_losses},
                                      {"damped", harmonic_damped},
                                      {"modes", harmonic_modes},
                                      {"mesh", harmonic_mesh},
                                      {"residual_vectors", harmonic_residual_vectors},
                                      {"solves", harmonic_solves},
                                      {NULL, NULL}};
static const luaL_Reg meta[] = {{"__tostring", harmonic_tostring}, {NULL, NULL}};
const lbw_class lbw_harmonic_class = {"harmonic", methods, properties, meta, NULL};

void lbw_open_harmonic(lua_State *L) {
  static const luaL_Reg of_model[] = {{"harmonic", model_harmonic}, {NULL, NULL}};
  lbw_class_register(L, &lbw_harmonic_class);
  lbw_add_methods(L, &lbw_model_class, of_model);
}
