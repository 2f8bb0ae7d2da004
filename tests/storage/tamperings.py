"""Single ways to tamper with a model folder, each given the folder, chance and a marker file.

A marker file is there when a payload has run.
"""

from __future__ import annotations

import json
import os
import random
import shutil
import zipfile
from collections.abc import Iterator
from io import BytesIO
from pathlib import Path
from typing import Any

import numpy as np
from numpy.lib import format as npy

FILES = ("manifest.json", "state.json", "arrays.npz")
JSON = ("manifest.json", "state.json", "state.json")


class Payload:
    """Makes a file when it is unpickled."""

    def __init__(self, marker: Path) -> None:
        self.marker = str(marker)

    def __reduce__(self) -> tuple[Any, ...]:
        return os.mkdir, (self.marker,)


# ---------------------------------------------------------------------------- whole files


def flip_a_bit(folder: Path, chance: random.Random, _: Path) -> None:
    path = folder / chance.choice(FILES)
    data = bytearray(path.read_bytes())
    data[chance.randrange(len(data))] ^= 1 << chance.randrange(8)
    path.write_bytes(bytes(data))


def cut_a_file(folder: Path, chance: random.Random, _: Path) -> None:
    path = folder / chance.choice(FILES)
    data = path.read_bytes()
    path.write_bytes(data[: chance.randrange(len(data))])


def lengthen_a_file(folder: Path, chance: random.Random, _: Path) -> None:
    with (folder / chance.choice(FILES)).open("ab") as file:
        file.write(chance.randbytes(100))


def remove_a_file(folder: Path, chance: random.Random, _: Path) -> None:
    (folder / chance.choice(FILES)).unlink()


def swap_two_files(folder: Path, chance: random.Random, _: Path) -> None:
    first, second = chance.sample(FILES, 2)
    (folder / first).rename(folder / "aside")
    (folder / second).rename(folder / first)
    (folder / "aside").rename(folder / second)


def _replaced(folder: Path, chance: random.Random) -> Path:
    path = folder / chance.choice(FILES)
    path.unlink()
    return path


def put_a_pipe(folder: Path, chance: random.Random, _: Path) -> None:
    os.mkfifo(_replaced(folder, chance))


def put_a_folder(folder: Path, chance: random.Random, _: Path) -> None:
    _replaced(folder, chance).mkdir()


def link_a_device(folder: Path, chance: random.Random, _: Path) -> None:
    _replaced(folder, chance).symlink_to("/dev/zero")


def link_to_outside(folder: Path, chance: random.Random, _: Path) -> None:
    path = folder / chance.choice(FILES)
    outside = folder.with_name("outside")
    shutil.copy(path, outside)
    path.unlink()
    path.symlink_to(outside)


def make_a_sparse_file(folder: Path, chance: random.Random, _: Path) -> None:
    os.truncate(folder / chance.choice(FILES), 48 * 2**20)


# ---------------------------------------------------------------------------- JSON

VALUES: list[Any] = [
    None, True, -1, 0, 3, 10**30, 1e308, -0.5, "", "x" * 2000, "a\nb", "../../etc/passwd", [], {},
    [[1, 2], [3]], {"@": "array"}, {"@": "nothing"}, {"@": []}, {"@": "mapping", "items": []},
    {"@": "layout", "value": {"layout": "one_against_one", "classes": ["a"]}},
    {"@": "layout", "value": {"layout": "probabilities", "classes": 3}},
    {"@": "scaling", "name": "range", "state": {"scale_": 1}},
    {"@": "tuple", "items": [1, 2]}, {"plugin": "svm"}, {"plugin": ["svm"]}, {"plugin": "nowhere"},
    {"plugin": "mcap", "path": "/dev/zero"},
    {"@": "component", "kind": "source", "spec": {"plugin": "mcap", "path": "/x"}, "state": {}},
    {"@": "component", "kind": "kernel", "spec": {"plugin": "rbf"}, "state": {"fit": 1}},
    {"@": "component", "kind": "kernel", "spec": {"plugin": "rbf"}, "state": {"x_": [1]}},
    {"@": "component", "kind": [], "spec": [], "state": []},
    {"@": "number", "value": "nan"}, {"@": "number", "value": 3},
    {"estimator": "os.system", "params": {"command": "true"}},
    {"estimator": "sklearn.pipeline.Pipeline", "params": {"steps": [], "memory": "/tmp"}},
]  # fmt: skip


def _places(value: Any) -> Iterator[tuple[Any, Any]]:
    """Yield every place in JSON data: a list or mapping, and the key in it."""
    keys = value if isinstance(value, dict) else range(len(value))
    for key in keys:
        yield value, key
        if isinstance(value[key], (dict, list)):
            yield from _places(value[key])


def _edited(folder: Path, chance: random.Random, change: Any) -> None:
    path = folder / chance.choice(JSON)
    data = json.loads(path.read_text())
    change(data, list(_places(data)))
    path.write_text(json.dumps(data))


def swap_a_value(folder: Path, chance: random.Random, _: Path) -> None:
    def change(data: Any, places: list[tuple[Any, Any]]) -> None:
        where, key = chance.choice(places)
        where[key] = chance.choice(VALUES)

    _edited(folder, chance, change)


def remove_a_key(folder: Path, chance: random.Random, _: Path) -> None:
    def change(data: Any, places: list[tuple[Any, Any]]) -> None:
        where, key = chance.choice(places)
        del where[key]

    _edited(folder, chance, change)


def exchange_two_values(folder: Path, chance: random.Random, _: Path) -> None:
    def change(data: Any, places: list[tuple[Any, Any]]) -> None:
        (a, i), (b, j) = chance.sample(places, 2)
        a[i], b[j] = json.loads(json.dumps([b[j], a[i]]))

    _edited(folder, chance, change)


def rename_a_key(folder: Path, chance: random.Random, _: Path) -> None:
    names = [
        "__class__",
        "extract",
        "fit_",
        "classes_",
        "__dict__",
        "_private_",
        "C",
        "plugin",
        "@",
    ]

    def change(data: Any, places: list[tuple[Any, Any]]) -> None:
        where, key = chance.choice([place for place in places if isinstance(place[1], str)])
        where[chance.choice(names)] = where.pop(key)

    _edited(folder, chance, change)


def name_another_component(folder: Path, chance: random.Random, _: Path) -> None:
    names = ["svm", "adaboost", "sklearn", "rbf", "linear", "mcap", "door", "crfh", "beams", "gdas"]

    def change(data: Any, places: list[tuple[Any, Any]]) -> None:
        where, key = chance.choice([p for p in places if p[1] in ("plugin", "name", "kind")])
        where[key] = chance.choice([*names, "kernel", "classifier", "source", "cue"])

    _edited(folder, chance, change)


def name_another_estimator(folder: Path, chance: random.Random, _: Path) -> None:
    names = [
        "os.system", "builtins.eval", "sklearn.svm.SVC", "sklearn.datasets.load_files",
        "sklearn.cluster.FeatureAgglomeration", "sklearn.linear_model.LogisticRegression",
        "sklearn.feature_extraction.text.CountVectorizer", "placecue.cli.run", "", 3, None,
    ]  # fmt: skip

    def change(data: Any, places: list[tuple[Any, Any]]) -> None:
        where, key = chance.choice([place for place in places if place[1] == "estimator"])
        where[key] = chance.choice(names)

    _edited(folder, chance, change)


def set_a_parameter(folder: Path, chance: random.Random, marker: Path) -> None:
    harmful = {
        "memory": str(marker), "n_jobs": 4, "verbose": 3, "cache": str(marker), "func": "eval",
        "kernel": "os.system", "max_depth": "deep", "random_state": -1, "criterion": str(marker),
        "max_features": [1], "class_weight": {"0": str(marker)}, "steps": [["a", "b"]],
    }  # fmt: skip

    def change(data: Any, places: list[tuple[Any, Any]]) -> None:
        where, key = chance.choice([place for place in places if place[1] == "params"])
        name = chance.choice(list(harmful))
        where[key] = {**(where[key] or {}), name: harmful[name]}

    _edited(folder, chance, change)


def spoil_the_text(folder: Path, chance: random.Random, _: Path) -> None:
    path = folder / chance.choice(JSON)
    text = path.read_text()
    spoilt = [
        "{" + text, text + "]", "[" * 100_000, "{\"a\":" * 50_000, "\ufeff" + text, "null", "3",
        text.replace("{", '{"format": 1, ', 1), text.replace("1", "9" * 5000, 1),
        text.replace("2", "NaN", 1), text.replace("0", "-Infinity", 1),
        text.replace(": 4", ": 1e9999"), '""',
        text.replace('"', '"\\ud800', 1), text.replace("kitchen", "\\udfff"),
        text.replace("office", "of\\u0000fice"), text.replace("kitchen", "kit\\nchen"),
        text[:-2] + ', "x": ' + "[" * 300 + "]" * 300 + "}",
    ]  # fmt: skip
    path.write_text(chance.choice(spoilt))


def write_no_text(folder: Path, chance: random.Random, _: Path) -> None:
    path = folder / chance.choice(JSON)
    path.write_bytes(path.read_bytes().replace(b"e", b"\xff", 1))


def write_very_much(folder: Path, chance: random.Random, _: Path) -> None:
    path = folder / chance.choice(JSON)
    path.write_text(path.read_text().rstrip()[:-1] + ', "x": [' + "{}," * 1_300_000 + "{}]}")


# ---------------------------------------------------------------------------- arrays


def _arrays(folder: Path) -> dict[str, np.ndarray]:
    with np.load(folder / "arrays.npz") as arrays:
        return dict(arrays)


def _one(folder: Path, chance: random.Random) -> tuple[dict[str, np.ndarray], str]:
    arrays = _arrays(folder)
    return arrays, chance.choice(list(arrays))


def drop_an_array(folder: Path, chance: random.Random, _: Path) -> None:
    arrays, name = _one(folder, chance)
    del arrays[name]
    np.savez(folder / "arrays.npz", **arrays)


def add_an_array(folder: Path, chance: random.Random, _: Path) -> None:
    arrays, _name = _one(folder, chance)
    np.savez(folder / "arrays.npz", surplus=np.zeros(3), **arrays)


def put_another_array(folder: Path, chance: random.Random, marker: Path) -> None:
    arrays, name = _one(folder, chance)
    array = arrays[name]
    others = [
        array[:-1] if array.ndim else array, array.reshape(-1), np.zeros((0, 3)), np.zeros(()),
        array.astype("U32"), np.full(array.shape, np.nan), np.full(array.shape, "x"),
        np.array([Payload(marker)] * 2, dtype=object), np.zeros(3, "M8[s]"), np.zeros(3, "c16"),
        np.zeros(3, [("a", "f8")]), np.zeros((2, 3), ">f4"), np.asfortranarray(np.ones((3, 4))),
    ]  # fmt: skip
    arrays[name] = chance.choice(others)
    np.savez(folder / "arrays.npz", **arrays)


def put_another_array_and_say_so(folder: Path, chance: random.Random, _: Path) -> None:
    arrays, name = _one(folder, chance)
    array = arrays[name]
    arrays[name] = chance.choice(
        [array[:-1], array[:0], array.reshape(-1), np.full(array.shape, np.inf), np.zeros((2, 3))]
    )
    np.savez(folder / "arrays.npz", **arrays)
    about = {"dtype": arrays[name].dtype.str, "shape": list(arrays[name].shape), "finite": True}
    about["finite"] = arrays[name].dtype.kind != "f" or bool(np.isfinite(arrays[name]).all())
    data = json.loads((folder / "state.json").read_text())
    for where, key in _places(data):
        if key == "array" and where[key] == name:
            where.update(about)
    (folder / "state.json").write_text(json.dumps(data))


def spoil_the_values(folder: Path, chance: random.Random, _: Path) -> None:
    arrays, name = _one(folder, chance)
    kind = arrays[name].dtype.kind
    values = {"f": [np.nan, np.inf, 1e308, 0.0], "i": [-1, 2**62, 0, 7], "U": ["", "\x00", "z"]}
    flat = arrays[name].reshape(-1)
    flat[chance.randrange(len(flat))] = chance.choice(values[kind])
    np.savez(folder / "arrays.npz", **arrays)


def pack_a_bomb(folder: Path, chance: random.Random, _: Path) -> None:
    arrays, name = _one(folder, chance)
    arrays[name] = np.zeros(4 * 2**20)
    np.savez_compressed(folder / "arrays.npz", **arrays)


def _members(folder: Path) -> dict[str, bytes]:
    with zipfile.ZipFile(folder / "arrays.npz") as archive:
        return {name: archive.read(name) for name in archive.namelist()}


def _packed(folder: Path, members: list[tuple[str, bytes]]) -> None:
    with zipfile.ZipFile(folder / "arrays.npz", "w") as archive:
        for name, data in members:
            archive.writestr(name, data)


def claim_a_huge_shape(folder: Path, chance: random.Random, _: Path) -> None:
    members = _members(folder)
    shape = chance.choice([(10**12,), (2**40, 2**40), (-1,), (-3, -8), (10**30, 0), (1,) * 70])
    head = BytesIO()
    npy.write_array_header_1_0(head, {"descr": "<f8", "fortran_order": False, "shape": shape})
    members[chance.choice(list(members))] = head.getvalue() + b"\0" * 24
    _packed(folder, list(members.items()))


def write_a_strange_header(folder: Path, chance: random.Random, _: Path) -> None:
    members = _members(folder)
    texts = [
        "{'descr': 'O', 'fortran_order': False, 'shape': (3,)}", "[" * 3000, "__import__('os')",
        "{'descr': '<f8', 'fortran_order': 3, 'shape': 'x'}", "{}", "\x00\xff", "9" * 9000,
        "{'descr': '<U0', 'fortran_order': False, 'shape': (10**4,)}",
        "{'descr': '<U2000000000', 'fortran_order': False, 'shape': (3,)}",
        "{'descr': [('a', '<f8', (99999999, 99))], 'fortran_order': False, 'shape': (1,)}",
    ]  # fmt: skip
    text = chance.choice(texts).encode("latin-1")
    magic = chance.choice([b"\x93NUMPY\x01\x00", b"\x93NUMPY\x02\x00", b"\x93NUMPY\x09\x00", b"PK"])
    data = magic + len(text).to_bytes(2, "little") + text + b"\0" * 24
    members[chance.choice(list(members))] = data
    _packed(folder, list(members.items()))


def name_members_strangely(folder: Path, chance: random.Random, _: Path) -> None:
    members = list(_members(folder).items())
    names = ["../../evil.npy", "a0.npy", "a0", "/etc/passwd.npy", "", "a0.npy/", "\udcff.npy"]
    members.append((chance.choice(names), members[0][1]))
    _packed(folder, members)


def put_a_pickle(folder: Path, chance: random.Random, marker: Path) -> None:
    import pickle

    members = _members(folder)
    name = chance.choice(list(members))
    members[name] = pickle.dumps(Payload(marker))
    _packed(folder, list(members.items()))


def put_many_members(folder: Path, chance: random.Random, _: Path) -> None:
    members = list(_members(folder).items())
    _packed(folder, members + [(f"x{i}.npy", members[0][1][:200]) for i in range(5000)])


FILE_TAMPERINGS = [
    flip_a_bit, cut_a_file, lengthen_a_file, remove_a_file, swap_two_files, put_a_pipe,
    put_a_folder, link_a_device, link_to_outside, make_a_sparse_file,
]  # fmt: skip
JSON_TAMPERINGS = [
    swap_a_value, swap_a_value, swap_a_value, remove_a_key, remove_a_key, exchange_two_values,
    rename_a_key, name_another_component, name_another_estimator, set_a_parameter, spoil_the_text,
    write_no_text, write_very_much,
]  # fmt: skip
ARRAYS_TAMPERINGS = [
    drop_an_array, add_an_array, put_another_array, put_another_array_and_say_so, spoil_the_values,
    pack_a_bomb, claim_a_huge_shape, write_a_strange_header, name_members_strangely, put_a_pickle,
    put_many_members,
]  # fmt: skip
