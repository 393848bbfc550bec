/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* Values of a glTF file that are checked as they are read; buffers in its text, in its binary part
 * or in files beside it; accessors, which are views of them. */
#include "io/gltf_data.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

#include "barwright/job.h"

#define MOST ((int64_t)1 << 32)

const bwi_json_value *bwi_gltf_value(const bwi_gltf *g, int32_t value) {
  return &g->json.value[value];
}

bw_status bwi_gltf_fail(const bwi_gltf *g, int32_t value, const char *format, ...) {
  char text[512];
  va_list arguments;
  va_start(arguments, format);
  vsnprintf(text, sizeof text, format, arguments);
  va_end(arguments);
  bwi_cursor cursor = *g->file;
  cursor.at = bwi_gltf_value(g, value)->text.at;
  return bwi_fail_byte(&cursor, "%s", text);
}

bw_status bwi_gltf_integer(const bwi_gltf *g, int32_t of, const char *key, int64_t limit,
                           int64_t missing, int64_t *value) {
  int32_t member = bwi_json_member(&g->json, of, key);
  *value = missing;
  if (!member)
    return missing >= 0 ? BW_OK : bwi_gltf_fail(g, of, "this has no \"%s\"", key);
  double number = bwi_gltf_value(g, member)->number;
  if (bwi_gltf_value(g, member)->kind != BWI_JSON_NUMBER || !(number >= 0) ||
      number >= (double)limit || number != floor(number))
    return limit == 0 ? bwi_gltf_fail(g, member, "\"%s\": the file has none of these", key)
                      : bwi_gltf_fail(g, member, "\"%s\": an integer from 0 to %lld was expected",
                                      key, (long long)limit - 1);
  *value = (int64_t)number;
  return BW_OK;
}

bw_status bwi_gltf_reals(const bwi_gltf *g, int32_t of, const char *key, int count, double *out) {
  int32_t member = bwi_json_member(&g->json, of, key);
  if (!member)
    return BW_OK;
  if (bwi_gltf_value(g, member)->kind != BWI_JSON_ARRAY ||
      bwi_gltf_value(g, member)->count != count)
    return bwi_gltf_fail(g, member, "\"%s\": %d numbers were expected", key, count);
  int32_t at = bwi_gltf_value(g, member)->first;
  for (int k = 0; k < count; k++, at = bwi_gltf_value(g, at)->next) {
    if (bwi_gltf_value(g, at)->kind != BWI_JSON_NUMBER)
      return bwi_gltf_fail(g, at, "\"%s\": a number was expected", key);
    out[k] = bwi_gltf_value(g, at)->number;
  }
  return BW_OK;
}

bw_status bwi_gltf_list_of(const bwi_gltf *g, int32_t of, const char *key, bwi_gltf_list *out) {
  int32_t member = bwi_json_member(&g->json, of, key);
  *out = (bwi_gltf_list){0};
  if (!member)
    return BW_OK;
  if (bwi_gltf_value(g, member)->kind != BWI_JSON_ARRAY)
    return bwi_gltf_fail(g, member, "\"%s\": an array was expected", key);
  out->value = BW_NEW(g->context, int32_t, bwi_gltf_value(g, member)->count + 1);
  if (!out->value)
    return BW_MEMORY;
  for (int32_t at = bwi_gltf_value(g, member)->first; at; at = bwi_gltf_value(g, at)->next) {
    if (bwi_gltf_value(g, at)->kind != BWI_JSON_OBJECT)
      return bwi_gltf_fail(g, at, "\"%s\": objects were expected", key);
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

static bw_status decode_base64(const bwi_gltf *g, int32_t uri, const unsigned char *at,
                               const unsigned char *end, bwi_gltf_block *out) {
  while (end > at && end[-1] == '=')
    end--;
  if (!(out->owned = BW_NEW(g->context, unsigned char, (size_t)(end - at) / 4 * 3 + 3)))
    return BW_MEMORY;
  uint32_t bits = 0;
  for (int have = 0; at < end; at++) {
    int digit = base64_digit(*at);
    if (digit < 0)
      return bwi_gltf_fail(g, uri, "found '%s' inside base64 data", bwi_show((bwi_word){at, 1}));
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
static bw_status read_beside(const bwi_gltf *g, int32_t uri, bwi_gltf_block *out) {
  char name[1024], path[4096];
  size_t length = bwi_json_text(bwi_gltf_value(g, uri), name, sizeof name);
  decode_percent(name);
  const char *slash = strrchr(g->file->name, '/');
  int folder = slash ? (int)(slash - g->file->name) + 1 : 0;
  if (length >= sizeof name || name[0] == '/' || strstr(name, "..") || strchr(name, ':') ||
      snprintf(path, sizeof path, "%.*s%s", folder, g->file->name, name) >= (int)sizeof path)
    return bwi_gltf_fail(g, uri, "\"uri\": '%s' names no file beside this one or in a folder there",
                         bwi_show(bwi_gltf_value(g, uri)->text));
  bw_status status = bw_read_file(g->context, path, &out->owned, &out->count);
  out->at = out->owned;
  return status;
}

static bw_status open_buffer(bwi_gltf *g, int64_t index, bwi_gltf_block **out) {
  static const char data[] = "data:", base64[] = ";base64,";
  int32_t object = g->buffer.value[index], uri = bwi_json_member(&g->json, object, "uri");
  int64_t length;
  bwi_gltf_block *own = *out = &g->block[index];
  if (own->open)
    return BW_OK;
  bw_status status = bwi_gltf_integer(g, object, "byteLength", MOST, -1, &length);
  if (status != BW_OK)
    return status;
  bwi_word text = bwi_gltf_value(g, uri)->text;
  if (!uri) {
    if (index != 0 || !g->chunk)
      return bwi_gltf_fail(g, object, "this buffer has no \"uri\"");
    own->at = g->chunk;
    own->count = g->chunk_count;
  } else if (bwi_gltf_value(g, uri)->kind != BWI_JSON_STRING) {
    return bwi_gltf_fail(g, uri, "\"uri\": a string was expected");
  } else if (text.length >= 5 && memcmp(text.at, data, 5) == 0) {
    const unsigned char *mark = memmem(text.at, text.length, base64, sizeof base64 - 1);
    if (!mark)
      return bwi_gltf_fail(g, uri, "\"uri\": data in base64 were expected");
    status = decode_base64(g, uri, mark + sizeof base64 - 1, text.at + text.length, own);
  } else {
    status = read_beside(g, uri, own);
    g->bytes += (double)own->count;
  }
  if (status == BW_OK && own->count < (size_t)length)
    status = bwi_gltf_fail(g, object, "this buffer has %zu bytes, but \"byteLength\" says %lld",
                           own->count, (long long)length);
  own->count = status == BW_OK ? (size_t)length : 0;
  own->open = status == BW_OK;
  return status;
}

size_t bwi_gltf_component_size(int64_t type) {
  static const size_t size[] = {1, 1, 2, 2, 0, 4, 4};
  return type >= 5120 && type <= 5126 ? size[type - 5120] : 0;
}

/* Where the `count` elements of `size` bytes begin that an object with "bufferView" refers to. */
static bw_status open_view(bwi_gltf *g, int32_t object, int64_t count, size_t size,
                           const unsigned char **at, size_t *step) {
  bw_status status = BW_OK;
  int64_t view, buffer, offset, first, length, stride;
  bwi_gltf_block *bytes;
  BW_TRY(bwi_gltf_integer(g, object, "byteOffset", MOST, 0, &offset));
  BW_TRY(bwi_gltf_integer(g, object, "bufferView", g->view.count, -1, &view));
  int32_t part = g->view.value[view];
  BW_TRY(bwi_gltf_integer(g, part, "buffer", g->buffer.count, -1, &buffer));
  BW_TRY(bwi_gltf_integer(g, part, "byteOffset", MOST, 0, &first));
  BW_TRY(bwi_gltf_integer(g, part, "byteLength", MOST, -1, &length));
  BW_TRY(bwi_gltf_integer(g, part, "byteStride", 256, 0, &stride));
  BW_TRY(open_buffer(g, buffer, &bytes));
  *step = stride ? (size_t)stride : size;
  if ((uint64_t)first + (uint64_t)length > bytes->count)
    return bwi_gltf_fail(g, part, "this part ends at byte %lld of a buffer of %zu bytes",
                         (long long)(first + length), bytes->count);
  if (*step < size ||
      (count > 0 && (uint64_t)offset + (uint64_t)(count - 1) * *step + size > (uint64_t)length))
    return bwi_gltf_fail(g, object, "%lld elements do not fit into the %lld bytes of their part",
                         (long long)count, (long long)length);
  *at = bytes->at + first + offset;
done:
  return status;
}

static bw_status object_of(const bwi_gltf *g, int32_t of, const char *key, int32_t *object) {
  *object = bwi_json_member(&g->json, of, key);
  if (!*object || bwi_gltf_value(g, *object)->kind != BWI_JSON_OBJECT)
    return bwi_gltf_fail(g, of, "an object \"%s\" was expected here", key);
  return BW_OK;
}

/* Room for the elements of an accessor: zeros. BW_LIMIT where all copies take more than the memory
 * that is free. */
static bw_status make_copy(bwi_gltf *g, int64_t number, int64_t count, size_t size) {
  const double memory = bw_available_memory();
  g->copied += (double)count * (double)size;
  if (memory > 0 && g->copied > memory) {
    bwi_gltf_fail(g, g->accessor.value[number],
                  "\"sparse\" of this accessor and of those before it takes %.0f bytes, more than "
                  "the memory that is free",
                  g->copied);
    return BW_LIMIT;
  }
  g->copy[number] = BW_NEW0(g->context, unsigned char, (size_t)count *size + 1);
  return g->copy[number] ? BW_OK : BW_MEMORY;
}

/* A copy of the elements of an accessor in which those are replaced that "sparse" lists; elements
 * without data (`at` NULL) are zeros. */
static bw_status replace_elements(bwi_gltf *g, int64_t number, size_t size,
                                  bwi_gltf_accessor *out) {
  bw_status status = BW_OK;
  const int32_t sparse = bwi_json_member(&g->json, g->accessor.value[number], "sparse");
  int32_t indices, values;
  int64_t count, type;
  const unsigned char *index, *value;
  size_t index_step, value_step;
  if (g->copy[number]) { /* from another place of its mesh */
    out->at = g->copy[number];
    out->stride = size;
    return BW_OK;
  }
  BW_TRY(bwi_gltf_integer(g, sparse, "count", out->count + 1, -1, &count));
  BW_TRY(object_of(g, sparse, "indices", &indices));
  BW_TRY(object_of(g, sparse, "values", &values));
  BW_TRY(bwi_gltf_integer(g, indices, "componentType", 65536, -1, &type));
  if (type != 5121 && type != 5123 && type != 5125)
    return bwi_gltf_fail(g, indices, "the indices of \"sparse\" have no such \"componentType\"");
  BW_TRY(open_view(g, indices, count, bwi_gltf_component_size(type), &index, &index_step));
  BW_TRY(open_view(g, values, count, size, &value, &value_step));
  BW_TRY(make_copy(g, number, out->count, size));
  unsigned char *copy = g->copy[number];
  for (int64_t i = 0; out->at && i < out->count; i++)
    memcpy(copy + (size_t)i * size, out->at + (size_t)i * out->stride, size);
  const bwi_gltf_accessor list = {.type = type};
  for (int64_t i = 0; i < count; i++) {
    double at = bwi_gltf_component(&list, index + (size_t)i * index_step);
    if (at >= (double)out->count)
      return bwi_gltf_fail(g, indices, "\"sparse\" replaces element %.0f of %lld", at,
                           (long long)out->count);
    memcpy(copy + (size_t)at * size, value + (size_t)i * value_step, size);
  }
  out->at = copy;
  out->stride = size;
done:
  return status;
}

bw_status bwi_gltf_accessor_open(bwi_gltf *g, int64_t index, const char *type, size_t components,
                                 bwi_gltf_accessor *out) {
  bw_status status = BW_OK;
  int32_t object = g->accessor.value[index];
  int32_t kind = bwi_json_member(&g->json, object, "type");
  int32_t normalised = bwi_json_member(&g->json, object, "normalized");
  *out = (bwi_gltf_accessor){0};
  if (!kind || !bwi_word_is(bwi_gltf_value(g, kind)->text, type))
    return bwi_gltf_fail(g, kind ? kind : object, "an accessor of the type %s was expected here",
                         type);
  BW_TRY(bwi_gltf_integer(g, object, "componentType", 65536, -1, &out->type));
  BW_TRY(bwi_gltf_integer(g, object, "count", INT32_MAX, -1, &out->count));
  size_t size = components * bwi_gltf_component_size(out->type);
  if (size == 0)
    return bwi_gltf_fail(g, object, "the \"componentType\" %lld is none of glTF's",
                         (long long)out->type);
  const bool dense = bwi_json_member(&g->json, object, "bufferView") != 0;
  const bool sparse = bwi_json_member(&g->json, object, "sparse") != 0;
  if (!dense && !sparse) {
    bwi_gltf_fail(g, object,
                  "this accessor has no data, as those that the extension "
                  "KHR_draco_mesh_compression packs: export without compression");
    return BW_UNSUPPORTED;
  }
  if (dense)
    BW_TRY(open_view(g, object, out->count, size, &out->at, &out->stride));
  if (sparse)
    BW_TRY(replace_elements(g, index, size, out));
  out->normalised = normalised && bwi_gltf_value(g, normalised)->kind == BWI_JSON_TRUE;
done:
  return status;
}

double bwi_gltf_component(const bwi_gltf_accessor *a, const unsigned char *at) {
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

bw_status bwi_gltf_open(bwi_gltf *g) {
  bw_status status = BW_OK;
  BW_TRY(bwi_gltf_list_of(g, 0, "accessors", &g->accessor));
  BW_TRY(bwi_gltf_list_of(g, 0, "bufferViews", &g->view));
  BW_TRY(bwi_gltf_list_of(g, 0, "buffers", &g->buffer));
  g->block = BW_NEW0(g->context, bwi_gltf_block, g->buffer.count + 1);
  g->copy = BW_NEW0(g->context, unsigned char *, g->accessor.count + 1);
  BW_TRY_MEMORY(g->block && g->copy);
done:
  return status;
}

void bwi_gltf_clear(bwi_gltf *g) {
  for (int64_t i = 0; g->block && i < g->buffer.count; i++)
    bw_free(g->block[i].owned);
  for (int64_t i = 0; g->copy && i < g->accessor.count; i++)
    bw_free(g->copy[i]);
  bw_free(g->copy);
  bw_free(g->block);
  bw_free(g->accessor.value);
  bw_free(g->view.value);
  bw_free(g->buffer.value);
  bw_free(g->json.value);
}
