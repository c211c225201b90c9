"""Simulates packages that are not installed, as the import system would see it."""

from importlib.machinery import PathFinder


class WithoutPackages:
    """Stands in place of the path finder and finds none of the packages."""

    def __init__(self, *packages):
        self.packages = packages

    find_distributions = staticmethod(PathFinder.find_distributions)

    def find_spec(self, name, path=None, target=None):
        if name.partition(".")[0] in self.packages:
            return None
        return PathFinder.find_spec(name, path, target)


HIDDEN = """
import sys
from importlib.machinery import PathFinder
from tests.door.missing import WithoutPackages
sys.meta_path = [WithoutPackages(*{packages!r}) if finder is PathFinder else finder for finder in sys.meta_path]
"""
"""A program that begins so sees none of the packages."""
