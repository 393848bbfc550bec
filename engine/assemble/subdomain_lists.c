/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* Which blocks each subdomain contributes to (subdomain.h), from topology alone. */
#include "assemble/subdomain.h"

#include <stdlib.h>

/* A tile is small enough for its entries to stay in the nearest cache while they are written, and
 * large enough for segments of many blocks. */
enum { BLOCKS_PER_TILE = 4096, BLOCKS_PER_CHECK = 1 << 16 };

/* Elements listed by subdomain, ascending. */
static bw_status list_elements(bw_context *context, const bw_mesh *mesh, int32_t subdomain_count,
                               const int32_t *element_subdomain, bwi_subdomain_coefficients *c) {
  int32_t *start = c->element_start = BW_NEW0(context, int32_t, (int64_t)subdomain_count + 1);
  c->element = BW_NEW(context, int32_t, mesh->element_count);
  c->number = BW_NEW(context, int32_t, mesh->element_count);
  if (!c->element_start || !c->element || !c->number)
    return BW_MEMORY;
  for (int32_t e = 0; e < mesh->element_count; e++)
    start[element_subdomain[e] + 1]++;
  for (int32_t d = 0; d < subdomain_count; d++)
    start[d + 1] += start[d];
  for (int32_t e = 0; e < mesh->element_count; e++) {
    c->number[e] = start[element_subdomain[e]]++;
    c->element[c->number[e]] = e;
  }
  memmove(start + 1, start, (size_t)subdomain_count * sizeof *start);
  start[0] = 0;
  return BW_OK;
}

/* Nodes of each subdomain, and the frames met there. */
static bw_status list_nodes(bw_context *context, const bw_mesh *mesh, int32_t subdomain_count,
                            const int32_t *element_subdomain, const int32_t *node_subdomain,
                            bool material_frame, bool rotate_material,
                            bwi_subdomain_coefficients *c) {
  bw_status status = BW_OK;
  bwi_incidence around = {0};
  int32_t *mark = BW_NEW(context, int32_t, (int64_t)subdomain_count + 1);
  size_t frame_capacity = 0;
  c->node_start = BW_NEW0(context, int64_t, (int64_t)subdomain_count + 1);
  c->frame_start = BW_NEW0(context, int32_t, (int64_t)subdomain_count + 1);
  BW_TRY_MEMORY(mark && c->node_start && c->frame_start);
  BW_TRY(bwi_incidence_create(context, mesh, &around));
  for (int pass = 0; pass < 2; pass++) {
    for (int32_t d = 0; d <= subdomain_count; d++)
      mark[d] = -1;
    for (int32_t i = 0; i < mesh->node_count; i++)
      for (int64_t k = around.start[i]; k < around.start[i + 1]; k++) {
        int32_t d = element_subdomain[around.element[k]];
        if (mark[d] == i)
          continue;
        mark[d] = i;
        if (pass == 0)
          c->node_start[d + 1]++;
        else
          c->node[c->node_start[d]++] = i;
      }
    if (pass == 0) {
      for (int32_t d = 0; d < subdomain_count; d++)
        c->node_start[d + 1] += c->node_start[d];
      c->node = BW_NEW(context, int32_t, c->node_start[subdomain_count]);
      BW_TRY_MEMORY(c->node);
    } else {
      memmove(c->node_start + 1, c->node_start, (size_t)subdomain_count * sizeof *c->node_start);
      c->node_start[0] = 0;
    }
  }
  /* mark[f + 1]: the last subdomain that listed frame f */
  for (int32_t d = 0; d <= subdomain_count; d++)
    mark[d] = -1;
  for (int32_t d = 0; d < subdomain_count; d++) {
    int32_t count = c->frame_start[d];
    for (int64_t k = c->node_start[d] - 1; k < c->node_start[d + 1]; k++) {
      int32_t f;
      if (k < c->node_start[d]) { /* before all nodes: where the material rests */
        if (!material_frame || c->node_start[d] == c->node_start[d + 1])
          continue;
        f = rotate_material ? d : -1;
      } else
        f = node_subdomain[c->node[k]];
      if (mark[f + 1] == d)
        continue;
      mark[f + 1] = d;
      if (!bw_grow(context, (void **)&c->frame_subdomain, &frame_capacity, (size_t)count, 1,
                   sizeof *c->frame_subdomain)) {
        status = BW_MEMORY;
        goto done;
      }
      c->frame_subdomain[count++] = f;
    }
    c->frame_start[d + 1] = count;
  }
done:
  bw_free(mark);
  bwi_incidence_clear(&around);
  return status;
}

/* ---- sections -------------------------------------------------------------------------------- */

/* Sets of subdomains met at shared blocks, found again through a table of hashes. */
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

/* The subdomains of a block's elements, ascending, into list (with room for subdomain_count);
 * mark[d] is the last block that listed d. */
static int32_t subdomains_of(const bwi_contributions *contributions,
                             const int32_t *element_subdomain, int64_t block, int64_t *mark,
                             int32_t *list) {
  int32_t count = 0;
  for (int64_t k = contributions->start[block]; k < contributions->start[block + 1]; k++) {
    int32_t d = element_subdomain[contributions->element[k]];
    if (mark[d] == block)
      continue;
    mark[d] = block;
    int32_t at = count++;
    for (; at > 0 && list[at - 1] > d; at--)
      list[at] = list[at - 1];
    list[at] = d;
  }
  return count;
}

/* The subdomains of each section. */
static bw_status list_section_subdomains(bw_context *context, int32_t subdomain_count,
                                         const set_table *sets, bwi_subdomain_coefficients *c) {
  int64_t members = sets->count ? sets->start[sets->count] : 0, inside = c->inside_count;
  c->section_start = BW_NEW(context, int64_t, c->section_count + 1);
  c->section_subdomain = BW_NEW(context, int32_t, inside + members);
  if (!c->section_start || !c->section_subdomain)
    return BW_MEMORY;
  for (int64_t s = 0; s < inside; s++) {
    c->section_start[s] = s;
    c->section_subdomain[s] = (int32_t)(s % subdomain_count);
  }
  for (int64_t set = 0; set < sets->count; set++)
    c->section_start[inside + set] = inside + sets->start[set];
  c->section_start[c->section_count] = inside + members;
  if (members)
    memcpy(c->section_subdomain + inside, sets->member, (size_t)members * sizeof *sets->member);
  return BW_OK;
}

static int ascending(const void *a, const void *b) {
  const bwi_subdomain_segment *p = (const bwi_subdomain_segment *)a,
                              *q = (const bwi_subdomain_segment *)b;
  return (p->section > q->section) - (p->section < q->section);
}

/* Segments and what they hold, from the section of every block. */
static bw_status list_segments(bw_context *context, const bw_block_pattern *pattern,
                               int32_t subdomain_count, const int32_t *section,
                               bwi_subdomain_coefficients *c) {
  bw_status status = BW_OK;
  size_t capacity = 0;
  int64_t blocks = pattern->block_count, *found = BW_NEW(context, int64_t, c->section_count);
  BW_TRY_MEMORY(found);
  for (int64_t s = 0; s < c->section_count; s++)
    found[s] = -1; /* its last segment */
  for (int64_t first = 0; first < blocks; first += BLOCKS_PER_TILE) {
    int64_t before = c->segment_count, end = first + BLOCKS_PER_TILE;
    end = end < blocks ? end : blocks;
    if (!bw_grow(context, (void **)&c->segment, &capacity, (size_t)before, BLOCKS_PER_TILE,
                 sizeof *c->segment)) {
      status = BW_MEMORY;
      goto done;
    }
    for (int64_t block = first; block < end; block++) {
      int64_t s = section[block];
      if (found[s] < before) {
        found[s] = c->segment_count++;
        c->segment[found[s]] =
            (bwi_subdomain_segment){.section = s, .numbers = s < subdomain_count ? 6 : 9};
      }
      c->segment[found[s]].size++;
    }
    qsort(c->segment + before, (size_t)(c->segment_count - before), sizeof *c->segment, ascending);
    for (int64_t p = before; p < c->segment_count; p++) {
      bwi_subdomain_segment *segment = &c->segment[p];
      int64_t size = bwi_next_four(segment->size);
      int64_t all = segment->numbers * size *
                    (c->section_start[segment->section + 1] - c->section_start[segment->section]);
      segment->first = c->code_count;
      segment->item = c->item_count;
      segment->present = c->present_count;
      c->code_count += size;
      c->item_count += all;
      c->present_count += segment->section < c->inside_count ? 0 : all;
      found[segment->section] = p;
    }
  }
  c->block_code = BW_NEW0(context, uint32_t, c->code_count);
  c->tensor = BW_NEW0(context, double, c->item_count);
  c->present = BW_NEW0(context, double, c->present_count);
  BW_TRY_MEMORY(c->block_code && c->tensor && c->present);
  bwi_subdomain_segment *segment = c->segment;
  int64_t *next = found; /* where the next block of a section is put */
  for (int32_t i = 0; i < pattern->node_count; i++)
    for (int64_t block = pattern->start[i]; block < pattern->start[i + 1]; block++) {
      if (block % BLOCKS_PER_TILE == 0)
        for (int64_t in = 0; in < BLOCKS_PER_TILE && in < blocks - block; in += (segment++)->size)
          next[segment->section] = segment->first;
      c->block_code[next[section[block]]++] =
          (uint32_t)block << 1 | (block == pattern->start[i + 1] - 1);
    }
done:
  bw_free(found);
  return status;
}

static bw_status list_sections(bw_context *context, const bw_block_pattern *pattern,
                               int32_t subdomain_count, const int32_t *element_subdomain,
                               bwi_subdomain_coefficients *c) {
  bw_status status = BW_OK;
  set_table sets = {0};
  size_t capacity = 0;
  int64_t *mark = BW_NEW(context, int64_t, subdomain_count);
  int32_t *list = BW_NEW(context, int32_t, subdomain_count);
  int32_t *section = BW_NEW(context, int32_t, pattern->block_count);
  uint8_t *surface = BW_NEW0(context, uint8_t, pattern->block_count);
  c->section_count = c->inside_count = 2 * (int64_t)subdomain_count;
  if (!mark || !list || !section || !surface ||
      !bw_grow(context, (void **)&c->section_size, &capacity, 0, (size_t)c->inside_count,
               sizeof *c->section_size)) {
    status = BW_MEMORY;
    goto done;
  }
  for (int32_t d = 0; d < subdomain_count; d++)
    mark[d] = -1;
  memset(c->section_size, 0, (size_t)c->inside_count * sizeof *c->section_size);
  bwi_block_pattern_mark_surface(pattern, pattern->mesh, surface);
  for (int64_t block = 0; block < pattern->block_count; block++) {
    if (block % BLOCKS_PER_CHECK == 0)
      BW_TRY(bw_check_cancel(context));
    int32_t count = subdomains_of(c->contributions, element_subdomain, block, mark, list);
    int64_t number = surface[block] ? subdomain_count + list[0] : list[0];
    if (count > 1) {
      BW_TRY(set_number(context, &sets, list, count, &number));
      number += c->inside_count;
      if (number == c->section_count) {
        if (!bw_grow(context, (void **)&c->section_size, &capacity, (size_t)number, 1,
                     sizeof *c->section_size)) {
          status = BW_MEMORY;
          goto done;
        }
        c->section_size[c->section_count++] = 0;
      }
    }
    section[block] = (int32_t)number;
    c->section_size[number]++;
  }
  BW_TRY(list_section_subdomains(context, subdomain_count, &sets, c));
  BW_TRY(list_segments(context, pattern, subdomain_count, section, c));
done:
  set_table_clear(&sets);
  bw_free(mark);
  bw_free(list);
  bw_free(section);
  bw_free(surface);
  return status;
}

bw_status bwi_subdomain_lists(bw_context *context, const bw_block_pattern *pattern,
                              int32_t subdomain_count, const int32_t *element_subdomain,
                              const int32_t *node_subdomain, bool material_frame,
                              bool rotate_material, bwi_subdomain_coefficients *c) {
  bw_status status = BW_OK;
  BW_TRY(list_elements(context, pattern->mesh, subdomain_count, element_subdomain, c));
  BW_TRY(list_nodes(context, pattern->mesh, subdomain_count, element_subdomain, node_subdomain,
                    material_frame, rotate_material, c));
  BW_TRY(list_sections(context, pattern, subdomain_count, element_subdomain, c));
done:
  return status;
}
