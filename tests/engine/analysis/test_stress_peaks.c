/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* The largest stresses of many fields at once, against each field by itself. */
#include "../bodies.h"

#include "barwright/analysis.h"

#include "analysis/stress_peaks.h"

enum { FIELDS = BWI_PEAK_FIELDS };

static void bent(void *data, const double unit[3], double out[3]) {
  (void)data;
  out[0] = 3 * unit[0];
  out[1] = unit[1] + 0.3 * unit[0] * unit[0];
  out[2] = unit[2] + 0.2 * unit[0] * unit[1];
}

/* Straight elements of both orders, and curved ones. */
static bw_mesh *mesh_of(bw_context *context, int kind) {
  const int cells[3] = {7, 6, 5};
  bw_mesh *mesh = NULL;
  if (kind < 2)
    return body_box(context, 3, 1, 1, 7, 6, 5, kind + 1);
  check_ok(context, bw_mesh_mapped_box(context, cells, 2, bent, NULL, &mesh));
  return mesh;
}

/* Of one strength, of three, in the B-bar formulation and nearly incompressible, and of elements
 * of the first two and of one without strength. */
static bw_material *material_of(bw_context *context, const bw_mesh *mesh, int kind) {
  const bw_orthotropic layered = {.name = "layered",
                                  .young = {3e9, 2e9, 1e9},
                                  .poisson = {0.3, 0.3, 0.3},
                                  .shear = {8e8, 7e8, 9e8},
                                  .strength = {5e7, 2e7, 4e7},
                                  .density = 1000};
  bw_material *material = NULL, *part[3] = {NULL};
  const bw_isotropic weak = {.name = "unknown", .young = 1e9, .poisson = 0.495, .density = 1000};
  int32_t *of_element = malloc((size_t)mesh->element_count * sizeof *of_element);
  for (int32_t e = 0; e < mesh->element_count; e++)
    of_element[e] = e * 7 % 3;
  check_ok(context, bw_material_named(context, "pla", &part[0]));
  check_ok(context, bw_material_orthotropic(context, &layered, &part[1]));
  check_ok(context, bw_material_isotropic(context, &weak, &part[2]));
  if (kind < 2)
    material = bw_retain(part[kind]);
  else if (kind == 2)
    check_ok(context, bw_material_formulated(context, part[2], BW_B_BAR, &material));
  else
    check_ok(context, bw_material_by_element(context, mesh->element_count, 3, of_element,
                                             (const bw_material *const *)part, &material));
  for (int i = 0; i < 3; i++)
    bw_release(part[i]);
  free(of_element);
  return material;
}

static void compare(bw_context *context, const bw_mesh *mesh, const bw_material *material) {
  int64_t size = 3 * (int64_t)mesh->node_count, elements = mesh->element_count;
  double *u = numbers(FIELDS * size), *one = numbers(size), *tensor = numbers(6 * elements);
  double *value = numbers(elements), *share = numbers(elements);
  double *stress = numbers(elements), *utilisation = numbers(elements);
  double *most = numbers(elements), *used = numbers(elements);
  for (int64_t e = 0; e < elements; e++)
    stress[e] = utilisation[e] = most[e] = used[e] = 0;
  for (int round = 0; round < 3; round++) {
    int fields = round == 2 ? 5 : FIELDS; /* the others are 0 */
    double largest[FIELDS];
    int32_t where[FIELDS];
    random_field(7 + (uint64_t)round, FIELDS * size, u);
    for (int64_t i = 0; i < size; i++) /* of other sizes, and one that stretches */
      for (int f = 0; f < FIELDS; f++)
        u[i * FIELDS + f] = f >= fields ? 0
                            : f == 3    ? 4 * mesh->node[i]
                                        : u[i * FIELDS + f] * exp(0.05 * f * cos(9. * round));
    check_ok(context,
             bwi_stress_peaks(context, mesh, material, u, stress, utilisation, largest, where));
    for (int f = 0; f < FIELDS; f++) {
      double highest = 0;
      for (int64_t i = 0; i < size; i++)
        one[i] = u[i * FIELDS + f];
      check_ok(context, bw_element_stress(context, mesh, material, one, tensor));
      check_ok(context, bw_max_principal_field(context, elements, tensor, value));
      check_ok(context, bw_utilisation_field(context, material, elements, tensor, share));
      for (int64_t e = 0; e < elements; e++) {
        most[e] = fmax(most[e], value[e]);
        used[e] = fmax(used[e], share[e]);
        highest = fmax(highest, value[e]);
      }
      check_near(largest[f], highest, 1e-12 * highest);
      check_near(value[where[f]], highest, 1e-12 * highest);
    }
    for (int64_t e = 0; e < elements; e++) {
      check_near(stress[e], most[e], 1e-12 * most[e]);
      check_near(utilisation[e], used[e], 1e-12 * used[e]);
    }
  }
  free(u), free(one), free(tensor), free(value), free(share);
  free(stress), free(utilisation), free(most), free(used);
}

static void test_each_field(void **state) {
  bw_context *context = check_context(state);
  for (int i = 0; i < 12; i++) {
    bw_mesh *mesh = mesh_of(context, i / 4);
    bw_material *material = material_of(context, mesh, i % 4);
    compare(context, mesh, material);
    bw_release(material);
    bw_release(mesh);
  }
}

/* The same bits on any number of threads, and without utilisation. */
static void test_threads(void **state) {
  bw_context *context = check_context(state);
  bw_mesh *mesh = mesh_of(context, 2);
  bw_material *material = material_of(context, mesh, 3);
  int64_t size = 3 * (int64_t)mesh->node_count, elements = mesh->element_count;
  double *u = numbers(FIELDS * size), *stress[2] = {numbers(elements), numbers(elements)};
  double *utilisation = numbers(elements), largest[2][FIELDS];
  int32_t where[2][FIELDS];
  random_field(3, FIELDS * size, u);
  for (int i = 0; i < 2; i++) {
    for (int64_t e = 0; e < elements; e++)
      stress[i][e] = utilisation[e] = 0;
    check_ok(context, bw_set_threads(context, i == 0 ? 1 : 5));
    check_ok(context, bwi_stress_peaks(context, mesh, material, u, stress[i],
                                       i == 0 ? NULL : utilisation, largest[i], where[i]));
  }
  assert_memory_equal(stress[0], stress[1], (size_t)elements * sizeof(double));
  assert_memory_equal(largest[0], largest[1], sizeof largest[0]);
  assert_memory_equal(where[0], where[1], sizeof where[0]);
  free(u), free(stress[0]), free(stress[1]), free(utilisation);
  bw_release(material);
  bw_release(mesh);
}

int main(void) {
  const struct CMUnitTest tests[] = {check_test(test_each_field), check_test(test_threads)};
  return cmocka_run_group_tests_name("stress peaks", tests, NULL, NULL);
}
