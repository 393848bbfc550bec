/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* Targets of a screening. See screening_targets.h.
 *
 * A patch has tens of facets and a facet lies in tens of patches: the stresses at the corners of
 * facets are computed once. The weights of a patch are those of bw_surface_mean. */
#include "analysis/screening_targets.h"

#include "analysis/surface_stress.h"
#include "analysis/weak_internal.h"

#include <string.h>

enum { CORNERS_PER_CHUNK = 64 };

/* Adds C grad u of all pressures to 6 x K numbers, by the gradients of the shape functions. */
static void add_stress(const bwi_targets *t, const double c[36], int nodes, const int32_t *node,
                       const double (*gradient)[3], double *out) {
  size_t k = (size_t)t->pressures;
  for (int a = 0; a < nodes; a++) {
    /* Columns of C B for the three components of node a. */
    const double *g = gradient[a];
    for (int i = 0; i < 3; i++) {
      double strain[6] = {0};
      strain[i] = g[i];
      strain[3] = i == 1 ? g[2] : i == 2 ? g[1] : 0;
      strain[4] = i == 2 ? g[0] : i == 0 ? g[2] : 0;
      strain[5] = i == 0 ? g[1] : i == 1 ? g[0] : 0;
      const double *u = t->response + (3 * (size_t)node[a] + (size_t)i) * k;
      for (size_t r = 0; r < 6; r++) {
        double factor = 0;
        for (size_t l = 0; l < 6; l++)
          factor += c[6 * r + l] * strain[l];
        double *to = out + r * k;
        for (size_t j = 0; j < k; j++)
          to[j] += factor * u[j];
      }
    }
  }
}

/* Mean stress of element e by pressure. */
static void element_stress(const bwi_targets *t, int32_t e, double *out) {
  double gradient[10][3];
  int nodes = t->mesh->nodes_per_element;
  double volume = bwi_shape_integrals(t->mesh, e, gradient, NULL);
  for (int a = 0; a < nodes; a++)
    for (int j = 0; j < 3; j++)
      gradient[a][j] /= volume;
  memset(out, 0, 6 * (size_t)t->pressures * sizeof *out);
  add_stress(t, bw_material_elasticity(t->material, e), nodes,
             t->mesh->element + (size_t)e * (size_t)nodes, (const double(*)[3])gradient, out);
}

static bw_status corners_body(void *data, int64_t begin, int64_t end, int worker) {
  const bwi_targets *t = (const bwi_targets *)data;
  (void)worker;
  size_t k = (size_t)t->pressures;
  for (int64_t i = begin; i < end; i++) {
    double *out = t->at_corner + (size_t)i * 6 * k;
    const double *traction = t->traction + (size_t)(i / 3) * 3 * k;
    bwi_facet_corner at;
    bwi_facet_corner_load(t->mesh, t->material, (int32_t)i, &at);
    add_stress(t, at.elasticity, at.nodes, at.node, (const double(*)[3])at.gradient, out);
    for (size_t r = 0; r < 6; r++)
      for (size_t c = 0; c < 3; c++)
        for (size_t j = 0; j < k; j++)
          out[r * k + j] += at.by_traction[3 * r + c] * traction[c * k + j];
  }
  return BW_OK;
}

/* Corners of facets; mid-edge nodes have almost the same patches. */
static bw_status list_corners(bw_context *context, bwi_targets *t) {
  const bw_mesh *mesh = t->mesh;
  bool *corner = BW_NEW0(context, bool, mesh->node_count);
  t->node = BW_NEW(context, int32_t, mesh->boundary_node_count);
  if (!corner || !t->node) {
    bw_free(corner);
    return BW_MEMORY;
  }
  for (int32_t f = 0; f < mesh->facet_count; f++)
    for (int a = 0; a < 3; a++)
      corner[mesh->facet[(size_t)f * (size_t)mesh->nodes_per_facet + (size_t)a]] = true;
  for (int32_t i = 0; i < mesh->boundary_node_count; i++)
    if (corner[mesh->boundary_node[i]] &&
        bwi_surface_patch_exists(&t->patch, mesh->boundary_node[i]))
      t->node[t->count++] = mesh->boundary_node[i];
  bw_free(corner);
  return BW_OK;
}

bw_status bwi_targets_begin(bw_context *context, const bw_mesh *mesh, const bw_material *material,
                            const bw_dof_map *dof_map, int32_t pressures, const double *response,
                            const double *traction, double radius, bwi_targets *targets) {
  bw_status status = BW_OK;
  *targets = (bwi_targets){.mesh = mesh,
                           .material = material,
                           .pressures = pressures,
                           .response = response,
                           .traction = traction};
  if (radius == 0) {
    targets->count = mesh->element_count;
    return BW_OK;
  }
  BW_TRY(bwi_surface_patches_begin(context, mesh, dof_map, radius, &targets->patch));
  BW_TRY(list_corners(context, targets));
  targets->mark = BW_NEW0(context, int32_t, bw_threads(context));
  targets->at_corner = BW_NEW0(context, double, 18 * (size_t)mesh->facet_count * (size_t)pressures);
  if (!targets->mark || !targets->at_corner)
    return BW_MEMORY;
  BW_TRY(bw_parallel(context, 3 * (int64_t)mesh->facet_count, CORNERS_PER_CHUNK, corners_body,
                     targets));
done:
  return status;
}

void bwi_targets_clear(bwi_targets *targets) {
  bwi_surface_patches_clear(&targets->patch);
  bw_free(targets->node);
  bw_free(targets->at_corner);
  bw_free(targets->mark);
}

typedef struct mean {
  const bwi_targets *targets;
  double total, *sum;
} mean;

static void add_facet(void *data, int32_t facet, const double weight[3]) {
  mean *m = (mean *)data;
  size_t width = 6 * (size_t)m->targets->pressures;
  const double *stress = m->targets->at_corner + 3 * (size_t)facet * width;
  for (int a = 0; a < 3; a++, stress += width) {
    m->total += weight[a];
    for (size_t j = 0; j < width; j++)
      m->sum[j] += weight[a] * stress[j];
  }
}

void bwi_target_stress(const bwi_targets *t, int32_t target, int worker, double *out) {
  if (!t->node) {
    element_stress(t, target, out);
    return;
  }
  size_t width = 6 * (size_t)t->pressures;
  mean m = {t, 0, out};
  memset(out, 0, width * sizeof *out);
  bwi_surface_patch_visit(&t->patch, t->node[target], ++t->mark[worker], worker, add_facet, &m);
  for (size_t j = 0; j < width; j++)
    out[j] /= m.total;
}

int32_t bwi_targets_apart(const bwi_targets *t, int32_t wanted, int32_t *list) {
  int32_t count = 0;
  if (!t->node)
    return wanted < t->count ? wanted : t->count;
  for (int32_t i = 0; i < t->count && count < wanted; i++) {
    const double *x = t->mesh->node + 3 * (size_t)t->node[list[i]];
    bool apart = true;
    for (int32_t j = 0; j < count && apart; j++) {
      const double *y = t->mesh->node + 3 * (size_t)t->node[list[j]];
      double d[3] = {x[0] - y[0], x[1] - y[1], x[2] - y[2]};
      apart = bw_dot(d, d) > t->patch.radius * t->patch.radius;
    }
    if (apart)
      list[count++] = list[i];
  }
  return count;
}
