/* barwright: a structural-design engine.
 *
 * Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later.
 *
 * THE CONTRACT
 *
 * Names        Public names start with bw_, constants with BW_. Names shared between files
 *              of the engine but not public start with bwi_.
 * Units        SI everywhere: metre, kilogram, second, newton, pascal, kelvin, radian.
 * Numbers      double for reals; int32_t for the number of one node, element, facet or
 *              unknown (a mesh beyond 2^31-1 of them is refused); int64_t or size_t for
 *              counts of bytes, matrix entries and products of sizes. Numbering starts at 0.
 * Arguments    The context comes first, then inputs, then options (a const pointer to a
 *              struct; NULL means the defaults), then outputs. An output pointer is written
 *              only on success, unless its comment says otherwise.
 * Return       Every function that can fail returns a bw_status. BW_OK is 0. The sentence
 *              that says what happened, with its numbers, is in the context (bw_message).
 *              Any function may return BW_INVALID (an argument outside of what its comment
 *              allows), BW_MEMORY, BW_CANCELLED and BW_INTERNAL, and BW_IO where it has a path
 *              or starts a process. Comments name the other statuses.
 *              A positive status leaves every object passed in as it was. A negative status
 *              leaves the object that was being changed fit only for release.
 * Ownership    Engine objects carry a reference count (bw_retain, bw_release). A function
 *              that returns an object through an output pointer gives the caller one
 *              reference. An object retains what it depends on. The words in a function's
 *              name say what happens to arrays: _copy copies them, _own takes them over (they
 *              must come from bw_alloc), _borrow uses them while the named owner lives.
 *              Other input arrays and texts, those of options too, are read during the call
 *              only, and are copied where an object needs them later. Output arrays are
 *              the caller's; all of their entries are written. `T **` gives a block or an
 *              object to the caller. Callbacks run during the call only, on its thread.
 * Comments     Brackets behind the name of a parameter, and at the beginning of a field's
 *              comment, hold unit and shape: (m), (N, n x 3), (-) without dimension, rows first
 *              and contiguous. The index type counts from 0: (index). An array of fixed size
 *              shows its shape in C; `*x` is one number. Statuses follow in capitals.
 * Words        Parameters and fields of these names have these units unless their comment
 *              says otherwise, and need no text:
 *                (m)      point, at, min, max, centre, origin, spacing, displacement
 *                (m)      radius, thickness, length
 *                (-)      normal, direction, axis, barycentric, fraction, poisson
 *                (N)      force, reaction
 *                (Pa)     stress, pressure, von_mises
 *                (s)      seconds, time, time_limit
 *                (rad)    angle
 *                (kg/m3)  density
 *                (index)  node, element, facet, cell, triangle, region
 *                (-)      order, path, name, data
 *              A position has 3 coordinates, 2 in the plane; min and max are the corners of a
 *              box. A direction need not have unit length, but is not 0; a normal that the
 *              engine gives has unit length. Stress is xx yy zz yz zx xy. `order` is that of
 *              the elements' shape functions, 1 or 2; `data` is passed on to callbacks; x_count
 *              is the number of x.
 * Functions    bw_X_default writes the defaults that the comments of the fields of bw_X name.
 *              bw_X_free and bw_X_destroy release a bw_X and all that it holds; NULL is fine.
 *              bw_X_clear releases what a struct holds, which may be all zeros, and leaves it
 *              without anything to release. bw_X_word gives a static text. bw_X_check returns
 *              BW_GEOMETRY, BW_INVALID or BW_INTERNAL where the parts of an object contradict
 *              each other; for tests and debuggers. bw_X_keep gives the present state of a
 *              mutable object, itself an immutable object, without copying it; bw_X_return goes
 *              back to it.
 * Constness    Surfaces, meshes and materials do not change once made. Their fields may be
 *              read freely, from any thread, and must not be written.
 * Threads      A context serves one thread at a time. Objects may be shared between threads
 *              that only read them. Results have the same bits for any number of threads.
 * Cancelling   Long work asks bw_cancelled now and then and returns BW_CANCELLED. */
#ifndef BARWRIGHT_H
#define BARWRIGHT_H

#include "barwright/base.h"
#include "barwright/boolean.h"
#include "barwright/confine.h"
#include "barwright/faces.h"
#include "barwright/job.h"
#include "barwright/lp.h"
#include "barwright/matrix.h"
#include "barwright/mesh.h"
#include "barwright/outline.h"
#include "barwright/plane.h"
#include "barwright/qp.h"
#include "barwright/report.h"
#include "barwright/sample.h"
#include "barwright/singular.h"
#include "barwright/temporary.h"

#include "barwright/cad.h"
#include "barwright/grid.h"
#include "barwright/io.h"

#include "barwright/element.h"
#include "barwright/material.h"

#include "barwright/model.h"
#include "barwright/singular_places.h"

#include "barwright/assemble.h"
#include "barwright/plane_matrix.h"

#include "barwright/linear.h"

#include "barwright/eigen.h"

#include "barwright/external.h"
#include "barwright/statics.h"

#include "barwright/incremental.h"

#include "barwright/metamaterial.h"
#include "barwright/nonlinear.h"

#include "barwright/shape.h"

#include "barwright/analysis.h"
#include "barwright/buckling.h"
#include "barwright/contact.h"
#include "barwright/deposition.h"
#include "barwright/drop.h"
#include "barwright/dynamics.h"
#include "barwright/finite.h"
#include "barwright/flow.h"
#include "barwright/heat.h"
#include "barwright/joint.h"
#include "barwright/responsive.h"
#include "barwright/transient.h"

#include "barwright/picture.h"

#include "barwright/study.h"

#endif
