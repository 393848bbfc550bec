/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* What the files of flow/ share. */
#ifndef BWI_FLOW_INTERNAL_H
#define BWI_FLOW_INTERNAL_H

#include "barwright/flow.h"

enum { BWI_FLOW_UNKNOWNS = 4 }; /* unknowns of a node: velocity x, y, pressure, temperature */

/* One linear problem: the implicit step of length 1 / rate (times the coefficient of the scheme),
 * or with rate 0 the steady equations, linearised about a velocity. */
typedef struct bwi_linear {
  const bw_plane_mesh *mesh;
  const bw_flow_description *about;
  int components;
  double rate;           /* coefficient of the new values in the time derivative, 1/s */
  const double *convect; /* node_count x 2: velocity that carries (less that of the mesh) */
  const double *history; /* node_count x components: what the time derivative has from before */
  const double
      *newton; /* node_count x components: the state to linearise about, or NULL (Picard) */
  const double
      *laplacian; /* element_count x 3: of velocity and temperature, recovered (recover.c) */
} bwi_linear;

typedef struct bwi_flow_element {
  double area, gradient[3][2];
  double convection[3][2], mean[2]; /* the convecting velocity at the corners, and its mean */
  double tau, tau_heat, divergence; /* stabilisation: momentum and mass, heat, incompressibility */
  double velocity_slope[2][2], heat_slope[2]; /* with Newton: of the state linearised about */
} bwi_flow_element;

/* False where the element is inverted. */
bool bwi_flow_element_make(const bwi_linear *linear, int32_t element, bwi_flow_element *made);
/* (3 c) x (3 c), row by row */
void bwi_flow_element_matrix(const bwi_linear *linear, const bwi_flow_element *e, double *matrix);
/* 3 c */
void bwi_flow_element_vector(const bwi_linear *linear, int32_t element, const bwi_flow_element *e,
                             double *vector);

/* Laplacians of velocity x, y and temperature in every element (element_count x 3) from a state. */
bw_status bwi_flow_recover(bw_context *context, const bw_plane_mesh *mesh, int components,
                           const double *state, double *laplacian);

/* What the equations need as workspace, recomputed with the pattern. */
typedef struct bwi_flow_workspace {
  double *block, *vector;  /* of all elements */
  double *values, *system; /* components^2 per block: the matrix, and with prescribed unknowns */
  double *load, *rhs;      /* node_count x components: likewise */
  double *prescribed, *solution, *history;
  double
      *reaction; /* node_count x components: A x - b of the last equations, before prescriptions */
  double *convect;   /* node_count x 2 */
  double *laplacian; /* element_count x 3 */
  uint8_t *is_prescribed;
} bwi_flow_workspace;
bw_status bwi_flow_workspace_make(bw_context *context, const bw_plane_pattern *pattern,
                                  int components, bwi_flow_workspace *workspace);
void bwi_flow_workspace_clear(bwi_flow_workspace *workspace);

/* All that an operation on a flow changes (state.c). An operation makes the next state beside the
 * one that stands and puts it in its place when nothing can fail any more: it happens whole or not
 * at all, and keeping a state copies nothing. */
struct bw_flow_state {
  bw_object object;
  const bw_plane_mesh *mesh;       /* retained */
  const bw_plane_pattern *pattern; /* retained: of the mesh */
  int components, condition_count;
  bw_condition
      *condition; /* whose tags are those of the mesh's outline; its functions are not called */
  double time;
  double *state, *before; /* node_count x components */
  double *reaction;       /* node_count x components: A x - b of the last step */
  bool reacted;           /* `reaction` is of this state and mesh */
  double *old_point;      /* node_count x 2: where these nodes were at the last step; NULL: here */
  double *older_point;    /* and at the step before that; NULL: where they were at the last */
  int known;              /* states that the next step may start from: 1, or 2 with `before` */
  double last_step;       /* between `before` and `state` */
};

struct bwi_flow {
  bw_flow_description about;
  bw_condition *condition;
  const bw_flow_state *now; /* retained; the public fields are its own */
  /* What follows from it, or makes it faster. */
  bw_plane_locator *locator; /* of the current mesh; NULL until it is asked for */
  bw_lagged_factor *lagged;
  bwi_flow_workspace workspace; /* of the current pattern; empty until it is needed */
  bool conflicts_reported;      /* of the conditions' prescribed values */
};

/* A copy of the state that stands, as the first draft of the next on the same nodes. */
bw_status bwi_flow_next(bw_context *context, const bw_flow *flow, bw_flow_state **next);
/* A state without any field. */
bw_status bwi_flow_blank(bw_context *context, const bw_flow *flow, const bw_plane_mesh *mesh,
                         const bw_plane_pattern *pattern, bw_flow_state **state);
/* Puts a state in the place of the one that stands. Cannot fail. */
void bwi_flow_adopt(bw_flow *flow, const bw_flow_state *state);
/* The end of an operation: the state takes its place unless somebody asked to stop meanwhile, whom
 * a result would surprise. */
bw_status bwi_flow_commit(bw_context *context, bw_flow *flow, const bw_flow_state *next);

/* What the boundary's conditions bring at a time: tractions and heat into workspace.load, the part
 * of convection that goes with the temperature into workspace.values. */
bw_status bwi_flow_boundary(bw_context *context, bw_flow *flow, double time);
/* Heat by fluxes and convection on a tag (-1: all), of the state as it is. */
bw_status bwi_flow_boundary_heat(bw_context *context, const bw_flow *flow, int32_t tag,
                                 double *heat);

#endif
