/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* JSON (RFC 8259) as a list of values in the order of the text. */
#ifndef BWI_IO_JSON_H
#define BWI_IO_JSON_H

#include "io/internal.h"

typedef enum bwi_json_kind {
  BWI_JSON_NULL,
  BWI_JSON_FALSE,
  BWI_JSON_TRUE,
  BWI_JSON_NUMBER,
  BWI_JSON_STRING,
  BWI_JSON_ARRAY,
  BWI_JSON_OBJECT
} bwi_json_kind;

enum { BWI_JSON_DEPTH = 64 };

typedef struct bwi_json_value {
  bwi_json_kind kind;
  bwi_word key;  /* of a member of an object, without quotes, escapes as in the text */
  bwi_word text; /* as in the text; of a string without quotes; of lists their first bracket */
  double number;
  int32_t first, next, count; /* first element, next one of the same list, 0: none; elements */
} bwi_json_value;

/* Value 0 is the root. Keys and texts point into the bytes that were read. */
typedef struct bwi_json {
  bwi_json_value *value;
  size_t count, capacity;
} bwi_json;

/* The whole text from the cursor on; failures name the byte. Lists lie at most BWI_JSON_DEPTH deep
 * in each other. Release json->value with bw_free, also after a failure. */
bw_status bwi_json_parse(bwi_cursor *cursor, bwi_json *json);
/* The first member of this key, without escapes; 0 where there is none, or `of` is no object. */
int32_t bwi_json_member(const bwi_json *json, int32_t of, const char *key);
/* A string with its escapes decoded to UTF-8, cut to `size` bytes with the final 0. Returns its
 * whole length, like snprintf. */
size_t bwi_json_text(const bwi_json_value *value, char *text, size_t size);

#endif
