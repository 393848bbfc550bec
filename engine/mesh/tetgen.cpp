/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* TetGen 1.5 as a library. It throws ints, may call exit, keeps static tables, and prints: all of
 * that is harmless here, since this runs in a child process of its own that ends afterwards. What
 * it allocates is left to the end of the process. */
#define TETLIBRARY
#include <tetgen.h>

#include "mesh/tetgen_run.h"

#include <clocale>
#include <cmath>
#include <cstdio>
#include <new>

namespace {

/* TetGen's callback has no room for data; the process serves one job. */
const bw_size_field *the_field;
bool wrong_size;
double wrong_at[3];

/* Is this tetrahedron too large for the sizes asked for? Its longest edge may be a little longer
 * than asked, as the edges of a good mesh scatter about their mean. */
bool too_large(REAL *a, REAL *b, REAL *c, REAL *d, REAL *, REAL) {
  const REAL *corner[4] = {a, b, c, d};
  double middle[3], longest = 0, sum = 0;
  for (int k = 0; k < 3; k++)
    middle[k] = (a[k] + b[k] + c[k] + d[k]) / 4;
  for (int i = 0; i < 4; i++)
    for (int j = i + 1; j < 4; j++) {
      double square = 0;
      for (int k = 0; k < 3; k++)
        square += (corner[i][k] - corner[j][k]) * (corner[i][k] - corner[j][k]);
      longest = std::fmax(longest, square);
      sum += std::sqrt(square);
    }
  double wanted = bwi_size_at(the_field, middle);
  if (wanted < 0 || wanted != wanted) {
    if (!wrong_size)
      for (int k = 0; k < 3; k++)
        wrong_at[k] = middle[k];
    wrong_size = true;
    return false;
  }
  return wanted > 0 && (std::sqrt(longest) > 1.6 * wanted || sum > 6 * 1.15 * wanted);
}

const char *meaning(int code) {
  switch (code) {
  case 1:
    return "memory ran out";
  case 2:
    return "an internal check of TetGen failed";
  case 3:
    return "the surface intersects itself";
  case 4:
    return "a feature of the surface is too small to be resolved";
  case 5:
    return "two facets lie too close to each other";
  case 10:
    return "TetGen does not accept the surface";
  }
  return "TetGen gave up";
}

void give_surface(const bwi_tetgen_job *job, tetgenio *in) {
  in->firstnumber = 0;
  in->numberofpoints = job->point_count;
  in->pointlist = const_cast<double *>(job->point);
  in->numberoffacets = job->triangle_count;
  in->facetlist = new tetgenio::facet[job->triangle_count];
  for (int32_t i = 0; i < job->triangle_count; i++) {
    tetgenio::facet *facet = &in->facetlist[i];
    tetgenio::init(facet);
    facet->numberofpolygons = 1;
    facet->polygonlist = new tetgenio::polygon[1];
    facet->polygonlist->numberofvertices = 3;
    facet->polygonlist->vertexlist = const_cast<int32_t *>(job->triangle) + 3 * (size_t)i;
  }
  in->numberofholes = job->hole_count;
  in->holelist = const_cast<double *>(job->hole);
}

void give_switches(const bwi_tetgen_job *job, tetgenbehavior *behavior) {
  char switches[64];
  bool bounded = job->max_volume > 0;
  snprintf(switches, sizeof switches, "pz%s%s%s%sBQ", job->keep_surface ? "Y" : "",
           job->subdomains ? "A" : "", job->radius_edge > 0 ? "q1.4" : "", bounded ? "a1" : "");
  behavior->parse_commandline(switches);
  if (job->radius_edge > 0) {
    behavior->minratio = job->radius_edge;
    behavior->mindihedral = job->dihedral * (180 / M_PI);
  }
  if (bounded)
    behavior->maxvolume = job->max_volume;
  if (job->max_points > 0 && job->max_points < INT32_MAX)
    behavior->steinerleft = (int)job->max_points;
}

bw_status run(bw_context *context, const bwi_tetgen_job *job, bwi_child_stream *out) {
  tetgenio *in = new tetgenio, *made = new tetgenio; /* never deleted: they borrow */
  tetgenbehavior *behavior = new tetgenbehavior;
  give_surface(job, in);
  give_switches(job, behavior);
  if (job->field) {
    the_field = job->field;
    in->tetunsuitable = too_large;
  }
  tetrahedralize(behavior, in, made);
  if (wrong_size)
    return bw_fail(context, BW_INVALID,
                   "the size function returned no length at (%g, %g, %g) m: it must return an edge "
                   "length in m, or 0 for no bound",
                   wrong_at[0], wrong_at[1], wrong_at[2]);
  int64_t count[2] = {made->numberofpoints, made->numberoftetrahedra};
  if (count[1] <= 0 || made->numberofcorners != 4)
    return bw_fail(context, BW_GEOMETRY, "TetGen found nothing to fill inside the surface");
  bw_status status = bwi_child_write(out, count, sizeof count);
  if (status == BW_OK)
    status = bwi_child_write(out, made->pointlist, (size_t)count[0] * 3 * sizeof(double));
  if (status == BW_OK)
    status = bwi_child_write(out, made->tetrahedronlist, (size_t)count[1] * 4 * sizeof(int32_t));
  for (int64_t i = 0; job->subdomains && i < count[1] && status == BW_OK; i++) {
    int32_t subdomain = (int32_t)made->tetrahedronattributelist[i];
    status = bwi_child_write(out, &subdomain, sizeof subdomain);
  }
  return status;
}

} // namespace

bw_status bwi_tetgen_child(bw_context *context, void *job, bwi_child_stream *out) {
  std::setlocale(LC_NUMERIC, "C"); /* TetGen reads its switches by strtod */
  try {
    return run(context, static_cast<const bwi_tetgen_job *>(job), out);
  } catch (int code) {
    if (code == 1)
      return bw_fail(context, BW_MEMORY, "memory ran out while TetGen filled the surface");
    bw_status status = bw_fail(context, BW_GEOMETRY, "TetGen rejects the surface: %s (code %d)",
                               meaning(code), code);
    bw_detail_number(context, "tetgen", code);
    return status;
  } catch (const std::bad_alloc &) {
    return bw_fail(context, BW_MEMORY, "memory ran out while TetGen filled the surface");
  } catch (...) {
    return bw_fail(
        context, BW_GEOMETRY,
        "TetGen stopped with an unknown error: repair the surface, or try another edge length");
  }
}
