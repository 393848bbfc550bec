/* The union of closed shells.
 *
 * Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later.
 *
 * Points are exact while shells are joined one by one, and rounded once at the end. */
#include "mesh/surface_cgal.hpp"

#include <CGAL/Exact_predicates_exact_constructions_kernel.h>
#include <CGAL/Polygon_mesh_processing/corefinement.h>

using Mesh = CGAL::Surface_mesh<CGAL::Exact_predicates_exact_constructions_kernel::Point_3>;
namespace steps = CGAL::Polygon_mesh_processing;

bw_status bwi_cgal_union(bw_context *context, void *data, bwi_child_stream *out) {
  const bwi_union_job *job = static_cast<const bwi_union_job *>(data);
  try {
    Mesh whole;
    for (int take_away = 0; take_away < 2; take_away++)
      for (std::int32_t s = 0; s < job->shells; s++) {
        if (job->cavity[s] != take_away)
          continue;
        Mesh shell, joined;
        if (!bwi::load(job->surface, job->shell, s, take_away == 1, shell))
          return bw_fail(context, BW_GEOMETRY, "shell %d of %d is not manifold", s + 1,
                         job->shells);
        bool good;
        const auto strict = CGAL::parameters::throw_on_self_intersection(true);
        if (take_away)
          good = steps::corefine_and_compute_difference(whole, shell, joined, strict);
        else if (whole.number_of_faces() == 0)
          good = true, joined = shell;
        else
          good = steps::corefine_and_compute_union(whole, shell, joined, strict);
        if (!good)
          return bw_fail(context, BW_GEOMETRY,
                         "joining shell %d of %d gives a surface that is not manifold", s + 1,
                         job->shells);
        joined.collect_garbage();
        whole = joined;
        bw_progress(context, "joining shells", (s + 1.0) / job->shells);
      }
    return bwi::store_sorted(out, whole);
  } catch (...) {
    return bwi::caught(context, "joining shells");
  }
}
