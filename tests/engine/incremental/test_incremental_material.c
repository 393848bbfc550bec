/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* Orthotropic materials of bodies that are edited: axes that stay, axes that turn with
 * the subdomains. */
#include "incremental_bar.h"

/* Printed material: its axes stay those of the printer, or turn with the subdomains. */
static void print_bar(bw_context *context, bar *b) {
  const bw_orthotropic constants = {.name = "print",
                                    .young = {2e9, 1.8e9, 1.2e9},
                                    .poisson = {0.35, 0.3, 0.3},
                                    .shear = {6e8, 5e8, 7e8},
                                    .density = 1100,
                                    .strength = {3e7, 3e7, 2e7}};
  bar_make(context, 1, 1, b);
  bw_release(b->material);
  bw_release(b->model);
  check_ok(context, bw_material_orthotropic(context, &constants, &b->material));
  check_ok(context, bw_model_create(context, b->mesh, b->material, &b->model));
  load_bar(context, b, 0);
}

/* The material of every subdomain turned as the subdomain is. */
static void rotate_material(bw_context *context, const bar *b, bw_model *model) {
  double turn[SUBDOMAINS][9];
  for (int d = 0; d < SUBDOMAINS; d++)
    memcpy(turn[d], b->rotation[d / 2], sizeof turn[d]);
  check_ok(context,
           bw_model_rotate_material(context, model, SUBDOMAINS, b->element_subdomain, turn[0]));
}

static void orthotropic(void **state) {
  bw_context *context = check_context(state);
  for (int turns = 0; turns < 2; turns++) {
    bar b;
    print_bar(context, &b);
    bw_incremental_system *incremental = NULL;
    check_ok(context,
             bw_incremental_system_create(context, b.model, turns, SUBDOMAINS, b.element_subdomain,
                                          b.node_subdomain, NULL, &incremental));
    bw_incremental_options options;
    bw_incremental_options_default(&options);
    options.check = true;
    for (int step = 0; step < 3; step++) {
      bw_reuse reuse = {0};
      bw_static *result = NULL;
      if (step == 0)
        turn_subdomain(&b, 0, 0.5); /* all as one */
      else
        turn_subdomain(&b, step, 0.2);
      bw_model *model = posed(context, &b);
      if (turns) { /* the material must lie as the subdomains do */
        uint64_t revision = incremental->object.revision;
        check_fails(context, BW_INVALID, "another material orientation than its subdomain",
                    bw_incremental_system_update(context, incremental, model, b.motion, &reuse));
        assert_int_equal(incremental->object.revision, revision);
        rotate_material(context, &b, model);
      }
      options.solver = solver_by(step == 2 ? WAY_ITERATE : WAY_REFACTOR);
      check_ok(context,
               bw_incremental_system_update(context, incremental, model, b.motion, &reuse));
      check_ok(context, bw_incremental_statics(context, incremental, model, NULL, &options, &result,
                                               &reuse));
      if (step == 0 && turns)
        check_near(reuse.factor_reused, 1, 0);
      if (step == 0 && !turns)
        check_near(reuse.factor_reused, 0, 0); /* against the printer's axes all has turned */
      bw_release(result);
      bw_release(model);
    }
    bw_release(incremental);
    bar_clear(&b);
  }
}

/* A bar whose material turned with it has the stress of one of that shape whose material was given
 * so from the start: as a whole by bw_material_rotated, bent by element; and of the latter a system
 * can be made at that shape, and go on. */
static void material_rotates(void **state) {
  bw_context *context = check_context(state);
  bar b;
  print_bar(context, &b);
  bw_incremental_system *incremental = NULL;
  check_ok(context,
           bw_incremental_system_create(context, b.model, true, SUBDOMAINS, b.element_subdomain,
                                        b.node_subdomain, NULL, &incremental));
  size_t count = 6 * (size_t)b.mesh->node_count;
  double *mine = numbers((int64_t)count), *fresh = numbers((int64_t)count);
  for (int step = 0; step < 3; step++) {
    bw_reuse reuse = {0};
    bw_static *followed = NULL, *rebuilt = NULL;
    bw_material *rotated = NULL;
    bw_model *other = NULL;
    turn_subdomain(&b, step == 0 ? 0 : step, 0.3);
    bw_model *model = posed(context, &b);
    rotate_material(context, &b, model);
    check_ok(context, bw_incremental_system_update(context, incremental, model, b.motion, &reuse));
    check_ok(context,
             bw_incremental_statics(context, incremental, model, NULL, NULL, &followed, &reuse));
    check_ok(context, bw_static_stress(context, followed, true, mine));
    if (step == 0) {
      bar c = b;
      check_ok(context, bw_material_rotated(context, b.material, b.rotation[0], &rotated));
      check_ok(context, bw_model_create(context, b.mesh, rotated, &c.model));
      load_bar(context, &c, 0);
      check_ok(context, bw_model_moved(context, c.model, model->mesh, &other));
      bw_release(c.model);
    } else
      other = bw_retain(model);
    check_ok(context, bw_statics(context, other, NULL, NULL, &rebuilt));
    check_ok(context, bw_static_stress(context, rebuilt, true, fresh));
    check_near(difference(mine, fresh, (int64_t)count), 0, 1e-8);
    double error_mine = 0, error_fresh = 0;
    check_ok(context, bw_error_estimate(context, model->mesh, model->material,
                                        followed->displacement, NULL, &error_mine));
    check_ok(context, bw_error_estimate(context, other->mesh, other->material,
                                        rebuilt->displacement, NULL, &error_fresh));
    check_near(error_mine / error_fresh, 1, 1e-8);
    if (step == 2) { /* with the material as it lay at rest the stress is another */
      check_ok(context,
               bw_nodal_stress(context, model->mesh, b.material, followed->displacement, fresh));
      assert_true(difference(mine, fresh, (int64_t)count) > 0.01);
    }
    bw_release(followed);
    bw_release(rebuilt);
    bw_release(rotated);
    bw_release(other);
    if (step == 1) { /* from here on by a system made at this shape */
      bw_release(incremental);
      check_ok(context,
               bw_incremental_system_create(context, model, true, SUBDOMAINS, b.element_subdomain,
                                            b.node_subdomain, NULL, &incremental));
      bw_release(b.model);
      b.model = bw_retain(model);
    }
    bw_release(model);
    if (step == 1) { /* motions count from here: turn all as one, material and frames with it */
      bw_subdomain_motion motion[SUBDOMAINS];
      double turn[9], all[SUBDOMAINS][9], *x = numbers(3 * b.mesh->node_count);
      const double axis[3] = {1, -1, 2};
      bw_mesh *mesh = NULL;
      rotation_about(axis, 0.7, turn);
      for (int d = 0; d < SUBDOMAINS; d++) {
        bw_subdomain_motion_rest(&motion[d]);
        memcpy(motion[d].linear, turn, sizeof turn);
        for (int i = 0; i < 9; i++)
          motion[d].frame[i] = turn[3 * (i % 3) + i / 3];
        multiply(turn, b.rotation[d / 2], all[d]);
      }
      for (int32_t i = 0; i < b.mesh->node_count; i++)
        for (int c = 0; c < 3; c++)
          x[3 * i + c] = bw_dot(turn + 3 * c, b.model->mesh->node + 3 * i);
      check_ok(context, bw_mesh_moved(context, b.model->mesh, x, &mesh));
      bw_model *plain = NULL;
      bar c = b;
      check_ok(context, bw_model_create(context, b.mesh, b.material, &c.model));
      load_bar(context, &c, 0);
      check_ok(context, bw_model_moved(context, c.model, mesh, &plain));
      check_ok(context,
               bw_model_rotate_material(context, plain, SUBDOMAINS, b.element_subdomain, all[0]));
      reuse = (bw_reuse){0};
      check_ok(context, bw_incremental_system_update(context, incremental, plain, motion, &reuse));
      bw_incremental_options options;
      bw_incremental_options_default(&options);
      options.check = true;
      check_ok(context, bw_incremental_statics(context, incremental, plain, NULL, &options,
                                               &followed, &reuse));
      check_near(reuse.factor_reused, 1, 0);
      bw_release(followed);
      bw_release(plain);
      bw_release(mesh);
      bw_release(incremental);
      free(x);
      bw_release(b.model); /* and the last step from rest again */
      b.model = c.model;
      incremental = NULL;
      check_ok(context,
               bw_incremental_system_create(context, b.model, true, SUBDOMAINS, b.element_subdomain,
                                            b.node_subdomain, NULL, &incremental));
    }
  }
  free(mine);
  free(fresh);
  bw_release(incremental);
  bar_clear(&b);
}

check_main(check_test(orthotropic), check_test(material_rotates))
