/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* What an unknown name may have been meant for: every "did you mean" of bindings, Lua files and
 * program comes from here.
 *
 * A name is suggested where it resembles the word: where a third of the longer of both or less is
 * slips of the hand (a letter more, less or wrong, two neighbours swapped; capitals count for
 * nothing), or where one of them begins with the other. Otherwise a guess would mislead, and the
 * known names are listed in its place, unless they are too many to be read. */
#include "bind.h"

#include <limits.h>
#include <string.h>

enum {
  LONGEST_WORD = 63, /* what is compared of a word */
  MIN_COMMON = 3,    /* letters that a beginning must have to tell something */
  MAX_LISTED = 24
};

/* Letters as numbers, those of ASCII without capitals; dashes in front, which all options have,
 * left out. What is not UTF-8 counts byte by byte. */
static int letters(const char *word, unsigned out[LONGEST_WORD]) {
  const unsigned char *at = (const unsigned char *)word + strspn(word, "-");
  int count = 0;
  while (*at && count < LONGEST_WORD) {
    unsigned letter = *at++;
    if (letter >= 'A' && letter <= 'Z')
      letter += 'a' - 'A';
    for (int k = 0; letter >= 0xC0 && k < 3 && (*at & 0xC0) == 0x80; k++)
      letter = letter << 6 | (*at++ & 0x3F);
    out[count++] = letter;
  }
  return count;
}

/* Edit distance where a swap of neighbours counts once (Damerau and Levenshtein). */
static int edit_distance(const unsigned *a, int n, const unsigned *b, int m) {
  int row[3][LONGEST_WORD + 1];
  int *before = row[0], *last = row[1], *now = row[2];
  for (int j = 0; j <= m; j++)
    before[j] = last[j] = j;
  for (int i = 1; i <= n; i++) {
    now[0] = i;
    for (int j = 1; j <= m; j++) {
      int best = last[j - 1] + (a[i - 1] != b[j - 1]);
      if (last[j] + 1 < best)
        best = last[j] + 1;
      if (now[j - 1] + 1 < best)
        best = now[j - 1] + 1;
      if (i > 1 && j > 1 && a[i - 1] == b[j - 2] && a[i - 2] == b[j - 1] &&
          before[j - 2] + 1 < best)
        best = before[j - 2] + 1;
      now[j] = best;
    }
    int *spare = before;
    before = last;
    last = now;
    now = spare;
  }
  return last[m];
}

/* Two words of one letter each have nothing in common but that. */
static bool resemble(const unsigned *a, int n, const unsigned *b, int m, int distance) {
  int longer = n > m ? n : m, shorter = n > m ? m : n;
  int max = longer < 3 ? 1 : longer / 3;
  if (distance <= max && distance < longer)
    return true;
  return shorter >= MIN_COMMON && memcmp(a, b, (size_t)shorter * sizeof *a) == 0;
}

const char *lbw_nearest(const char *word, const char *const *candidate, size_t count) {
  unsigned a[LONGEST_WORD], b[LONGEST_WORD];
  int n = letters(word, a);
  const char *best = NULL;
  int min = INT_MAX;
  for (size_t i = 0; i < count; i++) {
    int m = letters(candidate[i], b);
    int distance = edit_distance(a, n, b, m);
    if (!resemble(a, n, b, m, distance))
      continue;
    /* Ties go to the alphabet: the order of a table must not show. */
    if (distance < min || (distance == min && strcmp(candidate[i], best) < 0)) {
      min = distance;
      best = candidate[i];
    }
  }
  return best;
}

/* The name that comes after `last` in the alphabet (the first for NULL); NULL: there is none. */
static const char *next_name(const char *last, const char *const *candidate, size_t count) {
  const char *found = NULL;
  for (size_t i = 0; i < count; i++)
    if ((!last || strcmp(candidate[i], last) > 0) && (!found || strcmp(candidate[i], found) < 0))
      found = candidate[i];
  return found;
}

const char *lbw_suggestion(lua_State *L, const char *word, const char *const *candidate,
                           size_t count) {
  const char *near = lbw_nearest(word, candidate, count);
  if (near) /* options of a command line stand for themselves */
    return lua_pushfstring(L, near[0] == '-' ? "did you mean %s?" : "did you mean '%s'?", near);
  if (count == 0)
    return lua_pushliteral(L, "there are none");
  if (count > MAX_LISTED)
    return lua_pushfstring(L, "none of the %d known names resembles it", (int)count);
  luaL_Buffer text;
  luaL_buffinit(L, &text);
  luaL_addstring(&text, count == 1 ? "known is only " : "known are ");
  const char *name = next_name(NULL, candidate, count);
  for (const char *comma = ""; name; comma = ", ", name = next_name(name, candidate, count)) {
    luaL_addstring(&text, comma);
    luaL_addstring(&text, name);
  }
  luaL_pushresult(&text);
  return lua_tostring(L, -1);
}

/* suggestion(word, names): the rest of a sentence that says that there is no such name */
static int core_suggestion(lua_State *L) {
  const char *word = lbw_check_text(L, 1, NULL);
  lbw_check_type(L, 2, LUA_TTABLE);
  size_t count = lua_rawlen(L, 2);
  const char **candidate = (const char **)lua_newuserdatauv(L, (count + 1) * sizeof *candidate, 0);
  for (size_t i = 0; i < count; i++) {
    lua_rawgeti(L, 2, (lua_Integer)i + 1);
    candidate[i] = lbw_check_text(L, -1, NULL);
    lua_pop(L, 1); /* the table keeps the string alive */
  }
  lbw_suggestion(L, word, candidate, count);
  return 1;
}

static const luaL_Reg functions[] = {{"suggestion", core_suggestion}, {NULL, NULL}};

void lbw_open_suggestions(lua_State *L) {
  luaL_setfuncs(L, functions, 0);
}
