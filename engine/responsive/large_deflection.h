/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* Energy, force and tangent of St. Venant-Kirchhoff sheets, element by element. */
#ifndef BWI_RESPONSIVE_LARGE_DEFLECTION_H
#define BWI_RESPONSIVE_LARGE_DEFLECTION_H

#include "responsive/sheet.h"

typedef struct bwi_large_deflection {
  const bw_sheet *sheet;
  bwi_triangle_rule rule, corners; /* quadrature; the nodes, where inversion is looked for too */
  const double *u;                 /* displacement */
  bool convex;                     /* leave the negative part of stresses out of the tangent */
  double *line;     /* element_count x 8, of tri3 alone: three gradients, area x thickness */
  double *energy;   /* element_count; < 0: inverted */
  double *force;    /* element_count x n x 2 */
  int32_t inverted; /* the first element found inverted last, -1: none */
} bwi_large_deflection;
bw_status bwi_large_deflection_prepare(bw_context *context, const bw_sheet *sheet,
                                       bwi_large_deflection *bend);
void bwi_large_deflection_clear(bwi_large_deflection *bend);
/* Sum of the elements' energies at u, INFINITY where one is inverted, and its gradient (node_count
 * x 2); either may be NULL. */
bw_status bwi_large_deflection_evaluate(bw_context *context, bwi_large_deflection *bend,
                                        double *energy, double *force);
/* The second derivative (4 per block; room for element matrices). */
bw_status bwi_large_deflection_tangent(bw_context *context, bwi_large_deflection *bend,
                                       const bw_plane_pattern *pattern, double *workspace,
                                       double *values);

#endif
