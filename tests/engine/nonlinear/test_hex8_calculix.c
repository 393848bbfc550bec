/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* Under tiny loads every law is linear elasticity: displacements are those of CalculiX's C3D8
 * (eight nodes, 2 x 2 x 2 points) to the digits that it prints. Skipped without `ccx`. */
#include <unistd.h>

#include "nonlinear/whole.h"

/* Abaqus goes around the lower and then the upper face. */
static const int corner[8] = {0, 1, 3, 2, 4, 5, 7, 6};

static void write_deck(const char *path, const bw_grid *grid, const bw_load_case *load_case,
                       double young, double poisson) {
  FILE *file = fopen(path, "w");
  assert_non_null(file);
  fprintf(file, "*NODE, NSET=ALL\n");
  for (int32_t i = 0; i < grid->node_count; i++) {
    double x[3];
    bw_grid_position(grid, i, x);
    fprintf(file, "%d, %.15g, %.15g, %.15g\n", (int)i + 1, x[0], x[1], x[2]);
  }
  fprintf(file, "*ELEMENT, TYPE=C3D8, ELSET=BODY\n");
  for (int32_t e = 0; e < grid->element_count; e++) {
    fprintf(file, "%d", (int)e + 1);
    for (int c = 0; c < 8; c++)
      fprintf(file, ", %d", (int)grid->element[8 * (int64_t)e + corner[c]] + 1);
    fprintf(file, "\n");
  }
  fprintf(file, "*MATERIAL, NAME=IT\n*ELASTIC\n%.15g, %.15g\n", young, poisson);
  fprintf(file, "*SOLID SECTION, ELSET=BODY, MATERIAL=IT\n*BOUNDARY\n");
  for (int32_t i = 0; i < grid->node_count; i++)
    for (int c = 0; c < 3; c++)
      if (load_case->constrained[3 * (int64_t)i + c])
        fprintf(file, "%d, %d, %d, %.15g\n", (int)i + 1, c + 1, c + 1,
                load_case->value[3 * (int64_t)i + c]);
  fprintf(file, "*STEP\n*STATIC\n*CLOAD\n");
  for (int32_t i = 0; i < grid->node_count; i++)
    for (int c = 0; c < 3; c++)
      if (load_case->force[3 * (int64_t)i + c] != 0)
        fprintf(file, "%d, %d, %.15g\n", (int)i + 1, c + 1, load_case->force[3 * (int64_t)i + c]);
  fprintf(file, "*NODE PRINT, NSET=ALL\nU\n*END STEP\n");
  assert_int_equal(fclose(file), 0);
}

static void remove_files(const char *stem) {
  static const char *const ending[] = {"inp", "dat", "frd", "sta", "cvg", "12d", "log"};
  char path[300];
  for (size_t i = 0; i < sizeof ending / sizeof *ending; i++) {
    snprintf(path, sizeof path, "%s.%s", stem, ending[i]);
    unlink(path);
  }
}

/* An L of cells, constrained at its foot, bent and twisted at its arm, and moved a little on one
 * side. */
static void test_same(void **state) {
  bw_context *context = check_context(state);
  if (system("command -v ccx > /dev/null 2>&1") != 0)
    skip();
  const double young = 1e6, poisson = 0.3;
  const double origin[3] = {0, 0, 0}, spacing[3] = {0.1, 0.12, 0.08};
  const int32_t cells[3] = {5, 2, 5};
  int32_t material[50], node, found = 0;
  bw_grid *grid;
  for (int k = 0; k < 50; k++)
    material[k] = k % 5 < 2 || k / 10 > 2;
  check_ok(context, bw_grid_create(context, origin, spacing, cells, material, NULL, &grid));
  char stem[200], path[300], command[700], line[300];
  snprintf(stem, sizeof stem, "/tmp/barwright-hex8-%d", (int)getpid());
  for (int law = 0; law < BW_LAWS; law++) {
    bw_retain(grid);
    body b = body_of(context, grid, (bw_law)law, young, poisson, 0);
    bw_load_case *load_case;
    check_ok(context, bw_load_case_create(context, grid, &load_case));
    hold_side(context, load_case, 2, 0, 7, 0, 0, 0);
    hold_side(context, load_case, 0, 0.5, 2, 0, 2e-9, 0);
    push_side(context, load_case, 0, 0.5, 1e-6, 2e-6, -4e-6);
    bw_solid_static *result = solve(context, &b, load_case, 1);
    if (law == 0) {
      snprintf(path, sizeof path, "%s.inp", stem);
      write_deck(path, grid, load_case, young, poisson);
      snprintf(command, sizeof command, "cd /tmp && OMP_NUM_THREADS=1 ccx -i '%s' > '%s.log' 2>&1",
               stem, stem);
      assert_int_equal(system(command), 0);
    }
    double largest = 0, worst = 0, x, y, z;
    for (int32_t i = 0; i < 3 * b.nodes; i++)
      largest = fmax(largest, fabs(result->displacement[i]));
    snprintf(path, sizeof path, "%s.dat", stem);
    FILE *file = fopen(path, "r");
    assert_non_null(file);
    for (found = 0; fgets(line, sizeof line, file);)
      if (sscanf(line, "%d %lf %lf %lf", &node, &x, &y, &z) == 4 && node >= 1 && node <= b.nodes) {
        const double *u = result->displacement + 3 * (int64_t)(node - 1);
        worst = fmax(worst, fmax(fabs(u[0] - x), fmax(fabs(u[1] - y), fabs(u[2] - z))));
        found++;
      }
    fclose(file);
    assert_int_equal(found, b.nodes);
    printf(
        "VERIFY | tiny loads, %s, against C3D8 | largest difference of displacements | 0 | %.1e | "
        "1e-6 | CalculiX\n",
        bw_law_word((bw_law)law), worst / largest);
    check_near(worst / largest, 0, 1e-6);
    bw_release(result);
    bw_release(load_case);
    body_release(&b);
  }
  remove_files(stem);
  bw_release(grid);
}

check_main(check_test(test_same))
