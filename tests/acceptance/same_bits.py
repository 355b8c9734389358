"""Point 6: the same bits with one and two threads, and from the stored form."""

from __future__ import annotations

import tempfile
from pathlib import Path

from report import Program, Report, metrics_of

FILES = ("cells.vtu", "surface.ply", "sites.ply", "form.vtu")
# What may differ between two runs that are otherwise equal.
VARYING = ("seconds", "peak_memory_bytes", "threads")


def comparable(folder: Path) -> dict | None:
    metrics = metrics_of(folder)
    return metrics and {key: value for key, value in metrics.items() if key not in VARYING}


def same_files(report: Report, first: Path, second: Path) -> None:
    for name in FILES:
        there = (first / name).exists() and (second / name).exists()
        report.equal(f"{name} the same", there and (first / name).read_bytes() == (second / name).read_bytes(), True)
    report.equal("metrics.json the same but for " + ", ".join(VARYING), comparable(first) == comparable(second), True)


def check(report: Report, program: Program, data: Path) -> None:
    for method, sites in (("cvt1", 15000), ("cvt2", 15000), ("cvt3", 15000), ("cvt3", 60000)):
        report.start(f"6 the same bits: kitten.xyz, {method}, {sites} sites")
        with tempfile.TemporaryDirectory() as name:
            folder = Path(name)
            more = ("--method", method, "--sites", sites, "--seed", 1)
            for threads in (1, 2):
                outcome = program.run(
                    "reconstruct", data / "kitten.xyz", "-o", folder / str(threads), "--threads", threads, *more
                )
                report.equal("exit code", outcome.returncode, 0)
            same_files(report, folder / "1", folder / "2")
            form = folder / "1" / "form.vtu"
            outcome = program.run("tessellate", form, "-o", folder / "form", *more)
            report.equal("exit code", outcome.returncode, 0)
            same_files(report, folder / "1", folder / "form")
    report.start("6 the same bits: negative control, another seed")
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        for seed in (1, 2):
            program.run("reconstruct", data / "kitten.xyz", "-o", folder / str(seed), "--sites", 2000, "--seed", seed)
        first, second = (folder / seed / "cells.vtu" for seed in "12")
        report.equal("cells.vtu differs", first.read_bytes() != second.read_bytes(), True)
