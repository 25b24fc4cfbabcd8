import json
from dataclasses import replace

import pytest
from report.page import Page
from synthetic_output import document, walk_arrays, write_output

from gaitlab.errors import OutputError
from gaitlab.report.build import ReportOptions
from gaitlab.report.files import (
    ReportFolders,
    amend_report,
    draft_report,
    problems_of,
    sign_report,
)
from gaitlab.report.ledger import LEDGER, read_ledger, refuse_signed

OPTIONS = ReportOptions(formats=("html",), pages=("front", "examination", "scores"))


@pytest.fixture
def folders(tmp_path):
    made = write_output(tmp_path / "out", document(), walk_arrays())
    return ReportFolders(results=made, report=made)


@pytest.fixture
def signed(folders):
    draft_report(folders, OPTIONS)
    sign_report(folders, "Dr. X")
    return folders


def names(folders):
    return sorted(path.name for path in folders.report.glob("report*"))


def text(folders, name):
    return Page((folders.report / name).read_text()).text


def test_a_draft_says_so_and_may_be_made_anew(folders):
    draft_report(folders, ReportOptions(pages=("front",)))
    draft_report(folders, OPTIONS)
    ledger = read_ledger(folders.report)
    assert [(v.number, v.state) for v in ledger.versions] == [(1, "draft")]
    assert names(folders) == ["report.html", LEDGER]
    assert text(folders, "report.html").count("Draft of version 1, not signed") == 1 + 3


def test_a_signature_makes_files_of_its_own_that_cannot_be_written(signed):
    assert names(signed) == ["report-v1.html", LEDGER]
    assert "Version 1, signed by Dr. X, 20" in text(signed, "report-v1.html")
    assert (signed.report / "report-v1.html").stat().st_mode & 0o222 == 0
    assert problems_of(signed) == ()


def test_a_signed_report_is_never_overwritten(signed):
    before = (signed.report / "report-v1.html").read_bytes()
    with pytest.raises(
        OutputError, match=r"version 1 is signed by Dr\. X and is not overwritten; 'gaitlab report amend'"
    ):
        draft_report(signed, OPTIONS)
    with pytest.raises(OutputError, match="there is no draft to sign"):
        sign_report(signed, "Dr. Y")
    with pytest.raises(OutputError, match=r"holds a report signed by Dr\. X"):
        refuse_signed(signed.report)
    assert (signed.report / "report-v1.html").read_bytes() == before


def test_a_file_in_the_way_of_a_signature_is_kept(folders):
    draft_report(folders, OPTIONS)
    (folders.report / "report-v1.html").write_text("older")
    with pytest.raises(OutputError, match="no signed report is overwritten"):
        sign_report(folders, "Dr. X")
    assert (folders.report / "report-v1.html").read_text() == "older"


def test_an_amendment_keeps_the_old_version_and_says_why(signed):
    amend_report(signed, "Dr. Y", "wrong shoes")
    assert "amends version 1 (Dr. Y: wrong shoes)" in text(signed, "report.html")
    draft_report(signed, OPTIONS)
    sign_report(signed, "Dr. Z")
    assert [(v.number, v.state) for v in read_ledger(signed.report).versions] == [(1, "amended"), (2, "signed")]
    assert "Version 2, signed by Dr. Z" in text(signed, "report-v2.html")
    assert "amends version 1 (Dr. Y: wrong shoes)" in text(signed, "report-v2.html")
    assert {"report-v1.html", "report-v2.html"} <= set(names(signed)) and problems_of(signed) == ()


@pytest.mark.parametrize(("name", "words"), [("result.json", "result.json"), ("report.html", "report.html")])
def test_what_changed_since_it_was_read_is_not_signed(folders, name, words):
    draft_report(folders, OPTIONS)
    (folders.report / name).write_text(json.dumps(document(status="not_converged")))
    with pytest.raises(OutputError, match=f"{words} changed since the draft was made"):
        sign_report(folders, "Dr. X")


def test_changes_after_the_signature_are_found(signed):
    path = signed.report / "report-v1.html"
    path.chmod(0o644)
    path.write_text("forged")
    (signed.results / "result.json").write_text("{}")
    assert problems_of(signed) == (
        "version 1: report-v1.html is not what it was",
        "result.json changed since version 1",
    )


def test_a_report_may_lie_elsewhere(folders, tmp_path):
    (tmp_path / "elsewhere").mkdir()
    apart = replace(folders, report=tmp_path / "elsewhere")
    examination = tmp_path / "e.toml"
    examination.write_text('[patient]\npseudonym = "P-017"\n[[strength]]\nmuscle = "soleus"\nleft = 3\n')
    draft_report(apart, OPTIONS, examination)
    assert "Gait report: P-017" in text(apart, "report.html") and "soleus" in text(apart, "report.html")
    sign_report(apart, "Dr. X")
    assert names(folders) == [] and names(apart) == ["report-v1.html", LEDGER]


@pytest.mark.parametrize(
    ("call", "words"),
    [
        (lambda f: sign_report(f, "Dr. X"), "there is no draft to sign"),
        (lambda f: sign_report(f, " "), "signed by somebody"),
        (lambda f: amend_report(f, "Dr. X", "why"), "no signed report to amend"),
        (problems_of, "holds no report.json"),
    ],
)
def test_steps_in_the_wrong_order_are_refused(folders, call, words):
    with pytest.raises(OutputError, match=words):
        call(folders)


def test_an_amendment_needs_author_and_reason(signed):
    with pytest.raises(OutputError, match="an amendment has an author and a reason"):
        amend_report(signed, "Dr. X", " ")


def test_a_broken_ledger_stops_everything(folders):
    (folders.report / LEDGER).write_text("{")
    with pytest.raises(OutputError, match="is not a ledger of reports"):
        draft_report(folders, OPTIONS)
