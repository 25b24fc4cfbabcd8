"""Reads a page as a browser would: text, elements, addresses."""

from html.parser import HTMLParser

from gaitlab.report.build import ReportOptions, build_report
from gaitlab.report.edition import DRAFT
from gaitlab.report.pages import KEYS
from gaitlab.report.source import read_source

VOID = {"meta", "br", "hr", "img", "link", "input"}


def render(directory, *pages):
    """The report of a result folder as HTML; all pages unless some are named."""
    options = ReportOptions(formats=("html",), pages=pages or KEYS)
    return build_report(read_source(directory), options, DRAFT, {})["html"].decode()


class Page(HTMLParser):
    def __init__(self, markup):
        super().__init__()
        self.elements, self.words, self.open, self.unclosed = [], [], [], []
        self.feed(markup)
        self.close()

    def handle_starttag(self, tag, attrs):
        self.elements.append((tag, dict(attrs)))
        if tag not in VOID:
            self.open.append(tag)

    def handle_startendtag(self, tag, attrs):
        self.elements.append((tag, dict(attrs)))

    def handle_endtag(self, tag):
        if not self.open or self.open.pop() != tag:
            self.unclosed.append(tag)

    def handle_data(self, data):
        if "style" not in self.open:
            self.words.append(data)

    @property
    def text(self):
        return " ".join(" ".join(self.words).split())

    def attributes(self, name):
        return [attrs[name] for _, attrs in self.elements if name in attrs]

    def tags(self):
        return {tag for tag, _ in self.elements}
