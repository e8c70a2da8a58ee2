"""Ground, scenes, contact wrenches and paused starts: as a user runs them, with real rclpy."""

import csv
import json
import math
import subprocess

import pytest
from conftest import BINARY, nanoseconds, wait_until
from cyclone import listen as cyclone_listen
from geometry_msgs.msg import TwistStamped, WrenchStamped
from rosbags.highlevel import AnyReader
from rosbags.typesys import Stores, get_typestore
from rosgraph_msgs.msg import Clock
from simulation import BLOCK, ORIGIN, columns, refused, simulate

ROOT = BINARY.parents[2]
LEG_AND_BALL = ROOT / "config/leg_and_ball.yaml"
G = 9.80665
WEIGHT = 0.5 * 1000 * 0.2**3 * G


@pytest.fixture
def block(tmp_path):
    """A block of 4 kg, whose wrench is told in the world's axes."""
    path = tmp_path / "block.urdf"
    path.write_text(BLOCK.format(frame="world"))
    return path


def test_a_block_comes_to_rest_on_the_ground_and_the_ground_carries_it(block, tmp_path):
    contacts = tmp_path / "contacts.csv"
    start = ["--base", "free", "--base-pose", "0,0,0.11,0,0,0,1", "--ground"]
    summary = simulate(block, "--duration", 2, *start, "--out", tmp_path / "rows.csv", "--contacts", contacts, "--every", 0.1)
    rows = columns(tmp_path / "rows.csv")
    assert abs(rows["base.z"][-1] - 0.1) < 1e-4 and abs(rows["base.vz"][-1]) < 1e-6
    assert summary["contacts"] >= 3 and 0 <= summary["worst_penetration"] < 3e-3
    assert str(contacts) in summary["output"]
    with open(contacts, newline="") as file:
        table = list(csv.DictReader(file))
    last = [row for row in table if row["time"] == table[-1]["time"]]
    assert len(last) == summary["contacts"]
    assert {(row["first"], row["second"]) for row in last} == {("block", "ground")}
    # Force is on the second, the ground: it is pressed down with the weight.
    assert math.isclose(sum(float(row["fz"]) for row in last), -WEIGHT, rel_tol=1e-3)
    assert all(float(row["nz"]) == -1.0 for row in last)


def test_without_ground_it_falls(block, tmp_path):
    simulate(block, "--duration", 1, "--base", "free", "--off", "deactivation", "--out", tmp_path / "rows.csv")
    assert columns(tmp_path / "rows.csv")["base.z"][-1] < -4


def test_the_leg_kicks_the_ball(tmp_path):
    """A scene needs no URDF on the command line if it names one."""
    command = [BINARY, "simulate", "--scene", LEG_AND_BALL, "--duration", "1", "--out", tmp_path / "kick.csv"]
    done = subprocess.run([*map(str, command)], capture_output=True, text=True)
    assert done.returncode == 0, done.stderr
    assert json.loads(done.stdout)["warnings"] == []
    rows = columns(tmp_path / "kick.csv")
    assert rows["ball.x"][0] == 0.33 and rows["ball.x"][-1] > 0.6
    assert "wall.x" not in rows and "base.x" not in rows


def test_a_bag_has_an_odometry_of_its_own_for_what_floats_beside_the_robot(tmp_path):
    path = tmp_path / "kick" / "kick.mcap"
    command = [BINARY, "simulate", "--scene", LEG_AND_BALL, "--duration", "0.01", "--out", path]
    done = subprocess.run([*map(str, command)], capture_output=True, text=True)
    assert done.returncode == 0, done.stderr
    with AnyReader([path.parent], default_typestore=get_typestore(Stores.ROS2_JAZZY)) as reader:
        read = [(c.topic, reader.deserialize(raw, c.msgtype)) for c, _, raw in reader.messages()]
    odometry = [message for topic, message in read if topic == "/ball/odom"]
    assert {topic for topic, _ in read} == {"/clock", "/joint_states", "/ball/odom"} and len(odometry) == 11
    assert odometry[0].child_frame_id == "ball" and odometry[0].pose.pose.position.x == 0.33


def test_a_scene_without_any_robot_is_refused(tmp_path):
    path = tmp_path / "scene.yaml"
    path.write_text("version: 1\n")
    done = subprocess.run([BINARY, "simulate", "--scene", path, "--duration", "1"], capture_output=True, text=True)
    assert done.returncode == 2 and "name a URDF file" in done.stderr


def test_bodies_alone_make_a_scene(tmp_path):
    path = tmp_path / "scene.yaml"
    path.write_text(
        "version: 1\nground: true\nbodies:\n  - {name: ball, mass: 1, shape: {sphere: {radius: 0.1}}, pose: [0, 0, 1, 0, 0, 0, 1]}\n"
    )
    command = [BINARY, "simulate", "--scene", path, "--duration", "0.1", "--out", tmp_path / "rows.csv"]
    done = subprocess.run([*map(str, command)], capture_output=True, text=True)
    assert done.returncode == 0, done.stderr
    assert math.isclose(columns(tmp_path / "rows.csv")["ball.z"][-1], 1 - G * 0.1**2 / 2, rel_tol=1e-3)


def test_a_wrong_body_gives_code_2_with_file_line_and_name(block, tmp_path):
    path = tmp_path / "scene.yaml"
    path.write_text("version: 1\nbodies:\n  - {name: ball, mass: 1, shape: {sphere: {radios: 1}}}\n")
    message = refused(block, "--duration", 1, "--scene", path)
    for part in [str(path), "line 3", "bodies[0] 'ball'", "radios"]:
        assert part in message
    checked = subprocess.run([BINARY, "check", block, "--scene", path], capture_output=True, text=True)
    assert checked.returncode == 1 and "radios" in checked.stderr


def test_inspect_lists_what_stands_in_the_world():
    command = [BINARY, "inspect", "--scene", LEG_AND_BALL, "--json"]
    world = json.loads(subprocess.run(command, capture_output=True, text=True, check=True).stdout)["world"]
    assert "ball" in world["dynamic"] and "foot" in world["dynamic"]
    assert {"wall", "hip"} <= set(world["static"])
    assert world["joints"] == ["hip_pitch", "knee_pitch", "ankle_pitch"]
    forms = {c["name"]: (c["form"], c["friction"]) for c in world["colliders"]}
    assert forms["ball"] == ("ball", 0.9) and forms["ground"] == ("half-space", 0.9)
    table = subprocess.run([BINARY, "inspect", "--scene", LEG_AND_BALL], capture_output=True, text=True, check=True).stdout
    assert "half-space" in table and "static: hip, wall" in table


# The node


@pytest.mark.parametrize("frame", ["world", "body"])
def test_the_wrench_of_the_ground_on_a_standing_block(start, tmp_path, frame):
    """Turned by a quarter about X, the body's y axis points up."""
    urdf = tmp_path / "block.urdf"
    urdf.write_text(BLOCK.format(frame=frame))
    scene = tmp_path / "scene.yaml"
    root = math.sqrt(0.5)
    scene.write_text(f"version: 1\nrobot: {{base: free, pose: [0.3, 0, 0.1, {root}, 0, 0, {root}]}}\nground: true\n")
    bench = start("-p", f"scene:={scene}", urdf=urdf)
    wrenches = bench.probe.listen(WrenchStamped, "wrench/block")
    wait_until(lambda: len(wrenches) > 300, what="wrenches")
    last = wrenches[-1]
    up = last.wrench.force.z if frame == "world" else last.wrench.force.y
    assert last.header.frame_id == ("world" if frame == "world" else "block")
    assert math.isclose(up, WEIGHT, rel_tol=1e-3)
    others = [last.wrench.force.x, last.wrench.torque.x, last.wrench.torque.y, last.wrench.torque.z]
    assert all(abs(x) < 1e-2 for x in others), "the block stands straight: no torque about its origin"
    wait_until(lambda: bench.count("simulation", "contacts") not in (None, "0"), what="contacts in /diagnostics")
    assert float(bench.count("simulation", "worst penetration [m]")) < 1e-3


def test_the_parameter_ground_lays_one(start, block):
    bench = start("-p", "ground:=true", "-p", "base:=free", urdf=block)
    twists = bench.probe.listen(TwistStamped, "twist/block")
    wrenches = bench.probe.listen(WrenchStamped, "wrench/block")
    # The middle of the block starts on the ground: it is pushed out and comes to rest.
    carried = lambda: wrenches and math.isclose(wrenches[-1].wrench.force.z, WEIGHT, rel_tol=1e-2)
    wait_until(lambda: carried() and twists and abs(twists[-1].twist.linear.z) < 1e-2, what="rest")


def test_a_scene_moves_its_bodies_on_tf_and_keeps_the_static_ones(start):
    bench = start("-p", f"scene:={LEG_AND_BALL}", "-p", "start:=free", urdf=ROOT / "urdf/leg.urdf")
    tf, frames = cyclone_listen("tf", bench.domain), {}

    def kicked():
        frames.update({t.child_frame_id: t for m in tf.take_all() for t in m.transforms})
        return "ball" in frames and frames["ball"].transform.translation.x > 0.4

    wait_until(kicked, what="the ball to be kicked")
    assert frames["ball"].header.frame_id == "world" and "wall" not in frames
    assert list(bench.states[-1].name) == ["hip_pitch", "knee_pitch", "ankle_pitch"]
    wrenches = bench.probe.listen(WrenchStamped, "wrench/ball")
    wait_until(lambda: len(wrenches) > 10, what="the wrench of the ball")


def test_a_wrong_scene_keeps_the_node_from_starting(tmp_path, block):
    path = tmp_path / "scene.yaml"
    path.write_text("version: 1\nground: {fricton: 1}\n")
    command = [BINARY, "run", block, "--ros-args", "-p", f"scene:={path}"]
    done = subprocess.run(command, capture_output=True, text=True, timeout=60)
    assert done.returncode == 2 and "fricton" in done.stderr and str(path) in done.stderr


def test_parameters_win_over_the_scene(start, tmp_path, block):
    scene = tmp_path / "scene.yaml"
    scene.write_text("version: 1\nworld: {control_interval: 0.002, steps_per_interval: 3}\nrobot: {base: free}\nground: true\n")
    bench = start("-p", f"scene:={scene}", "-p", "control_interval:=0.004", urdf=block)
    client = bench.probe.parameters()
    assert bench.probe.get(client, "control_interval") == 0.004
    assert bench.probe.get(client, "steps_per_interval") == 3


def test_paused_time_stands_until_it_is_let_go(start):
    bench = start("-p", "start:=paused", urdf=ORIGIN)
    clocks = bench.probe.listen(Clock, "/clock")
    moving = cyclone_listen("tf", bench.domain)
    states = len(bench.states)
    wait_until(lambda: len(clocks) > 20 and len(bench.states) > states + 20 and moving.take_all(), what="states of a world that stands")
    assert {nanoseconds(c.clock) for c in clocks} == {0}
    assert {nanoseconds(s.header.stamp) for s in bench.states} == {0}
    client = bench.probe.parameters()
    assert bench.probe.get(client, "paused") is True
    [result] = bench.probe.set(client, paused=False)
    assert result.successful
    wait_until(lambda: nanoseconds(bench.states[-1].header.stamp) > 200_000_000, what="time to run")
    stamps = sorted({nanoseconds(s.header.stamp) for s in bench.states})
    assert stamps[:100] == [1_000_000 * i for i in range(100)], "no interval is left out"
    [result] = bench.probe.set(client, paused=True)
    assert result.successful
    stood = bench.stands()
    told = lambda: any(s.message == "paused" for s in bench.diagnostics[-1].status)
    reports = len(bench.diagnostics)
    wait_until(lambda: len(bench.diagnostics) > reports and told(), what="the pause in a new report")
    seen = len(bench.states)
    wait_until(lambda: len(bench.states) > seen + 5, what="states of a world that stands again")
    assert {nanoseconds(s.header.stamp) for s in bench.states[seen:]} == {stood}
    assert max(abs(x) for x in bench.states[-1].position) < 0.05, "it holds, as with start: hold"
