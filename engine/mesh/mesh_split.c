/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* Regions cut off by a surface, and the facets between regions. */
#include "mesh/mesh_internal.h"

#include <stdlib.h>
#include <string.h>

/* ---- splitting ------------------------------------------------------------------------------ */

enum { SAMPLES = 64, BATCH = 512 };

/* A tetrahedron cut into eight of equal volume, and those likewise: their centroids, barycentric.
 */
static int place_samples(double corner[4][4], int levels, double (*sample)[4], int count) {
  if (levels == 0) {
    for (int k = 0; k < 4; k++)
      sample[count][k] = 0.25 * (corner[0][k] + corner[1][k] + corner[2][k] + corner[3][k]);
    return count + 1;
  }
  /* Corners, and the mid-edge nodes 01 12 20 03 13 23 as 4 to 9; the octahedron in the middle is
   * cut around its diagonal from 4 to 9. */
  static const int part[8][4] = {{0, 4, 6, 7}, {4, 1, 5, 8}, {6, 5, 2, 9}, {7, 8, 9, 3},
                                 {4, 9, 7, 8}, {4, 9, 8, 5}, {4, 9, 5, 6}, {4, 9, 6, 7}};
  double node[10][4], child[4][4];
  memcpy(node, corner, 4 * sizeof node[0]);
  for (int e = 0; e < 6; e++)
    for (int k = 0; k < 4; k++)
      node[4 + e][k] = 0.5 * (node[bw_tet_edge[e][0]][k] + node[bw_tet_edge[e][1]][k]);
  for (int p = 0; p < 8; p++) {
    for (int a = 0; a < 4; a++)
      memcpy(child[a], node[part[p][a]], sizeof child[a]);
    count = place_samples(child, levels - 1, sample, count);
  }
  return count;
}

static void place_in(const bw_mesh *mesh, int32_t e, const double weight[4], double at[3]) {
  const int32_t *node = mesh->element + (int64_t)e * mesh->nodes_per_element;
  for (int k = 0; k < 3; k++) {
    at[k] = 0;
    for (int a = 0; a < 4; a++)
      at[k] += weight[a] * mesh->node[3 * (int64_t)node[a] + k];
  }
}

typedef struct splitting {
  bw_context *context;
  const bw_mesh *mesh;
  bw_inside *inside;
  void *data;
  uint8_t *of_element, *of_node; /* inside: centroids, nodes */
} splitting;

static bw_status find_sides(splitting *s) {
  static const double middle[4] = {0.25, 0.25, 0.25, 0.25};
  bw_status status = BW_OK;
  double *at = BW_NEW(s->context, double, 3 * (size_t)s->mesh->element_count);
  s->of_element = BW_NEW0(s->context, uint8_t, s->mesh->element_count);
  s->of_node = BW_NEW0(s->context, uint8_t, s->mesh->node_count);
  BW_TRY_MEMORY(at && s->of_element && s->of_node);
  for (int32_t e = 0; e < s->mesh->element_count; e++)
    place_in(s->mesh, e, middle, at + 3 * (int64_t)e);
  BW_TRY(s->inside(s->data, s->mesh->element_count, at, s->of_element));
  status = s->inside(s->data, s->mesh->node_count, s->mesh->node, s->of_node);
done:
  bw_free(at);
  return status;
}

static bool is_cut(const splitting *s, int32_t e) {
  const int32_t *node = s->mesh->element + (int64_t)e * s->mesh->nodes_per_element;
  for (int a = 0; a < 4; a++)
    if (!s->of_node[node[a]] != !s->of_element[e])
      return true;
  return false;
}

static bw_status measure_cut(const splitting *s, const int32_t *cut, int32_t count, double *sample,
                             double *at, uint8_t *in, bw_split_log *log) {
  for (int32_t i = 0; i < count; i++)
    for (int p = 0; p < SAMPLES; p++)
      place_in(s->mesh, cut[i], sample + 4 * p, at + 3 * ((size_t)SAMPLES * (size_t)i + (size_t)p));
  bw_status status = s->inside(s->data, (int64_t)SAMPLES * count, at, in);
  for (int32_t i = 0; i < count && status == BW_OK; i++) {
    int other = 0;
    for (int p = 0; p < SAMPLES; p++)
      other += !in[SAMPLES * i + p] != !s->of_element[cut[i]];
    log->misplaced += s->mesh->volume[cut[i]] * other / SAMPLES;
    log->cut += other > 0;
  }
  return status;
}

static bw_status measure(const splitting *s, bw_split_log *log) {
  bw_status status = BW_OK;
  double corner[4][4] = {{1, 0, 0, 0}, {0, 1, 0, 0}, {0, 0, 1, 0}, {0, 0, 0, 1}};
  double sample[SAMPLES][4];
  int32_t cut[BATCH], count = 0, last = s->mesh->element_count - 1;
  place_samples(corner, 2, sample, 0);
  double *at = BW_NEW(s->context, double, 3 * SAMPLES * BATCH);
  uint8_t *in = BW_NEW0(s->context, uint8_t, SAMPLES * BATCH);
  BW_TRY_MEMORY(at && in);
  *log = (bw_split_log){0, 0, 0};
  for (int32_t e = 0; e <= last; e++) {
    if (s->of_element[e])
      log->volume += s->mesh->volume[e];
    if (is_cut(s, e))
      cut[count++] = e;
    if (count == BATCH || (e == last && count > 0)) {
      BW_TRY(bw_check_cancel(s->context));
      BW_TRY(measure_cut(s, cut, count, sample[0], at, in, log));
      count = 0;
    }
  }
done:
  bw_free(at);
  bw_free(in);
  return status;
}

static bw_status check_name(bw_context *context, const bw_mesh *mesh, const char *name) {
  if (!name[0] || strlen(name) >= BW_NAME)
    return bw_fail(context, BW_INVALID, "the name of a region has 1 to %d bytes, but '%s' has %zu",
                   BW_NAME - 1, name, strlen(name));
  if (bw_mesh_find_region(mesh, name) >= 0)
    return bw_fail(context, BW_INVALID, "there is already a region '%s': give another name", name);
  if (mesh->region_count > 0 && mesh->regions[mesh->region_count - 1].tag == INT32_MAX)
    return bw_fail(context, BW_LIMIT, "the region '%s' has the largest tag: there is none above it",
                   mesh->regions[mesh->region_count - 1].name.text);
  return BW_OK;
}

/* The table of the mesh with one more region, the last one. */
static bw_status name_regions(const splitting *s, const char *name, bw_mesh **split) {
  const bw_mesh *mesh = s->mesh;
  bw_status status = BW_OK;
  int32_t before = mesh->region_count > 0 ? mesh->region_count : 1;
  bw_mesh_region *region = BW_NEW0(s->context, bw_mesh_region, before + 1);
  int32_t *of_element = BW_NEW0(s->context, int32_t, mesh->element_count);
  BW_TRY_MEMORY(region && of_element);
  if (mesh->region_count > 0)
    memcpy(region, mesh->regions, (size_t)before * sizeof *region);
  else
    region[0] = (bw_mesh_region){1, 0, {"rest"}};
  region[before].tag = region[before - 1].tag + 1;
  memcpy(region[before].name.text, name, strlen(name) + 1);
  for (int32_t e = 0; e < mesh->element_count; e++)
    of_element[e] = s->of_element[e] ? before : mesh->region ? mesh->region[e] : 0;
  bw_mesh_regions regions = {before + 1, region, of_element};
  status = bw_mesh_with_regions(s->context, mesh, &regions, split);
done:
  bw_free(region);
  bw_free(of_element);
  return status;
}

bw_status bw_mesh_split(bw_context *context, const bw_mesh *mesh, const char *name,
                        bw_inside *inside, void *data, bw_mesh **split, bw_split_log *log) {
  splitting s = {.context = context, .mesh = mesh, .inside = inside, .data = data};
  int32_t count = 0;
  bw_status status;
  BW_TRY(check_name(context, mesh, name));
  BW_TRY(find_sides(&s));
  for (int32_t e = 0; e < mesh->element_count; e++)
    count += s.of_element[e] != 0;
  if (count == 0 || count == mesh->element_count)
    BW_TRY(bw_fail(context, BW_EMPTY,
                   "the centroids of %s elements are inside what the mesh is split at: the region "
                   "'%s' would be %s",
                   count == 0 ? "no" : "all", name, count == 0 ? "empty" : "the whole mesh"));
  if (log)
    BW_TRY(measure(&s, log));
  status = name_regions(&s, name, split);
done:
  bw_free(s.of_element);
  bw_free(s.of_node);
  return status;
}

/* ---- a region with nodes of its own --------------------------------------------------------- */

bw_status bw_mesh_separate(bw_context *context, const bw_mesh *mesh, int32_t region,
                           bw_mesh **separated) {
  bw_status status = BW_OK;
  const int n = mesh->nodes_per_element;
  const int64_t entries = (int64_t)mesh->element_count * n;
  int64_t count = mesh->node_count;
  double *node = NULL;
  int32_t *element = NULL, *copy = NULL;
  if (region < 0 || region >= mesh->region_count)
    return bw_fail(context, BW_INVALID, "there is no region %d: there are %d", region + 1,
                   mesh->region_count);
  copy = BW_NEW0(context, int32_t, mesh->node_count);
  element = BW_NEW(context, int32_t, entries);
  BW_TRY_MEMORY(copy && element);
  for (int64_t k = 0; k < entries; k++) /* 1: of the region, 2: of others, 3: of both */
    copy[mesh->element[k]] |= mesh->region[k / n] == region ? 1 : 2;
  for (int32_t i = 0; i < mesh->node_count; i++) {
    if (copy[i] == 3 && count == INT32_MAX)
      BW_TRY(bw_fail(context, BW_LIMIT,
                     "region '%s' cannot have nodes of its own: the mesh would have more than 2^31 "
                     "- 1 nodes",
                     mesh->regions[region].name.text));
    copy[i] = copy[i] == 3 ? (int32_t)count++ : i;
  }
  if (count == mesh->node_count) {
    *separated = bw_retain(mesh);
    goto done;
  }
  node = BW_NEW(context, double, 3 * count);
  BW_TRY_MEMORY(node);
  memcpy(node, mesh->node, 3 * (size_t)mesh->node_count * sizeof *node);
  for (int32_t i = 0; i < mesh->node_count; i++)
    if (copy[i] != i)
      memcpy(node + 3 * (int64_t)copy[i], mesh->node + 3 * (int64_t)i, 3 * sizeof *node);
  for (int64_t k = 0; k < entries; k++)
    element[k] = mesh->region[k / n] == region ? copy[mesh->element[k]] : mesh->element[k];
  const bw_mesh_regions regions = bw_mesh_regions_of(mesh);
  BW_TRY(bw_mesh_adopt(context, mesh->order, count, node, mesh->element_count, element, &regions,
                       separated));
  node = NULL;
  element = NULL;
  (*separated)->surface_moved = mesh->surface_moved;
  status = bwi_mesh_keep_names(context, mesh, NULL, separated);
done:
  bw_free(node);
  bw_free(element);
  bw_free(copy);
  return status;
}

/* ---- facets between regions ----------------------------------------------------------------- */

static double facet_area(const bw_mesh *mesh, const int32_t *corner) {
  double u[3], v[3];
  const double *x = mesh->node + 3 * (int64_t)corner[0];
  for (int k = 0; k < 3; k++) {
    u[k] = mesh->node[3 * (int64_t)corner[1] + k] - x[k];
    v[k] = mesh->node[3 * (int64_t)corner[2] + k] - x[k];
  }
  bw_cross(u, v, u);
  return 0.5 * bw_norm(u);
}

/* Corners and mid-edge nodes of face k of an element; `turned`: seen from the element. */
static void write_facet(const bw_mesh *mesh, int32_t e, int face, bool turned, int32_t *facet) {
  static const int back[3] = {0, 2, 1}, back_middle[3] = {2, 1, 0};
  const int32_t *node = mesh->element + (int64_t)e * mesh->nodes_per_element;
  for (int k = 0; k < 3; k++) {
    facet[k] = node[bw_tet_face[face][turned ? back[k] : k]];
    if (mesh->order == 2)
      facet[3 + k] = node[bw_tet_face_mid_edge[face][turned ? back_middle[k] : k]];
  }
}

void bw_mesh_interface_clear(bw_mesh_interface *interface) {
  bw_free(interface->facet);
  bw_free(interface->element);
  *interface = (bw_mesh_interface){0, NULL, NULL, 0};
}

bw_status bw_mesh_interface_find(bw_context *context, const bw_mesh *mesh, int32_t a, int32_t b,
                                 bw_mesh_interface *interface) {
  const int32_t low = a < b ? a : b, high = a < b ? b : a;
  if (low < 0 || high >= mesh->region_count || low == high)
    return bw_fail(context, BW_INVALID,
                   "an interface between the regions %d and %d: two different regions from 1 to %d "
                   "were expected",
                   a + 1, b + 1, mesh->region_count);
  *interface = (bw_mesh_interface){0, NULL, NULL, 0};
  for (int pass = 0; pass < 2; pass++) { /* count, then write */
    int64_t count = 0;
    for (int64_t side = 0; side < 4 * (int64_t)mesh->element_count; side++) {
      int32_t e = (int32_t)(side / 4), other = mesh->neighbour[side];
      if (mesh->region[e] != low || other < 0 || mesh->region[other] != high)
        continue;
      if (pass == 1) {
        int32_t *facet = interface->facet + count * mesh->nodes_per_facet;
        write_facet(mesh, e, (int)(side % 4), a > b, facet);
        interface->element[2 * count + (a > b)] = e;
        interface->element[2 * count + (a < b)] = other;
        interface->area += facet_area(mesh, facet);
      }
      count++;
    }
    if (count > INT32_MAX)
      return bw_fail(context, BW_LIMIT, "%lld facets between two regions: at most %d are listed",
                     (long long)count, INT32_MAX);
    if (pass == 1)
      break;
    interface->count = (int32_t)count;
    interface->facet = BW_NEW(context, int32_t, count * mesh->nodes_per_facet);
    interface->element = BW_NEW(context, int32_t, 2 * count);
    if (!interface->facet || !interface->element) {
      bw_mesh_interface_clear(interface);
      return BW_MEMORY;
    }
  }
  return BW_OK;
}
