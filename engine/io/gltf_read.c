/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* glTF 2.0: the meshes of a scene, from .glb, or from .gltf with data in its text or in files
 * beside it. Each mesh of a node is a group. Its equal points are welded, since glTF splits points
 * where normals or colours differ. y is up in glTF, z here: (x, y, z) becomes (x, -z, y).
 *
 * Files of hostile origin: nodes may repeat meshes to no more than REPEATED times their size. */
#include "io/gltf.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "barwright/job.h"
#include "io/json.h"
#include "mesh/surface_internal.h"

enum { REPEATED = 100, SLACK = 1 << 16, POINT_BYTES = 80 };
#define MOST ((int64_t)1 << 32)

typedef struct list { /* the elements of an array of the root */
  int32_t *value;
  int64_t count;
} list;

typedef struct block { /* a buffer */
  const unsigned char *at;
  size_t count;
  unsigned char *owned;
  bool open;
} block;

typedef struct accessor {
  const unsigned char *at;
  size_t stride;
  int64_t count, type;
  bool normalised;
} accessor;

typedef struct gltf {
  bw_context *context;
  const bwi_cursor *file;
  bool binary;
  bwi_json json;
  list accessor, view, buffer, mesh, node;
  const unsigned char *chunk; /* binary part of a .glb */
  size_t chunk_count;
  block *block;
  double work, bytes; /* points and facets placed; of the file and those beside it */
  int32_t *stamp,
      *local; /* of the points of an accessor: primitive that used it, number in the soup */
  size_t stamp_count;
  int32_t primitive;
  bw_name *group_name;
  size_t name_count, name_capacity;
} gltf;

static const bwi_json_value *value_of(const gltf *g, int32_t value) {
  return &g->json.value[value];
}

/* At the place of a value. */
static bw_status fail_at(const gltf *g, int32_t value, const char *format, ...) BW_PRINTF(3, 4);
static bw_status fail_at(const gltf *g, int32_t value, const char *format, ...) {
  char text[512];
  va_list arguments;
  va_start(arguments, format);
  vsnprintf(text, sizeof text, format, arguments);
  va_end(arguments);
  bwi_cursor cursor = *g->file;
  cursor.at = value_of(g, value)->text.at;
  return bwi_fail_byte(&cursor, "%s", text);
}

/* A member that is an integer from 0 to limit - 1. missing: its value where there is none, -1: it
 * must be there. */
static bw_status read_integer(const gltf *g, int32_t of, const char *key, int64_t limit,
                              int64_t missing, int64_t *value) {
  int32_t member = bwi_json_member(&g->json, of, key);
  *value = missing;
  if (!member)
    return missing >= 0 ? BW_OK : fail_at(g, of, "this has no \"%s\"", key);
  double number = value_of(g, member)->number;
  if (value_of(g, member)->kind != BWI_JSON_NUMBER || !(number >= 0) || number >= (double)limit ||
      number != floor(number))
    return fail_at(g, member, "\"%s\": an integer from 0 to %lld was expected", key,
                   (long long)limit - 1);
  *value = (int64_t)number;
  return BW_OK;
}

/* `count` numbers into `out`, which stays as it is where the member is not there. */
static bw_status read_reals(const gltf *g, int32_t of, const char *key, int count, double *out) {
  int32_t member = bwi_json_member(&g->json, of, key);
  if (!member)
    return BW_OK;
  if (value_of(g, member)->kind != BWI_JSON_ARRAY || value_of(g, member)->count != count)
    return fail_at(g, member, "\"%s\": %d numbers were expected", key, count);
  int32_t at = value_of(g, member)->first;
  for (int k = 0; k < count; k++, at = value_of(g, at)->next) {
    if (value_of(g, at)->kind != BWI_JSON_NUMBER)
      return fail_at(g, at, "\"%s\": a number was expected", key);
    out[k] = value_of(g, at)->number;
  }
  return BW_OK;
}

/* An array of objects, or none. */
static bw_status read_list(const gltf *g, int32_t of, const char *key, list *out) {
  int32_t member = bwi_json_member(&g->json, of, key);
  *out = (list){0};
  if (!member)
    return BW_OK;
  if (value_of(g, member)->kind != BWI_JSON_ARRAY)
    return fail_at(g, member, "\"%s\": an array was expected", key);
  out->value = BW_NEW(g->context, int32_t, value_of(g, member)->count + 1);
  if (!out->value)
    return BW_MEMORY;
  for (int32_t at = value_of(g, member)->first; at; at = value_of(g, at)->next) {
    if (value_of(g, at)->kind != BWI_JSON_OBJECT)
      return fail_at(g, at, "\"%s\": objects were expected", key);
    out->value[out->count++] = at;
  }
  return BW_OK;
}

/* ---- buffers --------------------------------------------------------------------------------- */

static int base64_digit(unsigned char c) {
  return c >= 'A' && c <= 'Z'   ? c - 'A'
         : c >= 'a' && c <= 'z' ? c - 'a' + 26
         : c >= '0' && c <= '9' ? c - '0' + 52
         : c == '+'             ? 62
         : c == '/'             ? 63
                                : -1;
}

static bw_status decode_base64(const gltf *g, int32_t uri, const unsigned char *at,
                               const unsigned char *end, block *out) {
  while (end > at && end[-1] == '=')
    end--;
  if (!(out->owned = BW_NEW(g->context, unsigned char, (size_t)(end - at) / 4 * 3 + 3)))
    return BW_MEMORY;
  uint32_t bits = 0;
  for (int have = 0; at < end; at++) {
    int digit = base64_digit(*at);
    if (digit < 0)
      return fail_at(g, uri, "found '%s' inside base64 data", bwi_show((bwi_word){at, 1}));
    bits = bits << 6 | (uint32_t)digit;
    have += 6;
    if (have >= 8)
      out->owned[out->count++] = (unsigned char)(bits >> (have -= 8));
  }
  out->at = out->owned;
  return BW_OK;
}

/* %41 is A. */
static void decode_percent(char *text) {
  char *to = text;
  for (const char *at = text; *at; at++) {
    unsigned code;
    if (*at == '%' && strspn(at + 1, "0123456789abcdefABCDEF") >= 2 &&
        sscanf(at + 1, "%2x", &code) == 1 && code != 0) {
      *to++ = (char)code;
      at += 2;
    } else {
      *to++ = *at;
    }
  }
  *to = 0;
}

/* A file beside this one, or in a folder there. */
static bw_status read_beside(const gltf *g, int32_t uri, block *out) {
  char name[1024], path[4096];
  size_t length = bwi_json_text(value_of(g, uri), name, sizeof name);
  decode_percent(name);
  const char *slash = strrchr(g->file->name, '/');
  int folder = slash ? (int)(slash - g->file->name) + 1 : 0;
  if (length >= sizeof name || name[0] == '/' || strstr(name, "..") || strchr(name, ':') ||
      snprintf(path, sizeof path, "%.*s%s", folder, g->file->name, name) >= (int)sizeof path)
    return fail_at(g, uri, "\"uri\": '%s' names no file beside this one or in a folder there",
                   bwi_show(value_of(g, uri)->text));
  bw_status status = bw_read_file(g->context, path, &out->owned, &out->count);
  out->at = out->owned;
  return status;
}

static bw_status open_buffer(gltf *g, int64_t index, block **out) {
  static const char data[] = "data:", base64[] = ";base64,";
  int32_t object = g->buffer.value[index], uri = bwi_json_member(&g->json, object, "uri");
  int64_t length;
  block *own = *out = &g->block[index];
  if (own->open)
    return BW_OK;
  bw_status status = read_integer(g, object, "byteLength", MOST, -1, &length);
  if (status != BW_OK)
    return status;
  bwi_word text = value_of(g, uri)->text;
  if (!uri) {
    if (index != 0 || !g->chunk)
      return fail_at(g, object, "this buffer has no \"uri\"");
    own->at = g->chunk;
    own->count = g->chunk_count;
  } else if (value_of(g, uri)->kind != BWI_JSON_STRING) {
    return fail_at(g, uri, "\"uri\": a string was expected");
  } else if (text.length >= 5 && memcmp(text.at, data, 5) == 0) {
    const unsigned char *mark = memmem(text.at, text.length, base64, sizeof base64 - 1);
    if (!mark)
      return fail_at(g, uri, "\"uri\": data in base64 were expected");
    status = decode_base64(g, uri, mark + sizeof base64 - 1, text.at + text.length, own);
  } else {
    status = read_beside(g, uri, own);
    g->bytes += (double)own->count;
  }
  if (status == BW_OK && own->count < (size_t)length)
    status = fail_at(g, object, "this buffer has %zu bytes, but \"byteLength\" says %lld",
                     own->count, (long long)length);
  own->count = status == BW_OK ? (size_t)length : 0;
  own->open = status == BW_OK;
  return status;
}

static size_t size_of_type(int64_t type) {
  static const size_t size[] = {1, 1, 2, 2, 0, 4, 4};
  return type >= 5120 && type <= 5126 ? size[type - 5120] : 0;
}

static bw_status open_accessor(gltf *g, int64_t index, const char *type, size_t components,
                               accessor *out) {
  bw_status status = BW_OK;
  int32_t object = g->accessor.value[index];
  int32_t kind = bwi_json_member(&g->json, object, "type");
  int32_t normalised = bwi_json_member(&g->json, object, "normalized");
  int64_t view, buffer, offset, first, length, stride;
  block *bytes;
  if (!kind || !bwi_word_is(value_of(g, kind)->text, type))
    return fail_at(g, kind ? kind : object, "an accessor of the type %s was expected here", type);
  BW_TRY(read_integer(g, object, "componentType", 65536, -1, &out->type));
  BW_TRY(read_integer(g, object, "count", INT32_MAX, -1, &out->count));
  BW_TRY(read_integer(g, object, "byteOffset", MOST, 0, &offset));
  size_t size = size_of_type(out->type);
  if (size == 0)
    return fail_at(g, object, "the \"componentType\" %lld is none of glTF's", (long long)out->type);
  if (bwi_json_member(&g->json, object, "sparse") ||
      !bwi_json_member(&g->json, object, "bufferView")) {
    fail_at(g, object, "sparse or compressed accessors are not read: export without them");
    return BW_UNSUPPORTED;
  }
  BW_TRY(read_integer(g, object, "bufferView", g->view.count, -1, &view));
  int32_t part = g->view.value[view];
  BW_TRY(read_integer(g, part, "buffer", g->buffer.count, -1, &buffer));
  BW_TRY(read_integer(g, part, "byteOffset", MOST, 0, &first));
  BW_TRY(read_integer(g, part, "byteLength", MOST, -1, &length));
  BW_TRY(read_integer(g, part, "byteStride", 256, 0, &stride));
  BW_TRY(open_buffer(g, buffer, &bytes));
  size *= components;
  out->stride = stride ? (size_t)stride : size;
  if ((uint64_t)first + (uint64_t)length > bytes->count)
    return fail_at(g, part, "this part ends at byte %lld of a buffer of %zu bytes",
                   (long long)(first + length), bytes->count);
  if (out->stride < size ||
      (out->count > 0 &&
       (uint64_t)offset + (uint64_t)(out->count - 1) * out->stride + size > (uint64_t)length))
    return fail_at(g, object, "%lld elements do not fit into the %lld bytes of their part",
                   (long long)out->count, (long long)length);
  out->at = bytes->at + first + offset;
  out->normalised = normalised && value_of(g, normalised)->kind == BWI_JSON_TRUE;
done:
  return status;
}

static double component(const accessor *a, const unsigned char *at) {
  static const double largest[] = {127, 255, 32767, 65535};
  const bool swap = __BYTE_ORDER__ == __ORDER_BIG_ENDIAN__;
  if (a->type == 5126)
    return (double)bwi_f32(at, swap);
  double value = a->type == 5120   ? (double)(int8_t)at[0]
                 : a->type == 5121 ? (double)at[0]
                 : a->type == 5122 ? (double)(int16_t)bwi_u16(at, swap)
                 : a->type == 5123 ? (double)bwi_u16(at, swap)
                                   : (double)bwi_u32(at, swap);
  if (a->normalised && a->type <= 5123) {
    value /= largest[a->type - 5120];
    value = value < -1 ? -1 : value;
  }
  return value;
}

/* ---- meshes ---------------------------------------------------------------------------------- */

/* What a primitive's corners are, in order. */
typedef struct corners {
  accessor position, index;
  bool indexed;
  int32_t value; /* of the primitive, for messages */
  const double *transform;
} corners;

static bw_status place_point(gltf *g, const corners *c, int64_t i, bwi_soup *soup, int32_t *out) {
  int64_t own = i;
  if (c->indexed) {
    own = (int64_t)component(&c->index, c->index.at + (size_t)i * c->index.stride);
    if (own >= c->position.count)
      return fail_at(g, c->value, "a facet names point %lld, but there are %lld, numbered from 0",
                     (long long)own, (long long)c->position.count);
  }
  if (g->stamp[own] != g->primitive) {
    const unsigned char *at = c->position.at + (size_t)own * c->position.stride;
    const double *t = c->transform;
    double x[3], y[3];
    for (size_t k = 0; k < 3; k++)
      x[k] = component(&c->position, at + k * size_of_type(c->position.type));
    for (size_t k = 0; k < 3; k++)
      y[k] = t[4 * k] * x[0] + t[4 * k + 1] * x[1] + t[4 * k + 2] * x[2] + t[4 * k + 3];
    if (!isfinite(y[0]) || !isfinite(y[1]) || !isfinite(y[2]))
      return fail_at(g, c->value, "point %lld has a coordinate that is not finite", (long long)own);
    const double up[3] = {y[0], -y[2], y[1]};
    bw_status status = bwi_soup_point(soup, up);
    if (status != BW_OK)
      return status;
    g->stamp[own] = g->primitive;
    g->local[own] = (int32_t)soup->point_count - 1;
  }
  *out = g->local[own];
  return BW_OK;
}

static bw_status place_facets(gltf *g, const corners *c, int64_t mode, bool mirrored,
                              bwi_soup *soup) {
  bw_status status = BW_OK;
  int64_t count = c->indexed ? c->index.count : c->position.count;
  int64_t facets = mode == 4 ? count / 3 : count < 3 ? 0 : count - 2;
  for (int64_t i = 0; i < facets; i++) {
    int64_t corner[3] = {mode == 4   ? 3 * i
                         : mode == 5 ? i
                                     : 0,
                         mode == 4 ? 3 * i + 1 : i + 1, mode == 4 ? 3 * i + 2 : i + 2};
    int32_t v[3];
    for (int k = 0; k < 3; k++)
      BW_TRY(place_point(g, c, corner[k], soup, &v[k]));
    bool turned = mirrored != (mode == 5 && i % 2 == 1);
    if (mode == 4 || (v[0] != v[1] && v[1] != v[2] && v[2] != v[0]))
      BW_TRY(bwi_soup_triangle(soup, v[0], v[turned ? 2 : 1], v[turned ? 1 : 2]));
    if (i % 65536 == 0)
      BW_TRY(bw_check_cancel(g->context));
  }
done:
  return status;
}

/* What is placed is counted, since many nodes may have one mesh. */
static bw_status count_work(gltf *g, int32_t value, const corners *c) {
  double memory = bw_available_memory();
  g->work += 1 + (double)(c->indexed ? c->index.count : c->position.count);
  if (g->primitive < INT32_MAX && g->work <= REPEATED * g->bytes + SLACK &&
      (memory <= 0 || POINT_BYTES * g->work < memory + POINT_BYTES * SLACK))
    return BW_OK;
  fail_at(g, value,
          "nodes repeat meshes to %.0f corners, from %.0f bytes: no plausible file does that, or "
          "it takes more than the memory that is free",
          g->work, g->bytes);
  return BW_LIMIT;
}

static bw_status place_primitive(gltf *g, int32_t value, const double transform[12], bool mirrored,
                                 bwi_soup *soup) {
  bw_status status = BW_OK;
  int64_t mode, position, index;
  int32_t attributes = bwi_json_member(&g->json, value, "attributes");
  corners c = {.value = value, .transform = transform};
  BW_TRY(read_integer(g, value, "mode", 7, 4, &mode));
  c.indexed = bwi_json_member(&g->json, value, "indices") != 0;
  if (mode >= 4 && attributes && bwi_json_member(&g->json, attributes, "POSITION")) {
    BW_TRY(read_integer(g, attributes, "POSITION", g->accessor.count, -1, &position));
    BW_TRY(open_accessor(g, position, "VEC3", 3, &c.position));
    if (c.indexed) {
      BW_TRY(read_integer(g, value, "indices", g->accessor.count, -1, &index));
      BW_TRY(open_accessor(g, index, "SCALAR", 1, &c.index));
      if (c.index.type != 5121 && c.index.type != 5123 && c.index.type != 5125)
        return fail_at(g, value,
                       "the indices are of the \"componentType\" %lld: 5121, 5123 or "
                       "5125 was expected",
                       (long long)c.index.type);
    }
  } else {
    soup->skipped++;
  }
  BW_TRY(count_work(g, value, &c));
  if (c.position.count == 0)
    goto done;
  if ((size_t)c.position.count > g->stamp_count) {
    bw_free(g->stamp);
    bw_free(g->local);
    g->stamp_count = (size_t)c.position.count;
    g->stamp = BW_NEW0(g->context, int32_t, g->stamp_count);
    g->local = BW_NEW(g->context, int32_t, g->stamp_count);
    BW_TRY_MEMORY(g->stamp && g->local);
  }
  g->primitive++;
  BW_TRY(place_facets(g, &c, mode, mirrored, soup));
done:
  return status;
}

/* Merges equal points from `first` on, in the facets from `first_facet` on. */
static bw_status weld(bwi_soup *soup, size_t first, size_t first_facet) {
  bw_status status = BW_OK;
  size_t count = soup->point_count - first;
  double *point = soup->point + 3 * first;
  int32_t kept, *to = BW_NEW(soup->context, int32_t, count + 1);
  BW_TRY_MEMORY(to);
  BW_TRY(bwi_weld_map(soup->context, (int64_t)count, point, NULL, 0, to, &kept));
  for (size_t i = 0; i < count; i++) /* new numbers are no larger than the old ones */
    memmove(point + 3 * (size_t)to[i], point + 3 * i, 3 * sizeof *point);
  soup->point_count = first + (size_t)kept;
  for (size_t i = 3 * first_facet; i < 3 * soup->triangle_count; i++)
    soup->triangle[i] = (int32_t)first + to[(size_t)soup->triangle[i] - first];
done:
  bw_free(to);
  return status;
}

static bw_status keep_name(gltf *g, int32_t node, int32_t mesh) {
  bw_status status = BW_OK;
  int32_t name = node ? bwi_json_member(&g->json, node, "name") : 0;
  name = name ? name : bwi_json_member(&g->json, mesh, "name");
  BW_TRY_MEMORY(bw_grow(g->context, (void **)&g->group_name, &g->name_capacity, g->name_count, 1,
                        sizeof *g->group_name));
  bw_name *own = &g->group_name[g->name_count++];
  own->text[0] = 0;
  if (name && value_of(g, name)->kind == BWI_JSON_STRING)
    bwi_json_text(value_of(g, name), own->text, sizeof own->text);
done:
  return status;
}

/* node: 0 where there are meshes only. */
static bw_status place_mesh(gltf *g, int32_t node, int64_t index, const double t[12],
                            bwi_soup *soup) {
  bw_status status = BW_OK;
  int32_t mesh = g->mesh.value[index], primitives = bwi_json_member(&g->json, mesh, "primitives");
  size_t first = soup->point_count, first_facet = soup->triangle_count;
  bool mirrored = t[0] * (t[5] * t[10] - t[6] * t[9]) - t[1] * (t[4] * t[10] - t[6] * t[8]) +
                      t[2] * (t[4] * t[9] - t[5] * t[8]) <
                  0;
  if (!primitives || value_of(g, primitives)->kind != BWI_JSON_ARRAY)
    return fail_at(g, mesh, "this mesh has no \"primitives\"");
  bwi_soup_next_group(soup);
  for (int32_t at = value_of(g, primitives)->first; at; at = value_of(g, at)->next)
    BW_TRY(place_primitive(g, at, t, mirrored, soup));
  if (soup->triangle_count > first_facet) {
    BW_TRY(weld(soup, first, first_facet));
    BW_TRY(keep_name(g, node, mesh));
  }
done:
  return status;
}

/* ---- nodes ----------------------------------------------------------------------------------- */

/* A node's own transform, rows of [A | b]. */
static bw_status local_transform(const gltf *g, int32_t node, double t[12]) {
  bw_status status = BW_OK;
  double m[16] = {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1};
  double move[3] = {0, 0, 0}, q[4] = {0, 0, 0, 1}, scale[3] = {1, 1, 1};
  if (bwi_json_member(&g->json, node, "matrix")) {
    BW_TRY(read_reals(g, node, "matrix", 16, m));
    if (m[3] != 0 || m[7] != 0 || m[11] != 0 || m[15] != 1)
      BW_TRY(fail_at(g, node, "the matrix of this node is none of a motion and a scale"));
    for (size_t i = 0; i < 3; i++)
      for (size_t j = 0; j < 4; j++)
        t[4 * i + j] = m[4 * j + i];
    return BW_OK;
  }
  BW_TRY(read_reals(g, node, "translation", 3, move));
  BW_TRY(read_reals(g, node, "rotation", 4, q));
  BW_TRY(read_reals(g, node, "scale", 3, scale));
  double size = sqrt(q[0] * q[0] + q[1] * q[1] + q[2] * q[2] + q[3] * q[3]);
  if (!(size > 0) || !isfinite(size))
    BW_TRY(fail_at(g, node, "the rotation of this node is no unit quaternion"));
  for (int k = 0; k < 4; k++)
    q[k] /= size;
  const double x = q[0], y = q[1], z = q[2], w = q[3];
  const double r[9] = {1 - 2 * (y * y + z * z), 2 * (x * y - z * w),     2 * (x * z + y * w),
                       2 * (x * y + z * w),     1 - 2 * (x * x + z * z), 2 * (y * z - x * w),
                       2 * (x * z - y * w),     2 * (y * z + x * w),     1 - 2 * (x * x + y * y)};
  for (size_t i = 0; i < 3; i++) {
    for (size_t j = 0; j < 3; j++)
      t[4 * i + j] = r[3 * i + j] * scale[j];
    t[4 * i + 3] = move[i];
  }
done:
  return status;
}

/* outer, then inner becomes inner's transform of the world. */
static void compose(const double outer[12], const double inner[12], double out[12]) {
  for (size_t i = 0; i < 3; i++)
    for (size_t j = 0; j < 4; j++)
      out[4 * i + j] = outer[4 * i] * inner[j] + outer[4 * i + 1] * inner[4 + j] +
                       outer[4 * i + 2] * inner[8 + j] + (j == 3 ? outer[4 * i + 3] : 0);
}

static const double identity[12] = {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0};

typedef struct walk {
  int32_t *stack; /* nodes to be placed, the next one last */
  int64_t depth;
  bool *seen;
  double *world; /* of the node above, until it is placed */
} walk;

/* The nodes of a list, the last one first. */
static bw_status push_nodes(const gltf *g, int32_t of, const char *key, const double outer[12],
                            walk *w) {
  int32_t member = bwi_json_member(&g->json, of, key);
  int64_t begin = w->depth;
  if (!member)
    return BW_OK;
  if (value_of(g, member)->kind != BWI_JSON_ARRAY)
    return fail_at(g, member, "\"%s\": numbers of nodes were expected", key);
  for (int32_t at = value_of(g, member)->first; at; at = value_of(g, at)->next) {
    double number = value_of(g, at)->number;
    if (value_of(g, at)->kind != BWI_JSON_NUMBER || !(number >= 0) ||
        number >= (double)g->node.count || number != floor(number))
      return fail_at(g, at, "a node from 0 to %lld was expected", (long long)g->node.count - 1);
    int64_t node = (int64_t)number;
    if (w->seen[node])
      return fail_at(g, at, "node %lld stands below two nodes, or below itself", (long long)node);
    w->seen[node] = true;
    memcpy(w->world + 12 * node, outer, 12 * sizeof *outer);
    w->stack[w->depth++] = (int32_t)node;
  }
  for (int64_t end = w->depth - 1; begin < end; begin++, end--) {
    int32_t kept = w->stack[begin];
    w->stack[begin] = w->stack[end];
    w->stack[end] = kept;
  }
  return BW_OK;
}

/* Without a scene all nodes that stand below no other are placed. */
static bw_status push_roots(const gltf *g, walk *w) {
  bw_status status = BW_OK;
  list scene = {0};
  int64_t chosen;
  BW_TRY(read_list(g, 0, "scenes", &scene));
  if (scene.count > 0) {
    BW_TRY(read_integer(g, 0, "scene", scene.count, 0, &chosen));
    status = push_nodes(g, scene.value[chosen], "nodes", identity, w);
    goto done;
  }
  for (int64_t i = 0; i < g->node.count; i++)
    BW_TRY(push_nodes(g, g->node.value[i], "children", identity, w));
  w->depth = 0;
  for (int64_t i = g->node.count - 1; i >= 0; i--) {
    if (!w->seen[i]) {
      memcpy(w->world + 12 * i, identity, sizeof identity);
      w->stack[w->depth++] = (int32_t)i;
    }
    w->seen[i] = !w->seen[i];
  }
done:
  bw_free(scene.value);
  return status;
}

static bw_status place_nodes(gltf *g, bwi_soup *soup) {
  bw_status status = BW_OK;
  int64_t mesh;
  walk w = {.stack = BW_NEW(g->context, int32_t, g->node.count + 1),
            .seen = BW_NEW0(g->context, bool, g->node.count + 1),
            .world = BW_NEW(g->context, double, 12 * ((size_t)g->node.count + 1))};
  BW_TRY_MEMORY(w.stack && w.seen && w.world);
  if (g->node.count == 0)
    for (int64_t i = 0; i < g->mesh.count; i++)
      BW_TRY(place_mesh(g, 0, i, identity, soup));
  BW_TRY(push_roots(g, &w));
  while (w.depth > 0) {
    int64_t own = w.stack[--w.depth];
    int32_t node = g->node.value[own];
    double local[12], world[12];
    BW_TRY(local_transform(g, node, local));
    compose(w.world + 12 * own, local, world);
    if (bwi_json_member(&g->json, node, "mesh")) {
      BW_TRY(read_integer(g, node, "mesh", g->mesh.count, -1, &mesh));
      BW_TRY(place_mesh(g, node, mesh, world, soup));
    }
    BW_TRY(push_nodes(g, node, "children", world, &w));
  }
done:
  bw_free(w.stack);
  bw_free(w.seen);
  bw_free(w.world);
  return status;
}

/* ---- the file -------------------------------------------------------------------------------- */

bool bwi_is_gltf(const bwi_cursor *cursor) {
  bwi_cursor text = *cursor;
  if (bwi_left(cursor) >= 4 && memcmp(cursor->at, "glTF", 4) == 0)
    return true;
  bwi_skip_space(&text);
  return text.at < text.end && *text.at == '{' && bwi_find(&text, "\"asset\"") != NULL;
}

/* The JSON and the binary part of a .glb. */
static bw_status open_chunks(bwi_cursor *cursor, gltf *g, bwi_cursor *text) {
  enum { JSON = 0x4E4F534A, BIN = 0x004E4942 };
  const bool swap = __BYTE_ORDER__ == __ORDER_BIG_ENDIAN__;
  bw_status status = BW_OK;
  const unsigned char *head, *bytes;
  BW_TRY(bwi_take(cursor, 12, &head, "the head"));
  if (bwi_u32(head + 4, swap) != 2) {
    cursor->at = head + 4;
    bwi_fail_byte(cursor, "glTF of version %u is not read: save it as glTF 2.0",
                  (unsigned)bwi_u32(head + 4, swap));
    return BW_UNSUPPORTED;
  }
  for (int part = 0; part < 2 && bwi_left(cursor) > 0; part++) {
    BW_TRY(bwi_take(cursor, 8, &head, "the head of a part"));
    size_t length = bwi_u32(head, swap);
    uint32_t kind = bwi_u32(head + 4, swap);
    BW_TRY(bwi_take(cursor, length, &bytes, "a part"));
    if (part == 0 && kind != JSON) {
      cursor->at = head;
      return bwi_fail_byte(cursor, "the first part is not the JSON of a glTF file");
    }
    if (part == 0) {
      text->at = bytes;
      text->end = bytes + length;
    } else if (kind == BIN) {
      g->chunk = bytes;
      g->chunk_count = length;
    }
  }
  if (!text->at)
    status = bwi_fail_byte(cursor, "the file ends before its JSON");
done:
  return status;
}

/* Extensions without which the positions of points cannot be read. */
static bw_status check_extensions(const gltf *g) {
  static const char *const fine[] = {"KHR_mesh_quantization", "KHR_lights_punctual"};
  static const char material[] = "KHR_materials_", texture[] = "KHR_texture_";
  int32_t required = bwi_json_member(&g->json, 0, "extensionsRequired");
  for (int32_t at = required ? value_of(g, required)->first : 0; at; at = value_of(g, at)->next) {
    bwi_word word = value_of(g, at)->text;
    if (bwi_word_is(word, fine[0]) || bwi_word_is(word, fine[1]) ||
        (word.length > 14 && memcmp(word.at, material, 14) == 0) ||
        (word.length > 12 && memcmp(word.at, texture, 12) == 0))
      continue;
    fail_at(g, at, "the file needs the extension %s, which is not read: export without it",
            bwi_show(word));
    return BW_UNSUPPORTED;
  }
  return BW_OK;
}

static bw_status check_version(const gltf *g) {
  int32_t asset = bwi_json_member(&g->json, 0, "asset");
  int32_t version = asset ? bwi_json_member(&g->json, asset, "version") : 0;
  if (!version || value_of(g, version)->kind != BWI_JSON_STRING)
    return fail_at(g, asset, "a glTF file with \"asset\" and its \"version\" was expected");
  bwi_word word = value_of(g, version)->text;
  if (word.length > 1 && word.at[0] == '2' && word.at[1] == '.')
    return BW_OK;
  fail_at(g, version, "glTF of version %s is not read: save it as glTF 2.0", bwi_show(word));
  return BW_UNSUPPORTED;
}

bw_status bwi_gltf_parse(bwi_cursor *cursor, bw_surface **surface, bw_read_info *info) {
  bw_status status = BW_OK;
  bwi_soup soup;
  bwi_cursor text = *cursor;
  gltf g = {.context = cursor->context, .file = cursor};
  g.bytes = (double)bwi_left(cursor);
  g.binary = bwi_left(cursor) >= 4 && memcmp(cursor->at, "glTF", 4) == 0;
  bwi_soup_init(&soup, cursor->context, cursor->name);
  if (g.binary) {
    text.at = text.end = NULL;
    BW_TRY(open_chunks(cursor, &g, &text));
  }
  BW_TRY(bwi_json_parse(&text, &g.json));
  BW_TRY(check_version(&g));
  BW_TRY(check_extensions(&g));
  BW_TRY(read_list(&g, 0, "accessors", &g.accessor));
  BW_TRY(read_list(&g, 0, "bufferViews", &g.view));
  BW_TRY(read_list(&g, 0, "buffers", &g.buffer));
  BW_TRY(read_list(&g, 0, "meshes", &g.mesh));
  BW_TRY(read_list(&g, 0, "nodes", &g.node));
  BW_TRY_MEMORY(g.block = BW_NEW0(g.context, block, g.buffer.count + 1));
  BW_TRY(place_nodes(&g, &soup));
  BW_TRY(bwi_soup_finish(&soup, "glTF", false, surface, info));
  if (info) {
    info->unit = 1;
    info->group_name = g.group_name;
    g.group_name = NULL;
  }
done:
  for (int64_t i = 0; g.block && i < g.buffer.count; i++)
    bw_free(g.block[i].owned);
  bw_free(g.block);
  bw_free(g.accessor.value);
  bw_free(g.view.value);
  bw_free(g.buffer.value);
  bw_free(g.mesh.value);
  bw_free(g.node.value);
  bw_free(g.json.value);
  bw_free(g.stamp);
  bw_free(g.local);
  bw_free(g.group_name);
  bwi_soup_clear(&soup);
  return status;
}
