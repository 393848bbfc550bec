/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* Text that grows, and numbers written alike in every locale. */
#include <locale.h>
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "model/internal.h"

void bwi_text_add(bwi_text *text, const char *string) {
  size_t length = strlen(string);
  if (text->failed)
    return;
  if (!bw_grow(text->context, (void **)&text->bytes, &text->capacity, text->count, length + 1, 1)) {
    text->failed = true;
    return;
  }
  memcpy(text->bytes + text->count, string, length + 1);
  text->count += length;
}

void bwi_number_string(char *buffer, size_t size, double value, int digits, double zero) {
  if (fabs(value) <= zero)
    value = 0; /* also -0 */
  char number[64];
  snprintf(number, sizeof number, "%.*g", digits, value);
  const char *point = localeconv()->decimal_point;
  char *at = point && strcmp(point, ".") ? strstr(number, point) : NULL;
  if (at)
    snprintf(buffer, size, "%.*s.%s", (int)(at - number), number, at + strlen(point));
  else
    snprintf(buffer, size, "%s", number);
}

void bwi_text_number(bwi_text *text, double value, int digits, double zero) {
  char number[64];
  bwi_number_string(number, sizeof number, value, digits, zero);
  bwi_text_add(text, number);
}

void bwi_text_integer(bwi_text *text, int64_t value) {
  char number[32];
  snprintf(number, sizeof number, "%lld", (long long)value);
  bwi_text_add(text, number);
}

void bwi_vector_string(char *buffer, size_t size, const double v[3], int digits, double zero) {
  char number[3][64];
  for (int k = 0; k < 3; k++)
    bwi_number_string(number[k], sizeof number[k], v[k], digits, zero);
  snprintf(buffer, size, "(%s, %s, %s)", number[0], number[1], number[2]);
}

void bwi_text_vector(bwi_text *text, const double v[3], int digits, double zero) {
  char vector[208];
  bwi_vector_string(vector, sizeof vector, v, digits, zero);
  bwi_text_add(text, vector);
}
