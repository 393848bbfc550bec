/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* The materials of subdomains: one in each, which may become another.
 *
 * The frames include that of the axes only where the body was made of a material that is not
 * isotropic. Of a material whose axes turn only the elasticity at rest is kept. So a material may
 * become any other where its axes stay and the frames include them. Elsewhere only isotropic
 * materials follow isotropic ones. */
#include "assemble/subdomain.h"

bw_status bwi_subdomain_one_material(bw_context *context, const bw_material *material,
                                     int32_t subdomain_count, const bwi_subdomain_coefficients *c) {
  for (int32_t d = 0; d < subdomain_count; d++)
    for (int32_t k = c->element_start[d] + 1; k < c->element_start[d + 1]; k++) {
      const bw_material *first = bw_material_of(material, c->element[c->element_start[d]]);
      const bw_material *own = bw_material_of(material, c->element[k]);
      if (own == first)
        continue;
      bool turned = first->isotropic == own->isotropic && strcmp(first->name, own->name) == 0;
      bw_fail(context, BW_INVALID,
              "element %d of subdomain %d has another material%s than the elements before it: each "
              "subdomain needs one",
              c->element[k] + 1, d + 1, turned ? " orientation" : "");
      bw_detail_number(context, "element", c->element[k] + 1);
      return BW_INVALID;
    }
  return BW_OK;
}

void bwi_subdomain_take_elasticity(const bw_material *material, int32_t d,
                                   const bwi_subdomain_coefficients *c) {
  static const int voigt[3][3] = {{0, 5, 4}, {5, 1, 3}, {4, 3, 2}};
  if (c->element_start[d] == c->element_start[d + 1])
    return;
  const double *from = bw_material_elasticity(material, c->element[c->element_start[d]]);
  for (int n = 0; n < 81; n++) {
    int i = n / 27, k = n / 9 % 3, j = n / 3 % 3, l = n % 3;
    c->elasticity[81 * (int64_t)d + n] = from[6 * voigt[i][j] + voigt[k][l]];
  }
}

/* Of an element, in directions that do not turn with the body. */
static const bw_material *fixed_material(const bw_subdomain_stiffness *stiffness,
                                         const bw_material *material, int64_t element) {
  return stiffness->rotate_material ? bw_material_unrotated(material, element)
                                    : bw_material_of(material, element);
}

bool bwi_subdomain_other_material(const bw_subdomain_stiffness *stiffness,
                                  const bw_material *material, int32_t d) {
  const bwi_subdomain_coefficients *c = stiffness->coefficients;
  if (material == stiffness->material || c->element_start[d] == c->element_start[d + 1])
    return false;
  int32_t e = c->element[c->element_start[d]];
  const bw_material *before = fixed_material(stiffness, stiffness->material, e);
  const bw_material *now = fixed_material(stiffness, material, e);
  return before != now && memcmp(before->elasticity, now->elasticity, sizeof now->elasticity) != 0;
}

bool bw_subdomain_stiffness_follows(const bw_subdomain_stiffness *stiffness,
                                    const bw_material *material) {
  const bwi_subdomain_coefficients *c = stiffness->coefficients;
  if (c->orientation_matters && !stiffness->rotate_material)
    return true;
  for (int32_t d = 0; d < stiffness->subdomain_count; d++) {
    if (!bwi_subdomain_other_material(stiffness, material, d))
      continue;
    int32_t e = c->element[c->element_start[d]];
    if (!bw_material_of(stiffness->material, e)->isotropic ||
        !bw_material_of(material, e)->isotropic)
      return false;
  }
  return true;
}

bw_status bwi_subdomain_check_material(bw_context *context, const bw_subdomain_stiffness *stiffness,
                                       const bw_material *material) {
  if (material == stiffness->material)
    return BW_OK;
  bw_status status = bw_material_fits(context, material, stiffness->pattern->mesh->element_count);
  if (status == BW_OK && material->formulation != stiffness->material->formulation)
    status = bw_fail(context, BW_INVALID,
                     "the stiffness by subdomains is of another formulation than the material %s",
                     material->name);
  if (status == BW_OK)
    status = bwi_subdomain_one_material(context, material, stiffness->subdomain_count,
                                        stiffness->coefficients);
  if (status == BW_OK && !bw_subdomain_stiffness_follows(stiffness, material))
    status =
        bw_fail(context, BW_UNSUPPORTED,
                "material %s differs from that before it in a law that is not isotropic, whose "
                "axes the subdomains do not know: make the system again",
                material->name);
  return status;
}
