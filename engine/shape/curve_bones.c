/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* Bones along a pruned curve, after Douglas and Peucker: every branch begins as one bone, and the
 * bone that strays most is cut at the place where it does, distances counted in local radii. */
#include <math.h>
#include <string.h>

#include "shape/curve.h"
#include "shape/internal.h"

enum { SAMPLES = 2000 };               /* along the whole curve */
static const double ends_apart = 0.75; /* a bend lies so many radii from the ends of its bone */
static const double min_bend = 0.15;   /* radii: less than this is no bend, but a matter of taste */

typedef struct piece {
  int32_t branch, first, last; /* samples */
  int32_t bend;                /* the sample that strays most, or -1 */
  double strays;               /* radii */
  double length;
} piece;

typedef struct samples {
  int32_t count;
  double *at; /* count x 4 */
} samples;

static bw_status resample(bw_context *context, const bwi_branch *b, double step, samples *out) {
  double length = 0;
  for (int32_t i = 1; i < b->count; i++)
    length += bwi_gap(b->at + 4 * (size_t)(i - 1), b->at + 4 * (size_t)i);
  int32_t parts = (int32_t)fmin(ceil(length / step), SAMPLES);
  parts = parts < 2 ? 2 : parts;
  out->count = parts + 1;
  out->at = BW_NEW(context, double, 4 * (size_t)out->count);
  if (!out->at)
    return BW_MEMORY;
  double done = 0;
  int32_t i = 1;
  for (int32_t s = 0; s <= parts; s++) {
    double want = length * s / parts, part = 0;
    for (;; i++) {
      part = bwi_gap(b->at + 4 * (size_t)(i - 1), b->at + 4 * (size_t)i);
      if (done + part >= want || i == b->count - 1)
        break;
      done += part;
    }
    double t = part > 0 ? fmin(fmax((want - done) / part, 0), 1) : 0;
    for (size_t k = 0; k < 4; k++) {
      const double *from = b->at + 4 * (size_t)(i - 1) + k;
      out->at[4 * (size_t)s + k] = from[0] + t * (from[4] - from[0]);
    }
  }
  memcpy(out->at, b->at, 4 * sizeof *out->at);
  memcpy(out->at + 4 * (size_t)parts, b->at + 4 * ((size_t)b->count - 1), 4 * sizeof *out->at);
  return BW_OK;
}

static void check(const samples *along, piece *p) {
  const double *at = along[p->branch].at;
  const double *a = at + 4 * (size_t)p->first, *b = at + 4 * (size_t)p->last;
  p->bend = -1;
  p->strays = 0;
  p->length = bwi_gap(a, b);
  for (int32_t i = p->first + 1; i < p->last; i++) {
    const double *x = at + 4 * (size_t)i;
    /* not within the ball of a junction: how a limb comes out of it is no bend of the limb */
    if (bwi_gap(x, a) < ends_apart * fmax(x[3], a[3]) ||
        bwi_gap(x, b) < ends_apart * fmax(x[3], b[3]))
      continue;
    double strays = bwi_segment_distance(x, a, b) / fmax(x[3], 1e-9);
    if (strays > p->strays) {
      p->strays = strays;
      p->bend = i;
    }
  }
}

/* The sample in the middle of a piece. */
static int32_t half_way(const samples *along, const piece *p) {
  return p->last - p->first < 2 || !along[p->branch].at ? -1 : (p->first + p->last) / 2;
}

static bw_status cut_pieces(bw_context *context, const samples *along, double bend, int32_t wanted,
                            piece **list, size_t *capacity, size_t *count) {
  while (wanted <= 0 || *count < (size_t)wanted) {
    size_t max = 0, longest = 0;
    for (size_t i = 1; i < *count; i++) {
      if ((*list)[i].strays > (*list)[max].strays)
        max = i;
      if ((*list)[i].length > (*list)[longest].length)
        longest = i;
    }
    bool bends = (*list)[max].strays > (wanted > 0 ? min_bend : bend);
    if (!bends && wanted <= 0)
      return BW_OK;
    size_t of = bends ? max : longest;
    int32_t at = bends ? (*list)[of].bend : half_way(along, &(*list)[of]);
    if (at < 0)
      return BW_OK;
    if (!bw_grow(context, (void **)list, capacity, *count, 1, sizeof **list))
      return BW_MEMORY;
    piece *p = *list + of, *rest = *list + (*count)++;
    *rest = *p;
    p->last = rest->first = at;
    check(along, p);
    check(along, rest);
  }
  return BW_OK;
}

/* Joints: keys in use, then bends; joint_of[branch][sample] by lookup in a list per branch. */
static bw_status draw(bw_context *context, const bwi_curve *curve, const samples *along,
                      const piece *list, size_t count, bwi_sketch *sketch) {
  bw_status status = BW_OK;
  int32_t *of_key = BW_NEW(context, int32_t, curve->key_count), joints = 0;
  int32_t **of_sample = BW_NEW0(context, int32_t *, curve->branch_count);
  BW_TRY_MEMORY(of_key && of_sample);
  size_t max = count + 1;
  sketch->joint = BW_NEW(context, double, 4 * max);
  sketch->tip = BW_NEW0(context, uint8_t, max);
  sketch->bone = BW_NEW(context, int32_t, 2 * count);
  BW_TRY_MEMORY(sketch->joint && sketch->tip && sketch->bone);
  for (int32_t k = 0; k < curve->key_count; k++) {
    of_key[k] = -1;
    if (curve->key[k].degree == 0)
      continue;
    memcpy(sketch->joint + 4 * (size_t)joints, curve->key[k].at, 4 * sizeof(double));
    sketch->tip[joints] = curve->key[k].degree == 1 && !curve->key[k].cut;
    of_key[k] = joints++;
  }
  for (size_t i = 0; i < count; i++) {
    const piece *p = &list[i];
    const samples *s = &along[p->branch];
    int32_t *of = of_sample[p->branch];
    if (!of) {
      of = of_sample[p->branch] = BW_NEW(context, int32_t, s->count);
      BW_TRY_MEMORY(of);
      for (int32_t k = 1; k < s->count - 1; k++)
        of[k] = -1;
      of[0] = of_key[curve->branch[p->branch].end[0]];
      of[s->count - 1] = of_key[curve->branch[p->branch].end[1]];
    }
    for (int e = 0; e < 2; e++) {
      int32_t sample = e ? p->last : p->first;
      if (of[sample] < 0) {
        memcpy(sketch->joint + 4 * (size_t)joints, s->at + 4 * (size_t)sample, 4 * sizeof(double));
        of[sample] = joints++;
      }
      sketch->bone[2 * i + (size_t)e] = of[sample];
    }
  }
  sketch->joint_count = joints;
  sketch->bone_count = (int32_t)count;
done:
  if (of_sample)
    for (int32_t b = 0; b < curve->branch_count; b++)
      bw_free(of_sample[b]);
  bw_free(of_sample);
  bw_free(of_key);
  return status;
}

bw_status bwi_curve_bones(bw_context *context, const bwi_curve *curve, double bend, int32_t wanted,
                          bwi_sketch *sketch) {
  bw_status status = BW_OK;
  piece *list = NULL;
  size_t capacity = 0, count = 0;
  double step = bwi_branches_length(curve) / SAMPLES;
  samples *along = BW_NEW0(context, samples, curve->branch_count);
  memset(sketch, 0, sizeof *sketch);
  if (!along)
    return BW_MEMORY;
  for (int32_t b = 0; b < curve->branch_count; b++) {
    if (!curve->branch[b].at)
      continue;
    BW_TRY(resample(context, &curve->branch[b], step, &along[b]));
    BW_TRY_MEMORY(bw_grow(context, (void **)&list, &capacity, count, 1, sizeof *list));
    list[count] = (piece){b, 0, along[b].count - 1, -1, 0, 0};
    check(along, &list[count++]);
  }
  if (count == 0)
    goto done;
  BW_TRY(cut_pieces(context, along, bend, wanted, &list, &capacity, &count));
  BW_TRY(draw(context, curve, along, list, count, sketch));
done:
  for (int32_t b = 0; b < curve->branch_count; b++)
    bw_free(along[b].at);
  bw_free(along);
  bw_free(list);
  if (status != BW_OK)
    bwi_sketch_clear(sketch);
  return status;
}

void bwi_sketch_clear(bwi_sketch *sketch) {
  bw_free(sketch->joint);
  bw_free(sketch->tip);
  bw_free(sketch->bone);
  memset(sketch, 0, sizeof *sketch);
}
