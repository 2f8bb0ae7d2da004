from __future__ import annotations

from pathlib import Path

import cv2
import numpy as np
import pytest

from placecue.errors import DataError, UsageError
from placecue.logs import McapLog
from placecue.logs.writing.convert import copy
from placecue.logs.writing.writer import McapWriter
from placecue.observation import EncodedImage
from placecue_sources.image_folder import ImageFolder
from recordings import packed, picture, same, write


def classes(root: Path) -> Path:
    folder = root / "rooms"
    for number, name in enumerate(("img1.png", "img2.png", "img10.png")):
        write(folder / "kitchen" / name, picture(10 + number))
    write(folder / "office" / "north" / "a.JPG", picture(40, ".jpg"))
    write(folder / "office" / "b.bmp", picture(50, ".bmp"))
    write(folder / "notes.txt", "nothing")
    return folder


def test_the_first_folder_is_the_label(tmp_path: Path) -> None:
    source = ImageFolder(str(classes(tmp_path)), rate=10, conditions={"run": "2"})
    found = list(source)
    assert [o.label for o in found] == ["kitchen"] * 3 + ["office"] * 2
    assert [o.stamp for o in found] == [k * 10**8 for k in (1, 2, 3, 4, 5)]
    means = [float(np.mean(o.image)) for o in found if o.image is not None]
    np.testing.assert_allclose(means, [10, 11, 12, 50, 40], atol=2)
    assert source.count() == 5
    assert source.metadata == {"run": "2"}
    assert source.name == "rooms"


def test_a_folder_in_that_of_a_class_is_a_scene(tmp_path: Path) -> None:
    write(tmp_path / "rooms" / "kitchen" / "north" / "a.png", picture(20))
    found = list(ImageFolder(str(classes(tmp_path))))
    assert [o.scene for o in found] == [None] * 3 + ["kitchen/north", None, "office/north"]


def test_only_png_and_jpeg_pass_untouched(tmp_path: Path) -> None:
    found = list(ImageFolder(str(classes(tmp_path))))
    assert [isinstance(o.image_source, EncodedImage) for o in found] == [True] * 3 + [False, True]
    with McapWriter(tmp_path / "a.mcap") as writer:
        assert copy(ImageFolder(str(classes(tmp_path))), writer) == 5
    read = list(McapLog(str(tmp_path / "a.mcap")))
    assert [o.label for o in read] == [o.label for o in found]
    assert read[3].image is not None
    assert read[3].image.mean() == pytest.approx(50, abs=2)


def test_a_tar_of_the_folder_or_of_what_is_in_it(tmp_path: Path) -> None:
    folder = classes(tmp_path)
    tar = ImageFolder(str(packed(folder, tmp_path / "rooms.tar.gz", "w:gz", shuffled=True)))
    same(tar, ImageFolder(str(folder)))
    assert tar.digest() == ImageFolder(str(folder)).digest()


def test_bad_files_are_counted_once(tmp_path: Path, caplog: pytest.LogCaptureFixture) -> None:
    folder = classes(tmp_path)
    write(folder / "stray.png", picture(1))
    write(folder / "kitchen" / "img2.png", b"")
    assert len(list(ImageFolder(str(folder)))) == 4
    assert len(caplog.records) == 1
    assert "1 images lie in no folder of a class" in caplog.text
    assert "1 images cannot be read" in caplog.text


def test_nothing_of_use_is_said(tmp_path: Path) -> None:
    write(tmp_path / "a" / "notes.txt", "nothing")
    with pytest.raises(DataError, match="no folder with images"):
        list(ImageFolder(str(tmp_path)))
    with pytest.raises(UsageError, match="no folder and no tar"):
        list(ImageFolder(str(tmp_path / "none")))
    write(tmp_path / "a" / "x.png", b"")
    with pytest.raises(DataError, match="gives no observation: 1 images cannot be read"):
        list(ImageFolder(str(tmp_path)))
    with pytest.raises(UsageError, match="above 0"):
        list(ImageFolder(str(tmp_path), rate=0))


def test_the_digest_follows_content_and_labels(tmp_path: Path) -> None:
    folder = classes(tmp_path)
    digest = ImageFolder(str(folder)).digest()
    assert digest != ImageFolder(str(folder), rate=1).digest()
    (folder / "kitchen").rename(folder / "bath")
    assert digest != ImageFolder(str(folder)).digest()


def test_an_image_that_does_not_decode_is_left_to_its_user(tmp_path: Path) -> None:
    write(tmp_path / "a" / "x.png", b"\x89PNG\r\n\x1a\nnothing")
    (seen,) = ImageFolder(str(tmp_path))
    with pytest.raises(DataError, match=r"a/x\.png does not decode"):
        _ = seen.image
    assert cv2.imread(str(tmp_path / "a" / "x.png")) is None
