/* Taking self-intersections out locally.
 *
 * Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
#include "mesh/surface_cgal.hpp"

#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/Polygon_mesh_processing/repair_self_intersections.h>

using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;

bw_status bwi_cgal_resolve(bw_context *context, void *data, bwi_child_stream *out) {
  const bw_surface *surface = static_cast<const bw_surface *>(data);
  try {
    CGAL::Surface_mesh<Kernel::Point_3> mesh;
    if (!bwi::load(surface, nullptr, 0, false, mesh))
      return bw_fail(context, BW_GEOMETRY,
                     "self-intersections can be removed from manifold surfaces only");
    namespace steps = CGAL::Polygon_mesh_processing::experimental;
    if (!steps::remove_self_intersections(mesh, CGAL::parameters::preserve_genus(false)))
      return bw_fail(context, BW_GEOMETRY, "not every self-intersection could be removed");
    return bwi::store_sorted(out, mesh);
  } catch (...) {
    return bwi::caught(context, "taking out self-intersections");
  }
}
