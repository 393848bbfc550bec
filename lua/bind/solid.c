/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* Hyperelastic solids on grids: energies, what acts on them, static solutions. Selections, and what
 * is transferred to coarse grids, are Lua (lua/barwright/solids.lua). */
#include "solid.h"

#include <stdio.h>
#include <string.h>

static const bw_solid *self(lua_State *L) {
  return (const bw_solid *)lbw_check(L, 1, &lbw_solid_class);
}

const bw_material_table *lbw_check_material_table(lua_State *L, int index, const char *function) {
  const bw_material_table *material_table =
      (const bw_material_table *)lbw_test(L, index, &lbw_material_table_class);
  if (!material_table)
    return lbw_read_material_table(L, index, function);
  lua_pushvalue(L, index);
  return material_table;
}

double *lbw_read_displacement(lua_State *L, int index, const char *what, const bw_grid *grid) {
  int64_t rows;
  if (lua_isnoneornil(L, index)) {
    lua_pushnil(L);
    return NULL;
  }
  double *u = lbw_to_doubles(L, index, what, 3, &rows);
  lbw_require_rows(L, what, rows, grid->node_count, "node");
  return u;
}

static void set_number(lua_State *L, const char *key, double value) {
  lua_pushnumber(L, value);
  lua_setfield(L, -2, key);
}

static void set_integer(lua_State *L, const char *key, int64_t value) {
  lua_pushinteger(L, value);
  lua_setfield(L, -2, key);
}

void lbw_push_solid_shape(lua_State *L, const bw_solid_shape *shape) {
  lua_createtable(L, 0, 4);
  set_number(L, "min_ratio", shape->min_ratio);
  set_integer(L, "worst_element", shape->worst + 1);
  set_integer(L, "inverted", shape->inverted);
  lua_pushboolean(L, shape->defined);
  lua_setfield(L, -2, "defined");
}

void lbw_push_newton_report(lua_State *L, const bw_newton_report *r) {
  lua_createtable(L, 0, 20);
  set_integer(L, "iterations", r->iterations);
  set_integer(L, "load_steps", r->load_steps);
  set_integer(L, "failed_steps", r->failed_steps);
  set_integer(L, "factorisations", r->factorisations);
  set_integer(L, "analyses", r->analyses);
  set_integer(L, "evaluations", r->evaluations);
  set_integer(L, "cg_iterations", r->cg_iterations);
  set_integer(L, "stability_iterations", r->stability_iterations);
  set_integer(L, "undecided", r->undecided);
  set_integer(L, "contacts", r->contacts);
  set_number(L, "load", r->load);
  set_number(L, "residual", r->residual);
  set_number(L, "seconds_quadrature", r->seconds_quadrature);
  set_number(L, "seconds_analysis", r->seconds_analysis);
  set_number(L, "seconds_factor", r->seconds_factor);
  set_number(L, "seconds_solve", r->seconds_solve);
  set_number(L, "seconds", r->seconds);
  lbw_push_solid_shape(L, &r->shape);
  lua_setfield(L, -2, "shape");
  lua_createtable(L, r->history_count, 0);
  for (int i = 0; i < r->history_count; i++) {
    const bw_newton_entry *h = &r->history[i];
    lua_createtable(L, 0, 8);
    set_number(L, "load", h->load);
    set_number(L, "energy", h->energy);
    set_number(L, "residual", h->residual);
    set_number(L, "step", h->step);
    set_integer(L, "cg_iterations", h->cg);
    set_integer(L, "contacts", h->contacts);
    lua_pushboolean(L, h->projected);
    lua_setfield(L, -2, "projected");
    lua_rawseti(L, -2, i + 1);
  }
  lua_setfield(L, -2, "history");
}

/* ---- solids ---------------------------------------------------------------------------------- */

/* solid.create(grid, material table, previous | nil) */
static int solid_create(lua_State *L) {
  lua_settop(L, 3);
  const bw_grid *grid = (const bw_grid *)lbw_check(L, 1, &lbw_grid_class);
  const bw_material_table *material_table = lbw_check_material_table(L, 2, "solid");
  const bw_solid *previous = (const bw_solid *)lbw_test(L, 3, &lbw_solid_class);
  lbw_box *box = lbw_box_new(L, &lbw_solid_class);
  bw_solid *solid = NULL;
  bw_status status = bw_solid_create(lbw_enter(L), grid, material_table, previous, &solid);
  return lbw_leave_object(L, box, solid, status);
}

/* solid:evaluate(displacement): energy, gradient, shape */
static int solid_evaluate(lua_State *L) {
  const bw_solid *solid = self(L);
  const double *u = lbw_read_displacement(L, 2, "displacement", solid->grid);
  double energy = 0;
  bw_solid_shape shape;
  if (!u)
    return lbw_error(L, "evaluate: displacement: an array of %d x 3 expected, got nil",
                     (int)solid->grid->node_count);
  bw_array *gradient = lbw_push_array(L, BW_F64, solid->grid->node_count, 3);
  int place = lua_gettop(L);
  bw_status status = bw_solid_evaluate(lbw_enter(L), solid, u, false, &energy,
                                       (double *)gradient->data, NULL, &shape);
  lbw_leave_or_raise(L, status);
  if (shape.defined) {
    lua_pushnumber(L, energy);
    lua_pushvalue(L, place);
  } else {
    lua_pushnil(L);
    lua_pushnil(L);
  }
  lbw_push_solid_shape(L, &shape);
  return 3;
}

/* solid:stress(displacement, of_nodes): Cauchy, rows of six */
static int solid_stress(lua_State *L) {
  const bw_solid *solid = self(L);
  lua_settop(L, 3);
  const double *u = lbw_read_displacement(L, 2, "displacement", solid->grid);
  bool nodes = lua_toboolean(L, 3);
  if (!u)
    return lbw_error(L, "stress: displacement: an array of %d x 3 expected, got nil",
                     (int)solid->grid->node_count);
  int64_t rows = nodes ? solid->grid->node_count : solid->grid->element_count;
  double *out = (double *)lbw_push_array(L, BW_F64, rows, 6)->data;
  bw_status status =
      bw_solid_stress(lbw_enter(L), solid, u, nodes ? NULL : out, nodes ? out : NULL);
  return lbw_leave(L, status, 1);
}

LBW_PUSH(solid_grid, lbw_push(L, &lbw_grid_class, self(L)->grid))
LBW_PUSH(solid_material_table, lbw_push(L, &lbw_material_table_class, self(L)->material_table))

static int solid_mass(lua_State *L) {
  const bw_solid *solid = self(L);
  return lbw_push_borrowed(L, BW_F64, solid->grid->node_count, 1, solid->mass, solid);
}

/* What warns of volumetric locking, or nil. */
LBW_PUSH(solid_locking, lua_pushstring(L, bw_solid_locking(self(L))))

/* "b_bar" where a material of the material table is. */
static int solid_formulation(lua_State *L) {
  const bw_material_table *material_table = self(L)->material_table;
  bool b_bar = false;
  for (int32_t i = 1; i < material_table->count; i++)
    b_bar = b_bar || material_table->material[i]->b_bar;
  lua_pushstring(L, b_bar ? "b_bar" : "standard");
  return 1;
}

static const luaL_Reg solid_methods[] = {
    {"evaluate", solid_evaluate}, {"stress", solid_stress}, {NULL, NULL}};
static const luaL_Reg solid_properties[] = {
    {"grid", solid_grid},       {"materials", solid_material_table}, {"mass", solid_mass},
    {"locking", solid_locking}, {"formulation", solid_formulation},  {NULL, NULL}};
static const luaL_Reg no_meta[] = {{NULL, NULL}};
const lbw_class lbw_solid_class = {"elastic_solid", solid_methods, solid_properties, no_meta, NULL};

/* ---- cases ----------------------------------------------------------------------------------- */

static bw_load_case *self_case(lua_State *L) {
  return (bw_load_case *)lbw_check(L, 1, &lbw_load_case_class);
}

static int case_create(lua_State *L) {
  const bw_grid *grid = (const bw_grid *)lbw_check(L, 1, &lbw_grid_class);
  lbw_box *box = lbw_box_new(L, &lbw_load_case_class);
  bw_load_case *it = NULL;
  bw_status status = bw_load_case_create(lbw_enter(L), grid, &it);
  return lbw_leave_object(L, box, it, status);
}

static int32_t *read_nodes(lua_State *L, int index, const bw_grid *grid, int64_t *count) {
  int32_t *node = lbw_to_indices(L, index, "nodes", 1, count);
  for (int64_t i = 0; i < *count; i++)
    if (node[i] >= grid->node_count)
      lbw_error(L, "nodes: indices from 1 to %d expected, got %d", (int)grid->node_count,
                (int)node[i] + 1);
  return node;
}

/* case:fix(nodes, {x | false, y | false, z | false}): prescribed displacements */
static int case_fix(lua_State *L) {
  bw_load_case *it = self_case(L);
  int64_t count;
  bool fixed[3];
  double value[3];
  const int32_t *node = read_nodes(L, 2, it->grid, &count);
  lbw_check_type(L, 3, LUA_TTABLE);
  for (int d = 0; d < 3; d++) {
    lua_rawgeti(L, 3, d + 1);
    fixed[d] = lua_isnumber(L, -1);
    value[d] = fixed[d] ? lua_tonumber(L, -1) : 0;
    lua_pop(L, 1);
  }
  return lbw_leave(L, bw_load_case_fix(lbw_enter(L), it, count, node, fixed, value), 0);
}

/* case:fix_each(nodes, values): every node has displacements of its own, rows of three */
static int case_fix_each(lua_State *L) {
  bw_status status = BW_OK;
  bw_load_case *it = self_case(L);
  int64_t count, rows;
  const bool fixed[3] = {true, true, true};
  const int32_t *node = read_nodes(L, 2, it->grid, &count);
  const double *value = lbw_to_doubles(L, 3, "displacements", 3, &rows);
  lbw_require_rows(L, "fix: displacements", rows, count, "node");
  bw_context *context = lbw_enter(L);
  for (int64_t i = 0; i < count; i++)
    BW_TRY(bw_load_case_fix(context, it, 1, node + i, fixed, value + 3 * i));
done:
  return lbw_leave(L, status, 0);
}

/* case:force(nodes, {x, y, z}): the total */
static int case_force(lua_State *L) {
  bw_load_case *it = self_case(L);
  int64_t count;
  double total[3];
  const int32_t *node = read_nodes(L, 2, it->grid, &count);
  lbw_check_vector(L, 3, "force", total);
  return lbw_leave(L, bw_load_case_force(lbw_enter(L), it, count, node, total), 0);
}

/* case:gravity{x, y, z} */
static int case_gravity(lua_State *L) {
  bw_load_case *it = self_case(L);
  double gravity[3];
  lbw_check_vector(L, 2, "gravity", gravity);
  return lbw_leave(L, bw_load_case_gravity(lbw_enter(L), it, gravity), 0);
}

/* case:pressure(embedding, triangles, pressures, follower) */
static int case_pressure(lua_State *L) {
  bw_load_case *it = self_case(L);
  int64_t triangles, rows;
  lua_settop(L, 5);
  const bw_embedding *embedding = (const bw_embedding *)lbw_check(L, 2, &lbw_embedding_class);
  const int32_t *triangle = lbw_to_indices(L, 3, "triangles", 3, &triangles);
  const double *pressure = lbw_to_doubles(L, 4, "pressures", 1, &rows);
  lbw_require_rows(L, "pressure", rows, triangles, "triangle");
  return lbw_leave(L,
                   bw_load_case_pressure(lbw_enter(L), it, embedding, triangles, triangle, pressure,
                                         lua_toboolean(L, 5)),
                   0);
}

/* case:surface_pressure(nodes, pressure, factor, follower): on free faces; a number, a function of
 * x, y, z or a formula */
static int case_surface_pressure(lua_State *L) {
  bw_load_case *it = self_case(L);
  int64_t count;
  lua_settop(L, 5);
  const int32_t *node = read_nodes(L, 2, it->grid, &count);
  lbw_field *field = lbw_field_read(L, 3, "pressure");
  double factor = lbw_check_real(L, 4, "factor");
  bw_context *context = lbw_enter(L);
  lbw_field_begin(field, context);
  bw_status status = bw_load_case_surface_pressure(context, it, count, node, lbw_field_value, field,
                                                   factor, lua_toboolean(L, 5));
  lbw_field_end(field, context);
  return lbw_leave(L, status, 0);
}

/* case:contact_plane(point, normal, move, embedding | nil, points | nil) */
static int case_contact_plane(lua_State *L) {
  bw_load_case *it = self_case(L);
  double point[3], normal[3], move[3];
  int64_t rows = 0;
  lua_settop(L, 6);
  lbw_check_vector(L, 2, "point", point);
  lbw_check_vector(L, 3, "normal", normal);
  lbw_check_vector(L, 4, "move", move);
  const bw_embedding *embedding = NULL;
  const double *rest = NULL;
  if (!lua_isnil(L, 5)) {
    embedding = (const bw_embedding *)lbw_check(L, 5, &lbw_embedding_class);
    rest = lbw_to_doubles(L, 6, "points", 3, &rows);
    lbw_require_rows(L, "contact_plane: points", rows, embedding->point_count, "point");
  }
  return lbw_leave(
      L, bw_load_case_contact_plane(lbw_enter(L), it, point, normal, move, embedding, rest), 0);
}

static int case_applied(lua_State *L) {
  const bw_load_case *it = self_case(L);
  return lbw_push_borrowed(L, BW_F64, it->grid->node_count, 3, it->force, it);
}

static const luaL_Reg case_methods[] = {{"fix", case_fix},
                                        {"fix_each", case_fix_each},
                                        {"force", case_force},
                                        {"gravity", case_gravity},
                                        {"pressure", case_pressure},
                                        {"surface_pressure", case_surface_pressure},
                                        {"contact_plane", case_contact_plane},
                                        {NULL, NULL}};
static const luaL_Reg case_properties[] = {{"applied", case_applied}, {NULL, NULL}};
const lbw_class lbw_load_case_class = {"load_case", case_methods, case_properties, no_meta, NULL};

/* ---- statics --------------------------------------------------------------------------------- */

static const luaL_Reg none[] = {{NULL, NULL}};
static const lbw_class lbw_newton_class = {"newton", none, none, none, NULL};

/* solid.newton(): order, analysis and memory kept between solves */
static int newton_create(lua_State *L) {
  lbw_box *box = lbw_box_new(L, &lbw_newton_class);
  bw_newton *newton = NULL;
  bw_status status = bw_newton_create(lbw_enter(L), &newton);
  return lbw_leave_object(L, box, newton, status);
}

enum { MAX_LEVELS = 4 };

/* options.coarse = {{coarsening, solid}, ...}, from fine to coarse */
static int read_coarse(lua_State *L, int index, const bw_coarsening **coarsening,
                       const bw_solid **solid) {
  int count = 0;
  if (lbw_option_get(L, index, "coarse") == LUA_TTABLE) {
    count = (int)lua_rawlen(L, -1);
    if (count > MAX_LEVELS)
      lbw_error(L, "solve: option 'coarse': at most %d pairs expected, got %d", MAX_LEVELS, count);
    for (int i = 0; i < count; i++) {
      lua_rawgeti(L, -1, i + 1);
      lua_rawgeti(L, -1, 1);
      lua_rawgeti(L, -2, 2);
      coarsening[i] = (const bw_coarsening *)lbw_test(L, -2, &lbw_coarsening_class);
      solid[i] = (const bw_solid *)lbw_test(L, -1, &lbw_solid_class);
      if (!coarsening[i] || !solid[i]) {
        const char *first = lbw_got(L, -2), *second = lbw_got(L, -2); /* each pushes one */
        lbw_error(
            L, "solve: option 'coarse': pair %d: a coarsening and a solid expected, got %s and %s",
            i + 1, first, second);
      }
      lua_pop(L, 3);
    }
  }
  return count;
}

/* solid:solve(case, newton | nil, options | nil, start | nil) */
static int solid_solve(lua_State *L) {
  static const lbw_option list[] = {
      {"tolerance", LBW_REAL, offsetof(bw_newton_options, tolerance)},
      {"iterations", LBW_INT, offsetof(bw_newton_options, iterations)},
      {"steps", LBW_INT, offsetof(bw_newton_options, steps)},
      {"max_iterations", LBW_INT, offsetof(bw_newton_options, max_iterations)},
      {"min_step", LBW_REAL, offsetof(bw_newton_options, min_step)},
      {"allow_inverted", LBW_BOOLEAN, offsetof(bw_newton_options, allow_inverted)},
      {"solver", LBW_OTHER, 0},
      {"coarse", LBW_OTHER, 0},
      {NULL, LBW_OTHER, 0}};
  lua_settop(L, 5);
  const bw_solid *solid = self(L);
  const bw_load_case *load_case = (const bw_load_case *)lbw_check(L, 2, &lbw_load_case_class);
  lbw_box *kept = lua_isnil(L, 3) ? NULL : lbw_check_box(L, 3, &lbw_newton_class);
  const bw_coarsening *coarsening[MAX_LEVELS];
  const bw_solid *coarse[MAX_LEVELS];
  bw_newton_options options;
  bw_newton_options_default(&options);
  lbw_options(L, 4, "solve", list, &options);
  options.solver = lbw_solver_option(L, 4, "solve");
  options.coarse_count = read_coarse(L, 4, coarsening, coarse);
  options.coarsening = coarsening;
  options.coarse = coarse;
  options.start = lbw_read_displacement(L, 5, "start", solid->grid);
  lbw_box *box = lbw_box_new(L, &lbw_solid_static_class);
  int place = lua_gettop(L);
  bw_solid_static *result = NULL;
  bw_status status = bw_solid_statics(lbw_enter(L), solid, load_case,
                                      kept ? (bw_newton *)kept->object : NULL, &options, &result);
  lbw_box_fill(L, box, result);
  if (kept)
    lbw_box_account(L, kept); /* it has grown */
  lua_pushvalue(L, place);
  int results = lbw_leave(L, status, 1);
  /* What was reached before it failed goes with the details. */
  if (status != BW_OK && result) {
    lua_pushvalue(L, place);
    lua_setfield(L, -2, "reached");
  }
  return results;
}

/* solid:correct(case, options, displacement): {iterations, solver, coarse}; the displacement
 * after so many steps, or nil where the energy is not defined */
static int solid_correct(lua_State *L) {
  static const lbw_option list[] = {
      {"iterations", LBW_INT, offsetof(bw_newton_options, iterations)},
      {"solver", LBW_OTHER, 0},
      {"coarse", LBW_OTHER, 0},
      {NULL, LBW_OTHER, 0}};
  lua_settop(L, 4);
  const bw_solid *solid = self(L);
  const bw_load_case *load_case = (const bw_load_case *)lbw_check(L, 2, &lbw_load_case_class);
  const bw_coarsening *coarsening[MAX_LEVELS];
  const bw_solid *coarse[MAX_LEVELS];
  bw_newton_options options;
  bool defined = false;
  bw_newton_options_default(&options);
  lbw_options(L, 3, "correct", list, &options);
  options.coarse_count = read_coarse(L, 3, coarsening, coarse);
  options.solver = lbw_solver_option(L, 3, "correct");
  options.coarsening = coarsening;
  options.coarse = coarse;
  options.start = lbw_read_displacement(L, 4, "displacement", solid->grid);
  bw_array *out = lbw_push_array(L, BW_F64, solid->grid->node_count, 3);
  bw_status status =
      bw_solid_correct(lbw_enter(L), solid, load_case, &options, (double *)out->data, &defined);
  if (status == BW_OK && !defined)
    lua_pushnil(L);
  return lbw_leave(L, status, 1);
}

static const bw_solid_static *self_static(lua_State *L) {
  return (const bw_solid_static *)lbw_check(L, 1, &lbw_solid_static_class);
}

static int static_displacement(lua_State *L) {
  const bw_solid_static *s = self_static(L);
  return lbw_push_borrowed(L, BW_F64, s->solid->grid->node_count, 3, s->displacement, s);
}

static int static_reaction(lua_State *L) {
  const bw_solid_static *s = self_static(L);
  return lbw_push_borrowed(L, BW_F64, s->solid->grid->node_count, 3, s->reaction, s);
}

LBW_PUSH(static_energy, lua_pushnumber(L, self_static(L)->energy))
LBW_PUSH(static_complete, lua_pushboolean(L, self_static(L)->complete))
LBW_PUSH(static_newton, lbw_push_newton_report(L, &self_static(L)->newton))
LBW_PUSH(static_report, lbw_push_report(L, &self_static(L)->report))

static const luaL_Reg static_properties[] = {{"displacement", static_displacement},
                                             {"reaction", static_reaction},
                                             {"energy", static_energy},
                                             {"complete", static_complete},
                                             {"report", static_report},
                                             {"newton", static_newton},
                                             {NULL, NULL}};
const lbw_class lbw_solid_static_class = {"large_static", none, static_properties, no_meta, NULL};

void lbw_open_solid(lua_State *L) {
  static const luaL_Reg functions[] = {
      {"create", solid_create}, {"case", case_create}, {"newton", newton_create}, {NULL, NULL}};
  static const luaL_Reg solve[] = {
      {"solve", solid_solve}, {"correct", solid_correct}, {NULL, NULL}};
  lbw_class_register(L, &lbw_solid_class);
  lbw_class_register(L, &lbw_load_case_class);
  lbw_class_register(L, &lbw_solid_static_class);
  lbw_class_register(L, &lbw_newton_class);
  lbw_add_methods(L, &lbw_solid_class, solve);
  lua_newtable(L);
  luaL_setfuncs(L, functions, 0);
  lua_setfield(L, -2, "solid");
}
