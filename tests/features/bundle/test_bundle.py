"""A bundle: whole, readable by others' programs, and without anybody's words or codes."""

from __future__ import annotations

import csv
import gzip
import hashlib
import json
import random
import re
import shutil
import subprocess
import sys
from pathlib import Path

import frictionless
import msgspec
import pytest

from tests.export import secret_log
from tests.export.logs import write
from tests.export.test_bids import validated
from tests.export.test_redaction import ASKED, NEVER, field_of, promised
from tests.features.bundle.deposited import (
    ANSWERS,
    EXPERIMENT,
    INCOME,
    NAME,
    UX,
    bundled,
    course_of,
    recorded,
)
from woz_tui.config.about_file import About, AuthorEntry, missing_in
from woz_tui.export.log_sources import ExportError
from woz_tui.features.bundle.bundle import BundleError
from woz_tui.features.bundle.participant_codes import drawn_codes, recoded
from woz_tui.sensing.visitor_store import VisitorStore

ABOUT = About(
    title="Warm or sober",
    authors=(AuthorEntry("Ada Example", "0000-0002-1825-0097", "University of Examples"),),
    licence="CC-BY-4.0",
    share=("media",),
    suspicion="end.person",
)
TABLE = re.compile(r"([a-z]+-[a-zA-Z0-9]+)(_[a-z]+-[a-zA-Z0-9]+)*_data\.csv")
#: The keywords of Psych-DS; others are a warning.
KEYWORDS = {"study", "site", "subject", "session", "task", "condition", "trial", "stimulus"} | {
    "description"
}


@pytest.fixture(scope="module")
def bundle(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("study")
    bundled(recorded(folder / "recordings"), folder / "osf", ABOUT, recode=True)
    return folder / "osf"


def table(bundle: Path, name: str) -> list[dict[str, str]]:
    [path] = bundle.glob(f"data/*description-{name}_data.csv")
    with path.open(encoding="utf-8", newline="") as file:
        return list(csv.DictReader(file))


def everything(folder: Path) -> dict[str, bytes]:
    """Each file's bytes, with its name, unpacked."""
    return {
        str(path.relative_to(folder)): gzip.decompress(path.read_bytes())
        if path.suffix == ".gz"
        else path.read_bytes()
        for path in folder.rglob("*")
        if path.is_file()
    }


def test_it_has_what_a_repository_asks_for(bundle: Path) -> None:
    names = {path.name for path in bundle.iterdir()}
    assert names == {
        *("README.md", "CHANGES.md", "LICENSE", "CITATION.cff", "TODO.md", "MANIFEST.sha256"),
        *("dataset_description.json", "datapackage.json", "codebook.md", "codebook.csv"),
        *("data", "materials", "documentation", "analysis", "results"),
    }
    assert (bundle / "materials" / "study.yaml").read_text() == EXPERIMENT
    assert (bundle / "results" / "report.html").exists()
    assert (bundle / "results" / "figures" / "mistake_rate.svg").exists()
    assert "CC-BY-4.0" in (bundle / "LICENSE").read_text()
    cited = (bundle / "CITATION.cff").read_text()
    assert 'family-names: "Example"' in cited
    assert "type: dataset" in cited


def test_the_manifest_has_every_other_file(bundle: Path) -> None:
    lines = (bundle / "MANIFEST.sha256").read_text().splitlines()
    listed = {name: digest for digest, name in (line.split("  ", 1) for line in lines)}
    found = {
        name: hashlib.sha256((bundle / name).read_bytes()).hexdigest()
        for name in map(str, (p.relative_to(bundle) for p in bundle.rglob("*") if p.is_file()))
        if name != "MANIFEST.sha256"
    }
    assert listed == found


def test_frictionless_accepts_its_tables(bundle: Path) -> None:
    report = frictionless.Package(str(bundle / "datapackage.json")).validate()
    assert report.flatten(["rowNumber", "fieldName", "type", "message"]) == []
    assert len(report.tasks) == len([*bundle.glob("data/*_data.csv")])


def test_the_bids_validator_accepts_its_bids(bundle: Path) -> None:
    warned = {each["code"] for each in validated(bundle / "documentation" / "bids")}
    assert "NO_AUTHORS" not in warned
    said = json.loads((bundle / "documentation/bids/dataset_description.json").read_text())
    assert (said["Authors"], said["License"]) == (["Ada Example"], "CC-BY-4.0")


def test_it_keeps_the_rules_of_psych_ds(bundle: Path) -> None:
    """As its public schema says them; its validator did not run here."""
    description = json.loads((bundle / "dataset_description.json").read_text())
    assert description["@context"] in ("https://schema.org/", "http://schema.org/")
    assert description["@type"] == "Dataset"
    assert {"name", "description", "variableMeasured"} <= description.keys()
    measured = [each["name"] for each in description["variableMeasured"]]
    assert len(measured) == len(set(measured))
    files = sorted((bundle / "data").glob("*"))
    assert [path for path in files if path.suffix == ".csv"]
    for path in files:
        if path.suffix != ".csv":
            continue
        assert TABLE.fullmatch(path.name)
        assert set(re.findall(r"(?:^|_)([a-z]+)-", path.name)) <= KEYWORDS
        with path.open(encoding="utf-8", newline="") as file:
            head, *rows = csv.reader(file)
        assert set(head) <= set(measured)
        assert len(set(head)) == len(head)
        assert {len(row) for row in rows} <= {len(head)}
        assert "row_id" not in head  # its values would have to differ
    for name in ("README.md", "CHANGES.md"):
        assert (bundle / name).read_text().strip()
    # One of this name alone: another one is in the wrong place, but below documentation/.
    others = {path.parent.relative_to(bundle).parts[:1] for path in bundle.rglob("dataset_desc*")}
    assert others == {(), ("documentation",)}


def test_no_name_and_no_code_of_the_lab_is_in_any_byte(bundle: Path) -> None:
    content = everything(bundle)
    for name, data in content.items():
        for part in NAME.replace("-", " ").split():
            assert part.encode() not in data, name
            assert part not in name
        if not name.startswith("materials/"):  # the file's own comment has P01 ... P99
            assert not re.search(rb"\bP0[123]\b|2026-03-0", data), name
            assert not re.search(r"P0[123]|2026-03", name)
    answers = {name: data for name, data in content.items() if name.endswith((".jsonl", ".csv"))}
    assert not [name for name, data in answers.items() if str(INCOME).encode() in data]
    codes = {row["participant"] for row in table(bundle, "answers")}
    assert len(codes) == len(ANSWERS)


def test_no_secret_of_any_kind_of_message_is_in_any_byte(tmp_path: Path) -> None:
    """What the experiment file says is none; of all else, no more than redaction promises."""
    secrets = secret_log.Secrets()
    recordings = tmp_path / "recordings"
    secret_log.write(recordings, secrets)
    own = {"session.plan", "experiment.files"}
    planned = [f"Ms {token} & <co>" for token, (kind, _) in secrets.told.items() if kind in own]
    bundled(recordings, tmp_path / "osf", public=planned)
    found = "\n".join(
        f"{name}\n{data.decode('utf-8', 'replace')}"
        for name, data in everything(tmp_path / "osf").items()
    )
    told = {(kind, path) for kind, path in secrets.leaked(found) - ASKED if kind not in own}
    leaked = {(kind, field_of(path)) for kind, path in told}
    assert {field for _, field in leaked} <= promised() | {"robot"}  # the name of a robot's file
    assert not {field.partition(".")[0] for _, field in leaked - ASKED} & NEVER


def test_the_codebook_is_of_the_file_not_of_the_answers(bundle: Path) -> None:
    with (bundle / "codebook.csv").open(encoding="utf-8", newline="") as file:
        rows = {(row["table"], row["variable"]): row for row in csv.DictReader(file)}
    pleasant = rows["answers", "robot_ux_pleasant"]
    assert pleasant["question"] == "I enjoyed being with this robot."
    assert (pleasant["values"], pleasant["type"]) == ("1 = not at all; 7 = very much", "integer")
    assert rows["answers", "robot_ux_words"]["missing"].startswith("withheld")
    head = table(bundle, "answers")[0].keys()
    assert {name for of, name in rows if of == "answers"} - set(head) == {
        *("robot_ux_words", "robot_ux_income")
    }
    assert rows["answers", "robot_ux_income"]["missing"] == "withheld: private"
    assert rows["answers", "robot_ux_robots"]["values"] == "1 = never; 2 = once"
    assert not [name for _, name in rows if name == "robot_ux_page"]
    for name in ("events", "questionnaires"):
        assert set(table(bundle, name)[0]) == {each for of, each in rows if of == name}
    # What was asked stays in tables and logs: only what was said goes.
    assert {row["question"] for row in table(bundle, "questionnaires")} >= {
        "Was a person behind it?"
    }


def test_its_script_reproduces_means_of_the_report(bundle: Path) -> None:
    ran = subprocess.run(
        [sys.executable, str(bundle / "analysis" / "read.py")],
        capture_output=True,
        text=True,
        timeout=60,
        check=True,
    )
    told, choices = ran.stdout.split("\n\n")
    means = {
        (row["item"], row["condition"]): float(row["mean"])
        for row in csv.DictReader(told.splitlines())
    }
    assert "robot_ux_robots" not in told, "codes of choices have no mean"
    assert choices.splitlines()[1:] == ["robot_ux_robots,sober,2,3", "robot_ux_robots,warm,2,3"]
    for condition in ("warm", "sober"):
        known = [pleasant[condition] for _, pleasant, _ in ANSWERS.values()]
        expected = pytest.approx(sum(known) / len(known), abs=1e-3)
        assert means["robot_ux_pleasant", condition] == expected
    assert means["end_person", ""] == pytest.approx(7 / 3, abs=1e-3)
    report = next((bundle / "results" / "figures").glob("*pleasant.csv"))
    with report.open(encoding="utf-8", newline="") as file:
        rows = {row["condition"]: row for row in csv.DictReader(file)}
    for condition in ("warm", "sober"):
        reported = pytest.approx(float(rows[condition]["mean"]), abs=1e-2)
        assert means["robot_ux_pleasant", condition] == reported


@pytest.mark.skipif(shutil.which("Rscript") is None, reason="R is not installed")
def test_its_script_for_r_reproduces_them_too(bundle: Path) -> None:
    ran = subprocess.run(
        ["Rscript", "analysis/read.R"],
        cwd=bundle, capture_output=True, text=True, timeout=60, check=True,
    )  # fmt: skip
    assert re.search(r"robot_ux_pleasant +sober +3\.0+\n", ran.stdout)
    assert re.search(r"robot_ux_pleasant +warm +5\.66", ran.stdout)
    assert re.search(r"end_person +2\.33", ran.stdout)
    assert re.search(r"robot_ux_robots *\n +value\n", ran.stdout), "counted"


def test_labels_are_in_the_scripts_for_r_and_spss(bundle: Path) -> None:
    r, spss = ((bundle / "analysis" / name).read_text() for name in ("read.R", "read.sps"))
    assert 'c("not at all" = 1, "very much" = 7)' in r
    assert "VALUE LABELS robot_ux_pleasant 1 'not at all' 7 'very much'." in spss
    assert "robot_ux_words" not in r + spss


def test_criteria_say_where_each_answer_is_from(bundle: Path) -> None:
    with (bundle / "documentation" / "riek.csv").open(encoding="utf-8", newline="") as file:
        rows = {row["criterion"]: row for row in csv.DictReader(file)}
    assert rows["Users: how many"]["source"] == "log"
    assert "3 participants took part" in rows["Users: how many"]["answer"]
    assert "experiment file" in rows["Wizards: who, and what they knew"]["source"]
    robot = rows["Robot: what it is"]
    assert robot["answer"] == "The robot was simulated (robot); no hardware moved."
    assert (
        "the answers were 2 twice and 3 once"
        in (rows["Users: whether the simulation convinced them"]["answer"])
    )
    assert rows["General: scenario"] == {
        "criterion": "General: scenario", "answer": "", "source": "missing"
    }  # fmt: skip


def test_what_was_played_otherwise_than_registered_is_a_diff(tmp_path: Path) -> None:
    registered = tmp_path / "registered.yaml"
    registered.write_text(EXPERIMENT)
    changed = EXPERIMENT.replace("The tour begins now.", "Shall we begin?")
    bundled(recorded(tmp_path / "r", last=changed), tmp_path / "osf", registered=registered)
    text = (tmp_path / "osf" / "documentation" / "deviations.md").read_text()
    assert "2 sessions began with it\n\nAs registered." in text
    assert "1 session began with it" in text
    assert "Shall we begin?" in text
    planned = (tmp_path / "osf" / "documentation" / "preregistration.md").read_text()
    assert hashlib.sha256(EXPERIMENT.encode()).hexdigest() in planned
    assert "## Hypotheses\n\n*(to be written by hand)*" in planned
    assert "a Latin square (Williams)" in planned
    assert "`end_person`, asked at the end: Was a person behind it?" in planned


def test_no_text_says_that_words_are_as_they_were(bundle: Path) -> None:
    readme = (bundle / "documentation" / "bids" / "README.md").read_text()
    assert "was replaced by `[redacted]`" in readme
    methods = (bundle / "documentation" / "methods.md").read_text()
    assert '("Warm or sober")' in methods


def test_what_is_missing_is_listed(bundle: Path) -> None:
    text = (bundle / "TODO.md").read_text()
    for name, doc in missing_in(ABOUT):
        assert f"- [ ] `{name}`: {doc}" in text
    assert "`title`" not in text


def test_sound_is_there_by_choice_and_agreement(tmp_path: Path) -> None:
    recordings = recorded(tmp_path / "r")
    with pytest.raises(BundleError, match="only if participants agreed"):
        bundled(recordings, tmp_path / "osf", media=True)
    assert not (tmp_path / "osf").exists()
    bundled(recordings, tmp_path / "osf", ABOUT, media=True, recode=True)
    sounds = [*(tmp_path / "osf" / "data" / "media").rglob("*.wav")]
    assert [path.name for path in sounds] == ["0001.wav"] * 3


def test_new_codes_do_not_lead_back(tmp_path: Path) -> None:
    """With the seed of a session the code of a shuffled order can be found by trying all."""
    bundled(recorded(tmp_path / "r"), tmp_path / "osf", ABOUT, recode=True)
    logs = [
        path
        for path in sorted((tmp_path / "osf" / "data" / "logs").glob("*.jsonl"))
        if ".samples." not in path.name
    ]
    assert {json.loads(path.read_bytes().splitlines()[0])["seed"] for path in logs} == {0}


def test_words_that_get_in_all_the_same_stop_it(tmp_path: Path) -> None:
    """As a label that somebody has typed would: here, the name of an action that no file has."""
    recordings = recorded(tmp_path / "r")
    log = sorted(recordings.glob("*_P03_*.jsonl"))[0]
    log.write_bytes(
        log.read_bytes().replace(b'"action":"Hello"', f'"action":"{NAME}, smiling"'.encode())
    )
    with pytest.raises(BundleError, match="texts that were withheld stand in it") as raised:
        bundled(recordings, tmp_path / "osf")
    assert NAME in raised.value.what
    assert not (tmp_path / "osf").exists()
    bundled(recordings, tmp_path / "osf", public=[f"{NAME}, smiling"])


def test_logs_are_never_replaced(tmp_path: Path) -> None:
    recordings = recorded(tmp_path / "r")
    with pytest.raises((BundleError, ExportError)):
        bundled(recordings, recordings)
    assert len([*recordings.glob("*.jsonl")]) == 6


def test_a_code_within_a_label_stops_it_where_codes_are_drawn_anew(tmp_path: Path) -> None:
    recordings = recorded(tmp_path / "r")
    log = min(recordings.glob("*_P03_*.jsonl"))
    log.write_bytes(log.read_bytes().replace(b'"action":"Hello"', b'"action":"Hello P01"'))
    with pytest.raises(BundleError, match=r"_data\.csv: P01"):
        bundled(recordings, tmp_path / "osf", recode=True)
    bundled(recordings, tmp_path / "osf")  # the lab's codes stay


def test_a_key_that_looks_like_a_code_stays_a_key() -> None:
    line = {"participant": "7", "key": "7", "session": "S07", "order": ["P01"], "P01": {"a": "P01"}}
    assert recoded(line, {"7": "BCDFG", "P01": "XYZXY"}) == {
        "participant": "BCDFG", "key": "7", "session": "S0BCDFG", "order": ["XYZXY"],
        "XYZXY": {"a": "XYZXY"},
    }  # fmt: skip


def test_codes_are_drawn_by_chance() -> None:
    old = [f"P{number:02}" for number in range(1, 51)]
    drawn = drawn_codes(old, random.Random(1))
    assert drawn.keys() == set(old)
    assert len(set(drawn.values())) == len(old)
    assert [*drawn.values()] != sorted(drawn.values())
    assert drawn != drawn_codes(old, random.Random(2))


def test_versions_of_a_questionnaire_are_not_mixed(tmp_path: Path) -> None:
    """Not of several sessions, nor of one in which the file was read again."""
    pleasant, clear, *rest = UX.items
    five = msgspec.structs.replace(pleasant, high=5, ends=("never", "always"))
    changed = msgspec.structs.replace(UX, items=(five, clear, *rest))
    for who, before, after in (("P01", UX, UX), ("P02", UX, changed), ("P03", changed, changed)):
        stem = f"2026-03-01T10-00-{who[1:]}_{who}_S{who[1:]}"
        write(tmp_path / "r", course_of(who, ux=before, changed=after), stem)
    bundled(tmp_path / "r", tmp_path / "osf")
    names = ("robot_ux_pleasant", "robot_ux_pleasant_2", "robot_ux_clear")
    rows = table(tmp_path / "osf", "answers")
    told = {(row["participant"], row["condition"]): [row[n] for n in names] for row in rows}
    assert told == {
        ("P01", ""): ["", "", ""], ("P02", ""): ["", "", ""], ("P03", ""): ["", "", ""],
        ("P01", "warm"): ["6", "", "5"], ("P01", "sober"): ["3", "", "5"],
        ("P02", "sober"): ["4", "", "5"], ("P02", "warm"): ["", "4", "5"],
        ("P03", "warm"): ["", "7", "5"], ("P03", "sober"): ["", "2", "5"],
    }  # fmt: skip
    with (tmp_path / "osf" / "codebook.csv").open(encoding="utf-8", newline="") as file:
        book = {row["variable"]: row for row in csv.DictReader(file) if row["table"] == "answers"}
    assert [(book[each]["values"], book[each]["version"]) for each in names] == [
        ("1 = not at all; 7 = very much", "1"),
        ("1 = never; 5 = always", "2"),
        ("1 = not at all; 7 = very much", ""),
    ]
    assert book[names[1]]["label"] == "I enjoyed being with this robot. (version 2 of 2)"


def test_the_preregistration_is_of_the_file_not_of_a_session(tmp_path: Path) -> None:
    """Whatever the last session was shown: the file says all conditions and what is asked."""
    registered = tmp_path / "registered.yaml"
    registered.write_text(
        """\
title: Three ways
robot: simulated
conditions: [warm, sober, silent]
design: {order: latin-square, trials: 2}
questionnaires: [{name: mood, title: Mood, when: condition, items: [How are you?]}]
panels: [{title: P, actions: [{key: h, label: Hello, say: Hello.}]}]
"""
    )
    bundled(recorded(tmp_path / "r"), tmp_path / "osf", registered=registered)
    text = (tmp_path / "osf" / "documentation" / "preregistration.md").read_text()
    assert "# Preregistration: Three ways" in text
    assert "Conditions: warm, sober and silent." in text
    assert "each participant gets all, 2 trials in each" in text
    assert "There are 6 rows (warm, sober, silent; " in text
    assert "`mood_how_are_you`, asked after each condition: How are you?" in text
    assert "robot_ux" not in text


def test_codes_of_choices_have_no_order(bundle: Path) -> None:
    spss = (bundle / "analysis" / "read.sps").read_text()
    assert "VARIABLE LEVEL robot_ux_robots (NOMINAL)." in spss
    assert "VARIABLE LEVEL robot_ux_pleasant (ORDINAL)." in spss


@pytest.mark.parametrize("word", ["end", "key", "robot", "Speech"])
def test_a_code_that_is_a_word_is_told_before_anything_is_written(
    tmp_path: Path, word: str
) -> None:
    """Drawn anew wherever it stands it would change the log; found anywhere it would stop it."""
    log = write(tmp_path / "r", course_of("P01"), f"2026-03-01T10-00-00_{word}_S01")
    log.write_bytes(log.read_bytes().replace(b'"P01"', f'"{word}"'.encode()))
    with pytest.raises(BundleError, match=f"code {word!r} is a word of logs") as raised:
        bundled(tmp_path / "r", tmp_path / "osf", recode=True)
    assert f"--public {word}" in raised.value.remedy
    bundled(tmp_path / "r", tmp_path / "osf", recode=True, public=[word])
    assert {row["participant"] for row in table(tmp_path / "osf", "answers")}.isdisjoint({word})
    [row] = [row for row in table(tmp_path / "osf", "actions") if row["action"] == "Hello"][:1]
    assert (row["panel"], row["source"]) == ("Speech", "key")
    bundled(tmp_path / "r", tmp_path / "plain")


def test_materials_do_not_tell_of_the_labs_computer(tmp_path: Path) -> None:
    """A robot that comes with woz-tui lies where that was installed."""
    log = write(tmp_path / "r", course_of("P01"), "2026-03-01T10-00-00_P01_S01")
    for name in (b"../../opt/lab-7/robots/simulated.yaml", b"/opt/lab-7/robots/simulated.yaml"):
        told = log.read_bytes().replace(b'"robots/simulated.yaml"', b'"%b"' % name)
        (tmp_path / "r" / log.name).write_bytes(told)
        bundled(tmp_path / "r", tmp_path / "osf", force=True)
        assert (tmp_path / "osf" / "materials" / "robots" / "simulated.yaml").exists()
        assert not [name for name, data in everything(tmp_path / "osf").items() if b"lab-7" in data]
        log.write_bytes(told.replace(b'"%b"' % name, b'"robots/simulated.yaml"'))


def test_what_people_said_is_there_by_choice_agreement_and_without_names(tmp_path: Path) -> None:
    recordings = recorded(tmp_path / "r")
    with pytest.raises(BundleError, match="only if participants agreed"):
        bundled(recordings, tmp_path / "osf", transcripts=True)
    about = About(share=("transcripts",))
    VisitorStore(recordings / "visitors.json").add("Ben Young", on=None)
    for log in recordings.glob("*_P02_*.jsonl"):
        said = log.read_bytes().replace(b"I am Anna Keller-Winter.", b"I am KELLER, and young Ben.")
        log.write_bytes(said)
    out = tmp_path / "osf"
    bundled(recordings, out, about, transcripts=True, recode=True, names=[NAME, ""])
    rows = table(out, "transcripts")
    codes = {row["participant"] for row in table(out, "answers")}
    assert {row["participant"] for row in rows} == codes
    assert sorted(row["text"] for row in rows) == [
        *["I am [NAME_1], and [NAME_2] [NAME_2]."] * 2,
        *["I am [NAME_1]."] * 4,
    ]
    assert {(row["condition"], row["trial"]) for row in rows} >= {("warm", "1"), ("sober", "2")}
    told = (out / "documentation" / "transcripts.md").read_text()
    assert ("| [NAME_1] | 6 |" in told, "no anonymisation" in told) == (True, True)
    assert frictionless.Package(str(out / "datapackage.json")).validate().valid
    measured = json.loads((out / "dataset_description.json").read_text())["variableMeasured"]
    assert {"onset", "text"} <= {each["name"] for each in measured}
    for name, data in everything(out).items():
        assert not re.search(rb"Anna|Keller|KELLER|Young", data), name
    bundled(recordings, out, about, transcripts=True, force=True)
    bundled(recordings, out, about, transcripts=True, names=["Zoe"], force=True)
    assert "| [NAME_2] | 4 |" in (out / "documentation" / "transcripts.md").read_text()
    bundled(recordings, out, about, transcripts=True, force=True)
    assert "no list of names was given" in (out / "TODO.md").read_text()
