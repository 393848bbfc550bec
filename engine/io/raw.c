/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* From what a mesh file holds to a mesh with its fields and sets, or to a surface. */
#include "io/raw.h"
#include "base/sort.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

void bwi_raw_init(bwi_raw *raw, bw_context *context, const char *name) {
  memset(raw, 0, sizeof *raw);
  raw->context = context;
  raw->name = name;
}

void bwi_raw_clear(bwi_raw *raw) {
  bw_free(raw->point);
  bw_free(raw->tet);
  bw_free(raw->region);
  bw_free(raw->named);
  bw_free(raw->facet);
  for (size_t i = 0; i < raw->field_count; i++) {
    bw_free(raw->field[i].name);
    bw_release(raw->field[i].array);
  }
  bw_free(raw->field);
  for (size_t i = 0; i < raw->set_count; i++) {
    bw_free(raw->set[i].name);
    bw_free(raw->set[i].member);
  }
  bw_free(raw->set);
  bwi_raw_init(raw, raw->context, raw->name);
}

/* ---- collecting ---------------------------------------------------------------------------- */

static bw_status fail_file(const bwi_raw *raw, bw_status status, const char *text) {
  bw_fail(raw->context, status, "%s: %s", raw->name, text);
  bw_detail_text(raw->context, "file", raw->name);
  return status;
}

bw_status bwi_raw_point(bwi_raw *raw, const double point[3]) {
  if (raw->point_count >= INT32_MAX)
    return fail_file(raw, BW_LIMIT, "more than 2147483647 points");
  if (!bw_grow(raw->context, (void **)&raw->point, &raw->point_capacity, raw->point_count, 1,
               3 * sizeof(double)))
    return BW_MEMORY;
  memcpy(raw->point + 3 * raw->point_count++, point, 3 * sizeof(double));
  return BW_OK;
}

bw_status bwi_raw_tet(bwi_raw *raw, int width, const int32_t *node, int32_t region) {
  if (raw->width && raw->width != width)
    return fail_file(
        raw, BW_UNSUPPORTED,
        "tetrahedra of 4 and of 10 nodes in one file: a mesh has elements of one order");
  if (raw->tet_count >= INT32_MAX)
    return fail_file(raw, BW_LIMIT, "more than 2147483647 tetrahedra");
  raw->width = width;
  if (!bw_grow(raw->context, (void **)&raw->tet, &raw->tet_capacity, raw->tet_count, 1,
               (size_t)width * sizeof(int32_t)) ||
      !bw_grow(raw->context, (void **)&raw->region, &raw->region_capacity, raw->tet_count, 1,
               sizeof(int32_t)))
    return BW_MEMORY;
  memcpy(raw->tet + raw->tet_count * (size_t)width, node, (size_t)width * sizeof *node);
  raw->region[raw->tet_count++] = region;
  raw->regions = raw->regions || region != 0;
  return BW_OK;
}

bw_status bwi_raw_name_region(bwi_raw *raw, int32_t tag, bwi_word name) {
  if (!bw_grow(raw->context, (void **)&raw->named, &raw->named_capacity, raw->named_count, 1,
               sizeof *raw->named))
    return BW_MEMORY;
  bw_mesh_region *named = &raw->named[raw->named_count++];
  *named = (bw_mesh_region){.tag = tag};
  size_t length = name.length < BW_NAME ? name.length : BW_NAME - 1;
  while (length < name.length && length > 0 && (name.at[length] & 0xC0) == 0x80)
    length--; /* no half of a UTF-8 character */
  memcpy(named->name.text, name.at, length);
  return BW_OK;
}

/* By name, those of one name in the order of the file. */
static int by_name(const void *a, const void *b) {
  const bw_mesh_region *x = *(bw_mesh_region *const *)a, *y = *(bw_mesh_region *const *)b;
  int order = strcmp(x->name.text, y->name.text);
  return order ? order : (x > y) - (x < y);
}

static void append_tag(bwi_raw *raw, bw_mesh_region *region) {
  char *text = region->name.text, tag[16];
  size_t most = sizeof region->name.text - 1, length = strlen(text);
  size_t more = (size_t)snprintf(tag, sizeof tag, " (%d)", (int)region->tag);
  bw_warn(raw->context, "%s: two regions are called '%s'; that of the tag %d is '%.*s%s' here",
          raw->name, text, (int)region->tag, (int)(most - more), text, tag);
  length = length < most - more ? length : most - more;
  while (length > 0 && (text[length] & 0xC0) == 0x80)
    length--;
  memcpy(text + length, tag, more + 1);
}

/* A name that an earlier tag has is followed by its own tag. */
static bw_status separate_names(bwi_raw *raw) {
  bw_mesh_region **sorted = BW_NEW(raw->context, bw_mesh_region *, raw->named_count);
  if (!sorted)
    return BW_MEMORY;
  for (size_t i = 0; i < raw->named_count; i++)
    sorted[i] = &raw->named[i];
  qsort(sorted, raw->named_count, sizeof *sorted, by_name);
  for (size_t i = 1, first = 0; i < raw->named_count; i++)
    if (strcmp(sorted[first]->name.text, sorted[i]->name.text) != 0)
      first = i;
    else if (sorted[i]->tag != sorted[first]->tag)
      append_tag(raw, sorted[i]);
  bw_free(sorted);
  return BW_OK;
}

bw_status bwi_raw_facet(bwi_raw *raw, size_t corners, const int32_t *corner, int32_t group) {
  if (corners < 3 || corners > BWI_POLYGON_CORNERS) {
    raw->skipped++;
    return BW_OK;
  }
  if (!bw_grow(raw->context, (void **)&raw->facet, &raw->facet_capacity, raw->facet_used,
               corners + 2, sizeof *raw->facet))
    return BW_MEMORY;
  int32_t *to = raw->facet + raw->facet_used;
  to[0] = (int32_t)corners;
  to[1] = group;
  memcpy(to + 2, corner, corners * sizeof *corner);
  raw->facet_used += corners + 2;
  raw->facet_count++;
  return BW_OK;
}

static char *copy_word(bw_context *context, bwi_word word) {
  char *text = BW_NEW(context, char, word.length + 1);
  if (text) {
    memcpy(text, word.at, word.length);
    text[word.length] = 0;
  }
  return text;
}

bw_status bwi_raw_add_field(bwi_raw *raw, bwi_word name, bw_field_place place, bw_array *array) {
  char *text = NULL;
  if (!bw_grow(raw->context, (void **)&raw->field, &raw->field_capacity, raw->field_count, 1,
               sizeof *raw->field) ||
      !(text = copy_word(raw->context, name))) {
    bw_release(array);
    return BW_MEMORY;
  }
  raw->field[raw->field_count++] = (bwi_raw_field){text, place, array};
  return BW_OK;
}

bw_status bwi_raw_find_set(bwi_raw *raw, bwi_word name, bool of_elements, size_t *set) {
  for (size_t i = 0; i < raw->set_count; i++)
    if (raw->set[i].of_elements == of_elements && bwi_word_is_nocase(name, raw->set[i].name)) {
      *set = i;
      return BW_OK;
    }
  if (raw->set_count == BWI_MAX_SETS)
    return fail_file(raw, BW_LIMIT, "more than 10000 named sets");
  if (!bw_grow(raw->context, (void **)&raw->set, &raw->set_capacity, raw->set_count, 1,
               sizeof *raw->set))
    return BW_MEMORY;
  char *text = copy_word(raw->context, name);
  if (!text)
    return BW_MEMORY;
  *set = raw->set_count;
  raw->set[raw->set_count++] = (bwi_raw_set){text, of_elements, NULL, 0, 0};
  return BW_OK;
}

bw_status bwi_raw_member(bwi_raw *raw, size_t set, int32_t member) {
  bwi_raw_set *to = &raw->set[set];
  if (!bw_grow(raw->context, (void **)&to->member, &to->capacity, to->count, 1, sizeof *to->member))
    return BW_MEMORY;
  to->member[to->count++] = member;
  return BW_OK;
}

/* ---- as a mesh ----------------------------------------------------------------------------- */

/* to[i]: the new number of point i, or -1. The points are moved together. */
static size_t drop_unused(bwi_raw *raw, int32_t *to) {
  size_t entries = raw->tet_count * (size_t)raw->width, kept = 0;
  for (size_t i = 0; i < raw->point_count; i++)
    to[i] = -1;
  for (size_t i = 0; i < entries; i++)
    to[raw->tet[i]] = 0;
  for (size_t i = 0; i < raw->point_count; i++)
    if (to[i] == 0) {
      memmove(raw->point + 3 * kept, raw->point + 3 * i, 3 * sizeof(double));
      to[i] = (int32_t)kept++;
    }
  for (size_t i = 0; i < entries; i++)
    raw->tet[i] = to[raw->tet[i]];
  return kept;
}

static bw_status keep_rows(bw_context *context, bw_array **array, const int32_t *to, size_t kept) {
  bw_array *old = *array, *fresh;
  bw_status status = bw_array_create(context, old->type, (int64_t)kept, old->columns, &fresh);
  if (status != BW_OK)
    return status;
  size_t bytes = (size_t)old->columns * bw_type_size(old->type);
  for (int64_t i = 0; i < old->rows; i++)
    if (to[i] >= 0)
      memcpy((char *)fresh->data + (size_t)to[i] * bytes, (char *)old->data + (size_t)i * bytes,
             bytes);
  bw_release(old);
  *array = fresh;
  return BW_OK;
}

/* New numbers, ascending, each once. */
static void tidy_set(bwi_raw_set *set, const int32_t *to) {
  size_t kept = 0, once = 0;
  for (size_t i = 0; i < set->count; i++) {
    int32_t member = set->of_elements ? set->member[i] : to[set->member[i]];
    if (member >= 0)
      set->member[kept++] = member;
  }
  if (kept)
    bwi_sort_columns(set->member, (int64_t)kept);
  for (size_t i = 0; i < kept; i++)
    if (i == 0 || set->member[i] != set->member[i - 1])
      set->member[once++] = set->member[i];
  set->count = once;
}

/* An element field "region" of whole numbers, which is how formats without tags carry them. */
static void adopt_region(bwi_raw *raw) {
  for (size_t f = 0; f < raw->field_count; f++) {
    bwi_raw_field *field = &raw->field[f];
    const bw_array *array = field->array;
    if (field->place != BW_ON_ELEMENTS || strcmp(field->name, "region") != 0 ||
        array->columns != 1 || raw->regions)
      continue;
    for (int64_t i = 0; i < array->rows; i++) {
      double value = bw_array_get(array, i, 0);
      if (!(fabs(value) <= INT32_MAX) || value != floor(value))
        return;
    }
    for (int64_t i = 0; i < array->rows; i++)
      raw->region[i] = (int32_t)bw_array_get(array, i, 0);
    raw->regions = true;
    bw_free(field->name);
    bw_release(field->array);
    memmove(field, field + 1, (--raw->field_count - f) * sizeof *field);
    return;
  }
}

/* The failure at hand, with the name of the file before it and its details kept. */
static void name_file_in_failure(const bwi_raw *raw, bw_status status) {
  enum { MAX_KEYS = 8 };
  char key[MAX_KEYS][32];
  double number[MAX_KEYS];
  int count = 0;
  const char *word, *text;
  for (int i = 0; count < MAX_KEYS && bw_detail(raw->context, i, &word, &number[count], &text); i++)
    if (!text)
      snprintf(key[count++], sizeof key[0], "%s", word);
  bw_fail(raw->context, status, "%s: %s", raw->name, bw_message(raw->context));
  bw_detail_text(raw->context, "file", raw->name);
  for (int i = 0; i < count; i++)
    bw_detail_number(raw->context, key[i], number[i]);
}

static bw_status move_extras(bwi_raw *raw, bw_mesh_file *file) {
  file->field_name = BW_NEW0(raw->context, char *, raw->field_count);
  file->field_place = BW_NEW0(raw->context, bw_field_place, raw->field_count);
  file->field_array = BW_NEW0(raw->context, bw_array *, raw->field_count);
  file->set = BW_NEW0(raw->context, bw_named_set, raw->set_count);
  if (!file->field_name || !file->field_place || !file->field_array || !file->set)
    return BW_MEMORY;
  for (size_t i = 0; i < raw->field_count; i++) {
    file->field_name[i] = raw->field[i].name;
    file->field_place[i] = raw->field[i].place;
    file->field_array[i] = raw->field[i].array;
  }
  for (size_t i = 0; i < raw->set_count; i++)
    file->set[i] = (bw_named_set){raw->set[i].name, raw->set[i].of_elements,
                                  (int64_t)raw->set[i].count, raw->set[i].member};
  file->field_count = (int)raw->field_count;
  file->set_count = (int)raw->set_count;
  raw->field_count = raw->set_count = 0;
  return BW_OK;
}

bw_status bwi_raw_mesh(bwi_raw *raw, const char *format, bw_mesh_file *file) {
  bw_status status = BW_OK;
  bw_context *context = raw->context;
  int32_t *to = NULL;
  bw_mesh_regions regions = {0, NULL, NULL};
  memset(file, 0, sizeof *file);
  if (raw->tet_count == 0) {
    char text[200];
    snprintf(
        text, sizeof text,
        "the %s file holds no tetrahedra (but %zu points, %zu facets, %lld hexahedra, prisms or "
        "pyramids, %lld other elements)",
        format, raw->point_count, raw->facet_count, (long long)raw->solids,
        (long long)(raw->skipped - raw->solids));
    return fail_file(raw, BW_FORMAT, text);
  }
  if (raw->solids > 0) { /* without them it would be another body */
    char text[200];
    snprintf(
        text, sizeof text,
        "%lld hexahedra, prisms or pyramids beside %zu tetrahedra: a mesh has tetrahedra only; "
        "divide the others into tetrahedra first",
        (long long)raw->solids, raw->tet_count);
    return fail_file(raw, BW_UNSUPPORTED, text);
  }
  to = BW_NEW(context, int32_t, raw->point_count);
  if (!to)
    return BW_MEMORY;
  size_t kept = drop_unused(raw, to);
  for (size_t i = 0; i < raw->field_count && kept < raw->point_count; i++)
    if (raw->field[i].place == BW_ON_NODES)
      BW_TRY(keep_rows(context, &raw->field[i].array, to, kept));
  for (size_t i = 0; i < raw->set_count; i++)
    tidy_set(&raw->set[i], to);
  adopt_region(raw);
  BW_TRY(separate_names(raw));
  if (raw->regions)
    BW_TRY(bw_mesh_regions_by_tag(context, (int64_t)raw->tet_count, raw->region,
                                  (int32_t)raw->named_count, raw->named, &regions));
  status = bw_mesh_adopt(context, raw->width == 10 ? 2 : 1, (int64_t)kept, raw->point,
                         (int64_t)raw->tet_count, raw->tet, &regions, &file->mesh);
  if (status != BW_OK) {
    if (status == BW_INVALID) /* a region has the name that another gets by its tag */
      status = BW_FORMAT;
    if (status != BW_MEMORY && status != BW_CANCELLED)
      name_file_in_failure(raw, status);
    goto done;
  }
  raw->point = NULL;
  raw->tet = NULL;
  BW_TRY(move_extras(raw, file));
  snprintf(file->info.format, sizeof file->info.format, "%s", format);
  file->info.skipped = raw->skipped + (int64_t)raw->facet_count;
done:
  bw_free(to);
  bw_mesh_regions_clear(&regions);
  if (status != BW_OK)
    bw_mesh_file_clear(file);
  return status;
}

void bw_mesh_file_clear(bw_mesh_file *file) {
  bw_release(file->mesh);
  for (int i = 0; i < file->field_count; i++) {
    bw_free(file->field_name[i]);
    bw_release(file->field_array[i]);
  }
  bw_free(file->field_name);
  bw_free(file->field_place);
  bw_free(file->field_array);
  for (int i = 0; i < file->set_count; i++) {
    bw_free(file->set[i].name);
    bw_free(file->set[i].member);
  }
  bw_free(file->set);
  bw_free(file->node_from);
  bw_free(file->element_from);
  memset(file, 0, sizeof *file);
}

/* ---- as a surface -------------------------------------------------------------------------- */

bw_status bwi_mesh_file_surface(bw_context *context, bw_mesh_file *file, bw_surface **surface,
                                bw_read_info *info) {
  bw_status status = bw_mesh_boundary(context, file->mesh, surface, NULL);
  if (status == BW_OK && info) {
    *info = file->info;
    info->group_count = 1;
  }
  bw_mesh_file_clear(file);
  return status;
}

static bw_status boundary(bwi_raw *raw, const char *format, bw_surface **surface,
                          bw_read_info *info) {
  bw_mesh_file file;
  bw_status status = bwi_raw_mesh(raw, format, &file);
  return status == BW_OK ? bwi_mesh_file_surface(raw->context, &file, surface, info) : status;
}

bw_status bwi_raw_surface(bwi_raw *raw, const char *format, bw_surface **surface,
                          bw_read_info *info) {
  if (raw->tet_count > 0)
    return boundary(raw, format, surface, info);
  bw_status status = BW_OK;
  bwi_soup soup;
  bwi_soup_init(&soup, raw->context, raw->name);
  soup.point = raw->point;
  soup.point_count = raw->point_count;
  soup.point_capacity = raw->point_capacity;
  soup.skipped = raw->skipped;
  raw->point = NULL;
  raw->point_count = 0;
  for (size_t i = 0; i < raw->facet_used; i += (size_t)raw->facet[i] + 2) {
    size_t first = soup.triangle_count;
    BW_TRY(bwi_soup_polygon(&soup, raw->facet + i + 2, (size_t)raw->facet[i]));
    bwi_soup_regroup(&soup, first, raw->facet[i + 1]);
  }
  BW_TRY(bwi_soup_finish(&soup, format, false, surface, info));
done:
  bwi_soup_clear(&soup);
  return status;
}
