"""Methods by experiments, as a table."""

from __future__ import annotations

from placecue.evaluation.figures.drawn import Drawn
from placecue.evaluation.figures.spec import Spec
from placecue.evaluation.results.about import About
from placecue.evaluation.results.results import Results
from placecue.evaluation.results.table import Table
from placecue.evaluation.results.tables import summary_numbers, summary_table

KEYS: frozenset[str] = frozenset()


def draw(results: Results, spec: Spec, about: About) -> Drawn:
    """Return the mean ± standard deviation over pairs of each method in each experiment."""
    table = summary_table(results, spec.methods, spec.experiments)
    labelled = [[spec.label(str(row[0])), *row[1:]] for row in table.rows]
    numbers = summary_numbers(results, spec.methods, spec.experiments)
    return Drawn(numbers, Table(table.columns, labelled))
