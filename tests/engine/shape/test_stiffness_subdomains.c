/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* Stiffness subdomains: what moves as a whole does so exactly, an edit leaves alone what it does
 * not move, and the stiffness kept subdomain by subdomain is that from scratch. */
#include "limbs.h"

#include "barwright/assemble.h"
#include "barwright/material.h"

enum { TEETH = 8, BONES = 2 * TEETH - 1 };

/* A comb: a back of 8 x 0.5 x 0.5 along x and eight teeth of length 1.5 down from it. Its bones run
 * along the back from tooth to tooth, and down the teeth; only the teeth's are subdomains, so that
 * the back is one blended subdomain between eight. */
typedef struct comb {
  bw_mesh *mesh;
  bw_skeleton *skeleton;
  bw_subdomains *subdomains;
} comb;

static comb make_comb(bw_context *context, int order) {
  comb c;
  bw_mesh *box;
  const double low[3] = {0, -1.5, 0}, high[3] = {TEETH, 0.5, 0.5};
  const int cells[3] = {4 * TEETH, 8, 2};
  check_ok(context, bw_mesh_box_grid(context, low, high, cells, order, &box));
  uint8_t *keep = calloc((size_t)box->element_count, 1);
  for (int pass = 0; pass < 2; pass++) {
    const bw_mesh *mesh = pass ? c.mesh : box;
    int32_t *label = calloc((size_t)mesh->element_count, sizeof *label), bone_of[TEETH + 1];
    for (int32_t e = 0; e < mesh->element_count; e++) {
      double middle[2] = {0, 0};
      for (int k = 0; k < 4; k++)
        for (int j = 0; j < 2; j++)
          middle[j] += mesh->node[3 * mesh->element[e * mesh->nodes_per_element + k] + j] / 4;
      int tooth = (int)middle[0];
      if (pass == 0)
        keep[e] = middle[1] > 0 || fabs(middle[0] - tooth - 0.5) < 0.25;
      label[e] = middle[1] < -0.25 ? tooth : TEETH;
    }
    if (pass == 0) {
      check_ok(context, bw_mesh_subset(context, box, keep, &c.mesh));
    } else {
      double joint[6 * TEETH];
      int32_t bone[2 * BONES];
      for (int t = 0; t < TEETH; t++) {
        memcpy(joint + 3 * t, (double[3]){t + 0.5, 0.25, 0.25}, 3 * sizeof(double));
        memcpy(joint + 3 * (TEETH + t), (double[3]){t + 0.5, -1.4, 0.25}, 3 * sizeof(double));
        bone[2 * t] = t;
        bone[2 * t + 1] = TEETH + t;
        if (t > 0) {
          bone[2 * (TEETH + t - 1)] = t - 1;
          bone[2 * (TEETH + t - 1) + 1] = t;
        }
      }
      check_ok(context, bw_skeleton_create(context, 2 * TEETH, joint, NULL, BONES, bone, NULL, 0,
                                           &c.skeleton));
      /* bones are renumbered, parents first: subdomains go by the tooth's tail joint */
      int32_t order_of[TEETH], count = 0;
      for (int32_t b = 0; b < BONES; b++)
        if (c.skeleton->joint[3 * c.skeleton->bone[2 * b + 1] + 1] < 0) {
          order_of[(int)c.skeleton->joint[3 * c.skeleton->bone[2 * b + 1]]] = count;
          bone_of[count++] = b;
        }
      assert_int_equal(count, TEETH);
      bone_of[TEETH] = -1;
      for (int32_t e = 0; e < mesh->element_count; e++)
        if (label[e] < TEETH)
          label[e] = order_of[label[e]];
      check_ok(context, bw_subdomains_from_labels(context, c.mesh, c.skeleton, TEETH + 1, bone_of,
                                                  label, &c.subdomains));
    }
    free(label);
  }
  free(keep);
  bw_release(box);
  return c;
}

static void release_comb(comb *c) {
  bw_release(c->subdomains);
  bw_release(c->skeleton);
  bw_release(c->mesh);
}

static bool follows(const bw_subdomains *d, int32_t part, int32_t bone) {
  for (int32_t k = d->stiffness.bone_start[part]; k < d->stiffness.bone_start[part + 1]; k++)
    if (d->stiffness.bone[k] == bone)
      return true;
  return false;
}

/* The back is cut; its parts follow the teeth near them, and cover it. */
static void test_cut(void **state) {
  bw_context *context = check_context(state);
  for (int order = 1; order <= 2; order++) {
    comb c = make_comb(context, order);
    const bw_subdomains *d = c.subdomains;
    check_ok(context, bw_subdomains_check(context, d));
    assert_int_equal(d->count, TEETH + 1);
    assert_true(d->stiffness.count >= TEETH + 3);
    int32_t *size = calloc((size_t)d->stiffness.count, sizeof *size);
    for (int32_t e = 0; e < c.mesh->element_count; e++)
      size[d->stiffness.of_element[e]]++;
    for (int32_t p = 0; p < d->stiffness.count; p++) {
      int32_t bones = d->stiffness.bone_start[p + 1] - d->stiffness.bone_start[p];
      assert_true(size[p] >= 40);
      assert_true(p < TEETH ? bones == 1 : bones < TEETH);
      assert_int_equal(d->stiffness.parent[p], p < TEETH ? p : TEETH);
    }
    free(size);
    /* what is wrong is found */
    int32_t *broken = c.subdomains->stiffness.of_element;
    broken[0] = (broken[0] + 1) % d->stiffness.count;
    check_fails(context, BW_INTERNAL, "element", bw_subdomains_check(context, d));
    broken[0] = d->stiffness.count;
    check_fails(context, BW_INTERNAL, "does not exist", bw_subdomains_check(context, d));
    release_comb(&c);
  }
}

/* Scaling the bone of one tooth leaves the nodes of all parts that do not list it where they are,
 * to the last bit, and says so. */
static void test_local(void **state) {
  bw_context *context = check_context(state);
  comb c = make_comb(context, 2);
  const bw_subdomains *d = c.subdomains;
  bw_bone_pose pose[BONES];
  double map[12 * BONES], rotation[9 * BONES];
  double *rest = malloc(3 * (size_t)c.mesh->node_count * sizeof *rest);
  double *node = malloc(3 * (size_t)c.mesh->node_count * sizeof *node);
  bw_subdomain_motion *motion = malloc((size_t)d->stiffness.count * sizeof *motion), unmoved;
  bw_subdomain_motion_rest(&unmoved);
  for (int b = 0; b < BONES; b++)
    bw_bone_pose_rest(pose + b);
  check_ok(context, bw_pose_maps(context, c.skeleton, pose, map, rotation));
  check_ok(context, bw_pose_nodes(context, d, map, rest));
  for (int t = 0; t < TEETH; t++) {
    int32_t bone = d->bone_of[t], kept = 0;
    pose[bone].scale[0] = 1.3;
    pose[bone].scale[1] = 0.8;
    check_ok(context, bw_pose_maps(context, c.skeleton, pose, map, rotation));
    check_ok(context, bw_pose_nodes(context, d, map, node));
    check_ok(context, bw_pose_motion(context, d, map, rotation, motion));
    for (int32_t p = 0; p < d->stiffness.count; p++) {
      if (p >= TEETH)
        assert_int_equal(motion[p].reshaped, follows(d, p, bone));
      if (follows(d, p, bone))
        continue;
      kept += p >= TEETH;
      assert_memory_equal(motion[p].linear, unmoved.linear, sizeof unmoved.linear);
      assert_memory_equal(motion[p].frame, unmoved.frame, sizeof unmoved.frame);
    }
    assert_true(kept >= 1);
    for (int32_t e = 0; e < c.mesh->element_count; e++)
      for (int k = 0; k < 10 && !follows(d, d->stiffness.of_element[e], bone); k++) {
        int32_t i = c.mesh->element[10 * e + k];
        assert_memory_equal(node + 3 * i, rest + 3 * i, 3 * sizeof *node);
      }
    bw_bone_pose_rest(pose + bone);
  }
  free(motion);
  free(node);
  free(rest);
  release_comb(&c);
}

/* Random poses of some bones, the others following their parents: parts that are reported to move
 * as a whole do, to rounding, and the stiffness kept part by part is that from scratch. */
static void test_random_edits(void **state) {
  bw_context *context = check_context(state);
  bw_random random;
  bw_random_seed(&random, 21);
  comb c = make_comb(context, 1);
  const bw_subdomains *d = c.subdomains;
  bw_material *material;
  bw_block_pattern *pattern;
  bw_subdomain_stiffness *stiffness;
  const bw_isotropic plain = {.name = "plain", .young = 2e9, .poisson = 0.3, .density = 1000};
  check_ok(context, bw_material_isotropic(context, &plain, &material));
  check_ok(context, bw_block_pattern_create(context, c.mesh, &pattern));
  check_ok(context, bw_subdomain_stiffness_create(context, pattern, c.mesh, material, false,
                                                  d->stiffness.count, d->stiffness.of_element,
                                                  d->stiffness.of_node, &stiffness));
  size_t entries = 9 * (size_t)pattern->block_count;
  double *scratch = malloc(entries * sizeof *scratch);
  double *node = malloc(3 * (size_t)c.mesh->node_count * sizeof *node);
  bw_subdomain_motion *motion = malloc((size_t)d->stiffness.count * sizeof *motion);
  bw_bone_pose pose[BONES];
  double map[12 * BONES], rotation[9 * BONES];
  int32_t whole = 0, left = 0;
  for (int b = 0; b < BONES; b++)
    bw_bone_pose_rest(pose + b);
  for (int round = 0; round < 12; round++) {
    int b = (int)(BONES * bw_random_uniform(&random)) % BONES;
    double axis[3] = {0, 0, 1};
    bw_bone_pose_rest(pose + b);
    if (round % 2) {
      limbs_turn(pose[b].rotation, axis, 0.3 * bw_random_normal(&random));
    } else {
      for (int k = 0; k < 3; k++)
        pose[b].scale[k] = 0.9 + 0.2 * bw_random_uniform(&random);
    }
    check_ok(context, bw_pose_maps(context, c.skeleton, pose, map, rotation));
    check_ok(context, bw_pose_nodes(context, d, map, node));
    check_ok(context, bw_pose_motion(context, d, map, rotation, motion));
    for (int32_t e = 0; e < c.mesh->element_count; e++) {
      int32_t p = d->stiffness.of_element[e];
      const double *own = map + 12 * d->stiffness.bone[d->stiffness.bone_start[p]];
      for (int k = 0; k < 4 && !motion[p].reshaped; k++)
        for (int r = 0; r < 3; r++) {
          int32_t i = c.mesh->element[4 * e + k];
          double at = bw_dot(motion[p].linear + 3 * r, c.mesh->node + 3 * i) + own[4 * r + 3];
          assert_true(fabs(node[3 * i + r] - at) <= TEETH * 1e-14);
        }
      whole += p >= TEETH && !motion[p].reshaped;
    }
    bw_mesh *moved;
    bw_subdomain_change change;
    check_ok(context, bw_mesh_moved(context, c.mesh, node, &moved));
    check_ok(context, bw_subdomain_stiffness_update(context, stiffness, moved, stiffness->material,
                                                    motion, &change));
    check_ok(context, bw_stiffness(context, pattern, moved, material, scratch));
    double largest = 0, off = 0;
    for (size_t k = 0; k < entries; k++) {
      largest = fmax(largest, fabs(scratch[k]));
      off = fmax(off, fabs(scratch[k] - stiffness->values[k]));
    }
    assert_true(off <= 1e-12 * largest);
    for (int32_t p = 0; p < d->stiffness.count; p++)
      left += !stiffness->changed[p];
    bw_release(moved);
  }
  assert_true(whole > 100);
  assert_true(left > 12 * d->stiffness.count / 2);
  free(motion);
  free(node);
  free(scratch);
  bw_release(stiffness);
  bw_release(pattern);
  bw_release(material);
  release_comb(&c);
}

check_main(check_test(test_cut), check_test(test_local), check_test(test_random_edits))
