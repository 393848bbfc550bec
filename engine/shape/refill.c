/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* Refilling parts of an edited mesh: what is to be replaced falls into components connected through
 * faces; the boundary of each is checked and refilled (refill_component.c), and the parts are
 * joined again (refill_join.c). */
#include "shape/mesh_repair_internal.h"

#include <math.h>
#include <string.h>

/* ---- components ------------------------------------------------------------------------------ */

static bw_status find_components(bwi_refiller *r, const uint8_t *replace) {
  const bw_mesh *mesh = r->mesh;
  int32_t count = 0;
  size_t capacity = 0;
  r->component_of = BW_NEW(r->context, int32_t, mesh->element_count);
  r->ordered = BW_NEW(r->context, int32_t, mesh->element_count);
  r->number = BW_NEW(r->context, int32_t, mesh->node_count);
  if (!r->component_of || !r->ordered || !r->number)
    return BW_MEMORY;
  for (int32_t e = 0; e < mesh->element_count; e++) {
    r->component_of[e] = -1;
    r->kept += !replace[e];
  }
  if (r->kept == mesh->element_count)
    return bw_fail(r->context, BW_EMPTY, "none of the %d elements is to be replaced",
                   mesh->element_count);
  for (int32_t seed = 0; seed < mesh->element_count; seed++) {
    if (!replace[seed] || r->component_of[seed] >= 0)
      continue;
    if (!bw_grow(r->context, (void **)&r->component, &capacity, (size_t)r->components, 1,
                 sizeof *r->component))
      return BW_MEMORY;
    bwi_component *p = &r->component[r->components];
    *p = (bwi_component){.first = count};
    r->component_of[seed] = r->components++;
    r->ordered[count++] = seed;
    for (int32_t at = p->first; at < count; at++)
      for (size_t k = 0; k < 4; k++) {
        int32_t other = mesh->neighbour[4 * (size_t)r->ordered[at] + k];
        if (other >= 0 && replace[other] && r->component_of[other] < 0) {
          r->component_of[other] = r->component_of[seed];
          r->ordered[count++] = other;
        }
      }
    p->element_count = count - p->first;
  }
  return BW_OK;
}

/* Kept elements are not repaired here. */
static bw_status check_kept(const bwi_refiller *r) {
  for (int64_t i = 0; i < 3 * (int64_t)r->mesh->node_count; i++)
    if (!isfinite(r->node[i])) {
      bw_fail(r->context, BW_INVALID, "node %d is not at a finite place", (int)(i / 3) + 1);
      bw_detail_number(r->context, "node", (double)(i / 3 + 1));
      return BW_INVALID;
    }
  for (int32_t e = 0; e < r->mesh->element_count; e++) {
    const int32_t *c = bwi_nodes_of(r->mesh, e);
    const double *const x[4] = {r->node + 3 * (size_t)c[0], r->node + 3 * (size_t)c[1],
                                r->node + 3 * (size_t)c[2], r->node + 3 * (size_t)c[3]};
    if (r->component_of[e] >= 0 || bwi_checked_quality(x) > 0)
      continue;
    bw_fail(r->context, BW_GEOMETRY,
            "the mesh is folded over itself near (%g, %g, %g) m, which is not among what is to be "
            "replaced",
            x[0][0], x[0][1], x[0][2]);
    bw_detail_number(r->context, "element", e + 1.0);
    return BW_GEOMETRY;
  }
  return BW_OK;
}

/* The region of most elements of a component, the lowest of several. */
static int32_t common_region(const bwi_refiller *r, const bwi_component *p) {
  const int32_t *region = r->mesh->region;
  int32_t best = 0, max = 0, candidate = 0;
  if (!region)
    return 0;
  bool more = true;
  for (int32_t last = INT32_MIN, first = 1; more; first = 0, last = candidate) {
    int32_t votes = 0;
    more = false;
    for (int32_t i = p->first; i < p->first + p->element_count; i++) {
      int32_t here = region[r->ordered[i]];
      if (!first && here <= last)
        continue;
      if (!more || here < candidate) {
        candidate = here;
        votes = 0;
        more = true;
      }
      votes += here == candidate;
    }
    if (more && votes > max) {
      max = votes;
      best = candidate;
    }
  }
  return best;
}

/* Mean length of the old edges at each corner of a component, in its new place: the size wanted. */
static bw_status measure_edges(bwi_refiller *r, const bwi_component *p, double **sample,
                               double **length, int64_t *count) {
  bw_status status = BW_OK;
  int32_t corners = 0, *edges = NULL;
  for (int32_t i = 0; i < r->mesh->node_count; i++)
    r->number[i] = -1;
  for (int32_t i = p->first; i < p->first + p->element_count; i++)
    for (int k = 0; k < 4; k++) {
      int32_t c = bwi_nodes_of(r->mesh, r->ordered[i])[k];
      if (r->number[c] < 0)
        r->number[c] = corners++;
    }
  double *at = BW_NEW(r->context, double, 3 * (size_t)corners);
  double *sum = BW_NEW0(r->context, double, corners);
  edges = BW_NEW0(r->context, int32_t, corners);
  BW_TRY_MEMORY(at && sum && edges);
  for (int32_t i = p->first; i < p->first + p->element_count; i++) {
    const int32_t *c = bwi_nodes_of(r->mesh, r->ordered[i]);
    for (int k = 0; k < 6; k++) {
      int32_t a = c[bw_tet_edge[k][0]], b = c[bw_tet_edge[k][1]], na = r->number[a],
              nb = r->number[b];
      double d[3];
      for (size_t j = 0; j < 3; j++)
        d[j] = r->node[3 * (size_t)b + j] - r->node[3 * (size_t)a + j];
      double size = bw_norm(d);
      sum[na] += size;
      sum[nb] += size;
      edges[na]++;
      edges[nb]++;
      memcpy(at + 3 * (size_t)na, r->node + 3 * (size_t)a, 3 * sizeof *at);
      memcpy(at + 3 * (size_t)nb, r->node + 3 * (size_t)b, 3 * sizeof *at);
    }
  }
  for (int32_t i = 0; i < corners; i++)
    sum[i] /= edges[i];
done:
  bw_free(edges);
  if (status != BW_OK) {
    bw_free(at);
    bw_free(sum);
    return status;
  }
  *sample = at;
  *length = sum;
  *count = corners;
  return BW_OK;
}

/* The boundary of a component as a surface; p->corner tells the old nodes. element_of (may be
 * NULL): the element behind each facet. */
static bw_status component_boundary(bwi_refiller *r, bwi_component *p, bw_surface **surface,
                                    int32_t *element_of) {
  bw_status status = BW_OK;
  int32_t *triangle = NULL;
  double *point = NULL;
  for (int32_t i = 0; i < r->mesh->node_count; i++)
    r->number[i] = -1;
  p->facet_count = p->corners = 0;
  for (int32_t i = p->first; i < p->first + p->element_count; i++)
    for (int k = 0; k < 4; k++)
      if (bwi_on_component_boundary(r, r->ordered[i], k)) {
        p->facet_count++;
        for (int j = 0; j < 3; j++)
          r->number[bwi_nodes_of(r->mesh, r->ordered[i])[bw_tet_face[k][j]]] = 0;
      }
  for (int32_t i = 0; i < r->mesh->node_count; i++)
    if (r->number[i] == 0)
      r->number[i] = p->corners++;
  triangle = BW_NEW(r->context, int32_t, 3 * (size_t)p->facet_count);
  point = BW_NEW(r->context, double, 3 * (size_t)p->corners);
  p->corner = BW_NEW(r->context, int32_t, p->corners);
  BW_TRY_MEMORY(triangle && point && p->corner);
  for (int32_t i = 0; i < r->mesh->node_count; i++)
    if (r->number[i] >= 0) {
      p->corner[r->number[i]] = i;
      memcpy(point + 3 * (size_t)r->number[i], r->node + 3 * (size_t)i, 3 * sizeof *point);
    }
  int32_t at = 0;
  for (int32_t i = p->first; i < p->first + p->element_count; i++)
    for (int k = 0; k < 4; k++)
      if (bwi_on_component_boundary(r, r->ordered[i], k)) {
        for (int j = 0; j < 3; j++)
          triangle[3 * (size_t)at + (size_t)j] =
              r->number[bwi_nodes_of(r->mesh, r->ordered[i])[bw_tet_face[k][j]]];
        element_of[at++] = r->ordered[i];
      }
  BW_TRY(bw_surface_adopt(r->context, p->corners, point, p->facet_count, triangle, NULL, surface));
  point = NULL;
  triangle = NULL;
done:
  bw_free(triangle);
  bw_free(point);
  return status;
}

/* A boundary that cuts itself, or has inward normals, cannot be filled. */
static bw_status check_boundary(const bwi_refiller *r, int32_t number, const bw_surface *surface,
                                const int32_t *element_of) {
  bw_surface_report report = {0};
  bw_status status;
  BW_TRY(bw_surface_check(r->context, surface, 1, &report));
  for (int64_t i = 0; i < report.defect_count; i++) {
    const bw_defect *d = &report.defect[i];
    if (d->kind != BW_DEFECT_SELF_INTERSECTION && d->kind != BW_DEFECT_ZERO_AREA &&
        d->kind != BW_DEFECT_DUPLICATE_FACET)
      continue;
    const char *what = d->kind == BW_DEFECT_SELF_INTERSECTION ? "cuts itself"
                       : d->kind == BW_DEFECT_ZERO_AREA       ? "has a facet without area"
                                                              : "lies on itself";
    status =
        bw_fail(r->context, BW_GEOMETRY,
                "the boundary of what is to be replaced %s at (%g, %g, %g) m (%lld such places): "
                "undo the edit or make it smaller",
                what, d->at[0], d->at[1], d->at[2], (long long)report.count[d->kind]);
    bw_detail_number(r->context, "element", element_of[d->facet] + 1.0);
    bw_detail_number(r->context, "component", number + 1.0);
    goto done;
  }
  if (!(report.volume > 0)) {
    status = bw_fail(r->context, BW_GEOMETRY,
                     "the boundary of what is to be replaced has inward normals: it encloses %g m3 "
                     "near (%g, %g, %g) m",
                     report.volume, surface->point[0], surface->point[1], surface->point[2]);
    bw_detail_number(r->context, "component", number + 1.0);
  }
done:
  bw_surface_report_clear(&report);
  return status;
}

static bw_status fill_component(bwi_refiller *r, int32_t number) {
  bwi_component *p = &r->component[number];
  bw_surface *surface = NULL;
  double *sample = NULL, *length = NULL;
  int64_t samples = 0;
  bw_status status;
  int32_t *element_of = BW_NEW(r->context, int32_t, 4 * (size_t)p->element_count);
  if (!element_of)
    return BW_MEMORY;
  BW_TRY(measure_edges(r, p, &sample, &length, &samples));
  BW_TRY(component_boundary(r, p, &surface, element_of));
  BW_TRY(check_boundary(r, number, surface, element_of));
  p->region = common_region(r, p);
  BW_TRY(bwi_fill_exactly(r->context, surface, samples, sample, length, &p->filled));
done:
  bw_free(element_of);
  bw_free(sample);
  bw_free(length);
  bw_release(surface);
  return status;
}

/* The facets, in their old order, have their old groups. */
static bw_status keep_groups(bw_context *context, const bw_mesh *mesh, bw_mesh *made) {
  if (!mesh->names)
    return BW_OK;
  int32_t *group = BW_NEW(context, int32_t, mesh->facet_count);
  if (!group)
    return BW_MEMORY;
  memcpy(group, mesh->facet_group, (size_t)mesh->facet_count * sizeof *group);
  bwi_mesh_adopt_groups(made, group, mesh->names);
  return BW_OK;
}

bw_status bw_mesh_refill(bw_context *context, const bw_mesh *mesh, const double *node,
                         const uint8_t *replace, bw_mesh **refilled, int32_t **node_from,
                         int32_t **element_from) {
  bwi_refiller r = {.context = context, .mesh = mesh, .node = node};
  bw_mesh_regions regions = bw_mesh_regions_of(mesh);
  bw_mesh *made = NULL;
  bw_status status;
  BW_TRY(find_components(&r, replace));
  BW_TRY(check_kept(&r));
  for (int32_t p = 0; p < r.components; p++) {
    bw_progress(context, "refilling", (double)p / r.components);
    BW_TRY(fill_component(&r, p));
  }
  BW_TRY(bwi_refill_join(&r));
  regions.of_element = r.region;
  BW_TRY(bw_mesh_adopt(context, mesh->order, r.node_count, r.new_node, r.element_count, r.element,
                       &regions, &made));
  r.new_node = NULL;
  r.element = NULL;
  if (made->node_count != r.node_count)
    BW_TRY(bw_fail(context, BW_INTERNAL, "%lld nodes became %d when a part was remeshed",
                   (long long)r.node_count, made->node_count));
  BW_TRY(bwi_refill_order_facets(&r, made));
  BW_TRY(keep_groups(context, mesh, made));
  *refilled = made;
  made = NULL;
  if (node_from) {
    *node_from = r.node_from;
    r.node_from = NULL;
  }
  if (element_from) {
    *element_from = r.element_from;
    r.element_from = NULL;
  }
done:
  bw_release(made);
  for (int32_t p = 0; p < r.components; p++) {
    bw_free(r.component[p].corner);
    bw_free(r.component[p].filled.node);
    bw_free(r.component[p].filled.element);
  }
  bw_free(r.component);
  bw_free(r.component_of);
  bw_free(r.ordered);
  bw_free(r.number);
  bw_free(r.new_node);
  bw_free(r.element);
  bw_free(r.region);
  bw_free(r.node_from);
  bw_free(r.element_from);
  return status;
}
