/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* Free rigid-body motions of a body: which there are, and in words.
 *
 * A rigid-body motion about the body's centre of volume c is u(x) = t + w x y, y = x - c. In the
 * tests below rotations are measured by the displacement they cause at the body's radius of
 * gyration L: a motion is the six numbers (t, L w), and a constrained component d . u(x) is the row
 * (d, y x d / L). */
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "base/dense.h"
#include "model/internal.h"

/* A component is constrained when what is left of its row (size about 1) is above this. Positions
 * from single-precision files carry relative noise of 1e-7, which must not count as a support. */
#define CONSTRAINED_TOLERANCE 1e-6
/* Of a motion of size 1: what words leave out of it. The motion of a body that slides away is
 * known to about this. */
#define DESCRIBED_TOLERANCE 1e-3
/* Of it a rotation that words call slight: its axis is far away and would tell nothing. */
#define SLIGHT_ROTATION 0.03
/* Principal moments that agree to this are taken as equal, and their axes along x, y, z. */
#define EQUAL_MOMENTS 1e-7

/* ---- small linear algebra -------------------------------------------------------------------- */

/* Eigenvalues (ascending) and eigenvectors (rows) of a symmetric n x n matrix, n <= 6. The matrix
 * is destroyed. */
static void eigen(int n, double (*a)[6], double *value, double (*vector)[6]) {
  bwi_symmetric_eigen(n, 6, a[0], vector[0], 1e-34, 50);
  for (int i = 0; i < n; i++)
    value[i] = a[i][i];
  for (int i = 0; i < n; i++) /* selection sort: n is at most 6 */
    for (int j = i + 1; j < n; j++)
      if (value[j] < value[i]) {
        double t = value[i], row[6];
        value[i] = value[j];
        value[j] = t;
        memcpy(row, vector[i], sizeof row);
        memcpy(vector[i], vector[j], sizeof row);
        memcpy(vector[j], row, sizeof row);
      }
}

/* a minus its parts along `count` orthonormal rows, twice for full accuracy; its size. */
static double deflate(int n, double *a, int count, const double (*row)[6]) {
  for (int pass = 0; pass < 2; pass++)
    for (int i = 0; i < count; i++) {
      double part = bwi_dot(n, a, row[i]);
      for (int k = 0; k < n; k++)
        a[k] -= part * row[i][k];
    }
  return sqrt(bwi_dot(n, a, a));
}

/* Coefficients (rows) that turn `count` orthonormal vectors of space into an orthonormal basis of
 * the same subspace lying along the global axes as far as it can. */
static void align(int count, const double (*v)[3], double (*coefficient)[6]) {
  for (int j = 0; j < count; j++) {
    double best = -1;
    for (int axis = 0; axis < 3; axis++) {
      double a[6] = {0};
      for (int i = 0; i < count; i++)
        a[i] = v[i][axis];
      double size = deflate(count, a, j, (const double(*)[6])coefficient);
      if (size > best + 1e-6) {
        best = size;
        for (int i = 0; i < count; i++)
          coefficient[j][i] = a[i] / size;
      }
    }
  }
}

/* ---- which motions are free ------------------------------------------------------------------ */

/* An orthonormal basis of the motions (t, L w) that no row constrains. */
static int free_space(int64_t row_count, const double (*row)[6], double (*basis)[6]) {
  double constrained[6][6];
  int rank = 0;
  for (; rank < 6; rank++) { /* the row that adds most: rank by pivoting, whatever their number */
    double best = CONSTRAINED_TOLERANCE;
    bool found = false;
    for (int64_t r = 0; r < row_count; r++) {
      double a[6];
      memcpy(a, row[r], sizeof a);
      double size = deflate(6, a, rank, (const double(*)[6])constrained);
      if (size > best) {
        best = size;
        found = true;
        for (int k = 0; k < 6; k++)
          constrained[rank][k] = a[k] / size;
      }
    }
    if (!found)
      break;
  }
  double all[6][6];
  memcpy(all, constrained, sizeof all);
  for (int j = rank; j < 6; j++) {
    double best = 0;
    for (int k = 0; k < 6; k++) {
      double a[6] = {0};
      a[k] = 1;
      double size = deflate(6, a, j, (const double(*)[6])all);
      if (size > best + 1e-6) {
        best = size;
        for (int i = 0; i < 6; i++)
          basis[j - rank][i] = a[i] / size;
      }
    }
    memcpy(all[j], basis[j - rank], sizeof all[j]);
  }
  return 6 - rank;
}

static void largest_positive(double *v, double *with) {
  int max = 0;
  for (int k = 1; k < 3; k++)
    if (fabs(v[k]) > fabs(v[max]) * (1 + 1e-6))
      max = k;
  if (v[max] < 0)
    for (int k = 0; k < 3; k++) {
      v[k] = -v[k];
      with[k] = -with[k];
    }
}

/* What is up to the fraction `zero` of a direction, or of the body's length, is 0. */
static void name_motion(bw_rigid_mode *motion, double length, double zero) {
  double size = bw_norm(motion->rotation), slip = bw_norm(motion->translation);
  char along[64], through[96];
  if (size == 0) {
    bwi_vector_string(along, sizeof along, motion->translation, 4, zero * slip);
    snprintf(motion->text, sizeof motion->text, "translation along %s", along);
    return;
  }
  double axis[3];
  for (int k = 0; k < 3; k++)
    axis[k] = motion->rotation[k] / size;
  bwi_vector_string(along, sizeof along, axis, 4, zero);
  bwi_vector_string(through, sizeof through, motion->centre, 4, zero * length);
  if (slip == 0)
    snprintf(motion->text, sizeof motion->text, "rotation about the axis through %s along %s",
             through, along);
  else {
    char pitch[32];
    bwi_number_string(pitch, sizeof pitch, bw_dot(motion->translation, axis) / size, 3, 0);
    snprintf(motion->text, sizeof motion->text,
             "screw motion about the axis through %s along %s, %s m per radian", through, along,
             pitch);
  }
}

/* Fills a rotation or screw from (t, w) about the body's centre, of unit size; a slip (m per
 * radian) up to `none` is 0. */
static void set_rotation(bw_rigid_mode *motion, const double centre[3], const double t[3],
                         const double w[3], double none) {
  double square = bw_dot(w, w), slip = bw_dot(t, w) / square, arm[3];
  bw_cross(w, t, arm);
  memcpy(motion->rotation, w, sizeof motion->rotation);
  if (fabs(slip) <= none)
    slip = 0;
  for (int k = 0; k < 3; k++) {
    motion->centre[k] = centre[k] + arm[k] / square;
    motion->translation[k] = slip * w[k];
  }
}

void bwi_describe_motion(const bw_dof_map *dof_map, const double *a, char *text, size_t size) {
  int32_t largest = 0;
  double most = -1;
  for (int32_t body = 0; body < dof_map->mesh->component_count; body++) {
    int32_t begin = dof_map->rigid_mode_start[body], end = dof_map->rigid_mode_start[body + 1];
    double square = bwi_dot(end - begin, a + begin, a + begin);
    if (square > most * (1 + 1e-6)) {
      most = square;
      largest = body;
    }
  }
  const double *centre = dof_map->body_centre + 3 * (size_t)largest;
  double t[3] = {0}, w[3] = {0}, length = cbrt(dof_map->body_volume[largest]);
  bw_rigid_mode motion = {.component = largest};
  for (int32_t m = dof_map->rigid_mode_start[largest]; m < dof_map->rigid_mode_start[largest + 1];
       m++) {
    double at_centre[3];
    bwi_motion_at(&dof_map->rigid_mode[m], centre, at_centre);
    for (int k = 0; k < 3; k++) {
      t[k] += a[m] * at_centre[k] / sqrt(most);
      w[k] += a[m] * dof_map->rigid_mode[m].rotation[k] / sqrt(most);
    }
  }
  double turns = bw_norm(w) * length;
  bool slight = turns > DESCRIBED_TOLERANCE && turns < SLIGHT_ROTATION * bw_norm(t);
  if (turns > DESCRIBED_TOLERANCE && !slight)
    set_rotation(&motion, centre, t, w, DESCRIBED_TOLERANCE * length);
  else
    memcpy(motion.translation, t, sizeof t);
  name_motion(&motion, length, slight ? SLIGHT_ROTATION : DESCRIBED_TOLERANCE);
  const char *also = slight ? ", with a slight rotation" : "";
  if (dof_map->mesh->component_count > 1)
    snprintf(text, size, "%s of body %d%s", motion.text, largest + 1, also);
  else
    snprintf(text, size, "%s%s", motion.text, also);
}

int bwi_rigid_modes(const bw_dof_map *dof_map, int32_t component, const double inertia[9],
                    double length, int64_t row_count, const double (*row)[6],
                    bw_rigid_mode *motion) {
  const double *centre = dof_map->body_centre + 3 * (size_t)component;
  double basis[6][6], gram[6][6], value[6], vector[6][6];
  int count = free_space(row_count, row, basis);
  if (count == 0)
    return 0;
  memset(motion, 0, (size_t)count * sizeof *motion);

  /* Split off the pure translations: combinations of the basis whose rotation vanishes. */
  for (int i = 0; i < count; i++)
    for (int j = 0; j < count; j++)
      gram[i][j] = bwi_dot(3, basis[i] + 3, basis[j] + 3);
  eigen(count, gram, value, vector);
  int shifts = 0;
  double shift[3][3], rotation_t[3][3], rotation_w[3][3];
  int rotation_count = 0;
  for (int i = 0; i < count; i++) {
    double t[3] = {0, 0, 0}, w[3] = {0, 0, 0};
    for (int j = 0; j < count; j++)
      for (int k = 0; k < 3; k++) {
        t[k] += vector[i][j] * basis[j][k];
        w[k] += vector[i][j] * basis[j][3 + k];
      }
    double size = bw_norm(w);
    if (size <= CONSTRAINED_TOLERANCE && shifts < 3) {
      for (int s = 0; s < shifts; s++) {
        double part = bw_dot(t, shift[s]);
        for (int k = 0; k < 3; k++)
          t[k] -= part * shift[s][k];
      }
      double length_t = bw_norm(t);
      for (int k = 0; k < 3; k++)
        shift[shifts][k] = t[k] / length_t;
      shifts++;
    } else if (rotation_count < 3) { /* unit rotations, orthogonal to each other */
      for (int k = 0; k < 3; k++) {
        rotation_t[rotation_count][k] = t[k] / size;
        rotation_w[rotation_count][k] = w[k] / size;
      }
      rotation_count++;
    }
  }
  count = shifts + rotation_count;
  double coefficient[6][6];
  align(shifts, (const double(*)[3])shift, coefficient);
  for (int i = 0; i < shifts; i++) {
    double unused[3] = {0, 0, 0};
    motion[i].component = component;
    memcpy(motion[i].centre, centre, sizeof motion[i].centre);
    for (int j = 0; j < shifts; j++)
      for (int k = 0; k < 3; k++)
        motion[i].translation[k] += coefficient[i][j] * shift[j][k];
    largest_positive(motion[i].translation, unused);
    name_motion(&motion[i], length, 1e-6);
  }

  /* The rotations, orthogonal to the translations: principal axes of
   * <r, s> = t . t' + w . J w' among them (w here is L times the angular velocity). */
  for (int i = 0; i < rotation_count; i++)
    for (int s = 0; s < shifts; s++) {
      double part = bw_dot(rotation_t[i], shift[s]);
      for (int k = 0; k < 3; k++)
        rotation_t[i][k] -= part * shift[s][k];
    }
  for (int i = 0; i < rotation_count; i++)
    for (int j = 0; j < rotation_count; j++) {
      gram[i][j] = bw_dot(rotation_t[i], rotation_t[j]);
      for (int k = 0; k < 3; k++)
        gram[i][j] +=
            rotation_w[i][k] * bwi_dot(3, inertia + 3 * k, rotation_w[j]) / (length * length);
    }
  eigen(rotation_count, gram, value, vector);
  /* equal moments: any axes are principal, so take x, y, z */
  for (int first = 0; first < rotation_count;) {
    int next = first + 1;
    while (next < rotation_count &&
           value[next] - value[first] <= EQUAL_MOMENTS * value[rotation_count - 1])
      next++;
    double t[3][3] = {{0}}, w[3][3] = {{0}};
    for (int i = first; i < next; i++)
      for (int j = 0; j < rotation_count; j++)
        for (int k = 0; k < 3; k++) {
          t[i - first][k] += vector[i][j] * rotation_t[j][k];
          w[i - first][k] += vector[i][j] * rotation_w[j][k];
        }
    align(next - first, (const double(*)[3])w, coefficient);
    for (int i = first; i < next; i++) {
      double ti[3] = {0, 0, 0}, wi[3] = {0, 0, 0};
      for (int j = 0; j < next - first; j++)
        for (int k = 0; k < 3; k++) {
          ti[k] += coefficient[i - first][j] * t[j][k];
          wi[k] += coefficient[i - first][j] * w[j][k];
        }
      double norm = bw_dot(ti, ti);
      for (int k = 0; k < 3; k++)
        norm += wi[k] * bwi_dot(3, inertia + 3 * k, wi) / (length * length);
      norm = sqrt(norm);
      for (int k = 0; k < 3; k++) {
        ti[k] /= norm;
        wi[k] /= norm * length;
      }
      largest_positive(wi, ti);
      motion[shifts + i].component = component;
      set_rotation(&motion[shifts + i], centre, ti, wi, 1e-9 * length);
      name_motion(&motion[shifts + i], length, 1e-6);
    }
    first = next;
  }
  return count;
}
