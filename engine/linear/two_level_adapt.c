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
#include "linear/stars.h"

/* Iterations between the times at which it is asked whether they are slow, by the rate since half
 * of them. Conjugate gradients lose the directions they have when M changes, so that it is not
 * asked late: rotations then cost more than they saved (docs/theory/preconditioners.md). */
enum { ITERATIONS = 8 };
/* Of the iterations that are left, those that are with rotations. Measured: 0.15 to 0.3, where the
 * smoother has blocks 0.4 to 0.7; 0.05 to 0.24 where moduli differ a thousandfold. */
#define FEWER 0.3
#define FEWER_ALONG_FIBRES 0.2
/* Of what they save, what making them may cost. */
#define MAKING_FRACTION 0.65
/* Of what is free, the memory that they may take. */
#define MEMORY_FRACTION 0.8
/* Moduli of a material that differ by more than this, and of stiff fibres. */
#define CONTRAST 10
#define FIBRES 500
/* Bulk modulus over shear modulus from which on linear elements are too stiff for another reason:
 * they lock. That of Poisson's ratio 0.4. */
#define LOCKING_RATIO 4.67

/* The largest of the parts of the material. */
static double bulk_over_shear(const bw_material *material) {
  double most = 0;
  for (int32_t i = 0; i < bw_material_part_count(material); i++) {
    const bw_material *part = bw_material_part(material, i);
    most = fmax(most, bw_material_bulk(part) / bw_material_mean_shear(part));
  }
  return most;
}

/* Rotations cure linear elements that do not bend, not those that lock. Where nodes are coupled
 * strongly in one direction, or moduli differ strongly, elements do not bend in any case. */
void bwi_two_level_forget(bwi_two_level *l, const bw_model *model) {
  bool helps = true, fibres = true; /* in all parts of the material */
  for (int32_t i = 0; i < bw_material_part_count(model->material); i++) {
    const bw_material *m = bw_material_part(model->material, i);
    double least = INFINITY, most = 0;
    for (int k = 0; k < 3 && !m->isotropic; k++) {
      least = fmin(least, fmin(m->young[k], m->shear[k]));
      most = fmax(most, fmax(m->young[k], m->shear[k]));
    }
    helps &= l->smoother->columns || most > CONTRAST * least ||
             (m->isotropic && bulk_over_shear(m) < LOCKING_RATIO);
    fibres &= most > FIBRES * least;
  }
  l->fewer = !helps ? 0 : fibres ? FEWER_ALONG_FIBRES : FEWER;
  l->asked = false;
}

/* Seconds of the reference machine for so many bytes in an iteration: of sweeps node by node, and
 * of what is read from one end to the other, factors and stars. */
static double reading(double bytes) {
  return BWI_TWO_LEVEL_PASS / BWI_COST_BYTES_PER_SECOND * bytes;
}

static double streaming(double bytes) {
  return bytes / BWI_COST_BYTES_PER_SECOND;
}

static double count_blocks(const bwi_two_level *l) {
  return (double)(l->smoother->pattern->block_count - l->smoother->count);
}

/* What one iteration takes node by node, without rotations. */
static double one_iteration(const bwi_two_level *l) {
  return reading(bwi_smoother_bytes((int64_t)count_blocks(l)) + bwi_coarse_pass_bytes(l->coarse));
}

double bwi_two_level_seconds(const bwi_two_level *l) {
  double blocks = count_blocks(l);
  double bytes =
      l->stars ? BWI_SMOOTHER_PRODUCT_BYTES * blocks : bwi_smoother_bytes((int64_t)blocks);
  return reading(bytes + (l->rotations ? 0 : bwi_coarse_bytes(l->coarse))) +
         streaming((l->stars ? bwi_stars_read(l->stars) : 0) +
                   (l->rotations ? bwi_corner_rotations_read(l->rotations) : 0));
}

/* Bytes of rotations, and the time to make them. */
static double rotations_bytes(const bwi_two_level *l) {
  return 4 * BWI_ROTATIONS_ENTRIES * bwi_coarse_entries(l->coarse);
}

static double rotations_making(const bwi_two_level *l) {
  return BWI_ROTATIONS_FLOPS * bwi_coarse_flops(l->coarse) / bwi_cost_flops_per_second(32) +
         BWI_ROTATIONS_PRODUCT * bwi_coarse_corners(l->coarse) / BWI_COST_BLOCKS_FLOPS_PER_SECOND +
         4 * rotations_bytes(l) / BWI_COST_BYTES_PER_SECOND;
}

/* Bytes of a stiffness that is whole while they are made. */
static double whole_bytes(const bwi_two_level *l) {
  return l->stiffness.values ? 0 : 72.0 * (double)l->smoother->pattern->block_count;
}

/* Whether rotations are predicted to save more than they cost, of `left` iterations. */
static bool rotations_pay(const bwi_two_level *l, double left, int64_t count) {
  double bytes = rotations_bytes(l), one = one_iteration(l);
  double more = streaming(2 * bytes) - reading(bwi_coarse_pass_bytes(l->coarse));
  double saved = left * bwi_two_level_sides(count) * (one - l->fewer * (one + more));
  return rotations_making(l) < MAKING_FRACTION * saved &&
         bytes + whole_bytes(l) < MEMORY_FRACTION * bw_available_memory();
}

/* The whole stiffness, for what is made of it; *own is to be freed then. */
static bw_status take_stiffness(bw_context *context, const bwi_two_level *l, double **own,
                                const double **stiffness) {
  const bw_block_pattern *pattern = l->smoother->pattern;
  *own = NULL;
  *stiffness = l->stiffness.values;
  if (*stiffness)
    return BW_OK;
  *stiffness = *own = BW_NEW(context, double, 9 * pattern->block_count);
  return *own ? bw_stiffness(context, pattern, l->stiffness.mesh, l->stiffness.material, *own)
              : BW_MEMORY;
}

static bw_status rotate(bw_context *context, bwi_two_level *l) {
  double *own = NULL;
  const double *stiffness;
  bw_progress(context, "corner rotations", 0);
  bw_status status = take_stiffness(context, l, &own, &stiffness);
  if (status == BW_OK)
    status = bwi_corner_rotations_create(context, l, l->dof_map->mesh, stiffness, &l->rotations);
  bw_free(own);
  l->asked = status != BW_CANCELLED; /* then the next solution asks again */
  if (status != BW_MEMORY)
    return status;
  bw_clear_failure(context); /* the iteration does without */
  return BW_OK;
}

/* The same of stars and rotations together. The number of iterations grows with the bulk modulus
 * over the shear modulus, `ratio`: with its square root, except where elements have the mean of the
 * volumetric strain and the smoother has their motions. Fitted to cubes of 8 to 16 cells along an
 * edge (docs/theory/preconditioners.md). */
static bool stars_pay(const bwi_two_level *l, const bw_material *material) {
  double ratio = bulk_over_shear(material);
  bool projected = false;
  for (int32_t i = 0; i < bw_material_part_count(material); i++)
    projected |= bw_material_projected_bulk(bw_material_part(material, i)) > 0;
  double by_nodes = 11 * sqrt(ratio),
         by_stars = projected ? 5.5 * pow(ratio, 0.32) : 3.2 * sqrt(ratio);
  double bytes = rotations_bytes(l), blocks = count_blocks(l);
  double with =
      reading(BWI_SMOOTHER_PRODUCT_BYTES * blocks) + streaming(BWI_STARS_READ * blocks + 2 * bytes);
  double make = rotations_making(l) + BWI_STARS_FLOPS * blocks / BWI_COST_BLOCKS_FLOPS_PER_SECOND;
  return ratio > LOCKING_RATIO && make + by_stars * with < by_nodes * one_iteration(l) &&
         BWI_STARS_BYTES * blocks + bytes + whole_bytes(l) <
             MEMORY_FRACTION * bw_available_memory();
}

bw_status bwi_two_level_take_stars(bw_context *context, bwi_two_level *l, const bw_model *model) {
  bw_status status = BW_OK;
  double *own = NULL;
  const double *stiffness;
  if (!stars_pay(l, model->material))
    return BW_OK;
  bw_progress(context, "vertex stars", 0);
  status = take_stiffness(context, l, &own, &stiffness);
  if (status == BW_OK)
    status = bwi_stars_create(context, l, stiffness, &l->stars);
  bw_free(own);
  if (status == BW_OK && l->stars)
    status = rotate(context, l);
  if (status == BW_OK && l->rotations)
    return BW_OK;
  bw_release(l->stars);
  l->stars = NULL;
  if (status != BW_MEMORY)
    return status;
  bw_clear_failure(context); /* the iteration does without */
  return BW_OK;
}

bw_status bwi_two_level_remember(bw_context *context, bwi_two_level *l, int64_t count) {
  bool pay = l->slow > 0 && !l->asked && l->fewer > 0 && rotations_pay(l, l->slow, count);
  return pay ? rotate(context, l) : BW_OK;
}

bw_status bwi_two_level_adapt(bw_context *context, void *data, int iterations, double done) {
  const bwi_two_level_watch *watch = data;
  bwi_two_level *l = watch->two_level;
  int k = iterations / ITERATIONS, half = k / 2;
  if (l->asked || l->fewer == 0 || iterations % ITERATIONS != 0 || k >= BWI_TWO_LEVEL_ASKED)
    return BW_OK;
  l->done[k] = done; /* done[0] is 0 */
  double left = ITERATIONS * (k - half) * (1 - done) / fmax(done - l->done[half], 1e-3);
  if (!rotations_pay(l, left, *watch->count))
    return BW_OK;
  l->slow = iterations + left;
  return rotate(context, l);
}

void bwi_two_level_say(const bwi_two_level *l, bw_solver_report *report) {
  static const char slow[] = "; corners rotate in the coarse space, since iterations were slow";
  static const char stars[] = "; vertex stars, and corners rotate, since volume hardly changes";
  const char *text = l->stars ? stars : slow;
  size_t length = strlen(report->reason);
  if (l->rotations && !strstr(report->reason, text))
    snprintf(report->reason + length, sizeof report->reason - length, "%s", text);
}
