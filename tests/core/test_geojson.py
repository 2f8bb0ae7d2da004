"""GeoJSON files: shapes as arrays, and one line for those that make no sense."""

import json
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from placecue import DataError, Feature, read_geojson

SQUARE = [[0, 0], [4, 0], [4, 3], [0, 3], [0, 0]]


def write(folder: Path, content: Any) -> Path:
    path = folder / "shapes.geojson"
    path.write_text(content if isinstance(content, str) else json.dumps(content))
    return path


def feature(folder: Path, shape: str, coordinates: Any, **properties: Any) -> Feature:
    geometry = {"type": shape, "coordinates": coordinates}
    one = {"type": "Feature", "properties": properties, "geometry": geometry}
    (found,) = read_geojson(write(folder, {"features": [one], "name": "x"})).features
    return found


def every_shape(found: Feature) -> list[Any]:
    return [*found.polygons(), *found.lines(), *found.points()]


def test_shapes_as_arrays(tmp_path: Path) -> None:
    hole = [[1, 1, 9], [2, 1, 9], [2, 2, 9], [1, 1, 9]]
    found = feature(tmp_path, "Polygon", [SQUARE, hole], label="lab")
    ((outline, inner),) = found.polygons()
    np.testing.assert_array_equal(outline, SQUARE)
    np.testing.assert_array_equal(inner, np.array(hole)[:, :2])  # the height is left out
    assert (found.properties, found.lines(), found.points()) == ({"label": "lab"}, [], [])
    many = feature(tmp_path, "MultiPolygon", [[SQUARE], [SQUARE, hole]]).polygons()
    assert [len(rings) for rings in many] == [1, 2]
    (line,) = feature(tmp_path, "LineString", [[0, 0.5], [1, 2]]).lines()
    np.testing.assert_array_equal(line, [[0, 0.5], [1, 2]])
    assert len(feature(tmp_path, "MultiLineString", [SQUARE, SQUARE, SQUARE]).lines()) == 3
    (point,) = feature(tmp_path, "Point", [3, 4, 5]).points()
    np.testing.assert_array_equal(point, [[3, 4]])
    assert feature(tmp_path, "MultiPoint", [[3, 4]]).polygons() == []


def test_what_stands_beside_the_features(tmp_path: Path) -> None:
    bare = {"type": "Feature", "properties": None, "geometry": None}
    path = write(tmp_path, {"name": "floor 3", "features": [bare], "height": 2.5})
    found = read_geojson(path)
    assert dict(found.members) == {"name": "floor 3", "height": 2.5}
    assert (found.features[0].shape, dict(found.features[0].properties)) == ("", {})


@pytest.mark.parametrize(
    ("content", "said"),
    [
        ("", "JSONDecodeError: Expecting value"),
        ([1], "TypeError: it is a list"),
        ({"name": "x"}, "KeyError: 'features'"),
        ({"features": 3}, "TypeError: 'int' object is not iterable"),
        ({"features": [{}, 7]}, "TypeError: feature 1 is an int"),
        ({"features": [{"properties": "x"}]}, "TypeError: 'properties' of feature 0 is a str"),
        ({"features": [{"geometry": [1]}]}, "TypeError: 'geometry' of feature 0 is a list"),
    ],
)
def test_what_is_no_collection(tmp_path: Path, content: Any, said: str) -> None:
    path = write(tmp_path, content)
    with pytest.raises(DataError) as caught:
        read_geojson(path, "the plan")
    told = str(caught.value)
    assert told.startswith(f"the plan {path} is not a GeoJSON FeatureCollection ({said}")
    assert "\n" not in told


@pytest.mark.parametrize(
    ("shape", "coordinates", "said"),
    [
        ("Polygon", None, "a Polygon without coordinates"),
        ("MultiPolygon", [7], "a MultiPolygon without coordinates"),
        ("Polygon", [[[0, 0], [1, 1]]], "a Polygon of fewer than three points"),
        ("Polygon", [[[0], [1], [2]]], "a Polygon of fewer than three points, or not of finite"),
        ("Polygon", [[[0, 0], [1, 1], [2, float("inf")]]], "or not of finite numbers"),
        ("Polygon", [[["a", 1], [2, 3], [4, 5]]], "ValueError: could not convert string"),
        ("Polygon", [[[0, 0], [1], [2, 2]]], "ValueError: "),
        ("Polygon", [7], "TypeError: "),
        ("LineString", [[0, 0]], "a LineString of fewer than two points"),
        ("Point", [10**400, 0], "OverflowError: "),
    ],
)
def test_malformed_shapes(tmp_path: Path, shape: str, coordinates: Any, said: str) -> None:
    with pytest.raises(DataError) as caught:
        every_shape(feature(tmp_path, shape, coordinates))
    told = str(caught.value)
    assert told.startswith(f"feature 0 of {tmp_path / 'shapes.geojson'} is malformed: ")
    assert said in told
    assert "\n" not in told


def test_a_file_that_is_not_there(tmp_path: Path) -> None:
    path = tmp_path / "none.geojson"
    with pytest.raises(DataError, match=f"^cannot read the rooms {path}: No such file"):
        read_geojson(path, "the rooms")
