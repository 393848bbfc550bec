/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* STEP and IGES: recognised here, read by the library that is registered. */
#include "barwright/cad.h"

#include <string.h>

#include "barwright/io.h"

static bw_cad_reader *registered;

void bw_cad_register(bw_cad_reader *reader) {
  registered = reader;
}

/* A line of an IGES file has 80 columns: the 73rd names its section, the first of which is S, and
 * its number follows. */
enum { IGES_SECTION = 72, IGES_COLUMNS = 80 };

const char *bw_cad_format(const unsigned char *bytes, size_t count) {
  static const char step[] = "ISO-10303-21";
  size_t begin = 0;
  while (begin < count && (bytes[begin] == ' ' || bytes[begin] == '\n' || bytes[begin] == '\r'))
    begin++;
  if (count - begin >= sizeof step - 1 && memcmp(bytes + begin, step, sizeof step - 1) == 0)
    return "STEP";
  if (count < IGES_COLUMNS || bytes[IGES_SECTION] != 'S' || bytes[IGES_COLUMNS - 1] != '1')
    return NULL;
  for (int i = 0; i < IGES_COLUMNS; i++) {
    bool number = i > IGES_SECTION && i < IGES_COLUMNS - 1;
    if (number ? bytes[i] != ' ' && bytes[i] != '0' : bytes[i] < ' ' || bytes[i] == 127)
      return NULL;
  }
  return "IGES";
}

const char *bw_cad_kind_word(bw_cad_kind kind) {
  static const char *const words[] = {"plane", "cylinder", "cone", "sphere", "torus", "freeform"};
  return words[kind];
}

void bw_cad_file_clear(bw_cad_file *file) {
  for (int32_t i = 0; file->body && i < file->body_count; i++)
    bw_release(file->body[i].surface);
  bw_release(file->surface);
  bw_free(file->body);
  bw_free(file->face);
  bw_free(file->names);
  *file = (bw_cad_file){0};
}

bw_status bw_cad_read(bw_context *context, const char *path, const bw_cad_options *options,
                      bw_cad_file *file) {
  unsigned char *bytes = NULL;
  size_t count;
  bw_status status;
  BW_TRY(bw_read_file(context, path, &bytes, &count));
  if (!bw_cad_format(bytes, count))
    BW_TRY(bw_fail(context, BW_FORMAT, "%s: this is neither a STEP nor an IGES file", path));
  if (!registered)
    BW_TRY(bw_fail(context, BW_UNSUPPORTED,
                   "%s: %s files are read by OpenCASCADE, which is not loaded", path,
                   bw_cad_format(bytes, count)));
  BW_TRY(registered(context, path, bytes, count, options, file));
done:
  bw_free(bytes);
  return status;
}
