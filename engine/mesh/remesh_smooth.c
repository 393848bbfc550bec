/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* Flips and relaxation. */
#include <string.h>

#include "mesh/remesh.h"

/* ---- flip ---------------------------------------------------------------------------------- */

/* The smallest of the three angles, by its cosine: the larger the cosine, the smaller the angle. */
static double sharpest(const double a[3], const double b[3], const double c[3]) {
  const double *x[3] = {a, b, c};
  double worst = -1;
  for (int k = 0; k < 3; k++) {
    double u[3], v[3];
    for (int i = 0; i < 3; i++) {
      u[i] = x[(k + 1) % 3][i] - x[k][i];
      v[i] = x[(k + 2) % 3][i] - x[k][i];
    }
    double size = bw_norm(u) * bw_norm(v), cosine = size > 0 ? bw_dot(u, v) / size : 1;
    worst = cosine > worst ? cosine : worst;
  }
  return worst;
}

static bool flip_helps(const bwi_remesher *r, int32_t side) {
  const bwi_changing *mesh = r->mesh;
  if (mesh->sharp[side])
    return false;
  int32_t other = mesh->opposite[side];
  int32_t ia = bwi_from(mesh, side), ib = bwi_to(mesh, side), ic = bwi_to(mesh, bwi_next(side)),
          id = bwi_to(mesh, bwi_next(other));
  const double *a = bwi_at(mesh, ia), *b = bwi_at(mesh, ib), *c = bwi_at(mesh, ic),
               *d = bwi_at(mesh, id);
  double before = fmax(sharpest(a, b, c), sharpest(b, a, d));
  double after = fmax(sharpest(d, c, a), sharpest(c, d, b));
  if (after >= before - 1e-6 || !bwi_may_flip(mesh, side))
    return false;
  double old[2][3], made[2][3];
  normal_of(a, b, c, old[0]);
  normal_of(b, a, d, old[1]);
  normal_of(d, c, a, made[0]);
  normal_of(c, d, b, made[1]);
  bool flat[2] = {quality(a, b, c) < 1e-6,
                  quality(b, a, d) < 1e-6}; /* direction not to be trusted */
  for (int i = 0; i < 2; i++)
    for (int k = 0; k < 2; k++)
      if (!flat[i] && turns_too_far(old[i], made[k]))
        return false;
  if ((flat[0] && flat[1]) || bw_dot(made[0], made[1]) <= 0)
    return false;
  /* On a plane nothing moves; elsewhere the new edge may not leave the surface. */
  double straight = bw_dot(old[0], old[1]) / (bw_norm(old[0]) * bw_norm(old[1]));
  if (!flat[0] && !flat[1] && straight > 1 - 1e-10)
    return true;
  double limit = bwi_remesh_slack(
      r, fmin(fmin(mesh->size[ia], mesh->size[ib]), fmin(mesh->size[ic], mesh->size[id])));
  return bwi_remesh_facet_near_surface(r, c, d, a, limit) &&
         bwi_remesh_facet_near_surface(r, c, d, b, limit);
}

bw_status bwi_remesh_flip_edges(bwi_remesher *r, int passes) {
  bwi_changing *mesh = r->mesh;
  for (int pass = 0; pass < passes; pass++) {
    int64_t flips = 0;
    bw_status status = bw_check_cancel(r->context);
    if (status != BW_OK)
      return status;
    for (int32_t s = 0; s < 3 * (int32_t)mesh->facet_count; s++) {
      if ((status = check_limits(r, (size_t)s)) != BW_OK)
        return status;
      if (mesh->corner[s] >= 0 && s < mesh->opposite[s] && flip_helps(r, s)) {
        bwi_flip(mesh, s);
        flips++;
      }
    }
    if (flips == 0)
      break;
  }
  return BW_OK;
}

/* ---- relax --------------------------------------------------------------------------------- */

/* Where a point would like to be: the mean of its facets' centroids weighted by area; on a crease,
 * of its two neighbours there. */
static bool opts(const bwi_changing *mesh, int32_t p, double out[3]) {
  int32_t start = mesh->side[p], s = start;
  double weight = 0, sum[3] = {0, 0, 0};
  if (mesh->fixed[p] == BWI_CORNER)
    return false;
  do {
    if (mesh->fixed[p] == BWI_CREASE) {
      if (mesh->sharp[s]) {
        double size = mesh->size[bwi_to(mesh, s)];
        for (int k = 0; k < 3; k++)
          sum[k] += bwi_at(mesh, bwi_to(mesh, s))[k] / size;
        weight += 1 / size;
      }
    } else {
      const double *a = bwi_at(mesh, p), *b = bwi_at(mesh, bwi_to(mesh, s)),
                   *c = bwi_at(mesh, bwi_to(mesh, bwi_next(s)));
      double n[3];
      normal_of(a, b, c, n);
      double size = (mesh->size[bwi_to(mesh, s)] + mesh->size[bwi_to(mesh, bwi_next(s))]);
      double area = bw_norm(n) / (size * size);
      for (int k = 0; k < 3; k++)
        sum[k] += area * (a[k] + b[k] + c[k]) / 3;
      weight += area;
    }
    s = bwi_around(mesh, s);
  } while (s != start);
  if (!(weight > 0))
    return false;
  for (int k = 0; k < 3; k++)
    out[k] = sum[k] / weight;
  return true;
}

static bool move_is_fine(const bwi_remesher *r, int32_t p, const double to[3]) {
  const bwi_changing *mesh = r->mesh;
  const double *from = bwi_at(mesh, p);
  double worst_before = 1, worst_after = 1, limit = bwi_remesh_slack(r, mesh->size[p]);
  int32_t start = mesh->side[p], s = start;
  do {
    const double *b = bwi_at(mesh, bwi_to(mesh, s)), *c = bwi_at(mesh, bwi_to(mesh, bwi_next(s)));
    double before[3], after[3], quality_before = quality(from, b, c);
    normal_of(from, b, c, before);
    normal_of(to, b, c, after);
    if (quality_before > 1e-6 && turns_too_far(before, after))
      return false;
    worst_before = fmin(worst_before, quality_before);
    worst_after = fmin(worst_after, quality(to, b, c));
    s = bwi_around(mesh, s);
  } while (s != start);
  if (worst_after < 0.5 && worst_after < worst_before)
    return false;
  do {
    if (!bwi_remesh_facet_near_surface(r, to, bwi_at(mesh, bwi_to(mesh, s)),
                                       bwi_at(mesh, bwi_to(mesh, bwi_next(s))), limit))
      return false;
    if (mesh->sharp[s] && !bwi_remesh_near_crease(r, to, bwi_at(mesh, bwi_to(mesh, s)), limit))
      return false;
    s = bwi_around(mesh, s);
  } while (s != start);
  return true;
}

bw_status bwi_remesh_relax(bwi_remesher *r) {
  bwi_changing *mesh = r->mesh;
  for (int32_t p = 0; p < (int32_t)mesh->point_count; p++) {
    double to[3], place[3];
    int32_t facet;
    if (p % 4096 == 0) {
      bw_status status = bw_check_cancel(r->context);
      if (status != BW_OK)
        return status;
    }
    if (mesh->side[p] < 0 || !opts(mesh, p, to))
      continue;
    const bwi_tree *tree = mesh->fixed[p] == BWI_CREASE ? r->creases : r->tree;
    bwi_tree_nearest(tree, to, -1, 0, place, &facet);
    if (facet >= 0 && distance(bwi_at(mesh, p), place) > 1e-3 * mesh->size[p] &&
        move_is_fine(r, p, place))
      memcpy(bwi_at(mesh, p), place, sizeof place);
  }
  return BW_OK;
}
