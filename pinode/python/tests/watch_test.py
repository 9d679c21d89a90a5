"""pinode.watch.Store on a store that pinode_watch filled, against its own files."""

import csv
import os
import pathlib
import shutil
import sqlite3
import subprocess

import numpy as np
import pytest

import pinode

PROGRAM = pathlib.Path(os.environ.get("PINODE_BUILD_DIR", ".")) / "apps" / "pinode_watch"
TOML = """name = "b"
[records]
time_in_name = "%Y"
[[covariate]]
name = "T"
[reference]
records = 60
"""


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    """A store of 80 records whose frequencies are given, without files of records."""
    if not PROGRAM.exists():
        pytest.skip("pinode_watch is not built")
    folder = tmp_path_factory.mktemp("watch")
    (folder / "b.toml").write_text(TOML)
    command = [PROGRAM, "--structure=b.toml", "--store=w.db"]
    once = [*command, "--once", "--output_dir=D", "--overwrite"]
    subprocess.run(once, cwd=folder, check=True, stdout=subprocess.DEVNULL)
    rng = np.random.default_rng(3)
    store = sqlite3.connect(folder / "w.db")
    for i in range(80):
        store.execute("INSERT INTO record VALUES (?, 1, ?, ?, ?, 600, '')",
                      (i + 1, str(i), f"r{i}.csv", 1.7e9 + 10800.5 * i))
        store.execute("INSERT INTO channel VALUES (?, 0, 'a', '')", (i + 1,))
        temperature = 10 + 8 * np.sin(i)
        hz = 2 * (1 - 0.001 * temperature + 0.001 * rng.standard_normal())
        hz *= 0.95 if i >= 70 else 1
        store.execute("INSERT INTO mode VALUES (?, 0, ?, 0.002, 0.01, 0.001, ?)",
                      (i + 1, hz, np.array([1 + 2j]).tobytes()))
        store.execute("INSERT INTO covariate VALUES (?, 'T', ?)", (i + 1, temperature))
    store.commit()
    store.close()
    subprocess.run(once, cwd=folder, check=True, stdout=subprocess.DEVNULL)
    return folder, command, once


def rows(path):
    with open(path, newline="") as file:
        return list(csv.DictReader(file))


def test_histories_are_those_of_the_program(folder):
    folder, _, _ = folder
    histories = pinode.watch.Store(folder / "w.db").histories()
    table = rows(folder / "D" / "histories.csv")
    assert list(histories) == [n for n in table[0] if n != "record"]
    assert [r["light"] for r in table] == histories["light"].tolist()
    assert "alarm" in histories["light"]
    for name in ("mode_1_hz", "mode_1_expected_upper95_hz", "T", "average"):
        np.testing.assert_allclose([float(r[name] or "nan") for r in table],
                                   histories[name], rtol=1e-9)
    assert histories["time"][1] == np.datetime64("2023-11-15T01:13:20.500")


def test_records_and_modes(folder):
    folder, _, _ = folder
    with pinode.watch.Store(folder / "w.db", "b") as store:
        records, modes = store.records(), store.modes()
        assert "'b'" in repr(store)
    assert records["record"].tolist() == [f"r{i}.csv" for i in range(80)]
    np.testing.assert_allclose(records["T"], 10 + 8 * np.sin(np.arange(80)))
    assert modes["shape"][0].tolist() == [1 + 2j]
    assert modes["frequency_hz"].shape == (80,)


def test_decisions_stay_beside_the_results(folder):
    folder, command, once = folder
    store = pinode.watch.Store(folder / "w.db")
    alarms = store.alarms()
    time = alarms["time"][alarms["kind"] == "alarm"][0]
    text = str(time.astype("datetime64[m]")).replace("T", " ")
    for mend in ("reject:r3.csv", f"acknowledge:{text}", "name:2=first"):
        subprocess.run([*command, f"--mend={mend}", "--by=N. N.", "--why=crane"], cwd=folder,
                       check=True, stdout=subprocess.DEVNULL)
    refused = subprocess.run([*command, "--mend=reject:r3.csv", "--by=N. N."], cwd=folder,
                             capture_output=True, text=True)
    assert refused.returncode == 2 and refused.stderr.count("\n") == 1
    subprocess.run(once, cwd=folder, check=True, stdout=subprocess.DEVNULL)
    assert np.flatnonzero(store.records()["rejected"]).tolist() == [3]
    assert len(store.records()["record"]) == 80
    assert len(store.histories()["time"]) == 79
    assert store.decisions()["kind"].tolist() == ["reject", "acknowledge", "name"]
    alarms = store.alarms()
    assert alarms["acknowledged_by"][alarms["kind"] == "alarm"][0] == "N. N."
    assert store.decisions()["value"].tolist() == ["r3.csv", text, "first"]
    page = (folder / "D" / "watch.html").read_text()
    assert "reject r3.csv" in page and "acknowledge " + text in page
    table = rows(folder / "D" / "alarms.csv")
    assert any(r["acknowledged"].endswith("crane") and "first)" in r["text"] for r in table)


def test_frames_and_figures(folder):
    pandas = pytest.importorskip("pandas")
    pytest.importorskip("matplotlib")
    folder, _, _ = folder
    store = pinode.watch.Store(folder / "w.db")
    frame = store.histories(frame=True)
    assert isinstance(frame, pandas.DataFrame) and frame["time"].dtype.kind == "M"
    axes = store.plot_histories().axes
    assert len(axes) == 1
    np.testing.assert_array_equal(axes[0].lines[0].get_ydata(), frame["mode_1_hz"])


def test_what_is_no_store_is_refused(tmp_path):
    with pytest.raises(pinode.Error, match="no such store"):
        pinode.watch.Store(tmp_path / "none.db")
    (tmp_path / "text.db").write_text("some text that is not a database" * 10)
    with pytest.raises(pinode.Error, match="not a store"):
        pinode.watch.Store(tmp_path / "text.db")
    sqlite3.connect(tmp_path / "other.db").execute("CREATE TABLE a (b)").connection.close()
    with pytest.raises(pinode.Error, match="not a store"):
        pinode.watch.Store(tmp_path / "other.db")


def test_a_record_that_arrives_between_two_queries(folder, tmp_path):
    folder, _, _ = folder
    for name in ("records", "modes", "histories", "alarms"):
        path = tmp_path / f"{name}.db"
        shutil.copy(folder / "w.db", path)
        store = pinode.watch.Store(path)
        before, read, calls = len(next(iter(getattr(store, name)().values()))), store._rows, []

        def rows_and_write(sql):
            found = read(sql)
            if not calls:
                with sqlite3.connect(path) as other:
                    other.execute("INSERT INTO record VALUES (999, 1, 'x', 'x.csv', 1.8e9, 1, '')")
                    other.execute("INSERT INTO covariate VALUES (999, 'T', 3.0)")
                    other.execute("DELETE FROM event")
                other.close()
            calls.append(sql)
            return found

        store._rows = rows_and_write
        assert len(next(iter(getattr(store, name)().values()))) == before
        # The transaction is over: the next call sees the record.
        store._rows = read
        assert "x.csv" in store.records()["record"] and len(store.alarms()["time"]) == 0
        store.close()
        with pytest.raises(pinode.Error, match="closed"):
            store.records()


def test_arrays_are_the_users_own(folder):
    store = pinode.watch.Store(folder[0] / "w.db")
    store.histories()["mode_1_hz"][0] = 1.0
    store.modes()["shape"][0][0] = 1.0


@pytest.mark.parametrize("change", [
    "UPDATE history SET \"values\" = x'00' WHERE name = 'light'",
    "UPDATE history SET \"values\" = 'text'", "DELETE FROM history WHERE name = 'light'",
    "UPDATE history SET \"values\" = (SELECT \"values\" FROM history WHERE name = 'time') "
    "WHERE name = 'light'",
    "UPDATE mode SET shape = 3", "UPDATE mode SET frequency_hz = 'high'",
    "UPDATE record SET duration = 'long'", "UPDATE record SET time = 'now'",
    "UPDATE covariate SET value = 'warm'", "UPDATE covariate SET name = 'record'",
    "UPDATE event SET time = 'now'", "UPDATE record SET time = 1e300",
    "INSERT INTO mend (structure, time, person, reason, kind, subject, value) VALUES "
    "(1, 'now', 'N', 'w', 'acknowledge', 'today', 'v')",
])
def test_a_damaged_store_is_refused_in_one_line(folder, tmp_path, change):
    shutil.copy(folder[0] / "w.db", tmp_path / "w.db")
    with sqlite3.connect(tmp_path / "w.db") as other:
        assert other.execute(change).rowcount > 0
    other.close()
    refused = 0
    with pinode.watch.Store(tmp_path / "w.db") as store:
        for name in ("records", "modes", "histories", "alarms", "decisions"):
            try:
                getattr(store, name)()
            except pinode.Error as failure:
                assert "w.db: " in str(failure) and "\n" not in str(failure)
                refused += 1
    # A time that is no date is none.
    assert refused > 0 or "1e300" in change


def test_the_structure_must_be_there(folder):
    folder, _, _ = folder
    with pytest.raises(pinode.Error, match="expected one of b"):
        pinode.watch.Store(folder / "w.db", "bridge")
    with pytest.raises(sqlite3.OperationalError, match="readonly"):
        pinode.watch.Store(folder / "w.db")._database.execute("DELETE FROM record")
