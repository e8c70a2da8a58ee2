"""Runs `realnoid simulate` as a user would, and reads what it leaves."""

import csv
import json
import subprocess

from conftest import BINARY

ORIGIN = BINARY.parents[2] / "urdf/origin.urdf"
BLOCK = """<robot name="block"><link name="block">
  <realnoid>
    <body specific_gravity="0.5"><shape><box size="0.2 0.2 0.2"/></shape></body>
    <monitor frame="{frame}"/>
  </realnoid>
</link></robot>
"""
"""4 kg, with a monitor in a `frame`."""


def run(urdf, *arguments, **options):
    """The finished process; arguments may be anything that has a text."""
    command = [str(BINARY), "simulate", str(urdf), *map(str, arguments)]
    return subprocess.run(command, capture_output=True, text=True, timeout=120, **options)


def simulate(urdf, *arguments, code=0):
    """The JSON summary of a run that must end with `code`."""
    done = run(urdf, *arguments)
    assert done.returncode == code, f"exit code {done.returncode}: {done.stderr}"
    return json.loads(done.stdout)


def refused(urdf, *arguments, code=2):
    """What is said about a run that must not start."""
    done = run(urdf, *arguments)
    assert done.returncode == code, f"exit code {done.returncode}: {done.stdout}{done.stderr}"
    assert done.stdout == "", "nothing but a summary goes to standard output"
    assert done.stderr.startswith("error: ") and "panicked" not in done.stderr
    return done.stderr


def texts(path):
    """Column -> texts, in the order of the file."""
    with open(path, newline="") as file:
        header, *rows = csv.reader(file)
    return dict(zip(header, zip(*rows, strict=True), strict=True))


def columns(path):
    """Column -> numbers, in the order of the file."""
    return {name: [float(x) for x in column] for name, column in texts(path).items()}


def rows(urdf, folder, *arguments):
    """The columns of a run that must succeed."""
    path = folder / "rows.csv"
    simulate(urdf, *arguments, "--out", path)
    return columns(path)
