/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* Exchanging the diagonals of nearly flat pairs of facets, where the worse one improves. */
#include "mesh/coarsen.h"

/* The other living triangle with the directed side b a, or -1; *opposite its third corner. */
static int32_t across(bwi_coarsening *c, int32_t a, int32_t b, int32_t *opposite) {
  int32_t ring[BWI_RING];
  int count;
  if (!bwi_coarsen_ring(c, b, ring, &count))
    return -1;
  for (int i = 0; i < count; i++) {
    int32_t t = ring[i] / 3, k = ring[i] % 3;
    const int32_t *corner = c->corner + 3 * (size_t)t;
    if (corner[(k + 1) % 3] == a) {
      *opposite = corner[(k + 2) % 3];
      return t;
    }
  }
  return -1;
}

static void unlink_corner(bwi_coarsening *c, int32_t point, int32_t corner) {
  int32_t *link = &c->first[point];
  while (*link >= 0 && *link != corner)
    link = &c->next[*link];
  if (*link >= 0)
    *link = c->next[corner];
}

/* Facets a b p and b a q become p q b and q p a. */
static bw_status exchange(bwi_coarsening *c, int32_t t, int side, bool *done) {
  int32_t *corner = c->corner + 3 * (size_t)t;
  int32_t a = corner[side], b = corner[(side + 1) % 3], p = corner[(side + 2) % 3], q,
          around[BWI_RING];
  int count, count_b;
  *done = false;
  int32_t u = across(c, a, b, &q);
  if (u < 0 || p == q || !bwi_coarsen_ring(c, a, around, &count) || count < 4 ||
      !bwi_coarsen_ring(c, b, around, &count_b) || count_b < 4 ||
      !bwi_coarsen_ring(c, p, around, &count) || count > BWI_RING - 2)
    return BW_OK;
  for (int i = 0; i < count; i++) { /* p and q must not be neighbours already */
    const int32_t *other = c->corner + around[i] / 3 * 3;
    if (other[0] == q || other[1] == q || other[2] == q)
      return BW_OK;
  }
  const double *xt[3] = {place(c, a), place(c, b), place(c, p)};
  const double *xu[3] = {place(c, b), place(c, a), place(c, q)};
  double nt[3], nu[3];
  normal_of(xt, nt);
  normal_of(xu, nu);
  double before = fmin(shape_of(xt, nt), shape_of(xu, nu));
  bwi_coarsen_change now = {.kept = -1, .gone = -1, .pair = {t, u}, .count = 2};
  memcpy(now.corner, (int32_t[2][3]){{p, q, b}, {q, p, a}}, 2 * sizeof now.corner[0]);
  double after = 1;
  for (int i = 0; i < 2; i++) {
    for (int k = 0; k < 3; k++)
      now.x[i][k] = place(c, now.corner[i][k]);
    normal_of(now.x[i], now.normal[i]);
    after = fmin(after, shape_of(now.x[i], now.normal[i]));
  }
  if (!(after > 1.1 * before + 0.02))
    return BW_OK;
  /* Flat enough: every new normal close to the old ones; a needle's own normal says nothing, so
   * the sum of both stands for it. */
  double sum[3] = {nt[0] + nu[0], nt[1] + nu[1], nt[2] + nu[2]};
  double size = bw_norm(sum), limit = before < 0.05 ? 0.985 : 0.94;
  double ab[3], pq[3], across_both[3], between[3];
  for (int k = 0; k < 3; k++) {
    ab[k] = xt[1][k] - xt[0][k];
    pq[k] = xu[2][k] - xt[2][k];
    between[k] = xt[2][k] - xt[0][k];
  }
  bw_cross(ab, pq, across_both); /* how far the diagonals pass each other */
  double apart = fabs(bw_dot(between, across_both)), width = bw_norm(across_both);
  if (c->tree && apart > allowed_at(c, xt[0]) * width)
    return BW_OK;
  if (apart < error_at(c, xt[0]) * width)
    limit = 0.7;
  for (int i = 0; i < 2; i++)
    if (!(bw_dot(now.normal[i], sum) > limit * bw_norm(now.normal[i]) * size))
      return BW_OK;
  if (bw_norm(nt) + bw_norm(nu) > (limit > 0.7 ? 1.1 : 1.4) * size || !bwi_coarsen_is_free(c, &now))
    return BW_OK;
  *done = true;
  int32_t two[2] = {t, u};
  for (int i = 0; i < 2; i++)
    for (int k = 0; k < 3; k++)
      unlink_corner(c, c->corner[3 * (size_t)two[i] + (size_t)k], 3 * two[i] + k);
  for (int i = 0; i < 2; i++)
    for (int k = 0; k < 3; k++) {
      int32_t at = 3 * two[i] + k, point = now.corner[i][k];
      c->corner[at] = point;
      c->next[at] = c->first[point];
      c->first[point] = at;
    }
  return bwi_coarsen_enter(c, t) && bwi_coarsen_enter(c, u) ? BW_OK : BW_MEMORY;
}

bw_status bwi_coarsen_exchange(bwi_coarsening *c) {
  bw_status status = BW_OK;
  for (int32_t t = 0; t < c->triangles; t++) {
    bool done = false;
    BW_TRY(bwi_coarsen_check(c, (size_t)t));
    if (c->corner[3 * (size_t)t] < 0)
      continue;
    int longest = 0; /* the diagonal whose exchange does most good */
    double length = 0;
    for (int k = 0; k < 3; k++) {
      const int32_t *corner = c->corner + 3 * (size_t)t;
      double here = distance_of(place(c, corner[k]), place(c, corner[(k + 1) % 3]));
      if (here > length) {
        length = here;
        longest = k;
      }
    }
    for (int k = 0; k < 3 && !done; k++)
      BW_TRY(exchange(c, t, (longest + k) % 3, &done));
  }
done:
  return status;
}
