/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* Thermal constants: conductivity, by a table where it depends on the temperature, and heat
 * capacity. */
#include "material/internal.h"

#include <math.h>

static bw_status refuse(bw_context *context, const char *name, const char *what, double value,
                        const char *unit) {
  return bw_fail(context, BW_INVALID,
                 "material %s: the %s is %g %s; give a positive number, or 0 when it is not known",
                 name, what, value, unit);
}

bw_status bw_material_with_thermal(bw_context *context, const bw_material *material,
                                   const bw_thermal *constants, bw_material **result) {
  const bw_thermal *c = constants;
  const char *name = material->name;
  for (int i = 0; i < 3; i++)
    if (!isfinite(c->conductivity[i]) || c->conductivity[i] < 0 ||
        (c->conductivity[i] > 0) != (c->conductivity[0] > 0))
      return refuse(context, name, "conductivity", c->conductivity[i], "W/(m K)");
  if (!isfinite(c->heat_capacity) || c->heat_capacity < 0)
    return refuse(context, name, "heat capacity", c->heat_capacity, "J/(kg K)");
  if (c->rows < 0 || c->rows > BW_THERMAL_ROWS)
    return bw_fail(context, BW_INVALID,
                   "material %s: a table of conductivity has up to %d rows, not %d", name,
                   BW_THERMAL_ROWS, c->rows);
  for (int i = 0; i < c->rows; i++) {
    if (!isfinite(c->factor[i]) || !(c->factor[i] > 0))
      return bw_fail(context, BW_INVALID,
                     "material %s: row %d of the table of conductivity is %g of the conductivity; "
                     "it must be above 0",
                     name, i + 1, c->factor[i]);
    if (!isfinite(c->temperature[i]) || (i && !(c->temperature[i] > c->temperature[i - 1])))
      return bw_fail(context, BW_INVALID,
                     "material %s: row %d of the table of conductivity is at %g K; temperatures "
                     "must ascend",
                     name, i + 1, c->temperature[i]);
  }
  if (material->parts)
    return bw_fail(context, BW_INVALID,
                   "material %s differs by element: give thermal constants to its parts before",
                   name);
  bw_material *made = bwi_material_copy(context, material);
  if (!made)
    return BW_MEMORY;
  made->thermal = *c;
  for (int i = 0; i < 3; i++)
    made->conductivity_value[i] = (bw_value){c->conductivity[i], 0, NULL};
  made->heat_capacity_value = (bw_value){c->heat_capacity, 0, NULL};
  *result = made;
  return BW_OK;
}

double bw_thermal_factor(const bw_thermal *thermal, double temperature) {
  const double *t = thermal->temperature, *f = thermal->factor;
  int i = 1, rows = thermal->rows;
  if (rows == 0)
    return 1;
  if (temperature <= t[0] || rows == 1)
    return f[0];
  while (i < rows && t[i] < temperature)
    i++;
  if (i == rows)
    return f[rows - 1];
  return f[i - 1] + (f[i] - f[i - 1]) * (temperature - t[i - 1]) / (t[i] - t[i - 1]);
}
