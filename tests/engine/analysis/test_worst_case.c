/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* The whole chain from region to stress: the adjoint identity, the bordered system, pins, Young's
 * modulus, scaling, symmetry, beams, the neck of a dumbbell, threads. */
#include "bodies.h"
#include "body_system.h"

#include "analysis/load_program.h"

typedef struct part {
  bw_mesh *mesh;
  bw_material *material;
  bw_dof_map *dof_map;
  bw_system *system;
  bw_pressure_basis *basis;
} part;

static void part_open(bw_context *context, part *p, bw_mesh *mesh, double young) {
  bw_isotropic constants = {"test", young, 0.3, 1000, 5e6, 0, 0};
  memset(p, 0, sizeof *p);
  p->mesh = mesh;
  check_ok(context, bw_material_isotropic(context, &constants, &p->material));
  check_ok(context, bw_dof_map_unconstrained(context, mesh, &p->dof_map));
  check_ok(context, body_system(context, mesh, p->material, p->dof_map, NULL, &p->system));
  check_ok(context, bw_pressure_basis_create(context, mesh, NULL, &p->basis));
}

static void part_close(part *p) {
  bw_release(p->basis);
  bw_release(p->system);
  bw_release(p->dof_map);
  bw_release(p->material);
  bw_release(p->mesh);
}

/* What visits leave behind. */
typedef struct answers {
  const part *of;
  const bw_weak_regions *regions;
  int count;
  double *pressure, *stress; /* of the region with the largest stress */
  double objective[512], peak[512], own[512];
  double at[3], largest;
  int weakest;
  uint64_t digest;
} answers;

static uint64_t mix(uint64_t h, const void *data, size_t bytes) {
  const unsigned char *c = (const unsigned char *)data;
  for (size_t i = 0; i < bytes; i++)
    h = (h ^ c[i]) * 0x100000001b3u;
  return h;
}

static bw_status collect(void *data, const bw_worst_case_visit *visit) {
  answers *a = (answers *)data;
  const bw_mesh *mesh = a->of->mesh;
  int r = visit->region;
  assert_int_equal(r, a->count);
  a->count++;
  a->objective[r] = visit->objective;
  a->peak[r] = 0;
  int32_t where = 0;
  for (int32_t e = 0; e < mesh->element_count; e++)
    if (visit->max_principal[e] > a->peak[r]) {
      a->peak[r] = visit->max_principal[e];
      where = e;
    }
  a->own[r] = 0;
  const bw_weak_region *region = &a->regions->region[r];
  for (int32_t i = 0; i < region->count; i++)
    a->own[r] = fmax(a->own[r], visit->max_principal[region->element[i]]);
  if (a->peak[r] > a->largest) {
    a->largest = a->peak[r];
    a->weakest = r;
    for (int k = 0; k < 3; k++) {
      a->at[k] = 0;
      for (int c = 0; c < 4; c++)
        a->at[k] += mesh->node[3 * mesh->element[where * mesh->nodes_per_element + c] + k] / 4;
    }
    memcpy(a->pressure, visit->pressure, (size_t)a->of->basis->count * sizeof(double));
    memcpy(a->stress, visit->stress, 6 * (size_t)mesh->element_count * sizeof(double));
  }
  /* The linear program's objective is the functional of the stress that was found. */
  if (a->regions->options.target == BW_WORST_STRESS) {
    double sum = 0;
    for (int32_t i = 0; i < region->count; i++) {
      const double *s = visit->stress + 6 * region->element[i];
      sum += region->weight[i] * mesh->volume[region->element[i]] * (s[0] + s[1] + s[2]);
    }
    check_near(visit->flipped ? -sum : sum, visit->objective, 1e-7 * fabs(visit->objective));
  }
  a->digest = mix(a->digest, visit->pressure, (size_t)a->of->basis->count * sizeof(double));
  a->digest = mix(a->digest, visit->stress, 6 * (size_t)mesh->element_count * sizeof(double));
  assert_true(visit->seconds >= 0);
  return BW_OK;
}

static void answers_open(bw_context *context, answers *a, const part *p,
                         const bw_weak_regions *regions) {
  memset(a, 0, sizeof *a);
  a->of = p;
  a->regions = regions;
  a->weakest = -1;
  a->pressure = BW_NEW(context, double, p->basis->count);
  a->stress = BW_NEW(context, double, 6 * (size_t)p->mesh->element_count);
}

static void answers_close(answers *a) {
  bw_free(a->pressure);
  bw_free(a->stress);
}

static bw_weak_regions *modal_regions(bw_context *context, const part *p, int modes,
                                      const bw_weak_options *options, bool laplacian) {
  bw_modes *shapes = NULL;
  bw_modes_options wanted;
  bw_modes_options_default(&wanted);
  wanted.count = modes;
  check_ok(context, laplacian
                        ? bw_modes_laplacian(context, p->mesh, p->system->pattern, &wanted, &shapes)
                        : bw_modes_elastic(context, p->system, &wanted, &shapes));
  bw_weak_regions *regions = NULL;
  check_ok(context, bw_weak_regions_find(context, p->mesh, p->material, shapes, options, &regions));
  bw_release(shapes);
  return regions;
}

static double boundary_area(const part *p) {
  double area = 0;
  for (int32_t j = 0; j < p->basis->count; j++)
    area += p->basis->area[j];
  return area;
}

/* u of bw_system_solve against the dense bordered system (13), balanced load or not. */
static void pinned_equals_bordered(void **state) {
  bw_context *context = check_context(state);
  for (int order = 1; order <= 2; order++) {
    part p;
    part_open(context, &p, make_bar(context, dumbbell_profile, 4 / order, 2 / order, order), 3e9);
    int32_t n = 3 * p.mesh->node_count, m = n + 6;
    const bw_block_pattern *pattern = p.system->pattern;
    double *a = BW_NEW0(context, double, (size_t)m *(size_t)m), *x = BW_NEW0(context, double, m);
    double *r = BW_NEW0(context, double, (size_t)n), *mr = BW_NEW0(context, double, (size_t)n);
    double *f = BW_NEW(context, double, n), *u = BW_NEW(context, double, n);
    int32_t *pivot = BW_NEW(context, int32_t, m);
    bw_random random;
    bw_random_seed(&random, 2);
    for (int32_t i = 0; i < p.mesh->node_count; i++)
      for (int64_t k = pattern->start[i]; k < pattern->start[i + 1]; k++)
        for (int c = 0; c < 9; c++) {
          int32_t row = 3 * i + c / 3, column = 3 * pattern->column[k] + c % 3;
          a[(size_t)row * (size_t)m + (size_t)column] = p.system->stiffness[9 * k + c];
          a[(size_t)column * (size_t)m + (size_t)row] = p.system->stiffness[9 * k + c];
        }
    for (int k = 0; k < 6; k++) {
      for (int32_t i = 0; i < p.mesh->node_count; i++) {
        const double *at = p.mesh->node + 3 * i;
        double axis[3] = {k == 3, k == 4, k == 5};
        bw_cross(axis, at, r + 3 * i);
        for (int c = 0; c < 3; c++)
          r[3 * i + c] += k == c;
      }
      check_ok(context, bw_block_multiply(context, pattern, p.system->mass, 1, 3, 1, r, mr));
      for (int32_t i = 0; i < n; i++) {
        /* scaled to the stiffness, for the elimination's sake */
        a[(size_t)i * (size_t)m + (size_t)(n + k)] = 1e9 * mr[i];
        a[(size_t)(n + k) * (size_t)m + (size_t)i] = 1e9 * mr[i];
      }
    }
    assert_true(bwi_dense_factor(m, a, pivot));
    for (int trial = 0; trial < 2; trial++) {
      double largest = 0;
      if (trial == 0) {
        double *pressure = BW_NEW(context, double, p.basis->count);
        for (int32_t j = 0; j < p.basis->count; j++)
          pressure[j] = 1e6; /* uniform: balanced */
        bw_pressure_force(p.basis, pressure, f);
        bw_free(pressure);
      } else {
        for (int32_t i = 0; i < n; i++)
          f[i] = bw_random_normal(&random);
      }
      memset(x, 0, (size_t)m * sizeof *x);
      memcpy(x, f, (size_t)n * sizeof *f);
      bwi_dense_solve(m, a, pivot, x);
      check_ok(context, bw_system_solve(context, p.system, 1, f, u));
      for (int32_t i = 0; i < n; i++)
        largest = fmax(largest, fabs(x[i]));
      for (int32_t i = 0; i < n; i++)
        check_near(u[i], x[i], 1e-8 * largest);
    }
    bw_free(a);
    bw_free(x);
    bw_free(r);
    bw_free(mr);
    bw_free(f);
    bw_free(u);
    bw_free(pivot);
    part_close(&p);
  }
}

/* The same body with its nodes numbered backwards has isostatic constraints elsewhere; nothing may
 * change. And with another Young's modulus, stresses stay. Twice the load is twice the stress. */
static void invariances(void **state) {
  bw_context *context = check_context(state);
  bw_mesh *mesh = make_bar(context, dumbbell_profile, 14, 4, 1), *turned = NULL;
  size_t nodes = (size_t)mesh->node_count, elements = (size_t)mesh->element_count;
  double *x = BW_NEW(context, double, 3 * nodes);
  int32_t *e = BW_NEW(context, int32_t, 4 * elements);
  const double c = cos(0.7), s = sin(0.7);
  for (size_t i = 0; i < nodes; i++) {
    const double *at = mesh->node + 3 * i;
    double *to = x + 3 * (nodes - 1 - i);
    to[0] = c * at[0] - s * at[1] + 5;
    to[1] = s * at[0] + c * at[1] - 3;
    to[2] = at[2] + 1;
  }
  for (size_t i = 0; i < 4 * elements; i++)
    e[i] = (int32_t)nodes - 1 - mesh->element[i];
  check_ok(context,
           bw_mesh_copy(context, 1, (int64_t)nodes, x, (int64_t)elements, e, NULL, &turned));
  bw_free(x);
  bw_free(e);
  part p[3];
  part_open(context, &p[0], mesh, 1e9);
  part_open(context, &p[1], turned, 1e9);
  part_open(context, &p[2], (bw_mesh *)bw_retain(mesh), 7.7e10);
  double area = boundary_area(&p[0]);
  bw_worst_load_options options = {.pressure = 1e5, .force = 1e5 * 0.08 * area};
  const int32_t some[6] = {3, 200, 411, 640, 700, 1001};
  answers first, other;
  for (int which = 0; which < 4; which++) {
    const part *of = &p[which % 3];
    bw_weak_regions *regions = NULL;
    check_ok(context, bw_weak_regions_single(context, of->mesh, 6, some, 1, &regions));
    answers *a = which == 0 ? &first : &other;
    answers_open(context, a, of, regions);
    if (which == 3) {
      options.pressure *= 2;
      options.force *= 2;
    }
    check_ok(context, bw_worst_case_run(context, of->system, of->basis, regions, &options,
                                        which == 1 ? 4 : 0, collect, a, NULL));
    double factor = which == 3 ? 2 : 1;
    for (int r = 0; r < 6; r++) {
      check_near(a->objective[r], factor * first.objective[r], 1e-8 * factor * first.objective[r]);
      check_near(a->own[r], factor * first.own[r], 1e-6 * factor * first.own[r]);
    }
    bw_release(regions);
    if (which > 0)
      answers_close(a);
  }
  answers_close(&first);
  for (int i = 0; i < 3; i++)
    part_close(&p[i]);
}

/* The Kuhn grid of a cube looks the same after inversion through its middle: so do its answers. */
static void symmetric_body(void **state) {
  bw_context *context = check_context(state);
  part p;
  part_open(context, &p, make_box(context, 1, 1, 1, 4, 4, 4, 1), 1e9);
  int32_t pair[8];
  int found = 0;
  for (int32_t a = 5; a < p.mesh->element_count && found < 8; a += 37)
    for (int32_t b = 0; b < p.mesh->element_count; b++) {
      double off = 0;
      for (int k = 0; k < 3; k++) {
        double sum = 0;
        for (int c = 0; c < 4; c++)
          sum += p.mesh->node[3 * p.mesh->element[4 * a + c] + k] +
                 p.mesh->node[3 * p.mesh->element[4 * b + c] + k];
        off += fabs(sum - 4);
      }
      if (off < 1e-9 && found < 8) {
        pair[found++] = a;
        pair[found++] = b;
      }
    }
  assert_int_equal(found, 8);
  bw_weak_regions *regions = NULL;
  check_ok(context, bw_weak_regions_single(context, p.mesh, 8, pair, 1, &regions));
  bw_worst_load_options options = {.pressure = 10, .force = 3};
  answers a;
  answers_open(context, &a, &p, regions);
  check_ok(context,
           bw_worst_case_run(context, p.system, p.basis, regions, &options, 0, collect, &a, NULL));
  for (int i = 0; i < 8; i += 2)
    check_near(a.objective[i + 1], a.objective[i], 1e-9 * a.objective[i]);
  answers_close(&a);
  bw_release(regions);
  part_close(&p);
}

static double slender_profile(double x) {
  (void)x;
  return 0.025;
}

/* A free slender bar: whatever balanced pushing with total force F can do, bending in the middle by
 * F/4 at either end against F/2 in the middle does most. Largest moment F L / 8, section modulus
 * h^3 / 6. Patches of finite size shorten the arms. */
static void slender_bar_is_bent_in_the_middle(void **state) {
  bw_context *context = check_context(state);
  for (int displacement = 0; displacement < 2; displacement++) {
    part p;
    part_open(context, &p, make_bar(context, slender_profile, 40, 2, 2), 2e9);
    bw_weak_options weak;
    bw_weak_options_default(&weak);
    weak.target = displacement ? BW_WORST_DISPLACEMENT : BW_WORST_STRESS;
    bw_weak_regions *regions = modal_regions(context, &p, 6, &weak, false);
    bw_worst_load_options options = {.pressure = 2e4, .force = 20};
    answers a;
    answers_open(context, &a, &p, regions);
    check_ok(context, bw_worst_case_run(context, p.system, p.basis, regions, &options, 0, collect,
                                        &a, NULL));
    /* The outermost of the two layers of elements has its centroids at 3/4 of the half height. */
    double bound = 0.75 * options.force / 8 / (0.05 * 0.05 * 0.05 / 6);
    if (getenv("BARWRIGHT_FULL"))
      printf("  largest %.4g Pa, simple beam %.4g Pa, at x = %.2f\n", a.largest, bound, a.at[0]);
    assert_true(a.largest > 0.88 * bound && a.largest < 1.05 * bound);
    check_near(a.at[0], 0.5, 0.1);
    /* A quarter of the force on each end, half on the middle, the other way; bending about a
     * diagonal by pushing on two sides at once is as good, hence components. */
    int count;
    bw_arrow *arrow = NULL;
    double part_of[3] = {0, 0, 0};
    check_ok(context, bw_resultant_arrows(context, p.basis, a.pressure, 0.1, &count, &arrow));
    for (int i = 0; i < count; i++) {
      double t = arrow[i].at[0];
      part_of[t < 0.25 ? 0 : t > 0.75 ? 2 : 1] += fabs(arrow[i].force[1]) + fabs(arrow[i].force[2]);
    }
    check_near(part_of[0], 5, 0.6);
    check_near(part_of[1], 10, 0.6);
    check_near(part_of[2], 5, 0.6);
    bw_free(arrow);
    answers_close(&a);
    bw_release(regions);
    part_close(&p);
  }
}

/* Wherever one looks, with elastic or Laplacian modes or everywhere: a dumbbell breaks at its neck.
 */
static void dumbbell_breaks_at_the_neck(void **state) {
  bw_context *context = check_context(state);
  part p;
  part_open(context, &p, make_bar(context, dumbbell_profile, 24, 4, 1), 2e9);
  bw_worst_load_options options = {.pressure = 1e5, .force = 50};
  double largest[3];
  for (int way = 0; way < 3; way++) {
    bw_weak_regions *regions = NULL;
    int32_t some[480];
    for (int i = 0; i < 480; i++)
      some[i] = i * (p.mesh->element_count / 480);
    if (way < 2)
      regions = modal_regions(context, &p, 8, NULL, way == 1);
    else
      check_ok(context, bw_weak_regions_single(context, p.mesh, 480, some, 1, &regions));
    answers a;
    answers_open(context, &a, &p, regions);
    check_ok(context, bw_worst_case_run(context, p.system, p.basis, regions, &options, 32, collect,
                                        &a, NULL));
    assert_int_equal(a.count, regions->count);
    check_near(a.at[0], 0.4, 0.06);
    largest[way] = a.largest;
    answers_close(&a);
    bw_release(regions);
  }
  if (getenv("BARWRIGHT_FULL"))
    printf("  elastic %.4g, Laplacian %.4g, element by element %.4g Pa\n", largest[0], largest[1],
           largest[2]);
  assert_true(largest[0] > 0.9 * largest[2]);
  part_close(&p);
}

/* A constrained body takes any pressure: no balance, the best pressures by gain per area. */
static void constrained_body(void **state) {
  bw_context *context = check_context(state);
  part p;
  part_open(context, &p, make_box(context, 1, 0.2, 0.2, 16, 3, 3, 1), 1e9);
  bw_model *model = NULL;
  bw_selection *foot = NULL;
  const double origin[3] = {0, 0, 0}, normal[3] = {1, 0, 0};
  check_ok(context, bw_model_create(context, p.mesh, p.material, &model));
  check_ok(context, bw_select_plane(context, p.mesh, origin, normal, 1e-9, &foot));
  check_ok(context, bw_model_fix(context, model, foot));
  bw_release(p.dof_map);
  bw_release(p.system);
  check_ok(context, bw_dof_map_create(context, model, &p.dof_map));
  assert_int_equal(p.dof_map->rigid_mode_count, 0);
  check_ok(context, body_system(context, p.mesh, p.material, p.dof_map, NULL, &p.system));
  bw_weak_regions *regions = modal_regions(context, &p, 4, NULL, false);
  bw_worst_load_options options = {.pressure = 1e4, .force = 40};
  answers a;
  answers_open(context, &a, &p, regions);
  check_ok(context,
           bw_worst_case_run(context, p.system, p.basis, regions, &options, 0, collect, &a, NULL));
  check_near(a.at[0], 0, 0.1); /* a cantilever pressed at its tip breaks at its root */
  for (int32_t j = 0; j < p.basis->count; j++)
    assert_true(a.pressure[j] == 0 || p.mesh->node[3 * p.basis->node[j]] > 0.8);
  answers_close(&a);
  bw_release(regions);
  bw_release(foot);
  bw_release(model);
  part_close(&p);
}

static void same_bits_for_any_number_of_threads(void **state) {
  bw_context *context = check_context(state);
  uint64_t digest[4];
  for (int threads = 1; threads <= 3; threads++) {
    check_ok(context, bw_set_threads(context, threads));
    part p;
    part_open(context, &p, make_bar(context, dumbbell_profile, 16, 4, 1), 2e9);
    bw_weak_regions *regions = modal_regions(context, &p, 5, NULL, false);
    bw_worst_load_options options = {.pressure = 1e5, .force = 50};
    answers a;
    answers_open(context, &a, &p, regions);
    check_ok(context, bw_worst_case_run(context, p.system, p.basis, regions, &options, 8, collect,
                                        &a, NULL));
    digest[threads] = a.digest;
    answers_close(&a);
    bw_release(regions);
    part_close(&p);
    assert_true(digest[threads] == digest[1]);
  }
}

static bw_status refuse(void *data, const bw_worst_case_visit *visit) {
  return visit->region == 2 ? bw_fail((bw_context *)data, BW_LIMIT, "enough seen") : BW_OK;
}

static bw_status ignore(void *data, const bw_worst_case_visit *visit) {
  (void)data;
  (void)visit;
  return BW_OK;
}

static void failures(void **state) {
  bw_context *context = check_context(state);
  part p;
  part_open(context, &p, make_bar(context, dumbbell_profile, 6, 2, 1), 2e9);
  bw_weak_regions *regions = NULL;
  const int32_t some[4] = {3, 20, 41, 64};
  check_ok(context, bw_weak_regions_single(context, p.mesh, 4, some, 1, &regions));
  bw_worst_load_options options = {.pressure = 1e5, .force = 50};
  check_fails(
      context, BW_LIMIT, "enough seen",
      bw_worst_case_run(context, p.system, p.basis, regions, &options, 0, refuse, context, NULL));
  options.force = 1e12;
  check_fails(
      context, BW_INFEASIBLE, "raise the pressure",
      bw_worst_case_run(context, p.system, p.basis, regions, &options, 0, ignore, NULL, NULL));
  options.force = 50;
  bw_cancel(context);
  check_fails(
      context, BW_CANCELLED, "",
      bw_worst_case_run(context, p.system, p.basis, regions, &options, 0, ignore, NULL, NULL));
  bw_clear_cancel(context);
  check_ok(context, bw_set_threads(context, 1));
  check_each_allocation(context, status, 20) {
    status =
        bw_worst_case_run(context, p.system, p.basis, regions, &options, 0, ignore, NULL, NULL);
  }
  bw_release(regions);
  part_close(&p);
}

check_main(check_test(pinned_equals_bordered), check_test(invariances), check_test(symmetric_body),
           check_test(slender_bar_is_bent_in_the_middle), check_test(dumbbell_breaks_at_the_neck),
           check_test(constrained_body), check_test(same_bits_for_any_number_of_threads),
           check_test(failures))
