/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* Libraries as bytes: material table, options, fits. */
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "metamaterial/library.h"

/* ---- numbers ------------------------------------------------------------------------------ */

void bwi_pack_begin(bwi_pack *pack, bw_context *context) {
  memset(pack, 0, sizeof *pack);
  pack->context = context;
}

void bwi_pack_clear(bwi_pack *pack) {
  bw_free(pack->bytes);
  pack->bytes = NULL;
  pack->count = pack->capacity = 0;
}

void bwi_pack_bytes(bwi_pack *pack, const void *bytes, size_t count) {
  if (pack->status != BW_OK)
    return;
  if (!bw_grow(pack->context, (void **)&pack->bytes, &pack->capacity, pack->count, count, 1)) {
    pack->status = BW_MEMORY;
    return;
  }
  if (count)
    memcpy(pack->bytes + pack->count, bytes, count);
  pack->count += count;
}

static void put(bwi_pack *pack, uint64_t value, size_t size) {
  unsigned char bytes[8];
  for (size_t i = 0; i < size; i++)
    bytes[i] = (unsigned char)(value >> 8 * i);
  bwi_pack_bytes(pack, bytes, size);
}

void bwi_pack_u8(bwi_pack *pack, unsigned value) {
  put(pack, value, 1);
}
void bwi_pack_u32(bwi_pack *pack, uint32_t value) {
  put(pack, value, 4);
}
void bwi_pack_u64(bwi_pack *pack, uint64_t value) {
  put(pack, value, 8);
}
void bwi_pack_f32(bwi_pack *pack, double value) {
  float rounded = (float)value;
  uint32_t bits;
  memcpy(&bits, &rounded, sizeof bits);
  put(pack, bits, 4);
}
void bwi_pack_f64(bwi_pack *pack, double value) {
  uint64_t bits;
  memcpy(&bits, &value, sizeof bits);
  put(pack, bits, 8);
}

const unsigned char *bwi_unpack_bytes(bwi_unpack *from, size_t count) {
  if (count > (size_t)(from->end - from->at)) {
    from->short_of = true;
    from->at = from->end;
    return NULL;
  }
  from->at += count;
  return from->at - count;
}

static uint64_t take(bwi_unpack *from, size_t size) {
  const unsigned char *bytes = bwi_unpack_bytes(from, size);
  uint64_t value = 0;
  for (size_t i = 0; bytes && i < size; i++)
    value |= (uint64_t)bytes[i] << 8 * i;
  return value;
}

unsigned bwi_unpack_u8(bwi_unpack *from) {
  return (unsigned)take(from, 1);
}
uint32_t bwi_unpack_u32(bwi_unpack *from) {
  return (uint32_t)take(from, 4);
}
uint64_t bwi_unpack_u64(bwi_unpack *from) {
  return take(from, 8);
}
double bwi_unpack_f32(bwi_unpack *from) {
  uint32_t bits = (uint32_t)take(from, 4);
  float value;
  memcpy(&value, &bits, sizeof value);
  return (double)value;
}
double bwi_unpack_f64(bwi_unpack *from) {
  uint64_t bits = take(from, 8);
  double value;
  memcpy(&value, &bits, sizeof value);
  return value;
}

bw_status bwi_unpack_fail(bwi_unpack *from, const char *format, ...) {
  char text[512];
  va_list arguments;
  va_start(arguments, format);
  vsnprintf(text, sizeof text, format, arguments);
  va_end(arguments);
  bw_fail(from->context, BW_FORMAT, "%s: in its %s: %s", from->name, from->part, text);
  bw_detail_text(from->context, "file", from->name);
  return BW_FORMAT;
}

bw_status bwi_unpack_end(bwi_unpack *from) {
  if (from->short_of)
    return bwi_unpack_fail(from, "the data end early");
  if (from->at != from->end)
    return bwi_unpack_fail(from, "%lld bytes too many", (long long)(from->end - from->at));
  return BW_OK;
}

/* ---- material table and options ------------------------------------------------------------ */

void bwi_pack_head(bwi_pack *pack, const bw_material_table *material_table,
                   const bw_library_options *o) {
  bwi_pack_u32(pack, (uint32_t)material_table->count);
  for (int32_t i = 1; i < material_table->count; i++) {
    const bw_solid_material *m = material_table->material[i];
    char name[BW_NAME] = {0};
    snprintf(name, sizeof name, "%s", m->name);
    bwi_pack_bytes(pack, name, sizeof name);
    bwi_pack_u8(pack, m->law[0]);
    bwi_pack_f64(pack, m->mu[0]);
    bwi_pack_f64(pack, m->lambda[0]);
    bwi_pack_f64(pack, m->density);
  }
  bwi_pack_u32(pack, (uint32_t)o->levels);
  bwi_pack_u8(pack, o->voids);
  bwi_pack_u32(pack, (uint32_t)o->directions);
  bwi_pack_u32(pack, (uint32_t)o->magnitudes);
  bwi_pack_u32(pack, (uint32_t)o->stretches);
  bwi_pack_u32(pack, (uint32_t)o->fibres);
  bwi_pack_f64(pack, o->strain);
  bwi_pack_f64(pack, o->ridge);
  bwi_pack_u32(pack, (uint32_t)o->representatives);
  bwi_pack_u64(pack, o->seed);
}

static bw_status unpack_material(bwi_unpack *from, int32_t number, const bw_rule *rule,
                                 bw_solid_material **material) {
  char name[BW_NAME] = {0};
  uint8_t law[8];
  double mu[8], lambda[8];
  const unsigned char *text = bwi_unpack_bytes(from, sizeof name);
  if (text)
    memcpy(name, text, sizeof name - 1);
  unsigned l = bwi_unpack_u8(from);
  double m = bwi_unpack_f64(from), la = bwi_unpack_f64(from), density = bwi_unpack_f64(from);
  for (int p = 0; p < 8; p++) {
    law[p] = (uint8_t)l;
    mu[p] = m;
    lambda[p] = la;
  }
  for (char *c = name; *c; c++)
    if ((unsigned char)*c < 32 || *c == 127)
      *c = '?';
  if (from->short_of)
    return bwi_unpack_end(from);
  bw_status status = bw_solid_material_points(from->context, name, rule, density, law, mu, lambda,
                                              0, NULL, NULL, material);
  if (status == BW_INVALID) {
    char why[256];
    snprintf(why, sizeof why, "%s", bw_message(from->context));
    return bwi_unpack_fail(from, "material %d cannot be: %s", (int)number, why);
  }
  return status;
}

bw_status bwi_unpack_head(bwi_unpack *from, bw_material_table **material_table,
                          bw_library_options *o) {
  bw_status status = BW_OK;
  bw_solid_material *material[7] = {NULL};
  bw_rule *rule = NULL;
  uint32_t count = bwi_unpack_u32(from);
  if (count < 2 || count > 8)
    BW_TRY(
        bwi_unpack_fail(from, "a material table of %lld materials; 1 to 7", (long long)count - 1));
  BW_TRY(bw_rule_create(from->context, 0, &rule));
  for (uint32_t i = 0; i + 1 < count; i++)
    BW_TRY(unpack_material(from, (int32_t)i + 1, rule, &material[i]));
  memset(o, 0, sizeof *o);
  o->levels = (int)bwi_unpack_u32(from);
  o->voids = bwi_unpack_u8(from) != 0;
  o->directions = (int)bwi_unpack_u32(from);
  o->magnitudes = (int)bwi_unpack_u32(from);
  o->stretches = (int)bwi_unpack_u32(from);
  o->fibres = (int)bwi_unpack_u32(from);
  o->strain = bwi_unpack_f64(from);
  o->ridge = bwi_unpack_f64(from);
  o->representatives = (int)bwi_unpack_u32(from);
  o->seed = bwi_unpack_u64(from);
  BW_TRY(bwi_unpack_end(from));
  if (bwi_check_options(from->context, o) != BW_OK) {
    char why[256];
    snprintf(why, sizeof why, "%s", bw_message(from->context));
    BW_TRY(bwi_unpack_fail(from, "options that cannot be: %s", why));
  }
  BW_TRY(bw_material_table_create(from->context, (int32_t)count,
                                  (const bw_solid_material *const *)material, material_table));
done:
  for (int i = 0; i < 7; i++)
    bw_release(material[i]);
  bw_release(rule);
  return status;
}

bool bwi_head_differs(const bw_material_table *p, const bw_library_options *a,
                      const bw_material_table *q, const bw_library_options *b, char *text,
                      size_t size) {
  if (p->count != q->count) {
    snprintf(text, size, "it has %d materials instead of %d", (int)q->count - 1, (int)p->count - 1);
    return true;
  }
  for (int32_t i = 1; i < p->count; i++) {
    const bw_solid_material *m = p->material[i], *n = q->material[i];
    if (m->law[0] != n->law[0] || m->mu[0] != n->mu[0] || m->lambda[0] != n->lambda[0] ||
        m->density != n->density) {
      snprintf(text, size,
               "material %d is %s of mu = %g Pa, lambda = %g Pa, %g kg/m3 there, %s of mu = %g Pa, "
               "lambda = %g Pa, %g kg/m3 here",
               (int)i, bw_law_word((bw_law)n->law[0]), n->mu[0], n->lambda[0], n->density,
               bw_law_word((bw_law)m->law[0]), m->mu[0], m->lambda[0], m->density);
      return true;
    }
  }
  const struct {
    const char *name;
    double here, there;
  } option[] = {{"levels", a->levels, b->levels},
                {"voids", a->voids, b->voids},
                {"directions", a->directions, b->directions},
                {"magnitudes", a->magnitudes, b->magnitudes},
                {"stretches", a->stretches, b->stretches},
                {"fibres", a->fibres, b->fibres},
                {"strain", a->strain, b->strain},
                {"ridge", a->ridge, b->ridge},
                {"representatives", a->representatives, b->representatives}};
  for (size_t i = 0; i < sizeof option / sizeof option[0]; i++)
    if (option[i].here != option[i].there) {
      snprintf(text, size, "its option %s is %g instead of %g", option[i].name, option[i].there,
               option[i].here);
      return true;
    }
  if (a->seed != b->seed) {
    snprintf(text, size, "its seed is %llu instead of %llu", (unsigned long long)b->seed,
             (unsigned long long)a->seed);
    return true;
  }
  return false;
}

/* ---- fits --------------------------------------------------------------------------------- */

void bwi_pack_fit(bwi_pack *pack, const bw_solid_material *m, const bw_fit_error *e) {
  size_t n = (size_t)m->rule->count, fibres = n * (size_t)m->fibre_count;
  bwi_pack_u8(pack, (unsigned)m->fibre_count);
  for (int d = 0; d < 3; d++)
    bwi_pack_f32(pack, m->rule->spread[d]);
  bwi_pack_f64(pack, m->density);
  const double error[] = {e->median,      e->worst, e->naive_median,
                          e->naive_worst, e->force, e->naive_force};
  for (size_t i = 0; i < sizeof error / sizeof error[0]; i++)
    bwi_pack_f32(pack, error[i]);
  bwi_pack_u32(pack, (uint32_t)e->samples);
  bwi_pack_bytes(pack, m->law, n);
  for (size_t p = 0; p < n; p++)
    bwi_pack_f32(pack, m->mu[p]);
  for (size_t p = 0; p < n; p++)
    bwi_pack_f32(pack, m->lambda[p]);
  for (size_t p = 0; p < fibres; p++)
    bwi_pack_f32(pack, m->fibre_stiffness[p]);
  for (size_t p = 0; p < 3 * fibres; p++)
    bwi_pack_f32(pack, m->fibre[p]);
}

bw_status bwi_unpack_fit(bwi_unpack *from, int level, int32_t number, bw_solid_material **fit,
                         bw_fit_error *error) {
  bw_status status = BW_OK;
  bw_rule *rule = NULL;
  uint8_t law[8];
  double mu[8], lambda[8], stiffness[24], fibre[72], spread[3], numbers[6];
  char name[BW_NAME];
  const size_t n = 8;
  unsigned fibres = bwi_unpack_u8(from);
  for (int d = 0; d < 3; d++)
    spread[d] = bwi_unpack_f32(from);
  double density = bwi_unpack_f64(from);
  for (int i = 0; i < 6; i++)
    numbers[i] = bwi_unpack_f32(from);
  uint32_t samples = bwi_unpack_u32(from);
  if (from->short_of)
    return bwi_unpack_end(from);
  if (fibres > 3)
    return bwi_unpack_fail(from, "fit %d has %u fibres at a point", (int)number + 1, fibres);
  const unsigned char *laws = bwi_unpack_bytes(from, n);
  if (laws)
    memcpy(law, laws, n);
  for (size_t p = 0; p < n; p++)
    mu[p] = bwi_unpack_f32(from);
  for (size_t p = 0; p < n; p++)
    lambda[p] = bwi_unpack_f32(from);
  for (size_t p = 0; p < n * fibres; p++)
    stiffness[p] = bwi_unpack_f32(from);
  for (size_t p = 0; p < 3 * n * fibres; p++)
    fibre[p] = bwi_unpack_f32(from);
  if (from->short_of)
    return bwi_unpack_end(from);
  /* `0 < x` is false for NaN too. */
  for (int i = 0; i < 6; i++)
    if (isnan(numbers[i]))
      return bwi_unpack_fail(from, "fit %d has errors that are no numbers", (int)number + 1);
  *error = (bw_fit_error){numbers[0],
                          numbers[1],
                          numbers[2],
                          numbers[3],
                          numbers[4],
                          numbers[5],
                          (int)(samples & 0x7fffffff)};
  snprintf(name, sizeof name, "metamaterial %d of level %d", (int)number + 1, level);
  status = bw_rule_create_spread(from->context, 1, spread, &rule);
  if (status == BW_OK)
    status = bw_solid_material_points(from->context, name, rule, density, law, mu, lambda,
                                      (int)fibres, stiffness, fibre, fit);
  bw_release(rule);
  if (status == BW_INVALID) {
    char why[256];
    snprintf(why, sizeof why, "%s", bw_message(from->context));
    return bwi_unpack_fail(from, "fit %d cannot be: %s", (int)number + 1, why);
  }
  return status;
}
