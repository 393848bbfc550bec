/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* Refinement of tetrahedral meshes by longest-edge bisection (Rivara 1984; in space Rivara and
 * Levin 1992).
 *
 * A cell is bisected at its longest edge where it has levels left, or where one of its edges was
 * bisected by a neighbour. Edges are ordered by length, then by the numbers of their ends, so that
 * all cells at an edge agree; every bisection that a neighbour causes is at a longer edge, and the
 * sweeps end. The result is conforming.
 *
 * Invariants: every corner of the mesh before stays and keeps its number while cells are bisected.
 * A cell carries the barycentric coordinates of its corners in the element of the mesh before that
 * it lies in; they are multiples of powers of 1/2 and exact. Positions, fields and supports follow
 * from them alone, so curved edges stay the curves that they were. */
#include "mesh/mesh_internal.h"

#include <math.h>
#include <string.h>

typedef struct cell {
  int32_t node[4], parent;
  uint8_t levels;
  double at[4][4]; /* barycentric coordinates of the corners in the parent */
} cell;

typedef struct slot {
  int32_t low, high, middle; /* middle -1: empty */
} slot;

typedef struct refining {
  bw_context *context;
  const bw_mesh *from;
  cell *cells;
  int64_t cell_count, cell_capacity, cell_limit;
  double *node; /* of the corners */
  int32_t node_count, node_capacity;
  slot *slots; /* bisected edges, open addressing; slot_capacity is a power of two */
  int64_t slot_count, slot_capacity;
} refining;

static void shape_of(int order, const double l[4], double *value) {
  for (int k = 0; k < 4; k++)
    value[k] = order == 1 ? l[k] : l[k] * (2 * l[k] - 1);
  for (int e = 0; order == 2 && e < 6; e++)
    value[4 + e] = 4 * l[bw_tet_edge[e][0]] * l[bw_tet_edge[e][1]];
}

/* Where barycentric coordinates of an element of the mesh before lie in space. */
static void place_of(const bw_mesh *mesh, int32_t element, const double l[4], double x[3]) {
  double value[10];
  const int32_t *node = mesh->element + (size_t)element * (size_t)mesh->nodes_per_element;
  shape_of(mesh->order, l, value);
  x[0] = x[1] = x[2] = 0;
  for (int a = 0; a < mesh->nodes_per_element; a++)
    for (size_t k = 0; k < 3; k++)
      x[k] += value[a] * mesh->node[3 * (size_t)node[a] + k];
}

/* ---- bisected edges -------------------------------------------------------------------------- */

static slot *find_slot(const refining *r, int32_t low, int32_t high) {
  uint64_t hash = ((uint64_t)(uint32_t)low << 32 | (uint32_t)high) * 0x9E3779B97F4A7C15u;
  int64_t at = (int64_t)(hash >> 20) & (r->slot_capacity - 1);
  while (r->slots[at].middle >= 0 && (r->slots[at].low != low || r->slots[at].high != high))
    at = (at + 1) & (r->slot_capacity - 1);
  return &r->slots[at];
}

static int32_t mid_edge_node_of(const refining *r, int32_t a, int32_t b) {
  return find_slot(r, a < b ? a : b, a < b ? b : a)->middle;
}

static bw_status make_slots(refining *r, int64_t capacity) {
  refining old = *r;
  slot *slots = BW_NEW(r->context, slot, capacity);
  if (!slots)
    return BW_MEMORY;
  for (int64_t i = 0; i < capacity; i++)
    slots[i].middle = -1;
  r->slots = slots;
  r->slot_capacity = capacity;
  for (int64_t i = 0; i < old.slot_capacity; i++)
    if (old.slots[i].middle >= 0)
      *find_slot(r, old.slots[i].low, old.slots[i].high) = old.slots[i];
  bw_free(old.slots);
  return BW_OK;
}

/* The corner in the middle of an edge of a cell, made where there is none yet. */
static bw_status take_middle(refining *r, const cell *c, int a, int b, int32_t *middle) {
  int32_t low = c->node[a], high = c->node[b];
  bw_status status = BW_OK;
  if (low > high) {
    low = c->node[b];
    high = c->node[a];
  }
  if (2 * r->slot_count >= r->slot_capacity)
    BW_TRY(make_slots(r, 2 * r->slot_capacity));
  slot *s = find_slot(r, low, high);
  if (s->middle < 0) {
    double l[4];
    if (r->node_count == r->node_capacity) {
      int64_t capacity = 2 * (int64_t)r->node_capacity;
      double *node = BW_NEW(r->context, double, 3 * capacity);
      if (!node)
        return BW_MEMORY;
      memcpy(node, r->node, 3 * (size_t)r->node_count * sizeof *node);
      bw_free(r->node);
      r->node = node;
      r->node_capacity = (int32_t)capacity;
    }
    for (int k = 0; k < 4; k++)
      l[k] = (c->at[a][k] + c->at[b][k]) / 2;
    place_of(r->from, c->parent, l, r->node + 3 * (size_t)r->node_count);
    *s = (slot){low, high, r->node_count++};
    r->slot_count++;
  }
  *middle = s->middle;
done:
  return status;
}

/* ---- bisection ------------------------------------------------------------------------------- */

static int longest_edge(const refining *r, const cell *c) {
  int best = 0;
  double max = -1;
  int32_t best_low = 0, best_high = 0;
  for (int e = 0; e < 6; e++) {
    int32_t a = c->node[bw_tet_edge[e][0]], b = c->node[bw_tet_edge[e][1]];
    int32_t low = a < b ? a : b, high = a < b ? b : a;
    double square = 0;
    for (size_t k = 0; k < 3; k++) {
      double d = r->node[3 * (size_t)high + k] - r->node[3 * (size_t)low + k];
      square += d * d;
    }
    if (square > max ||
        (square == max && (low < best_low || (low == best_low && high < best_high)))) {
      best = e;
      max = square;
      best_low = low;
      best_high = high;
    }
  }
  return best;
}

static bool is_hanging(const refining *r, const cell *c) {
  for (int e = 0; e < 6; e++)
    if (mid_edge_node_of(r, c->node[bw_tet_edge[e][0]], c->node[bw_tet_edge[e][1]]) >= 0)
      return true;
  return false;
}

static bw_status bisect(refining *r, int64_t number) {
  bw_status status = BW_OK;
  if (r->cell_count >= r->cell_limit)
    return bw_fail(r->context, BW_LIMIT,
                   "the refinement needs more than %lld elements: allow more, or refine less",
                   (long long)r->cell_limit);
  if (r->cell_count == r->cell_capacity) {
    cell *cells = BW_NEW(r->context, cell, 2 * r->cell_capacity);
    if (!cells)
      return BW_MEMORY;
    memcpy(cells, r->cells, (size_t)r->cell_count * sizeof *cells);
    bw_free(r->cells);
    r->cells = cells;
    r->cell_capacity *= 2;
  }
  cell *one = &r->cells[number], *two = &r->cells[r->cell_count];
  int edge = longest_edge(r, one), a = bw_tet_edge[edge][0], b = bw_tet_edge[edge][1];
  int32_t middle;
  BW_TRY(take_middle(r, one, a, b, &middle));
  r->cell_count++;
  if (one->levels > 0)
    one->levels--;
  *two = *one;
  for (int k = 0; k < 4; k++)
    one->at[b][k] = two->at[a][k] = (one->at[a][k] + one->at[b][k]) / 2;
  one->node[b] = two->node[a] = middle;
done:
  return status;
}

/* Sweeps over the cells until none has levels left or a bisected edge. New cells are visited in the
 * sweep that made them. */
static bw_status bisect_all(refining *r) {
  bool changed = true;
  while (changed) {
    changed = false;
    for (int64_t i = 0; i < r->cell_count; i++)
      while (r->cells[i].levels > 0 || is_hanging(r, &r->cells[i])) {
        bw_status status = bisect(r, i);
        if (status != BW_OK)
          return status;
        changed = true;
      }
    bw_status status = bw_check_cancel(r->context);
    if (status != BW_OK)
      return status;
  }
  return BW_OK;
}

static bw_status begin(refining *r, const uint8_t *levels) {
  const bw_mesh *mesh = r->from;
  size_t width = (size_t)mesh->nodes_per_element;
  r->cell_count = mesh->element_count;
  r->cell_capacity = 2 * r->cell_count;
  r->node_count = mesh->node_count; /* mid-edge nodes are dropped at the end */
  r->node_capacity = 2 * r->node_count;
  r->cells = BW_NEW(r->context, cell, r->cell_capacity);
  r->node = BW_NEW(r->context, double, 3 * (int64_t)r->node_capacity);
  if (!r->cells || !r->node)
    return BW_MEMORY;
  memcpy(r->node, mesh->node, 3 * (size_t)mesh->node_count * sizeof *r->node);
  for (int32_t e = 0; e < mesh->element_count; e++) {
    cell *c = &r->cells[e];
    *c = (cell){.parent = e, .levels = levels[e]};
    memcpy(c->node, mesh->element + width * (size_t)e, sizeof c->node);
    for (int k = 0; k < 4; k++)
      c->at[k][k] = 1;
  }
  return make_slots(r, 4096);
}

/* ---- the mesh that comes of it ------------------------------------------------------------- */

/* The straight mesh of the order that is wanted; *cell_of: the cell of every element. */
static bw_status make_mesh(refining *r, int order, bw_mesh **out, int32_t **cell_of) {
  bw_status status = BW_OK;
  bw_mesh *straight = NULL, *wide = NULL;
  size_t cells = (size_t)r->cell_count;
  bw_mesh_regions regions = bw_mesh_regions_of(r->from);
  int32_t *element = BW_NEW(r->context, int32_t, 4 * cells);
  int32_t *region = r->from->region ? BW_NEW(r->context, int32_t, cells) : NULL;
  BW_TRY_MEMORY(element && (!r->from->region || region));
  for (size_t i = 0; i < cells; i++) {
    const int32_t *n = r->cells[i].node;
    double error,
        volume =
            bwi_tet_determinant(r->node + 3 * (size_t)n[0], r->node + 3 * (size_t)n[1],
                                r->node + 3 * (size_t)n[2], r->node + 3 * (size_t)n[3], &error);
    if (!(volume > error))
      BW_TRY(bw_fail(r->context, BW_GEOMETRY,
                     "a part of element %d, which has curved edges, has no volume near (%g, %g, "
                     "%g): refine a mesh with better elements or straight edges",
                     r->cells[i].parent + 1, r->node[3 * (size_t)n[0]],
                     r->node[3 * (size_t)n[0] + 1], r->node[3 * (size_t)n[0] + 2]));
    memcpy(element + 4 * i, r->cells[i].node, 4 * sizeof *element);
    if (region)
      region[i] = r->from->region[r->cells[i].parent];
  }
  regions.of_element = region;
  BW_TRY(bw_mesh_adopt(r->context, 1, r->node_count, r->node, r->cell_count, element, &regions,
                       &straight));
  r->node = NULL;
  element = NULL;
  BW_TRY(bw_mesh_with_order(r->context, straight, order, &wide));
  BW_TRY(bw_mesh_renumbered(r->context, wide, NULL, cell_of, out));
done:
  bw_release(straight);
  bw_release(wide);
  bw_free(element);
  bw_free(region);
  return status;
}

/* Parents and coordinates of nodes, and their positions on curved edges. */
static bw_status place_nodes(refining *r, bw_refinement *f, const int32_t *cell_of,
                             bw_mesh **mesh) {
  bw_mesh *old = *mesh, *placed = NULL;
  int width = old->nodes_per_element;
  double *node = BW_NEW(r->context, double, 3 * (size_t)old->node_count);
  if (!node)
    return BW_MEMORY;
  for (int32_t i = 0; i < old->node_count; i++)
    f->node_parent[i] = -1;
  for (int32_t e = 0; e < old->element_count; e++) {
    const cell *c = &r->cells[cell_of[e]];
    f->element_parent[e] = c->parent;
    for (int a = 0; a < width; a++) {
      size_t i = (size_t)old->element[(size_t)e * (size_t)width + (size_t)a];
      if (f->node_parent[i] >= 0)
        continue;
      f->node_parent[i] = c->parent;
      const double *one = c->at[a < 4 ? a : bw_tet_edge[a - 4][0]];
      const double *two = c->at[a < 4 ? a : bw_tet_edge[a - 4][1]];
      for (size_t k = 0; k < 4; k++)
        f->node_weight[4 * i + k] = (one[k] + two[k]) / 2;
      place_of(r->from, c->parent, f->node_weight + 4 * i, node + 3 * i);
    }
  }
  bw_status status = bw_mesh_moved(r->context, old, node, &placed);
  bw_free(node);
  if (status == BW_OK) {
    bw_release(old);
    *mesh = placed;
  }
  return status;
}

/* The facet before that a facet lies in: a face of the parent that all its corners lie on. */
static bw_status find_facets(refining *r, bw_refinement *f, const int32_t *cell_of) {
  const bw_mesh *from = r->from, *mesh = f->mesh;
  size_t width = (size_t)mesh->nodes_per_element;
  int32_t *facet_of = BW_NEW(r->context, int32_t, 4 * (size_t)from->element_count);
  if (!facet_of)
    return BW_MEMORY;
  for (int32_t t = 0; t < from->facet_count; t++) {
    const int32_t *corner = from->facet + (size_t)t * (size_t)from->nodes_per_facet;
    size_t e = (size_t)from->facet_element[t];
    const int32_t *own = from->element + e * (size_t)from->nodes_per_element;
    for (size_t k = 0; k < 4; k++)
      if (own[k] != corner[0] && own[k] != corner[1] && own[k] != corner[2])
        facet_of[4 * e + k] = t;
  }
  for (int32_t t = 0; t < mesh->facet_count; t++) {
    const int32_t *corner = mesh->facet + (size_t)t * (size_t)mesh->nodes_per_facet;
    size_t e = (size_t)mesh->facet_element[t];
    const int32_t *own = mesh->element + e * width;
    const cell *c = &r->cells[cell_of[e]];
    size_t across = 0;
    for (size_t k = 0; k < 4; k++)
      if (own[k] != corner[0] && own[k] != corner[1] && own[k] != corner[2])
        across = k;
    for (size_t face = 0; face < 4; face++) {
      bool on = true;
      for (size_t k = 0; k < 4; k++)
        on = on && (k == across || c->at[k][face] == 0);
      if (on)
        f->facet_parent[t] = facet_of[4 * (size_t)c->parent + face];
    }
  }
  bw_free(facet_of);
  return BW_OK;
}

void bw_refinement_clear(bw_refinement *refinement) {
  bw_release(refinement->mesh);
  bw_free(refinement->element_parent);
  bw_free(refinement->facet_parent);
  bw_free(refinement->node_parent);
  bw_free(refinement->node_weight);
  *refinement = (bw_refinement){.mesh = NULL};
}

bw_status bw_mesh_refine(bw_context *context, const bw_mesh *mesh, const uint8_t *levels, int order,
                         int64_t max_elements, bw_refinement *refinement) {
  bw_status status;
  refining r = {.context = context, .from = mesh, .cell_limit = max_elements};
  bw_refinement f = {.mesh = NULL};
  bw_mesh *made = NULL;
  int32_t *cell_of = NULL;
  if (order < mesh->order || order > 2)
    return bw_fail(context, BW_INVALID,
                   "order %d: a refined mesh has the order of the given mesh, which is %d, or 2",
                   order, mesh->order);
  if (max_elements < mesh->element_count || max_elements > INT32_MAX / 8)
    return bw_fail(context, BW_INVALID,
                   "max_elements %lld: give at least the %d elements that there are, at most %d",
                   (long long)max_elements, mesh->element_count, INT32_MAX / 8);
  BW_TRY(begin(&r, levels));
  BW_TRY(bisect_all(&r));
  BW_TRY(make_mesh(&r, order, &made, &cell_of));
  f.element_parent = BW_NEW(context, int32_t, made->element_count);
  f.facet_parent = BW_NEW(context, int32_t, made->facet_count);
  f.node_parent = BW_NEW(context, int32_t, made->node_count);
  f.node_weight = BW_NEW(context, double, 4 * (size_t)made->node_count);
  BW_TRY_MEMORY(f.element_parent && f.facet_parent && f.node_parent && f.node_weight);
  BW_TRY(place_nodes(&r, &f, cell_of, &made));
  f.mesh = made;
  BW_TRY(find_facets(&r, &f, cell_of));
  if (mesh->names) {
    int32_t *group = BW_NEW(context, int32_t, made->facet_count);
    BW_TRY_MEMORY(group);
    for (int32_t t = 0; t < made->facet_count; t++)
      group[t] = mesh->facet_group[f.facet_parent[t]];
    bwi_mesh_adopt_groups(made, group, mesh->names);
  }
  *refinement = f;
  f = (bw_refinement){.mesh = NULL};
  made = NULL;
done:
  if (!f.mesh)
    bw_release(made);
  bw_refinement_clear(&f);
  bw_free(cell_of);
  bw_free(r.cells);
  bw_free(r.node);
  bw_free(r.slots);
  return status;
}
