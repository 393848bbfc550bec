/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* 2 x 2 x 2 cells become one, and values go between the two grids.
 *
 * Invariants: child[8 parent[e] + octant of e's cell] = e, other entries are -1. A fine node lies
 * at a corner, in the middle of an edge or face, or at the centre of a coarse element: the
 * trilinear weights there are 1, 1/2, 1/4, 1/8, that is, the mean over eight entries of the
 * stencil. Coarse elements that share a face agree on the stencil of nodes on it. */
#include "grid/internal.h"

#include <string.h>

static void destroy(void *object) {
  bw_coarsening *it = (bw_coarsening *)object;
  bw_release(it->fine);
  bw_release(it->coarse);
  bw_free(it->parent);
  bw_free(it->child);
  bw_free(it->stencil);
  bw_free(it);
}

static size_t bytes(const void *object) {
  const bw_coarsening *it = (const bw_coarsening *)object;
  return sizeof *it + sizeof(int32_t) *
                          ((size_t)it->fine->element_count + 8 * (size_t)it->coarse->element_count +
                           8 * (size_t)it->fine->node_count);
}

static const bw_kind coarsening_kind = {"coarsening", destroy, bytes};

/* The coarse cell of a fine one, and the octant in it. */
static int64_t parent_cell(const bw_grid *fine, const int32_t coarse[3], int32_t cell,
                           int *octant) {
  int32_t place[3];
  bwi_grid_place(fine->cells, cell, place);
  *octant = (place[0] & 1) | (place[1] & 1) << 1 | (place[2] & 1) << 2;
  return place[0] / 2 + (int64_t)coarse[0] * (place[1] / 2 + (int64_t)coarse[1] * (place[2] / 2));
}

static bw_status make_coarse(bw_context *context, const bw_grid *fine, bw_grid **coarse) {
  bw_status status = BW_OK;
  int32_t cells[3];
  double spacing[3];
  for (int d = 0; d < 3; d++) {
    cells[d] = fine->cells[d] / 2 + fine->cells[d] % 2;
    spacing[d] = 2 * fine->spacing[d];
  }
  int32_t *material = BW_NEW0(context, int32_t, bwi_grid_cells(cells));
  if (!material)
    return BW_MEMORY;
  for (int32_t e = 0; e < fine->element_count; e++) {
    int octant;
    material[parent_cell(fine, cells, fine->cell[e], &octant)] = 1;
  }
  BW_TRY(bw_grid_create(context, fine->origin, spacing, cells, material, NULL, coarse));
done:
  bw_free(material);
  return status;
}

/* The stencils of the corners of a fine element in this octant of a coarse one. */
static void fill_stencils(bw_coarsening *it, int32_t element, int octant) {
  const int32_t *corner = it->coarse->element + 8 * (int64_t)it->parent[element];
  for (int c = 0; c < 8; c++) {
    int32_t *stencil = it->stencil + 8 * (int64_t)it->fine->element[8 * (int64_t)element + c];
    if (stencil[0] >= 0)
      continue;
    /* Where both bits agree the node is at an end of the coarse cell, else in its middle, where
     * both ends count. */
    int fixed = ~(octant ^ c), at = octant & c;
    for (int q = 0; q < 8; q++)
      stencil[q] = corner[((q & ~fixed) | (at & fixed)) & 7];
  }
}

bw_status bw_coarsening_create(bw_context *context, const bw_grid *fine, bw_coarsening **out) {
  bw_status status = BW_OK;
  bw_coarsening *it = BW_NEW0(context, bw_coarsening, 1);
  bw_grid *coarse = NULL;
  if (!it)
    return BW_MEMORY;
  bw_object_init(it, &coarsening_kind);
  it->fine = (const bw_grid *)bw_retain(fine);
  BW_TRY(make_coarse(context, fine, &coarse));
  it->coarse = coarse;
  it->parent = BW_NEW(context, int32_t, fine->element_count);
  it->child = BW_NEW(context, int32_t, 8 * (int64_t)coarse->element_count);
  it->stencil = BW_NEW(context, int32_t, 8 * (int64_t)fine->node_count);
  BW_TRY_MEMORY(it->parent && it->child && it->stencil);
  memset(it->child, -1, 8 * (size_t)coarse->element_count * sizeof *it->child);
  memset(it->stencil, -1, 8 * (size_t)fine->node_count * sizeof *it->stencil);
  for (int32_t e = 0; e < fine->element_count; e++) {
    int octant;
    it->parent[e] = coarse->at[parent_cell(fine, coarse->cells, fine->cell[e], &octant)];
    it->child[8 * (int64_t)it->parent[e] + octant] = e;
    fill_stencils(it, e, octant);
  }
  *out = it;
  it = NULL;
done:
  bw_release(it);
  return status;
}

void bw_coarsening_prolong(const bw_coarsening *it, int components, const double *coarse,
                           double *fine) {
  for (int64_t n = 0; n < it->fine->node_count; n++) {
    const int32_t *s = it->stencil + 8 * n;
    for (int i = 0; i < components; i++) {
      double v[8];
      for (int q = 0; q < 8; q++)
        v[q] = coarse[(int64_t)components * s[q] + i];
      /* In pairs, so that equal values come out as they are. */
      fine[components * n + i] =
          (((v[0] + v[1]) + (v[2] + v[3])) + ((v[4] + v[5]) + (v[6] + v[7]))) / 8;
    }
  }
}

void bw_coarsening_restrict(const bw_coarsening *it, int components, const double *fine,
                            double *coarse) {
  memset(coarse, 0, (size_t)it->coarse->node_count * (size_t)components * sizeof *coarse);
  for (int64_t n = 0; n < it->fine->node_count; n++) {
    const int32_t *s = it->stencil + 8 * n;
    for (int q = 0; q < 8; q++)
      for (int i = 0; i < components; i++)
        coarse[(int64_t)components * s[q] + i] += fine[components * n + i] / 8;
  }
}
