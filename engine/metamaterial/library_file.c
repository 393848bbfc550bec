/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* Library files (.bwm), little endian:
 *
 *   mark                8 bytes, the first not ASCII, with both kinds of line end: damage by
 *                       programs that treat it as text shows at once
 *   u32 version, u32 number of sections
 *   sections            tag of 4 letters, u64 length unpacked, u64 length packed, u32 CRC-32 of the
 *                       unpacked bytes, the bytes packed by zlib
 *   u32                 CRC-32 of all before it
 *
 * Sections: HEAD (material table, options), FIT1 and FIT2 (fits with their errors, one after the
 * other), TAB2 (what was chosen for level 2, and the tables of pairs); the last two are empty in a
 * library of one level, FIT1 too in one of none. Keys and symmetries follow from the material table
 * and are not stored. A library that was grown is of version 2 and has a fifth section, GROW: for
 * each of two levels u32 number, keys (8 or 64 bytes each, ascending), fits.
 *
 * A file that came from anywhere is read with care: lengths are compared with what is there and
 * with what they can be before memory is taken. */
#include <stdio.h>
#include <string.h>
#include <zlib.h>

#include "barwright/io.h"
#include "metamaterial/library.h"

enum {
  MARK_BYTES = 8,
  VERSION = 1,
  VERSION_GROWN = 2,
  FILE_HEAD = 16,
  SECTION_HEAD = 24,
  MAX_HEAD = 4096
};
static const unsigned char mark[MARK_BYTES] = {0x89, 'B', 'W', 'M', '\r', '\n', 0x1a, '\n'};
static const char tag[BWI_SECTIONS][5] = {"HEAD", "FIT1", "FIT2", "TAB2", "GROW"};

static uint32_t sum_of(uint32_t sum, const unsigned char *bytes, size_t count) {
  return (uint32_t)crc32_z(sum, bytes, count);
}

/* ---- writing ------------------------------------------------------------------------------- */

static void pack_stage(bwi_pack *pack, const bwi_levels *it, int s) {
  bwi_pack_u32(pack, (uint32_t)it->chosen_count[s]);
  for (int32_t k = 0; k < it->chosen_count[s]; k++)
    bwi_pack_u32(pack, (uint32_t)it->chosen[s][k]);
  bwi_pack_f32(pack, it->typical[s]);
  bwi_pack_f32(pack, it->max[s]);
}

static void pack_choice(bwi_pack *pack, unsigned representative) {
  bwi_pack_u8(pack, representative & 255);
  bwi_pack_u8(pack, representative >> 8);
}

static bw_status pack_tables(bwi_pack *pack, const bwi_levels *it, int32_t orbits) {
  bw_status status = BW_OK;
  int32_t *item = NULL, count;
  pack_stage(pack, it, 0);
  for (int32_t f = 0; f < orbits; f++)
    pack_choice(pack, it->nearest[f]);
  for (int s = 1; s < BWI_STAGES; s++) {
    pack_stage(pack, it, s);
    BW_TRY(bwi_levels_items(pack->context, it, s - 1, &item, &count));
    for (int32_t i = 0; i < count; i++)
      pack_choice(pack, it->table[s - 1][item[i]]);
    bw_free(item);
    item = NULL;
  }
done:
  bw_free(item);
  return status;
}

static void pack_grown(bwi_pack *pack, const bwi_grown *it) {
  bwi_pack_u32(pack, (uint32_t)it->count);
  bwi_pack_bytes(pack, it->key, (size_t)it->width * (size_t)it->count);
  for (int32_t f = 0; f < it->count; f++)
    bwi_pack_fit(pack, it->fit[f], &it->error[f]);
}

static bool is_grown(const bw_library *it) {
  return it->grown_count[0] + it->grown_count[1] > 0;
}

static bw_status pack_section(bwi_pack *pack, const bw_library *it, int section) {
  const bwi_library *inner = it->inner;
  if (section == 4)
    for (int l = 0; l < 2; l++)
      pack_grown(pack, &inner->grown[l]);
  else if (section == 0)
    bwi_pack_head(pack, it->material_table, &it->options);
  else if (section < 3)
    for (int32_t f = 0; f < it->fit_count[section - 1]; f++)
      bwi_pack_fit(pack, inner->fit[section - 1][f], &inner->error[section - 1][f]);
  else if (inner->levels)
    return pack_tables(pack, inner->levels, inner->keys->orbit_count);
  return pack->status;
}

static bw_status add_section(bwi_pack *file, const char *name, const bwi_pack *raw) {
  uLongf packed = compressBound((uLong)raw->count);
  unsigned char *bytes = BW_NEW(file->context, unsigned char, packed);
  if (!bytes)
    return BW_MEMORY;
  if (compress2(bytes, &packed, raw->bytes ? raw->bytes : (const Bytef *)"", (uLong)raw->count,
                9) != Z_OK) {
    bw_free(bytes);
    return bw_fail(file->context, BW_MEMORY, "no memory to compress %zu bytes", raw->count);
  }
  bwi_pack_bytes(file, name, 4);
  bwi_pack_u64(file, raw->count);
  bwi_pack_u64(file, packed);
  bwi_pack_u32(file, sum_of(0, raw->bytes ? raw->bytes : (const Bytef *)"", raw->count));
  bwi_pack_bytes(file, bytes, packed);
  bw_free(bytes);
  return file->status;
}

bw_status bw_library_write(bw_context *context, const bw_library *library, const char *path) {
  bw_status status = BW_OK;
  bw_writer *writer = NULL;
  bwi_pack file, raw;
  bwi_pack_begin(&file, context);
  bwi_pack_begin(&raw, context);
  bwi_pack_bytes(&file, mark, MARK_BYTES);
  int sections = is_grown(library) ? BWI_SECTIONS : BWI_SECTIONS - 1;
  bwi_pack_u32(&file, is_grown(library) ? VERSION_GROWN : VERSION);
  bwi_pack_u32(&file, (uint32_t)sections);
  for (int s = 0; s < sections; s++) {
    raw.count = 0;
    BW_TRY(pack_section(&raw, library, s));
    BW_TRY(raw.status);
    BW_TRY(add_section(&file, tag[s], &raw));
  }
  bwi_pack_u32(&file, sum_of(0, file.bytes, file.count));
  BW_TRY(file.status);
  BW_TRY(bw_writer_open(context, path, &writer));
  status = bw_writer_bytes(writer, file.bytes, file.count);
  if (status == BW_OK) {
    bw_writer *whole = writer;
    writer = NULL;
    status = bw_writer_commit(whole);
  }
done:
  bw_writer_discard(writer);
  bwi_pack_clear(&raw);
  bwi_pack_clear(&file);
  return status;
}

/* ---- sections ------------------------------------------------------------------------------ */

static bw_status unpack_fits(bw_context *context, const char *name, const bwi_file_section *section,
                             bw_library *it, int level) {
  bw_status status = BW_OK;
  bwi_unpack from = {context, name, "fits", section->bytes, section->bytes + section->count, false};
  for (int32_t f = 0; f < it->fit_count[level - 1]; f++) {
    if (f % 1024 == 0)
      BW_TRY(bw_check_cancel(context));
    BW_TRY(bwi_unpack_fit(&from, level, f, &it->inner->fit[level - 1][f],
                          &it->inner->error[level - 1][f]));
  }
  BW_TRY(bwi_unpack_end(&from));
done:
  return status;
}

/* Fits take at least so many bytes: what a file claims can be no more. */
static bw_status check_size(bwi_unpack *from, int64_t count, int64_t min, const char *what) {
  int64_t left = (int64_t)(from->end - from->at);
  if (from->short_of || count > left / min)
    return bwi_unpack_fail(from, "%lld %s do not fit into %lld bytes", (long long)count, what,
                           (long long)left);
  return BW_OK;
}

static bw_status unpack_stage(bwi_unpack *from, bwi_levels *it, int s, int32_t max) {
  bw_status status = BW_OK;
  uint32_t count = bwi_unpack_u32(from);
  if (count < 1 || count > (uint32_t)max)
    return bwi_unpack_fail(from, "%u representatives chosen; 1 to %d", count, (int)max);
  BW_TRY(check_size(from, count, 4, "representatives"));
  it->chosen[s] = BW_NEW(from->context, int32_t, count);
  if (!it->chosen[s])
    return BW_MEMORY;
  it->chosen_count[s] = (int32_t)count;
  for (uint32_t k = 0; k < count; k++)
    it->chosen[s][k] = (int32_t)bwi_unpack_u32(from);
  it->typical[s] = (float)bwi_unpack_f32(from);
  it->max[s] = (float)bwi_unpack_f32(from);
done:
  return status;
}

static bw_status unpack_choices(bwi_unpack *from, int32_t count, int32_t among,
                                uint16_t *representative) {
  for (int32_t i = 0; i < count; i++) {
    unsigned low = bwi_unpack_u8(from), r = low | bwi_unpack_u8(from) << 8;
    if (from->short_of)
      return bwi_unpack_end(from);
    if (r < 1 || (int32_t)r >= among)
      return bwi_unpack_fail(from, "entry %d of a table is %u; there are 1 to %d", (int)i + 1, r,
                             (int)among - 1);
    representative[i] = (uint16_t)r;
  }
  return BW_OK;
}

static bw_status unpack_pairs(bwi_unpack *from, bwi_levels *it, int s, int32_t max) {
  bw_status status = BW_OK;
  int32_t *item = NULL, count = 0;
  uint16_t *representative = NULL;
  int64_t pairs = (int64_t)it->count[s - 1] * it->count[s - 1];
  BW_TRY(unpack_stage(from, it, s, max));
  BW_TRY(check_size(from, (pairs - 1) / BWI_FLIPS, 2, "pairs"));
  BW_TRY(bwi_levels_expand_pairs(from->context, it, s));
  BW_TRY(bwi_levels_items(from->context, it, s - 1, &item, &count));
  BW_TRY(check_size(from, count, 2, "pairs"));
  representative = BW_NEW(from->context, uint16_t, count);
  BW_TRY_MEMORY(representative);
  BW_TRY(unpack_choices(from, count, it->count[s], representative));
  BW_TRY(bwi_levels_fill_table(from->context, it, s - 1, count, item, representative));
done:
  bw_free(item);
  bw_free(representative);
  return status;
}

static bw_status unpack_tables(bw_context *context, const char *name,
                               const bwi_file_section *section, bw_library *library) {
  bw_status status = BW_OK;
  bwi_unpack from = {context, name, "tables", section->bytes, section->bytes + section->count,
                     false};
  const bwi_keys *keys = library->inner->keys;
  int32_t orbits = keys->orbit_count, max = library->options.representatives;
  bwi_levels *it = BW_NEW0(context, bwi_levels, 1);
  if (!it)
    return BW_MEMORY;
  library->inner->levels = it;
  BW_TRY(unpack_stage(&from, it, 0, max));
  BW_TRY(check_size(&from, orbits, 2, "entries"));
  BW_TRY(bwi_levels_expand_cells(context, it, keys));
  it->nearest = BW_NEW(context, uint16_t, orbits);
  BW_TRY_MEMORY(it->nearest);
  BW_TRY(unpack_choices(&from, orbits, it->count[0], it->nearest));
  for (int s = 1; s < BWI_STAGES; s++)
    BW_TRY(unpack_pairs(&from, it, s, max));
  BW_TRY(bwi_unpack_end(&from));
done:
  return status;
}

/* Keys are of blocks that hold something, turned first, one behind the other. */
static bw_status check_grown_key(bwi_unpack *from, const bw_library *it, const bwi_grown *grown,
                                 int32_t entry) {
  size_t w = (size_t)grown->width;
  const uint8_t *key = grown->key + w * (size_t)entry;
  uint8_t first[64];
  int32_t solid = 0;
  for (size_t p = 0; p < w; p++) {
    if (key[p] >= it->material_table->count)
      return bwi_unpack_fail(from, "block %d has a material %d; there are 1 to %d", (int)entry + 1,
                             (int)key[p], (int)it->material_table->count - 1);
    solid += key[p] > 0;
  }
  bwi_key_first(grown->width, key, first);
  if (solid == 0 || memcmp(first, key, w) != 0 ||
      (entry > 0 && bwi_key_compare(grown->width, key - w, key) >= 0))
    return bwi_unpack_fail(from, "block %d is void, turned, or not in order", (int)entry + 1);
  return BW_OK;
}

static bw_status unpack_grown(bw_context *context, const char *name,
                              const bwi_file_section *section, bw_library *it) {
  bw_status status = BW_OK;
  bwi_unpack from = {context, name, "grown fits", section->bytes, section->bytes + section->count,
                     false};
  for (int level = 1; level <= 2 && section->count > 0; level++) {
    bwi_grown *grown = &it->inner->grown[level - 1];
    int32_t width = grown->width;
    uint32_t count = bwi_unpack_u32(&from);
    BW_TRY(check_size(&from, count, width + BWI_FIT_MIN_BYTES, "fits"));
    BW_TRY(bwi_grown_reserve(context, width, (int32_t)count, grown));
    const unsigned char *keys = bwi_unpack_bytes(&from, (size_t)width * count);
    if (count > 0 && keys)
      memcpy(grown->key, keys, (size_t)width * count);
    for (int32_t f = 0; f < grown->count; f++) {
      if (f % 1024 == 0)
        BW_TRY(bw_check_cancel(context));
      BW_TRY(check_grown_key(&from, it, grown, f));
      BW_TRY(bwi_unpack_fit(&from, level, f, &grown->fit[f], &grown->error[f]));
    }
  }
  BW_TRY(bwi_unpack_end(&from));
  bwi_library_show(it);
done:
  return status;
}

/* How many orbits there can be at least: 48 keys each at most. Not to number the keys of seven
 * materials for a file of some bytes. */
static bw_status check_orbits(bw_context *context, const char *name,
                              const bwi_file_section *section, int32_t base, bool voids) {
  double keys = 1, left = (double)section->count;
  for (int c = 0; c < 8; c++)
    keys *= base - !voids;
  if ((keys - 1) / BWI_SYMMETRIES > left / BWI_FIT_MIN_BYTES)
    return bw_fail(context, BW_FORMAT,
                   "%s: in its fits: %g bytes are too few for the blocks of %d materials", name,
                   left, (int)base - 1);
  return BW_OK;
}

bw_status bwi_library_of_sections(bw_context *context, const char *name,
                                  const bwi_file_section section[BWI_SECTIONS], bw_library **out) {
  bw_status status = BW_OK;
  bw_material_table *material_table = NULL;
  bw_library *it = NULL;
  bw_library_options options;
  bwi_unpack from = {context, name, "head", section[0].bytes, section[0].bytes + section[0].count,
                     false};
  BW_TRY(bwi_unpack_head(&from, &material_table, &options));
  if (options.levels > 0)
    BW_TRY(check_orbits(context, name, &section[1], material_table->count, options.voids));
  BW_TRY(bwi_library_begin(context, material_table, &options, &it));
  BW_TRY(unpack_fits(context, name, &section[1], it, 1));
  if (options.levels == 2) {
    BW_TRY(unpack_tables(context, name, &section[3], it));
    BW_TRY(bwi_library_reserve(context, it, 2, it->inner->levels->chosen_count[3]));
    BW_TRY(unpack_fits(context, name, &section[2], it, 2));
  } else if (section[2].count || section[3].count)
    BW_TRY(bwi_unpack_fail(&from, "one level, but data of a second"));
  BW_TRY(unpack_grown(context, name, &section[4], it));
  *out = it;
  it = NULL;
done:
  bw_release(it);
  bw_release(material_table);
  return status;
}

/* ---- reading ------------------------------------------------------------------------------- */

typedef struct packed_section {
  uint64_t raw, packed;
  uint32_t sum;
  const unsigned char *bytes;
} packed_section;

static bw_status fail(bw_context *context, const char *name, int64_t byte, const char *what) {
  bw_fail(context, BW_FORMAT, "%s: byte %lld: %s", name, (long long)byte, what);
  bw_detail_text(context, "file", name);
  bw_detail_number(context, "byte", (double)byte);
  return BW_FORMAT;
}

static bw_status find_sections(bw_context *context, const char *name, const unsigned char *bytes,
                               size_t count, packed_section section[BWI_SECTIONS]) {
  size_t known = count < MARK_BYTES ? count : MARK_BYTES;
  if (count == 0 || memcmp(bytes, mark, known) != 0)
    return fail(context, name, 0, "this is no library file of barwright (.bwm)");
  bwi_unpack from = {context, name, "file", bytes, bytes + count, false};
  bwi_unpack_bytes(&from, MARK_BYTES);
  uint32_t version = bwi_unpack_u32(&from), sections = bwi_unpack_u32(&from);
  if (!from.short_of && version != VERSION && version != VERSION_GROWN) {
    char text[128];
    snprintf(text, sizeof text,
             "library file of version %u; this barwright reads versions %d and %d", version,
             VERSION, VERSION_GROWN);
    return fail(context, name, MARK_BYTES, text);
  }
  uint32_t there = version == VERSION_GROWN ? BWI_SECTIONS : BWI_SECTIONS - 1;
  if (!from.short_of && sections != there)
    return fail(context, name, MARK_BYTES + 4, "the number of sections is wrong: damaged");
  memset(section, 0, BWI_SECTIONS * sizeof *section);
  for (uint32_t s = 0; s < there; s++) {
    int64_t at = (int64_t)(from.at - bytes);
    const unsigned char *its = bwi_unpack_bytes(&from, 4);
    section[s].raw = bwi_unpack_u64(&from);
    section[s].packed = bwi_unpack_u64(&from);
    section[s].sum = bwi_unpack_u32(&from);
    if (its && memcmp(its, tag[s], 4) != 0)
      return fail(context, name, at, "another section was expected here: damaged");
    section[s].bytes = section[s].packed > (size_t)(from.end - from.at)
                           ? NULL
                           : bwi_unpack_bytes(&from, (size_t)section[s].packed);
    if (from.short_of || !section[s].bytes)
      return fail(context, name, (int64_t)count, "the file is cut short, or a length in it wrong");
    /* zlib makes a byte of at most 1032. */
    if (section[s].raw > 1032 * section[s].packed + 1032 || (s == 0 && section[s].raw > MAX_HEAD))
      return fail(context, name, at, "a section claims more bytes than it can hold: damaged");
  }
  uint32_t whole = bwi_unpack_u32(&from);
  if (from.short_of)
    return fail(context, name, (int64_t)count, "the file is cut short");
  if (from.at != from.end)
    return fail(context, name, (int64_t)(from.at - bytes), "bytes follow the end of the library");
  if (whole != sum_of(0, bytes, count - 4))
    return fail(context, name, 0, "the checksum is wrong: the file is damaged");
  return BW_OK;
}

bw_status bw_library_parse(bw_context *context, const char *name, const unsigned char *bytes,
                           size_t count, bw_library **library) {
  packed_section packed[BWI_SECTIONS];
  bwi_file_section section[BWI_SECTIONS];
  unsigned char *raw[BWI_SECTIONS] = {NULL};
  bw_status status = find_sections(context, name, bytes, count, packed);
  if (status != BW_OK)
    return status;
  for (int s = 0; s < BWI_SECTIONS; s++)
    section[s] = (bwi_file_section){bytes, 0}; /* an older version lacks the last one */
  for (int s = 0; s < BWI_SECTIONS && packed[s].bytes; s++) {
    uLongf size = (uLongf)packed[s].raw;
    uLong used = (uLong)packed[s].packed;
    raw[s] = BW_NEW(context, unsigned char, packed[s].raw);
    BW_TRY_MEMORY(raw[s]);
    int code = uncompress2(raw[s], &size, packed[s].bytes, &used);
    if (code == Z_MEM_ERROR)
      BW_TRY(bw_fail(context, BW_MEMORY, "%s: no memory to unpack it", name));
    if (code != Z_OK || size != packed[s].raw || used != packed[s].packed ||
        packed[s].sum != sum_of(0, raw[s], size))
      BW_TRY(fail(context, name, (int64_t)(packed[s].bytes - bytes), "a section is damaged"));
    section[s] = (bwi_file_section){raw[s], size};
  }
  status = bwi_library_of_sections(context, name, section, library);
done:
  for (int s = 0; s < BWI_SECTIONS; s++)
    bw_free(raw[s]);
  return status;
}

bw_status bw_library_read(bw_context *context, const char *path, bw_library **library) {
  unsigned char *bytes = NULL;
  size_t count = 0;
  bw_status status = bw_read_file(context, path, &bytes, &count);
  if (status == BW_OK)
    status = bw_library_parse(context, path, bytes, count, library);
  bw_free(bytes);
  return status;
}
