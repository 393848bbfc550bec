/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* Samples are equilibria: energy, shape and force belong together. */
#include "check.h"
#include "metamaterial/sample.h"

typedef struct kit {
  bw_solid_material *material[2];
  bwi_block block;
  bwi_condensed condensed;
  bwi_base base;
  bwi_frame18 frame;
  bwi_sampler sampler;
} kit;

static kit *kit_of(bw_context *context, bw_law law, const char *key) {
  kit *k = (kit *)calloc(1, sizeof *k);
  double own[2][576];
  const double *child[8];
  assert_non_null(k);
  k->block = (bwi_block){.size = {2, 2, 2}};
  for (int i = 0; i < 2; i++) {
    check_ok(context,
             bw_solid_material_create(context, "it", law, i ? 1e7 : 1e5, 0.4, 0, &k->material[i]));
    bwi_material_stiffness(k->material[i], own[i]);
    for (int j = 0; j < 576; j++)
      own[i][j] *= 0.5;
  }
  for (int c = 0; c < 8; c++) {
    int which = key[c] - '1';
    child[c] = which < 0 ? NULL : own[which];
    k->block.child[c] = which < 0 ? NULL : k->material[which];
  }
  k->base.mean_mu = 1e6;
  assert_true(bwi_condense(k->block.size, child, &k->condensed));
  bwi_frame18_of(&k->condensed, &k->base, &k->frame);
  bwi_sampler_set(&k->sampler, &k->block, &k->condensed, &k->frame);
  return k;
}

static void kit_free(kit *k) {
  bw_release(k->material[0]);
  bw_release(k->material[1]);
  free(k);
}

/* In the frame's coordinates the stiffness is nearly the identity, so that at small strain energy
 * is half the square of the coordinates and the force is the coordinates. */
static void small_shapes_are_linear(void **state) {
  bw_context *context = check_context(state);
  kit *k = kit_of(context, BW_NEO_HOOKEAN, "11222112");
  bw_random random;
  bwi_sample sample[1];
  bw_random_seed(&random, 1);
  for (int d = 0; d < 10; d++) {
    assert_int_equal(bwi_sample_direction(&k->sampler, &k->frame, 1e-5, 1, &random, sample), 1);
    double size = 0;
    for (int i = 0; i < BWI_SHAPES; i++)
      size += sample->coordinate[i] * sample->coordinate[i];
    for (int i = 0; i < BWI_SHAPES; i++)
      check_near(sample->force[i], sample->coordinate[i], 0.02 * sqrt(size));
    check_near(sample->energy, size / 2, 0.02 * size);
  }
  kit_free(k);
}

/* Along a direction of force, work is what is stored: E(m) = sum of f dx, by Simpson's rule over
 * many small magnitudes of a growing force. */
static void energy_is_work(void **state) {
  bw_context *context = check_context(state);
  enum { STEPS = 60 };
  static const char *const key[] = {"11112222", "21121221", "12100000"};
  for (int law = 0; law < BW_LAWS; law++)
    for (size_t b = 0; b < sizeof key / sizeof *key; b++) {
      kit *k = kit_of(context, (bw_law)law, key[b]);
      bw_random random;
      bwi_sample sample[STEPS];
      bw_random_seed(&random, 2);
      int count = bwi_sample_direction(&k->sampler, &k->frame, 0.1, STEPS, &random, sample);
      double work = 0;
      for (int m = 0; m < count; m++) /* the force is even in m: trapezia in x */
        for (int i = 0; i < BWI_SHAPES; i++)
          work += 0.5 * (sample[m].force[i] + (m ? sample[m - 1].force[i] : 0)) *
                  (sample[m].coordinate[i] - (m ? sample[m - 1].coordinate[i] : 0));
      if (count <= STEPS / 3)
        fail_msg("%s, block %s: only %d samples", bw_law_word((bw_law)law), key[b], count);
      check_near(work / sample[count - 1].energy, 1, 2e-3);
      kit_free(k);
    }
}

check_main(check_test(small_shapes_are_linear), check_test(energy_is_work))
