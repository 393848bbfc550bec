/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* Edits of a skeleton. Each copies the lists, changes them, and lets bw_skeleton_create check and
 * order the result, so that every skeleton in the house went through the same checks. Names stay
 * with their joints and bones. */
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "barwright/shape.h"

typedef struct draft {
  int32_t joints, bones, root;
  double *joint;
  bw_name *joint_name;
  int32_t *bone;
  bw_name *bone_name;
  uint8_t *drop, *cut; /* joints and bones to be left out: draft_drop */
} draft;

/* A copy with room for one more joint and bone. */
static bw_status draft_create(bw_context *context, const bw_skeleton *s, draft *d) {
  size_t joints = (size_t)s->joint_count, bones = (size_t)s->bone_count;
  *d = (draft){.joints = s->joint_count, .bones = s->bone_count, .root = s->root};
  d->joint = BW_NEW(context, double, 3 * (joints + 1));
  d->joint_name = BW_NEW0(context, bw_name, joints + 1);
  d->bone = BW_NEW(context, int32_t, 2 * (bones + 1));
  d->bone_name = BW_NEW0(context, bw_name, bones + 1);
  d->drop = BW_NEW0(context, uint8_t, joints);
  d->cut = BW_NEW0(context, uint8_t, bones);
  if (!d->joint || !d->joint_name || !d->bone || !d->bone_name || !d->drop || !d->cut)
    return BW_MEMORY;
  memcpy(d->joint, s->joint, 3 * joints * sizeof *d->joint);
  memcpy(d->joint_name, s->joint_name, joints * sizeof *d->joint_name);
  memcpy(d->bone, s->bone, 2 * bones * sizeof *d->bone);
  memcpy(d->bone_name, s->bone_name, bones * sizeof *d->bone_name);
  return BW_OK;
}

static void draft_clear(draft *d) {
  bw_free(d->joint);
  bw_free(d->joint_name);
  bw_free(d->bone);
  bw_free(d->bone_name);
  bw_free(d->drop);
  bw_free(d->cut);
}

static bw_status draft_finish(bw_context *context, const draft *d, bw_skeleton **out) {
  return bw_skeleton_create(context, d->joints, d->joint, d->joint_name, d->bones, d->bone,
                            d->bone_name, d->root, out);
}

/* Leave out joints with drop[j] and bones with cut[b] (which must hold all bones at such
 * joints). */
static bw_status draft_drop(bw_context *context, draft *d) {
  int32_t joints = 0, bones = 0;
  int32_t *to = BW_NEW(context, int32_t, d->joints);
  if (!to)
    return BW_MEMORY;
  for (int32_t j = 0; j < d->joints; j++) {
    to[j] = d->drop[j] ? -1 : joints;
    if (d->drop[j])
      continue;
    memmove(d->joint + 3 * (size_t)joints, d->joint + 3 * (size_t)j, 3 * sizeof *d->joint);
    d->joint_name[joints++] = d->joint_name[j];
  }
  for (int32_t b = 0; b < d->bones; b++) {
    if (d->cut[b])
      continue;
    d->bone[2 * (size_t)bones] = to[d->bone[2 * (size_t)b]];
    d->bone[2 * (size_t)bones + 1] = to[d->bone[2 * (size_t)b + 1]];
    d->bone_name[bones++] = d->bone_name[b];
  }
  d->joints = joints;
  d->bones = bones;
  d->root = to[d->root];
  bw_free(to);
  return BW_OK;
}

static bool is_taken(const bw_name *list, int32_t count, const char *name) {
  for (int32_t i = 0; i < count; i++)
    if (strcmp(list[i].text, name) == 0)
      return true;
  return false;
}

/* "bone 7" for the seventh, or the next number that is free. */
static bw_name fresh_name(const bw_name *list, int32_t count, const char *kind) {
  bw_name made;
  int32_t number = count;
  do
    snprintf(made.text, sizeof made.text, "%s %d", kind, ++number);
  while (is_taken(list, count, made.text));
  return made;
}

/* `what`: "bone" or "joint". */
static bw_status check_number(bw_context *context, const char *what, int32_t number,
                              int32_t count) {
  if (number >= 0 && number < count)
    return BW_OK;
  bw_fail(context, BW_INVALID, "%s %d: the %ss of the skeleton are 1 to %d", what, number + 1, what,
          count);
  bw_detail_number(context, what, number + 1.0);
  return BW_INVALID;
}

bw_status bw_skeleton_insert_joint(bw_context *context, const bw_skeleton *skeleton, int32_t bone,
                                   double fraction, const char *name, bw_skeleton **out) {
  bw_status status = BW_OK;
  draft d = {0};
  BW_TRY(check_number(context, "bone", bone, skeleton->bone_count));
  if (!(fraction > 1e-6 && fraction < 1 - 1e-6))
    BW_TRY(bw_fail(context, BW_INVALID,
                   "a joint at the fraction %g of bone '%s': it must lie between its ends, 0 < "
                   "fraction < 1",
                   fraction, skeleton->bone_name[bone].text));
  if (name && strlen(name) >= BW_NAME)
    BW_TRY(bw_fail(context, BW_INVALID, "the name '%.60s...' is too long: at most %d bytes", name,
                   BW_NAME - 1));
  BW_TRY(draft_create(context, skeleton, &d));
  int32_t *ends = d.bone + 2 * (size_t)bone, middle = d.joints;
  const double *head = d.joint + 3 * (size_t)ends[0], *tail = d.joint + 3 * (size_t)ends[1];
  for (int k = 0; k < 3; k++)
    d.joint[3 * (size_t)middle + (size_t)k] = head[k] + fraction * (tail[k] - head[k]);
  if (name && name[0])
    memcpy(d.joint_name[middle].text, name, strlen(name) + 1);
  else
    d.joint_name[middle] = fresh_name(d.joint_name, d.joints, "joint");
  d.bone_name[d.bones] = fresh_name(d.bone_name, d.bones, "bone");
  d.bone[2 * (size_t)d.bones] = middle;
  d.bone[2 * (size_t)d.bones + 1] = ends[1];
  ends[1] = middle;
  d.joints++;
  d.bones++;
  BW_TRY(draft_finish(context, &d, out));
done:
  draft_clear(&d);
  return status;
}

bw_status bw_skeleton_move_joint(bw_context *context, const bw_skeleton *skeleton, int32_t joint,
                                 const double at[3], bw_skeleton **out) {
  bw_status status = BW_OK;
  draft d = {0};
  BW_TRY(check_number(context, "joint", joint, skeleton->joint_count));
  BW_TRY(draft_create(context, skeleton, &d));
  memcpy(d.joint + 3 * (size_t)joint, at, 3 * sizeof *at);
  BW_TRY(draft_finish(context, &d, out));
done:
  draft_clear(&d);
  return status;
}

/* The joint at which two bones meet, or -1. */
static int32_t common_joint(const bw_skeleton *s, int32_t a, int32_t b) {
  for (int i = 0; i < 4; i++)
    if (s->bone[2 * (size_t)a + (size_t)(i / 2)] == s->bone[2 * (size_t)b + (size_t)(i % 2)])
      return s->bone[2 * (size_t)a + (size_t)(i / 2)];
  return -1;
}

static int32_t other_end(const bw_skeleton *s, int32_t bone, int32_t joint) {
  const int32_t *ends = s->bone + 2 * (size_t)bone;
  return ends[0] == joint ? ends[1] : ends[0];
}

bw_status bw_skeleton_merge_bones(bw_context *context, const bw_skeleton *skeleton, int32_t a,
                                  int32_t b, bw_skeleton **out) {
  bw_status status = BW_OK;
  draft d = {0};
  int32_t meeting = 0;
  BW_TRY(check_number(context, "bone", a, skeleton->bone_count));
  BW_TRY(check_number(context, "bone", b, skeleton->bone_count));
  int32_t joint = a == b ? -1 : common_joint(skeleton, a, b);
  if (joint < 0) {
    status = bw_fail(context, BW_INVALID, "bones '%s' and '%s' do not meet at a joint",
                     skeleton->bone_name[a].text, skeleton->bone_name[b].text);
    bw_detail_number(context, "bone", b + 1.0);
    goto done;
  }
  for (int64_t i = 0; i < 2 * (int64_t)skeleton->bone_count; i++)
    meeting += skeleton->bone[i] == joint;
  if (meeting != 2) {
    status = bw_fail(context, BW_INVALID,
                     "bones '%s' and '%s' meet at joint '%s', where %d bones meet: only two that "
                     "meet alone can become one",
                     skeleton->bone_name[a].text, skeleton->bone_name[b].text,
                     skeleton->joint_name[joint].text, meeting);
    bw_detail_number(context, "joint", joint + 1.0);
    goto done;
  }
  BW_TRY(draft_create(context, skeleton, &d));
  int32_t far_a = other_end(skeleton, a, joint);
  d.bone[2 * (size_t)a] = far_a;
  d.bone[2 * (size_t)a + 1] = other_end(skeleton, b, joint);
  if (d.root == joint)
    d.root = far_a;
  d.drop[joint] = 1;
  d.cut[b] = 1;
  BW_TRY(draft_drop(context, &d));
  BW_TRY(draft_finish(context, &d, out));
done:
  draft_clear(&d);
  return status;
}

bw_status bw_skeleton_remove_bone(bw_context *context, const bw_skeleton *skeleton, int32_t bone,
                                  bw_skeleton **out) {
  bw_status status = BW_OK;
  draft d = {0};
  int32_t left = 0;
  BW_TRY(check_number(context, "bone", bone, skeleton->bone_count));
  BW_TRY(draft_create(context, skeleton, &d));
  for (int32_t b = 0; b < d.bones; b++) {
    int32_t parent = skeleton->parent[b];
    d.cut[b] = b == bone || (parent >= 0 && d.cut[parent]);
    d.drop[skeleton->bone[2 * (size_t)b + 1]] = d.cut[b];
    left += !d.cut[b];
  }
  if (left == 0) {
    status =
        bw_fail(context, BW_INVALID, "without bone '%s' and what hangs on it no bone would be left",
                skeleton->bone_name[bone].text);
    bw_detail_number(context, "bone", bone + 1.0);
    goto done;
  }
  BW_TRY(draft_drop(context, &d));
  BW_TRY(draft_finish(context, &d, out));
done:
  draft_clear(&d);
  return status;
}

bw_status bw_skeleton_with_root(bw_context *context, const bw_skeleton *skeleton, int32_t joint,
                                bw_skeleton **out) {
  bw_status status = BW_OK;
  draft d = {0};
  BW_TRY(check_number(context, "joint", joint, skeleton->joint_count));
  BW_TRY(draft_create(context, skeleton, &d));
  d.root = joint;
  BW_TRY(draft_finish(context, &d, out));
done:
  draft_clear(&d);
  return status;
}
