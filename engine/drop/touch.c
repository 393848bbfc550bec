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

enum { MOST = 2000, POWER_STEPS = 30 };

/* Of the body's radius: by how much points may come nearer before all are looked at again. */
static const double travel = 0.02;
/* Of the compliance of a node: what the modes must leave. */
static const double least_left = 1e-6;
/* Cosine of the angle, 0.01 rad, within which the force of a known point is along the normal. */
static const double along_normal = 0.99995;
/* Of the largest diagonal entry: redundant candidates are singular. */
static const double shift = 1e-12;

double bwi_drop_reach(const bwi_drop_run *run) {
  double sum = 0;
  for (int k = 0; k < run->motion.modes; k++)
    sum += hypot(run->motion.q[k], run->motion.rate[k] / run->motion.omega[k]) *
           run->points.mode_size[k];
  return sum + bwi_drop_contact_reach(&run->touch, bwi_drop_contact_energy(&run->touch));
}

/* ---- candidates ------------------------------------------------------------------------------ */

bw_status bwi_drop_touch_create(bw_context *context, const bwi_drop_run *run,
                                bwi_drop_touch *touch) {
  bw_status status = BW_OK;
  memset(touch, 0, sizeof *touch);
  touch->limit = -1; /* all points are looked at first */
  touch->place = BW_NEW(context, int32_t, run->points.count);
  touch->near = BW_NEW(context, int32_t, run->points.count);
  BW_TRY_MEMORY(touch->place && touch->near);
  memset(touch->place, 0xff, (size_t)run->points.count * sizeof *touch->place);
done:
  return status;
}

void bwi_drop_touch_clear(bwi_drop_touch *t) {
  void *all[] = {t->point, t->push,  t->whole,  t->flexibility, t->s,      t->gap,   t->force,
                 t->w,     t->slack, t->normal, t->arm,         t->active, t->place, t->near};
  for (size_t i = 0; i < sizeof all / sizeof *all; i++)
    bw_free(all[i]);
  memset(t, 0, sizeof *t);
}

/* Room for more candidates; what is there stays. */
static bw_status grow(bw_context *context, bwi_drop_touch *t, int more) {
  bw_status status = BW_OK;
  int count = t->count + more;
  bw_free(t->s);
  t->s = BW_NEW(context, double, (int64_t)count *count);
  BW_TRY_MEMORY(t->s);
  if (count > t->capacity) {
    int capacity = 2 * count;
    struct {
      void **block;
      size_t size;
    } block[] = {{(void **)&t->gap, sizeof(double)},        {(void **)&t->force, sizeof(double)},
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
    double *row = b + (int64_t)i * width, moment[3];
    bwi_drop_modal_force(run, t->point[i], push, row);
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

/* Makes those known that are not, or not for the normal they have now. */
static bw_status know_all(bw_context *context, bwi_drop_run *run, int count, const int32_t *which) {
  bw_status status = BW_OK;
  const bwi_drop_touch *t = &run->touch;
  int lacking = 0;
  int32_t *lacks = BW_NEW(context, int32_t, count);
  BW_TRY_MEMORY(lacks);
  for (int i = 0; i < count; i++) {
    double push[3];
    int32_t place = t->place[which[i]];
    bwi_drop_push(run, which[i], push);
    if (place < 0 || !(bw_dot(t->push + 3 * (int64_t)place, push) > along_normal))
      lacks[lacking++] = which[i];
  }
  if (lacking > 0)
    BW_TRY(bwi_drop_know(context, run, lacking, lacks));
done:
  bw_free(lacks);
  return status;
}

static bw_status add_candidates(bw_context *context, bwi_drop_run *run, int more,
                                const int32_t *which) {
  bw_status status = BW_OK;
  bwi_drop_touch *t = &run->touch;
  if (t->count + more > MOST)
    return bw_fail(context, BW_LIMIT,
                   "more than %d nodes touch in one impact: mesh the faces that land coarser, or "
                   "tilt the body",
                   MOST);
  BW_TRY(know_all(context, run, more, which));
  BW_TRY(grow(context, t, more));
  for (int j = 0; j < more; j++) {
    int c = t->count;
    t->slack[c] = run->slack;
    t->force[c] = 0;
    t->active[c] = 0;
    bwi_drop_promote(t, which[j]);
    if (!(t->flexibility[(int64_t)c * t->known + c] > least_left * t->whole[c]))
      BW_TRY(bw_fail(context, BW_INVALID,
                     "the %d modes leave nothing of the compliance of this mesh to the contact: "
                     "take fewer modes",
                     run->motion.modes));
  }
  for (int64_t i = 0; i < t->count; i++)
    memcpy(t->s + i * t->count, t->flexibility + i * t->known, (size_t)t->count * sizeof *t->s);
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
    if (bwi_drop_rigid_gap_at(run, i) < t->limit)
      t->near[t->near_count++] = i;
}

/* Points that penetrate, and those within the margin where one does: *more of them. Or, where the
 * forces may move points so far that are not known, these. */
static bool find_others(const bwi_drop_run *run, double reach, int *more, int32_t *which) {
  const bwi_drop_touch *t = &run->touch;
  double energy = bwi_drop_contact_energy(t), moved = bwi_drop_contact_reach(t, energy);
  bool one = false;
  int count = 0, lacking = 0;
  for (int32_t i = 0; i < t->near_count; i++) {
    int32_t point = t->near[i], place = t->place[point];
    double normal[3], arm[3], gap;
    if ((place >= 0 && place < t->count) || bwi_drop_rigid_gap_at(run, point) > reach + run->margin)
      continue;
    gap = bwi_drop_gap_at(run, point, normal, arm);
    if (gap - moved > run->margin || (place < 0 && bwi_drop_faces_away(run, point, normal)))
      continue;
    if (energy > 0 && place < 0) {
      which[lacking++] = point;
      continue;
    }
    if (energy > 0)
      gap += bwi_dot(t->count, t->flexibility + (int64_t)place * t->known, t->force);
    one = one || gap < -run->slack;
    if (gap < run->margin && lacking == 0)
      which[count++] = point;
  }
  *more = lacking > 0 ? lacking : one ? count : 0;
  return lacking > 0;
}

static bw_status solve_forces(bw_context *context, bwi_drop_run *run) {
  bw_status status = BW_OK;
  bwi_drop_touch *t = &run->touch;
  bool negative = false;
  for (int j = 0; j < t->count; j++) {
    t->gap[j] = bwi_drop_gap_at(run, t->point[j], t->normal + 3 * j, t->arm + 3 * j);
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
    bool unknown = false;
    BW_TRY(solve_forces(context, run));
    double reach = bwi_drop_reach(run);
    if (reach + run->margin + t->traveled > t->limit)
      look_at_all(run, reach + run->margin);
    if (t->near_count > 0) {
      if (!which) {
        which = BW_NEW(context, int32_t, run->points.count);
        BW_TRY_MEMORY(which);
      }
      unknown = find_others(run, reach, &more, which);
    }
    if (more == 0)
      break;
    BW_TRY(unknown ? bwi_drop_know(context, run, more, which)
                   : add_candidates(context, run, more, which));
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
    bwi_drop_to_space(run->motion.turn, t->push + 3 * j, push);
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
    bwi_drop_to_body(m->turn, normal, push);
    for (int k = 0; k < 3; k++) {
      m->velocity[k] += impulse * normal[k] / m->mass;
      m->momentum[k] += impulse * moment[k];
      for (int l = 0; l < m->modes; l++)
        m->rate[l] += impulse * push[k] * basis[k * m->modes + l];
    }
  }
}
