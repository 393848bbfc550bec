/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* The drop test: where bodies are hit and how hard, that the neck of a dumbbell suffers most, and
 * that nothing depends on threads. */
#include "bodies.h"
#include "body_system.h"

static bw_system *free_system(bw_context *context, bw_mesh *mesh, double density, double strength) {
  bw_isotropic constants = {"test", 2e9, 0.3, density, strength, 0, 0};
  bw_material *material = NULL;
  bw_dof_map *dof_map = NULL;
  bw_system *system = NULL;
  check_ok(context, bw_material_isotropic(context, &constants, &material));
  check_ok(context, bw_dof_map_unconstrained(context, mesh, &dof_map));
  check_ok(context, body_system(context, mesh, material, dof_map, NULL, &system));
  bw_release(material);
  bw_release(dof_map);
  bw_release(mesh);
  return system;
}

/* A ball is always hit on its surface, and, all normals passing through its middle, with its whole
 * mass: force 2 m v_e / duration with v_e the speed along the normal. */
static void a_ball(void *data, const double unit[3], double out[3]) {
  double largest = 0, length = 0;
  (void)data;
  for (int k = 0; k < 3; k++) {
    out[k] = 2 * unit[k] - 1;
    largest = fmax(largest, fabs(out[k]));
    length += out[k] * out[k];
  }
  for (int k = 0; k < 3 && length > 0; k++)
    out[k] *= largest / sqrt(length);
}

static void ball_is_hit_with_its_whole_mass(void **state) {
  bw_context *context = check_context(state);
  bw_mesh *mesh = NULL;
  const int cells[3] = {10, 10, 10};
  check_ok(context, bw_mesh_mapped_box(context, cells, 1, a_ball, NULL, &mesh));
  bw_system *system = free_system(context, mesh, 1000, 0);
  mesh = (bw_mesh *)system->mesh;
  bw_drop_test_options options;
  bw_drop_test_options_default(&options);
  options.drops = 40;
  options.peg_radius = 1e-3; /* a thin peg: the lateral distance is the angle of incidence */
  bw_drop_test_result result;
  check_ok(context, bw_drop_test(context, system, &options, &result));
  double mass = 1000 * bw_mesh_volume(mesh), speed = sqrt(2 * 9.80665), hardest = 0;
  for (int i = 0; i < 40; i++) {
    check_near(bw_norm(result.contact + 3 * i), 1, 0.03);
    assert_true(result.force[i] > 0 && result.force[i] <= 2 * mass * speed / options.duration);
    assert_true(result.peak[i] > 0);
    hardest = fmax(hardest, result.force[i]);
  }
  assert_true(hardest > 0.9 * 2 * mass * speed / options.duration);
  assert_true(result.threshold > 0);
  bw_drop_test_result_clear(&result);
  bw_release(system);
}

static void dumbbell_breaks_at_the_neck(void **state) {
  bw_context *context = check_context(state);
  bw_system *system =
      free_system(context, make_bar(context, dumbbell_profile, 20, 4, 1), 1200, 3e7);
  const bw_mesh *mesh = system->mesh;
  bw_drop_test_options options;
  bw_drop_test_options_default(&options);
  options.drops = 200;
  options.peg_radius = 0.02;
  options.duration = 5e-3;
  bw_drop_test_result result, again;
  check_ok(context, bw_drop_test(context, system, &options, &result));
  double neck = 0, neck_volume = 0, rest = 0, rest_volume = 0;
  for (int32_t e = 0; e < mesh->element_count; e++) {
    double x = 0;
    for (int a = 0; a < 4; a++)
      x += mesh->node[3 * mesh->element[4 * e + a]] / 4;
    bool in = fabs(x - 0.4) < 0.06;
    *(in ? &neck : &rest) += mesh->volume[e] * result.exceedance[e];
    *(in ? &neck_volume : &rest_volume) += mesh->volume[e];
    assert_true(result.exceedance[e] >= 0 && result.exceedance[e] <= 1);
  }
  if (getenv("BARWRIGHT_FULL"))
    printf("  exceeded in %.3f of the drops at the neck, %.3f elsewhere\n", neck / neck_volume,
           rest / rest_volume);
  assert_true(neck / neck_volume > 3 * (rest / rest_volume));
  assert_true(result.threshold == 0);
  for (int threads = 1; threads <= 3; threads++) {
    check_ok(context, bw_set_threads(context, threads));
    check_ok(context, bw_drop_test(context, system, &options, &again));
    assert_memory_equal(again.mean_peak, result.mean_peak,
                        (size_t)mesh->element_count * sizeof(double));
    assert_memory_equal(again.contact, result.contact, 600 * sizeof(double));
    bw_drop_test_result_clear(&again);
  }
  options.seed = 1;
  check_ok(context, bw_drop_test(context, system, &options, &again));
  assert_true(again.contact[0] != result.contact[0]);
  bw_drop_test_result_clear(&again);
  bw_drop_test_result_clear(&result);
  bw_release(system);
}

/* The same body in two meshes, one with facets far larger than the contacts: the same drops, the
 * same points, areas and forces. */
static void contact_does_not_depend_on_the_mesh(void **state) {
  bw_context *context = check_context(state);
  enum { DROPS = 60 };
  bw_drop_test_options options;
  bw_drop_test_options_default(&options);
  options.drops = DROPS;
  options.peg_radius = 0.01;
  bw_drop_test_result result[2];
  double difference = 0;
  for (int k = 0; k < 2; k++) {
    int cells = k ? 8 : 2;
    bw_system *system =
        free_system(context, make_box(context, 0.1, 0.06, 0.04, cells, cells, cells, 1), 1000, 1e7);
    check_ok(context, bw_drop_test(context, system, &options, &result[k]));
    bw_release(system);
  }
  for (int i = 0; i < DROPS; i++) {
    for (int c = 0; c < 3; c++)
      check_near(result[1].contact[3 * i + c], result[0].contact[3 * i + c], 1e-12);
    assert_true(result[0].area[i] > 0 && result[0].area[i] < 0.04 * 0.06);
    difference = fmax(difference, fabs(log(result[1].area[i] / result[0].area[i])));
    check_near(result[1].force[i], result[0].force[i], 0.02 * result[0].force[i]);
    for (int k = 0; k < 2; k++) { /* a patch, however coarse the mesh, and nothing sideways */
      assert_true(result[k].nodes[i] >= 3);
      for (int c = 0; c < 3; c++)
        check_near(result[k].resultant[3 * i + c],
                   result[k].force[i] * result[k].direction[3 * i + c], 1e-9 * result[k].force[i]);
    }
  }
  assert_true(difference < 0.1);
  for (int k = 0; k < 2; k++)
    bw_drop_test_result_clear(&result[k]);
}

static void failures(void **state) {
  bw_context *context = check_context(state);
  bw_system *system = free_system(context, make_box(context, 1, 1, 1, 2, 2, 2, 1), 0, 0);
  bw_drop_test_options options;
  bw_drop_test_options_default(&options);
  options.drops = 3;
  bw_drop_test_result result;
  check_fails(context, BW_INVALID, "density", bw_drop_test(context, system, &options, &result));
  bw_release(system);
  system = free_system(context, make_box(context, 1, 1, 1, 2, 2, 2, 1), 1000, 0);
  options.height = 0;
  check_fails(context, BW_INVALID, "height", bw_drop_test(context, system, &options, &result));
  bw_drop_test_options_default(&options);
  options.drops = 0;
  check_fails(context, BW_INVALID, "0 drops", bw_drop_test(context, system, &options, &result));
  options.drops = 3;
  check_ok(context, bw_set_threads(context, 1));
  check_each_allocation(context, status, 10) {
    status = bw_drop_test(context, system, &options, &result);
    if (status == BW_OK)
      bw_drop_test_result_clear(&result);
  }
  bw_release(system);
}

check_main(check_test(ball_is_hit_with_its_whole_mass), check_test(dumbbell_breaks_at_the_neck),
           check_test(contact_does_not_depend_on_the_mesh), check_test(failures))
