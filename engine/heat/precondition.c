/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* The preconditioner of quadratic elements: D for what oscillates, and a factor of the matrix that
 * the linear functions of the corners make of it (Galerkin). P is 1 at a corner and 1/2 at the
 * middles of its edges; a corner that follows others in a bond takes their functions. D is the
 * diagonal, and of nodes in contact their whole block, without which a contact that hardly resists
 * would hide what the elements conduct. */
#include "heat/internal.h"

typedef struct two_level {
  int32_t unknowns, corners, joined;
  bw_sparse_matrix *prolong; /* unknowns x corners */
  double *diagonal;          /* of the inverse of D */
  int32_t *node;             /* (index, joined) the unknowns in contact */
  double *work;              /* 2 vectors of corners or joined */
  bw_operator *inverse;      /* of P^T A P, or NULL without corners */
  bw_operator *joint;        /* the inverse of the block in contact, or NULL */
} two_level;

static void destroy(void *data) {
  two_level *m = data;
  bw_release(m->prolong);
  bw_free(m->diagonal);
  bw_free(m->node);
  bw_free(m->work);
  bw_release(m->inverse);
  bw_release(m->joint);
  bw_free(m);
}

static bw_status apply(bw_context *context, void *data, int64_t count, const double *x, double *y) {
  const two_level *m = data;
  const bw_sparse_matrix *p = m->prolong;
  bw_status status = BW_OK;
  for (int64_t k = 0; k < count; k++) {
    const double *from = x + k * m->unknowns;
    double *to = y + k * m->unknowns;
    for (int32_t i = 0; i < m->unknowns; i++)
      to[i] = m->diagonal[i] * from[i];
    if (m->joint) {
      double *r = m->work, *z = m->work + m->joined;
      for (int32_t c = 0; c < m->joined; c++)
        r[c] = from[m->node[c]];
      BW_TRY(bw_operator_apply(context, m->joint, 1, r, z));
      for (int32_t c = 0; c < m->joined; c++)
        to[m->node[c]] = z[c];
    }
    if (!m->inverse)
      continue;
    double *r = m->work, *z = m->work + m->corners;
    for (int32_t c = 0; c < m->corners; c++)
      r[c] = 0;
    for (int32_t i = 0; i < m->unknowns; i++)
      for (int64_t e = p->start[i]; e < p->start[i + 1]; e++)
        r[p->column[e]] += p->value[e] * from[i];
    BW_TRY(bw_operator_apply(context, m->inverse, 1, r, z));
    for (int32_t i = 0; i < m->unknowns; i++)
      for (int64_t e = p->start[i]; e < p->start[i + 1]; e++)
        to[i] += p->value[e] * z[p->column[e]];
  }
done:
  return status;
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

/* P: half of each end; an end that follows others is made of the unknowns that it follows. */
static bw_status make_prolong(bw_context *context, const bwi_heat_system *s, int32_t (*end)[2],
                              two_level *m) {
  bw_status status = BW_OK;
  bwi_entries entries = {0};
  int32_t n = s->heat->mesh->node_count;
  int32_t *corner = BW_NEW(context, int32_t, n); /* the coarse unknown of a node */
  BW_TRY_MEMORY(corner);
  for (int32_t i = 0; i < n; i++)
    corner[i] = end[i][0] == i && s->unknown[i] >= 0 ? m->corners++ : -1;
  for (int32_t r = 0; r < s->unknowns; r++)
    for (int k = 0; k < 2; k++) {
      int32_t i = end[s->node[r]][k];
      if (corner[i] >= 0) {
        BW_TRY(bwi_entries_add(context, &entries, r, corner[i], 0.5));
        continue;
      }
      for (int64_t e = s->expand ? s->expand->start[i] : 0;
           s->expand && e < s->expand->start[i + 1]; e++) {
        const int32_t *of = end[s->node[s->expand->column[e]]];
        for (int l = 0; l < 2; l++)
          if (corner[of[l]] >= 0)
            BW_TRY(
                bwi_entries_add(context, &entries, r, corner[of[l]], 0.25 * s->expand->value[e]));
      }
    }
  BW_TRY(bwi_entries_matrix(context, &entries, s->unknowns, m->corners, &m->prolong));
done:
  bwi_entries_clear(&entries);
  bw_free(corner);
  return status;
}

static double diagonal_of(const bw_sparse_matrix *matrix, int32_t row) {
  for (int64_t k = matrix->start[row]; k < matrix->start[row + 1]; k++)
    if (matrix->column[k] == row)
      return matrix->value[k];
  return 0;
}

/* D and its inverse. */
static bw_status invert_diagonal(bw_context *context, const bwi_heat_system *s,
                                 const bw_sparse_matrix *matrix, two_level *m) {
  bw_status status = BW_OK;
  bw_sparse_matrix *block = NULL;
  bwi_entries entries = {0};
  int32_t *place = BW_NEW(context, int32_t, s->unknowns);
  BW_TRY_MEMORY(place);
  for (int32_t r = 0; r < s->unknowns; r++) {
    place[r] = -1;
    m->diagonal[r] = 1 / diagonal_of(matrix, r);
  }
  for (int c = 0; c < s->heat->condition_count; c++) {
    const bw_sparse_matrix *joint = s->heat->condition[c].joint;
    for (int32_t i = 0; joint && i < joint->rows; i++)
      if (joint->start[i + 1] > joint->start[i] && s->unknown[i] >= 0)
        place[s->unknown[i]] = 0;
  }
  for (int32_t r = 0; r < s->unknowns; r++)
    if (place[r] == 0) {
      place[r] = m->joined;
      m->node[m->joined++] = r;
    }
  for (int32_t i = 0; i < m->joined; i++)
    for (int64_t k = matrix->start[m->node[i]]; k < matrix->start[m->node[i] + 1]; k++)
      if (place[matrix->column[k]] >= 0)
        BW_TRY(bwi_entries_add(context, &entries, i, place[matrix->column[k]], matrix->value[k]));
  if (m->joined) {
    BW_TRY(bwi_entries_matrix(context, &entries, m->joined, m->joined, &block));
    BW_TRY(bw_operator_inverse(context, block, NULL, &m->joint));
  }
done:
  bw_release(block);
  bwi_entries_clear(&entries);
  bw_free(place);
  return status;
}

bw_status bwi_heat_two_level(bw_context *context, const bwi_heat_system *s,
                             const bw_sparse_matrix *matrix, bw_operator **result) {
  bw_status status = BW_OK;
  int32_t(*end)[2] = bw_alloc(context, (size_t)s->heat->mesh->node_count, sizeof *end);
  bw_sparse_matrix *coarse = NULL;
  two_level *m = BW_NEW0(context, two_level, 1);
  BW_TRY_MEMORY(end && m);
  m->unknowns = s->unknowns;
  m->diagonal = BW_NEW(context, double, s->unknowns);
  m->node = BW_NEW(context, int32_t, s->unknowns);
  BW_TRY_MEMORY(m->diagonal && m->node);
  find_ends(s->heat->mesh, end);
  BW_TRY(invert_diagonal(context, s, matrix, m));
  BW_TRY(make_prolong(context, s, end, m));
  m->work = BW_NEW(context, double, 2 * (size_t)(m->corners > m->joined ? m->corners : m->joined));
  BW_TRY_MEMORY(m->work);
  if (m->corners) {
    BW_TRY(bwi_galerkin(context, matrix, m->prolong, &coarse));
    BW_TRY(bw_operator_inverse(context, coarse, NULL, &m->inverse));
  }
  BW_TRY(bw_operator_create(context, s->unknowns, apply, m, destroy, "two_level", result));
  m = NULL;
done:
  if (m)
    destroy(m);
  bw_release(coarse);
  bw_free(end);
  return status;
}
