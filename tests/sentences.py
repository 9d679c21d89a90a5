"""Sentences of a document, for documents_test.py: how many are long.

    tests/sentences.py PAGE...

Prints the sentences of more than 25 words of some pages, and their share.
A cell of a table and an item of a list is a sentence by itself. What stands
between backquotes is one word. Headings, code and comments do not count.
"""

import json
import pathlib
import re
import sys

MOST_WORDS = 25
# Fewer words are a label.
FEWEST_WORDS = 3

ITEM = re.compile(r"^\s*(?:[-*]|\d+\.)\s+")


def text_of(path):
    text = path.read_text(encoding="utf-8")
    if path.suffix != ".ipynb":
        return text
    return "\n\n".join("".join(cell["source"]) for cell in json.loads(text)["cells"]
                       if cell["cell_type"] == "markdown")


def passages(text):
    """Paragraphs, items and cells, each in one line."""
    text = re.sub(r"<!--.*?-->", "", text, flags=re.DOTALL)
    text = re.sub(r"^ *```.*?^ *```$", "", text, flags=re.DOTALL | re.MULTILINE)
    paragraph = []
    for line in [*text.split("\n"), ""]:
        is_code = line.startswith("    ") and not paragraph
        is_row = line.lstrip().startswith("|")
        if (not line.strip() or is_code or is_row or line.startswith("#")
                or ITEM.match(line)):
            yield " ".join(paragraph)
            paragraph = []
        if is_row:
            yield from (cell.strip() for cell in re.split(r"(?<!\\)\|", line))
        elif line.strip() and not is_code and not line.startswith("#"):
            paragraph.append(ITEM.sub("", line).strip())


def sentences(path):
    """(number of words, sentence) of each."""
    for passage in passages(text_of(path)):
        plain = re.sub(r"!?\[([^\]]*)\]\([^)]*\)", r"\1", passage)
        plain = re.sub(r"`[^`]*`", "CODE", plain).replace("*", "")
        for sentence in re.split(r"(?<=[.!?:])\s+(?=[A-Z\"(\d])", plain):
            words = sum(1 for word in sentence.split() if re.search(r"\w", word))
            if words >= FEWEST_WORDS:
                yield words, sentence


def main():
    count = long = 0
    for name in sys.argv[1:]:
        for words, sentence in sentences(pathlib.Path(name)):
            count += 1
            if words > MOST_WORDS:
                long += 1
                print(f"{name}: {words} words: {sentence}")
    print(f"{long} of {count} sentences have more than {MOST_WORDS} words: "
          f"{100.0 * long / max(count, 1):.1f} %")


if __name__ == "__main__":
    main()
