/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* model:drop, and what happens to the body. */
#include "bind.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

static const bw_drop *self(lua_State *L) {
  return (const bw_drop *)lbw_check(L, 1, &lbw_drop_class);
}

/* {height, speed, gravity, down, spin, onto, damping, modes, impacts, time, tolerance, samples,
 * history, fewer} */
static void read_options(lua_State *L, int index, bw_drop_options *options) {
  static const lbw_option list[] = {{"height", LBW_REAL, offsetof(bw_drop_options, height)},
                                    {"speed", LBW_REAL, offsetof(bw_drop_options, speed)},
                                    {"gravity", LBW_REAL, offsetof(bw_drop_options, gravity)},
                                    {"down", LBW_VECTOR, offsetof(bw_drop_options, down)},
                                    {"spin", LBW_VECTOR, offsetof(bw_drop_options, spin)},
                                    {"onto", LBW_OTHER, 0},
                                    {"damping", LBW_OTHER, 0},
                                    {"modes", LBW_OTHER, 0},
                                    {"impacts", LBW_INT, offsetof(bw_drop_options, impacts)},
                                    {"time", LBW_REAL, offsetof(bw_drop_options, time)},
                                    {"tolerance", LBW_REAL, offsetof(bw_drop_options, tolerance)},
                                    {"samples", LBW_INT, offsetof(bw_drop_options, samples)},
                                    {"history", LBW_BOOLEAN, offsetof(bw_drop_options, history)},
                                    {"fewer", LBW_BOOLEAN, offsetof(bw_drop_options, fewer)},
                                    {NULL, LBW_OTHER, 0}};
  int top = lua_gettop(L);
  bw_drop_options_default(options);
  lbw_options(L, index, "drop", list, options);
  if (lbw_option_get(L, index, "height") != LUA_TNIL &&
      lbw_option_get(L, index, "speed") != LUA_TNIL)
    lbw_error(L, "drop: one of the options 'height' and 'speed' expected, got both");
  lua_settop(L, top);
  lbw_damping_option(L, index, "drop", &options->damping, NULL, NULL);
  if (lua_istable(L, index)) { /* which keeps both */
    options->modes = (const bw_modes *)lbw_object_option(L, index, "drop", "modes",
                                                         &lbw_modes_class, "modes of the part");
    options->onto = (const bw_rigid_surface *)lbw_object_option(
        L, index, "drop", "onto", &lbw_rigid_surface_class, "a surface of bw.rigid");
  }
  lua_settop(L, top);
}

/* drop_misses(model, list of options): booleans, one for each */
static int drop_misses(lua_State *L) {
  const bw_model *model = (const bw_model *)lbw_check(L, 1, &lbw_model_class);
  lbw_check_type(L, 2, LUA_TTABLE);
  lua_settop(L, 2);
  int count = (int)lua_rawlen(L, 2);
  bw_drop_options *options =
      (bw_drop_options *)lua_newuserdatauv(L, (size_t)count * sizeof *options, 0);
  bool *misses = (bool *)lua_newuserdatauv(L, (size_t)count * sizeof *misses, 0);
  for (int i = 0; i < count; i++) {
    lua_rawgeti(L, 2, i + 1);
    read_options(L, 5, options + i);
    lua_pop(L, 1);
  }
  bw_status status = bw_drop_misses(lbw_enter(L), model, count, options, misses);
  lua_createtable(L, count, 0);
  for (int i = 0; i < count && status == BW_OK; i++) {
    lua_pushboolean(L, misses[i]);
    lua_rawseti(L, -2, i + 1);
  }
  return lbw_leave(L, status, 1);
}

static int model_drop(lua_State *L) {
  lbw_box *model = lbw_check_box(L, 1, &lbw_model_class);
  bw_drop_options options;
  lua_settop(L, 2);
  read_options(L, 2, &options);
  lbw_box *box = lbw_box_new(L, &lbw_drop_class);
  bw_drop *drop = NULL;
  bw_system *system = NULL;
  bw_status status = bw_drop_of_model(lbw_enter(L), (const bw_model *)model->object,
                                      (bw_system *)model->extra, &options, &system, &drop);
  if (status == BW_OK) {
    bw_release(model->extra);
    model->extra = system;
  }
  lbw_box_fill(L, box, drop);
  if (status == BW_OK)
    lbw_box_account(L, model);
  return lbw_leave(L, status, 1);
}

#define ROWS(name, field, rows)                                                                    \
  static int drop_##name(lua_State *L) {                                                           \
    const bw_drop *drop = self(L);                                                                 \
    if (!drop->field)                                                                              \
      return 0;                                                                                    \
    return lbw_push_borrowed(L, BW_F64, rows, 1, drop->field, drop);                               \
  }
ROWS(times, time, drop->row_count)
ROWS(forces, force, drop->row_count)
ROWS(motion_energy, motion, drop->row_count)
ROWS(vibration_energy, vibration, drop->row_count)
ROWS(strain_energy, strain, drop->row_count)
ROWS(potential_energy, potential, drop->row_count)
ROWS(damping_energy, damped, drop->row_count)
ROWS(sample_times, sample, drop->sample_count)
ROWS(sample_stresses, sample_stress, drop->sample_count)
ROWS(peak_stresses, peak_stress, drop->sample_count)
ROWS(max_principal, stress, drop->model->mesh->element_count)
ROWS(utilisation, utilisation, drop->model->mesh->element_count)
#undef ROWS

static int drop_displacement(lua_State *L) {
  const bw_drop *drop = self(L);
  if (!drop->displacement)
    return 0;
  return lbw_push_borrowed(L, BW_F64, drop->model->mesh->node_count, 3, drop->displacement, drop);
}

#define NUMBER(name, value)                                                                        \
  static int drop_##name(lua_State *L) {                                                           \
    lua_pushnumber(L, self(L)->value);                                                             \
    return 1;                                                                                      \
  }
NUMBER(mass, mass)
NUMBER(speed, speed)
NUMBER(initial_energy, energy)
NUMBER(energy_error, error)
NUMBER(obstacle_depth, depth)
NUMBER(step_length, step)
#undef NUMBER

static int drop_steps(lua_State *L) {
  lua_pushinteger(L, (lua_Integer)self(L)->steps);
  return 1;
}

static int drop_solves(lua_State *L) {
  lua_pushinteger(L, self(L)->solves);
  return 1;
}

static int drop_velocity(lua_State *L) {
  lbw_push_vector(L, self(L)->velocity);
  return 1;
}

static int drop_spin(lua_State *L) {
  lbw_push_vector(L, self(L)->spin);
  return 1;
}

static int drop_mesh(lua_State *L) {
  lbw_push(L, &lbw_mesh_class, self(L)->model->mesh);
  return 1;
}

static int drop_onto(lua_State *L) {
  lbw_push(L, &lbw_rigid_surface_class, self(L)->onto);
  return 1;
}

static int drop_modes(lua_State *L) {
  lbw_push(L, &lbw_modes_class, self(L)->modes);
  return 1;
}

static int drop_mode_count(lua_State *L) {
  lua_pushinteger(L, self(L)->mode_count);
  return 1;
}

static int drop_fewer(lua_State *L) {
  bw_drop *fewer = self(L)->fewer;
  if (!fewer)
    return 0;
  lbw_push(L, &lbw_drop_class, fewer);
  return 1;
}

static void set_number(lua_State *L, const char *key, double value) {
  lua_pushnumber(L, value);
  lua_setfield(L, -2, key);
}

static int drop_impacts(lua_State *L) {
  const bw_drop *drop = self(L);
  lua_createtable(L, drop->impact_count, 0);
  for (int i = 0; i < drop->impact_count; i++) {
    const bw_drop_impact *impact = &drop->impact[i];
    lua_createtable(L, 0, 9);
    set_number(L, "time", impact->time);
    set_number(L, "duration", impact->duration);
    set_number(L, "force", impact->force);
    set_number(L, "force_time", impact->peak_time);
    set_number(L, "impulse", impact->impulse);
    set_number(L, "area", impact->area);
    set_number(L, "turn", impact->turn);
    lua_pushinteger(L, impact->contacts);
    lua_setfield(L, -2, "contacts");
    lbw_push_vector(L, impact->place);
    lua_setfield(L, -2, "place");
    lua_rawseti(L, -2, i + 1);
  }
  return 1;
}

static void centre_of(const bw_mesh *mesh, int32_t element, double centre[3]) {
  memset(centre, 0, 3 * sizeof *centre);
  for (int a = 0; a < 4; a++) {
    const int32_t *node = mesh->element + (size_t)element * (size_t)mesh->nodes_per_element;
    for (int k = 0; k < 3; k++)
      centre[k] += mesh->node[3 * (size_t)node[a] + (size_t)k] / 4;
  }
}

static int drop_peak(lua_State *L) {
  const bw_drop *drop = self(L);
  double place[3];
  if (drop->peak_element < 0)
    return 0;
  centre_of(drop->model->mesh, drop->peak_element, place);
  lua_createtable(L, 0, 4);
  set_number(L, "stress", drop->peak);
  set_number(L, "time", drop->peak_time);
  lua_pushinteger(L, (lua_Integer)drop->peak_element + 1);
  lua_setfield(L, -2, "element");
  lbw_push_vector(L, place);
  lua_setfield(L, -2, "place");
  return 1;
}

typedef struct fewer_text {
  char text[40];
} fewer_text;

/* By how much a value differs with half of the modes. */
static fewer_text fewer_differs(double value, double fewer) {
  fewer_text out;
  double larger = fmax(fabs(value), fabs(fewer)), smaller = fmin(fabs(value), fabs(fewer));
  if (larger < 2 * smaller)
    snprintf(out.text, sizeof out.text, "by %.2g %%", 100 * fabs(fewer / value - 1));
  else
    snprintf(out.text, sizeof out.text, "by a factor of %.2g", larger / smaller);
  return out;
}

/* One line each: the drop, its first impact, the stress, the energy, what is assumed. */
static int drop_tostring(lua_State *L) {
  const bw_drop *drop = (const bw_drop *)lbw_check(L, 1, &lbw_drop_class);
  char text[2000];
  int used = snprintf(text, sizeof text, "drop of %s at %s, %d impact%s to %s, %d modes",
                      lbw_quantity(drop->mass, "kg").text, lbw_quantity(drop->speed, "m/s").text,
                      drop->impact_count, drop->impact_count == 1 ? "" : "s",
                      lbw_quantity(drop->time[drop->row_count - 1], "s").text, drop->mode_count);
#define ADD(...) used += snprintf(text + used, sizeof text - (size_t)used, __VA_ARGS__)
  if (drop->impact_count > 0) {
    const bw_drop_impact *first = &drop->impact[0];
    ADD("\n  first impact: %s at (%.4g, %.4g, %.4g) m, force %s at most, impulse %.4g N s, "
        "nodes that touch or come near: %d; normals turn in the body by %.2g degrees",
        lbw_quantity(first->duration, "s").text, first->place[0], first->place[1], first->place[2],
        lbw_quantity(first->force, "N").text, first->impulse, first->contacts,
        first->turn * 180 / M_PI);
  }
  if (drop->peak_element >= 0) {
    double place[3];
    centre_of(drop->model->mesh, drop->peak_element, place);
    ADD("\n  largest principal stress %s at %s, (%.4g, %.4g, %.4g) m, of %d times; within an "
        "element of a touching node it depends on the mesh",
        lbw_quantity(drop->peak, "Pa").text, lbw_quantity(drop->peak_time, "s").text, place[0],
        place[1], place[2], drop->sample_count);
    if (drop->utilisation) {
      double most = 0;
      for (int32_t e = 0; e < drop->model->mesh->element_count; e++)
        most = fmax(most, drop->utilisation[e]);
      ADD("; that is %.3g %% of the strength at most", 100 * most);
    }
  }
  ADD("\n  energy %s at the first touch, kept to %.1e of it", lbw_quantity(drop->energy, "J").text,
      drop->error);
  const bw_drop *fewer = drop->fewer;
  if (fewer && fewer->impact_count > 0 && drop->impact_count > 0) {
    const bw_drop_impact *one = drop->impact, *other = fewer->impact;
    ADD("\n  with half of the modes the duration changes %s, the force %s, the impulse %s",
        fewer_differs(one->duration, other->duration).text,
        fewer_differs(one->force, other->force).text,
        fewer_differs(one->impulse, other->impulse).text);
    if (drop->peak_element >= 0)
      ADD(", the stress %s", fewer_differs(drop->peak, fewer->peak).text);
    ADD("; that is no bound of the error of %d modes; error of the mesh unknown", drop->mode_count);
  } else
    ADD("\n  error of duration, force, impulse and stress by mesh and modes unknown: one mesh, one "
        "number of modes");
  ADD("\n  free motion is exact between kicks of the contact; the duration is up to two steps of "
      "%s too short",
      lbw_quantity(drop->step, "s").text);
  if (drop->onto->kind != BW_RIGID_PLANE)
    ADD("\n  onto %s of radius %s; between nodes it goes %s deep at the first touch",
        drop->onto->kind == BW_RIGID_SPHERE ? "a peg" : "an edge",
        lbw_quantity(drop->onto->radius, "m").text, lbw_quantity(drop->depth, "m").text);
  ADD("\n  linear elasticity about the motion as a rigid body, rigid %s, no friction, %s",
      drop->onto->kind == BW_RIGID_PLANE ? "plane" : "obstacle",
      drop->damped[drop->row_count - 1] > 0 ? "damping as given" : "no damping");
#undef ADD
  lua_pushstring(L, text);
  return 1;
}

static const luaL_Reg properties[] = {{"times", drop_times},
                                      {"forces", drop_forces},
                                      {"motion_energy", drop_motion_energy},
                                      {"vibration_energy", drop_vibration_energy},
                                      {"strain_energy", drop_strain_energy},
                                      {"potential_energy", drop_potential_energy},
                                      {"damping_energy", drop_damping_energy},
                                      {"sample_times", drop_sample_times},
                                      {"sample_stresses", drop_sample_stresses},
                                      {"peak_stresses", drop_peak_stresses},
                                      {"max_principal", drop_max_principal},
                                      {"utilisation", drop_utilisation},
                                      {"displacement", drop_displacement},
                                      {"mass", drop_mass},
                                      {"speed", drop_speed},
                                      {"initial_energy", drop_initial_energy},
                                      {"energy_error", drop_energy_error},
                                      {"step_length", drop_step_length},
                                      {"steps", drop_steps},
                                      {"solves", drop_solves},
                                      {"velocity", drop_velocity},
                                      {"spin", drop_spin},
                                      {"impacts", drop_impacts},
                                      {"peak", drop_peak},
                                      {"onto", drop_onto},
                                      {"obstacle_depth", drop_obstacle_depth},
                                      {"mesh", drop_mesh},
                                      {"modes", drop_modes},
                                      {"mode_count", drop_mode_count},
                                      {"fewer", drop_fewer},
                                      {NULL, NULL}};
static const luaL_Reg meta[] = {{"__tostring", drop_tostring}, {NULL, NULL}};
static const luaL_Reg methods[] = {{NULL, NULL}};
const lbw_class lbw_drop_class = {"drop", methods, properties, meta, NULL};

void lbw_open_drop(lua_State *L) {
  static const luaL_Reg of_model[] = {{"drop", model_drop}, {NULL, NULL}};
  static const luaL_Reg functions[] = {{"drop_misses", drop_misses}, {NULL, NULL}};
  lbw_class_register(L, &lbw_drop_class);
  lbw_add_methods(L, &lbw_model_class, of_model);
  luaL_setfuncs(L, functions, 0);
}
