/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* Eight points at once: a vector of eight doubles, whatever registers the processor has. Every
 * operation on a lane is IEEE's own and no lane looks at another, so a point's numbers have the
 * same bits alone, in any company, and on any processor.
 *
 * Vectors go through pointers and macros, never by value: how those are passed depends on the
 * processor compiled for. */
#ifndef BWI_NONLINEAR_LANES_H
#define BWI_NONLINEAR_LANES_H

#include <math.h>
#include <stdbool.h>
#include <stdint.h>
#include <string.h>

enum { BWI_LANES = 8 };
typedef double bwi_lanes __attribute__((vector_size(64)));
typedef int64_t bwi_mask __attribute__((vector_size(64)));

#define BWI_SELECT(mask, yes, no)                                                                  \
  ((bwi_lanes)(((mask) & (bwi_mask)(yes)) | (~(mask) & (bwi_mask)(no))))
#define BWI_MAX(a, b) BWI_SELECT((a) > (b), a, b)
/* The same number in all lanes. */
#define BWI_ALL(number) ((number) - (bwi_lanes){0})

static inline bool bwi_any(const bwi_mask *mask) {
  int64_t any = 0;
  for (int i = 0; i < BWI_LANES; i++)
    any |= (*mask)[i];
  return any != 0;
}

static inline void bwi_sqrt(const bwi_lanes *x, bwi_lanes *root) {
  double number[BWI_LANES];
  memcpy(number, x, sizeof number);
  for (int i = 0; i < BWI_LANES; i++)
    number[i] = sqrt(number[i]);
  memcpy(root, number, sizeof number);
}

/* Jacobi's rotation that makes the entry pq of a symmetric matrix vanish in the lanes of `apart`,
 * none in the others: the tangent, cosine and sine of its angle. `difference` is qq - pp. */
static inline void bwi_jacobi(const bwi_lanes *difference, const bwi_lanes *pq,
                              const bwi_mask *apart, bwi_lanes *t, bwi_lanes *c, bwi_lanes *s) {
  bwi_lanes square = *difference * *difference + 4 * *pq * *pq, root;
  bwi_sqrt(&square, &root);
  *t = 2 * *pq / BWI_SELECT(*difference >= 0, *difference + root, *difference - root);
  *t = BWI_SELECT(*apart, *t, BWI_ALL(0.0));
  square = 1 + *t * *t;
  bwi_sqrt(&square, &root);
  *c = 1 / root;
  *s = *t * *c;
}

#endif
