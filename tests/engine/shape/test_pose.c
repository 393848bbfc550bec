/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* Poses: forward kinematics against closed forms and an independent recursion; posed nodes move as
 * their bones; the mesh stays continuous; scales are linear. */
#include "limbs.h"

static const double unit[9] = {1, 0, 0, 0, 1, 0, 0, 0, 1};

static void apply(const double *map, const double *x, double *y) {
  for (int i = 0; i < 3; i++)
    y[i] = bw_dot(map + 4 * i, x) + map[4 * i + 3];
}

static bw_subdomains *make(bw_context *context, const bw_mesh *mesh, const bw_skeleton *skeleton) {
  bw_subdomains *subdomains;
  double *weight = limbs_weights(mesh, skeleton, 20);
  check_ok(context, bw_subdomains_create(context, mesh, skeleton, weight, NULL, &subdomains));
  free(weight);
  return subdomains;
}

static void test_rest(void **state) {
  bw_context *context = check_context(state);
  bw_skeleton *skeleton = limbs_cross_bones(context);
  bw_mesh *mesh = limbs_cross(context, 2);
  bw_subdomains *d = make(context, mesh, skeleton);
  bw_bone_pose pose[4];
  for (int b = 0; b < 4; b++)
    bw_bone_pose_rest(pose + b);
  double map[48], rotation[36], joint[15];
  double *node = malloc(3 * (size_t)mesh->node_count * sizeof *node);
  check_ok(context, bw_pose_maps(context, skeleton, pose, map, rotation));
  check_ok(context, bw_pose_nodes(context, d, map, node));
  for (int32_t i = 0; i < 3 * mesh->node_count; i++)
    check_near(node[i], mesh->node[i], 1e-15); /* corners exactly; grids round their midpoints */
  bw_pose_joints(skeleton, map, joint);
  assert_memory_equal(joint, skeleton->joint, sizeof joint);
  /* a translated root takes everything along, as a whole */
  bw_subdomain_motion *motion = malloc((size_t)d->count * sizeof *motion);
  for (int b = 0; b < 4; b++)
    pose[b].translation[1] = 0.3;
  check_ok(context, bw_pose_maps(context, skeleton, pose, map, rotation));
  check_ok(context, bw_pose_motion(context, d, map, rotation, motion));
  for (int i = 0; i < d->count; i++) {
    assert_false(motion[i].reshaped);
    assert_memory_equal(motion[i].linear, unit, sizeof unit);
    assert_memory_equal(motion[i].frame, unit, sizeof unit);
  }
  free(motion);
  free(node);
  bw_release(d);
  bw_release(mesh);
  bw_release(skeleton);
}

/* An arm of three bones: shoulder turned by 90 degrees about z, elbow back by 90; the middle bone
 * twice as long and shifted. */
static void test_arm(void **state) {
  bw_context *context = check_context(state);
  bw_skeleton *skeleton = limbs_bar_bones(context);
  bw_bone_pose pose[3];
  for (int b = 0; b < 3; b++)
    bw_bone_pose_rest(pose + b);
  limbs_turn(pose[0].rotation, (double[3]){0, 0, 1}, M_PI / 2);
  limbs_turn(pose[2].rotation, (double[3]){0, 0, 1}, -M_PI / 2);
  pose[1].scale[0] = 2;
  pose[1].translation[0] = 0.5; /* along the parent's x, which now is y */
  double map[36], joint[12];
  check_ok(context, bw_pose_maps(context, skeleton, pose, map, NULL));
  bw_pose_joints(skeleton, map, joint);
  /* joint 1 is bone 0's tail; bone 1 begins half a unit on, at y = 1.5, and ends at 3.5 */
  const double expected[12] = {0, 0, 0, 0, 1, 0, 0, 3.5, 0, 1, 3.5, 0};
  for (int i = 0; i < 12; i++)
    check_near(joint[i], expected[i], 1e-15);
  bw_release(skeleton);
}

/* Maps by the definition, point by point: local turns about heads, from the bone up to the root. */
static void place(const bw_skeleton *s, const double *frame, const bw_bone_pose *pose, int32_t b,
                  double *x, double *directions) {
  /* x: a point carried by bone b; directions: 3 x 3, vectors turned along */
  const double *head = s->joint + 3 * s->bone[2 * b];
  double local[3] = {0, 0, 0};
  for (int a = 0; a < 3; a++) {
    const double *f = frame + 9 * b + 3 * a;
    double part = bw_dot(f, x) - bw_dot(f, head);
    for (int k = 0; k < 3; k++)
      local[k] += pose[b].scale[a] * part * f[k];
  }
  for (int32_t c = b; c >= 0; c = s->parent[c]) {
    /* turn about c's head; then c's head is where c's parent carries it */
    double turned[3], anchor[3];
    for (int k = 0; k < 3; k++)
      turned[k] = bw_dot(pose[c].rotation + 3 * k, local);
    for (int k = 0; k < 3; k++)
      turned[k] += pose[c].translation[k];
    const double *own = s->joint + 3 * s->bone[2 * c];
    int32_t p = s->parent[c];
    memcpy(anchor, own, sizeof anchor);
    if (p >= 0) {
      const double *up = s->joint + 3 * s->bone[2 * p];
      memset(anchor, 0, sizeof anchor);
      for (int a = 0; a < 3; a++) {
        const double *f = frame + 9 * p + 3 * a;
        double part = pose[p].scale[a] * (bw_dot(f, own) - bw_dot(f, up));
        for (int k = 0; k < 3; k++)
          anchor[k] += part * f[k];
      }
    }
    for (int k = 0; k < 3; k++)
      local[k] = turned[k] + anchor[k];
    for (int j = 0; j < 3; j++) {
      double v[3];
      for (int k = 0; k < 3; k++)
        v[k] = bw_dot(pose[c].rotation + 3 * k, directions + 3 * j);
      memcpy(directions + 3 * j, v, sizeof v);
    }
  }
  memcpy(x, local, sizeof local);
}

static void test_random_poses(void **state) {
  bw_context *context = check_context(state);
  bw_random random;
  bw_random_seed(&random, 3);
  bw_skeleton *skeleton;
  const double joint[18] = {0, 0, 0, 1, 0.2, 0, 2, 0, 0.5, 1.5, 1, 0, 0, -1, 0.3, 2.5, 1.5, 0.2};
  const int32_t bone[10] = {0, 1, 1, 2, 1, 3, 0, 4, 3, 5};
  check_ok(context, bw_skeleton_create(context, 6, joint, NULL, 5, bone, NULL, 0, &skeleton));
  double frame[45];
  bw_skeleton_frames(skeleton, frame);
  for (int round = 0; round < 20; round++) {
    bw_bone_pose pose[5];
    double map[60], rotation[45];
    limbs_random_pose(&random, 5, pose);
    check_ok(context, bw_pose_maps(context, skeleton, pose, map, rotation));
    for (int b = 0; b < 5; b++) {
      double x[3], y[3], axes[9];
      for (int k = 0; k < 3; k++)
        x[k] = bw_random_normal(&random);
      memcpy(axes, unit, sizeof axes);
      apply(map + 12 * b, x, y);
      place(skeleton, frame, pose, b, x, axes);
      for (int k = 0; k < 3; k++) {
        check_near(y[k], x[k], 1e-13);
        for (int j = 0; j < 3; j++) /* columns of R are the images of the axes */
          check_near(rotation[9 * b + 3 * k + j], axes[3 * j + k], 1e-14);
      }
      /* volumes go with the product of the scales */
      double linear[9], unused[9];
      for (int i = 0; i < 3; i++)
        memcpy(linear + 3 * i, map + 12 * b + 4 * i, 3 * sizeof(double));
      check_near(bw_inverse3(linear, unused),
                 pose[b].scale[0] * pose[b].scale[1] * pose[b].scale[2], 1e-13);
    }
  }
  bw_release(skeleton);
}

/* Nodes of type R go exactly where their bone's map sends them, interfaces included; their
 * elements' volumes scale by its determinant; nodes of type F lie between. */
static void test_nodes(void **state) {
  bw_context *context = check_context(state);
  bw_random random;
  bw_random_seed(&random, 5);
  for (int order = 1; order <= 2; order++) {
    bw_skeleton *skeleton = limbs_cross_bones(context);
    bw_mesh *mesh = limbs_cross(context, order);
    bw_subdomains *d = make(context, mesh, skeleton);
    bw_bone_pose pose[4];
    double map[48], rotation[36], *node = malloc(3 * (size_t)mesh->node_count * sizeof *node);
    bw_subdomain_motion motion[5];
    assert_int_equal(d->count, 5);
    limbs_random_pose(&random, 4, pose);
    check_ok(context, bw_pose_maps(context, skeleton, pose, map, rotation));
    check_ok(context, bw_pose_nodes(context, d, map, node));
    check_ok(context, bw_pose_motion(context, d, map, rotation, motion));
    for (int32_t e = 0; e < mesh->element_count; e++) {
      const int32_t *at = mesh->element + e * mesh->nodes_per_element;
      int32_t subdomain = d->element_subdomain[e], b = d->bone_of[subdomain];
      double edge[9], unused[9];
      for (int k = 0; k < mesh->nodes_per_element; k++) {
        double y[3];
        apply(map + 12 * (b < 0 ? 0 : b), mesh->node + 3 * at[k], y);
        for (int j = 0; j < 3 && b >= 0; j++)
          check_near(node[3 * at[k] + j], y[j], k < 4 ? 1e-16 : 1e-15);
        if (k >= 4)
          for (int j = 0; j < 3; j++)
            check_near(node[3 * at[k] + j],
                       0.5 * (node[3 * at[bw_tet_edge[k - 4][0]] + j] +
                              node[3 * at[bw_tet_edge[k - 4][1]] + j]),
                       0);
        if (k > 0 && k < 4)
          for (int j = 0; j < 3; j++)
            edge[3 * k - 3 + j] = node[3 * at[k] + j] - node[3 * at[0] + j];
      }
      if (b >= 0)
        check_near(bw_inverse3(edge, unused) / (6 * mesh->volume[e]),
                   pose[b].scale[0] * pose[b].scale[1] * pose[b].scale[2], 1e-11);
    }
    for (int i = 0; i < 5; i++) {
      assert_int_equal(motion[i].reshaped, i == 4);
      int32_t b = d->bone[d->bone_start[i]];
      double inverse[9];
      check_near(bw_inverse3(motion[i].frame, inverse), 1, 1e-14);
      for (int r = 0; r < 3; r++)
        for (int c = 0; c < 3; c++) {
          assert_true(motion[i].frame[3 * r + c] == rotation[9 * b + 3 * c + r]);
          assert_true(motion[i].linear[3 * r + c] == map[12 * b + 4 * r + c]);
        }
    }
    free(node);
    bw_release(d);
    bw_release(mesh);
    bw_release(skeleton);
  }
}

/* Turning an upper bone moves what lies below it as a whole: only its own joint is reshaped. */
static void test_turned_as_a_whole(void **state) {
  bw_context *context = check_context(state);
  bw_skeleton *skeleton = limbs_bar_bones(context);
  bw_mesh *mesh = limbs_bar(context, 1, 4);
  bw_subdomains *d = make(context, mesh, skeleton);
  bw_bone_pose pose[3];
  double map[36], rotation[27];
  bw_subdomain_motion motion[5];
  for (int b = 0; b < 3; b++)
    bw_bone_pose_rest(pose + b);
  limbs_turn(pose[1].rotation, (double[3]){1, 2, 3}, 0.7);
  check_ok(context, bw_pose_maps(context, skeleton, pose, map, rotation));
  check_ok(context, bw_pose_motion(context, d, map, rotation, motion));
  assert_false(motion[0].reshaped || motion[1].reshaped || motion[2].reshaped);
  assert_true(motion[3].reshaped);  /* between bones 0 and 1 */
  assert_false(motion[4].reshaped); /* between 1 and 2, which turned together */
  assert_memory_equal(motion[4].linear, motion[2].linear, sizeof motion[2].linear);
  assert_memory_equal(motion[0].linear, unit, sizeof unit);
  /* from the root, with a chain of turns: everything beyond the last of them goes as a whole */
  limbs_turn(pose[0].rotation, (double[3]){0, 2, -1}, 0.3);
  check_ok(context, bw_pose_maps(context, skeleton, pose, map, rotation));
  check_ok(context, bw_pose_motion(context, d, map, rotation, motion));
  assert_false(motion[4].reshaped);
  assert_memory_equal(map + 12, map + 24, 12 * sizeof(double));
  bw_release(d);
  bw_release(mesh);
  bw_release(skeleton);
}

/* Positions are linear in each scale: the derivative is a difference of any width, children that
 * hang on the scaled bone included. */
static void test_derivative(void **state) {
  bw_context *context = check_context(state);
  bw_random random;
  bw_random_seed(&random, 9);
  bw_skeleton *skeleton = limbs_bar_bones(context);
  bw_mesh *mesh = limbs_bar(context, 2, 2);
  bw_subdomains *d = make(context, mesh, skeleton);
  size_t size = 3 * (size_t)mesh->node_count;
  double *low = malloc(size * 8), *high = malloc(size * 8), *exact = malloc(size * 8);
  bw_bone_pose pose[3];
  limbs_random_pose(&random, 3, pose);
  for (int b = 0; b < 3; b++)
    for (int axis = 0; axis < 3; axis++) {
      double map[36], at = pose[b].scale[axis];
      check_ok(context, bw_pose_derivative(context, d, pose, b, axis, exact));
      pose[b].scale[axis] = at - 0.25;
      check_ok(context, bw_pose_maps(context, skeleton, pose, map, NULL));
      check_ok(context, bw_pose_nodes(context, d, map, low));
      pose[b].scale[axis] = at + 0.75;
      check_ok(context, bw_pose_maps(context, skeleton, pose, map, NULL));
      check_ok(context, bw_pose_nodes(context, d, map, high));
      pose[b].scale[axis] = at;
      double largest = 0;
      for (size_t i = 0; i < size; i++) {
        check_near(exact[i], high[i] - low[i], 3e-15);
        largest = fmax(largest, fabs(exact[i]));
      }
      assert_true(largest > 0.1);
    }
  check_fails(context, BW_INVALID, "bone 4", bw_pose_derivative(context, d, pose, 3, 0, exact));
  free(low);
  free(high);
  free(exact);
  bw_release(d);
  bw_release(mesh);
  bw_release(skeleton);
}

static void test_refusals_and_memory(void **state) {
  bw_context *context = check_context(state);
  bw_skeleton *skeleton = limbs_bar_bones(context);
  bw_mesh *mesh = limbs_bar(context, 1, 2);
  bw_subdomains *d = make(context, mesh, skeleton);
  bw_bone_pose pose[3];
  double map[36], *derivative = malloc(3 * (size_t)mesh->node_count * 8);
  for (int b = 0; b < 3; b++)
    bw_bone_pose_rest(pose + b);
  pose[1].scale[2] = 0;
  check_fails(context, BW_INVALID, "\"bone 2\" is scaled by 0 along its axis z",
              bw_pose_maps(context, skeleton, pose, map, NULL));
  pose[1].scale[2] = 1;
  pose[2].rotation[4] = -1;
  check_fails(context, BW_INVALID, "mirrored", bw_pose_maps(context, skeleton, pose, map, NULL));
  pose[2].rotation[4] = NAN;
  check_fails(context, BW_INVALID, "rotation of bone \"bone 3\"",
              bw_pose_maps(context, skeleton, pose, map, NULL));
  bw_bone_pose_rest(pose + 2);
  pose[0].translation[1] = INFINITY;
  check_fails(context, BW_INVALID, "translated", bw_pose_maps(context, skeleton, pose, map, NULL));
  bw_bone_pose_rest(pose);
  check_each_allocation(context, status, 4) {
    status = bw_pose_derivative(context, d, pose, 1, 0, derivative);
  }
  free(derivative);
  bw_release(d);
  bw_release(mesh);
  bw_release(skeleton);
}

check_main(check_test(test_rest), check_test(test_arm), check_test(test_random_poses),
           check_test(test_nodes), check_test(test_turned_as_a_whole), check_test(test_derivative),
           check_test(test_refusals_and_memory))
