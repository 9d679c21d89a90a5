"""A progress bar in a terminal or a notebook."""

from __future__ import annotations

import contextlib
import sys
import warnings
from collections.abc import Callable, Iterator, Mapping
from typing import Any


# "stage 1 of 5, 29 iterations in 00:05, simulation error 3.2 %, cost 812". How long it
# will take is not known: a stage ends where it has converged.
_FORMAT = "{desc}, {n_fmt} iterations in {elapsed}{postfix}"


def _in_notebook() -> bool:
    shell = sys.modules.get("IPython")
    shell = shell.get_ipython() if shell is not None else None
    return shell is not None and "IPKernelApp" in getattr(shell, "config", {})


@contextlib.contextmanager
def watched(
    progress: bool | None, callback: Callable[[Mapping[str, Any]], Any] | None
) -> Iterator[Callable[[Mapping[str, Any]], Any] | None]:
    """Returns the function that a fit calls: the callback, a progress bar, both, or
    None.
    """
    if progress is None:
        progress = _in_notebook() or bool(getattr(sys.stderr, "isatty", bool)())
    bar = None
    if progress:
        try:
            # In a notebook without ipywidgets it takes the bar of a terminal, which
            # is no fault of the notebook's.
            with warnings.catch_warnings():
                warnings.filterwarnings("ignore", message="IProgress not found")
                from tqdm.auto import tqdm

            bar = tqdm(desc="identify", leave=False, bar_format=_FORMAT)
        except ImportError:
            bar = None
    if bar is None:
        yield callback
        return

    last = 0

    def call(state: Mapping[str, Any]) -> Any:
        nonlocal last
        bar.set_description_str(
            (state["fit"] + ", " if state["fit"] else "")
            + f"stage {state['stage']} of {state['num_stages']}",
            refresh=False,
        )
        bar.set_postfix_str(
            f"simulation error {100.0 * state['free_run_error']:.3g} %, cost {state['cost']:.4g}",
            refresh=False,
        )
        # Each of several fits counts from zero.
        now = state["iteration"]
        bar.update(now - last if now >= last else now)
        last = now
        return None if callback is None else callback(state)

    try:
        yield call
    finally:
        bar.close()
