"""Folders of data: at the top of the tree, or inside of the packages where they are installed from a wheel."""

from __future__ import annotations

from pathlib import Path


def shipped(module: str, name: str) -> Path:
    """Return where a wheel has the folder `name`: beside the file `module`."""
    return Path(module).resolve().with_name(name)


def data_folder(module: str, name: str, in_tree: str) -> Path:
    """Return a folder of data.

    `pyproject.toml` says (`force-include`) which folder of the tree goes where in a wheel. In the tree, and in an
    editable install, which runs the tree, it is read where it lies.

    Args:
        module: `__file__` of the module that it belongs to.
        name: its name beside that module in a wheel.
        in_tree: its path from the top of the tree.
    """
    inside = shipped(module, name)
    tops = (top for top in inside.parents if (top / "pyproject.toml").is_file())
    return inside if inside.is_dir() else next((top / in_tree for top in tops), inside)
