"""The words of the command line: its commands, with a line on each."""

from __future__ import annotations

COMMANDS = {
    "demo": "make sample logs, train, classify, label; writes a report and a map",
    "train": "log(s) -> model folder",
    "classify": "model + log -> beliefs (MCAP, CSV); scores where the log is labelled",
    "label": "model + log -> semantic map, online in one pass",
    "live": "model + a robot that drives -> beliefs and a growing map, served likewise",
    "where": "a map and a position -> which room, and how sure",
    "evaluate": "an experiment: pairs of logs, methods -> tables, figures, significance",
    "report": "a run folder, or several -> its tables, figures and page, made again",
    "teach": "model + labelled log -> a model that knows these samples or places as well",
    "suggest": "model (or the starter) + log -> the moments that are most worth labelling",
    "convert": "any source -> MCAP",
    "annotate": "MCAP log + rooms -> a copy with labels",
    "info": "what is in a log, and which topics would be used",
    "doctor": "what is installed, what is wrong and how to mend it; also of a log and a model",
    "cache": "the features that are kept between runs; shows and trims them",
    "plugins": "the components that are installed, and plugins that do not load",
}

#: Set to 1 in the environment for full tracebacks; ``hydra.verbose=true`` does it for one run.
TRACEBACK = "PLACECUE_TRACEBACK"

LOG, OUT, MODEL, MAP = "log", "out", "model", "map"
#: The command whose log is the address of a robot.
LIVE = "live"
#: The command whose path is a map.
WHERE = "where"
#: What paths that stand by themselves are: the first key takes all of them, but ``out`` is the last
#: of two or more, and ``model`` one that is a model's folder.
PATHS: dict[str, tuple[str, ...]] = {
    "demo": (OUT,),
    "train": (LOG,),
    "classify": (LOG, MODEL),
    "label": (LOG, MODEL),
    LIVE: (LOG, MODEL),
    "teach": (LOG, MODEL),
    "suggest": (LOG, MODEL),
    "evaluate": (LOG,),
    "report": (OUT,),
    "convert": (LOG, OUT),
    "annotate": (LOG, OUT),
    "info": (LOG,),
    "doctor": (LOG, MODEL),
    WHERE: (MAP,),
}
