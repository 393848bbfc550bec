/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* A strict reader of JSON without recursion: the lists that are open are kept in an array. */
#include "io/json.h"

#include <string.h>

static void skip_space(bwi_cursor *cursor) {
  while (cursor->at < cursor->end &&
         (*cursor->at == ' ' || *cursor->at == '\t' || *cursor->at == '\n' || *cursor->at == '\r'))
    cursor->at++;
}

static bw_status fail(const bwi_cursor *cursor, const char *expected) {
  size_t left = bwi_left(cursor);
  if (left == 0)
    return bwi_fail_byte(cursor, "the JSON ends where %s was expected", expected);
  return bwi_fail_byte(cursor, "the JSON has '%s' where %s was expected",
                       bwi_show((bwi_word){cursor->at, left < 20 ? left : 20}), expected);
}

static bool accept(bwi_cursor *cursor, unsigned char c) {
  skip_space(cursor);
  if (cursor->at == cursor->end || *cursor->at != c)
    return false;
  cursor->at++;
  return true;
}

static int hex_digit(unsigned char c) {
  return c >= '0' && c <= '9'   ? c - '0'
         : c >= 'a' && c <= 'f' ? c - 'a' + 10
         : c >= 'A' && c <= 'F' ? c - 'A' + 10
                                : -1;
}

/* Behind the first quote, to behind the last. */
static bw_status read_string(bwi_cursor *cursor, bwi_word *word) {
  word->at = cursor->at;
  for (; cursor->at < cursor->end && *cursor->at != '"'; cursor->at++) {
    if (*cursor->at < 32)
      return fail(cursor, "a character of a string");
    if (*cursor->at != '\\')
      continue;
    cursor->at++;
    if (cursor->at == cursor->end || !strchr("\"\\/bfnrtu", *cursor->at) || *cursor->at == 0)
      return fail(cursor, "an escape (one of \"\\/bfnrtu)");
    for (int k = 0; *cursor->at == 'u' && k < 4; k++)
      if (bwi_left(cursor) < 6 || hex_digit(cursor->at[k + 1]) < 0)
        return fail(cursor, "an escape \\u with four hexadecimal digits");
  }
  if (cursor->at == cursor->end)
    return fail(cursor, "the end of a string");
  word->length = (size_t)(cursor->at++ - word->at);
  return BW_OK;
}

static const unsigned char *skip_digits(const unsigned char *at, const unsigned char *end) {
  while (at < end && *at >= '0' && *at <= '9')
    at++;
  return at;
}

/* The end of what the grammar allows, or NULL. */
static const unsigned char *number_end(const unsigned char *at, const unsigned char *end) {
  at += at < end && *at == '-';
  const unsigned char *after = skip_digits(at, end);
  if (after == at || (*at == '0' && after > at + 1))
    return NULL;
  at = after;
  if (at < end && *at == '.') {
    after = skip_digits(at + 1, end);
    if (after == at + 1)
      return NULL;
    at = after;
  }
  if (at < end && (*at | 0x20) == 'e') {
    at++;
    at += at < end && (*at == '+' || *at == '-');
    after = skip_digits(at, end);
    if (after == at)
      return NULL;
    at = after;
  }
  return at;
}

static bw_status read_number(bwi_cursor *cursor, bwi_json_value *value) {
  const unsigned char *end = number_end(cursor->at, cursor->end), *after;
  if (!end)
    return fail(cursor, "a value");
  if (bwi_parse_real(cursor->at, end, &value->number, &after) != BWI_NUMBER || after != end)
    return fail(cursor, "a number that a double can hold");
  value->kind = BWI_JSON_NUMBER;
  value->text = (bwi_word){cursor->at, (size_t)(end - cursor->at)};
  cursor->at = end;
  return BW_OK;
}

static bw_status read_value(bwi_cursor *cursor, bwi_json_value *value) {
  static const char *const word[] = {"null", "false", "true"};
  skip_space(cursor);
  value->text = (bwi_word){cursor->at, 1};
  if (accept(cursor, '{'))
    value->kind = BWI_JSON_OBJECT;
  else if (accept(cursor, '['))
    value->kind = BWI_JSON_ARRAY;
  else if (accept(cursor, '"')) {
    value->kind = BWI_JSON_STRING;
    return read_string(cursor, &value->text);
  } else {
    for (int k = 0; k < 3; k++) {
      size_t length = strlen(word[k]);
      if (bwi_left(cursor) < length || memcmp(cursor->at, word[k], length) != 0)
        continue;
      value->kind = (bwi_json_kind)(BWI_JSON_NULL + k);
      value->text.length = length;
      cursor->at += length;
      return BW_OK;
    }
    return read_number(cursor, value);
  }
  return BW_OK;
}

static bw_status read_key(bwi_cursor *cursor, bwi_word *key) {
  if (!accept(cursor, '"'))
    return fail(cursor, "a key in quotes");
  bw_status status = read_string(cursor, key);
  if (status == BW_OK && !accept(cursor, ':'))
    status = fail(cursor, "':'");
  return status;
}

/* Where a value is expected: appends it. *last: the element before it, 0: none. */
static bw_status append(bwi_cursor *cursor, bwi_json *json, int32_t parent, int32_t *last) {
  bw_status status = BW_OK;
  bwi_json_value value = {.kind = BWI_JSON_NULL};
  if (json->count >= INT32_MAX)
    return bwi_fail_byte(cursor, "the JSON has more than 2147483647 values");
  if (parent >= 0 && json->value[parent].kind == BWI_JSON_OBJECT)
    BW_TRY(read_key(cursor, &value.key));
  BW_TRY(read_value(cursor, &value));
  BW_TRY_MEMORY(bw_grow(cursor->context, (void **)&json->value, &json->capacity, json->count, 1,
                        sizeof value));
  int32_t own = (int32_t)json->count++;
  json->value[own] = value;
  if (parent >= 0) {
    *(*last ? &json->value[*last].next : &json->value[parent].first) = own;
    json->value[parent].count++;
  }
  *last = own;
done:
  return status;
}

bw_status bwi_json_parse(bwi_cursor *cursor, bwi_json *json) {
  bw_status status = BW_OK;
  int32_t open[BWI_JSON_DEPTH], last[BWI_JSON_DEPTH + 1] = {0};
  int depth = 0; /* open lists; last[depth]: the last element of the innermost one */
  BW_TRY(append(cursor, json, -1, &last[0]));
  for (bool opened = true;;) {
    int32_t newest = last[depth];
    if (opened && json->value[newest].kind >= BWI_JSON_ARRAY) {
      if (depth == BWI_JSON_DEPTH)
        return bwi_fail_byte(cursor, "the JSON has lists more than %d deep in each other",
                             BWI_JSON_DEPTH);
      open[depth++] = newest;
      last[depth] = 0;
    }
    if (depth == 0)
      break;
    int32_t parent = open[depth - 1];
    bool object = json->value[parent].kind == BWI_JSON_OBJECT;
    opened = !accept(cursor, object ? '}' : ']');
    if (!opened) {
      depth--;
      continue;
    }
    if (last[depth] && !accept(cursor, ','))
      return fail(cursor, object ? "',' or '}'" : "',' or ']'");
    if (json->count % 65536 == 0)
      BW_TRY(bw_check_cancel(cursor->context));
    BW_TRY(append(cursor, json, parent, &last[depth]));
  }
  skip_space(cursor);
  if (cursor->at < cursor->end)
    status = fail(cursor, "the end");
done:
  return status;
}

int32_t bwi_json_member(const bwi_json *json, int32_t of, const char *key) {
  if (json->value[of].kind != BWI_JSON_OBJECT)
    return 0;
  int32_t at = json->value[of].first;
  while (at && !bwi_word_is(json->value[at].key, key))
    at = json->value[at].next;
  return at;
}

/* ---- strings --------------------------------------------------------------------------------- */

static uint32_t four_digits(const unsigned char *at) {
  uint32_t code = 0;
  for (int k = 0; k < 4; k++)
    code = code << 4 | (uint32_t)hex_digit(at[k]);
  return code;
}

static int utf8(uint32_t code, unsigned char out[4]) {
  if (code < 0x80) {
    out[0] = (unsigned char)code;
    return 1;
  }
  int count = code < 0x800 ? 2 : code < 0x10000 ? 3 : 4;
  static const unsigned char lead[] = {0, 0, 0xC0, 0xE0, 0xF0};
  for (int k = count - 1; k > 0; k--, code >>= 6)
    out[k] = (unsigned char)(0x80 | (code & 0x3F));
  out[0] = (unsigned char)(lead[count] | code);
  return count;
}

/* The character at `at`, which is moved behind it, as bytes. */
static int next_character(const unsigned char **at, const unsigned char *end,
                          unsigned char out[4]) {
  static const char escape[] = "\"\\/bfnrt", meant[] = "\"\\/\b\f\n\r\t";
  if (**at != '\\') {
    out[0] = *(*at)++;
    return 1;
  }
  unsigned char c = (*at)[1];
  *at += 2;
  if (c != 'u') {
    out[0] = (unsigned char)meant[strchr(escape, c) - escape];
    return 1;
  }
  uint32_t code = four_digits(*at);
  *at += 4;
  bool high = code >= 0xD800 && code < 0xDC00;
  if (high && end - *at >= 6 && (*at)[0] == '\\' && (*at)[1] == 'u') {
    uint32_t low = four_digits(*at + 2);
    if (low >= 0xDC00 && low < 0xE000) {
      *at += 6;
      return utf8(0x10000 + ((code - 0xD800) << 10) + (low - 0xDC00), out);
    }
  }
  return utf8(code >= 0xD800 && code < 0xE000 ? 0xFFFD : code, out);
}

size_t bwi_json_text(const bwi_json_value *value, char *text, size_t size) {
  const unsigned char *at = value->text.at, *end = at + value->text.length;
  size_t length = 0, kept = 0;
  while (at < end) {
    unsigned char out[4];
    int count = next_character(&at, end, out);
    if (kept == length && length + (size_t)count < size) {
      memcpy(text + length, out, (size_t)count);
      kept += (size_t)count;
    }
    length += (size_t)count;
  }
  if (size > 0)
    text[kept] = 0;
  return length;
}
