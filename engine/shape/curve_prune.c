/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* Pruning a curve: the least of its branches goes first, and everything is checked again after
 * each, since a junction that loses a branch may become part of one.
 *
 * Contraction leaves spurs that point at corners and bumps of the surface, and splits a junction of
 * four limbs into two of three that lie close together. Both are small against the local radius,
 * which distinguishes them from thin limbs. */
#include <math.h>
#include <string.h>

#include "shape/curve.h"

/* Two junctions are one when the way between them is shorter than this many radii. */
static const double same_junction = 1.2;

static double way_length(const double *at, int32_t count) {
  double length = 0;
  for (int32_t i = 1; i < count; i++)
    length += bwi_gap(at + 4 * (size_t)(i - 1), at + 4 * (size_t)i);
  return length;
}

double bwi_branches_length(const bwi_curve *curve) {
  double length = 0;
  for (int32_t b = 0; b < curve->branch_count; b++)
    if (curve->branch[b].at)
      length += way_length(curve->branch[b].at, curve->branch[b].count);
  return length;
}

/* How far a branch strays from its junction. */
static double reach(const bwi_branch *b, const double *junction) {
  double far = 0;
  for (int32_t i = 0; i < b->count; i++)
    far = fmax(far, bwi_gap(b->at + 4 * (size_t)i, junction));
  return far;
}

static void turn_round(bwi_branch *b) {
  int32_t end = b->end[0];
  b->end[0] = b->end[1];
  b->end[1] = end;
  for (int32_t i = 0, k = b->count - 1; i < k; i++, k--)
    for (size_t c = 0; c < 4; c++) {
      double x = b->at[4 * (size_t)i + c];
      b->at[4 * (size_t)i + c] = b->at[4 * (size_t)k + c];
      b->at[4 * (size_t)k + c] = x;
    }
}

/* The two branches at a key become one. */
static bw_status join(bw_context *context, bwi_curve *curve, int32_t key) {
  bwi_branch *both[2] = {NULL, NULL};
  int found = 0;
  for (int32_t b = 0; b < curve->branch_count && found < 2; b++)
    if (curve->branch[b].at && (curve->branch[b].end[0] == key || curve->branch[b].end[1] == key))
      both[found++] = &curve->branch[b];
  if (both[0]->end[1] != key)
    turn_round(both[0]);
  if (both[1]->end[0] != key)
    turn_round(both[1]);
  size_t first = (size_t)both[0]->count, second = (size_t)both[1]->count;
  double *at = bw_resize(context, both[0]->at, 4 * (first + second - 1), sizeof *at);
  if (!at)
    return BW_MEMORY;
  memcpy(at + 4 * first, both[1]->at + 4, 4 * (second - 1) * sizeof *at);
  both[0]->at = at;
  both[0]->count += both[1]->count - 1;
  both[0]->end[1] = both[1]->end[1];
  bw_free(both[1]->at);
  both[1]->at = NULL;
  curve->key[key].degree = 0;
  return BW_OK;
}

static bw_status leave_out(bw_context *context, bwi_curve *curve, int32_t branch) {
  bwi_branch *b = &curve->branch[branch];
  bw_free(b->at);
  b->at = NULL;
  for (int k = 0; k < 2; k++)
    if (--curve->key[b->end[k]].degree == 2) {
      bw_status status = join(context, curve, b->end[k]);
      if (status != BW_OK)
        return status;
    }
  return BW_OK;
}

/* A branch between two junctions shrinks to its middle; the others are drawn there. */
static bw_status contract(bw_context *context, bwi_curve *curve, int32_t branch) {
  bwi_branch *b = &curve->branch[branch];
  int32_t keep = b->end[0], lose = b->end[1];
  double left = 0.5 * way_length(b->at, b->count), at[4];
  memcpy(at, b->at, sizeof at);
  for (int32_t i = 1; i < b->count && left > 0; i++) {
    const double *from = b->at + 4 * (size_t)(i - 1), *to = from + 4;
    double part = bwi_gap(from, to), t = part > left ? left / part : 1;
    for (int k = 0; k < 3; k++)
      at[k] = from[k] + t * (to[k] - from[k]);
    left -= part;
  }
  at[3] = fmax(curve->key[keep].at[3], curve->key[lose].at[3]);
  for (int32_t i = 0; i < curve->branch_count; i++) {
    bwi_branch *other = &curve->branch[i];
    if (!other->at || i == branch)
      continue;
    for (int k = 0; k < 2; k++) {
      if (other->end[k] != keep && other->end[k] != lose)
        continue;
      double *more = bw_resize(context, other->at, 4 * ((size_t)other->count + 1), sizeof *more);
      if (!more)
        return BW_MEMORY;
      other->at = more;
      if (k == 0)
        memmove(more + 4, more, 4 * (size_t)other->count * sizeof *more);
      memcpy(more + (k == 0 ? 0 : 4 * (size_t)other->count), at, sizeof at);
      other->count++;
      other->end[k] = keep;
    }
  }
  bw_free(b->at);
  b->at = NULL;
  memcpy(curve->key[keep].at, at, sizeof at);
  curve->key[keep].degree += curve->key[lose].degree - 2;
  curve->key[lose].degree = 0;
  return BW_OK;
}

bw_status bwi_curve_prune(bw_context *context, bwi_curve *curve, double prune, int32_t max) {
  for (;;) {
    int32_t branches = 0, spur = -1, bridge = -1, min = -1;
    double spur_size = prune, bridge_size = same_junction, min_size = HUGE_VAL;
    for (int32_t i = 0; i < curve->branch_count; i++) {
      const bwi_branch *b = &curve->branch[i];
      if (!b->at)
        continue;
      branches++;
      const bwi_curve_key *one = &curve->key[b->end[0]], *two = &curve->key[b->end[1]];
      if (one->degree == 1 && two->degree == 1)
        continue; /* the only one */
      if (one->degree > 1 && two->degree > 1) {
        double size = way_length(b->at, b->count) / fmax(one->at[3], two->at[3]);
        if (size <= bridge_size) {
          bridge_size = size;
          bridge = i;
        }
        continue;
      }
      const bwi_curve_key *junction = one->degree == 1 ? two : one;
      double far = reach(b, junction->at), radius = junction->at[3];
      if (far <= spur_size * radius) {
        spur_size = far / radius;
        spur = i;
      }
      if (far - radius < min_size) {
        min_size = far - radius;
        min = i;
      }
    }
    bw_status status;
    if (spur >= 0)
      status = leave_out(context, curve, spur);
    else if (bridge >= 0)
      status = contract(context, curve, bridge);
    else if (max > 0 && branches > max && min >= 0)
      status = leave_out(context, curve, min);
    else
      return BW_OK;
    if (status != BW_OK)
      return status;
  }
}
