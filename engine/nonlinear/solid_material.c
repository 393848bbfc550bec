/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* Materials of elements, point by point, and material tables of them. */
#include "barwright/nonlinear.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

const char *bw_law_word(bw_law law) {
  static const char *const word[BW_LAWS] = {"neo_hookean", "st_venant_kirchhoff", "corotated",
                                            "fixed_corotated"};
  return (unsigned)law < BW_LAWS ? word[law] : "?";
}

static void destroy(void *object) {
  bw_solid_material *m = (bw_solid_material *)object;
  bw_release(m->rule);
  bw_free(m->law);
  bw_free(m->mu);
  bw_free(m->lambda);
  bw_free(m->fibre_stiffness);
  bw_free(m->fibre);
  bw_free(m->empty);
  bw_free(m);
}

static size_t bytes(const void *object) {
  const bw_solid_material *m = (const bw_solid_material *)object;
  return sizeof *m +
         (size_t)m->rule->count * (17 + 32 * (size_t)(m->fibre_count > 0 ? m->fibre_count : 0));
}

static const bw_kind material_kind = {"solid material", destroy, bytes};

#define EMPTY_PART 2e-3

/* Which points stand for void: what metamaterials put where a block has none. */
static bw_status find_empty(bw_context *context, bw_solid_material *m) {
  double max = 0;
  int32_t count = 0;
  for (int32_t p = 0; p < m->rule->count; p++)
    max = fmax(max, m->mu[p]);
  for (int pass = 0; pass < 2; pass++) {
    for (int32_t p = 0; p < m->rule->count; p++) {
      bool empty = m->law[p] == BW_ST_VENANT_KIRCHHOFF && m->mu[p] < EMPTY_PART * max;
      if (pass == 0)
        count += empty;
      else
        m->empty[p] = empty;
    }
    if (count == 0)
      return BW_OK;
    if (pass == 0) {
      m->empty = BW_NEW(context, uint8_t, m->rule->count);
      if (!m->empty)
        return BW_MEMORY;
    }
  }
  return BW_OK;
}

/* Constants of one point: finite, and not below what keeps the energy bounded. */
static bw_status check_point(bw_context *context, const char *name, int32_t point, int law,
                             double mu, double lambda) {
  if (law < 0 || law >= BW_LAWS)
    return bw_fail(context, BW_INVALID, "material %s, point %d: there is no law %d", name,
                   (int)point + 1, law);
  if (!isfinite(mu) || !isfinite(lambda) || mu < 0 || 3 * lambda + 2 * mu < 0)
    return bw_fail(context, BW_INVALID,
                   "material %s, point %d: mu = %g Pa, lambda = %g Pa; both must be finite, mu not "
                   "negative, and the bulk modulus lambda + 2 mu / 3 not either",
                   name, (int)point + 1, mu, lambda);
  return BW_OK;
}

bw_status bw_solid_material_points(bw_context *context, const char *name, const bw_rule *rule,
                                   double density, const uint8_t *law, const double *mu,
                                   const double *lambda, int fibre_count,
                                   const double *fibre_stiffness, const double *fibre,
                                   bw_solid_material **out) {
  bw_status status = BW_OK;
  bw_solid_material *m = NULL;
  size_t n = (size_t)rule->count, f = (size_t)(fibre_count > 0 ? fibre_count : 0);
  if (fibre_count < 0 || fibre_count > 3)
    return bw_fail(context, BW_INVALID, "material %s has %d fibres at a point; 0 to 3", name,
                   fibre_count);
  if (!isfinite(density) || density < 0)
    return bw_fail(context, BW_INVALID, "material %s: density is %g kg/m3; 0 when not known", name,
                   density);
  for (int32_t p = 0; p < rule->count; p++)
    BW_TRY(check_point(context, name, p, law[p], mu[p], lambda[p]));
  for (size_t k = 0; k < n * f; k++) {
    double length = bw_norm(fibre + 3 * k);
    if (!isfinite(fibre_stiffness[k]) || fibre_stiffness[k] < 0 || !(fabs(length - 1) < 1e-6))
      return bw_fail(context, BW_INVALID,
                     "material %s, point %d: a fibre of stiffness %g Pa and length %g; it must not "
                     "be negative, and the direction of unit length",
                     name, (int)(k / f) + 1, fibre_stiffness[k], length);
  }
  m = BW_NEW0(context, bw_solid_material, 1);
  if (!m)
    return BW_MEMORY;
  bw_object_init(m, &material_kind);
  m->rule = bw_retain(rule);
  snprintf(m->name, sizeof m->name, "%s", name);
  m->density = density;
  m->fibre_count = fibre_count;
  m->law = BW_NEW(context, uint8_t, n);
  m->mu = BW_NEW(context, double, n);
  m->lambda = BW_NEW(context, double, n);
  m->fibre_stiffness = BW_NEW(context, double, n *f);
  m->fibre = BW_NEW(context, double, 3 * n * f);
  BW_TRY_MEMORY(m->law && m->mu && m->lambda && m->fibre_stiffness && m->fibre);
  memcpy(m->law, law, n);
  memcpy(m->mu, mu, n * sizeof *mu);
  memcpy(m->lambda, lambda, n * sizeof *lambda);
  if (f) {
    memcpy(m->fibre_stiffness, fibre_stiffness, n * f * sizeof *fibre);
    memcpy(m->fibre, fibre, 3 * n * f * sizeof *fibre);
  }
  m->uniform = fibre_count == 0;
  for (size_t p = 1; p < n; p++)
    m->uniform = m->uniform && law[p] == law[0] && mu[p] == mu[0] && lambda[p] == lambda[0];
  BW_TRY(find_empty(context, m));
  *out = m;
  m = NULL;
done:
  bw_release(m);
  return status;
}

/* Constants from Young's modulus and Poisson's ratio, or BW_INVALID. */
static bw_status lame(bw_context *context, const char *name, double young, double poisson,
                      double *mu, double *lambda) {
  if (!isfinite(young) || !(young > 0))
    return bw_fail(context, BW_INVALID,
                   "material %s: Young's modulus is %g Pa; it must be positive (1e6 for rubber)",
                   name, young);
  if (!(poisson > -1 && poisson < 0.5))
    return bw_fail(context, BW_INVALID,
                   "material %s: Poisson's ratio is %g; it must lie above -1 and below 0.5", name,
                   poisson);
  *mu = young / (2 * (1 + poisson));
  *lambda = young * poisson / ((1 + poisson) * (1 - 2 * poisson));
  return BW_OK;
}

bw_status bw_solid_material_create(bw_context *context, const char *name, bw_law law, double young,
                                   double poisson, double density, bw_solid_material **material) {
  bw_status status = BW_OK;
  bw_rule *rule = NULL;
  uint8_t laws[8];
  double mu[8], lambda[8];
  name = name && *name ? name : bw_law_word(law);
  BW_TRY(lame(context, name, young, poisson, mu, lambda));
  for (int p = 0; p < 8; p++) {
    laws[p] = (uint8_t)law;
    mu[p] = mu[0];
    lambda[p] = lambda[0];
  }
  BW_TRY(bw_rule_create(context, 0, &rule));
  BW_TRY(bw_solid_material_points(context, name, rule, density, laws, mu, lambda, 0, NULL, NULL,
                                  material));
done:
  bw_release(rule);
  return status;
}

bw_status bw_solid_material_b_bar(bw_context *context, const char *name, bw_law law, double young,
                                  double poisson, double density, bw_solid_material **material) {
  bw_status status = BW_OK;
  bw_rule *rule = NULL;
  uint8_t laws[16];
  double mu[16], lambda[16], whole[2] = {0, 0};
  if (!(poisson > 0))
    return bw_solid_material_create(context, name, law, young, poisson, density, material);
  name = name && *name ? name : bw_law_word(law);
  BW_TRY(lame(context, name, young, poisson, &whole[0], &whole[1]));
  for (int p = 0; p < 16; p++) { /* half of the weight is at either place */
    laws[p] = (uint8_t)law;
    mu[p] = p < 8 ? 2 * whole[0] : 0;
    lambda[p] = p < 8 ? 0 : 2 * whole[1];
  }
  BW_TRY(bw_rule_create_selective(context, &rule));
  BW_TRY(bw_solid_material_points(context, name, rule, density, laws, mu, lambda, 0, NULL, NULL,
                                  material));
  (*material)->b_bar = true;
done:
  bw_release(rule);
  return status;
}

void bw_solid_material_constants(const bw_solid_material *m, double *mu, double *lambda) {
  *mu = m->b_bar ? m->mu[0] / 2 : m->mu[0];
  *lambda = m->b_bar ? m->lambda[m->rule->count - 1] / 2 : m->lambda[0];
}

static void destroy_material_table(void *object) {
  bw_material_table *material_table = (bw_material_table *)object;
  for (int32_t i = 0; material_table->material && i < material_table->count; i++)
    bw_release(material_table->material[i]);
  bw_free((void *)material_table->material);
  bw_free(material_table);
}

static size_t bytes_of_material_table(const void *object) {
  const bw_material_table *material_table = (const bw_material_table *)object;
  return sizeof *material_table + sizeof(void *) * (size_t)material_table->count;
}

static const bw_kind material_table_kind = {"material table", destroy_material_table,
                                            bytes_of_material_table};

bw_status bw_material_table_create(bw_context *context, int32_t count,
                                   const bw_solid_material *const *material,
                                   bw_material_table **out) {
  if (count < 2)
    return bw_fail(context, BW_INVALID, "a material table needs a material beside void");
  bw_material_table *material_table = BW_NEW0(context, bw_material_table, 1);
  if (!material_table)
    return BW_MEMORY;
  bw_object_init(material_table, &material_table_kind);
  material_table->count = count;
  material_table->material = BW_NEW0(context, const bw_solid_material *, count);
  if (!material_table->material) {
    bw_release(material_table);
    return BW_MEMORY;
  }
  for (int32_t i = 1; i < count; i++)
    material_table->material[i] = bw_retain(material[i - 1]);
  *out = material_table;
  return BW_OK;
}
