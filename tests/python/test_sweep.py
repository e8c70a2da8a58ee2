"""`realnoid sweep`: a row per world, the same whatever the number of threads and shards, and after SIGKILL."""

import csv
import os
import signal
import subprocess
import sys
import time

import numpy
import pytest
import yaml
from conftest import ARM, BINARY, wait_until
from simulation import ORIGIN, columns, simulate

TIMES = {"cpu_seconds", "us_per_step", "real_time_factor"}

SPEC = {
    "version": 1,
    "run": {"urdf": str(ARM), "duration": 0.05, "effort": {"hip": 1.0}},
    "seed": 3,
    "vary": [
        {"at": "run.gravity", "values": [[0, 0, -9.8], [1, 0, -1.6]], "name": "gravity"},
        {"at": "run.effort.hip", "from": 0.5, "to": 8, "steps": 5, "scale": "log"},
        {"at": "run.set.knee", "uniform": [-0.5, 0.5], "name": "knee"},
    ],
}


def spec_file(folder, name="sweep.yaml", **changes):
    path = folder / name
    path.write_text(yaml.safe_dump({**SPEC, **changes}))
    return path


def sweep(*arguments, code=0, cwd=None, timeout=120):
    command = [BINARY, "sweep", *map(str, arguments)]
    result = subprocess.run(command, capture_output=True, text=True, timeout=timeout, cwd=cwd)
    assert result.returncode == code, result.stdout + result.stderr
    return result.stdout + result.stderr


def rows(path):
    with open(path, newline="") as file:
        return list(csv.DictReader(file))


def results(path):
    """What must be the same every time: all but the times, by world."""
    return {int(row["index"]): {k: v for k, v in row.items() if k not in TIMES} for row in rows(path)}


@pytest.fixture(scope="module")
def table(tmp_path_factory):
    folder = tmp_path_factory.mktemp("sweep")
    sweep(spec_file(folder), "--out", folder / "rows.csv")
    return folder / "rows.csv"


def test_a_grid_has_every_value_with_every_other(table):
    found = rows(table)
    assert [int(r["index"]) for r in found] == list(range(10))
    assert [r["gravity"] for r in found] == ["[0,0,-9.8]"] * 5 + ["[1,0,-1.6]"] * 5
    efforts = [float(r["run.effort.hip"]) for r in found[:5]]
    assert efforts == [float(r["run.effort.hip"]) for r in found[5:]]
    assert (efforts[0], efforts[-1]) == (0.5, 8.0)
    numpy.testing.assert_allclose(efforts, numpy.geomspace(0.5, 8, 5), rtol=1e-14)
    knees = [float(r["knee"]) for r in found]
    assert len(set(knees)) == 10 and all(-0.5 <= k <= 0.5 for k in knees), "drawn anew for each world"
    assert len({r["seed"] for r in found}) == 10 and len({r["sweep"] for r in found}) == 1


def test_a_row_is_what_simulate_says(table, tmp_path):
    row = rows(table)[7]
    out = tmp_path / "run.csv"
    arguments = ["--duration", 0.05, "--gravity", "1,0,-1.6", "--effort", f"hip={row['run.effort.hip']}", "--set", f"knee={row['knee']}"]
    summary = simulate(ARM, *arguments, "--out", out)
    last = columns(out)
    for name, values in last.items():
        assert float(row[f"final.{name}"]) == values[-1], name
    assert float(row["energy.unaccounted"]) == summary["energy"]["unaccounted"]
    assert float(row["peaks.hip.torque"]) == summary["peaks"]["hip"]["torque"]
    assert (row["status"], row["finite"], row["error"]) == ("0", "true", "")
    assert float(row["simulated_seconds"]) == 0.05 and int(row["steps"]) == summary["steps"] == 250
    assert float(row["cpu_seconds"]) > 0 and float(row["real_time_factor"]) > 0


@pytest.mark.parametrize("jobs", [1, 5])
def test_threads_make_no_difference(table, tmp_path, jobs):
    sweep(spec_file(tmp_path), "--out", tmp_path / "rows.csv", "--jobs", jobs)
    assert results(tmp_path / "rows.csv") == results(table)
    assert list(results(tmp_path / "rows.csv")) == list(range(10)), "in the order of worlds"


def test_worlds_alone_have_the_same_rows(tmp_path):
    scene = {"version": 1, "ground": True, "robot": {"urdf": str(ORIGIN), "base": "free", "pose": [0, 0, 1.0, 0, 0, 0, 1]}}
    vary = [
        {"at": "run.integrator", "values": ["implicit_midpoint", "semi_implicit_euler", "rk4", "extrapolation"]},
        {"at": "run.gravity.2", "uniform": [-12, -3]},
        {"at": "run.effort.left_knee", "uniform": [-20, 20]},
    ]
    run = {"duration": 0.1, "gravity": [0, 0, -9.8], "effort": {"left_knee": 0, "right_knee": 3}, "servo": {"left_elbow": 0.4}}
    spec = spec_file(tmp_path, scene=scene, run=run, vary=vary, repeat=3)
    found = {}
    for name, *options in [("alone", "--alone", "--jobs", 2), ("one", "--jobs", 1), ("two", "--jobs", 2)]:
        sweep(spec, "--out", tmp_path / f"{name}.csv", "--tables", tmp_path / name, *options)
        tables = [(tmp_path / name / f"world_{i:02}.csv").read_text() for i in range(12)]
        found[name] = results(tmp_path / f"{name}.csv"), tables
        assert all(float(row["cpu_seconds"]) > 0 for row in rows(tmp_path / f"{name}.csv")), name
    assert found["one"] == found["alone"] and found["two"] == found["alone"]
    assert len(set(found["alone"][1])) == 12, "worlds that differ"


def test_shards_make_no_difference_and_are_merged(table, tmp_path):
    spec = spec_file(tmp_path)
    for i in (2, 0, 1):
        text = sweep(spec, "--shard", f"{i}/3", cwd=tmp_path)
        assert f"sweep.shard-{i}-of-3.csv" in text
    shards = [tmp_path / f"sweep.shard-{i}-of-3.csv" for i in range(3)]
    assert [list(results(s)) for s in shards] == [[0, 3, 6, 9], [1, 4, 7], [2, 5, 8]]
    assert "10 worlds of 3 files" in sweep("--merge", tmp_path / "all.csv", *shards)
    assert results(tmp_path / "all.csv") == results(table) and list(results(tmp_path / "all.csv")) == list(range(10))
    assert "3 worlds before the last one are missing" in sweep("--merge", tmp_path / "some.csv", shards[0], shards[2])
    other = shards[1].read_text().replace("\n1,", "\n1,x", 1)
    (tmp_path / "other.csv").write_text(other)
    assert "rows of another sweep" in sweep("--merge", tmp_path / "no.csv", shards[0], tmp_path / "other.csv", code=2)
    changed = shards[0].read_text().replace(",true,", ",false,", 1)
    (tmp_path / "changed.csv").write_text(changed)
    assert "another row of world 0" in sweep("--merge", tmp_path / "no.csv", shards[0], tmp_path / "changed.csv", code=2)
    assert not (tmp_path / "no.csv").exists()


def test_200_worlds_killed_in_the_middle_and_gone_on_with(tmp_path):
    vary = [{"at": "run.effort.hip", "uniform": [-5, 5]}, {"at": "run.set.knee", "normal": [0, 0.2]}]
    # Long enough, and one at a time, that it is still on its way some seconds after the rows that are waited for.
    run = {**SPEC["run"], "duration": 1.5}
    spec = spec_file(tmp_path, combine="random", samples=200, vary=vary, run=run)
    whole, broken = tmp_path / "whole.csv", tmp_path / "broken.csv"
    sweep(spec, "--out", whole)
    assert len(rows(whole)) == 200
    for least in (20, 90):
        command = [BINARY, "sweep", spec, "--out", broken, "--jobs", "1"]
        process = subprocess.Popen(command, stderr=subprocess.DEVNULL, stdout=subprocess.DEVNULL)
        wait_until(lambda: broken.exists() and broken.read_bytes().count(b"\n") > least, timeout=60, what="some rows")
        process.send_signal(signal.SIGKILL)
        process.wait(30)
        done = broken.read_bytes().count(b"\n") - 1
        assert least <= done < 200, "it was killed in the middle"
        with open(broken, "ab") as file:
            file.write(broken.read_bytes().splitlines()[-1][:37])  # as if it had been killed while it wrote
    kept = {line.split(b",")[0]: line for line in broken.read_bytes().splitlines()[1:-1]}
    text = sweep(spec, "--out", broken)
    assert f"{200 - done} worlds made, {done} were there" in text
    assert results(broken) == results(whole) and list(results(broken)) == list(range(200))
    again = {line.split(b",")[0]: line for line in broken.read_bytes().splitlines()[1:]}
    assert all(again[k] == line for k, line in kept.items()), "finished worlds were not made again"
    assert "0 worlds made, 200 were there" in sweep(spec, "--out", broken)


def test_sigint_ends_it_neatly_and_it_goes_on(tmp_path):
    run = {**SPEC["run"], "duration": 3.0}
    spec, out = spec_file(tmp_path, run=run, repeat=20), tmp_path / "rows.csv"
    process = subprocess.Popen([BINARY, "sweep", spec, "--out", out], stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
    wait_until(lambda: out.exists() and out.read_bytes().count(b"\n") > 3, timeout=60, what="some rows")
    process.send_signal(signal.SIGINT)
    output, _ = process.communicate(timeout=60)
    assert process.returncode == 1 and "the same command goes on" in output
    assert 2 < len(rows(out)) < 200


def test_another_specification_is_not_mixed_in(table, tmp_path):
    out = tmp_path / "rows.csv"
    out.write_bytes(table.read_bytes())
    before = out.read_bytes()
    for changes in ({"seed": 4}, {"run": {**SPEC["run"], "duration": 0.06}}, {"run": {**SPEC["run"], "steps": 6}}):
        assert "rows of another sweep" in sweep(spec_file(tmp_path, **changes), "--out", out, code=2)
    assert "its columns are others" in sweep(spec_file(tmp_path, vary=SPEC["vary"][:1]), "--out", out, code=2)
    assert out.read_bytes() == before
    out.write_text("my,own\n1,2\n")
    assert "no table of a sweep" in sweep(spec_file(tmp_path), "--out", out, code=2)
    assert out.read_text() == "my,own\n1,2\n"


def test_a_robot_that_has_changed_is_another_sweep(tmp_path):
    (tmp_path / "arm.urdf").write_text(ARM.read_text())
    spec = spec_file(tmp_path, run={**SPEC["run"], "urdf": "arm.urdf"})
    sweep(spec, "--out", tmp_path / "rows.csv")
    (tmp_path / "arm.urdf").write_text(ARM.read_text().replace('mass value="1"', 'mass value="1.1"'))
    assert "a file that it reads" in sweep(spec, "--out", tmp_path / "rows.csv", code=2)


def test_scenes_settings_effects_bodies_and_scripts_are_varied(tmp_path):
    scene = {
        "version": 1,
        "world": {"engine": "rbx"},
        "ground": {"friction": 0.5},
        "bodies": [{"name": "box", "shape": {"box": {"size": [0.2, 0.2, 0.2]}}, "mass": 1, "pose": [0, 0, 0.1001, 0, 0, 0, 1]}],
    }
    (tmp_path / "scene.yaml").write_text(yaml.safe_dump(scene))
    vary = [
        {"at": "scene.world.engine", "values": ["rbx", "rapier"]},
        {"at": "scene.ground.friction", "values": [0.1, 0.6]},
        {"at": "scene.bodies.box.velocity.0", "values": [1, 2]},
        {"at": "scene.world.effects.gravity", "values": [True, False]},
    ]
    scene["bodies"][0]["velocity"] = [0, 0, 0]
    (tmp_path / "scene.yaml").write_text(yaml.safe_dump(scene))
    spec = spec_file(tmp_path, scene="scene.yaml", run={"duration": 0.2}, vary=vary)
    sweep(spec, "--out", tmp_path / "rows.csv")
    found = rows(tmp_path / "rows.csv")
    assert len(found) == 16 and all(r["status"] == "0" for r in found)
    key = lambda r: (r["scene.world.engine"], r["scene.ground.friction"], r["scene.bodies.box.velocity.0"], r["scene.world.effects.gravity"])
    slid = {key(r): float(r["final.box.x"]) for r in found}
    for engine in ("rbx", "rapier"):
        for v in (1.0, 2.0):
            a, b = (slid[engine, mu, str(int(v)), "true"] for mu in ("0.1", "0.6"))
            numpy.testing.assert_allclose(a, v * 0.2 - 0.5 * 0.1 * 9.80665 * 0.2**2, atol=2e-3)
            assert b < a < slid[engine, "0.1", str(int(v)), "false"]


def test_entries_of_a_script_are_varied(tmp_path):
    run = {**SPEC["run"], "script": [{"at": 0.01, "axis": "hip", "mode": "torque", "torque": 1.0}]}
    del run["effort"]
    spec = spec_file(tmp_path, run=run, vary=[{"at": "run.script.0.torque", "values": [1, 2]}])
    sweep(spec, "--out", tmp_path / "rows.csv")
    a, b = (float(r["final.hip.velocity"]) for r in rows(tmp_path / "rows.csv"))
    assert 1.5 * a < b


def test_worlds_that_cannot_be_made_or_diverge_have_rows_that_say_so(tmp_path):
    vary = [{"at": "run.steps", "values": [5, 5000]}, {"at": "run.set.hip", "values": [[0, 1], [0, 1e300]], "name": "hip"}]
    text = sweep(spec_file(tmp_path, vary=vary), "--out", tmp_path / "rows.csv")
    found = rows(tmp_path / "rows.csv")
    assert [r["status"] for r in found] == ["0", "1", "2", "2"], found
    assert found[1]["finite"] == "false" and "steps_per_interval is 5000" in found[2]["error"]
    assert "1 diverged" in text and "2 could not be made" in text


def test_bags_and_tables_of_each_world(tmp_path):
    from rosbags.highlevel import AnyReader

    spec = spec_file(tmp_path)
    sweep(spec, "--out", tmp_path / "a.csv", "--bags", tmp_path / "bags")
    sweep(spec, "--out", tmp_path / "b.csv", "--tables", tmp_path / "tables")
    assert results(tmp_path / "a.csv") == results(tmp_path / "b.csv")
    for row in rows(tmp_path / "a.csv"):
        with AnyReader([tmp_path / "bags" / f"world_{row['index']}"]) as reader:
            assert reader.message_count == 2 * 51
        last = columns(tmp_path / "tables" / f"world_{row['index']}.csv")
        assert last["hip.position"][-1] == float(row["final.hip.position"])


REFUSED = [
    ({"version": 2}, "version is 2"),
    ({"colour": 1}, "colour"),
    ({"run": {"urdf": str(ARM), "duration": 1, "speed": 2}}, "unknown field `speed`"),
    ({"run": {"urdf": str(ARM), "duration": -1}}, "--duration -1"),
    ({"vary": [{"at": "run.sett.knee", "values": [1]}]}, "unknown field `sett`"),
    ({"vary": [{"at": "run.set.elbow", "values": [1]}]}, "there is no axis 'elbow'"),
    ({"vary": [{"at": "scene.world.gravitty", "values": [1]}]}, "gravitty"),
    ({"vary": [{"at": "scene.bodies.ball.mass", "values": [1]}]}, "expected sequence start"),
    ({"vary": [{"at": "gravity", "values": [1]}]}, "must begin with scene. or run."),
    ({"vary": [{"at": "run.steps", "values": [1]}, {"at": "run.steps", "values": [2]}]}, "varied twice"),
    ({"vary": [{"at": "run.steps", "values": [1], "name": "status"}]}, "two columns 'status'"),
    ({"combine": "random"}, "needs samples"),
    ({"samples": 5}, "samples is for combine: random"),
    ({"combine": "latin"}, "latin"),
    ({"vary": [{"at": "run.steps", "from": 1, "to": 10, "steps": 1000}, {"at": "run.iterations", "from": 1, "to": 9, "steps": 100000}]}, "more than 10000000 worlds"),
]


@pytest.mark.parametrize("changes, reason", REFUSED, ids=[r for _, r in REFUSED])
def test_nonsense_is_refused_before_anything_runs(tmp_path, changes, reason):
    text = sweep(spec_file(tmp_path, **changes), "--out", tmp_path / "rows.csv", code=2)
    assert reason in text, text
    assert not (tmp_path / "rows.csv").exists()


def test_bad_arguments(tmp_path):
    spec = spec_file(tmp_path)
    assert "must be I/N" in sweep(spec, "--shard", "3/3", code=2)
    assert "cannot read" in sweep(tmp_path / "nothing.yaml", code=2)
    assert "is being written by another sweep" in locked(spec, tmp_path / "rows.csv")


def locked(spec, out):
    import fcntl

    with open(out, "a") as file:
        fcntl.flock(file, fcntl.LOCK_EX)
        return sweep(spec, "--out", out, code=2)


def test_the_example_of_the_documentation_works(tmp_path):
    import re
    from pathlib import Path

    text = (Path(__file__).parent / "../../docs/sweep.md").read_text()
    [example] = re.findall(r"```yaml\n(.*?)```", text, re.DOTALL)[:1]
    document = yaml.safe_load(example)
    document["run"]["duration"] = 0.01
    (tmp_path / "sweep.yaml").write_text(yaml.safe_dump(document))
    sweep("sweep.yaml", cwd=tmp_path)
    found = rows(tmp_path / "sweep.csv")
    assert len(found) > 10 and {r["status"] for r in found} == {"0"}
