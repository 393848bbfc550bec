/* Alpha wrap: a closed manifold around anything.
 *
 * Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
#include "mesh/surface_cgal.hpp"

#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/alpha_wrap_3.h>

#include <array>

using Point = CGAL::Exact_predicates_inexact_constructions_kernel::Point_3;

bw_status bwi_cgal_wrap(bw_context *context, void *data, bwi_child_stream *out) {
  const bwi_wrap_job *job = static_cast<const bwi_wrap_job *>(data);
  const bw_surface *surface = job->surface;
  try {
    std::vector<Point> point;
    std::vector<std::array<std::size_t, 3>> facet;
    for (std::int64_t i = 0; i < surface->point_count; i++) {
      const double *x = surface->point + 3 * i;
      point.emplace_back(x[0], x[1], x[2]);
    }
    for (std::int64_t t = 0; t < surface->triangle_count; t++)
      facet.push_back({static_cast<std::size_t>(surface->triangle[3 * t]),
                       static_cast<std::size_t>(surface->triangle[3 * t + 1]),
                       static_cast<std::size_t>(surface->triangle[3 * t + 2])});
    CGAL::Surface_mesh<Point> wrapped;
    CGAL::alpha_wrap_3(point, facet, job->alpha, job->offset, wrapped);
    return bwi::store(out, wrapped);
  } catch (...) {
    return bwi::caught(context, "the alpha wrap");
  }
}
