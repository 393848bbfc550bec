/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* Singular places: what lua/barwright/singular.lua makes surface:singular_edges() of. */
#include "bind.h"

#include "barwright/singular_places.h"

/* Rows of three numbers as a list of vectors. */
static void push_rows(lua_State *L, const double *row, int32_t count, const char *key) {
  lua_createtable(L, count, 0);
  for (int32_t i = 0; i < count; i++) {
    lbw_push_vector(L, row + 3 * (size_t)i);
    lua_rawseti(L, -2, i + 1);
  }
  lua_setfield(L, -2, key);
}

static void push_number(lua_State *L, const char *key, double value) {
  lua_pushnumber(L, value);
  lua_setfield(L, -2, key);
}

static int push_places(lua_State *L) {
  const bw_singular_places *places = (const bw_singular_places *)lua_touserdata(L, 1);
  lua_createtable(L, places->count, 0);
  for (int32_t i = 0; i < places->count; i++) {
    const bw_singular_place *place = &places->place[i];
    lua_createtable(L, 0, 9);
    lua_pushstring(L, bw_singular_word(place->kind));
    lua_setfield(L, -2, "kind");
    push_rows(L, places->point + 3 * (size_t)place->first, place->count, "points");
    push_rows(L, places->inward + 3 * (size_t)place->first, place->count, "inward");
    push_number(L, "length", place->length);
    push_number(L, "exponent", place->exponent);
    push_number(L, "growth", 1 - place->exponent);
    if (place->angle > 0) {
      push_number(L, "angle", place->angle);
      push_number(L, "min_angle", place->min_angle);
      push_number(L, "largest_angle", place->largest_angle);
    }
    lua_rawseti(L, -2, i + 1);
  }
  return 1;
}

/* Ends a call of the engine with a list of places, which are released. */
static int leave_places(lua_State *L, bw_status status, bw_singular_places *places) {
  if (status != BW_OK)
    return lbw_leave(L, status, 0);
  lbw_state_of(L)->running = 0;
  lua_pushcfunction(L, push_places);
  lua_pushlightuserdata(L, places);
  int failure = lua_pcall(L, 1, 1, 0);
  bw_release(places);
  return failure ? lua_error(L) : lbw_leave(L, BW_OK, 1);
}

/* singular_edges(surface, angle): a list of tables */
static int core_singular_edges(lua_State *L) {
  const bw_surface *surface = (const bw_surface *)lbw_check(L, 1, &lbw_surface_class);
  double margin = lbw_check_real(L, 2, "angle");
  bw_singular_places *places = NULL;
  bw_status status = bw_singular_edges(lbw_enter(L), surface, NULL, margin, &places);
  return leave_places(L, status, places);
}

/* singular_places(model, surface or nil, angle): a list of tables */
static int core_singular_places(lua_State *L) {
  const bw_model *model = (const bw_model *)lbw_check(L, 1, &lbw_model_class);
  const bw_surface *surface =
      lua_isnil(L, 2) ? NULL : (const bw_surface *)lbw_check(L, 2, &lbw_surface_class);
  double margin = lbw_check_real(L, 3, "angle");
  bw_singular_places *places = NULL;
  bw_status status = bw_singular_places_find(lbw_enter(L), model, surface, margin, &places);
  return leave_places(L, status, places);
}

void lbw_open_singular(lua_State *L) {
  static const luaL_Reg functions[] = {{"singular_edges", core_singular_edges},
                                       {"singular_places", core_singular_places},
                                       {NULL, NULL}};
  luaL_setfuncs(L, functions, 0);
}
