"""The package itself: what it reads when it is imported, its stubs, its
documentation."""

import ast
import inspect
import os
import pathlib
import re
import resource
import subprocess
import sys

import pytest

import pinode
from pinode import _pinode

SOURCE = pathlib.Path(os.environ["PINODE_SOURCE_DIR"])
PACKAGE = pathlib.Path(pinode.__file__).parent


def cpu_of(code):
    before = resource.getrusage(resource.RUSAGE_CHILDREN)
    subprocess.run([sys.executable, "-c", code], check=True)
    after = resource.getrusage(resource.RUSAGE_CHILDREN)
    return after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime


def test_import_is_quick_and_reads_no_more_than_numpy():
    code = ("import sys, pinode\n"
            "heavy = {'scipy', 'pandas', 'matplotlib', 'tqdm', 'hypothesis'}\n"
            "assert not heavy & set(sys.modules), heavy & set(sys.modules)")
    cpu_of(code)
    seconds = min(cpu_of(code) for _ in range(3)) - min(cpu_of("pass") for _ in range(3))
    print(f"import pinode: {seconds:.3f} s of CPU")
    assert seconds < 0.3


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


PAGES = [str(page.relative_to(SOURCE)) for folder in (".", "pinode", "pinode/*", "data", "tests")
         for page in sorted(SOURCE.glob(f"{folder}/*.md")) if "```python" in page.read_text()]


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
    assert capsys.readouterr().out
