/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* Bonds of surfaces whose meshes do not match, by dual mortar functions (docs/theory/joints.md):
 * each node of side a gets its displacement from nodes of side b. Integrals are over the exact
 * overlaps of facets, so that constant stress passes. */
#include <math.h>
#include <string.h>

#include "base/dense.h"
#include "matrix/sparse.h"
#include "model/internal.h"

/* Of quadratic facets, the part of each adjacent mid-edge function that a corner gets. */
static const double share = 0.2;
/* A node's integral below this part of its facets' own is none: they are hardly covered. */
static const double least_cover = 1e-4;
/* A facet is covered where more than this part of it is. */
static const double most_cover = 0.5;
/* Of a facet's area: less than the integral of each of its functions. */
static const double least_integral = 0.1;
/* Coefficients below this are rounding. */
static const double rounding = 1e-14;

/* What the overlaps of a facet of side a contribute. */
typedef struct side_facet {
  double product[36]; /* of its functions with each other, over what is covered */
  double whole[6];    /* integrals of its functions over what is covered */
  double covered;
  size_t count, capacity; /* of masters */
  struct master {
    int32_t node;
    double value[6];
  } * master;
} side_facet;

typedef struct bonding {
  bw_context *context;
  const bw_mesh *mesh;
  const bw_selection *a;
  bwi_overlaps overlaps;
  side_facet facet;
  double *cover; /* the part of each facet of the mesh that is covered */
} bonding;

static const int32_t *nodes_of(const bw_mesh *mesh, int32_t facet) {
  return mesh->facet + (int64_t)facet * mesh->nodes_per_facet;
}

/* Shape functions of a facet; on side a (`own`) those of corners made positive in the mean, which
 * span the same polynomials. */
static void functions(const bw_mesh *mesh, const double at[3], bool own, double value[6]) {
  bw_facet_shape(mesh->order, at, value);
  if (!own || mesh->order == 1)
    return;
  for (int e = 0; e < 3; e++) {
    value[e] += share * value[3 + e];
    value[(e + 1) % 3] += share * value[3 + e];
  }
  for (int e = 0; e < 3; e++)
    value[3 + e] *= 1 - 2 * share;
}

static bw_status find_master(bonding *d, int32_t node, struct master **found) {
  side_facet *s = &d->facet;
  for (size_t i = 0; i < s->count; i++)
    if (s->master[i].node == node) {
      *found = &s->master[i];
      return BW_OK;
    }
  if (!bw_grow(d->context, (void **)&s->master, &s->capacity, s->count, 1, sizeof *s->master))
    return BW_MEMORY;
  *found = &s->master[s->count++];
  **found = (struct master){.node = node};
  return BW_OK;
}

static bw_status add_point(void *data, const bwi_overlap_point *point) {
  bw_status status = BW_OK;
  bonding *d = data;
  side_facet *s = &d->facet;
  const int n = d->mesh->nodes_per_facet;
  const double w = point->weight;
  double own[6], its[6];
  functions(d->mesh, point->at, true, own);
  functions(d->mesh, point->other_at, false, its);
  s->covered += w;
  for (int i = 0; i < n; i++) {
    s->whole[i] += w * own[i];
    for (int j = 0; j < n; j++)
      s->product[n * i + j] += w * own[i] * own[j];
  }
  d->cover[point->facet] += w / point->other_area;
  for (int m = 0; m < n; m++) {
    struct master *to;
    BW_TRY(find_master(d, nodes_of(d->mesh, point->facet)[m], &to));
    for (int i = 0; i < n; i++)
      to->value[i] += w * own[i] * its[m];
  }
done:
  return status;
}

/* ---- coefficients -----------------------------------------------------------------------------
 */

/* The dual functions of a facet are D M^-1 N: their products with side b go to `sums`. `place`:
 * rows of nodes. *covered: its area, 0 where too little of it is covered. */
static bw_status close_facet(bonding *d, int32_t facet, const int32_t *place, double *whole,
                             double *normal, double *own, bwi_entries *sums, double *covered) {
  bw_status status = BW_OK;
  side_facet *s = &d->facet;
  int n = d->mesh->nodes_per_facet;
  *covered = 0;
  if (s->count == 0 || !bwi_cholesky(n, s->product, 1e-10))
    return BW_OK;
  *covered = s->covered;
  for (size_t m = 0; m < s->count; m++) {
    bwi_lower_solve(n, s->product, s->master[m].value);
    bwi_upper_solve(n, s->product, s->master[m].value);
  }
  for (int i = 0; i < n; i++) {
    int32_t row = place[nodes_of(d->mesh, facet)[i]];
    whole[row] += s->whole[i];
    for (int c = 0; c < 3; c++)
      normal[3 * (int64_t)row + c] += s->whole[i] * d->overlaps.normal[c];
    own[row] += least_integral * d->overlaps.area;
    for (size_t m = 0; m < s->count; m++)
      BW_TRY(bwi_entries_add(d->context, sums, row, s->master[m].node,
                             s->whole[i] * s->master[m].value[i]));
  }
done:
  return status;
}

/* Rows of the nodes themselves from those of the functions: a mid-edge node's displacement is made
 * of three. `ends`: rows of its corners, or -1. */
static bw_status node_rows(bonding *d, const bw_sparse_matrix *sums, const double *whole,
                           const int32_t *ends, bwi_entries *rows) {
  bw_status status = BW_OK;
  for (int32_t i = 0; i < sums->rows; i++) {
    const int32_t *end = ends + 2 * (int64_t)i, from[3] = {i, end[0], end[1]};
    bool middle = end[0] >= 0;
    for (int k = 0; k < (middle ? 3 : 1); k++) {
      double factor = !middle ? 1 : k == 0 ? 1 - 2 * share : share;
      for (int64_t e = sums->start[from[k]]; e < sums->start[from[k] + 1]; e++)
        BW_TRY(bwi_entries_add(d->context, rows, i, sums->column[e],
                               factor * sums->value[e] / whole[from[k]]));
    }
  }
done:
  return status;
}

/* Without what is rounding. */
static void drop_rounding(bw_sparse_matrix *matrix) {
  int64_t kept = 0, begin = 0;
  for (int32_t i = 0; i < matrix->rows; i++) {
    int64_t end = matrix->start[i + 1];
    for (int64_t e = begin; e < end; e++)
      if (fabs(matrix->value[e]) > rounding) {
        matrix->column[kept] = matrix->column[e];
        matrix->value[kept++] = matrix->value[e];
      }
    begin = end;
    matrix->start[i + 1] = kept;
  }
}

/* ---- messages ---------------------------------------------------------------------------------
 */

static bw_status fail_cover(const bonding *d, int32_t node) {
  const double *x = d->mesh->node + 3 * (int64_t)node;
  bw_fail(
      d->context, BW_GEOMETRY,
      "the facets of side a around node %d at (%g, %g, %g) m are hardly covered by side b: make "
      "a the side that the other one covers, or select on a only what touches b",
      node + 1, x[0], x[1], x[2]);
  bw_detail_number(d->context, "node", node + 1.0);
  return BW_GEOMETRY;
}

/* ---- together ---------------------------------------------------------------------------------
 */

/* The rows of `made` are the nodes in `node`. */
static bw_status find_coefficients(bonding *d, bw_bond *bond) {
  bw_status status = BW_OK;
  const bw_mesh *mesh = d->mesh;
  int32_t count = d->a->node_count, kept = 0;
  bwi_entries sums = {0}, rows = {0};
  bw_sparse_matrix *sum = NULL;
  int32_t *place = BW_NEW(d->context, int32_t, mesh->node_count);
  int32_t *ends = BW_NEW(d->context, int32_t, 2 * (int64_t)count);
  double *whole = BW_NEW0(d->context, double, count), *own = BW_NEW0(d->context, double, count);
  double *normal = BW_NEW0(d->context, double, 3 * (int64_t)count);
  bond->node = BW_NEW(d->context, int32_t, count);
  bond->node_area = whole;
  bond->node_normal = normal;
  BW_TRY_MEMORY(place && ends && whole && own && normal && bond->node);
  for (int32_t i = 0; i < count; i++) {
    place[d->a->node[i]] = i;
    ends[2 * i] = ends[2 * i + 1] = -1;
  }
  for (int32_t f = 0; f < d->a->facet_count; f++) {
    int32_t facet = d->a->facet[f];
    double covered;
    if (f % 256 == 0)
      BW_TRY(bw_check_cancel(d->context));
    d->facet = (side_facet){.master = d->facet.master, .capacity = d->facet.capacity};
    BW_TRY(bwi_overlaps_of(&d->overlaps, facet, add_point, d));
    BW_TRY(close_facet(d, facet, place, whole, normal, own, &sums, &covered));
    bond->area += covered;
    if (covered == 0)
      continue;
    d->cover[facet] = covered / d->overlaps.area;
    const int32_t *node = nodes_of(mesh, facet);
    for (int e = 0; e < 3 && mesh->order == 2; e++) {
      int32_t middle = place[node[3 + e]];
      ends[2 * middle] = place[node[e]];
      ends[2 * middle + 1] = place[node[(e + 1) % 3]];
    }
  }
  if (bond->area == 0)
    BW_TRY(bwi_overlaps_fail_apart(&d->overlaps, "bond"));
  for (int32_t i = 0; i < count; i++)
    if (own[i] > 0 && !(whole[i] > least_cover * own[i]))
      BW_TRY(fail_cover(d, d->a->node[i]));
  BW_TRY(bwi_entries_matrix(d->context, &sums, count, mesh->node_count, &sum));
  BW_TRY(node_rows(d, sum, whole, ends, &rows));
  for (int32_t i = 0; i < count; i++) { /* rows of nodes that nothing covers are left out */
    place[i] = kept;
    if (!(own[i] > 0))
      continue;
    whole[kept] = whole[i];
    memcpy(normal + 3 * (int64_t)kept, normal + 3 * (int64_t)i, 3 * sizeof *normal);
    bond->node[kept++] = d->a->node[i];
  }
  for (size_t e = 0; e < rows.count; e++)
    rows.row[e] = place[rows.row[e]];
  bond->node_count = kept;
  BW_TRY(bwi_entries_matrix(d->context, &rows, kept, mesh->node_count, &bond->follows));
  drop_rounding(bond->follows);
done:
  bw_release(sum);
  bwi_entries_clear(&sums);
  bwi_entries_clear(&rows);
  bw_free(place);
  bw_free(ends);
  bw_free(own);
  return status;
}

/* The facets of both sides that are covered. */
static bw_status find_covered(const bonding *d, bw_bond *bond) {
  bw_status status = BW_OK;
  const bw_selection *side[2] = {bond->a, bond->b};
  bw_selection *covered = NULL;
  bool any = false;
  uint8_t *mask = BW_NEW0(d->context, uint8_t, d->mesh->facet_count);
  BW_TRY_MEMORY(mask);
  for (int s = 0; s < 2; s++)
    for (int32_t f = 0; f < side[s]->facet_count; f++) {
      int32_t facet = side[s]->facet[f];
      mask[facet] = d->cover[facet] > most_cover;
      any |= mask[facet];
    }
  if (any)
    BW_TRY(bw_select_mask(d->context, d->mesh, mask, NULL, &covered));
  bond->covered = covered;
done:
  bw_free(mask);
  return status;
}

bw_status bwi_bond_make(bw_context *context, const bw_selection *a, const bw_selection *b,
                        double gap, bw_bond *bond) {
  bw_status status = BW_OK;
  bonding d = {.context = context, .mesh = a->mesh, .a = a};
  *bond = (bw_bond){.a = a, .b = b, .asked_gap = gap};
  BW_TRY(bwi_overlaps_open(context, a, b, gap, "the bond: a bond joins", &d.overlaps));
  d.cover = BW_NEW0(context, double, d.mesh->facet_count);
  BW_TRY_MEMORY(d.cover);
  BW_TRY(find_coefficients(&d, bond));
  BW_TRY(find_covered(&d, bond));
  bond->gap = d.overlaps.largest;
  bond->a = bw_retain(a);
  bond->b = bw_retain(b);
done:
  bwi_overlaps_clear(&d.overlaps);
  bw_free(d.cover);
  bw_free(d.facet.master);
  if (status != BW_OK) {
    bw_free(bond->node);
    bw_free(bond->node_area);
    bw_free(bond->node_normal);
    bw_release(bond->follows);
  }
  return status;
}

void bwi_bond_clear(bw_bond *bond) {
  bw_release(bond->a);
  bw_release(bond->b);
  bw_release(bond->covered);
  bw_release(bond->follows);
  bw_free(bond->node);
  bw_free(bond->node_area);
  bw_free(bond->node_normal);
}
