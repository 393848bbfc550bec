/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* Sectors of cyclic symmetry among the files of joint (docs/theory/symmetry.md). */
#ifndef BWI_JOINT_CYCLIC_H
#define BWI_JOINT_CYCLIC_H

#include "joint/internal.h"

/* As bwi_reduction_open, of a sector in a wheel with so many nodal diameters. T has twice the rows,
 * real and imaginary parts, where bwi_cyclic_parts is 2. BW_INVALID for supports that differ from
 * sector to sector, BW_UNSUPPORTED for bonds that reach a cut. */
bw_status bwi_cyclic_reduction_open(bw_context *context, const bw_model *model, int diameter,
                                    bwi_reduction *reduction);
/* Moves forces (node_count x 3) that are the same in all sectors from the high face to the low one.
 */
void bwi_cyclic_move(const bw_cyclic *cyclic, double *force);
/* The whole wheel of a sector. Nodes are numbered sector by sector without those of the high faces,
 * then those on the axis; elements sector by sector. */
typedef struct bwi_wheel {
  const bw_cyclic *cyclic;
  const bw_mesh *sector;
  int32_t own_count; /* nodes of each sector */
  int32_t *place;    /* node_count of the sector: among these, or those on the axis */
  bw_mesh *mesh;
  bw_material *material; /* its axes turn with the sectors */
} bwi_wheel;
/* Close with bwi_wheel_close in any case. BW_INVALID where `cyclic` is NULL. */
bw_status bwi_wheel_open(bw_context *context, const bw_cyclic *cyclic, const bw_material *material,
                         bwi_wheel *wheel);
void bwi_wheel_close(bwi_wheel *wheel);
/* The node of the wheel that a node of a sector is. */
int64_t bwi_wheel_node(const bwi_wheel *wheel, int sector, int32_t node);
/* factor times the real part of exp(i diameter angle) R (u + i v), sector by sector; v may be NULL.
 */
void bwi_wheel_expand(const bwi_wheel *wheel, int diameter, const double *u, const double *v,
                      double factor, double *whole);
/* force (3 numbers for each node) of the wheel: those of each sector alone, added up. */
void bwi_wheel_add_forces(const bwi_wheel *wheel, const double *sector, double *whole);
/* A number for each node, the same in all sectors. */
void bwi_wheel_spread(const bwi_wheel *wheel, const double *sector, double *whole);
/* The model of the wheel: supports, attachments and loads of a sector in each. BW_UNSUPPORTED for
 * those of which directions cannot turn. */
bw_status bwi_wheel_model(bw_context *context, const bwi_wheel *wheel, const bw_model *sector,
                          bw_model **whole);
/* bw_joined_modes of a sector. */
bw_status bwi_cyclic_modes(bw_context *context, const bw_model *model,
                           const bw_modes_options *options, bw_modes **modes);

#endif
