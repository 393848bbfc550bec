/* Boolean operations of closed surfaces.
 *
 * Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
#include "mesh/surface_boolean.h"

#include "mesh/surface_cgal.h"
#include "mesh/surface_internal.h"
#include "mesh/surface_repair.h"

/* Equal points merged; BW_GEOMETRY where there is no inside. */
static bw_status closed_body(bw_context *context, const bw_surface *surface, const char *which,
                             bw_surface **welded) {
  bw_surface_report report = {0};
  bw_status status = bw_surface_weld(context, surface, 0, welded);
  if (status == BW_OK)
    status = bw_surface_check(context, *welded, 0, &report);
  if (status == BW_OK && !report.sound)
    status = bw_fail(context, BW_GEOMETRY,
                     "the %s surface is not sound: check it by surface:check(), repair it by "
                     "surface:repair()",
                     which);
  bw_surface_report_clear(&report);
  return status;
}

bw_status bw_surface_boolean(bw_context *context, const bw_surface *first, const bw_surface *second,
                             bw_boolean operation, bw_surface **result) {
  const bwi_child_limits limits = {.seconds = 300, .bytes = 6e9};
  bw_surface *body[2] = {NULL, NULL}, *made = NULL;
  bw_face_names *names = NULL;
  bw_status status = BW_OK;
  int64_t changed;
  if (operation < BW_BOOLEAN_UNION || operation > BW_BOOLEAN_INTERSECTION)
    return bw_fail(context, BW_INVALID, "boolean operation %d: 0 to 2 expected", (int)operation);
  BW_TRY(closed_body(context, first, "first", &body[0]));
  BW_TRY(closed_body(context, second, "second", &body[1]));
  BW_TRY(bwi_name_alike(context, 2, body, &names));
  bwi_boolean_job job = {body[0], body[1], operation};
  BW_TRY(bwi_cgal_surface(context, "a boolean operation", &limits, bwi_cgal_boolean, &job, &made));
  if (made->triangle_count == 0) {
    status = bw_fail(context, BW_EMPTY, "nothing is left of the two bodies");
    goto done;
  }
  if (names && made->group)
    made->names = bw_retain(names);
  /* Rounding may have put corners of a facet onto a line. */
  BW_TRY(bwi_change_again(context, made, bwi_split_flat, 8, result, &changed));
done:
  bw_release(body[0]);
  bw_release(body[1]);
  bw_release(made);
  bw_release(names);
  return status;
}
