/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* A model with everything (oblique slides that meet, prescribed displacement, pressure, torque,
 * gravity, an orthotropic material at an angle) solved here and, from its input deck, by CalculiX:
 * the displacements agree to the seven digits that CalculiX prints, and with temperatures the
 * stresses. Skipped without `ccx`. */
#include "helpers.h"

#include <unistd.h>

static void stretch(void *data, const double unit[3], double out[3]) {
  (void)data;
  out[0] = 2 * unit[0];
  out[1] = 0.5 * unit[1] * (1 + 0.3 * unit[0]);
  out[2] = 0.4 * unit[2] + 0.1 * unit[0] * unit[1];
}

static bw_material *turned_wood(bw_context *context) {
  bw_orthotropic constants = {.name = "turned",
                              .young = {11e9, 0.9e9, 0.5e9},
                              .poisson = {0.5, 0.02, 0.4},
                              .shear = {0.1e9, 0.7e9, 0.65e9},
                              .density = 450};
  double c = cos(0.5), s = sin(0.5);
  double axes[9] = {c, s, 0, -s * c, c * c, s, s * s, -s * c, c};
  memcpy(constants.axes, axes, sizeof axes);
  bw_material *material = NULL;
  check_ok(context, bw_material_orthotropic(context, &constants, &material));
  return material;
}

static void remove_files(const char *stem) {
  static const char *const ending[] = {"inp", "dat", "frd", "sta", "cvg", "12d", "log"};
  char path[300];
  for (size_t i = 0; i < sizeof ending / sizeof *ending; i++) {
    snprintf(path, sizeof path, "%s.%s", stem, ending[i]);
    unlink(path);
  }
}

/* Largest difference of the stresses (S11 S22 S33 S12 S13 S23 at nodes, from the .frd file) over
 * the largest stress. */
static double stress_difference(bw_context *context, const bw_static *result, const char *stem) {
  static const int place[6] = {0, 1, 2, 5, 4, 3}; /* xx yy zz yz zx xy here */
  int32_t nodes = result->model->mesh->node_count, found = 0;
  double *stress = BW_NEW(context, double, 6 * (size_t)nodes), largest = 0, worst = 0;
  char path[300], line[300];
  bool here = false;
  check_ok(context, bw_static_stress(context, result, true, stress));
  snprintf(path, sizeof path, "%s.frd", stem);
  FILE *file = fopen(path, "r");
  assert_non_null(file);
  while (fgets(line, sizeof line, file)) {
    if (strncmp(line, " -4", 3) == 0)
      here = strstr(line, "STRESS") != NULL;
    if (!here || strncmp(line, " -1", 3) != 0)
      continue;
    char field[13] = {0};
    memcpy(field, line + 3, 10);
    int32_t node = atoi(field) - 1;
    assert_true(node >= 0 && node < nodes);
    for (int k = 0; k < 6; k++) {
      memcpy(field, line + 13 + 12 * k, 12);
      double ours = stress[6 * (size_t)node + (size_t)place[k]];
      largest = fmax(largest, fabs(ours));
      worst = fmax(worst, fabs(ours - atof(field)));
    }
    found++;
  }
  fclose(file);
  assert_int_equal(found, nodes);
  bw_free(stress);
  return worst / largest;
}

/* Regions of one material each come back from the deck by their names. */
static void check_regions(bw_context *context, const bw_mesh *mesh, const char *path) {
  bw_mesh_file file;
  check_ok(context, bw_mesh_read(context, path, &file));
  assert_int_equal(file.mesh->region_count, mesh->region_count);
  for (int32_t i = 0; i < mesh->region_count; i++)
    assert_string_equal(file.mesh->regions[i].name.text, mesh->regions[i].name.text);
  if (mesh->region)
    assert_memory_equal(file.mesh->region, mesh->region,
                        (size_t)mesh->element_count * sizeof *mesh->region);
  bw_mesh_file_clear(&file);
}

static void compare(bw_context *context, const bw_model *model, bool stresses) {
  int32_t nodes = model->mesh->node_count, node, found = 0;
  bw_static *result = NULL;
  char stem[200], path[300], command[700], line[300];
  double largest = 0, worst = 0, x, y, z;
  check_ok(context, bw_statics(context, model, NULL, NULL, &result));
  snprintf(stem, sizeof stem, "/tmp/barwright-model-%d", (int)getpid());
  snprintf(path, sizeof path, "%s.inp", stem);
  check_ok(context, bw_model_write_inp(context, model, path, 0));
  check_regions(context, model->mesh, path);
  snprintf(command, sizeof command, "cd /tmp && OMP_NUM_THREADS=1 ccx -i '%s' > '%s.log' 2>&1",
           stem, stem);
  assert_int_equal(system(command), 0);
  for (int32_t i = 0; i < 3 * nodes; i++)
    largest = fmax(largest, fabs(result->displacement[i]));
  snprintf(path, sizeof path, "%s.dat", stem);
  FILE *file = fopen(path, "r");
  assert_non_null(file);
  while (fgets(line, sizeof line, file))
    if (sscanf(line, "%d %lf %lf %lf", &node, &x, &y, &z) == 4 && node >= 1 && node <= nodes) {
      const double *u = result->displacement + 3 * (size_t)(node - 1);
      worst = fmax(worst, fmax(fabs(u[0] - x), fmax(fabs(u[1] - y), fabs(u[2] - z))));
      found++;
    }
  fclose(file);
  assert_int_equal(found, nodes);
  if (stresses)
    check_near(stress_difference(context, result, stem), 0, 2e-5);
  else
    check_near(worst / largest, 0, 1e-6);
  remove_files(stem);
  bw_release(result);
}

static void everything(bw_context *context, int order, bool wood) {
  int cells[3] = {4, 2, 2};
  bw_mesh *corners = NULL, *mesh = NULL;
  bw_model *model = NULL;
  /* straight edges: CalculiX integrates curved C3D10 with fewer points */
  check_ok(context, bw_mesh_mapped_box(context, cells, 1, stretch, NULL, &corners));
  check_ok(context, bw_mesh_with_order(context, corners, order, &mesh));
  bw_release(corners);
  bw_material *material = wood ? turned_wood(context) : some_material(context);
  check_ok(context, bw_model_create(context, mesh, material, &model));
  bw_selection *end = face_of(context, mesh, 0, 0), *far_end = face_of(context, mesh, 0, 2);
  bw_selection *side = face_of(context, mesh, 1, 0), *all = NULL, *top = NULL, *corner = NULL;
  double slope[3] = {1, 0, 0.3}, other[3] = {0.2, 1, 0.2}, g[3] = {1, 2, -9.81}, up[3] = {0, 0, 1};
  double torque[3] = {30, 0, 5}, origin[3] = {0, 0, 0}, pull[3] = {1e-4, 0, 0};
  bool along_z[3] = {false, false, true};
  check_ok(context, bw_select_all(context, mesh, &all));
  check_ok(context, bw_select_normal_cone(context, mesh, up, 0.5, &top));
  check_ok(context, bw_select_nearest(context, mesh, origin, 1, &corner));
  check_ok(context, bw_model_slide(context, model, end, slope));
  check_ok(context, bw_model_slide(context, model, side, other)); /* two at the shared edge */
  check_ok(context, bw_model_prescribe(context, model, corner, along_z, origin));
  check_ok(context, bw_model_pressure(context, model, top, 2e3));
  check_ok(context, bw_model_torque(context, model, far_end, torque, NULL));
  check_ok(context, bw_model_gravity(context, model, g));
  compare(context, model, false);
  /* a moved end instead of the oblique ones */
  bool all_three[3] = {true, true, true};
  bw_model_clear_supports(model);
  check_ok(context, bw_model_fix(context, model, end));
  check_ok(context, bw_model_prescribe(context, model, far_end, all_three, pull));
  compare(context, model, false);
  bw_release(end);
  bw_release(far_end);
  bw_release(side);
  bw_release(all);
  bw_release(top);
  bw_release(corner);
  bw_release(model);
  bw_release(material);
  bw_release(mesh);
}

static void calculix_agrees(void **state) {
  if (system("command -v ccx > /dev/null 2>&1") != 0)
    skip();
  everything(check_context(state), 1, false);
  everything(check_context(state), 2, false);
  everything(check_context(state), 2, true);
}

/* A bar between walls, heated by two loads with coefficients of their own: along its length between
 * walls that hold it (displacements are compared), or alike between walls on which it slides
 * (stresses are compared: they are the same everywhere, so that it does not matter how a program
 * averages them at nodes). Nodal forces in place of temperatures have the same displacements and
 * other stresses. */
static void heated(bw_context *context, int order, bool wood, bool alike) {
  bw_mesh *mesh = box_mesh(context, 0.4, 0.1, 0.1, 8, 2, 2, order);
  bw_material *material = wood ? turned_wood(context) : some_material(context);
  bw_model *model = NULL;
  bw_array *warmer[2];
  bw_selection *end[2] = {face_of(context, mesh, 0, 0), face_of(context, mesh, 0, 0.4)};
  check_ok(context, bw_model_create(context, mesh, material, &model));
  for (int l = 0; l < 2; l++) {
    double normal[3] = {1, 0, 0};
    check_ok(context, bw_array_create(context, BW_F64, mesh->node_count, 1, &warmer[l]));
    for (int32_t i = 0; i < mesh->node_count; i++)
      ((double *)warmer[l]->data)[i] = l ? -20 : 50 + (alike ? 0 : 300 * mesh->node[3 * (size_t)i]);
    check_ok(context, bw_model_temperature(context, model, warmer[l], &(double){l ? 5e-6 : 23e-6}));
    check_ok(context, alike ? bw_model_slide(context, model, end[l], normal)
                            : bw_model_fix(context, model, end[l]));
  }
  compare(context, model, alike);
  for (int l = 0; l < 2; l++) {
    bw_release(warmer[l]);
    bw_release(end[l]);
  }
  bw_release(model);
  bw_release(material);
  bw_release(mesh);
}

static void temperatures_agree(void **state) {
  if (system("command -v ccx > /dev/null 2>&1") != 0)
    skip();
  for (int alike = 0; alike < 2; alike++) {
    heated(check_context(state), 1, false, alike);
    heated(check_context(state), 2, false, alike);
    heated(check_context(state), 2, true, alike);
  }
}

/* A bar of wood at an angle, steel and plastic by turns, heavy, pulled and heated, each part
 * expanding as its material does. */
static void several_materials(bw_context *context, int order) {
  bw_mesh *mesh = box_mesh(context, 0.4, 0.1, 0.1, 8, 2, 2, order);
  const bw_isotropic steel = {.young = 2.1e11, .poisson = 0.3, .density = 7850, .expansion = 12e-6};
  const bw_isotropic soft = {.young = 2e9, .poisson = 0.4, .density = 1200, .expansion = 9e-5};
  bw_material *part[3] = {turned_wood(context), NULL, NULL}, *all = NULL;
  bw_model *model = NULL;
  bw_array *warmer = NULL;
  bw_selection *end[2] = {face_of(context, mesh, 0, 0), face_of(context, mesh, 0, 0.4)};
  const double down[3] = {0, 0, -9.81}, pull[3] = {1e5, 2e4, 0};
  int32_t *of = BW_NEW(context, int32_t, mesh->element_count);
  check_ok(context, bw_material_isotropic(context, &steel, &part[1]));
  check_ok(context, bw_material_isotropic(context, &soft, &part[2]));
  for (int32_t e = 0; e < mesh->element_count; e++) {
    double x = 0;
    for (int a = 0; a < 4; a++)
      x += mesh->node[3 * mesh->element[(int64_t)e * mesh->nodes_per_element + a]] / 4;
    of[e] = (int32_t)(x / 0.1) % 3;
  }
  const bw_mesh_region named[3] = {{0, 0, {"wood"}}, {1, 0, {"steel-bar"}}, {2, 0, {"Soft_2"}}};
  bw_mesh_regions regions;
  bw_mesh *plain = mesh;
  check_ok(context, bw_mesh_regions_by_tag(context, mesh->element_count, of, 3, named, &regions));
  check_ok(context, bw_mesh_with_regions(context, plain, &regions, &mesh));
  bw_mesh_regions_clear(&regions);
  for (int k = 0; k < 2; k++)
    bw_release(end[k]);
  end[0] = face_of(context, mesh, 0, 0);
  end[1] = face_of(context, mesh, 0, 0.4);
  check_ok(context, bw_material_by_element(context, mesh->element_count, 3, of,
                                           (const bw_material *const *)part, &all));
  check_ok(context, bw_model_create(context, mesh, all, &model));
  check_ok(context, bw_array_create(context, BW_F64, mesh->node_count, 1, &warmer));
  for (int32_t i = 0; i < mesh->node_count; i++)
    ((double *)warmer->data)[i] = 50 - 100 * mesh->node[3 * (size_t)i + 1];
  check_ok(context, bw_model_fix(context, model, end[0]));
  check_ok(context, bw_model_gravity(context, model, down));
  check_ok(context, bw_model_traction(context, model, end[1], pull));
  check_ok(context, bw_model_temperature(context, model, warmer, NULL));
  compare(context, model, false);
  bw_free(of);
  bw_release(warmer);
  for (int k = 0; k < 2; k++)
    bw_release(end[k]);
  for (int k = 0; k < 3; k++)
    bw_release(part[k]);
  bw_release(model);
  bw_release(all);
  bw_release(mesh);
  bw_release(plain);
}

static void several_materials_agree(void **state) {
  if (system("command -v ccx > /dev/null 2>&1") != 0)
    skip();
  several_materials(check_context(state), 1);
  several_materials(check_context(state), 2);
}

static void free_body_under_a_balanced_load_is_pinned(void **state) {
  if (system("command -v ccx > /dev/null 2>&1") != 0)
    skip();
  bw_context *context = check_context(state);
  bw_mesh *mesh = box_mesh(context, 1, 1, 1, 2, 2, 2, 2);
  bw_model *model = some_model(context, mesh);
  bw_selection *low = face_of(context, mesh, 0, 0), *high = face_of(context, mesh, 0, 1);
  double pull[3] = {1e6, 0, 0}, back[3] = {-1e6, 0, 0};
  char path[200], command[600], line[300];
  check_ok(context, bw_model_traction(context, model, high, pull));
  check_ok(context, bw_model_traction(context, model, low, back));
  snprintf(path, sizeof path, "/tmp/barwright-free-%d", (int)getpid());
  snprintf(command, sizeof command, "%s.inp", path);
  check_ok(context, bw_model_write_inp(context, model, command, 0));
  snprintf(command, sizeof command, "cd /tmp && OMP_NUM_THREADS=1 ccx -i '%s' > '%s.log' 2>&1",
           path, path);
  assert_int_equal(system(command), 0);
  snprintf(command, sizeof command, "%s.dat", path);
  FILE *file = fopen(command, "r");
  assert_non_null(file);
  double first = 0, last = 0, x, y, z; /* the elongation is F / (A Y) */
  int node;
  while (fgets(line, sizeof line, file))
    if (sscanf(line, "%d %lf %lf %lf", &node, &x, &y, &z) == 4) {
      const double *at = mesh->node + 3 * (size_t)(node - 1);
      first = at[0] == 0 && at[1] == 0 && at[2] == 0 ? x : first;
      last = at[0] == 1 && at[1] == 0 && at[2] == 0 ? x : last;
    }
  fclose(file);
  check_near(last - first, 1e6 / 2e11, 1e-11);
  remove_files(path);
  bw_release(low);
  bw_release(high);
  bw_release(model);
  bw_release(mesh);
}

check_main(check_test(calculix_agrees), check_test(temperatures_agree),
           check_test(several_materials_agree),
           check_test(free_body_under_a_balanced_load_is_pinned))
