/* Sobol's generating numbers, between the points and the search that chose them. */
/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
#ifndef BWI_STUDY_SOBOL_H
#define BWI_STUDY_SOBOL_H

#include <stdint.h>

enum { BWI_SOBOL_BITS = 32, BWI_SOBOL_DEGREE = 13 };

/* The primitive polynomials over the field of two elements in order: degree, then value, whose bits
 * are the coefficients. Begin with {0, 0}; false past degree BWI_SOBOL_DEGREE. */
typedef struct bwi_polynomial {
  int degree;
  uint32_t bits;
} bwi_polynomial;
_Bool bwi_next_primitive(bwi_polynomial *polynomial);

/* The columns of a dimension's generating matrix: bit 31 of a column is the first binary digit.
 * `candidate` selects the initial numbers. */
void bwi_sobol_columns(int dimension, const bwi_polynomial *polynomial, uint32_t candidate,
                       uint32_t column[BWI_SOBOL_BITS]);

/* The t of the first 2^m points in two dimensions: every box of 2^(t-m), cut dyadically, holds 2^t
 * of them. 0 is best, m is worst. */
int bwi_sobol_t(const uint32_t *a, const uint32_t *b, int m);

#endif
