/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* Surfaces into files of any format, by the ending of the path, with colours and fields where the
 * format has a place for them. */
#include "io/surface_write.h"

#include "io/formats.h"
#include "io/gltf.h"
#include "io/raw.h"

typedef struct format {
  const char *ending;
  bool facet_colours, point_colours, fields;
} format;

static const format formats[] = {
    {"stl", false, false, false}, {"obj", false, true, false},   {"off", false, false, false},
    {"ply", true, true, true},    {"3mf", true, true, false},    {"glb", true, true, false},
    {"usda", true, true, true},   {"step", false, false, false}, {"stp", false, false, false},
    {"vtu", false, false, true},  {"msh", false, false, false}};

static const format *format_of(const char *path) {
  for (size_t i = 0; i < sizeof formats / sizeof *formats; i++)
    if (bwi_has_ending(path, formats[i].ending))
      return &formats[i];
  return NULL;
}

static bw_status check(bw_context *context, const bw_surface *surface, const char *path,
                       const bw_surface_write_options *options, bool vtu) {
  const format *found = format_of(path);
  if (!found)
    return bw_fail(context, BW_INVALID,
                   "%s: the ending '%s' names no format that surfaces are written in: use .stl "
                   ".obj .ply .off .3mf .glb .usda .step .vtu or .msh",
                   path, bwi_ending(path));
  if (options->colour && !found->point_colours)
    return bw_fail(context, BW_INVALID, "%s: .%s has no colours: use .glb .usda .ply .obj or .3mf",
                   path, found->ending);
  if (options->colour && options->colour_on_facets && !found->facet_colours)
    return bw_fail(context, BW_INVALID,
                   "%s: .%s has colours of points only, not of facets: use .glb .usda .ply or "
                   ".3mf",
                   path, found->ending);
  if (options->field_count > 0 && !found->fields)
    return bw_fail(context, BW_INVALID, "%s: .%s has no fields: use .vtu .ply or .usda", path,
                   found->ending);
  for (int i = 0; !vtu && i < options->field_count; i++)
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
  bool vtu = bwi_has_ending(path, "vtu");
  bw_status status = check(context, surface, path, options, vtu);
  if (status != BW_OK)
    return status;
  if (vtu)
    return bw_surface_write_vtu(context, surface, path, options->field_count, options->fields);
  if (bwi_has_ending(path, "msh"))
    return bwi_msh_write_surface(context, surface, path, options->ascii);
  if (bwi_has_ending(path, "3mf"))
    return bwi_3mf_write(context, surface, path, options);
  bw_writer *writer = NULL;
  status = bw_writer_open(context, path, &writer);
  if (status != BW_OK)
    return status;
  bool step = bwi_has_ending(path, "step") || bwi_has_ending(path, "stp");
  status = step                          ? bwi_step_write(writer, surface, options)
           : bwi_has_ending(path, "stl") ? bwi_stl_write(writer, surface, options->ascii)
           : bwi_has_ending(path, "obj") ? bwi_obj_write(writer, surface, options)
           : bwi_has_ending(path, "off") ? bwi_off_write(writer, surface)
           : bwi_has_ending(path, "ply") ? bwi_ply_write(writer, surface, options)
           : bwi_has_ending(path, "glb") ? bwi_gltf_write(writer, surface, options)
                                         : bwi_usd_write(writer, surface, options);
  if (status == BW_OK)
    return bw_writer_commit(writer);
  bw_writer_discard(writer);
  return status;
}

bw_status bw_surface_write(bw_context *context, const bw_surface *surface, const char *path,
                           bool ascii) {
  return bw_surface_write_with(context, surface, path, &(bw_surface_write_options){.ascii = ascii});
}
