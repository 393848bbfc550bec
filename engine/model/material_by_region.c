/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* The material of a mesh with regions: every element is of the material of its region. That of a
 * region may become another. */
#include "model/internal.h"

bw_status bw_material_by_region(bw_context *context, const bw_mesh *mesh,
                                const bw_material *const *part, bw_material **material) {
  if (mesh->region_count == 0)
    return bw_fail(
        context, BW_INVALID,
        "materials were given by region, and the mesh has no regions: give one material");
  for (int32_t i = 0; i < mesh->region_count; i++)
    if (!part[i])
      return bw_fail(context, BW_INVALID, "region '%s' has no material: give it one",
                     mesh->regions[i].name.text);
  return bw_material_by_element(context, mesh->element_count, mesh->region_count, mesh->region,
                                part, material);
}

bw_status bwi_material_region_changed(bw_context *context, const bw_mesh *mesh,
                                      const bw_material *material, int32_t region,
                                      const bw_material *other, bw_material **changed) {
  bw_status status = BW_OK;
  const bw_material **part = NULL;
  int32_t *number = NULL, *of_element = NULL, count = 0, parts = bw_material_part_count(material);
  bw_material *formulated = NULL;
  if (other->formulation != material->formulation) {
    BW_TRY(bw_material_formulated(context, other, material->formulation, &formulated));
    other = formulated;
  }
  part = BW_NEW(context, const bw_material *, (int64_t)parts + 1);
  number = BW_NEW(context, int32_t, (int64_t)parts + 1); /* of each part among those that stay */
  of_element = BW_NEW(context, int32_t, mesh->element_count);
  BW_TRY_MEMORY(part && number && of_element);
  for (int32_t i = 0; i <= parts; i++)
    number[i] = -1;
  for (int32_t e = 0; e < mesh->element_count; e++) {
    bool changes = region < 0 || mesh->region[e] == region;
    int32_t own = changes ? parts : material->parts ? material->parts->of_element[e] : 0;
    if (number[own] < 0) {
      part[count] = changes ? other : bw_material_part(material, own);
      number[own] = count++;
    }
    of_element[e] = number[own];
  }
  status = bw_material_by_element(context, mesh->element_count, count, of_element, part, changed);
done:
  bw_release(formulated);
  bw_free(part);
  bw_free(number);
  bw_free(of_element);
  return status;
}

/* An element of each region, all of whose elements are of one material. */
static bw_status take_regions(bw_context *context, const bw_mesh *mesh, const bw_material *material,
                              int32_t *element) {
  for (int32_t i = 0; i < mesh->region_count; i++)
    element[i] = -1;
  for (int32_t e = 0; e < mesh->element_count; e++) {
    int32_t like = 0;
    if (mesh->region) {
      int32_t *first = &element[mesh->region[e]];
      *first = *first < 0 ? e : *first;
      like = *first;
    }
    if (bw_material_of(material, e) != bw_material_of(material, like))
      return bw_fail(context, BW_UNSUPPORTED,
                     "material %s differs within %s (elements %d and %d), and the new mesh has "
                     "other elements: transfer the model with a material for each region",
                     material->name,
                     mesh->region ? mesh->regions[mesh->region[e]].name.text : "the mesh", like + 1,
                     e + 1);
  }
  return BW_OK;
}

bw_status bwi_material_carry_by_region(bw_context *context, const bw_material *material,
                                       const bw_mesh *before, const bw_mesh *mesh,
                                       bw_material **carried) {
  bw_status status = BW_OK;
  int32_t *from = NULL, *to = NULL;
  int32_t *first = BW_NEW(context, int32_t, before->region_count + 1);
  BW_TRY_MEMORY(first);
  BW_TRY(take_regions(context, before, material, first));
  from = BW_NEW(context, int32_t, mesh->region_count + 1);
  to = BW_NEW(context, int32_t, mesh->element_count);
  BW_TRY_MEMORY(from && to);
  for (int32_t i = 0; i < mesh->region_count; i++) {
    int32_t at = bw_mesh_find_region(before, mesh->regions[i].name.text);
    if (at < 0)
      BW_TRY(bw_fail(context, BW_INVALID,
                     "the new mesh has the region '%s', which the model's mesh has not",
                     mesh->regions[i].name.text));
    from[i] = first[at];
  }
  for (int32_t e = 0; e < mesh->element_count; e++)
    to[e] = mesh->region ? from[mesh->region[e]] : 0;
  status = bw_material_carried(context, material, mesh->element_count, to, carried);
done:
  bw_free(first);
  bw_free(from);
  bw_free(to);
  return status;
}
