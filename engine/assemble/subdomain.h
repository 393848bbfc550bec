/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* The stiffness kept subdomain by subdomain: lists, coefficients and shapes.
 *
 * Blocks are sorted into sections by the set of subdomains that their elements lie in: two sections
 * for the inside of each subdomain, then one for each set of several subdomains that share blocks.
 * For each of its subdomains a block has coefficients, T of that subdomain's elements at rest;
 * entries are the sum over the subdomains, ascending, of the subdomains' maps of T. They depend on
 * where the subdomains lie now, and not in one bit on the edits that brought them there (but for
 * differences that count as rounding, which are left: subdomain_update.c).
 *
 * Inside a subdomain the skew half of T is an integral over the facets of the body's boundary that
 * hold both nodes (docs/theory/edit.md): it vanishes for most blocks, whose section keeps the six
 * numbers of the symmetric half alone.
 *
 * What takes the time is reading coefficients and writing entries, so that they lie in one order:
 * blocks are cut into tiles of neighbours, and what a section has in a tile is a segment. Four
 * blocks of a segment have their coefficients interleaved, so that a vector register holds one
 * component of four blocks: of the j-th subdomain of its section, component m of block k is at
 * tensor[item + numbers
 * * (j * bwi_next_four(size) + (k & ~3)) + 4 * m + (k & 3)]. Segments are filled up to a multiple
 * of four by zeros. */
#ifndef BARWRIGHT_SUBDOMAIN_H
#define BARWRIGHT_SUBDOMAIN_H

#include "assemble/block.h"

/* How a subdomain lay at some time. */
typedef struct bwi_subdomain_shape {
  bool reshaped;
  double linear[9], frame[9];
} bwi_subdomain_shape;

/* The blocks of a section in one tile. */
typedef struct bwi_subdomain_segment {
  int64_t section, first; /* into `block_code` */
  int64_t item, present;  /* into `tensor` and `present` */
  int32_t size, numbers;  /* blocks; of each and each subdomain: 6 or 9 */
} bwi_subdomain_segment;
static inline int64_t bwi_next_four(int64_t n) {
  return (n + 3) & ~(int64_t)3;
}

typedef struct bwi_subdomain_coefficients {
  /* elements and nodes, subdomain by subdomain */
  bwi_contributions *contributions;
  int32_t *element_start, *element; /* subdomain_count + 1 */
  int32_t *number;                  /* element_count: its index in `element` */
  int64_t *node_start; /* subdomain_count + 1: of all nodes of its elements, ascending */
  int32_t *node;

  /* sections: subdomain_count insides without skew halves, as many with them, then sets */
  int64_t section_count, inside_count;
  int64_t *section_size;      /* section_count: blocks */
  int64_t *section_start;     /* section_count + 1, into section_subdomain */
  int32_t *section_subdomain; /* the subdomains of each section, ascending */
  /* segments: tile by tile, in each by ascending sections */
  int64_t segment_count, code_count, item_count, present_count;
  bwi_subdomain_segment *segment;
  uint32_t *block_code; /* 2 * block, + 1 on the diagonal; ascending in each segment */
  double *tensor;       /* T at rest, by halves: (T_pq + T_qp) / 2 for p <= q, (T_pq - T_qp) / 2 */
  double *present;      /* T as it is now, of segments of sets, where a subdomain is reshaped */
  double *map;          /* BWI_SUBDOMAIN_MAP subdomain_count: what makes entries of T now */

  double *elasticity;       /* subdomain_count x 81, [3 i + k][3 j + l]: C_ijkl at rest */
  bool orientation_matters; /* the material of a subdomain is not isotropic */

  /* Frames met on a subdomain's nodes, -1 the global one; with a material that is not isotropic
     also the frame in which the material rests. */
  int32_t *frame_start; /* subdomain_count + 1 */
  int32_t *frame_subdomain;

  /* `written` is the shape that the values have, `reported` that at which a change of the subdomain
     was last reported, with the frames of frame_subdomain then; positions (3 per entry of `node`)
     are kept where reshaped. */
  bwi_subdomain_shape *written, *reported;
  double *written_position, *reported_position;
  double *reported_frame; /* 9 frame_start[subdomain_count] */
} bwi_subdomain_coefficients;

/* subdomain_material.c. BW_INVALID where a subdomain is of several materials. */
bw_status bwi_subdomain_one_material(bw_context *context, const bw_material *material,
                                     int32_t subdomain_count, const bwi_subdomain_coefficients *c);
/* `elasticity` of a subdomain from its material. */
void bwi_subdomain_take_elasticity(const bw_material *material, int32_t d,
                                   const bwi_subdomain_coefficients *c);
/* Whether the stiffness of a subdomain is another with this material. */
bool bwi_subdomain_other_material(const bw_subdomain_stiffness *stiffness,
                                  const bw_material *material, int32_t d);
/* Whether the stiffness can be brought to this material; see bw_subdomain_stiffness_update. */
bw_status bwi_subdomain_check_material(bw_context *context, const bw_subdomain_stiffness *stiffness,
                                       const bw_material *material);

/* subdomain_lists.c: everything that depends on topology alone. */
bw_status bwi_subdomain_lists(bw_context *context, const bw_block_pattern *pattern,
                              int32_t subdomain_count, const int32_t *element_subdomain,
                              const int32_t *node_subdomain, bool material_frame,
                              bool rotate_material, bwi_subdomain_coefficients *c);

/* subdomain_evaluate.c. A tensor's halves: xx xy xz yy yz zz of the symmetric one, xy xz yz of the
 * skew one. A map makes those of the entries: map[6 m + r] and map[36 + 3 m + r] is what number m
 * of a half adds to number r of that half. */
enum { BWI_SUBDOMAIN_MAP = 36 + 9 };
/* The first 6 or all 9 numbers of the halves of T (rows of four) to out[4 m]. */
void bwi_subdomain_halves(const bwi_vector t[3], int numbers, double *out);
/* Of a subdomain moved by x -> linear x whose material is given by C as in `elasticity`. */
void bwi_subdomain_map(const double elasticity[81], const double linear[9],
                       double map[BWI_SUBDOMAIN_MAP]);
/* C of a subdomain, whose material may have rotated with its frame. */
void bwi_subdomain_elasticity(const bw_subdomain_stiffness *stiffness, int32_t subdomain,
                              const double frame[9], double elasticity[81]);
/* T of a segment's j-th subdomain: at rest, or as it counts now. */
static inline double *bwi_subdomain_rest(const bwi_subdomain_coefficients *c,
                                         const bwi_subdomain_segment *segment, int64_t j) {
  return c->tensor + segment->item + j * segment->numbers * bwi_next_four(segment->size);
}
static inline double *bwi_subdomain_present(const bwi_subdomain_coefficients *c,
                                            const bwi_subdomain_segment *segment, int64_t j) {
  return c->present + segment->present + j * segment->numbers * bwi_next_four(segment->size);
}
/* Entries of a segment to out + 9 * block. */
void bwi_subdomain_evaluate(const bwi_subdomain_coefficients *c,
                            const bwi_subdomain_segment *segment, double *out);

/* subdomain_write.c: entries of some subdomains. */
enum { BWI_SUBDOMAIN_KEEP, BWI_SUBDOMAIN_EVALUATE, BWI_SUBDOMAIN_GATHER };

typedef struct bwi_subdomain_work {
  bw_subdomain_stiffness *stiffness;
  const bw_mesh *mesh;
  uint8_t *action; /* subdomain_count: BWI_SUBDOMAIN_... */
  bwi_block_term table[256];
  bwi_frames frames;    /* of elements of gathered subdomains, subdomain by subdomain */
  int64_t *first_frame; /* subdomain_count + 1 */
  bool *touched;        /* section_count: a subdomain of it has an action */
  int64_t blocks;       /* of those sections */
} bwi_subdomain_work;
bw_status bwi_subdomain_work_create(bw_context *context, bw_subdomain_stiffness *stiffness,
                                    bwi_subdomain_work *work);
void bwi_subdomain_work_clear(bwi_subdomain_work *work);
/* Everything that can fail, with `action` given: the frames of the subdomains to be gathered
 * (BW_INVALID for curved elements, BW_GEOMETRY for inverted ones). */
bw_status bwi_subdomain_work_prepare(bw_context *context, const bw_mesh *mesh,
                                     bwi_subdomain_work *work);
/* The coefficients at rest of all subdomains, all of them to be gathered; what is left to do is
 * then to evaluate them. */
bw_status bwi_subdomain_gather_rest(bw_context *context, bwi_subdomain_work *work);
/* The entries of all sections that a subdomain with an action has part in, by `map` and `written`
 * as they are now. */
bw_status bwi_subdomain_write(bw_context *context, bwi_subdomain_work *work);

#endif
