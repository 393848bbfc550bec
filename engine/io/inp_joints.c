/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* Joints of input decks, *EQUATION, *SPRING and *MASS, and numbers. */
#include "io/inp_joints.h"

#include <stdio.h>

#include "io/internal.h"
#include "io/locale.h"

bw_status bwi_inp_list_add(bw_context *context, bwi_inp_list *list, int32_t node, int direction,
                           double value) {
  if (!bw_grow(context, (void **)&list->item, &list->capacity, list->count, 1, sizeof *list->item))
    return BW_MEMORY;
  list->item[list->count++] = (bwi_inp_value){node, direction, value};
  return BW_OK;
}

void bwi_inp_joints_clear(bwi_inp_joints *joints) {
  bw_free(joints->node);
  bw_free(joints->term.item);
  bw_free(joints->first);
  bw_free(joints->spring.item);
  bw_free(joints->mass.item);
  bw_free(joints->fixed.item);
  bw_free(joints->force.item);
}

/* CalculiX reads 20 characters of a number and silently drops the rest, exponent and all: numbers
 * are written with as many digits as fit. */
void bwi_inp_write_number(bw_writer *writer, double value) {
  enum { FIELD = 20 };
  char text[BW_NUMBER_BYTES];
  int length = bw_format_number(value, text);
  if (length > FIELD) {
    locale_t before = uselocale(bwi_c_locale());
    for (int digits = 16; length > FIELD && digits > 9; digits--)
      length = snprintf(text, sizeof text, "%.*g", digits, value);
    uselocale(before);
  }
  bw_writer_bytes(writer, text, (size_t)length);
}

/* CalculiX reads four terms from each line. */
enum { TERMS_OF_LINE = 4 };

static void write_equations(bw_writer *writer, const bwi_inp_joints *j) {
  for (size_t i = 0; i < j->equation_count; i++) {
    size_t first = j->first[i];
    size_t count = (i + 1 < j->equation_count ? j->first[i + 1] : j->term.count) - first;
    bw_writer_print(writer, "*EQUATION\n%lld\n", (long long)count);
    for (size_t k = 0; k < count; k++) {
      const bwi_inp_value *term = &j->term.item[first + k];
      bw_writer_print(writer, "%lld, %d, ", (long long)term->node + 1, term->direction + 1);
      bwi_inp_write_number(writer, term->value);
      bw_writer_print(writer,
                      k + 1 == count || k % TERMS_OF_LINE == TERMS_OF_LINE - 1 ? "\n" : ", ");
    }
  }
}

/* CalculiX passes over a spring constant without a decimal point. */
static void write_constant(bw_writer *writer, double value) {
  char text[32];
  locale_t before = uselocale(bwi_c_locale());
  int length = snprintf(text, sizeof text, "%.12e\n", value);
  uselocale(before);
  bw_writer_bytes(writer, text, (size_t)length);
}

/* Elements of one node: those that follow each other with the same value share a set. */
static void write_points(bw_writer *writer, const bwi_inp_list *list, bool springs,
                         int64_t element) {
  const char *name = springs ? "SPRING" : "MASS";
  for (size_t i = 0, end; i < list->count; i = end) {
    const bwi_inp_value *of = &list->item[i];
    long long set = (long long)i + 1;
    bw_writer_print(writer, "*ELEMENT, TYPE=%s, ELSET=%s_%lld\n", springs ? "SPRING1" : "MASS",
                    name, set);
    for (end = i; end < list->count && list->item[end].value == of->value &&
                  list->item[end].direction == of->direction;
         end++)
      bw_writer_print(writer, "%lld, %lld\n", (long long)(element + (int64_t)end) + 1,
                      (long long)list->item[end].node + 1);
    bw_writer_print(writer, "*%s, ELSET=%s_%lld\n", name, name, set);
    if (springs)
      bw_writer_print(writer, "%d\n", of->direction + 1);
    write_constant(writer, of->value);
  }
}

void bwi_inp_write_joints(bw_writer *writer, const bw_inp_deck *deck, const bwi_inp_joints *j) {
  int64_t elements = deck->mesh->element_count;
  if (j->node_count > 0)
    bw_writer_print(writer, "** Nodes of joints: remote points (one for the displacement, one for "
                            "the rotation), points of springs and masses\n*NODE, NSET=NJOINTS\n");
  for (size_t i = 0; i < j->node_count; i++) {
    bw_writer_integer(writer, (int64_t)deck->mesh->node_count + (int64_t)i + 1);
    for (size_t k = 0; k < 3; k++) {
      bw_writer_bytes(writer, ", ", 2);
      bwi_inp_write_number(writer, j->node[3 * i + k]);
    }
    bw_writer_bytes(writer, "\n", 1);
  }
  write_equations(writer, j);
  write_points(writer, &j->spring, true, elements);
  if (deck->modes > 0)
    write_points(writer, &j->mass, false, elements + (int64_t)j->spring.count);
  for (size_t i = 0; i < j->fixed.count; i++)
    bw_writer_print(writer, "%s%lld, %d, %d\n", i == 0 ? "*BOUNDARY\n" : "",
                    (long long)j->fixed.item[i].node + 1, j->fixed.item[i].direction + 1,
                    j->fixed.item[i].direction + 1);
}

void bwi_inp_write_joint_loads(bw_writer *writer, const bwi_inp_joints *j) {
  for (int forces = 0; forces < 2; forces++) {
    const bwi_inp_list *list = forces ? &j->force : &j->fixed;
    bool any = false;
    for (size_t i = 0; i < list->count; i++) {
      const bwi_inp_value *of = &list->item[i];
      if (of->value == 0)
        continue;
      if (!any)
        bw_writer_print(writer, forces ? "*CLOAD\n" : "*BOUNDARY\n");
      any = true;
      bw_writer_print(writer, "%lld, %d, ", (long long)of->node + 1, of->direction + 1);
      if (!forces)
        bw_writer_print(writer, "%d, ", of->direction + 1);
      bwi_inp_write_number(writer, of->value);
      bw_writer_bytes(writer, "\n", 1);
    }
  }
}
