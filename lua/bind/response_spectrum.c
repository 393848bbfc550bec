/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* Responses of models to a response spectrum. */
#include "bind.h"

static const bw_response_spectrum *self(lua_State *L) {
  return (const bw_response_spectrum *)lbw_check(L, 1, &lbw_response_spectrum_class);
}

/* model:response_spectrum{points, direction, damping, combination, missing_mass, solver, modes} */
static int model_response_spectrum(lua_State *L) {
  static const char *const words[] = {"cqc", "srss", "absolute", NULL};
  static const bw_combination combinations[] = {BW_CQC, BW_SRSS, BW_ABSOLUTE};
  static const lbw_option list[] = {
      {"points", LBW_OTHER, 0},
      {"direction", LBW_VECTOR, offsetof(bw_response_spectrum_options, direction)},
      {"damping", LBW_REAL, offsetof(bw_response_spectrum_options, ratio)},
      {"combination", LBW_OTHER, 0},
      {"missing_mass", LBW_BOOLEAN, offsetof(bw_response_spectrum_options, missing_mass)},
      {"solver", LBW_OTHER, 0},
      {"modes", LBW_OTHER, 0},
      {NULL, LBW_OTHER, 0}};
  lbw_box *model = lbw_check_box(L, 1, &lbw_model_class);
  bw_response_spectrum_options options;
  int64_t count;
  lua_settop(L, 2);
  bw_response_spectrum_options_default(&options);
  lbw_options(L, 2, "response_spectrum", list, &options);
  options.solver = lbw_eigensolver_option(L, 2, "response_spectrum");
  options.modes =
      (bw_modes *)lbw_object_option(L, 2, "response_spectrum", "modes", &lbw_modes_class, "modes");
  options.combination =
      combinations[lbw_word_option(L, 2, "response_spectrum", "combination", words, 0)];
  lua_settop(L, 2);
  lbw_option_get(L, 2, "points");
  if (lua_isnil(L, 3))
    return lbw_error(L, "response_spectrum: option 'points' is missing: rows of a frequency in Hz "
                        "and an acceleration in m/s2");
  options.frequency = lbw_to_points(L, 3, "response_spectrum: option 'points'", &count);
  options.acceleration = options.frequency + count;
  options.count = (int)count;
  lbw_box *box = lbw_box_new(L, &lbw_response_spectrum_class);
  bw_system *system = NULL;
  bw_response_spectrum *response = NULL;
  bw_status status =
      bw_response_spectrum_of_model(lbw_enter(L), (const bw_model *)model->object,
                                    (bw_system *)model->extra, &options, &system, &response);
  if (system) {
    bw_release(model->extra);
    model->extra = system;
  }
  lbw_box_fill(L, box, response);
  lbw_box_account(L, model);
  return lbw_leave(L, status, 1);
}

static int numbers(lua_State *L, int64_t rows, const double *value) {
  return lbw_push_borrowed(L, BW_F64, rows, 1, value, self(L));
}

static int spectrum_participation(lua_State *L) {
  return numbers(L, self(L)->count, self(L)->participation);
}

static int spectrum_effective_masses(lua_State *L) {
  return numbers(L, self(L)->count, self(L)->effective_mass);
}

static int spectrum_accelerations(lua_State *L) {
  return numbers(L, self(L)->count, self(L)->acceleration);
}

static int spectrum_von_mises(lua_State *L) {
  return numbers(L, self(L)->model->mesh->node_count, self(L)->von_mises);
}

static int spectrum_displacement(lua_State *L) {
  return lbw_push_borrowed(L, BW_F64, self(L)->model->mesh->node_count, 3, self(L)->displacement,
                           self(L));
}

static int vector(lua_State *L, const double x[3]) {
  lua_createtable(L, 3, 0);
  for (int j = 0; j < 3; j++) {
    lua_pushnumber(L, x[j]);
    lua_rawseti(L, -2, j + 1);
  }
  return 1;
}

static int spectrum_base_force(lua_State *L) {
  return vector(L, self(L)->base_force);
}

/* Of remote points: a table for each coupling. */
static int spectrum_couplings(lua_State *L) {
  const bw_response_spectrum *r = self(L);
  lua_createtable(L, r->coupling_count, 0);
  for (int p = 0; p < r->coupling_count; p++) {
    lua_createtable(L, 0, 2);
    vector(L, r->point + 6 * (size_t)p);
    lua_setfield(L, -2, "displacement");
    vector(L, r->point + 6 * (size_t)p + 3);
    lua_setfield(L, -2, "rotation");
    lua_rawseti(L, -2, p + 1);
  }
  return 1;
}

static int spectrum_direction(lua_State *L) {
  return vector(L, self(L)->direction);
}

static int spectrum_mass(lua_State *L) {
  lua_pushnumber(L, self(L)->mass);
  return 1;
}

static int spectrum_missing_mass(lua_State *L) {
  lua_pushnumber(L, self(L)->missing_mass);
  return 1;
}

static int spectrum_base_acceleration(lua_State *L) {
  lua_pushnumber(L, self(L)->base);
  return 1;
}

static int spectrum_combination(lua_State *L) {
  bw_combination c = self(L)->combination;
  lua_pushstring(L, c == BW_CQC ? "cqc" : c == BW_SRSS ? "srss" : "absolute");
  return 1;
}

static int spectrum_modes(lua_State *L) {
  lbw_push(L, &lbw_modes_class, self(L)->modes);
  return 1;
}

static int spectrum_mesh(lua_State *L) {
  lbw_push(L, &lbw_mesh_class, self(L)->model->mesh);
  return 1;
}

/* spectra_of_one_model(a, b): whether a model did not change between them, unless by loads: modes
 * that both have were checked against it each time */
static int core_spectra_of_one_model(lua_State *L) {
  const bw_response_spectrum *a = self(L), *b = lbw_check(L, 2, &lbw_response_spectrum_class);
  bool same = a->revision == b->revision ||
              (a->modes == b->modes && a->coupling_count == b->coupling_count);
  lua_pushboolean(L, a->model == b->model && same);
  return 1;
}

static const luaL_Reg methods[] = {{NULL, NULL}};
static const luaL_Reg properties[] = {{"participation", spectrum_participation},
                                      {"effective_masses", spectrum_effective_masses},
                                      {"accelerations", spectrum_accelerations},
                                      {"von_mises", spectrum_von_mises},
                                      {"displacement", spectrum_displacement},
                                      {"base_force", spectrum_base_force},
                                      {"couplings", spectrum_couplings},
                                      {"direction", spectrum_direction},
                                      {"mass", spectrum_mass},
                                      {"missing_mass", spectrum_missing_mass},
                                      {"base_acceleration", spectrum_base_acceleration},
                                      {"combination", spectrum_combination},
                                      {"modes", spectrum_modes},
                                      {"mesh", spectrum_mesh},
                                      {NULL, NULL}};
static const luaL_Reg meta[] = {{NULL, NULL}};
const lbw_class lbw_response_spectrum_class = {"response_spectrum", methods, properties, meta,
                                               NULL};

void lbw_open_response_spectrum(lua_State *L) {
  static const luaL_Reg of_model[] = {{"response_spectrum", model_response_spectrum}, {NULL, NULL}};
  static const luaL_Reg functions[] = {{"spectra_of_one_model", core_spectra_of_one_model},
                                       {NULL, NULL}};
  lbw_class_register(L, &lbw_response_spectrum_class);
  lbw_add_methods(L, &lbw_model_class, of_model);
  luaL_setfuncs(L, functions, 0);
}
