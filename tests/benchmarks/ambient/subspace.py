#!/usr/bin/env python3
"""subspace.py RECORD.npy RATE: covariance-driven stochastic subspace
identification with uncertainty in NumPy, one thread, as published: B. Peeters and
G. De Roeck, Mech. Syst. Signal Process. 13 (1999) 855; E. Reynders, R. Pintelon,
G. De Roeck, ibid. 22 (2008) 948; M. Doehler and L. Mevel, ibid. 38 (2013) 346,
whose efficient form of the sensitivities of singular vectors this is. Orders 2 to
60, as many block rows and blocks of samples as pinode_modes takes by default.
Prints the poles of the highest order that are certain, and CPU seconds."""

import os
import sys
import time

for name in ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS"):
    os.environ[name] = "1"
import numpy as np  # noqa: E402

BLOCK_ROWS, MAX_ORDER, BLOCKS = 37, 60, 100


def correlations(samples, lags):
    """Blocks x lags x channels x channels, of each block's own samples."""
    count = samples.shape[1] // BLOCKS
    result = np.empty((BLOCKS, lags, len(samples), len(samples)))
    for b in range(BLOCKS):
        part = samples[:, b * count:(b + 1) * count]
        for lag in range(lags):
            result[b, lag] = part[:, lag:] @ part[:, :count - lag].T / (
                count - lag)
    return result


def hankel(lags):
    return np.block([[lags[i + j + 1] for j in range(BLOCK_ROWS)]
                     for i in range(BLOCK_ROWS)])


def main():
    samples, rate = np.load(sys.argv[1]), float(sys.argv[2])
    began = time.process_time()
    channels = len(samples)
    lags = correlations(samples, 2 * BLOCK_ROWS)
    mean = hankel(lags.mean(axis=0))
    # Deviations of the blocks, of the mean of all.
    change = np.stack([hankel(block) for block in lags]) - mean
    change /= np.sqrt(BLOCKS * (BLOCKS - 1))
    u, s, vt = np.linalg.svd(mean)
    rows, columns = mean.shape
    u1, s1, v1 = u[:, :MAX_ORDER], s[:MAX_ORDER], vt[:MAX_ORDER].T
    moved = np.empty((MAX_ORDER, BLOCKS, rows))
    gram = mean.T @ mean
    for j in range(MAX_ORDER):
        uj, sj, vj = u1[:, j], s1[j], v1[:, j]
        k = np.eye(columns) - gram / sj**2
        k[-1] += 2 * vj
        k = np.linalg.inv(k)
        hk = mean @ k / sj
        shifted = mean.T / sj
        shifted[-1] -= uj
        left = np.eye(rows) + hk @ shifted
        by_v = change @ vj
        by_u = np.einsum("bij,i->bj", change, uj, optimize=True)
        by_v -= np.outer(by_v @ uj, uj)
        by_u -= np.outer(by_u @ vj, vj)
        moved[j] = (by_v @ left.T + by_u @ hk.T) / sj
    certain = []
    for order in range(2, MAX_ORDER + 1, 2):
        o, d_o = u1[:, :order], moved[:order]  # balancing does not matter
        up, down = o[:-channels], o[channels:]
        inverse = np.linalg.pinv(up)
        a = inverse @ down
        values, right = np.linalg.eig(a)
        left = np.linalg.inv(right)
        rest = down - up @ a
        normal = np.linalg.inv(up.T @ up)
        poles = np.log(values) * rate
        for i in np.flatnonzero(poles.imag > 0):
            phi, chi = right[:, i], left[i]
            d_down = np.einsum("jbr,j->br", d_o[:, :, channels:], phi)
            d_up = np.einsum("jbr,j->br", d_o[:, :, :-channels], a @ phi)
            d_a = (d_down - d_up) @ (inverse.T @ chi)
            d_a += np.einsum("jbr,r,j->b", d_o[:, :, :-channels], rest @ phi,
                             normal @ chi, optimize=True)
            d_pole = d_a * rate / values[i]
            # The shape's, as C = the first block row.
            d_c = np.einsum("jbr,j->br", d_o[:, :, :channels], phi)
            others = np.flatnonzero(np.arange(order) != i)
            d_right = np.zeros((BLOCKS, channels), dtype=complex)
            for m in others:
                d_m = (d_down - d_up) @ (inverse.T @ left[m])
                d_m += np.einsum("jbr,r,j->b", d_o[:, :, :-channels],
                                 rest @ phi, normal @ left[m], optimize=True)
                d_right += np.outer(d_m / (values[i] - values[m]),
                                    o[:channels] @ right[:, m])
            shape_sigma = np.sqrt(np.sum(np.abs(d_c + d_right)**2, axis=0))
            frequency = abs(poles[i]) / (2 * np.pi)
            sigma = np.sqrt(np.sum((d_pole * poles[i].conj()).real**2)) / (
                abs(poles[i]) * 2 * np.pi)
            if order == MAX_ORDER and sigma < 0.002 * frequency:
                certain.append((frequency, sigma, shape_sigma.max()))
    seconds = time.process_time() - began
    print("NumPy: %.1f s CPU;" % seconds,
          ", ".join("%.3f (%.1e)" % mode[:2] for mode in sorted(certain)))


if __name__ == "__main__":
    main()
