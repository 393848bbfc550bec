/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* An outline as DXF in millimetres for cutters, of AutoCAD 2000 (AC1015), the first version with
 * splines: each run of edges of one tag is an entity on the layer of that name, a closed one where
 * the whole loop has the tag; a LWPOLYLINE when all its edges are lines, else a SPLINE of degree 3
 * whose inner knots are threefold, so that it is the same curve. The tables are those that AutoCAD
 * insists on. Every object has a handle of its own. */
#include <string.h>

#include "io/contours.h"

/* Handles below the first of an entity are those of the tables. */
enum {
  HANDLE_LAYERS = 0x02,
  HANDLE_LINETYPES = 0x05,
  HANDLE_STYLES = 0x03,
  HANDLE_VIEWS = 0x06,
  HANDLE_UCS = 0x07,
  HANDLE_VIEWPORTS = 0x08,
  HANDLE_APPLICATIONS = 0x09,
  HANDLE_DIMENSIONS = 0x0A,
  HANDLE_BLOCKS = 0x01,
  HANDLE_DICTIONARY = 0x0C,
  HANDLE_GROUPS = 0x0D,
  HANDLE_BY_BLOCK = 0x14,
  HANDLE_BY_LAYER = 0x15,
  HANDLE_CONTINUOUS = 0x16,
  HANDLE_STANDARD = 0x11,
  HANDLE_ACAD = 0x12,
  HANDLE_MODEL = 0x1F,
  HANDLE_PAPER = 0x1B,
  HANDLE_MODEL_BLOCK = 0x20,
  HANDLE_MODEL_END = 0x21,
  HANDLE_PAPER_BLOCK = 0x1C,
  HANDLE_PAPER_END = 0x1D,
  HANDLE_FIRST = 0x100
};

static void text(bw_writer *w, int code, const char *value) {
  bw_writer_print(w, "%3d\n%s\n", code, value);
}

static void integer(bw_writer *w, int code, int64_t value) {
  bw_writer_print(w, "%3d\n%lld\n", code, (long long)value);
}

static void handle(bw_writer *w, int code, int64_t value) {
  bw_writer_print(w, "%3d\n%llX\n", code, (long long)value);
}

static void real(bw_writer *w, int code, double value) {
  bw_writer_print(w, "%3d\n", code);
  bw_writer_number(w, value);
  bw_writer_bytes(w, "\n", 1);
}

static void point(bw_writer *w, int code, double x, double y) {
  real(w, code, x);
  real(w, code + 10, y);
}

/* A layer's name may not hold these; names that only differ in them fall together. */
static void layer(bw_writer *w, int code, const char *name) {
  char copy[BW_NAME];
  size_t i = 0;
  for (; name[i]; i++)
    copy[i] = strchr("<>/\\\":;?*|=,`", name[i]) || (unsigned char)name[i] < ' ' ? '_' : name[i];
  copy[i] = 0;
  text(w, code, copy);
}

/* ---- tables ---------------------------------------------------------------------------------- */

static void begin_table(bw_writer *w, const char *name, int64_t own, int count) {
  text(w, 0, "TABLE");
  text(w, 2, name);
  handle(w, 5, own);
  handle(w, 330, 0);
  text(w, 100, "AcDbSymbolTable");
  integer(w, 70, count);
}

static void begin_record(bw_writer *w, const char *type, int64_t own, int64_t table,
                         const char *kind, const char *name) {
  text(w, 0, type);
  handle(w, strcmp(type, "DIMSTYLE") == 0 ? 105 : 5, own);
  handle(w, 330, table);
  text(w, 100, "AcDbSymbolTableRecord");
  text(w, 100, kind);
  if (name)
    text(w, 2, name);
}

static void write_linetypes(bw_writer *w) {
  static const char *const name[3] = {"ByBlock", "ByLayer", "Continuous"};
  begin_table(w, "LTYPE", HANDLE_LINETYPES, 3);
  for (int i = 0; i < 3; i++) {
    begin_record(w, "LTYPE", HANDLE_BY_BLOCK + i, HANDLE_LINETYPES, "AcDbLinetypeTableRecord",
                 name[i]);
    integer(w, 70, 0);
    text(w, 3, i == 2 ? "Solid line" : "");
    integer(w, 72, 65);
    integer(w, 73, 0);
    real(w, 40, 0);
  }
  text(w, 0, "ENDTAB");
}

static void write_layers(bw_writer *w, const bw_outline *o, int64_t *next) {
  begin_table(w, "LAYER", HANDLE_LAYERS, o->tag_count + 1);
  for (int32_t t = -1; t < o->tag_count; t++) {
    if (t >= 0 && strcmp(o->tag[t].text, "0") == 0)
      continue;
    begin_record(w, "LAYER", (*next)++, HANDLE_LAYERS, "AcDbLayerTableRecord", NULL);
    layer(w, 2, t < 0 ? "0" : o->tag[t].text);
    integer(w, 70, 0);
    integer(w, 62, t < 0 ? 7 : 1 + t % 6);
    text(w, 6, "Continuous");
  }
  text(w, 0, "ENDTAB");
}

static void write_tables(bw_writer *w, const bw_outline *o, int64_t *next) {
  text(w, 0, "SECTION");
  text(w, 2, "TABLES");
  begin_table(w, "VPORT", HANDLE_VIEWPORTS, 0);
  text(w, 0, "ENDTAB");
  write_linetypes(w);
  write_layers(w, o, next);
  begin_table(w, "STYLE", HANDLE_STYLES, 1);
  begin_record(w, "STYLE", HANDLE_STANDARD, HANDLE_STYLES, "AcDbTextStyleTableRecord", "Standard");
  integer(w, 70, 0);
  real(w, 40, 0);
  real(w, 41, 1);
  real(w, 50, 0);
  integer(w, 71, 0);
  real(w, 42, 1);
  text(w, 3, "txt");
  text(w, 4, "");
  text(w, 0, "ENDTAB");
  begin_table(w, "VIEW", HANDLE_VIEWS, 0);
  text(w, 0, "ENDTAB");
  begin_table(w, "UCS", HANDLE_UCS, 0);
  text(w, 0, "ENDTAB");
  begin_table(w, "APPID", HANDLE_APPLICATIONS, 1);
  begin_record(w, "APPID", HANDLE_ACAD, HANDLE_APPLICATIONS, "AcDbRegAppTableRecord", "ACAD");
  integer(w, 70, 0);
  text(w, 0, "ENDTAB");
  begin_table(w, "DIMSTYLE", HANDLE_DIMENSIONS, 0);
  text(w, 100, "AcDbDimStyleTable");
  text(w, 0, "ENDTAB");
  begin_table(w, "BLOCK_RECORD", HANDLE_BLOCKS, 2);
  begin_record(w, "BLOCK_RECORD", HANDLE_MODEL, HANDLE_BLOCKS, "AcDbBlockTableRecord",
               "*Model_Space");
  begin_record(w, "BLOCK_RECORD", HANDLE_PAPER, HANDLE_BLOCKS, "AcDbBlockTableRecord",
               "*Paper_Space");
  text(w, 0, "ENDTAB");
  text(w, 0, "ENDSEC");
}

static void write_block(bw_writer *w, int64_t begin, int64_t end, int64_t owner, const char *name) {
  text(w, 0, "BLOCK");
  handle(w, 5, begin);
  handle(w, 330, owner);
  text(w, 100, "AcDbEntity");
  text(w, 8, "0");
  text(w, 100, "AcDbBlockBegin");
  text(w, 2, name);
  integer(w, 70, 0);
  point(w, 10, 0, 0);
  real(w, 30, 0);
  text(w, 3, name);
  text(w, 1, "");
  text(w, 0, "ENDBLK");
  handle(w, 5, end);
  handle(w, 330, owner);
  text(w, 100, "AcDbEntity");
  text(w, 8, "0");
  text(w, 100, "AcDbBlockEnd");
}

/* ---- entities -------------------------------------------------------------------------------- */

/* Edges [from, from + count) of a loop, counted around it. */
typedef struct run {
  const bw_outline *o;
  const bw_loop *loop;
  int32_t from, count;
} run;

static const bw_segment *edge_of(const run *r, int32_t i) {
  return &r->o->segment[r->loop->first + (r->from + i) % r->loop->count];
}

static void write_vertex(bw_writer *w, const run *r, int32_t p, bool flat) {
  point(w, 10, 1000 * r->o->point[2 * (int64_t)p], 1000 * r->o->point[2 * (int64_t)p + 1]);
  if (!flat)
    real(w, 30, 0);
}

static void write_polyline(bw_writer *w, const run *r) {
  bool closed = r->count == r->loop->count;
  text(w, 100, "AcDbPolyline");
  integer(w, 90, r->count + !closed);
  integer(w, 70, closed);
  for (int32_t i = 0; i < r->count; i++)
    write_vertex(w, r, edge_of(r, i)->point[0], true);
  if (!closed)
    write_vertex(w, r, edge_of(r, r->count - 1)->point[3], true);
}

static void write_spline(bw_writer *w, const run *r) {
  bool closed = r->count == r->loop->count;
  text(w, 100, "AcDbSpline");
  integer(w, 70, 8 + closed);
  integer(w, 71, 3);
  integer(w, 72, 3 * (int64_t)r->count + 5);
  integer(w, 73, 3 * (int64_t)r->count + 1);
  integer(w, 74, 0);
  for (int32_t i = 0; i <= r->count; i++)
    for (int k = 0; k < (i == 0 || i == r->count ? 4 : 3); k++)
      real(w, 40, i);
  for (int32_t i = 0; i < r->count; i++) {
    const bw_segment *s = edge_of(r, i);
    write_vertex(w, r, s->point[0], false);
    for (int k = 1; k < 3; k++) {
      if (!bwi_is_line(s)) {
        write_vertex(w, r, s->point[k], false);
        continue;
      }
      const double *a = r->o->point + 2 * (int64_t)s->point[0];
      const double *b = r->o->point + 2 * (int64_t)s->point[3];
      point(w, 10, 1000 * (a[0] + (b[0] - a[0]) * k / 3), 1000 * (a[1] + (b[1] - a[1]) * k / 3));
      real(w, 30, 0);
    }
  }
  write_vertex(w, r, edge_of(r, r->count - 1)->point[3], false);
}

static void write_run(bw_writer *w, const run *r, int64_t own) {
  bool lines = true;
  for (int32_t i = 0; i < r->count; i++)
    lines = lines && bwi_is_line(edge_of(r, i));
  text(w, 0, lines ? "LWPOLYLINE" : "SPLINE");
  handle(w, 5, own);
  handle(w, 330, HANDLE_MODEL);
  text(w, 100, "AcDbEntity");
  layer(w, 8, r->o->tag[edge_of(r, 0)->tag].text);
  if (lines)
    write_polyline(w, r);
  else
    write_spline(w, r);
}

/* Runs of one tag, beginning where the tag changes. */
static void write_loop(bw_writer *w, const bw_outline *o, const bw_loop *loop, int64_t *next) {
  run r = {o, loop, 0, loop->count};
  int32_t change = -1;
  for (int32_t i = 0; i < loop->count && change < 0; i++)
    if (edge_of(&r, i)->tag != edge_of(&r, i + loop->count - 1)->tag)
      change = i;
  if (change < 0) {
    write_run(w, &r, (*next)++);
    return;
  }
  for (int32_t done = 0; done < loop->count; done += r.count) {
    r.from = (change + done) % loop->count;
    r.count = 1;
    while (done + r.count < loop->count && edge_of(&r, r.count)->tag == edge_of(&r, 0)->tag)
      r.count++;
    write_run(w, &r, (*next)++);
  }
}

bw_status bwi_dxf_write(bw_writer *w, const bw_outline *o) {
  int64_t next = HANDLE_FIRST;
  bw_outline_measures m;
  bw_status status = bw_outline_measure(bwi_writer_context(w), o, -1, &m);
  if (status != BW_OK)
    return status;
  text(w, 0, "SECTION");
  text(w, 2, "HEADER");
  text(w, 9, "$ACADVER");
  text(w, 1, "AC1015");
  text(w, 9, "$HANDSEED");
  handle(w, 5, HANDLE_FIRST + (int64_t)o->tag_count + o->segment_count + 16);
  text(w, 9, "$INSUNITS");
  integer(w, 70, 4);
  text(w, 9, "$MEASUREMENT");
  integer(w, 70, 1);
  text(w, 9, "$EXTMIN");
  point(w, 10, 1000 * m.min[0], 1000 * m.min[1]);
  real(w, 30, 0);
  text(w, 9, "$EXTMAX");
  point(w, 10, 1000 * m.max[0], 1000 * m.max[1]);
  real(w, 30, 0);
  text(w, 0, "ENDSEC");
  write_tables(w, o, &next);
  text(w, 0, "SECTION");
  text(w, 2, "BLOCKS");
  write_block(w, HANDLE_MODEL_BLOCK, HANDLE_MODEL_END, HANDLE_MODEL, "*Model_Space");
  write_block(w, HANDLE_PAPER_BLOCK, HANDLE_PAPER_END, HANDLE_PAPER, "*Paper_Space");
  text(w, 0, "ENDSEC");
  text(w, 0, "SECTION");
  text(w, 2, "ENTITIES");
  for (int32_t l = 0; l < o->loop_count; l++)
    write_loop(w, o, &o->loop[l], &next);
  text(w, 0, "ENDSEC");
  text(w, 0, "SECTION");
  text(w, 2, "OBJECTS");
  text(w, 0, "DICTIONARY");
  handle(w, 5, HANDLE_DICTIONARY);
  handle(w, 330, 0);
  text(w, 100, "AcDbDictionary");
  integer(w, 281, 1);
  text(w, 3, "ACAD_GROUP");
  handle(w, 350, HANDLE_GROUPS);
  text(w, 0, "DICTIONARY");
  handle(w, 5, HANDLE_GROUPS);
  handle(w, 330, HANDLE_DICTIONARY);
  text(w, 100, "AcDbDictionary");
  integer(w, 281, 1);
  text(w, 0, "ENDSEC");
  return bw_writer_print(w, "  0\nEOF\n");
}
