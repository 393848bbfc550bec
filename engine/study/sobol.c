/* Sobol's points. See study.h and docs/theory/studies.md.
 *
 * Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later.
 *
 * Point i of a dimension is the sum over the field of two elements of the columns at the one-bits
 * of i. From i to i + 1 the lowest bits change up to the lowest zero: one sum of leading columns
 * takes the point along. */
#include <string.h>

#include "barwright/study.h"
#include "study/sobol.h"
#include "study/sobol_table.h"

_Static_assert(sizeof sobol_candidate / sizeof *sobol_candidate == BW_SOBOL_DIMENSIONS,
               "a candidate for each dimension");

enum { DIGITS = 52 };

typedef struct generator {
  uint64_t column[BWI_SOBOL_BITS];
  uint64_t leading[BWI_SOBOL_BITS]; /* sums of columns 0..k */
  uint64_t now;
} generator;

/* Digits mixed by a random lower triangular matrix with a unit diagonal, and shifted: what holds of
 * dyadic boxes goes on to hold, and each point is uniformly distributed. */
static void scramble(generator *g, uint64_t seed, int dimension) {
  bw_random random;
  uint64_t mixed[BWI_SOBOL_BITS] = {0};
  bw_random_seed(&random, seed ^ 0x9e3779b97f4a7c15u * ((uint64_t)dimension + 1));
  for (int r = 0; r < DIGITS; r++) {
    uint64_t row = bw_random_bits(&random) >> (64 - DIGITS),
             digit = (uint64_t)1 << (DIGITS - 1 - r);
    row = (row & ~(2 * digit - 1) & (((uint64_t)1 << DIGITS) - 1)) | digit;
    for (int k = 0; k < BWI_SOBOL_BITS; k++)
      if (__builtin_parityll(row & g->column[k]))
        mixed[k] |= digit;
  }
  memcpy(g->column, mixed, sizeof mixed);
  g->now = bw_random_bits(&random) >> (64 - DIGITS);
}

static void set_up(generator *g, int dimension, const bwi_polynomial *polynomial,
                   const bw_sobol_options *options) {
  uint32_t column[BWI_SOBOL_BITS];
  bwi_sobol_columns(dimension, polynomial, sobol_candidate[dimension], column);
  for (int k = 0; k < BWI_SOBOL_BITS; k++)
    g->column[k] = (uint64_t)column[k] << (DIGITS - BWI_SOBOL_BITS);
  g->now = 0;
  if (options->scrambled)
    scramble(g, options->seed, dimension);
  uint64_t sum = 0;
  for (int k = 0; k < BWI_SOBOL_BITS; k++) {
    g->leading[k] = sum ^= g->column[k];
    if (options->skip >> k & 1)
      g->now ^= g->column[k];
  }
}

bw_status bw_sobol(bw_context *context, int64_t count, int dimensions,
                   const bw_sobol_options *options, double *point) {
  static const bw_sobol_options defaults;
  enum { BETWEEN_QUESTIONS = 1 << 12 };
  options = options ? options : &defaults;
  if (dimensions < 1 || dimensions > BW_SOBOL_DIMENSIONS)
    return bw_fail(context, BW_INVALID, "Sobol points in %d dimensions: 1 to %d expected",
                   dimensions, BW_SOBOL_DIMENSIONS);
  int64_t max = (int64_t)1 << BWI_SOBOL_BITS;
  if (count < 0 || options->skip < 0 || count > max || options->skip > max - count)
    return bw_fail(context, BW_INVALID, "Sobol points %lld to %lld: there are 2^%d, counted from 0",
                   (long long)options->skip, (long long)(options->skip + count - 1),
                   BWI_SOBOL_BITS);
  bw_status status = BW_OK;
  bwi_polynomial polynomial = {0, 0};
  generator *g = BW_NEW(context, generator, dimensions);
  if (!g)
    return BW_MEMORY;
  for (int j = 0; j < dimensions; j++) {
    if (j > 0 && !bwi_next_primitive(&polynomial))
      BW_TRY(bw_fail(context, BW_INTERNAL, "no polynomial for dimension %d", j));
    set_up(&g[j], j, &polynomial, options);
  }
  for (int64_t i = 0; i < count; i++) {
    if (i % BETWEEN_QUESTIONS == 0)
      BW_TRY(bw_check_cancel(context));
    /* The last of all points has no zero below bit 32; nothing follows it. */
    int lowest_zero = __builtin_ctzll(~(uint64_t)(options->skip + i));
    for (int j = 0; j < dimensions; j++) {
      point[i * dimensions + j] = (double)g[j].now * 0x1p-52;
      g[j].now ^= g[j].leading[lowest_zero < BWI_SOBOL_BITS ? lowest_zero : 0];
    }
  }
done:
  bw_free(g);
  return status;
}
