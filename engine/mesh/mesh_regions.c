/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* Regions of a mesh: named domains such as the parts of an assembly.
 *
 * Invariants of a mesh with regions:
 *   - region[e] is an index into `regions`, so a table by region is read without a search;
 *   - `regions` ascend by tag, each has an element and a name, and no two have one name or one tag;
 *   - a mesh without regions has region_count 0, and both pointers are NULL. */
#include "base/sort.h"
#include "mesh/mesh_internal.h"

#include <assert.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

bw_mesh_regions bw_mesh_regions_of(const bw_mesh *mesh) {
  return (bw_mesh_regions){mesh->region_count, mesh->regions, mesh->region};
}

int32_t bw_mesh_find_region(const bw_mesh *mesh, const char *name) {
  for (int32_t i = 0; i < mesh->region_count; i++)
    if (strcmp(mesh->regions[i].name.text, name) == 0)
      return i;
  return -1;
}

void bw_mesh_region_volumes(const bw_mesh *mesh, double *volume) {
  for (int32_t i = 0; i < mesh->region_count; i++)
    volume[i] = 0;
  for (int32_t e = 0; mesh->region && e < mesh->element_count; e++)
    volume[mesh->region[e]] += mesh->volume[e];
}

bw_status bw_mesh_element_tags(bw_context *context, const bw_mesh *mesh, int32_t **tag) {
  *tag = NULL;
  if (!mesh->region)
    return BW_OK;
  *tag = BW_NEW(context, int32_t, mesh->element_count);
  if (!*tag)
    return BW_MEMORY;
  for (int32_t e = 0; e < mesh->element_count; e++)
    (*tag)[e] = mesh->regions[mesh->region[e]].tag;
  return BW_OK;
}

/* ---- the table of a mesh -------------------------------------------------------------------- */

typedef struct entry {
  bw_mesh_region region;
  int32_t from; /* its place in the table that was given */
} entry;

static int by_tag(const void *a, const void *b) {
  int32_t x = ((const entry *)a)->region.tag, y = ((const entry *)b)->region.tag;
  return (x > y) - (x < y);
}

static int by_name(const void *a, const void *b) {
  const bw_mesh_region *x = *(const bw_mesh_region *const *)a;
  const bw_mesh_region *y = *(const bw_mesh_region *const *)b;
  int order = strcmp(x->name.text, y->name.text);
  return order ? order : (x->tag > y->tag) - (x->tag < y->tag);
}

static bw_status count_elements(bw_context *context, const bw_mesh *mesh,
                                const bw_mesh_regions *given, entry *list) {
  for (int32_t i = 0; i < given->count; i++) {
    list[i] = (entry){given->region[i], i};
    list[i].region.element_count = 0;
  }
  for (int32_t e = 0; e < mesh->element_count; e++) {
    int32_t r = given->of_element[e];
    if (r < 0 || r >= given->count) {
      bw_fail(context, BW_INVALID, "element %d is in region number %d, but there are %d regions",
              e + 1, r + 1, given->count);
      bw_detail_number(context, "element", e + 1.0);
      return BW_INVALID;
    }
    list[r].region.element_count++;
  }
  return BW_OK;
}

/* The first `count` entries have elements and ascend by tag. */
static bw_status check_entries(bw_context *context, int32_t count, entry *list) {
  const bw_mesh_region **sorted = BW_NEW(context, const bw_mesh_region *, count);
  if (!sorted)
    return BW_MEMORY;
  bw_status status = BW_OK;
  for (int32_t i = 0; i < count; i++) {
    bw_mesh_region *r = &list[i].region;
    r->name.text[BW_NAME - 1] = 0;
    if (!r->name.text[0])
      snprintf(r->name.text, BW_NAME, "region %d", (int)r->tag);
    sorted[i] = r;
    if (i > 0 && list[i - 1].region.tag == r->tag)
      BW_TRY(bw_fail(context, BW_INVALID, "the regions '%s' and '%s' both have the tag %d",
                     list[i - 1].region.name.text, r->name.text, (int)r->tag));
  }
  qsort(sorted, (size_t)count, sizeof *sorted, by_name);
  for (int32_t i = 1; i < count; i++)
    if (strcmp(sorted[i - 1]->name.text, sorted[i]->name.text) == 0)
      BW_TRY(bw_fail(context, BW_INVALID,
                     "two regions are called '%s', those of the tags %d and %d: each needs a name "
                     "of its own",
                     sorted[i]->name.text, (int)sorted[i - 1]->tag, (int)sorted[i]->tag));
done:
  bw_free(sorted);
  return status;
}

bw_status bwi_mesh_set_regions(bw_context *context, bw_mesh *mesh, const bw_mesh_regions *given) {
  assert(!mesh->region);
  if (!given || given->count == 0)
    return BW_OK;
  bw_status status = BW_OK;
  int32_t count = 0, *number = BW_NEW(context, int32_t, given->count);
  entry *list = BW_NEW(context, entry, given->count);
  BW_TRY_MEMORY(number && list);
  BW_TRY(count_elements(context, mesh, given, list));
  for (int32_t i = 0; i < given->count; i++)
    if (list[i].region.element_count > 0)
      list[count++] = list[i];
  qsort(list, (size_t)count, sizeof *list, by_tag);
  BW_TRY(check_entries(context, count, list));
  mesh->regions = BW_NEW(context, bw_mesh_region, count);
  mesh->region = BW_NEW(context, int32_t, mesh->element_count);
  BW_TRY_MEMORY(mesh->regions && mesh->region);
  mesh->region_count = count;
  for (int32_t i = 0; i < count; i++) {
    mesh->regions[i] = list[i].region;
    number[list[i].from] = i;
  }
  for (int32_t e = 0; e < mesh->element_count; e++)
    mesh->region[e] = number[given->of_element[e]];
done:
  bw_free(number);
  bw_free(list);
  return status;
}

/* ---- regions by tag ------------------------------------------------------------------------- */

void bw_mesh_regions_clear(bw_mesh_regions *regions) {
  bw_free((void *)(uintptr_t)regions->region);
  bw_free((void *)(uintptr_t)regions->of_element);
  *regions = (bw_mesh_regions){0, NULL, NULL};
}

bw_status bw_mesh_regions_by_tag(bw_context *context, int64_t elements, const int32_t *tag,
                                 int32_t named_count, const bw_mesh_region *named,
                                 bw_mesh_regions *regions) {
  bw_status status = BW_OK;
  int32_t count = 0;
  int32_t *sorted = BW_NEW(context, int32_t, elements);
  int32_t *of_element = BW_NEW(context, int32_t, elements);
  bw_mesh_region *region = NULL;
  BW_TRY_MEMORY(sorted && of_element);
  memcpy(sorted, tag, (size_t)elements * sizeof *tag);
  bwi_sort_columns(sorted, elements);
  for (int64_t i = 0; i < elements; i++)
    if (i == 0 || sorted[i] != sorted[count - 1])
      sorted[count++] = sorted[i];
  region = BW_NEW0(context, bw_mesh_region, count);
  BW_TRY_MEMORY(region);
  for (int32_t i = 0; i < count; i++)
    region[i].tag = sorted[i];
  for (int32_t i = 0; i < named_count; i++) {
    int64_t at = bwi_sorted_index(sorted, 0, count, named[i].tag);
    if (sorted[at] == named[i].tag)
      region[at].name = named[i].name;
  }
  for (int64_t e = 0; e < elements; e++)
    of_element[e] = (int32_t)bwi_sorted_index(sorted, 0, count, tag[e]);
  *regions = (bw_mesh_regions){count, region, of_element};
done:
  bw_free(sorted);
  if (status != BW_OK) {
    bw_free(of_element);
    bw_free(region);
  }
  return status;
}
