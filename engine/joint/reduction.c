/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* The displacements u = T x + g that supports, bonds and couplings allow, and matrices reduced to
 * them. The unknowns are components of nodes in the frames of their supports, and of remote points.
 * A support at a node that follows others in a bond wins: the node follows them in its free
 * directions only. The nodes of a rigid coupling follow its remote point. */
#include "joint/internal.h"
#include "matrix/sparse.h"

#include <string.h>

static const double global_frame[9] = {1, 0, 0, 0, 1, 0, 0, 0, 1};

static const double *frame_of(const bw_dof_map *dof_map, int32_t node) {
  int32_t f = dof_map->frame_of[node];
  return f >= 0 ? dof_map->frame + 9 * (int64_t)f : global_frame;
}

static bool is_prescribed(const bw_dof_map *dof_map, int32_t node, int k) {
  return dof_map->state[3 * (int64_t)node + k] == BW_DOF_PRESCRIBED;
}

/* Which nodes move with a remote point. */
static void find_coupled(const bw_model *model, bwi_reduction *r) {
  for (int32_t i = 0; i < model->mesh->node_count; i++)
    r->coupling_of[i] = -1;
  for (int p = 0; p < model->coupling_count; p++)
    for (int32_t i = 0;
         model->coupling[p].point.kind == BW_RIGID && i < model->coupling[p].node_count; i++)
      r->coupling_of[model->coupling[p].node[i]] = p;
}

bw_status bwi_reduction_followers(bw_context *context, const bw_model *model, bwi_reduction *r) {
  bw_status status = BW_OK;
  r->bond_of = BW_NEW0(context, const bw_bond *, model->mesh->node_count);
  r->row_of = BW_NEW0(context, int32_t, model->mesh->node_count);
  BW_TRY_MEMORY(r->bond_of && r->row_of);
  for (int b = 0; b < model->bond_count; b++)
    for (int32_t i = 0; i < model->bond[b].node_count; i++) {
      int32_t node = model->bond[b].node[i];
      if (r->bond_of[node])
        BW_TRY(
            bwi_fail_node(context, model->mesh, node, BW_INVALID,
                          "follows others in two bonds: let its side be b in one of them, or leave "
                          "the facets around it out"));
      r->bond_of[node] = &model->bond[b];
      r->row_of[node] = i;
    }
  for (int b = 0; b < model->bond_count; b++) {
    const bw_sparse_matrix *f = model->bond[b].follows;
    for (int64_t e = 0; e < f->start[f->rows]; e++)
      if (r->bond_of[f->column[e]])
        BW_TRY(bwi_fail_node(
            context, model->mesh, f->column[e], BW_INVALID,
            "is followed in one bond and follows others in another: give the sides of "
            "one of these bonds the other way round"));
  }
done:
  return status;
}

typedef struct triplets {
  int64_t count;
  int32_t *row, *column;
  double *value;
} triplets;

/* Component k of a node's own frame, `factor` times, as a part of row `row`. NULL: only counted. */
static int64_t add_own(const bwi_reduction *r, int32_t node, int k, double factor, int32_t row,
                       triplets *t) {
  int32_t column = r->unknown[3 * (int64_t)node + k];
  if (factor == 0)
    return 0;
  if (t && column >= 0) {
    t->row[t->count] = row;
    t->column[t->count] = column;
    t->value[t->count++] = factor;
  } else if (t)
    r->g[row] += factor * r->dof_map->value[3 * (int64_t)node + k];
  return column >= 0;
}

/* The displacement along d of a node that moves with a remote point. */
static int64_t add_coupled(const bwi_reduction *r, int32_t node, const double d[3], double factor,
                           int32_t row, triplets *t) {
  int32_t p = r->coupling_of[node];
  const bw_remote_point *point = &r->coupling[p].point;
  const double *x = r->dof_map->mesh->node + 3 * (int64_t)node;
  double arm[3] = {x[0] - point->at[0], x[1] - point->at[1], x[2] - point->at[2]}, turn[3];
  int64_t count = 0;
  bw_cross(arm, d, turn);
  for (int k = 0; k < 6; k++) {
    int32_t column = r->point_unknown[6 * p + k];
    double part = factor * (k < 3 ? d[k] : turn[k - 3]);
    if (part == 0)
      continue;
    count += column >= 0;
    if (t && column >= 0) {
      t->row[t->count] = row;
      t->column[t->count] = column;
      t->value[t->count++] = part;
    } else if (t)
      r->g[row] += part * point->displacement[k];
  }
  return count;
}

/* The displacement along d of a node that follows none in a bond. */
static int64_t add_along(const bwi_reduction *r, int32_t node, const double d[3], double factor,
                         int32_t row, triplets *t) {
  const double *frame = frame_of(r->dof_map, node);
  int64_t count = 0;
  if (r->coupling_of[node] >= 0)
    return add_coupled(r, node, d, factor, row, t);
  for (int k = 0; k < 3; k++)
    count += add_own(r, node, k, factor * bw_dot(frame + 3 * k, d), row, t);
  return count;
}

/* The part of a shortening along d. */
static int64_t add_shortening(const bwi_reduction *r, const bw_bond *bond, const double d[3],
                              double factor, int32_t row, triplets *t) {
  int32_t column = r->shortening[bond - r->bond];
  double part = factor * bw_dot(bond->normal, d);
  if (bond->preload == BW_NO_PRELOAD || part == 0)
    return 0;
  if (t && column >= 0) {
    t->row[t->count] = row;
    t->column[t->count] = column;
    t->value[t->count++] = part;
  } else if (t && bond->preload == BW_PRELOAD_SHORTENING)
    r->g[row] += part * bond->pull;
  return column >= 0;
}

/* Row `row` of T and g: component c of a node in global directions. */
static int64_t add_row(const bwi_reduction *r, int32_t node, int c, triplets *t) {
  const double *frame = frame_of(r->dof_map, node);
  int32_t row = 3 * node + c;
  int64_t count = 0;
  if (!r->bond_of[node])
    return add_along(r, node, global_frame + 3 * c, 1, row, t);
  const bw_sparse_matrix *f = r->bond_of[node]->follows;
  for (int k = 0; k < 3; k++) {
    double part = frame[3 * k + c];
    if (part == 0)
      continue;
    if (is_prescribed(r->dof_map, node, k)) {
      count += add_own(r, node, k, part, row, t);
      continue;
    }
    for (int64_t e = f->start[r->row_of[node]]; e < f->start[r->row_of[node] + 1]; e++)
      count += add_along(r, f->column[e], frame + 3 * k, part * f->value[e], row, t);
    count += add_shortening(r, r->bond_of[node], frame + 3 * k, part, row, t);
  }
  return count;
}

static void number_unknowns(const bw_model *model, bool locked, bwi_reduction *r) {
  for (int32_t i = 0; i < r->dof_map->mesh->node_count; i++)
    for (int k = 0; k < 3; k++)
      r->unknown[3 * (int64_t)i + k] =
          r->bond_of[i] || r->coupling_of[i] >= 0 || is_prescribed(r->dof_map, i, k)
              ? -1
              : r->unknown_count++;
  for (int b = 0; b < model->bond_count; b++)
    r->shortening[b] =
        !locked && model->bond[b].preload == BW_PRELOAD_FORCE ? r->unknown_count++ : -1;
  for (int p = 0; p < r->point_count; p++)
    for (int k = 0; k < 6; k++)
      r->point_unknown[6 * p + k] =
          r->coupling[p].point.kind == BW_RIGID && !r->coupling[p].point.fixed[k]
              ? r->unknown_count++
              : -1;
}

bw_status bwi_reduction_open(bw_context *context, const bw_model *model, bool locked,
                             bwi_reduction *r) {
  bw_status status = BW_OK;
  int32_t nodes = model->mesh->node_count;
  triplets t = {0};
  *r = (bwi_reduction){
      .coupling = model->coupling, .point_count = model->coupling_count, .bond = model->bond};
  BW_TRY(bwi_dof_map_apart(context, model, &r->dof_map));
  r->shortening = BW_NEW(context, int32_t, model->bond_count);
  r->coupling_of = BW_NEW(context, int32_t, nodes);
  r->point_unknown = BW_NEW(context, int32_t, 6 * (int64_t)r->point_count);
  r->unknown = BW_NEW(context, int32_t, 3 * (int64_t)nodes);
  r->g = BW_NEW0(context, double, 3 * (int64_t)nodes);
  BW_TRY_MEMORY(r->unknown && r->g && r->coupling_of && r->shortening && r->point_unknown);
  find_coupled(model, r);
  BW_TRY(bwi_reduction_followers(context, model, r));
  BW_TRY(bwi_points_check(context, model, r));
  number_unknowns(model, locked, r);
  int64_t count = 0;
  for (int32_t i = 0; i < nodes; i++)
    for (int c = 0; c < 3; c++)
      count += add_row(r, i, c, NULL);
  t.row = BW_NEW(context, int32_t, count);
  t.column = BW_NEW(context, int32_t, count);
  t.value = BW_NEW(context, double, count);
  BW_TRY_MEMORY(t.row && t.column && t.value);
  for (int32_t i = 0; i < nodes; i++)
    for (int c = 0; c < 3; c++)
      add_row(r, i, c, &t);
  BW_TRY(bw_sparse_matrix_create(context, 3 * nodes, r->unknown_count, t.count, t.row, t.column,
                                 t.value, &r->t));
  BW_TRY(bw_sparse_matrix_create(context, r->unknown_count, 3 * nodes, t.count, t.column, t.row,
                                 t.value, &r->transposed));
  BW_TRY(bwi_points_open(context, r));
done:
  bw_free(t.row);
  bw_free(t.column);
  bw_free(t.value);
  return status;
}

void bwi_reduction_clear(bwi_reduction *r) {
  bw_release(r->dof_map);
  bw_release(r->t);
  bw_release(r->transposed);
  bw_free(r->bond_of);
  bw_free(r->row_of);
  bw_free(r->unknown);
  bw_free(r->g);
  bw_free(r->coupling_of);
  bw_free(r->shortening);
  bw_free(r->point_unknown);
  bw_release(r->p);
  bw_free(r->h);
  bw_free(r->gone.component);
  bw_release(r->gone.row);
  bw_free(r->gone.point);
  bw_free(r->gone.square);
  *r = (bwi_reduction){0};
}

void bwi_reduction_move(const bwi_reduction *r, double *force) {
  const bw_dof_map *dof_map = r->dof_map;
  for (int32_t i = 0; i < dof_map->mesh->node_count; i++) {
    if (!r->bond_of[i])
      continue;
    const bw_sparse_matrix *f = r->bond_of[i]->follows;
    const double *frame = frame_of(dof_map, i);
    double *at = force + 3 * (int64_t)i, moved[3] = {0};
    for (int k = 0; k < 3; k++) {
      double part = is_prescribed(dof_map, i, k) ? 0 : bw_dot(frame + 3 * k, at);
      for (int c = 0; c < 3; c++)
        moved[c] += part * frame[3 * k + c];
    }
    for (int64_t e = f->start[r->row_of[i]]; e < f->start[r->row_of[i] + 1]; e++)
      for (int c = 0; c < 3; c++)
        force[3 * (int64_t)f->column[e] + c] += f->value[e] * moved[c];
    for (int c = 0; c < 3; c++)
      at[c] -= moved[c];
  }
}

/* ---- T^T A T --------------------------------------------------------------------------------- */

/* Lower triangles of rows, summed in the order of the entries of T^T and of the pattern. */
typedef struct product {
  const bwi_reduction *reduction;
  const bw_block_pattern *pattern;
  const double *values;
  int block;
  double *sum;      /* threads x columns, 0 between rows */
  int32_t *touched; /* threads x columns */
  uint8_t *mark;    /* threads x columns, 0 between rows */
  int64_t *start;   /* of rows, or counts of them while `column` is NULL */
  int32_t *column;
  double *value;
} product;

enum { ROWS_PER_CHUNK = 128 };

typedef struct row_sum {
  double *sum;
  int32_t *touched, count, last;
  uint8_t *mark;
} row_sum;

/* sum += factor (component ci of row i of the block) T, from row `first` of T on */
static void add_block(const product *p, row_sum *s, const double *block, bool turned, int ci,
                      int64_t first, double factor) {
  const bw_sparse_matrix *t = p->reduction->t;
  for (int cj = 0; cj < 3; cj++) {
    double value = p->block == 1 ? (ci == cj ? block[0] : 0)
                   : turned      ? block[3 * cj + ci]
                                 : block[3 * ci + cj];
    if (value == 0 && !(p->reduction->with_zeros && (p->block == 9 || ci == cj)))
      continue;
    int64_t row = first + cj;
    for (int64_t e = t->start[row]; e < t->start[row + 1]; e++) {
      int32_t column = t->column[e];
      if (column > s->last)
        break;
      if (!s->mark[column]) {
        s->mark[column] = 1;
        s->touched[s->count++] = column;
      }
      s->sum[column] += factor * value * t->value[e];
    }
  }
}

static bw_status product_rows(void *data, int64_t begin, int64_t end, int worker) {
  const product *p = data;
  const bw_sparse_matrix *transposed = p->reduction->transposed;
  const bw_block_pattern *pattern = p->pattern;
  int64_t columns = p->reduction->unknown_count;
  int32_t size = 3 * p->reduction->dof_map->mesh->node_count;
  for (int64_t r = begin; r < end; r++) {
    row_sum s = {.sum = p->sum + worker * columns,
                 .touched = p->touched + worker * columns,
                 .mark = p->mark + worker * columns,
                 .last = (int32_t)r};
    for (int64_t e = transposed->start[r]; e < transposed->start[r + 1]; e++) {
      int32_t part = transposed->column[e] / size, i = transposed->column[e] % size / 3;
      int ci = transposed->column[e] % 3; /* size is a multiple of 3 */
      double factor = transposed->value[e];
      for (int64_t b = pattern->start[i]; b < pattern->start[i + 1]; b++)
        add_block(p, &s, p->values + p->block * b, false, ci,
                  3 * (int64_t)pattern->column[b] + (int64_t)part * size, factor);
      for (int64_t u = pattern->upper_start[i]; u < pattern->upper_start[i + 1]; u++)
        add_block(p, &s, p->values + p->block * bw_upper_block(pattern, u), true, ci,
                  3 * (int64_t)pattern->upper_row[u] + (int64_t)part * size, factor);
    }
    if (!p->column)
      p->start[r + 1] = s.count;
    for (int32_t k = 0; k < s.count; k++) {
      int32_t column = s.touched[k];
      if (p->column) {
        p->column[p->start[r] + k] = column;
        p->value[p->start[r] + k] = s.sum[column];
      }
      s.sum[column] = 0;
      s.mark[column] = 0;
    }
  }
  return BW_OK;
}

bw_status bwi_reduce_matrix(bw_context *context, const bwi_reduction *r,
                            const bw_block_pattern *pattern, const double *values, int block,
                            bw_sparse_matrix **reduced) {
  bw_status status = BW_OK;
  int64_t rows = r->unknown_count, size = rows * bw_threads(context);
  product p = {.reduction = r, .pattern = pattern, .values = values, .block = block};
  p.sum = BW_NEW0(context, double, size);
  p.touched = BW_NEW(context, int32_t, size);
  p.mark = BW_NEW0(context, uint8_t, size);
  p.start = BW_NEW0(context, int64_t, rows + 1);
  BW_TRY_MEMORY(p.sum && p.touched && p.mark && p.start);
  BW_TRY(bw_parallel(context, rows, ROWS_PER_CHUNK, product_rows, &p));
  for (int64_t i = 0; i < rows; i++)
    p.start[i + 1] += p.start[i];
  p.column = BW_NEW(context, int32_t, p.start[rows]);
  p.value = BW_NEW(context, double, p.start[rows]);
  BW_TRY_MEMORY(p.column && p.value);
  BW_TRY(bw_parallel(context, rows, ROWS_PER_CHUNK, product_rows, &p));
  BW_TRY(bwi_sparse_mirror(context, r->unknown_count, p.start, p.column, p.value, reduced));
done:
  bw_free(p.sum);
  bw_free(p.touched);
  bw_free(p.mark);
  bw_free(p.start);
  bw_free(p.column);
  bw_free(p.value);
  return status;
}
