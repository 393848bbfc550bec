/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* The worst loads of regions, and the screening of all elements by a coarse pressure. */
#include "bind.h"

#include "barwright/certificate.h"

#include <math.h>
#include <string.h>

/* ---- worst loads ----------------------------------------------------------------------------- */

/* What is kept of each visit: no Lua inside, the arrays are made before. */
typedef struct collection {
  bw_context *context;
  const bw_mesh *mesh;
  const bw_material *material;
  int32_t basis_count;
  bool directional; /* strengths differ with the direction: utilisation needs the tensors */
  int first;        /* regions of earlier runs */
  const bw_weak_regions *regions;
  double *peak, *objective, *seconds, *utilisation, *displacement; /* per region */
  double *solve_error;                                             /* per region */
  double *peak_stress, *first_stress;                              /* per region: six */
  int32_t *peak_element, *utilised_element, *worst_region;
  uint8_t *flipped;
  double *weakness; /* per element: the largest stress over all regions */
  double *pressure; /* regions x basis_count, or NULL */
  double *scratch;  /* per element */
} collection;

static bw_status collect(void *data, const bw_worst_case_visit *visit) {
  collection *c = (collection *)data;
  int r = c->first + visit->region;
  double peak = -1, used = 0;
  for (int32_t e = 0; e < c->mesh->element_count; e++) {
    double value = visit->max_principal[e];
    if (value > peak) {
      peak = value;
      c->peak_element[r] = e + 1;
    }
    if (value > c->weakness[e]) {
      c->weakness[e] = value;
      c->worst_region[e] = r + 1;
    }
  }
  if (c->directional) {
    bw_status status = bw_utilisation_field(c->context, c->material, c->mesh->element_count,
                                            visit->stress, c->scratch);
    if (status != BW_OK)
      return status;
    for (int32_t e = 0; e < c->mesh->element_count; e++)
      if (c->scratch[e] > used) {
        used = c->scratch[e];
        c->utilised_element[r] = e + 1;
      }
  } else {
    used = c->material->strength[0] > 0 ? peak / c->material->strength[0] : 0;
    c->utilised_element[r] = c->peak_element[r];
  }
  memcpy(c->peak_stress + 6 * r, visit->stress + 6 * (int64_t)(c->peak_element[r] - 1),
         6 * sizeof(double));
  memcpy(c->first_stress + 6 * r,
         visit->stress + 6 * (int64_t)c->regions->region[visit->region].element[0],
         6 * sizeof(double));
  double moved = 0;
  for (int64_t i = 0; i < c->mesh->node_count; i++)
    moved = fmax(moved, bw_norm(visit->displacement + 3 * i));
  c->peak[r] = peak;
  c->utilisation[r] = used;
  c->displacement[r] = moved;
  c->objective[r] = visit->objective;
  c->solve_error[r] = visit->solve_error;
  c->flipped[r] = visit->flipped;
  c->seconds[r] = visit->seconds;
  if (c->pressure)
    memcpy(c->pressure + (int64_t)r * c->basis_count, visit->pressure,
           (size_t)c->basis_count * sizeof(double));
  return BW_OK;
}

/* Arrays by region: those of earlier runs come first. */
typedef struct arrays {
  lua_State *L;
  int table, after; /* stack places; after: 0 for none */
  int earlier, count;
} arrays;

static void *new_array(const arrays *k, const char *key, bw_type type, int64_t rows,
                       int64_t columns) {
  void *data = lbw_push_array(k->L, type, rows, columns)->data;
  lua_setfield(k->L, k->table, key);
  return data;
}

/* Field `key` of the earlier results: an array of this type and size. */
static const void *earlier_array(const arrays *k, const char *key, bw_type type, int64_t rows,
                                 int64_t columns) {
  lua_getfield(k->L, k->after, key);
  const bw_array *array = (const bw_array *)lbw_test(k->L, -1, &lbw_array_class);
  bool fits = array && array->type == type && array->rows == rows && array->columns == columns &&
              array->row_stride == (ptrdiff_t)bw_type_size(type) * (ptrdiff_t)columns &&
              (columns == 1 || array->column_stride == (ptrdiff_t)bw_type_size(type));
  lbw_argument_check(k->L, fits, 4, "after: results of worst_loads for the same mesh expected");
  lua_pop(k->L, 1); /* the table keeps it alive */
  return array->data;
}

static void *by_region(const arrays *k, const char *key, bw_type type, int64_t columns) {
  size_t size = (size_t)bw_type_size(type) * (size_t)columns;
  void *data = new_array(k, key, type, (int64_t)k->earlier + k->count, columns);
  if (k->after)
    memcpy(data, earlier_array(k, key, type, k->earlier, columns), (size_t)k->earlier * size);
  return data;
}

static void *by_element(const arrays *k, const char *key, bw_type type, int64_t elements) {
  void *data = new_array(k, key, type, elements, 1);
  if (k->after)
    memcpy(data, earlier_array(k, key, type, elements, 1),
           (size_t)elements * (size_t)bw_type_size(type));
  return data;
}

static bw_status respond_in_contact(bw_context *context, void *data, int count, double *block) {
  return bw_contact_system_solve(context, (const bw_contact_system *)data, count, block, block,
                                 NULL);
}

/* worst_loads(system, basis, regions, {pressure, force, force_is_max, one_sign, other_sign, hands,
 * hand_area, batch, keep_pressures, lp, after, contact, given}): a table of arrays, and the report
 * of the linear programs */
static int worst_loads(lua_State *L) {
  struct opts {
    bw_worst_load_options options;
    int batch;
    bool keep_pressures;
  } opts;
  static const lbw_option list[] = {
      {"pressure", LBW_REAL, offsetof(struct opts, options.pressure)},
      {"force", LBW_REAL, offsetof(struct opts, options.force)},
      {"force_is_max", LBW_BOOLEAN, offsetof(struct opts, options.force_is_max)},
      {"one_sign", LBW_BOOLEAN, offsetof(struct opts, options.one_sign)},
      {"other_sign", LBW_BOOLEAN, offsetof(struct opts, options.other_sign)},
      {"hands", LBW_INT, offsetof(struct opts, options.hands)},
      {"hand_area", LBW_REAL, offsetof(struct opts, options.hand_area)},
      {"batch", LBW_INT, offsetof(struct opts, batch)},
      {"keep_pressures", LBW_BOOLEAN, offsetof(struct opts, keep_pressures)},
      {"lp", LBW_OTHER, 0},
      {"after", LBW_OTHER, 0},
      {"contact", LBW_OTHER, 0},
      {"given", LBW_OTHER, 0},
      {NULL, LBW_OTHER, 0}};
  bw_system *system = (bw_system *)lbw_check(L, 1, &lbw_system_class);
  const bw_pressure_basis *basis =
      (const bw_pressure_basis *)lbw_check(L, 2, &lbw_pressure_basis_class);
  const bw_weak_regions *regions =
      (const bw_weak_regions *)lbw_check(L, 3, &lbw_weak_regions_class);
  memset(&opts, 0, sizeof opts);
  opts.keep_pressures = true;
  lua_settop(L, 4);
  lbw_options(L, 4, "worst_loads", list, &opts);
  opts.options.lp = lbw_lp_option(L, 4, "worst_loads");
  const bw_mesh *mesh = system->mesh;
  lbw_argument_check(L, basis->mesh == mesh, 2, "a pressure basis of the same mesh expected");
  lbw_argument_check(L, regions->mesh == mesh, 3, "regions of the same mesh expected");
  bw_contact_system *contact = (bw_contact_system *)lbw_object_option(
      L, 4, "worst_loads", "contact", &lbw_contact_system_class, "an open contact system");
  lua_settop(L, 4);
  lbw_argument_check(L, !contact || contact->model->mesh == mesh, 4,
                     "contact: a contact system of the same mesh expected");
  if (contact) {
    opts.options.respond = respond_in_contact;
    opts.options.respond_data = contact;
  }
  if (lua_isnil(L, 4)) {
    lua_newtable(L);
    lua_replace(L, 4);
  }
  lua_getfield(L, 4, "given"); /* 5 */
  if (!lua_isnil(L, 5)) {
    int64_t loads;
    opts.options.given = lbw_to_doubles(L, 5, "given", basis->count, &loads);
    lbw_require_rows(L, "worst_loads: given", loads, regions->count, "region");
    lua_replace(L, 5); /* it stays alive there */
  } else {
    lua_settop(L, 5);
  }
  lua_getfield(L, 4, "after"); /* 6 */
  lua_createtable(L, 0, 15);   /* 7 */
  arrays k = {.L = L, .table = 7, .count = regions->count};
  if (!lua_isnil(L, 6)) {
    lbw_argument_check(L, lua_istable(L, 6), 4,
                       "after: a table of results of worst_loads expected");
    lua_getfield(L, 6, "peaks");
    const bw_array *peaks = (const bw_array *)lbw_test(L, -1, &lbw_array_class);
    lbw_argument_check(L, peaks && peaks->rows < INT32_MAX - regions->count, 4,
                       "after: a table of results of worst_loads expected");
    k.after = 6;
    k.earlier = (int)peaks->rows;
    lua_pop(L, 1);
  }
  const bw_material *material = system->material;
  const double *strength = material->strength; /* the least of several materials */
  collection c = {.mesh = mesh,
                  .material = material,
                  .basis_count = basis->count,
                  .first = k.earlier,
                  .regions = regions,
                  .directional = strength[0] > 0 &&
                                 (strength[0] != strength[1] || strength[0] != strength[2] ||
                                  bw_material_mixed(material))};
  c.peak = (double *)by_region(&k, "peaks", BW_F64, 1);
  c.peak_element = (int32_t *)by_region(&k, "peak_elements", BW_I32, 1);
  c.peak_stress = (double *)by_region(&k, "peak_stresses", BW_F64, 6);
  c.first_stress = (double *)by_region(&k, "first_stresses", BW_F64, 6);
  c.utilisation = (double *)by_region(&k, "utilisations", BW_F64, 1);
  c.utilised_element = (int32_t *)by_region(&k, "utilised_elements", BW_I32, 1);
  c.displacement = (double *)by_region(&k, "displacements", BW_F64, 1);
  c.objective = (double *)by_region(&k, "objectives", BW_F64, 1);
  c.solve_error = (double *)by_region(&k, "solve_errors", BW_F64, 1);
  c.seconds = (double *)by_region(&k, "seconds", BW_F64, 1);
  c.flipped = (uint8_t *)by_region(&k, "flipped", BW_U8, 1);
  c.weakness = (double *)by_element(&k, "weakness", BW_F64, mesh->element_count);
  c.worst_region = (int32_t *)by_element(&k, "worst_region", BW_I32, mesh->element_count);
  if (opts.keep_pressures)
    c.pressure = (double *)by_region(&k, "pressures", BW_F64, basis->count);
  if (c.directional)
    c.scratch =
        (double *)lua_newuserdatauv(L, (size_t)mesh->element_count * sizeof *c.scratch + 1, 0);
  lua_pushvalue(L, k.table); /* the scratch block stays alive below it */
  bw_solver_report report;
  c.context = lbw_enter(L);
  bw_status status = bw_worst_case_run(c.context, system, basis, regions, &opts.options, opts.batch,
                                       collect, &c, &report);
  int results = lbw_leave(L, status, 1);
  if (status != BW_OK)
    return results;
  lbw_push_report(L, &report);
  lua_setfield(L, k.table, "report");
  return 1;
}

/* ---- screening ------------------------------------------------------------------------------- */

static int push_screening(lua_State *L) {
  const bw_screening *found = (const bw_screening *)lua_touserdata(L, 1);
  lua_createtable(L, 0, 2);
  lbw_push_indices(L, found->count, 1, found->target);
  lua_setfield(L, 2, "targets");
  void *to = lbw_push_array(L, BW_F64, found->count, 6)->data;
  if (found->count > 0)
    memcpy(to, found->stress, 6 * (size_t)found->count * sizeof(double));
  lua_setfield(L, 2, "stresses");
  lbw_push_report(L, &found->report);
  lua_setfield(L, 2, "report");
  return 1;
}

/* worst_screening(system, basis, {pressure, force, force_is_max, lp, patches, targets, radius}):
 * {targets, stresses, report}, largest first. Targets are elements, or with a radius nodes in the
 * centres of patches. */
static int worst_screening(lua_State *L) {
  struct opts {
    bw_worst_load_options options;
    int patches, targets;
    double radius;
  } opts;
  static const lbw_option list[] = {
      {"pressure", LBW_REAL, offsetof(struct opts, options.pressure)},
      {"force", LBW_REAL, offsetof(struct opts, options.force)},
      {"force_is_max", LBW_BOOLEAN, offsetof(struct opts, options.force_is_max)},
      {"lp", LBW_OTHER, 0},
      {"patches", LBW_INT, offsetof(struct opts, patches)},
      {"targets", LBW_INT, offsetof(struct opts, targets)},
      {"radius", LBW_REAL, offsetof(struct opts, radius)},
      {NULL, LBW_OTHER, 0}};
  bw_system *system = (bw_system *)lbw_check(L, 1, &lbw_system_class);
  const bw_pressure_basis *basis =
      (const bw_pressure_basis *)lbw_check(L, 2, &lbw_pressure_basis_class);
  memset(&opts, 0, sizeof opts);
  opts.patches = 128;
  opts.targets = 512;
  lua_settop(L, 3);
  lbw_options(L, 3, "worst_screening", list, &opts);
  opts.options.lp = lbw_lp_option(L, 3, "worst_screening");
  lbw_argument_check(L, basis->mesh == system->mesh, 2,
                     "a pressure basis of the same mesh expected");
  bw_screening found;
  memset(&found, 0, sizeof found);
  lua_pushcfunction(L, push_screening);
  lua_pushlightuserdata(L, &found);
  bw_status status = bw_worst_screening(lbw_enter(L), system, basis, &opts.options, opts.patches,
                                        opts.radius, opts.targets, &found);
  lbw_state_of(L)->running = 0;
  if (status != BW_OK)
    return lbw_leave(L, status, 0);
  int failure = lua_pcall(L, 1, 1, 0);
  bw_screening_clear(&found);
  return failure ? lua_error(L) : lbw_leave(L, BW_OK, 1);
}

/* ---- the upper bound ------------------------------------------------------------------------- */

/* The leaves as arrays: elements, cells, bounds, starts (one more, from 1), numbers. */
static int push_leaves(lua_State *L) {
  const bw_bound_leaves *leaves = (const bw_bound_leaves *)lua_touserdata(L, 1);
  int64_t count = (int64_t)leaves->count, numbers = (int64_t)leaves->number_count;
  lua_createtable(L, 0, 5);
  int32_t *element = (int32_t *)lbw_push_array(L, BW_I32, count, 1)->data;
  lua_setfield(L, 2, "elements");
  int64_t *cell = (int64_t *)lbw_push_array(L, BW_I64, count, 1)->data;
  lua_setfield(L, 2, "cells");
  double *bound = (double *)lbw_push_array(L, BW_F64, count, 1)->data;
  lua_setfield(L, 2, "bounds");
  int64_t *start = (int64_t *)lbw_push_array(L, BW_I64, count + 1, 1)->data;
  lua_setfield(L, 2, "starts");
  int32_t *number = (int32_t *)lbw_push_array(L, BW_I32, numbers, 1)->data;
  lua_setfield(L, 2, "numbers");
  for (int64_t i = 0; i < count; i++) {
    element[i] = leaves->leaf[i].element + 1;
    cell[i] = leaves->leaf[i].cell;
    bound[i] = leaves->leaf[i].bound;
    start[i] = leaves->leaf[i].start + 1;
  }
  start[count] = numbers + 1;
  if (numbers > 0)
    memcpy(number, leaves->number, (size_t)numbers * sizeof *number);
  return 1;
}

/* worst_bound(system, basis, {pressure, force, force_is_max, lp, incumbent, tolerance, leaves}):
 * {upper, largest, linear programs, report}; where `largest` is more than the incumbent, element
 * and stress (an array of one row); with leaves = true these */
static int worst_bound(lua_State *L) {
  struct opts {
    bw_worst_load_options options;
    double incumbent, tolerance;
    bool leaves;
  } opts;
  static const lbw_option list[] = {
      {"pressure", LBW_REAL, offsetof(struct opts, options.pressure)},
      {"force", LBW_REAL, offsetof(struct opts, options.force)},
      {"force_is_max", LBW_BOOLEAN, offsetof(struct opts, options.force_is_max)},
      {"lp", LBW_OTHER, 0},
      {"incumbent", LBW_REAL, offsetof(struct opts, incumbent)},
      {"tolerance", LBW_REAL, offsetof(struct opts, tolerance)},
      {"leaves", LBW_BOOLEAN, offsetof(struct opts, leaves)},
      {NULL, LBW_OTHER, 0}};
  bw_system *system = (bw_system *)lbw_check(L, 1, &lbw_system_class);
  const bw_pressure_basis *basis =
      (const bw_pressure_basis *)lbw_check(L, 2, &lbw_pressure_basis_class);
  memset(&opts, 0, sizeof opts);
  lua_settop(L, 3);
  lbw_options(L, 3, "worst_bound", list, &opts);
  opts.options.lp = lbw_lp_option(L, 3, "worst_bound");
  lbw_argument_check(L, basis->mesh == system->mesh, 2,
                     "a pressure basis of the same mesh expected");
  lua_createtable(L, 0, 5);
  double *stress = (double *)lbw_push_array(L, BW_F64, 1, 6)->data;
  lua_pushcfunction(L, push_leaves);
  bw_bound_leaves leaves;
  memset(&leaves, 0, sizeof leaves);
  lua_pushlightuserdata(L, &leaves);
  bw_worst_bound bound;
  bw_status status = bw_worst_bound_find(lbw_enter(L), system, basis, &opts.options, opts.incumbent,
                                         opts.tolerance, &bound, opts.leaves ? &leaves : NULL);
  lbw_state_of(L)->running = 0;
  int failure = status == BW_OK ? lua_pcall(L, 1, 1, 0) : LUA_OK;
  bw_bound_leaves_clear(&leaves);
  if (failure)
    return lua_error(L);
  if (status != BW_OK)
    return lbw_leave(L, status, 0);
  if (opts.leaves)
    lua_setfield(L, 4, "leaves");
  lua_settop(L, 5); /* the results and the stress */
  memcpy(stress, bound.stress, sizeof bound.stress);
  if (bound.element >= 0) {
    lua_setfield(L, 4, "stress");
    lua_pushinteger(L, (lua_Integer)bound.element + 1);
    lua_setfield(L, 4, "element");
  }
  lua_settop(L, 4);
  lua_pushnumber(L, bound.upper);
  lua_setfield(L, 4, "upper");
  lua_pushnumber(L, bound.largest);
  lua_setfield(L, 4, "largest");
  lua_pushinteger(L, bound.linear_programs);
  lua_setfield(L, 4, "linear_programs");
  lbw_push_report(L, &bound.report);
  lua_setfield(L, 4, "report");
  return lbw_leave(L, BW_OK, 1);
}

/* ---- what multipliers prove ------------------------------------------------------------------ */

/* dual_bounds(system, basis, {force, pressure, force_is_max}, works, elements, directions,
 * multipliers): a bound for each element, and what the residuals of the linear solves may add to
 * it. works: a row for each rigid-body mode */
static int dual_bounds(lua_State *L) {
  bw_dual_claims claims;
  static const lbw_option list[] = {
      {"pressure", LBW_REAL, offsetof(bw_dual_claims, pressure)},
      {"force", LBW_REAL, offsetof(bw_dual_claims, force)},
      {"force_is_max", LBW_BOOLEAN, offsetof(bw_dual_claims, force_is_max)},
      {NULL, LBW_OTHER, 0}};
  bw_system *system = (bw_system *)lbw_check(L, 1, &lbw_system_class);
  const bw_pressure_basis *basis =
      (const bw_pressure_basis *)lbw_check(L, 2, &lbw_pressure_basis_class);
  memset(&claims, 0, sizeof claims);
  lua_settop(L, 7);
  lbw_options(L, 3, "dual_bounds", list, &claims);
  lbw_argument_check(L, basis->mesh == system->mesh, 2,
                     "a pressure basis of the same mesh expected");
  int64_t motions, rows;
  claims.work = lbw_to_doubles(L, 4, "works", basis->count, &motions);
  claims.motions = (int32_t)motions;
  claims.element = lbw_to_indices(L, 5, "elements", 1, &claims.count);
  claims.direction = lbw_to_doubles(L, 6, "directions", 3, &rows);
  lbw_check_rows(L, 6, "directions", rows, claims.count, "element");
  claims.multiplier = lbw_to_doubles(L, 7, "multipliers", 6 * motions + 2, &rows);
  lbw_check_rows(L, 7, "multipliers", rows, claims.count, "element");
  double *bound = (double *)lbw_push_array(L, BW_F64, rows, 1)->data;
  double *solve_error = (double *)lbw_push_array(L, BW_F64, rows, 1)->data;
  return lbw_leave(L, bw_dual_bounds(lbw_enter(L), system, basis, &claims, bound, solve_error), 2);
}

void lbw_open_worst_loads(lua_State *L) {
  static const luaL_Reg functions[] = {{"worst_loads", worst_loads},
                                       {"worst_screening", worst_screening},
                                       {"worst_bound", worst_bound},
                                       {"dual_bounds", dual_bounds},
                                       {NULL, NULL}};
  luaL_setfuncs(L, functions, 0);
}
