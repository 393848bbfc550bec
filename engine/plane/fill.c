/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* Filling an outline with triangles: nodes along the outline, triangles between them by CGAL, nodes
 * that CGAL put on boundary edges moved onto the curves, smoothing with flips, middles of edges.
 *
 * What can go wrong on the way is answered by denser nodes along the curves: boundary edges that
 * cross where two curves run close to each other, elements inverted by a node moved onto its curve,
 * six-node elements folded by a curved side. */
#include "plane/fill_internal.h"
#include "plane/weave.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { DENSER = 8, COUNT_TRIES = 8, SMOOTHING = 6 };
static const double EQUILATERAL = 0.43301270189221930; /* area over squared side */

void bw_plane_options_default(bw_plane_options *options) {
  *options = (bw_plane_options){
      .order = 1, .elements = 2000, .minimum_angle = 25, .curvature = 20, .limit = 5000000};
}

void bwi_filling_clear(bwi_filling *filling) {
  bw_free(filling->point);
  bw_free(filling->element);
  bw_free(filling->loop);
  bw_free(filling->chord);
  bw_free(filling->along);
  memset(filling, 0, sizeof *filling);
}

static bw_status check_options(bw_context *context, const bw_plane_options *o) {
  if (o->order != 1 && o->order != 2)
    return bw_fail(context, BW_INVALID, "order %d: a plane mesh has order 1 or 2", o->order);
  if (!(o->size >= 0) || isinf(o->size))
    return bw_fail(context, BW_INVALID, "size %g: an edge length above 0, or 0 for none", o->size);
  if (o->size == 0 && !o->field && o->elements < 1)
    return bw_fail(context, BW_INVALID, "elements %d: at least 1, or give a size", o->elements);
  if (!(o->minimum_angle >= 0 && o->minimum_angle <= 30))
    return bw_fail(context, BW_INVALID, "minimum angle %g: from 0 to 30 degrees", o->minimum_angle);
  if (!(o->curvature > 0 && o->curvature <= 90))
    return bw_fail(context, BW_INVALID, "curvature %g: above 0, at most 90 degrees per edge",
                   o->curvature);
  if (o->limit < 1)
    return bw_fail(context, BW_INVALID, "limit %d: at least 1 element", o->limit);
  return BW_OK;
}

/* ---- from what CGAL made to a mesh --------------------------------------------------------------
 */

typedef struct keyed {
  uint64_t key;
  int32_t item;
} keyed;

static int by_key(const void *a, const void *b) {
  const keyed *p = a, *q = b;
  if (p->key != q->key)
    return p->key < q->key ? -1 : 1;
  return (p->item > q->item) - (p->item < q->item);
}

/* Every second bit: the lowest 32 bits of v spread out. */
static uint64_t spread(uint64_t v) {
  v = (v | v << 16) & 0x0000ffff0000ffff;
  v = (v | v << 8) & 0x00ff00ff00ff00ff;
  v = (v | v << 4) & 0x0f0f0f0f0f0f0f0f;
  v = (v | v << 2) & 0x3333333333333333;
  v = (v | v << 1) & 0x5555555555555555;
  return v;
}

/* Places along a Morton curve: what is near is near in memory. */
static void order_places(keyed *list, int32_t count, const double *place) {
  double low[2] = {INFINITY, INFINITY}, size = 0;
  for (int k = 0; k < 2; k++) {
    double high = -INFINITY;
    for (int32_t i = 0; i < count; i++) {
      low[k] = fmin(low[k], place[2 * (size_t)i + (size_t)k]);
      high = fmax(high, place[2 * (size_t)i + (size_t)k]);
    }
    size = fmax(size, high - low[k]);
  }
  double scale = size > 0 ? 4294967295.0 / size : 0;
  for (int32_t i = 0; i < count; i++) {
    list[i].item = i;
    list[i].key = spread((uint64_t)((place[2 * (size_t)i] - low[0]) * scale)) |
                  spread((uint64_t)((place[2 * (size_t)i + 1] - low[1]) * scale)) << 1;
  }
  qsort(list, (size_t)count, sizeof *list, by_key);
}

/* The nodes' places on the outline. Nodes put on boundary edges are moved onto the curve. */
static bw_status place_nodes(bw_context *context, const bw_outline *outline,
                             const bwi_fill_boundary *boundary, bwi_filling *filling,
                             int32_t **segment, double **parameter) {
  *segment = BW_NEW(context, int32_t, filling->node_count);
  *parameter = BW_NEW0(context, double, filling->node_count);
  if (!*segment || !*parameter)
    return BW_MEMORY;
  for (int32_t i = 0; i < filling->node_count; i++) {
    int32_t chord = filling->chord[i];
    (*segment)[i] = -1;
    if (i < boundary->count) {
      (*segment)[i] = boundary->segment[i];
      (*parameter)[i] = boundary->parameter[i];
    } else if (chord >= 0) {
      double from = boundary->parameter[chord], to = 1;
      if (chord + 1 < boundary->count && boundary->segment[chord + 1] == boundary->segment[chord])
        to = boundary->parameter[chord + 1];
      (*segment)[i] = boundary->segment[chord];
      (*parameter)[i] = from + filling->along[i] * (to - from);
    }
    if ((*segment)[i] >= 0)
      bw_outline_evaluate(outline, (*segment)[i], (*parameter)[i], filling->point + 2 * (size_t)i,
                          NULL, NULL);
  }
  return BW_OK;
}

/* Three-node topology of the filling in Morton order, and its weave. */
static bw_status open_weave(bw_context *context, const bw_outline *outline,
                            const bwi_fill_boundary *boundary, bwi_filling *filling,
                            bw_plane_topology **topology, bwi_weave *weave) {
  bw_status status = BW_OK;
  int32_t nodes = filling->node_count, elements = filling->element_count;
  int32_t *segment = NULL, *number = NULL, *element = NULL, *region = NULL, *segments = NULL;
  double *parameter = NULL, *parameters = NULL, *point = NULL, *middle = NULL;
  bw_plane_nodes *made = NULL;
  keyed *list = BW_NEW(context, keyed, nodes > elements ? nodes : elements);
  BW_TRY(place_nodes(context, outline, boundary, filling, &segment, &parameter));
  number = BW_NEW(context, int32_t, nodes);
  element = BW_NEW(context, int32_t, 3 * (size_t)elements);
  region = BW_NEW(context, int32_t, elements);
  segments = BW_NEW(context, int32_t, nodes);
  parameters = BW_NEW(context, double, nodes);
  point = BW_NEW(context, double, 2 * (size_t)nodes);
  middle = BW_NEW(context, double, 2 * (size_t)elements);
  if (!list || !number || !element || !region || !segments || !parameters || !point || !middle) {
    status = BW_MEMORY;
    goto done;
  }
  order_places(list, nodes, filling->point);
  for (int32_t i = 0; i < nodes; i++) {
    int32_t from = list[i].item;
    number[from] = i;
    segments[i] = segment[from];
    parameters[i] = parameter[from];
    memcpy(point + 2 * (size_t)i, filling->point + 2 * (size_t)from, 2 * sizeof *point);
  }
  for (int32_t e = 0; e < elements; e++)
    for (size_t k = 0; k < 2; k++) {
      const int32_t *n = filling->element + 3 * (size_t)e;
      middle[2 * (size_t)e + k] =
          (filling->point[2 * (size_t)n[0] + k] + filling->point[2 * (size_t)n[1] + k] +
           filling->point[2 * (size_t)n[2] + k]) /
          3;
    }
  order_places(list, elements, middle);
  for (int32_t e = 0; e < elements; e++) {
    int32_t from = list[e].item;
    const int32_t *n = filling->element + 3 * (size_t)from;
    /* the lowest corner first: the same triangles give the same arrays */
    int first = number[n[0]] < number[n[1]] ? (number[n[0]] < number[n[2]] ? 0 : 2)
                                            : (number[n[1]] < number[n[2]] ? 1 : 2);
    for (int k = 0; k < 3; k++)
      element[3 * (size_t)e + (size_t)k] = number[n[(first + k) % 3]];
    region[e] = outline->loop[filling->loop[from]].region;
  }
  status = bwi_plane_nodes_own(context, 1, nodes, nodes, segments, parameters, &made);
  segments = NULL;
  parameters = NULL;
  BW_TRY(status);
  status = bwi_plane_topology_own(context, made, outline, elements, element, region, topology);
  element = region = NULL;
  BW_TRY(status);
  BW_TRY(bwi_weave_open(context, *topology, point, weave));
done:
  bw_release(made);
  bw_free(list);
  bw_free(segment);
  bw_free(parameter);
  bw_free(number);
  bw_free(element);
  bw_free(region);
  bw_free(segments);
  bw_free(parameters);
  bw_free(point);
  bw_free(middle);
  return status;
}

/* Middles on all edges, numbered element by element, those on sides on their curve. */
static bw_status add_middles(bw_context *context, const bw_outline *outline,
                             const bw_plane_topology *topology, const bwi_weave *weave,
                             int32_t *nodes, int32_t **segment, double **parameter, double **point,
                             int32_t **element) {
  bw_status status = BW_OK;
  const bw_plane_nodes *corners = topology->nodes;
  int32_t count = corners->corner_count, elements = weave->element_count;
  /* edges = (halves + open ones) / 2 */
  int64_t open = 0;
  for (int64_t h = 0; h < 3 * (int64_t)elements; h++)
    open += weave->neighbour[h] < 0;
  int64_t total = count + (3 * (int64_t)elements + open) / 2;
  if (total > INT32_MAX / 2)
    return bw_fail(context, BW_LIMIT, "%lld nodes: a plane mesh holds at most %d", (long long)total,
                   INT32_MAX / 2);
  int32_t *middle = BW_NEW(context, int32_t, 3 * (size_t)elements);
  *segment = BW_NEW(context, int32_t, total);
  *parameter = BW_NEW0(context, double, total);
  *point = BW_NEW(context, double, 2 * (size_t)total);
  *element = BW_NEW(context, int32_t, 6 * (size_t)elements);
  if (!middle || !*segment || !*parameter || !*point || !*element) {
    status = BW_MEMORY;
    goto done;
  }
  memcpy(*segment, corners->segment, (size_t)count * sizeof **segment);
  memcpy(*parameter, corners->parameter, (size_t)count * sizeof **parameter);
  memcpy(*point, weave->point, 2 * (size_t)count * sizeof **point);
  for (int64_t h = 0; h < 3 * (int64_t)elements; h++) {
    int32_t e = (int32_t)(h / 3), other = weave->neighbour[h];
    const int32_t *n = weave->element + 3 * (size_t)e;
    int k = (int)(h % 3);
    int32_t a = n[k], b = n[(k + 1) % 3];
    if (other >= 0 && other < e) {
      const int32_t *m = weave->element + 3 * (size_t)other;
      int at = m[0] == b ? 0 : m[1] == b ? 1 : 2;
      middle[h] = middle[3 * (size_t)other + (size_t)at];
      continue;
    }
    middle[h] = count;
    (*segment)[count] = -1;
    for (size_t i = 0; i < 2; i++)
      (*point)[2 * (size_t)count + i] =
          (weave->point[2 * (size_t)a + i] + weave->point[2 * (size_t)b + i]) / 2;
    count++;
  }
  for (int32_t s = 0; s < topology->side_count; s++) {
    int32_t a = topology->side[2 * s], b = topology->side[2 * s + 1];
    int one = topology->side_element[2 * s] >= 0 ? 0 : 1;
    int32_t e = -1, k = -1;
    /* flips left the sides' elements behind: look around the corner */
    int32_t from = one == 0 ? a : b, to = one == 0 ? b : a, at = weave->star[from];
    for (int turn = 0; turn < 2 && k < 0; turn++) {
      at = weave->star[from];
      while (at >= 0) {
        const int32_t *n = weave->element + 3 * (size_t)at;
        int c = n[0] == from ? 0 : n[1] == from ? 1 : 2;
        if (n[(c + 1) % 3] == to) {
          e = at;
          k = c;
          break;
        }
        at = weave->neighbour[3 * (size_t)at + (size_t)(turn == 0 ? (c + 2) % 3 : c)];
        if (at == weave->star[from])
          break;
      }
    }
    if (k < 0) {
      status = bw_fail(context, BW_INTERNAL, "filling: side %d was lost", s);
      goto done;
    }
    int32_t m = middle[3 * (size_t)e + (size_t)k], on = topology->side_segment[s];
    double end = (*segment)[b] == on && (*parameter)[b] > (*parameter)[a] ? (*parameter)[b] : 1;
    (*segment)[m] = on;
    (*parameter)[m] = ((*parameter)[a] + end) / 2;
    bw_outline_evaluate(outline, on, (*parameter)[m], *point + 2 * (size_t)m, NULL, NULL);
  }
  for (int32_t e = 0; e < elements; e++)
    for (size_t k = 0; k < 3; k++) {
      (*element)[6 * (size_t)e + k] = weave->element[3 * (size_t)e + k];
      (*element)[6 * (size_t)e + 3 + k] = middle[3 * (size_t)e + k];
    }
  *nodes = count;
done:
  bw_free(middle);
  return status;
}

/* *fits false: elements are inverted or folded, and nodes along the curves must be denser. */
static bw_status make_mesh(bw_context *context, const bw_outline *outline,
                           const bwi_fill_boundary *boundary, bwi_filling *filling, int order,
                           bool *fits, bw_plane_mesh **mesh) {
  bw_status status = BW_OK;
  bw_plane_topology *corners = NULL, *topology = NULL;
  bw_plane_nodes *made = NULL;
  bwi_weave weave = {0};
  int32_t *segment = NULL, *element = NULL, *region = NULL, nodes = 0, which = 0;
  double *parameter = NULL, *point = NULL;
  *fits = true;
  BW_TRY(open_weave(context, outline, boundary, filling, &corners, &weave));
  bwi_weave_queue_all(&weave);
  bwi_weave_flip(&weave);
  for (int round = 0; round < SMOOTHING; round++) {
    bwi_weave_smooth(&weave, 2, 0.75);
    bwi_weave_flip(&weave);
    BW_TRY(bw_check_cancel(context));
  }
  nodes = corners->nodes->node_count;
  if (order == 2) {
    BW_TRY(add_middles(context, outline, corners, &weave, &nodes, &segment, &parameter, &point,
                       &element));
  } else {
    segment = BW_NEW(context, int32_t, nodes);
    parameter = BW_NEW(context, double, nodes);
    if (!segment || !parameter) {
      status = BW_MEMORY;
      goto done;
    }
    memcpy(segment, corners->nodes->segment, (size_t)nodes * sizeof *segment);
    memcpy(parameter, corners->nodes->parameter, (size_t)nodes * sizeof *parameter);
    point = weave.point;
    element = weave.element;
    weave.point = NULL;
    weave.element = NULL;
  }
  region = BW_NEW(context, int32_t, filling->element_count);
  if (!region) {
    status = BW_MEMORY;
    goto done;
  }
  memcpy(region, corners->region, (size_t)filling->element_count * sizeof *region);
  status = bwi_plane_nodes_own(context, order, nodes, corners->nodes->corner_count, segment,
                               parameter, &made);
  segment = NULL;
  parameter = NULL;
  BW_TRY(status);
  status = bwi_plane_topology_own(context, made, outline, filling->element_count, element, region,
                                  &topology);
  element = region = NULL;
  BW_TRY(status);
  *fits = bwi_plane_worst(topology, point, &which) > 1e-3;
  status = bwi_plane_mesh_own(context, topology, outline, point, mesh);
  point = NULL;
done:
  bwi_weave_clear(&weave);
  bw_release(corners);
  bw_release(topology);
  bw_release(made);
  bw_free(segment);
  bw_free(parameter);
  bw_free(point);
  bw_free(element);
  bw_free(region);
  return status;
}

/* ---- filling ------------------------------------------------------------------------------------
 */

/* One filling with a size; `turn` is halved while boundary edges cross, and the angle is let go
 * where refinement towards it finds no end. */
static bw_status fill_once(bw_context *context, const bw_outline *outline,
                           const bw_plane_options *options, double area, bwi_size_field *field,
                           double *turn, double *angle, bwi_fill_boundary *boundary,
                           bwi_filling *filling) {
  bw_status status = BW_OK;
  for (int denser = 0;;) {
    bwi_fill_boundary_clear(boundary);
    bwi_filling_clear(filling);
    BW_TRY(bwi_fill_boundary_create(context, outline, field, *turn, boundary));
    int64_t limit = options->limit;
    if (!field->function && *angle > 0) {
      double expected = area / (EQUILATERAL * field->size * field->size);
      limit = (int64_t)fmin((double)limit, 8 * expected + 60.0 * boundary->count + 20000);
    }
    BW_TRY(bwi_fill_cgal(context, outline, boundary, field, *angle, limit, filling));
    BW_TRY(bwi_size_check(context, field));
    if (filling->crossed) {
      if (denser++ == DENSER) {
        status = bw_fail(context, BW_GEOMETRY,
                         "two parts of the outline come so close to each other that edges along "
                         "them cross even with %d nodes on it",
                         boundary->count);
        goto done;
      }
      *turn /= 2;
    } else if (filling->full) {
      if (limit == options->limit || *angle == 0) {
        status = bw_fail(context, BW_LIMIT,
                         "more than %d elements are needed: give a larger size, or raise the limit",
                         options->limit);
        goto done;
      }
      *angle = *angle > 20 ? 20 : *angle > 10 ? 10 : 0;
    } else {
      return BW_OK;
    }
  }
done:
  return status;
}

bw_status bwi_plane_fill(bw_context *context, const bw_outline *outline,
                         const bw_plane_options *given, double *guess, bw_plane_mesh **mesh) {
  bw_status status = BW_OK;
  bw_plane_options options = *given;
  bwi_fill_boundary boundary = {0};
  bwi_filling filling = {0};
  bw_outline_measures measures;
  bw_plane_mesh *made = NULL;
  BW_TRY(check_options(context, &options));
  BW_TRY(bw_outline_measure(context, outline, -1, &measures));
  double across = hypot(measures.high[0] - measures.low[0], measures.high[1] - measures.low[1]);
  double turn = options.curvature * 0.017453292519943295, angle = options.minimum_angle;
  bool counted = options.size == 0 && !options.field;
  bwi_size_field field = {
      .size = options.size, .function = options.field, .data = options.field_data};
  if (counted)
    field.size =
        *guess > 0 ? *guess : fmin(sqrt(measures.area / (EQUILATERAL * options.elements)), across);
  else if (options.size == 0)
    field.size = across;
  if (!options.field &&
      measures.area / (EQUILATERAL * field.size * field.size) > 2.0 * options.limit) {
    status =
        bw_fail(context, BW_LIMIT,
                "about %.3g elements of the size %g are needed, and the limit is %d: give a "
                "larger size, or raise the limit",
                measures.area / (EQUILATERAL * field.size * field.size), field.size, options.limit);
    goto done;
  }
  double off = INFINITY, best = field.size, before = 0;
  for (int tries = 0; tries <= COUNT_TRIES; tries++) {
    bw_progress(context, "filling", 0.8 * tries / (tries + 1));
    if (tries == COUNT_TRIES)
      field.size = best; /* no size gives the number wanted: the nearest */
    BW_TRY(fill_once(context, outline, &options, measures.area, &field, &turn, &angle, &boundary,
                     &filling));
    if (!counted)
      break;
    double ratio = (double)filling.element_count / options.elements;
    if (fabs(ratio - 1) < off) {
      off = fabs(ratio - 1);
      best = field.size;
    }
    /* details ask for more than is wanted, whatever the size */
    bool stuck = ratio > 1.1 && (field.size >= across || fabs(ratio - before) < 0.01 * ratio);
    before = ratio;
    if (stuck && field.size == best)
      break;
    if (off <= (tries < 3 ? 0.06 : 0.1) && field.size == best)
      break;
    field.size = fmin(field.size * fmin(fmax(sqrt(ratio), 0.25), 4), across);
  }
  for (int denser = 0;; denser++) {
    bool fits;
    if (filling.element_count < 1) {
      status = bw_fail(context, BW_GEOMETRY, "the outline has no inside that elements fit into");
      goto done;
    }
    bw_release(made);
    made = NULL;
    BW_TRY(make_mesh(context, outline, &boundary, &filling, options.order, &fits, &made));
    if (fits)
      break;
    if (denser == DENSER) { /* thinner than any element: only what is inverted is refused */
      int32_t which = 0;
      if (bwi_plane_worst(made->topology, made->point, &which) > 0)
        break;
      const double *at =
          made->point +
          2 * (size_t)made->topology
                  ->element[(size_t)bwi_plane_width(made->topology->nodes) * (size_t)which];
      status = bw_fail(context, BW_GEOMETRY,
                       "no element fits between the outline's curves near (%g, %g): the wall there "
                       "is too thin",
                       at[0], at[1]);
      bw_detail_number(context, "x", at[0]);
      bw_detail_number(context, "y", at[1]);
      goto done;
    }
    turn /= 2;
    BW_TRY(fill_once(context, outline, &options, measures.area, &field, &turn, &angle, &boundary,
                     &filling));
  }
  bw_progress(context, "filling", 1);
  *guess = counted ? field.size : 0;
  *mesh = made;
  made = NULL;
done:
  bw_release(made);
  bwi_fill_boundary_clear(&boundary);
  bwi_filling_clear(&filling);
  return status;
}

bw_status bw_plane_fill(bw_context *context, const bw_outline *outline,
                        const bw_plane_options *options, bw_plane_mesh **mesh) {
  double guess = 0;
  bw_plane_options standard;
  if (!options) {
    bw_plane_options_default(&standard);
    options = &standard;
  }
  bw_status status = bwi_plane_fill(context, outline, options, &guess, mesh);
  if (status != BW_OK || guess == 0)
    return status;
  double count = (*mesh)->topology->element_count;
  if (fabs(count / options->elements - 1) > 0.1)
    bw_remark(context, "%d elements were made where %d were wanted: the outline's details decide",
              (*mesh)->topology->element_count, options->elements);
  return BW_OK;
}
