/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* The library of measured materials: one table. To add a material, add a row (CONTRIBUTING shows
 * one from start to end). Every value carries its standard deviation, 0 where none is published,
 * and where it comes from, in words that say plainly when it is an estimate. Where a range a to b
 * is published, the deviation is that of a uniform distribution, (b - a) / sqrt(12).
 *
 * An orthotropic row gives Poisson's ratios nu12, nu23, nu13 (load along the first axis), and its
 * shear moduli follow from the worst-case paper's formula. The paper assumes 0.3 "in all cases"
 * without saying for which of nu_ij and nu_ji; the two differ when the moduli do. We take the
 * pairs xy, yz, xz, which are the ones its formula (from SolidWorks) is written for; the other
 * three follow from nu_ij/Y_i = nu_ji/Y_j. For zp150, where X is stiffest and Z softest, this makes
 * 0.3 the larger ratio of each pair: the opposite choice would give nu13 = 1.56. */
#include "material/internal.h"

#include <stdio.h>
#include <string.h>

typedef struct entry {
  const char *name;
  bool isotropic;
  bw_value young[3];      /* Pa; isotropic: the first only */
  bw_value poisson;       /* nu12 = nu23 = nu13 */
  bw_value strength[3];   /* Pa; isotropic: the first only */
  bw_value density;       /* kg/m3 */
  bw_value toughness;     /* Pa m^1/2; none where no published value fits the material */
  bw_value conductivity;  /* W/(m K), alike in all directions; none likewise */
  bw_value heat_capacity; /* J/(kg K) */
  bw_value expansion;     /* 1/K, alike in all directions; none likewise */
} entry;

#define PAPER "worst-case structural analysis (2013), section 6: three-point bending"
#define ASSUMED "assumed in worst-case structural analysis (2013), section 6"
#define EC3 "EN 1993-1-1, 3.2.6"
#define EC9 "EN 1999-1-1, 3.2.5"

/* One strength is published, for infiltrated parts, with no direction. The moduli of zp150 are the
 * paper's for parts without infiltrant, of which it says only that they are weak and scatter. */
#define ZP150_STRENGTH                                                                             \
  "Jimenez et al., Complexity 2019, 9656938, table 6: parts infiltrated with Z-Bond, direction "   \
  "not given; an upper bound for parts that are not infiltrated"

static const entry library[] = {
    {.name = "steel",
     .isotropic = true,
     .young = {{210e9, 0, EC3}},
     .poisson = {0.3, 0, EC3},
     .strength = {{235e6, 0, "yield strength of grade S235 up to 16 mm, EN 10025-2"}},
     .density = {7850, 0, "EN 1991-1-1, table A.4"},
     .toughness = {61.5e6, 11.8e6,
                   "Cambridge University Engineering Department, Materials Data Book (2003): low "
                   "carbon steels, 41 to 82; S235 yields before it fractures in plane strain"},
     .conductivity = {53.3, 0, "carbon steel at 20 degrees C, EN 1993-1-2, 3.4.1.3"},
     .heat_capacity = {440, 0, "carbon steel at 20 degrees C, EN 1993-1-2, 3.4.1.2"},
     .expansion = {12e-6, 0, "up to 100 degrees C, " EC3}},
    {.name = "aluminium",
     .isotropic = true,
     .young = {{70e9, 0, EC9}},
     .poisson = {0.3, 0, EC9},
     .strength = {{240e6, 0, "0.2 % proof strength of EN AW-6061 T6 extrusions, EN 755-2"}},
     .density = {2700, 0, EC9},
     .toughness = {29e6, 3.8e6,
                   "6061-T6 across the rolling direction, supplier's data by ASM; scatter of "
                   "aluminium alloys, 22 to 35, Materials Data Book (2003)"},
     .conductivity = {167, 0, "6061-T6, supplier's data by ASM"},
     .heat_capacity = {896, 0, "6061-T6, supplier's data by ASM"},
     .expansion = {23e-6, 0, EC9}},
    {.name = "pla",
     .isotropic = true,
     .young = {{3.6e9, 0, "NatureWorks Ingeo 4043D data sheet, the resin, ASTM D882"}},
     .poisson = {0.36, 0, "customary for PLA; published values lie between 0.33 and 0.36"},
     .strength = {{53e6, 0,
                   "NatureWorks Ingeo 4043D data sheet, the resin at break, ASTM D882; across "
                   "printed layers often half of it or less"}},
     .density = {1240, 0, "NatureWorks Ingeo 4043D data sheet"},
     .conductivity = {0.15, 0.023,
                      "customary for solid PLA; published values lie between 0.11 and 0.19"},
     .heat_capacity = {1500, 170,
                       "customary for PLA at room temperature; published values lie between 1200 "
                       "and 1800"}},
    {.name = "abs",
     .isotropic = true,
     .young = {{2.413e9, 0, "Stratasys, Fortus ABS-M30, ASTM D638"}},
     .poisson = {0.35, 0, "customary for ABS"},
     .strength = {{36e6, 0,
                   "Stratasys, Fortus ABS-M30, ASTM D638 (33 MPa by ISO 527); less across printed "
                   "layers"}},
     .density = {1040, 0, "Stratasys, Fortus ABS-M30"},
     .toughness =
         {3e6, 0.4e6,
          "Dowling, Mechanical Behavior of Materials (2013), table 8.2: ABS, not printed; scatter "
          "by McLouth et al., Additive Manufacturing 18 (2017): 54 % from the weakest to the "
          "strongest direction of prints"}},
    {.name = "resin",
     .isotropic = true,
     .young = {{2.8e9, 0, "Formlabs standard resin data sheet, post-cured, ASTM D638"}},
     .poisson = {0.35, 0, "customary for photopolymers"},
     .strength = {{65e6, 0, "Formlabs standard resin data sheet, post-cured, ASTM D638"}},
     .density = {1170, 0, "estimate for cured acrylate resin"}},
    {.name = "green_state_stainless_steel",
     .isotropic = true,
     .young = {{3.59e9, 0.27e9, PAPER}},
     .poisson = {0.3, 0, ASSUMED},
     .strength = {{6.88e6, 0.62e6, PAPER ", critical stress"}},
     .density = {4600, 0, "estimate: 420 stainless steel, 7740 kg/m3, packed to 60 %"}},
    {.name = "nylon_pa2200",
     .isotropic = false,
     .young = {{0.80e9, 0.13e9, PAPER}, {1.02e9, 0.18e9, PAPER}, {0.98e9, 0.12e9, PAPER}},
     .poisson = {0.3, 0, ASSUMED},
     .strength = {{48e6, 0, "EOS PA 2200 Balance 1.0 data sheet, X, ISO 527"},
                  {48e6, 0, "EOS PA 2200 Balance 1.0 data sheet, Y, ISO 527"},
                  {42e6, 0, "EOS PA 2200 Balance 1.0 data sheet, Z, ISO 527"}},
     .density = {930, 0, "EOS PA 2200 Balance 1.0 data sheet"}},
    {.name = "zp150",
     .isotropic = false,
     .young = {{1.22e9, 0.13e9, PAPER}, {0.68e9, 0.07e9, PAPER}, {0.234e9, 0.02e9, PAPER}},
     .poisson = {0.3, 0, ASSUMED},
     .strength = {{14e6, 0, ZP150_STRENGTH}, {14e6, 0, ZP150_STRENGTH}, {14e6, 0, ZP150_STRENGTH}},
     .density = {1300, 0, "estimate: gypsum, 2320 kg/m3, at 44 % porosity"}},
};

int bw_material_library_count(void) {
  return (int)(sizeof library / sizeof *library);
}

const char *bw_material_library_name(int i) {
  return i >= 0 && i < bw_material_library_count() ? library[i].name : NULL;
}

static bw_status make(bw_context *context, const entry *e, bw_material **material) {
  bw_status status;
  if (e->isotropic) {
    bw_isotropic constants = {.name = e->name,
                              .young = e->young[0].mean,
                              .poisson = e->poisson.mean,
                              .density = e->density.mean,
                              .strength = e->strength[0].mean,
                              .toughness = e->toughness.mean,
                              .expansion = e->expansion.mean};
    status = bw_material_isotropic(context, &constants, material);
  } else {
    double nu = e->poisson.mean;
    bw_orthotropic constants = {.name = e->name,
                                .poisson = {nu, 0, nu},  /* nu23, -, nu12 */
                                .poisson_t = {0, nu, 0}, /* nu13 */
                                .density = e->density.mean,
                                .toughness = e->toughness.mean,
                                .expansion = e->expansion.mean};
    for (int i = 0; i < 3; i++) {
      constants.young[i] = e->young[i].mean;
      constants.strength[i] = e->strength[i].mean;
    }
    status = bw_material_orthotropic(context, &constants, material);
  }
  if (status != BW_OK)
    return status;
  (*material)->thermal.heat_capacity = e->heat_capacity.mean;
  (*material)->heat_capacity_value = e->heat_capacity;
  for (int i = 0; i < 3; i++) {
    (*material)->thermal.conductivity[i] = e->conductivity.mean;
    (*material)->conductivity_value[i] = e->conductivity;
    (*material)->young_value[i] = e->young[e->isotropic ? 0 : i];
    (*material)->strength_value[i] = e->strength[e->isotropic ? 0 : i];
    (*material)->poisson_value[i] = e->poisson;
    (*material)->poisson_value[i].mean = (*material)->poisson[i];
  }
  (*material)->density_value = e->density;
  (*material)->toughness_value = e->toughness;
  return BW_OK;
}

bw_status bw_material_named(bw_context *context, const char *name, bw_material **material) {
  char names[400] = "";
  size_t used = 0;
  for (int i = 0; i < bw_material_library_count(); i++) {
    if (strcmp(name, library[i].name) == 0)
      return make(context, &library[i], material);
    int n = snprintf(names + used, sizeof names - used, "%s%s", i ? ", " : "", library[i].name);
    if (n > 0 && (size_t)n < sizeof names - used)
      used += (size_t)n;
  }
  bw_status status = bw_fail(
      context, BW_INVALID, "there is no material named \"%.60s\"; the library has %s", name, names);
  bw_detail_text(context, "name", name);
  return status;
}
