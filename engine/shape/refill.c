/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* Refilling parts of an edited mesh: what is to be replaced falls into pieces connected through
 * faces; the boundary of each is filled anew (refill_piece.c) and the parts are joined again.
 *
 * Nodes of the new mesh are the old ones that a kept element or a facet of a piece has, in their
 * order, then new ones by piece: corners, and at order 2 the middles of all new edges. An edge of a
 * new element that was there before (along a piece's boundary) has its old middle, so that the
 * parts fit. */
#include "mesh/mesh_internal.h"
#include "shape/mend_internal.h"

#include <math.h>
#include <string.h>

typedef struct piece {
  int32_t element_count, facet_count;
  int32_t first;   /* its elements in refiller.ordered */
  int32_t region;  /* that of most of its elements */
  int32_t corners; /* on its boundary */
  int32_t *corner; /* the old node of each point of its boundary, ascending */
  bwi_filled filled;
} piece;

typedef struct refiller {
  bw_context *context;
  const bw_mesh *mesh;
  const double *node;
  int32_t pieces;
  piece *piece;
  int32_t *piece_of; /* element_count: or -1, kept */
  int32_t *ordered;  /* elements to replace, by piece */
  int32_t *number;   /* node_count: scratch, then the new number of an old node or -1 */
  int32_t kept;      /* elements */
  /* the new mesh */
  int64_t node_count, element_count;
  double *new_node;
  int32_t *element, *region, *node_from, *element_from;
} refiller;

static const int32_t *corners_of(const refiller *r, int32_t e) {
  return r->mesh->element + (size_t)e * (size_t)r->mesh->nodes_per_element;
}

static bool on_boundary(const refiller *r, int32_t e, int face) {
  int32_t other = r->mesh->neighbour[4 * (size_t)e + (size_t)face];
  return other < 0 || r->piece_of[other] != r->piece_of[e];
}

/* ---- pieces ---------------------------------------------------------------------------------- */

static bw_status find_pieces(refiller *r, const uint8_t *replace) {
  const bw_mesh *mesh = r->mesh;
  int32_t count = 0;
  size_t capacity = 0;
  r->piece_of = BW_NEW(r->context, int32_t, mesh->element_count);
  r->ordered = BW_NEW(r->context, int32_t, mesh->element_count);
  r->number = BW_NEW(r->context, int32_t, mesh->node_count);
  if (!r->piece_of || !r->ordered || !r->number)
    return BW_MEMORY;
  for (int32_t e = 0; e < mesh->element_count; e++) {
    r->piece_of[e] = -1;
    r->kept += !replace[e];
  }
  if (r->kept == mesh->element_count)
    return bw_fail(r->context, BW_EMPTY, "none of the %d elements is to be replaced",
                   mesh->element_count);
  for (int32_t seed = 0; seed < mesh->element_count; seed++) {
    if (!replace[seed] || r->piece_of[seed] >= 0)
      continue;
    if (!bw_grow(r->context, (void **)&r->piece, &capacity, (size_t)r->pieces, 1, sizeof *r->piece))
      return BW_MEMORY;
    piece *p = &r->piece[r->pieces];
    *p = (piece){.first = count};
    r->piece_of[seed] = r->pieces++;
    r->ordered[count++] = seed;
    for (int32_t at = p->first; at < count; at++)
      for (size_t k = 0; k < 4; k++) {
        int32_t other = mesh->neighbour[4 * (size_t)r->ordered[at] + k];
        if (other >= 0 && replace[other] && r->piece_of[other] < 0) {
          r->piece_of[other] = r->piece_of[seed];
          r->ordered[count++] = other;
        }
      }
    p->element_count = count - p->first;
  }
  return BW_OK;
}

/* Kept elements are not mended here. */
static bw_status check_kept(const refiller *r) {
  for (int32_t i = 0; i < 3 * r->mesh->node_count; i++)
    if (!isfinite(r->node[i])) {
      bw_fail(r->context, BW_INVALID, "node %d is not at a finite place", i / 3);
      bw_detail_number(r->context, "node", i / 3);
      return BW_INVALID;
    }
  for (int32_t e = 0; e < r->mesh->element_count; e++) {
    const int32_t *c = corners_of(r, e);
    const double *const x[4] = {r->node + 3 * (size_t)c[0], r->node + 3 * (size_t)c[1],
                                r->node + 3 * (size_t)c[2], r->node + 3 * (size_t)c[3]};
    if (r->piece_of[e] >= 0 || bwi_judged_quality(x) > 0)
      continue;
    bw_fail(r->context, BW_GEOMETRY,
            "element %d near (%g, %g, %g) is inverted and not among those to be replaced", e,
            x[0][0], x[0][1], x[0][2]);
    bw_detail_number(r->context, "element", e);
    return BW_GEOMETRY;
  }
  return BW_OK;
}

/* The region of most elements of a piece, the lowest of several. */
static int32_t common_region(const refiller *r, const piece *p) {
  const int32_t *region = r->mesh->region;
  int32_t best = 0, most = 0, candidate = 0;
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
    if (more && votes > most) {
      most = votes;
      best = candidate;
    }
  }
  return best;
}

/* Mean length of the old edges at each corner of a piece, in its new place: the sizes to ask for.
 */
static bw_status measure_edges(refiller *r, const piece *p, double **sample, double **length,
                               int64_t *count) {
  bw_status status = BW_OK;
  int32_t corners = 0, *edges = NULL;
  for (int32_t i = 0; i < r->mesh->node_count; i++)
    r->number[i] = -1;
  for (int32_t i = p->first; i < p->first + p->element_count; i++)
    for (int k = 0; k < 4; k++) {
      int32_t c = corners_of(r, r->ordered[i])[k];
      if (r->number[c] < 0)
        r->number[c] = corners++;
    }
  double *at = BW_NEW(r->context, double, 3 * (size_t)corners);
  double *sum = BW_NEW0(r->context, double, corners);
  edges = BW_NEW0(r->context, int32_t, corners);
  if (!at || !sum || !edges) {
    status = BW_MEMORY;
    goto done;
  }
  for (int32_t i = p->first; i < p->first + p->element_count; i++) {
    const int32_t *c = corners_of(r, r->ordered[i]);
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

/* The boundary of a piece as a surface; p->corner tells the old nodes. element_of (may be NULL):
 * the element behind each facet. */
static bw_status piece_boundary(refiller *r, piece *p, bw_surface **surface, int32_t *element_of) {
  bw_status status = BW_OK;
  int32_t *triangle = NULL;
  double *point = NULL;
  for (int32_t i = 0; i < r->mesh->node_count; i++)
    r->number[i] = -1;
  p->facet_count = p->corners = 0;
  for (int32_t i = p->first; i < p->first + p->element_count; i++)
    for (int k = 0; k < 4; k++)
      if (on_boundary(r, r->ordered[i], k)) {
        p->facet_count++;
        for (int j = 0; j < 3; j++)
          r->number[corners_of(r, r->ordered[i])[bw_tet_face[k][j]]] = 0;
      }
  for (int32_t i = 0; i < r->mesh->node_count; i++)
    if (r->number[i] == 0)
      r->number[i] = p->corners++;
  triangle = BW_NEW(r->context, int32_t, 3 * (size_t)p->facet_count);
  point = BW_NEW(r->context, double, 3 * (size_t)p->corners);
  p->corner = BW_NEW(r->context, int32_t, p->corners);
  if (!triangle || !point || !p->corner) {
    status = BW_MEMORY;
    goto done;
  }
  for (int32_t i = 0; i < r->mesh->node_count; i++)
    if (r->number[i] >= 0) {
      p->corner[r->number[i]] = i;
      memcpy(point + 3 * (size_t)r->number[i], r->node + 3 * (size_t)i, 3 * sizeof *point);
    }
  int32_t at = 0;
  for (int32_t i = p->first; i < p->first + p->element_count; i++)
    for (int k = 0; k < 4; k++)
      if (on_boundary(r, r->ordered[i], k)) {
        for (int j = 0; j < 3; j++)
          triangle[3 * (size_t)at + (size_t)j] =
              r->number[corners_of(r, r->ordered[i])[bw_tet_face[k][j]]];
        element_of[at++] = r->ordered[i];
      }
  BW_TRY(bw_surface_own(r->context, p->corners, point, p->facet_count, triangle, NULL, surface));
  point = NULL;
  triangle = NULL;
done:
  bw_free(triangle);
  bw_free(point);
  return status;
}

/* A boundary that cuts itself, or is inside out, cannot be filled. */
static bw_status check_boundary(const refiller *r, int32_t number, const bw_surface *surface,
                                const int32_t *element_of) {
  bw_surface_report report = {0};
  const piece *p = &r->piece[number];
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
                "the boundary of the %d elements to be replaced %s at (%g, %g, %g), by a facet "
                "of element %d (%lld such places): undo the edit or make it smaller",
                p->element_count, what, d->at[0], d->at[1], d->at[2], element_of[d->facet],
                (long long)report.count[d->kind]);
    bw_detail_number(r->context, "element", element_of[d->facet]);
    bw_detail_number(r->context, "piece", number);
    goto done;
  }
  if (!(report.volume > 0)) {
    status = bw_fail(r->context, BW_GEOMETRY,
                     "the boundary of the %d elements to be replaced is inside out: it encloses %g "
                     "m3 near (%g, %g, %g)",
                     p->element_count, report.volume, surface->point[0], surface->point[1],
                     surface->point[2]);
    bw_detail_number(r->context, "piece", number);
  }
done:
  bw_surface_report_clear(&report);
  return status;
}

static bw_status fill_piece(refiller *r, int32_t number) {
  piece *p = &r->piece[number];
  bw_surface *surface = NULL;
  double *sample = NULL, *length = NULL;
  int64_t samples = 0;
  bw_status status;
  int32_t *element_of = BW_NEW(r->context, int32_t, 4 * (size_t)p->element_count);
  if (!element_of)
    return BW_MEMORY;
  BW_TRY(measure_edges(r, p, &sample, &length, &samples));
  BW_TRY(piece_boundary(r, p, &surface, element_of));
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

/* ---- joining --------------------------------------------------------------------------------- */

/* r->number: the new number of every node that stays, -1 for the others. */
static void number_nodes(refiller *r) {
  const bw_mesh *mesh = r->mesh;
  size_t width = (size_t)mesh->nodes_per_element;
  for (int32_t i = 0; i < mesh->node_count; i++)
    r->number[i] = -1;
  for (int32_t e = 0; e < mesh->element_count; e++) {
    const int32_t *n = corners_of(r, e);
    if (r->piece_of[e] < 0)
      for (size_t k = 0; k < width; k++)
        r->number[n[k]] = 0;
    else
      for (int k = 0; k < 4; k++)
        for (int j = 0; j < 3 && on_boundary(r, e, k); j++) {
          r->number[n[bw_tet_face[k][j]]] = 0;
          if (mesh->order == 2)
            r->number[n[bw_tet_face_middle[k][j]]] = 0;
        }
  }
  r->node_count = 0;
  for (int32_t i = 0; i < mesh->node_count; i++)
    if (r->number[i] == 0)
      r->number[i] = (int32_t)r->node_count++;
}

/* Old edges that a new element may meet again: those of kept elements and of pieces' facets whose
 * ends are both on a piece's boundary. Keyed by new numbers, sorted; item: the middle. */
static bw_status old_edges(refiller *r, bwi_keyed **list, size_t *count) {
  bw_status status = BW_OK;
  size_t found = 0, capacity = 0;
  bwi_keyed *edges = NULL;
  uint8_t *touched = BW_NEW0(r->context, uint8_t, r->mesh->node_count);
  if (!touched)
    return BW_MEMORY;
  for (int32_t p = 0; p < r->pieces; p++)
    for (int32_t i = 0; i < r->piece[p].corners; i++)
      touched[r->piece[p].corner[i]] = 1;
  for (int32_t e = 0; e < r->mesh->element_count; e++) {
    const int32_t *n = corners_of(r, e);
    for (int k = 0; k < 6; k++) {
      int32_t a = n[bw_tet_edge[k][0]], b = n[bw_tet_edge[k][1]], middle = r->number[n[4 + k]];
      if (!touched[a] || !touched[b] || middle < 0)
        continue;
      uint64_t low = (uint64_t)r->number[a < b ? a : b], high = (uint64_t)r->number[a < b ? b : a];
      if (!bw_grow(r->context, (void **)&edges, &capacity, found, 1, sizeof *edges)) {
        status = BW_MEMORY;
        goto done;
      }
      edges[found++] = (bwi_keyed){low << 32 | high, middle, 0};
    }
  }
  bwi_sort_keyed(edges, (int64_t)found);
  *list = edges;
  *count = found;
  edges = NULL;
done:
  bw_free(touched);
  bw_free(edges);
  return status;
}

static int32_t find_edge(const bwi_keyed *list, size_t count, uint64_t key) {
  size_t low = 0, high = count;
  while (low < high) {
    size_t middle = (low + high) / 2;
    if (list[middle].key < key)
      low = middle + 1;
    else
      high = middle;
  }
  return low < count && list[low].key == key ? list[low].item : -1;
}

/* Middles for the elements from r->kept on: old ones where the edge is old, else new ones in the
 * order of edges. Grows r->new_node and r->node_from. */
static bw_status place_new_middles(refiller *r) {
  bw_status status;
  bwi_keyed *old = NULL, *edge = NULL;
  size_t olds = 0, edges = 6 * (size_t)(r->element_count - r->kept), at = 0;
  int64_t count = r->node_count;
  BW_TRY(old_edges(r, &old, &olds));
  edge = BW_NEW(r->context, bwi_keyed, edges);
  if (!edge) {
    status = BW_MEMORY;
    goto done;
  }
  for (int64_t e = r->kept; e < r->element_count; e++)
    for (int k = 0; k < 6; k++) {
      const int32_t *n = r->element + 10 * (size_t)e;
      uint64_t a = (uint64_t)n[bw_tet_edge[k][0]], b = (uint64_t)n[bw_tet_edge[k][1]];
      edge[at++] = (bwi_keyed){a < b ? a << 32 | b : b << 32 | a, (int32_t)e, k};
    }
  bwi_sort_keyed(edge, (int64_t)edges);
  for (int pass = 0; pass < 2; pass++) { /* count, then place */
    int64_t next = r->node_count;
    for (size_t i = 0; i < edges;) {
      size_t end = i;
      int32_t middle = find_edge(old, olds, edge[i].key);
      bool is_new = middle < 0;
      if (is_new)
        middle = (int32_t)next++;
      for (; end < edges && edge[end].key == edge[i].key; end++)
        if (pass == 1)
          r->element[10 * (size_t)edge[end].item + 4 + (size_t)edge[end].part] = middle;
      if (pass == 1 && is_new) {
        size_t a = (size_t)(edge[i].key >> 32), b = (size_t)(edge[i].key & 0xffffffff);
        for (size_t k = 0; k < 3; k++)
          r->new_node[3 * (size_t)middle + k] =
              0.5 * (r->new_node[3 * a + k] + r->new_node[3 * b + k]);
        r->node_from[middle] = -1;
      }
      i = end;
    }
    count = next;
    if (count > INT32_MAX) {
      status = bw_fail(r->context, BW_LIMIT, "%lld nodes: a mesh holds at most 2147483647",
                       (long long)count);
      goto done;
    }
    if (pass == 0) {
      double *node = bw_resize(r->context, r->new_node, 3 * (size_t)count, sizeof *node);
      if (node)
        r->new_node = node;
      int32_t *from = bw_resize(r->context, r->node_from, (size_t)count, sizeof *from);
      if (from)
        r->node_from = from;
      if (!node || !from) {
        status = BW_MEMORY;
        goto done;
      }
    }
  }
  r->node_count = count;
done:
  bw_free(old);
  bw_free(edge);
  return status;
}

static bw_status join(refiller *r) {
  const bw_mesh *mesh = r->mesh;
  size_t width = (size_t)mesh->nodes_per_element;
  number_nodes(r);
  int64_t next = r->node_count, nodes = r->node_count;
  r->element_count = r->kept;
  for (int32_t p = 0; p < r->pieces; p++) {
    nodes += r->piece[p].filled.node_count - r->piece[p].corners;
    r->element_count += r->piece[p].filled.element_count;
  }
  if (nodes > INT32_MAX || r->element_count > INT32_MAX)
    return bw_fail(r->context, BW_LIMIT,
                   "%lld nodes and %lld elements: a mesh holds at most 2147483647 each",
                   (long long)nodes, (long long)r->element_count);
  r->new_node = BW_NEW(r->context, double, 3 * (size_t)nodes);
  r->node_from = BW_NEW(r->context, int32_t, nodes);
  r->element = BW_NEW(r->context, int32_t, width * (size_t)r->element_count);
  r->element_from = BW_NEW(r->context, int32_t, r->element_count);
  r->region = mesh->region ? BW_NEW(r->context, int32_t, r->element_count) : NULL;
  if (!r->new_node || !r->node_from || !r->element || !r->element_from ||
      (mesh->region && !r->region))
    return BW_MEMORY;
  for (int32_t i = 0; i < mesh->node_count; i++)
    if (r->number[i] >= 0) {
      memcpy(r->new_node + 3 * (size_t)r->number[i], r->node + 3 * (size_t)i, 3 * sizeof(double));
      r->node_from[r->number[i]] = i;
    }
  size_t at = 0;
  for (int32_t e = 0; e < mesh->element_count; e++)
    if (r->piece_of[e] < 0) {
      for (size_t k = 0; k < width; k++)
        r->element[width * at + k] = r->number[corners_of(r, e)[k]];
      if (r->region)
        r->region[at] = mesh->region[e];
      r->element_from[at++] = e;
    }
  for (int32_t i = 0; i < r->pieces; i++) {
    const piece *p = &r->piece[i];
    int64_t offset = next - p->corners;
    for (int32_t n = p->corners; n < p->filled.node_count; n++, next++) {
      memcpy(r->new_node + 3 * (size_t)next, p->filled.node + 3 * (size_t)n, 3 * sizeof(double));
      r->node_from[next] = -1;
    }
    for (int32_t e = 0; e < p->filled.element_count; e++, at++) {
      for (size_t k = 0; k < 4; k++) {
        int32_t n = p->filled.element[4 * (size_t)e + k];
        r->element[width * at + k] =
            n < p->corners ? r->number[p->corner[n]] : (int32_t)(offset + n);
      }
      if (r->region)
        r->region[at] = p->region;
      r->element_from[at] = -1 - i;
    }
  }
  r->node_count = next;
  return mesh->order == 2 ? place_new_middles(r) : BW_OK;
}

/* ---- facets in their old order --------------------------------------------------------------- */

static bwi_keyed facet_key(const int32_t *corner, int32_t item) {
  int32_t a = corner[0], b = corner[1], c = corner[2], t;
  if (a > b)
    t = a, a = b, b = t;
  if (b > c)
    t = b, b = c, c = t;
  if (a > b)
    t = a, a = b, b = t;
  return (bwi_keyed){(uint64_t)a << 32 | (uint64_t)b, c, item};
}

/* Give the facets of a mesh that nobody has seen yet the order they had. */
static bw_status order_facets(refiller *r, bw_mesh *made) {
  const bw_mesh *mesh = r->mesh;
  size_t width = (size_t)mesh->nodes_per_facet;
  bw_status status = BW_OK;
  int32_t *element = BW_NEW(r->context, int32_t, made->facet_count);
  bwi_keyed *list = BW_NEW(r->context, bwi_keyed, made->facet_count);
  if (!element || !list) {
    status = BW_MEMORY;
    goto done;
  }
  if (made->facet_count != mesh->facet_count)
    goto different;
  for (int32_t i = 0; i < made->facet_count; i++) {
    list[i] = facet_key(made->facet + width * (size_t)i, i);
    element[i] = made->facet_element[i];
  }
  bwi_sort_keyed(list, made->facet_count);
  for (int32_t i = 0; i < mesh->facet_count; i++) {
    const int32_t *old = mesh->facet + width * (size_t)i;
    int32_t now[6], low = 0, high = made->facet_count;
    for (size_t k = 0; k < width; k++)
      now[k] = r->number[old[k]];
    bwi_keyed key = facet_key(now, i);
    while (low < high) {
      int32_t middle = low + (high - low) / 2;
      const bwi_keyed *m = &list[middle];
      if (m->key < key.key || (m->key == key.key && m->item < key.item))
        low = middle + 1;
      else
        high = middle;
    }
    if (low == made->facet_count || list[low].key != key.key || list[low].item != key.item)
      goto different;
    memcpy(made->facet + width * (size_t)i, now, width * sizeof *now);
    made->facet_element[i] = element[list[low].part];
  }
  goto done;
different:
  status = bw_fail(r->context, BW_INTERNAL,
                   "%d boundary facets became %d others when a part was filled anew",
                   mesh->facet_count, made->facet_count);
done:
  bw_free(element);
  bw_free(list);
  return status;
}

bw_status bw_mesh_refill(bw_context *context, const bw_mesh *mesh, const double *node,
                         const uint8_t *replace, bw_mesh **refilled, int32_t **node_from,
                         int32_t **element_from) {
  refiller r = {.context = context, .mesh = mesh, .node = node};
  bw_mesh *made = NULL;
  bw_status status;
  BW_TRY(find_pieces(&r, replace));
  BW_TRY(check_kept(&r));
  for (int32_t p = 0; p < r.pieces; p++) {
    bw_progress(context, "filling anew", (double)p / r.pieces);
    BW_TRY(fill_piece(&r, p));
  }
  BW_TRY(join(&r));
  BW_TRY(bw_mesh_own(context, mesh->order, r.node_count, r.new_node, r.element_count, r.element,
                     r.region, &made));
  r.new_node = NULL;
  r.element = r.region = NULL;
  if (made->node_count != r.node_count) {
    status = bw_fail(context, BW_INTERNAL, "%lld nodes became %d when a part was filled anew",
                     (long long)r.node_count, made->node_count);
    goto done;
  }
  BW_TRY(order_facets(&r, made));
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
  for (int32_t p = 0; p < r.pieces; p++) {
    bw_free(r.piece[p].corner);
    bw_free(r.piece[p].filled.node);
    bw_free(r.piece[p].filled.element);
  }
  bw_free(r.piece);
  bw_free(r.piece_of);
  bw_free(r.ordered);
  bw_free(r.number);
  bw_free(r.new_node);
  bw_free(r.element);
  bw_free(r.region);
  bw_free(r.node_from);
  bw_free(r.element_from);
  return status;
}
