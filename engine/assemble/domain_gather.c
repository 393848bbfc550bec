/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* Coefficients and entries of a domain's pairs from the frames of its elements.
 *
 * A pair has one to some dozens of elements, and a loop whose length cannot be foretold costs as
 * much for its end as for an element: inside a domain, pairs are therefore summed by their number
 * of elements, two being that of most, and a block of tensors is kept until all of them are there.
 */
#include "assemble/domain.h"

#ifdef __FMA__
#include <immintrin.h>
#endif

enum { BLOCK = 128, COUNTS = 8 };

/* t += a * x, rounded once where the processor can. */
static inline void add(double a, const bwi_vector *x, bwi_vector *t) {
#ifdef __FMA__
  *t = (bwi_vector)_mm256_fmadd_pd(_mm256_set1_pd(a), (__m256d)*x, (__m256d)*t);
#else
  *t += a * *x;
#endif
}

/* T of a pair of two nodes from `count` elements. */
__attribute__((always_inline)) static inline void sum_elements(const bwi_pair_source *source,
                                                               const int32_t *element,
                                                               const uint8_t *local, int count,
                                                               bwi_vector t[3]) {
  const bwi_vector *vector = source->frames->vector;
  const int vectors = source->frames->vectors;
  bwi_vector t0 = {0}, t1 = {0}, t2 = {0};
  for (int k = 0; k < count; k++) {
    const bwi_vector *h = vector + (int64_t)element[k] * vectors;
    const bwi_product *p = &source->table[local[k]];
    const double *u = (const double *)(h + p->u), *w = (const double *)(h + p->w);
    bwi_vector v = p->first * h[p->v], z = p->second * h[p->z];
    add(u[0], &v, &t0);
    add(u[1], &v, &t1);
    add(u[2], &v, &t2);
    add(w[0], &z, &t0);
    add(w[1], &z, &t1);
    add(w[2], &z, &t2);
  }
  t[0] = t0;
  t[1] = t1;
  t[2] = t2;
}

/* T of pairs all of whose elements are in one domain. */
static void sum_inside(const bwi_pair_source *source, const uint32_t *place, int size,
                       bwi_vector t[BLOCK][3]) {
  const bw_graph *graph = source->graph;
  uint8_t order[COUNTS][BLOCK];
  int count[COUNTS] = {0};
  for (int k = 0; k < size; k++) {
    const int64_t *start = graph->gather_start + (place[k] >> 1);
    int64_t elements = start[1] - start[0];
    int of = place[k] & 1 || elements >= COUNTS ? 0 : (int)elements;
    order[of][count[of]++] = (uint8_t)k;
  }
  for (int n = 0; n < COUNTS; n++)
    for (int m = 0; m < count[n]; m++) {
      int k = order[n][m];
      int64_t first = graph->gather_start[place[k] >> 1];
      const int32_t *element = graph->gather_element + first;
      const uint8_t *local = graph->gather_local + first;
      if (n == 2)
        sum_elements(source, element, local, 2, t[k]);
      else if (n == 1)
        sum_elements(source, element, local, 1, t[k]);
      else if (n)
        sum_elements(source, element, local, n, t[k]);
      else
        bwi_sum_pair(source, NULL, place[k] >> 1, place[k] & 1, (double(*)[4])t[k]);
    }
}

/* T of the first pairs of `place`, at most BLOCK, whose elements are all in the domain or not. */
static int sum_block(const bwi_domain_work *work, const bwi_domain_piece *piece, int32_t domain,
                     int64_t begin, bwi_vector t[BLOCK][3]) {
  const bwi_domain_coefficients *c = work->stiffness->coefficients;
  const uint32_t *place = c->place + piece->first + begin;
  int size = piece->size - begin < BLOCK ? (int)(piece->size - begin) : BLOCK;
  if (piece->section < c->inside_count)
    sum_inside(&work->source, place, size, t);
  else {
    bwi_element_range range = {c->domain_of, domain};
    for (int k = 0; k < size; k++)
      bwi_sum_pair(&work->source, &range, place[k] >> 1, place[k] & 1, (double(*)[4])t[k]);
  }
  return size;
}

void bwi_domain_gather_tensors(const bwi_domain_work *work, const bwi_domain_piece *piece,
                               int32_t domain, double *to) {
  const uint32_t *place = work->stiffness->coefficients->place + piece->first;
  int numbers = piece->numbers;
  bwi_vector t[BLOCK][3];
  for (int64_t begin = 0; begin < piece->size; begin += BLOCK) {
    int size = sum_block(work, piece, domain, begin, t);
    for (int64_t k = begin; k < begin + size; k++) {
      double *tensor = to + numbers * (k & ~(int64_t)3) + (k & 3);
      bwi_domain_halves((double(*)[4])t[k - begin], numbers, tensor);
      if (place[k] & 1) /* symmetric but for rounding */
        for (int m = 6; m < numbers; m++)
          tensor[4 * m] = 0;
    }
  }
}

/* (lambda + mu) T + mu tr(T) 1: what an isotropic material makes of a symmetric T. */
static inline void apply_symmetric(double lambda, double mu, const bwi_vector t[3], double *out) {
  double trace = mu * (t[0][0] + t[1][1] + t[2][2]);
  bwi_vector first = (lambda + mu) * t[0] + (bwi_vector){trace, 0, 0, 0},
             second = (lambda + mu) * t[1] + (bwi_vector){0, trace, 0, 0},
             third = (lambda + mu) * t[2] + (bwi_vector){0, 0, trace, 0};
  *(bwi_vector *)out = first; /* its last number, and that of the next, are written over */
  *(bwi_vector *)(out + 3) = second;
  for (int k = 0; k < 3; k++)
    out[6 + k] = third[k];
}

void bwi_domain_gather_entries(const bwi_domain_work *work, const bwi_domain_piece *piece,
                               double *out) {
  const bwi_domain_coefficients *c = work->stiffness->coefficients;
  const bw_material *material = work->stiffness->material;
  const uint32_t *place = c->place + piece->first;
  int32_t domain = c->block_domain[c->block_start[piece->section]];
  bwi_vector map[9][3] = {{{0}}}, t[BLOCK][3];
  if (!material->isotropic) {
    double elasticity[81];
    bwi_domain_elasticity(work->stiffness, domain, c->written[domain].frame, elasticity);
    for (int jl = 0; jl < 9; jl++)
      for (int i = 0; i < 3; i++)
        for (int k = 0; k < 3; k++)
          map[jl][i][k] = elasticity[9 * (3 * i + k) + jl];
  }
  for (int64_t begin = 0; begin < piece->size; begin += BLOCK) {
    int size = sum_block(work, piece, domain, begin, t);
    for (int k = 0; k < size; k++) {
      uint32_t at = place[begin + k];
      double *block = out + 9 * (int64_t)(at >> 1);
      if (material->isotropic && piece->numbers == 6)
        apply_symmetric(material->lame_lambda, material->lame_mu, t[k], block);
      else if (material->isotropic)
        bwi_apply_isotropic(material->lame_lambda, material->lame_mu, (double(*)[4])t[k], block);
      else
        bwi_apply_general(map, (double(*)[4])t[k], block);
      if (at & 1)
        bwi_make_symmetric(block);
    }
  }
}
