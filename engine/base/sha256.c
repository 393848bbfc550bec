/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* SHA-256 (FIPS 180-4) of files, for manifests. */
#include "barwright/confine.h"

#include <errno.h>
#include <fcntl.h>
#include <stdio.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

typedef struct sha256 {
  uint32_t h[8];
  uint64_t bytes;
  unsigned char block[64];
} sha256;

static const uint32_t round_constant[64] = {
    0x428a2f98, 0x71374491, 0xb5c0fbcf, 0xe9b5dba5, 0x3956c25b, 0x59f111f1, 0x923f82a4, 0xab1c5ed5,
    0xd807aa98, 0x12835b01, 0x243185be, 0x550c7dc3, 0x72be5d74, 0x80deb1fe, 0x9bdc06a7, 0xc19bf174,
    0xe49b69c1, 0xefbe4786, 0x0fc19dc6, 0x240ca1cc, 0x2de92c6f, 0x4a7484aa, 0x5cb0a9dc, 0x76f988da,
    0x983e5152, 0xa831c66d, 0xb00327c8, 0xbf597fc7, 0xc6e00bf3, 0xd5a79147, 0x06ca6351, 0x14292967,
    0x27b70a85, 0x2e1b2138, 0x4d2c6dfc, 0x53380d13, 0x650a7354, 0x766a0abb, 0x81c2c92e, 0x92722c85,
    0xa2bfe8a1, 0xa81a664b, 0xc24b8b70, 0xc76c51a3, 0xd192e819, 0xd6990624, 0xf40e3585, 0x106aa070,
    0x19a4c116, 0x1e376c08, 0x2748774c, 0x34b0bcb5, 0x391c0cb3, 0x4ed8aa4a, 0x5b9cca4f, 0x682e6ff3,
    0x748f82ee, 0x78a5636f, 0x84c87814, 0x8cc70208, 0x90befffa, 0xa4506ceb, 0xbef9a3f7, 0xc67178f2};

static const sha256 beginning = {{0x6a09e667, 0xbb67ae85, 0x3c6ef372, 0xa54ff53a, 0x510e527f,
                                  0x9b05688c, 0x1f83d9ab, 0x5be0cd19},
                                 0,
                                 {0}};

static uint32_t rotate_right(uint32_t x, int k) {
  return (x >> k) | (x << (32 - k));
}

static void digest_block(sha256 *sha) {
  uint32_t w[64];
  const unsigned char *b = sha->block;
  for (int i = 0; i < 16; i++, b += 4)
    w[i] = (uint32_t)b[0] << 24 | (uint32_t)b[1] << 16 | (uint32_t)b[2] << 8 | b[3];
  for (int i = 16; i < 64; i++) {
    uint32_t s0 = rotate_right(w[i - 15], 7) ^ rotate_right(w[i - 15], 18) ^ (w[i - 15] >> 3);
    uint32_t s1 = rotate_right(w[i - 2], 17) ^ rotate_right(w[i - 2], 19) ^ (w[i - 2] >> 10);
    w[i] = w[i - 16] + s0 + w[i - 7] + s1;
  }
  uint32_t v[8];
  memcpy(v, sha->h, sizeof v);
  for (int i = 0; i < 64; i++) {
    uint32_t s1 = rotate_right(v[4], 6) ^ rotate_right(v[4], 11) ^ rotate_right(v[4], 25);
    uint32_t choose = (v[4] & v[5]) ^ (~v[4] & v[6]);
    uint32_t t1 = v[7] + s1 + choose + round_constant[i] + w[i];
    uint32_t s0 = rotate_right(v[0], 2) ^ rotate_right(v[0], 13) ^ rotate_right(v[0], 22);
    uint32_t majority = (v[0] & v[1]) ^ (v[0] & v[2]) ^ (v[1] & v[2]);
    for (int k = 7; k > 0; k--)
      v[k] = v[k - 1];
    v[4] += t1;
    v[0] = t1 + s0 + majority;
  }
  for (int k = 0; k < 8; k++)
    sha->h[k] += v[k];
}

static void add(sha256 *sha, const unsigned char *bytes, size_t count) {
  for (size_t i = 0; i < count; i++) {
    sha->block[sha->bytes++ % 64] = bytes[i];
    if (sha->bytes % 64 == 0)
      digest_block(sha);
  }
}

static void finish(sha256 *sha, char digest[65]) {
  uint64_t bits = sha->bytes * 8;
  unsigned char tail[8], one = 0x80, zero = 0;
  add(sha, &one, 1);
  while (sha->bytes % 64 != 56)
    add(sha, &zero, 1);
  for (int i = 0; i < 8; i++)
    tail[i] = (unsigned char)(bits >> (56 - 8 * i));
  add(sha, tail, 8);
  for (int i = 0; i < 8; i++)
    snprintf(digest + 8 * i, 9, "%08x", (unsigned)sha->h[i]);
}

static bw_status refuse(bw_context *context, const char *path, int descriptor, const char *why) {
  bw_fail(context, BW_IO, "%s: cannot be read: %s", path[0] ? path : "(empty name)", why);
  bw_detail_text(context, "file", path);
  if (descriptor >= 0)
    close(descriptor);
  return BW_IO;
}

bw_status bw_sha256_file(bw_context *context, const char *path, char digest[65]) {
  bw_status status = bw_may_use(context, path, BW_TO_READ);
  if (status != BW_OK)
    return status;
  /* Without waiting: opening a pipe to which nobody writes would never return. */
  int descriptor = bw_open(path, O_RDONLY | O_NONBLOCK, 0);
  struct stat about;
  if (descriptor < 0 || fstat(descriptor, &about) != 0)
    return refuse(context, path, descriptor, strerror(errno));
  if (!S_ISREG(about.st_mode)) /* a device may have no end */
    return refuse(context, path, descriptor,
                  S_ISDIR(about.st_mode) ? "it is a directory" : "it is not a regular file");
  FILE *file = fdopen(descriptor, "rb");
  if (!file)
    return refuse(context, path, descriptor, strerror(errno));
  sha256 sha = beginning;
  unsigned char buffer[65536];
  size_t got;
  while ((got = fread(buffer, 1, sizeof buffer, file)) > 0)
    add(&sha, buffer, got);
  bool failed = ferror(file) != 0;
  fclose(file);
  if (failed)
    return bw_fail(context, BW_IO, "%s: cannot be read: reading failed", path);
  finish(&sha, digest);
  return BW_OK;
}

void bw_sha256_bytes(const void *bytes, size_t count, char digest[65]) {
  sha256 sha = beginning;
  add(&sha, (const unsigned char *)bytes, count);
  finish(&sha, digest);
}
