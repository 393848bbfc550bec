# Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later.
# Reads a matrix and two arrays that barwright wrote with SciPy and NumPy, and writes them again for barwright to read.
# Exit status 77: SciPy is not there.
import sys

try:
    import numpy
    import scipy.io
    import scipy.sparse
except ImportError:
    sys.exit(77)

folder = sys.argv[1] + "/"
npz = scipy.sparse.load_npz(folder + "a.npz")
mtx = scipy.io.mmread(folder + "a.mtx").tocsr()
symmetric = scipy.io.mmread(folder + "s.mtx").tocsr()
array = numpy.load(folder + "b.npy")
column = numpy.load(folder + "c.npy")
text = scipy.io.mmread(folder + "b.mtx")
# a(i, j) = 1 / (1 + i + 3 j) where 7 i + 5 j is a multiple of 4, from 0; b(i, j) = sqrt(i + 10 j)
rows, columns = npz.shape
assert (rows, columns) == (9, 7), npz.shape
for i in range(rows):
    for j in range(columns):
        value = 1 / (1 + i + 3 * j) if (7 * i + 5 * j) % 4 == 0 else 0
        assert npz[i, j] == value and mtx[i, j] == value, (i, j)
assert npz.has_sorted_indices and npz.dtype == numpy.float64
assert (symmetric != symmetric.T).nnz == 0 and symmetric[3, 1] == -0.1 and symmetric.nnz == 13
assert array.shape == (6, 4) and column.shape == (5,) and column.dtype == numpy.int32
for i in range(6):
    for j in range(4):
        assert array[i, j] == numpy.sqrt(i + 10.0 * j) == text[i, j], (i, j)
assert list(column) == [0, 1, 4, 9, 16]

scipy.sparse.save_npz(folder + "packed.npz", npz)
scipy.sparse.save_npz(folder + "stored.npz", npz, compressed=False)
scipy.sparse.save_npz(folder + "csc.npz", npz.tocsc())
scipy.io.mmwrite(folder + "general.mtx", npz, precision=17)
scipy.io.mmwrite(folder + "symmetric.mtx", symmetric, precision=17)
numpy.save(folder + "fortran.npy", numpy.asfortranarray(array))
numpy.save(folder + "big.npy", array.astype(">f4"))
numpy.save(folder + "bool.npy", array > 3)
numpy.save(folder + "cube.npy", numpy.zeros((2, 2, 2)))
numpy.save(folder + "complex.npy", array + 1j)
