/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* The stiffness kept domain by domain: lists, coefficients and shapes.
 *
 * A pair whose elements all lie in one domain is inside it, and its entries are that domain's
 * alone. A pair with elements of several domains is shared: each keeps its part of the entries in a
 * slot, and the entries are their sum in the order of domains, so that the bits do not depend on
 * which edits led to them.
 *
 * Every (pair, domain) that occurs is an item. Items are listed in sections, two per domain: 2 d
 * those inside, 2 d + 1 those shared, each in ascending order of pairs. A section starts at a
 * multiple of four; four neighbouring items have their coefficients interleaved (component m of
 * item k at tensor[9 * (k & ~3) + 4 * m + (k & 3)]), so that a vector register holds one component
 * of four items. */
#ifndef BARWRIGHT_DOMAIN_H
#define BARWRIGHT_DOMAIN_H

#include "assemble/pair.h"

/* How a domain lay at some time. */
typedef struct bwi_domain_shape {
  bool reshaped;
  double linear[9], frame[9];
} bwi_domain_shape;

typedef struct bwi_domain_coefficients {
  /* elements and nodes, domain by domain */
  int32_t *element_start, *element; /* domain_count + 1 */
  int32_t *number;                  /* element_count: its place in `element` */
  int64_t *node_start;              /* domain_count + 1: of all nodes of its elements, ascending */
  int32_t *node;

  /* items */
  int64_t item_count;     /* with the gaps between sections */
  int64_t *section_start; /* 2 domain_count + 1 */
  int64_t *section_count; /* 2 domain_count */
  uint32_t *place;        /* item_count: 2 * (pair or slot), + 1 on the diagonal */
  double *tensor;         /* 9 item_count */
  int64_t shared_count;   /* shared pairs, ascending */
  uint32_t *shared_pair;
  int64_t *shared_start; /* shared_count + 1: its slots, by ascending domain */
  uint32_t *slot_shared; /* which shared pair a slot is of */
  int32_t *slot_domain;
  double *slot; /* 9 per slot: a domain's part of the entries */

  double elasticity[81]; /* [3 i + k][3 j + l]: C_ijkl at rest */
  bool turning_matters;  /* the material is not isotropic */

  /* Frames met on a domain's nodes, -1 the global one; with a material that is not isotropic also
     the frame in which the material rests. */
  int32_t *frame_start; /* domain_count + 1 */
  int32_t *frame_domain;

  /* `written` is the shape that the values have, `reported` that at which a domain was last said
     to have changed, with the frames of frame_domain then; positions (3 per entry of `node`) are
     kept where reshaped. */
  bwi_domain_shape *written, *reported;
  double *written_position, *reported_position;
  double *reported_frame; /* 9 frame_start[domain_count] */
} bwi_domain_coefficients;

/* domain_lists.c: everything that depends on topology alone. */
bw_status bwi_domain_lists(bw_context *context, const bw_graph *graph, int32_t domain_count,
                           const int32_t *element_domain, const int32_t *node_domain,
                           bool material_frame, bool material_turns, bwi_domain_coefficients *c);

/* domain_evaluate.c */
/* The 9 x 9 map of one item's nine coefficients to its nine entries, for a domain moved by x ->
 * linear x whose material is given by C as in `elasticity`. */
void bwi_domain_map(const double elasticity[81], const double linear[9], double map[81]);
/* Its derivative where linear changes by `direction`. */
void bwi_domain_map_derivative(const double elasticity[81], const double linear[9],
                               const double direction[9], double map[81]);
/* C of a material turned by the rotation: C'_ijkl = R_ia R_jb R_kc R_ld C_abcd. */
void bwi_turn_elasticity(const double elasticity[81], const double rotation[9], double turned[81]);
/* Entries of items [first, first + count), first a multiple of four, to `out` + 9 * index. */
void bwi_domain_evaluate(const bwi_domain_coefficients *c, const double map[81], int64_t first,
                         int64_t count, double *out);

/* ---- domain_write.c: entries of some domains ---- */

enum { BWI_DOMAIN_KEEP, BWI_DOMAIN_EVALUATE, BWI_DOMAIN_GATHER };

/* Items of one section, one thread's at a time. */
typedef struct bwi_domain_task {
  int64_t section, first, count;
} bwi_domain_task;

typedef struct bwi_domain_work {
  bw_domain_stiffness *stiffness;
  const bw_mesh *mesh;
  uint8_t *action; /* domain_count: BWI_DOMAIN_... */
  double *map;     /* 81 domain_count: coefficients to entries; where gathered, the elasticity */
  bwi_pair_source source;
  bwi_frames frames;    /* of elements of gathered domains, domain by domain */
  int64_t *first_frame; /* domain_count + 1 */
  bwi_domain_task *task;
  int64_t task_count;
  int64_t pairs; /* entries written by bwi_domain_write, in pairs */
} bwi_domain_work;
bw_status bwi_domain_work_create(bw_context *context, bw_domain_stiffness *stiffness,
                                 bwi_domain_work *work);
void bwi_domain_work_clear(bwi_domain_work *work);
/* Everything that can fail, with `action` given: lists of tasks, and the frames of the domains to
 * be gathered (BW_INVALID for curved elements, BW_GEOMETRY for inverted ones). */
bw_status bwi_domain_work_prepare(bw_context *context, const bw_mesh *mesh, bwi_domain_work *work);
/* The coefficients of all domains. */
bw_status bwi_domain_gather_rest(bw_context *context, bwi_domain_work *work);
/* The entries of all domains with an action, and of the pairs that they share. */
bw_status bwi_domain_write(bw_context *context, bwi_domain_work *work);

/* C of a domain, whose material may have turned with its frame. */
void bwi_domain_elasticity(const bw_domain_stiffness *stiffness, const double frame[9],
                           double elasticity[81]);

/* The row of a pair, sought from row `from` on. */
static inline int32_t bwi_row_of(const bw_graph *graph, int32_t from, int64_t pair) {
  int32_t step = 1, high = graph->node_count; /* start[from] <= pair < start[high] */
  while (high - from > step && graph->start[from + step] <= pair) {
    from += step;
    step *= 2;
  }
  if (high - from > step)
    high = from + step;
  while (high - from > 1) {
    int32_t middle = from + (high - from) / 2;
    if (graph->start[middle] <= pair)
      from = middle;
    else
      high = middle;
  }
  return from;
}

#endif
