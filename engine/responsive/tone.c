/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* The sound of a struck plate: a sum of decaying modes. A half-sine push of duration T gives a mode
 * of angular frequency w the impulse |cos(w T / 2) / (1 - (w T / pi)^2)| of a short one. */
#include <math.h>
#include <string.h>

#include "responsive/plate.h"

static const double PI = 3.14159265358979323846;

void bw_tone_default(bw_tone *tone) {
  *tone =
      (bw_tone){.at = {NAN, NAN}, .loss = 0.002, .contact = 0.3e-3, .seconds = 2, .rate = 44100};
}

static double softened(double omega, double contact) {
  double x = omega * contact / PI, from_one = 1 - x * x;
  return fabs(from_one) < 1e-6 ? PI / 4 : fabs(cos(PI * x / 2) / from_one);
}

/* Deflection of a mode at a place. */
static double deflection(const bw_plate *plate, int mode, int32_t element,
                         const double barycentric[3]) {
  double value[6], sum = 0;
  bw_facet_shape(2, barycentric, value);
  const bw_plane_topology *topology = plate->mesh->topology;
  const double *shape = plate->shape + mode * 3 * (int64_t)topology->nodes->node_count;
  for (int a = 0; a < 6; a++)
    sum += value[a] * shape[3 * (int64_t)topology->element[6 * (int64_t)element + a]];
  return sum;
}

static bw_status check_tone(bw_context *context, const bw_plate *plate, const bw_tone *tone) {
  if (plate->mode_count < 1)
    return bw_fail(context, BW_INVALID, "the plate has no modes: solve first");
  if (!(tone->loss > 0) || !(tone->contact >= 0) || !(tone->seconds > 0) || tone->rate < 1000)
    return bw_fail(
        context, BW_INVALID,
        "a tone has a loss factor above 0, more than 0 seconds, a contact of at least 0 s "
        "and a rate of at least 1000 samples per second, not %g, %g, %g, %d",
        tone->loss, tone->seconds, tone->contact, tone->rate);
  return BW_OK;
}

bw_status bw_plate_gains(bw_context *context, const bw_plate *plate, const bw_tone *given,
                         double *gain) {
  bw_status status = BW_OK;
  bw_tone tone;
  bw_tone_default(&tone);
  if (given)
    tone = *given;
  bw_plane_locator *locator = NULL;
  double barycentric[3], outside, loudest = 0;
  double at[2] = {tone.at[0], tone.at[1]};
  BW_TRY(check_tone(context, plate, &tone));
  if (isnan(at[0]) || isnan(at[1])) {
    int64_t max = 0;
    for (int64_t i = 1; i < plate->mesh->topology->nodes->node_count; i++)
      if (fabs(plate->shape[3 * i]) > fabs(plate->shape[3 * max]) * (1 + 1e-9))
        max = i;
    memcpy(at, plate->mesh->point + 2 * max, sizeof at);
  }
  BW_TRY(bw_plane_locator_create(context, plate->mesh, &locator));
  int32_t element = bw_plane_locate(locator, at, barycentric, &outside);
  for (int k = 0; k < plate->mode_count; k++) {
    gain[k] = deflection(plate, k, element, barycentric) *
              softened(2 * PI * plate->frequency[k], tone.contact);
    loudest = fmax(loudest, fabs(gain[k]));
  }
  for (int k = 0; k < plate->mode_count && loudest > 0; k++)
    gain[k] /= loudest;
done:
  bw_plane_locator_destroy(locator);
  return status;
}

bw_status bw_plate_tone(bw_context *context, const bw_plate *plate, const bw_tone *given,
                        double *sample) {
  bw_status status = BW_OK;
  bw_tone tone;
  double *gain = NULL, loudest = 0;
  bw_tone_default(&tone);
  if (given)
    tone = *given;
  BW_TRY(check_tone(context, plate, &tone));
  gain = BW_NEW(context, double, plate->mode_count);
  if (!gain)
    return BW_MEMORY;
  BW_TRY(bw_plate_gains(context, plate, &tone, gain));
  int64_t count = (int64_t)(tone.seconds * tone.rate);
  memset(sample, 0, (size_t)count * sizeof *sample);
  for (int k = 0; k < plate->mode_count; k++) {
    double f = plate->frequency[k], omega = 2 * PI * f, decay = PI * tone.loss * f;
    if (f >= 0.5 * tone.rate)
      continue;
    for (int64_t i = 0; i < count; i++) {
      double t = (double)i / tone.rate;
      sample[i] += gain[k] * exp(-decay * t) * sin(omega * t);
    }
  }
  for (int64_t i = 0; i < count; i++)
    loudest = fmax(loudest, fabs(sample[i]));
  for (int64_t i = 0; i < count && loudest > 0; i++)
    sample[i] *= 0.9 / loudest;
done:
  bw_free(gain);
  return status;
}
