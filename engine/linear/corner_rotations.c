/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* The coarse space of corners that rotate (corner_rotations.h). To the factor, rotations are nodes
 * of their own, numbered after all corners. */
#include "linear/corner_rotations.h"

#include <string.h>

#include "base/dense.h"

enum { CORNERS = 32, FIELDS = BWI_SMOOTHER_SIDES }; /* corners handed to a thread at once */

/* Of the mean diagonal entry of a corner's rotations, added to each of them. From 1e-10 to 1e-4 the
 * number of iterations is the same. */
#define STIFFEN 1e-5

struct bwi_corner_rotations {
  bw_object object;
  int32_t corners;
  double *arm;            /* rows of the smoother x 3: (x_b - x_a) / 4 */
  bw_dof_map dof_map;     /* of 2 x corners nodes: what the factor and its fields read of one */
  int32_t *unknown;       /* 2 x corners x 3: 0 where there is one, else -1 */
  bwi_rigid_space *rigid; /* of the corners; NULL where the supports leave no mode free */
  bwi_factor *factor;
  double *x; /* FIELDS x 2 x corners x 3 */
};

static void rotations_destroy(void *object) {
  bwi_corner_rotations *c = object;
  bw_release(c->factor);
  bw_release(c->rigid);
  bw_free(c->arm);
  bw_free(c->dof_map.frame_of);
  bw_free(c->dof_map.frame);
  bw_free(c->unknown);
  bw_free(c->x);
  bw_free(c);
}

static size_t rotations_bytes(const void *object) {
  const bwi_corner_rotations *c = object;
  size_t corners = (size_t)c->corners;
  return sizeof *c + bw_bytes(c->factor) + bw_bytes(c->rigid) +
         corners * ((9 + 3 + 6 * FIELDS) * sizeof(double) + 8 * sizeof(int32_t));
}

static const bw_kind rotations_kind = {"coarse space of corners that rotate", rotations_destroy,
                                       rotations_bytes};

/* ---- P^T K P --------------------------------------------------------------------------------- */

typedef struct galerkin {
  const bwi_two_level *l;
  const bwi_corner_rotations *c;
  const double *stiffness;
  const bw_block_pattern *pattern; /* of corners and rotations */
  const uint8_t *constrained;      /* by row of the smoother: has a prescribed component */
  double *value;                   /* block_count x 9 */
  int32_t *mark;                   /* workers x corners: place among the neighbours, or -1 */
  double *sum;                     /* workers x longest row x 36 */
  int64_t longest;
} galerkin;

/* The 3 x 3 block of nodes i (row) and j at their unknowns. */
static void block_at_unknowns(const galerkin *g, int32_t row, int32_t column, const double *stored,
                              bool across, double block[9]) {
  const bwi_smoother *s = g->l->smoother;
  for (int i = 0; i < 3; i++)
    for (int j = 0; j < 3; j++)
      block[3 * i + j] = stored[across ? 3 * j + i : 3 * i + j];
  if (g->constrained[column])
    for (int i = 0; i < 3; i++)
      bwi_project_unknowns(g->l->dof_map, s->node[column], block + 3 * i, block + 3 * i);
  if (g->constrained[row])
    for (int j = 0; j < 3; j++) {
      double side[3] = {block[j], block[3 + j], block[6 + j]};
      bwi_project_unknowns(g->l->dof_map, s->node[row], side, side);
      for (int i = 0; i < 3; i++)
        block[3 * i + j] = side[i];
    }
}

/* sums of the corner's row += its part of row k of P (`side`: of its two parents), transposed,
 * times a block of K, times P. */
static void add_block(const galerkin *g, int32_t k, int side, int32_t column, const double *block,
                      const int32_t *mark, double *sum) {
  const bwi_two_level *l = g->l;
  const double *arm = g->c->arm + 3 * (int64_t)k, *other = g->c->arm + 3 * (int64_t)column;
  double left[18], sign = side ? -1 : 1;
  for (int j = 0; j < 3; j++) { /* t / 2, and sign w x arm: its transpose is arm x u */
    const double u[3] = {block[j], block[3 + j], block[6 + j]};
    double turn[3];
    bw_cross(arm, u, turn);
    for (int i = 0; i < 3; i++) {
      left[3 * i + j] = 0.5 * u[i];
      left[9 + 3 * i + j] = sign * turn[i];
    }
  }
  for (int to = 0; to < 2; to++) {
    double *at = sum + 36 * (int64_t)mark[l->parent[2 * (int64_t)column + to]];
    double towards = to ? -1 : 1;
    for (int i = 0; i < 6; i++) {
      double turn[3];
      bw_cross(other, left + 3 * i, turn);
      for (int j = 0; j < 3; j++) {
        at[6 * i + j] += 0.5 * left[3 * i + j];
        at[6 * i + 3 + j] += towards * turn[j];
      }
    }
  }
}

/* All 6 x 6 blocks of a corner's row. */
static void sum_row(const galerkin *g, int32_t corner, const int32_t *mark, double *sum) {
  const bwi_two_level *l = g->l;
  const bwi_smoother *s = l->smoother;
  const bw_block_pattern *fine = s->pattern;
  for (int64_t at = l->child_start[corner]; at < l->child_start[corner + 1]; at++) {
    int32_t k = l->child[at], i = s->node[k];
    int side = l->parent[2 * (int64_t)k] != corner; /* itself is listed twice, with no arm */
    double block[9];
    for (int64_t p = fine->start[i]; p < fine->start[i + 1]; p++) {
      int32_t column = s->row_of[fine->column[p]];
      block_at_unknowns(g, k, column, g->stiffness + 9 * p, false, block);
      add_block(g, k, side, column, block, mark, sum);
    }
    for (int64_t u = fine->upper_start[i]; u < fine->upper_start[i + 1]; u++) {
      int32_t column = s->row_of[fine->upper_row[u]];
      block_at_unknowns(g, k, column, g->stiffness + 9 * bw_upper_block(fine, u), true, block);
      add_block(g, k, side, column, block, mark, sum);
    }
  }
}

/* The block of one kind, 0 displacements and 1 rotations, with another. */
static void store(const double *sum, int kind, int with, double *block) {
  for (int i = 0; i < 3; i++)
    for (int j = 0; j < 3; j++)
      block[3 * i + j] = sum[6 * (3 * kind + i) + 3 * with + j];
}

static bw_status make_rows(void *data, int64_t begin, int64_t end, int worker) {
  const galerkin *g = data;
  const bw_block_pattern *pattern = g->pattern;
  int32_t corners = g->c->corners;
  int32_t *mark = g->mark + (int64_t)worker * corners;
  double *sum = g->sum + 36 * worker * g->longest;
  for (int64_t c = begin; c < end; c++) {
    int64_t row = c + corners; /* it has all neighbours' displacements, then rotations below it */
    int32_t count = 0;
    for (int64_t p = pattern->start[row]; pattern->column[p] < corners; p++)
      mark[pattern->column[p]] = count++;
    memset(sum, 0, 36 * (size_t)count * sizeof *sum);
    sum_row(g, (int32_t)c, mark, sum);
    for (int64_t p = pattern->start[c]; p < pattern->start[c + 1]; p++)
      store(sum + 36 * (int64_t)mark[pattern->column[p]], 0, 0, g->value + 9 * p);
    for (int64_t p = pattern->start[row]; p < pattern->start[row + 1]; p++) {
      int32_t column = pattern->column[p];
      int with = column >= corners;
      store(sum + 36 * (int64_t)mark[column - with * corners], 1, with, g->value + 9 * p);
    }
    double *own = g->value + 9 * (pattern->start[row + 1] - 1);
    double trace = own[0] + own[4] + own[8];
    for (int i = 0; i < 9; i += 4) /* no unknown around it: any number */
      own[i] += trace > 0 ? STIFFEN / 3 * trace : 1;
  }
  return BW_OK;
}

static bw_status multiply(bw_context *context, galerkin *g) {
  bw_status status = BW_OK;
  const bwi_two_level *l = g->l;
  int32_t corners = g->c->corners;
  int workers = bw_threads(context);
  uint8_t *constrained = BW_NEW0(context, uint8_t, l->smoother->count);
  for (int64_t c = 0; c < corners; c++) {
    int64_t length = g->pattern->start[c + corners + 1] - g->pattern->start[c + corners];
    g->longest = length > g->longest ? length : g->longest;
  }
  g->mark = BW_NEW(context, int32_t, (int64_t)workers * corners);
  g->sum = BW_NEW(context, double, 36 * workers * g->longest);
  BW_TRY_MEMORY(constrained && g->mark && g->sum);
  for (int32_t h = 0; h < l->constrained_count; h++)
    constrained[l->constrained[h]] = 1;
  g->constrained = constrained;
  status = bw_parallel(context, corners, CORNERS, make_rows, g);
done:
  bw_free(constrained);
  bw_free(g->mark);
  bw_free(g->sum);
  return status;
}

/* ---- unknowns -------------------------------------------------------------------------------- */

static bw_status set_arms(bw_context *context, bwi_corner_rotations *c, const bwi_two_level *l,
                          const bw_mesh *mesh) {
  const int32_t *corner_node = bwi_coarse_nodes(l->coarse);
  c->arm = BW_NEW(context, double, 3 * (int64_t)l->smoother->count);
  if (!c->arm)
    return BW_MEMORY;
  for (int64_t k = 0; k < l->smoother->count; k++) {
    const double *a = mesh->node + 3 * (int64_t)corner_node[l->parent[2 * k]];
    const double *b = mesh->node + 3 * (int64_t)corner_node[l->parent[2 * k + 1]];
    for (int d = 0; d < 3; d++)
      c->arm[3 * k + d] = 0.25 * (b[d] - a[d]);
  }
  return BW_OK;
}

/* Displacements of corners in their frames, isostatic constraints among them, and all rotations. */
static bw_status number(bw_context *context, bwi_corner_rotations *c, const bwi_two_level *l) {
  c->dof_map.frame_of = BW_NEW(context, int32_t, 2 * (int64_t)c->corners);
  c->dof_map.frame = BW_NEW0(context, double, 9 * (int64_t)c->corners);
  c->unknown = BW_NEW0(context, int32_t, 6 * (int64_t)c->corners);
  if (!c->dof_map.frame_of || !c->dof_map.frame || !c->unknown)
    return BW_MEMORY;
  bwi_coarse_supports(l->coarse, l->dof_map, &c->dof_map, c->unknown);
  for (int64_t k = 0; k < c->corners; k++)
    c->dof_map.frame_of[c->corners + k] = -1;
  return bwi_coarse_constrain(context, l->coarse, l->dof_map, NULL, c->unknown, &c->rigid);
}

static bw_status make_pattern(bw_context *context, const bwi_corner_rotations *c,
                              const bwi_two_level *l, const bw_mesh *mesh,
                              bw_block_pattern **pattern) {
  const int32_t *parent = bwi_coarse_parents(l->coarse);
  int32_t *element = BW_NEW(context, int32_t, 8 * (int64_t)mesh->element_count);
  if (!element)
    return BW_MEMORY;
  for (int64_t e = 0; e < mesh->element_count; e++)
    for (int a = 0; a < 4; a++) {
      int32_t k = parent[2 * (int64_t)mesh->element[10 * e + a]];
      element[8 * e + a] = k;
      element[8 * e + 4 + a] = c->corners + k;
    }
  bw_status status = bw_block_pattern_of_elements(context, 2 * c->corners, mesh->element_count, 8,
                                                  element, pattern);
  bw_free(element);
  return status;
}

/* ---- factor ---------------------------------------------------------------------------------- */

/* x = A^-1 x, of bodies that can move freely with the projector, for `count` fields. */
static bw_status solve(bw_context *context, const void *data, int64_t count, double *x) {
  bw_status status = BW_OK;
  const bwi_corner_rotations *c = data;
  const bwi_field_layout layout = {3, 1, 6 * (int64_t)c->corners};
  if (c->rigid)
    BW_TRY(bwi_rigid_space_project(context, c->rigid, &layout, (int)count, x));
  BW_TRY(bwi_solve_fields(context, c->factor, &c->dof_map, count, x, x));
  if (c->rigid)
    BW_TRY(bwi_rigid_space_project(context, c->rigid, &layout, (int)count, x));
done:
  return status;
}

/* Thin and free bodies lose some digits in single precision. The load is at displacements. */
static bw_status is_exact_enough(bw_context *context, const bwi_corner_rotations *c,
                                 const bwi_matrix *matrix, bool *enough) {
  double *load = BW_NEW0(context, double, 6 * (int64_t)c->corners);
  bw_random random;
  bw_random_seed(&random, 1);
  if (!load)
    return BW_MEMORY;
  for (int64_t i = 0; i < 3 * (int64_t)c->corners; i++)
    if (c->unknown[i] >= 0)
      load[i] = 2 * bw_random_uniform(&random) - 1;
  bw_status status =
      bwi_coarse_check_digits(context, matrix->pattern, matrix->stiffness, solve, c, load, enough);
  bw_free(load);
  return status;
}

static bw_status factor(bw_context *context, bwi_corner_rotations *c, bwi_symbolic *symbolic,
                        const bwi_matrix *matrix) {
  bw_status status = BW_OK;
  const bwi_kernels *const kernels[2] = {&bwi_kernels_single, &bwi_kernels_double};
  bool enough = false;
  for (int k = 0; k < 2 && status == BW_OK && !enough; k++) {
    bw_release(c->factor);
    c->factor = NULL;
    status = bwi_factor_create_in(context, symbolic, matrix, NULL, kernels[k], &c->factor, NULL);
    enough = k == 1;
    if (status == BW_OK && !enough)
      status = is_exact_enough(context, c, matrix, &enough);
    if (status == BW_SINGULAR && k == 0) {
      bw_clear_failure(context);
      status = BW_OK;
    }
  }
  return status;
}

bw_status bwi_corner_rotations_create(bw_context *context, const bwi_two_level *l,
                                      const bw_mesh *mesh, const double *stiffness,
                                      bwi_corner_rotations **out) {
  bw_status status = BW_OK;
  bw_block_pattern *pattern = NULL;
  bwi_order *order = NULL;
  bwi_symbolic *symbolic = NULL;
  double *value = NULL;
  bwi_corner_rotations *c = BW_NEW0(context, bwi_corner_rotations, 1);
  *out = NULL;
  if (!c)
    return BW_MEMORY;
  bw_object_init(c, &rotations_kind);
  c->corners = bwi_coarse_corners(l->coarse);
  c->x = BW_NEW(context, double, 6 * FIELDS * (int64_t)c->corners);
  BW_TRY_MEMORY(c->x);
  BW_TRY(set_arms(context, c, l, mesh));
  BW_TRY(number(context, c, l));
  BW_TRY(make_pattern(context, c, l, mesh, &pattern));
  BW_TRY(bwi_order_create(context, pattern, NULL, &order));
  BW_TRY(bwi_symbolic_create(context, order, 3, c->unknown, &symbolic));
  value = BW_NEW(context, double, 9 * pattern->block_count);
  BW_TRY_MEMORY(value);
  galerkin g = {.l = l, .c = c, .stiffness = stiffness, .pattern = pattern, .value = value};
  BW_TRY(multiply(context, &g));
  const bwi_matrix matrix = {.pattern = pattern, .stiffness = value, .dof_map = &c->dof_map};
  status = factor(context, c, symbolic, &matrix);
  if (status == BW_OK) {
    *out = bw_retain(c);
  } else if (status == BW_SINGULAR) {
    bw_clear_failure(context);
    status = BW_OK;
  }
done:
  bw_free(value);
  bw_release(pattern);
  bw_release(order);
  bw_release(symbolic);
  bw_release(c);
  return status;
}

/* ---- correction ------------------------------------------------------------------------------ */

typedef struct passage {
  const bwi_two_level *l;
  const bwi_corner_rotations *c;
  int width, used;
  double unit; /* of the corners' equations over those of the rows */
} passage;

static bw_status restrict_residual(void *data, int64_t begin, int64_t end, int worker) {
  (void)worker;
  const passage *m = data;
  const bwi_two_level *l = m->l;
  for (int64_t corner = begin; corner < end; corner++)
    for (int f = 0; f < m->used; f++) {
      double force[3] = {0, 0, 0}, moment[3] = {0, 0, 0};
      for (int64_t at = l->child_start[corner]; at < l->child_start[corner + 1]; at++) {
        int64_t k = l->child[at];
        const float *r = l->residual + 3 * m->width * k + f;
        const double u[3] = {r[0], r[m->width], r[2 * m->width]};
        double turn[3], sign = l->parent[2 * k] == corner ? 1 : -1;
        bw_cross(m->c->arm + 3 * k, u, turn);
        for (int d = 0; d < 3; d++) {
          force[d] += 0.5 * u[d];
          moment[d] += sign * turn[d];
        }
      }
      double *x = m->c->x + 6 * (int64_t)m->c->corners * f + 3 * corner;
      for (int d = 0; d < 3; d++) {
        x[d] = m->unit * force[d];
        x[3 * (int64_t)m->c->corners + d] = m->unit * moment[d];
      }
    }
  return BW_OK;
}

static bw_status prolong(void *data, int64_t begin, int64_t end, int worker) {
  (void)worker;
  const passage *m = data;
  const bwi_two_level *l = m->l;
  int64_t corners = m->c->corners;
  for (int64_t k = begin; k < end; k++)
    for (int f = 0; f < m->used; f++) {
      const double *x = m->c->x + 6 * corners * f;
      const double *a = x + 3 * (int64_t)l->parent[2 * k],
                   *b = x + 3 * (int64_t)l->parent[2 * k + 1];
      double difference[3], turn[3];
      for (int d = 0; d < 3; d++)
        difference[d] = a[3 * corners + d] - b[3 * corners + d];
      bw_cross(difference, m->c->arm + 3 * k, turn);
      for (int d = 0; d < 3; d++)
        l->z[(3 * k + d) * m->width + f] += (float)(0.5 * (a[d] + b[d]) + turn[d]);
    }
  return BW_OK;
}

bw_status bwi_corner_rotations_correct(bw_context *context, const bwi_corner_rotations *c,
                                       const bwi_two_level *l, int width, int used) {
  bw_status status = BW_OK;
  passage m = {l, c, width, used, 1 / l->smoother->unit};
  BW_TRY(bw_parallel(context, c->corners, BWI_SMOOTHER_ROWS, restrict_residual, &m));
  BW_TRY(solve(context, c, used, c->x));
  BW_TRY(bw_parallel(context, l->smoother->count, BWI_SMOOTHER_ROWS, prolong, &m));
done:
  return status;
}

double bwi_corner_rotations_read(const bwi_corner_rotations *c) {
  return 2 * (double)bwi_factor_bytes(c->factor);
}
