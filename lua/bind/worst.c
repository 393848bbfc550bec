/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* The parts of the worst case: weak regions, pressure basis, drops; worst_loads.c has the loads.
 * The steps are put together in lua/barwright/worst_case.lua. */
#include "bind.h"

#include <string.h>

/* ---- weak regions ---------------------------------------------------------------------------- */

static const bw_weak_regions *regions_self(lua_State *L) {
  return (const bw_weak_regions *)lbw_check(L, 1, &lbw_weak_regions_class);
}

/* weak_regions(mesh, material, modes, {measure, fraction, regions, target}) */
static int weak_regions_find(lua_State *L) {
  struct opts {
    double fraction;
    int regions;
  } opts;
  static const lbw_option list[] = {{"measure", LBW_OTHER, 0},
                                    {"target", LBW_OTHER, 0},
                                    {"fraction", LBW_REAL, offsetof(struct opts, fraction)},
                                    {"regions", LBW_INT, offsetof(struct opts, regions)},
                                    {NULL, LBW_OTHER, 0}};
  static const char *const measures[] = {"stress", "energy", NULL};
  static const char *const targets[] = {"stress", "displacement", NULL};
  const bw_mesh *mesh = (const bw_mesh *)lbw_check(L, 1, &lbw_mesh_class);
  const bw_material *material = (const bw_material *)lbw_check(L, 2, &lbw_material_class);
  const bw_modes *modes = (const bw_modes *)lbw_check(L, 3, &lbw_modes_class);
  bw_weak_options options;
  bw_weak_options_default(&options);
  opts = (struct opts){options.fraction, options.regions};
  lua_settop(L, 4);
  lbw_options(L, 4, "weak_regions", list, &opts);
  options.fraction = opts.fraction;
  options.regions = opts.regions;
  options.measure = lbw_word_option(L, 4, "weak_regions", "measure", measures, 0) ? BW_WEAK_ENERGY
                                                                                  : BW_WEAK_STRESS;
  options.target = lbw_word_option(L, 4, "weak_regions", "target", targets, 0)
                       ? BW_WORST_DISPLACEMENT
                       : BW_WORST_STRESS;
  lbw_box *box = lbw_box_new(L, &lbw_weak_regions_class);
  bw_weak_regions *regions = NULL;
  bw_status status = bw_weak_regions_find(lbw_enter(L), mesh, material, modes, &options, &regions);
  return lbw_leave_object(L, box, regions, status);
}

/* single_regions(mesh, elements or nil, sign) */
static int single_regions(lua_State *L) {
  const bw_mesh *mesh = (const bw_mesh *)lbw_check(L, 1, &lbw_mesh_class);
  int64_t count = mesh->element_count;
  const int32_t *element = NULL;
  double sign = lbw_number_or(L, 3, 1);
  if (!lua_isnoneornil(L, 2))
    element = lbw_to_indices(L, 2, "elements", 1, &count);
  lbw_box *box = lbw_box_new(L, &lbw_weak_regions_class);
  bw_weak_regions *regions = NULL;
  bw_status status = bw_weak_regions_single(lbw_enter(L), mesh, count, element, sign, &regions);
  return lbw_leave_object(L, box, regions, status);
}

/* directed_regions(mesh, elements, stresses) */
static int directed_regions(lua_State *L) {
  const bw_mesh *mesh = (const bw_mesh *)lbw_check(L, 1, &lbw_mesh_class);
  int64_t count, rows;
  lua_settop(L, 3);
  const int32_t *element = lbw_to_indices(L, 2, "elements", 1, &count);
  const double *stress = lbw_to_doubles(L, 3, "stresses", 6, &rows);
  lbw_check_rows(L, 3, "stresses", rows, count, "element");
  lbw_box *box = lbw_box_new(L, &lbw_weak_regions_class);
  bw_weak_regions *regions = NULL;
  bw_status status = bw_weak_regions_directed(lbw_enter(L), mesh, count, element, stress, &regions);
  return lbw_leave_object(L, box, regions, status);
}

/* nearest_patch_nodes(system, points): array of node indices */
static int nearest_patch_nodes(lua_State *L) {
  const bw_system *system = (const bw_system *)lbw_check(L, 1, &lbw_system_class);
  int64_t count;
  lua_settop(L, 2);
  const double *point = lbw_to_doubles(L, 2, "points", 3, &count);
  int32_t *node = (int32_t *)lbw_push_array(L, BW_I32, count, 1)->data;
  bw_status status =
      bw_nearest_patch_nodes(lbw_enter(L), system->mesh, system->dof_map, count, point, node);
  for (int64_t i = 0; i < count; i++)
    node[i]++;
  return lbw_leave(L, status, 1);
}

/* patch_regions(system, radius, nodes, stresses) */
static int patch_regions(lua_State *L) {
  const bw_system *system = (const bw_system *)lbw_check(L, 1, &lbw_system_class);
  int64_t count, rows;
  lua_settop(L, 4);
  double radius = lbw_check_number(L, 2);
  const int32_t *node = lbw_to_indices(L, 3, "nodes", 1, &count);
  const double *stress = lbw_to_doubles(L, 4, "stresses", 6, &rows);
  lbw_check_rows(L, 4, "stresses", rows, count, "node");
  lbw_box *box = lbw_box_new(L, &lbw_weak_regions_class);
  bw_weak_regions *regions = NULL;
  bw_status status = bw_weak_regions_patches(lbw_enter(L), system->mesh, system->dof_map, radius,
                                             count, node, stress, &regions);
  return lbw_leave_object(L, box, regions, status);
}

/* regions[i]: {mode, rank, count, volume, energy, peak}; mode and rank where a mode gave the region
 */
static int regions_index(lua_State *L) {
  const bw_weak_regions *regions = regions_self(L);
  const bw_weak_region *region = &regions->region[lbw_check_index(L, 2, "region", regions->count)];
  lua_createtable(L, 0, 6);
  if (region->mode >= 0) {
    lua_pushinteger(L, (lua_Integer)region->mode + 1);
    lua_setfield(L, -2, "mode");
    lua_pushinteger(L, (lua_Integer)region->rank + 1);
    lua_setfield(L, -2, "rank");
  }
  lua_pushinteger(L, region->count);
  lua_setfield(L, -2, "count");
  lua_pushnumber(L, region->volume);
  lua_setfield(L, -2, "volume");
  lua_pushnumber(L, region->energy);
  lua_setfield(L, -2, "energy");
  lua_pushnumber(L, region->peak);
  lua_setfield(L, -2, "peak");
  return 1;
}

static int regions_elements(lua_State *L) {
  const bw_weak_regions *regions = regions_self(L);
  const bw_weak_region *region = &regions->region[lbw_check_index(L, 2, "region", regions->count)];
  return lbw_push_indices(L, region->count, 1, region->element);
}

static int regions_weights(lua_State *L) {
  const bw_weak_regions *regions = regions_self(L);
  const bw_weak_region *region = &regions->region[lbw_check_index(L, 2, "region", regions->count)];
  static const int widths[] = {
      [BW_WORST_STRESS] = 1, [BW_WORST_DISPLACEMENT] = 3, [BW_WORST_DIRECTION] = 6};
  int columns = widths[regions->options.target];
  return lbw_push_borrowed(L, BW_F64, region->count, columns, region->weight, regions);
}

LBW_PUSH(regions_count, lua_pushinteger(L, regions_self(L)->count))
LBW_PUSH(regions_mesh, lbw_push(L, &lbw_mesh_class, regions_self(L)->mesh))

static int regions_tostring(lua_State *L) {
  const bw_weak_regions *regions =
      (const bw_weak_regions *)lbw_check(L, 1, &lbw_weak_regions_class);
  lua_pushfstring(L, "%d weak regions", regions->count);
  return 1;
}

/* regions:objective(i, material): the forces whose displacement q gives the objective's gradient,
 * basis:gradient(q) (eq. 15 of the paper): a row of three for every node */
static int regions_objective(lua_State *L) {
  const bw_weak_regions *regions = regions_self(L);
  int64_t i = lbw_check_index(L, 2, "region", regions->count);
  const bw_material *material = (const bw_material *)lbw_check(L, 3, &lbw_material_class);
  double *out = (double *)lbw_push_array(L, BW_F64, regions->mesh->node_count, 3)->data;
  return lbw_leave(L, bw_region_objective(lbw_enter(L), regions, (int)i, material, out), 1);
}

static const luaL_Reg regions_methods[] = {{"elements", regions_elements},
                                           {"weights", regions_weights},
                                           {"objective", regions_objective},
                                           {NULL, NULL}};
static const luaL_Reg regions_properties[] = {
    {"count", regions_count}, {"mesh", regions_mesh}, {NULL, NULL}};
static const luaL_Reg regions_meta[] = {{"__len", regions_count},
                                        {"__index", regions_index},
                                        {"__tostring", regions_tostring},
                                        {NULL, NULL}};
const lbw_class lbw_weak_regions_class = {"weak_regions", regions_methods, regions_properties,
                                          regions_meta, NULL};

/* ---- pressures ------------------------------------------------------------------------------- */

static const bw_pressure_basis *basis_self(lua_State *L) {
  return (const bw_pressure_basis *)lbw_check(L, 1, &lbw_pressure_basis_class);
}

/* pressure_basis(mesh, {forbidden, spacing, friction, friction_facets}) */
static int pressure_basis(lua_State *L) {
  static const lbw_option list[] = {
      {"forbidden", LBW_OTHER, 0},
      {"cuts", LBW_OTHER, 0},
      {"spacing", LBW_REAL, offsetof(bw_pressure_options, spacing)},
      {"friction", LBW_REAL, offsetof(bw_pressure_options, friction)},
      {"friction_facets", LBW_INT, offsetof(bw_pressure_options, friction_facets)},
      {NULL, LBW_OTHER, 0}};
  const bw_mesh *mesh = (const bw_mesh *)lbw_check(L, 1, &lbw_mesh_class);
  bw_pressure_options options = {.friction_facets = 8};
  lua_settop(L, 2);
  lbw_options(L, 2, "pressure_basis", list, &options);
  static const char *const name[] = {"forbidden", "cuts"};
  const bw_selection **on[] = {&options.forbidden, &options.cuts};
  for (int i = 0; i < 2; i++) {
    if (lbw_option_get(L, 2, name[i]) == LUA_TNIL)
      continue;
    *on[i] = (const bw_selection *)lbw_test(L, -1, &lbw_selection_class);
    if (!*on[i])
      return lbw_option_refused(L, "pressure_basis", name[i], "a selection");
    lbw_argument_check(L, (*on[i])->mesh == mesh, 2,
                       lua_pushfstring(L, "%s: a selection on the same mesh expected", name[i]));
  }
  lbw_box *box = lbw_box_new(L, &lbw_pressure_basis_class);
  bw_pressure_basis *basis = NULL;
  bw_status status = bw_pressure_basis_create(lbw_enter(L), mesh, &options, &basis);
  return lbw_leave_object(L, box, basis, status);
}

static double *check_pressure(lua_State *L, const bw_pressure_basis *basis) {
  int64_t rows;
  double *pressure = lbw_to_doubles(L, 2, "pressure", 1, &rows);
  lbw_check_rows(L, 2, "pressure", rows, basis->count, "column");
  return pressure;
}

/* basis:force(pressure): a row of three for every mesh node */
static int basis_force(lua_State *L) {
  const bw_pressure_basis *basis = basis_self(L);
  double *pressure = check_pressure(L, basis);
  bw_array *force = lbw_push_array(L, BW_F64, basis->mesh->node_count, 3);
  bw_pressure_force(basis, pressure, (double *)force->data);
  return 1;
}

/* basis:nodal(pressure): at every mesh node, that of its columns; of several cells the mean */
static int basis_nodal(lua_State *L) {
  const bw_pressure_basis *basis = basis_self(L);
  const double *pressure = check_pressure(L, basis);
  size_t count = (size_t)basis->mesh->node_count;
  double *out = (double *)lbw_push_array(L, BW_F64, basis->mesh->node_count, 1)->data;
  double *area = (double *)lua_newuserdatauv(L, count * sizeof *area, 0);
  memset(out, 0, count * sizeof *out);
  memset(area, 0, count * sizeof *area);
  for (int32_t j = 0; j < basis->count; j++) {
    out[basis->node[j]] += basis->area[j] * pressure[j];
    area[basis->node[j]] += basis->area[j] / basis->directions;
  }
  for (size_t i = 0; i < count; i++)
    out[i] = area[i] > 0 ? out[i] / area[i] : 0;
  lua_pop(L, 1);
  return 1;
}

/* basis:arrows(pressure, radius): {{at, force, area}, ...}, largest first */
static int basis_arrows(lua_State *L) {
  const bw_pressure_basis *basis = basis_self(L);
  double radius = lbw_number_or(L, 3, 0);
  double *pressure = check_pressure(L, basis);
  int count = 0;
  bw_arrow *found = NULL;
  bw_status status = bw_resultant_arrows(lbw_enter(L), basis, pressure, radius, &count, &found);
  lbw_state_of(L)->running = 0;
  if (status != BW_OK)
    return lbw_leave(L, status, 0);
  /* Copied into Lua's memory first: from here on tables may run out of memory. */
  enum { MAX_SHOWN = 4096 };
  static const size_t size = sizeof(bw_arrow);
  int kept = count < MAX_SHOWN ? count : MAX_SHOWN;
  luaL_Buffer buffer;
  luaL_buffinit(L, &buffer);
  if (kept > 0)
    luaL_addlstring(&buffer, (const char *)found, (size_t)kept * size);
  bw_free(found);
  luaL_pushresult(&buffer);
  const char *copy = lua_tostring(L, -1);
  lua_createtable(L, kept, 0);
  for (int i = 0; i < kept; i++) {
    bw_arrow arrow;
    memcpy(&arrow, copy + (size_t)i * size, size);
    lua_createtable(L, 0, 3);
    lbw_push_vector(L, arrow.at);
    lua_setfield(L, -2, "at");
    lbw_push_vector(L, arrow.force);
    lua_setfield(L, -2, "force");
    lua_pushnumber(L, arrow.area);
    lua_setfield(L, -2, "area");
    lua_rawseti(L, -2, i + 1);
  }
  return lbw_leave(L, BW_OK, 1);
}

/* basis:gradient(q): by each pressure, of the work of the forces on q */
static int basis_gradient(lua_State *L) {
  const bw_pressure_basis *basis = basis_self(L);
  int64_t rows;
  double *q = lbw_to_doubles(L, 2, "q", 3, &rows);
  lbw_check_rows(L, 2, "q", rows, basis->mesh->node_count, "node");
  bw_array *out = lbw_push_array(L, BW_F64, basis->count, 1);
  bw_pressure_gradient(basis, q, (double *)out->data);
  return 1;
}

/* basis:maximise(system, objective, {pressure, force, force_is_max, hands, hand_area, lp}):
 * the pressure of an allowed load that makes objective . pressure largest, that value, a report */
static int basis_maximise(lua_State *L) {
  bw_worst_load_options options;
  static const lbw_option list[] = {
      {"pressure", LBW_REAL, offsetof(bw_worst_load_options, pressure)},
      {"force", LBW_REAL, offsetof(bw_worst_load_options, force)},
      {"force_is_max", LBW_BOOLEAN, offsetof(bw_worst_load_options, force_is_max)},
      {"hands", LBW_INT, offsetof(bw_worst_load_options, hands)},
      {"hand_area", LBW_REAL, offsetof(bw_worst_load_options, hand_area)},
      {"lp", LBW_OTHER, 0},
      {NULL, LBW_OTHER, 0}};
  const bw_pressure_basis *basis = basis_self(L);
  const bw_system *system = (const bw_system *)lbw_check(L, 2, &lbw_system_class);
  lbw_argument_check(L, system->mesh == basis->mesh, 2, "a system of the same mesh expected");
  memset(&options, 0, sizeof options);
  lua_settop(L, 4);
  lbw_options(L, 4, "maximise", list, &options);
  options.lp = lbw_lp_option(L, 4, "maximise");
  int64_t rows;
  double *objective = lbw_to_doubles(L, 3, "objective", 1, &rows), value = 0;
  lbw_check_rows(L, 3, "objective", rows, basis->count, "column");
  double *out = (double *)lbw_push_array(L, BW_F64, rows, 1)->data;
  bw_solver_report report;
  bw_status status = bw_worst_loads(lbw_enter(L), basis, system->dof_map, &options, 1, objective,
                                    out, &value, NULL, &report);
  int results = lbw_leave(L, status, 1);
  if (status != BW_OK)
    return results;
  lua_pushnumber(L, value);
  lbw_push_report(L, &report);
  return 3;
}

static int basis_tostring(lua_State *L) {
  const bw_pressure_basis *basis =
      (const bw_pressure_basis *)lbw_check(L, 1, &lbw_pressure_basis_class);
  lua_pushfstring(L, "pressure basis of %d pressures", (int)(basis->count / basis->directions));
  return 1;
}

static int basis_nodes(lua_State *L) {
  const bw_pressure_basis *basis = basis_self(L);
  return lbw_push_indices(L, basis->count, 1, basis->node);
}

static int basis_areas(lua_State *L) {
  const bw_pressure_basis *basis = basis_self(L);
  return lbw_push_borrowed(L, BW_F64, basis->count, 1, basis->area, basis);
}

LBW_PUSH(basis_directions, lua_pushinteger(L, basis_self(L)->directions))
LBW_PUSH(basis_count, lua_pushinteger(L, basis_self(L)->count))

static const luaL_Reg basis_methods[] = {{"force", basis_force},   {"gradient", basis_gradient},
                                         {"nodal", basis_nodal},   {"maximise", basis_maximise},
                                         {"arrows", basis_arrows}, {NULL, NULL}};
static const luaL_Reg basis_meta[] = {{"__tostring", basis_tostring}, {NULL, NULL}};
static const luaL_Reg basis_properties[] = {{"nodes", basis_nodes},
                                            {"areas", basis_areas},
                                            {"count", basis_count},
                                            {"directions", basis_directions},
                                            {NULL, NULL}};
const lbw_class lbw_pressure_basis_class = {"pressure_basis", basis_methods, basis_properties,
                                            basis_meta, NULL};

/* ---- drops ----------------------------------------------------------------------------------- */

static void copy_out(lua_State *L, int table, const char *key, int64_t rows, int64_t columns,
                     const double *data) {
  void *to = lbw_push_array(L, BW_F64, rows, columns)->data;
  lua_setfield(L, table, key);
  memcpy(to, data, (size_t)(rows * columns) * sizeof *data);
}

static void copy_counts(lua_State *L, int table, const char *key, int64_t rows,
                        const int32_t *data) {
  void *to = lbw_push_array(L, BW_I32, rows, 1)->data;
  lua_setfield(L, table, key);
  memcpy(to, data, (size_t)rows * sizeof *data);
}

typedef struct drop_out {
  const bw_drop_test_result *result;
  int64_t elements;
} drop_out;

static int push_drops(lua_State *L) {
  const drop_out *out = (const drop_out *)lua_touserdata(L, 1);
  const bw_drop_test_result *result = out->result;
  lua_createtable(L, 0, 11);
  copy_out(L, 2, "exceedance", out->elements, 1, result->exceedance);
  copy_out(L, 2, "mean_peak", out->elements, 1, result->mean_peak);
  copy_out(L, 2, "contacts", result->drops, 3, result->contact);
  copy_out(L, 2, "directions", result->drops, 3, result->direction);
  copy_out(L, 2, "resultants", result->drops, 3, result->resultant);
  copy_counts(L, 2, "nodes", result->drops, result->nodes);
  copy_out(L, 2, "forces", result->drops, 1, result->force);
  copy_out(L, 2, "areas", result->drops, 1, result->area);
  copy_out(L, 2, "peaks", result->drops, 1, result->peak);
  lua_pushnumber(L, result->threshold);
  lua_setfield(L, 2, "threshold");
  lua_pushinteger(L, result->drops);
  lua_setfield(L, 2, "drops");
  return 1;
}

/* drops(system, {drops, height, peg_radius, duration, seed}): a table of arrays */
static int drops(lua_State *L) {
  static const lbw_option list[] = {
      {"drops", LBW_COUNT, offsetof(bw_drop_test_options, drops)},
      {"height", LBW_REAL, offsetof(bw_drop_test_options, height)},
      {"peg_radius", LBW_REAL, offsetof(bw_drop_test_options, peg_radius)},
      {"duration", LBW_REAL, offsetof(bw_drop_test_options, duration)},
      {"seed", LBW_SEED, offsetof(bw_drop_test_options, seed)},
      {NULL, LBW_OTHER, 0}};
  bw_system *system = (bw_system *)lbw_check(L, 1, &lbw_system_class);
  bw_drop_test_options options;
  bw_drop_test_options_default(&options);
  lbw_options(L, 2, "drops", list, &options);
  bw_drop_test_result result;
  memset(&result, 0, sizeof result);
  drop_out out = {&result, system->mesh->element_count};
  lua_pushcfunction(L, push_drops);
  lua_pushlightuserdata(L, &out);
  bw_status status = bw_drop_test(lbw_enter(L), system, &options, &result);
  lbw_state_of(L)->running = 0;
  if (status != BW_OK)
    return lbw_leave(L, status, 0);
  int failure = lua_pcall(L, 1, 1, 0);
  bw_drop_test_result_clear(&result);
  return failure ? lua_error(L) : lbw_leave(L, BW_OK, 1);
}

/* rank_correlation(a, b, weights): Spearman's */
static int rank_correlation(lua_State *L) {
  int64_t count, other;
  lua_settop(L, 3);
  double *a = lbw_to_doubles(L, 1, "a", 1, &count);
  double *b = lbw_to_doubles(L, 2, "b", 1, &other), *weight = NULL, rho = 0;
  lbw_check_rows(L, 2, "b", other, count, "row of a");
  if (!lua_isnoneornil(L, 3)) {
    weight = lbw_to_doubles(L, 3, "weights", 1, &other);
    lbw_check_rows(L, 3, "weights", other, count, "row of a");
  }
  bw_context *context = lbw_enter(L);
  bw_status status = weight ? bw_weighted_rank_correlation(context, count, a, b, weight, &rho)
                            : bw_rank_correlation(context, count, a, b, &rho);
  lua_pushnumber(L, rho);
  return lbw_leave(L, status, 1);
}

void lbw_open_worst(lua_State *L) {
  static const luaL_Reg functions[] = {{"weak_regions", weak_regions_find},
                                       {"single_regions", single_regions},
                                       {"pressure_basis", pressure_basis},
                                       {"directed_regions", directed_regions},
                                       {"patch_regions", patch_regions},
                                       {"nearest_patch_nodes", nearest_patch_nodes},
                                       {"drops", drops},
                                       {"rank_correlation", rank_correlation},
                                       {NULL, NULL}};
  lbw_class_register(L, &lbw_weak_regions_class);
  lbw_class_register(L, &lbw_pressure_basis_class);
  luaL_setfuncs(L, functions, 0);
  lbw_open_worst_loads(L);
}
