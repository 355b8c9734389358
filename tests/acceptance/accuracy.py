"""Point 3: distance of the boundary to the surface relative to Marching Cubes, and its order."""

from pathlib import Path

from report import Program, Report


def check(report: Report, program: Program, data: Path) -> None:
    report.start("3 accuracy")
    program.benchmark("voroform_accuracy")
