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

/* ---- sections -------------------------------------------------------------------------------- */

/* Sets of domains met at shared pairs, found again through a table of hashes. */
typedef struct set_table {
  int32_t *member; /* all sets, one after the other, each ascending */
  int64_t *start;  /* count + 1 */
  size_t member_capacity, start_capacity;
  int64_t count;
  int64_t *slot; /* capacity: number of a set + 1, or 0 */
  int64_t capacity;
} set_table;

static void set_table_clear(set_table *table) {
  bw_free(table->member);
  bw_free(table->start);
  bw_free(table->slot);
}

static int64_t hash_of(const int32_t *member, int64_t count, int64_t capacity) {
  uint64_t hash = 0xcbf29ce484222325u;
  for (int64_t k = 0; k < count; k++)
    hash = (hash ^ (uint64_t)member[k]) * 0x9e3779b97f4a7c15u;
  return (int64_t)(hash >> 20) & (capacity - 1);
}

/* Where a set is, or would be put. */
static int64_t slot_of(const set_table *table, const int32_t *member, int64_t count) {
  int64_t at = hash_of(member, count, table->capacity);
  for (;; at = (at + 1) & (table->capacity - 1)) {
    int64_t set = table->slot[at] - 1;
    if (set < 0)
      return at;
    if (table->start[set + 1] - table->start[set] == count &&
        memcmp(table->member + table->start[set], member, (size_t)count * sizeof *member) == 0)
      return at;
  }
}

static bw_status set_table_grow(bw_context *context, set_table *table) {
  int64_t capacity = table->capacity ? 2 * table->capacity : 64;
  int64_t *slot = BW_NEW0(context, int64_t, capacity);
  if (!slot)
    return BW_MEMORY;
  bw_free(table->slot);
  table->slot = slot;
  table->capacity = capacity;
  for (int64_t set = 0; set < table->count; set++) {
    int64_t first = table->start[set];
    slot[slot_of(table, table->member + first, table->start[set + 1] - first)] = set + 1;
  }
  return BW_OK;
}

/* The number of a set, which is added when it is new. */
static bw_status set_number(bw_context *context, set_table *table, const int32_t *member,
                            int64_t count, int64_t *number) {
  bw_status status = BW_OK;
  if (2 * table->count >= table->capacity)
    BW_TRY(set_table_grow(context, table));
  int64_t at = slot_of(table, member, count);
  if (!table->slot[at]) {
    size_t used = table->count ? (size_t)table->start[table->count] : 0;
    if (!bw_grow(context, (void **)&table->member, &table->member_capacity, used, (size_t)count,
                 sizeof *table->member) ||
        !bw_grow(context, (void **)&table->start, &table->start_capacity, (size_t)table->count, 2,
                 sizeof *table->start))
      return BW_MEMORY;
    memcpy(table->member + used, member, (size_t)count * sizeof *member);
    table->start[table->count] = (int64_t)used;
    table->start[table->count + 1] = (int64_t)used + count;
    table->slot[at] = ++table->count;
  }
  *number = table->slot[at] - 1;
done:
  return status;
}

/* The domains of a pair's elements, ascending, into list (with room for domain_count); mark[d] is
 * the last pair that listed d. */
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

/* Sections and blocks from the sets, with room for what they hold; section_size is counted. */
static bw_status make_sections(bw_context *context, int32_t domain_count, const set_table *sets,
                               bwi_domain_coefficients *c) {
  int64_t sections = c->section_count, pairs = 0, items = 0, block = 0;
  int64_t blocks = domain_count + (sets->count ? sets->start[sets->count] : 0);
  c->section_start = BW_NEW(context, int64_t, sections + 1);
  c->block_start = BW_NEW(context, int64_t, sections + 1);
  c->block_domain = BW_NEW(context, int32_t, blocks);
  c->block_first = BW_NEW(context, int64_t, blocks + 1);
  if (!c->section_start || !c->block_start || !c->block_domain || !c->block_first)
    return BW_MEMORY;
  for (int64_t s = 0; s < sections; s++) {
    int64_t set = s - domain_count, count = set < 0 ? 1 : sets->start[set + 1] - sets->start[set];
    c->section_start[s] = pairs;
    c->block_start[s] = block;
    for (int64_t k = 0; k < count; k++, block++) {
      c->block_domain[block] = set < 0 ? (int32_t)s : sets->member[sets->start[set] + k];
      c->block_first[block] = items;
      items += next_four(c->section_size[s]);
    }
    pairs += next_four(c->section_size[s]);
  }
  c->section_start[sections] = pairs;
  c->block_start[sections] = block;
  c->block_first[block] = items;
  c->place = BW_NEW0(context, uint32_t, pairs);
  c->tensor = BW_NEW0(context, double, 9 * items);
  c->present = BW_NEW0(context, double, 9 * (items - c->block_first[domain_count]));
  return c->place && c->tensor && c->present ? BW_OK : BW_MEMORY;
}

static bw_status list_sections(bw_context *context, const bw_graph *graph, int32_t domain_count,
                               const int32_t *element_domain, bwi_domain_coefficients *c) {
  bw_status status = BW_OK;
  set_table sets = {0};
  size_t capacity = 0;
  int64_t *mark = BW_NEW(context, int64_t, domain_count);
  int32_t *list = BW_NEW(context, int32_t, domain_count);
  int32_t *section = BW_NEW(context, int32_t, graph->pair_count);
  if (!mark || !list || !section ||
      !bw_grow(context, (void **)&c->section_size, &capacity, 0, (size_t)domain_count,
               sizeof *c->section_size)) {
    status = BW_MEMORY;
    goto done;
  }
  c->section_count = domain_count;
  for (int32_t d = 0; d < domain_count; d++) {
    mark[d] = -1;
    c->section_size[d] = 0;
  }
  for (int64_t pair = 0; pair < graph->pair_count; pair++) {
    if (pair % PAIRS_PER_CHECK == 0)
      BW_TRY(bw_check_cancel(context));
    int32_t count = domains_of(graph, element_domain, pair, mark, list);
    int64_t number = list[0];
    if (count > 1) {
      BW_TRY(set_number(context, &sets, list, count, &number));
      number += domain_count;
      if (number == c->section_count) {
        if (!bw_grow(context, (void **)&c->section_size, &capacity, (size_t)number, 1,
                     sizeof *c->section_size)) {
          status = BW_MEMORY;
          goto done;
        }
        c->section_size[c->section_count++] = 0;
      }
    }
    section[pair] = (int32_t)number;
    c->section_size[number]++;
  }
  BW_TRY(make_sections(context, domain_count, &sets, c));
  for (int64_t s = 0; s < c->section_count; s++)
    c->section_size[s] = 0; /* counted again while they are filled */
  for (int32_t i = 0; i < graph->node_count; i++)
    for (int64_t pair = graph->start[i]; pair < graph->start[i + 1]; pair++) {
      int64_t s = section[pair];
      c->place[c->section_start[s] + c->section_size[s]++] =
          (uint32_t)pair << 1 | (pair == graph->start[i + 1] - 1);
    }
done:
  set_table_clear(&sets);
  bw_free(mark);
  bw_free(list);
  bw_free(section);
  return status;
}

bw_status bwi_domain_lists(bw_context *context, const bw_graph *graph, int32_t domain_count,
                           const int32_t *element_domain, const int32_t *node_domain,
                           bool material_frame, bool material_turns, bwi_domain_coefficients *c) {
  bw_status status = BW_OK;
  BW_TRY(list_elements(context, graph->mesh, domain_count, element_domain, c));
  BW_TRY(list_nodes(context, graph->mesh, domain_count, element_domain, node_domain, material_frame,
                    material_turns, c));
  BW_TRY(list_sections(context, graph, domain_count, element_domain, c));
done:
  return status;
}
