/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* A reader of XML tags that looks no further than the tag at hand, since binary data may follow. */
#include "io/vtu.h"

#include <string.h>

static bool is_name(unsigned char c) {
  return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '_' ||
         c == '-' || c == ':' || c == '.';
}

static bwi_word take_name(bwi_cursor *cursor) {
  const unsigned char *start = cursor->at;
  while (cursor->at < cursor->end && is_name(*cursor->at))
    cursor->at++;
  return (bwi_word){start, (size_t)(cursor->at - start)};
}

/* Moves to `at`, counting the lines between. */
static void move_to(bwi_cursor *cursor, const unsigned char *at) {
  for (; cursor->at < at; cursor->at++)
    cursor->line += *cursor->at == '\n';
}

/* <!-- ... -->, <? ... >, <! ... >: cursor behind the '<'. */
static bool skip_aside(bwi_cursor *cursor) {
  if (cursor->at == cursor->end || (*cursor->at != '!' && *cursor->at != '?'))
    return false;
  bool comment = bwi_left(cursor) >= 3 && memcmp(cursor->at, "!--", 3) == 0;
  const char *stop = comment ? "-->" : ">";
  const unsigned char *found = bwi_find(cursor, stop);
  move_to(cursor, found ? found + strlen(stop) : cursor->end);
  return true;
}

static bw_status read_attribute(bwi_cursor *cursor, bwi_tag *tag) {
  bwi_word key = take_name(cursor);
  bwi_skip_space(cursor);
  if (key.length == 0 || cursor->at == cursor->end || *cursor->at != '=')
    return bwi_fail_word(cursor, bwi_peek_word(cursor), "name=\"value\" or the end of an XML tag");
  cursor->at++;
  bwi_skip_space(cursor);
  if (cursor->at == cursor->end || (*cursor->at != '"' && *cursor->at != '\''))
    return bwi_fail_word(cursor, bwi_peek_word(cursor), "a value in quotation marks");
  unsigned char quote = *cursor->at++;
  const unsigned char *stop = bwi_left(cursor) ? memchr(cursor->at, quote, bwi_left(cursor)) : NULL;
  if (!stop)
    return bwi_fail_line(cursor, "the file ends inside the value of '%s'", bwi_show(key));
  if (tag->count < BWI_XML_ATTRIBUTES) {
    tag->key[tag->count] = key;
    tag->value[tag->count++] = (bwi_word){cursor->at, (size_t)(stop - cursor->at)};
  }
  move_to(cursor, stop + 1);
  return BW_OK;
}

bw_status bwi_xml_next(bwi_cursor *cursor, bwi_tag *tag, bool *any) {
  memset(tag, 0, sizeof *tag);
  *any = false;
  do {
    const unsigned char *open = bwi_left(cursor) ? memchr(cursor->at, '<', bwi_left(cursor)) : NULL;
    if (!open) {
      cursor->at = cursor->end;
      return BW_OK;
    }
    move_to(cursor, open + 1);
  } while (skip_aside(cursor));
  if (cursor->at < cursor->end && *cursor->at == '/') {
    tag->closing = true;
    cursor->at++;
  }
  tag->name = take_name(cursor);
  if (tag->name.length == 0)
    return bwi_fail_word(cursor, bwi_peek_word(cursor), "the name of an XML tag");
  *any = true;
  while (bwi_skip_space(cursor)) {
    if (*cursor->at == '>') {
      cursor->at++;
      return BW_OK;
    }
    if (*cursor->at == '/') {
      tag->empty = true;
      cursor->at++;
      continue;
    }
    bw_status status = read_attribute(cursor, tag);
    if (status != BW_OK)
      return status;
  }
  return bwi_fail_line(cursor, "the file ends inside the XML tag '%s'", bwi_show(tag->name));
}

bwi_word bwi_xml_value(const bwi_tag *tag, const char *key) {
  for (int i = 0; i < tag->count; i++)
    if (bwi_word_is(tag->key[i], key))
      return tag->value[i];
  return (bwi_word){tag->name.at, 0};
}

void bwi_xml_decode(char *text) {
  static const char *const entity[5] = {"&amp;", "&lt;", "&gt;", "&quot;", "&apos;"};
  char *to = text;
  for (const char *at = text; *at;) {
    int found = -1;
    for (int i = 0; i < 5; i++)
      if (strncmp(at, entity[i], strlen(entity[i])) == 0)
        found = i;
    if (found >= 0) {
      *to++ = "&<>\"'"[found];
      at += strlen(entity[found]);
    } else {
      *to++ = *at++;
    }
  }
  *to = 0;
}
