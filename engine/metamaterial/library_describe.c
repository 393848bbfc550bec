/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* What a library is, in a few lines: material table, options, errors by class of block. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "io/locale.h"
#include "metamaterial/library.h"

static void line(bwi_pack *text, const char *format, ...) BW_PRINTF(2, 3);

static void line(bwi_pack *text, const char *format, ...) {
  char buffer[512];
  va_list arguments;
  locale_t before = uselocale(bwi_c_locale());
  va_start(arguments, format);
  int length = vsnprintf(buffer, sizeof buffer, format, arguments);
  va_end(arguments);
  uselocale(before);
  bwi_pack_bytes(text, buffer,
                 (size_t)(length < (int)sizeof buffer ? length : (int)sizeof buffer - 1));
}

static double young_of(const bw_solid_material *m) {
  double mu = m->mu[0], lambda = m->lambda[0];
  return mu + lambda > 0 ? mu * (3 * lambda + 2 * mu) / (lambda + mu) : 0;
}

/* Classes: how many materials, with void or not, and decades between the stiffest and the
 * softest. */
typedef struct class_of {
  int materials, decades;
  bool empty;
} class_of;

static class_of classify(const bw_library *it, int count, const int32_t *key) {
  class_of found = {0, 0, false};
  double min = INFINITY, max = 0;
  for (int32_t m = 0; m < it->material_table->count; m++) {
    bool there = false;
    for (int p = 0; p < count; p++)
      there = there || key[p] == m;
    if (!there)
      continue;
    if (m == 0) {
      found.empty = true;
      continue;
    }
    found.materials++;
    min = fmin(min, it->material_table->material[m]->mu[0]);
    max = fmax(max, it->material_table->material[m]->mu[0]);
  }
  found.decades = min > 0 && max > 0 ? (int)floor(log10(max) - log10(min) + 0.5) : 0;
  return found;
}

/* The 64 fine materials that a fit of level 2 is of. */
static void key_of_level2(const bw_library *it, int32_t fit, int32_t key[64]) {
  const bwi_levels *levels = it->inner->levels;
  const bwi_keys *keys = it->inner->keys;
  int32_t cell[8];
  bwi_levels_block(levels, fit, cell);
  for (int c = 0; c < 8; c++)
    bwi_key_of(keys->base, levels->code[0][cell[c]], key + 8 * c);
}

static int by_value(const void *a, const void *b) {
  double x = *(const double *)a, y = *(const double *)b;
  return (x > y) - (x < y);
}

static double median(double *value, int32_t count) {
  qsort(value, (size_t)count, sizeof *value, by_value);
  return count % 2 ? value[count / 2] : 0.5 * (value[count / 2 - 1] + value[count / 2]);
}

static void errors_of(bwi_pack *text, const char *name, const bw_fit_error *error,
                      const int32_t *member, int32_t count, double *value) {
  double result[6];
  for (int e = 0; e < 6; e++) {
    for (int32_t i = 0; i < count; i++) {
      const bw_fit_error *x = &error[member[i]];
      const double all[6] = {x->median,      x->worst, x->naive_median,
                             x->naive_worst, x->force, x->naive_force};
      value[i] = all[e];
    }
    result[e] = 100 * median(value, count);
  }
  line(text, "  %-34s %6d  %7.3g %7.3g  %7.3g %7.3g  %7.3g %7.3g\n", name, (int)count, result[0],
       result[2], result[1], result[3], result[4], result[5]);
}

static void key_of_grown(const bwi_grown *grown, int32_t fit, int32_t key[64]) {
  for (int32_t p = 0; p < grown->width; p++)
    key[p] = grown->key[(size_t)grown->width * (size_t)fit + (size_t)p];
}

/* Fits as it was built, or those that were grown. */
static bw_status describe_level(bwi_pack *text, const bw_library *it, int level, bool grown) {
  bw_status status = BW_OK;
  int32_t count = grown ? it->grown_count[level - 1] : it->fit_count[level - 1], key[64];
  int max = 0; /* decades */
  if (count == 0)
    return BW_OK;
  double *value = BW_NEW(text->context, double, count);
  class_of *of = BW_NEW(text->context, class_of, count);
  int32_t *member = BW_NEW(text->context, int32_t, count);
  BW_TRY_MEMORY(value && of && member);
  for (int32_t f = 0; f < count; f++) {
    if (grown)
      key_of_grown(&it->inner->grown[level - 1], f, key);
    else if (level == 1)
      bwi_key_of(it->inner->keys->base, it->inner->keys->first[f], key);
    else
      key_of_level2(it, f, key);
    of[f] = classify(it, level == 1 ? 8 : 64, key);
    max = of[f].decades > max ? of[f].decades : max;
  }
  line(text, "level %d: %d fits%s; medians over fits, in %%; in each column fitted, then naive\n",
       level, (int)count, grown ? " of blocks of grids it was grown for" : "");
  line(text, "  %-34s %6s  %15s  %15s  %15s\n", "blocks of", "fits", "energy, median",
       "energy, 95 %", "force, median");
  for (int empty = 0; empty < 2; empty++)
    for (int materials = 1; materials < it->material_table->count; materials++)
      for (int decades = 0; decades <= max; decades++) {
        int32_t members = 0;
        char name[64];
        for (int32_t f = 0; f < count; f++)
          if (of[f].empty == (empty > 0) && of[f].materials == materials &&
              of[f].decades == decades)
            member[members++] = f;
        if (members == 0)
          continue;
        snprintf(name, sizeof name, "%d material%s%s, contrast 1e%d", materials,
                 materials > 1 ? "s" : "", empty ? " and void" : "", decades);
        errors_of(text, name, (grown ? it->grown_error : it->error)[level - 1], member, members,
                  value);
      }
done:
  bw_free(value);
  bw_free(of);
  bw_free(member);
  return status;
}

static void describe_stages(bwi_pack *text, const bwi_levels *levels) {
  static const char *const name[] = {"cells", "pairs along x", "pairs along y", "pairs along z"};
  line(text,
       "level 2 by representatives; factor on energies between what is and what stands for it\n");
  for (int s = 0; s < BWI_STAGES; s++)
    line(text, "  %-14s %6d representatives of %5d chosen; typical %.3g, largest %.3g\n", name[s],
         (int)levels->count[s] - 1, (int)levels->chosen_count[s], exp((double)levels->typical[s]),
         exp((double)levels->max[s]));
}

bw_status bw_library_describe(bw_context *context, const bw_library *it, char **out) {
  bw_status status = BW_OK;
  const bw_library_options *o = &it->options;
  bwi_pack text;
  bwi_pack_begin(&text, context);
  line(&text, "library of %d material%s, %d level%s, blocks with%s void\n",
       (int)it->material_table->count - 1, it->material_table->count > 2 ? "s" : "", it->levels,
       it->levels > 1 ? "s" : "", o->voids ? "" : "out");
  for (int32_t i = 1; i < it->material_table->count; i++) {
    const bw_solid_material *m = it->material_table->material[i];
    line(&text, "  %d %s: %s, mu = %.4g Pa, lambda = %.4g Pa, E = %.4g Pa, %.4g kg/m3\n", (int)i,
         m->name, bw_law_word((bw_law)m->law[0]), m->mu[0], m->lambda[0], young_of(m), m->density);
  }
  line(&text,
       "directions %d, magnitudes %d, stretches %d, fibres %d, strain %g, ridge %g, seed %llu\n",
       o->directions, o->magnitudes, o->stretches, o->fibres, o->strain, o->ridge,
       (unsigned long long)o->seed);
  if (it->seconds > 0)
    line(&text, "%s in %.4g s; ", it->inner->of ? "grown" : "built", it->seconds);
  line(&text, "%.3g MB in memory\n", 1e-6 * (double)bw_bytes(it));
  for (int level = 1; level <= it->levels; level++)
    for (int grown = 0; grown < 2; grown++)
      BW_TRY(describe_level(&text, it, level, grown == 1));
  if (it->inner->levels)
    describe_stages(&text, it->inner->levels);
  bwi_pack_u8(&text, 0);
  BW_TRY(text.status);
  *out = (char *)text.bytes;
  text.bytes = NULL;
done:
  bwi_pack_clear(&text);
  return status;
}
