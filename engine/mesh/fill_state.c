/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* What the files of filling ask of its state, and what they write into its log. */
#include "mesh/fill_internal.h"

#include <stdio.h>

#include "base/limit.h"

void bwi_fill_describe_defects(const bw_surface_report *report, char *text, size_t size) {
  size_t used = 0;
  text[0] = 0;
  for (int k = 0; k < BW_DEFECT_KINDS; k++)
    if (report->count[k] && used < size) {
      int put = snprintf(text + used, size - used, "%s%lld x %s", used ? ", " : "",
                         (long long)report->count[k], bw_defect_word((bw_defect_kind)k));
      used += put > 0 ? (size_t)put : 0;
    }
}

void bwi_fill_append_log(bw_shape_log *to, const bw_shape_log *from) {
  for (int i = 0; i < from->count; i++)
    bw_shape_log_add(to, from->step[i].name, from->step[i].count, from->step[i].moved, "%s",
                     from->step[i].text);
}

/* Errors that another way of making the surface may cure. Time that ran out is none: which way is
 * taken must not depend on the machine. */
bool bwi_fill_may_cure(const bwi_filler *f, bw_status status) {
  if (bwi_time_ran_out(f->context, status))
    return false;
  return status == BW_GEOMETRY || status == BW_LIMIT || status == BW_INTERNAL ||
         status == BW_UNSUPPORTED || status == BW_CONVERGENCE;
}
