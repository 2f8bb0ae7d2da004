"""The page that lists the laser features is the one that the code writes."""

from pathlib import Path

from placecue_cues.laser import LaserGeometry
from placecue_cues.scan.page import page

PAGE = Path(__file__).parents[2] / "docs" / "laser_features.md"


def test_page_is_in_step() -> None:
    assert PAGE.read_text(encoding="utf-8") == page()


def test_names_are_unique_and_have_units() -> None:
    for preset in ("group", "full"):
        cue = LaserGeometry(preset)
        assert len(set(cue.feature_names)) == len(cue.feature_names) == len(cue.feature_units)
        assert set(cue.feature_units) <= {"m", "m²", "1/m", "1", "rad", "count"}
