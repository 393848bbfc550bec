# Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later.
# An independent reader and writer, meshio, on the files of test_foreign.c:
#   compare_meshio.py read  FOLDER   files of barwright, compared with reference.txt
#   compare_meshio.py write FOLDER   files for barwright to read
import os
import sys

import meshio
import numpy as np

folder = sys.argv[2]


def reference(name):
    with open(os.path.join(folder, name)) as lines:
        words = lines.read().split()
    points, cells, width = (int(w) for w in words[:3])
    numbers = [float(w) for w in words[3:]]
    x = np.array(numbers[: 3 * points]).reshape(points, 3)
    c = np.array(numbers[3 * points :], dtype=int).reshape(cells, width)
    return x, c


def check(path, x, c, exact=True):
    mesh = meshio.read(path)
    got = np.vstack([block.data for block in mesh.cells])
    # A reader may weld or number points in its own way: compare corner by corner.
    a, b = mesh.points[got], x[c]
    assert a.shape == b.shape, (path, a.shape, b.shape)
    worst = np.abs(a - b).max()
    assert worst == 0 if exact else worst <= 1e-7 * np.abs(x).max(), (path, worst)
    return mesh


if sys.argv[1] == "read":
    for order in (1, 2):
        x, c = reference(f"reference{order}.txt")
        for name in ("vtu", "msh", "22.msh", "inp") + (("mesh",) if order == 1 else ()):
            exact = name != "inp"
            mesh = check(os.path.join(folder, f"mesh{order}.{name}"), x, c, exact)
            if name != "inp" and name != "mesh":
                assert np.array_equal(mesh.point_data["u"][:, 1], x[:, 0] * 2), name
    x, c = reference("surface.txt")
    for name in ("b.stl", "a.stl", "b.ply", "a.ply", "obj", "off", "vtu"):
        check(os.path.join(folder, "surface." + name), x, c, name != "b.stl")
else:
    x, c = reference("reference1.txt")
    mesh = meshio.Mesh(
        x, [("tetra", c)], point_data={"u": x * 2.0}, cell_data={"e": [np.arange(float(len(c)))]}
    )
    out = lambda name: os.path.join(folder, "meshio." + name)
    meshio.write(out("ascii.vtu"), mesh, binary=False)
    meshio.write(out("zlib.vtu"), mesh, binary=True, compression="zlib")
    meshio.write(out("plain.vtu"), mesh, binary=True, compression=None)
    for version in ("gmsh22", "gmsh"):
        for binary in (False, True):
            name = f"{version}.{'b' if binary else 'a'}.msh"
            meshio.write(out(name), mesh, file_format=version, binary=binary)
    meshio.write(out("mesh"), mesh)
    meshio.write(out("inp"), mesh)
    x, c = reference("surface.txt")
    surface = meshio.Mesh(x, [("triangle", c)])
    for binary in (False, True):
        meshio.write(out(f"{'b' if binary else 'a'}.stl"), surface, binary=binary)
        meshio.write(out(f"{'b' if binary else 'a'}.ply"), surface, binary=binary)
    meshio.write(out("obj"), surface)
    meshio.write(out("off"), surface)
