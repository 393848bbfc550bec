/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* Entries of some subdomains: from coefficients, or gathered from node positions. What may fail is
 * done before anything is written. */
#include "assemble/subdomain.h"

enum { SEGMENTS_PER_CHUNK = 16 };

bw_status bwi_subdomain_work_create(bw_context *context, bw_subdomain_stiffness *stiffness,
                                    bwi_subdomain_work *work) {
  int64_t subdomains = stiffness->subdomain_count;
  memset(work, 0, sizeof *work);
  work->stiffness = stiffness;
  work->action = BW_NEW0(context, uint8_t, subdomains);
  work->first_frame = BW_NEW(context, int64_t, subdomains + 1);
  work->touched = BW_NEW0(context, bool, stiffness->coefficients->section_count);
  return work->action && work->first_frame && work->touched ? BW_OK : BW_MEMORY;
}

void bwi_subdomain_work_clear(bwi_subdomain_work *work) {
  bw_free(work->action);
  bw_free(work->first_frame);
  bw_free(work->touched);
  bw_free(work->frames.vector);
  memset(work, 0, sizeof *work);
}

/* The sections that a subdomain with an action has part in. */
static void list_touched(bwi_subdomain_work *work) {
  const bwi_subdomain_coefficients *c = work->stiffness->coefficients;
  for (int64_t s = 0; s < c->section_count; s++) {
    for (int64_t b = c->section_start[s]; b < c->section_start[s + 1]; b++)
      work->touched[s] =
          work->touched[s] || work->action[c->section_subdomain[b]] != BWI_SUBDOMAIN_KEEP;
    if (work->touched[s])
      work->blocks += c->section_size[s];
  }
}

/* ---- frames of the subdomains to be gathered ---- */

typedef struct frames_data {
  bwi_subdomain_work *work;
  int32_t subdomain;
} frames_data;

static bw_status fill_frames(void *data, int64_t begin, int64_t end, int worker) {
  const frames_data *f = (const frames_data *)data;
  const bwi_subdomain_work *work = f->work;
  const bwi_subdomain_coefficients *c = work->stiffness->coefficients;
  (void)worker;
  for (int64_t k = begin; k < end; k++) {
    int32_t e = c->element[c->element_start[f->subdomain] + k];
    bwi_vector *h =
        work->frames.vector + (work->first_frame[f->subdomain] + k) * work->frames.vectors;
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
                              const bwi_subdomain_coefficients *c, int32_t subdomain) {
  for (int32_t k = c->element_start[subdomain]; k < c->element_start[subdomain + 1]; k++) {
    int32_t e = c->element[k];
    double x[10][3];
    bwi_vector h[10];
    bwi_element_nodes(mesh, e, x);
    if (mesh->order == 2 && !bw_tet_is_straight((const double(*)[3])x)) {
      bw_status status = bw_fail(
          context, BW_INVALID,
          "element %d near (%g, %g, %g) m has a mid-edge node that is not at the midpoint of its "
          "edge: only straight edges have a closed form; move mid-edge nodes to the midpoints",
          e + 1, x[4][0], x[4][1], x[4][2]);
      bw_detail_number(context, "element", e + 1.0);
      return status;
    }
    double determinant = bwi_element_frame(mesh, e, h);
    if (!(determinant > 0))
      return bwi_fail_inverted(context, mesh, e, determinant);
  }
  return bw_fail(context, BW_INTERNAL, "an element of subdomain %d was refused and not found again",
                 subdomain + 1);
}

bw_status bwi_subdomain_work_prepare(bw_context *context, const bw_mesh *mesh,
                                     bwi_subdomain_work *work) {
  bw_status status = BW_OK;
  const bwi_subdomain_coefficients *c = work->stiffness->coefficients;
  work->mesh = mesh;
  bwi_product_table(mesh->order, work->table);
  work->frames.mesh = mesh;
  work->frames.vectors = mesh->order == 1 ? 4 : 10;
  list_touched(work);
  int64_t count = 0;
  for (int32_t d = 0; d < work->stiffness->subdomain_count; d++) {
    work->first_frame[d] = count;
    if (work->action[d] == BWI_SUBDOMAIN_GATHER)
      count += c->element_start[d + 1] - c->element_start[d];
  }
  if (!count)
    goto done;
  work->frames.vector = BW_NEW(context, bwi_vector, count * work->frames.vectors);
  BW_TRY_MEMORY(work->frames.vector);
  for (int32_t d = 0; d < work->stiffness->subdomain_count; d++)
    if (work->action[d] == BWI_SUBDOMAIN_GATHER) {
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

/* ---- tensors and entries ---- */

static bwi_element_range range_of(const bwi_subdomain_work *work, int64_t subdomain) {
  const bwi_subdomain_coefficients *c = work->stiffness->coefficients;
  return (bwi_element_range){c->number,
                             c->element_start[subdomain],
                             c->element_start[subdomain + 1] - c->element_start[subdomain],
                             work->frames.vector +
                                 work->first_frame[subdomain] * work->frames.vectors,
                             work->frames.vectors,
                             work->table};
}

/* T of a segment's j-th subdomain into `to`. */
static void gather_tensors(const bwi_subdomain_work *work, const bwi_subdomain_segment *segment,
                           int32_t subdomain, double *to) {
  const uint32_t *code = work->stiffness->coefficients->block_code + segment->first;
  bwi_element_range range = range_of(work, subdomain);
  int numbers = segment->numbers;
  for (int64_t k = 0; k < segment->size; k++) {
    bwi_vector t[3];
    double *tensor = to + numbers * (k & ~(int64_t)3) + (k & 3);
    bool diagonal = code[k] & 1;
    bwi_sum_block(work->stiffness->coefficients->contributions, &range, code[k] >> 1, diagonal, t);
    bwi_subdomain_halves(t, numbers, tensor);
    if (diagonal) /* symmetric but for rounding */
      for (int m = 6; m < numbers; m++)
        tensor[4 * m] = 0;
  }
}

static bw_status gather_rest(void *data, int64_t begin, int64_t end, int worker) {
  const bwi_subdomain_work *work = (const bwi_subdomain_work *)data;
  const bwi_subdomain_coefficients *c = work->stiffness->coefficients;
  (void)worker;
  for (const bwi_subdomain_segment *segment = c->segment + begin; segment < c->segment + end;
       segment++) {
    int64_t first = c->section_start[segment->section];
    for (int64_t b = first; b < c->section_start[segment->section + 1]; b++)
      gather_tensors(work, segment, c->section_subdomain[b],
                     bwi_subdomain_rest(c, segment, b - first));
  }
  return BW_OK;
}

/* Entries inside a gathered subdomain, straight from its frames. */
static void gather_inside(const bwi_subdomain_work *work, const bwi_subdomain_segment *segment,
                          int32_t subdomain) {
  const bwi_subdomain_coefficients *c = work->stiffness->coefficients;
  const bw_material *material =
      bw_material_of(work->stiffness->material, c->element[c->element_start[subdomain]]);
  const uint32_t *code = c->block_code + segment->first;
  bwi_element_range range = range_of(work, subdomain);
  bwi_vector map[9][3] = {{{0}}};
  if (!material->isotropic) {
    double elasticity[81];
    bwi_subdomain_elasticity(work->stiffness, subdomain, c->written[subdomain].frame, elasticity);
    for (int jl = 0; jl < 9; jl++)
      for (int i = 0; i < 3; i++)
        for (int k = 0; k < 3; k++)
          map[jl][i][k] = elasticity[9 * (3 * i + k) + jl];
  }
  for (int64_t k = 0; k < segment->size; k++) {
    bwi_vector t[3];
    double *block = work->stiffness->values + 9 * (int64_t)(code[k] >> 1);
    bool diagonal = code[k] & 1;
    bwi_sum_block(work->stiffness->coefficients->contributions, &range, code[k] >> 1, diagonal, t);
    if (material->isotropic)
      bwi_apply_isotropic(material->lame_lambda, material->lame_mu, t, block);
    else
      bwi_apply_general(map, t, block);
    if (diagonal)
      bwi_make_symmetric(block);
  }
}

static bw_status write_segments(void *data, int64_t begin, int64_t end, int worker) {
  const bwi_subdomain_work *work = (const bwi_subdomain_work *)data;
  const bwi_subdomain_coefficients *c = work->stiffness->coefficients;
  (void)worker;
  for (const bwi_subdomain_segment *segment = c->segment + begin; segment < c->segment + end;
       segment++) {
    if (!work->touched[segment->section])
      continue;
    const int32_t *subdomain = c->section_subdomain + c->section_start[segment->section];
    int64_t subdomains =
        c->section_start[segment->section + 1] - c->section_start[segment->section];
    if (subdomains == 1 && work->action[*subdomain] == BWI_SUBDOMAIN_GATHER) {
      gather_inside(work, segment, *subdomain);
      continue;
    }
    for (int64_t j = 0; subdomains > 1 && j < subdomains; j++)
      if (work->action[subdomain[j]] == BWI_SUBDOMAIN_GATHER)
        gather_tensors(work, segment, subdomain[j], bwi_subdomain_present(c, segment, j));
    bwi_subdomain_evaluate(c, segment, work->stiffness->values);
  }
  return BW_OK;
}

bw_status bwi_subdomain_gather_rest(bw_context *context, bwi_subdomain_work *work) {
  bw_status status = bw_parallel(context, work->stiffness->coefficients->segment_count,
                                 SEGMENTS_PER_CHUNK, gather_rest, work);
  memset(work->action, BWI_SUBDOMAIN_EVALUATE, (size_t)work->stiffness->subdomain_count);
  return status;
}

bw_status bwi_subdomain_write(bw_context *context, bwi_subdomain_work *work) {
  return bw_parallel(context, work->stiffness->coefficients->segment_count, SEGMENTS_PER_CHUNK,
                     write_segments, work);
}
