/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* Rainflow counting and damage. */
#include "bind.h"

/* rainflow(history): rows {range, mean, count} */
static int core_rainflow(lua_State *L) {
  int64_t count, cycles = 0;
  lua_settop(L, 1);
  const double *history = lbw_to_doubles(L, 1, "rainflow: history", 1, &count);
  lbw_box *box = lbw_box_new(L, &lbw_array_class);
  bw_context *context = lbw_enter(L);
  bw_cycle *cycle = NULL;
  bw_array *array = NULL;
  bw_status status = bw_rainflow(context, count, history, &cycle, &cycles);
  if (status == BW_OK)
    status = bw_array_create(context, BW_F64, cycles, 3, &array);
  for (int64_t i = 0; array && i < cycles; i++) {
    double *row = (double *)array->data + 3 * i;
    row[0] = cycle[i].range;
    row[1] = cycle[i].mean;
    row[2] = cycle[i].count;
  }
  bw_free(cycle);
  return lbw_leave_object(L, box, array, status);
}

void lbw_check_life_curve(lua_State *L, int index, bw_life_curve *curve) {
  static const lbw_option list[] = {{"amplitude", LBW_REAL, offsetof(bw_life_curve, amplitude)},
                                    {"cycles", LBW_REAL, offsetof(bw_life_curve, cycles)},
                                    {"exponent", LBW_REAL, offsetof(bw_life_curve, exponent)},
                                    {"limit", LBW_REAL, offsetof(bw_life_curve, limit)},
                                    {"strength", LBW_REAL, offsetof(bw_life_curve, strength)},
                                    {NULL, LBW_OTHER, 0}};
  bw_life_curve_default(curve);
  lbw_options(L, index, "fatigue: curve", list, curve);
}

/* fatigue_damage({static solution of each case}, {{factor of each case} at each step}, curve) */
static int core_fatigue_damage(lua_State *L) {
  bw_life_curve curve;
  int64_t steps;
  lua_settop(L, 3);
  lbw_check_life_curve(L, 3, &curve);
  int cases = (int)lua_rawlen(L, 1);
  const bw_static **result =
      (const bw_static **)lua_newuserdatauv(L, (size_t)cases * sizeof *result + 1, 0);
  for (int c = 0; c < cases; c++) {
    lua_rawgeti(L, 1, c + 1);
    result[c] =
        (const bw_static *)lbw_check(L, lua_gettop(L), &lbw_static_class); /* the table keeps it */
    lua_pop(L, 1);
  }
  const double *factor = lbw_to_doubles(L, 2, "fatigue: histories", cases, &steps);
  if (cases < 1)
    return lbw_error(L, "fatigue: at least one load expected");
  double *damage = (double *)lbw_push_array(L, BW_F64, result[0]->model->mesh->node_count, 1)->data;
  return lbw_leave(L, bw_static_damage(lbw_enter(L), &curve, cases, result, steps, factor, damage),
                   1);
}

/* spectral_damage(curve, index of the method, m0, m1, m2, m4): damage per time. The curve was
 * checked before. */
static int core_spectral_damage(lua_State *L) {
  bw_life_curve curve;
  double moment[4], rate = 0;
  lua_settop(L, 6);
  lbw_check_life_curve(L, 1, &curve);
  bw_spectral_method method = (bw_spectral_method)lbw_check_index(L, 2, "method", 4);
  for (int k = 0; k < 4; k++)
    moment[k] = lbw_check_real(L, 3 + k, "moment");
  bw_status status = bw_spectral_damage(lbw_enter(L), &curve, method, moment, &rate);
  lua_pushnumber(L, rate);
  return lbw_leave(L, status, 1);
}

void lbw_open_fatigue(lua_State *L) {
  static const luaL_Reg functions[] = {{"rainflow", core_rainflow},
                                       {"fatigue_damage", core_fatigue_damage},
                                       {"spectral_damage", core_spectral_damage},
                                       {NULL, NULL}};
  luaL_setfuncs(L, functions, 0);
}
