"""All textures of a world in one array, each at every halved size."""

from __future__ import annotations

from functools import lru_cache
from typing import NamedTuple, TypeAlias
from zlib import crc32

import numpy as np
from numpy.typing import NDArray

from placecue.errors import DataError, choices
from placecue_office.pictures import PICTURES
from placecue_office.surfaces import SURFACES

Sizes: TypeAlias = NDArray[np.int64]
Colour: TypeAlias = tuple[int, ...]
#: A texture at every size.
Pyramid: TypeAlias = tuple[NDArray[np.uint8], ...]

#: Sizes that each texture is kept at.
LEVELS = 10

#: Textures that a process keeps, of each sort: recordings of one world share nearly all of theirs.
KEPT = 512

#: Sets the draws of repeating surfaces apart from those of pictures.
_SURFACE = 2**31


class Look(NamedTuple):
    """How a texture lies on a face.

    Attributes
    ----------
    texture : int
        Index of the texture.
    across, up : float
        Repeats a metre, horizontally and vertically.
    """

    texture: int
    across: float
    up: float


class AtlasBuilder:
    """Draws textures as materials are asked for.

    A material is a name, or a name and a colour: ``wood #b08050``. Repeating surfaces are drawn
    once for each material; pictures are drawn anew for each face. What is drawn does not depend
    on what else there is.

    Parameters
    ----------
    seed : int
        Seed of all that is drawn.
    resolution : float
        Pixels a metre of pictures.
    size : int
        Pixels across of repeating surfaces, a power of two.
    """

    def __init__(self, seed: int, resolution: float = 128.0, size: int = 256) -> None:
        self.seed = seed
        self.resolution = resolution
        self.size = size
        self._pyramids: list[Pyramid] = []
        self._known: dict[str, Look] = {}

    def look(self, material: str, width: float, height: float, key: int = 0, face: int = 0) -> Look:
        """Return the look of a face of ``width`` by ``height`` metres.

        Parameters
        ----------
        material : str
        width, height : float
            m.
        key, face : int
            Decide how a picture is drawn.

        Raises
        ------
        DataError
            If the material is unknown.
        """
        name, colour = _parse(material)
        if name in SURFACES:
            if material not in self._known:
                self._known[material] = self._surface(name, colour)
            return self._known[material]
        if name not in PICTURES:
            raise DataError(f"no material '{name}': {choices(name, [*SURFACES, *PICTURES])}")
        rows, columns = (_power_of_two(metres * self.resolution) for metres in (height, width))
        texture = self._add(_picture(self.seed, key, face, name, colour, rows, columns))
        return Look(texture, 1.0 / width, 1.0 / height)

    def _surface(self, name: str, colour: Colour) -> Look:
        surface = SURFACES[name]
        texture = self._add(_repeating(self.seed, name, colour, self.size))
        return Look(texture, 1.0 / surface.metres, 1.0 / (surface.tall or surface.metres))

    def _add(self, pyramid: Pyramid) -> int:
        self._pyramids.append(pyramid)
        return len(self._pyramids) - 1

    def pack(self) -> tuple[NDArray[np.uint8], Sizes, Sizes, Sizes]:
        """Return everything drawn so far as texels, offsets, widths and heights of a ``Skin``."""
        levels = [level for pyramid in self._pyramids for level in pyramid]
        sizes = np.array([level.shape[:2] for level in levels]).reshape(-1, LEVELS, 2)
        counts = sizes.prod(axis=2).ravel()
        starts = np.concatenate([[0], np.cumsum(counts)[:-1]]).reshape(-1, LEVELS)
        texels = np.concatenate([level.reshape(-1, 3) for level in levels])
        return texels, starts, sizes[..., 1].copy(), sizes[..., 0].copy()


@lru_cache(KEPT)
def _repeating(seed: int, name: str, colour: Colour, size: int) -> Pyramid:
    surface = SURFACES[name]
    rng = np.random.default_rng([seed, _SURFACE, crc32(name.encode()), *colour])
    return _pyramid(surface.draw(rng, np.array(colour, dtype=float), size * surface.finer))


@lru_cache(KEPT)
def _picture(
    seed: int, key: int, face: int, name: str, colour: Colour, rows: int, columns: int
) -> Pyramid:
    rng = np.random.default_rng([seed, key, face])
    return _pyramid(PICTURES[name](rng, np.array(colour, dtype=float), rows, columns))


def _parse(material: str) -> tuple[str, Colour]:
    name, _, colour = material.partition(" #")
    try:
        return name, tuple(bytes.fromhex(colour or "c8c8c8"))
    except ValueError as error:
        raise DataError(f"the colour of material '{material}' is not like #b08050") from error


def _power_of_two(pixels: float) -> int:
    return int(2 ** np.clip(np.round(np.log2(max(pixels, 1.0))), 4, 9))


def _pyramid(drawn: NDArray[np.float64]) -> Pyramid:
    """Return the texture at LEVELS sizes, each half the one before, the last ones 1 x 1."""
    levels, image = [], drawn
    for _ in range(LEVELS):
        levels.append(np.clip(np.rint(image), 0, 255).astype(np.uint8))
        if image.shape[0] > 1:
            image = 0.5 * (image[::2] + image[1::2])
        if image.shape[1] > 1:
            image = 0.5 * (image[:, ::2] + image[:, 1::2])
    return tuple(levels)
