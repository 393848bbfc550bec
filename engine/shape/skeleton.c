/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* Skeletons: making and checking a tree of joints and bones, finding by name, rest frames.
 *
 * Invariants of every bw_skeleton: bone_count == joint_count - 1 >= 1; the bones join all joints;
 * every bone is longer than 1e-9 of the skeleton's box; parent[b] < b; bone[2 b] is the root or the
 * tail of bone parent[b]; names are not empty, end within their field, hold no control character
 * and no blank at either end, and are unique among the joints and among the bones. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "barwright/shape.h"
#include "base/union_find.h"

static void skeleton_destroy(void *object) {
  bw_skeleton *skeleton = object;
  bw_free(skeleton->joint);
  bw_free(skeleton->joint_name);
  bw_free(skeleton->bone);
  bw_free(skeleton->bone_name);
  bw_free(skeleton->parent);
  bw_free(skeleton);
}

static size_t skeleton_bytes(const void *object) {
  const bw_skeleton *s = object;
  return sizeof *s + (size_t)s->joint_count * (3 * sizeof(double) + sizeof(bw_name)) +
         (size_t)s->bone_count * (3 * sizeof(int32_t) + sizeof(bw_name));
}

static const bw_kind skeleton_kind = {"skeleton", skeleton_destroy, skeleton_bytes};

/* ---- names ----------------------------------------------------------------------------------- */

/* What is wrong with a name, or NULL. */
static const char *name_fault(const bw_name *name) {
  size_t length = strnlen(name->text, BW_NAME);
  if (length == BW_NAME)
    return "is too long: at most 47 bytes are kept";
  for (size_t i = 0; i < length; i++)
    if ((unsigned char)name->text[i] < 0x20 || name->text[i] == 0x7f)
      return "holds a control character (a line end, a tab)";
  if (length > 0 && (name->text[0] == ' ' || name->text[length - 1] == ' '))
    return "begins or ends with a blank";
  return NULL;
}

/* What a message calls joint or bone i: by its name where it has one, else by its number, from
 * 1. */
typedef struct label {
  char text[BW_NAME + 40];
} label;

static label label_of(const char *kind, const bw_name *name, int64_t i) {
  label made;
  if (name && name[i].text[0] && !name_fault(&name[i]))
    snprintf(made.text, sizeof made.text, "%s \"%s\"", kind, name[i].text);
  else
    snprintf(made.text, sizeof made.text, "%s %lld", kind, (long long)i + 1);
  return made;
}

static int compare_names(const void *a, const void *b) {
  return strcmp((*(const bw_name *const *)a)->text, (*(const bw_name *const *)b)->text);
}

static bool name_is_taken(const bw_name *const *sorted, size_t count, const bw_name *name) {
  return bsearch(&name, sorted, count, sizeof *sorted, compare_names) != NULL;
}

/* Check the names of one kind ("joint", "bone") and fill the empty ones. */
static bw_status settle_names(bw_context *context, const char *kind, int64_t count, bw_name *name) {
  bw_status status = BW_OK;
  const bw_name **sorted = BW_NEW(context, const bw_name *, count);
  size_t given = 0;
  if (!sorted)
    return BW_MEMORY;
  for (int64_t i = 0; i < count; i++) {
    const char *fault = name_fault(&name[i]);
    if (fault) {
      status = bw_fail(context, BW_INVALID, "the name of %s %lld, '%.*s', %s", kind,
                       (long long)i + 1, BW_NAME, name[i].text, fault);
      bw_detail_number(context, kind, (double)i + 1);
      goto done;
    }
    if (name[i].text[0])
      sorted[given++] = &name[i];
  }
  qsort(sorted, given, sizeof *sorted, compare_names);
  for (size_t i = 1; i < given; i++)
    if (strcmp(sorted[i - 1]->text, sorted[i]->text) == 0) {
      long long a = sorted[i - 1] - name, b = sorted[i] - name;
      status = bw_fail(context, BW_INVALID, "the name '%s' is used twice, by %ss %lld and %lld",
                       sorted[i]->text, kind, (a < b ? a : b) + 1, (a < b ? b : a) + 1);
      bw_detail_number(context, kind, (double)(a < b ? b : a) + 1);
      bw_detail_text(context, "name", sorted[i]->text);
      goto done;
    }
  int64_t spare = count;
  for (int64_t i = 0; i < count; i++) {
    if (name[i].text[0])
      continue;
    bw_name made;
    snprintf(made.text, sizeof made.text, "%s %lld", kind, (long long)i + 1);
    while (name_is_taken(sorted, given, &made))
      snprintf(made.text, sizeof made.text, "%s %lld", kind, (long long)++spare);
    name[i] = made;
  }
done:
  bw_free(sorted);
  return status;
}

/* ---- the tree -------------------------------------------------------------------------------- */

/* Bones around each joint: those of joint j are bone[start[j]] .. bone[start[j + 1] - 1]. */
typedef struct star {
  int32_t *start, *bone;
} star;

static bw_status star_create(bw_context *context, int32_t joints, int32_t bones,
                             const int32_t *ends, star *out) {
  out->start = BW_NEW0(context, int32_t, (size_t)joints + 2);
  out->bone = BW_NEW(context, int32_t, 2 * (size_t)bones);
  if (!out->start || !out->bone)
    return BW_MEMORY;
  for (int64_t i = 0; i < 2 * (int64_t)bones; i++)
    out->start[ends[i] + 2]++;
  for (int32_t j = 0; j < joints; j++)
    out->start[j + 2] += out->start[j + 1];
  for (int64_t i = 0; i < 2 * (int64_t)bones; i++)
    out->bone[out->start[ends[i] + 1]++] = (int32_t)(i / 2);
  return BW_OK;
}

static void star_clear(star *s) {
  bw_free(s->start);
  bw_free(s->bone);
}

static double distance(const double *joint, int32_t a, int32_t b) {
  const double *x = joint + 3 * (size_t)a, *y = joint + 3 * (size_t)b;
  return hypot(hypot(x[0] - y[0], x[1] - y[1]), x[2] - y[2]);
}

/* Walk from a joint: `through[j]` is the bone by which j is reached (-1 at the start, -2 where it
 * is not reached), `length[j]` the way there. Returns how many joints are reached; `queue` holds
 * them, near ones (by bones) first. */
static int32_t walk(const star *around, int32_t joints, const double *joint, const int32_t *ends,
                    int32_t from, int32_t *through, double *length, int32_t *queue) {
  for (int32_t j = 0; j < joints; j++)
    through[j] = -2;
  int32_t count = 0;
  queue[count++] = from;
  through[from] = -1;
  length[from] = 0;
  for (int32_t i = 0; i < count; i++) {
    int32_t j = queue[i];
    for (int32_t k = around->start[j]; k < around->start[j + 1]; k++) {
      int32_t b = around->bone[k];
      int32_t other = ends[2 * (int64_t)b] == j ? ends[2 * (int64_t)b + 1] : ends[2 * (int64_t)b];
      if (through[other] != -2)
        continue;
      through[other] = b;
      length[other] = length[j] + distance(joint, j, other);
      queue[count++] = other;
    }
  }
  return count;
}

static int32_t farthest(int32_t joints, const double *length) {
  int32_t best = 0;
  for (int32_t j = 1; j < joints; j++)
    if (length[j] > length[best])
      best = j;
  return best;
}

/* In a tree the joint farthest from any joint is one end of the longest way. The lowest of the
 * joints that are as good within rounding, so that a moved skeleton keeps its root. */
static int32_t middle_joint(const star *around, int32_t joints, const double *joint,
                            const int32_t *ends, int32_t *through, double *a, double *b,
                            int32_t *queue) {
  walk(around, joints, joint, ends, 0, through, a, queue);
  int32_t one = farthest(joints, a);
  walk(around, joints, joint, ends, one, through, a, queue);
  int32_t other = farthest(joints, a);
  double longest = a[other], best = longest;
  walk(around, joints, joint, ends, other, through, b, queue);
  for (int32_t j = 0; j < joints; j++)
    best = fmin(best, fmax(a[j], b[j]));
  for (int32_t j = 0; j < joints; j++)
    if (fmax(a[j], b[j]) <= best + 1e-9 * longest)
      return j;
  return one;
}

/* Bones turned to point away from the root and sorted so that parents come first; an order that
 * has them first already is kept. */
static void direct_bones(bw_skeleton *s, const int32_t *ends, const bw_name *name,
                         const int32_t *through, int32_t *place, int32_t *stack) {
  int32_t next = 0;
  for (int32_t b = 0; b < s->bone_count; b++)
    place[b] = -1;
  for (int32_t b = 0; b < s->bone_count; b++) {
    int32_t depth = 0;
    for (int32_t up = b; up >= 0 && place[up] < 0;) {
      stack[depth++] = up;
      const int32_t *end = ends + 2 * (size_t)up;
      up = through[through[end[1]] == up ? end[0] : end[1]];
    }
    while (depth > 0) {
      int32_t from = stack[--depth], to = next++;
      const int32_t *end = ends + 2 * (size_t)from;
      bool along = through[end[1]] == from;
      s->bone[2 * (size_t)to] = along ? end[0] : end[1];
      s->bone[2 * (size_t)to + 1] = along ? end[1] : end[0];
      int32_t up = through[s->bone[2 * (size_t)to]];
      s->parent[to] = up < 0 ? -1 : place[up];
      if (name)
        s->bone_name[to] = name[from];
      place[from] = to;
    }
  }
}

/* ---- checks ---------------------------------------------------------------------------------- */

static bw_status check_counts(bw_context *context, int64_t joints, int64_t bones, int32_t root) {
  if (joints < 2 || bones < 1)
    return bw_fail(context, BW_INVALID,
                   "a skeleton of %lld joints and %lld bones: at least two joints and a bone "
                   "between them are needed",
                   (long long)joints, (long long)bones);
  if (joints > INT32_MAX / 4 || bones > INT32_MAX / 4)
    return bw_fail(context, BW_LIMIT, "a skeleton of %lld joints and %lld bones: at most %d",
                   (long long)joints, (long long)bones, INT32_MAX / 4);
  if (root < -1 || root >= joints)
    return bw_fail(context, BW_INVALID,
                   "joint %d cannot be the root: the joints are 1 to %lld (0: the middle one)",
                   root + 1, (long long)joints);
  return BW_OK;
}

static bw_status fail_bone(bw_context *context, int64_t bone) {
  bw_detail_number(context, "bone", (double)bone + 1);
  return BW_INVALID;
}

/* Joints finite, indices in range, bones longer than 1e-9 of the box. */
static bw_status check_geometry(bw_context *context, int64_t joints, const double *joint,
                                const bw_name *joint_name, int64_t bones, const int32_t *ends,
                                const bw_name *bone_name) {
  double low[3] = {HUGE_VAL, HUGE_VAL, HUGE_VAL}, high[3] = {-HUGE_VAL, -HUGE_VAL, -HUGE_VAL};
  for (int64_t j = 0; j < joints; j++)
    for (int k = 0; k < 3; k++) {
      double x = joint[3 * j + k];
      if (!(fabs(x) < 1e100)) {
        bw_fail(context, BW_INVALID,
                "%s is at (%g, %g, %g): every coordinate must be a number of ordinary size",
                label_of("joint", joint_name, j).text, joint[3 * j], joint[3 * j + 1],
                joint[3 * j + 2]);
        bw_detail_number(context, "joint", (double)j + 1);
        return BW_INVALID;
      }
      low[k] = fmin(low[k], x);
      high[k] = fmax(high[k], x);
    }
  double size = hypot(hypot(high[0] - low[0], high[1] - low[1]), high[2] - low[2]);
  for (int64_t b = 0; b < bones; b++) {
    int32_t head = ends[2 * b], tail = ends[2 * b + 1];
    if (head < 0 || tail < 0 || head >= joints || tail >= joints) {
      bw_fail(context, BW_INVALID, "%s joins joints %d and %d, but the joints are 1 to %lld",
              label_of("bone", bone_name, b).text, head + 1, tail + 1, (long long)joints);
      return fail_bone(context, b);
    }
    if (!(distance(joint, head, tail) > 1e-9 * size)) {
      bw_fail(context, BW_INVALID, "%s, from %s to %s, has no length: both are at (%g, %g, %g)",
              label_of("bone", bone_name, b).text, label_of("joint", joint_name, head).text,
              label_of("joint", joint_name, tail).text, joint[3 * (int64_t)head],
              joint[3 * (int64_t)head + 1], joint[3 * (int64_t)head + 2]);
      return fail_bone(context, b);
    }
  }
  return BW_OK;
}

/* The first bone that closes a cycle, or a joint that no way leads to. */
static bw_status check_tree(bw_context *context, int32_t joints, const bw_name *joint_name,
                            int32_t bones, const int32_t *ends, const bw_name *bone_name,
                            int32_t *group) {
  for (int32_t j = 0; j < joints; j++)
    group[j] = j;
  for (int32_t b = 0; b < bones; b++) {
    int32_t i = ends[2 * (size_t)b], k = ends[2 * (size_t)b + 1];
    int32_t one = bwi_set_root(group, i), other = bwi_set_root(group, k);
    if (one == other) {
      bw_fail(context, BW_INVALID,
              "%s, from %s to %s, closes a cycle: these joints are joined already; a skeleton is a "
              "tree",
              label_of("bone", bone_name, b).text, label_of("joint", joint_name, i).text,
              label_of("joint", joint_name, k).text);
      return fail_bone(context, b);
    }
    bwi_set_join(group, one, other);
  }
  for (int32_t j = 0; j < joints; j++)
    if (bwi_set_root(group, j) != bwi_set_root(group, 0)) {
      bw_fail(context, BW_INVALID, "%s is not connected: no way along bones leads from %s to it",
              label_of("joint", joint_name, j).text, label_of("joint", joint_name, 0).text);
      bw_detail_number(context, "joint", j + 1.0);
      return BW_INVALID;
    }
  return BW_OK;
}

/* ---- public ---------------------------------------------------------------------------------- */

bw_status bw_skeleton_create(bw_context *context, int64_t joints, const double *joint,
                             const bw_name *joint_name, int64_t bones, const int32_t *bone,
                             const bw_name *bone_name, int32_t root, bw_skeleton **skeleton) {
  bw_status status = BW_OK;
  bw_skeleton *made = NULL;
  star around = {NULL, NULL};
  int32_t *through = NULL, *queue = NULL, *place = NULL;
  double *a = NULL, *b = NULL;
  BW_TRY(check_counts(context, joints, bones, root));
  BW_TRY(check_geometry(context, joints, joint, joint_name, bones, bone, bone_name));
  made = BW_NEW0(context, bw_skeleton, 1);
  through = BW_NEW(context, int32_t, joints);
  queue = BW_NEW(context, int32_t, joints);
  place = BW_NEW(context, int32_t, bones);
  a = BW_NEW(context, double, joints);
  b = BW_NEW(context, double, joints);
  if (made)
    bw_object_init(made, &skeleton_kind);
  BW_TRY_MEMORY(made && through && queue && place && a && b);
  BW_TRY(check_tree(context, (int32_t)joints, joint_name, (int32_t)bones, bone, bone_name, queue));
  made->joint_count = (int32_t)joints;
  made->bone_count = (int32_t)bones;
  made->joint = BW_NEW(context, double, 3 * joints);
  made->joint_name = BW_NEW0(context, bw_name, joints);
  made->bone = BW_NEW(context, int32_t, 2 * bones);
  made->bone_name = BW_NEW0(context, bw_name, bones);
  made->parent = BW_NEW(context, int32_t, bones);
  BW_TRY_MEMORY(made->joint && made->joint_name && made->bone && made->bone_name && made->parent);
  memcpy(made->joint, joint, 3 * (size_t)joints * sizeof *joint);
  if (joint_name)
    memcpy(made->joint_name, joint_name, (size_t)joints * sizeof *joint_name);
  BW_TRY(star_create(context, (int32_t)joints, (int32_t)bones, bone, &around));
  made->root =
      root >= 0 ? root : middle_joint(&around, (int32_t)joints, joint, bone, through, a, b, queue);
  walk(&around, (int32_t)joints, joint, bone, made->root, through, a, queue);
  direct_bones(made, bone, bone_name, through, place, queue);
  BW_TRY(settle_names(context, "joint", joints, made->joint_name));
  BW_TRY(settle_names(context, "bone", bones, made->bone_name));
done:
  star_clear(&around);
  bw_free(through);
  bw_free(queue);
  bw_free(place);
  bw_free(a);
  bw_free(b);
  if (status == BW_OK)
    *skeleton = made;
  else
    bw_release(made);
  return status;
}

static int32_t find_name(const bw_name *list, int32_t count, const char *name) {
  for (int32_t i = 0; i < count; i++)
    if (strcmp(list[i].text, name) == 0)
      return i;
  return -1;
}

int32_t bw_skeleton_find_joint(const bw_skeleton *skeleton, const char *name) {
  return find_name(skeleton->joint_name, skeleton->joint_count, name);
}

int32_t bw_skeleton_find_bone(const bw_skeleton *skeleton, const char *name) {
  return find_name(skeleton->bone_name, skeleton->bone_count, name);
}

void bw_skeleton_frames(const bw_skeleton *skeleton, double *frame) {
  for (int32_t b = 0; b < skeleton->bone_count; b++) {
    const double *head = skeleton->joint + 3 * (size_t)skeleton->bone[2 * (size_t)b];
    const double *tail = skeleton->joint + 3 * (size_t)skeleton->bone[2 * (size_t)b + 1];
    double *x = frame + 9 * (size_t)b, *y = x + 3, *z = x + 6;
    double length = hypot(hypot(tail[0] - head[0], tail[1] - head[1]), tail[2] - head[2]);
    for (int k = 0; k < 3; k++)
      x[k] = (tail[k] - head[k]) / length;
    bw_across(x, z, y);
    for (int k = 0; k < 3; k++)
      y[k] = -y[k];
  }
}
