"""Runs the proofs and prints each figure with its bound; exits with 1 if one misses it.

run.py --build FOLDER [POINT...]    points: demo scans accuracy regularity regular_cvts comparison speed same_bits bad_input sanitizers
"""

from __future__ import annotations

import argparse
import importlib
from pathlib import Path

from report import Program, Report, main_report

POINTS = ("demo", "scans", "accuracy", "regularity", "regular_cvts", "comparison", "speed", "same_bits", "bad_input",
          "sanitizers")


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--build", type=Path, required=True, help="folder of a finished build")
    parser.add_argument("--data", type=Path, default=Path(__file__).resolve().parents[2] / "data")
    parser.add_argument("points", nargs="*", metavar="POINT", help="points to prove; all without")
    options = parser.parse_args()
    for point in options.points:
        if point not in POINTS:
            parser.error(f"unknown point {point}; there are {' '.join(POINTS)}")

    def proofs(report: Report) -> None:
        program = Program(options.build, report)
        for point in options.points or POINTS:
            importlib.import_module(point).check(report, program, options.data)

    main_report(proofs)


if __name__ == "__main__":
    main()
