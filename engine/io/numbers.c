/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* Numbers as text, independent of the locale.
 *
 * Reading is correctly rounded. A decimal of up to 19 digits and a power of ten of up to 27 either
 * way, which is nearly every number in a mesh file, is w 10^q = w 5^q 2^q with w and 5^|q| below
 * 2^64: the product, or the quotient with its remainder as a sticky bit, is exact in 128 bits, and
 * one rounding to 53 bits is left to do. The rest goes to strtod in the C locale. */
#include "io/internal.h"

#include <math.h>
#include <pthread.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "io/locale.h"

static locale_t c_locale;

static void make_c_locale(void) {
  c_locale = newlocale(LC_ALL_MASK, "C", (locale_t)0);
  if (!c_locale)
    c_locale = LC_GLOBAL_LOCALE;
}

locale_t bwi_c_locale(void) {
  static pthread_once_t once = PTHREAD_ONCE_INIT;
  pthread_once(&once, make_c_locale);
  return c_locale;
}

/* ---- reading ------------------------------------------------------------------------------- */

enum { FIVE_POWERS = 27, LONGEST_NUMBER = 1000 };

static uint64_t five_to(int n) {
  static const uint64_t power[FIVE_POWERS + 1] = {
      1ull,
      5ull,
      25ull,
      125ull,
      625ull,
      3125ull,
      15625ull,
      78125ull,
      390625ull,
      1953125ull,
      9765625ull,
      48828125ull,
      244140625ull,
      1220703125ull,
      6103515625ull,
      30517578125ull,
      152587890625ull,
      762939453125ull,
      3814697265625ull,
      19073486328125ull,
      95367431640625ull,
      476837158203125ull,
      2384185791015625ull,
      11920928955078125ull,
      59604644775390625ull,
      298023223876953125ull,
      1490116119384765625ull,
      7450580596923828125ull,
  };
  return power[n];
}

__extension__ typedef unsigned __int128 wide;

static int bits_of(wide value) {
  uint64_t high = (uint64_t)(value >> 64), low = (uint64_t)value;
  return high ? 128 - __builtin_clzll(high) : low ? 64 - __builtin_clzll(low) : 0;
}

/* value 2^exponent rounded to nearest, ties to even; `sticky`: a little more than value. */
static double round_wide(wide value, int exponent, bool sticky) {
  int drop = bits_of(value) - 53;
  if (drop > 0) {
    wide rest = value & (((wide)1 << drop) - 1), half = (wide)1 << (drop - 1);
    value >>= drop;
    exponent += drop;
    if (rest > half || (rest == half && (sticky || (value & 1))))
      value++;
  }
  return ldexp((double)(uint64_t)value, exponent);
}

/* w 10^q for |q| <= FIVE_POWERS: far from overflow and from subnormal numbers. */
static double scale_ten(uint64_t w, int q) {
  if (w == 0)
    return 0;
  if (q >= 0)
    return round_wide((wide)w * five_to(q), q, false);
  /* The quotient of a numerator of 127 or 128 bits and a divisor of up to 63 has at least 64. */
  int up = 64 + __builtin_clzll(w);
  wide numerator = (wide)w << up, divisor = five_to(-q);
  wide quotient = numerator / divisor;
  return round_wide(quotient, q - up, quotient * divisor != numerator);
}

static bool is_digit(const unsigned char *at, const unsigned char *end) {
  return at < end && *at >= '0' && *at <= '9';
}

static bool starts_nocase(const unsigned char *at, const unsigned char *end, const char *text) {
  for (; *text; text++, at++)
    if (at >= end || (*at | 0x20) != *text)
      return false;
  return true;
}

/* nan, nan(...), inf, infinity, 1.#INF, 1.#QNAN, 1.#IND: `at` behind the sign. */
static const unsigned char *behind_not_finite(const unsigned char *at, const unsigned char *end) {
  bool word = starts_nocase(at, end, "nan") || starts_nocase(at, end, "inf");
  bool hash = end - at > 3 && at[0] == '1' && at[1] == '.' && at[2] == '#';
  if (!word && !hash)
    return NULL;
  while (at<end && * at> ' ' && *at != ',')
    at++;
  return at;
}

/* The general case. The number has been checked to be digits with at most a point and an exponent,
 * so that nothing else that strtod knows (hexadecimal, words) gets there. */
static bwi_number_kind parse_general(const unsigned char *at, const unsigned char *after,
                                     double *value) {
  char text[LONGEST_NUMBER + 1];
  size_t length = (size_t)(after - at);
  if (length > LONGEST_NUMBER)
    return BWI_NOT_A_NUMBER;
  for (size_t i = 0; i < length; i++)
    text[i] = at[i] == 'd' || at[i] == 'D' ? 'e' : (char)at[i];
  text[length] = 0;
  *value = strtod_l(text, NULL, bwi_c_locale());
  return isfinite(*value) ? BWI_NUMBER : BWI_NOT_FINITE;
}

bwi_number_kind bwi_parse_real(const unsigned char *at, const unsigned char *end, double *value,
                               const unsigned char **after) {
  const unsigned char *start = at;
  bool negative = false;
  if (at < end && (*at == '+' || *at == '-'))
    negative = *at++ == '-';
  uint64_t w = 0;
  int digits = 0; /* significant ones in w */
  int64_t q = 0;
  bool any = false, fits = true;
  for (int part = 0; part < 2; part++) {
    for (; is_digit(at, end); at++) {
      any = true;
      if (digits > 0 || *at != '0') {
        if (digits < 19) {
          w = 10 * w + (uint64_t)(*at - '0');
          digits++;
        } else {
          fits = false;
        }
      }
      q -= part;
    }
    if (part == 0 && at < end && *at == '.')
      at++;
    else
      break;
  }
  const unsigned char *word = any ? NULL : behind_not_finite(at, end);
  if (any && at < end && *at == '#')
    word = behind_not_finite(start + (*start == '+' || *start == '-'), end);
  if (word) {
    *after = word;
    return BWI_NOT_FINITE;
  }
  *after = at;
  if (!any)
    return BWI_NOT_A_NUMBER;
  if (at < end && (*at == 'e' || *at == 'E' || *at == 'd' || *at == 'D')) {
    const unsigned char *mark = at++;
    bool minus = false;
    if (at < end && (*at == '+' || *at == '-'))
      minus = *at++ == '-';
    if (is_digit(at, end)) {
      int64_t exponent = 0;
      for (; is_digit(at, end); at++)
        if (exponent < 1000000)
          exponent = 10 * exponent + (*at - '0');
      q += minus ? -exponent : exponent;
    } else {
      at = mark;
    }
  }
  *after = at;
  if (fits && q >= -FIVE_POWERS && q <= FIVE_POWERS) {
    double size = scale_ten(w, (int)q);
    *value = negative ? -size : size;
    return BWI_NUMBER;
  }
  return parse_general(start, at, value);
}

bool bwi_parse_integer(const unsigned char *at, const unsigned char *end, int64_t *value,
                       const unsigned char **after) {
  bool negative = false;
  if (at < end && (*at == '+' || *at == '-'))
    negative = *at++ == '-';
  if (!is_digit(at, end))
    return false;
  uint64_t size = 0;
  for (; is_digit(at, end); at++)
    if (__builtin_mul_overflow(size, (uint64_t)10, &size) ||
        __builtin_add_overflow(size, (uint64_t)(*at - '0'), &size) || size > INT64_MAX)
      return false;
  *value = negative ? -(int64_t)size : (int64_t)size;
  *after = at;
  return true;
}

bool bw_parse_number(const char *text, double *value) {
  const unsigned char *after, *at = (const unsigned char *)text, *end = at + strlen(text);
  return bwi_parse_real(at, end, value, &after) == BWI_NUMBER && after == end;
}

/* ---- writing ------------------------------------------------------------------------------- */

int bw_format_number(double value, char text[BW_NUMBER_BYTES]) {
  if (fabs(value) < 1e15 && value == (double)(int64_t)value && !(value == 0 && signbit(value)))
    return snprintf(text, BW_NUMBER_BYTES, "%lld", (long long)value);
  if (!isfinite(value))
    return snprintf(text, BW_NUMBER_BYTES, "%s", isnan(value) ? "nan" : value > 0 ? "inf" : "-inf");
  locale_t before = uselocale(bwi_c_locale());
  int length = 0;
  for (int digits = 15; digits <= 17; digits++) {
    double again;
    length = snprintf(text, BW_NUMBER_BYTES, "%.*g", digits, value);
    if (digits == 17 || (bw_parse_number(text, &again) && again == value))
      break;
  }
  uselocale(before);
  return length;
}
