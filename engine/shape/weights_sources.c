/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* The sources of heat on the surface: for every point the nearest bones that it sees. */
#include "shape/weights.h"

#include <math.h>

static const double tie = 1e-4;     /* bones as near as this, relatively, share a point */
static const double inset = 1e-3;   /* of an edge: where a point looks from */
static const double min_gap = 1e-6; /* of the box: a bone on the surface is this far away */
enum { POINTS_PER_CHUNK = 256 };

typedef struct look {
  const bwi_skinning *s;
  double from[3], way[3];
  bool blocked;
} look;

static bool blocks(void *data, int32_t facet) {
  look *l = data;
  const int32_t *corner = l->s->triangle + 3 * (size_t)facet;
  const double *a = l->s->at + 3 * (size_t)corner[0];
  double e1[3], e2[3], from[3], p[3], q[3];
  for (size_t k = 0; k < 3; k++) {
    e1[k] = l->s->at[3 * (size_t)corner[1] + k] - a[k];
    e2[k] = l->s->at[3 * (size_t)corner[2] + k] - a[k];
    from[k] = l->from[k] - a[k];
  }
  bw_cross(l->way, e2, p);
  double det = bw_dot(e1, p);
  if (det == 0)
    return true;
  double u = bw_dot(from, p) / det;
  bw_cross(from, e1, q);
  double v = bw_dot(l->way, q) / det, t = bw_dot(e2, q) / det;
  l->blocked = u >= 0 && v >= 0 && u + v <= 1 && t > 0 && t < 1;
  return !l->blocked;
}

double bwi_nearest_on_bone(const bw_skeleton *s, int32_t bone, const double *x, double *place) {
  const double *head = s->joint + 3 * (size_t)s->bone[2 * (size_t)bone];
  const double *tail = s->joint + 3 * (size_t)s->bone[2 * (size_t)bone + 1];
  double along[3], from[3], d[3];
  for (int k = 0; k < 3; k++) {
    along[k] = tail[k] - head[k];
    from[k] = x[k] - head[k];
  }
  double t = fmin(fmax(bw_dot(from, along) / bw_dot(along, along), 0), 1);
  for (int k = 0; k < 3; k++) {
    place[k] = head[k] + t * along[k];
    d[k] = x[k] - place[k];
  }
  return bw_norm(d);
}

/* A point looks from just below the surface, so that its own facets hide what lies outwards. */
static bool sees(const bwi_skinning *s, int32_t point, int32_t bone) {
  look l = {.s = s};
  double to[3];
  const double *x = s->at + 3 * (size_t)point, *n = s->normal + 3 * (size_t)point;
  bwi_nearest_on_bone(s->skeleton, bone, x, to);
  double size = bw_norm(n), below = size > 0 ? inset * s->edge[point] / size : 0;
  for (int k = 0; k < 3; k++) {
    l.from[k] = x[k] - below * n[k];
    l.way[k] = to[k] - l.from[k];
  }
  bwi_tree_on_segment(s->tree, l.from, to, blocks, &l);
  return !l.blocked;
}

static bw_status find_sources(void *data, int64_t begin, int64_t end, int worker) {
  bwi_skinning *s = data;
  int32_t bones = s->skeleton->bone_count;
  double *gap = s->gap + (size_t)worker * (size_t)bones, place[3];
  for (int64_t i = begin; i < end; i++) {
    uint8_t *is_near = s->is_near + (size_t)i * (size_t)bones;
    const double *x = s->at + 3 * (size_t)i;
    int32_t nearest = 0, first = -1;
    for (int32_t b = 0; b < bones; b++) {
      gap[b] = bwi_nearest_on_bone(s->skeleton, b, x, place);
      if (gap[b] < gap[nearest])
        nearest = b;
      is_near[b] = 0;
    }
    /* the nearest first, until one is seen; 2 marks those that are not */
    for (int32_t tried = 0; tried < bones && first < 0; tried++) {
      int32_t next = -1;
      for (int32_t b = 0; b < bones; b++)
        if (!is_near[b] && (next < 0 || gap[b] < gap[next]))
          next = b;
      if (sees(s, (int32_t)i, next))
        first = next;
      else
        is_near[next] = 2;
    }
    bool any = first >= 0;
    double d = any ? gap[first] : gap[nearest];
    s->near[i] = 0;
    for (int32_t b = 0; b < bones; b++) {
      bool close = gap[b] <= (1 + tie) * d;
      is_near[b] = close && (!any || (is_near[b] == 0 && (b == first || sees(s, (int32_t)i, b))));
      s->near[i] += is_near[b];
    }
    d = fmax(d, min_gap * s->size);
    s->source[i] = fmax(s->area[i], 1e-12 * s->size * s->size) * s->heat / (d * d);
  }
  return BW_OK;
}

bw_status bwi_find_sources(bwi_skinning *s) {
  return bw_parallel(s->context, s->points, POINTS_PER_CHUNK, find_sources, s);
}
