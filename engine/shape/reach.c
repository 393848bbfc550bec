/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* Inverse kinematics, what is asked for: targets, chains and limits checked, the bones that turn,
 * the start within the limits. reach_descend.c does the work. */
#include "shape/reach.h"

#include <math.h>
#include <string.h>

static const double pi_and_rounding = 3.14159265358979323846 * (1 + 1e-12);

static bw_status check_target(bw_context *context, const bw_skeleton *skeleton, int i,
                              const bw_reach_target *t) {
  if (t->bone < 0 || t->bone >= skeleton->bone_count)
    return bw_fail(context, BW_INVALID, "target %d is for bone %d: there are %d", i + 1,
                   t->bone + 1, skeleton->bone_count);
  const char *name = skeleton->bone_name[t->bone].text;
  if (!(t->along >= 0 && t->along <= 1))
    return bw_fail(
        context, BW_INVALID,
        "target %d is for the point at %g along bone \"%s\": 0 (head) to 1 (tail) expected", i + 1,
        t->along, name);
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
      limit->twist_min <= limit->twist_max && limit->twist_min >= -pi_and_rounding &&
      limit->twist_max <= pi_and_rounding)
    return BW_OK;
  return bw_fail(context, BW_INVALID,
                 "the limits of bone \"%s\" are swing %g and twist %g to %g: swing from 0 to pi "
                 "and twists from -pi to pi, the lower first, expected",
                 skeleton->bone_name[b].text, limit->swing, limit->twist_min, limit->twist_max);
}

/* Which bones turn, and for which targets. */
static void find_chains(bwi_reach *r) {
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

static bw_status allocate(bwi_reach *r) {
  bw_context *context = r->context;
  int64_t bones = r->skeleton->bone_count, n = 3 * bones;
  r->bone_of_slot = BW_NEW(context, int32_t, bones);
  r->slot_of_bone = BW_NEW(context, int32_t, bones);
  r->in_chain = BW_NEW0(context, uint8_t, r->count * bones);
  r->direction = BW_NEW(context, double, n);
  r->bars = BW_NEW0(context, bwi_bars, bones);
  r->barred = BW_NEW(context, int8_t, n);
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
  r->fixed = BW_NEW(context, double, n);
  bool all = r->bone_of_slot && r->slot_of_bone && r->in_chain && r->direction && r->bars &&
             r->barred && r->pose && r->trial && r->turn && r->trial_turn && r->map &&
             r->trial_map && r->rotation && r->trial_rotation && r->gradient && r->step && r->fixed;
  if (!all)
    return BW_MEMORY;
  find_chains(r);
  n = 3 * (int64_t)r->slots;
  r->hessian = BW_NEW(context, double, n *n);
  r->matrix = BW_NEW(context, double, n *n);
  return r->hessian && r->matrix ? BW_OK : BW_MEMORY;
}

static void release(bwi_reach *r) {
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
  bw_free(r->fixed);
}

/* Directions, quaternions, and bones beyond their limits put back on them. */
static bool settle_start(bwi_reach *r) {
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
    return bw_fail(context, BW_INVALID, "a tolerance of %g m: 0 (the default) or more expected",
                   tolerance);
  if (count < 1)
    return bw_fail(context, BW_INVALID, "%d targets: at least one expected", count);
  bw_status status = BW_OK;
  for (int i = 0; i < count && status == BW_OK; i++)
    status = check_target(context, skeleton, i, target + i);
  for (int32_t b = 0; b < skeleton->bone_count && limit && status == BW_OK; b++)
    status = check_limit(context, skeleton, b, limit + b);
  if (status != BW_OK)
    return status;
  bwi_reach r = {.context = context, .skeleton = skeleton, .limit = limit, .count = count};
  size_t bytes = (size_t)skeleton->bone_count * sizeof *pose;
  bw_reach_report done_with = {0, 0, false};
  r.target = target;
  r.size = size_of(skeleton);
  r.tolerance = tolerance > 0 ? tolerance : 1e-6 * r.size;
  bw_bone_pose *best = BW_NEW(context, bw_bone_pose, skeleton->bone_count);
  BW_TRY_MEMORY(best);
  BW_TRY(allocate(&r));
  memcpy(r.pose, pose, bytes);
  BW_TRY(bw_pose_maps(context, skeleton, r.pose, r.map, r.rotation));
  if (settle_start(&r))
    BW_TRY(bw_pose_maps(context, skeleton, r.pose, r.map, r.rotation));
  memcpy(r.trial, r.pose, bytes);
  BW_TRY(bwi_reach_descend(&r, best, &done_with.distance, &done_with.iterations));
  done_with.reached = done_with.distance <= r.tolerance;
  memcpy(pose, best, bytes);
  if (report)
    *report = done_with;
done:
  release(&r);
  bw_free(best);
  return status;
}
