/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* Following an edit: which subdomains have to be written, and which changed in the frames of their
 * nodes (docs/theory/edit.md).
 *
 * In frame F, where a subdomain lies by x -> A x, the entries are a function of F A alone when the
 * material is isotropic: K rotates with the body. A node's entries with another are so for both
 * their frames; hence entries are unchanged when F A is, for every frame F that occurs on the
 * subdomain's nodes. A material that is not isotropic is one more frame: its own where it rotates
 * with the subdomain, the global one where it stays. For a reshaped subdomain F (x - x_0) of its
 * nodes takes the place of F A. Where a subdomain is made of another material all its entries
 * change. */
#include "assemble/subdomain.h"
#include "base/dense.h"

#include <math.h>

/* Less than this is rounding: of a map relative to itself, of positions relative to the largest
 * coordinate. Chains of some tens of rotations give 1e-15; what this lets pass moves an entry by
 * some 1e-13 of itself. */
static const double same = 2e-14;

static const double identity[9] = {1, 0, 0, 0, 1, 0, 0, 0, 1};

/* Whether `now` is `before` but for rounding, as maps: now before^-1 = 1. */
static bool same_map(const double now[9], const double before[9]) {
  double inverse[9], ratio[9];
  if (memcmp(now, before, 9 * sizeof *now) == 0)
    return true;
  bw_inverse3(before, inverse);
  bwi_multiply(3, 3, 3, now, inverse, ratio);
  for (int k = 0; k < 9; k++)
    if (!(fabs(ratio[k] - (k % 4 == 0)) <= same))
      return false;
  return true;
}

static const double *frame_of(const bw_subdomain_motion *motion, int32_t subdomain) {
  return subdomain < 0 ? identity : motion[subdomain].frame;
}

/* Whether a reshaped subdomain's nodes lie, seen in a frame, as they lay in another. Frames NULL:
 * seen in global directions. */
static bool same_positions(const bw_mesh *mesh, const bwi_subdomain_coefficients *c,
                           int32_t subdomain, const double *now_frame, const double *before,
                           const double *before_frame) {
  int64_t first = c->node_start[subdomain], count = c->node_start[subdomain + 1] - first;
  const int32_t *node = c->node + first;
  if (count == 0)
    return true;
  const double *x0 = mesh->node + 3 * (int64_t)node[0], *y0 = before + 3 * first;
  double size = 0;
  for (int64_t k = 0; k < count; k++)
    for (int r = 0; r < 3; r++) {
      double a = fabs(mesh->node[3 * (int64_t)node[k] + r]), b = fabs(before[3 * (first + k) + r]);
      size = a > size ? a : size;
      size = b > size ? b : size;
    }
  for (int64_t k = 1; k < count; k++) {
    const double *x = mesh->node + 3 * (int64_t)node[k], *y = before + 3 * (first + k);
    double dx[3] = {x[0] - x0[0], x[1] - x0[1], x[2] - x0[2]};
    double dy[3] = {y[0] - y0[0], y[1] - y0[1], y[2] - y0[2]};
    for (int r = 0; r < 3; r++) {
      double a = now_frame ? bw_dot(now_frame + 3 * r, dx) : dx[r];
      double b = before_frame ? bw_dot(before_frame + 3 * r, dy) : dy[r];
      if (!(fabs(a - b) <= same * size))
        return false;
    }
  }
  return true;
}

/* ---- what is to be done ---- */

static bw_status check_motion(bw_context *context, int32_t subdomain,
                              const bw_subdomain_motion *motion) {
  double inverse[9], error = 0;
  for (int r = 0; r < 3; r++)
    for (int s = 0; s < 3; s++)
      error = fmax(error, fabs(bw_dot(motion->frame + 3 * r, motion->frame + 3 * s) - (r == s)));
  bool finite = true;
  for (int k = 0; k < 9; k++)
    finite =
        finite && isfinite(motion->frame[k]) && (motion->reshaped || isfinite(motion->linear[k]));
  bw_status status = BW_OK;
  if (!finite)
    status = bw_fail(context, BW_INVALID,
                     "the motion of subdomain %d has numbers that are not finite", subdomain + 1);
  else if (error > 1e-6 || bw_inverse3(motion->frame, inverse) < 0)
    status = bw_fail(context, BW_INVALID,
                     "the frame of subdomain %d is no rotation (off by %g); its rows must be "
                     "orthonormal and right-handed",
                     subdomain + 1, error);
  else if (!motion->reshaped && !(bw_inverse3(motion->linear, inverse) > 0))
    status =
        bw_fail(context, BW_INVALID,
                "the map of subdomain %d has determinant %g; it must be positive: no factor may be "
                "zero and nothing mirrored",
                subdomain + 1, bw_inverse3(motion->linear, inverse));
  if (status != BW_OK)
    bw_detail_number(context, "subdomain", subdomain + 1.0);
  return status;
}

/* Whether the global entries of a subdomain are no longer those written. */
static bool must_write(const bw_subdomain_stiffness *stiffness, const bw_mesh *mesh, int32_t d,
                       const bw_subdomain_motion *motion) {
  const bwi_subdomain_coefficients *c = stiffness->coefficients;
  const bwi_subdomain_shape *was = &c->written[d];
  if (motion->reshaped != was->reshaped)
    return true;
  if (c->orientation_matters && stiffness->rotate_material && !same_map(motion->frame, was->frame))
    return true;
  return motion->reshaped ? !same_positions(mesh, c, d, NULL, c->written_position, NULL)
                          : !same_map(motion->linear, was->linear);
}

/* Whether any entry of a subdomain changed in the frames of its nodes since the last report. */
static bool has_changed(const bw_subdomain_stiffness *stiffness, const bw_mesh *mesh, int32_t d,
                        const bw_subdomain_motion *motion) {
  const bwi_subdomain_coefficients *c = stiffness->coefficients;
  const bwi_subdomain_shape *was = &c->reported[d];
  const bw_subdomain_motion *own = &motion[d];
  if (own->reshaped != was->reshaped)
    return true;
  double rotated[9], now[9], before[9];
  if (own->reshaped) {
    if (!same_positions(mesh, c, d, own->frame, c->reported_position, was->frame))
      return true;
    /* the shape times own->frame^T was->frame: its rotation since */
    double back[9];
    for (int r = 0; r < 3; r++)
      for (int s = 0; s < 3; s++)
        back[3 * r + s] = own->frame[3 * s + r];
    bwi_multiply(3, 3, 3, back, was->frame, rotated);
  }
  for (int32_t k = c->frame_start[d]; k < c->frame_start[d + 1]; k++) {
    const double *f_now = frame_of(motion, c->frame_subdomain[k]);
    const double *f_before = c->reported_frame + 9 * (int64_t)k;
    bwi_multiply(3, 3, 3, f_now, own->reshaped ? rotated : own->linear, now);
    if (own->reshaped)
      memcpy(before, f_before, sizeof before);
    else
      bwi_multiply(3, 3, 3, f_before, was->linear, before);
    if (!same_map(now, before))
      return true;
  }
  return false;
}

static void remember(const bw_mesh *mesh, const bwi_subdomain_coefficients *c, int32_t d,
                     const bw_subdomain_motion *motion, bwi_subdomain_shape *shape,
                     double *position) {
  shape->reshaped = motion->reshaped;
  memcpy(shape->linear, motion->linear, sizeof shape->linear);
  memcpy(shape->frame, motion->frame, sizeof shape->frame);
  if (motion->reshaped)
    for (int64_t k = c->node_start[d]; k < c->node_start[d + 1]; k++)
      memcpy(position + 3 * k, mesh->node + 3 * (int64_t)c->node[k], 3 * sizeof *position);
}

bw_status bw_subdomain_stiffness_update(bw_context *context, bw_subdomain_stiffness *stiffness,
                                        const bw_mesh *mesh, const bw_material *material,
                                        const bw_subdomain_motion *motion,
                                        bw_subdomain_change *change) {
  bw_status status = BW_OK;
  bwi_subdomain_coefficients *c = stiffness->coefficients;
  int32_t subdomains = stiffness->subdomain_count;
  bwi_subdomain_work work = {0};
  bw_subdomain_change count = {0};
  bool *other = BW_NEW(context, bool, subdomains); /* made of another material */
  BW_TRY_MEMORY(other);
  BW_TRY(bw_check_cancel(context));
  BW_TRY(bwi_block_pattern_fits(context, stiffness->pattern, mesh));
  BW_TRY(bwi_subdomain_check_material(context, stiffness, material));
  for (int32_t d = 0; d < subdomains; d++)
    BW_TRY(check_motion(context, d, &motion[d]));
  BW_TRY(bwi_subdomain_work_create(context, stiffness, &work));
  for (int32_t d = 0; d < subdomains; d++) {
    other[d] = bwi_subdomain_other_material(stiffness, material, d);
    bool write = other[d] || must_write(stiffness, mesh, d, &motion[d]);
    work.action[d] = !write               ? BWI_SUBDOMAIN_KEEP
                     : motion[d].reshaped ? BWI_SUBDOMAIN_GATHER
                                          : BWI_SUBDOMAIN_EVALUATE;
    count.kept += work.action[d] == BWI_SUBDOMAIN_KEEP;
    count.gathered += work.action[d] == BWI_SUBDOMAIN_GATHER;
    count.evaluated += work.action[d] == BWI_SUBDOMAIN_EVALUATE;
  }
  BW_TRY(bwi_subdomain_work_prepare(context, mesh, &work));

  /* from here on nothing fails */
  bw_retain(material);
  bw_release(stiffness->material);
  stiffness->material = material;
  for (int32_t d = 0; d < subdomains; d++) {
    double elasticity[81];
    if (work.action[d] == BWI_SUBDOMAIN_KEEP)
      continue;
    if (other[d])
      bwi_subdomain_take_elasticity(material, d, c);
    remember(mesh, c, d, &motion[d], &c->written[d], c->written_position);
    bwi_subdomain_elasticity(stiffness, d, motion[d].frame, elasticity);
    bwi_subdomain_map(elasticity, motion[d].reshaped ? identity : motion[d].linear,
                      c->map + BWI_SUBDOMAIN_MAP * (int64_t)d);
  }
  if (count.kept < subdomains) {
    BW_TRY(bwi_subdomain_write(context, &work));
    count.blocks = work.blocks;
    stiffness->revision = ++stiffness->object.revision;
  }
  for (int32_t d = 0; d < subdomains; d++) {
    stiffness->changed[d] = other[d] || has_changed(stiffness, mesh, d, motion);
    if (!stiffness->changed[d])
      continue;
    remember(mesh, c, d, &motion[d], &c->reported[d], c->reported_position);
    for (int32_t k = c->frame_start[d]; k < c->frame_start[d + 1]; k++)
      memcpy(c->reported_frame + 9 * (int64_t)k, frame_of(motion, c->frame_subdomain[k]),
             9 * sizeof(double));
  }
  if (change)
    *change = count;
done:
  bw_free(other);
  bwi_subdomain_work_clear(&work);
  return status;
}
