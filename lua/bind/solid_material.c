/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* bw.hyperelastic: laws of large deformation given by constants, and material tables read from
 * lists. */
#include "solid.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

static const bw_solid_material *self(lua_State *L) {
  return (const bw_solid_material *)lbw_check(L, 1, &lbw_solid_material_class);
}

typedef struct constants {
  double young, poisson, mu, lambda, density;
} constants;

/* hyperelastic{law, young, poisson | mu, lambda, density, name, formulation} */
static int material_create(lua_State *L) {
  static const lbw_option list[] = {{"young", LBW_REAL, offsetof(constants, young)},
                                    {"poisson", LBW_REAL, offsetof(constants, poisson)},
                                    {"mu", LBW_REAL, offsetof(constants, mu)},
                                    {"lambda", LBW_REAL, offsetof(constants, lambda)},
                                    {"density", LBW_REAL, offsetof(constants, density)},
                                    {"law", LBW_OTHER, 0},
                                    {"name", LBW_OTHER, 0},
                                    {"formulation", LBW_OTHER, 0},
                                    {NULL, LBW_OTHER, 0}};
  static const char *const laws[] = {"neo_hookean", "st_venant_kirchhoff", "corotated",
                                     "fixed_corotated", NULL};
  static const char *const formulations[] = {"standard", "b_bar", NULL};
  static const char where[] = "hyperelastic";
  constants c = {NAN, NAN, NAN, NAN, 0};
  const char *name = NULL;
  lbw_check_type(L, 1, LUA_TTABLE);
  lbw_options(L, 1, where, list, &c);
  int law = lbw_word_option(L, 1, where, "law", laws, 0);
  bool b_bar = lbw_word_option(L, 1, where, "formulation", formulations, 0) == 1;
  int type = lbw_option_get(L, 1, "name");
  if (type != LUA_TSTRING && type != LUA_TNIL)
    return lbw_option_refused(L, where, "name", "a string");
  name = lua_tostring(L, -1); /* stays on the stack */
  bool engineering = !isnan(c.young) && !isnan(c.poisson) && isnan(c.mu) && isnan(c.lambda);
  bool lame = !isnan(c.mu) && !isnan(c.lambda) && isnan(c.young) && isnan(c.poisson);
  if (!engineering && !lame)
    return lbw_error(L, "%s: the options 'young' and 'poisson', or 'mu' and 'lambda', expected",
                     where);
  if (lame && !(c.mu > 0 && 3 * c.lambda + 2 * c.mu > 0))
    return lbw_error(
        L, "%s: mu and 3 lambda + 2 mu above 0 expected, got mu = %f Pa and lambda = %f Pa", where,
        c.mu, c.lambda);
  if (lame) {
    c.young = c.mu * (3 * c.lambda + 2 * c.mu) / (c.lambda + c.mu);
    c.poisson = c.lambda / (2 * (c.lambda + c.mu));
  }
  lbw_box *box = lbw_box_new(L, &lbw_solid_material_class);
  bw_solid_material *out = NULL;
  bw_status status = (b_bar ? bw_solid_material_b_bar : bw_solid_material_create)(
      lbw_enter(L), name, (bw_law)law, c.young, c.poisson, c.density, &out);
  return lbw_leave_object(L, box, out, status);
}

bw_material_table *lbw_read_material_table(lua_State *L, int index, const char *function) {
  index = lua_absindex(L, index);
  if (!lua_istable(L, index))
    lbw_error(L, "%s: materials: a list of materials expected, got %s", function,
              lbw_got(L, index));
  size_t count = lua_rawlen(L, index);
  const bw_solid_material **material =
      (const bw_solid_material **)lua_newuserdatauv(L, (count + 1) * sizeof *material, 0);
  for (size_t i = 0; i < count; i++) {
    lua_rawgeti(L, index, (lua_Integer)i + 1);
    material[i] = (const bw_solid_material *)lbw_test(L, -1, &lbw_solid_material_class);
    if (!material[i])
      lbw_error(L, "%s: materials: entry %d: a hyperelastic material expected, got %s", function,
                (int)i + 1, lbw_got(L, -1));
    lua_pop(L, 1); /* the list keeps it alive */
  }
  lbw_box *box = lbw_box_new(L, &lbw_material_table_class);
  bw_material_table *material_table = NULL;
  bw_status status =
      bw_material_table_create(lbw_enter(L), (int32_t)count + 1, material, &material_table);
  lbw_box_fill(L, box, material_table);
  lbw_leave_or_raise(L, status);
  lua_remove(L, -2);
  return material_table;
}

static int material_table_create(lua_State *L) {
  lbw_read_material_table(L, 1, "materials");
  return 1;
}

/* ---- properties ------------------------------------------------------------------------------ */

LBW_PUSH(material_name, lua_pushstring(L, self(L)->name))

static int material_law(lua_State *L) {
  const bw_solid_material *m = self(L);
  for (int32_t p = 1; p < m->rule->count; p++)
    if (m->law[p] != m->law[0]) {
      lua_pushstring(L, "mixed");
      return 1;
    }
  lua_pushstring(L, bw_law_word((bw_law)m->law[0]));
  return 1;
}

LBW_PUSH(material_points, lua_pushinteger(L, self(L)->rule->count))
LBW_PUSH(material_density, lua_pushnumber(L, self(L)->density))
LBW_PUSH(material_uniform, lua_pushboolean(L, self(L)->uniform))

static int material_mu(lua_State *L) {
  const bw_solid_material *m = self(L);
  return lbw_push_borrowed(L, BW_F64, m->rule->count, 1, m->mu, m);
}

static int material_lambda(lua_State *L) {
  const bw_solid_material *m = self(L);
  return lbw_push_borrowed(L, BW_F64, m->rule->count, 1, m->lambda, m);
}

static int material_fibre_stiffness(lua_State *L) {
  const bw_solid_material *m = self(L);
  return lbw_push_borrowed(L, BW_F64, m->rule->count, m->fibre_count, m->fibre_stiffness, m);
}

static int material_fibre(lua_State *L) {
  const bw_solid_material *m = self(L);
  return lbw_push_borrowed(L, BW_F64, m->rule->count, 3 * (int64_t)m->fibre_count, m->fibre, m);
}

/* young, poisson: of the first point */
static int material_young(lua_State *L) {
  double mu, lambda;
  bw_solid_material_constants(self(L), &mu, &lambda);
  lua_pushnumber(L, mu * (3 * lambda + 2 * mu) / (lambda + mu));
  return 1;
}

static int material_poisson(lua_State *L) {
  double mu, lambda;
  bw_solid_material_constants(self(L), &mu, &lambda);
  lua_pushnumber(L, lambda / (2 * (lambda + mu)));
  return 1;
}

LBW_PUSH(material_formulation, lua_pushstring(L, self(L)->b_bar ? "b_bar" : "standard"))

/* energy(F), and the stress (first Piola-Kirchhoff, a table of nine): of the first point's law */
static int material_energy(lua_State *L) {
  const bw_solid_material *m = self(L);
  double f[9], energy = 0, stress[9], mu, lambda;
  lbw_check_matrix(L, 2, "deformation gradient", 3, 3, f);
  bw_solid_material_constants(m, &mu, &lambda);
  if (!bw_law_evaluate((bw_law)m->law[0], mu, lambda, f, false, &energy, stress, NULL)) {
    lua_pushnil(L);
    lua_pushliteral(L, "the neo-Hookean law is not defined where det F <= 0");
    return 2;
  }
  lua_pushnumber(L, energy);
  bw_array *array = lbw_push_array(L, BW_F64, 3, 3);
  memcpy(array->data, stress, sizeof stress);
  return 2;
}

static int material_tostring(lua_State *L) {
  const bw_solid_material *m = self(L);
  char text[240];
  double mu, lambda;
  bw_solid_material_constants(m, &mu, &lambda);
  if (m->uniform || m->b_bar)
    snprintf(text, sizeof text, "%s: %s, mu %s, lambda %s%s", m->name,
             bw_law_word((bw_law)m->law[0]), lbw_quantity(mu, "Pa").text,
             lbw_quantity(lambda, "Pa").text, m->b_bar ? ", B-bar" : "");
  else
    snprintf(text, sizeof text, "%s: %d points, %d fibres at each", m->name, (int)m->rule->count,
             m->fibre_count);
  lua_pushstring(L, text);
  return 1;
}

static const luaL_Reg methods[] = {{"energy", material_energy}, {NULL, NULL}};
static const luaL_Reg properties[] = {{"name", material_name},
                                      {"law", material_law},
                                      {"points", material_points},
                                      {"density", material_density},
                                      {"uniform", material_uniform},
                                      {"young", material_young},
                                      {"poisson", material_poisson},
                                      {"mu", material_mu},
                                      {"lambda", material_lambda},
                                      {"fibre_stiffness", material_fibre_stiffness},
                                      {"fibre", material_fibre},
                                      {"formulation", material_formulation},
                                      {NULL, NULL}};
static const luaL_Reg meta[] = {{"__tostring", material_tostring}, {NULL, NULL}};
const lbw_class lbw_solid_material_class = {"hyperelastic", methods, properties, meta, NULL};

/* ---- material table -------------------------------------------------------------------------- */

static const bw_material_table *self_material_table(lua_State *L) {
  return (const bw_material_table *)lbw_check(L, 1, &lbw_material_table_class);
}

LBW_PUSH(material_table_count, lua_pushinteger(L, self_material_table(L)->count - 1))

/* materials:material(number) */
static int material_table_material(lua_State *L) {
  const bw_material_table *material_table = self_material_table(L);
  int64_t i = lbw_check_index(L, 2, "material", material_table->count - 1);
  lbw_push(L, &lbw_solid_material_class, material_table->material[i + 1]);
  return 1;
}

LBW_PUSH(material_table_tostring,
         lua_pushfstring(L, "table of %d materials", (int)self_material_table(L)->count - 1))

static const luaL_Reg material_table_methods[] = {{"material", material_table_material},
                                                  {NULL, NULL}};
static const luaL_Reg material_table_properties[] = {{"count", material_table_count}, {NULL, NULL}};
static const luaL_Reg material_table_meta[] = {{"__tostring", material_table_tostring},
                                               {NULL, NULL}};
const lbw_class lbw_material_table_class = {"material table", material_table_methods,
                                            material_table_properties, material_table_meta, NULL};

void lbw_open_solid_material(lua_State *L) {
  lbw_class_register(L, &lbw_solid_material_class);
  lbw_class_register(L, &lbw_material_table_class);
  lua_pushcfunction(L, material_create);
  lua_setfield(L, -2, "hyperelastic");
  lua_pushcfunction(L, material_table_create);
  lua_setfield(L, -2, "materials");
}
