/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* Skinning weights: heat equilibrium on the surface (Baran and Popovic 2007), harmonic inside.
 *
 * On the surface every bone is a source of heat for the points that are nearest to it and see it:
 * with L the cotangent Laplacian, M the third of the areas of the facets around a point, H = heat /
 * d^2 with d the distance to the nearest bone seen, and p_b = 1 / (number of nearest bones) where b
 * is one of them, else 0,
 *
 *   (L + M H) w_b = M H p_b.
 *
 * L is positive semi-definite and H is positive everywhere, so that the matrix can be factored
 * whatever the surface; L 1 = 0 makes the w_b sum to one. Both sides have no unit: weights do not
 * depend on the scale. Inside, L w_b = 0 on straight tetrahedra with the surface's weights
 * given. */
#include <math.h>
#include <string.h>

#include "linear/matrix_factor.h"
#include "shape/weights.h"

static void skinning_clear(bwi_skinning *s) {
  bw_free(s->number);
  bw_free(s->node);
  bw_free(s->triangle);
  bw_free(s->at);
  bw_free(s->normal);
  bw_free(s->area);
  bw_free(s->edge);
  bw_free(s->source);
  bw_free(s->near);
  bw_free(s->is_near);
  bw_free(s->gap);
  bwi_tree_destroy(s->tree);
}

/* ---- the surface ----------------------------------------------------------------------------- */

/* Corners: those on the surface first, each in the order of the nodes. */
static bw_status number_corners(bwi_skinning *s) {
  const bw_mesh *mesh = s->mesh;
  s->number = BW_NEW(s->context, int32_t, mesh->node_count);
  s->node = BW_NEW(s->context, int32_t, mesh->node_count);
  s->triangle = BW_NEW(s->context, int32_t, 3 * (size_t)mesh->facet_count);
  if (!s->number || !s->node || !s->triangle)
    return BW_MEMORY;
  enum { MIDDLE = -1, INNER = -2, OUTER = -3 };
  for (int32_t i = 0; i < mesh->node_count; i++)
    s->number[i] = MIDDLE;
  for (int64_t e = 0; e < mesh->element_count; e++)
    for (int a = 0; a < 4; a++)
      s->number[mesh->element[e * mesh->nodes_per_element + a]] = INNER;
  for (int64_t f = 0; f < mesh->facet_count; f++)
    for (int a = 0; a < 3; a++)
      s->number[mesh->facet[f * mesh->nodes_per_facet + a]] = OUTER;
  int32_t next = 0;
  for (int kind = OUTER; kind <= INNER; kind++) {
    for (int32_t i = 0; i < mesh->node_count; i++)
      if (s->number[i] == kind) {
        s->node[next] = i;
        s->number[i] = next++;
      }
    if (kind == OUTER)
      s->points = next;
  }
  s->corners = next;
  for (int64_t f = 0; f < mesh->facet_count; f++)
    for (int a = 0; a < 3; a++)
      s->triangle[3 * f + a] = s->number[mesh->facet[f * mesh->nodes_per_facet + a]];
  return BW_OK;
}

static bw_status measure_surface(bwi_skinning *s) {
  size_t points = (size_t)s->points;
  s->at = BW_NEW(s->context, double, 3 * points);
  s->normal = BW_NEW0(s->context, double, 3 * points);
  s->area = BW_NEW0(s->context, double, points);
  s->edge = BW_NEW(s->context, double, points);
  if (!s->at || !s->normal || !s->area || !s->edge)
    return BW_MEMORY;
  for (size_t i = 0; i < points; i++) {
    memcpy(s->at + 3 * i, s->mesh->node + 3 * (size_t)s->node[i], 3 * sizeof *s->at);
    s->edge[i] = HUGE_VAL;
  }
  for (int64_t f = 0; f < s->mesh->facet_count; f++) {
    const int32_t *t = s->triangle + 3 * f;
    double e[2][3], n[3];
    for (size_t k = 0; k < 3; k++)
      for (size_t c = 0; c < 2; c++)
        e[c][k] = s->at[3 * (size_t)t[c + 1] + k] - s->at[3 * (size_t)t[0] + k];
    bw_cross(e[0], e[1], n);
    double area = 0.5 * bw_norm(n);
    for (int a = 0; a < 3; a++) {
      size_t i = (size_t)t[a], j = (size_t)t[(a + 1) % 3];
      double d[3];
      for (size_t k = 0; k < 3; k++) {
        s->normal[3 * i + k] += n[k];
        d[k] = s->at[3 * i + k] - s->at[3 * j + k];
      }
      s->area[i] += area / 3;
      double length = bw_norm(d);
      s->edge[i] = fmin(s->edge[i], length);
      s->edge[j] = fmin(s->edge[j], length);
    }
  }
  return bwi_tree_create(s->context, s->at, s->mesh->facet_count, s->triangle, NULL, &s->tree);
}

/* ---- equations ------------------------------------------------------------------------------- */

/* Cotangents of a facet's angles; false for one that is too flat to have any. */
static bool cotangents(const double *a, const double *b, const double *c, double cot[3]) {
  const double *x[3] = {a, b, c};
  double n[3], e[2][3], longest = 0;
  for (int i = 0; i < 3; i++) {
    for (int k = 0; k < 3; k++) {
      e[0][k] = x[(i + 1) % 3][k] - x[i][k];
      e[1][k] = x[(i + 2) % 3][k] - x[i][k];
    }
    bw_cross(e[0], e[1], n);
    double twice = bw_norm(n);
    longest = fmax(longest, bw_dot(e[0], e[0]));
    if (!(twice > 1e-12 * longest))
      return false;
    cot[i] = bw_dot(e[0], e[1]) / twice;
  }
  return true;
}

/* A symmetric matrix while its entries are listed; several at one place are added. */
typedef struct entries {
  int32_t *row, *column;
  double *value;
  int64_t count;
} entries;

static bool entries_open(bw_context *context, size_t capacity, entries *list) {
  *list = (entries){.row = BW_NEW(context, int32_t, capacity),
                    .column = BW_NEW(context, int32_t, capacity),
                    .value = BW_NEW(context, double, capacity)};
  return list->row && list->column && list->value;
}

static void entries_clear(entries *list) {
  bw_free(list->row);
  bw_free(list->column);
  bw_free(list->value);
}

static void add(entries *list, int32_t i, int32_t j, double value) {
  list->row[list->count] = i > j ? i : j;
  list->column[list->count] = i > j ? j : i;
  list->value[list->count++] = value;
}

static bw_status solve(bw_context *context, const entries *list, int32_t size, size_t count,
                       double *x) {
  bw_sparse_matrix *matrix = NULL;
  bw_status status = bw_sparse_matrix_create(context, size, size, list->count, list->row,
                                             list->column, list->value, &matrix);
  if (status == BW_OK)
    status = bwi_matrix_solve(context, matrix, "matrix of skinning weights",
                              "a coarser mesh takes less", (int64_t)count, x);
  bw_release(matrix);
  return status;
}

static bw_status solve_surface(bwi_skinning *s, double *weight) {
  bw_status status = BW_OK;
  size_t bones = (size_t)s->skeleton->bone_count, points = (size_t)s->points;
  entries list;
  double *x = BW_NEW(s->context, double, points *bones);
  BW_TRY_MEMORY(entries_open(s->context, 9 * (size_t)s->mesh->facet_count + points, &list) && x);
  for (int64_t f = 0; f < s->mesh->facet_count; f++) {
    const int32_t *t = s->triangle + 3 * f;
    double cot[3];
    if (!cotangents(s->at + 3 * (size_t)t[0], s->at + 3 * (size_t)t[1], s->at + 3 * (size_t)t[2],
                    cot))
      continue;
    for (int k = 0; k < 3; k++) {
      int32_t i = t[(k + 1) % 3], j = t[(k + 2) % 3];
      add(&list, i, j, -0.5 * cot[k]);
      add(&list, i, i, 0.5 * cot[k]);
      add(&list, j, j, 0.5 * cot[k]);
    }
  }
  for (int32_t i = 0; i < s->points; i++)
    add(&list, i, i, s->source[i]);
  for (size_t b = 0; b < bones; b++)
    for (size_t i = 0; i < points; i++)
      x[b * points + i] = s->is_near[i * bones + b] ? s->source[i] / s->near[i] : 0;
  BW_TRY(solve(s->context, &list, s->points, bones, x));
  for (size_t b = 0; b < bones; b++)
    for (size_t i = 0; i < points; i++)
      weight[(size_t)s->node[i] * bones + b] = x[b * points + i];
done:
  entries_clear(&list);
  bw_free(x);
  return status;
}

/* Laplacian of a straight tetrahedron: n_a . n_b / (9 V) with the area vectors of its faces. */
static void tetrahedron(const bw_mesh *mesh, int64_t e, double k[4][4]) {
  const int32_t *node = mesh->element + e * mesh->nodes_per_element;
  double n[4][3], edge[2][3];
  for (int a = 0; a < 4; a++) {
    const double *x[3]; /* the face opposite corner a; all faces turned the same way */
    for (int i = 0; i < 3; i++)
      x[i] = mesh->node + 3 * (size_t)node[bw_tet_face[a == 3   ? 0
                                                       : a == 2 ? 1
                                                       : a == 0 ? 2
                                                                : 3][i]];
    for (int i = 0; i < 3; i++) {
      edge[0][i] = x[1][i] - x[0][i];
      edge[1][i] = x[2][i] - x[0][i];
    }
    bw_cross(edge[0], edge[1], n[a]);
  }
  for (int a = 0; a < 4; a++)
    for (int b = 0; b < 4; b++)
      k[a][b] = bw_dot(n[a], n[b]) / (36 * mesh->volume[e]);
}

static bw_status solve_inside(bwi_skinning *s, double *weight) {
  bw_status status = BW_OK;
  const bw_mesh *mesh = s->mesh;
  size_t bones = (size_t)s->skeleton->bone_count, inner = (size_t)(s->corners - s->points);
  entries list;
  if (inner == 0)
    return BW_OK;
  double *x = BW_NEW0(s->context, double, inner *bones);
  BW_TRY_MEMORY(entries_open(s->context, 10 * (size_t)mesh->element_count, &list) && x);
  for (int64_t e = 0; e < mesh->element_count; e++) {
    const int32_t *node = mesh->element + e * mesh->nodes_per_element;
    double k[4][4];
    tetrahedron(mesh, e, k);
    for (int a = 0; a < 4; a++) {
      int32_t i = s->number[node[a]] - s->points;
      if (i < 0)
        continue;
      for (int b = 0; b < 4; b++) {
        int32_t j = s->number[node[b]] - s->points;
        if (j >= 0 && j <= i)
          add(&list, i, j, k[a][b]);
        else if (j < 0)
          for (size_t c = 0; c < bones; c++)
            x[c * inner + (size_t)i] -= k[a][b] * weight[(size_t)node[b] * bones + c];
      }
    }
  }
  BW_TRY(solve(s->context, &list, (int32_t)inner, bones, x));
  for (size_t b = 0; b < bones; b++)
    for (size_t i = 0; i < inner; i++)
      weight[(size_t)s->node[(size_t)s->points + i] * bones + b] = x[b * inner + i];
done:
  entries_clear(&list);
  bw_free(x);
  return status;
}

/* ---- rows ------------------------------------------------------------------------------------ */

/* No negative weight, and rows that sum to one; a row that rounding ruined follows the nearest
 * bone. */
static void settle_row(const bwi_skinning *s, int32_t node, double *row) {
  int32_t bones = s->skeleton->bone_count, nearest = 0;
  double sum = 0, place[3], min = HUGE_VAL;
  for (int32_t b = 0; b < bones; b++) {
    if (!(row[b] > 0))
      row[b] = 0;
    sum += row[b];
  }
  if (sum > 0.5 && sum < 2) {
    for (int32_t b = 0; b < bones; b++)
      row[b] /= sum;
    return;
  }
  for (int32_t b = 0; b < bones; b++) {
    double gap = bwi_nearest_on_bone(s->skeleton, b, s->mesh->node + 3 * (size_t)node, place);
    row[b] = 0;
    if (gap < min) {
      min = gap;
      nearest = b;
    }
  }
  row[nearest] = 1;
}

static void fill_centroids(const bwi_skinning *s, double *weight) {
  const bw_mesh *mesh = s->mesh;
  size_t bones = (size_t)s->skeleton->bone_count;
  if (mesh->order == 1)
    return;
  for (int64_t e = 0; e < mesh->element_count; e++) {
    const int32_t *node = mesh->element + e * mesh->nodes_per_element;
    for (int k = 0; k < 6; k++) {
      const double *a = weight + (size_t)node[bw_tet_edge[k][0]] * bones;
      const double *b = weight + (size_t)node[bw_tet_edge[k][1]] * bones;
      double *middle = weight + (size_t)node[4 + k] * bones;
      for (size_t c = 0; c < bones; c++)
        middle[c] = 0.5 * (a[c] + b[c]);
    }
  }
}

static bw_status check_rows(const bwi_skinning *s, const double *weight) {
  size_t bones = (size_t)s->skeleton->bone_count;
  for (int32_t i = 0; i < s->mesh->node_count; i++) {
    double sum = 0, min = 0;
    for (size_t b = 0; b < bones; b++) {
      sum += weight[(size_t)i * bones + b];
      min = fmin(min, weight[(size_t)i * bones + b]);
    }
    if (!(fabs(sum - 1) <= 1e-12) || min < 0) {
      bw_status status =
          bw_fail(s->context, BW_INTERNAL,
                  "the weights of node %d sum to %.17g, the smallest is %g", i + 1, sum, min);
      bw_detail_number(s->context, "node", i + 1.0);
      return status;
    }
  }
  return BW_OK;
}

/* The diagonal of the box around mesh and skeleton. */
static double whole_size(const bw_mesh *mesh, const bw_skeleton *skeleton) {
  double low[3], high[3];
  bw_mesh_box(mesh, low, high);
  for (size_t j = 0; j < (size_t)skeleton->joint_count; j++)
    for (size_t k = 0; k < 3; k++) {
      low[k] = fmin(low[k], skeleton->joint[3 * j + k]);
      high[k] = fmax(high[k], skeleton->joint[3 * j + k]);
    }
  return hypot(hypot(high[0] - low[0], high[1] - low[1]), high[2] - low[2]);
}

bw_status bw_skinning_weights(bw_context *context, const bw_mesh *mesh, const bw_skeleton *skeleton,
                              const bw_weights_options *options, double *weight) {
  bw_status status = BW_OK;
  bwi_skinning s = {.context = context, .mesh = mesh, .skeleton = skeleton};
  s.heat = options && options->heat != 0 ? options->heat : 20;
  if (!(s.heat > 0 && s.heat < 1e12))
    return bw_fail(context, BW_INVALID, "heat %g of skinning weights: a positive number is needed",
                   s.heat);
  s.size = whole_size(mesh, skeleton);
  BW_TRY(number_corners(&s));
  BW_TRY(measure_surface(&s));
  size_t points = (size_t)s.points, bones = (size_t)skeleton->bone_count;
  s.source = BW_NEW(context, double, points);
  s.near = BW_NEW(context, int32_t, points);
  s.is_near = BW_NEW(context, uint8_t, points * bones);
  s.gap = BW_NEW(context, double, (size_t)bw_threads(context) * bones);
  BW_TRY_MEMORY(s.source && s.near && s.is_near && s.gap);
  bw_progress(context, "skinning weights", 0);
  BW_TRY(bwi_find_sources(&s));
  BW_TRY(bw_check_cancel(context));
  bw_progress(context, "skinning weights", 0.3);
  BW_TRY(solve_surface(&s, weight));
  BW_TRY(bw_check_cancel(context));
  for (size_t i = 0; i < points; i++)
    settle_row(&s, s.node[i], weight + (size_t)s.node[i] * bones);
  bw_progress(context, "skinning weights", 0.5);
  BW_TRY(solve_inside(&s, weight));
  for (int32_t i = s.points; i < s.corners; i++)
    settle_row(&s, s.node[i], weight + (size_t)s.node[i] * bones);
  fill_centroids(&s, weight);
  BW_TRY(check_rows(&s, weight));
  bw_progress(context, "skinning weights", 1);
done:
  skinning_clear(&s);
  return status;
}
