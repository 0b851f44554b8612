"""Riccati equations by their number of states: ours and SciPy's in turns on one core, on the matrices of `tests/benches/riccati.rs`.

    python python/benchmarks/riccati.py [ROUNDS]

Each time is the median of processor times of this process, so that other loads of the machine count for little. Ours has P to the last
digit, gain, poles, residual and condition; SciPy's has P.
"""

import os
import sys
import time

os.environ |= {"OMP_NUM_THREADS": "1", "OPENBLAS_NUM_THREADS": "1", "MKL_NUM_THREADS": "1"}

import numpy as np
import scipy
from scipy.linalg import solve_continuous_are, solve_discrete_are

import quatrack as q

ROUNDS = int(sys.argv[1]) if len(sys.argv) > 1 else 25
EQUATIONS = {"CARE": (q.care, solve_continuous_are), "DARE": (q.dare, solve_discrete_are)}


def matrix(rows, columns, start):
    """Entries between -1 and 1 without a pattern."""
    return np.sin((start + np.arange(rows * columns, dtype=float)) ** 2).reshape(rows, columns)


def seconds(solve, problem):
    begun = time.process_time()
    solve(*problem)
    return time.process_time() - begun


if hasattr(os, "sched_setaffinity"):
    os.sched_setaffinity(0, {max(os.sched_getaffinity(0))})
print(f"NumPy {np.__version__}, SciPy {scipy.__version__}, one thread, median of {ROUNDS} rounds\n")
print("| pair | states, inputs | equation | quatrack, ms | SciPy, ms | quatrack / SciPy | differ by |\n|---|---|---|---|---|---|---|")


def compared(pair, a, b, equations):
    n, m = b.shape
    problem = a, b, np.eye(n), np.eye(m)
    for name in equations:
        ours, scipys = EQUATIONS[name]
        exact, found = ours(*problem).p, scipys(*problem)
        rounds = np.array([(seconds(ours, problem), seconds(scipys, problem)) for _ in range(ROUNDS)])
        (own, other), ratio = np.median(rounds, axis=0), np.median(rounds[:, 0] / rounds[:, 1])
        apart = np.linalg.norm(found - exact) / np.linalg.norm(exact)
        print(f"| {pair} | {n}, {m} | {name} | {1e3 * own:.3f} | {1e3 * other:.3f} | {ratio:.2f} | {apart:.0e} |")


for n in (4, 6, 9, 20, 30, 40):
    compared("dense", matrix(n, n, 0), matrix(n, -(-n // 4), 5000), EQUATIONS)
# Integrators one after the other, Euler's step of 0.1 s: their costs lie as far apart as any.
for n in (20, 30, 40):
    compared("chain", np.eye(n) + 0.1 * np.eye(n, k=1), 0.1 * np.eye(n)[:, -1:], ["DARE"])
