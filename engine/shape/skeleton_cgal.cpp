/* Mean-curvature skeletons by CGAL: a surface in, a curve graph with local radius out.
 *
 * Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later.
 *
 * CGAL visits the edges to collapse in the order of their addresses. So that a skeleton does not
 * depend on what the heap looked like, its meshes lie in a region of their own here, handed out in
 * order. All of it lives and ends in the child process. */
#include <cstddef>
#include <new>
#include <sys/mman.h>

namespace {

struct region {
  static constexpr std::size_t size = std::size_t(1) << 30, grain = 16, classes = 64;
  char *at = nullptr, *end = nullptr;
  void *spare[classes] = {};

  void *take(std::size_t bytes) {
    std::size_t grains = (bytes + grain - 1) / grain;
    if (grains < classes && spare[grains]) {
      void *block = spare[grains];
      spare[grains] = *static_cast<void **>(block);
      return block;
    }
    if (!at) {
      void *got = mmap(nullptr, size, PROT_READ | PROT_WRITE,
                       MAP_PRIVATE | MAP_ANONYMOUS | MAP_NORESERVE, -1, 0);
      if (got == MAP_FAILED)
        throw std::bad_alloc();
      at = static_cast<char *>(got);
      end = at + size;
    }
    if (grains > static_cast<std::size_t>(end - at) / grain)
      throw std::bad_alloc();
    void *block = at;
    at += grains * grain;
    return block;
  }
  void give(void *block, std::size_t bytes) {
    std::size_t grains = (bytes + grain - 1) / grain;
    if (grains < classes) {
      *static_cast<void **>(block) = spare[grains];
      spare[grains] = block;
    }
  }
};
region meshes;

template <class T> struct in_order {
  using value_type = T;
  in_order() = default;
  template <class U> in_order(const in_order<U> &) {
  }
  T *allocate(std::size_t n) {
    return static_cast<T *>(meshes.take(n * sizeof(T)));
  }
  void deallocate(T *block, std::size_t n) {
    meshes.give(block, n * sizeof(T));
  }
  bool operator==(const in_order &) const {
    return true;
  }
  bool operator!=(const in_order &) const {
    return false;
  }
};

} // namespace

#include <CGAL/memory.h>
#undef CGAL_ALLOCATOR
#define CGAL_ALLOCATOR(T) in_order<T>
#include <CGAL/HalfedgeDS_default.h>
#include <CGAL/Polyhedron_3.h>
#undef CGAL_ALLOCATOR
#define CGAL_ALLOCATOR(T) std::allocator<T>

#include "mesh/surface_cgal.hpp"

#include <CGAL/Mean_curvature_flow_skeletonization.h>
#include <CGAL/Simple_cartesian.h>

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include <cholmod.h>

#include "shape/skeleton_cgal.h"

namespace {

/* Least squares A x = b through the normal equations, as CGAL asks for them. Simplicial, so that no
 * BLAS with threads of its own runs in a forked process. */
class normal_equations {
public:
  class Matrix {
  public:
    Matrix(int row_count, int column_count) : rows(row_count), columns(column_count) {
    }
    void set_coef(std::size_t i, std::size_t j, double x, bool) {
      row.push_back(static_cast<int>(i));
      column.push_back(static_cast<int>(j));
      value.push_back(x);
    }
    int rows, columns;
    std::vector<int> row, column;
    std::vector<double> value;
  };
  using Vector = std::vector<double>;

  normal_equations() {
    cholmod_start(&common);
    common.supernodal = CHOLMOD_SIMPLICIAL;
    common.nmethods = 1;
    common.method[0].ordering = CHOLMOD_AMD;
    common.print = 0;
  }
  ~normal_equations() {
    clear();
    cholmod_finish(&common);
  }
  normal_equations(const normal_equations &) = delete;
  normal_equations &operator=(const normal_equations &) = delete;

  void normal_equation_factor(Matrix &a) {
    clear();
    cholmod_triplet t = {};
    t.nrow = static_cast<std::size_t>(a.columns);
    t.ncol = static_cast<std::size_t>(a.rows);
    t.nzmax = t.nnz = a.value.size();
    t.i = a.column.data();
    t.j = a.row.data();
    t.x = a.value.data();
    t.itype = CHOLMOD_INT;
    t.xtype = CHOLMOD_REAL;
    t.dtype = CHOLMOD_DOUBLE;
    transposed = cholmod_triplet_to_sparse(&t, t.nnz, &common);
    factor = transposed ? cholmod_analyze(transposed, &common) : nullptr;
    if (!factor || !cholmod_factorize(transposed, factor, &common) || common.status != CHOLMOD_OK)
      fail();
  }
  void normal_equation_solver(const Vector &b, Vector &x) {
    cholmod_dense right = {};
    right.nrow = right.nzmax = right.d = b.size();
    right.ncol = 1;
    right.x = const_cast<double *>(b.data());
    right.xtype = CHOLMOD_REAL;
    right.dtype = CHOLMOD_DOUBLE;
    double one[2] = {1, 0}, zero[2] = {0, 0};
    cholmod_dense *side = cholmod_zeros(x.size(), 1, CHOLMOD_REAL, &common);
    cholmod_dense *got = nullptr;
    if (side && cholmod_sdmult(transposed, 0, one, zero, &right, side, &common))
      got = cholmod_solve(CHOLMOD_A, factor, side, &common);
    if (got)
      std::copy_n(static_cast<double *>(got->x), x.size(), x.begin());
    bool good = got && std::all_of(x.begin(), x.end(), [](double v) { return std::isfinite(v); });
    cholmod_free_dense(&side, &common);
    cholmod_free_dense(&got, &common);
    if (!good)
      fail();
  }

private:
  void clear() {
    cholmod_free_factor(&factor, &common);
    cholmod_free_sparse(&transposed, &common);
  }
  [[noreturn]] void fail() {
    if (common.status == CHOLMOD_OUT_OF_MEMORY)
      throw std::bad_alloc();
    throw std::runtime_error("the equations of a contraction step could not be solved");
  }
  cholmod_common common;
  cholmod_sparse *transposed = nullptr;
  cholmod_factor *factor = nullptr;
};

using Kernel = CGAL::Simple_cartesian<double>;
using Mesh = CGAL::Surface_mesh<Kernel::Point_3>;
using Skeletoniser =
    CGAL::Mean_curvature_flow_skeletonization<Mesh, CGAL::Default, CGAL::Default, normal_equations>;

/* As contract_until_convergence, with progress. */
void contract(bw_context *context, Skeletoniser &skeletoniser, double area) {
  double last = 0;
  for (std::size_t i = 0; i < skeletoniser.max_iterations(); i++) {
    skeletoniser.contract();
    double now = CGAL::Polygon_mesh_processing::area(skeletoniser.meso_skeleton());
    bw_progress(context, "contract to a skeleton", std::max(0.0, 1 - now / area));
    if (!(std::fabs(last - now) >= skeletoniser.area_variation_factor() * area))
      break;
    last = now;
  }
}

bw_status send(bwi_child_stream *out, const Mesh &mesh, const Skeletoniser::Skeleton &curve) {
  std::vector<double> point;
  std::vector<std::int32_t> edge;
  for (auto v : CGAL::make_range(vertices(curve))) {
    const Kernel::Point_3 &x = curve[v].point;
    double sum = 0;
    for (auto of : curve[v].vertices)
      sum += std::sqrt(CGAL::squared_distance(x, mesh.point(of)));
    std::size_t of = curve[v].vertices.size();
    point.insert(point.end(), {x.x(), x.y(), x.z(), of ? sum / static_cast<double>(of) : -1.0});
  }
  for (auto e : CGAL::make_range(edges(curve))) {
    edge.push_back(static_cast<std::int32_t>(source(e, curve)));
    edge.push_back(static_cast<std::int32_t>(target(e, curve)));
  }
  std::int64_t count[2] = {static_cast<std::int64_t>(point.size() / 4),
                           static_cast<std::int64_t>(edge.size() / 2)};
  bw_status status = bwi_child_write(out, count, sizeof count);
  if (status == BW_OK)
    status = bwi_child_write(out, point.data(), point.size() * sizeof(double));
  if (status == BW_OK)
    status = bwi_child_write(out, edge.data(), edge.size() * sizeof(std::int32_t));
  return status;
}

} // namespace

bw_status bwi_cgal_skeleton(bw_context *context, void *data, bwi_child_stream *out) {
  try {
    Mesh mesh;
    if (!bwi::load(static_cast<const bw_surface *>(data), nullptr, 0, false, mesh))
      return bw_fail(context, BW_GEOMETRY, "the surface is not manifold: repair it first");
    Skeletoniser skeletoniser(mesh);
    contract(context, skeletoniser, CGAL::Polygon_mesh_processing::area(mesh));
    Skeletoniser::Skeleton curve;
    skeletoniser.convert_to_skeleton(curve);
    return send(out, mesh, curve);
  } catch (...) {
    return bwi::caught(context, "the skeleton");
  }
}
