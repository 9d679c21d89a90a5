"""Damage, equations, unknown forces, measured modes."""

import json
import pickle

import conftest
import frame_testing
import numpy as np
import pytest
import scipy.linalg
import scipy.signal

import pinode


def test_damage_from_fits_folders_and_pickles(baseline, damaged, tmp_path):
    damage = damaged.damage([pickle.loads(pickle.dumps(baseline))])
    assert damage.verdict == "damage" and "k1" in damage.sentence
    baseline.save(tmp_path / "healthy")
    again = damaged.damage(tmp_path / "healthy")
    assert again.groups["k1"]["change"] == pytest.approx(damage.groups["k1"]["change"],
                                                         abs=1e-6)
    fit = damaged.identify()
    assert fit.damage(pinode.read_result(tmp_path / "healthy")).verdict == "damage"
    other = pickle.loads(pickle.dumps(damage))
    assert other.sentence == damage.sentence and other.groups == damage.groups
    assert "changes" in damage.figures()
    assert "k1" in damage._repr_html_()


def test_damage_with_a_folder_that_goes_on(damaged, baseline, tmp_path):
    stopped = damaged.damage(
        [baseline], output=tmp_path / "out", callback=lambda state: state["iteration"] < 1)
    assert stopped.termination == "interrupted"
    assert stopped.verdict == "cannot_tell"
    assert not (tmp_path / "out/damage.json").exists()
    with pytest.raises(pinode.Error, match="exists"):
        damaged.damage([baseline], output=tmp_path / "out")
    damage = damaged.damage([baseline], output=tmp_path / "out", resume=True)
    assert damage.verdict == "damage"
    written = json.loads((tmp_path / "out/damage.json").read_text())
    assert written == damage.damage_json
    assert (tmp_path / "out/report.html").exists()


def test_no_damage_where_there_is_none(healthy, baseline):
    now = healthy.replace(records=[conftest.record("now", seed=5)])
    assert now.damage([baseline]).verdict == "no_damage"


def test_baselines_that_are_none_are_refused(damaged, healthy):
    with pytest.raises(pinode.Error, match="no baseline"):
        damaged.damage([])
    with pytest.raises(pinode.Error, match="value of type int"):
        damaged.damage([3])
    stopped = healthy.identify(callback=lambda state: False)
    with pytest.raises(pinode.Error):
        damaged.damage([stopped])
    with pytest.raises(pinode.Error, match="threshold"):
        damaged.damage([stopped], threshold=-1.0)


def free_vibration(cubic, seconds=6.0, step=0.01):
    """x, v of m x'' + c x' + k x + cubic x^3 = 0 by Runge-Kutta of fine steps."""
    def rate(s):
        return np.array([s[1], -(100.0 * s[0] + 0.5 * s[1] + cubic * s[0] ** 3)])

    fine = 10
    h, state, rows = step / fine, np.array([0.1, 0.0]), []
    for i in range(int(seconds / step) * fine):
        if i % fine == 0:
            rows.append(state)
        k1 = rate(state)
        k2 = rate(state + h / 2 * k1)
        k3 = rate(state + h / 2 * k2)
        k4 = rate(state + h * k3)
        state = state + h / 6 * (k1 + 2 * k2 + 2 * k3 + k4)
    return np.array(rows)


def oscillator(**parts):
    states = free_vibration(3000.0)
    noise = np.random.default_rng(3).standard_normal(states.shape)
    return pinode.Case(
        pinode.Model([[1.0]], [[100.0]], [[0.5]]),
        records=[pinode.Record(
            "free", step=0.01, start={"x": [0.1], "v": [0.0]},
            channels=[
                pinode.Channel("x", states[:, 0] + 1e-4 * noise[:, 0], "displacement",
                               dof="u1"),
                pinode.Channel("v", states[:, 1] + 1e-3 * noise[:, 1], "velocity",
                               dof="u1")])],
        **parts)


def test_library_expressions_and_elements_find_a_spring():
    library = oscillator(libraries=[pinode.Library(
        "nl", ["x[u1]"], "u1", ["x[u1]^3"], acts_as="force")]).identify()
    element = oscillator(elements=[pinode.Element(
        "spring", "cubic", ("ground", "u1"), {"k3": pinode.Unknown(0.0)})]).identify()
    assert element["spring.k3"] == pytest.approx(3000.0, rel=0.01)
    assert abs(library["nl.x[u1]^3"]) == pytest.approx(3000.0, rel=0.01)
    assert "loops" in element.figures()


def test_networks_become_equations():
    case = oscillator(
        networks=[pinode.Network("nn", ["x[u1]", "v[u1]"], ["u1"], layers=[8])],
        options={"max_iterations": 60})
    fit = case.identify()
    found = fit.discover()
    terms = found.terms["u1"]
    assert terms["x[u1]^3"] == pytest.approx(-3000.0, rel=0.05)
    assert "x[u1]^3" in str(found)
    other = pickle.loads(pickle.dumps(found))
    assert other.terms == found.terms


def test_discovery_with_a_folder_that_goes_on(tmp_path):
    fit = oscillator(
        networks=[pinode.Network("nn", ["x[u1]", "v[u1]"], ["u1"], layers=[8])],
        options={"max_iterations": 60}).identify()
    stopped = fit.discover(output=tmp_path / "out", callback=lambda state: False)
    assert stopped.termination == "interrupted"
    assert (tmp_path / "out/checkpoint.json").exists()
    with pytest.raises(pinode.Error, match="exists"):
        fit.discover(output=tmp_path / "out")
    found = fit.discover(output=tmp_path / "out", resume=True, mat=True)
    assert found.termination == "converged"
    assert found.terms["u1"]["x[u1]^3"] == pytest.approx(-3000.0, rel=0.05)
    assert json.loads((tmp_path / "out/discover.json").read_text()) == found.discovery_json
    for name in ("report.html", "result.json", "equations.txt", "results.mat"):
        assert (tmp_path / "out" / name).exists()
    # Another discovery's checkpoint is not gone on from.
    fit.discover(output=tmp_path / "other", callback=lambda state: False)
    with pytest.raises(pinode.Error, match="checkpoint"):
        oscillator(networks=[pinode.Network("mm", ["x[u1]"], ["u1"], layers=[4])],
                   options={"max_iterations": 20}).identify().discover(
                       output=tmp_path / "other", resume=True)


def test_measured_modes_alone():
    true = frame_testing.STIFFNESS - 0.1 * frame_testing.STOREYS[0]
    values, shapes = scipy.linalg.eigh(true, frame_testing.MASS)
    case = pinode.Case(
        pinode.Model(frame_testing.MASS, frame_testing.STIFFNESS),
        groups=conftest.groups(),
        modes=[pinode.Mode(np.sqrt(value) / (2 * np.pi), shape=shape,
                           dofs=["u1", "u2", "u3"])
               for value, shape in zip(values, shapes.T)])
    fit = case.identify()
    assert fit["k1"] == pytest.approx(-0.1, abs=1e-6)


def test_baselines_are_of_the_same_structure(healthy, damaged, baseline):
    def other(stiffness, groups):
        return pinode.Case(
            pinode.Model(frame_testing.MASS, stiffness, frame_testing.DAMPING),
            groups=groups, records=[conftest.record("now", seed=2)])

    first = frame_testing.STOREYS[0]
    stiffer = [pinode.Group("k1", 1.2 * first), *conftest.groups()[1:]]
    with pytest.raises(pinode.Error, match="matrix of group 'k1' differs"):
        other(frame_testing.STIFFNESS + 0.2 * first, stiffer).damage([baseline])
    # The same groups of another nominal structure: a tenth of k1 is not there.
    with pytest.raises(pinode.Error, match=r"have 0\.1 times group 'k1' more"):
        other(frame_testing.STIFFNESS - 0.1 * first, conftest.groups()).damage([baseline])
    with pytest.raises(pinode.Error, match="the same result"):
        damaged.damage([baseline, baseline])


def test_damage_says_all_that_was_remarked(damaged, baseline, monkeypatch):
    damage = damaged.damage([baseline])
    monkeypatch.setattr(damage, "_found", {**damage.damage_json, "remarks": ["So and so."]})
    assert damage.remarks[-1] == "So and so."
    assert "So and so." in str(damage)


def test_a_roof_sensor_alone_does_not_tell_storeys_apart():
    """Base motion and the roof's response have several answers (F. E. Udwadia,
    D. K. Sharma, SIAM J. Appl. Math. 34 (1978) 104-118); more sensors have one."""
    masses = np.array([3000.0, 3000.0, 3000.0, 2500.0])
    springs = np.array([6e6, 5e6, 4.5e6, 4e6])

    def chain(k):
        return np.diag(k + np.append(k[1:], 0.0)) - np.diag(k[1:], 1) - np.diag(k[1:], -1)

    def measure(seed, samples=2000):
        random = np.random.default_rng(seed)
        damping = 0.4 * np.diag(masses) + 4e-4 * chain(springs)
        inverse = np.diag(1.0 / masses)
        a = np.block([[np.zeros((4, 4)), np.eye(4)],
                      [-inverse @ chain(springs), -inverse @ damping]])
        b = np.concatenate([np.zeros(4), -np.ones(4)])[:, None]
        ground = random.standard_normal(samples)
        # Exact for motion that is linear between samples.
        floors = scipy.signal.lsim((a, b, a[4:], np.zeros((4, 1))), ground,
                                   0.01 * np.arange(samples))[1]
        noise = 0.03 * floors.std(axis=0) * random.standard_normal(floors.shape)
        return ground, floors + noise

    def identify(seed, factors, dofs, prior_sigma=None):
        ground, floors = measure(seed)
        nominal = springs * factors
        return pinode.Case(
            pinode.ShearBuilding(list(masses), list(nominal),
                                 damping={"rayleigh": [0.25, 6e-4]}),
            groups=[*(pinode.Group(f"k{i + 1}", storey=i + 1, prior_sigma=prior_sigma)
                      for i in range(4)),
                    pinode.Group("cm", 0.1 * np.diag(masses), adds_to="damping"),
                    pinode.Group("ck", 1e-4 * chain(nominal), adds_to="damping")],
            records=[pinode.Record(
                "shaken", step=0.01, ground={"x": ground}, interpolation="linear",
                start="rest",
                channels=[pinode.Channel(f"a{i}", floors[:, i - 1], "absolute_acceleration",
                                         dof=f"u{i}") for i in dofs])]).identify()

    for seed, factors in ((1, (1.2, 0.9, 1.2, 0.85)), (2, (0.8, 1.2, 0.85, 1.1))):
        roof = identify(seed, factors, [4])
        assert not roof.usable
        assert "another solution describes the data almost as well: k1" in roof.message
        # Priors that both are within do not tell.
        assert not identify(seed, factors, [4], prior_sigma=0.3).usable
        several = identify(seed, factors, [1, 2, 4])
        assert several.usable
        found = [(1.0 + several[f"k{i + 1}"]) * f for i, f in enumerate(factors)]
        assert found == pytest.approx([1.0] * 4, abs=0.02)
