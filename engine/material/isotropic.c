/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* Isotropic linear elasticity: sigma = lambda tr(eps) I + 2 mu eps, from Young's modulus Y and
 * Poisson's ratio nu: mu = Y / (2 (1 + nu)), lambda = Y nu / ((1 + nu)(1 - 2 nu)). */
#include "material/internal.h"

#include <math.h>

bw_status bw_material_isotropic(bw_context *context, const bw_isotropic *constants,
                                bw_material **material) {
  const bw_isotropic *c = constants;
  const char *name = c->name && *c->name ? c->name : "isotropic";
  double strength[3] = {c->strength, c->strength, c->strength};
  bw_status status = bwi_material_check_common(context, name, c->density, strength, c->toughness);
  if (status != BW_OK)
    return status;
  if (!isfinite(c->young) || !(c->young > 0)) {
    status = bw_fail(context, BW_INVALID,
                     "material %s: Young's modulus is %g Pa; it must be positive (2.1e11 for "
                     "steel)",
                     name, c->young);
    bw_detail_number(context, "young", c->young);
    return status;
  }
  if (!(c->poisson > -1 && c->poisson < 0.5)) {
    status = bw_fail(context, BW_INVALID,
                     "material %s: Poisson's ratio is %g; it must lie above -1 and below 0.5%s",
                     name, c->poisson,
                     c->poisson == 0.5 ? " (an incompressible material needs another kind of "
                                         "element; 0.49 comes close)"
                                       : "");
    bw_detail_number(context, "poisson", c->poisson);
    return status;
  }

  bw_material *m = bwi_material_create(context, name, name);
  if (!m)
    return BW_MEMORY;
  m->isotropic = true;
  m->density = c->density;
  m->toughness = c->toughness;
  m->expansion = c->expansion;
  m->lame_mu = c->young / (2 * (1 + c->poisson));
  m->lame_lambda = c->young * c->poisson / ((1 + c->poisson) * (1 - 2 * c->poisson));
  for (int i = 0; i < 3; i++) {
    m->young[i] = c->young;
    m->poisson[i] = c->poisson;
    m->shear[i] = m->lame_mu;
    m->strength[i] = c->strength;
    for (int j = 0; j < 3; j++) {
      m->elasticity[6 * i + j] = m->lame_lambda + (i == j ? 2 * m->lame_mu : 0);
      m->compliance[6 * i + j] = (i == j ? 1 : -c->poisson) / c->young;
    }
    m->elasticity[7 * (3 + i)] = m->lame_mu;
    m->compliance[7 * (3 + i)] = 1 / m->lame_mu;
  }
  bwi_material_values(m);
  status = bwi_material_check_finite(context, m);
  if (status != BW_OK) {
    bw_release(m);
    return status;
  }
  *material = m;
  return BW_OK;
}
