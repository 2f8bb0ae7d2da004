"""Files from anybody: what is no plain file, no strict JSON, or more than it says is refused."""

from __future__ import annotations

import math
import os
import zipfile
from io import BytesIO
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from numpy.lib import format as npy

from placecue import DataError
from placecue.storage.arrays import from_parts, read_arrays, write_arrays
from placecue.storage.guarded import opened, read_bytes
from placecue.storage.strict_json import dumps, loads

# ---------------------------------------------------------------------------- plain files


def test_a_plain_file_is_read(tmp_path: Path) -> None:
    (tmp_path / "a").write_bytes(b"abc")
    assert read_bytes(tmp_path / "a", 3) == b"abc"
    with pytest.raises(DataError, match="is larger than"):
        read_bytes(tmp_path / "a", 2)
    (tmp_path / "link").symlink_to(tmp_path)  # a folder may be reached through a link
    assert read_bytes(tmp_path / "link" / "a", 3) == b"abc"


def test_what_is_no_plain_file_is_refused_without_waiting(tmp_path: Path) -> None:
    os.mkfifo(tmp_path / "pipe")
    (tmp_path / "folder").mkdir()
    (tmp_path / "whole").write_bytes(b"x")
    (tmp_path / "zero").symlink_to("/dev/zero")
    (tmp_path / "link").symlink_to(tmp_path / "whole")
    said = {
        "pipe": "no plain file",
        "folder": "no plain file",
        "zero": "is a link",
        "link": "is a link",
        "nothing": "is missing",
        "whole/in it": "cannot be read",
        "\0": "cannot be read",
    }
    for name, why in said.items():
        with pytest.raises(DataError, match=why), opened(tmp_path / name):
            pass
    with pytest.raises(DataError, match="no plain file"), opened(Path("/dev/zero")):
        pass


# ---------------------------------------------------------------------------- JSON


@pytest.mark.parametrize(
    ("text", "why"),
    [
        (b'{"a": 1, "a": 2}', "twice"),
        (b"[NaN]", "NaN is no number"),
        (b"[-Infinity]", "-Infinity is no number"),
        (b"[1e999]", "too large"),
        (b"9" * 41, "41 digits"),
        (b"[" * 100_000, "nested too deep"),
        (b"[" * 101 + b"]" * 101, "nested deeper than 100"),
        (b'["\\ud800"]', "surrogates not allowed"),
        (b'["\xff"]', "can't decode"),
        (b"\xef\xbb\xbf[]", "BOM"),
        (b"[1] 2", "Extra data"),
        (b"", "Expecting value"),
    ],
)
def test_what_is_no_strict_json_is_refused(text: bytes, why: str) -> None:
    with pytest.raises(DataError, match=why) as told:
        loads(text, "state.json")
    assert str(told.value).startswith("state.json is damaged: ")


def test_plain_data_comes_back() -> None:
    data = {"a": [1, -0.1, True, None, "ä \n"], "b": {"c": [math.inf, -math.inf]}, "d": 2**100}
    assert loads(dumps(data), "it") == data
    assert math.isnan(loads(dumps([math.nan]), "it")[0])


# ---------------------------------------------------------------------------- arrays


def _packed(path: Path, members: dict[str, bytes], how: int = zipfile.ZIP_STORED) -> None:
    with zipfile.ZipFile(path, "w", how) as archive:
        for name, data in members.items():
            archive.writestr(name, data)


def _npy(array: np.ndarray) -> bytes:
    stream = BytesIO()
    npy.write_array(stream, array, allow_pickle=True)
    return stream.getvalue()


def _claiming(descr: str, shape: tuple[int, ...]) -> bytes:
    stream = BytesIO()
    npy.write_array_header_1_0(stream, {"descr": descr, "fortran_order": False, "shape": shape})
    return stream.getvalue() + b"\0" * 24


@pytest.mark.parametrize(
    "array",
    [
        np.arange(6.0).reshape(2, 3),
        np.asfortranarray(np.arange(6, dtype="i2").reshape(2, 3)),
        np.array(["office", "küche"]),
        np.array(3.5),
        np.zeros((0, 4)),
        np.array([True, False]),
        np.arange(3, dtype=">f4"),
        np.random.default_rng(0).normal(size=200_000),  # more than is read at a time
    ],
)
def test_arrays_come_back(tmp_path: Path, array: np.ndarray) -> None:
    found = read_arrays(write_arrays(tmp_path / "a.npz", {"x": array}))["x"]
    assert found.dtype == array.dtype
    assert found.shape == array.shape
    assert (found == array).all()
    assert found.flags.writeable


@pytest.mark.parametrize(
    ("members", "why"),
    [
        ({"x.npy": _npy(np.array([{}], dtype=object))}, "array of object"),
        ({"x.npy": _npy(np.zeros(2, [("a", "f8")]))}, "is an array of"),
        ({"x.npy": _npy(np.zeros(2, "c16"))}, "array of complex128"),
        ({"x.npy": _claiming("<f8", (2**40, 2**40))}, "says shape"),
        ({"x.npy": _claiming("<f8", (4,))}, "holds 24 bytes"),
        ({"x.npy": _claiming("<f8", (2,))}, "holds 24 bytes"),
        ({"x.npy": _claiming("<f8", (-3,))}, "says shape"),
        ({"x.npy": _claiming("<U0", (10**9,))}, "array of <U0"),
        ({"x.npy": _claiming("<U3", (2,)).replace(b"\0" * 24, b"\xff" * 24)}, "a character is"),
        ({"x.npy": _claiming("|b1", (24,)).replace(b"\0" * 24, b"\x07" * 24)}, "truth value"),
        ({"x.npy": b"no array"}, "damaged"),
        ({"x": _npy(np.zeros(2))}, "'x' is no array"),
    ],
)
def test_what_is_no_plain_array_is_refused(
    tmp_path: Path, members: dict[str, bytes], why: str
) -> None:
    _packed(tmp_path / "a.npz", members)
    with pytest.raises(DataError, match=why):
        read_arrays(tmp_path / "a.npz")


def test_what_grows_when_it_is_read_is_refused(tmp_path: Path) -> None:
    _packed(tmp_path / "a.npz", {"x.npy": _npy(np.zeros(2**20))}, zipfile.ZIP_DEFLATED)
    with pytest.raises(DataError, match="array 'x' is compressed"):
        read_arrays(tmp_path / "a.npz")


def test_a_changed_byte_is_noticed(tmp_path: Path) -> None:
    path = write_arrays(tmp_path / "a.npz", {"x": np.full(100, 7.0)})
    data = path.read_bytes()
    path.write_bytes(data.replace(np.float64(7).tobytes(), np.float64(8).tobytes(), 1))
    with pytest.raises(DataError, match="CRC"):
        read_arrays(path)


CSR = {"@": "csr", "shape": [1, 3]}
SETS = {"@": "descriptors"}


@pytest.mark.parametrize(
    ("what", "parts"),
    [
        (CSR, {"data": np.ones(1), "indices": np.array([3]), "indptr": np.array([0, 1])}),
        (CSR, {"data": np.ones(1), "indices": np.array([-1]), "indptr": np.array([0, 1])}),
        (CSR, {"data": np.ones(1), "indices": np.array([0]), "indptr": np.array([0, 2])}),
        (SETS, {"values": np.ones((2, 3)), "offsets": np.array([0, 3])}),
        (SETS, {"values": np.ones((2, 3)), "offsets": np.array([0, 2, 1, 2])}),
        (SETS, {"values": np.ones(2), "offsets": np.array([0, 2])}),
        (SETS, {"values": np.ones((2, 3)), "offsets": np.array([0.0, 2.0])}),
    ],
)
def test_parts_that_do_not_fit_one_another_are_refused(
    what: dict[str, Any], parts: dict[str, Any]
) -> None:
    with pytest.raises(ValueError, match=r"."):
        from_parts(what, parts)
