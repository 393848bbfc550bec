/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* Orthotropic linear elasticity: nine constants and a rotation.
 *
 * In the material axes the compliance is
 *     S_ii = 1/Y_i,   S_ij = -nu_ij/Y_i = -nu_ji/Y_j,   S_44 = 1/G23, S_55 = 1/G31, S_66 = 1/G12,
 * where nu_ij is the contraction along j for a load along i. It must be positive definite; its
 * inverse, rotated from the material axes to the global ones, is the elasticity. */
#include "base/dense.h"
#include "material/internal.h"

#include <math.h>
#include <string.h>

/* The pairs in the order of the constants: 23 31 12. */
static const int pair[3][2] = {{1, 2}, {2, 0}, {0, 1}};

/* The inverse of the 3x3 normal part, which is scaled to a unit diagonal so that the answer does
 * not depend on how different the moduli are. False when it is not positive definite. */
static bool normal_compliance_inverse(const bw_material *m, double inverse[9]) {
  double scale[3], a[9] = {1, 0, 0, 0, 1, 0, 0, 0, 1};
  for (int i = 0; i < 3; i++)
    scale[i] = sqrt(m->young[i]);
  for (int p = 0; p < 3; p++) {
    int i = pair[p][0], j = pair[p][1];
    a[3 * i + j] = a[3 * j + i] = -m->poisson[p] / m->young[i] * scale[i] * scale[j];
  }
  if (!bwi_cholesky(3, a, 1e-12))
    return false;
  for (int c = 0; c < 3; c++) {
    double column[3] = {c == 0, c == 1, c == 2};
    bwi_lower_solve(3, a, column);
    bwi_upper_solve(3, a, column);
    for (int i = 0; i < 3; i++)
      inverse[3 * i + c] = column[i] * scale[i] * scale[c];
  }
  for (int i = 0; i < 3; i++)
    for (int j = 0; j < i; j++)
      inverse[3 * i + j] = inverse[3 * j + i];
  return true;
}

/* A tensor 3x3 from its six numbers; shears of strains are halved. */
static void unpack(const double v[6], double shear, double t[3][3]) {
  for (int i = 0; i < 3; i++)
    t[i][i] = v[i];
  for (int p = 0; p < 3; p++)
    t[pair[p][0]][pair[p][1]] = t[pair[p][1]][pair[p][0]] = shear * v[3 + p];
}

/* out = a t a^T, or a^T t a when transposed. */
static void rotate(const double a[9], bool transposed, double t[3][3], double out[3][3]) {
  for (int i = 0; i < 3; i++)
    for (int j = 0; j < 3; j++) {
      double sum = 0;
      for (int k = 0; k < 3; k++)
        for (int l = 0; l < 3; l++)
          sum += (transposed ? a[3 * k + i] * a[3 * l + j] : a[3 * i + k] * a[3 * j + l]) * t[k][l];
      out[i][j] = sum;
    }
}

/* A 6x6 matrix given in material axes, in global ones: column by column, unit tensor in, rotated to
 * the material axes, the law, and rotated back. `in` and `out` are the factors between the shear
 * numbers and the tensor's components on either side. */
static void to_global(const double axes[9], const double local[36], double in, double out,
                      double global[36]) {
  for (int c = 0; c < 6; c++) {
    double unit[6] = {0}, t[3][3], rotated[3][3], v[6], w[6];
    unit[c] = 1;
    unpack(unit, in, t);
    rotate(axes, false, t, rotated);
    for (int i = 0; i < 3; i++)
      v[i] = rotated[i][i];
    for (int p = 0; p < 3; p++)
      v[3 + p] = rotated[pair[p][0]][pair[p][1]] / in;
    for (int i = 0; i < 6; i++) {
      w[i] = 0;
      for (int j = 0; j < 6; j++)
        w[i] += local[6 * i + j] * v[j];
    }
    unpack(w, out, t);
    rotate(axes, true, t, rotated);
    for (int i = 0; i < 3; i++)
      global[6 * i + c] = rotated[i][i];
    for (int p = 0; p < 3; p++)
      global[6 * (3 + p) + c] = rotated[pair[p][0]][pair[p][1]] / out;
  }
  for (int i = 0; i < 6; i++)
    for (int j = 0; j < i; j++)
      global[6 * i + j] = global[6 * j + i] = 0.5 * (global[6 * i + j] + global[6 * j + i]);
}

bw_status bwi_material_orthotropic_matrices(bw_context *context, bw_material *m) {
  double inverse[9], stiff[36] = {0}, soft[36] = {0};
  if (!normal_compliance_inverse(m, inverse)) {
    bw_status status = bw_fail(
        context, BW_INVALID,
        "material %s: the constants Y = (%g, %g, %g) Pa, nu23 = %g, nu31 = %g, nu12 = %g do not "
        "belong to a stable material (the compliance is not positive definite)",
        m->name, m->young[0], m->young[1], m->young[2], m->poisson[0], m->poisson[1],
        m->poisson[2]);
    for (int p = 0; p < 3; p++) {
      int i = pair[p][0], j = pair[p][1];
      if (!(m->poisson[p] * m->poisson[p] < m->young[i] / m->young[j])) {
        double bound = sqrt(m->young[i] / m->young[j]);
        status = bw_fail(context, BW_INVALID,
                         "material %s: nu%d%d = %g does not fit Y%d = %g Pa and Y%d = %g Pa: it "
                         "must be smaller than sqrt(Y%d/Y%d) = %g",
                         m->name, i + 1, j + 1, m->poisson[p], i + 1, m->young[i], j + 1,
                         m->young[j], i + 1, j + 1, bound);
        bw_detail_number(context, "poisson", m->poisson[p]);
        bw_detail_number(context, "bound", bound);
        break;
      }
    }
    return status;
  }
  for (int i = 0; i < 3; i++) {
    for (int j = 0; j < 3; j++)
      stiff[6 * i + j] = inverse[3 * i + j];
    soft[7 * i] = 1 / m->young[i];
    stiff[7 * (3 + i)] = m->shear[i];
    soft[7 * (3 + i)] = 1 / m->shear[i];
  }
  for (int p = 0; p < 3; p++) {
    int i = pair[p][0], j = pair[p][1];
    soft[6 * i + j] = soft[6 * j + i] = -m->poisson[p] / m->young[i];
  }
  to_global(m->axes, stiff, 0.5, 1, m->elasticity);
  to_global(m->axes, soft, 1, 0.5, m->compliance);
  return bwi_material_check_finite(context, m);
}

/* nu_ij from what is given: the number itself, or nu_ji by the reciprocal relation. */
static bw_status reciprocal(bw_context *context, const char *name, const bw_orthotropic *c, int p,
                            double *poisson) {
  int i = pair[p][0], j = pair[p][1];
  double forward = c->poisson[p], backward = c->poisson_t[p];
  if (!isfinite(forward) || !isfinite(backward)) {
    bw_status status = bw_fail(context, BW_INVALID,
                               "material %s: Poisson's ratios nu%d%d = %g, nu%d%d = %g are not "
                               "finite numbers",
                               name, i + 1, j + 1, forward, j + 1, i + 1, backward);
    return status;
  }
  double derived = backward * c->young[i] / c->young[j];
  if (forward == 0) {
    *poisson = derived;
    return BW_OK;
  }
  if (backward != 0 && !(fabs(forward - derived) <= 1e-6 * fabs(forward))) {
    bw_status status =
        bw_fail(context, BW_INVALID,
                "material %s: nu%d%d = %g and nu%d%d = %g contradict nu_ij/Y_i = nu_ji/Y_j with "
                "Y%d = %g Pa and Y%d = %g Pa: nu%d%d must be %.9g; give only one of the two",
                name, i + 1, j + 1, forward, j + 1, i + 1, backward, i + 1, c->young[i], j + 1,
                c->young[j], j + 1, i + 1, forward * c->young[j] / c->young[i]);
    bw_detail_number(context, "given", backward);
    bw_detail_number(context, "expected", forward * c->young[j] / c->young[i]);
    return status;
  }
  *poisson = forward;
  return BW_OK;
}

bw_status bw_material_orthotropic(bw_context *context, const bw_orthotropic *constants,
                                  bw_material **material) {
  const bw_orthotropic *c = constants;
  const char *name = c->name && *c->name ? c->name : "orthotropic";
  bw_material *m = NULL;
  bw_status status;
  BW_TRY(bwi_material_check_common(context, name, c->density, c->strength, c->toughness));
  for (int i = 0; i < 3; i++)
    if (!isfinite(c->young[i]) || !(c->young[i] > 0)) {
      status = bw_fail(context, BW_INVALID,
                       "material %s: Young's modulus Y%d is %g Pa; it must be positive", name,
                       i + 1, c->young[i]);
      bw_detail_number(context, "axis", i + 1);
      bw_detail_number(context, "young", c->young[i]);
      goto done;
    }

  m = bwi_material_create(context, name, name);
  if (!m)
    return BW_MEMORY;
  m->density = c->density;
  m->toughness = c->toughness;
  m->expansion = c->expansion;
  memcpy(m->young, c->young, sizeof m->young);
  memcpy(m->strength, c->strength, sizeof m->strength);
  for (int p = 0; p < 3; p++) {
    int i = pair[p][0], j = pair[p][1];
    BW_TRY(reciprocal(context, name, c, p, &m->poisson[p]));
    m->shear[p] = c->shear[p];
    if (m->shear[p] == 0)
      m->shear[p] = 1 / (1 / m->young[i] + 1 / m->young[j] + 2 * m->poisson[p] / m->young[i]);
    if (!isfinite(m->shear[p]) || !(m->shear[p] > 0)) {
      status = bw_fail(context, BW_INVALID,
                       "material %s: the shear modulus G%d%d is %g Pa; it must be positive", name,
                       i + 1, j + 1, m->shear[p]);
      bw_detail_number(context, "shear", m->shear[p]);
      goto done;
    }
  }
  bool given = false;
  for (int k = 0; k < 9; k++)
    given = given || c->axes[k] != 0;
  if (given) {
    char what[80];
    memcpy(m->axes, c->axes, sizeof m->axes);
    memcpy(what, "material ", 9);
    memcpy(what + 9, m->name, sizeof m->name);
    BW_TRY(bwi_material_check_rotation(context, what, m->axes));
  }
  BW_TRY(bwi_material_orthotropic_matrices(context, m));
  bwi_material_values(m);
  *material = m;
  return BW_OK;
done:
  bw_release(m);
  return status;
}
