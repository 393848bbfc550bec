/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* Random numbers that are the same everywhere: splitmix64 seeds xoshiro256** (Blackman, Vigna). */
#include "barwright/base.h"

#include <math.h>

static uint64_t splitmix(uint64_t *state) {
  uint64_t z = (*state += 0x9e3779b97f4a7c15u);
  z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9u;
  z = (z ^ (z >> 27)) * 0x94d049bb133111ebu;
  return z ^ (z >> 31);
}

static uint64_t rotate_left(uint64_t x, int k) {
  return (x << k) | (x >> (64 - k));
}

void bw_random_seed(bw_random *random, uint64_t seed) {
  for (int i = 0; i < 4; i++)
    random->state[i] = splitmix(&seed);
}

uint64_t bw_random_bits(bw_random *random) {
  uint64_t *s = random->state;
  uint64_t result = rotate_left(s[1] * 5, 7) * 9, t = s[1] << 17;
  s[2] ^= s[0];
  s[3] ^= s[1];
  s[1] ^= s[2];
  s[0] ^= s[3];
  s[2] ^= t;
  s[3] = rotate_left(s[3], 45);
  return result;
}

double bw_random_uniform(bw_random *random) {
  return (double)(bw_random_bits(random) >> 11) * 0x1p-53;
}

double bw_random_normal(bw_random *random) {
  double u = 1 - bw_random_uniform(random), v = bw_random_uniform(random);
  return sqrt(-2 * log(u)) * cos(6.283185307179586 * v);
}
