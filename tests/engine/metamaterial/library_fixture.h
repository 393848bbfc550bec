/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* Libraries for tests, with made-up fits: as symmetric as their blocks, quick to make. */
#ifndef LIBRARY_FIXTURE_H
#define LIBRARY_FIXTURE_H

#include "check.h"

#include "metamaterial/library.h"

static inline bw_material_table *fixture_material_table(bw_context *context, int count) {
  static const double young[] = {1e5, 1e6, 1e7, 2e6}, density[] = {1000, 1200, 900, 1100};
  static const char *const name[] = {"soft", "middle", "stiff", "other"};
  bw_solid_material *material[4] = {NULL};
  bw_material_table *material_table;
  for (int i = 0; i < count; i++)
    check_ok(context,
             bw_solid_material_create(context, name[i], i == 3 ? BW_COROTATED : BW_NEO_HOOKEAN,
                                      young[i], 0.45, density[i], &material[i]));
  check_ok(context,
           bw_material_table_create(context, count + 1, (const bw_solid_material *const *)material,
                                    &material_table));
  for (int i = 0; i < count; i++)
    bw_release(material[i]);
  return material_table;
}

/* A material for a block: its children's constants by a factor that depends on how mixed it is, and
 * three fibres along the axes. */
static inline bw_solid_material *fixture_fit(bw_context *context,
                                             const bw_solid_material *const child[8]) {
  uint8_t law[8];
  double mu[8], lambda[8], stiffness[24], fibre[72] = {0}, sum_mu = 0, sum_lambda = 0;
  double density = 0, factor = 1;
  int there = 0;
  for (int c = 0; c < 8; c++)
    for (int d = 0; d < c; d++)
      factor -= (child[c] == NULL) != (child[d] == NULL) ? 0.01 : 0;
  for (int c = 0; c < 8; c++) {
    const bw_solid_material *m = child[c];
    law[c] = m ? m->law[0] : BWI_VOID_LAW;
    mu[c] = lambda[c] = 0;
    for (int p = 0; m && p < 8; p++) {
      mu[c] += factor * m->mu[p] / 8;
      lambda[c] += factor * m->lambda[p] / 8;
    }
    density += m ? m->density / 8 : 0;
    sum_mu += mu[c];
    sum_lambda += lambda[c];
    there += m != NULL;
  }
  for (int c = 0; c < 8; c++) {
    if (!child[c]) {
      mu[c] = BWI_VOID_PART * sum_mu / there;
      lambda[c] = BWI_VOID_PART * sum_lambda / there;
    }
    for (int f = 0; f < 3; f++) {
      stiffness[3 * c + f] = child[c] ? 0.1 * mu[c] : 0;
      fibre[3 * (3 * c + f) + f] = 1;
    }
  }
  const double spread[3] = {0.9, 0.9, 0.9};
  bw_rule *rule;
  bw_solid_material *fit;
  check_ok(context, bw_rule_create_spread(context, 1, spread, &rule));
  check_ok(context, bw_solid_material_points(context, "made up", rule, density, law, mu, lambda, 3,
                                             stiffness, fibre, &fit));
  bw_release(rule);
  return fit;
}

static inline void fixture_keep(bw_context *context, bw_library *library, int level, int32_t f,
                                bw_solid_material *fit) {
  bwi_pack packed;
  bw_fit_error error = {0.01 + 1e-5 * f, 0.05, 0.5, 1, 0.02, 0.3, 10};
  bwi_pack_begin(&packed, context);
  bwi_pack_fit(&packed, fit, &error);
  bwi_unpack from = {context, "fixture", "fit", packed.bytes, packed.bytes + packed.count, false};
  check_ok(context, bwi_unpack_fit(&from, level, f, &library->inner->fit[level - 1][f],
                                   &library->inner->error[level - 1][f]));
  bwi_pack_clear(&packed);
  bw_release(fit);
}

static inline bw_library *fixture_library(bw_context *context, int materials, bool voids,
                                          int levels, int representatives) {
  bw_material_table *material_table = fixture_material_table(context, materials);
  bw_library_options options;
  bw_library *library;
  bw_library_options_default(&options);
  options.levels = levels;
  options.voids = voids;
  options.representatives = representatives;
  check_ok(context, bwi_library_begin(context, material_table, &options, &library));
  for (int32_t f = 0; f < library->fit_count[0]; f++) {
    int32_t key[8];
    const bw_solid_material *child[8];
    bwi_key_of(material_table->count, library->inner->keys->first[f], key);
    for (int c = 0; c < 8; c++)
      child[c] = material_table->material[key[c]];
    fixture_keep(context, library, 1, f, fixture_fit(context, child));
  }
  if (levels == 2) {
    check_ok(context, bwi_levels_create(context, library->inner->keys, library->inner->fit[0],
                                        representatives, &library->inner->levels));
    check_ok(context,
             bwi_library_reserve(context, library, 2, library->inner->levels->chosen_count[3]));
    for (int32_t f = 0; f < library->fit_count[1]; f++) {
      bw_solid_material *child[8];
      check_ok(context, bwi_level2_block(context, library, f, child));
      fixture_keep(context, library, 2, f,
                   fixture_fit(context, (const bw_solid_material *const *)child));
      for (int c = 0; c < 8; c++)
        bw_release(child[c]);
    }
  }
  bw_release(material_table);
  return library;
}

static inline void fixture_same_fits(int32_t count, bw_solid_material *const *a,
                                     bw_solid_material *const *b, const bw_fit_error *a_error,
                                     const bw_fit_error *b_error) {
  for (int32_t f = 0; f < count; f++) {
    const bw_solid_material *m = a[f], *n = b[f];
    size_t points = (size_t)m->rule->count, fibres = points * (size_t)m->fibre_count;
    assert_int_equal(m->fibre_count, n->fibre_count);
    assert_memory_equal(m->rule->spread, n->rule->spread, sizeof m->rule->spread);
    assert_memory_equal(m->law, n->law, points);
    assert_memory_equal(m->mu, n->mu, points * sizeof(double));
    assert_memory_equal(m->lambda, n->lambda, points * sizeof(double));
    assert_memory_equal(m->fibre_stiffness, n->fibre_stiffness, fibres * sizeof(double));
    assert_memory_equal(m->fibre, n->fibre, 3 * fibres * sizeof(double));
    const bw_fit_error *x = &a_error[f], *y = &b_error[f];
    assert_true(x->median == y->median && x->worst == y->worst && x->force == y->force &&
                x->naive_median == y->naive_median && x->naive_worst == y->naive_worst &&
                x->naive_force == y->naive_force && x->samples == y->samples);
  }
}

static inline void fixture_same(const bw_library *a, const bw_library *b) {
  assert_int_equal(a->material_table->count, b->material_table->count);
  assert_int_equal(a->levels, b->levels);
  for (int l = 0; l < 2; l++) {
    const bwi_grown *g = &a->inner->grown[l], *h = &b->inner->grown[l];
    assert_int_equal(a->fit_count[l], b->fit_count[l]);
    fixture_same_fits(a->fit_count[l], a->inner->fit[l], b->inner->fit[l], a->error[l],
                      b->error[l]);
    for (int32_t f = 0; f < a->fit_count[l]; f++)
      assert_string_equal(a->inner->fit[l][f]->name, b->inner->fit[l][f]->name);
    assert_int_equal(a->grown_count[l], b->grown_count[l]);
    assert_int_equal(g->count, h->count);
    if (g->count > 0)
      assert_memory_equal(g->key, h->key, (size_t)g->width * (size_t)g->count);
    fixture_same_fits(g->count, g->fit, h->fit, g->error, h->error);
  }
  const bwi_levels *p = a->inner->levels, *q = b->inner->levels;
  assert_int_equal(p == NULL, q == NULL);
  for (int s = 0; p && s < 3; s++) {
    size_t pairs = (size_t)p->count[s] * (size_t)p->count[s];
    assert_int_equal(p->count[s], q->count[s]);
    assert_memory_equal(p->table[s], q->table[s], pairs * sizeof *p->table[s]);
  }
}

#endif
