/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* The mesh of a whole wheel from that of a sector, its material, and fields on it. */
#include <string.h>

#include "joint/cyclic.h"

static bool on_axis(const bwi_wheel *w, int32_t node) {
  return w->cyclic->partner[node] == node;
}

static bool on_high(const bwi_wheel *w, int32_t node) {
  return w->cyclic->partner[node] >= 0 && !on_axis(w, node);
}

int64_t bwi_wheel_node(const bwi_wheel *w, int sector, int32_t node) {
  if (on_axis(w, node))
    return (int64_t)w->cyclic->count * w->own_count + w->place[node];
  if (on_high(w, node))
    return bwi_wheel_node(w, sector + 1, w->cyclic->partner[node]);
  return (int64_t)(sector % w->cyclic->count) * w->own_count + w->place[node];
}

static bw_status make_mesh(bw_context *context, bwi_wheel *w) {
  bw_status status = BW_OK;
  const bw_mesh *from = w->sector;
  int count = w->cyclic->count;
  int64_t nodes = (int64_t)count * w->own_count + w->cyclic->axis_count;
  int64_t elements = (int64_t)count * from->element_count, corners = from->nodes_per_element;
  double *node = NULL;
  int32_t *element = NULL, *region = NULL;
  if (nodes > INT32_MAX || elements > INT32_MAX)
    BW_TRY(bw_fail(context, BW_LIMIT, "the whole of %d sectors has %lld nodes: too many", count,
                   (long long)nodes));
  node = BW_NEW(context, double, 3 * nodes);
  element = BW_NEW(context, int32_t, corners * elements);
  region = BW_NEW(context, int32_t, elements);
  BW_TRY_MEMORY(node && element && region);
  for (int s = 0; s < count; s++) {
    double rotation[9];
    bwi_cyclic_rotation(w->cyclic, s, rotation);
    for (int32_t i = 0; i < from->node_count; i++)
      if (!on_high(w, i))
        bwi_cyclic_place(w->cyclic, rotation, from->node + 3 * (int64_t)i,
                         node + 3 * bwi_wheel_node(w, s, i));
    for (int64_t e = 0; e < from->element_count; e++) {
      int64_t to = s * (int64_t)from->element_count + e;
      region[to] = from->region ? from->region[e] : 0;
      for (int64_t k = 0; k < corners; k++)
        element[to * corners + k] = (int32_t)bwi_wheel_node(w, s, from->element[e * corners + k]);
    }
  }
  const bw_mesh_regions regions = {from->region_count, from->regions, region};
  BW_TRY(bw_mesh_adopt(context, from->order, nodes, node, elements, element,
                       from->region_count > 0 ? &regions : NULL, &w->mesh));
  node = NULL;
  element = NULL;
done:
  bw_free(node);
  bw_free(element);
  bw_free(region);
  return status;
}

/* Axes of materials turn with their sector. */
static bw_status make_material(bw_context *context, const bw_material *material, bwi_wheel *w) {
  bw_status status = BW_OK;
  int count = w->cyclic->count;
  int32_t elements = w->mesh->element_count, own = w->sector->element_count;
  bw_material *carried = NULL;
  int32_t *from = BW_NEW(context, int32_t, elements), *group = BW_NEW(context, int32_t, elements);
  double *rotation = BW_NEW(context, double, 9 * (int64_t)count);
  BW_TRY_MEMORY(from && group && rotation);
  for (int32_t e = 0; e < elements; e++) {
    from[e] = e % own;
    group[e] = e / own;
  }
  for (int s = 0; s < count; s++)
    bwi_cyclic_rotation(w->cyclic, s, rotation + 9 * (int64_t)s);
  BW_TRY(bw_material_carried(context, material, elements, from, &carried));
  BW_TRY(bw_material_rotated_by_element(context, carried, elements, count, group, rotation,
                                        &w->material));
done:
  bw_release(carried);
  bw_free(from);
  bw_free(group);
  bw_free(rotation);
  return status;
}

bw_status bwi_wheel_open(bw_context *context, const bw_cyclic *cyclic, const bw_material *material,
                         bwi_wheel *w) {
  bw_status status = BW_OK;
  *w = (bwi_wheel){.cyclic = cyclic, .sector = cyclic ? cyclic->low->mesh : NULL};
  int32_t axis = 0;
  if (!cyclic)
    return bw_fail(context, BW_INVALID, "there is no cyclic symmetry: this is the whole already");
  w->place = BW_NEW(context, int32_t, w->sector->node_count);
  BW_TRY_MEMORY(w->place);
  for (int32_t i = 0; i < w->sector->node_count; i++)
    if (!on_high(w, i))
      w->place[i] = on_axis(w, i) ? axis++ : w->own_count++;
  BW_TRY(make_mesh(context, w));
  BW_TRY(make_material(context, material, w));
done:
  return status;
}

void bwi_wheel_close(bwi_wheel *w) {
  bw_free(w->place);
  bw_release(w->mesh);
  bw_release(w->material);
}

void bwi_wheel_expand(const bwi_wheel *w, int diameter, const double *u, const double *v,
                      double factor, double *out) {
  for (int s = 0; s < w->cyclic->count; s++) {
    double rotation[9], cosine, sine;
    bwi_cyclic_rotation(w->cyclic, s, rotation);
    bwi_cyclic_phase(w->cyclic, (int64_t)s * diameter, &cosine, &sine);
    for (int32_t i = 0; i < w->sector->node_count; i++) {
      double sum[3];
      if (on_high(w, i))
        continue;
      for (int k = 0; k < 3; k++)
        sum[k] = factor * (cosine * u[3 * (int64_t)i + k] - (v ? sine * v[3 * (int64_t)i + k] : 0));
      bwi_rotate(rotation, sum, out + 3 * bwi_wheel_node(w, s, i));
    }
  }
}

void bwi_wheel_add_forces(const bwi_wheel *w, const double *force, double *out) {
  memset(out, 0, 3 * (size_t)w->mesh->node_count * sizeof *out);
  for (int s = 0; s < w->cyclic->count; s++) {
    double rotation[9], f[3];
    bwi_cyclic_rotation(w->cyclic, s, rotation);
    for (int32_t i = 0; i < w->sector->node_count; i++) {
      bwi_rotate(rotation, force + 3 * (int64_t)i, f);
      for (int k = 0; k < 3; k++)
        out[3 * bwi_wheel_node(w, s, i) + k] += f[k];
    }
  }
}

void bwi_wheel_spread(const bwi_wheel *w, const double *sector, double *whole) {
  for (int s = 0; s < w->cyclic->count; s++)
    for (int32_t i = 0; i < w->sector->node_count; i++)
      if (!on_high(w, i))
        whole[bwi_wheel_node(w, s, i)] = sector[i];
}
