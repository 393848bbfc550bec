/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* The starter's side: runs OpenCASCADE in a child process and takes its result apart. */
#include <math.h>
#include <string.h>

#include "barwright/occt.h"
#include "occt/internal.h"

static const double SECONDS = 300; /* of computing that a file may take */
static const double WALL_FACTOR = 6;
static const double MILLIMETRE = 1e-3;
static const double ANGLE = 0.2;

/* The block of `count` members of the stream, which is moved behind it; NULL: it is too short. */
static const void *take(const unsigned char **at, size_t *left, int64_t count, size_t size) {
  const void *block = *at;
  if (count < 0 || (size_t)count > *left / size)
    return NULL;
  *at += (size_t)count * size;
  *left -= (size_t)count * size;
  return block;
}

static const char *next_name(const char **at, const char *end) {
  const char *name = *at, *zero = memchr(name, 0, (size_t)(end - name));
  if (zero)
    *at = zero + 1;
  return zero ? name : "";
}

static bw_status fail_broken(bw_context *context) {
  return bw_fail(context, BW_INTERNAL, "what the process of OpenCASCADE wrote is no body");
}

/* The surface of one body, whose points stand together. */
static bw_status body_surface(bw_context *context, const bw_surface *all, const bwi_occt_body *body,
                              bw_surface **surface) {
  bw_status status;
  int32_t *triangle = NULL;
  int64_t first = body->first_triangle, count = body->triangle_count;
  int32_t low = INT32_MAX, high = -1;
  if (first < 0 || count < 0 || first > all->triangle_count - count)
    return fail_broken(context);
  const int32_t *from = all->triangle + 3 * first;
  triangle = BW_NEW(context, int32_t, 3 * count);
  BW_TRY_MEMORY(triangle);
  for (int64_t i = 0; i < 3 * count; i++) {
    low = from[i] < low ? from[i] : low;
    high = from[i] > high ? from[i] : high;
  }
  for (int64_t i = 0; i < 3 * count; i++)
    triangle[i] = from[i] - low;
  BW_TRY(bw_surface_copy(context, count > 0 ? (int64_t)high - low + 1 : 0,
                         all->point + (count > 0 ? 3 * (size_t)low : 0), count, triangle,
                         all->group + first, surface));
  (*surface)->names = bw_retain(all->names);
done:
  bw_free(triangle);
  return status;
}

/* The surface of the file gets the names of its faces, which are its groups. */
static bw_status name_faces(bw_context *context, bw_cad_file *file) {
  bw_status status = BW_OK;
  bw_name *name = BW_NEW0(context, bw_name, file->face_count);
  BW_TRY_MEMORY(name);
  for (int32_t i = 0; i < file->face_count; i++) {
    size_t length = strnlen(file->face[i].name, BW_NAME);
    for (; length == BW_NAME || ((unsigned char)file->face[i].name[length] & 0xC0) == 0x80;)
      length--; /* cut before a whole character */
    memcpy(name[i].text, file->face[i].name, length);
  }
  BW_TRY(bw_face_names_create(context, file->face_count, name, NULL, &file->surface->names));
done:
  bw_free(name);
  return status;
}

static bw_status decode(bw_context *context, const unsigned char *at, size_t left, double unit,
                        bw_cad_file *file) {
  bw_status status = BW_OK;
  bwi_occt_head head;
  double *point = NULL;
  if (left < sizeof head)
    return fail_broken(context);
  memcpy(&head, at, sizeof head);
  at += sizeof head, left -= sizeof head;
  const unsigned char *points = take(&at, &left, head.points, 3 * sizeof(double));
  const unsigned char *triangles = points ? take(&at, &left, head.triangles, 12) : NULL;
  const unsigned char *groups = triangles ? take(&at, &left, head.triangles, 4) : NULL;
  const unsigned char *bodies =
      groups ? take(&at, &left, head.bodies, sizeof(bwi_occt_body)) : NULL;
  const unsigned char *faces = bodies ? take(&at, &left, head.faces, sizeof(bwi_occt_face)) : NULL;
  const unsigned char *names = faces ? take(&at, &left, head.name_bytes, 1) : NULL;
  if (!names || head.bodies > INT32_MAX || head.faces > INT32_MAX)
    return fail_broken(context);
  double scale = unit > 0 ? MILLIMETRE * unit / head.metres_per_unit : MILLIMETRE;
  file->metres_per_unit = unit > 0 ? unit : head.metres_per_unit;
  file->body_count = (int32_t)head.bodies;
  file->face_count = (int32_t)head.faces;
  point = BW_NEW(context, double, 3 * head.points);
  file->body = BW_NEW0(context, bw_cad_body, head.bodies);
  file->face = BW_NEW0(context, bw_cad_face, head.faces);
  file->names = BW_NEW(context, char, head.name_bytes + 1);
  BW_TRY_MEMORY(point && file->body && file->face && file->names);
  memcpy(file->names, names, (size_t)head.name_bytes);
  memcpy(point, points, (size_t)head.points * 3 * sizeof(double));
  for (int64_t i = 0; i < 3 * head.points; i++)
    point[i] *= scale;
  const char *name = file->names, *end = name + head.name_bytes;
  for (int32_t i = 0; i < file->body_count; i++) {
    bwi_occt_body from;
    memcpy(&from, bodies + (size_t)i * sizeof from, sizeof from);
    file->body[i] = (bw_cad_body){.name = next_name(&name, end),
                                  .closed = from.closed != 0,
                                  .volume = from.volume * scale * scale * scale,
                                  .area = from.area * scale * scale};
  }
  for (int32_t i = 0; i < file->face_count; i++) {
    bwi_occt_face from;
    memcpy(&from, faces + (size_t)i * sizeof from, sizeof from);
    file->face[i] = (bw_cad_face){.name = next_name(&name, end),
                                  .kind = (bw_cad_kind)from.kind,
                                  .body = (int32_t)from.body,
                                  .area = from.area * scale * scale,
                                  .radius = from.radius * scale};
  }
  /* Blocks of the stream begin at multiples of 4 bytes. */
  BW_TRY(bw_surface_copy(context, head.points, point, head.triangles, (const void *)triangles,
                         (const void *)groups, &file->surface));
  BW_TRY(name_faces(context, file));
  for (int32_t i = 0; i < file->body_count; i++) {
    bwi_occt_body from;
    memcpy(&from, bodies + (size_t)i * sizeof from, sizeof from);
    BW_TRY(body_surface(context, file->surface, &from, &file->body[i].surface));
  }
done:
  bw_free(point);
  return status;
}

bw_status bw_occt_read(bw_context *context, const char *name, const unsigned char *bytes,
                       size_t count, const bw_cad_options *options, bw_cad_file *file) {
  static const bw_cad_options defaults = {0};
  const bw_cad_options *given = options ? options : &defaults;
  double angle = given->angle > 0 ? given->angle : ANGLE;
  bwi_occt_request request = {name, bytes, count, given->tolerance, given->unit, angle};
  double memory = bw_available_memory();
  bw_job_options limits = {.name = "reading the CAD file",
                           .processor_seconds = SECONDS,
                           .seconds = WALL_FACTOR * SECONDS,
                           .bytes = isfinite(memory) ? memory : 0,
                           .show = true};
  bw_job *job = NULL;
  bw_cad_file read = {0};
  const unsigned char *result;
  size_t length;
  int which = -1;
  bw_status status;
  BW_TRY(bw_job_start(context, &limits, bwi_occt_child, &request, &job));
  BW_TRY(bw_jobs_wait(context, 1, &job, INFINITY, &which));
  bw_job_usage usage;
  bw_job_read_usage(job, &usage);
  if (usage.state == BW_JOB_CRASHED)
    BW_TRY(bw_fail(context, BW_FORMAT, "%s: OpenCASCADE stopped at this file (signal %d)", name,
                   usage.signal));
  BW_TRY(bw_job_result(context, job, &result, &length));
  const char *format = bw_cad_format(bytes, count);
  strncpy(read.format, format ? format : "", sizeof read.format - 1);
  BW_TRY(decode(context, result, length, given->unit, &read));
  *file = read;
done:
  if (status != BW_OK)
    bw_cad_file_clear(&read);
  bw_release(job);
  return status;
}
