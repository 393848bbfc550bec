/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* Input decks for CalculiX (and, but for the solution step, Abaqus): nodes and elements numbered
 * from 1 in mesh order, sets NALL and EALL, one ELSET per region, called as it is or REGION_TAG. */
#include "io/inp_joints.h"
#include "io/internal.h"

#include <math.h>
#include <stdio.h>
#include <string.h>
#include <strings.h>

/* The elements e of which of[e] is `value`. */
static void write_set(bw_writer *writer, const bw_mesh *mesh, const char *name, const int32_t *of,
                      int32_t value) {
  bw_writer_print(writer, "*ELSET, ELSET=%s\n", name);
  int in_line = 0;
  for (int32_t e = 0; e < mesh->element_count; e++)
    if (of[e] == value) {
      bw_writer_integer(writer, (int64_t)e + 1);
      bw_writer_bytes(writer, ++in_line % 16 ? "," : "\n", 1);
    }
  if (in_line % 16)
    bw_writer_bytes(writer, "\n", 1);
}

static bool has_prefix(const char *text, const char *prefix) {
  return strncasecmp(text, prefix, strlen(prefix)) == 0;
}

/* Whether a set can have the name of region i: a word of letters, digits, '-' and '_', which no
 * other set has, whatever the case. */
static bool is_set_name(const bw_mesh *mesh, int32_t i) {
  static const char allowed[] = "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ"
                                "0123456789-_";
  const char *name = mesh->regions[i].name.text;
  if (!name[0] || name[strspn(name, allowed)] || strchr("0123456789-_", name[0]))
    return false;
  if (strcasecmp(name, "EALL") == 0 || strcasecmp(name, "NALL") == 0)
    return false;
  if (has_prefix(name, "MATERIAL") || has_prefix(name, "REGION_"))
    return false;
  for (int32_t k = 0; k < mesh->region_count; k++)
    if (k != i && strcasecmp(name, mesh->regions[k].name.text) == 0)
      return false;
  return true;
}

/* At most so many regions, in ascending order, are written as sets. */
enum { MAX_SETS = 1000 };

static bw_name set_name(const bw_mesh *mesh, int32_t i) {
  bw_name name = mesh->regions[i].name;
  long long tag = mesh->regions[i].tag;
  if (!is_set_name(mesh, i))
    snprintf(name.text, sizeof name.text, "REGION_%s%lld", tag < 0 ? "M" : "",
             tag < 0 ? -tag : tag);
  return name;
}

static void write_regions(bw_writer *writer, const bw_mesh *mesh) {
  for (int32_t i = 0; i < mesh->region_count && i < MAX_SETS; i++) {
    bw_name name = set_name(mesh, i);
    write_set(writer, mesh, name.text, mesh->region, i);
  }
}

static void write_mesh(bw_writer *writer, const bw_mesh *mesh) {
  bw_writer_print(writer, "*NODE, NSET=NALL\n");
  for (int32_t i = 0; i < mesh->node_count; i++) {
    bw_writer_integer(writer, (int64_t)i + 1);
    for (size_t k = 0; k < 3; k++) {
      bw_writer_bytes(writer, ", ", 2);
      bwi_inp_write_number(writer, mesh->node[3 * (size_t)i + k]);
    }
    bw_writer_bytes(writer, "\n", 1);
  }
  bw_writer_print(writer, "*ELEMENT, TYPE=%s, ELSET=EALL\n", mesh->order == 2 ? "C3D10" : "C3D4");
  size_t width = (size_t)mesh->nodes_per_element;
  for (int32_t e = 0; e < mesh->element_count; e++) {
    bw_writer_integer(writer, (int64_t)e + 1);
    for (size_t k = 0; k < width; k++) {
      bw_writer_bytes(writer, ", ", 2);
      bw_writer_integer(writer, (int64_t)mesh->element[(size_t)e * width + k] + 1);
    }
    bw_writer_bytes(writer, "\n", 1);
  }
  if (mesh->region)
    write_regions(writer, mesh);
}

bw_status bwi_inp_write_mesh(bw_writer *writer, const bw_mesh *mesh) {
  bw_writer_print(writer, "*HEADING\nbarwright\n");
  write_mesh(writer, mesh);
  return bw_writer_bytes(writer, NULL, 0);
}

/* ---- a whole analysis ---------------------------------------------------------------------- */

static void write_line(bw_writer *writer, const char *card, double value) {
  bw_writer_print(writer, "%s\n", card);
  bwi_inp_write_number(writer, value);
  bw_writer_bytes(writer, "\n", 1);
}

/* The region whose elements are those of material i, written as a set; or -1. */
static int32_t region_of_material(const bw_inp_deck *deck, int32_t i) {
  const bw_mesh *mesh = deck->mesh;
  int32_t first = 0;
  while (mesh->region && first < mesh->element_count && deck->material_of[first] != i)
    first++;
  if (!mesh->region || first == mesh->element_count || mesh->region[first] >= MAX_SETS)
    return -1;
  for (int32_t e = 0; e < mesh->element_count; e++)
    if ((deck->material_of[e] == i) != (mesh->region[e] == mesh->region[first]))
      return -1;
  return mesh->region[first];
}

/* The name of a material and its set of elements: one is called as if there were no others. */
static void write_material(bw_writer *writer, const bw_inp_deck *deck, int32_t i) {
  const bw_inp_material *m = &deck->material[i];
  char number[16] = "";
  if (deck->material_count > 1)
    snprintf(number, sizeof number, "_%d", i + 1);
  bw_writer_print(writer, "*MATERIAL, NAME=MATERIAL%s\n", number);
  if (m->isotropic) {
    bw_writer_print(writer, "*ELASTIC\n");
    bwi_inp_write_number(writer, m->young);
    bw_writer_bytes(writer, ", ", 2);
    bwi_inp_write_number(writer, m->poisson);
    bw_writer_bytes(writer, "\n", 1);
  } else {
    bw_writer_print(writer, "*ELASTIC, TYPE=ANISO\n");
    for (int k = 0; k < 21; k++) { /* eight to a line, as the card asks */
      bwi_inp_write_number(writer, m->stiffness[k]);
      bw_writer_print(writer, k % 8 == 7 || k == 20 ? "\n" : ", ");
    }
  }
  if (m->density > 0)
    write_line(writer, "*DENSITY", m->density);
  if (deck->temperature)
    write_line(writer, "*EXPANSION, ZERO=0", m->expansion);
  bw_name set = {"EALL"};
  if (deck->material_count > 1) {
    int32_t region = region_of_material(deck, i);
    if (region >= 0)
      set = set_name(deck->mesh, region);
    else {
      snprintf(set.text, sizeof set.text, "MATERIAL%s", number);
      write_set(writer, deck->mesh, set.text, deck->material_of, i);
    }
  }
  bw_writer_print(writer, "*SOLID SECTION, ELSET=%s, MATERIAL=MATERIAL%s\n", set.text, number);
}

static void write_materials(bw_writer *writer, const bw_inp_deck *deck) {
  for (int32_t i = 0; i < deck->material_count; i++)
    write_material(writer, deck, i);
  if (deck->temperature) /* every node needs one before the step that changes it */
    bw_writer_print(writer, "*INITIAL CONDITIONS, TYPE=TEMPERATURE\nNALL, 0\n");
}

/* The first term of an equation is the one that CalculiX eliminates: the largest leads. */
static void write_equation(bw_writer *writer, int32_t node, const double normal[3]) {
  int max = 0, terms = 0;
  for (int k = 0; k < 3; k++) {
    terms += normal[k] != 0;
    if (fabs(normal[k]) > fabs(normal[max]))
      max = k;
  }
  if (terms == 0)
    return;
  if (terms == 1) {
    bw_writer_print(writer, "*BOUNDARY\n%lld, %d, %d\n", (long long)node + 1, max + 1, max + 1);
    return;
  }
  bw_writer_print(writer, "*EQUATION\n%d\n", terms);
  for (int i = 0; i < 3; i++) {
    int k = (max + i) % 3;
    if (normal[k] == 0)
      continue;
    bw_writer_print(writer, "%s%lld, %d, ", i ? ", " : "", (long long)node + 1, k + 1);
    bwi_inp_write_number(writer, normal[k]);
  }
  bw_writer_bytes(writer, "\n", 1);
}

static void write_supports(bw_writer *writer, const bw_inp_deck *deck) {
  for (int64_t i = 0; i < deck->equation_count; i++)
    write_equation(writer, deck->equation_node[i], deck->equation_normal + 3 * i);
  int64_t supports = deck->fixed_count - deck->isostatic_count;
  if (supports > 0)
    bw_writer_print(writer, "*BOUNDARY\n");
  for (int64_t i = 0; i < deck->fixed_count; i++) {
    if (i == supports)
      bw_writer_print(writer,
                      "** Isostatic constraints: no supports of the model. They hold a free "
                      "body and carry no load\n** where its loads balance. Remove them "
                      "before you add contact, springs or supports.\n*BOUNDARY\n");
    int direction = deck->fixed_direction[i] + 1;
    /* Without a value: before the step CalculiX takes zero only; write_moved says the rest. */
    bw_writer_print(writer, "%lld, %d, %d\n", (long long)deck->fixed_node[i] + 1, direction,
                    direction);
  }
}

static void write_moved(bw_writer *writer, const bw_inp_deck *deck) {
  bool any = false;
  for (int64_t i = 0; i < deck->fixed_count; i++) {
    if (deck->fixed_value[i] == 0)
      continue;
    if (!any)
      bw_writer_print(writer, "*BOUNDARY\n");
    any = true;
    int direction = deck->fixed_direction[i] + 1;
    bw_writer_print(writer, "%lld, %d, %d, ", (long long)deck->fixed_node[i] + 1, direction,
                    direction);
    bwi_inp_write_number(writer, deck->fixed_value[i]);
    bw_writer_bytes(writer, "\n", 1);
  }
}

static void write_loads(bw_writer *writer, const bw_inp_deck *deck) {
  bool any = false;
  for (int64_t i = 0; deck->force && i < 3 * (int64_t)deck->mesh->node_count; i++) {
    if (deck->force[i] == 0)
      continue;
    if (!any)
      bw_writer_print(writer, "*CLOAD\n");
    any = true;
    bw_writer_print(writer, "%lld, %d, ", (long long)(i / 3) + 1, (int)(i % 3) + 1);
    bwi_inp_write_number(writer, deck->force[i]);
    bw_writer_bytes(writer, "\n", 1);
  }
  double size = bw_norm(deck->gravity);
  if (size > 0) {
    bw_writer_print(writer, "*DLOAD\nEALL, GRAV, ");
    bwi_inp_write_number(writer, size);
    for (int k = 0; k < 3; k++) {
      bw_writer_bytes(writer, ", ", 2);
      bwi_inp_write_number(writer, deck->gravity[k] / size);
    }
    bw_writer_bytes(writer, "\n", 1);
  }
}

static void write_temperatures(bw_writer *writer, const bw_inp_deck *deck) {
  if (!deck->temperature)
    return;
  bw_writer_print(writer, "*TEMPERATURE\n");
  for (int64_t i = 0; i < deck->mesh->node_count; i++) {
    bw_writer_integer(writer, i + 1);
    bw_writer_bytes(writer, ", ", 2);
    bwi_inp_write_number(writer, deck->temperature[i]);
    bw_writer_bytes(writer, "\n", 1);
  }
}

static void write_step(bw_writer *writer, const bw_inp_deck *deck, const bwi_inp_joints *joints) {
  bw_writer_print(writer, "*STEP\n");
  if (deck->modes > 0) {
    bw_writer_print(writer, "*FREQUENCY\n%d\n", deck->modes);
  } else {
    bw_writer_print(writer, "*STATIC\n");
    write_moved(writer, deck);
    write_loads(writer, deck);
    if (joints)
      bwi_inp_write_joint_loads(writer, joints);
    write_temperatures(writer, deck);
  }
  bw_writer_print(writer, "*NODE PRINT, NSET=NALL\nU\n");
  if (joints && joints->node_count > 0)
    bw_writer_print(writer, "*NODE PRINT, NSET=NJOINTS\nU\n");
  bw_writer_print(writer, "*NODE FILE\nU\n*EL FILE\nS\n*END STEP\n");
}

static bw_status check_deck(bw_context *context, const bw_inp_deck *deck) {
  double size = bw_norm(deck->gravity);
  for (int32_t i = 0; i < deck->material_count; i++)
    if ((size > 0 || deck->modes > 0) && !(deck->material[i].density > 0))
      return bw_fail(context, BW_INVALID,
                     "an input deck with %s needs a density, but it is %g kg/m3: give the material "
                     "one",
                     deck->modes > 0 ? "a frequency step" : "gravity", deck->material[i].density);
  for (int64_t i = 0; i < deck->fixed_count; i++)
    if (deck->fixed_node[i] < 0 || deck->fixed_node[i] >= deck->mesh->node_count ||
        deck->fixed_direction[i] < 0 || deck->fixed_direction[i] > 2)
      return bw_fail(
          context, BW_INVALID,
          "support %lld of the input deck fixes node %d in direction %d: the nodes are 1 to "
          "%d, the directions 1 to 3",
          (long long)i + 1, (int)deck->fixed_node[i] + 1, deck->fixed_direction[i] + 1,
          (int)deck->mesh->node_count);
  return BW_OK;
}

bw_status bw_inp_write(bw_context *context, const bw_inp_deck *deck, const char *path) {
  return bwi_inp_write(context, deck, NULL, path);
}

bw_status bwi_inp_write(bw_context *context, const bw_inp_deck *deck, const bwi_inp_joints *joints,
                        const char *path) {
  bw_writer *writer;
  bw_status status = check_deck(context, deck);
  if (status == BW_OK)
    status = bw_writer_open(context, path, &writer);
  if (status != BW_OK)
    return status;
  bw_writer_print(writer, "*HEADING\n");
  /* The title is one line and must not look like a keyword. */
  for (const char *at = deck->title ? deck->title : "barwright"; *at; at++)
    bw_writer_bytes(writer, *at == '\n' || *at == '\r' || *at == '*' ? " " : at, 1);
  bw_writer_bytes(writer, "\n", 1);
  write_mesh(writer, deck->mesh);
  write_materials(writer, deck);
  if (joints)
    bwi_inp_write_joints(writer, deck, joints);
  write_supports(writer, deck);
  write_step(writer, deck, joints);
  return bw_writer_commit(writer);
}
