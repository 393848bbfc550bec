/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* Symmetries of the cube, and keys that they take into each other. */
#ifndef BWI_METAMATERIAL_KEYS_H
#define BWI_METAMATERIAL_KEYS_H

#include "barwright/nonlinear.h"

/* ---- symmetries ---------------------------------------------------------------------------------
 *
 * The 48 symmetries of the unit cube, reflections included. Number s takes x to y with
 * y_d = x_axis[d], or 1 - x_axis[d] where bit d of `flip` is set. Number 0 is the identity. */
enum { BWI_SYMMETRIES = 48 };
typedef struct bwi_symmetry {
  int axis[3], flip;
} bwi_symmetry;

bwi_symmetry bwi_symmetry_of(int s);
int bwi_symmetry_after(int s, int first); /* `first`, then s */
int bwi_symmetry_inverse(int s);
/* Where octant (or corner) c goes. */
static inline int bwi_symmetry_octant(bwi_symmetry s, int c) {
  return ((c >> s.axis[0] & 1) | (c >> s.axis[1] & 1) << 1 | (c >> s.axis[2] & 1) << 2) ^ s.flip;
}
/* Where a vector goes. */
void bwi_symmetry_vector(bwi_symmetry s, const double from[3], double to[3]);
/* to[image of c] = from[c]: the key of the turned block. `count` is 8, or 64 (octants of
 * octants). */
void bwi_symmetry_key(int s, int count, const int32_t *from, int32_t *to);
/* A 24 x 24 stiffness of a cube, turned with it. */
void bwi_symmetry_stiffness(int s, const double from[576], double to[576]);
/* A material whose points lie in octants (of octants), turned. */
bw_status bwi_material_transformed(bw_context *context, const bw_solid_material *material, int s,
                                   bw_solid_material **turned);

/* ---- keys ---------------------------------------------------------------------------------------
 *
 * A key of eight numbers below `base` has the code sum key[c] base^c. Keys that symmetries take
 * into each other are one orbit; the one of smallest code stands for it. Orbits are numbered by
 * that code. The key of void alone belongs to none, and without `voids` no key with a 0 does. */
typedef struct bwi_keys {
  int32_t base;
  bool voids;
  int32_t code_count, orbit_count;
  int32_t *first;    /* orbit_count: smallest code */
  int32_t *orbit;    /* code_count: or -1 */
  uint8_t *symmetry; /* code_count: takes the orbit's first key to this one */
} bwi_keys;

/* BW_LIMIT where there are more than 2^24 keys. Without `orbits` only base and limit are taken: no
 * key belongs to an orbit, and the lists are NULL. */
bw_status bwi_keys_create(bw_context *context, int32_t base, bool voids, bool orbits,
                          bwi_keys **keys);
void bwi_keys_destroy(bwi_keys *keys);
static inline int32_t bwi_key_code(int32_t base, const int32_t key[8]) {
  int32_t code = 0;
  for (int c = 7; c >= 0; c--)
    code = code * base + key[c];
  return code;
}
static inline void bwi_key_of(int32_t base, int32_t code, int32_t key[8]) {
  for (int c = 0; c < 8; c++, code /= base)
    key[c] = code % base;
}

#endif
