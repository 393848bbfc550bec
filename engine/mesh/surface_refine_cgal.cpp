/* A surface with the points and edges that another one has in common with it.
 *
 * Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later.
 *
 * Constructions are exact, and rounded once at the end: what both surfaces share is rounded alike.
 */
#include "mesh/surface_cgal.hpp"

#include <CGAL/Exact_predicates_exact_constructions_kernel.h>
#include <CGAL/Polygon_mesh_processing/corefinement.h>

using Mesh = CGAL::Surface_mesh<CGAL::Exact_predicates_exact_constructions_kernel::Point_3>;

bw_status bwi_cgal_refine(bw_context *context, void *data, bwi_child_stream *out) {
  const bwi_refine_job *job = static_cast<const bwi_refine_job *>(data);
  try {
    Mesh first, second;
    if (!bwi::load(job->surface, nullptr, 0, false, first) ||
        !bwi::load(job->other, nullptr, 0, false, second))
      return bw_fail(context, BW_GEOMETRY, "surfaces that touch must be manifold");
    CGAL::Polygon_mesh_processing::corefine(first, second);
    Mesh &wanted = job->second ? second : first;
    wanted.collect_garbage();
    return bwi::store_sorted(out, wanted);
  } catch (...) {
    return bwi::caught(context, "joining the faces of parts that touch");
  }
}
