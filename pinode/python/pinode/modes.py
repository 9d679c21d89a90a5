"""Modes of a structure from records alone, without a model."""

from __future__ import annotations

import contextlib
import copy
import functools
import os
import re
from collections.abc import Iterator, Mapping, Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

from . import _html, _pinode
from ._arguments import (ANY, COUNT, FLAG, LIST, MAPPING, NUMBER, POSITIVE, TEXT, WHOLE, Kind,
                         check_kind, either, hint, takes, words_of)
from ._arrays import as_array, is_frame
from ._conditioned import check_band, check_trend, conditioned
from ._labels import check_places, check_rows, labels_of
from ._part import as_flag, as_folder, as_names, as_path, as_sequence, counted
from ._pinode import Error
from .measurements import rate_from

if TYPE_CHECKING:
    from .structure_view import StructureView

# Ends of the names of data files, which may have .gz behind them.
_DATA_FILES = (".csv", ".txt", ".tsv", ".dat", ".uff", ".unv", ".mat", ".npz", ".npy", ".h5",
               ".hdf5", ".at2")
_SETUP_KEYS = ("values", "step", "fs", "sampling_rate_hz", "names", "quantity", "loads",
               "free_decay")
_TIME = Kind("the name of the column of a data file; arrays take step or fs", TEXT.fits)
_DERIVATIVES = {"displacement": 0, "strain": 0, "velocity": 1, "acceleration": 2}
# As channels of a case have them; modes are the same of both.
_LONGER = {"absolute_displacement": "displacement", "absolute_acceleration": "acceleration",
           "relative_acceleration": "acceleration"}


class IdentifiedModes(Sequence):
    """Identified modes, ascending by frequency.

    Each mode is a dictionary: frequency_hz and damping_ratio (a fraction of
    critical), their sigma, lower95 and upper95, and the complex shape over `places`.
    is_harmonic is True for the vibration of a machine, which is not a mode of the
    structure.
    """

    def __init__(self, handle: Any) -> None:
        self._handle = handle
        self._modes: list[dict[str, Any]] = handle.modes
        self.places: list[str] = handle.places
        self.remarks: list[str] = [_in_python(remark) for remark in handle.remarks]

    def __getstate__(self) -> dict[str, Any]:
        # All that is shown; the records stay behind.
        known = ("methods", "diagram", "spectra", "_case_modes", "_structure_html")
        return {**self.__dict__, **{key: getattr(self, key) for key in known}, "_handle": None}

    @property
    def frequencies_hz(self) -> np.ndarray:
        """Frequencies in Hz, ascending, one per mode."""
        return np.array([m["frequency_hz"] for m in self._modes])

    @property
    def damping_ratios(self) -> np.ndarray:
        """Damping ratios as fractions of critical, one per mode."""
        return np.array([m["damping_ratio"] for m in self._modes])

    @property
    def shapes(self) -> np.ndarray:
        """Mode shapes, places x modes, complex. The largest entry of each is 1."""
        if not self._modes:
            return np.zeros((len(self.places), 0), dtype=complex)
        return np.column_stack([m["shape"] for m in self._modes])

    def mac(self, other: "IdentifiedModes | None" = None) -> np.ndarray:
        """Returns the modal assurance criterion |a^H b|^2 / (a^H a b^H b), modes x
        modes.

        other: the second set of modes, compared at the places that both have.
            Default: the modes are compared with each other.
        """
        both = self if other is None else other
        if not isinstance(both, IdentifiedModes):
            raise Error(f"other is {words_of(other)}, expected identified modes")
        shared = [place for place in self.places if place in both.places]
        if not shared:
            raise Error("other has no place in common with these modes, expected at least one")
        one = np.nan_to_num(self.shapes[[self.places.index(p) for p in shared]])
        two = np.nan_to_num(both.shapes[[both.places.index(p) for p in shared]])
        sizes = np.outer((np.abs(one) ** 2).sum(axis=0), (np.abs(two) ** 2).sum(axis=0))
        products = np.abs(one.conj().T @ two) ** 2
        return np.divide(products, sizes, out=np.zeros_like(products), where=sizes > 0.0)

    @functools.cached_property
    def methods(self) -> dict[str, str]:
        """Method by record: "covariance_driven", "input_output", "ring_down", ..."""
        return self._handle.methods

    @functools.cached_property
    def diagram(self) -> list[dict[str, Any]]:
        """Stabilisation diagram: one entry per record and sampling rate of the
        analysis.

        Each entry has the poles as columns: order, frequency_hz, frequency_sigma,
        damping_ratio, and mode, the index of the record's mode, -1 for none.
        """
        return self._handle.diagram

    @functools.cached_property
    def spectra(self) -> dict[str, dict[str, Any]]:
        """Spectra of each record, by name.

        singular_values: 3 x frequencies, of the spectra of all channels, at
            singular_hz.
        measured, modelled: spectral densities, channels x frequencies, at
            frequency_hz, in the unit of the channel squared per Hz.
        explained: fraction of each channel's power that the modes explain.

        The last two items are empty for a free decay.
        """
        return self._handle.spectra()

    def for_case(self) -> list[dict[str, Any]]:
        """Returns the modes as `modes` of a Case.

        They have frequencies with sigmas, and shapes with covariances. DOFs have the
        names of the places.
        """
        return copy.deepcopy(self._case_modes)

    @functools.cached_property
    def _case_modes(self) -> list[dict[str, Any]]:
        return self._handle.for_case()

    @functools.cached_property
    def _structure_html(self) -> str:
        return self._handle.structure_html

    @takes(overwrite=FLAG, mat=FLAG)
    def save(
        self, folder: str | os.PathLike[str], *, overwrite: bool = False, mat: bool = False
    ) -> None:
        """Writes a result folder with the report, as `pinode_modes` does.

        overwrite: True: an existing folder of results is replaced.
        mat: True: also writes results.mat, for MATLAB and Octave.
        """
        if self._handle is None:
            raise Error("modes from a pickle have no records; save the folder before pickling")
        self._handle.save(as_path("folder", folder), overwrite, mat)

    def plot(self, what: str = "stabilisation", record: str | None = None) -> Any:
        """Returns one figure of matplotlib.

        what: "stabilisation", "spectra" or "fdd" (singular values of the spectra) of
            one record; "shapes" or "mac" of all modes.
        record: name of the record. Default: the first.
        """
        from . import figures

        kinds = {"stabilisation": figures.stabilisation, "spectra": figures.modal_spectra,
                 "fdd": figures.fdd, "shapes": figures.identified_shapes, "mac": figures.mac}
        if not isinstance(what, str) or what not in kinds:
            raise Error(f"what is {words_of(what)}, expected one of {', '.join(kinds)}")
        if what in ("shapes", "mac"):
            drawn = kinds[what](self)
        else:
            name = next(iter(self.methods), None) if record is None else record
            if not isinstance(name, str) or name not in self.methods:
                raise Error(f"there is no record {name!r:.40} in the modes")
            drawn = kinds[what](self, name)
        if drawn is None:
            raise Error(f"there is nothing to plot as '{what}'")
        return drawn

    def figures(self) -> "dict[str, Any]":
        """Returns figures of matplotlib by name: the stabilisation diagram of each
        record, spectra, singular values, shapes and MAC.
        """
        from . import figures

        return figures.of_modes(self)

    def to_pandas(self, what: str = "modes") -> Any:
        """Returns a frame of pandas: "modes" (one row each), "shapes" or "diagram"."""
        from . import frames

        return frames.of_modes(self, what)

    def structure(self) -> "StructureView":
        """View of the moving modes. None if the case has no [geometry]."""
        from .structure_view import StructureView

        section = self._structure_html
        if not section:
            raise Error("the structure has no geometry, expected one in the case")
        return StructureView(section)

    def __getitem__(self, index: Any) -> Any:
        return self._modes[index]

    def __len__(self) -> int:
        return len(self._modes)

    def __repr__(self) -> str:
        text = ", ".join(f"{f:.4g} Hz" for f in self.frequencies_hz)
        return f"IdentifiedModes({text})"

    def _repr_html_(self) -> str:
        rows = [
            [i + 1, m["frequency_hz"], m["frequency_lower95"], m["frequency_upper95"],
             *(100.0 * m[key] for key in ("damping_ratio", "damping_lower95", "damping_upper95")),
             "harmonic" if m["is_harmonic"] else ""]
            for i, m in enumerate(self._modes)
        ]
        header = ["mode", "Hz", "from", "to (95 %)", "damping (%)", "from", "to (95 %)", ""]
        return _html.section(counted(len(self), "mode"), _html.table(header, rows))


@takes(records=ANY, free_decay=FLAG, method=TEXT, time=_TIME, time_unit=TEXT, time_format=TEXT,
       header_lines=WHOLE, delimiter=TEXT, decimal=TEXT, encoding=TEXT,
       scale=either(NUMBER, MAPPING), title=TEXT, lowest_hz=POSITIVE, highest_hz=POSITIVE,
       block_rows=WHOLE, max_order=WHOLE, max_damping_ratio=POSITIVE,
       references=LIST, pick=LIST, threads=COUNT, overwrite=FLAG)
def identify_modes(
    records: Any,
    *,
    step: float | None = None,
    fs: float | None = None,
    sampling_rate_hz: float | None = None,
    names: Sequence[str] | None = None,
    quantity: str | Sequence[str] = "acceleration",
    loads: Any = None,
    free_decay: bool = False,
    columns: str | Sequence[str] | None = None,
    time: str | None = None,
    time_unit: str | None = None,
    time_format: str | None = None,
    header_lines: int | None = None,
    delimiter: str | None = None,
    decimal: str | None = None,
    encoding: str | None = None,
    scale: float | Mapping[str, float] | None = None,
    method: str | None = None,
    lowest_hz: float | None = None,
    highest_hz: float | None = None,
    block_rows: int | None = None,
    max_order: int | None = None,
    max_damping_ratio: float | None = None,
    references: Sequence[str] | None = None,
    pick: Sequence[float] | None = None,
    harmonics: bool | None = None,
    detrend: bool | str | None = None,
    filter_hz: Sequence[float | None] | None = None,
    threads: int = 0,
    title: str = "",
    output: str | os.PathLike[str] = "",
    overwrite: bool = False,
) -> IdentifiedModes:
    """Identifies modes from records by subspace methods, with 95 % intervals.

    records: array, samples x channels, of one set-up. Or a dictionary {set-up:
        {"values": ..., "step": ..., "names": ...}} of set-ups with places in common.
        Each set-up may have its own `quantity`, `loads` and `free_decay`. Or a case,
        which needs no model: a Case, the path of a case file, or its tables
        ({"record": [...]}). Or the path of a data file (CSV, universal file, ...).
    step: seconds between samples; or fs or sampling_rate_hz: samples per second.
    names: names of the channels, which are the places on the structure. Default:
        names of the columns of a pandas frame.
    quantity: "displacement", "velocity", "acceleration" or "strain", for all channels
        or one per channel. Names of Channel.quantity are accepted too.
    loads: measured loads, samples x loads, in any units.
    free_decay: True: no load acts from the first sample on.
    columns: channels of a data file. Default: all columns but the time.
    time: column of the time of a data file. Default: found by its name ("t", "time")
        or its clock times.
    time_unit, time_format, header_lines, delimiter, decimal, encoding: form of a text
        file, as the keys of a record with these names. Default: found from the text.
    scale: factor on the numbers of a data file: a number for all channels, or a
        dictionary {column: factor}.
    method: "covariance_driven", "data_driven", "input_output" or "ring_down".
        Default: chosen by the kind of record.
    lowest_hz, highest_hz: range of frequencies of the search.
    block_rows: number of block rows of the Hankel matrix. Default: 12 to 40.
    max_order: highest model order, even. Default: 60, or as many as the channels
        allow.
    max_damping_ratio: poles with more damping are not modes. Default: 0.15.
    references: channels that correlations are computed with. Default: all.
    pick: frequencies in Hz. The nearest poles are the modes, stable or not.
    harmonics: True: `for_case` and modes.toml include harmonics of machines.
    detrend: "linear" (or True) or "constant": trend that is subtracted from arrays.
    filter_hz: (lowest, highest) of a zero-phase Butterworth filter for arrays; None
        for an open end. No modes are searched for outside. The method needs no
        filter. Use one against drift or strong noise outside of the band.
    threads: number of threads. 0: those of the machine.
    title: title of the report.
    output: result folder, as `pinode_modes` writes it. Empty: nothing is written.
    overwrite: True: an existing folder of results is replaced.

    An argument that is not given is as in the table `[modes]` of the case, or has the
    default of this table.

    Raises pinode.Error, which names the argument, if records or arguments are not
    valid or a record is too short.
    """
    options = {
        "method": method,
        "lowest_hz": lowest_hz,
        "highest_hz": highest_hz,
        "block_rows": block_rows,
        "max_order": max_order,
        "max_damping_ratio": max_damping_ratio,
        "references": None if references is None else as_sequence("references", references),
        "pick": None if pick is None else as_sequence("pick", pick),
        "harmonics": None if harmonics is None else as_flag("harmonics", harmonics),
    }
    trend, band = check_trend(detrend), check_band(filter_hz)
    if band is not None:
        options["lowest_hz"] = band[0] if lowest_hz is None else lowest_hz
        options["highest_hz"] = band[1] if highest_hz is None else highest_hz
    options = {key: value for key, value in options.items() if value is not None}
    output = as_folder(output)
    if output:
        _pinode.check_output_folder(output, overwrite)
    rate = rate_from("identify_modes", step, fs, sampling_rate_hz)
    one = {"step": step if rate is None or step is not None else 1.0 / rate, "names": names,
           "quantity": quantity, "loads": loads, "free_decay": free_decay}
    of_file = {"columns": columns, "time": time, "time_unit": time_unit,
               "time_format": time_format, "header_lines": header_lines,
               "delimiter": delimiter, "decimal": decimal, "encoding": encoding,
               "scale": scale}
    of_arrays = {"detrend": trend, "filter_hz": band}
    if _is_data_file(records, of_file):
        _refuse_given("records is a file, which is not prepared", of_arrays)
        handle = _of_data_file(records, options, **one, **of_file, title=str(title))
    elif (handle := _of_case(records, options)) is not None:
        _refuse_given("records is a case, which describes its records itself",
                      {**one, **of_file, **of_arrays, "title": title or None})
    else:
        _refuse_given("records is an array, and this argument is for data files", of_file)
        setups = records if isinstance(records, Mapping) else {"record": {"values": records}}
        given = [_setup(str(name), setup, {**one, **of_arrays}, setups is not records)
                 for name, setup in setups.items()]
        with _in_words():
            handle = _pinode.ModesHandle.from_setups(given, options, title=str(title))
    with _in_words():
        handle.find(threads)
    found = IdentifiedModes(handle)
    if output:
        found.save(output, overwrite=overwrite)
    return found


@contextlib.contextmanager
def _in_words() -> Iterator[None]:
    """Names the function in place of the table of a case file in an Error."""
    try:
        yield
    except Error as failure:
        words = re.sub(r"^\[modes\]( \w+)?: ", lambda m: f"identify_modes:{f'{m[1]}:' if m[1] else ''} ",
                       str(failure))
        if words == str(failure):
            raise
    else:
        return
    raise Error(words)


def _in_python(remark: str) -> str:
    """Returns a remark with keywords in place of keys of a file."""
    return remark.replace("set harmonics = true in [modes].",
                          "set harmonics=True; for_case() and modes.toml then have it.")


def _refuse_given(why: str, values: Mapping[str, Any]) -> None:
    """Raises an Error if one of `values` is given."""
    for key, value in values.items():
        usual = key == "quantity" and isinstance(value, str) and value == "acceleration"
        if value is not None and value is not False and not usual:
            raise Error(f"{why}, expected no {key}")


def _is_data_file(records: Any, of_file: Mapping[str, Any]) -> bool:
    """True for a path of a data file, which arguments or its extension show."""
    if not isinstance(records, (str, os.PathLike)):
        return False
    name = as_path("records", records).lower().removesuffix(".gz")
    return name.endswith(_DATA_FILES) or any(value is not None for value in of_file.values())


def _of_data_file(
    records: Any,
    options: dict[str, Any],
    *,
    step: float | None,
    names: Any,
    quantity: str | Sequence[str],
    loads: Any,
    free_decay: bool,
    columns: str | Sequence[str] | None,
    time: str | None,
    scale: float | Mapping[str, float] | None,
    title: str,
    **text: str | int | None,
) -> Any:
    """Returns the modes of a data file. `text` is the form of a text file."""
    path = as_path("records", records)
    _refuse_given("channels of a data file have the names of its columns", {"names": names})
    _refuse_given("a data file has no loads (a case can name columns as loads)",
                  {"loads": loads})
    one_name = isinstance(columns, str)
    return _pinode.ModesHandle.read_data(
        path,
        ["all"] if columns is None else [columns] if one_name else as_sequence("columns", columns),
        [_short(quantity)] if isinstance(quantity, str) else
        [_short(name) for name in as_sequence("quantity", quantity)],
        time or "",
        0.0 if step is None else 1.0 / step,
        free_decay,
        options,
        title,
        {key: str(value) for key, value in text.items() if value is not None},
        *_factors(scale),
    )


def _factors(scale: float | Mapping[str, float] | None) -> tuple[dict[str, float], float]:
    """Returns the factors by column, and that of all other columns."""
    if not isinstance(scale, Mapping):
        return {}, 1.0 if scale is None else float(scale)
    for name, factor in scale.items():
        check_kind("identify_modes", f"scale[{name!r}]", factor, NUMBER)
    return {str(name): float(factor) for name, factor in scale.items()}, 1.0


def _of_case(records: Any, options: dict[str, Any]) -> Any:
    """Returns the modes of a case; None if `records` is not a case."""
    from .case import Case

    if isinstance(records, Case):
        tree, path = records.to_dict(), records.path
    elif isinstance(records, Mapping) and "record" in records and not (
        isinstance(records["record"], Mapping) and "values" in records["record"]
    ):
        tree, path = dict(records), ""
    elif isinstance(records, (str, os.PathLike)):
        path = as_path("records", records)
        if not options:
            return _pinode.ModesHandle.read(path)
        tree = _pinode.toml_tree(path)
    else:
        return None
    tree["modes"] = {**(tree.get("modes") or {}), **options}
    return _pinode.ModesHandle.from_tree(tree, path)


def _setup(name: str, setup: Any, one: Mapping[str, Any], single: bool) -> tuple[Any, ...]:
    """Returns the table of one set-up. `one` has the values that set-ups share. `single`:
    the user gave an array, not a dictionary of set-ups.
    """
    if is_frame(setup):
        setup = {"values": setup}
    if not isinstance(setup, Mapping) or "values" not in setup:
        raise Error(f"records: set-up '{name}': expected {{'values': ..., 'step': ...}}")
    for key in setup:
        if key not in _SETUP_KEYS:
            raise Error(f"records[{name!r}] has no key '{key!s:.40}'; {hint(str(key), _SETUP_KEYS)}")
    argument = "records" if single else f"records[{name!r}]['values']"
    values = _columns(argument, setup["values"])
    count = values.shape[1] if values.ndim == 2 else 0
    if values.ndim == 2 and values.shape[0] < count:
        raise Error(
            f"{argument} is {values.shape[0]} x {count}, expected samples x channels; if each row "
            f"is a channel, pass its transpose, {'records' if single else 'values'}.T"
        )
    places = setup.get("names", one["names"])
    if places is None and is_frame(setup["values"]):
        places = [str(name) for name in setup["values"].columns]
    places = [f"a{i + 1}" for i in range(count)] if places is None else as_names("names", places)
    check_places(argument, labels_of(setup["values"]), places, "names")
    if len(places) != count:
        raise Error(f"names has {counted(len(places), 'name')} and {argument} "
                    f"{counted(count, 'channel')}, expected one for each")
    own = [setup.get(key) for key in ("step", "fs", "sampling_rate_hz")]
    rate = rate_from(f"set-up '{name}'", *own)
    step = one["step"] if rate is None else own[0] if own[0] is not None else 1.0 / rate
    if step is None:
        raise Error(f"set-up '{name}': 'step' is missing, expected step=seconds or fs=samples a "
                    "second")
    loads = setup.get("loads", one["loads"])
    check_rows(f"set-up '{name}'", {argument: setup["values"], "loads": loads})
    if values.ndim == 2 and (one["detrend"], one["filter_hz"]) != (None, None):
        seconds = 1.0 / (rate_from(f"set-up '{name}'", step) or 1.0)
        values = conditioned(f"set-up '{name}'", values, seconds, one["detrend"],
                             one["filter_hz"])
    return (
        name,
        places,
        _derivatives(setup.get("quantity", one["quantity"]), count, argument),
        values,
        step,
        None if loads is None else _columns("loads", loads),
        setup.get("free_decay", one["free_decay"]),
    )


def _columns(name: str, values: Any) -> np.ndarray:
    try:
        values = as_array(values)
    except (TypeError, ValueError):
        raise Error(
            f"{name}: a value of type {type(values).__name__} is not an array, expected "
            "samples x channels"
        ) from None
    if values.dtype.kind not in "iuf":
        found = "texts" if values.dtype.kind in "US" else f"entries of type {values.dtype}"
        raise Error(f"{name} has {found}, expected numbers")
    if values.ndim not in (1, 2) or values.size == 0:
        found = "empty" if values.size == 0 else words_of(values)
        raise Error(f"{name} is {found}, expected samples x channels")
    return values[:, None] if values.ndim == 1 else values


def _derivatives(quantity: str | Sequence[str], count: int, argument: str) -> list[int]:
    quantities = [quantity] * count if isinstance(quantity, str) else as_sequence("quantity", quantity)
    if len(quantities) != count:
        raise Error(f"quantity is a list of {len(quantities)} and {argument} has "
                    f"{counted(count, 'channel')}, expected one for each")
    for name in quantities:
        if not isinstance(name, str) or _short(name) not in _DERIVATIVES:
            raise Error(
                f"quantity is {words_of(name)}, expected one of {', '.join(_DERIVATIVES)}"
            )
    return [_DERIVATIVES[_short(name)] for name in quantities]


def _short(quantity: Any) -> Any:
    return _LONGER.get(quantity, quantity) if isinstance(quantity, str) else quantity
