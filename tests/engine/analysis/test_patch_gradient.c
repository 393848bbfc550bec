/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* The shape gradient of a patch's mean stress: against central differences of its parts, computed
 * by other functions on moved meshes; motions of the boundary carried into the body. */
#include "bodies.h"

#include <math.h>

static const double slope[6] = {0.9, 0.2, -0.1, 0.3, -0.2, 0.4};
static const double price = 0.7;

static double *numbers(const bw_mesh *mesh, int columns) {
  double *block = (double *)calloc((size_t)mesh->node_count * (size_t)columns, sizeof *block);
  assert_non_null(block);
  return block;
}

static bw_material *make_material(bw_context *context) {
  const bw_isotropic constants = {.name = "test", .young = 1, .poisson = 0.33, .density = 1};
  bw_material *material = NULL;
  check_ok(context, bw_material_isotropic(context, &constants, &material));
  return material;
}

static int boundary_node_near(const bw_mesh *mesh, double x, double y, double z) {
  int best = -1;
  double min = INFINITY;
  for (int32_t k = 0; k < mesh->boundary_node_count; k++) {
    const double *p = mesh->node + 3 * (size_t)mesh->boundary_node[k];
    double d = hypot(hypot(p[0] - x, p[1] - y), p[2] - z);
    if (d < min)
      min = d, best = mesh->boundary_node[k];
  }
  return best;
}

static double dot(const double *a, const double *b, size_t count) {
  double sum = 0;
  for (size_t i = 0; i < count; i++)
    sum += a[i] * b[i];
  return sum;
}

/* slope . m + lambda . (G p - K u) - price * integral of p, by the functions that define them */
static double lagrangian(bw_context *context, const bw_mesh *mesh, const bw_material *material,
                         const bw_patch_state *s, double spacing) {
  const bw_pressure_options options = {.spacing = spacing};
  double *stress = (double *)malloc(18 * (size_t)mesh->facet_count * sizeof *stress),
         *mean = numbers(mesh, 6), *force = numbers(mesh, 3);
  size_t size = 3 * (size_t)mesh->node_count;
  bw_pressure_basis *basis = NULL;
  check_ok(context, bw_internal_force(context, mesh, material, s->displacement, force));
  double value = -dot(force, s->adjoint, size);
  check_ok(context, bw_pressure_basis_create(context, mesh, &options, &basis));
  for (int32_t j = 0; j < basis->count; j++)
    value -= s->price * s->pressure[j] * basis->area[j];
  bw_pressure_force(basis, s->pressure, force);
  value += dot(force, s->adjoint, size);
  check_ok(context, bw_surface_stress(context, mesh, material, s->displacement, force, stress));
  check_ok(context, bw_surface_mean(context, mesh, s->dof_map, s->radius, 6, stress, mean));
  value += dot(s->slope, mean + 6 * (size_t)s->node, 6);
  bw_release(basis);
  free(stress), free(mean), free(force);
  return value;
}

static bw_mesh *moved(bw_context *context, const bw_mesh *mesh, const double *motion, double size) {
  double *x = numbers(mesh, 3);
  bw_mesh *out = NULL;
  for (size_t i = 0; i < 3 * (size_t)mesh->node_count; i++)
    x[i] = mesh->node[i] + size * motion[i];
  check_ok(context, bw_mesh_moved(context, mesh, x, &out));
  free(x);
  return out;
}

/* Nodal values of u, lambda and p are smooth and arbitrary: nothing is in equilibrium. */
static void check_gradient(bw_context *context, int order, bool curved, double spacing,
                           double radius) {
  const bw_pressure_options options = {.spacing = spacing};
  bw_pressure_basis *basis = NULL;
  bw_mesh *mesh = make_bar(context, curved ? dumbbell_profile : straight_profile, 10, 2, order);
  bw_material *material = make_material(context);
  double *u = numbers(mesh, 3), *adjoint = numbers(mesh, 3), *motion = numbers(mesh, 3),
         *gradient = numbers(mesh, 3);
  if (curved) {
    for (size_t i = 0; i < (size_t)mesh->node_count; i++)
      motion[3 * i + 1] = sin(40 * mesh->node[3 * i]) * sin(50 * mesh->node[3 * i + 1]);
    bw_mesh *straight = mesh;
    mesh = moved(context, straight, motion, 2e-3);
    bw_release(straight);
  }
  for (size_t i = 0; i < (size_t)mesh->node_count; i++) {
    const double *x = mesh->node + 3 * i;
    for (int c = 0; c < 3; c++) {
      u[3 * i + (size_t)c] = sin(3 * x[0] + 5 * x[1] + c) + x[2] * x[0];
      adjoint[3 * i + (size_t)c] = cos(4 * x[0] - 3 * x[2] + 2 * c);
      motion[3 * i + (size_t)c] = sin(7 * x[0] + 2 * c) * cos(6 * x[1] - 4 * x[2] + c);
    }
  }
  check_ok(context, bw_pressure_basis_create(context, mesh, &options, &basis));
  double *pressure = (double *)malloc((size_t)basis->count * sizeof *pressure);
  for (int32_t j = 0; j < basis->count; j++) {
    const double *x = mesh->node + 3 * (size_t)basis->node[j];
    pressure[j] = 1 + sin(9 * x[0] + j % 3) * cos(5 * x[1]);
  }
  bw_patch_state state = {.node = boundary_node_near(mesh, 0.42, 0.02, 0.06),
                          .radius = radius,
                          .displacement = u,
                          .adjoint = adjoint,
                          .basis = basis,
                          .pressure = pressure,
                          .price = price};
  memcpy(state.slope, slope, sizeof slope);
  double value, step = 1e-6, part[2];
  check_ok(context, bw_patch_shape_gradient(context, mesh, material, &state, &value, gradient));
  for (int k = 0; k < 2; k++) {
    bw_mesh *other = moved(context, mesh, motion, k ? -step : step);
    part[k] = lagrangian(context, other, material, &state, spacing);
    bw_release(other);
  }
  double change = dot(gradient, motion, 3 * (size_t)mesh->node_count);
  check_near(change / ((part[0] - part[1]) / (2 * step)), 1, 2e-6);

  /* The functionals are the derivatives of the value, which is linear in u and G p. */
  double *force = numbers(mesh, 3), *by_force = numbers(mesh, 3), *load = numbers(mesh, 3);
  size_t size = 3 * (size_t)mesh->node_count;
  check_ok(context, bw_patch_functional(context, mesh, material, NULL, radius, state.node, slope,
                                        force, by_force));
  bw_pressure_force(basis, pressure, load);
  assert_true(fabs(dot(by_force, load, size)) > 0.01 * fabs(value));
  check_near((dot(force, u, size) + dot(by_force, load, size)) / value, 1, 1e-10);
  free(by_force), free(load);
  free(force), free(u), free(adjoint), free(pressure), free(motion), free(gradient);
  bw_release(basis);
  bw_release(material);
  bw_release(mesh);
}

static void test_differences(void **state) {
  bw_context *context = check_context(state);
  for (int cells = 0; cells < 2; cells++) {
    check_gradient(context, 1, false, cells * 0.0213, 0.08);
    check_gradient(context, 2, false, cells * 0.0213, 0.08);
    check_gradient(context, 2, true, cells * 0.0213, 0.08);
    check_gradient(context, 2, true, cells * 0.0213, 1e-4); /* the mesh is coarser */
  }
}

static void test_boundary_motions(void **state) {
  bw_context *context = check_context(state);
  bw_mesh *mesh = make_bar(context, straight_profile, 8, 4, 2);
  double *motion = numbers(mesh, 3), *covector = numbers(mesh, 3), *other = numbers(mesh, 3);
  size_t size = 3 * (size_t)mesh->node_count;
  for (size_t i = 0; i < size; i++) {
    motion[i] = 1 + 0.5 * sin((double)(7 * i));
    covector[i] = cos((double)(3 * i));
    other[i] = covector[i];
  }
  double *given = numbers(mesh, 3);
  memcpy(given, motion, size * sizeof *given);
  check_ok(context, bw_boundary_extend(context, mesh, motion));
  check_ok(context, bw_boundary_gather(context, mesh, other));
  check_near(dot(covector, motion, size) / dot(other, given, size), 1, 1e-12);
  for (int32_t i = 0, k = 0; i < mesh->node_count; i++) {
    bool boundary = k < mesh->boundary_node_count && mesh->boundary_node[k] == i;
    k += boundary;
    for (size_t c = 0; c < 3; c++) {
      double value = motion[3 * (size_t)i + c];
      if (boundary)
        assert_true(value == given[3 * (size_t)i + c]);
      else
        assert_true(value > 0.3 && value < 1.5 && other[3 * (size_t)i + c] == 0);
    }
  }
  free(motion), free(covector), free(other), free(given);
  bw_release(mesh);
}

/* A node at the border of a support, on a mesh that is coarser than the radius: the facets of the
 * support do not count. */
static void test_support_border(void **state) {
  bw_context *context = check_context(state);
  const bw_pressure_options options = {.spacing = 0};
  bw_mesh *mesh = make_bar(context, straight_profile, 10, 2, 2);
  bw_material *material = make_material(context);
  bw_model *model = NULL;
  bw_selection *root = NULL;
  bw_dof_map *dof_map = NULL;
  bw_pressure_basis *basis = NULL;
  check_ok(context, bw_model_create(context, mesh, material, &model));
  check_ok(context,
           bw_select_half_space(context, mesh, mesh->node, (double[3]){1, 0, 0}, 1e-9, &root));
  check_ok(context, bw_model_fix(context, model, root));
  check_ok(context, bw_dof_map_create(context, model, &dof_map));
  check_ok(context, bw_pressure_basis_create(context, mesh, &options, &basis));
  double *u = numbers(mesh, 3), *gradient = numbers(mesh, 3), *zero = numbers(mesh, 3);
  double *pressure = (double *)calloc((size_t)basis->count, sizeof *pressure), value;
  for (size_t i = 0; i < 3 * (size_t)mesh->node_count; i++)
    u[i] = sin(5 * mesh->node[i]);
  int outside = 0;
  for (int32_t k = 0; k < root->node_count; k++) {
    bw_patch_state patch = {.node = root->node[k],
                            .dof_map = dof_map,
                            .radius = 1e-4,
                            .displacement = u,
                            .adjoint = zero,
                            .basis = basis,
                            .pressure = pressure};
    memcpy(patch.slope, slope, sizeof slope);
    bw_status status = bw_patch_shape_gradient(context, mesh, material, &patch, &value, gradient);
    assert_true(status == BW_OK || status == BW_INVALID); /* at a border, or inside */
    for (size_t i = 0; status == BW_OK && i < 3 * (size_t)mesh->node_count; i++)
      assert_true(isfinite(gradient[i]));
    outside += status == BW_OK;
  }
  assert_true(outside > 0 && outside < root->node_count);
  free(u), free(gradient), free(zero), free(pressure);
  bw_release(basis), bw_release(dof_map), bw_release(root), bw_release(model);
  bw_release(material);
  bw_release(mesh);
}

static void test_wrong_input(void **state) {
  bw_context *context = check_context(state);
  bw_mesh *mesh = make_box(context, 1, 1, 1, 3, 3, 3, 1);
  bw_material *material = make_material(context);
  double *zero = numbers(mesh, 3);
  int32_t inner = -1;
  for (int32_t i = 0; i < mesh->node_count; i++)
    if (fabs(mesh->node[3 * (size_t)i] - 1.0 / 3) < 1e-9 &&
        fabs(mesh->node[3 * (size_t)i + 1] - 1.0 / 3) < 1e-9 &&
        fabs(mesh->node[3 * (size_t)i + 2] - 1.0 / 3) < 1e-9)
      inner = i;
  check_fails(context, BW_INVALID, "not on the boundary",
              bw_patch_functional(context, mesh, material, NULL, 0.08, inner, slope, zero, zero));
  check_fails(context, BW_INVALID, "radius",
              bw_patch_functional(context, mesh, material, NULL, -1, 0, slope, zero, zero));
  free(zero);
  bw_release(material);
  bw_release(mesh);
}

check_main(check_test(test_differences), check_test(test_boundary_motions),
           check_test(test_support_border), check_test(test_wrong_input))
