/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* Which pairs each domain contributes to (domain.h), from topology alone. */
#include "assemble/domain.h"

enum { PAIRS_PER_CHECK = 1 << 16 };

static int64_t next_four(int64_t n) {
  return (n + 3) & ~(int64_t)3;
}

/* Elements listed by domain, ascending. */
static bw_status list_elements(bw_context *context, const bw_mesh *mesh, int32_t domain_count,
                               const int32_t *element_domain, bwi_domain_coefficients *c) {
  int32_t *start = c->element_start = BW_NEW0(context, int32_t, (int64_t)domain_count + 1);
  c->element = BW_NEW(context, int32_t, mesh->element_count);
  c->number = BW_NEW(context, int32_t, mesh->element_count);
  if (!c->element_start || !c->element || !c->number)
    return BW_MEMORY;
  for (int32_t e = 0; e < mesh->element_count; e++)
    start[element_domain[e] + 1]++;
  for (int32_t d = 0; d < domain_count; d++)
    start[d + 1] += start[d];
  for (int32_t e = 0; e < mesh->element_count; e++) {
    c->number[e] = start[element_domain[e]]++;
    c->element[c->number[e]] = e;
  }
  memmove(start + 1, start, (size_t)domain_count * sizeof *start);
  start[0] = 0;
  return BW_OK;
}

/* Nodes of each domain, and the frames met there. */
static bw_status list_nodes(bw_context *context, const bw_mesh *mesh, int32_t domain_count,
                            const int32_t *element_domain, const int32_t *node_domain,
                            bool material_frame, bool material_turns, bwi_domain_coefficients *c) {
  bw_status status = BW_OK;
  bwi_incidence around = {0};
  int32_t *mark = BW_NEW(context, int32_t, (int64_t)domain_count + 1);
  size_t frame_capacity = 0;
  c->node_start = BW_NEW0(context, int64_t, (int64_t)domain_count + 1);
  c->frame_start = BW_NEW0(context, int32_t, (int64_t)domain_count + 1);
  if (!mark || !c->node_start || !c->frame_start) {
    status = BW_MEMORY;
    goto done;
  }
  BW_TRY(bwi_incidence_create(context, mesh, &around));
  for (int pass = 0; pass < 2; pass++) {
    for (int32_t d = 0; d <= domain_count; d++)
      mark[d] = -1;
    for (int32_t i = 0; i < mesh->node_count; i++)
      for (int64_t k = around.start[i]; k < around.start[i + 1]; k++) {
        int32_t d = element_domain[around.element[k]];
        if (mark[d] == i)
          continue;
        mark[d] = i;
        if (pass == 0)
          c->node_start[d + 1]++;
        else
          c->node[c->node_start[d]++] = i;
      }
    if (pass == 0) {
      for (int32_t d = 0; d < domain_count; d++)
        c->node_start[d + 1] += c->node_start[d];
      c->node = BW_NEW(context, int32_t, c->node_start[domain_count]);
      if (!c->node) {
        status = BW_MEMORY;
        goto done;
      }
    } else {
      memmove(c->node_start + 1, c->node_start, (size_t)domain_count * sizeof *c->node_start);
      c->node_start[0] = 0;
    }
  }
  /* mark[f + 1]: the last domain that listed frame f */
  for (int32_t d = 0; d <= domain_count; d++)
    mark[d] = -1;
  for (int32_t d = 0; d < domain_count; d++) {
    int32_t count = c->frame_start[d];
    for (int64_t k = c->node_start[d] - 1; k < c->node_start[d + 1]; k++) {
      int32_t f;
      if (k < c->node_start[d]) { /* before all nodes: where the material rests */
        if (!material_frame || c->node_start[d] == c->node_start[d + 1])
          continue;
        f = material_turns ? d : -1;
      } else
        f = node_domain[c->node[k]];
      if (mark[f + 1] == d)
        continue;
      mark[f + 1] = d;
      if (!bw_grow(context, (void **)&c->frame_domain, &frame_capacity, (size_t)count, 1,
                   sizeof *c->frame_domain)) {
        status = BW_MEMORY;
        goto done;
      }
      c->frame_domain[count++] = f;
    }
    c->frame_start[d + 1] = count;
  }
done:
  bw_free(mark);
  bwi_incidence_clear(&around);
  return status;
}

/* The domains of a pair's elements, ascending, into list (with room for domain_count); *mark of a
 * domain is the last pair that listed it. */
static int32_t domains_of(const bw_graph *graph, const int32_t *element_domain, int64_t pair,
                          int64_t *mark, int32_t *list) {
  int32_t count = 0;
  for (int64_t k = graph->gather_start[pair]; k < graph->gather_start[pair + 1]; k++) {
    int32_t d = element_domain[graph->gather_element[k]];
    if (mark[d] == pair)
      continue;
    mark[d] = pair;
    int32_t at = count++;
    for (; at > 0 && list[at - 1] > d; at--)
      list[at] = list[at - 1];
    list[at] = d;
  }
  return count;
}

/* Count (pass 0) or list (pass 1) the items. */
static bw_status list_items(bw_context *context, const bw_graph *graph, int32_t domain_count,
                            const int32_t *element_domain, int64_t *mark, int32_t *list, int pass,
                            bwi_domain_coefficients *c) {
  int64_t shared = 0, slot = 0;
  for (int32_t d = 0; d < domain_count; d++)
    mark[d] = -1;
  for (int32_t i = 0; i < graph->node_count; i++)
    for (int64_t pair = graph->start[i]; pair < graph->start[i + 1]; pair++) {
      if (pair % PAIRS_PER_CHECK == 0 && bw_check_cancel(context) != BW_OK)
        return BW_CANCELLED;
      uint32_t diagonal = pair == graph->start[i + 1] - 1;
      int32_t count = domains_of(graph, element_domain, pair, mark, list);
      if (pass == 0) {
        for (int32_t k = 0; k < count; k++)
          c->section_count[2 * (int64_t)list[k] + (count > 1)]++;
      } else if (count == 1) {
        int64_t section = 2 * (int64_t)list[0];
        c->place[c->section_start[section] + c->section_count[section]++] =
            (uint32_t)pair << 1 | diagonal;
      } else {
        c->shared_pair[shared] = (uint32_t)pair;
        c->shared_start[shared] = slot;
        for (int32_t k = 0; k < count; k++, slot++) {
          int64_t section = 2 * (int64_t)list[k] + 1;
          c->place[c->section_start[section] + c->section_count[section]++] =
              (uint32_t)slot << 1 | diagonal;
          c->slot_shared[slot] = (uint32_t)shared;
          c->slot_domain[slot] = list[k];
        }
      }
      shared += count > 1;
      slot += pass == 0 && count > 1 ? count : 0;
    }
  if (pass == 0) {
    c->shared_count = shared;
    int64_t at = 0;
    for (int64_t s = 0; s < 2 * (int64_t)domain_count; s++) {
      c->section_start[s] = at;
      at += next_four(c->section_count[s]);
      c->section_count[s] = 0;
    }
    c->section_start[2 * (int64_t)domain_count] = c->item_count = at;
    c->shared_pair = BW_NEW(context, uint32_t, shared);
    c->shared_start = BW_NEW(context, int64_t, shared + 1);
    c->slot_shared = BW_NEW(context, uint32_t, slot);
    c->slot_domain = BW_NEW(context, int32_t, slot);
    c->slot = BW_NEW(context, double, 9 * slot);
    c->place = BW_NEW0(context, uint32_t, at);
    c->tensor = BW_NEW0(context, double, 9 * at);
    if (!c->shared_pair || !c->shared_start || !c->slot_shared || !c->slot_domain || !c->slot ||
        !c->place || !c->tensor)
      return BW_MEMORY;
    c->shared_start[shared] = slot;
  }
  return BW_OK;
}

bw_status bwi_domain_lists(bw_context *context, const bw_graph *graph, int32_t domain_count,
                           const int32_t *element_domain, const int32_t *node_domain,
                           bool material_frame, bool material_turns, bwi_domain_coefficients *c) {
  bw_status status = BW_OK;
  int64_t *mark = BW_NEW(context, int64_t, domain_count);
  int32_t *list = BW_NEW(context, int32_t, domain_count);
  c->section_start = BW_NEW(context, int64_t, 2 * (int64_t)domain_count + 1);
  c->section_count = BW_NEW0(context, int64_t, 2 * (int64_t)domain_count);
  if (!mark || !list || !c->section_start || !c->section_count) {
    status = BW_MEMORY;
    goto done;
  }
  BW_TRY(list_elements(context, graph->mesh, domain_count, element_domain, c));
  BW_TRY(list_nodes(context, graph->mesh, domain_count, element_domain, node_domain, material_frame,
                    material_turns, c));
  for (int pass = 0; pass < 2; pass++)
    BW_TRY(list_items(context, graph, domain_count, element_domain, mark, list, pass, c));
done:
  bw_free(mark);
  bw_free(list);
  return status;
}
