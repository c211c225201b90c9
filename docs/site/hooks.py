"""What makes a site of `docs/`, whose pages are also read where they lie: links, blocks of code, the commands.

A link from a page to a file outside of `docs/` leads to a copy of that file in the site; CONTRIBUTING.md and
CHANGELOG.md are pages.
"""

from __future__ import annotations

import os
import re
from pathlib import Path, PurePosixPath

import click
from mkdocs.config.defaults import MkDocsConfig
from mkdocs.structure.files import File, Files
from mkdocs.structure.pages import Page

from smash.cli import COMMANDS, smash

ROOT = Path(__file__).parents[2]
PAGES = ("CONTRIBUTING.md", "CHANGELOG.md")
"""Pages beside `docs/`."""
SHOWN = ("examples", "experiments", "domains", "LICENSE")
"""Folders whose files pages link to, and single files."""
LINK = re.compile(r"(?<=\]\()(?!https?:|#)([^)#\s]+)(?=[)#])")
PICTURE = re.compile(r"^(!\[[^]\n]*\]\(([^)\s]+)\))$", re.MULTILINE)
FENCE = re.compile(r"^```(\w+) (\S+)$", re.MULTILINE)
NESTED = re.compile(r"^  (?=[-*] )", re.MULTILINE)
EVERY_COMMAND = "<!-- every command -->"


def on_files(files: Files, config: MkDocsConfig) -> Files:
    """Add what lies outside of `docs/`: pages, and the files that pages link to."""
    for name in PAGES:
        files.append(File.generated(config, name, abs_src_path=str(ROOT / name)))
    for name in SHOWN:
        for file in (ROOT / name, *sorted((ROOT / name).rglob("*"))):
            if file.is_file() and "__pycache__" not in file.parts:
                files.append(_copy(config, file))
    return files


def _copy(config: MkDocsConfig, file: Path) -> File:
    """Return a file as the site has it: under its own name, or as text where a reader's browser would not show it."""
    name = file.relative_to(ROOT).as_posix()
    if file.suffix in (".py", ".toml", ".pddl", ".md", ""):
        return File.generated(config, f"{name}.txt", content=file.read_bytes())
    return File.generated(config, name, abs_src_path=str(file))


def on_page_markdown(markdown: str, *, page: Page, config: MkDocsConfig, files: Files) -> str:
    """Make a page that GitHub shows one that this site shows."""
    if EVERY_COMMAND in markdown:
        markdown = markdown.replace(EVERY_COMMAND, _commands())
    markdown = PICTURE.sub(r"[\1](\2){.picture}", markdown)  # a click shows it as large as it is
    markdown = FENCE.sub(lambda fence: f"```{fence[1]}" + _title(fence[2]), markdown)
    here = PurePosixPath(page.file.src_uri).parent
    return LINK.sub(lambda link: _target(link[1], here, page.file.src_uri, files), NESTED.sub("    ", markdown))


def _title(word: str) -> str:
    """Return what a word behind a block's language becomes: a file's name is shown, what a block needs is not."""
    return f' title="{word}"' if "." in word else ""


def _target(link: str, here: PurePosixPath, page: str, files: Files) -> str:
    """Return a link between files of the repository as one between files of the site."""
    folder = PurePosixPath() if page in PAGES else PurePosixPath("docs") / here
    path = os.path.normpath(folder / link)
    inside = os.path.relpath(path, "docs") if path.startswith("docs/") else path
    for found in (inside, f"{inside}.txt"):
        if files.get_file_from_path(found):
            return os.path.relpath(found, here)
    return link


def _commands() -> str:
    """Return the help of every command, as `smash COMMAND --help` prints it."""
    parts = []
    for name in COMMANDS:
        parts.append(_help(name, smash.get_command(click.Context(smash), name)))
    return "\n".join(parts)


def _help(name: str, command: click.Command | None) -> str:
    assert command is not None
    with click.Context(command, info_name=f"smash {name}", max_content_width=100) as context:
        text = command.get_help(context).replace("\b", "")
        part = f"## `smash {name}`\n\n```text\n{text}\n```\n"
        if isinstance(command, click.Group):
            children = ((child, command.get_command(context, child)) for child in command.list_commands(context))
            part += "\n".join(_help(f"{name} {child}", one) for child, one in children)
    return part


def on_post_build(*, config: MkDocsConfig) -> None:
    """Leave out the page that only a server shows: its links begin at the server's root."""
    Path(config.site_dir, "404.html").unlink(missing_ok=True)
