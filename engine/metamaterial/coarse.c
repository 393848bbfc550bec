/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* Grids made coarse: each block of 8 or 64 fine elements becomes one, whose material its key
 * decides.
 *
 * Only materials that occur are made. Their rows of the material table are numbered in the order in
 * which blocks first have them, so that what an edit leads to does not depend on the way there. A
 * block with partial cells has a row of its own, since its constants are scaled point by point.
 *
 * Invariant: inner->key has the key of row r at width (r - 1), its first entry -1 for a row of a
 * block with partial cells, which no other block may share. */
#include "metamaterial/coarse.h"

#include <string.h>

#include "grid/internal.h"

static void destroy(void *object) {
  bw_coarse *it = (bw_coarse *)object;
  bw_release(it->library);
  bw_release(it->fine_material_table);
  bw_release(it->fine);
  bw_release(it->grid);
  bw_release(it->material_table);
  for (int l = 0; l < 2; l++)
    bw_release(it->coarsening[l]);
  if (it->inner)
    bw_free(it->inner->key);
  bw_free(it->inner);
  bw_free(it);
}

static size_t bytes(const void *object) {
  const bw_coarse *it = (const bw_coarse *)object;
  return sizeof *it + sizeof *it->inner +
         sizeof(int32_t) * (size_t)it->inner->width * (size_t)(it->material_table->count - 1);
}

static const bw_kind coarse_kind = {"coarse", destroy, bytes};

/* ---- blocks --------------------------------------------------------------------------------- */

static void gather_child(const bw_grid *fine, const int32_t *child, int first,
                         bwi_fine_block *block) {
  for (int c = 0; c < 8; c++) {
    int32_t e = child ? child[c] : -1;
    block->key[first + c] = e < 0 ? 0 : fine->material[e];
    block->fraction[first + c] = e < 0 || !fine->fraction ? 1 : fine->fraction[e];
    block->partial = block->partial || block->fraction[first + c] < 1;
  }
}

void bwi_block_gather(const bw_grid *fine, const bw_coarsening *const *coarsening, int levels,
                      int32_t element, bwi_fine_block *block) {
  const int32_t *child = coarsening[levels - 1]->child + 8 * (int64_t)element;
  block->partial = false;
  if (levels == 1)
    gather_child(fine, child, 0, block);
  for (int c = 0; levels == 2 && c < 8; c++)
    gather_child(fine, child[c] < 0 ? NULL : coarsening[0]->child + 8 * (int64_t)child[c], 8 * c,
                 block);
}

/* Number the materials in the order of first use, and make material table, keys and the coarse
 * grid. */
static bw_status finish(bw_context *context, bw_coarse *it, const bwi_rows *list, int32_t *id) {
  bw_status status = BW_OK;
  const bw_grid *shape = it->coarsening[it->levels - 1]->coarse;
  bw_material_table *material_table = NULL;
  bw_grid *grid = NULL;
  int32_t count = 0, *row = BW_NEW0(context, int32_t, list->count + 1);
  const bw_solid_material **used = BW_NEW(context, const bw_solid_material *, list->count);
  int32_t *material = BW_NEW(context, int32_t, shape->element_count);
  size_t w = (size_t)list->width;
  it->inner->key = BW_NEW(context, int32_t, w * (size_t)list->count);
  BW_TRY_MEMORY(row && used && material && it->inner->key);
  for (int32_t e = 0; e < shape->element_count; e++) {
    if (!row[id[e]]) {
      size_t from = (size_t)(id[e] - 1);
      used[count] = list->material[from];
      memcpy(it->inner->key + w * (size_t)count, list->key + w * from, w * sizeof *list->key);
      row[id[e]] = ++count;
    }
    material[e] = row[id[e]];
  }
  BW_TRY(bw_material_table_create(context, count + 1, used, &material_table));
  it->material_table = material_table;
  BW_TRY(bw_grid_with_materials(context, shape, material, &grid));
  it->grid = grid;
done:
  bw_free(row);
  bw_free((void *)used);
  bw_free(material);
  return status;
}

static bw_status check_materials(bw_context *context, const bw_material_table *material_table,
                                 const bw_grid *fine) {
  for (int32_t i = 1; i < material_table->count; i++)
    if (material_table->material[i]->b_bar)
      return bw_fail(context, BW_INVALID,
                     "material %d (%s) is of the B-bar formulation: only grids of the standard one "
                     "are coarsened",
                     (int)i, material_table->material[i]->name);
    else if (!material_table->material[i]->uniform)
      return bw_fail(context, BW_INVALID,
                     "material %d (%s) differs from point to point: only grids of uniform "
                     "materials are coarsened",
                     (int)i, material_table->material[i]->name);
  for (int32_t e = 0; e < fine->element_count; e++)
    if (fine->material[e] >= material_table->count)
      return bw_fail(context, BW_INVALID,
                     "element %d (cell %d) is of material %d, the material table has 1 to %d",
                     (int)e + 1, (int)fine->cell[e] + 1, (int)fine->material[e],
                     (int)material_table->count - 1);
  return BW_OK;
}

bw_status bwi_coarse_check(bw_context *context, const bw_library *library,
                           const bw_material_table *material_table, const bw_grid *fine) {
  bw_status status = check_materials(context, material_table, fine);
  const double *h = fine->spacing;
  if (status != BW_OK)
    return status;
  for (int d = 1; d < 3; d++)
    if (!(h[d] - h[0] <= 1e-9 * h[0] && h[0] - h[d] <= 1e-9 * h[0]))
      return bw_fail(context, BW_INVALID,
                     "the cells are %g x %g x %g m; a library is of cubes: make the spacing the "
                     "same in all directions",
                     h[0], h[1], h[2]);
  return bwi_same_material_table(context, material_table, library->material_table);
}

static bw_status check(bw_context *context, bw_coarse_method method, const bw_library *library,
                       const bw_material_table *material_table, const bw_grid *fine, int levels) {
  if ((unsigned)method > BW_COARSE_AVERAGE)
    return bw_fail(context, BW_INVALID, "coarsening method %d is not known", (int)method);
  if (levels < 1 || levels > 2)
    return bw_fail(context, BW_INVALID, "coarsening by %d levels: 1 or 2 expected", levels);
  if (method != BW_COARSE_LOOKUP)
    return check_materials(context, material_table, fine);
  if (!library)
    return bw_fail(context, BW_INVALID, "coarsening by lookup needs a library");
  if (levels > library->levels)
    return bw_fail(context, BW_INVALID, "coarsening by %d levels with a library of %d", levels,
                   library->levels);
  return bwi_coarse_check(context, library, material_table, fine);
}

static bw_status begin(bw_context *context, bw_coarse_method method, const bw_library *library,
                       const bw_material_table *material_table, const bw_grid *fine, int levels,
                       bw_coarse **out) {
  bw_coarse *it = BW_NEW0(context, bw_coarse, 1);
  if (!it)
    return BW_MEMORY;
  bw_object_init(it, &coarse_kind);
  it->method = method;
  it->levels = levels;
  it->fine_material_table = (const bw_material_table *)bw_retain(material_table);
  it->fine = (const bw_grid *)bw_retain(fine);
  if (method == BW_COARSE_LOOKUP)
    it->library = (const bw_library *)bw_retain(library);
  it->inner = BW_NEW0(context, bwi_coarse_keys, 1);
  if (!it->inner) {
    bw_release(it);
    return BW_MEMORY;
  }
  it->inner->width = levels == 1 ? 8 : 64;
  *out = it;
  return BW_OK;
}

static bw_status make_lattice(bw_context *context, bw_coarse *it) {
  bw_status status = BW_OK;
  double start = bw_seconds();
  for (int l = 0; l < it->levels; l++) {
    bw_coarsening *coarsening;
    BW_TRY(
        bw_coarsening_create(context, l ? it->coarsening[l - 1]->coarse : it->fine, &coarsening));
    it->coarsening[l] = coarsening;
  }
  it->seconds_lattice = bw_seconds() - start;
done:
  return status;
}

/* Assign materials to all coarse elements: to those with `id` set (not NULL) as it says, to the
 * others by their key. */
static bw_status assign(bw_context *context, bw_coarse *it, const bw_coarse *before, int32_t *id) {
  bw_status status = BW_OK;
  bw_rule *rule = NULL;
  bwi_coarse_maker maker = {it->method, it->levels, it->library, it->fine_material_table, NULL};
  bwi_rows list;
  memset(&list, 0, sizeof list);
  double start = bw_seconds();
  int32_t elements = it->coarsening[it->levels - 1]->coarse->element_count;
  BW_TRY(bw_rule_create(context, it->levels, &rule));
  maker.rule = rule;
  BW_TRY(bwi_rows_begin(&list, context, &maker, before));
  for (int32_t e = 0; e < elements; e++) {
    bwi_fine_block block;
    if (e % 4096 == 0)
      BW_TRY(bw_check_cancel(context));
    if (id[e])
      continue;
    bwi_block_gather(it->fine, it->coarsening, it->levels, e, &block);
    BW_TRY(bwi_rows_of(&list, &block, &id[e]));
    it->looked_up++;
  }
  BW_TRY(finish(context, it, &list, id));
  it->seconds_lookup = bw_seconds() - start;
done:
  bwi_rows_clear(&list);
  bw_release(rule);
  return status;
}

bw_status bw_coarsen(bw_context *context, bw_coarse_method method, const bw_library *library,
                     const bw_material_table *material_table, const bw_grid *fine, int levels,
                     bw_coarse **out) {
  bw_status status = BW_OK;
  bw_coarse *it = NULL;
  int32_t *id = NULL;
  BW_TRY(check(context, method, library, material_table, fine, levels));
  BW_TRY(begin(context, method, library, material_table, fine, levels, &it));
  BW_TRY(make_lattice(context, it));
  id = BW_NEW0(context, int32_t, it->coarsening[levels - 1]->coarse->element_count);
  BW_TRY_MEMORY(id);
  BW_TRY(assign(context, it, NULL, id));
  *out = it;
  it = NULL;
done:
  bw_free(id);
  bw_release(it);
  return status;
}

/* ---- following edits ------------------------------------------------------------------------ */

static double fraction_at(const bw_grid *grid, int32_t element) {
  return grid->fraction ? grid->fraction[element] : 1;
}

/* The coarse cell of a fine one. */
static int64_t coarse_cell(const bw_grid *fine, const bw_grid *coarse, int64_t cell, int levels) {
  int32_t place[3];
  bwi_grid_place(fine->cells, cell, place);
  return (place[0] >> levels) +
         (int64_t)coarse->cells[0] *
             ((place[1] >> levels) + (int64_t)coarse->cells[1] * (place[2] >> levels));
}

/* Coarse elements keep the material that they had, where nothing in them changed. */
static void keep(const bw_coarse *now, const bw_coarse *before, int32_t *id) {
  const bw_grid *old = before->fine, *fine = now->fine;
  const bw_grid *coarse = now->coarsening[now->levels - 1]->coarse, *former = before->grid;
  for (int32_t e = 0; e < coarse->element_count; e++) {
    int32_t was = former->at[coarse->cell[e]];
    id[e] = was < 0 ? 0 : former->material[was];
  }
  int64_t cells = bwi_grid_cells(fine->cells);
  for (int64_t c = 0; c < cells; c++) {
    int32_t a = old->at[c], b = fine->at[c];
    if (a < 0 && b < 0)
      continue;
    if (a >= 0 && b >= 0 && old->material[a] == fine->material[b] &&
        fraction_at(old, a) == fraction_at(fine, b))
      continue;
    int32_t e = coarse->at[coarse_cell(fine, coarse, c, now->levels)];
    if (e >= 0)
      id[e] = 0;
  }
}

bw_status bw_coarse_follow(bw_context *context, const bw_coarse *before, const bw_grid *fine,
                           bw_coarse **out) {
  bw_status status = BW_OK;
  bw_coarse *it = NULL;
  int32_t *id = NULL;
  const bw_grid *old = before->fine;
  for (int d = 0; d < 3; d++)
    if (fine->cells[d] != old->cells[d] || fine->origin[d] != old->origin[d] ||
        fine->spacing[d] != old->spacing[d])
      return bw_fail(context, BW_INVALID,
                     "the edited grid lies on another lattice (%d x %d x %d cells, before %d x %d "
                     "x %d, or moved): coarsen it again",
                     (int)fine->cells[0], (int)fine->cells[1], (int)fine->cells[2],
                     (int)old->cells[0], (int)old->cells[1], (int)old->cells[2]);
  BW_TRY(check(context, before->method, before->library, before->fine_material_table, fine,
               before->levels));
  if (fine == old) {
    *out = (bw_coarse *)bw_retain(before);
    return BW_OK;
  }
  BW_TRY(begin(context, before->method, before->library, before->fine_material_table, fine,
               before->levels, &it));
  if (bw_grid_same_elements(old, fine))
    for (int l = 0; l < it->levels; l++)
      it->coarsening[l] = (const bw_coarsening *)bw_retain(before->coarsening[l]);
  else
    BW_TRY(make_lattice(context, it));
  id = BW_NEW(context, int32_t, it->coarsening[it->levels - 1]->coarse->element_count);
  BW_TRY_MEMORY(id);
  keep(it, before, id);
  BW_TRY(assign(context, it, before, id));
  *out = it;
  it = NULL;
done:
  bw_free(id);
  bw_release(it);
  return status;
}

/* ---- displacements ------------------------------------------------------------------------- */

/* A coarse element that holds the lattice point `at` of the fine grid. */
static int32_t holder(const bw_coarse *it, const int32_t at[3], int32_t low[3]) {
  const bw_grid *coarse = it->grid;
  int32_t size = 1 << it->levels;
  for (int c = 0; c < 8; c++) {
    bool inside = true;
    for (int d = 0; d < 3; d++) {
      int32_t back = c >> d & 1;
      low[d] = (at[d] >> it->levels) - back;
      inside = inside && low[d] >= 0 && low[d] < coarse->cells[d] && !(back && at[d] % size);
    }
    if (!inside)
      continue;
    int32_t e = coarse->at[low[0] + (int64_t)coarse->cells[0] *
                                        (low[1] + (int64_t)coarse->cells[1] * low[2])];
    if (e >= 0)
      return e;
  }
  return -1;
}

/* Trilinear functions of nested cells are those of the largest one, so that no values of grids in
 * between are needed. */
void bw_coarse_to_fine(const bw_coarse *it, const double *u, double *fine) {
  double size = (double)(1 << it->levels);
  for (int32_t n = 0; n < it->fine->node_count; n++) {
    int32_t at[3], low[3];
    double *to = fine + 3 * (int64_t)n;
    bwi_grid_lattice(it->fine->cells, it->fine->node[n], at);
    int32_t e = holder(it, at, low);
    to[0] = to[1] = to[2] = 0;
    if (e < 0)
      continue; /* cannot be: an element's node lies in the element's block */
    double t[3];
    for (int d = 0; d < 3; d++)
      t[d] = at[d] / size - low[d];
    for (int c = 0; c < 8; c++) {
      const double *from = u + 3 * (int64_t)it->grid->element[8 * (int64_t)e + c];
      double weight =
          (c & 1 ? t[0] : 1 - t[0]) * (c & 2 ? t[1] : 1 - t[1]) * (c & 4 ? t[2] : 1 - t[2]);
      for (int d = 0; d < 3; d++)
        to[d] += weight * from[d];
    }
  }
}
