/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* core.sobol: points that fill a cube evenly. */
#include "bind.h"

/* sobol(count, dimensions, {skip, seed}): scrambled where there is a seed */
static int core_sobol(lua_State *L) {
  static const lbw_option list[] = {{"skip", LBW_COUNT, offsetof(bw_sobol_options, skip)},
                                    {"seed", LBW_SEED, offsetof(bw_sobol_options, seed)},
                                    {NULL, LBW_OTHER, 0}};
  lua_Integer count = lbw_check_integer(L, 1), dimensions = lbw_check_integer(L, 2);
  lbw_argument_check(L, count >= 0, 1, "a number of points expected");
  lbw_argument_check(L, dimensions >= 1 && dimensions <= BW_SOBOL_DIMENSIONS, 2,
                     "1 to 1111 dimensions expected");
  bw_sobol_options options = {0};
  lbw_options(L, 3, "sobol", list, &options);
  options.scrambled = lbw_option_get(L, 3, "seed") != LUA_TNIL;
  bw_array *points = lbw_push_array(L, BW_F64, count, dimensions);
  return lbw_leave(
      L, bw_sobol(lbw_enter(L), count, (int)dimensions, &options, (double *)points->data), 1);
}

void lbw_open_sobol(lua_State *L) {
  static const luaL_Reg functions[] = {{"sobol", core_sobol}, {NULL, NULL}};
  luaL_setfuncs(L, functions, 0);
}
