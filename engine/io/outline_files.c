/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* Outlines from drawings and to them: which format a file has, by content first and by its ending
 * second. */
#include <math.h>
#include <string.h>

#include "io/contours.h"
#include "io/formats.h"

static bool looks_like_dxf(bwi_cursor cursor) {
  if (bwi_left(&cursor) > 11 && memcmp(cursor.at, "AutoCAD Bin", 11) == 0)
    return true;
  bwi_word code = bwi_peek_word(&cursor);
  if (bwi_word_is(code, "999"))
    return true;
  bwi_next_word(&cursor, &code);
  return bwi_word_is(code, "0") && bwi_word_is(bwi_peek_word(&cursor), "SECTION");
}

bw_status bw_outline_parse(bw_context *context, const char *name, const unsigned char *bytes,
                           size_t count, const bw_outline_read_options *options,
                           bw_outline **outline, bw_read_info *info) {
  bw_status status = BW_OK;
  static const bw_outline_read_options plain = {0, 0};
  const bw_outline_read_options *opts = options ? options : &plain;
  bwi_contours contours;
  bwi_cursor cursor;
  if (!(opts->unit >= 0 && opts->unit < 1e9 && opts->tolerance >= 0 && opts->tolerance < 1e9))
    return bw_fail(context, BW_INVALID,
                   "a unit of %g m and a tolerance of %g m: positive lengths expected, or 0 for "
                   "what the file says",
                   opts->unit, opts->tolerance);
  bwi_contours_init(&contours, context, name);
  bwi_cursor_init(&cursor, context, name, bytes, count);
  bwi_cursor text = cursor;
  bool any = bwi_skip_space(&text);
  bool is_svg = any && *text.at == '<', is_dxf = looks_like_dxf(cursor);
  if (is_svg)
    BW_TRY(bwi_svg_parse(&cursor, opts->unit, &contours, info));
  else if (is_dxf || (any && bwi_has_ending(name, "dxf")))
    BW_TRY(bwi_dxf_parse(&cursor, opts->unit, &contours, info));
  else
    BW_TRY(bwi_fail_unknown(&cursor, "SVG (beginning with '<'), DXF (beginning with the lines 0, "
                                     "SECTION)"));
  BW_TRY(bwi_contours_finish(&contours, opts->tolerance, outline));
done:
  bwi_contours_clear(&contours);
  return status;
}

bw_status bw_outline_read(bw_context *context, const char *path,
                          const bw_outline_read_options *options, bw_outline **outline,
                          bw_read_info *info) {
  unsigned char *bytes;
  size_t count;
  bw_status status = bw_read_file(context, path, &bytes, &count);
  if (status != BW_OK)
    return status;
  status = bw_outline_parse(context, path, bytes, count, options, outline, info);
  bw_free(bytes);
  return status;
}

bw_status bw_outline_write(bw_context *context, const bw_outline *outline, const char *path) {
  bw_status status = BW_OK;
  bw_writer *writer = NULL;
  bool svg = bwi_has_ending(path, "svg");
  if (!svg && !bwi_has_ending(path, "dxf"))
    return bw_fail(context, BW_INVALID, "%s: outlines are written as .svg or .dxf", path);
  BW_TRY(bw_writer_open(context, path, &writer));
  BW_TRY(svg ? bwi_svg_write(writer, outline) : bwi_dxf_write(writer, outline));
  return bw_writer_commit(writer);
done:
  bw_writer_discard(writer);
  return status;
}
