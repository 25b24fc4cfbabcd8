import numpy as np
import pytest
import typst
from report.test_html import HOSTILE
from synthetic_output import document, walk_arrays, write_output

from gaitlab.report.blocks import Page, paragraph, section, table
from gaitlab.report.build import ReportOptions, build_report
from gaitlab.report.edition import DRAFT, INTENDED_USE, Edition
from gaitlab.report.pages import KEYS, report_pages
from gaitlab.report.pdf import pdf_report, typst_source
from gaitlab.report.source import read_source


@pytest.fixture(scope="module")
def source(tmp_path_factory):
    return read_source(write_output(tmp_path_factory.mktemp("out"), document(), walk_arrays()))


def test_the_same_source_gives_the_same_bytes(source):
    options = ReportOptions(formats=("pdf",), pages=("front", "kinematics", "stills"))
    first, second = (build_report(source, options, DRAFT, {})["pdf"] for _ in range(2))
    assert first.startswith(b"%PDF-") and first == second


def test_state_and_intended_use_stand_on_every_page(source):
    signed = Edition(number=2, signed_by="Dr. X", signed_at="2026-01-01", amended_by="Dr. Y", reason="wrong side")
    made = typst_source("P-1", report_pages(source, {}), signed)
    head = made.split("#show: paper.with(")[1].split("\n")[0]
    assert "Version 2, signed by Dr. X, 2026-01-01; amends version 1 (Dr. Y: wrong side)" in head
    assert INTENDED_USE in head and "signed: true" in head


def test_both_formats_hold_the_same_pages(source):
    pages = report_pages(source, {})
    made = typst_source("P-1", pages, DRAFT)
    assert [page.key for page in pages] == list(KEYS)
    assert all(f'#heading(level: 2, "{page.title}")' in made for page in pages)


def test_pages_can_be_chosen(source):
    assert [page.key for page in report_pages(source, {}, ("scores", "front"))] == ["front", "scores"]


def test_hostile_words_stay_words():
    words = 'a"#b] $c$ \\ #read("/etc/passwd") <x> @y ```' + HOSTILE + "\x01\ud800"
    page = Page(key="x", sections=(section(words, paragraph(words), table((words,), [(words, words)], words)),))
    assert pdf_report(words, [page], DRAFT).startswith(b"%PDF-")
    made = typst_source("P", [page], DRAFT)
    assert typst.query(made.encode(), "<x>") == "[]"


def test_long_fingerprints_may_break():
    page = Page(key="x", sections=(section("t", paragraph("a" * 64)),))
    assert "\u200b".join(["a" * 16] * 4) in typst_source("P", [page], DRAFT)


def test_a_broken_walk_and_nothing_at_all_still_make_a_report(tmp_path):
    empty = write_output(tmp_path, {}, {"time": np.zeros(0)}, angles=False)
    made = build_report(read_source(empty), ReportOptions(), DRAFT, {})
    assert made["pdf"].startswith(b"%PDF-") and b"Not shown: weights of the criteria" in made["html"]
