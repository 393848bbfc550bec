/* Triangles inside of a boundary: constrained Delaunay triangulation, refined until angles and
 * sizes are as wanted.
 *
 * Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
#if defined(__GNUC__) && !defined(__clang__)
#pragma GCC diagnostic ignored "-Wmaybe-uninitialized" /* in CGAL's own headers */
#endif
#include "plane/fill_internal.h"
#include "plane/watched_kernel.hpp"

#include <CGAL/Constrained_Delaunay_triangulation_2.h>
#include <CGAL/Delaunay_mesh_face_base_2.h>
#include <CGAL/Delaunay_mesh_vertex_base_2.h>
#include <CGAL/Delaunay_mesher_2.h>
#include <CGAL/Delaunay_mesher_no_edge_refinement_2.h>
#include <CGAL/Triangulation_face_base_with_info_2.h>
#include <CGAL/Triangulation_vertex_base_with_info_2.h>

#include <cmath>
#include <cstring>
#include <exception>
#include <new>
#include <vector>

namespace {

using Kernel = bwi::Watched_kernel;
/* Number of a vertex: -1 is none yet. */
struct Number {
  std::int32_t at = -1;
};
/* The innermost loop around a face: -1 none, -2 not known yet. */
struct Loop {
  std::int32_t at = -2;
};
using Vertex_base =
    CGAL::Delaunay_mesh_vertex_base_2<Kernel,
                                      CGAL::Triangulation_vertex_base_with_info_2<Number, Kernel>>;
using Face_base = CGAL::Delaunay_mesh_face_base_2<
    Kernel, CGAL::Constrained_Delaunay_triangulation_face_base_2<
                Kernel, CGAL::Constrained_triangulation_face_base_2<
                            Kernel, CGAL::Triangulation_face_base_with_info_2<Loop, Kernel>>>>;
using Data = CGAL::Triangulation_data_structure_2<Vertex_base, Face_base>;
using Triangulation =
    CGAL::Constrained_Delaunay_triangulation_2<Kernel, Data, CGAL::No_constraint_intersection_tag>;
using Vertex = Triangulation::Vertex_handle;
using Face = Triangulation::Face_handle;

/* Everything is done about the middle of the boundary: far from the origin CGAL's constructions
 * would be rounded to the size of small elements, and refinement would not end. */
struct Origin {
  double x, y;
};

/* What a triangle may be: its longest edge at most `reach` times the wanted length at its middle,
 * the squared sine of its smallest angle at least `sine`. Large triangles are refined first, the
 * largest before all. */
class Criteria {
public:
  Criteria(bwi_plane_size_field *field, double sine, const Origin &origin)
      : field_(field), sine_(sine), origin_(origin) {
  }
  struct Quality {
    double size = 0, sine = 1;
    bool operator<(const Quality &other) const {
      if (size > 1 || other.size > 1)
        return size > other.size;
      return sine < other.sine;
    }
  };
  class Is_bad {
  public:
    Is_bad(bwi_plane_size_field *field, double sine, const Origin &origin)
        : field_(field), sine_(sine), origin_(origin) {
    }
    CGAL::Mesh_2::Face_badness operator()(const Quality &quality) const {
      return quality.size > 1       ? CGAL::Mesh_2::IMPERATIVELY_BAD
             : quality.sine < sine_ ? CGAL::Mesh_2::BAD
                                    : CGAL::Mesh_2::NOT_BAD;
    }
    CGAL::Mesh_2::Face_badness operator()(const Face &face, Quality &quality) const {
      double x[3], y[3], square[3];
      for (int i = 0; i < 3; i++) {
        x[i] = face->vertex(i)->point().x();
        y[i] = face->vertex(i)->point().y();
      }
      for (int i = 0; i < 3; i++) {
        int a = (i + 1) % 3, b = (i + 2) % 3;
        square[i] = (x[b] - x[a]) * (x[b] - x[a]) + (y[b] - y[a]) * (y[b] - y[a]);
      }
      double longest = std::fmax(square[0], std::fmax(square[1], square[2]));
      double shortest = std::fmin(square[0], std::fmin(square[1], square[2]));
      double other = square[0] + square[1] + square[2] - longest - shortest;
      double twice = (x[1] - x[0]) * (y[2] - y[0]) - (y[1] - y[0]) * (x[2] - x[0]);
      double wanted = reach * bwi_plane_size_at(field_, origin_.x + (x[0] + x[1] + x[2]) / 3,
                                                origin_.y + (y[0] + y[1] + y[2]) / 3);
      quality.size = longest / (wanted * wanted);
      quality.sine = longest * other > 0 ? twice * twice / (longest * other) : 0;
      return (*this)(quality);
    }

  private:
    bwi_plane_size_field *field_;
    double sine_;
    Origin origin_;
  };
  Is_bad is_bad_object() const {
    return Is_bad(field_, sine_, origin_);
  }

private:
  /* Measured: with it, a uniform size h gives about as many triangles as equilateral ones of the
   * side h would be. */
  static constexpr double reach = 1.4;
  bwi_plane_size_field *field_;
  double sine_;
  Origin origin_;
};

/* The loops around faces: from outside inwards, across constraints. `of` says which loop a
 * constrained edge belongs to. */
template <class Of> void flood(Triangulation &t, const bw_outline *outline, const Of &of) {
  std::vector<Face> front;
  for (auto f = t.all_faces_begin(); f != t.all_faces_end(); ++f)
    f->info().at = -2;
  t.infinite_face()->info().at = -1;
  front.push_back(t.infinite_face());
  while (!front.empty()) {
    Face face = front.back();
    front.pop_back();
    for (int i = 0; i < 3; i++) {
      Face other = face->neighbor(i);
      if (other->info().at != -2)
        continue;
      std::int32_t here = face->info().at;
      if (face->is_constrained(i)) {
        std::int32_t loop = of(face, i);
        here = here == loop ? outline->loop[loop].parent : loop;
      }
      other->info().at = here;
      front.push_back(other);
    }
  }
}

bool is_material(const bw_outline *outline, std::int32_t loop) {
  return loop >= 0 && outline->loop[loop].region >= 0;
}

/* The vertices that were put on the boundary: from each boundary vertex along constrained edges to
 * the next one. */
struct Put {
  std::int32_t chord;
  double along;
};

bool trace_chords(Triangulation &t, const bwi_fill_boundary *boundary, std::int32_t loops,
                  const std::vector<Vertex> &vertex, std::vector<Put> &put) {
  auto constrained_others = [&](Vertex v, Vertex found[2]) {
    int count = 0;
    auto edge = t.incident_edges(v), first = edge;
    do {
      if (!edge->first->is_constrained(edge->second))
        continue;
      Vertex a = edge->first->vertex(Triangulation::cw(edge->second));
      Vertex b = edge->first->vertex(Triangulation::ccw(edge->second));
      if (count < 2)
        found[count] = a == v ? b : a;
      count++;
    } while (++edge != first);
    return count == 2;
  };
  for (std::int32_t l = 0; l < loops; l++) {
    std::int32_t begin = boundary->loop_start[l], end = boundary->loop_start[l + 1];
    for (std::int32_t i = begin; i < end; i++) {
      std::int32_t next = i + 1 < end ? i + 1 : begin;
      Vertex a = vertex[static_cast<std::size_t>(i)], b = vertex[static_cast<std::size_t>(next)];
      Vertex found[2];
      if (!constrained_others(a, found))
        return false;
      bool arrived = false;
      for (int way = 0; way < 2 && !arrived; way++) {
        Vertex before = a, at = found[way];
        std::vector<Vertex> passed;
        while (at->info().at < 0 || static_cast<std::size_t>(at->info().at) >= vertex.size()) {
          Vertex ends[2];
          passed.push_back(at);
          if (passed.size() > t.number_of_vertices())
            return false;
          if (!constrained_others(at, ends))
            return false;
          Vertex on = ends[0] == before ? ends[1] : ends[0];
          before = at;
          at = on;
        }
        /* with three nodes and more in a loop only one way leads to the next */
        if (at != b)
          continue;
        arrived = true;
        double length = std::sqrt(CGAL::squared_distance(a->point(), b->point()));
        for (Vertex v : passed) {
          double part = std::sqrt(CGAL::squared_distance(a->point(), v->point())) / length;
          put[static_cast<std::size_t>(v->info().at)] = {i, part};
        }
      }
      if (!arrived)
        return false;
    }
  }
  return true;
}

bw_status take_over(bw_context *context, const bw_outline *outline, Triangulation &t,
                    const std::vector<Vertex> &number, const std::vector<Put> &put,
                    const Origin &origin, bwi_filling *filling) {
  std::int64_t elements = 0;
  for (auto f = t.finite_faces_begin(); f != t.finite_faces_end(); ++f)
    elements += is_material(outline, f->info().at);
  std::size_t nodes = number.size();
  filling->node_count = static_cast<std::int32_t>(nodes);
  filling->element_count = static_cast<std::int32_t>(elements);
  filling->point = BW_NEW(context, double, 2 * nodes);
  filling->chord = BW_NEW(context, std::int32_t, nodes);
  filling->along = BW_NEW(context, double, nodes);
  filling->element = BW_NEW(context, std::int32_t, 3 * elements);
  filling->loop = BW_NEW(context, std::int32_t, elements);
  if (!filling->point || !filling->chord || !filling->along || !filling->element || !filling->loop)
    return BW_MEMORY;
  for (std::size_t i = 0; i < nodes; i++) {
    filling->point[2 * i] = number[i]->point().x() + origin.x;
    filling->point[2 * i + 1] = number[i]->point().y() + origin.y;
    filling->chord[i] = put[i].chord;
    filling->along[i] = put[i].along;
  }
  std::int64_t e = 0;
  for (auto f = t.finite_faces_begin(); f != t.finite_faces_end(); ++f) {
    if (!is_material(outline, f->info().at))
      continue;
    for (int k = 0; k < 3; k++)
      filling->element[3 * e + k] = f->vertex(k)->info().at;
    filling->loop[e++] = f->info().at;
  }
  return BW_OK;
}

/* Between boundary edges with a smaller angle than this, splitting them towards each other can come
 * to vertices that rounding puts at one place, where CGAL's splitting of edges in clusters does not
 * return. Edges are left as they are then. */
constexpr double SHARP = 2e-3;

/* The smallest angle between two edges that follow each other. */
double sharpest_turn(const bwi_fill_boundary *boundary, std::int32_t loops) {
  double sharpest = 4;
  for (std::int32_t l = 0; l < loops; l++) {
    std::int32_t begin = boundary->loop_start[l], end = boundary->loop_start[l + 1];
    for (std::int32_t i = begin; i < end; i++) {
      const double *a = boundary->point + 2 * static_cast<std::size_t>(i);
      const double *b = boundary->point + 2 * static_cast<std::size_t>(i > begin ? i - 1 : end - 1);
      const double *c = boundary->point + 2 * static_cast<std::size_t>(i + 1 < end ? i + 1 : begin);
      double u[2] = {b[0] - a[0], b[1] - a[1]}, v[2] = {c[0] - a[0], c[1] - a[1]};
      sharpest = std::fmin(
          sharpest, std::fabs(std::atan2(u[0] * v[1] - u[1] * v[0], u[0] * v[0] + u[1] * v[1])));
    }
  }
  return sharpest;
}

/* Asked by the watched kernel whether to go on. */
struct Asked {
  bw_context *context;
  const bwi_plane_size_field *field;
  const bwi_time_limit *time;
  std::int64_t max_work;
  bwi_filling *filling;
  bw_status status;
};

/* Work per element and boundary node that are allowed. Triangulations that come out right have
 * taken 8 to 15 per element. */
constexpr std::int64_t MAX_WORK = 60;

bool go_on(void *data, std::int64_t work) {
  Asked *asked = static_cast<Asked *>(data);
  /* who is shown it may cancel */
  bw_progress(asked->context, "filling",
              0.8 * static_cast<double>(work) / static_cast<double>(asked->max_work));
  asked->status = bwi_time_limit_check(asked->context, asked->time);
  asked->filling->stuck = work > asked->max_work;
  return asked->status == BW_OK && !asked->field->failed && !asked->filling->stuck;
}

template <class Mesher>
void refine(Triangulation &t, Mesher &mesher, std::int64_t limit, bwi_filling *filling) {
  std::size_t before = 0;
  mesher.init(true);
  for (std::int64_t step = 0; mesher.try_one_step_refine_mesh(); step++) {
    if (step % 1024 != 0)
      continue;
    /* where rounding leaves no place for another vertex, steps lead nowhere */
    filling->stuck = step > 0 && t.number_of_vertices() == before;
    filling->full = static_cast<std::int64_t>(t.number_of_faces()) > limit;
    if (filling->stuck || filling->full)
      return;
    before = t.number_of_vertices();
  }
}

/* At most this many nodes of a loop are inserted one after the other. */
constexpr std::int32_t FIRST_NODES = 1024;

/* The nodes of a loop: some of them one after the other, each looked for from the one before; then
 * those halfway between, again and again. All of them one after the other would turn over nearly
 * all edges for each node along a straight line. False: two nodes lie at one place. */
bool insert_loop(Triangulation &t, const bwi_fill_boundary *boundary, std::int32_t loop,
                 const Origin &origin, std::vector<Vertex> &vertex) {
  std::int32_t begin = boundary->loop_start[loop], count = boundary->loop_start[loop + 1] - begin;
  std::int32_t first = 1;
  while (count / first > FIRST_NODES)
    first *= 2;
  for (std::int32_t step = first; step > 0; step /= 2)
    for (std::int32_t i = 0; i < count; i += step) {
      if (step < first && i % (2 * step) == 0)
        continue; /* it is there */
      std::size_t at = static_cast<std::size_t>(begin + i);
      Face hint;
      if (i > 0)
        hint = vertex[at - static_cast<std::size_t>(step)]->face();
      else if (at > 0)
        hint = vertex[at - 1]->face();
      Vertex v = t.insert(Kernel::Point_2(boundary->point[2 * at] - origin.x,
                                          boundary->point[2 * at + 1] - origin.y),
                          hint);
      if (v->info().at >= 0)
        return false;
      v->info().at = begin + i;
      vertex[at] = v;
    }
  return true;
}

bw_status fill(bw_context *context, const bw_outline *outline, const bwi_fill_boundary *boundary,
               bwi_plane_size_field *field, double minimum_angle, std::int64_t limit,
               bwi::Watch *watch, bwi_filling *filling) {
  Triangulation t{Kernel(watch)};
  std::vector<Vertex> vertex(static_cast<std::size_t>(boundary->count));
  std::vector<std::int32_t> loop_of(vertex.size());
  std::int32_t loops = outline->loop_count;
  double low[2] = {INFINITY, INFINITY}, high[2] = {-INFINITY, -INFINITY};
  for (std::size_t i = 0; i < vertex.size(); i++)
    for (std::size_t k = 0; k < 2; k++) {
      low[k] = std::fmin(low[k], boundary->point[2 * i + k]);
      high[k] = std::fmax(high[k], boundary->point[2 * i + k]);
    }
  Origin origin{(low[0] + high[0]) / 2, (low[1] + high[1]) / 2};
  for (std::int32_t l = 0; l < loops; l++) {
    for (std::int32_t i = boundary->loop_start[l]; i < boundary->loop_start[l + 1]; i++)
      loop_of[static_cast<std::size_t>(i)] = l;
    if (!insert_loop(t, boundary, l, origin, vertex)) {
      filling->crossed = true;
      return BW_OK;
    }
  }
  for (std::int32_t l = 0; l < loops; l++) {
    std::int32_t begin = boundary->loop_start[l], end = boundary->loop_start[l + 1];
    for (std::int32_t i = begin; i < end; i++) {
      Vertex a = vertex[static_cast<std::size_t>(i)];
      Vertex b = vertex[static_cast<std::size_t>(i + 1 < end ? i + 1 : begin)];
      try {
        t.insert_constraint(a, b);
      } catch (const Triangulation::Intersection_of_constraints_exception &) {
        filling->crossed = true;
        return BW_OK;
      }
    }
  }
  /* a constraint through a third node is cut there: no edge between its ends remains */
  std::int64_t constrained = 0;
  for (auto e = t.finite_edges_begin(); e != t.finite_edges_end(); ++e)
    if (e->first->is_constrained(e->second)) {
      constrained++;
      std::int32_t a = e->first->vertex(Triangulation::cw(e->second))->info().at;
      std::int32_t b = e->first->vertex(Triangulation::ccw(e->second))->info().at;
      std::int32_t l = loop_of[static_cast<std::size_t>(a)];
      std::int32_t begin = boundary->loop_start[l], end = boundary->loop_start[l + 1];
      auto follows = [&](std::int32_t p, std::int32_t q) {
        return q == (p + 1 < end ? p + 1 : begin);
      };
      if (loop_of[static_cast<std::size_t>(b)] != l || !(follows(a, b) || follows(b, a)))
        filling->crossed = true;
    }
  if (filling->crossed || constrained != boundary->count) {
    filling->crossed = true;
    return BW_OK;
  }
  flood(t, outline, [&](Face face, int i) {
    return loop_of[static_cast<std::size_t>(face->vertex(Triangulation::cw(i))->info().at)];
  });
  for (auto f = t.all_faces_begin(); f != t.all_faces_end(); ++f)
    f->set_in_domain(!t.is_infinite(f) && is_material(outline, f->info().at));

  double sine = std::sin(std::fmax(minimum_angle, 0) * 0.017453292519943295);
  Criteria criteria(field, sine * sine, origin);
  if (minimum_angle == BWI_WHOLE_EDGES || sharpest_turn(boundary, loops) < SHARP) {
    CGAL::Delaunay_mesher_no_edge_refinement_2<Triangulation, Criteria> mesher(t, criteria);
    refine(t, mesher, limit, filling);
  } else {
    CGAL::Delaunay_mesher_2<Triangulation, Criteria> mesher(t, criteria);
    refine(t, mesher, limit, filling);
  }
  if (filling->stuck || filling->full)
    return BW_OK;
  std::vector<Vertex> number(vertex);
  for (auto v = t.finite_vertices_begin(); v != t.finite_vertices_end(); ++v)
    if (v->info().at < 0) {
      v->info().at = static_cast<std::int32_t>(number.size());
      number.push_back(v);
    }
  std::vector<Put> put(number.size(), Put{-1, 0});
  if (!trace_chords(t, boundary, loops, vertex, put)) {
    filling->stuck = true; /* rounding let two boundary edges meet */
    return BW_OK;
  }
  flood(t, outline, [&](Face face, int i) {
    std::int32_t a = face->vertex(Triangulation::cw(i))->info().at;
    if (put[static_cast<std::size_t>(a)].chord >= 0)
      a = put[static_cast<std::size_t>(a)].chord;
    return loop_of[static_cast<std::size_t>(a)];
  });
  return take_over(context, outline, t, number, put, origin, filling);
}

} // namespace

bw_status bwi_fill_cgal(bw_context *context, const bw_outline *outline,
                        const bwi_fill_boundary *boundary, bwi_plane_size_field *field,
                        double minimum_angle, int64_t limit, const bwi_time_limit *time,
                        bwi_filling *filling) {
  std::memset(filling, 0, sizeof *filling);
  Asked asked{context, field, time, MAX_WORK * (limit + boundary->count), filling, BW_OK};
  bwi::Watch watch(go_on, &asked);
  try {
    return fill(context, outline, boundary, field, minimum_angle, limit, &watch, filling);
  } catch (const bwi::Stopped &) {
    return asked.status;
  } catch (const std::bad_alloc &) {
    return bw_fail(context, BW_MEMORY, "filling an outline: memory ran out");
  } catch (const std::exception &error) {
    return bw_fail(context, BW_GEOMETRY, "CGAL could not fill the outline: %s", error.what());
  } catch (...) {
    return bw_fail(context, BW_GEOMETRY, "CGAL could not fill the outline");
  }
}
