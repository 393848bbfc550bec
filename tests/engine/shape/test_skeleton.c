/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* Skeletons: trees and refusals, names, frames, edits, TGF files. */
#include <locale.h>
#include <unistd.h>

#include "check.h"
#include "shape/internal.h"

static bw_name name(const char *text) {
  bw_name made = {""};
  strncpy(made.text, text, BW_NAME - 1);
  return made;
}

/* A body with two arms and two legs:
 *      0 head
 *   3--1--4       arms
 *      2          hip
 *     5 6         feet */
static const double man_joint[7 * 3] = {0, 5, 0, 0, 4,  0, 0, 2, 0, -2, 4,
                                        0, 2, 4, 0, -1, 0, 0, 1, 0, 0};
static const int32_t man_bone[6 * 2] = {2, 5, 6, 2, 1, 2, 1, 0, 1, 3, 4, 1};

static bw_skeleton *man(bw_context *context, int32_t root) {
  const bw_name bones[6] = {name("left leg"), name("right leg"), name("trunk"),
                            name("neck"),     name("left arm"),  name("")};
  bw_skeleton *made = NULL;
  check_ok(context,
           bw_skeleton_create(context, 7, man_joint, NULL, 6, man_bone, bones, root, &made));
  return made;
}

/* What every skeleton promises. */
static void check_skeleton(const bw_skeleton *s) {
  assert_int_equal(s->bone_count, s->joint_count - 1);
  assert_true(s->root >= 0 && s->root < s->joint_count);
  for (int32_t b = 0; b < s->bone_count; b++) {
    int32_t head = s->bone[2 * b];
    assert_true(s->parent[b] < b);
    if (s->parent[b] < 0)
      assert_int_equal(head, s->root);
    else
      assert_int_equal(head, s->bone[2 * s->parent[b] + 1]);
    assert_int_equal(bw_skeleton_find_bone(s, s->bone_name[b].text), b);
  }
  for (int32_t j = 0; j < s->joint_count; j++)
    assert_int_equal(bw_skeleton_find_joint(s, s->joint_name[j].text), j);
}

static void a_tree_is_directed_away_from_its_root(void **state) {
  bw_context *context = check_context(state);
  for (int32_t root = -1; root < 7; root++) {
    bw_skeleton *s = man(context, root);
    check_skeleton(s);
    /* the farthest joint from the neck's base is 2 + sqrt 5 away, from the hip 4 */
    assert_int_equal(s->root, root < 0 ? 2 : root);
    int32_t trunk = bw_skeleton_find_bone(s, "trunk");
    bool down = s->root == 0 || s->root == 1 || s->root == 3 || s->root == 4;
    assert_int_equal(s->bone[2 * trunk], down ? 1 : 2);
    assert_string_equal(s->joint_name[4].text, "joint 5");
    bw_release(s);
  }
}

static void an_order_with_parents_first_is_kept(void **state) {
  bw_context *context = check_context(state);
  static const int32_t bone[6 * 2] = {1, 2, 1, 3, 2, 5, 1, 4, 2, 6, 1, 0};
  bw_skeleton *s = NULL;
  check_ok(context, bw_skeleton_create(context, 7, man_joint, NULL, 6, bone, NULL, 1, &s));
  check_skeleton(s);
  assert_memory_equal(s->bone, bone, sizeof bone);
  assert_string_equal(s->bone_name[5].text, "bone 6");
  bw_release(s);
}

static void names_that_are_taken_are_stepped_over(void **state) {
  bw_context *context = check_context(state);
  const bw_name joints[7] = {name("joint 2"), {""}, {""}, name("joint 8"), {""}, {""}, {""}};
  bw_skeleton *s = NULL;
  check_ok(context, bw_skeleton_create(context, 7, man_joint, joints, 6, man_bone, NULL, 1, &s));
  check_skeleton(s);
  assert_string_equal(s->joint_name[0].text, "joint 2");
  assert_string_equal(s->joint_name[1].text, "joint 9");
  assert_string_equal(s->joint_name[2].text, "joint 3");
  assert_int_equal(bw_skeleton_find_joint(s, "elbow"), -1);
  bw_release(s);
}

static void what_is_no_tree_is_refused(void **state) {
  bw_context *context = check_context(state);
  bw_skeleton *s = NULL;
  double joint[7 * 3];
  int32_t bone[6 * 2];
  bw_name names[7];
#define TRY_CREATE(joints, bones, root)                                                            \
  bw_skeleton_create(context, joints, joint, NULL, bones, bone, NULL, root, &s)
#define RESET()                                                                                    \
  (memcpy(joint, man_joint, sizeof joint), memcpy(bone, man_bone, sizeof bone),                    \
   memset(names, 0, sizeof names))
  RESET();
  check_fails(context, BW_INVALID, "at least two joints", TRY_CREATE(1, 0, -1));
  check_fails(context, BW_INVALID, "at least two joints", TRY_CREATE(2, 0, -1));
  check_fails(context, BW_INVALID, "joint 8 cannot be the root", TRY_CREATE(7, 6, 7));
  check_fails(context, BW_LIMIT, "at most", TRY_CREATE((int64_t)1 << 40, 6, -1));
  check_fails(context, BW_INVALID, "joint 5 is not connected", TRY_CREATE(7, 5, -1));
  bone[10] = 7;
  check_fails(context, BW_INVALID, "bone 6 joins joints 8 and 2", TRY_CREATE(7, 6, -1));
  RESET();
  bone[9] = 2; /* arm 1-3 becomes 1-2 a second time */
  check_fails(context, BW_INVALID, "bone 5, from joint 2 to joint 3, closes", TRY_CREATE(7, 6, -1));
  RESET();
  bone[9] = 1;
  check_fails(context, BW_INVALID, "has no length", TRY_CREATE(7, 6, -1));
  RESET();
  memcpy(joint + 9, joint + 3, 3 * sizeof *joint);
  check_fails(context, BW_INVALID, "bone 5, from joint 2 to joint 4, has no", TRY_CREATE(7, 6, -1));
  RESET();
  joint[8] = NAN;
  check_fails(context, BW_INVALID, "joint 3 is at", TRY_CREATE(7, 6, -1));
  joint[8] = 1e200;
  check_fails(context, BW_INVALID, "joint 3 is at", TRY_CREATE(7, 6, -1));
  RESET();
#define TRY_NAMES(text_a, text_b)                                                                  \
  (names[2] = name(text_a), names[4] = name(text_b),                                               \
   bw_skeleton_create(context, 7, joint, names, 6, bone, NULL, -1, &s))
  check_fails(context, BW_INVALID, "'hip' is used twice, by joints 3 and 5",
              TRY_NAMES("hip", "hip"));
  check_fails(context, BW_INVALID, "control character", TRY_NAMES("hip\n", ""));
  check_fails(context, BW_INVALID, "blank", TRY_NAMES(" hip", ""));
  check_fails(context, BW_INVALID, "blank", TRY_NAMES("hip ", ""));
  RESET();
  memset(names[3].text, 'a', BW_NAME);
  check_fails(context, BW_INVALID, "too long",
              bw_skeleton_create(context, 7, joint, NULL, 6, bone, names, -1, &s));
  assert_null(s);
#undef TRY_CREATE
#undef TRY_NAMES
#undef RESET
}

static void frames_are_right_handed_and_follow_the_bones(void **state) {
  bw_context *context = check_context(state);
  double joint[5 * 3] = {0, 0, 0, 2, 0, 0, 0, 3, 0, 0, 0, -1, 1, 2, 3};
  static const int32_t bone[4 * 2] = {0, 1, 0, 2, 0, 3, 0, 4};
  static const double expected[3][9] = {
      {1, 0, 0, 0, 1, 0, 0, 0, 1}, {0, 1, 0, 1, 0, 0, 0, 0, -1}, {0, 0, -1, 1, 0, 0, 0, -1, 0}};
  bw_skeleton *s = NULL;
  check_ok(context, bw_skeleton_create(context, 5, joint, NULL, 4, bone, NULL, 0, &s));
  double frame[4 * 9];
  bw_skeleton_frames(s, frame);
  for (int b = 0; b < 4; b++) {
    const double *f = frame + 9 * b;
    double inverse[9];
    check_near(bw_inverse3(f, inverse), 1, 1e-14);
    for (int i = 0; i < 3; i++)
      for (int k = 0; k < 3; k++) {
        check_near(bw_dot(f + 3 * i, f + 3 * k), i == k, 1e-14);
        if (b < 3)
          check_near(f[3 * i + k], expected[b][3 * i + k], 1e-14);
      }
  }
  check_near(frame[27], 1 / sqrt(14), 1e-14);
  /* y is as near the global x axis, least along (1, 2, 3), as it can be */
  check_near(frame[30], sqrt(13. / 14), 1e-14);
  bw_release(s);
}

/* ---- edits ----------------------------------------------------------------------------------- */

static void inserting_a_joint_cuts_a_bone(void **state) {
  bw_context *context = check_context(state);
  bw_skeleton *s = man(context, 2), *out = NULL;
  int32_t trunk = bw_skeleton_find_bone(s, "trunk");
  check_ok(context, bw_skeleton_insert_joint(context, s, trunk, 0.25, "waist", &out));
  check_skeleton(out);
  assert_int_equal(out->bone_count, 7);
  int32_t waist = bw_skeleton_find_joint(out, "waist");
  check_near(out->joint[3 * waist + 1], 2.5, 1e-15);
  trunk = bw_skeleton_find_bone(out, "trunk");
  assert_int_equal(out->bone[2 * trunk], 2);
  assert_int_equal(out->bone[2 * trunk + 1], waist);
  int32_t upper = bw_skeleton_find_bone(out, "bone 7");
  assert_int_equal(out->bone[2 * upper], waist);
  assert_int_equal(out->bone[2 * upper + 1], 1);
  assert_int_equal(out->root, 2);
  assert_int_equal(s->bone_count, 6);
  bw_release(out);
  out = NULL;
  check_fails(context, BW_INVALID, "must lie between its ends",
              bw_skeleton_insert_joint(context, s, 0, 1, NULL, &out));
  check_fails(context, BW_INVALID, "must lie between its ends",
              bw_skeleton_insert_joint(context, s, 0, NAN, NULL, &out));
  check_fails(context, BW_INVALID, "bone 7: the bones",
              bw_skeleton_insert_joint(context, s, 6, 0.5, NULL, &out));
  check_fails(context, BW_INVALID, "used twice",
              bw_skeleton_insert_joint(context, s, 0, 0.5, "joint 3", &out));
  check_fails(context, BW_INVALID, "too long",
              bw_skeleton_insert_joint(context, s, 0, 0.5,
                                       "a name of far more bytes than a skeleton has room for",
                                       &out));
  assert_null(out);
  bw_release(s);
}

static void merging_undoes_inserting(void **state) {
  bw_context *context = check_context(state);
  for (int32_t root = 0; root < 7; root++) {
    bw_skeleton *s = man(context, root), *cut = NULL, *out = NULL;
    for (int32_t b = 0; b < 6; b++) {
      check_ok(context, bw_skeleton_insert_joint(context, s, b, 0.5, NULL, &cut));
      int32_t one = bw_skeleton_find_bone(cut, s->bone_name[b].text);
      int32_t two = bw_skeleton_find_bone(cut, "bone 7");
      check_ok(context, bw_skeleton_merge_bones(context, cut, one, two, &out));
      check_skeleton(out);
      assert_memory_equal(out->joint, s->joint, sizeof man_joint);
      assert_int_equal(out->root, root);
      for (int32_t i = 0; i < 6; i++) {
        int32_t k = bw_skeleton_find_bone(out, s->bone_name[i].text);
        assert_true(k >= 0);
        assert_memory_equal(out->bone + 2 * k, s->bone + 2 * i, 2 * sizeof(int32_t));
      }
      bw_release(cut);
      bw_release(out);
      cut = out = NULL;
    }
    int32_t neck = bw_skeleton_find_bone(s, "neck"), leg = bw_skeleton_find_bone(s, "left leg");
    check_fails(context, BW_INVALID, "do not meet",
                bw_skeleton_merge_bones(context, s, neck, leg, &out));
    check_fails(context, BW_INVALID, "do not meet",
                bw_skeleton_merge_bones(context, s, neck, neck, &out));
    check_fails(context, BW_INVALID, "where 4 bones meet",
                bw_skeleton_merge_bones(context, s, neck, bw_skeleton_find_bone(s, "trunk"), &out));
    bw_release(s);
  }
}

static void the_root_moves_when_its_joint_is_merged_away(void **state) {
  bw_context *context = check_context(state);
  static const double joint[9] = {0, 0, 0, 1, 0, 0, 3, 0, 0};
  static const int32_t bone[4] = {1, 0, 1, 2};
  const bw_name names[2] = {name("left"), name("right")};
  bw_skeleton *s = NULL, *out = NULL;
  check_ok(context, bw_skeleton_create(context, 3, joint, NULL, 2, bone, names, 1, &s));
  check_ok(context, bw_skeleton_merge_bones(context, s, 1, 0, &out));
  check_skeleton(out);
  assert_string_equal(out->bone_name[0].text, "right");
  check_near(out->joint[3 * out->root], 3, 0);
  bw_release(s);
  bw_release(out);
}

static void moving_removing_and_rooting(void **state) {
  bw_context *context = check_context(state);
  bw_skeleton *s = man(context, 2), *out = NULL;
  static const double at[3] = {0, 4.5, 1};
  check_ok(context, bw_skeleton_move_joint(context, s, 1, at, &out));
  check_skeleton(out);
  assert_memory_equal(out->joint + 3, at, sizeof at);
  bw_release(out);
  out = NULL;
  check_fails(context, BW_INVALID, "has no length",
              bw_skeleton_move_joint(context, s, 1, man_joint, &out));
  check_fails(context, BW_INVALID, "joint 0: the joints",
              bw_skeleton_move_joint(context, s, -1, at, &out));

  check_ok(context, bw_skeleton_remove_bone(context, s, bw_skeleton_find_bone(s, "trunk"), &out));
  check_skeleton(out); /* with the trunk go neck and arms */
  assert_int_equal(out->bone_count, 2);
  assert_true(bw_skeleton_find_bone(out, "left leg") >= 0);
  assert_int_equal(bw_skeleton_find_joint(out, "joint 3"), out->root);
  check_fails(context, BW_INVALID, "the bones of the skeleton are",
              bw_skeleton_remove_bone(context, out, 2, &out));
  bw_release(out);
  out = NULL;

  check_ok(context, bw_skeleton_with_root(context, s, 3, &out));
  check_skeleton(out);
  assert_int_equal(out->root, 3);
  int32_t arm = bw_skeleton_find_bone(out, "left arm");
  assert_int_equal(out->parent[arm], -1);
  bw_skeleton *none = NULL;
  check_fails(context, BW_INVALID, "no bone would be left",
              bw_skeleton_remove_bone(context, out, arm, &none));
  check_fails(context, BW_INVALID, "joint 8: the joints",
              bw_skeleton_with_root(context, s, 7, &none));
  assert_null(none);
  bw_release(out);
  bw_release(s);
}

/* ---- TGF ------------------------------------------------------------------------------------- */

static void check_same(const bw_skeleton *a, const bw_skeleton *b) {
  assert_int_equal(a->joint_count, b->joint_count);
  assert_int_equal(a->root, b->root);
  size_t joints = (size_t)a->joint_count, bones = (size_t)a->bone_count;
  assert_memory_equal(a->joint, b->joint, 3 * joints * sizeof(double));
  assert_memory_equal(a->bone, b->bone, 2 * bones * sizeof(int32_t));
  assert_memory_equal(a->parent, b->parent, bones * sizeof(int32_t));
  for (size_t j = 0; j < joints; j++)
    assert_string_equal(a->joint_name[j].text, b->joint_name[j].text);
  for (size_t i = 0; i < bones; i++)
    assert_string_equal(a->bone_name[i].text, b->bone_name[i].text);
}

static void a_file_brings_back_the_same_skeleton(void **state) {
  bw_context *context = check_context(state);
  char path[] = "/tmp/barwright_skeleton_XXXXXX";
  int file = mkstemp(path);
  assert_true(file >= 0);
  close(file);
  double joint[7 * 3];
  const bw_name joints[7] = {name("#"),        name("a  b"), {""}, name("1"),
                             name("\xc3\xa4"), {""},         {""}};
  const bw_name bones[6] = {name("1 0 0"), name("0 1 0 x"), name("1 0"), {""}, name("#"), {""}};
  for (int i = 0; i < 21; i++)
    joint[i] = man_joint[i] / 3 + 1e-17 * i;
  setlocale(LC_ALL, "de_DE.UTF-8"); /* where it is installed: numbers keep their point */
  for (int32_t root = 0; root < 7; root++) {
    bw_skeleton *s = NULL, *back = NULL;
    check_ok(context, bw_skeleton_create(context, 7, joint, joints, 6, man_bone, bones, root, &s));
    check_ok(context, bw_skeleton_write_tgf(context, s, path, 1));
    check_ok(context, bw_skeleton_read_tgf(context, path, 1, &back));
    check_same(s, back);
    bw_release(back);
    check_ok(context, bw_skeleton_write_tgf(context, s, path, 1e-3));
    check_ok(context, bw_skeleton_read_tgf(context, path, 1e-3, &back));
    for (int i = 0; i < 21; i++)
      check_near(back->joint[i], s->joint[i], 1e-15);
    bw_release(back);
    bw_release(s);
  }
  setlocale(LC_ALL, "C");
  bw_skeleton *s = man(context, 2), *none = NULL;
  check_fails(context, BW_INVALID, "unit", bw_skeleton_write_tgf(context, s, path, 0));
  check_fails(context, BW_INVALID, "unit", bw_skeleton_read_tgf(context, path, NAN, &none));
  check_fails(context, BW_IO, "no_such", bw_skeleton_read_tgf(context, "no_such.tgf", 1, &none));
  unlink(path);
  bw_release(s);
}

static bw_status parse(bw_context *context, const char *text, bw_skeleton **s) {
  return bwi_tgf_parse(context, "a.tgf", (const unsigned char *)text, strlen(text), 1, s);
}

static void files_of_others_are_understood(void **state) {
  bw_context *context = check_context(state);
  bw_skeleton *s = NULL;
  check_ok(context,
           parse(context,
                 "\xef\xbb\xbf 7 0 0 0 hip\r\n\r\n-3 0 1e0 0\tthe\tknee \r\n9 0 2 .5\r\n#  \r\n"
                 "9 -3 1 0 0\r\n7 -3  thigh\r\n7 9 0 1 0",
                 &s));
  check_skeleton(s);
  assert_int_equal(s->bone_count, 2);
  assert_string_equal(s->joint_name[0].text, "hip");
  assert_string_equal(s->joint_name[1].text, "the knee");
  assert_int_equal(s->root, 1); /* the bones point nowhere in common: the middle joint */
  assert_string_equal(s->bone_name[0].text, "bone 1");
  assert_string_equal(s->bone_name[1].text, "thigh");
  assert_non_null(strstr(bw_warning_at(context, 0), "1 edges"));
  bw_release(s);
}

static void malformed_files_are_refused_by_line(void **state) {
  bw_context *context = check_context(state);
  static const struct {
    const char *text, *said;
  } bad[] = {
      {"", "a.tgf:1: the file ends before '#'"},
      {"1 0 0 0\n2 1 0 0\n", "the file ends before '#'"},
      {"#\n1 2\n", "a.tgf:1: no joint"},
      {"1 0 0\n#\n", "a.tgf:1: the line ends where a coordinate"},
      {"1 0 0 0\n2 1 x 0\n#\n", "a.tgf:2: found 'x'"},
      {"1 0 0 0\n2 1,5 0 0\n#\n", "a decimal point"},
      {"1 0 0 nan\n#\n", "finite"},
      {"1 0 0 0\n\n1 1 0 0\n#\n1 1\n", "a.tgf:3: the number 1 is that of the joint on line 1"},
      {"1 0 0 0\n2 1 0 0\n#\n1 3\n", "a.tgf:4: a bone ends at joint 3"},
      {"1 0 0 0\n2 1 0 0\n#\n1\n", "a.tgf:4: the line ends"},
      {"1 0 0 0\n2 1 0 0\n3 2 0 0\n#\n1 2\n", "a.tgf:3: joint 3 is not"},
      {"1 0 0 0\n2 1 0 0\n3 2 0 0\n#\n1 2\n3 2\n1 3\n", "a.tgf:7: bone 3"},
      {"1 0 0 0\n2 0 0 0\n3 2 0 0\n#\n1 2\n3 2\n", "a.tgf:5: bone 1"},
      {"1 0 0 0\n2 1 0 0\n#\n1 1\n", "a.tgf:4: bone 1"},
      {"1 0 0 0 a\n2 1 0 0 a\n#\n1 2\n", "a.tgf:2: the name 'a' is used twice"},
      {"1 0 0 0 a\x01z\n2 1 0 0\n#\n1 2\n", "a.tgf:1: a name holds the control character"},
      {"1 0 0 0\n2 1e300 0 0\n#\n1 2\n", "a.tgf:2: joint 2"},
      {"1 0 0 0\n2 1 0 0\n#\n1 2 a name of more than forty-seven bytes, which is the most\n",
       "a.tgf:4: the name"},
  };
  for (size_t i = 0; i < sizeof bad / sizeof *bad; i++) {
    bw_skeleton *s = NULL;
    check_fails(context, BW_FORMAT, bad[i].said, parse(context, bad[i].text, &s));
    assert_null(s);
    const char *key, *text;
    double line;
    bool found = false;
    for (int k = 0; bw_detail(context, k, &key, &line, &text); k++)
      found = found || strcmp(key, "line") == 0;
    assert_true(found);
  }
}

/* ---- memory ---------------------------------------------------------------------------------- */

static void every_failing_allocation_is_survived(void **state) {
  bw_context *context = check_context(state);
  bw_skeleton *s = man(context, 2);
  for (int what = 0; what < 5; what++)
    for (int64_t n = 1;; n++) {
      bw_skeleton *out = NULL;
      bw_fail_allocation(n, true);
      bw_status status =
          what == 0   ? bw_skeleton_create(context, 7, man_joint, NULL, 6, man_bone, NULL, -1, &out)
          : what == 1 ? bw_skeleton_insert_joint(context, s, 0, 0.5, NULL, &out)
          : what == 2 ? bw_skeleton_merge_bones(context, s, 0, 1, &out)
          : what == 3 ? bw_skeleton_remove_bone(context, s, 0, &out)
                      : parse(context, "1 0 0 0\n2 1 0 0\n#\n1 2\n", &out);
      bw_fail_allocation(0, false);
      assert_true((status == BW_OK || status == BW_INVALID) == (status != BW_MEMORY));
      assert_true((status == BW_OK) == (out != NULL));
      bw_release(out);
      if (status != BW_MEMORY)
        break;
      assert_true(n < 100);
    }
  bw_release(s);
}

check_main(check_test(a_tree_is_directed_away_from_its_root),
           check_test(an_order_with_parents_first_is_kept),
           check_test(names_that_are_taken_are_stepped_over),
           check_test(what_is_no_tree_is_refused),
           check_test(frames_are_right_handed_and_follow_the_bones),
           check_test(inserting_a_joint_cuts_a_bone), check_test(merging_undoes_inserting),
           check_test(the_root_moves_when_its_joint_is_merged_away),
           check_test(moving_removing_and_rooting),
           check_test(a_file_brings_back_the_same_skeleton),
           check_test(files_of_others_are_understood),
           check_test(malformed_files_are_refused_by_line),
           check_test(every_failing_allocation_is_survived))
