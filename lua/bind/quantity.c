/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* Quantities as print shows them: four significant digits and a unit of drawings and tables. */
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
    {"m", "m", 1, 10},       {"m", "mm", 1e-3, 1e-6},   {"m", "um", 1e-6, 0},
    {"m2", "m2", 1, 1},      {"m2", "cm2", 1e-4, 1e-5}, {"m2", "mm2", 1e-6, 0},
    {"m3", "m3", 1, 0.1},    {"m3", "cm3", 1e-6, 1e-8}, {"m3", "mm3", 1e-9, 0},
    {"Pa", "GPa", 1e9, 1e9}, {"Pa", "MPa", 1e6, 1e3},   {"Pa", "Pa", 1, 0},
    {"J", "J", 1, 1},        {"J", "mJ", 1e-3, 0},      {"kg", "kg", 1, 1},
    {"kg", "g", 1e-3, 1e-3}, {"kg", "mg", 1e-6, 0},
};

lbw_text lbw_quantity(double value, const char *unit) {
  enum { COUNT = sizeof shown / sizeof *shown };
  const struct shown plain = {unit, unit, 1, 0}, *as = &plain;
  lbw_text out;
  char number[28];
  /* the unit of the number that is shown: 9.99999 m is 10 m */
  snprintf(number, sizeof number, "%.4g", value);
  double size = fabs(strtod(number, NULL));
  for (int i = 0; i < COUNT && as == &plain; i++)
    if (strcmp(shown[i].unit, unit) == 0 &&
        (size >= shown[i].from || (value == 0 && shown[i].scale < 1)))
      as = &shown[i];
  snprintf(number, sizeof number, "%.4g", value / as->scale);
  if (strstr(number, "e+") && fabs(value / as->scale) < 1e9) /* no exponent in 12340 */
    snprintf(number, sizeof number, "%.0f", strtod(number, NULL));
  snprintf(out.text, sizeof out.text, "%s%s%.16s", number, as->name[0] ? " " : "", as->name);
  return out;
}

/* quantity(value, unit): the text */
static int core_quantity(lua_State *L) {
  lua_pushstring(L, lbw_quantity(lbw_check_number(L, 1), lbw_check_text(L, 2, NULL)).text);
  return 1;
}

void lbw_open_quantity(lua_State *L) {
  lua_pushcfunction(L, core_quantity);
  lua_setfield(L, -2, "quantity");
}
