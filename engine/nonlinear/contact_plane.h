/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* Planes that a solid does not pass: frictionless contact by augmented Lagrangians.
 *
 * A point p with the gap g (distance to its plane, negative: passed) pushes with the force
 * f = max(0, l - c g) along the normal: the gradient of the energy (f^2 - l^2) / 2c, which has one
 * derivative, so line searches work on it. l is the multiplier, c a stiffness a good deal above the
 * solid's own at the point. In equilibrium, l is set to f and the equilibrium found again, until
 * gaps of points that push are zero to rounding: then f is the exact contact force. f is never
 * negative: the plane does not pull. */
#ifndef BWI_NONLINEAR_CONTACT_PLANE_H
#define BWI_NONLINEAR_CONTACT_PLANE_H

#include "barwright/nonlinear.h"

typedef struct bwi_contact {
  const bw_load_case *load_case;
  int64_t count;     /* points that may touch */
  int32_t *plane;    /* count */
  double *rest;      /* count: height over the plane at load factor 0, both at rest */
  int64_t *start;    /* count + 1: terms of each point */
  int32_t *node;     /* terms */
  double *weight;    /* terms: the point's displacement is the sum of weight times the node's */
  double *stiffness; /* count: c */
  double *force;     /* count: f at the last evaluation */
  double *gap;       /* count: likewise */
  double *multiplier;
  bool borrows;    /* contact plane, stiffness and pushes are those of another */
  uint8_t *pushes; /* count: f > 0 at the last evaluation, or as was predicted since */
  double *offset;  /* contact_plane_count: how far each plane has moved along its normal */
  double *shift;   /* contact_plane_count: how much further back it is at load factor 0 */
} bwi_contact;

/* `blocks`: node_count x 9, the solid's own stiffness at each node. *contact stays NULL for a case
 * without contact planes. */
bw_status bwi_contact_create(bw_context *context, const bw_load_case *load_case,
                             const double *blocks, bwi_contact **contact);
void bwi_contact_destroy(bwi_contact *contact);
/* Where the planes are at a load factor; `moved`: they are at their ends, but for the shifts. */
void bwi_contact_place(bwi_contact *contact, double load, bool moved);
/* Shift the planes so that at load factor 0 they do not reach into a shape that begins at u. */
void bwi_contact_begin(bwi_contact *contact, const double *u);
/* Energy, and forces added to `force` (may be NULL). Returns the points that push. */
int64_t bwi_contact_evaluate(bwi_contact *contact, const double *u, double *energy, double *force);
/* The largest |gap| among points that push, and depth of those that do not. */
double bwi_contact_error(const bwi_contact *contact);
/* Multipliers become the forces of the last evaluation. */
void bwi_contact_settle(bwi_contact *contact);
/* Which points will push after a step d, their forces taken as linear, l - c g, in those that are
 * taken to push: `pushes` becomes that, and blocks of a pattern (may be NULL) follow. Returns how
 * many are not as before. */
int64_t bwi_contact_predict(bwi_contact *contact, const double *d, const bw_block_pattern *pattern,
                            double *values);
/* Those linear forces at the last evaluation, added. */
void bwi_contact_linear(const bwi_contact *contact, double *force);
/* Derivatives with the points that push, added to blocks of a pattern, to node blocks, or to y
 * (their product with x). */
void bwi_contact_stiffness(const bwi_contact *contact, const bw_block_pattern *pattern,
                           double *values);
void bwi_contact_blocks(const bwi_contact *contact, double *blocks);
void bwi_contact_multiply(const bwi_contact *contact, const double *x, double *y);
/* The same points as parts of a coarse solid, for those derivatives alone: which of them push is
 * read from `contact`, which must outlive it. */
bw_status bwi_contact_coarse(bw_context *context, const bwi_contact *contact,
                             const bw_coarsening *coarsening, bwi_contact **coarse);

#endif
