/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* What the files of the ringing plate share. Unknowns of a node: deflection w and the two rotations
 * b of the section, displacement (z b_x, z b_y, w); shear strain grad w + b, curvature sym grad b.
 * Every number carries the thickness: energies are per plate, not per volume. */
#ifndef BWI_PLATE_H
#define BWI_PLATE_H

#include "eigen/internal.h"
#include "incremental/lagged_factor.h"
#include "responsive/internal.h"

enum {
  BWI_PLATE_NODES = 6,
  BWI_PLATE_UNKNOWNS = 18, /* of the nodes, node by node: w, b_x, b_y */
  BWI_PLATE_ALL = 20       /* and the two of the bubble of the rotations */
};

typedef struct bwi_plate_law {
  double bending[9]; /* h^3/12 Q, order xx yy xy: moments from curvatures */
  double shear[4];   /* 5/6 h G: shear forces from shear strains */
  double mass;       /* rho h */
  double inertia;    /* rho h^3 / 12 */
} bwi_plate_law;
/* BW_INVALID where stresses in the plane and across it are coupled (material axes tilted), and
 * where there is no density. */
bw_status bwi_plate_law_create(bw_context *context, const bw_material *material, double thickness,
                               bwi_plate_law *law);

/* Everything about the reference triangle: quadrature, shape functions, the interpolation of shear.
 * Made once (bwi_plate_reference_fill), read by all threads. */
enum { BWI_PLATE_POINTS = 16 };
typedef struct bwi_plate_reference {
  int points;
  double weight[BWI_PLATE_POINTS];                                  /* summing to 1/2 */
  double value[BWI_PLATE_POINTS][7], slope[BWI_PLATE_POINTS][2][7]; /* six nodes, bubble */
  double field[BWI_PLATE_POINTS][2][8];                             /* shear from 8 conditions */
  double node_slope[6][2][6]; /* of the six functions, at the six nodes */
  struct {
    double value[7], slope[2][6], weight[2]; /* condition = sum of weight . covariant shear there */
    int row;
  } tie[6 + BWI_PLATE_POINTS];
} bwi_plate_reference;
void bwi_plate_reference_fill(bwi_plate_reference *reference);

/* Stiffness (18 x 18) with the bubble condensed and, where not NULL, what the bubble's two unknowns
 * are by those of the nodes (2 x 18). The smallest Jacobian comes back: not above 0, no matrix. */
double bwi_plate_stiffness(const bwi_plate_reference *reference, const bwi_plate_law *law,
                           const double x[6][2], double *stiffness, double *bubble);
/* integral of N_a N_b (6 x 6): times mass for deflections, times inertia for rotations. */
void bwi_plate_mass(const bwi_plate_reference *reference, const double x[6][2], double *mass);
/* u^T K u and u^T M u of one element for unknowns with the bubble's. */
void bwi_plate_energies(const bwi_plate_reference *reference, const bwi_plate_law *law,
                        const double x[6][2], const double u[20], double *elastic, double *kinetic);

/* Per node the 2 x 2 matrix that takes rotations from the nodes at `from` to those at `to`. */
bw_status bwi_plate_rotations(bw_context *context, const bwi_plate_reference *reference,
                              const bw_plane_topology *topology, const double *from,
                              const double *to, double *rotation);
/* u = T u or T^T u in place (3 numbers a node). */
void bwi_plate_rotate(int64_t nodes, const double *rotation, bool transposed, double *u);

/* The matrices of a mesh: an immutable object. */
typedef struct bwi_plate_matrices {
  bw_object object;
  bwi_plate_law law;         /* that they are made with */
  bw_plane_pattern *pattern; /* retained */
  double *stiffness;         /* 9 per block */
  double *mass;              /* 1 per block: integral of N_a N_b */
  double *shifted;           /* 9 per block: stiffness + shift mass, what the factor is of */
} bwi_plate_matrices;

/* All that an operation on a plate changes (plate_state.c). An operation makes the next state
 * beside the one that stands and puts it in its place when nothing can fail any more: it happens
 * whole or not at all, and keeping a state copies nothing. */
struct bw_plate_state {
  bw_object object;
  const bw_plane_mesh *mesh;          /* retained */
  const bwi_plate_matrices *matrices; /* retained: of the mesh */
  int mode_count;
  double *frequency, *shape, *residual;
  int known; /* vectors in `shape`: the modes and some guards, the next start, */
  int past;  /* and as the last of them modes of former frames */
};

struct bwi_plate {
  bwi_plate_law law;
  bwi_plate_reference reference;
  const bw_plate_state *now; /* retained; the public fields are its own */
  /* What makes the next frame faster. */
  bwi_lagged *factor;
  bool factored;              /* there is a factor of these nodes, of whatever shape */
  double *origin;             /* node_count x 2: where the nodes were then */
  int first_iterations, last; /* iterations with a new factor, and in the last solve */
  int lag;                    /* solutions since the factor's own */
  double factor_bytes;
};

/* A state of a mesh with its matrices and without modes. */
bw_status bwi_plate_blank(bw_context *context, const bw_plane_mesh *mesh,
                          const bwi_plate_matrices *matrices, bw_plate_state **state);
/* Puts a state in the place of the one that stands. Cannot fail. */
void bwi_plate_adopt(bw_plate *plate, const bw_plate_state *state);
/* The end of an operation: the state takes its place unless somebody asked to stop meanwhile, whom
 * a result would surprise. */
bw_status bwi_plate_commit(bw_context *context, bw_plate *plate, const bw_plate_state *next);

/* y = M x (3 numbers a node) */
bw_status bwi_plate_multiply_mass(bw_context *context, const bw_plate *plate, const double *x,
                                  double *y);

/* ---- eigenproblems of free plane bodies (free_modes.c) --------------------------------------- */

enum { BWI_PLANE_MOTIONS = 3 };
typedef bw_status bwi_plane_product(bw_context *context, const void *data, const double *x,
                                    double *y);
typedef struct bwi_free_body {
  int64_t size;
  const void *data;
  bwi_plane_product *stiffness, *mass, *precondition; /* of one vector */
  double *rigid; /* 6 x size, of the caller: three rigid-body motions, one after the other */
  double *mass_rigid;
} bwi_free_body;
/* Makes the motions M-orthonormal; M times them comes behind them. */
bw_status bwi_free_body_begin(bw_context *context, bwi_free_body *body);
/* Borrows the body. */
bwi_eigen_problem bwi_free_body_problem(bwi_free_body *body);

#endif
