/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* What the files of assemble share, and the stress fields use. */
#ifndef BARWRIGHT_ASSEMBLE_INTERNAL_H
#define BARWRIGHT_ASSEMBLE_INTERNAL_H

#include "barwright/assemble.h"

/* Degrees of the quadrature on curved elements: of gradient products, and of mass. */
enum { BWI_CURVED_DEGREE = 5, BWI_MASS_DEGREE = 6 };

/* The elements around every node, ascending, and which of its nodes it is there. */
typedef struct bwi_incidence {
  int64_t *start;   /* node_count + 1 */
  int32_t *element; /* start[node_count] */
  uint8_t *local;
} bwi_incidence;
bw_status bwi_incidence_of_elements(bw_context *context, int32_t node_count, int32_t element_count,
                                    int nodes_per_element, const int32_t *element,
                                    bwi_incidence *incidence);
bw_status bwi_incidence_create(bw_context *context, const bw_mesh *mesh, bwi_incidence *incidence);
void bwi_incidence_clear(bwi_incidence *incidence);

/* Rows of a pattern in work: what the nodes' elements add to the blocks of a row is added to places
 * that stay in cache, in ascending order of elements, so that a value has the same bits whichever
 * thread sums it. No list of what adds to which block is kept: it would take a third of a
 * stiffness. */
typedef struct bwi_row_sums {
  const bw_block_pattern *pattern;
  int nodes_per_element;
  const int32_t *element; /* what the pattern was made of */
  bwi_incidence incidence;
  int32_t *place; /* threads x node_count: index in the row in work of the block of a node */
} bwi_row_sums;
enum { BWI_ROWS_PER_CHUNK = 256 };
/* On failure too the rows are to be closed. */
bw_status bwi_row_sums_open(bw_context *context, const bw_block_pattern *pattern,
                            int32_t element_count, int nodes_per_element, const int32_t *element,
                            bwi_row_sums *rows);
void bwi_row_sums_close(bwi_row_sums *rows);
/* Sets the places of row i; returns how many blocks it has. */
static inline int64_t bwi_row_places(const bwi_row_sums *rows, int64_t i, int32_t *place) {
  const bw_block_pattern *pattern = rows->pattern;
  const int32_t *column = pattern->column + pattern->start[i];
  int64_t count = pattern->start[i + 1] - pattern->start[i];
  for (int64_t p = 0; p < count; p++)
    place[column[p]] = (int32_t)p;
  return count;
}
/* Nodes of the element at index k of the incidence. */
static inline const int32_t *bwi_row_element(const bwi_row_sums *rows, int64_t k) {
  return rows->element + (int64_t)rows->incidence.element[k] * rows->nodes_per_element;
}

/* What elements contribute to each block of a pattern, in ascending order of elements: for what
 * sums some blocks again and again. Release with bw_release. */
typedef struct bwi_contributions {
  bw_object object;
  int64_t blocks, count; /* of the pattern; contributions */
  int64_t *start;        /* blocks + 1 */
  int32_t *element;      /* of each contribution */
  uint8_t *local;        /* (a << 4) | b: local row and column nodes */
} bwi_contributions;
/* `element` (element_count x nodes_per_element) is what the pattern was made of. */
bw_status bwi_contributions_create(bw_context *context, const bw_block_pattern *pattern,
                                   int32_t element_count, int nodes_per_element,
                                   const int32_t *element, bwi_contributions **list);

/* The bulk modulus that acts on mean dilatations. In a tet4 the dilatation is constant anyway. */
static inline double bwi_projected_bulk(const bw_mesh *mesh, const bw_material *material) {
  return mesh->order == 2 ? bw_material_projected_bulk(material) : 0;
}

/* Node positions of an element. */
static inline void bwi_element_nodes(const bw_mesh *mesh, int64_t element, double (*x)[3]) {
  const int32_t *node = mesh->element + element * mesh->nodes_per_element;
  for (int a = 0; a < mesh->nodes_per_element; a++)
    for (int k = 0; k < 3; k++)
      x[a][k] = mesh->node[3 * (int64_t)node[a] + k];
}

/* Barycentric coordinates of local node a: of a corner, or of the midpoint of an edge. */
static inline void bwi_node_barycentric(int a, double l[4]) {
  l[0] = l[1] = l[2] = l[3] = 0;
  if (a < 4)
    l[a] = 1;
  else
    l[bw_tet_edge[a - 4][0]] = l[bw_tet_edge[a - 4][1]] = 0.5;
}

/* Gradients in space of the shape functions at local node a of an element. */
static inline void bwi_gradients_at_node(const bw_mesh *mesh, int64_t element, int a,
                                         double (*gradient)[3]) {
  double x[10][3], l[4];
  bwi_element_nodes(mesh, element, x);
  bwi_node_barycentric(a, l);
  bw_tet_gradient(mesh->order, (const double(*)[3])x, l, gradient);
}

/* bw_stiffness of the rows of the nodes that are not 0 in `rows` alone, with the same bits. The
 * other values are left as they are. */
bw_status bwi_stiffness_update(bw_context *context, const bw_block_pattern *pattern,
                               const bw_mesh *mesh, const bw_material *material,
                               const uint8_t *rows, double *values);
/* BW_INVALID unless the mesh has the pattern's topology (by its sizes). */
bw_status bwi_block_pattern_fits(bw_context *context, const bw_block_pattern *pattern,
                                 const bw_mesh *mesh);
/* The pattern of `node_count` rows from their columns, which it takes over: start (node_count + 1),
 * column (start[node_count]) as in bw_block_pattern. Its mesh is NULL, and nothing contributes to
 * its blocks: it serves products and factors. On failure they stay the caller's. */
bw_status bwi_block_pattern_of_rows(bw_context *context, int32_t node_count, int64_t *start,
                                    int32_t *column, bw_block_pattern **pattern);
/* Mark the blocks of two nodes of one facet of the boundary, by block: elsewhere the tensor of
 * gradients is symmetric (docs/theory/edit.md). */
void bwi_block_pattern_mark_surface(const bw_block_pattern *pattern, const bw_mesh *mesh,
                                    uint8_t *surface);
/* BW_GEOMETRY: the element has no positive volume (or Jacobian) at a point. */
bw_status bwi_fail_inverted(bw_context *context, const bw_mesh *mesh, int64_t element,
                            double determinant);

/* A stiffness that is read row by row: one that is stored (block_count x 9), or else that of a mesh
 * and a material, whose rows are made one by one and kept by nobody. */
typedef struct bwi_stiffness {
  const double *values; /* or NULL */
  const bw_mesh *mesh;
  const bw_material *material;
} bwi_stiffness;
/* Of row i: its blocks on and left of the diagonal, 9 numbers each. */
typedef void bwi_stiffness_row(void *data, int64_t i, const double *row);
/* Every row once, several at the same time. The same numbers either way. Statuses of
 * bw_stiffness. */
bw_status bwi_stiffness_rows(bw_context *context, const bw_block_pattern *pattern,
                             const bwi_stiffness *stiffness, bwi_stiffness_row *take, void *data);

/* Which elements are curved: *number has an entry per element, its index among the curved ones or
 * -1; NULL when all are straight (always for tet4). */
bw_status bwi_find_curved(bw_context *context, const bw_mesh *mesh, int32_t **number,
                          int64_t *count);
/* Whether the block of two nodes with no facet of the boundary in common is symmetric in itself:
 * elements are straight, of one material, and displacements alone enter their energy. */
bw_status bwi_blocks_even(bw_context *context, const bw_mesh *mesh, const bw_material *material,
                          bool *even);

#endif
