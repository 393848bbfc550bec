/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* Detection of volumetric locking. Above this Poisson's ratio displacements of standard elements
 * come out too small by more than a few per cent on usual meshes: docs/theory/elements.md. */
#include "assemble/internal.h"

static const double locking_ratio = 0.48;

static bool locks(const bw_mesh *mesh, const bw_material *material) {
  double bulk = bw_material_bulk(material), shear = bw_material_mean_shear(material);
  double ratio = (3 * bulk - 2 * shear) / (2 * (3 * bulk + shear));
  return ratio > locking_ratio && !(bwi_projected_bulk(mesh, material) > 0);
}

const char *bw_locking(const bw_mesh *mesh, const bw_material *material) {
  bool any = false;
  for (int32_t i = 0; i < bw_material_part_count(material); i++)
    any |= locks(mesh, bw_material_part(material, i));
  if (!any)
    return NULL;
  if (mesh->order == 1)
    return "volumetric locking: Poisson's ratio is above 0.48, and linear tetrahedra are far too "
           "stiff there: displacements may come out ten to a hundred times too small. Use "
           "quadratic "
           "elements (order = 2) with formulation = \"b_bar\"";
  return "volumetric locking: Poisson's ratio is above 0.48, and quadratic tetrahedra of the "
         "standard formulation are too stiff there: displacements may come out a tenth too small, "
         "and pressures oscillate. Use formulation = \"b_bar\"";
}
