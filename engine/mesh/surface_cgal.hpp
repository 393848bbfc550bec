/* Surfaces to CGAL's meshes and back.
 *
 * Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
#ifndef BARWRIGHT_MESH_SURFACE_CGAL_HPP
#define BARWRIGHT_MESH_SURFACE_CGAL_HPP

#if defined(__GNUC__) && !defined(__clang__)
#pragma GCC diagnostic ignored "-Wmaybe-uninitialized" /* in CGAL's own headers */
#endif
#include <CGAL/Surface_mesh.h>
#include <CGAL/number_utils.h>

#include <algorithm>
#include <array>
#include <cstdint>
#include <exception>
#include <new>
#include <numeric>
#include <tuple>
#include <vector>

#include "mesh/surface_cgal.h"

namespace bwi {

/* The facets t with of[t] == wanted (all of them when `of` is NULL), turned round when `turn`.
 * False where they are not manifold. */
template <class Mesh>
bool load(const bw_surface *surface, const std::int32_t *of, std::int32_t wanted, bool turn,
          Mesh &mesh) {
  using Vertex = typename Mesh::Vertex_index;
  std::vector<Vertex> vertex(static_cast<std::size_t>(surface->point_count), Mesh::null_vertex());
  for (std::int64_t t = 0; t < surface->triangle_count; t++) {
    if (of && of[t] != wanted)
      continue;
    Vertex corner[3];
    for (int k = 0; k < 3; k++) {
      std::int32_t i = surface->triangle[3 * t + k];
      const double *x = surface->point + 3 * static_cast<std::int64_t>(i);
      Vertex &v = vertex[static_cast<std::size_t>(i)];
      if (v == Mesh::null_vertex())
        v = mesh.add_vertex(typename Mesh::Point(x[0], x[1], x[2]));
      corner[k] = v;
    }
    if (mesh.add_face(corner[0], corner[turn ? 2 : 1], corner[turn ? 1 : 2]) == Mesh::null_face())
      return false;
  }
  return true;
}

inline bw_status store(bwi_child_stream *out, const std::vector<double> &point,
                       const std::vector<std::int32_t> &triangle) {
  std::int64_t count[2] = {static_cast<std::int64_t>(point.size() / 3),
                           static_cast<std::int64_t>(triangle.size() / 3)};
  bw_status status = bwi_child_write(out, count, sizeof count);
  if (status == BW_OK)
    status = bwi_child_write(out, point.data(), point.size() * sizeof(double));
  if (status == BW_OK)
    status = bwi_child_write(out, triangle.data(), triangle.size() * sizeof(std::int32_t));
  return status;
}

inline double rounded(double x) {
  return x;
}
/* Of its exact value: the interval around a lazy number depends on what was evaluated before. */
template <class Number> double rounded(const Number &x) {
  return CGAL::to_double(x.exact());
}

template <class Mesh>
void read(const Mesh &mesh, std::vector<double> &point, std::vector<std::int32_t> &triangle) {
  std::vector<std::int32_t> number(mesh.num_vertices() + mesh.number_of_removed_vertices());
  std::int32_t next = 0;
  for (auto v : mesh.vertices()) {
    number[static_cast<std::size_t>(v)] = next++;
    for (int k = 0; k < 3; k++)
      point.push_back(rounded(mesh.point(v)[k]));
  }
  for (auto f : mesh.faces())
    for (auto v : mesh.vertices_around_face(mesh.halfedge(f)))
      triangle.push_back(number[static_cast<std::size_t>(v)]);
}

template <class Mesh> bw_status store(bwi_child_stream *out, const Mesh &mesh) {
  std::vector<double> point;
  std::vector<std::int32_t> triangle;
  read(mesh, point, triangle);
  return store(out, point, triangle);
}

/* Points by their coordinates, and facets by their points: intersections of CGAL number both in an
 * order that depends on addresses, which differ from run to run. Points at one place have one rank,
 * so that their order among each other does not matter to facets. */
template <class Mesh> bw_status store_sorted(bwi_child_stream *out, const Mesh &mesh) {
  using Facet = std::array<std::int32_t, 3>;
  std::vector<double> point, sorted;
  std::vector<std::int32_t> triangle;
  read(mesh, point, triangle);
  const std::size_t points = point.size() / 3;
  const auto place = [&point](std::int32_t i) {
    const double *x = &point[3 * static_cast<std::size_t>(i)];
    return std::make_tuple(x[0], x[1], x[2]);
  };
  std::vector<std::int32_t> order(points), number(points), rank(points);
  std::iota(order.begin(), order.end(), 0);
  std::stable_sort(order.begin(), order.end(),
                   [&place](std::int32_t i, std::int32_t j) { return place(i) < place(j); });
  for (std::size_t i = 0; i < points; i++) {
    const bool same = i > 0 && place(order[i]) == place(order[i - 1]);
    number[static_cast<std::size_t>(order[i])] = static_cast<std::int32_t>(i);
    rank[i] = same ? rank[i - 1] : static_cast<std::int32_t>(i);
    const auto at = point.begin() + 3 * static_cast<std::ptrdiff_t>(order[i]);
    sorted.insert(sorted.end(), at, at + 3);
  }
  const auto rank_of = [&rank](std::int32_t i) { return rank[static_cast<std::size_t>(i)]; };
  const auto ranks = [&rank_of](const Facet &f) {
    return Facet{rank_of(f[0]), rank_of(f[1]), rank_of(f[2])};
  };
  std::vector<Facet> facet(triangle.size() / 3);
  for (std::size_t t = 0; t < facet.size(); t++) {
    Facet &f = facet[t];
    for (std::size_t k = 0; k < 3; k++)
      f[k] = number[static_cast<std::size_t>(triangle[3 * t + k])];
    std::rotate(f.begin(), std::min_element(f.begin(), f.end()), f.end());
  }
  std::stable_sort(facet.begin(), facet.end(),
                   [&ranks](const Facet &f, const Facet &g) { return ranks(f) < ranks(g); });
  triangle.clear();
  for (const Facet &f : facet)
    triangle.insert(triangle.end(), f.begin(), f.end());
  return store(out, sorted, triangle);
}

/* To be called in a catch (...) block: the exception as a failure. */
inline bw_status caught(bw_context *context, const char *what) {
  try {
    throw;
  } catch (const std::bad_alloc &) {
    return bw_fail(context, BW_MEMORY, "%s: memory ran out", what);
  } catch (const std::exception &error) {
    return bw_fail(context, BW_GEOMETRY, "%s: CGAL stopped with an error: %s", what, error.what());
  } catch (...) {
    return bw_fail(context, BW_GEOMETRY, "%s: CGAL stopped with an error", what);
  }
}

} // namespace bwi
#endif
