/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* The leaves of the branch and bound: what a certificate lists.
 *
 * Multipliers of one vector are whole numbers of at most 15 binary digits times a common power of
 * two. They are short to write, and the same in decimal text, doubles and rational numbers. */
#include "analysis/worst_internal.h"

#include <math.h>
#include <string.h>

enum { DIGITS = 15 };

/* The power of two that the numbers are multiples of. */
static int exponent_of(int32_t count, const double *y) {
  double largest = 0;
  int exponent = 0;
  for (int32_t k = 0; k < count; k++)
    largest = fmax(largest, fabs(y[k]));
  if (largest > 0)
    frexp(largest, &exponent);
  return exponent - DIGITS;
}

void bwi_round_multipliers(int32_t count, double *y) {
  const double max = ldexp(1, DIGITS) - 1;
  int exponent = exponent_of(count, y);
  for (int32_t k = 0; k < count; k++) {
    double whole = nearbyint(ldexp(y[k], -exponent));
    y[k] = ldexp(fmax(-max, fmin(max, whole)), exponent); /* the same exponent again */
  }
}

static int32_t *write_vector(int32_t count, const double *y, int32_t *to) {
  int exponent = exponent_of(count, y);
  *to++ = exponent;
  for (int32_t k = 0; k < count; k++)
    *to++ = (int32_t)ldexp(y[k], -exponent);
  return to;
}

static bw_status reserve(bw_context *context, bw_bound_leaves *leaves, size_t count,
                         size_t numbers) {
  bool fits = bw_grow(context, (void **)&leaves->leaf, &leaves->leaf_capacity, leaves->count, count,
                      sizeof *leaves->leaf) &&
              bw_grow(context, (void **)&leaves->number, &leaves->number_capacity,
                      leaves->number_count, numbers, sizeof *leaves->number);
  return fits ? BW_OK : BW_MEMORY;
}

bw_status bwi_keep_leaf(bw_context *context, bw_bound_leaves *leaves, int64_t cell, double bound,
                        int32_t motions, const double *y) {
  bw_status status = BW_OK;
  int vectors = cell == 0 ? 6 : 2;
  size_t m = (size_t)motions;
  BW_TRY(reserve(context, leaves, 1, (size_t)vectors * (m + 3)));
  int32_t *to = leaves->number + leaves->number_count;
  leaves->leaf[leaves->count++] =
      (bw_bound_leaf){.cell = cell, .bound = bound, .start = (int64_t)leaves->number_count};
  for (int v = 0; v < vectors; v++) {
    /* For all directions the multiplier of the total follows the six vectors. */
    to = write_vector(motions, y, to);
    y += m;
    if (cell != 0 || v == 5)
      to = write_vector(1, y++, to);
  }
  leaves->number_count = (size_t)(to - leaves->number);
done:
  return status;
}

bw_status bwi_append_leaves(bw_context *context, bw_bound_leaves *leaves, int32_t element,
                            const bw_bound_leaves *more) {
  bw_status status = BW_OK;
  BW_TRY(reserve(context, leaves, more->count, more->number_count));
  for (size_t i = 0; i < more->count; i++) {
    bw_bound_leaf *leaf = &leaves->leaf[leaves->count++];
    *leaf = more->leaf[i];
    leaf->element = element;
    leaf->start += (int64_t)leaves->number_count;
  }
  if (more->number_count > 0)
    memcpy(leaves->number + leaves->number_count, more->number,
           more->number_count * sizeof *more->number);
  leaves->number_count += more->number_count;
done:
  return status;
}

void bw_bound_leaves_clear(bw_bound_leaves *leaves) {
  bw_free(leaves->leaf);
  bw_free(leaves->number);
  *leaves = (bw_bound_leaves){0};
}
