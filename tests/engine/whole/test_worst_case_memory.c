/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* Memory running out anywhere in a whole worst-case run, from the surface file to the picture: each
 * failing allocation ends the run with a status, and nothing stays behind. */
#include <unistd.h>

#include "body_system.h"
#include "check.h"

typedef struct files {
  char surface[64], mesh[64], picture[64];
} files;

typedef struct worst {
  double max, *field;
  int32_t elements;
} worst;

static bw_status keep_worst(void *data, const bw_worst_case_visit *visit) {
  worst *w = (worst *)data;
  for (int32_t e = 0; e < w->elements; e++)
    w->max = fmax(w->max, w->field[e] = fmax(w->field[e], visit->max_principal[e]));
  return BW_OK;
}

static bw_status whole_run(bw_context *context, const files *file, double *max) {
  bw_surface *surface = NULL, *boundary = NULL;
  bw_mesh *mesh = NULL;
  bw_material *material = NULL;
  bw_model *model = NULL;
  bw_dof_map *dof_map = NULL;
  bw_system *system = NULL;
  bw_modes *modes = NULL;
  bw_weak_regions *regions = NULL;
  bw_pressure_basis *basis = NULL;
  bw_array *weakness = NULL;
  bw_surface_report report = {.defect = NULL};
  worst found = {0, NULL, 0};
  bw_status status;
  const double low[3] = {0, 0, 0}, high[3] = {0.1, 0.02, 0.01};
  const int cells[3] = {5, 2, 1};
  BW_TRY(bw_surface_read(context, file->surface, &surface, NULL));
  BW_TRY(bw_surface_check(context, surface, 4, &report));
  BW_TRY(bw_mesh_box_grid(context, low, high, cells, 1, &mesh));
  BW_TRY(bw_material_named(context, "zp150", &material));
  BW_TRY(bw_model_create(context, mesh, material, &model));
  BW_TRY(bw_dof_map_create(context, model, &dof_map));
  BW_TRY(body_system(context, mesh, material, dof_map, NULL, &system));
  bw_modes_options modes_options;
  bw_modes_options_default(&modes_options);
  modes_options.count = 3;
  BW_TRY(bw_modes_elastic(context, system, &modes_options, &modes));
  bw_weak_options weak_options;
  bw_weak_options_default(&weak_options);
  weak_options.fraction = 0.1;
  weak_options.regions = 2;
  BW_TRY(bw_weak_regions_find(context, mesh, material, modes, &weak_options, &regions));
  BW_TRY(bw_pressure_basis_create(context, mesh, NULL, &basis));
  BW_TRY(bw_array_create(context, BW_F64, mesh->element_count, 1, &weakness));
  found.field = (double *)weakness->data;
  found.elements = mesh->element_count;
  bw_worst_load_options load = {.pressure = 2e5, .force = 5};
  BW_TRY(bw_worst_case_run(context, system, basis, regions, &load, 0, keep_worst, &found, NULL));
  bw_field field = {"weakness", BW_ON_ELEMENTS, weakness};
  BW_TRY(bw_mesh_write(context, mesh, file->mesh, 1, &field));
  BW_TRY(bw_mesh_boundary(context, mesh, &boundary, NULL));
  bw_picture_options picture;
  bw_picture_options_default(&picture);
  picture.width = 80;
  picture.height = 64;
  BW_TRY(bw_picture_surface(context, boundary, NULL, false, &picture, file->picture));
  *max = found.max;
done:
  bw_surface_report_clear(&report);
  bw_release(weakness);
  bw_release(basis);
  bw_release(regions);
  bw_release(modes);
  bw_release(system);
  bw_release(dof_map);
  bw_release(model);
  bw_release(material);
  bw_release(mesh);
  bw_release(boundary);
  bw_release(surface);
  return status;
}

static void test_sweep(void **state) {
  bw_context *context = check_context(state);
  files file;
  snprintf(file.surface, sizeof file.surface, "/tmp/barwright-whole-%d.stl", (int)getpid());
  snprintf(file.mesh, sizeof file.mesh, "/tmp/barwright-whole-%d.vtu", (int)getpid());
  snprintf(file.picture, sizeof file.picture, "/tmp/barwright-whole-%d.png", (int)getpid());
  const double low[3] = {0, 0, 0}, high[3] = {0.1, 0.02, 0.01};
  bw_surface *box;
  check_ok(context, bw_surface_box_shape(context, low, high, &box));
  check_ok(context, bw_surface_write(context, box, file.surface, false));
  bw_release(box);
  double max = 0, again = 0;
  check_ok(context, whole_run(context, &file, &max));
  assert_true(max > 0);
  int64_t asked = bw_allocation_count();
  check_ok(context, whole_run(context, &file, &again));
  asked = bw_allocation_count() - asked;
  assert_true(again == max);
  /* Every allocation in the full run, one in seven otherwise. */
  int64_t step = getenv("BARWRIGHT_FULL") ? 1 : 7, failed = 0;
  for (int64_t n = 1; n <= asked; n += step) {
    int64_t blocks = bw_live_blocks();
    unlink(file.mesh);
    unlink(file.picture);
    bw_fail_allocation(n, true);
    bw_status status = whole_run(context, &file, &again);
    bw_fail_allocation(0, false);
    if (bw_live_blocks() != blocks)
      fail_msg("allocation %lld: %lld blocks left", (long long)n,
               (long long)(bw_live_blocks() - blocks));
    if (status == BW_OK)
      continue; /* a warning or a cache went without */
    failed++;
    assert_int_equal(status, BW_MEMORY);
    assert_int_not_equal(access(file.picture, F_OK), 0);
  }
  printf("%lld allocations, %lld of them made to fail\n", (long long)asked, (long long)failed);
  assert_true(failed > asked / step / 2);
  unlink(file.surface);
  unlink(file.mesh);
  unlink(file.picture);
}

check_main(check_test(test_sweep))
