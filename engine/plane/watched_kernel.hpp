/* A kernel for CGAL's triangulations in the plane that can be stopped: every predicate and
 * construction that their loops turn on counts as one unit of work, and now and then it is asked
 * whether to go on. CGAL itself asks nobody: where rounding has spoilt a triangulation, one
 * insertion may flip edges for ever.
 *
 * Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
#ifndef BARWRIGHT_PLANE_WATCHED_KERNEL_HPP
#define BARWRIGHT_PLANE_WATCHED_KERNEL_HPP

#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>

#include <cstdint>
#include <utility>

namespace bwi {

/* Thrown through CGAL. What it worked on can then only be destroyed. */
struct Stopped {};

class Watch {
public:
  /* `ask` is called every 4096 units of work; false: stop. */
  Watch(bool (*ask)(void *data, std::int64_t work), void *data) : ask_(ask), data_(data) {
  }
  void look() {
    if (++work_ % 4096 == 0 && !ask_(data_, work_))
      throw Stopped();
  }

private:
  bool (*ask_)(void *data, std::int64_t work);
  void *data_;
  std::int64_t work_ = 0;
};

template <class Function> class Watched {
public:
  Watched() = default;
  Watched(const Function &function, Watch *watch) : function_(function), watch_(watch) {
  }
  template <class... Arguments> decltype(auto) operator()(Arguments &&...arguments) const {
    if (watch_)
      watch_->look();
    return function_(std::forward<Arguments>(arguments)...);
  }

private:
  Function function_;
  Watch *watch_ = nullptr;
};

class Watched_kernel : public CGAL::Exact_predicates_inexact_constructions_kernel {
  using Base = CGAL::Exact_predicates_inexact_constructions_kernel;

public:
  explicit Watched_kernel(Watch *watch = nullptr) : watch_(watch) {
  }
#define BWI_WATCHED(Name, object)                                                                  \
  using Name = Watched<Base::Name>;                                                                \
  Name object() const {                                                                            \
    return Name(Base::object(), watch_);                                                           \
  }
  BWI_WATCHED(Orientation_2, orientation_2_object)
  BWI_WATCHED(Side_of_oriented_circle_2, side_of_oriented_circle_2_object)
  BWI_WATCHED(Compare_x_2, compare_x_2_object)
  BWI_WATCHED(Angle_2, angle_2_object)
  BWI_WATCHED(Compute_squared_distance_2, compute_squared_distance_2_object)
  BWI_WATCHED(Construct_midpoint_2, construct_midpoint_2_object)
#undef BWI_WATCHED

private:
  Watch *watch_;
};

} // namespace bwi
#endif
