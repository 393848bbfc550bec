/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* The states of a plate: each immutable once it stands. */
#include <math.h>
#include <string.h>

#include "responsive/plate.h"

static void destroy(void *object) {
  bw_plate_state *s = object;
  bw_release(s->mesh);
  bw_release(s->matrices);
  bw_free(s->frequency);
  bw_free(s->shape);
  bw_free(s->residual);
  bw_free(s);
}

static size_t bytes(const void *object) {
  const bw_plate_state *s = object;
  size_t nodes = (size_t)s->mesh->topology->nodes->node_count;
  return sizeof *s + (size_t)s->known * (3 * nodes + 2) * sizeof(double);
}

static const bw_kind kind = {"plate state", destroy, bytes};

bw_status bwi_plate_blank(bw_context *context, const bw_plane_mesh *mesh,
                          const bwi_plate_matrices *matrices, bw_plate_state **state) {
  bw_plate_state *s = BW_NEW0(context, bw_plate_state, 1);
  if (!s)
    return BW_MEMORY;
  bw_object_init(s, &kind);
  s->mesh = bw_retain(mesh);
  s->matrices = bw_retain(matrices);
  *state = s;
  return BW_OK;
}

void bwi_plate_adopt(bw_plate *plate, const bw_plate_state *state) {
  struct bwi_plate *in = plate->inner;
  const bw_plate_state *former = in->now;
  /* flipped edges move their mid-edge nodes: a former factor takes five times as long */
  if (former && former->mesh->topology != state->mesh->topology)
    in->factored = false;
  in->now = bw_retain(state);
  plate->mesh = state->mesh;
  plate->mode_count = state->mode_count;
  plate->frequency = state->frequency;
  plate->shape = state->shape;
  plate->residual = state->residual;
  plate->object.revision++;
  bw_release(former);
}

bw_status bwi_plate_commit(bw_context *context, bw_plate *plate, const bw_plate_state *next) {
  bw_status status = bw_check_cancel(context);
  if (status == BW_OK)
    bwi_plate_adopt(plate, next);
  return status;
}

const bw_plate_state *bw_plate_keep(const bw_plate *plate) {
  return bw_retain(plate->inner->now);
}

bw_status bw_plate_return(bw_context *context, bw_plate *plate, const bw_plate_state *state) {
  if (memcmp(&state->matrices->law, &plate->inner->law, sizeof plate->inner->law) != 0)
    return bw_fail(context, BW_INVALID, "the state is that of another plate");
  if (state != plate->inner->now)
    bwi_plate_adopt(plate, state);
  return BW_OK;
}

bw_status bw_plate_check(bw_context *context, const bw_plate *plate) {
  bw_status status = BW_OK;
  const bw_plate_state *now = plate->inner->now;
  const bw_plane_topology *topology = now->mesh->topology;
  int64_t numbers = 3 * (int64_t)now->known * topology->nodes->node_count;
  BW_TRY(bw_plane_mesh_check(context, now->mesh));
  if (plate->mesh != now->mesh || plate->shape != now->shape ||
      plate->frequency != now->frequency || plate->residual != now->residual ||
      plate->mode_count != now->mode_count || now->matrices->pattern->topology != topology ||
      topology->nodes->order != 2)
    status = bw_fail(context, BW_INTERNAL, "a plate has other fields than its state");
  else if (now->past < 0 || now->known < now->past + now->mode_count || (now->known && !now->shape))
    status =
        bw_fail(context, BW_INTERNAL, "a plate of %d modes keeps %d vectors, %d of them former",
                now->mode_count, now->known, now->past);
  for (int k = 0; k < now->mode_count && status == BW_OK; k++)
    if (!(now->frequency[k] >= (k ? now->frequency[k - 1] : 0)) || !isfinite(now->frequency[k]))
      status = bw_fail(context, BW_INTERNAL, "mode %d has %g Hz", k + 1, now->frequency[k]);
  for (int64_t i = 0; i < numbers && status == BW_OK; i++)
    if (!isfinite(now->shape[i]))
      status = bw_fail(context, BW_INTERNAL, "number %lld of a plate's modes is %g", (long long)i,
                       now->shape[i]);
done:
  return status;
}
