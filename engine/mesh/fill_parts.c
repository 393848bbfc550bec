/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* Several closed surfaces filled with one conforming mesh, a region for each.
 *
 * Parts that come near each other are refined by each other, so that what they have in common has
 * the same points, edges and facets in both, and each facet lies on one side of every other part.
 * Then a part has facets inside another one and outside of it only where the two overlap. TetGen
 * gets every facet once and says which elements lie between which facets; the region of such a
 * subdomain is the smallest part that holds it, and a subdomain in no part is a cavity. */
#include "mesh/fill_internal.h"
#include "mesh/mesh_internal.h"
#include "mesh/surface_cgal.h"
#include "mesh/surface_contains.h"
#include "mesh/surface_internal.h"

#include <math.h>
#include <string.h>

enum { MAX_ROUNDS = 5 };

typedef struct filling {
  bw_context *context;
  const bw_fill_part *part;
  const bw_fill_options *options;
  int32_t count;
  double tolerance;
  bw_surface **surface; /* of each part, as refined so far */
  bwi_container *container;
  double *volume;
  bw_surface *whole; /* all facets, part behind part */
  int32_t *start;    /* count + 1: the first facet of each part in `whole` */
  int32_t *same;     /* of each facet of `whole`: the first one of the same corners */
  bwi_topology *topology;
} filling;

static bw_status check_part(filling *f, int32_t p) {
  bw_surface_report report = {0};
  const bw_fill_part *part = &f->part[p];
  bw_status status = BW_OK;
  if (!part->name.text[0])
    return bw_fail(f->context, BW_INVALID, "part %d has no name: each part needs one", p + 1);
  for (int32_t q = 0; q < p; q++)
    if (strcmp(f->part[q].name.text, part->name.text) == 0)
      return bw_fail(f->context, BW_INVALID,
                     "two parts are called '%s': each needs a name of its own", part->name.text);
  BW_TRY(bw_surface_check(f->context, part->surface, 0, &report));
  if (!report.sound) {
    char text[200];
    bwi_fill_describe_defects(&report, text, sizeof text);
    BW_TRY(bw_fail(f->context, BW_GEOMETRY,
                   "the surface of the part '%s' is not sound (%s): repair it first",
                   part->name.text, text));
  }
  f->volume[p] = report.volume;
done:
  bw_surface_report_clear(&report);
  return status;
}

/* All surfaces in one, in which points nearer than the tolerance are one. */
static bw_status join(filling *f, double tolerance) {
  bw_status status = BW_OK;
  bw_surface *all = NULL, *welded = NULL;
  bw_face_names *names = NULL;
  double *point = NULL;
  int32_t *triangle = NULL, *group = NULL;
  int64_t points = 0, facets = 0;
  BW_TRY(bwi_name_alike(f->context, f->count, f->surface, &names));
  for (int32_t p = 0; p < f->count; p++) {
    points += f->surface[p]->point_count;
    facets += f->surface[p]->triangle_count;
  }
  point = BW_NEW(f->context, double, 3 * points);
  triangle = BW_NEW(f->context, int32_t, 3 * facets);
  if (names)
    group = BW_NEW(f->context, int32_t, facets);
  BW_TRY_MEMORY(point && triangle && (group || !names));
  if (points > INT32_MAX || facets > INT32_MAX / 3)
    BW_TRY(bw_fail(f->context, BW_LIMIT, "the parts have %lld facets together: at most %d",
                   (long long)facets, INT32_MAX / 3));
  points = facets = 0;
  for (int32_t p = 0; p < f->count; p++) {
    const bw_surface *s = f->surface[p];
    f->start[p] = (int32_t)facets;
    memcpy(point + 3 * points, s->point, 24 * (size_t)s->point_count);
    for (int64_t i = 0; i < 3 * (int64_t)s->triangle_count; i++)
      triangle[3 * facets + i] = (int32_t)points + s->triangle[i];
    if (group)
      memcpy(group + facets, s->group, (size_t)s->triangle_count * sizeof *group);
    points += s->point_count;
    facets += s->triangle_count;
  }
  f->start[f->count] = (int32_t)facets;
  BW_TRY(bw_surface_adopt(f->context, points, point, facets, triangle, group, &all));
  all->names = bw_retain(names);
  point = NULL;
  triangle = group = NULL;
  BW_TRY(bw_surface_weld(f->context, all, tolerance, &welded));
  bw_release(f->whole);
  f->whole = welded;
done:
  bw_free(point);
  bw_free(triangle);
  bw_free(group);
  bw_release(names);
  bw_release(all);
  return status;
}

/* The parts with the points of `whole`. */
static bw_status take_apart(filling *f) {
  for (int32_t p = 0; p < f->count; p++) {
    bw_surface *own = NULL, *welded = NULL;
    bw_status status = bw_surface_copy(
        f->context, f->whole->point_count, f->whole->point, f->start[p + 1] - f->start[p],
        f->whole->triangle + 3 * (int64_t)f->start[p],
        f->whole->group ? f->whole->group + f->start[p] : NULL, &own);
    if (status == BW_OK) {
      bwi_keep_names(f->whole, own);
      status = bw_surface_weld(f->context, own, 0, &welded); /* drops what others use */
    }
    bw_release(own);
    if (status != BW_OK)
      return status;
    bw_release(f->surface[p]);
    f->surface[p] = welded;
  }
  return BW_OK;
}

/* ---- refining by each other ----------------------------------------------------------------- */

static bool found(void *data, int32_t facet) {
  (void)facet;
  *(bool *)data = true;
  return false;
}

/* Does a box around a facet of one surface meet one of the other? */
static bw_status come_near(filling *f, const bw_surface *a, const bw_surface *b, bool *near) {
  bwi_tree *tree = NULL;
  *near = false;
  bw_status status =
      bwi_tree_create(f->context, a->point, a->triangle_count, a->triangle, NULL, &tree);
  for (int32_t t = 0; t < b->triangle_count && status == BW_OK && !*near; t++) {
    double low[3] = {HUGE_VAL, HUGE_VAL, HUGE_VAL}, high[3] = {-HUGE_VAL, -HUGE_VAL, -HUGE_VAL};
    for (int k = 0; k < 3; k++)
      for (int i = 0; i < 3; i++) {
        double x = b->point[3 * (int64_t)b->triangle[3 * (int64_t)t + k] + i];
        low[i] = fmin(low[i], x - f->tolerance);
        high[i] = fmax(high[i], x + f->tolerance);
      }
    bwi_tree_in_box(tree, low, high, found, near);
  }
  bwi_tree_destroy(tree);
  return status;
}

/* Refines two parts by each other; *changed when one has more facets than before. */
static bw_status refine_pair(filling *f, int32_t p, int32_t q, bool *changed) {
  bwi_child_limits limits = {.seconds = f->options->time_limit, .bytes = f->options->memory_limit};
  bw_surface *made[2] = {NULL, NULL};
  bw_status status = BW_OK;
  for (int k = 0; k < 2; k++) {
    bwi_refine_job job = {f->surface[p], f->surface[q], k == 1};
    BW_TRY(bwi_cgal_surface(f->context, "joining the faces of parts that touch", &limits,
                            bwi_cgal_refine, &job, &made[k]));
  }
  for (int k = 0; k < 2; k++) {
    bw_surface **own = &f->surface[k == 0 ? p : q];
    *changed = *changed || made[k]->triangle_count != (*own)->triangle_count;
    if ((*own)->names)
      BW_TRY(bwi_take_groups(f->context, *own, made[k]));
    bw_release(*own);
    *own = made[k];
    made[k] = NULL;
  }
done:
  bw_release(made[0]);
  bw_release(made[1]);
  return status;
}

static bw_status refine(filling *f) {
  bw_status status = BW_OK;
  bool changed = true;
  for (int round = 0; round < MAX_ROUNDS && changed; round++) {
    changed = false;
    for (int32_t p = 0; p < f->count; p++)
      for (int32_t q = p + 1; q < f->count; q++) {
        bool near;
        BW_TRY(come_near(f, f->surface[p], f->surface[q], &near));
        if (near)
          BW_TRY(refine_pair(f, p, q, &changed));
      }
  }
  BW_TRY(join(f, f->tolerance)); /* what was rounded apart */
  status = take_apart(f);
done:
  return status;
}

/* ---- overlaps ------------------------------------------------------------------------------- */

static void facet_middle(const bw_surface *s, int32_t t, double at[3]) {
  const int32_t *corner = s->triangle + 3 * (int64_t)t;
  for (int k = 0; k < 3; k++)
    at[k] = (s->point[3 * (int64_t)corner[0] + k] + s->point[3 * (int64_t)corner[1] + k] +
             s->point[3 * (int64_t)corner[2] + k]) /
            3;
}

/* Facets of part p that are inside of part q (sides[1]) and outside (sides[0]); common ones are
 * neither. `of`: scratch, by class of equal facets. */
static bw_status find_sides(filling *f, int32_t p, int32_t q, int32_t *of, int64_t sides[2]) {
  sides[0] = sides[1] = 0;
  for (int32_t t = f->start[q]; t < f->start[q + 1]; t++)
    of[f->same[t]] = q;
  for (int32_t t = f->start[p]; t < f->start[p + 1]; t++) {
    double at[3];
    bool inside, unclear;
    if (of[f->same[t]] == q)
      continue;
    facet_middle(f->whole, t, at);
    bw_status status = bwi_container_holds(f->context, &f->container[q], at, &inside, &unclear);
    if (status != BW_OK)
      return status;
    if (!unclear)
      sides[inside]++;
  }
  for (int32_t t = f->start[q]; t < f->start[q + 1]; t++)
    of[f->same[t]] = -1;
  return BW_OK;
}

static bw_status check_overlaps(filling *f) {
  bw_status status = BW_OK;
  int32_t *of = BW_NEW(f->context, int32_t, f->whole->triangle_count);
  BW_TRY_MEMORY(of);
  memset(of, -1, (size_t)f->whole->triangle_count * sizeof *of);
  for (int32_t p = 0; p < f->count; p++)
    for (int32_t q = p + 1; q < f->count; q++) {
      int64_t a[2], b[2];
      const char *one = f->part[p].name.text, *two = f->part[q].name.text;
      BW_TRY(find_sides(f, p, q, of, a));
      BW_TRY(find_sides(f, q, p, of, b));
      BW_TRY(bw_check_cancel(f->context));
      if (a[0] + a[1] + b[0] + b[1] == 0)
        BW_TRY(bw_fail(f->context, BW_GEOMETRY,
                       "the parts '%s' and '%s' are the same body: leave one out", one, two));
      if ((a[0] && a[1]) || (b[0] && b[1]) || (a[1] && b[1]))
        BW_TRY(bw_fail(f->context, BW_GEOMETRY,
                       "the parts '%s' and '%s' overlap: one must lie inside the other, or only "
                       "their surfaces may touch",
                       one, two));
    }
done:
  bw_free(of);
  return status;
}

static bw_status prepare(filling *f) {
  bw_status status = BW_OK;
  double low[3], high[3], d[3];
  for (int32_t p = 0; p < f->count; p++) {
    BW_TRY(check_part(f, p));
    BW_TRY(bw_surface_weld(f->context, f->part[p].surface, 0, &f->surface[p]));
  }
  BW_TRY(join(f, 0));
  bw_surface_box(f->whole, low, high);
  for (int k = 0; k < 3; k++)
    d[k] = high[k] - low[k];
  if (f->tolerance == 0)
    f->tolerance = 1e-9 * bw_norm(d);
  BW_TRY(join(f, f->tolerance));
  BW_TRY(take_apart(f));
  BW_TRY(refine(f));
  BW_TRY(bwi_topology_create(f->context, f->whole, &f->topology));
  for (int32_t t = 0, p = 0; t < f->whole->triangle_count; t++) {
    while (t >= f->start[p + 1])
      p++;
    if (f->topology->degenerate[t])
      BW_TRY(bw_fail(f->context, BW_GEOMETRY,
                     "the part '%s' has facets smaller than the tolerance of %g m: give a smaller "
                     "one, or remesh the part",
                     f->part[p].name.text, f->tolerance));
  }
  f->same = BW_NEW(f->context, int32_t, f->whole->triangle_count);
  BW_TRY_MEMORY(f->same);
  BW_TRY(bwi_same_facets(f->context, f->topology, f->same));
  for (int32_t p = 0; p < f->count; p++)
    BW_TRY(bwi_container_create(f->context, f->surface[p], &f->container[p]));
  status = check_overlaps(f);
done:
  return status;
}

/* ---- elements ------------------------------------------------------------------------------- */

typedef struct limited {
  const bw_size_field *field;
  double length;
} limited;

/* What the field asks for, or the length where that is less. */
static double limited_size(void *data, const double at[3]) {
  const limited *limit = data;
  double bound = bwi_size_at(limit->field, at);
  return bound == 0 || bound > limit->length ? limit->length : bound;
}

static bw_status run_tetgen(filling *f, bwi_tetgen_result *result) {
  const bw_fill_options *o = f->options;
  bw_size_field field = {o->size_point_count, o->size_point, o->size, o->size_data};
  limited limit = {&field, o->edge_length};
  bw_size_field sizes = {.size = limited_size, .data = &limit};
  int32_t count = 0, *triangle = BW_NEW(f->context, int32_t, 3 * (size_t)f->whole->triangle_count);
  if (!triangle)
    return BW_MEMORY;
  for (int32_t t = 0; t < f->whole->triangle_count; t++)
    if (f->same[t] == t)
      memcpy(triangle + 3 * (size_t)count++, f->whole->triangle + 3 * (size_t)t,
             3 * sizeof *triangle);
  bwi_tetgen_job job = {.point_count = f->whole->point_count,
                        .triangle_count = count,
                        .point = f->whole->point,
                        .triangle = triangle,
                        .subdomains = true,
                        .max_volume = o->max_volume,
                        .radius_edge = o->radius_edge,
                        .dihedral = o->dihedral,
                        .keep_surface = o->keep_surface,
                        .field = o->edge_length > 0                   ? &sizes
                                 : o->size_point_count > 0 || o->size ? &field
                                                                      : NULL,
                        .limits = {.seconds = o->time_limit, .bytes = o->memory_limit}};
  bw_status status = bwi_tetgen_run(f->context, &job, result);
  bw_free(triangle);
  return status;
}

/* The part of each subdomain, -1 for a cavity, by the centroid of its largest element. */
static bw_status find_parts(filling *f, const bwi_tetgen_result *r, int32_t *max, int32_t **part) {
  bw_status status = BW_OK;
  *max = 0;
  for (int64_t e = 0; e < r->element_count; e++)
    *max = r->subdomain[e] > *max ? r->subdomain[e] : *max;
  double *largest = BW_NEW0(f->context, double, *max + 1);
  int64_t *element = BW_NEW0(f->context, int64_t, *max + 1);
  *part = BW_NEW(f->context, int32_t, *max + 1);
  BW_TRY_MEMORY(largest && element && *part);
  for (int64_t e = 0; e < r->element_count; e++) {
    const int32_t *n = r->element + 4 * e;
    const double *x = r->node;
    double volume = fabs(bwi_tet_determinant(x + 3 * (int64_t)n[0], x + 3 * (int64_t)n[1],
                                             x + 3 * (int64_t)n[2], x + 3 * (int64_t)n[3], NULL));
    int32_t s = r->subdomain[e] < 0 ? 0 : r->subdomain[e];
    if (volume > largest[s]) {
      largest[s] = volume;
      element[s] = e;
    }
  }
  for (int32_t s = 0; s <= *max; s++) {
    (*part)[s] = -1;
    if (largest[s] == 0)
      continue;
    double at[3] = {0, 0, 0};
    for (int a = 0; a < 4; a++)
      for (int k = 0; k < 3; k++)
        at[k] += 0.25 * r->node[3 * (int64_t)r->element[4 * element[s] + a] + k];
    for (int32_t p = 0; p < f->count; p++) {
      bool inside, unclear;
      BW_TRY(bwi_container_holds(f->context, &f->container[p], at, &inside, &unclear));
      if (inside && ((*part)[s] < 0 || f->volume[p] < f->volume[(*part)[s]]))
        (*part)[s] = p;
    }
  }
done:
  bw_free(largest);
  bw_free(element);
  return status;
}

/* The elements that lie in a part, with their regions. */
static bw_status make_mesh(filling *f, bwi_tetgen_result *r, bw_mesh **mesh) {
  bw_status status = BW_OK;
  int32_t max, *part = NULL;
  int64_t kept = 0;
  bw_mesh *straight = NULL, *ordered = NULL;
  bw_mesh_region *region = BW_NEW0(f->context, bw_mesh_region, f->count);
  BW_TRY_MEMORY(region);
  BW_TRY(find_parts(f, r, &max, &part));
  for (int64_t e = 0; e < r->element_count; e++) {
    int32_t p = part[r->subdomain[e] < 0 ? 0 : r->subdomain[e]];
    if (p < 0)
      continue;
    memmove(r->element + 4 * kept, r->element + 4 * e, 4 * sizeof *r->element);
    r->subdomain[kept++] = p;
    region[p].element_count++;
  }
  for (int32_t p = 0; p < f->count; p++) {
    if (region[p].element_count == 0)
      BW_TRY(bw_fail(f->context, BW_GEOMETRY,
                     "the part '%s' has no volume of its own: other parts fill it",
                     f->part[p].name.text));
    region[p].tag = p + 1;
    region[p].name = f->part[p].name;
  }
  bw_mesh_regions regions = {f->count, region, r->subdomain};
  BW_TRY(
      bw_mesh_adopt(f->context, 1, r->node_count, r->node, kept, r->element, &regions, &straight));
  r->node = NULL;
  r->element = NULL;
  BW_TRY(bwi_mesh_take_names(f->context, f->whole, straight));
  BW_TRY(bw_mesh_with_order(f->context, straight, f->options->order, &ordered));
  status = bw_mesh_renumbered(f->context, ordered, NULL, NULL, mesh);
done:
  bw_free(part);
  bw_free(region);
  bw_release(straight);
  bw_release(ordered);
  return status;
}

bw_status bw_mesh_fill_parts(bw_context *context, int32_t count, const bw_fill_part *part,
                             double tolerance, const bw_fill_options *options, bw_mesh **mesh) {
  bw_fill_options defaults;
  bw_fill_options_default(&defaults);
  filling f = {.context = context,
               .part = part,
               .options = options ? options : &defaults,
               .count = count,
               .tolerance = tolerance};
  bwi_tetgen_result result = {.node = NULL};
  bw_status status;
  BW_TRY(bwi_fill_check_options(context, f.options));
  if (count < 1 || !(tolerance >= 0))
    BW_TRY(
        bw_fail(context, BW_INVALID,
                "%d parts and a tolerance of %g m: at least one part and 0 or more were expected",
                count, tolerance));
  if (f.options->elements > 0)
    BW_TRY(bw_fail(context, BW_UNSUPPORTED,
                   "several surfaces are not filled to a number of elements: give edge_length or "
                   "max_volume"));
  f.surface = BW_NEW0(context, bw_surface *, count);
  f.container = BW_NEW0(context, bwi_container, count);
  f.volume = BW_NEW0(context, double, count);
  f.start = BW_NEW0(context, int32_t, (size_t)count + 1);
  BW_TRY_MEMORY(f.surface && f.container && f.volume && f.start);
  bw_progress(context, "filling", 0);
  BW_TRY(prepare(&f));
  BW_TRY(run_tetgen(&f, &result));
  BW_TRY(make_mesh(&f, &result, mesh));
  bw_progress(context, "filling", 1);
done:
  for (int32_t p = 0; p < count; p++) {
    if (f.surface)
      bw_release(f.surface[p]);
    if (f.container)
      bwi_container_clear(&f.container[p]);
  }
  bw_free(f.surface);
  bw_free(f.container);
  bw_free(f.volume);
  bw_free(f.start);
  bw_free(f.same);
  bwi_topology_destroy(f.topology);
  bw_release(f.whole);
  bw_free(result.node);
  bw_free(result.element);
  bw_free(result.subdomain);
  return status;
}
