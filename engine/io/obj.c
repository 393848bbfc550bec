/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* Wavefront OBJ: vertices "v x y z [w] [colour]", facets "f" of corners v, v/vt, v//vn or v/vt/vn,
 * numbered from 1, or from -1 backwards from the last vertex before the facet. Two passes, so that
 * facets may stand before their vertices. "g" and "o" begin a group, whose name is the rest
 * of the line; groups of one name are one. Texture, normals, materials, smoothing are ignored;
 * lines, points and free-form elements are counted as skipped. */
#include "io/surface_write.h"
#include "outline/internal.h"

#include <string.h>

typedef struct obj_line {
  unsigned char *joined; /* scratch for a line continued by a backslash */
  size_t capacity;
} obj_line;

/* The next logical line: physical lines that end in a backslash are joined with the one after. */
static bw_status next_line(bwi_cursor *cursor, obj_line *scratch, bwi_cursor *line, bool *any) {
  *any = bwi_next_line(cursor, line);
  if (!*any || line->at == line->end || line->end[-1] != '\\')
    return BW_OK;
  size_t used = 0;
  bwi_cursor part = *line;
  for (bool more = true; more;) {
    size_t length = (size_t)(part.end - part.at);
    more = length > 0 && part.end[-1] == '\\';
    if (!bw_grow(cursor->context, (void **)&scratch->joined, &scratch->capacity, used, length + 1,
                 1))
      return BW_MEMORY;
    memcpy(scratch->joined + used, part.at, length);
    used += length;
    if (more) {
      scratch->joined[used - 1] = ' ';
      more = bwi_next_line(cursor, &part);
    }
  }
  line->begin = line->at = scratch->joined;
  line->end = scratch->joined + used;
  return BW_OK;
}

static bw_status read_vertices(bwi_cursor *cursor, bwi_soup *soup, obj_line *scratch) {
  bw_status status = BW_OK;
  bwi_cursor line;
  bwi_word word;
  bool any;
  for (int64_t i = 0;; i++) {
    BW_TRY(next_line(cursor, scratch, &line, &any));
    if (!any)
      break;
    bwi_next_word(&line, &word);
    if (bwi_word_is(word, "v")) {
      double x[3];
      static const char *const what[3] = {"the x coordinate of a vertex",
                                          "the y coordinate of a vertex",
                                          "the z coordinate of a vertex"};
      for (int k = 0; k < 3; k++)
        BW_TRY(bwi_read_real(&line, &x[k], what[k]));
      BW_TRY(bwi_soup_point(soup, x));
    }
    if (i % 65536 == 0)
      BW_TRY(bw_check_cancel(cursor->context));
  }
done:
  return status;
}

/* The vertex of a corner "v", "v/vt", "v//vn" or "v/vt/vn". */
static bw_status read_corner(const bwi_cursor *line, bwi_word word, int64_t before, int64_t all,
                             int32_t *corner) {
  int64_t number;
  const unsigned char *after, *end = word.at + word.length;
  bool good = bwi_parse_integer(word.at, end, &number, &after);
  for (int slash = 0; good && after < end; slash++) {
    int64_t other;
    good = slash < 2 && *after++ == '/';
    if (good && after < end && *after != '/')
      good = bwi_parse_integer(after, end, &other, &after);
  }
  if (!good)
    return bwi_fail_word(line, word, "a corner of a facet (v, v/vt, v//vn or v/vt/vn)");
  int64_t place = number > 0 ? number - 1 : before + number;
  if (number == 0 || place < 0 || place >= all) {
    bw_status status = bwi_fail_line(
        line, "a facet names vertex %lld, but there are %lld vertices %s, numbered from 1",
        (long long)number, (long long)(number < 0 ? before : all),
        number < 0 ? "before it" : "in the file");
    bw_detail_number(line->context, "vertex", (double)number);
    return status;
  }
  *corner = (int32_t)place;
  return BW_OK;
}

/* Groups of facets, each of which began at a "g" or "o", and those of one name as one. */
typedef struct obj_names {
  int32_t *number; /* (begun) of the group of that name */
  size_t begun, number_capacity;
  bw_name *name; /* (count) different ones, but for empty ones */
  size_t count, capacity;
  int32_t *slot; /* (slots) hash table: 1 + the index of a name, or 0 */
  size_t slots;
  bw_name now; /* of facets that follow */
} obj_names;

/* The rest of a line "g name" or "o name". */
static void read_name(bwi_cursor line, bw_name *name) {
  const unsigned char *end = line.end;
  while (line.at < end && (*line.at == ' ' || *line.at == '\t'))
    line.at++;
  while (end > line.at && (end[-1] == ' ' || end[-1] == '\t' || end[-1] == '\r'))
    end--;
  *name = bwi_name((const char *)line.at, (size_t)(end - line.at));
}

/* The slot of a name in the hash table (FNV-1a, linear probing): its own or a free one. */
static int32_t *find_slot(const obj_names *names, const bw_name *name) {
  uint64_t hash = 14695981039346656037u;
  for (const char *c = name->text; *c; c++)
    hash = (hash ^ (unsigned char)*c) * 1099511628211u;
  size_t at = (size_t)(hash % names->slots);
  while (names->slot[at] && strcmp(names->name[names->slot[at] - 1].text, name->text) != 0)
    at = at + 1 < names->slots ? at + 1 : 0;
  return &names->slot[at];
}

/* At most half of the slots are in use. */
static bw_status grow_slots(bw_context *context, obj_names *names) {
  if (2 * (names->count + 1) <= names->slots)
    return BW_OK;
  const size_t slots = 4 * names->count + 64;
  int32_t *slot = BW_NEW0(context, int32_t, slots);
  if (!slot)
    return BW_MEMORY;
  bw_free(names->slot);
  names->slot = slot;
  names->slots = slots;
  for (size_t i = 0; i < names->count; i++)
    if (names->name[i].text[0])
      *find_slot(names, &names->name[i]) = (int32_t)i + 1;
  return BW_OK;
}

/* The group of the facet that was read last. */
static bw_status keep_name(bw_context *context, const bwi_soup *soup, obj_names *names) {
  bw_status status = BW_OK;
  if (names->begun > (size_t)soup->current_group)
    return BW_OK;
  BW_TRY_MEMORY(bw_grow(context, (void **)&names->number, &names->number_capacity, names->begun, 1,
                        sizeof *names->number));
  BW_TRY(grow_slots(context, names));
  int32_t *slot = names->now.text[0] ? find_slot(names, &names->now) : NULL;
  if (!slot || !*slot) {
    BW_TRY_MEMORY(bw_grow(context, (void **)&names->name, &names->capacity, names->count, 1,
                          sizeof *names->name));
    names->name[names->count++] = names->now;
    if (slot)
      *slot = (int32_t)names->count;
  }
  names->number[names->begun++] = slot ? *slot - 1 : (int32_t)names->count - 1;
done:
  return status;
}

/* Groups of one name become one, and the surface, which was just made, gets the names. */
static bw_status name_groups(bw_context *context, const obj_names *names, bw_surface *surface,
                             bw_read_info *info) {
  if (!surface->group)
    return BW_OK;
  if (info)
    info->group_count = (int32_t)names->count;
  if (names->count < 2) {
    bw_free(surface->group);
    surface->group = NULL;
    return BW_OK;
  }
  for (int32_t t = 0; t < surface->triangle_count; t++)
    surface->group[t] = names->number[surface->group[t]];
  return bw_face_names_create(context, (int32_t)names->count, names->name, NULL, &surface->names);
}

static bw_status read_facets(bwi_cursor *cursor, bwi_soup *soup, obj_line *scratch,
                             obj_names *names) {
  bw_status status = BW_OK;
  bwi_cursor line;
  bwi_word word;
  bool any;
  int64_t before = 0;
  int32_t *corner = NULL;
  size_t capacity = 0;
  for (int64_t i = 0;; i++) {
    BW_TRY(next_line(cursor, scratch, &line, &any));
    if (!any)
      break;
    bwi_next_word(&line, &word);
    if (word.length == 0 || *word.at == '#')
      continue;
    if (bwi_word_is(word, "v")) {
      before++;
    } else if (bwi_word_is(word, "f") || bwi_word_is(word, "fo")) {
      size_t count = 0;
      while (bwi_next_word(&line, &word) && *word.at != '#') {
        if (count == BWI_POLYGON_CORNERS)
          BW_TRY(bwi_fail_line(&line, "a facet of more than %d corners", BWI_POLYGON_CORNERS));
        BW_TRY_MEMORY(
            bw_grow(cursor->context, (void **)&corner, &capacity, count, 1, sizeof *corner));
        BW_TRY(read_corner(&line, word, before, (int64_t)soup->point_count, &corner[count]));
        count++;
      }
      if (count < 3)
        BW_TRY(bwi_fail_line(&line, "a facet of %zu corners: at least three were expected", count));
      BW_TRY(bwi_soup_polygon(soup, corner, count));
      BW_TRY(keep_name(cursor->context, soup, names));
    } else if (bwi_word_is(word, "g") || bwi_word_is(word, "o")) {
      bwi_soup_next_group(soup);
      read_name(line, &names->now);
    } else if (bwi_word_is(word, "l") || bwi_word_is(word, "p") || bwi_word_is(word, "curv") ||
               bwi_word_is(word, "curv2") || bwi_word_is(word, "surf")) {
      soup->skipped++;
    }
    if (i % 65536 == 0)
      BW_TRY(bw_check_cancel(cursor->context));
  }
done:
  bw_free(corner);
  return status;
}

bw_status bwi_obj_parse(bwi_cursor *cursor, bw_surface **surface, bw_read_info *info) {
  bw_status status = BW_OK;
  bwi_cursor again = *cursor;
  obj_line scratch = {NULL, 0};
  obj_names names = {.number = NULL};
  bwi_soup soup;
  bwi_soup_init(&soup, cursor->context, cursor->name);
  BW_TRY(read_vertices(cursor, &soup, &scratch));
  BW_TRY(read_facets(&again, &soup, &scratch, &names));
  BW_TRY(bwi_soup_finish(&soup, "OBJ", false, surface, info));
  status = name_groups(cursor->context, &names, *surface, info);
  if (status != BW_OK) {
    bw_release(*surface);
    *surface = NULL;
  }
done:
  bw_free(names.number);
  bw_free(names.slot);
  bw_free(names.name);
  bwi_soup_clear(&soup);
  bw_free(scratch.joined);
  return status;
}

bw_status bwi_obj_write(bw_writer *writer, const bw_surface *surface,
                        const bw_surface_write_options *options) {
  bw_writer_print(writer, "# barwright: %d vertices, %d facets\n", (int)surface->point_count,
                  (int)surface->triangle_count);
  for (int32_t i = 0; i < surface->point_count; i++) {
    bw_writer_bytes(writer, "v", 1);
    for (size_t k = 0; k < 3; k++) {
      bw_writer_bytes(writer, " ", 1);
      bw_writer_number(writer, surface->point[3 * (size_t)i + k]);
    }
    for (size_t k = 0; options->colour && k < 3; k++)
      bw_writer_print(writer, " %.4g", options->colour[3 * (size_t)i + k] / 255.0);
    bw_writer_bytes(writer, "\n", 1);
  }
  const bw_face_names *names = surface->names;
  for (int32_t i = 0; i < surface->triangle_count; i++) {
    if (surface->group && (i == 0 || surface->group[i] != surface->group[i - 1])) {
      int32_t g = surface->group[i];
      if (names && g >= 0 && g < names->count && names->name[g].text[0])
        bw_writer_print(writer, "g %s\n", names->name[g].text);
      else
        bw_writer_print(writer, "g group_%d\n", (int)g);
    }
    bw_writer_bytes(writer, "f", 1);
    for (size_t k = 0; k < 3; k++) {
      bw_writer_bytes(writer, " ", 1);
      bw_writer_integer(writer, surface->triangle[3 * (size_t)i + k] + (int64_t)1);
    }
    bw_writer_bytes(writer, "\n", 1);
  }
  return bw_writer_bytes(writer, NULL, 0);
}
