"""What a notebook shows of what it meets."""

import copy
import json
import pickle
from html import escape

import conftest
import frame_testing
import numpy as np
import pytest

import pinode
from pinode import _html, _result_tables


def cells(html):
    """Rows of all its tables, as lists of texts."""
    rows = [row.split("</tr>")[0] for row in html.split("<tr>")[1:]]
    return [[cell.split("</td>")[0] for cell in row.split("<td>")[1:]] for row in rows]


def test_a_check_is_a_dictionary_with_tables(healthy):
    check = healthy.check()
    assert isinstance(check, dict) and type(check) is pinode.Check
    assert json.loads(json.dumps(check)) == check == dict(check)
    for other in (pickle.loads(pickle.dumps(check)), copy.deepcopy(check)):
        assert other == check and type(other) is pinode.Check
    assert {**check}["num_free"] == 3
    html = check._repr_html_()
    assert "3 free parameters, 4500 residuals" in html
    (expected,) = [row for row in cells(html) if row[:1] == ["k1"]]
    assert expected[2] == f"{check['expected'][0]['sigma']:.4g}"
    assert ["healthy", check["steps"][0]["integrator"], str(check["steps"][0]["substeps"])] in (
        cells(html))
    assert "Cannot be determined" not in html


def test_a_check_of_what_is_not_seen(healthy):
    twice = healthy.replace(groups=[*conftest.groups(),
                                    pinode.Group("same", frame_testing.STOREYS[0])]).check()
    html = twice._repr_html_()
    assert "Cannot be determined" in html and "<li>" in html and "same" in html
    alone = pinode.Case(conftest.model()).check()
    assert "Nothing was measured" in alone._repr_html_()
    assert "Not assessed: why" in pinode.Check(steps=[], not_assessed="why")._repr_html_()


def test_a_simulation(healthy):
    simulation = healthy.simulate()
    html = simulation._repr_html_()
    values = simulation["healthy"]["channels"]["a3"]
    assert "Simulation of 1 record<" in html
    assert ["healthy", "1500", "a1, a2, a3", ""] in cells(html)
    assert ["healthy", "a3", f"{np.sqrt(np.mean(values**2)):.4g}",
            f"{np.abs(values).max():.4g}"] in cells(html)
    lost = dict(simulation["healthy"], finite=False, remark="its start is unknown")
    broken = pinode.Simulation({"healthy": lost}, healthy, {})
    assert "not finite its start is unknown" in broken._repr_html_()


@pytest.mark.parametrize("kind", ["fit", "damage"])
def test_a_result_folder_as_the_result(kind, baseline, damaged, tmp_path):
    outcome = baseline if kind == "fit" else damaged.damage([baseline])
    outcome.save(tmp_path / "out")
    folder = pinode.read_result(tmp_path / "out")
    html = folder._repr_html_()
    assert str(tmp_path / "out") in html
    there = cells(html)
    # Infinite ends of intervals, null in the file, are a dash in both.
    for row in cells(outcome._repr_html_()):
        assert row in there
    # The first sentence is the heading, and the others follow.
    text = html.replace("</b></p><p>", " ")
    assert escape(outcome.message if kind == "fit" else outcome.sentence) in text


def test_the_heading_of_a_long_verdict_is_its_first_sentence():
    html = _html.section("Usable with care: 17 % is unexplained. Find the cause. Check it.")
    assert "<b>Usable with care: 17 % is unexplained.</b></p><p>Find the cause. Check it.</p>" in html
    assert "<b>4 modes</b></p><table>" in _html.section("4 modes", "<table>")


def test_errors_and_damping_are_in_per_cent(baseline):
    record = next(iter(baseline.records.values()))
    assert [record["name"], record["role"], f"{100.0 * record['nrmse']:.3g}",
            f"{100.0 * record['prior_nrmse']:.3g}"] in [list(row) for row in
                                                        cells(baseline._repr_html_())]


def test_names_are_no_markup(healthy):
    check = pinode.Check(healthy.check(), undetermined=["<b>"])
    assert "<li>&lt;b&gt;</li>" in check._repr_html_()


def test_it_is_styled_for_light_and_dark_pages(baseline, damaged, healthy):
    damage = damaged.damage([baseline])
    for shown in (baseline, damage, healthy, healthy.check(), healthy.simulate()):
        html = shown._repr_html_()
        style = html.partition("<style>")[2].partition("</style>")[0]
        # The text has the colour of the page.
        assert "color:inherit" in style and "#" not in style
        # A table that is wider than a phone is scrolled by itself.
        assert "overflow-x:auto" in style
        numbers = [cell for row in cells(html) for cell in row if "." in cell]
        assert all(len(n.lstrip("-").replace(".", "").lstrip("0").partition("e")[0]) <= 4
                   for n in numbers if n.replace(".", "").lstrip("-").isdigit()), numbers
    assert '<span class="verdict good">good</span>' in baseline._repr_html_()
    assert '<span class="verdict damage">damage</span>' in damage._repr_html_()


def test_checks_and_simulations_in_a_terminal(healthy):
    check = healthy.check()
    assert repr(check).startswith("Check(3 free parameters, 4500 residuals; k1 +- 0.0")
    lines = str(check).splitlines()
    assert lines[0] == "3 free parameters, 4500 residuals"
    (row,) = [line.split() for line in lines if line.startswith("k1 ")]
    assert row[2] == f"{check['expected'][0]['sigma']:.4g}"
    assert any(line.startswith("healthy ") for line in lines) and "{" not in str(check)
    twice = healthy.replace(groups=[*conftest.groups(),
                                    pinode.Group("same", frame_testing.STOREYS[0])]).check()
    assert "Cannot be determined:" in str(twice) and "undetermined" in repr(twice)
    assert repr(healthy.simulate()) == "Simulation(healthy: 1500 samples of a1, a2, a3)"


def test_a_summary(baseline, damaged):
    lines = baseline.summary().splitlines()
    assert lines[0] == baseline.sentence
    (row,) = [line.split() for line in lines if line.startswith("k1 ")]
    p = baseline.parameters["k1"]
    assert row[1:5] == [f"{v:.4g}" for v in (p.initial, p.value, p.lower95, p.upper95)]
    error = baseline.records["healthy"]["nrmse"]
    assert ["healthy", "train", f"{100 * error:.3g}"] in [line.split()[:3] for line in lines]
    damage = damaged.damage([baseline])
    lines = damage.summary().splitlines()
    assert lines[0] == damage.sentence and damage.fit_sentence in lines


def test_changes_are_in_per_cent_and_probabilities_have_a_side():
    group = {"name": "k2", "change": -0.15031, "lower95": -0.1526, "upper95": -0.148}
    rows = [_result_tables.change_row({**group, "probability": p})
            for p in (1e-200, 0.0323, 1.0, None, float("nan"))]
    assert rows[0] == ["k2", "-15", "-15.3", "-14.8", "< 0.01"]
    assert [row[-1] for row in rows[1:]] == ["3.23", "> 99.99", None, None]
