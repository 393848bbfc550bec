/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* Input decks are run by CalculiX itself (skipped where `ccx` is not installed) and the
 * displacements are compared with closed forms that both element types meet exactly: a bar under a
 * uniform end traction, isotropic and orthotropic, and one under its own weight to the digits that
 * the element order gives. */
#include "io_check.h"

static bool ccx_runs(const char *stem) {
  char command[1000];
  char folder[300];
  snprintf(folder, sizeof folder, "%s", stem);
  char *slash = strrchr(folder, '/');
  *slash = 0;
  snprintf(command, sizeof command, "cd '%s' && OMP_NUM_THREADS=1 ccx -i '%s' > '%s.log' 2>&1",
           folder, slash + 1, stem);
  return system(command) == 0;
}

/* Displacements from the .dat file. */
static int read_displacements(const char *stem, int nodes, double *u) {
  char path[400], line[300];
  snprintf(path, sizeof path, "%s.dat", stem);
  FILE *file = fopen(path, "r");
  int found = 0, node;
  double x, y, z;
  while (file && fgets(line, sizeof line, file))
    if (sscanf(line, "%d %lf %lf %lf", &node, &x, &y, &z) == 4 && node >= 1 && node <= nodes) {
      u[3 * node - 3] = x, u[3 * node - 2] = y, u[3 * node - 1] = z;
      found++;
    }
  if (file)
    fclose(file);
  return found;
}

static void remove_all(const char *stem) {
  static const char *const ending[] = {"inp", "dat", "frd", "sta", "cvg", "12d", "log"};
  for (size_t i = 0; i < sizeof ending / sizeof *ending; i++) {
    char path[400];
    snprintf(path, sizeof path, "%s.%s", stem, ending[i]);
    unlink(path);
  }
}

/* Uniform traction on the face x = length of a bar: consistent nodal forces. */
static void end_traction(const bw_mesh *mesh, double length, const double traction[3],
                         double *force) {
  for (int f = 0; f < mesh->facet_count; f++) {
    const int32_t *facet = mesh->facet + f * mesh->nodes_per_facet;
    double a[3], b[3], c[3];
    bool end = true;
    for (int k = 0; k < 3; k++)
      end = end && fabs(mesh->node[3 * facet[k]] - length) < 1e-9;
    if (!end)
      continue;
    for (int k = 0; k < 3; k++) {
      a[k] = mesh->node[3 * facet[1] + k] - mesh->node[3 * facet[0] + k];
      b[k] = mesh->node[3 * facet[2] + k] - mesh->node[3 * facet[0] + k];
    }
    bw_cross(a, b, c);
    double share = bw_norm(c) / 6; /* a third of the area */
    for (int i = 0; i < 3; i++)    /* all on the corners, or all on the mid-edge nodes */
      for (int k = 0; k < 3; k++)
        force[3 * facet[mesh->order == 2 ? 3 + i : i] + k] += share * traction[k];
  }
}

static void bar(bw_context *context, int order, bool isotropic) {
  const double length = 0.2, width = 0.03, young = 70e9, poisson = 0.31, stress = 1e6;
  bw_mesh *mesh;
  check_ok(context,
           bw_mesh_box_grid(context, (double[3]){0, 0, 0}, (double[3]){length, width, width},
                            (int[3]){4, 2, 2}, order, &mesh));
  double *force = calloc((size_t)mesh->node_count * 3, sizeof *force);
  double *u = calloc((size_t)mesh->node_count * 3, sizeof *u);
  int32_t node[400];
  int direction[400], fixed = 0;
  double value[400] = {0};
  end_traction(mesh, length, (double[3]){stress, 0, 0}, force);
  /* symmetry planes: x = 0, y = 0, z = 0 */
  for (int32_t i = 0; i < mesh->node_count; i++)
    for (int k = 0; k < 3; k++)
      if (mesh->node[3 * i + k] == 0) {
        assert_true(fixed < 400);
        node[fixed] = i, direction[fixed++] = k;
      }
  bw_inp_material material = {.isotropic = isotropic, .young = young, .poisson = poisson};
  bw_inp_deck deck = {.mesh = mesh,
                      .title = "bar",
                      .material_count = 1,
                      .material = &material,
                      .fixed_count = fixed,
                      .fixed_node = node,
                      .fixed_direction = direction,
                      .fixed_value = value,
                      .force = force};
  double strain[3] = {stress / young, -poisson * stress / young, -poisson * stress / young};
  if (!isotropic) {
    /* diagonal compliance shears, nu12 != nu13: invert the 3x3 of the normal parts */
    const double y[3] = {70e9, 20e9, 5e9}, nu12 = 0.3, nu13 = 0.25, nu23 = 0.2;
    double s[9] = {1 / y[0],     -nu12 / y[0], -nu13 / y[0], -nu12 / y[0], 1 / y[1],
                   -nu23 / y[1], -nu13 / y[0], -nu23 / y[1], 1 / y[2]};
    double d[9];
    bw_inverse3(s, d);
    double c[21] = {d[0], d[1], d[4], d[2], d[5], d[8]};
    c[9] = 3e9, c[14] = 4e9, c[20] = 5e9;
    memcpy(material.stiffness, c, sizeof c);
    for (int k = 0; k < 3; k++)
      strain[k] = s[3 * k] * stress;
  }
  char stem[300], path[400];
  temporary(stem, "bar");
  snprintf(path, sizeof path, "%s.inp", stem);
  check_ok(context, bw_inp_write(context, &deck, path));
  assert_true(ccx_runs(stem));
  assert_int_equal(read_displacements(stem, mesh->node_count, u), mesh->node_count);
  for (int32_t i = 0; i < mesh->node_count; i++)
    for (int k = 0; k < 3; k++)
      check_near(u[3 * i + k], strain[k] * mesh->node[3 * i + k], 1e-6 * strain[0] * length);
  remove_all(stem);
  free(force);
  free(u);
  bw_release(mesh);
}

static void calculix_bars(void **state) {
  if (system("command -v ccx > /dev/null 2>&1") != 0)
    skip();
  for (int order = 1; order <= 2; order++) {
    bar(check_context(state), order, true);
    bar(check_context(state), order, false);
  }
}

/* A column under its own weight, on a sliding oblique base made of equations with normal (0, 0, 1)
 * turned about y: u . n = 0. The displacement at mid height is that of the closed form
 * u = -rho g (h z - z^2 / 2) / E. Poisson's ratio 0 makes it one-dimensional. */
static void calculix_weight_and_equations(void **state) {
  if (system("command -v ccx > /dev/null 2>&1") != 0)
    skip();
  bw_context *context = check_context(state);
  const double angle = 0.4, h = 1, rho = 2000, g = 9.81, young = 1e8;
  const double axis[3] = {sin(angle), 0, cos(angle)}, across[3] = {cos(angle), 0, -sin(angle)};
  bw_mesh *box, *mesh;
  check_ok(context, bw_mesh_box_grid(context, (double[3]){0, 0, 0}, (double[3]){0.2, 0.2, h},
                                     (int[3]){1, 1, 3}, 2, &box));
  double *x = malloc(sizeof *x * 3 * (size_t)box->node_count);
  double *u = calloc((size_t)box->node_count * 3, sizeof *u);
  int32_t equation_node[200], node[200];
  double normal[600], value[200] = {0};
  int direction[200], fixed = 0, equations = 0;
  for (int32_t i = 0; i < box->node_count; i++) {
    const double *p = box->node + 3 * i;
    for (int k = 0; k < 3; k++)
      x[3 * i + k] = p[0] * across[k] + p[2] * axis[k] + (k == 1 ? p[1] : 0);
    if (p[2] == 0) {
      equation_node[equations] = i;
      memcpy(normal + 3 * equations++, axis, sizeof axis);
    }
    /* hold sideways: y at y = 0 and, by an equation, u . across = 0 at two more nodes would make
       two equations at a node of the base; u_x there does as well, since u . n = 0 too */
    if (p[1] == 0)
      node[fixed] = i, direction[fixed++] = 1;
    if (p[2] == 0 && p[0] == 0)
      node[fixed] = i, direction[fixed++] = 0;
  }
  check_ok(context, bw_mesh_moved(context, box, x, &mesh));
  bw_inp_material material = {.isotropic = true, .young = young, .density = rho};
  bw_inp_deck deck = {.mesh = mesh,
                      .material_count = 1,
                      .material = &material,
                      .gravity = {-g * axis[0], -g * axis[1], -g * axis[2]},
                      .fixed_count = fixed,
                      .fixed_node = node,
                      .fixed_direction = direction,
                      .fixed_value = value,
                      .equation_count = equations,
                      .equation_node = equation_node,
                      .equation_normal = normal};
  char stem[300], path[400];
  temporary(stem, "column");
  snprintf(path, sizeof path, "%s.inp", stem);
  check_ok(context, bw_inp_write(context, &deck, path));
  assert_true(ccx_runs(stem));
  assert_int_equal(read_displacements(stem, mesh->node_count, u), mesh->node_count);
  for (int32_t i = 0; i < mesh->node_count; i++) {
    double z = box->node[3 * i + 2], expected = -rho * g * (h * z - z * z / 2) / young;
    check_near(bw_dot(u + 3 * i, axis), expected, 2e-6 * rho * g * h * h / young);
  }
  deck.modes = 3;
  check_ok(context, bw_inp_write(context, &deck, path));
  assert_true(ccx_runs(stem));
  material.density = 0;
  check_fails(context, BW_INVALID, "needs a density", bw_inp_write(context, &deck, path));
  remove_all(stem);
  free(x);
  free(u);
  bw_release(box);
  bw_release(mesh);
}

/* A bar pulled by a prescribed displacement of its end, sideways free: u = x / length * value. */
static void calculix_prescribed(void **state) {
  if (system("command -v ccx > /dev/null 2>&1") != 0)
    skip();
  bw_context *context = check_context(state);
  bw_mesh *mesh;
  check_ok(context, bw_mesh_box_grid(context, (double[3]){0, 0, 0}, (double[3]){2, 1, 1},
                                     (int[3]){2, 1, 1}, 1, &mesh));
  double *u = calloc((size_t)mesh->node_count * 3, sizeof *u), value[100];
  int32_t node[100];
  int direction[100], fixed = 0;
  const double pulled = -1.23456789012345678e-5;
  for (int32_t i = 0; i < mesh->node_count; i++)
    for (int k = 0; k < 3; k++) {
      bool end = k == 0 && mesh->node[3 * i] == 2;
      if (mesh->node[3 * i + k] != 0 && !end)
        continue;
      node[fixed] = i, direction[fixed] = k, value[fixed++] = end ? pulled : 0;
    }
  bw_inp_material material = {.isotropic = true, .young = 1e9, .poisson = 0.25};
  bw_inp_deck deck = {.mesh = mesh,
                      .title = "*pulled\n*NODE",
                      .material_count = 1,
                      .material = &material,
                      .fixed_count = fixed,
                      .fixed_node = node,
                      .fixed_direction = direction,
                      .fixed_value = value};
  char stem[300], path[400];
  temporary(stem, "pulled");
  snprintf(path, sizeof path, "%s.inp", stem);
  check_ok(context, bw_inp_write(context, &deck, path));
  assert_true(ccx_runs(stem));
  assert_int_equal(read_displacements(stem, mesh->node_count, u), mesh->node_count);
  for (int32_t i = 0; i < mesh->node_count; i++) {
    check_near(u[3 * i], pulled * mesh->node[3 * i] / 2, 1e-6 * fabs(pulled));
    check_near(u[3 * i + 1], -0.25 * pulled / 2 * mesh->node[3 * i + 1], 1e-6 * fabs(pulled));
  }
  node[0] = 9999;
  check_fails(context, BW_INVALID, "fixes node 10000", bw_inp_write(context, &deck, path));
  remove_all(stem);
  free(u);
  bw_release(mesh);
}

check_main(check_test(calculix_bars), check_test(calculix_weight_and_equations),
           check_test(calculix_prescribed))
