/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* Quantities as print, commands and plots show them: four significant digits and a unit of drawings
 * and tables. */
#include "bind.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* How a quantity in a SI unit is shown from a size on; of one unit the largest first. */
static const struct shown {
  const char *unit, *name;
  double scale, from;
} shown[] = {
    {"m", "m", 1, 10},         {"m", "mm", 1e-3, 1e-6},
    {"m", "um", 1e-6, 0},      {"m2", "m2", 1, 1},
    {"m2", "cm2", 1e-4, 1e-5}, {"m2", "mm2", 1e-6, 0},
    {"m3", "m3", 1, 0.1},      {"m3", "cm3", 1e-6, 1e-8},
    {"m3", "mm3", 1e-9, 0},    {"Pa", "GPa", 1e9, 1e9},
    {"Pa", "MPa", 1e6, 1e3},   {"Pa", "Pa", 1, 0},
    {"J", "kJ", 1e3, 1e4},     {"J", "J", 1, 1},
    {"J", "mJ", 1e-3, 0},      {"kg", "kg", 1, 1},
    {"kg", "g", 1e-3, 1e-3},   {"kg", "mg", 1e-6, 0},
    {"N", "kN", 1e3, 1e5},     {"B", "GB", 1e9, 1e9},
    {"B", "MB", 1e6, 0},       {"Pa m^0.5", "MPa m^0.5", 1e6, 0},
};

/* Four significant digits; no exponent in 12340. */
static void write_number(double value, char number[28]) {
  snprintf(number, 28, "%.4g", value + 0.0); /* -0 is 0 */
  if (strstr(number, "e+") && fabs(value) < 1e9)
    snprintf(number, 28, "%.0f", strtod(number, NULL));
}

const char *lbw_shown_unit(double value, const char *unit, double *scale) {
  char number[28];
  /* the unit of the number that is shown: 9.99999 m is 10 m */
  write_number(value, number);
  double size = fabs(strtod(number, NULL));
  for (size_t i = 0; i < sizeof shown / sizeof *shown; i++)
    if (strcmp(shown[i].unit, unit) == 0 &&
        (size >= shown[i].from || (value == 0 && shown[i].scale < 1))) {
      *scale = shown[i].scale;
      return shown[i].name;
    }
  *scale = 1;
  return unit;
}

lbw_text lbw_quantity(double value, const char *unit) {
  lbw_text out;
  double scale;
  char number[28];
  const char *name = lbw_shown_unit(value, unit, &scale);
  write_number(value / scale, number);
  snprintf(out.text, sizeof out.text, "%s%s%.16s", number, name[0] ? " " : "", name);
  return out;
}

lbw_text lbw_triple(const double x[3], double scale, const char *unit) {
  lbw_text out;
  char number[3][28];
  double largest = fmax(fabs(x[0]), fmax(fabs(x[1]), fabs(x[2])));
  for (int i = 0; i < 3; i++) /* less than the single precision of surface files is 0 */
    write_number(fabs(x[i]) < 1e-15 + 1e-7 * largest ? 0 : x[i] / scale, number[i]);
  snprintf(out.text, sizeof out.text, "(%.14s, %.14s, %.14s)%s%.3s", number[0], number[1],
           number[2], unit[0] ? " " : "", unit);
  return out;
}

lbw_text lbw_point(const double at[3]) {
  return lbw_triple(at, 1e-3, "mm");
}

lbw_text lbw_direction(const double direction[3]) {
  return lbw_triple(direction, 1, "");
}

/* quantity(value, unit): the text */
static int core_quantity(lua_State *L) {
  lua_pushstring(L, lbw_quantity(lbw_check_number(L, 1), lbw_check_text(L, 2, NULL)).text);
  return 1;
}

/* shown_unit(value, unit): the unit in which print shows a value, and how large it is */
static int core_shown_unit(lua_State *L) {
  double scale;
  lua_pushstring(L, lbw_shown_unit(lbw_check_number(L, 1), lbw_check_text(L, 2, NULL), &scale));
  lua_pushnumber(L, scale);
  return 2;
}

/* point(at): "(1.5, 0, 30) mm" */
static int core_point(lua_State *L) {
  double at[3];
  lbw_check_vector(L, 1, "point", at);
  lua_pushstring(L, lbw_point(at).text);
  return 1;
}

void lbw_open_quantity(lua_State *L) {
  static const luaL_Reg functions[] = {{"quantity", core_quantity},
                                       {"shown_unit", core_shown_unit},
                                       {"point", core_point},
                                       {NULL, NULL}};
  luaL_setfuncs(L, functions, 0);
}
