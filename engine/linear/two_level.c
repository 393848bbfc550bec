/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* The two-level preconditioner: restriction and prolongation (two_level.h). */
#include <string.h>

#include "linear/corner_rotations.h"
#include "linear/stars.h"

enum { ROWS = BWI_SMOOTHER_ROWS };

void bwi_two_level_release(bwi_two_level *l) {
  bw_free(l->u);
  bw_free(l->r);
  bw_free(l->p);
  bw_free(l->q);
  bw_free(l->ku);
  bw_free(l->z);
  bw_free(l->residual);
  bw_free(l->floats);
  bw_free(l->corner);
  l->u = l->r = l->p = l->q = l->ku = l->corner = NULL;
  l->z = l->residual = l->floats = NULL;
  l->width = 0;
}

static void two_level_destroy(void *object) {
  bwi_two_level *l = object;
  bwi_two_level_release(l);
  bw_release(l->coarse);
  bw_release(l->smoother);
  bw_release(l->dof_map);
  bw_release(l->rigid);
  bw_release(l->rotations);
  bw_release(l->stars);
  bw_free(l->child_start);
  bw_free(l->child);
  bw_free(l->parent);
  bw_free(l->constrained);
  bw_free(l);
}

static size_t two_level_bytes(const void *object) {
  const bwi_two_level *l = object;
  size_t rows = (size_t)l->smoother->count, corners = (size_t)bwi_coarse_corners(l->coarse);
  size_t fields = (l->ku ? 5 : 4) * sizeof(double) + 3 * sizeof(float);
  return sizeof *l + bw_bytes(l->coarse) + bw_bytes(l->smoother) + bw_bytes(l->rigid) +
         bw_bytes(l->rotations) + bw_bytes(l->stars) + (corners + 1) * sizeof(int64_t) +
         5 * rows * sizeof(int32_t) +
         3 * (size_t)l->width * (rows * fields + corners * sizeof(double));
}

static const bw_kind two_level_kind = {"two-level preconditioner", two_level_destroy,
                                       two_level_bytes};

/* ---- between the levels -------------------------------------------------------------------- */

static bw_status join_levels(bw_context *context, bwi_two_level *l) {
  const bwi_smoother *s = l->smoother;
  const int32_t *parent = bwi_coarse_parents(l->coarse);
  int64_t corners = bwi_coarse_corners(l->coarse);
  l->parent = BW_NEW(context, int32_t, 2 * (int64_t)s->count);
  l->child_start = BW_NEW0(context, int64_t, corners + 1);
  l->child = BW_NEW(context, int32_t, 2 * (int64_t)s->count);
  l->constrained = BW_NEW(context, int32_t, s->count);
  if (!l->parent || !l->child_start || !l->child || !l->constrained)
    return BW_MEMORY;
  for (int64_t k = 0; k < s->count; k++)
    for (int side = 0; side < 2; side++) {
      int32_t corner = parent[2 * (int64_t)s->node[k] + side];
      l->parent[2 * k + side] = corner;
      l->child_start[corner + 1]++;
    }
  for (int64_t c = 0; c < corners; c++)
    l->child_start[c + 1] += l->child_start[c];
  /* the starts run ahead while children are listed, and are put back after */
  for (int32_t k = 0; k < s->count; k++)
    for (int side = 0; side < 2; side++)
      l->child[l->child_start[l->parent[2 * (int64_t)k + side]]++] = k;
  for (int64_t c = corners; c > 0; c--)
    l->child_start[c] = l->child_start[c - 1];
  l->child_start[0] = 0;
  return BW_OK;
}

typedef struct passage {
  const bwi_two_level *l;
  int width, used;
  int64_t corners;
  double unit; /* of the corners' equations over those of the rows */
} passage;

/* Half of what each child has left; a corner is its own child twice. */
static bw_status restrict_residual(void *data, int64_t begin, int64_t end, int worker) {
  (void)worker;
  const passage *m = data;
  const bwi_two_level *l = m->l;
  for (int64_t c = begin; c < end; c++) {
    double sum[3 * BWI_SMOOTHER_SIDES] = {0};
    for (int64_t k = l->child_start[c]; k < l->child_start[c + 1]; k++) {
      const float *residual = l->residual + 3 * (int64_t)m->width * l->child[k];
      for (int i = 0; i < 3 * m->width; i++)
        sum[i] += (double)residual[i];
    }
    for (int f = 0; f < m->used; f++)
      for (int d = 0; d < 3; d++)
        l->corner[3 * (f * m->corners + c) + d] = 0.5 * m->unit * sum[d * m->width + f];
  }
  return BW_OK;
}

static bw_status prolong(void *data, int64_t begin, int64_t end, int worker) {
  (void)worker;
  const passage *m = data;
  const bwi_two_level *l = m->l;
  for (int64_t k = begin; k < end; k++)
    for (int f = 0; f < m->used; f++) {
      const double *x = l->corner + 3 * f * m->corners;
      const double *a = x + 3 * (int64_t)l->parent[2 * k],
                   *b = x + 3 * (int64_t)l->parent[2 * k + 1];
      for (int d = 0; d < 3; d++)
        l->z[(3 * k + d) * m->width + f] += (float)(0.5 * (a[d] + b[d]));
    }
  return BW_OK;
}

bw_status bwi_two_level_precondition(bw_context *context, bwi_two_level *l, int width, int used) {
  bw_status status = BW_OK;
  passage m = {l, width, used, bwi_coarse_corners(l->coarse), 1 / l->smoother->unit};
  BW_TRY(l->stars
             ? bwi_stars_forward(context, l->stars, width, l->floats, l->z, l->residual)
             : bwi_smoother_forward(context, l->smoother, width, l->floats, l->z, l->residual));
  bwi_smoother_keep(l->smoother, l->dof_map, l->constrained_count, l->constrained, width,
                    l->residual);
  if (l->rotations)
    BW_TRY(bwi_corner_rotations_correct(context, l->rotations, l, width, used));
  else {
    BW_TRY(bw_parallel(context, m.corners, ROWS, restrict_residual, &m));
    BW_TRY(bwi_coarse_solve(context, l->coarse, used, l->corner));
    BW_TRY(bw_parallel(context, l->smoother->count, ROWS, prolong, &m));
  }
  bwi_smoother_keep(l->smoother, l->dof_map, l->constrained_count, l->constrained, width, l->z);
  BW_TRY(l->stars
             ? bwi_stars_backward(context, l->stars, width, l->floats, l->z)
             : bwi_smoother_backward(context, l->smoother, width, l->floats, l->z, l->residual));
done:
  return status;
}

/* ---- life ---------------------------------------------------------------------------------- */

bw_status bwi_two_level_create(bw_context *context, const bw_mesh *mesh,
                               const bw_block_pattern *pattern, bool even,
                               const bwi_stiffness *stiffness, bwi_two_level **out) {
  bw_status status = BW_OK;
  bwi_coarse *coarse = NULL;
  BW_TRY(bwi_coarse_create(context, mesh, &coarse));
  BW_TRY(bwi_two_level_create_over(context, coarse, mesh, pattern, even, stiffness, out));
done:
  bw_release(coarse);
  return status;
}

bw_status bwi_two_level_create_over(bw_context *context, bwi_coarse *coarse, const bw_mesh *mesh,
                                    const bw_block_pattern *pattern, bool even,
                                    const bwi_stiffness *stiffness, bwi_two_level **out) {
  bw_status status = BW_OK;
  bwi_two_level *l = BW_NEW0(context, bwi_two_level, 1);
  if (!l)
    return BW_MEMORY;
  bw_object_init(l, &two_level_kind);
  l->coarse = bw_retain(coarse);
  BW_TRY(bwi_smoother_create(context, mesh, pattern, even, even, stiffness, &l->smoother));
  BW_TRY(join_levels(context, l));
done:
  if (status == BW_OK)
    *out = l;
  else
    bw_release(l);
  return status;
}

bw_status bwi_two_level_follow(bw_context *context, bwi_two_level *l, const bw_model *model,
                               const bw_dof_map *dof_map, const double *stiffness, bool *usable) {
  bw_status status = BW_OK;
  bw_retain(dof_map);
  bw_release(l->dof_map);
  l->dof_map = (bw_dof_map *)dof_map;
  l->constrained_count = 0;
  for (int32_t k = 0; k < l->smoother->count; k++) {
    const uint8_t *state = dof_map->state + 3 * (int64_t)l->smoother->node[k];
    if (state[0] == BW_DOF_PRESCRIBED || state[1] == BW_DOF_PRESCRIBED ||
        state[2] == BW_DOF_PRESCRIBED)
      l->constrained[l->constrained_count++] = k;
  }
  bw_release(l->rigid);
  bw_release(l->rotations);
  bw_release(l->stars);
  l->rigid = NULL;
  l->rotations = NULL;
  l->stars = NULL;
  l->stiffness = (bwi_stiffness){stiffness, model->mesh, model->material};
  bwi_two_level_forget(l, model);
  if (dof_map->rigid_mode_count > 0)
    BW_TRY(bwi_rigid_space_create(context, dof_map, l->smoother->row_of, &l->rigid));
  BW_TRY(bwi_coarse_follow(context, l->coarse, model, dof_map, usable));
  if (*usable)
    BW_TRY(bwi_smoother_follow(context, l->smoother, &l->stiffness, dof_map, usable));
  if (*usable)
    BW_TRY(
        bwi_smoother_follow_elements(context, l->smoother, model->mesh, model->material, usable));
  if (*usable)
    BW_TRY(bwi_two_level_take_stars(context, l, model));
done:
  return status;
}

bw_status bwi_two_level_reserve(bw_context *context, bwi_two_level *l, int width) {
  size_t numbers = 3 * (size_t)l->smoother->count * (size_t)width + BWI_SMOOTHER_SPARE;
  if (l->width >= width)
    return BW_OK;
  bwi_two_level_release(l);
  l->u = BW_NEW(context, double, numbers);
  l->r = BW_NEW(context, double, numbers);
  l->p = BW_NEW0(context, double, numbers);
  l->q = BW_NEW(context, double, numbers);
  if (width > 1)
    l->ku = BW_NEW(context, double, numbers);
  l->z = BW_NEW0(context, float, numbers);
  l->residual = BW_NEW(context, float, numbers);
  l->floats = BW_NEW(context, float, numbers);
  l->corner = BW_NEW(context, double, 3 * (size_t)bwi_coarse_corners(l->coarse) * (size_t)width);
  if (!l->u || !l->r || !l->p || !l->q || (width > 1 && !l->ku) || !l->z || !l->residual ||
      !l->floats || !l->corner) {
    bwi_two_level_release(l);
    return BW_MEMORY;
  }
  l->width = width;
  return BW_OK;
}
