/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* Materials whose axes differ from element to element, as where parts of a body were bent or
 * rotated together with their grain. Invariant: `unrotated` has no orientations itself, and is not
 * isotropic. */
#include "material/internal.h"

#include <string.h>

static bw_status check_groups(bw_context *context, const bw_material *material,
                              int32_t element_count, int32_t group_count,
                              const int32_t *of_element) {
  if (material->orientations)
    return bw_fail(
        context, BW_INVALID,
        "material %s has axes by element already: rotate the material that it was made of",
        material->name);
  if (group_count < 1 || element_count < 0)
    return bw_fail(context, BW_INVALID, "%d groups of %d elements: at least one group expected",
                   group_count, element_count);
  for (int32_t e = 0; e < element_count; e++)
    if (of_element[e] < 0 || of_element[e] >= group_count) {
      bw_fail(context, BW_INVALID, "element %d is in group %d: the groups are 1 to %d", e + 1,
              of_element[e] + 1, group_count);
      bw_detail_number(context, "element", e + 1);
      return BW_INVALID;
    }
  return BW_OK;
}

static bw_material_orientations *orientations_create(bw_context *context, int32_t element_count,
                                                     int32_t group_count) {
  bw_material_orientations *t = BW_NEW0(context, bw_material_orientations, 1);
  if (!t)
    return NULL;
  t->element_count = element_count;
  t->count = group_count;
  t->of_element = BW_NEW(context, int32_t, element_count);
  t->rotation = BW_NEW(context, double, 9 * (int64_t)group_count);
  t->axes = BW_NEW(context, double, 9 * (int64_t)group_count);
  t->elasticity = BW_NEW(context, double, 36 * (int64_t)group_count);
  t->compliance = BW_NEW(context, double, 36 * (int64_t)group_count);
  if (t->of_element && t->rotation && t->axes && t->elasticity && t->compliance)
    return t;
  bwi_material_orientations_destroy(t);
  return NULL;
}

bw_status bw_material_rotated_by_element(bw_context *context, const bw_material *material,
                                         int32_t element_count, int32_t group_count,
                                         const int32_t *of_element, const double *rotation,
                                         bw_material **rotated) {
  bw_status status = BW_OK;
  bw_material *made = NULL, *one = NULL;
  BW_TRY(check_groups(context, material, element_count, group_count, of_element));
  if (material->isotropic) {
    *rotated = (bw_material *)bw_retain(material);
    return BW_OK;
  }
  made = bwi_material_copy(context, material);
  one = bwi_material_copy(context, material);
  bw_material_orientations *t = orientations_create(context, element_count, group_count);
  if (made)
    made->orientations = t;
  else
    bwi_material_orientations_destroy(t);
  BW_TRY_MEMORY(made && one && t);
  made->unrotated = (const bw_material *)bw_retain(material);
  memcpy(t->of_element, of_element, (size_t)element_count * sizeof *of_element);
  memcpy(t->rotation, rotation, 9 * (size_t)group_count * sizeof *rotation);
  for (int64_t g = 0; g < group_count; g++) {
    BW_TRY(bwi_material_check_rotation(context, "the turn of a group of elements",
                                       t->rotation + 9 * g));
    bwi_material_rotate_axes(material->axes, t->rotation + 9 * g, one->axes);
    BW_TRY(bwi_material_orthotropic_matrices(context, one));
    memcpy(t->axes + 9 * g, one->axes, sizeof one->axes);
    memcpy(t->elasticity + 36 * g, one->elasticity, sizeof one->elasticity);
    memcpy(t->compliance + 36 * g, one->compliance, sizeof one->compliance);
  }
  *rotated = made;
  made = NULL;
done:
  bw_release(one);
  bw_release(made);
  return status;
}

/* A material that is rotated by element, rotated once more as a whole. */
static bw_status rotated_again(bw_context *context, const bw_material *material,
                               const double rotation[9], bw_material **rotated) {
  const bw_material_orientations *t = material->orientations;
  double *both = BW_NEW(context, double, 9 * (int64_t)t->count);
  if (!both)
    return BW_MEMORY;
  for (int64_t g = 0; g < t->count; g++)
    for (int r = 0; r < 3; r++)
      for (int c = 0; c < 3; c++) {
        const double *first = t->rotation + 9 * g;
        both[9 * g + 3 * r + c] = rotation[3 * r] * first[c] + rotation[3 * r + 1] * first[3 + c] +
                                  rotation[3 * r + 2] * first[6 + c];
      }
  bw_status status = bw_material_rotated_by_element(context, material->unrotated, t->element_count,
                                                    t->count, t->of_element, both, rotated);
  bw_free(both);
  return status;
}

bw_status bw_material_rotated(bw_context *context, const bw_material *material,
                              const double rotation[9], bw_material **rotated) {
  bw_status status = BW_OK;
  double r[9];
  memcpy(r, rotation, sizeof r);
  BW_TRY(bwi_material_check_rotation(context, "the rotation of a material", r));
  if (material->orientations)
    return rotated_again(context, material, r, rotated);
  bw_material *made = bwi_material_copy(context, material);
  if (!made)
    return BW_MEMORY;
  bwi_material_rotate_axes(material->axes, r, made->axes);
  if (!made->isotropic)
    status = bwi_material_orthotropic_matrices(context, made);
  if (status != BW_OK) {
    bw_free(made);
    return status;
  }
  *rotated = made;
done:
  return status;
}

bw_status bw_material_fits(bw_context *context, const bw_material *material,
                           int32_t element_count) {
  if (!material->orientations || material->orientations->element_count == element_count)
    return BW_OK;
  return bw_fail(context, BW_INVALID,
                 "material %s has axes for each of %d elements; the mesh has %d", material->name,
                 material->orientations->element_count, element_count);
}
