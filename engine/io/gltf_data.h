/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* The values, buffers and accessors of a glTF file, of which nothing is trusted. */
#ifndef BWI_IO_GLTF_DATA_H
#define BWI_IO_GLTF_DATA_H

#include "io/internal.h"
#include "io/json.h"

typedef struct bwi_gltf_list { /* the elements of an array of the root */
  int32_t *value;
  int64_t count;
} bwi_gltf_list;

typedef struct bwi_gltf_block { /* a buffer */
  const unsigned char *at;
  size_t count;
  unsigned char *owned;
  bool open;
} bwi_gltf_block;

typedef struct bwi_gltf_accessor {
  const unsigned char *at;
  size_t stride;
  int64_t count, type;
  bool normalised;
} bwi_gltf_accessor;

typedef struct bwi_gltf {
  bw_context *context;
  const bwi_cursor *file;
  bwi_json json;
  bwi_gltf_list accessor, view, buffer;
  const unsigned char *chunk; /* binary part of a .glb */
  size_t chunk_count;
  bwi_gltf_block *block; /* (buffer.count) */
  unsigned char **copy;  /* (accessor.count) its elements, some of them replaced; or NULL */
  double copied;         /* bytes of the copies */
  double bytes;          /* of the file and of those beside it */
} bwi_gltf;

/* The lists of accessors and buffers of the JSON that was parsed. */
bw_status bwi_gltf_open(bwi_gltf *g);
void bwi_gltf_clear(bwi_gltf *g);

const bwi_json_value *bwi_gltf_value(const bwi_gltf *g, int32_t value);
/* Fails at the place of a value. */
bw_status bwi_gltf_fail(const bwi_gltf *g, int32_t value, const char *format, ...) BW_PRINTF(3, 4);
/* A member that is an integer from 0 to limit - 1. missing: its value where there is none, -1: it
 * must be there. */
bw_status bwi_gltf_integer(const bwi_gltf *g, int32_t of, const char *key, int64_t limit,
                           int64_t missing, int64_t *value);
/* `count` numbers into `out`, which stays as it is where the member is not there. */
bw_status bwi_gltf_reals(const bwi_gltf *g, int32_t of, const char *key, int count, double *out);
/* An array of objects, or none. */
bw_status bwi_gltf_list_of(const bwi_gltf *g, int32_t of, const char *key, bwi_gltf_list *out);

/* The accessor of a number, of "SCALAR" or "VEC3" with 1 or 3 components. */
bw_status bwi_gltf_accessor_open(bwi_gltf *g, int64_t index, const char *type, size_t components,
                                 bwi_gltf_accessor *out);
/* The bytes of a component of a type; 0: there is no such type. */
size_t bwi_gltf_component_size(int64_t type);
double bwi_gltf_component(const bwi_gltf_accessor *a, const unsigned char *at);

#endif
