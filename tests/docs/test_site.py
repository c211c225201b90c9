"""The site is whole: every name of the door is in the reference, no link is dead, nothing is fetched from the net."""

import os
import re
import subprocess
import sys
from html.parser import HTMLParser
from pathlib import Path
from urllib.parse import unquote, urlsplit

import pytest

import smash
from tests.docs.blocks import ROOT

DOCS = ROOT / "docs"
LOADED = {("script", "src"), ("img", "src"), ("link", "href"), ("iframe", "src"), ("source", "src")}


class Links(HTMLParser):
    """What a page names, what it loads, and the anchors that it has."""

    def __init__(self, page):
        super().__init__()
        self.named, self.loaded, self.anchors = set(), set(), set()
        self.feed(page.read_text(encoding="utf-8"))

    def handle_starttag(self, tag, attrs):
        for name, value in attrs:
            if name in ("id", "name") and value:
                self.anchors.add(value)
            if name in ("href", "src") and value:
                (self.loaded if (tag, name) in LOADED else self.named).add(value)


def test_every_name_of_the_door_is_in_its_reference():
    page = (DOCS / "reference" / "door.md").read_text(encoding="utf-8")
    shown = re.findall(r"^::: smash\.(\w+)$", page, re.MULTILINE)
    assert sorted(shown) == sorted(set(smash.__all__) - {"__version__"})
    assert "`smash.__version__`" in page


def test_every_page_has_its_place_in_the_site():
    placed = set(re.findall(r"([\w/.-]+\.md)$", (ROOT / "mkdocs.yml").read_text(encoding="utf-8"), re.MULTILINE))
    pages = {page.relative_to(DOCS).as_posix() for page in DOCS.rglob("*.md")}
    assert pages == placed - {"CONTRIBUTING.md", "CHANGELOG.md"}


@pytest.fixture(scope="module")
def site(tmp_path_factory):
    """The site as `make docs` builds it; any warning fails the build."""
    pytest.importorskip("material")
    pytest.importorskip("mkdocstrings_handlers.python")
    folder = tmp_path_factory.mktemp("docs") / "site"
    command = [sys.executable, "-m", "mkdocs", "build", "--strict", "--site-dir", str(folder)]
    silent = {**os.environ, "NO_MKDOCS_2_WARNING": "1"}
    built = subprocess.run(command, cwd=ROOT, env=silent, capture_output=True, text=True, timeout=600)
    assert built.returncode == 0, built.stderr
    assert "WARNING" not in built.stderr
    return folder


@pytest.mark.slow
def test_no_link_within_the_site_is_dead_and_nothing_is_fetched(site):
    pages = {page: Links(page) for page in site.rglob("*.html")}
    assert len(pages) > 30
    dead, fetched = [], []
    for page, links in pages.items():
        where = page.relative_to(site)
        for link in links.named | links.loaded:
            parts = urlsplit(link)
            if parts.scheme or link.startswith("//"):
                fetched += [f"{where}: {link}"] if link in links.loaded and parts.scheme != "data" else []
                continue
            target = (page.parent / unquote(parts.path)).resolve() if parts.path else page
            target = target / "index.html" if target.is_dir() else target
            anchor = unquote(parts.fragment)
            if not target.is_file() or (anchor and target in pages and anchor not in pages[target].anchors):
                dead.append(f"{where}: {link}")
    assert dead == []
    assert fetched == []


@pytest.mark.slow
def test_no_style_asks_the_net(site):
    for style in site.rglob("*.css"):
        assert not re.search(r"(url\(|@import )[\"']?(https?:)?//", Path(style).read_text(encoding="utf-8")), style


@pytest.mark.slow
def test_every_name_of_the_door_has_an_entry(site):
    anchors = Links(site / "reference" / "door.html").anchors
    assert {f"smash.{name}" for name in smash.__all__ if name != "__version__"} <= anchors


def test_every_link_between_files_is_there():
    """Of the pages as they lie in the repository; the site's own links are read when it is built (slow)."""
    pages = (*ROOT.glob("*.md"), *(ROOT / "examples").rglob("*.md"), *DOCS.rglob("*.md"))
    code = re.compile(r"^ *(```|~~~).*?^ *\1\s*$|`[^`\n]*`", re.MULTILINE | re.DOTALL)
    dead = {}
    for page in pages:
        text = code.sub("", page.read_text(encoding="utf-8"))
        for link in re.findall(r"\]\((?!https?:|#)([^)#\s]+)", text):
            if not (page.parent / unquote(link)).exists():
                dead[page.relative_to(ROOT).as_posix()] = link
    assert dead == {}


def test_what_pages_link_to_outside_of_them_is_in_the_site():
    hooks = (DOCS / "site" / "hooks.py").read_text(encoding="utf-8")
    shown = re.search(r"^SHOWN = \(([^)]*)\)", hooks, re.MULTILINE)[1]
    inside = {"docs", *re.findall(r'"([\w.]+)"', shown), "CONTRIBUTING.md", "CHANGELOG.md"}
    for page in DOCS.rglob("*.md"):
        for link in re.findall(r"\]\((\.\./[^)#\s]+)", page.read_text(encoding="utf-8")):
            target = (page.parent / link).resolve().relative_to(ROOT)
            assert target.parts[0] in inside, f"{page.name} links to {target}"


@pytest.mark.slow
def test_no_list_or_table_has_run_into_a_paragraph(site):
    """The site wants four spaces below an item where GitHub takes two, and an empty line before a table."""
    for page in site.rglob("*.html"):
        if page.parent.name != "reference":
            run = r"<(p|li)>(?:(?!</?(?:p|li|ul|pre|table)\b).)*?\n(?:- |\| ?\w)"
            assert not re.search(run, page.read_text(encoding="utf-8"), re.DOTALL), page
