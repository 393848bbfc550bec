/* Triangles between the corners of plane polygons: a constrained Delaunay triangulation by CGAL.
 *
 * Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later.
 *
 * A triangle is inside where an odd number of polygon sides lies between it and the outside. */
#include "mesh/surface_cgal.hpp"

#include <CGAL/Constrained_Delaunay_triangulation_2.h>
#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/Triangulation_face_base_with_info_2.h>
#include <CGAL/Triangulation_vertex_base_with_info_2.h>

#include <cmath>

namespace {

using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;
using Vertex = CGAL::Triangulation_vertex_base_with_info_2<std::int32_t, Kernel>;
using Face =
    CGAL::Triangulation_face_base_with_info_2<int, Kernel,
                                              CGAL::Constrained_triangulation_face_base_2<Kernel>>;
using Plane = CGAL::Constrained_Delaunay_triangulation_2<
    Kernel, CGAL::Triangulation_data_structure_2<Vertex, Face>,
    CGAL::No_constraint_intersection_requiring_constructions_tag>;

/* Numbers of sides between each triangle and the outside. */
void find_depths(Plane &plane) {
  std::vector<Plane::Face_handle> now{plane.infinite_face()}, next;
  for (auto f : plane.all_face_handles())
    f->info() = -1;
  for (int depth = 0; !now.empty(); depth++) {
    next.clear();
    while (!now.empty()) {
      Plane::Face_handle f = now.back();
      now.pop_back();
      if (f->info() >= 0)
        continue;
      f->info() = depth;
      for (int k = 0; k < 3; k++)
        if (f->neighbor(k)->info() < 0)
          (f->is_constrained(k) ? next : now).push_back(f->neighbor(k));
    }
    now.swap(next);
  }
}

bw_status fail_touching(bw_context *context, const double *at) {
  return bw_fail(context, BW_GEOMETRY, "the polygons touch or cross near (%g, %g) m", at[0], at[1]);
}

bw_status insert(bw_context *context, int32_t polygons, const int32_t *start, const double *point,
                 Plane &plane) {
  std::vector<Plane::Vertex_handle> vertex;
  for (int32_t i = 0; i < start[polygons]; i++) {
    const double *x = point + 2 * static_cast<std::int64_t>(i);
    Plane::Vertex_handle v = plane.insert(
        Kernel::Point_2(x[0], x[1]), vertex.empty() ? Plane::Face_handle() : vertex.back()->face());
    if (static_cast<std::int32_t>(plane.number_of_vertices()) != i + 1)
      return fail_touching(context, x);
    v->info() = i;
    vertex.push_back(v);
  }
  for (bool checks : {false, true})
    for (int32_t p = 0; p < polygons; p++)
      for (int32_t i = start[p]; i < start[p + 1]; i++) {
        Plane::Vertex_handle
            a = vertex[static_cast<std::size_t>(i)],
            b = vertex[static_cast<std::size_t>(i + 1 < start[p + 1] ? i + 1 : start[p])];
        bool good = true;
        try {
          if (checks) /* a corner on a side has cut it */
            good = plane.is_edge(a, b);
          else
            plane.insert_constraint(a, b);
        } catch (const Plane::Intersection_of_constraints_exception &) {
          good = false;
        }
        if (!good)
          return fail_touching(context, point + 2 * static_cast<std::int64_t>(i));
      }
  return BW_OK;
}

bw_status triangulate(bw_context *context, int32_t polygons, const int32_t *start,
                      const double *point, int32_t **triangle, int64_t *count) {
  Plane plane;
  bw_status status = insert(context, polygons, start, point, plane);
  if (status != BW_OK)
    return status;
  if (plane.dimension() < 2)
    return bw_fail(context, BW_GEOMETRY, "the polygons have no area");
  find_depths(plane);
  std::vector<std::array<std::int32_t, 3>> list;
  for (auto f : plane.finite_face_handles())
    if (f->info() % 2 == 1) {
      std::array<std::int32_t, 3> t = {f->vertex(0)->info(), f->vertex(1)->info(),
                                       f->vertex(2)->info()};
      std::rotate(t.begin(), std::min_element(t.begin(), t.end()), t.end());
      list.push_back(t);
    }
  if (list.empty())
    return bw_fail(context, BW_GEOMETRY, "the polygons have no area");
  std::sort(list.begin(), list.end());
  auto *made = static_cast<int32_t *>(bw_alloc(context, 3 * list.size(), sizeof(int32_t)));
  if (!made)
    return BW_MEMORY;
  for (std::size_t t = 0; t < list.size(); t++)
    std::copy(list[t].begin(), list[t].end(), made + 3 * t);
  *triangle = made;
  *count = static_cast<int64_t>(list.size());
  return BW_OK;
}

} // namespace

bw_status bw_polygons_triangles(bw_context *context, int32_t polygons, const int32_t *start,
                                const double *point, int32_t **triangle, int64_t *count) {
  if (polygons < 1 || start[0] != 0)
    return bw_fail(context, BW_INVALID, "at least one polygon, from point 1 on, expected");
  for (int32_t p = 0; p < polygons; p++)
    if (start[p + 1] < start[p] + 3)
      return bw_fail(context, BW_INVALID, "polygon %d has %d corners: at least 3 expected", p + 1,
                     start[p + 1] - start[p]);
  for (std::int64_t i = 0; i < 2 * static_cast<std::int64_t>(start[polygons]); i++)
    if (!std::isfinite(point[i]))
      return bw_fail(context, BW_GEOMETRY, "a corner of a polygon is not finite");
  try {
    return triangulate(context, polygons, start, point, triangle, count);
  } catch (...) {
    return bwi::caught(context, "cutting polygons into triangles");
  }
}
