/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* The search of the worst case: screening, directed objectives, the ascent, bounds. */
#include "bodies.h"
#include "body_system.h"

#include "analysis/load_program.h"
#include "analysis/weak_internal.h"
#include "analysis/worst_internal.h"

typedef struct part {
  bw_mesh *mesh;
  bw_material *material;
  bw_model *model;
  bw_dof_map *dof_map;
  bw_system *system;
  bw_pressure_basis *basis;
} part;

/* Fixed at x = 0, or free. */
static void part_open(bw_context *context, part *p, bw_mesh *mesh, bool fixed) {
  bw_isotropic constants = {"test", 3e9, 0.3, 1000, 5e6, 0, 0};
  const double origin[3] = {0, 0, 0}, normal[3] = {1, 0, 0};
  bw_selection *foot = NULL;
  memset(p, 0, sizeof *p);
  p->mesh = mesh;
  check_ok(context, bw_material_isotropic(context, &constants, &p->material));
  check_ok(context, bw_model_create(context, mesh, p->material, &p->model));
  if (fixed) {
    check_ok(context, bw_select_plane(context, mesh, origin, normal, 1e-9, &foot));
    check_ok(context, bw_model_fix(context, p->model, foot));
  }
  check_ok(context, bw_dof_map_create(context, p->model, &p->dof_map));
  check_ok(context, body_system(context, mesh, p->material, p->dof_map, NULL, &p->system));
  check_ok(context, bw_pressure_basis_create(context, mesh, NULL, &p->basis));
  bw_release(foot);
}

static void part_close(part *p) {
  bw_release(p->basis);
  bw_release(p->system);
  bw_release(p->dof_map);
  bw_release(p->model);
  bw_release(p->material);
  bw_release(p->mesh);
}

static double principal(const double stress[6]) {
  double value[3];
  bw_eigen3(stress, value, NULL);
  return fmax(fabs(value[0]), fabs(value[2]));
}

typedef struct climb {
  const bw_weak_regions *regions;
  double own[512][6]; /* stress of the region's element under its load */
  double objective[512];
} climb;

static bw_status keep_own(void *data, const bw_worst_case_visit *visit) {
  climb *c = (climb *)data;
  int32_t e = c->regions->region[visit->region].element[0];
  memcpy(c->own[visit->region], visit->stress + 6 * (size_t)e, sizeof c->own[0]);
  c->objective[visit->region] = visit->objective;
  assert_false(visit->flipped);
  return BW_OK;
}

/* From the stress of the screening on, an exact linear program along the principal direction of the
 * last stress never loses: principal before <= objective <= principal after. */
static void ascent_never_decreases(void **state) {
  bw_context *context = check_context(state);
  for (int kind = 0; kind < 4; kind++) {
    part p;
    bool fixed = kind == 1;
    part_open(context, &p,
              kind < 2 ? make_bar(context, dumbbell_profile, 12, 3, 1)
                       : make_bar(context, dumbbell_profile, 6, 2, 2),
              fixed);
    bw_worst_load_options options = {.pressure = 1e5, .force = 300, .force_is_max = kind == 3};
    bw_screening found;
    check_ok(context, bw_worst_screening(context, p.system, p.basis, &options, 40, 0, 30, &found));
    assert_true(found.count > 0 && found.count <= 30);
    for (int32_t i = 1; i < found.count; i++)
      assert_true(principal(found.stress + 6 * i) <= principal(found.stress + 6 * (i - 1)));
    options.one_sign = true;
    climb c;
    double *stress = found.stress, gained = 0;
    for (int step = 0; step < 3; step++) {
      bw_weak_regions *regions = NULL;
      check_ok(context, bw_weak_regions_directed(context, p.mesh, found.count, found.target, stress,
                                                 &regions));
      c.regions = regions;
      for (int32_t i = 0; i < found.count; i++) {
        check_near(regions->region[i].peak, principal(stress + 6 * i),
                   1e-9 * principal(stress + 6 * i));
        assert_int_equal(regions->region[i].mode, -1);
      }
      double before[512];
      for (int32_t i = 0; i < found.count; i++)
        before[i] = principal(stress + 6 * i);
      check_ok(context, bw_worst_case_run(context, p.system, p.basis, regions, &options, 7,
                                          keep_own, &c, NULL));
      for (int32_t i = 0; i < found.count; i++) {
        assert_true(c.objective[i] >= before[i] * (1 - 1e-7));
        assert_true(principal(c.own[i]) >= c.objective[i] * (1 - 1e-7));
        gained = fmax(gained, principal(c.own[i]) / before[i]);
      }
      stress = c.own[0];
      bw_release(regions);
    }
    assert_true(gained >
                1.01); /* pressures by patch are coarser than those of the linear program */
    bw_screening_clear(&found);
    part_close(&p);
  }
}

/* s n n^T of the principal stress of largest magnitude, as the derivative by the six components. */
static void direction_of(const double stress[6], double slope[6]) {
  double value[3], vector[9];
  bw_eigen3(stress, value, vector);
  int largest = fabs(value[0]) >= fabs(value[2]) ? 0 : 2;
  const double *n = vector + 3 * (size_t)largest;
  double s = value[largest] < 0 ? -1 : 1;
  const double all[6] = {n[0] * n[0],     n[1] * n[1],     n[2] * n[2],
                         2 * n[1] * n[2], 2 * n[2] * n[0], 2 * n[0] * n[1]};
  for (int k = 0; k < 6; k++)
    slope[k] = s * all[k];
}

/* Mean stresses over patches: what the screening finds is reached by the linear programs, whose
 * objective is the mean of bw_surface_stress over the patch. */
static void patches_are_screened_and_reached(void **state) {
  bw_context *context = check_context(state);
  const double radius = 0.1;
  for (int order = 1; order <= 2; order++) {
    part p;
    part_open(context, &p, make_bar(context, straight_profile, 8, 3, order), false);
    size_t size = 3 * (size_t)p.mesh->node_count;
    bw_worst_load_options options = {.pressure = 1e5, .force = 300};
    bw_screening found;
    bw_weak_regions *regions = NULL;
    climb c;
    double *force = BW_NEW(context, double, size), *region = BW_NEW(context, double, size),
           *by_force = BW_NEW(context, double, size);
    check_ok(context,
             bw_worst_screening(context, p.system, p.basis, &options, 40, radius, 12, &found));
    assert_true(found.count > 2 && found.count <= 12);
    for (int32_t i = 0; i < found.count; i++)
      for (int32_t j = 0; j < i; j++) {
        const double *a = p.mesh->node + 3 * (size_t)found.target[i],
                     *b = p.mesh->node + 3 * (size_t)found.target[j];
        double d[3] = {a[0] - b[0], a[1] - b[1], a[2] - b[2]};
        assert_true(bw_norm(d) > radius);
      }
    check_ok(context, bw_weak_regions_patches(context, p.mesh, NULL, radius, found.count,
                                              found.target, found.stress, &regions));
    for (int32_t i = 0; i < found.count; i++) {
      double slope[6], largest = 0, difference = 0;
      direction_of(found.stress + 6 * (size_t)i, slope);
      check_ok(context, bw_region_objective(context, regions, i, p.material, region));
      check_ok(context, bw_patch_functional(context, p.mesh, p.material, NULL, radius,
                                            found.target[i], slope, force, by_force));
      for (size_t k = 0; k < size; k++) {
        largest = fmax(largest, fabs(force[k]));
        difference = fmax(difference, fabs(force[k] - region[k]));
      }
      assert_true(largest > 0 && difference < 1e-11 * largest);
      memset(region, 0, size * sizeof *region);
      check_ok(context, bw_region_by_force(context, regions, i, p.material, region));
      largest = difference = 0;
      for (size_t k = 0; k < size; k++) {
        largest = fmax(largest, fabs(by_force[k]));
        difference = fmax(difference, fabs(by_force[k] - region[k]));
      }
      assert_true(largest > 0 && difference < 1e-11 * largest);
    }
    c.regions = regions;
    options.one_sign = true;
    check_ok(context, bw_worst_case_run(context, p.system, p.basis, regions, &options, 7, keep_own,
                                        &c, NULL));
    for (int32_t i = 0; i < found.count; i++)
      assert_true(c.objective[i] >= principal(found.stress + 6 * (size_t)i) * (1 - 1e-7));
    bw_free(force);
    bw_free(by_force);
    bw_free(region);
    bw_screening_clear(&found);
    bw_release(regions);
    part_close(&p);
  }
}

static void patches_divide_the_boundary(void **state) {
  bw_context *context = check_context(state);
  part p;
  part_open(context, &p, make_box(context, 1, 0.6, 0.02, 10, 6, 1, 1), false);
  for (int32_t patches = 1; patches <= 64; patches *= 4) {
    bw_pressure_basis *coarse = NULL;
    check_ok(context, bwi_pressure_patches(context, p.basis, patches, &coarse));
    assert_int_equal(coarse->count, patches);
    double area = 0, fine = 0;
    for (int32_t k = 0; k < coarse->count; k++) {
      assert_true(coarse->area[k] > 0);
      area += coarse->area[k];
    }
    for (int32_t j = 0; j < p.basis->count; j++)
      fine += p.basis->area[j];
    check_near(area, fine, 1e-12);
    /* The same pressure on all patches gives the forces of the uniform pressure. */
    size_t n = 3 * (size_t)p.mesh->node_count;
    double *one = BW_NEW(context, double, p.basis->count), *a = BW_NEW(context, double, n),
           *b = BW_NEW(context, double, n);
    for (int32_t j = 0; j < p.basis->count; j++)
      one[j] = 1;
    bw_pressure_force(coarse, one, a);
    bw_pressure_force(p.basis, one, b);
    for (size_t i = 0; i < n; i++)
      check_near(a[i], b[i], 1e-12);
    bw_free(one);
    bw_free(a);
    bw_free(b);
    bw_release(coarse);
  }
  part_close(&p);
}

static uint64_t state_of_noise = 7;
static double noise(void) {
  state_of_noise = state_of_noise * 6364136223846793005u + 1442695040888963407u;
  return (double)(state_of_noise >> 11) / 9007199254740992.0;
}

/* The faces cover a half sphere once: their solid angles sum to 2 pi, and of each direction n or -n
 * lies in one. */
static void faces_cover_the_half_sphere(void **state) {
  (void)state;
  bwi_triangle face[BWI_HALF_ICOSAHEDRON];
  double angle = 0, cross[3];
  bwi_half_icosahedron(face);
  for (int f = 0; f < BWI_HALF_ICOSAHEDRON; f++) {
    const double *a = face[f].corner[0], *b = face[f].corner[1], *c = face[f].corner[2];
    bw_cross(b, c, cross);
    angle += 2 * atan2(fabs(bw_dot(a, cross)), 1 + bw_dot(a, b) + bw_dot(b, c) + bw_dot(c, a));
  }
  check_near(angle, 2 * acos(-1), 1e-12);
  for (int turn = 0; turn < 2000; turn++) {
    double n[3] = {noise() - 0.5, noise() - 0.5, noise() - 0.5};
    int inside = 0;
    for (int f = 0; f < BWI_HALF_ICOSAHEDRON; f++) {
      double side[3];
      for (int k = 0; k < 3; k++) {
        bw_cross(face[f].corner[k], face[f].corner[(k + 1) % 3], cross);
        side[k] = bw_dot(n, cross);
      }
      inside += (side[0] >= 0 && side[1] >= 0 && side[2] >= 0) ||
                (side[0] <= 0 && side[1] <= 0 && side[2] <= 0);
    }
    assert_true(inside >= 1);
  }
}

/* The bound exceeds every stress of random directions' linear programs, by no more than the
 * tolerance of the best found; free, fixed, with a smaller force, of one and two threads. */
static void bound_is_above_every_linear_program(void **state) {
  bw_context *context = check_context(state);
  for (int kind = 0; kind < 4; kind++) {
    part p;
    part_open(context, &p,
              kind == 3 ? make_box(context, 1, 1, 1, 2, 2, 2, 1) /* squeezed, not stretched */
                        : make_bar(context, dumbbell_profile, 6, 2, kind == 2 ? 2 : 1),
              kind == 1);
    bw_worst_load_options options = {
        .pressure = 1e5, .force = kind == 3 ? 2e5 : 300, .force_is_max = kind == 2};
    bw_worst_bound bound, again;
    check_ok(context,
             bw_worst_bound_find(context, p.system, p.basis, &options, 0, 0.03, &bound, NULL));
    assert_true(bound.largest > 0 && bound.upper >= bound.largest);
    assert_true(bound.upper <= 1.0301 * bound.largest);
    assert_true(bound.element >= 0 && bound.linear_programs > 0);
    check_near(principal(bound.stress), bound.largest, 1e-9 * bound.largest);
    check_ok(context, bw_set_threads(context, 3));
    check_ok(context,
             bw_worst_bound_find(context, p.system, p.basis, &options, 0, 0.03, &again, NULL));
    assert_memory_equal(&again.upper, &bound.upper, sizeof bound.upper);
    assert_memory_equal(again.stress, bound.stress, sizeof bound.stress);
    assert_int_equal(again.linear_programs, bound.linear_programs);
    check_ok(context, bw_set_threads(context, 1));
    /* A better start needs fewer linear programs and finds nothing larger than the bound. */
    check_ok(context, bw_worst_bound_find(context, p.system, p.basis, &options, bound.upper, 0.03,
                                          &again, NULL));
    assert_true(again.linear_programs < bound.linear_programs && again.element == -1);
    options.one_sign = true;
    for (int turn = 0; turn < 20; turn++) {
      int32_t element[8];
      double stress[8][6];
      for (int i = 0; i < 8; i++) {
        element[i] = (int32_t)(noise() * p.mesh->element_count);
        for (int k = 0; k < 6; k++)
          stress[i][k] = noise() - 0.5;
      }
      bw_weak_regions *regions = NULL;
      check_ok(context, bw_weak_regions_directed(context, p.mesh, 8, element, stress[0], &regions));
      climb c = {.regions = regions};
      check_ok(context, bw_worst_case_run(context, p.system, p.basis, regions, &options, 0,
                                          keep_own, &c, NULL));
      for (int i = 0; i < 8; i++)
        assert_true(principal(c.own[i]) <= bound.upper * (1 + 1e-9));
      bw_release(regions);
    }
    part_close(&p);
  }
}

static void same_bits_for_any_number_of_threads(void **state) {
  bw_context *context = check_context(state);
  bw_screening first = {0};
  for (int threads = 1; threads <= 3; threads++) {
    check_ok(context, bw_set_threads(context, threads));
    part p;
    bw_screening found;
    part_open(context, &p, make_bar(context, dumbbell_profile, 10, 3, 1), false);
    bw_worst_load_options options = {.pressure = 1e5, .force = 300};
    check_ok(context, bw_worst_screening(context, p.system, p.basis, &options, 32, 0, 24, &found));
    if (threads == 1) {
      first = found;
    } else {
      assert_int_equal(found.count, first.count);
      assert_memory_equal(found.target, first.target, (size_t)found.count * sizeof(int32_t));
      assert_memory_equal(found.stress, first.stress, 6 * (size_t)found.count * sizeof(double));
      bw_screening_clear(&found);
    }
    part_close(&p);
  }
  bw_screening_clear(&first);
}

/* Stresses by unit pressure from slabs of any size: those of adjoint solves. */
static void slabs_give_the_same_responses(void **state) {
  bw_context *context = check_context(state);
  for (int order = 1; order <= 2; order++) {
    part p;
    part_open(context, &p, make_box(context, 0.3, 1, 0.3, 2, 6, 2, order), order == 1);
    size_t n = (size_t)p.basis->count, entries = 3 * (size_t)p.mesh->node_count;
    int32_t elements = p.mesh->element_count, slabs[2] = {0, 0};
    double *first = BW_NEW(context, double, 6 * n * (size_t)elements);
    double *adjoint = BW_NEW(context, double, entries), *own = BW_NEW(context, double, 6 * n);
    for (int small = 0; small < 2; small++) {
      bwi_responses r;
      size_t max = small ? 24 * n * (size_t)(order == 1 ? 30 : 120) : 1 << 30;
      int32_t seen = 0;
      check_ok(context, bwi_responses_open(context, p.system, p.basis, max, &r));
      check_ok(context, bwi_responses_next(&r, 16));
      for (; r.count > 0; slabs[small]++) {
        assert_true(r.first + r.count == elements || r.count % 16 == 0);
        for (int32_t i = r.first; i < r.first + r.count; i++, seen++) {
          bwi_response_of(&r, r.order[i], own);
          double *kept = first + 6 * n * (size_t)r.order[i];
          if (!small)
            memcpy(kept, own, 6 * n * sizeof *own);
          assert_memory_equal(kept, own, 6 * n * sizeof *own);
        }
        check_ok(context, bwi_responses_next(&r, 16));
      }
      assert_int_equal(seen, elements);
      bwi_responses_close(&r);
    }
    assert_int_equal(slabs[0], 1);
    assert_true(slabs[1] > 2);
    bw_weak_regions *regions = NULL;
    const int32_t element = elements / 2;
    check_ok(context,
             bwi_element_regions(context, p.mesh, 1, &element, BW_WORST_DIRECTION, &regions));
    double volume = bwi_shape_integrals(p.mesh, element, NULL, NULL);
    for (size_t c = 0; c < 6; c++) {
      double *weight = regions->region[0].weight, largest = 0;
      memset(weight, 0, 6 * sizeof *weight);
      weight[c] = (c < 3 ? 1 : 0.5) / volume;
      check_ok(context, bw_region_objective(context, regions, 0, p.material, adjoint));
      check_ok(context, bw_system_solve(context, p.system, 1, adjoint, adjoint));
      bw_pressure_gradient(p.basis, adjoint, own);
      const double *kept = first + 6 * n * (size_t)element + c * n;
      for (size_t j = 0; j < n; j++)
        largest = fmax(largest, fabs(own[j]));
      for (size_t j = 0; j < n; j++)
        check_near(kept[j], own[j], 1e-9 * largest);
    }
    bw_release(regions);
    bw_free(first);
    bw_free(adjoint);
    bw_free(own);
    part_close(&p);
  }
}

/* Whole numbers times a power of two, at most 2^-15 off, and rounded once for all. */
static void multipliers_have_few_digits(void **state) {
  (void)state;
  for (int turn = 0; turn < 2000; turn++) {
    double y[3], again[3], largest = 0;
    for (int k = 0; k < 3; k++) {
      y[k] = turn == 0 ? 0 : ldexp(2 * noise() - 1, turn % 90 - 45 + 3 * k);
      y[k] = turn % 7 == 3 ? ldexp(1 - 1e-9, turn % 90 - 45) : y[k];
      largest = fmax(largest, fabs(y[k]));
    }
    memcpy(again, y, sizeof y);
    bwi_round_multipliers(3, again);
    for (int k = 0; k < 3; k++)
      assert_true(fabs(again[k] - y[k]) <= ldexp(largest, -14));
    memcpy(y, again, sizeof y);
    bwi_round_multipliers(3, again);
    assert_memory_equal(y, again, sizeof y);
  }
}

static void failures(void **state) {
  bw_context *context = check_context(state);
  part p;
  part_open(context, &p, make_bar(context, dumbbell_profile, 5, 2, 1), false);
  bw_worst_load_options options = {.pressure = 1e5, .force = 300};
  bw_screening found;
  check_fails(context, BW_INVALID, "both must be positive",
              bw_worst_screening(context, p.system, p.basis, &options, 0, 0, 5, &found));
  check_fails(context, BW_INVALID, "both must be positive",
              bw_worst_screening(context, p.system, p.basis, &options, 5, 0, 0, &found));
  options.force = 1e12;
  check_fails(context, BW_INFEASIBLE, "raise the pressure",
              bw_worst_screening(context, p.system, p.basis, &options, 5, 0, 5, &found));
  options.force = 300;
  /* Fewer patches than balance rows would leave the uniform pressure alone: it takes more. */
  check_ok(context, bw_worst_screening(context, p.system, p.basis, &options, 2, 0, 5, &found));
  assert_int_equal(found.count, 5);
  bw_screening_clear(&found);
  bw_weak_regions *regions = NULL;
  const int32_t element[2] = {3, 1};
  const double stress[12] = {1, 2, 3, 0, 0, 0};
  check_fails(context, BW_INVALID, "region 2 must be finite and not zero",
              bw_weak_regions_directed(context, p.mesh, 2, element, stress, &regions));
  const int32_t far[1] = {100000};
  check_fails(context, BW_INVALID, "element 100001",
              bw_weak_regions_directed(context, p.mesh, 1, far, stress, &regions));
  bw_worst_bound bound;
  check_fails(context, BW_INVALID, "from 0.001 to 0.5",
              bw_worst_bound_find(context, p.system, p.basis, &options, 1, 1e-9, &bound, NULL));
  check_fails(context, BW_INVALID, "known to be reached is -1",
              bw_worst_bound_find(context, p.system, p.basis, &options, -1, 0.01, &bound, NULL));
  bw_cancel(context);
  check_fails(context, BW_CANCELLED, "",
              bw_worst_bound_find(context, p.system, p.basis, &options, 1, 0.01, &bound, NULL));
  check_fails(context, BW_CANCELLED, "",
              bw_worst_screening(context, p.system, p.basis, &options, 16, 0, 5, &found));
  bw_clear_cancel(context);
  check_ok(context, bw_set_threads(context, 1));
  check_each_allocation(context, status, 20) {
    status = bw_worst_screening(context, p.system, p.basis, &options, 16, 0, 5, &found);
    if (status == BW_OK)
      status = bw_weak_regions_directed(context, p.mesh, 1, element, stress, &regions);
    bw_screening_clear(&found);
    bw_release(regions);
    regions = NULL;
  }
  part_close(&p);
  part_open(context, &p, make_box(context, 1, 1, 1, 1, 1, 1, 1), false);
  check_each_allocation(context, status, 20) {
    bw_bound_leaves leaves = {0};
    status = bw_worst_bound_find(context, p.system, p.basis, &options, 0, 0.3, &bound, &leaves);
    bw_bound_leaves_clear(&leaves);
  }
  part_close(&p);
}

check_main(check_test(ascent_never_decreases), check_test(patches_are_screened_and_reached),
           check_test(patches_divide_the_boundary), check_test(faces_cover_the_half_sphere),
           check_test(bound_is_above_every_linear_program),
           check_test(same_bits_for_any_number_of_threads),
           check_test(slabs_give_the_same_responses), check_test(multipliers_have_few_digits),
           check_test(failures))
