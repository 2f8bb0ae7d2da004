"""What is public: everything that a component is written with, the built-ins among them."""

from __future__ import annotations

import ast
from collections.abc import Iterator
from pathlib import Path

import pytest

import placecue

ROOT = Path(placecue.__file__).parents[2]
OWN = ast.parse(Path(placecue.__file__).read_text())


def imported(tree: ast.AST, package: str) -> Iterator[str]:
    """Yield the names that a module imports from a package, wherever in it they are."""
    for node in ast.walk(tree):
        if isinstance(node, ast.Import):
            assert not any(each.name.split(".")[0] == package for each in node.names)
        elif isinstance(node, ast.ImportFrom) and (node.module or "").split(".")[0] == package:
            yield from (each.name for each in node.names)


def test_built_ins_import_nothing_that_is_not_public() -> None:
    private = {
        str(path.relative_to(ROOT)): names
        for path in (ROOT / "plugins").rglob("*.py")
        if (names := {*imported(ast.parse(path.read_text()), "placecue")} - {*placecue.__all__})
    }
    assert private == {}


def test_the_list_is_written_out_and_holds_what_checkers_see() -> None:
    [listed] = [
        ast.literal_eval(node.value)
        for node in OWN.body
        if isinstance(node, ast.Assign) and ast.unparse(node.targets[0]) == "__all__"
    ]
    assert listed == sorted(placecue.__all__)
    assert set(listed) == {*imported(OWN, "placecue"), "__version__"}


def test_every_public_name_is_there_and_is_no_module_by_accident() -> None:
    modules = [n for n in placecue.__all__ if type(getattr(placecue, n)) is type(ast)]
    assert modules == ["contracts", "estimators"]
    with pytest.raises(AttributeError, match="has no attribute 'Nothing'"):
        _ = placecue.Nothing
