"""Bags of `simulate --out FILE.mcap`, read by two independent readers and by rclpy's own deserialisation."""

import json
import signal
import struct
import subprocess
import sys
from pathlib import Path

import pytest
import yaml
from conftest import ARM, BINARY, nanoseconds, wait_until
from mcap.reader import make_reader
from mcap_ros2.decoder import DecoderFactory
from nav_msgs.msg import Odometry
from rclpy.serialization import deserialize_message, serialize_message
from rosbags.highlevel import AnyReader
from rosbags.typesys import Stores, get_types_from_msg, get_typestore
from rosgraph_msgs.msg import Clock
from sensor_msgs.msg import JointState
from simulation import ORIGIN, columns, refused, run, simulate

ROS_TYPES = {"/clock": Clock, "/joint_states": JointState, "/odom": Odometry}
STEP_NS = 5_000_000
ROWS = 61
LIVELY = [
    "--duration", 0.3, "--every", 0.005, "--effort", "left_elbow=1.5", "--servo", "right_knee=0.7",
    "--set", "waist_yaw=0.1,2", "--set", "left_hip_yaw=0.2,-1",
]  # fmt: skip
FLYING = ["--base", "free", "--base-pose", "0.1,-0.2,3,0.6,0,0.8,0", "--base-twist", "1,-2,0.5,0.3,0.2,-0.1"]


class Recording:
    """The same run as a table and as a bag in a folder of its own."""

    def __init__(self, folder, *arguments):
        self.bag = folder / "run" / "humanoid.mcap"
        self.summary = simulate(ORIGIN, *LIVELY, *arguments, "--out", self.bag)
        simulate(ORIGIN, *LIVELY, *arguments, "--out", folder / "rows.csv")
        self.table = columns(folder / "rows.csv")
        self.axes = [c.removesuffix(".position") for c in self.table if c.endswith(".position")]


@pytest.fixture(scope="module")
def free(tmp_path_factory):
    return Recording(tmp_path_factory.mktemp("free"), *FLYING)


@pytest.fixture(scope="module")
def fixed(tmp_path_factory):
    return Recording(tmp_path_factory.mktemp("fixed"))


def by_rosbags(recording):
    """Topic -> (log time, message), decoded by the definitions in the file alone."""
    found = {}
    with AnyReader([recording.bag.parent], default_typestore=None) as reader:
        for connection, stamp, raw in reader.messages():
            found.setdefault(connection.topic, []).append((stamp, reader.deserialize(raw, connection.msgtype)))
    return found


def by_mcap_ros2(recording):
    found = {}
    with open(recording.bag, "rb") as file:
        reader = make_reader(file, decoder_factories=[DecoderFactory()])
        for _, channel, message, decoded in reader.iter_decoded_messages():
            found.setdefault(channel.topic, []).append((message.log_time, decoded))
    return found


def raw_messages(path):
    """(topic, type, log time, publish time, sequence, bytes) of each message; insists on whole checksums."""
    with open(path, "rb") as file:
        for schema, channel, m in make_reader(file, validate_crcs=True).iter_messages():
            yield channel.topic, schema.name, m.log_time, m.publish_time, m.sequence, m.data


def by_rclpy(recording):
    found = {}
    for topic, _, log_time, _, _, data in raw_messages(recording.bag):
        found.setdefault(topic, []).append((log_time, deserialize_message(data, ROS_TYPES[topic])))
    return found


READERS = pytest.mark.parametrize("read", [by_rosbags, by_mcap_ros2, by_rclpy])


def bits(values):
    return struct.pack(f"<{len(values)}d", *values)


def same_bits(values, column):
    """Also tells 0 from -0."""
    assert bits(values) == bits(column)


@READERS
@pytest.mark.parametrize("which", ["free", "fixed"])
def test_joint_states_are_the_table_bit_for_bit(read, which, request):
    recording = request.getfixturevalue(which)
    messages = [m for _, m in read(recording)["/joint_states"]]
    assert len(messages) == ROWS and len(recording.axes) >= 30
    assert all(list(m.name) == recording.axes for m in messages)
    for i, axis in enumerate(recording.axes):
        for part in ("position", "velocity", "effort"):
            same_bits([getattr(m, part)[i] for m in messages], recording.table[f"{axis}.{part}"])
    elbow = recording.axes.index("left_elbow")
    assert messages[-1].effort[elbow] == 1.5, "the run under test really has efforts"
    assert messages[-1].position[elbow] != messages[0].position[elbow], "and really moves"


@READERS
def test_odometry_is_the_table_bit_for_bit(read, free):
    messages = [m for _, m in read(free)["/odom"]]
    assert len(messages) == ROWS
    for m in messages:
        assert (m.header.frame_id, m.child_frame_id) == ("world", "base_link")
        assert not any(m.pose.covariance) and not any(m.twist.covariance), "a simulated state is exact"
        assert len(m.pose.covariance) == 36
    parts = {f"base.{k}": lambda m, k=k: getattr(m.pose.pose.position, k) for k in "xyz"}
    parts |= {f"base.q{k}": lambda m, k=k: getattr(m.pose.pose.orientation, k) for k in "xyzw"}
    parts |= {f"base.w{k}": lambda m, k=k: getattr(m.twist.twist.angular, k) for k in "xyz"}
    parts |= {f"base.v{k}": lambda m, k=k: getattr(m.twist.twist.linear, k) for k in "xyz"}
    for column, part in parts.items():
        same_bits([part(m) for m in messages], free.table[column])


@READERS
def test_stamps_are_exactly_one_interval_apart(read, free):
    found = read(free)
    expected = [k * STEP_NS for k in range(ROWS)]
    assert [t * 1e-9 for t in expected] == free.table["time"]
    stamps = {"/clock": lambda m: m.clock, "/joint_states": lambda m: m.header.stamp, "/odom": lambda m: m.header.stamp}
    assert set(found) == set(stamps)
    for topic, stamp in stamps.items():
        assert [nanoseconds(stamp(m)) for _, m in found[topic]] == expected, topic
        assert [t for t, _ in found[topic]] == expected, f"{topic}: log time"


def test_a_fixed_base_has_no_odometry(fixed):
    assert set(by_rclpy(fixed)) == {"/clock", "/joint_states"}


def test_rclpy_reads_the_raw_bytes_to_their_end(free):
    """Lengths are compared, not bytes: Fast CDR leaves its padding uninitialised."""
    for topic, _, log_time, publish_time, _, data in raw_messages(free.bag):
        message = deserialize_message(data, ROS_TYPES[topic])
        assert len(serialize_message(message)) == len(data), topic
        assert publish_time == log_time


def test_definitions_and_hashes_are_those_of_jazzy(free):
    jazzy = get_typestore(Stores.ROS2_JAZZY)
    with open(free.bag, "rb") as file:
        reader = make_reader(file, validate_crcs=True)
        summary = reader.get_summary()
        assert reader.get_header().profile == "ros2"
    for channel in summary.channels.values():
        schema = summary.schemas[channel.schema_id]
        package, _, name = schema.name.split("/")
        own = get_typestore(Stores.EMPTY)
        own.register(get_types_from_msg(schema.data.decode(), schema.name))
        assert (schema.encoding, channel.message_encoding) == ("ros2msg", "cdr")
        assert channel.metadata["topic_type_hash"] == own.hash_rihs01(schema.name) == jazzy.hash_rihs01(schema.name)
        published = json.loads((Path(sys.prefix) / "share" / package / "msg" / f"{name}.json").read_text())
        hashes = {h["type_name"]: h["hash_string"] for h in published["type_hashes"]}
        assert channel.metadata["topic_type_hash"] == hashes[schema.name]


def test_the_file_is_complete(free):
    data = free.bag.read_bytes()
    assert data.startswith(b"\x89MCAP0\r\n") and data.endswith(b"\x89MCAP0\r\n")
    with open(free.bag, "rb") as file:
        summary = make_reader(file, validate_crcs=True).get_summary()
    assert summary.statistics.message_count == 3 * ROWS
    assert summary.chunk_indexes and all(not c.compression for c in summary.chunk_indexes)
    counts = {summary.channels[k].topic: n for k, n in summary.statistics.channel_message_counts.items()}
    assert counts == dict.fromkeys(ROS_TYPES, ROWS)
    sequences = {}
    for topic, *_, sequence, _ in raw_messages(free.bag):
        sequences.setdefault(topic, []).append(sequence)
    assert sequences == dict.fromkeys(ROS_TYPES, list(range(ROWS)))


def test_the_folder_is_a_rosbag2_bag(free):
    document = yaml.safe_load((free.bag.parent / "metadata.yaml").read_text())["rosbag2_bagfile_information"]
    duration = {"nanoseconds": (ROWS - 1) * STEP_NS}
    assert (document["version"], document["storage_identifier"]) == (9, "mcap")
    assert document["relative_file_paths"] == [free.bag.name]
    assert (document["message_count"], document["duration"]) == (3 * ROWS, duration)
    assert document["files"][0]["duration"] == duration
    with AnyReader([free.bag.parent]) as reader:
        assert (reader.message_count, reader.start_time) == (3 * ROWS, 0)
        for connection in reader.connections:
            assert connection.ext.offered_qos_profiles[0].reliability.name == "RELIABLE"
    assert free.summary["output"] == [str(free.bag), str(free.bag.parent / "metadata.yaml")]


def test_rosbags_converts_it_to_sqlite3(free, tmp_path):
    copy = tmp_path / "copy"
    command = [Path(sys.executable).parent / "rosbags-convert", "--src", free.bag.parent, "--dst", copy]
    subprocess.run([*command, "--dst-storage", "sqlite3"], check=True, capture_output=True)
    with AnyReader([copy]) as reader:
        assert reader.message_count == 3 * ROWS


def test_metadata_goes_only_into_a_folder_of_the_bags_own(tmp_path):
    short = [ARM, "--duration", 0.01]
    metadata = tmp_path / "metadata.yaml"
    simulate(*short, "--out", tmp_path / "a.mcap")
    assert metadata.exists(), "an empty folder"
    (tmp_path / "notes.txt").write_text("mine")
    simulate(ARM, "--duration", 0.02, "--out", tmp_path / "a.mcap")
    with AnyReader([tmp_path]) as reader:
        assert reader.message_count == 2 * 21, "the same bag once more: its metadata is renewed"
    before = metadata.read_text()
    files = simulate(*short, "--out", tmp_path / "b.mcap")["output"]
    assert (files, metadata.read_text()) == ([str(tmp_path / "b.mcap")], before), "a second file stands for itself"
    metadata.write_text("rosbag2_bagfile_information:\n  relative_file_paths: [a.mcap, a_1.mcap]\n")
    bag = (tmp_path / "a.mcap").read_bytes()
    message = refused(*short, "--out", tmp_path / "a.mcap", code=1)
    assert "a.mcap is one of several files of the bag" in message
    assert (tmp_path / "a.mcap").read_bytes() == bag, "and nothing was touched"


def test_a_run_that_diverges_leaves_a_complete_bag(tmp_path):
    bag = tmp_path / "run" / "wild.mcap"
    summary = simulate(ORIGIN, "--duration", 0.02, "--set", "left_hip_yaw=0,1e200", "--out", bag, code=1)
    assert summary["finite"] is False and "not finite" in " ".join(summary["warnings"])
    assert len(list(raw_messages(bag))) == 2 * 21
    with AnyReader([bag.parent]) as reader:
        assert reader.message_count == 2 * 21


@pytest.mark.parametrize("by", [signal.SIGINT, signal.SIGTERM])
def test_a_run_that_is_stopped_leaves_a_complete_bag(tmp_path, by):
    bag = tmp_path / "run" / "long.mcap"
    command = [str(BINARY), "simulate", str(ARM), "--duration", "1e6", "--out", str(bag)]
    process = subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
    try:
        wait_until(lambda: bag.exists() and bag.stat().st_size > 1_000_000, what="the first megabyte")
        process.send_signal(by)
        output, _ = process.communicate(timeout=30)
    finally:
        process.kill()
    summary = json.loads(output)
    assert process.returncode == 1 and summary["stopped"] is True and "stopped by a signal" in " ".join(summary["warnings"])
    with AnyReader([bag.parent]) as reader:
        assert reader.message_count == 2 * summary["rows"] > 2000


def test_one_row_is_a_bag_too(tmp_path):
    bag = tmp_path / "run" / "instant.mcap"
    simulate(ARM, "--duration", 0, "--out", bag)
    with AnyReader([bag.parent]) as reader:
        assert (reader.message_count, reader.duration) == (2, 1)


@pytest.mark.parametrize("ending", ["csv", "mcap"])
def test_io_errors_name_the_file_and_the_cause(tmp_path, ending):
    full = tmp_path / f"full.{ending}"
    full.symlink_to("/dev/full")
    for duration in (0.01, 5):
        assert f"cannot write '{full}': No space left on device" in refused(ARM, "--duration", duration, "--out", full, code=1)
    folder = tmp_path / f"folder.{ending}"
    folder.mkdir()
    assert f"cannot write '{folder}': Is a directory" in refused(ARM, "--duration", 0.01, "--out", folder, code=1)
    deep = tmp_path / "no" / "such" / f"run.{ending}"
    assert f"cannot write '{deep.parent}': No such file" in refused(ARM, "--duration", 0.01, "--out", deep, code=1)


def test_other_endings_are_refused_before_anything_runs(tmp_path):
    for name in ("run.txt", "run", ".mcap"):
        message = refused(ARM, "--duration", 1e6, "--out", tmp_path / name)
        assert f"--out {tmp_path / name}: must end in .csv or .mcap" in message
    assert not list(tmp_path.iterdir())


def test_the_same_run_twice_gives_the_same_bytes(tmp_path):
    for name in "ab":
        assert run(ORIGIN, *LIVELY, *FLYING, "--out", tmp_path / name / "run.mcap").returncode == 0
    assert (tmp_path / "a" / "run.mcap").read_bytes() == (tmp_path / "b" / "run.mcap").read_bytes()
