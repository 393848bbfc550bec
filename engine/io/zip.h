/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* ZIP archives: members that are stored or deflated, sizes of 64 bits in the directory. */
#ifndef BWI_IO_ZIP_H
#define BWI_IO_ZIP_H

#include "io/internal.h"

/* The most that deflate packs into one byte. */
enum { BWI_DEFLATE_RATIO = 1032 };

typedef struct bwi_zip_member {
  const char *name; /* that is looked for */
  bool found;
  uint16_t method;
  uint32_t crc;
  uint64_t packed, size, at; /* at: of its local header */
} bwi_zip_member;

bool bwi_is_zip(const bwi_cursor *cursor);
/* Looks for `count` members by their names, in any case of letters where `nocase`. */
bw_status bwi_zip_find(const bwi_cursor *archive, bool nocase, int count, bwi_zip_member *list);
/* The bytes of a member that was found, checked by its checksum; *owned to be freed, where they had
 * to be unpacked. A size that the packed bytes cannot give is refused before it is allocated. */
bw_status bwi_zip_open(const bwi_cursor *archive, const bwi_zip_member *member,
                       const unsigned char **bytes, unsigned char **owned);

/* What a member is written from: two blocks, one behind the other. The first may be empty. */
typedef struct bwi_zip_part {
  const char *name;
  const void *head;
  size_t head_count;
  const void *bytes;
  size_t count;
  bool deflate;
  uint16_t method; /* these are filled in */
  uint32_t crc, packed, at;
} bwi_zip_part;

/* Writes a whole archive. Its date is the first of 1980: the same parts give the same bytes.
 * BW_LIMIT beyond 4 GB. */
bw_status bwi_zip_write(bw_writer *writer, bwi_zip_part *list, int count);

#endif
