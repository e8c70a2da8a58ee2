"""A long run with recording, watched by rclpy: does the clock drift, does memory grow, is anything lost?

benches/soak/run [--minutes 30] [--folder target/soak]   prints a report; exit code 1 if something is wrong.
"""

import argparse
import os
import random
import re
import shutil
import signal
import subprocess
import sys
import time
from pathlib import Path

os.environ["ROS_AUTOMATIC_DISCOVERY_RANGE"] = "LOCALHOST"
os.environ["ROS_DOMAIN_ID"] = str(random.randint(0, 101))

import rclpy
from rclpy.qos import QoSProfile, ReliabilityPolicy
from rosbags.rosbag2 import Reader
from rosbags.typesys import Stores, get_typestore
from sensor_msgs.msg import JointState

REPOSITORY = Path(__file__).resolve().parents[2]
INTERVAL = 1_000_000
"""ns."""
EVERY = 10.0
"""s between two looks at the memory."""
SETTLED = 60.0
"""s after which memory must not grow any more but for the index of the bag."""


def resident(pid):
    """MiB."""
    text = Path(f"/proc/{pid}/status").read_text()
    return int(re.search(r"VmRSS:\s+(\d+) kB", text)[1]) / 1024


class Watch:
    """Sees every state: gaps, and how simulated time goes beside the monotonic clock."""

    def __init__(self):
        rclpy.init()
        self.node = rclpy.create_node("soak")
        qos = QoSProfile(depth=5000, reliability=ReliabilityPolicy.RELIABLE)
        self.node.create_subscription(JointState, "joint_states", self.state, qos)
        self.count = self.gaps = 0
        self.last = None
        self.offsets = []

    def state(self, message):
        stamp = message.header.stamp.sec * 10**9 + message.header.stamp.nanosec
        self.count += 1
        self.gaps += self.last is not None and stamp - self.last != INTERVAL
        self.last = stamp
        self.offsets.append((stamp, time.monotonic_ns() - stamp))


def drift(offsets):
    """How far the smallest offset of the last minute is from that of the second minute, µs: transport only adds."""
    first = min(o for s, o in offsets if 60e9 <= s < 120e9)
    end = offsets[-1][0]
    last = min(o for s, o in offsets if s >= end - 60e9)
    return (last - first) * 1e-3


def growth(rows):
    """kiB/s, by least squares over what comes after it has settled."""
    rows = [(t, m) for t, m in rows if t >= SETTLED]
    n = len(rows)
    mt, mm = sum(t for t, _ in rows) / n, sum(m for _, m in rows) / n
    return 1024 * sum((t - mt) * (m - mm) for t, m in rows) / sum((t - mt) ** 2 for t, _ in rows)


def in_bag(folder):
    """Samples of joint_states in the bag, and how many are not one interval after the one before."""
    types = get_typestore(Stores.ROS2_JAZZY)
    count, gaps, last = 0, 0, None
    with Reader(folder) as reader:
        connections = [c for c in reader.connections if c.topic == "/joint_states"]
        for connection, _, raw in reader.messages(connections=connections):
            # Behind the encapsulation: sec, nanosec.
            stamp = int.from_bytes(raw[4:8], "little") * 10**9 + int.from_bytes(raw[8:12], "little")
            count += 1
            gaps += last is not None and stamp - last != INTERVAL
            last = stamp
    return count, gaps, last


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("--minutes", type=float, default=30.0)
    parser.add_argument("--folder", type=Path, default=REPOSITORY / "target/soak")
    parser.add_argument("--binary", type=Path, default=REPOSITORY / "target/release/realnoid")
    arguments = parser.parse_args()
    bag = arguments.folder / "bag"
    shutil.rmtree(arguments.folder, ignore_errors=True)
    arguments.folder.mkdir(parents=True)
    watch = Watch()
    node = subprocess.Popen([arguments.binary, "run", "--record", bag], stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
    start, memory, due = time.monotonic(), [], 0.0
    while (now := time.monotonic() - start) < arguments.minutes * 60 and node.poll() is None:
        rclpy.spin_once(watch.node, timeout_sec=0.05)
        if now >= due:
            memory.append((now, resident(node.pid)))
            due += EVERY
    node.send_signal(signal.SIGINT)
    output, errors = node.communicate(timeout=60)
    samples, bag_gaps, last = in_bag(bag)
    size = sum(f.stat().st_size for f in bag.iterdir())
    print(output[output.index("simulated") :] if "simulated" in output else output, errors, sep="")
    print(f"rclpy: {watch.count} states, {watch.gaps} gaps; clock against the monotonic clock: {drift(watch.offsets):+.1f} µs")
    print(f"bag: {samples} states, {bag_gaps} gaps, up to {last * 1e-9:.3f} s; {size / 2**20:.0f} MiB")
    print("resident memory [MiB]:", ", ".join(f"{t / 60:.0f} min {m:.1f}" for t, m in memory[:: max(1, len(memory) // 10)]))
    print(f"growth after {SETTLED:.0f} s: {growth(memory):.3f} kiB/s")
    wrong = node.returncode or watch.gaps or bag_gaps
    sys.exit(1 if wrong else 0)


if __name__ == "__main__":
    main()
