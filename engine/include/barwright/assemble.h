/* assemble: sparse patterns of node pairs, stiffness, mass, Laplacian. Patterns are built once per
 * topology; values are gathered into known places, with the same bits for any thread count. */
#ifndef BARWRIGHT_ASSEMBLE_H
#define BARWRIGHT_ASSEMBLE_H

#include "barwright/element.h"
#include "barwright/model.h"

#ifdef __cplusplus
extern "C" {
#endif

/* The graph of nodes that share an element, lower triangle by rows with the diagonal last, and for
 * every stored pair the list of contributions (element, local pair). Depends on topology only. */
typedef struct bw_graph {
  bw_object object;
  const bw_mesh *mesh; /* retained: any mesh of the same topology may be assembled */
  int32_t node_count;
  int64_t pair_count;
  int64_t *start;        /* node_count + 1 */
  int32_t *column;       /* pair_count: columns j <= i of row i, ascending */
  int64_t *upper_start;  /* node_count + 1: pairs (k, i) with k > i seen from i */
  int64_t *upper_pair;   /* their places in `column` order */
  int32_t *upper_row;    /* their rows k */
  int64_t *gather_start; /* pair_count + 1 */
  int32_t *gather_element;
  uint8_t *gather_local; /* (a << 4) | b: local row and column nodes */
} bw_graph;
bw_status bw_graph_create(bw_context *context, const bw_mesh *mesh, bw_graph **graph);

/* Stiffness: 9 numbers per pair, row by row (row = node i). Closed form for straight elements,
 * quadrature for curved tet10. `values` has room for 9 * pair_count. */
bw_status bw_stiffness(bw_context *context, const bw_graph *graph, const bw_mesh *mesh,
                       const bw_material *material, double *values);
/* Consistent mass per unit density: one number per pair (times the 3x3 identity), m3. */
bw_status bw_mass(bw_context *context, const bw_graph *graph, const bw_mesh *mesh, double *values);
/* Lumped mass per unit density: one number per node, positive, summing to the volume (diagonal
 * scaling for tet10). */
bw_status bw_lumped_mass(bw_context *context, const bw_mesh *mesh, double *values);
/* Stiffness of the scalar Laplacian: one number per pair. */
bw_status bw_laplacian(bw_context *context, const bw_graph *graph, const bw_mesh *mesh,
                       double *values);
/* One element's stiffness (12x12 or 30x30, full) and mass (4x4 or 10x10): also the readable
 * reference in the tests. */
bw_status bw_element_stiffness(bw_context *context, int order, const double (*x)[3],
                               const bw_material *material, double *stiffness);
void bw_element_mass(int order, const double (*x)[3], double *mass);

/* y = A x for `count` vectors (node_count x 3 each, one after the other); `block` 9: a stiffness,
 * 1: a mass or Laplacian acting on each of the `components` (1 or 3) alike. */
bw_status bw_graph_multiply(bw_context *context, const bw_graph *graph, const double *values,
                            int block, int components, int64_t count, const double *x, double *y);

#ifdef __cplusplus
}
#endif
#endif
