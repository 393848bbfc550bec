/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* Entries of some domains: from coefficients, or gathered from node positions; then the sums at
 * shared pairs. What may fail is done before anything is written. */
#include "assemble/domain.h"

enum { ITEMS_PER_TASK = 1024, SHARED_PER_CHUNK = 512 };

bw_status bwi_domain_work_create(bw_context *context, bw_domain_stiffness *stiffness,
                                 bwi_domain_work *work) {
  int64_t domains = stiffness->domain_count;
  memset(work, 0, sizeof *work);
  work->stiffness = stiffness;
  work->action = BW_NEW0(context, uint8_t, domains);
  work->map = BW_NEW(context, double, 81 * domains);
  work->first_frame = BW_NEW(context, int64_t, domains + 1);
  return work->action && work->map && work->first_frame ? BW_OK : BW_MEMORY;
}

void bwi_domain_work_clear(bwi_domain_work *work) {
  bw_free(work->action);
  bw_free(work->map);
  bw_free(work->first_frame);
  bw_free(work->task);
  bw_free(work->frames.vector);
  memset(work, 0, sizeof *work);
}

/* The domains' sections cut into tasks. */
static bw_status list_tasks(bw_context *context, bwi_domain_work *work) {
  const bwi_domain_coefficients *c = work->stiffness->coefficients;
  for (int pass = 0; pass < 2; pass++) {
    int64_t count = 0;
    for (int64_t s = 0; s < 2 * (int64_t)work->stiffness->domain_count; s++) {
      if (work->action[s / 2] == BWI_DOMAIN_KEEP)
        continue;
      for (int64_t done = 0; done < c->section_count[s]; done += ITEMS_PER_TASK, count++)
        if (pass == 1) {
          int64_t left = c->section_count[s] - done;
          work->task[count] = (bwi_domain_task){s, c->section_start[s] + done,
                                                left < ITEMS_PER_TASK ? left : ITEMS_PER_TASK};
        }
    }
    work->task_count = count;
    if (pass == 0 && !(work->task = BW_NEW(context, bwi_domain_task, count)))
      return BW_MEMORY;
  }
  return BW_OK;
}

/* ---- frames of the domains to be gathered ---- */

typedef struct frames_data {
  bwi_domain_work *work;
  int32_t domain;
} frames_data;

static bw_status fill_frames(void *data, int64_t begin, int64_t end, int worker) {
  const frames_data *f = (const frames_data *)data;
  const bwi_domain_work *work = f->work;
  const bwi_domain_coefficients *c = work->stiffness->coefficients;
  (void)worker;
  for (int64_t k = begin; k < end; k++) {
    int32_t e = c->element[c->element_start[f->domain] + k];
    bwi_vector *h = work->frames.vector + (work->first_frame[f->domain] + k) * work->frames.vectors;
    if (work->mesh->order == 2) {
      double x[10][3];
      bwi_element_nodes(work->mesh, e, x);
      if (!bw_tet_is_straight((const double(*)[3])x))
        return BW_INVALID;
    }
    if (!(bwi_element_frame(work->mesh, e, h) > 0))
      return BW_GEOMETRY;
  }
  return BW_OK;
}

/* Name the first element that fill_frames refused. */
static bw_status name_refused(bw_context *context, const bw_mesh *mesh,
                              const bwi_domain_coefficients *c, int32_t domain) {
  for (int32_t k = c->element_start[domain]; k < c->element_start[domain + 1]; k++) {
    int32_t e = c->element[k];
    double x[10][3];
    bwi_vector h[10];
    bwi_element_nodes(mesh, e, x);
    if (mesh->order == 2 && !bw_tet_is_straight((const double(*)[3])x)) {
      bw_status status =
          bw_fail(context, BW_INVALID,
                  "element %d near (%g, %g, %g) m has a middle node that is not half-way along its "
                  "edge; only straight edges have a closed form, so put middle nodes half-way",
                  e, x[4][0], x[4][1], x[4][2]);
      bw_detail_number(context, "element", e);
      return status;
    }
    double determinant = bwi_element_frame(mesh, e, h);
    if (!(determinant > 0))
      return bwi_fail_inverted(context, mesh, e, determinant);
  }
  return bw_fail(context, BW_INTERNAL, "an element of domain %d was refused and not found again",
                 domain);
}

bw_status bwi_domain_work_prepare(bw_context *context, const bw_mesh *mesh, bwi_domain_work *work) {
  bw_status status = BW_OK;
  const bwi_domain_coefficients *c = work->stiffness->coefficients;
  const bw_graph *graph = work->stiffness->graph;
  work->mesh = mesh;
  work->source.graph = graph;
  work->source.frames = &work->frames;
  work->source.contributions = graph->gather_start[graph->pair_count];
  bwi_product_table(mesh->order, work->source.table);
  work->frames.mesh = mesh;
  work->frames.vectors = mesh->order == 1 ? 4 : 10;
  BW_TRY(list_tasks(context, work));
  int64_t count = 0;
  for (int32_t d = 0; d < work->stiffness->domain_count; d++) {
    work->first_frame[d] = count;
    if (work->action[d] == BWI_DOMAIN_GATHER)
      count += c->element_start[d + 1] - c->element_start[d];
  }
  if (!count)
    goto done;
  work->frames.vector = BW_NEW(context, bwi_vector, count * work->frames.vectors);
  if (!work->frames.vector) {
    status = BW_MEMORY;
    goto done;
  }
  for (int32_t d = 0; d < work->stiffness->domain_count; d++)
    if (work->action[d] == BWI_DOMAIN_GATHER) {
      frames_data f = {work, d};
      status = bw_parallel(context, c->element_start[d + 1] - c->element_start[d], 1024,
                           fill_frames, &f);
      if (status == BW_INVALID || status == BW_GEOMETRY)
        status = name_refused(context, mesh, c, d);
      if (status != BW_OK)
        goto done;
    }
done:
  return status;
}

/* ---- entries ---- */

static inline int64_t pair_of(const bwi_domain_coefficients *c, int64_t section, int64_t item) {
  uint32_t index = c->place[item] >> 1;
  return section & 1 ? c->shared_pair[c->slot_shared[index]] : index;
}

static bwi_element_range range_of(const bwi_domain_work *work, int64_t domain) {
  const bwi_domain_coefficients *c = work->stiffness->coefficients;
  return (bwi_element_range){
      c->number, c->element_start[domain], c->element_start[domain + 1] - c->element_start[domain],
      work->frames.vector + work->first_frame[domain] * work->frames.vectors};
}

static bw_status rest_tasks(void *data, int64_t begin, int64_t end, int worker) {
  bwi_domain_work *work = (bwi_domain_work *)data;
  bwi_domain_coefficients *c = work->stiffness->coefficients;
  (void)worker;
  for (const bwi_domain_task *task = work->task + begin; task < work->task + end; task++) {
    bwi_element_range range = range_of(work, task->section / 2);
    for (int64_t k = task->first; k < task->first + task->count; k++) {
      double t[3][4];
      bool diagonal = c->place[k] & 1;
      bwi_sum_pair(&work->source, &range, pair_of(c, task->section, k), diagonal, t);
      if (diagonal) { /* symmetric but for rounding */
        t[1][0] = t[0][1];
        t[2][0] = t[0][2];
        t[2][1] = t[1][2];
      }
      double *tensor = c->tensor + 9 * (k & ~(int64_t)3) + (k & 3);
      for (int m = 0; m < 9; m++)
        tensor[4 * m] = t[m / 3][m % 3];
    }
  }
  return BW_OK;
}

bw_status bwi_domain_gather_rest(bw_context *context, bwi_domain_work *work) {
  return bw_parallel(context, work->task_count, 1, rest_tasks, work);
}

static void gather_task(const bwi_domain_work *work, const bwi_domain_task *task, double *out) {
  const bwi_domain_coefficients *c = work->stiffness->coefficients;
  const bw_material *material = work->stiffness->material;
  const double *elasticity = work->map + 81 * (task->section / 2);
  bwi_element_range range = range_of(work, task->section / 2);
  bwi_vector map[9][3];
  for (int jl = 0; jl < 9; jl++)
    for (int i = 0; i < 3; i++) {
      map[jl][i][3] = 0;
      for (int k = 0; k < 3; k++)
        map[jl][i][k] = elasticity[9 * (3 * i + k) + jl];
    }
  for (int64_t k = task->first; k < task->first + task->count; k++) {
    double t[3][4], *block = out + 9 * (int64_t)(c->place[k] >> 1);
    bool diagonal = c->place[k] & 1;
    bwi_sum_pair(&work->source, &range, pair_of(c, task->section, k), diagonal, t);
    if (material->isotropic)
      bwi_apply_isotropic(material->lame_lambda, material->lame_mu, t, block);
    else
      bwi_apply_general(map, t, block);
    if (diagonal)
      bwi_make_symmetric(block);
  }
}

static bw_status write_tasks(void *data, int64_t begin, int64_t end, int worker) {
  bwi_domain_work *work = (bwi_domain_work *)data;
  const bwi_domain_coefficients *c = work->stiffness->coefficients;
  (void)worker;
  for (const bwi_domain_task *task = work->task + begin; task < work->task + end; task++) {
    int64_t d = task->section / 2;
    double *out = task->section & 1 ? c->slot : work->stiffness->values;
    if (work->action[d] == BWI_DOMAIN_GATHER)
      gather_task(work, task, out);
    else
      bwi_domain_evaluate(c, work->map + 81 * d, task->first, task->count, out);
  }
  return BW_OK;
}

static bool touched(const bwi_domain_work *work, int64_t shared) {
  const bwi_domain_coefficients *c = work->stiffness->coefficients;
  for (int64_t k = c->shared_start[shared]; k < c->shared_start[shared + 1]; k++)
    if (work->action[c->slot_domain[k]] != BWI_DOMAIN_KEEP)
      return true;
  return false;
}

static bw_status sum_shared(void *data, int64_t begin, int64_t end, int worker) {
  bwi_domain_work *work = (bwi_domain_work *)data;
  const bwi_domain_coefficients *c = work->stiffness->coefficients;
  (void)worker;
  for (int64_t p = begin; p < end; p++) {
    if (!touched(work, p))
      continue;
    double sum[9];
    memcpy(sum, c->slot + 9 * c->shared_start[p], sizeof sum);
    for (int64_t k = c->shared_start[p] + 1; k < c->shared_start[p + 1]; k++)
      for (int r = 0; r < 9; r++)
        sum[r] += c->slot[9 * k + r];
    memcpy(work->stiffness->values + 9 * (int64_t)c->shared_pair[p], sum, sizeof sum);
  }
  return BW_OK;
}

bw_status bwi_domain_write(bw_context *context, bwi_domain_work *work) {
  bw_status status = BW_OK;
  const bwi_domain_coefficients *c = work->stiffness->coefficients;
  BW_TRY(bw_parallel(context, work->task_count, 1, write_tasks, work));
  BW_TRY(bw_parallel(context, c->shared_count, SHARED_PER_CHUNK, sum_shared, work));
  work->pairs = 0;
  for (int32_t d = 0; d < work->stiffness->domain_count; d++)
    if (work->action[d] != BWI_DOMAIN_KEEP)
      work->pairs += c->section_count[2 * (int64_t)d];
  for (int64_t p = 0; p < c->shared_count; p++)
    work->pairs += touched(work, p);
done:
  return status;
}

void bwi_domain_elasticity(const bw_domain_stiffness *stiffness, const double frame[9],
                           double elasticity[81]) {
  const bwi_domain_coefficients *c = stiffness->coefficients;
  if (!c->turning_matters || !stiffness->material_turns) {
    memcpy(elasticity, c->elasticity, sizeof c->elasticity);
    return;
  }
  double rotation[9];
  for (int r = 0; r < 3; r++)
    for (int s = 0; s < 3; s++)
      rotation[3 * r + s] = frame[3 * s + r];
  bwi_turn_elasticity(c->elasticity, rotation, elasticity);
}
