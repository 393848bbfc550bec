/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* glTF 2.0 as one .glb: a node with a mesh for each object. Positions are 32-bit numbers in metres,
 * y up: (x, y, z) becomes (x, z, -y). Colours are linear light in COLOR_0; where they belong to
 * facets, each facet has points of its own. */
#include "io/gltf.h"

#include <float.h>
#include <math.h>
#include <string.h>

#include "io/growing.h"
#include "io/surface_write.h"

/* What one object has of the arrays that all share. */
typedef struct range {
  int32_t first_point, points, first_facet, facets;
  float min[3], max[3];
} range;

typedef struct scene {
  const bw_surface *surface;
  const unsigned char *colour;
  bool apart; /* each facet has points of its own */
  int32_t object_count;
  int32_t *object_of;     /* of points */
  int32_t *point, *facet; /* in the order of the file; point: not used where apart */
  int32_t *number;        /* of a point among those of its object */
  range *object;
  int64_t point_count;
} scene;

static void place(const scene *s, int32_t point, double unit, float out[3]) {
  const double *x = s->surface->point + 3 * (size_t)point;
  out[0] = (float)(unit * x[0]);
  out[1] = (float)(unit * x[2]);
  out[2] = (float)(-unit * x[1]);
}

/* Points and facets by their objects, in the order of the surface. */
static void sort_by_object(scene *s) {
  const bw_surface *surface = s->surface;
  for (int32_t i = 0; i < surface->point_count; i++)
    if (s->object_of[i] >= 0)
      s->object[s->object_of[i]].points++;
  for (int32_t i = 0; i < surface->triangle_count; i++)
    s->object[s->object_of[surface->triangle[3 * (size_t)i]]].facets++;
  int32_t point = 0, facet = 0;
  for (int32_t k = 0; k < s->object_count; k++) {
    range *r = &s->object[k];
    r->first_point = point;
    r->first_facet = facet;
    point += r->points;
    facet += r->facets;
    r->points = r->facets = 0;
  }
  for (int32_t i = 0; i < surface->point_count; i++) {
    if (s->object_of[i] < 0)
      continue;
    range *r = &s->object[s->object_of[i]];
    s->number[i] = r->points;
    s->point[r->first_point + r->points++] = i;
  }
  for (int32_t i = 0; i < surface->triangle_count; i++) {
    range *r = &s->object[s->object_of[surface->triangle[3 * (size_t)i]]];
    s->facet[r->first_facet + r->facets++] = i;
  }
  s->point_count = s->apart ? 3 * (int64_t)facet : point;
}

/* The point of the surface at a place of the file. */
static int32_t point_at(const scene *s, int64_t i) {
  return s->apart ? s->surface->triangle[3 * (size_t)s->facet[i / 3] + (size_t)(i % 3)]
                  : s->point[i];
}

static bw_status find_boxes(bw_context *context, scene *s, double unit) {
  for (int32_t k = 0; k < s->object_count; k++) {
    range *r = &s->object[k];
    int64_t begin = s->apart ? 3 * (int64_t)r->first_facet : r->first_point;
    int64_t count = s->apart ? 3 * (int64_t)r->facets : r->points;
    for (int64_t i = begin; i < begin + count; i++) {
      float x[3];
      place(s, point_at(s, i), unit, x);
      for (int j = 0; j < 3; j++) {
        if (!isfinite(x[j]))
          return bw_fail(context, BW_INVALID,
                         "a coordinate of %g m is beyond glTF's numbers of 32 bits",
                         unit * s->surface->point[3 * (size_t)point_at(s, i)]);
        r->min[j] = i == begin || x[j] < r->min[j] ? x[j] : r->min[j];
        r->max[j] = i == begin || x[j] > r->max[j] ? x[j] : r->max[j];
      }
    }
  }
  return BW_OK;
}

static void print_vector(bwi_growing *text, const char *key, const float value[3]) {
  bwi_growing_print(text, ",\"%s\":[", key);
  for (int j = 0; j < 3; j++) {
    bwi_growing_print(text, j ? "," : "");
    bwi_growing_number(text, (double)value[j]);
  }
  bwi_growing_print(text, "]");
}

enum { POINT_BYTES = 12, INDEX_BYTES = 4 };

static void print_json(bwi_growing *text, const scene *s, size_t point_bytes, size_t index_bytes) {
  size_t colours = s->colour ? point_bytes : 0;
  bwi_growing_print(text,
                    "{\"asset\":{\"version\":\"2.0\",\"generator\":\"barwright\"},\"scene\":0,"
                    "\"scenes\":[{\"nodes\":[");
  for (int32_t k = 0; k < s->object_count; k++)
    bwi_growing_print(text, k ? ",%d" : "%d", (int)k);
  bwi_growing_print(text, "]}],\"nodes\":[");
  for (int32_t k = 0; k < s->object_count; k++)
    bwi_growing_print(text, "%s{\"name\":\"group %d\",\"mesh\":%d}", k ? "," : "", (int)k + 1,
                      (int)k);
  bwi_growing_print(text,
                    "],\"materials\":[{\"pbrMetallicRoughness\":{\"baseColorFactor\":"
                    "[%s,1],\"metallicFactor\":0,\"roughnessFactor\":0.8}}],\"meshes\":[",
                    s->colour ? "1,1,1" : "0.5,0.55,0.6");
  int per = s->colour ? 3 : 2;
  for (int32_t k = 0; k < s->object_count; k++) {
    bwi_growing_print(text, "%s{\"primitives\":[{\"attributes\":{\"POSITION\":%d", k ? "," : "",
                      per * (int)k + 1);
    if (s->colour)
      bwi_growing_print(text, ",\"COLOR_0\":%d", per * (int)k + 2);
    bwi_growing_print(text, "},\"indices\":%d,\"material\":0}]}", per * (int)k);
  }
  bwi_growing_print(text, "],\"accessors\":[");
  for (int32_t k = 0; k < s->object_count; k++) {
    const range *r = &s->object[k];
    long long points = s->apart ? 3 * (long long)r->facets : (long long)r->points;
    size_t first = s->apart ? 3 * (size_t)r->first_facet : (size_t)r->first_point;
    bwi_growing_print(text,
                      "%s{\"bufferView\":0,\"byteOffset\":%zu,\"componentType\":5125,\"count\":"
                      "%lld,\"type\":\"SCALAR\"},{\"bufferView\":1,\"byteOffset\":%zu,"
                      "\"componentType\":5126,\"count\":%lld,\"type\":\"VEC3\"",
                      k ? "," : "", 3 * INDEX_BYTES * (size_t)r->first_facet,
                      3 * (long long)r->facets, POINT_BYTES * first, points);
    print_vector(text, "min", r->min);
    print_vector(text, "max", r->max);
    bwi_growing_print(text, "}");
    if (s->colour)
      bwi_growing_print(text,
                        ",{\"bufferView\":2,\"byteOffset\":%zu,\"componentType\":5126,\"count\":"
                        "%lld,\"type\":\"VEC3\"}",
                        POINT_BYTES * first, points);
  }
  bwi_growing_print(text,
                    "],\"bufferViews\":[{\"buffer\":0,\"byteLength\":%zu,\"target\":34963},"
                    "{\"buffer\":0,\"byteOffset\":%zu,\"byteLength\":%zu,\"target\":34962}",
                    index_bytes, index_bytes, point_bytes);
  if (s->colour)
    bwi_growing_print(text,
                      ",{\"buffer\":0,\"byteOffset\":%zu,\"byteLength\":%zu,\"target\":34962}",
                      index_bytes + point_bytes, colours);
  bwi_growing_print(text, "],\"buffers\":[{\"byteLength\":%zu}]}",
                    index_bytes + point_bytes + colours);
  while (text->status == BW_OK && text->count % 4 != 0)
    bwi_growing_print(text, " ");
}

static void put_u32(bw_writer *writer, uint32_t value) {
  const unsigned char bytes[4] = {(unsigned char)value, (unsigned char)(value >> 8),
                                  (unsigned char)(value >> 16), (unsigned char)(value >> 24)};
  bw_writer_bytes(writer, bytes, sizeof bytes);
}

static void put_f32(bw_writer *writer, float value) {
  uint32_t bits;
  memcpy(&bits, &value, sizeof bits);
  put_u32(writer, bits);
}

static void put_arrays(bw_writer *writer, const scene *s, double unit) {
  for (int64_t i = 0; i < s->surface->triangle_count; i++)
    for (size_t k = 0; k < 3; k++) {
      int32_t corner = s->surface->triangle[3 * (size_t)s->facet[i] + k];
      int32_t object = s->object_of[corner];
      put_u32(writer, s->apart ? (uint32_t)(3 * (i - s->object[object].first_facet) + (int64_t)k)
                               : (uint32_t)s->number[corner]);
    }
  for (int64_t i = 0; i < s->point_count; i++) {
    float x[3];
    place(s, point_at(s, i), unit, x);
    for (int k = 0; k < 3; k++)
      put_f32(writer, x[k]);
  }
  for (int64_t i = 0; s->colour && i < s->point_count; i++) {
    const unsigned char *rgb = s->colour + 3 * (size_t)(s->apart ? s->facet[i / 3] : s->point[i]);
    for (int k = 0; k < 3; k++)
      put_f32(writer, (float)bwi_linear_light(rgb[k]));
  }
}

bw_status bwi_gltf_write(bw_writer *writer, const bw_surface *surface,
                         const bw_surface_write_options *options) {
  bw_status status = BW_OK;
  bw_context *context = bwi_writer_context(writer);
  double unit = options->unit > 0 ? options->unit : 1;
  bwi_growing text = {.context = context};
  scene s = {.surface = surface,
             .colour = options->colour,
             .apart = options->colour && options->colour_on_facets};
  s.object_of = BW_NEW(context, int32_t, surface->point_count + 1);
  s.number = BW_NEW(context, int32_t, surface->point_count + 1);
  s.point = BW_NEW(context, int32_t, surface->point_count + 1);
  s.facet = BW_NEW(context, int32_t, surface->triangle_count + 1);
  BW_TRY_MEMORY(s.object_of && s.number && s.point && s.facet);
  BW_TRY(bwi_surface_objects(context, surface, s.object_of, &s.object_count));
  s.object = BW_NEW0(context, range, s.object_count);
  BW_TRY_MEMORY(s.object);
  sort_by_object(&s);
  BW_TRY(find_boxes(context, &s, unit));
  size_t point_bytes = POINT_BYTES * (size_t)s.point_count;
  size_t index_bytes = 3 * INDEX_BYTES * (size_t)surface->triangle_count;
  print_json(&text, &s, point_bytes, index_bytes);
  BW_TRY(text.status);
  size_t bytes = index_bytes + point_bytes + (s.colour ? point_bytes : 0);
  if (bytes + text.count > UINT32_MAX - 28)
    BW_TRY(bw_fail(context, BW_LIMIT, "the surface takes %.1f GB in glTF, which has at most 4 GB",
                   1e-9 * (double)bytes));
  bw_writer_bytes(writer, "glTF", 4);
  put_u32(writer, 2);
  put_u32(writer, (uint32_t)(28 + text.count + bytes));
  put_u32(writer, (uint32_t)text.count);
  bw_writer_bytes(writer, "JSON", 4);
  bw_writer_bytes(writer, text.at, text.count);
  put_u32(writer, (uint32_t)bytes);
  bw_writer_bytes(writer, "BIN", 4);
  put_arrays(writer, &s, unit);
  status = bw_writer_bytes(writer, NULL, 0);
done:
  bw_free(text.at);
  bw_free(s.object_of);
  bw_free(s.number);
  bw_free(s.point);
  bw_free(s.facet);
  bw_free(s.object);
  return status;
}
