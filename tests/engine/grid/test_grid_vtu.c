/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* Grids as VTU files, read back by an independent program where python3 has meshio. */
#include "check.h"

#include "grid/internal.h"

#include <unistd.h>

static void hexahedra(void **state) {
  bw_context *context = check_context(state);
  const int32_t cells[3] = {4, 3, 2};
  int32_t material[24];
  double fraction[24];
  bw_grid *grid;
  bw_array *u, *height, *wrong;
  char path[300], command[800];
  const char *folder = getenv("TMPDIR");
  snprintf(path, sizeof path, "%s/barwright-%ld.vtu", folder ? folder : "/tmp", (long)getpid());
  for (int c = 0; c < 24; c++) {
    material[c] = c == 7 ? 0 : c % 4 < 2 ? 2 : 5;
    fraction[c] = (c + 1) / 24.;
  }
  check_ok(context, bw_grid_create(context, (double[3]){0, 1, 2}, (double[3]){0.5, 0.25, 0.125},
                                   cells, material, fraction, &grid));
  check_ok(context, bw_array_create(context, BW_F64, grid->node_count, 3, &u));
  check_ok(context, bw_array_create(context, BW_F64, grid->element_count, 1, &height));
  check_ok(context, bw_array_create(context, BW_F64, 5, 1, &wrong));
  for (int32_t n = 0; n < grid->node_count; n++) {
    double at[3];
    bw_grid_position(grid, n, at);
    for (int d = 0; d < 3; d++)
      ((double *)u->data)[3 * n + d] = 2 * at[d] + 1;
  }
  for (int32_t e = 0; e < grid->element_count; e++) {
    int32_t place[3];
    bwi_grid_place(cells, grid->cell[e], place);
    ((double *)height->data)[e] = 2 + 0.125 * (place[2] + 0.5);
  }
  bw_field field[2] = {{"u", BW_ON_NODES, u}, {"height", BW_ON_ELEMENTS, height}};
  check_ok(context, bw_grid_write_vtu(context, grid, path, 2, field));
  /* barwright's own reader knows tetrahedra only, and says so */
  bw_mesh_file file;
  check_fails(context, BW_FORMAT, "holds no tetrahedra", bw_mesh_read(context, path, &file));
  bool found = false;
  static const char *const candidate[] = {"python3", "/usr/bin/python3"};
  for (int i = 0; i < 2 && !found; i++) {
    snprintf(command, sizeof command, "%s -c 'import meshio' > /dev/null 2>&1", candidate[i]);
    if (system(command) != 0)
      continue;
    found = true;
    snprintf(command, sizeof command, "%s tests/engine/grid/read_hexahedra.py '%s' %.17g",
             candidate[i], path, bw_grid_volume(grid));
    assert_int_equal(system(command), 0);
  }
  check_each_allocation(context, status, 10) {
    status = bw_grid_write_vtu(context, grid, path, 2, field);
  }
  field[0].array = wrong;
  check_fails(context, BW_INVALID, "field 'u' on nodes has 5 rows",
              bw_grid_write_vtu(context, grid, path, 2, field));
  unlink(path);
  bw_release(u);
  bw_release(height);
  bw_release(wrong);
  bw_release(grid);
  if (!found)
    skip();
}

check_main(check_test(hexahedra))
