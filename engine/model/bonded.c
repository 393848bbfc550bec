/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* The rigid-body modes of bodies that bonds join: the motions of the single bodies and remote
 * points, six for each, that agree with the supports, leave springs alone, and agree at the nodes
 * of bonds and couplings. */
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "base/dense.h"
#include "model/internal.h"

/* Of a sum of squares that a free motion leaves, in that of the stiffest one. */
static const double free_square = 1e-10;
enum { SWEEPS = 60 };

bw_status bwi_fail_node(bw_context *context, const bw_mesh *mesh, int32_t node, bw_status status,
                        const char *what) {
  const double *x = mesh->node + 3 * (int64_t)node;
  bw_fail(context, status, "node %d at (%g, %g, %g) m %s", node + 1, x[0], x[1], x[2], what);
  bw_detail_number(context, "node", node + 1.0);
  return status;
}

bw_status bwi_model_refuse_preloads(bw_context *context, const bw_model *model, const char *why) {
  for (int b = 0; b < model->bond_count; b++)
    if (model->bond[b].preload != BW_NO_PRELOAD)
      return bw_fail(context, BW_UNSUPPORTED, "bond %d has a preload, which %s", b + 1, why);
  return BW_OK;
}

bw_status bw_model_refuse_joints(bw_context *context, const bw_model *model) {
  const struct {
    int count;
    const char *name;
  } kind[] = {{model->bond_count, "bond"},
              {model->attachment_count, "attachment"},
              {model->coupling_count, "coupling"}};
  char list[100];
  int length = 0, kinds = 0;
  if (!bw_model_joined(model))
    return BW_OK;
  if (model->cyclic)
    return bw_fail(context, BW_UNSUPPORTED,
                   "the model is one of %d sectors of cyclic symmetry: it gives static solutions "
                   "and modes; for other analyses, model the whole",
                   model->cyclic->count);
  for (int k = 0; k < 3; k++)
    if (kind[k].count > 0)
      length += snprintf(list + length, sizeof list - (size_t)length, "%s%d %s%s",
                         kinds++ > 0 ? " and " : "", kind[k].count, kind[k].name,
                         kind[k].count == 1 ? "" : "s");
  return bw_fail(
      context, BW_UNSUPPORTED,
      "the model has %s: it gives static solutions, modes, load factors, harmonic responses, "
      "response spectra, transients, the worst case, contact and edit sessions; for other "
      "analyses, join the bodies in one mesh, and leave masses, springs and remote points out",
      list);
}

bw_status bwi_motions_open(bw_context *context, const bw_dof_map *dof_map, int count,
                           bwi_motions *m) {
  int64_t n = count;
  *m = (bwi_motions){.dof_map = dof_map, .count = count, .bodies = count};
  m->square = BW_NEW0(context, double, n *n);
  m->row = BW_NEW0(context, double, n);
  m->vector = BW_NEW(context, double, n *n);
  return m->square && m->row && m->vector ? BW_OK : BW_MEMORY;
}

void bwi_motions_clear(bwi_motions *m) {
  bw_free(m->square);
  bw_free(m->row);
  bw_free(m->vector);
}

/* A body turns by its own size. */
void bwi_add_motion(const bwi_motions *m, int32_t body, const double x[3], const double d[3],
                    double factor) {
  double *row = m->row + m->first;
  const double *centre = m->dof_map->body_centre + 3 * (size_t)body;
  double size = cbrt(m->dof_map->body_volume[body]), turn[3];
  double y[3] = {x[0] - centre[0], x[1] - centre[1], x[2] - centre[2]};
  bw_cross(y, d, turn);
  for (int k = 0; k < 3; k++) {
    row[6 * body + k] += factor * d[k];
    row[6 * body + 3 + k] += factor * turn[k] / size;
  }
}

/* Rows have few bodies in them. */
void bwi_take_row(const bwi_motions *m) {
  for (int i = 0; i < m->count; i++)
    for (int k = 0; m->row[i] != 0 && k < m->count; k++)
      m->square[i * (int64_t)m->count + k] += m->row[i] * m->row[k];
  memset(m->row, 0, (size_t)m->count * sizeof *m->row);
}

void bwi_take_supports(const bwi_motions *m, int32_t count, const bwi_constraint *constraint) {
  const bw_mesh *mesh = m->dof_map->mesh;
  for (int32_t h = 0; h < count; h++)
    for (int i = 0; i < constraint[h].count; i++) {
      int32_t node = constraint[h].node;
      bwi_add_motion(m, mesh->component[node], mesh->node + 3 * (int64_t)node,
                     constraint[h].direction[i], 1);
      bwi_take_row(m);
    }
}

/* A spring leaves alone what does not move its nodes along it. */
void bwi_take_spring(const bwi_motions *m, const bw_attachment *spring) {
  const bw_mesh *mesh = m->dof_map->mesh;
  int32_t parts = bwi_attachment_parts(spring);
  for (int32_t p = 0; p < parts; p++) {
    const int32_t *node;
    double share[36];
    int count = bwi_attachment_part(spring, p, &node, share);
    for (int i = 0; i < count; i++)
      for (int k = 0; k < 3; k++) {
        const double d[3] = {k == 0, k == 1, k == 2};
        if (spring->stiffness[k] == 0)
          continue;
        bwi_add_motion(m, mesh->component[node[i]], mesh->node + 3 * (int64_t)node[i], d, 1);
        bwi_take_row(m);
      }
  }
}

void bwi_take_bond(const bwi_motions *m, const bw_bond *bond, int64_t sliding) {
  const bw_mesh *mesh = m->dof_map->mesh;
  const bw_sparse_matrix *f = bond->follows;
  for (int32_t i = 0; i < bond->node_count; i++)
    for (int k = 0; k < 3; k++) {
      const double *x = mesh->node + 3 * (int64_t)bond->node[i], d[3] = {k == 0, k == 1, k == 2};
      bwi_add_motion(m, mesh->component[bond->node[i]], x, d, 1);
      for (int64_t e = f->start[i]; e < f->start[i + 1]; e++)
        bwi_add_motion(m, mesh->component[f->column[e]], x, d, -f->value[e]);
      if (sliding >= 0)
        m->row[sliding] = -bond->normal[k];
      bwi_take_row(m);
    }
}

/* A remote point as its face sees it: however far away, it moves by the displacement and rotation
 * of the middle of its nodes. A rotation is measured by their radius of gyration. */
typedef struct lever {
  int64_t at;       /* the first of its six motions in a row */
  double middle[3]; /* of the nodes */
  double arm[3];    /* from there to the point */
  double radius;
} lever;

static lever lever_of(const bwi_motions *m, const bw_coupling *coupling, int p) {
  const double *x = m->dof_map->mesh->node;
  lever l = {.at = 6 * ((int64_t)m->dof_map->mesh->component_count + p)};
  for (int32_t i = 0; i < coupling->node_count; i++)
    for (int c = 0; c < 3; c++)
      l.middle[c] += x[3 * (int64_t)coupling->node[i] + c] / coupling->node_count;
  for (int32_t i = 0; i < coupling->node_count; i++)
    for (int c = 0; c < 3; c++) {
      double y = x[3 * (int64_t)coupling->node[i] + c] - l.middle[c];
      l.radius += y * y / coupling->node_count;
    }
  l.radius = sqrt(l.radius);
  for (int c = 0; c < 3; c++)
    l.arm[c] = coupling->point.at[c] - l.middle[c];
  return l;
}

/* row += factor (displacement along d at `arm` from the middle) */
static void add_lever(const bwi_motions *m, const lever *l, const double arm[3], const double d[3],
                      double factor) {
  double turn[3];
  bw_cross(arm, d, turn);
  for (int k = 0; k < 3; k++) {
    m->row[l->at + k] += factor * d[k];
    m->row[l->at + 3 + k] += factor * turn[k] / l->radius;
  }
}

/* The middle moves as the face does in the mean. */
static void take_mean(const bwi_motions *m, const bw_coupling *coupling, const lever *l, int k) {
  const bw_mesh *mesh = m->dof_map->mesh;
  int64_t width = 3 * (int64_t)coupling->node_count;
  double turn[3] = {0};
  if (k < 3)
    bw_cross(l->arm, (double[3]){k == 0, k == 1, k == 2}, turn);
  for (int64_t i = 0; i < width; i++) {
    int32_t node = coupling->node[i / 3];
    const double d[3] = {i % 3 == 0, i % 3 == 1, i % 3 == 2}, *mean = coupling->mean + i;
    double part = k < 3 ? mean[k * width] : mean[k * width] * l->radius;
    for (int c = 0; c < 3; c++)
      part -= turn[c] * mean[(3 + c) * width];
    bwi_add_motion(m, mesh->component[node], mesh->node + 3 * (int64_t)node, d, part);
  }
  m->row[l->at + k] -= 1;
  bwi_take_row(m);
}

static void take_coupling(const bwi_motions *m, const bw_coupling *coupling, int p) {
  const bw_mesh *mesh = m->dof_map->mesh;
  const bw_remote_point *point = &coupling->point;
  const lever l = lever_of(m, coupling, p);
  for (int k = 0; k < 6; k++) {
    if (point->fixed[k] || point->spring[k] > 0) {
      if (k < 3)
        add_lever(m, &l, l.arm, (double[3]){k == 0, k == 1, k == 2}, 1);
      else
        m->row[l.at + k] = 1;
      bwi_take_row(m);
    }
    if (point->kind == BW_DISTRIBUTED)
      take_mean(m, coupling, &l, k);
  }
  for (int64_t i = 0; point->kind == BW_RIGID && i < 3 * (int64_t)coupling->node_count; i++) {
    int32_t node = coupling->node[i / 3];
    const double *x = mesh->node + 3 * (int64_t)node;
    const double d[3] = {i % 3 == 0, i % 3 == 1, i % 3 == 2};
    bwi_add_motion(m, mesh->component[node], x, d, 1);
    add_lever(m, &l, (double[3]){x[0] - l.middle[0], x[1] - l.middle[1], x[2] - l.middle[2]}, d,
              -1);
    bwi_take_row(m);
  }
}

/* Whether motion i of the eigenvectors fulfils the conditions. */
static bool is_free(const bwi_motions *m, int i) {
  double largest = 0;
  for (int64_t k = 0; k < m->count; k++)
    largest = fmax(largest, m->square[k * m->count + k]);
  return m->square[i * (int64_t)m->count + i] <= free_square * largest;
}

void bwi_count_rigid_modes(const bwi_motions *m, int *count, int32_t *body) {
  double most = 0;
  int64_t n = m->count;
  *count = 0;
  *body = -1;
  bwi_symmetric_eigen(m->count, m->count, m->square, m->vector, 1e-28, SWEEPS);
  for (int i = 0; i < n; i++) {
    if (!is_free(m, i))
      continue;
    for (int64_t k = 0; *count == 0 && k < m->bodies; k++)
      if (fabs(m->vector[i * n + k]) > most) {
        most = fabs(m->vector[i * n + k]);
        *body = (int32_t)(k / 6 % m->dof_map->mesh->component_count);
      }
    ++*count;
  }
}

/* The conditions of a joined model. Clear with bwi_motions_clear in any case. */
static bw_status take_all(bw_context *context, const bw_model *model, const bw_dof_map *dof_map,
                          bool locked, bwi_motions *m) {
  bw_status status = BW_OK;
  int32_t constrained = 0;
  bwi_constraint *constraint = NULL;
  int64_t of_bodies = 6 * (int64_t)dof_map->mesh->component_count;
  int64_t sliding = of_bodies + 6 * (int64_t)model->coupling_count, n = sliding;
  for (int i = 0; i < model->bond_count; i++)
    n += !locked && model->bond[i].preload == BW_PRELOAD_FORCE;
  BW_TRY(bwi_motions_open(context, dof_map, (int)n, m));
  m->bodies = (int)of_bodies;
  BW_TRY(bwi_node_constraints(context, model, &constrained, &constraint));
  bwi_take_supports(m, constrained, constraint);
  for (int i = 0; i < model->bond_count; i++) {
    bool slides = !locked && model->bond[i].preload == BW_PRELOAD_FORCE;
    bwi_take_bond(m, &model->bond[i], slides ? sliding++ : -1);
  }
  for (int i = 0; i < model->attachment_count; i++)
    bwi_take_spring(m, &model->attachment[i]);
  for (int i = 0; i < model->coupling_count; i++)
    take_coupling(m, &model->coupling[i], i);
done:
  bw_free(constraint);
  return status;
}

bw_status bwi_bonded_rigid_modes(bw_context *context, const bw_model *model,
                                 const bw_dof_map *dof_map, bool locked, int *count,
                                 int32_t *body) {
  bwi_motions m = {0};
  bw_status status = take_all(context, model, dof_map, locked, &m);
  if (status == BW_OK)
    bwi_count_rigid_modes(&m, count, body);
  bwi_motions_clear(&m);
  return status;
}

bw_status bwi_bonded_rigid_fields(bw_context *context, const bw_model *model,
                                  const bw_dof_map *dof_map, int *count, double **field) {
  bw_status status = BW_OK;
  const bw_mesh *mesh = dof_map->mesh;
  int64_t nodes = mesh->node_count, made = 0;
  int32_t body;
  bwi_motions m = {0};
  BW_TRY(take_all(context, model, dof_map, false, &m));
  bwi_count_rigid_modes(&m, count, &body);
  *field = BW_NEW(context, double, 3 * nodes * *count);
  BW_TRY_MEMORY(*field);
  for (int i = 0; i < m.count; i++) {
    if (!is_free(&m, i))
      continue;
    for (int64_t n = 0; n < nodes; n++) {
      const double *motion = m.vector + i * (int64_t)m.count + 6 * (int64_t)mesh->component[n];
      const double *centre = dof_map->body_centre + 3 * (int64_t)mesh->component[n];
      double size = cbrt(dof_map->body_volume[mesh->component[n]]), y[3], turn[3];
      for (int k = 0; k < 3; k++)
        y[k] = (mesh->node[3 * n + k] - centre[k]) / size;
      bw_cross(motion + 3, y, turn);
      for (int k = 0; k < 3; k++)
        (*field)[3 * (made * nodes + n) + k] = motion[k] + turn[k];
    }
    made++;
  }
done:
  bwi_motions_clear(&m);
  return status;
}
