"""A plan turned into the flat arrays that rays are cast against."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from placecue_office.arrays import Geometry, Skin
from placecue_office.atlas import AtlasBuilder, Look
from placecue_office.blocks import Block
from placecue_office.plan import Plan

#: The number of a block's cover, beside those of its sides.
COVER = 999


def build_geometry(plan: Plan, blocks: list[Block]) -> Geometry:
    """Flatten the blocks of a plan."""
    counts = [_edge_count(block) for block in blocks]
    return Geometry(
        faces=np.vstack([_edges(block) for block in blocks]),
        spans=np.repeat([(block.bottom, block.top) for block in blocks], counts, axis=0),
        starts=np.concatenate([[0], np.cumsum(counts)]).astype(np.int64),
        caps=np.array([_caps(block) for block in blocks]),
        ceiling=plan.height,
    )


def build_skin(plan: Plan, blocks: list[Block], seed: int) -> Skin:
    """Draw the surfaces of a plan's blocks, floors and ceilings.

    Parameters
    ----------
    plan : Plan
    blocks : list of Block
    seed : int
        Seed of the textures.
    """
    builder = AtlasBuilder(seed)
    looks = [look for block in blocks for look in _face_looks(plan, block, builder)]
    looks += [
        builder.look(block.cover or "plain", *_extent(block), block.key, COVER) for block in blocks
    ]
    looks += [builder.look(room.floor, 1.0, 1.0) for room in plan.rooms]
    looks += [builder.look(room.ceiling, 1.0, 1.0) for room in plan.rooms]
    return Skin(
        np.array([look.texture for look in looks], dtype=np.int64),
        np.array([(look.across, look.up) for look in looks]),
        _glows(blocks, len(looks)),
        *builder.pack(),
    )


def _edge_count(block: Block) -> int:
    return len(block.outline) if block.closed else 1


def _edges(block: Block) -> NDArray[np.float64]:
    ends = np.roll(block.outline, -1, axis=0)
    return np.hstack([block.outline, ends])[: _edge_count(block)]


def _face_looks(plan: Plan, block: Block, builder: AtlasBuilder) -> list[Look]:
    edges = _edges(block)
    starts, along = edges[:, :2], edges[:, 2:] - edges[:, :2]
    lengths = np.linalg.norm(along, axis=1)
    outward = np.column_stack([along[:, 1], -along[:, 0]]) / lengths[:, None]
    facing = plan.room_at(starts + 0.5 * along + 0.1 * outward)
    height = block.top - block.bottom
    return [
        builder.look(side or _wall_material(plan, room), length, height, block.key, number)
        for number, (side, room, length) in enumerate(
            zip(block.sides, facing, lengths, strict=True)
        )
    ]


def _wall_material(plan: Plan, room: int) -> str:
    return plan.rooms[room].wall if room >= 0 else "plain"


def _extent(block: Block) -> tuple[float, float]:
    width, depth = np.ptp(block.outline, axis=0)
    return max(float(width), 0.01), max(float(depth), 0.01)


def _caps(block: Block) -> tuple[float, float]:
    if block.cover is None or not block.closed:
        return np.nan, np.nan
    return block.bottom, block.top


def _glows(blocks: list[Block], surfaces: int) -> NDArray[np.float64]:
    each = np.array([block.glow for block in blocks])
    faces = np.repeat(each, [_edge_count(block) for block in blocks])
    glows = np.zeros(surfaces)
    glows[: len(faces) + len(each)] = np.concatenate([faces, each])
    return glows
