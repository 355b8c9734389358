"""Point 1: the demo's command gives a valid tessellation of the kitten, whose tail makes a handle."""

from __future__ import annotations

import shutil
import subprocess
from pathlib import Path

from report import Program, Report
from scans import check_result

SITES = 15000


def check(report: Report, program: Program, data: Path) -> None:
    report.start("1 demo")
    root = data.parent
    output = root / "demo-output"
    shutil.rmtree(output, ignore_errors=True)
    words = ["./bootstrap", "demo"]
    report.command(words)
    outcome = subprocess.run(words, cwd=root, capture_output=True, text=True, check=False)
    report.equal("exit code", outcome.returncode, 0)
    report.equal("ran on the scan", "NO SCAN" not in outcome.stdout, True)
    metrics = check_result(report, output, SITES)
    if metrics is not None:
        report.equal("components", metrics["validity"]["components"], 1)
        report.equal("Euler number of the boundary", metrics["validity"]["euler_characteristic"], 0)
    report.start("1 tests")
    words = ["ctest", "--test-dir", str(program.build), "--label-regex", "unit|property|cli|scan"]
    report.command(words)
    outcome = subprocess.run(words, cwd=root, capture_output=True, text=True, check=False)
    report.equal("exit code", outcome.returncode, 0)
    report.information("ctest", " ".join(line for line in outcome.stdout.splitlines() if "tests passed" in line))
