/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* Factors in single precision: as exact in the end, chosen by cost, given up where they break down.
 */
#include "incremental_bar.h"

/* What it takes and what it says; from one precision to the other. */
static void precisions(void **state) {
  bw_context *context = check_context(state);
  bar b;
  bar_make(context, 3, 2, &b);
  load_bar(context, &b, 0);
  bw_incremental_system *incremental = incremental_of(context, &b);
  size_t factor[2], updates[2];
  for (int k = 0; k < 2; k++) {
    bw_reuse r = {0};
    b.now.scale[1][1] = 1.1 + 0.1 * k;
    bw_model *model = posed(context, &b);
    check_ok(context, bw_incremental_system_update(context, incremental, model, b.motion, &r));
    compare_in(context, incremental, model, WAY_REFACTOR, 32 + 32 * k, &r);
    assert_int_equal(r.precision, 32 + 32 * k);
    assert_int_equal(way_of(&r), WAY_FULL); /* there was one in the other precision */
    assert_int_equal(r.iterations, 0);
    assert_int_equal(r.refinements > 0, k == 0);
    assert_true(r.refinements < 10);
    bw_incremental_system_memory(incremental, &factor[k], &updates[k]);
    bw_release(model);
    model = NULL;
  }
  assert_int_equal(factor[1], 2 * factor[0]);
  assert_int_equal(updates[1], 2 * updates[0]);
  bw_incremental_options options = {.tolerance = 1e-10, .precision = 16};
  check_fails(context, BW_INVALID, "32 or 64 bits",
              bw_incremental_system_solve(context, incremental, &options, 1, b.node, b.node, NULL));
  bw_release(incremental);
  bar_clear(&b);
}

/* A waist of a third still does; one of a tenth, where elements are ten times as long as thick both
 * ways, is too much for seven digits: the factor in single precision breaks down, the one in double
 * precision serves, from then on, and that is reported. */
static void too_thin_for_single(void **state) {
  bw_context *context = check_context(state);
  for (int k = 0; k < 2; k++) {
    const double waist[2] = {0.3, 0.1};
    bar b;
    bar_make(context, 2, 2, &b);
    load_bar(context, &b, 0);
    bw_incremental_system *incremental = incremental_of(context, &b);
    bw_static *result = NULL, *fresh = NULL;
    bw_incremental_options options;
    bw_incremental_options_default(&options);
    options.precision = 32;
    options.solver = solver_by(WAY_REFACTOR);
    bw_reuse reuse = {0};
    check_ok(context, bw_incremental_statics(context, incremental, b.model, NULL, &options, &result,
                                             &reuse));
    assert_int_equal(reuse.precision, 32);
    bw_release(result);
    b.now.scale[1][1] = b.now.scale[1][2] = waist[k];
    follow(&b);
    bw_mesh *mesh = NULL;
    bw_model *model = NULL;
    check_ok(context, bw_mesh_moved(context, b.mesh, b.node, &mesh));
    check_ok(context, bw_model_moved(context, b.model, mesh, &model));
    bw_clear_warnings(context);
    check_ok(context, bw_incremental_system_update(context, incremental, model, b.motion, &reuse));
    check_ok(context,
             bw_incremental_statics(context, incremental, model, NULL, &options, &result, &reuse));
    check_ok(context, bw_statics(context, model, NULL, NULL, &fresh));
    int64_t size = 3 * (int64_t)mesh->node_count;
    /* of either solution of the thin one the residual is 6e-8 by rounding alone */
    check_near(difference(result->displacement, fresh->displacement, size), 0,
               k == 0 ? 1e-8 : 6e-8);
    bw_release(result);
    assert_int_equal(reuse.precision, k == 0 ? 32 : 64);
    if (k == 1) {
      assert_int_equal(way_of(&reuse), WAY_FULL);
      assert_non_null(strstr(bw_warning_at(context, 0), "double precision from now on"));
      b.now.scale[1][1] = b.now.scale[1][2] = 1;
      bw_model *back = posed(context, &b);
      check_ok(context, bw_incremental_system_update(context, incremental, back, b.motion, &reuse));
      compare_in(context, incremental, back, WAY_AUTO, 32, &reuse);
      assert_int_equal(reuse.precision, 64);
      bw_release(back);
    }
    bw_release(fresh);
    bw_release(model);
    bw_release(mesh);
    bw_release(incremental);
    bar_clear(&b);
  }
}

/* By cost: where iterations are cheap single precision, where they are expensive double, and no
 * more of single once it failed. */
static void choice_of_precision(void **state) {
  bw_context *context = check_context(state);
  bar b;
  bar_make(context, 3, 2, &b);
  load_bar(context, &b, 0);
  bw_incremental_system *incremental = incremental_of(context, &b);
  bwi_incremental *inner = incremental->inner;
  for (int k = 0; k < 4; k++) {
    int bits = k == 3 ? 64 : 0;
    inner->refinements = k == 1 ? 200 : 0.01;
    inner->double_only = k == 2;
    check_ok(context, bwi_incremental_choose_bits(context, incremental, inner->reach, &bits));
    assert_int_equal(bits, k == 0 ? 32 : 64);
  }
  bw_release(incremental);
  bar_clear(&b);
}

check_main(check_test(precisions), check_test(too_thin_for_single), check_test(choice_of_precision))
