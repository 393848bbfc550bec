/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* The rasteriser: visible facets by a depth buffer, shaded per sample, several samples per pixel.
 *
 * The picture is cut into bands of rows. Each band has a depth buffer and facet numbers of its own
 * samples, small enough for the cache; which facet wins at a sample depends on depth and, where
 * depths are equal, on the order of the facets, so the picture has the same bits for any number of
 * threads. Corners are snapped to 1/256 of a sample and edges decided in integers, with both
 * borders counted in: no gap can open between neighbours. */
#include <math.h>
#include <string.h>

#include "picture/internal.h"

enum { SNAP = 256, BAND = 16, LEVELS = 1024, TONES = 4096, CATEGORIES = 12 };
#define NOTHING (-1)

typedef struct scene {
  bw_context *context;
  int solid_count, samples; /* per pixel and direction */
  const bwi_solid *solid;
  bwi_image *image;
  int64_t first[9]; /* facet number of each solid's first facet; solid_count + 1 of them */
  int64_t *bin_start;
  int32_t *bin;
  float *band_depth; /* one band per worker */
  int32_t *band_facet;
  size_t band_size;
  float colour[LEVELS + 1][3]; /* linear light of the colour map */
  float missing[3], plain[3], arrow[3], ghost[3], line[3], category[CATEGORIES][3];
  unsigned char tone[TONES + 1]; /* linear light to sRGB bytes */
} scene;

/* ---- light ----------------------------------------------------------------------------------- */

static float linear_of(int byte) {
  double s = byte / 255.;
  return (float)(s <= 0.04045 ? s / 12.92 : pow((s + 0.055) / 1.055, 2.4));
}

static void set_linear(float out[3], int red, int green, int blue) {
  out[0] = linear_of(red);
  out[1] = linear_of(green);
  out[2] = linear_of(blue);
}

static void prepare_light(scene *s) {
  for (int i = 0; i <= LEVELS; i++) {
    unsigned char rgb[3];
    bw_colour((double)i / LEVELS, rgb);
    set_linear(s->colour[i], rgb[0], rgb[1], rgb[2]);
  }
  for (int i = 0; i < CATEGORIES; i++) {
    unsigned char rgb[3];
    bw_category_colour(i, rgb);
    set_linear(s->category[i], rgb[0], rgb[1], rgb[2]);
  }
  unsigned char none[3];
  bw_colour(NAN, none);
  set_linear(s->missing, none[0], none[1], none[2]);
  set_linear(s->plain, 188, 198, 210);
  set_linear(s->arrow, 52, 58, 74);
  set_linear(s->line, 96, 20, 214);
  set_linear(s->ghost, 222, 225, 230);
  for (int i = 0; i <= TONES; i++) {
    double l = (double)i / TONES;
    double v = l <= 0.0031308 ? 12.92 * l : 1.055 * pow(l, 1 / 2.4) - 0.055;
    s->tone[i] = (unsigned char)(255 * v + 0.5);
  }
}

/* How a surface with this normal (right, up, towards the viewer) is lit: a key light from above
 * left, a soft one from the right, sky above and ground below; and what it mirrors. */
static void light(const float n[3], float *lit, float *gloss) {
  static const float key[3] = {-0.3800f, 0.4200f, 0.8241f}, fill[3] = {0.7507f, 0.0000f, 0.6606f};
  /* halfway between the key light and the viewer */
  static const float half[3] = {-0.1990f, 0.2199f, 0.9550f};
  float k = n[0] * key[0] + n[1] * key[1] + n[2] * key[2];
  float f = n[0] * fill[0] + n[1] * fill[1] + n[2] * fill[2];
  float h = n[0] * half[0] + n[1] * half[1] + n[2] * half[2];
  float grazing = 1 - (n[2] > 0 ? n[2] : 0);
  grazing *= grazing;
  *lit = 0.52f + 0.07f * n[1] + (k > 0 ? 0.47f * k : 0) + (f > 0 ? 0.21f * f : 0);
  *lit *= 1 - 0.28f * grazing * grazing;
  h = h > 0 ? h * h : 0;
  h *= h;
  h *= h;
  h *= h; /* to the 16th */
  *gloss = 0.055f * h * h;
}

/* ---- one sample ------------------------------------------------------------------------------ */

/* Barycentric coordinates of a place in a facet's projection, within 0 and 1. */
static void barycentric(const bwi_solid *solid, const int32_t *t, float x, float y, float w[3],
                        float *area) {
  const float *a = solid->pixel + 3 * (size_t)t[0], *b = solid->pixel + 3 * (size_t)t[1];
  const float *c = solid->pixel + 3 * (size_t)t[2];
  float abx = b[0] - a[0], aby = b[1] - a[1], acx = c[0] - a[0], acy = c[1] - a[1];
  float apx = x - a[0], apy = y - a[1];
  *area = abx * acy - aby * acx;
  float by = *area != 0 ? 1 / *area : 0;
  w[1] = (apx * acy - apy * acx) * by;
  w[2] = (abx * apy - aby * apx) * by;
  w[1] = w[1] < 0 ? 0 : w[1] > 1 ? 1 : w[1];
  w[2] = w[2] < 0 ? 0 : w[2] > 1 - w[1] ? 1 - w[1] : w[2];
  w[0] = 1 - w[1] - w[2];
}

static const float *colour_at(const scene *s, const bwi_solid *solid, int64_t f, const int32_t *t,
                              const float w[3]) {
  if (solid->finish == BWI_ARROW)
    return s->arrow;
  if (solid->finish == BWI_TUBE)
    return s->line;
  if (solid->finish == BWI_GHOST)
    return s->ghost;
  if (!solid->value && solid->category)
    return s->category[(solid->category[f] % CATEGORIES + CATEGORIES) % CATEGORIES];
  if (!solid->value)
    return s->plain;
  double v = solid->on_facets ? solid->value[f]
                              : w[0] * solid->value[t[0]] + w[1] * solid->value[t[1]] +
                                    w[2] * solid->value[t[2]];
  if (!isfinite(v))
    return s->missing;
  double at = (v - solid->low) / (solid->high - solid->low) * LEVELS + 0.5;
  return s->colour[at > 0 ? at < LEVELS ? (int)at : LEVELS : 0];
}

/* How dark a line along the facet's edges is here, 0 to 1. Lines are as wide as a pixel; a mesh
 * finer than a few pixels would turn black, so its lines fade. */
static float line_at(const bwi_solid *solid, int64_t f, const int32_t *t, const float w[3],
                     float area) {
  float dark = 0;
  for (int k = 0; k < 3; k++) {
    bool sharp = solid->lines[f] & (1 << k);
    if (solid->quads && k == (f % 2 ? 0 : 2))
      continue;
    if (!sharp && !solid->edges)
      continue;
    const float *a = solid->pixel + 3 * (size_t)t[k],
                *b = solid->pixel + 3 * (size_t)t[(k + 1) % 3];
    float length = hypotf(b[0] - a[0], b[1] - a[1]);
    if (!(length > 0))
      continue;
    float height = fabsf(area) / length, off = w[(k + 2) % 3] * height;
    float strength = sharp ? 0.38f : 0.42f;
    if (!sharp)
      strength *= height < 3 ? 0 : height < 9 ? (height - 3) / 6 : 1;
    else
      strength *= height < 1 ? height : 1;
    if (off < 0.6f && strength > dark)
      dark = strength;
  }
  return dark;
}

static void shade(const scene *s, int64_t number, float x, float y, unsigned char rgb[3],
                  float normal[3]) {
  int which = 0;
  while (number >= s->first[which + 1])
    which++;
  const bwi_solid *solid = &s->solid[which];
  int64_t f = number - s->first[which];
  const int32_t *t = solid->triangle + 3 * f;
  const float *corner = solid->normal + 9 * f;
  float w[3], area, n[3], lit, gloss;
  barycentric(solid, t, x, y, w, &area);
  for (int k = 0; k < 3; k++)
    n[k] = w[0] * corner[k] + w[1] * corner[3 + k] + w[2] * corner[6 + k];
  /* pixels run downwards: a facet that faces the viewer has a negative area there */
  bool inside = (area > 0) != solid->inverted;
  float size = sqrtf(n[0] * n[0] + n[1] * n[1] + n[2] * n[2]);
  float by = (area > 0 ? -1 : 1) / (size > 0 ? size : 1);
  for (int k = 0; k < 3; k++)
    n[k] *= by;
  if (n[2] < 0) { /* smoothed past the horizon */
    n[2] = 0;
    size = sqrtf(n[0] * n[0] + n[1] * n[1]);
    n[0] /= size > 0 ? size : 1;
    n[1] /= size > 0 ? size : 1;
  }
  const float *base = colour_at(s, solid, f, t, w);
  light(n, &lit, &gloss);
  float dark = line_at(solid, f, t, w, area);
  if (solid->finish == BWI_GHOST) { /* paper: hardly shaded */
    lit = 0.80f + 0.20f * lit;
    gloss = 0;
    dark *= 0.5f;
  }
  if (solid->finish == BWI_TUBE) { /* bright in corners too */
    lit = 0.85f + 0.15f * lit;
    gloss = 0;
  }
  if (inside)
    lit *= 0.72f;
  for (int k = 0; k < 3; k++) {
    float l = base[k] * lit + gloss;
    l = l < 0 ? 0 : l > 1 ? 1 : l;
    rgb[k] = (unsigned char)(s->tone[(int)(l * TONES + 0.5f)] * (1 - dark) + 0.5f);
  }
  memcpy(normal, n, 3 * sizeof *n);
}

/* ---- bands ----------------------------------------------------------------------------------- */

/* The bands that a facet touches; false when it lies outside the picture. */
static bool bands_of(const scene *s, const bwi_solid *solid, const int32_t *t, int *low,
                     int *high) {
  float min[2] = {HUGE_VALF, HUGE_VALF}, max[2] = {-HUGE_VALF, -HUGE_VALF};
  for (int c = 0; c < 3; c++)
    for (int k = 0; k < 2; k++) {
      float at = solid->pixel[3 * (size_t)t[c] + (size_t)k];
      min[k] = fminf(min[k], at);
      max[k] = fmaxf(max[k], at);
    }
  if (!(max[0] >= 0 && min[0] <= (float)s->image->width && max[1] >= 0 &&
        min[1] <= (float)s->image->height))
    return false;
  int bands = (s->image->height + BAND - 1) / BAND;
  *low = min[1] < 0 ? 0 : (int)(min[1] / BAND);
  *high = max[1] >= (float)(bands * BAND) ? bands - 1 : (int)(max[1] / BAND);
  if (*low > bands - 1)
    *low = bands - 1;
  if (*high > bands - 1)
    *high = bands - 1;
  return true;
}

static bw_status fill_bins(scene *s) {
  int bands = (s->image->height + BAND - 1) / BAND;
  for (int pass = 0; pass < 2; pass++) {
    for (int which = 0; which < s->solid_count; which++) {
      const bwi_solid *solid = &s->solid[which];
      for (int64_t f = 0; f < solid->triangle_count; f++) {
        int low, high;
        if (!bands_of(s, solid, solid->triangle + 3 * f, &low, &high))
          continue;
        for (int b = low; b <= high; b++)
          if (pass == 0)
            s->bin_start[b + 1]++;
          else
            s->bin[s->bin_start[b]++] = (int32_t)(s->first[which] + f);
      }
    }
    if (pass == 1)
      break;
    for (int b = 0; b < bands; b++)
      s->bin_start[b + 1] += s->bin_start[b];
    s->bin = BW_NEW(s->context, int32_t, s->bin_start[bands]);
    if (!s->bin)
      return BW_MEMORY;
  }
  memmove(s->bin_start + 1, s->bin_start, (size_t)bands * sizeof *s->bin_start); /* ends again */
  s->bin_start[0] = 0;
  return BW_OK;
}

/* v / SNAP rounded down. */
static int64_t contact_plane_snap(int64_t v) {
  return v >= 0 ? v / SNAP : -((-v + SNAP - 1) / SNAP);
}

/* Enter one facet into a band whose first sample row is `top`. */
static void draw_facet(const scene *s, int64_t number, int64_t top, int64_t rows, float *depth,
                       int32_t *facet) {
  int which = 0;
  while (number >= s->first[which + 1])
    which++;
  const bwi_solid *solid = &s->solid[which];
  const int32_t *t = solid->triangle + 3 * (number - s->first[which]);
  const int64_t wide = (int64_t)s->image->width * s->samples;
  /* Far outside (strong zoom) corners are pulled in, which only moves what is not seen much. */
  const double limit = 1e6;
  int64_t x[3], y[3];
  double z[3];
  for (int c = 0; c < 3; c++) {
    const float *p = solid->pixel + 3 * (size_t)t[c];
    double px = p[0] * s->samples, py = p[1] * s->samples;
    px = px < -limit ? -limit : px > limit ? limit : px;
    py = py < -limit ? -limit : py > limit ? limit : py;
    x[c] = (int64_t)floor(px * SNAP + 0.5);
    y[c] = (int64_t)floor(py * SNAP + 0.5) - top * SNAP;
    z[c] = p[2];
  }
  int64_t area = (x[1] - x[0]) * (y[2] - y[0]) - (y[1] - y[0]) * (x[2] - x[0]);
  if (area == 0)
    return;
  if (area < 0) {
    int64_t swap = x[1];
    x[1] = x[2];
    x[2] = swap;
    swap = y[1];
    y[1] = y[2];
    y[2] = swap;
    double swap_z = z[1];
    z[1] = z[2];
    z[2] = swap_z;
    area = -area;
  }
  int64_t low[2], high[2];
  const int64_t *axis[2] = {x, y};
  for (int k = 0; k < 2; k++) {
    int64_t min = axis[k][0], max = min;
    for (int c = 1; c < 3; c++) {
      min = axis[k][c] < min ? axis[k][c] : min;
      max = axis[k][c] > max ? axis[k][c] : max;
    }
    /* samples lie at (i + 1/2) SNAP */
    low[k] = contact_plane_snap(min - SNAP / 2 + SNAP - 1);
    high[k] = contact_plane_snap(max - SNAP / 2);
    int64_t end = k == 0 ? wide - 1 : rows - 1;
    low[k] = low[k] < 0 ? 0 : low[k];
    high[k] = high[k] > end ? end : high[k];
  }
  if (low[0] > high[0] || low[1] > high[1])
    return;
  int64_t row_edge[3], right[3], down[3];
  for (int c = 0; c < 3; c++) { /* edge opposite corner c: from a to b */
    int a = (c + 1) % 3, b = (c + 2) % 3;
    int64_t dx = x[b] - x[a], dy = y[b] - y[a];
    int64_t px = low[0] * SNAP + SNAP / 2, py = low[1] * SNAP + SNAP / 2;
    row_edge[c] = dx * (py - y[a]) - dy * (px - x[a]);
    right[c] = -dy * SNAP;
    down[c] = dx * SNAP;
  }
  double by = 1 / (double)area;
  double zx = (right[1] * (z[1] - z[0]) + right[2] * (z[2] - z[0])) * by;
  for (int64_t j = low[1]; j <= high[1]; j++) {
    int64_t e0 = row_edge[0], e1 = row_edge[1], e2 = row_edge[2];
    double at = z[0] + ((double)e1 * (z[1] - z[0]) + (double)e2 * (z[2] - z[0])) * by;
    float *row_depth = depth + j * wide;
    int32_t *row_facet = facet + j * wide;
    bool entered = false;
    for (int64_t i = low[0]; i <= high[0]; i++) {
      if ((e0 | e1 | e2) >= 0) {
        float d = (float)(at + zx * (double)(i - low[0]));
        entered = true;
        if (d > row_depth[i]) {
          row_depth[i] = d;
          row_facet[i] = (int32_t)number;
        }
      } else if (entered)
        break; /* convex: once left, never met again in this row */
      e0 += right[0];
      e1 += right[1];
      e2 += right[2];
    }
    for (int c = 0; c < 3; c++)
      row_edge[c] += down[c];
  }
}

/* Shade a band's samples and average them into pixels. */
static void resolve(const scene *s, int first_row, int rows, const float *depth,
                    const int32_t *facet) {
  const int n = s->samples, all = n * n;
  const size_t wide = (size_t)s->image->width * (size_t)n;
  for (int row = 0; row < rows; row++)
    for (int column = 0; column < s->image->width; column++) {
      size_t pixel = (size_t)(first_row + row) * (size_t)s->image->width + (size_t)column;
      int sum[3] = {0, 0, 0}, covered = 0;
      float middle[3] = {0, 0, 1}, middle_depth = -HUGE_VALF;
      int64_t middle_facet = NOTHING;
      for (int j = 0; j < n; j++)
        for (int i = 0; i < n; i++) {
          size_t at = (size_t)(row * n + j) * wide + (size_t)(column * n + i);
          unsigned char rgb[3];
          float normal[3];
          if (facet[at] == NOTHING)
            continue;
          shade(s, facet[at], (float)column + (float)(2 * i + 1) / (float)(2 * n),
                (float)(first_row + row) + (float)(2 * j + 1) / (float)(2 * n), rgb, normal);
          for (int k = 0; k < 3; k++)
            sum[k] += rgb[k];
          covered++;
          if (i == n / 2 && j == n / 2) {
            memcpy(middle, normal, sizeof middle);
            middle_depth = depth[at];
            middle_facet = facet[at];
          }
        }
      unsigned char *out = s->image->colour + 4 * pixel;
      for (int k = 0; k < 3; k++)
        out[k] = (unsigned char)(covered ? (sum[k] + covered / 2) / covered : 0);
      out[3] = (unsigned char)((255 * covered + all / 2) / all);
      s->image->depth[pixel] = middle_depth;
      memcpy(s->image->normal + 3 * pixel, middle, sizeof middle);
      int which = 0;
      while (middle_facet != NOTHING && middle_facet >= s->first[which + 1])
        which++;
      s->image->finish[pixel] = (uint8_t)s->solid[which].finish;
    }
}

static bw_status draw_band(void *data, int64_t begin, int64_t end, int worker) {
  scene *s = (scene *)data;
  float *depth = s->band_depth + (size_t)worker * s->band_size;
  int32_t *facet = s->band_facet + (size_t)worker * s->band_size;
  for (int64_t b = begin; b < end; b++) {
    int first = (int)b * BAND, rows = s->image->height - first;
    rows = rows > BAND ? BAND : rows;
    if (bw_cancelled(s->context))
      return bw_check_cancel(s->context);
    for (size_t i = 0; i < s->band_size; i++) {
      depth[i] = -HUGE_VALF;
      facet[i] = NOTHING;
    }
    for (int64_t i = s->bin_start[b]; i < s->bin_start[b + 1]; i++)
      draw_facet(s, s->bin[i], (int64_t)first * s->samples, (int64_t)rows * s->samples, depth,
                 facet);
    resolve(s, first, rows, depth, facet);
  }
  return BW_OK;
}

void bwi_image_clear(bwi_image *image) {
  bw_free(image->colour);
  bw_free(image->depth);
  bw_free(image->normal);
  bw_free(image->finish);
  image->colour = NULL;
  image->depth = image->normal = NULL;
  image->finish = NULL;
}

bw_status bwi_render(bw_context *context, int solid_count, const bwi_solid *solid,
                     bwi_image *image) {
  size_t pixels = (size_t)image->width * (size_t)image->height;
  int bands = (image->height + BAND - 1) / BAND, workers = bw_threads(context);
  bw_status status = BW_OK;
  scene *s = BW_NEW0(context, scene, 1);
  if (!s)
    return BW_MEMORY;
  s->context = context;
  s->solid_count = solid_count;
  s->solid = solid;
  s->image = image;
  s->samples = pixels <= 1500000 ? 3 : 2;
  for (int i = 0; i < solid_count; i++)
    s->first[i + 1] = s->first[i] + solid[i].triangle_count;
  if (s->first[solid_count] > INT32_MAX)
    BW_TRY(bw_fail(context, BW_LIMIT, "%lld facets are too many for one picture",
                   (long long)s->first[solid_count]));
  s->band_size = (size_t)image->width * (size_t)s->samples * BAND * (size_t)s->samples;
  image->colour = BW_NEW(context, unsigned char, 4 * pixels);
  image->depth = BW_NEW(context, float, pixels);
  image->normal = BW_NEW(context, float, 3 * pixels);
  image->finish = BW_NEW(context, uint8_t, pixels);
  s->bin_start = BW_NEW0(context, int64_t, (size_t)bands + 1);
  s->band_depth = BW_NEW(context, float, s->band_size *(size_t)workers);
  s->band_facet = BW_NEW(context, int32_t, s->band_size * (size_t)workers);
  BW_TRY_MEMORY(image->colour && image->depth && image->normal && image->finish && s->bin_start &&
                s->band_depth && s->band_facet);
  prepare_light(s);
  BW_TRY(fill_bins(s));
  BW_TRY(bw_parallel(context, bands, 1, draw_band, s));
done:
  bw_free(s->bin_start);
  bw_free(s->bin);
  bw_free(s->band_depth);
  bw_free(s->band_facet);
  bw_free(s);
  if (status != BW_OK)
    bwi_image_clear(image);
  return status;
}
