/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* Remote points of couplings: their motions q = P x + h, what they carry, and what they exert. A
 * point of a rigid coupling has unknowns of its own. One of a distributed coupling has the mean
 * motion of its face, so that its load spreads over the face by the transposed mean. */
#include <math.h>
#include <string.h>

#include "joint/internal.h"

/* Nodes of a face that a point with a spring, a mass or a prescribed value couples each with all
 * others: the matrices have a dense block of three times as many rows. */
enum { MAX_DENSE_NODES = 2000 };

/* Of a prescribed motion, how far supports and a coupling may differ. */
static const double same_motion = 1e-9;

bool bwi_point_has_springs(const bw_remote_point *point) {
  for (int k = 0; k < 6; k++)
    if (point->spring[k] > 0)
      return true;
  return false;
}

bool bwi_point_has_mass(const bw_remote_point *point) {
  for (int k = 0; k < 3; k++)
    if (point->inertia[4 * k] > 0)
      return true;
  return point->mass > 0;
}

static bool has_fixed(const bw_remote_point *point) {
  for (int k = 0; k < 6; k++)
    if (point->fixed[k])
      return true;
  return false;
}

/* The springs (else the masses) of a point: 6 x 6. */
static void matrix_of(const bw_remote_point *point, bool springs, double s[6][6]) {
  memset(s, 0, 36 * sizeof(double));
  for (int k = 0; k < 6; k++)
    s[k][k] = springs ? point->spring[k] : k < 3 ? point->mass : 0;
  for (int a = 0; a < 3 && !springs; a++)
    for (int b = 0; b < 3; b++)
      s[3 + a][3 + b] = point->inertia[3 * a + b];
}

/* Given forces and weight. */
static void load_of(const bw_remote_point *point, const double gravity[3], double load[6]) {
  for (int k = 0; k < 6; k++)
    load[k] = point->load[k] + (k < 3 ? point->mass * gravity[k] : 0);
}

/* ---- checks ---------------------------------------------------------------------------------- */

/* Whether what the point prescribes moves a node by `value` along d, whatever else moves. */
static bool moves_so(const bw_remote_point *point, double reach, const double x[3],
                     const double d[3], double value) {
  double arm[3] = {x[0] - point->at[0], x[1] - point->at[1], x[2] - point->at[2]}, turn[3];
  double sum = 0, size = fabs(value);
  bw_cross(arm, d, turn);
  for (int k = 0; k < 6; k++) {
    double part = k < 3 ? d[k] : turn[k - 3];
    if (!point->fixed[k]) {
      if (fabs(part) > same_motion * (k < 3 ? 1 : reach))
        return false;
      continue;
    }
    sum += part * point->displacement[k];
    size = fmax(size, fabs(part * point->displacement[k]));
  }
  return fabs(sum - value) <= same_motion * size;
}

static bw_status check_node(bw_context *context, const bwi_reduction *r, int p, int32_t node) {
  const bw_dof_map *dof_map = r->dof_map;
  const bw_coupling *coupling = &r->coupling[p];
  const double *x = dof_map->mesh->node + 3 * (int64_t)node;
  const char *what = NULL;
  if (r->bond_of[node])
    what = "follows others in a bond: let its side be b there, or leave the facets around it out";
  for (int k = 0; k < 3 && !what; k++) {
    double d[3];
    if (dof_map->state[3 * (int64_t)node + k] != BW_DOF_PRESCRIBED)
      continue;
    bwi_direction_of(dof_map, node, k, d);
    if (!moves_so(&coupling->point, coupling->reach, x, d, dof_map->value[3 * (int64_t)node + k]))
      what = "is in a support, which the motion that is prescribed for the remote point does not "
             "fulfil: leave the facets around it out, prescribe the point, or make the coupling "
             "distributed";
  }
  if (!what)
    return BW_OK;
  bw_fail(context, BW_INVALID, "node %d at (%g, %g, %g) m of the rigid coupling %d %s", node + 1,
          x[0], x[1], x[2], p + 1, what);
  bw_detail_number(context, "node", node + 1.0);
  bw_detail_number(context, "coupling", p + 1.0);
  return BW_INVALID;
}

bw_status bwi_points_check(bw_context *context, const bw_model *model, const bwi_reduction *r) {
  for (int p = 0; p < model->coupling_count; p++) {
    const bw_coupling *coupling = &model->coupling[p];
    const bw_remote_point *point = &coupling->point;
    for (int32_t i = 0; point->kind == BW_RIGID && i < coupling->node_count; i++) {
      bw_status status = check_node(context, r, p, coupling->node[i]);
      if (status != BW_OK)
        return status;
    }
    if (point->kind == BW_DISTRIBUTED && coupling->node_count > MAX_DENSE_NODES &&
        (bwi_point_has_springs(point) || bwi_point_has_mass(point) || has_fixed(point)))
      return bw_fail(context, BW_LIMIT,
                     "the distributed coupling %d has %d nodes, and the spring, mass or prescribed "
                     "motion of its remote point couples each with all others: at most %d are "
                     "possible; make it rigid, or couple a smaller face",
                     p + 1, coupling->node_count, MAX_DENSE_NODES);
  }
  return BW_OK;
}

bw_status bwi_points_refuse_motion(bw_context *context, const bw_model *model, const char *why) {
  for (int p = 0; p < model->coupling_count; p++)
    for (int k = 0; k < 6; k++)
      if (model->coupling[p].point.fixed[k] && model->coupling[p].point.displacement[k] != 0)
        return bw_fail(context, BW_UNSUPPORTED,
                       "the remote point of coupling %d has a prescribed motion that is not zero: "
                       "%s",
                       p + 1, why);
  return BW_OK;
}

/* ---- P and h --------------------------------------------------------------------------------- */

/* Calls through all entries of P from T; with NULL they are counted. */
static int64_t fill(const bwi_reduction *r, int32_t *row, int32_t *column, double *value) {
  int64_t count = 0;
  for (int p = 0; p < r->point_count; p++) {
    const bw_coupling *c = &r->coupling[p];
    int64_t width = 3 * (int64_t)c->node_count;
    for (int k = 0; k < 6; k++) {
      int32_t own = r->point_unknown[6 * p + k];
      if (own >= 0) {
        if (row) {
          row[count] = 6 * p + k;
          column[count] = own;
          value[count] = 1;
        }
        count++;
      }
      for (int64_t i = 0; c->point.kind == BW_DISTRIBUTED && i < width; i++) {
        int64_t at = 3 * (int64_t)c->node[i / 3] + i % 3;
        for (int64_t e = r->t->start[at]; e < r->t->start[at + 1]; e++, count++)
          if (row) {
            row[count] = 6 * p + k;
            column[count] = r->t->column[e];
            value[count] = c->mean[k * width + i] * r->t->value[e];
          }
        if (row)
          r->h[6 * p + k] += c->mean[k * width + i] * r->g[at];
      }
      if (row && c->point.kind == BW_RIGID && c->point.fixed[k])
        r->h[6 * p + k] = c->point.displacement[k];
    }
  }
  return count;
}

/* Prescribed values of distributed couplings. */
static bw_status prescribe(bw_context *context, bwi_reduction *r) {
  bw_status status = BW_OK;
  int count = 0;
  int *component = BW_NEW(context, int, 6 * r->point_count);
  double *rows = NULL, *d = NULL;
  BW_TRY_MEMORY(component);
  for (int p = 0; p < r->point_count; p++)
    for (int k = 0; k < 6; k++)
      if (r->coupling[p].point.kind == BW_DISTRIBUTED && r->coupling[p].point.fixed[k])
        component[count++] = 6 * p + k;
  if (count == 0)
    goto done;
  rows = BW_NEW0(context, double, (int64_t)count * r->unknown_count);
  d = BW_NEW(context, double, count);
  BW_TRY_MEMORY(rows && d);
  for (int i = 0; i < count; i++) {
    int at = component[i];
    for (int64_t e = r->p->start[at]; e < r->p->start[at + 1]; e++)
      rows[(int64_t)i * r->unknown_count + r->p->column[e]] = r->p->value[e];
    d[i] = r->coupling[at / 6].point.displacement[at % 6] - r->h[at];
  }
  BW_TRY(bwi_eliminate(context, r, count, component, rows, d));
done:
  bw_free(component);
  bw_free(rows);
  bw_free(d);
  return status;
}

bw_status bwi_points_open(bw_context *context, bwi_reduction *r) {
  bw_status status = BW_OK;
  int32_t *row = NULL, *column = NULL;
  double *value = NULL;
  if (r->point_count == 0)
    return BW_OK;
  int64_t count = fill(r, NULL, NULL, NULL);
  r->h = BW_NEW0(context, double, 6 * (int64_t)r->point_count);
  row = BW_NEW(context, int32_t, count);
  column = BW_NEW(context, int32_t, count);
  value = BW_NEW(context, double, count);
  BW_TRY_MEMORY(r->h && row && column && value);
  fill(r, row, column, value);
  BW_TRY(bw_sparse_matrix_create(context, 6 * r->point_count, r->unknown_count, count, row, column,
                                 value, &r->p));
  BW_TRY(prescribe(context, r));
done:
  bw_free(row);
  bw_free(column);
  bw_free(value);
  return status;
}

/* ---- matrices and loads ---------------------------------------------------------------------- */

/* The columns that move a point, ascending, and its motions: 6 numbers for each. */
typedef struct moves {
  int32_t count, *column;
  double *value;
} moves;

static bw_status moves_of(bw_context *context, const bwi_reduction *r, int point, moves *m) {
  bw_status status = BW_OK;
  const bw_sparse_matrix *p = r->p;
  int32_t *place = BW_NEW0(context, int32_t, r->unknown_count);
  BW_TRY_MEMORY(place);
  for (int64_t e = p->start[6 * point]; e < p->start[6 * point + 6]; e++)
    place[p->column[e]] = 1;
  for (int32_t i = 0; i < r->unknown_count; i++)
    m->count += place[i];
  m->column = BW_NEW(context, int32_t, m->count);
  m->value = BW_NEW0(context, double, 6 * (int64_t)m->count);
  BW_TRY_MEMORY(m->column && m->value);
  int32_t count = 0;
  for (int32_t i = 0; i < r->unknown_count; i++)
    if (place[i]) {
      m->column[count] = i;
      place[i] = count++;
    }
  for (int k = 0; k < 6; k++)
    for (int64_t e = p->start[6 * point + k]; e < p->start[6 * point + k + 1]; e++)
      m->value[6 * (int64_t)place[p->column[e]] + k] = p->value[e];
done:
  bw_free(place);
  return status;
}

/* a^T S b, the same to the last bit with a and b exchanged. */
static double product(const double s[6][6], const double *a, const double *b) {
  double sum = 0;
  for (int i = 0; i < 6; i++) {
    if (s[i][i] != 0)
      sum += s[i][i] * (a[i] * b[i]);
    for (int j = 0; j < i; j++)
      if (s[i][j] != 0) {
        double one = a[i] * b[j], other = a[j] * b[i];
        sum += s[i][j] * (one + other);
      }
  }
  return sum;
}

/* matrix + M^T S M: rows of both, ascending, are merged. */
static bw_status merge(bw_context *context, const bw_sparse_matrix *a, const moves *m,
                       const double s[6][6], bw_sparse_matrix **out) {
  bw_status status = BW_OK;
  int32_t *column = NULL;
  double *value = NULL;
  int64_t *start = BW_NEW0(context, int64_t, (int64_t)a->rows + 1);
  BW_TRY_MEMORY(start);
  for (int pass = 0; pass < 2; pass++) {
    int32_t next = 0;
    int64_t count = 0;
    for (int32_t i = 0; i < a->rows; i++) {
      bool moved = next < m->count && m->column[next] == i;
      int64_t e = a->start[i], end = a->start[i + 1];
      int32_t k = 0, last = moved ? m->count : 0;
      while (e < end || k < last) {
        int32_t j = e < end ? a->column[e] : INT32_MAX, l = k < last ? m->column[k] : INT32_MAX;
        if (pass == 1) {
          column[count] = j < l ? j : l;
          value[count] =
              (j <= l ? a->value[e] : 0) +
              (l <= j ? product(s, m->value + 6 * (int64_t)next, m->value + 6 * (int64_t)k) : 0);
        }
        e += j <= l;
        k += l <= j;
        count++;
      }
      next += moved;
      start[i + 1] = count;
    }
    if (pass == 0) {
      column = BW_NEW(context, int32_t, count);
      value = BW_NEW(context, double, count);
      BW_TRY_MEMORY(column && value);
    }
  }
  BW_TRY(bw_sparse_matrix_adopt(context, a->rows, a->columns, start, column, value, out));
  start = NULL;
  column = NULL;
  value = NULL;
done:
  bw_free(start);
  bw_free(column);
  bw_free(value);
  return status;
}

bw_status bwi_points_add_one(bw_context *context, const bwi_reduction *r, int point,
                             const double s[6][6], bw_sparse_matrix **matrix) {
  bw_status status = BW_OK;
  moves m = {0};
  bw_sparse_matrix *sum = NULL;
  const bw_coupling *c = &r->coupling[point];
  if (c->point.kind == BW_DISTRIBUTED && c->node_count > MAX_DENSE_NODES)
    return bw_fail(context, BW_LIMIT,
                   "the distributed coupling %d has %d nodes, and the lever of its remote point "
                   "couples each with all others: at most %d are possible; make it rigid, or "
                   "couple a smaller face",
                   point + 1, c->node_count, MAX_DENSE_NODES);
  BW_TRY(moves_of(context, r, point, &m));
  BW_TRY(merge(context, *matrix, &m, s, &sum));
  bw_release(*matrix);
  *matrix = sum;
done:
  bw_free(m.column);
  bw_free(m.value);
  return status;
}

bw_status bwi_points_add(bw_context *context, const bwi_reduction *r, bool springs,
                         bw_sparse_matrix **matrix) {
  bw_status status = BW_OK;
  for (int p = 0; p < r->point_count; p++) {
    const bw_remote_point *point = &r->coupling[p].point;
    double s[6][6];
    if (springs ? !bwi_point_has_springs(point) : !bwi_point_has_mass(point))
      continue;
    matrix_of(point, springs, s);
    BW_TRY(bwi_points_add_one(context, r, p, s, matrix));
  }
done:
  return status;
}

void bwi_points_load(const bwi_reduction *r, const double gravity[3], double *b) {
  for (int p = 0; p < r->point_count; p++) {
    const bw_remote_point *point = &r->coupling[p].point;
    double load[6];
    load_of(point, gravity, load);
    for (int k = 0; k < 6; k++) {
      double force = load[k] - point->spring[k] * r->h[6 * p + k];
      for (int64_t e = r->p->start[6 * p + k]; e < r->p->start[6 * p + k + 1]; e++)
        b[r->p->column[e]] += force * r->p->value[e];
    }
  }
}

/* ---- results --------------------------------------------------------------------------------- */

/* x = A^-1 x by elimination with row exchanges; what was eliminated once is regular. */
static void solve_square(int n, double *a, double *x) {
  for (int i = 0; i < n; i++) {
    int best = i;
    for (int j = i + 1; j < n; j++)
      if (fabs(a[j * n + i]) > fabs(a[best * n + i]))
        best = j;
    for (int k = 0; k < n; k++) {
      double kept = a[i * n + k];
      a[i * n + k] = a[best * n + k];
      a[best * n + k] = kept;
    }
    double kept = x[i];
    x[i] = x[best];
    x[best] = kept;
    for (int j = i + 1; j < n; j++) {
      double factor = a[j * n + i] / a[i * n + i];
      for (int k = i; k < n; k++)
        a[j * n + k] -= factor * a[i * n + k];
      x[j] -= factor * x[i];
    }
  }
  for (int i = n - 1; i >= 0; i--) {
    for (int k = i + 1; k < n; k++)
      x[i] -= a[i * n + k] * x[k];
    x[i] /= a[i * n + i];
  }
}

/* The reactions of prescribed values of distributed couplings. */
static bw_status react(bw_context *context, const bwi_reduction *r, const double *force,
                       bw_coupling_result *result) {
  bw_status status = BW_OK;
  const bwi_eliminated *gone = &r->gone;
  int n = gone->count;
  double *square = BW_NEW(context, double, (int64_t)n *n), *multiplier = BW_NEW(context, double, n);
  BW_TRY_MEMORY(square && multiplier);
  memcpy(square, gone->square, (size_t)n * (size_t)n * sizeof *square);
  BW_TRY(bw_sparse_matrix_apply(context, gone->row, 1, force, multiplier));
  for (int i = 0; i < n; i++)
    for (int k = 0; k < 6 * r->point_count; k++)
      multiplier[i] -= gone->point[i * 6 * r->point_count + k] * result[k / 6].load[k % 6];
  solve_square(n, square, multiplier);
  for (int i = 0; i < n; i++)
    result[gone->component[i] / 6].reaction[gone->component[i] % 6] = multiplier[i];
done:
  bw_free(square);
  bw_free(multiplier);
  return status;
}

void bwi_point_exert(const bw_coupling *c, double factor, const double load[6], double *force) {
  int64_t width = 3 * (int64_t)c->node_count;
  for (int k = 0; k < 6; k++)
    for (int64_t i = 0; i < width && load[k] != 0; i++)
      force[3 * (int64_t)c->node[i / 3] + i % 3] += factor * c->mean[k * width + i] * load[k];
}

bw_status bwi_points_spread(bw_context *context, const bwi_reduction *r, const double gravity[3],
                            const double *x, double *force, bw_coupling_result *result) {
  bw_status status = BW_OK;
  for (int p = 0; p < r->point_count; p++) {
    const bw_remote_point *point = &r->coupling[p].point;
    load_of(point, gravity, result[p].load);
    for (int k = 0; k < 6; k++) {
      double sum = r->h[6 * p + k];
      for (int64_t e = r->p->start[6 * p + k]; e < r->p->start[6 * p + k + 1]; e++)
        sum += r->p->value[e] * x[r->p->column[e]];
      result[p].displacement[k] = sum;
      result[p].load[k] -= point->spring[k] * sum;
    }
  }
  if (r->gone.count > 0)
    BW_TRY(react(context, r, force, result));
  for (int p = 0; p < r->point_count; p++) {
    if (r->coupling[p].point.kind != BW_DISTRIBUTED)
      continue;
    for (int k = 0; k < 6; k++)
      result[p].load[k] += result[p].reaction[k];
    bwi_point_exert(&r->coupling[p], -1, result[p].load, force);
  }
done:
  return status;
}

bw_status bwi_points_react(bw_context *context, const bwi_reduction *r, double *force) {
  bw_status status = BW_OK;
  bw_coupling_result *result = NULL;
  if (r->gone.count == 0)
    return BW_OK;
  result = BW_NEW0(context, bw_coupling_result, r->point_count);
  BW_TRY_MEMORY(result);
  BW_TRY(react(context, r, force, result));
  for (int p = 0; p < r->point_count; p++)
    bwi_point_exert(&r->coupling[p], -1, result[p].reaction, force);
done:
  bw_free(result);
  return status;
}

void bwi_points_gather(const bwi_reduction *r, double *force, bw_coupling_result *result,
                       double *joint) {
  for (int p = 0; p < r->point_count; p++) {
    const bw_coupling *c = &r->coupling[p];
    double sum[6] = {0};
    if (c->point.kind == BW_DISTRIBUTED)
      continue;
    for (int32_t i = 0; i < c->node_count; i++) {
      double *f = force + 3 * (int64_t)c->node[i], moment[3];
      const double *x = r->dof_map->mesh->node + 3 * (int64_t)c->node[i], *at = c->point.at;
      bw_cross((double[3]){x[0] - at[0], x[1] - at[1], x[2] - at[2]}, f, moment);
      for (int k = 0; k < 3; k++) {
        sum[k] += f[k];
        sum[3 + k] += moment[k];
        joint[3 * (int64_t)c->node[i] + k] = f[k];
        f[k] = 0;
      }
    }
    for (int k = 0; k < 6; k++) { /* the point is in equilibrium */
      if (c->point.fixed[k])
        result[p].reaction[k] = sum[k] - result[p].load[k];
      result[p].load[k] = sum[k];
    }
  }
}
