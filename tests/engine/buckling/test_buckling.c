/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* Load factors against dense eigenvalues, closed forms and CalculiX (where `ccx` is there). */
#include "bodies.h"

#include <unistd.h>

#include "barwright/buckling.h"
#include "linear/blas.h"

static const double axis[3][3] = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}};

static bw_static *solved(bw_context *context, const bw_model *model) {
  bw_static *result = NULL;
  check_ok(context, bw_statics(context, model, NULL, NULL, &result));
  return result;
}

static void bend(void *data, const double unit[3], double out[3]) {
  (void)data;
  out[0] = 0.3 * unit[0];
  out[1] = 0.1 * unit[1] + 0.03 * unit[0] * unit[0];
  out[2] = 0.05 * unit[2] + 0.01 * unit[1] * unit[0];
}

/* A stretch u = a x has one stress; v = B x then has v . K_sigma v = volume sigma : B^T B. */
static void uniform_stress(void **state) {
  bw_context *context = check_context(state);
  bw_material *material = body_material(context);
  const double a[9] = {1e-3, 2e-4, 0, 2e-4, -5e-4, 3e-4, 0, 3e-4, 7e-4};
  const double b[9] = {0.3, -1, 0.2, 0.5, 0.1, 0.9, -0.4, 0.6, 0.8};
  double strain[6] = {a[0], a[4], a[8], 2 * a[5], 2 * a[2], 2 * a[1]}, s[6] = {0}, expected = 0;
  for (int i = 0; i < 36; i++)
    s[i / 6] += material->elasticity[i] * strain[i % 6];
  const double full[9] = {s[0], s[5], s[4], s[5], s[1], s[3], s[4], s[3], s[2]};
  for (int i = 0; i < 3; i++)
    for (int j = 0; j < 3; j++)
      for (int k = 0; k < 3; k++)
        expected += b[3 * k + i] * full[3 * i + j] * b[3 * k + j];
  for (int which = 0; which < 3; which++) { /* tet4, tet10, curved tet10 */
    const int cells[3] = {3, 2, 2};
    bw_mesh *mesh = NULL;
    bw_model *model = NULL;
    bw_block_pattern *pattern = NULL;
    check_ok(context, bw_mesh_mapped_box(context, cells, which ? 2 : 1, bend, NULL, &mesh));
    if (which == 1) {
      bw_release(mesh);
      mesh = body_box(context, 0.3, 0.1, 0.05, 3, 2, 2, 2);
    }
    int64_t size = 3 * (int64_t)mesh->node_count;
    double *u = numbers(size), *v = numbers(size), *y = numbers(size), sum = 0, volume = 0;
    for (int64_t i = 0; i < size; i++)
      for (int k = 0; k < 3; k++) {
        u[i] += a[3 * (i % 3) + k] * mesh->node[i - i % 3 + k];
        v[i] += b[3 * (i % 3) + k] * mesh->node[i - i % 3 + k];
      }
    check_ok(context, bw_model_create(context, mesh, material, &model));
    check_ok(context, bw_block_pattern_create(context, mesh, &pattern));
    double *values = numbers(pattern->block_count), *mass = numbers(pattern->block_count);
    check_ok(context, bw_stress_stiffness(context, pattern, model, u, values));
    check_ok(context, bw_mass(context, pattern, mesh, NULL, mass));
    check_ok(context, bw_block_multiply(context, pattern, values, 1, 3, 1, v, y));
    for (int64_t i = 0; i < size; i++)
      sum += v[i] * y[i];
    for (int64_t i = 0; i < size; i++)
      v[i] = i % 3 == 0;
    check_ok(context, bw_block_multiply(context, pattern, mass, 1, 3, 1, v, y));
    for (int64_t i = 0; i < size; i += 3)
      volume += y[i];
    check_near(sum, volume * expected, 1e-10 * fabs(volume * expected));
    free(u);
    free(v);
    free(y);
    free(values);
    free(mass);
    bw_release(pattern);
    bw_release(model);
    bw_release(mesh);
  }
  bw_release(material);
}

/* gradient . u = x . K_sigma(u) y, and work = x . K y, of every kind of element. */
static void gradient_of_stress_stiffness(void **state) {
  bw_context *context = check_context(state);
  for (int which = 0; which < 4; which++) { /* tet4, tet10, curved tet10, B-bar tet10 */
    const int cells[3] = {3, 2, 2};
    bw_material *material = body_material(context);
    bw_mesh *mesh = NULL;
    bw_model *model = NULL;
    bw_block_pattern *pattern = NULL;
    bw_random random;
    bw_random_seed(&random, 5);
    if (which == 3) {
      bw_material *standard = material;
      check_ok(context, bw_material_formulated(context, standard, BW_B_BAR, &material));
      bw_release(standard);
    }
    if (which % 2)
      mesh = body_box(context, 0.3, 0.1, 0.05, 3, 2, 2, 2);
    else
      check_ok(context, bw_mesh_mapped_box(context, cells, which ? 2 : 1, bend, NULL, &mesh));
    int64_t size = 3 * (int64_t)mesh->node_count;
    double *u = numbers(size), *x = numbers(size), *y = numbers(size), *product = numbers(size);
    double *gradient = numbers(size), work, linear = 0, expected = 0, energy = 0;
    for (int64_t i = 0; i < size; i++) {
      u[i] = bw_random_normal(&random);
      x[i] = bw_random_normal(&random);
      y[i] = bw_random_normal(&random);
    }
    check_ok(context, bw_model_create(context, mesh, material, &model));
    check_ok(context, bw_block_pattern_create(context, mesh, &pattern));
    double *values = numbers(pattern->block_count), *stiffness = numbers(9 * pattern->block_count);
    check_ok(context, bw_stress_stiffness(context, pattern, model, u, values));
    check_ok(context, bw_stress_stiffness_gradient(context, mesh, material, x, y, gradient, &work));
    check_ok(context, bw_block_multiply(context, pattern, values, 1, 3, 1, y, product));
    for (int64_t i = 0; i < size; i++) {
      linear += gradient[i] * u[i];
      expected += x[i] * product[i];
    }
    check_ok(context, bw_stiffness(context, pattern, mesh, material, stiffness));
    check_ok(context, bw_block_multiply(context, pattern, stiffness, 9, 3, 1, y, product));
    for (int64_t i = 0; i < size; i++)
      energy += x[i] * product[i];
    check_near(linear, expected, 1e-11 * fabs(expected));
    check_near(work, energy, 1e-11 * fabs(energy));
    free(u);
    free(x);
    free(y);
    free(product);
    free(gradient);
    free(values);
    free(stiffness);
    bw_release(pattern);
    bw_release(model);
    bw_release(mesh);
    bw_release(material);
  }
}

static bw_buckling *buckled(bw_context *context, const bw_static *solution, int count,
                            bw_buckling_sign sign, bw_eigensolver_kind kind) {
  bw_buckling_options options;
  bw_buckling *buckling = NULL;
  bw_eigensolver *solver = NULL;
  bw_eigensolver_options how;
  bw_eigensolver_options_default(&how);
  how.kind = kind;
  check_ok(context, bw_eigensolver_create(context, &how, &solver));
  bw_buckling_options_default(&options);
  options.count = count;
  options.sign = sign;
  options.solver = solver;
  check_ok(context, bw_buckling_of_static(context, solution, &options, &buckling));
  bw_release(solver);
  return buckling;
}

/* All factors of a small bar by dense eigenvalues, the largest in size first in mu. */
static double *dense_mu(bw_context *context, const bw_static *solution, int *count) {
  const bw_system *system = solution->system;
  const bw_dof_map *map = system->dof_map;
  int size = 3 * system->mesh->node_count, n = map->unknown_count, kind = 1, info;
  int length = 10 * n;
  double *stress = numbers(system->pattern->block_count), *column = numbers(size);
  double *product = numbers(size), *k = numbers((int64_t)n * n), *s = numbers((int64_t)n * n);
  double *mu = numbers(n), *work = numbers(length);
  check_ok(context, bw_stress_stiffness(context, system->pattern, solution->model,
                                        solution->displacement, stress));
  for (int j = 0; j < size; j++) {
    if (map->unknown[j] < 0)
      continue;
    memset(column, 0, (size_t)size * sizeof(double));
    column[j] = 1;
    for (int which = 0; which < 2; which++) {
      check_ok(context,
               bw_block_multiply(context, system->pattern, which ? stress : system->stiffness,
                                 which ? 1 : 9, 3, 1, column, product));
      for (int i = 0; i < size; i++)
        if (map->unknown[i] >= 0)
          (which ? s : k)[map->unknown[i] + (int64_t)map->unknown[j] * n] = product[i];
    }
  }
  dsygv_(&kind, "N", "L", &n, s, &n, k, &n, mu, work, &length, &info);
  assert_int_equal(info, 0);
  for (int i = 0; i < n; i++)
    mu[i] = -mu[i];
  for (int i = 1; i < n; i++) /* by size */
    for (int j = i; j > 0 && fabs(mu[j]) > fabs(mu[j - 1]); j--) {
      double held = mu[j];
      mu[j] = mu[j - 1];
      mu[j - 1] = held;
    }
  free(stress);
  free(column);
  free(product);
  free(k);
  free(s);
  free(work);
  *count = n;
  return mu;
}

static void against_dense(void **state) {
  bw_context *context = check_context(state);
  const double force[3] = {-1e3, 2e3, 1e3};
  for (int order = 1; order <= 2; order++) {
    bw_mesh *mesh = body_box(context, 0.3, 0.1, 0.05, 3, 1, 1, order);
    bw_model *model = body_bar(context, mesh, 0.3, force);
    bw_static *solution = solved(context, model);
    int n;
    double *mu = dense_mu(context, solution, &n);
    static const bw_eigensolver_kind kinds[] = {BW_EIGENSOLVER_LANCZOS, BW_EIGENSOLVER_ARPACK,
                                                BW_EIGENSOLVER_LOBPCG};
    for (int which = 0; which < 3; which++)
      for (int sign = 0; sign < 3; sign++) {
        bw_buckling *b = buckled(context, solution, 6, (bw_buckling_sign)sign, kinds[which]);
        assert_int_equal(b->count, 6);
        assert_true(b->counted);
        for (int k = 0, i = 0; k < 6; k++, i++) {
          while (i < n && ((sign == BW_BUCKLING_POSITIVE && mu[i] < 0) ||
                           (sign == BW_BUCKLING_NEGATIVE && mu[i] > 0)))
            i++;
          check_near(b->factor[k] * mu[i], 1, 1e-7);
          assert_true(fabs(b->factor[k] - 1 / mu[i]) <= b->error[k] + 1e-10 * fabs(b->factor[k]));
          assert_true(b->error[k] < 1e-5 * fabs(b->factor[k]));
          assert_true(fabs(b->factor[k]) <= b->searched * (1 + 1e-9));
        }
        bw_release(b);
      }
    free(mu);
    bw_release(solution);
    bw_release(model);
    bw_release(mesh);
  }
}

/* Clamped and free: P = pi^2 E I / (4 L^2), less what shear takes. The two planes of a square
 * section have one factor. */
static void euler_column(void **state) {
  bw_context *context = check_context(state);
  const double length = 1, side = 0.05, force[3] = {-1, 0, 0}, young = 200e9;
  bw_mesh *mesh = body_box(context, length, side, side, 32, 2, 2, 2);
  bw_model *model = body_bar(context, mesh, length, force);
  bw_static *solution = solved(context, model);
  bw_buckling *b = buckled(context, solution, 2, BW_BUCKLING_EITHER, BW_EIGENSOLVER_AUTO);
  double euler = M_PI * M_PI * young * pow(side, 4) / 12 / (4 * length * length);
  double exact = euler / (1 + euler / (5.0 / 6 * young / 2.6 * side * side));
  assert_int_equal(b->count, 2);
  check_near(b->factor[0] / exact, 1, 5e-3);
  check_near(b->factor[1] / exact, 1, 5e-3);
  double relative[2], largest = 0;
  check_ok(context, bw_buckling_error(context, b, relative));
  assert_true(relative[0] > 1e-7 && relative[0] < 1e-2);
  for (int64_t i = 0; i < mesh->node_count; i++)
    largest =
        fmax(largest, hypot(hypot(b->shape[3 * i], b->shape[3 * i + 1]), b->shape[3 * i + 2]));
  check_near(largest, 1, 1e-12);
  bw_release(b);
  bw_release(solution);
  bw_release(model);
  bw_release(mesh);
}

/* A strip under a transverse force buckles alike under the reversed one: factors come in pairs of
 * both signs, and each shape belongs to one of them. */
static void both_signs(void **state) {
  bw_context *context = check_context(state);
  const double force[3] = {0, -1, 0};
  bw_mesh *mesh = body_box(context, 0.5, 0.05, 0.004, 16, 2, 1, 2);
  bw_model *model = body_bar(context, mesh, 0.5, force);
  bw_static *solution = solved(context, model);
  for (int count = 1; count <= 4; count++) {
    bw_buckling *b = buckled(context, solution, count, BW_BUCKLING_EITHER, BW_EIGENSOLVER_AUTO);
    assert_int_equal(b->count, count);
    assert_true(b->counted);
    for (int k = 0; k < count; k++) {
      assert_int_equal(b->factor[k] > 0, k % 2 == 0);
      assert_true(b->error[k] < 1e-5 * fabs(b->factor[k]));
    }
    if (count > 1) /* the mesh is not quite symmetric */
      check_near(b->factor[0] / b->factor[1], -1, 1e-2);
    bw_release(b);
  }
  bw_release(solution);
  bw_release(model);
  bw_release(mesh);
}

/* Twice the load halves the factors; the reversed load changes their signs. */
static void scales_with_the_load(void **state) {
  bw_context *context = check_context(state);
  double factor[3];
  static const double times[3] = {1, 2, -1};
  bw_mesh *mesh = body_box(context, 0.3, 0.05, 0.02, 6, 1, 1, 2);
  for (int k = 0; k < 3; k++) {
    const double force[3] = {-1e-3 * times[k], 0, 0};
    bw_model *model = body_bar(context, mesh, 0.3, force);
    bw_static *solution = solved(context, model);
    bw_buckling *b = buckled(context, solution, 1, BW_BUCKLING_EITHER, BW_EIGENSOLVER_AUTO);
    factor[k] = b->factor[0];
    bw_release(b);
    bw_release(solution);
    bw_release(model);
  }
  assert_true(factor[0] > 0);
  check_near(factor[1], factor[0] / 2, 1e-7 * factor[0]);
  check_near(factor[2], -factor[0], 1e-7 * factor[0]);
  bw_release(mesh);
}

/* Pure tension on sliding planes: there is no positive factor, and the count shows it. */
static void no_compression(void **state) {
  bw_context *context = check_context(state);
  bw_mesh *mesh = body_box(context, 0.4, 0.05, 0.05, 8, 1, 1, 2);
  bw_material *material = body_material(context);
  bw_model *model = NULL;
  const double traction[3] = {1e6, 0, 0};
  check_ok(context, bw_model_create(context, mesh, material, &model));
  for (int k = 0; k < 3; k++) {
    bw_selection *face = body_face(context, mesh, k, 0);
    check_ok(context, bw_model_slide(context, model, face, axis[k]));
    bw_release(face);
  }
  bw_selection *end = body_face(context, mesh, 0, 0.4);
  check_ok(context, bw_model_traction(context, model, end, traction));
  bw_static *solution = solved(context, model);
  bw_buckling *b = buckled(context, solution, 2, BW_BUCKLING_POSITIVE, BW_EIGENSOLVER_AUTO);
  assert_int_equal(b->count, 0);
  assert_true(b->counted);
  bw_buckling *reversed = buckled(context, solution, 2, BW_BUCKLING_NEGATIVE, BW_EIGENSOLVER_AUTO);
  assert_int_equal(reversed->count, 2);
  assert_true(reversed->factor[0] < 0);
  check_near(b->searched, -1000 * reversed->factor[0], 1e-3 * b->searched);
  bw_release(b);
  bw_release(reversed);
  bw_release(end);
  bw_release(solution);
  bw_release(model);
  bw_release(material);
  bw_release(mesh);
}

/* A bar that is heated between walls carries -E alpha dT, free of displacement along it. */
static void heated_between_walls(void **state) {
  bw_context *context = check_context(state);
  const double length = 1, side = 0.04, alpha = 12e-6, force[3] = {0, 0, 0};
  bw_mesh *mesh = body_box(context, length, side, side, 20, 1, 1, 2);
  bw_model *model = body_bar(context, mesh, length, force);
  bw_array *warmer = NULL;
  bw_selection *end = body_face(context, mesh, 0, length);
  bw_model_clear_loads(model);
  check_ok(context, bw_model_fix(context, model, end));
  check_ok(context, bw_array_create(context, BW_F64, mesh->node_count, 1, &warmer));
  for (int32_t i = 0; i < mesh->node_count; i++)
    ((double *)warmer->data)[i] = 1;
  check_ok(context, bw_model_temperature(context, model, warmer, &alpha));
  bw_static *solution = solved(context, model);
  bw_buckling *b = buckled(context, solution, 1, BW_BUCKLING_EITHER, BW_EIGENSOLVER_AUTO);
  double euler = 4 * M_PI * M_PI * pow(side, 2) / 12 / (length * length); /* strain */
  double exact = euler / (1 + euler * 2.6 * 1.2);
  check_near(b->factor[0] * alpha / exact, 1, 1e-2);
  bw_release(b);
  bw_release(solution);
  bw_release(warmer);
  bw_release(end);
  bw_release(model);
  bw_release(mesh);
}

static void same_bits(void **state) {
  bw_context *context = check_context(state);
  const double force[3] = {-1, 2, 0};
  bw_mesh *mesh = body_box(context, 0.3, 0.1, 0.05, 8, 3, 2, 2);
  bw_model *model = body_bar(context, mesh, 0.3, force);
  bw_buckling *b[2];
  for (int k = 0; k < 2; k++) {
    check_ok(context, bw_set_threads(context, k ? 3 : 1));
    bw_static *solution = solved(context, model);
    b[k] = buckled(context, solution, 3, BW_BUCKLING_EITHER, BW_EIGENSOLVER_AUTO);
    bw_release(solution);
  }
  assert_memory_equal(b[0]->factor, b[1]->factor, 3 * sizeof(double));
  assert_memory_equal(b[0]->error, b[1]->error, 3 * sizeof(double));
  assert_memory_equal(b[0]->shape, b[1]->shape, 9 * (size_t)mesh->node_count * sizeof(double));
  bw_release(b[0]);
  bw_release(b[1]);
  bw_release(model);
  bw_release(mesh);
}

static void refused(void **state) {
  bw_context *context = check_context(state);
  const double force[3] = {-1, 0, 0}, gravity[3] = {0, 0, -9.81};
  bw_mesh *mesh = body_box(context, 0.3, 0.1, 0.05, 3, 1, 1, 1);
  bw_model *model = body_bar(context, mesh, 0.3, force);
  bw_static *solution = solved(context, model);
  bw_buckling *b = NULL;
  bw_buckling_options options;
  bw_buckling_options_default(&options);
  options.count = 0;
  check_fails(context, BW_INVALID, "0 load factors",
              bw_buckling_of_static(context, solution, &options, &b));
  options.count = 1;
  options.tolerance = 1;
  check_fails(context, BW_INVALID, "tolerance",
              bw_buckling_of_static(context, solution, &options, &b));
  bw_release(solution);
  /* moved as a whole */
  const bool all[3] = {true, true, true};
  const double shift[3] = {1e-3, 2e-3, 0};
  bw_selection *held = body_face(context, mesh, 0, 0);
  bw_model_clear_supports(model);
  bw_model_clear_loads(model);
  check_ok(context, bw_model_prescribe(context, model, held, all, shift));
  solution = solved(context, model);
  check_fails(context, BW_INVALID, "cause no stress",
              bw_buckling_of_static(context, solution, NULL, &b));
  bw_release(solution);
  /* free, balanced by inertia */
  bw_statics_options relief = {.inertia_relief = true};
  bw_model_clear_supports(model);
  check_ok(context, bw_model_force(context, model, held, force));
  check_ok(context, bw_model_gravity(context, model, gravity));
  check_ok(context, bw_statics(context, model, NULL, &relief, &solution));
  check_fails(context, BW_UNCONSTRAINED, "Add supports",
              bw_buckling_of_static(context, solution, NULL, &b));
  bw_release(solution);
  bw_release(held);
  bw_release(model);
  bw_release(mesh);
}

static void memory_failures(void **state) {
  bw_context *context = check_context(state);
  const double force[3] = {-1, 0, 0};
  bw_mesh *mesh = body_box(context, 0.3, 0.1, 0.05, 3, 1, 1, 1);
  bw_model *model = body_bar(context, mesh, 0.3, force);
  bw_static *solution = solved(context, model);
  bw_buckling *b = NULL;
  check_ok(context, bw_set_threads(context, 1));
  check_allocations(context, b, bw_buckling_of_static(context, solution, NULL, &b));
  bw_pressure_basis *basis = NULL;
  bw_buckling_starts_options options;
  bw_buckling_starts_options_default(&options);
  options.loads = (bw_worst_load_options){.pressure = 1e5, .force = 10};
  options.restarts = 2;
  check_ok(context, bw_pressure_basis_create(context, mesh, NULL, &basis));
  double *pressure = numbers(basis->count), value;
  int found;
  void *none = NULL; /* nothing is made */
  check_allocations(context, none,
                    bw_buckling_starts(context, solution->system, basis, &options, 1,
                                       solution->displacement, 1, &found, pressure, &value, NULL));
  assert_int_equal(found, 1);
  free(pressure);
  bw_release(basis);
  bw_release(solution);
  bw_release(model);
  bw_release(mesh);
}

/* The factors that CalculiX prints for a model's deck with a buckling step; how many. */
static int calculix_factors(bw_context *context, const bw_model *model, int count, double *factor) {
  static const char *const ending[] = {"inp", "dat", "frd", "sta",
                                       "cvg", "12d", "log", "buckle.inp"};
  char stem[200], path[300], command[1000], line[300];
  int found = 0, number;
  double value;
  snprintf(stem, sizeof stem, "/tmp/barwright-buckling-%d", (int)getpid());
  snprintf(path, sizeof path, "%s.inp", stem);
  check_ok(context, bw_model_write_inp(context, model, path, 0));
  snprintf(
      command, sizeof command,
      "sed -i 's/^\\*STATIC.*/*BUCKLE\\n%d, 1e-6/' '%s' && cd /tmp && OMP_NUM_THREADS=1 ccx -i "
      "'%s' > '%s.log' 2>&1",
      count, path, stem, stem);
  assert_int_equal(system(command), 0);
  snprintf(path, sizeof path, "%s.dat", stem);
  FILE *file = fopen(path, "r");
  assert_non_null(file);
  bool here = false;
  while (fgets(line, sizeof line, file) && found < count) {
    here = here || strstr(line, "B U C K L I N G");
    if (here && sscanf(line, "%d %lf", &number, &value) == 2 && number == found + 1)
      factor[found++] = value;
  }
  fclose(file);
  for (size_t i = 0; i < sizeof ending / sizeof *ending; i++) {
    snprintf(path, sizeof path, "%s.%s", stem, ending[i]);
    unlink(path);
  }
  return found;
}

/* Half a tube along x, of radius 0.05 and thickness 0.002. */
static void half_tube(void *data, const double unit[3], double out[3]) {
  double angle = 3.14159265358979323846 * unit[1], radius = 0.049 + 0.002 * unit[2];
  (void)data;
  out[0] = 0.2 * unit[0];
  out[1] = -radius * cos(angle);
  out[2] = radius * sin(angle);
}

/* Straight edges, on which both programs take the same points of quadrature. */
static void straighten(bw_mesh *mesh) {
  for (int64_t e = 0; mesh->order == 2 && e < mesh->element_count; e++)
    for (int m = 0; m < 6; m++) {
      const int32_t *node = mesh->element + 10 * e;
      for (int k = 0; k < 3; k++)
        mesh->node[3 * (int64_t)node[4 + m] + k] =
            0.5 * (mesh->node[3 * (int64_t)node[bw_tet_edge[m][0]] + k] +
                   mesh->node[3 * (int64_t)node[bw_tet_edge[m][1]] + k]);
    }
}

/* CalculiX prints seven digits, of factors of one sign here. */
static void calculix_agrees(void **state) {
  if (system("command -v ccx > /dev/null 2>&1") != 0)
    skip();
  bw_context *context = check_context(state);
  /* a column, a plate and a shell; factors above one, below which CalculiX may skip some */
  const double length[3] = {0.5, 0.2, 0.2};
  const double force[3][3] = {{-1e4, 2e2, 1e2}, {-1e2, 3, 1}, {-1e4, 3e2, 1e2}};
  const int cells[3] = {6, 12, 1};
  for (int body = 0; body < 3; body++)
    for (int order = 1; order <= 2; order++) {
      bw_mesh *mesh = NULL;
      if (body == 2)
        check_ok(context, bw_mesh_mapped_box(context, cells, order, half_tube, NULL, &mesh));
      else
        mesh = body == 0 ? body_box(context, 0.5, 0.05, 0.04, 12, 2, 2, order)
                         : body_box(context, 0.2, 0.15, 0.004, 8, 6, 1, order);
      straighten(mesh);
      bw_model *model = body_bar(context, mesh, length[body], force[body]);
      bw_static *solution = solved(context, model);
      bw_buckling *b = buckled(context, solution, 3, BW_BUCKLING_POSITIVE, BW_EIGENSOLVER_AUTO);
      double factor[3];
      assert_true(b->factor[0] > 1);
      assert_int_equal(calculix_factors(context, model, 3, factor), 3);
      for (int k = 0; k < 3; k++)
        check_near(factor[k] / b->factor[k], 1, 1e-6);
      bw_release(b);
      bw_release(solution);
      bw_release(model);
      bw_release(mesh);
    }
}

int main(void) {
  const struct CMUnitTest tests[] = {
      check_test(uniform_stress),  check_test(gradient_of_stress_stiffness),
      check_test(against_dense),   check_test(euler_column),
      check_test(both_signs),      check_test(scales_with_the_load),
      check_test(no_compression),  check_test(heated_between_walls),
      check_test(same_bits),       check_test(refused),
      check_test(memory_failures), check_test(calculix_agrees)};
  return cmocka_run_group_tests(tests, NULL, NULL);
}
