/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* Entries of some domains: from coefficients, or gathered from node positions. What may fail is
 * done before anything is written. */
#include "assemble/domain.h"

enum { PIECES_PER_CHUNK = 4, ELEMENTS_PER_CHUNK = 256 };

bw_status bwi_domain_work_create(bw_context *context, bw_domain_stiffness *stiffness,
                                 bwi_domain_work *work) {
  int64_t domains = stiffness->domain_count;
  memset(work, 0, sizeof *work);
  work->stiffness = stiffness;
  work->action = BW_NEW0(context, uint8_t, domains);
  work->first_element = BW_NEW(context, int64_t, domains + 1);
  work->touched = BW_NEW0(context, bool, stiffness->coefficients->section_count);
  return work->action && work->first_element && work->touched ? BW_OK : BW_MEMORY;
}

void bwi_domain_work_clear(bwi_domain_work *work) {
  bw_free(work->action);
  bw_free(work->first_element);
  bw_free(work->touched);
  memset(work, 0, sizeof *work);
}

/* The sections that a domain with an action has part in. */
static void list_touched(bwi_domain_work *work) {
  const bwi_domain_coefficients *c = work->stiffness->coefficients;
  for (int64_t s = 0; s < c->section_count; s++) {
    for (int64_t b = c->block_start[s]; b < c->block_start[s + 1]; b++)
      work->touched[s] = work->touched[s] || work->action[c->block_domain[b]] != BWI_DOMAIN_KEEP;
    if (work->touched[s])
      work->pairs += c->section_size[s];
  }
}

/* ---- frames of the domains to be gathered ---- */

static bw_status fill_frames(void *data, int64_t begin, int64_t end, int worker) {
  const bwi_domain_work *work = (const bwi_domain_work *)data;
  const bwi_domain_coefficients *c = work->stiffness->coefficients;
  int32_t domain = 0;
  (void)worker;
  for (int64_t k = begin; k < end; k++) {
    while (work->first_element[domain + 1] <= k)
      domain++;
    int32_t e = c->element[c->element_start[domain] + k - work->first_element[domain]];
    if (work->mesh->order == 2) {
      double x[10][3];
      bwi_element_nodes(work->mesh, e, x);
      if (!bw_tet_is_straight((const double(*)[3])x))
        return BW_INVALID;
    }
    if (!(bwi_element_frame(work->mesh, e, c->frame + (int64_t)e * work->frames.vectors) > 0))
      return BW_GEOMETRY;
  }
  return BW_OK;
}

/* Name the first element of a gathered domain that fill_frames refused. */
static bw_status name_refused(bw_context *context, const bwi_domain_work *work) {
  const bw_mesh *mesh = work->mesh;
  const bwi_domain_coefficients *c = work->stiffness->coefficients;
  for (int64_t k = 0; k < mesh->element_count; k++) {
    int32_t e = c->element[k];
    if (work->action[c->domain_of[e]] != BWI_DOMAIN_GATHER)
      continue;
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
  return bw_fail(context, BW_INTERNAL, "an element was refused and not found again");
}

bw_status bwi_domain_work_prepare(bw_context *context, const bw_mesh *mesh, bwi_domain_work *work) {
  const bwi_domain_coefficients *c = work->stiffness->coefficients;
  const bw_graph *graph = work->stiffness->graph;
  work->mesh = mesh;
  work->source.graph = graph;
  work->source.frames = &work->frames;
  work->source.contributions = graph->gather_start[graph->pair_count];
  bwi_product_table(mesh->order, work->source.table);
  work->frames.mesh = mesh;
  work->frames.vectors = mesh->order == 1 ? 4 : 10;
  work->frames.vector = c->frame;
  list_touched(work);
  int32_t domains = work->stiffness->domain_count;
  work->first_element[0] = 0;
  for (int32_t d = 0; d < domains; d++)
    work->first_element[d + 1] =
        work->first_element[d] +
        (work->action[d] == BWI_DOMAIN_GATHER ? c->element_start[d + 1] - c->element_start[d] : 0);
  bw_status status =
      bw_parallel(context, work->first_element[domains], ELEMENTS_PER_CHUNK, fill_frames, work);
  return status == BW_INVALID || status == BW_GEOMETRY ? name_refused(context, work) : status;
}

/* ---- tensors and entries ---- */

static bw_status gather_rest(void *data, int64_t begin, int64_t end, int worker) {
  const bwi_domain_work *work = (const bwi_domain_work *)data;
  const bwi_domain_coefficients *c = work->stiffness->coefficients;
  (void)worker;
  for (const bwi_domain_piece *piece = c->piece + begin; piece < c->piece + end; piece++) {
    int64_t first = c->block_start[piece->section];
    for (int64_t b = first; b < c->block_start[piece->section + 1]; b++)
      bwi_domain_gather_tensors(work, piece, c->block_domain[b],
                                bwi_domain_rest(c, piece, b - first));
  }
  return BW_OK;
}

static bw_status write_pieces(void *data, int64_t begin, int64_t end, int worker) {
  const bwi_domain_work *work = (const bwi_domain_work *)data;
  const bwi_domain_coefficients *c = work->stiffness->coefficients;
  double *values = work->stiffness->values;
  (void)worker;
  for (int64_t k = begin; k < end; k++) {
    const bwi_domain_piece *piece = &c->piece[c->chosen[k]];
    const int32_t *domain = c->block_domain + c->block_start[piece->section];
    bool inside = piece->section < c->inside_count;
    if (inside && work->action[*domain] == BWI_DOMAIN_GATHER) {
      bwi_domain_gather_entries(work, piece, values);
      continue;
    }
    int64_t domains = c->block_start[piece->section + 1] - c->block_start[piece->section];
    for (int64_t j = 0; !inside && j < domains; j++)
      if (work->action[domain[j]] == BWI_DOMAIN_GATHER)
        bwi_domain_gather_tensors(work, piece, domain[j], bwi_domain_present(c, piece, j));
    bwi_domain_evaluate(c, piece, values);
  }
  return BW_OK;
}

bw_status bwi_domain_gather_rest(bw_context *context, bwi_domain_work *work) {
  bw_status status = bw_parallel(context, work->stiffness->coefficients->piece_count,
                                 PIECES_PER_CHUNK, gather_rest, work);
  memset(work->action, BWI_DOMAIN_EVALUATE, (size_t)work->stiffness->domain_count);
  return status;
}

bw_status bwi_domain_write(bw_context *context, bwi_domain_work *work) {
  const bwi_domain_coefficients *c = work->stiffness->coefficients;
  int64_t count = 0;
  for (int64_t p = 0; p < c->piece_count; p++)
    if (work->touched[c->piece[p].section])
      c->chosen[count++] = p;
  return bw_parallel(context, count, PIECES_PER_CHUNK, write_pieces, work);
}
