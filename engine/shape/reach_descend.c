/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* Inverse kinematics: the sum of squared distances between points of bones and their targets, made
 * least over small turns of the bones of the chains.
 *
 * Turning bone b by the vector w about its posed head moves a point x that hangs on it by w x q,
 * with q = x - head; for bones b above c the second-order part is w_b x (w_c x q_c), and half of
 * that for b = c. So the exact gradient and Hessian are at hand. Newton's method, damped until the
 * Hessian is positive definite and the sum falls, converges quickly also where a target is out of
 * reach. A straight chain whose target lies along it is a saddle: it is bent a little and tried
 * again. */
#include "shape/reach.h"

#include <math.h>
#include <string.h>

enum { max_iterations = 200, max_kicks = 3 };

static const double longest_turn = 0.6; /* radians in one iteration */

/* ---- the sum and its derivatives ------------------------------------------------------------- */

static void at_point(const bwi_reach *r, const double *map, const bw_reach_target *target,
                     double x[3]) {
  const double *head = r->skeleton->joint + 3 * (size_t)r->skeleton->bone[2 * target->bone];
  const double *tail = r->skeleton->joint + 3 * (size_t)r->skeleton->bone[2 * target->bone + 1];
  const double *m = map + 12 * (size_t)target->bone;
  double rest[3];
  for (int k = 0; k < 3; k++)
    rest[k] = head[k] + target->along * (tail[k] - head[k]);
  for (int k = 0; k < 3; k++)
    x[k] = bw_dot(m + 4 * k, rest) + m[4 * k + 3];
}

static double evaluate(const bwi_reach *r, const double *map, double *distance) {
  double sum = 0;
  *distance = 0;
  for (int i = 0; i < r->count; i++) {
    double x[3], d[3];
    at_point(r, map, r->target + i, x);
    for (int k = 0; k < 3; k++)
      d[k] = (r->target[i].at[k] - x[k]) / r->size;
    double length = bw_norm(d);
    sum += 0.5 * r->target[i].weight * r->target[i].weight * length * length;
    *distance = fmax(*distance, length * r->size);
  }
  return sum;
}

/* x relative to the posed head of a slot's bone. */
static void lever(const bwi_reach *r, int32_t slot, const double x[3], double q[3]) {
  int32_t b = r->bone_of_slot[slot];
  const double *head = r->skeleton->joint + 3 * (size_t)r->skeleton->bone[2 * b];
  const double *m = r->map + 12 * (size_t)b;
  for (int k = 0; k < 3; k++)
    q[k] = (x[k] - bw_dot(m + 4 * k, head) - m[4 * k + 3]) / r->size;
}

/* gradient: minus that of the sum, so that a step along it descends. */
static void differentiate(const bwi_reach *r) {
  size_t n = 3 * (size_t)r->slots;
  memset(r->gradient, 0, n * sizeof(double));
  memset(r->hessian, 0, n * n * sizeof(double));
  for (int i = 0; i < r->count; i++) {
    const uint8_t *chain = r->in_chain + (size_t)i * (size_t)r->slots;
    double x[3], d[3], square = r->target[i].weight * r->target[i].weight;
    at_point(r, r->map, r->target + i, x);
    for (int k = 0; k < 3; k++)
      d[k] = (r->target[i].at[k] - x[k]) / r->size;
    for (int32_t c = 0; c < r->slots; c++) {
      if (!chain[c])
        continue;
      double qc[3], pull[3];
      lever(r, c, x, qc);
      bw_cross(qc, d, pull);
      for (int k = 0; k < 3; k++)
        r->gradient[3 * c + k] += square * pull[k];
      double pulled = bw_dot(qc, d);
      for (int32_t b = 0; b <= c; b++) { /* b above c, or c itself */
        if (!chain[b])
          continue;
        double qb[3];
        lever(r, b, x, qb);
        double both = bw_dot(qb, qc) + pulled;
        for (int l = 0; l < 3; l++) /* component of c: row */
          for (int k = 0; k < 3; k++) {
            double second = b == c ? 0.5 * (qc[k] * d[l] + qc[l] * d[k]) : qc[k] * d[l];
            double entry = (k == l ? both : 0) - qc[k] * qb[l] - second;
            r->hessian[(size_t)(3 * c + l) * n + (size_t)(3 * b + k)] += square * entry;
          }
      }
    }
  }
  for (size_t i = 0; i < n; i++)
    for (size_t j = 0; j < i; j++)
      r->hessian[j * n + i] = r->hessian[i * n + j];
}

/* ---- steps ----------------------------------------------------------------------------------- */

static bw_status take_step(const bwi_reach *r) {
  double longest = 0;
  for (int32_t s = 0; s < r->slots; s++)
    longest = fmax(longest, bw_norm(r->step + 3 * s));
  double scale = longest > longest_turn ? longest_turn / longest : 1;
  for (int32_t s = 0; s < r->slots; s++) {
    int32_t b = r->bone_of_slot[s], p = r->skeleton->parent[b];
    double local[3];
    for (int k = 0; k < 3; k++) {
      local[k] = r->step[3 * s + k];
      if (p >= 0) { /* R_p transposed */
        const double *turn = r->rotation + 9 * (size_t)p;
        local[k] = turn[k] * r->step[3 * s] + turn[3 + k] * r->step[3 * s + 1] +
                   turn[6 + k] * r->step[3 * s + 2];
      }
      local[k] *= scale;
    }
    double *q = r->trial_turn + 4 * s;
    memcpy(q, r->turn + 4 * s, 4 * sizeof(double));
    bwi_quaternion_turn(local, q);
    if (r->limit)
      bwi_limit_rotation(r->limit + b, r->direction + 3 * s, q);
    bwi_quaternion_rotation(q, r->trial[b].rotation);
  }
  return bw_pose_maps(r->context, r->skeleton, r->trial, r->trial_map, r->trial_rotation);
}

static void accept(bwi_reach *r) {
#define SWAP(type, a, b)                                                                           \
  do {                                                                                             \
    type kept = r->a;                                                                              \
    r->a = r->b;                                                                                   \
    r->b = kept;                                                                                   \
  } while (0)
  SWAP(bw_bone_pose *, pose, trial);
  SWAP(double *, turn, trial_turn);
  SWAP(double *, map, trial_map);
  SWAP(double *, rotation, trial_rotation);
#undef SWAP
}
/* ---- the iteration --------------------------------------------------------------------------- */

/* Descend from the present pose until the targets are met or nothing is gained. *saddle: whether
 * the Hessian there is not positive, so that another way may lead further down. */
static bw_status descend(bwi_reach *r, double *sum, double *distance, int *iterations,
                         bool *saddle) {
  size_t n = 3 * (size_t)r->slots;
  double damping = 1e-3;
  *saddle = false;
  while (*distance > r->tolerance && *iterations < max_iterations) {
    bw_status status = bw_check_cancel(r->context);
    if (status != BW_OK)
      return status;
    differentiate(r);
    bwi_reach_find_bars(r);
    double scale = 0;
    for (size_t i = 0; i < n; i++)
      scale = fmax(scale, fabs(r->hessian[i * n + i]));
    scale = fmax(scale, 1e-12);
    bool better = false;
    double before = *sum;
    ++*iterations;
    for (int attempt = 0; attempt < 24 && !better; attempt++) {
      if (bwi_reach_step(r, damping * scale)) {
        double left;
        status = take_step(r);
        if (status != BW_OK)
          return status;
        double gained = evaluate(r, r->trial_map, &left);
        if (gained < *sum) {
          better = true;
          *sum = gained;
          *distance = left;
          accept(r);
        }
      }
      damping = better ? fmax(0.1 * damping, 1e-9) : fmin(5 * damping, 1e6);
    }
    if (!better || before - *sum <= 1e-13 * before) {
      *saddle = !bwi_reach_is_minimum(r, 1e-9 * scale);
      break;
    }
  }
  return BW_OK;
}

/* Bend the chains a little, neighbouring bones to opposite sides, at right angles to where the
 * first unmet target lies. */
static bw_status kick(bwi_reach *r, int number) {
  double pull[3] = {0, 0, 0}, across[3] = {0, 0, 0}, axis[3], farthest = -1;
  for (int i = 0; i < r->count; i++) {
    double x[3];
    at_point(r, r->map, r->target + i, x);
    for (int k = 0; k < 3; k++)
      x[k] = r->target[i].at[k] - x[k];
    if (bw_norm(x) > farthest) {
      farthest = bw_norm(x);
      memcpy(pull, x, sizeof pull);
    }
  }
  int min = 0;
  for (int k = 1; k < 3; k++)
    if (fabs(pull[k]) < fabs(pull[min]))
      min = k;
  across[min] = 1;
  bw_cross(pull, across, axis);
  if (number % 2 == 1) {
    memcpy(across, axis, sizeof across);
    bw_cross(pull, across, axis);
  }
  double length = bw_norm(axis);
  for (int32_t s = 0; s < r->slots; s++)
    for (int k = 0; k < 3; k++) {
      double angle = (s % 2 ? -0.2 : 0.1) * (1 + 0.1 * s / r->slots) * (1 + number / 2);
      r->step[3 * s + k] = length > 0 ? angle * axis[k] / length : 0;
    }
  bw_status status = take_step(r);
  if (status == BW_OK)
    accept(r);
  return status;
}

bw_status bwi_reach_descend(bwi_reach *r, bw_bone_pose *best, double *distance, int *iterations) {
  size_t bytes = (size_t)r->skeleton->bone_count * sizeof *best;
  bool saddle;
  double sum = evaluate(r, r->map, distance);
  bw_status status = descend(r, &sum, distance, iterations, &saddle);
  if (status != BW_OK)
    return status;
  double min = sum, nearest = *distance;
  memcpy(best, r->pose, bytes);
  bool limited = false;
  for (int32_t s = 0; s < r->slots; s++)
    limited |= r->bars[s].count > 0;
  for (int i = 0; i < max_kicks && nearest > r->tolerance && (saddle || limited); i++) {
    BW_TRY(kick(r, i));
    sum = evaluate(r, r->map, distance);
    BW_TRY(descend(r, &sum, distance, iterations, &saddle));
    if (sum < min * (1 - 1e-9)) {
      min = sum;
      nearest = *distance;
      memcpy(best, r->pose, bytes);
    }
  }
  *distance = nearest;
done:
  return status;
}
