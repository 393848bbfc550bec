/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* The three objects of a plane mesh, and meshes from arrays.
 *
 * Invariants of every bw_plane_mesh:
 *   - every node is used by an element, every coordinate is finite, every element is
 *     counter-clockwise with a positive Jacobian (bwi_plane_quality > 0);
 *   - a node with segment >= 0 lies at that parameter of the outline's segment, to within rounding;
 *   - the sides cover every segment of the outline once, in the order of segments and parameters,
 *     and every edge with one element is a side;
 *   - neighbour[3 e + k] is the element across edge k of e, and that element names e in return. */
#include "plane/internal.h"

#include <math.h>
#include <string.h>

/* ---- objects --------------------------------------------------------------------------------- */

static void nodes_destroy(void *object) {
  bw_plane_nodes *nodes = object;
  bw_free(nodes->segment);
  bw_free(nodes->parameter);
  bw_free(nodes);
}

static size_t nodes_bytes(const void *object) {
  const bw_plane_nodes *nodes = object;
  return sizeof *nodes + (size_t)nodes->node_count * (sizeof(int32_t) + sizeof(double));
}

static const bw_kind nodes_kind = {"plane nodes", nodes_destroy, nodes_bytes};

bw_status bwi_plane_nodes_adopt(bw_context *context, int order, int32_t nodes, int32_t corners,
                                int32_t *segment, double *parameter, bw_plane_nodes **out) {
  bw_plane_nodes *made = BW_NEW0(context, bw_plane_nodes, 1);
  if (!made) {
    bw_free(segment);
    bw_free(parameter);
    return BW_MEMORY;
  }
  bw_object_init(made, &nodes_kind);
  made->order = order;
  made->node_count = nodes;
  made->corner_count = corners;
  made->segment = segment;
  made->parameter = parameter;
  *out = made;
  return BW_OK;
}

static void mesh_destroy(void *object) {
  bw_plane_mesh *mesh = object;
  bw_release(mesh->topology);
  bw_release(mesh->outline);
  bw_free(mesh->point);
  bw_free(mesh);
}

static size_t mesh_bytes(const void *object) {
  const bw_plane_mesh *mesh = object;
  return sizeof *mesh + (size_t)mesh->topology->nodes->node_count * 2 * sizeof(double);
}

static const bw_kind mesh_kind = {"plane mesh", mesh_destroy, mesh_bytes};

bw_status bwi_plane_mesh_adopt(bw_context *context, const bw_plane_topology *topology,
                               const bw_outline *outline, double *point, bw_plane_mesh **out) {
  bw_plane_mesh *made = BW_NEW0(context, bw_plane_mesh, 1);
  if (!made) {
    bw_free(point);
    return BW_MEMORY;
  }
  bw_object_init(made, &mesh_kind);
  made->topology = bw_retain(topology);
  made->outline = bw_retain(outline);
  made->point = point;
  *out = made;
  return BW_OK;
}

/* ---- checks ---------------------------------------------------------------------------------- */

bw_status bwi_plane_check_arrays(bw_context *context, int order, int32_t nodes, const double *point,
                                 int32_t elements, const int32_t *element) {
  int width = order == 2 ? 6 : 3;
  if (order != 1 && order != 2)
    return bw_fail(context, BW_INVALID, "order %d: a plane mesh has order 1 or 2", order);
  if (nodes < 3 || elements < 1 || !point || !element)
    return bw_fail(context, BW_INVALID, "a plane mesh needs at least 3 nodes and 1 element");
  for (int64_t i = 0; i < 2 * (int64_t)nodes; i++)
    if (!isfinite(point[i])) {
      bw_fail(context, BW_GEOMETRY,
              "node %lld has the coordinates %g %g: every one must be a finite number",
              (long long)(i / 2) + 1, point[i / 2 * 2], point[i / 2 * 2 + 1]);
      bw_detail_number(context, "node", (double)(i / 2 + 1));
      return BW_GEOMETRY;
    }
  for (int64_t i = 0; i < (int64_t)width * elements; i++)
    if (element[i] < 0 || element[i] >= nodes) {
      bw_fail(context, BW_GEOMETRY, "element %lld names node %d, but the nodes are 1 to %d",
              (long long)(i / width) + 1, element[i] + 1, nodes);
      bw_detail_number(context, "element", (double)(i / width + 1));
      bw_detail_number(context, "node", element[i] + 1.0);
      return BW_GEOMETRY;
    }
  return BW_OK;
}

/* Corners before mid-edge nodes, every node used. */
static bw_status count_corners(bw_context *context, int order, int32_t nodes, int32_t elements,
                               const int32_t *element, int32_t *corners) {
  bw_status status = BW_OK;
  int width = order == 2 ? 6 : 3;
  uint8_t *role = BW_NEW0(context, uint8_t, nodes); /* 1 corner, 2 middle */
  if (!role)
    return BW_MEMORY;
  for (int64_t i = 0; i < (int64_t)width * elements; i++)
    role[element[i]] |= i % width < 3 ? 1 : 2;
  int32_t count = 0;
  while (count < nodes && role[count] == 1)
    count++;
  for (int32_t i = 0; i < nodes && status == BW_OK; i++) {
    if (role[i] == 0)
      status = bw_fail(context, BW_GEOMETRY, "node %d belongs to no element: leave it out", i + 1);
    else if (role[i] != (i < count ? 1 : 2))
      status = bw_fail(context, BW_GEOMETRY,
                       "node %d is %s: corner nodes come first, mid-edge nodes after them", i + 1,
                       role[i] == 3 ? "a corner node of one element and a mid-edge node of another"
                                    : "a corner node behind a mid-edge node");
    if (status != BW_OK)
      bw_detail_number(context, "node", i + 1.0);
  }
  *corners = count;
  bw_free(role);
  return status;
}

static bw_status check_elements(bw_context *context, const bw_plane_topology *topology,
                                const double *point) {
  int order = topology->nodes->order, width = bwi_plane_width(topology->nodes);
  for (int32_t e = 0; e < topology->element_count; e++) {
    const int32_t *n = topology->element + (size_t)e * (size_t)width;
    double quality = bwi_plane_quality(point, n, order);
    if (quality > 0)
      continue;
    const double *a = point + 2 * (size_t)n[0];
    bool folded = order == 2 &&
                  bwi_triangle_quality(a, point + 2 * (size_t)n[1], point + 2 * (size_t)n[2]) > 0;
    bw_fail(context, BW_GEOMETRY,
            folded
                ? "element %d (corners %d %d %d) near (%g, %g) m is folded: a mid-edge node lies "
                  "too far from the middle of its edge"
                : "element %d (corners %d %d %d) near (%g, %g) m is flat or inverted: its corners "
                  "must run counter-clockwise",
            e + 1, n[0] + 1, n[1] + 1, n[2] + 1, a[0], a[1]);
    bw_detail_number(context, "element", e + 1.0);
    bw_detail_number(context, "x", a[0]);
    bw_detail_number(context, "y", a[1]);
    return BW_GEOMETRY;
  }
  return BW_OK;
}

/* Nodes on segments must lie there. */
static bw_status check_places(bw_context *context, const bw_plane_nodes *nodes,
                              const bw_outline *outline, const double *point) {
  double low[2] = {INFINITY, INFINITY}, high[2] = {-INFINITY, -INFINITY};
  for (int64_t i = 0; i < nodes->node_count; i++)
    for (int k = 0; k < 2; k++) {
      low[k] = fmin(low[k], point[2 * i + k]);
      high[k] = fmax(high[k], point[2 * i + k]);
    }
  double reach = 0;
  for (int k = 0; k < 2; k++)
    reach = fmax(reach, fmax(high[k] - low[k], fmax(fabs(low[k]), fabs(high[k]))));
  for (int32_t i = 0; i < nodes->node_count; i++) {
    if (nodes->segment[i] < 0)
      continue;
    double at[2];
    bw_outline_evaluate(outline, nodes->segment[i], nodes->parameter[i], at, NULL, NULL);
    double off = hypot(point[2 * (size_t)i] - at[0], point[2 * (size_t)i + 1] - at[1]);
    if (off <= 1e-9 * reach)
      continue;
    bw_fail(context, BW_GEOMETRY,
            "node %d at (%g, %g) lies %g away from its place on the outline, segment %d at "
            "parameter %g, which is (%g, %g)",
            i + 1, point[2 * (size_t)i], point[2 * (size_t)i + 1], off, nodes->segment[i] + 1,
            nodes->parameter[i], at[0], at[1]);
    bw_detail_number(context, "node", i + 1.0);
    return BW_GEOMETRY;
  }
  return BW_OK;
}

/* Nodes on segments that there are, and neighbours that know each other. */
static bw_status check_topology(bw_context *context, const bw_plane_topology *topology,
                                const bw_outline *outline) {
  const bw_plane_nodes *nodes = topology->nodes;
  for (int32_t i = 0; i < nodes->node_count; i++)
    if (nodes->segment[i] < -1 || nodes->segment[i] >= outline->segment_count ||
        (nodes->segment[i] >= 0 && !(nodes->parameter[i] >= 0 && nodes->parameter[i] < 1)))
      return bw_fail(context, BW_INTERNAL, "node %d is at parameter %g of segment %d of %d", i + 1,
                     nodes->parameter[i], nodes->segment[i] + 1, outline->segment_count);
  for (int64_t h = 0; h < 3 * (int64_t)topology->element_count; h++) {
    int64_t element = h / 3, other = topology->neighbour[h];
    bool back = other == -1;
    if (other < -1 || other >= topology->element_count)
      return bw_fail(context, BW_INTERNAL, "element %lld is beside element %lld of %d",
                     (long long)element + 1, (long long)other + 1, topology->element_count);
    for (int64_t k = 3 * other; other >= 0 && k < 3 * other + 3; k++)
      back = back || topology->neighbour[k] == element;
    if (!back)
      return bw_fail(context, BW_INTERNAL, "element %lld is beside %lld, which is not beside it",
                     (long long)element + 1, (long long)other + 1);
  }
  for (int64_t k = 0; k < topology->side_count; k++)
    if (topology->side_segment[k] < 0 || topology->side_segment[k] >= outline->segment_count ||
        topology->side_element[2 * k] < 0 ||
        topology->side_element[2 * k] >= topology->element_count)
      return bw_fail(context, BW_INTERNAL, "side %lld is of element %d and segment %d",
                     (long long)k + 1, topology->side_element[2 * k] + 1,
                     topology->side_segment[k] + 1);
  return BW_OK;
}

bw_status bw_plane_mesh_check(bw_context *context, const bw_plane_mesh *mesh) {
  bw_status status = BW_OK;
  const bw_plane_topology *topology = mesh->topology;
  const bw_plane_nodes *nodes = topology->nodes;
  BW_TRY(bwi_plane_check_arrays(context, nodes->order, nodes->node_count, mesh->point,
                                topology->element_count, topology->element));
  BW_TRY(check_topology(context, topology, mesh->outline));
  BW_TRY(check_elements(context, topology, mesh->point));
  BW_TRY(check_places(context, nodes, mesh->outline, mesh->point));
done:
  return status;
}

/* ---- meshes from arrays ---------------------------------------------------------------------- */

bw_status bw_plane_mesh_on(bw_context *context, const bw_outline *outline, int order, int32_t nodes,
                           const double *point, const int32_t *segment, const double *parameter,
                           int32_t elements, const int32_t *element, const int32_t *region,
                           bw_plane_mesh **mesh) {
  bw_status status = BW_OK;
  bw_plane_nodes *made_nodes = NULL;
  bw_plane_topology *topology = NULL;
  int32_t *segments = NULL, *corner = NULL, *regions = NULL, corners = 0;
  double *parameters = NULL, *points = NULL;
  BW_TRY(bwi_plane_check_arrays(context, order, nodes, point, elements, element));
  BW_TRY(count_corners(context, order, nodes, elements, element, &corners));
  for (int32_t i = 0; i < nodes; i++)
    if (segment[i] < -1 || segment[i] >= outline->segment_count ||
        (segment[i] >= 0 && !(parameter[i] >= 0 && parameter[i] < 1)))
      BW_TRY(
          bw_fail(context, BW_INVALID,
                  "node %d is on segment %d at parameter %g: the segments are 1 to %d (0: none), "
                  "parameters at least 0 and below 1",
                  i + 1, segment[i] + 1, parameter[i], outline->segment_count));
  size_t width = order == 2 ? 6 : 3;
  segments = BW_NEW(context, int32_t, nodes);
  parameters = BW_NEW(context, double, nodes);
  points = BW_NEW(context, double, 2 * (size_t)nodes);
  corner = BW_NEW(context, int32_t, width * (size_t)elements);
  regions = BW_NEW0(context, int32_t, elements);
  BW_TRY_MEMORY(segments && parameters && points && corner && regions);
  memcpy(segments, segment, (size_t)nodes * sizeof *segments);
  for (int32_t i = 0; i < nodes; i++)
    parameters[i] = segment[i] < 0 ? 0 : parameter[i];
  memcpy(points, point, 2 * (size_t)nodes * sizeof *points);
  memcpy(corner, element, width * (size_t)elements * sizeof *corner);
  if (region)
    memcpy(regions, region, (size_t)elements * sizeof *regions);
  status = bwi_plane_nodes_adopt(context, order, nodes, corners, segments, parameters, &made_nodes);
  segments = NULL;
  parameters = NULL;
  BW_TRY(status);
  BW_TRY(check_places(context, made_nodes, outline, points));
  status =
      bwi_plane_topology_adopt(context, made_nodes, outline, elements, corner, regions, &topology);
  corner = regions = NULL;
  BW_TRY(status);
  BW_TRY(check_elements(context, topology, points));
  status = bwi_plane_mesh_adopt(context, topology, outline, points, mesh);
  points = NULL;
done:
  bw_release(made_nodes);
  bw_release(topology);
  bw_free(segments);
  bw_free(parameters);
  bw_free(points);
  bw_free(corner);
  bw_free(regions);
  return status;
}

bw_status bw_plane_mesh_moved(bw_context *context, const bw_plane_mesh *mesh,
                              const bw_outline *outline, const double *point,
                              bw_plane_mesh **moved) {
  bw_status status = BW_OK;
  size_t count = 2 * (size_t)mesh->topology->nodes->node_count;
  double *points = NULL;
  if (!bwi_plane_same_shape(mesh->outline, outline))
    return bw_fail(context, BW_INVALID,
                   "the outline has other segments or loops than the mesh was made for: make a new "
                   "mesh of it");
  for (size_t i = 0; i < count; i++)
    if (!isfinite(point[i])) {
      bw_fail(context, BW_GEOMETRY, "node %zu moves to (%g, %g): both must be finite numbers",
              i / 2 + 1, point[i / 2 * 2], point[i / 2 * 2 + 1]);
      bw_detail_number(context, "node", (double)(i / 2 + 1));
      return BW_GEOMETRY;
    }
  BW_TRY(check_places(context, mesh->topology->nodes, outline, point));
  BW_TRY(check_elements(context, mesh->topology, point));
  points = BW_NEW(context, double, count);
  if (!points)
    return BW_MEMORY;
  memcpy(points, point, count * sizeof *points);
  status = bwi_plane_mesh_adopt(context, mesh->topology, outline, points, moved);
done:
  return status;
}
