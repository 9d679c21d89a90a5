"""Cases from arrays and from files."""

import json
import os
import pathlib
import pickle
import subprocess

import conftest
import frame_testing
import numpy as np
import pytest
import scipy.io
import scipy.linalg
import scipy.sparse

import pinode

DATA = pathlib.Path(os.environ["PINODE_SOURCE_DIR"]) / "data"


def test_has_the_matrices_and_modes_of_its_model(healthy):
    assert np.array_equal(healthy.mass, frame_testing.MASS)
    assert np.array_equal(healthy.stiffness, frame_testing.STIFFNESS)
    assert healthy.dofs == ["u1", "u2", "u3"]
    values = scipy.linalg.eigh(frame_testing.STIFFNESS, frame_testing.MASS,
                               eigvals_only=True)
    modes = healthy.natural_modes()
    assert np.allclose(modes["frequencies_hz"], np.sqrt(values) / (2 * np.pi))
    # Each direction's effective masses add up to the mass that moves in it.
    loads = healthy.mass @ np.ones(3)
    assert modes["directions"] == ["x"]
    assert np.allclose(modes["participation"][:, 0], modes["shapes"].T @ loads)
    assert np.allclose(modes["effective_masses"], modes["participation"]**2)
    assert np.allclose(modes["effective_masses"].sum(axis=0), modes["moving_masses"])
    assert np.allclose(modes["moving_masses"], healthy.mass.sum())
    with pytest.raises(ValueError):
        healthy.mass[0, 0] = 1.0  # of the case, which others look at


def test_takes_sparse_matrices_lists_and_other_numbers():
    mass = scipy.sparse.csr_matrix(frame_testing.MASS)
    stiffness = frame_testing.STIFFNESS.astype(np.float32).tolist()
    case = pinode.Case(pinode.Model(mass, stiffness, frame_testing.DAMPING))
    assert np.array_equal(case.mass, frame_testing.MASS)
    assert np.array_equal(case.stiffness, frame_testing.STIFFNESS)
    whole = pinode.Case(pinode.FiniteElementModel(
        mass, scipy.sparse.coo_matrix(frame_testing.STIFFNESS), dofs=["a", "b", "c"]))
    assert whole.dofs == ["a", "b", "c"]
    assert np.allclose(whole.natural_modes()["frequencies_hz"],
                       case.natural_modes()["frequencies_hz"])


class _Compressed:
    """Looks like one of SciPy's, and has whatever it is given."""

    def __init__(self, data, indices, indptr, shape=(3, 3)):
        self.data, self.indices, self.indptr, self.shape = data, indices, indptr, shape

    def tocsc(self):
        return self


def _whole(mass):
    return pinode.Case(pinode.FiniteElementModel(
        mass, scipy.sparse.eye(3), dofs=["a", "b", "c"])).full_matrices()["mass"].toarray()


def test_sparse_matrices_of_any_order_and_index_type():
    """Entries in order are taken as they lie; others are sorted and added up."""
    ordered = scipy.sparse.csc_array(frame_testing.MASS)
    for index in (np.int32, np.int64):
        for values in (ordered.data, ordered.data[::-1][::-1], ordered.data.astype(np.int64)):
            assert np.array_equal(_whole(_Compressed(
                values, ordered.indices.astype(index), ordered.indptr.astype(index))),
                frame_testing.MASS)
        # (0, 0) twice, and rows that descend.
        data, rows, starts = [1.0, 2.0, 0.5, 4.0, 0.5, 5.0], [0, 0, 2, 1, 1, 2], [0, 2, 4, 6]
        twice = _whole(_Compressed(
            np.array(data), np.array(rows, index), np.array(starts, index)))
        assert np.array_equal(twice, [[3.0, 0.0, 0.0], [0.0, 4.0, 0.5], [0.0, 0.5, 5.0]])
    for data, rows, starts in (
            ([1.0], [3], [0, 1, 1, 1]),  # a row that is not there
            ([1.0], [-1], [0, 1, 1, 1]),
            ([1.0], [0], [0, 1, 0, 1]),  # columns that go back
            ([1.0], [0], [0, 2, 2, 2]),  # more entries than there are
            ([1.0], [0], [1, 1, 1, 1]),
            ([1.0], [0], [0, 1])):
        with pytest.raises(pinode.Error, match="not a consistent sparse matrix"):
            _whole(_Compressed(np.array(data), np.array(rows, np.int32),
                               np.array(starts, np.int32)))


@pytest.mark.parametrize("kind", ["bsr", "coo", "csc", "csr", "dia", "dok", "lil"])
def test_every_kind_of_scipys_sparse_matrices(kind):
    """One of them is a dictionary."""
    def sparse(matrix):
        return getattr(scipy.sparse, f"{kind}_matrix")(matrix)

    first = sparse(frame_testing.STOREYS[0])
    for model in (pinode.Model(sparse(frame_testing.MASS), sparse(frame_testing.STIFFNESS),
                               sparse(frame_testing.DAMPING)),
                  pinode.FiniteElementModel(sparse(frame_testing.MASS),
                                            sparse(frame_testing.STIFFNESS),
                                            dofs=["u1", "u2", "u3"])):
        case = pinode.Case(model, groups=[pinode.Group("k1", first)])
        assert np.array_equal(case.stiffness, frame_testing.STIFFNESS)


def test_names_of_dofs_may_be_numbers_or_those_of_files(tmp_path):
    stiffness = scipy.sparse.diags([2.0 * np.ones(90), -np.ones(89), -np.ones(89)], [0, 1, -1])
    model = pinode.FiniteElementModel(scipy.sparse.eye(90), stiffness, dofs=range(90))
    assert pinode.Case(model).dofs[:3] == ["0", "1", "2"]
    np.savetxt(tmp_path / "M.csv", frame_testing.MASS, delimiter=",", header="kg")
    np.savetxt(tmp_path / "K.csv", frame_testing.STIFFNESS, delimiter=",")
    scipy.io.mmwrite(tmp_path / "K.mtx", scipy.sparse.coo_matrix(frame_testing.STIFFNESS))
    for mass, other in (("M.csv", "K.csv"), ("M.csv", "K.mtx"), ("K.mtx", "K.csv")):
        case = pinode.Case(pinode.Model(str(tmp_path / mass), tmp_path / other))
        assert case.dofs == ["u1", "u2", "u3"]
    (tmp_path / "M.mat").write_bytes(b"MATLAB")
    with pytest.raises(pinode.Error, match="number of its rows is unknown, expected dofs"):
        pinode.Model(tmp_path / "M.mat", tmp_path / "K.csv")


def test_matrices_before_a_reduction_are_sparse(healthy):
    """A chain of twenty masses of which a reduction keeps four."""
    springs = np.full(20, 4e6)
    stiffness = scipy.sparse.diags(
        [springs + np.append(springs[1:], 0.0), -springs[1:], -springs[1:]], [0, 1, -1])
    mass = scipy.sparse.diags(np.full(20, 1000.0))
    dofs = [f"u{i + 1}" for i in range(20)]
    first = scipy.sparse.csc_array(([4e6], ([0], [0])), shape=(20, 20))
    case = pinode.Case(
        pinode.FiniteElementModel(mass, stiffness, dofs=dofs, damping={"rayleigh": [0.1, 1e-4]},
                                  reduction={"method": "guyan",
                                             "keep": ["u5", "u10", "u15", "u20"]}),
        groups=[pinode.Group("first", set_export=first),
                pinode.Group("kept", matrix=np.eye(4))])
    full = case.full_matrices()
    assert case.mass.shape == (4, 4) and full["dofs"] == dofs
    for key, expected in (("mass", mass), ("stiffness", stiffness),
                          ("damping", 0.1 * mass + 1e-4 * stiffness)):
        assert scipy.sparse.issparse(full[key]) and full[key].nnz <= 58
        assert np.allclose(full[key].toarray(), expected.toarray())
    assert np.array_equal(full["groups"]["first"].toarray(), first.toarray())
    # Given for the coordinates alone.
    assert full["groups"]["kept"] is None
    with pytest.raises(pinode.Error, match="no finite-element model"):
        healthy.full_matrices()


def test_records_are_the_arrays(healthy):
    ground, floors = frame_testing.measure()
    measured = healthy.measured("healthy")
    assert np.allclose(measured["time"], 0.01 * np.arange(len(ground)))
    for i in range(3):
        assert np.array_equal(measured[f"a{i + 1}"], floors[:, i])
    assert healthy.records["healthy"]["num_samples"] == len(ground)


def test_units_of_arrays_are_converted():
    ground, floors = frame_testing.measure(samples=50)
    record = pinode.Record(
        "r", time=0.01 * np.arange(50), interpolation="held",
        ground={"x": {"values": ground / 9.80665, "unit": "g"}},
        channels=[pinode.Channel("a", 1e3 * floors[:, 0], dof="u1", unit="mm/s^2")])
    case = pinode.Case(conftest.model(), groups=conftest.groups(), records=[record])
    assert case.measured("r")["a"] == pytest.approx(1e3 * floors[:, 0])
    fit = case.identify(callback=lambda state: False)
    assert fit.termination == "interrupted"
    assert fit.record("r").units == {"a": "mm/s^2"}


def test_frames_of_pandas_and_missing_samples():
    pandas = pytest.importorskip("pandas")
    ground, floors = frame_testing.measure(samples=200)
    floors = np.ma.masked_array(floors, mask=np.zeros(floors.shape, dtype=bool))
    floors.mask[3, 0] = True
    frame = pandas.DataFrame({"t": 0.01 * np.arange(200), "ag": ground})
    frame["top"] = floors[:, 0].filled(np.nan)
    case = pinode.Case(conftest.model(), groups=conftest.groups(), records=[
        pinode.Record("r", file=frame, time="t", ground={"x": "ag"},
                      interpolation="linear", start="rest",
                      channels=[pinode.Channel("a1", "top", dof="u1"),
                                pinode.Channel("masked", floors[:, 0], dof="u1")])])
    for channel in ("a1", "masked"):
        values = case.measured("r")[channel]
        assert np.isnan(values[3]) and np.isfinite(np.delete(values, 3)).all()


def test_files_are_cases_too():
    case = pinode.read_case(DATA / "three_storey" / "three_storey.toml")
    assert case.title == "Three-storey frame"
    assert set(case.parameters) >= {"k1", "k2", "k3", "spring1.k3"}
    assert "three_storey" in repr(pickle.loads(pickle.dumps(case)).path)
    other = case.replace(title="Another")
    assert other.title == "Another" and other.parameters == case.parameters


def test_cases_are_written_and_pickled(healthy, tmp_path):
    healthy.save(tmp_path / "case")
    for other in (pinode.read_case(tmp_path / "case" / "case.toml"),
                  pickle.loads(pickle.dumps(healthy)),
                  pinode.Case.from_dict(healthy.to_dict())):
        assert np.array_equal(other.stiffness, healthy.stiffness)
        assert other.parameters == healthy.parameters
        ours, theirs = healthy.measured("healthy"), other.measured("healthy")
        assert all(np.array_equal(ours[k], theirs[k]) for k in ours)


def test_simulation_agrees_with_another_integration():
    ground, floors = frame_testing.measure(noise=0.0)
    case = pinode.Case(
        conftest.model(),
        records=[pinode.Record("r", step=0.01, ground={"x": ground},
                               interpolation="cubic", start="rest",
                               channels=[pinode.Channel("a", dof="u3")])])
    response = case.simulate()["r"]
    error = response["channels"]["a"] - floors[:, 2]
    assert response["finite"]
    assert np.sqrt(np.mean(error**2)) < 1e-3 * np.std(floors[:, 2])
    noisy = case.simulate(noise_percent=5.0, seed=3)["r"]["channels"]["a"]
    again = case.simulate(noise_percent=5.0, seed=3)["r"]["channels"]["a"]
    assert np.array_equal(noisy, again)
    spread = np.std(noisy - response["channels"]["a"]) / np.std(noisy)
    assert 0.04 < spread < 0.06
    with pytest.raises(pinode.Error, match="sigma"):
        case.simulate(noise="sigma")
    with pytest.raises(pinode.Error, match="noise"):
        case.simulate(noise="loud")
    with pytest.raises(pinode.Error, match="noise_percent is -3, expected 0 or more"):
        case.simulate(noise_percent=-3)


def test_sweep_of_a_linear_case_is_its_frequency_response(healthy):
    sweep = healthy.sweep("ground_x", 1.0, 12.0, amplitude=0.5, points=30)
    assert sweep["finished"] and sweep["remark"] == ""
    frequency = sweep["frequency_hz"]
    assert frequency[0] == 1.0 and frequency[-1] == pytest.approx(12.0, rel=1e-12)
    for name, channel in sweep["channels"].items():
        dof = healthy.dofs.index({"a1": "u1", "a2": "u2", "a3": "u3"}[name])
        for f, amplitude in zip(frequency, channel["amplitude"]):
            w = 2.0 * np.pi * f
            relative = np.linalg.solve(
                healthy.stiffness + 1j * w * healthy.damping - w**2 * healthy.mass,
                w**2 * (healthy.mass @ np.ones(3)))
            assert amplitude == pytest.approx(0.5 * abs(1.0 + relative[dof]), rel=1e-8)
    assert np.all(sweep["largest_multiplier"] < 1.0)
    with pytest.raises(pinode.Error, match="no load 'shaker'; the case has 'ground_x'"):
        healthy.sweep("shaker", 1.0, 2.0)
    with pytest.raises(pinode.Error, match="to_hz"):
        healthy.sweep("ground_x", 1.0, -2.0)


def test_simulations_are_written_as_the_program_does(healthy, tmp_path):
    healthy.save(tmp_path / "case")
    path = tmp_path / "case" / "case.toml"
    case = pinode.read_case(path, simulation=True)
    simulation = pickle.loads(pickle.dumps(case.simulate(noise_percent=2.0, seed=7)))
    simulation.save(tmp_path / "ours", mat=True)
    assert scipy.io.loadmat(tmp_path / "ours/results.mat")
    with pytest.raises(pinode.Error, match="exists"):
        simulation.save(tmp_path / "ours")
    program = pathlib.Path(os.environ["PINODE_BUILD_DIR"], "apps/pinode_simulate")
    if not program.exists():
        pytest.skip("pinode_simulate is not built")
    subprocess.run([program, f"--case={path}", f"--output_dir={tmp_path}/theirs",
                    "--noise_percent=2", "--seed=7"], check=True, capture_output=True)
    for name in ("response_healthy.csv", "simulate.json"):
        assert (tmp_path / "ours" / name).read_text() == (
            tmp_path / "theirs" / name).read_text()
    simulation["healthy"]["channels"][next(iter(simulation["healthy"]["channels"]))] = [1.0]
    with pytest.raises(pinode.Error, match="has 1 samples, expected 1500"):
        simulation.save(tmp_path / "spoiled")
    assert not (tmp_path / "spoiled").exists()


def test_covariates_are_arrays_or_one_number():
    ground, floors = frame_testing.measure(noise=0.0)

    def response(temperature, slope):
        group = pinode.Group("frost", frame_testing.STIFFNESS, initial=slope, free=False,
                             follows={"covariate": "T", "reference": 20.0})
        case = pinode.Case(
            conftest.model(), groups=[group],
            records=[pinode.Record("r", step=0.01, ground={"x": ground},
                                   covariate={"T": temperature},
                                   interpolation="cubic", start="rest",
                                   channels=[pinode.Channel("a", dof="u3")])])
        return case.simulate()["r"]["channels"]["a"]

    warm = response(np.full(len(ground), 30.0), -0.01)
    assert np.array_equal(warm, response(30.0, -0.01))
    assert not np.allclose(warm, response(20.0, -0.01), rtol=1e-3)
    assert np.allclose(response(20.0, -0.01), response(30.0, 0.0))


def test_noise_of_each_sensors_own_sigma():
    ground, _ = frame_testing.measure(noise=0.0)
    sigmas = {"u1": 0.05, "u3": 0.2}
    case = pinode.Case(
        conftest.model(),
        records=[pinode.Record("r", step=0.01, ground={"x": ground}, interpolation="cubic",
                               start="rest", channels=[
                                   pinode.Channel(dof, dof=dof, sigma=sigma)
                                   for dof, sigma in sigmas.items()])])
    clean = case.simulate()["r"]["channels"]
    noisy = case.simulate(noise="sigma", seed=3)["r"]["channels"]
    for dof, sigma in sigmas.items():
        assert np.std(noisy[dof] - clean[dof]) == pytest.approx(sigma, rel=0.08)
    with pytest.raises(pinode.Error, match="both"):
        case.simulate(noise="sigma", noise_percent=1.0)
    with pytest.raises(pinode.Error, match="simulation"):
        case.identify()


def test_check_says_what_is_not_seen(healthy):
    check = healthy.check()
    assert check["num_free"] == 3 and check["undetermined"] == []
    assert {e["name"] for e in check["expected"]} == {"k1", "k2", "k3"}
    twice = healthy.replace(groups=conftest.groups() + [
        pinode.Group("same", frame_testing.STOREYS[0])])
    assert any("same" in u for u in twice.check()["undetermined"])


def test_more_measured_modes_than_dofs():
    """As identify_modes finds them: the model has none for the last."""
    hz = np.sqrt(scipy.linalg.eigh(frame_testing.STIFFNESS, frame_testing.MASS,
                                   eigvals_only=True)) / (2 * np.pi)
    measured = [*(0.98 * hz), 3.0 * hz[-1]]
    modes = [pinode.Mode(f, frequency_sigma=1e-3 * f, name=f"m{i}")
             for i, f in enumerate(measured)]
    fit = pinode.Case(conftest.model(), groups=conftest.groups(), modes=modes).identify()
    assert fit.usable, fit.message
    assert any("does not use 'm3'" in remark for remark in fit.remarks)
    assert [m["updated_hz"] for m in fit.modes] == pytest.approx(measured[:3], rel=1e-3)


def test_a_mode_has_a_deviation_of_each_entry():
    def made(**sigmas):
        return pinode.Case(conftest.model(), groups=conftest.groups(), modes=[pinode.Mode(
            1.0, frequency_sigma=0.1, shape={"u1": 0.5, "u2": 1.0}, shape_sigma=sigmas)])

    sigmas = {"u1": 0.02, "u2": 0.03}
    assert made(**sigmas).to_dict()["mode"][0]["shape_sigma"] == sigmas
    with pytest.raises(pinode.Error, match="no deviation of 'u2'"):
        made(u1=0.02)


def test_a_check_writes_a_folder(healthy, tmp_path):
    check = healthy.check(output=tmp_path / "c", mat=True)
    found = json.loads((tmp_path / "c" / "check.json").read_text())
    assert found["dofs"] == ["u1", "u2", "u3"] and found["free_parameters"] == 3
    assert {e["name"]: e["sigma"] for e in found["expected"]} == pytest.approx(
        {e["name"]: e["sigma"] for e in check["expected"]})
    assert [m["frequency_hz"] for m in found["modes"]] == pytest.approx(
        list(healthy.natural_modes()["frequencies_hz"]))
    mat = scipy.io.loadmat(tmp_path / "c" / "results.mat", simplify_cells=True)
    assert np.array_equal(mat["K"], frame_testing.STIFFNESS)
    with pytest.raises(pinode.Error, match="exists and is not empty"):
        healthy.check(output=tmp_path / "c")
    healthy.check(output=tmp_path / "c", overwrite=True)
    assert not (tmp_path / "c" / "results.mat").exists()
    with pytest.raises(pinode.Error, match="mat=True .* expected output"):
        healthy.check(mat=True)
    with pytest.raises(pinode.Error, match="output is a value of type int"):
        healthy.check(output=3)


@pytest.mark.parametrize("change, message", [
    (dict(groups=[pinode.Group("k1", np.eye(2))]),
     r"groups\[0\].matrix: the matrix of group 'k1' is 2 x 2, expected 3 x 3"),
    (dict(groups=[pinode.Group("k1", np.eye(3, dtype=complex))]),
     r"groups\[0\].matrix has entries of type complex128"),
    (dict(groups=[pinode.Group("k1", [np.eye(3, dtype=complex)[i] for i in range(3)])]),
     "k1|complex|matrix"),
    (dict(elements=[{"name": "e", "type": "cubik", "between": ["ground", "u1"]}]), "cubik"),
    (dict(records=[]), "^records is an empty list, expected at least one entry"),
    (dict(model=3), "model is the number 3, expected a dictionary"),
    (dict(units={"length": "furlong"}), "furlong"),
])
def test_mistakes_are_sentences(healthy, change, message):
    with pytest.raises(pinode.Error, match=message) as caught:
        healthy.replace(**change).identify()
    assert isinstance(caught.value, ValueError)
    assert "\n" not in str(caught.value)


def _shaken(**changes):
    ground, floors = frame_testing.measure()
    columns = {"ground": ground, "a3": floors[:, 2], **changes}
    return pinode.Case(conftest.model(), groups=conftest.groups(), records=[
        pinode.Record("r", step=0.01, interpolation="held", start="rest",
                      ground={"x": columns["ground"]},
                      channels=[pinode.Channel("a3", columns["a3"], dof="u3")])])


def test_bad_samples_are_named():
    _, floors = frame_testing.measure()
    assert not any("channel a3" in r for r in _shaken().identify().remarks)
    values = floors[:, 2].copy()
    values[200:204] = -9999.0
    fit = _shaken(a3=values).identify()
    wanted = "Record 'r', channel a3: 4 samples are -9999"
    assert any(wanted in remark for remark in fit.remarks), fit.remarks
    assert any(wanted in remark for remark in _shaken(a3=values).check()["remarks"])


def test_levels_of_motion():
    _, floors = frame_testing.measure()
    fit = _shaken().identify()
    level, = fit.levels_of_motion
    assert (level["channel"], level["dof"]) == ("a3", "u3")
    assert (level["quantity"], level["unit"]) == ("absolute_acceleration", "m/s^2")
    assert 0.0 < level["lowest"] < np.std(floors[:, 2]) < level["highest"]
    assert level["lowest"] < level["mean"] < level["highest"]
    assert pickle.loads(pickle.dumps(fit)).levels_of_motion == [level]


def test_columns_that_are_no_measurements_are_refused():
    ground, floors = frame_testing.measure()
    with pytest.raises(pinode.Error, match="'ground_x', has entries of type bool"):
        _shaken(ground=ground > 0.0)
    with pytest.raises(pinode.Error, match="'a3', has entries of type bool"):
        _shaken(a3=floors[:, 2] > 0.0)
    with pytest.raises(pinode.Error, match="beyond 1e140"):
        _shaken(ground=1e200 * ground, a3=1e200 * floors[:, 2])


def test_names_of_dofs_are_unique():
    with pytest.raises(pinode.Error, match="the list of DOFs has 'a' at 1 and at 3"):
        pinode.Case(pinode.FiniteElementModel(
            frame_testing.MASS, frame_testing.STIFFNESS, dofs=["a", "b", "a"]))
    with pytest.raises(pinode.Error, match="the name 'a' is used"):
        pinode.Case(pinode.Model(frame_testing.MASS, frame_testing.STIFFNESS,
                                 frame_testing.DAMPING, dofs=["a", "b", "a"]))


def test_what_contains_itself_is_refused():
    tree = {}
    tree["model"] = tree
    with pytest.raises(pinode.Error, match="nested too deeply"):
        pinode.Case.from_dict(tree)


def test_reprs(healthy):
    assert "3 DOFs, 1 record, 3 free parameters" in repr(healthy)
    assert "<table>" in healthy._repr_html_()
    assert repr(pinode.Group("k1", np.eye(3))) == (
        "Group(name='k1', adds_to='stiffness', matrix=array of 3 x 3)")


@pytest.mark.parametrize("as_given", [np.asarray, scipy.sparse.csc_matrix])
def test_groups_over_all_dofs_of_a_reduced_model(as_given):
    """Five springs in a row, reduced to the first and the last mass."""
    def springs(values):
        total = np.zeros((5, 5))
        for i, k in enumerate(values):
            total[i, i] += k
            if i > 0:
                total[i - 1, i - 1] += k
                total[[i, i - 1], [i - 1, i]] -= k
        return total

    whole = springs([9.0, 8.0, 7.0, 6.0, 5.0])
    first = springs([9.0, 0.0, 0.0, 0.0, 0.0])
    made = pinode.Case(
        pinode.FiniteElementModel(
            as_given(np.eye(5)), as_given(whole), damping={"ratios": [0.02]},
            reduction={"method": "guyan", "keep": ["u1", "u5"]}),
        groups=[pinode.Group("first", as_given(first), initial=-0.1)])
    assert made.stiffness.shape == (2, 2)
    assert np.allclose(made.full_matrices()["groups"]["first"].toarray(), first)
