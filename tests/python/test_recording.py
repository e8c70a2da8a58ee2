"""Bags of `run --record` and of the service `record`, read by two independent readers and by rclpy's own deserialisation."""

import io
import json
import signal
import struct
import subprocess
import sys
from importlib import import_module
from pathlib import Path

import pytest
import yaml
from conftest import ARM, Bench, nanoseconds, wait_until
from mcap.reader import make_reader
from mcap_ros2.decoder import DecoderFactory
from rclpy.serialization import deserialize_message
from realnoid.srv import Record
from rosbags.highlevel import AnyReader
from rosbags.typesys import Stores, get_types_from_msg, get_typestore
from sensor_msgs.msg import JointState
from services import Services
from std_msgs.msg import Float64MultiArray

COMMANDS = ("effort_command", "servo_command", "joint_command")
OWN = {"/axis_commands", "/world_events", "/state_digest"}


def raw_messages(file):
    """(topic, type, log time, bytes) in the order of the file, also of a file without an end, or while its last chunk is written."""
    from mcap.exceptions import EndOfFile
    from mcap.stream_reader import CRCValidationError, StreamReader

    # What is there now: while it is read, it may grow.
    stream, schemas, channels = io.BytesIO(Path(file).read_bytes()), {}, {}
    try:
        for record in StreamReader(stream, validate_crcs=True).records:
            kind = type(record).__name__
            if kind == "Schema":
                schemas[record.id] = record
            elif kind == "Channel":
                channels[record.id] = record
            elif kind == "Message":
                channel = channels[record.channel_id]
                yield channel.topic, schemas[channel.schema_id].name, record.log_time, record.data
    except EndOfFile:
        return
    except (CRCValidationError, struct.error):
        # What is cut off is read short: a chunk's sum differs then, and of an index's number bytes are missing.
        assert not stream.read(1), "broken, and not at the end"


def message_class(name):
    package, _, kind = name.split("/")
    return getattr(import_module(f"{package}.msg"), kind)


def messages(file, topic):
    return [deserialize_message(d, message_class(kind)) for t, kind, _, d in raw_messages(file) if t == topic]


def file_of(folder):
    [file] = Path(folder).glob("*.mcap")
    return file


def every_sample_is_there(file, ended_by_service=False):
    """Intervals are consecutive, and every one has its joint_states; but the service may end a bag between what was commanded in
    an interval and the state that came of it."""
    intervals = [m.interval for m in messages(file, "/axis_commands")]
    assert intervals == list(range(intervals[0], intervals[0] + len(intervals)))
    stamps = [nanoseconds(m.header.stamp) for m in messages(file, "/joint_states")]
    assert len(intervals) - len(stamps) in ((0, 1) if ended_by_service else (0,))
    assert all(b - a == 1_000_000 for a, b in zip(stamps, stamps[1:]))
    return intervals


def events(file, *kinds):
    return [m for m in messages(file, "/world_events") if not kinds or m.kind in kinds]


def move(bench, seconds=0.3):
    """Commands on all three topics, each when the one before has had its effect: until the node has found a publisher (up to a
    heartbeat of 3 s), what others publish overtakes it."""
    n = len(bench.states[-1].name)
    effort = bench.probe.publisher(Float64MultiArray, "effort_command")
    servo = bench.probe.publisher(Float64MultiArray, "servo_command")
    joint = bench.probe.publisher(JointState, "joint_command")
    hip, last = bench.states[-1].name[0], lambda: bench.states[-1]
    for publish, seen in (
        (lambda: effort.publish(Float64MultiArray(data=[0.1] * n)), lambda: abs(last().position[0]) > 0.005),
        (lambda: joint.publish(JointState(name=[hip], position=[0.2])), lambda: abs(last().position[0] - 0.2) < 0.01),
        (lambda: servo.publish(Float64MultiArray(data=[0.05] * n)), lambda: abs(last().position[0] - 0.05) < 0.01),
    ):
        publish()
        wait_until(seen, what="its effect")
        stamp = nanoseconds(last().header.stamp)
        wait_until(lambda: nanoseconds(last().header.stamp) > stamp + seconds * 1e9 / 3, what="time to pass")
    for topic in COMMANDS:
        wait_until(lambda: bench.count("commands", f"{topic} accepted") == "1", what=f"{topic} to arrive")


def switchable(folder):
    """The arm, all of whose drives may change their mode."""
    urdf = folder / "arm.urdf"
    urdf.write_text(ARM.read_text().replace('switchable="false"', ""))
    return urdf


@pytest.fixture(scope="module")
def recorded(tmp_path_factory):
    """A node that was recorded from its start to SIGINT, and what a subscriber has seen of it."""
    folder = tmp_path_factory.mktemp("recorded") / "run"
    urdf = switchable(folder.parent)
    bench = Bench(urdf=urdf, options=["--record", folder]).wait_for_first_sample()
    try:
        move(bench)
        client = bench.probe.parameters()
        assert bench.probe.set(client, gravity=[0.0, 0.0, -5.0])[0].successful
        found = lambda: ("forward_dynamics", "/") in bench.probe.node.get_node_names_and_namespaces()
        wait_until(found, what="the node to be found")
        topics = dict(bench.probe.node.get_publisher_names_and_types_by_node("forward_dynamics", "/"))
        wait_until(lambda: bench.count("recording", "messages") not in (None, "0"), what="a report")
    finally:
        output = bench.close()
    return {"folder": folder, "urdf": urdf, "topics": topics, "states": bench.states, "output": output, "log": bench.log}


def test_every_topic_of_the_node_is_in_the_bag(recorded):
    found = {topic: kind for topic, kind, *_ in raw_messages(file_of(recorded["folder"]))}
    published = {t: kinds[0] for t, kinds in recorded["topics"].items()}
    silent = {t for t in published if t not in found}
    assert {"/joint_states", "/clock", "/tf", "/tf_static", "/robot_description", "/diagnostics", "/rosout"} <= set(found)
    assert silent <= {"/debug/markers"}, "made only while somebody subscribes"
    assert {t: found[t] for t in published if t in found} == {t: k for t, k in published.items() if t in found}
    assert {f"/{t}" for t in COMMANDS} | OWN <= set(found)


def test_the_bag_holds_every_sample_that_a_subscriber_saw(recorded):
    file = file_of(recorded["folder"])
    every_sample_is_there(file)
    there = {nanoseconds(m.header.stamp): m for m in messages(file, "/joint_states")}
    assert 0 in there and len(recorded["states"]) > 100
    for state in recorded["states"]:
        assert there[nanoseconds(state.header.stamp)] == state
    assert not events(file, "lost")


def test_commands_are_there_as_they_came_and_as_they_were_in_force(recorded):
    file = file_of(recorded["folder"])
    [effort], [servo] = messages(file, "/effort_command"), messages(file, "/servo_command")
    [joint] = messages(file, "/joint_command")
    assert set(effort.data) == {0.1} and set(servo.data) == {0.05} and list(joint.position) == [0.2]
    changes = [m for m in messages(file, "/axis_commands") if len(m.mode)]
    assert len(changes) == 4, "at the start, and after each command"
    n = len(effort.data)
    assert [list(m.mode) for m in changes[1:]] == [[1] * n, [2] + [1] * (n - 1), [2] * n]
    assert list(changes[1].torque) == [0.1] * n and changes[2].target[0] == 0.2 and list(changes[3].target) == [0.05] * n


def test_events_tell_the_start_and_the_settings(recorded):
    told = events(file_of(recorded["folder"]))
    assert [e.kind for e in told] == ["start", "settings", "settings"]
    start, first, second = (json.loads(e.data) for e in told)
    assert start["from_start"] is True and list(start["origin"]["texts"].values()) == [recorded["urdf"].read_text()]
    assert start["parameters"]["control_interval"] == "0.001" and start["program"]["version"]
    assert (first["gravity"], second["gravity"]) == ([0.0, 0.0, -9.80665], [0.0, 0.0, -5.0])
    assert (told[0].interval, told[1].interval) == (0, 0) and told[2].interval > 100


def test_parameter_events_and_the_log_are_there(recorded):
    file = file_of(recorded["folder"])
    event, *again = messages(file, "/parameter_events")
    assert all(e.changed_parameters == event.changed_parameters for e in again), "a call may be made twice"
    assert event.node == "/forward_dynamics" and [p.name for p in event.changed_parameters] == ["gravity"]
    assert list(event.changed_parameters[0].value.double_array_value) == [0.0, 0.0, -5.0]
    logged = {m.msg for m in messages(file, "/rosout")}
    assert {m.msg for m in recorded["log"] if m.name == "forward_dynamics"} <= logged


def test_it_is_told_at_the_end(recorded):
    line = [line for line in recorded["output"].splitlines() if line.startswith("recorded ")]
    count = sum(1 for _ in raw_messages(file_of(recorded["folder"])))
    assert line == [f"recorded {count} messages in '{recorded['folder']}'"]


def test_three_readers_agree(recorded):
    file = file_of(recorded["folder"])
    stored = [(topic, time) for topic, _, time, _ in raw_messages(file)]
    assert [t for _, t in stored] == sorted({t for _, t in stored}), "times rise"
    with open(file, "rb") as stream:
        reader = make_reader(stream, validate_crcs=True, decoder_factories=[DecoderFactory()])
        decoded = [(c.topic, m.log_time) for _, c, m, _ in reader.iter_decoded_messages()]
    assert decoded == stored
    with AnyReader([recorded["folder"]]) as reader:
        found = [(c.topic, t) for c, t, raw in reader.messages() if reader.deserialize(raw, c.msgtype) is not None]
        latched = {c.topic for c in reader.connections if c.ext.offered_qos_profiles[0].durability.name == "TRANSIENT_LOCAL"}
    assert found == stored
    assert latched == {"/robot_description", "/tf_static"}
    for topic, kind, _, data in raw_messages(file):
        if kind != "tf2_msgs/msg/TFMessage":  # there is no wheel of tf2_msgs
            assert deserialize_message(data, message_class(kind)) is not None, topic


def test_bytes_are_those_of_an_independent_serialiser(recorded):
    with AnyReader([recorded["folder"]]) as reader:
        for connection, _, raw in reader.messages():
            message = reader.deserialize(raw, connection.msgtype)
            assert bytes(reader.typestore.serialize_cdr(message, connection.msgtype)) == bytes(raw), connection.topic


def test_definitions_and_hashes_are_those_of_rclpy(recorded):
    jazzy = get_typestore(Stores.ROS2_JAZZY)
    with open(file_of(recorded["folder"]), "rb") as stream:
        summary = make_reader(stream).get_summary()
    seen = set()
    for channel in summary.channels.values():
        name = summary.schemas[channel.schema_id].name
        package, _, kind = name.split("/")
        own = get_typestore(Stores.EMPTY)
        own.register(get_types_from_msg(summary.schemas[channel.schema_id].data.decode(), name))
        published = Path(sys.prefix) / "share" / package / "msg" / f"{kind}.json"
        if published.exists():
            hashes = {h["type_name"]: h["hash_string"] for h in json.loads(published.read_text())["type_hashes"]}
            expected = hashes[name]
        else:
            expected = jazzy.hash_rihs01(name)
        assert channel.metadata["topic_type_hash"] == own.hash_rihs01(name) == expected, name
        seen.add(name)
    assert {"realnoid/msg/AxisCommands", "realnoid/msg/WorldEvent", "diagnostic_msgs/msg/DiagnosticArray"} <= seen


def test_every_known_hash_is_that_of_jazzy():
    """Also of the types that no test happens to publish."""
    text = (Path(__file__).parent / "../../src/record/definitions.rs").read_text()
    known = dict(part.split('", "') for part in __import__("re").findall(r'"(\w+/\w+",\s*"RIHS01_[0-9a-f]+)"', text))
    known = {k.strip('"'): v for k, v in known.items()}
    assert len(known) > 20
    jazzy = get_typestore(Stores.ROS2_JAZZY)
    for name, value in known.items():
        package, kind = name.split("/")
        published = Path(sys.prefix) / "share" / package / "msg" / f"{kind}.json"
        if published.exists():
            hashes = {h["type_name"]: h["hash_string"] for h in json.loads(published.read_text())["type_hashes"]}
            assert hashes[f"{package}/msg/{kind}"] == value, name
        else:
            assert jazzy.hash_rihs01(f"{package}/msg/{kind}") == value, name


def test_sigterm_leaves_a_complete_bag(tmp_path):
    bench = Bench(options=["--record", tmp_path / "run"]).wait_for_first_sample()
    try:
        bench.simulator.stop(by=signal.SIGTERM)
    finally:
        bench.close()
    count = sum(1 for _ in raw_messages(file_of(tmp_path / "run")))
    document = yaml.safe_load((tmp_path / "run" / "metadata.yaml").read_text())["rosbag2_bagfile_information"]
    assert document["message_count"] == count > 0
    assert sum(t["message_count"] for t in document["topics_with_message_count"]) == count
    with AnyReader([tmp_path / "run"]) as reader:
        assert reader.message_count == count


def killed(folder):
    """A recording that was killed once a second or more of it was on the disk."""
    bench = Bench(options=["--record", folder]).wait_for_first_sample()
    try:
        flushed = lambda: sum(1 for t, *_ in raw_messages(file_of(folder)) if t == "/joint_states")
        wait_until(lambda: flushed() > 1100, what="a second on the disk")
        bench.simulator.process.send_signal(signal.SIGKILL)
        bench.simulator.process.wait(30)
    finally:
        bench.simulator.process.kill()
        bench.probe.close()
    return bench


def test_after_sigkill_all_is_readable_up_to_the_last_flush(tmp_path):
    bench = killed(tmp_path / "run")
    file = file_of(tmp_path / "run")
    every_sample_is_there(file)
    stamps = [nanoseconds(m.header.stamp) for m in messages(file, "/joint_states")]
    last_seen = nanoseconds(bench.states[-1].header.stamp)
    assert last_seen - stamps[-1] < 3_000_000_000, "flushed twice a second; the margin is for a loaded machine"
    document = yaml.safe_load((tmp_path / "run" / "metadata.yaml").read_text())["rosbag2_bagfile_information"]
    assert 0 < document["message_count"] <= sum(1 for _ in raw_messages(file))


def test_recover_completes_a_bag_that_was_cut_off(tmp_path):
    killed(tmp_path / "run")
    file = file_of(tmp_path / "run")
    before = list(raw_messages(file))
    with pytest.raises(Exception):
        with AnyReader([tmp_path / "run"]) as reader:
            list(reader.messages())
    result = recover(tmp_path / "run")
    assert result.returncode == 0 and f"{len(before)} messages" in result.stdout, result.stderr
    assert list(raw_messages(file)) == before
    with AnyReader([tmp_path / "run"]) as reader:
        assert [(c.topic, t, bytes(raw)) for c, t, raw in reader.messages()] == [(t, s, d) for t, _, s, d in before]
    assert "complete" in recover(tmp_path / "run").stdout, "once is enough"


def recover(*arguments):
    from conftest import BINARY

    return subprocess.run([BINARY, "recover", *map(str, arguments)], capture_output=True, text=True, timeout=60)


def test_recover_refuses_what_is_no_bag(tmp_path):
    assert recover(tmp_path / "nothing").returncode == 2
    (tmp_path / "x.mcap").write_text("not a bag")
    result = recover(tmp_path / "x.mcap")
    assert result.returncode == 1 and "x.mcap" in result.stderr
    assert (tmp_path / "x.mcap").read_text() == "not a bag", "left alone"


def test_a_folder_with_something_in_it_is_refused(tmp_path):
    from conftest import BINARY

    (tmp_path / "mine").write_text("")
    result = subprocess.run([BINARY, "run", ARM, "--record", tmp_path], capture_output=True, text=True, timeout=60)
    assert result.returncode == 1 and "it is not empty" in result.stderr
    assert [p.name for p in tmp_path.iterdir()] == ["mine"]


def recorder(bench):
    """The service `record`: each order is given once, and by a client that has been answered before."""
    services = Services(bench)
    return lambda start, folder="": services(Record, start=start, folder=str(folder))


def test_the_service_records_while_the_node_runs(start, tmp_path):
    bench = start(urdf=switchable(tmp_path))
    record = recorder(bench)
    assert "nothing is recorded" in record(False).message
    seen = nanoseconds(bench.states[-1].header.stamp)
    answer = record(True, tmp_path / "run")
    assert answer.success and answer.folder == str(tmp_path / "run")
    again = record(True, tmp_path / "other")
    assert not again.success and "runs already" in again.message and not (tmp_path / "other").exists()
    move(bench)
    wait_until(lambda: bench.count("recording", "messages") not in (None, "0"), what="a report")
    answer = record(False)
    file = file_of(tmp_path / "run")
    assert answer.success and answer.message.startswith(f"recorded {sum(1 for _ in raw_messages(file))} messages")
    intervals = every_sample_is_there(file, ended_by_service=True)
    assert intervals[0] > 0 and nanoseconds(messages(file, "/joint_states")[0].header.stamp) >= seen
    assert {"/robot_description", "/tf_static"} <= {topic for topic, *_ in raw_messages(file)}, "what is latched comes along"
    assert [json.loads(e.data).get("from_start") for e in events(file, "start")] == [False]
    stamp = nanoseconds(bench.states[-1].header.stamp)
    wait_until(lambda: nanoseconds(bench.states[-1].header.stamp) > stamp, what="the node to go on")
    refused = record(True, tmp_path / "run")
    assert not refused.success and "it is not empty" in refused.message
    assert record(True, tmp_path / "second").success, "once more, into another folder"
    wait_until(lambda: bench.count("recording", "folder") == str(tmp_path / "second"), what="the second one")
    assert record(False).success and events(file_of(tmp_path / "second"), "start")


def test_a_disk_that_is_full_is_told_and_the_node_goes_on(tmp_path):
    """A limit on the size of files stands for it. SIGXFSZ must not end the process: Python ignores it, and so does its child."""
    import resource

    limit = lambda: resource.setrlimit(resource.RLIMIT_FSIZE, (2_000_000, 2_000_000))
    bench = Bench(options=["--record", tmp_path / "run"], preexec_fn=limit, restore_signals=False).wait_for_first_sample()
    try:
        wait_until(lambda: bench.logged("the recording has ended"), what="the warning")
        [warning] = bench.logged("the recording has ended")
        assert "File too large" in warning and "run_0.mcap" in warning
        wait_until(lambda: bench.diagnostics and "File too large" in level(bench, "recording")[1], what="the diagnostics")
        assert level(bench, "recording")[0] == b"\x02"
        stamp = nanoseconds(bench.states[-1].header.stamp)
        wait_until(lambda: nanoseconds(bench.states[-1].header.stamp) > stamp + 100_000_000, what="the node to go on")
        output = bench.simulator.stop()
        assert "then it ended: cannot write" in output
    finally:
        bench.close()
    every_sample_is_there(file_of(tmp_path / "run"))


def level(bench, part):
    """Level and message of a part in the latest diagnostics that have it."""
    found = [s for d in list(bench.diagnostics) for s in d.status if s.name.endswith(part)]
    return (found[-1].level, found[-1].message) if found else (None, "")


def test_without_a_recording_there_is_no_report(bench):
    wait_until(lambda: bench.diagnostics, what="diagnostics")
    assert not [s for s in bench.diagnostics[-1].status if s.name.endswith("recording")]
