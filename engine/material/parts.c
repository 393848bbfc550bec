/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* Materials that differ from element to element: several materials in one body, axes that turn with
 * the place, or both. Invariants: parts have no parts themselves, all have one formulation, and
 * part i is unrotated[i] turned by rotation i. */
#include "base/dense.h"
#include "material/internal.h"

#include <math.h>
#include <string.h>

static bw_status check_groups(bw_context *context, const char *what, int32_t element_count,
                              int32_t count, const int32_t *of_element) {
  if (count < 1 || element_count < 0)
    return bw_fail(context, BW_INVALID, "%d %ss of %d elements: at least one %s expected", count,
                   what, element_count, what);
  for (int32_t e = 0; e < element_count; e++)
    if (of_element[e] < 0 || of_element[e] >= count) {
      bw_fail(context, BW_INVALID, "element %d is in %s %d: the %ss are 1 to %d", e + 1, what,
              of_element[e] + 1, what, count);
      bw_detail_number(context, "element", e + 1);
      return BW_INVALID;
    }
  return BW_OK;
}

static bw_material_parts *parts_create(bw_context *context, int32_t element_count, int32_t count) {
  bw_material_parts *p = BW_NEW0(context, bw_material_parts, 1);
  if (!p)
    return NULL;
  p->element_count = element_count;
  p->of_element = BW_NEW(context, int32_t, element_count);
  p->part = BW_NEW0(context, const bw_material *, count);
  p->unrotated = BW_NEW0(context, const bw_material *, count);
  p->rotation = BW_NEW0(context, double, 9 * (int64_t)count);
  if (p->of_element && p->part && p->unrotated && p->rotation) {
    p->count = count;
    return p;
  }
  bwi_material_parts_destroy(p);
  return NULL;
}

/* Part i is `unrotated` turned by a rotation, or as it is where that is NULL. */
static bw_status set_part(bw_context *context, bw_material_parts *p, int32_t i,
                          const bw_material *unrotated, const double *rotation) {
  double *own = p->rotation + 9 * (int64_t)i;
  p->unrotated[i] = (const bw_material *)bw_retain(unrotated);
  if (!rotation) {
    own[0] = own[4] = own[8] = 1;
    p->part[i] = (const bw_material *)bw_retain(unrotated);
    return BW_OK;
  }
  memcpy(own, rotation, 9 * sizeof *own);
  bw_status status = bwi_material_check_rotation(context, "the turn of a group of elements", own);
  bw_material *turned = NULL;
  if (status == BW_OK)
    status = bw_material_rotated(context, unrotated, own, &turned);
  p->part[i] = turned;
  return status;
}

/* a, or 0 where b is another */
static double agreed(double a, double b) {
  return a == b ? a : 0;
}

/* The least of both, 0 where one is not known. */
static double least(double a, double b) {
  return a > 0 && b > 0 ? fmin(a, b) : 0;
}

/* What the parts have in common. */
static void summarise(const bw_material_parts *p, bw_material *m) {
  const bw_material *first = p->unrotated[0];
  for (int32_t i = 1; i < p->count; i++) {
    const bw_material *other = p->unrotated[i];
    if (other == first)
      continue;
    m->isotropic = false;
    m->density = least(m->density, other->density);
    m->toughness = least(m->toughness, other->toughness);
    m->expansion = agreed(m->expansion, other->expansion);
    m->lame_lambda = m->lame_mu = 0;
    memset(m->elasticity, 0, sizeof m->elasticity);
    memset(m->compliance, 0, sizeof m->compliance);
    for (int k = 0; k < 3; k++) {
      m->strength[k] = least(m->strength[k], other->strength[k]);
      m->young[k] = agreed(m->young[k], other->young[k]);
      m->poisson[k] = agreed(m->poisson[k], other->poisson[k]);
      m->shear[k] = agreed(m->shear[k], other->shear[k]);
    }
    size_t length = strlen(m->name), more = strlen(other->name);
    bool met = false; /* the same material in two regions is named once */
    for (int32_t k = 0; k < i; k++)
      met |= strcmp(p->unrotated[k]->name, other->name) == 0;
    if (!met && length + more + 4 < sizeof m->name) {
      memcpy(m->name + length, " + ", 3);
      memcpy(m->name + length + 3, other->name, more + 1);
    }
  }
  if (bw_material_mixed(m))
    bwi_material_values(m);
}

/* A material of complete parts, which it takes over, on failure too. */
static bw_status compose(bw_context *context, bw_material_parts *parts, bw_material **material) {
  bw_material *made = bwi_material_copy(context, parts->unrotated[0]);
  if (!made) {
    bwi_material_parts_destroy(parts);
    return BW_MEMORY;
  }
  made->parts = parts;
  summarise(parts, made);
  *material = made;
  return BW_OK;
}

bw_status bw_material_by_element(bw_context *context, int32_t element_count, int32_t part_count,
                                 const int32_t *of_element, const bw_material *const *part,
                                 bw_material **material) {
  bw_status status = BW_OK;
  bw_material_parts *p = NULL;
  bool same = true;
  BW_TRY(check_groups(context, "part", element_count, part_count, of_element));
  for (int32_t i = 0; i < part_count; i++) {
    if (part[i]->parts)
      return bw_fail(context, BW_INVALID,
                     "material %s differs from element to element itself: give its parts",
                     part[i]->name);
    if (part[i]->formulation != part[0]->formulation)
      return bw_fail(context, BW_INVALID,
                     "materials %s and %s are of different formulations: a body has one",
                     part[0]->name, part[i]->name);
    same &= part[i] == part[0];
  }
  if (same) {
    *material = (bw_material *)bw_retain(part[0]);
    return BW_OK;
  }
  p = parts_create(context, element_count, part_count);
  BW_TRY_MEMORY(p);
  memcpy(p->of_element, of_element, (size_t)element_count * sizeof *of_element);
  for (int32_t i = 0; i < part_count; i++)
    BW_TRY(set_part(context, p, i, part[i], NULL));
  status = compose(context, p, material);
  p = NULL;
done:
  bwi_material_parts_destroy(p);
  return status;
}

/* The same parts with another list, which the material takes over, on failure too. */
static bw_status with_list(bw_context *context, const bw_material_parts *from,
                           int32_t element_count, int32_t *of_element, bw_material **material) {
  bw_material_parts *p = parts_create(context, 0, from->count);
  if (!p) {
    bw_free(of_element);
    return BW_MEMORY;
  }
  bw_free(p->of_element);
  p->of_element = of_element;
  p->element_count = element_count;
  memcpy(p->rotation, from->rotation, 9 * (size_t)from->count * sizeof *p->rotation);
  for (int32_t i = 0; i < from->count; i++) {
    p->part[i] = (const bw_material *)bw_retain(from->part[i]);
    p->unrotated[i] = (const bw_material *)bw_retain(from->unrotated[i]);
  }
  return compose(context, p, material);
}

bw_status bw_material_carried(bw_context *context, const bw_material *material,
                              int32_t element_count, const int32_t *element_from,
                              bw_material **carried) {
  const bw_material_parts *from = material->parts;
  if (!from) {
    *carried = (bw_material *)bw_retain(material);
    return BW_OK;
  }
  bw_status status =
      check_groups(context, "element before", element_count, from->element_count, element_from);
  if (status != BW_OK)
    return status;
  int32_t *of_element = BW_NEW(context, int32_t, element_count);
  if (!of_element)
    return BW_MEMORY;
  for (int32_t e = 0; e < element_count; e++)
    of_element[e] = from->of_element[element_from[e]];
  return with_list(context, from, element_count, of_element, carried);
}

/* Gives every pair of a part and a group that is met a number, by elements: pair (index, part_count
 * x group_count), -1 where it is not met. */
static int32_t number_pairs(const bw_material *material, int32_t element_count, int32_t group_count,
                            const int32_t *of_element, int32_t *pair) {
  int32_t count = 0;
  for (int64_t k = 0; k < (int64_t)bw_material_part_count(material) * group_count; k++)
    pair[k] = -1;
  for (int32_t e = 0; e < element_count; e++) {
    int64_t part = material->parts ? material->parts->of_element[e] : 0;
    int32_t *number = pair + part * group_count + of_element[e];
    if (*number < 0)
      *number = count++;
  }
  return count;
}

static bool all_isotropic(const bw_material *material) {
  for (int32_t i = 0; i < bw_material_part_count(material); i++)
    if (!bw_material_part(material, i)->isotropic)
      return false;
  return true;
}

bw_status bw_material_rotated_by_element(bw_context *context, const bw_material *material,
                                         int32_t element_count, int32_t group_count,
                                         const int32_t *of_element, const double *rotation,
                                         bw_material **rotated) {
  static const double identity[9] = {1, 0, 0, 0, 1, 0, 0, 0, 1};
  bw_status status = BW_OK;
  const bw_material_parts *from = material->parts;
  bw_material_parts *p = NULL;
  int32_t *pair = NULL;
  BW_TRY(check_groups(context, "group", element_count, group_count, of_element));
  BW_TRY(bw_material_fits(context, material, element_count));
  if (all_isotropic(material)) {
    *rotated = (bw_material *)bw_retain(material);
    return BW_OK;
  }
  int64_t pairs = (int64_t)bw_material_part_count(material) * group_count;
  pair = BW_NEW(context, int32_t, pairs);
  BW_TRY_MEMORY(pair);
  int32_t count = number_pairs(material, element_count, group_count, of_element, pair);
  p = parts_create(context, element_count, count);
  BW_TRY_MEMORY(p);
  for (int64_t k = 0; k < pairs; k++) {
    int64_t part = k / group_count, group = k % group_count;
    double both[9];
    if (pair[k] < 0)
      continue;
    const bw_material *unrotated = from ? from->unrotated[part] : material;
    const double *before = from ? from->rotation + 9 * part : identity;
    double turn[9];
    memcpy(turn, rotation + 9 * group, sizeof turn);
    BW_TRY(bwi_material_check_rotation(context, "the turn of a group of elements", turn));
    bwi_multiply(3, 3, 3, turn, before, both);
    BW_TRY(set_part(context, p, pair[k], unrotated, unrotated->isotropic ? NULL : both));
  }
  for (int32_t e = 0; e < element_count; e++)
    p->of_element[e] =
        pair[(int64_t)(from ? from->of_element[e] : 0) * group_count + of_element[e]];
  status = compose(context, p, rotated);
  p = NULL;
done:
  bw_free(pair);
  bwi_material_parts_destroy(p);
  return status;
}

/* The same material with its moduli multiplied. */
static bw_material *stiffened(bw_context *context, const bw_material *material, double factor) {
  bw_material *m = bwi_material_copy(context, material);
  if (!m)
    return NULL;
  m->lame_lambda *= factor;
  m->lame_mu *= factor;
  for (int k = 0; k < 36; k++) {
    m->elasticity[k] *= factor;
    m->compliance[k] /= factor;
  }
  for (int k = 0; k < 3; k++) {
    m->young[k] *= factor;
    m->shear[k] *= factor;
  }
  bwi_material_values(m);
  return m;
}

bw_status bw_material_stiffened(bw_context *context, const bw_material *material,
                                int32_t element_count, int32_t group_count,
                                const int32_t *of_element, const double *factor,
                                bw_material **result) {
  bw_status status = BW_OK;
  bw_material_parts *p = NULL;
  int32_t *pair = NULL;
  BW_TRY(check_groups(context, "group", element_count, group_count, of_element));
  BW_TRY(bw_material_fits(context, material, element_count));
  for (int32_t g = 0; g < group_count; g++)
    if (!(factor[g] > 0 && factor[g] < INFINITY))
      return bw_fail(context, BW_INVALID,
                     "the factor of group %d is %g; it must be above 0, and finite", g + 1,
                     factor[g]);
  int64_t pairs = (int64_t)bw_material_part_count(material) * group_count;
  pair = BW_NEW(context, int32_t, pairs);
  BW_TRY_MEMORY(pair);
  p = parts_create(context, element_count,
                   number_pairs(material, element_count, group_count, of_element, pair));
  BW_TRY_MEMORY(p);
  for (int64_t k = 0; k < pairs; k++) {
    if (pair[k] < 0)
      continue;
    const bw_material *part = bw_material_part(material, (int32_t)(k / group_count));
    bw_material *own = stiffened(context, part, factor[k % group_count]);
    BW_TRY_MEMORY(own);
    status = set_part(context, p, pair[k], own, NULL);
    bw_release(own);
    BW_TRY(status);
  }
  for (int32_t e = 0; e < element_count; e++)
    p->of_element[e] =
        pair[(material->parts ? material->parts->of_element[e] : 0) * (int64_t)group_count +
             of_element[e]];
  status = compose(context, p, result);
  p = NULL;
done:
  bw_free(pair);
  bwi_material_parts_destroy(p);
  return status;
}

/* A material with parts of which every one becomes another: by a rotation of the whole, or by a
 * formulation. */
static bw_status each_part(bw_context *context, const bw_material_parts *from,
                           const double *rotation, const bw_formulation *formulation,
                           bw_material **out) {
  bw_status status = BW_OK;
  bw_material *unrotated = NULL;
  bw_material_parts *p = parts_create(context, from->element_count, from->count);
  BW_TRY_MEMORY(p);
  memcpy(p->of_element, from->of_element, (size_t)from->element_count * sizeof *p->of_element);
  for (int32_t i = 0; i < from->count; i++) {
    const double *before = from->rotation + 9 * (int64_t)i;
    double both[9];
    int32_t same = 0; /* parts of one material before stay parts of one material */
    while (same < i && from->unrotated[same] != from->unrotated[i])
      same++;
    if (rotation)
      bwi_multiply(3, 3, 3, rotation, before, both);
    else
      memcpy(both, before, sizeof both);
    if (same < i || !formulation)
      unrotated = (bw_material *)bw_retain(same < i ? p->unrotated[same] : from->unrotated[i]);
    else
      BW_TRY(bw_material_formulated(context, from->unrotated[i], *formulation, &unrotated));
    bool turned = rotation || from->part[i] != from->unrotated[i];
    BW_TRY(set_part(context, p, i, unrotated, turned ? both : NULL));
    bw_release(unrotated);
    unrotated = NULL;
  }
  status = compose(context, p, out);
  p = NULL;
done:
  bw_release(unrotated);
  bwi_material_parts_destroy(p);
  return status;
}

bw_status bw_material_rotated(bw_context *context, const bw_material *material,
                              const double rotation[9], bw_material **rotated) {
  bw_status status = BW_OK;
  double r[9];
  memcpy(r, rotation, sizeof r);
  BW_TRY(bwi_material_check_rotation(context, "the rotation of a material", r));
  if (material->parts)
    return each_part(context, material->parts, r, NULL, rotated);
  bw_material *made = bwi_material_copy(context, material);
  if (!made)
    return BW_MEMORY;
  bwi_material_rotate_axes(material->axes, r, made->axes);
  if (!made->isotropic)
    status = bwi_material_orthotropic_matrices(context, made);
  if (status != BW_OK) {
    bw_free(made);
    return status;
  }
  *rotated = made;
done:
  return status;
}

bw_status bw_material_formulated(bw_context *context, const bw_material *material,
                                 bw_formulation formulation, bw_material **formulated) {
  if (material->parts)
    return each_part(context, material->parts, NULL, &formulation, formulated);
  bw_material *made = bwi_material_copy(context, material);
  if (!made)
    return BW_MEMORY;
  made->formulation = formulation;
  *formulated = made;
  return BW_OK;
}

bw_status bw_material_fits(bw_context *context, const bw_material *material,
                           int32_t element_count) {
  if (!material->parts || material->parts->element_count == element_count)
    return BW_OK;
  return bw_fail(context, BW_INVALID,
                 "material %s is given for each of %d elements; the mesh has %d", material->name,
                 material->parts->element_count, element_count);
}
