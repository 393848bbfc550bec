/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* Bodies with limbs for the tests of this folder: skeletons and weights made by hand. */
#ifndef LIMBS_H
#define LIMBS_H

#include "check.h"
#include "shape/internal.h"

/* A bar of 3 x 0.4 x 0.4 along x (n cells across) and three bones of length 1 along it. */
static inline bw_mesh *limbs_bar(bw_context *context, int order, int n) {
  bw_mesh *mesh;
  const double low[3] = {0, -0.2, -0.2}, high[3] = {3, 0.2, 0.2};
  const int cells[3] = {15 * n / 2, n, n};
  check_ok(context, bw_mesh_box_grid(context, low, high, cells, order, &mesh));
  return mesh;
}

static inline bw_skeleton *limbs_bar_bones(bw_context *context) {
  bw_skeleton *skeleton;
  const double joint[12] = {0, 0, 0, 1, 0, 0, 2, 0, 0, 3, 0, 0};
  const int32_t bone[6] = {0, 1, 1, 2, 2, 3};
  check_ok(context, bw_skeleton_create(context, 4, joint, NULL, 3, bone, NULL, 0, &skeleton));
  return skeleton;
}

/* A cross in the plane z = 0: four arms of length 1.5 from a middle block, 0.5 wide. */
static inline bw_mesh *limbs_cross(bw_context *context, int order) {
  bw_mesh *box, *cross;
  const double low[3] = {-1.5, -1.5, -0.25}, high[3] = {1.5, 1.5, 0.25};
  const int cells[3] = {12, 12, 2};
  check_ok(context, bw_mesh_box_grid(context, low, high, cells, order, &box));
  uint8_t *keep = calloc((size_t)box->element_count, 1);
  for (int32_t e = 0; e < box->element_count; e++) {
    double middle[2] = {0, 0};
    for (int k = 0; k < 4; k++)
      for (int j = 0; j < 2; j++)
        middle[j] += box->node[3 * box->element[e * box->nodes_per_element + k] + j] / 4;
    keep[e] = fabs(middle[0]) < 0.25 || fabs(middle[1]) < 0.25;
  }
  check_ok(context, bw_mesh_subset(context, box, keep, &cross));
  free(keep);
  bw_release(box);
  return cross;
}

static inline bw_skeleton *limbs_cross_bones(bw_context *context) {
  bw_skeleton *skeleton;
  const double joint[15] = {0, 0, 0, 1.4, 0, 0, 0, 1.4, 0, -1.4, 0, 0, 0, -1.4, 0};
  const int32_t bone[8] = {0, 1, 0, 2, 0, 3, 0, 4};
  check_ok(context, bw_skeleton_create(context, 5, joint, NULL, 4, bone, NULL, 0, &skeleton));
  return skeleton;
}

static inline double limbs_distance(const bw_skeleton *skeleton, int32_t b, const double at[3]) {
  return bwi_segment_distance(at, skeleton->joint + 3 * skeleton->bone[2 * b],
                              skeleton->joint + 3 * skeleton->bone[2 * b + 1]);
}

/* Weights that fall off with the distance to the nearest bone: near one along a bone, shared at
 * joints. */
static inline double *limbs_weights(const bw_mesh *mesh, const bw_skeleton *skeleton,
                                    double sharpness) {
  int32_t bones = skeleton->bone_count;
  double *weight = malloc((size_t)mesh->node_count * (size_t)bones * sizeof *weight);
  for (int32_t i = 0; i < mesh->node_count; i++) {
    double sum = 0, *w = weight + (size_t)i * (size_t)bones, min = INFINITY;
    for (int32_t b = 0; b < bones; b++) {
      w[b] = limbs_distance(skeleton, b, mesh->node + 3 * i);
      min = fmin(min, w[b]);
    }
    for (int32_t b = 0; b < bones; b++)
      sum += w[b] = exp(-sharpness * (w[b] - min));
    for (int32_t b = 0; b < bones; b++)
      w[b] /= sum;
  }
  return weight;
}

/* A body, its bones, and weights of that sharpness. */
typedef struct limbs {
  bw_mesh *mesh;
  bw_skeleton *skeleton;
  double *weight;
} limbs;

static inline limbs limbs_of_bar(bw_context *context, int order, int n, double sharpness) {
  limbs l = {limbs_bar(context, order, n), limbs_bar_bones(context), NULL};
  l.weight = limbs_weights(l.mesh, l.skeleton, sharpness);
  return l;
}

static inline limbs limbs_of_cross(bw_context *context, int order, double sharpness) {
  limbs l = {limbs_cross(context, order), limbs_cross_bones(context), NULL};
  l.weight = limbs_weights(l.mesh, l.skeleton, sharpness);
  return l;
}

static inline void limbs_drop(limbs *l) {
  free(l->weight);
  bw_release(l->mesh);
  bw_release(l->skeleton);
}

static inline void limbs_turn(double rotation[9], const double axis[3], double angle) {
  double length = bw_norm(axis), c = cos(angle), s = sin(angle);
  double a[3] = {axis[0] / length, axis[1] / length, axis[2] / length};
  for (int i = 0; i < 3; i++)
    for (int j = 0; j < 3; j++)
      rotation[3 * i + j] = (1 - c) * a[i] * a[j] + (i == j ? c : 0);
  rotation[1] -= s * a[2];
  rotation[2] += s * a[1];
  rotation[3] += s * a[2];
  rotation[5] -= s * a[0];
  rotation[6] -= s * a[1];
  rotation[7] += s * a[0];
}

static inline void limbs_random_pose(bw_random *random, int32_t bones, bw_bone_pose *pose) {
  for (int32_t b = 0; b < bones; b++) {
    bw_bone_pose_rest(pose + b);
    double axis[3];
    for (int k = 0; k < 3; k++) {
      axis[k] = bw_random_normal(random);
      pose[b].scale[k] = 0.7 + 0.6 * bw_random_uniform(random);
      pose[b].translation[k] = 0.1 * bw_random_normal(random);
    }
    limbs_turn(pose[b].rotation, axis, 0.8 * bw_random_normal(random));
  }
}

#endif
