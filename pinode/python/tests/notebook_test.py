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
    assert expected[2] == f"{check['expected'][0]['sigma']:.5g}"
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
    assert ["healthy", "a3", f"{np.sqrt(np.mean(values**2)):.5g}",
            f"{np.abs(values).max():.5g}"] in cells(html)
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
    assert escape(outcome.message if kind == "fit" else outcome.sentence) in html


def test_names_are_no_markup(healthy):
    check = pinode.Check(healthy.check(), undetermined=["<b>"])
    assert "<li>&lt;b&gt;</li>" in check._repr_html_()
