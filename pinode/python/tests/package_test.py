"""The package itself: what it reads when it is imported, its stubs, its
documentation."""

import ast
import importlib
import inspect
import os
import pathlib
import re
import subprocess
import sys
import textwrap
import types

import pytest

import pinode
from pinode import _pinode

SOURCE = pathlib.Path(os.environ["PINODE_SOURCE_DIR"])
PACKAGE = pathlib.Path(pinode.__file__).parent


def test_import_reads_no_more_than_numpy():
    code = ("import sys, pinode\n"
            "heavy = {'scipy', 'pandas', 'matplotlib', 'tqdm', 'hypothesis'}\n"
            "assert not heavy & set(sys.modules), heavy & set(sys.modules)")
    subprocess.run([sys.executable, "-c", code], check=True)


def signatures(text):
    """{name: [argument, ...]} of what pybind11 says of a function."""
    head = text.splitlines()[0]
    inside = head[head.index("(") + 1:head.rindex(")")]
    return re.findall(r"(?:^|, )(\w+)\s*:", re.sub(r"\[[^\]]*\]", "", inside))


def stub():
    tree = ast.parse((PACKAGE / "_pinode.pyi").read_text())
    found = {}
    for node in tree.body:
        if isinstance(node, ast.FunctionDef):
            found[node.name] = node
        elif isinstance(node, ast.ClassDef):
            found[node.name] = node
            for part in node.body:
                if isinstance(part, ast.FunctionDef):
                    found[f"{node.name}.{part.name}"] = part
    return found


def test_stubs_are_those_of_the_module():
    stubs = stub()
    there = {}
    for name, value in vars(_pinode).items():
        if name.startswith("_"):
            continue
        there[name] = value
        if inspect.isclass(value) and name != "Error":
            there.update({f"{name}.{part}": getattr(value, part) for part in vars(value)
                          if not part.startswith("_")})
    assert set(stubs) == set(there)
    for name, value in there.items():
        node, text = stubs[name], getattr(value, "__doc__", None) or ""
        if isinstance(node, ast.FunctionDef) and "(" in text and "->" in text:
            arguments = [a.arg for a in node.args.args]
            assert [a for a in arguments if a != "self"] == [
                a for a in signatures(text) if a != "self"], name


def test_modules_that_are_read_when_asked_for_are_known_to_type_checkers():
    tree = ast.parse((PACKAGE / "__init__.py").read_text())
    known = {alias.name for node in tree.body
             if isinstance(node, ast.If) and ast.unparse(node.test) == "TYPE_CHECKING"
             for part in node.body if isinstance(part, ast.ImportFrom) and part.level == 1
             for alias in part.names}
    assert known == set(pinode.MODULES)
    for name in known:
        assert inspect.ismodule(getattr(pinode, name))
    assert pinode.__getattr__.__annotations__["return"] == "ModuleType"


def test_what_is_public_is_described():
    assert (PACKAGE / "py.typed").exists()
    for name in pinode.__all__:
        value = getattr(pinode, name)
        if name == "__version__":
            continue
        assert value.__doc__ or name == "Error", name
        if inspect.isclass(value) and value.__module__.startswith("pinode."):
            for part, what in vars(value).items():
                if inspect.isfunction(what) and not part.startswith("_"):
                    assert what.__annotations__.get("return") is not None, (name, part)


# Of the way from a case to a fit, nothing to be called.
INTERNAL = {"progress.watched", "measurements.rate_from"}


def test_what_has_a_public_name_is_public():
    """In the package itself, or in a module that it has: these are what the site tells of."""
    apart = []
    for path in PACKAGE.glob("[a-z]*.py"):
        if path.stem not in pinode.MODULES:
            module = importlib.import_module(f"pinode.{path.stem}")
            apart += [f"{path.stem}.{name}" for name, value in vars(module).items()
                      if inspect.isclass(value) or inspect.isfunction(value)
                      if value.__module__ == module.__name__ and not name.startswith("_")
                      if name not in pinode.__all__]
    assert set(apart) == INTERNAL
    for name in pinode.MODULES:
        assert inspect.ismodule(getattr(pinode, name)) and getattr(pinode, name).__doc__


def functions_of(kind):
    """(name, function) of the public parts of a class, those of its bases here too."""
    for base in kind.__mro__:
        if not base.__module__.startswith("pinode."):
            continue
        for name, part in vars(base).items():
            if name.startswith("_"):
                continue
            part = getattr(part, "__func__", getattr(part, "fget", getattr(part, "func", part)))
            if inspect.isfunction(part):
                yield name, part


def without_docstring(module):
    """Names of public functions, classes, methods and properties that are made there."""
    if not module.__doc__:
        yield module.__name__
    for name, value in vars(module).items():
        if name.startswith("_") or getattr(value, "__module__", None) != module.__name__:
            continue
        if inspect.isclass(value):
            if not vars(value).get("__doc__"):
                yield name
            yield from (f"{name}.{part}" for part, what in functions_of(value)
                        if not what.__doc__)
        elif inspect.isfunction(value) and not value.__doc__:
            yield name


def test_all_that_is_public_has_a_docstring():
    names = [p.stem for p in PACKAGE.glob("*.py") if not p.stem.startswith("_")]
    assert len(names) > 10
    missing = {name: list(without_docstring(importlib.import_module(f"pinode.{name}")))
               for name in names}
    assert not {name: found for name, found in missing.items() if found}


def test_a_missing_docstring_is_seen():
    module = types.ModuleType("pinode.example", "An example.")
    exec(textwrap.dedent("""
        import functools
        class _Base:
            def of_base(self): pass
        class Kind(_Base):
            @property
            def one(self): pass
            @functools.cached_property
            def two(self): pass
            @classmethod
            def three(cls): pass
            @staticmethod
            def four(): pass
            def said(self):
                "Is said."
        def function(): pass
        """), vars(module))
    assert set(without_docstring(module)) == {
        "Kind", "Kind.of_base", "Kind.one", "Kind.two", "Kind.three", "Kind.four", "function"}


PAGES = [str(page.relative_to(SOURCE)) for folder in (".", "pinode", "pinode/*", "data", "tests")
         for page in sorted(SOURCE.glob(f"{folder}/*.md")) if "```python" in page.read_text()]


def test_ten_lines_are_ten():
    text = (SOURCE / "README.md").read_text()
    before, block = re.search(r"(.*?)```python\n(.*?)```", text, re.DOTALL).groups()
    assert "in ten lines of Python" in before
    assert len([line for line in block.splitlines() if line.strip()]) == 10


@pytest.mark.parametrize("page", PAGES)
def test_python_of_the_documentation_runs(page, tmp_path, monkeypatch, capsys):
    text = (SOURCE / page).read_text()
    blocks = re.findall(r"```python\n(.*?)```", text, re.DOTALL)
    assert blocks
    monkeypatch.chdir(tmp_path)
    os.symlink(SOURCE / "data", tmp_path / "data")
    names = {}
    for block in blocks:
        exec(compile(block, page, "exec"), names)
    printed = capsys.readouterr().out
    assert printed
    if page == "pinode/python/README.md":
        # "-0.1 is a tenth less", it says beside the first result and the last.
        verdict, change = printed.splitlines()[0].split()
        assert verdict == "good"
        assert float(change) == pytest.approx(-0.1, abs=0.002)
        assert names["fit"]["k1"] == pytest.approx(-0.1, abs=0.002)
