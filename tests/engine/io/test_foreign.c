/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* meshio, an independent program, reads what barwright writes and writes what barwright reads.
 * Skipped where python3 has no meshio (Debian: python3-meshio). */
#include "mesh_check.h"

#include <sys/stat.h>

static char folder[300];
static const char *python;

static const char *in_folder(char path[400], const char *name) {
  snprintf(path, 400, "%s/%s", folder, name);
  return path;
}

static bool find_python(void) {
  static const char *const candidate[] = {"python3", "/usr/bin/python3"};
  for (int i = 0; i < 2; i++) {
    char command[200];
    snprintf(command, sizeof command, "%s -c 'import meshio' > /dev/null 2>&1", candidate[i]);
    if (system(command) == 0) {
      python = candidate[i];
      return true;
    }
  }
  return false;
}

static void write_reference(const char *name, int points, const double *x, int cells, int width,
                            const int32_t *cell) {
  char path[400];
  FILE *file = fopen(in_folder(path, name), "w");
  fprintf(file, "%d %d %d\n", points, cells, width);
  for (int i = 0; i < 3 * points; i++)
    fprintf(file, "%.17g\n", x[i]);
  for (int i = 0; i < cells * width; i++)
    fprintf(file, "%d\n", cell[i]);
  fclose(file);
}

static bw_mesh *curved_box(bw_context *context, int order) {
  bw_mesh *box, *bent;
  check_ok(context, bw_mesh_box_grid(context, (double[3]){0, 0, 0}, (double[3]){1, 0.3, 2},
                                     (int[3]){2, 2, 3}, order, &box));
  double *x = malloc(sizeof *x * 3 * (size_t)box->node_count);
  for (int i = 0; i < 3 * box->node_count; i++)
    x[i] = box->node[i] + sin(i) * 0.01 / 3;
  check_ok(context, bw_mesh_copy(context, order, box->node_count, x, box->element_count,
                                 box->element, NULL, &bent));
  free(x);
  bw_release(box);
  return bent;
}

static void write_all(bw_context *context, int order) {
  char path[400], name[40];
  bw_mesh *mesh = curved_box(context, order);
  bw_array *u;
  check_ok(context, bw_array_create(context, BW_F64, mesh->node_count, 3, &u));
  for (int i = 0; i < mesh->node_count; i++)
    ((double *)u->data)[3 * i + 1] = 2 * mesh->node[3 * i];
  bw_field field = {"u", BW_ON_NODES, u};
  snprintf(name, sizeof name, "reference%d.txt", order);
  write_reference(name, mesh->node_count, mesh->node, mesh->element_count, mesh->nodes_per_element,
                  mesh->element);
  static const char *const ending[] = {"vtu", "msh", "mesh", "inp"};
  for (int i = 0; i < 4; i++) {
    snprintf(name, sizeof name, "mesh%d.%s", order, ending[i]);
    check_ok(context, bw_mesh_write(context, mesh, in_folder(path, name), 1, &field));
  }
  snprintf(name, sizeof name, "mesh%d.22.msh", order);
  check_ok(context, bw_msh22_write(context, mesh, in_folder(path, name), 1, &field));
  if (order == 1) {
    static const char *const surface_ending[] = {"b.stl", "a.stl", "b.ply", "a.ply",
                                                 "obj",   "off",   "vtu"};
    bw_surface *surface;
    check_ok(context, bw_mesh_boundary(context, mesh, &surface, NULL));
    write_reference("surface.txt", surface->point_count, surface->point, surface->triangle_count, 3,
                    surface->triangle);
    for (int i = 0; i < 7; i++) {
      snprintf(name, sizeof name, "surface.%s", surface_ending[i]);
      check_ok(context, bw_surface_write(context, surface, in_folder(path, name),
                                         surface_ending[i][0] == 'a'));
    }
    bw_release(surface);
  }
  bw_release(u);
  bw_release(mesh);
}

static void run(const char *what) {
  char command[1000];
  snprintf(command, sizeof command, "%s tests/engine/io/compare_meshio.py %s '%s' > '%s/log' 2>&1",
           python, what, folder, folder);
  if (system(command) != 0) {
    snprintf(command, sizeof command, "tail -n 3 '%s/log'", folder);
    if (system(command) != 0)
      printf("no log\n");
    fail_msg("meshio could not %s", what);
  }
}

static void read_all(bw_context *context) {
  char path[400];
  static const char *const mesh_name[] = {"ascii.vtu",    "zlib.vtu",     "plain.vtu",
                                          "gmsh22.a.msh", "gmsh22.b.msh", "gmsh.a.msh",
                                          "gmsh.b.msh",   "mesh",         "inp"};
  static const char *const surface_name[] = {"a.stl", "b.stl", "a.ply", "b.ply", "obj", "off"};
  bw_mesh *mesh = curved_box(context, 1);
  bw_surface *surface, *read;
  for (size_t i = 0; i < sizeof mesh_name / sizeof *mesh_name; i++) {
    char name[60];
    bw_mesh_file file;
    snprintf(name, sizeof name, "meshio.%s", mesh_name[i]);
    check_ok(context, bw_mesh_read(context, in_folder(path, name), &file));
    double tolerance = strcmp(name, "meshio.ascii.vtu") == 0 ? 1e-11 : 0; /* its digits */
    assert_int_equal(file.mesh->node_count, mesh->node_count);
    assert_int_equal(file.mesh->element_count, mesh->element_count);
    assert_memory_equal(file.mesh->element, mesh->element, 16 * (size_t)mesh->element_count);
    for (int n = 0; n < 3 * mesh->node_count; n++)
      if (!(fabs(file.mesh->node[n] - mesh->node[n]) <= tolerance * 2))
        fail_msg("%s: coordinate %d is %.17g instead of %.17g", name, n, file.mesh->node[n],
                 mesh->node[n]);
    if (strstr(name, "vtu") || strstr(name, "msh")) {
      bool found = false;
      for (int f = 0; f < file.field_count; f++)
        if (strcmp(file.field_name[f], "u") == 0) {
          found = true;
          for (int n = 0; n < mesh->node_count; n++)
            check_near(bw_array_get(file.field_array[f], n, 1), 2 * mesh->node[3 * n + 1],
                       tolerance);
        }
      assert_true(found);
    }
    bw_mesh_file_clear(&file);
  }
  check_ok(context, bw_mesh_boundary(context, mesh, &surface, NULL));
  for (size_t i = 0; i < sizeof surface_name / sizeof *surface_name; i++) {
    char name[60];
    snprintf(name, sizeof name, "meshio.%s", surface_name[i]);
    check_ok(context, bw_surface_read(context, in_folder(path, name), &read, NULL));
    assert_int_equal(read->triangle_count, surface->triangle_count);
    for (int t = 0; t < 3 * read->triangle_count; t++)
      for (int k = 0; k < 3; k++)
        check_near(read->point[3 * read->triangle[t] + k],
                   surface->point[3 * surface->triangle[t] + k],
                   strcmp(surface_name[i], "b.stl") == 0 ? 2e-7 : 1e-15);
    bw_release(read);
  }
  bw_release(surface);
  bw_release(mesh);
}

static void meshio(void **state) {
  bw_context *context = check_context(state);
  if (!find_python())
    skip();
  temporary(folder, "meshio");
  mkdir(folder, 0700);
  write_all(context, 1);
  write_all(context, 2);
  run("read");
  run("write");
  read_all(context);
  char command[400];
  snprintf(command, sizeof command, "rm -r '%s'", folder);
  assert_int_equal(system(command), 0);
}

check_main(check_test(meshio))
