/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* Bodies in contact under many loads: the compliance of all candidates, from which a load takes two
 * solutions and a state of contact is a linear system (docs/theory/worst_case.md, section 17).
 *
 * Invariant: no rigid-body motion is free, so that S = B G B^T and any load have one solution. */
#include <math.h>
#include <string.h>

#include "barwright/joint.h"
#include "base/dense.h"
#include "contact/internal.h"
#include "linear/blas.h"
#include "linear/internal.h"
#include "model/internal.h"

enum { MOST_CANDIDATES = 8000 /* a dense matrix */ };

static const double constrained =
    1e-8; /* of the compliance of a free surface: supports constrain it */
static const double rounding = 1e-12;  /* of the diagonal of the mesh */
static const double redundant = 1e-11; /* of a candidate's compliance: what others leave of it */
static const double no_gap = 1e-8; /* of the largest mean gap without contact: penetration that is
                                      none */

static void contact_system_destroy(void *object) {
  bw_contact_system *c = object;
  bwi_contact_pairs_release(c->pair_count, c->pair);
  if (c->rows)
    bwi_contact_rows_clear(c->rows);
  bw_free(c->rows);
  bw_free(c->row);
  bw_free(c->gap);
  bw_free(c->s);
  bw_release(c->cuts);
  bw_release(c->system);
  bw_release(c->model);
  bw_free(c);
}

static size_t contact_system_bytes(const void *object) {
  const bw_contact_system *c = object;
  size_t count = (size_t)c->count;
  return sizeof *c + count * (count + 1) * sizeof(double) +
         (size_t)c->rows->point_count * sizeof *c->rows->point;
}

static const bw_kind contact_system_kind = {"contact system", contact_system_destroy,
                                            contact_system_bytes};

/* ---- what is refused ------------------------------------------------------------------------- */

static bw_status check_pairs(bw_context *context, int pair_count, const bw_contact_pair *pair) {
  for (int i = 0; i < pair_count; i++) {
    if (pair[i].friction != 0)
      return bw_fail(context, BW_UNSUPPORTED,
                     "contact pair %d has friction: under many loads contact is without, as the "
                     "answer would depend on the order of the loads",
                     i + 1);
    if (pair[i].with && pair[i].with->kind != BW_RIGID_PLANE)
      return bw_fail(context, BW_UNSUPPORTED,
                     "contact pair %d is with a curved rigid surface: under many loads contact is "
                     "with planes, or between parts of the mesh",
                     i + 1);
  }
  return BW_OK;
}

static bw_status check_solver(bw_context *context, const bw_solver *solver) {
  if (!solver || solver->options.kind == BW_SOLVER_CHOLESKY)
    return BW_OK;
  return bw_fail(context, BW_UNSUPPORTED,
                 "contact under many loads is solved by a factor, not by \"%s\": leave the solver "
                 "out, or give cholesky",
                 bw_solver_word(solver->options.kind));
}

static bw_status check_motions(bw_context *context, const bw_dof_map *dof_map) {
  bw_status status = BW_OK;
  char text[300];
  double *a = NULL;
  if (dof_map->prescribed)
    return bw_fail(context, BW_UNSUPPORTED,
                   "a support prescribes a displacement that is not zero: contact under many loads "
                   "is with fixed supports only");
  if (dof_map->rigid_mode_count == 0)
    return BW_OK;
  a = BW_NEW0(context, double, dof_map->rigid_mode_count);
  BW_TRY_MEMORY(a);
  a[0] = 1;
  bwi_describe_motion(dof_map, a, text, sizeof text);
  bw_fail(context, BW_UNCONSTRAINED,
          "contact alone constrains a body, which is free in the %s, one of %d such motions: no "
          "load that opens the contact is in balance. Support each body, or bond it to one that is",
          text, dof_map->rigid_mode_count);
  bw_detail_text(context, "motion", text);
  status = BW_UNCONSTRAINED;
done:
  bw_free(a);
  return status;
}

/* ---- the surface that contact covers --------------------------------------------------------- */

/* Facets that face over more than half of their area what they may touch, nearer than their size:
 * no load from outside reaches there. */
static bw_status find_cuts(bw_context *context, bw_contact_system *c) {
  bw_status status = BW_OK;
  const bw_mesh *mesh = c->model->mesh;
  const double centre[3] = {1. / 3, 1. / 3, 1. / 3};
  bool any = false;
  double *faced = BW_NEW0(context, double, mesh->facet_count);
  uint8_t *mask = BW_NEW0(context, uint8_t, mesh->facet_count);
  BW_TRY_MEMORY(faced && mask);
  for (int64_t p = 0; p < c->rows->point_count; p++) {
    const bwi_contact_point *point = &c->rows->point[p];
    double normal[3];
    bwi_boundary_normal(mesh, point->facet, centre, normal);
    if (point->gap + c->pair[point->pair].interference > sqrt(bw_norm(normal) / 2))
      continue;
    faced[point->facet] += point->area;
    if (point->opposite >= 0)
      faced[point->opposite] += point->area;
  }
  for (int32_t f = 0; f < mesh->facet_count; f++) {
    double normal[3];
    bwi_boundary_normal(mesh, f, centre, normal);
    mask[f] = faced[f] > bw_norm(normal) / 4;
    any = any || mask[f];
  }
  if (any)
    BW_TRY(bw_select_mask(context, mesh, mask, NULL, &c->cuts));
done:
  bw_free(faced);
  bw_free(mask);
  return status;
}

/* ---- candidates ------------------------------------------------------------------------------ */

/* Leaves out candidates that supports keep from moving. */
static void leave_out_constrained(bw_contact_system *c) {
  double young = bw_material_of(c->model->material, 0)->elasticity[0];
  int kept = 0, count = c->count;
  int32_t *place = c->row; /* of a kept one among all, which comes no later */
  for (int k = 0; k < count; k++) {
    double area = c->rows->area[c->row[k]];
    if (!(c->s[(size_t)k * (size_t)count + (size_t)k] > constrained * area * sqrt(area) / young))
      continue;
    for (int l = 0; l < count; l++) /* row k takes the place of row `kept` */
      c->s[(size_t)kept * (size_t)count + (size_t)l] = c->s[(size_t)k * (size_t)count + (size_t)l];
    for (int l = 0; l < count; l++)
      c->s[(size_t)l * (size_t)count + (size_t)kept] = c->s[(size_t)l * (size_t)count + (size_t)k];
    c->gap[kept] = c->gap[k];
    place[kept++] = c->row[k];
  }
  for (int k = 0; k < kept; k++)
    memmove(c->s + (size_t)k * (size_t)kept, c->s + (size_t)k * (size_t)count,
            (size_t)kept * sizeof *c->s);
  c->count = kept;
}

static bw_status find_candidates(bw_context *context, bw_contact_system *c) {
  bw_status status = BW_OK;
  const bw_mesh *mesh = c->model->mesh;
  double min[3], max[3], *gap = NULL;
  double *none = BW_NEW0(context, double, 3 * (int64_t)mesh->node_count);
  bw_mesh_box(mesh, min, max);
  for (int k = 0; k < 3; k++)
    max[k] -= min[k];
  c->rows = BW_NEW0(context, bwi_contact_rows, 1);
  BW_TRY_MEMORY(c->rows && none);
  BW_TRY(bwi_contact_rows_create(context, c->model, c->pair_count, c->pair, false, c->rows));
  gap = BW_NEW(context, double, c->rows->row_count);
  c->row = BW_NEW(context, int32_t, c->rows->row_count);
  c->gap = BW_NEW(context, double, c->rows->row_count);
  BW_TRY_MEMORY(gap && c->row && c->gap);
  BW_TRY(bwi_contact_rows_linearise(context, c->rows, none, gap));
  for (int i = 0; i < c->rows->count; i++) {
    double area = c->rows->area[i];
    if (!(area > 0))
      continue;
    c->row[c->count] = i;
    c->gap[c->count++] = fabs(gap[i]) <= rounding * bw_norm(max) * area ? 0 : gap[i];
  }
  if (c->count > MOST_CANDIDATES)
    BW_TRY(bw_fail(context, BW_LIMIT,
                   "the contact pairs have %d corners, and contact under many loads takes at most "
                   "%d: select fewer facets, or make the mesh coarser there",
                   c->count, (int)MOST_CANDIDATES));
  c->s = BW_NEW(context, double, (int64_t)c->count * c->count);
  BW_TRY_MEMORY(c->s);
  bw_progress(context, "contact", 0);
  BW_TRY(bwi_contact_rows_compliance(context, c->rows, c->system, c->count, c->row, 0, NULL, c->s));
  leave_out_constrained(c);
  if (c->count == 0)
    BW_TRY(bw_fail(context, BW_INVALID,
                   "supports constrain all corners of the contact pairs: leave the pairs out"));
  for (int k = 0; k < c->count; k++)
    c->closed = c->closed && c->gap[k] == 0;
done:
  bw_free(none);
  bw_free(gap);
  return status;
}

bw_status bw_contact_system_create(bw_context *context, const bw_model *model, int pair_count,
                                   const bw_contact_pair *pair, const bw_solver *solver,
                                   bw_system *given, bw_contact_system **out) {
  bw_status status = BW_OK;
  bw_contact_system *c = NULL;
  BW_TRY(check_pairs(context, pair_count, pair));
  BW_TRY(check_solver(context, solver));
  c = BW_NEW0(context, bw_contact_system, 1);
  BW_TRY_MEMORY(c);
  bw_object_init(c, &contact_system_kind);
  c->model = bw_retain(model);
  c->closed = true;
  c->pair = BW_NEW0(context, bw_contact_pair, pair_count);
  BW_TRY_MEMORY(c->pair);
  c->pair_count = pair_count;
  bwi_contact_pairs_retain(pair_count, pair, c->pair);
  if (model->bond_count + model->attachment_count + model->coupling_count > 0 || model->cyclic)
    BW_TRY(bw_joined_system(context, model, solver, &c->system));
  else
    BW_TRY(bw_system_of_model(context, model, solver, given, &c->system));
  if (c->system->iterative) /* its tolerance would have no bound in the results */
    BW_TRY(bw_system_factor(context, c->system));
  BW_TRY(check_motions(context, c->system->dof_map));
  BW_TRY(find_candidates(context, c));
  BW_TRY(find_cuts(context, c));
  *out = c;
done:
  if (status != BW_OK)
    bw_release(c);
  return status;
}

/* ---- one load -------------------------------------------------------------------------------- */

/* q (count) of a field without contact: its gaps. */
static void measure(const bw_contact_system *c, const double *u, double *all, double *q) {
  bwi_contact_rows_measure(c->rows, u, all);
  for (int k = 0; k < c->count; k++)
    q[k] = all[c->row[k]];
}

/* The forces of pressures p (count) of either sign. */
static void press(const bw_contact_system *c, const double *p, double *force) {
  const bwi_contact_rows *rows = c->rows;
  memset(force, 0, 3 * (size_t)rows->mesh->node_count * sizeof *force);
  for (int i = 0; i < c->count; i++)
    for (int64_t k = rows->start[c->row[i]]; k < rows->start[c->row[i] + 1]; k++)
      for (int l = 0; l < 3; l++)
        force[3 * (int64_t)rows->column[k] + l] += p[i] * rows->value[3 * k + l];
}

/* Memory for one load. */
typedef struct touch {
  double *all;               /* (rows) */
  double *q, *p, *w;         /* (count) */
  double *sq, *sp, *sw, *ss; /* the same of the working set, and its part of S (count x count) */
  double *slack;             /* (count) of the working set */
  int32_t *member;           /* (count) the working set, */
  uint8_t *inside, *active;  /* (count) and who is in it; of its members */
} touch;

static void touch_close(touch *t) {
  bw_free(t->all);
  bw_free(t->q);
  bw_free(t->ss);
  bw_free(t->member);
  bw_free(t->inside);
}

static bw_status touch_open(bw_context *context, const bw_contact_system *c, touch *t) {
  bw_status status = BW_OK;
  int64_t n = c->count;
  t->all = BW_NEW(context, double, c->rows->row_count);
  t->q = BW_NEW(context, double, 7 * n);
  t->ss = BW_NEW(context, double, n *n);
  t->member = BW_NEW(context, int32_t, n);
  t->inside = BW_NEW(context, uint8_t, 2 * n);
  BW_TRY_MEMORY(t->all && t->q && t->ss && t->member && t->inside);
  t->p = t->q + n;
  t->w = t->q + 2 * n;
  t->sq = t->q + 3 * n;
  t->sp = t->q + 4 * n;
  t->sw = t->q + 5 * n;
  t->slack = t->q + 6 * n;
  t->active = t->inside + n;
done:
  return status;
}

/* Takes candidates whose gap is negative into the working set of n. Whether there are any. */
static bool grow(const bw_contact_system *c, touch *t, double slack, int *n) {
  int before = *n;
  for (int k = 0; k < c->count; k++) {
    if (t->inside[k] || !(-t->w[k] / c->rows->area[c->row[k]] > slack))
      continue;
    t->inside[k] = 1;
    t->active[*n] = 1;
    t->member[(*n)++] = k;
  }
  return *n > before;
}

/* Pressures p of gaps q, on a working set: it begins with the gaps that are negative, and grows by
 * those that the pressures make so. */
static bw_status close_gaps(bw_context *context, const bw_contact_system *c, touch *t) {
  bw_status status = BW_OK;
  const size_t all = (size_t)c->count;
  double largest = 0, none = 0;
  int n = 0;
  memset(t->inside, 0, all);
  memset(t->p, 0, all * sizeof *t->p);
  for (int k = 0; k < c->count; k++)
    largest = fmax(largest, fabs(t->q[k]) / c->rows->area[c->row[k]]);
  memcpy(t->w, t->q, all * sizeof *t->w);
  while (grow(c, t, no_gap * largest, &n)) {
    for (int i = 0; i < n; i++) {
      const double *row = c->s + (size_t)t->member[i] * all;
      for (int j = 0; j < n; j++)
        t->ss[(size_t)i * (size_t)n + (size_t)j] = row[t->member[j]];
      t->sq[i] = t->q[t->member[i]];
      t->sp[i] = 0;
      t->slack[i] = 0.1 * no_gap * largest * c->rows->area[c->row[t->member[i]]];
    }
    bwi_complementarity problem = {.count = n,
                                   .s = t->ss,
                                   .q = t->sq,
                                   .e = &none,
                                   .load = &none,
                                   .centre = &none,
                                   .slack = t->slack,
                                   .active = t->active,
                                   .p = t->sp,
                                   .w = t->sw,
                                   .a = &none,
                                   .h = &none};
    BW_TRY(bwi_complementarity_solve(context, &problem));
    memset(t->p, 0, all * sizeof *t->p);
    for (int i = 0; i < n; i++)
      t->p[t->member[i]] = t->sp[i];
    for (int k = 0; k < c->count; k++)
      t->w[k] = t->q[k] + bwi_dot(c->count, c->s + (size_t)k * all, t->p);
  }
done:
  return status;
}

bw_status bw_contact_system_solve(bw_context *context, const bw_contact_system *c, int count,
                                  const double *force, double *displacement, uint8_t *state) {
  bw_status status = BW_OK;
  int64_t size = 3 * (int64_t)c->model->mesh->node_count, n = c->count;
  touch t = {0};
  double *pressed = BW_NEW(context, double, count *size);
  BW_TRY_MEMORY(pressed);
  BW_TRY(touch_open(context, c, &t));
  BW_TRY(bw_system_solve(context, c->system, count, force, displacement));
  for (int i = 0; i < count; i++) {
    BW_TRY(bw_check_cancel(context));
    measure(c, displacement + i * size, t.all, t.q);
    for (int64_t k = 0; k < n; k++)
      t.q[k] += c->gap[k];
    BW_TRY(close_gaps(context, c, &t));
    for (int64_t k = 0; state && k < n; k++)
      state[i * n + k] = t.p[k] > 0;
    press(c, t.p, pressed + i * size);
  }
  BW_TRY(bw_system_solve(context, c->system, count, pressed, pressed));
  for (int64_t i = 0; i < count * size; i++)
    displacement[i] += pressed[i];
done:
  touch_close(&t);
  bw_free(pressed);
  return status;
}

/* ---- a state as a linear system -------------------------------------------------------------- */

typedef struct one_state {
  bw_contact_system *c;
  int count;
  int32_t *member; /* (count) candidates that are closed */
  double *factor;  /* (count x count) of S between them */
} one_state;

static void state_destroy(void *data) {
  one_state *s = data;
  if (!s)
    return;
  bw_release(s->c);
  bw_free(s->member);
  bw_free(s->factor);
  bw_free(s);
}

/* u = G f - G B_A^T S_AA^-1 B_A G f */
static bw_status state_apply(bw_context *context, void *data, int64_t count, const double *force,
                             double *displacement) {
  const one_state *s = data;
  const bw_contact_system *c = s->c;
  bw_status status = BW_OK;
  int64_t size = 3 * (int64_t)c->model->mesh->node_count;
  double *pressed = BW_NEW(context, double, count *size);
  double *all = BW_NEW(context, double, c->rows->row_count);
  double *p = BW_NEW(context, double, c->count), *part = BW_NEW(context, double, s->count);
  BW_TRY_MEMORY(pressed && all && p && part);
  BW_TRY(bw_system_solve(context, c->system, (int)count, force, displacement));
  if (s->count == 0)
    goto done;
  for (int64_t i = 0; i < count; i++) {
    measure(c, displacement + i * size, all, p);
    for (int k = 0; k < s->count; k++)
      part[k] = -p[s->member[k]];
    bwi_lower_solve(s->count, s->factor, part);
    bwi_upper_solve(s->count, s->factor, part);
    memset(p, 0, (size_t)c->count * sizeof *p);
    for (int k = 0; k < s->count; k++)
      p[s->member[k]] = part[k];
    press(c, p, pressed + i * size);
  }
  BW_TRY(bw_system_solve(context, c->system, (int)count, pressed, pressed));
  for (int64_t i = 0; i < count * size; i++)
    displacement[i] += pressed[i];
done:
  bw_free(pressed);
  bw_free(all);
  bw_free(p);
  bw_free(part);
  return status;
}

/* S between the members. */
static void gather(one_state *s) {
  size_t n = (size_t)s->count, all = (size_t)s->c->count;
  for (size_t i = 0; i < n; i++)
    for (size_t j = 0; j < n; j++)
      s->factor[i * n + j] = s->c->s[(size_t)s->member[i] * all + (size_t)s->member[j]];
}

/* Cholesky with pivots: leaves out members whose gap others decide, as at corners that supports
 * constrain. */
static bw_status factor_pivoted(bw_context *context, one_state *s) {
  bw_status status = BW_OK;
  const size_t n = (size_t)s->count, all = (size_t)s->c->count;
  const double *compliance = s->c->s;
  double *l = s->factor, *pivot = BW_NEW(context, double, n);
  size_t rank = 0;
  BW_TRY_MEMORY(pivot);
  for (size_t i = 0; i < n; i++)
    pivot[i] = 1; /* over the member's compliance */
  for (; rank < n; rank++) {
    size_t best = rank;
    for (size_t i = rank; i < n; i++)
      best = pivot[i] > pivot[best] ? i : best;
    if (!(pivot[best] > redundant))
      break;
    BW_TRY(bw_check_cancel(context));
    int32_t member = s->member[best];
    s->member[best] = s->member[rank];
    s->member[rank] = member;
    pivot[best] = pivot[rank];
    for (size_t j = 0; j < rank; j++) {
      double value = l[best * n + j];
      l[best * n + j] = l[rank * n + j];
      l[rank * n + j] = value;
    }
    const double *row = compliance + (size_t)member * all;
    double whole = row[member] - bwi_dot((int64_t)rank, l + rank * n, l + rank * n);
    l[rank * n + rank] = sqrt(whole);
    for (size_t i = rank + 1; i < n; i++) {
      size_t at = (size_t)s->member[i];
      double value = row[at] - bwi_dot((int64_t)rank, l + i * n, l + rank * n);
      l[i * n + rank] = value / l[rank * n + rank];
      pivot[i] -= l[i * n + rank] * l[i * n + rank] / compliance[at * all + at];
    }
  }
  for (size_t i = 0; i < rank; i++)
    memmove(l + i * rank, l + i * n, rank * sizeof *l);
  s->count = (int)rank;
done:
  bw_free(pivot);
  return status;
}

static bw_status factor_state(bw_context *context, one_state *s) {
  int n = s->count, info = 0;
  bool regular = true;
  gather(s);
  if (n == 0)
    return BW_OK;
  bwi_blas_enter(); /* the upper triangle by columns is the lower one by rows */
  dpotrf_("U", &n, s->factor, &n, &info);
  bwi_blas_leave();
  for (int i = 0; i < n && info == 0; i++) {
    double l = s->factor[(size_t)i * (size_t)n + (size_t)i];
    size_t at = (size_t)s->member[i] * (size_t)s->c->count + (size_t)s->member[i];
    regular = regular && l * l > redundant * s->c->s[at];
  }
  return info != 0 || !regular ? factor_pivoted(context, s) : BW_OK;
}

bw_status bw_contact_system_in_state(bw_context *context, bw_contact_system *c,
                                     const uint8_t *state, bw_system **out) {
  bw_status status = BW_OK;
  bw_operator *solution = NULL;
  one_state *s = BW_NEW0(context, one_state, 1);
  BW_TRY_MEMORY(s);
  s->c = bw_retain(c);
  s->member = BW_NEW(context, int32_t, c->count);
  BW_TRY_MEMORY(s->member);
  for (int k = 0; k < c->count; k++)
    if (state[k])
      s->member[s->count++] = k;
  s->factor = BW_NEW(context, double, (int64_t)s->count * s->count);
  BW_TRY_MEMORY(s->factor);
  BW_TRY(factor_state(context, s));
  BW_TRY(bw_operator_create(context, 3 * (int64_t)c->model->mesh->node_count, state_apply, s,
                            state_destroy, "solution in a state of contact", &solution));
  s = NULL;
  BW_TRY(bwi_system_by_operator(context, c->model, c->system->dof_map, solution, out));
done:
  state_destroy(s);
  bw_release(solution);
  return status;
}
