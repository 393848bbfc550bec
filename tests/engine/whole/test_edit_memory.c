/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* Memory running out anywhere in a whole edit session, from the skeleton to stress gradients: each
 * failing allocation ends the run with a status, and nothing stays behind. */
#include "solver_by.h"

enum { BONES = 2, SLOPES = 2 };

static bw_status make_model(bw_context *context, const bw_mesh *mesh, bw_model **model) {
  bw_material *material = NULL;
  bw_model *made = NULL;
  bw_selection *fixed = NULL, *loaded = NULL;
  bw_status status;
  const double origin[3] = {0, 0, 0}, end[3] = {1, 0, 0}, left[3] = {1, 0, 0},
               right[3] = {-1, 0, 0}, down[3] = {0, 0, -10};
  BW_TRY(bw_material_named(context, "pla", &material));
  BW_TRY(bw_model_create(context, mesh, material, &made));
  BW_TRY(bw_select_half_space(context, mesh, origin, left, 1e-9, &fixed));
  BW_TRY(bw_select_half_space(context, mesh, end, right, 1e-9, &loaded));
  BW_TRY(bw_model_fix(context, made, fixed));
  BW_TRY(bw_model_force(context, made, loaded, down));
done:
  bw_release(fixed);
  bw_release(loaded);
  bw_release(material);
  if (status == BW_OK)
    *model = made;
  else
    bw_release(made);
  return status;
}

/* Where the nodes are in a pose, and how each subdomain of the subdomains moved; inner nodes are
 * relaxed where elements are inverted. */
typedef struct shape {
  double *map, *rotation, *node;
  bw_subdomain_motion *motion;
  uint8_t *inner;
} shape;

static bw_status shape_create(bw_context *context, const bw_subdomains *subdomains, shape *s) {
  size_t nodes = (size_t)subdomains->mesh->node_count;
  s->map = BW_NEW(context, double, 12 * BONES);
  s->rotation = BW_NEW(context, double, 9 * BONES);
  s->node = BW_NEW(context, double, 3 * nodes);
  s->motion = BW_NEW(context, bw_subdomain_motion, subdomains->stiffness.count);
  s->inner = BW_NEW(context, uint8_t, nodes);
  if (!s->map || !s->rotation || !s->node || !s->motion || !s->inner)
    return BW_MEMORY;
  memset(s->inner, 1, nodes);
  return BW_OK;
}

static void shape_clear(shape *s) {
  bw_free(s->map);
  bw_free(s->rotation);
  bw_free(s->node);
  bw_free(s->motion);
  bw_free(s->inner);
}

static bw_status pose_shape(bw_context *context, const bw_subdomains *subdomains,
                            const bw_bone_pose *pose, shape *s, bw_mesh **mesh) {
  bw_status status;
  bw_mesh_repair_report report;
  BW_TRY(bw_pose_maps(context, subdomains->skeleton, pose, s->map, s->rotation));
  BW_TRY(bw_pose_nodes(context, subdomains, s->map, s->node));
  bw_mesh_shape_check(subdomains->mesh, s->node, 0, &report);
  BW_TRY(bw_mesh_relax(context, subdomains->mesh, s->inner, s->node, &report));
  BW_TRY(bw_pose_motion(context, subdomains, s->map, s->rotation, s->motion));
  BW_TRY(bw_mesh_moved(context, subdomains->mesh, s->node, mesh));
done:
  return status;
}

static bw_status solve_local(void *data, bw_context *context, int64_t count, const double *force,
                             double *displacement) {
  return bw_incremental_system_solve(context, (bw_incremental_system *)data, NULL, count, force,
                                     displacement, NULL);
}

/* One edit followed and solved, and the slopes of two stresses. */
static bw_status follow_and_solve(bw_context *context, const bw_model *model,
                                  const bw_subdomains *subdomains, const bw_bone_pose *pose,
                                  shape *s, edit_way method, bw_incremental_system *incremental,
                                  double *max) {
  bw_mesh *mesh = NULL;
  bw_model *moved = NULL;
  bw_static *result = NULL;
  bw_reuse reuse;
  bw_incremental_options options;
  double *gradient = NULL, von_mises[SLOPES];
  bw_status status;
  BW_TRY(pose_shape(context, subdomains, pose, s, &mesh));
  BW_TRY(bw_model_moved(context, model, mesh, &moved));
  BW_TRY(bw_incremental_system_update(context, incremental, moved, s->motion, &reuse));
  bw_incremental_options_default(&options);
  options.solver = solver_by(method);
  BW_TRY(bw_incremental_statics(context, incremental, moved, NULL, &options, &result, &reuse));
  gradient = BW_NEW(context, double, SLOPES * 3 * (size_t)mesh->node_count);
  if (!gradient) {
    status = BW_MEMORY;
    goto done;
  }
  const int32_t nodes[SLOPES] = {0, mesh->node_count / 2};
  BW_TRY(bw_von_mises_gradient(context, moved, incremental->system->dof_map, result->displacement,
                               solve_local, incremental, SLOPES, nodes, NULL, von_mises, gradient));
  *max = von_mises[0];
done:
  bw_free(gradient);
  bw_release(result);
  bw_release(moved);
  bw_release(mesh);
  return status;
}

static bw_status whole_session(bw_context *context, double *max) {
  bw_mesh *mesh = NULL;
  bw_skeleton *skeleton = NULL;
  bw_subdomains *subdomains = NULL;
  bw_model *model = NULL;
  bw_incremental_system *incremental = NULL;
  double *weight = NULL;
  shape s = {NULL, NULL, NULL, NULL, NULL};
  bw_bone_pose pose[BONES];
  bw_reach_report reached;
  bw_status status;
  const double low[3] = {0, 0, 0}, high[3] = {1, 0.2, 0.2};
  const int cells[3] = {8, 1, 1};
  const double joint[9] = {0, 0.1, 0.1, 0.5, 0.1, 0.1, 1, 0.1, 0.1};
  const int32_t bone[2 * BONES] = {0, 1, 1, 2};
  BW_TRY(bw_mesh_box_grid(context, low, high, cells, 2, &mesh));
  BW_TRY(make_model(context, mesh, &model));
  BW_TRY(bw_skeleton_create(context, 3, joint, NULL, BONES, bone, NULL, 0, &skeleton));
  weight = BW_NEW(context, double, BONES *(size_t)mesh->node_count);
  if (!weight) {
    status = BW_MEMORY;
    goto done;
  }
  BW_TRY(bw_skinning_weights(context, mesh, skeleton, NULL, weight));
  BW_TRY(bw_subdomains_create(context, mesh, skeleton, weight, NULL, &subdomains));
  BW_TRY(shape_create(context, subdomains, &s));
  BW_TRY(bw_incremental_system_create(context, model, false, subdomains->stiffness.count,
                                      subdomains->stiffness.of_element,
                                      subdomains->stiffness.of_node, NULL, &incremental));
  for (int b = 0; b < BONES; b++)
    bw_bone_pose_rest(&pose[b]);
  pose[1].scale[1] = 1.2;
  BW_TRY(follow_and_solve(context, model, subdomains, pose, &s, WAY_REFACTOR, incremental, max));
  const bw_reach_target target = {
      .bone = 1, .along = 1, .at = {0.95, 0.15, 0.1}, .weight = 1, .chain_from = -1};
  BW_TRY(bw_pose_reach(context, skeleton, NULL, 1, &target, 0, pose, &reached));
  BW_TRY(follow_and_solve(context, model, subdomains, pose, &s, WAY_ITERATE, incremental, max));
  for (int b = 0; b < BONES; b++) /* undone */
    bw_bone_pose_rest(&pose[b]);
  BW_TRY(follow_and_solve(context, model, subdomains, pose, &s, WAY_AUTO, incremental, max));
done:
  shape_clear(&s);
  bw_free(weight);
  bw_release(incremental);
  bw_release(subdomains);
  bw_release(skeleton);
  bw_release(model);
  bw_release(mesh);
  return status;
}

/* The n-th allocation fails, for every `step`-th n: and all after it, or that one alone. */
static int64_t sweep(bw_context *context, int64_t asked, int64_t step, bool and_later,
                     double expected) {
  int64_t failed = 0;
  for (int64_t n = 1; n <= asked; n += step) {
    int64_t blocks = bw_live_blocks();
    double max = 0;
    bw_fail_allocation(n, and_later);
    bw_status status = whole_session(context, &max);
    bw_fail_allocation(0, false);
    if (bw_live_blocks() != blocks)
      fail_msg("allocation %lld: %lld blocks left", (long long)n,
               (long long)(bw_live_blocks() - blocks));
    if (status == BW_OK) { /* a warning or a cache went without */
      check_near(max, expected, 1e-8 * expected);
      continue;
    }
    failed++;
    if (status != BW_MEMORY)
      fail_msg("allocation %lld: %s (%s)", (long long)n, bw_message(context),
               bw_status_word(status));
  }
  return failed;
}

static void test_sweep(void **state) {
  bw_context *context = check_context(state);
  double max = 0, again = 0;
  check_ok(context, whole_session(context, &max));
  assert_true(max > 0);
  int64_t asked = bw_allocation_count();
  check_ok(context, whole_session(context, &again));
  asked = bw_allocation_count() - asked;
  assert_true(again == max);
  /* Every allocation in the full run, one in eleven otherwise. */
  int64_t step = getenv("BARWRIGHT_FULL") ? 1 : 11;
  int64_t all = sweep(context, asked, step, true, max);
  int64_t one = sweep(context, asked, step, false, max);
  printf("%lld allocations: %lld and all later made to fail, %lld alone\n", (long long)asked,
         (long long)all, (long long)one);
  assert_true(all > asked / step / 2 && one > asked / step / 2);
}

check_main(check_test(test_sweep))
