/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* The making of a tetrahedral mesh: what a reader or a mesher hands over is checked, put in order
 * and given its topology. After that nothing in it changes.
 *
 * Invariants of every bw_mesh:
 *   - every node is used by an element, every coordinate is finite, every volume is positive;
 *   - a face belongs to one element (then it is a boundary facet) or to two that lie on opposite
 *     sides of it and, at order 2, share its mid-edge nodes;
 *   - neighbour[4 e + k] is the element across face k of e, and that element names e in return;
 *   - facets come in the order of their elements and faces, components in the order of their lowest
 *     nodes: the same input gives the same arrays;
 *   - either every element has a region or none; mesh_regions.c states what holds for regions. */
#include "base/union_find.h"
#include "mesh/mesh_internal.h"

#include <assert.h>
#include <float.h>
#include <math.h>
#include <string.h>

const int bw_tet_edge[6][2] = {{0, 1}, {1, 2}, {2, 0}, {0, 3}, {1, 3}, {2, 3}};
const int bw_tet_face[4][3] = {{0, 2, 1}, {0, 1, 3}, {1, 2, 3}, {0, 3, 2}};
const int bw_tet_face_mid_edge[4][3] = {{6, 5, 4}, {4, 8, 7}, {5, 9, 8}, {7, 9, 6}};

static void mesh_destroy(void *object) {
  bwi_mesh *body = object;
  bw_mesh *mesh = &body->mesh;
  bw_free(mesh->regions);
  bw_free(mesh->region);
  bw_release(mesh->names);
  if (body->places) {
    bw_release(body->places);
  } else {
    bw_free(mesh->node);
    bw_free(mesh->volume);
  }
  if (body->topology) {
    bw_release(body->topology);
  } else {
    bw_free(mesh->element);
    bw_free(mesh->facet);
    bw_free(mesh->facet_element);
    bw_free(mesh->facet_group);
    bw_free(mesh->boundary_node);
    bw_free(mesh->neighbour);
    bw_free(mesh->component);
  }
  bw_free(body);
}

static size_t mesh_bytes(const void *object) {
  const bwi_mesh *body = object;
  const bw_mesh *mesh = &body->mesh;
  size_t elements = (size_t)mesh->element_count, nodes = (size_t)mesh->node_count;
  size_t bytes = sizeof *body + (size_t)mesh->region_count * sizeof *mesh->regions +
                 (mesh->region ? elements * sizeof *mesh->region : 0);
  if (!body->places)
    bytes += nodes * 3 * sizeof(double) + elements * sizeof(double);
  if (!body->topology)
    bytes += sizeof(int32_t) * (elements * ((size_t)mesh->nodes_per_element + 4) +
                                (size_t)mesh->facet_count * ((size_t)mesh->nodes_per_facet + 1) +
                                (mesh->facet_group ? (size_t)mesh->facet_count : 0) +
                                (size_t)mesh->boundary_node_count + nodes);
  return bytes;
}

static const bw_kind mesh_kind = {"mesh", mesh_destroy, mesh_bytes};

bw_mesh *bwi_mesh_create(bw_context *context) {
  bwi_mesh *body = BW_NEW0(context, bwi_mesh, 1);
  if (!body)
    return NULL;
  bw_object_init(body, &mesh_kind);
  return &body->mesh;
}

double bwi_tet_determinant(const double *x0, const double *x1, const double *x2, const double *x3,
                           double *error) {
  double a[3], b[3], c[3], size = 0, offset = 0;
  for (int i = 0; i < 3; i++) {
    a[i] = x1[i] - x0[i];
    b[i] = x2[i] - x0[i];
    c[i] = x3[i] - x0[i];
    size = fmax(size, fmax(fabs(a[i]), fmax(fabs(b[i]), fabs(c[i]))));
    offset = fmax(offset, fabs(x0[i]));
  }
  if (error)
    *error = 8 * DBL_EPSILON * (size + offset) * size * size;
  return a[0] * (b[1] * c[2] - b[2] * c[1]) + a[1] * (b[2] * c[0] - b[0] * c[2]) +
         a[2] * (b[0] * c[1] - b[1] * c[0]);
}

/* ---- sorting -------------------------------------------------------------------------------- */

static bool keyed_before(const bwi_keyed *a, const bwi_keyed *b) {
  if (a->key != b->key)
    return a->key < b->key;
  return a->item != b->item ? a->item < b->item : a->part < b->part;
}

static void sift_down(bwi_keyed *list, int64_t root, int64_t count) {
  bwi_keyed moving = list[root];
  for (;;) {
    int64_t child = 2 * root + 1;
    if (child >= count)
      break;
    if (child + 1 < count && keyed_before(&list[child], &list[child + 1]))
      child++;
    if (!keyed_before(&moving, &list[child]))
      break;
    list[root] = list[child];
    root = child;
  }
  list[root] = moving;
}

void bwi_sort_keyed(bwi_keyed *list, int64_t count) {
  if (count <= 48) { /* the usual bucket holds some twenty */
    for (int64_t i = 1; i < count; i++) {
      bwi_keyed moving = list[i];
      int64_t j = i;
      for (; j > 0 && keyed_before(&moving, &list[j - 1]); j--)
        list[j] = list[j - 1];
      list[j] = moving;
    }
    return;
  }
  for (int64_t i = count / 2; i-- > 0;)
    sift_down(list, i, count);
  for (int64_t end = count - 1; end > 0; end--) {
    bwi_keyed last = list[end];
    list[end] = list[0];
    list[0] = last;
    sift_down(list, 0, end);
  }
}

/* ---- checks --------------------------------------------------------------------------------- */

static bw_status check_sizes(bw_context *context, int order, int64_t nodes, const void *node,
                             int64_t elements, const void *element) {
  if (order != 1 && order != 2)
    return bw_fail(context, BW_INVALID, "order %d: a mesh of tetrahedra has order 1 or 2", order);
  if (nodes < 0 || elements < 0 || (nodes > 0 && !node) || (elements > 0 && !element))
    return bw_fail(context, BW_INVALID, "a mesh needs arrays of nodes and elements");
  if (elements == 0)
    return bw_fail(context, BW_GEOMETRY, "the mesh has no elements");
  if (nodes > INT32_MAX || elements > INT32_MAX) {
    bw_fail(context, BW_LIMIT, "%lld nodes and %lld elements: a mesh holds at most 2147483647 each",
            (long long)nodes, (long long)elements);
    return BW_LIMIT;
  }
  return BW_OK;
}

static bw_status check_numbers(bw_context *context, int per_element, int64_t nodes,
                               const double *node, int64_t elements, const int32_t *element) {
  for (int64_t i = 0; i < 3 * nodes; i++)
    if (!isfinite(node[i])) {
      bw_fail(context, BW_GEOMETRY,
              "node %lld has the coordinates (%g, %g, %g) m: every one must be a finite number",
              (long long)(i / 3) + 1, node[i / 3 * 3], node[i / 3 * 3 + 1], node[i / 3 * 3 + 2]);
      bw_detail_number(context, "node", (double)(i / 3 + 1));
      return BW_GEOMETRY;
    }
  for (int64_t i = 0; i < per_element * elements; i++)
    if (element[i] < 0 || element[i] >= nodes) {
      bw_fail(context, BW_GEOMETRY, "element %lld names node %d, but the nodes are 1 to %lld",
              (long long)(i / per_element) + 1, element[i] + 1, (long long)nodes);
      bw_detail_number(context, "element", (double)(i / per_element + 1));
      bw_detail_number(context, "node", element[i] + 1.0);
      return BW_GEOMETRY;
    }
  return BW_OK;
}

/* Exchange corners 1 and 2 and their mid-edge nodes: the orientation is reversed. */
static void reverse_element(int32_t *e, int order) {
  static const int pair[3][2] = {{1, 2}, {4, 6}, {8, 9}};
  for (int i = 0; i < (order == 2 ? 3 : 1); i++) {
    int32_t kept = e[pair[i][0]];
    e[pair[i][0]] = e[pair[i][1]];
    e[pair[i][1]] = kept;
  }
}

static bw_status find_volumes(bw_context *context, bw_mesh *mesh, bool flat) {
  for (int32_t i = 0; i < mesh->element_count; i++) {
    int32_t *e = mesh->element + (size_t)i * (size_t)mesh->nodes_per_element;
    const double *x[4];
    for (int k = 0; k < 4; k++)
      x[k] = mesh->node + 3 * (size_t)e[k];
    double error;
    double determinant = bwi_tet_determinant(x[0], x[1], x[2], x[3], &error);
    if (flat && fabs(determinant) <= error) {
      mesh->volume[i] = 0;
      continue;
    }
    if (!(fabs(determinant) > error) || !isfinite(determinant)) {
      bw_fail(
          context, BW_GEOMETRY,
          "element %d (nodes %d %d %d %d) near (%g, %g, %g) m has no volume: its corners lie in "
          "one plane to within rounding",
          i + 1, e[0] + 1, e[1] + 1, e[2] + 1, e[3] + 1, x[0][0], x[0][1], x[0][2]);
      bw_detail_number(context, "element", i + 1.0);
      return BW_GEOMETRY;
    }
    if (determinant < 0)
      reverse_element(e, mesh->order);
    mesh->volume[i] = fabs(determinant) / 6;
  }
  return BW_OK;
}

/* ---- topology ------------------------------------------------------------------------------- */

static bw_status drop_unused_nodes(bw_context *context, bw_mesh *mesh) {
  size_t entries = (size_t)mesh->element_count * (size_t)mesh->nodes_per_element;
  int32_t *number = BW_NEW0(context, int32_t, mesh->node_count);
  if (!number)
    return BW_MEMORY;
  for (size_t i = 0; i < entries; i++)
    number[mesh->element[i]] = 1;
  int32_t kept = 0;
  for (int32_t i = 0; i < mesh->node_count; i++)
    if (number[i]) {
      if (kept != i)
        memcpy(mesh->node + 3 * (size_t)kept, mesh->node + 3 * (size_t)i, 3 * sizeof(double));
      number[i] = kept++;
    }
  if (kept != mesh->node_count)
    for (size_t i = 0; i < entries; i++)
      mesh->element[i] = number[mesh->element[i]];
  mesh->node_count = kept;
  bw_free(number);
  return BW_OK;
}

/* The corners of a face in ascending order. */
static void face_corners(const bw_mesh *mesh, int32_t element, int face, int32_t corner[3]) {
  const int32_t *e = mesh->element + (size_t)element * (size_t)mesh->nodes_per_element;
  int32_t a = e[bw_tet_face[face][0]], b = e[bw_tet_face[face][1]], c = e[bw_tet_face[face][2]], t;
  if (a > b)
    t = a, a = b, b = t;
  if (b > c)
    t = b, b = c, c = t;
  if (a > b)
    t = a, a = b, b = t;
  corner[0] = a, corner[1] = b, corner[2] = c;
}

static bw_status fail_pair(bw_context *context, const bw_mesh *mesh, const bwi_keyed *a,
                           const bwi_keyed *b, const char *what) {
  int32_t c[3];
  face_corners(mesh, a->item, a->part, c);
  const double *x = mesh->node + 3 * (size_t)c[0];
  bw_fail(context, BW_GEOMETRY,
          "elements %d and %d share the face of nodes %d %d %d near (%g, %g, %g) m but %s",
          a->item + 1, b->item + 1, c[0] + 1, c[1] + 1, c[2] + 1, x[0], x[1], x[2], what);
  bw_detail_number(context, "element", a->item + 1.0);
  bw_detail_number(context, "other", b->item + 1.0);
  return BW_GEOMETRY;
}

/* Two elements meet in a face: seen from both it must turn the opposite way round, since both have
 * positive volume, and have the same mid-edge nodes. */
static bw_status join_faces(bw_context *context, bw_mesh *mesh, const bwi_keyed *a,
                            const bwi_keyed *b) {
  size_t width = (size_t)mesh->nodes_per_element;
  const int32_t *ea = mesh->element + (size_t)a->item * width;
  const int32_t *eb = mesh->element + (size_t)b->item * width;
  const int *fa = bw_tet_face[a->part], *fb = bw_tet_face[b->part];
  int shift = 0; /* the index in face b of corner 0 of face a */
  while (shift < 2 && eb[fb[shift]] != ea[fa[0]])
    shift++;
  const bool solid = mesh->volume[a->item] > 0 && mesh->volume[b->item] > 0;
  if (solid && eb[fb[(shift + 2) % 3]] != ea[fa[1]])
    return fail_pair(context, mesh, a, b, "lie on the same side of it: they overlap");
  if (mesh->order == 2) {
    const int *ma = bw_tet_face_mid_edge[a->part], *mb = bw_tet_face_mid_edge[b->part];
    for (int k = 0; k < 3; k++) /* edge k of a runs backwards through edge shift - 1 - k of b */
      if (ea[ma[k]] != eb[mb[(shift + 5 - k) % 3]])
        return fail_pair(context, mesh, a, b, "have different mid-edge nodes on its edges");
  }
  mesh->neighbour[4 * (size_t)a->item + (size_t)a->part] = b->item;
  mesh->neighbour[4 * (size_t)b->item + (size_t)b->part] = a->item;
  return BW_OK;
}

/* Faces are put into buckets by their lowest corner and sorted there by the other two: equal ones
 * come to stand side by side, in linear time but for buckets of thousands. */
static bw_status find_neighbours(bw_context *context, bw_mesh *mesh) {
  bw_status status = BW_OK;
  size_t faces = 4 * (size_t)mesh->element_count;
  int32_t corner[3];
  bwi_keyed *list = BW_NEW(context, bwi_keyed, faces);
  int64_t *start = BW_NEW0(context, int64_t, (size_t)mesh->node_count + 2);
  mesh->neighbour = BW_NEW(context, int32_t, faces);
  BW_TRY_MEMORY(list && start && mesh->neighbour);
  for (size_t i = 0; i < faces; i++)
    mesh->neighbour[i] = -1;
  for (int32_t e = 0; e < mesh->element_count; e++)
    for (int k = 0; k < 4; k++) {
      face_corners(mesh, e, k, corner);
      start[corner[0] + 2]++;
    }
  for (int32_t i = 0; i <= mesh->node_count; i++)
    start[i + 1] += start[i];
  for (int32_t e = 0; e < mesh->element_count; e++)
    for (int k = 0; k < 4; k++) {
      face_corners(mesh, e, k, corner);
      bwi_keyed *face = &list[start[corner[0] + 1]++];
      face->key = (uint64_t)corner[1] << 32 | (uint64_t)corner[2];
      face->item = e;
      face->part = k;
    }
  BW_TRY(bw_check_cancel(context));
  for (int32_t i = 0; i < mesh->node_count; i++) {
    bwi_keyed *bucket = list + start[i];
    int64_t count = start[i + 1] - start[i];
    bwi_sort_keyed(bucket, count);
    for (int64_t j = 0; j + 1 < count; j++) {
      if (bucket[j].key != bucket[j + 1].key)
        continue;
      if (j + 2 < count && bucket[j].key == bucket[j + 2].key) {
        BW_TRY(fail_pair(context, mesh, &bucket[j], &bucket[j + 1],
                         "a third one has it too: a face belongs to one or two elements"));
      }
      BW_TRY(join_faces(context, mesh, &bucket[j], &bucket[j + 1]));
      j++;
    }
  }
done:
  bw_free(list);
  bw_free(start);
  return status;
}

static bw_status find_boundary(bw_context *context, bw_mesh *mesh) {
  size_t width = (size_t)mesh->nodes_per_element, facet_width = (size_t)mesh->nodes_per_facet;
  size_t faces = 4 * (size_t)mesh->element_count, facets = 0;
  for (size_t i = 0; i < faces; i++)
    facets += mesh->neighbour[i] < 0;
  if (facets > INT32_MAX / 3) /* corners of facets have numbers */
    return bw_fail(context, BW_LIMIT, "%zu boundary facets: a mesh holds at most %d", facets,
                   INT32_MAX / 3);
  mesh->facet_count = (int32_t)facets;
  mesh->facet = BW_NEW(context, int32_t, facets * facet_width);
  mesh->facet_element = BW_NEW(context, int32_t, facets);
  uint8_t *outside = BW_NEW0(context, uint8_t, mesh->node_count);
  if (!mesh->facet || !mesh->facet_element || !outside) {
    bw_free(outside);
    return BW_MEMORY;
  }
  size_t at = 0;
  for (size_t i = 0; i < faces; i++) {
    if (mesh->neighbour[i] >= 0)
      continue;
    const int32_t *e = mesh->element + i / 4 * width;
    int32_t *facet = mesh->facet + at * facet_width;
    for (int k = 0; k < 3; k++) {
      facet[k] = e[bw_tet_face[i % 4][k]];
      if (mesh->order == 2)
        facet[3 + k] = e[bw_tet_face_mid_edge[i % 4][k]];
    }
    for (size_t k = 0; k < facet_width; k++)
      outside[facet[k]] = 1;
    mesh->facet_element[at++] = (int32_t)(i / 4);
  }
  int32_t count = 0;
  for (int32_t i = 0; i < mesh->node_count; i++)
    count += outside[i];
  mesh->boundary_node_count = count;
  mesh->boundary_node = BW_NEW(context, int32_t, count);
  if (mesh->boundary_node)
    for (int32_t i = 0, j = 0; i < mesh->node_count; i++)
      if (outside[i])
        mesh->boundary_node[j++] = i;
  bw_free(outside);
  return mesh->boundary_node ? BW_OK : BW_MEMORY;
}

static bw_status find_components(bw_context *context, bw_mesh *mesh) {
  int32_t *parent = mesh->component = BW_NEW(context, int32_t, mesh->node_count);
  if (!parent)
    return BW_MEMORY;
  for (int32_t i = 0; i < mesh->node_count; i++)
    parent[i] = i;
  for (int32_t i = 0; i < mesh->element_count; i++) {
    const int32_t *e = mesh->element + (size_t)i * (size_t)mesh->nodes_per_element;
    for (int k = 1; k < mesh->nodes_per_element; k++)
      bwi_set_join(parent, e[0], e[k]);
  }
  /* A root is the lowest node of its component, so it is numbered before the others need it. */
  int32_t count = 0;
  for (int32_t i = 0; i < mesh->node_count; i++)
    mesh->component[i] = parent[i] == i ? count++ : mesh->component[parent[i]];
  mesh->component_count = count;
  return BW_OK;
}

/* ---- constructors --------------------------------------------------------------------------- */

#ifndef NDEBUG
/* Neighbours know each other, and belong to the same body as all of their nodes. */
static bool is_connected(const bw_mesh *mesh) {
  for (int32_t e = 0; e < mesh->element_count; e++) {
    const int32_t *node = mesh->element + (size_t)e * (size_t)mesh->nodes_per_element;
    for (int a = 1; a < mesh->nodes_per_element; a++)
      if (mesh->component[node[a]] != mesh->component[node[0]])
        return false;
    for (int k = 0; k < 4; k++) {
      int32_t other = mesh->neighbour[4 * (size_t)e + (size_t)k], back = other < 0 ? 0 : 4;
      if (other < -1 || other >= mesh->element_count || other == e)
        return false;
      while (back > 0 && mesh->neighbour[4 * (size_t)other + (size_t)back - 1] != e)
        if (--back == 0)
          return false;
    }
  }
  return true;
}
#endif

bw_status bwi_mesh_adopt(bw_context *context, int order, int64_t nodes, double *node,
                         int64_t elements, int32_t *element, const bw_mesh_regions *regions,
                         bool flat, bw_mesh **out) {
  bw_status status = check_sizes(context, order, nodes, node, elements, element);
  if (status != BW_OK)
    return status;
  bw_mesh *mesh = bwi_mesh_create(context);
  if (!mesh)
    return BW_MEMORY;
  mesh->order = order;
  mesh->nodes_per_element = order == 2 ? 10 : 4;
  mesh->nodes_per_facet = order == 2 ? 6 : 3;
  mesh->node_count = (int32_t)nodes;
  mesh->element_count = (int32_t)elements;
  mesh->node = node;
  mesh->element = element;
  BW_TRY(check_numbers(context, mesh->nodes_per_element, nodes, node, elements, element));
  mesh->volume = BW_NEW(context, double, elements);
  BW_TRY_MEMORY(mesh->volume);
  BW_TRY(find_volumes(context, mesh, flat));
  BW_TRY(drop_unused_nodes(context, mesh));
  BW_TRY(find_neighbours(context, mesh));
  BW_TRY(find_boundary(context, mesh));
  BW_TRY(find_components(context, mesh));
  BW_TRY(bwi_mesh_set_regions(context, mesh, regions));
  assert(is_connected(mesh));
  *out = mesh;
done:
  if (status != BW_OK) {
    mesh->node = NULL; /* the arrays stay the caller's */
    mesh->element = NULL;
    bw_release(mesh);
  }
  return status;
}

bw_status bw_mesh_adopt(bw_context *context, int order, int64_t nodes, double *node,
                        int64_t elements, int32_t *element, const bw_mesh_regions *regions,
                        bw_mesh **mesh) {
  return bwi_mesh_adopt(context, order, nodes, node, elements, element, regions, false, mesh);
}

bw_status bw_mesh_copy(bw_context *context, int order, int64_t nodes, const double *node,
                       int64_t elements, const int32_t *element, const bw_mesh_regions *regions,
                       bw_mesh **mesh) {
  bw_status status = check_sizes(context, order, nodes, node, elements, element);
  if (status != BW_OK)
    return status;
  size_t width = order == 2 ? 10 : 4;
  double *own_node = BW_NEW(context, double, 3 * (size_t)nodes);
  int32_t *own_element = BW_NEW(context, int32_t, width * (size_t)elements);
  BW_TRY_MEMORY(own_node && own_element);
  if (nodes > 0)
    memcpy(own_node, node, 3 * (size_t)nodes * sizeof *node);
  memcpy(own_element, element, width * (size_t)elements * sizeof *element);
  BW_TRY(bw_mesh_adopt(context, order, nodes, own_node, elements, own_element, regions, mesh));
done:
  if (status != BW_OK) {
    bw_free(own_node);
    bw_free(own_element);
  }
  return status;
}

void bw_mesh_box(const bw_mesh *mesh, double min[3], double max[3]) {
  for (int k = 0; k < 3; k++)
    min[k] = max[k] = mesh->node_count ? mesh->node[k] : 0;
  for (int32_t i = 1; i < mesh->node_count; i++)
    for (int k = 0; k < 3; k++) {
      double x = mesh->node[3 * (size_t)i + (size_t)k];
      if (x < min[k])
        min[k] = x;
      if (x > max[k])
        max[k] = x;
    }
}

double bw_mesh_volume(const bw_mesh *mesh) {
  double sum = 0;
  for (int32_t i = 0; i < mesh->element_count; i++)
    sum += mesh->volume[i];
  return sum;
}
