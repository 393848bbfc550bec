/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* The constraints of contact in the mean of hat functions (docs/theory/contact.md, eq. 2 and 6):
 * points of a rule on the selected facets, the rows B of the candidates, and products with them. */
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "contact/internal.h"
#include "model/internal.h"

enum {
  DEGREE = 6,     /* of the rule against smooth surfaces; */
  CUT = 3,        /* against facets each edge is cut into so many, */
  DEGREE_CUT = 4, /* for a rule of this degree on each of the parts */
  MOST_POINTS = CUT * CUT * BW_QUADRATURE_POINTS,
  MOST_FRICTION = 100
};

static const double sliver = 1e-4; /* of a candidate's area: what faces so little faces nothing */

/* The points of the rule on a facet; how many. */
static int rule(bool cut, double (*barycentric)[3], double *weight) {
  double inner[BW_QUADRATURE_POINTS][3], part[BW_QUADRATURE_POINTS];
  int parts = cut ? CUT : 1, count = 0;
  int points = bw_triangle_quadrature(cut ? DEGREE_CUT : DEGREE, inner, part);
  for (int i = 0; i < parts; i++)
    for (int j = 0; j < parts - i; j++)
      for (int down = 0; down < (i + j < parts - 1 ? 2 : 1); down++) /* and the one beside it */
        for (int p = 0; p < points; p++) {
          double a = inner[p][1], b = inner[p][2];
          weight[count] = part[p] / (parts * parts);
          barycentric[count][1] = (i + (down ? 1 - a : a)) / parts;
          barycentric[count][2] = (j + (down ? 1 - b : b)) / parts;
          barycentric[count][0] = 1 - barycentric[count][1] - barycentric[count][2];
          count++;
        }
  return count;
}

static bw_status check_facets(bw_context *context, const bw_mesh *mesh, int i,
                              const bw_selection *on) {
  if (on->mesh != mesh)
    return bw_fail(context, BW_INVALID, "contact pair %d is on another mesh than the model's",
                   i + 1);
  if (on->facet_count == 0)
    return bw_fail(context, BW_EMPTY,
                   "contact pair %d is on nodes without a facet: contact needs a selection with "
                   "facets",
                   i + 1);
  return BW_OK;
}

static bool have_common_facet(const bw_selection *a, const bw_selection *b) {
  int32_t i = 0, j = 0;
  while (i < a->facet_count && j < b->facet_count && a->facet[i] != b->facet[j])
    if (a->facet[i] < b->facet[j])
      i++;
    else
      j++;
  return i < a->facet_count && j < b->facet_count;
}

/* Where a bond keeps both sides together, nothing decides the pressure between them. */
static bw_status check_bonds(bw_context *context, const bw_model *model, int i,
                             const bw_contact_pair *pair) {
  for (int k = 0; k < model->bond_count; k++) {
    const bw_selection *covered = model->bond[k].covered;
    if (covered && have_common_facet(pair->on, covered) &&
        have_common_facet(pair->against, covered))
      return bw_fail(
          context, BW_INVALID,
          "contact pair %d is on facets that bond %d joins: leave these out of the pair, "
          "or the bond",
          i + 1, k + 1);
  }
  return BW_OK;
}

static bw_status check_pair(bw_context *context, const bw_model *model, int i,
                            const bw_contact_pair *pair) {
  bw_status status = BW_OK;
  const bw_mesh *mesh = model->mesh;
  if (!pair->with == !pair->against)
    return bw_fail(context, BW_INVALID,
                   "contact pair %d needs either a rigid surface or facets that it is against",
                   i + 1);
  if (!isfinite(pair->interference))
    return bw_fail(context, BW_INVALID, "contact pair %d has an interference that is not finite",
                   i + 1);
  if (!(pair->friction >= 0 && pair->friction <= MOST_FRICTION))
    return bw_fail(context, BW_INVALID,
                   "contact pair %d has the coefficient of friction %g; it is from 0 to %d", i + 1,
                   pair->friction, (int)MOST_FRICTION);
  BW_TRY(check_facets(context, mesh, i, pair->on));
  if (pair->against) {
    char what[80];
    snprintf(what, sizeof what, "contact pair %d: contact between parts is of", i + 1);
    BW_TRY(check_facets(context, mesh, i, pair->against));
    BW_TRY(bwi_check_sides(context, pair->on, pair->against, what));
    BW_TRY(check_bonds(context, model, i, pair));
  }
done:
  return status;
}

/* The points of a pair; their candidates are nodes. */
static bw_status add_points(bw_context *context, bwi_contact_rows *rows, int pair) {
  const bw_mesh *mesh = rows->mesh;
  const bw_selection *on = rows->pair[pair].on;
  double barycentric[MOST_POINTS][3], weight[MOST_POINTS];
  int points = rule(rows->pair[pair].against, barycentric, weight);
  int64_t first = rows->point_count, count = 0;
  bw_status status = BW_OK;
  for (int32_t f = 0; f < on->facet_count; f++) {
    const int32_t *node = mesh->facet + (int64_t)on->facet[f] * mesh->nodes_per_facet;
    for (int p = 0; p < points; p++) {
      bwi_contact_point *point = &rows->point[rows->point_count++];
      double normal[3];
      bwi_boundary_normal(mesh, on->facet[f], barycentric[p], normal);
      *point = (bwi_contact_point){.facet = on->facet[f],
                                   .pair = pair,
                                   .area = weight[p] * bw_norm(normal) / 2,
                                   .whole = weight[p] * bw_norm(normal) / 2,
                                   .opposite = -1};
      bw_facet_shape(mesh->order, barycentric[p], point->shape);
      for (int k = 0; k < 3; k++) {
        point->candidate[k] = node[k];
        point->hat[k] = barycentric[p][k];
      }
    }
  }
  if (!rows->pair[pair].against)
    return BW_OK;
  BW_TRY(bwi_contact_find_opposite(context, mesh, &rows->pair[pair], false,
                                   rows->point_count - first, rows->point + first));
  if (rows->finite)
    return BW_OK;
  for (int64_t p = first; p < rows->point_count; p++) /* the others never touch */
    if (rows->point[p].opposite >= 0)
      rows->point[first + count++] = rows->point[p];
  rows->point_count = first + count;
  if (count == 0)
    status =
        bw_fail(context, BW_INVALID,
                "contact pair %d: none of its facets faces those that it is against", pair + 1);
done:
  return status;
}

/* Numbers the corners that the points of a pair have, by ascending nodes. */
static void number_corners(bwi_contact_rows *rows, int pair, int64_t first, int32_t *number) {
  const bw_mesh *mesh = rows->mesh;
  memset(number, 0xff, (size_t)mesh->node_count * sizeof *number);
  for (int64_t p = first; p < rows->point_count; p++)
    for (int k = 0; k < 3; k++)
      number[rows->point[p].candidate[k]] = 0;
  for (int32_t i = 0; i < mesh->node_count; i++)
    if (number[i] == 0) {
      number[i] = rows->count;
      rows->node[rows->count] = i;
      rows->of[rows->count++] = pair;
    }
  for (int64_t p = first; p < rows->point_count; p++)
    for (int k = 0; k < 3; k++) {
      bwi_contact_point *point = &rows->point[p];
      point->candidate[k] = number[point->candidate[k]];
      rows->area[point->candidate[k]] += point->area * point->hat[k];
    }
}

void bwi_contact_pairs_retain(int pair_count, const bw_contact_pair *pair, bw_contact_pair *copy) {
  for (int i = 0; i < pair_count; i++) {
    copy[i] = pair[i];
    bw_retain(pair[i].on);
    bw_retain(pair[i].with);
    bw_retain(pair[i].against);
  }
}

void bwi_contact_pairs_release(int pair_count, bw_contact_pair *copy) {
  for (int i = 0; i < pair_count && copy; i++) {
    bw_release(copy[i].on);
    bw_release(copy[i].with);
    bw_release(copy[i].against);
  }
  bw_free(copy);
}

bw_status bwi_contact_rows_create(bw_context *context, const bw_model *model, int pair_count,
                                  const bw_contact_pair *pair, bool finite,
                                  bwi_contact_rows *rows) {
  bw_status status = BW_OK;
  const bw_mesh *mesh = model->mesh;
  int64_t facets = 0, points = 0;
  double barycentric[MOST_POINTS][3], weight[MOST_POINTS];
  int32_t *number = BW_NEW(context, int32_t, mesh->node_count);
  *rows =
      (bwi_contact_rows){.mesh = mesh, .pair_count = pair_count, .pair = pair, .finite = finite};
  BW_TRY_MEMORY(number);
  for (int i = 0; i < pair_count; i++) {
    BW_TRY(check_pair(context, model, i, &pair[i]));
    facets += pair[i].on->facet_count;
    points += (int64_t)pair[i].on->facet_count * rule(pair[i].against, barycentric, weight);
  }
  if (9 * facets > INT32_MAX)
    BW_TRY(bw_fail(context, BW_LIMIT, "contact on %lld facets is too much", (long long)facets));
  rows->first = BW_NEW0(context, int32_t, 3 * facets + 1);
  rows->tangent = BW_NEW0(context, double, 18 * facets);
  rows->node = BW_NEW(context, int32_t, 3 * facets);
  rows->of = BW_NEW(context, int32_t, 3 * facets);
  rows->area = BW_NEW0(context, double, 3 * facets);
  rows->point = BW_NEW(context, bwi_contact_point, points);
  rows->height = BW_NEW0(context, double, 3 * (int64_t)mesh->facet_count);
  BW_TRY_MEMORY(rows->height && rows->first && rows->tangent && rows->node && rows->of &&
                rows->area && rows->point);
  for (int i = 0; i < pair_count; i++) {
    int64_t first = rows->point_count;
    BW_TRY(add_points(context, rows, i));
    BW_TRY(bwi_contact_take_heights(context, mesh, pair[i].on, rows->height));
    if (pair[i].against)
      BW_TRY(bwi_contact_take_heights(context, mesh, pair[i].against, rows->height));
    number_corners(rows, i, first, number);
  }
  for (int32_t i = 0; i < rows->count; i++)
    rows->first[i + 1] = rows->first[i] + (pair[rows->of[i]].friction > 0 ? 3 : 1);
  rows->row_count = rows->first[rows->count];
  if (finite) {
    rows->whole = BW_NEW(context, double, rows->count);
    BW_TRY_MEMORY(rows->whole);
    memcpy(rows->whole, rows->area, (size_t)rows->count * sizeof *rows->area);
  }
  rows->touching = BW_NEW(context, int64_t, 3 * rows->point_count);
  rows->start = BW_NEW0(context, int64_t, rows->row_count + 1);
  BW_TRY_MEMORY(rows->touching && rows->start);
done:
  bw_free(number);
  return status;
}

void bwi_contact_rows_clear(bwi_contact_rows *rows) {
  bw_free(rows->first);
  bw_free(rows->tangent);
  bw_free(rows->node);
  bw_free(rows->of);
  bw_free(rows->area);
  bw_free(rows->whole);
  bw_free(rows->point);
  bw_free(rows->height);
  bw_free(rows->touching);
  bw_free(rows->start);
  bw_free(rows->column);
  bw_free(rows->value);
}

/* out += factor times sum shape u over the facet's nodes */
static void add_at(const bw_mesh *mesh, int32_t facet, const double *shape, double factor,
                   const double *u, double out[3]) {
  const int32_t *node = mesh->facet + (int64_t)facet * mesh->nodes_per_facet;
  for (int a = 0; a < mesh->nodes_per_facet; a++)
    for (int k = 0; k < 3; k++)
      out[k] += factor * shape[a] * u[3 * (int64_t)node[a] + k];
}

/* u at a point, less that of what it faces. */
static void at_point(const bw_mesh *mesh, const bwi_contact_point *point, const double *u,
                     double out[3]) {
  memset(out, 0, 3 * sizeof *out);
  add_at(mesh, point->facet, point->shape, 1, u, out);
  if (point->opposite >= 0)
    add_at(mesh, point->opposite, point->far, -1, u, out);
}

double bwi_contact_rows_slid(const bwi_contact_rows *rows, int pair, const double *p,
                             const double *u) {
  double most = 0;
  for (int64_t n = 0; n < rows->point_count; n++) {
    const bwi_contact_point *point = &rows->point[n];
    double pressure = 0, at[3], along;
    for (int k = 0; k < 3; k++)
      pressure += point->hat[k] * p[rows->first[point->candidate[k]]];
    if (point->pair != pair || !(pressure > 0))
      continue;
    at_point(rows->mesh, point, u, at);
    along = bw_dot(at, point->normal);
    for (int k = 0; k < 3; k++)
      at[k] -= along * point->normal[k];
    most = fmax(most, bw_norm(at));
  }
  return most;
}

/* Two tangents of each candidate with friction, about the mean of its normals: near to those
 * before, or to an axis. */
static void take_tangents(bwi_contact_rows *rows) {
  double *normal = rows->tangent + 3; /* summed in the place of the second */
  for (int32_t i = 0; i < rows->count; i++)
    memset(normal + 6 * (int64_t)i, 0, 3 * sizeof *normal);
  for (int64_t p = 0; p < rows->point_count; p++) {
    const bwi_contact_point *point = &rows->point[p];
    for (int k = 0; k < 3; k++)
      for (int l = 0; l < 3; l++)
        normal[6 * (int64_t)point->candidate[k] + l] +=
            point->area * point->hat[k] * point->normal[l];
  }
  for (int32_t i = 0; i < rows->count; i++) {
    double *first = rows->tangent + 6 * (int64_t)i, *second = first + 3, n[3], along = 0, length;
    int least = 0;
    memcpy(n, second, sizeof n);
    length = bw_norm(n);
    for (int k = 0; k < 3; k++) {
      n[k] = length > 0 ? n[k] / length : k == 2;
      least = fabs(n[k]) < fabs(n[least]) ? k : least;
    }
    along = bw_dot(first, n);
    if (!(bw_dot(first, first) - along * along > 0.1)) {
      memset(first, 0, 3 * sizeof *first);
      first[least] = 1;
      along = n[least];
    }
    for (int k = 0; k < 3; k++)
      first[k] -= along * n[k];
    length = bw_norm(first);
    for (int k = 0; k < 3; k++)
      first[k] /= length;
    bw_cross(n, first, second);
  }
}

/* Rows of candidate i: 1, or 3 with friction. */
static int width(const bwi_contact_rows *rows, int32_t i) {
  return rows->first[i + 1] - rows->first[i];
}

/* out += factor times the direction of row `l` of candidate i at a point: the normal there, or a
 * tangent of the candidate without its part along this normal. */
static void add_direction(const bwi_contact_rows *rows, const bwi_contact_point *point, int32_t i,
                          int l, double factor, double out[3]) {
  if (l == 0)
    for (int k = 0; k < 3; k++)
      out[k] += factor * point->normal[k];
  else {
    const double *tangent = rows->tangent + 6 * (int64_t)i + 3 * (l - 1);
    double along = bw_dot(tangent, point->normal);
    for (int k = 0; k < 3; k++)
      out[k] += factor * (tangent[k] - along * point->normal[k]);
  }
}

/* Nodes of a point: of its facet, then of that which it faces. */
static int nodes_of(const bw_mesh *mesh, const bwi_contact_point *point) {
  return (point->opposite >= 0 ? 2 : 1) * mesh->nodes_per_facet;
}

static int32_t node_of(const bw_mesh *mesh, const bwi_contact_point *point, int a) {
  int n = mesh->nodes_per_facet;
  return mesh->facet[(int64_t)(a < n ? point->facet : point->opposite) * n + a % n];
}

/* The entries of B, candidate by candidate. */
static bw_status take_entries(bw_context *context, bwi_contact_rows *rows) {
  bw_status status = BW_OK;
  const bw_mesh *mesh = rows->mesh;
  int64_t *first = BW_NEW0(context, int64_t, rows->count + 1);
  int32_t *place = BW_NEW(context, int32_t, mesh->node_count);
  BW_TRY_MEMORY(first && place);
  for (int64_t p = 0; p < 3 * rows->point_count; p++)
    first[rows->point[p / 3].candidate[p % 3] + 1]++;
  for (int32_t i = 0; i < rows->count; i++)
    first[i + 1] += first[i];
  for (int64_t p = 0; p < 3 * rows->point_count; p++)
    rows->touching[first[rows->point[p / 3].candidate[p % 3]]++] = p;
  for (int32_t i = rows->count; i > 0; i--)
    first[i] = first[i - 1];
  first[0] = 0;
  for (int pass = 0; pass < 2; pass++) { /* count, then fill */
    int64_t count = 0;
    memset(place, 0xff, (size_t)mesh->node_count * sizeof *place);
    for (int32_t i = 0; i < rows->count; i++) {
      int64_t begin = count;
      int nodes = 0;
      for (int64_t t = first[i]; t < first[i + 1]; t++) {
        const bwi_contact_point *point = &rows->point[rows->touching[t] / 3];
        for (int a = 0; a < nodes_of(mesh, point); a++)
          if (place[node_of(mesh, point, a)] < 0) {
            if (pass > 0)
              rows->column[begin + nodes] = node_of(mesh, point, a);
            place[node_of(mesh, point, a)] = nodes++;
          }
      }
      count += (int64_t)nodes * width(rows, i);
      if (pass > 0)
        for (int l = 0; l < width(rows, i); l++) {
          rows->start[rows->first[i] + l + 1] = begin + (int64_t)(l + 1) * nodes;
          if (l > 0)
            memcpy(rows->column + begin + (int64_t)l * nodes, rows->column + begin,
                   (size_t)nodes * sizeof *rows->column);
        }
      for (int64_t t = first[i]; t < first[i + 1]; t++) {
        const bwi_contact_point *point = &rows->point[rows->touching[t] / 3];
        for (int l = 0; pass > 0 && l < width(rows, i); l++) {
          double traction[3] = {0};
          add_direction(rows, point, i, l, point->area * point->hat[rows->touching[t] % 3],
                        traction);
          for (int a = 0; a < nodes_of(mesh, point); a++) {
            int n = mesh->nodes_per_facet;
            double shape = a < n ? point->shape[a] : -point->far[a - n];
            double *value =
                rows->value + 3 * (begin + (int64_t)l * nodes + place[node_of(mesh, point, a)]);
            for (int k = 0; k < 3; k++)
              value[k] += shape * traction[k];
          }
        }
      }
      for (int64_t t = first[i]; t < first[i + 1]; t++) {
        const bwi_contact_point *point = &rows->point[rows->touching[t] / 3];
        for (int a = 0; a < nodes_of(mesh, point); a++)
          place[node_of(mesh, point, a)] = -1;
      }
    }
    if (pass > 0)
      break;
    bw_free(rows->column);
    bw_free(rows->value);
    rows->column = BW_NEW(context, int32_t, count);
    rows->value = BW_NEW0(context, double, 3 * count);
    BW_TRY_MEMORY(rows->column && rows->value);
  }
done:
  bw_free(first);
  bw_free(place);
  return status;
}

/* What the points against facets face where they are now, and the areas of what faces something. */
static bw_status face_again(bw_context *context, bwi_contact_rows *rows,
                            const double *displacement) {
  bw_status status = BW_OK;
  bw_mesh moved = *rows->mesh; /* borrowed but for its nodes */
  double *node = BW_NEW(context, double, 3 * (int64_t)moved.node_count);
  BW_TRY_MEMORY(node);
  for (int64_t i = 0; i < 3 * (int64_t)moved.node_count; i++)
    node[i] = rows->mesh->node[i] + displacement[i];
  moved.node = node;
  for (int64_t p = 0, end; p < rows->point_count; p = end) {
    const bw_contact_pair *pair = &rows->pair[rows->point[p].pair];
    for (end = p; end < rows->point_count && rows->point[end].pair == rows->point[p].pair;)
      end++;
    if (pair->against)
      BW_TRY(bwi_contact_find_opposite(context, &moved, pair, true, end - p, rows->point + p));
  }
  memset(rows->area, 0, (size_t)rows->count * sizeof *rows->area);
  for (int64_t p = 0; p < rows->point_count; p++) {
    bwi_contact_point *point = &rows->point[p];
    point->area = rows->pair[point->pair].against && point->opposite < 0 ? 0 : point->whole;
    for (int k = 0; k < 3; k++)
      rows->area[point->candidate[k]] += point->area * point->hat[k];
  }
  for (int32_t i = 0; i < rows->count; i++)
    if (rows->area[i] < sliver * rows->whole[i])
      rows->area[i] = 0;
done:
  bw_free(node);
  return status;
}

bw_status bwi_contact_rows_linearise(bw_context *context, bwi_contact_rows *rows,
                                     const double *displacement, double *gap) {
  bw_status status = BW_OK;
  if (rows->finite)
    BW_TRY(face_again(context, rows, displacement));
  memset(gap, 0, (size_t)rows->row_count * sizeof *gap);
  for (int64_t p = 0; p < rows->point_count; p++) {
    bwi_contact_point *point = &rows->point[p];
    const bw_contact_pair *pair = &rows->pair[point->pair];
    double x[3];
    at_point(rows->mesh, point, displacement, x);
    if (pair->with) {
      add_at(rows->mesh, point->facet, point->shape, 1, rows->mesh->node, x);
      point->gap = bwi_rigid_gap(pair->with, x, point->normal);
    } else
      point->gap = point->apart + (rows->finite ? 0 : bw_dot(point->normal, x));
    point->gap -= pair->interference;
    if (pair->smooth)
      point->gap += bwi_contact_smoothing(rows->mesh, rows->height, point);
    if (point->area == 0)
      point->gap = 0;
    for (int k = 0; k < 3; k++)
      gap[rows->first[point->candidate[k]]] += point->area * point->hat[k] * point->gap;
  }
  if (rows->row_count > rows->count)
    take_tangents(rows);
  BW_TRY(take_entries(context, rows));
done:
  return status;
}

void bwi_contact_rows_measure(const bwi_contact_rows *rows, const double *u, double *gap) {
  for (int32_t r = 0; r < rows->row_count; r++) {
    gap[r] = 0;
    for (int64_t k = rows->start[r]; k < rows->start[r + 1]; k++)
      gap[r] += bw_dot(rows->value + 3 * k, u + 3 * (int64_t)rows->column[k]);
  }
}

void bwi_contact_rows_force(const bwi_contact_rows *rows, const double *p, double *force) {
  memset(force, 0, 3 * (size_t)rows->mesh->node_count * sizeof *force);
  for (int32_t i = 0; i < rows->count; i++)
    for (int32_t r = rows->first[i]; p[rows->first[i]] > 0 && r < rows->first[i + 1]; r++)
      for (int64_t k = rows->start[r]; k < rows->start[r + 1]; k++)
        for (int c = 0; c < 3; c++)
          force[3 * (int64_t)rows->column[k] + c] += p[r] * rows->value[3 * k + c];
}

void bwi_contact_rows_pair_force(const bwi_contact_rows *rows, int pair, bool tangential,
                                 const double *p, double *force) {
  const bw_mesh *mesh = rows->mesh;
  memset(force, 0, 3 * (size_t)mesh->node_count * sizeof *force);
  for (int64_t n = 0; n < rows->point_count; n++) {
    const bwi_contact_point *point = &rows->point[n];
    const int32_t *node = mesh->facet + (int64_t)point->facet * mesh->nodes_per_facet;
    double traction[3] = {0};
    if (point->pair != pair)
      continue;
    for (int k = 0; k < 3; k++) {
      int32_t i = point->candidate[k];
      for (int l = tangential; p[rows->first[i]] > 0 && l < width(rows, i); l++)
        add_direction(rows, point, i, l, point->hat[k] * p[rows->first[i] + l], traction);
    }
    for (int a = 0; a < mesh->nodes_per_facet; a++)
      for (int k = 0; k < 3; k++)
        force[3 * (int64_t)node[a] + k] += point->area * point->shape[a] * traction[k];
  }
}

bw_status bwi_contact_rows_compliance(bw_context *context, const bwi_contact_rows *rows,
                                      bw_system *system, int count, const int32_t *row, int first,
                                      bwi_half_solves *kept, double *s) {
  bw_status status = BW_OK;
  int64_t *start = BW_NEW0(context, int64_t, (int64_t)count + 1);
  int32_t *node = NULL;
  double *force = NULL;
  BW_TRY_MEMORY(start);
  for (int k = 0; k < count; k++)
    start[k + 1] = start[k] + rows->start[row[k] + 1] - rows->start[row[k]];
  node = BW_NEW(context, int32_t, start[count]);
  force = BW_NEW(context, double, 3 * start[count]);
  BW_TRY_MEMORY(node && force);
  for (int k = 0; k < count; k++) {
    int64_t from = rows->start[row[k]];
    size_t entries = (size_t)(start[k + 1] - start[k]);
    memcpy(node + start[k], rows->column + from, entries * sizeof *node);
    memcpy(force + 3 * start[k], rows->value + 3 * from, 3 * entries * sizeof *force);
  }
  const bwi_nodal_columns columns = {count, start, node, force};
  BW_TRY(bwi_compliance_of(context, system, &columns, first, kept, s));
done:
  bw_free(start);
  bw_free(node);
  bw_free(force);
  return status;
}
