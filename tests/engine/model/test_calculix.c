/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* A model with everything (oblique slides that meet, prescribed displacement, pressure, torque,
 * gravity, an orthotropic material at an angle) solved here and, from its input deck, by CalculiX:
 * the displacements agree to the seven digits that CalculiX prints. Skipped without `ccx`. */
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

static void compare(bw_context *context, const bw_model *model) {
  int32_t nodes = model->mesh->node_count, node, found = 0;
  bw_static *result = NULL;
  char stem[200], path[300], command[700], line[300];
  double largest = 0, worst = 0, x, y, z;
  check_ok(context, bw_statics(context, model, NULL, NULL, &result));
  snprintf(stem, sizeof stem, "/tmp/barwright-model-%d", (int)getpid());
  snprintf(path, sizeof path, "%s.inp", stem);
  check_ok(context, bw_model_write_inp(context, model, path, 0));
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
  compare(context, model);
  /* a moved end instead of the oblique ones */
  bool all_three[3] = {true, true, true};
  bw_model_clear_supports(model);
  check_ok(context, bw_model_fix(context, model, end));
  check_ok(context, bw_model_prescribe(context, model, far_end, all_three, pull));
  compare(context, model);
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

int main(void) {
  const struct CMUnitTest tests[] = {
      check_test(calculix_agrees),
      check_test(free_body_under_a_balanced_load_is_pinned),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
