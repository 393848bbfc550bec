/* Groups of a surface's facets on the boundary of a mesh.
 *
 * Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
#include <string.h>

#include "barwright/boolean.h"
#include "mesh/surface_internal.h"

bw_status bw_groups_on_mesh(bw_context *context, const bw_surface *surface, const bw_mesh *mesh,
                            int32_t *group) {
  bw_surface *boundary = NULL;
  bw_status status = BW_OK;
  if (!surface->group || surface->triangle_count == 0)
    return bw_fail(context, BW_INVALID, "the surface has no groups");
  BW_TRY(bw_mesh_boundary(context, mesh, &boundary, NULL));
  bw_free(boundary->group); /* of the surface that the mesh was filled from */
  boundary->group = NULL;
  BW_TRY(bwi_take_groups(context, surface, boundary));
  if (mesh->facet_count)
    memcpy(group, boundary->group, (size_t)mesh->facet_count * sizeof *group);
done:
  bw_release(boundary);
  return status;
}
