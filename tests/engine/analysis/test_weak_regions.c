/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* Weak regions of modes made by formula, and the functionals of regions against the integrals that
 * they stand for. */
#include "bodies.h"

static bw_material *orthotropic(bw_context *context) {
  bw_material *material = NULL, *turned = NULL;
  bw_orthotropic constants = {.young = {1.22e9, 0.68e9, 0.234e9}, .poisson = {0.3, 0.05, 0.3}};
  /* About z and then about x, so that no component of C : I vanishes. */
  const double c = cos(0.4), s = sin(0.4), d = cos(1.1), e = sin(1.1);
  const double rotation[9] = {c, -s, 0, d * s, d * c, -e, e * s, e * c, d};
  check_ok(context, bw_material_orthotropic(context, &constants, &material));
  check_ok(context, bw_material_rotated(context, material, rotation, &turned));
  bw_release(material);
  return turned;
}

static bw_material *isotropic(bw_context *context, double young) {
  bw_material *material = NULL;
  bw_isotropic constants = {"test", young, 0.3, 1000, 5e6, 0, 0};
  check_ok(context, bw_material_isotropic(context, &constants, &material));
  return material;
}

/* A mode by formula. */
static bw_modes one_mode(bw_context *context, const bw_mesh *mesh, int components,
                         void (*shape)(const double x[3], double *u)) {
  bw_modes modes = {.mesh = mesh, .count = 1, .components = components};
  modes.shape = BW_NEW(context, double, (size_t)(components * mesh->node_count));
  for (int32_t i = 0; i < mesh->node_count; i++)
    shape(mesh->node + 3 * i, modes.shape + components * i);
  return modes;
}

static void centroid(const bw_mesh *mesh, int32_t e, double c[3]) {
  for (int k = 0; k < 3; k++) {
    c[k] = 0;
    for (int a = 0; a < 4; a++)
      c[k] += mesh->node[3 * mesh->element[e * mesh->nodes_per_element + a] + k] / 4;
  }
}

/* g . u is the weighted integral of the trace of the stress, whatever u, element and material. */
static void functional_is_the_integral(void **state) {
  bw_context *context = check_context(state);
  bw_random random;
  bw_random_seed(&random, 5);
  for (int kind = 0; kind < 4; kind++) {
    bw_mesh *mesh = NULL;
    const int cells[3] = {3, 2, 2};
    check_ok(context, kind < 2 ? bw_mesh_box_grid(context, (double[3]){0, 0, 0},
                                                  (double[3]){1, 2, 3}, cells, 1 + kind, &mesh)
                               : bw_mesh_mapped_box(context, cells, kind - 1, bulge, NULL, &mesh));
    bw_material *material = orthotropic(context);
    size_t n = 3 * (size_t)mesh->node_count, m = (size_t)mesh->element_count;
    double *u = BW_NEW(context, double, n), *g = BW_NEW(context, double, n);
    double *stress = BW_NEW(context, double, 6 * m), by_force = 0, by_stress = 0;
    for (size_t i = 0; i < n; i++)
      u[i] = bw_random_normal(&random);
    bw_weak_regions *regions = NULL;
    const int32_t element[3] = {1, 7, 20};
    check_ok(context, bw_weak_regions_single(context, mesh, 3, element, -1, &regions));
    check_ok(context, bw_element_stress(context, mesh, material, u, stress));
    for (int r = 0; r < 3; r++) {
      check_ok(context, bw_region_objective(context, regions, r, material, g));
      by_force = 0;
      for (size_t i = 0; i < n; i++)
        by_force += g[i] * u[i];
      /* Straight elements: the mean trace, with the sign. Curved ones have a volume of their own.
       */
      const double *s = stress + 6 * element[r];
      by_stress = -(s[0] + s[1] + s[2]);
      check_near(by_force, by_stress, (kind == 3 ? 0.2 : 1e-10) * fabs(by_stress));
    }
    check_fails(context, BW_INVALID, "the regions are 1 to",
                bw_region_objective(context, regions, 3, material, g));
    bw_free(u);
    bw_free(g);
    bw_free(stress);
    bw_release(regions);
    bw_release(material);
    bw_release(mesh);
  }
}

static void square(const double x[3], double *u) {
  u[0] = x[0] * x[0];
  u[1] = u[2] = 0;
}

/* Strain 2 x: the weakest 10 % of a bar are its last tenth, pulled. */
static void stretched_end(void **state) {
  bw_context *context = check_context(state);
  bw_material *material = isotropic(context, 1e9);
  for (int order = 1; order <= 2; order++)
    for (int measure = 0; measure < 2; measure++) {
      bw_mesh *mesh = make_box(context, 1, 0.2, 0.2, 40, 4, 4, order);
      bw_modes modes = one_mode(context, mesh, 3, square);
      bw_weak_options options;
      bw_weak_options_default(&options);
      options.fraction = 0.1;
      options.measure = (bw_weak_measure)measure;
      bw_weak_regions *regions = NULL;
      check_ok(context, bw_weak_regions_find(context, mesh, material, &modes, &options, &regions));
      double weight = 0;
      assert_int_equal(regions->count, 1);
      const bw_weak_region *r = &regions->region[0];
      check_near(r->volume, 0.1 * 0.04, 1e-9);
      for (int32_t i = 0; i < r->count; i++) {
        double c[3];
        centroid(mesh, r->element[i], c);
        assert_true(c[0] > 0.9);
        assert_true(r->weight[i] > 0);
        assert_true(i == 0 || r->element[i] > r->element[i - 1]);
        weight += r->weight[i] * mesh->volume[r->element[i]];
      }
      check_near(weight, 1, 1e-12);
      bw_free(modes.shape);
      bw_release(regions);
      bw_release(mesh);
    }
  bw_release(material);
}

/* Strain with two humps: a low, wide one and a high, narrow one. */
static double hump(double t) {
  return fabs(t) < 1 ? t - t * t * t / 3 : copysign(2.0 / 3, t);
}

static void two_humps(const double x[3], double *u) {
  u[0] = -0.4 * hump((x[0] - 0.25) / 0.2) + 0.12 * hump((x[0] - 0.8) / 0.05);
  u[1] = u[2] = 0;
}

static void two_humps_scalar(const double x[3], double *u) {
  double v[3];
  two_humps(x, v);
  *u = v[0];
}

static void regions_by_energy(void **state) {
  bw_context *context = check_context(state);
  bw_material *material = isotropic(context, 1e9);
  bw_mesh *mesh = make_box(context, 1, 0.1, 0.1, 100, 3, 3, 1);
  for (int components = 1; components <= 3; components += 2) {
    bw_modes modes =
        one_mode(context, mesh, components, components == 3 ? two_humps : two_humps_scalar);
    bw_weak_options options;
    bw_weak_options_default(&options);
    options.fraction = 0.3;
    bw_weak_regions *regions = NULL;
    check_ok(context, bw_weak_regions_find(context, mesh, material, &modes, &options, &regions));
    assert_int_equal(regions->count, 2);
    for (int r = 0; r < 2; r++) {
      const bw_weak_region *region = &regions->region[r];
      assert_int_equal(region->rank, r);
      double c[3];
      centroid(mesh, region->element[0], c);
      check_near(c[0], r == 0 ? 0.25 : 0.8, r == 0 ? 0.2 : 0.05);
      double sum = 0;
      for (int32_t i = 0; i < region->count; i++) {
        if (components == 3) /* compressed in the first, stretched in the second */
          assert_true((region->weight[i] > 0) == (r == 1));
        sum += region->weight[i] * mesh->volume[region->element[i]];
      }
      /* A scalar mode cannot tell, but both regions go through the bar: they are to be bent. */
      check_near(fabs(sum), components == 3 ? 1 : 0, components == 3 ? 1e-12 : 0.1);
    }
    assert_true(regions->region[0].energy > regions->region[1].energy);
    assert_true(regions->region[0].volume > regions->region[1].volume);
    assert_true(regions->region[0].peak < regions->region[1].peak || components == 1);
    bw_free(modes.shape);
    bw_release(regions);
    options.regions = 1;
    modes = one_mode(context, mesh, components, components == 3 ? two_humps : two_humps_scalar);
    check_ok(context, bw_weak_regions_find(context, mesh, material, &modes, &options, &regions));
    assert_int_equal(regions->count, 1);
    bw_free(modes.shape);
    bw_release(regions);
  }
  bw_release(mesh);
  bw_release(material);
}

static void skin(const double x[3], double *u) {
  *u = (x[0] - 0.1) * exp(5 * x[1]);
}

/* The strained skin of a block lies on one side of it: one sign. */
static void one_sided_region_of_a_laplacian_mode(void **state) {
  bw_context *context = check_context(state);
  bw_material *material = isotropic(context, 1e9);
  bw_mesh *mesh = make_box(context, 0.2, 1, 1, 4, 40, 10, 1);
  bw_modes modes = one_mode(context, mesh, 1, skin);
  bw_weak_regions *regions = NULL;
  check_ok(context, bw_weak_regions_find(context, mesh, material, &modes, NULL, &regions));
  const bw_weak_region *region = &regions->region[0];
  for (int32_t i = 0; i < region->count; i++) {
    double c[3];
    centroid(mesh, region->element[i], c);
    assert_true(c[1] > 0.9);
    assert_true((region->weight[i] > 0) == (region->weight[0] > 0));
  }
  bw_free(modes.shape);
  bw_release(regions);
  bw_release(mesh);
  bw_release(material);
}

/* Whatever the field: what is chosen lies above what is not, and just fills the fraction. */
static void threshold_is_exact(void **state) {
  bw_context *context = check_context(state);
  bw_material *material = isotropic(context, 1e9);
  bw_mesh *mesh = make_bar(context, dumbbell_profile, 12, 4, 1);
  size_t n = (size_t)mesh->element_count;
  bw_random random;
  bw_random_seed(&random, 9);
  bw_modes modes = {.mesh = mesh, .count = 6, .components = 3};
  modes.shape = BW_NEW(context, double, 18 * (size_t)mesh->node_count);
  for (int32_t i = 0; i < 18 * mesh->node_count; i++) /* the last two take few values: ties */
    modes.shape[i] = i < 12 * mesh->node_count ? bw_random_normal(&random)
                                               : floor(1.5 * bw_random_uniform(&random));
  double *stress = BW_NEW(context, double, 6 * n), *value = BW_NEW(context, double, n);
  uint8_t *mark = BW_NEW(context, uint8_t, n);
  for (int trial = 0; trial < 6; trial++) {
    bw_weak_options options;
    bw_weak_options_default(&options);
    options.regions = 10000;
    options.fraction = trial == 5 ? 1 : 0.02 + 0.15 * trial;
    bw_weak_regions *regions = NULL;
    check_ok(context, bw_weak_regions_find(context, mesh, material, &modes, &options, &regions));
    for (int mode = 0; mode < 6; mode++) {
      double filled = 0, total = 0, min = INFINITY, max = 0, largest = 0;
      memset(mark, 0, n);
      for (int r = 0; r < regions->count; r++)
        for (int32_t i = 0; i < regions->region[r].count && regions->region[r].mode == mode; i++) {
          assert_int_equal(mark[regions->region[r].element[i]], 0);
          mark[regions->region[r].element[i]] = 1;
        }
      check_ok(context, bw_element_stress(context, mesh, material,
                                          modes.shape + 3 * (size_t)mode * (size_t)mesh->node_count,
                                          stress));
      check_ok(context, bw_max_principal_field(context, (int64_t)n, stress, value));
      for (size_t e = 0; e < n; e++) {
        total += mesh->volume[e];
        if (mark[e]) {
          filled += mesh->volume[e];
          min = fmin(min, value[e]);
          if (value[e] == min)
            largest = fmax(largest, mesh->volume[e]);
        } else {
          max = fmax(max, value[e]);
        }
      }
      assert_true(min >= max);
      assert_true(filled >= options.fraction * total * (1 - 1e-12));
      assert_true(filled <= options.fraction * total + largest * (1 + 1e-9) + 1e-12 * total);
    }
    bw_release(regions);
  }
  bw_free(stress);
  bw_free(value);
  bw_free(mark);
  bw_free(modes.shape);
  bw_release(mesh);
  bw_release(material);
}

static void swing(const double x[3], double *u) {
  u[0] = u[1] = 0;
  u[2] = x[0] * x[0] * x[0];
}

static void displacement_target(void **state) {
  bw_context *context = check_context(state);
  bw_material *material = isotropic(context, 1e9);
  for (int order = 1; order <= 2; order++) {
    bw_mesh *mesh = make_box(context, 1, 0.2, 0.2, 20, 2, 2, order);
    bw_modes modes = one_mode(context, mesh, 3, swing);
    bw_weak_options options;
    bw_weak_options_default(&options);
    options.target = BW_WORST_DISPLACEMENT;
    options.fraction = 0.05;
    bw_weak_regions *regions = NULL;
    check_ok(context, bw_weak_regions_find(context, mesh, material, &modes, &options, &regions));
    assert_int_equal(regions->count, 1);
    double c[3], norm = 0, moved = 0;
    for (int32_t i = 0; i < regions->region[0].count; i++) {
      const double *w = regions->region[0].weight + 3 * i;
      centroid(mesh, regions->region[0].element[i], c);
      assert_true(c[0] > 0.95 && w[2] > 0);
      norm += bw_norm(w) * mesh->volume[regions->region[0].element[i]];
    }
    check_near(norm, 1, 1e-12);
    /* A unit displacement along z has J = sum of w_z V = 1. */
    double *g = BW_NEW(context, double, 3 * (size_t)mesh->node_count);
    check_ok(context, bw_region_objective(context, regions, 0, material, g));
    for (int32_t i = 0; i < mesh->node_count; i++)
      moved += g[3 * i + 2];
    check_near(moved, 1, 1e-12);
    bw_free(g);
    modes.components = 1;
    check_fails(context, BW_UNSUPPORTED, "elastic",
                bw_weak_regions_find(context, mesh, material, &modes, &options, &regions));
    bw_free(modes.shape);
    bw_release(regions);
    bw_release(mesh);
  }
  bw_release(material);
}

static void nonsense_is_refused(void **state) {
  bw_context *context = check_context(state);
  bw_material *material = isotropic(context, 1e9);
  bw_mesh *mesh = make_box(context, 1, 1, 1, 2, 2, 2, 1);
  bw_modes modes = one_mode(context, mesh, 3, square);
  bw_weak_regions *regions = NULL;
  bw_weak_options options;
  bw_weak_options_default(&options);
  options.fraction = 0;
  check_fails(context, BW_INVALID, "fraction",
              bw_weak_regions_find(context, mesh, material, &modes, &options, &regions));
  bw_weak_options_default(&options);
  options.regions = 0;
  check_fails(context, BW_INVALID, "regions",
              bw_weak_regions_find(context, mesh, material, &modes, &options, &regions));
  for (int32_t i = 0; i < 3 * mesh->node_count; i++)
    modes.shape[i] = 0;
  check_fails(context, BW_EMPTY, "has strain energy",
              bw_weak_regions_find(context, mesh, material, &modes, NULL, &regions));
  modes.shape[4] = NAN;
  check_fails(context, BW_INVALID, "not finite",
              bw_weak_regions_find(context, mesh, material, &modes, NULL, &regions));
  const int32_t wrong[1] = {4800};
  check_fails(context, BW_INVALID, "element 4801",
              bw_weak_regions_single(context, mesh, 1, wrong, 1, &regions));
  check_fails(context, BW_INVALID, "sign",
              bw_weak_regions_single(context, mesh, 1, NULL, 0, &regions));
  bw_free(modes.shape);
  bw_release(mesh);
  bw_release(material);
}

static void allocation_failures(void **state) {
  bw_context *context = check_context(state);
  bw_material *material = isotropic(context, 1e9);
  bw_mesh *mesh = make_box(context, 1, 0.1, 0.1, 40, 2, 2, 1);
  bw_modes modes = one_mode(context, mesh, 3, two_humps);
  check_ok(context, bw_set_threads(context, 1));
  bw_weak_options options;
  bw_weak_options_default(&options);
  options.fraction = 0.2;
  check_each_allocation(context, status, 20) {
    bw_weak_regions *regions = NULL, *single = NULL;
    status = bw_weak_regions_find(context, mesh, material, &modes, &options, &regions);
    if (status == BW_OK)
      status = bw_weak_regions_single(context, mesh, 3, NULL, 1, &single);
    bw_release(regions);
    bw_release(single);
  }
  bw_free(modes.shape);
  bw_release(mesh);
  bw_release(material);
}

check_main(check_test(functional_is_the_integral), check_test(stretched_end),
           check_test(regions_by_energy), check_test(one_sided_region_of_a_laplacian_mode),
           check_test(threshold_is_exact), check_test(displacement_target),
           check_test(nonsense_is_refused), check_test(allocation_failures))
