/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* What all material laws have in common: life, checks, strength by direction, utilisation. */
#include "material/internal.h"

#include <math.h>
#include <string.h>

void bwi_material_parts_destroy(bw_material_parts *parts) {
  if (!parts)
    return;
  for (int32_t i = 0; i < parts->count; i++) {
    bw_release(parts->part[i]);
    bw_release(parts->unrotated[i]);
  }
  bw_free(parts->of_element);
  bw_free(parts->part);
  bw_free(parts->unrotated);
  bw_free(parts->rotation);
  bw_free(parts);
}

static void destroy(void *object) {
  bw_material *material = (bw_material *)object;
  bwi_material_parts_destroy(material->parts);
  bw_free(material);
}

static size_t bytes(const void *object) {
  const bw_material *material = (const bw_material *)object;
  const bw_material_parts *p = material->parts;
  size_t parts = p ? (size_t)p->count : 0, elements = p ? (size_t)p->element_count : 0;
  return sizeof *material + (p ? sizeof *p : 0) + elements * sizeof(int32_t) +
         parts * (sizeof *material + 2 * sizeof material + 9 * sizeof(double));
}

static const bw_kind material_kind = {"material", destroy, bytes};

bw_material *bwi_material_create(bw_context *context, const char *name, const char *fallback) {
  bw_material *material = BW_NEW0(context, bw_material, 1);
  if (!material)
    return NULL;
  bw_object_init(material, &material_kind);
  if (!name || !*name)
    name = fallback;
  size_t length = strlen(name), capacity = sizeof material->name - 1;
  if (length > capacity) {
    length = capacity; /* not in the middle of a UTF-8 character */
    while (length > 0 && ((unsigned char)name[length] & 0xC0) == 0x80)
      length--;
  }
  memcpy(material->name, name, length);
  material->axes[0] = material->axes[4] = material->axes[8] = 1;
  return material;
}

void bwi_material_values(bw_material *material) {
  for (int i = 0; i < 3; i++) {
    material->young_value[i] = (bw_value){material->young[i], 0, NULL};
    material->poisson_value[i] = (bw_value){material->poisson[i], 0, NULL};
    material->strength_value[i] = (bw_value){material->strength[i], 0, NULL};
  }
  material->density_value = (bw_value){material->density, 0, NULL};
  material->toughness_value = (bw_value){material->toughness, 0, NULL};
}

bw_status bwi_material_check_common(bw_context *context, const char *name, double density,
                                    const double strength[3], double toughness) {
  if (!isfinite(density) || density < 0) {
    bw_status status =
        bw_fail(context, BW_INVALID,
                "material %s: the density is %g kg/m3; give a positive number, or 0 when it is "
                "not known",
                name, density);
    bw_detail_number(context, "density", density);
    return status;
  }
  for (int i = 0; i < 3; i++)
    if (!isfinite(strength[i]) || strength[i] < 0) {
      bw_status status =
          bw_fail(context, BW_INVALID,
                  "material %s: the strength along axis %d is %g Pa; give a positive number, or 0 "
                  "when it is not known",
                  name, i + 1, strength[i]);
      bw_detail_number(context, "axis", i + 1);
      bw_detail_number(context, "strength", strength[i]);
      return status;
    }
  if (!isfinite(toughness) || toughness < 0) {
    bw_status status =
        bw_fail(context, BW_INVALID,
                "material %s: the fracture toughness is %g Pa m^0.5; give a positive number, or 0 "
                "when it is not known",
                name, toughness);
    bw_detail_number(context, "toughness", toughness);
    return status;
  }
  return BW_OK;
}

bw_status bwi_material_check_finite(bw_context *context, const bw_material *material) {
  for (int k = 0; k < 36; k++)
    if (!isfinite(material->elasticity[k]) || !isfinite(material->compliance[k]))
      return bw_fail(context, BW_INVALID,
                     "material %s: Y = (%g, %g, %g) Pa with these Poisson's ratios is outside the "
                     "range of double precision; give moduli in Pa",
                     material->name, material->young[0], material->young[1], material->young[2]);
  return BW_OK;
}

bw_status bwi_material_check_rotation(bw_context *context, const char *what, double axes[9]) {
  double worst = 0;
  for (int i = 0; i < 3; i++)
    for (int j = i; j < 3; j++) {
      double off = fabs(bw_dot(axes + 3 * i, axes + 3 * j) - (i == j));
      worst = isnan(off) ? INFINITY : fmax(worst, off);
    }
  double third[3];
  bw_cross(axes, axes + 3, third);
  if (!(worst <= 1e-6) || bw_dot(third, axes + 6) < 0) {
    bw_status status =
        bw_fail(context, BW_INVALID,
                "%s: the three axes (%g, %g, %g), (%g, %g, %g), (%g, %g, %g) must be unit vectors "
                "at right angles, right-handed; they are off by %g%s",
                what, axes[0], axes[1], axes[2], axes[3], axes[4], axes[5], axes[6], axes[7],
                axes[8], worst, worst <= 1e-6 ? " but left-handed" : "");
    bw_detail_number(context, "off", worst);
    return status;
  }
  /* What is left is rounding in the caller's numbers; without it, rotating a material keeps its
   * constants. Exact axes stay exact. */
  if (worst > 1e-15) {
    double length = bw_norm(axes);
    for (int k = 0; k < 3; k++)
      axes[k] /= length;
    double along = bw_dot(axes, axes + 3);
    for (int k = 0; k < 3; k++)
      axes[3 + k] -= along * axes[k];
    length = bw_norm(axes + 3);
    for (int k = 0; k < 3; k++)
      axes[3 + k] /= length;
    bw_cross(axes, axes + 3, axes + 6);
  }
  return BW_OK;
}

bw_material *bwi_material_copy(bw_context *context, const bw_material *material) {
  bw_material *copy = BW_NEW(context, bw_material, 1);
  if (!copy)
    return NULL;
  *copy = *material;
  bw_object_init(copy, &material_kind);
  copy->parts = NULL;
  return copy;
}

double bw_material_bulk(const bw_material *material) {
  const double *s = material->compliance;
  return 1 / (s[0] + s[7] + s[14] + 2 * (s[1] + s[2] + s[8]));
}

double bw_material_mean_shear(const bw_material *material) {
  const double *c = material->elasticity;
  return (c[0] + c[7] + c[14] - (c[1] + c[2] + c[8]) + 3 * (c[21] + c[28] + c[35])) / 15;
}

/* Times the shear modulus: the bulk modulus that quadratic tetrahedra tolerate without locking. */
static const double projected_limit = 3;

double bw_material_projected_bulk(const bw_material *material) {
  if (material->formulation != BW_B_BAR)
    return 0;
  return fmax(0, bw_material_bulk(material) - projected_limit * bw_material_mean_shear(material));
}

void bwi_material_rotate_axes(const double axes[9], const double rotation[9], double rotated[9]) {
  for (int i = 0; i < 3; i++)
    for (int k = 0; k < 3; k++)
      rotated[3 * i + k] = bw_dot(rotation + 3 * k, axes + 3 * i);
}

double bw_material_strength(const bw_material *material, const double direction[3]) {
  double length2 = bw_dot(direction, direction), inverse2 = 0;
  for (int i = 0; i < 3; i++) {
    if (!(material->strength[i] > 0))
      return 0;
    double along = bw_dot(direction, material->axes + 3 * i) / material->strength[i];
    inverse2 += along * along;
  }
  return inverse2 > 0 ? sqrt(length2 / inverse2) : 0;
}

bw_value bw_material_critical_distance_value(const bw_material *material) {
  const double *s = material->strength, K = material->toughness;
  int max = s[1] > s[0] ? 1 : 0;
  max = s[2] > s[max] ? 2 : max;
  if (!(s[max] > 0) || !(K > 0))
    return (bw_value){0};
  double L = K / s[max] * (K / s[max]) / 3.14159265358979323846;
  const bw_value *of_K = &material->toughness_value, *of_s = &material->strength_value[max];
  double scatter = 2 * L * hypot(of_K->scatter / K, of_s->scatter / s[max]);
  return (bw_value){L, scatter,
                    of_K->source ? "(fracture toughness / strength)^2 / pi, by the largest strength"
                                 : NULL};
}

double bw_material_critical_distance(const bw_material *material) {
  return bw_material_critical_distance_value(material).mean;
}

/* The largest 1/s(n)^2 = n . W n, W = sum_i e_i e_i^T / s_i^2, over the unit vectors n spanned by
 * `count` orthonormal rows: the largest eigenvalue of W restricted to them. */
static double largest_inverse_square(const bw_material *material, const double *rows, int count) {
  double w[3][3] = {{0}};
  for (int i = 0; i < 3; i++)
    for (int a = 0; a < count; a++)
      for (int b = 0; b < count; b++)
        w[a][b] += bw_dot(rows + 3 * a, material->axes + 3 * i) *
                   bw_dot(rows + 3 * b, material->axes + 3 * i) /
                   (material->strength[i] * material->strength[i]);
  if (count == 1)
    return w[0][0];
  if (count == 2)
    return 0.5 * (w[0][0] + w[1][1]) + hypot(0.5 * (w[0][0] - w[1][1]), w[0][1]);
  double tensor[6] = {w[0][0], w[1][1], w[2][2], w[1][2], w[2][0], w[0][1]}, values[3];
  bw_eigen3(tensor, values, NULL);
  return values[0];
}

double bw_material_utilisation(const bw_material *material, const double stress[6]) {
  const double *s = material->strength;
  if (!(s[0] > 0 && s[1] > 0 && s[2] > 0))
    return 0;
  double value[3], vector[9];
  if (s[0] == s[1] && s[1] == s[2]) {
    bw_eigen3(stress, value, NULL);
    return fmax(fabs(value[0]), fabs(value[2])) / s[0];
  }
  bw_eigen3(stress, value, vector);
  double equal = 1e-9 * fmax(fabs(value[0]), fabs(value[2])), utilisation = 0;
  for (int i = 0; i < 3;) {
    int count = 1;
    while (i + count < 3 && value[i] - value[i + count] <= equal)
      count++;
    double size = fmax(fabs(value[i]), fabs(value[i + count - 1]));
    double here = size * sqrt(largest_inverse_square(material, vector + 3 * i, count));
    if (here > utilisation)
      utilisation = here;
    i += count;
  }
  return utilisation;
}
