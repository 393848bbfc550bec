# Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later.
# An independent reader, meshio, on the file of test_grid_vtu.c:
#   read_hexahedra.py FILE VOLUME
# VTK's hexahedron: corners 0 1 2 3 around the low face, counter-clockwise from above, 4 5 6 7 over them.
import sys

import meshio
import numpy as np

mesh = meshio.read(sys.argv[1])
(block,) = mesh.cells
assert block.type == "hexahedron", block.type
x = mesh.points[block.data]
for corner, (along, across, up) in enumerate(
    [(1, 3, 4), (2, 0, 5), (3, 1, 6), (0, 2, 7), (7, 5, 0), (4, 6, 1), (5, 7, 2), (6, 4, 3)]
):
    edges = [x[:, k] - x[:, corner] for k in (along, across, up)]
    corner_volume = np.einsum("ij,ij->i", np.cross(edges[0], edges[1]), edges[2])
    assert np.all(corner_volume > 0), corner
fraction = mesh.cell_data["fraction"][0].ravel()
material = mesh.cell_data["material"][0].ravel()
volume = np.sum(corner_volume * fraction)
assert abs(volume - float(sys.argv[2])) < 1e-12, volume
centre = x.mean(axis=1)
assert np.array_equal(material, np.where(centre[:, 0] < 1, 2, 5))
assert np.allclose(mesh.point_data["u"], 2 * mesh.points + 1, rtol=0, atol=1e-15)
assert np.allclose(mesh.cell_data["height"][0].ravel(), centre[:, 2], rtol=0, atol=1e-14)
