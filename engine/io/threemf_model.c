/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* The model of a 3MF file, by the 3MF Core Specification 1.3, with the paths of the Production
 * Extension. Prefixes of names are not looked at. */
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "io/threemf.h"
#include "io/vtu.h"

/* Without its prefix. */
static bwi_word local_name(bwi_word name) {
  for (size_t i = name.length; i-- > 0;)
    if (name.at[i] == ':')
      return (bwi_word){name.at + i + 1, name.length - i - 1};
  return name;
}

static bwi_word value_of(const bwi_tag *tag, const char *key) {
  for (int i = 0; i < tag->count; i++)
    if (bwi_word_is(local_name(tag->key[i]), key))
      return tag->value[i];
  return (bwi_word){tag->name.at, 0};
}

static bw_status read_real(const bwi_cursor *cursor, const bwi_tag *tag, const char *key,
                           double *value) {
  bwi_word word = bwi_xml_value(tag, key);
  const unsigned char *after;
  if (word.length == 0 ||
      bwi_parse_real(word.at, word.at + word.length, value, &after) != BWI_NUMBER ||
      after != word.at + word.length)
    return bwi_fail_line(cursor, "%s=\"%s\" of a vertex: a finite number was expected", key,
                         word.length ? bwi_show(word) : "");
  return BW_OK;
}

static bw_status read_index(const bwi_cursor *cursor, const bwi_tag *tag, const char *key,
                            int64_t limit, const char *what, int64_t *value) {
  bwi_word word = bwi_xml_value(tag, key);
  const unsigned char *after;
  if (word.length == 0)
    return bwi_fail_line(cursor, "%s has no %s", what, key);
  if (!bwi_parse_integer(word.at, word.at + word.length, value, &after) ||
      after != word.at + word.length || *value < 0 || *value >= limit)
    return bwi_fail_line(cursor, "%s=\"%s\" of %s: an integer from 0 to %lld was expected", key,
                         bwi_show(word), what, (long long)limit - 1);
  return BW_OK;
}

/* The member that holds the object of a use: another one when it has a path. */
static bw_status find_part(const bwi_cursor *cursor, bwi_3mf *file, bwi_word path, int *part) {
  if (path.length > 0 && *path.at == '/')
    path.at++, path.length--;
  if (path.length == 0)
    return BW_OK;
  for (*part = 0; *part < file->part_count; ++*part)
    if (bwi_word_is_nocase(path, file->part[*part]))
      return BW_OK;
  if (file->part_count == BWI_3MF_PARTS)
    return bwi_fail_line(cursor, "the objects lie in more than %d members of the archive",
                         BWI_3MF_PARTS);
  char *copy = BW_NEW(file->context, char, path.length + 1);
  if (!copy)
    return BW_MEMORY;
  memcpy(copy, path.at, path.length);
  copy[path.length] = 0;
  bwi_xml_decode(copy);
  file->part[file->part_count++] = copy;
  return BW_OK;
}

/* A component or an item. */
static bw_status read_use(const bwi_cursor *cursor, const bwi_tag *tag, int part, bwi_3mf *file,
                          bwi_3mf_use *use) {
  static const double identity[12] = {1, 0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0};
  memcpy(use->transform, identity, sizeof identity);
  use->line = cursor->line;
  use->part = part;
  bw_status status =
      read_index(cursor, tag, "objectid", INT32_MAX, "a component or an item", &use->id);
  if (status == BW_OK)
    status = find_part(cursor, file, value_of(tag, "path"), &use->part);
  bwi_word text = bwi_xml_value(tag, "transform");
  const unsigned char *at = text.at, *end = text.at + text.length;
  for (int k = 0; status == BW_OK && text.length > 0 && k < 12; k++) {
    while (at < end && (*at == ' ' || *at == '\t' || *at == '\n' || *at == '\r'))
      at++;
    if (bwi_parse_real(at, end, &use->transform[k], &at) != BWI_NUMBER)
      status = bwi_fail_line(cursor, "transform=\"%s\": twelve finite numbers were expected",
                             bwi_show(text));
  }
  return status;
}

static bw_status read_unit(const bwi_cursor *cursor, const bwi_tag *tag, bwi_3mf *file) {
  static const struct {
    const char *name;
    double metres;
  } units[] = {{"micron", 1e-6}, {"millimeter", 1e-3}, {"centimeter", 1e-2},
               {"inch", 0.0254}, {"foot", 0.3048},     {"meter", 1}};
  bwi_word word = bwi_xml_value(tag, "unit");
  double unit = word.length ? 0 : 1e-3;
  for (size_t i = 0; i < sizeof units / sizeof *units; i++)
    if (bwi_word_is_nocase(word, units[i].name))
      unit = units[i].metres;
  if (unit == 0)
    return bwi_fail_line(cursor,
                         "the unit '%s' is none of 3MF's: micron, millimeter, centimeter, inch, "
                         "foot or meter",
                         bwi_show(word));
  if (file->unit != 0 && file->unit != unit) {
    bwi_fail_line(cursor, "the models of the archive have different units");
    return BW_UNSUPPORTED;
  }
  file->unit = unit;
  return BW_OK;
}

static bw_status begin_object(const bwi_cursor *cursor, const bwi_tag *tag, int part,
                              bwi_3mf *file) {
  bw_status status = BW_OK;
  BW_TRY_MEMORY(bw_grow(file->context, (void **)&file->object, &file->object_capacity,
                        file->object_count, 1, sizeof *file->object));
  bwi_3mf_object *object = &file->object[file->object_count];
  memset(object, 0, sizeof *object);
  BW_TRY(read_index(cursor, tag, "id", INT32_MAX, "an object", &object->id));
  object->part = part;
  object->first_point = file->point_count;
  object->first_facet = file->facet_count;
  object->first_use = file->use_count;
  bwi_word kind = bwi_xml_value(tag, "type"), name = bwi_xml_value(tag, "name");
  object->ignored = kind.length > 0 && !bwi_word_is(kind, "model") && !bwi_word_is(kind, "surface");
  size_t length = name.length < sizeof object->name.text ? name.length : 0;
  memcpy(object->name.text, name.at, length);
  object->name.text[length] = 0;
  bwi_xml_decode(object->name.text);
  file->object_count++;
done:
  return status;
}

static bw_status read_vertex(const bwi_cursor *cursor, const bwi_tag *tag, bwi_3mf *file) {
  static const char *const key[3] = {"x", "y", "z"};
  bw_status status = BW_OK;
  if (file->point_count >= INT32_MAX)
    return bw_fail(file->context, BW_LIMIT, "%s: more than 2147483647 vertices", file->name);
  BW_TRY_MEMORY(bw_grow(file->context, (void **)&file->point, &file->point_capacity,
                        file->point_count, 1, 3 * sizeof(double)));
  for (int k = 0; k < 3; k++)
    BW_TRY(read_real(cursor, tag, key[k], &file->point[3 * file->point_count + (size_t)k]));
  file->point_count++;
done:
  return status;
}

static bw_status read_facet(const bwi_cursor *cursor, const bwi_tag *tag, bwi_3mf *file,
                            const bwi_3mf_object *object) {
  static const char *const key[3] = {"v1", "v2", "v3"};
  bw_status status = BW_OK;
  int64_t count = (int64_t)(file->point_count - object->first_point), corner;
  BW_TRY_MEMORY(bw_grow(file->context, (void **)&file->facet, &file->facet_capacity,
                        file->facet_count, 1, 3 * sizeof(int32_t)));
  if (count == 0)
    return bwi_fail_line(cursor, "a triangle of an object without vertices");
  for (int k = 0; k < 3; k++) {
    BW_TRY(read_index(cursor, tag, key[k], count, "a triangle", &corner));
    file->facet[3 * file->facet_count + (size_t)k] = (int32_t)corner;
  }
  file->facet_count++;
done:
  return status;
}

static bool is_any(bwi_word name, const char *const *list) {
  for (; *list; list++)
    if (bwi_word_is(name, *list))
      return true;
  return false;
}

bw_status bwi_3mf_model(bwi_cursor *cursor, int part, bwi_3mf *file) {
  /* Colours, materials, lattices and slices have no place in a surface. */
  static const char *const passed_over[] = {
      "basematerials",      "colorgroup",      "texture2d",  "texture2dgroup",
      "compositematerials", "multiproperties", "slicestack", "beamlattice",
      "pbspecular",         "pbmetallic",      NULL};
  bw_status status = BW_OK;
  bwi_tag tag;
  bool any, model = false, inside = false;
  for (int64_t i = 0;; i++) {
    BW_TRY(bwi_xml_next(cursor, &tag, &any));
    if (!any)
      break;
    if (i % 65536 == 0)
      BW_TRY(bw_check_cancel(file->context));
    bwi_word name = local_name(tag.name);
    bwi_3mf_object *object = inside ? &file->object[file->object_count - 1] : NULL;
    if (bwi_word_is(name, "object")) {
      if (tag.closing) {
        inside = false;
      } else {
        if (inside)
          BW_TRY(bwi_fail_line(cursor, "an object inside of another object"));
        BW_TRY(begin_object(cursor, &tag, part, file));
        inside = !tag.empty;
      }
    } else if (tag.closing) {
      continue;
    } else if (bwi_word_is(name, "model")) {
      BW_TRY(read_unit(cursor, &tag, file));
      model = true;
    } else if (bwi_word_is(name, "vertex") && object) {
      BW_TRY(read_vertex(cursor, &tag, file));
      object->point_count++;
    } else if (bwi_word_is(name, "triangle") && object) {
      BW_TRY(read_facet(cursor, &tag, file, object));
      object->facet_count++;
    } else if (bwi_word_is(name, "component") && object) {
      BW_TRY_MEMORY(bw_grow(file->context, (void **)&file->use, &file->use_capacity,
                            file->use_count, 1, sizeof *file->use));
      BW_TRY(read_use(cursor, &tag, part, file, &file->use[file->use_count]));
      file->use_count++;
      object->use_count++;
    } else if (bwi_word_is(name, "item") && part == 0) {
      BW_TRY_MEMORY(bw_grow(file->context, (void **)&file->item, &file->item_capacity,
                            file->item_count, 1, sizeof *file->item));
      BW_TRY(read_use(cursor, &tag, part, file, &file->item[file->item_count]));
      file->item_count++;
    } else if (is_any(name, passed_over)) {
      file->skipped++;
    }
  }
  if (!model)
    status = bwi_fail_line(cursor, "the member holds no 3MF model");
  if (status == BW_OK && inside)
    status = bwi_fail_line(cursor, "the file ends inside an object");
done:
  return status;
}
