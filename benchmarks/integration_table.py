"""Every integrator over several sets of cues: the tables of docs/integration.md.

    python benchmarks/integration_table.py runs/integration
    python benchmarks/integration_table.py runs/integration --tests nyu_four --cues crfh laser
    python benchmarks/integration_table.py runs/integration --report

Single-cue models are trained once a fold (or sequence); what they say of samples that they have
not seen is kept in the folder, and so is what each integrator makes of it, so that a run that was
stopped goes on where it was. Take another folder after a change of the code. At the end, or with
``--report``, the tables are written into the page.
"""

from __future__ import annotations

import argparse
import os
from pathlib import Path

os.environ.setdefault("OMP_NUM_THREADS", "1")
os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")

from integration_methods import METHODS, SETS, decide
from integration_page import write
from integration_tests import CUES, TESTS, evidence

if __name__ == "__main__":
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("folder", type=Path)
    parser.add_argument("--tests", nargs="*", default=list(TESTS), choices=list(TESTS))
    parser.add_argument("--cues", nargs="*", default=list(CUES), choices=list(CUES))
    parser.add_argument("--methods", nargs="*", default=list(METHODS), choices=list(METHODS))
    parser.add_argument("--scores", action="store_true", help="train single-cue models only")
    parser.add_argument("--report", action="store_true", help="only write the page")
    given = parser.parse_args()
    if not given.report:
        for test in given.tests:
            for part in TESTS[test].parts():
                for cue in given.cues:
                    evidence(given.folder, test, part, cue)
        for test in given.tests if not given.scores else ():
            for cues in SETS:
                for method in given.methods:
                    decide(given.folder, test, cues, method)
    print(f"written: {write(given.folder)}")
