"""Point 8: the suite under the sanitizers."""

from __future__ import annotations

import subprocess
import time
from pathlib import Path

from report import Program, Report


def check(report: Report, program: Program, data: Path) -> None:
    for command in ("asan", "tsan"):
        report.start(f"8 sanitizers: {command}")
        words = ["./bootstrap", command]
        report.command(words)
        start = time.monotonic()
        outcome = subprocess.run(words, cwd=data.parent, capture_output=True, text=True, check=False)
        report.equal("exit code", outcome.returncode, 0)
        report.information("seconds, with the build", round(time.monotonic() - start))
        if outcome.returncode != 0:
            print(outcome.stdout[-4000:], outcome.stderr[-4000:])
