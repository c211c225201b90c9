"""What is installed: names, types and data are the same in the tree, in an editable install and from the wheel."""

import importlib
import json
import re
import subprocess
import sys
import sysconfig
import tomllib
from pathlib import Path
from zipfile import ZipFile

import pytest

ROOT = Path(__file__).parents[1]
FOUND = """
import json
from pathlib import Path
import smash, smash_analysis, smash_baselines
from smash.experiments.best_known.files import LIST, list_to_write
from smash.problem.errors import SmashError
from smash_baselines.domains import DOMAINS
def content(folder):
    return {file.relative_to(folder).as_posix(): file.stat().st_size for file in folder.rglob("*") if file.is_file()}
try:
    list_to_write(None)
    changes = True
except SmashError:
    changes = False
print(json.dumps({
    "packages": [str(Path(package.__file__).parent) for package in (smash, smash_analysis, smash_baselines)],
    "domains": content(DOMAINS), "best known": content(LIST), "changes the list": changes,
}))
"""


def built(kind, target):
    """Build the wheel, or the one of an editable install, and unpack it; nothing is fetched."""
    for builder in ("hatchling", "editables"):
        pytest.importorskip(builder, reason=f"{builder} is not installed (the extra dev)")
    call = f"from hatchling.build import build_{kind} as build; build({str(target)!r})"
    subprocess.run([sys.executable, "-c", call], cwd=ROOT, check=True, capture_output=True, timeout=100)
    (wheel,) = target.glob("*.whl")
    with ZipFile(wheel) as content:
        content.extractall(target / "site")
        return target / "site", content.namelist()


@pytest.fixture(scope="module")
def wheel(tmp_path_factory):
    return built("wheel", tmp_path_factory.mktemp("wheel"))


def found_in(site, folder):
    """Return what an interpreter finds that knows `site` and, behind it, the packages of others."""
    others = sysconfig.get_path("purelib")  # its .pth files are not read: the tree is not on the path
    lines = f"import site, sys; site.addsitedir({str(site)!r}); sys.path.append({others!r})\n{FOUND}"
    ended = subprocess.run(
        [sys.executable, "-S", "-P", "-E", "-c", lines],
        cwd=folder,
        check=True,
        capture_output=True,
        text=True,
        timeout=100,
    )
    return json.loads(ended.stdout)


def in_tree(folder):
    top = ROOT / folder
    return {file.relative_to(top).as_posix(): file.stat().st_size for file in top.rglob("*") if file.is_file()}


def test_every_name_that_the_wheel_installs_begins_with_smash(wheel):
    assert {name.split("/")[0] for name in wheel[1]} == {
        *("smash", "smash_analysis", "smash_baselines"),
        next(name.split("/")[0] for name in wheel[1] if ".dist-info/" in name),
    }


def test_every_package_says_that_it_is_typed(wheel):
    for package in ("smash", "smash_analysis", "smash_baselines"):
        assert f"{package}/py.typed" in wheel[1]


def test_the_wheel_has_the_data_of_the_tree_and_reads_it(wheel, tmp_path):
    found = found_in(wheel[0], tmp_path)
    assert all(Path(package).parent == wheel[0] for package in found["packages"])
    assert found["domains"] == in_tree("domains")
    assert found["best known"] == in_tree("results/best-known")
    assert not found["changes the list"]


def test_the_wheel_has_every_robot_with_its_meshes_and_the_licence_of_each(wheel):
    shipped = {name for name in wheel[1] if name.startswith("smash/motion/robots/")}
    data = {f"smash/motion/robots/{name}" for name in in_tree("smash/motion/robots") if "__pycache__" not in name}
    assert data <= shipped
    folders = {name.split("/")[3] for name in data if "/meshes/" in name}
    assert {"ur5", "xarm7"} < folders
    metadata = next(name.split("/")[0] for name in wheel[1] if ".dist-info/" in name)
    for folder in folders:
        assert f"smash/motion/robots/{folder}/LICENSE.txt" in shipped
        assert f"{metadata}/licenses/smash/motion/robots/{folder}/LICENSE.txt" in wheel[1]


def test_an_editable_install_reads_the_tree(tmp_path):
    found = found_in(built("editable", tmp_path)[0], tmp_path)
    assert all(Path(package).is_relative_to(ROOT) for package in found["packages"])
    assert found["domains"] == in_tree("domains")
    assert found["best known"] == in_tree("results/best-known")
    assert found["changes the list"]


@pytest.fixture
def locked(monkeypatch):
    """The script that hands out parts of the lock."""
    monkeypatch.syspath_prepend(str(ROOT / ".ci"))
    return importlib.import_module("locked")


@pytest.fixture
def project():
    return tomllib.loads((ROOT / "pyproject.toml").read_text())


def test_the_lock_holds_every_dependency_its_builders_and_hashes_of_all(locked, project):
    entries = locked.entries()
    extras = [*project["project"]["optional-dependencies"], *project["dependency-groups"]]
    wanted = locked.asked(project, extras) | {locked.plain(word) for word in project["build-system"]["requires"]}
    assert wanted <= set(entries)
    assert all("==" in text.splitlines()[0] and "--hash=sha256:" in text for text, _ in entries.values())


def test_the_lock_names_no_host_and_no_path(locked):
    text = locked.LOCK.read_text()
    assert not re.findall(r"\w+://|index-url|find-links|@ file|(?<![\w.])/\w+", text)


def test_an_environment_gets_what_its_extras_reach_and_no_more(locked, project):
    entries = locked.entries()

    def names(*asked):
        return set(locked.reached(locked.asked(project, list(asked)), entries))

    assert {"click", "numpy", "llvmlite"} <= names()
    assert not {"pandas", "matplotlib", "hatchling", "uv"} & names()
    assert {"pandas", "matplotlib", "kiwisolver", "numpy"} <= names("analysis")
    assert names("parquet") > names("analysis")
    assert {"hatchling", "editables", "setuptools", "wheel"} <= names("build")
    assert "click" not in names("build")
    assert names("all", "dev", "build", "lock") == set(entries)


def test_the_page_of_licences_has_every_package_of_the_lock(locked):
    rows = re.findall(
        r"^\| ([a-z0-9-]+) \| (\S+) \| ([^|]+) \| ([^|]+) \|$", (ROOT / "docs/licences.md").read_text(), re.M
    )
    shown = {name: version for name, version, said, _ in rows[1:] if said.strip()}
    on_linux = {
        name: re.split(r"==|\s", text)[1]
        for name, (text, _) in locked.entries().items()
        if "== 'win32'" not in text.splitlines()[0]
    }
    assert shown == on_linux


def test_citation_and_package_are_of_one_version_and_releases_have_a_heading(project):
    citation = (ROOT / "CITATION.cff").read_text(encoding="utf-8")
    version = project["project"]["version"]
    assert re.search(r"^version: (.+)$", citation, re.MULTILINE)[1] == version
    released = re.search(r"^date-released: (.+)$", citation, re.MULTILINE)[1]
    changes = (ROOT / "CHANGELOG.md").read_text(encoding="utf-8")
    assert re.search(rf"^## \[?{re.escape(version)}\]? - {released}$", changes, re.MULTILINE)


def test_every_entry_that_the_paper_cites_is_in_its_bibliography():
    cited = set(re.findall(r"@([\w-]+)", (ROOT / "paper.md").read_text(encoding="utf-8")))
    assert cited == set(re.findall(r"^@\w+\{([\w-]+),", (ROOT / "paper.bib").read_text(encoding="utf-8"), re.MULTILINE))
