/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* Library files: there and back, and every kind of damage refused. */
#include "library_fixture.h"

#include <unistd.h>
#include <zlib.h>

#include "barwright/io.h"

static char path[] = "/tmp/barwright_library_XXXXXX";

static unsigned char *bytes_of(bw_context *context, const bw_library *library, size_t *count) {
  unsigned char *bytes;
  check_ok(context, bw_library_write(context, library, path));
  check_ok(context, bw_read_file(context, path, &bytes, count));
  return bytes;
}

static void test_there_and_back(void **state) {
  bw_context *context = check_context(state);
  for (int levels = 1; levels <= 2; levels++) {
    bw_library *library = fixture_library(context, 2, levels == 1, levels, 20), *read;
    size_t count, again;
    unsigned char *bytes = bytes_of(context, library, &count), *second;
    char *text;
    check_ok(context, bw_library_read(context, path, &read));
    fixture_same(library, read);
    second = bytes_of(context, read, &again);
    assert_int_equal(again, count);
    assert_memory_equal(bytes, second, count);
    check_ok(context, bw_library_describe(context, read, &text));
    assert_non_null(
        strstr(text, levels == 1 ? "2 materials, 1 level, blocks with void" : "without void"));
    assert_non_null(strstr(text, "2 middle: neo_hookean"));
    bw_free(text);
    bw_free(bytes);
    bw_free(second);
    bw_release(read);
    bw_release(library);
  }
}

/* Put right checksums on what was changed, as someone with bad intentions would. */
static void sign(unsigned char *bytes, size_t count) {
  uint32_t sum = (uint32_t)crc32(0, bytes, (uInt)count - 4);
  for (int i = 0; i < 4; i++)
    bytes[count - 4 + (size_t)i] = (unsigned char)(sum >> 8 * i);
}

static bw_status parse(bw_context *context, const unsigned char *bytes, size_t count) {
  /* A block of its own, so that a read past the end is seen. */
  unsigned char *copy = malloc(count ? count : 1);
  bw_library *library = NULL;
  int64_t blocks = bw_live_blocks();
  memcpy(copy, bytes, count);
  bw_status status = bw_library_parse(context, "damaged.bwm", copy, count, &library);
  free(copy);
  if (status == BW_OK)
    bw_release(library);
  else
    assert_true(strncmp(bw_message(context), "damaged.bwm", 11) == 0);
  assert_int_equal(bw_live_blocks(), blocks);
  return status;
}

static void test_damage(void **state) {
  bw_context *context = check_context(state);
  bw_library *library = fixture_library(context, 1, true, 2, 8);
  size_t count;
  unsigned char *bytes = bytes_of(context, library, &count);
  assert_int_equal(parse(context, bytes, count), BW_OK);
  for (size_t cut = 0; cut < count; cut += cut < 200 || cut + 200 > count ? 1 : 97)
    assert_int_equal(parse(context, bytes, cut), BW_FORMAT);
  for (size_t bit = 0; bit < 8 * count; bit += bit < 1600 || bit + 1600 > 8 * count ? 1 : 611) {
    bytes[bit / 8] ^= (unsigned char)(1 << bit % 8);
    assert_int_equal(parse(context, bytes, count), BW_FORMAT);
    /* With the last checksum put right something else must notice, or it does not matter: a bit of
     * zlib's header can be one that does not. */
    sign(bytes, count);
    parse(context, bytes, count);
    bytes[bit / 8] ^= (unsigned char)(1 << bit % 8);
    sign(bytes, count);
  }
  assert_int_equal(parse(context, bytes, count), BW_OK);
  unsigned char *longer = malloc(count + 1);
  memcpy(longer, bytes, count);
  longer[count] = 0;
  check_fails(context, BW_FORMAT, "bytes follow", parse(context, longer, count + 1));
  free(longer);
  bw_free(bytes);
  bw_release(library);
}

static void test_claims(void **state) {
  bw_context *context = check_context(state);
  bw_library *library = fixture_library(context, 1, true, 1, 8);
  size_t count;
  unsigned char *bytes = bytes_of(context, library, &count);
  check_fails(context, BW_FORMAT, "no library file",
              parse(context, (const unsigned char *)"solid cube\n", 11));
  check_fails(context, BW_FORMAT, "no library file", parse(context, bytes, 0));
  bytes[8] = 3;
  sign(bytes, count);
  check_fails(context, BW_FORMAT, "version 3; this barwright reads versions 1 and 2",
              parse(context, bytes, count));
  bytes[8] = 1;
  /* The head, unpacked, would take a terabyte; then just more than a head can. */
  bytes[20 + 5] = 1;
  sign(bytes, count);
  check_fails(context, BW_FORMAT, "more bytes than it can hold", parse(context, bytes, count));
  bytes[20 + 5] = 0;
  bytes[20 + 1] = 17;
  sign(bytes, count);
  check_fails(context, BW_FORMAT, "more bytes than it can hold", parse(context, bytes, count));
  bytes[20 + 1] = 0;
  check_fails(context, BW_IO, "nowhere", bw_library_read(context, "/tmp/nowhere/x.bwm", &library));
  bw_free(bytes);
  bw_release(library);
}

/* Sections whose checksums are right, but not what they say. */
static void test_sections(void **state) {
  bw_context *context = check_context(state);
  bw_library *library = fixture_library(context, 1, true, 1, 8), *read = NULL;
  bwi_pack head, fits;
  bwi_pack_begin(&head, context);
  bwi_pack_begin(&fits, context);
  bwi_pack_head(&head, library->material_table, &library->options);
  for (int32_t f = 0; f < library->fit_count[0]; f++)
    bwi_pack_fit(&fits, library->inner->fit[0][f], &library->error[0][f]);
  bwi_file_section section[BWI_SECTIONS] = {{head.bytes, head.count}, {fits.bytes, fits.count}};
  check_ok(context, bwi_library_of_sections(context, "made", section, &read));
  fixture_same(library, read);
  bw_release(read);
  section[1].count -= 1;
  check_fails(context, BW_FORMAT, "made: in its fits: the data end early",
              bwi_library_of_sections(context, "made", section, &read));
  section[1].count = 200;
  head.bytes[0] = 8; /* seven materials, without a byte for them */
  check_fails(context, BW_FORMAT, "made: in its head",
              bwi_library_of_sections(context, "made", section, &read));
  head.bytes[0] = 200;
  check_fails(context, BW_FORMAT, "a material table of 199 materials",
              bwi_library_of_sections(context, "made", section, &read));
  head.bytes[0] = 2;
  section[1].count = fits.count;
  const double nan = NAN;
  memcpy(head.bytes + 4 + BW_NAME + 1, &nan, sizeof nan);
  check_fails(context, BW_FORMAT, "material 1 cannot be",
              bwi_library_of_sections(context, "made", section, &read));
  section[2] = section[1];
  memcpy(head.bytes + 4 + BW_NAME + 1, &library->material_table->material[1]->mu[0], sizeof nan);
  check_fails(context, BW_FORMAT, "data of a second",
              bwi_library_of_sections(context, "made", section, &read));
  bwi_pack_clear(&head);
  bwi_pack_clear(&fits);
  bw_release(library);
}

/* The ratio of two stiffnesses may be no double, though each of them is one. */
static void test_contrast(void **state) {
  bw_context *context = check_context(state);
  bw_library *library = fixture_library(context, 2, true, 1, 8), *read = NULL;
  const double soft = 1e-305;
  char *text;
  bwi_pack head, fits;
  bwi_pack_begin(&head, context);
  bwi_pack_begin(&fits, context);
  bwi_pack_head(&head, library->material_table, &library->options);
  for (int32_t f = 0; f < library->fit_count[0]; f++)
    bwi_pack_fit(&fits, library->inner->fit[0][f], &library->error[0][f]);
  memcpy(head.bytes + 4 + BW_NAME + 1, &soft, sizeof soft);
  bwi_file_section section[BWI_SECTIONS] = {{head.bytes, head.count}, {fits.bytes, fits.count}};
  check_ok(context, bwi_library_of_sections(context, "made", section, &read));
  check_ok(context, bw_library_describe(context, read, &text));
  assert_non_null(strstr(text, "2 materials, contrast 1e311"));
  assert_null(strstr(text, "2 materials, contrast 1e-"));
  bw_free(text);
  bw_release(read);
  bwi_pack_clear(&head);
  bwi_pack_clear(&fits);
  bw_release(library);
}

static void test_memory(void **state) {
  bw_context *context = check_context(state);
  bw_library *library = fixture_library(context, 1, true, 2, 8);
  size_t count;
  unsigned char *bytes = bytes_of(context, library, &count);
  for (int64_t n = 1;; n += n < 400 ? 1 : 13) {
    bw_library *read = NULL;
    char *text = NULL;
    int64_t blocks = bw_live_blocks();
    bw_fail_allocation(n, true);
    bw_status status = bw_library_parse(context, "x", bytes, count, &read);
    if (status == BW_OK)
      status = bw_library_write(context, read, path);
    if (status == BW_OK)
      status = bw_library_describe(context, read, &text);
    bw_fail_allocation(0, false);
    bw_release(read);
    bw_free(text);
    assert_int_equal(bw_live_blocks(), blocks);
    if (status == BW_OK)
      break;
    assert_int_equal(status, BW_MEMORY);
  }
  bw_free(bytes);
  bw_release(library);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      check_test(test_there_and_back), check_test(test_damage),   check_test(test_claims),
      check_test(test_sections),       check_test(test_contrast), check_test(test_memory),
  };
  int file = mkstemp(path);
  if (file < 0)
    return 1;
  close(file);
  int failed = cmocka_run_group_tests(tests, NULL, NULL);
  unlink(path);
  return failed;
}
