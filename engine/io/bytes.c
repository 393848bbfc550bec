/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* Whole files in memory, and the cursor that all readers move over them. */
#include "barwright/confine.h"
#include "io/internal.h"

#include <errno.h>
#include <fcntl.h>
#include <math.h>
#include <stdio.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

/* Far above any mesh that 2^31 nodes allow in practice; keeps a stray disk image out. */
#define FILE_LIMIT ((int64_t)4 << 30)

/* ---- whole files --------------------------------------------------------------------------- */

static bw_status fail_file(bw_context *context, bw_status status, const char *path,
                           const char *text) {
  bw_fail(context, status, "%s: cannot be read: %s", path, text);
  bw_detail_text(context, "file", path);
  return status;
}

static bw_status fail_errno(bw_context *context, const char *path) {
  char text[128];
  return fail_file(context, BW_IO, path, strerror_r(errno, text, sizeof text));
}

static bw_status read_open_file(bw_context *context, const char *path, int file,
                                unsigned char **bytes, size_t *count) {
  bw_status status = BW_OK;
  struct stat about;
  if (fstat(file, &about) != 0)
    return fail_errno(context, path);
  if (S_ISDIR(about.st_mode))
    return fail_file(context, BW_IO, path, "it is a directory");
  if (!S_ISREG(about.st_mode))
    return fail_file(context, BW_IO, path, "it is not a regular file");
  if (about.st_size > FILE_LIMIT) {
    char text[120];
    snprintf(text, sizeof text, "it has %lld bytes; the limit is %lld", (long long)about.st_size,
             (long long)FILE_LIMIT);
    return fail_file(context, BW_LIMIT, path, text);
  }
  size_t size = (size_t)about.st_size, have = 0;
  unsigned char *block = BW_NEW(context, unsigned char, size + 1);
  if (!block)
    return BW_MEMORY;
  while (have < size) {
    size_t want = size - have < ((size_t)16 << 20) ? size - have : (size_t)16 << 20;
    ssize_t got = read(file, block + have, want);
    if (got < 0 && errno == EINTR)
      continue;
    if (got < 0)
      BW_TRY(fail_errno(context, path));
    if (got == 0)
      break; /* the file was cut while it was read: the parser will see */
    have += (size_t)got;
    BW_TRY(bw_check_cancel(context));
  }
  block[have] = 0;
  *bytes = block;
  *count = have;
  return BW_OK;
done:
  bw_free(block);
  return status;
}

bw_status bw_read_file(bw_context *context, const char *path, unsigned char **bytes,
                       size_t *count) {
  bw_status status = bw_may_use(context, path, BW_TO_READ);
  if (status != BW_OK)
    return status;
  /* O_NONBLOCK: opening a pipe that nobody writes to must not wait. */
  int file = bw_open(path, O_RDONLY | O_NONBLOCK, 0);
  if (file < 0)
    return fail_errno(context, path);
  status = read_open_file(context, path, file, bytes, count);
  close(file);
  return status;
}

/* ---- cursor -------------------------------------------------------------------------------- */

void bwi_cursor_init(bwi_cursor *cursor, bw_context *context, const char *name,
                     const unsigned char *bytes, size_t count) {
  static const unsigned char none[1] = {0};
  *cursor = (bwi_cursor){context, name, bytes ? bytes : none, NULL, NULL, 1, false, false};
  cursor->at = cursor->begin;
  cursor->end = cursor->begin + count;
  if (count >= 3 && memcmp(bytes, "\xEF\xBB\xBF", 3) == 0)
    cursor->at += 3;
}

static bool is_blank(unsigned char c) {
  return c == ' ' || c == '\t' || c == '\v' || c == '\f';
}

void bwi_skip_blank(bwi_cursor *cursor) {
  while (cursor->at < cursor->end && is_blank(*cursor->at))
    cursor->at++;
}

bool bwi_skip_space(bwi_cursor *cursor) {
  for (; cursor->at < cursor->end; cursor->at++) {
    unsigned char c = *cursor->at;
    if (c == '\n')
      cursor->line++;
    else if (c == '\r')
      cursor->line += !(cursor->at + 1 < cursor->end && cursor->at[1] == '\n');
    else if (!is_blank(c))
      return true;
  }
  return false;
}

static const unsigned char *line_end(const bwi_cursor *cursor) {
  const unsigned char *at = cursor->at;
  while (at < cursor->end && *at != '\n' && *at != '\r')
    at++;
  return at;
}

void bwi_skip_line(bwi_cursor *cursor) {
  cursor->at = line_end(cursor);
  if (cursor->at == cursor->end)
    return;
  bool two = *cursor->at == '\r' && cursor->at + 1 < cursor->end && cursor->at[1] == '\n';
  cursor->at += two ? 2 : 1;
  cursor->line++;
}

bool bwi_next_line(bwi_cursor *cursor, bwi_cursor *line) {
  if (cursor->at == cursor->end)
    return false;
  *line = *cursor;
  line->end = line_end(cursor);
  line->is_line = true;
  bwi_skip_line(cursor);
  return true;
}

bool bwi_next_record(bwi_cursor *cursor, bwi_cursor *line) {
  while (bwi_next_line(cursor, line)) {
    const unsigned char *hash = bwi_left(line) ? memchr(line->at, '#', bwi_left(line)) : NULL;
    if (hash)
      line->end = hash;
    bwi_skip_blank(line);
    if (line->at < line->end)
      return true;
  }
  return false;
}

bwi_word bwi_peek_word(const bwi_cursor *cursor) {
  bwi_cursor at = *cursor;
  bwi_word word;
  bwi_next_word(&at, &word);
  return word;
}

bool bwi_next_word(bwi_cursor *cursor, bwi_word *word) {
  *word = (bwi_word){cursor->end, 0};
  if (!bwi_skip_space(cursor))
    return false;
  const unsigned char *at = cursor->at;
  while (at < cursor->end && !is_blank(*at) && *at != '\n' && *at != '\r')
    at++;
  *word = (bwi_word){cursor->at, (size_t)(at - cursor->at)};
  cursor->at = at;
  return true;
}

bool bwi_word_is(bwi_word word, const char *text) {
  return word.length == strlen(text) && memcmp(word.at, text, word.length) == 0;
}

bool bwi_word_is_nocase(bwi_word word, const char *text) {
  if (word.length != strlen(text))
    return false;
  for (size_t i = 0; i < word.length; i++) {
    unsigned char a = word.at[i], b = (unsigned char)text[i];
    a = a >= 'A' && a <= 'Z' ? (unsigned char)(a + 32) : a;
    b = b >= 'A' && b <= 'Z' ? (unsigned char)(b + 32) : b;
    if (a != b)
      return false;
  }
  return true;
}

const unsigned char *bwi_find(const bwi_cursor *cursor, const char *text) {
  return bwi_left(cursor) ? memmem(cursor->at, bwi_left(cursor), text, strlen(text)) : NULL;
}

/* ---- failures ------------------------------------------------------------------------------ */

const char *bwi_show(bwi_word word) {
  enum { SHOWN = 40 };
  static _Thread_local char buffer[4][4 * SHOWN + 4];
  static _Thread_local int next;
  char *text = buffer[next = (next + 1) % 4], *to = text;
  for (size_t i = 0; i < word.length && i < SHOWN; i++) {
    unsigned char c = word.at[i];
    if (c >= 32 && c < 127)
      *to++ = (char)c;
    else
      to += snprintf(to, 5, "\\x%02x", c);
  }
  memcpy(to, word.length > SHOWN ? "..." : "", word.length > SHOWN ? 4 : 1);
  return text;
}

bw_status bwi_fail_line(const bwi_cursor *cursor, const char *format, ...) {
  char text[1024];
  va_list arguments;
  va_start(arguments, format);
  vsnprintf(text, sizeof text, format, arguments);
  va_end(arguments);
  bw_fail(cursor->context, BW_FORMAT, "%s:%lld: %s", cursor->name, (long long)cursor->line, text);
  bw_detail_text(cursor->context, "file", cursor->name);
  bw_detail_number(cursor->context, "line", (double)cursor->line);
  return BW_FORMAT;
}

bw_status bwi_fail_byte(const bwi_cursor *cursor, const char *format, ...) {
  char text[1024];
  va_list arguments;
  va_start(arguments, format);
  vsnprintf(text, sizeof text, format, arguments);
  va_end(arguments);
  long long byte = (long long)(cursor->at - cursor->begin);
  bw_fail(cursor->context, BW_FORMAT, "%s: byte %lld: %s", cursor->name, byte, text);
  bw_detail_text(cursor->context, "file", cursor->name);
  bw_detail_number(cursor->context, "byte", (double)byte);
  return BW_FORMAT;
}

bw_status bwi_fail_word(const bwi_cursor *cursor, bwi_word found, const char *expected) {
  if (found.length == 0)
    return bwi_fail_line(cursor, "the %s ends where %s was expected",
                         cursor->is_line ? "line" : "file", expected);
  return bwi_fail_line(cursor, "found '%s' where %s was expected", bwi_show(found), expected);
}

/* ---- numbers ------------------------------------------------------------------------------- */

static bool ends_word(const bwi_cursor *cursor, const unsigned char *at) {
  return at == cursor->end || is_blank(*at) || *at == '\n' || *at == '\r';
}

static bw_status fail_number(const bwi_cursor *cursor, const char *what) {
  bwi_word word = bwi_peek_word(cursor);
  double value;
  const unsigned char *after;
  bwi_number_kind kind = bwi_parse_real(word.at, word.at + word.length, &value, &after);
  if (word.length && kind == BWI_NOT_FINITE)
    return bwi_fail_line(cursor, "%s is '%s': a finite number was expected", what, bwi_show(word));
  if (kind == BWI_NUMBER && after < word.at + word.length && *after == ',')
    return bwi_fail_line(cursor, "%s is '%s': a decimal point, not a comma, was expected", what,
                         bwi_show(word));
  return bwi_fail_word(cursor, word, what);
}

bw_status bwi_read_real(bwi_cursor *cursor, double *value, const char *what) {
  const unsigned char *after;
  bwi_skip_space(cursor);
  if (bwi_parse_real(cursor->at, cursor->end, value, &after) != BWI_NUMBER ||
      !ends_word(cursor, after))
    return fail_number(cursor, what);
  cursor->at = after;
  return BW_OK;
}

bw_status bwi_read_any_real(bwi_cursor *cursor, double *value, const char *what) {
  bwi_word word = bwi_peek_word(cursor);
  const unsigned char *after;
  if (bwi_parse_real(word.at, word.at + word.length, value, &after) != BWI_NOT_FINITE)
    return bwi_read_real(cursor, value, what);
  bwi_next_word(cursor, &word);
  bool negative = *word.at == '-', sign = negative || *word.at == '+';
  unsigned char first = word.at[sign] | 0x20;
  bool infinite = first == 'i' || (word.at[sign] >= '0' && word.at[sign] <= '9');
  *value = infinite ? (negative ? -HUGE_VAL : HUGE_VAL) : (double)NAN;
  return BW_OK;
}

bw_status bwi_read_integer(bwi_cursor *cursor, int64_t *value, const char *what) {
  const unsigned char *after;
  bwi_skip_space(cursor);
  if (!bwi_parse_integer(cursor->at, cursor->end, value, &after) || !ends_word(cursor, after))
    return bwi_fail_word(cursor, bwi_peek_word(cursor), what);
  cursor->at = after;
  return BW_OK;
}

bw_status bwi_read_count(bwi_cursor *cursor, size_t min, int64_t *value, const char *what) {
  bwi_cursor before = *cursor;
  bw_status status = bwi_read_integer(cursor, value, what);
  if (status != BW_OK)
    return status;
  if (*value < 0)
    return bwi_fail_line(cursor, "%s is %lld: it cannot be negative", what, (long long)*value);
  before.line = cursor->line;
  before.at = cursor->at;
  return bwi_check_count(&before, (uint64_t)*value, min, what);
}

bw_status bwi_check_count(const bwi_cursor *cursor, uint64_t count, size_t min, const char *what) {
  /* The last record of a text may lack its final white space: one byte of grace. */
  if (min > 0 && count > (bwi_left(cursor) + 1) / min) {
    bw_status status = bwi_fail_line(
        cursor, "%s is %llu, but only %zu bytes follow: the file is cut short or the count wrong",
        what, (unsigned long long)count, bwi_left(cursor));
    bw_detail_number(cursor->context, "byte", (double)(cursor->at - cursor->begin));
    return status;
  }
  return BW_OK;
}

/* ---- binary -------------------------------------------------------------------------------- */

bw_status bwi_take(bwi_cursor *cursor, size_t count, const unsigned char **bytes,
                   const char *what) {
  if (count > bwi_left(cursor))
    return bwi_fail_byte(cursor, "%s takes %zu bytes, but only %zu are left: the file is cut short",
                         what, count, bwi_left(cursor));
  *bytes = cursor->at;
  cursor->at += count;
  return BW_OK;
}

uint16_t bwi_u16(const unsigned char *bytes, bool swap) {
  uint16_t value;
  memcpy(&value, bytes, sizeof value);
  return swap ? __builtin_bswap16(value) : value;
}

uint32_t bwi_u32(const unsigned char *bytes, bool swap) {
  uint32_t value;
  memcpy(&value, bytes, sizeof value);
  return swap ? __builtin_bswap32(value) : value;
}

uint64_t bwi_u64(const unsigned char *bytes, bool swap) {
  uint64_t value;
  memcpy(&value, bytes, sizeof value);
  return swap ? __builtin_bswap64(value) : value;
}

float bwi_f32(const unsigned char *bytes, bool swap) {
  uint32_t bits = bwi_u32(bytes, swap);
  float value;
  memcpy(&value, &bits, sizeof value);
  return value;
}

double bwi_f64(const unsigned char *bytes, bool swap) {
  uint64_t bits = bwi_u64(bytes, swap);
  double value;
  memcpy(&value, &bits, sizeof value);
  return value;
}
