/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* Inverse kinematics: closed forms of the two-bone arm, targets out of reach, limits, several
 * targets from one torso. */
#include "limbs.h"

#include "shape/reach.h"

/* An arm of two bones along x, lengths 1 and 0.7. */
static bw_skeleton *arm(bw_context *context) {
  bw_skeleton *skeleton;
  const double joint[9] = {0, 0, 0, 1, 0, 0, 1.7, 0, 0};
  const int32_t bone[4] = {0, 1, 1, 2};
  check_ok(context, bw_skeleton_create(context, 3, joint, NULL, 2, bone, NULL, 0, &skeleton));
  return skeleton;
}

/* A torso of two bones, two arms of two bones each. */
static bw_skeleton *torso(bw_context *context) {
  bw_skeleton *skeleton;
  const double joint[21] = {0,   0, 0, 0,   0,    0.5, 0,   0,  1, 0.5, 0,
                            1.2, 1, 0, 1.1, -0.5, 0,   1.2, -1, 0, 1.1};
  const int32_t bone[12] = {0, 1, 1, 2, 2, 3, 3, 4, 2, 5, 5, 6};
  check_ok(context, bw_skeleton_create(context, 7, joint, NULL, 6, bone, NULL, 0, &skeleton));
  return skeleton;
}

static void rest(bw_bone_pose *pose, int32_t bones) {
  for (int32_t b = 0; b < bones; b++)
    bw_bone_pose_rest(pose + b);
}

static void tail_at(bw_context *context, const bw_skeleton *s, const bw_bone_pose *pose, int32_t b,
                    double along, double x[3]) {
  double *map = malloc(12 * (size_t)s->bone_count * sizeof *map);
  check_ok(context, bw_pose_maps(context, s, pose, map, NULL));
  for (int i = 0; i < 3; i++) {
    x[i] = map[12 * b + 4 * i + 3];
    for (int k = 0; k < 3; k++) {
      double head = s->joint[3 * s->bone[2 * b] + k], tail = s->joint[3 * s->bone[2 * b + 1] + k];
      x[i] += map[12 * b + 4 * i + k] * (head + along * (tail - head));
    }
  }
  free(map);
}

static double apart(const double a[3], const double b[3]) {
  double d[3] = {a[0] - b[0], a[1] - b[1], a[2] - b[2]};
  return bw_norm(d);
}

static bw_reach_target tail_to(int32_t bone, double x, double y, double z) {
  return (bw_reach_target){bone, 1, {x, y, z}, 1, -1};
}

/* From rest to one target. */
static bw_reach_report reach_from_rest(bw_context *context, const bw_skeleton *s,
                                       const bw_joint_limit *limit, bw_reach_target target,
                                       bw_bone_pose *pose) {
  bw_reach_report report;
  rest(pose, s->bone_count);
  check_ok(context, bw_pose_reach(context, s, limit, 1, &target, 0, pose, &report));
  return report;
}

/* The elbow's angle follows from the law of cosines, wherever the target. */
static void test_two_bones(void **state) {
  bw_context *context = check_context(state);
  bw_skeleton *s = arm(context);
  bw_random random;
  bw_random_seed(&random, 2);
  int max = 0;
  for (int i = 0; i < 200; i++) {
    double at[3], x[3], distance = 0.35 + 1.3 * bw_random_uniform(&random);
    for (int k = 0; k < 3; k++)
      at[k] = bw_random_normal(&random);
    double length = bw_norm(at);
    bw_reach_target target =
        tail_to(1, at[0] * distance / length, at[1] * distance / length, at[2] * distance / length);
    bw_bone_pose pose[2];
    bw_reach_report report = reach_from_rest(context, s, NULL, target, pose);
    assert_true(report.reached);
    tail_at(context, s, pose, 1, 1, x);
    check_near(apart(x, target.at), report.distance, 1e-12);
    assert_true(report.distance <= 1.7e-6);
    /* between the bones: pi minus the angle of the triangle 1, 0.7, distance */
    double cosine = pose[1].rotation[0];
    check_near(cosine, (distance * distance - 1 - 0.49) / 1.4, 2e-5);
    max = report.iterations > max ? report.iterations : max;
  }
  assert_true(max <= 20);
  bw_release(s);
}

/* Straight arms: a target on the line of the arm, nearer than its tip, is a saddle. */
static void test_straight_arm_bends(void **state) {
  bw_context *context = check_context(state);
  bw_skeleton *s = limbs_bar_bones(context);
  for (int axis = 0; axis < 2; axis++) {
    bw_bone_pose pose[3];
    bw_reach_target target = tail_to(2, 1.1, 0, 0);
    if (axis == 1) /* behind */
      target.at[0] = -2.5;
    bw_reach_report report = reach_from_rest(context, s, NULL, target, pose);
    assert_true(report.reached);
    assert_true(report.iterations < 30);
  }
  bw_release(s);
}

/* Out of reach: the arm points straight at the target, and the distance left is what is missing. */
static void test_out_of_reach(void **state) {
  bw_context *context = check_context(state);
  bw_skeleton *s = limbs_bar_bones(context);
  const double targets[4][3] = {{2, 3, 1}, {-30, 1, 2}, {0, 0, 5}, {4, 0, 0}};
  for (int i = 0; i < 4; i++) {
    bw_bone_pose pose[3];
    bw_reach_report report;
    bw_reach_target target = tail_to(2, targets[i][0], targets[i][1], targets[i][2]);
    rest(pose, 3);
    pose[1].scale[0] = 1.5; /* scales are respected: the arm is 3.5 long */
    check_ok(context, bw_pose_reach(context, s, NULL, 1, &target, 0, pose, &report));
    assert_false(report.reached);
    check_near(report.distance, bw_norm(target.at) - 3.5, 1e-9);
    assert_true(report.iterations < 30);
    for (int b = 0; b < 3; b++) {
      double x[3];
      tail_at(context, s, pose, b, 1, x);
      double reach = b == 0 ? 1 : b == 1 ? 2.5 : 3.5;
      for (int k = 0; k < 3; k++)
        check_near(x[k], target.at[k] / bw_norm(target.at) * reach, 1e-4);
    }
  }
  bw_release(s);
}

/* Only the chain turns; below chain_from nothing moves; points inside a bone can be targets. */
static void test_chain_from(void **state) {
  bw_context *context = check_context(state);
  bw_skeleton *s = torso(context);
  bw_bone_pose pose[6], before[6];
  bw_random random;
  bw_random_seed(&random, 4);
  limbs_random_pose(&random, 6, before);
  memcpy(pose, before, sizeof pose);
  double shoulder[3], elbow[3], x[3];
  tail_at(context, s, pose, 2, 0, shoulder);
  tail_at(context, s, pose, 2, 1, elbow);
  bw_reach_target target = {3, 0.5, {0, 0, 0}, 1, 2};
  for (int k = 0; k < 3; k++)
    target.at[k] = shoulder[k] + (k == 1 ? 0.8 : 0.2) * apart(shoulder, elbow);
  bw_reach_report report;
  check_ok(context, bw_pose_reach(context, s, NULL, 1, &target, 0, pose, &report));
  assert_true(report.reached);
  tail_at(context, s, pose, 3, 0.5, x);
  check_near(apart(x, target.at), 0, 3e-6);
  for (int b = 0; b < 6; b++) {
    assert_memory_equal(pose[b].scale, before[b].scale, sizeof before[b].scale);
    assert_memory_equal(pose[b].translation, before[b].translation, sizeof before[b].translation);
    if (b != 2 && b != 3)
      assert_memory_equal(pose + b, before + b, sizeof *pose);
  }
  bw_release(s);
}

/* Two hands from one torso, which has to bend for both. */
static void test_two_targets(void **state) {
  bw_context *context = check_context(state);
  bw_skeleton *s = torso(context);
  bw_bone_pose pose[6], again[6];
  bw_reach_report report;
  bw_reach_target targets[2] = {tail_to(3, 0.9, 0.9, 0.6), tail_to(5, 0.2, 1.1, 0.7)};
  rest(pose, 6);
  check_ok(context, bw_pose_reach(context, s, NULL, 2, targets, 0, pose, &report));
  assert_true(report.reached);
  assert_true(report.iterations < 30);
  for (int i = 0; i < 2; i++) {
    double x[3];
    tail_at(context, s, pose, targets[i].bone, 1, x);
    assert_true(apart(x, targets[i].at) <= report.distance + 1e-12);
  }
  assert_true(report.distance < 3e-6);
  /* the same bits again, and with other threads */
  rest(again, 6);
  check_ok(context, bw_set_threads(context, 3));
  check_ok(context, bw_pose_reach(context, s, NULL, 2, targets, 0, again, &report));
  assert_memory_equal(pose, again, sizeof pose);
  /* a pose that is there already is left as it is */
  check_ok(context, bw_pose_reach(context, s, NULL, 2, targets, 0, again, &report));
  assert_int_equal(report.iterations, 0);
  assert_memory_equal(pose, again, sizeof pose);
  /* both out of reach to opposite sides: weights decide between them */
  double left[2];
  for (int i = 0; i < 2; i++) {
    bw_reach_target apart_targets[2] = {tail_to(3, 9, 0, 0), tail_to(5, -9, 0, 0)};
    double x[3];
    apart_targets[0].weight = i ? 3 : 1;
    rest(pose, 6);
    check_ok(context, bw_pose_reach(context, s, NULL, 2, apart_targets, 0, pose, &report));
    assert_false(report.reached);
    tail_at(context, s, pose, 3, 1, x);
    left[i] = apart(x, apart_targets[0].at);
  }
  assert_true(left[1] < left[0] - 0.01);
  bw_release(s);
}

/* Swing and twist come apart and together again, and the rate of the barred turns is right. */
static void test_swing_twist(void **state) {
  (void)state;
  bw_random random;
  bw_random_seed(&random, 12);
  for (int i = 0; i < 200; i++) {
    double d[3], axis[3], r[9], q[4], back[9], swing, twist;
    for (int k = 0; k < 3; k++) {
      d[k] = bw_random_normal(&random);
      axis[k] = bw_random_normal(&random);
    }
    double length = bw_norm(d);
    for (int k = 0; k < 3; k++)
      d[k] /= length;
    limbs_turn(r, axis, 6 * bw_random_uniform(&random) - 3);
    bwi_quaternion_of(r, q);
    bwi_quaternion_rotation(q, back);
    for (int k = 0; k < 9; k++)
      check_near(back[k], r[k], 1e-14);
    bwi_swing_twist(q, d, &swing, &twist);
    double turned[3] = {bw_dot(r, d), bw_dot(r + 3, d), bw_dot(r + 6, d)};
    check_near(swing, acos(fmin(fmax(bw_dot(turned, d), -1), 1)), 1e-6);
    /* rebuild: twist about d, then the shortest arc from d to where it went */
    double twisting[9], swinging[9], across[3];
    limbs_turn(twisting, d, twist);
    bw_cross(d, turned, across);
    limbs_turn(swinging, across, swing);
    for (int a = 0; a < 3; a++)
      for (int b = 0; b < 3; b++) {
        double sum = 0;
        for (int k = 0; k < 3; k++)
          sum += swinging[3 * a + k] * twisting[3 * k + b];
        check_near(sum, r[3 * a + b], 1e-9);
      }
    /* limits: what was inside stays, the rest is put on them */
    bw_joint_limit limit = {0.5, -0.2, 0.3};
    double clamped[4], swing_after, twist_after;
    memcpy(clamped, q, sizeof q);
    bwi_limit_rotation(&limit, d, clamped);
    bwi_swing_twist(clamped, d, &swing_after, &twist_after);
    check_near(swing_after, fmin(swing, 0.5), 1e-9);
    check_near(twist_after, fmin(fmax(twist, -0.2), 0.3), 1e-9);
    /* the bars are the directions in which swing and twist change, with what is left of each */
    bwi_bars bars;
    bwi_limit_bars(&limit, d, clamped, &bars);
    assert_int_equal(bars.count, 2);
    check_near(bars.high[0], 0.5 - swing_after, 1e-9);
    double rate = cos(swing_after / 2);
    check_near(bars.high[1], rate * (0.3 - twist_after), 1e-9);
    check_near(bars.low[1], rate * (-0.2 - twist_after), 1e-9);
    for (int bar = 0; bar < 2; bar++) {
      double moved[4], turn[3], s, t;
      for (int k = 0; k < 3; k++)
        turn[k] = 1e-6 * bars.axis[bar][k];
      memcpy(moved, clamped, sizeof moved);
      bwi_quaternion_turn(turn, moved);
      bwi_swing_twist(moved, d, &s, &t);
      check_near(s - swing_after, bar == 0 ? 1e-6 : 0, 1e-10);
      check_near(t - twist_after, bar == 1 ? 1e-6 / rate : 0, 1e-10);
    }
  }
}

static void test_limits(void **state) {
  bw_context *context = check_context(state);
  bw_skeleton *s = limbs_bar_bones(context);
  bw_random random;
  bw_random_seed(&random, 6);
  bw_joint_limit limit[3];
  int reached = 0;
  for (int i = 0; i < 60; i++) {
    bw_bone_pose pose[3];
    bw_reach_report report;
    /* targets made by a pose within the limits, so that each can be reached */
    rest(pose, 3);
    double axis[3], at[3];
    for (int b = 0; b < 3; b++) {
      limit[b].swing = 0.2 + bw_random_uniform(&random);
      limit[b].twist_min = -0.3 * bw_random_uniform(&random);
      limit[b].twist_max = 0.3 * bw_random_uniform(&random);
      double angle = bw_random_uniform(&random) * limit[b].swing,
             phase = 6.28 * bw_random_uniform(&random);
      axis[0] = 0;
      axis[1] = cos(phase);
      axis[2] = sin(phase);
      limbs_turn(pose[b].rotation, axis, angle);
    }
    tail_at(context, s, pose, 2, 1, at);
    bw_reach_target target = tail_to(2, at[0], at[1], at[2]);
    limbs_random_pose(&random, 3, pose); /* begins outside the limits, too */
    for (int b = 0; b < 3; b++)
      for (int k = 0; k < 3; k++) {
        pose[b].scale[k] = 1;
        pose[b].translation[k] = 0;
      }
    check_ok(context, bw_pose_reach(context, s, limit, 1, &target, 0, pose, &report));
    reached += report.reached;
    assert_true(report.iterations < 20);
    for (int b = 0; b < 3; b++) {
      double q[4], swing, twist;
      bwi_quaternion_of(pose[b].rotation, q);
      bwi_swing_twist(q, (double[3]){1, 0, 0}, &swing, &twist);
      assert_true(swing <= limit[b].swing + 1e-9);
      assert_true(twist >= limit[b].twist_min - 1e-9 && twist <= limit[b].twist_max + 1e-9);
    }
  }
  assert_int_equal(reached, 60);
  /* a stiff elbow: the arm of two bones that may swing by 0.5 at the elbow, target near the root:
     the least distance is that of the most bent arm */
  for (int b = 0; b < 3; b++)
    bw_joint_limit_none(limit + b);
  limit[1].swing = 0.5;
  limit[2].swing = 0; /* bones 2 and 3 are one of length 2 */
  bw_bone_pose pose[3];
  bw_reach_target target = tail_to(2, 0.5, 0.1, 0);
  bw_reach_report report = reach_from_rest(context, s, limit, target, pose);
  double farthest = sqrt(1 + 4 + 4 * cos(0.5));
  check_near(report.distance, farthest - bw_norm(target.at), 1e-6);
  assert_false(report.reached);
  check_near(pose[1].rotation[0], cos(0.5), 1e-6);
  bw_release(s);
}

/* Random trees, scales and translations; targets taken from a random pose, within the limits in
 * every second round: what can be reached is reached, and the limits hold. */
static void test_random_trees(void **state) {
  bw_context *context = check_context(state);
  bw_random random;
  bw_random_seed(&random, 11);
  enum { max_bones = 12 };
  int64_t iterations = 0;
  for (int round = 0; round < 300; round++) {
    int32_t bones = 2 + (int32_t)(bw_random_uniform(&random) * (max_bones - 2));
    double joint[3 * (max_bones + 1)] = {0}, map[12 * max_bones], posed[3 * (max_bones + 1)];
    int32_t bone[2 * max_bones];
    for (int32_t b = 0; b < bones; b++) {
      bool goes_on = bw_random_uniform(&random) < 0.7;
      bone[2 * b] = goes_on ? b : (int32_t)(bw_random_uniform(&random) * (b + 1));
      bone[2 * b + 1] = b + 1;
      for (int k = 0; k < 3; k++)
        joint[3 * (b + 1) + k] = joint[3 * bone[2 * b] + k] + bw_random_normal(&random);
    }
    bw_skeleton *s;
    check_ok(context,
             bw_skeleton_create(context, bones + 1, joint, NULL, bones, bone, NULL, 0, &s));
    bw_bone_pose pose[max_bones], rested;
    bw_joint_limit limit[max_bones];
    bool limited = round % 2;
    double direction[max_bones][3], q[4];
    bw_bone_pose_rest(&rested);
    limbs_random_pose(&random, bones, pose);
    for (int32_t b = 0; b < bones; b++) {
      limit[b].swing = 0.1 + bw_random_uniform(&random);
      limit[b].twist_min = -0.1 - bw_random_uniform(&random);
      limit[b].twist_max = bw_random_uniform(&random);
      for (int k = 0; k < 3; k++)
        direction[b][k] = s->joint[3 * s->bone[2 * b + 1] + k] - s->joint[3 * s->bone[2 * b] + k];
      double length = bw_norm(direction[b]);
      for (int k = 0; k < 3; k++)
        direction[b][k] /= length;
      bwi_quaternion_of(pose[b].rotation, q);
      if (limited)
        bwi_limit_rotation(limit + b, direction[b], q);
      bwi_quaternion_rotation(q, pose[b].rotation);
    }
    check_ok(context, bw_pose_maps(context, s, pose, map, NULL));
    bw_pose_joints(s, map, posed);
    for (int32_t b = 0; b < bones; b++)
      memcpy(pose[b].rotation, rested.rotation, sizeof rested.rotation);
    const double *at = posed + 3 * s->bone[2 * bones - 1];
    bw_reach_target target = tail_to(bones - 1, at[0], at[1], at[2]);
    bw_reach_report report;
    check_ok(context,
             bw_pose_reach(context, s, limited ? limit : NULL, 1, &target, 0, pose, &report));
    assert_true(report.reached);
    assert_true(report.iterations < 40);
    iterations += report.iterations;
    for (int32_t b = 0; b < bones && limited; b++) {
      double swing, twist;
      bwi_quaternion_of(pose[b].rotation, q);
      bwi_swing_twist(q, direction[b], &swing, &twist);
      assert_true(swing <= limit[b].swing + 1e-9);
      assert_true(twist >= limit[b].twist_min - 1e-9 && twist <= limit[b].twist_max + 1e-9);
    }
    bw_release(s);
  }
  assert_true(iterations < 300 * 10);
}

/* A chain of thirty bones, as an extracted skeleton may have. */
static void test_long_chain(void **state) {
  bw_context *context = check_context(state);
  enum { bones = 30 };
  double joint[3 * (bones + 1)];
  int32_t bone[2 * bones];
  for (int j = 0; j <= bones; j++) {
    joint[3 * j] = 0.1 * j;
    joint[3 * j + 1] = 0.05 * sin(j);
    joint[3 * j + 2] = 0.05 * cos(3 * j);
    if (j < bones) {
      bone[2 * j] = j;
      bone[2 * j + 1] = j + 1;
    }
  }
  bw_skeleton *s;
  check_ok(context, bw_skeleton_create(context, bones + 1, joint, NULL, bones, bone, NULL, 0, &s));
  bw_bone_pose pose[bones];
  const double targets[3][3] = {{1, 1, 1}, {-2, 0.5, 0}, {0.2, 0, 0.1}};
  for (int i = 0; i < 3; i++) {
    bw_reach_target target = tail_to(bones - 1, targets[i][0], targets[i][1], targets[i][2]);
    bw_reach_report report = reach_from_rest(context, s, NULL, target, pose);
    assert_true(report.reached);
    assert_true(report.iterations < 30);
  }
  bw_release(s);
}

static void test_refusals_and_memory(void **state) {
  bw_context *context = check_context(state);
  bw_skeleton *s = arm(context);
  bw_bone_pose pose[2];
  bw_reach_report report;
  rest(pose, 2);
  bw_reach_target target = tail_to(2, 1, 1, 0);
  check_fails(context, BW_INVALID, "bone 3: there are 2",
              bw_pose_reach(context, s, NULL, 1, &target, 0, pose, &report));
  target = tail_to(0, 1, 1, 0);
  target.chain_from = 1;
  check_fails(context, BW_INVALID, "not above",
              bw_pose_reach(context, s, NULL, 1, &target, 0, pose, &report));
  target = tail_to(1, 1, NAN, 0);
  check_fails(context, BW_INVALID, "nan",
              bw_pose_reach(context, s, NULL, 1, &target, 0, pose, &report));
  target = tail_to(1, 1, 1, 0);
  target.weight = 0;
  check_fails(context, BW_INVALID, "weight 0",
              bw_pose_reach(context, s, NULL, 1, &target, 0, pose, &report));
  target = tail_to(1, 1, 1, 0);
  target.along = 2;
  check_fails(context, BW_INVALID, "at 2 along",
              bw_pose_reach(context, s, NULL, 1, &target, 0, pose, &report));
  target.along = 1;
  check_fails(context, BW_INVALID, "tolerance",
              bw_pose_reach(context, s, NULL, 1, &target, -1, pose, &report));
  check_fails(context, BW_INVALID, "0 targets",
              bw_pose_reach(context, s, NULL, 0, &target, 0, pose, &report));
  bw_joint_limit limit[2];
  bw_joint_limit_none(limit);
  limit[1] = (bw_joint_limit){0.5, 0.4, 0.3};
  check_fails(context, BW_INVALID, "\"bone 2\"",
              bw_pose_reach(context, s, limit, 1, &target, 0, pose, &report));
  bw_joint_limit_none(limit + 1);
  bw_status status = BW_MEMORY;
  int64_t blocks = bw_live_blocks();
  bw_bone_pose before[2];
  memcpy(before, pose, sizeof pose);
  int n;
  for (n = 1; status == BW_MEMORY && n < 1000; n++) {
    bw_fail_allocation(n, true);
    status = bw_pose_reach(context, s, limit, 1, &target, 0, pose, &report);
    bw_fail_allocation(0, false);
    assert_int_equal(bw_live_blocks(), blocks);
    if (status != BW_OK)
      assert_memory_equal(pose, before, sizeof pose);
  }
  check_ok(context, status);
  assert_true(report.reached && n > 20);
  bw_release(s);
}

check_main(check_test(test_two_bones), check_test(test_straight_arm_bends),
           check_test(test_out_of_reach), check_test(test_chain_from), check_test(test_two_targets),
           check_test(test_swing_twist), check_test(test_limits), check_test(test_long_chain),
           check_test(test_random_trees), check_test(test_refusals_and_memory))
