/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* The contact of a rigid cylinder with a meshed body, finer than its facets.
 *
 * The cylinder is moved into the body by a depth d. Where it overlaps the boundary is the contact,
 * of area A(d) as seen along the push. Two undeformed surfaces that approach by 2 d touch there
 * in Hertz's theory, and for any indenter dF/d(approach) = 2 E* sqrt(A/pi), so that
 *     F(d) = integral from 0 to d of 4 E* sqrt(A/pi).
 * The pressure goes as sqrt(1 - gap/d), which is Hertz's. Facets are cut into halves again and
 * again where they touch. The gap is convex on a plane facet, so that a tangent at the centroid
 * bounds it from below. */
#include "analysis/drop_contact.h"

#include "barwright/element.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { PARTS = 4096, ENOUGH = 600, LEVELS = 60 };
/* Of the radius: the depth that is never exceeded; where the cylinder's height is continued by its
 * tangent, beyond all contacts. */
#define DEEPEST 0.5
#define EDGE 0.95

int64_t bwi_contact_capacity(const bw_mesh *mesh) {
  return (int64_t)mesh->facet_count + PARTS;
}

/* The gap along push at a place relative to the axis, and its slopes by height and breadth. */
static double gap_at(const bwi_peg *peg, const double across[3], const double x[3], double slope[3],
                     double *height) {
  double off[3], r = peg->radius, breadth, edge, top, fall;
  for (int k = 0; k < 3; k++)
    off[k] = x[k] - peg->at[k] + r * peg->direction[k];
  *height = bw_dot(off, peg->direction);
  breadth = bw_dot(off, across);
  edge = fmin(fmax(breadth, -EDGE * r), EDGE * r);
  top = sqrt(r * r - edge * edge);
  fall = -edge / top;
  for (int k = 0; k < 3; k++)
    slope[k] = peg->direction[k] - fall * across[k];
  return *height - (top + fall * (breadth - edge));
}

static double gap_of(const bwi_peg *peg, const double across[3], const double x[3]) {
  double slope[3], height;
  return gap_at(peg, across, x, slope, &height);
}

/* The edge along which the gap varies most: contacts may be a hundred times longer than broad. */
static int edge_to_cut(const bwi_peg *peg, const double across[3], double x[3][3]) {
  double max = -1, gap[3];
  int cut = 0;
  for (int c = 0; c < 3; c++)
    gap[c] = gap_of(peg, across, x[c]);
  for (int c = 0; c < 3; c++) {
    const double *p = x[(c + 1) % 3], *q = x[(c + 2) % 3];
    double middle[3], edge[3], a = gap[(c + 1) % 3], b = gap[(c + 2) % 3];
    for (int k = 0; k < 3; k++) {
      middle[k] = 0.5 * (p[k] + q[k]);
      edge[k] = q[k] - p[k];
    }
    double between = gap_of(peg, across, middle);
    double varies = fmax(fmax(a, b), between) - fmin(fmin(a, b), between);
    varies += 1e-6 * bw_norm(edge); /* where it is the same on all: the longest */
    if (varies > max) {
      max = varies;
      cut = c;
    }
  }
  return cut;
}

static void measure(const bw_mesh *mesh, const bwi_peg *peg, const double across[3],
                    bwi_contact_part *part) {
  const int32_t *node = mesh->facet + (int64_t)part->facet * mesh->nodes_per_facet;
  double x[3][3], centre[3], slope[3], edge[2][3], normal[3], height;
  for (int c = 0; c < 3; c++)
    for (int k = 0; k < 3; k++) {
      x[c][k] = 0;
      for (int a = 0; a < 3; a++)
        x[c][k] += part->corner[c][a] * mesh->node[3 * (int64_t)node[a] + k];
    }
  for (int k = 0; k < 3; k++) {
    centre[k] = (x[0][k] + x[1][k] + x[2][k]) / 3;
    edge[0][k] = x[1][k] - x[0][k];
    edge[1][k] = x[2][k] - x[0][k];
  }
  bw_cross(edge[0], edge[1], normal);
  part->area = fmax(0, -0.5 * bw_dot(normal, peg->direction));
  part->gap = part->min = gap_at(peg, across, centre, slope, &height);
  if (!(height > 0)) /* behind the cylinder's middle */
    part->area = 0;
  for (int c = 0; c < 3; c++) {
    double off[3] = {x[c][0] - centre[0], x[c][1] - centre[1], x[c][2] - centre[2]};
    part->min = fmin(part->min, part->gap + bw_dot(slope, off));
  }
  part->cut = edge_to_cut(peg, across, x);
}

static int by_gap(const void *a, const void *b) {
  const bwi_contact_part *p = (const bwi_contact_part *)a, *q = (const bwi_contact_part *)b;
  if (p->gap != q->gap)
    return p->gap < q->gap ? -1 : 1;
  if (p->facet != q->facet)
    return p->facet < q->facet ? -1 : 1;
  return memcmp(p->corner, q->corner, sizeof p->corner);
}

/* The depth at which F is reached; parts in order of their gaps. */
static double depth_of(const bwi_contact_part *part, int64_t count, double force, double modulus,
                       double deepest) {
  double area = 0, depth = 0, reached = 0;
  for (int64_t i = 0; i <= count; i++) {
    double next = i < count ? fmin(fmax(part[i].gap, 0), deepest) : deepest;
    double rate = 4 * modulus * sqrt(area / M_PI);
    if (rate > 0 && reached + rate * (next - depth) >= force)
      return depth + (force - reached) / rate;
    reached += rate * (next - depth);
    depth = next;
    if (i < count)
      area += part[i].area;
  }
  return deepest;
}

/* Cuts part[i] in halves, one of which goes to the end. */
static void split(bwi_contact_part *part, int64_t i, int64_t *count) {
  bwi_contact_part *old = &part[i], *new = &part[(*count)++];
  int p = (old->cut + 1) % 3, q = (old->cut + 2) % 3;
  *new = *old;
  for (int a = 0; a < 3; a++)
    old->corner[q][a] = new->corner[p][a] = 0.5 * (new->corner[p][a] + new->corner[q][a]);
}

static int64_t facets_near(const bw_mesh *mesh, const bwi_peg *peg, const double across[3],
                           bwi_contact_part *part) {
  static const double corners[3][3] = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
  int64_t count = 0;
  for (int32_t f = 0; f < mesh->facet_count; f++) {
    if (mesh->component[mesh->facet[(int64_t)f * mesh->nodes_per_facet]] != peg->component)
      continue;
    part[count].facet = f;
    memcpy(part[count].corner, corners, sizeof corners);
    measure(mesh, peg, across, &part[count]);
    count += part[count].min < DEEPEST * peg->radius;
  }
  return count;
}

void bwi_contact_press(const bw_mesh *mesh, const bwi_peg *peg, double force, double modulus,
                       bwi_contact_part *part, double *fraction, bwi_contact_patch *patch) {
  double across[3], depth = 0, deepest = DEEPEST * peg->radius, sum = 0;
  int64_t capacity = bwi_contact_capacity(mesh), in_contact = 0;
  bw_cross(peg->along, peg->direction, across);
  int64_t count = facets_near(mesh, peg, across, part);
  for (int level = 0;; level++) {
    qsort(part, (size_t)count, sizeof *part, by_gap);
    depth = depth_of(part, count, force, modulus, deepest);
    int64_t left = 0, touching = 0;
    in_contact = 0;
    for (int64_t i = 0; i < count; i++)
      if (part[i].min < 2 * depth) {
        touching += part[i].min < depth;
        in_contact += part[i].gap < depth && part[i].area > 0;
        part[left++] = part[i];
      }
    count = left;
    if (in_contact >= ENOUGH || level == LEVELS || count + touching > capacity)
      break;
    for (int64_t i = 0; i < left; i++)
      if (part[i].min < depth) {
        split(part, i, &count);
        measure(mesh, peg, across, &part[i]);
        measure(mesh, peg, across, &part[count - 1]);
      }
  }
  *patch = (bwi_contact_patch){.indentation = depth, .count = in_contact};
  for (int64_t i = 0; i < count; i++)
    if (part[i].gap < depth) {
      patch->area += part[i].area;
      sum += part[i].area * sqrt(1 - fmax(part[i].gap, 0) / depth);
    }
  for (int64_t i = 0; i < count; i++) {
    if (!(part[i].gap < depth && part[i].area > 0))
      continue;
    const int32_t *node = mesh->facet + (int64_t)part[i].facet * mesh->nodes_per_facet;
    double weight = part[i].area * sqrt(1 - fmax(part[i].gap, 0) / depth) / sum;
    double centre[3], value[6];
    for (int a = 0; a < 3; a++)
      centre[a] = (part[i].corner[0][a] + part[i].corner[1][a] + part[i].corner[2][a]) / 3;
    bw_facet_shape(mesh->order, centre, value);
    for (int a = 0; a < mesh->nodes_per_facet; a++)
      fraction[node[a]] += weight * value[a];
    for (int a = 0; a < 3; a++)
      for (int k = 0; k < 3; k++)
        patch->centre[k] += weight * centre[a] * mesh->node[3 * (int64_t)node[a] + k];
  }
}
