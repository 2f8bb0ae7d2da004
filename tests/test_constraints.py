"""The oldest versions that the tests run with are those that pyproject.toml declares."""

import tomllib
from pathlib import Path

from packaging.requirements import Requirement
from packaging.utils import canonicalize_name
from packaging.version import Version

ROOT = Path(__file__).parents[1]


def pins(name: str) -> dict[str, Version]:
    lines = (ROOT / ".ci" / name).read_text().splitlines()
    pinned = [Requirement(line) for line in lines if line and not line.startswith("#")]
    return {
        canonicalize_name(each.name): Version(spec.version)
        for each in pinned
        for spec in each.specifier
    }


def test_each_declared_minimum_is_pinned_and_what_is_pinned_is_allowed() -> None:
    project = tomllib.loads((ROOT / "pyproject.toml").read_text())
    declared = [
        Requirement(line)
        for line in [*project["project"]["dependencies"], *project["dependency-groups"]["dev"]]
    ]
    oldest, newest = pins("constraints-oldest.txt"), pins("constraints.txt")
    for requirement in declared:
        name = canonicalize_name(requirement.name)
        [minimum] = [s.version for s in requirement.specifier if s.operator == ">="]
        # 4.11 is pinned as 4.11.0.86: the first release of it.
        assert oldest[name].release[: len(Version(minimum).release)] == Version(minimum).release
        for pinned in (oldest, newest):
            assert requirement.specifier.contains(pinned[name]), requirement
