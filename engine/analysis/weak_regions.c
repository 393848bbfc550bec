/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* Weak regions: where a mode strains the body most (docs/theory/worst_case.md, "Weak regions").
 *
 * Per mode every element gets a measure; the elements with the largest ones, until they fill the
 * fraction of the volume asked for, are cut into parts connected through faces; the parts with most
 * energy are the mode's regions. Weights are scaled so that sum |w| V = 1 over a region: the
 * objective is then a mean of plus or minus tr sigma in Pa (or a mean displacement in m).
 *
 * Invariants of a region: elements ascending, count >= 1, some weight not zero. The order of
 * elements is total (measure, then number), so nothing depends on the sorting method. */
#include "analysis/weak_internal.h"
#include "base/sort.h"

#include <float.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

void bw_weak_options_default(bw_weak_options *options) {
  *options = (bw_weak_options){BW_WEAK_STRESS, 0.025, 5, BW_WORST_STRESS};
}

static void region_clear(bw_weak_region *region) {
  bw_free(region->element);
  bw_free(region->weight);
  bw_free(region->corner);
}

static void regions_destroy(void *object) {
  bw_weak_regions *regions = (bw_weak_regions *)object;
  for (int i = 0; i < regions->count; i++)
    region_clear(&regions->region[i]);
  bw_free(regions->region);
  bw_release(regions->mesh);
  bw_free(regions);
}

static size_t regions_bytes(const void *object) {
  const bw_weak_regions *regions = (const bw_weak_regions *)object;
  size_t weights = bwi_weight_width(regions->options.target), bytes = sizeof *regions;
  for (int i = 0; i < regions->count; i++)
    bytes += sizeof *regions->region + (size_t)regions->region[i].count * (4 + 8 * weights);
  return bytes;
}

static const bw_kind regions_kind = {"weak regions", regions_destroy, regions_bytes};

/* What a mode says about every element. `field` is the stress (6), the gradient of a Laplacian mode
 * (3) or the mean displacement (3). */
typedef struct mode_fields {
  int components;
  double *field, *measure, *energy;
} mode_fields;

static double frobenius(const double t[6]) {
  return sqrt(t[0] * t[0] + t[1] * t[1] + t[2] * t[2] +
              2 * (t[3] * t[3] + t[4] * t[4] + t[5] * t[5]));
}

static bw_status elastic_stress_fields(bw_context *context, const bw_mesh *mesh,
                                       const bw_material *material, const double *shape,
                                       bw_weak_measure measure, mode_fields *fields) {
  bw_status status = BW_OK;
  BW_TRY(bw_element_stress(context, mesh, material, shape, fields->field));
  BW_TRY(bw_element_energy(context, mesh, material, shape, fields->energy));
  if (measure == BW_WEAK_STRESS)
    BW_TRY(bw_max_principal_field(context, mesh->element_count, fields->field, fields->measure));
  else
    for (int32_t e = 0; e < mesh->element_count; e++)
      fields->measure[e] = fields->energy[e] / mesh->volume[e];
done:
  return status;
}

/* Means over the elements of the gradient of a scalar mode, or of a displacement. */
static void mean_fields(const bw_mesh *mesh, const double *shape, bool laplacian,
                        mode_fields *fields) {
  int nodes = mesh->nodes_per_element;
  for (int32_t e = 0; e < mesh->element_count; e++) {
    const int32_t *node = mesh->element + (size_t)e * (size_t)nodes;
    double gradient[10][3], value[10], mean[3] = {0, 0, 0};
    double volume =
        bwi_shape_integrals(mesh, e, laplacian ? gradient : NULL, laplacian ? NULL : value);
    for (int a = 0; a < nodes; a++)
      for (int k = 0; k < 3; k++)
        mean[k] += laplacian ? gradient[a][k] * shape[node[a]]
                             : value[a] * shape[3 * (size_t)node[a] + (size_t)k];
    for (int k = 0; k < 3; k++)
      fields->field[3 * (size_t)e + (size_t)k] = mean[k] /= volume;
    fields->measure[e] = bw_norm(mean);
    fields->energy[e] = volume * bw_dot(mean, mean);
  }
}

/* ---- the threshold ------------------------------------------------------------------------- */

typedef struct candidate {
  double measure, volume;
  int32_t element;
} candidate;

static bool before(const candidate *a, const candidate *b) {
  return a->measure != b->measure ? a->measure > b->measure : a->element < b->element;
}

/* Bring to the front the fewest first elements (by `before`) whose volume reaches `wanted`; returns
 * their number, at least one. Quickselect by volume, with the middle one of three as pivot. */
static int32_t select_top(candidate *list, int32_t count, double wanted) {
  int32_t low = 0, high = count;
  while (high - low > 1) {
    candidate a = list[low], b = list[low + (high - low) / 2], c = list[high - 1];
    candidate pivot = before(&a, &b) ? (before(&b, &c)   ? b
                                        : before(&a, &c) ? c
                                                         : a)
                                     : (before(&a, &c)   ? a
                                        : before(&b, &c) ? c
                                                         : b);
    double volume = 0;
    int32_t i = low, j = high - 1;
    for (;;) { /* Hoare: [low, i) stay before the pivot or are it */
      while (before(&list[i], &pivot))
        volume += list[i++].volume;
      while (before(&pivot, &list[j]))
        j--;
      if (i >= j)
        break;
      candidate t = list[i];
      list[i] = list[j];
      list[j] = t;
    }
    /* list[i] is the pivot now: everything before it comes before it. */
    if (volume >= wanted) {
      high = i;
    } else if (volume + list[i].volume >= wanted) {
      return i + 1;
    } else {
      wanted -= volume + list[i].volume;
      low = i + 1;
      if (low == high)
        return low;
    }
  }
  return high > low ? low + 1 : low;
}

/* ---- the regions of one mode --------------------------------------------------------------- */

static int by_energy(const void *a, const void *b) {
  const bw_weak_region *x = (const bw_weak_region *)a, *y = (const bw_weak_region *)b;
  if (x->energy != y->energy)
    return x->energy > y->energy ? -1 : 1;
  return (x->element[0] > y->element[0]) - (x->element[0] < y->element[0]);
}

static bw_status set_weights(bw_context *context, const bw_mesh *mesh, const mode_fields *fields,
                             bw_worst_target target, bw_weak_region *region) {
  bool stress = target == BW_WORST_STRESS;
  size_t width = stress ? 1 : 3, count = (size_t)region->count;
  double sum = 0;
  region->weight = BW_NEW(context, double, count *width);
  if (!region->weight)
    return BW_MEMORY;
  if (stress && fields->components == 3)
    bwi_laplacian_weights(mesh, region, fields->field, region->weight);
  for (size_t i = 0; i < count; i++) {
    int32_t e = region->element[i];
    const double *t = fields->field + (size_t)e * (size_t)fields->components;
    double *w = region->weight + i * width;
    if (!stress)
      memcpy(w, t, 3 * sizeof *w);
    else if (fields->components == 6)
      *w = copysign(frobenius(t), t[0] + t[1] + t[2]);
    sum += mesh->volume[e] * (stress ? fabs(*w) : bw_norm(w));
  }
  for (size_t i = 0; i < count * width; i++)
    region->weight[i] /= sum;
  return BW_OK;
}

/* Parts of the marked elements connected through faces, most energy first, at most `wanted`.
 * `mark` is 1 on the chosen elements and 0 elsewhere, and 0 everywhere afterwards. */
static bw_status cut_regions(bw_context *context, const bw_mesh *mesh, const mode_fields *fields,
                             const bw_weak_options *options, int mode, const candidate *chosen,
                             int32_t count, uint8_t *mark, bw_weak_region *out, int *found) {
  bw_status status = BW_OK;
  bw_weak_region *part = NULL;
  size_t parts = 0, capacity = 0;
  int32_t *stack = BW_NEW(context, int32_t, count);
  if (!stack)
    return BW_MEMORY;
  for (int32_t c = 0; c < count; c++) {
    if (!mark[chosen[c].element])
      continue;
    BW_TRY_MEMORY(bw_grow(context, (void **)&part, &capacity, parts, 1, sizeof *part));
    /* The stack never shrinks: it ends up as the list of the part's elements. */
    int32_t size = 1;
    double energy = 0, volume = 0, peak = 0;
    stack[0] = chosen[c].element;
    mark[stack[0]] = 0;
    for (int32_t at = 0; at < size; at++)
      for (int k = 0; k < 4; k++) {
        int32_t other = mesh->neighbour[4 * (size_t)stack[at] + (size_t)k];
        if (other >= 0 && mark[other]) {
          mark[other] = 0;
          stack[size++] = other;
        }
      }
    bwi_sort_columns(stack, size);
    for (int32_t i = 0; i < size; i++) {
      energy += fields->energy[stack[i]];
      volume += mesh->volume[stack[i]];
      peak = fmax(peak, fields->measure[stack[i]]);
    }
    bw_weak_region *r = &part[parts];
    *r = (bw_weak_region){
        .mode = mode, .count = size, .volume = volume, .energy = energy, .peak = peak};
    r->element = BW_NEW(context, int32_t, size);
    BW_TRY_MEMORY(r->element);
    parts++;
    memcpy(r->element, stack, (size_t)size * sizeof *stack);
  }
  if (parts > 0) /* without any there is no array */
    qsort(part, parts, sizeof *part, by_energy);
  *found = 0;
  for (size_t i = 0; i < parts && *found < options->regions; i++) {
    if (!(part[i].energy > 0))
      break;
    BW_TRY(set_weights(context, mesh, fields, options->target, &part[i]));
    out[*found] = part[i];
    out[*found].rank = *found;
    part[i].element = NULL; /* handed over */
    part[i].weight = NULL;
    ++*found;
  }
done:
  for (int32_t c = 0; c < count; c++)
    mark[chosen[c].element] = 0;
  for (size_t i = 0; i < parts; i++)
    region_clear(&part[i]);
  bw_free(part);
  bw_free(stack);
  return status;
}

typedef struct find_work {
  bw_context *context;
  const bw_mesh *mesh;
  const bw_material *material;
  const bw_modes *modes;
  const bw_weak_options *options;
  bw_weak_region *region; /* modes x options->regions */
  int *found;             /* per mode */
} find_work;

static bw_status find_in_mode(const find_work *work, int mode) {
  bw_status status = BW_OK;
  bw_context *context = work->context;
  const bw_mesh *mesh = work->mesh;
  const bw_modes *modes = work->modes;
  bool displacement = work->options->target == BW_WORST_DISPLACEMENT;
  bool laplacian = modes->components == 1;
  size_t n = (size_t)mesh->element_count;
  const double *shape =
      modes->shape + (size_t)mode * (size_t)mesh->node_count * (size_t)modes->components;
  mode_fields fields = {laplacian || displacement ? 3 : 6, NULL, NULL, NULL};
  candidate *list = NULL;
  uint8_t *mark = NULL;
  fields.field = BW_NEW(context, double, n *(size_t)fields.components);
  fields.measure = BW_NEW(context, double, n);
  fields.energy = BW_NEW(context, double, n);
  list = BW_NEW(context, candidate, n);
  mark = BW_NEW0(context, uint8_t, n);
  BW_TRY_MEMORY(fields.field && fields.measure && fields.energy && list && mark);
  BW_TRY(bw_check_cancel(context));
  if (fields.components == 3)
    mean_fields(mesh, shape, laplacian, &fields);
  else
    BW_TRY(elastic_stress_fields(context, mesh, work->material, shape, work->options->measure,
                                 &fields));
  double total = 0;
  for (size_t e = 0; e < n; e++) {
    list[e] = (candidate){fields.measure[e], mesh->volume[e], (int32_t)e};
    total += mesh->volume[e];
    if (!isfinite(fields.measure[e]))
      BW_TRY(bw_fail(context, BW_INVALID, "mode %d is not finite in element %zu", mode + 1, e + 1));
  }
  int32_t count = select_top(list, (int32_t)n, work->options->fraction * total);
  for (int32_t c = 0; c < count; c++)
    mark[list[c].element] = 1;
  BW_TRY(cut_regions(context, mesh, &fields, work->options, mode, list, count, mark,
                     work->region + (size_t)mode * (size_t)work->options->regions,
                     &work->found[mode]));
done:
  bw_free(fields.field);
  bw_free(fields.measure);
  bw_free(fields.energy);
  bw_free(list);
  bw_free(mark);
  return status;
}

static bw_status find_body(void *data, int64_t begin, int64_t end, int worker) {
  (void)worker;
  bw_status status = BW_OK;
  for (int64_t mode = begin; mode < end; mode++)
    BW_TRY(find_in_mode((const find_work *)data, (int)mode));
done:
  return status;
}

bw_status bw_weak_regions_find(bw_context *context, const bw_mesh *mesh,
                               const bw_material *material, const bw_modes *modes,
                               const bw_weak_options *options, bw_weak_regions **result) {
  bw_status status = BW_OK;
  bw_weak_options standard;
  bw_weak_regions *regions = NULL;
  find_work work = {context, mesh, material, modes, options, NULL, NULL};
  if (!options) {
    bw_weak_options_default(&standard);
    work.options = options = &standard;
  }
  if (!(options->fraction > 0 && options->fraction <= 1))
    return bw_fail(context, BW_INVALID,
                   "the volume fraction of weak regions is %g: it must lie between 0 and 1",
                   options->fraction);
  if (options->regions < 1 || options->regions > 100000)
    return bw_fail(context, BW_INVALID,
                   "%d weak regions per mode were requested: 1 to 100000 expected",
                   options->regions);
  if (modes->cyclic)
    return bw_fail(context, BW_UNSUPPORTED,
                   "the modes are those of a sector of cyclic symmetry: weak regions are found on "
                   "modes of the whole");
  if (modes->mesh->node_count != mesh->node_count)
    return bw_fail(context, BW_INVALID, "the modes have %d nodes and the mesh has %d",
                   modes->mesh->node_count, mesh->node_count);
  if (modes->components == 1 && options->target == BW_WORST_DISPLACEMENT)
    return bw_fail(context, BW_UNSUPPORTED,
                   "Laplacian modes have no direction of displacement: the displacement target "
                   "needs elastic modes");
  size_t slots = (size_t)modes->count * (size_t)options->regions;
  regions = BW_NEW0(context, bw_weak_regions, 1);
  work.region = BW_NEW0(context, bw_weak_region, slots);
  work.found = BW_NEW0(context, int, modes->count);
  BW_TRY_MEMORY(regions && work.region && work.found);
  BW_TRY(bw_parallel(context, modes->count, 1, find_body, &work));
  for (int mode = 0; mode < modes->count; mode++)
    for (int i = 0; i < work.found[mode]; i++)
      work.region[regions->count++] =
          work.region[(size_t)mode * (size_t)options->regions + (size_t)i];
  for (size_t i = (size_t)regions->count; i < slots; i++)
    memset(&work.region[i], 0, sizeof *work.region);
  if (regions->count == 0)
    status = bw_fail(context, BW_EMPTY, "none of the %d modes has strain energy", modes->count);
done:
  if (status != BW_OK) {
    for (size_t i = 0; work.region && i < slots; i++)
      region_clear(&work.region[i]);
    bw_free(work.region);
    bw_free(regions);
  } else {
    bw_object_init(regions, &regions_kind);
    regions->mesh = (const bw_mesh *)bw_retain(mesh);
    regions->options = *options;
    regions->region = work.region;
    *result = regions;
  }
  bw_free(work.found);
  return status;
}

bw_status bwi_element_regions(bw_context *context, const bw_mesh *mesh, int64_t count,
                              const int32_t *element, bw_worst_target target,
                              bw_weak_regions **result) {
  if (count < 1 || count > INT32_MAX)
    return bw_fail(context, BW_INVALID,
                   "%lld single-element regions were requested: at least 1 expected",
                   (long long)count);
  if (!element && count > mesh->element_count)
    return bw_fail(context, BW_INVALID, "%lld regions of a mesh of %d elements", (long long)count,
                   mesh->element_count);
  for (int64_t i = 0; element && i < count; i++)
    if (element[i] < 0 || element[i] >= mesh->element_count)
      return bw_fail(context, BW_INVALID, "element %d: the mesh has elements 1 to %d",
                     element[i] + 1, mesh->element_count);
  bw_weak_regions *regions = BW_NEW0(context, bw_weak_regions, 1);
  if (!regions)
    return BW_MEMORY;
  bw_object_init(regions, &regions_kind);
  regions->mesh = (const bw_mesh *)bw_retain(mesh);
  bw_weak_options_default(&regions->options);
  regions->options.target = target;
  regions->region = BW_NEW0(context, bw_weak_region, count);
  if (!regions->region)
    goto no_memory;
  for (int64_t i = 0; i < count; i++) {
    bw_weak_region *r = &regions->region[regions->count++];
    r->count = 1;
    r->mode = r->rank = -1;
    r->element = BW_NEW(context, int32_t, 1);
    r->weight = BW_NEW0(context, double, bwi_weight_width(target));
    if (!r->element || !r->weight)
      goto no_memory;
    r->element[0] = element ? element[i] : (int32_t)i;
    r->volume = mesh->volume[r->element[0]];
  }
  *result = regions;
  return BW_OK;
no_memory:
  bw_release(regions);
  return BW_MEMORY;
}
