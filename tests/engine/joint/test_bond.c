/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* Bonds of meshes that do not match: patch tests, balance, modes, and what is refused. */
#include "pair.h"

#include "barwright/analysis.h"
#include "barwright/joint.h"

static const double axis[3][3] = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}};

typedef struct stack {
  bw_mesh *mesh;
  bw_material *material;
  bw_model *model;
} stack;

static stack stack_of(bw_context *context, bw_mesh *mesh) {
  stack s = {.mesh = mesh, .material = body_material(context)};
  check_ok(context, bw_model_create(context, s.mesh, s.material, &s.model));
  return s;
}

/* Two unit cubes, one on the other, of different cells; a small one on a plate where `partly`. */
static stack make_stack(bw_context *context, int order, bool partly, double gap) {
  double size = partly ? 0.55 : 1, offset[3] = {partly ? 0.2 : 0, partly ? 0.15 : 0, 1 + gap};
  return stack_of(context, pair(context, body_box(context, 1, 1, 1, 3, 2, 2, order),
                                body_box(context, size, size, 1, 2, 3, 3, order), offset));
}

static void close_stack(stack *s) {
  bw_release(s->model);
  bw_release(s->material);
  bw_release(s->mesh);
}

static void bond(bw_context *context, stack *s, bool upper_follows, double gap) {
  bw_selection *low = face(context, s->mesh, 0, 2, 1),
               *high = face(context, s->mesh, 1, 2, 1 + gap);
  check_ok(context, bw_model_bond(context, s->model, upper_follows ? high : low,
                                  upper_follows ? low : high, -1));
  bw_release(low);
  bw_release(high);
}

static void slide(bw_context *context, stack *s, int k, double at) {
  bw_selection *on = face(context, s->mesh, -1, k, at);
  check_ok(context, bw_model_slide(context, s->model, on, axis[k]));
  bw_release(on);
}

/* Constant tension and shear, by forces: three planes of symmetry for tension; statically
 * determinate points for shear. */
static void tension_passes(void **state) {
  bw_context *context = check_context(state);
  for (int variant = 0; variant < 4; variant++) {
    stack s = make_stack(context, 1 + variant / 2, false, 0);
    bw_static *result = NULL;
    bond(context, &s, variant % 2, 0);
    for (int k = 0; k < 3; k++)
      slide(context, &s, k, 0);
    bw_selection *top = face(context, s.mesh, 1, 2, 2);
    check_ok(context, bw_model_traction(context, s.model, top, (double[3]){0, 0, 1e6}));
    check_ok(context, bw_joined_statics(context, s.model, NULL, &result));
    double *stress = numbers(6 * (int64_t)s.mesh->element_count);
    check_ok(context, bw_static_stress(context, result, false, stress));
    for (int64_t i = 0; i < 6 * (int64_t)s.mesh->element_count; i++)
      check_near(stress[i], i % 6 == 2 ? 1e6 : 0, 1e-8 * 1e6);
    for (int32_t i = 0; i < s.mesh->node_count; i++)
      for (int k = 0; k < 3; k++)
        check_near(result->displacement[3 * i + k],
                   s.mesh->node[3 * i + k] * (k == 2 ? 1 : -0.3) * 1e6 / 200e9, 1e-8 * 5e-6);
    check_near(fabs(result->bond[0].force[2]), 1e6, 1e-3);
    check_near(fabs(result->bond[0].moment[0]), 5e5, 1e-3);
    double sum = 0;
    for (int32_t i = 0; i < s.mesh->node_count; i++)
      sum += result->reaction[3 * i + 2];
    check_near(sum, -1e6, 1e-3);
    free(stress);
    bw_release(top);
    bw_release(result);
    close_stack(&s);
  }
}

/* Forces of a constant stress with shear on the whole boundary; the lowest face is held where the
 * linear field says. Side a is covered in full. */
static void any_constant_stress_passes(void **state) {
  bw_context *context = check_context(state);
  const double gradient[9] = {1e-6, 4e-6, -2e-6, 3e-6, -5e-6, 1e-6, 2e-6, -3e-6, 6e-6};
  for (int variant = 0; variant < 4; variant++) {
    stack s = make_stack(context, 1 + variant / 2, false, 0);
    const double *g = gradient;
    double strain[6] = {g[0], g[4], g[8], g[5] + g[7], g[2] + g[6], g[1] + g[3]}, t[6] = {0};
    for (int i = 0; i < 36; i++)
      t[i / 6] += s.material->elasticity[i] * strain[i % 6];
    const double full[3][3] = {{t[0], t[5], t[4]}, {t[5], t[1], t[3]}, {t[4], t[3], t[2]}};
    bond(context, &s, variant % 2, 0);
    for (int k = 0; k < 3; k++)
      for (int side = k == 2; side < 2; side++) {
        bw_selection *on = face(context, s.mesh, -1, k, side ? k == 2 ? 2 : 1 : 0);
        double traction[3];
        for (int c = 0; c < 3; c++)
          traction[c] = (side ? 1 : -1) * full[k][c];
        check_ok(context, bw_model_traction(context, s.model, on, traction));
        bw_release(on);
      }
    bw_selection *bottom = face(context, s.mesh, 0, 2, 0);
    bw_array *field = NULL;
    check_ok(context, bw_array_create(context, BW_F64, s.mesh->node_count, 3, &field));
    double *u = field->data;
    for (int32_t i = 0; i < s.mesh->node_count; i++)
      for (int k = 0; k < 3; k++)
        u[3 * i + k] = bw_dot(g + 3 * k, s.mesh->node + 3 * (int64_t)i);
    check_ok(context, bw_model_prescribe_field(context, s.model, bottom,
                                               (const bool[3]){true, true, true}, field));
    bw_static *result = NULL;
    check_ok(context, bw_joined_statics(context, s.model, NULL, &result));
    for (int64_t i = 0; i < 3 * (int64_t)s.mesh->node_count; i++)
      check_near(result->displacement[i], u[i], 1e-8 * 1e-5);
    bw_release(result);
    bw_release(field);
    bw_release(bottom);
    close_stack(&s);
  }
}

/* A small cube on a plate: the side that is covered in full follows. Force and moment pass. */
static void forces_pass_where_a_part_is_covered(void **state) {
  bw_context *context = check_context(state);
  for (int order = 1; order <= 2; order++) {
    stack s = make_stack(context, order, true, 0);
    bw_static *result = NULL;
    bond(context, &s, true, 0);
    check_near(s.model->bond[0].area, 0.55 * 0.55, 1e-12);
    bw_selection *top = face(context, s.mesh, 1, 2, 2), *bottom = face(context, s.mesh, 0, 2, 0);
    check_ok(context, bw_model_fix(context, s.model, bottom));
    check_ok(context, bw_model_force(context, s.model, top, (double[3]){300, -200, 100}));
    check_ok(context, bw_joined_statics(context, s.model, NULL, &result));
    double sum[3] = {0}, moment[3] = {0}, expected[3];
    const double centre[3] = {0.2 + 0.275, 0.15 + 0.275, 2}, load[3] = {300, -200, 100};
    for (int32_t i = 0; i < s.mesh->node_count; i++) {
      double m[3];
      bw_cross(s.mesh->node + 3 * i, result->reaction + 3 * i, m);
      for (int k = 0; k < 3; k++) {
        sum[k] += result->reaction[3 * i + k];
        moment[k] += m[k];
      }
    }
    bw_cross(centre, load, expected);
    for (int k = 0; k < 3; k++) {
      check_near(sum[k], -load[k], 1e-6);
      check_near(moment[k], -expected[k], 1e-6);
      check_near(result->bond[0].force[k], -load[k], 1e-6);
      check_near(result->bond[0].moment[k], -expected[k], 1e-6);
    }
    bw_release(result);
    bw_release(top);
    bw_release(bottom);
    close_stack(&s);
  }
}

/* Cells that match: the modes of one mesh, free and held. */
static void modes_are_those_of_one_body(void **state) {
  bw_context *context = check_context(state);
  for (int held = 0; held < 2; held++) {
    bw_mesh *whole = body_box(context, 1, 1, 4, 2, 2, 8, 2);
    bw_mesh *halves = pair(context, body_box(context, 1, 1, 2, 2, 2, 4, 2),
                           body_box(context, 1, 1, 2, 2, 2, 4, 2), (double[3]){0, 0, 2});
    bw_material *material = body_material(context);
    bw_model *one = NULL, *two = NULL;
    bw_modes *expected = NULL, *modes = NULL;
    bw_modes_options options;
    bw_modes_options_default(&options);
    options.count = 5;
    check_ok(context, bw_model_create(context, whole, material, &one));
    check_ok(context, bw_model_create(context, halves, material, &two));
    bw_selection *low = face(context, halves, 0, 2, 2), *high = face(context, halves, 1, 2, 2);
    check_ok(context, bw_model_bond(context, two, low, high, -1));
    if (held) {
      bw_selection *a = face(context, whole, -1, 2, 0), *b = face(context, halves, -1, 2, 0);
      check_ok(context, bw_model_fix(context, one, a));
      check_ok(context, bw_model_fix(context, two, b));
      bw_release(a);
      bw_release(b);
    }
    check_ok(context, bw_modes_of_model(context, one, NULL, &options, NULL, &expected));
    check_ok(context, bw_joined_modes(context, two, &options, &modes));
    assert_int_equal(modes->count, 5);
    assert_int_equal(modes->rigid_count, held ? 0 : 6);
    assert_true(modes->counted);
    for (int k = 0; k < 5; k++)
      check_near(modes->frequency[k], expected->frequency[k], 1e-7 * expected->frequency[k]);
    bw_release(expected);
    bw_release(modes);
    bw_release(low);
    bw_release(high);
    bw_release(one);
    bw_release(two);
    bw_release(material);
    bw_release(whole);
    bw_release(halves);
  }
}

static void refuses(void **state) {
  bw_context *context = check_context(state);
  stack s = make_stack(context, 2, true, 0.2);
  bw_dof_map *dof_map = NULL;
  bw_static *result = NULL;
  bw_selection *low = face(context, s.mesh, 0, 2, 1), *high = face(context, s.mesh, 1, 2, 1.2),
               *top = face(context, s.mesh, 1, 2, 2.2);
  check_fails(context, BW_GEOMETRY, "0.2 m apart", bw_model_bond(context, s.model, low, high, -1));
  check_fails(context, BW_INVALID, "both sides", bw_model_bond(context, s.model, low, low, -1));
  check_ok(context, bw_model_bond(context, s.model, high, low, 0.21));
  check_near(s.model->bond[0].gap, 0.2, 1e-9);
  check_fails(context, BW_UNSUPPORTED, "1 bond", bw_dof_map_create(context, s.model, &dof_map));
  check_fails(context, BW_UNCONSTRAINED, "6 rigid-body modes",
              bw_joined_statics(context, s.model, NULL, &result));
  check_ok(context, bw_model_bond(context, s.model, high, low, 0.21));
  check_fails(context, BW_INVALID, "two bonds", bw_joined_statics(context, s.model, NULL, &result));
  bw_model_clear_bonds(s.model);
  check_ok(context, bw_model_bond(context, s.model, high, low, 0.21));
  check_fails(context, BW_GEOMETRY, "hardly covered",
              bw_model_bond(context, s.model, low, high, 0.21));
  bw_release(low);
  bw_release(high);
  bw_release(top);
  close_stack(&s);
  s = make_stack(context, 2, false, 0);
  bond(context, &s, true, 0);
  bond(context, &s, false, 0);
  check_fails(context, BW_INVALID, "other way round",
              bw_joined_statics(context, s.model, NULL, &result));
  close_stack(&s);
}

/* With each allocation failing in turn: thousands of runs, so of the least mesh that does not
 * match. */
static void memory_failures(void **state) {
  bw_context *context = check_context(state);
  stack s = stack_of(context, pair(context, body_box(context, 1, 1, 1, 1, 1, 1, 1),
                                   body_box(context, 1, 1, 1, 2, 1, 1, 1), (double[3]){0, 0, 1}));
  bw_selection *low = face(context, s.mesh, 0, 2, 1), *high = face(context, s.mesh, 1, 2, 1);
  bw_static *result = NULL;
  bw_modes *modes = NULL;
  bw_buckling *buckling = NULL;
  bw_buckling_options options;
  bw_buckling_options_default(&options);
  options.count = 1;
  for (int64_t n = 1;; n++) {
    bw_fail_allocation(n, true);
    bw_status status = bw_model_bond(context, s.model, high, low, -1);
    bw_fail_allocation(0, false);
    if (status == BW_OK)
      break;
    assert_int_equal(status, BW_MEMORY);
    bw_clear_failure(context);
  }
  for (int k = 0; k < 3; k++)
    slide(context, &s, k, 0);
  check_ok(context, bw_model_traction(context, s.model, high, (double[3]){0, 0, 1}));
  check_allocations(context, result, bw_joined_statics(context, s.model, NULL, &result));
  check_allocations(context, modes, bw_joined_modes(context, s.model, NULL, &modes));
  check_ok(context, bw_joined_statics(context, s.model, NULL, &result));
  check_allocations(context, buckling, bw_joined_buckling(context, result, &options, &buckling));
  bw_release(result);
  bw_release(low);
  bw_release(high);
  close_stack(&s);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      check_test(tension_passes),
      check_test(any_constant_stress_passes),
      check_test(forces_pass_where_a_part_is_covered),
      check_test(modes_are_those_of_one_body),
      check_test(refuses),
      check_test(memory_failures),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
