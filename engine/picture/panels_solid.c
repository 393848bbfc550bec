/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* What a panel shows: the boundary of a grid's elements, or a surface that is embedded in it,
 * moved, with its colours; and the same where it was, as a ghost. */
#include <math.h>
#include <string.h>

#include "picture/panels.h"

/* The boundary's quadrilaterals, halved; points are all nodes, moved by factor times u. */
static bw_status fill_solid(bwi_panel_sheet *s, int which, const bw_grid_face *face, int64_t faces,
                            double factor, bwi_solid *solid) {
  const bw_grid *grid = s->panel[which].grid;
  const double *u = s->panel[which].displacement;
  solid->point = BW_NEW(s->context, double, 3 * (int64_t)grid->node_count);
  solid->triangle = BW_NEW(s->context, int32_t, 6 * faces);
  if (!solid->point || !solid->triangle)
    return BW_MEMORY;
  solid->point_count = grid->node_count;
  solid->triangle_count = (int32_t)(2 * faces);
  solid->quads = true;
  for (int32_t n = 0; n < grid->node_count; n++) {
    double *at = solid->point + 3 * (int64_t)n;
    bw_grid_position(grid, n, at);
    for (int d = 0; d < 3 && u && factor != 0; d++)
      if (!(fabs(at[d] += factor * u[3 * (int64_t)n + d]) < 1e150))
        return bw_fail(s->context, BW_INVALID,
                       "panel %d: the displacement of node %d along %c is %g: too large for a "
                       "picture",
                       which + 1, (int)n + 1, "xyz"[d], u[3 * (int64_t)n + d]);
  }
  for (int64_t f = 0; f < faces; f++) {
    static const int half[6] = {0, 1, 2, 0, 2, 3};
    for (int k = 0; k < 6; k++)
      solid->triangle[6 * f + k] = face[f].node[half[k]];
  }
  return BW_OK;
}

/* The surface's points, moved by factor times what the nodes' displacements are there. */
static bw_status fill_surface(bwi_panel_sheet *s, int which, double factor, bwi_solid *solid) {
  const bw_grid_panel *panel = &s->panel[which];
  const bw_surface *surface = panel->surface;
  size_t points = 3 * (size_t)surface->point_count, corners = 3 * (size_t)surface->triangle_count;
  solid->point = BW_NEW(s->context, double, points);
  solid->triangle = BW_NEW(s->context, int32_t, corners);
  if (!solid->point || !solid->triangle)
    return BW_MEMORY;
  solid->point_count = surface->point_count;
  solid->triangle_count = surface->triangle_count;
  solid->inverted = bw_surface_volume(surface) < 0;
  memcpy(solid->triangle, surface->triangle, corners * sizeof *solid->triangle);
  if (panel->displacement && factor != 0)
    bw_embedding_values(panel->embedding, 3, panel->displacement, solid->point);
  else
    memset(solid->point, 0, points * sizeof *solid->point);
  for (size_t i = 0; i < points; i++) {
    solid->point[i] = surface->point[i] + factor * solid->point[i];
    if (!(fabs(solid->point[i]) < 1e150))
      return bw_fail(s->context, BW_INVALID,
                     "panel %d: the displacement at point %zu of the surface is too large for a "
                     "picture",
                     which + 1, i / 3 + 1);
  }
  return BW_OK;
}

/* Values and materials come through the embedding. */
static bw_status add_surface(bwi_panel_sheet *s, int which) {
  bw_status status = BW_OK;
  const bw_grid_panel *panel = &s->panel[which];
  const bw_embedding *embedding = panel->embedding;
  const bw_surface *surface = panel->surface;
  bwi_solid *body = &s->solid[which][0], *ghost = &s->solid[which][1];
  if (!embedding || embedding->grid != panel->grid ||
      embedding->point_count != surface->point_count)
    return bw_fail(s->context, BW_INVALID,
                   "panel %d: its surface needs an embedding of its points in the panel's grid",
                   which + 1);
  body->finish = BWI_BODY;
  ghost->finish = BWI_GHOST;
  BW_TRY(fill_surface(s, which, s->options->deformation, body));
  if (s->options->ghost && panel->displacement)
    BW_TRY(fill_surface(s, which, 0, ghost));
  s->category[which] = BW_NEW(s->context, int32_t, surface->triangle_count);
  s->value[which] = panel->value ? BW_NEW(s->context, double, surface->point_count) : NULL;
  BW_TRY_MEMORY(s->category[which] && (!panel->value || s->value[which]));
  for (int64_t f = 0; f < surface->triangle_count; f++) {
    int32_t m = panel->grid->material[embedding->element[surface->triangle[3 * f]]];
    s->category[which][f] = m - 1;
    if (!panel->value && m > s->max_material)
      s->max_material = m;
  }
  if (panel->value && !panel->on_elements)
    bw_embedding_values(embedding, 1, panel->value, s->value[which]);
  for (int64_t i = 0; i < surface->point_count && panel->value && panel->on_elements; i++)
    s->value[which][i] = panel->value[embedding->element[i]];
  body->category = s->category[which];
  body->value = s->value[which];
done:
  return status;
}

bw_status bwi_panel_solids(bwi_panel_sheet *s, int which) {
  if (s->panel[which].surface)
    return add_surface(s, which);
  bw_status status;
  const bw_grid_panel *panel = &s->panel[which];
  const bw_grid_picture_options *o = s->options;
  bwi_solid *body = &s->solid[which][0], *ghost = &s->solid[which][1];
  bw_grid_face *face = NULL;
  int64_t faces;
  BW_TRY(bw_grid_boundary(s->context, panel->grid, &face, &faces));
  if (faces > INT32_MAX / 4)
    BW_TRY(
        bw_fail(s->context, BW_LIMIT, "%lld faces are too many for one picture", (long long)faces));
  body->finish = BWI_BODY;
  ghost->finish = BWI_GHOST;
  body->edges = o->edges;
  BW_TRY(fill_solid(s, which, face, faces, o->deformation, body));
  if (o->ghost && panel->displacement)
    BW_TRY(fill_solid(s, which, face, faces, 0, ghost));
  s->category[which] = BW_NEW(s->context, int32_t, 2 * faces);
  s->value[which] = panel->on_elements ? BW_NEW(s->context, double, 2 * faces) : NULL;
  BW_TRY_MEMORY(s->category[which] && (!panel->on_elements || s->value[which]));
  for (int64_t f = 0; f < 2 * faces; f++) {
    int32_t e = face[f / 2].element, material = panel->grid->material[e];
    s->category[which][f] = material - 1;
    if (!panel->value && material > s->max_material)
      s->max_material = material;
    if (s->value[which] && panel->value)
      s->value[which][f] = panel->value[e];
  }
  body->category = s->category[which];
  body->on_facets = panel->on_elements && panel->value;
  body->value = body->on_facets ? s->value[which] : panel->value;
done:
  bw_free(face);
  return status;
}
