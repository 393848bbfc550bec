/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* From the triangles of a filling to a mesh: nodes that were put on boundary edges go onto the
 * curves, nodes and elements are numbered along a Morton curve, smoothing and flips take turns,
 * mid-edge nodes are made. */
#include "plane/edge_flips.h"
#include "plane/fill_internal.h"

#include <string.h>

enum { SMOOTHING = 6 };

/* The nodes' places on the outline. Nodes put on boundary edges are moved onto the curve. */
static bw_status place_nodes(bw_context *context, const bw_outline *outline,
                             const bwi_fill_boundary *boundary, bwi_filling *filling,
                             int32_t **segment, double **parameter) {
  *segment = BW_NEW(context, int32_t, filling->node_count);
  *parameter = BW_NEW0(context, double, filling->node_count);
  if (!*segment || !*parameter)
    return BW_MEMORY;
  for (int32_t i = 0; i < filling->node_count; i++) {
    int32_t chord = filling->chord[i];
    (*segment)[i] = -1;
    if (i < boundary->count) {
      (*segment)[i] = boundary->segment[i];
      (*parameter)[i] = boundary->parameter[i];
    } else if (chord >= 0) {
      double from = boundary->parameter[chord], to = 1;
      if (chord + 1 < boundary->count && boundary->segment[chord + 1] == boundary->segment[chord])
        to = boundary->parameter[chord + 1];
      (*segment)[i] = boundary->segment[chord];
      (*parameter)[i] = from + filling->along[i] * (to - from);
    }
    if ((*segment)[i] >= 0)
      bw_outline_evaluate(outline, (*segment)[i], (*parameter)[i], filling->point + 2 * (size_t)i,
                          NULL, NULL);
  }
  return BW_OK;
}

/* Three-node topology of the filling in Morton order, and its edge flips. */
static bw_status open_flipping(bw_context *context, const bw_outline *outline,
                               const bwi_fill_boundary *boundary, bwi_filling *filling,
                               bw_plane_topology **topology, bwi_edge_flips *flipping) {
  bw_status status = BW_OK;
  int32_t nodes = filling->node_count, elements = filling->element_count;
  int32_t *segment = NULL, *number = NULL, *element = NULL, *region = NULL, *segments = NULL;
  double *parameter = NULL, *parameters = NULL, *point = NULL, *middle = NULL;
  bw_plane_nodes *made = NULL;
  int32_t *order = BW_NEW(context, int32_t, nodes > elements ? nodes : elements);
  BW_TRY(place_nodes(context, outline, boundary, filling, &segment, &parameter));
  number = BW_NEW(context, int32_t, nodes);
  element = BW_NEW(context, int32_t, 3 * (size_t)elements);
  region = BW_NEW(context, int32_t, elements);
  segments = BW_NEW(context, int32_t, nodes);
  parameters = BW_NEW(context, double, nodes);
  point = BW_NEW(context, double, 2 * (size_t)nodes);
  middle = BW_NEW(context, double, 2 * (size_t)elements);
  BW_TRY_MEMORY(order && number && element && region && segments && parameters && point && middle);
  BW_TRY(bwi_order_places(context, nodes, filling->point, order));
  for (int32_t i = 0; i < nodes; i++) {
    int32_t from = order[i];
    number[from] = i;
    segments[i] = segment[from];
    parameters[i] = parameter[from];
    memcpy(point + 2 * (size_t)i, filling->point + 2 * (size_t)from, 2 * sizeof *point);
  }
  for (int32_t e = 0; e < elements; e++)
    for (size_t k = 0; k < 2; k++) {
      const int32_t *n = filling->element + 3 * (size_t)e;
      middle[2 * (size_t)e + k] =
          (filling->point[2 * (size_t)n[0] + k] + filling->point[2 * (size_t)n[1] + k] +
           filling->point[2 * (size_t)n[2] + k]) /
          3;
    }
  BW_TRY(bwi_order_places(context, elements, middle, order));
  for (int32_t e = 0; e < elements; e++) {
    int32_t from = order[e];
    const int32_t *n = filling->element + 3 * (size_t)from;
    /* the lowest corner first: the same triangles give the same arrays */
    int first = number[n[0]] < number[n[1]] ? (number[n[0]] < number[n[2]] ? 0 : 2)
                                            : (number[n[1]] < number[n[2]] ? 1 : 2);
    for (int k = 0; k < 3; k++)
      element[3 * (size_t)e + (size_t)k] = number[n[(first + k) % 3]];
    region[e] = outline->loop[filling->loop[from]].region;
  }
  status = bwi_plane_nodes_adopt(context, 1, nodes, nodes, segments, parameters, &made);
  segments = NULL;
  parameters = NULL;
  BW_TRY(status);
  status = bwi_plane_topology_adopt(context, made, outline, elements, element, region, topology);
  element = region = NULL;
  BW_TRY(status);
  BW_TRY(bwi_edge_flips_open(context, *topology, point, flipping));
done:
  bw_release(made);
  bw_free(order);
  bw_free(segment);
  bw_free(parameter);
  bw_free(number);
  bw_free(element);
  bw_free(region);
  bw_free(segments);
  bw_free(parameters);
  bw_free(point);
  bw_free(middle);
  return status;
}

/* Mid-edge nodes on all edges, numbered element by element, those on sides on their curve. */
static bw_status add_mid_edge_nodes(bw_context *context, const bw_outline *outline,
                                    const bw_plane_topology *topology,
                                    const bwi_edge_flips *flipping, int32_t *nodes,
                                    int32_t **segment, double **parameter, double **point,
                                    int32_t **element) {
  bw_status status = BW_OK;
  const bw_plane_nodes *corners = topology->nodes;
  int32_t count = corners->corner_count, elements = flipping->element_count;
  /* edges = (halves + open ones) / 2 */
  int64_t open = 0;
  for (int64_t h = 0; h < 3 * (int64_t)elements; h++)
    open += flipping->neighbour[h] < 0;
  int64_t total = count + (3 * (int64_t)elements + open) / 2;
  if (total > INT32_MAX / 2)
    return bw_fail(context, BW_LIMIT, "%lld nodes: a plane mesh holds at most %d", (long long)total,
                   INT32_MAX / 2);
  int32_t *middle = BW_NEW(context, int32_t, 3 * (size_t)elements);
  *segment = BW_NEW(context, int32_t, total);
  *parameter = BW_NEW0(context, double, total);
  *point = BW_NEW(context, double, 2 * (size_t)total);
  *element = BW_NEW(context, int32_t, 6 * (size_t)elements);
  BW_TRY_MEMORY(middle && *segment && *parameter && *point && *element);
  memcpy(*segment, corners->segment, (size_t)count * sizeof **segment);
  memcpy(*parameter, corners->parameter, (size_t)count * sizeof **parameter);
  memcpy(*point, flipping->point, 2 * (size_t)count * sizeof **point);
  for (int64_t h = 0; h < 3 * (int64_t)elements; h++) {
    int32_t e = (int32_t)(h / 3), other = flipping->neighbour[h];
    const int32_t *n = flipping->element + 3 * (size_t)e;
    int k = (int)(h % 3);
    int32_t a = n[k], b = n[(k + 1) % 3];
    if (other >= 0 && other < e) {
      const int32_t *m = flipping->element + 3 * (size_t)other;
      int at = m[0] == b ? 0 : m[1] == b ? 1 : 2;
      middle[h] = middle[3 * (size_t)other + (size_t)at];
      continue;
    }
    middle[h] = count;
    (*segment)[count] = -1;
    for (size_t i = 0; i < 2; i++)
      (*point)[2 * (size_t)count + i] =
          (flipping->point[2 * (size_t)a + i] + flipping->point[2 * (size_t)b + i]) / 2;
    count++;
  }
  for (int32_t s = 0; s < topology->side_count; s++) {
    int32_t a = topology->side[2 * s], b = topology->side[2 * s + 1];
    int one = topology->side_element[2 * s] >= 0 ? 0 : 1;
    int32_t e = -1, k = -1;
    /* flips left the sides' elements behind: look around the corner */
    int32_t from = one == 0 ? a : b, to = one == 0 ? b : a, at = flipping->star[from];
    for (int turn = 0; turn < 2 && k < 0; turn++) {
      at = flipping->star[from];
      while (at >= 0) {
        const int32_t *n = flipping->element + 3 * (size_t)at;
        int c = n[0] == from ? 0 : n[1] == from ? 1 : 2;
        if (n[(c + 1) % 3] == to) {
          e = at;
          k = c;
          break;
        }
        at = flipping->neighbour[3 * (size_t)at + (size_t)(turn == 0 ? (c + 2) % 3 : c)];
        if (at == flipping->star[from])
          break;
      }
    }
    if (k < 0)
      BW_TRY(bw_fail(context, BW_INTERNAL, "filling: side %d was lost", s + 1));
    int32_t m = middle[3 * (size_t)e + (size_t)k], on = topology->side_segment[s];
    double end = (*segment)[b] == on && (*parameter)[b] > (*parameter)[a] ? (*parameter)[b] : 1;
    (*segment)[m] = on;
    (*parameter)[m] = ((*parameter)[a] + end) / 2;
    bw_outline_evaluate(outline, on, (*parameter)[m], *point + 2 * (size_t)m, NULL, NULL);
  }
  for (int32_t e = 0; e < elements; e++)
    for (size_t k = 0; k < 3; k++) {
      (*element)[6 * (size_t)e + k] = flipping->element[3 * (size_t)e + k];
      (*element)[6 * (size_t)e + 3 + k] = middle[3 * (size_t)e + k];
    }
  *nodes = count;
done:
  bw_free(middle);
  return status;
}

bw_status bwi_fill_mesh(bw_context *context, const bw_outline *outline,
                        const bwi_fill_boundary *boundary, bwi_filling *filling, int order,
                        bool *fits, bw_plane_mesh **mesh) {
  bw_status status = BW_OK;
  bw_plane_topology *corners = NULL, *topology = NULL;
  bw_plane_nodes *made = NULL;
  bwi_edge_flips flipping = {0};
  int32_t *segment = NULL, *element = NULL, *region = NULL, nodes = 0, which = 0;
  double *parameter = NULL, *point = NULL;
  *fits = true;
  BW_TRY(open_flipping(context, outline, boundary, filling, &corners, &flipping));
  bwi_edge_flips_queue_all(&flipping);
  bwi_edge_flips_flip(&flipping);
  for (int round = 0; round < SMOOTHING; round++) {
    bwi_edge_flips_smooth(&flipping, 2, 0.75);
    bwi_edge_flips_flip(&flipping);
    BW_TRY(bw_check_cancel(context));
  }
  nodes = corners->nodes->node_count;
  if (order == 2) {
    BW_TRY(add_mid_edge_nodes(context, outline, corners, &flipping, &nodes, &segment, &parameter,
                              &point, &element));
  } else {
    segment = BW_NEW(context, int32_t, nodes);
    parameter = BW_NEW(context, double, nodes);
    BW_TRY_MEMORY(segment && parameter);
    memcpy(segment, corners->nodes->segment, (size_t)nodes * sizeof *segment);
    memcpy(parameter, corners->nodes->parameter, (size_t)nodes * sizeof *parameter);
    point = flipping.point;
    element = flipping.element;
    flipping.point = NULL;
    flipping.element = NULL;
  }
  region = BW_NEW(context, int32_t, filling->element_count);
  BW_TRY_MEMORY(region);
  memcpy(region, corners->region, (size_t)filling->element_count * sizeof *region);
  status = bwi_plane_nodes_adopt(context, order, nodes, corners->nodes->corner_count, segment,
                                 parameter, &made);
  segment = NULL;
  parameter = NULL;
  BW_TRY(status);
  status = bwi_plane_topology_adopt(context, made, outline, filling->element_count, element, region,
                                    &topology);
  element = region = NULL;
  BW_TRY(status);
  *fits = bwi_plane_worst(topology, point, &which) > 1e-3;
  status = bwi_plane_mesh_adopt(context, topology, outline, point, mesh);
  point = NULL;
done:
  bwi_edge_flips_clear(&flipping);
  bw_release(corners);
  bw_release(topology);
  bw_release(made);
  bw_free(segment);
  bw_free(parameter);
  bw_free(point);
  bw_free(element);
  bw_free(region);
  return status;
}
