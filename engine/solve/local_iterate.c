/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* What iterating with the factor of a former shape needs beside it: the coarse space of the present
 * shape, and the directions along which the factor is applied.
 *
 * In the frames of now a domain that turned against its neighbours would have the motion that it
 * shares with them turned too, which tears the body at its border. With a coarse space the factor
 * is therefore applied in the frames of then, all turned by one rotation, that of the largest
 * domain; what turning makes of strains is small beside, and the coarse space takes rotations of
 * elements. Where supports have frames of their own these are of now, so that what is held then is
 * held now. */
#include <string.h>

#include "solve/local.h"

bool bwi_local_has_coarse(const bw_local_system *local) {
  return bwi_coarse_fits(local->inner->rest->mesh, local->system->numbering);
}

void bwi_local_turn(const bw_local_system *local, double turn[9]) {
  const bwi_local *inner = local->inner;
  const double *now = inner->frame + 9 * (size_t)inner->largest;
  const double *then = inner->factored_frame + 9 * (size_t)inner->largest;
  for (int r = 0; r < 3; r++)
    for (int c = 0; c < 3; c++)
      turn[3 * r + c] = now[r] * then[c] + now[3 + r] * then[3 + c] + now[6 + r] * then[6 + c];
}

/* The coarse space of the present shape, or NULL. */
static bw_status bring_coarse(bw_context *context, const bw_local_system *local,
                              const bwi_coarse **coarse) {
  bw_status status = BW_OK;
  bwi_local *inner = local->inner;
  *coarse = NULL;
  if (!bwi_local_has_coarse(local) || (!inner->aided && !bwi_local_current(local)))
    return BW_OK;
  if (!inner->coarse)
    BW_TRY(bwi_coarse_create(context, inner->rest->mesh, &inner->coarse));
  if (!inner->coarse_known)
    BW_TRY(bwi_coarse_follow(context, inner->coarse, inner->model, local->system->numbering,
                             &inner->coarse_usable));
  inner->coarse_known = true;
  if (inner->coarse_usable)
    *coarse = inner->coarse;
done:
  return status;
}

bw_status bwi_local_aids(bw_context *context, const bw_local_system *local, bwi_local_aid *aid) {
  bw_status status = BW_OK;
  const bwi_local *inner = local->inner;
  const bw_numbering *now = local->system->numbering;
  BW_TRY(bring_coarse(context, local, &aid->coarse));
  aid->directions = *now;
  if (!aid->coarse || bwi_local_current(local))
    return BW_OK;
  size_t count = (size_t)now->frame_count, own = count - (size_t)inner->domain_count;
  double turn[9];
  aid->frame = BW_NEW(context, double, 9 * count);
  if (!aid->frame)
    return BW_MEMORY;
  memcpy(aid->frame, now->frame, 9 * own * sizeof *aid->frame);
  bwi_local_turn(local, turn);
  for (size_t d = 0; d < (size_t)inner->domain_count; d++)
    for (int k = 0; k < 3; k++)
      for (int c = 0; c < 3; c++)
        aid->frame[9 * (own + d) + (size_t)(3 * k + c)] =
            bw_dot(turn + 3 * c, inner->factored_frame + 9 * d + 3 * k);
  aid->directions.frame = aid->frame;
done:
  return status;
}

void bwi_local_aid_clear(bwi_local_aid *aid) {
  bw_free(aid->frame);
  aid->frame = NULL;
}
