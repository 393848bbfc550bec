/* Chooses the initial numbers of Sobol's points: prints engine/study/sobol_table.h, and on standard
 * error how good the pairs of dimensions are. About a minute.
 *   build/tests/bench_sobol > engine/study/sobol_table.h
 *
 * Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later.
 *
 * Dimension after dimension, the candidate is taken whose pairs with dimensions before it have the
 * least sum of 4^t over numbers of points 2^2, 2^4, ... 2^16: what makes projections on planes
 * even. Up to dimension 256 all pairs count; from there on those with the first 24 and with the 40
 * just before. */
#include <stdio.h>
#include <string.h>

#include "study/sobol.h"

enum { DIMENSIONS = 1111, ALL_PAIRS = 256, FIRST = 24, BEFORE = 40 };

static uint32_t column[DIMENSIONS][BWI_SOBOL_BITS];
static uint32_t chosen[DIMENSIONS];

static double cost_of(int dimension, const uint32_t *candidate, double best) {
  double cost = 0;
  for (int i = 0; i < dimension && cost < best; i++) {
    if (dimension > ALL_PAIRS && i >= FIRST && i < dimension - BEFORE)
      continue;
    for (int m = 2; m <= 16; m += 2)
      cost += (double)(1u << 2 * bwi_sobol_t(column[i], candidate, m));
  }
  return cost;
}

static void report(int dimensions, int m, int window) {
  double sum = 0;
  int worst = 0, count = 0;
  for (int j = 1; j < dimensions; j++)
    for (int i = 0; i < j; i++) {
      if (j - i > window)
        continue;
      int t = bwi_sobol_t(column[i], column[j], m);
      sum += t;
      count++;
      worst = t > worst ? t : worst;
    }
  fprintf(stderr,
          "%4d dimensions, 2^%d points, pairs at most %d apart: t %.2f on average, %d at worst\n",
          dimensions, m, window, sum / count, worst);
}

static void report_all(const char *what) {
  fprintf(stderr, "%s\n", what);
  for (int m = 8; m <= 16; m += 4) {
    report(10, m, DIMENSIONS);
    report(50, m, DIMENSIONS);
    report(200, m, DIMENSIONS);
    report(DIMENSIONS, m, 20);
  }
}

int main(void) {
  for (int pass = 0; pass < 2; pass++) {
    bwi_polynomial polynomial = {0, 0};
    bwi_sobol_columns(0, &polynomial, 0, column[0]);
    for (int j = 1; j < DIMENSIONS; j++) {
      if (!bwi_next_primitive(&polynomial))
        return 1;
      int tries = pass == 0 ? 1 : j <= 64 ? 600 : j <= ALL_PAIRS ? 150 : 60;
      double best = 1e300;
      for (int c = 0; c < tries; c++) {
        uint32_t candidate[BWI_SOBOL_BITS];
        bwi_sobol_columns(j, &polynomial, (uint32_t)c, candidate);
        double cost = tries > 1 ? cost_of(j, candidate, best) : 0;
        if (cost < best) {
          best = cost;
          chosen[j] = (uint32_t)c;
          memcpy(column[j], candidate, sizeof candidate);
        }
      }
    }
    report_all(pass == 0 ? "first candidates:" : "chosen candidates:");
  }
  printf("/* Made by tests/bench/bench_sobol.c: which candidate each dimension takes. */\n"
         "/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */\n"
         "/* clang-format off */\n"
         "static const unsigned short sobol_candidate[%d] = {",
         DIMENSIONS);
  for (int j = 0; j < DIMENSIONS; j++)
    printf("%s%u,", j % 24 == 0 ? "\n  " : " ", (unsigned)chosen[j]);
  printf("\n};\n/* clang-format on */\n");
  return 0;
}
