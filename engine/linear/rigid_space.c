/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* The null space of bodies that can move freely (rigid_space.h). */
#include "linear/rigid_space.h"

#include <assert.h>
#include <math.h>
#include <string.h>

#include "base/dense.h"

enum { ROWS = 512, FIELDS = BWI_RIGID_FIELDS, SUMS = 6 * FIELDS };

/* Isostatic constraints as in model/isostatic.c: within this many radii of gyration, at so many
 * candidates, none weaker than a fraction of the first. Those of a former shape may be weaker. */
#define MAX_REACH 1.5
#define WEAK 0.1
#define KEPT_REACH 3.0
#define KEPT_WEAK 0.03
#define TINY 1e-7
enum { CANDIDATES = 4096 };

typedef struct body {
  int32_t first, count; /* of its nodes in `node` */
  int modes;
  double centre[3], radius; /* of gyration of the nodes */
  double translation[6][3], rotation[6][3];
  int32_t constraint[6]; /* 3 * row + component */
} body;

struct bwi_rigid_space {
  bw_object object;
  const bw_dof_map *dof_map; /* retained */
  int32_t body_count;
  body *body;        /* those with modes */
  int32_t *node;     /* with a row, body by body */
  int32_t *row;      /* of each of `node` */
  double *chunk_sum; /* of the largest body: chunks x SUMS */
};

static void space_destroy(void *object) {
  bwi_rigid_space *s = object;
  bw_release(s->dof_map);
  bw_free(s->body);
  bw_free(s->node);
  bw_free(s->row);
  bw_free(s->chunk_sum);
  bw_free(s);
}

static int64_t largest_body(const bwi_rigid_space *s) {
  int64_t most = 0;
  for (int32_t b = 0; b < s->body_count; b++)
    most = s->body[b].count > most ? s->body[b].count : most;
  return most;
}

static size_t space_bytes(const void *object) {
  const bwi_rigid_space *s = object;
  size_t nodes = 0;
  for (int32_t b = 0; b < s->body_count; b++)
    nodes += (size_t)s->body[b].count;
  return sizeof *s + (size_t)s->body_count * sizeof(body) + nodes * 2 * sizeof(int32_t) +
         (size_t)(largest_body(s) / ROWS + 1) * SUMS * sizeof(double);
}

static const bw_kind space_kind = {"rigid space", space_destroy, space_bytes};

static void arm_of(const bwi_rigid_space *s, const body *b, int64_t at, double arm[3]) {
  const double *x = s->dof_map->mesh->node + 3 * (int64_t)s->node[at];
  for (int d = 0; d < 3; d++)
    arm[d] = x[d] - b->centre[d];
}

static void mode_at(const body *b, int mode, const double arm[3], double u[3]) {
  bw_cross(b->rotation[mode], arm, u);
  for (int d = 0; d < 3; d++)
    u[d] += b->translation[mode][d];
}

/* Modes about the centre of the nodes, made orthonormal by Cholesky's factor of their products. */
static bool orthonormalise(const bwi_rigid_space *s, body *b, const bw_rigid_mode *mode) {
  double gram[36] = {0};
  int m = b->modes;
  for (int i = 0; i < m; i++) {
    double arm[3];
    for (int d = 0; d < 3; d++)
      arm[d] = b->centre[d] - mode[i].centre[d];
    bw_cross(mode[i].rotation, arm, b->translation[i]);
    for (int d = 0; d < 3; d++) {
      b->translation[i][d] += mode[i].translation[d];
      b->rotation[i][d] = mode[i].rotation[d];
    }
  }
  for (int64_t k = b->first; k < b->first + b->count; k++) {
    double arm[3], u[6][3];
    arm_of(s, b, k, arm);
    for (int i = 0; i < m; i++)
      mode_at(b, i, arm, u[i]);
    for (int i = 0; i < m; i++)
      for (int j = 0; j <= i; j++)
        gram[i * m + j] += bw_dot(u[i], u[j]);
  }
  if (!bwi_cholesky(m, gram, 1e-12))
    return false;
  for (int d = 0; d < 3; d++) { /* Z = R L^-T */
    double t[6], w[6];
    for (int i = 0; i < m; i++) {
      t[i] = b->translation[i][d];
      w[i] = b->rotation[i][d];
    }
    bwi_lower_solve(m, gram, t);
    bwi_lower_solve(m, gram, w);
    for (int i = 0; i < m; i++) {
      b->translation[i][d] = t[i];
      b->rotation[i][d] = w[i];
    }
  }
  return true;
}

static void measure(const bwi_rigid_space *s, body *b) {
  double sum = 0;
  memset(b->centre, 0, sizeof b->centre);
  for (int64_t k = b->first; k < b->first + b->count; k++)
    for (int d = 0; d < 3; d++)
      b->centre[d] += s->dof_map->mesh->node[3 * (int64_t)s->node[k] + d] / b->count;
  for (int64_t k = b->first; k < b->first + b->count; k++) {
    double arm[3];
    arm_of(s, b, k, arm);
    sum += bw_dot(arm, arm);
  }
  b->radius = sqrt(sum / b->count);
}

bw_status bwi_rigid_space_create(bw_context *context, const bw_dof_map *dof_map,
                                 const int32_t *row_of, bwi_rigid_space **out) {
  bw_status status = BW_OK;
  int32_t bodies = dof_map->mesh->component_count, taken = 0;
  bwi_rigid_space *s = BW_NEW0(context, bwi_rigid_space, 1);
  if (!s)
    return BW_MEMORY;
  bw_object_init(s, &space_kind);
  s->dof_map = bw_retain(dof_map);
  s->body = BW_NEW0(context, body, bodies);
  s->node = BW_NEW(context, int32_t, dof_map->mesh->node_count);
  s->row = BW_NEW(context, int32_t, dof_map->mesh->node_count);
  if (!s->body || !s->node || !s->row) {
    status = BW_MEMORY;
    goto done;
  }
  for (int32_t c = 0; c < bodies; c++) {
    int modes = dof_map->rigid_mode_start[c + 1] - dof_map->rigid_mode_start[c];
    body *b = &s->body[s->body_count];
    if (modes == 0)
      continue;
    *b = (body){.first = taken, .modes = modes};
    for (int k = 0; k < 6; k++)
      b->constraint[k] = -1;
    for (int32_t j = dof_map->body_start[c]; j < dof_map->body_start[c + 1]; j++)
      if (row_of[dof_map->body_node[j]] >= 0) {
        s->node[taken] = dof_map->body_node[j];
        s->row[taken++] = row_of[dof_map->body_node[j]];
      }
    b->count = taken - b->first;
    measure(s, b);
    if (!orthonormalise(s, b, dof_map->rigid_mode + dof_map->rigid_mode_start[c])) {
      status = bw_fail(context, BW_INTERNAL, "the rigid-body modes of body %d are dependent",
                       (int)c + 1);
      goto done;
    }
    s->body_count++;
  }
  s->chunk_sum = BW_NEW(context, double, (largest_body(s) / ROWS + 1) * SUMS);
  if (!s->chunk_sum)
    status = BW_MEMORY;
done:
  if (status == BW_OK)
    *out = s;
  else
    bw_release(s);
  return status;
}

/* ---- projection ---------------------------------------------------------------------------- */

typedef struct projection {
  bwi_rigid_space *s;
  const body *b;
  bwi_field_layout layout;
  int fields;
  double *x;
  double translation[FIELDS][3], rotation[FIELDS][3]; /* Z Z^T x */
} projection;

/* Resultant and moment of each field. */
static bw_status add_up(void *data, int64_t begin, int64_t end, int worker) {
  (void)worker;
  const projection *p = data;
  const bwi_field_layout *l = &p->layout;
  double *sum = p->s->chunk_sum + SUMS * (begin / ROWS);
  memset(sum, 0, SUMS * sizeof *sum);
  for (int64_t k = p->b->first + begin; k < p->b->first + end; k++) {
    const double *x = p->x + l->row * p->s->row[k];
    double arm[3];
    arm_of(p->s, p->b, k, arm);
    for (int f = 0; f < p->fields; f++) {
      const double *v = x + f * l->field;
      const double own[3] = {v[0], v[l->component], v[2 * l->component]};
      double moment[3];
      bw_cross(arm, own, moment);
      for (int d = 0; d < 3; d++) {
        sum[6 * f + d] += own[d];
        sum[6 * f + 3 + d] += moment[d];
      }
    }
  }
  return BW_OK;
}

static bw_status subtract(void *data, int64_t begin, int64_t end, int worker) {
  (void)worker;
  const projection *p = data;
  const bwi_field_layout *l = &p->layout;
  for (int64_t k = p->b->first + begin; k < p->b->first + end; k++) {
    double *x = p->x + l->row * p->s->row[k], arm[3];
    arm_of(p->s, p->b, k, arm);
    for (int f = 0; f < p->fields; f++) {
      double *v = x + f * l->field, turn[3];
      bw_cross(p->rotation[f], arm, turn);
      for (int d = 0; d < 3; d++)
        v[d * l->component] -= p->translation[f][d] + turn[d];
    }
  }
  return BW_OK;
}

static void combine(projection *p) {
  const body *b = p->b;
  int64_t chunks = (b->count + ROWS - 1) / ROWS;
  for (int f = 0; f < p->fields; f++) {
    double sum[6] = {0};
    for (int64_t c = 0; c < chunks; c++)
      for (int d = 0; d < 6; d++)
        sum[d] += p->s->chunk_sum[SUMS * c + 6 * f + d];
    memset(p->translation[f], 0, sizeof p->translation[f]);
    memset(p->rotation[f], 0, sizeof p->rotation[f]);
    for (int m = 0; m < b->modes; m++) {
      double along = bw_dot(b->translation[m], sum) + bw_dot(b->rotation[m], sum + 3);
      for (int d = 0; d < 3; d++) {
        p->translation[f][d] += along * b->translation[m][d];
        p->rotation[f][d] += along * b->rotation[m][d];
      }
    }
  }
}

bw_status bwi_rigid_space_project(bw_context *context, bwi_rigid_space *s,
                                  const bwi_field_layout *layout, int fields, double *x) {
  bw_status status = BW_OK;
  assert(fields <= FIELDS);
  projection p = {.s = s, .layout = *layout, .fields = fields, .x = x};
  for (int32_t b = 0; b < s->body_count; b++) {
    p.b = &s->body[b];
    BW_TRY(bw_parallel(context, p.b->count, ROWS, add_up, &p));
    combine(&p);
    BW_TRY(bw_parallel(context, p.b->count, ROWS, subtract, &p));
  }
done:
  return status;
}

/* ---- isostatic constraints ----------------------------------------------------------------- */

typedef struct pivot {
  double size, direction[6];
  int32_t at;
} pivot;

/* What is left of component d at a node, seen by the modes, beside the `done` chosen ones. */
static void weigh(const bwi_rigid_space *s, const body *b, int64_t at, int d, int done,
                  const double chosen[6][6], pivot *best) {
  int32_t frame = s->dof_map->frame_of[s->node[at]];
  double arm[3], row[6], size = 0, direction[3];
  arm_of(s, b, at, arm);
  for (int k = 0; k < 3; k++)
    direction[k] = frame < 0 ? k == d : s->dof_map->frame[9 * (int64_t)frame + 3 * d + k];
  for (int m = 0; m < b->modes; m++) {
    double u[3];
    mode_at(b, m, arm, u);
    row[m] = bw_dot(u, direction);
  }
  for (int pass = 0; pass < 2; pass++)
    for (int p = 0; p < done; p++) {
      double part = bwi_dot(b->modes, row, chosen[p]);
      for (int m = 0; m < b->modes; m++)
        row[m] -= part * chosen[p][m];
    }
  for (int m = 0; m < b->modes; m++)
    size += row[m] * row[m];
  if (size > best->size * (1 + 1e-6)) { /* ties go to the first, whatever the rounding */
    best->size = size;
    best->at = 3 * s->row[at] + d;
    memcpy(best->direction, row, sizeof row);
  }
}

static bool is_among(const int32_t *list, int32_t what) {
  for (int k = 0; k < 6; k++)
    if (list[k] == what)
      return true;
  return false;
}

/* Constraints at every stride-th node within `reach` of the centre, of those in `among` where
 * given. */
static bool choose(const bwi_rigid_space *s, body *b, double reach, int64_t stride, double weakest,
                   const int32_t *among, const int32_t *unknown) {
  double chosen[6][6], first = 0;
  for (int done = 0; done < b->modes; done++) {
    pivot best = {.size = 0};
    for (int64_t k = b->first; k < b->first + b->count; k += stride) {
      double arm[3];
      arm_of(s, b, k, arm);
      for (int d = 0; d < 3 && bw_dot(arm, arm) <= reach * reach; d++) {
        int32_t at = 3 * s->row[k] + d;
        if (unknown[at] >= 0 && (!among || is_among(among, at)))
          weigh(s, b, k, d, done, chosen, &best);
      }
    }
    double size = sqrt(best.size);
    first = done == 0 ? size : first;
    if (!(size > weakest * first) || size == 0)
      return false;
    for (int m = 0; m < b->modes; m++)
      chosen[done][m] = best.direction[m] / size;
    b->constraint[done] = best.at;
  }
  return true;
}

bool bwi_rigid_space_constrain(bwi_rigid_space *s, const bwi_rigid_space *former,
                               int32_t *unknown) {
  bool keep = former && former->body_count == s->body_count;
  for (int32_t k = 0; k < s->body_count; k++) {
    body *b = &s->body[k];
    const int32_t *kept = keep ? former->body[k].constraint : NULL;
    if (!(kept && choose(s, b, KEPT_REACH * b->radius, 1, KEPT_WEAK, kept, unknown)) &&
        !choose(s, b, MAX_REACH * b->radius, b->count / CANDIDATES + 1, WEAK, NULL, unknown) &&
        !choose(s, b, HUGE_VAL, 1, TINY, NULL, unknown))
      return false;
    for (int m = 0; m < b->modes; m++)
      unknown[b->constraint[m]] = -1;
  }
  return true;
}
