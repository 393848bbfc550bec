/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* Nodes and elements numbered along a curve that fills space: what is near in space is then near in
 * memory, and the rows of a limb follow one another. Most of the time of assembly and of products
 * goes into memory that is far apart otherwise, as mesh generators number points in the order in
 * which they put them in.
 *
 * The curve is Hilbert's in three dimensions: a cube's eight octants in turn, each entered where
 * the one before was left. J. Skilling, Programming the Hilbert curve (2004), has the rule by which
 * the bits of the coordinates become those of the place on it. */
#include "mesh/mesh_internal.h"

#include <math.h>
#include <string.h>

enum { BITS = 20 }; /* of each coordinate */

/* The place of a point on the curve. Bit by bit from the highest, the axes are mirrored or swapped
 * so that the rest of the curve in this octant runs as it does in the first; then Gray's code. */
static uint64_t place_on_curve(const uint32_t at[3]) {
  uint32_t x[3] = {at[0], at[1], at[2]};
  for (uint32_t bit = 1u << (BITS - 1); bit > 1; bit >>= 1)
    for (int i = 0; i < 3; i++) {
      uint32_t below = bit - 1, differ = (x[0] ^ x[i]) & below;
      if (x[i] & bit)
        x[0] ^= below;
      else {
        x[0] ^= differ;
        x[i] ^= differ;
      }
    }
  x[1] ^= x[0];
  x[2] ^= x[1];
  uint32_t flip = 0;
  for (uint32_t bit = 1u << (BITS - 1); bit > 1; bit >>= 1)
    if (x[2] & bit)
      flip ^= bit - 1;
  uint64_t place = 0;
  for (int b = BITS - 1; b >= 0; b--)
    for (int i = 0; i < 3; i++)
      place = place << 1 | ((x[i] ^ flip) >> b & 1);
  return place;
}

typedef struct cube {
  double low[3], scale;
} cube;

static uint64_t place_of(const cube *c, const double x[3]) {
  uint32_t at[3];
  for (int k = 0; k < 3; k++) {
    double steps = (x[k] - c->low[k]) * c->scale;
    at[k] = steps > 0 ? (uint32_t)steps : 0;
    if (at[k] >> BITS)
      at[k] = (1u << BITS) - 1;
  }
  return place_on_curve(at);
}

/* from[new] = old, of items with keys. */
static bw_status sort_items(bw_context *context, bwi_keyed *list, int32_t count, int32_t **from) {
  bwi_sort_keyed(list, count);
  *from = BW_NEW(context, int32_t, count);
  if (!*from)
    return BW_MEMORY;
  for (int32_t i = 0; i < count; i++)
    (*from)[i] = list[i].item;
  bw_status status = bw_check_cancel(context);
  if (status != BW_OK) {
    bw_free(*from);
    *from = NULL;
  }
  return status;
}

static void key_nodes(const bw_mesh *mesh, const cube *c, bwi_keyed *list) {
  for (int32_t i = 0; i < mesh->node_count; i++)
    list[i] = (bwi_keyed){.key = place_of(c, mesh->node + 3 * (size_t)i), .item = i};
}

static void key_elements(const bw_mesh *mesh, const cube *c, bwi_keyed *list) {
  for (int32_t e = 0; e < mesh->element_count; e++) {
    const int32_t *corner = mesh->element + (size_t)e * (size_t)mesh->nodes_per_element;
    double middle[3] = {0, 0, 0};
    for (int a = 0; a < 4; a++)
      for (int k = 0; k < 3; k++)
        middle[k] += 0.25 * mesh->node[3 * (size_t)corner[a] + (size_t)k];
    list[e] = (bwi_keyed){.key = place_of(c, middle), .item = e};
  }
}

static cube cube_around(const bw_mesh *mesh) {
  cube c;
  double high[3], size = 0;
  bw_mesh_box(mesh, c.low, high);
  for (int k = 0; k < 3; k++)
    size = fmax(size, high[k] - c.low[k]);
  c.scale = size > 0 ? ldexp(1, BITS) / size : 0;
  return c;
}

bw_status bw_mesh_curve_order(bw_context *context, const bw_mesh *mesh, int32_t **element_from) {
  cube c = cube_around(mesh);
  bwi_keyed *list = BW_NEW(context, bwi_keyed, mesh->element_count);
  if (!list)
    return BW_MEMORY;
  key_elements(mesh, &c, list);
  bw_status status = sort_items(context, list, mesh->element_count, element_from);
  bw_free(list);
  return status;
}

bw_status bw_mesh_renumbered(bw_context *context, const bw_mesh *mesh, int32_t **node_from,
                             int32_t **element_from, bw_mesh **out) {
  bw_status status = BW_OK;
  size_t nodes = (size_t)mesh->node_count, elements = (size_t)mesh->element_count;
  size_t width = (size_t)mesh->nodes_per_element, max = nodes > elements ? nodes : elements;
  double *node = NULL;
  cube c = cube_around(mesh);
  bw_mesh_regions regions = bw_mesh_regions_of(mesh);
  int32_t *of_node = NULL, *of_element = NULL, *element = NULL, *region = NULL;
  int32_t *now = BW_NEW(context, int32_t, nodes); /* the new number of an old node */
  bwi_keyed *list = BW_NEW(context, bwi_keyed, max);
  BW_TRY_MEMORY(now && list);
  key_nodes(mesh, &c, list);
  BW_TRY(sort_items(context, list, mesh->node_count, &of_node));
  key_elements(mesh, &c, list);
  BW_TRY(sort_items(context, list, mesh->element_count, &of_element));
  node = BW_NEW(context, double, 3 * nodes);
  element = BW_NEW(context, int32_t, width * elements);
  region = mesh->region ? BW_NEW(context, int32_t, elements) : NULL;
  BW_TRY_MEMORY(node && element && (!mesh->region || region));
  for (size_t i = 0; i < nodes; i++) {
    now[of_node[i]] = (int32_t)i;
    memcpy(node + 3 * i, mesh->node + 3 * (size_t)of_node[i], 3 * sizeof *node);
  }
  for (size_t e = 0; e < elements; e++) {
    size_t old = (size_t)of_element[e];
    for (size_t a = 0; a < width; a++)
      element[width * e + a] = now[mesh->element[width * old + a]];
    if (region)
      region[e] = mesh->region[old];
  }
  regions.of_element = region;
  BW_TRY(bw_mesh_adopt(context, mesh->order, mesh->node_count, node, mesh->element_count, element,
                       &regions, out));
  node = NULL;
  element = NULL;
  BW_TRY(bwi_mesh_keep_names(context, mesh, of_element, out));
  if (node_from) {
    *node_from = of_node;
    of_node = NULL;
  }
  if (element_from) {
    *element_from = of_element;
    of_element = NULL;
  }
done:
  bw_free(now);
  bw_free(list);
  bw_free(of_node);
  bw_free(of_element);
  bw_free(node);
  bw_free(element);
  bw_free(region);
  return status;
}
