/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* Neighbours and sides. Sides follow from the nodes' places on the outline: on each segment the
 * corners in the order of their parameters, then the first of the segment behind. */
#include "plane/internal.h"

#include <stdlib.h>
#include <string.h>

static void topology_destroy(void *object) {
  bw_plane_topology *topology = object;
  bw_release(topology->nodes);
  bw_free(topology->element);
  bw_free(topology->region);
  bw_free(topology->neighbour);
  bw_free(topology->side);
  bw_free(topology->side_element);
  bw_free(topology->side_segment);
  bw_free(topology);
}

static size_t topology_bytes(const void *object) {
  const bw_plane_topology *topology = object;
  size_t width = (size_t)bwi_plane_width(topology->nodes);
  return sizeof *topology + sizeof(int32_t) * ((size_t)topology->element_count * (width + 4) +
                                               (size_t)topology->side_count * (width == 6 ? 6 : 5));
}

static const bw_kind topology_kind = {"plane topology", topology_destroy, topology_bytes};

bool bwi_plane_same_shape(const bw_outline *a, const bw_outline *b) {
  if (bw_outline_same_topology(a, b))
    return true;
  if (a->point_count != b->point_count || a->segment_count != b->segment_count ||
      a->loop_count != b->loop_count || a->region_count != b->region_count)
    return false;
  for (int32_t s = 0; s < a->segment_count; s++)
    if (memcmp(a->segment[s].point, b->segment[s].point, sizeof a->segment[s].point) ||
        strcmp(a->tag[a->segment[s].tag].text, b->tag[b->segment[s].tag].text))
      return false;
  for (int32_t l = 0; l < a->loop_count; l++) {
    const bw_loop *p = &a->loop[l], *q = &b->loop[l];
    if (p->first != q->first || p->count != q->count || p->region != q->region ||
        p->parent != q->parent)
      return false;
  }
  return true;
}

/* ---- neighbours -------------------------------------------------------------------------------
 * Directed edges in buckets by the node where they begin: start[a] .. start[a + 1] in `half`, each
 * 3 e + k. */

typedef struct half_edges {
  int64_t *start;
  int32_t *half;
} half_edges;

static int32_t half_between(const bw_plane_topology *t, const half_edges *halves, int32_t a,
                            int32_t b) {
  int width = bwi_plane_width(t->nodes);
  for (int64_t i = halves->start[a]; i < halves->start[a + 1]; i++) {
    int32_t h = halves->half[i];
    if (t->element[(size_t)(h / 3) * (size_t)width + (size_t)((h % 3 + 1) % 3)] == b)
      return h;
  }
  return -1;
}

static bw_status find_neighbours(bw_context *context, bw_plane_topology *t, half_edges *halves) {
  int width = bwi_plane_width(t->nodes);
  int32_t corners = t->nodes->corner_count, count = 3 * t->element_count;
  halves->start = BW_NEW0(context, int64_t, (size_t)corners + 2);
  halves->half = BW_NEW(context, int32_t, count);
  t->neighbour = BW_NEW(context, int32_t, count);
  if (!halves->start || !halves->half || !t->neighbour)
    return BW_MEMORY;
  int64_t *start = halves->start;
  for (int32_t h = 0; h < count; h++)
    start[t->element[(size_t)(h / 3) * (size_t)width + (size_t)(h % 3)] + 2]++;
  for (int32_t i = 0; i < corners; i++)
    start[i + 2] += start[i + 1];
  for (int32_t h = 0; h < count; h++)
    halves->half[start[t->element[(size_t)(h / 3) * (size_t)width + (size_t)(h % 3)] + 1]++] = h;
  for (int32_t h = 0; h < count; h++) {
    const int32_t *n = t->element + (size_t)(h / 3) * (size_t)width;
    int k = h % 3;
    int32_t a = n[k], b = n[(k + 1) % 3];
    int32_t other = half_between(t, halves, b, a), twin = half_between(t, halves, a, b);
    bool joined = other < 0 || width == 3 ||
                  n[3 + k] == t->element[(size_t)(other / 3) * 6 + 3 + (size_t)(other % 3)];
    if (twin == h && joined) {
      t->neighbour[h] = other < 0 ? -1 : other / 3;
      continue;
    }
    if (!joined)
      bw_fail(context, BW_GEOMETRY,
              "elements %d and %d share the edge between nodes %d and %d but not its mid-edge node",
              h / 3 + 1, other / 3 + 1, a + 1, b + 1);
    else
      bw_fail(context, BW_GEOMETRY,
              "elements %d and %d lie on the same side of the edge from node %d to node %d: "
              "elements may not overlap",
              twin / 3 + 1, h / 3 + 1, a + 1, b + 1);
    bw_detail_number(context, "element", (double)(h / 3 + 1));
    return BW_GEOMETRY;
  }
  return BW_OK;
}

/* ---- sides ----------------------------------------------------------------------------------- */

typedef struct placed {
  int32_t segment, node;
  double parameter;
} placed;

static int by_place(const void *a, const void *b) {
  const placed *p = a, *q = b;
  if (p->segment != q->segment)
    return p->segment < q->segment ? -1 : 1;
  if (p->parameter != q->parameter)
    return p->parameter < q->parameter ? -1 : 1;
  return (p->node > q->node) - (p->node < q->node);
}

static bw_status find_sides(bw_context *context, bw_plane_topology *t, const bw_outline *outline,
                            const half_edges *halves) {
  bw_status status = BW_OK;
  const bw_plane_nodes *nodes = t->nodes;
  int order = nodes->order;
  size_t per = order == 2 ? 3 : 2;
  int width = bwi_plane_width(nodes);
  int32_t count = 0, s = 0;
  int32_t *first = BW_NEW(context, int32_t, (size_t)outline->segment_count + 1);
  int32_t *next = BW_NEW(context, int32_t, outline->segment_count);
  placed *list = NULL;
  BW_TRY_MEMORY(first && next);
  for (int32_t i = 0; i < nodes->corner_count; i++)
    count += nodes->segment[i] >= 0;
  list = BW_NEW(context, placed, count);
  t->side = BW_NEW(context, int32_t, per * (size_t)count);
  t->side_element = BW_NEW(context, int32_t, 2 * (size_t)count);
  t->side_segment = BW_NEW(context, int32_t, count);
  BW_TRY_MEMORY(list && t->side && t->side_element && t->side_segment);
  t->side_count = count;
  count = 0;
  for (int32_t i = 0; i < nodes->corner_count; i++)
    if (nodes->segment[i] >= 0)
      list[count++] = (placed){nodes->segment[i], i, nodes->parameter[i]};
  qsort(list, (size_t)count, sizeof *list, by_place);
  for (int32_t l = 0; l < outline->loop_count; l++)
    for (int32_t k = 0; k < outline->loop[l].count; k++)
      next[outline->loop[l].first + k] =
          outline->loop[l].first + (k + 1 < outline->loop[l].count ? k + 1 : 0);
  for (int32_t i = 0; i <= outline->segment_count; i++) {
    while (s < count && list[s].segment < i)
      s++;
    first[i] = s;
  }
  first[outline->segment_count] = count;
  for (int32_t i = 0; i < outline->segment_count; i++) {
    if (first[i] < first[i + 1] && list[first[i]].parameter == 0)
      continue;
    status = bw_fail(context, BW_GEOMETRY,
                     "no node lies at the beginning of segment %d of the outline: every vertex of "
                     "the outline is a node",
                     i + 1);
    bw_detail_number(context, "segment", i + 1.0);
    goto done;
  }
  for (int32_t i = 0; i < count; i++) {
    int32_t segment = list[i].segment, a = list[i].node;
    int32_t b = i + 1 < first[segment + 1] ? list[i + 1].node : list[first[next[segment]]].node;
    int32_t left = half_between(t, halves, a, b), right = half_between(t, halves, b, a);
    if (left < 0 && right < 0) {
      bw_fail(context, BW_GEOMETRY,
              "nodes %d and %d follow each other on segment %d of the outline, but no element has "
              "an edge between them",
              a + 1, b + 1, segment + 1);
      bw_detail_number(context, "segment", segment + 1.0);
      status = BW_GEOMETRY;
      goto done;
    }
    int32_t *side = t->side + per * (size_t)i, one = left >= 0 ? left : right;
    side[0] = a;
    side[1] = b;
    if (order == 2)
      side[2] = t->element[(size_t)(one / 3) * (size_t)width + 3 + (size_t)(one % 3)];
    t->side_element[2 * i] = left < 0 ? -1 : left / 3;
    t->side_element[2 * i + 1] = right < 0 ? -1 : right / 3;
    t->side_segment[i] = segment;
    if (left < 0 || right < 0)
      t->neighbour[one] = -2; /* seen: set back below */
    if (order == 2 && nodes->segment[side[2]] != segment) {
      bw_fail(context, BW_GEOMETRY,
              "node %d is the mid-edge node of an edge on segment %d of the outline, but is given "
              "on segment %d",
              side[2] + 1, segment + 1, nodes->segment[side[2]] + 1);
      bw_detail_number(context, "node", side[2] + 1.0);
      status = BW_GEOMETRY;
      goto done;
    }
  }
  for (int64_t h = 0; h < 3 * (int64_t)t->element_count; h++) {
    if (t->neighbour[h] == -1) {
      const int32_t *n = t->element + (size_t)(h / 3) * (size_t)width;
      bw_fail(context, BW_GEOMETRY,
              "the edge from node %d to node %d of element %d has no neighbour and lies on no "
              "segment of the outline",
              n[h % 3] + 1, n[(h % 3 + 1) % 3] + 1, (int)(h / 3) + 1);
      bw_detail_number(context, "element", (double)(h / 3 + 1));
      status = BW_GEOMETRY;
      goto done;
    }
    if (t->neighbour[h] == -2)
      t->neighbour[h] = -1;
  }
done:
  bw_free(list);
  bw_free(first);
  bw_free(next);
  return status;
}

/* ---- making ---------------------------------------------------------------------------------- */

static bw_plane_topology *topology_new(bw_context *context, const bw_plane_nodes *nodes,
                                       int32_t elements, int32_t *element) {
  bw_plane_topology *t = BW_NEW0(context, bw_plane_topology, 1);
  if (!t)
    return NULL;
  bw_object_init(t, &topology_kind);
  t->nodes = bw_retain(nodes);
  t->element_count = elements;
  t->element = element;
  return t;
}

bw_status bwi_plane_topology_adopt(bw_context *context, const bw_plane_nodes *nodes,
                                   const bw_outline *outline, int32_t elements, int32_t *element,
                                   int32_t *region, bw_plane_topology **out) {
  bw_status status = BW_OK;
  half_edges halves = {NULL, NULL};
  bw_plane_topology *t = NULL;
  if (elements > INT32_MAX / 6)
    status = bw_fail(context, BW_LIMIT, "%d elements: a plane mesh holds at most %d", elements,
                     INT32_MAX / 6);
  else if (!(t = topology_new(context, nodes, elements, element)))
    status = BW_MEMORY;
  if (status != BW_OK) {
    bw_free(element);
    bw_free(region);
    return status;
  }
  t->region = region;
  BW_TRY(find_neighbours(context, t, &halves));
  BW_TRY(find_sides(context, t, outline, &halves));
  *out = t;
done:
  bw_free(halves.start);
  bw_free(halves.half);
  if (status != BW_OK)
    bw_release(t);
  return status;
}

static int32_t *copied(bw_context *context, const int32_t *list, size_t count) {
  int32_t *copy = BW_NEW(context, int32_t, count);
  if (copy)
    memcpy(copy, list, count * sizeof *list);
  return copy;
}

bw_status bwi_plane_topology_like(bw_context *context, const bw_plane_topology *like,
                                  int32_t *element, int32_t *neighbour, int32_t *side_element,
                                  bw_plane_topology **out) {
  bw_plane_topology *t = topology_new(context, like->nodes, like->element_count, element);
  if (!t) {
    bw_free(element);
    bw_free(neighbour);
    bw_free(side_element);
    return BW_MEMORY;
  }
  t->neighbour = neighbour;
  t->side_element = side_element;
  t->side_count = like->side_count;
  t->region = copied(context, like->region, (size_t)like->element_count);
  t->side =
      copied(context, like->side, (size_t)like->side_count * (like->nodes->order == 2 ? 3 : 2));
  t->side_segment = copied(context, like->side_segment, (size_t)like->side_count);
  if (!t->region || !t->side || !t->side_segment) {
    bw_release(t);
    return BW_MEMORY;
  }
  *out = t;
  return BW_OK;
}
