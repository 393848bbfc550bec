/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* The null space of bodies that can move freely (rigid_space.h). */
#include "linear/rigid_space.h"

#include <assert.h>
#include <math.h>
#include <string.h>

#include "base/dense.h"
#include "model/internal.h"

enum { ROWS = 512, FIELDS = BWI_RIGID_FIELDS, SUMS = 6 * FIELDS };

typedef struct body {
  int32_t first, count; /* of its nodes in `node` */
  int modes;
  double centre[3], radius; /* of gyration of the nodes */
  bw_rigid_mode mode[6];    /* about the centre, orthonormal */
  int32_t constraint[6];    /* 3 * row + component */
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

/* Modes about the centre of the nodes, made orthonormal by Cholesky's factor of their products. */
static bool orthonormalise(const bwi_rigid_space *s, body *b, const bw_rigid_mode *mode) {
  double gram[36] = {0};
  int m = b->modes;
  for (int i = 0; i < m; i++) {
    b->mode[i] = mode[i];
    bwi_motion_at(&mode[i], b->centre, b->mode[i].translation);
    memcpy(b->mode[i].centre, b->centre, sizeof b->centre);
  }
  for (int64_t k = b->first; k < b->first + b->count; k++) {
    double u[6][3];
    for (int i = 0; i < m; i++)
      bwi_motion_at(&b->mode[i], s->dof_map->mesh->node + 3 * (int64_t)s->node[k], u[i]);
    for (int i = 0; i < m; i++)
      for (int j = 0; j <= i; j++)
        gram[i * m + j] += bw_dot(u[i], u[j]);
  }
  if (!bwi_cholesky(m, gram, 1e-12))
    return false;
  for (int d = 0; d < 3; d++) { /* Z = R L^-T */
    double t[6], w[6];
    for (int i = 0; i < m; i++) {
      t[i] = b->mode[i].translation[d];
      w[i] = b->mode[i].rotation[d];
    }
    bwi_lower_solve(m, gram, t);
    bwi_lower_solve(m, gram, w);
    for (int i = 0; i < m; i++) {
      b->mode[i].translation[d] = t[i];
      b->mode[i].rotation[d] = w[i];
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
  BW_TRY_MEMORY(s->body && s->node && s->row);
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
  double translation[3][FIELDS], rotation[3][FIELDS]; /* Z Z^T x */
} projection;

/* Fields side by side (`field` is 1) are worked on together. */
static inline void add_row(const projection *p, const double arm[3], const double *restrict x,
                           int64_t field, double (*restrict sum)[FIELDS]) {
  int64_t component = p->layout.component;
  for (int f = 0; f < p->fields; f++) {
    double u = x[f * field], v = x[component + f * field], w = x[2 * component + f * field];
    sum[0][f] += u;
    sum[1][f] += v;
    sum[2][f] += w;
    sum[3][f] += arm[1] * w - arm[2] * v;
    sum[4][f] += arm[2] * u - arm[0] * w;
    sum[5][f] += arm[0] * v - arm[1] * u;
  }
}

/* Resultant and moment of each field. */
static bw_status add_up(void *data, int64_t begin, int64_t end, int worker) {
  (void)worker;
  const projection *p = data;
  const bwi_field_layout *l = &p->layout;
  double sum[6][FIELDS] = {{0}};
  for (int64_t k = p->b->first + begin; k < p->b->first + end; k++) {
    const double *x = p->x + l->row * p->s->row[k];
    double arm[3];
    arm_of(p->s, p->b, k, arm);
    if (l->field == 1)
      add_row(p, arm, x, 1, sum);
    else
      add_row(p, arm, x, l->field, sum);
  }
  memcpy(p->s->chunk_sum + SUMS * (begin / ROWS), sum, sizeof sum);
  return BW_OK;
}

static inline void subtract_row(const projection *p, const double arm[3], double *restrict x,
                                int64_t field) {
  int64_t component = p->layout.component;
  const double(*t)[FIELDS] = p->translation, (*r)[FIELDS] = p->rotation;
  for (int f = 0; f < p->fields; f++) {
    x[f * field] -= t[0][f] + r[1][f] * arm[2] - r[2][f] * arm[1];
    x[component + f * field] -= t[1][f] + r[2][f] * arm[0] - r[0][f] * arm[2];
    x[2 * component + f * field] -= t[2][f] + r[0][f] * arm[1] - r[1][f] * arm[0];
  }
}

static bw_status subtract(void *data, int64_t begin, int64_t end, int worker) {
  (void)worker;
  const projection *p = data;
  const bwi_field_layout *l = &p->layout;
  for (int64_t k = p->b->first + begin; k < p->b->first + end; k++) {
    double *x = p->x + l->row * p->s->row[k], arm[3];
    arm_of(p->s, p->b, k, arm);
    if (l->field == 1)
      subtract_row(p, arm, x, 1);
    else
      subtract_row(p, arm, x, l->field);
  }
  return BW_OK;
}

static void combine(projection *p) {
  const body *b = p->b;
  int64_t chunks = (b->count + ROWS - 1) / ROWS;
  memset(p->translation, 0, sizeof p->translation);
  memset(p->rotation, 0, sizeof p->rotation);
  for (int f = 0; f < p->fields; f++) {
    double sum[6] = {0};
    for (int64_t c = 0; c < chunks; c++)
      for (int d = 0; d < 6; d++)
        sum[d] += p->s->chunk_sum[SUMS * c + d * FIELDS + f];
    for (int m = 0; m < b->modes; m++) {
      const bw_rigid_mode *mode = &b->mode[m];
      double along = bw_dot(mode->translation, sum) + bw_dot(mode->rotation, sum + 3);
      for (int d = 0; d < 3; d++) {
        p->translation[d][f] += along * mode->translation[d];
        p->rotation[d][f] += along * mode->rotation[d];
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

typedef struct candidates {
  const bwi_rigid_space *s;
  const body *b;
  const int32_t *former; /* constraints, or NULL */
  const int32_t *unknown;
} candidates;

static bool is_open(const void *data, int64_t at, int k, bool former) {
  const candidates *c = data;
  int32_t component = 3 * c->s->row[c->b->first + at] + k;
  bool among = !former;
  for (int m = 0; m < 6 && !among; m++)
    among = c->former[m] == component;
  return among && c->unknown[component] >= 0;
}

bool bwi_rigid_space_constrain(bwi_rigid_space *s, const bwi_rigid_space *former,
                               int32_t *unknown) {
  bool keep = former && former->body_count == s->body_count;
  for (int32_t k = 0; k < s->body_count; k++) {
    body *b = &s->body[k];
    const candidates data = {s, b, keep ? former->body[k].constraint : NULL, unknown};
    bwi_isostatic_choice choice = {.dof_map = s->dof_map,
                                   .count = b->modes,
                                   .mode = b->mode,
                                   .centre = b->centre,
                                   .length = b->radius,
                                   .node_count = b->count,
                                   .node = s->node + b->first,
                                   .open = is_open,
                                   .data = &data,
                                   .former = keep};
    if (!bwi_choose_isostatic(&choice))
      return false;
    for (int m = 0; m < b->modes; m++) {
      b->constraint[m] = 3 * s->row[b->first + choice.at[m]] + choice.component[m];
      unknown[b->constraint[m]] = -1;
    }
  }
  return true;
}
