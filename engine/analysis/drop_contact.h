/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* Where a peg touches a body that it presses with a given force: the contact of the drop test
 * (docs/theory/worst_case.md, section 12). */
#ifndef BWI_ANALYSIS_DROP_CONTACT_H
#define BWI_ANALYSIS_DROP_CONTACT_H

#include "barwright/analysis.h"

/* A rigid cylinder that touches the body at one point. */
typedef struct bwi_peg {
  double at[3];        /* the point */
  double direction[3]; /* unit, from the cylinder's axis to the point: the force on the body */
  double along[3];     /* unit, the axis */
  double radius;
  int32_t component; /* of the body that it touches */
} bwi_peg;

/* A part of a boundary facet, by corners in the facet's barycentric coordinates. */
typedef struct bwi_contact_part {
  int32_t facet;
  double corner[3][3];
  double gap;  /* at the centroid, along push, before it is pressed */
  double min;  /* not above any gap on it */
  double area; /* seen along push; 0: it faces away */
  int cut;     /* the corner opposite to the edge along which the gap varies most */
} bwi_contact_part;

typedef struct bwi_contact_patch {
  double indentation; /* depth of the overlap, half of the approach */
  double area;        /* seen along push */
  double centre[3];   /* of pressure */
  int64_t count;      /* parts that carry pressure */
} bwi_contact_patch;

/* Room for parts that never runs out at the start. */
int64_t bwi_contact_capacity(const bw_mesh *mesh);
/* The patch under a force; `modulus`: of plane strain, E/(1 - nu^2). The fractions of the force at
 * the nodes are added to `fraction` (node_count): 1 in all, or 0 where count is 0 (nothing faces
 * the peg). */
void bwi_contact_press(const bw_mesh *mesh, const bwi_peg *peg, double force, double modulus,
                       bwi_contact_part *part, double *fraction, bwi_contact_patch *patch);

#endif
