/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* From rendered colours to a canvas for Cairo, and from there to a PNG file. */
#include <math.h>
#include <string.h>
#include <strings.h>

#include "picture/internal.h"

/* How much of an outline runs through a pixel of the ghost: where its neighbours show
 * background. */
static double outline_at(const bwi_image *image, int x, int y) {
  size_t at = (size_t)y * (size_t)image->width + (size_t)x;
  int min = image->colour[4 * at + 3];
  if (image->finish[at] != BWI_GHOST || image->depth[at] == -HUGE_VALF)
    return 0;
  for (int dy = -1; dy <= 1; dy++)
    for (int dx = -1; dx <= 1; dx++) {
      int px = x + dx, py = y + dy;
      if (px < 0 || py < 0 || px >= image->width || py >= image->height)
        continue;
      int other = image->colour[4 * ((size_t)py * (size_t)image->width + (size_t)px) + 3];
      min = other < min ? other : min;
    }
  return 0.38 * (255 - min) / 255;
}

/* The rendered colours over the background: white, a little greyer towards the bottom. */
void bwi_compose(const bwi_image *image, cairo_surface_t *canvas) {
  unsigned char *pixels = cairo_image_surface_get_data(canvas);
  int stride = cairo_image_surface_get_stride(canvas);
  cairo_surface_flush(canvas);
  for (int y = 0; y < image->height; y++) {
    double down = (double)y / image->height;
    double back[3] = {255 - 13 * down, 255 - 11 * down, 255 - 8 * down};
    uint32_t *row = (uint32_t *)(void *)(pixels + (size_t)y * (size_t)stride);
    for (int x = 0; x < image->width; x++) {
      const unsigned char *c = image->colour + 4 * ((size_t)y * (size_t)image->width + (size_t)x);
      uint32_t out = 0;
      double line = outline_at(image, x, y);
      for (int k = 0; k < 3; k++) {
        double v = (c[k] * c[3] + back[k] * (255 - c[3])) / 255;
        out = out << 8 | (uint32_t)(v * (1 - line) + 0.5);
      }
      row[x] = out;
    }
  }
  cairo_surface_mark_dirty(canvas);
}

typedef struct sink {
  bw_writer *writer;
  bw_status status;
} sink;

static cairo_status_t write_bytes(void *data, const unsigned char *bytes, unsigned int count) {
  sink *out = (sink *)data;
  out->status = bw_writer_bytes(out->writer, bytes, count);
  return out->status == BW_OK ? CAIRO_STATUS_SUCCESS : CAIRO_STATUS_WRITE_ERROR;
}

bw_status bwi_need_png(bw_context *context, const char *path) {
  static const char *const endings[] = {".png", ".apng"};
  size_t length = strlen(path);
  for (int i = 0; i < 2; i++)
    if (length > strlen(endings[i]) &&
        strcasecmp(path + length - strlen(endings[i]), endings[i]) == 0)
      return BW_OK;
  return bw_fail(context, BW_UNSUPPORTED,
                 "%s: a picture is written as PNG; let the name of its file end in .png", path);
}

bw_status bwi_write_png(bw_context *context, cairo_surface_t *canvas, const char *path) {
  sink out = {NULL, BW_OK};
  bw_status status = bwi_need_png(context, path);
  if (status == BW_OK)
    status = bw_writer_open(context, path, &out.writer);
  if (status != BW_OK)
    return status;
  cairo_status_t drawn = cairo_surface_write_to_png_stream(canvas, write_bytes, &out);
  if (drawn == CAIRO_STATUS_SUCCESS)
    return bw_writer_commit(out.writer);
  bw_writer_discard(out.writer);
  if (out.status != BW_OK)
    return out.status;
  return drawn == CAIRO_STATUS_NO_MEMORY
             ? bw_fail(context, BW_MEMORY, "%s: no memory for the PNG file", path)
             : bw_fail(context, BW_INTERNAL, "%s: %s", path, cairo_status_to_string(drawn));
}
