/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* The pressure basis and the worst-load linear program, without any solve of a body: closed
 * surfaces, balance, enumeration of vertices, the backends against each other, weak duality, random
 * feasible pressures. */
#include "bodies.h"

#include "lp/backends.h"

#include "analysis/load_program.h"

/* A DOF map with nothing but six rigid-body motions about the middle of each body. */
typedef struct free_body {
  bw_dof_map dof_map;
  bw_rigid_mode motion[12];
} free_body;

static void free_all(free_body *body, const bw_mesh *mesh) {
  memset(body, 0, sizeof *body);
  body->dof_map.mesh = mesh;
  body->dof_map.rigid_mode = body->motion;
  for (int32_t c = 0; c < mesh->component_count; c++) {
    double centre[3] = {0, 0, 0}, count = 0;
    for (int32_t i = 0; i < mesh->node_count; i++)
      if (mesh->component[i] == c) {
        for (int k = 0; k < 3; k++)
          centre[k] += mesh->node[3 * i + k];
        count++;
      }
    for (int m = 0; m < 6; m++) {
      bw_rigid_mode *motion = &body->motion[body->dof_map.rigid_mode_count++];
      motion->component = c;
      for (int k = 0; k < 3; k++)
        motion->centre[k] = centre[k] / count;
      (m < 3 ? motion->translation : motion->rotation)[m % 3] = 1;
    }
  }
}

static double motion_dot(const bw_rigid_mode *motion, const bw_mesh *mesh, const double *force) {
  double sum = 0;
  for (int32_t i = 0; i < mesh->node_count; i++) {
    if (mesh->component[i] != motion->component)
      continue;
    double arm[3], u[3];
    for (int k = 0; k < 3; k++)
      arm[k] = mesh->node[3 * i + k] - motion->centre[k];
    bw_cross(motion->rotation, arm, u);
    for (int k = 0; k < 3; k++)
      sum += (u[k] + motion->translation[k]) * force[3 * i + k];
  }
  return sum;
}

/* The largest force or moment about the middle that a pressure leaves. */
static double imbalance(bw_context *context, const free_body *body, const bw_pressure_basis *basis,
                        const double *pressure) {
  const bw_mesh *mesh = basis->mesh;
  double *force = BW_NEW(context, double, 3 * (size_t)mesh->node_count), worst = 0;
  bw_pressure_force(basis, pressure, force);
  for (int32_t m = 0; m < body->dof_map.rigid_mode_count; m++)
    worst = fmax(worst, fabs(motion_dot(&body->motion[m], mesh, force)));
  bw_free(force);
  return worst;
}

static void uniform_pressure_is_balanced(void **state) {
  bw_context *context = check_context(state);
  for (int kind = 0; kind < 8; kind++) {
    bw_mesh *mesh = NULL;
    const int cells[3] = {3, 4, 2};
    bool box = kind % 4 < 2;
    if (box)
      mesh = make_box(context, 1, 2, 0.5, 3, 4, 2, 1 + kind % 4);
    else
      check_ok(context, bw_mesh_mapped_box(context, cells, kind % 4 - 1, bulge, NULL, &mesh));
    bw_pressure_basis *basis = NULL;
    const bw_pressure_options options = {.spacing = kind < 4 ? 0 : 0.17};
    check_ok(context, bw_pressure_basis_create(context, mesh, &options, &basis));
    free_body body;
    free_all(&body, mesh);
    double *p = BW_NEW(context, double, basis->count), area = 0;
    for (int32_t j = 0; j < basis->count; j++) {
      p[j] = 3;
      area += basis->area[j];
    }
    check_near(imbalance(context, &body, basis, p), 0, 3 * area * 1e-14);
    if (box)
      check_near(area, 2 * (1 * 2 + 1 * 0.5 + 2 * 0.5), 1e-13);
    bw_free(p);
    bw_release(basis);
    bw_release(mesh);
  }
}

static void nodal_force(const bw_pressure_basis *basis, int32_t column, double force[3]) {
  memset(force, 0, 3 * sizeof *force);
  for (int64_t k = basis->start[column]; k < basis->start[column + 1]; k++)
    for (int c = 0; c < 3; c++)
      force[c] += basis->coefficient[3 * k + c];
}

/* Over all cells of a face the work on a field of the order of the elements is its integral. */
static void cells_integrate_over_their_facets(void **state) {
  bw_context *context = check_context(state);
  for (int order = 1; order <= 2; order++) {
    bw_mesh *mesh = make_box(context, 1, 1, 1, 2, 3, 2, order);
    const bw_pressure_options options = {.spacing = 0.2}; /* diagonals: 0.60 to 0.71 */
    bw_pressure_basis *basis = NULL;
    check_ok(context, bw_pressure_basis_create(context, mesh, &options, &basis));
    double *q = BW_NEW(context, double, 3 * (size_t)mesh->node_count);
    double *f = BW_NEW(context, double, basis->count), work = 0;
    int64_t parts = 0;
    for (int32_t i = 0; i < mesh->facet_count; i++)
      parts += basis->parts[i] * basis->parts[i];
    assert_int_equal(parts, basis->count);
    assert_true(basis->parts[0] >= 3 && basis->parts[0] <= 4);
    for (int32_t i = 0; i < mesh->node_count; i++) {
      const double *x = mesh->node + 3 * i;
      q[3 * i] = order == 1 ? x[1] + 2 * x[2] : x[1] * x[1] + x[2] * x[1];
      q[3 * i + 1] = q[3 * i + 2] = 0;
    }
    bw_pressure_gradient(basis, q, f);
    for (int32_t j = 0; j < basis->count; j++) {
      double force[3];
      nodal_force(basis, j, force);
      check_near(bw_norm(force), basis->area[j], 1e-15);
      work += force[0] < -0.5 * basis->area[j] ? f[j] : 0; /* on the face x = 1 */
    }
    check_near(work, order == 1 ? -1.5 : -(1.0 / 3 + 1.0 / 4), 1e-13);
    bw_free(q);
    bw_free(f);
    bw_release(basis);
    bw_release(mesh);
  }
}

/* The forces of all cells of a curved facet are those of one cell that covers it. */
static void divided_cells_add_up(void **state) {
  bw_context *context = check_context(state);
  const int cells[3] = {3, 4, 2};
  bw_mesh *mesh = NULL;
  check_ok(context, bw_mesh_mapped_box(context, cells, 2, bulge, NULL, &mesh));
  const bw_pressure_options options = {.spacing = 1e-9}, whole = {.spacing = 100};
  bw_pressure_basis *fine = NULL, *coarse = NULL;
  check_ok(context, bw_pressure_basis_create(context, mesh, &options, &fine));
  check_ok(context, bw_pressure_basis_create(context, mesh, &whole, &coarse));
  assert_int_equal(coarse->count, mesh->facet_count);
  assert_int_equal(fine->count, 256 * (int64_t)mesh->facet_count);
  for (int32_t facet = 0; facet < coarse->count; facet++)
    for (int64_t k = coarse->start[facet]; k < coarse->start[facet + 1]; k++)
      for (int c = 0; c < 3; c++) {
        double sum = 0;
        for (int64_t j = 256 * (int64_t)facet; j < 256 * ((int64_t)facet + 1); j++)
          sum += fine->coefficient[3 * (fine->start[j] + k - coarse->start[facet]) + c];
        check_near(sum, coarse->coefficient[3 * k + c], 1e-14);
      }
  bw_release(fine);
  bw_release(coarse);
  bw_release(mesh);
}

/* Pressure x on the end faces x = 0 and 1 only, so to speak: work of the pressure's forces on a
 * linear displacement field equals the surface integral, by hand for a box. */
static void work_on_a_linear_field(void **state) {
  bw_context *context = check_context(state);
  for (int order = 1; order <= 2; order++) {
    bw_mesh *mesh = make_box(context, 1, 1, 1, 2, 3, 2, order);
    bw_pressure_basis *basis = NULL;
    check_ok(context, bw_pressure_basis_create(context, mesh, NULL, &basis));
    double *p = BW_NEW(context, double, basis->count);
    double *q = BW_NEW(context, double, 3 * (size_t)mesh->node_count);
    double *f = BW_NEW(context, double, basis->count), work = 0;
    double *force = BW_NEW(context, double, 3 * (size_t)mesh->node_count), other = 0;
    for (int32_t j = 0; j < basis->count; j++)
      p[j] = mesh->node[3 * basis->node[j]] + 2 * mesh->node[3 * basis->node[j] + 1];
    for (int32_t i = 0; i < mesh->node_count; i++) {
      const double *x = mesh->node + 3 * i;
      q[3 * i] = x[1];            /* u = (y, */
      q[3 * i + 1] = x[0] + x[2]; /*      x + z, */
      q[3 * i + 2] = 1;           /*      1) */
    }
    bw_pressure_gradient(basis, q, f);
    bw_pressure_force(basis, p, force);
    for (int32_t j = 0; j < basis->count; j++)
      work += f[j] * p[j];
    for (int32_t i = 0; i < 3 * mesh->node_count; i++)
      other += force[i] * q[i];
    /* -integral of p n.u, p = x + 2 y: by the divergence theorem -integral of div(p u), and
     * div(p u) = grad p . u + p div u = y + 2 (x + z): -(1/2 + 2) */
    check_near(work, -2.5, 1e-13);
    check_near(other, work, 1e-13);
    bw_free(p);
    bw_free(q);
    bw_free(f);
    bw_free(force);
    bw_release(basis);
    bw_release(mesh);
  }
}

/* A linear program small enough for every basis to be tried: one row (a constrained body). */
static void agrees_with_a_sorted_fill(void **state) {
  bw_context *context = check_context(state);
  bw_mesh *mesh = make_box(context, 1, 1, 1, 2, 2, 2, 1);
  bw_pressure_basis *basis = NULL;
  check_ok(context, bw_pressure_basis_create(context, mesh, NULL, &basis));
  bw_dof_map fixed = {.mesh = mesh};
  bw_random random;
  bw_random_seed(&random, 7);
  double f[26], p[26], value, dual;
  assert_int_equal(basis->count, 26);
  for (int trial = 0; trial < 20; trial++) {
    bw_worst_load_options options = {.pressure = 2, .force = 0.4 * (trial + 1)};
    for (int j = 0; j < 26; j++)
      f[j] = bw_random_normal(&random);
    check_ok(context,
             bw_worst_loads(context, basis, &fixed, &options, 1, f, p, &value, &dual, NULL));
    /* Fill up to p_max by falling gain per force. */
    double left = options.force, best = 0;
    bool used[26] = {false};
    while (left > 1e-12) {
      int top = -1;
      for (int j = 0; j < 26; j++)
        if (!used[j] && (top < 0 || f[j] / basis->area[j] > f[top] / basis->area[top]))
          top = j;
      used[top] = true;
      double part = fmin(left, 2 * basis->area[top]);
      best += part * f[top] / basis->area[top];
      left -= part;
    }
    check_near(value, best, 1e-12 * fmax(1, fabs(best)));
  }
  bw_release(basis);
  bw_release(mesh);
}

/* One tetrahedron, fixed against turning only in part: all vertices by enumeration. Rows: the three
 * forces and the shares; four pressures. A tetrahedron's balance leaves one free pressure pattern,
 * so use two tetrahedra joined to a bipyramid: five pressures, one degree of freedom. */
static void agrees_with_enumeration(void **state) {
  bw_context *context = check_context(state);
  const double x[15] = {1, 0, 0, -0.5, 0.8, 0, -0.4, -0.9, 0, 0.1, 0, 1, 0, 0.1, -1.3};
  const int32_t e[8] = {0, 1, 2, 3, 0, 2, 1, 4};
  bw_mesh *mesh = NULL;
  check_ok(context, bw_mesh_copy(context, 1, 5, x, 2, e, NULL, &mesh));
  bw_pressure_basis *basis = NULL;
  check_ok(context, bw_pressure_basis_create(context, mesh, NULL, &basis));
  free_body body;
  free_all(&body, mesh);
  body.dof_map.rigid_mode_count = 2; /* forces along x and y only */
  bw_random random;
  bw_random_seed(&random, 3);
  double area = 0;
  for (int j = 0; j < 5; j++)
    area += basis->area[j];
  for (int trial = 0; trial < 50; trial++) {
    bw_worst_load_options options = {.pressure = 1, .force = area * (0.1 + 0.017 * trial)};
    double f[5], p[5], value, dual[3], best = -INFINITY;
    for (int j = 0; j < 5; j++)
      f[j] = bw_random_normal(&random);
    check_ok(context,
             bw_worst_loads(context, basis, &body.dof_map, &options, 1, f, p, &value, dual, NULL));
    /* Rows: force x, force y, total. Three basic columns out of five, two at either bound. */
    double row[3][5];
    for (int j = 0; j < 5; j++) {
      double unit[5] = {0}, force[15];
      unit[j] = 1;
      bw_pressure_force(basis, unit, force);
      row[0][j] = motion_dot(&body.motion[0], mesh, force);
      row[1][j] = motion_dot(&body.motion[1], mesh, force);
      row[2][j] = basis->area[j];
    }
    for (int a = 0; a < 5; a++)
      for (int b = a + 1; b < 5; b++)
        for (int bounds = 0; bounds < 4; bounds++) {
          double m[9], inverse[9], rest[3] = {0, 0, options.force}, q[5];
          int basic[3], k = 0;
          for (int j = 0; j < 5; j++)
            if (j != a && j != b)
              basic[k++] = j;
          q[a] = bounds & 1;
          q[b] = bounds >> 1;
          for (int i = 0; i < 3; i++) {
            rest[i] -= row[i][a] * q[a] + row[i][b] * q[b];
            for (int l = 0; l < 3; l++)
              m[3 * i + l] = row[i][basic[l]];
          }
          if (fabs(bw_inverse3(m, inverse)) < 1e-12)
            continue;
          bool inside = true;
          double total = f[a] * q[a] + f[b] * q[b];
          for (int l = 0; l < 3; l++) {
            double v = bw_dot(inverse + 3 * l, rest);
            inside = inside && v >= -1e-12 && v <= 1 + 1e-12;
            total += f[basic[l]] * v;
          }
          if (inside)
            best = fmax(best, total);
        }
    check_near(value, best, 1e-10);
    /* The multipliers prove it. */
    double bound = dual[2] * options.force;
    for (int j = 0; j < 5; j++)
      bound += fmax(0, f[j] - dual[0] * row[0][j] - dual[1] * row[1][j] - dual[2] * row[2][j]);
    check_near(bound, value, 1e-9);
  }
  bw_release(basis);
  bw_release(mesh);
}

static double smooth_objective(const double x[3], int which) {
  return sin(7 * x[0] + which) * cos(5 * x[1] - which) + x[2] * x[2] - 0.3 * which * x[0] * x[1] +
         0.05 * sin(90 * x[0] + 70 * x[1] + 50 * x[2]);
}

static void backends_agree(void **state) {
  bw_context *context = check_context(state);
  enum { OBJECTIVES = 12 };
  for (int kind = 0; kind < 3; kind++) {
    bw_mesh *mesh = kind == 0   ? make_bar(context, dumbbell_profile, 20, 6, 1)
                    : kind == 1 ? make_bar(context, dumbbell_profile, 10, 4, 2)
                                : make_box(context, 1, 1, 1, 16, 16, 16, 1);
    bw_pressure_basis *basis = NULL;
    check_ok(context, bw_pressure_basis_create(context, mesh, NULL, &basis));
    free_body body;
    free_all(&body, mesh);
    size_t n = (size_t)basis->count;
    double *f = BW_NEW(context, double, n *OBJECTIVES), *p = BW_NEW(context, double, n *OBJECTIVES);
    double *g = BW_NEW(context, double, n *OBJECTIVES);
    bw_lp_solver *glpk = lp_backend(context, 1), *own = lp_backend(context, 0);
    double value[OBJECTIVES], other[OBJECTIVES], dual[7 * OBJECTIVES], area = 0;
    for (size_t j = 0; j < n; j++) {
      area += basis->area[j];
      for (int i = 0; i < OBJECTIVES; i++)
        f[(size_t)i * n + j] =
            basis->area[j] * smooth_objective(mesh->node + 3 * basis->node[j], i);
    }
    for (int tight = 0; tight < 3; tight++) {
      double share[3] = {0.002, 0.1, 0.97};
      bw_worst_load_options options = {.pressure = 1e5, .force = 1e5 * area * share[tight]};
      options.force_is_max = kind == 2 && tight == 1;
      options.lp = own;
      check_ok(context, bw_worst_loads(context, basis, &body.dof_map, &options, OBJECTIVES, f, p,
                                       value, dual, NULL));
      options.lp = glpk;
      check_ok(context, bw_worst_loads(context, basis, &body.dof_map, &options, OBJECTIVES, f, g,
                                       other, NULL, NULL));
      for (int i = 0; i < OBJECTIVES; i++) {
        double total = 0, bound = dual[7 * i + 6] * options.force;
        check_near(value[i], other[i], 1e-8 * fabs(other[i]));
        check_near(imbalance(context, &body, basis, p + (size_t)i * n), 0, 1e-8 * options.force);
        for (size_t j = 0; j < n; j++) {
          assert_true(p[(size_t)i * n + j] >= 0 && p[(size_t)i * n + j] <= options.pressure);
          total += basis->area[j] * p[(size_t)i * n + j];
        }
        if (options.force_is_max)
          assert_true(total <= options.force * (1 + 1e-9));
        else
          check_near(total, options.force, 1e-9 * options.force);
        /* Weak duality in raw terms: what `dual` promises. */
        double *force = BW_NEW(context, double, 3 * (size_t)mesh->node_count);
        double *gradient = BW_NEW(context, double, n);
        memset(force, 0, 24 * (size_t)mesh->node_count);
        for (int32_t k = 0; k < mesh->node_count; k++)
          for (int m = 0; m < 6; m++) {
            double arm[3], u[3];
            for (int c = 0; c < 3; c++)
              arm[c] = mesh->node[3 * k + c] - body.motion[m].centre[c];
            bw_cross(body.motion[m].rotation, arm, u);
            for (int c = 0; c < 3; c++)
              force[3 * k + c] += dual[7 * i + m] * (u[c] + body.motion[m].translation[c]);
          }
        bw_pressure_gradient(basis, force, gradient);
        for (size_t j = 0; j < n; j++)
          bound += options.pressure *
                   fmax(0, f[(size_t)i * n + j] - gradient[j] - dual[7 * i + 6] * basis->area[j]);
        check_near(bound, value[i], 1e-7 * fabs(value[i]));
        bw_free(force);
        bw_free(gradient);
      }
    }
    bw_free(f);
    bw_free(p);
    bw_free(g);
    bw_release(glpk);
    bw_release(own);
    bw_release(basis);
    bw_release(mesh);
  }
}

/* Every attempt of every backend by itself, in the scaled form. */
static void each_attempt_alone(void **state) {
  bw_context *context = check_context(state);
  bw_mesh *mesh = make_box(context, 1, 1, 1, 40, 40, 10, 1);
  bw_pressure_basis *basis = NULL;
  check_ok(context, bw_pressure_basis_create(context, mesh, NULL, &basis));
  free_body body;
  free_all(&body, mesh);
  bw_worst_load_options options = {.pressure = 1, .force = 0.2};
  bwi_load_program *loads = NULL;
  check_ok(context, bwi_load_program_create(context, basis, &body.dof_map, &options, &loads));
  const bwi_linear_program *program = &loads->lp;
  assert_int_equal(program->rows, 7);
  assert_true(program->levels > 1);
  size_t n = (size_t)program->columns;
  double *cost = BW_NEW(context, double, n), *share = BW_NEW(context, double, n), y[7];
  double first[5] = {0};
  bwi_vertex vertex = {BW_NEW(context, int32_t, 7), BW_NEW(context, uint8_t, n), 0};
  for (int b = 0; b < LP_BACKENDS; b++) {
    const bwi_lp_method *method = lp_backends[b];
    void *opened = NULL;
    check_ok(context, method->open(context, program, 0, &opened));
    for (int i = 0; i < 5; i++) {
      for (size_t j = 0; j < n; j++)
        cost[j] = smooth_objective(mesh->node + 3 * basis->node[loads->source[j]], i);
      for (int attempt = 0; attempt < method->attempts; attempt++) {
        double start = bw_seconds();
        check_ok(context, method->solve(context, opened, cost, attempt, &vertex));
        double seconds = bw_seconds() - start;
        bwi_solution solution = {share, y, 0, 0, 0};
        check_ok(context, bwi_linear_program_evaluate(context, program, cost, &vertex, &solution));
        if (getenv("BARWRIGHT_FULL"))
          printf(
              "  %s, attempt %d, %zu columns: %d iterations, %.2f ms, violation %.1e, gap %.1e\n",
              method->name, attempt, n, vertex.iterations, 1e3 * seconds, solution.violation,
              solution.gap);
        assert_true(solution.violation < 1e-9 && solution.gap < 1e-8);
        if (b == 0 && attempt == 0)
          first[i] = solution.value;
        check_near(solution.value, first[i], 1e-9 * fabs(first[i]));
      }
    }
    method->close(opened);
  }
  bw_free(cost);
  bw_free(share);
  bw_free(vertex.basic);
  bw_free(vertex.at_upper);
  bwi_load_program_destroy(loads);
  bw_release(basis);
  bw_release(mesh);
}

/* A regular mesh makes ties between whole rows of columns, on which the dual simplex method cycles
 * unless it perturbs the costs. */
static void ties_of_regular_meshes_are_broken(void **state) {
  bw_context *context = check_context(state);
  for (int cells = 20; cells <= 40; cells += 20) {
    bw_mesh *mesh = make_box(context, 0.1, 0.1, 0.2 / cells, cells, cells, 2, 1);
    bw_pressure_basis *basis = NULL;
    check_ok(context, bw_pressure_basis_create(context, mesh, NULL, &basis));
    free_body body;
    free_all(&body, mesh);
    size_t n = (size_t)basis->count;
    double *f = BW_NEW(context, double, n), *p = BW_NEW(context, double, n), area = 0;
    double *q = BW_NEW(context, double, 3 * (size_t)mesh->node_count);
    for (size_t j = 0; j < n; j++)
      area += basis->area[j];
    for (int i = 1; i <= 9; i++) {
      for (int32_t k = 0; k < mesh->node_count; k++) {
        const double x = 10 * mesh->node[3 * k], y = 10 * mesh->node[3 * k + 1],
                     z = 10 * mesh->node[3 * k + 2];
        q[3 * k] = sin(7 * x + i) * cos(5 * y - i);
        q[3 * k + 1] = z * z - 0.3 * i * x * y;
        q[3 * k + 2] = cos(4 * x * (1 + z) + i);
      }
      bw_pressure_gradient(basis, q, f);
      const double pressed[3] = {0.01, 0.05, 0.3};
      double value[LP_BACKENDS];
      for (int b = 0; b < LP_BACKENDS; b++) {
        bw_lp_solver *solver = lp_backend(context, b);
        bw_worst_load_options options = {.pressure = 1, .lp = solver};
        options.force = pressed[i % 3] * area;
        bw_solver_report report;
        check_ok(context, bw_worst_loads(context, basis, &body.dof_map, &options, 1, f, p,
                                         &value[b], NULL, &report));
        assert_true(report.iterations < 250);
        bw_release(solver);
      }
      check_near(value[0], value[1], 1e-8 * fabs(value[1]));
    }
    bw_free(f);
    bw_free(p);
    bw_free(q);
    bw_release(basis);
    bw_release(mesh);
  }
}

/* Random pressures, brought to balance and total force by moving along the rows, that stay within
 * the bounds: none may beat the optimum. */
static void no_feasible_pressure_beats_the_optimum(void **state) {
  bw_context *context = check_context(state);
  bw_mesh *mesh = make_bar(context, dumbbell_profile, 12, 4, 1);
  bw_pressure_basis *basis = NULL;
  check_ok(context, bw_pressure_basis_create(context, mesh, NULL, &basis));
  free_body body;
  free_all(&body, mesh);
  size_t n = (size_t)basis->count;
  double *row = BW_NEW(context, double, 7 * n), *f = BW_NEW(context, double, n);
  double *p = BW_NEW(context, double, n), *best = BW_NEW(context, double, n), value, area = 0;
  double *force = BW_NEW(context, double, 3 * (size_t)mesh->node_count);
  for (size_t j = 0; j < n; j++) {
    memset(p, 0, n * sizeof *p);
    p[j] = 1;
    bw_pressure_force(basis, p, force);
    for (int m = 0; m < 6; m++)
      row[(size_t)m * n + j] = motion_dot(&body.motion[m], mesh, force);
    row[6 * n + j] = basis->area[j];
    area += basis->area[j];
  }
  bw_worst_load_options options = {.pressure = 1, .force = 0.3 * area};
  bw_random random;
  bw_random_seed(&random, 11);
  int tried = 0;
  for (int trial = 0; trial < 300; trial++) {
    if (trial % 30 == 0) {
      for (size_t j = 0; j < n; j++)
        f[j] = basis->area[j] * bw_random_normal(&random);
      check_ok(context, bw_worst_loads(context, basis, &body.dof_map, &options, 1, f, best, &value,
                                       NULL, NULL));
    }
    /* Half of them near the optimum, where beating it would be easiest. */
    for (size_t j = 0; j < n; j++) {
      double any = bw_random_uniform(&random);
      p[j] = trial % 2 ? any : fmin(1, fmax(0, best[j] + 0.2 * (any - 0.5)));
    }
    for (int round = 0; round < 200; round++) {
      /* One projection onto the rows, then onto the box; alternate. */
      double gram[49] = {0}, rest[7];
      int32_t pivot[7];
      for (int a = 0; a < 7; a++) {
        rest[a] = a == 6 ? options.force : 0;
        for (size_t j = 0; j < n; j++)
          rest[a] -= row[(size_t)a * n + j] * p[j];
        for (int b = 0; b < 7; b++)
          for (size_t j = 0; j < n; j++)
            gram[7 * a + b] += row[(size_t)a * n + j] * row[(size_t)b * n + j];
      }
      assert_true(bwi_dense_factor(7, gram, pivot));
      bwi_dense_solve(7, gram, pivot, rest);
      double outside = 0;
      for (size_t j = 0; j < n; j++) {
        for (int a = 0; a < 7; a++)
          p[j] += row[(size_t)a * n + j] * rest[a];
        outside = fmax(outside, fmax(-p[j], p[j] - 1));
      }
      if (outside <= 1e-9) {
        double total = 0;
        for (size_t j = 0; j < n; j++)
          total += f[j] * p[j];
        assert_true(total <= value + 1e-7 * fabs(value));
        tried++;
        break;
      }
      for (size_t j = 0; j < n; j++)
        p[j] = fmin(1, fmax(0, p[j]));
    }
  }
  assert_true(tried > 100);
  bw_free(row);
  bw_free(f);
  bw_free(p);
  bw_free(best);
  bw_free(force);
  bw_release(basis);
  bw_release(mesh);
}

static void two_bodies_are_balanced_apart(void **state) {
  bw_context *context = check_context(state);
  bw_mesh *one = make_box(context, 1, 1, 1, 3, 3, 3, 1), *mesh = NULL;
  size_t nodes = (size_t)one->node_count, elements = (size_t)one->element_count;
  double *x = BW_NEW(context, double, 6 * nodes);
  int32_t *e = BW_NEW(context, int32_t, 8 * elements);
  for (size_t i = 0; i < 3 * nodes; i++) {
    x[i] = one->node[i];
    x[3 * nodes + i] = one->node[i] + (i % 3 == 0 ? 3 : 0);
  }
  for (size_t i = 0; i < 4 * elements; i++) {
    e[i] = one->element[i];
    e[4 * elements + i] = one->element[i] + (int32_t)nodes;
  }
  check_ok(context, bw_mesh_copy(context, 1, (int64_t)(2 * nodes), x, (int64_t)(2 * elements), e,
                                 NULL, &mesh));
  assert_int_equal(mesh->component_count, 2);
  bw_pressure_basis *basis = NULL;
  check_ok(context, bw_pressure_basis_create(context, mesh, NULL, &basis));
  free_body body;
  free_all(&body, mesh);
  size_t n = (size_t)basis->count;
  double *f = BW_NEW(context, double, n), *p = BW_NEW(context, double, n), value, other = 0;
  /* Gains that would love to push the two bodies together. */
  for (size_t j = 0; j < n; j++) {
    const double *at = mesh->node + 3 * basis->node[j];
    f[j] = basis->area[j] * (fabs(at[0] - 2) + 0.1 * at[1] * at[2]);
  }
  bw_worst_load_options options = {.pressure = 1, .force = 2};
  for (int b = 0; b < LP_BACKENDS; b++) {
    bw_lp_solver *solver = lp_backend(context, b);
    options.lp = solver;
    check_ok(context,
             bw_worst_loads(context, basis, &body.dof_map, &options, 1, f, p, &value, NULL, NULL));
    check_near(imbalance(context, &body, basis, p), 0, 1e-9 * options.force);
    other = b == 0 ? value : other;
    check_near(value, other, 1e-9 * other);
    bw_release(solver);
  }
  bw_free(f);
  bw_free(p);
  bw_free(x);
  bw_free(e);
  bw_release(basis);
  bw_release(mesh);
  bw_release(one);
}

static void bad_options_are_refused(void **state) {
  bw_context *context = check_context(state);
  bw_mesh *mesh = make_box(context, 1, 1, 1, 2, 2, 2, 1);
  bw_pressure_basis *basis = NULL;
  check_ok(context, bw_pressure_basis_create(context, mesh, NULL, &basis));
  free_body body;
  free_all(&body, mesh);
  double f[26] = {0}, p[26], value;
  bw_worst_load_options options = {.pressure = 1, .force = 7};
  check_fails(context, BW_INFEASIBLE, "7 N",
              bw_worst_loads(context, basis, &body.dof_map, &options, 1, f, p, &value, NULL, NULL));
  check_fails(context, BW_INFEASIBLE, "gives 6 N",
              bw_worst_loads(context, basis, &body.dof_map, &options, 1, f, p, &value, NULL, NULL));
  options.force_is_max = true;
  check_ok(context,
           bw_worst_loads(context, basis, &body.dof_map, &options, 1, f, p, &value, NULL, NULL));
  options = (bw_worst_load_options){.pressure = 1, .force = 6};
  check_ok(context,
           bw_worst_loads(context, basis, &body.dof_map, &options, 1, f, p, &value, NULL, NULL));
  for (int j = 0; j < 26; j++)
    check_near(p[j], 1, 1e-9);
  options.force = -1;
  check_fails(context, BW_INVALID, "force",
              bw_worst_loads(context, basis, &body.dof_map, &options, 1, f, p, &value, NULL, NULL));
  options = (bw_worst_load_options){.pressure = NAN, .force = 1};
  check_fails(context, BW_INVALID, "pressure",
              bw_worst_loads(context, basis, &body.dof_map, &options, 1, f, p, &value, NULL, NULL));
  options.pressure = 1;
  f[3] = NAN;
  check_fails(context, BW_INVALID, "objective 1",
              bw_worst_loads(context, basis, &body.dof_map, &options, 1, f, p, &value, NULL, NULL));
  bw_release(basis);
  bw_release(mesh);
}

static void same_bits_for_any_number_of_threads(void **state) {
  bw_context *context = check_context(state);
  enum { OBJECTIVES = 9 };
  bw_mesh *mesh = make_box(context, 1, 1, 0.3, 24, 24, 6, 1);
  bw_pressure_basis *basis = NULL;
  check_ok(context, bw_pressure_basis_create(context, mesh, NULL, &basis));
  free_body body;
  free_all(&body, mesh);
  size_t n = (size_t)basis->count;
  double *f = BW_NEW(context, double, n *OBJECTIVES), value[OBJECTIVES];
  double *p[3] = {NULL, NULL, NULL};
  for (int i = 0; i < OBJECTIVES; i++)
    for (size_t j = 0; j < n; j++)
      f[(size_t)i * n + j] = basis->area[j] * smooth_objective(mesh->node + 3 * basis->node[j], i);
  bw_worst_load_options options = {.pressure = 1, .force = 0.1};
  for (int b = 0; b < LP_BACKENDS; b++) {
    bw_lp_solver *solver = lp_backend(context, b);
    options.lp = solver;
    for (int threads = 1; threads <= 3; threads++) {
      check_ok(context, bw_set_threads(context, threads));
      double *to = p[threads - 1] = BW_NEW(context, double, n *OBJECTIVES);
      check_ok(context, bw_worst_loads(context, basis, &body.dof_map, &options, OBJECTIVES, f, to,
                                       value, NULL, NULL));
      assert_memory_equal(to, p[0], n * OBJECTIVES * sizeof *to);
    }
    for (int threads = 0; threads < 3; threads++)
      bw_free(p[threads]);
    bw_release(solver);
  }
  bw_free(f);
  bw_release(basis);
  bw_release(mesh);
}

static void allocation_failures(void **state) {
  bw_context *context = check_context(state);
  bw_mesh *mesh = make_box(context, 1, 1, 1, 3, 3, 3, 1);
  free_body body;
  free_all(&body, mesh);
  check_ok(context, bw_set_threads(context, 1));
  for (int b = 0; b <= LP_BACKENDS; b++) { /* the last: chosen */
    bw_lp_solver *solver = b < LP_BACKENDS ? lp_backend(context, b) : NULL;
    bw_worst_load_options options = {.pressure = 1, .force = 1, .lp = solver};
    check_each_allocation(context, status, 10) {
      double f[56], p[56], value;
      bw_pressure_basis *basis = NULL;
      for (int j = 0; j < 56; j++)
        f[j] = j % 7;
      status = bw_pressure_basis_create(context, mesh, NULL, &basis);
      if (status == BW_OK)
        status =
            bw_worst_loads(context, basis, &body.dof_map, &options, 1, f, p, &value, NULL, NULL);
      bw_release(basis);
    }
    bw_release(solver);
  }
  bw_release(mesh);
}

check_main(check_test(uniform_pressure_is_balanced), check_test(cells_integrate_over_their_facets),
           check_test(divided_cells_add_up), check_test(work_on_a_linear_field),
           check_test(agrees_with_a_sorted_fill), check_test(agrees_with_enumeration),
           check_test(backends_agree), check_test(each_attempt_alone),
           check_test(ties_of_regular_meshes_are_broken),
           check_test(no_feasible_pressure_beats_the_optimum),
           check_test(two_bodies_are_balanced_apart), check_test(bad_options_are_refused),
           check_test(same_bits_for_any_number_of_threads), check_test(allocation_failures))
