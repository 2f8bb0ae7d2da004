"""What labels a log without a model: a laser model of drawn plans, and what objects tell of rooms.

The model in the folder ``laser`` is made by ``placecue train +recipe=starter``; see
``docs/starter.md``.
"""
