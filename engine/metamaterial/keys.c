/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* Symmetries of the cube, and keys that they take into each other. */
#include "metamaterial/keys.h"

#include <string.h>

enum { MAX_CODES = 1 << 24 };

static const int permutation[6][3] = {{0, 1, 2}, {0, 2, 1}, {1, 0, 2},
                                      {1, 2, 0}, {2, 0, 1}, {2, 1, 0}};

bwi_symmetry bwi_symmetry_of(int s) {
  const int *axis = permutation[s / 8];
  return (bwi_symmetry){{axis[0], axis[1], axis[2]}, s % 8};
}

int bwi_symmetry_after(int s, int first) {
  bwi_symmetry a = bwi_symmetry_of(s), b = bwi_symmetry_of(first);
  int flip = a.flip, p = 0;
  for (int d = 0; d < 3; d++)
    flip ^= (b.flip >> a.axis[d] & 1) << d;
  while (permutation[p][0] != b.axis[a.axis[0]] || permutation[p][1] != b.axis[a.axis[1]])
    p++;
  return 8 * p + flip;
}

int bwi_symmetry_inverse(int s) {
  int t = 0;
  while (bwi_symmetry_after(t, s) != 0)
    t++;
  return t;
}

void bwi_symmetry_vector(bwi_symmetry s, const double from[3], double to[3]) {
  for (int d = 0; d < 3; d++)
    to[d] = s.flip >> d & 1 ? -from[s.axis[d]] : from[s.axis[d]];
}

void bwi_symmetry_key(int s, int count, const int32_t *from, int32_t *to) {
  bwi_symmetry sym = bwi_symmetry_of(s);
  for (int p = 0; p < count; p++)
    to[count == 8 ? bwi_symmetry_octant(sym, p)
                  : 8 * bwi_symmetry_octant(sym, p / 8) + bwi_symmetry_octant(sym, p % 8)] =
        from[p];
}

void bwi_symmetry_stiffness(int s, const double from[576], double to[576]) {
  bwi_symmetry sym = bwi_symmetry_of(s);
  int image[24]; /* row of `from` that row 3 c + d of `to` comes from */
  double sign[24];
  for (int c = 0; c < 8; c++)
    for (int d = 0; d < 3; d++) {
      int row = 3 * bwi_symmetry_octant(sym, c) + d;
      image[row] = 3 * c + sym.axis[d];
      sign[row] = sym.flip >> d & 1 ? -1 : 1;
    }
  for (int i = 0; i < 24; i++)
    for (int j = 0; j < 24; j++)
      to[24 * i + j] = sign[i] * sign[j] * from[24 * image[i] + image[j]];
}

bw_status bwi_material_transformed(bw_context *context, const bw_solid_material *m, int s,
                                   bw_solid_material **turned) {
  bw_status status = BW_OK;
  bwi_symmetry sym = bwi_symmetry_of(s);
  int32_t count = m->rule->count;
  size_t fibres = (size_t)m->fibre_count;
  uint8_t law[64];
  double mu[64], lambda[64], stiffness[64 * 3], fibre[64 * 9], spread[3];
  bw_rule *rule = NULL;
  if (count != 8 && count != 64)
    return bw_fail(context, BW_INVALID,
                   "material %s has %d points; those of 8 and 64 can be rotated", m->name,
                   (int)count);
  if (s == 0) {
    *turned = (bw_solid_material *)bw_retain(m);
    return BW_OK;
  }
  for (int32_t p = 0; p < count; p++) {
    int32_t to = bwi_symmetry_octant(sym, p % 8);
    if (count == 64)
      to += 8 * bwi_symmetry_octant(sym, p / 8);
    law[to] = m->law[p];
    mu[to] = m->mu[p];
    lambda[to] = m->lambda[p];
    for (size_t f = 0; f < fibres; f++) {
      stiffness[(size_t)to * fibres + f] = m->fibre_stiffness[(size_t)p * fibres + f];
      bwi_symmetry_vector(sym, m->fibre + 3 * ((size_t)p * fibres + f),
                          fibre + 3 * ((size_t)to * fibres + f));
    }
  }
  bool even = true;
  for (int d = 0; d < 3; d++) {
    spread[d] = m->rule->spread[sym.axis[d]];
    even = even && spread[d] == m->rule->spread[d];
  }
  if (even)
    rule = (bw_rule *)bw_retain(m->rule);
  else
    BW_TRY(bw_rule_create_spread(context, m->rule->level, spread, &rule));
  BW_TRY(bw_solid_material_points(context, m->name, rule, m->density, law, mu, lambda,
                                  m->fibre_count, stiffness, fibre, turned));
done:
  bw_release(rule);
  return status;
}

void bwi_keys_destroy(bwi_keys *keys) {
  if (!keys)
    return;
  bw_free(keys->first);
  bw_free(keys->orbit);
  bw_free(keys->symmetry);
  bw_free(keys);
}

/* All that the symmetries make of a key, unless it is one of an orbit already. */
static void enter_orbit(bwi_keys *keys, const int32_t weight[BWI_SYMMETRIES][8], int32_t code) {
  int32_t key[8], orbit = keys->orbit_count;
  bwi_key_of(keys->base, code, key);
  for (int c = 0; c < 8; c++)
    if (!keys->voids && key[c] == 0)
      return;
  for (int s = 0; s < BWI_SYMMETRIES; s++) {
    int32_t image = 0;
    for (int c = 0; c < 8; c++)
      image += key[c] * weight[s][c];
    if (keys->orbit[image] >= 0)
      continue;
    keys->orbit[image] = orbit;
    keys->symmetry[image] = (uint8_t)s;
  }
  keys->first[keys->orbit_count++] = code;
}

bw_status bwi_keys_create(bw_context *context, int32_t base, bool voids, bool orbits,
                          bwi_keys **out) {
  bw_status status = BW_OK;
  int64_t codes = 1;
  int32_t power[8], weight[BWI_SYMMETRIES][8];
  for (int c = 0; c < 8; c++) {
    power[c] = (int32_t)codes;
    codes *= base;
    if (codes > MAX_CODES)
      return bw_fail(
          context, BW_LIMIT,
          "a material table of %d materials and void has %d^8 blocks of 2 x 2 x 2, more than "
          "2^24: a library takes up to 7 materials",
          (int)base - 1, (int)base);
  }
  for (int s = 0; s < BWI_SYMMETRIES; s++)
    for (int c = 0; c < 8; c++)
      weight[s][c] = power[bwi_symmetry_octant(bwi_symmetry_of(s), c)];
  bwi_keys *keys = BW_NEW0(context, bwi_keys, 1);
  if (!keys)
    return BW_MEMORY;
  keys->base = base;
  keys->voids = voids;
  if (!orbits) {
    *out = keys;
    return BW_OK;
  }
  keys->code_count = (int32_t)codes;
  keys->orbit = BW_NEW(context, int32_t, codes);
  keys->symmetry = BW_NEW0(context, uint8_t, codes);
  keys->first = BW_NEW(context, int32_t, codes);
  BW_TRY_MEMORY(keys->orbit && keys->symmetry && keys->first);
  memset(keys->orbit, -1, (size_t)codes * sizeof *keys->orbit);
  for (int32_t code = 1; code < keys->code_count; code++) {
    if (code % 65536 == 0)
      BW_TRY(bw_check_cancel(context));
    if (keys->orbit[code] < 0)
      enter_orbit(keys, weight, code);
  }
  int32_t *less =
      (int32_t *)bw_resize(context, keys->first, (size_t)keys->orbit_count, sizeof *less);
  BW_TRY_MEMORY(less);
  keys->first = less;
  *out = keys;
  keys = NULL;
done:
  bwi_keys_destroy(keys);
  return status;
}
