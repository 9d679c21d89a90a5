"""What large records take, and who owns the numbers that are handed out."""

import os
import subprocess
import sys

import numpy as np
import pytest

import pinode

CODE = """
import re
import numpy as np
import pinode
def most():  # MB; of getrusage it would be that of the process that began this one, too
    return int(re.search(r"VmHWM:\\s+(\\d+)", open("/proc/self/status").read())[1]) / 1e3
n = 500000
values, ground = np.random.default_rng(1).standard_normal((n, 8)), np.ones(n)
ground[::7] = 0.0
model = pinode.ShearBuilding([1.0] * 8, [1e4] * 8, damping={"ratios": [0.02]})
before = most()
case = pinode.Case(model, groups=[pinode.Group("k1", storey=1)], records=[pinode.Record(
    "r", step=0.01, ground={"x": ground}, interpolation="linear", start="rest",
    channels=pinode.channels("a", values, "absolute_acceleration"))])
made = most()
seen = case.measured("r")
assert np.array_equal(seen["a3"], values[:, 2])
print((made - before) / (values.nbytes / 1e6), (most() - made) / (values.nbytes / 1e6))
"""


@pytest.mark.skipif(not os.path.exists("/proc/self/status"), reason="Linux says it")
def test_samples_are_there_twice_and_no_more():
    """As the case has them, to be saved and pickled, and as they are fitted; of the rest
    there is one column at a time, and where each sample is."""
    done = subprocess.run([sys.executable, "-c", CODE], check=True, capture_output=True, text=True)
    made, measured = map(float, done.stdout.split())
    print(f"a case takes {made:.2f} times its samples, measured() {measured:.2f} more")
    assert made < 3.7 and measured < 0.3


def test_what_is_handed_out_cannot_be_written_to():
    wave = np.sin(0.1 * np.arange(200.0))
    case = pinode.Case(
        pinode.ShearBuilding([1.0, 1.0], [100.0, 100.0], damping={"ratios": [0.02]}),
        groups=[pinode.Group("k1", storey=1)],
        records=[pinode.Record("r", step=0.01, ground={"x": wave}, interpolation="linear",
                               channels=[pinode.Channel("a", wave, dof="u1"),
                                         pinode.Channel("b", wave, dof="u2", unit="mm/s^2")])])
    for seen in (case.measured("r"), case.identify(callback=lambda s: False).record("r").measured):
        for name in ("a", "b"):
            assert not seen[name].flags.writeable and np.allclose(seen[name], wave, rtol=1e-14)
            with pytest.raises(ValueError):
                seen[name][0] = 1.0
    # The library's own lives as long as what looks at it.
    samples = case.measured("r")["a"]
    del case
    assert np.array_equal(samples, wave)
