/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* Every seed of the fuzzers, whole and damaged in ways that do not depend on chance: cut at every
 * byte, bytes changed, numbers replaced by ones that lie. Nothing may crash, hang, or leave memory
 * behind; what comes back is an object or a message. */
#include "io_check.h"

#include <dirent.h>

#include "../../fuzz/parse_bytes.h"

enum { MAX_SEEDS = 400, STEPS = 700 };

static int by_name(const void *a, const void *b) {
  return strcmp(*(char *const *)a, *(char *const *)b);
}

static void cut(const char *format, const unsigned char *bytes, size_t count) {
  size_t step = count / STEPS + 1;
  for (size_t i = 0; i < count; i += step)
    parse_bytes(format, bytes, i);
}

static void change(const char *format, unsigned char *bytes, size_t count) {
  static const unsigned char flip[] = {0x01, 0x80, 0xFF};
  size_t step = 3 * count / STEPS + 1;
  for (size_t i = 0; i < count; i += step)
    for (int k = 0; k < 3; k++) {
      bytes[i] ^= flip[k];
      parse_bytes(format, bytes, count);
      bytes[i] ^= flip[k];
    }
  for (size_t i = 0; i + 8 <= count; i += step) {
    unsigned char kept[8];
    memcpy(kept, bytes + i, 8);
    memset(bytes + i, 0xFF, 4);
    parse_bytes(format, bytes, count);
    memset(bytes + i, 0x7F, 8);
    parse_bytes(format, bytes, count);
    memcpy(bytes + i, kept, 8);
  }
}

static bool is_digit(unsigned char c) {
  return c >= '0' && c <= '9';
}

static void splice(const char *format, const unsigned char *bytes, size_t count) {
  static const char *const lie[] = {"4294967295", "-1", "1e999", "nan", "9223372036854775807", ""};
  unsigned char *spliced = malloc(count + 32);
  int numbers = 0;
  for (size_t i = 0; i < count && numbers < STEPS; i++) {
    if (!is_digit(bytes[i]) || (i > 0 && is_digit(bytes[i - 1])))
      continue;
    size_t end = i;
    while (end < count && is_digit(bytes[end]))
      end++;
    numbers++;
    for (size_t k = 0; k < sizeof lie / sizeof *lie; k++) {
      size_t length = strlen(lie[k]);
      memcpy(spliced, bytes, i);
      memcpy(spliced + i, lie[k], length);
      memcpy(spliced + i + length, bytes + end, count - end);
      parse_bytes(format, spliced, count - (end - i) + length);
    }
  }
  free(spliced);
}

static void replay(const char *format) {
  char folder[200], path[600], *name[MAX_SEEDS];
  int seeds = 0;
  bw_context *context = bw_context_create();
  snprintf(folder, sizeof folder, "tests/fuzz/seeds/%s", format);
  DIR *directory = opendir(folder);
  assert_non_null(directory);
  for (struct dirent *entry; (entry = readdir(directory)) && seeds < MAX_SEEDS;)
    if (entry->d_name[0] != '.')
      name[seeds++] = strdup(entry->d_name);
  closedir(directory);
  assert_true(seeds > 0);
  qsort(name, (size_t)seeds, sizeof *name, by_name);
  for (int i = 0; i < seeds; i++) {
    unsigned char *bytes;
    size_t count;
    snprintf(path, sizeof path, "%s/%s", folder, name[i]);
    check_ok(context, bw_read_file(context, path, &bytes, &count));
    parse_bytes(format, bytes, count);
    cut(format, bytes, count);
    change(format, bytes, count);
    splice(format, bytes, count);
    bw_free(bytes);
    free(name[i]);
  }
  bw_context_destroy(context);
}

#define REPLAY(format)                                                                             \
  static void replay_##format(void **state) {                                                      \
    (void)state;                                                                                   \
    replay(#format);                                                                               \
  }
REPLAY(stl)
REPLAY(obj)
REPLAY(off)
REPLAY(ply)
REPLAY(msh)
REPLAY(vtu)
REPLAY(medit)
REPLAY(tetgen)
REPLAY(inp)
REPLAY(tgf)
REPLAY(gltf)
REPLAY(svg)
REPLAY(dxf)
REPLAY(bwm)
REPLAY(plane)
REPLAY(matrix)

check_main(cmocka_unit_test(replay_stl), cmocka_unit_test(replay_obj), cmocka_unit_test(replay_off),
           cmocka_unit_test(replay_ply), cmocka_unit_test(replay_msh), cmocka_unit_test(replay_vtu),
           cmocka_unit_test(replay_medit), cmocka_unit_test(replay_tetgen),
           cmocka_unit_test(replay_inp), cmocka_unit_test(replay_tgf),
           cmocka_unit_test(replay_gltf), cmocka_unit_test(replay_svg),
           cmocka_unit_test(replay_dxf), cmocka_unit_test(replay_bwm),
           cmocka_unit_test(replay_plane), cmocka_unit_test(replay_matrix))
