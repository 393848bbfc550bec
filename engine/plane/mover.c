/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* Which level of mesh change an outline's move asks for (responsive, section 3.3):
 *
 *   relocate; an element inverted?  reconnect where the nodes were, relocate from there;
 *                                   nothing to reconnect, or inverted again: reconstruct
 *   an element distorted?           reconnect; still near flat: reconstruct
 *
 * What counts as distorted is bounded by what the mesh had when it was new: the corner of a needle
 * never calls for reconnecting. Nothing of the mover changes before the new mesh is whole. */
#include "plane/mover.h"

#include <math.h>
#include <string.h>

#include "plane/fill_internal.h"

struct bwi_mover {
  bwi_relocator *relocator;
  double reference; /* the worst quality that this mesh had at its best */
  double guess;     /* edge length of the last reconstruction, 0: none yet */
};

void bw_follow_options_default(bw_follow_options *options) {
  *options = (bw_follow_options){.relocation = BW_RELOCATE_HARMONIC,
                                 .sweeps = 2,
                                 .distorted = 0.35,
                                 .rebuild = 0.1,
                                 .force = BW_LEVEL_NONE};
  bw_plane_options_default(&options->fill);
  options->fill.elements = 0;
}

static void mover_destroy(void *object) {
  bw_mover *mover = object;
  bw_release(mover->mesh);
  if (mover->inner)
    bwi_relocator_free(mover->inner->relocator);
  bw_free(mover->inner);
  bw_free(mover);
}

static const bw_kind mover_kind = {"mover", mover_destroy, NULL};

bw_status bw_mover_create(bw_context *context, const bw_plane_mesh *mesh,
                          const bw_follow_options *options, bw_mover **out) {
  bw_status status = BW_OK;
  bw_mover *made = NULL;
  bw_follow_options standard;
  int32_t which = 0;
  if (!options) {
    bw_follow_options_default(&standard);
    options = &standard;
  }
  if (!(options->distorted >= 0 && options->distorted < 1) ||
      !(options->rebuild >= 0 && options->rebuild <= options->distorted))
    return bw_fail(context, BW_INVALID,
                   "distorted %g, rebuild %g: qualities with 0 <= rebuild <= distorted < 1",
                   options->distorted, options->rebuild);
  if (options->sweeps < 0 || options->sweeps > 10000)
    return bw_fail(context, BW_INVALID, "sweeps %d: from 0 to 10000", options->sweeps);
  made = BW_NEW0(context, bw_mover, 1);
  if (!made)
    return BW_MEMORY;
  bw_object_init(made, &mover_kind);
  made->mesh = bw_retain(mesh);
  made->options = *options;
  made->options.fill.order = mesh->topology->nodes->order;
  if (made->options.fill.size == 0 && !made->options.fill.field && made->options.fill.elements <= 0)
    made->options.fill.elements = mesh->topology->element_count;
  made->inner = BW_NEW0(context, struct bwi_mover, 1);
  if (!made->inner) {
    status = BW_MEMORY;
    goto done;
  }
  made->inner->reference = bwi_plane_worst(mesh->topology, mesh->point, &which);
  BW_TRY(bwi_relocator_create(context, mesh, &made->inner->relocator));
  *out = made;
  made = NULL;
done:
  bw_release(made);
  return status;
}

/* What a frame makes, until it is taken over. */
typedef struct attempt {
  bw_plane_mesh *mesh;
  bwi_relocator *relocator; /* NULL: the mover's own stays */
  double guess, reference;
  bw_follow_report report;
} attempt;

static bw_status relocate(bw_context *context, const bw_mover *mover, bwi_relocator *relocator,
                          const bw_plane_mesh *from, const bw_outline *outline, double **point) {
  *point = BW_NEW(context, double, 2 * (size_t)from->topology->nodes->node_count);
  if (!*point)
    return BW_MEMORY;
  if (mover->options.relocation == BW_RELOCATE_SPRINGS)
    return bwi_relocate_springs(context, from, outline, mover->options.sweeps, *point);
  return bwi_relocate(context, relocator, outline, *point);
}

static bw_status reconstruct(bw_context *context, const bw_mover *mover, const bw_outline *outline,
                             attempt *frame) {
  bw_status status = BW_OK;
  bw_release(frame->mesh);
  bwi_relocator_free(frame->relocator);
  frame->mesh = NULL;
  frame->relocator = NULL;
  frame->guess = mover->inner->guess;
  BW_TRY(bwi_plane_fill(context, outline, &mover->options.fill, &frame->guess, &frame->mesh));
  BW_TRY(bwi_relocator_create(context, frame->mesh, &frame->relocator));
  frame->report.level = BW_LEVEL_RECONSTRUCTION;
  frame->report.flips = 0;
  frame->report.worst = frame->reference =
      bwi_plane_worst(frame->mesh->topology, frame->mesh->point, &frame->report.worst_element);
done:
  return status;
}

/* Reconnect at these places (taken over) and make it the base of relocation from now on. */
static bw_status reconnect(bw_context *context, const bw_plane_topology *topology,
                           const bw_outline *outline, double *point, attempt *frame,
                           bool *changed) {
  bw_status status = BW_OK;
  bwi_reconnected made = {0};
  bw_plane_mesh *mesh = NULL;
  bwi_relocator *relocator = NULL;
  BW_TRY(bwi_plane_reconnect(context, topology, point, &made));
  *changed = made.flips > 0 || made.moved > 0;
  if (*changed) {
    status = bwi_plane_mesh_own(context, made.topology ? made.topology : topology, outline,
                                made.point, &mesh);
    made.point = NULL;
    BW_TRY(status);
    BW_TRY(bwi_relocator_create(context, mesh, &relocator));
    frame->report.flips += made.flips;
    bw_release(frame->mesh);
    bwi_relocator_free(frame->relocator);
    frame->mesh = mesh;
    frame->relocator = relocator;
    mesh = NULL;
  }
done:
  bw_free(point);
  bw_release(mesh);
  bwi_reconnected_clear(&made);
  return status;
}

/* Relocation inverted elements: flips where the nodes were make room for it. */
static bw_status recover(bw_context *context, const bw_mover *mover, const bw_outline *outline,
                         attempt *frame, double **point) {
  bw_status status = BW_OK;
  const bw_plane_mesh *mesh = mover->mesh;
  size_t bytes = 2 * (size_t)mesh->topology->nodes->node_count * sizeof(double);
  bool changed = false;
  bw_free(*point);
  *point = NULL;
  double *copy = bw_alloc(context, bytes, 1);
  if (!copy)
    return BW_MEMORY;
  memcpy(copy, mesh->point, bytes);
  frame->report.restored = true;
  BW_TRY(reconnect(context, mesh->topology, mesh->outline, copy, frame, &changed));
  if (!changed && bwi_relocator_base(mover->inner->relocator) == mesh)
    goto done;  /* relocation from here was what failed */
  if (!changed) /* from here rather than from where the topology was new */
    BW_TRY(bwi_relocator_create(context, mesh, &frame->relocator));
  BW_TRY(
      relocate(context, mover, frame->relocator, frame->mesh ? frame->mesh : mesh, outline, point));
done:
  return status;
}

static bw_status follow(bw_context *context, const bw_mover *mover, const bw_outline *outline,
                        attempt *frame) {
  bw_status status = BW_OK;
  const bw_follow_options *options = &mover->options;
  bw_follow_report *report = &frame->report;
  const bw_plane_topology *topology = mover->mesh->topology;
  double reference = mover->inner->reference, *point = NULL;
  bool changed = false;
  if (options->force == BW_LEVEL_RECONSTRUCTION ||
      !bwi_plane_same_shape(mover->mesh->outline, outline))
    return reconstruct(context, mover, outline, frame);
  frame->reference = reference;
  double distorted = fmin(options->distorted, 0.8 * reference);
  double rebuild = fmin(options->rebuild, 0.4 * reference);
  BW_TRY(relocate(context, mover, mover->inner->relocator, mover->mesh, outline, &point));
  report->level = BW_LEVEL_RELOCATION;
  report->worst = bwi_plane_worst(topology, point, &report->worst_element);
  if (!(report->worst > 0)) {
    BW_TRY(recover(context, mover, outline, frame, &point));
    if (frame->mesh)
      topology = frame->mesh->topology;
    if (point)
      report->worst = bwi_plane_worst(topology, point, &report->worst_element);
    if (!point || !(report->worst > 0)) {
      status = reconstruct(context, mover, outline, frame);
      goto done;
    }
    if (frame->report.flips > 0)
      report->level = BW_LEVEL_RECONNECTING;
  }
  if (report->worst < distorted || options->force == BW_LEVEL_RECONNECTING) {
    size_t count = 2 * (size_t)topology->nodes->node_count;
    double *copy = BW_NEW(context, double, count);
    if (!copy) {
      status = BW_MEMORY;
      goto done;
    }
    memcpy(copy, point, count * sizeof *copy);
    bw_retain(topology); /* the frame's own may go */
    status = reconnect(context, topology, outline, copy, frame, &changed);
    bw_release(topology);
    BW_TRY(status);
    if (changed || options->force == BW_LEVEL_RECONNECTING)
      report->level = BW_LEVEL_RECONNECTING;
    if (changed)
      report->worst =
          bwi_plane_worst(frame->mesh->topology, frame->mesh->point, &report->worst_element);
    if (report->worst < rebuild) {
      status = reconstruct(context, mover, outline, frame);
      goto done;
    }
  }
  if (!changed) {
    bw_plane_mesh *mesh = NULL;
    status = bwi_plane_mesh_own(context, topology, outline, point, &mesh);
    point = NULL;
    BW_TRY(status);
    bw_release(frame->mesh);
    frame->mesh = mesh;
  }
  frame->reference = fmax(reference, report->worst);
done:
  bw_free(point);
  return status;
}

bw_status bw_mover_follow(bw_context *context, bw_mover *mover, const bw_outline *outline,
                          bw_follow_report *report) {
  double start = bw_seconds();
  attempt frame = {.guess = mover->inner->guess, .reference = mover->inner->reference};
  const bw_outline *now = mover->mesh->outline;
  bw_status status = bw_check_cancel(context);
  if (status != BW_OK)
    return status;
  bool still = mover->options.force == BW_LEVEL_NONE &&
               (now == outline || (bwi_plane_same_shape(now, outline) &&
                                   !memcmp(now->point, outline->point,
                                           2 * (size_t)now->point_count * sizeof(double))));
  if (still) {
    frame.report.level = BW_LEVEL_NONE;
    frame.report.worst =
        bwi_plane_worst(mover->mesh->topology, mover->mesh->point, &frame.report.worst_element);
  } else {
    status = follow(context, mover, outline, &frame);
  }
  if (status == BW_OK && frame.mesh) {
    bw_release(mover->mesh);
    mover->mesh = frame.mesh;
    frame.mesh = NULL;
    if (frame.relocator) {
      bwi_relocator_free(mover->inner->relocator);
      mover->inner->relocator = frame.relocator;
      frame.relocator = NULL;
    }
    mover->inner->guess = frame.guess;
    mover->inner->reference = frame.reference;
    mover->object.revision++;
  }
  bw_release(frame.mesh);
  bwi_relocator_free(frame.relocator);
  frame.report.seconds = bw_seconds() - start;
  if (status == BW_OK && report)
    *report = frame.report;
  return status;
}

bw_status bw_mover_return(bw_context *context, bw_mover *mover, const bw_plane_mesh *mesh) {
  bw_status status = BW_OK;
  struct bwi_mover *inner = mover->inner;
  int32_t which = 0;
  if (mesh == mover->mesh)
    return BW_OK;
  if (mesh->topology->nodes->order != mover->options.fill.order)
    return bw_fail(context, BW_INVALID, "a mesh of order %d for a mover of order %d",
                   mesh->topology->nodes->order, mover->options.fill.order);
  if (mesh->topology != bwi_relocator_base(inner->relocator)->topology) {
    bwi_relocator *relocator = NULL;
    BW_TRY(bwi_relocator_create(context, mesh, &relocator));
    bwi_relocator_free(inner->relocator);
    inner->relocator = relocator;
    inner->reference = bwi_plane_worst(mesh->topology, mesh->point, &which);
  }
  bw_retain(mesh);
  bw_release(mover->mesh);
  mover->mesh = mesh;
  mover->object.revision++;
done:
  return status;
}

bw_status bw_mover_pull_back(bw_context *context, bw_mover *mover, const double *node_gradient,
                             double *point_gradient) {
  return bwi_relocate_adjoint(context, mover->inner->relocator, mover->mesh->outline, node_gradient,
                              point_gradient);
}
