/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* Inverse kinematics: the sum of squared distances between points of bones and their targets, made
 * least over small turns of the bones of the chains.
 *
 * Turning bone b by the vector w about its posed head moves a point x that hangs on it by w x q,
 * with q = x - head; for bones b above c the second-order part is w_b x (w_c x q_c), and half of
 * that for b = c. So the exact gradient and Hessian are at hand. Newton's method, damped until the
 * Hessian is positive definite and the sum falls, converges quadratically also where a target is
 * out of reach. Turns that a joint's limits bar are projected out (and what remains beyond a limit
 * is put back on it). A straight chain whose target lies along it is a saddle: it is bent a little
 * and tried again.
 *
 * Lengths are in units of the skeleton's size; bones of the chains are numbered by slots, parents
 * first. */
#include "shape/reach.h"

#include <math.h>
#include <string.h>

enum { most_iterations = 200, most_kicks = 3 };

static const double longest_turn = 0.6; /* radians in one iteration */
static const double pi_and_rounding = 3.14159265358979323846 * (1 + 1e-12);

typedef struct reach {
  bw_context *context;
  const bw_skeleton *skeleton;
  const bw_joint_limit *limit; /* per bone, or NULL */
  int count;
  const bw_reach_target *target;
  double size, tolerance;
  int32_t slots;
  int32_t *bone_of_slot, *slot_of_bone; /* -1: does not turn */
  uint8_t *in_chain;                    /* count x slots */
  double *direction;                    /* slots x 3: rest directions of the bones */
  bwi_bars *bars;                       /* slots, in world directions */
  uint8_t *barred;                      /* slots x 3 */
  bw_bone_pose *pose, *trial;           /* bone_count */
  double *turn, *trial_turn;            /* slots x 4: quaternions of pose, trial */
  double *map, *rotation;               /* of the pose evaluated last */
  double *trial_map, *trial_rotation;
  double *gradient, *hessian, *matrix, *step; /* 3 slots (squared) */
} reach;

/* ---- the sum and its derivatives ------------------------------------------------------------- */

static void at_point(const reach *r, const double *map, const bw_reach_target *target,
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

static double evaluate(const reach *r, const double *map, double *distance) {
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
static void lever(const reach *r, int32_t slot, const double x[3], double q[3]) {
  int32_t b = r->bone_of_slot[slot];
  const double *head = r->skeleton->joint + 3 * (size_t)r->skeleton->bone[2 * b];
  const double *m = r->map + 12 * (size_t)b;
  for (int k = 0; k < 3; k++)
    q[k] = (x[k] - bw_dot(m + 4 * k, head) - m[4 * k + 3]) / r->size;
}

/* gradient: minus that of the sum, so that a step along it descends; hessian: lower triangle. */
static void differentiate(const reach *r) {
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
}

/* ---- steps ----------------------------------------------------------------------------------- */

static void find_bars(const reach *r) {
  for (int32_t s = 0; s < r->slots; s++) {
    bwi_bars *bars = r->bars + s;
    bars->count = 0;
    if (!r->limit)
      continue;
    int32_t b = r->bone_of_slot[s], p = r->skeleton->parent[b];
    bwi_limit_bars(r->limit + b, r->direction + 3 * s, r->turn + 4 * s, bars);
    for (int i = 0; i < bars->count && p >= 0; i++) {
      double local[3];
      memcpy(local, bars->axis[i], sizeof local);
      for (int k = 0; k < 3; k++)
        bars->axis[i][k] = bw_dot(r->rotation + 9 * (size_t)p + 3 * k, local);
    }
  }
}

/* Mark the bars that the vector runs against; true when there are new ones. */
static bool run_against(const reach *r, const double *vector) {
  bool found = false;
  for (int32_t s = 0; s < r->slots; s++)
    for (int i = 0; i < r->bars[s].count; i++) {
      uint8_t *barred = r->barred + 3 * s + i;
      double part = bw_dot(vector + 3 * s, r->bars[s].axis[i]);
      int sign = r->bars[s].sign[i];
      if (*barred || (sign != 0 && part * sign <= 1e-14))
        continue;
      *barred = 1;
      found = true;
    }
  return found;
}

static void project(const reach *r, double *vector) {
  for (int32_t s = 0; s < r->slots; s++)
    for (int i = 0; i < r->bars[s].count; i++) {
      if (!r->barred[3 * s + i])
        continue;
      const double *axis = r->bars[s].axis[i];
      double part = bw_dot(vector + 3 * s, axis);
      for (int k = 0; k < 3; k++)
        vector[3 * s + k] -= part * axis[k];
    }
}

/* In place, lower triangle; false where it is not positive definite. */
static bool cholesky(double *a, size_t n, double least) {
  for (size_t i = 0; i < n; i++)
    for (size_t j = 0; j <= i; j++) {
      double sum = a[i * n + j];
      for (size_t k = 0; k < j; k++)
        sum -= a[i * n + k] * a[j * n + k];
      if (i > j)
        a[i * n + j] = sum / a[j * n + j];
      else if (!(sum > least))
        return false;
      else
        a[i * n + i] = sqrt(sum);
    }
  return true;
}

/* The step (P H P + damping) step = P gradient; false when that is not positive definite. */
static bool solve(const reach *r, double damping) {
  size_t n = 3 * (size_t)r->slots;
  double *a = r->matrix, *x = r->step;
  for (size_t i = 0; i < n; i++)
    for (size_t j = 0; j < n; j++)
      a[i * n + j] = i >= j ? r->hessian[i * n + j] : r->hessian[j * n + i];
  for (size_t i = 0; i < n; i++) /* rows, then columns, of a symmetric matrix */
    project(r, a + i * n);
  for (size_t i = 0; i < n; i++)
    for (size_t j = 0; j < i; j++) {
      double swap = a[i * n + j];
      a[i * n + j] = a[j * n + i];
      a[j * n + i] = swap;
    }
  for (size_t i = 0; i < n; i++)
    project(r, a + i * n);
  for (size_t i = 0; i < n; i++)
    a[i * n + i] += damping;
  if (!cholesky(a, n, 1e-3 * damping))
    return false;
  memcpy(x, r->gradient, n * sizeof *x);
  project(r, x);
  for (size_t i = 0; i < n; i++) {
    for (size_t k = 0; k < i; k++)
      x[i] -= a[i * n + k] * x[k];
    x[i] /= a[i * n + i];
  }
  for (size_t i = n; i-- > 0;) {
    for (size_t k = i + 1; k < n; k++)
      x[i] -= a[k * n + i] * x[k];
    x[i] /= a[i * n + i];
  }
  return true;
}

/* The trial pose: the pose with the step (world directions) taken, within the limits. */
static bw_status take_step(const reach *r) {
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

static void accept(reach *r) {
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
static bw_status descend(reach *r, double *sum, double *distance, int *iterations, bool *saddle) {
  size_t n = 3 * (size_t)r->slots;
  double damping = 1e-3;
  *saddle = false;
  while (*distance > r->tolerance && *iterations < most_iterations) {
    bw_status status = bw_check_cancel(r->context);
    if (status != BW_OK)
      return status;
    differentiate(r);
    find_bars(r);
    memset(r->barred, 0, n);
    run_against(r, r->gradient);
    double scale = 0;
    for (size_t i = 0; i < n; i++)
      scale = fmax(scale, fabs(r->hessian[i * n + i]));
    scale = fmax(scale, 1e-12);
    bool better = false;
    double before = *sum;
    ++*iterations;
    *saddle = !solve(r, 1e-9 * scale);
    for (int attempt = 0; attempt < 24 && !better; attempt++) {
      bool positive = solve(r, damping * scale);
      for (int round = 0; positive && round < 4 && run_against(r, r->step); round++)
        positive = solve(r, damping * scale);
      if (positive) {
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
    if (!better || before - *sum <= 1e-13 * before)
      break;
  }
  return BW_OK;
}

/* Bend the chains a little, neighbouring bones to opposite sides, at right angles to where the
 * first unmet target lies. */
static bw_status kick(reach *r, int number) {
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
  int least = 0;
  for (int k = 1; k < 3; k++)
    if (fabs(pull[k]) < fabs(pull[least]))
      least = k;
  across[least] = 1;
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

static bw_status iterate(reach *r, bw_bone_pose *best, double *distance, int *iterations) {
  size_t bytes = (size_t)r->skeleton->bone_count * sizeof *best;
  bool saddle;
  double sum = evaluate(r, r->map, distance);
  bw_status status = descend(r, &sum, distance, iterations, &saddle);
  if (status != BW_OK)
    return status;
  double least = sum, nearest = *distance;
  memcpy(best, r->pose, bytes);
  bool limited = false;
  for (int32_t s = 0; s < r->slots; s++)
    limited |= r->bars[s].count > 0;
  for (int i = 0; i < most_kicks && nearest > r->tolerance && (saddle || limited); i++) {
    BW_TRY(kick(r, i));
    sum = evaluate(r, r->map, distance);
    BW_TRY(descend(r, &sum, distance, iterations, &saddle));
    if (sum < least * (1 - 1e-9)) {
      least = sum;
      nearest = *distance;
      memcpy(best, r->pose, bytes);
    }
  }
  *distance = nearest;
done:
  return status;
}

/* ---- what is asked for ----------------------------------------------------------------------- */

static bw_status check_target(bw_context *context, const bw_skeleton *skeleton, int i,
                              const bw_reach_target *t) {
  if (t->bone < 0 || t->bone >= skeleton->bone_count)
    return bw_fail(context, BW_INVALID, "target %d is for bone %d: there are %d", i + 1,
                   t->bone + 1, skeleton->bone_count);
  const char *name = skeleton->bone_name[t->bone].text;
  if (!(t->along >= 0 && t->along <= 1))
    return bw_fail(context, BW_INVALID,
                   "target %d is for the point at %g along bone \"%s\": 0 (head) to 1 (tail) is "
                   "asked for",
                   i + 1, t->along, name);
  if (!isfinite(t->at[0]) || !isfinite(t->at[1]) || !isfinite(t->at[2]))
    return bw_fail(context, BW_INVALID, "target %d of bone \"%s\" is at (%g, %g, %g)", i + 1, name,
                   t->at[0], t->at[1], t->at[2]);
  if (!(t->weight > 0) || !isfinite(t->weight))
    return bw_fail(context, BW_INVALID,
                   "target %d of bone \"%s\" has the weight %g: it must be positive", i + 1, name,
                   t->weight);
  if (t->chain_from == -1)
    return BW_OK;
  for (int32_t b = t->bone; b >= 0; b = skeleton->parent[b])
    if (b == t->chain_from)
      return BW_OK;
  return bw_fail(context, BW_INVALID,
                 "the chain of target %d begins at bone %d, which is not above bone \"%s\"", i + 1,
                 t->chain_from + 1, name);
}

static bw_status check_limit(bw_context *context, const bw_skeleton *skeleton, int32_t b,
                             const bw_joint_limit *limit) {
  if (limit->swing >= 0 && limit->swing <= pi_and_rounding &&
      limit->twist_low <= limit->twist_high && limit->twist_low >= -pi_and_rounding &&
      limit->twist_high <= pi_and_rounding)
    return BW_OK;
  return bw_fail(
      context, BW_INVALID,
      "the limits of bone \"%s\" are swing %g and twist %g to %g: swing from 0 to pi and "
      "twists from -pi to pi, the lower first, are asked for",
      skeleton->bone_name[b].text, limit->swing, limit->twist_low, limit->twist_high);
}

/* Which bones turn, and for which targets. */
static void find_chains(reach *r) {
  const bw_skeleton *s = r->skeleton;
  for (int32_t b = 0; b < s->bone_count; b++)
    r->slot_of_bone[b] = -1;
  for (int pass = 0; pass < 2; pass++) {
    for (int i = 0; i < r->count; i++) {
      const bw_reach_target *t = r->target + i;
      for (int32_t b = t->bone; b >= 0; b = b == t->chain_from ? -1 : s->parent[b])
        if (pass == 0)
          r->slot_of_bone[b] = 0;
        else
          r->in_chain[(size_t)i * (size_t)r->slots + (size_t)r->slot_of_bone[b]] = 1;
    }
    for (int32_t b = 0; b < s->bone_count && pass == 0; b++)
      if (r->slot_of_bone[b] == 0) {
        r->slot_of_bone[b] = r->slots;
        r->bone_of_slot[r->slots++] = b;
      }
  }
}

static bw_status allocate(reach *r) {
  bw_context *context = r->context;
  int64_t bones = r->skeleton->bone_count, n = 3 * bones;
  r->bone_of_slot = BW_NEW(context, int32_t, bones);
  r->slot_of_bone = BW_NEW(context, int32_t, bones);
  r->in_chain = BW_NEW0(context, uint8_t, r->count * bones);
  r->direction = BW_NEW(context, double, n);
  r->bars = BW_NEW0(context, bwi_bars, bones);
  r->barred = BW_NEW(context, uint8_t, n);
  r->pose = BW_NEW(context, bw_bone_pose, bones);
  r->trial = BW_NEW(context, bw_bone_pose, bones);
  r->turn = BW_NEW(context, double, 4 * bones);
  r->trial_turn = BW_NEW(context, double, 4 * bones);
  r->map = BW_NEW(context, double, 12 * bones);
  r->trial_map = BW_NEW(context, double, 12 * bones);
  r->rotation = BW_NEW(context, double, 9 * bones);
  r->trial_rotation = BW_NEW(context, double, 9 * bones);
  r->gradient = BW_NEW(context, double, n);
  r->step = BW_NEW(context, double, n);
  bool all = r->bone_of_slot && r->slot_of_bone && r->in_chain && r->direction && r->bars &&
             r->barred && r->pose && r->trial && r->turn && r->trial_turn && r->map &&
             r->trial_map && r->rotation && r->trial_rotation && r->gradient && r->step;
  if (!all)
    return BW_MEMORY;
  find_chains(r);
  n = 3 * (int64_t)r->slots;
  r->hessian = BW_NEW(context, double, n *n);
  r->matrix = BW_NEW(context, double, n *n);
  return r->hessian && r->matrix ? BW_OK : BW_MEMORY;
}

static void release(reach *r) {
  bw_free(r->bone_of_slot);
  bw_free(r->slot_of_bone);
  bw_free(r->in_chain);
  bw_free(r->direction);
  bw_free(r->bars);
  bw_free(r->barred);
  bw_free(r->pose);
  bw_free(r->trial);
  bw_free(r->turn);
  bw_free(r->trial_turn);
  bw_free(r->map);
  bw_free(r->trial_map);
  bw_free(r->rotation);
  bw_free(r->trial_rotation);
  bw_free(r->gradient);
  bw_free(r->hessian);
  bw_free(r->matrix);
  bw_free(r->step);
}

/* Directions, quaternions, and bones beyond their limits put back on them. */
static bool settle_start(reach *r) {
  bool changed = false;
  for (int32_t s = 0; s < r->slots; s++) {
    int32_t b = r->bone_of_slot[s];
    const double *head = r->skeleton->joint + 3 * (size_t)r->skeleton->bone[2 * b];
    const double *tail = r->skeleton->joint + 3 * (size_t)r->skeleton->bone[2 * b + 1];
    double *d = r->direction + 3 * s, *q = r->turn + 4 * s;
    for (int k = 0; k < 3; k++)
      d[k] = tail[k] - head[k];
    double length = bw_norm(d);
    for (int k = 0; k < 3; k++)
      d[k] /= length;
    bwi_quaternion_of(r->pose[b].rotation, q);
    if (r->limit && bwi_limit_rotation(r->limit + b, d, q)) {
      bwi_quaternion_rotation(q, r->pose[b].rotation);
      changed = true;
    }
  }
  return changed;
}

static double size_of(const bw_skeleton *skeleton) {
  double low[3], high[3], extent[3];
  for (int k = 0; k < 3; k++) {
    low[k] = INFINITY;
    high[k] = -INFINITY;
    for (int32_t j = 0; j < skeleton->joint_count; j++) {
      low[k] = fmin(low[k], skeleton->joint[3 * j + k]);
      high[k] = fmax(high[k], skeleton->joint[3 * j + k]);
    }
    extent[k] = high[k] - low[k];
  }
  return bw_norm(extent);
}

bw_status bw_pose_reach(bw_context *context, const bw_skeleton *skeleton,
                        const bw_joint_limit *limit, int count, const bw_reach_target *target,
                        double tolerance, bw_bone_pose *pose, bw_reach_report *report) {
  if (!(tolerance >= 0) || !isfinite(tolerance))
    return bw_fail(context, BW_INVALID,
                   "a tolerance of %g m: 0 (the usual one) or more is asked for", tolerance);
  if (count < 1)
    return bw_fail(context, BW_INVALID, "%d targets: at least one is asked for", count);
  bw_status status = BW_OK;
  for (int i = 0; i < count && status == BW_OK; i++)
    status = check_target(context, skeleton, i, target + i);
  for (int32_t b = 0; b < skeleton->bone_count && limit && status == BW_OK; b++)
    status = check_limit(context, skeleton, b, limit + b);
  if (status != BW_OK)
    return status;
  reach r = {.context = context, .skeleton = skeleton, .limit = limit, .count = count};
  size_t bytes = (size_t)skeleton->bone_count * sizeof *pose;
  bw_reach_report done_with = {0, 0, false};
  r.target = target;
  r.size = size_of(skeleton);
  r.tolerance = tolerance > 0 ? tolerance : 1e-6 * r.size;
  bw_bone_pose *best = BW_NEW(context, bw_bone_pose, skeleton->bone_count);
  if (!best) {
    status = BW_MEMORY;
    goto done;
  }
  BW_TRY(allocate(&r));
  memcpy(r.pose, pose, bytes);
  BW_TRY(bw_pose_maps(context, skeleton, r.pose, r.map, r.rotation));
  if (settle_start(&r))
    BW_TRY(bw_pose_maps(context, skeleton, r.pose, r.map, r.rotation));
  memcpy(r.trial, r.pose, bytes);
  BW_TRY(iterate(&r, best, &done_with.distance, &done_with.iterations));
  done_with.reached = done_with.distance <= r.tolerance;
  memcpy(pose, best, bytes);
  if (report)
    *report = done_with;
done:
  release(&r);
  bw_free(best);
  return status;
}
