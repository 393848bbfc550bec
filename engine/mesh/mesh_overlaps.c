/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* Which bodies of a mesh overlap.
 *
 * Two bodies that overlap, and are no more than that, have an element at the boundary of one of
 * them that overlaps an element of the other. So only the elements at the boundary are compared
 * with those near them. Two elements are convex: the shortest motion that takes them apart is along
 * the normal of a face or across an edge of each (the theorem of the separating axis), and the
 * volume that they share follows by cutting one at the faces of the other. */
#include <math.h>
#include <string.h>

#include "mesh/locator.h"
#include "mesh/mesh_internal.h"
#include "mesh/surface_tree.h"

static const double touching = 1e-6; /* of the diagonal of the mesh's box */
static const double parallel = 1e-9; /* of the product of two edges: the area between them */
static const double shallow = 0.05;  /* of an edge: press fits, and facets of curved faces */
static const double large = 0.1;     /* of the volume of the smaller body: no fit is so deep */

typedef struct search {
  bw_context *context;
  const bw_mesh *mesh;
  bw_locator *near;
  double tolerance;    /* (m) that elements which only touch may overlap by */
  double *body_volume; /* (m3, component_count) */
  bw_mesh_overlaps *found;

  /* of the element that is compared with others */
  int32_t element;
  const double *x[4];

  /* of the pair of bodies that is measured */
  bw_mesh_overlap *pair;
  bwi_tree *boundary[2]; /* of the lower body, and of the other one */
  uint8_t *measured;     /* (node_count) */
  int32_t *corner;       /* (facet_count x 3) of the mesh's facets */
} search;

static int32_t body_of(const bw_mesh *mesh, int32_t element) {
  return mesh->component[mesh->element[(int64_t)element * mesh->nodes_per_element]];
}

static void corners_of(const bw_mesh *mesh, int32_t element, const double *x[4]) {
  for (int k = 0; k < 4; k++)
    x[k] = mesh->node + 3 * (int64_t)mesh->element[(int64_t)element * mesh->nodes_per_element + k];
}

static void box_of(const double *const x[4], double min[3], double max[3]) {
  for (int k = 0; k < 3; k++) {
    min[k] = fmin(fmin(x[0][k], x[1][k]), fmin(x[2][k], x[3][k]));
    max[k] = fmax(fmax(x[0][k], x[1][k]), fmax(x[2][k], x[3][k]));
  }
}

static void difference(const double *a, const double *b, double out[3]) {
  for (int k = 0; k < 3; k++)
    out[k] = a[k] - b[k];
}

/* ---- two elements ---------------------------------------------------------------------------- */

/* Takes the motion along an axis (of any length) where it is shorter. */
static void take_axis(const double *const x[4], const double *const y[4], const double axis[3],
                      double *depth) {
  double low[2] = {INFINITY, INFINITY}, high[2] = {-INFINITY, -INFINITY}, from[3];
  for (int i = 0; i < 4; i++)
    for (int side = 0; side < 2; side++) {
      difference(side ? y[i] : x[i], x[0], from); /* far from the origin no digit is lost */
      double along = bw_dot(from, axis);
      low[side] = fmin(low[side], along);
      high[side] = fmax(high[side], along);
    }
  double apart = fmin(high[0] - low[1], high[1] - low[0]) / bw_norm(axis);
  *depth = fmin(*depth, apart);
}

/* The length of the shortest motion that takes two elements apart; 0 or less where they are. */
static double depth_of_pair(const double *const x[4], const double *const y[4], double enough) {
  double depth = INFINITY, a[3], b[3], axis[3];
  for (int side = 0; side < 2; side++)
    for (int f = 0; f < 4; f++) {
      const double *const *z = side ? y : x;
      difference(z[bw_tet_face[f][1]], z[bw_tet_face[f][0]], a);
      difference(z[bw_tet_face[f][2]], z[bw_tet_face[f][0]], b);
      bw_cross(a, b, axis);
      take_axis(x, y, axis, &depth);
      if (depth <= enough)
        return depth;
    }
  for (int i = 0; i < 6; i++)
    for (int j = 0; j < 6; j++) {
      difference(x[bw_tet_edge[i][1]], x[bw_tet_edge[i][0]], a);
      difference(y[bw_tet_edge[j][1]], y[bw_tet_edge[j][0]], b);
      bw_cross(a, b, axis);
      if (bw_norm(axis) <= parallel * bw_norm(a) * bw_norm(b))
        continue;
      take_axis(x, y, axis, &depth);
      if (depth <= enough)
        return depth;
    }
  return depth;
}

/* Adds the volume of the part of a tetrahedron y that is inside the faces `face` to 3 of x, and
 * that volume times the part's centroid. */
static void add_common(const double *const x[4], int face, double y[4][3], double *volume,
                       double moment[3]) {
  double height[4], cut[4][3], a[3], b[3], c[3], normal[3];
  int in[4], out[4], ins = 0, outs = 0;
  if (face == 4) {
    difference(y[1], y[0], a);
    difference(y[2], y[0], b);
    difference(y[3], y[0], c);
    bw_cross(a, b, normal);
    double part = fabs(bw_dot(normal, c)) / 6;
    *volume += part;
    for (int k = 0; k < 3; k++)
      moment[k] += part * (y[0][k] + y[1][k] + y[2][k] + y[3][k]) / 4;
    return;
  }
  const double *corner = x[bw_tet_face[face][0]];
  difference(x[bw_tet_face[face][1]], corner, a);
  difference(x[bw_tet_face[face][2]], corner, b);
  bw_cross(a, b, normal);
  for (int i = 0; i < 4; i++) {
    difference(y[i], corner, a);
    height[i] = bw_dot(normal, a);
    if (height[i] <= 0)
      in[ins++] = i;
    else
      out[outs++] = i;
  }
  if (ins == 0)
    return;
  if (ins == 4) {
    add_common(x, face + 1, y, volume, moment);
    return;
  }
  for (int i = 0, n = 0; i < ins; i++)
    for (int j = 0; j < outs; j++, n++) {
      double t = height[in[i]] / (height[in[i]] - height[out[j]]);
      for (int k = 0; k < 3; k++)
        cut[n][k] = y[in[i]][k] + t * (y[out[j]][k] - y[in[i]][k]);
    }
  /* One corner inside leaves a tetrahedron, two or three leave a prism, whose corners i and i + 3
   * are the ends of an edge. */
  const double *prism[6] = {y[in[0]], cut[0], cut[1], ins > 1 ? y[in[1]] : cut[2], cut[2], cut[3]};
  if (ins == 3) {
    const double *other[6] = {y[in[0]], y[in[1]], y[in[2]], cut[0], cut[1], cut[2]};
    memcpy(prism, other, sizeof other);
  }
  for (int first = 0; first < (ins == 1 ? 1 : 3); first++) {
    double part[4][3];
    for (int i = 0; i < 4; i++)
      memcpy(part[i], prism[first + i], sizeof part[i]);
    add_common(x, face + 1, part, volume, moment);
  }
}

/* ---- which bodies ---------------------------------------------------------------------------- */

/* The place of a pair in the list, ascending by its bodies, where it is or belongs. */
static int32_t place_of(const bw_mesh_overlaps *found, int32_t a, int32_t b) {
  int32_t low = 0, high = found->count;
  while (low < high) {
    int32_t middle = (low + high) / 2;
    const int32_t *body = found->overlap[middle].body;
    if (body[0] < a || (body[0] == a && body[1] < b))
      low = middle + 1;
    else
      high = middle;
  }
  return low;
}

static bw_status take_pair(void *data, int32_t other) {
  search *s = (search *)data;
  bw_mesh_overlaps *found = s->found;
  const double *y[4];
  int32_t a = body_of(s->mesh, s->element), b = body_of(s->mesh, other);
  if (a == b || found->more)
    return BW_OK;
  int32_t lower = a < b ? a : b, upper = a < b ? b : a, place = place_of(found, lower, upper);
  bw_mesh_overlap *at = found->overlap + place;
  if (place < found->count && at->body[0] == lower && at->body[1] == upper)
    return BW_OK;
  corners_of(s->mesh, other, y);
  if (depth_of_pair(s->x, y, s->tolerance) <= s->tolerance)
    return BW_OK;
  if (found->count == BW_MESH_OVERLAPS) {
    found->more = true;
    return BW_OK;
  }
  memmove(at + 1, at, (size_t)(found->count++ - place) * sizeof *at);
  *at = (bw_mesh_overlap){.body = {lower, upper}};
  return BW_OK;
}

static bw_status compare(search *s, int32_t element, bwi_item_visit *visit) {
  double min[3], max[3];
  s->element = element;
  corners_of(s->mesh, element, s->x);
  box_of(s->x, min, max);
  return bwi_locator_in_box(s->near, min, max, visit, s);
}

static bw_status find_pairs(search *s) {
  bw_status status = BW_OK;
  const bw_mesh *mesh = s->mesh;
  uint8_t *outside = BW_NEW0(s->context, uint8_t, mesh->node_count);
  BW_TRY_MEMORY(outside);
  for (int32_t i = 0; i < mesh->boundary_node_count; i++)
    outside[mesh->boundary_node[i]] = 1;
  for (int32_t e = 0; e < mesh->element_count; e++) {
    const int32_t *node = mesh->element + (int64_t)e * mesh->nodes_per_element;
    if (e % 4096 == 0)
      BW_TRY(bw_check_cancel(s->context));
    if (outside[node[0]] || outside[node[1]] || outside[node[2]] || outside[node[3]])
      BW_TRY(compare(s, e, take_pair));
  }
done:
  bw_free(outside);
  return status;
}

/* ---- how deep -------------------------------------------------------------------------------- */

static void take_depth(search *s, double depth, const double at[3], int32_t other) {
  bw_mesh_overlap *pair = s->pair;
  if (!(depth > pair->depth))
    return;
  bool lower = body_of(s->mesh, s->element) == pair->body[0];
  pair->depth = depth;
  pair->element[0] = lower ? s->element : other;
  pair->element[1] = lower ? other : s->element;
  memcpy(pair->at, at, sizeof pair->at);
  pair->edge = cbrt(6 * sqrt(2) * fmin(s->mesh->volume[s->element], s->mesh->volume[other]));
}

/* The depth of the corners of an element that are in the other one: their distances from the
 * boundary of the other one's body. */
static void take_corners(search *s, int32_t element, int32_t holder, int32_t other) {
  const double *y[4];
  corners_of(s->mesh, holder, y);
  for (int i = 0; i < 4; i++) {
    int32_t node = s->mesh->element[(int64_t)element * s->mesh->nodes_per_element + i], facet;
    const double *at = s->mesh->node + 3 * (int64_t)node;
    double from[3], a[3], b[3], normal[3], place[3];
    bool inside = !s->measured[node];
    for (int f = 0; f < 4 && inside; f++) {
      difference(y[bw_tet_face[f][1]], y[bw_tet_face[f][0]], a);
      difference(y[bw_tet_face[f][2]], y[bw_tet_face[f][0]], b);
      difference(at, y[bw_tet_face[f][0]], from);
      bw_cross(a, b, normal);
      inside = bw_dot(normal, from) <= 0;
    }
    if (!inside)
      continue;
    s->measured[node] = 1;
    int side = body_of(s->mesh, holder) == s->pair->body[1];
    take_depth(s, sqrt(bwi_tree_nearest(s->boundary[side], at, -1, 0, place, &facet)), at, other);
  }
}

static bw_status measure(void *data, int32_t other) {
  search *s = (search *)data;
  const double *y[4];
  double volume = 0, moment[3] = {0, 0, 0}, part[4][3];
  int32_t body = body_of(s->mesh, other);
  if (body == body_of(s->mesh, s->element) ||
      (body != s->pair->body[0] && body != s->pair->body[1]))
    return BW_OK;
  corners_of(s->mesh, other, y);
  double depth = depth_of_pair(s->x, y, s->tolerance);
  if (depth <= s->tolerance)
    return BW_OK;
  for (int i = 0; i < 4; i++)
    difference(y[i], s->x[0], part[i]);
  double own[4][3];
  for (int i = 0; i < 4; i++)
    difference(s->x[i], s->x[0], own[i]);
  add_common((const double *const[4]){own[0], own[1], own[2], own[3]}, 0, part, &volume, moment);
  s->pair->volume += volume;
  for (int k = 0; k < 3; k++)
    moment[k] = s->x[0][k] + (volume > 0 ? moment[k] / volume : 0);
  take_depth(s, depth, moment, other);
  take_corners(s, s->element, other, other);
  take_corners(s, other, s->element, other);
  return BW_OK;
}

/* Trees of the boundaries of the pair's bodies. */
static bw_status open_boundaries(search *s) {
  bw_status status = BW_OK;
  const bw_mesh *mesh = s->mesh;
  uint8_t *skip = BW_NEW(s->context, uint8_t, mesh->facet_count);
  BW_TRY_MEMORY(skip);
  for (int side = 0; side < 2; side++) {
    for (int32_t f = 0; f < mesh->facet_count; f++)
      skip[f] = body_of(mesh, mesh->facet_element[f]) != s->pair->body[side];
    BW_TRY(bwi_tree_create(s->context, mesh->node, mesh->facet_count, s->corner, skip,
                           &s->boundary[side]));
  }
done:
  bw_free(skip);
  return status;
}

/* Compares the elements of the smaller body with those of the other one. */
static bw_status measure_pair(search *s, const int32_t *element_count) {
  bw_status status = BW_OK;
  const bw_mesh *mesh = s->mesh;
  const int32_t *body = s->pair->body;
  int32_t smaller = body[element_count[body[1]] < element_count[body[0]]];
  memset(s->measured, 0, (size_t)mesh->node_count);
  BW_TRY(open_boundaries(s));
  for (int32_t e = 0; e < mesh->element_count; e++) {
    if (e % 1024 == 0)
      BW_TRY(bw_check_cancel(s->context));
    if (body_of(mesh, e) == smaller)
      BW_TRY(compare(s, e, measure));
  }
  s->pair->fraction = s->pair->volume / fmin(s->body_volume[body[0]], s->body_volume[body[1]]);
done:
  for (int side = 0; side < 2; side++) {
    bwi_tree_destroy(s->boundary[side]);
    s->boundary[side] = NULL;
  }
  return status;
}

static bw_status measure_pairs(search *s) {
  bw_status status = BW_OK;
  const bw_mesh *mesh = s->mesh;
  int32_t *elements = BW_NEW0(s->context, int32_t, mesh->component_count);
  s->measured = BW_NEW(s->context, uint8_t, mesh->node_count);
  s->corner = BW_NEW(s->context, int32_t, 3 * (int64_t)mesh->facet_count);
  s->body_volume = BW_NEW0(s->context, double, mesh->component_count);
  BW_TRY_MEMORY(elements && s->measured && s->corner && s->body_volume);
  for (int32_t f = 0; f < mesh->facet_count; f++)
    memcpy(s->corner + 3 * (int64_t)f, mesh->facet + (int64_t)f * mesh->nodes_per_facet,
           3 * sizeof *s->corner);
  for (int32_t e = 0; e < mesh->element_count; e++) {
    elements[body_of(mesh, e)]++;
    s->body_volume[body_of(mesh, e)] += mesh->volume[e];
  }
  for (int32_t i = 0; i < s->found->count; i++) {
    s->pair = &s->found->overlap[i];
    BW_TRY(measure_pair(s, elements));
  }
done:
  bw_free(elements);
  bw_free(s->measured);
  bw_free(s->corner);
  bw_free(s->body_volume);
  return status;
}

bw_status bw_mesh_overlaps_find(bw_context *context, const bw_mesh *mesh,
                                bw_mesh_overlaps *overlaps) {
  bw_status status = BW_OK;
  double min[3], max[3], diagonal[3];
  search s = {.context = context, .mesh = mesh, .found = overlaps};
  *overlaps = (bw_mesh_overlaps){0};
  if (mesh->component_count < 2)
    return BW_OK;
  overlaps->overlap = BW_NEW(context, bw_mesh_overlap, BW_MESH_OVERLAPS);
  BW_TRY_MEMORY(overlaps->overlap);
  bw_mesh_box(mesh, min, max);
  difference(max, min, diagonal);
  s.tolerance = touching * bw_norm(diagonal);
  BW_TRY(bw_locator_create(context, mesh, &s.near));
  BW_TRY(find_pairs(&s));
  if (overlaps->count > 0)
    BW_TRY(measure_pairs(&s));
done:
  bw_release(s.near);
  if (status != BW_OK)
    bw_mesh_overlaps_clear(overlaps);
  return status;
}

void bw_mesh_overlaps_clear(bw_mesh_overlaps *overlaps) {
  bw_free(overlaps->overlap);
  *overlaps = (bw_mesh_overlaps){0};
}

/* ---- what analyses refuse ----------------------------------------------------------------------
 */

bw_status bwi_mesh_check_overlaps(bw_context *context, const bw_mesh *mesh) {
  bw_mesh_overlaps overlaps;
  bw_status status = bw_mesh_overlaps_find(context, mesh, &overlaps);
  if (status != BW_OK)
    return status;
  const bw_mesh_overlap *largest = NULL, *deepest = NULL;
  for (int32_t i = 0; i < overlaps.count; i++) {
    const bw_mesh_overlap *o = &overlaps.overlap[i];
    if (!largest || o->fraction > largest->fraction)
      largest = o;
    if (o->depth > shallow * o->edge && (!deepest || o->depth > deepest->depth))
      deepest = o;
  }
  const bw_mesh_overlap *worst = largest && largest->fraction > large ? largest : deepest;
  if (!worst)
    goto done;
  int lower = worst->body[0] + 1, upper = worst->body[1] + 1;
  const double *at = worst->at;
  if (worst == largest && worst->fraction > large) {
    status = bw_fail(context, BW_GEOMETRY,
                     "bodies %d and %d of the mesh overlap: both take up %.3g m3, which is %.3g %% "
                     "of the smaller one; the deepest place, at least %.3g m deep, is near "
                     "(%g, %g, %g) m. Move them apart, or remove the elements of one there",
                     lower, upper, worst->volume, 100 * worst->fraction, worst->depth, at[0], at[1],
                     at[2]);
    bw_detail_number(context, "body", lower);
    bw_detail_number(context, "other", upper);
    bw_detail_number(context, "depth", worst->depth);
  } else {
    bw_warn(context,
            "bodies %d and %d of the mesh overlap by at least %.3g m near (%g, %g, %g) m: material "
            "counts twice there, and nothing but contact takes an interference fit apart",
            lower, upper, worst->depth, at[0], at[1], at[2]);
  }
done:
  bw_mesh_overlaps_clear(&overlaps);
  return status;
}
