/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* Runs of TetGen, and the search for the edge length and the volume bound that give the wanted
 * number of elements. */
#include "mesh/fill_internal.h"
#include "mesh/mesh_internal.h"
#include "mesh/predicates.h"

#include <math.h>
#include <stdio.h>

/* Elements per facet of the surface and per cube of an edge length, for the first guess. */
static const double per_facet = 1.7, per_cube = 1.6;
/* ... per point that bends a border of faces, where those are kept. */
static const double per_bend = 12;
/* The volume bound that goes with an edge length, in cubes of it: the edges inside may be about
 * half as long again as those on the surface. */
static const double volume_of_length = 0.5;
enum { MAX_ATTEMPTS = 14 };
/* Edges of the next try over those of the last one, where filling failed. */
static const double shorter = 0.96;

/* Elements without volume at planes are taken off, within this fraction of the diagonal. */
static const double of_rounding = 1e-12;

/* TetGen's last step may leave elements of no volume, which no mesh may have. */
static bw_status check_volumes(bw_context *context, const bwi_tetgen_result *result) {
  for (int64_t i = 0; i < result->element_count; i++) {
    const int32_t *e = result->element + 4 * i;
    const double *x[4];
    for (int k = 0; k < 4; k++)
      x[k] = result->node + 3 * (int64_t)e[k];
    double error, volume = bwi_tet_determinant(x[0], x[1], x[2], x[3], &error);
    if (!(fabs(volume) > error))
      return bw_fail(context, BW_GEOMETRY,
                     "TetGen left an element without volume near (%g, %g, %g) m", x[0][0], x[0][1],
                     x[0][2]);
  }
  return BW_OK;
}

/* ---- one attempt ---------------------------------------------------------------------------- */

static bw_status attempt(bwi_filler *f, double max_volume, int64_t *count) {
  const bw_fill_options *o = f->options;
  bool fields = f->field.point_count || f->field.size;
  if (o->max_volume > 0 && (max_volume <= 0 || max_volume > o->max_volume))
    max_volume = o->max_volume;
  bwi_tetgen_job job = {.point_count = f->surface->point_count,
                        .triangle_count = f->surface->triangle_count,
                        .point = f->surface->point,
                        .triangle = f->surface->triangle,
                        .hole_count = f->holes,
                        .hole = f->hole,
                        .max_volume = max_volume,
                        .radius_edge = o->radius_edge,
                        .dihedral = o->dihedral,
                        .keep_surface = o->keep_surface || o->remesh,
                        .field = fields ? &f->field : NULL,
                        .limits = {.seconds = o->time_limit, .bytes = o->memory_limit}};
  if (o->elements > 0) /* far beyond what is wanted there is nothing to learn */
    job.max_points = 4 * (o->elements + f->surface->point_count) + 10000;
  bwi_tetgen_result result;
  double start = bw_seconds();
  f->attempts++;
  bw_status status = bwi_tetgen_run(f->context, &job, &result);
  f->seconds_fill += bw_seconds() - start;
  bw_progress(f->context, "filling", 0.1 + 0.85 * (1 - pow(0.6, f->attempts)));
  if (status != BW_OK)
    return status;
  status = check_volumes(f->context, &result);
  if (status == BW_GEOMETRY && !o->keep_surface) {
    status = bwi_peel_degenerate(f->context, &result, of_rounding * f->diagonal);
    if (status == BW_OK)
      status = check_volumes(f->context, &result);
  }
  if (status != BW_OK) {
    bw_free(result.node);
    bw_free(result.element);
    return status;
  }
  *count = result.element_count;
  double miss = o->elements > 0 ? fabs(log((double)*count / (double)o->elements)) : 0;
  if (!f->best.node || miss < f->best_miss) {
    bw_free(f->best.node);
    bw_free(f->best.element);
    f->best = result;
    f->best_miss = miss;
    bw_release(f->best_surface);
    f->best_surface = bw_retain(f->surface);
    f->best_log = f->surface_log;
    f->best_length = f->length;
    f->best_how = f->how;
  } else {
    bw_free(result.node);
    bw_free(result.element);
  }
  return BW_OK;
}

/* How often a way is tried, each time with edges a little shorter: what TetGen stumbles over is
 * often an accident of this very surface. More often before a wrap, which may close holes and
 * slots. */
static int tries_of(bwi_fill_way how) {
  return how == WAY_AS_IS ? 1 : how + 1 == WAY_WRAP ? 4 : 2;
}

/* Make the surface for an edge length and fill it, by the mildest way from *how on that works. */
static bw_status fill_at(bwi_filler *f, bwi_fill_way *how, double length, double max_volume,
                         int64_t *count) {
  bw_status status = BW_OK;
  char why[300] = "";
  for (; *how < WAYS; ++*how) {
    bool filled = false;
    for (int try = 0; try < tries_of(*how); try++) {
      status = bwi_fill_make_surface(f, *how, length * pow(shorter, try));
      if (status != BW_OK)
        break;
      filled = true;
      status = attempt(f, max_volume, count);
      if (status == BW_OK || status == BW_LIMIT || !bwi_fill_may_cure(f, status))
        break;
    }
    if (status == BW_OK || !bwi_fill_may_cure(f, status))
      break;
    if (filled && status == BW_LIMIT && *how != WAY_AS_IS)
      break; /* well-shaped facets already: another surface takes as long */
    snprintf(why, sizeof why, "%s", bw_message(f->context));
    if (status == BW_LIMIT && *how == WAY_FACES)
      *how = WAY_BORDERS; /* that takes as long */
    if (!f->options->remesh || f->options->keep_surface)
      break;
  }
  if (status == BW_OK && why[0] && *how == WAY_WRAP)
    bw_warn(f->context, "%s; a surface wrapped around it and remeshed is used instead", why);
  return status;
}

/* ---- the wanted number ---------------------------------------------------------------------- */

/* Elements that the faces take at any edge length. */
static double min_count(const bwi_filler *f, bwi_fill_way how) {
  return (how <= WAY_BORDERS ? per_bend * (double)f->bends : 0) +
         (how <= WAY_FACES ? per_facet * f->round_facets : 0);
}

static double expected_count(const bwi_filler *f, double length) {
  double facets = f->area / (0.4330127 * length * length) * 1.15;
  double cube = length * length * length;
  return per_facet * facets + per_cube * f->volume / cube;
}

static double first_length(const bwi_filler *f, double count) {
  double low = 1e-6 * f->diagonal, high = f->diagonal;
  for (int i = 0; i < 60; i++) {
    double middle = sqrt(low * high);
    if (expected_count(f, middle) > count)
      low = middle;
    else
      high = middle;
  }
  return sqrt(low * high);
}

/* On one surface the count is about a + b / volume bound: two runs give both. Used for surfaces
 * that must stay as they are, and to close in when a remeshed surface is nearly right. */
static bw_status tune_volume(bwi_filler *f, double wanted, double volume, int64_t count, int max) {
  bw_status status = BW_OK;
  double last_inverse = volume > 0 ? 1 / volume : 0, last_count = (double)count;
  double slope = 1.4 * f->volume;
  for (int i = 0; i < max && f->attempts < MAX_ATTEMPTS; i++) {
    if (f->best_miss <= log1p(f->options->tolerance) * 0.999)
      break;
    double inverse = last_inverse + (wanted - last_count) / slope;
    if (!(inverse > 1e-3 / f->volume)) { /* no bound at all gives the smallest count */
      if (last_inverse == 0)
        break;
      inverse = 0;
    }
    BW_TRY(attempt(f, inverse > 0 ? 1 / inverse : 0, &count));
    if (fabs((double)count - last_count) < 0.01 * last_count)
      break; /* walls with nothing inside */
    double steepness = ((double)count - last_count) / (inverse - last_inverse);
    if (inverse != last_inverse && steepness > 0.05 * f->volume)
      slope = steepness;
    last_inverse = inverse;
    last_count = (double)count;
  }
done:
  return status;
}

/* Tunnels through the surface: marching surfaces of walls thinner than their grid are full of them.
 * Coarsening keeps each, with the ten facets or so that it takes. */
static int64_t tunnels_of(const bw_surface *surface, int64_t bodies) {
  return bodies - ((int64_t)surface->point_count - surface->triangle_count / 2) / 2;
}

/* The first way that may give so many elements. Faces are kept where they can be, and where one
 * length holds for all places. A surface much finer than wanted needs coarsening only, which is
 * faster than remeshing, and keeps within a tolerance with fewer facets. */
static bwi_fill_way way_from(const bwi_filler *f, bwi_fill_way first, double length, double count) {
  double own = sqrt(f->area / (0.4330127 * f->base->triangle_count));
  for (bwi_fill_way how = first; how < WAY_REMESH; how++)
    if (f->has_faces && f->field.point_count == 0 && !f->field.size && min_count(f, how) <= count)
      return how;
  return own < 0.6 * length || f->options->surface_tolerance > 0 ? WAY_COARSEN : WAY_REMESH;
}

/* Search for the edge length: a secant on the logarithms of length and count. The slope lies
 * between that of a sheet, -2, and that of a solid, -3, unless detail that must be kept flattens
 * it. */
static bw_status search_length(bwi_filler *f, bwi_fill_way *how) {
  double wanted = (double)f->options->elements, tolerance = log1p(f->options->tolerance) * 0.999;
  bw_status status = BW_OK;
  double length = first_length(f, fmax(wanted - min_count(f, *how), 0.3 * wanted));
  double slope = -2.4, last_length = 0, last_count = 0;
  bool flat = false;
  double low = 0, high = INFINITY; /* lengths known to give too many, too few */
  for (int i = 0; i < 8 && f->attempts < MAX_ATTEMPTS; i++) {
    double volume = volume_of_length * length * length * length;
    int64_t count = 0;
    status = fill_at(f, how, length, volume, &count);
    if (status != BW_OK) {
      if (f->best.node && bwi_fill_may_cure(f, status)) {
        status = BW_OK;
        break;
      }
      goto done;
    }
    if (f->best_miss <= tolerance)
      break;
    double ratio = (double)count / wanted;
    int64_t tunnels = tunnels_of(f->surface, 1);
    if (ratio > 1 && *how < WAY_WRAP && 40.0 * (double)tunnels > wanted) {
      /* A wrap would close them, but it also fills the walls' surroundings: not the user's body. */
      bw_warn(f->context,
              "the surface has about %lld tunnels, which alone take more elements than wanted: "
              "walls thinner than the grid that it was made on look like that, and a finer grid "
              "would keep them. The count is not met; bw_surface_wrap closes tunnels where that is "
              "what you want",
              (long long)tunnels);
      break;
    }
    if (ratio > 1)
      low = fmax(low, length);
    else
      high = fmin(high, length);
    if (ratio > 0.4 && ratio < 1) { /* more elements inside do it */
      BW_TRY(tune_volume(f, wanted, volume, count, 2));
      if (f->best_miss <= tolerance)
        break;
    }
    if (last_length > 0 && fabs(log(length / last_length)) > 0.02) {
      slope = log((double)count / last_count) / log(length / last_length);
      if (*how < WAY_REMESH && ratio > 1 + f->options->tolerance && slope > -0.4) {
        if (flat) /* the borders of faces take as many at any length */
          break;
        flat = true;
        last_length = length;
        last_count = (double)count;
        length *= 3;
        continue;
      }
      slope = fmin(fmax(slope, -3.5), -1.0);
    }
    last_length = length;
    last_count = (double)count;
    length *= exp(fmin(fmax(-log(ratio) / slope, -1.5), 1.5));
    if (low > 0 && high < INFINITY && (length <= low || length >= high))
      length = sqrt(low * high);
    if (length > 0.5 * f->diagonal) {
      if (last_length > 0.49 * f->diagonal)
        break;
      length = 0.5 * f->diagonal;
    }
  }
done:
  return status;
}

bw_status bwi_fill_meet_count(bwi_filler *f) {
  double wanted = (double)f->options->elements, tolerance = log1p(f->options->tolerance) * 0.999;
  bw_status status = BW_OK;
  int64_t count = 0;
  bwi_fill_way how = WAY_AS_IS;
  if (f->options->keep_surface || !f->options->remesh) {
    double volume = 1.8 * f->volume / wanted;
    BW_TRY(fill_at(f, &how, 0, volume, &count));
    BW_TRY(tune_volume(f, wanted, volume, count, 6));
    goto done;
  }
  BW_TRY(bwi_fill_find_faces(f));
  double length = first_length(f, wanted);
  bool faces = true;
  for (how = WAY_FACES; faces; how++) {
    how = way_from(f, how, length, wanted);
    faces = how < WAY_REMESH;
    BW_TRY(search_length(f, &how));
    faces = faces && f->best_miss > tolerance && how < WAY_REMESH;
  }
done:
  return status;
}

/* Without a wanted count: the surface at its own resolution, or one that fits the volume
 * bound, whichever is finer. */
bw_status bwi_fill_once(bwi_filler *f) {
  const bw_fill_options *o = f->options;
  int64_t count;
  double length = sqrt(f->area / (0.4330127 * 1.15 * (double)f->base->triangle_count));
  double bound = 0;
  if (o->edge_length > 0) {
    length = o->edge_length;
    bound = volume_of_length * length * length * length;
  } else if (o->max_volume > 0)
    length = fmin(length, cbrt(o->max_volume / volume_of_length));
  bwi_fill_way how = WAY_AS_IS;
  if (o->remesh && !o->keep_surface) {
    bw_status found = bwi_fill_find_faces(f);
    if (found != BW_OK)
      return found;
    how = way_from(f, WAY_FACES, length, o->edge_length > 0 ? 0 : expected_count(f, length));
  }
  if (o->max_volume == 0 && bound == 0 && how != WAY_AS_IS)
    bound = 8 * length * length * length;
  bw_status status = fill_at(f, &how, length, bound, &count);
  return status;
}
