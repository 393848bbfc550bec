/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* What acts on a solid: gathering it.
 *
 * Invariants: value[i] is 0 where constrained[i] is not set; normals of contact planes are of unit
 * length; every triangle's points exist in its embedding, which is of the case's grid or of one
 * with the same elements. */
#include "nonlinear/load_case.h"

#include <math.h>
#include <string.h>

#include "grid/internal.h"

static void destroy(void *object) {
  bw_load_case *it = (bw_load_case *)object;
  for (int32_t p = 0; p < it->patch_count; p++) {
    bw_release(it->patch[p].embedding);
    bw_free(it->patch[p].triangle);
    bw_free(it->patch[p].pressure);
  }
  for (int32_t f = 0; f < it->contact_plane_count; f++) {
    bw_release(it->contact_plane[f].embedding);
    bw_free(it->contact_plane[f].rest);
  }
  bw_free(it->patch);
  bw_free(it->contact_plane);
  bw_free(it->constrained);
  bw_free(it->value);
  bw_free(it->force);
  bw_release(it->grid);
  bw_free(it);
}

static size_t bytes(const void *object) {
  const bw_load_case *it = (const bw_load_case *)object;
  size_t sum = sizeof *it + (size_t)it->grid->node_count * 51;
  for (int32_t p = 0; p < it->patch_count; p++)
    sum += (size_t)it->patch[p].triangle_count * 20;
  return sum;
}

static const bw_kind case_kind = {"solid case", destroy, bytes};

bw_status bw_load_case_create(bw_context *context, const bw_grid *grid, bw_load_case **out) {
  bw_load_case *it = BW_NEW0(context, bw_load_case, 1);
  if (!it)
    return BW_MEMORY;
  size_t size = 3 * (size_t)grid->node_count;
  bw_object_init(it, &case_kind);
  it->grid = bw_retain(grid);
  it->constrained = BW_NEW0(context, uint8_t, size);
  it->value = BW_NEW0(context, double, size);
  it->force = BW_NEW0(context, double, size);
  if (!it->constrained || !it->value || !it->force) {
    bw_release(it);
    return BW_MEMORY;
  }
  *out = it;
  return BW_OK;
}

bw_status bwi_load_case_check_nodes(bw_context *context, const bw_grid *grid, int64_t count,
                                    const int32_t *node, const char *what) {
  if (count < 1)
    return bw_fail(context, BW_EMPTY, "%s: the list of nodes is empty: at least one node expected",
                   what);
  for (int64_t k = 0; k < count; k++)
    if (node[k] < 0 || node[k] >= grid->node_count)
      return bw_fail(context, BW_INVALID, "%s: there is no node %lld; the grid has %d", what,
                     (long long)node[k] + 1, (int)grid->node_count);
  return BW_OK;
}

bw_status bwi_load_case_check_finite(bw_context *context, const char *what,
                                     const double vector[3]) {
  if (isfinite(vector[0]) && isfinite(vector[1]) && isfinite(vector[2]))
    return BW_OK;
  return bw_fail(context, BW_INVALID, "%s is (%g, %g, %g); it must be finite", what, vector[0],
                 vector[1], vector[2]);
}

bw_status bw_load_case_fix(bw_context *context, bw_load_case *it, int64_t count,
                           const int32_t *node, const bool fixed[3], const double value[3]) {
  static const char axis[] = "xyz";
  bw_status status = BW_OK;
  static const double rest[3] = {0, 0, 0};
  value = value ? value : rest;
  BW_TRY(bwi_load_case_check_nodes(context, it->grid, count, node, "a support"));
  BW_TRY(bwi_load_case_check_finite(context, "the prescribed displacement", value));
  if (!fixed[0] && !fixed[1] && !fixed[2])
    return bw_fail(context, BW_EMPTY, "a support constrains no direction: give at least one");
  for (int64_t k = 0; k < count; k++)
    for (int c = 0; c < 3; c++) {
      int64_t i = 3 * (int64_t)node[k] + c;
      if (fixed[c] && it->constrained[i] && it->value[i] != value[c]) {
        double at[3];
        bw_grid_position(it->grid, node[k], at);
        status = bw_fail(context, BW_INVALID,
                         "node %d at (%g, %g, %g) m is moved by %g m along %c and, by an earlier "
                         "support, by %g m",
                         (int)node[k] + 1, at[0], at[1], at[2], value[c], axis[c], it->value[i]);
        bw_detail_number(context, "node", node[k] + 1);
        return status;
      }
    }
  for (int64_t k = 0; k < count; k++)
    for (int c = 0; c < 3; c++)
      if (fixed[c]) {
        it->constrained[3 * (int64_t)node[k] + c] = 1;
        it->value[3 * (int64_t)node[k] + c] = value[c];
      }
  it->object.revision++;
done:
  return status;
}

bw_status bw_load_case_gravity(bw_context *context, bw_load_case *it, const double gravity[3]) {
  bw_status status = BW_OK;
  BW_TRY(bwi_load_case_check_finite(context, "gravity", gravity));
  memcpy(it->gravity, gravity, sizeof it->gravity);
  it->object.revision++;
done:
  return status;
}

static bw_status check_embedding(bw_context *context, const bw_load_case *it,
                                 const bw_embedding *embedding) {
  if (bwi_grid_same_places(it->grid, embedding->grid))
    return BW_OK;
  return bw_fail(
      context, BW_INVALID,
      "the points are embedded in another grid (%d elements, cells of %g m) than that of "
      "the case (%d, %g m), or one at another place",
      (int)embedding->grid->element_count, embedding->grid->spacing[0],
      (int)it->grid->element_count, it->grid->spacing[0]);
}

bw_status bw_load_case_pressure(bw_context *context, bw_load_case *it,
                                const bw_embedding *embedding, int64_t triangles,
                                const int32_t *triangle, const double *pressure, bool follower) {
  bw_status status = BW_OK;
  bw_pressure_patch patch = {.triangle_count = triangles, .follower = follower};
  BW_TRY(check_embedding(context, it, embedding));
  if (triangles < 1)
    return bw_fail(context, BW_EMPTY, "a pressure without triangles: at least one expected");
  for (int64_t t = 0; t < triangles; t++) {
    for (int c = 0; c < 3; c++)
      if (triangle[3 * t + c] < 0 || triangle[3 * t + c] >= embedding->point_count)
        return bw_fail(context, BW_INVALID, "triangle %lld has point %lld; the embedding has %lld",
                       (long long)t + 1, (long long)triangle[3 * t + c] + 1,
                       (long long)embedding->point_count);
    if (!isfinite(pressure[t]))
      return bw_fail(context, BW_INVALID, "the pressure on triangle %lld is %g; it must be finite",
                     (long long)t + 1, pressure[t]);
  }
  patch.triangle = BW_NEW(context, int32_t, 3 * triangles);
  patch.pressure = BW_NEW(context, double, triangles);
  bw_pressure_patch *list =
      (bw_pressure_patch *)bw_resize(context, it->patch, (size_t)it->patch_count + 1, sizeof *list);
  if (list)
    it->patch = list;
  BW_TRY_MEMORY(list && patch.triangle && patch.pressure);
  memcpy(patch.triangle, triangle, 3 * (size_t)triangles * sizeof *triangle);
  memcpy(patch.pressure, pressure, (size_t)triangles * sizeof *pressure);
  patch.embedding = bw_retain(embedding);
  it->patch[it->patch_count++] = patch;
  it->object.revision++;
  return BW_OK;
done:
  bw_free(patch.triangle);
  bw_free(patch.pressure);
  return status;
}

bw_status bw_load_case_contact_plane(bw_context *context, bw_load_case *it, const double point[3],
                                     const double normal[3], const double move[3],
                                     const bw_embedding *embedding, const double *rest) {
  bw_status status = BW_OK;
  bw_contact_plane plane = {{0}, {0}, {0}, NULL, NULL};
  double length = bw_norm(normal);
  BW_TRY(bwi_load_case_check_finite(context, "the contact plane's point", point));
  BW_TRY(bwi_load_case_check_finite(context, "the contact plane's normal", normal));
  if (move)
    BW_TRY(bwi_load_case_check_finite(context, "the contact plane's displacement", move));
  if (!(length > 0))
    return bw_fail(context, BW_INVALID, "the contact plane's normal is of length 0");
  if (embedding)
    BW_TRY(check_embedding(context, it, embedding));
  for (int c = 0; c < 3; c++) {
    plane.point[c] = point[c];
    plane.normal[c] = normal[c] / length;
    plane.move[c] = move ? move[c] : 0;
  }
  if (embedding) {
    plane.rest = BW_NEW(context, double, 3 * embedding->point_count);
    if (!plane.rest)
      return BW_MEMORY;
    if (rest)
      memcpy(plane.rest, rest, 3 * (size_t)embedding->point_count * sizeof *rest);
    else
      bwi_embedding_rest(embedding, plane.rest);
  }
  bw_contact_plane *list = (bw_contact_plane *)bw_resize(
      context, it->contact_plane, (size_t)it->contact_plane_count + 1, sizeof *list);
  if (!list) {
    bw_free(plane.rest);
    return BW_MEMORY;
  }
  it->contact_plane = list;
  plane.embedding = bw_retain(embedding);
  it->contact_plane[it->contact_plane_count++] = plane;
  it->object.revision++;
done:
  return status;
}
