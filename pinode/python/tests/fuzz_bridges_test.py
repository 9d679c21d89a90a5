"""Whatever is passed to the bridges and to the parts that take arrays: it is a
pinode.Error with a sentence, and nothing else."""

import inspect
import os

import fuzz_test
import hypothesis
import numpy as np
import pytest
from fuzz_test import settings
from hypothesis import strategies as st

import pinode
from pinode import calculix, elements, opensees

masked = st.builds(lambda array, mask: np.ma.masked_array(array, mask=np.resize(mask, array.shape)),
                   fuzz_test.arrays(), st.lists(st.booleans(), min_size=1, max_size=3))
values = st.one_of(fuzz_test.values, masked)

DECK = """*NODE
1, 0, 0, 0
2, 1, 0, 0
*ELEMENT, TYPE=SPRINGA, ELSET=tie
1, 1, 2
*SPRING, ELSET=tie

1.0
*ELEMENT, TYPE=MASS, ELSET=tip
2, 2
*MASS, ELSET=tip
5.0
"""


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    """Whatever is written is written here."""
    path, before = tmp_path_factory.mktemp("bridges"), os.getcwd()
    os.chdir(path)
    (path / "a.inp").write_text(DECK)
    (path / "m.out").write_text("1 0\n0 1\n")
    yield path
    os.chdir(before)


def tries(work, usual):
    """`usual` arguments of which some are anything."""
    @settings
    @hypothesis.given(st.data())
    def run(folder, data):
        given_for = {**usual, **{name: p.default for name, p in inspect.signature(work).parameters
                                 .items() if p.default is not p.empty}}
        names = data.draw(st.lists(st.sampled_from(list(given_for)), min_size=1, max_size=2,
                                   unique=True))
        given = {**usual, **{name: data.draw(values) for name in names}}
        # Nothing is to be written beside this folder, and no other program run.
        hypothesis.assume(not any(isinstance(v, str) and v.startswith(("/", ".."))
                                  for v in given.values()))
        try:
            work(**given)
        except pinode.Error as failure:
            fuzz_test.is_sentence(failure)
        except MemoryError:
            pass
    return run


EYE = np.eye(2)
test_exports_of_anything = tries(calculix.export, dict(deck="a.inp", sets=["tie"], ccx="true"))
test_sets_of_anything = tries(calculix.element_sets, dict(deck="a.inp"))
test_matrix_files_of_anything = tries(opensees.read_matrix, dict(path="m.out"))
test_models_of_anything = tries(
    opensees.condense, dict(mass=EYE, stiffness=EYE, dofs={1: [0, 1]}, equal=[], rigid=[],
                            coordinates={1: (0.0, 0.0)}))
test_names_of_anything = tries(opensees.equation_names, dict(dofs={1: [0, 1]}, size=2))
test_builds_of_anything = tries(
    elements.build, dict(source="struct A {};", library="x.so", compiler="false"))
test_channels_of_anything = tries(
    pinode.channels, dict(prefix="a", values=np.zeros((4, 2)), quantity="strain"))
test_modes_of_anything = tries(
    pinode.Mode, dict(frequency_hz=1.0, shape=[1.0, 2.0], dofs=["u1", "u2"]))
test_records_of_anything = tries(
    pinode.Record, dict(name="r", step=0.1, channels=[pinode.Channel("a", np.zeros(4))]))


@settings
@hypothesis.given(st.data())
def test_arguments_of_any_kind(folder, data):
    """Those that a fit has beside what is fitted."""
    case = pinode.Case.from_dict(fuzz_test.EXAMPLE)
    name = data.draw(st.sampled_from(["callback", "progress", "mat", "overwrite", "resume",
                                      "profiles", "threads", "begin_from", "output"]))
    value = data.draw(values)
    hypothesis.assume(not (isinstance(value, str) and value.startswith(("/", ".."))))
    stop = {"callback": lambda state: False}
    try:
        case.identify(**{**stop, name: value})
    except pinode.Error as failure:
        fuzz_test.is_sentence(failure)
