/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* Which level of mesh change an outline's move asks for (responsive, section 3.3):
 *
 *   relocate; an element inverted?  reconnect where the nodes were, relocate from there;
 *                                   nothing to reconnect, or inverted again: reconstruct
 *   an element distorted?           reconnect; still near flat: reconstruct
 *
 * What counts as distorted is bounded by what the mesh had when it was new: the corner of a needle
 * never calls for reconnecting. Nothing of the mesh motion changes before the new mesh is whole. */
#include "plane/mesh_motion.h"

#include <math.h>
#include <string.h>

#include "plane/fill_internal.h"

/* All that a frame changes. A state is made whole and then put in the place of the one before, so
 * that a mesh motion never stands between two, and keeping one copies nothing. */
struct bw_mesh_motion_state {
  bw_object object;
  const bw_plane_mesh *mesh; /* retained */
  bwi_relocator *relocator;  /* retained: of the nodes of the mesh */
  double reference;          /* the worst quality that this mesh had at its best */
  double guess;              /* edge length of the last reconstruction, 0: none yet */
};

struct bwi_mesh_motion {
  const bw_mesh_motion_state *now;
};

static void state_destroy(void *object) {
  bw_mesh_motion_state *state = object;
  bw_release(state->mesh);
  bw_release(state->relocator);
  bw_free(state);
}

static const bw_kind state_kind = {"mesh motion state", state_destroy, NULL};

void bw_follow_options_default(bw_follow_options *options) {
  *options = (bw_follow_options){.relocation = BW_RELOCATE_HARMONIC,
                                 .rounds = 2,
                                 .distorted = 0.35,
                                 .rebuild = 0.1,
                                 .force = BW_LEVEL_NONE};
  bw_plane_options_default(&options->fill);
  options->fill.elements = 0;
}

static void mesh_motion_destroy(void *object) {
  bw_mesh_motion *motion = object;
  if (motion->inner)
    bw_release(motion->inner->now);
  bw_free(motion->inner);
  bw_free(motion);
}

static const bw_kind mesh_motion_kind = {"mesh motion", mesh_motion_destroy, NULL};

/* Cannot fail. */
static void adopt(bw_mesh_motion *motion, const bw_mesh_motion_state *state) {
  const bw_mesh_motion_state *former = motion->inner->now;
  motion->inner->now = bw_retain(state);
  motion->mesh = state->mesh;
  motion->object.revision++;
  bw_release(former);
}

bw_status bw_mesh_motion_create(bw_context *context, const bw_plane_mesh *mesh,
                                const bw_follow_options *options, bw_mesh_motion **out) {
  bw_status status = BW_OK;
  bw_mesh_motion *made = NULL;
  bw_mesh_motion_state *first = NULL;
  bw_follow_options standard;
  int32_t which = 0;
  if (!options) {
    bw_follow_options_default(&standard);
    options = &standard;
  }
  if (!(options->distorted >= 0 && options->distorted < 1) ||
      !(options->rebuild >= 0 && options->rebuild <= options->distorted))
    return bw_fail(
        context, BW_INVALID,
        "distorted %g, rebuild %g: qualities with 0 <= rebuild <= distorted < 1 expected",
        options->distorted, options->rebuild);
  if (options->rounds < 0 || options->rounds > 10000)
    return bw_fail(context, BW_INVALID, "rounds %d: from 0 to 10000 expected", options->rounds);
  made = BW_NEW0(context, bw_mesh_motion, 1);
  if (!made)
    return BW_MEMORY;
  bw_object_init(made, &mesh_motion_kind);
  made->options = *options;
  made->options.fill.order = mesh->topology->nodes->order;
  if (made->options.fill.size == 0 && !made->options.fill.field && made->options.fill.elements <= 0)
    made->options.fill.elements = mesh->topology->element_count;
  made->inner = BW_NEW0(context, struct bwi_mesh_motion, 1);
  first = BW_NEW0(context, bw_mesh_motion_state, 1);
  if (!made->inner || !first) {
    bw_free(first);
    first = NULL;
    status = BW_MEMORY;
    goto done;
  }
  bw_object_init(first, &state_kind);
  first->mesh = bw_retain(mesh);
  first->reference = bwi_plane_worst(mesh->topology, mesh->point, &which);
  BW_TRY(bwi_relocator_create(context, mesh, &first->relocator));
  adopt(made, first);
  *out = made;
  made = NULL;
done:
  bw_release(first);
  bw_release(made);
  return status;
}

/* What a frame makes, until it becomes a state. */
typedef struct attempt {
  bw_plane_mesh *mesh;
  bwi_relocator *relocator; /* NULL: that of the state before */
  double guess, reference;
  bw_follow_report report;
} attempt;

static bw_status relocate(bw_context *context, const bw_mesh_motion *motion,
                          bwi_relocator *relocator, const bw_plane_mesh *from,
                          const bw_outline *outline, double **point) {
  *point = BW_NEW(context, double, 2 * (size_t)from->topology->nodes->node_count);
  if (!*point)
    return BW_MEMORY;
  if (motion->options.relocation == BW_RELOCATE_SPRINGS)
    return bwi_relocate_springs(context, from, outline, motion->options.rounds, *point);
  return bwi_relocate(context, relocator, outline, *point);
}

static bw_status reconstruct(bw_context *context, const bw_mesh_motion *motion,
                             const bw_outline *outline, attempt *frame) {
  bw_status status = BW_OK;
  bw_release(frame->mesh);
  bw_release(frame->relocator);
  frame->mesh = NULL;
  frame->relocator = NULL;
  frame->guess = motion->inner->now->guess;
  BW_TRY(bwi_plane_fill(context, outline, &motion->options.fill, &frame->guess, &frame->mesh));
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
    status = bwi_plane_mesh_adopt(context, made.topology ? made.topology : topology, outline,
                                  made.point, &mesh);
    made.point = NULL;
    BW_TRY(status);
    BW_TRY(bwi_relocator_create(context, mesh, &relocator));
    frame->report.flips += made.flips;
    bw_release(frame->mesh);
    bw_release(frame->relocator);
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
static bw_status recover(bw_context *context, const bw_mesh_motion *motion,
                         const bw_outline *outline, attempt *frame, double **point) {
  bw_status status = BW_OK;
  const bw_plane_mesh *mesh = motion->mesh;
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
  if (!changed && bwi_relocator_base(motion->inner->now->relocator) == mesh)
    goto done;  /* relocation from here was what failed */
  if (!changed) /* from here rather than from where the topology was new */
    BW_TRY(bwi_relocator_create(context, mesh, &frame->relocator));
  BW_TRY(relocate(context, motion, frame->relocator, frame->mesh ? frame->mesh : mesh, outline,
                  point));
done:
  return status;
}

static bw_status follow(bw_context *context, const bw_mesh_motion *motion,
                        const bw_outline *outline, attempt *frame) {
  bw_status status = BW_OK;
  const bw_follow_options *options = &motion->options;
  bw_follow_report *report = &frame->report;
  const bw_plane_topology *topology = motion->mesh->topology;
  double reference = motion->inner->now->reference, *point = NULL;
  bool changed = false;
  if (options->force == BW_LEVEL_RECONSTRUCTION ||
      !bwi_plane_same_shape(motion->mesh->outline, outline))
    return reconstruct(context, motion, outline, frame);
  frame->reference = reference;
  double distorted = fmin(options->distorted, 0.8 * reference);
  double rebuild = fmin(options->rebuild, 0.4 * reference);
  BW_TRY(relocate(context, motion, motion->inner->now->relocator, motion->mesh, outline, &point));
  report->level = BW_LEVEL_RELOCATION;
  report->worst = bwi_plane_worst(topology, point, &report->worst_element);
  if (!(report->worst > 0)) {
    BW_TRY(recover(context, motion, outline, frame, &point));
    if (frame->mesh)
      topology = frame->mesh->topology;
    if (point)
      report->worst = bwi_plane_worst(topology, point, &report->worst_element);
    if (!point || !(report->worst > 0)) {
      status = reconstruct(context, motion, outline, frame);
      goto done;
    }
    if (frame->report.flips > 0)
      report->level = BW_LEVEL_RECONNECTING;
  }
  if (report->worst < distorted || options->force == BW_LEVEL_RECONNECTING) {
    size_t count = 2 * (size_t)topology->nodes->node_count;
    double *copy = BW_NEW(context, double, count);
    BW_TRY_MEMORY(copy);
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
      status = reconstruct(context, motion, outline, frame);
      goto done;
    }
  }
  if (!changed) {
    bw_plane_mesh *mesh = NULL;
    status = bwi_plane_mesh_adopt(context, topology, outline, point, &mesh);
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

/* The frame as the mesh motion's state, which takes the frame's mesh and relocator over. */
static bw_status commit(bw_context *context, bw_mesh_motion *motion, attempt *frame) {
  bw_status status = bw_check_cancel(context); /* a result would surprise who asked to stop */
  if (status != BW_OK)
    return status;
  bw_mesh_motion_state *next = BW_NEW0(context, bw_mesh_motion_state, 1);
  if (!next)
    return BW_MEMORY;
  bw_object_init(next, &state_kind);
  *next = (bw_mesh_motion_state){next->object, frame->mesh, frame->relocator, frame->reference,
                                 frame->guess};
  if (!next->relocator)
    next->relocator = bw_retain(motion->inner->now->relocator);
  frame->mesh = NULL;
  frame->relocator = NULL;
  adopt(motion, next);
  bw_release(next);
  return BW_OK;
}

bw_status bw_mesh_motion_follow(bw_context *context, bw_mesh_motion *motion,
                                const bw_outline *outline, bw_follow_report *report) {
  double start = bw_seconds();
  attempt frame = {.guess = motion->inner->now->guess, .reference = motion->inner->now->reference};
  const bw_outline *now = motion->mesh->outline;
  bw_status status = bw_check_cancel(context);
  if (status != BW_OK)
    return status;
  bool still = motion->options.force == BW_LEVEL_NONE &&
               (now == outline || (bwi_plane_same_shape(now, outline) &&
                                   !memcmp(now->point, outline->point,
                                           2 * (size_t)now->point_count * sizeof(double))));
  if (still) {
    frame.report.level = BW_LEVEL_NONE;
    frame.report.worst =
        bwi_plane_worst(motion->mesh->topology, motion->mesh->point, &frame.report.worst_element);
  } else {
    status = follow(context, motion, outline, &frame);
  }
  if (status == BW_OK && frame.mesh)
    status = commit(context, motion, &frame);
  bw_release(frame.mesh);
  bw_release(frame.relocator);
  frame.report.seconds = bw_seconds() - start;
  if (status == BW_OK && report)
    *report = frame.report;
  return status;
}

const bw_mesh_motion_state *bw_mesh_motion_keep(const bw_mesh_motion *motion) {
  return bw_retain(motion->inner->now);
}

bw_status bw_mesh_motion_return(bw_context *context, bw_mesh_motion *motion,
                                const bw_mesh_motion_state *state) {
  if (state->mesh->topology->nodes->order != motion->options.fill.order)
    return bw_fail(context, BW_INVALID, "a mesh of order %d for a mesh motion of order %d",
                   state->mesh->topology->nodes->order, motion->options.fill.order);
  if (state != motion->inner->now)
    adopt(motion, state);
  return BW_OK;
}

bw_status bw_mesh_motion_pull_back(bw_context *context, bw_mesh_motion *motion,
                                   const bw_plane_mesh *mesh, const double *node_gradient,
                                   double *point_gradient) {
  return bwi_relocate_adjoint(context, motion->inner->now->relocator, mesh, node_gradient,
                              point_gradient);
}

bw_status bw_mesh_motion_check(bw_context *context, const bw_mesh_motion *motion) {
  bw_status status = BW_OK;
  const bw_mesh_motion_state *now = motion->inner->now;
  const bw_plane_topology *topology = now->mesh->topology;
  const bw_plane_mesh *base = bwi_relocator_base(now->relocator);
  BW_TRY(bw_plane_mesh_check(context, now->mesh));
  if (motion->mesh != now->mesh || base->topology != topology ||
      base->outline->segment_count != now->mesh->outline->segment_count ||
      topology->nodes->order != motion->options.fill.order || !(now->reference > 0) ||
      !(now->guess >= 0))
    status = bw_fail(context, BW_INTERNAL,
                     "a mesh motion of %d nodes is based on a mesh of %d; reference %g, guess %g",
                     topology->nodes->node_count, base->topology->nodes->node_count, now->reference,
                     now->guess);
done:
  return status;
}
