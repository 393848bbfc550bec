/* assemble: block sparsity patterns, stiffness, mass, Laplacian. Patterns are built once per
 * topology; values are gathered into known places, with the same bits for any thread count. */
#ifndef BARWRIGHT_ASSEMBLE_H
#define BARWRIGHT_ASSEMBLE_H

#include "barwright/element.h"
#include "barwright/model.h"

#ifdef __cplusplus
extern "C" {
#endif

/* The block sparsity pattern (nodes i and j share an element), lower triangle by rows with the
 * diagonal last. Depends on topology only. */
typedef struct bw_block_pattern {
  bw_object object;
  const bw_mesh *mesh; /* retained: any mesh of the same topology may be assembled; NULL where it
                          was made of element lists */
  int32_t node_count;
  int64_t block_count;
  int64_t *start;       /* (index, node_count + 1) first block of each row */
  int32_t *column;      /* (index, block_count) columns j <= i of row i, ascending */
  int64_t *upper_start; /* (index, node_count + 1) of the blocks (k, i) with k > i seen from i */
  int32_t *upper_row;   /* (index, upper_start[node_count]) their rows k */
  int32_t *upper_place; /* (index, upper_start[node_count]) their places within those rows */
} bw_block_pattern;
/* The index of upper block u in `column`. */
static inline int64_t bw_upper_block(const bw_block_pattern *pattern, int64_t u) {
  return pattern->start[pattern->upper_row[u]] + pattern->upper_place[u];
}
/* The pattern of a mesh. */
BW_API bw_status bw_block_pattern_create(bw_context *context, const bw_mesh *mesh,
                                         bw_block_pattern **pattern);
/* The same of any elements with up to 16 nodes: element (index, element_count x nodes_per_element).
 * The pattern's mesh is NULL: it serves products and factors, not the functions that take a mesh.
 * Every node must have an element. */
BW_API bw_status bw_block_pattern_of_elements(bw_context *context, int32_t node_count,
                                              int32_t element_count, int nodes_per_element,
                                              const int32_t *element, bw_block_pattern **pattern);

/* Stiffness: values (N/m, block_count x 3 x 3), row = node i. Closed form for straight elements,
 * quadrature for curved tet10. BW_GEOMETRY for an inverted element. */
BW_API bw_status bw_stiffness(bw_context *context, const bw_block_pattern *pattern,
                              const bw_mesh *mesh, const bw_material *material, double *values);
/* A static sentence that warns of volumetric locking and names the cure, or NULL where none is
 * expected: nearly incompressible materials (mean Poisson's ratio above 0.48) in elements of the
 * standard formulation. */
BW_API const char *bw_locking(const bw_mesh *mesh, const bw_material *material);
/* Consistent mass of a material: values (kg, block_count), each times the 3x3 identity. With
 * density 1 where `material` is NULL or one of its parts has no density (m3 then). BW_INVALID for a
 * material of other elements. */
BW_API bw_status bw_mass(bw_context *context, const bw_block_pattern *pattern, const bw_mesh *mesh,
                         const bw_material *material, double *values);
/* The same of a weight by element, such as a heat capacity per volume: weight (any, element_count)
 * or NULL, 1; values (any, block_count) in its unit times m3. */
BW_API bw_status bw_weighted_mass(bw_context *context, const bw_block_pattern *pattern,
                                  const bw_mesh *mesh, const double *weight, double *values);
/* Lumped mass of a weight by element: weight (any, element_count) or NULL, 1; values (any,
 * node_count) in its unit times m3, summing to the weighted volume, and positive where weights are
 * (diagonal scaling for tet10). */
BW_API bw_status bw_lumped_mass(bw_context *context, const bw_mesh *mesh, const double *weight,
                                double *values);
/* Stiffness of the scalar Laplacian: values (m, block_count). BW_GEOMETRY as bw_stiffness. */
BW_API bw_status bw_laplacian(bw_context *context, const bw_block_pattern *pattern,
                              const bw_mesh *mesh, double *values);
/* The full stiffness (N/m, 12 x 12 or 30 x 30) of an element with nodes x (m, 4 or 10 x 3): also
 * the readable reference in the tests. BW_GEOMETRY for an inverted element. */
BW_API bw_status bw_element_stiffness(bw_context *context, int order, const double (*x)[3],
                                      const bw_material *material, double *stiffness);
/* The consistent mass (m3, 4 x 4 or 10 x 10) per unit density of an element with nodes x (m, 4 or
 * 10 x 3). */
BW_API void bw_element_mass(int order, const double (*x)[3], double *mass);

/* y = A x for `count` vectors x and y (any, count x node_count x components) and values (any,
 * block_count x block); `block` 9: a stiffness, 1: a mass or Laplacian acting on each of the
 * `components` (1 or 3) alike. */
BW_API bw_status bw_block_multiply(bw_context *context, const bw_block_pattern *pattern,
                                   const double *values, int block, int components, int64_t count,
                                   const double *x, double *y);

/* ---- stiffness kept subdomain by subdomain (agile, sections 5 and 6) ------------------------- */

/* How a subdomain lies now, relative to rest: the mesh that the stiffness was created with. Never
 * relative to an earlier edit, so that rounding does not accumulate over a session and an old
 * motion undoes an edit. */
typedef struct bw_subdomain_motion {
  /* (-) Where !reshaped: x -> linear x + translation took it from rest to now. Positive
   determinant; a rotation times a scaling for a subdomain of type R. The translation changes no
   stiffness. */
  double linear[9];
  /* (-) With R the subdomain's rotation since rest: frame = R^T. Row i is R e_i, where the i-th
   direction of rest has gone to: the unknowns of nodes that go with the subdomain are taken along
   these rows (own = frame * global). A rotation also where reshaped. Turning a subdomain as a
   whole, so that R and the shape turn together, changes none of its entries in these directions. */
  double frame[9];
  bool reshaped; /* its nodes moved otherwise: they are read from the mesh, and linear is not used.
                    Any subdomain may become so and stop being so again */
} bw_subdomain_motion;
/* Writes the motion of a subdomain at rest: identities. */
BW_API void bw_subdomain_motion_rest(bw_subdomain_motion *motion);

/* What an update wrote. */
typedef struct bw_subdomain_change {
  /* how many subdomains: unchanged; evaluated by the polynomials; recomputed from coordinates */
  int32_t kept, evaluated, gathered;
  int64_t blocks; /* how many blocks were written */
} bw_subdomain_change;

/* The stiffness of a mesh cut into subdomains, in global directions, 9 per block of the pattern.
 * Per block and subdomain it keeps the coefficients T_ab = integral of grad N_a (x) grad N_b at
 * rest; a subdomain moved by x -> A x has det(A) A^-T T A^-1, of which eq. A.8 of agile is the case
 * of a diagonal A. Entries are products of these with the elasticity tensor, isotropic or not
 * (docs/theory/edit.md). Mutable; the object's revision moves when entries were written. */
typedef struct bw_subdomain_stiffness {
  bw_object object;
  const bw_block_pattern *pattern; /* retained */
  /* Retained: that of the last update. Its axes stay global, unless rotate_material */
  const bw_material *material;
  bool rotate_material; /* an orthotropic material's axes turn with each subdomain's frame, from
                          what they are in `material` (rotated by element: one way in each
                          subdomain) */
  int32_t subdomain_count;
  double *values;    /* (N/m, block_count x 9) those of bw_stiffness for the mesh as it is now */
  uint8_t *changed;  /* (subdomain_count) by the last update, in the unknowns' own frames */
  uint64_t revision; /* of the values: the same as the object's */
  struct bwi_subdomain_coefficients *coefficients; /* the engine's own */
} bw_subdomain_stiffness;
/* All subdomains at rest in `mesh`, with rotate_material as above. element_subdomain (index,
 * element_count) and node_subdomain (index, node_count), -1: the global frame, for nodes some but
 * not all of whose components are prescribed, are copied. Curved elements are BW_INVALID, as they
 * have no closed form; BW_UNSUPPORTED for the B-bar formulation, BW_LIMIT for too many
 * contributions, BW_GEOMETRY for an inverted element. */
BW_API bw_status bw_subdomain_stiffness_create(bw_context *context, const bw_block_pattern *pattern,
                                               const bw_mesh *mesh, const bw_material *material,
                                               bool rotate_material, int32_t subdomain_count,
                                               const int32_t *element_subdomain,
                                               const int32_t *node_subdomain,
                                               bw_subdomain_stiffness **stiffness);
/* Brings it to another shape and material: motion[subdomain_count] says how every subdomain lies
 * now; `mesh` has the nodes as they are now, and is read for reshaped subdomains only. `material`
 * is that of the body now, which may differ from that before in any subdomain
 * (bw_subdomain_stiffness_follows). Only entries of subdomains
 * whose global entries changed are written (contributions of the others at shared blocks are kept).
 * Changes since the last writing below 2e-14 (of the map; for reshaped subdomains of the largest
 * coordinate) count as rounding and are not written. So the values stay within 1e-12 of those from
 * scratch after any number of updates.
 *
 * `changed` says for which subdomains any entry changed in the frames of its nodes, with the same
 * tolerance relative to the shape at which it was last reported. It is false for a subdomain that
 * only turned as a whole together with the frames of all its nodes (and, if anisotropic, its
 * material), though its global entries were written. It is true for one that stayed while the frame
 * of a neighbour's node turned, though nothing was written. On failure everything is as it was:
 * BW_INVALID for a motion that is none (not finite, determinant not positive, frame no rotation), a
 * curved element, or a subdomain of several materials, BW_GEOMETRY for an inverted element,
 * BW_UNSUPPORTED for a material that is not followed. `change` may be NULL. */
BW_API bw_status bw_subdomain_stiffness_update(bw_context *context,
                                               bw_subdomain_stiffness *stiffness,
                                               const bw_mesh *mesh, const bw_material *material,
                                               const bw_subdomain_motion *motion,
                                               bw_subdomain_change *change);
/* Whether it can be brought to another material: isotropic ones may become isotropic ones; any may
 * become any where the body was made with one that is not, whose axes stay global. */
BW_API bool bw_subdomain_stiffness_follows(const bw_subdomain_stiffness *stiffness,
                                           const bw_material *material);
/* Bytes of coefficients, contribution lists and entries, for the benchmarks. */
BW_API size_t bw_subdomain_stiffness_bytes(const bw_subdomain_stiffness *stiffness);

#ifdef __cplusplus
}
#endif
#endif
