/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* The stiffness kept domain by domain: lists, coefficients and shapes.
 *
 * Pairs are cut into sections by the set of domains that their elements lie in: first one section
 * for the inside of each domain, then one for each set of several domains that share pairs. For
 * each of its domains a section has a block of coefficients, T of that domain's elements at rest;
 * entries are the sum over the blocks, in ascending order of domains, of the blocks' maps of T.
 * They depend on where the domains lie now, and not in one bit on the edits that brought them there
 * (but for differences that count as rounding, which are left: domain_update.c).
 *
 * Four neighbouring pairs of a section have their coefficients interleaved (component m of pair k
 * of a block at tensor[9 * (k & ~3) + 4 * m + (k & 3)]), so that a vector register holds one
 * component of four pairs; lists are filled up to a multiple of four by zeros. */
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

  /* sections: domain_count insides, then sets; pairs ascending in each */
  int64_t section_count;
  int64_t *section_start; /* section_count + 1, into `place`, multiples of four */
  int64_t *section_size;  /* section_count: pairs */
  uint32_t *place;        /* 2 * pair, + 1 on the diagonal */
  /* blocks: that of the inside of domain d is block d */
  int64_t *block_start;  /* section_count + 1 */
  int32_t *block_domain; /* ascending within a section */
  int64_t *block_first;  /* its first pair's place in `tensor`, over 9; + 1 for the end */
  double *tensor;        /* T at rest */
  /* T as it is now, of blocks of sets whose domain is reshaped: block b at 9 * (block_first[b] -
   * block_first[domain_count]) */
  double *present;
  double *map; /* 81 domain_count: what makes entries of T now, column by column */

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

/* domain_evaluate.c. Maps are column by column: map[9 m + r] is what component m of the
 * coefficients adds to entry r. */
/* Of a domain moved by x -> linear x whose material is given by C as in `elasticity`. */
void bwi_domain_map(const double elasticity[81], const double linear[9], double map[81]);
/* Its derivative where linear changes by `direction`. */
void bwi_domain_map_derivative(const double elasticity[81], const double linear[9],
                               const double direction[9], double map[81]);
/* C of a material turned by the rotation: C'_ijkl = R_ia R_jb R_kc R_ld C_abcd. */
void bwi_turn_elasticity(const double elasticity[81], const double rotation[9], double turned[81]);
/* C of a domain, whose material may have turned with its frame. */
void bwi_domain_elasticity(const bw_domain_stiffness *stiffness, const double frame[9],
                           double elasticity[81]);
/* Entries of pairs [first, first + size) of a section, first a multiple of four, to out + 9 * pair.
 * A block of a reshaped domain counts by `present`. */
void bwi_domain_evaluate(const bwi_domain_coefficients *c, int32_t domain_count, int64_t section,
                         int64_t first, int64_t size, double *out);

/* domain_write.c: entries of some domains. */
enum { BWI_DOMAIN_KEEP, BWI_DOMAIN_EVALUATE, BWI_DOMAIN_GATHER };

/* Some pairs of one section, for one thread: to be written, or one block's T to be gathered. */
typedef struct bwi_domain_task {
  int64_t section, block, first, size;
} bwi_domain_task;
typedef struct bwi_domain_tasks {
  bwi_domain_task *task;
  size_t capacity;
  int64_t count;
} bwi_domain_tasks;

typedef struct bwi_domain_work {
  bw_domain_stiffness *stiffness;
  const bw_mesh *mesh;
  uint8_t *action; /* domain_count: BWI_DOMAIN_... */
  bwi_pair_source source;
  bwi_frames frames;       /* of elements of gathered domains, domain by domain */
  int64_t *first_frame;    /* domain_count + 1 */
  bwi_domain_tasks gather; /* blocks whose T is gathered */
  bwi_domain_tasks write;  /* sections whose entries are written */
  int64_t pairs;           /* in the latter */
} bwi_domain_work;
bw_status bwi_domain_work_create(bw_context *context, bw_domain_stiffness *stiffness,
                                 bwi_domain_work *work);
void bwi_domain_work_clear(bwi_domain_work *work);
/* Everything that can fail, with `action` given: lists of tasks, and the frames of the domains to
 * be gathered (BW_INVALID for curved elements, BW_GEOMETRY for inverted ones). `rest`: for
 * bwi_domain_gather_rest. */
bw_status bwi_domain_work_prepare(bw_context *context, const bw_mesh *mesh, bool rest,
                                  bwi_domain_work *work);
/* The coefficients at rest of all domains, all of them to be gathered; what is left to do is then
 * to evaluate them. */
bw_status bwi_domain_gather_rest(bw_context *context, bwi_domain_work *work);
/* The entries of all sections that a domain with an action has part in, by `map` and `written` as
 * they are now. */
bw_status bwi_domain_write(bw_context *context, bwi_domain_work *work);

#endif
