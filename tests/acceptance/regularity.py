"""Point 4: the regularity of the cells."""

from pathlib import Path

from report import Program, Report


def check(report: Report, program: Program, data: Path) -> None:
    report.start("4 regularity")
    program.benchmark("voroform_regularity", data / "kitten.xyz")
