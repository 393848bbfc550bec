/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* Singular places of a model: its re-entrant edges, the borders of its supports, and what acts on
 * points and lines (docs/theory/singular.md). */
#include "barwright/singular_places.h"

#include <math.h>
#include <string.h>

#include "mesh/surface_internal.h"
#include "model/singular_bond.h"
#include "model/singular_sector.h"

static const double along_normal = 0.999; /* cosine: a direction that is a facet's normal */
static const double nothing = 1e-12;      /* of the largest nodal force */
static const double pi = 3.14159265358979323846;

enum { FIXED_X = 1, FIXED_ALL = 7, OTHERWISE = 8 };

typedef struct finder {
  bw_context *context;
  const bw_model *model;
  bw_singular_places *places;
  bwi_seams seams;
  double poisson;
  double *normal;  /* per facet, unit outward */
  uint8_t *corner; /* per facet: bw_corner, BW_CORNER_FREE where nothing constrains it */
  uint8_t *rigid;  /* per facet: whether a rigid coupling constrains it, and no support */
  uint8_t *cut;    /* per facet: whether another sector goes on there */
  double margin;   /* (rad) of re-entrant edges in cuts */
} finder;

/* ---- borders of supports --------------------------------------------------------------------- */

/* Which of the facet's displacements a support constrains, as bits of directions. A support along
 * the facet's normal alone is no bit, and `slides` then. */
static uint8_t bits_of(const bw_support *support, const double normal[3], bool *slides) {
  const double *n = support->normal;
  uint8_t bits = 0;
  if (support->slide) {
    double size = bw_norm(n);
    if (size > 0 && fabs(bw_dot(n, normal)) < along_normal * size)
      return OTHERWISE;
    *slides = true;
    return 0;
  }
  for (int k = 0; k < 3; k++)
    if (support->fixed[k])
      bits |= (uint8_t)(FIXED_X << k);
  for (int k = 0; k < 3; k++)
    if (bits == FIXED_X << k && fabs(normal[k]) > along_normal) {
      *slides = true;
      return 0;
    }
  return bits;
}

static void classify(finder *f) {
  const bw_model *model = f->model;
  for (int i = 0; i < model->support_count; i++) {
    const bw_support *support = &model->support[i];
    for (int32_t j = 0; j < support->on->facet_count; j++) {
      int32_t t = support->on->facet[j];
      bool slides = false;
      if (bits_of(support, f->normal + 3 * (size_t)t, &slides))
        f->corner[t] = BW_CORNER_FIXED;
      else if (slides && f->corner[t] == BW_CORNER_FREE)
        f->corner[t] = BW_CORNER_SLIDING;
    }
  }
  for (int c = 0; c < model->coupling_count; c++) {
    const bw_selection *on = model->coupling[c].on;
    for (int32_t j = 0; j < on->facet_count && model->coupling[c].point.kind == BW_RIGID; j++)
      if (!on->node_set && f->corner[on->facet[j]] != BW_CORNER_FIXED) {
        f->corner[on->facet[j]] = BW_CORNER_FIXED;
        f->rigid[on->facet[j]] = 1;
      }
  }
  for (int s = 0; s < 2 && model->cyclic; s++) {
    const bw_selection *on = s == 0 ? model->cyclic->low : model->cyclic->high;
    for (int32_t j = 0; j < on->facet_count; j++)
      f->cut[on->facet[j]] = 1;
  }
}

/* The direction on a facet away from its side. */
static void along_face(bwi_seam *seam, const bwi_topology *top, int64_t side,
                       const double *normal) {
  const double *a = top->point + 3 * (size_t)bwi_side_from(top, side);
  const double *b = top->point + 3 * (size_t)bwi_side_to(top, side);
  const double d[3] = {b[0] - a[0], b[1] - a[1], b[2] - a[2]};
  bw_cross(normal + 3 * (size_t)(side / 3), d, seam->inward);
  double size = bw_norm(seam->inward);
  for (int k = 0; k < 3 && size > 0; k++)
    seam->inward[k] /= size;
}

/* Edges between a facet that is constrained like this and a free one; of free ones those in the
 * cuts of a sector. */
static bw_status find_borders(finder *f, const bwi_topology *top, const bw_faces *faces,
                              bw_corner corner, bw_singular_kind kind) {
  f->seams.count = 0;
  for (int64_t e = 0; e < top->edges; e++) {
    const int64_t *side = top->side + top->start[e];
    if (top->start[e + 1] - top->start[e] != 2)
      continue;
    int32_t t1 = (int32_t)(side[0] / 3), t2 = (int32_t)(side[1] / 3);
    if (corner == BW_CORNER_FREE || f->cut[t1] || f->cut[t2])
      continue;
    if (f->corner[t1] + f->corner[t2] != (int)corner || f->corner[t1] == f->corner[t2])
      continue;
    bool first = f->corner[t1] != BW_CORNER_FREE;
    if (f->rigid[first ? t1 : t2] != (kind == BW_SINGULAR_COUPLING))
      continue;
    bwi_seam seam = {.end = {bwi_side_from(top, side[0]), bwi_side_to(top, side[0])},
                     .key = {faces->of_triangle[first ? t1 : t2],
                             faces->of_triangle[first ? t2 : t1], (int32_t)corner}};
    seam.angle =
        bwi_opening(top->point + 3 * (size_t)seam.end[0], top->point + 3 * (size_t)seam.end[1],
                    f->normal + 3 * (size_t)t1, f->normal + 3 * (size_t)t2, seam.inward);
    if (corner == BW_CORNER_SLIDING && 2 * seam.angle - pi <= BWI_FACET_MARGIN)
      continue;
    /* the bisector of the whole wedge lies in the constrained face */
    if (corner == BW_CORNER_SLIDING)
      along_face(&seam, top, side[first ? 0 : 1], f->normal);
    bw_status status = bwi_seams_add(f->context, &f->seams, &seam);
    if (status != BW_OK)
      return status;
  }
  if (f->model->cyclic) {
    const bwi_sector_border border = {f->model->mesh, f->model->cyclic, top,    faces,
                                      f->normal,      f->corner,        f->cut, f->margin};
    bw_status status = bwi_sector_seams(f->context, &border, corner, &f->seams);
    if (status != BW_OK)
      return status;
  }
  return bwi_singular_chain(f->context, f->places, &f->seams, top->points, top->point, kind, corner,
                            f->poisson);
}

/* Where bonds end. */
static bw_status find_ends(finder *f, const bwi_topology *top, const bw_faces *faces) {
  const bwi_sector_border border = {f->model->mesh, NULL,      top,    faces,
                                    f->normal,      f->corner, f->cut, f->margin};
  f->seams.count = 0;
  bw_status status = bwi_bond_seams(f->context, f->model, &border, &f->seams);
  if (status != BW_OK)
    return status;
  return bwi_singular_chain(f->context, f->places, &f->seams, top->points, top->point,
                            BW_SINGULAR_BOND, BW_CORNER_FREE, f->poisson);
}

static bw_status support_borders(finder *f, const bw_surface *boundary) {
  bw_status status;
  bwi_topology *top = NULL;
  bw_faces *faces = NULL;
  BW_TRY(bwi_topology_create(f->context, boundary, &top));
  BW_TRY(bw_faces_find(f->context, boundary, 0, &faces));
  BW_TRY(find_borders(f, top, faces, BW_CORNER_FIXED, BW_SINGULAR_SUPPORT));
  if (f->model->coupling_count > 0)
    BW_TRY(find_borders(f, top, faces, BW_CORNER_FIXED, BW_SINGULAR_COUPLING));
  if (f->model->bond_count > 0)
    BW_TRY(find_ends(f, top, faces));
  BW_TRY(find_borders(f, top, faces, BW_CORNER_SLIDING, BW_SINGULAR_SUPPORT));
  BW_TRY(find_borders(f, top, faces, BW_CORNER_FREE, BW_SINGULAR_EDGE));
done:
  bw_release(faces);
  bwi_topology_destroy(top);
  return status;
}

/* ---- points and lines ------------------------------------------------------------------------ */

static void mark_loads(const finder *f, uint8_t *mark) {
  const bw_model *model = f->model;
  for (int i = 0; i < model->load_count; i++) {
    const bw_load *load = &model->load[i];
    double max = 0;
    for (int pass = 0; pass < 2 && load->kind == BW_LOAD_NODAL; pass++)
      for (int32_t n = 0; n < model->mesh->node_count; n++) {
        double force[3];
        for (int k = 0; k < 3; k++)
          force[k] = bw_array_get(load->nodal, n, k);
        if (pass == 0)
          max = fmax(max, bw_norm(force));
        else if (bw_norm(force) > nothing * max)
          mark[n] = 1;
      }
  }
}

static void mark_supports(const finder *f, uint8_t *mark) {
  for (int i = 0; i < f->model->support_count; i++) {
    const bw_selection *on = f->model->support[i].on;
    for (int32_t j = 0; j < on->node_count && on->node_set; j++)
      mark[on->node[j]] = 1;
  }
  for (int i = 0; i < f->model->attachment_count; i++) {
    const bw_attachment *at = &f->model->attachment[i];
    for (int32_t j = 0; j < at->on->node_count && at->on->node_set && !(at->mass > 0); j++)
      mark[at->on->node[j]] = 1;
  }
  for (int i = 0; i < f->model->coupling_count; i++) {
    const bw_selection *on = f->model->coupling[i].on;
    for (int32_t j = 0; j < on->node_count && on->node_set; j++)
      mark[on->node[j]] = 1;
  }
}

/* Facets of which three nodes and more are marked are an area: their nodes are marked no longer. */
static void unmark_areas(const bw_mesh *mesh, uint8_t *mark) {
  enum { AREA = 2 };
  for (int32_t t = 0; t < mesh->facet_count; t++) {
    const int32_t *node = mesh->facet + (size_t)t * mesh->nodes_per_facet;
    int marked = 0;
    bool line = false; /* an edge with its mid-edge node is no area */
    for (int a = 0; a < mesh->nodes_per_facet; a++)
      marked += mark[node[a]] != 0;
    for (int a = 0; a < 3 && marked == 3 && mesh->order == 2; a++)
      line = line || (mark[node[a]] && mark[node[(a + 1) % 3]] && mark[node[3 + a]]);
    for (int a = 0; a < mesh->nodes_per_facet && marked >= 3 && !line; a++)
      if (mark[node[a]])
        mark[node[a]] = AREA;
  }
  for (int32_t n = 0; n < mesh->node_count; n++)
    if (mark[n] == AREA)
      mark[n] = 0;
}

static bw_status add_point(finder *f, int32_t node, const double *mean, bw_singular_kind kind) {
  const bw_singular_place place = {.kind = kind, .exponent = -1};
  double inward[3], size = bw_norm(mean);
  for (int k = 0; k < 3; k++)
    inward[k] = size > 0 ? -mean[k] / size : 0;
  return bwi_singular_add(f->context, f->places, &place, 1, f->model->mesh->node + 3 * (size_t)node,
                          inward);
}

/* Lines of marked nodes, then marked nodes by themselves. */
static bw_status add_marked(finder *f, uint8_t *mark, const double *mean, bw_singular_kind line,
                            bw_singular_kind point) {
  const bw_mesh *mesh = f->model->mesh;
  bw_status status = BW_OK;
  f->seams.count = 0;
  unmark_areas(mesh, mark);
  uint8_t *on_line = BW_NEW0(f->context, uint8_t, mesh->node_count);
  if (!on_line)
    return BW_MEMORY;
  for (int32_t t = 0; t < mesh->facet_count; t++)
    for (int a = 0; a < 3; a++) {
      const int32_t *node = mesh->facet + (size_t)t * mesh->nodes_per_facet;
      const int32_t own[3] = {node[a], node[(a + 1) % 3], mesh->order == 2 ? node[3 + a] : node[a]};
      int marked =
          (mark[own[0]] != 0) + (mark[own[1]] != 0) + (mesh->order == 2 && mark[own[2]] != 0);
      if (marked < 2 || own[0] > own[1])
        continue;
      bwi_seam seam = {.end = {own[0], own[1]}};
      for (int k = 0; k < 3; k++) {
        on_line[own[k]] = 1;
        seam.inward[k] = -f->normal[3 * (size_t)t + (size_t)k];
      }
      BW_TRY(bwi_seams_add(f->context, &f->seams, &seam));
    }
  BW_TRY(bwi_singular_chain(f->context, f->places, &f->seams, mesh->node_count, mesh->node, line,
                            BW_CORNER_FREE, 0));
  for (int32_t n = 0; n < mesh->node_count; n++)
    if (mark[n] && !on_line[n])
      BW_TRY(add_point(f, n, mean + 3 * (size_t)n, point));
done:
  bw_free(on_line);
  return status;
}

static bw_status points_and_lines(finder *f) {
  const bw_mesh *mesh = f->model->mesh;
  bw_status status = BW_OK;
  uint8_t *mark = BW_NEW0(f->context, uint8_t, mesh->node_count);
  double *mean = BW_NEW0(f->context, double, 3 * (size_t)mesh->node_count);
  BW_TRY_MEMORY(mark && mean);
  for (int32_t t = 0; t < mesh->facet_count; t++)
    for (int a = 0; a < mesh->nodes_per_facet; a++)
      for (int k = 0; k < 3; k++)
        mean[3 * (size_t)mesh->facet[(size_t)t * mesh->nodes_per_facet + a] + (size_t)k] +=
            f->normal[3 * (size_t)t + (size_t)k];
  mark_loads(f, mark);
  BW_TRY(add_marked(f, mark, mean, BW_SINGULAR_LINE_LOAD, BW_SINGULAR_POINT_LOAD));
  memset(mark, 0, (size_t)mesh->node_count);
  mark_supports(f, mark);
  BW_TRY(add_marked(f, mark, mean, BW_SINGULAR_LINE_SUPPORT, BW_SINGULAR_POINT_SUPPORT));
done:
  bw_free(mark);
  bw_free(mean);
  return status;
}

/* ---- the whole ------------------------------------------------------------------------------- */

static double poisson_of(const bw_material *material) {
  double max = -1;
  for (int32_t i = 0; i < bw_material_part_count(material); i++)
    for (int k = 0; k < 3; k++)
      max = fmax(max, bw_material_part(material, i)->poisson[k]);
  return fmin(max, 0.4999);
}

bw_status bw_singular_places_find(bw_context *context, const bw_model *model,
                                  const bw_surface *surface, double margin,
                                  bw_singular_places **places) {
  bw_status status;
  bw_surface *boundary = NULL;
  finder f = {.context = context, .model = model, .poisson = poisson_of(model->material)};
  const size_t facets = (size_t)model->mesh->facet_count;
  BW_TRY(bw_mesh_boundary(context, model->mesh, &boundary, NULL));
  BW_TRY(bw_singular_edges(context, surface ? surface : boundary, NULL, margin, &f.places));
  f.normal = BW_NEW(context, double, 3 * facets);
  f.corner = BW_NEW0(context, uint8_t, facets);
  f.rigid = BW_NEW0(context, uint8_t, facets);
  f.cut = BW_NEW0(context, uint8_t, facets);
  f.margin = margin > 0 ? margin : BWI_FACET_MARGIN;
  BW_TRY_MEMORY(f.normal && f.corner && f.rigid && f.cut);
  if (model->cyclic)
    BW_TRY(bwi_sector_without_cuts(context, model, &f.places));
  for (size_t t = 0; t < facets; t++) {
    double *n = f.normal + 3 * t;
    bwi_facet_normal(boundary->point, boundary->triangle + 3 * t, n);
    double size = bw_norm(n);
    for (int k = 0; k < 3; k++)
      n[k] = size > 0 ? n[k] / size : 0;
  }
  classify(&f);
  BW_TRY(support_borders(&f, boundary));
  BW_TRY(points_and_lines(&f));
  bwi_singular_sort(f.places);
  *places = f.places;
  f.places = NULL;
done:
  bw_release(f.places);
  bw_release(boundary);
  bw_free(f.normal);
  bw_free(f.corner);
  bw_free(f.rigid);
  bw_free(f.cut);
  bw_free(f.seams.seam);
  return status;
}
