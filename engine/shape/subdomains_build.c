/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* bw_subdomains as an object: numbering, neighbours, interfaces, from labels that fulfil the
 * invariants. */
#include "shape/subdomains_internal.h"

#include <stdlib.h>
#include <string.h>

static void subdomains_destroy(void *object) {
  bw_subdomains *d = object;
  bw_release(d->mesh);
  bw_release(d->skeleton);
  bw_free(d->element_subdomain);
  bw_free(d->elements);
  bw_free(d->bone_of);
  bw_free(d->bone_start);
  bw_free(d->bone);
  bw_free(d->adjacent_start);
  bw_free(d->adjacent);
  bw_free(d->node_subdomain);
  bw_free(d->interface);
  bw_free(d->influence_start);
  bw_free(d->influence_bone);
  bw_free(d->influence_weight);
  bwi_stiffness_subdomains_clear(d);
  bw_free(d);
}

static size_t subdomains_bytes(const void *object) {
  const bw_subdomains *d = object;
  size_t n = (size_t)d->mesh->node_count, count = (size_t)d->count;
  size_t influences = (size_t)d->influence_start[n], parts = (size_t)d->stiffness.count;
  return sizeof *d + (size_t)d->mesh->element_count * 8 + count * 8 + (count + 1) * 8 +
         (size_t)d->bone_start[count] * 4 + (size_t)d->adjacent_start[count] * 4 + n * 9 +
         (n + 1) * 8 + influences * 12 + (2 * parts + 1) * 4 +
         (size_t)d->stiffness.bone_start[parts] * 4;
}

static const bw_kind subdomains_kind = {"subdomains", subdomains_destroy, subdomains_bytes};

/* ---- groups ---------------------------------------------------------------------------------- */

bw_status bwi_flexible_groups(bw_context *context, const bw_mesh *mesh, const int32_t *bone,
                              int32_t *group) {
  enum { rigid = -2, unseen = -1 };
  int32_t *at_node = BW_NEW(context, int32_t, mesh->node_count); /* an element there */
  if (!at_node)
    return BW_MEMORY;
  for (int32_t i = 0; i < mesh->node_count; i++)
    at_node[i] = unseen;
  for (int32_t e = 0; e < mesh->element_count; e++) {
    group[e] = e;
    if (bone[e] >= 0)
      for (int k = 0; k < mesh->nodes_per_element; k++)
        at_node[bwi_nodes_of(mesh, e)[k]] = rigid;
  }
  for (int32_t e = 0; e < mesh->element_count; e++) {
    if (bone[e] >= 0)
      continue;
    for (int k = 0; k < 4; k++) {
      int32_t other = mesh->neighbour[4 * (size_t)e + (size_t)k];
      if (other >= 0 && bone[other] < 0)
        bwi_set_join(group, e, other);
    }
    for (int k = 0; k < mesh->nodes_per_element; k++) {
      int32_t *seen = at_node + bwi_nodes_of(mesh, e)[k];
      if (*seen == unseen)
        *seen = e;
      else if (*seen >= 0)
        bwi_set_join(group, e, *seen);
    }
  }
  for (int32_t e = 0; e < mesh->element_count; e++)
    group[e] = bone[e] >= 0 ? -1 : bwi_set_root(group, e);
  bw_free(at_node);
  return BW_OK;
}

/* ---- nodes and neighbours -------------------------------------------------------------------- */

static bool is_rigid(const bw_subdomains *d, int32_t subdomain) {
  return d->bone_of[subdomain] >= 0;
}

/* node_subdomain and interface. */
static void place_nodes(bw_subdomains *d) {
  const bw_mesh *mesh = d->mesh;
  for (int32_t i = 0; i < mesh->node_count; i++)
    d->node_subdomain[i] = -1;
  for (int32_t e = 0; e < mesh->element_count; e++) {
    int32_t here = d->element_subdomain[e];
    for (int k = 0; k < mesh->nodes_per_element; k++) {
      int32_t i = bwi_nodes_of(mesh, e)[k], there = d->node_subdomain[i];
      if (there >= 0 && there != here)
        d->interface[i] = 1;
      if (there < 0 || (is_rigid(d, here) && !is_rigid(d, there)))
        d->node_subdomain[i] = here;
    }
  }
}

static int compare_keys(const void *a, const void *b) {
  int64_t x = *(const int64_t *)a, y = *(const int64_t *)b;
  return (x > y) - (x < y);
}

static size_t sort_unique(int64_t *key, size_t count) {
  if (count == 0)
    return 0;
  qsort(key, count, sizeof *key, compare_keys);
  size_t kept = 1;
  for (size_t i = 1; i < count; i++)
    if (key[i] != key[kept - 1])
      key[kept++] = key[i];
  return kept;
}

/* Pairs of subdomains that share a node, from the subdomains at every interface node. */
static bw_status find_neighbours(bw_context *context, bw_subdomains *d) {
  const bw_mesh *mesh = d->mesh;
  bw_status status = BW_OK;
  int64_t *at = NULL, *pair = NULL; /* node * count + subdomain; subdomain * count + subdomain */
  size_t at_count = 0, at_capacity = 0, pair_count = 0, pair_capacity = 0;
  for (int32_t e = 0; e < mesh->element_count; e++)
    for (int k = 0; k < mesh->nodes_per_element; k++) {
      int32_t i = bwi_nodes_of(mesh, e)[k];
      if (!d->interface[i])
        continue;
      BW_TRY_MEMORY(bw_grow(context, (void **)&at, &at_capacity, at_count, 1, sizeof *at));
      at[at_count++] = (int64_t)i * d->count + d->element_subdomain[e];
    }
  at_count = sort_unique(at, at_count);
  for (size_t first = 0, end; first < at_count; first = end) {
    int64_t node = at[first] / d->count;
    for (end = first; end < at_count && at[end] / d->count == node; end++)
      ;
    for (size_t a = first; a < end; a++)
      for (size_t b = first; b < end; b++) {
        if (a == b)
          continue;
        BW_TRY_MEMORY(
            bw_grow(context, (void **)&pair, &pair_capacity, pair_count, 1, sizeof *pair));
        pair[pair_count++] = at[a] % d->count * d->count + at[b] % d->count;
      }
  }
  pair_count = sort_unique(pair, pair_count);
  d->adjacent = BW_NEW(context, int32_t, pair_count);
  BW_TRY_MEMORY(d->adjacent);
  for (size_t i = 0; i < pair_count; i++) {
    d->adjacent[i] = (int32_t)(pair[i] % d->count);
    d->adjacent_start[pair[i] / d->count + 1]++;
  }
  for (int32_t i = 0; i < d->count; i++)
    d->adjacent_start[i + 1] += d->adjacent_start[i];
done:
  bw_free(at);
  bw_free(pair);
  return status;
}

/* ---- making ---------------------------------------------------------------------------------- */

bw_status bwi_subdomains_make(bw_context *context, const bw_mesh *mesh, const bw_skeleton *skeleton,
                              int32_t count, const int32_t *bone_of,
                              const int32_t *element_subdomain, const bwi_guide *guide,
                              bw_subdomains **subdomains) {
  bw_status status = BW_OK;
  bw_subdomains *d = BW_NEW0(context, bw_subdomains, 1);
  if (!d)
    return BW_MEMORY;
  bw_object_init(d, &subdomains_kind);
  d->mesh = bw_retain(mesh);
  d->skeleton = bw_retain(skeleton);
  d->count = count;
  d->element_subdomain = BW_NEW(context, int32_t, mesh->element_count);
  d->elements = BW_NEW0(context, int32_t, count);
  d->bone_of = BW_NEW(context, int32_t, count);
  d->adjacent_start = BW_NEW0(context, int32_t, count + 1);
  d->node_subdomain = BW_NEW(context, int32_t, mesh->node_count);
  d->interface = BW_NEW0(context, uint8_t, mesh->node_count);
  BW_TRY_MEMORY(d->element_subdomain && d->elements && d->bone_of && d->adjacent_start &&
                d->node_subdomain && d->interface);
  memcpy(d->element_subdomain, element_subdomain, (size_t)mesh->element_count * sizeof(int32_t));
  memcpy(d->bone_of, bone_of, (size_t)count * sizeof(int32_t));
  for (int32_t i = 0; i < count; i++)
    d->rigid_count += is_rigid(d, i);
  for (int32_t e = 0; e < mesh->element_count; e++)
    d->elements[element_subdomain[e]]++;
  place_nodes(d);
  BW_TRY(find_neighbours(context, d));
  BW_TRY(bwi_subdomains_blend(context, d, guide));
  BW_TRY(bwi_stiffness_subdomains_create(context, d));
  *subdomains = d;
  d = NULL;
done:
  bw_release(d);
  return status;
}

bw_status bwi_subdomains_from_bones(bw_context *context, const bw_mesh *mesh,
                                    const bw_skeleton *skeleton, const int32_t *bone,
                                    const bwi_guide *guide, bw_subdomains **subdomains) {
  bw_status status = BW_OK;
  int32_t *label = BW_NEW(context, int32_t, mesh->element_count);
  int32_t *number = BW_NEW(context, int32_t, skeleton->bone_count);
  int32_t *bone_of = BW_NEW(context, int32_t, (int64_t)mesh->element_count + 1);
  BW_TRY_MEMORY(label && number && bone_of);
  BW_TRY(bwi_flexible_groups(context, mesh, bone, label));
  for (int32_t b = 0; b < skeleton->bone_count; b++)
    number[b] = -1;
  for (int32_t e = 0; e < mesh->element_count; e++)
    if (bone[e] >= 0)
      number[bone[e]] = 0;
  int32_t count = 0;
  for (int32_t b = 0; b < skeleton->bone_count; b++)
    if (number[b] >= 0) {
      bone_of[count] = b;
      number[b] = count++;
    }
  /* a group is named by its first element, which comes before the others */
  for (int32_t e = 0; e < mesh->element_count; e++) {
    if (bone[e] >= 0) {
      label[e] = number[bone[e]];
    } else if (label[e] == e) {
      bone_of[count] = -1;
      label[e] = count++;
    } else {
      label[e] = label[label[e]];
    }
  }
  BW_TRY(bwi_subdomains_make(context, mesh, skeleton, count, bone_of, label, guide, subdomains));
done:
  bw_free(label);
  bw_free(number);
  bw_free(bone_of);
  return status;
}
