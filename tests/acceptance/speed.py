"""Point 5: the cost of an evaluation relative to the Delaunay triangulation of the same sites, and its memory.

Figures of time mean something only on a machine that does nothing else.
"""

from pathlib import Path

from report import Program, Report


def check(report: Report, program: Program, data: Path) -> None:
    report.start("5 speed")
    program.benchmark("voroform_speed", "ratio", data / "kitten.xyz")
    program.benchmark("voroform_speed", "large")
    program.benchmark("voroform_speed", "memory")
    program.benchmark("voroform_speed", "fit")
