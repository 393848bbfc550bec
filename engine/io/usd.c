/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* USD as text, .usda: a component with a mesh for each object. Colours are linear light in
 * displayColor, fields are primvars; both are numbers of 32 bits. It is not read. */
#include <math.h>

#include "io/surface_write.h"

typedef struct scene {
  const bw_surface *surface;
  const bw_surface_write_options *options;
  int32_t *object_of, *local; /* of points: object, number in it */
  int32_t object;             /* that is being written */
} scene;

static bool has_point(const scene *s, int32_t i) {
  return s->object_of[i] == s->object;
}

static bool has_facet(const scene *s, int32_t i) {
  return has_point(s, s->surface->triangle[3 * (size_t)i]);
}

static bool has(const scene *s, bool facets, int32_t i) {
  return facets ? has_facet(s, i) : has_point(s, i);
}

static int32_t count_of(const scene *s, bool facets) {
  return facets ? s->surface->triangle_count : s->surface->point_count;
}

/* Separates the entries of a list, with a new line now and then. */
static void next(bw_writer *writer, int64_t number) {
  if (number > 0)
    bw_writer_print(writer, number % 16 == 0 ? ",\n" : ", ");
}

static void put_real(bw_writer *writer, double value) {
  if (isnan(value))
    bw_writer_print(writer, "nan");
  else if (isinf(value) || fabs(value) > 3.4e38)
    bw_writer_print(writer, value > 0 ? "inf" : "-inf");
  else
    bw_writer_print(writer, "%.9g", value);
}

static void put_vector(bw_writer *writer, const double x[3]) {
  for (int k = 0; k < 3; k++) {
    bw_writer_print(writer, k ? ", " : "(");
    put_real(writer, x[k]);
  }
  bw_writer_print(writer, ")");
}

static void put_points(bw_writer *writer, scene *s) {
  double min[3] = {HUGE_VAL, HUGE_VAL, HUGE_VAL}, max[3] = {-HUGE_VAL, -HUGE_VAL, -HUGE_VAL};
  int32_t count = 0;
  bw_writer_print(writer, "        point3f[] points = [");
  for (int32_t i = 0; i < s->surface->point_count; i++) {
    if (!has_point(s, i))
      continue;
    const double *x = s->surface->point + 3 * (size_t)i;
    for (int k = 0; k < 3; k++) {
      min[k] = x[k] < min[k] ? x[k] : min[k];
      max[k] = x[k] > max[k] ? x[k] : max[k];
    }
    next(writer, count);
    put_vector(writer, x);
    s->local[i] = count++;
  }
  bw_writer_print(writer, "]\n        float3[] extent = [");
  put_vector(writer, min);
  bw_writer_print(writer, ", ");
  put_vector(writer, max);
  bw_writer_print(writer, "]\n");
}

static void put_facets(bw_writer *writer, const scene *s) {
  int64_t count = 0;
  bw_writer_print(writer, "        int[] faceVertexIndices = [");
  for (int32_t i = 0; i < s->surface->triangle_count; i++)
    for (size_t k = 0; has_facet(s, i) && k < 3; k++) {
      next(writer, count++);
      bw_writer_print(writer, "%d", (int)s->local[s->surface->triangle[3 * (size_t)i + k]]);
    }
  bw_writer_print(writer, "]\n        int[] faceVertexCounts = [");
  for (int64_t i = 0; i < count / 3; i++) {
    next(writer, i);
    bw_writer_print(writer, "3");
  }
  bw_writer_print(writer, "]\n");
}

static void put_interpolation(bw_writer *writer, bool facets) {
  bw_writer_print(writer, "] (\n            interpolation = \"%s\"\n        )\n",
                  facets ? "uniform" : "vertex");
}

static void put_colours(bw_writer *writer, const scene *s) {
  bool facets = s->options->colour_on_facets;
  int64_t count = 0;
  bw_writer_print(writer, "        color3f[] primvars:displayColor = [");
  for (int32_t i = 0; i < count_of(s, facets); i++) {
    if (!has(s, facets, i))
      continue;
    const unsigned char *rgb = s->options->colour + 3 * (size_t)i;
    next(writer, count++);
    put_vector(writer, (double[3]){bwi_linear_light(rgb[0]), bwi_linear_light(rgb[1]),
                                   bwi_linear_light(rgb[2])});
  }
  put_interpolation(writer, facets);
}

static void put_field(bw_writer *writer, const scene *s, const bw_field *field) {
  bool facets = field->place == BW_ON_ELEMENTS;
  int64_t count = 0;
  bw_writer_print(writer, "        float[] primvars:");
  for (const char *c = field->name; *c; c++) {
    bool letter = (*c >= 'a' && *c <= 'z') || (*c >= 'A' && *c <= 'Z');
    bool digit = *c >= '0' && *c <= '9';
    if (c == field->name && digit)
      bw_writer_print(writer, "_");
    bw_writer_bytes(writer, letter || digit ? c : "_", 1);
  }
  bw_writer_print(writer, " = [");
  for (int32_t i = 0; i < count_of(s, facets); i++) {
    if (!has(s, facets, i))
      continue;
    next(writer, count++);
    put_real(writer, bw_array_get(field->array, i, 0));
  }
  put_interpolation(writer, facets);
}

bw_status bwi_usd_write(bw_writer *writer, const bw_surface *surface,
                        const bw_surface_write_options *options) {
  bw_status status = BW_OK;
  bw_context *context = bwi_writer_context(writer);
  scene s = {.surface = surface, .options = options};
  int32_t count;
  s.object_of = BW_NEW(context, int32_t, surface->point_count + 1);
  s.local = BW_NEW(context, int32_t, surface->point_count + 1);
  BW_TRY_MEMORY(s.object_of && s.local);
  BW_TRY(bwi_surface_objects(context, surface, s.object_of, &count));
  bw_writer_print(writer, "#usda 1.0\n(\n    defaultPrim = \"barwright\"\n    metersPerUnit = ");
  bw_writer_number(writer, options->unit > 0 ? options->unit : 1);
  bw_writer_print(writer, "\n    upAxis = \"Z\"\n)\n\ndef Xform \"barwright\" (\n"
                          "    kind = \"component\"\n)\n{\n");
  for (s.object = 0; s.object < count; s.object++) {
    bw_writer_print(writer, "    def Mesh \"group_%d\"\n    {\n", (int)s.object + 1);
    put_points(writer, &s);
    put_facets(writer, &s);
    bw_writer_print(writer, "        uniform token subdivisionScheme = \"none\"\n");
    if (options->colour)
      put_colours(writer, &s);
    for (int k = 0; k < options->field_count; k++)
      put_field(writer, &s, &options->fields[k]);
    bw_writer_print(writer, "    }\n");
  }
  bw_writer_print(writer, "}\n");
  status = bw_writer_bytes(writer, NULL, 0);
done:
  bw_free(s.object_of);
  bw_free(s.local);
  return status;
}
