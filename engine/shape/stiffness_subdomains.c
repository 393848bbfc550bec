/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* Subdomains cut into stiffness subdomains, called parts here: elements of one region of the mesh
 * joined through faces, those of type F where their corners follow the same set of bones.
 *
 * Invariants: a part lies in one subdomain and in one region, so that it is of one material, and is
 * connected through faces (what is joined by edges or corners only is in parts of its own); its
 * bones are those that its corners follow; parts are numbered by subdomain. Parts of type F
 * too small to be worth their own bookkeeping are joined to a neighbour, so that then a part's
 * bones are those of any of its corners and not of all. */
#include "shape/subdomains_internal.h"

#include <string.h>

/* Parts of fewer elements are joined to a neighbour. */
enum { fewest = 40 };

/* Elements in the place of parts while those grow: named by their first element. */
typedef struct partition {
  bw_subdomains *subdomains;
  size_t words;   /* of a set of bones */
  uint64_t *set;  /* element_count x words: that of the part, at its first element */
  int32_t *group; /* element_count */
  int32_t *size;  /* element_count: elements of the part, at its first */
  int32_t *next;  /* element_count: the part's elements in a chain, -1 at its end */
  int32_t *last;  /* element_count: the end of the chain, at its first */
} partition;

/* ---- sets of bones --------------------------------------------------------------------------- */

static size_t set_words(const bw_subdomains *d) {
  return ((size_t)d->skeleton->bone_count + 63) / 64;
}

static void add_bone(uint64_t *set, int32_t bone) {
  set[bone / 64] |= (uint64_t)1 << (bone % 64);
}

static bool has_bone(const uint64_t *set, int32_t bone) {
  return set[bone / 64] >> (bone % 64) & 1;
}

/* How many bones are in a and not in b (NULL: the empty set). */
static int32_t count_beyond(const uint64_t *a, const uint64_t *b, size_t words) {
  int32_t count = 0;
  for (size_t k = 0; k < words; k++)
    for (uint64_t left = b ? a[k] & ~b[k] : a[k]; left; left &= left - 1)
      count++;
  return count;
}

/* The bones that the corners of element e follow. */
static void add_followed(const bw_subdomains *d, int32_t e, uint64_t *set) {
  for (int k = 0; k < 4; k++) {
    int32_t i = bwi_nodes_of(d->mesh, e)[k];
    for (int64_t at = d->influence_start[i]; at < d->influence_start[i + 1]; at++)
      add_bone(set, d->influence_bone[at]);
  }
}

/* ---- growing --------------------------------------------------------------------------------- */

static uint64_t *set_of(const partition *p, int32_t first) {
  return p->set + (size_t)first * p->words;
}

static bool same_set(const partition *p, int32_t a, int32_t b) {
  return memcmp(set_of(p, a), set_of(p, b), p->words * sizeof(uint64_t)) == 0;
}

static void join(partition *p, int32_t a, int32_t b) {
  a = bwi_set_root(p->group, a);
  b = bwi_set_root(p->group, b);
  if (a == b)
    return;
  bwi_set_join(p->group, a, b);
  int32_t to = a < b ? a : b, from = a < b ? b : a;
  for (size_t k = 0; k < p->words; k++)
    set_of(p, to)[k] |= set_of(p, from)[k];
  p->size[to] += p->size[from];
  p->next[p->last[to]] = from;
  p->last[to] = p->last[from];
}

/* The face neighbour of e in the same subdomain and region, or -1. */
static int32_t beside(const bw_subdomains *d, int32_t e, int k) {
  const bw_mesh *mesh = d->mesh;
  int32_t other = mesh->neighbour[4 * (size_t)e + (size_t)k];
  if (other < 0 || d->element_subdomain[other] != d->element_subdomain[e])
    return -1;
  return !mesh->region || mesh->region[other] == mesh->region[e] ? other : -1;
}

static bool is_rigid_part(const bw_subdomains *d, int32_t part) {
  return d->stiffness.parent[part] < d->rigid_count;
}

/* Join what touches through faces and follows the same bones. */
static void join_alike(partition *p) {
  const bw_subdomains *d = p->subdomains;
  for (int32_t e = 0; e < d->mesh->element_count; e++)
    for (int k = 0; k < 4; k++) {
      int32_t other = beside(d, e, k);
      if (other > e && (d->bone_of[d->element_subdomain[e]] >= 0 ||
                        same_set(p, bwi_set_root(p->group, e), bwi_set_root(p->group, other))))
        join(p, e, other);
    }
}

/* The neighbour of a part with which fewest elements come to follow bones that they did not: that
 * of the smallest superset, if there is one and it is not too large. Or -1. */
static int32_t best_neighbour(partition *p, int32_t first) {
  int32_t best = -1;
  int64_t min = 0;
  for (int32_t e = first; e >= 0; e = p->next[e])
    for (int k = 0; k < 4; k++) {
      int32_t other = beside(p->subdomains, e, k);
      if (other < 0 || (other = bwi_set_root(p->group, other)) == first)
        continue;
      const uint64_t *own = set_of(p, first), *its = set_of(p, other);
      int64_t cost = (int64_t)p->size[first] * count_beyond(its, own, p->words) +
                     (int64_t)p->size[other] * count_beyond(own, its, p->words);
      if (best < 0 || cost < min || (cost == min && other < best)) {
        best = other;
        min = cost;
      }
    }
  return best;
}

/* Smallest parts first; what they become part of is larger, and comes later if it is still
 * small. */
static void join_small(partition *p) {
  const bw_subdomains *d = p->subdomains;
  for (int32_t size = 1; size < fewest; size++)
    for (int32_t e = 0; e < d->mesh->element_count; e++) {
      if (p->group[e] != e || p->size[e] != size || d->bone_of[d->element_subdomain[e]] >= 0)
        continue;
      int32_t to = best_neighbour(p, e);
      if (to >= 0)
        join(p, e, to);
    }
}

/* ---- numbers --------------------------------------------------------------------------------- */

/* count, of_element, parent: by subdomain, then by first element. */
static bw_status number_parts(bw_context *context, partition *p) {
  bw_subdomains *d = p->subdomains;
  int32_t elements = d->mesh->element_count, *next = BW_NEW0(context, int32_t, d->count + 1);
  if (!next)
    return BW_MEMORY;
  for (int32_t e = 0; e < elements; e++)
    if (p->group[e] == e)
      next[d->element_subdomain[e] + 1]++;
  for (int32_t i = 0; i < d->count; i++)
    next[i + 1] += next[i];
  d->stiffness.count = next[d->count];
  d->stiffness.of_element = BW_NEW(context, int32_t, elements);
  d->stiffness.parent = BW_NEW(context, int32_t, d->stiffness.count);
  if (!d->stiffness.of_element || !d->stiffness.parent) {
    bw_free(next);
    return BW_MEMORY;
  }
  for (int32_t e = 0; e < elements; e++) {
    int32_t first = bwi_set_root(p->group, e);
    if (first == e) {
      d->stiffness.of_element[e] = next[d->element_subdomain[e]]++;
      d->stiffness.parent[d->stiffness.of_element[e]] = d->element_subdomain[e];
    } else {
      d->stiffness.of_element[e] = d->stiffness.of_element[first];
    }
  }
  bw_free(next);
  return BW_OK;
}

static bw_status list_bones(bw_context *context, const partition *p) {
  bw_subdomains *d = p->subdomains;
  int32_t *start = d->stiffness.bone_start = BW_NEW0(context, int32_t, d->stiffness.count + 1);
  if (!start)
    return BW_MEMORY;
  for (int32_t e = 0; e < d->mesh->element_count; e++)
    if (p->group[e] == e)
      start[d->stiffness.of_element[e] + 1] = count_beyond(set_of(p, e), NULL, p->words);
  for (int32_t i = 0; i < d->stiffness.count; i++)
    start[i + 1] += start[i];
  d->stiffness.bone = BW_NEW(context, int32_t, start[d->stiffness.count]);
  if (!d->stiffness.bone)
    return BW_MEMORY;
  for (int32_t e = 0; e < d->mesh->element_count; e++) {
    if (p->group[e] != e)
      continue;
    int32_t at = start[d->stiffness.of_element[e]];
    for (int32_t b = 0; b < d->skeleton->bone_count; b++)
      if (has_bone(set_of(p, e), b))
        d->stiffness.bone[at++] = b;
  }
  return BW_OK;
}

/* ---- frames of nodes ------------------------------------------------------------------------- */

/* of_node. When a limb turns as a whole, the parts in it keep their entries where all their nodes'
 * frames turn along: those of bones that they follow. */
static bw_status place_nodes(bw_context *context, const partition *p) {
  bw_subdomains *d = p->subdomains;
  const bw_mesh *mesh = d->mesh;
  bw_status status = BW_OK;
  int32_t bones = d->skeleton->bone_count;
  uint64_t *common = BW_NEW(context, uint64_t, (int64_t)p->words * mesh->node_count);
  int32_t *rank = BW_NEW(context, int32_t, mesh->node_count); /* of the choice: lower is better */
  d->stiffness.of_node = BW_NEW(context, int32_t, mesh->node_count);
  BW_TRY_MEMORY(common && rank && d->stiffness.of_node);
  memset(common, 0xff, p->words * (size_t)mesh->node_count * sizeof *common);
  for (int32_t e = 0; e < mesh->element_count; e++)
    for (int k = 0; k < mesh->nodes_per_element; k++)
      for (size_t w = 0; w < p->words; w++)
        common[(size_t)bwi_nodes_of(mesh, e)[k] * p->words + w] &=
            set_of(p, bwi_set_root(p->group, e))[w];
  for (int32_t i = 0; i < mesh->node_count; i++) {
    d->stiffness.of_node[i] = -1;
    rank[i] = INT32_MAX;
  }
  for (int32_t e = 0; e < mesh->element_count; e++) {
    int32_t part = d->stiffness.of_element[e], first = d->stiffness.bone_start[part];
    int32_t count = d->stiffness.bone_start[part + 1] - first;
    for (int k = 0; k < mesh->nodes_per_element; k++) {
      int32_t i = bwi_nodes_of(mesh, e)[k], own = count;
      if (is_rigid_part(d, part))
        own = 0;
      else if (!has_bone(common + (size_t)i * p->words, d->stiffness.bone[first]))
        own += bones;
      if (own < rank[i] || (own == rank[i] && part < d->stiffness.of_node[i])) {
        rank[i] = own;
        d->stiffness.of_node[i] = part;
      }
    }
  }
done:
  bw_free(common);
  bw_free(rank);
  return status;
}

/* ---- the whole ------------------------------------------------------------------------------- */

void bwi_stiffness_subdomains_clear(bw_subdomains *d) {
  bw_free(d->stiffness.of_element);
  bw_free(d->stiffness.parent);
  bw_free(d->stiffness.bone_start);
  bw_free(d->stiffness.bone);
  bw_free(d->stiffness.of_node);
  d->stiffness.of_element = d->stiffness.parent = d->stiffness.bone_start = d->stiffness.bone =
      d->stiffness.of_node = NULL;
  d->stiffness.count = 0;
}

bw_status bwi_stiffness_subdomains_create(bw_context *context, bw_subdomains *subdomains) {
  bw_status status = BW_OK;
  int32_t elements = subdomains->mesh->element_count;
  partition p = {.subdomains = subdomains, .words = set_words(subdomains)};
  bwi_stiffness_subdomains_clear(subdomains);
  p.set = BW_NEW0(context, uint64_t, (int64_t)p.words * elements);
  p.group = BW_NEW(context, int32_t, elements);
  p.size = BW_NEW(context, int32_t, elements);
  p.next = BW_NEW(context, int32_t, elements);
  p.last = BW_NEW(context, int32_t, elements);
  BW_TRY_MEMORY(p.set && p.group && p.size && p.next && p.last);
  for (int32_t e = 0; e < elements; e++) {
    p.group[e] = p.last[e] = e;
    p.size[e] = 1;
    p.next[e] = -1;
    add_followed(subdomains, e, set_of(&p, e));
  }
  join_alike(&p);
  join_small(&p);
  join_alike(&p); /* sets that grew may be alike now */
  BW_TRY(bw_check_cancel(context));
  BW_TRY(number_parts(context, &p));
  BW_TRY(list_bones(context, &p));
  BW_TRY(place_nodes(context, &p));
done:
  bw_free(p.set);
  bw_free(p.group);
  bw_free(p.size);
  bw_free(p.next);
  bw_free(p.last);
  return status;
}

/* ---- the check ------------------------------------------------------------------------------- */

static bw_status fail_part(bw_context *context, int32_t element, int32_t part, const char *what) {
  bw_fail(context, BW_INTERNAL, "element %d is in stiffness subdomain %d, %s", element + 1,
          part + 1, what);
  bw_detail_number(context, "element", element + 1.0);
  return BW_INTERNAL;
}

static bool follows(const bw_subdomains *d, int32_t part, int32_t bone) {
  for (int32_t k = d->stiffness.bone_start[part]; k < d->stiffness.bone_start[part + 1]; k++)
    if (d->stiffness.bone[k] == bone)
      return true;
  return false;
}

/* Parts cover the subdomains, and each is what its lowest element reaches through faces. */
static bw_status check_parts(bw_context *context, const bw_subdomains *d, int32_t *group,
                             int32_t *first) {
  const bw_mesh *mesh = d->mesh;
  for (int32_t e = 0; e < mesh->element_count; e++) {
    int32_t part = d->stiffness.of_element[e];
    if (part < 0 || part >= d->stiffness.count)
      return fail_part(context, e, part, "which does not exist");
    if (d->stiffness.parent[part] != d->element_subdomain[e])
      return fail_part(context, e, part, "which is of another subdomain");
    group[e] = e;
  }
  for (int32_t e = 0; e < mesh->element_count; e++)
    for (int k = 0; k < 4; k++) {
      int32_t other = beside(d, e, k), part = d->stiffness.of_element[e];
      if (other > e && d->stiffness.of_element[other] == part)
        bwi_set_join(group, e, other);
      else if (other > e && is_rigid_part(d, part))
        return fail_part(context, e, part, "which is not all of its subdomain and region");
    }
  for (int32_t i = 0; i < d->stiffness.count; i++)
    first[i] = -1;
  for (int32_t e = 0; e < mesh->element_count; e++) {
    int32_t *named = first + d->stiffness.of_element[e], part = bwi_set_root(group, e);
    if (*named < 0)
      *named = part;
    else if (*named != part)
      return fail_part(context, e, d->stiffness.of_element[e], "which falls apart");
  }
  return BW_OK;
}

/* A part follows what its corners follow, and nothing else. */
static bw_status check_bones(bw_context *context, const bw_subdomains *d, uint8_t *met) {
  const bw_mesh *mesh = d->mesh;
  for (int32_t e = 0; e < mesh->element_count; e++) {
    int32_t part = d->stiffness.of_element[e];
    for (int k = 0; k < mesh->nodes_per_element; k++) {
      int32_t i = bwi_nodes_of(mesh, e)[k], frame = d->stiffness.of_node[i];
      for (int64_t at = d->influence_start[i]; at < d->influence_start[i + 1]; at++) {
        int32_t list = d->stiffness.bone_start[part], bone = d->influence_bone[at];
        if (!follows(d, part, bone))
          return fail_part(context, e, part, "whose bones are not all that its corners follow");
        while (d->stiffness.bone[list] != bone)
          list++;
        met[list] = 1;
      }
      if (frame < 0 || frame >= d->stiffness.count ||
          (is_rigid_part(d, part) && d->stiffness.parent[frame] != d->stiffness.parent[part]))
        return fail_part(context, e, part, "a node of which goes with another");
    }
  }
  for (int32_t i = 0; i < d->stiffness.count; i++)
    for (int32_t k = d->stiffness.bone_start[i]; k < d->stiffness.bone_start[i + 1]; k++) {
      bool sorted =
          k == d->stiffness.bone_start[i] || d->stiffness.bone[k - 1] < d->stiffness.bone[k];
      if (!met[k] || !sorted)
        return bw_fail(context, BW_INTERNAL,
                       "stiffness subdomain %d lists bone %d, which none of its corners follows, "
                       "or out of order",
                       i + 1, d->stiffness.bone[k] + 1);
    }
  return BW_OK;
}

bw_status bwi_stiffness_subdomains_check(bw_context *context, const bw_subdomains *d) {
  bw_status status = BW_OK;
  int32_t *group = BW_NEW(context, int32_t, d->mesh->element_count);
  int32_t *first = BW_NEW(context, int32_t, d->stiffness.count);
  uint8_t *met = BW_NEW0(context, uint8_t, d->stiffness.bone_start[d->stiffness.count]);
  BW_TRY_MEMORY(group && first && met);
  BW_TRY(check_parts(context, d, group, first));
  BW_TRY(check_bones(context, d, met));
done:
  bw_free(group);
  bw_free(first);
  bw_free(met);
  return status;
}
