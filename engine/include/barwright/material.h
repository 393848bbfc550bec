/* material: linear elastic laws and a small library of measured materials. */
#ifndef BARWRIGHT_MATERIAL_H
#define BARWRIGHT_MATERIAL_H

#include "barwright/base.h"

#ifdef __cplusplus
extern "C" {
#endif

/* A measured constant, in its own unit. */
typedef struct bw_value {
  double mean, scatter; /* (any) scatter: one standard deviation; 0 when not known */
  const char *source;   /* a static string: where the value comes from; NULL: given by the user */
} bw_value;

/* How displacements enter the strain energy of an element. B-bar: the part of the bulk modulus that
 * locks acts on the mean of the volumetric strain over the element (docs/theory/elements.md). */
typedef enum bw_formulation {
  BW_STANDARD, /* displacements alone */
  BW_B_BAR     /* with the mean of the volumetric strain */
} bw_formulation;

enum { BW_THERMAL_ROWS = 16 /* the most of a table of conductivity */ };
/* What a material does with heat (docs/theory/heat.md). */
typedef struct bw_thermal {
  double conductivity[3]; /* (W/(m K)) along the axes 1 2 3; 0: not known */
  double heat_capacity;   /* (J/(kg K)) per mass; 0: not known */
  /* The conductivity is `factor` times the one above at each `temperature`, linear between, and
   * constant outside of the table. */
  int rows;                            /* (count) of the table; 0: it does not depend on it */
  double temperature[BW_THERMAL_ROWS]; /* (K, rows) ascending */
  double factor[BW_THERMAL_ROWS];      /* (-, rows) above 0 */
} bw_thermal;

/* A linear elastic law with strength, density, toughness, and what conducts and stores heat. */
typedef struct bw_material bw_material;
typedef struct bw_material_parts bw_material_parts;
struct bw_material {
  bw_object object;
  char name[48];         /* for messages and results */
  bool isotropic;        /* else orthotropic */
  double density;        /* (kg/m3) 0 when not given */
  double elasticity[36]; /* (Pa) 6x6, global axes, order xx yy zz yz zx xy, engineering shears */
  double compliance[36]; /* (1/Pa) its inverse */
  double axes[9];        /* (-) rows: material axes 1 2 3 in global coordinates */
  double young[3];       /* (Pa) Y1 Y2 Y3 */
  double poisson[3];  /* (-) nu23 nu31 nu12: nu_ij is the contraction along j under load along i */
  double shear[3];    /* (Pa) G23 G31 G12 */
  double strength[3]; /* (Pa) tensile strength along axes 1 2 3; 0 when not known */
  double toughness;   /* (Pa m^0.5) fracture toughness K_Ic; 0 when not known */
  double expansion;   /* (1/K) coefficient of linear expansion, alike in all directions; 0: none */
  bw_thermal thermal; /* conductivity and heat capacity */
  double lame_lambda, lame_mu; /* (Pa) when isotropic */
  bw_formulation formulation;  /* of the elements that have this material */
  /* with scatter and source, where they are known (the library's materials) */
  bw_value young_value[3], poisson_value[3], strength_value[3], density_value, toughness_value;
  bw_value conductivity_value[3], heat_capacity_value; /* likewise, of `thermal` */
  bw_material_parts *parts; /* owned; NULL: all elements are of this material */
};
/* What elements are made of where that differs from one to the next: by region, by axes that turn
 * with the place, or both. The material owns the lists. A material with parts has the formulation,
 * name and axes of its parts where these agree; its density, expansion, toughness and strengths are
 * the least of the parts', 0 where one of them has none; what else differs is 0. */
struct bw_material_parts {
  int32_t element_count, count;
  int32_t *of_element;           /* (index, element_count) its part, from 0 to count - 1 */
  const bw_material **part;      /* (count) retained; none of them has parts */
  const bw_material **unrotated; /* (count) retained: each part before it was turned by element */
  double *rotation; /* (-, count x 9) material axis e_i of the unrotated part goes to R e_i */
};
/* The material of an element of the mesh, without parts; lives as long as `material`. */
static inline const bw_material *bw_material_of(const bw_material *material, int64_t element) {
  const bw_material_parts *p = material->parts;
  return p ? p->part[p->of_element[element]] : material;
}
/* The same before it was turned by element; lives as long as `material`. */
static inline const bw_material *bw_material_unrotated(const bw_material *material,
                                                       int64_t element) {
  const bw_material_parts *p = material->parts;
  return p ? p->unrotated[p->of_element[element]] : material;
}
/* The number of parts (count): 1 where all elements are of one material. */
static inline int32_t bw_material_part_count(const bw_material *material) {
  return material->parts ? material->parts->count : 1;
}
/* Part i, from 0; lives as long as `material`. */
static inline const bw_material *bw_material_part(const bw_material *material, int32_t i) {
  return material->parts ? material->parts->part[i] : material;
}
/* Whether elements are of several materials, not of one whose axes turn. */
static inline bool bw_material_mixed(const bw_material *material) {
  const bw_material_parts *p = material->parts;
  for (int32_t i = 1; p && i < p->count; i++)
    if (p->unrotated[i] != p->unrotated[0])
      return true;
  return false;
}
/* The elasticity matrix, 36 numbers (Pa), in an element; lives as long as the material. */
static inline const double *bw_material_elasticity(const bw_material *material, int64_t element) {
  return bw_material_of(material, element)->elasticity;
}
/* The compliance matrix, 36 numbers (1/Pa), in an element; lives as long as the material. */
static inline const double *bw_material_compliance(const bw_material *material, int64_t element) {
  return bw_material_of(material, element)->compliance;
}

/* The constants of an isotropic material. */
typedef struct bw_isotropic {
  const char *name; /* copied, up to 47 bytes */
  double young;     /* (Pa) > 0 */
  double poisson;   /* (-) > -1 and < 1/2 */
  double density;   /* (kg/m3) 0: not given */
  double strength;  /* (Pa) in tension; 0: not known */
  double toughness; /* (Pa m^0.5) 0: not known */
  double expansion; /* (1/K) 0: none */
} bw_isotropic;
/* A material of these constants. BW_INVALID names one that is out of range. */
BW_API bw_status bw_material_isotropic(bw_context *context, const bw_isotropic *constants,
                                       bw_material **material);

/* The constants of an orthotropic material, along its axes 1 2 3. */
typedef struct bw_orthotropic {
  const char *name;    /* copied, up to 47 bytes */
  double young[3];     /* (Pa) Y1 Y2 Y3 */
  double poisson[3];   /* (-) nu23 nu31 nu12; 0: derived from poisson_t */
  double poisson_t[3]; /* (-) nu32 nu13 nu21; 0: derived from poisson by nu_ij/Y_i = nu_ji/Y_j.
                          Where both are given they are checked against each other */
  double shear[3];     /* (Pa) G23 G31 G12; 0: the worst-case paper's formula (section 6), that is
                          1/G_ij = 1/Y_i + 1/Y_j + 2 nu_ij/Y_i, the same for ij and ji */
  double axes[9];      /* (-) rotation, rows are the material axes; all zero: identity */
  double density;      /* (kg/m3) 0: not given */
  double strength[3];  /* (Pa) in tension along the axes; 0: not known */
  double toughness;    /* (Pa m^0.5) 0: not known */
  double expansion;    /* (1/K) 0: none */
} bw_orthotropic;
/* Checked for positive definiteness, for the reciprocal relation (relative 1e-6) and for axes being
 * a rotation: BW_INVALID names the constants. */
BW_API bw_status bw_material_orthotropic(bw_context *context, const bw_orthotropic *constants,
                                         bw_material **material);
/* The same material with other thermal constants. BW_INVALID names one that is negative or not
 * finite, and a table that does not ascend; it is returned too for a material rotated by element.
 */
BW_API bw_status bw_material_with_thermal(bw_context *context, const bw_material *material,
                                          const bw_thermal *constants, bw_material **result);
/* The factor (-) of the conductivity at a temperature (K); 1 without a table. */
BW_API double bw_thermal_factor(const bw_thermal *thermal, double temperature);
/* The same material turned by a 3x3 rotation (-): axes' = axes * rotation^T, so that each
 * material axis e_i goes to rotation * e_i. BW_INVALID when the matrix is not a rotation. */
BW_API bw_status bw_material_rotated(bw_context *context, const bw_material *material,
                                     const double rotation[9], bw_material **rotated);
/* The material of a body whose elements differ: element e is of part of_element[e] of the
 * part_count parts, which are retained: of_element (index, element_count). It fits meshes of
 * element_count elements only. Where all parts are one material it is that, retained. BW_INVALID
 * for a part that is not there, parts that have parts, and parts of different formulations. */
BW_API bw_status bw_material_by_element(bw_context *context, int32_t element_count,
                                        int32_t part_count, const int32_t *of_element,
                                        const bw_material *const *part, bw_material **material);
/* The material on other elements, each of which is made of what element element_from (index,
 * element_count) of the ones before was. */
BW_API bw_status bw_material_carried(bw_context *context, const bw_material *material,
                                     int32_t element_count, const int32_t *element_from,
                                     bw_material **carried);
/* The same material with axes by element: those of group of_element[e] are turned by the rotation
 * of that group as by bw_material_rotated: of_element (index, element_count), rotation (-,
 * group_count x 9). It fits meshes of element_count elements only. An isotropic material is itself,
 * retained. BW_INVALID for a group that is not there and a rotation that is none. */
BW_API bw_status bw_material_rotated_by_element(bw_context *context, const bw_material *material,
                                                int32_t element_count, int32_t group_count,
                                                const int32_t *of_element, const double *rotation,
                                                bw_material **turned);
/* BW_INVALID where a material with parts does not fit the number of elements. */
BW_API bw_status bw_material_fits(bw_context *context, const bw_material *material,
                                  int32_t element_count);

/* The same material with moduli by element: those of group of_element[e] are multiplied by the
 * factor of that group: of_element (index, element_count), factor (-, group_count) above 0. It fits
 * meshes of element_count elements only, and is of several materials, turned or not. BW_INVALID for
 * a group that is not there and a factor outside its range. */
BW_API bw_status bw_material_stiffened(bw_context *context, const bw_material *material,
                                       int32_t element_count, int32_t group_count,
                                       const int32_t *of_element, const double *factor,
                                       bw_material **stiffened);

/* The same material for elements of a formulation, each of its parts where it has some. */
BW_API bw_status bw_material_formulated(bw_context *context, const bw_material *material,
                                        bw_formulation formulation, bw_material **formulated);
/* The functions below are of a material without parts: of each part where there are some. */

/* The bulk modulus (Pa) under uniform pressure, 1 / (1 : S : 1) (Reuss); a part of C not above it
 * leaves the rest of C positive. */
BW_API double bw_material_bulk(const bw_material *material);
/* The shear modulus (Pa) as Voigt's mean over all directions. */
BW_API double bw_material_mean_shear(const bw_material *material);
/* The part of the bulk modulus (Pa) that acts on the mean of the volumetric strain of an element,
 * in the B-bar formulation; 0 in the standard one, and for materials that do not lock. */
BW_API double bw_material_projected_bulk(const bw_material *material);

/* How many materials the library has: steel, aluminium, pla, abs, resin,
 * green_state_stainless_steel, nylon_pa2200, zp150 (engine/material/library.c). */
BW_API int bw_material_library_count(void);
/* The name of the i-th one, static; NULL past the end. */
BW_API const char *bw_material_library_name(int i);
/* A material of the library. For an unknown name the message of BW_INVALID lists the names. */
BW_API bw_status bw_material_named(bw_context *context, const char *name, bw_material **material);

/* Strength (Pa) in direction n, interpolated over the material axes e_i by
 * 1/s(n)^2 = sum_i (n . e_i)^2 / s_i^2; 0 when not known along all three. */
BW_API double bw_material_strength(const bw_material *material, const double direction[3]);
/* The critical distance (m), (K_Ic / strength)^2 / pi, of the theory of critical distances, by the
 * largest of the strengths; 0 when one of both is not known (docs/theory/singular.md). */
BW_API double bw_material_critical_distance(const bw_material *material);
/* The same with its standard deviation, 2 L ((s_K / K)^2 + (s_s / s)^2)^1/2 by those of toughness
 * and strength, where one of them is known. `source` where that of the toughness is known. */
BW_API bw_value bw_material_critical_distance_value(const bw_material *material);
/* Utilisation (-) of a stress tensor: the largest over the principal stresses of
 * |sigma_i| / strength(direction i); 0 when the strength is not known. Where principal stresses
 * coincide every direction between theirs is principal, and the weakest of them counts. */
BW_API double bw_material_utilisation(const bw_material *material, const double stress[6]);

#ifdef __cplusplus
}
#endif
#endif
