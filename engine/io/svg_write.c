/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* An outline as SVG in millimetres: a path for every loop, one closed line without filling, for
 * pictures and cutters. y is mirrored about the middle of the box, as the reader does. What SVG has
 * no word for stands in attributes that others ignore: data-region, data-name where the name is no
 * id, data-tags where the edges differ. */
#include <string.h>

#include "io/contours.h"

/* What an id may hold everywhere: letters, digits, - and _, not beginning with a digit. */
static bool plain(const char *name) {
  for (const char *c = name; *c; c++) {
    bool letter = (*c >= 'a' && *c <= 'z') || (*c >= 'A' && *c <= 'Z') || *c == '_';
    if (!letter && (c == name || !((*c >= '0' && *c <= '9') || *c == '-')))
      return false;
  }
  return name[0] != 0;
}

static void write_id(bw_writer *writer, const char *name) {
  for (const char *c = name; *c; c++) {
    bool ok = (*c >= 'a' && *c <= 'z') || (*c >= 'A' && *c <= 'Z') || (*c >= '0' && *c <= '9') ||
              *c == '-' || *c == '_';
    if (c == name && ((*c >= '0' && *c <= '9') || *c == '-'))
      bw_writer_bytes(writer, "_", 1);
    bw_writer_bytes(writer, ok ? c : "_", 1);
  }
}

static void write_escaped(bw_writer *writer, const char *text) {
  for (const char *c = text; *c; c++) {
    const char *entity = *c == '&'   ? "&amp;"
                         : *c == '<' ? "&lt;"
                         : *c == '>' ? "&gt;"
                         : *c == '"' ? "&quot;"
                                     : NULL;
    /* Bytes that XML does not allow become blanks. */
    if (!entity && (unsigned char)*c < ' ')
      entity = " ";
    if (entity)
      bw_writer_bytes(writer, entity, strlen(entity));
    else
      bw_writer_bytes(writer, c, 1);
  }
}

/* A tag in data-tags: all but letters, digits, -, _ and bytes beyond ASCII as %20 and the like. */
static void write_tag(bw_writer *writer, const char *tag) {
  for (const char *c = tag; *c; c++) {
    unsigned char u = (unsigned char)*c;
    bool ok = u >= 128 || (u >= 'a' && u <= 'z') || (u >= 'A' && u <= 'Z') ||
              (u >= '0' && u <= '9') || u == '-' || u == '_';
    if (ok)
      bw_writer_bytes(writer, c, 1);
    else
      bw_writer_print(writer, "%%%02X", u);
  }
}

static void write_tags(bw_writer *writer, const bw_outline *o, const bw_loop *loop) {
  int32_t end = loop->first + loop->count, tag = o->segment[loop->first].tag;
  bool same = true;
  for (int32_t s = loop->first; s < end; s++)
    same = same && o->segment[s].tag == tag;
  if (same && plain(o->tag[tag].text)) {
    bw_writer_print(writer, " class=\"%s\"", o->tag[tag].text);
    return;
  }
  bw_writer_print(writer, " data-tags=\"");
  for (int32_t s = loop->first; s < end;) {
    int32_t next = s + 1;
    while (next < end && o->segment[next].tag == o->segment[s].tag)
      next++;
    bw_writer_bytes(writer, " ", s > loop->first);
    write_tag(writer, o->tag[o->segment[s].tag].text);
    if (next - s > 1)
      bw_writer_print(writer, "*%d", next - s);
    s = next;
  }
  bw_writer_bytes(writer, "\"", 1);
}

static void write_point(bw_writer *writer, const bw_outline *o, int32_t p, double mirror) {
  bw_writer_bytes(writer, " ", 1);
  bw_writer_number(writer, 1000 * o->point[2 * (int64_t)p]);
  bw_writer_bytes(writer, " ", 1);
  bw_writer_number(writer, 1000 * (mirror - o->point[2 * (int64_t)p + 1]));
}

bw_status bwi_svg_write(bw_writer *writer, const bw_outline *o) {
  bw_outline_measures m;
  bw_status status = bw_outline_measure(bwi_writer_context(writer), o, -1, &m);
  if (status != BW_OK)
    return status;
  double width = 1000 * (m.max[0] - m.min[0]), height = 1000 * (m.max[1] - m.min[1]);
  double mirror = m.min[1] + m.max[1], stroke = (width + height) / 1000;
  bw_writer_print(writer, "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n<svg "
                          "xmlns=\"http://www.w3.org/2000/svg\" width=\"");
  bw_writer_number(writer, width);
  bw_writer_print(writer, "mm\" height=\"");
  bw_writer_number(writer, height);
  bw_writer_print(writer, "mm\" viewBox=\"");
  const double view[4] = {1000 * m.min[0], 1000 * m.min[1], width, height};
  for (int i = 0; i < 4; i++) {
    bw_writer_bytes(writer, " ", i > 0);
    bw_writer_number(writer, view[i]);
  }
  bw_writer_print(writer, "\" overflow=\"visible\">\n<g fill=\"none\" stroke=\"black\" "
                          "stroke-width=\"");
  bw_writer_number(writer, stroke);
  bw_writer_print(writer, "\">\n");
  for (int32_t l = 0; l < o->loop_count; l++) {
    const bw_loop *loop = &o->loop[l];
    bw_writer_print(writer, "<path id=\"");
    write_id(writer, loop->name.text);
    bw_writer_bytes(writer, "\"", 1);
    if (!plain(loop->name.text)) {
      bw_writer_print(writer, " data-name=\"");
      write_escaped(writer, loop->name.text);
      bw_writer_bytes(writer, "\"", 1);
    }
    write_tags(writer, o, loop);
    if (loop->region < 0)
      bw_writer_print(writer, " data-region=\"hole\" d=\"M");
    else
      bw_writer_print(writer, " data-region=\"%d\" d=\"M", loop->region + 1);
    write_point(writer, o, o->segment[loop->first].point[0], mirror);
    for (int32_t s = loop->first; s < loop->first + loop->count; s++) {
      const int32_t *p = o->segment[s].point;
      bw_writer_print(writer, p[1] < 0 ? " L" : " C");
      for (int i = p[1] < 0 ? 3 : 1; i < 4; i++)
        write_point(writer, o, p[i], mirror);
    }
    bw_writer_print(writer, " Z\"/>\n");
  }
  return bw_writer_print(writer, "</g>\n</svg>\n");
}
