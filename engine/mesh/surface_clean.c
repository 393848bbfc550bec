/* Dropping and splitting facets that should not be there.
 *
 * Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
#include <math.h>
#include <string.h>

#include "mesh/surface_internal.h"
#include "mesh/surface_repair.h"
#include "mesh/surface_topology.h"

bw_status bwi_surface_select(bw_context *context, const bw_surface *surface, const uint8_t *keep,
                             int64_t extra, const int32_t *extra_triangle,
                             const int32_t *extra_from, bw_surface **out) {
  bw_status status = BW_OK;
  int64_t count = 0;
  bw_surface *loose = NULL;
  int32_t *group = NULL;
  size_t all = (size_t)surface->triangle_count + (size_t)extra;
  const bool grouped = surface->group && (extra == 0 || extra_from);
  int32_t *triangle = BW_NEW(context, int32_t, 3 * all);
  if (grouped)
    group = BW_NEW(context, int32_t, all);
  BW_TRY_MEMORY(triangle && (group || !grouped));
  for (int64_t t = 0; t < surface->triangle_count; t++)
    if (!keep || keep[t]) {
      memcpy(triangle + 3 * count, surface->triangle + 3 * t, 3 * sizeof *triangle);
      if (group)
        group[count] = surface->group[t];
      count++;
    }
  for (int64_t i = 0; i < extra; i++) {
    memcpy(triangle + 3 * count, extra_triangle + 3 * i, 3 * sizeof *triangle);
    if (group)
      group[count] = surface->group[extra_from[i]];
    count++;
  }
  BW_TRY(bw_surface_copy(context, surface->point_count, surface->point, count, triangle, group,
                         &loose));
  bwi_keep_names(surface, loose);
  BW_TRY(bw_surface_weld(context, loose, 0, out));
done:
  bw_release(loose);
  bw_free(triangle);
  bw_free(group);
  return status;
}

/* The facets with keep[t], or the surface itself when nothing is dropped. */
static bw_status keep_only(bw_context *context, const bw_surface *surface, const uint8_t *keep,
                           int64_t dropped, bw_surface **out, int64_t *changed) {
  *changed = dropped;
  if (dropped == 0) {
    *out = (bw_surface *)bw_retain(surface);
    return BW_OK;
  }
  return bwi_surface_select(context, surface, keep, 0, NULL, NULL, out);
}

bw_status bwi_drop_repeated(bw_context *context, const bw_surface *surface, bw_surface **out,
                            int64_t *changed) {
  bw_status status = BW_OK;
  bwi_topology *topology = NULL;
  int64_t dropped = 0;
  BW_TRY(bwi_topology_create(context, surface, &topology));
  for (int32_t t = 0; t < topology->facets; t++) {
    dropped += topology->degenerate[t];
    topology->degenerate[t] ^= 1; /* now: keep */
  }
  BW_TRY(keep_only(context, surface, topology->degenerate, dropped, out, changed));
done:
  bwi_topology_destroy(topology);
  return status;
}

/* ---- duplicates ------------------------------------------------------------------------------ */

static bool same_turn(const int32_t *a, const int32_t *b) {
  for (int k = 0; k < 3; k++)
    if (a[k] == b[0])
      return a[(k + 1) % 3] == b[1];
  return false;
}

/* Of a patch's edges, those where other facets join it, and that would not have two facets if the
 * patch's facets counted `weight` times. */
static int64_t bad_rim(const bwi_topology *topology, const int32_t *patch, int32_t which,
                       const uint8_t *keep, int weight, const int64_t *edges, int64_t count) {
  int64_t bad = 0;
  for (int64_t i = 0; i < count; i++) {
    int64_t e = edges[i];
    int own = 0, others = 0;
    for (int64_t s = topology->start[e]; s < topology->start[e + 1]; s++) {
      int32_t t = (int32_t)(topology->side[s] / 3);
      if (patch[t] == which)
        own += keep[t];
      else
        others += keep[t];
    }
    bad += others > 0 && others + weight * own != 2;
  }
  return bad;
}

bw_status bwi_drop_duplicates(bw_context *context, const bw_surface *surface, bw_surface **out,
                              int64_t *changed) {
  bw_status status = BW_OK;
  bwi_topology *topology = NULL;
  int64_t dropped = 0;
  int32_t facets = surface->triangle_count;
  int32_t *same = BW_NEW(context, int32_t, facets);
  int32_t *balance =
      BW_NEW0(context, int32_t, facets);             /* first ones: copies one way less the other */
  int32_t *patch = BW_NEW(context, int32_t, facets); /* facets back to back, joined by edges */
  uint8_t *keep = BW_NEW(context, uint8_t, facets);
  uint8_t *doubled = BW_NEW0(context, uint8_t, facets);
  int64_t *edges = NULL, *first = NULL;
  BW_TRY_MEMORY(same && balance && patch && keep && doubled);
  BW_TRY(bwi_topology_create(context, surface, &topology));
  BW_TRY(bwi_same_facets(context, topology, same));
  for (int32_t t = 0; t < facets; t++) {
    bool turn =
        same_turn(topology->corner + 3 * (int64_t)same[t], topology->corner + 3 * (int64_t)t);
    balance[same[t]] += turn ? 1 : -1;
    keep[t] = same[t] == t;
    dropped += !keep[t];
    if (same[t] != t)
      doubled[same[t]] = 1;
    patch[t] = t;
  }
  if (dropped == 0) {
    BW_TRY(keep_only(context, surface, keep, 0, out, changed));
    goto done;
  }
  /* Walls: first facets whose copies cancel, joined across edges into patches. */
  for (int64_t e = 0; e < topology->edges; e++) {
    int32_t before = -1;
    for (int64_t i = topology->start[e]; i < topology->start[e + 1]; i++) {
      int32_t t = (int32_t)(topology->side[i] / 3);
      if (!keep[t] || !doubled[t] || balance[t] != 0)
        continue;
      if (before >= 0)
        bwi_set_join(patch, before, t);
      before = t;
    }
  }
  for (int32_t t = 0; t < facets; t++) {
    bool wall = keep[t] && doubled[t] && balance[t] == 0;
    patch[t] = wall ? bwi_set_root(patch, t) : -1;
  }
  /* The edges of each patch, listed together by sorting (patch, edge) with counting. */
  first = BW_NEW0(context, int64_t, (size_t)facets + 1);
  edges = BW_NEW(context, int64_t, (size_t)topology->edges + 1);
  BW_TRY_MEMORY(first && edges);
  for (int pass = 0; pass < 2; pass++) {
    for (int64_t e = 0; e < topology->edges; e++)
      for (int64_t i = topology->start[e]; i < topology->start[e + 1]; i++) {
        int32_t p = patch[topology->side[i] / 3];
        if (p < 0)
          continue;
        if (pass == 0)
          first[p + 1]++;
        else
          edges[first[p]++] = e; /* afterwards first[p] is the end of p's list */
        break;                   /* walls around one edge are in one patch */
      }
    for (int32_t p = 0; pass == 0 && p < facets; p++)
      first[p + 1] += first[p];
  }
  for (int32_t p = 0; p < facets; p++) {
    int64_t start = p ? first[p - 1] : 0, count = first[p] - start;
    if (count == 0)
      continue;
    int64_t bad_one = bad_rim(topology, patch, p, keep, 1, edges + start, count);
    int64_t bad_none = bad_rim(topology, patch, p, keep, 0, edges + start, count);
    doubled[p] = bad_none < bad_one ? 2 : 1; /* p is the first facet of its patch */
  }
  for (int32_t t = 0; t < facets; t++)
    if (patch[t] >= 0 && doubled[patch[t]] == 2) {
      keep[t] = 0;
      dropped++;
    }
  BW_TRY(keep_only(context, surface, keep, dropped, out, changed));
done:
  bwi_topology_destroy(topology);
  bw_free(same);
  bw_free(balance);
  bw_free(patch);
  bw_free(keep);
  bw_free(doubled);
  bw_free(edges);
  bw_free(first);
  return status;
}

/* ---- flat facets --------------------------------------------------------------------------- */

static double side_length(const bwi_topology *topology, int64_t side) {
  const double *a = topology->point + 3 * (int64_t)bwi_side_from(topology, side),
               *b = topology->point + 3 * (int64_t)bwi_side_to(topology, side);
  double d[3] = {b[0] - a[0], b[1] - a[1], b[2] - a[2]};
  return bw_norm(d);
}

/* One pass; facets touched already wait for the next. */
static bw_status split_flat_once(bw_context *context, const bw_surface *surface, bw_surface **out,
                                 int64_t *changed) {
  bw_status status = BW_OK;
  bwi_topology *topology = NULL;
  bw_surface *welded = NULL;
  int64_t extra = 0, dropped = 0;
  uint8_t *flat = NULL, *keep = NULL;
  int32_t *triangle = NULL, *from = NULL;
  BW_TRY(bw_surface_weld(context, surface, 0, &welded));
  BW_TRY(bwi_topology_create(context, welded, &topology));
  flat = BW_NEW(context, uint8_t, topology->facets);
  keep = BW_NEW(context, uint8_t, topology->facets);
  triangle = BW_NEW(context, int32_t, 6 * (size_t)topology->facets);
  from = BW_NEW(context, int32_t, 2 * (size_t)topology->facets);
  BW_TRY_MEMORY(flat && keep && triangle && from);
  BW_TRY(bwi_flat_facets(context, topology, flat));
  memset(keep, 1, (size_t)topology->facets);
  for (int32_t t = 0; t < topology->facets; t++) {
    if (!flat[t] || !keep[t])
      continue;
    if (topology->degenerate[t]) {
      keep[t] = 0;
      dropped++;
      continue;
    }
    int64_t longest = 3 * (int64_t)t;
    for (int64_t s = longest + 1; s < 3 * (int64_t)t + 3; s++)
      if (side_length(topology, s) > side_length(topology, longest))
        longest = s;
    int32_t middle = welded->triangle[3 * (int64_t)t + (longest % 3 + 2) % 3];
    int64_t e = topology->edge_of[longest], start = topology->start[e];
    if (topology->start[e + 1] - start == 2) {
      int64_t other =
          topology->side[start] == longest ? topology->side[start + 1] : topology->side[start];
      int64_t o = other / 3;
      if (!keep[o])
        continue; /* later */
      int32_t a = welded->triangle[other], b = welded->triangle[3 * o + (other % 3 + 1) % 3],
              c = welded->triangle[3 * o + (other % 3 + 2) % 3];
      keep[o] = 0;
      if (c != middle) { /* else the two lie flat on each other: both go */
        int32_t split[6] = {a, middle, c, middle, b, c};
        memcpy(triangle + 3 * extra, split, sizeof split);
        from[extra] = from[extra + 1] = (int32_t)o;
        extra += 2;
      }
    }
    keep[t] = 0;
    dropped++;
  }
  *changed = dropped;
  if (dropped == 0)
    *out = (bw_surface *)bw_retain(surface);
  else
    BW_TRY(bwi_surface_select(context, welded, keep, extra, triangle, from, out));
done:
  bwi_topology_destroy(topology);
  bw_release(welded);
  bw_free(flat);
  bw_free(keep);
  bw_free(triangle);
  bw_free(from);
  return status;
}

bw_status bwi_change_again(bw_context *context, const bw_surface *surface,
                           bwi_surface_change *change, int rounds, bw_surface **out,
                           int64_t *changed) {
  bw_status status = BW_OK;
  bw_surface *now = (bw_surface *)bw_retain(surface), *next = NULL;
  int64_t count = 1;
  *changed = 0;
  for (int round = 0; round < rounds && count > 0; round++) {
    BW_TRY(bw_check_cancel(context));
    BW_TRY(change(context, now, &next, &count));
    bw_release(now);
    now = next;
    next = NULL;
    *changed += count;
  }
  *out = now;
  now = NULL;
done:
  bw_release(now);
  return status;
}

bw_status bwi_split_flat(bw_context *context, const bw_surface *surface, bw_surface **out,
                         int64_t *changed) {
  return bwi_change_again(context, surface, split_flat_once, 50, out, changed);
}

/* ---- fins ---------------------------------------------------------------------------------- */

bw_status bwi_drop_fins(bw_context *context, const bw_surface *surface, bw_surface **out,
                        int64_t *changed) {
  bw_status status = BW_OK;
  bwi_topology *topology = NULL;
  int64_t dropped = 0;
  uint8_t *keep = NULL;
  int32_t *facets = NULL, *queue = NULL;
  int64_t held = 0;
  BW_TRY(bwi_topology_create(context, surface, &topology));
  keep = BW_NEW(context, uint8_t, topology->facets);
  facets = BW_NEW(context, int32_t, topology->edges); /* left on each edge */
  queue = BW_NEW(context, int32_t, 4 * (size_t)topology->facets);
  BW_TRY_MEMORY(keep && facets && queue);
  memset(keep, 1, (size_t)topology->facets);
  for (int64_t e = 0; e < topology->edges; e++)
    facets[e] = (int32_t)(topology->start[e + 1] - topology->start[e]);
  for (int32_t t = topology->facets - 1; t >= 0; t--)
    queue[held++] = t;
  while (held > 0) {
    int32_t t = queue[--held];
    if (!keep[t] || topology->degenerate[t])
      continue;
    bool open = false, crowded = false;
    for (int k = 0; k < 3; k++) {
      int32_t n = facets[topology->edge_of[3 * (int64_t)t + k]];
      open |= n == 1;
      crowded |= n > 2;
    }
    if (!open || !crowded)
      continue;
    keep[t] = 0;
    dropped++;
    for (int k = 0; k < 3; k++) {
      int64_t e = topology->edge_of[3 * (int64_t)t + k];
      facets[e]--;
      for (int64_t i = topology->start[e]; facets[e] == 1 && i < topology->start[e + 1]; i++)
        if (keep[topology->side[i] / 3])
          queue[held++] = (int32_t)(topology->side[i] / 3);
    }
  }
  BW_TRY(keep_only(context, surface, keep, dropped, out, changed));
done:
  bwi_topology_destroy(topology);
  bw_free(keep);
  bw_free(facets);
  bw_free(queue);
  return status;
}
