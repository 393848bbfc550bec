/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* Which elements follow one bone (agile, section 4): region growing from the skinning weights, and
 * what it takes for the invariants of bw_subdomains to hold.
 *
 * Through all steps bone[e] is the bone whose subdomain of type R holds element e; -1: type F. */
#include "shape/subdomains_internal.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

typedef struct growth {
  bw_context *context;
  const bw_mesh *mesh;
  const bw_skeleton *skeleton;
  const double *weight;
  double *threshold; /* per bone */
  int32_t *bone;     /* per element */
  double *mean;      /* per element: of the weights at its corners, for that bone */
  double *highest;   /* per bone: the highest mean of any element, for the warnings */
  int32_t lowered;   /* how many thresholds, and the lowest of them */
  double lowest;
  int32_t *stack, *component; /* scratch: per element */
} growth;

static double mean_weight(const growth *g, int32_t e, int32_t b) {
  const int32_t *node = bwi_nodes_of(g->mesh, e);
  size_t bones = (size_t)g->skeleton->bone_count;
  double sum = 0;
  for (int k = 0; k < 4; k++)
    sum += g->weight[(size_t)node[k] * bones + (size_t)b];
  return sum / 4;
}

/* The bone of highest mean weight at every element. */
static void find_best(growth *g) {
  for (int32_t e = 0; e < g->mesh->element_count; e++) {
    g->bone[e] = 0;
    g->mean[e] = -1;
    for (int32_t b = 0; b < g->skeleton->bone_count; b++) {
      double mean = mean_weight(g, e, b);
      g->highest[b] = fmax(g->highest[b], mean);
      if (mean > g->mean[e]) {
        g->bone[e] = b;
        g->mean[e] = mean;
      }
    }
  }
}

typedef struct ranked {
  double mean, volume;
  int32_t bone, element;
} ranked;

static int compare_ranked(const void *a, const void *b) {
  const ranked *x = a, *y = b;
  if (x->bone != y->bone)
    return x->bone < y->bone ? -1 : 1;
  if (x->mean != y->mean)
    return x->mean > y->mean ? -1 : 1;
  return (x->element > y->element) - (x->element < y->element);
}

/* Lower each bone's threshold to what `fraction` (by volume) of the elements that it moves most
 * reach: where bones are short for the body's thickness, no weight comes near one. */
static bw_status fit_thresholds(growth *g, double fraction, const double *own) {
  int32_t count = g->mesh->element_count;
  ranked *list = BW_NEW(g->context, ranked, count);
  if (!list)
    return BW_MEMORY;
  for (int32_t e = 0; e < count; e++)
    list[e] = (ranked){g->mean[e], g->mesh->volume[e], g->bone[e], e};
  qsort(list, (size_t)count, sizeof *list, compare_ranked);
  for (int32_t first = 0, end; first < count; first = end) {
    double total = 0, reached = 0;
    int32_t b = list[first].bone, at = first;
    for (end = first; end < count && list[end].bone == b; end++)
      total += list[end].volume;
    while (at + 1 < end && (reached += list[at].volume) < fraction * total)
      at++;
    if ((own && own[b] != 0) || list[at].mean >= g->threshold[b])
      continue;
    g->threshold[b] = list[at].mean;
    g->lowered++;
    g->lowest = fmin(g->lowest, list[at].mean);
  }
  bw_free(list);
  return BW_OK;
}

/* An element's candidate: of the bones whose threshold it reaches, the one of the highest mean. */
static void candidates(growth *g) {
  for (int32_t e = 0; e < g->mesh->element_count; e++) {
    g->bone[e] = -1;
    g->mean[e] = 0;
    for (int32_t b = 0; b < g->skeleton->bone_count; b++) {
      double mean = mean_weight(g, e, b);
      /* rounding of a mean of four must not decide */
      if (mean > g->mean[e] && mean >= g->threshold[b] * (1 - 1e-12)) {
        g->bone[e] = b;
        g->mean[e] = mean;
      }
    }
  }
}

/* Mark with `mark` in component[] what is connected to `seed` through faces of elements of the same
 * bone, and return how many there are. */
static int32_t flood(growth *g, int32_t seed, int32_t mark) {
  int32_t depth = 0, count = 0;
  g->stack[depth++] = seed;
  g->component[seed] = mark;
  while (depth > 0) {
    int32_t e = g->stack[--depth];
    count++;
    for (int k = 0; k < 4; k++) {
      int32_t other = g->mesh->neighbour[4 * (size_t)e + (size_t)k];
      if (other >= 0 && g->component[other] < 0 && g->bone[other] == g->bone[seed]) {
        g->component[other] = mark;
        g->stack[depth++] = other;
      }
    }
  }
  return count;
}

static void clear_components(growth *g) {
  for (int32_t e = 0; e < g->mesh->element_count; e++)
    g->component[e] = -1;
}

/* Region growing: of a bone's candidates only those stay that can be reached through faces from the
 * one of the highest mean. */
static void grow_from_seeds(growth *g, int32_t *seed) {
  for (int32_t b = 0; b < g->skeleton->bone_count; b++)
    seed[b] = -1;
  for (int32_t e = 0; e < g->mesh->element_count; e++) {
    int32_t b = g->bone[e];
    if (b >= 0 && (seed[b] < 0 || g->mean[e] > g->mean[seed[b]]))
      seed[b] = e;
  }
  clear_components(g);
  for (int32_t b = 0; b < g->skeleton->bone_count; b++)
    if (seed[b] >= 0)
      flood(g, seed[b], b);
  for (int32_t e = 0; e < g->mesh->element_count; e++)
    if (g->component[e] < 0)
      g->bone[e] = -1;
}

/* Where subdomains of two bones meet at a node, the one with the element of the highest mean there
 * keeps it; the others' elements at that node become type F. Releasing elements makes no new
 * meeting, so that once is enough. */
static bw_status part_subdomains(growth *g) {
  const bw_mesh *mesh = g->mesh;
  double *best = BW_NEW0(g->context, double, mesh->node_count);
  int32_t *owner = BW_NEW(g->context, int32_t, mesh->node_count);
  if (!best || !owner) {
    bw_free(best);
    bw_free(owner);
    return BW_MEMORY;
  }
  for (int32_t i = 0; i < mesh->node_count; i++)
    owner[i] = -1;
  for (int32_t e = 0; e < mesh->element_count; e++) {
    if (g->bone[e] < 0)
      continue;
    for (int k = 0; k < 4; k++) {
      int32_t i = bwi_nodes_of(mesh, e)[k];
      if (owner[i] < 0 || g->mean[e] > best[i] ||
          (g->mean[e] == best[i] && g->bone[e] < owner[i])) {
        owner[i] = g->bone[e];
        best[i] = g->mean[e];
      }
    }
  }
  for (int32_t e = 0; e < mesh->element_count; e++)
    for (int k = 0; k < 4 && g->bone[e] >= 0; k++)
      if (owner[bwi_nodes_of(mesh, e)[k]] != g->bone[e])
        g->bone[e] = -1;
  bw_free(best);
  bw_free(owner);
  return BW_OK;
}

/* Of each bone's components (connected through faces) only the largest stays. */
static void keep_largest(growth *g, int32_t *first, int32_t *size) {
  for (int32_t b = 0; b < g->skeleton->bone_count; b++)
    first[b] = -1, size[b] = 0;
  clear_components(g);
  for (int32_t e = 0; e < g->mesh->element_count; e++) {
    int32_t b = g->bone[e];
    if (b < 0 || g->component[e] >= 0)
      continue;
    int32_t count = flood(g, e, e);
    if (count > size[b]) {
      size[b] = count;
      first[b] = e;
    }
  }
  for (int32_t e = 0; e < g->mesh->element_count; e++)
    if (g->bone[e] >= 0 && g->component[e] != first[g->bone[e]])
      g->bone[e] = -1;
}

static int32_t liked_bone(const growth *g, int32_t first, const int32_t *next, double *score) {
  bwi_guide guide = {g->weight, NULL};
  memset(score, 0, (size_t)g->skeleton->bone_count * sizeof *score);
  for (int32_t e = first; e >= 0; e = next[e])
    bwi_guide_score(&guide, g->mesh, g->skeleton, e, score);
  return bwi_highest(score, g->skeleton->bone_count);
}

/* Groups of type F that touch at most one subdomain of type R. One that touches none becomes the
 * subdomain of its bone of highest weight, if that bone has none. One that touches a single
 * subdomain, and is mostly that bone's own, would follow it as a whole anyway: what hangs on it
 * through faces joins it. touches[first element of a group]: -1 none, -2 several, else the bone. */
static bw_status settle_groups(growth *g, int32_t *first, int32_t *size) {
  const bw_mesh *mesh = g->mesh;
  bw_status status = BW_OK;
  int32_t *group = BW_NEW(g->context, int32_t, mesh->element_count);
  int32_t *next = BW_NEW(g->context, int32_t, mesh->element_count);
  int32_t *last = BW_NEW(g->context, int32_t, mesh->element_count);
  int32_t *touches = BW_NEW(g->context, int32_t, mesh->element_count);
  int32_t *owner = BW_NEW(g->context, int32_t, mesh->node_count);
  double *score = BW_NEW(g->context, double, g->skeleton->bone_count);
  BW_TRY_MEMORY(group && next && last && touches && owner && score);
  BW_TRY(bwi_flexible_groups(g->context, mesh, g->bone, group));
  for (int32_t i = 0; i < mesh->node_count; i++)
    owner[i] = -1;
  for (int32_t b = 0; b < g->skeleton->bone_count; b++)
    size[b] = 0;
  for (int32_t e = 0; e < mesh->element_count; e++)
    if (g->bone[e] >= 0) {
      size[g->bone[e]]++;
      for (int k = 0; k < 4; k++)
        owner[bwi_nodes_of(mesh, e)[k]] = g->bone[e];
    }
  for (int32_t e = 0; e < mesh->element_count; e++) {
    next[e] = -1;
    int32_t to = group[e];
    if (to < 0)
      continue;
    if (to == e)
      touches[e] = -1;
    else
      next[last[to]] = e;
    last[to] = e;
    for (int k = 0; k < 4; k++) {
      int32_t b = owner[bwi_nodes_of(mesh, e)[k]];
      if (b >= 0 && touches[to] != b)
        touches[to] = touches[to] == -1 ? b : -2;
    }
  }
  for (int32_t e = 0; e < mesh->element_count; e++) {
    if (group[e] != e || touches[e] == -2)
      continue;
    int32_t likes = liked_bone(g, e, next, score);
    if (touches[e] >= 0 ? likes != touches[e] : size[likes] > 0)
      continue;
    for (int32_t i = e; i >= 0; i = next[i])
      g->bone[i] = likes;
    size[likes]++;
  }
  /* what was given away but hangs on by an edge or a corner only falls back to type F */
  keep_largest(g, first, size);
done:
  bw_free(group);
  bw_free(next);
  bw_free(last);
  bw_free(touches);
  bw_free(owner);
  bw_free(score);
  return status;
}

enum { WARNINGS = 4 }; /* on single bones; of more, their number says enough */

static void warning(growth *g, double fraction) {
  if (g->lowered > 0)
    bw_warn(g->context,
            "the thresholds of %d of %d bones were lowered, to %.3g at least, so that each has a "
            "subdomain of %g %% of what it moves most",
            g->lowered, g->skeleton->bone_count, g->lowest, 100 * fraction);
  int32_t without = 0;
  for (int32_t b = 0; b < g->skeleton->bone_count; b++) {
    bool found = false;
    for (int32_t e = 0; e < g->mesh->element_count && !found; e++)
      found = g->bone[e] == b;
    if (found || without++ >= WARNINGS)
      continue;
    bw_warn(g->context,
            "bone \"%s\" has no subdomain of its own: the highest mean weight of an element is "
            "%.3g, its threshold %.3g; lower that threshold, or assign elements to the bone",
            g->skeleton->bone_name[b].text, g->highest[b], g->threshold[b]);
  }
  if (without > WARNINGS)
    bw_warn(g->context, "%d of %d bones have no subdomain of their own: fewer bones would do",
            without, g->skeleton->bone_count);
}

static bw_status check_threshold(bw_context *context, double threshold, const char *of) {
  if (threshold > 0 && threshold <= 1)
    return BW_OK;
  bw_fail(context, BW_INVALID,
          "%s has the threshold %g: a mean weight above 0 and at most 1 expected (usually 0.95)",
          of, threshold);
  bw_detail_number(context, "threshold", threshold);
  return BW_INVALID;
}

static bw_status check_weights(bw_context *context, const bw_mesh *mesh,
                               const bw_skeleton *skeleton, const double *weight) {
  size_t bones = (size_t)skeleton->bone_count;
  for (int32_t i = 0; i < mesh->node_count; i++) {
    double sum = 0;
    bool negative = false;
    for (size_t b = 0; b < bones; b++) {
      double w = weight[(size_t)i * bones + b];
      negative |= !(w >= 0);
      sum += w;
    }
    if (!negative && fabs(sum - 1) <= 1e-6)
      continue;
    bw_fail(context, BW_INVALID,
            "the weights of node %d sum to %g%s: they must not be negative and must sum to 1",
            i + 1, sum, negative ? ", some negative or not a number" : "");
    bw_detail_number(context, "node", i + 1.0);
    return BW_INVALID;
  }
  return BW_OK;
}

bw_status bw_subdomains_create(bw_context *context, const bw_mesh *mesh,
                               const bw_skeleton *skeleton, const double *weight,
                               const bw_subdomains_options *options, bw_subdomains **subdomains) {
  int32_t bones = skeleton->bone_count;
  double usual = options && options->threshold != 0 ? options->threshold : 0.95;
  double fraction = options && options->fraction != 0 ? options->fraction : 0.35;
  if (!(fraction <= 1))
    return bw_fail(
        context, BW_INVALID,
        "a fraction of %g: at most 1 expected, or a negative number for thresholds as they are",
        fraction);
  bw_status status = check_threshold(context, usual, "the skeleton");
  if (status == BW_OK)
    status = check_weights(context, mesh, skeleton, weight);
  if (status != BW_OK)
    return status;
  double *threshold = BW_NEW(context, double, bones);
  growth g = {.context = context, .mesh = mesh, .skeleton = skeleton, .weight = weight};
  g.threshold = threshold;
  g.lowest = 1;
  int32_t *first = BW_NEW(context, int32_t, bones), *size = BW_NEW(context, int32_t, bones);
  g.bone = BW_NEW(context, int32_t, mesh->element_count);
  g.mean = BW_NEW(context, double, mesh->element_count);
  g.highest = BW_NEW0(context, double, bones);
  g.stack = BW_NEW(context, int32_t, mesh->element_count);
  g.component = BW_NEW(context, int32_t, mesh->element_count);
  BW_TRY_MEMORY(threshold && first && size && g.bone && g.mean && g.highest && g.stack &&
                g.component);
  for (int32_t b = 0; b < bones; b++) {
    bool own = options && options->bone_threshold && options->bone_threshold[b] != 0;
    threshold[b] = own ? options->bone_threshold[b] : usual;
    BW_TRY(check_threshold(context, threshold[b], skeleton->bone_name[b].text));
  }
  find_best(&g);
  if (fraction > 0)
    BW_TRY(fit_thresholds(&g, fraction, options ? options->bone_threshold : NULL));
  candidates(&g);
  BW_TRY(bw_check_cancel(context));
  grow_from_seeds(&g, first);
  BW_TRY(part_subdomains(&g));
  keep_largest(&g, first, size);
  BW_TRY(settle_groups(&g, first, size));
  BW_TRY(bw_check_cancel(context));
  bwi_guide guide = {weight, NULL};
  BW_TRY(bwi_subdomains_from_bones(context, mesh, skeleton, g.bone, &guide, subdomains));
  warning(&g, fraction);
done:
  bw_free(threshold);
  bw_free(first);
  bw_free(size);
  bw_free(g.bone);
  bw_free(g.mean);
  bw_free(g.highest);
  bw_free(g.stack);
  bw_free(g.component);
  return status;
}
