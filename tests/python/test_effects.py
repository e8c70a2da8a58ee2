"""`realnoid effects`, `inspect`'s list of effects, and their switches on the command line."""

import json
import re
import shutil
import subprocess

import pytest
from conftest import BINARY
from simulation import ORIGIN

PENDULUM = ORIGIN.parents[1] / "tests/conformance/hanging_rod.urdf"
QUICK = ("--steps", "5", "--rounds", "1", "--seconds", "0.05")


def run(*arguments, code=0, **options):
    done = subprocess.run([BINARY, *map(str, arguments)], capture_output=True, text=True, **options)
    assert done.returncode == code, done.stderr
    return done


def prices(*arguments):
    return json.loads(run("effects", *arguments, *QUICK, "--json").stdout)


@pytest.mark.skipif(not shutil.which("valgrind"), reason="valgrind counts")
def test_what_a_pendulum_does_not_call_for_costs_nothing():
    said = prices(PENDULUM, "--set", "hinge=1")
    called_for = {e["name"]: e["instructions_per_step"] for e in said["effects"] if e["called_for"] and e["kind"] == "switched"}
    assert set(called_for) == {"gravity", "drives"} and called_for["drives"] > 0
    assert said["instructions_per_step"] > 500
    others = {e["name"]: e["instructions_per_step"] for e in said["effects"] if not e["called_for"] and e["kind"] == "switched"}
    # The same way through the program, but for the address from which memcpy copies (benches/counts/counts.py).
    assert len(others) == 22 and all(abs(n) <= 16 for n in others.values()), others


def test_the_error_of_a_run_without_an_effect_names_the_axis():
    said = {e["name"]: e for e in prices(PENDULUM, "--set", "hinge=1", "--no-count")["effects"]}
    axis = said["gravity"]["error_when_off"]["axis"]
    # It falls from rest with about m g l / J · sin(1) for 0.05 s.
    assert axis["name"] == "hinge" and axis["unit"] == "rad" and 0.01 < axis["by"] < 0.05
    assert said["mimic"]["error_when_off"] is None and said["gravity"]["instructions_per_step"] is None


def test_the_table_and_the_markdown_have_a_row_for_each_effect_of_the_steps():
    wanted = [e["name"] for e in json.loads(run("inspect", PENDULUM, "--json").stdout)["all_effects"] if e["kind"] != "on_demand"]
    table = run("effects", PENDULUM, *QUICK, "--no-count").stdout
    assert re.findall(r"^([a-z_]+)  ", table, re.M)[1:] == wanted
    assert "not counted (--no-count)" in table
    markdown = run("effects", PENDULUM, *QUICK, "--no-count", "--markdown").stdout
    rows = [line.split(" | ") for line in markdown.splitlines() if line.startswith("| `")]
    assert [cells[0].strip("| `") for cells in rows] == wanted and {len(cells) for cells in rows} == {5}


def test_without_valgrind_it_says_how_to_get_it():
    said = run("effects", PENDULUM, *QUICK, env={"PATH": "/nowhere"}).stdout
    assert "apt install valgrind" in said


def test_inspect_lists_what_is_called_for_by_what():
    said = run("inspect", ORIGIN).stdout
    [called_for, rest] = said.split("not called for, not built")
    assert re.search(r"\n  joint_friction +\d+ of \d+ axes: \w+, ", called_for) and "\n  poles " in called_for
    absent, on_demand = rest.split("made on demand")
    assert "\n  contact  " in absent and "\n  mimic " in absent and "\n  markers " in on_demand
    listed = json.loads(run("inspect", ORIGIN, "--json").stdout)
    assert listed["effects"]["gravity"] is True and listed["effects"]["contact"] is False
    by_name = {e["name"]: e for e in listed["all_effects"]}
    assert by_name["velocity_products"]["kind"] == "derived" and by_name["velocity_products"]["why"]


def test_an_effect_that_is_off_in_the_scene_is_listed_as_such(tmp_path):
    scene = tmp_path / "scene.yaml"
    scene.write_text("version: 1\nground: true\nworld: {effects: {contact_friction: false}}\n")
    said = run("inspect", ORIGIN, "--scene", scene).stdout
    assert "  contact_friction" in said.split("switched off\n")[1].split("not called for")[0]


@pytest.mark.parametrize("command", [("simulate", "--duration", "0.1"), ("effects",)])
def test_unknown_names_are_refused_with_the_list(command):
    reason = run(*command, PENDULUM, "--off", "magic", code=2).stderr
    assert "effect 'magic' does not exist" in reason and "torque_speed_line, short_brake, servo" in reason


def test_bad_seconds_are_refused():
    assert "--seconds 0: must be" in run("effects", PENDULUM, "--seconds", "0", code=2).stderr
