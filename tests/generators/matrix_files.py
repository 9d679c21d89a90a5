#!/usr/bin/env python3
"""The small matrix files on which the readers of pinode/structure are tested,
and from which their fuzzers start, as other programs write them.

Run from the project's root and commit what it writes:

    python3 tests/generators/matrix_files.py tests/fuzz/corpus

All of them hold one model, a cantilever of four DOFs whose third is a rotation
without mass:

    K = [ 4 -2  0  0;  -2  5 -1.5  0;  0 -1.5 3 -1;  0 0 -1 1 ] * 1e6
    M = [ 2 0.5 0 0;  0.5 2 0 0;  0 0 0 0;  0 0 0 1 ]
    C = 0.01 K + 0.5 M
"""

import os
import struct
import sys

import numpy as np
import scipy.io
import scipy.sparse as sp

K = 1e6 * np.array(
    [[4.0, -2, 0, 0], [-2, 5, -1.5, 0], [0, -1.5, 3, -1], [0, 0, -1, 1]]
)
M = np.array([[2, 0.5, 0, 0], [0.5, 2, 0, 0], [0, 0, 0, 0], [0, 0, 0, 1.0]])
C = 0.01 * K + 0.5 * M
DOFS = [(1, 1), (2, 1), (2, 6), (3, 1)]
NAMES = ["%d.%d" % dof for dof in DOFS]


def write(folder, name, content):
    os.makedirs(folder, exist_ok=True)
    mode = "wb" if isinstance(content, bytes) else "w"
    with open(os.path.join(folder, name), mode) as file:
        file.write(content)


def matrix_market(root):
    folder = os.path.join(root, "matrix_market")
    os.makedirs(folder, exist_ok=True)
    for name, matrix in [("K", K), ("M", M), ("C", C)]:
        sparse = sp.coo_matrix(matrix)
        scipy.io.mmwrite(
            os.path.join(folder, name + ".mtx"), sparse, symmetry="symmetric"
        )
    scipy.io.mmwrite(
        os.path.join(folder, "K_general.mtx"),
        sp.coo_matrix(K),
        symmetry="general",
    )
    scipy.io.mmwrite(os.path.join(folder, "K_array.mtx"), K)


def lower(matrix):
    sparse = sp.coo_matrix(np.tril(matrix))
    return zip(sparse.row, sparse.col, sparse.data)


def calculix(root):
    folder = os.path.join(root, "calculix")
    for name, matrix in [("beam.sti", K), ("beam.mas", M)]:
        # The upper triangle, column by column.
        lines = ["%d %d %20.13e\n" % (j + 1, i + 1, v) for i, j, v in
                 sorted(lower(matrix))]
        write(folder, name, "".join(lines))
    write(folder, "beam.dof", "".join(name + "\n" for name in NAMES))


def abaqus(root):
    folder = os.path.join(root, "abaqus")
    for name, matrix in [("beam_STIF2", K), ("beam_MASS2", M)]:
        lines = ["** Assembled nodal loads are not written\n"]
        for i, j, v in sorted(lower(matrix)):
            lines.append("%d,%d, %d,%d, %.15e\n" % (*DOFS[i], *DOFS[j], v))
        write(folder, name + ".mtx", "".join(lines))
    lines = []
    for i in range(4):
        for j in range(4):
            if K[i, j] != 0:
                lines.append("%d,%d,%d,%d,%.15e\n" %
                             (*DOFS[i], *DOFS[j], K[i, j]))
    write(folder, "beam_full_STIF2.mtx", "".join(lines))


def harwell_boeing(root):
    """The general matrices are SciPy's; the others look like HBMAT's."""
    folder = os.path.join(root, "harwell_boeing")
    os.makedirs(folder, exist_ok=True)
    for name, matrix in [("K_general", K), ("M_general", M)]:
        scipy.io.hb_write(os.path.join(folder, name + ".hb"),
                          sp.csc_matrix(matrix))
    for name, matrix in [("K", K), ("M", M)]:
        half = sp.csc_matrix(np.tril(matrix))
        begins = ["%14d" % (i + 1) for i in half.indptr]
        rows = ["%14d" % (i + 1) for i in half.indices]
        values = [("%26.16E" % v).replace("E", "D") for v in half.data]
        loads = ["%26.16E" % 0.0] * 4
        counts = (len(begins), len(rows), len(values), len(loads))
        lines = ["%-72s%-8s" % ("A cantilever of four DOFs", name),
                 "%14d" * 5 % ((sum(counts),) + counts),
                 "%-14s" % "RSA" + "%14d" * 4 % (4, 4, half.nnz, 0),
                 "%-16s%-16s%-20s%-20s" % ("(1I14)", "(1I14)", "(1D26.16)",
                                           "(1E26.16)"),
                 "%-14s%14d%14d" % ("F", 1, 0)]
        write(folder, name + ".matrix",
              "\n".join(lines + begins + rows + values + loads) + "\n")
    labels = {1: "UX", 6: "ROTZ"}
    lines = ["   Matrix Eqn         Node          DOF\n"]
    for row, (node, direction) in enumerate(DOFS):
        lines.append("%13d%13d%13s\n" % (row + 1, node, labels[direction]))
    write(folder, "K.mapping", "".join(lines))


def dmig_wide(name, matrix):
    """Columns as in the punch file of a superelement."""
    lines = ["DMIG    %-8s%8d%8d%8d%8d%24d" % (name, 0, 6, 2, 0, 4)]
    for j in range(4):
        column = "DMIG*   %-16s%16d%16d" % (name, *DOFS[j])
        entries = []
        for i in range(j, 4):
            if matrix[i, j] != 0:
                value = ("%16.9E" % matrix[i, j]).replace("E", "D")
                entries.append("*       %16d%16d%16s" % (*DOFS[i], value))
        if entries:
            lines += [column] + entries
    return lines


def nastran(value):
    """A real number in eight places: 4.+6 is four million."""
    if abs(value) < 1e5:
        return "%.3f" % value
    mantissa = "%g" % (value / 1e6)
    return mantissa + ("" if "." in mantissa else ".") + "+6"


def dmig(root):
    folder = os.path.join(root, "dmig")
    lines = ["$ A superelement", "GRID*                  1               0"
             "  0.000000000E+00", "*"]
    write(folder, "wide.pch", "\n".join(
        lines + dmig_wide("KAAX", K) + dmig_wide("MAAX", M)
        + ["ASET1   1       1       2       3"]) + "\n")
    # Narrow fields, two entries a line; both triangles, as a square matrix.
    lines = []
    for name, matrix in [("K", K), ("M", M)]:
        lines.append("DMIG    %-8s%8d%8d%8d%8d" % (name, 0, 1, 1, 0))
        for j in range(4):
            rows = [i for i in range(4) if matrix[i, j] != 0]
            entries = ["%8d%8d%8s%8s" % (*DOFS[i], nastran(matrix[i, j]), "")
                       for i in rows]
            if not entries:
                continue
            lines.append("DMIG    %-8s%8d%8d%8s%s" % (name, *DOFS[j], "",
                                                      entries[0]))
            for k in range(1, len(entries), 2):
                lines.append("+       " + "".join(entries[k:k + 2]))
    write(folder, "narrow.dmig", "\n".join(lines) + "\n")
    # Free fields; each entry of a symmetric matrix on whichever side.
    lines = ["DMIG,CPLX,0,6,3,0", "DMIG,CPLX,1,1,,1,1,1.0,2.0"]
    for name, matrix in [("KAAX", K), ("MAAX", M)]:
        lines.append("DMIG,%s,0,6,2,0" % name)
        for i, j, value in sorted(lower(matrix)):
            i, j = (i, j) if (i + j) % 4 == 1 else (j, i)
            lines.append("DMIG,%s,%d,%d,,%d,%d,%r" % (name, *DOFS[j], *DOFS[i],
                                                      float(value)))
    write(folder, "free.pch", "\n".join(lines) + "\n")


def strings(column):
    """Runs of non-zeros: (first row from 0, values)."""
    runs = []
    for i, value in enumerate(column):
        if value == 0:
            continue
        if runs and runs[-1][0] + len(runs[-1][1]) == i:
            runs[-1][1].append(value)
        else:
            runs.append((i, [value]))
    return runs


def op4_ascii(matrices, kind):
    out = []

    def numbers(values):
        for begin in range(0, len(values), 3):
            out.append("".join("%23.16E" % v for v in values[begin:begin + 3]))

    for name, matrix in matrices:
        n = matrix.shape[0]
        out.append("%8d%8d%8d%8d%-8s%s" % (
            n, -n if kind == "bigmat" else n, 6, 2, name, "1P,3E23.16"))
        for j in range(n):
            runs = strings(matrix[:, j])
            if not runs:
                continue
            if kind == "dense":
                first = runs[0][0]
                last = runs[-1][0] + len(runs[-1][1])
                out.append("%8d%8d%8d" % (j + 1, first + 1, last - first))
                numbers(matrix[first:last, j])
                continue
            head = 2 if kind == "bigmat" else 1
            words = sum(head + 2 * len(values) for _, values in runs)
            out.append("%8d%8d%8d" % (j + 1, 0, words))
            for row, values in runs:
                length = 2 * len(values)
                if kind == "bigmat":
                    out.append("%8d%8d" % (length + 1, row + 1))
                else:
                    out.append("%12d" % (row + 1 + 65536 * (length + 1)))
                numbers(values)
        out.append("%8d%8d%8d" % (n + 1, 1, 1))
        out.append("%23.16E" % 1.0)
    return "\n".join(out) + "\n"


def op4_binary(matrices, kind, order, word, single=False, marker=4):
    """word, marker: bytes of an integer and of a record's length."""
    out = b""
    integer = "i" if word == 4 else "q"

    def record(payload):
        length = struct.pack(order + ("i" if marker == 4 else "q"),
                             len(payload))
        return length + payload + length

    def name_words(name):
        # Two words of four characters, whatever else a word has room for.
        return b"".join(name.ljust(8)[i:i + 4].ljust(word).encode()
                        for i in (0, 4))

    def ints(*values):
        return struct.pack(order + integer * len(values), *values)

    def reals(values):
        real = "f" if single and word == 4 else "d"
        return struct.pack(order + real * len(values), *values)

    words_per_number = 1 if single or word == 8 else 2
    for name, matrix in matrices:
        n = matrix.shape[0]
        out += record(
            ints(n, -n if kind == "bigmat" else n, 6, 1 if single else 2)
            + name_words(name))
        for j in range(n):
            runs = strings(matrix[:, j])
            if not runs:
                continue
            if kind == "dense":
                first = runs[0][0]
                last = runs[-1][0] + len(runs[-1][1])
                out += record(
                    ints(j + 1, first + 1, words_per_number * (last - first))
                    + reals(matrix[first:last, j]))
                continue
            payload = b""
            for row, values in runs:
                length = words_per_number * len(values)
                if kind == "bigmat":
                    payload += ints(length + 1, row + 1)
                else:
                    payload += ints(row + 1 + 65536 * (length + 1))
                payload += reals(values)
            out += record(ints(j + 1, 0, len(payload) // word) + payload)
        out += record(ints(n + 1, 1, words_per_number) + reals([1.0]))
    return out


def op4(root):
    folder = os.path.join(root, "op4")
    matrices = [("MGG", M), ("BGG", C), ("KGG", K)]
    for kind in ["dense", "sparse", "bigmat"]:
        write(folder, "ascii_%s.op4" % kind, op4_ascii(matrices, kind))
        for order, name in [("<", "little"), (">", "big")]:
            for word in [4, 8]:
                write(folder, "%s_%d_%s.op4" % (name, 8 * word, kind),
                      op4_binary(matrices, kind, order, word))
    write(folder, "single.op4",
          op4_binary([("MGG", M)], "sparse", "<", 4, single=True))
    write(folder, "single_64.op4",
          op4_binary([("MGG", M)], "sparse", ">", 8, single=True))
    long_names = [("MGGEXT", M), ("BGGEXT", C), ("KGGEXT", K)]
    for order, name in [("<", "little"), (">", "big")]:
        write(folder, "%s_64_names.op4" % name,
              op4_binary(long_names, "bigmat", order, 8))
        write(folder, "%s_64_marker.op4" % name,
              op4_binary(matrices, "sparse", order, 8, marker=8))
        write(folder, "%s_32_marker.op4" % name,
              op4_binary(matrices, "dense", order, 4, marker=8))


def mat(root):
    folder = os.path.join(root, "mat")
    os.makedirs(folder, exist_ok=True)
    cells = np.empty((4, 1), dtype=object)
    for i, name in enumerate(NAMES):
        cells[i, 0] = name
    for name, compressed in [("sparse", False), ("compressed", True)]:
        scipy.io.savemat(
            os.path.join(folder, name + ".mat"),
            {"M": sp.csc_matrix(M), "C": sp.csc_matrix(C),
             "K": sp.csc_matrix(K), "dofs": cells, "note": "a cantilever"},
            do_compression=compressed)
    scipy.io.savemat(
        os.path.join(folder, "full.mat"),
        {"mass": M, "stiffness": K.astype(np.int32),
         "dof_map": np.array(DOFS, dtype=np.int32),
         "history": np.zeros((2, 3))})
    scipy.io.savemat(
        os.path.join(folder, "char.mat"), {"M": M, "K": K,
                                           "dofs": np.array(NAMES)})
    # What else a workspace may hold.
    others = np.empty((2, 2), dtype=object)
    others[0, 0], others[0, 1] = "text", np.eye(2)
    others[1, 0], others[1, 1] = 3.0, np.zeros((0, 0))
    scipy.io.savemat(
        os.path.join(folder, "workspace.mat"),
        {"K": K, "M": sp.csc_matrix(M), "dofs": cells, "others": others,
         "none": "", "flags": np.array([True, False]),
         "options": {"a": 1.0, "b": "text", "c": {"d": np.zeros((0, 0))}},
         "elements": np.array([(1, "beam"), (3, "shell")],
                              dtype=[("id", object), ("kind", object)])})
    # SciPy writes the date into the text that begins a file.
    for name in sorted(os.listdir(folder)):
        path = os.path.join(folder, name)
        with open(path, "rb") as file:
            content = file.read()
        text = b"MATLAB 5.0 MAT-file, as SciPy writes it".ljust(116)
        write(folder, name, text + content[116:])


def npz(root):
    folder = os.path.join(root, "npz")
    os.makedirs(folder, exist_ok=True)
    np.savez(os.path.join(folder, "full.npz"), M=M, C=C, K=K,
             dofs=np.array(NAMES), history=np.zeros((2, 3)))
    np.savez_compressed(
        os.path.join(folder, "types.npz"), M=M.astype(">f4"),
        K=np.asfortranarray(K.astype(np.int32)), dof_map=np.array(DOFS))
    for kind in ["csr", "csc", "coo"]:
        sp.save_npz(os.path.join(folder, "K_%s.npz" % kind),
                    sp.coo_matrix(K).asformat(kind))
    sp.save_npz(os.path.join(folder, "M_csr.npz"), sp.csr_matrix(M))
    k = sp.csr_matrix(K)
    m = sp.coo_matrix(M)
    np.savez(os.path.join(folder, "parts.npz"), K_data=k.data,
             K_indices=k.indices, K_indptr=k.indptr, K_shape=k.shape,
             M_data=m.data, M_row=m.row, M_col=m.col, M_shape=m.shape,
             dofs=np.array(NAMES, dtype="S"))
    np.savez(os.path.join(folder, "complex.npz"), M=M, K=K + 1j * K)


def main():
    root = sys.argv[1]
    for generate in [matrix_market, calculix, abaqus, harwell_boeing, dmig,
                     op4, mat, npz]:
        generate(root)


if __name__ == "__main__":
    main()
