# Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later.
"""The lowest modes of a free body by SLEPc without a factor, beside eigenvalues of bw.eigensolver.

Usage: /usr/bin/python3 scripts/bench/slepc_block.py FOLDER [gd|jd]... (Debian packages python3-slepc4py, python3-scipy)

FOLDER is what scripts/bench/slepc_block.lua writes. The generalised Davidson method (gd) or Jacobi-Davidson (jd) works
in the complement of the six rigid-body modes. Its preconditioner is one cycle of PETSc's GAMG, with those modes as near
null space, for K + s M: K alone is singular, and s is a fifth of the lowest eigenvalue.

The residual of a mode is |K x - a M x| over |a M x|, both in the norm of the inverse of the diagonal D of M. It says
how exact an eigenvalue a is: with M >= t D the relative error is at most residual^2 / t times a over its distance to
the next eigenvalue that is not of its cluster. For tet10 t is 1/4 to 1/16, and the bound takes 1/16.

Prints a Markdown row for each solver: processor seconds of set-up and of iteration, memory, the largest residual, the
largest of these bounds, and the largest relative differences from the eigenvalues in FOLDER.
"""
import glob
import os
import resource
import sys
import time

import numpy as np
import petsc4py

petsc4py.init(sys.argv[:1])
from petsc4py import PETSc  # noqa: E402
import scipy.sparse  # noqa: E402
from slepc4py import SLEPc  # noqa: E402

RESIDUAL = 2e-6  # to be reached
MASS_FRACTION = 1 / 16
CLUSTER = 1e-3  # relative distance of eigenvalues of one cluster, split by rounding or by the mesh


def matrix(path):
    a = scipy.sparse.load_npz(path)
    out = PETSc.Mat().createAIJ(a.shape, bsize=3, comm=PETSc.COMM_SELF,
                                csr=(a.indptr.astype(np.int32), a.indices.astype(np.int32), a.data))
    out.setOption(PETSc.Mat.Option.SYMMETRIC, True)
    return out


def rigid_modes(nodes):
    at = PETSc.Vec().createWithArray(np.ascontiguousarray(nodes - nodes.mean(0)).ravel(), bsize=3,
                                     comm=PETSc.COMM_SELF)
    return PETSc.NullSpace().createRigidBody(at)


def bounds(values, residuals):
    """Of the relative errors. The last cluster has no known neighbour above, and that below stands for it.
    Where all values are one cluster nothing is known: nan."""
    out = []
    for i, value in enumerate(values):
        others = [abs(value - v) for v in values if abs(value - v) > CLUSTER * value]
        out.append(residuals[i] ** 2 / MASS_FRACTION * value / min(others, default=float("nan")))
    return out


def solve(name, K, M, rigid, own):
    begin = time.process_time()
    count, mass = len(next(iter(own.values()))), M.getDiagonal()
    shift = -0.2 * min(v[0] for v in own.values())
    P = K.copy()
    P.axpy(-shift, M, PETSc.Mat.Structure.SUBSET_NONZERO_PATTERN)
    P.setOption(PETSc.Mat.Option.SPD, True)
    P.setNearNullSpace(rigid)
    PETSc.Options()["st_pc_gamg_aggressive_coarsening"] = 1
    eps = SLEPc.EPS().create(PETSc.COMM_SELF)
    eps.setOperators(K, M)
    eps.setProblemType(SLEPc.EPS.ProblemType.GHEP)
    eps.setType(name)
    eps.setWhichEigenpairs(SLEPc.EPS.Which.SMALLEST_REAL)
    eps.setDimensions(count)
    eps.setTolerances(RESIDUAL * mass.sum() / mass.size, 5000)  # SLEPc's is |K x - a M x| / a, with |x| = 1
    eps.setDeflationSpace(rigid.getVecs())
    if name == "gd":  # wider starts and steps: 519 steps for 15 modes of 1.27 million unknowns
        eps.setGDInitialSize(16)
        eps.setGDBlockSize(2)
    st = eps.getST()
    st.setType("precond")
    st.setShift(shift)
    st.setPreconditionerMat(P)
    ksp = st.getKSP()
    ksp.setType("cg" if name == "jd" else "preonly")
    ksp.getPC().setType("gamg")
    eps.setFromOptions()
    eps.setUp()
    ready = time.process_time()
    eps.solve()
    end = time.process_time()
    found = min(eps.getConverged(), count)
    x, y, z = (K.createVecRight() for _ in range(3))

    def size(vector):
        return np.sqrt((vector.array ** 2 / mass.array).sum())

    values, residuals = np.empty(found), np.empty(found)
    for i in range(found):
        eps.getEigenpair(i, x)
        K.mult(x, y)
        M.mult(x, z)
        values[i] = x.dot(y) / x.dot(z)
        scale = values[i] * size(z)
        y.axpy(-values[i], z)
        residuals[i] = size(y) / scale
    order = np.argsort(values)
    values, residuals = values[order], residuals[order]
    differences = ", ".join(f"{n} {np.abs(values / v[:found] - 1).max():.1e}" for n, v in own.items())
    peak = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss * 1024 / 1e9
    print(f"| {K.size[0]} | {name} | {found} | {eps.getIterationNumber()} | {ready - begin:.1f} | {end - ready:.1f} | "
          f"{peak:.2f} | {residuals.max():.1e} | {max(bounds(values, residuals)):.1e} | {differences} |", flush=True)


if len(sys.argv) < 2:
    sys.exit(__doc__)
folder = sys.argv[1]
eigenvalues = {os.path.basename(p)[12:-4]: np.load(p).ravel() for p in glob.glob(folder + "/eigenvalues_*.npy")}
stiffness, mass_matrix = matrix(folder + "/k.npz"), matrix(folder + "/m.npz")
modes = rigid_modes(np.load(folder + "/nodes.npy"))
print("| unknowns | solver | modes | iterations | set-up, s | iteration, s | GB | residual | bound of the error | "
      "difference from |\n|---|---|---|---|---|---|---|---|---|---|")
for solver in sys.argv[2:] or ["gd"]:
    solve(solver, stiffness, mass_matrix, modes, eigenvalues)
