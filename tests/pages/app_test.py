#!/usr/bin/env python3
"""The page of pinode_app in headless Chromium, by mouse and keys alone.

    tests/pages/app_test.py PROGRAM [FOLDER]

Two files of a logger are dropped on the page; floors, weights and places are
given; the case is checked and fitted; the later state is compared; and the
verdict names the storey that has lost stiffness. At 1280 and at 390 pixels of
width, where nothing is wider than the screen. Two tabs see one state. A fit
that is stopped, or whose program is killed, goes on from where it was. Modes
take three clicks. The text of a case is edited; records of a later state are
compared with the result of another work. Names that are markup run nothing.
Sensors are put on the nodes of a deck. Screenshots go to FOLDER. Status 77: there is no Chromium.

Nothing depends on how long a step takes: states are waited for, and the fit
that is stopped and killed never ends by itself. The last lines of a failure say
which step failed, and what page, browser and program said.
"""

import csv
import json
import os
import re
import shutil
import sys
import time

import chromium
import two_logs
from app_page import (PATIENCE_SECONDS, App, Page, Steps, await_true, check)

# Sensors and forces of data/frame.
FRAME_PLACES = {"fx": "force:3153.1", "fy": "force:2151.2",
                "a1x": "1051.1", "a1y": "1051.2", "a2x": "1101.1",
                "a2y": "1101.2", "a3x": "1151.1", "a3y": "1151.2"}
TRUE_CHANGE_PERCENT = -100 * two_logs.LOST
WEIGHTS = ", ".join(f"{weight:.0f}" for weight in two_logs.WEIGHTS_KN) + " kN"
HOSTILE = "<img src=x onerror=window.isHostile=1>"
ALL_READ = ("state.files.length === %d && "
            "state.files.every((file) => file.state === 'read')")
# With this network a fit takes hundreds of iterations, and longer than a test:
# 30 s alone where the fit of the case as it was drafted takes 0.6 s. It has one
# stage, so that the costs of all its iterations can be compared.
SLOW = """
[[network]]
name    = "extra"
inputs  = ["x[u1]", "v[u1]"]
outputs = ["u1"]
layers  = [8]

[options]
shooting       = "single"
tolerance      = 1e-15
max_iterations = 100000
"""


def begin_work(page, *others):
    """Begins a new work, which the other tabs see as well."""
    before = page.evaluate("state.work")
    page.click("#new-work")
    for one in (page, *others):
        one.wait(f"state.work !== '{before}' && state.files.length === 0")


def answer_and_check(page):
    page.answer("storeys", str(two_logs.STOREYS))
    page.answer("weights", WEIGHTS)
    page.wait(f"placeOf(allColumns()[{two_logs.STOREYS}]) === "
              f"'{two_logs.STOREYS}'")
    page.click("#do-check")
    page.wait("state.is_checked")
    page.wait("!!document.querySelector('#check-result .verdict')")


def check_verdict(page, verdict):
    check(f"k{two_logs.DAMAGED_STOREY}" in verdict and "Damage" in verdict,
          "the verdict is: " + verdict)
    groups = {group["name"]: group
              for group in page.evaluate("state.damage.groups")
              if re.fullmatch(r"k\d", group["name"])}
    check(len(groups) == two_logs.STOREYS, str(groups))
    for name, group in groups.items():
        is_lost = name == f"k{two_logs.DAMAGED_STOREY}"
        true = TRUE_CHANGE_PERCENT if is_lost else 0.0
        check(abs(100 * group["change"] - true) < 1.0,
              f"{name}: {100 * group['change']} %, expected {true} %")
        check((group["probability"] > 0.5) == is_lost,
              f"{name}: damaged with probability {group['probability']}")


def to_the_verdict(app, page, logs, folder):
    """Two files to the verdict, by drag or by the chooser of files."""
    if page.width > 500:
        page.drop(".zone[data-use=baseline]", logs[0])
        page.drop(".zone[data-use=later]", logs[1])
    else:
        page.pick("#pick-baseline", logs[0])
        page.pick("#pick-later", logs[1])
    page.wait(ALL_READ % 2)
    page.place("#columns .column")
    page.wait("document.querySelector('#columns .column').dataset.drawn === '1'")
    page.check_width()
    page.screenshot("columns")

    # A page without width asks for no picture of no width.
    page.evaluate("(async () => { const columns = $('#columns'); "
                  "columns.hidden = true; await showView(columns.children[0]); "
                  "columns.hidden = false; })()")
    check(page.evaluate("$('#columns .column').dataset.drawn === 'later'"),
          "a picture of no width was drawn")
    page.evaluate("window.dispatchEvent(new Event('resize'))")
    page.wait("document.querySelector('#columns .column').dataset.drawn === '1'")

    # A missing answer is asked for, beside its field and by its name.
    page.click("#do-check")
    page.wait("!!document.querySelector('.asked [data-answer=storeys]')")
    page.wait("/give \"a deck of CalculiX\"/.test($('#check-job').textContent)",
              fails=True)
    answer_and_check(page)
    page.check_width()
    page.screenshot("checked")

    page.click("#do-fit")
    page.wait("state.result !== null && !state.job.running")
    check(page.evaluate("state.result.usable"), "the fit is not usable")
    page.click("#do-compare")
    page.wait("!!document.querySelector('#damage-verdict')")
    verdict = page.evaluate("$('#damage-verdict').textContent")
    check_verdict(page, verdict)
    # The report is there, and cannot ask the server for anything.
    page.wait("!!document.querySelector('#compare-report iframe') && "
              "performance.getEntriesByType('resource').some((entry) => "
              "entry.name.endsWith('damage/report.html') && "
              "entry.responseEnd > 0)")
    page.check_width()
    page.screenshot("verdict")
    case = os.path.join(folder, page.evaluate("state.work"), "case.toml")
    with open(case, encoding="utf-8") as file:
        check(file.read() == app.get("files/case.toml?save=1"),
              "the saved case differs")
    print(f"         {page.width} px: {verdict}")


def slow_fit(page, other, log, work):
    """Checks a case in one tab, makes its fit slow, and fits it in another."""
    page.pick("#pick-baseline", log)
    other.wait(ALL_READ % 1)  # two tabs, one state
    answer_and_check(page)
    edit_the_case(page, other, os.path.dirname(work))
    other.click("#do-fit")
    page.wait("state.job !== null && state.job.kind === 'fit'", fails=True)


def stop(page, other, work):
    """Stops the fit by the button of the page. Returns the cost that it had
    begun with; a whole result is there."""
    page.wait("state.job.running && state.job.iteration > 0")
    page.click("#fit-job .stop")
    other.wait("state.result !== null && !state.job.running")
    check(other.evaluate("state.result.termination") == "interrupted",
          "the fit was not stopped")
    check(os.path.exists(os.path.join(work, "result", "report.html")),
          "no report")
    with open(os.path.join(work, "result", "history.csv"),
              encoding="utf-8") as file:
        return float(next(csv.DictReader(file))["cost"])


def cost(folder):
    """The cost that the fit of a checkpoint has reached; None: no checkpoint."""
    try:
        with open(os.path.join(folder, "checkpoint.json"),
                  encoding="utf-8") as file:
            return json.load(file)["cost"]
    except FileNotFoundError:
        return None


def partial_cost(work):
    """The cost of a fit that runs, or was killed; None: no checkpoint."""
    costs = [cost(os.path.join(work, name)) for name in os.listdir(work)
             if name.startswith("result.partial-")]
    return min(filter(None, costs), default=None)


def go_on(page, other):
    page.wait(ALL_READ % 1)
    check(page.evaluate("state.answers.storeys") == str(two_logs.STOREYS),
          "answers are lost")
    page.click("#unfinished button")
    other.wait("state.job !== null && state.job.kind === 'fit' && "
               "state.job.running")


def check_goes_on(begun, reached, fresh):
    """The fit began near the cost that the one before had reached. The two
    differ, since noise levels are estimated anew as a fit goes on."""
    check(begun < 0.1 * fresh,
          f"a fit with the cost {reached} goes on with {begun}, "
          f"a new one begins with {fresh}")


def edit_the_case(page, other, folder):
    """A wrong text is refused beside its field, and a right one is saved."""
    path = os.path.join(folder, page.evaluate("state.work"), "case.toml")
    with open(path, encoding="utf-8") as file:
        before = file.read()
    page.click("#edit summary")
    page.wait("$('#edit-text').value.includes('[model.shear_building]')")
    page.fill("#edit-text", before + "\n[options]\nmax_iteration = 1\n")
    page.click("#edit-save")
    page.wait("/max_iteration/.test($('#edit-job').textContent)", fails=True)
    page.check_width()
    page.screenshot("edited")
    with open(path, encoding="utf-8") as file:
        check(file.read() == before, "a wrong text was saved")
    after = before.replace("Building of", "House of") + SLOW
    page.fill("#edit-text", after)
    page.click("#edit-save")
    other.wait("state.is_checked && state.job.kind === 'save_case' && "
               "!state.job.running && !state.job.problem", fails=True)
    with open(path, encoding="utf-8") as file:
        check(file.read() == after, "the text is not saved")
    # The draft does not replace it.
    page.click("#do-check")
    page.wait("/by hand/.test($('#check-job').textContent)", fails=True)
    with open(path, encoding="utf-8") as file:
        check(file.read() == after, "an edited case was replaced")


def compare_with_an_earlier_work(page, log, earlier):
    """A work with nothing but later records, and the result of another one."""
    page.pick("#pick-later", log)
    page.wait(ALL_READ % 1)
    page.choose("#earlier", earlier)
    page.click("#do-compare")
    page.wait("!!document.querySelector('#damage-verdict') && "
              "!state.job.running")
    check_verdict(page, page.evaluate("$('#damage-verdict').textContent"))
    page.check_width()
    page.screenshot("earlier")


def with_hostile_names(log):
    """A copy whose name and column are markup that would run a script."""
    copy = os.path.join(os.path.dirname(log), f"{HOSTILE}.csv")
    with open(log, encoding="utf-8") as file:
        text = file.read()
    with open(copy, "w", encoding="utf-8") as file:
        file.write(text.replace("Etage 2", HOSTILE))
    return copy


def modes_in_three_clicks(page, log, folder):
    """Choose the files, confirm, find: the report is there."""
    page.pick("#pick-baseline", log)  # 1 and 2: the button and its dialog
    page.wait(ALL_READ % 1)
    page.click("#find-modes")  # 3: that is all
    page.wait("!!document.querySelector('#modes-report iframe')")
    page.check_width()
    with open(os.path.join(folder, page.evaluate("state.work"), "modes",
                           "modes.json"), encoding="utf-8") as file:
        modes = json.load(file)["modes"]
    check(len(modes) >= 1, "no modes")
    # Names are shown, and nothing of them is run.
    page.wait(f"allColumns().some((column) => column.name === '{HOSTILE}')")
    check(page.evaluate("document.body.innerText").count(HOSTILE) >= 2,
          "names are not shown as they are")
    check(page.evaluate("window.isHostile === undefined && "
                        "document.querySelectorAll('img').length === 0"),
          "a name was run as markup")


def put_on_node(page, column, place):
    node, direction = place.replace("force:", "").split(".")
    end = time.monotonic() + PATIENCE_SECONDS
    # The picture may be drawn anew between the question and the click.
    while page.evaluate("$('#deck-node').textContent") != f"Node {node}":
        page.place("#deck-canvas")
        page.press(*page.evaluate(f"""(() => {{
            const canvas = $("#deck-canvas");
            const box = canvas.getBoundingClientRect();
            const [x, y] = deckPoint(canvas, deck.index.get("{node}"));
            return [box.x + x, box.y + y];
        }})()"""))
        check(time.monotonic() < end, f"node {node} cannot be selected")
    value = ("force:" if "force" in place else "") + direction
    page.evaluate(f"$('#deck-column').value = '{column}'; "
                  f"$('#deck-direction').value = '{value}'")
    page.click("#deck-put")
    page.wait(f"state.places['{column}'] === '{place}'")


def sensors_on_a_deck(page, other):
    """Selects nodes on the structure of data/frame and puts sensors there, half
    of them in each tab."""
    # Chromium reads no file whose path has "..".
    data = os.path.join(os.path.dirname(os.path.dirname(os.path.dirname(
        os.path.abspath(__file__)))), "data", "frame")
    deck = [os.path.join(data, name) for name in sorted(os.listdir(data))
            if re.fullmatch(r"frame\.(inp|dof)|.*\.(sti|mas)\.gz", name)]
    page.click("input[name=kind][value=deck]")
    page.pick("#pick-deck", *deck)
    page.pick("#pick-baseline", os.path.join(data, "healthy_1.csv"))
    for one in (page, other):
        one.wait(f"state.files.length === {len(deck) + 1} && "
                 "state.files.every((file) => file.state !== 'reading') && "
                 "deck.view !== null && allColumns().length === 8")
    for i, (column, place) in enumerate(FRAME_PLACES.items()):
        put_on_node((page, other)[i % 2], column, place)
    for one in (page, other):
        one.check_width()
        one.screenshot("deck")
    for name, text in (("deck_units", "N,m"), ("factor", "2"),
                       ("unit", "m/s^2"), ("force_unit", "N")):
        if name == "unit":
            page.click("#time-answers summary")
        page.answer(name, text)
    page.click("#do-check")
    page.wait("state.is_checked")
    check(page.evaluate("state.check.assessed"), "the deck cannot be fitted")


def run(steps, program, scratch, shots):
    logs = [os.path.join(scratch, name) for name in ("before.csv", "after.csv")]
    folder = os.path.join(scratch, "works")
    with steps.step("files of a logger are written"):
        two_logs.write_both(*logs)
    with steps.step("program and browsers start"):
        app = steps.app = App(program, folder, scratch)
        for width in (1280, 390):
            steps.pages.append(Page(width, shots))
            steps.pages[-1].open(app.address)
    wide, narrow = steps.pages
    with steps.step("two files to the verdict at 1280 px"):
        to_the_verdict(app, wide, logs, folder)
    with steps.step("two files to the verdict at 390 px"):
        begin_work(narrow, wide)
        to_the_verdict(app, narrow, logs, folder)
    with steps.step("a later state beside the result of an earlier work"):
        earlier = narrow.evaluate("state.work")
        begin_work(narrow, wide)
        compare_with_an_earlier_work(narrow, logs[1], earlier)
    with steps.step("modes of a record alone"):
        begin_work(narrow, wide)
        modes_in_three_clicks(narrow, with_hostile_names(logs[0]), folder)
    with steps.step("a fit is stopped in another tab"):
        begin_work(wide, narrow)
        work = os.path.join(folder, wide.evaluate("state.work"))
        slow_fit(wide, narrow, logs[0], work)
        fresh = stop(wide, narrow, work)
    with steps.step("the program is killed while it goes on"):
        go_on(narrow, wide)
        await_true(lambda: (partial_cost(work) or fresh) < 0.01 * fresh,
                   f"a checkpoint with a cost below a hundredth of {fresh}")
        app.kill()
        reached = partial_cost(work)
    with steps.step("started again, the fit goes on"):
        app = steps.app = App(program, folder, scratch)
        for page in steps.pages:
            page.open(app.address)
        go_on(narrow, wide)
        check_goes_on(stop(narrow, wide, work), reached, fresh)
    with steps.step("sensors on a deck"):
        begin_work(narrow, wide)
        sensors_on_a_deck(narrow, wide)
    with steps.step("the end, by its button"):
        wide.click("#quit")
        app.check_ended()
        for page in steps.pages:
            page.check_no_errors()


def main():
    if len(sys.argv) not in (2, 3):
        sys.exit(__doc__)
    if shutil.which("chromium") is None:
        print("no chromium: nothing is tested")
        sys.exit(77)
    program = os.path.abspath(sys.argv[1])
    shots = os.path.abspath(sys.argv[2]) if len(sys.argv) == 3 else None
    if shots:
        os.makedirs(shots, exist_ok=True)
    scratch = chromium.temporary_folder()
    steps = Steps()
    try:
        run(steps, program, scratch, shots)
        return 0
    except Exception as error:  # whatever it is, it is told
        steps.report(error)
        return 1
    finally:
        for page in steps.pages:
            page.close()
        if steps.app is not None and steps.app.process.poll() is None:
            steps.app.kill()
        shutil.rmtree(scratch, ignore_errors=True)


if __name__ == "__main__":
    sys.exit(main())
