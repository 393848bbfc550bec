/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* Constants that symmetries of the block take into each other, as one unknown. */
#include "base/dense.h"
#include "metamaterial/axes.h"
#include "metamaterial/keys.h"
#include "metamaterial/nnls.h"

#define FIBRE_SIZE 0.5 /* of the mean mu: what counts as a fibre's own size */

void bwi_ridge(const bwi_base *base, double ridge, int count, double *gram, double *side) {
  for (int j = 0; j < count; j++) {
    double own = j < 8 ? base->mu[j] : j < 16 ? base->lambda[j - 8] : 0;
    double size = own > 0 ? own : j >= 8 && j < 16 ? base->mean_lambda : base->mean_mu;
    size *= j < 16 ? 1 : FIBRE_SIZE;
    double stiffness = size > 0 ? ridge * ridge / (size * size) : 0;
    gram[(size_t)j * count + j] += stiffness;
    side[j] += stiffness * own;
  }
}

/* The direction of octant k that is v or -v; -1: none. */
static int find_direction(const bwi_candidates *c, int octant, const double v[3]) {
  for (int f = 0; f < c->count; f++)
    if (fabs(bw_dot(v, c->direction[octant][f])) > BWI_SAME_DIRECTION)
      return f;
  return -1;
}

/* Where a symmetry takes a constant. */
static int image(const bwi_candidates *c, int s, int constant) {
  bwi_symmetry symmetry = bwi_symmetry_of(s);
  int octant = bwi_symmetry_octant(symmetry, constant % 8), f = constant / 8 - 2;
  double v[3];
  if (f < 0)
    return constant - constant % 8 + octant;
  bwi_symmetry_vector(symmetry, c->direction[constant % 8][f], v);
  f = find_direction(c, octant, v);
  return f < 0 ? -1 : 8 * (2 + f) + octant;
}

void bwi_tie(uint64_t symmetries, bwi_candidates *c) {
  bwi_ties *ties = &c->ties;
  ties->constants = BWI_OCTANTS * (2 + c->count);
  ties->variables = 0;
  for (int j = 0; j < ties->constants; j++)
    ties->variable[j] = -1;
  for (int j = 0; j < ties->constants; j++) {
    int f = j / 8 - 2, v = ties->variables, low = j % 8;
    if (ties->variable[j] >= 0 || (f >= 0 && !(bw_norm(c->direction[j % 8][f]) > 0)))
      continue;
    bool closed = true;
    for (int s = 0; s < BWI_SYMMETRIES && closed; s++)
      closed = !(symmetries >> s & 1) || image(c, s, j) >= 0;
    if (!closed)
      continue;
    ties->size[v] = 0;
    for (int s = 0; s < BWI_SYMMETRIES; s++)
      if (symmetries >> s & 1) {
        int to = image(c, s, j);
        ties->variable[to] = v;
        low = to % 8 < low ? to % 8 : low;
      }
    for (int other = 0; other < c->count; other++)
      ties->size[v] += ties->variable[8 * (2 + other) + j % 8] == v;
    ties->group[v] = f < 0 ? -1 : low;
    ties->variables++;
  }
}

void bwi_tied_min(const bwi_ties *ties, const bwi_base *base, const double *gram,
                  const double *side, int limit, bwi_axes_work *work) {
  double min[2 * BWI_OCTANTS];
  memcpy(min, base->min_mu, sizeof base->min_mu);
  memcpy(min + BWI_OCTANTS, base->min_lambda, sizeof base->min_lambda);
  int n = ties->constants, m = ties->variables;
  memset(work->tied, 0, (size_t)m * m * sizeof *work->tied);
  memset(work->tied_side, 0, (size_t)m * sizeof *work->tied_side);
  for (int i = 0; i < n; i++) {
    int row = ties->variable[i];
    if (row < 0)
      continue;
    work->tied_side[row] += side[i] - bwi_dot(2 * BWI_OCTANTS, gram + (size_t)i * n, min);
    for (int j = 0; j < n; j++)
      if (ties->variable[j] >= 0)
        work->tied[(size_t)row * m + ties->variable[j]] += gram[(size_t)i * n + j];
  }
  bwi_nnls(m, work->tied, work->tied_side, ties->group, ties->size, limit, work->value, work->nnls);
  for (int i = 0; i < n; i++)
    work->x[i] = (i < 2 * BWI_OCTANTS ? min[i] : 0) +
                 (ties->variable[i] < 0 ? 0 : work->value[ties->variable[i]]);
}
