/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* Skeletons: trees and refusals, names, frames, edits, TGF files. */
#include "check.h"

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
  check_fails(context, BW_INVALID, "joint 7 cannot be the root", TRY_CREATE(7, 6, 7));
  check_fails(context, BW_LIMIT, "at most", TRY_CREATE((int64_t)1 << 40, 6, -1));
  check_fails(context, BW_INVALID, "joint 4 (counting from 0) is not connected",
              TRY_CREATE(7, 5, -1));
  bone[10] = 7;
  check_fails(context, BW_INVALID, "bone 5 (counting from 0) joins joints 7 and 1",
              TRY_CREATE(7, 6, -1));
  RESET();
  bone[9] = 2; /* arm 1-3 becomes 1-2 a second time */
  check_fails(context, BW_INVALID, "bone 4 (counting from 0), from joint 1 to joint 2, closes",
              TRY_CREATE(7, 6, -1));
  RESET();
  bone[9] = 1;
  check_fails(context, BW_INVALID, "has no length", TRY_CREATE(7, 6, -1));
  RESET();
  memcpy(joint + 9, joint + 3, 3 * sizeof *joint);
  check_fails(context, BW_INVALID, "bone 4 (counting from 0), from joint 1 to joint 3, has no",
              TRY_CREATE(7, 6, -1));
  RESET();
  joint[8] = NAN;
  check_fails(context, BW_INVALID, "joint 2 (counting from 0)", TRY_CREATE(7, 6, -1));
  joint[8] = 1e200;
  check_fails(context, BW_INVALID, "joint 2 (counting from 0)", TRY_CREATE(7, 6, -1));
  RESET();
#define TRY_NAMES(text_a, text_b)                                                                  \
  (names[2] = name(text_a), names[4] = name(text_b),                                               \
   bw_skeleton_create(context, 7, joint, names, 6, bone, NULL, -1, &s))
  check_fails(context, BW_INVALID, "'hip' is used twice, by joints 2 and 4",
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

int main(void) {
  const struct CMUnitTest tests[] = {
      check_test(a_tree_is_directed_away_from_its_root),
      check_test(an_order_with_parents_first_is_kept),
      check_test(names_that_are_taken_are_stepped_over),
      check_test(what_is_no_tree_is_refused),
      check_test(frames_are_right_handed_and_follow_the_bones),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
