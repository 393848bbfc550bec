/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* Subdomains on refilled meshes: the pose they were filled in gives the filled nodes back, and in
 * every pose the surface is what it was before. */
#include "limbs.h"

#include <string.h>

typedef struct scene {
  bw_mesh *mesh, *posed, *refilled;
  bw_skeleton *skeleton;
  bw_subdomains *subdomains;
  double *weight, *node;
  double map[36];
  uint8_t *replace;
  int32_t *node_from, *element_from;
} scene;

static bool is_blended(const bw_subdomains *d, int32_t e) {
  return d->bone_of[d->element_subdomain[e]] < 0;
}

static void pose_maps(bw_context *context, const bw_skeleton *skeleton, double degrees,
                      double scale, double map[36]) {
  bw_bone_pose pose[3];
  const double z[3] = {0, 0, 1};
  for (int b = 0; b < 3; b++)
    bw_bone_pose_rest(&pose[b]);
  limbs_turn(pose[1].rotation, z, degrees * acos(-1) / 180);
  pose[2].scale[1] = scale;
  pose[0].translation[2] = 0.1;
  check_ok(context, bw_pose_maps(context, skeleton, pose, map, NULL));
}

static scene make(bw_context *context, int order) {
  scene s = {0};
  s.mesh = limbs_bar(context, order, 2);
  s.skeleton = limbs_bar_bones(context);
  s.weight = limbs_weights(s.mesh, s.skeleton, 12);
  bw_subdomains_options options = {.threshold = 0.95};
  check_ok(context,
           bw_subdomains_create(context, s.mesh, s.skeleton, s.weight, &options, &s.subdomains));
  pose_maps(context, s.skeleton, 50, 1.3, s.map);
  s.node = malloc(3 * (size_t)s.mesh->node_count * sizeof *s.node);
  check_ok(context, bw_pose_nodes(context, s.subdomains, s.map, s.node));
  s.replace = calloc((size_t)s.mesh->element_count, 1);
  for (int32_t e = 0; e < s.mesh->element_count; e++)
    s.replace[e] = is_blended(s.subdomains, e);
  check_ok(context, bw_mesh_refill(context, s.mesh, s.node, s.replace, &s.refilled, &s.node_from,
                                   &s.element_from));
  return s;
}

static void clear(scene *s) {
  bw_free(s->node_from);
  bw_free(s->element_from);
  free(s->replace);
  free(s->node);
  free(s->weight);
  bw_release(s->subdomains);
  bw_release(s->skeleton);
  bw_release(s->refilled);
  bw_release(s->mesh);
}

static void check_nodes(const double *want, const double *got, int64_t count, double tolerance) {
  for (int64_t i = 0; i < count; i++)
    check_near(got[i], want[i], tolerance);
}

static void test_refilled(void **state) {
  bw_context *context = check_context(state);
  for (int order = 1; order <= 2; order++) {
    scene s = make(context, order);
    bw_subdomains *d;
    check_ok(context, bw_subdomains_refilled(context, s.subdomains, s.map, s.replace, s.refilled,
                                             s.node_from, s.element_from, &d));
    check_ok(context, bw_subdomains_check(context, d));
    assert_int_equal(d->count, s.subdomains->count);
    assert_true(d->mesh->element_count != s.mesh->element_count);
    /* the pose it was filled in */
    int32_t nodes = d->mesh->node_count;
    double *got = malloc(3 * (size_t)nodes * sizeof *got), map[36];
    check_ok(context, bw_pose_nodes(context, d, s.map, got));
    check_nodes(s.refilled->node, got, 3 * (int64_t)nodes, 1e-13);
    /* other poses: kept nodes, and with them the surface, as before */
    for (int k = 0; k < 3; k++) {
      pose_maps(context, s.skeleton, 20.0 * k, 1 + 0.2 * k, map);
      check_ok(context, bw_pose_nodes(context, s.subdomains, map, s.node));
      check_ok(context, bw_pose_nodes(context, d, map, got));
      int32_t inner = 0;
      for (int32_t i = 0; i < nodes; i++) {
        if (s.node_from[i] >= 0)
          assert_memory_equal(got + 3 * i, s.node + 3 * s.node_from[i], 3 * sizeof *got);
        inner += s.node_from[i] < 0;
      }
      assert_true(inner > 0);
    }
    /* elements kept and new are in the subdomain they were in */
    for (int32_t e = 0; e < d->mesh->element_count; e++) {
      if (s.element_from[e] >= 0)
        assert_int_equal(d->element_subdomain[e],
                         s.subdomains->element_subdomain[s.element_from[e]]);
      else
        assert_true(is_blended(d, e));
    }
    free(got);
    bw_release(d);
    clear(&s);
  }
}

static void test_refusals(void **state) {
  bw_context *context = check_context(state);
  scene s = make(context, 1);
  bw_subdomains *d = NULL;
  /* an element of a bone's subdomain among those replaced */
  int32_t rigid = 0;
  while (is_blended(s.subdomains, rigid))
    rigid++;
  s.replace[rigid] = 1;
  check_fails(context, BW_INVALID, "only blended subdomains",
              bw_subdomains_refilled(context, s.subdomains, s.map, s.replace, s.refilled,
                                     s.node_from, s.element_from, &d));
  s.replace[rigid] = 0;
  /* numbers that do not exist */
  int32_t kept = s.node_from[0];
  s.node_from[0] = s.mesh->node_count;
  check_fails(context, BW_INVALID, "does not exist",
              bw_subdomains_refilled(context, s.subdomains, s.map, s.replace, s.refilled,
                                     s.node_from, s.element_from, &d));
  s.node_from[0] = kept;
  kept = s.element_from[0];
  s.element_from[0] = -1000;
  check_fails(context, BW_INVALID, "does not exist",
              bw_subdomains_refilled(context, s.subdomains, s.map, s.replace, s.refilled,
                                     s.node_from, s.element_from, &d));
  s.element_from[0] = kept;
  /* bones that are opposite mirror images blend to a plane */
  double map[36];
  memset(map, 0, sizeof map);
  for (int b = 0; b < 3; b++)
    for (int k = 0; k < 2; k++)
      map[12 * b + 5 * k] = 1;
  check_fails(context, BW_GEOMETRY, "blend is singular",
              bw_subdomains_refilled(context, s.subdomains, map, s.replace, s.refilled, s.node_from,
                                     s.element_from, &d));
  clear(&s);
}

static void test_memory(void **state) {
  bw_context *context = check_context(state);
  scene s = make(context, 2);
  bw_subdomains *d = NULL;
  check_each_allocation(context, status, 20) {
    status = bw_subdomains_refilled(context, s.subdomains, s.map, s.replace, s.refilled,
                                    s.node_from, s.element_from, &d);
  }
  bw_release(d);
  clear(&s);
}

check_main(check_test(test_refilled), check_test(test_refusals), check_test(test_memory))
