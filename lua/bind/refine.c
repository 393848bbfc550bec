/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* What adaptive refinement needs of the engine: refined models, recovered stresses, products of
 * primal and dual errors, loads of dual problems. */
#include "bind.h"

#include <math.h>
#include <string.h>

enum { MAX_LEVELS = 30, MAX_ALSO = 64 };

/* The selections in the list at `index`, in a userdata that is pushed. */
static const bw_selection **read_selections(lua_State *L, int index, int *count) {
  lua_Integer length = lua_istable(L, index) ? (lua_Integer)lua_rawlen(L, index) : -1;
  if (length < 0 || length > MAX_ALSO)
    lbw_error(L, "refined: option 'also': a list of at most %d selections expected, got %s",
              MAX_ALSO,
              length < 0 ? lbw_got(L, index) : lua_pushfstring(L, "%I", (LUAI_UACINT)length));
  *count = (int)length;
  const bw_selection **list =
      (const bw_selection **)lua_newuserdatauv(L, ((size_t)length + 1) * sizeof *list, 0);
  for (int i = 0; i < *count; i++) {
    lua_rawgeti(L, index, i + 1);
    list[i] = (const bw_selection *)lbw_test(L, -1, &lbw_selection_class);
    if (!list[i])
      lbw_error(L, "refined: option 'also': item %d: an open selection expected, got %s", i + 1,
                lbw_got(L, -1));
    lua_pop(L, 1);
  }
  return list;
}

static uint8_t *read_levels(lua_State *L, int index, int64_t elements) {
  int64_t rows;
  const double *given = lbw_to_doubles(L, index, "levels", 1, &rows);
  lbw_check_rows(L, index, "levels", rows, elements, "element");
  uint8_t *levels = (uint8_t *)lua_newuserdatauv(L, (size_t)elements + 1, 0);
  for (int64_t e = 0; e < elements; e++) {
    lbw_argument_check(L, given[e] >= 0 && given[e] <= MAX_LEVELS, index,
                       "levels: numbers from 0 to 30 expected");
    levels[e] = (uint8_t)given[e];
  }
  return levels;
}

/* model:refined(levels, {surface, order, max_elements, also}): model, the selections of `also` */
static int model_refined(lua_State *L) {
  struct opts {
    int order;
    int64_t max;
  } opts = {0, 100000000};
  static const lbw_option list[] = {{"surface", LBW_OTHER, 0},
                                    {"also", LBW_OTHER, 0},
                                    {"order", LBW_INT, offsetof(struct opts, order)},
                                    {"max_elements", LBW_COUNT, offsetof(struct opts, max)},
                                    {NULL, LBW_OTHER, 0}};
  const bw_model *model = (const bw_model *)lbw_check(L, 1, &lbw_model_class);
  const bw_surface *surface = NULL;
  const bw_selection **also = NULL;
  bw_selection *transferred[MAX_ALSO] = {NULL};
  lbw_box *transferred_box[MAX_ALSO];
  int also_count = 0;
  lua_settop(L, 3);
  lbw_options(L, 3, "refined", list, &opts);
  if (lbw_option_get(L, 3, "surface") != LUA_TNIL) {
    surface = (const bw_surface *)lbw_test(L, -1, &lbw_surface_class);
    if (!surface)
      return lbw_error(L, "refined: option 'surface': an open surface expected, got %s",
                       lbw_got(L, -1));
  }
  if (lbw_option_get(L, 3, "also") != LUA_TNIL)
    also = read_selections(L, lua_gettop(L), &also_count);
  uint8_t *levels = read_levels(L, 2, model->mesh->element_count);
  luaL_checkstack(L, 8, NULL);
  lbw_box *box = lbw_box_new(L, &lbw_model_class);
  lua_createtable(L, also_count, 0);
  for (int i = 0; i < also_count; i++) {
    transferred_box[i] = lbw_box_new(L, &lbw_selection_class);
    lua_rawseti(L, -2, i + 1);
  }
  bw_refinement refinement = {.mesh = NULL};
  bw_model *refined = NULL;
  bw_mesh *curved = NULL;
  bw_status status;
  bw_context *context = lbw_enter(L);
  BW_TRY(bw_mesh_refine(context, model->mesh, levels, opts.order ? opts.order : model->mesh->order,
                        opts.max, &refinement));
  if (surface)
    BW_TRY(bw_mesh_curved(context, refinement.mesh, surface, &curved, NULL));
  BW_TRY(bw_model_refined(context, model, &refinement, curved ? curved : refinement.mesh,
                          also_count, also, transferred, &refined));
done:
  bw_refinement_clear(&refinement);
  bw_release(curved);
  lbw_box_fill(L, box, refined);
  for (int i = 0; i < also_count; i++)
    lbw_box_fill(L, transferred_box[i], transferred[i]);
  return lbw_leave(L, status, 2);
}

typedef struct fields {
  const bw_mesh *mesh;
  const bw_material *material;
} fields;

static fields check_fields(lua_State *L) {
  return (fields){(const bw_mesh *)lbw_check(L, 1, &lbw_mesh_class),
                  (const bw_material *)lbw_check(L, 2, &lbw_material_class)};
}

static const double *check_displacement(lua_State *L, int index, const bw_mesh *mesh) {
  int64_t rows;
  const double *u = lbw_to_doubles(L, index, "displacement", 3, &rows);
  lbw_check_rows(L, index, "displacement", rows, mesh->node_count, "node");
  return u;
}

/* recovered_stress(mesh, material, displacement) */
static int core_recovered_stress(lua_State *L) {
  fields f = check_fields(L);
  const double *u = check_displacement(L, 3, f.mesh);
  double *out = (double *)lbw_push_array(L, BW_F64, f.mesh->node_count, 6)->data;
  return lbw_leave(L, bw_recovered_stress(lbw_enter(L), f.mesh, f.material, u, out), 1);
}

/* error_product(mesh, material, primal, dual): of every element, J */
static int core_error_product(lua_State *L) {
  fields f = check_fields(L);
  bool same = lua_rawequal(L, 3, 4);
  const double *primal = check_displacement(L, 3, f.mesh);
  const double *dual = same ? primal : check_displacement(L, 4, f.mesh);
  double *out = (double *)lbw_push_array(L, BW_F64, f.mesh->element_count, 1)->data;
  return lbw_leave(L, bw_error_product(lbw_enter(L), f.mesh, f.material, primal, dual, out), 1);
}

/* stress_functional(mesh, material, nodes, weights): nodal forces */
static int core_stress_functional(lua_State *L) {
  fields f = check_fields(L);
  int64_t count, rows;
  const int32_t *node = lbw_to_indices(L, 3, "nodes", 1, &count);
  const double *weight = lbw_to_doubles(L, 4, "weights", 6, &rows);
  lbw_check_rows(L, 4, "weights", rows, count, "node");
  for (int64_t i = 0; i < count; i++)
    lbw_argument_check(L, node[i] >= 0 && node[i] < f.mesh->node_count, 3,
                       "nodes: numbers of nodes of the mesh expected");
  double *out = (double *)lbw_push_array(L, BW_F64, f.mesh->node_count, 3)->data;
  return lbw_leave(
      L, bw_stress_functional(lbw_enter(L), f.mesh, f.material, count, node, weight, out), 1);
}

/* internal_force(mesh, material, displacement) */
static int core_internal_force(lua_State *L) {
  fields f = check_fields(L);
  const double *u = check_displacement(L, 3, f.mesh);
  double *out = (double *)lbw_push_array(L, BW_F64, f.mesh->node_count, 3)->data;
  return lbw_leave(L, bw_internal_force(lbw_enter(L), f.mesh, f.material, u, out), 1);
}

/* boundary_kink(mesh, node, limit) */
static int core_boundary_kink(lua_State *L) {
  const bw_mesh *mesh = (const bw_mesh *)lbw_check(L, 1, &lbw_mesh_class);
  int64_t node = lbw_check_index(L, 2, "node", mesh->node_count);
  double limit = lbw_check_real(L, 3, "limit"), kink = 0;
  bw_status status = bw_boundary_kink(lbw_enter(L), mesh, (int32_t)node, limit, &kink);
  lua_pushnumber(L, kink);
  return lbw_leave(L, status, 1);
}

/* modes:error_estimate(): cents by which every frequency is too high */
static int modes_error_estimate(lua_State *L) {
  const bw_modes *modes = (const bw_modes *)lbw_check(L, 1, &lbw_modes_class);
  double *out = (double *)lbw_push_array(L, BW_F64, modes->count, 1)->data;
  bw_status status = bw_modes_error(lbw_enter(L), modes, out);
  for (int k = 0; k < modes->count && status == BW_OK; k++)
    out[k] = 600 * log2(1 + out[k]); /* 1200 cents an octave, and the root of the eigenvalue */
  return lbw_leave(L, status, 1);
}

void lbw_open_refine(lua_State *L) {
  static const luaL_Reg of_model[] = {{"refined", model_refined}, {NULL, NULL}};
  static const luaL_Reg of_modes[] = {{"error_estimate", modes_error_estimate}, {NULL, NULL}};
  static const luaL_Reg functions[] = {
      {"recovered_stress", core_recovered_stress},   {"error_product", core_error_product},
      {"stress_functional", core_stress_functional}, {"internal_force", core_internal_force},
      {"boundary_kink", core_boundary_kink},         {NULL, NULL}};
  lbw_add_methods(L, &lbw_model_class, of_model);
  lbw_add_methods(L, &lbw_modes_class, of_modes);
  luaL_setfuncs(L, functions, 0);
}
