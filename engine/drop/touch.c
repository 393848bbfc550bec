/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* The contact of a falling body (docs/theory/drop.md). What the modes leave of the compliance has
 * no mass: it gives S, and the forces of contact solve a complementarity problem in each step. They
 * are the derivatives of an energy of the position, which is why the energy is kept. */
#include <math.h>
#include <string.h>

#include "base/dense.h"
#include "contact/internal.h"
#include "drop/internal.h"
#include "linear/blas.h"

enum {
  BATCH = BWI_DROP_COLUMNS,
  TOGETHER = 8, /* solutions that take less than two of one do */
  MOST = 2000,
  POWER_STEPS = 30
};

/* Of the body's radius: by how much points may come nearer before all are looked at again. */
static const double travel = 0.02;
/* Of the compliance of a node: what the modes must leave. */
static const double least_left = 1e-6;
/* Cosine of the angle, 0.01 rad, within which a column's force is along the normal. */
static const double along_normal = 0.99995;
/* Of the largest diagonal entry: redundant candidates are singular. */
static const double shift = 1e-12;

/* ---- points ---------------------------------------------------------------------------------- */

static void add_areas(const bw_mesh *mesh, const int32_t *place, double *area) {
  static const double linear[3] = {1. / 3, 1. / 3, 1. / 3};
  static const double quadratic[6] = {1. / 12, 1. / 12, 1. / 12, 1. / 4, 1. / 4, 1. / 4};
  const double *part = mesh->order == 1 ? linear : quadratic; /* of the four triangles of a facet */
  for (int32_t f = 0; f < mesh->facet_count; f++) {
    const int32_t *node = mesh->facet + (size_t)f * (size_t)mesh->nodes_per_facet;
    const double *x[3];
    double a[3], b[3], normal[3];
    for (int k = 0; k < 3; k++)
      x[k] = mesh->node + 3 * (size_t)node[k];
    for (int k = 0; k < 3; k++) {
      a[k] = x[1][k] - x[0][k];
      b[k] = x[2][k] - x[0][k];
    }
    bw_cross(a, b, normal);
    for (int i = 0; i < mesh->nodes_per_facet; i++)
      for (int k = 0; k < 3; k++)
        area[3 * (int64_t)place[node[i]] + k] += 0.5 * part[i] * normal[k];
  }
}

bw_status bwi_drop_points_create(bw_context *context, bwi_drop_run *run) {
  bw_status status = BW_OK;
  const bw_mesh *mesh = run->model->mesh;
  bwi_drop_points *p = &run->points;
  int m = run->modes->count;
  int32_t *place = BW_NEW0(context, int32_t, mesh->node_count);
  p->count = mesh->boundary_node_count;
  p->node = BW_NEW(context, int32_t, p->count);
  p->at = BW_NEW(context, double, 3 * (int64_t)p->count);
  p->area = BW_NEW0(context, double, 3 * (int64_t)p->count);
  p->basis = BW_NEW(context, double, 3 * (int64_t)p->count * m);
  p->mode_size = BW_NEW0(context, double, m);
  BW_TRY_MEMORY(place && p->node && p->at && p->area && p->basis && p->mode_size);
  for (int32_t i = 0; i < p->count; i++) {
    int64_t node = mesh->boundary_node[i];
    double *at = p->at + 3 * (int64_t)i, *basis = p->basis + 3 * (int64_t)i * m;
    p->node[i] = (int32_t)node;
    place[node] = i;
    for (int k = 0; k < 3; k++)
      at[k] = mesh->node[3 * node + k] - run->origin[k];
    p->radius = fmax(p->radius, bw_norm(at));
    for (int j = 0; j < m; j++) {
      const double *shape = run->modes->shape + 3 * ((int64_t)j * mesh->node_count + node);
      for (int k = 0; k < 3; k++)
        basis[k * m + j] = shape[k];
      p->mode_size[j] = fmax(p->mode_size[j], bw_norm(shape));
    }
  }
  add_areas(mesh, place, p->area);
done:
  bw_free(place);
  return status;
}

void bwi_drop_points_clear(bwi_drop_points *p) {
  bw_free(p->node);
  bw_free(p->at);
  bw_free(p->area);
  bw_free(p->basis);
  bw_free(p->mode_size);
}

/* ---- positions ------------------------------------------------------------------------------- */

static void to_space(const double turn[9], const double body[3], double space[3]) {
  for (int i = 0; i < 3; i++)
    space[i] = bw_dot(turn + 3 * i, body);
}

static void to_body(const double turn[9], const double space[3], double body[3]) {
  for (int k = 0; k < 3; k++)
    body[k] = turn[k] * space[0] + turn[3 + k] * space[1] + turn[6 + k] * space[2];
}

static double rigid_gap_at(const bwi_drop_run *run, int32_t point) {
  const bwi_drop_motion *m = &run->motion;
  double arm[3], x[3], normal[3];
  to_space(m->turn, run->points.at + 3 * (int64_t)point, arm);
  for (int k = 0; k < 3; k++)
    x[k] = m->centre[k] + arm[k];
  return bwi_rigid_gap(&run->onto, x, normal);
}

/* The gap where the modes, and `more` in the body's frame (or NULL), bring a point. */
static double gap_at(const bwi_drop_run *run, int32_t point, const double *more, double normal[3],
                     double arm[3]) {
  const bwi_drop_motion *m = &run->motion;
  const double *at = run->points.at + 3 * (int64_t)point;
  const double *basis = run->points.basis + 3 * (int64_t)point * m->modes;
  double place[3], x[3];
  for (int k = 0; k < 3; k++)
    place[k] = at[k] + (more ? more[k] : 0) + bwi_dot(m->modes, basis + k * m->modes, m->q);
  to_space(m->turn, place, arm);
  for (int k = 0; k < 3; k++)
    x[k] = m->centre[k] + arm[k];
  return bwi_rigid_gap(&run->onto, x, normal);
}

double bwi_drop_rigid_gap(const bwi_drop_run *run) {
  double least = INFINITY;
  for (int32_t i = 0; i < run->points.count; i++)
    least = fmin(least, rigid_gap_at(run, i));
  return least;
}

double bwi_drop_plane_gap(const bwi_drop_run *run, const double normal[3]) {
  const bwi_drop_motion *m = &run->motion;
  double body[3], least = INFINITY, centre = -run->onto.radius; /* 0 of a plane */
  to_body(m->turn, normal, body);
  for (int k = 0; k < 3; k++)
    centre += normal[k] * (m->centre[k] - run->onto.point[k]);
  for (int32_t i = 0; i < run->points.count; i++)
    least = fmin(least, centre + bw_dot(body, run->points.at + 3 * (int64_t)i));
  return least;
}

double bwi_drop_reach(const bwi_drop_run *run) {
  double sum = 0;
  for (int k = 0; k < run->motion.modes; k++)
    sum += hypot(run->motion.q[k], run->motion.rate[k] / run->motion.omega[k]) *
           run->points.mode_size[k];
  for (int j = 0; j < run->touch.count; j++)
    sum += run->touch.force[j] * run->touch.size[j];
  return sum;
}

double bwi_drop_speed(const bwi_drop_run *run) {
  double spin[3];
  bwi_drop_spin(&run->motion, spin);
  return bw_norm(run->motion.velocity) + bw_norm(spin) * run->points.radius;
}

/* ---- candidates ------------------------------------------------------------------------------ */

bw_status bwi_drop_touch_create(bw_context *context, const bwi_drop_run *run,
                                bwi_drop_touch *touch) {
  bw_status status = BW_OK;
  memset(touch, 0, sizeof *touch);
  touch->limit = -1; /* all points are looked at first */
  touch->candidate = BW_NEW0(context, uint8_t, run->points.count);
  touch->near = BW_NEW(context, int32_t, run->points.count);
  BW_TRY_MEMORY(touch->candidate && touch->near);
done:
  return status;
}

void bwi_drop_touch_clear(bwi_drop_touch *t) {
  while (t->columns) {
    bwi_drop_columns *next = t->columns->next;
    bw_free(t->columns->field);
    bw_free(t->columns);
    t->columns = next;
  }
  void *all[] = {t->point, t->push,  t->column, t->size, t->s,      t->gap,       t->force,
                 t->w,     t->slack, t->normal, t->arm,  t->active, t->candidate, t->near};
  for (size_t i = 0; i < sizeof all / sizeof *all; i++)
    bw_free(all[i]);
  memset(t, 0, sizeof *t);
}

/* Room for more candidates; what is there stays. */
static bw_status grow(bw_context *context, bwi_drop_touch *t, int more) {
  bw_status status = BW_OK;
  int count = t->count + more;
  double *s = BW_NEW(context, double, (int64_t)count *count);
  BW_TRY_MEMORY(s);
  for (int i = 0; i < t->count; i++)
    memcpy(s + (size_t)i * (size_t)count, t->s + (size_t)i * (size_t)t->count,
           (size_t)t->count * sizeof *s);
  bw_free(t->s);
  t->s = s;
  if (count > t->capacity) {
    int capacity = 2 * count;
    struct {
      void **block;
      size_t size;
    } block[] = {{(void **)&t->point, sizeof *t->point},    {(void **)&t->push, 3 * sizeof(double)},
                 {(void **)&t->column, sizeof *t->column},  {(void **)&t->size, sizeof(double)},
                 {(void **)&t->gap, sizeof(double)},        {(void **)&t->force, sizeof(double)},
                 {(void **)&t->w, sizeof(double)},          {(void **)&t->slack, sizeof(double)},
                 {(void **)&t->normal, 3 * sizeof(double)}, {(void **)&t->arm, 3 * sizeof(double)},
                 {(void **)&t->active, sizeof *t->active}};
    for (size_t i = 0; i < sizeof block / sizeof *block; i++) {
      void *larger = bw_calloc(context, (size_t)capacity, block[i].size);
      BW_TRY_MEMORY(larger);
      if (t->count > 0)
        memcpy(larger, *block[i].block, (size_t)t->count * block[i].size);
      bw_free(*block[i].block);
      *block[i].block = larger;
    }
    t->capacity = capacity;
  }
done:
  return status;
}

/* The normal at a point, in the body's frame. */
static void push_at(const bwi_drop_run *run, int32_t point, double push[3]) {
  double normal[3], arm[3];
  gap_at(run, point, NULL, normal, arm);
  to_body(run->motion.turn, normal, push);
}

/* A block that has a column of the point for this force, and its number there; or NULL. */
static const bwi_drop_columns *find_column(const bwi_drop_touch *t, int32_t point,
                                           const double push[3], int *number) {
  for (const bwi_drop_columns *c = t->columns; c; c = c->next)
    for (int j = 0; j < c->count; j++)
      if (c->point[j] == point && bw_dot(c->push + 3 * j, push) > along_normal) {
        *number = j;
        return c;
      }
  return NULL;
}

/* Takes from displacements under unit forces what the modes have of them. */
static void leave_modes(const bwi_drop_run *run, bwi_drop_columns *c, double *weight) {
  int m = run->motion.modes, size = 3 * run->model->mesh->node_count;
  const double one = 1;
  for (int j = 0; j < c->count; j++) {
    const double *push = c->push + 3 * j;
    const double *basis = run->points.basis + 3 * (int64_t)c->point[j] * m;
    for (int k = 0; k < m; k++)
      weight[j * m + k] =
          -(push[0] * basis[k] + push[1] * basis[m + k] + push[2] * basis[2 * m + k]) /
          run->modes->eigenvalue[k];
  }
  bwi_blas_enter();
  dgemm_("N", "N", &size, &c->count, &m, &one, run->modes->shape, &size, weight, &m, &one, c->field,
         &size);
  bwi_blas_leave();
}

/* Columns of up to BATCH points. */
static bw_status solve_columns(bw_context *context, bwi_drop_run *run, int count,
                               const int32_t *point) {
  bw_status status = BW_OK;
  bwi_drop_touch *t = &run->touch;
  const bwi_drop_points *p = &run->points;
  int64_t size = 3 * (int64_t)run->model->mesh->node_count;
  bwi_drop_columns *c = BW_NEW0(context, bwi_drop_columns, 1);
  double *weight = BW_NEW(context, double, (int64_t)count * run->motion.modes);
  BW_TRY_MEMORY(c && weight);
  c->field = BW_NEW0(context, double, size *count);
  BW_TRY_MEMORY(c->field);
  c->count = count;
  for (int j = 0; j < count; j++) {
    c->point[j] = point[j];
    push_at(run, point[j], c->push + 3 * j);
    memcpy(c->field + j * size + 3 * (int64_t)p->node[point[j]], c->push + 3 * j,
           3 * sizeof(double));
  }
  BW_TRY(bw_system_solve(context, run->system, count, c->field, c->field));
  run->solves += count;
  for (int j = 0; j < count; j++)
    c->whole[j] = bw_dot(c->push + 3 * j, c->field + j * size + 3 * (int64_t)p->node[point[j]]);
  leave_modes(run, c, weight);
  for (int j = 0; j < count; j++)
    for (int32_t i = 0; i < p->count; i++)
      c->size[j] = fmax(c->size[j], bw_norm(c->field + j * size + 3 * (int64_t)p->node[i]));
  c->next = t->columns;
  t->columns = c;
  c = NULL;
done:
  if (c)
    bw_free(c->field);
  bw_free(c);
  bw_free(weight);
  return status;
}

/* The nearest points behind the `count` that have no column, until there are TOGETHER of them: the
 * next that touch are among these, most often. */
static int add_nearest(const bwi_drop_run *run, int count, int32_t *point) {
  const bwi_drop_touch *t = &run->touch;
  double gap[TOGETHER];
  int first = count, number;
  for (int32_t i = 0; i < t->near_count; i++) {
    double own = rigid_gap_at(run, t->near[i]), push[3];
    bool known = t->candidate[t->near[i]] || (count == TOGETHER && own >= gap[count - 1]);
    for (int j = 0; j < first; j++)
      known = known || point[j] == t->near[i];
    if (known)
      continue;
    push_at(run, t->near[i], push);
    if (find_column(t, t->near[i], push, &number))
      continue;
    int at = count < TOGETHER ? count++ : count - 1;
    for (; at > first && gap[at - 1] > own; at--) {
      gap[at] = gap[at - 1];
      point[at] = point[at - 1];
    }
    gap[at] = own;
    point[at] = t->near[i];
  }
  return count;
}

/* Columns of the first points that have none, of `count`, and of those nearest. */
static bw_status solve_next(bw_context *context, bwi_drop_run *run, int count,
                            const int32_t *point) {
  int32_t lacks[BATCH];
  int lacking = 0, number;
  for (int i = 0; i < count && lacking < BATCH; i++) {
    double push[3];
    push_at(run, point[i], push);
    if (!find_column(&run->touch, point[i], push, &number))
      lacks[lacking++] = point[i];
  }
  if (lacking < TOGETHER)
    lacking = add_nearest(run, lacking, lacks);
  bw_status status = bw_check_cancel(context);
  return status == BW_OK ? solve_columns(context, run, lacking, lacks) : status;
}

/* Rows and columns of S of the last `more` candidates. */
static void extend_compliance(bwi_drop_run *run, int more) {
  bwi_drop_touch *t = &run->touch;
  int n = t->count;
  for (int i = 0; i < n; i++)
    for (int j = n - more; j < n; j++) {
      double entry =
          bw_dot(t->push + 3 * i, t->column[j] + 3 * (int64_t)run->points.node[t->point[i]]);
      if (i >= n - more) /* symmetric but for rounding: the mean of both */
        entry = 0.5 * (entry + bw_dot(t->push + 3 * j,
                                      t->column[i] + 3 * (int64_t)run->points.node[t->point[j]]));
      t->s[(size_t)i * (size_t)n + (size_t)j] = entry;
      t->s[(size_t)j * (size_t)n + (size_t)i] = entry;
    }
}

/* The highest frequency of the rigid body and the modes on the contact of all candidates: the
 * largest eigenvalue of S^-1 B M^-1 B^T, by powers. Steps follow it. */
static bw_status find_stiffest(bw_context *context, bwi_drop_run *run) {
  bw_status status = BW_OK;
  bwi_drop_touch *t = &run->touch;
  const bwi_drop_motion *motion = &run->motion;
  int n = t->count, m = motion->modes, width = m + 6, info = 0;
  double largest = 0, root[9], *factor = BW_NEW(context, double, (int64_t)n *n);
  double *b = BW_NEW(context, double, (int64_t)n *width), *x = BW_NEW(context, double, n);
  double *y = BW_NEW(context, double, width);
  BW_TRY_MEMORY(factor && b && x && y);
  memcpy(factor, t->s, (size_t)n * (size_t)n * sizeof *factor);
  for (int i = 0; i < n; i++)
    largest = fmax(largest, t->s[(size_t)i * (size_t)n + (size_t)i]);
  for (int i = 0; i < n; i++)
    factor[(size_t)i * (size_t)n + (size_t)i] += shift * largest;
  bwi_blas_enter();
  dpotrf_("U", &n, factor, &n, &info);
  bwi_blas_leave();
  if (info != 0)
    BW_TRY(bw_fail(context, BW_SINGULAR,
                   "the compliance of %d nodes in contact is not positive definite: elements "
                   "almost without volume cause that. Mesh again",
                   n));
  memcpy(root, motion->inverse, sizeof root);
  bwi_cholesky(3, root, 0); /* I^-1 = L L^T */
  for (int i = 0; i < n; i++) {
    const double *push = t->push + 3 * i, *at = run->points.at + 3 * (int64_t)t->point[i];
    const double *basis = run->points.basis + 3 * (int64_t)t->point[i] * m;
    double *row = b + (int64_t)i * width, moment[3];
    for (int k = 0; k < m; k++)
      row[k] = push[0] * basis[k] + push[1] * basis[m + k] + push[2] * basis[2 * m + k];
    bw_cross(at, push, moment);
    for (int k = 0; k < 3; k++) {
      row[m + k] = push[k] / sqrt(motion->mass);
      row[m + 3 + k] = 0;
      for (int l = k; l < 3; l++)
        row[m + 3 + k] += root[3 * l + k] * moment[l];
    }
    x[i] = 1 + 0.3 * sin(i);
  }
  double square = 0;
  for (int step = 0; step < POWER_STEPS; step++) {
    double before = sqrt(bwi_dot(n, x, x));
    for (int i = 0; i < n; i++)
      x[i] /= before;
    memset(y, 0, (size_t)width * sizeof *y);
    for (int i = 0; i < n; i++)
      for (int k = 0; k < width; k++)
        y[k] += x[i] * b[(int64_t)i * width + k];
    for (int i = 0; i < n; i++)
      x[i] = bwi_dot(width, b + (int64_t)i * width, y);
    bwi_lower_solve(n, factor, x);
    bwi_upper_solve(n, factor, x);
    square = sqrt(bwi_dot(n, x, x));
  }
  t->stiffest = fmax(t->stiffest, sqrt(square));
  t->stiffest_of = n;
done:
  bw_free(factor);
  bw_free(b);
  bw_free(x);
  bw_free(y);
  return status;
}

static bw_status add_candidates(bw_context *context, bwi_drop_run *run, int more,
                                const int32_t *which) {
  bw_status status = BW_OK;
  bwi_drop_touch *t = &run->touch;
  int64_t size = 3 * (int64_t)run->model->mesh->node_count;
  if (t->count + more > MOST)
    return bw_fail(context, BW_LIMIT,
                   "more than %d nodes touch in one impact: mesh the faces that land coarser, or "
                   "tilt the body",
                   MOST);
  BW_TRY(grow(context, t, more));
  for (int j = 0; j < more; j++) {
    int c = t->count++, number = 0;
    double push[3];
    t->point[c] = which[j];
    t->slack[c] = run->slack;
    t->force[c] = 0;
    t->active[c] = 0;
    t->candidate[which[j]] = 1;
    push_at(run, which[j], push);
    const bwi_drop_columns *of;
    while (!(of = find_column(t, which[j], push, &number)))
      BW_TRY(solve_next(context, run, more - j, which + j));
    memcpy(t->push + 3 * c, of->push + 3 * number, sizeof push);
    t->column[c] = of->field + number * size;
    t->size[c] = of->size[number];
    double left = bw_dot(t->push + 3 * c, t->column[c] + 3 * (int64_t)run->points.node[which[j]]);
    if (!(left > least_left * of->whole[number]))
      BW_TRY(bw_fail(context, BW_INVALID,
                     "the %d modes leave nothing of the compliance of this mesh to the contact: "
                     "take fewer modes",
                     run->motion.modes));
  }
  extend_compliance(run, more);
  if (t->count >= 2 * t->stiffest_of)
    BW_TRY(find_stiffest(context, run));
done:
  return status;
}

/* ---- forces ---------------------------------------------------------------------------------- */

static void look_at_all(bwi_drop_run *run, double reach) {
  bwi_drop_touch *t = &run->touch;
  t->limit = 2 * reach + travel * run->points.radius;
  t->traveled = 0;
  t->near_count = 0;
  for (int32_t i = 0; i < run->points.count; i++)
    if (rigid_gap_at(run, i) < t->limit)
      t->near[t->near_count++] = i;
}

/* Points that penetrate, and those within the margin where one does: *more of them. */
static void find_others(const bwi_drop_run *run, double reach, int *more, int32_t *which) {
  const bwi_drop_touch *t = &run->touch;
  bool one = false;
  int count = 0;
  for (int32_t i = 0; i < t->near_count; i++) {
    int32_t point = t->near[i];
    double moved[3] = {0}, normal[3], arm[3];
    if (t->candidate[point] || rigid_gap_at(run, point) > reach + run->margin)
      continue;
    for (int j = 0; j < t->count; j++)
      for (int k = 0; t->force[j] > 0 && k < 3; k++)
        moved[k] += t->force[j] * t->column[j][3 * (int64_t)run->points.node[point] + k];
    double gap = gap_at(run, point, moved, normal, arm);
    one = one || gap < -run->slack;
    if (gap < run->margin)
      which[count++] = point;
  }
  *more = one ? count : 0;
}

static bw_status solve_forces(bw_context *context, bwi_drop_run *run) {
  bw_status status = BW_OK;
  bwi_drop_touch *t = &run->touch;
  bool negative = false;
  for (int j = 0; j < t->count; j++) {
    t->gap[j] = gap_at(run, t->point[j], NULL, t->normal + 3 * j, t->arm + 3 * j);
    negative = negative || t->gap[j] < -run->slack;
  }
  if (negative) {
    bwi_complementarity problem = {.count = t->count,
                                   .s = t->s,
                                   .q = t->gap,
                                   .e = t->gap, /* not read: there are no motions */
                                   .slack = t->slack,
                                   .active = t->active,
                                   .p = t->force,
                                   .w = t->w};
    BW_TRY(bwi_complementarity_solve(context, &problem));
  } else
    for (int j = 0; j < t->count; j++) {
      t->force[j] = 0;
      t->active[j] = 0;
    }
done:
  return status;
}

bw_status bwi_drop_touch_find(bw_context *context, bwi_drop_run *run) {
  bw_status status = BW_OK;
  bwi_drop_touch *t = &run->touch;
  int32_t *which = NULL;
  for (;;) {
    int more = 0;
    BW_TRY(solve_forces(context, run));
    double reach = bwi_drop_reach(run);
    if (reach + run->margin + t->traveled > t->limit)
      look_at_all(run, reach + run->margin);
    if (t->near_count > 0) {
      if (!which) {
        which = BW_NEW(context, int32_t, run->points.count);
        BW_TRY_MEMORY(which);
      }
      find_others(run, reach, &more, which);
    }
    if (more == 0)
      break;
    BW_TRY(add_candidates(context, run, more, which));
  }
done:
  bw_free(which);
  return status;
}

void bwi_drop_force(const bwi_drop_run *run, double force[3]) {
  const bwi_drop_touch *t = &run->touch;
  memset(force, 0, 3 * sizeof *force);
  for (int j = 0; j < t->count; j++)
    for (int k = 0; k < 3; k++)
      force[k] += t->force[j] * t->normal[3 * j + k];
}

double bwi_drop_turn(const bwi_drop_run *run) {
  const bwi_drop_touch *t = &run->touch;
  double most = 0;
  for (int j = 0; j < t->count; j++) {
    double push[3], square = 0;
    to_space(run->motion.turn, t->push + 3 * j, push);
    for (int k = 0; k < 3; k++)
      square += (push[k] - t->normal[3 * j + k]) * (push[k] - t->normal[3 * j + k]);
    if (t->force[j] > 0)
      most = fmax(most, 2 * asin(fmin(1, sqrt(square) / 2)));
  }
  return most;
}

void bwi_drop_kick(bwi_drop_run *run, double time) {
  const bwi_drop_touch *t = &run->touch;
  bwi_drop_motion *m = &run->motion;
  for (int j = 0; j < t->count; j++) {
    double impulse = time * t->force[j], moment[3], push[3];
    const double *normal = t->normal + 3 * j;
    const double *basis = run->points.basis + 3 * (int64_t)t->point[j] * m->modes;
    if (impulse == 0)
      continue;
    bw_cross(t->arm + 3 * j, normal, moment);
    to_body(m->turn, normal, push);
    for (int k = 0; k < 3; k++) {
      m->velocity[k] += impulse * normal[k] / m->mass;
      m->momentum[k] += impulse * moment[k];
      for (int l = 0; l < m->modes; l++)
        m->rate[l] += impulse * push[k] * basis[k * m->modes + l];
    }
  }
}
