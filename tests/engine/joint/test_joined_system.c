/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* The equations of joined models for many loads: symmetric, free of rigid-body motion, those of the
 * static solution; cuts; what is refused. */
#include "pair.h"

#include "barwright/analysis.h"
#include "barwright/joint.h"

typedef struct stack {
  bw_mesh *mesh;
  bw_material *material;
  bw_model *model;
  int64_t size;
} stack;

/* Two unit cubes of different cells, the upper one bonded to the lower one. */
static stack make_stack(bw_context *context, int order) {
  stack s = {0};
  s.mesh = pair(context, body_box(context, 1, 1, 1, 3, 2, 2, order),
                body_box(context, 1, 1, 1, 2, 3, 2, order), (double[3]){0, 0, 1});
  s.material = body_material(context);
  s.size = 3 * (int64_t)s.mesh->node_count;
  check_ok(context, bw_model_create(context, s.mesh, s.material, &s.model));
  bw_selection *low = face(context, s.mesh, 0, 2, 1), *high = face(context, s.mesh, 1, 2, 1);
  check_ok(context, bw_model_bond(context, s.model, high, low, -1));
  bw_release(low);
  bw_release(high);
  return s;
}

static void close_stack(stack *s) {
  bw_release(s->model);
  bw_release(s->material);
  bw_release(s->mesh);
}

static void fix_base(bw_context *context, stack *s) {
  bw_selection *base = face(context, s->mesh, 0, 2, 0);
  check_ok(context, bw_model_fix(context, s->model, base));
  bw_release(base);
}

static double product(int64_t count, const double *a, const double *b) {
  double sum = 0;
  for (int64_t i = 0; i < count; i++)
    sum += a[i] * b[i];
  return sum;
}

/* f . S g = g . S f; several at once as one by one, also in place. */
static void the_solution_is_symmetric(void **state) {
  bw_context *context = check_context(state);
  for (int order = 1; order <= 2; order++)
    for (int held = 0; held < 2; held++) {
      stack s = make_stack(context, order);
      bw_system *system = NULL;
      double *f = numbers(2 * s.size), *u = numbers(2 * s.size), *one = numbers(s.size);
      if (held)
        fix_base(context, &s);
      check_ok(context, bw_joined_system(context, s.model, NULL, &system));
      assert_int_equal(system->dof_map->rigid_mode_count, held ? 0 : 6);
      random_field(3, 2 * s.size, f);
      check_ok(context, bw_system_solve(context, system, 2, f, u));
      double a = product(s.size, f, u + s.size), b = product(s.size, f + s.size, u);
      double size = sqrt(product(s.size, f, u) * product(s.size, f + s.size, u + s.size));
      check_near(a, b, 1e-10 * size);
      double largest = 0;
      check_ok(context, bw_system_solve(context, system, 1, f + s.size, one));
      for (int64_t i = 0; i < s.size; i++)
        largest = fmax(largest, fabs(one[i]));
      for (int64_t i = 0; i < s.size; i++)
        check_near(one[i], u[s.size + i], 1e-12 * largest);
      check_ok(context, bw_system_solve(context, system, 2, f, f));
      for (int64_t i = 0; i < 2 * s.size; i++)
        assert_true(f[i] == u[i]);
      free(f);
      free(u);
      free(one);
      bw_release(system);
      close_stack(&s);
    }
}

/* A load of the top: the static solution of the held body, at nodes of both. */
static void it_is_the_static_solution(void **state) {
  bw_context *context = check_context(state);
  stack s = make_stack(context, 2);
  bw_selection *top = face(context, s.mesh, 1, 2, 2);
  bw_static *result = NULL;
  bw_system *system = NULL;
  double *u = numbers(s.size), largest = 0;
  fix_base(context, &s);
  check_ok(context, bw_model_traction(context, s.model, top, (double[3]){1e6, 2e6, -3e6}));
  check_ok(context, bw_joined_statics(context, s.model, NULL, &result));
  check_ok(context, bw_joined_system(context, s.model, NULL, &system));
  check_ok(context, bw_system_solve(context, system, 1, result->force, u));
  for (int64_t i = 0; i < s.size; i++)
    largest = fmax(largest, fabs(u[i]));
  for (int64_t i = 0; i < s.size; i++)
    check_near(result->displacement[i], u[i], 1e-9 * largest);
  free(u);
  bw_release(top);
  bw_release(result);
  bw_release(system);
  close_stack(&s);
}

/* Opposite tractions at both ends of the free stack, along x and y so that they turn nothing: the
 * stress is that of the traction, across a bond of faces that do not match; the mean motion of the
 * volume is 0. */
static void a_free_stack_in_tension(void **state) {
  bw_context *context = check_context(state);
  stack s = make_stack(context, 2);
  bw_selection *base = face(context, s.mesh, 0, 2, 0), *top = face(context, s.mesh, 1, 2, 2);
  bw_system *system = NULL;
  const double pull = 1e6;
  double *f = numbers(s.size), *u = numbers(s.size),
         *stress = numbers(6 * (int64_t)s.mesh->element_count), mean[3] = {0};
  check_ok(context, bw_model_traction(context, s.model, base, (double[3]){0, 0, -pull}));
  check_ok(context, bw_model_traction(context, s.model, top, (double[3]){0, 0, pull}));
  check_ok(context, bw_model_force_vector(context, s.model, f));
  check_ok(context, bw_joined_system(context, s.model, NULL, &system));
  check_ok(context, bw_system_solve(context, system, 1, f, u));
  check_ok(context, bw_element_stress(context, s.mesh, s.material, u, stress));
  for (int32_t e = 0; e < s.mesh->element_count; e++)
    for (int k = 0; k < 6; k++)
      check_near(k == 2 ? pull : 0, stress[6 * e + k], 1e-7 * pull);
  for (int32_t e = 0; e < s.mesh->element_count; e++) { /* straight: weights -1/20 and 1/5 */
    const int32_t *node = s.mesh->element + 10 * (int64_t)e;
    for (int a = 0; a < 10; a++)
      for (int k = 0; k < 3; k++)
        mean[k] += s.mesh->volume[e] * (a < 4 ? -0.05 : 0.2) * u[3 * (int64_t)node[a] + k];
  }
  for (int k = 0; k < 3; k++)
    check_near(0, mean[k], 1e-10 * pull / 2e11);
  free(f);
  free(u);
  free(stress);
  bw_release(base);
  bw_release(top);
  bw_release(system);
  close_stack(&s);
}

/* Both sides of a bond and a plane of symmetry; nothing of a plain model. */
static void cuts(void **state) {
  bw_context *context = check_context(state);
  stack s = make_stack(context, 1);
  bw_selection *on = NULL, *side = face(context, s.mesh, 0, 0, 0);
  bw_model *plain = NULL;
  check_ok(context, bw_model_cuts(context, s.model, &on));
  check_near(2, bw_selection_area(on), 1e-12);
  bw_release(on);
  check_ok(context, bw_model_symmetry(context, s.model, side, BW_SYMMETRIC));
  check_ok(context, bw_model_cuts(context, s.model, &on));
  check_near(3, bw_selection_area(on), 1e-12);
  bw_release(on);
  check_ok(context, bw_model_create(context, s.mesh, s.material, &plain));
  check_ok(context, bw_model_cuts(context, plain, &on));
  assert_null(on);
  bw_release(plain);
  bw_release(side);
  close_stack(&s);
}

static void refuses(void **state) {
  bw_context *context = check_context(state);
  stack s = make_stack(context, 1);
  bw_system *system = NULL;
  bw_sparse_matrix *matrix = NULL;
  bw_modes *modes = NULL;
  bw_solver *pcg = NULL;
  bw_model *apart = NULL;
  check_ok(context, bw_solver_create(context, &(bw_solver_options){.kind = BW_SOLVER_PCG}, &pcg));
  check_fails(context, BW_UNSUPPORTED, "solved by a factor",
              bw_joined_system(context, s.model, pcg, &system));
  check_ok(context, bw_model_create(context, s.mesh, s.material, &apart));
  check_fails(context, BW_UNCONSTRAINED, "move against one another",
              bw_joined_system(context, apart, NULL, &system));
  check_ok(context, bw_joined_system(context, s.model, NULL, &system));
  check_fails(context, BW_UNSUPPORTED, "joined model",
              bw_system_matrix(context, system, BW_STIFFNESS, false, &matrix));
  check_fails(context, BW_UNSUPPORTED, "joined model", bw_system_factor(context, system));
  check_fails(context, BW_UNSUPPORTED, "joined model", bw_system_stiffness(context, system));
  check_fails(context, BW_UNSUPPORTED, "joined model",
              bw_modes_elastic(context, system, NULL, &modes));
  bw_release(system);
  system = NULL;
  bw_selection *base = face(context, s.mesh, 0, 2, 0);
  const bool fixed[3] = {true, true, true};
  const double moved[3] = {0, 0, 1e-3};
  check_ok(context, bw_model_prescribe(context, s.model, base, fixed, moved));
  check_fails(context, BW_UNSUPPORTED, "a support prescribes a displacement",
              bw_joined_system(context, s.model, NULL, &system));
  bw_release(base);
  bw_release(pcg);
  bw_release(apart);
  close_stack(&s);
}

/* With each allocation failing in turn. */
static void memory_failures(void **state) {
  bw_context *context = check_context(state);
  stack s = make_stack(context, 1);
  bw_system *system = NULL;
  bw_selection *on = NULL;
  check_allocations(context, system, bw_joined_system(context, s.model, NULL, &system));
  check_allocations(context, on, bw_model_cuts(context, s.model, &on));
  close_stack(&s);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      check_test(the_solution_is_symmetric),
      check_test(it_is_the_static_solution),
      check_test(a_free_stack_in_tension),
      check_test(cuts),
      check_test(refuses),
      check_test(memory_failures),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
