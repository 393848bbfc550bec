/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* STEP (ISO 10303-21, AP214): closed shells as solids with flat faces, cylinders and cones
 * (flat_faces.h). A shell inside of another one is a void of it. Faces have the names of the
 * surface. What else was curved is written as the flat facets that it has.
 *
 * A chain is what the border of two faces has from one kept point to the next: a straight edge of
 * the solid, an arc, or a circle. Faces that go around a whole cylinder have no seam, only the two
 * circles. */
#include "io/surface_write.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "io/flat_faces.h"
#include "io/round_faces.h"

typedef struct step {
  bw_context *context;
  bw_writer *writer;
  double unit;
  bwi_flat_faces faces;
  int64_t *chain;      /* per edge that names a chain: its number in the file, 0: not there yet */
  int32_t *chain_from; /* its first point, and the one behind */
  int32_t *chain_second;
  int64_t *vertex; /* per point: the number of its VERTEX_POINT; the point's is one less */
  int64_t next;    /* number of the next entity */
} step;

/* ---- entities -------------------------------------------------------------------------------- */

/* Reals of STEP have a point. */
static void put_real(bw_writer *writer, double value) {
  char text[BW_NUMBER_BYTES];
  bw_format_number(value, text);
  size_t digits = strcspn(text, "eE");
  bw_writer_bytes(writer, text, digits);
  if (!memchr(text, '.', digits))
    bw_writer_bytes(writer, ".", 1);
  if (text[digits])
    bw_writer_print(writer, "E%s", text + digits + 1);
}

static void put_triple(bw_writer *writer, const double x[3]) {
  for (int k = 0; k < 3; k++) {
    bw_writer_bytes(writer, k ? "," : "(", 1);
    put_real(writer, x[k]);
  }
  bw_writer_bytes(writer, ")", 1);
}

/* Those with one list of three numbers; gives the number of the entity. */
static int64_t put_vector(step *s, const char *type, const double x[3]) {
  bw_writer_print(s->writer, "#%lld=%s('',", (long long)s->next, type);
  put_triple(s->writer, x);
  bw_writer_print(s->writer, ");\n");
  return s->next++;
}

static int64_t vertex_of(step *s, int32_t point) {
  if (s->vertex[point] == 0) {
    int64_t own = put_vector(s, "CARTESIAN_POINT", s->faces.topology->point + 3 * (size_t)point);
    bw_writer_print(s->writer, "#%lld=VERTEX_POINT('',#%lld);\n", (long long)s->next,
                    (long long)own);
    s->vertex[point] = s->next++;
  }
  return s->vertex[point];
}

static int64_t put_placement(step *s, const double at[3], const double axis[3],
                             const double reference[3]) {
  int64_t point = put_vector(s, "CARTESIAN_POINT", at), z = put_vector(s, "DIRECTION", axis);
  int64_t x = put_vector(s, "DIRECTION", reference);
  bw_writer_print(s->writer, "#%lld=AXIS2_PLACEMENT_3D('',#%lld,#%lld,#%lld);\n",
                  (long long)s->next, (long long)point, (long long)z, (long long)x);
  return s->next++;
}

/* The direction from a to b, of length 1. */
static void direction_of(const double a[3], const double b[3], double direction[3]) {
  for (int k = 0; k < 3; k++)
    direction[k] = b[k] - a[k];
  double length = bw_norm(direction);
  for (int k = 0; k < 3; k++)
    direction[k] /= length;
}

/* The LINE from a point, of which `vertex` is the vertex, to another one. */
static int64_t put_line(step *s, const double a[3], const double b[3], int64_t vertex) {
  double along[3];
  direction_of(a, b, along);
  int64_t direction = put_vector(s, "DIRECTION", along);
  bw_writer_print(s->writer, "#%lld=VECTOR('',#%lld,1.);\n#%lld=LINE('',#%lld,#%lld);\n",
                  (long long)s->next, (long long)direction, (long long)s->next + 1,
                  (long long)vertex - 1, (long long)s->next);
  s->next += 2;
  return s->next - 1;
}

/* The CIRCLE from a point on by another one; it runs from the first to the second the short way. */
static int64_t put_circle(step *s, const bwi_round *round, const double a[3], const double b[3]) {
  double centre[3], u[3], v[3], turn[3], axis[3];
  double radius = bwi_round_circle(round, a, centre);
  direction_of(centre, a, u);
  direction_of(centre, b, v);
  bw_cross(u, v, turn);
  const double sign = bw_dot(turn, round->axis) < 0 ? -1 : 1;
  for (int k = 0; k < 3; k++)
    axis[k] = sign * round->axis[k];
  int64_t placement = put_placement(s, centre, axis, u);
  bw_writer_print(s->writer, "#%lld=CIRCLE('',#%lld,", (long long)s->next, (long long)placement);
  put_real(s->writer, radius);
  bw_writer_print(s->writer, ");\n");
  return s->next++;
}

/* The chain that begins with a side at a kept point: its number, whether it runs the same way, and
 * the side behind it. */
static int64_t chain_of(step *s, int64_t side, bool *same, int64_t *behind) {
  const bwi_topology *t = s->faces.topology;
  const int32_t from = bwi_side_from(t, side), second = bwi_side_to(t, side);
  int32_t to = second;
  int64_t name = t->edge_of[side];
  for (*behind = bwi_flat_next(&s->faces, side); !s->faces.kept[to];
       *behind = bwi_flat_next(&s->faces, *behind)) {
    to = bwi_side_to(t, *behind);
    name = t->edge_of[*behind] < name ? t->edge_of[*behind] : name;
  }
  if (s->chain[name] == 0) {
    const double *a = t->point + 3 * (size_t)from;
    const bwi_round *round = bwi_flat_round_of(&s->faces, side);
    int64_t first = vertex_of(s, from), last = vertex_of(s, to);
    int64_t curve = round ? put_circle(s, round, a, t->point + 3 * (size_t)second)
                          : put_line(s, a, t->point + 3 * (size_t)to, first);
    bw_writer_print(s->writer, "#%lld=EDGE_CURVE('',#%lld,#%lld,#%lld,.T.);\n", (long long)s->next,
                    (long long)first, (long long)last, (long long)curve);
    s->chain[name] = s->next++;
    s->chain_from[name] = from;
    s->chain_second[name] = second;
  }
  *same = s->chain_from[name] == from && s->chain_second[name] == second;
  return s->chain[name];
}

/* The EDGE_LOOP of a loop; sides: room for its entities. */
static int64_t put_loop(step *s, int64_t side, int64_t *entity) {
  const bwi_topology *t = s->faces.topology;
  while (!s->faces.kept[bwi_side_from(t, side)])
    side = bwi_flat_next(&s->faces, side);
  int64_t at = side, count = 0;
  do {
    bool same;
    int64_t edge = chain_of(s, at, &same, &at);
    bw_writer_print(s->writer, "#%lld=ORIENTED_EDGE('',*,*,#%lld,%s);\n", (long long)s->next,
                    (long long)edge, same ? ".T." : ".F.");
    entity[count++] = s->next++;
  } while (at != side);
  bw_writer_print(s->writer, "#%lld=EDGE_LOOP('',(", (long long)s->next);
  for (int64_t i = 0; i < count; i++)
    bw_writer_print(s->writer, "%s#%lld", i ? "," : "", (long long)entity[i]);
  bw_writer_print(s->writer, "));\n");
  return s->next++;
}

static double area_of_loop(const step *s, int64_t side, const double n[3]) {
  const bwi_topology *t = s->faces.topology;
  const double *origin = t->point + 3 * (size_t)bwi_side_from(t, side);
  double sum[3] = {0, 0, 0};
  int64_t at = side;
  do {
    const double *a = t->point + 3 * (size_t)bwi_side_from(t, at),
                 *b = t->point + 3 * (size_t)bwi_side_to(t, at);
    const double u[3] = {a[0] - origin[0], a[1] - origin[1], a[2] - origin[2]};
    const double v[3] = {b[0] - origin[0], b[1] - origin[1], b[2] - origin[2]};
    double cross[3];
    bw_cross(u, v, cross);
    for (int k = 0; k < 3; k++)
      sum[k] += cross[k];
    at = bwi_flat_next(&s->faces, at);
  } while (at != side);
  return bw_dot(sum, n);
}

/* The PLANE of a face: through the first corner of its largest facet. */
static int64_t put_plane(step *s, int32_t face) {
  const bwi_topology *t = s->faces.topology;
  const int32_t *c = t->corner + 3 * (size_t)s->faces.seed[face];
  const double *a = t->point + 3 * (size_t)c[0], *b = t->point + 3 * (size_t)c[1];
  double n[3], along[3] = {b[0] - a[0], b[1] - a[1], b[2] - a[2]};
  bwi_flat_normal(t, s->faces.seed[face], n);
  double area = bw_norm(n), length = bw_norm(along);
  for (int k = 0; k < 3; k++)
    n[k] /= area, along[k] /= length;
  int64_t placement = put_placement(s, a, n, along);
  bw_writer_print(s->writer, "#%lld=PLANE('',#%lld);\n", (long long)s->next, (long long)placement);
  return s->next++;
}

/* The CYLINDRICAL_SURFACE or CONICAL_SURFACE of a face. */
static int64_t put_round(step *s, const bwi_round *round) {
  double across[3], other[3];
  bw_across(round->axis, across, other);
  int64_t placement = put_placement(s, round->origin, round->axis, across);
  bw_writer_print(s->writer, "#%lld=%s('',#%lld,", (long long)s->next,
                  round->slope > 0 ? "CONICAL_SURFACE" : "CYLINDRICAL_SURFACE",
                  (long long)placement);
  put_real(s->writer, round->radius);
  if (round->slope > 0) {
    bw_writer_bytes(s->writer, ",", 1);
    put_real(s->writer, atan(round->slope));
  }
  bw_writer_print(s->writer, ");\n");
  return s->next++;
}

/* Text within apostrophes. What is no ASCII is written by the numbers of its characters, as ISO
 * 10303-21 asks for; bytes that are no UTF-8 are '?'. */
static void put_text(const step *s, const char *text) {
  const unsigned char *at = (const unsigned char *)text;
  while (*at) {
    unsigned char lead = *at++;
    int more = lead < 0xc0 ? 0 : lead < 0xe0 ? 1 : lead < 0xf0 ? 2 : lead < 0xf8 ? 3 : 0;
    uint32_t character = more == 0 ? lead : lead & (0x3fU >> more);
    for (; more > 0 && (*at & 0xc0) == 0x80; more--)
      character = character << 6 | (*at++ & 0x3fU);
    if (more > 0 || (lead >= 0x80 && lead < 0xc0) || lead >= 0xf8 || character > 0x10ffff)
      character = '?';
    if (lead < 0x80 && (lead == '\'' || lead == '\\'))
      bw_writer_print(s->writer, "%c%c", lead, lead);
    else if (character >= ' ' && character < 0x7f)
      bw_writer_print(s->writer, "%c", (int)character);
    else if (character <= 0xffff)
      bw_writer_print(s->writer, "\\X2\\%04X\\X0\\", (unsigned)character);
    else
      bw_writer_print(s->writer, "\\X4\\%08X\\X0\\", (unsigned)character);
  }
}

/* The name that the surface has for a face, or "face" and its number. */
static void put_face_name(const step *s, int32_t face) {
  const bw_face_names *names = s->faces.surface->names;
  int32_t group = names ? s->faces.surface->group[s->faces.seed[face]] : -1;
  if (group >= 0 && group < names->count && names->name[group].text[0])
    put_text(s, names->name[group].text);
  else
    bw_writer_print(s->writer, "face %d", (int)face + 1);
}

/* Puts the outer loop of a flat face first. */
static void sort_loops(const step *s, int32_t face, int64_t *loop, int64_t loops) {
  double n[3], most = -HUGE_VAL;
  int64_t outer = 0;
  bwi_flat_normal(s->faces.topology, s->faces.seed[face], n);
  for (int64_t i = 0; i < loops; i++) {
    double area = area_of_loop(s, loop[i], n);
    outer = area > most ? i : outer;
    most = area > most ? area : most;
  }
  int64_t first = loop[outer];
  loop[outer] = loop[0];
  loop[0] = first;
}

/* A face with its loops; bound: room for one more than these. */
static int64_t put_face(step *s, int32_t face, int64_t *loop, int64_t loops, int64_t *bound,
                        int64_t *entity) {
  const bwi_round *round = s->faces.round_of && s->faces.round_of[face] >= 0
                               ? &s->faces.round[s->faces.round_of[face]]
                               : NULL;
  if (!round)
    sort_loops(s, face, loop, loops);
  for (int64_t i = 0; i < loops; i++) {
    int64_t own = put_loop(s, loop[i], entity);
    bw_writer_print(s->writer, "#%lld=%s('',#%lld,.T.);\n", (long long)s->next,
                    i == 0 && (!round || loops == 1) ? "FACE_OUTER_BOUND" : "FACE_BOUND",
                    (long long)own);
    bound[i] = s->next++;
  }
  if (round && round->apex >= 0) {
    int64_t vertex = vertex_of(s, round->apex);
    bw_writer_print(s->writer, "#%lld=VERTEX_LOOP('',#%lld);\n#%lld=FACE_BOUND('',#%lld,.T.);\n",
                    (long long)s->next, (long long)vertex, (long long)s->next + 1,
                    (long long)s->next);
    s->next += 2;
    bound[loops++] = s->next - 1;
  }
  int64_t carrier = round ? put_round(s, round) : put_plane(s, face);
  bw_writer_print(s->writer, "#%lld=ADVANCED_FACE('", (long long)s->next);
  put_face_name(s, face);
  bw_writer_print(s->writer, "',(");
  for (int64_t i = 0; i < loops; i++)
    bw_writer_print(s->writer, "%s#%lld", i ? "," : "", (long long)bound[i]);
  bw_writer_print(s->writer, "),#%lld,%s);\n", (long long)carrier,
                  round && !round->outward ? ".F." : ".T.");
  return s->next++;
}

static int by_face(const void *left, const void *right, void *data) {
  const step *s = (const step *)data;
  int64_t a = *(const int64_t *)left, b = *(const int64_t *)right;
  int32_t fa = s->faces.face_of[a / 3], fb = s->faces.face_of[b / 3];
  return fa != fb ? (fa > fb) - (fa < fb) : (a > b) - (a < b);
}

/* All faces; entity[face]: their numbers. */
static bw_status put_faces(step *s, int64_t *face_entity) {
  bw_status status = BW_OK;
  int64_t sides = 3 * (int64_t)s->faces.topology->facets;
  int64_t *bound = BW_NEW(s->context, int64_t, s->faces.loop_count + 2);
  int64_t *entity = BW_NEW(s->context, int64_t, sides + 1);
  BW_TRY_MEMORY(bound && entity);
  qsort_r(s->faces.loop, (size_t)s->faces.loop_count, sizeof *s->faces.loop, by_face, s);
  for (int64_t i = 0, end; i < s->faces.loop_count; i = end) {
    int32_t face = s->faces.face_of[s->faces.loop[i] / 3];
    for (end = i + 1;
         end < s->faces.loop_count && s->faces.face_of[s->faces.loop[end] / 3] == face;)
      end++;
    face_entity[face] = put_face(s, face, s->faces.loop + i, end - i, bound, entity);
    if (face % 4096 == 0)
      BW_TRY(bw_check_cancel(s->context));
  }
done:
  bw_free(bound);
  bw_free(entity);
  return status;
}

/* ---- solids ---------------------------------------------------------------------------------- */

/* How often a shell winds around a point. */
static double winding(const bwi_topology *t, int32_t shell, const double at[3]) {
  double sum = 0;
  for (int32_t i = 0; i < t->facets; i++) {
    double r[3][3], length[3], cross[3];
    if (t->shell[i] != shell)
      continue;
    for (size_t k = 0; k < 3; k++) {
      const double *x = t->point + 3 * (size_t)t->corner[3 * (size_t)i + k];
      for (size_t j = 0; j < 3; j++)
        r[k][j] = x[j] - at[j];
      length[k] = bw_norm(r[k]);
    }
    bw_cross(r[1], r[2], cross);
    sum += 2 * atan2(bw_dot(r[0], cross),
                     length[0] * length[1] * length[2] + bw_dot(r[0], r[1]) * length[2] +
                         bw_dot(r[1], r[2]) * length[0] + bw_dot(r[2], r[0]) * length[1]);
  }
  return fabs(sum) / (4 * M_PI);
}

/* For each shell the one whose void it is, or -1. */
static bw_status find_owners(const step *s, const int32_t *depth, int32_t *owner) {
  const bwi_topology *t = s->faces.topology;
  for (int32_t v = 0; v < t->shells; v++) {
    owner[v] = -1;
    if (depth[v] % 2 == 0)
      continue;
    int32_t facet = 0;
    while (t->shell[facet] != v)
      facet++;
    const double *at = t->point + 3 * (size_t)t->corner[3 * (size_t)facet];
    for (int32_t o = 0; o < t->shells && owner[v] < 0; o++)
      if (depth[o] == depth[v] - 1 && winding(t, o, at) > 0.5)
        owner[v] = o;
    if (owner[v] < 0)
      return bwi_fail_repair(s->context, "a shell lies neither inside nor outside of another one");
  }
  return BW_OK;
}

static bw_status check_volumes(const step *s, const int32_t *depth, double *volume) {
  const bwi_topology *t = s->faces.topology;
  for (int32_t i = 0; i < t->facets; i++) {
    const int32_t *c = t->corner + 3 * (size_t)i;
    double cross[3];
    if (t->shell[i] < 0)
      continue;
    bw_cross(t->point + 3 * (size_t)c[1], t->point + 3 * (size_t)c[2], cross);
    volume[t->shell[i]] += bw_dot(t->point + 3 * (size_t)c[0], cross) / 6;
  }
  for (int32_t k = 0; k < t->shells; k++)
    if (!(depth[k] % 2 == 0 ? volume[k] > 0 : volume[k] < 0))
      return bwi_fail_repair(s->context, "a shell is turned inside out");
  return BW_OK;
}

/* The faces shell by shell, each behind a neighbour of it: OpenCASCADE's time grows with the square
 * of their number where they come in any other order. */
static bw_status order_faces(const step *s, int32_t *order) {
  bw_status status = BW_OK;
  const bwi_topology *t = s->faces.topology;
  int32_t count = 0;
  uint8_t *listed = BW_NEW0(s->context, uint8_t, s->faces.face_count + 1);
  uint8_t *seen = BW_NEW0(s->context, uint8_t, t->facets + 1);
  int32_t *queue = BW_NEW(s->context, int32_t, t->facets + 1);
  BW_TRY_MEMORY(listed && seen && queue);
  for (int32_t first = 0; first < t->facets; first++) {
    int32_t begin = 0, end = 0;
    if (seen[first] || s->faces.face_of[first] < 0)
      continue;
    seen[first] = 1;
    for (queue[end++] = first; begin < end; begin++) {
      const int32_t face = s->faces.face_of[queue[begin]];
      if (!listed[face])
        order[count++] = face;
      listed[face] = 1;
      for (int k = 0; k < 3; k++) {
        int32_t other = (int32_t)(bwi_flat_opposite(t, 3 * (int64_t)queue[begin] + k) / 3);
        if (!seen[other])
          queue[end++] = other;
        seen[other] = 1;
      }
    }
  }
done:
  bw_free(listed);
  bw_free(seen);
  bw_free(queue);
  return status;
}

/* CLOSED_SHELL of each shell. */
static void put_shells(step *s, const int32_t *order, const int64_t *face_entity,
                       int64_t *shell_entity) {
  const bwi_topology *t = s->faces.topology;
  for (int32_t i = 0; i < s->faces.face_count;) {
    const int32_t shell = t->shell[s->faces.seed[order[i]]];
    bw_writer_print(s->writer, "#%lld=CLOSED_SHELL('',(#%lld", (long long)s->next,
                    (long long)face_entity[order[i]]);
    for (i++; i < s->faces.face_count && t->shell[s->faces.seed[order[i]]] == shell; i++)
      bw_writer_print(s->writer, ",\n#%lld", (long long)face_entity[order[i]]);
    bw_writer_print(s->writer, "));\n");
    shell_entity[shell] = s->next++;
  }
}

/* The entity of the solid of a shell. */
static int64_t put_solid(step *s, int32_t shell, const int32_t *owner, int64_t *shell_entity) {
  const bwi_topology *t = s->faces.topology;
  bool voids = false;
  for (int32_t v = 0; v < t->shells; v++)
    if (owner[v] == shell) {
      bw_writer_print(s->writer, "#%lld=ORIENTED_CLOSED_SHELL('',*,#%lld,.T.);\n",
                      (long long)s->next, (long long)shell_entity[v]);
      shell_entity[v] = s->next++;
      voids = true;
    }
  bw_writer_print(s->writer, "#%lld=%s('solid %d',#%lld", (long long)s->next,
                  voids ? "BREP_WITH_VOIDS" : "MANIFOLD_SOLID_BREP", (int)shell + 1,
                  (long long)shell_entity[shell]);
  bool any = false;
  for (int32_t v = 0; v < t->shells; v++)
    if (owner[v] == shell) {
      bw_writer_print(s->writer, "%s#%lld", any ? "," : ",(", (long long)shell_entity[v]);
      any = true;
    }
  bw_writer_print(s->writer, voids ? "));\n" : ");\n");
  return s->next++;
}

/* ---- the file -------------------------------------------------------------------------------- */

/* Entities 10 to 14: the units; false where STEP has no such. */
static bool put_units(step *s) {
  static const struct {
    double metres;
    const char *prefix;
  } si[] = {{1, "$"}, {1e-3, ".MILLI."}, {1e-2, ".CENTI."}, {1e-6, ".MICRO."}, {1e3, ".KILO."}};
  bw_writer *writer = s->writer;
  const char *prefix = NULL, *name = s->unit == 0.0254 ? "INCH" : s->unit == 0.3048 ? "FOOT" : NULL;
  for (size_t i = 0; i < sizeof si / sizeof *si; i++)
    if (s->unit == si[i].metres)
      prefix = si[i].prefix;
  if (!prefix && !name)
    return false;
  bw_writer_print(writer, "#10=(LENGTH_UNIT()NAMED_UNIT(*)SI_UNIT(%s,.METRE.));\n",
                  name ? ".MILLI." : prefix);
  if (name) {
    bw_writer_print(writer, "#11=LENGTH_MEASURE_WITH_UNIT(LENGTH_MEASURE(");
    put_real(writer, 1e3 * s->unit);
    bw_writer_print(writer,
                    "),#10);\n#12=DIMENSIONAL_EXPONENTS(1.,0.,0.,0.,0.,0.,0.);\n"
                    "#13=(CONVERSION_BASED_UNIT('%s',#11)LENGTH_UNIT()NAMED_UNIT(#12));\n",
                    name);
  }
  bw_writer_print(writer, "#14=(NAMED_UNIT(*)PLANE_ANGLE_UNIT()SI_UNIT($,.RADIAN.));\n"
                          "#15=(NAMED_UNIT(*)SI_UNIT($,.STERADIAN.)SOLID_ANGLE_UNIT());\n"
                          "#16=UNCERTAINTY_MEASURE_WITH_UNIT(LENGTH_MEASURE(");
  put_real(writer, s->faces.tolerance);
  int length = name ? 13 : 10;
  bw_writer_print(writer,
                  "),#%d,'distance_accuracy_value','');\n"
                  "#17=(GEOMETRIC_REPRESENTATION_CONTEXT(3)"
                  "GLOBAL_UNCERTAINTY_ASSIGNED_CONTEXT((#16))"
                  "GLOBAL_UNIT_ASSIGNED_CONTEXT((#%d,#14,#15))REPRESENTATION_CONTEXT('',''));\n",
                  length, length);
  return true;
}

/* The date is the same for all: the same surface gives the same bytes. */
static bool put_head(step *s) {
  bw_writer_print(
      s->writer,
      "ISO-10303-21;\nHEADER;\nFILE_DESCRIPTION(('solids'),'2;1');\n"
      "FILE_NAME('part','1980-01-01T00:00:00',(''),(''),'barwright','barwright','');\n"
      "FILE_SCHEMA(('AUTOMOTIVE_DESIGN { 1 0 10303 214 1 1 1 1 }'));\nENDSEC;\nDATA;\n"
      "#1=APPLICATION_CONTEXT('core data for automotive mechanical design processes');\n"
      "#2=APPLICATION_PROTOCOL_DEFINITION('international standard','automotive_design',2000,#1);\n"
      "#3=PRODUCT_CONTEXT('',#1,'mechanical');\n#4=PRODUCT('part','part','',(#3));\n"
      "#5=PRODUCT_RELATED_PRODUCT_CATEGORY('part',$,(#4));\n"
      "#6=PRODUCT_DEFINITION_FORMATION('','',#4);\n"
      "#7=PRODUCT_DEFINITION_CONTEXT('part definition',#1,'design');\n");
  bw_writer_print(s->writer, "#8=PRODUCT_DEFINITION('design','',#6,#7);\n"
                             "#9=PRODUCT_DEFINITION_SHAPE('','',#8);\n");
  s->next = 18;
  return put_units(s);
}

static bw_status put_solids(step *s, const int64_t *face_entity) {
  bw_status status = BW_OK;
  const bwi_topology *t = s->faces.topology;
  const double origin[3] = {0, 0, 0}, z[3] = {0, 0, 1}, x[3] = {1, 0, 0};
  uint8_t *closed = BW_NEW(s->context, uint8_t, t->shells + 1);
  int32_t *depth = BW_NEW0(s->context, int32_t, t->shells + 1);
  int32_t *owner = BW_NEW(s->context, int32_t, t->shells + 1);
  int64_t *shell_entity = BW_NEW(s->context, int64_t, t->shells + 1);
  int32_t *order = BW_NEW(s->context, int32_t, s->faces.face_count + 1);
  double *volume = BW_NEW0(s->context, double, t->shells + 1);
  BW_TRY_MEMORY(closed && depth && owner && shell_entity && order && volume);
  memset(closed, 1, (size_t)t->shells);
  BW_TRY(bwi_shell_depths(s->context, t, closed, t->degenerate, depth));
  BW_TRY(check_volumes(s, depth, volume));
  BW_TRY(find_owners(s, depth, owner));
  BW_TRY(order_faces(s, order));
  put_shells(s, order, face_entity, shell_entity);
  for (int32_t k = 0; k < t->shells; k++)
    if (owner[k] < 0)
      shell_entity[k] = put_solid(s, k, owner, shell_entity);
  int64_t placement = put_placement(s, origin, z, x);
  bw_writer_print(s->writer, "#%lld=ADVANCED_BREP_SHAPE_REPRESENTATION('',(#%lld",
                  (long long)s->next, (long long)placement);
  for (int32_t k = 0; k < t->shells; k++)
    if (owner[k] < 0)
      bw_writer_print(s->writer, ",#%lld", (long long)shell_entity[k]);
  bw_writer_print(s->writer,
                  "),#17);\n#%lld=SHAPE_DEFINITION_REPRESENTATION(#9,#%lld);\nENDSEC;\n"
                  "END-ISO-10303-21;\n",
                  (long long)s->next + 1, (long long)s->next);
done:
  bw_free(closed);
  bw_free(depth);
  bw_free(owner);
  bw_free(shell_entity);
  bw_free(order);
  bw_free(volume);
  return status;
}

bw_status bwi_step_write(bw_writer *writer, const bw_surface *surface,
                         const bw_surface_write_options *options) {
  bw_status status = BW_OK;
  bw_context *context = bwi_writer_context(writer);
  step s = {.context = context, .writer = writer, .unit = options->unit > 0 ? options->unit : 1};
  int64_t *face_entity = NULL;
  BW_TRY(bwi_flat_faces_find(context, surface, &s.faces));
  if (!options->flat)
    BW_TRY(bwi_round_faces_find(&s.faces));
  BW_TRY(bwi_flat_loops_find(&s.faces));
  const bwi_topology *t = s.faces.topology;
  s.chain = BW_NEW0(context, int64_t, t->edges + 1);
  s.chain_from = BW_NEW(context, int32_t, t->edges + 1);
  s.chain_second = BW_NEW(context, int32_t, t->edges + 1);
  s.vertex = BW_NEW0(context, int64_t, t->points + 1);
  face_entity = BW_NEW0(context, int64_t, t->facets + 1);
  BW_TRY_MEMORY(s.chain && s.chain_from && s.chain_second && s.vertex && face_entity);
  if (!put_head(&s))
    BW_TRY(bw_fail(context, BW_INVALID,
                   "a unit of %g m is none of those written in STEP: um, mm, cm, m, km, in or ft",
                   s.unit));
  BW_TRY(put_faces(&s, face_entity));
  BW_TRY(put_solids(&s, face_entity));
  status = bw_writer_bytes(writer, NULL, 0);
done:
  bwi_flat_faces_clear(&s.faces);
  bw_free(s.chain);
  bw_free(s.chain_from);
  bw_free(s.chain_second);
  bw_free(s.vertex);
  bw_free(face_entity);
  return status;
}
