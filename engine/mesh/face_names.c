/* Names of faces: groups of facets, on surfaces and on the boundaries of meshes.
 *
 * Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later.
 *
 * A surface has a group for each facet, and names for groups. What is made from it by parts of its
 * facets has the same groups and shares the names. On a mesh each boundary facet has the group of
 * the facet that it lies on. */
#include <string.h>

#include "mesh/mesh_internal.h"
#include "mesh/surface_internal.h"

static void names_destroy(void *object) {
  bw_face_names *names = object;
  bw_free(names->name);
  bw_free(names->curved);
  bw_free(names);
}

static size_t names_bytes(const void *object) {
  const bw_face_names *names = object;
  return sizeof *names + (size_t)names->count * (sizeof *names->name + sizeof *names->curved);
}

static const bw_kind names_kind = {"face names", names_destroy, names_bytes};

bw_status bw_face_names_create(bw_context *context, int32_t count, const bw_name *name,
                               const uint8_t *curved, bw_face_names **names) {
  if (count < 0)
    return bw_fail(context, BW_INVALID, "%d names of faces: 0 or more expected", count);
  bw_face_names *made = BW_NEW0(context, bw_face_names, 1);
  if (!made)
    return BW_MEMORY;
  bw_object_init(made, &names_kind);
  made->name = BW_NEW0(context, bw_name, count);
  made->curved = BW_NEW0(context, uint8_t, count);
  if (!made->name || !made->curved) {
    bw_release(made);
    return BW_MEMORY;
  }
  made->count = count;
  if (count > 0)
    memcpy(made->name, name, (size_t)count * sizeof *name);
  if (count > 0 && curved)
    memcpy(made->curved, curved, (size_t)count * sizeof *curved);
  *names = made;
  return BW_OK;
}

bool bw_face_names_is(const bw_face_names *names, int32_t group, const char *name) {
  return names && group >= 0 && group < names->count && name[0] &&
         strcmp(names->name[group].text, name) == 0;
}

/* ---- surfaces ------------------------------------------------------------------------------ */

bw_status bw_surface_with_names(bw_context *context, const bw_surface *surface,
                                const int32_t *group, const bw_face_names *names,
                                bw_surface **named) {
  if (!group)
    group = surface->group;
  if (names && !group)
    return bw_fail(context, BW_INVALID,
                   "names of faces need a group for each facet, and the surface has none");
  bw_surface *made;
  bw_status status = bw_surface_copy(context, surface->point_count, surface->point,
                                     surface->triangle_count, surface->triangle, group, &made);
  if (status != BW_OK)
    return status;
  made->names = bw_retain(names);
  *named = made;
  return BW_OK;
}

/* The number of a name in a list of `count`, behind which it is put where it is not there. */
static int32_t number_of(bw_name *list, int32_t *count, const bw_name *name) {
  int32_t i = 0;
  while (i < *count && strcmp(list[i].text, name->text) != 0)
    i++;
  if (i == *count)
    list[(*count)++] = *name;
  return i;
}

/* A surface whose groups are numbers in the list of names. */
static bw_status in_list(bw_context *context, bw_surface **surface, bw_name *list, uint8_t *curved,
                         int32_t *count) {
  static const bw_name empty = {""};
  bw_surface *old = *surface, *made;
  const int32_t known = old->names ? old->names->count : 0;
  int32_t none = -1;
  bw_status status = BW_OK;
  int32_t *number = BW_NEW(context, int32_t, known);
  int32_t *group = BW_NEW(context, int32_t, old->triangle_count);
  BW_TRY_MEMORY(number && group);
  for (int32_t i = 0; i < known; i++) {
    number[i] = number_of(list, count, &old->names->name[i]);
    curved[number[i]] |= old->names->curved[i];
  }
  for (int32_t t = 0; t < old->triangle_count; t++) {
    const int32_t own = known ? old->group[t] : -1;
    const bool has = own >= 0 && own < known;
    if (!has && none < 0)
      none = number_of(list, count, &empty);
    group[t] = has ? number[own] : none;
  }
  BW_TRY(bw_surface_with_names(context, old, group, NULL, &made));
  bw_release(old);
  *surface = made;
done:
  bw_free(number);
  bw_free(group);
  return status;
}

bw_status bwi_name_alike(bw_context *context, int32_t count, bw_surface **surface,
                         bw_face_names **names) {
  bw_status status = BW_OK;
  size_t most = 1;
  int32_t used = 0;
  bool some = false;
  *names = NULL;
  for (int32_t i = 0; i < count; i++)
    if (surface[i]->names) {
      some = true;
      most += (size_t)surface[i]->names->count;
    }
  if (!some)
    return BW_OK;
  bw_name *list = BW_NEW0(context, bw_name, most);
  uint8_t *curved = BW_NEW0(context, uint8_t, most);
  BW_TRY_MEMORY(list && curved);
  for (int32_t i = 0; i < count; i++)
    BW_TRY(in_list(context, &surface[i], list, curved, &used));
  BW_TRY(bw_face_names_create(context, used, list, curved, names));
  for (int32_t i = 0; i < count; i++)
    surface[i]->names = bw_retain(*names);
done:
  bw_free(list);
  bw_free(curved);
  return status;
}

/* ---- meshes -------------------------------------------------------------------------------- */

void bwi_mesh_adopt_groups(bw_mesh *mesh, int32_t *group, bw_face_names *names) {
  /* The block belongs to whoever owns the topology. */
  const bw_mesh *shared = ((const bwi_mesh *)mesh)->topology;
  bw_mesh *owner = shared ? (bw_mesh *)(uintptr_t)shared : mesh;
  bw_free(owner->facet_group);
  owner->facet_group = mesh->facet_group = group;
  for (int i = 0; i < (shared ? 2 : 1); i++) {
    bw_mesh *one = i ? owner : mesh;
    bw_release(one->names);
    one->names = bw_retain(names);
  }
}

/* The face of an element, 0 to 3, that a facet is. */
static size_t side_of(const bw_mesh *mesh, int32_t facet) {
  const int32_t *corner = mesh->facet + (size_t)mesh->nodes_per_facet * (size_t)facet;
  const int32_t *node =
      mesh->element + (size_t)mesh->nodes_per_element * (size_t)mesh->facet_element[facet];
  size_t side = 0; /* opposite to the corner of the element that is none of the facet */
  while (node[side] == corner[0] || node[side] == corner[1] || node[side] == corner[2])
    side++;
  return side;
}

bw_status bwi_mesh_keep_names(bw_context *context, const bw_mesh *from, const int32_t *element_from,
                              bw_mesh **mesh) {
  bw_mesh *made = *mesh;
  if (!from->names || made->names)
    return BW_OK;
  bw_status status = BW_OK;
  /* The group of each side of an element there; -1 inside. */
  int32_t *side = BW_NEW(context, int32_t, 4 * (size_t)from->element_count);
  int32_t *group = BW_NEW(context, int32_t, made->facet_count);
  BW_TRY_MEMORY(side && group);
  for (size_t i = 0; i < 4 * (size_t)from->element_count; i++)
    side[i] = -1;
  for (int32_t t = 0; t < from->facet_count; t++)
    side[4 * (size_t)from->facet_element[t] + side_of(from, t)] = from->facet_group[t];
  for (int32_t t = 0; t < made->facet_count; t++) {
    const int64_t e = element_from ? element_from[made->facet_element[t]] : made->facet_element[t];
    group[t] = e < 0 || e >= from->element_count ? -1 : side[4 * (size_t)e + side_of(made, t)];
  }
  bwi_mesh_adopt_groups(made, group, from->names);
  group = NULL;
done:
  bw_free(side);
  bw_free(group);
  if (status != BW_OK) {
    bw_release(made);
    *mesh = NULL;
  }
  return status;
}
