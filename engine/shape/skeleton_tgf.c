/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* Skeletons in the trivial graph format:
 *
 *   number x y z [name]      a joint; numbers are any distinct integers
 *   #
 *   from to [name]           a bone; three flags of 0 or 1 may stand before the name
 *
 * The flags are those of libigl: bone, pseudo-edge, edge of a cage. Edges that are no bones are
 * passed over with a warning. A name is the rest of its line. The format has no place for a root:
 * where every bone points away from one joint, which is how skeletons are written here, that joint
 * is the root, else the middle one is. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "io/internal.h"
#include "shape/internal.h"

typedef struct numbered {
  int64_t number, line;
  int32_t joint;
} numbered;

typedef struct draft {
  bw_context *context;
  double *joint;
  bw_name *joint_name;
  numbered *of; /* by joint, then sorted by number */
  int32_t *bone;
  bw_name *bone_name;
  int64_t *joint_line, *bone_line;
  size_t joints, bones, skipped;
  size_t joint_capacity, joint_name_capacity, of_capacity, joint_line_capacity;
  size_t bone_capacity, bone_name_capacity, bone_line_capacity;
} draft;

static void draft_clear(draft *d) {
  bw_free(d->joint);
  bw_free(d->joint_name);
  bw_free(d->of);
  bw_free(d->bone);
  bw_free(d->bone_name);
  bw_free(d->joint_line);
  bw_free(d->bone_line);
}

/* The rest of the line without blanks at its ends; other blanks than spaces become spaces. */
static bw_status read_name(bwi_cursor *line, bw_name *name) {
  bwi_skip_blank(line);
  const unsigned char *end = line->end;
  while (end > line->at && (end[-1] == ' ' || (end[-1] >= '\t' && end[-1] <= '\r')))
    end--;
  size_t length = (size_t)(end - line->at);
  memset(name, 0, sizeof *name);
  if (length >= BW_NAME)
    return bwi_fail_line(line, "the name '%s...' has %zu bytes: at most %d are kept",
                         bwi_show((bwi_word){line->at, 20}), length, BW_NAME - 1);
  for (size_t i = 0; i < length; i++) {
    unsigned char c = line->at[i];
    if (c == '\t' || c == '\v' || c == '\f')
      c = ' ';
    if (c < 0x20 || c == 0x7f)
      return bwi_fail_line(line, "a name holds the control character of code %d", c);
    name->text[i] = (char)c;
  }
  line->at = line->end;
  return BW_OK;
}

/* Three words of 0 or 1 at the cursor, which then moves past them. */
static bool take_flags(bwi_cursor *line, bool *is_bone) {
  bwi_cursor at = *line;
  bwi_word word;
  for (int k = 0; k < 3; k++) {
    if (!bwi_next_word(&at, &word) || word.length != 1 || (*word.at != '0' && *word.at != '1'))
      return false;
    if (k == 0)
      *is_bone = *word.at == '1';
  }
  *line = at;
  return true;
}

static bw_status read_joint(bwi_cursor *line, double unit, draft *d) {
  bw_status status = BW_OK;
  bw_context *c = d->context;
  int64_t number;
  if (!bw_grow(c, (void **)&d->joint, &d->joint_capacity, 3 * d->joints, 3, sizeof *d->joint) ||
      !bw_grow(c, (void **)&d->joint_name, &d->joint_name_capacity, d->joints, 1,
               sizeof *d->joint_name) ||
      !bw_grow(c, (void **)&d->of, &d->of_capacity, d->joints, 1, sizeof *d->of) ||
      !bw_grow(c, (void **)&d->joint_line, &d->joint_line_capacity, d->joints, 1,
               sizeof *d->joint_line))
    return BW_MEMORY;
  BW_TRY(bwi_read_integer(line, &number, "the number of a joint (or '#' before the bones)"));
  for (size_t k = 0; k < 3; k++) {
    double *x = &d->joint[3 * d->joints + k];
    BW_TRY(bwi_read_real(line, x, "a coordinate of a joint"));
    *x *= unit;
  }
  BW_TRY(read_name(line, &d->joint_name[d->joints]));
  d->of[d->joints] = (numbered){number, line->line, (int32_t)d->joints};
  d->joint_line[d->joints] = line->line;
  d->joints++;
  if (d->joints > INT32_MAX / 4)
    status = bw_fail(c, BW_LIMIT, "%s: more than %d joints", line->name, INT32_MAX / 4);
done:
  return status;
}

static int compare_numbers(const void *a, const void *b) {
  const numbered *x = a, *y = b;
  if (x->number != y->number)
    return x->number < y->number ? -1 : 1;
  return x->joint < y->joint ? -1 : x->joint > y->joint;
}

static bw_status sort_joints(const bwi_cursor *cursor, draft *d) {
  if (d->joints == 0)
    return bwi_fail_line(cursor, "no joint stands before '#': lines \"number x y z [name]\" were "
                                 "expected");
  qsort(d->of, d->joints, sizeof *d->of, compare_numbers);
  for (size_t i = 1; i < d->joints; i++)
    if (d->of[i - 1].number == d->of[i].number) {
      bwi_cursor at = *cursor;
      at.line = d->of[i].line;
      return bwi_fail_line(&at, "the number %lld is that of the joint on line %lld already",
                           (long long)d->of[i].number, (long long)d->of[i - 1].line);
    }
  return BW_OK;
}

static bw_status read_end(bwi_cursor *line, const draft *d, int32_t *joint) {
  int64_t number;
  bw_status status = bwi_read_integer(line, &number, "the number of a joint at the end of a bone");
  if (status != BW_OK)
    return status;
  size_t low = 0, high = d->joints;
  while (low < high) {
    size_t middle = (low + high) / 2;
    if (d->of[middle].number < number)
      low = middle + 1;
    else
      high = middle;
  }
  if (low == d->joints || d->of[low].number != number)
    return bwi_fail_line(line, "a bone ends at joint %lld, which is not among the %zu joints above",
                         (long long)number, d->joints);
  *joint = d->of[low].joint;
  return BW_OK;
}

static bw_status read_bone(bwi_cursor *line, draft *d) {
  bw_status status = BW_OK;
  bw_context *c = d->context;
  bool is_bone = true;
  if (!bw_grow(c, (void **)&d->bone, &d->bone_capacity, 2 * d->bones, 2, sizeof *d->bone) ||
      !bw_grow(c, (void **)&d->bone_name, &d->bone_name_capacity, d->bones, 1,
               sizeof *d->bone_name) ||
      !bw_grow(c, (void **)&d->bone_line, &d->bone_line_capacity, d->bones, 1,
               sizeof *d->bone_line))
    return BW_MEMORY;
  BW_TRY(read_end(line, d, &d->bone[2 * d->bones]));
  BW_TRY(read_end(line, d, &d->bone[2 * d->bones + 1]));
  take_flags(line, &is_bone);
  BW_TRY(read_name(line, &d->bone_name[d->bones]));
  d->bone_line[d->bones] = line->line;
  if (is_bone)
    d->bones++;
  else
    d->skipped++;
done:
  return status;
}

/* The one joint from which all bones point away, or -1. */
static bw_status find_root(const draft *d, int32_t *root) {
  uint8_t *ends_at = BW_NEW0(d->context, uint8_t, d->joints);
  if (!ends_at)
    return BW_MEMORY;
  int64_t starts = 0;
  *root = -1;
  for (size_t b = 0; b < d->bones; b++)
    if (ends_at[d->bone[2 * b + 1]] < 2)
      ends_at[d->bone[2 * b + 1]]++;
  for (size_t j = 0; j < d->joints; j++)
    if (ends_at[j] != 1) {
      starts += ends_at[j] == 0 ? 1 : 2;
      *root = (int32_t)j;
    }
  if (starts != 1)
    *root = -1;
  bw_free(ends_at);
  return BW_OK;
}

/* Say of a refusal by bw_skeleton_create on which line the joint or bone stands. */
static bw_status add_line(const bwi_cursor *cursor, const draft *d) {
  bwi_cursor at = *cursor;
  const char *key, *text;
  double value;
  char message[512];
  for (int i = 0; bw_detail(d->context, i, &key, &value, &text); i++) {
    if (strcmp(key, "joint") == 0)
      at.line = d->joint_line[(size_t)value - 1];
    else if (strcmp(key, "bone") == 0)
      at.line = d->bone_line[(size_t)value - 1];
  }
  size_t length = strlen(bw_message(d->context));
  length = length < sizeof message - 1 ? length : sizeof message - 1;
  memcpy(message, bw_message(d->context), length);
  message[length] = 0;
  return bwi_fail_line(&at, "%s", message);
}

bw_status bwi_tgf_parse(bw_context *context, const char *name, const unsigned char *bytes,
                        size_t count, double unit, bw_skeleton **skeleton) {
  bw_status status = BW_OK;
  draft d = {.context = context};
  bwi_cursor cursor, line;
  bool bones = false;
  int32_t root;
  bwi_cursor_init(&cursor, context, name, bytes, count);
  while (bwi_next_line(&cursor, &line)) {
    bwi_skip_blank(&line);
    if (line.at == line.end)
      continue;
    bwi_word word = bwi_peek_word(&line);
    if (!bones && *word.at == '#') {
      BW_TRY(sort_joints(&line, &d));
      bones = true;
    } else if (bones)
      BW_TRY(read_bone(&line, &d));
    else
      BW_TRY(read_joint(&line, unit, &d));
    if (line.line % 65536 == 0)
      BW_TRY(bw_check_cancel(context));
  }
  if (!bones)
    BW_TRY(bwi_fail_line(&cursor, "the file ends before '#', the line between joints and bones"));
  BW_TRY(find_root(&d, &root));
  status = bw_skeleton_create(context, (int64_t)d.joints, d.joint, d.joint_name, (int64_t)d.bones,
                              d.bone, d.bone_name, root, skeleton);
  if (status == BW_INVALID)
    status = add_line(&cursor, &d);
  if (status == BW_OK && d.skipped)
    bw_warn(context, "%s: %zu edges are marked as not being bones and were ignored", name,
            d.skipped);
done:
  draft_clear(&d);
  return status;
}

static bw_status check_unit(bw_context *context, double unit) {
  if (unit > 0 && unit < 1e100)
    return BW_OK;
  return bw_fail(context, BW_INVALID, "a unit of %g m: a length above 0 expected", unit);
}

bw_status bw_skeleton_read_tgf(bw_context *context, const char *path, double unit,
                               bw_skeleton **skeleton) {
  bw_status status = BW_OK;
  unsigned char *bytes = NULL;
  size_t count = 0;
  BW_TRY(check_unit(context, unit));
  BW_TRY(bw_read_file(context, path, &bytes, &count));
  BW_TRY(bwi_tgf_parse(context, path, bytes, count, unit, skeleton));
done:
  bw_free(bytes);
  return status;
}

/* A name that begins like flags is written behind flags. */
static bool needs_flags(const bw_name *name) {
  bwi_cursor at;
  bool is_bone;
  bwi_cursor_init(&at, NULL, "", (const unsigned char *)name->text, strlen(name->text));
  return take_flags(&at, &is_bone);
}

bw_status bw_skeleton_write_tgf(bw_context *context, const bw_skeleton *skeleton, const char *path,
                                double unit) {
  bw_writer *writer = NULL;
  bw_status status = check_unit(context, unit);
  if (status != BW_OK || (status = bw_writer_open(context, path, &writer)) != BW_OK)
    return status;
  for (int32_t j = 0; j < skeleton->joint_count; j++) {
    bw_writer_integer(writer, (int64_t)j + 1);
    for (int k = 0; k < 3; k++) {
      bw_writer_bytes(writer, " ", 1);
      bw_writer_number(writer, skeleton->joint[3 * (size_t)j + (size_t)k] / unit);
    }
    bw_writer_print(writer, " %s\n", skeleton->joint_name[j].text);
  }
  bw_writer_print(writer, "#\n");
  for (int32_t b = 0; b < skeleton->bone_count; b++)
    bw_writer_print(writer, "%d %d %s%s\n", skeleton->bone[2 * (size_t)b] + 1,
                    skeleton->bone[2 * (size_t)b + 1] + 1,
                    needs_flags(&skeleton->bone_name[b]) ? "1 0 0 " : "",
                    skeleton->bone_name[b].text);
  return bw_writer_commit(writer);
}
