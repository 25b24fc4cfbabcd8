"""`gaitlab report`: the command, and reports of bad input: still made, they say what is missing and why."""

import json
from dataclasses import replace
from pathlib import Path

import pytest
from report.page import Page
from synthetic_output import document, walk_arrays, write_output

from gaitlab.pipelines import analyse as analysis
from gaitlab.pipelines.analyse import analyse
from gaitlab.pipelines.options import AnalysisOptions
from gaitlab.pipelines.output import write_analysis
from gaitlab.pipelines.references import ReferenceOptions
from gaitlab.report.build import ReportOptions, build_report
from gaitlab.report.edition import DRAFT
from gaitlab.report.source import read_source

EXAMPLE = Path(__file__).parents[2] / "docs" / "examination.toml"
PAGES = "front,examination,scores"


@pytest.fixture
def folder(tmp_path):
    return write_output(tmp_path / "out", document(), walk_arrays())


def test_a_report_is_made_signed_amended_and_checked(gaitlab, folder):
    code, out, err = gaitlab("report", folder, "--pages", PAGES, "--examination", EXAMPLE, "--colours", "safe")
    assert code == 0, err
    assert out.splitlines() == [f"report: {folder / name}" for name in ("report.pdf", "report.html")]
    assert "spastic diplegia" in Page((folder / "report.html").read_text()).text
    assert gaitlab("report", "sign", folder, "--by", "Dr. X")[0] == 0
    code, _, err = gaitlab("report", folder)
    assert code == 2 and "version 1 is signed by Dr. X" in err
    assert gaitlab("report", "amend", folder, "--by", "Dr. Y", "--reason", "age")[0] == 0
    assert gaitlab("report", "sign", folder, "--by", "Dr. X")[0] == 0
    assert gaitlab("report", "check", folder)[:2] == (0, "report and results are what report.json says\n")
    states = [version["state"] for version in json.loads((folder / "report.json").read_text())["versions"]]
    assert states == ["amended", "signed"]
    (folder / "result.json").write_text("{}")
    code, _, err = gaitlab("report", "check", folder)
    assert code == 2 and "result.json changed since version 2" in err


def test_results_of_a_signed_report_are_kept(gaitlab, folder):
    gaitlab("report", folder, "--pages", "front", "--format", "html")
    gaitlab("report", "sign", folder, "--by", "Dr. X")
    code, _, err = gaitlab("analyse", "walk.c3d", "--out", folder)
    assert code == 2 and "holds a report signed by Dr. X" in err


@pytest.mark.parametrize(
    ("options", "words"),
    [
        (("--format", "docx"), "--format docx is not known; give pdf or html"),
        (("--pages", "front,end"), "pages 'end' do not exist; available: front, examination"),
        (("--pages", ","), "available: front"),
        (("--colours", "grey"), "'grey'"),
        (("--examination", "absent.toml"), "examination absent.toml cannot be read"),
    ],
)
def test_bad_options_are_refused(gaitlab, folder, options, words):
    code, _, err = gaitlab("report", folder, *options)
    assert code == 2 and words in err and not (folder / "report.json").exists()


def test_a_folder_without_a_result_is_refused(gaitlab, tmp_path):
    code, _, err = gaitlab("report", tmp_path)
    assert code == 2 and "has no result.json" in err


def _far(plate):
    return replace(plate, corners=plate.corners + [9.0, 9.0, 0.0])


def _corrupt(folder):
    (folder / "broken.json").write_text("{")
    return ReferenceOptions(norms=str(folder / "broken.json"))


def _adult(folder):
    return ReferenceOptions(age=60.0)


def _bundled(folder):
    return ReferenceOptions()


BAD = {
    "no plates": (lambda w: replace(w, force_plates=()), _bundled, "no kinetics, the file holds no usable force plate"),
    "plates without feet": (
        lambda w: replace(w, force_plates=tuple(map(_far, w.force_plates))),
        _bundled,
        "no kinetics of the left side, its foot has no valid contact with a force plate",
    ),
    "no norms for this age": (lambda w: w, _adult, "no norms for this age: Schwartz 2008"),
    "one side only": (lambda w: w, _bundled, "right side: no complete cycle with all markers"),
    "one cycle only": (lambda w: w, _bundled, "left side: one cycle only, so there is no standard deviation"),
    "corrupt norm file": (lambda w: w, _corrupt, "no norms: norms broken.json is not a gaitlab reference cohort"),
}


@pytest.mark.shared_data
@pytest.mark.parametrize("case", BAD)
def test_bad_input_still_makes_a_report_that_says_why(recordings, tmp_path, monkeypatch, case):
    change, references, words = BAD[case]
    if case == "one side only":
        left = tuple(event for event in recordings["straight"].events if event.side == "left")
        monkeypatch.setattr(analysis, "events_to_use", lambda *_: left)
    options = AnalysisOptions(weights=False, references=references(tmp_path))
    found = analyse(recordings["static"], [change(recordings["straight"])], options)
    write_analysis(found, tmp_path / "out")
    pages = ("front", "kinematics", "kinetics", "scores")
    made = build_report(read_source(tmp_path / "out"), ReportOptions(pages=pages), DRAFT, {})
    text = Page(made["html"].decode()).text
    assert made["pdf"].startswith(b"%PDF-") and "Not in this report" in text
    assert words in text.split("Not in this report")[1]
