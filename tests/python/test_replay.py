"""`realnoid replay`: a run with real rclpy, made again bit for bit; and whatever is not the same is found."""

import json
import re
import signal
import subprocess
import threading

import pytest
from conftest import ARM, BINARY, HERE, Bench, nanoseconds, until_heard, wait_until
from mcap.reader import make_reader
from mcap.writer import CompressionType, Writer
from rclpy.serialization import deserialize_message, serialize_message
from realnoid.msg import AxisCommands, WorldEvent
from sensor_msgs.msg import JointState
from services import Services
from simulation_interfaces.msg import EntityState, SimulationState
from simulation_interfaces.srv import ResetSimulation, SetEntityState, SetSimulationState, StepSimulation
from std_msgs.msg import Float64MultiArray
from std_srvs.srv import Trigger
from test_recording import events, file_of, messages, recorder, switchable

HUMANOID = HERE / "../../urdf/origin.urdf"


def replay(*arguments, cwd=None, timeout=120):
    command = [BINARY, "replay", *map(str, arguments)]
    return subprocess.run(command, capture_output=True, text=True, timeout=timeout, cwd=cwd)


def same(bag, **options):
    """Insists on the same bits; (intervals, states, messages, orders)."""
    result = replay(bag, **options)
    assert result.returncode == 0, result.stdout + result.stderr
    assert "SAME: all bits" in result.stdout
    counts = re.search(r"(\d+) control intervals .* (\d+) states, (\d+) published messages and (\d+) orders", result.stdout)
    return tuple(map(int, counts.groups()))


def let_time_pass(bench, seconds):
    stamp = nanoseconds(bench.states[-1].header.stamp)
    wait_until(lambda: nanoseconds(bench.states[-1].header.stamp) > stamp + seconds * 1e9, timeout=30, what="time to pass")


def busy(bench):
    """All kinds of commands, settings that change while it runs, a pause, another engine and back, an order."""
    n = len(bench.states[-1].name)
    client = bench.probe.parameters()
    effort = bench.probe.publisher(Float64MultiArray, "effort_command")
    servo = bench.probe.publisher(Float64MultiArray, "servo_command")
    joint = bench.probe.publisher(JointState, "joint_command")
    changes = lambda **values: [r.successful for r in bench.probe.set(client, **values)]
    last = lambda: bench.states[-1]
    torques = Float64MultiArray(data=[0.3 - 0.1 * (i % 5) for i in range(n)])
    until_heard(lambda: effort.publish(torques), lambda: last().effort[0] > 0.2, "the torques")
    let_time_pass(bench, 0.1)
    assert changes(gravity=[3.0, -1.0, -9.0], steps_per_interval=3) == [True, True]
    target = JointState(name=[last().name[0]], position=[0.2], velocity=[1.0])
    until_heard(lambda: joint.publish(target), lambda: abs(last().position[0] - 0.2) < 0.01, "the target")
    remember = bench.probe.node.create_client(Trigger, "remember_pose")
    assert remember.wait_for_service(30.0)
    assert bench.probe.call(lambda: remember.call_async(Trigger.Request())).success
    targets = Float64MultiArray(data=[0.02 * (i % 3) for i in range(n)])
    until_heard(lambda: servo.publish(targets), lambda: abs(last().position[0]) < 0.01, "the targets")
    assert changes(paused=True) == [True]
    assert changes(solver_iterations=20, integrator="semi_implicit_euler") == [True, True]
    assert changes(paused=False) == [True]
    let_time_pass(bench, 0.1)
    assert changes(engine="rapier", control_interval=0.002) == [True, True]
    let_time_pass(bench, 0.1)
    assert changes(engine="rbx", time_scale=0.5) == [True, True]
    let_time_pass(bench, 0.1)


@pytest.fixture(scope="module")
def run(tmp_path_factory):
    """A busy run of the arm."""
    folder = tmp_path_factory.mktemp("replay")
    bench = Bench(urdf=switchable(folder), options=["--record", folder / "run"]).wait_for_first_sample()
    try:
        busy(bench)
    finally:
        bench.close()
    return folder / "run"


def test_a_busy_run_has_the_same_bits(run):
    intervals, states, compared, orders = same(run)
    file = file_of(run)
    stored = messages(file, "/axis_commands")
    assert intervals == stored[-1].interval and states == len(stored)
    assert compared == 4 * states, "joint_states, and three monitored links"
    assert orders == len(events(file, "remember")) >= 1
    settings = [json.loads(e.data) for e in events(file, "settings")]
    assert {s["engine"] for s in settings} == {"rbx", "rapier"} and len(settings) >= 5
    assert len([m for m in stored if len(m.mode)]) >= 4


def test_it_says_so_from_another_folder_too_and_without_the_robot(run, tmp_path):
    (run.parent / "arm.urdf").unlink(missing_ok=True)
    assert same(file_of(run), cwd=tmp_path)[0] > 100, "the bag holds the text"


def test_rows_of_the_replay_are_the_recorded_states(run, tmp_path):
    out = tmp_path / "rows.csv"
    assert replay(run, "--out", out).returncode == 0
    header, *rows = [line.split(",") for line in out.read_text().splitlines()]
    recorded = messages(file_of(run), "/joint_states")
    assert len(rows) == len(recorded)
    hip = header.index("hip.position")
    assert [float(row[hip]) for row in rows] == [m.position[0] for m in recorded]
    result = replay(run, "--out", tmp_path / "rows.mcap")
    assert result.returncode == 2 and "FILE.csv" in result.stderr


def test_a_free_humanoid_in_a_scene_has_the_same_bits(tmp_path):
    (tmp_path / "scene.yaml").write_text(
        "version: 1\nrobot:\n  base: free\n  pose: [0, 0, 1.2, 0, 0, 0, 1]\nground: {friction: 0.7}\n"
        "bodies:\n- {name: ball, pose: [1, 0, 2, 0, 0, 0, 1], shape: {sphere: {radius: 0.1}}, mass: 2}\n"
    )
    bench = Bench("-p", "scene:=scene.yaml", urdf=HUMANOID, options=["--record", "run"], cwd=tmp_path)
    bench.wait_for_first_sample()
    try:
        let_time_pass(bench, 1.0)
    finally:
        bench.close()
    intervals, *_ = same(tmp_path / "run", cwd="/")
    assert intervals > 1000
    wrenches = [t for t in {c for c, *_ in raw(file_of(tmp_path / "run"))} if t.startswith("/wrench/")]
    assert wrenches, "contacts are compared, too"


def raw(file):
    from test_recording import raw_messages

    return raw_messages(file)


BALL = """
version: 1
bodies:
  - {name: ball, shape: {sphere: {radius: 0.1}}, mass: 1.0, pose: [1, 2, 0.5, 0, 0, 0, 1]}
ground: true
"""


def test_resets_steps_and_placed_bodies_have_the_same_bits(tmp_path):
    (tmp_path / "scene.yaml").write_text(BALL)
    bench = Bench("-p", f"scene:={tmp_path}/scene.yaml", urdf=switchable(tmp_path), options=["--record", tmp_path / "run"])
    bench.wait_for_first_sample()
    try:
        call = Services(bench)
        effort = bench.probe.publisher(Float64MultiArray, "effort_command")
        push = lambda *torques: effort.publish(Float64MultiArray(data=list(torques)))
        ok = lambda answer: answer.result.result == 1
        push(1.0, -0.5, 0.2)
        let_time_pass(bench, 0.1)
        assert ok(call(ResetSimulation, scope=ResetSimulation.Request.SCOPE_STATE))
        push(-1.0, 0.5, 0.3)
        let_time_pass(bench, 0.1)
        state = EntityState()
        state.pose.position.z, state.pose.orientation.w, state.twist.linear.x = 1.0, 1.0, 0.7
        assert ok(call(SetEntityState, entity="ball", state=state))
        let_time_pass(bench, 0.1)
        assert ok(call(SetSimulationState, state=SimulationState(state=SimulationState.STATE_PAUSED)))
        assert ok(call(StepSimulation, steps=25))
        assert ok(call(ResetSimulation, scope=ResetSimulation.Request.SCOPE_ALL))
        assert ok(call(StepSimulation, steps=30))
        push(0.5, 0.5, 0.5)
        assert ok(call(SetSimulationState, state=SimulationState(state=SimulationState.STATE_PLAYING)))
        let_time_pass(bench, 0.1)
    finally:
        bench.close()
    intervals, states, _, orders = same(tmp_path / "run")
    file = file_of(tmp_path / "run")
    kinds = [e.kind for e in events(file) if e.kind not in ("start", "settings")]
    assert kinds.count("reset") >= 2 and "place" in kinds and orders == len(kinds)
    stored = [m.interval for m in messages(file, "/axis_commands")]
    assert any(b < a for a, b in zip(stored, stored[1:])), "time went back"
    assert intervals > 430


def test_command_timeouts_and_lock_step_have_the_same_bits(tmp_path):
    arguments = ["-p", "command_timeout:=0.05", "-p", "on_timeout:=brake"]
    bench = Bench(*arguments, urdf=switchable(tmp_path), options=["--record", tmp_path / "run"]).wait_for_first_sample()
    try:
        effort = bench.probe.publisher(Float64MultiArray, "effort_command")
        for torque in (1.0, -2.0):
            heard = lambda: any(s.effort[0] / torque > 0.75 for s in list(bench.states)[-300:])
            until_heard(lambda: effort.publish(Float64MultiArray(data=[torque] * 3)), heard, "the torque")
            let_time_pass(bench, 0.2)
        client = bench.probe.parameters()
        assert bench.probe.set(client, lockstep=True)[0].successful
        joint = bench.probe.publisher(JointState, "joint_command")
        bench.stands()
        for _ in range(50):
            last = bench.states[-1]
            message = JointState(name=["hip"], effort=[0.3])
            message.header.stamp = last.header.stamp
            joint.publish(message)
            wait_until(lambda: nanoseconds(bench.states[-1].header.stamp) > nanoseconds(last.header.stamp), what="the step")
    finally:
        bench.close()
    assert same(tmp_path / "run")[0] > 400
    kinds = {e.kind for e in events(file_of(tmp_path / "run"))}
    assert "short_brake" in kinds


def test_load_of_the_machine_makes_no_difference(tmp_path):
    """The loop is late, catches up, and gives time up; the bits are those of the recorded intervals all the same."""
    stop = threading.Event()
    burners = [threading.Thread(target=lambda: [None for _ in iter(stop.is_set, True)], daemon=True) for _ in range(4)]
    bench = Bench(urdf=switchable(tmp_path), options=["--record", tmp_path / "run"]).wait_for_first_sample()
    try:
        [b.start() for b in burners]
        effort = bench.probe.publisher(Float64MultiArray, "effort_command")
        for k in range(30):
            effort.publish(Float64MultiArray(data=[0.01 * k] * 3))
            let_time_pass(bench, 0.01)
    finally:
        stop.set()
        bench.close()
    assert same(tmp_path / "run")[0] >= 300


def tampered(run, folder, topic, change):
    """A copy of the bag in which `change` has been applied to the data of every message of a topic (None: left out)."""
    folder.mkdir()
    target = folder / "bag_0.mcap"
    with open(file_of(run), "rb") as source, open(target, "wb") as out:
        writer = Writer(out, compression=CompressionType.NONE)
        writer.start("ros2", "tampered")
        schemas, channels, count = {}, {}, 0
        for schema, channel, message in make_reader(source).iter_messages(log_time_order=False):
            if schema.id not in schemas:
                schemas[schema.id] = writer.register_schema(schema.name, schema.encoding, schema.data)
            if channel.id not in channels:
                channels[channel.id] = writer.register_channel(
                    channel.topic, channel.message_encoding, schemas[schema.id], channel.metadata
                )
            data = message.data
            if channel.topic == topic:
                data = change(count, data)
                count += 1
            if data is not None:
                writer.add_message(channels[channel.id], message.log_time, data, message.publish_time, message.sequence)
        writer.finish()
    assert count > 0
    return folder


def on(kind, number, edit):
    """Edits the message of this number."""

    def change(count, data):
        if count != number:
            return data
        message = deserialize_message(data, kind)
        edit(message)
        return serialize_message(message)

    return change


def different(bag):
    result = replay(bag)
    assert result.returncode == 1, result.stdout + result.stderr
    return result.stdout


def test_an_untouched_copy_is_still_the_same(run, tmp_path):
    assert same(tampered(run, tmp_path / "copy", "/joint_states", lambda _, data: data)) == same(run)


def test_a_changed_bit_of_a_joint_state_is_found(run, tmp_path):
    def edit(m):
        m.position[1] = float.fromhex((m.position[1]).hex()) * (1 + 2.0**-52) + 2.0**-1074

    text = different(tampered(run, tmp_path / "bag", "/joint_states", on(JointState, 57, edit)))
    assert "DIFFERENT from control interval 57 on (0.057000 s): joint_states: axis 'knee' position recorded" in text


def test_a_changed_twist_is_found(run, tmp_path):
    from geometry_msgs.msg import TwistStamped

    def edit(m):
        m.twist.angular.z += 1e-9

    text = different(tampered(run, tmp_path / "bag", "/twist/thigh", on(TwistStamped, 100, edit)))
    assert "DIFFERENT from control interval 100 on" in text and "twist/thigh: angular z recorded" in text


def test_changed_commands_are_found(run, tmp_path):
    stored = messages(file_of(run), "/axis_commands")
    at = [i for i, m in enumerate(stored) if len(m.mode)][1]

    def edit(m):
        m.torque[0] += 1e-6

    text = different(tampered(run, tmp_path / "bag", "/axis_commands", on(AxisCommands, at, edit)))
    assert f"DIFFERENT from control interval {stored[at].interval} on" in text and "joint_states: axis 'hip'" in text


def test_changed_settings_are_found(run, tmp_path):
    told = messages(file_of(run), "/world_events")
    at = next(i for i, e in enumerate(told) if e.kind == "settings" and "3.0,-1.0" in e.data)

    def edit(m):
        m.data = m.data.replace("3.0,-1.0,-9.0", "0.0,0.0,-9.0").replace('"steps_per_interval":3', '"steps_per_interval":4')

    assert "DIFFERENT" in different(tampered(run, tmp_path / "bag", "/world_events", on(WorldEvent, at, edit)))


def test_a_changed_digest_alone_is_found(run, tmp_path):
    change = lambda n, data: data[:-1] + bytes([data[-1] ^ 1]) if n == 77 else data
    text = different(tampered(run, tmp_path / "bag", "/state_digest", change))
    assert "DIFFERENT from control interval 77 on" in text and "something that joint_states do not show" in text


def test_another_robot_in_the_bag_is_found(run, tmp_path):
    def edit(m):
        m.data = m.data.replace("0.01", "0.011", 1)

    result = replay(tampered(run, tmp_path / "bag", "/world_events", on(WorldEvent, 0, edit)))
    assert result.returncode == 2 and "another model" in result.stderr


def test_missing_intervals_are_told(run, tmp_path):
    result = replay(tampered(run, tmp_path / "bag", "/axis_commands", lambda n, data: None if n in (90, 91) else data))
    assert result.returncode == 1
    assert "INCOMPLETE: the same bits as far as it goes" in result.stdout
    assert "joint_states of 90000000 ns follows the commands of 89000000 ns: messages are missing" in result.stdout


def test_a_damaged_file_is_told(run, tmp_path):
    data = bytearray(file_of(run).read_bytes())
    data[len(data) // 2] ^= 0xFF
    (tmp_path / "damaged.mcap").write_bytes(data)
    result = replay(tmp_path / "damaged.mcap")
    assert result.returncode in (1, 2) and "is damaged" in result.stdout + result.stderr


def test_a_bag_that_was_cut_off_is_replayed_up_to_the_last_flush(run, tmp_path):
    data, whole, replayed = file_of(run).read_bytes(), same(run)[0], []
    for percent in (1, 70, 80, 90, 95, 99):
        (tmp_path / "cut.mcap").write_bytes(data[: len(data) * percent // 100])
        result = replay(tmp_path / "cut.mcap")
        if result.returncode == 2:
            assert "was cut off before its first flush" in result.stderr and not replayed
            continue
        assert result.returncode == 0 and "it has no end" in result.stdout, result.stdout + result.stderr
        replayed.append(int(re.search(r"(\d+) control intervals", result.stdout)[1]))
    assert replayed == sorted(replayed) and 100 < replayed[-1] <= whole


def test_after_sigkill_it_can_be_replayed(tmp_path):
    from test_recording import killed

    killed(tmp_path / "run")
    assert same(tmp_path / "run")[0] > 1000


def test_a_bag_from_the_middle_of_a_run_is_refused_with_the_reason(start, tmp_path):
    bench = start()
    record = recorder(bench)
    let_time_pass(bench, 0.05)
    assert record(True, tmp_path / "run").success
    let_time_pass(bench, 0.05)
    assert record(False).success
    result = replay(tmp_path / "run")
    assert result.returncode == 2 and "begins in the middle of a run" in result.stderr


def test_a_bag_that_the_service_began_before_time_ran_can_be_replayed(start, tmp_path):
    bench = start("-p", "paused:=true", urdf=switchable(tmp_path))
    record = recorder(bench)
    assert record(True, tmp_path / "run").success
    client = bench.probe.parameters()
    assert bench.probe.set(client, paused=False)[0].successful
    busy(bench)
    assert record(False).success
    assert same(tmp_path / "run")[0] > 300


def test_other_bags_and_no_bags_are_refused(tmp_path):
    assert replay(tmp_path / "nothing").returncode == 2
    assert "has no .mcap file" in replay(tmp_path).stderr
    subprocess.run([BINARY, "simulate", ARM, "--duration", "0.01", "--out", tmp_path / "a.mcap"], check=True, capture_output=True)
    result = replay(tmp_path)
    assert result.returncode == 2 and "was not recorded by realnoid run --record" in result.stderr
    (tmp_path / "b.mcap").write_text("nonsense")
    result = replay(tmp_path / "b.mcap")
    assert result.returncode == 2 and "no MCAP file" in result.stderr


def test_a_mesh_file_that_has_changed_is_named(tmp_path):
    import numpy
    import trimesh

    trimesh.creation.box(extents=numpy.array([0.2, 0.1, 0.3])).export(tmp_path / "box.stl")
    urdf = tmp_path / "box.urdf"
    urdf.write_text(
        '<robot name="r"><link name="a"/><link name="b"><visual><geometry><mesh filename="box.stl"/></geometry></visual>'
        '<realnoid><body specific_gravity="1"/></realnoid></link>'
        '<joint name="j" type="continuous"><parent link="a"/><child link="b"/><origin rpy="0.1 0 0"/><axis xyz="0 1 0"/></joint></robot>'
    )
    bench = Bench(urdf=urdf, options=["--record", tmp_path / "run"]).wait_for_first_sample()
    try:
        let_time_pass(bench, 0.05)
    finally:
        bench.close()
    assert same(tmp_path / "run")[0] > 50
    trimesh.creation.box(extents=numpy.array([0.2, 0.1, 0.4])).export(tmp_path / "box.stl")
    result = replay(tmp_path / "run")
    assert result.returncode == 2 and "box.stl" in result.stderr and "not what they were" in result.stderr
