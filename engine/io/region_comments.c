/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* Names of regions in formats without names: comments "# region 3 insert". A name with a blank or a
 * quote at its beginning or end stands in quotes. */
#include <string.h>

#include "io/raw.h"

static bool needs_quotes(const char *name) {
  size_t length = strlen(name);
  return length > 0 &&
         (name[0] <= ' ' || name[0] == '"' || name[length - 1] <= ' ' || name[length - 1] == '"');
}

bw_status bwi_read_region_comment(bwi_cursor *line, bwi_raw *raw) {
  bwi_word word;
  int64_t tag;
  const unsigned char *after;
  if (!bwi_next_word(line, &word) || !bwi_word_is(word, "region") || !bwi_next_word(line, &word) ||
      !bwi_parse_integer(word.at, word.at + word.length, &tag, &after) ||
      after != word.at + word.length || tag < INT32_MIN || tag > INT32_MAX)
    return BW_OK;
  bwi_skip_blank(line);
  word = (bwi_word){line->at, bwi_left(line)};
  while (word.length && word.at[word.length - 1] <= ' ')
    word.length--;
  if (word.length > 2 && word.at[0] == '"' && word.at[word.length - 1] == '"')
    word = (bwi_word){word.at + 1, word.length - 2};
  return word.length ? bwi_raw_name_region(raw, (int32_t)tag, word) : BW_OK;
}

void bwi_write_region_comments(bw_writer *writer, const bw_mesh *mesh) {
  for (int32_t i = 0; i < mesh->region_count; i++) {
    const char *name = mesh->regions[i].name.text, *quote = needs_quotes(name) ? "\"" : "";
    if (!strpbrk(name, "\r\n"))
      bw_writer_print(writer, "# region %d %s%s%s\n", (int)mesh->regions[i].tag, quote, name,
                      quote);
  }
}
