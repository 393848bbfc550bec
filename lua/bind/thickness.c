/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* surface:thickness: how thick the body is under its surface. */
#include "bind.h"

/* surface:thickness(samples): arrays of thicknesses and of places, samples of equal areas */
static int surface_thickness(lua_State *L) {
  const bw_surface *surface = (const bw_surface *)lbw_check(L, 1, &lbw_surface_class);
  lua_Integer samples = lbw_integer_or(L, 2, 1000);
  lbw_argument_check(L, samples >= 1 && samples <= 10000000, 2,
                     "a number of samples from 1 to 10000000 expected");
  bw_array *thickness = lbw_push_array(L, BW_F64, samples, 1);
  bw_array *place = lbw_push_array(L, BW_F64, samples, 3);
  bw_status status = bw_surface_thickness(lbw_enter(L), surface, (int32_t)samples,
                                          (double *)thickness->data, (double *)place->data);
  return lbw_leave(L, status, 2);
}

void lbw_open_thickness(lua_State *L) {
  static const luaL_Reg methods[] = {{"thickness", surface_thickness}, {NULL, NULL}};
  lbw_add_methods(L, &lbw_surface_class, methods);
}
