/* deposition: residual stress of bodies that are laid down layer by layer. */
#ifndef BARWRIGHT_DEPOSITION_H
#define BARWRIGHT_DEPOSITION_H

#include "barwright/analysis.h"
#include "barwright/statics.h"

#ifdef __cplusplus
extern "C" {
#endif

/* The layer of each element by the height of its centroid along a direction (-): layer (index,
 * element_count), of `count` layers of equal height between the lowest and the highest node.
 * BW_INVALID for a direction without length, and a count below 1 or above that of elements. */
BW_API bw_status bw_deposition_layers(bw_context *context, const bw_mesh *mesh,
                                      const double direction[3], int32_t count, int32_t *layer);

/* How a body is laid down. */
typedef struct bw_deposition_options {
  int32_t layer_count;  /* layers, 1 to the number of elements; no default */
  const int32_t *layer; /* (index, element_count) the layer of each element, below layer_count;
                           borrowed; no default */
  const double *change; /* (K, node_count) from the temperature without stress to that at the end,
                           negative where the body cools; borrowed; no default */
  const bw_solver *solver; /* of each layer's statics; borrowed; default NULL: by counted cost */
} bw_deposition_options;

/* What a body that was laid down is like. Linear elasticity: stresses above the yield stress are
 * not what the body has. */
typedef struct bw_deposition {
  bw_object object;
  const bw_model *model;   /* retained */
  int32_t layer_count;     /* in which elements were laid */
  int32_t *layer;          /* (index, element_count) with which each element was laid */
  int64_t postponed;       /* (count) elements laid later than asked for: nothing that was laid
                              had a facet with them, or what had was not connected */
  double postponed_volume; /* (m3) of these */
  double *displacement;    /* (m, node_count x 3) since the node was laid */
  double *element_stress;  /* (Pa, element_count x 6) means of elements */
  double *reaction;        /* (N, node_count x 3) of the supports */
  double residual;         /* (-) the largest one of the layers' solutions */
} bw_deposition;
/* Lays a body down. Layer by layer, the elements of a layer are added without stress to what was
 * laid before. They then change their temperature, and all that was laid deforms
 * (docs/theory/deposition.md). The model's supports constrain the nodes that are there. An element
 * is added where it has a facet with what was laid, or three corners on supports. Where supports
 * carry no element of the first layer, that begins with its largest connected part. BW_INVALID for
 * layers that are not there, a model with loads or prescribed displacements, and where no material
 * expands; BW_UNSUPPORTED for bonds, attachments and supports along their facets' own normals,
 * BW_GEOMETRY for elements that are never reached, and those of bw_statics. */
BW_API bw_status bw_deposit(bw_context *context, const bw_model *model,
                            const bw_deposition_options *options, bw_deposition **deposition);
/* The same body with other supports, those of `model`, which is of the same mesh: what its supports
 * exerted is taken away. BW_INVALID for another mesh, another stiffness, and a model with loads or
 * prescribed displacements; those of bw_statics. `solver` may be NULL. */
BW_API bw_status bw_deposition_release(bw_context *context, const bw_deposition *deposition,
                                       const bw_model *model, const bw_solver *solver,
                                       bw_deposition **released);

#ifdef __cplusplus
}
#endif
#endif
