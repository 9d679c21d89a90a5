#!/usr/bin/env python3
"""Results that documents print, compared with runs.

    tests/printed_results_test.py ROOT                     every printed block has its place in this test
    tests/printed_results_test.py ROOT PROGRAMS PAGE...    the commands of pages are run, results compared
    tests/printed_results_test.py ROOT --program=NAME FILE PAGE
                                                           what NAME has printed (FILE) and what the page prints

PROGRAMS is the folder of the programs. Pages are run in one new folder, in
their order, with `data` of the project in it.

An indented block is a command, if it begins with a program, and otherwise what
the command above it prints. `...` stands for lines, or within a line for words,
that are left out. Words and numbers of one digit are the same; other numbers
differ by 1 % or by one and a half of the last digit, at most. Columns may be
wider. Comments of the page say what else is done:

    <!-- save as FILE -->                the next code block is the file; `append to FILE`: its end
    <!-- in FILE: OLD => NEW -->         in the file, each OLD is now NEW (\\n: a new line)
    <!-- in FILE without KEY -->         lines that begin with KEY are left out
    <!-- part of FILE -->                lines of the next code block are in the file, in their order
    <!-- names in FILE -->               names in quotes in the next block are in the file, a JSON file
    <!-- run: COMMAND -->                a command that the page does not show
    <!-- not run: REASON -->             the next command is not run
    <!-- status 1 -->                    exit status of the next command, 0 unless said
    <!-- printed by NAME -->             what a C++ program of the page prints (tests/install_test.sh)
    <!-- not compared: REASON -->        the next block is no result, or cannot be compared

Prints `page:line: what, and what was expected` for each that is not so and
exits 1.
"""

import os
import pathlib
import re
import subprocess
import sys
import tempfile

# Pages whose indented blocks are equations, or commands that are long or build
# the project.
PAGES_WITHOUT_RESULTS = {
    "CHANGELOG.md": "no results",
    "CONTRIBUTING.md": "commands of developers",
    "tests/README.md": "commands of developers",
    "tests/benchmarks/README.md": "times of one machine",
}
FOLDERS_WITHOUT_RESULTS = {
    "pinode/theory": "equations",
    "third_party_notes": "licences",
    "tests/floors_fixture": "no document",
}
COMMAND = re.compile(r"(?:if )?(?:pinode_\w+|apps/|tests/|cmake |ctest |cd |python3 |v/bin/|c\+\+ |for |done\b|mpirun )")
# Digits of a name, such as k1, are no number.
NUMBER = re.compile(r"(?<![\w.])[-+]?\d+(?:\.\d*)?(?:[eE][-+]?\d+)?")
DIRECTIVE = re.compile(r"^<!-- (.*) -->$")


class Block:
    """Lines of a page: kind is `fence`, `command`, `result` or `directive`."""

    def __init__(self, kind, line, lines):
        self.kind, self.line, self.lines = kind, line, lines


def blocks_of(path):
    blocks, fence, paragraph = [], None, None
    listed = False
    for number, line in enumerate(path.read_text().splitlines(), 1):
        if re.match(r" *```", line):
            if fence is None:
                fence = Block("fence", number, [])
            else:
                blocks.append(fence)
                fence = None
            paragraph = None
        elif fence is not None:
            fence.lines.append(line)
        elif DIRECTIVE.match(line):
            blocks.append(Block("directive", number, [DIRECTIVE.match(line)[1]]))
            paragraph = None
        elif line.startswith("    ") and not listed:
            if paragraph is None:
                kind = "command" if COMMAND.match(line.strip()) else "result"
                paragraph = Block(kind, number, [])
                blocks.append(paragraph)
            paragraph.lines.append(line[4:])
        else:
            # Indented lines below an item of a list are its text.
            listed = bool(re.match(r" *([-*]|\d+\.) ", line)) or (listed and line.startswith("  "))
            paragraph = None
    return blocks


def same_number(expected, actual):
    difference = abs(float(expected) - float(actual))
    if re.fullmatch(r"[-+]?\d", expected):  # a count, or the number of a mode
        return difference == 0.0
    digits, _, exponent = expected.lower().partition("e")
    unit = 10.0 ** (int(exponent or 0) - len(digits.partition(".")[2]))
    return difference <= max(1.5 * unit, 0.01 * abs(float(expected)))


def same_word(expected, actual):
    if expected == actual or (set(expected) == set(actual) == {"-"}):
        return True
    if NUMBER.split(expected) != NUMBER.split(actual):
        return False
    return all(map(same_number, NUMBER.findall(expected), NUMBER.findall(actual)))


def same_words(expected, actual):
    return len(expected) == len(actual) and all(map(same_word, expected, actual))


def same_line(expected, actual):
    """Words of a line, with `...` for any number of them."""
    parts, part = [], []
    for word in expected.split():
        if word == "...":
            parts.append(part)
            part = []
        else:
            part.append(word)
    parts.append(part)
    words = actual.split()
    if len(parts) == 1:
        return same_words(parts[0], words)
    first, *middle, last = parts
    if not same_words(first, words[:len(first)]):
        return False
    at = len(first)
    for part in middle:
        at = next((i + len(part) for i in range(at, len(words) - len(part) + 1)
                   if same_words(part, words[i:i + len(part)])), None)
        if at is None:
            return False
    return at + len(last) <= len(words) and (not last or same_words(last, words[-len(last):]))


def missing_line(expected, printed):
    """The number of the first expected line that `printed` does not have in its place, or None."""
    actual = [line for line in printed.splitlines() if line.strip()]

    def matches(lines, at, anywhere):
        """How many of `lines` are found, at best."""
        if not lines:
            return 0
        if lines[0][1].strip() == "...":
            return 1 + matches(lines[1:], at, True)
        best = 0
        for place in range(at, len(actual) if anywhere else min(at + 1, len(actual))):
            if same_line(lines[0][1], actual[place]):
                best = max(best, 1 + matches(lines[1:], place + 1, False))
                if best == len(lines):
                    break
        return best

    lines = [(i, line) for i, line in enumerate(expected) if line.strip()]
    found = matches(lines, 0, True)
    return None if found == len(lines) else lines[found][0]


class Runner:
    def __init__(self, root, programs, folder):
        self.root, self.folder = root, folder
        self.environment = {**os.environ, "PATH": f"{programs}:{os.environ['PATH']}", "LC_ALL": "C.UTF-8"}
        self.failures, self.compared = [], 0

    def fail(self, page, block, message, offset=0):
        self.failures.append(f"{page}:{block.line + offset}: {message}")

    def run(self, page):
        self.printed, self.status, self.next_block = None, 0, None
        for block in blocks_of(self.root / page):
            try:
                getattr(self, block.kind)(page, block)
            except OSError as error:
                self.fail(page, block, str(error))

    def directive(self, page, block):
        text = block.lines[0]
        for pattern, action in [(r"(save as|append to|part of|names in) (\S+)", self.keep),
                                (r"(not compared|not run|printed by):? (.+)", self.keep),
                                (r"in (\S+): (.+) => (.+)", self.replace),
                                (r"in (\S+) without (\S+)", self.leave_out),
                                (r"status (\d)", lambda *a: setattr(self, "status", int(a[2]))),
                                (r"run: (.+)", lambda *a: self.start(page, block, a[2]))]:
            match = re.fullmatch(pattern, text)
            if match:
                action(page, block, *match.groups())
                return
        if not text.startswith(("keys of", "end of keys")):
            self.fail(page, block, f"'{text}' says nothing to this test")

    def keep(self, page, block, what, value):
        self.next_block = (what, value)

    def replace(self, page, block, file, old, new):
        path = self.folder / file
        text = path.read_text()
        if old not in text:
            self.fail(page, block, f"'{old}' is not in {file}")
        path.write_text(text.replace(old, new.replace("\\n", "\n")))

    def leave_out(self, page, block, file, key):
        path = self.folder / file
        lines = path.read_text().splitlines(keepends=True)
        kept = [line for line in lines if not line.startswith(key)]
        if len(kept) == len(lines):
            self.fail(page, block, f"no line of {file} begins with '{key}'")
        path.write_text("".join(kept))

    def fence(self, page, block):
        what, file = self.next_block or (None, None)
        self.next_block = None
        text = "\n".join(block.lines) + "\n"
        if what == "save as":
            (self.folder / file).write_text(text)
        elif what == "append to":
            with open(self.folder / file, "a") as end:
                end.write("\n" + text)
        elif what == "part of":
            self.compared += 1
            there = iter((self.folder / file).read_text().splitlines())
            for i, line in enumerate(block.lines):
                if line.strip() and not any(same_line(line, other) for other in there):
                    self.fail(page, block, f"{file} has no line '{line}' there", i + 1)
                    break

    def command(self, page, block):
        kept, self.next_block = self.next_block, None
        if kept is not None and kept[0] == "not run":
            return
        for line in block.lines:
            self.start(page, block, line)

    def start(self, page, block, line):
        done = subprocess.run(["bash", "-c", line], cwd=self.folder, env=self.environment, text=True,
                              stdin=subprocess.DEVNULL, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, timeout=1500)
        if done.returncode != self.status:
            self.fail(page, block, f"'{line}' ends with status {done.returncode}, expected "
                      f"{self.status}:\n{done.stdout[-1000:]}")
        self.printed, self.status = done.stdout, 0

    def result(self, page, block):
        kept, self.next_block = self.next_block, None
        if kept is not None and kept[0] in ("not compared", "printed by"):
            return
        self.compared += 1
        if kept is not None and kept[0] == "names in":
            self.names(page, block, kept[1])
            return
        if self.printed is None:
            self.fail(page, block, "no command has printed this")
            return
        offset = missing_line(block.lines, self.printed)
        if offset is not None:
            self.fail(page, block, f"'{block.lines[offset]}' is not printed there, expected what the command "
                      f"prints:\n{self.printed}", offset)


    def names(self, page, block, file):
        there = set(re.findall(r'"([^"]*)"', (self.folder / file).read_text()))
        # Names with a number stand for others, as those of DOFs and groups.
        named = {name for name in re.findall(r'"([a-z_]+|\w+95)"', "\n".join(block.lines))}
        for name in sorted(named - there):
            self.fail(page, block, f"{file} has no '{name}'")


# Expected lines, printed text, and True if they agree.
COMPARISONS = [
    (["k1  0.2530  0.0040"], "Parameters\n  k1    0.25301  0.00402\n", True),
    (["k1  0.2530  0.0040"], "k1 0.2571 0.0040", False),
    (["k1  0.2530"], "k2 0.2530", False),
    (["x[u]^3"], "x[u]^2", False),
    (["3 modes were found"], "4 modes were found", False),
    (["k1  0.2530"], "k1 0.2530 1/s", False),
    (["k1  0.2530"], "k1 -0.2530", False),
    (["-----  --"], "---  -------", True),
    (["1.996e+09 to 2.004e+09"], "2.0e+09 to 2.0e+09", True),
    (["1.996e+09"], "1.996e+08", False),
    (["a 1", "c 3"], "a 1\nb 2\nc 3\n", False),
    (["a 1", "...", "c 3"], "a 1\nb 2\nc 3\n", True),
    (["a 1", "...", "c 3"], "c 3\nb 2\na 1\n", False),
    (["Damage: ... lost stiffness."], "Damage: k1 (-10 %) lost stiffness.", True),
    (["Damage: ... lost stiffness."], "Damage: k1 (-10 %) lost mass.", False),
    (["k1 (-10 %)"], "k1 (-12 %)", False),
    (["k1 (-10 %)"], "k1 (-11 %)", True),
]


def pages_in(root):
    for path in sorted(root.rglob("*.md")):
        page = str(path.relative_to(root))
        if not page.startswith(("build", ".")) and page not in PAGES_WITHOUT_RESULTS and \
                not any(page.startswith(folder + "/") for folder in FOLDERS_WITHOUT_RESULTS):
            yield page


def run_pages(root):
    """Pages that tests/CMakeLists.txt gives to this test."""
    lists = (root / "tests" / "CMakeLists.txt").read_text()
    return set(re.findall(r"[\w/.]+\.md", lists))


def check_places(root):
    """Every result is below a command of a page that is run, or its comment says otherwise."""
    failures, results, reasons = [], 0, []
    for expected, printed, same in COMPARISONS:
        if (missing_line(expected, printed) is None) != same:
            failures.append(f"{expected} and {printed!r}: expected them to be {'the same' if same else 'different'}")
    for page in pages_in(root):
        is_run, above = page in run_pages(root), None
        for block in blocks_of(root / page):
            if block.kind == "directive":
                above = block.lines[0]
                continue
            if block.kind == "result":
                results += 1
                reason = re.match(r"(not compared|printed by|names in)\b", above or "")
                if reason and reason[1] == "not compared":
                    reasons.append(f"{page}:{block.line}: {above}")
                elif not is_run and not reason:
                    failures.append(f"{page}:{block.line}: a printed result, and nothing compares it; expected the page "
                                    "in tests/CMakeLists.txt, or a comment that says why not")
            above = None
    if results == 0:
        failures.append("no printed result was found")
    return failures, f"{results} printed results; not compared:\n" + "\n".join(reasons)


def check_program(root, name, file, page):
    printed, failures, above = pathlib.Path(file).read_text(), [], None
    compared = 0
    for block in blocks_of(root / page):
        if block.kind == "result" and above == f"printed by {name}":
            compared += 1
            offset = missing_line(block.lines, printed)
            if offset is not None:
                failures.append(f"{page}:{block.line + offset}: '{block.lines[offset]}' is not printed there, expected "
                                f"what {name} prints:\n{printed}")
        above = block.lines[0] if block.kind == "directive" else None
    if compared == 0:
        failures.append(f"{page} prints nothing of {name}")
    return failures, f"{compared} results of {name}"


def main():
    root = pathlib.Path(sys.argv[1]).resolve()
    if len(sys.argv) == 2:
        failures, done = check_places(root)
    elif sys.argv[2].startswith("--program="):
        failures, done = check_program(root, sys.argv[2].partition("=")[2], *sys.argv[3:])
    else:
        with tempfile.TemporaryDirectory() as folder:
            os.symlink(root / "data", pathlib.Path(folder) / "data")
            runner = Runner(root, pathlib.Path(sys.argv[2]).resolve(), pathlib.Path(folder))
            for page in sys.argv[3:]:
                runner.run(page)
        failures, done = runner.failures, f"{runner.compared} results compared"
        if runner.compared == 0:
            failures.append("nothing was compared")
    print("\n".join(failures) or done)
    sys.exit(bool(failures))


if __name__ == "__main__":
    main()
