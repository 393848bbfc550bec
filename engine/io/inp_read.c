/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* Abaqus and CalculiX decks: *NODE, *ELEMENT of type C3D4 or C3D10 (triangles S3, S6, STRI3, CPS3
 * ... and quadrilaterals S4, S8 make a surface), *NSET and *ELSET with GENERATE and names of other
 * sets. Regions are the sets of several *SOLID SECTION, or sets that divide the mesh. Other
 * keywords are passed over with their data. Keywords and parameters in either case;
 * "**" begins a comment; a line that ends in a comma goes on in the next one. */
#include "io/raw.h"

#include <string.h>

typedef struct inp {
  bwi_cursor *cursor;
  bwi_raw *raw;
  int64_t *node_id, *tet_id;
  size_t node_capacity, tet_capacity;
  bwi_ids nodes, tets;
  int64_t *number; /* of the element or set at hand */
  size_t number_count, number_capacity;
  size_t *section; /* sets of elements that *SOLID SECTION gives a material */
  size_t section_count, section_capacity;
} inp;

typedef struct keyword {
  bwi_word name, type, set; /* set: ELSET=, NSET= */
  bool generate, input;
} keyword;

static bwi_word trim(bwi_word word) {
  while (word.length && *word.at <= ' ')
    word.at++, word.length--;
  while (word.length && word.at[word.length - 1] <= ' ')
    word.length--;
  return word;
}

/* The next piece up to a comma; false at the end of the line. */
static bool next_item(bwi_cursor *line, bwi_word *item) {
  if (line->at >= line->end)
    return false;
  const unsigned char *comma = memchr(line->at, ',', bwi_left(line));
  const unsigned char *stop = comma ? comma : line->end;
  *item = trim((bwi_word){line->at, (size_t)(stop - line->at)});
  line->at = comma ? comma + 1 : line->end;
  return true;
}

/* The next line that is neither empty nor a comment. `keyword` lines begin with one star. */
static bool next_line(bwi_cursor *cursor, bwi_cursor *line) {
  while (bwi_next_line(cursor, line)) {
    bwi_skip_blank(line);
    bool comment = bwi_left(line) >= 2 && line->at[0] == '*' && line->at[1] == '*';
    if (line->at < line->end && !comment)
      return true;
  }
  return false;
}

/* The next data line; false before a keyword or the end. */
static bool next_data(bwi_cursor *cursor, bwi_cursor *line) {
  bwi_cursor before = *cursor;
  if (!next_line(cursor, line))
    return false;
  if (*line->at != '*')
    return true;
  *cursor = before;
  return false;
}

static bool ends_in_comma(const bwi_cursor *line) {
  bwi_word word = trim((bwi_word){line->at, bwi_left(line)});
  return word.length && word.at[word.length - 1] == ',';
}

static bwi_word parameter(bwi_word item, const char *name) {
  const unsigned char *equal = memchr(item.at, '=', item.length);
  bwi_word key = trim((bwi_word){item.at, equal ? (size_t)(equal - item.at) : 0});
  if (!equal || !bwi_word_is_nocase(key, name))
    return (bwi_word){item.at, 0};
  return trim((bwi_word){equal + 1, (size_t)(item.at + item.length - equal - 1)});
}

static void read_keyword(inp *deck, bwi_cursor *line, keyword *key) {
  bwi_word item, value;
  memset(key, 0, sizeof *key);
  bool comma = ends_in_comma(line);
  next_item(line, &key->name);
  for (bool more = true; more; comma = more && ends_in_comma(line)) {
    more = comma; /* the parameters go on in the next line */
    while (next_item(line, &item)) {
      if ((value = parameter(item, "TYPE")).length)
        key->type = value;
      if ((value = parameter(item, "ELSET")).length || (value = parameter(item, "NSET")).length)
        key->set = value;
      key->generate = key->generate || bwi_word_is_nocase(item, "GENERATE");
      key->input = key->input || parameter(item, "INPUT").length > 0;
    }
    more = more && next_data(deck->cursor, line);
  }
}

static bw_status item_integer(const bwi_cursor *line, bwi_word item, int64_t *value,
                              const char *what) {
  const unsigned char *after;
  if (!bwi_parse_integer(item.at, item.at + item.length, value, &after) ||
      after != item.at + item.length)
    return bwi_fail_line(line, "found '%s' where %s was expected", bwi_show(item), what);
  return BW_OK;
}

static bw_status item_real(const bwi_cursor *line, bwi_word item, double *value) {
  const unsigned char *after;
  *value = 0;
  if (item.length == 0) /* an empty field is 0 */
    return BW_OK;
  if (bwi_parse_real(item.at, item.at + item.length, value, &after) != BWI_NUMBER ||
      after != item.at + item.length)
    return bwi_fail_line(line, "found '%s' where a finite coordinate of a node was expected",
                         bwi_show(item));
  return BW_OK;
}

static bw_status set_of(inp *deck, const keyword *key, bool of_elements, size_t *set) {
  *set = SIZE_MAX;
  return key->set.length ? bwi_raw_find_set(deck->raw, key->set, of_elements, set) : BW_OK;
}

static bw_status read_nodes(inp *deck, const keyword *key) {
  bw_status status = BW_OK;
  bwi_cursor line;
  size_t set;
  BW_TRY(set_of(deck, key, false, &set));
  while (next_data(deck->cursor, &line)) {
    bwi_word item = {line.at, 0};
    int64_t id;
    double x[3];
    next_item(&line, &item);
    BW_TRY(item_integer(&line, item, &id, "the number of a node"));
    for (int k = 0; k < 3; k++) {
      if (!next_item(&line, &item))
        item.length = 0;
      BW_TRY(item_real(&line, item, &x[k]));
    }
    if (!bw_grow(deck->raw->context, (void **)&deck->node_id, &deck->node_capacity,
                 deck->raw->point_count, 1, sizeof *deck->node_id))
      return BW_MEMORY;
    deck->node_id[deck->raw->point_count] = id;
    if (set != SIZE_MAX)
      BW_TRY(bwi_raw_member(deck->raw, set, (int32_t)deck->raw->point_count));
    BW_TRY(bwi_raw_point(deck->raw, x));
    if (deck->raw->point_count % 65536 == 0)
      BW_TRY(bw_check_cancel(deck->raw->context));
  }
  bwi_ids_clear(&deck->nodes); /* rebuilt when next asked for */
done:
  return status;
}

static bw_status need_ids(inp *deck, bool of_elements) {
  bwi_ids *ids = of_elements ? &deck->tets : &deck->nodes;
  size_t count = of_elements ? deck->raw->tet_count : deck->raw->point_count;
  int64_t twice = 0;
  if (ids->id)
    return BW_OK;
  int64_t *copy = BW_NEW(deck->raw->context, int64_t, count);
  if (!copy)
    return BW_MEMORY;
  if (count)
    memcpy(copy, of_elements ? deck->tet_id : deck->node_id, count * sizeof *copy);
  bw_status status = bwi_ids_build(deck->raw->context, copy, count, ids, &twice);
  if (status == BW_FORMAT)
    bwi_fail_line(deck->cursor, "%s %lld is defined twice", of_elements ? "element" : "node",
                  (long long)twice);
  return status;
}

/* The numbers of a record of `count` items, which may go over several lines. */
static bw_status read_record(inp *deck, bwi_cursor *line, size_t count) {
  bw_status status = BW_OK;
  bwi_word item;
  deck->number_count = 0;
  for (;;) {
    while (next_item(line, &item)) {
      int64_t value;
      if (item.length == 0)
        continue;
      BW_TRY(item_integer(line, item, &value, "a number of a node or element"));
      if (!bw_grow(deck->raw->context, (void **)&deck->number, &deck->number_capacity,
                   deck->number_count, 1, sizeof *deck->number))
        return BW_MEMORY;
      deck->number[deck->number_count++] = value;
    }
    if (deck->number_count >= count || !next_data(deck->cursor, line))
      break;
  }
  if (deck->number_count != count)
    status = bwi_fail_line(line, "an element of %zu numbers where %zu were expected",
                           deck->number_count, count);
done:
  return status;
}

typedef struct shape {
  const char *type;
  int nodes, corners; /* corners 4 or 10 with tet, else of a facet; 0: neither */
  bool tet;
} shape;
static const shape shapes[] = {
    {"C3D4", 4, 4, true},     {"C3D10", 10, 10, true}, {"C3D10M", 10, 10, true},
    {"C3D10T", 10, 10, true}, {"C3D4T", 4, 4, true},   {"C3D10H", 10, 10, true},
    {"C3D4H", 4, 4, true},    {"S3", 3, 3, false},     {"S3R", 3, 3, false},
    {"STRI3", 3, 3, false},   {"CPS3", 3, 3, false},   {"CPE3", 3, 3, false},
    {"M3D3", 3, 3, false},    {"SFM3D3", 3, 3, false}, {"S6", 6, 3, false},
    {"STRI65", 6, 3, false},  {"CPS6", 6, 3, false},   {"M3D6", 6, 3, false},
    {"S4", 4, 4, false},      {"S4R", 4, 4, false},    {"M3D4", 4, 4, false},
    {"S8", 8, 4, false},      {"S8R", 8, 4, false},
};

static bw_status skip_elements(inp *deck, bwi_word type) {
  bwi_cursor line;
  bool go_on = false;
  static const char solid[] = "C3D";
  bool is_solid = type.length >= 3;
  for (size_t i = 0; i < 3 && is_solid; i++)
    is_solid = (type.at[i] & ~0x20) == (solid[i] & ~0x20);
  while (next_data(deck->cursor, &line)) {
    deck->raw->skipped += !go_on;
    deck->raw->solids += is_solid && !go_on;
    go_on = ends_in_comma(&line);
  }
  return BW_OK;
}

static bw_status read_elements(inp *deck, const keyword *key) {
  bw_status status = BW_OK;
  bwi_cursor line;
  const shape *kind = NULL;
  size_t set;
  for (size_t i = 0; i < sizeof shapes / sizeof *shapes; i++)
    if (bwi_word_is_nocase(key->type, shapes[i].type))
      kind = &shapes[i];
  if (!kind)
    return skip_elements(deck, key->type);
  BW_TRY(set_of(deck, key, true, &set));
  while (next_data(deck->cursor, &line)) {
    int32_t node[10];
    bwi_cursor start = line;
    BW_TRY(read_record(deck, &line, (size_t)kind->nodes + 1));
    BW_TRY(need_ids(deck, false));
    for (int k = 0; k < kind->corners; k++) {
      node[k] = bwi_ids_find(&deck->nodes, deck->number[k + 1]);
      if (node[k] < 0)
        BW_TRY(bwi_fail_line(&start, "element %lld names node %lld, which is not defined before it",
                             (long long)deck->number[0], (long long)deck->number[k + 1]));
    }
    if (!kind->tet) {
      BW_TRY(bwi_raw_facet(deck->raw, (size_t)kind->corners, node, 0));
      continue;
    }
    size_t place = deck->raw->tet_count;
    if (!bw_grow(deck->raw->context, (void **)&deck->tet_id, &deck->tet_capacity, place, 1,
                 sizeof *deck->tet_id))
      return BW_MEMORY;
    deck->tet_id[place] = deck->number[0];
    BW_TRY(bwi_raw_tet(deck->raw, kind->nodes, node, 0));
    if (set != SIZE_MAX)
      BW_TRY(bwi_raw_member(deck->raw, set, (int32_t)place));
    if (place % 65536 == 0)
      BW_TRY(bw_check_cancel(deck->raw->context));
  }
  bwi_ids_clear(&deck->tets);
done:
  return status;
}

/* Members that are no nodes or tetrahedra of the mesh (shells, reference points) are left out. */
static bw_status add_member(inp *deck, size_t set, bool of_elements, int64_t id) {
  int32_t place = bwi_ids_find(of_elements ? &deck->tets : &deck->nodes, id);
  return place < 0 ? BW_OK : bwi_raw_member(deck->raw, set, place);
}

/* first, last, step: only numbers that exist count, so the loop is over those. */
static bw_status generate(inp *deck, size_t set, bool of_elements, bwi_cursor *line) {
  bw_status status = BW_OK;
  int64_t value[3] = {0, 0, 1};
  bwi_word item;
  for (int k = 0; k < 3 && next_item(line, &item); k++)
    if (item.length)
      BW_TRY(item_integer(line, item, &value[k], "first, last and step of GENERATE"));
  if (value[2] < 1 || value[0] > value[1])
    BW_TRY(bwi_fail_line(line,
                         "GENERATE from %lld to %lld by %lld: first <= last and a positive "
                         "step were expected",
                         (long long)value[0], (long long)value[1], (long long)value[2]));
  size_t count = of_elements ? deck->raw->tet_count : deck->raw->point_count;
  const int64_t *id = of_elements ? deck->tet_id : deck->node_id;
  for (size_t i = 0; i < count; i++)
    if (id[i] >= value[0] && id[i] <= value[1] &&
        ((uint64_t)id[i] - (uint64_t)value[0]) % (uint64_t)value[2] == 0)
      BW_TRY(bwi_raw_member(deck->raw, set, (int32_t)i));
done:
  return status;
}

static bw_status include_set(inp *deck, size_t set, bool of_elements, bwi_word name,
                             const bwi_cursor *line) {
  for (size_t i = 0; i < deck->raw->set_count; i++) {
    if (deck->raw->set[i].of_elements != of_elements ||
        !bwi_word_is_nocase(name, deck->raw->set[i].name))
      continue;
    size_t count = deck->raw->set[i].count;
    if (i == set)
      return BW_OK;
    for (size_t k = 0; k < count; k++) {
      bw_status status = bwi_raw_member(deck->raw, set, deck->raw->set[i].member[k]);
      if (status != BW_OK)
        return status;
    }
    /* sets of sets could double without end */
    if (deck->raw->set[set].count > 4 * (deck->raw->point_count + deck->raw->tet_count) + 64)
      return bwi_fail_line(line, "the set '%s' includes itself", bwi_show(name));
    return BW_OK;
  }
  return bwi_fail_line(line, "found '%s' where a number or the name of a set was expected",
                       bwi_show(name));
}

static bw_status read_set(inp *deck, const keyword *key, bool of_elements) {
  enum { MAX_RANGES = 1000 };
  bw_status status = BW_OK;
  bwi_cursor line;
  bwi_word item;
  size_t set;
  int ranges = 0;
  BW_TRY(set_of(deck, key, of_elements, &set));
  if (set == SIZE_MAX)
    BW_TRY(bwi_fail_line(deck->cursor, "a set without a name"));
  BW_TRY(need_ids(deck, of_elements));
  while (next_data(deck->cursor, &line)) {
    if (key->generate) {
      if (++ranges > MAX_RANGES)
        BW_TRY(bwi_fail_line(&line, "more than %d ranges in one set", MAX_RANGES));
      BW_TRY(generate(deck, set, of_elements, &line));
      continue;
    }
    while (next_item(&line, &item)) {
      const unsigned char *after, *end = item.at + item.length;
      int64_t id;
      if (item.length == 0)
        continue;
      if (bwi_parse_integer(item.at, end, &id, &after) && after == end)
        BW_TRY(add_member(deck, set, of_elements, id));
      else
        BW_TRY(include_set(deck, set, of_elements, item, &line));
    }
  }
done:
  return status;
}

/* ---- sections -------------------------------------------------------------------------------- */

/* The set of a *SOLID SECTION, which is there before it; each is remembered once, at its last. */
static bw_status read_section(inp *deck, const keyword *key) {
  size_t set = 0;
  while (set < deck->raw->set_count && !(deck->raw->set[set].of_elements &&
                                         bwi_word_is_nocase(key->set, deck->raw->set[set].name)))
    set++;
  if (key->set.length == 0 || set == deck->raw->set_count)
    return BW_OK;
  for (size_t i = 0; i < deck->section_count; i++)
    if (deck->section[i] == set) {
      memmove(deck->section + i, deck->section + i + 1,
              (deck->section_count - i - 1) * sizeof *deck->section);
      deck->section[deck->section_count - 1] = set;
      return BW_OK;
    }
  if (!bw_grow(deck->raw->context, (void **)&deck->section, &deck->section_capacity,
               deck->section_count, 1, sizeof *deck->section))
    return BW_MEMORY;
  deck->section[deck->section_count++] = set;
  return BW_OK;
}

/* Where sections make no regions: sets of elements that divide the mesh, each element in one of
 * them. The search begins at the last set, since groups with names of their own follow those of
 * geometry. What holds all elements, or shares one with a later set, is no region. */
static bw_status divide_by_sets(inp *deck) {
  bw_status status = BW_OK;
  const bwi_raw *raw = deck->raw;
  size_t left = raw->tet_count, *section = NULL;
  uint8_t *taken = BW_NEW0(raw->context, uint8_t, raw->tet_count);
  section = BW_NEW(raw->context, size_t, raw->set_count);
  BW_TRY_MEMORY(taken && section);
  deck->section_count = 0;
  for (size_t i = raw->set_count; i-- > 0 && left > 0;) {
    const bwi_raw_set *set = &raw->set[i];
    size_t own = 0, k = 0;
    if (!set->of_elements || set->count == 0)
      continue;
    for (; k < set->count && taken[set->member[k]] != 1; k++) { /* 2: by this set */
      own += taken[set->member[k]] == 0;
      taken[set->member[k]] = 2;
    }
    bool region = k == set->count && own < raw->tet_count;
    for (size_t j = 0; j < k; j++)
      taken[set->member[j]] = region;
    if (!region)
      continue;
    left -= own;
    section[deck->section_count++] = i;
  }
  if (left > 0)
    deck->section_count = 0;
  bw_free(deck->section);
  deck->section = section;
  section = NULL;
  for (size_t i = 0, j = deck->section_count; i + 1 < j; i++) { /* in the order of the file */
    size_t first = deck->section[i];
    deck->section[i] = deck->section[--j];
    deck->section[j] = first;
  }
done:
  bw_free(section);
  bw_free(taken);
  return status;
}

/* Several sections are the regions of the mesh, numbered in their order; of an element in two of
 * them the later one counts, as in CalculiX. Of a single material, sets may be regions. */
static bw_status make_regions(inp *deck) {
  bw_status status = BW_OK;
  bwi_raw *raw = deck->raw;
  if (deck->section_count < 2)
    BW_TRY(divide_by_sets(deck));
  for (size_t i = 0; i < deck->section_count && deck->section_count > 1; i++) {
    const bwi_raw_set *set = &raw->set[deck->section[i]];
    bwi_word name = {(const unsigned char *)set->name, strlen(set->name)};
    BW_TRY(bwi_raw_name_region(raw, (int32_t)i + 1, name));
    for (size_t k = 0; k < set->count; k++)
      raw->region[set->member[k]] = (int32_t)i + 1;
    raw->regions |= set->count > 0;
  }
done:
  return status;
}

bw_status bwi_inp_read(bwi_cursor *cursor, bwi_raw *raw, const char **format) {
  bw_status status = BW_OK;
  inp deck = {.cursor = cursor, .raw = raw};
  bwi_cursor line;
  *format = "INP";
  while (next_line(cursor, &line)) {
    keyword key;
    if (*line.at != '*')
      continue; /* data of a keyword that was passed over */
    read_keyword(&deck, &line, &key);
    if (bwi_word_is_nocase(key.name, "*INCLUDE") || key.input)
      BW_TRY(bwi_fail_line(&line, "%s: included files are not read; put their lines in this place",
                           bwi_show(key.name)));
    if (bwi_word_is_nocase(key.name, "*NODE"))
      BW_TRY(read_nodes(&deck, &key));
    else if (bwi_word_is_nocase(key.name, "*ELEMENT"))
      BW_TRY(read_elements(&deck, &key));
    else if (bwi_word_is_nocase(key.name, "*NSET"))
      BW_TRY(read_set(&deck, &key, false));
    else if (bwi_word_is_nocase(key.name, "*ELSET"))
      BW_TRY(read_set(&deck, &key, true));
    else if (bwi_word_is_nocase(key.name, "*SOLID SECTION"))
      BW_TRY(read_section(&deck, &key));
    BW_TRY(bw_check_cancel(raw->context));
  }
  if (raw->tet_count) /* an element may be defined twice without any set that asks */
    BW_TRY(need_ids(&deck, true));
  BW_TRY(make_regions(&deck));
done:
  bw_free(deck.section);
  bwi_ids_clear(&deck.nodes);
  bwi_ids_clear(&deck.tets);
  bw_free(deck.node_id);
  bw_free(deck.tet_id);
  bw_free(deck.number);
  return status;
}
