/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* Bonds of surfaces whose meshes do not match, by dual mortar functions (docs/theory/joints.md):
 * each node of side a gets its displacement from nodes of side b. Integrals are over the exact
 * overlaps of facets, so that constant stress passes. */
#include <math.h>
#include <string.h>

#include "base/box_tree.h"
#include "base/dense.h"
#include "model/internal.h"

enum { LEAF = 8, CORNERS_OF_OVERLAP = 9 };

/* Of quadratic facets, the part of each adjacent mid-edge function that a corner gets. */
static const double share = 0.2;
/* A gap is closed without being asked for up to this part of the mean edge. */
static const double closed_gap = 0.05;
/* A node's integral below this part of its facets' own is none: they are hardly covered. */
static const double least_cover = 1e-4;
/* Of a facet's area: less than the integral of each of its functions. */
static const double least_integral = 0.1;
/* Coefficients below this are rounding. */
static const double rounding = 1e-14;

/* A facet of side a: its plane, and what its overlaps contribute. */
typedef struct side_facet {
  double origin[3], along[3], across[3], normal[3], corner[3][2], area;
  double product[36]; /* of its functions with each other, over what is covered */
  double whole[6];    /* integrals of its functions over what is covered */
  double covered;
  size_t count, capacity; /* of masters */
  struct master {
    int32_t node;
    double value[6];
  } * master;
} side_facet;

typedef struct entries {
  size_t count, row_capacity, column_capacity, value_capacity;
  int32_t *row, *column;
  double *value;
} entries;

typedef struct bonding {
  bw_context *context;
  const bw_mesh *mesh;
  const bw_selection *a, *b;
  double gap, largest;
  bwi_box_tree tree;
  side_facet facet;
  int points;
  double point[BW_QUADRATURE_POINTS][3], weight[BW_QUADRATURE_POINTS];
} bonding;

static const int32_t *nodes_of(const bw_mesh *mesh, int32_t facet) {
  return mesh->facet + (int64_t)facet * mesh->nodes_per_facet;
}

static const double *corner_of(const bw_mesh *mesh, int32_t facet, int k) {
  return mesh->node + 3 * (int64_t)nodes_of(mesh, facet)[k];
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

static double cross2(const double a[2], const double b[2], const double c[2]) {
  return (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]);
}

static void barycentric_of(const double corner[3][2], const double p[2], double at[3]) {
  double whole = cross2(corner[0], corner[1], corner[2]);
  at[0] = cross2(p, corner[1], corner[2]) / whole;
  at[1] = cross2(p, corner[2], corner[0]) / whole;
  at[2] = 1 - at[0] - at[1];
}

static void open_facet(const bonding *d, int32_t facet, side_facet *s) {
  const double *p = corner_of(d->mesh, facet, 0), *q = corner_of(d->mesh, facet, 1),
               *r = corner_of(d->mesh, facet, 2);
  struct master *kept = s->master;
  size_t capacity = s->capacity;
  double u[3], v[3];
  *s = (side_facet){.master = kept, .capacity = capacity};
  for (int k = 0; k < 3; k++) {
    s->origin[k] = p[k];
    u[k] = q[k] - p[k];
    v[k] = r[k] - p[k];
  }
  bw_cross(u, v, s->normal);
  double twice = bw_norm(s->normal), edge = bw_norm(u);
  s->area = twice / 2;
  for (int k = 0; k < 3 && twice > 0; k++) {
    s->normal[k] /= twice;
    s->along[k] = u[k] / edge;
  }
  bw_cross(s->normal, s->along, s->across);
  s->corner[1][0] = edge;
  s->corner[2][0] = bw_dot(v, s->along);
  s->corner[2][1] = bw_dot(v, s->across);
}

/* What polygon `in` has on the left of the line from `from` to `to`. */
static int cut(int count, const double (*in)[2], const double from[2], const double to[2],
               double (*out)[2]) {
  int kept = 0;
  for (int i = 0; i < count; i++) {
    const double *p = in[i], *q = in[(i + 1) % count];
    double a = cross2(from, to, p), b = cross2(from, to, q);
    if (a >= 0) {
      out[kept][0] = p[0];
      out[kept++][1] = p[1];
    }
    if ((a < 0) != (b < 0)) {
      double t = a / (a - b);
      out[kept][0] = p[0] + t * (q[0] - p[0]);
      out[kept++][1] = p[1] + t * (q[1] - p[1]);
    }
  }
  return kept;
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

/* Adds the overlap of a facet of side b: where both look along the normal of side a. */
static bw_status add_overlap(bonding *d, int32_t facet) {
  bw_status status = BW_OK;
  const bw_mesh *mesh = d->mesh;
  side_facet *s = &d->facet, other = {0};
  double corner[3][2], height[3], polygon[CORNERS_OF_OVERLAP][2], next[CORNERS_OF_OVERLAP][2];
  open_facet(d, facet, &other);
  if (!(other.area > 0) || bw_dot(other.normal, s->normal) > BWI_FACING)
    return BW_OK;
  for (int k = 0; k < 3; k++) {
    double y[3];
    for (int i = 0; i < 3; i++)
      y[i] = corner_of(mesh, facet, k)[i] - s->origin[i];
    corner[k][0] = bw_dot(y, s->along);
    corner[k][1] = bw_dot(y, s->across);
    height[k] = bw_dot(y, s->normal);
    memcpy(polygon[2 - k], corner[k], sizeof corner[k]); /* seen from behind */
  }
  int count = 3;
  for (int e = 0; e < 3 && count > 0; e++) {
    count = cut(count, (const double(*)[2])polygon, s->corner[e], s->corner[(e + 1) % 3], next);
    memcpy(polygon, next, sizeof next);
  }
  for (int t = 1; t + 1 < count; t++) {
    double area = cross2(polygon[0], polygon[t], polygon[t + 1]) / 2;
    if (!(area > rounding * s->area))
      continue;
    for (int q = 0; q < d->points; q++) {
      const double *l = d->point[q];
      double p[2], own_at[3], other_at[3], own[6], its[6], distance = 0;
      double w = d->weight[q] * area;
      for (int k = 0; k < 2; k++)
        p[k] = l[0] * polygon[0][k] + l[1] * polygon[t][k] + l[2] * polygon[t + 1][k];
      barycentric_of((const double(*)[2])s->corner, p, own_at);
      barycentric_of((const double(*)[2])corner, p, other_at);
      for (int k = 0; k < 3; k++)
        distance += other_at[k] * height[k];
      if (fabs(distance) > d->gap)
        continue;
      d->largest = fmax(d->largest, fabs(distance));
      functions(mesh, own_at, true, own);
      functions(mesh, other_at, false, its);
      s->covered += w;
      int n = mesh->nodes_per_facet;
      for (int i = 0; i < n; i++) {
        s->whole[i] += w * own[i];
        for (int j = 0; j < n; j++)
          s->product[n * i + j] += w * own[i] * own[j];
      }
      for (int m = 0; m < n; m++) {
        struct master *to;
        BW_TRY(find_master(d, nodes_of(mesh, facet)[m], &to));
        for (int i = 0; i < n; i++)
          to->value[i] += w * own[i] * its[m];
      }
    }
  }
done:
  return status;
}

/* ---- facets of side b near one of side a ------------------------------------------------------
 */

static void box_of(const void *data, int32_t facet, double *min, double *max) {
  bwi_boundary_box(((const bonding *)data)->mesh, facet, min, max);
}

static double distance_to(void *data, int32_t facet, const double *p) {
  double weight[3];
  return bwi_boundary_nearest(((const bonding *)data)->mesh, facet, p, weight);
}

static bool apart(const double *box, const double *min, const double *max, double gap) {
  for (int k = 0; k < 3; k++)
    if (box[k] > max[k] + gap || box[3 + k] < min[k] - gap)
      return true;
  return false;
}

static bw_status add_below(bonding *d, int64_t at, const double *min, const double *max) {
  bw_status status = BW_OK;
  const bwi_box_tree *tree = &d->tree;
  if (apart(tree->box + 6 * at, min, max, d->gap))
    return BW_OK;
  if (at < tree->leaves - 1) {
    BW_TRY(add_below(d, 2 * at + 1, min, max));
    BW_TRY(add_below(d, 2 * at + 2, min, max));
    return BW_OK;
  }
  int64_t first = (at - (tree->leaves - 1)) * LEAF;
  for (int64_t i = first; i < first + LEAF && i < tree->count; i++) {
    double box[6];
    box_of(d, tree->item[i], box, box + 3);
    if (!apart(box, min, max, d->gap))
      BW_TRY(add_overlap(d, tree->item[i]));
  }
done:
  return status;
}

static bw_status plant(bonding *d) {
  int32_t count = d->b->facet_count, *item = BW_NEW(d->context, int32_t, count);
  if (!item)
    return BW_MEMORY;
  memcpy(item, d->b->facet, (size_t)count * sizeof *item);
  return bwi_box_tree_create(d->context, 3, LEAF, count, item, box_of, d, &d->tree);
}

/* ---- coefficients -----------------------------------------------------------------------------
 */

static bw_status add_entry(bw_context *context, entries *e, int32_t row, int32_t column,
                           double value) {
  if (fabs(value) == 0)
    return BW_OK;
  if (!bw_grow(context, (void **)&e->row, &e->row_capacity, e->count, 1, sizeof *e->row) ||
      !bw_grow(context, (void **)&e->column, &e->column_capacity, e->count, 1, sizeof *e->column) ||
      !bw_grow(context, (void **)&e->value, &e->value_capacity, e->count, 1, sizeof *e->value))
    return BW_MEMORY;
  e->row[e->count] = row;
  e->column[e->count] = column;
  e->value[e->count++] = value;
  return BW_OK;
}

static void clear_entries(entries *e) {
  bw_free(e->row);
  bw_free(e->column);
  bw_free(e->value);
}

/* The dual functions of a facet are D M^-1 N: their products with side b go to `sums`. `place`:
 * rows of nodes. *covered: its area, 0 where too little of it is covered. */
static bw_status close_facet(bonding *d, int32_t facet, const int32_t *place, double *whole,
                             double *own, entries *sums, double *covered) {
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
    own[row] += least_integral * s->area;
    for (size_t m = 0; m < s->count; m++)
      BW_TRY(
          add_entry(d->context, sums, row, s->master[m].node, s->whole[i] * s->master[m].value[i]));
  }
done:
  return status;
}

/* Rows of the nodes themselves from those of the functions: a mid-edge node's displacement is made
 * of three. `ends`: rows of its corners, or -1. */
static bw_status node_rows(bonding *d, const bw_sparse_matrix *sums, const double *whole,
                           const int32_t *ends, entries *rows) {
  bw_status status = BW_OK;
  for (int32_t i = 0; i < sums->rows; i++) {
    const int32_t *end = ends + 2 * (int64_t)i, from[3] = {i, end[0], end[1]};
    bool middle = end[0] >= 0;
    for (int k = 0; k < (middle ? 3 : 1); k++) {
      double factor = !middle ? 1 : k == 0 ? 1 - 2 * share : share;
      for (int64_t e = sums->start[from[k]]; e < sums->start[from[k] + 1]; e++)
        BW_TRY(add_entry(d->context, rows, i, sums->column[e],
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

/* How far the nodes of side a are from side b. */
static bw_status fail_apart(bonding *d) {
  double nearest = INFINITY, square;
  for (int32_t i = 0; i < d->a->node_count; i++)
    if (bwi_box_tree_nearest(&d->tree, d->mesh->node + 3 * (int64_t)d->a->node[i], distance_to, d,
                             &square) >= 0)
      nearest = fmin(nearest, sqrt(square));
  bw_fail(
      d->context, BW_GEOMETRY,
      "the sides of the bond do not touch: they are %.4g m apart at the nearest node of side a, "
      "and the bond closes gaps up to %.4g m between facets that face each other; give a larger "
      "gap, or other selections",
      nearest, d->gap);
  bw_detail_number(d->context, "distance", nearest);
  bw_detail_number(d->context, "gap", d->gap);
  return BW_GEOMETRY;
}

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
  entries sums = {0}, rows = {0};
  bw_sparse_matrix *sum = NULL;
  int32_t *place = BW_NEW(d->context, int32_t, mesh->node_count);
  int32_t *ends = BW_NEW(d->context, int32_t, 2 * (int64_t)count);
  double *whole = BW_NEW0(d->context, double, count), *own = BW_NEW0(d->context, double, count);
  bond->node = BW_NEW(d->context, int32_t, count);
  BW_TRY_MEMORY(place && ends && whole && own && bond->node);
  for (int32_t i = 0; i < count; i++) {
    place[d->a->node[i]] = i;
    ends[2 * i] = ends[2 * i + 1] = -1;
  }
  for (int32_t f = 0; f < d->a->facet_count; f++) {
    int32_t facet = d->a->facet[f];
    double box[6], covered;
    if (f % 256 == 0)
      BW_TRY(bw_check_cancel(d->context));
    open_facet(d, facet, &d->facet);
    box_of(d, facet, box, box + 3);
    BW_TRY(add_below(d, 0, box, box + 3));
    BW_TRY(close_facet(d, facet, place, whole, own, &sums, &covered));
    bond->area += covered;
    if (covered == 0)
      continue;
    const int32_t *node = nodes_of(mesh, facet);
    for (int e = 0; e < 3 && mesh->order == 2; e++) {
      int32_t middle = place[node[3 + e]];
      ends[2 * middle] = place[node[e]];
      ends[2 * middle + 1] = place[node[(e + 1) % 3]];
    }
  }
  if (bond->area == 0)
    BW_TRY(fail_apart(d));
  for (int32_t i = 0; i < count; i++)
    if (own[i] > 0 && !(whole[i] > least_cover * own[i]))
      BW_TRY(fail_cover(d, d->a->node[i]));
  BW_TRY(bw_sparse_matrix_create(d->context, count, mesh->node_count, (int64_t)sums.count, sums.row,
                                 sums.column, sums.value, &sum));
  BW_TRY(node_rows(d, sum, whole, ends, &rows));
  for (int32_t i = 0; i < count; i++) { /* rows of nodes that nothing covers are left out */
    place[i] = kept;
    if (own[i] > 0)
      bond->node[kept++] = d->a->node[i];
  }
  for (size_t e = 0; e < rows.count; e++)
    rows.row[e] = place[rows.row[e]];
  bond->node_count = kept;
  BW_TRY(bw_sparse_matrix_create(d->context, kept, mesh->node_count, (int64_t)rows.count, rows.row,
                                 rows.column, rows.value, &bond->follows));
  drop_rounding(bond->follows);
done:
  bw_release(sum);
  clear_entries(&sums);
  clear_entries(&rows);
  bw_free(place);
  bw_free(ends);
  bw_free(whole);
  bw_free(own);
  return status;
}

static double mean_edge(const bw_selection *on) {
  return sqrt(2 * bw_selection_area(on) / on->facet_count);
}

bw_status bwi_bond_make(bw_context *context, const bw_selection *a, const bw_selection *b,
                        double gap, bw_bond *bond) {
  bw_status status = BW_OK;
  bonding d = {.context = context, .mesh = a->mesh, .a = a, .b = b, .gap = gap};
  *bond = (bw_bond){.a = a, .b = b, .asked_gap = gap};
  if (d.gap < 0)
    d.gap = closed_gap * fmin(mean_edge(a), mean_edge(b));
  d.points = bw_triangle_quadrature(2 * d.mesh->order, d.point, d.weight);
  BW_TRY(bwi_check_sides(context, a, b, "the bond: a bond joins"));
  BW_TRY(plant(&d));
  BW_TRY(find_coefficients(&d, bond));
  bond->gap = d.largest;
  bond->a = bw_retain(a);
  bond->b = bw_retain(b);
done:
  bwi_box_tree_clear(&d.tree);
  bw_free(d.facet.master);
  if (status != BW_OK) {
    bw_free(bond->node);
    bw_release(bond->follows);
  }
  return status;
}

void bwi_bond_clear(bw_bond *bond) {
  bw_release(bond->a);
  bw_release(bond->b);
  bw_release(bond->follows);
  bw_free(bond->node);
}
