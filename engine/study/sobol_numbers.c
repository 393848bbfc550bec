/* The numbers that generate Sobol's points. See sobol.h and docs/theory/studies.md.
 *
 * Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
#include "study/sobol.h"

#include <stdbool.h>

/* ---- primitive polynomials ------------------------------------------------------------------- */

/* The product of two residues. */
static uint32_t multiply(uint32_t a, uint32_t b, const bwi_polynomial *p) {
  uint32_t product = 0;
  for (; b; b >>= 1) {
    if (b & 1)
      product ^= a;
    a <<= 1;
    if (a >> p->degree & 1)
      a ^= p->bits;
  }
  return product;
}

static uint32_t power_of_x(uint32_t exponent, const bwi_polynomial *p) {
  uint32_t result = 1, square = p->degree == 1 ? 2 ^ p->bits : 2;
  for (; exponent; exponent >>= 1) {
    if (exponent & 1)
      result = multiply(result, square, p);
    square = multiply(square, square, p);
  }
  return result;
}

/* x generates all 2^d - 1 residues but 0. */
static bool is_primitive(const bwi_polynomial *p) {
  uint32_t order = (1u << p->degree) - 1, rest = order;
  if (!(p->bits & 1) || power_of_x(order, p) != 1)
    return false;
  for (uint32_t factor = 2; factor <= rest; factor++)
    if (rest % factor == 0) {
      if (order / factor < order && power_of_x(order / factor, p) == 1 && order > 1)
        return false;
      while (rest % factor == 0)
        rest /= factor;
    }
  return true;
}

bool bwi_next_primitive(bwi_polynomial *p) {
  do {
    p->bits++;
    if (p->bits >> (p->degree + 1)) {
      p->degree++;
      p->bits = 1u << p->degree;
    }
    if (p->degree < 1) {
      p->degree = 1;
      p->bits = 2;
    }
    if (p->degree > BWI_SOBOL_DEGREE)
      return false;
  } while (!is_primitive(p));
  return true;
}

/* ---- columns --------------------------------------------------------------------------------- */

/* Odd, below 2^k: the k-th initial number of a dimension's candidate. */
static uint32_t initial(int dimension, uint32_t candidate, int k) {
  uint64_t z = ((uint64_t)candidate << 32 | (uint32_t)dimension) * 32 + (uint64_t)k;
  z += 0x9e3779b97f4a7c15u;
  z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9u;
  z = (z ^ (z >> 27)) * 0x94d049bb133111ebu;
  z ^= z >> 31;
  return ((uint32_t)(z >> 32) & ((1u << k) - 1)) | 1;
}

void bwi_sobol_columns(int dimension, const bwi_polynomial *p, uint32_t candidate,
                       uint32_t column[BWI_SOBOL_BITS]) {
  if (dimension == 0) { /* van der Corput's points */
    for (int k = 0; k < BWI_SOBOL_BITS; k++)
      column[k] = 1u << (31 - k);
    return;
  }
  int d = p->degree;
  for (int k = 0; k < BWI_SOBOL_BITS; k++)
    if (k < d)
      column[k] = initial(dimension, candidate, k + 1) << (31 - k);
    else {
      /* The recurrence of the polynomial, in fractions: a factor 2^i is in the place already. */
      column[k] = column[k - d] ^ (column[k - d] >> d);
      for (int i = 1; i < d; i++)
        if (p->bits >> (d - i) & 1)
          column[k] ^= column[k - i];
    }
}

/* ---- quality --------------------------------------------------------------------------------- */

/* Row r of the leading m x m part: digit r of the first m columns. */
static uint32_t row_of(const uint32_t *column, int r, int m) {
  uint32_t row = 0;
  for (int k = 0; k < m; k++)
    row |= (column[k] >> (31 - r) & 1) << k;
  return row;
}

/* Adds a row to a basis in which pivot[i] has leading bit i; false when it depends on it. */
static bool add_row(uint32_t *pivot, uint32_t row) {
  while (row) {
    int lead = 31 - __builtin_clz(row);
    if (!pivot[lead]) {
      pivot[lead] = row;
      return true;
    }
    row ^= pivot[lead];
  }
  return false;
}

int bwi_sobol_t(const uint32_t *a, const uint32_t *b, int m) {
  uint32_t row_a[BWI_SOBOL_BITS], row_b[BWI_SOBOL_BITS], first[BWI_SOBOL_BITS] = {0};
  int min = m;
  for (int r = 0; r < m; r++) {
    row_a[r] = row_of(a, r, m);
    row_b[r] = row_of(b, r, m);
  }
  /* With i rows of the one, so many of the other are independent. */
  for (int i = 0; i <= m; i++) {
    uint32_t pivot[BWI_SOBOL_BITS];
    int j = 0;
    for (int k = 0; k < m; k++)
      pivot[k] = first[k];
    while (i + j < m && add_row(pivot, row_b[j]))
      j++;
    if (i + j < min)
      min = i + j;
    if (i < m && !add_row(first, row_a[i]))
      return m - (i < min ? i : min);
  }
  return m - min;
}
