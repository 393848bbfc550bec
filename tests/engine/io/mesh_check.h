/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* A mesh with fields to write, and comparisons of what comes back. */
#ifndef MESH_CHECK_H
#define MESH_CHECK_H

#include "io_check.h"

enum { FIELDS = 5 };
typedef struct sample {
  bw_mesh *mesh;
  bw_field field[FIELDS]; /* u (3), stress (6), id (int32), flag (uint8), big (int64, 2) */
} sample;

static inline void fill(bw_array *array, double scale) {
  for (int64_t i = 0; i < array->rows * array->columns; i++) {
    double value = sin((double)i) * scale;
    if (array->type == BW_F64)
      ((double *)array->data)[i] = i == 3 ? 1e300 : value;
    else if (array->type == BW_I32)
      ((int32_t *)array->data)[i] = (int32_t)(value * 1e9);
    else if (array->type == BW_I64)
      ((int64_t *)array->data)[i] = (int64_t)(value * 1e18);
    else
      ((uint8_t *)array->data)[i] = (uint8_t)(i * 7);
  }
}

/* A box of distorted elements; regions: NULL, or a value per element by number. */
static inline sample make_sample(bw_context *context, int order, bool regions) {
  sample s;
  bw_mesh *box;
  check_ok(context, bw_mesh_box_grid(context, (double[3]){0, 0, 0}, (double[3]){1, 0.3, 1e-3},
                                     (int[3]){3, 2, 2}, order, &box));
  double *x = malloc(sizeof *x * 3 * (size_t)box->node_count);
  int32_t *region = malloc(sizeof *region * (size_t)box->element_count);
  for (int i = 0; i < box->node_count * 3; i++)
    x[i] = box->node[i] + sin(i) * 1e-5 / 3 + (i % 3 == 1 ? 1e4 : 0);
  for (int i = 0; i < box->element_count; i++)
    region[i] = 1 + i % 5 / 2;
  check_ok(context, bw_mesh_copy(context, order, box->node_count, x, box->element_count,
                                 box->element, NULL, &s.mesh));
  if (regions)
    s.mesh = check_tagged(context, s.mesh, region);
  static const struct {
    const char *name;
    bw_field_place place;
    bw_type type;
    int columns;
  } kind[FIELDS] = {{"u", BW_ON_NODES, BW_F64, 3},
                    {"stress <&\"> x", BW_ON_ELEMENTS, BW_F64, 6},
                    {"id", BW_ON_ELEMENTS, BW_I32, 1},
                    {"flag", BW_ON_NODES, BW_U8, 1},
                    {"big", BW_ON_NODES, BW_I64, 2}};
  for (int f = 0; f < FIELDS; f++) {
    bw_array *array;
    int rows = kind[f].place == BW_ON_NODES ? s.mesh->node_count : s.mesh->element_count;
    check_ok(context, bw_array_create(context, kind[f].type, rows, kind[f].columns, &array));
    fill(array, 3.7);
    s.field[f] = (bw_field){kind[f].name, kind[f].place, array};
  }
  bw_release(box);
  free(x);
  free(region);
  return s;
}

static inline void free_sample(sample *s) {
  bw_release(s->mesh);
  for (int f = 0; f < FIELDS; f++)
    bw_release(s->field[f].array);
}

static inline void same_mesh(const bw_mesh *a, const bw_mesh *b) {
  assert_int_equal(a->order, b->order);
  assert_int_equal(a->node_count, b->node_count);
  assert_int_equal(a->element_count, b->element_count);
  assert_memory_equal(a->node, b->node, sizeof(double) * 3 * (size_t)a->node_count);
  assert_memory_equal(a->element, b->element,
                      sizeof(int32_t) * (size_t)(a->element_count * a->nodes_per_element));
  assert_int_equal(a->region != NULL, b->region != NULL);
  if (a->region)
    assert_memory_equal(a->region, b->region, sizeof(int32_t) * (size_t)a->element_count);
  assert_int_equal(a->region_count, b->region_count);
  for (int i = 0; i < a->region_count; i++) {
    assert_int_equal(a->regions[i].tag, b->regions[i].tag);
    assert_string_equal(a->regions[i].name.text, b->regions[i].name.text);
  }
}

static inline void same_field(const bw_mesh_file *file, const bw_field *field, bool types) {
  for (int i = 0; i < file->field_count; i++) {
    if (strcmp(file->field_name[i], field->name) != 0)
      continue;
    const bw_array *a = file->field_array[i], *b = field->array;
    assert_int_equal(file->field_place[i], field->place);
    assert_int_equal(a->rows, b->rows);
    assert_int_equal(a->columns, b->columns);
    if (types)
      assert_int_equal(a->type, b->type);
    for (int64_t r = 0; r < a->rows; r++)
      for (int64_t c = 0; c < a->columns; c++)
        assert_true(bw_array_get(a, r, c) == bw_array_get(b, r, c));
    return;
  }
  fail_msg("no field '%s' came back", field->name);
}

#endif
