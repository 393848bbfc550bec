/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* Which subdomains contribute to which supernodes.
 *
 * Every node of an element has a diagonal entry of that element, so the subdomains of a supernode's
 * own columns are those of the elements around its nodes. Sets grow from child to parent; a
 * supernode is done again when its set meets the touched subdomains, and then so is its parent.
 * What it needs from a child that is not done again is the child's update matrix: kept wherever the
 * parent's set is larger. */
#include <string.h>

#include "linear/internal.h"

static void reach_destroy(void *object) {
  bwi_elimination_reach *reach = object;
  bw_release(reach->symbolic);
  bw_free(reach->set);
  bw_free(reach->keep);
  bw_free(reach->part);
  bw_free(reach);
}

static size_t reach_bytes(const void *object) {
  const bwi_elimination_reach *reach = object;
  return sizeof *reach +
         (size_t)reach->symbolic->order->super_count * (size_t)(8 * reach->words + 1);
}

static const bw_kind reach_kind = {"reach of subdomains", reach_destroy, reach_bytes};

bw_status bwi_elimination_reach_create(bw_context *context, bwi_symbolic *symbolic,
                                       const bw_mesh *mesh, int32_t subdomain_count,
                                       const int32_t *element_subdomain,
                                       bwi_elimination_reach **out) {
  bw_status status = BW_OK;
  const bwi_order *order = symbolic->order;
  int32_t supers = order->super_count, *super_of = NULL;
  int npe = mesh->nodes_per_element;
  if (mesh->node_count != order->node_count)
    return bw_fail(context, BW_INTERNAL, "the order is of %d nodes, the mesh has %d",
                   order->node_count, mesh->node_count);
  bwi_elimination_reach *reach = BW_NEW0(context, bwi_elimination_reach, 1);
  if (!reach)
    return BW_MEMORY;
  bw_object_init(reach, &reach_kind);
  reach->symbolic = bw_retain(symbolic);
  reach->subdomain_count = subdomain_count;
  reach->words = (subdomain_count + 63) / 64;
  size_t words = (size_t)reach->words;
  reach->set = BW_NEW0(context, uint64_t, (size_t)supers * words);
  reach->keep = BW_NEW0(context, uint8_t, supers);
  super_of = BW_NEW(context, int32_t, order->size);
  BW_TRY_MEMORY(reach->set && reach->keep && super_of);
  for (int32_t s = 0; s < supers; s++)
    for (int32_t p = order->super[s]; p < order->super[s + 1]; p++)
      super_of[p] = s;
  for (int64_t e = 0; e < mesh->element_count; e++) {
    int32_t subdomain = element_subdomain[e];
    if (subdomain < 0 || subdomain >= subdomain_count)
      BW_TRY(bw_fail(context, BW_INVALID,
                     "element %lld is in subdomain %d: the subdomains are 1 to %d",
                     (long long)(e + 1), subdomain + 1, subdomain_count));
    for (int k = 0; k < npe; k++) {
      int32_t position = order->position[mesh->element[e * npe + k]];
      if (position >= 0)
        reach->set[(size_t)super_of[position] * words + (size_t)(subdomain / 64)] |=
            (uint64_t)1 << subdomain % 64;
    }
  }
  for (int32_t s = 0; s < supers; s++) {
    int32_t parent = order->parent[s];
    if (parent >= 0)
      for (size_t w = 0; w < words; w++)
        reach->set[(size_t)parent * words + w] |= reach->set[(size_t)s * words + w];
  }
  for (int32_t s = 0; s < supers; s++) {
    int32_t parent = order->parent[s];
    if (parent < 0)
      continue;
    reach->keep[s] = memcmp(reach->set + (size_t)parent * words, reach->set + (size_t)s * words,
                            words * sizeof(uint64_t)) != 0;
    if (reach->keep[s])
      reach->kept_numbers += bwi_update_size(symbolic->rows[s] - bwi_pivots(symbolic, s));
  }
done:
  bw_free(super_of);
  if (status == BW_OK)
    *out = reach;
  else
    bw_release(reach);
  return status;
}

static bool meets(const bwi_elimination_reach *reach, int32_t s, const uint8_t *touched_subdomain) {
  const uint64_t *set = reach->set + (size_t)s * (size_t)reach->words;
  for (int w = 0; w < reach->words; w++)
    for (uint64_t left = set[w]; left; left &= left - 1)
      if (touched_subdomain[64 * w + __builtin_ctzll(left)])
        return true;
  return false;
}

double bwi_elimination_reach_supernodes(const bwi_elimination_reach *reach,
                                        const uint8_t *touched_subdomain, uint8_t *wanted) {
  double flops = 0;
  for (int32_t s = 0; s < reach->symbolic->order->super_count; s++) {
    wanted[s] = meets(reach, s, touched_subdomain);
    if (wanted[s])
      flops += bwi_front_flops(reach->symbolic, s);
  }
  return flops;
}

double bwi_elimination_reach_flops(const bwi_elimination_reach *reach,
                                   const uint8_t *touched_subdomain) {
  double flops = 0;
  for (int32_t s = 0; s < reach->symbolic->order->super_count; s++)
    if (meets(reach, s, touched_subdomain))
      flops += bwi_front_flops(reach->symbolic, s);
  return flops;
}

/* The subdomain of an element: that of its node eliminated first; 0 where none is eliminated. */
static int32_t part_of(const bwi_order *order, const int32_t *part, const int32_t *node,
                       int nodes) {
  int32_t first = INT32_MAX;
  for (int a = 0; a < nodes; a++) {
    int32_t position = order->position[node[a]];
    if (position >= 0 && position < first)
      first = position;
  }
  return first < INT32_MAX ? part[first] : 0;
}

bw_status bwi_elimination_reach_create_by_plan(bw_context *context, bwi_symbolic *symbolic,
                                               const bw_mesh *mesh, bwi_elimination_reach **out) {
  bw_status status = BW_OK;
  const bwi_order *order = symbolic->order;
  const bwi_plan *plan = &symbolic->plan;
  int32_t *part = BW_NEW(context, int32_t, order->size);
  int32_t *subdomain = BW_NEW(context, int32_t, mesh->element_count);
  BW_TRY_MEMORY(part && subdomain);
  for (int32_t t = 0; t < plan->task_count; t++)
    for (int32_t p = order->super[plan->task[t].first]; p < order->super[plan->task[t].root + 1];
         p++)
      part[p] = t;
  for (int32_t k = 0; k < plan->top_count; k++)
    for (int32_t p = order->super[plan->top[k]]; p < order->super[plan->top[k] + 1]; p++)
      part[p] = plan->task_count + k;
  for (int64_t e = 0; e < mesh->element_count; e++)
    subdomain[e] =
        part_of(order, part, mesh->element + e * mesh->nodes_per_element, mesh->nodes_per_element);
  BW_TRY(bwi_elimination_reach_create(context, symbolic, mesh, plan->task_count + plan->top_count,
                                      subdomain, out));
  (*out)->part = part;
  part = NULL;
done:
  bw_free(part);
  bw_free(subdomain);
  return status;
}

void bwi_elimination_reach_touch(const bwi_elimination_reach *reach, const bw_mesh *mesh,
                                 const uint8_t *changed, uint8_t *touched_subdomain) {
  for (int64_t e = 0; e < mesh->element_count; e++)
    if (changed[e])
      touched_subdomain[part_of(reach->symbolic->order, reach->part,
                                mesh->element + e * mesh->nodes_per_element,
                                mesh->nodes_per_element)] = 1;
}

bw_status bwi_elimination_reach_create_whole(bw_context *context, bwi_symbolic *symbolic,
                                             bwi_elimination_reach **out) {
  int32_t supers = symbolic->order->super_count;
  bwi_elimination_reach *reach = BW_NEW0(context, bwi_elimination_reach, 1);
  if (!reach)
    return BW_MEMORY;
  bw_object_init(reach, &reach_kind);
  reach->symbolic = bw_retain(symbolic);
  reach->subdomain_count = reach->words = 1;
  reach->set = BW_NEW(context, uint64_t, supers);
  reach->keep = BW_NEW0(context, uint8_t, supers);
  if (!reach->set || !reach->keep) {
    bw_release(reach);
    return BW_MEMORY;
  }
  for (int32_t s = 0; s < supers; s++)
    reach->set[s] = 1;
  *out = reach;
  return BW_OK;
}
