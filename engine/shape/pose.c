/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* Poses: forward kinematics, posed joints and nodes, their derivative by scales, and how the
 * stiffness subdomains moved.
 *
 * Bone b with parent p, rest head h, rest frame F (rows are its axes), local rotation r, scales s,
 * translation t:
 *     R_b = R_p r,   A_b = R_b F^T diag(s) F,
 *     h'_b = A_p h + b_p + R_p t,   b_b = h'_b - A_b h,
 * with R = A = identity and b = 0 for the parent of a root bone. Scales stretch a bone and carry
 * what hangs on it, but are not taken over. */
#include "barwright/shape.h"
#include "base/dense.h"

#include <math.h>
#include <string.h>

static const double identity[9] = {1, 0, 0, 0, 1, 0, 0, 0, 1};

void bw_bone_pose_rest(bw_bone_pose *pose) {
  memset(pose, 0, sizeof *pose);
  memcpy(pose->rotation, identity, sizeof identity);
  pose->scale[0] = pose->scale[1] = pose->scale[2] = 1;
}

static void transform(const double a[9], const double x[3], double y[3]) {
  for (int i = 0; i < 3; i++)
    y[i] = a[3 * i] * x[0] + a[3 * i + 1] * x[1] + a[3 * i + 2] * x[2];
}

static void apply(const double map[12], const double x[3], double y[3]) {
  for (int i = 0; i < 3; i++)
    y[i] = map[4 * i] * x[0] + map[4 * i + 1] * x[1] + map[4 * i + 2] * x[2] + map[4 * i + 3];
}

static void linear_part(const double map[12], double linear[9]) {
  for (int i = 0; i < 3; i++)
    memcpy(linear + 3 * i, map + 4 * i, 3 * sizeof(double));
}

static bw_status check_pose(bw_context *context, const bw_skeleton *skeleton, int32_t b,
                            const bw_bone_pose *pose) {
  const char *name = skeleton->bone_name[b].text;
  const double *r = pose->rotation;
  double off = 0, normal[3];
  for (int i = 0; i < 3; i++)
    for (int j = 0; j < 3; j++) {
      double entry = bw_dot(r + 3 * i, r + 3 * j) - (i == j);
      off = !(fabs(entry) <= off) ? fabs(entry) : off; /* a NaN stays */
    }
  bw_cross(r, r + 3, normal);
  if (!(off <= 1e-9) || !(bw_dot(normal, r + 6) > 0))
    return bw_fail(context, BW_INVALID,
                   "the rotation of bone \"%s\" is not one: R Rt differs from the identity by %g%s",
                   name, off, bw_dot(normal, r + 6) > 0 ? "" : ", and it is mirrored");
  for (int k = 0; k < 3; k++) {
    if (!(pose->scale[k] > 0) || !isfinite(pose->scale[k]))
      return bw_fail(context, BW_INVALID,
                     "bone \"%s\" is scaled by %g along its axis %c: scales must be positive", name,
                     pose->scale[k], "xyz"[k]);
    if (!isfinite(pose->translation[k]))
      return bw_fail(context, BW_INVALID, "bone \"%s\" is translated by %g m along %c", name,
                     pose->translation[k], "xyz"[k]);
  }
  return BW_OK;
}

/* R F^T diag(s) F, exactly R where nothing is scaled. */
static void scaled_rotation(const double rotation[9], const double frame[9], const double scale[3],
                            double out[9]) {
  double stretch[9];
  memcpy(stretch, identity, sizeof stretch);
  for (int a = 0; a < 3; a++)
    for (int i = 0; i < 3; i++)
      for (int j = 0; j < 3; j++)
        stretch[3 * i + j] += (scale[a] - 1) * frame[3 * a + i] * frame[3 * a + j];
  bwi_multiply(3, 3, 3, rotation, stretch, out);
}

bw_status bw_pose_maps(bw_context *context, const bw_skeleton *skeleton, const bw_bone_pose *pose,
                       double *map, double *rotation) {
  static const double rest_map[12] = {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0};
  int32_t bones = skeleton->bone_count;
  for (int32_t b = 0; b < bones; b++) {
    bw_status status = check_pose(context, skeleton, b, pose + b);
    if (status != BW_OK)
      return status;
  }
  bw_status status = BW_OK;
  double *frame = BW_NEW(context, double, 9 * (int64_t)bones);
  double *own_map = map ? NULL : BW_NEW(context, double, 12 * (int64_t)bones);
  double *own_rotation = rotation ? NULL : BW_NEW(context, double, 9 * (int64_t)bones);
  BW_TRY_MEMORY(frame && (map || own_map) && (rotation || own_rotation));
  double *to = map ? map : own_map, *turn = rotation ? rotation : own_rotation;
  bw_skeleton_frames(skeleton, frame);
  for (int32_t b = 0; b < bones; b++) {
    int32_t p = skeleton->parent[b];
    const double *parent_map = p < 0 ? rest_map : to + 12 * (size_t)p;
    const double *parent_turn = p < 0 ? identity : turn + 9 * (size_t)p;
    const double *head = skeleton->joint + 3 * (size_t)skeleton->bone[2 * b];
    double linear[9], parent_linear[9], moved[3], turned_head[3], shift[3];
    double *own = to + 12 * (size_t)b;
    bwi_multiply(3, 3, 3, parent_turn, pose[b].rotation, turn + 9 * (size_t)b);
    scaled_rotation(turn + 9 * (size_t)b, frame + 9 * (size_t)b, pose[b].scale, linear);
    linear_part(parent_map, parent_linear);
    apply(parent_map, head, moved);
    transform(parent_turn, pose[b].translation, shift);
    transform(linear, head, turned_head);
    /* a bone that moves as its parent does gets its map to the last bit */
    bool follows = true;
    for (int i = 0; i < 9; i++)
      follows &= linear[i] == parent_linear[i];
    for (int i = 0; i < 3; i++) {
      memcpy(own + 4 * i, linear + 3 * i, 3 * sizeof(double));
      own[4 * i + 3] = (follows ? parent_map[4 * i + 3] : moved[i] - turned_head[i]) + shift[i];
    }
  }
done:
  bw_free(frame);
  bw_free(own_map);
  bw_free(own_rotation);
  return status;
}

void bw_pose_joints(const bw_skeleton *skeleton, const double *map, double *joint) {
  for (int32_t b = skeleton->bone_count - 1; b >= 0; b--)
    for (int end = 0; end < 2; end++) {
      int32_t j = skeleton->bone[2 * b + end];
      if (end == 1 || skeleton->parent[b] < 0)
        apply(map + 12 * (size_t)b, skeleton->joint + 3 * (size_t)j, joint + 3 * (size_t)j);
    }
}

/* ---- nodes ----------------------------------------------------------------------------------- */

/* Nodes sent through one map per bone, blended: x' = M_0 x + sum w_k (M_k - M_0) x, which is M_0 x
 * to the last bit where the maps agree. Linear in the maps. */
static void blend_nodes(const bw_subdomains *d, const double *map, double *node) {
  const bw_mesh *mesh = d->mesh;
  for (int32_t i = 0; i < mesh->node_count; i++) {
    int64_t first = d->influence_start[i], end = d->influence_start[i + 1];
    if (first == end)
      continue;
    const double *base = map + 12 * (size_t)d->influence_bone[first];
    const double *x = mesh->node + 3 * (size_t)i;
    double *y = node + 3 * (size_t)i;
    apply(base, x, y);
    for (int64_t k = first + 1; k < end; k++) {
      const double *other = map + 12 * (size_t)d->influence_bone[k];
      double difference[12], part[3];
      for (int j = 0; j < 12; j++)
        difference[j] = other[j] - base[j];
      apply(difference, x, part);
      for (int j = 0; j < 3; j++)
        y[j] += d->influence_weight[k] * part[j];
    }
  }
  if (mesh->order < 2)
    return;
  for (int32_t e = 0; e < mesh->element_count; e++) {
    const int32_t *at = mesh->element + (size_t)e * 10;
    for (int k = 0; k < 6; k++)
      for (int j = 0; j < 3; j++)
        node[3 * (size_t)at[4 + k] + (size_t)j] =
            0.5 * (node[3 * (size_t)at[bw_tet_edge[k][0]] + (size_t)j] +
                   node[3 * (size_t)at[bw_tet_edge[k][1]] + (size_t)j]);
  }
}

bw_status bw_pose_nodes(bw_context *context, const bw_subdomains *subdomains, const double *map,
                        double *node) {
  bw_status status = bw_check_cancel(context);
  if (status == BW_OK)
    blend_nodes(subdomains, map, node);
  return status;
}

bw_status bw_pose_derivative(bw_context *context, const bw_subdomains *subdomains,
                             const bw_bone_pose *pose, int32_t bone, int axis, double *derivative) {
  const bw_skeleton *skeleton = subdomains->skeleton;
  int32_t bones = skeleton->bone_count;
  if (bone < 0 || bone >= bones || axis < 0 || axis > 2)
    return bw_fail(context, BW_INVALID,
                   "the derivative by the scale of bone %d along axis %d: bones 1 to %d and axes 1 "
                   "to 3 expected",
                   bone + 1, axis + 1, bones);
  bw_status status = BW_OK;
  double *frame = BW_NEW(context, double, 9 * (int64_t)bones);
  double *rotation = BW_NEW(context, double, 9 * (int64_t)bones);
  double *change = BW_NEW0(context, double, 12 * (int64_t)bones); /* of each bone's map */
  BW_TRY_MEMORY(frame && rotation && change);
  BW_TRY(bw_pose_maps(context, skeleton, pose, NULL, rotation));
  bw_skeleton_frames(skeleton, frame);
  /* the bone itself: dA = R f f^T about its head */
  const double *f = frame + 9 * (size_t)bone + 3 * axis;
  const double *head = skeleton->joint + 3 * (size_t)skeleton->bone[2 * bone];
  double turned[3];
  transform(rotation + 9 * (size_t)bone, f, turned);
  for (int i = 0; i < 3; i++) {
    for (int j = 0; j < 3; j++)
      change[12 * (size_t)bone + (size_t)(4 * i + j)] = turned[i] * f[j];
    change[12 * (size_t)bone + (size_t)(4 * i + 3)] = -turned[i] * bw_dot(f, head);
  }
  /* what hangs on it moves with its tail */
  for (int32_t b = bone + 1; b < bones; b++) {
    int32_t p = skeleton->parent[b];
    if (p < bone)
      continue;
    double moved[3];
    const double *at = skeleton->joint + 3 * (size_t)skeleton->bone[2 * b];
    apply(change + 12 * (size_t)p, at, moved);
    for (int i = 0; i < 3; i++)
      change[12 * (size_t)b + (size_t)(4 * i + 3)] = moved[i];
  }
  blend_nodes(subdomains, change, derivative);
done:
  bw_free(frame);
  bw_free(rotation);
  bw_free(change);
  return status;
}

/* ---- stiffness subdomains -------------------------------------------------------------------- */

/* The furthest that two maps send a corner of the box apart. */
static double maps_differ(const double *a, const double *b, const double low[3],
                          const double high[3]) {
  double furthest = 0;
  for (int corner = 0; corner < 8; corner++) {
    double x[3], p[3], q[3];
    for (int k = 0; k < 3; k++)
      x[k] = corner >> k & 1 ? high[k] : low[k];
    apply(a, x, p);
    apply(b, x, q);
    for (int k = 0; k < 3; k++)
      furthest = fmax(furthest, fabs(p[k] - q[k]));
  }
  return furthest;
}

bw_status bw_pose_motion(bw_context *context, const bw_subdomains *subdomains, const double *map,
                         const double *rotation, bw_subdomain_motion *motion) {
  const bw_subdomains *d = subdomains;
  bw_status status = bw_check_cancel(context);
  if (status != BW_OK)
    return status;
  double low[3], high[3], size = 0; /* largest coordinate, which sets what rounding is */
  bw_mesh_box(d->mesh, low, high);
  for (int k = 0; k < 3; k++)
    size = fmax(size, fmax(fabs(low[k]), fabs(high[k])));
  for (int32_t i = 0; i < d->stiffness.count; i++) {
    int32_t first = d->stiffness.bone_start[i], end = d->stiffness.bone_start[i + 1];
    const double *own = map + 12 * (size_t)d->stiffness.bone[first];
    const double *turn = rotation + 9 * (size_t)d->stiffness.bone[first];
    linear_part(own, motion[i].linear);
    for (int r = 0; r < 3; r++)
      for (int c = 0; c < 3; c++)
        motion[i].frame[3 * r + c] = turn[3 * c + r];
    motion[i].reshaped = false;
    for (int32_t k = first + 1; k < end; k++)
      if (!(maps_differ(own, map + 12 * (size_t)d->stiffness.bone[k], low, high) <= 1e-14 * size))
        motion[i].reshaped = true;
  }
  return BW_OK;
}
