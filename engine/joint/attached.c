/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* Attached masses and springs in the matrices of a body. */
#include "joint/internal.h"

void bwi_add_attachments(const bw_model *model, const bw_block_pattern *pattern, int block,
                         double *values) {
  for (int a = 0; a < model->attachment_count; a++) {
    const bw_attachment *attachment = &model->attachment[a];
    int32_t parts = bwi_attachment_parts(attachment);
    for (int32_t p = 0; p < parts; p++) {
      const int32_t *node;
      double share[36];
      int count = bwi_attachment_part(attachment, p, &node, share);
      for (int i = 0; i < count; i++)
        for (int64_t b = pattern->start[node[i]]; b < pattern->start[node[i] + 1]; b++)
          for (int j = 0; j < count; j++) {
            if (pattern->column[b] != node[j])
              continue;
            if (block == 1)
              values[b] += attachment->mass * share[count * i + j];
            for (int k = 0; block == 9 && k < 3; k++)
              values[9 * b + 4 * k] += attachment->stiffness[k] * share[count * i + j];
          }
    }
  }
}

bool bwi_has_springs(const bw_model *model) {
  for (int a = 0; a < model->attachment_count; a++)
    if (!(model->attachment[a].mass > 0))
      return true;
  for (int p = 0; p < model->coupling_count; p++)
    if (bwi_point_has_springs(&model->coupling[p].point))
      return true;
  return false;
}
