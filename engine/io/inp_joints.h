/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* What joins the bodies of an input deck: nodes behind those of the mesh, linear equations, springs
 * and masses. */
#ifndef BWI_IO_INP_JOINTS_H
#define BWI_IO_INP_JOINTS_H

#include "barwright/io.h"

/* A value of one displacement: of direction 0..2 of a node, from 0. */
typedef struct bwi_inp_value {
  int32_t node;
  int direction;
  double value;
} bwi_inp_value;
typedef struct bwi_inp_list {
  size_t count, capacity;
  bwi_inp_value *item;
} bwi_inp_list;

typedef struct bwi_inp_joints {
  size_t node_count, node_capacity;
  double *node;      /* (m, node_count x 3) places of the further nodes */
  bwi_inp_list term; /* of equations: their values times displacements sum to 0 */
  size_t equation_count, equation_capacity;
  size_t *first;       /* (equation_count) the first term of each, which is eliminated */
  bwi_inp_list spring; /* (N/m) to the ground */
  bwi_inp_list mass;   /* (kg) in all directions, for a frequency step */
  bwi_inp_list fixed;  /* (m) displacements of the further nodes */
  bwi_inp_list force;  /* (N) on them */
} bwi_inp_joints;

bw_status bwi_inp_list_add(bw_context *context, bwi_inp_list *list, int32_t node, int direction,
                           double value);
void bwi_inp_joints_clear(bwi_inp_joints *joints);

/* bw_inp_write of bodies with joints, which may be NULL. */
bw_status bwi_inp_write(bw_context *context, const bw_inp_deck *deck, const bwi_inp_joints *joints,
                        const char *path);

/* Parts of the deck: nodes, then what follows them, and what a static step has. */
void bwi_inp_write_joints(bw_writer *writer, const bw_inp_deck *deck, const bwi_inp_joints *j);
void bwi_inp_write_joint_loads(bw_writer *writer, const bwi_inp_joints *j);
/* A number in at most 20 characters. */
void bwi_inp_write_number(bw_writer *writer, double value);

#endif
