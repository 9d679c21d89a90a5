"""Models from CalculiX, held against the frequencies that it finds itself."""

import os
import pathlib
import pickle
import re
import shutil
import subprocess

import numpy as np
import pytest

import pinode
from pinode import calculix

pytestmark = pytest.mark.skipif(
    shutil.which("ccx") is None, reason="CalculiX is not installed (calculix-ccx)")

FRAME = pathlib.Path(os.environ["PINODE_SOURCE_DIR"], "data/frame")
LENGTH, SIDE, ELEMENTS = 1.0, 0.05, 8
YOUNG, DENSITY = 2.1e11, 7850.0


def deck(young=YOUNG, spring=1e5, density=DENSITY, step="*STEP\n*STATIC\n*END STEP\n"):
    """A cantilever of two halves with one material, and a spring at its end.
    `young`, `density`: of the half at the support."""
    lines = ["*NODE, NSET=all"]
    for i in range(ELEMENTS + 1):
        for j, (y, z) in enumerate([(0, 0), (1, 0), (1, 1), (0, 1)]):
            lines.append(f"{4 * i + j + 1}, {LENGTH * i / ELEMENTS}, {SIDE * y}, {SIDE * z}")
    lines.append(f"{4 * ELEMENTS + 9}, {LENGTH}, {SIDE}, 1.0")
    for name, first in (("Near", 0), ("far", ELEMENTS // 2)):
        lines.append(f"*Element, type=C3D8I, elset={name}")
        for i in range(first, first + ELEMENTS // 2):
            corners = [4 * i + k for k in (1, 2, 3, 4, 5, 6, 7, 8)]
            lines.append(", ".join(map(str, [i + 1, *corners])))
    lines += [
        "*ELEMENT,TYPE=SPRINGA,ELSET=tie", f"100,{4 * ELEMENTS + 3},{4 * ELEMENTS + 9}",
        "*SPRING,ELSET=tie", f"{spring:.6E}",
        "** both halves are of one steel unless one is changed",
        "*MATERIAL,NAME=steel", "*ELASTIC", f"{YOUNG},0.3", "*DENSITY", f"{DENSITY}",
        "*MATERIAL,NAME=other", "*ELASTIC", f"{young},0.3", "*DENSITY", f"{density}",
        "*SOLID SECTION,ELSET=far,MATERIAL=steel",
        "*SOLID SECTION, ELSET=Near, MATERIAL="
        + ("steel" if (young, density) == (YOUNG, DENSITY) else "other"),
        "*BOUNDARY", "1,1,3", "2,1,3", "3,1,3", "4,1,3", f"{4 * ELEMENTS + 9},1,3"]
    return "\n".join(lines) + "\n" + step


def frequencies(folder, text):
    """The lowest four in Hz, as CalculiX prints them."""
    (folder / "own.inp").write_text(text)
    subprocess.run(["ccx", "-i", "own"], cwd=folder, check=True, capture_output=True)
    found = []
    for line in (folder / "own.dat").read_text().splitlines():
        words = line.split()
        if "P A R T I C I P A T I O N" in line:
            break
        if len(words) == 5 and words[0].isdigit():
            found.append(float(words[3]))
    return np.array(found)


FREQUENCY = "*STEP\n*FREQUENCY\n4\n*END STEP\n"


@pytest.fixture(scope="module")
def export(tmp_path_factory):
    folder = tmp_path_factory.mktemp("calculix")
    (folder / "beam.inp").write_text(deck())
    return calculix.export(folder / "beam.inp", ["Near", "FAR", "tie"], masses=["near"])


def case(export, **initial):
    groups = [pinode.Group(**{**g, "initial": initial.get(g["name"], 0.0)})
              for g in export.groups]
    return pinode.Case(export.model(reduction={"method": "modal", "modes": 12}),
                       groups=groups)


def test_sets_of_a_deck(tmp_path):
    (tmp_path / "beam.inp").write_text(deck())
    assert calculix.element_sets(tmp_path / "beam.inp") == ["tie", "far", "Near"]


def test_included_files(tmp_path):
    (tmp_path / "sub").mkdir()
    (tmp_path / "sub/all.inp").write_text(
        '*INCLUDE,INPUT="sub/beam.inp"\n*INCLUDE,INPUT=more.inp\n')
    (tmp_path / "sub/beam.inp").write_text("** Gr\xf6\xdfe\n" + deck(), encoding="latin-1")
    (tmp_path / "sub/more.inp").write_text("*SPRING,ELSET=more\n")
    (tmp_path / "main.inp").write_text('*INCLUDE, INPUT="sub/all.inp"\n')
    assert calculix.element_sets(tmp_path / "main.inp") == ["tie", "far", "Near", "more"]


def test_frequencies_are_calculix_own(export, tmp_path):
    own = frequencies(tmp_path, deck(step=FREQUENCY))
    ours = case(export).natural_modes()["frequencies_hz"]
    assert ours[:4] == pytest.approx(own, rel=1e-6)
    # Two bending planes of a slender cantilever, the spring along one of them.
    inertia, area = SIDE**4 / 12, SIDE**2
    beam = 1.875104**2 / (2 * np.pi) * np.sqrt(YOUNG * inertia / (DENSITY * area))
    assert own[0] == pytest.approx(beam, rel=0.02)


@pytest.mark.parametrize("name, change, text", [
    ("Near", -0.1, dict(young=0.9 * YOUNG)),
    ("tie", 0.5, dict(spring=1.5e5)),
    ("mass_near", 0.2, dict(density=1.2 * DENSITY))])
def test_groups_change_as_the_deck_does(export, tmp_path, name, change, text):
    own = frequencies(tmp_path, deck(step=FREQUENCY, **text))
    ours = case(export, **{name: change}).natural_modes()["frequencies_hz"]
    # The basis is that of the deck as it is.
    assert ours[:4] == pytest.approx(own, rel=2e-3)
    still = case(export).natural_modes()["frequencies_hz"]
    shift, own_shift = ours[:4] - still[:4], own - still[:4]
    most = np.argmax(np.abs(own_shift))
    assert np.abs(own_shift[most]) > 1e-3 * own[most]
    assert shift[most] == pytest.approx(own_shift[most], rel=0.05)


def test_what_was_found_goes_back_into_the_deck(export, tmp_path):
    softer = case(export, Near=-0.1)
    measured = softer.natural_modes()["frequencies_hz"][:4]
    fit = case(export).replace(
        groups=[pinode.Group(**g) for g in export.groups if g["name"] == "Near"],
        modes=[pinode.Mode(hz, frequency_sigma=1e-4 * hz) for hz in measured]).identify()
    assert fit["Near"] == pytest.approx(-0.1, abs=1e-4)
    (tmp_path / "beam.inp").write_text(deck())
    fit.save(tmp_path / "out", deck=tmp_path / "beam.inp")
    own = frequencies(tmp_path, deck(step=FREQUENCY, young=0.9 * YOUNG))
    updated = (tmp_path / "out/beam_updated.inp").read_text()
    again = frequencies(tmp_path, updated + FREQUENCY)
    assert again == pytest.approx(own, rel=1e-3)
    with pytest.raises(pinode.Error, match="nowhere.inp"):
        fit.save(tmp_path / "other", deck=tmp_path / "nowhere.inp")
    assert not (tmp_path / "other").exists()


def test_a_changed_state_goes_back_into_the_deck(export, tmp_path):
    def state(change):
        measured = case(export, Near=change).natural_modes()["frequencies_hz"][:4]
        return case(export).replace(
            groups=[pinode.Group(**g) for g in export.groups if g["name"] == "Near"],
            modes=[pinode.Mode(hz, frequency_sigma=1e-4 * hz) for hz in measured])

    damage = state(-0.1).damage([state(-0.02).identify()])
    (tmp_path / "beam.inp").write_text(deck())
    damage.save(tmp_path / "out", deck=tmp_path / "beam.inp")
    updated = (tmp_path / "out/beam_updated.inp").read_text()
    modulus = updated.split("NAME=STEEL_NEAR\n*ELASTIC\n")[1].split(",")[0]
    assert float(modulus) == pytest.approx(0.9 * YOUNG, rel=1e-6)


def test_an_export_is_all_that_its_deck_needs(export, tmp_path, monkeypatch):
    """Drawn, fitted and written back with what the export hands out."""
    monkeypatch.chdir(tmp_path)
    assert export.geometry["groups"] == {"mass_near": "near"}
    reduction = {"method": "modal", "modes": 12}

    def with_groups(**initial):
        groups = [pinode.Group(**{**g, "initial": initial.get(g["name"], 0.0)})
                  for g in export.groups if g["name"] in ("Near", "mass_near")]
        return pinode.Case(export.model(reduction=reduction), groups=groups,
                           geometry=export.geometry_of(groups))

    truth = with_groups(Near=-0.1, mass_near=0.2).natural_modes()["frequencies_hz"][:6]
    fit = with_groups().replace(
        modes=[pinode.Mode(hz, frequency_sigma=1e-5 * hz) for hz in truth]).identify()
    assert "tie" in {g["name"] for g in export.groups}
    assert fit.structure() is not None
    deck_path = pathlib.Path(export.geometry["file"])
    fit.save("out", deck=deck_path)
    updated = (tmp_path / "out/beam_updated.inp").read_text()
    numbers = [float(w) for line in updated.splitlines() if not line.startswith("*")
               for w in line.split(",") if w.strip()]
    for name, before in (("Near", YOUNG), ("mass_near", DENSITY)):
        assert fit[name] == pytest.approx({"Near": -0.1, "mass_near": 0.2}[name], abs=0.01)
        assert any(n == pytest.approx(before * (1.0 + fit[name]), rel=1e-9) for n in numbers), name
    # All groups at once need no thought of names.
    assert pinode.Case(export.model(reduction=reduction), groups=export.groups,
                       geometry=export.geometry).dofs


def test_paths_of_an_export_are_whole_ones(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "beam.inp").write_text(deck())
    for keys in ({}, {"folder": "elsewhere"}):
        found = calculix.export("beam.inp", ["far"], **keys)
        files = [found.folder, found.mass, found.geometry["file"], found.groups[0]["changed_export"]]
        assert all(os.path.isabs(file) and os.path.exists(file) for file in files)
    case = pinode.Case(found.model(reduction={"method": "modal", "modes": 4}), groups=found.groups,
                       geometry=found.geometry)
    kept = pickle.dumps(case)
    (tmp_path / "other").mkdir()
    monkeypatch.chdir(tmp_path / "other")
    assert pickle.loads(kept).parameters == case.parameters


@pytest.mark.parametrize("change, sets, message", [
    ({}, ["nowhere"], "no section and no *SPRING has the element set 'nowhere', expected "
     "one of tie, far, Near"),
    ({"*SPRING,ELSET=tie": "*SPRING,ELSET=tie,NONLINEAR"}, ["tie"], "nonlinear"),
    ({"*ELASTIC\n": "*ELASTIC,TYPE=ORTHO\n"}, ["far"], "of type ORTHO"),
    ({"MATERIAL=steel": "MATERIAL=tin"}, ["far"], "no material 'tin'"),
    ({"*NODE, NSET=all": "*HEADING"}, ["far"], "ccx failed"),
])
def test_decks_that_do_not_do(tmp_path, change, sets, message):
    text = deck()
    for old, new in change.items():
        text = text.replace(old, new)
    (tmp_path / "beam.inp").write_text(text)
    with pytest.raises(pinode.Error, match=re.escape(message)):
        calculix.export(tmp_path / "beam.inp", sets)


def matrices(export):
    case = pinode.Case(export.model(reduction={"method": "modal", "modes": 4}),
                       groups=export.groups)
    full = case.full_matrices()
    return [full["mass"], full["stiffness"], *full["groups"].values()]


def test_data_in_a_file_of_their_own(tmp_path):
    text = deck()
    (tmp_path / "beam.inp").write_text(text)
    expected = matrices(calculix.export(tmp_path / "beam.inp", ["far", "tie"]))
    first = text.index("1, 0.0")
    last = text.index("*Element")
    (tmp_path / "nodes.txt").write_text(text[first:last])
    (tmp_path / "split.inp").write_text(
        text[:first] + "*INCLUDE,INPUT=nodes.txt\n" + text[last:])
    found = matrices(calculix.export(tmp_path / "split.inp", ["far", "tie"]))
    assert all(abs(a - b).max() == 0.0 for a, b in zip(found, expected))
    (tmp_path / "nothing.inp").write_text("1, 2\n" + text)
    with pytest.raises(pinode.Error, match="data before the first card"):
        calculix.export(tmp_path / "nothing.inp", ["far"])


def test_materials_with_other_cards_between(tmp_path):
    text = deck()
    (tmp_path / "beam.inp").write_text(text)
    expected = matrices(calculix.export(tmp_path / "beam.inp", ["far"], masses=["far"]))
    between = "*ELSET,ELSET=some\n1\n"
    (tmp_path / "mixed.inp").write_text(text.replace(
        "*MATERIAL,NAME=steel\n", "*MATERIAL,NAME=steel\n" + between))
    found = matrices(calculix.export(tmp_path / "mixed.inp", ["far"], masses=["far"]))
    assert all(abs(a - b).max() == 0.0 for a, b in zip(found, expected))


def test_masses_of_points(tmp_path):
    tip = 4 * ELEMENTS + 3
    (tmp_path / "beam.inp").write_text(deck(step=(
        f"*ELEMENT,TYPE=MASS,ELSET=tip\n200,{tip}\n*MASS,ELSET=tip\n5.0\n"
        "*STEP\n*STATIC\n*END STEP\n")))
    assert calculix.element_sets(tmp_path / "beam.inp") == ["tie", "far", "Near", "tip"]
    export = calculix.export(tmp_path / "beam.inp", [], masses=["Tip"])
    case = pinode.Case(export.model(reduction={"method": "modal", "modes": 4}),
                       groups=export.groups, geometry=export.geometry)
    full = case.full_matrices()
    group = full["groups"]["mass_Tip"].tocoo()
    where = {full["dofs"][i] for i in group.row}
    assert where == {f"{tip}.{d}" for d in (1, 2, 3)}
    assert group.data == pytest.approx(5.0) and (group.row == group.col).all()
    with pytest.raises(pinode.Error, match=r"no \*MASS has the element set 'tie', expected one of"):
        calculix.export(tmp_path / "beam.inp", [], masses=["tie"])


def test_what_is_not_there(tmp_path):
    with pytest.raises(pinode.Error, match="cannot be read"):
        calculix.export(tmp_path / "nowhere.inp", ["a"])
    (tmp_path / "beam.inp").write_text(deck())
    with pytest.raises(pinode.Error, match="no program 'ccy'"):
        calculix.export(tmp_path / "beam.inp", ["far"], ccx="ccy")
    with pytest.raises(pinode.Error, match="factor"):
        calculix.export(tmp_path / "beam.inp", ["far"], factor=1.0)


def test_the_frame_as_its_generator_exported_it(tmp_path):
    """Every matrix of data/frame, which its generate.py had CalculiX write from
    decks of its own."""
    theirs = pinode.read_case(FRAME / "healthy_1.toml")
    names = [g["name"] for g in theirs.to_dict()["group"] if "changed_export" in g]
    masses = [name.removeprefix("mass_") for name in names if name.startswith("mass_")]
    export = calculix.export(
        FRAME / "frame.inp", [name for name in names if not name.startswith("mass_")],
        masses=[f"beams_{floor}" for floor in masses], folder=tmp_path)
    assert len(export.groups) == len(names) == 12
    keep = theirs.to_dict()["model"]["reduction"]
    ours = pinode.Case(export.model(reduction=keep), groups=export.groups)
    whole, expected = ours.full_matrices(), theirs.full_matrices()
    assert whole["dofs"] == expected["dofs"] and len(whole["dofs"]) == 1620
    for key in ("mass", "stiffness"):
        assert_same(whole[key], expected[key], 1e-12)
    for name in names:
        own = whole["groups"][name.replace("mass_", "mass_beams_")]
        assert own.nnz > 0
        # A difference of two exports, which have fifteen digits.
        assert_same(own, expected["groups"][name], 1e-9)
    assert ours.natural_modes()["frequencies_hz"] == pytest.approx(
        theirs.natural_modes()["frequencies_hz"], rel=1e-9)


def assert_same(ours, theirs, relative):
    """All entries, to a part of the largest."""
    assert abs(ours - theirs).max() <= relative * abs(theirs).max()
