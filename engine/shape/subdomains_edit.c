/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* Subdomains changed by hand or made from labels, and the check of their invariants. */
#include "shape/subdomains_internal.h"

#include <math.h>
#include <string.h>

typedef struct labels {
  bw_context *context;
  const bw_mesh *mesh;
  const bw_skeleton *skeleton;
  int32_t count;
  const int32_t *bone_of, *element_subdomain;
} labels;

static const char *bone_name(const labels *l, int32_t subdomain) {
  return l->skeleton->bone_name[l->bone_of[subdomain]].text;
}

static bw_status fail_at(bw_context *context, int32_t element, int32_t other) {
  bw_detail_number(context, "element", element + 1.0);
  if (other >= 0)
    bw_detail_number(context, "other", other + 1.0);
  return BW_INVALID;
}

static bw_status check_numbers(const labels *l, bool may_be_empty) {
  bw_status status = BW_MEMORY;
  int32_t *elements = BW_NEW0(l->context, int32_t, l->count), before = -1;
  if (!elements)
    return BW_MEMORY;
  for (int32_t i = 0; i < l->count; i++) {
    int32_t b = l->bone_of[i];
    if (b < -1 || b >= l->skeleton->bone_count)
      BW_TRY(bw_fail(l->context, BW_INVALID,
                     "subdomain %d names bone %d of %d: 1 to %d expected, or none for type F",
                     i + 1, b + 1, l->skeleton->bone_count, l->skeleton->bone_count));
    if (b >= 0 && b <= before)
      BW_TRY(
          bw_fail(l->context, BW_INVALID,
                  "subdomain %d (bone \"%s\") is out of order: subdomains of type R come first, by "
                  "bone, one for each",
                  i + 1, bone_name(l, i)));
    before = b < 0 ? INT32_MAX : b;
  }
  for (int32_t e = 0; e < l->mesh->element_count; e++) {
    int32_t i = l->element_subdomain[e];
    if (i < 0 || i >= l->count) {
      bw_fail(l->context, BW_INVALID, "element %d is in subdomain %d: there are %d subdomains",
              e + 1, i + 1, l->count);
      BW_TRY(fail_at(l->context, e, -1));
    }
    elements[i]++;
  }
  for (int32_t i = 0; i < l->count && !may_be_empty; i++)
    if (elements[i] == 0)
      BW_TRY(bw_fail(l->context, BW_INVALID, "subdomain %d of %d has no element", i + 1, l->count));
  status = BW_OK;
done:
  bw_free(elements);
  return status;
}

/* Where elements of two subdomains meet, at least one must be of type R and the other of type F. */
static bw_status check_meetings(const labels *l) {
  const bw_mesh *mesh = l->mesh;
  bw_status status = BW_OK;
  int32_t *rigid =
      BW_NEW(l->context, int32_t, mesh->node_count); /* an element of that type, or -1 */
  int32_t *flexible = BW_NEW(l->context, int32_t, mesh->node_count);
  BW_TRY_MEMORY(rigid && flexible);
  for (int32_t i = 0; i < mesh->node_count; i++)
    rigid[i] = flexible[i] = -1;
  for (int32_t e = 0; e < mesh->element_count; e++)
    for (int k = 0; k < mesh->nodes_per_element; k++) {
      int32_t i = bwi_nodes_of(mesh, e)[k], here = l->element_subdomain[e];
      if (l->bone_of[here] < 0)
        continue;
      if (rigid[i] < 0)
        rigid[i] = e;
      int32_t there = l->element_subdomain[rigid[i]];
      if (here == there)
        continue;
      bw_fail(l->context, BW_INVALID,
              "bones \"%s\" and \"%s\" touch at (%g, %g, %g) m: elements that follow no bone alone "
              "(type "
              "F) must lie between",
              bone_name(l, there), bone_name(l, here), mesh->node[3 * (size_t)i],
              mesh->node[3 * (size_t)i + 1], mesh->node[3 * (size_t)i + 2]);
      BW_TRY(fail_at(l->context, rigid[i], e));
    }
  for (int32_t e = 0; e < mesh->element_count; e++)
    for (int k = 0; k < mesh->nodes_per_element; k++) {
      int32_t i = bwi_nodes_of(mesh, e)[k], here = l->element_subdomain[e];
      if (l->bone_of[here] >= 0 || rigid[i] >= 0)
        continue;
      if (flexible[i] < 0)
        flexible[i] = e;
      if (here == l->element_subdomain[flexible[i]])
        continue;
      bw_fail(l->context, BW_INVALID,
              "elements %d and %d, of the subdomains %d and %d of type F, share node %d, which no "
              "subdomain of type R has: they must be one subdomain",
              flexible[i] + 1, e + 1, l->element_subdomain[flexible[i]] + 1, here + 1, i + 1);
      BW_TRY(fail_at(l->context, flexible[i], e));
    }
done:
  bw_free(rigid);
  bw_free(flexible);
  return status;
}

/* Every type R subdomain is connected through faces. The element named is in its smaller part. */
static bw_status check_connected(const labels *l) {
  const bw_mesh *mesh = l->mesh;
  bw_status status = BW_OK;
  int32_t *group = BW_NEW(l->context, int32_t, mesh->element_count);
  int32_t *size = BW_NEW0(l->context, int32_t, mesh->element_count);
  int32_t *largest = BW_NEW(l->context, int32_t, l->count);
  BW_TRY_MEMORY(group && size && largest);
  for (int32_t e = 0; e < mesh->element_count; e++)
    group[e] = e;
  for (int32_t e = 0; e < mesh->element_count; e++)
    for (int k = 0; k < 4; k++) {
      int32_t other = mesh->neighbour[4 * (size_t)e + (size_t)k];
      if (other > e && l->element_subdomain[other] == l->element_subdomain[e])
        bwi_set_join(group, e, other);
    }
  for (int32_t i = 0; i < l->count; i++)
    largest[i] = -1;
  for (int32_t e = 0; e < mesh->element_count; e++)
    size[bwi_set_root(group, e)]++;
  for (int32_t e = 0; e < mesh->element_count; e++) {
    int32_t *first = largest + l->element_subdomain[e];
    if (size[e] > 0 && (*first < 0 || size[e] > size[*first]))
      *first = e;
  }
  for (int32_t e = 0; e < mesh->element_count; e++) {
    int32_t i = l->element_subdomain[e], part = bwi_set_root(group, e);
    if (l->bone_of[i] < 0 || part == largest[i])
      continue;
    bw_fail(
        l->context, BW_INVALID,
        "the subdomain of bone \"%s\" is not connected: no path through faces leads from element "
        "%d, in a part of %d elements, to the part of %d",
        bone_name(l, i), e + 1, size[part], size[largest[i]]);
    BW_TRY(fail_at(l->context, e, largest[i]));
  }
done:
  bw_free(group);
  bw_free(size);
  bw_free(largest);
  return status;
}

static bw_status check_labels(const labels *l, bool may_be_empty) {
  bw_status status = check_numbers(l, may_be_empty);
  if (status == BW_OK)
    status = check_connected(l);
  if (status == BW_OK)
    status = check_meetings(l);
  return status;
}

/* ---- changes --------------------------------------------------------------------------------- */

bw_status bw_subdomains_assign(bw_context *context, const bw_subdomains *subdomains, int64_t count,
                               const int32_t *element, int32_t bone, bw_subdomains **changed) {
  const bw_mesh *mesh = subdomains->mesh;
  const bw_skeleton *skeleton = subdomains->skeleton;
  int32_t bones = skeleton->bone_count;
  if (bone < -1 || bone >= bones)
    return bw_fail(context, BW_INVALID,
                   "bone %d of %d: 1 to %d expected, or none to remove elements", bone + 1, bones,
                   bones);
  for (int64_t i = 0; i < count; i++)
    if (element[i] < 0 || element[i] >= mesh->element_count) {
      bw_fail(context, BW_INVALID, "element %d does not exist: the mesh has %d", element[i] + 1,
              mesh->element_count);
      return fail_at(context, element[i], -1);
    }
  bw_status status = BW_OK;
  int32_t *follows = BW_NEW(context, int32_t, mesh->element_count);
  int32_t *label = BW_NEW(context, int32_t, mesh->element_count);
  int32_t *bone_of = BW_NEW(context, int32_t, (int64_t)bones + 1);
  BW_TRY_MEMORY(follows && label && bone_of);
  for (int32_t e = 0; e < mesh->element_count; e++)
    follows[e] = subdomains->bone_of[subdomains->element_subdomain[e]];
  for (int64_t i = 0; i < count; i++)
    follows[element[i]] = bone;
  /* for the check each bone is a label, and all of type F one more */
  for (int32_t e = 0; e < mesh->element_count; e++)
    label[e] = follows[e] < 0 ? bones : follows[e];
  for (int32_t b = 0; b <= bones; b++)
    bone_of[b] = b < bones ? b : -1;
  labels l = {context, mesh, skeleton, bones + 1, bone_of, label};
  BW_TRY(check_labels(&l, true));
  bwi_guide guide = {NULL, subdomains};
  BW_TRY(bwi_subdomains_from_bones(context, mesh, skeleton, follows, &guide, changed));
done:
  bw_free(follows);
  bw_free(label);
  bw_free(bone_of);
  return status;
}

bw_status bw_subdomains_from_labels(bw_context *context, const bw_mesh *mesh,
                                    const bw_skeleton *skeleton, int32_t count,
                                    const int32_t *bone_of, const int32_t *element_subdomain,
                                    bw_subdomains **subdomains) {
  if (count < 1)
    return bw_fail(context, BW_INVALID, "%d subdomains: at least one expected", count);
  labels l = {context, mesh, skeleton, count, bone_of, element_subdomain};
  bw_status status = check_labels(&l, false);
  if (status != BW_OK)
    return status;
  bwi_guide guide = {NULL, NULL};
  return bwi_subdomains_make(context, mesh, skeleton, count, bone_of, element_subdomain, &guide,
                             subdomains);
}

/* ---- the check ------------------------------------------------------------------------------- */

static bw_status check_influences(bw_context *context, const bw_subdomains *d) {
  const bw_mesh *mesh = d->mesh;
  for (int32_t e = 0; e < mesh->element_count; e++)
    for (int k = 0; k < mesh->nodes_per_element; k++) {
      int32_t i = bwi_nodes_of(mesh, e)[k], subdomain = d->element_subdomain[e];
      int64_t first = d->influence_start[i], end = d->influence_start[i + 1];
      if (k >= 4) {
        if (first != end)
          return bw_fail(context, BW_INTERNAL, "mid-edge node %d has weights of its own", i + 1);
        continue;
      }
      double sum = 0;
      bool sound = true;
      for (int64_t j = first; j < end; j++) {
        bool known = false;
        for (int32_t b = d->bone_start[subdomain]; b < d->bone_start[subdomain + 1]; b++)
          known |= d->bone[b] == d->influence_bone[j];
        sound &= known && d->influence_weight[j] > 0;
        sound &= j == first || d->influence_bone[j] > d->influence_bone[j - 1];
        sum += d->influence_weight[j];
      }
      sound &= fabs(sum - 1) <= 1e-14;
      if (d->bone_of[subdomain] >= 0)
        sound &= end - first == 1 && d->influence_bone[first] == d->bone_of[subdomain];
      if (!sound)
        return bw_fail(
            context, BW_INTERNAL,
            "the bones of node %d in subdomain %d are not those of the subdomain, or its %d "
            "weights (sum %.17g) are not positive and one together",
            i + 1, subdomain + 1, (int)(end - first), sum);
    }
  return BW_OK;
}

bw_status bw_subdomains_check(bw_context *context, const bw_subdomains *subdomains) {
  const bw_subdomains *d = subdomains;
  labels l = {context, d->mesh, d->skeleton, d->count, d->bone_of, d->element_subdomain};
  bw_status status = check_labels(&l, false);
  if (status != BW_OK)
    return status;
  for (int32_t e = 0; e < d->mesh->element_count; e++)
    for (int k = 0; k < d->mesh->nodes_per_element; k++) {
      int32_t i = bwi_nodes_of(d->mesh, e)[k], here = d->element_subdomain[e],
              there = d->node_subdomain[i];
      bool rigid = d->bone_of[here] >= 0;
      if ((rigid && there != here) || (!rigid && d->bone_of[there] < 0 && there != here) ||
          (there != here && !d->interface[i]))
        return bw_fail(context, BW_INTERNAL, "node %d of subdomain %d goes with subdomain %d",
                       i + 1, here + 1, there + 1);
    }
  status = check_influences(context, d);
  return status == BW_OK ? bwi_stiffness_subdomains_check(context, d) : status;
}
