/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* Solids: a grid, what its numbers of materials mean, and what follows from the two once and for
 * all: the block sparsity pattern and the lumped mass. */
#include "nonlinear/internal.h"

#include <math.h>

static void destroy(void *object) {
  bw_solid *solid = (bw_solid *)object;
  bw_release(solid->grid);
  bw_release(solid->material_table);
  bw_release(solid->pattern);
  bw_release(solid->contributions);
  bw_free(solid->mass);
  bw_free(solid);
}

static size_t bytes(const void *object) {
  const bw_solid *solid = (const bw_solid *)object;
  return sizeof *solid + sizeof(double) * (size_t)solid->grid->node_count;
}

static const bw_kind solid_kind = {"solid", destroy, bytes};

static bw_status check_materials(bw_context *context, const bw_grid *grid,
                                 const bw_material_table *material_table) {
  for (int32_t e = 0; e < grid->element_count; e++) {
    int32_t m = grid->material[e];
    if (m >= 1 && m < material_table->count && material_table->material[m])
      continue;
    bw_status status =
        bw_fail(context, BW_INVALID,
                "element %d (cell %d) is of material %d; the material table has materials "
                "1 to %d",
                (int)e + 1, (int)grid->cell[e] + 1, (int)m, (int)material_table->count - 1);
    bw_detail_number(context, "element", e + 1);
    bw_detail_number(context, "material", m);
    return status;
  }
  return BW_OK;
}

bw_status bw_solid_create(bw_context *context, const bw_grid *grid,
                          const bw_material_table *material_table, const bw_solid *previous,
                          bw_solid **out) {
  bw_status status = check_materials(context, grid, material_table);
  if (status != BW_OK)
    return status;
  bw_solid *solid = BW_NEW0(context, bw_solid, 1);
  if (!solid)
    return BW_MEMORY;
  bw_object_init(solid, &solid_kind);
  solid->grid = (const bw_grid *)bw_retain(grid);
  solid->material_table = (const bw_material_table *)bw_retain(material_table);
  if (previous && bw_grid_same_elements(previous->grid, grid)) {
    solid->pattern = (bw_block_pattern *)bw_retain(previous->pattern);
    solid->contributions = (bwi_contributions *)bw_retain(previous->contributions);
  } else {
    BW_TRY(bw_block_pattern_of_elements(context, grid->node_count, grid->element_count, 8,
                                        grid->element, &solid->pattern));
    BW_TRY(bwi_contributions_create(context, solid->pattern, grid->element_count, 8, grid->element,
                                    &solid->contributions));
  }
  solid->mass = BW_NEW0(context, double, grid->node_count);
  BW_TRY_MEMORY(solid->mass);
  for (int32_t e = 0; e < grid->element_count; e++) {
    double density = material_table->material[grid->material[e]]->density;
    solid->weightless = solid->weightless || !(density > 0);
    for (int c = 0; c < 8; c++)
      solid->mass[grid->element[8 * (int64_t)e + c]] += density * bwi_solid_volume(grid, e) / 8;
  }
  *out = solid;
  solid = NULL;
done:
  bw_release(solid);
  return status;
}

const char *bw_solid_locking(const bw_solid *solid) {
  for (int32_t i = 1; i < solid->material_table->count; i++) {
    const bw_solid_material *m = solid->material_table->material[i];
    if (m->uniform && m->lambda[0] > 2 * 0.48 * (m->lambda[0] + m->mu[0]))
      return "volumetric locking: a material's Poisson's ratio is above 0.48, and hexahedra of the "
             "standard formulation are far too stiff there. Give the material with formulation = "
             "\"b_bar\"";
  }
  return NULL;
}

bw_status bwi_fail_undefined(bw_context *context, int64_t element) {
  bw_status status = bw_fail(context, BW_GEOMETRY,
                             "element %lld has a neo-Hookean point with det F <= 0, where its "
                             "energy does not exist; give displacements that do not invert it",
                             (long long)element + 1);
  bw_detail_number(context, "element", (double)element + 1);
  return status;
}
