/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
#include "parse_bytes.h"

int LLVMFuzzerTestOneInput(const uint8_t *bytes, size_t count);

int LLVMFuzzerTestOneInput(const uint8_t *bytes, size_t count) {
  parse_bytes("gltf", bytes, count);
  return 0;
}
