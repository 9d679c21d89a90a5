"""Models from CalculiX: matrices that `ccx` exports from a deck, and a group for each
element set.

    export = pinode.calculix.export("frame.inp", ["columns_1", "brace_1"])
    case = pinode.Case(
        export.model(reduction={"method": "craig_bampton", "modes": 4},
                     damping={"ratios": [0.01]}),
        groups=export.groups, geometry=export.geometry, records=[...])
    case.identify().save("found", deck="frame.inp")

For each set, the modulus is multiplied by a factor and the stiffness is exported
again. alpha = -0.1 of the set's group then is a loss of 10 % of the modulus. With the
geometry pinode can draw the structure. `save` writes the identified properties into
the deck.
"""

from __future__ import annotations

import os
import re
import shutil
import subprocess
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

from ._part import as_number, as_path, as_sequence, as_text
from ._pinode import Error
from .parts import FiniteElementModel, Group


class Export(NamedTuple):
    """Exported matrices of a deck, and a group for each set that was changed.

    folder: absolute path of the exported files.
    mass, stiffness: absolute paths of the matrices' files.
    groups: list of the groups.
    geometry: the `geometry` of a Case with all these groups: the deck, and the element
        sets of groups with other names. For some of the groups use geometry_of.
    """

    folder: Path
    mass: Path
    stiffness: Path
    groups: list[Group]
    geometry: dict[str, Any]

    def model(self, **keys: Any) -> FiniteElementModel:
        """Returns the model of these files. `keys` are those of FiniteElementModel,
        such as `reduction` and `damping`.
        """
        return FiniteElementModel(str(self.mass), str(self.stiffness), **keys)

    def geometry_of(self, groups: Sequence[Mapping[str, Any]]) -> dict[str, Any]:
        """Returns the `geometry` of a Case with these groups only."""
        names = {group["name"] for group in groups}
        sets = {name: s for name, s in self.geometry["groups"].items() if name in names}
        return {**self.geometry, "groups": sets}


class _Card(NamedTuple):
    name: str  # "*ELASTIC", upper case
    options: dict[str, str]  # upper case
    line: str
    data: list[str]

    def text(self) -> list[str]:
        return [self.line, *self.data]


def export(
    deck: str | os.PathLike[str],
    sets: Sequence[str],
    *,
    masses: Sequence[str] = (),
    factor: float = 2.0,
    folder: str | os.PathLike[str] | None = None,
    ccx: str = "ccx",
    threads: int = 1,
) -> Export:
    """Exports the matrices of a deck, and again with one set changed at a time.

    deck: path of the input deck.
    sets: element sets of a section or of springs. The stiffness of each becomes a
        group with its name.
    masses: element sets of a section, or of *MASS. The mass of each becomes a group
        named "mass_<set>".
    factor: factor of the modulus or the density in the changed exports.
    folder: folder of the exported files. Default: "<deck>_export" beside the deck.
    ccx: command of CalculiX.
    threads: number of exports at a time.

    Steps of the deck are left out, except the supports of the first step. Returns an
    Export.

    Raises pinode.Error if the deck has no such set, or if `ccx` is missing or fails.
    """
    deck = Path(as_path("deck", deck)).absolute()
    sets = [as_text("sets: a set", name) for name in as_sequence("sets", sets)]
    masses = [as_text("masses: a set", name) for name in as_sequence("masses", masses)]
    factor, ccx = as_number("factor", factor), as_path("ccx", ccx)
    if not factor > 0.0 or factor in (1.0, float("inf")):
        raise Error(f"factor is {factor!r}, expected a positive number other than 1")
    place = deck.with_name(deck.stem + "_export")
    if folder is not None:
        place = Path(as_path("folder", folder)).absolute()
    if not isinstance(threads, (int, np.integer)) or isinstance(threads, bool) or threads < 1:
        raise Error(f"threads is {threads!r:.40}, expected a whole number from 1")
    program = shutil.which(ccx)
    if program is None:
        raise Error(f"there is no program '{ccx}', expected CalculiX (Debian: calculix-ccx)")
    cards = _model_of(_read(deck))
    # All that can be wrong with a name, before anything is run.
    jobs = [(name, name, "stiffness", _changed(cards, name, factor, deck)) for name in sets]
    jobs += [
        (f"mass_{name}", name, "mass", _changed(cards, name, factor, deck, "*DENSITY"))
        for name in masses
    ]
    for name, *_ in jobs:
        if not re.fullmatch(r"[A-Za-z0-9_.+-]+", name) or name == "model":
            raise Error(f"set '{name}' cannot be the name of a group and a file")
    try:
        place.mkdir(parents=True, exist_ok=True)
        groups = _export_all(os.path.abspath(program), place, cards, jobs, factor, threads)
    except OSError as failure:
        raise Error(f"{place}: cannot be written: {failure.strerror}") from None
    # A set of the same name needs no mention.
    geometry = {"file": str(deck),
                "groups": {name: of for name, of, *_ in jobs if name != of}}
    return Export(place, place / "model.mas", place / "model.sti", groups, geometry)


def _export_all(
    ccx: str,
    place: Path,
    cards: list[_Card],
    jobs: list[tuple[str, str, str, list[_Card]]],
    factor: float,
    threads: int,
) -> list[Group]:
    _run(ccx, place, "model", cards, threads)
    groups = []
    for name, _, target, changed in jobs:
        _run(ccx, place, name, changed, threads)
        suffix = "sti" if target == "stiffness" else "mas"
        groups.append(
            Group(name, adds_to=target, changed_export=str(place / f"{name}.{suffix}"),
                  factor=factor, lower=-0.95)
        )
        (place / f"{name}.{'mas' if suffix == 'sti' else 'sti'}").unlink(missing_ok=True)
    return groups


def element_sets(deck: str | os.PathLike[str]) -> list[str]:
    """Returns the names of the element sets of a deck that `export` can change."""
    cards = _model_of(_read(Path(as_path("deck", deck))))
    return _sets_of(cards, "*SPRING", "*MASS")


def _sets_of(cards: list[_Card], *kinds: str) -> list[str]:
    """Returns the element sets of sections and of other cards of these kinds."""
    return list(dict.fromkeys(
        card.options["ELSET"] for card in cards
        if (card.name.endswith(" SECTION") or card.name in kinds) and "ELSET" in card.options))


def _read(path: Path) -> list[_Card]:
    cards: list[_Card] = []
    _read_into(cards, path, path, 0)
    return cards


def _read_into(cards: list[_Card], path: Path, main: Path, depth: int) -> None:
    """Adds the cards of a file. An included file may continue the data of the card
    before it.
    """
    try:
        lines = path.read_text(encoding="utf-8", errors="surrogateescape").splitlines()
    except OSError as failure:
        raise Error(f"{path}: cannot be read: {failure.strerror}") from None
    for number, line in enumerate(lines, 1):
        text = line.strip()
        if not text or text.startswith("**"):
            continue
        if not text.startswith("*"):
            if not cards:
                raise Error(f"{path}:{number}: data before the first card")
            cards[-1].data.append(line)
            continue
        words = [word.strip() for word in text.split(",")]
        options = {}
        for word in words[1:]:
            key, _, value = word.partition("=")
            options[key.strip().upper()] = value.strip()
        card = _Card(" ".join(words[0].upper().split()), options, line, [])
        if card.name == "*INCLUDE":
            if depth > 8:
                raise Error(f"{path}:{number}: includes are nested too deeply")
            name = options.get("INPUT", "").strip('"')
            # Beside the file that names it, or else beside the deck.
            other = path.parent / name
            if not other.exists() and (main.parent / name).exists():
                other = main.parent / name
            _read_into(cards, other, main, depth + 1)
        else:
            cards.append(card)


def _model_of(cards: list[_Card]) -> list[_Card]:
    """Returns the cards without steps, except the supports of the first step."""
    model, step = [], 0
    inside = False
    for card in cards:
        if card.name == "*STEP":
            inside, step = True, step + 1
        elif card.name == "*END STEP":
            inside = False
        elif not inside or (step == 1 and card.name == "*BOUNDARY"):
            model.append(card)
    return model


def _changed(
    cards: list[_Card], name: str, factor: float, deck: Path, what: str = "*ELASTIC"
) -> list[_Card]:
    """Returns the model with the set's modulus, spring constant or density times
    `factor`.

    A material that other sets share is copied for the set.
    """
    wanted = str(name).upper()

    def is_of(card: _Card) -> bool:
        return card.options.get("ELSET", "").upper() == wanted

    # Cards with a number of their own, besides sections and their materials.
    kind = "*SPRING" if what == "*ELASTIC" else "*MASS"
    own = [i for i, card in enumerate(cards) if card.name == kind and is_of(card)]
    if own:
        scaled = _scaled_spring if kind == "*SPRING" else _scaled_mass
        result = list(cards)
        for i in own:
            result[i] = scaled(cards[i], factor, deck)
        return result
    sections = [i for i, card in enumerate(cards)
                if card.name.endswith(" SECTION") and is_of(card)]
    if not sections:
        known = ", ".join(_sets_of(cards, kind)) or "those of a section"
        raise Error(f"{deck}: no section and no {kind} has the element set '{name}', expected one "
                    f"of {known}")
    result = list(cards)
    for number, i in enumerate(sections):
        material = cards[i].options.get("MATERIAL", "")
        copy = f"P{number}_{wanted}"[:75]
        result[i] = cards[i]._replace(line=re.sub(
            r"(?i)(MATERIAL\s*=\s*)[^,\s]+", lambda m: m.group(1) + copy, cards[i].line))
        result += _scaled_material(cards, material, copy, factor, deck, what)
    return result


def _scaled_material(
    cards: list[_Card], material: str, copy: str, factor: float, deck: Path, what: str
) -> list[_Card]:
    begin = next((i for i, card in enumerate(cards)
                  if card.name == "*MATERIAL"
                  and card.options.get("NAME", "").upper() == material.upper()), None)
    if begin is None:
        raise Error(f"{deck}: there is no material '{material}'")
    block = [_Card("*MATERIAL", {"NAME": copy}, f"*MATERIAL,NAME={copy}", [])]
    found = False
    for card in cards[begin + 1:]:
        # Properties go to the last material, whatever stands between.
        if card.name == "*MATERIAL":
            break
        if card.name not in _OF_MATERIALS:
            continue
        if card.name == what:
            kind = card.options.get("TYPE", "ISO").upper()
            if what == "*ELASTIC" and kind not in ("ISO", "ISOTROPIC", ""):
                raise Error(f"{deck}: material '{material}' is elastic of type {kind}, "
                            "expected an isotropic one")
            card = card._replace(data=[_scaled(line, factor, deck) for line in card.data])
            found = True
        block.append(card)
    if not found:
        raise Error(f"{deck}: material '{material}' has no {what}")
    return block


_OF_MATERIALS = {
    "*ELASTIC", "*DENSITY", "*EXPANSION", "*DAMPING", "*PLASTIC", "*CONDUCTIVITY",
    "*SPECIFIC HEAT", "*DEPVAR", "*HYPERELASTIC", "*CREEP", "*USER MATERIAL",
    "*CYCLIC HARDENING", "*DEFORMATION PLASTICITY", "*MOHR COULOMB",
    "*MOHR COULOMB HARDENING",
}


def _scaled(line: str, factor: float, deck: Path) -> str:
    """Returns the line with its first number times `factor`."""
    words = line.split(",")
    try:
        words[0] = repr(float(words[0].upper().replace("D", "E")) * factor)
    except ValueError:
        raise Error(f"{deck}: '{line.strip()[:40]}', expected a number first") from None
    return ",".join(words)


def _scaled_spring(card: _Card, factor: float, deck: Path) -> _Card:
    if "NONLINEAR" in card.options:
        raise Error(f"{deck}: springs '{card.options['ELSET']}' are nonlinear, expected "
                    "linear ones")
    # Directions are whole numbers, constants have a point (CalculiX tells them
    # apart so).
    data = [_scaled(line, factor, deck) if "." in line.split(",")[0] else line
            for line in card.data]
    if data == card.data:
        raise Error(f"{deck}: springs '{card.options['ELSET']}' have no constant with a "
                    "decimal point")
    return card._replace(data=data)


def _scaled_mass(card: _Card, factor: float, deck: Path) -> _Card:
    return card._replace(data=[_scaled(line, factor, deck) for line in card.data])


def _run(ccx: str, folder: Path, name: str, cards: list[_Card], threads: int) -> None:
    lines = [line for card in cards for line in card.text()]
    lines += ["*STEP", "*FREQUENCY,SOLVER=MATRIXSTORAGE", "*END STEP", ""]
    (folder / f"{name}.inp").write_text("\n".join(lines), encoding="utf-8",
                                        errors="surrogateescape")
    for suffix in ("sti", "mas", "dof"):
        (folder / f"{name}.{suffix}").unlink(missing_ok=True)
    done = subprocess.run(
        [ccx, "-i", name], cwd=folder, capture_output=True, text=True, errors="replace",
        check=False, env={**os.environ, "OMP_NUM_THREADS": str(threads)})
    written = all((folder / f"{name}.{suffix}").exists() for suffix in ("sti", "mas", "dof"))
    if "Job finished" not in done.stdout or not written:
        said = [line.strip() for line in (done.stdout + done.stderr).splitlines() if line.strip()]
        wrong = next((line for line in said if "ERROR" in line.upper()), "")
        raise Error(f"{folder / name}.inp: ccx failed: {wrong or ' '.join(said[-2:])[:200]}")
    for suffix in ("12d", "cvg", "dat", "frd", "sta", "eig"):
        (folder / f"{name}.{suffix}").unlink(missing_ok=True)


__all__ = ["Export", "element_sets", "export"]
