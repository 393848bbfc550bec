/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* Subdomains on a mesh that was refilled in a posed shape (bw_mesh_refill).
 *
 * Kept nodes keep where they are at rest and what moves them, so that the surface goes on being the
 * function of the pose that it was. New nodes lie inside blended subdomains. Their weights solve
 * Laplace's equation on the refilled shape, and their place at rest is what their own blended map
 * takes to where the filling put them. */
#include "shape/subdomains_internal.h"

#include <math.h>
#include <string.h>

/* ---- labels ---------------------------------------------------------------------------------- */

/* The subdomain of every component, which is a face-connected part of `replace`; components are
 * numbered by their lowest element. */
static bw_status find_components(bw_context *context, const bw_subdomains *old,
                                 const uint8_t *replace, int32_t *component_subdomain,
                                 int32_t *components) {
  const bw_mesh *mesh = old->mesh;
  bw_status status = BW_OK;
  int32_t depth = 0;
  uint8_t *seen = BW_NEW0(context, uint8_t, mesh->element_count);
  int32_t *stack = BW_NEW(context, int32_t, mesh->element_count);
  *components = 0;
  BW_TRY_MEMORY(seen && stack);
  status = BW_OK;
  for (int32_t first = 0; first < mesh->element_count; first++) {
    if (!replace[first] || seen[first])
      continue;
    int32_t subdomain = old->element_subdomain[first];
    component_subdomain[(*components)++] = subdomain;
    seen[first] = 1;
    stack[depth++] = first;
    while (depth > 0) {
      int32_t e = stack[--depth];
      if (old->element_subdomain[e] != subdomain || old->bone_of[subdomain] >= 0)
        BW_TRY(bw_fail(context, BW_INVALID,
                       "element %d: only blended subdomains can be refilled, each by itself",
                       e + 1));
      for (int k = 0; k < 4; k++) {
        int32_t other = mesh->neighbour[4 * (size_t)e + (size_t)k];
        if (other >= 0 && replace[other] && !seen[other]) {
          seen[other] = 1;
          stack[depth++] = other;
        }
      }
    }
  }
done:
  bw_free(seen);
  bw_free(stack);
  return status;
}

static bw_status make_labels(bw_context *context, const bw_subdomains *old, const bw_mesh *mesh,
                             const uint8_t *replace, const int32_t *element_from, int32_t *label) {
  bw_status status = BW_OK;
  int32_t components = 0;
  int32_t *component_subdomain = BW_NEW(context, int32_t, old->mesh->element_count);
  if (!component_subdomain)
    return BW_MEMORY;
  BW_TRY(find_components(context, old, replace, component_subdomain, &components));
  for (int32_t e = 0; e < mesh->element_count; e++) {
    int32_t from = element_from[e];
    bool fits = from < 0 ? -1 - from < components : from < old->mesh->element_count;
    if (!fits)
      BW_TRY(bw_fail(context, BW_INVALID, "element %d comes from %d, which does not exist", e + 1,
                     from + 1));
    label[e] = from < 0 ? component_subdomain[-1 - from] : old->element_subdomain[from];
  }
done:
  bw_free(component_subdomain);
  return status;
}

/* ---- what moves the nodes -------------------------------------------------------------------- */

/* The part of an influence list that moves one node. */
typedef struct influences {
  int64_t count;
  const int32_t *bone;
  const double *weight;
} influences;

static const double whole = 1;

static influences of_node(const bw_subdomains *d, int32_t i) {
  int64_t first = d->influence_start[i];
  return (influences){d->influence_start[i + 1] - first, d->influence_bone + first,
                      d->influence_weight + first};
}

/* Kept nodes as before; new ones as their Laplace solve says, or in a subdomain of one bone by
 * that bone. */
static influences of_refilled(const bw_subdomains *old, const bw_subdomains *d,
                              const int32_t *node_from, int32_t i) {
  if (node_from[i] >= 0)
    return of_node(old, node_from[i]);
  influences found = of_node(d, i);
  int32_t subdomain = d->node_subdomain[i], first = old->bone_start[subdomain];
  if (found.count > 0 && old->bone_start[subdomain + 1] - first == 1)
    found = (influences){1, old->bone + first, &whole};
  return found;
}

static bw_status merge_influences(bw_context *context, const bw_subdomains *old, bw_subdomains *d,
                                  const int32_t *node_from) {
  int32_t nodes = d->mesh->node_count;
  int64_t *start = BW_NEW(context, int64_t, (int64_t)nodes + 1);
  int32_t *bone = NULL;
  double *weight = NULL;
  if (!start)
    return BW_MEMORY;
  start[0] = 0;
  for (int32_t i = 0; i < nodes; i++)
    start[i + 1] = start[i] + of_refilled(old, d, node_from, i).count;
  bone = BW_NEW(context, int32_t, start[nodes]);
  weight = BW_NEW(context, double, start[nodes]);
  if (!bone || !weight) {
    bw_free(start);
    bw_free(bone);
    bw_free(weight);
    return BW_MEMORY;
  }
  for (int32_t i = 0; i < nodes; i++) {
    influences of = of_refilled(old, d, node_from, i);
    for (int64_t k = 0; k < of.count; k++) {
      bone[start[i] + k] = of.bone[k];
      weight[start[i] + k] = of.weight[k];
    }
  }
  bw_free(d->influence_start);
  bw_free(d->influence_bone);
  bw_free(d->influence_weight);
  d->influence_start = start;
  d->influence_bone = bone;
  d->influence_weight = weight;
  return BW_OK;
}

/* The bones that the subdomains follow are those from before. */
static bw_status copy_bones(bw_context *context, const bw_subdomains *old, bw_subdomains *d) {
  int32_t total = old->bone_start[old->count];
  int32_t *bone = BW_NEW(context, int32_t, total);
  if (!bone)
    return BW_MEMORY;
  memcpy(bone, old->bone, (size_t)total * sizeof *bone);
  memcpy(d->bone_start, old->bone_start, ((size_t)old->count + 1) * sizeof *d->bone_start);
  bw_free(d->bone);
  d->bone = bone;
  return BW_OK;
}

/* ---- where the nodes are at rest ------------------------------------------------------------- */

/* x = the place that the blended map takes to `posed`. */
static bw_status pull_back(bw_context *context, bw_subdomains *d, const double *map, int32_t i,
                           const double posed[3], double x[3]) {
  double blended[12] = {0}, linear[9], inverse[9], shifted[3];
  influences of = of_node(d, i);
  for (int64_t k = 0; k < of.count; k++)
    for (int j = 0; j < 12; j++)
      blended[j] += of.weight[k] * map[12 * (size_t)of.bone[k] + (size_t)j];
  for (int r = 0; r < 3; r++) {
    memcpy(linear + 3 * r, blended + 4 * r, 3 * sizeof(double));
    shifted[r] = posed[r] - blended[4 * r + 3];
  }
  double determinant = bw_inverse3(linear, inverse), size = 0;
  for (int j = 0; j < 9; j++)
    size = fmax(size, fabs(linear[j]));
  if (!(fabs(determinant) > 1e-9 * size * size * size)) {
    bw_fail(context, BW_GEOMETRY,
            "the relative rotation of the bones of subdomain %d is so large that their blend is "
            "singular at (%g, %g, %g): undo the edit or make it smaller",
            d->node_subdomain[i] + 1, posed[0], posed[1], posed[2]);
    bw_detail_number(context, "subdomain", d->node_subdomain[i] + 1);
    return BW_GEOMETRY;
  }
  for (int r = 0; r < 3; r++)
    x[r] = bw_dot(inverse + 3 * r, shifted);
  return BW_OK;
}

static bw_status rest_places(bw_context *context, const bw_subdomains *old, bw_subdomains *d,
                             const double *map, const int32_t *node_from, double *rest) {
  const bw_mesh *mesh = d->mesh;
  for (int32_t i = 0; i < mesh->node_count; i++) {
    double *x = rest + 3 * (size_t)i;
    const double *posed = mesh->node + 3 * (size_t)i;
    bw_status status = BW_OK;
    if (node_from[i] >= 0)
      memcpy(x, old->mesh->node + 3 * (size_t)node_from[i], 3 * sizeof *x);
    else if (d->influence_start[i + 1] > d->influence_start[i])
      status = pull_back(context, d, map, i, posed, x);
    if (status != BW_OK)
      return status;
  }
  if (mesh->order == 2)
    for (int32_t e = 0; e < mesh->element_count; e++)
      for (int k = 0; k < 6; k++) {
        const int32_t *node = bwi_nodes_of(mesh, e);
        if (node_from[node[4 + k]] >= 0)
          continue;
        const double *a = rest + 3 * (size_t)node[bw_tet_edge[k][0]];
        const double *b = rest + 3 * (size_t)node[bw_tet_edge[k][1]];
        for (int j = 0; j < 3; j++)
          rest[3 * (size_t)node[4 + k] + (size_t)j] = (a[j] + b[j]) / 2;
      }
  return BW_OK;
}

/* A shape whose blended map folds over is what refilling is for; elements between the places that
 * the map's inverse gives may then be inverted. So this mesh is made from the posed one, whose
 * elements are sound, and carries positions; only meshes posed from it are checked. */
static bw_status transfer_shapes(bw_context *context, bw_subdomains *d, const double *rest) {
  bw_mesh *carrier = NULL;
  bw_status status = bw_mesh_moved(context, d->mesh, d->mesh->node, &carrier);
  if (status != BW_OK)
    return status;
  memcpy(carrier->node, rest, 3 * (size_t)carrier->node_count * sizeof *rest);
  bw_release(d->mesh);
  d->mesh = carrier;
  return BW_OK;
}

/* ---- the whole ------------------------------------------------------------------------------- */

static bw_status check_numbers(bw_context *context, const bw_subdomains *old, const bw_mesh *mesh,
                               const int32_t *node_from) {
  if (mesh->order != old->mesh->order)
    return bw_fail(context, BW_INVALID, "the refilled mesh is of order %d, not %d", mesh->order,
                   old->mesh->order);
  for (int32_t i = 0; i < mesh->node_count; i++)
    if (node_from[i] < -1 || node_from[i] >= old->mesh->node_count)
      return bw_fail(context, BW_INVALID, "node %d comes from %d, which does not exist", i + 1,
                     node_from[i] + 1);
  return BW_OK;
}

bw_status bw_subdomains_refilled(bw_context *context, const bw_subdomains *subdomains,
                                 const double *map, const uint8_t *replace, const bw_mesh *mesh,
                                 const int32_t *node_from, const int32_t *element_from,
                                 bw_subdomains **refilled) {
  bw_subdomains *d = NULL;
  bw_status status = BW_OK;
  int32_t *label = BW_NEW(context, int32_t, mesh->element_count);
  double *rest = BW_NEW(context, double, 3 * (int64_t)mesh->node_count);
  BW_TRY_MEMORY(label && rest);
  BW_TRY(check_numbers(context, subdomains, mesh, node_from));
  BW_TRY(make_labels(context, subdomains, mesh, replace, element_from, label));
  BW_TRY(bw_subdomains_from_labels(context, mesh, subdomains->skeleton, subdomains->count,
                                   subdomains->bone_of, label, &d));
  BW_TRY(merge_influences(context, subdomains, d, node_from));
  BW_TRY(copy_bones(context, subdomains, d));
  /* what moves the nodes is not what they were made with */
  BW_TRY(bwi_stiffness_subdomains_create(context, d));
  BW_TRY(rest_places(context, subdomains, d, map, node_from, rest));
  BW_TRY(transfer_shapes(context, d, rest));
  *refilled = d;
  d = NULL;
done:
  bw_release(d);
  bw_free(rest);
  bw_free(label);
  return status;
}
