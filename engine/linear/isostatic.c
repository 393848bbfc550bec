/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* Rigid-body motions by what they are at isostatic constraints (isostatic.h). */
#include "linear/isostatic.h"

#include <string.h>

#include "linear/blas.h"
#include "model/internal.h"

typedef struct constraint {
  int32_t node;
  double direction[3];
} constraint;

/* What the modes of a body are at its constraints, inverted. */
typedef struct body {
  int first, count; /* of modes, and of constraints */
  double inverse[36];
} body;

struct bwi_isostatic {
  bw_object object;
  const bw_dof_map *dof_map; /* retained */
  int32_t body_count;
  body *body;             /* those with modes */
  constraint *constraint; /* rigid_mode_count, body by body */
};

static void isostatic_destroy(void *object) {
  bwi_isostatic *s = object;
  bw_release(s->dof_map);
  bw_free(s->body);
  bw_free(s->constraint);
  bw_free(s);
}

static size_t isostatic_bytes(const void *object) {
  const bwi_isostatic *s = object;
  return sizeof *s + (size_t)s->body_count * sizeof(body) +
         (size_t)s->dof_map->rigid_mode_count * sizeof(constraint);
}

static const bw_kind isostatic_kind = {"isostatic constraints", isostatic_destroy, isostatic_bytes};

/* Of a matrix by rows, which is lost: A^T by columns, and A^-T comes by columns, A^-1 by rows. */
static bool invert(int n, double *a, double *inverse) {
  int pivot[6], info;
  memset(inverse, 0, 36 * sizeof *inverse);
  for (int i = 0; i < n; i++)
    inverse[i * n + i] = 1;
  bwi_blas_enter();
  dgesv_(&n, &n, a, &n, pivot, inverse, &n, &info);
  bwi_blas_leave();
  return info == 0;
}

/* The constraints of a body with modes; false where they are not as many, or do not tell the modes
 * apart. */
static bool take_body(bwi_isostatic *s, int32_t component) {
  const bw_dof_map *d = s->dof_map;
  int first = d->rigid_mode_start[component], modes = d->rigid_mode_start[component + 1] - first;
  body *b = &s->body[s->body_count++];
  double at[36];
  int found = 0;
  *b = (body){.first = first, .count = modes};
  for (int32_t j = d->body_start[component]; j < d->body_start[component + 1]; j++) {
    int64_t i = d->body_node[j];
    for (int k = 0; k < 3; k++) {
      if (d->state[3 * i + k] != BW_DOF_ISOSTATIC)
        continue;
      if (found == modes)
        return false;
      constraint *c = &s->constraint[first + found];
      c->node = (int32_t)i;
      bwi_direction_of(d, c->node, k, c->direction);
      for (int m = 0; m < modes; m++) {
        double u[3];
        bwi_motion_at(&d->rigid_mode[first + m], d->mesh->node + 3 * i, u);
        at[found * modes + m] = bw_dot(c->direction, u);
      }
      found++;
    }
  }
  return found == modes && invert(modes, at, b->inverse);
}

bw_status bwi_isostatic_create(bw_context *context, const bw_dof_map *dof_map,
                               bwi_isostatic **out) {
  bw_status status = BW_OK;
  bwi_isostatic *s = BW_NEW0(context, bwi_isostatic, 1);
  if (!s)
    return BW_MEMORY;
  bw_object_init(s, &isostatic_kind);
  s->dof_map = bw_retain(dof_map);
  s->body = BW_NEW0(context, body, dof_map->mesh->component_count);
  s->constraint = BW_NEW0(context, constraint, dof_map->rigid_mode_count + 1);
  if (!s->body || !s->constraint) {
    status = BW_MEMORY;
    goto done;
  }
  for (int32_t c = 0; c < dof_map->mesh->component_count; c++)
    if (dof_map->rigid_mode_start[c + 1] > dof_map->rigid_mode_start[c] && !take_body(s, c)) {
      status = bw_fail(context, BW_INTERNAL,
                       "the isostatic constraints of body %d do not fix its rigid-body modes",
                       (int)c + 1);
      goto done;
    }
done:
  if (status == BW_OK)
    *out = s;
  else
    bw_release(s);
  return status;
}

/* ---- fields -------------------------------------------------------------------------------- */

typedef struct pass {
  const bwi_isostatic *s;
  bool transposed;
  double *field, *amount; /* amount: count x 2 rigid_mode_count */
} pass;

/* to = what the inverse, or its transpose, makes of `from`, body by body, negative. */
static void combine(const pass *p, const double *from, double *to) {
  for (int32_t k = 0; k < p->s->body_count; k++) {
    const body *b = &p->s->body[k];
    int n = b->count;
    for (int i = 0; i < n; i++) {
      double sum = 0;
      for (int j = 0; j < n; j++)
        sum += b->inverse[p->transposed ? j * n + i : i * n + j] * from[b->first + j];
      to[b->first + i] = -sum;
    }
  }
}

static bw_status run(void *data, int64_t begin, int64_t end, int worker) {
  (void)worker;
  const pass *p = data;
  const bw_dof_map *d = p->s->dof_map;
  int modes = d->rigid_mode_count;
  for (int64_t k = begin; k < end; k++) {
    double *field = p->field + k * 3 * (int64_t)d->mesh->node_count;
    double *seen = p->amount + k * 2 * modes, *made = seen + modes;
    if (p->transposed)
      bw_rigid_modes_dot(d, field, seen);
    else
      for (int i = 0; i < modes; i++)
        seen[i] =
            bw_dot(p->s->constraint[i].direction, field + 3 * (int64_t)p->s->constraint[i].node);
    combine(p, seen, made);
    if (!p->transposed)
      bw_rigid_modes_add(d, made, field);
    for (int i = 0; p->transposed && i < modes; i++)
      for (int l = 0; l < 3; l++)
        field[3 * (int64_t)p->s->constraint[i].node + l] +=
            made[i] * p->s->constraint[i].direction[l];
  }
  return BW_OK;
}

static bw_status transform(bw_context *context, const bwi_isostatic *s, bool transposed,
                           int64_t count, double *field) {
  pass p = {.s = s, .transposed = transposed, .field = field};
  p.amount = BW_NEW(context, double, 2 * count * s->dof_map->rigid_mode_count);
  if (!p.amount)
    return BW_MEMORY;
  bw_status status = bw_parallel(context, count, 1, run, &p);
  bw_free(p.amount);
  return status;
}

bw_status bwi_isostatic_balance(bw_context *context, const bwi_isostatic *s, int64_t count,
                                double *r) {
  return transform(context, s, true, count, r);
}

bw_status bwi_isostatic_remove(bw_context *context, const bwi_isostatic *s, int64_t count,
                               double *u) {
  return transform(context, s, false, count, u);
}
