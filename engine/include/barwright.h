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
 *              A positive status leaves every object passed in as it was. A negative status
 *              leaves the object that was being changed fit only for release.
 * Ownership    Engine objects carry a reference count (bw_retain, bw_release). A function
 *              that returns an object through an output pointer gives the caller one
 *              reference. An object retains what it depends on. The words in a function's
 *              name say what happens to arrays: _copy copies them, _own takes them over (they
 *              must come from bw_alloc), _borrow uses them while the named owner lives.
 * Constness    Surfaces, meshes and materials do not change once made. Their fields may be
 *              read freely, from any thread, and must not be written.
 * Threads      A context serves one thread at a time. Objects may be shared between threads
 *              that only read them. Results have the same bits for any number of threads.
 * Cancelling   Long work asks bw_cancelled now and then and returns BW_CANCELLED.
 */
#ifndef BARWRIGHT_H
#define BARWRIGHT_H

#include "barwright/base.h"
#include "barwright/confine.h"
#include "barwright/faces.h"
#include "barwright/job.h"
#include "barwright/mesh.h"
#include "barwright/outline.h"
#include "barwright/plane.h"
#include "barwright/sample.h"
#include "barwright/singular.h"
#include "barwright/temporary.h"

#include "barwright/grid.h"
#include "barwright/io.h"

#include "barwright/element.h"
#include "barwright/material.h"

#include "barwright/model.h"
#include "barwright/singular_places.h"

#include "barwright/assemble.h"

#include "barwright/solve.h"

#include "barwright/metamaterial.h"
#include "barwright/nonlinear.h"

#include "barwright/shape.h"

#include "barwright/analysis.h"
#include "barwright/flow.h"
#include "barwright/responsive.h"

#include "barwright/picture.h"

#include "barwright/study.h"

#endif
