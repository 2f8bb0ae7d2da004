"""The words of the command line: its commands, with a line on each."""

from __future__ import annotations

COMMANDS = {
    "demo": "make sample logs, train, classify, label; writes a report and a map",
    "train": "log(s) -> model folder",
    "classify": "model + log -> beliefs (MCAP, CSV); scores where the log is labelled",
    "label": "model + log -> semantic map, online in one pass",
    "where": "a map and a position -> which room, and how sure",
    "evaluate": "an experiment: pairs of logs, methods -> tables, figures, significance",
    "report": "a run folder, or several -> its tables, figures and page, made again",
    "convert": "any source -> MCAP",
    "annotate": "MCAP log + rooms -> a copy with labels",
    "info": "what is in a log, and which topics would be used",
    "cache": "the features that are kept between runs; shows and trims them",
    "plugins": "the components that are installed, and plugins that do not load",
}

#: Set to 1 in the environment for full tracebacks; ``hydra.verbose=true`` does it for one run.
TRACEBACK = "PLACECUE_TRACEBACK"
