/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* Colours of sRGB as the linear light that glTF and USD prescribe (IEC 61966-2-1). */
#include "io/surface_write.h"

#include <math.h>

double bwi_linear_light(unsigned char byte) {
  double c = byte / 255.0;
  return c <= 0.04045 ? c / 12.92 : pow((c + 0.055) / 1.055, 2.4);
}
