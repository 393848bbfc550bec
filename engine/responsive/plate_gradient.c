/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* How a frequency changes with the places of the nodes: d lambda = u^T (dK - lambda dM) u for a
 * mode with u^T M u = 1 and a simple eigenvalue. Element by element from the two energies; the
 * bubble's unknowns stay as they are, since the energy is stationary in them. */
#include <math.h>
#include <string.h>

#include "responsive/plate.h"

/* Energies are polynomials over Jacobians in the coordinates: central differences of an element
 * with this part of its size are exact to about 1e-10. */
static const double STEP = 1e-5;

bw_status bw_plate_gradient(bw_context *context, const bw_plate *plate, int mode,
                            double *gradient) {
  if (mode < 0 || mode >= plate->mode_count)
    return bw_fail(context, BW_INVALID, "mode %d: the plate has modes 1 to %d", mode + 1,
                   plate->mode_count);
  const struct bwi_plate *in = plate->inner;
  const bw_plane_topology *topology = plate->mesh->topology;
  int64_t nodes = topology->nodes->node_count;
  const double *shape = plate->shape + mode * 3 * nodes;
  const double pi = 3.14159265358979323846, f = plate->frequency[mode];
  double lambda = 4 * pi * pi * f * f;
  memset(gradient, 0, (size_t)(2 * nodes) * sizeof *gradient);
  for (int64_t e = 0; e < topology->element_count; e++) {
    const int32_t *node = topology->element + 6 * e;
    double x[6][2], u[20], matrix[18 * 18], bubble[2][18];
    for (int a = 0; a < 6; a++) {
      memcpy(x[a], plate->mesh->point + 2 * (int64_t)node[a], sizeof x[a]);
      memcpy(u + 3 * a, shape + 3 * (int64_t)node[a], 3 * sizeof *u);
    }
    bwi_plate_stiffness(&in->reference, &in->law, x, matrix, &bubble[0][0]);
    for (int c = 0; c < 2; c++) {
      u[18 + c] = 0;
      for (int k = 0; k < 18; k++)
        u[18 + c] += bubble[c][k] * u[k];
    }
    double step = STEP * hypot(x[1][0] - x[0][0], x[1][1] - x[0][1]);
    for (int a = 0; a < 6; a++)
      for (int c = 0; c < 2; c++) {
        double here = x[a][c], difference[2], elastic, kinetic;
        for (int side = 0; side < 2; side++) {
          x[a][c] = here + (side ? step : -step);
          bwi_plate_energies(&in->reference, &in->law, x, u, &elastic, &kinetic);
          difference[side] = elastic - lambda * kinetic;
        }
        x[a][c] = here;
        gradient[2 * (int64_t)node[a] + c] +=
            (difference[1] - difference[0]) / (2 * step) / (8 * pi * pi * f);
      }
  }
  return BW_OK;
}
