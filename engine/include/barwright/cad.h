/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* cad: bodies bounded by curved surfaces, from STEP and IGES files, as triangles. */
#ifndef BARWRIGHT_CAD_H
#define BARWRIGHT_CAD_H

#include "barwright/mesh.h"

#ifdef __cplusplus
extern "C" {
#endif

/* These files are read by a library that the engine does not link: engine/occt, over OpenCASCADE.
 * Who loads it registers it here. */

/* How closely triangles follow curved surfaces. All zeros are the defaults. */
typedef struct bw_cad_options {
  double tolerance; /* (m) largest distance of a triangle's edge from its surface; 0: 1/2000 of the
                       diagonal of the box */
  double angle;     /* (rad) largest turn of the normal along a triangle; 0: 0.2 */
  double unit; /* (m) length of the file's unit, instead of what the file says; 0: as it says */
} bw_cad_options;

/* What carries a face. */
typedef enum bw_cad_kind {
  BW_CAD_PLANE,    /* a plane */
  BW_CAD_CYLINDER, /* a circular cylinder */
  BW_CAD_CONE,     /* a circular cone */
  BW_CAD_SPHERE,   /* a sphere */
  BW_CAD_TORUS,    /* a torus */
  BW_CAD_FREEFORM, /* any other surface */
  BW_CAD_KINDS     /* how many there are */
} bw_cad_kind;

/* A face of a body, as exact as the file has it; owned by a bw_cad_file. */
typedef struct bw_cad_face {
  const char *name; /* as in the file, or "face 7"; in a file each name is there once */
  bw_cad_kind kind; /* what carries it */
  int32_t body;     /* index of its body */
  double area;      /* (m2) */
  double radius;    /* (m) of a cylinder or sphere, the smaller one of a torus; otherwise 0 */
} bw_cad_face;

/* A body of the file; owned by a bw_cad_file. */
typedef struct bw_cad_body {
  const char *name;    /* as in the file, or "body 2"; each is there once */
  bool closed;         /* whether its faces bound a volume */
  double volume;       /* (m3) of the exact shape; 0 of an open one */
  double area;         /* (m2) likewise */
  bw_surface *surface; /* of this body alone; the same groups */
} bw_cad_body;

/* What a file holds; release it with bw_cad_file_clear. */
typedef struct bw_cad_file {
  bw_surface *surface;    /* all bodies; the group of a triangle is the index of its face */
  char format[8];         /* "STEP", "IGES" */
  double metres_per_unit; /* (m) the unit that was applied */
  int32_t body_count, face_count;
  bw_cad_body *body; /* body_count of them */
  bw_cad_face *face; /* face_count of them */
  char *names;       /* the texts that bodies and faces point to */
} bw_cad_file;
/* Releases what the file holds. */
BW_API void bw_cad_file_clear(bw_cad_file *file);

/* "plane", "cylinder", "cone", "sphere", "torus", "freeform" */
BW_API const char *bw_cad_kind_word(bw_cad_kind kind);

/* "STEP" or "IGES" where `count` bytes begin as such a file does; otherwise NULL.
 * The text is static. */
BW_API const char *bw_cad_format(const unsigned char *bytes, size_t count);

/* A reader of the content of a file: BW_FORMAT where it is damaged, BW_GEOMETRY where it holds no
 * faces, or where one has no triangles, BW_LIMIT where time or memory ran out. `name` stands for
 * the file in messages. */
typedef bw_status bw_cad_reader(bw_context *context, const char *name, const unsigned char *bytes,
                                size_t count, const bw_cad_options *options, bw_cad_file *file);
/* For the process; NULL: none. */
BW_API void bw_cad_register(bw_cad_reader *reader);

/* A file by the registered reader, with its statuses: BW_UNSUPPORTED where there is none,
 * BW_FORMAT for a file of another format. The triangles of a body
 * share their points, and face outwards where it is closed. `file` is written on success only. */
BW_API bw_status bw_cad_read(bw_context *context, const char *path, const bw_cad_options *options,
                             bw_cad_file *file);

#ifdef __cplusplus
}
#endif
#endif
