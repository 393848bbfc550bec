# Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later.
"""The blocks of statics.lua by DOLFINx and PETSc: processor seconds of conjugate gradients with GAMG and BoomerAMG.

Usage: /usr/bin/python3 scripts/bench/dolfinx_block.py CELLS [gamg|hypre]... (Debian package python3-dolfinx)

A cube of CELLS^3 cubes of six quadratic tetrahedra, steel, fixed at x = 0, 1 kN along x and -1 kN along z on x = 1.
GAMG gets the rigid-body modes; BoomerAMG takes the three components apart, since its interpolation of those modes takes
four times as long (14,739 unknowns). Iterations stop at a relative residual of 1e-10, as in statics.lua.
Prints a Markdown row for each: unknowns, processor seconds of assembly, set-up, iteration and all of it from the
mesh on, and the largest fall, by which the meshes are compared with statics.lua.
"""
import sys
import time

import numpy as np
from dolfinx import fem, la, mesh
from mpi4py import MPI
from petsc4py import PETSc
import ufl

YOUNG, POISSON = 210e9, 0.3
OPTIONS = {
    "gamg": {"pc_type": "gamg", "pc_gamg_type": "agg", "mg_levels_ksp_type": "chebyshev",
             "mg_levels_pc_type": "jacobi"},
    "hypre": {"pc_type": "hypre", "pc_hypre_type": "boomeramg", "pc_hypre_boomeramg_strong_threshold": 0.5},
}


def rigid_modes(space):
    """The six rigid-body modes at the nodes of a space, orthonormal."""
    x = space.tabulate_dof_coordinates()
    blocks = [la.create_petsc_vector(space.dofmap.index_map, space.dofmap.index_map_bs) for _ in range(6)]
    for k, block in enumerate(blocks):
        with block.localForm() as local:
            values = local.array.reshape(-1, 3)
            values[:] = 0
            if k < 3:
                values[:, k] = 1
            else:
                i, j = [(0, 1), (1, 2), (2, 0)][k - 3]
                values[:, i], values[:, j] = -x[:len(values), j], x[:len(values), i]
    la.orthonormalize(blocks)
    return PETSc.NullSpace().create(vectors=blocks)


def solve(cells, preconditioner):
    start = time.process_time()
    box = mesh.create_box(MPI.COMM_SELF, [[0, 0, 0], [1, 1, 1]], [cells] * 3, mesh.CellType.tetrahedron)
    space = fem.VectorFunctionSpace(box, ("CG", 2))
    u, v = ufl.TrialFunction(space), ufl.TestFunction(space)
    mu, lmbda = YOUNG / (2 * (1 + POISSON)), YOUNG * POISSON / ((1 + POISSON) * (1 - 2 * POISSON))

    def strain(w):
        return ufl.sym(ufl.grad(w))

    form = fem.form((2 * mu * ufl.inner(strain(u), strain(v)) + lmbda * ufl.div(u) * ufl.div(v)) * ufl.dx)
    loaded = mesh.locate_entities_boundary(box, 2, lambda x: np.isclose(x[0], 1))
    tags = mesh.meshtags(box, 2, np.sort(loaded), np.ones(len(loaded), dtype=np.int32))
    ds = ufl.Measure("ds", domain=box, subdomain_data=tags)
    traction = fem.Constant(box, PETSc.ScalarType((1e3, 0, -1e3)))
    load = fem.form(ufl.inner(traction, v) * ds(1))
    fixed = mesh.locate_entities_boundary(box, 2, lambda x: np.isclose(x[0], 0))
    conditions = [fem.dirichletbc(np.zeros(3), fem.locate_dofs_topological(space, 2, fixed), space)]
    made = time.process_time()
    matrix = fem.petsc.assemble_matrix(form, conditions)
    matrix.assemble()
    right = fem.petsc.assemble_vector(load)
    fem.petsc.set_bc(right, conditions)
    matrix.setOption(PETSc.Mat.Option.SPD, True)
    if preconditioner == "gamg":
        matrix.setNearNullSpace(rigid_modes(space))
    assembled = time.process_time()
    options = PETSc.Options()
    for key, value in OPTIONS[preconditioner].items():
        options[key] = value
    krylov = PETSc.KSP().create(MPI.COMM_SELF)
    krylov.setType("cg")
    krylov.setNormType(PETSc.KSP.NormType.UNPRECONDITIONED)
    krylov.setTolerances(rtol=1e-10, max_it=1000)
    krylov.setOperators(matrix)
    krylov.setFromOptions()
    krylov.setUp()
    ready = time.process_time()
    answer = matrix.createVecRight()
    krylov.solve(right, answer)
    end = time.process_time()
    residual = right - matrix * answer
    fall = answer.array.reshape(-1, 3)[:, 2].min()
    print(f"| block:{cells} | {matrix.size[0]} | {preconditioner} | {assembled - made:.1f} | {ready - assembled:.1f} | "
          f"{end - ready:.1f} | {end - start:.1f} | {krylov.its} | {residual.norm() / right.norm():.1e} | "
          f"{fall:.11e} |", flush=True)


if len(sys.argv) < 2:
    sys.exit(__doc__)
print("| body | unknowns | preconditioner | assembly, s | set-up, s | iteration, s | all, s | iterations | residual | "
      "largest fall, m |\n|---|---|---|---|---|---|---|---|---|---|")
for name in sys.argv[2:] or list(OPTIONS):
    solve(int(sys.argv[1]), name)
