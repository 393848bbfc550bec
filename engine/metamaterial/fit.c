/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* From a block to a fitted material: condense, choose axes, sample, fit constants, measure errors
 * on samples that were held out. */
#include "metamaterial/fit.h"

#include <stdlib.h>

#include "base/dense.h"
#include "metamaterial/keys.h"
#include "nonlinear/internal.h"

/* What a point has at least, of the constants of the children in series (Reuss's bound, below which
 * no composite lies); with voids, which have no such bound, of the others in series. Without it
 * cells that live by fibres alone would collapse sideways under pressure. */
#define MIN_MU 0.5
#define MIN_LAMBDA 0.25
#define MIN_BESIDE_VOID 0.1
#define SAME_STIFFNESS 1e-9 /* of children that a symmetry takes into each other */

struct bwi_fit_workspace {
  bwi_condensed condensed;
  bwi_frame18 frame;
  bwi_base base;
  bwi_axes axes;
  bwi_axes_work axes_work;
  bwi_sampler sampler;
  double stiffness[8][576];
  bwi_sample *sample;
  double *error; /* three for each held-out sample, twice */
  size_t capacity;
  const char *stage; /* NULL, or with `fraction` what is reported as progress */
  double fraction;
};

/* Samples or directions from one report of progress to the next. */
enum { BETWEEN_REPORTS = 256 };

/* Directions that errors are measured on, beside those that are fitted. */
static int held_out(const bw_library_options *options) {
  int count = options->directions / 10;
  return count < 10 ? 10 : count;
}

static bw_status reserve(bw_context *context, const bw_library_options *options,
                         bwi_fit_workspace *w) {
  if (options->directions < 1 || options->magnitudes < 1 || options->stretches < 0 ||
      !(options->strain > 0 && options->strain < 10) || !(options->ridge >= 0))
    return bw_fail(context, BW_INVALID,
                   "fitting with %d directions, %d magnitudes, %d stretches, strain %g, ridge %g: "
                   "each must be positive (stretches and ridge may be 0), and strain below 10",
                   options->directions, options->magnitudes, options->stretches, options->strain,
                   options->ridge);
  size_t count =
      ((size_t)options->directions + (size_t)held_out(options)) * (size_t)options->magnitudes;
  if (count <= w->capacity)
    return BW_OK;
  bw_free(w->sample);
  bw_free(w->error);
  w->capacity = 0;
  w->sample = BW_NEW(context, bwi_sample, count);
  w->error = BW_NEW(context, double, 4 * count);
  if (!w->sample || !w->error)
    return BW_MEMORY;
  w->capacity = count;
  return BW_OK;
}

bw_status bwi_fit_workspace_create(bw_context *context, const bw_library_options *options,
                                   bwi_fit_workspace **workspace) {
  bw_status status = BW_OK;
  bwi_fit_workspace *w = BW_NEW0(context, bwi_fit_workspace, 1);
  if (!w)
    return BW_MEMORY;
  BW_TRY(reserve(context, options, w));
  *workspace = w;
  w = NULL;
done:
  bwi_fit_workspace_destroy(w);
  return status;
}

void bwi_fit_workspace_report(bwi_fit_workspace *w, const char *stage, double fraction) {
  w->stage = stage;
  w->fraction = fraction;
}

void bwi_fit_workspace_destroy(bwi_fit_workspace *w) {
  if (!w)
    return;
  bw_free(w->sample);
  bw_free(w->error);
  bw_free(w);
}

/* ---- the block ----------------------------------------------------------------------------- */

static double mean_of(const double *values, int count) {
  double sum = 0;
  for (int i = 0; i < count; i++)
    sum += values[i];
  return sum / count;
}

/* Lame's constants of the mean over all rotations of a unit cube's elasticity in uniform strain:
 * those that it has, where it is isotropic. */
static void isotropic_mean(const double stiffness[576], double *mu, double *lambda) {
  double force[6][24], u[6][24] = {{0}}, volume = 0, all = 0;
  static const int of[6][2] = {{0, 0}, {1, 1}, {2, 2}, {1, 2}, {2, 0}, {0, 1}};
  for (int k = 0; k < 6; k++) {
    for (int c = 0; c < 8; c++) {
      u[k][3 * c + of[k][0]] += 0.5 * (c >> of[k][1] & 1);
      u[k][3 * c + of[k][1]] += 0.5 * (c >> of[k][0] & 1);
    }
    bwi_multiply(24, 24, 1, stiffness, u[k], force[k]);
  }
  for (int k = 0; k < 6; k++) /* C_iijj and C_ijij */
    for (int l = 0; l < 6; l++) {
      double value = bwi_dot(24, u[k], force[l]);
      volume += k < 3 && l < 3 ? value : 0;
      all += k != l ? 0 : k < 3 ? value : 2 * value;
    }
  *mu = (3 * all - volume) / 30;
  *lambda = fmax(0, volume / 9 - *mu * 2 / 3);
}

/* A child that was fitted counts without its fibres. */
static void bounds(const bwi_block *block, int present, bwi_base *base) {
  double mu = 0, lambda = 0, part = present < 8 ? MIN_BESIDE_VOID : 1;
  for (int c = 0; c < 8; c++) {
    const bw_solid_material *m = block->child[c];
    if (m) {
      mu += 1 / mean_of(m->mu, m->rule->count);
      lambda += 1 / mean_of(m->lambda, m->rule->count); /* where that is 0, so is the bound */
    }
  }
  for (int c = 0; c < 8; c++) {
    bool there = block->child[c] != NULL;
    base->min_mu[c] =
        there ? MIN_MU * part * present / mu : BWI_VOID_PART * base->mean_mu / present;
    base->min_lambda[c] = there ? MIN_LAMBDA * part * present / lambda : 0;
  }
}

static bw_status describe(bw_context *context, const bwi_block *block, bwi_fit_workspace *w) {
  const double *child[8];
  int present = 0;
  if (block->size[0] != 2 || block->size[1] != 2 || block->size[2] != 2)
    return bw_fail(context, BW_INVALID, "a block of %d x %d x %d cubes is to be fitted; 2 x 2 x 2",
                   (int)block->size[0], (int)block->size[1], (int)block->size[2]);
  memset(&w->base, 0, sizeof w->base);
  for (int c = 0; c < 8; c++) {
    const bw_solid_material *m = block->child[c];
    child[c] = NULL;
    if (!m)
      continue;
    bwi_material_stiffness(m, w->stiffness[c]);
    isotropic_mean(w->stiffness[c], &w->base.mu[c], &w->base.lambda[c]);
    for (int i = 0; i < 576; i++)
      w->stiffness[c][i] *= 0.5; /* of a cube of side 1/2 */
    child[c] = w->stiffness[c];
    w->base.mean_mu += w->base.mu[c];
    w->base.mean_lambda += w->base.lambda[c];
    present++;
  }
  if (present == 0 || !(w->base.mean_mu > 0 && isfinite(w->base.mean_mu)))
    return bw_fail(context, BW_EMPTY, "a block of void has no material to be fitted");
  bounds(block, present, &w->base);
  w->base.mean_mu /= present;
  w->base.mean_lambda /= present;
  if (!bwi_condense(block->size, child, &w->condensed))
    return bw_fail(context, BW_SINGULAR, "a block whose materials do not hold together");
  bwi_frame18_of(&w->condensed, &w->base, &w->frame);
  return BW_OK;
}

/* Symmetries of the cube that take the block into itself. */
static uint64_t symmetries_of(const bwi_block *block, const bwi_fit_workspace *w) {
  uint64_t all = 1;
  for (int s = 1; s < BWI_SYMMETRIES; s++) {
    bool same = true;
    for (int c = 0; c < 8 && same; c++) {
      int to = bwi_symmetry_octant(bwi_symmetry_of(s), c);
      double turned[576], size = 0, difference = 0;
      same = !block->child[c] == !block->child[to];
      if (!same || !block->child[c])
        continue;
      bwi_symmetry_stiffness(s, w->stiffness[c], turned);
      for (int i = 0; i < 576; i++) {
        size = fmax(size, fabs(turned[i]));
        difference = fmax(difference, fabs(turned[i] - w->stiffness[to][i]));
      }
      same = difference <= SAME_STIFFNESS * size;
    }
    all |= same ? (uint64_t)1 << s : 0;
  }
  return all;
}

/* ---- materials ------------------------------------------------------------------------------ */

static uint8_t law_of(const bwi_block *block, int octant) {
  return block->child[octant] ? block->child[octant]->law[0] : BWI_VOID_LAW;
}

static double density_of(const bwi_block *block) {
  double sum = 0;
  for (int c = 0; c < 8; c++)
    sum += block->child[c] ? block->child[c]->density / 8 : 0;
  return sum;
}

/* The fibres in use at a point come first. */
static bw_status make_material(bw_context *context, const bwi_block *block, const bwi_axes *axes,
                               bw_solid_material **material) {
  bw_status status = BW_OK;
  bw_rule *rule = NULL;
  uint8_t law[8];
  double mu[8], lambda[8], stiffness[8 * BWI_FIBRES] = {0}, fibre[8 * BWI_FIBRES * 3] = {0};
  int max = 0;
  const double spread[3] = {axes->spread, axes->spread, axes->spread};
  for (int pass = 0; pass < 2; pass++)
    for (int k = 0; k < BWI_OCTANTS; k++) {
      int count = 0;
      for (int f = 0; f < axes->fibres; f++)
        if (axes->constant[16 + 8 * f + k] > 0) {
          if (pass == 1) {
            stiffness[k * max + count] = axes->constant[16 + 8 * f + k];
            memcpy(fibre + 3 * (k * max + count), axes->direction[k][f], 3 * sizeof(double));
          }
          count++;
        }
      if (pass == 0)
        max = count > max ? count : max;
      else
        for (; count < max; count++)
          fibre[3 * (k * max + count)] = 1;
    }
  for (int k = 0; k < BWI_OCTANTS; k++) {
    law[k] = law_of(block, k);
    mu[k] = axes->constant[k];
    lambda[k] = axes->constant[8 + k];
  }
  BW_TRY(bw_rule_create_spread(context, 1, spread, &rule));
  BW_TRY(bw_solid_material_points(context, "fitted", rule, density_of(block), law, mu, lambda, max,
                                  stiffness, fibre, material));
done:
  bw_release(rule);
  return status;
}

bw_status bwi_fit_naive(bw_context *context, const bwi_block *block, bw_solid_material **naive) {
  bw_status status = BW_OK;
  bw_rule *rule = NULL;
  bool uniform = true;
  double mean = 0, mu[64], lambda[64], stiffness[64 * 3] = {0}, fibre[64 * 9] = {0};
  uint8_t law[64];
  int max = 0, present = 0;
  if (block->size[0] != 2 || block->size[1] != 2 || block->size[2] != 2)
    return bw_fail(context, BW_INVALID,
                   "a block of %d x %d x %d cubes is to be coarsened; 2 x 2 x 2",
                   (int)block->size[0], (int)block->size[1], (int)block->size[2]);
  for (int c = 0; c < 8; c++) {
    const bw_solid_material *m = block->child[c];
    if (!m)
      continue;
    if (m->rule->count != 8)
      return bw_fail(context, BW_INVALID, "material %s has %d points; 8", m->name,
                     (int)m->rule->count);
    uniform = uniform && m->uniform;
    max = m->fibre_count > max ? m->fibre_count : max;
    mean += mean_of(m->mu, 8);
    present++;
  }
  if (present == 0)
    return bw_fail(context, BW_EMPTY, "a block of void has no material");
  int each = uniform ? 1 : 8;
  for (int p = 0; p < 8 * each; p++) {
    const bw_solid_material *m = block->child[p / each];
    int k = p % each;
    law[p] = m ? m->law[k] : BWI_VOID_LAW;
    mu[p] = m ? m->mu[k] : BWI_VOID_PART * mean / present;
    lambda[p] = m ? m->lambda[k] : 0;
    for (int f = 0; f < max; f++) {
      bool there = m && f < m->fibre_count;
      stiffness[p * max + f] = there ? m->fibre_stiffness[k * m->fibre_count + f] : 0;
      fibre[3 * (p * max + f)] = 1;
      if (there)
        memcpy(fibre + 3 * (p * max + f), m->fibre + 3 * (k * m->fibre_count + f),
               3 * sizeof(double));
    }
  }
  BW_TRY(bw_rule_create(context, uniform ? 1 : 2, &rule));
  BW_TRY(bw_solid_material_points(context, "naive", rule, density_of(block), law, mu, lambda, max,
                                  stiffness, fibre, naive));
done:
  bw_release(rule);
  return status;
}

/* ---- errors --------------------------------------------------------------------------------- */

static int ascending(const void *a, const void *b) {
  double x = *(const double *)a, y = *(const double *)b;
  return (x > y) - (x < y);
}

/* Median and 95th percentile. */
static void spread_of(double *values, int count, double *median, double *worst) {
  *median = *worst = 0;
  if (count == 0)
    return;
  qsort(values, (size_t)count, sizeof *values, ascending);
  *median = values[count / 2];
  *worst = values[(int)(0.95 * (count - 1) + 0.5)];
}

/* Relative errors of energy and of force; an undefined energy counts as a whole. */
static void compare(const bw_solid_material *m, const bwi_frame18 *frame, const bwi_sample *sample,
                    double *of_energy, double *of_force) {
  const double spacing[3] = {1, 1, 1};
  double u[8][3] = {{0}}, force[BWI_ELEMENT_FORCES], own[BWI_SHAPES] = {0}, value[8][8];
  double difference = 0;
  bwi_hexahedron_state state;
  for (int c = 0; c < 8; c++) {
    double at[3] = {c & 1 ? 1 : -1, c & 2 ? 1 : -1, c & 4 ? 1 : -1};
    bwi_coarse_functions(at, value[c]);
    for (int f = 0; f < 8; f++)
      for (int i = 0; i < 3; i++)
        u[c][i] += value[c][f] * bwi_dot(BWI_SHAPES, sample->coordinate,
                                         frame->shape + (size_t)(3 * f + i) * BWI_SHAPES);
  }
  bwi_cell_evaluate(m, spacing, 1, (const double(*)[3])u, BWI_STRESS, false, &state, force, NULL);
  *of_energy = *of_force = 1;
  if (!state.defined || !isfinite(state.energy))
    return;
  for (int c = 0; c < 8; c++)
    for (int f = 0; f < 8; f++)
      for (int i = 0; i < 3; i++)
        for (int s = 0; s < BWI_SHAPES; s++)
          own[s] +=
              force[3 * c + i] * value[c][f] * frame->shape[(size_t)(3 * f + i) * BWI_SHAPES + s];
  for (int s = 0; s < BWI_SHAPES; s++)
    difference += (own[s] - sample->force[s]) * (own[s] - sample->force[s]);
  *of_energy = fabs(state.energy - sample->energy) / sample->energy;
  *of_force = sqrt(difference / bwi_dot(BWI_SHAPES, sample->force, sample->force));
}

/* Lets the caller cancel after some of the many samples of one fit. */
static bw_status pause_after(bw_context *context, const bwi_fit_workspace *w, int sample) {
  if (w->stage && sample % BETWEEN_REPORTS == 0)
    bw_progress(context, w->stage, w->fraction);
  return bw_check_cancel(context);
}

static bw_status measure(bw_context *context, const bw_solid_material *fitted,
                         const bw_solid_material *naive, const bwi_fit_workspace *w, int first,
                         int count, bw_fit_error *error) {
  bw_status status = BW_OK;
  double *values = w->error, other;
  for (int turn = 0; turn < 2; turn++)
    for (int i = 0; i < count; i++) {
      BW_TRY(pause_after(context, w, i));
      compare(turn ? naive : fitted, &w->frame, w->sample + first + i,
              values + 2 * turn * count + i, values + (2 * turn + 1) * count + i);
    }
  spread_of(values, count, &error->median, &error->worst);
  spread_of(values + count, count, &error->force, &other);
  spread_of(values + 2 * count, count, &error->naive_median, &error->naive_worst);
  spread_of(values + 3 * count, count, &error->naive_force, &other);
done:
  return status;
}

/* Never worse than nothing: constants that are not negative cannot follow blocks of a negative
 * Poisson's ratio. */
static void prefer(const bw_solid_material *naive, bw_solid_material **fitted,
                   bw_fit_error *error) {
  bw_release(*fitted);
  *fitted = (bw_solid_material *)bw_retain(naive);
  error->median = error->naive_median;
  error->worst = error->naive_worst;
  error->force = error->naive_force;
}

/* ---- fitting -------------------------------------------------------------------------------- */

static bw_status take_samples(bw_context *context, const bw_library_options *options,
                              int directions, bw_random *random, bwi_fit_workspace *w, int *count) {
  bw_status status = BW_OK;
  for (int d = 0; d < directions; d++) {
    BW_TRY(pause_after(context, w, d));
    *count += bwi_sample_direction(&w->sampler, &w->frame, options->strain, options->magnitudes,
                                   random, w->sample + *count);
  }
done:
  return status;
}

bw_status bwi_fit(bw_context *context, const bwi_block *block, const bw_library_options *options,
                  uint64_t seed, bwi_fit_workspace *w, bw_solid_material **out,
                  bw_fit_error *error) {
  bw_status status = BW_OK;
  bw_solid_material *fitted = NULL, *naive = NULL;
  bw_random random;
  uint8_t law[8];
  BW_TRY(reserve(context, options, w));
  BW_TRY(describe(context, block, w));
  bwi_axes_choose(&w->frame, &w->base, symmetries_of(block, w), options->stretches, options->fibres,
                  options->ridge, &w->axes_work, &w->axes);
  BW_TRY(bw_check_cancel(context));
  bwi_sampler_set(&w->sampler, block, &w->condensed, &w->frame);
  bw_random_seed(&random, seed);
  int first = 0;
  BW_TRY(take_samples(context, options, held_out(options), &random, w, &first));
  int count = first;
  BW_TRY(take_samples(context, options, options->directions, &random, w, &count));
  for (int k = 0; k < BWI_OCTANTS; k++)
    law[k] = law_of(block, k);
  bwi_fit_constants(&w->frame, &w->base, law, w->sample + first, count - first, options->ridge,
                    &w->axes_work, &w->axes);
  BW_TRY(make_material(context, block, &w->axes, &fitted));
  if (error) {
    memset(error, 0, sizeof *error);
    error->samples = count;
    BW_TRY(bwi_fit_naive(context, block, &naive));
    BW_TRY(measure(context, fitted, naive, w, 0, first, error));
    if (naive->rule->count == BWI_OCTANTS && error->median > error->naive_median &&
        error->force > error->naive_force)
      prefer(naive, &fitted, error);
  }
  *out = fitted;
  fitted = NULL;
done:
  bw_release(fitted);
  bw_release(naive);
  return status;
}
