# Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later.
# Solves what barwright wrote, by SciPy: K x = b and the smallest eigenvalues of K x = lambda M x.
# Exit status 77: SciPy is not there.
import sys

try:
    import numpy
    import scipy.io
    import scipy.sparse.linalg
except ImportError:
    sys.exit(77)

folder = sys.argv[1] + "/"
k = scipy.io.mmread(folder + "k.mtx").tocsc()
m = scipy.sparse.load_npz(folder + "m.npz").tocsc()
b = numpy.load(folder + "b.npy")
numpy.save(folder + "x.npy", scipy.sparse.linalg.spsolve(k, b))
values = scipy.sparse.linalg.eigsh(k, 6, m, sigma=0, return_eigenvectors=False)
numpy.save(folder + "values.npy", numpy.sort(values))
