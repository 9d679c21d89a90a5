"""Figures show what the results have."""

import copy
import json
import os
import pathlib
import pickle
import types

import frame_testing
import numpy as np
import pytest
import scipy.linalg
import study_test

import pinode
from pinode import _histories, figures

pytest.importorskip("matplotlib")

DATA = pathlib.Path(os.environ["PINODE_SOURCE_DIR"]) / "data"


@pytest.fixture(scope="module")
def damage(damaged, baseline):
    return damaged.damage([baseline])


@pytest.fixture(scope="module")
def network():
    return study_test.oscillator(
        networks=[pinode.Network("nn", ["x[u1]", "v[u1]"], ["u1"], layers=[8])],
        options={"max_iterations": 60}).identify()


@pytest.fixture(scope="module")
def with_holdout():
    return pinode.read_case(DATA / "three_storey" / "three_storey.toml").identify()


def curve(ax, name):
    (line,) = [line for line in ax.get_lines() if line.get_label() == name]
    return line.get_xdata(), line.get_ydata()


def ticks(ax):
    return [text.get_text() for text in ax.get_yticklabels()]


def test_which_there_are(baseline, damage):
    common = {"parameters", "modes", "mode_shapes", "convergence"}
    assert set(baseline.figures()) == common | {"prediction_healthy"}
    assert set(damage.figures()) == common | {"changes", "prediction_now"}


def test_they_are_matplotlibs_with_a_picture_of_their_own(baseline):
    import matplotlib.figure

    figure = baseline.figures()["modes"]
    assert isinstance(figure, matplotlib.figure.Figure)
    for shown in (figure, pickle.loads(pickle.dumps(figure)), copy.deepcopy(figure)):
        picture = shown._repr_png_()
        assert picture.startswith(b"\x89PNG")
        # Tight around what is drawn, at the figure's own resolution.
        width = int.from_bytes(picture[16:20], "big")
        assert width == pytest.approx(figure.get_figwidth() * figure.dpi, rel=0.05)
    assert len(baseline.figures()["modes"].axes) == 1
    figure.clear()
    assert figure._repr_png_() is None


def test_histories(with_holdout):
    drawn = with_holdout.figures()
    names = [name for name in drawn if name.startswith("prediction")]
    assert names == ["prediction_holdout", "prediction_train"]  # the test comes first
    record = with_holdout.record("train")
    score = with_holdout.records["train"]
    whole, part, rest = drawn["prediction_train"].axes[:3]
    assert whole.get_ylabel() == "a1 (m/s^2)" and part.get_xlabel() == "time (s)"
    for name, values in (("measured", record.measured), ("model", record.predicted)):
        assert np.array_equal(curve(whole, name)[1], values["a1"])
    # Of all that was measured the strongest part, six periods of the first mode.
    time, values = curve(part, "measured")
    assert time[-1] - time[0] == pytest.approx(
        6.0 / with_holdout.modes[0]["updated_hz"], abs=0.1)
    assert np.abs(values).max() == np.abs(record.measured["a1"]).max()
    # The initial model, as the scores have its error.
    assert np.array_equal(curve(whole, "initial model")[1], with_holdout.before("train")["a1"])
    before = curve(whole, "initial model")[1]
    left = record.measured["a1"] - before
    assert left.std() / record.measured["a1"].std() == pytest.approx(
        score["channels"][0]["prior_nrmse"], rel=1e-3)
    band = whole.collections[0].get_paths()[0].vertices
    half = 1.96 * record.deviation["a1"]
    assert band[:, 1].max() == pytest.approx((record.predicted["a1"] + half).max())
    residual, *sides = rest.get_lines()
    assert np.array_equal(residual.get_ydata(), record.measured["a1"] - record.predicted["a1"])
    assert [line.get_ydata()[0] for line in sides] == pytest.approx(
        [-2 * score["channels"][0]["sigma"], 2 * score["channels"][0]["sigma"]])


def test_the_worst_channels_of_many(with_holdout):
    scores = with_holdout.records["train"]["channels"]
    worst = max(scores, key=lambda score: score["nrmse"])["name"]
    figure = figures.prediction(with_holdout, "train", most=1)
    assert len(figure.axes) == 3 and figure.axes[0].get_ylabel().startswith(worst)


def nrmse(measured, predicted):
    return np.linalg.norm(measured - predicted) / np.linalg.norm(measured - measured.mean())


def test_the_run_before_of_a_free_start(healthy):
    """Begins where the initial model fits best, as the run has that the scores compare
    with."""
    ground, floors = frame_testing.measure()
    step = frame_testing.STEP
    # In the middle of the motion: at rest nothing would be found.
    free = pinode.Record(
        "healthy", step=step, ground={"x": ground[500:]}, interpolation="cubic",
        start="free", channels=pinode.channels("a", floors[500:], "absolute_acceleration"))
    fit = healthy.replace(records=[free]).identify()
    before = fit.before()
    assert set(before) == {"a1", "a2", "a3"}
    record = fit.record()
    for channel in fit.records["healthy"]["channels"]:
        name = channel["name"]
        assert nrmse(record.measured[name], before[name]) == pytest.approx(
            channel["prior_nrmse"], rel=1e-9)
        from_rest = fit.case.simulate(noise_percent=0.0)["healthy"]["channels"][name]
        assert nrmse(record.measured[name], from_rest) > channel["prior_nrmse"]
    assert np.array_equal(
        curve(figures.prediction(fit).axes[0], "initial model")[1], before["a1"])
    with pytest.raises(pinode.Error, match="no record 'other'"):
        fit.before("other")


def test_no_run_before_that_does_not_stay_finite(with_holdout, monkeypatch):
    monkeypatch.setitem(with_holdout.__dict__, "_before", {"train": {}, "holdout": {}})
    labels = [line.get_label() for line in figures.prediction(with_holdout).axes[0].get_lines()]
    assert "model" in labels and "initial model" not in labels


def test_parameters_in_per_cent(with_holdout):
    (ax,) = figures.parameters(with_holdout).axes
    free = [p for p in with_holdout.parameters.values() if p.free and p.name != "spring1.k3"]
    assert ticks(ax) == [p.name for p in free]
    assert [bar.get_width() for bar in ax.patches] == pytest.approx(
        [100 * (p.value - p.initial) for p in free])
    ends = ax.collections[0].get_segments()[0][:, 0]
    assert ends == pytest.approx([100 * free[0].lower95, 100 * free[0].upper95])
    assert "spring1.k3" in ax.get_title(loc="left")
    element = study_test.oscillator(elements=[pinode.Element(
        "spring", "cubic", ("ground", "u1"), {"k3": pinode.Unknown(2000.0)})]).identify()
    (ax,) = figures.parameters(element).axes
    assert ax.patches[0].get_width() == pytest.approx(100 * (element["spring.k3"] / 2000 - 1))


def test_changes_with_their_threshold(damage, monkeypatch):
    (ax,) = figures.changes(damage).axes
    assert ticks(ax) == ["k1", "k2", "k3"] and ax.get_xlabel() == "change (%)"
    assert [bar.get_width() for bar in ax.patches] == pytest.approx(
        [100 * g["change"] for g in damage.groups.values()])
    assert -5.0 in [line.get_xdata()[0] for line in ax.get_lines()]
    red, grey = ax.patches[0].get_facecolor(), ax.patches[1].get_facecolor()
    assert red[0] > 2 * red[2] and grey[0] == grey[2]
    found = json.loads(json.dumps(damage.damage_json))
    found["masses"] = [{"place": "u2", "change": 0.1, "lower95": 0.05, "upper95": 0.15,
                        "reason": "formal"}]
    found["nonlinearity"]["terms"] = [{"name": "k3.hardening", "share": 0.2, "lower95": 0.1,
                                       "upper95": 0.3}]
    found["groups"][1].update(lower95=None)
    found["groups"][2].update(lower95=-30.0, upper95=30.0)  # says nothing
    monkeypatch.setattr(damage, "_found", found)
    (ax,) = figures.changes(damage).axes
    assert ticks(ax) == ["k1", "mass at u2", "k3.hardening"]
    assert ax.patches[2].get_width() == pytest.approx(20.0)


def test_mode_shapes(damage):
    figure = figures.mode_shapes(damage)
    for i, ax in enumerate(figure.axes):
        for stiffness, name in ((frame_testing.STIFFNESS, "initial"), (damage.stiffness, "updated")):
            _, shapes = scipy.linalg.eigh(stiffness, frame_testing.MASS)
            drawn = curve(ax, name)[0]
            assert np.abs(drawn).max() == 1.0
            expected = shapes[:, i] / np.abs(shapes[:, i]).max()
            assert np.allclose(drawn, expected * np.sign(expected @ drawn), atol=1e-6)
        assert curve(ax, "initial")[0] @ curve(ax, "updated")[0] > 0.0
        assert ticks(ax) == ["u1", "u2", "u3"]
        assert ax.get_title().startswith(f"mode {i + 1}: {damage.modes[i]['initial_hz']:.4g}")
    assert len(figures.mode_shapes(damage, most=2).axes) == 2


def test_mode_shapes_in_milliseconds():
    """Frequencies of matrices are per unit of the model's time."""
    case = pinode.Case(
        pinode.Model(frame_testing.MASS, 1e-6 * frame_testing.STIFFNESS,
                     1e-3 * frame_testing.DAMPING),
        groups=[pinode.Group("k1", 1e-6 * frame_testing.STOREYS[0])],
        units={"time": "ms", "force": "kN", "length": "mm"},
        modes=[pinode.Mode(2.7), pinode.Mode(7.6)])
    fit = case.identify()
    assert len(figures.mode_shapes(fit).axes) == 3


def test_convergence(baseline):
    cost, error = figures.convergence(baseline).axes
    taken = baseline.history["accepted"]
    assert taken.any()
    assert np.array_equal(cost.get_lines()[0].get_ydata(), baseline.history["cost"][taken])
    assert error.get_lines()[0].get_ydata() == pytest.approx(
        [100 * s["free_run_error"] for s in baseline.json["solver"]["stages"]])
    staged = types.SimpleNamespace(
        history={"cost": np.array([9.0, 1e82, np.nan, 2.0, 1.0]),
                 "accepted": np.array([True, False, False, True, True]),
                 "stage": np.array([1, 1, 1, 2, 2])},
        json={"solver": {"stages": [
            {"segment_samples": 20, "free_run_error": 0.5},
            {"segment_samples": 0, "free_run_error": 0.1}]}})
    cost, error = figures.convergence(staged).axes
    assert list(cost.get_lines()[0].get_ydata()) == [9.0, 2.0, 1.0]
    # Of a step that was not taken the cost may be any number, or none.
    assert np.array_equal(cost.get_lines()[1].get_ydata(), [90.0, np.nan], equal_nan=True)
    assert cost.get_lines()[2].get_xdata() == [2.5, 2.5]
    assert [text.get_text() for text in cost.texts] == ["20"]
    assert list(error.get_lines()[0].get_xdata()) == [2.5, 4.5]


def test_loops_over_the_rate_too(network):
    (loop,) = network.loops
    over_deformation, over_rate = figures.loops(network).axes
    assert np.array_equal(over_rate.get_lines()[0].get_xdata(), loop["rate"])
    assert over_rate.get_xlabel() == "v[u1] (m/s)"
    assert over_deformation.get_ylabel() == "acceleration (m/s^2)"
    spring = {**loop, "type": "cubic"}
    assert len(figures.loops(types.SimpleNamespace(loops=[spring])).axes) == 1
    long = {key: np.tile(v, 10) if key in ("deformation", "rate", "force") else v
            for key, v in loop.items()}
    long["deformation"][4321] *= 100.0
    drawn = figures.loops(types.SimpleNamespace(loops=[long])).axes[0].get_lines()[0]
    assert len(drawn.get_xdata()) == 2000
    assert np.abs(drawn.get_xdata()).max() == np.abs(long["deformation"]).max()


def test_equations_circle_what_was_chosen(network):
    found = network.discover()
    (ax,) = figures.equations(found).axes
    (equation,) = found.equations
    curve, circle = ax.get_lines()
    assert list(curve.get_xdata()) == [p["terms"] for p in equation["pareto"]]
    assert list(circle.get_xdata()) == [1] and "acceleration" in ax.get_ylabel()
    axes = figures.equation_features(found).axes
    assert len(axes) == len(found.samples) >= 1
    regressed, terms = axes[0].get_lines()
    assert np.array_equal(terms.get_xdata(), found.samples[0]["at"])
    spread = np.std(regressed.get_ydata() - terms.get_ydata())
    assert spread < 0.2 * np.std(terms.get_ydata())
    assert {"equations", "equation_features"} <= set(found.figures())


def test_forces_and_where_they_are_largest():
    case = pinode.read_case(DATA / "three_storey_force" / "impact.toml")
    fit = case.identify()
    force = fit.forces["blow"]
    assert force["record"] == "impact" and force["unit"] == "N"
    whole, part = figures.forces(fit).axes
    assert np.array_equal(curve(whole, "identified")[1], force["force"])
    assert whole.get_ylabel() == "blow (N)" and "impact" in whole.get_title(loc="left")
    time, values = curve(part, "identified")
    assert values.max() == force["force"].max() and time[-1] - time[0] < 0.2
    assert whole.collections and part.collections
    # Beside it what really acted: of a short part its samples as dots.
    columns = np.genfromtxt(DATA / "three_storey_force" / "impact.csv", delimiter=",", names=True)
    assert np.array_equal(force["truth"]["force"], columns["F"])
    assert np.allclose(curve(whole, "truth"), (columns["t"], columns["F"]), atol=1e-12)
    (dots,) = [line for line in part.get_lines() if line.get_label() == "truth"]
    inside = (columns["t"] >= time[0]) & (columns["t"] <= time[-1])
    assert dots.get_marker() == "o" and np.array_equal(dots.get_ydata(), columns["F"][inside])
    tree = case.to_dict()
    del tree["unknown_force"][0]["truth"]
    unknown = types.SimpleNamespace(
        forces={"blow": {k: v for k, v in force.items() if k != "truth"}}, case=fit.case)
    labels = [line.get_label() for line in figures.forces(unknown).axes[0].get_lines()]
    assert labels == ["identified"]
    assert "truth" not in pinode.Case.from_dict(tree, path=case.path).identify(
        callback=lambda state: state["iteration"] < 1).forces["blow"]
    assert _histories._largest_part(np.zeros(100)) == slice(0, 40)
    assert _histories._largest_part(np.ones(800)) == slice(0, 100)


def test_loops_beside_what_is_known():
    fit = pinode.read_case(DATA / "nsd" / "phase2_element.toml").identify()
    (loop,) = [loop for loop in fit.loops if "known" in loop]
    table = fit.case.to_dict()["reference_curve"][0]
    assert loop["known"]["name"] == table["name"]
    (ax,) = [ax for ax in figures.loops(fit).axes if ax.get_legend() is not None]
    known, force = curve(ax, table["name"]), curve(ax, "identified")[1]
    assert np.array_equal(known, (loop["known"]["deformation"], loop["known"]["force"]))
    assert len(ax.get_legend().get_texts()) == 2
    low, high = loop["deformation"].min(), loop["deformation"].max()
    assert ax.get_xlim() == pytest.approx(
        (low - 0.05 * (high - low), high + 0.05 * (high - low)))
    # What was found is the curve, up to a tenth of its range.
    at = np.argsort(known[0])
    expected = np.interp(loop["deformation"], known[0][at], known[1][at])
    assert np.abs(loop["force"] - expected).max() < 0.1 * np.ptp(force)
    assert ax.get_lines()[0].get_label() == table["name"]


def test_profiles_beside_the_parabola(healthy):
    fit = healthy.replace(profiles={"parameters": ["k1"]}).identify()
    (ax,) = figures.profiles(fit).axes
    parabola, curve, points, *levels = ax.get_lines()
    profile, linear = fit.profiles["k1"], fit.parameters["k1"]
    assert np.array_equal(points.get_ydata(), profile["likelihood_ratios"])
    assert np.interp(linear.upper95, *parabola.get_data()) == pytest.approx(
        profile["threshold95"], rel=0.01)
    best = fit.json["profiles"][0]["value"]
    assert np.interp(0.5 * (best + linear.upper95), *parabola.get_data()) == pytest.approx(
        0.25 * profile["threshold95"], rel=0.02)
    assert np.interp(profile["values"], *curve.get_data()) == pytest.approx(
        profile["likelihood_ratios"], abs=1e-9)
    low, high = (line.get_ydata()[0] for line in levels)
    assert low == profile["threshold95"] and high / low == pytest.approx(6.6349 / 3.8415, rel=1e-4)
    # Where the ratio comes to the threshold of 99 % its interval ends.
    about = fit.json["profiles"][0]
    assert np.interp(about["upper99"], *curve.get_data()) == pytest.approx(high, rel=0.02)


def ambient_score(name):
    return {"name": name, "channels": ["a1", "a2"], "frequencies_hz": np.array([1.0, 2.0]),
            "lines": np.array([100.0, 1.0]),
            "measured": np.array([[1.0, 100.0], [0.0, 1.0]]),
            "modelled": np.array([[10.0, 10.0], [1.0, 1.0]])}


def test_ambient_densities_are_in_decibels():
    outcome = types.SimpleNamespace(ambient={n: ambient_score(n) for n in ("wind", "calm")})
    axes = figures.ambient(outcome).axes
    assert [ax.get_title(loc="left") for ax in axes] == [
        "wind, a1", "wind, a2", "calm, a1", "calm, a2"]
    assert list(curve(axes[0], "measured")[1]) == [0.0, 20.0]
    assert np.isnan(axes[1].get_lines()[0].get_ydata()[0])
    assert axes[0].get_ylabel() == "density (dB)"
    assert len(figures.ambient(outcome, most=1).axes) == 2
    # The mean of a hundred squares is within 20 %.
    (path,) = axes[0].collections[0].get_paths()
    assert path.vertices[:, 1].max() == pytest.approx(10.0 + 10.0 * np.log10(1.0 + 1.96))
    at_first = path.vertices[path.vertices[:, 0] == 1.0][:, 1]
    assert at_first.max() == pytest.approx(10.0 + 10.0 * np.log10(1.196))


def test_ambient_densities_are_per_hertz_in_any_unit_of_time():
    folder = DATA / "three_storey_ambient"
    case = pinode.read_case(folder / "three_storey_ambient.toml")
    tree = case.to_dict()
    # N, m and ms: a mass is in N ms^2 / m.
    tree["units"]["time"] = "ms"
    tree["group"] = [group for group in tree["group"] if group["adds_to"] == "stiffness"]
    building = tree["model"]["shear_building"]
    building["masses"] = [1e6 * mass for mass in building["masses"]]
    a0, a1 = tree["model"]["damping"]["rayleigh"]
    tree["model"]["damping"] = {"rayleigh": [1e-3 * a0, 1e3 * a1]}
    # By Welch's method, from the same samples.
    welch = pinode.identify_modes(case).spectra["wind"]
    inside = (welch["frequency_hz"] > 1.0) & (welch["frequency_hz"] < 10.0)
    power = np.trapz(welch["measured"][0][inside], welch["frequency_hz"][inside])
    stop = {"callback": lambda state: state["iteration"] < 1}
    for each in (case, pinode.Case.from_dict(tree, path=case.path)):
        found = each.identify(**stop).ambient["wind"]
        hz = found["frequencies_hz"]
        inside = (hz > 1.0) & (hz < 10.0)
        # In the model's unit of acceleration.
        unit = 1e-6 if each is not case else 1.0
        assert np.trapz(found["measured"][0][inside], hz[inside]) == pytest.approx(
            unit**2 * power, rel=0.1)


def test_identified_modes():
    band = {"record": "wind", "lowest_hz": 0.5, "highest_hz": 20.0, "order": [2, 4, 4],
            "frequency_hz": np.array([2.0, 2.0, 9.0]), "mode": [0, 0, -1],
            "frequency_sigma": np.array([0.1, 0.1, 1.0])}
    mode = {"frequency_hz": 2.0, "frequency_sigma": 0.1, "frequency_upper95": 2.25,
            "shape": np.array([0.5 + 0.1j, 1.0]), "shape_sigma_real": np.array([0.02, 0.0])}

    class Found(list):
        places, methods, diagram = ["u1", "u2"], {"wind": "covariance_driven"}, [band]
        frequencies_hz = np.array([2.0])
        spectra = {"wind": {
            "channels": ["a1", "a2"], "singular_hz": np.array([0.5, 1.5, 2.0]),
            "singular_values": np.array([[1.0, 2.0, 100.0], [1.0, 1.0, 1.0]]),
            "frequency_hz": np.array([1.0, 2.0]), "explained": np.array([0.9, 0.8]),
            "measured": np.array([[1.0, 10.0], [1.0, 1.0]]),
            "modelled": np.array([[1.0, 100.0], [1.0, 1.0]])}}

        def mac(self, other=None):
            return np.ones((len(self), len(other or self)))

    drawn = figures.of_modes(Found([mode]))
    assert set(drawn) == {"stabilisation_wind", "spectra_wind", "fdd_wind", "shapes", "mac"}
    first, second = drawn["spectra_wind"].axes
    assert list(curve(first, "modes")[1]) == [0.0, 20.0]
    assert first.get_title(loc="left") == "a1, 90 % explained"
    ax, behind = drawn["stabilisation_wind"].axes
    assert list(behind.get_lines()[0].get_ydata()) == pytest.approx([10 * np.log10(2), 20.0])
    assert list(curve(ax, "other poles")[0]) == [9.0]
    assert ax.get_xlim() == (1.0, 2.5)
    (ax,) = drawn["shapes"].axes
    assert list(ax.get_lines()[0].get_xdata()) == [0.5, 1.0] and ticks(ax) == ["u1", "u2"]
    # By Student's quantile, 2.5 sigma here.
    assert ax.collections[0].get_segments()[0][:, 0] == pytest.approx([0.45, 0.55])
