/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* Stiffness, mass and forces of a sheet. */
#include <math.h>
#include <string.h>

#include "base/union_find.h"
#include "responsive/sheet.h"

typedef struct loop {
  const bw_sheet *sheet;
  bwi_triangle_rule rule; /* of the mass */
  bwi_rules rules;        /* of the stiffness */
} loop;

static bw_status inverted(bw_context *context, int32_t element) {
  bw_fail(context, BW_GEOMETRY,
          "element %d of the plane mesh is inverted or flat: its corners have to run "
          "counter-clockwise",
          element + 1);
  bw_detail_number(context, "element", element + 1);
  return BW_GEOMETRY;
}

/* K_ab = integral of B_a^T D B_b t, where B_a is the matrix that makes strains of the displacement
 * of node a: rows (x 0), (0 y), (y x) of its gradient. */
static bw_status stiffness6(void *data, int32_t e, double *k) {
  enum { N = 6 };
  const loop *l = data;
  const bwi_section *section = bwi_section_of(l->sheet, e);
  double x[6][2], g[6][2];
  bwi_element_points(l->sheet->mesh, e, N, x);
  const bwi_triangle_rule *rule = bwi_rules_for(&l->rules, x);
  memset(k, 0, (size_t)(4 * N * N) * sizeof *k);
  for (int q = 0; q < rule->count; q++) {
    double determinant = bwi_rule_gradient(rule, q, N, x, g), d[9];
    if (!(determinant > 0))
      return BW_GEOMETRY;
    double scale = determinant * rule->weight[q] * section->thickness;
    for (int i = 0; i < 9; i++)
      d[i] = scale * section->elasticity[i];
    for (int a = 0; a < N; a++) {
      double gx = g[a][0], gy = g[a][1], row[2][3];
      for (int i = 0; i < 3; i++) {
        row[0][i] = gx * d[i] + gy * d[6 + i];
        row[1][i] = gy * d[3 + i] + gx * d[6 + i];
      }
      for (int b = 0; b < N; b++)
        for (int r = 0; r < 2; r++) {
          k[(2 * a + r) * 2 * N + 2 * b] += row[r][0] * g[b][0] + row[r][2] * g[b][1];
          k[(2 * a + r) * 2 * N + 2 * b + 1] += row[r][1] * g[b][1] + row[r][2] * g[b][0];
        }
    }
  }
  return BW_OK;
}

static bw_status element_mass(void *data, int32_t e, double *m) {
  const loop *l = data;
  int n = l->rule.n;
  const bwi_section *section = bwi_section_of(l->sheet, e);
  double x[6][2], g[6][2];
  bwi_element_points(l->sheet->mesh, e, n, x);
  memset(m, 0, (size_t)(n * n) * sizeof *m);
  for (int q = 0; q < l->rule.count; q++) {
    double scale = bwi_rule_gradient(&l->rule, q, n, x, g) * l->rule.weight[q] *
                   section->thickness * section->density;
    for (int a = 0; a < n; a++)
      for (int b = 0; b < n; b++)
        m[a * n + b] += scale * l->rule.value[q][a] * l->rule.value[q][b];
  }
  return BW_OK;
}

/* Room for one array per topology, when it is not there yet. */
static bw_status workspace(bw_context *context, double **block, size_t size) {
  if (!*block)
    *block = BW_NEW(context, double, size);
  return *block ? BW_OK : BW_MEMORY;
}

bw_status bwi_sheet_prepare(bw_context *context, bw_sheet *sheet, bool *made) {
  bw_status status = BW_OK;
  struct bwi_sheet *inner = sheet->inner;
  *made = !inner->pattern;
  if (!inner->pattern) {
    inner->stiffness_current = false;
    BW_TRY(bw_plane_pattern_create(context, sheet->mesh->topology, &inner->pattern));
  }
  size_t blocks = (size_t)inner->pattern->block_count,
         size = 2 * (size_t)inner->pattern->node_count;
  BW_TRY(workspace(context, &inner->stiffness, 4 * blocks));
  BW_TRY(workspace(context, &inner->matrix, 4 * blocks));
  BW_TRY(workspace(context, &inner->workspace, bwi_plane_workspace_size(inner->pattern, 2)));
  BW_TRY(workspace(context, &inner->prescribed, size));
  BW_TRY(workspace(context, &inner->force, size));
  BW_TRY(workspace(context, &inner->rhs, size));
  BW_TRY(workspace(context, &inner->work, size));
  if (!inner->is_prescribed && !(inner->is_prescribed = BW_NEW(context, uint8_t, size)))
    status = BW_MEMORY;
done:
  return status;
}

bw_status bwi_sheet_stiffness(bw_context *context, bw_sheet *sheet) {
  struct bwi_sheet *inner = sheet->inner;
  if (inner->stiffness_current)
    return BW_OK;
  loop l = {.sheet = sheet};
  bw_status status;
  if (sheet->mesh->topology->nodes->order == 1) {
    status = bwi_sheet_tri3_stiffness(context, sheet, inner->stiffness);
  } else {
    bwi_rules_create(2, &l.rules);
    status = bwi_plane_assemble(context, inner->pattern, 2, stiffness6, &l, inner->workspace,
                                inner->stiffness);
  }
  if (status == BW_GEOMETRY)
    for (int32_t e = 0; e < sheet->mesh->topology->element_count; e++)
      if (!(bw_plane_element_quality(sheet->mesh, e) > 0))
        return inverted(context, e);
  inner->stiffness_current = status == BW_OK;
  inner->matrix_step[0] = 0;
  bw_free(inner->mass);
  inner->mass = NULL;
  return status;
}

bw_status bwi_sheet_mass(bw_context *context, bw_sheet *sheet) {
  struct bwi_sheet *inner = sheet->inner;
  if (inner->mass)
    return BW_OK;
  for (int32_t k = 0; k < inner->section_count; k++)
    if (!(inner->section[k].density > 0))
      return bw_fail(context, BW_INVALID,
                     "material '%s' has no density: transient dynamics needs one (kg/m3)",
                     inner->material[k]->name);
  double *mass = BW_NEW(context, double, inner->pattern->block_count);
  if (!mass)
    return BW_MEMORY;
  loop l = {.sheet = sheet};
  bw_status status;
  if (sheet->mesh->topology->nodes->order == 1) {
    status = bwi_sheet_tri3_mass(context, sheet, mass);
  } else {
    bwi_rule_create(2, 4, &l.rule);
    status =
        bwi_plane_assemble(context, inner->pattern, 1, element_mass, &l, inner->workspace, mass);
  }
  if (status == BW_OK)
    inner->mass = mass;
  else
    bw_free(mass);
  return status;
}

/* A node takes a third of the weight of each of its triangles. */
static void add_weight3(const bw_sheet *sheet, double *force) {
  const bw_plane_topology *topology = sheet->mesh->topology;
  const double *gravity = sheet->inner->gravity;
  for (int32_t e = 0; e < topology->element_count; e++) {
    const bwi_section *section = bwi_section_of(sheet, e);
    const int32_t *node = topology->element + (int64_t)e * 3;
    double x[3][2];
    bwi_element_points(sheet->mesh, e, 3, x);
    double twice =
        (x[1][0] - x[0][0]) * (x[2][1] - x[0][1]) - (x[1][1] - x[0][1]) * (x[2][0] - x[0][0]);
    double nodal_mass = twice * section->thickness * section->density / 6;
    for (int a = 0; a < 3; a++)
      for (int i = 0; i < 2; i++)
        force[2 * (int64_t)node[a] + i] += nodal_mass * gravity[i];
  }
}

bw_status bwi_sheet_force(bw_context *context, bw_sheet *sheet, double time) {
  struct bwi_sheet *inner = sheet->inner;
  const bw_plane_mesh *mesh = sheet->mesh;
  const bw_plane_topology *topology = mesh->topology;
  bool weightless = false; /* some section, perhaps not used */
  bw_status status =
      bwi_conditions_force(context, mesh, 2, inner->condition_count, inner->condition, time,
                           inner->section_count, inner->thickness, inner->force);
  if (status != BW_OK || (inner->gravity[0] == 0 && inner->gravity[1] == 0))
    return status;
  for (int32_t k = 0; k < inner->section_count; k++)
    weightless = weightless || !(inner->section[k].density > 0);
  if (topology->nodes->order == 1 && !weightless) {
    add_weight3(sheet, inner->force);
    return BW_OK;
  }
  bwi_rules rules;
  bwi_rules_create(topology->nodes->order, &rules);
  int n = rules.straight.n;
  for (int32_t e = 0; e < topology->element_count; e++) {
    const bwi_section *section = bwi_section_of(sheet, e);
    const int32_t *node = topology->element + (int64_t)e * n;
    double x[6][2], g[6][2];
    if (!(section->density > 0))
      return bw_fail(context, BW_INVALID,
                     "gravity needs the density of the material (kg/m3), which is not given");
    bwi_element_points(mesh, e, n, x);
    const bwi_triangle_rule *rule = bwi_rules_for(&rules, x);
    for (int q = 0; q < rule->count; q++) {
      double scale = bwi_rule_gradient(rule, q, n, x, g) * rule->weight[q] * section->thickness *
                     section->density;
      for (int a = 0; a < n; a++)
        for (int i = 0; i < 2; i++)
          inner->force[2 * (int64_t)node[a] + i] += scale * rule->value[q][a] * inner->gravity[i];
    }
  }
  return BW_OK;
}

bw_status bwi_sheet_prescribe(bw_context *context, bw_sheet *sheet, double time) {
  struct bwi_sheet *inner = sheet->inner;
  return bw_conditions_prescribe(context, sheet->mesh, 2, inner->condition_count, inner->condition,
                                 time, inner->is_prescribed, inner->prescribed,
                                 &inner->conflicts_reported);
}

/* ---- unconstrained rigid-body modes ---------------------------------------------------------- */

/* Prescribed components restrain the motions (1, 0), (0, 1) and (-y, x)/size of the piece they are
 * on. A motion is free when no prescribed component resists it: a zero eigenvalue of the 3x3 sum of
 * their squares. */
bw_status bwi_sheet_check_constraints(bw_context *context, const bw_sheet *sheet) {
  bw_status status = BW_OK;
  const bw_plane_mesh *mesh = sheet->mesh;
  const bw_plane_topology *topology = mesh->topology;
  const uint8_t *is_prescribed = sheet->inner->is_prescribed;
  int32_t nodes = topology->nodes->node_count, n = topology->nodes->order == 1 ? 3 : 6;
  int32_t *parent = BW_NEW(context, int32_t, nodes);
  double *sum = BW_NEW0(context, double, 10 * (size_t)nodes); /* 6 of the matrix, centre, count */
  BW_TRY_MEMORY(parent && sum);
  for (int32_t i = 0; i < nodes; i++)
    parent[i] = i;
  for (int32_t e = 0; e < topology->element_count; e++) {
    const int32_t *node = topology->element + (int64_t)e * n;
    for (int a = 1; a < n; a++)
      bwi_set_join(parent, node[0], node[a]);
  }
  for (int32_t i = 0; i < nodes; i++) {
    double *s = sum + 10 * (int64_t)bwi_set_root(parent, i);
    s[6] += mesh->point[2 * i];
    s[7] += mesh->point[2 * i + 1];
    s[8] += 1;
  }
  for (int32_t i = 0; i < nodes; i++) {
    double *s = sum + 10 * (int64_t)bwi_set_root(parent, i);
    double x = mesh->point[2 * i] - s[6] / s[8], y = mesh->point[2 * i + 1] - s[7] / s[8];
    s[9] = fmax(s[9], hypot(x, y));
  }
  for (int32_t i = 0; i < nodes; i++) {
    double *s = sum + 10 * (int64_t)bwi_set_root(parent, i);
    double x = mesh->point[2 * i] - s[6] / s[8], y = mesh->point[2 * i + 1] - s[7] / s[8];
    if (is_prescribed[2 * i]) {
      s[0] += 1;
      s[4] += -y / s[9];
      s[2] += y * y / (s[9] * s[9]);
    }
    if (is_prescribed[2 * i + 1]) {
      s[1] += 1;
      s[3] += x / s[9];
      s[2] += x * x / (s[9] * s[9]);
    }
  }
  for (int32_t i = 0; i < nodes; i++) {
    if (parent[i] != i)
      continue;
    const double *s = sum + 10 * (int64_t)i;
    /* xx yy zz yz zx xy of the motions along x, along y and about the centre */
    double tensor[6] = {s[0], s[1], s[2], s[3], s[4], 0}, value[3], vector[9];
    bw_eigen3(tensor, value, vector);
    if (value[2] > 1e-9 * value[0] && value[0] > 0)
      continue;
    const double *free = vector + 6;
    int max = fabs(free[0]) > fabs(free[1]) ? 0 : 1;
    max = fabs(free[2]) > fabs(free[max]) ? 2 : max;
    status = bw_fail(context, BW_UNCONSTRAINED,
                     "the part of the sheet around (%.6g, %.6g) m is free to %s: constrain it by "
                     "more conditions",
                     s[6] / s[8], s[7] / s[8],
                     max == 0   ? "move along x"
                     : max == 1 ? "move along y"
                                : "rotate");
    bw_detail_number(context, "x", s[6] / s[8]);
    bw_detail_number(context, "y", s[7] / s[8]);
    goto done;
  }
done:
  bw_free(parent);
  bw_free(sum);
  return status;
}
