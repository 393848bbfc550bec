/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* Free rigid motions of a body: which there are, in words, and the products with them.
 *
 * A rigid motion about the body's centre of volume c is u(x) = t + w x y, y = x - c. In the tests
 * below rotations are measured by the displacement they cause at the body's radius of gyration L:
 * a motion is the six numbers (t, L w), and a held component d . u(x) is the row (d, y x d / L).
 *
 * The shape functions reproduce positions, also of curved elements: x = sum N_j x_j. Hence
 *     (M r)_i = integral N_i r = t m_i + w x q_i,  m_i = integral N_i,  q_i = integral N_i y,
 * which is the consistent mass matrix times r with no sum over pairs, and the second moments are
 * integral y y^T = sum_i y_i q_i^T. Four numbers per node hold all of it. */
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "model/internal.h"

/* A component is held when what is left of its row (size about 1) is above this. Positions from
 * single-precision files carry relative noise of 1e-7, which must not count as a support. */
#define HELD_TOLERANCE 1e-6
/* Principal moments that agree to this are taken as equal, and their axes along x, y, z. */
#define EQUAL_MOMENTS 1e-7

/* ---- moments of the volume -------------------------------------------------------------- */

void bwi_element_moments(int order, const double (*x)[3], double volume, double (*moment)[4]) {
  if (order == 1) {
    double sum[3];
    for (int k = 0; k < 3; k++)
      sum[k] = x[0][k] + x[1][k] + x[2][k] + x[3][k];
    for (int a = 0; a < 4; a++) {
      moment[a][0] = volume / 4;
      for (int k = 0; k < 3; k++)
        moment[a][1 + k] = volume / 20 * (sum[k] + x[a][k]);
    }
    return;
  }
  if (bw_tet_is_straight(x)) {
    /* N_a = L_a (2 L_a - 1), N_ab = 4 L_a L_b; integral L_a^i L_b^j ... = 6 V i! j! ... / (3+n)! */
    double sum[3];
    for (int k = 0; k < 3; k++)
      sum[k] = x[0][k] + x[1][k] + x[2][k] + x[3][k];
    for (int a = 0; a < 4; a++) {
      moment[a][0] = -volume / 20;
      for (int k = 0; k < 3; k++)
        moment[a][1 + k] = -volume / 60 * (sum[k] - x[a][k]);
    }
    for (int e = 0; e < 6; e++) {
      const double *xa = x[bw_tet_edge[e][0]], *xb = x[bw_tet_edge[e][1]];
      moment[4 + e][0] = volume / 5;
      for (int k = 0; k < 3; k++)
        moment[4 + e][1 + k] = volume / 30 * (sum[k] + xa[k] + xb[k]);
    }
    return;
  }
  double point[BW_QUADRATURE_POINTS][4], weight[BW_QUADRATURE_POINTS];
  int points = bw_tet_quadrature(6, point, weight);
  memset(moment, 0, 10 * sizeof *moment);
  for (int p = 0; p < points; p++) {
    double shape[10], gradient[10][3], at[3] = {0, 0, 0};
    double size = bw_tet_gradient(2, x, point[p], gradient) / 6 * weight[p];
    bw_tet_shape(2, point[p], shape);
    for (int a = 0; a < 10; a++)
      for (int k = 0; k < 3; k++)
        at[k] += shape[a] * x[a][k];
    for (int a = 0; a < 10; a++) {
      moment[a][0] += size * shape[a];
      for (int k = 0; k < 3; k++)
        moment[a][1 + k] += size * shape[a] * at[k];
    }
  }
}

bw_status bwi_moments(bw_context *context, bw_numbering *numbering, double *inertia) {
  const bw_mesh *mesh = numbering->mesh;
  int32_t bodies = mesh->component_count;
  double *weight = numbering->weight, *centre = numbering->body_centre;
  double *volume = numbering->body_volume;
  bw_status status = BW_OK;
  /* From the mean of the body's nodes first: no cancellation far from the origin. */
  int32_t *count = BW_NEW0(context, int32_t, bodies);
  double *reference = BW_NEW0(context, double, 3 * (size_t)bodies);
  if (!count || !reference) {
    status = BW_MEMORY;
    goto done;
  }
  for (int32_t i = 0; i < mesh->node_count; i++) {
    int32_t body = mesh->component[i];
    count[body]++;
    for (int k = 0; k < 3; k++)
      reference[3 * (size_t)body + k] += mesh->node[3 * (size_t)i + k];
  }
  for (int32_t body = 0; body < bodies; body++)
    for (int k = 0; k < 3; k++)
      reference[3 * (size_t)body + k] /= count[body] ? count[body] : 1;

  memset(weight, 0, 4 * sizeof *weight * (size_t)mesh->node_count);
  for (int32_t e = 0; e < mesh->element_count; e++) {
    const int32_t *node = mesh->element + (size_t)e * (size_t)mesh->nodes_per_element;
    const double *from = reference + 3 * (size_t)mesh->component[node[0]];
    double x[10][3], moment[10][4];
    if (e % 65536 == 0)
      BW_TRY(bw_check_cancel(context));
    for (int a = 0; a < mesh->nodes_per_element; a++)
      for (int k = 0; k < 3; k++)
        x[a][k] = mesh->node[3 * (size_t)node[a] + k] - from[k];
    bwi_element_moments(mesh->order, (const double(*)[3])x, mesh->volume[e], moment);
    for (int a = 0; a < mesh->nodes_per_element; a++)
      for (int k = 0; k < 4; k++)
        weight[4 * (size_t)node[a] + k] += moment[a][k];
  }
  memset(volume, 0, sizeof *volume * (size_t)bodies);
  memset(centre, 0, 3 * sizeof *centre * (size_t)bodies);
  for (int32_t i = 0; i < mesh->node_count; i++) {
    int32_t body = mesh->component[i];
    volume[body] += weight[4 * (size_t)i];
    for (int k = 0; k < 3; k++)
      centre[3 * (size_t)body + k] += weight[4 * (size_t)i + 1 + k];
  }
  for (int32_t body = 0; body < bodies; body++) {
    if (!(volume[body] > 0)) {
      status = bw_fail(context, BW_GEOMETRY, "body %d has the volume %g m3: it must be positive",
                       body + 1, volume[body]);
      goto done;
    }
    for (int k = 0; k < 3; k++)
      centre[3 * (size_t)body + k] =
          centre[3 * (size_t)body + k] / volume[body] + reference[3 * (size_t)body + k];
  }
  memset(inertia, 0, 9 * sizeof *inertia * (size_t)bodies);
  for (int32_t i = 0; i < mesh->node_count; i++) {
    size_t body = (size_t)mesh->component[i];
    double *w = weight + 4 * (size_t)i, y[3];
    w[0] /= volume[body];
    for (int k = 0; k < 3; k++) {
      w[1 + k] = w[1 + k] / volume[body] - w[0] * (centre[3 * body + k] - reference[3 * body + k]);
      y[k] = mesh->node[3 * (size_t)i + k] - centre[3 * body + k];
    }
    for (int k = 0; k < 3; k++)
      for (int l = 0; l < 3; l++)
        inertia[9 * body + 3 * k + l] += y[k] * w[1 + l]; /* y y^T for now */
  }
  for (int32_t body = 0; body < bodies; body++) {
    double *j = inertia + 9 * (size_t)body, trace = j[0] + j[4] + j[8];
    for (int k = 0; k < 3; k++)
      for (int l = k; l < 3; l++)
        j[3 * k + l] = j[3 * l + k] = (k == l ? trace : 0) - (j[3 * k + l] + j[3 * l + k]) / 2;
  }
done:
  bw_free(count);
  bw_free(reference);
  return status;
}

/* ---- small linear algebra ----------------------------------------------------------------- */

/* Eigenvalues (ascending) and eigenvectors (rows) of a symmetric n x n matrix, n <= 6: cyclic
 * Jacobi. The matrix is destroyed. */
static void jacobi(int n, double (*a)[6], double *value, double (*vector)[6]) {
  for (int i = 0; i < n; i++)
    for (int j = 0; j < n; j++)
      vector[i][j] = i == j;
  for (int sweep = 0; sweep < 50; sweep++) {
    double off = 0, size = 0;
    for (int i = 0; i < n; i++)
      for (int j = 0; j < n; j++)
        *(i == j ? &size : &off) += a[i][j] * a[i][j];
    if (off <= 1e-34 * size)
      break;
    for (int p = 0; p < n; p++)
      for (int q = p + 1; q < n; q++) {
        if (a[p][q] == 0)
          continue;
        double theta = (a[q][q] - a[p][p]) / (2 * a[p][q]);
        double t = (theta < 0 ? -1 : 1) / (fabs(theta) + sqrt(theta * theta + 1));
        double c = 1 / sqrt(t * t + 1), s = t * c;
        for (int k = 0; k < n; k++) {
          double kp = a[k][p], kq = a[k][q];
          a[k][p] = c * kp - s * kq;
          a[k][q] = s * kp + c * kq;
        }
        for (int k = 0; k < n; k++) {
          double pk = a[p][k], qk = a[q][k], vp = vector[p][k], vq = vector[q][k];
          a[p][k] = c * pk - s * qk;
          a[q][k] = s * pk + c * qk;
          vector[p][k] = c * vp - s * vq;
          vector[q][k] = s * vp + c * vq;
        }
      }
  }
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

static double dot(int n, const double *a, const double *b) {
  double sum = 0;
  for (int k = 0; k < n; k++)
    sum += a[k] * b[k];
  return sum;
}

/* a minus its parts along `count` orthonormal rows, twice for full accuracy; its size. */
static double deflate(int n, double *a, int count, const double (*row)[6]) {
  for (int pass = 0; pass < 2; pass++)
    for (int i = 0; i < count; i++) {
      double part = dot(n, a, row[i]);
      for (int k = 0; k < n; k++)
        a[k] -= part * row[i][k];
    }
  return sqrt(dot(n, a, a));
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

/* ---- which motions are free ----------------------------------------------------------------- */

/* An orthonormal basis of the motions (t, L w) that no row holds. */
static int free_space(int64_t row_count, const double (*row)[6], double (*basis)[6]) {
  double held[6][6];
  int rank = 0;
  for (; rank < 6; rank++) { /* the row that adds most: rank by pivoting, whatever their number */
    double best = HELD_TOLERANCE;
    bool found = false;
    for (int64_t r = 0; r < row_count; r++) {
      double a[6];
      memcpy(a, row[r], sizeof a);
      double size = deflate(6, a, rank, (const double(*)[6])held);
      if (size > best) {
        best = size;
        found = true;
        for (int k = 0; k < 6; k++)
          held[rank][k] = a[k] / size;
      }
    }
    if (!found)
      break;
  }
  double all[6][6];
  memcpy(all, held, sizeof all);
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
  int most = 0;
  for (int k = 1; k < 3; k++)
    if (fabs(v[k]) > fabs(v[most]) * (1 + 1e-6))
      most = k;
  if (v[most] < 0)
    for (int k = 0; k < 3; k++) {
      v[k] = -v[k];
      with[k] = -with[k];
    }
}

static void name_motion(bw_rigid_motion *motion, double length) {
  double turn = bw_norm(motion->rotation), slip = bw_norm(motion->translation);
  char along[64], through[96];
  if (turn == 0) {
    bwi_vector_string(along, sizeof along, motion->translation, 4, 1e-6);
    snprintf(motion->text, sizeof motion->text, "translation along %s", along);
    return;
  }
  double axis[3];
  for (int k = 0; k < 3; k++)
    axis[k] = motion->rotation[k] / turn;
  bwi_vector_string(along, sizeof along, axis, 4, 1e-6);
  bwi_vector_string(through, sizeof through, motion->centre, 4, 1e-6 * length);
  if (slip == 0)
    snprintf(motion->text, sizeof motion->text, "rotation about the axis through %s along %s",
             through, along);
  else {
    char pitch[32];
    bwi_number_string(pitch, sizeof pitch, bw_dot(motion->translation, axis) / turn, 3, 0);
    snprintf(motion->text, sizeof motion->text,
             "screw motion about the axis through %s along %s, %s m per radian", through, along,
             pitch);
  }
}

/* Fills a rotation or screw from (t, w) about the body's centre, of unit size. */
static void set_turn(bw_rigid_motion *motion, const double centre[3], const double t[3],
                     const double w[3], double length) {
  double turn = bw_dot(w, w), slip = bw_dot(t, w) / turn, arm[3];
  bw_cross(w, t, arm);
  memcpy(motion->rotation, w, sizeof motion->rotation);
  if (fabs(slip) <= 1e-9 * length) /* m per radian */
    slip = 0;
  for (int k = 0; k < 3; k++) {
    motion->centre[k] = centre[k] + arm[k] / turn;
    motion->translation[k] = slip * w[k];
  }
}

int bwi_free_motions(const bw_numbering *numbering, int32_t component, const double inertia[9],
                     double length, int64_t row_count, const double (*row)[6],
                     bw_rigid_motion *motion) {
  const double *centre = numbering->body_centre + 3 * (size_t)component;
  double basis[6][6], gram[6][6], value[6], vector[6][6];
  int count = free_space(row_count, row, basis);
  if (count == 0)
    return 0;
  memset(motion, 0, (size_t)count * sizeof *motion);

  /* Split off the pure translations: combinations of the basis whose rotation vanishes. */
  for (int i = 0; i < count; i++)
    for (int j = 0; j < count; j++)
      gram[i][j] = dot(3, basis[i] + 3, basis[j] + 3);
  jacobi(count, gram, value, vector);
  int shifts = 0;
  double shift[3][3], turn_t[3][3], turn_w[3][3];
  int turns = 0;
  for (int i = 0; i < count; i++) {
    double t[3] = {0, 0, 0}, w[3] = {0, 0, 0};
    for (int j = 0; j < count; j++)
      for (int k = 0; k < 3; k++) {
        t[k] += vector[i][j] * basis[j][k];
        w[k] += vector[i][j] * basis[j][3 + k];
      }
    double size = bw_norm(w);
    if (size <= HELD_TOLERANCE && shifts < 3) {
      for (int s = 0; s < shifts; s++) {
        double part = bw_dot(t, shift[s]);
        for (int k = 0; k < 3; k++)
          t[k] -= part * shift[s][k];
      }
      double length_t = bw_norm(t);
      for (int k = 0; k < 3; k++)
        shift[shifts][k] = t[k] / length_t;
      shifts++;
    } else if (turns < 3) { /* unit rotations, orthogonal to each other */
      for (int k = 0; k < 3; k++) {
        turn_t[turns][k] = t[k] / size;
        turn_w[turns][k] = w[k] / size;
      }
      turns++;
    }
  }
  count = shifts + turns;
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
    name_motion(&motion[i], length);
  }

  /* The rotations, orthogonal to the translations: principal axes of
   * <r, s> = t . t' + w . J w' among them (w here is L times the angular velocity). */
  for (int i = 0; i < turns; i++)
    for (int s = 0; s < shifts; s++) {
      double part = bw_dot(turn_t[i], shift[s]);
      for (int k = 0; k < 3; k++)
        turn_t[i][k] -= part * shift[s][k];
    }
  for (int i = 0; i < turns; i++)
    for (int j = 0; j < turns; j++) {
      gram[i][j] = bw_dot(turn_t[i], turn_t[j]);
      for (int k = 0; k < 3; k++)
        gram[i][j] += turn_w[i][k] * dot(3, inertia + 3 * k, turn_w[j]) / (length * length);
    }
  jacobi(turns, gram, value, vector);
  for (int first = 0; first < turns;) { /* equal moments: any axes are principal, so take x, y, z */
    int next = first + 1;
    while (next < turns && value[next] - value[first] <= EQUAL_MOMENTS * value[turns - 1])
      next++;
    double t[3][3] = {{0}}, w[3][3] = {{0}};
    for (int i = first; i < next; i++)
      for (int j = 0; j < turns; j++)
        for (int k = 0; k < 3; k++) {
          t[i - first][k] += vector[i][j] * turn_t[j][k];
          w[i - first][k] += vector[i][j] * turn_w[j][k];
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
        norm += wi[k] * dot(3, inertia + 3 * k, wi) / (length * length);
      norm = sqrt(norm);
      for (int k = 0; k < 3; k++) {
        ti[k] /= norm;
        wi[k] /= norm * length;
      }
      largest_positive(wi, ti);
      motion[shifts + i].component = component;
      set_turn(&motion[shifts + i], centre, ti, wi, length);
      name_motion(&motion[shifts + i], length);
    }
    first = next;
  }
  return count;
}

void bwi_motion_at(const bw_rigid_motion *motion, const double x[3], double u[3]) {
  double arm[3] = {x[0] - motion->centre[0], x[1] - motion->centre[1], x[2] - motion->centre[2]};
  bw_cross(motion->rotation, arm, u);
  for (int k = 0; k < 3; k++)
    u[k] += motion->translation[k];
}

/* ---- products with the motions ---------------------------------------------------------------
 *
 * Each works on the nodes of one body with the six numbers of a motion about the body's centre. */

static int motions_of(const bw_numbering *numbering, int32_t body) {
  return numbering->motion_start[body + 1] - numbering->motion_start[body];
}

/* a[m] of the body's motions from the resultant and the moment about the body's centre. */
static void along_motions(const bw_numbering *numbering, int32_t body, const double sum[3],
                          const double moment[3], double *a) {
  const bw_rigid_motion *motion = numbering->motion + numbering->motion_start[body];
  for (int m = 0; m < motions_of(numbering, body); m++) {
    double at_centre[3];
    bwi_motion_at(&motion[m], numbering->body_centre + 3 * (size_t)body, at_centre);
    a[m] = bw_dot(at_centre, sum) + bw_dot(motion[m].rotation, moment);
  }
}

/* t and w, about the body's centre, of sum a[m] motion m. */
static void combined(const bw_numbering *numbering, int32_t body, const double *a, double t[3],
                     double w[3]) {
  const bw_rigid_motion *motion = numbering->motion + numbering->motion_start[body];
  memset(t, 0, 3 * sizeof *t);
  memset(w, 0, 3 * sizeof *w);
  for (int m = 0; m < motions_of(numbering, body); m++) {
    double at_centre[3];
    bwi_motion_at(&motion[m], numbering->body_centre + 3 * (size_t)body, at_centre);
    for (int k = 0; k < 3; k++) {
      t[k] += a[m] * at_centre[k];
      w[k] += a[m] * motion[m].rotation[k];
    }
  }
}

static void dot_body(const bw_numbering *numbering, int32_t body, const double *force, double *a) {
  const double *centre = numbering->body_centre + 3 * (size_t)body;
  double sum[3] = {0, 0, 0}, moment[3] = {0, 0, 0};
  for (int32_t j = numbering->body_start[body]; j < numbering->body_start[body + 1]; j++) {
    size_t i = (size_t)numbering->body_node[j];
    const double *x = numbering->mesh->node + 3 * i, *f = force + 3 * i;
    double y[3] = {x[0] - centre[0], x[1] - centre[1], x[2] - centre[2]}, turn[3];
    bw_cross(y, f, turn);
    for (int k = 0; k < 3; k++) {
      sum[k] += f[k];
      moment[k] += turn[k];
    }
  }
  along_motions(numbering, body, sum, moment, a);
}

static void measure_body(const bw_numbering *numbering, int32_t body, const double *displacement,
                         double *a) {
  double sum[3] = {0, 0, 0}, moment[3] = {0, 0, 0};
  for (int32_t j = numbering->body_start[body]; j < numbering->body_start[body + 1]; j++) {
    size_t i = (size_t)numbering->body_node[j];
    const double *u = displacement + 3 * i, *weight = numbering->weight + 4 * i;
    double turn[3];
    bw_cross(weight + 1, u, turn); /* u . (w x q) = w . (q x u) */
    for (int k = 0; k < 3; k++) {
      sum[k] += weight[0] * u[k];
      moment[k] += turn[k];
    }
  }
  along_motions(numbering, body, sum, moment, a);
}

static void add_body(const bw_numbering *numbering, int32_t body, double factor, const double *a,
                     double *u) {
  const double *centre = numbering->body_centre + 3 * (size_t)body;
  double t[3], w[3];
  combined(numbering, body, a, t, w);
  for (int32_t j = numbering->body_start[body]; j < numbering->body_start[body + 1]; j++) {
    size_t i = (size_t)numbering->body_node[j];
    const double *x = numbering->mesh->node + 3 * i;
    double y[3] = {x[0] - centre[0], x[1] - centre[1], x[2] - centre[2]}, turn[3];
    bw_cross(w, y, turn);
    for (size_t k = 0; k < 3; k++)
      u[3 * i + k] += factor * (t[k] + turn[k]);
  }
}

static void add_weighted_body(const bw_numbering *numbering, int32_t body, double factor,
                              const double *a, double *f) {
  double t[3], w[3];
  combined(numbering, body, a, t, w);
  for (int32_t j = numbering->body_start[body]; j < numbering->body_start[body + 1]; j++) {
    size_t i = (size_t)numbering->body_node[j];
    const double *weight = numbering->weight + 4 * i;
    double turn[3];
    bw_cross(w, weight + 1, turn);
    for (size_t k = 0; k < 3; k++)
      f[3 * i + k] += factor * (t[k] * weight[0] + turn[k]);
  }
}

void bw_motions_dot(const bw_numbering *numbering, const double *force, double *a) {
  for (int32_t body = 0; body < numbering->mesh->component_count; body++)
    if (motions_of(numbering, body))
      dot_body(numbering, body, force, a + numbering->motion_start[body]);
}

void bw_motions_measure(const bw_numbering *numbering, const double *displacement, double *a) {
  for (int32_t body = 0; body < numbering->mesh->component_count; body++)
    if (motions_of(numbering, body))
      measure_body(numbering, body, displacement, a + numbering->motion_start[body]);
}

void bw_motions_add(const bw_numbering *numbering, const double *a, double *displacement) {
  for (int32_t body = 0; body < numbering->mesh->component_count; body++)
    if (motions_of(numbering, body))
      add_body(numbering, body, 1, a + numbering->motion_start[body], displacement);
}

void bw_motions_weighted(const bw_numbering *numbering, const double *a, double *force) {
  memset(force, 0, 3 * sizeof *force * (size_t)numbering->mesh->node_count);
  for (int32_t body = 0; body < numbering->mesh->component_count; body++)
    if (motions_of(numbering, body))
      add_weighted_body(numbering, body, 1, a + numbering->motion_start[body], force);
}

void bw_motions_balance(const bw_numbering *numbering, double *force) {
  for (int32_t body = 0; body < numbering->mesh->component_count; body++)
    if (motions_of(numbering, body)) {
      double a[6];
      dot_body(numbering, body, force, a);
      add_weighted_body(numbering, body, -1, a, force);
    }
}

void bw_motions_remove(const bw_numbering *numbering, double *displacement) {
  for (int32_t body = 0; body < numbering->mesh->component_count; body++)
    if (motions_of(numbering, body)) {
      double a[6];
      measure_body(numbering, body, displacement, a);
      add_body(numbering, body, -1, a, displacement);
    }
}
