/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* The stiffness of subdomains: made at rest, released, measured (subdomain.h). Updates are in
 * subdomain_update.c. */
#include "assemble/subdomain.h"

#include <math.h>

void bw_subdomain_motion_rest(bw_subdomain_motion *motion) {
  *motion = (bw_subdomain_motion){.linear = {1, 0, 0, 0, 1, 0, 0, 0, 1},
                                  .frame = {1, 0, 0, 0, 1, 0, 0, 0, 1}};
}

static void destroy(void *object) {
  bw_subdomain_stiffness *stiffness = (bw_subdomain_stiffness *)object;
  bwi_subdomain_coefficients *c = stiffness->coefficients;
  if (c) {
    bw_release(c->contributions);
    bw_free(c->element_start);
    bw_free(c->element);
    bw_free(c->number);
    bw_free(c->node_start);
    bw_free(c->node);
    bw_free(c->section_size);
    bw_free(c->section_start);
    bw_free(c->section_subdomain);
    bw_free(c->segment);
    bw_free(c->block_code);
    bw_free(c->tensor);
    bw_free(c->present);
    bw_free(c->map);
    bw_free(c->elasticity);
    bw_free(c->frame_start);
    bw_free(c->frame_subdomain);
    bw_free(c->written);
    bw_free(c->reported);
    bw_free(c->written_position);
    bw_free(c->reported_position);
    bw_free(c->reported_frame);
    bw_free(c);
  }
  bw_release(stiffness->pattern);
  bw_release(stiffness->material);
  bw_free(stiffness->values);
  bw_free(stiffness->changed);
  bw_free(stiffness);
}

static size_t bytes(const void *object) {
  const bw_subdomain_stiffness *stiffness = (const bw_subdomain_stiffness *)object;
  const bwi_subdomain_coefficients *c = stiffness->coefficients;
  size_t subdomains = (size_t)stiffness->subdomain_count, sections = (size_t)c->section_count,
         elements = (size_t)stiffness->pattern->mesh->element_count,
         numbers = (size_t)(9 * stiffness->pattern->block_count + c->item_count + c->present_count),
         nodes = (size_t)c->node_start[subdomains], frames = (size_t)c->frame_start[subdomains];
  return sizeof *stiffness + sizeof *c + bw_bytes(c->contributions) + numbers * sizeof *c->tensor +
         (size_t)c->code_count * sizeof *c->block_code +
         (size_t)c->segment_count * sizeof *c->segment + sections * 2 * sizeof(int64_t) +
         (size_t)c->section_start[sections] * sizeof *c->section_subdomain +
         elements * 2 * sizeof(int32_t) +
         nodes * (sizeof *c->node + 6 * sizeof *c->written_position) +
         frames * (sizeof *c->frame_subdomain + 9 * sizeof *c->reported_frame) +
         subdomains * (2 * sizeof *c->written + 2 * sizeof(int32_t) + sizeof(int64_t) +
                       (BWI_SUBDOMAIN_MAP + 81) * sizeof *c->map + 1);
}

static const bw_kind stiffness_kind = {"subdomain stiffness", destroy, bytes};

size_t bw_subdomain_stiffness_bytes(const bw_subdomain_stiffness *stiffness) {
  return bytes(stiffness);
}

static bw_status check_arguments(bw_context *context, const bw_mesh *mesh, int32_t subdomain_count,
                                 const int32_t *element_subdomain, const int32_t *node_subdomain) {
  if (subdomain_count < 1)
    return bw_fail(context, BW_INVALID, "%d subdomains: at least one expected", subdomain_count);
  for (int32_t e = 0; e < mesh->element_count; e++)
    if (element_subdomain[e] < 0 || element_subdomain[e] >= subdomain_count) {
      bw_status status =
          bw_fail(context, BW_INVALID, "element %d is in subdomain %d: the subdomains are 1 to %d",
                  e + 1, element_subdomain[e] + 1, subdomain_count);
      bw_detail_number(context, "element", e + 1.0);
      return status;
    }
  for (int32_t i = 0; i < mesh->node_count; i++)
    if (node_subdomain[i] < -1 || node_subdomain[i] >= subdomain_count) {
      bw_status status =
          bw_fail(context, BW_INVALID,
                  "node %d has the frame of subdomain %d: the subdomains are 1 to %d, and 0 is the "
                  "global frame",
                  i + 1, node_subdomain[i] + 1, subdomain_count);
      bw_detail_number(context, "node", i + 1.0);
      return status;
    }
  return BW_OK;
}

/* Whether any element's stiffness depends on how it lies to the axes of its material. */
static bool any_orientation(const bw_material *material) {
  for (int32_t i = 0; i < bw_material_part_count(material); i++)
    if (!bw_material_part(material, i)->isotropic)
      return true;
  return false;
}

bw_status bw_subdomain_stiffness_create(bw_context *context, const bw_block_pattern *pattern,
                                        const bw_mesh *mesh, const bw_material *material,
                                        bool rotate_material, int32_t subdomain_count,
                                        const int32_t *element_subdomain,
                                        const int32_t *node_subdomain,
                                        bw_subdomain_stiffness **stiffness) {
  static const double identity[9] = {1, 0, 0, 0, 1, 0, 0, 0, 1};
  bw_status status = BW_OK;
  bwi_subdomain_work work = {0};
  bw_subdomain_stiffness *s = NULL;
  BW_TRY(bwi_block_pattern_fits(context, pattern, mesh));
  BW_TRY(check_arguments(context, mesh, subdomain_count, element_subdomain, node_subdomain));
  BW_TRY(bw_material_fits(context, material, mesh->element_count));
  if (material->formulation == BW_B_BAR)
    return bw_fail(
        context, BW_UNSUPPORTED,
        "the stiffness by subdomains is implemented for the standard formulation, not for B-bar");
  int64_t contributions =
      (int64_t)mesh->element_count * mesh->nodes_per_element * (mesh->nodes_per_element + 1) / 2;
  if (contributions > INT32_MAX)
    return bw_fail(context, BW_LIMIT,
                   "the mesh has %lld contributions of elements to pairs of nodes; at most %d fit",
                   (long long)contributions, INT32_MAX);
  s = BW_NEW0(context, bw_subdomain_stiffness, 1);
  if (!s)
    return BW_MEMORY;
  bw_object_init(s, &stiffness_kind);
  s->pattern = (const bw_block_pattern *)bw_retain(pattern);
  s->material = (const bw_material *)bw_retain(material);
  s->rotate_material = rotate_material;
  s->subdomain_count = subdomain_count;
  s->revision = s->object.revision;
  bwi_subdomain_coefficients *c = s->coefficients = BW_NEW0(context, bwi_subdomain_coefficients, 1);
  BW_TRY_MEMORY(c);
  c->orientation_matters = any_orientation(material);
  BW_TRY(bwi_contributions_create(context, pattern, mesh->element_count, mesh->nodes_per_element,
                                  mesh->element, &c->contributions));
  BW_TRY(bwi_subdomain_lists(context, pattern, subdomain_count, element_subdomain, node_subdomain,
                             c->orientation_matters, rotate_material, c));
  BW_TRY(bwi_subdomain_one_material(context, material, subdomain_count, c));
  int64_t nodes = c->node_start[subdomain_count];
  int32_t frames = c->frame_start[subdomain_count];
  s->values = BW_NEW(context, double, 9 * pattern->block_count);
  s->changed = BW_NEW0(context, uint8_t, subdomain_count);
  c->elasticity = BW_NEW0(context, double, 81 * (int64_t)subdomain_count);
  c->map = BW_NEW(context, double, BWI_SUBDOMAIN_MAP *(int64_t)subdomain_count);
  c->written = BW_NEW(context, bwi_subdomain_shape, subdomain_count);
  c->reported = BW_NEW(context, bwi_subdomain_shape, subdomain_count);
  c->written_position = BW_NEW(context, double, 3 * nodes);
  c->reported_position = BW_NEW(context, double, 3 * nodes);
  c->reported_frame = BW_NEW(context, double, 9 * (int64_t)frames);
  BW_TRY_MEMORY(s->values && s->changed && c->elasticity && c->map && c->written && c->reported &&
                c->written_position && c->reported_position && c->reported_frame);
  for (int32_t d = 0; d < subdomain_count; d++) {
    bwi_subdomain_take_elasticity(material, d, c);
    c->written[d].reshaped = false;
    memcpy(c->written[d].linear, identity, sizeof identity);
    memcpy(c->written[d].frame, identity, sizeof identity);
    c->reported[d] = c->written[d];
  }
  for (int32_t f = 0; f < frames; f++)
    memcpy(c->reported_frame + 9 * (int64_t)f, identity, sizeof identity);

  BW_TRY(bwi_subdomain_work_create(context, s, &work));
  memset(work.action, BWI_SUBDOMAIN_GATHER, (size_t)subdomain_count);
  BW_TRY(bwi_subdomain_work_prepare(context, mesh, &work));
  BW_TRY(bwi_subdomain_gather_rest(context, &work));
  for (int32_t d = 0; d < subdomain_count; d++) {
    double elasticity[81];
    bwi_subdomain_elasticity(s, d, identity, elasticity);
    bwi_subdomain_map(elasticity, identity, c->map + BWI_SUBDOMAIN_MAP * (int64_t)d);
  }
  BW_TRY(bwi_subdomain_write(context, &work));
  *stiffness = s;
  s = NULL;
done:
  bwi_subdomain_work_clear(&work);
  bw_release(s);
  return status;
}
