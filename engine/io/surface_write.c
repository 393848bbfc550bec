/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* Surfaces into files of any format, by the ending of the path, with colours and fields where the
 * format has a place for them. */
#include "io/surface_write.h"

#include "io/formats.h"
#include "io/gltf.h"
#include "io/raw.h"

static bw_status write_stl(bw_writer *writer, const bw_surface *surface,
                           const bw_surface_write_options *options) {
  return bwi_stl_write(writer, surface, options->ascii);
}

static bw_status write_off(bw_writer *writer, const bw_surface *surface,
                           const bw_surface_write_options *options) {
  (void)options;
  return bwi_off_write(writer, surface);
}

static bw_status write_vtu(bw_context *context, const bw_surface *surface, const char *path,
                           const bw_surface_write_options *options) {
  return bw_surface_write_vtu(context, surface, path, options->field_count, options->fields);
}

static bw_status write_msh(bw_context *context, const bw_surface *surface, const char *path,
                           const bw_surface_write_options *options) {
  return bwi_msh_write_surface(context, surface, path, options->ascii);
}

enum { POINT_COLOURS = 1, FACET_COLOURS = 2, FIELDS = 4, VECTORS = 8 };

typedef struct format {
  const char *ending;
  int has; /* of the above; VECTORS: fields of several components */
  bw_status (*write)(bw_writer *writer, const bw_surface *surface,
                     const bw_surface_write_options *options);
  bw_status (*write_file)(bw_context *context, const bw_surface *surface, const char *path,
                          const bw_surface_write_options *options); /* where it opens the file */
} format;

static const format formats[] = {
    {"stl", 0, write_stl, NULL},
    {"obj", POINT_COLOURS, bwi_obj_write, NULL},
    {"off", 0, write_off, NULL},
    {"ply", POINT_COLOURS | FACET_COLOURS | FIELDS, bwi_ply_write, NULL},
    {"3mf", POINT_COLOURS | FACET_COLOURS, NULL, bwi_3mf_write},
    {"glb", POINT_COLOURS | FACET_COLOURS, bwi_gltf_write, NULL},
    {"usda", POINT_COLOURS | FACET_COLOURS | FIELDS, bwi_usd_write, NULL},
    {"step", 0, bwi_step_write, NULL},
    {"stp", 0, bwi_step_write, NULL},
    {"vtu", FIELDS | VECTORS, NULL, write_vtu},
    {"msh", 0, NULL, write_msh},
};

static const format *format_of(const char *path) {
  for (size_t i = 0; i < sizeof formats / sizeof *formats; i++)
    if (bwi_has_ending(path, formats[i].ending))
      return &formats[i];
  return NULL;
}

static bw_status check(bw_context *context, const bw_surface *surface, const char *path,
                       const bw_surface_write_options *options, const format *found) {
  if (!found)
    return bw_fail(context, BW_INVALID,
                   "%s: the ending '%s' names no format that surfaces are written in: use .stl "
                   ".obj .ply .off .3mf .glb .usda .step .vtu or .msh",
                   path, bwi_ending(path));
  if (options->colour && !(found->has & POINT_COLOURS))
    return bw_fail(context, BW_INVALID, "%s: .%s has no colours: use .glb .usda .ply .obj or .3mf",
                   path, found->ending);
  if (options->colour && options->colour_on_facets && !(found->has & FACET_COLOURS))
    return bw_fail(context, BW_INVALID,
                   "%s: .%s has colours of points only, not of facets: use .glb .usda .ply or "
                   ".3mf",
                   path, found->ending);
  if (options->field_count > 0 && !(found->has & FIELDS))
    return bw_fail(context, BW_INVALID, "%s: .%s has no fields: use .vtu .ply or .usda", path,
                   found->ending);
  for (int i = 0; !(found->has & VECTORS) && i < options->field_count; i++)
    if (options->fields[i].array->columns != 1)
      return bw_fail(
          context, BW_INVALID,
          "%s: field '%s' has %lld components: .%s has fields of one, .vtu of any number", path,
          options->fields[i].name, (long long)options->fields[i].array->columns, found->ending);
  return bwi_check_fields(context, surface->point_count, surface->triangle_count,
                          options->field_count, options->fields);
}

bw_status bw_surface_write_with(bw_context *context, const bw_surface *surface, const char *path,
                                const bw_surface_write_options *options) {
  static const bw_surface_write_options none = {0};
  options = options ? options : &none;
  const format *found = format_of(path);
  bw_status status = check(context, surface, path, options, found);
  if (status != BW_OK)
    return status;
  if (found->write_file)
    return found->write_file(context, surface, path, options);
  bw_writer *writer = NULL;
  status = bw_writer_open(context, path, &writer);
  if (status != BW_OK)
    return status;
  status = found->write(writer, surface, options);
  if (status == BW_OK)
    return bw_writer_commit(writer);
  bw_writer_discard(writer);
  return status;
}

bw_status bw_surface_write(bw_context *context, const bw_surface *surface, const char *path,
                           bool ascii) {
  return bw_surface_write_with(context, surface, path, &(bw_surface_write_options){.ascii = ascii});
}
