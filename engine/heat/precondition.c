/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* The preconditioner of quadratic elements: Jacobi for what oscillates, and a factor of the matrix
 * that the linear functions of the corners make of it (Galerkin). P is 1 at a corner and 1/2 at the
 * middles of its edges; both ends of the edges of two nodes of an element are its corners, so that
 * the pattern of the linear elements holds P^T A P, but for what joins the sides of contacts. */
#include "heat/internal.h"

typedef struct two_level {
  int32_t unknowns, corners;
  int32_t (
      *parent)[2];  /* (index, unknowns) the corners of each unknown, or -1; twice of a corner */
  double *diagonal; /* of the inverse of D */
  int32_t *partner; /* (index, unknowns) at the same place on the other side of a contact, or -1 */
  double *joint;    /* (unknowns) of the inverse of D, with the partner */
  double *work;     /* corners x 2 */
  bw_operator *inverse; /* of P^T A P, or NULL without corners */
} two_level;

static void destroy(void *data) {
  two_level *m = data;
  bw_free(m->parent);
  bw_free(m->diagonal);
  bw_free(m->partner);
  bw_free(m->joint);
  bw_free(m->work);
  bw_release(m->inverse);
  bw_free(m);
}

static bw_status apply(bw_context *context, void *data, int64_t count, const double *x, double *y) {
  const two_level *m = data;
  double *r = m->work, *z = m->work + m->corners;
  for (int64_t k = 0; k < count; k++) {
    const double *from = x + k * m->unknowns;
    double *to = y + k * m->unknowns;
    for (int32_t c = 0; c < m->corners; c++)
      r[c] = 0;
    for (int32_t i = 0; i < m->unknowns; i++) {
      to[i] = m->diagonal[i] * from[i];
      if (m->partner[i] >= 0)
        to[i] += m->joint[i] * from[m->partner[i]];
      for (int e = 0; e < 2; e++)
        if (m->parent[i][e] >= 0)
          r[m->parent[i][e]] += 0.5 * from[i];
    }
    if (!m->inverse)
      continue;
    bw_status status = bw_operator_apply(context, m->inverse, 1, r, z);
    if (status != BW_OK)
      return status;
    for (int32_t i = 0; i < m->unknowns; i++)
      for (int e = 0; e < 2; e++)
        if (m->parent[i][e] >= 0)
          to[i] += 0.5 * z[m->parent[i][e]];
  }
  return BW_OK;
}

/* The ends of each node's edge, a corner being both of its own. */
static void find_ends(const bw_mesh *mesh, int32_t (*end)[2]) {
  for (int64_t e = 0; e < mesh->element_count; e++) {
    const int32_t *node = mesh->element + 10 * e;
    for (int a = 0; a < 10; a++)
      for (int k = 0; k < 2; k++)
        end[node[a]][k] = a < 4 ? node[a] : node[bw_tet_edge[a - 4][k]];
  }
}

/* P^T A P on the lower triangle of the linear elements' pattern, both of whose nodes are numbered
 * as in the mesh. */
static void coarsen(const bwi_heat_system *s, const double *values, int32_t (*end)[2],
                    const int32_t *corner, const bw_block_pattern *coarse, double *out) {
  const bw_block_pattern *p = s->pattern;
  for (int32_t i = 0; i < p->node_count; i++)
    for (int64_t k = p->start[i]; s->unknown[i] >= 0 && k < p->start[i + 1]; k++) {
      int32_t j = p->column[k];
      if (s->unknown[j] < 0)
        continue;
      for (int a = 0; a < 2; a++)
        for (int b = 0; b < 2; b++) {
          int32_t r = end[i][a], c = end[j][b];
          if (s->unknown[r] < 0 || s->unknown[c] < 0)
            continue;
          /* entry (j, i) adds to (c, r): both lie in one triangle where r = c */
          double twice = i != j && r == c ? 2 : 1;
          if (i != j || r >= c)
            out[bwi_heat_block(coarse, corner[r], corner[c])] += 0.25 * twice * values[k];
        }
    }
}

/* D: the diagonal, and of two nodes at one place their 2 x 2 block, without which a contact that
 * hardly resists would hide what the elements conduct. A node of several contacts has the partner
 * of the first. */
static void invert_diagonal(const bwi_heat_system *s, const double *values, double part,
                            two_level *m) {
  const int n = s->heat->mesh->nodes_per_facet;
  for (int32_t r = 0; r < s->unknowns; r++)
    m->partner[r] = -1;
  for (int k = 0; k < s->heat->condition_count; k++) {
    const bw_heat_condition *c = &s->heat->condition[k];
    for (int64_t i = 0; c->pair && i < (int64_t)c->on->facet_count * n; i++) {
      if (c->pair[i - i % n] < 0)
        continue;
      int32_t one = s->unknown[s->heat->mesh->facet[(int64_t)c->on->facet[i / n] * n + i % n]];
      int32_t other = s->unknown[c->pair[i]];
      if (one >= 0 && other >= 0 && m->partner[one] < 0 && m->partner[other] < 0)
        m->partner[one] = other, m->partner[other] = one;
    }
  }
  for (int64_t k = 0; k < s->cross.count; k++) {
    int32_t i = s->unknown[s->cross.row[k]], j = s->unknown[s->cross.column[k]];
    if (i >= 0 && j >= 0 && m->partner[i] == j)
      m->joint[i] += part * s->cross.value[k];
  }
  for (int32_t r = 0; r < s->unknowns; r++) {
    int32_t other = m->partner[r];
    double a = values[s->pattern->start[s->node[r] + 1] - 1];
    if (other < 0)
      m->diagonal[r] = 1 / a;
    else if (r < other) {
      double b = values[s->pattern->start[s->node[other] + 1] - 1], c = m->joint[r];
      double determinant = a * b - c * c;
      m->diagonal[r] = b / determinant;
      m->diagonal[other] = a / determinant;
      m->joint[r] = m->joint[other] = -c / determinant;
    }
  }
}

bw_status bwi_heat_two_level(bw_context *context, const bwi_heat_system *s, const double *values,
                             double part, bw_operator **result) {
  bw_status status = BW_OK;
  const bw_mesh *mesh = s->heat->mesh;
  int32_t n = mesh->node_count, corners = 0;
  int64_t used = 0, most;
  int32_t(*end)[2] = bw_alloc(context, (size_t)n, sizeof *end);
  int32_t *corner = BW_NEW(context, int32_t, n);
  int32_t *element = BW_NEW(context, int32_t, 4 * (size_t)mesh->element_count);
  int32_t *row = NULL, *column = NULL, *unknown = NULL;
  double *coarse = NULL, *value = NULL;
  bw_block_pattern *pattern = NULL;
  bw_sparse_matrix *matrix = NULL;
  two_level *m = BW_NEW0(context, two_level, 1);
  BW_TRY_MEMORY(end && corner && element && m);
  find_ends(mesh, end);
  for (int32_t i = 0; i < n; i++)
    corner[i] = end[i][0] == i ? corners++ : -1;
  for (int64_t e = 0; e < mesh->element_count; e++)
    for (int a = 0; a < 4; a++)
      element[4 * e + a] = corner[mesh->element[10 * e + a]];
  BW_TRY(bw_block_pattern_of_elements(context, corners, mesh->element_count, 4, element, &pattern));
  coarse = BW_NEW0(context, double, pattern->block_count);
  unknown = BW_NEW(context, int32_t, corners); /* of the coarse matrix, by corner */
  m->unknowns = s->unknowns;
  m->parent = bw_alloc(context, (size_t)s->unknowns, sizeof *m->parent);
  m->diagonal = BW_NEW(context, double, s->unknowns);
  most = 2 * pattern->block_count + 4 * s->cross.count;
  m->partner = BW_NEW(context, int32_t, s->unknowns);
  m->joint = BW_NEW0(context, double, s->unknowns);
  row = BW_NEW(context, int32_t, most);
  column = BW_NEW(context, int32_t, most);
  value = BW_NEW(context, double, most);
  BW_TRY_MEMORY(coarse && unknown && m->parent && m->diagonal && m->partner && m->joint && row &&
                column && value);
  invert_diagonal(s, values, part, m);
  coarsen(s, values, end, corner, pattern, coarse);
  for (int32_t i = 0; i < n; i++)
    if (corner[i] >= 0)
      unknown[corner[i]] = s->unknown[i] >= 0 ? m->corners++ : -1;
  for (int32_t r = 0; r < s->unknowns; r++) {
    int32_t i = s->node[r];
    for (int k = 0; k < 2; k++)
      m->parent[r][k] = unknown[corner[end[i][k]]];
  }
  for (int32_t i = 0; i < corners; i++)
    for (int64_t k = pattern->start[i]; unknown[i] >= 0 && k < pattern->start[i + 1]; k++) {
      int32_t j = unknown[pattern->column[k]];
      if (j < 0)
        continue;
      row[used] = unknown[i], column[used] = j, value[used++] = coarse[k];
      if (j != unknown[i])
        row[used] = j, column[used] = unknown[i], value[used++] = coarse[k];
    }
  for (int64_t k = 0; k < s->cross.count; k++) { /* what joins the sides of contacts */
    int32_t i = s->unknown[s->cross.row[k]], j = s->unknown[s->cross.column[k]];
    for (int e = 0; e < 4 && i >= 0 && j >= 0; e++) {
      int32_t r = m->parent[i][e / 2], c = m->parent[j][e % 2];
      if (r >= 0 && c >= 0)
        row[used] = r, column[used] = c, value[used++] = 0.25 * part * s->cross.value[k];
    }
  }
  m->work = BW_NEW(context, double, 2 * (size_t)m->corners);
  BW_TRY_MEMORY(m->work);
  if (m->corners) {
    BW_TRY(bw_sparse_matrix_create(context, m->corners, m->corners, used, row, column, value,
                                   &matrix));
    BW_TRY(bw_operator_inverse(context, matrix, NULL, &m->inverse));
  }
  BW_TRY(bw_operator_create(context, s->unknowns, apply, m, destroy, "two_level", result));
  m = NULL;
done:
  if (m)
    destroy(m);
  bw_release(pattern);
  bw_release(matrix);
  bw_free(end);
  bw_free(corner);
  bw_free(element);
  bw_free(coarse);
  bw_free(unknown);
  bw_free(row);
  bw_free(column);
  bw_free(value);
  return status;
}
