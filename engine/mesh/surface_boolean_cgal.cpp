/* Union, difference and intersection of two closed surfaces by corefinement.
 *
 * Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later.
 *
 * A visitor hands the group of a facet on to its parts, and to their copies in the result. */
#include "mesh/surface_cgal.hpp"

#include <CGAL/Exact_predicates_exact_constructions_kernel.h>
#include <CGAL/Polygon_mesh_processing/corefinement.h>

#include "mesh/surface_boolean.h"

using Mesh = CGAL::Surface_mesh<CGAL::Exact_predicates_exact_constructions_kernel::Point_3>;
using Face = Mesh::Face_index;
using Groups = Mesh::Property_map<Face, std::int32_t>;
namespace steps = CGAL::Polygon_mesh_processing;

namespace {

Groups groups_of(Mesh &mesh) {
  return mesh.add_property_map<Face, std::int32_t>("f:group", 0).first;
}

struct Visitor : steps::Corefinement::Default_visitor<Mesh> {
  const Mesh *mesh[3]; /* first, second, result */
  Groups group[3];
  std::int32_t *split; /* the group of the facet whose parts are being made */

  const Groups &of(const Mesh &which) const {
    return group[&which == mesh[0] ? 0 : &which == mesh[1] ? 1 : 2];
  }
  void before_subface_creations(Face old, Mesh &which) {
    *split = of(which)[old];
  }
  void after_subface_created(Face part, Mesh &which) {
    Groups map = of(which);
    map[part] = *split;
  }
  void after_face_copy(Face old, const Mesh &from, Face copy, const Mesh &to) {
    Groups map = of(to);
    map[copy] = of(from)[old];
  }
};

bool load(const bw_surface *surface, Mesh &mesh, Groups &group) {
  if (!bwi::load(surface, nullptr, 0, false, mesh))
    return false;
  std::int64_t t = 0;
  for (Face f : mesh.faces())
    group[f] = surface->group ? surface->group[t++] : 0;
  return true;
}

struct Facet {
  std::array<std::int32_t, 3> corner;
  std::int32_t group;
};

/* In an order that depends on coordinates only, as bwi::store_sorted. Corners that rounding made
 * equal are one point here. */
bw_status store(bwi_child_stream *out, const Mesh &mesh, const Groups &group) {
  using Place = std::array<double, 3>;
  std::vector<double> point;
  std::vector<std::int32_t> triangle, groups;
  std::vector<Place> place;
  bwi::read(mesh, point, triangle);
  for (std::size_t i = 0; i < point.size(); i += 3)
    place.push_back({point[i] + 0.0, point[i + 1] + 0.0, point[i + 2] + 0.0}); /* no -0 */
  std::vector<Place> sorted(place);
  std::sort(sorted.begin(), sorted.end());
  sorted.erase(std::unique(sorted.begin(), sorted.end()), sorted.end());
  std::vector<Facet> facet;
  std::size_t t = 0;
  for (Face f : mesh.faces()) {
    Facet next = {{}, group[f]};
    for (std::size_t k = 0; k < 3; k++) {
      const Place &at = place[static_cast<std::size_t>(triangle[t++])];
      next.corner[k] = static_cast<std::int32_t>(
          std::lower_bound(sorted.begin(), sorted.end(), at) - sorted.begin());
    }
    std::rotate(next.corner.begin(), std::min_element(next.corner.begin(), next.corner.end()),
                next.corner.end());
    facet.push_back(next);
  }
  std::sort(facet.begin(), facet.end(), [](const Facet &a, const Facet &b) {
    return std::tie(a.corner, a.group) < std::tie(b.corner, b.group);
  });
  point.clear();
  triangle.clear();
  for (const Place &at : sorted)
    point.insert(point.end(), at.begin(), at.end());
  for (const Facet &f : facet) {
    triangle.insert(triangle.end(), f.corner.begin(), f.corner.end());
    groups.push_back(f.group);
  }
  bw_status status = bwi::store(out, point, triangle);
  if (status == BW_OK)
    status = bwi_child_write(out, groups.data(), groups.size() * sizeof(std::int32_t));
  return status;
}

} // namespace

bw_status bwi_cgal_boolean(bw_context *context, void *data, bwi_child_stream *out) {
  const bwi_boolean_job *job = static_cast<const bwi_boolean_job *>(data);
  try {
    Mesh first, second, result;
    std::int32_t split = 0;
    Visitor visitor;
    visitor.mesh[0] = &first, visitor.mesh[1] = &second, visitor.mesh[2] = &result;
    visitor.group[0] = groups_of(first), visitor.group[1] = groups_of(second);
    visitor.group[2] = groups_of(result);
    visitor.split = &split;
    if (!load(job->first, first, visitor.group[0]) || !load(job->second, second, visitor.group[1]))
      return bw_fail(context, BW_GEOMETRY, "a surface is not manifold");
    const auto watch = CGAL::parameters::visitor(visitor).throw_on_self_intersection(true);
    bool good;
    if (job->operation == BW_BOOLEAN_UNION)
      good = steps::corefine_and_compute_union(first, second, result, watch);
    else if (job->operation == BW_BOOLEAN_DIFFERENCE)
      good = steps::corefine_and_compute_difference(first, second, result, watch);
    else
      good = steps::corefine_and_compute_intersection(first, second, result, watch);
    if (!good)
      return bw_fail(context, BW_GEOMETRY,
                     "the result touches itself along an edge or in a point: move or resize one of "
                     "the bodies a little");
    return store(out, result, visitor.group[2]);
  } catch (...) {
    return bwi::caught(context, "a boolean operation");
  }
}
