/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* What solutions with the two-level preconditioner learn of a body (two_level.h): where iterations
 * are slow for a reason that rotations of corners cure, corners rotate from there on
 * (corner_rotations.h). All solutions and iterations with that preconditioner then have them; when
 * it follows another shape, they are made again before the first solution. */
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "barwright/job.h"
#include "base/cost.h"
#include "linear/corner_rotations.h"

/* Iterations between the times at which it is asked whether they are slow, by the rate since half
 * of them. Conjugate gradients lose the directions they have when M changes, so that it is not
 * asked late: rotations then cost more than they saved (docs/theory/preconditioners.md). */
enum { ITERATIONS = 8 };
/* Of the iterations that are left, those that are with rotations. Measured: 0.15 to 0.3, where the
 * smoother has blocks 0.4 to 0.7. */
#define FEWER 0.3
/* Of what they save, what making them may cost. */
#define MAKING_FRACTION 0.65
/* Of what is free, the memory that they may take. */
#define MEMORY_FRACTION 0.8
/* Moduli of a material that differ by more than this. */
#define CONTRAST 10
/* Poisson's ratio from which on linear elements are too stiff for another reason: they lock. */
#define LOCKING 0.4

/* Rotations cure linear elements that do not bend, not those that lock. Where nodes are coupled
 * strongly in one direction, or moduli differ strongly, elements do not bend in any case. */
void bwi_two_level_forget(bwi_two_level *l, const bw_model *model, const double *stiffness) {
  const bw_material *m = model->material;
  double least = INFINITY, most = 0;
  for (int k = 0; k < 3 && !m->isotropic; k++) {
    least = fmin(least, fmin(m->young[k], m->shear[k]));
    most = fmax(most, fmax(m->young[k], m->shear[k]));
  }
  l->may_rotate =
      l->smoother->columns || most > CONTRAST * least || (m->isotropic && m->poisson[0] < LOCKING);
  l->stiffness = stiffness;
  l->asked = false;
}

/* Whether rotations are predicted to save more than they cost, of `left` iterations. */
static bool rotations_pay(const bwi_two_level *l, double left, int64_t count) {
  const bw_block_pattern *pattern = l->smoother->pattern;
  double bytes = 4 * BWI_ROTATIONS_ENTRIES * bwi_coarse_entries(l->coarse);
  double coarse = bwi_coarse_pass_bytes(l->coarse);
  double rate = BWI_TWO_LEVEL_PASS / BWI_COST_BYTES_PER_SECOND;
  double one = rate * (bwi_smoother_bytes(pattern->block_count - pattern->node_count) + coarse);
  double more = rate * (2 * bytes - coarse);
  double make =
      BWI_ROTATIONS_FLOPS * bwi_coarse_flops(l->coarse) / bwi_cost_flops_per_second(32) +
      BWI_ROTATIONS_PRODUCT * bwi_coarse_corners(l->coarse) / BWI_COST_BLOCKS_FLOPS_PER_SECOND +
      4 * bytes / BWI_COST_BYTES_PER_SECOND;
  double saved = left * bwi_two_level_sides(count) * (one - FEWER * (one + more));
  return make < MAKING_FRACTION * saved && bytes < MEMORY_FRACTION * bw_available_memory();
}

static bw_status rotate(bw_context *context, bwi_two_level *l) {
  bw_progress(context, "corner rotations", 0);
  bw_status status =
      bwi_corner_rotations_create(context, l, l->dof_map->mesh, l->stiffness, &l->rotations);
  l->asked = status != BW_CANCELLED; /* then the next solution asks again */
  if (status != BW_MEMORY)
    return status;
  bw_clear_failure(context); /* the iteration does without */
  return BW_OK;
}

bw_status bwi_two_level_remember(bw_context *context, bwi_two_level *l, int64_t count) {
  bool pay = l->slow > 0 && !l->asked && l->may_rotate && rotations_pay(l, l->slow, count);
  return pay ? rotate(context, l) : BW_OK;
}

bw_status bwi_two_level_adapt(bw_context *context, void *data, int iterations, double done) {
  const bwi_two_level_watch *watch = data;
  bwi_two_level *l = watch->two_level;
  int k = iterations / ITERATIONS, half = k / 2;
  if (l->asked || !l->may_rotate || iterations % ITERATIONS != 0 || k >= BWI_TWO_LEVEL_ASKED)
    return BW_OK;
  l->done[k] = done; /* done[0] is 0 */
  double left = ITERATIONS * (k - half) * (1 - done) / fmax(done - l->done[half], 1e-3);
  if (!rotations_pay(l, left, watch->count))
    return BW_OK;
  l->slow = iterations + left;
  return rotate(context, l);
}

void bwi_two_level_say(const bwi_two_level *l, bw_solver_report *report) {
  static const char text[] = "; corners rotate in the coarse space, since iterations were slow";
  size_t length = strlen(report->reason);
  if (l->rotations && !strstr(report->reason, text))
    snprintf(report->reason + length, sizeof report->reason - length, "%s", text);
}
