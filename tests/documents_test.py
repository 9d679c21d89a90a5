#!/usr/bin/env python3
"""Every link and every code block of the project's documents, and the text of
its notebooks (their code is run by the test python.tutorials).

    tests/documents_test.py ROOT

Links: the file is there, and so is the heading after `#`. Code blocks, by their
language: cpp is built by tests/consumer (only pages that it is given have any),
python is run by the test python.package, matlab by programs.octave (only the
page that it is given has any), toml and json are read here, and of cmake the
targets are there. Of command lines, in indented blocks and between
backquotes: programs, their flags, scripts and presets are there. Every program
is in the tables of README.md and apps/README.md. Files that have to name the
version themselves have the one that CMakeLists.txt sets.

Of the sentences in the pages that a user reads first, at most 5 % have more
than 25 words (tests/sentences.py lists them).

Prints `file:line: what, and what was expected` for each that is not so and
exits 1.
"""

import json
import pathlib
import re
import sys
import tomllib

from sentences import MOST_WORDS, sentences

# Pages whose C++ tests/install_test.sh builds, and whose Python
# pinode/python/tests/package_test.py runs.
CPP_PAGES = ["README.md", "pinode/README.md"]
# The one whose MATLAB tests/programs/octave_test.sh runs.
MATLAB_PAGE = "pinode/matlab.md"

# The project's version is set in CMakeLists.txt. The formats of these files have it
# once more.
VERSIONS = {
    "CITATION.cff": r"^version: (\S+)",
    "pinode/cmake/conda/meta.yaml": r'set version = "(.*?)"',
    "pinode/cmake/vcpkg/vcpkg.json": r'^  "version": "(.*?)"',
    "CHANGELOG.md": r"^## (\d\S*)",
}

# The pages of a new user, and the largest share of long sentences there. It is
# 0.6 % where the tables of keys are and less elsewhere (28 November 2026).
FIRST_PAGES = ["README.md", "pinode/case/*.md", "pinode/case/first_case/*.md",
               "pinode/when_a_fit_does_not_work.md", "pinode/python/README.md",
               "pinode/coming_from.md", "pinode/python/tutorials/*.ipynb"]
MOST_LONG = 0.05

FENCE = re.compile(r"^ *```(\S*)")
LINK = re.compile(r"(?<!\\)\[[^\]]*\]\(([^()\s]+(?:\([^()]*\))?)\)")
# Words before a program's name may be variables or a launcher.
PROGRAM = re.compile(r"\b(pinode_(?:app|new|check|simulate|update|discover|damage|modes|watch))((?:[ =][^`;|]*)?)")
FLAG = re.compile(r"(?<![\w-])--([a-z_]+)")


def documents(root):
    for path in sorted([*root.rglob("*.md"), *root.rglob("*.ipynb")]):
        parts = path.relative_to(root).parts
        if parts[0].startswith(("build", ".")) or "floors_fixture" in parts:
            continue
        yield path


def slug(heading):
    """The name that a heading has for links, as GitHub and MyST make it."""
    text = re.sub(r"\[([^\]]*)\]\([^)]*\)", r"\1", heading)
    text = re.sub(r"[`*]", "", text.strip().lower())
    return re.sub(r"[^\w\- ]", "", text).replace(" ", "-")


def lines_of(path):
    """(line number, text) of a document; of a notebook its cells of text, and the
    lines of the file that they stand in."""
    lines = list(enumerate(path.read_text().splitlines(), 1))
    if path.suffix != ".ipynb":
        return lines
    found, rest = [], iter(lines)
    for cell in json.loads(path.read_text())["cells"]:
        for text in cell["source"]:
            quoted = [json.dumps(text, ensure_ascii=plain) for plain in (False, True)]
            number = next((n for n, line in rest if line.strip().rstrip(",") in quoted), 0)
            if cell["cell_type"] == "markdown":
                found.append((number, text.rstrip("\n")))
    return found


class Page:
    """Lines of a document by what they are: blocks, and text with its line numbers."""

    def __init__(self, path):
        self.path = path
        self.blocks = []  # (first line, language, text)
        self.text = []    # (line, text) outside of fences
        self.anchors = set()
        language, begun, block = None, 0, []
        for number, line in lines_of(path):
            fence = FENCE.match(line)
            if fence and language is None:
                language, begun, block = fence[1], number, []
            elif fence:
                self.blocks.append((begun, language, "\n".join(block) + "\n"))
                language = None
            elif language is not None:
                block.append(line)
            else:
                self.text.append((number, line))
                if re.match(r"#+ ", line):
                    self.anchors.add(slug(line.lstrip("#")))
        if language is not None:
            self.blocks.append((begun, "unclosed", ""))


def own_flags(root):
    """{program: flags} of what apps/ defines."""
    def defined(path):
        return set(re.findall(r"^DEFINE_\w+\(\s*(\w+)", path.read_text(), re.M))

    flags = {}
    for path in (root / "apps").glob("pinode_*.cc"):
        shared = {"help", "version", "v", "vmodule"}
        for every in ("program.cc", "ranks.cc"):
            shared |= defined(root / "apps" / every)
        if re.search(r'"apps/fit_flags.h"|^DECLARE_string\(case\)', path.read_text(), re.M):
            shared |= defined(root / "apps" / "fit_flags.cc")
        if '"apps/deck_flag.h"' in path.read_text():
            shared |= defined(root / "apps" / "deck_flag.cc")
        flags[path.stem] = shared | defined(path)
    return flags


def presets(root):
    tree = json.loads((root / "CMakePresets.json").read_text())
    return {p["name"] for kind in ("configurePresets", "buildPresets", "testPresets")
            for p in tree[kind]}


class Checker:
    def __init__(self, root):
        self.root = root
        self.pages = {path: Page(path) for path in documents(root)}
        self.flags = own_flags(root)
        self.presets = presets(root)
        self.floors = {p.parent.name for p in (root / "pinode").glob("*/CMakeLists.txt")}
        self.failures = []
        self.checked = {"links": 0, "blocks": 0, "commands": 0, "notebooks": 0,
                        "sentences": 0}
        self.long_sentences = 0

    def fail(self, page, line, message):
        self.failures.append(f"{page.path.relative_to(self.root)}:{line}: {message}")

    def run(self):
        self.programs()
        self.versions()
        self.sentences()
        for page in self.pages.values():
            self.checked["notebooks"] += page.path.suffix == ".ipynb"
            for line, language, text in page.blocks:
                self.checked["blocks"] += 1
                self.block(page, line, language, text)
            for line, text in page.text:
                for target in LINK.findall(re.sub(r"`[^`]*`", "", text)):
                    self.checked["links"] += 1
                    self.link(page, line, target)
                if text.startswith("    "):
                    self.command(page, line, text)
                for quoted in re.findall(r"`([^`]+)`", text):
                    self.command(page, line, quoted)

    def sentences(self):
        """Few of them are long."""
        for pattern in FIRST_PAGES:
            for path in sorted(self.root.glob(pattern)):
                words = [count for count, _ in sentences(path)]
                long = sum(count > MOST_WORDS for count in words)
                self.checked["sentences"] += len(words)
                self.long_sentences += long
                if long > max(MOST_LONG * len(words), 1):
                    self.fail(self.pages[path], 1,
                              f"{long} of {len(words)} sentences have more than {MOST_WORDS} "
                              f"words, expected {100 * MOST_LONG:.0f} % at most; "
                              "tests/sentences.py lists them")

    def programs(self):
        """Each has a sample run, and the project's README says what it is for."""
        for name in ("README.md", "apps/README.md"):
            page = self.pages[self.root / name]
            for program in self.flags:
                if not any(re.match(rf"\| `{program}[` ]", text) for _, text in page.text):
                    self.fail(page, 1, f"{program} is in no table")

    def versions(self):
        """No file names another version than the one that CMake builds."""
        version = re.search(r"project\(pinode VERSION (\S+)", (self.root / "CMakeLists.txt").read_text())[1]
        for name, pattern in VERSIONS.items():
            named = re.search(pattern, (self.root / name).read_text(), re.M)
            if named is None or named[1] != version:
                self.failures.append(f"{name}: version {named and named[1]}, expected {version}")

    def link(self, page, line, target):
        if re.match(r"https?://", target):
            if not re.fullmatch(r"https?://[\w.-]+\.[a-z]{2,}(:\d+)?(/\S*)?", target):
                self.fail(page, line, f"'{target}' is no address")
            return
        path, _, anchor = target.partition("#")
        file = (page.path.parent / path).resolve() if path else page.path
        if not file.exists():
            self.fail(page, line, f"link to '{path}', expected a file that is there")
        elif anchor:
            there = self.pages.get(file)
            if there is None or anchor not in there.anchors:
                self.fail(page, line, f"'{target}': there is no such heading")

    def block(self, page, line, language, text):
        name = str(page.path.relative_to(self.root))
        if language == "cpp":
            if name not in CPP_PAGES:
                self.fail(page, line, f"C++ that nobody builds, expected it in {CPP_PAGES}")
            elif not text.startswith("#include"):
                self.fail(page, line, "C++ without its includes")
        elif language == "python":
            try:
                compile(text, name, "exec")
            except SyntaxError as error:
                self.fail(page, line, f"Python: {error}")
        elif language in ("toml", "json"):
            try:
                tomllib.loads(text) if language == "toml" else json.loads(text)
            except ValueError as error:
                self.fail(page, line, f"{language}: {error}")
        elif language == "cmake":
            for floor in re.findall(r"\bpinode::(\w+)", text):
                if floor not in self.floors | {"pinode", "shared"}:
                    self.fail(page, line, f"pinode::{floor} is no target")
        elif language == "matlab":
            if name != MATLAB_PAGE:
                self.fail(page, line, f"MATLAB that nobody runs, expected it in {MATLAB_PAGE}")
        else:
            self.fail(page, line, f"a block of '{language}', which nothing checks")

    def command(self, page, line, text):
        for program, arguments in PROGRAM.findall(text):
            self.checked["commands"] += 1
            for flag in FLAG.findall(arguments):
                flags = self.flags[program]
                if flag not in flags and flag.removeprefix("no") not in flags:
                    self.fail(page, line, f"{program} has no flag --{flag}")
        for preset in re.findall(r"--preset[ =]([\w-]+)", text):
            if preset not in self.presets:
                self.fail(page, line, f"there is no preset '{preset}'")
        for script in re.findall(r"(?:^|\s)((?:tests|apps|data|pinode)/[\w/.-]+\.(?:sh|py))\b", text):
            self.checked["commands"] += 1
            if not any((base / script).exists() for base in (self.root, page.path.parent)):
                self.fail(page, line, f"there is no {script}")


def main():
    checker = Checker(pathlib.Path(sys.argv[1]).resolve())
    checker.run()
    if min(checker.checked.values()) == 0:
        sys.exit(f"nothing to check: {checker.checked}")
    print("\n".join(checker.failures) or 
          f"checked: {checker.checked}, long sentences: {checker.long_sentences}")
    sys.exit(bool(checker.failures))


if __name__ == "__main__":
    main()
