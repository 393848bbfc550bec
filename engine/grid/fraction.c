/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* How much of each cell of a lattice lies inside a closed surface.
 *
 * Take a line along x. Where it enters the body it adds to every cell what lies behind the place,
 * where it leaves it takes that away: the length inside the cell [i, i + 1] is the sum of
 * s clamp(i + 1 - x, 0, 1) over the places x where the line meets the surface, s = 1 entering and
 * -1 leaving. Summed over all lines, the volume inside a cell is an integral over the facets in its
 * column, of a function that is linear between the planes of the lattice. Facets are cut at these
 * planes, and each piece adds two numbers to its cell:
 *
 *   area: s times its area seen along x, which counts in full for every cell behind;
 *   cut:  the integral of s (i + 1 - x), which counts for the cell itself.
 *
 * So fractions are exact but for rounding, no line can hit an edge or a vertex, and facets along x
 * add nothing. What is needed of the surface is that facets cancel at every edge: as many run along
 * it one way as the other. Lengths are in cells from here on. */
#include "grid/internal.h"
#include "mesh/surface_topology.h"

#include <math.h>
#include <string.h>

/* Rounding of a cell's sum; beyond it, cells that count twice or negatively. */
#define ROUNDING 1e-9
#define OVERLAP 1e-6
/* A convex polygon of 3 corners gains one by each of six planes; rounding may add some. */
enum { CORNERS = 24 };

typedef struct polygon {
  int count;
  double corner[CORNERS][3];
} polygon;

typedef struct job {
  bw_context *context;
  const bw_surface *surface;
  double origin[3], spacing[3];
  int32_t cells[3];
  int64_t *start; /* facets by layer of cells */
  int32_t *facet;
  double *area, *cut; /* one layer per worker */
  double *fraction;
} job;

/* ---- polygons -------------------------------------------------------------------------------- */

static void add_corner(polygon *p, const double at[3]) {
  if (p->count < CORNERS)
    memcpy(p->corner[p->count++], at, 3 * sizeof *at);
}

/* The part below a plane goes to `below`, what is above stays. */
static void split(polygon *p, int axis, double plane, polygon *below) {
  polygon above;
  above.count = below->count = 0;
  for (int i = 0; i < p->count; i++) {
    const double *a = p->corner[i], *b = p->corner[i + 1 < p->count ? i + 1 : 0];
    if (a[axis] <= plane)
      add_corner(below, a);
    if (a[axis] >= plane)
      add_corner(&above, a);
    if ((a[axis] < plane && b[axis] > plane) || (a[axis] > plane && b[axis] < plane)) {
      double t = (plane - a[axis]) / (b[axis] - a[axis]), x[3];
      for (int d = 0; d < 3; d++)
        x[d] = d == axis ? plane : a[d] + t * (b[d] - a[d]);
      add_corner(below, x);
      add_corner(&above, x);
    }
  }
  *p = above;
}

static void extent(const polygon *p, int axis, double *low, double *high) {
  *low = *high = p->count ? p->corner[0][axis] : 0;
  for (int i = 1; i < p->count; i++) {
    *low = fmin(*low, p->corner[i][axis]);
    *high = fmax(*high, p->corner[i][axis]);
  }
}

/* The slabs [i, i + 1] among 0..count - 1 that an extent meets: first > last when none. */
static void slabs(double low, double high, int32_t count, int32_t *first, int32_t *last) {
  *first = 0;
  *last = -1;
  if (high < 0 || low > count)
    return;
  *first = low <= 0 ? 0 : low >= count - 1 ? count - 1 : (int32_t)low;
  *last = high >= count ? count - 1 : (int32_t)high;
}

/* s times the area seen along x, and times the integral of (plane - x). Entering means facing
 * against x, which makes the corners run clockwise in (y, z). */
static void integrate(const polygon *p, double plane, double *area, double *cut) {
  for (int i = 2; i < p->count; i++) {
    const double *a = p->corner[0], *b = p->corner[i - 1], *c = p->corner[i];
    double twice = (b[2] - a[2]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[2] - a[2]);
    *area += 0.5 * twice;
    *cut += twice / 6 * ((plane - a[0]) + (plane - b[0]) + (plane - c[0]));
  }
}

/* ---- a layer of cells ------------------------------------------------------------------------ */

static void in_cell_units(const job *j, int32_t facet, polygon *p) {
  const int32_t *t = j->surface->triangle + 3 * (int64_t)facet;
  p->count = 3;
  for (int c = 0; c < 3; c++)
    for (int d = 0; d < 3; d++)
      p->corner[c][d] = (j->surface->point[3 * (int64_t)t[c] + d] - j->origin[d]) / j->spacing[d];
}

/* A piece of a facet that lies in one column of the layer. */
static void add_piece(const job *j, polygon *piece, double *area, double *cut) {
  double low, high;
  int32_t first, last;
  polygon part;
  extent(piece, 0, &low, &high);
  if (low < 0) { /* before the first cell: all cells lie behind it */
    double seen = 0, unused = 0;
    split(piece, 0, 0, &part);
    integrate(&part, 0, &seen, &unused);
    area[0] += seen;
    cut[0] += seen;
  }
  slabs(low, high, j->cells[0], &first, &last);
  for (int32_t i = first; i <= last; i++) {
    split(piece, 0, i + 1, &part);
    integrate(&part, i + 1, area + i, cut + i);
  }
}

static void add_facet(const job *j, int32_t facet, int64_t layer, double *area, double *cut) {
  double low, high;
  int32_t first, last;
  polygon p, row;
  in_cell_units(j, facet, &p);
  split(&p, 2, (double)layer, &row);
  split(&p, 2, (double)layer + 1, &row);
  p = row;
  extent(&p, 1, &low, &high);
  slabs(low, high, j->cells[1], &first, &last);
  if (first <= last)
    split(&p, 1, first, &row);
  for (int32_t y = first; y <= last; y++) {
    split(&p, 1, y + 1, &row);
    add_piece(j, &row, area + (int64_t)y * j->cells[0], cut + (int64_t)y * j->cells[0]);
  }
}

static bw_status fill_layers(void *data, int64_t begin, int64_t end, int worker) {
  const job *j = (const job *)data;
  int64_t wide = j->cells[0], cells = wide * j->cells[1];
  double *area = j->area + worker * cells, *cut = j->cut + worker * cells;
  for (int64_t k = begin; k < end; k++) {
    double *out = j->fraction + k * cells, behind = 0;
    if (bw_cancelled(j->context))
      return bw_check_cancel(j->context);
    memset(area, 0, (size_t)cells * sizeof *area);
    memset(cut, 0, (size_t)cells * sizeof *cut);
    for (int64_t f = j->start[k]; f < j->start[k + 1]; f++)
      add_facet(j, j->facet[f], k, area, cut);
    for (int64_t c = 0; c < cells; c++) {
      behind = c % wide == 0 ? 0 : behind;
      out[c] = cut[c] + behind;
      behind += area[c];
    }
  }
  return BW_OK;
}

/* The facets that each layer of cells meets, in ascending order. */
static bw_status sort_facets(job *j) {
  const bw_surface *surface = j->surface;
  j->start = BW_NEW0(j->context, int64_t, (size_t)j->cells[2] + 2);
  if (!j->start)
    return BW_MEMORY;
  for (int pass = 0; pass < 2; pass++) {
    int64_t *end = j->start + 1 + (pass == 0); /* counts, then cursors */
    for (int32_t f = 0; f < surface->triangle_count; f++) {
      double low, high;
      int32_t first, last;
      polygon p;
      in_cell_units(j, f, &p);
      extent(&p, 2, &low, &high);
      slabs(low, high, j->cells[2], &first, &last);
      for (int32_t k = first; k <= last; k++)
        if (pass == 0)
          end[k]++;
        else
          j->facet[end[k]++] = f;
    }
    if (pass == 1)
      break;
    for (int32_t k = 0; k < j->cells[2]; k++)
      j->start[k + 2] += j->start[k + 1];
    j->facet = BW_NEW(j->context, int32_t, j->start[j->cells[2] + 1]);
    if (!j->facet)
      return BW_MEMORY;
  }
  return BW_OK;
}

/* Without rounding off: cells that two shells hold have 2. */
static bw_status raw_fractions(bw_context *context, const bw_surface *surface,
                               const double origin[3], const double spacing[3],
                               const int32_t cells[3], double *fraction) {
  bw_status status = BW_OK;
  job j = {.context = context, .surface = surface, .fraction = fraction};
  size_t layer = (size_t)cells[0] * (size_t)cells[1] * (size_t)bw_threads(context);
  for (int d = 0; d < 3; d++) {
    j.origin[d] = origin[d];
    j.spacing[d] = spacing[d];
    j.cells[d] = cells[d];
  }
  j.area = BW_NEW(context, double, layer);
  j.cut = BW_NEW(context, double, layer);
  BW_TRY_MEMORY(j.area && j.cut);
  BW_TRY(sort_facets(&j));
  BW_TRY(bw_parallel(context, cells[2], 1, fill_layers, &j));
done:
  bw_free(j.area);
  bw_free(j.cut);
  bw_free(j.start);
  bw_free(j.facet);
  return status;
}

/* ---- the surface ----------------------------------------------------------------------------- */

/* Edges along which facets do not cancel, and where the first is. */
static bw_status count_unmatched(bw_context *context, const bw_surface *surface, int64_t *edges,
                                 int64_t *unmatched, double at[3]) {
  bw_status status = BW_OK;
  bwi_topology *t = NULL;
  BW_TRY(bwi_topology_create(context, surface, &t));
  *edges = t->edges;
  *unmatched = 0;
  for (int64_t e = 0; e < t->edges; e++) {
    int64_t sum = 0;
    for (int64_t i = t->start[e]; i < t->start[e + 1]; i++)
      sum += bwi_side_from(t, t->side[i]) < bwi_side_to(t, t->side[i]) ? 1 : -1;
    if (sum == 0 || (*unmatched)++ > 0)
      continue;
    int64_t side = t->side[t->start[e]];
    for (int d = 0; d < 3; d++)
      at[d] = (t->point[3 * (int64_t)bwi_side_from(t, side) + d] +
               t->point[3 * (int64_t)bwi_side_to(t, side) + d]) /
              2;
  }
done:
  bwi_topology_destroy(t);
  return status;
}

/* The surface itself where its facets cancel, else oriented. */
static bw_status closed_surface(bw_context *context, const bw_surface *surface, bw_surface **closed,
                                bool *oriented) {
  bw_status status = BW_OK;
  bw_surface *oriented_surface = NULL;
  int64_t edges, unmatched;
  double at[3];
  *oriented = false;
  if (surface->triangle_count == 0)
    return bw_fail(context, BW_GEOMETRY, "the surface has no facets: there is no inside");
  BW_TRY(count_unmatched(context, surface, &edges, &unmatched, at));
  if (unmatched > 0) {
    *oriented = true;
    BW_TRY(bw_surface_orient(context, surface, &oriented_surface, NULL));
    BW_TRY(count_unmatched(context, oriented_surface, &edges, &unmatched, at));
  }
  if (unmatched > 0) {
    status = bw_fail(context, BW_GEOMETRY,
                     "the surface is not closed: at %lld of its %lld edges facets are missing or "
                     "too many, first at (%g, %g, %g) m: repair the surface first",
                     (long long)unmatched, (long long)edges, at[0], at[1], at[2]);
    bw_detail_number(context, "edges", (double)unmatched);
    goto done;
  }
  *closed = oriented_surface ? oriented_surface : (bw_surface *)bw_retain(surface);
  oriented_surface = NULL;
done:
  bw_release(oriented_surface);
  return status;
}

/* Cells that count twice or negatively. */
static int64_t count_odd(const double *fraction, int64_t cells) {
  int64_t count = 0;
  for (int64_t c = 0; c < cells; c++)
    count += fraction[c] < -OVERLAP || fraction[c] > 1 + OVERLAP;
  return count;
}

bw_status bw_grid_fractions(bw_context *context, const bw_surface *surface, const double origin[3],
                            const double spacing[3], const int32_t cells[3], double *fraction) {
  bw_status status = BW_OK;
  bw_surface *closed = NULL, *oriented_surface = NULL;
  bool oriented;
  int64_t count = bwi_grid_cells(cells), odd;
  BW_TRY(closed_surface(context, surface, &closed, &oriented));
  BW_TRY(raw_fractions(context, closed, origin, spacing, cells, fraction));
  odd = count_odd(fraction, count);
  if (odd > 0 && !oriented) {
    BW_TRY(bw_surface_orient(context, closed, &oriented_surface, NULL));
    BW_TRY(raw_fractions(context, oriented_surface, origin, spacing, cells, fraction));
    odd = count_odd(fraction, count);
  }
  if (odd > 0)
    bw_warn(context,
            "shells of the surface overlap in %lld cells: the volume fractions of cut cells are "
            "too large there; repair the surface first",
            (long long)odd);
  for (int64_t c = 0; c < count; c++) {
    double f = fraction[c];
    fraction[c] = !(f > ROUNDING) ? 0 : f > 1 - ROUNDING ? 1 : f;
  }
done:
  bw_release(closed);
  bw_release(oriented_surface);
  return status;
}
