/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* model:contact_system: the equations of parts in contact for many loads. */
#include "bind.h"

#include <string.h>

static bw_contact_system *self(lua_State *L) {
  return (bw_contact_system *)lbw_check(L, 1, &lbw_contact_system_class);
}

/* model:contact_system(pairs, {solver}) */
static int model_contact_system(lua_State *L) {
  static const lbw_option list[] = {{"solver", LBW_OTHER, 0}, {NULL, LBW_OTHER, 0}};
  lbw_box *model = lbw_check_box(L, 1, &lbw_model_class);
  lbw_check_type(L, 2, LUA_TTABLE);
  lua_settop(L, 3);
  lbw_options(L, 3, "contact_system", list, NULL);
  const bw_solver *solver = lbw_solver_option(L, 3, "contact_system");
  if (lbw_solver_is_external(solver))
    return lbw_error(L, "contact_system: a solver of the engine expected, got one of another "
                        "program: leave the solver out, or give cholesky");
  int count;
  bw_contact_pair *pair = lbw_contact_pairs(L, 2, "contact_system", &count);
  lbw_box *box = lbw_box_new(L, &lbw_contact_system_class);
  bw_contact_system *contact = NULL;
  bw_status status = bw_contact_system_create(lbw_enter(L), (const bw_model *)model->object, count,
                                              pair, solver, (bw_system *)model->extra, &contact);
  return lbw_leave_object(L, box, contact, status);
}

/* contact_system:solve(force): displacement, and 1 for each candidate that carries pressure */
static int contact_system_solve(lua_State *L) {
  const bw_contact_system *contact = self(L);
  int64_t rows;
  double *force = lbw_to_doubles(L, 2, "force", 3, &rows);
  lbw_check_rows(L, 2, "force", rows, contact->model->mesh->node_count, "node");
  double *out = (double *)lbw_push_array(L, BW_F64, rows, 3)->data;
  uint8_t *state = (uint8_t *)lbw_push_array(L, BW_U8, contact->count, 1)->data;
  return lbw_leave(L, bw_contact_system_solve(lbw_enter(L), contact, 1, force, out, state), 2);
}

/* contact_system:in_state("closed", "open", or an array): a system */
static int contact_system_in_state(lua_State *L) {
  static const char *const words[] = {"closed", "open", NULL};
  bw_contact_system *contact = self(L);
  uint8_t *state;
  if (lua_type(L, 2) == LUA_TSTRING) {
    int open = lbw_check_word(L, 2, words);
    state = (uint8_t *)lua_newuserdatauv(L, (size_t)contact->count, 0);
    memset(state, !open, (size_t)contact->count);
  } else {
    state = lbw_to_mask(L, 2, "state", contact->count);
  }
  lbw_box *box = lbw_box_new(L, &lbw_system_class);
  bw_system *system = NULL;
  bw_status status = bw_contact_system_in_state(lbw_enter(L), contact, state, &system);
  return lbw_leave_object(L, box, system, status);
}

static int contact_system_candidates(lua_State *L) {
  lua_pushinteger(L, self(L)->count);
  return 1;
}

static int contact_system_pairs(lua_State *L) {
  lua_pushinteger(L, self(L)->pair_count);
  return 1;
}

static int contact_system_closed(lua_State *L) {
  lua_pushboolean(L, self(L)->closed);
  return 1;
}

static int contact_system_system(lua_State *L) {
  lbw_push(L, &lbw_system_class, self(L)->system);
  return 1;
}

static int contact_system_mesh(lua_State *L) {
  lbw_push(L, &lbw_mesh_class, self(L)->model->mesh);
  return 1;
}

static int contact_system_cuts(lua_State *L) {
  const bw_selection *cuts = self(L)->cuts;
  if (cuts)
    lbw_push(L, &lbw_selection_class, cuts);
  else
    lua_pushnil(L);
  return 1;
}

static int contact_system_tostring(lua_State *L) {
  const bw_contact_system *contact = self(L);
  lua_pushfstring(L,
                  "contact of %d pair%s without friction under many loads: %d corners that may "
                  "touch, %s",
                  contact->pair_count, contact->pair_count == 1 ? "" : "s", contact->count,
                  contact->closed ? "all closed without a load" : "with gaps or interference");
  return 1;
}

static const luaL_Reg methods[] = {
    {"solve", contact_system_solve}, {"in_state", contact_system_in_state}, {NULL, NULL}};
static const luaL_Reg properties[] = {{"candidates", contact_system_candidates},
                                      {"pair_count", contact_system_pairs},
                                      {"closed", contact_system_closed},
                                      {"system", contact_system_system},
                                      {"mesh", contact_system_mesh},
                                      {"cuts", contact_system_cuts},
                                      {NULL, NULL}};
static const luaL_Reg meta[] = {{"__tostring", contact_system_tostring}, {NULL, NULL}};
const lbw_class lbw_contact_system_class = {"contact_system", methods, properties, meta, NULL};

void lbw_open_contact_system(lua_State *L) {
  static const luaL_Reg of_model[] = {{"contact_system", model_contact_system}, {NULL, NULL}};
  lbw_class_register(L, &lbw_contact_system_class);
  lbw_add_methods(L, &lbw_model_class, of_model);
}
