/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* Disjoint sets as a forest: parent[i] == i at roots. */
#ifndef BWI_BASE_UNION_FIND_H
#define BWI_BASE_UNION_FIND_H

#include <stdint.h>

/* The root of an item; paths are halved on the way. */
static inline int32_t bwi_set_root(int32_t *parent, int32_t item) {
  while (parent[item] != item) {
    parent[item] = parent[parent[item]];
    item = parent[item];
  }
  return item;
}

/* The lower of the two roots becomes that of both, and is returned. */
static inline int32_t bwi_set_join(int32_t *parent, int32_t a, int32_t b) {
  a = bwi_set_root(parent, a);
  b = bwi_set_root(parent, b);
  if (a > b) {
    int32_t c = a;
    a = b;
    b = c;
  }
  parent[b] = a;
  return a;
}

#endif
