"""Board of discovery: known equations, records with noise, and what is found.

    discovery_board.py PINODE_DISCOVER [--draws=20] [--noise=1,5,10]
        [--systems=duffing,van_der_pol,cubic_damping,coulomb,chain] [--first=0]

Each draw is a case of its own: displacements and velocities of every DOF with
white noise of so many per cent of each signal's RMS, all monomials to degree 3
of the states as candidates (9 for one DOF, 68 for the chain), no known matrix
but the mass; for dry friction also the sign of the velocity. A line per system and noise says

- exact: draws with the true terms and no others,
- missed, false: true terms that were not found, and terms that are not true,
- certain false: draws that call a false term certain: the verdict is good, or
  the term's probability at least 95 %,
- with care: exact draws, and others, with this verdict,
- good: draws that miss a term or have a false one, and are called good,
- worst: median over exact draws of the largest relative error of a coefficient,
- holds: intervals of the exact draws that hold the true coefficient,
- seconds: median and largest time of a run.

The last lines compare the probabilities of the chosen terms with how many of
them are true.
"""

import argparse
import json
import pathlib
import subprocess
import tempfile
import time

import numpy as np
from scipy.integrate import solve_ivp

# Equation of each DOF: coefficient of each monomial of the states.
SYSTEMS = {
    "duffing": {
        "start": ([1.5], [0.0]), "step": 0.05, "samples": 800,
        "equations": [{"x[u1]": -1.0, "v[u1]": -0.08, "x[u1]^3": -0.8}]},
    "van_der_pol": {
        "start": ([2.0], [0.0]), "step": 0.05, "samples": 800,
        "equations": [{"x[u1]": -1.0, "v[u1]": 0.7, "x[u1]^2*v[u1]": -0.7}]},
    "cubic_damping": {
        "start": ([1.5], [0.0]), "step": 0.05, "samples": 800,
        "equations": [{"x[u1]": -1.0, "v[u1]^3": -0.15}]},
    # A mass that slides on a dry surface and does not come to rest: the friction
    # turns over where the velocity changes its sign.
    "coulomb": {
        "start": ([1.5], [0.0]), "step": 0.05, "samples": 500, "turns": True,
        "signs": ["v[u1]"],
        "equations": [{"x[u1]": -1.0, "v[u1]": -0.04, "sign(v[u1])": -0.05}]},
    # Two masses, each on a spring and a dashpot, with a cubic spring between.
    "chain": {
        "start": ([1.2, -0.8], [0.0, 0.0]), "step": 0.05, "samples": 800,
        "equations": [
            {"x[u1]": -1.0, "v[u1]": -0.05, "x[u1]^3": -0.5,
             "x[u1]^2*x[u2]": 1.5, "x[u1]*x[u2]^2": -1.5, "x[u2]^3": 0.5},
            {"x[u2]": -2.0, "v[u2]": -0.05, "x[u1]^3": 0.5,
             "x[u1]^2*x[u2]": -1.5, "x[u1]*x[u2]^2": 1.5, "x[u2]^3": -0.5}]},
}


def right_hand_side(system):
    """Returns the accelerations as a function of displacements and velocities."""
    compiled = []
    for equation in system["equations"]:
        text = " + ".join(f"({value}) * {basis}" for basis, value in equation.items())
        for dof in range(len(system["equations"])):
            text = text.replace(f"x[u{dof + 1}]", f"x[{dof}]")
            text = text.replace(f"v[u{dof + 1}]", f"v[{dof}]")
        compiled.append(compile(text.replace("^", "**"), "equation", "eval"))

    def rate(_, state, direction=1.0):
        n = len(compiled)
        names = {"x": state[:n], "v": state[n:], "sign": lambda _: direction}
        return [*state[n:], *(eval(code, {}, names) for code in compiled)]

    return rate


def motion(system, times):
    """Returns the states at the times, a row per state."""
    rate = right_hand_side(system)
    start = np.concatenate(system["start"])
    tight = {"rtol": 1e-10, "atol": 1e-12}
    if not system.get("turns"):
        return solve_ivp(rate, [0.0, times[-1]], start, t_eval=times, **tight).y
    # A half cycle at a time, in which the friction has one sign.
    def turn(_, state, direction):
        return direction * state[1]

    turn.terminal, turn.direction = True, -1.0
    states, begin, direction = np.empty((2, times.size)), 0.0, -np.sign(start[0])
    while begin < times[-1]:
        piece = solve_ivp(rate, [begin, times[-1]], start, args=(direction,),
                          events=turn, dense_output=True, **tight)
        end = piece.t[-1]
        inside = (times >= begin) & (times <= end)
        states[:, inside] = piece.sol(times[inside])
        begin, start, direction = end, np.array([piece.y[0, -1], 0.0]), -direction
    return states


def write_case(folder, name, noise, draw):
    """Writes case.toml and record.csv of one draw."""
    system = SYSTEMS[name]
    n = len(system["equations"])
    times = system["step"] * np.arange(system["samples"])
    states = motion(system, times)
    random = np.random.default_rng([sorted(SYSTEMS).index(name), round(10 * noise), draw])
    spread = np.sqrt(np.mean(states**2, axis=1, keepdims=True))
    measured = states + noise / 100.0 * spread * random.standard_normal(states.shape)
    columns = [f"{q}{dof + 1}" for q in "xv" for dof in range(n)]
    np.savetxt(folder / "record.csv", np.column_stack([times, measured.T]),
               delimiter=",", header="t," + ",".join(columns), comments="")
    dofs = [f"u{dof + 1}" for dof in range(n)]
    zero = [[0.0] * n for _ in range(n)]
    channels = "".join(
        f"  [[record.channel]]\n  column = \"{q}{dof + 1}\"\n  quantity = \"{quantity}\"\n"
        f"  dof = \"u{dof + 1}\"\n  unit = \"{unit}\"\n"
        for q, quantity, unit in (("x", "displacement", "m"), ("v", "velocity", "m/s"))
        for dof in range(n))
    signs = json.dumps(system.get("signs", []))
    inputs = [f"{q}[{dof}]" for q in "xv" for dof in dofs]
    (folder / "case.toml").write_text(
        f"""[model]
dofs = {json.dumps(dofs)}
mass = {{diagonal = {[1.0] * n}}}
stiffness = {zero}
damping = {zero}
[[network]]
name = "rest"
inputs = {json.dumps(inputs)}
outputs = {json.dumps(dofs)}
[discover]
source = "derivatives"
polynomial_degree = 3
sign = {signs}
[[record]]
name = "free"
file = "record.csv"
time = "t"
{channels}""")


def run(program, name, noise, draw):
    """Returns what one draw's discovery found."""
    system = SYSTEMS[name]
    with tempfile.TemporaryDirectory() as place:
        folder = pathlib.Path(place)
        write_case(folder, name, noise, draw)
        begin = time.monotonic()
        done = subprocess.run(
            [program, f"--case={folder / 'case.toml'}", f"--output_dir={folder / 'found'}",
             "--threads=1"],
            stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, text=True, check=False)
        seconds = time.monotonic() - begin
        path = folder / "found" / "discover.json"
        if not path.is_file():
            raise SystemExit(f"{name}, {noise:g} %, draw {draw}: no result: {done.stderr}")
        result = json.loads(path.read_text())
    found, errors, held, intervals = {}, [], 0, 0
    for equation in result["equations"]:
        dof = int(equation["output"][1:]) - 1
        for term in equation["terms"]:
            found[dof, term["basis"]] = term
    truth = {(dof, basis): value for dof, equation in enumerate(system["equations"])
             for basis, value in equation.items()}
    for key in truth.keys() & found.keys():
        term = found[key]
        errors.append(abs(term["coefficient"] / truth[key] - 1.0))
        if term.get("lower95") is not None:
            intervals += 1
            held += term["lower95"] <= truth[key] <= term["upper95"]
    false = found.keys() - truth.keys()
    return {"missed": sorted(truth.keys() - found.keys()), "false": sorted(false),
            "certain": bool(false) and (
                result.get("verdict") == "good"
                or any((found[key].get("probability") or 0.0) >= 0.95 for key in false)),
            "care": result.get("verdict") == "with_care",
            "good": result.get("verdict") == "good",
            "terms": [(term.get("probability"), key in truth)
                      for key, term in found.items()],
            "worst": max(errors, default=np.nan), "held": held, "intervals": intervals,
            "seconds": seconds}


def print_calibration(terms):
    """Prints probability said and fraction true of terms by class of probability."""
    classes = [0.0, 0.2, 0.5, 0.8, 0.95, 0.99, 0.999]
    for low, high in zip(classes, [*classes[1:], np.inf]):
        inside = [(p, true) for p, true in terms if p is not None and low <= p < high]
        if inside:
            said, true = np.mean(np.array(inside, dtype=float), axis=0)
            print(f"probability from {low:g}: {len(inside)} terms, mean {100 * said:.2f} %,"
                  f" true {100 * true:.2f} %", flush=True)


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n", maxsplit=1)[0])
    parser.add_argument("program")
    parser.add_argument("--draws", type=int, default=20)
    parser.add_argument("--first", type=int, default=0)
    parser.add_argument("--noise", default="1,5,10")
    parser.add_argument("--systems", default=",".join(SYSTEMS))
    parser.add_argument("--verbose", action="store_true")
    options = parser.parse_args()
    print("system, noise %: exact; missed, false terms; certain false; with care: exact,"
          " others; good: others; worst, % ; holds; seconds, median and largest", flush=True)
    terms = []
    for name in options.systems.split(","):
        for noise in map(float, options.noise.split(",")):
            draws = []
            for draw in range(options.first, options.first + options.draws):
                draws.append(run(options.program, name, noise, draw))
                if options.verbose:
                    print("  ", draw, draws[-1], flush=True)
            terms += [term for d in draws for term in d["terms"]]
            exact = [d for d in draws if not d["missed"] and not d["false"]]
            seconds = [d["seconds"] for d in draws]
            worst = 100.0 * np.median([d["worst"] for d in exact]) if exact else np.nan
            print(f"{name}, {noise:g}: {len(exact)} of {len(draws)}; "
                  f"{sum(len(d['missed']) for d in draws)}, "
                  f"{sum(len(d['false']) for d in draws)}; "
                  f"{sum(d['certain'] for d in draws)}; "
                  f"{sum(d['care'] for d in exact)}, "
                  f"{sum(d['care'] for d in draws) - sum(d['care'] for d in exact)}; "
                  f"{sum(d['good'] for d in draws) - sum(d['good'] for d in exact)}; {worst:.2g}; "
                  f"{sum(d['held'] for d in exact)} of {sum(d['intervals'] for d in exact)}; "
                  f"{np.median(seconds):.1f}, {max(seconds):.1f}", flush=True)
    print_calibration(terms)


if __name__ == "__main__":
    main()
