/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* What the child process that works with OpenCASCADE gives to its starter. */
#ifndef BWI_OCCT_INTERNAL_H
#define BWI_OCCT_INTERNAL_H

#include "barwright/cad.h"
#include "barwright/job.h"

#ifdef __cplusplus
extern "C" {
#endif

/* The stream: the head, then points, triangles, groups, bodies, faces and names in the counts that
 * it gives. Lengths are in millimetres, as OpenCASCADE has them. Names end with a 0 byte: those of
 * bodies, then those of faces. */
typedef struct bwi_occt_head {
  int64_t points, triangles, bodies, faces, name_bytes;
  double metres_per_unit;
} bwi_occt_head;

typedef struct bwi_occt_body {
  double volume, area;
  int64_t closed, first_triangle, triangle_count;
} bwi_occt_body;

typedef struct bwi_occt_face {
  double area, radius;
  int64_t kind, body;
} bwi_occt_face;

typedef struct bwi_occt_request {
  const char *name; /* of the file */
  const unsigned char *bytes;
  size_t count;
  double tolerance, unit; /* (m) 0: by the size, as the file says */
  double angle;           /* (rad) */
} bwi_occt_request;

/* A bw_job_work; data: a bwi_occt_request. */
bw_status bwi_occt_child(bw_context *context, void *data, bw_job_stream *out);

#ifdef __cplusplus
}
#endif
#endif
