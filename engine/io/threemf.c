/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* 3MF: a ZIP archive that holds a model as XML. Each mesh that the items to be built reach is a
 * group. Written is one object for each group, where groups share no points, else one object.
 *
 * Archives of hostile origin: a model may be packed by no more than PACKED to one, and components
 * may repeat meshes to no more than REPEATED times the size of the models. */
#include "io/threemf.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "barwright/job.h"
#include "io/growing.h"
#include "io/surface_write.h"
#include "io/vtu.h"
#include "io/zip.h"

enum { PACKED = 200, REPEATED = 100, SLACK = 1 << 20, FACET_BYTES = 60 };

/* ---- the archive ----------------------------------------------------------------------------- */

/* A member as a cursor; *owned to be freed. */
static bw_status open_part(const bwi_cursor *archive, const char *member, char name[512],
                           bwi_cursor *cursor, unsigned char **owned) {
  bwi_zip_member found = {.name = member};
  const unsigned char *bytes = NULL;
  *owned = NULL;
  bw_status status = bwi_zip_find(archive, true, 1, &found);
  if (status != BW_OK)
    return status;
  bwi_cursor whole = *archive;
  whole.at = whole.begin;
  if (!found.found)
    return bwi_fail_byte(&whole, "the archive has no member '%.200s': a 3MF file was expected",
                         member);
  double memory = bw_available_memory();
  if (found.size / PACKED > found.packed + SLACK / PACKED ||
      (memory > 0 && (double)found.size > memory / 2)) {
    bwi_fail_byte(&whole,
                  "'%.200s' unpacks from %llu to %llu bytes: no plausible model does that, or it "
                  "takes more than half of the memory that is free",
                  member, (unsigned long long)found.packed, (unsigned long long)found.size);
    return BW_LIMIT;
  }
  status = bwi_zip_open(archive, &found, &bytes, owned);
  snprintf(name, 512, "%.300s: %.200s", archive->name, member);
  if (status == BW_OK)
    bwi_cursor_init(cursor, archive->context, name, bytes, (size_t)found.size);
  return status;
}

/* The member that the package names as its model. */
static bw_status find_root(const bwi_cursor *archive, bwi_3mf *file) {
  bw_status status = BW_OK;
  unsigned char *owned = NULL;
  char name[512];
  bwi_cursor cursor;
  bwi_tag tag;
  bool any = true;
  BW_TRY(open_part(archive, "_rels/.rels", name, &cursor, &owned));
  while (file->part_count == 0) {
    BW_TRY(bwi_xml_next(&cursor, &tag, &any));
    if (!any)
      break;
    bwi_word type = bwi_xml_value(&tag, "Type"), target = bwi_xml_value(&tag, "Target");
    static const char ending[] = "/3dmodel";
    size_t length = sizeof ending - 1;
    if (type.length < length || target.length == 0 ||
        memcmp(type.at + type.length - length, ending, length) != 0)
      continue;
    if (*target.at == '/')
      target.at++, target.length--;
    BW_TRY_MEMORY(file->part[0] = BW_NEW(file->context, char, target.length + 1));
    memcpy(file->part[0], target.at, target.length);
    file->part[0][target.length] = 0;
    bwi_xml_decode(file->part[0]);
    file->part_count = 1;
  }
  if (file->part_count == 0)
    status = bwi_fail_line(&cursor, "the archive names no 3D model: a 3MF file was expected");
done:
  bw_free(owned);
  return status;
}

/* ---- from objects to a surface --------------------------------------------------------------- */

static int compare_objects(const void *left, const void *right) {
  const bwi_3mf_object *a = (const bwi_3mf_object *)left, *b = (const bwi_3mf_object *)right;
  return a->part != b->part ? (a->part > b->part) - (a->part < b->part)
                            : (a->id > b->id) - (a->id < b->id);
}

/* So that find_object finds them. */
static bw_status sort_objects(bwi_3mf *file) {
  if (file->object_count > 1)
    qsort(file->object, file->object_count, sizeof *file->object, compare_objects);
  for (size_t i = 1; i < file->object_count; i++)
    if (compare_objects(&file->object[i - 1], &file->object[i]) == 0)
      return bw_fail(file->context, BW_FORMAT, "%s: two objects of the number %lld", file->name,
                     (long long)file->object[i].id);
  return BW_OK;
}

static bwi_3mf_object *find_object(bwi_3mf *file, const bwi_3mf_use *use) {
  const bwi_3mf_object wanted = {.id = use->id, .part = use->part};
  return file->object_count == 0
             ? NULL
             : (bwi_3mf_object *)bsearch(&wanted, file->object, file->object_count,
                                         sizeof *file->object, compare_objects);
}

static bw_status fail_use(const bwi_3mf *file, const bwi_3mf_use *use, const char *what) {
  bw_fail(file->context, BW_FORMAT, "%s: %.200s:%lld: object %lld %s", file->name,
          file->part[use->part], (long long)use->line, (long long)use->id, what);
  bw_detail_text(file->context, "file", file->name);
  return BW_FORMAT;
}

/* How many facets a use makes; cycles and missing objects are found on the way. */
static bw_status count_facets(bwi_3mf *file, const bwi_3mf_use *use, int depth, double *count) {
  bwi_3mf_object *object = find_object(file, use);
  if (!object)
    return fail_use(file, use, "is not in the file");
  if (object->open)
    return fail_use(file, use, "is a component of itself");
  if (depth > BWI_3MF_DEPTH)
    return fail_use(file, use, "lies in more than 64 objects, one inside the other");
  bw_status status = BW_OK;
  if (!object->counted) {
    double all = object->ignored ? 0 : (double)object->facet_count;
    object->open = 1;
    for (size_t k = 0; k < object->use_count && !object->ignored && status == BW_OK; k++) {
      double more = 0;
      status = count_facets(file, &file->use[object->first_use + k], depth + 1, &more);
      all += more;
    }
    object->open = 0;
    object->facets = all;
    object->counted = status == BW_OK;
  }
  *count = object->facets;
  return status;
}

/* x -> (x A) B: first a, then b. */
static void compose(const double a[12], const double b[12], double out[12]) {
  for (size_t i = 0; i < 4; i++)
    for (size_t j = 0; j < 3; j++) {
      double sum = i == 3 ? b[9 + j] : 0;
      for (size_t k = 0; k < 3; k++)
        sum += a[3 * i + k] * b[3 * k + j];
      out[3 * i + j] = sum;
    }
}

static double determinant(const double t[12]) {
  return t[0] * (t[4] * t[8] - t[5] * t[7]) - t[1] * (t[3] * t[8] - t[5] * t[6]) +
         t[2] * (t[3] * t[7] - t[4] * t[6]);
}

static bw_status place_mesh(const bwi_3mf *file, const bwi_3mf_object *object, const double t[12],
                            bwi_soup *soup) {
  bw_status status = BW_OK;
  size_t first = soup->point_count;
  bool mirrored = determinant(t) < 0;
  if (first + object->point_count > INT32_MAX)
    return bw_fail(file->context, BW_LIMIT, "%s: more than 2147483647 points", file->name);
  for (size_t i = 0; i < object->point_count; i++) {
    const double *from = file->point + 3 * (object->first_point + i);
    double x[3];
    for (size_t j = 0; j < 3; j++)
      x[j] = from[0] * t[j] + from[1] * t[3 + j] + from[2] * t[6 + j] + t[9 + j];
    if (!isfinite(x[0]) || !isfinite(x[1]) || !isfinite(x[2]))
      return bw_fail(file->context, BW_GEOMETRY, "%s: a transform makes a coordinate infinite",
                     file->name);
    BW_TRY(bwi_soup_point(soup, x));
  }
  bwi_soup_next_group(soup);
  for (size_t i = 0; i < object->facet_count; i++) {
    const int32_t *corner = file->facet + 3 * (object->first_facet + i);
    int32_t v[3] = {(int32_t)first + corner[0], (int32_t)first + corner[1],
                    (int32_t)first + corner[2]};
    BW_TRY(bwi_soup_triangle(soup, v[0], v[mirrored ? 2 : 1], v[mirrored ? 1 : 2]));
  }
done:
  return status;
}

/* That of the next group. */
static bw_status keep_name(bwi_3mf *file, const bw_name *name) {
  if (!bw_grow(file->context, (void **)&file->group_name, &file->name_capacity, file->name_count, 1,
               sizeof *name))
    return BW_MEMORY;
  file->group_name[file->name_count++] = *name;
  return BW_OK;
}

/* The mesh of a use and those of its components, whose counts are known. */
static bw_status place(bwi_3mf *file, const bwi_3mf_use *use, const double *outer, bwi_soup *soup,
                       bool named) {
  const bwi_3mf_object *object = find_object(file, use);
  double t[12];
  memcpy(t, use->transform, sizeof t);
  if (outer)
    compose(use->transform, outer, t);
  if (object->ignored)
    soup->skipped++;
  if (object->facets == 0)
    return BW_OK;
  bw_status status = BW_OK;
  if (object->facet_count > 0) {
    status = place_mesh(file, object, t, soup);
    if (named && status == BW_OK)
      status = keep_name(file, &object->name);
  }
  for (size_t k = 0; k < object->use_count && status == BW_OK; k++)
    status = place(file, &file->use[object->first_use + k], t, soup, named);
  return status;
}

static bw_status place_all(bwi_3mf *file, bwi_soup *soup, bool named) {
  bw_status status = BW_OK;
  double all = 0, memory = bw_available_memory();
  for (size_t i = 0; i < file->item_count; i++) {
    double count = 0;
    BW_TRY(count_facets(file, &file->item[i], 0, &count));
    all += count;
  }
  if (FACET_BYTES * all > (double)REPEATED * (double)file->bytes + SLACK ||
      (memory > 0 && 4 * FACET_BYTES * all > memory)) {
    bw_fail(file->context, BW_LIMIT,
            "%s: components repeat meshes to %.0f facets, from models of %zu bytes: no plausible "
            "file does that, or it takes more than the memory that is free",
            file->name, all, file->bytes);
    bw_detail_text(file->context, "file", file->name);
    return BW_LIMIT;
  }
  for (size_t i = 0; i < file->item_count && status == BW_OK; i++)
    status = place(file, &file->item[i], NULL, soup, named);
done:
  return status;
}

bw_status bwi_3mf_parse(bwi_cursor *archive, bw_surface **surface, bw_read_info *info) {
  bw_status status = BW_OK;
  bwi_soup soup;
  bwi_3mf file = {.context = archive->context, .name = archive->name};
  bwi_soup_init(&soup, archive->context, archive->name);
  BW_TRY(find_root(archive, &file));
  for (int part = 0; part < file.part_count; part++) {
    unsigned char *owned;
    char name[512];
    bwi_cursor cursor;
    status = open_part(archive, file.part[part], name, &cursor, &owned);
    if (status == BW_OK) {
      file.bytes += (size_t)(cursor.end - cursor.begin);
      status = bwi_3mf_model(&cursor, part, &file);
    }
    bw_free(owned);
    BW_TRY(status);
  }
  BW_TRY(sort_objects(&file));
  BW_TRY(place_all(&file, &soup, info != NULL));
  soup.skipped += file.skipped;
  BW_TRY(bwi_soup_finish(&soup, "3MF", false, surface, info));
  if (info) {
    info->unit = file.unit;
    info->group_name = file.group_name;
    file.group_name = NULL;
  }
done:
  bwi_soup_clear(&soup);
  for (int part = 0; part < file.part_count; part++)
    bw_free(file.part[part]);
  bw_free(file.group_name);
  bw_free(file.object);
  bw_free(file.point);
  bw_free(file.facet);
  bw_free(file.use);
  bw_free(file.item);
  return status;
}

/* ---- writing --------------------------------------------------------------------------------- */

static const char *unit_name(double metres) {
  return metres == 1e-6     ? "micron"
         : metres == 1e-3   ? "millimeter"
         : metres == 1e-2   ? "centimeter"
         : metres == 0.0254 ? "inch"
         : metres == 0.3048 ? "foot"
         : metres == 1      ? "meter"
                            : NULL;
}

/* The colours of the materials extension, once each, and which of them a point or facet has. */
typedef struct palette {
  uint32_t *entry; /* 0xRRGGBB */
  int32_t *of;     /* (point_count or triangle_count) NULL: no colours */
  size_t count, capacity;
} palette;

enum { PALETTE = 1 }; /* the number of its resource, before those of objects */

static uint32_t colour_at(const unsigned char *colour, int64_t i) {
  return (uint32_t)colour[3 * i] << 16 | (uint32_t)colour[3 * i + 1] << 8 | colour[3 * i + 2];
}

/* In the order of their first use. */
static bw_status find_palette(bw_context *context, const unsigned char *colour, int64_t count,
                              palette *p) {
  bw_status status = BW_OK;
  enum { COLOURS = 1 << 24 };
  int32_t *number = BW_NEW0(context, int32_t, COLOURS);
  p->of = BW_NEW(context, int32_t, count + 1);
  BW_TRY_MEMORY(number && p->of);
  for (int64_t i = 0; i < count; i++) {
    uint32_t value = colour_at(colour, i);
    if (number[value] == 0) {
      BW_TRY_MEMORY(
          bw_grow(context, (void **)&p->entry, &p->capacity, p->count, 1, sizeof *p->entry));
      p->entry[p->count++] = value;
      number[value] = (int32_t)p->count;
    }
    p->of[i] = number[value] - 1;
  }
done:
  bw_free(number);
  return status;
}

static void print_palette(bwi_growing *text, const palette *p) {
  bwi_growing_print(text, "<m:colorgroup id=\"%d\">\n", PALETTE);
  for (size_t i = 0; i < p->count; i++)
    bwi_growing_print(text, "<m:color color=\"#%06X\"/>\n", (unsigned)p->entry[i]);
  bwi_growing_print(text, "</m:colorgroup>\n");
}

typedef struct writing {
  const bw_surface *surface;
  palette colours;
  bool on_facets;
  int32_t *object_of, *local; /* of points: object, number in it */
  int32_t count;              /* of objects */
} writing;

static int resource_of(const writing *w, int32_t object) {
  return (int)object + (w->colours.of ? PALETTE + 1 : 1);
}

static void print_facet(bwi_growing *text, const writing *w, int32_t i) {
  const int32_t *v = w->surface->triangle + 3 * (size_t)i, *of = w->colours.of;
  bwi_growing_print(text, "<triangle v1=\"%d\" v2=\"%d\" v3=\"%d\"", (int)w->local[v[0]],
                    (int)w->local[v[1]], (int)w->local[v[2]]);
  if (of && w->on_facets)
    bwi_growing_print(text, " pid=\"%d\" p1=\"%d\"", PALETTE, (int)of[i]);
  else if (of)
    bwi_growing_print(text, " pid=\"%d\" p1=\"%d\" p2=\"%d\" p3=\"%d\"", PALETTE, (int)of[v[0]],
                      (int)of[v[1]], (int)of[v[2]]);
  bwi_growing_print(text, "/>\n");
}

static void print_object(bwi_growing *text, const writing *w, int32_t object) {
  const bw_surface *surface = w->surface;
  int32_t count = 0;
  bwi_growing_print(text, "<object id=\"%d\" type=\"model\" name=\"group %d\"",
                    resource_of(w, object), (int)object + 1);
  if (w->colours.of)
    bwi_growing_print(text, " pid=\"%d\" pindex=\"0\"", PALETTE);
  bwi_growing_print(text, "><mesh><vertices>\n");
  for (int32_t i = 0; i < surface->point_count; i++) {
    if (w->object_of[i] != object)
      continue;
    const double *x = surface->point + 3 * (size_t)i;
    w->local[i] = count++;
    for (int k = 0; k < 3; k++) {
      bwi_growing_print(text, "%s%c=\"", k ? " " : "<vertex ", "xyz"[k]);
      bwi_growing_number(text, x[k]);
      bwi_growing_print(text, "\"");
    }
    bwi_growing_print(text, "/>\n");
  }
  bwi_growing_print(text, "</vertices><triangles>\n");
  for (int32_t i = 0; i < surface->triangle_count; i++)
    if (w->object_of[surface->triangle[3 * (size_t)i]] == object)
      print_facet(text, w, i);
  bwi_growing_print(text, "</triangles></mesh></object>\n");
}

bw_status bwi_3mf_write(bw_context *context, const bw_surface *surface, const char *path,
                        const bw_surface_write_options *options) {
  static const char types[] =
      "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n"
      "<Types xmlns=\"http://schemas.openxmlformats.org/package/2006/content-types\">"
      "<Default Extension=\"rels\" "
      "ContentType=\"application/vnd.openxmlformats-package.relationships+xml\"/>"
      "<Default Extension=\"model\" "
      "ContentType=\"application/vnd.ms-package.3dmanufacturing-3dmodel+xml\"/></Types>\n";
  static const char relations[] =
      "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n"
      "<Relationships xmlns=\"http://schemas.openxmlformats.org/package/2006/relationships\">"
      "<Relationship Id=\"rel0\" Target=\"/3D/3dmodel.model\" "
      "Type=\"http://schemas.microsoft.com/3dmanufacturing/2013/01/3dmodel\"/></Relationships>\n";
  bw_status status = BW_OK;
  bw_writer *writer = NULL;
  bwi_growing text = {.context = context};
  const double unit = options->unit > 0 ? options->unit : 1;
  writing w = {.surface = surface, .on_facets = options->colour_on_facets, .count = 1};
  if (!unit_name(unit))
    return bw_fail(context, BW_INVALID,
                   "%s: a unit of %g m is none of 3MF's: micron, millimeter, centimeter, inch, "
                   "foot or meter",
                   path, unit);
  w.object_of = BW_NEW(context, int32_t, surface->point_count + 1);
  w.local = BW_NEW(context, int32_t, surface->point_count + 1);
  BW_TRY_MEMORY(w.object_of && w.local);
  BW_TRY(bwi_surface_objects(context, surface, w.object_of, &w.count));
  if (options->colour)
    BW_TRY(find_palette(context, options->colour,
                        w.on_facets ? surface->triangle_count : surface->point_count, &w.colours));
  bwi_growing_print(
      &text,
      "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n<model unit=\"%s\" xml:lang=\"en\" "
      "xmlns=\"http://schemas.microsoft.com/3dmanufacturing/core/2015/02\"%s>\n"
      "<metadata name=\"Application\">barwright</metadata>\n<resources>\n",
      unit_name(unit),
      w.colours.of ? " xmlns:m=\"http://schemas.microsoft.com/3dmanufacturing/material/2015/02\""
                   : "");
  if (w.colours.of)
    print_palette(&text, &w.colours);
  for (int32_t k = 0; k < w.count; k++)
    print_object(&text, &w, k);
  bwi_growing_print(&text, "</resources>\n<build>\n");
  for (int32_t k = 0; k < w.count; k++)
    bwi_growing_print(&text, "<item objectid=\"%d\"/>\n", resource_of(&w, k));
  bwi_growing_print(&text, "</build>\n</model>\n");
  BW_TRY(text.status);
  bwi_zip_part part[] = {
      {.name = "[Content_Types].xml", .bytes = types, .count = sizeof types - 1, .deflate = true},
      {.name = "_rels/.rels", .bytes = relations, .count = sizeof relations - 1, .deflate = true},
      {.name = "3D/3dmodel.model", .bytes = text.at, .count = text.count, .deflate = true}};
  BW_TRY(bw_writer_open(context, path, &writer));
  BW_TRY(bwi_zip_write(writer, part, (int)(sizeof part / sizeof *part)));
  status = bw_writer_commit(writer);
  writer = NULL;
done:
  bw_writer_discard(writer);
  bw_free(text.at);
  bw_free(w.object_of);
  bw_free(w.local);
  bw_free(w.colours.entry);
  bw_free(w.colours.of);
  return status;
}

bw_status bw_surface_write_3mf(bw_context *context, const bw_surface *surface, const char *path,
                               double unit) {
  return bwi_3mf_write(context, surface, path, &(bw_surface_write_options){.unit = unit});
}
