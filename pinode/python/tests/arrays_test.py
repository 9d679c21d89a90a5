"""Arrays as others have them: masked ones, columns and frames of pandas."""

import numpy as np
import pytest

import pinode

MODEL = pinode.ShearBuilding([1.0, 1.0], [100.0, 100.0], damping={"ratios": [0.02, 0.02]})
STEP, COUNT = 0.01, 400
WAVE = np.sin(0.1 * np.arange(float(COUNT)))


def hidden(values, *places):
    """With a number below the mask that is in nothing else."""
    masked = np.ma.masked_array(np.array(values, dtype=float))
    for place in places:
        masked[place] = 9999.0
        masked[place] = np.ma.masked
    return masked


def case(records=(), **parts):
    return pinode.Case(MODEL, groups=[pinode.Group("k1", storey=1)],
                       **({"records": list(records)} if records else {}), **parts)


def record(channels, **keys):
    return pinode.Record("r", **{"step": STEP, "ground": {"x": WAVE}, "interpolation": "linear",
                                 "channels": channels, **keys})


def test_masked_samples_of_channels_are_missing():
    both = np.column_stack([WAVE, 2.0 * WAVE])
    for channels in (
            pinode.channels("a", hidden(both, (7, 0)), "absolute_acceleration"),
            pinode.channels("a", [hidden(row, 0) if i == 7 else row
                                  for i, row in enumerate(both)], "absolute_acceleration"),
            [pinode.Channel("a1", hidden(WAVE, 7), dof="u1")],
            [pinode.Channel("a1", list(hidden(WAVE, 7)), dof="u1")]):
        seen = case([record(channels)]).measured("r")["a1"]
        assert np.isnan(seen[7]) and np.array_equal(np.delete(seen, 7), np.delete(WAVE, 7))


INPUTS = {
    "ground": lambda hide: {"ground": {"x": hide(WAVE, 7)}},
    "in a unit": lambda hide: {"ground": {"x": {"values": hide(WAVE, 7), "unit": "mm/s^2"}}},
    "force": lambda hide: {"force": {"u2": hide(WAVE, 7)}},
    "motion": lambda hide: {"motion": {"u2": hide(WAVE, 7)}, "ground": None},
    "time": lambda hide: {"time": hide(STEP * np.arange(COUNT), 7), "step": None},
    "start": lambda hide: {"start": {"x": hide([1.0, 2.0], 1), "v": [0.0, 0.0]}},
}


def missing(values, place):
    values = np.array(values, dtype=float)
    values[place] = np.nan
    return values


@pytest.mark.parametrize("name", INPUTS)
def test_masked_samples_of_what_acts_are_missing(name):
    """As NaN is: filled with a remark, or refused."""
    def outcome(hide):
        channels = [pinode.Channel("a", WAVE, "displacement", dof="u1")]
        try:
            made = case([record(channels, **INPUTS[name](hide))])
        except pinode.Error as failure:
            return str(failure)
        return made.records["r"]["remarks"], made.simulate()["r"]["states"].tolist()

    assert outcome(hidden) == outcome(missing)


def test_masked_readings_of_a_covariate_are_missing():
    channels = [pinode.Channel("a", WAVE, "displacement", dof="u1")]
    warm = hidden(np.full(COUNT, 20.0), 7, 8)
    remarks = case([record(channels, covariate={"T": warm})]).records["r"]["remarks"]
    assert any("398 of 400 samples are present" in remark for remark in remarks)


def test_masked_entries_of_shapes_and_matrices():
    for shape in (hidden([0.6, 1.0, 0.2], 2), [0.6, 1.0, np.nan]):
        mode = pinode.Mode(1.0, shape=shape, dofs=["u1", "u2", "u3"])
        assert mode["shape"] == {"u1": 0.6, "u2": 1.0}
    for model in (lambda: pinode.Model(hidden(np.eye(2), (0, 0)), np.eye(2)),
                  lambda: pinode.Model(np.eye(2), np.eye(2), hidden(np.eye(2), (0, 0))),
                  lambda: pinode.Model(np.eye(2), np.eye(2), influence={"x": hidden([1, 1], 1)}),
                  lambda: pinode.ShearBuilding(hidden([1.0, 1.0], 1), [1.0, 1.0])):
        with pytest.raises(pinode.Error, match="finite|nan"):
            pinode.Case(model())
    with pytest.raises(pinode.Error, match="not finite"):
        pinode.opensees.condense(hidden(np.eye(2), (0, 0)), np.eye(2), dofs={1: [0, 1]})
    with pytest.raises(pinode.Error, match="expected numbers or texts|expected a two-dim"):
        pinode.Case(pinode.Model(np.ma.masked_array(np.eye(2) + 1j, mask=np.eye(2)), np.eye(2)))


def test_masked_samples_give_no_modes():
    values = np.column_stack([WAVE, WAVE])
    plain = values.copy()
    plain[50:60, 0] = np.nan
    masked = np.ma.masked_array(values, mask=np.isnan(plain))
    masked.data[50:60, 0] = 9999.0

    def outcome(samples, **keys):
        try:
            return pinode.identify_modes(samples, step=STEP, **keys).frequencies_hz.tolist()
        except pinode.Error as failure:
            return str(failure)

    assert outcome(masked) == outcome(plain)
    assert outcome(values, loads=masked) == outcome(values, loads=plain)
