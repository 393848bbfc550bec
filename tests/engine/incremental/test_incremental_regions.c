/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* Bodies of several materials that are edited, one of which becomes another: against solutions from
 * scratch, back with the same bits, and at the cost of an edit of the same subdomain. */
#include "incremental_bar.h"

static bw_material *elastic(bw_context *context, double young, double poisson) {
  const bw_isotropic constants = {
      .name = "elastic", .young = young, .poisson = poisson, .density = 1e-6 * young};
  bw_material *material = NULL;
  check_ok(context, bw_material_isotropic(context, &constants, &material));
  return material;
}

static bw_material *printed(bw_context *context, double young) {
  const bw_orthotropic constants = {.name = "print",
                                    .young = {young, 0.9 * young, 0.6 * young},
                                    .poisson = {0.35, 0.3, 0.3},
                                    .shear = {0.3 * young, 0.25 * young, 0.35 * young},
                                    .density = 1100};
  bw_material *material = NULL;
  check_ok(context, bw_material_orthotropic(context, &constants, &material));
  return material;
}

/* Every subdomain of its own material; part[SUBDOMAINS] stays the caller's. */
static void use(bw_context *context, bar *b, const bw_material *const *part) {
  bw_release(b->material);
  bw_release(b->model);
  check_ok(context, bw_material_by_element(context, b->mesh->element_count, SUBDOMAINS,
                                           b->element_subdomain, part, &b->material));
  check_ok(context, bw_model_create(context, b->mesh, b->material, &b->model));
  load_bar(context, b, 0);
}

static bw_reuse follow_bar(bw_context *context, bar *b, bw_incremental_system *incremental) {
  bw_reuse reuse = {0};
  bw_model *model = posed(context, b);
  assert_non_null(model);
  check_ok(context, bw_incremental_system_update(context, incremental, model, b->motion, &reuse));
  bw_release(model);
  return reuse;
}

static double *solved(bw_context *context, bw_incremental_system *incremental, edit_way way,
                      bw_reuse *reuse) {
  bw_incremental_options options;
  bw_incremental_options_default(&options);
  options.solver = solver_by(way);
  options.precision = 64;
  double *u = numbers(3 * incremental->system->mesh->node_count);
  bw_static *result = NULL;
  check_ok(context, bw_incremental_statics(context, incremental, incremental->inner->model, NULL,
                                           &options, &result, reuse));
  memcpy(u, result->displacement, 3 * (size_t)incremental->system->mesh->node_count * sizeof *u);
  bw_release(result);
  return u;
}

/* Changes of material between edits of the pose, by every way to solve. */
static void from_scratch(void **state) {
  bw_context *context = check_context(state);
  const edit_way ways[] = {WAY_REFACTOR, WAY_ITERATE, WAY_PCG, WAY_AUTO};
  for (int order = 1; order <= 2; order++) {
    bar b;
    bar_make(context, 2, order, &b);
    bw_material *soft = elastic(context, 2e9, 0.35), *hard = elastic(context, 70e9, 0.3);
    bw_material *steel = elastic(context, 210e9, 0.28);
    const bw_material *part[SUBDOMAINS] = {soft, soft, hard, soft, soft};
    use(context, &b, part);
    bw_incremental_system *incremental = incremental_of(context, &b);
    for (int step = 0; step < 12; step++) {
      const bw_material *choice[] = {soft, hard, steel};
      part[(3 * step + 2) % SUBDOMAINS] = choice[step % 3];
      use(context, &b, part);
      if (step % 3 == 1)
        turn_subdomain(&b, 1 + step % 2, 0.1);
      if (step == 7) /* all of one material, and back */
        for (int d = 0; d < SUBDOMAINS; d++)
          part[d] = soft;
      use(context, &b, part);
      edit_way way = ways[step % 4];
      edit_and_compare(context, &b, incremental, order == 1 && way == WAY_PCG ? WAY_AUTO : way);
    }
    bw_release(incremental);
    bw_release(soft);
    bw_release(hard);
    bw_release(steel);
    bar_clear(&b);
  }
}

/* The same bits however often materials went back and forth; and where a change is taken back
 * before it was solved, nothing is done. */
static void back_and_forth(void **state) {
  bw_context *context = check_context(state);
  bar b;
  bar_make(context, 2, 2, &b);
  bw_material *soft = elastic(context, 2e9, 0.35), *hard = elastic(context, 70e9, 0.3);
  const bw_material *first[SUBDOMAINS] = {soft, soft, hard, soft, soft};
  const bw_material *second[SUBDOMAINS] = {soft, soft, soft, soft, soft};
  const bw_material *third[SUBDOMAINS] = {soft, hard, hard, soft, hard};
  use(context, &b, first);
  bw_incremental_system *incremental = incremental_of(context, &b);
  turn_subdomain(&b, 1, 0.2);
  bw_reuse reuse = follow_bar(context, &b, incremental);
  /* the factor of what was only turned is that at rest, but for rounding: make all of it */
  double *before = solved(context, incremental, WAY_FULL, &reuse);
  size_t entries = 9 * (size_t)incremental->system->pattern->block_count;
  double *values = numbers((int64_t)entries);
  memcpy(values, incremental->system->stiffness, entries * sizeof *values);
  for (int round = 0; round < 3; round++) {
    use(context, &b, round % 2 ? third : second);
    reuse = follow_bar(context, &b, incremental);
    assert_int_equal(reuse.subdomains_changed, round % 2 ? 2 : 1);
    double *other = solved(context, incremental, WAY_REFACTOR, &reuse);
    assert_true(difference(other, before, 3 * b.mesh->node_count) > 0.01);
    free(other);
    use(context, &b, first);
    reuse = follow_bar(context, &b, incremental);
    double *again = solved(context, incremental, WAY_REFACTOR, &reuse);
    assert_true(reuse.factor_reused < 1);
    assert_memory_equal(values, incremental->system->stiffness, entries * sizeof *values);
    assert_memory_equal(before, again, 3 * (size_t)b.mesh->node_count * sizeof *before);
    free(again);
  }
  use(context, &b, third);
  follow_bar(context, &b, incremental);
  use(context, &b, first);
  reuse = follow_bar(context, &b, incremental);
  free(solved(context, incremental, WAY_REFACTOR, &reuse));
  check_near(reuse.factor_reused, 1, 0);
  free(before);
  free(values);
  bw_release(incremental);
  bw_release(soft);
  bw_release(hard);
  bar_clear(&b);
}

/* Exactly the factor's work of an edit of the same subdomain: its inner nodes moved. */
static void costs_as_an_edit(void **state) {
  bw_context *context = check_context(state);
  bar b;
  bar_make(context, 3, 1, &b);
  bw_material *soft = elastic(context, 2e9, 0.35), *hard = elastic(context, 70e9, 0.3);
  for (int d = 0; d < SUBDOMAINS; d += 2) {
    const bw_material *part[SUBDOMAINS] = {soft, soft, soft, soft, soft};
    double reused[2];
    use(context, &b, part);
    follow(&b);
    for (int kind = 0; kind < 2; kind++) {
      bw_incremental_system *incremental = incremental_of(context, &b);
      bw_model *model = NULL;
      bw_mesh *mesh = bw_retain(b.mesh);
      bw_reuse reuse = {0};
      bw_subdomain_motion motion[SUBDOMAINS];
      memcpy(motion, b.motion, sizeof motion);
      if (kind == 0) {
        double *node = numbers(3 * b.mesh->node_count);
        memcpy(node, b.mesh->node, 3 * (size_t)b.mesh->node_count * sizeof *node);
        for (int32_t i = 0; i < b.mesh->node_count; i++) {
          double *x = node + 3 * i;
          if (x[0] > cut[d] + 0.1 && x[0] < cut[d + 1] - 0.1 && x[1] > 0.1 && x[1] < 0.9 &&
              x[2] > 0.1 && x[2] < 0.9)
            x[0] += 0.05;
        }
        motion[d].reshaped = true;
        bw_release(mesh);
        check_ok(context, bw_mesh_moved(context, b.mesh, node, &mesh));
        free(node);
      } else {
        part[d] = hard;
        use(context, &b, part);
      }
      check_ok(context, bw_model_moved(context, b.model, mesh, &model));
      check_ok(context, bw_incremental_system_update(context, incremental, model, motion, &reuse));
      assert_int_equal(reuse.subdomains_changed, 1);
      free(solved(context, incremental, WAY_REFACTOR, &reuse));
      reused[kind] = reuse.factor_reused;
      bw_release(model);
      bw_release(mesh);
      bw_release(incremental);
    }
    assert_true(reused[0] > 0 && reused[0] < 1);
    check_near(reused[1], reused[0], 0);
  }
  bw_release(soft);
  bw_release(hard);
  bar_clear(&b);
}

/* One subdomain that becomes stiffer and another that becomes softer spread the eigenvalues by the
 * product of both. */
static void spreads_multiply(void **state) {
  bw_context *context = check_context(state);
  bar b;
  bar_make(context, 3, 1, &b);
  bw_material *soft = elastic(context, 2e9, 0.3), *hard = elastic(context, 16e9, 0.3);
  bw_material *middle = elastic(context, 4e9, 0.3);
  const bw_material *before[SUBDOMAINS] = {middle, middle, middle, middle, middle};
  use(context, &b, before);
  follow(&b);
  for (int changes = 1; changes <= 2; changes++) {
    const bw_material *part[SUBDOMAINS] = {hard, middle, middle, middle,
                                           changes == 2 ? soft : middle};
    use(context, &b, before);
    bw_incremental_system *incremental = incremental_of(context, &b);
    use(context, &b, part);
    bw_reuse reuse = follow_bar(context, &b, incremental);
    assert_int_equal(reuse.subdomains_changed, changes);
    free(solved(context, incremental, WAY_ITERATE, &reuse));
    check_near(pow(1 + 20 * incremental->inner->change, 2), changes == 1 ? 4 : 8, 1e-9);
    bw_release(incremental);
  }
  bw_release(soft);
  bw_release(middle);
  bw_release(hard);
  bar_clear(&b);
}

/* Laws that are not isotropic are followed where the axes stay and were known from the start. */
static void other_laws(void **state) {
  bw_context *context = check_context(state);
  bar b;
  bar_make(context, 1, 1, &b);
  bw_material *soft = elastic(context, 2e9, 0.35), *hard = elastic(context, 70e9, 0.3);
  bw_material *print = printed(context, 2e9), *fine = printed(context, 3e9);
  const bw_material *part[SUBDOMAINS] = {soft, hard, soft, soft, soft};
  use(context, &b, part);
  bw_incremental_system *incremental = incremental_of(context, &b);
  part[1] = print; /* its axes are in no list of frames */
  use(context, &b, part);
  bw_model *model = posed(context, &b);
  uint64_t revision = incremental->object.revision;
  bw_reuse reuse = {0};
  check_fails(context, BW_UNSUPPORTED, "make the system again",
              bw_incremental_system_update(context, incremental, model, b.motion, &reuse));
  assert_int_equal(incremental->object.revision, revision);
  assert_false(bw_subdomain_stiffness_follows(incremental->stiffness, model->material));
  bw_release(model);
  bw_release(incremental);
  incremental = incremental_of(context, &b);
  for (int step = 0; step < 4; step++) {
    const bw_material *choice[] = {fine, soft, print, hard};
    part[1 + step % 3] = choice[step];
    use(context, &b, part);
    turn_subdomain(&b, 1, 0.1);
    edit_and_compare(context, &b, incremental, WAY_REFACTOR);
  }
  int32_t kept = b.element_subdomain[0]; /* two materials in one subdomain */
  b.element_subdomain[0] = 1 + kept;
  use(context, &b, part);
  b.element_subdomain[0] = kept;
  model = posed(context, &b);
  check_fails(context, BW_INVALID, "each subdomain needs one",
              bw_incremental_system_update(context, incremental, model, b.motion, &reuse));
  bw_release(model);
  bw_release(incremental);
  bw_release(soft);
  bw_release(hard);
  bw_release(print);
  bw_release(fine);
  bar_clear(&b);
}

check_main(check_test(from_scratch), check_test(back_and_forth), check_test(costs_as_an_edit),
           check_test(spreads_multiply), check_test(other_laws))
