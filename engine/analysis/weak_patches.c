/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* Regions that stand for the mean stress over a patch of the boundary.
 *
 * The mean is a sum over nodes n of w_n sigma_n, sigma_n = sum over the elements around n of
 * (V_e / V_n) sigma_e(x_n) (bw_nodal_stress). So element e has the weight B_e, the sum over its
 * nodes of w_n V_e / V_n, and since stress is linear in a straight element, the place in it is the
 * mean of its nodes' with these parts of B_e. Parts are not negative: the place lies in the
 * element. */
#include "analysis/surface_patch.h"
#include "analysis/weak_internal.h"

#include <math.h>
#include <string.h>

typedef struct collected {
  const bw_mesh *mesh;
  const bwi_surface_patches *patches;
  bwi_incidence around;   /* elements around every node */
  double *volume;         /* by element */
  double *of_node, total; /* w_n times `total`; 0 but for the nodes of the list */
  double *of_element;     /* B_e, 0 but for the elements of the list */
  double *place;          /* element_count x 4, times B_e */
  int32_t *node, nodes, *element, elements;
} collected;

static bw_status begin(bw_context *context, const bw_mesh *mesh, collected *c) {
  bw_status status;
  c->mesh = mesh;
  c->volume = BW_NEW(context, double, mesh->element_count);
  c->of_node = BW_NEW0(context, double, mesh->node_count);
  c->of_element = BW_NEW0(context, double, mesh->element_count);
  c->place = BW_NEW0(context, double, 4 * (size_t)mesh->element_count);
  c->node = BW_NEW(context, int32_t, mesh->node_count);
  c->element = BW_NEW(context, int32_t, mesh->element_count);
  if (!c->volume || !c->of_node || !c->of_element || !c->place || !c->node || !c->element)
    return BW_MEMORY;
  BW_TRY(bwi_incidence_create(context, mesh, &c->around));
  for (int32_t e = 0; e < mesh->element_count; e++)
    c->volume[e] = bwi_shape_integrals(mesh, e, NULL, NULL);
done:
  return status;
}

static void end(collected *c) {
  bwi_incidence_clear(&c->around);
  bw_free(c->volume);
  bw_free(c->of_node);
  bw_free(c->of_element);
  bw_free(c->place);
  bw_free(c->node);
  bw_free(c->element);
}

static void add_node(collected *c, int32_t node, double part) {
  if (c->of_node[node] == 0 && part > 0)
    c->node[c->nodes++] = node;
  c->of_node[node] += part;
  c->total += part;
}

static void add_facet(void *data, int32_t facet, const double share[BWI_PATCH_SAMPLES]) {
  collected *c = (collected *)data;
  const int32_t *node = c->mesh->facet + (size_t)facet * (size_t)c->mesh->nodes_per_facet;
  for (int a = 0; a < c->mesh->nodes_per_facet; a++) {
    double part = 0;
    for (int k = 0; k < BWI_PATCH_SAMPLES; k++)
      part += share[k] * c->patches->weight[k][a];
    add_node(c, node[a], part);
  }
}

/* From nodes to the elements around them; clears the nodes. */
static void spread_to_elements(collected *c) {
  for (int32_t i = 0; i < c->nodes; i++) {
    int32_t n = c->node[i];
    double whole = 0;
    for (int64_t k = c->around.start[n]; k < c->around.start[n + 1]; k++)
      whole += c->volume[c->around.element[k]];
    for (int64_t k = c->around.start[n]; k < c->around.start[n + 1]; k++) {
      int32_t e = c->around.element[k];
      double part = c->of_node[n] / c->total * c->volume[e] / whole, l[4];
      if (c->of_element[e] == 0)
        c->element[c->elements++] = e;
      c->of_element[e] += part;
      bwi_node_place(c->around.local[k], l);
      for (int j = 0; j < 4; j++)
        c->place[4 * (size_t)e + (size_t)j] += part * l[j];
    }
    c->of_node[n] = 0;
  }
  c->nodes = 0;
  c->total = 0;
}

/* What was collected, in the direction of `stress`; clears the elements. */
static bw_status set_region(bw_context *context, collected *c, const double stress[6],
                            bw_weak_region *r) {
  bw_free(r->element);
  bw_free(r->weight);
  r->volume = r->peak = 0;
  r->count = c->elements;
  r->element = BW_NEW(context, int32_t, c->elements);
  r->weight = BW_NEW(context, double, 6 * (size_t)c->elements);
  r->place = BW_NEW(context, double, 4 * (size_t)c->elements);
  if (!r->element || !r->weight || !r->place)
    return BW_MEMORY;
  for (int32_t k = 0; k < c->elements; k++) {
    int32_t e = r->element[k] = c->element[k];
    bwi_directed_weight(stress, c->of_element[e] / c->volume[e], r->weight + 6 * (size_t)k);
    for (size_t j = 0; j < 4; j++) {
      r->place[4 * (size_t)k + j] = c->place[4 * (size_t)e + j] / c->of_element[e];
      c->place[4 * (size_t)e + j] = 0;
    }
    r->volume += c->volume[e];
    c->of_element[e] = 0;
  }
  c->elements = 0;
  return BW_OK;
}

static bw_status check_patch(bw_context *context, const bwi_surface_patches *patches, int64_t i,
                             int32_t node, const double stress[6]) {
  if (node < 0 || node >= patches->mesh->node_count ||
      patches->around.start[node] == patches->around.start[node + 1])
    return bw_fail(context, BW_INVALID, "node %d is not on the boundary", node);
  double largest = 0;
  for (int k = 0; k < 6; k++)
    largest = fmax(largest, fabs(stress[k]));
  if (!isfinite(largest) || !(largest > 0))
    return bw_fail(context, BW_INVALID,
                   "the stress of patch %lld must be finite and not zero to have a direction",
                   (long long)i);
  return BW_OK;
}

bw_status bw_weak_regions_patches(bw_context *context, const bw_mesh *mesh, double radius,
                                  int64_t count, const int32_t *node, const double *stress,
                                  bw_weak_regions **result) {
  bw_status status;
  bw_weak_regions *regions = NULL;
  bwi_surface_patches patches = {.mesh = mesh};
  collected c = {.patches = &patches};
  int32_t *first = BW_NEW(context, int32_t, count);
  if (!first) {
    status = BW_MEMORY;
    goto done;
  }
  BW_TRY(begin(context, mesh, &c));
  BW_TRY(bwi_surface_patches_begin(context, mesh, radius, &patches));
  for (int64_t i = 0; i < count; i++) {
    BW_TRY(check_patch(context, &patches, i, node[i], stress + 6 * i));
    first[i] = mesh->facet_element[patches.around.element[patches.around.start[node[i]]]];
  }
  BW_TRY(bwi_element_regions(context, mesh, count, first, BW_WORST_DIRECTION, &regions));
  for (int64_t i = 0; i < count; i++) {
    bwi_surface_patch_visit(&patches, node[i], (int32_t)i + 1, 0, add_facet, &c);
    if (c.nodes == 0) /* the radius is less than the first sample's distance */
      add_node(&c, node[i], 1);
    spread_to_elements(&c);
    BW_TRY(set_region(context, &c, stress + 6 * i, &regions->region[i]));
  }
  *result = regions;
  regions = NULL;
done:
  bw_release(regions);
  bwi_surface_patches_clear(&patches);
  end(&c);
  bw_free(first);
  return status;
}
