/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* bw.material: laws given by constants, and the library's materials by name. */
#include "bind.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static const bw_material *self(lua_State *L) {
  return (const bw_material *)lbw_check(L, 1, &lbw_material_class);
}

/* The option "name", a string that stays with the options' table. */
static const char *name_option(lua_State *L, const char *function) {
  const char *name = NULL;
  int type = lbw_option_get(L, 1, "name");
  if (type == LUA_TSTRING)
    name = lua_tostring(L, -1);
  else if (type != LUA_TNIL)
    lbw_option_refused(L, function, "name", "a string");
  lua_pop(L, 1);
  return name;
}

/* The options "conductivity" (one number, three along the axes, or rows {temperature,
 * conductivity}) and "heat_capacity". */
static void thermal_options(lua_State *L, const char *function, bool isotropic,
                            bw_thermal *thermal) {
  memset(thermal, 0, sizeof *thermal);
  int type = lbw_option_get(L, 1, "conductivity");
  bool rows = false;
  if (type == LUA_TTABLE) {
    rows = lua_rawgeti(L, -1, 1) == LUA_TTABLE;
    lua_pop(L, 1);
  }
  if (type == LUA_TNUMBER)
    thermal->conductivity[0] = lua_tonumber(L, -1);
  else if (rows && isotropic) {
    int64_t count;
    const double *row = lbw_to_doubles(L, -1, "conductivity", 2, &count);
    if (count > BW_THERMAL_ROWS)
      lbw_error(L, "%s: option 'conductivity': up to %d rows expected, got %d", function,
                (int)BW_THERMAL_ROWS, (int)count);
    lua_pop(L, 1);
    thermal->rows = (int)count;
    thermal->conductivity[0] = row[1];
    for (int i = 0; i < thermal->rows; i++) {
      thermal->temperature[i] = row[2 * i];
      thermal->factor[i] = row[2 * i + 1] / row[1];
    }
  } else if (type != LUA_TNIL && (isotropic || !lbw_to_vector(L, -1, thermal->conductivity)))
    lbw_option_refused(L, function, "conductivity",
                       isotropic ? "a number in W/(m K), or rows {temperature, conductivity}"
                                 : "a number in W/(m K), or three along the axes");
  if (isotropic || type == LUA_TNUMBER)
    thermal->conductivity[1] = thermal->conductivity[2] = thermal->conductivity[0];
  lua_pop(L, 1);
  type = lbw_option_get(L, 1, "heat_capacity");
  if (type == LUA_TNUMBER)
    thermal->heat_capacity = lua_tonumber(L, -1);
  else if (type != LUA_TNIL)
    lbw_option_refused(L, function, "heat_capacity", "a number in J/(kg K)");
  lua_pop(L, 1);
}

/* The material on the way to its box, with its thermal constants. */
static int leave_material(lua_State *L, lbw_box *box, bw_status status, bw_material *made,
                          const bw_thermal *thermal) {
  bw_material *warm = NULL;
  if (status == BW_OK)
    status = bw_material_with_thermal(lbw_state_of(L)->context, made, thermal, &warm);
  bw_release(made);
  return lbw_leave_object(L, box, warm, status);
}

/* material.isotropic{young, poisson, density, strength, toughness, conductivity, heat_capacity,
 * name} */
static int material_isotropic(lua_State *L) {
  static const lbw_option list[] = {{"young", LBW_REAL, offsetof(bw_isotropic, young)},
                                    {"poisson", LBW_REAL, offsetof(bw_isotropic, poisson)},
                                    {"density", LBW_REAL, offsetof(bw_isotropic, density)},
                                    {"strength", LBW_REAL, offsetof(bw_isotropic, strength)},
                                    {"toughness", LBW_REAL, offsetof(bw_isotropic, toughness)},
                                    {"expansion", LBW_REAL, offsetof(bw_isotropic, expansion)},
                                    {"conductivity", LBW_OTHER, 0},
                                    {"heat_capacity", LBW_OTHER, 0},
                                    {"name", LBW_OTHER, 0},
                                    {NULL, LBW_OTHER, 0}};
  bw_isotropic constants;
  memset(&constants, 0, sizeof constants);
  lbw_check_type(L, 1, LUA_TTABLE);
  lbw_options(L, 1, "material.isotropic", list, &constants);
  constants.name = name_option(L, "material.isotropic");
  bw_thermal thermal;
  thermal_options(L, "material.isotropic", true, &thermal);
  lbw_box *box = lbw_box_new(L, &lbw_material_class);
  bw_material *out = NULL;
  bw_status status = bw_material_isotropic(lbw_enter(L), &constants, &out);
  return leave_material(L, box, status, out, &thermal);
}

/* material.orthotropic{young, poisson, poisson_t, shear, axes, density, strength, toughness,
 * conductivity, heat_capacity, name} */
static int material_orthotropic(lua_State *L) {
  static const lbw_option list[] = {{"young", LBW_VECTOR, offsetof(bw_orthotropic, young)},
                                    {"poisson", LBW_VECTOR, offsetof(bw_orthotropic, poisson)},
                                    {"poisson_t", LBW_VECTOR, offsetof(bw_orthotropic, poisson_t)},
                                    {"shear", LBW_VECTOR, offsetof(bw_orthotropic, shear)},
                                    {"strength", LBW_VECTOR, offsetof(bw_orthotropic, strength)},
                                    {"toughness", LBW_REAL, offsetof(bw_orthotropic, toughness)},
                                    {"expansion", LBW_REAL, offsetof(bw_orthotropic, expansion)},
                                    {"density", LBW_REAL, offsetof(bw_orthotropic, density)},
                                    {"axes", LBW_OTHER, 0},
                                    {"conductivity", LBW_OTHER, 0},
                                    {"heat_capacity", LBW_OTHER, 0},
                                    {"name", LBW_OTHER, 0},
                                    {NULL, LBW_OTHER, 0}};
  bw_orthotropic constants;
  memset(&constants, 0, sizeof constants);
  lbw_check_type(L, 1, LUA_TTABLE);
  lbw_options(L, 1, "material.orthotropic", list, &constants);
  constants.name = name_option(L, "material.orthotropic");
  if (lbw_option_get(L, 1, "axes") != LUA_TNIL)
    lbw_check_matrix(L, -1, "material.orthotropic: axes", 3, 3, constants.axes);
  bw_thermal thermal;
  thermal_options(L, "material.orthotropic", false, &thermal);
  lbw_box *box = lbw_box_new(L, &lbw_material_class);
  bw_material *out = NULL;
  bw_status status = bw_material_orthotropic(lbw_enter(L), &constants, &out);
  return leave_material(L, box, status, out, &thermal);
}

/* material.named(name); raises for an unknown name and names the nearest */
static int material_named(lua_State *L) {
  const char *name = lbw_check_text(L, 1, NULL);
  const char *known[64];
  size_t count = 0;
  bool found = false;
  for (int i = 0; i < bw_material_library_count() && count < 64; i++) {
    known[count++] = bw_material_library_name(i);
    found = found || strcmp(known[count - 1], name) == 0;
  }
  if (!found)
    return lbw_error(L, "there is no material '%s': %s", name,
                     lbw_suggestion(L, name, known, count));
  lbw_box *box = lbw_box_new(L, &lbw_material_class);
  bw_material *out = NULL;
  bw_status status = bw_material_named(lbw_enter(L), name, &out);
  return lbw_leave_object(L, box, out, status);
}

/* material.steel: looked up in the library when the module has no such function */
static int module_index(lua_State *L) {
  lua_remove(L, 1);
  return material_named(L);
}

/* material.names(): the library's names */
static int material_names(lua_State *L) {
  lua_newtable(L);
  for (int i = 0; i < bw_material_library_count(); i++) {
    lua_pushstring(L, bw_material_library_name(i));
    lua_rawseti(L, -2, i + 1);
  }
  return 1;
}

/* material:rotated(rotation): 3 x 3, turns the material's axes */
static int material_rotated(lua_State *L) {
  const bw_material *material = self(L);
  double rotation[9];
  lbw_check_matrix(L, 2, "rotation", 3, 3, rotation);
  lbw_box *box = lbw_box_new(L, &lbw_material_class);
  bw_material *out = NULL;
  bw_status status = bw_material_rotated(lbw_enter(L), material, rotation, &out);
  return lbw_leave_object(L, box, out, status);
}

static int material_strength_along(lua_State *L) {
  const bw_material *material = self(L);
  double direction[3];
  lbw_check_vector(L, 2, "direction", direction);
  double strength = bw_material_strength(material, direction);
  if (strength > 0)
    lua_pushnumber(L, strength);
  else
    lua_pushnil(L);
  return 1;
}

/* material:utilisation(stress): stress n x 6 (xx yy zz yz zx xy) -> n numbers */
static int material_utilisation(lua_State *L) {
  const bw_material *material = self(L);
  int64_t rows;
  double *stress = lbw_to_doubles(L, 2, "stress", 6, &rows);
  double *out = (double *)lbw_push_array(L, BW_F64, rows, 1)->data;
  return lbw_leave(L, bw_utilisation_field(lbw_enter(L), material, rows, stress, out), 1);
}

/* ---- properties ------------------------------------------------------------------------------ */

LBW_PUSH(material_name, lua_pushstring(L, self(L)->name))
LBW_PUSH(material_is_isotropic, lua_pushboolean(L, self(L)->isotropic))

static void push_known(lua_State *L, double value) {
  if (value > 0)
    lua_pushnumber(L, value);
  else
    lua_pushnil(L);
}

static int material_is_rotated_by_element(lua_State *L) {
  const bw_material_parts *p = self(L)->parts;
  bool turned = false;
  for (int32_t i = 0; p && i < p->count; i++)
    turned |= p->part[i] != p->unrotated[i];
  lua_pushboolean(L, turned);
  return 1;
}

static int material_density(lua_State *L) {
  push_known(L, self(L)->density);
  return 1;
}

/* One number for an isotropic material, three along the axes for others, nil where elements are of
 * several materials. */
static int push_constant(lua_State *L, const bw_material *material, const double value[3]) {
  if (bw_material_mixed(material))
    lua_pushnil(L);
  else if (material->isotropic)
    lua_pushnumber(L, value[0]);
  else
    lbw_push_vector(L, value);
  return 1;
}

static int material_young(lua_State *L) {
  const bw_material *material = self(L);
  return push_constant(L, material, material->young);
}

static int material_poisson(lua_State *L) {
  const bw_material *material = self(L);
  return push_constant(L, material, material->poisson);
}

static int material_shear(lua_State *L) {
  const bw_material *material = self(L);
  return push_constant(L, material, material->shear);
}

static int material_strength(lua_State *L) {
  const bw_material *material = self(L);
  if (!(material->strength[0] > 0)) {
    lua_pushnil(L);
    return 1;
  }
  return push_constant(L, material, material->strength);
}

static int material_toughness(lua_State *L) {
  push_known(L, self(L)->toughness);
  return 1;
}

static int material_expansion(lua_State *L) {
  const bw_material *material = self(L);
  if (material->expansion != 0)
    lua_pushnumber(L, material->expansion);
  else
    lua_pushnil(L);
  return 1;
}

/* The materials that elements are of, each once; nil where there is one */
static int material_parts(lua_State *L) {
  const bw_material *material = self(L);
  const bw_material_parts *p = material->parts;
  if (!bw_material_mixed(material))
    return 0;
  lua_newtable(L);
  int count = 0;
  for (int32_t i = 0; i < p->count; i++) {
    bool met = false;
    for (int32_t k = 0; k < i; k++)
      met |= p->unrotated[k] == p->unrotated[i];
    if (met)
      continue;
    lbw_push(L, &lbw_material_class, p->unrotated[i]);
    lua_rawseti(L, -2, ++count);
  }
  return 1;
}

static int material_critical_distance(lua_State *L) {
  push_known(L, bw_material_critical_distance(self(L)));
  return 1;
}

static int material_conductivity(lua_State *L) {
  const bw_material *material = self(L);
  if (!(material->thermal.conductivity[0] > 0)) {
    lua_pushnil(L);
    return 1;
  }
  return push_constant(L, material, material->thermal.conductivity);
}

static int material_heat_capacity(lua_State *L) {
  push_known(L, self(L)->thermal.heat_capacity);
  return 1;
}

static int material_axes(lua_State *L) {
  const bw_material *material = self(L);
  return lbw_push_borrowed(L, BW_F64, 3, 3, material->axes, material);
}

static int material_elasticity(lua_State *L) {
  const bw_material *material = self(L);
  return lbw_push_borrowed(L, BW_F64, 6, 6, material->elasticity, material);
}

static void push_value(lua_State *L, const char *key, const bw_value *value) {
  if (value->mean == 0 && !value->source)
    return;
  lua_createtable(L, 0, 3);
  lua_pushnumber(L, value->mean);
  lua_setfield(L, -2, "mean");
  push_known(L, value->scatter);
  lua_setfield(L, -2, "scatter");
  lua_pushstring(L, value->source);
  lua_setfield(L, -2, "source");
  lua_setfield(L, -2, key);
}

/* Where the values come from and how far they scatter: {young_1 = {mean, scatter, source}, ...} */
static int material_sources(lua_State *L) {
  const bw_material *material = self(L);
  lua_newtable(L);
  char key[32];
  for (int i = 0; i < 3; i++) {
    static const char *const pair[3] = {"23", "31", "12"};
    snprintf(key, sizeof key, "young_%d", i + 1);
    push_value(L, key, &material->young_value[i]);
    snprintf(key, sizeof key, "poisson_%s", pair[i]);
    push_value(L, key, &material->poisson_value[i]);
    snprintf(key, sizeof key, "strength_%d", i + 1);
    push_value(L, key, &material->strength_value[i]);
    snprintf(key, sizeof key, "conductivity_%d", i + 1);
    push_value(L, key, &material->conductivity_value[i]);
  }
  push_value(L, "heat_capacity", &material->heat_capacity_value);
  push_value(L, "density", &material->density_value);
  push_value(L, "toughness", &material->toughness_value);
  const bw_value critical = bw_material_critical_distance_value(material);
  push_value(L, "critical_distance", &critical);
  return 1;
}

static void add_source(luaL_Buffer *buffer, const char *what, const char *axis,
                       const bw_value *value, const char *unit) {
  char text[640], scatter[80] = "", digits[24];
  double scale;
  if (!value->source)
    return;
  const char *name = lbw_shown_unit(value->mean, unit, &scale);
  if (value->scatter > 0) { /* two digits: 0.27, 130 */
    snprintf(digits, sizeof digits, "%.2g", value->scatter / scale);
    snprintf(scatter, sizeof scatter, " +- %s %.16s", lbw_quantity(strtod(digits, NULL), "").text,
             name);
  }
  snprintf(text, sizeof text, "\n  %s%s %s%s: %s", what, axis, lbw_quantity(value->mean, unit).text,
           scatter, value->source);
  luaL_addstring(buffer, text);
}

/* ", strength 47 MPa", ", strengths 6.5 MPa, 4 MPa, 2 MPa" */
static void add_constants(luaL_Buffer *buffer, const char *one, const char *three, bool isotropic,
                          const double constant[3]) {
  luaL_addstring(buffer, isotropic ? one : three);
  for (int i = 0; i < (isotropic ? 1 : 3); i++) {
    luaL_addstring(buffer, i ? ", " : " ");
    luaL_addstring(buffer, lbw_quantity(constant[i], "Pa").text);
  }
}

static int material_tostring(lua_State *L) {
  const bw_material *material = (const bw_material *)lbw_check(L, 1, &lbw_material_class);
  luaL_Buffer buffer;
  luaL_buffinit(L, &buffer);
  luaL_addstring(&buffer, "material ");
  luaL_addstring(&buffer, material->name[0] ? material->name : "(unnamed)");
  if (bw_material_mixed(material)) {
    luaL_addstring(&buffer, ", several materials by element");
    luaL_pushresult(&buffer);
    return 1;
  }
  add_constants(&buffer, ", isotropic: Young's modulus", ", orthotropic: Young's moduli",
                material->isotropic, material->young);
  if (material->isotropic) {
    luaL_addstring(&buffer, ", Poisson's ratio ");
    luaL_addstring(&buffer, lbw_quantity(material->poisson[0], "").text);
  }
  if (material->parts)
    luaL_addstring(&buffer, ", axes differ by element");
  if (material->density > 0) {
    luaL_addstring(&buffer, ", density ");
    luaL_addstring(&buffer, lbw_quantity(material->density, "kg/m3").text);
  }
  if (material->expansion != 0) {
    luaL_addstring(&buffer, ", expansion ");
    luaL_addstring(&buffer, lbw_quantity(material->expansion, "1/K").text);
  }
  if (material->strength[0] > 0)
    add_constants(&buffer, ", strength", ", strengths", material->isotropic, material->strength);
  for (int i = 0; i < (material->isotropic ? 1 : 3); i++) {
    char axis[16] = "";
    if (!material->isotropic)
      snprintf(axis, sizeof axis, " %d", i + 1);
    add_source(&buffer, "Young's modulus", axis, &material->young_value[i], "Pa");
    add_source(&buffer, "strength", axis, &material->strength_value[i], "Pa");
  }
  add_source(&buffer, "density", "", &material->density_value, "kg/m3");
  add_source(&buffer, "fracture toughness", "", &material->toughness_value, "Pa m^0.5");
  add_source(&buffer, "conductivity", "", &material->conductivity_value[0], "W/(m K)");
  add_source(&buffer, "heat capacity", "", &material->heat_capacity_value, "J/(kg K)");
  const bw_value critical = bw_material_critical_distance_value(material);
  add_source(&buffer, "critical distance", "", &critical, "m");
  luaL_pushresult(&buffer);
  return 1;
}

static const luaL_Reg methods[] = {{"rotated", material_rotated},
                                   {"strength_along", material_strength_along},
                                   {"utilisation", material_utilisation},
                                   {NULL, NULL}};
static const luaL_Reg properties[] = {{"name", material_name},
                                      {"isotropic", material_is_isotropic},
                                      {"rotated_by_element", material_is_rotated_by_element},
                                      {"density", material_density},
                                      {"young", material_young},
                                      {"poisson", material_poisson},
                                      {"shear", material_shear},
                                      {"strength", material_strength},
                                      {"toughness", material_toughness},
                                      {"expansion", material_expansion},
                                      {"parts", material_parts},
                                      {"critical_distance", material_critical_distance},
                                      {"conductivity", material_conductivity},
                                      {"heat_capacity", material_heat_capacity},
                                      {"axes", material_axes},
                                      {"elasticity", material_elasticity},
                                      {"sources", material_sources},
                                      {NULL, NULL}};
static const luaL_Reg meta[] = {{"__tostring", material_tostring}, {NULL, NULL}};
const lbw_class lbw_material_class = {"material", methods, properties, meta, NULL};

void lbw_open_material(lua_State *L) {
  static const luaL_Reg functions[] = {{"isotropic", material_isotropic},
                                       {"orthotropic", material_orthotropic},
                                       {"named", material_named},
                                       {"names", material_names},
                                       {NULL, NULL}};
  lbw_class_register(L, &lbw_material_class);
  lua_newtable(L);
  luaL_setfuncs(L, functions, 0);
  lua_createtable(L, 0, 1);
  lua_pushcfunction(L, module_index);
  lua_setfield(L, -2, "__index");
  lua_setmetatable(L, -2);
  lua_setfield(L, -2, "material");
}
