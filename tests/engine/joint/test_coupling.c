/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* Couplings with remote points: closed forms, balance, CalculiX, and what is refused. */
#include "pair.h"

#include <unistd.h>

#include "barwright/joint.h"

static const double pi = 3.14159265358979323846, young = 200e9;

typedef struct bar {
  bw_mesh *mesh;
  bw_material *material;
  bw_model *model;
  bw_selection *root, *tip;
  double length, width, height;
} bar;

static bw_selection *plane(bw_context *context, const bw_mesh *mesh, int k, double at) {
  bw_selection *on = NULL;
  double point[3] = {0}, normal[3] = {0};
  point[k] = at;
  normal[k] = 1;
  check_ok(context, bw_select_plane(context, mesh, point, normal, 1e-9, &on));
  return on;
}

/* Along x, its axis through the origin: 0 <= x <= length. */
static bar make_bar(bw_context *context, double length, double width, double height,
                    const int cells[3], int order, double poisson) {
  bar b = {.length = length, .width = width, .height = height};
  const double low[3] = {0, -width / 2, -height / 2}, high[3] = {length, width / 2, height / 2};
  const bw_isotropic constants = {
      .name = "test", .young = young, .poisson = poisson, .density = 7800};
  check_ok(context, bw_mesh_box_grid(context, low, high, cells, order, &b.mesh));
  check_ok(context, bw_material_isotropic(context, &constants, &b.material));
  check_ok(context, bw_model_create(context, b.mesh, b.material, &b.model));
  b.root = plane(context, b.mesh, 0, 0);
  b.tip = plane(context, b.mesh, 0, length);
  return b;
}

static void close_bar(bar *b) {
  bw_release(b->root);
  bw_release(b->tip);
  bw_release(b->model);
  bw_release(b->material);
  bw_release(b->mesh);
}

/* The root slides in its plane; the node at the origin is held, and one above it across. */
static void hold_root(bw_context *context, bar *b) {
  const bool along[3] = {true, false, false}, both[3] = {false, true, true},
             across[3] = {false, true, false};
  bw_selection *origin = NULL, *above = NULL;
  const double zero[3] = {0}, up[3] = {0, 0, b->height / 2};
  check_ok(context, bw_select_nearest(context, b->mesh, zero, 1, &origin));
  check_ok(context, bw_select_nearest(context, b->mesh, up, 1, &above));
  check_ok(context, bw_model_prescribe(context, b->model, b->root, along, NULL));
  check_ok(context, bw_model_prescribe(context, b->model, origin, both, NULL));
  check_ok(context, bw_model_prescribe(context, b->model, above, across, NULL));
  bw_release(origin);
  bw_release(above);
}

static bw_static *solve(bw_context *context, const bar *b) {
  bw_static *result = NULL;
  check_ok(context, bw_joined_statics(context, b->model, NULL, &result));
  return result;
}

static void near_field(const bw_static *result, void (*exact)(const double x[3], double u[3]),
                       double tolerance) {
  const bw_mesh *mesh = result->model->mesh;
  double largest = 0, worst = 0;
  for (int32_t i = 0; i < mesh->node_count; i++) {
    double u[3];
    exact(mesh->node + 3 * (size_t)i, u);
    for (int k = 0; k < 3; k++) {
      largest = fmax(largest, fabs(u[k]));
      worst = fmax(worst, fabs(u[k] - result->displacement[3 * (size_t)i + (size_t)k]));
    }
  }
  check_near(worst / largest, 0, tolerance);
}

/* A moment of 500 N m about y bends a bar of 1 x 0.1 x 0.2 m: the exact field, also with Poisson's
 * ratio where the face can deform. */
static double bent_poisson;
static double bent_curvature(void) {
  return 500 / (young * 0.1 * 0.2 * 0.2 * 0.2 / 12);
}
static void bent(const double x[3], double u[3]) {
  double c = bent_curvature(), v = bent_poisson;
  u[0] = c * x[0] * x[2];
  u[1] = -v * c * x[1] * x[2];
  u[2] = -c / 2 * (x[0] * x[0] + v * (x[2] * x[2] - x[1] * x[1]));
}

static void a_moment_bends(void **state) {
  bw_context *context = check_context(state);
  for (int kind = BW_RIGID; kind <= BW_DISTRIBUTED; kind++) {
    bent_poisson = kind == BW_RIGID ? 0 : 0.3;
    bar b = make_bar(context, 1, 0.1, 0.2, (int[3]){4, 2, 2}, 2, bent_poisson);
    /* about another place than the centre: a moment is the same there */
    bw_remote_point point = {
        .kind = (bw_coupling_kind)kind, .at = {1.2, 0, 0}, .load = {0, 0, 0, 0, 500, 0}};
    hold_root(context, &b);
    check_ok(context, bw_model_couple(context, b.model, b.tip, &point));
    bw_static *result = solve(context, &b);
    const bw_coupling_result *q = result->coupling;
    double c = bent_curvature();
    double mean = -c / 2 * (1 + bent_poisson * (0.2 * 0.2 - 0.1 * 0.1) / 12);
    near_field(result, bent, 1e-8);
    check_near(q->displacement[4], c, 1e-8 * c);
    check_near(q->displacement[2], mean - 0.2 * c, 1e-8 * c);
    check_near(q->load[4], 500, 1e-6);
    for (int k = 0; k < 6; k++)
      check_near(q->reaction[k], 0, 0);
    bw_release(result);
    close_bar(&b);
  }
}

/* A distributed force gives constant stress with Poisson's contraction, whatever the mesh order. */
static void pulled(const double x[3], double u[3]) {
  double strain = 1e5 / (0.1 * 0.2) / young;
  u[0] = strain * x[0];
  u[1] = -0.3 * strain * x[1];
  u[2] = -0.3 * strain * x[2];
}

static void a_force_stretches(void **state) {
  bw_context *context = check_context(state);
  for (int order = 1; order <= 2; order++)
    for (int prescribed = 0; prescribed < 2; prescribed++) {
      bar b = make_bar(context, 1, 0.1, 0.2, (int[3]){4, 2, 2}, order, 0.3);
      bw_remote_point point = {.kind = BW_DISTRIBUTED, .at = {1, 0, 0}};
      double stretch = 1e5 / (0.1 * 0.2) / young;
      hold_root(context, &b);
      point.fixed[0] = prescribed;
      *(prescribed ? &point.displacement[0] : &point.load[0]) = prescribed ? stretch : 1e5;
      check_ok(context, bw_model_couple(context, b.model, b.tip, &point));
      bw_static *result = solve(context, &b);
      near_field(result, pulled, 1e-9);
      check_near(result->coupling->displacement[0], stretch, 1e-9 * stretch);
      check_near(result->coupling->load[0], 1e5, 1e-4);
      check_near(result->coupling->reaction[0], prescribed ? 1e5 : 0, prescribed ? 1e-4 : 0);
      bw_release(result);
      close_bar(&b);
    }
}

/* Sums of what supports exert, about the origin. */
static void sum_reactions(const bw_static *result, double sum[6]) {
  const bw_mesh *mesh = result->model->mesh;
  memset(sum, 0, 6 * sizeof *sum);
  for (int32_t i = 0; i < mesh->node_count; i++) {
    double moment[3];
    bw_cross(mesh->node + 3 * (size_t)i, result->reaction + 3 * (size_t)i, moment);
    for (int k = 0; k < 3; k++) {
      sum[k] += result->reaction[3 * (size_t)i + (size_t)k];
      sum[3 + k] += moment[k];
    }
  }
}

/* A load off the face is a force and a moment at its centre; supports balance it, and in part the
 * springs of the point. */
static void loads_are_balanced(void **state) {
  bw_context *context = check_context(state);
  const double far[3] = {1.7, 0.4, -0.3}, centre[3] = {1, 0, 0};
  for (int kind = BW_RIGID; kind <= BW_DISTRIBUTED; kind++)
    for (int springs = 0; springs < 2; springs++) {
      bw_static *result[2];
      bar b[2];
      bw_remote_point point = {.kind = (bw_coupling_kind)kind,
                               .load = {3e3, -2e3, 1e3, 100, 250, -70}};
      for (int i = 0; i < 2; i++) {
        b[i] = make_bar(context, 1, 0.1, 0.2, (int[3]){4, 2, 3}, 2, 0.3);
        check_ok(context, bw_model_fix(context, b[i].model, b[i].root));
        memcpy(point.at, i ? centre : far, sizeof far);
        if (i) {
          double arm[3] = {0.7, 0.4, -0.3}, moment[3];
          bw_cross(arm, point.load, moment);
          for (int k = 0; k < 3; k++)
            point.load[3 + k] += moment[k];
        } else if (springs)
          for (int k = 0; k < 6; k++)
            point.spring[k] = k < 3 ? 1e7 * (k + 1) : 2e5;
        check_ok(context, bw_model_couple(context, b[i].model, b[i].tip, &point));
        memset(point.spring, 0, sizeof point.spring);
        result[i] = solve(context, &b[i]);
        double sum[6], moment[3], size = 1e4;
        const double *load = result[i]->coupling->load;
        sum_reactions(result[i], sum);
        bw_cross(point.at, load, moment);
        for (int k = 0; k < 3; k++) {
          check_near(sum[k] + load[k], 0, 1e-10 * size * 10);
          check_near(sum[3 + k] + load[3 + k] + moment[k], 0, 1e-10 * size * 10);
        }
        for (int k = 0; k < 6 && springs && i == 0; k++) {
          double stiffness = k < 3 ? 1e7 * (k + 1) : 2e5;
          check_near(load[k],
                     b[i].model->coupling->point.load[k] -
                         stiffness * result[i]->coupling->displacement[k],
                     1e-6);
        }
      }
      for (int32_t i = 0; i < 3 * b[0].mesh->node_count && !springs; i++)
        check_near(result[0]->displacement[i], result[1]->displacement[i], 1e-12);
      for (int i = 0; i < 2; i++) {
        bw_release(result[i]);
        close_bar(&b[i]);
      }
    }
}

/* A point with prescribed values alone moves a body as a rigid one, without a force. */
static void a_point_moves_a_body(void **state) {
  bw_context *context = check_context(state);
  for (int kind = BW_RIGID; kind <= BW_DISTRIBUTED; kind++)
    for (int order = 1; order <= 2; order++) {
      bar b = make_bar(context, 1, 0.1, 0.2, (int[3]){3, 2, 2}, order, 0.3);
      bw_remote_point point = {.kind = (bw_coupling_kind)kind,
                               .at = {1.1, 0.3, 0.2},
                               .fixed = {true, true, true, true, true, true},
                               .displacement = {1e-3, -2e-3, 3e-3, 1e-2, -5e-3, 2e-3}};
      check_ok(context, bw_model_couple(context, b.model, b.tip, &point));
      bw_static *result = solve(context, &b);
      for (int32_t i = 0; i < b.mesh->node_count; i++) {
        const double *x = b.mesh->node + 3 * (size_t)i;
        double turn[3];
        bw_cross(point.displacement + 3, (double[3]){x[0] - 1.1, x[1] - 0.3, x[2] - 0.2}, turn);
        for (int k = 0; k < 3; k++)
          check_near(result->displacement[3 * (size_t)i + (size_t)k],
                     point.displacement[k] + turn[k], 1e-11);
      }
      for (int k = 0; k < 6; k++) {
        check_near(result->coupling->displacement[k], point.displacement[k], 1e-11);
        check_near(result->coupling->reaction[k], 0, 2);
      }
      bw_release(result);
      close_bar(&b);
    }
}

/* Bent and pulled by prescribed motion of all components: the reactions that a load would have. */
static void reactions_are_loads(void **state) {
  bw_context *context = check_context(state);
  for (int kind = BW_RIGID; kind <= BW_DISTRIBUTED; kind++) {
    const double load[6] = {5e3, -300, 700, 40, -90, 60};
    bw_remote_point point = {.kind = (bw_coupling_kind)kind, .at = {1.2, 0.1, 0}};
    bar b = make_bar(context, 1, 0.1, 0.2, (int[3]){4, 2, 3}, 2, 0.3);
    check_ok(context, bw_model_fix(context, b.model, b.root));
    memcpy(point.load, load, sizeof load);
    check_ok(context, bw_model_couple(context, b.model, b.tip, &point));
    bw_static *first = solve(context, &b);
    check_ok(context, bw_model_clear_couplings(context, b.model));
    memset(point.load, 0, sizeof point.load);
    point.load[2] = 200; /* is a part of what moves it */
    for (int k = 0; k < 6; k++)
      point.fixed[k] = true;
    memcpy(point.displacement, first->coupling->displacement, sizeof point.displacement);
    check_ok(context, bw_model_couple(context, b.model, b.tip, &point));
    bw_static *second = solve(context, &b);
    for (int k = 0; k < 6; k++) {
      check_near(second->coupling->load[k], load[k], 1e-5);
      check_near(second->coupling->reaction[k], load[k] - point.load[k], 1e-5);
    }
    for (int32_t i = 0; i < 3 * b.mesh->node_count; i++)
      check_near(first->displacement[i], second->displacement[i], 1e-12);
    bw_release(first);
    bw_release(second);
    close_bar(&b);
  }
}

/* The lowest root a > 0 of the cantilever with the mass r m at its end, bending. */
static double tip_mass_root(double r) {
  double low = 1e-3, high = 1.8751040687;
  for (int i = 0; i < 100; i++) {
    double a = (low + high) / 2;
    double value = 1 + cos(a) * cosh(a) - r * a * (sin(a) * cosh(a) - cos(a) * sinh(a));
    *(value > 0 ? &low : &high) = a;
  }
  return low;
}

/* A mass on a slender cantilever (Blevins, Formulas for natural frequency and mode shape). */
static void a_mass_slows_a_cantilever(void **state) {
  bw_context *context = check_context(state);
  for (int kind = BW_RIGID; kind <= BW_DISTRIBUTED; kind++) {
    bar b = make_bar(context, 1, 0.03, 0.02, (int[3]){40, 1, 2}, 2, 0);
    double area = 0.03 * 0.02, mass = 7800 * area, inertia = 0.03 * 0.02 * 0.02 * 0.02 / 12;
    bw_remote_point point = {.kind = (bw_coupling_kind)kind, .at = {1, 0, 0}, .mass = 2 * mass};
    bw_modes *modes = NULL;
    bw_modes_options options;
    check_ok(context, bw_model_fix(context, b.model, b.root));
    check_ok(context, bw_model_couple(context, b.model, b.tip, &point));
    bw_modes_options_default(&options);
    options.count = 1;
    check_ok(context, bw_joined_modes(context, b.model, &options, &modes));
    double root = tip_mass_root(2);
    double expected = root * root / (2 * pi) * sqrt(young * inertia / (7800 * area));
    check_near(modes->frequency[0], expected, 1e-3 * expected);
    bw_release(modes);
    close_bar(&b);
  }
}

/* A light body with a heavy mass on six springs: six frequencies of a rigid body. */
static void springs_carry_a_mass(void **state) {
  bw_context *context = check_context(state);
  for (int kind = BW_RIGID; kind <= BW_DISTRIBUTED; kind++) {
    bar b = make_bar(context, 0.1, 0.1, 0.1, (int[3]){2, 2, 2}, 2, 0.3);
    bw_remote_point point = {.kind = (bw_coupling_kind)kind, .at = {0.05, 0, 0}, .mass = 1e5};
    const double turned[9] = {4e3, 1e3, 0, 1e3, 3e3, 0, 0, 0, 6e3};
    double expected[6];
    memcpy(point.inertia, turned, sizeof turned);
    for (int k = 0; k < 6; k++)
      point.spring[k] = k < 3 ? 1e6 * (k + 1) : 7e5;
    double middle = (4e3 + 3e3) / 2, half = sqrt(500. * 500. + 1e3 * 1e3);
    expected[0] = 7e5 / (middle - half);
    expected[1] = 7e5 / (middle + half);
    expected[2] = 7e5 / 6e3;
    for (int k = 0; k < 3; k++)
      expected[3 + k] = 1e6 * (k + 1) / 1e5;
    check_ok(context, bw_model_couple(context, b.model, b.tip, &point));
    check_six(context, b.model, expected, 1e-3);
    close_bar(&b);
  }
}

/* Gravity acts on the mass at its own place. */
static void a_mass_has_weight(void **state) {
  bw_context *context = check_context(state);
  bar b = make_bar(context, 1, 0.1, 0.2, (int[3]){4, 2, 3}, 2, 0.3);
  bw_remote_point point = {.kind = BW_DISTRIBUTED, .at = {1.5, 0, 0}, .mass = 20};
  check_ok(context, bw_model_fix(context, b.model, b.root));
  check_ok(context, bw_model_gravity(context, b.model, (double[3]){0, 0, -10}));
  check_ok(context, bw_model_couple(context, b.model, b.tip, &point));
  bw_static *result = solve(context, &b);
  double sum[6], own = 7800 * 0.1 * 0.2 * 10;
  sum_reactions(result, sum);
  check_near(sum[2], own + 200, 1e-6);
  check_near(sum[4], -own * 0.5 - 200 * 1.5, 1e-6);
  check_near(b.model->load->resultant[2], -own - 200, 1e-8);
  check_near(b.model->load->moment[1], own * 0.5 + 200 * 1.5, 1e-8);
  bw_release(result);
  close_bar(&b);
}

/* A rigid coupling in CalculiX, on the same elements. */
static void calculix_agrees(void **state) {
  bw_context *context = check_context(state);
  const double load[6] = {3e3, -2e3, 1e3, 100, 250, -70}, at[3] = {1.7, 0.4, -0.3};
  if (system("command -v ccx > /dev/null 2>&1") != 0)
    skip();
  bar b = make_bar(context, 1, 0.1, 0.2, (int[3]){4, 2, 3}, 2, 0.3);
  bw_remote_point point = {.kind = BW_RIGID};
  char stem[200], path[300], text[1000], line[300];
  static const char *const ending[] = {"inp", "dat", "frd", "sta", "cvg", "12d", "log"};
  int nodes = b.mesh->node_count, found = 0, node;
  double largest = 0, worst = 0, u[3];
  memcpy(point.load, load, sizeof load);
  memcpy(point.at, at, sizeof at);
  check_ok(context, bw_model_fix(context, b.model, b.root));
  snprintf(stem, sizeof stem, "/tmp/barwright-couple-%d", (int)getpid());
  snprintf(path, sizeof path, "%s.inp", stem);
  check_ok(context, bw_model_write_inp(context, b.model, path, 0));
  check_ok(context, bw_model_couple(context, b.model, b.tip, &point));
  bw_static *result = solve(context, &b);
  snprintf(text, sizeof text, "%s.part", path);
  FILE *file = fopen(path, "r"), *out = fopen(text, "w");
  assert_non_null(file);
  assert_non_null(out);
  while (fgets(line, sizeof line, file)) {
    if (strncmp(line, "*STEP", 5) == 0) {
      fprintf(out, "*NODE, NSET=NREMOTE\n%d, %.17g, %.17g, %.17g\n%d, %.17g, %.17g, %.17g\n",
              nodes + 1, at[0], at[1], at[2], nodes + 2, at[0], at[1], at[2]);
      fprintf(out, "*NSET, NSET=NTIP\n");
      for (int32_t i = 0; i < b.tip->node_count; i++)
        fprintf(out, "%d,\n", b.tip->node[i] + 1);
      fprintf(out, "*RIGID BODY, NSET=NTIP, REF NODE=%d, ROT NODE=%d\n", nodes + 1, nodes + 2);
    }
    if (strncmp(line, "*END STEP", 9) == 0) {
      fprintf(out, "*CLOAD\n");
      for (int k = 0; k < 6; k++)
        fprintf(out, "%d, %d, %.17g\n", nodes + 1 + k / 3, k % 3 + 1, load[k]);
    }
    fputs(line, out);
  }
  fclose(file);
  fclose(out);
  assert_int_equal(rename(text, path), 0);
  snprintf(text, sizeof text, "cd /tmp && OMP_NUM_THREADS=1 ccx -i '%s' > '%s.log' 2>&1", stem,
           stem);
  assert_int_equal(system(text), 0);
  for (int32_t i = 0; i < 3 * nodes; i++)
    largest = fmax(largest, fabs(result->displacement[i]));
  snprintf(path, sizeof path, "%s.dat", stem);
  file = fopen(path, "r");
  assert_non_null(file);
  while (fgets(line, sizeof line, file))
    if (sscanf(line, "%d %lf %lf %lf", &node, &u[0], &u[1], &u[2]) == 4 && node <= nodes) {
      for (int k = 0; k < 3; k++)
        worst = fmax(worst, fabs(u[k] - result->displacement[3 * (node - 1) + k]));
      found++;
    }
  fclose(file);
  assert_int_equal(found, nodes);
  check_near(worst / largest, 0, 1e-6);
  for (size_t i = 0; i < sizeof ending / sizeof *ending; i++) {
    snprintf(path, sizeof path, "%s.%s", stem, ending[i]);
    unlink(path);
  }
  bw_release(result);
  close_bar(&b);
}

/* The nodes of two rigid couplings on one body, and a support that the point fulfils. */
static void supports_that_agree(void **state) {
  bw_context *context = check_context(state);
  bar b = make_bar(context, 1, 0.1, 0.2, (int[3]){4, 2, 2}, 2, 0.3);
  bw_static *result = NULL;
  bw_selection *side = plane(context, b.mesh, 1, -0.05);
  bw_remote_point point = {.kind = BW_RIGID, .at = {1, -0.05, 0}, .load = {0, 0, 1e3}};
  check_ok(context, bw_model_slide(context, b.model, side, (double[3]){0, 1, 0}));
  check_ok(context, bw_model_fix(context, b.model, b.root));
  check_ok(context, bw_model_couple(context, b.model, b.tip, &point));
  check_fails(context, BW_INVALID, "is in a support",
              bw_joined_statics(context, b.model, NULL, &result));
  check_ok(context, bw_model_clear_couplings(context, b.model));
  point.fixed[1] = point.fixed[3] = point.fixed[5] = true; /* symmetric to y */
  check_ok(context, bw_model_couple(context, b.model, b.tip, &point));
  result = solve(context, &b);
  double sum[6];
  sum_reactions(result, sum);
  check_near(sum[2], -1e3, 1e-6);
  check_near(sum[1] + result->coupling->load[1], 0, 1e-6);
  bw_release(result);
  bw_release(side);
  close_bar(&b);
}

static void refuses(void **state) {
  bw_context *context = check_context(state);
  bar b = make_bar(context, 1, 0.1, 0.2, (int[3]){3, 2, 2}, 1, 0.3);
  bw_selection *line = NULL, *side = plane(context, b.mesh, 1, 0.05), *edge = NULL;
  bw_dof_map *dof_map = NULL;
  bw_static *result = NULL;
  bw_modes *modes = NULL;
  bw_remote_point point = {.kind = BW_DISTRIBUTED, .at = {1, 0, 0}};
  bw_remote_point wrong = point;
  wrong.spring[4] = -1;
  check_fails(context, BW_INVALID, "rotational spring",
              bw_model_couple(context, b.model, b.tip, &wrong));
  wrong = point;
  wrong.mass = -1;
  check_fails(context, BW_INVALID, "mass", bw_model_couple(context, b.model, b.tip, &wrong));
  wrong = point;
  wrong.inertia[1] = 1;
  check_fails(context, BW_INVALID, "symmetric", bw_model_couple(context, b.model, b.tip, &wrong));
  wrong = point;
  wrong.load[3] = NAN;
  check_fails(context, BW_INVALID, "moment", bw_model_couple(context, b.model, b.tip, &wrong));
  check_ok(context, bw_select_combine(context, b.tip, side, BW_INTERSECTION, &edge));
  check_ok(context, bw_select_node_set(context, edge, &line));
  check_fails(context, BW_GEOMETRY, "on one line", bw_model_couple(context, b.model, line, &point));
  check_ok(context, bw_model_couple(context, b.model, b.tip, &point));
  check_fails(context, BW_UNSUPPORTED,
              "1 coupling:", bw_dof_map_create(context, b.model, &dof_map));
  check_fails(context, BW_UNCONSTRAINED, "6 rigid-body modes",
              bw_joined_statics(context, b.model, NULL, &result));
  check_ok(context, bw_joined_modes(context, b.model, NULL, &modes));
  assert_int_equal(modes->rigid_count, 6);
  bw_release(modes);
  /* a face that supports hold, and its mean motion prescribed */
  point.fixed[0] = true;
  check_ok(context, bw_model_couple(context, b.model, b.root, &point));
  check_ok(context, bw_model_fix(context, b.model, b.root));
  check_fails(context, BW_INVALID, "over-constrained",
              bw_joined_statics(context, b.model, NULL, &result));
  check_ok(context, bw_model_clear_couplings(context, b.model));
  point.kind = BW_RIGID;
  check_ok(context, bw_model_couple(context, b.model, b.tip, &point));
  check_fails(context, BW_INVALID, "in the rigid coupling 1 already",
              bw_model_couple(context, b.model, side, &point));
  check_ok(context, bw_model_couple(context, b.model, b.root, &point));
  check_fails(context, BW_INVALID, "is in a support",
              bw_joined_statics(context, b.model, NULL, &result));
  bw_release(line);
  bw_release(edge);
  bw_release(side);
  close_bar(&b);
}

/* With each allocation failing in turn. */
static void memory_failures(void **state) {
  bw_context *context = check_context(state);
  bar b = make_bar(context, 1, 0.1, 0.2, (int[3]){1, 1, 1}, 1, 0.3);
  bw_static *result = NULL;
  bw_modes *modes = NULL;
  bw_remote_point point = {.kind = BW_DISTRIBUTED, .at = {1, 0, 0}, .mass = 3};
  for (int64_t n = 1;; n++) {
    bw_fail_allocation(n, true);
    bw_status status = bw_model_couple(context, b.model, b.tip, &point);
    bw_fail_allocation(0, false);
    if (status == BW_OK)
      break;
    assert_int_equal(status, BW_MEMORY);
    bw_clear_failure(context);
  }
  point.kind = BW_RIGID;
  point.spring[0] = point.spring[1] = 1e6;
  point.fixed[2] = point.fixed[3] = point.fixed[4] = point.fixed[5] = true;
  check_ok(context, bw_model_couple(context, b.model, b.root, &point));
  check_ok(context, bw_model_clear_couplings(context, b.model));
  point.kind = BW_DISTRIBUTED;
  check_ok(context, bw_model_couple(context, b.model, b.tip, &point));
  check_allocations(context, result, bw_joined_statics(context, b.model, NULL, &result));
  check_allocations(context, modes, bw_joined_modes(context, b.model, NULL, &modes));
  close_bar(&b);
}

/* Of load factors under the force of a lever. */
static void buckling_memory_failures(void **state) {
  bw_context *context = check_context(state);
  for (int kind = 0; kind < 2; kind++) {
    bar b = make_bar(context, 1, 0.1, 0.2, (const int[3]){3, 1, 1}, 1, 0);
    bw_remote_point point = {.kind = kind ? BW_DISTRIBUTED : BW_RIGID, .at = {1.2, 0.01, 0.1}};
    bw_static *result = NULL;
    bw_buckling *buckling = NULL;
    bw_buckling_options options;
    bw_buckling_options_default(&options);
    options.count = 1;
    point.load[0] = -1;
    check_ok(context, bw_model_fix(context, b.model, b.root));
    check_ok(context, bw_model_couple(context, b.model, b.tip, &point));
    check_ok(context, bw_set_threads(context, 1));
    check_ok(context, bw_joined_statics(context, b.model, NULL, &result));
    check_allocations(context, buckling, bw_joined_buckling(context, result, &options, &buckling));
    bw_release(result);
    close_bar(&b);
  }
}

int main(void) {
  const struct CMUnitTest tests[] = {
      check_test(a_moment_bends),
      check_test(a_force_stretches),
      check_test(loads_are_balanced),
      check_test(a_point_moves_a_body),
      check_test(reactions_are_loads),
      check_test(a_mass_slows_a_cantilever),
      check_test(springs_carry_a_mass),
      check_test(a_mass_has_weight),
      check_test(calculix_agrees),
      check_test(supports_that_agree),
      check_test(refuses),
      check_test(memory_failures),
      check_test(buckling_memory_failures),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
