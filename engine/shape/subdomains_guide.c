/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* Which bone a part follows that touches no subdomain of type R. */
#include "shape/subdomains_internal.h"

static double distance_to_bone(const bw_skeleton *skeleton, int32_t b, const double at[3]) {
  return bwi_segment_distance(at, skeleton->joint + 3 * (size_t)skeleton->bone[2 * b],
                              skeleton->joint + 3 * (size_t)skeleton->bone[2 * b + 1]);
}

void bwi_guide_score(const bwi_guide *guide, const bw_mesh *mesh, const bw_skeleton *skeleton,
                     int32_t e, double *score) {
  const int32_t *node = bwi_nodes_of(mesh, e);
  size_t bones = (size_t)skeleton->bone_count;
  if (guide->weight) {
    for (int k = 0; k < 4; k++)
      for (size_t b = 0; b < bones; b++)
        score[b] += guide->weight[(size_t)node[k] * bones + b];
  } else if (guide->before) {
    const bw_subdomains *d = guide->before;
    for (int k = 0; k < 4; k++)
      for (int64_t i = d->influence_start[node[k]]; i < d->influence_start[node[k] + 1]; i++)
        score[d->influence_bone[i]] += d->influence_weight[i];
  } else {
    double middle[3] = {0, 0, 0};
    for (int k = 0; k < 4; k++)
      for (int j = 0; j < 3; j++)
        middle[j] += mesh->node[3 * (size_t)node[k] + (size_t)j] / 4;
    int32_t nearest = 0;
    double min = distance_to_bone(skeleton, 0, middle);
    for (int32_t b = 1; b < skeleton->bone_count; b++) {
      double distance = distance_to_bone(skeleton, b, middle);
      if (distance < min) {
        min = distance;
        nearest = b;
      }
    }
    score[nearest] += 1;
  }
}

int32_t bwi_highest(const double *score, int32_t count) {
  int32_t at = -1;
  for (int32_t i = 0; i < count; i++)
    if (score[i] > (at < 0 ? 0 : score[at]))
      at = i;
  return at;
}
