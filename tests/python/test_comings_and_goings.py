"""Nodes and clients that come, go, and stop for a while: nobody else loses anything."""

import os
import re
import signal
import subprocess
import sys
import time
from pathlib import Path

import pytest
from conftest import LATCHED, Probe, Simulator, nanoseconds, wait_until
from sensor_msgs.msg import JointState
from std_msgs.msg import String

pytestmark = pytest.mark.alone

INTERVAL = 1_000_000
"""ns."""

LISTENER = """
import rclpy, sys
from rclpy.qos import QoSProfile, ReliabilityPolicy
from sensor_msgs.msg import JointState
rclpy.init()
node = rclpy.create_node("listener")
last = [0]
def heard(state):
    now = state.header.stamp.sec
    if now != last[0]:
        last[0] = now
        print(now, flush=True)
node.create_subscription(JointState, "joint_states", heard, QoSProfile(depth=10, reliability=ReliabilityPolicy.RELIABLE))
rclpy.spin(node)
"""


def stamps(states):
    return [nanoseconds(s.header.stamp) for s in states]


def resident(pid):
    """MiB."""
    return int(re.search(r"VmRSS:\s+(\d+) kB", Path(f"/proc/{pid}/status").read_text())[1]) / 1024


def test_a_node_that_is_restarted_is_heard_by_a_client_that_was_there_before(bench):
    wait_until(lambda: len(bench.states) > 500, what="states")
    bench.simulator.stop()
    bench.settled()
    description = bench.probe.listen(String, "robot_description", LATCHED)
    before, began = len(bench.states), time.monotonic()
    bench.simulator = Simulator(domain=bench.domain)
    wait_until(lambda: len(bench.states) > before, what="the second node")
    assert stamps(bench.states[before:])[0] < (time.monotonic() - began) * 1e9, "its time began anew"
    wait_until(lambda: len(bench.states) > before + 500, what="states of the second node")
    new = stamps(bench.states[before:])
    assert all(b - a == INTERVAL for a, b in zip(new, new[1:])), "nothing is lost between its first state and the last"
    wait_until(lambda: description, what="its description")
    publisher = bench.probe.publisher(JointState, "joint_command")
    publisher.publish(JointState(name=["hip"], position=[0.3]))
    wait_until(lambda: abs(bench.axis("hip")[0] - 0.3) < 0.01, what="the hip, by a client of both nodes")


def test_clients_come_and_go_while_the_node_lives(bench):
    wait_until(lambda: len(bench.states) > 100, what="states")
    for target in (0.1, 0.2, 0.3):
        other = Probe(bench.domain)
        try:
            states = other.listen(JointState, "joint_states")
            other.publisher(JointState, "joint_command").publish(JointState(name=["hip"], position=[target]))
            wait_until(lambda: states and abs(states[-1].position[0] - target) < 0.01, what="the hip, seen by a new client")
            seen = stamps(states)
            assert all(b - a == INTERVAL for a, b in zip(seen, seen[1:]))
        finally:
            other.close()
    seen = stamps(bench.states)
    assert all(b - a == INTERVAL for a, b in zip(seen, seen[1:])), "the client that stays loses nothing"


def test_a_subscriber_that_stands_still_costs_the_others_nothing(start):
    bench = start(urdf=None)
    environment = {**os.environ, "ROS_DOMAIN_ID": str(bench.domain)}
    listener = subprocess.Popen([sys.executable, "-c", LISTENER], env=environment, stdout=subprocess.PIPE, text=True)
    try:
        assert listener.stdout.readline(), "it listens"
        # The history of every topic (1000 deep) fills up first.
        wait_until(lambda: stamps(bench.states[-1:])[0] > 4 * 10**9, what="four seconds")
        before, pid = len(bench.states), bench.simulator.process.pid
        memory = resident(pid)
        listener.send_signal(signal.SIGSTOP)
        stopped = time.monotonic()
        wait_until(lambda: time.monotonic() - stopped > 5.0, timeout=10, what="five seconds")
        # 5000 states of 1.7 kB are kept for it, 8.5 MB, and let go when it has read them; more if it was more than five seconds.
        assert resident(pid) - memory < 3.5 + 1.7e-3 * max(len(bench.states) - before, 5000), "nothing but what it has not read is kept"
        listener.send_signal(signal.SIGCONT)
        resumed = stamps(bench.states[-1:])[0] // 10**9
        wait_until(lambda: int(listener.stdout.readline()) >= resumed, what="it hears again")
        seen = stamps(bench.states[before:])
        assert len(seen) > 4500 and all(b - a == INTERVAL for a, b in zip(seen, seen[1:])), "nobody else loses a state"
        assert bench.count("real time", "deadline set anew") == "0" and bench.count("real time", "dropped snapshots") == "0"
    finally:
        listener.kill()
        listener.communicate()
