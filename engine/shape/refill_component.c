/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* Filling a closed surface without a point added on it.
 *
 * TetGen gets the surface alone, and fills everything within, cavities too: which of its elements
 * belong to the body follows from the facets, each of which has an element on its inner side, and
 * from there by going from element to element through faces that are no facets. That holds for
 * surfaces that touch themselves in edges and points, too. A result that lacks a facet, has moved a
 * point, or has not the volume inside the surface is not taken. */
#include "base/limit.h"
#include "mesh/tetgen_run.h"
#include "shape/mesh_repair_internal.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* ---- wanted sizes: those of the nearest sample ----------------------------------------------- */

/* Samples sorted into boxes of equal size. */
typedef struct sampler {
  int64_t count;
  const double *point, *length;
  double low[3], side;
  int cells[3];
  int32_t *start; /* boxes + 1 */
  int32_t *item;
} sampler;

static void box_of(const sampler *s, const double at[3], int box[3]) {
  for (int k = 0; k < 3; k++) {
    double place = floor((at[k] - s->low[k]) / s->side);
    box[k] = (int)fmax(0, fmin(place, s->cells[k] - 1));
  }
}

static size_t place_of(const sampler *s, const int box[3]) {
  return ((size_t)box[2] * (size_t)s->cells[1] + (size_t)box[1]) * (size_t)s->cells[0] +
         (size_t)box[0];
}

static bw_status sampler_create(bw_context *context, sampler *s) {
  double high[3], longest = 0;
  int box[3];
  for (int k = 0; k < 3; k++) {
    s->low[k] = INFINITY;
    high[k] = -INFINITY;
  }
  for (int64_t i = 0; i < s->count; i++)
    for (int k = 0; k < 3; k++) {
      s->low[k] = fmin(s->low[k], s->point[3 * i + k]);
      high[k] = fmax(high[k], s->point[3 * i + k]);
    }
  for (int k = 0; k < 3; k++)
    longest = fmax(longest, high[k] - s->low[k]);
  /* a long thin part has few boxes per sample, a cube one for four */
  s->side = longest / fmax(1, floor(cbrt((double)s->count / 4)));
  if (!(s->side > 0))
    s->side = 1;
  for (int k = 0; k < 3; k++)
    s->cells[k] = 1 + (int)floor((high[k] - s->low[k]) / s->side);
  size_t boxes = (size_t)s->cells[0] * (size_t)s->cells[1] * (size_t)s->cells[2];
  s->start = BW_NEW0(context, int32_t, boxes + 2);
  s->item = BW_NEW(context, int32_t, s->count);
  if (!s->start || !s->item)
    return BW_MEMORY;
  for (int64_t i = 0; i < s->count; i++) {
    box_of(s, s->point + 3 * i, box);
    s->start[place_of(s, box) + 2]++;
  }
  for (size_t i = 0; i <= boxes; i++)
    s->start[i + 1] += s->start[i];
  for (int64_t i = 0; i < s->count; i++) {
    box_of(s, s->point + 3 * i, box);
    s->item[s->start[place_of(s, box) + 1]++] = (int32_t)i;
  }
  return BW_OK;
}

/* The length of the nearest sample: shells of boxes around that of the place, until none farther
 * out can hold a nearer one. */
static double sample_at(void *data, const double at[3]) {
  const sampler *s = data;
  int centre[3], box[3], reach = 0;
  double nearest = INFINITY, length = 0;
  box_of(s, at, centre);
  for (int k = 0; k < 3; k++)
    reach = s->cells[k] > reach ? s->cells[k] : reach;
  for (int ring = 0; ring <= reach; ring++) {
    if (ring > 0 && nearest <= (ring - 1) * s->side * (ring - 1) * s->side)
      break;
    for (box[2] = centre[2] - ring; box[2] <= centre[2] + ring; box[2]++)
      for (box[1] = centre[1] - ring; box[1] <= centre[1] + ring; box[1]++) {
        bool shell = abs(box[2] - centre[2]) == ring || abs(box[1] - centre[1]) == ring;
        for (box[0] = centre[0] - ring; box[0] <= centre[0] + ring;
             box[0] += shell || ring == 0 ? 1 : 2 * ring) {
          if (box[0] < 0 || box[1] < 0 || box[2] < 0 || box[0] >= s->cells[0] ||
              box[1] >= s->cells[1] || box[2] >= s->cells[2])
            continue;
          size_t place = place_of(s, box);
          for (int32_t i = s->start[place]; i < s->start[place + 1]; i++) {
            const double *p = s->point + 3 * (size_t)s->item[i];
            double d[3] = {p[0] - at[0], p[1] - at[1], p[2] - at[2]}, square = bw_dot(d, d);
            if (square < nearest) {
              nearest = square;
              length = s->length[s->item[i]];
            }
          }
        }
      }
  }
  return length;
}

/* ---- which elements are inside --------------------------------------------------------------- */

bwi_keyed bwi_triangle_key(int32_t a, int32_t b, int32_t c, bool *turned) {
  int32_t t;
  *turned = false;
  if (a > b)
    t = a, a = b, b = t, *turned = !*turned;
  if (b > c)
    t = b, b = c, c = t, *turned = !*turned;
  if (a > b)
    t = a, a = b, b = t, *turned = !*turned;
  return (bwi_keyed){(uint64_t)(uint32_t)a << 32 | (uint64_t)(uint32_t)b, c, 0};
}

typedef struct facet_finder {
  bwi_keyed *list; /* by corners */
  uint8_t *facing; /* by place in the list: 1 where ascending corners run clockwise from outside */
  int32_t count;
} facet_finder;

static int32_t find_facet(const facet_finder *f, const bwi_keyed *wanted) {
  int32_t low = 0, high = f->count;
  while (low < high) {
    int32_t middle = low + (high - low) / 2;
    const bwi_keyed *m = &f->list[middle];
    if (m->key < wanted->key || (m->key == wanted->key && m->item < wanted->item))
      low = middle + 1;
    else
      high = middle;
  }
  return low < f->count && f->list[low].key == wanted->key && f->list[low].item == wanted->item
             ? low
             : -1;
}

static bw_status finder_create(bw_context *context, const bw_surface *surface, facet_finder *f) {
  bool turned;
  f->count = surface->triangle_count;
  f->list = BW_NEW(context, bwi_keyed, f->count);
  f->facing = BW_NEW(context, uint8_t, f->count);
  if (!f->list || !f->facing)
    return BW_MEMORY;
  for (int32_t i = 0; i < f->count; i++) {
    const int32_t *t = surface->triangle + 3 * (size_t)i;
    f->list[i] = bwi_triangle_key(t[0], t[1], t[2], &turned);
    f->list[i].part = turned;
  }
  bwi_sort_keyed(f->list, f->count);
  for (int32_t i = 0; i < f->count; i++)
    f->facing[i] = (uint8_t)f->list[i].part;
  return BW_OK;
}

/* side[e] = 1 inside; false when a facet is missing or an element would be on both sides. */
static bw_status find_inside(bw_context *context, const bw_surface *surface, const bw_mesh *mesh,
                             int8_t *side, bool *sound) {
  facet_finder f = {.list = NULL};
  size_t faces = 4 * (size_t)mesh->element_count;
  int32_t *wall = BW_NEW(context, int32_t, faces), *queue = NULL, queued = 0;
  uint8_t *met = BW_NEW0(context, uint8_t, surface->triangle_count);
  bw_status status = BW_OK;
  queue = BW_NEW(context, int32_t, mesh->element_count);
  BW_TRY_MEMORY(wall && met && queue);
  BW_TRY(finder_create(context, surface, &f));
  *sound = true;
  memset(side, 0, (size_t)mesh->element_count);
  for (int32_t e = 0; e < mesh->element_count; e++)
    for (int k = 0; k < 4; k++) {
      const int32_t *c = mesh->element + 4 * (size_t)e, *face = bw_tet_face[k];
      bool turned;
      bwi_keyed key = bwi_triangle_key(c[face[0]], c[face[1]], c[face[2]], &turned);
      int32_t at = find_facet(&f, &key);
      wall[4 * (size_t)e + (size_t)k] = at;
      if (at < 0)
        continue;
      int8_t here = f.facing[at] == turned ? 1 : -1;
      if (here == 1)
        met[at] = 1;
      if (side[e] == 0)
        queue[queued++] = e;
      else if (side[e] != here)
        *sound = false;
      side[e] = here;
    }
  for (int32_t i = 0; i < surface->triangle_count; i++)
    *sound = *sound && met[i];
  for (int32_t at = 0; at < queued && *sound; at++)
    for (size_t k = 0; k < 4; k++) {
      size_t face = 4 * (size_t)queue[at] + k;
      int32_t other = mesh->neighbour[face];
      if (wall[face] >= 0 || other < 0)
        continue;
      if (side[other] == 0) {
        side[other] = side[queue[at]];
        queue[queued++] = other;
      } else if (side[other] != side[queue[at]]) {
        *sound = false;
      }
    }
done:
  bw_free(wall);
  bw_free(queue);
  bw_free(met);
  bw_free(f.list);
  bw_free(f.facing);
  return status;
}

/* The inner elements and their nodes; those of the surface keep their numbers. */
static bw_status copy_inside(bw_context *context, const bw_mesh *mesh, const int8_t *side,
                             int32_t surface_points, bwi_filled *filled) {
  int32_t nodes = 0, at = 0, *number = BW_NEW(context, int32_t, mesh->node_count);
  double *node = BW_NEW(context, double, 3 * (size_t)mesh->node_count);
  int32_t *element = BW_NEW(context, int32_t, 4 * (size_t)filled->element_count);
  if (!number || !node || !element) {
    bw_free(number);
    bw_free(node);
    bw_free(element);
    return BW_MEMORY;
  }
  for (int32_t i = 0; i < mesh->node_count; i++)
    number[i] = i < surface_points ? 0 : -1;
  for (int32_t e = 0; e < mesh->element_count; e++)
    for (size_t k = 0; k < 4 && side[e] == 1; k++)
      number[mesh->element[4 * (size_t)e + k]] = 0;
  for (int32_t i = 0; i < mesh->node_count; i++)
    if (number[i] == 0) {
      memcpy(node + 3 * (size_t)nodes, mesh->node + 3 * (size_t)i, 3 * sizeof *node);
      number[i] = nodes++;
    }
  for (int32_t e = 0; e < mesh->element_count; e++)
    if (side[e] == 1) {
      for (size_t k = 0; k < 4; k++)
        element[4 * (size_t)at + k] = number[mesh->element[4 * (size_t)e + k]];
      at++;
    }
  bw_free(number);
  filled->node_count = nodes;
  filled->node = node;
  filled->element = element;
  return BW_OK;
}

/* Take from TetGen's mesh what is inside; *taken says whether it is a filling of the surface. */
static bw_status take_result(bw_context *context, const bw_surface *surface,
                             bwi_tetgen_result *result, bwi_filled *filled, bool *taken) {
  bw_mesh *mesh = NULL;
  int8_t *side = NULL;
  bw_status status;
  double volume = 0, wanted = bw_surface_volume(surface);
  bool sound = false;
  *taken = false;
  status = bw_mesh_adopt(context, 1, result->node_count, result->node, result->element_count,
                         result->element, NULL, &mesh);
  if (status == BW_GEOMETRY) { /* elements without volume */
    bw_clear_failure(context);
    return BW_OK;
  }
  if (status != BW_OK)
    goto done;
  result->node = NULL;
  result->element = NULL;
  if (mesh->node_count < surface->point_count ||
      memcmp(mesh->node, surface->point, 24 * (size_t)surface->point_count) != 0)
    goto done;
  side = BW_NEW(context, int8_t, mesh->element_count);
  BW_TRY_MEMORY(side);
  BW_TRY(find_inside(context, surface, mesh, side, &sound));
  filled->element_count = 0;
  for (int32_t e = 0; e < mesh->element_count; e++)
    if (side[e] == 1) {
      volume += mesh->volume[e];
      filled->element_count++;
    }
  if (!sound || !(fabs(volume - wanted) <= 1e-9 * wanted))
    goto done;
  BW_TRY(copy_inside(context, mesh, side, surface->point_count, filled));
  *taken = true;
done:
  bw_free(side);
  bw_release(mesh);
  return status;
}

/* ---- filling --------------------------------------------------------------------------------- */

bw_status bwi_fill_exactly(bw_context *context, const bw_surface *surface, int64_t sample_count,
                           const double *sample, const double *sample_length, bwi_filled *filled) {
  sampler samples = {.count = sample_count, .point = sample, .length = sample_length};
  bw_size_field field = {.size = sample_at, .data = &samples};
  bwi_tetgen_result result = {.node = NULL};
  bw_status status;
  bool taken = false;
  BW_TRY(sampler_create(context, &samples));
  /* with sizes and good shapes; with good shapes; with whatever fills it */
  for (int way = 0; way < 3 && !taken; way++) {
    bwi_tetgen_job job = {.point_count = surface->point_count,
                          .triangle_count = surface->triangle_count,
                          .point = surface->point,
                          .triangle = surface->triangle,
                          .radius_edge = way < 2 ? 1.4 : 0,
                          .keep_surface = true,
                          .field = way == 0 ? &field : NULL,
                          .max_points =
                              1000 + 20 * (int64_t)surface->point_count + 10 * sample_count,
                          .limits = {.seconds = 60, .bytes = 4e9}};
    status = bwi_tetgen_run(context, &job, &result);
    if (status == BW_OK) {
      status = take_result(context, surface, &result, filled, &taken);
      bw_free(result.node);
      bw_free(result.element);
      result = (bwi_tetgen_result){.node = NULL};
      if (status != BW_OK)
        goto done;
      if (!taken && way == 2)
        status = bw_fail(context, BW_GEOMETRY, "TetGen's elements do not keep the boundary");
    } else if ((status != BW_GEOMETRY && status != BW_LIMIT) || bwi_time_ran_out(context, status)) {
      goto done; /* which way is taken must not depend on the machine */
    }
  }
  if (taken)
    bw_clear_failure(context);
done:
  bw_free(samples.start);
  bw_free(samples.item);
  return status;
}
