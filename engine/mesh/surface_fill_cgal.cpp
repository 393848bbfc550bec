/* Triangles over holes.
 *
 * Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
#include "mesh/surface_cgal.hpp"

#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/Polygon_mesh_processing/triangulate_hole.h>

#include <array>

using Point = CGAL::Exact_predicates_inexact_constructions_kernel::Point_3;

namespace {
struct Triple {
  std::array<std::int32_t, 3> at;
  Triple(int a, int b, int c) : at{a, b, c} {
  }
};
} // namespace

bw_status bwi_cgal_fill(bw_context *context, void *data, bwi_child_stream *out) {
  const bwi_hole_job *job = static_cast<const bwi_hole_job *>(data);
  try {
    for (std::int32_t loop = 0; loop < job->loops; loop++) {
      const std::int32_t *of = job->of + job->start[loop];
      std::int64_t count = job->start[loop + 1] - job->start[loop];
      std::vector<Point> line;
      std::vector<Triple> patch;
      for (std::int64_t i = 0; i < count; i++) {
        const double *x = job->point + 3 * static_cast<std::int64_t>(of[i]);
        line.emplace_back(x[0], x[1], x[2]);
      }
      CGAL::Polygon_mesh_processing::triangulate_hole_polyline(line, std::back_inserter(patch));
      for (const Triple &triple : patch) {
        std::int32_t corner[3];
        for (int k = 0; k < 3; k++)
          corner[k] = of[triple.at[static_cast<std::size_t>(k)]];
        bw_status status = bwi_child_write(out, corner, sizeof corner);
        if (status != BW_OK)
          return status;
      }
    }
    return BW_OK;
  } catch (...) {
    return bwi::caught(context, "filling holes");
  }
}
