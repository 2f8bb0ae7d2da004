"""JSON schemas of the Foxglove messages that placecue writes, and of its own.

The field names and types are those of Foxglove's message schemas
(https://docs.foxglove.dev/docs/sdk/schemas), so that Foxglove and Lichtblick know them by name.
"""

from __future__ import annotations

from typing import Any

Schema = dict[str, Any]

NUMBER: Schema = {"type": "number"}
INTEGER: Schema = {"type": "integer"}
TEXT: Schema = {"type": "string"}
FLAG: Schema = {"type": "boolean"}
BYTES: Schema = {"type": "string", "contentEncoding": "base64"}


def structure(title: str, **fields: Schema) -> Schema:
    """Return the schema of an object, all of whose fields must be there."""
    return {"title": title, "type": "object", "properties": fields, "required": list(fields)}


def several(items: Schema) -> Schema:
    """Return the schema of an array."""
    return {"type": "array", "items": items}


TIME = structure("time", sec=INTEGER, nsec=INTEGER)
DURATION = structure("duration", sec=INTEGER, nsec=INTEGER)
VECTOR = structure("foxglove.Vector3", x=NUMBER, y=NUMBER, z=NUMBER)
POINT = structure("foxglove.Point3", x=NUMBER, y=NUMBER, z=NUMBER)
QUATERNION = structure("foxglove.Quaternion", x=NUMBER, y=NUMBER, z=NUMBER, w=NUMBER)
POSE = structure("foxglove.Pose", position=VECTOR, orientation=QUATERNION)
COLOR = structure("foxglove.Color", r=NUMBER, g=NUMBER, b=NUMBER, a=NUMBER)
FRAME_TRANSFORM = structure(
    "foxglove.FrameTransform",
    timestamp=TIME,
    parent_frame_id=TEXT,
    child_frame_id=TEXT,
    translation=VECTOR,
    rotation=QUATERNION,
)
LINE = structure(
    "foxglove.LinePrimitive",
    type=INTEGER,
    pose=POSE,
    thickness=NUMBER,
    scale_invariant=FLAG,
    points=several(POINT),
    color=COLOR,
    colors=several(COLOR),
    indices=several(INTEGER),
)
SPHERE = structure("foxglove.SpherePrimitive", pose=POSE, size=VECTOR, color=COLOR)
WORDS = structure(
    "foxglove.TextPrimitive",
    pose=POSE,
    billboard=FLAG,
    font_size=NUMBER,
    scale_invariant=FLAG,
    color=COLOR,
    text=TEXT,
)
PAIR = structure("foxglove.KeyValuePair", key=TEXT, value=TEXT)
NOTHING = several({"type": "object", "properties": {}})
ENTITY = structure(
    "foxglove.SceneEntity",
    timestamp=TIME,
    frame_id=TEXT,
    id=TEXT,
    lifetime=DURATION,
    frame_locked=FLAG,
    metadata=several(PAIR),
    arrows=NOTHING,
    cubes=NOTHING,
    spheres=several(SPHERE),
    cylinders=NOTHING,
    lines=several(LINE),
    triangles=NOTHING,
    texts=several(WORDS),
    models=NOTHING,
)
DELETION = structure("foxglove.SceneEntityDeletion", timestamp=TIME, type=INTEGER, id=TEXT)

SCHEMAS: dict[str, Schema] = {
    str(schema["title"]): schema
    for schema in (
        structure(
            "foxglove.CompressedImage", timestamp=TIME, frame_id=TEXT, data=BYTES, format=TEXT
        ),
        structure(
            "foxglove.CameraCalibration",
            timestamp=TIME,
            frame_id=TEXT,
            width=INTEGER,
            height=INTEGER,
            distortion_model=TEXT,
            D=several(NUMBER),
            K=several(NUMBER),
            R=several(NUMBER),
            P=several(NUMBER),
        ),
        structure(
            "foxglove.LaserScan",
            timestamp=TIME,
            frame_id=TEXT,
            pose=POSE,
            start_angle=NUMBER,
            end_angle=NUMBER,
            ranges=several(NUMBER),
            intensities=several(NUMBER),
            range_min=NUMBER,
            range_max=NUMBER,
        ),
        structure("foxglove.PoseInFrame", timestamp=TIME, frame_id=TEXT, pose=POSE),
        FRAME_TRANSFORM,
        structure("foxglove.SceneUpdate", deletions=several(DELETION), entities=several(ENTITY)),
        structure("placecue.Label", stamp=INTEGER, label=TEXT),
        structure(
            "placecue.Belief",
            timestamp=TIME,
            stamp=INTEGER,
            label=TEXT,
            confidence=NUMBER,
            scores={"type": "object", "properties": {}, "additionalProperties": NUMBER},
            cues_used=several(TEXT),
        ),
        structure(
            "placecue.AreaUpdate",
            timestamp=TIME,
            stamp=INTEGER,
            area=INTEGER,
            label=TEXT,
            confidence=NUMBER,
            finished=FLAG,
        ),
        {"title": "placecue.SemanticMap", "type": "object", "properties": {}},
    )
}
