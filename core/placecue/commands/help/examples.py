"""Examples of each command, from the plainest to the less plain."""

from __future__ import annotations

EXAMPLES: dict[str, tuple[str, ...]] = {
    "demo": ("placecue demo", "placecue demo my_demo source.seed=3"),
    "train": (
        "placecue train run1.mcap out=model",
        "placecue train run1.mcap run2.mcap cue=laser integrator=none out=laser",
        "placecue train run1.bag source.labels=labels.csv out=model",
        "placecue train run1.mcap rooms=rooms.geojson 'label_map={BO: office, EO: office}'",
        "placecue train -m run1.mcap cue=laser,crfh integrator=none out=sweep",
    ),
    "classify": (
        "placecue classify model run2.mcap",
        "placecue classify model=model log=run2.bag out=classified",
        "placecue classify model run2.mcap rooms=rooms.geojson report=false",
        "placecue classify -m model=sweep/0,sweep/1 log=run2.mcap out=compared",
    ),
    "label": (
        "placecue label model run2.mcap",
        "placecue label run2.bag model=model out=labelled",
        "placecue label model run2.mcap accumulator=spatiotemporal",
    ),
    "evaluate": (
        "placecue evaluate a.mcap b.mcap c.mcap",
        "placecue evaluate a.mcap b.mcap cue=[crfh,laser] integrator=[svm_das,gdas]",
        "placecue evaluate logs=recordings pairs=leave_one_out out=runs/all",
        "placecue evaluate experiment=office_idol",
    ),
    "report": ("placecue report runs/evaluate", "placecue report merge=[runs/a,runs/b] out=runs/c"),
    "convert": (
        "placecue convert run.log.gz out.mcap",
        "placecue convert run.bag out.mcap keep=all",
        "placecue convert drive.csv out.mcap 'source.columns={stamp: time, image: file}'",
        "placecue convert source=office run1.mcap",
    ),
    "annotate": (
        "placecue annotate run.mcap labelled.mcap rooms=rooms.geojson",
        "placecue annotate run.mcap labelled.mcap source.labels=labels.csv topic=/room",
    ),
    "info": (
        "placecue info run.mcap",
        "placecue info run.bag rooms=rooms.geojson out=way.png",
        "placecue info run.mcap --json",
    ),
    "teach": (
        "placecue teach model run2.mcap out=taught",
        "placecue teach model run2.mcap labels=suggested/suggestions.csv out=taught",
    ),
    "suggest": (
        "placecue suggest model run2.mcap out=suggested",
        "placecue suggest model run2.mcap moments=50 out=suggested",
    ),
    "live": (
        "placecue live ws://127.0.0.1:8765 model view=true",
        "placecue live ws://robot.local:8765 model=model source.scan_topic=/base_scan out=map",
        "placecue live ws://127.0.0.1:8765 seconds=600 source.patience=null",
    ),
    "where": (
        "placecue where labelled x=3.0 y=5.2",
        "placecue where map=map.json x=3 y=5",
    ),
    "cache": ("placecue cache", "placecue cache unused_days=30", "placecue cache trim_to=2"),
    "plugins": ("placecue plugins", "placecue plugins kind=cue", "placecue plugins --json"),
    "doctor": ("placecue doctor", "placecue doctor run.bag", "placecue doctor run.mcap model"),
}

#: How paths stand in the line of use.
USAGE: dict[str, str] = {
    "demo": "[FOLDER]",
    "train": "LOG ...",
    "classify": "MODEL LOG ...",
    "label": "MODEL LOG ...",
    "live": "ADDRESS [MODEL]",
    "evaluate": "LOG LOG ...",
    "report": "FOLDER",
    "where": "MAP",
    "convert": "LOG OUT.mcap",
    "annotate": "LOG.mcap OUT.mcap",
    "info": "LOG ...",
    "teach": "MODEL LOG ...",
    "suggest": "MODEL LOG ...",
    "doctor": "[LOG] [MODEL]",
}

#: What a group of options decides.
GROUPS: dict[str, str] = {
    "source": "What reads the log; told by what is in it where nothing is said.",
    "cue": "What is looked at; list several in brackets.",
    "integrator": "How the scores of several cues become one.",
    "accumulator": "How beliefs along the way become areas.",
    "folds": "How samples are cut wherever some are held out.",
    "executor": "Where tasks run.",
    "tracking": "Who else is told of results.",
    "experiment": "A ready-made experiment.",
    "world": "A ready-made set of simulated recordings.",
}
