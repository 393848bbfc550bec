/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* How a block of cubes moves when it is a part of a body: the coarse deformations, and the
 * fluctuations that its cubes may add. See docs/theory/data_driven.md, Sampling and fitting. */
#ifndef BWI_METAMATERIAL_BLOCK_H
#define BWI_METAMATERIAL_BLOCK_H

#include "metamaterial/internal.h"

/* A block has at most 27 nodes. Its coarse displacements are spanned by 8 functions per component,
 * in this order: 1, x, y, z, xy, yz, zx, xyz, where x, y, z run from -1 to 1 over the block: first
 * the affine ones, then the gradients of strain, as they are called here. `BWI_STRAINS` of the
 * affine ones are left without translations and rotations. */
enum {
  BWI_BLOCK_NODES = 27,
  BWI_BLOCK_SIZE = 81,
  BWI_COARSE = 24,
  BWI_AFFINE = 12,
  BWI_STRAINS = 6,
  BWI_SHAPES = 18, /* strains and gradients */
  BWI_PERIODIC = 21,
  BWI_BLOCK_FREE = 57 /* all fluctuations */
};

typedef struct bwi_condensed {
  int nodes, periodic; /* nodes; columns of `ripple` */
  /* Node displacements for each of the 24 coarse functions x components (3 m + i), with what the
   * block adds to them by itself; periodic fluctuations. Both row by row, 3 nodes rows. */
  double shape[BWI_BLOCK_SIZE * BWI_COARSE];
  double ripple[BWI_BLOCK_SIZE * BWI_PERIODIC];
  double stiffness[BWI_COARSE * BWI_COARSE]; /* in the coarse functions */
  double weak; /* stiffness of a void cube is this times bwi_weak_stiffness */
} bwi_condensed;

/* Block and children as for bwi_block_stiffness. False for void alone. */
bool bwi_condense(const int32_t size[3], const double *const child[8], bwi_condensed *condensed);
/* 24 x 24: what holds the nodes of void in their place, before scaling. */
void bwi_weak_stiffness(double stiffness[BWI_COARSE * BWI_COARSE]);
/* Node of a block at corner c of a child. */
int bwi_block_node(const int32_t size[3], int child, int c);
/* Values of the 8 functions at x, y, z in -1..1. */
void bwi_coarse_functions(const double at[3], double value[8]);

#endif
