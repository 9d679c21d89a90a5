"""Lays the project's documents out for Sphinx.

    stage.py [--tutorials=NAME,...] [--reports=NAME,...] ROOT BUILD SOURCE

SOURCE gets the documents in the folders that they have in ROOT, so that their
links hold, beside the files that they link to; landing.md becomes the index.
Reports of the gallery are made by the programs of BUILD. Tutorials are run, all or those that are named (the others stay as they are), and
become pages with their figures. There is a page of C++ for each floor.
"""

import argparse
import os
import pathlib
import re
import shutil

import benchmark_figure
import nbconvert
import nbformat
import pinode
import reports
from nbconvert.preprocessors import ExecutePreprocessor

TUTORIALS = pathlib.Path("pinode/python/tutorials")
LANDING = pathlib.Path("pinode/site/landing.md")
GALLERY = pathlib.Path("pinode/site/gallery.md")
# Sections of the index, in their order: title, pages.
CONTENTS = [
    ("Use", ["Start <README>", "pinode/site/gallery", "pinode/case/first_case/README", "pinode/case/recipes", "pinode/case/README",
             "pinode/case/security", "pinode/watch/README",
             "pinode/python/README", "tutorials", "pinode/coming_from", "pinode/matlab", "pinode/when_a_fit_does_not_work",
             "apps/README"]),
    ("Method", ["pinode/theory/README", "pinode/scaling", "data/README", "tests/benchmarks/README"]),
    ("Reference", ["pinode/README", "api_python", "api_cpp", "tests/README",
                   "third_party_notes/README", "CONTRIBUTING", "tests/packages/PUBLISHING", "CHANGELOG"]),
]
LINK = re.compile(r"\]\(([^()\s#]+)((?:#[^()\s]*)?)\)")


def is_address(target):
    return re.match(r"\w+://", target) is not None


def toctree(title, pages, **options):
    lines = "".join(f":{name}: {value}\n" for name, value in options.items())
    return f"\n```{{toctree}}\n:caption: {title}\n{lines}\n" + "\n".join(pages) + "\n```\n"


def as_seen(text):
    """What a terminal shows in the end of lines that were written over."""
    return "\n".join(line.rstrip("\r").split("\r")[-1].rstrip() for line in text.split("\n"))


def for_a_page(outputs):
    """Outputs of a cell as they fit into Markdown."""
    shown = []
    # A progress bar is written piece by piece, and leaves nothing.
    for name in ("stderr", "stdout"):
        text = as_seen("".join(o.text for o in outputs
                               if o.output_type == "stream" and o.name == name))
        if text.strip():
            shown.append({"text/plain": text})
    shown += [o.data for o in outputs if o.output_type in ("display_data", "execute_result")]
    for data in shown:
        # In Markdown HTML ends at the first empty line.
        if data.get("text/html", "").startswith("<iframe"):
            data["text/html"] = data["text/html"].replace("\n", "&#10;")
        elif set(data) == {"text/plain"}:
            text = data["text/plain"].strip("\n")
            data["text/markdown"] = f"````{{code-block}} none\n:class: output\n\n{text}\n````"
    return [nbformat.v4.new_output("display_data", data) for data in shown]


class Stage:
    def __init__(self, root, source, to_run):
        """to_run: names of the tutorials, None for all."""
        self.root, self.source, self.to_run = root, source, to_run

    def linked(self, page, text):
        """`text` with links to what the site has; files are laid beside it."""
        def replace(match):
            target, anchor = match[1], match[2]
            if is_address(target):
                return match[0]
            file = pathlib.Path(os.path.normpath(page.parent / target))
            if file == TUTORIALS:
                target = os.path.relpath("tutorials.md", page.parent)
            elif (self.root / file).is_dir():
                target = os.path.join(target, "README.md")
            elif file.suffix == ".ipynb":
                target = target.removesuffix(".ipynb") + ".md"
            elif file.suffix != ".md":
                self.copy(file)
            return f"]({target}{anchor})"

        return LINK.sub(replace, text)

    def copy(self, file):
        to = self.source / file
        to.parent.mkdir(parents=True, exist_ok=True)
        shutil.copyfile(self.root / file, to)

    def write(self, page, text):
        to = self.source / page
        to.parent.mkdir(parents=True, exist_ok=True)
        to.write_text(text)

    def documents(self):
        for path in sorted(self.root.rglob("*.md")):
            page = path.relative_to(self.root)
            if page.parts[0].startswith(("build", ".")) or "floors_fixture" in page.parts:
                continue
            text = path.read_text()
            if page == LANDING:
                # Seen from the index, which has no folder.
                text = LINK.sub(lambda match: match[0] if is_address(match[1]) else
                                f"]({os.path.normpath(page.parent / match[1])}{match[2]})", text)
                page = pathlib.Path("index.md")
            text = self.linked(page, text)
            if page == benchmark_figure.PAGE:
                text = benchmark_figure.with_figure(text, self.source / page.parent)
            if page == pathlib.Path("index.md"):
                for title, pages in CONTENTS:
                    text += toctree(title, [p for p in pages if self.has(p)],
                                    hidden="", maxdepth=2)
            if page == pathlib.Path("third_party_notes/README.md"):
                notes = sorted(p.stem for p in path.parent.glob("*.md") if p.stem != "README")
                text += toctree("Libraries", notes, hidden="")
            if page == pathlib.Path("pinode/theory/README.md"):
                # In the order of its table.
                chapters = dict.fromkeys(re.findall(r"^\| \[.*\]\((\w+)\.md\)", text, re.M))
                text += toctree("Chapters", chapters, hidden="")
            if page == pathlib.Path("pinode/case/first_case/README.md"):
                pages = re.findall(r"^\| .*\]\((\w+)\.md\) \|$", text, re.M)
                text += toctree("Pages", pages, hidden="")
            self.write(page, text)

    def has(self, page):
        page = re.sub(r".*<(.*)>", r"\1", page)
        return (page in ("tutorials", "api_cpp", "api_python") or
                (self.root / f"{page}.md").exists())

    def tutorials(self):
        titles = []
        for path in sorted((self.root / TUTORIALS).glob("*.ipynb")):
            book = nbformat.read(path, as_version=4)
            page = TUTORIALS / path.with_suffix(".md").name
            folder = self.source / TUTORIALS
            folder.mkdir(parents=True, exist_ok=True)
            if self.to_run is None or path.stem in self.to_run:
                ExecutePreprocessor(timeout=600, kernel_name="python3").preprocess(
                    book, {"metadata": {"path": str(folder)}})
            for cell in book.cells:
                if cell.cell_type == "code":
                    cell.outputs = for_a_page(cell.outputs)
            text, resources = nbconvert.MarkdownExporter().from_notebook_node(book, {
                "output_files_dir": f"{path.stem}_files", "unique_key": path.stem})
            for name, data in resources.get("outputs", {}).items():
                file = folder / name
                file.parent.mkdir(parents=True, exist_ok=True)
                file.write_bytes(data)
            self.write(page, text)
            titles.append(str(page.with_suffix("")))
        self.write(pathlib.Path("tutorials.md"), "# Tutorials\n\nNotebooks, as they run.\n" +
                   toctree("Tutorials", titles, maxdepth=1))

    def cpp(self):
        pages = []
        for lists in sorted((self.root / "pinode").glob("*/CMakeLists.txt")):
            name = lists.parent.name
            # What is installed; the rest is machinery.
            listed = re.search(r"PUBLIC_HEADERS\n((?: +\S+\.h\n)+)", lists.read_text())
            if listed is None:
                continue
            text = f"# pinode/{name}\n"
            for header in listed.group(1).split():
                text += (f"\n## {header}\n\n```{{doxygenfile}} pinode/{name}/{header}\n"
                         ":project: pinode\n```\n")
            self.write(pathlib.Path(f"api/{name}.md"), text)
            pages.append(f"api/{name}")
        self.write(pathlib.Path("api_cpp.md"), "# C++\n\nThe public headers of each layer; what a layer "
                   "is, [pinode/README.md](pinode/README.md) says.\n" +
                   toctree("Layers", pages, maxdepth=1))

    def python(self):
        text = "# Python\n\nWhat [pinode/python/README.md](pinode/python/README.md) tells in words.\n"
        for module in ["pinode", *(f"pinode.{name}" for name in pinode.MODULES)]:
            text += (f"\n## {module}\n\n```{{eval-rst}}\n.. automodule:: {module}\n   :members:\n"
                     # Of bases that are not told of; those of Python's own are known.
                     "   :inherited-members: dict, tuple, Sequence, Mapping\n")
            # Its classes stand in modules that are nobody's business.
            text += "   :imported-members:\n```\n" if module == "pinode" else "```\n"
        self.write(pathlib.Path("api_python.md"), text)


def main():
    options = argparse.ArgumentParser()
    options.add_argument("--tutorials", type=lambda names: names.split(","))
    options.add_argument("--reports", type=lambda names: names.split(","))
    options.add_argument("root", type=pathlib.Path)
    options.add_argument("build", type=pathlib.Path)
    options.add_argument("source", type=pathlib.Path)
    chosen = options.parse_args()
    root, source = chosen.root, chosen.source
    stage = Stage(root, source, chosen.tutorials)
    own = root / "pinode" / "site"
    shutil.copyfile(own / "conf.py", source / "conf.py")
    (source / "_static").mkdir()
    shutil.copyfile(own / "site.css", source / "_static" / "site.css")
    shutil.copytree(own / "templates", source / "_templates")
    stage.documents()
    introduction = (root / GALLERY).read_text()
    stage.write(GALLERY, introduction + reports.gallery(
        root, chosen.build, source / "_static", chosen.reports))
    stage.tutorials()
    stage.cpp()
    stage.python()


if __name__ == "__main__":
    main()
