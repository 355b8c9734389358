"""What every proof prints: point, figure, value, bound and whether it holds, after the command that gave it."""

from __future__ import annotations

import json
import subprocess
import sys
from pathlib import Path


class Report:
    """Prints figures as they come and remembers those that miss their bound."""

    def __init__(self) -> None:
        self.point = ""
        self.checks = 0
        self.failures: list[str] = []

    def start(self, point: str) -> None:
        self.point = point
        print(f"\n== {point}", flush=True)

    def command(self, words: list[str]) -> None:
        print(f"$ {' '.join(words)}", flush=True)

    def check(self, figure: str, value: object, bound: str, holds: bool) -> None:
        self.checks += 1
        shown = f"{value:.6g}" if isinstance(value, float) else str(value)
        line = f"{'pass' if holds else 'FAIL'}  {figure}: {shown} (bound: {bound})"
        print(f"  {line}", flush=True)
        if not holds:
            self.failures.append(f"{self.point}: {line}")

    def equal(self, figure: str, value: object, expected: object) -> None:
        self.check(figure, value, f"= {expected}", value == expected)

    def at_most(self, figure: str, value: float, bound: float) -> None:
        self.check(figure, value, f"<= {bound:g}", value <= bound)

    def information(self, figure: str, value: object) -> None:
        print(f"  info  {figure}: {value}", flush=True)

    def close(self) -> int:
        print(f"\n{self.checks} figures, {len(self.failures)} failed")
        for failure in self.failures:
            print(f"  {failure}")
        return 1 if self.failures or self.checks == 0 else 0


class Program:
    """The program voroform and the benchmarks of one build folder."""

    def __init__(self, build: Path, report: Report) -> None:
        self.build = build
        self.report = report

    def run(self, *arguments: object, show: bool = True, **options: object) -> subprocess.CompletedProcess:
        words = [str(self.build / "pipeline" / "voroform"), *map(str, arguments)]
        if show:
            self.report.command(words)
        return subprocess.run(words, capture_output=True, text=True, errors="replace", check=False, **options)

    def benchmark(self, name: str, *arguments: object) -> None:
        """Runs a program that prints one JSON object a line and checks each figure against its bounds."""
        words = [str(self.build / "benchmarks" / name), *map(str, arguments)]
        self.report.command(words)
        figures = 0
        with subprocess.Popen(words, stdout=subprocess.PIPE, text=True) as process:
            for line in process.stdout:
                if not line.startswith("{"):
                    continue
                record = json.loads(line)
                figures += 1
                self.figure(record)
        self.report.equal(f"exit code of {name}", process.returncode, 0)
        self.report.check(f"figures printed by {name}", figures, ">= 1", figures >= 1)

    def figure(self, record: dict) -> None:
        value, low, high = record["value"], record.get("low"), record.get("bound")
        if low is None and high is None:
            self.report.information(record["figure"], value)
            return
        bound = f"<= {high:g}" if low is None else f"[{low:g}, {high:g}]"
        # JSON has no NaN: it comes as null, and fails.
        holds = value is not None and (low is None or value >= low) and (high is None or value <= high)
        self.report.check(record["figure"], value, bound, holds)


def metrics_of(folder: Path) -> dict | None:
    """metrics.json of a result folder, or None if there is none."""
    path = folder / "metrics.json"
    if not path.exists():
        return None
    return json.loads(path.read_text(encoding="utf-8"))


def main_report(run) -> None:
    """Calls run(report) and exits with 1 if a figure missed its bound."""
    report = Report()
    run(report)
    sys.exit(report.close())
