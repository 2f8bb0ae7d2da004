"""Every laser feature is in a family, and those that say the same are in one."""

from collections import Counter

import pytest

from placecue_cues.laser import LaserGeometry
from placecue_cues.scan.page import page

#: The columns of a family by the beginnings of their names, as in the list of the group's code.
GROUP = {
    "differences": ("f2", "f2_sd"),
    "size": ("f5", "f6", "f7"),
    "ranges": ("f8", "f8_sd", "f28", "f28_sd"),
    "boundary": ("f9", "f9_sd", "f29", "f29_sd"),
    "gaps": ("f14(", "f33("),
    "fourier": ("f16(",),
    "ellipse": ("f17", "f18", "f19", "f17_2", "f18_2", "f19_2"),
    "ratios": ("f27", "f27_sd"),
    "relative_gaps": ("f30(", "f34("),
    "form_factor": ("f31",),
    "kurtosis": ("f32",),
}
FULL = {
    "differences": ("difference_",),
    "ranges": ("range_mean", "range_std"),
    "kurtosis": ("range_kurtosis",),
    "gaps": ("gaps(",),
    "relative_gaps": ("relative_gaps(",),
    "ratios": ("ratio_",),
    "lines": ("line_share",),
    "minima": ("minima_",),
    "size": ("area", "perimeter"),
    "boundary": ("boundary_",),
    "fourier": ("fourier(",),
    "ellipse": ("ellipse_",),
    "moments": ("hu(", "compactness", "eccentricity"),
    "form_factor": ("form_factor",),
}


def belongs(name: str, beginnings: tuple[str, ...]) -> bool:
    return any(name == each or (each[-1] in "(_" and name.startswith(each)) for each in beginnings)


def test_group() -> None:
    cue = LaserGeometry("group")
    for name, family in zip(cue.feature_names, cue.families, strict=True):
        assert [each for each, names in GROUP.items() if belongs(name, names)] == [family], name
    # 20 gaps and 10 ratios, each as a count and as a share of the beams.
    sizes = Counter(cue.families)
    assert (sizes["fourier"], sizes["gaps"], sizes["relative_gaps"]) == (99, 40, 20)


@pytest.mark.parametrize("parameters", [{}, {"clips": [7.0], "gaps": [1.0], "fourier": 3}])
def test_full(parameters: dict[str, object]) -> None:
    cue = LaserGeometry("full", **parameters)  # type: ignore[arg-type]
    for name, family in zip(cue.feature_names, cue.families, strict=True):
        assert any(name.startswith(each) for each in FULL[family]), name
    assert set(cue.families) == set(FULL)


def test_the_defaults_of_full() -> None:
    cue = LaserGeometry("full")
    sizes = Counter(cue.families)
    assert sizes["fourier"] == 16
    assert (sizes["ranges"], sizes["differences"]) == (12, 12)  # as they are, and five clips
    assert "range_mean(clip=2)" in cue.feature_names


def test_the_page_names_every_family() -> None:
    written = page()
    for preset in ("group", "full"):
        for family in set(LaserGeometry(preset).families):
            assert f"| `{family}` |" in written
