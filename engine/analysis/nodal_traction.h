/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* Tractions on facets from forces at their nodes (docs/theory/elements.md#interface-tractions). */
#ifndef BWI_ANALYSIS_NODAL_TRACTION_H
#define BWI_ANALYSIS_NODAL_TRACTION_H

#include "barwright/analysis.h"

/* Facets, and the integrals of the functions of their nodes. */
typedef struct bwi_nodal_traction {
  const bw_mesh *mesh;
  int32_t count;        /* of facets */
  const int32_t *facet; /* (index, count x nodes_per_facet) their nodes; borrowed */
  uint8_t *gathered;    /* (node_count) mid-edge nodes that were added to their ends */
  double *area;         /* (m2, node_count) of the functions, 0 at the beginning */
  double *normal;       /* (m2, node_count x 3) of the functions times the normal */
} bwi_nodal_traction;

/* Clear with bwi_nodal_traction_clear in any case. */
bw_status bwi_nodal_traction_open(bw_context *context, const bw_mesh *mesh, int32_t count,
                                  const int32_t *facet, bwi_nodal_traction *t);
void bwi_nodal_traction_clear(bwi_nodal_traction *t);
/* Adds the integrals over the whole facets. Returns their area (m2). */
double bwi_nodal_traction_integrate(bwi_nodal_traction *t);
/* The fields of bw_interface_traction from force (N, node_count x 3) at nodes of the facets. Force
 * and integrals become those of the hat functions of corners. */
void bwi_nodal_traction_write(bwi_nodal_traction *t, double *force, double *traction,
                              double *normal, double *shear);

#endif
