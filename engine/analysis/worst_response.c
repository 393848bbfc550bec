/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* Stresses by unit pressure: forward solves, one for each pressure, shared by all elements. There
 * are several times fewer pressures than components of element stresses, so this costs several
 * times less than an adjoint solve for each of these.
 *
 * The displacements of all nodes under all pressures may not fit into memory. Elements are sorted
 * along the longest side of the body's box; a slab is a run of them whose nodes' displacements fit.
 * Each slab repeats the solves. */
#include "analysis/weak_internal.h"
#include "analysis/worst_internal.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { CHUNK = 32, NODES_PER_TASK = 64 };

typedef struct placed {
  double at;
  int32_t element;
} placed;

static int by_place(const void *a, const void *b) {
  const placed *x = (const placed *)a, *y = (const placed *)b;
  if (x->at != y->at)
    return x->at < y->at ? -1 : 1;
  return (x->element > y->element) - (x->element < y->element);
}

static bw_status sort_elements(bwi_responses *r) {
  const bw_mesh *mesh = r->system->mesh;
  double low[3] = {INFINITY, INFINITY, INFINITY}, high[3] = {-INFINITY, -INFINITY, -INFINITY};
  int axis = 0, nodes = mesh->nodes_per_element;
  placed *list = BW_NEW(r->context, placed, mesh->element_count);
  if (!list)
    return BW_MEMORY;
  for (int32_t i = 0; i < mesh->node_count; i++)
    for (int k = 0; k < 3; k++) {
      low[k] = fmin(low[k], mesh->node[3 * (size_t)i + (size_t)k]);
      high[k] = fmax(high[k], mesh->node[3 * (size_t)i + (size_t)k]);
    }
  for (int k = 1; k < 3; k++)
    axis = high[k] - low[k] > high[axis] - low[axis] ? k : axis;
  for (int32_t e = 0; e < mesh->element_count; e++) {
    double sum = 0;
    for (int a = 0; a < 4; a++)
      sum += mesh->node[3 * (size_t)mesh->element[(size_t)e * (size_t)nodes + (size_t)a] +
                        (size_t)axis];
    list[e] = (placed){sum, e};
  }
  qsort(list, (size_t)mesh->element_count, sizeof *list, by_place);
  for (int32_t e = 0; e < mesh->element_count; e++)
    r->order[e] = list[e].element;
  bw_free(list);
  return BW_OK;
}

bw_status bwi_responses_open(bw_context *context, bw_system *system, const bw_pressure_basis *basis,
                             size_t max, bwi_responses *r) {
  const bw_mesh *mesh = system->mesh;
  *r = (bwi_responses){.context = context, .system = system, .basis = basis, .max = max};
  bw_status status = bw_material_fits(context, system->material, mesh->element_count);
  if (status != BW_OK)
    return status;
  r->order = BW_NEW(context, int32_t, mesh->element_count);
  r->place = BW_NEW(context, int32_t, mesh->node_count);
  r->node = BW_NEW(context, int32_t, mesh->node_count);
  r->block = BW_NEW(context, double, CHUNK * 3 * (size_t)mesh->node_count);
  if (!r->order || !r->place || !r->node || !r->block)
    return BW_MEMORY;
  return sort_elements(r);
}

void bwi_responses_close(bwi_responses *r) {
  bw_free(r->order);
  bw_free(r->place);
  bw_free(r->node);
  bw_free(r->displacement);
  bw_free(r->block);
}

/* Elements from `first` on, and their nodes, for as long as these fit: one batch at least. */
static void choose_slab(bwi_responses *r, int32_t batch) {
  const bw_mesh *mesh = r->system->mesh;
  int nodes = mesh->nodes_per_element;
  size_t bytes = 3 * sizeof(double) * (size_t)r->basis->count, fit = r->max / bytes;
  for (int32_t i = 0; i < mesh->node_count; i++)
    r->place[i] = -1;
  r->node_count = 0;
  while (r->first + r->count < mesh->element_count) {
    int32_t begin = r->first + r->count, end = begin + batch, former = r->node_count;
    end = end < mesh->element_count ? end : mesh->element_count;
    for (int32_t i = begin; i < end; i++)
      for (int a = 0; a < nodes; a++) {
        int32_t node = mesh->element[(size_t)r->order[i] * (size_t)nodes + (size_t)a];
        if (r->place[node] < 0) {
          r->place[node] = r->node_count;
          r->node[r->node_count++] = node;
        }
      }
    if (r->count > 0 && (size_t)r->node_count > fit) {
      r->node_count = former; /* places beyond are not asked for */
      return;
    }
    r->count += end - begin;
  }
}

static bw_status force_body(void *data, int64_t begin, int64_t end, int worker) {
  const bwi_responses *r = (const bwi_responses *)data;
  size_t n = 3 * (size_t)r->system->mesh->node_count;
  (void)worker;
  for (int64_t i = begin; i < end; i++) {
    double *force = r->block + (size_t)i * n;
    int32_t j = r->pressure + (int32_t)i;
    memset(force, 0, n * sizeof *force);
    for (int64_t k = r->basis->start[j]; k < r->basis->start[j + 1]; k++)
      for (int c = 0; c < 3; c++)
        force[3 * (size_t)r->basis->row[k] + (size_t)c] += r->basis->coefficient[3 * k + c];
  }
  return BW_OK;
}

static bw_status keep_body(void *data, int64_t begin, int64_t end, int worker) {
  const bwi_responses *r = (const bwi_responses *)data;
  size_t n = 3 * (size_t)r->system->mesh->node_count, count = (size_t)r->basis->count;
  (void)worker;
  for (int64_t i = begin; i < end; i++)
    for (size_t k = 0; k < 3; k++) {
      const double *from = r->block + 3 * (size_t)r->node[i] + k;
      double *to = r->displacement + (3 * (size_t)i + k) * count + r->pressure;
      for (int32_t c = 0; c < r->block_count; c++)
        to[c] = from[(size_t)c * n];
    }
  return BW_OK;
}

bw_status bwi_responses_next(bwi_responses *r, int32_t batch) {
  bw_status status = BW_OK;
  r->first += r->count;
  r->count = 0;
  choose_slab(r, batch);
  if (r->count == 0)
    return BW_OK;
  if (r->node_count > r->capacity) {
    bw_free(r->displacement);
    r->capacity = 0;
    r->displacement =
        BW_NEW(r->context, double, 3 * (size_t)r->node_count * (size_t)r->basis->count);
    if (!r->displacement)
      return BW_MEMORY;
    r->capacity = r->node_count;
  }
  for (r->pressure = 0; r->pressure < r->basis->count; r->pressure += CHUNK) {
    int32_t left = r->basis->count - r->pressure;
    r->block_count = left < CHUNK ? left : CHUNK;
    BW_TRY(bw_check_cancel(r->context));
    BW_TRY(bw_parallel(r->context, r->block_count, 1, force_body, r));
    BW_TRY(bw_system_solve(r->context, r->system, r->block_count, r->block, r->block));
    BW_TRY(bw_parallel(r->context, r->node_count, NODES_PER_TASK, keep_body, r));
  }
done:
  return status;
}

void bwi_response_of(const bwi_responses *r, int32_t element, double *response) {
  const bw_mesh *mesh = r->system->mesh;
  size_t count = (size_t)r->basis->count;
  int nodes = mesh->nodes_per_element;
  double gradient[10][3], s[6][6];
  double volume = bwi_shape_integrals(mesh, element, gradient, NULL);
  for (int c = 0; c < 6; c++) {
    double t[6] = {0};
    t[c] = (c < 3 ? 1 : 0.5) / volume;
    bwi_conjugate_stress(bw_material_elasticity(r->system->material, element), t, s[c]);
  }
  memset(response, 0, 6 * count * sizeof *response);
  for (int a = 0; a < nodes; a++) {
    int32_t node = mesh->element[(size_t)element * (size_t)nodes + (size_t)a];
    const double *u = r->displacement + 3 * (size_t)r->place[node] * count, *g = gradient[a];
    for (int c = 0; c < 6; c++) {
      const double *to = s[c], *v = u + count, *w = v + count;
      double x = to[0] * g[0] + to[5] * g[1] + to[4] * g[2];
      double y = to[5] * g[0] + to[1] * g[1] + to[3] * g[2];
      double z = to[4] * g[0] + to[3] * g[1] + to[2] * g[2];
      double *out = response + (size_t)c * count;
      for (size_t j = 0; j < count && (x != 0 || y != 0 || z != 0); j++)
        out[j] += x * u[j] + y * v[j] + z * w[j];
    }
  }
}
