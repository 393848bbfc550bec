/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* The colour map: pale blue, green, amber, red, dark red.
 *
 * A smooth curve through eight colours chosen in the OKLab space with lightness falling from 0.86
 * to 0.40, then sampled at equal steps of its length there: equal steps of the value look equally
 * different, also in grey. Low values are light, so that the shape shows; the peak is the darkest
 * and most saturated place on the body. */
#include <math.h>

#include "barwright/picture.h"

enum { STEPS = 32 };
static const unsigned char map[STEPS + 1][3] = {
    {174, 214, 249}, {159, 218, 242}, {147, 220, 231}, {138, 222, 217}, {134, 222, 201},
    {137, 221, 183}, {145, 219, 165}, {156, 217, 145}, {170, 213, 126}, {184, 208, 106},
    {198, 202, 87},  {209, 194, 69},  {217, 185, 56},  {222, 175, 46},  {226, 165, 38},
    {228, 155, 29},  {230, 145, 18},  {231, 135, 7},   {231, 124, 1},   {230, 113, 1},
    {228, 103, 5},   {225, 92, 8},    {222, 80, 12},   {217, 69, 17},   {211, 58, 22},
    {204, 48, 28},   {195, 40, 33},   {185, 34, 36},   {175, 29, 38},   {165, 25, 39},
    {154, 22, 40},   {144, 18, 40},   {134, 15, 39}};

void bw_colour(double t, unsigned char rgb[3]) {
  if (isnan(t)) { /* no value */
    rgb[0] = rgb[1] = rgb[2] = 168;
    return;
  }
  double at = (t <= 0 ? 0 : t >= 1 ? 1 : t) * STEPS;
  int i = at < STEPS ? (int)at : STEPS - 1;
  double f = at - i;
  for (int k = 0; k < 3; k++)
    rgb[k] = (unsigned char)(map[i][k] + f * (map[i + 1][k] - map[i][k]) + 0.5);
}

void bw_category_colour(int64_t index, unsigned char rgb[3]) {
  enum { COLOURS = 12 };
  static const unsigned char colour[COLOURS][3] = {
      {126, 159, 196}, {226, 148, 74}, {104, 176, 128}, {196, 94, 98},
      {150, 122, 190}, {222, 196, 94}, {92, 178, 186},  {206, 130, 176},
      {148, 148, 148}, {164, 118, 84}, {178, 204, 108}, {84, 104, 152}};
  for (int k = 0; k < 3; k++)
    rgb[k] = colour[(index % COLOURS + COLOURS) % COLOURS][k];
}
