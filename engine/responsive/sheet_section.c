/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* From a material of space to one of the plane.
 *
 * Plane strain: strains across are zero; the entries of the elasticity matrix are taken as they
 * are. Plane stress: stresses across are zero; the entries of the compliance matrix are taken and
 * inverted. Both need the plane to be one of the material's symmetry (an axis of orthotropy along
 * z), else shear across would come with stresses in the plane. */
#include <math.h>

#include "responsive/sheet.h"

double bwi_plane_von_mises(const double stress[3], double zz) {
  double x = stress[0], y = stress[1], xy = stress[2];
  double square =
      0.5 * ((x - y) * (x - y) + (y - zz) * (y - zz) + (zz - x) * (zz - x)) + 3 * xy * xy;
  return sqrt(square);
}

/* Inverse of a symmetric positive definite 3x3 matrix. */
static bool invert(const double a[9], double inverse[9]) {
  double determinant = bw_inverse3(a, inverse);
  return determinant > 0 && isfinite(determinant);
}

bw_status bwi_section_create(bw_context *context, const bw_sheet_section *given,
                             bwi_section *section) {
  static const int in[3] = {0, 1, 5}, out[2] = {3, 4};
  const bw_material *material = given->material;
  if (!material)
    return bw_fail(context, BW_INVALID, "a section of a sheet has no material");
  if (!(given->thickness > 0) || !isfinite(given->thickness))
    return bw_fail(context, BW_INVALID, "a thickness of %g m: above 0 expected", given->thickness);
  if (material->parts)
    return bw_fail(context, BW_INVALID,
                   "material '%s' has axes by element of a solid mesh: the triangles of a sheet "
                   "are other elements. Give the material with one set of axes",
                   material->name);
  const double *c = material->elasticity, *s = material->compliance;
  double size = fabs(c[0]) + fabs(c[7]) + fabs(c[14]);
  for (int i = 0; i < 2; i++)
    for (int j = 0; j < 6; j++)
      if (j != 3 && j != 4 && fabs(c[6 * out[i] + j]) > 1e-9 * size)
        return bw_fail(context, BW_UNSUPPORTED,
                       "material '%s' has no axis along z: stresses in the plane of a sheet "
                       "would shear it across the plane",
                       material->name);
  *section = (bwi_section){.thickness = given->thickness, .density = material->density};
  double *plane = given->plane_strain ? section->elasticity : section->compliance;
  for (int i = 0; i < 3; i++) {
    for (int j = 0; j < 3; j++)
      plane[3 * i + j] = (given->plane_strain ? c : s)[6 * in[i] + in[j]];
    section->across[i] = given->plane_strain ? c[12 + in[i]] : 0;
    section->strain_across[i] = given->plane_strain ? 0 : s[12 + in[i]];
  }
  if (!invert(plane, given->plane_strain ? section->compliance : section->elasticity))
    return bw_fail(context, BW_INVALID, "material '%s' has no stiffness in the plane",
                   material->name);
  return BW_OK;
}
