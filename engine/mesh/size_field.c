/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* The element size that is asked for at a point. */
#include "mesh/tetgen_run.h"

double bwi_size_at(const bw_size_field *field, const double at[3]) {
  double wanted = 0;
  for (int64_t i = 0; i < field->point_count; i++) {
    const bw_size_point *p = &field->point[i];
    double d[3] = {at[0] - p->at[0], at[1] - p->at[1], at[2] - p->at[2]};
    double beyond = bw_norm(d) - p->radius;
    double here = p->length + (beyond > 0 ? 0.3 * beyond : 0);
    if (wanted == 0 || here < wanted)
      wanted = here;
  }
  if (field->size) {
    double here = field->size(field->data, at);
    if (!(here >= 0))
      return -1;
    if (here > 0 && (wanted == 0 || here < wanted))
      wanted = here;
  }
  return wanted;
}
