"""Starts the node as a user would, and talks to it with real rclpy."""

import os

# Read when an rclpy context is made, and handed on to the node under test.
os.environ["ROS_AUTOMATIC_DISCOVERY_RANGE"] = "LOCALHOST"
os.environ.pop("ROS_LOCALHOST_ONLY", None)

import contextlib
import fcntl
import functools
import itertools
import random
import signal
import subprocess
import tempfile
import threading
import time
from pathlib import Path

import pytest
import rclpy
from diagnostic_msgs.msg import DiagnosticArray
from rcl_interfaces.msg import Log
from rclpy.executors import ExternalShutdownException, SingleThreadedExecutor
from rclpy.parameter import Parameter
from rclpy.parameter_client import AsyncParameterClient
from rclpy.qos import DurabilityPolicy, QoSProfile, ReliabilityPolicy
from sensor_msgs.msg import JointState

HERE = Path(__file__).parent
BINARY = Path(os.environ.get("REALNOID_BIN", HERE / "../../target/release/realnoid")).resolve()
ARM = HERE / "arm.urdf"

STREAM = QoSProfile(depth=20000, reliability=ReliabilityPolicy.RELIABLE)
LATCHED = QoSProfile(depth=1, reliability=ReliabilityPolicy.RELIABLE, durability=DurabilityPolicy.TRANSIENT_LOCAL)
ROSOUT = QoSProfile(depth=1000, reliability=ReliabilityPolicy.RELIABLE, durability=DurabilityPolicy.TRANSIENT_LOCAL)


def pytest_configure(config):
    config.addinivalue_line("markers", "alone: keeps real time, or loses nothing: not beside other tests on two cores")


DOMAINS = range(102)
"""Those that every DDS can use on Linux."""


def _claim(wanted):
    """Domains that no other run of these tests on this machine uses: each has a file that is locked until this process ends."""
    folder = Path(tempfile.gettempdir()) / f"realnoid-domains-{os.getuid()}"
    folder.mkdir(exist_ok=True)
    claimed = []
    for domain in random.sample(DOMAINS, len(DOMAINS)):
        file = open(folder / str(domain), "w")
        try:
            fcntl.flock(file, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except OSError:
            file.close()
            continue
        claimed.append((domain, file))
        if len(claimed) == wanted:
            break
    assert claimed, "all ROS domains are in use by other tests"
    return itertools.cycle(claimed)


@functools.cache
def _domains():
    # Enough that one that a killed node was in is not used again before others have forgotten it; few enough for six processes.
    return _claim(16)


def free_domain():
    """A ROS domain in which nothing else is."""
    return next(_domains())[0]


def nanoseconds(stamp):
    return stamp.sec * 10**9 + stamp.nanosec


def wait_until(condition, timeout=30.0, what="the condition"):
    """Polls until `condition()` is truthy, and returns it. What is over when the machine has been busy for a few seconds (a speed, a
    torque on the way) is looked for in all the messages, not in the latest one alone."""
    deadline = time.monotonic() + timeout
    while True:
        # Looked at once more after the deadline: this thread may have been held up since the last time.
        began = time.monotonic()
        late = began >= deadline
        result = condition()
        if result:
            return result
        if late:
            raise AssertionError(f"waited {timeout} s in vain for {what}")
        # A condition that looks through thousands of messages leaves the interpreter to the thread that listens, for most of the time.
        time.sleep(max(0.005, min(4 * (time.monotonic() - began), 0.5)))


def until_heard(publish, heard, what):
    """Publishes again every half second until `heard()`: what is published before both sides have found each other comes late."""
    for _ in range(40):
        publish()
        try:
            return wait_until(heard, timeout=0.5, what=what)
        except AssertionError:
            continue
    raise AssertionError(f"waited in vain for {what}")


class Simulator:
    """The running binary."""

    def __init__(self, *arguments, domain, urdf=ARM, environment=None, options=(), **process):
        """`arguments` are ROS's, `options` our own; `process` goes to Popen."""
        command = [str(BINARY), "run"] + ([str(urdf)] if urdf else []) + [str(o) for o in options]
        ros = ["--ros-args", *map(str, arguments)] if arguments else []
        variables = {**os.environ, "ROS_DOMAIN_ID": str(domain), **(environment or {})}
        self.process = subprocess.Popen(
            command + ros, env=variables, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True, **process
        )
        self.output = self.errors = ""

    def stop(self, by=signal.SIGINT):
        """Ends the node and insists on a clean exit."""
        if self.process.poll() is None:
            self.process.send_signal(by)
        self.output, self.errors = self.process.communicate(timeout=30)
        assert self.process.returncode == 0, f"exit code {self.process.returncode}: {self.errors}"
        return self.output


class Probe:
    """An rclpy node that listens in a thread of its own."""

    def __init__(self, domain):
        self.context = rclpy.Context()
        rclpy.init(context=self.context, domain_id=domain)
        self.node = rclpy.create_node("probe", context=self.context)
        self.executor = SingleThreadedExecutor(context=self.context)
        self.executor.add_node(self.node)
        self.closing = rclpy.Future()
        self.answered = set()
        self.thread = threading.Thread(target=self._spin, daemon=True)
        self.thread.start()

    def _spin(self):
        try:
            self.executor.spin_until_future_complete(self.closing)
        except ExternalShutdownException:
            pass

    def listen(self, kind, topic, qos=STREAM):
        """The list into which the messages come."""
        messages = []
        self.node.create_subscription(kind, topic, messages.append, qos)
        self.executor.wake()
        return messages

    def publisher(self, kind, topic):
        """A publisher that the simulator already listens to."""
        publisher = self.node.create_publisher(kind, topic, 100)
        wait_until(lambda: publisher.get_subscription_count() > 0, what=f"a subscriber of {topic}")
        return publisher

    def call(self, start, timeout=30.0, twice=True):
        """The result of a service call; `start` is tried `twice`, because one of a hundred first calls of a client gets lost."""
        first = start()
        if twice:
            try:
                wait_until(first.done, timeout=5.0, what="a service")
            except AssertionError:
                second = start()
                wait_until(lambda: first.done() or second.done(), timeout=timeout, what="a service")
                return (first if first.done() else second).result()
        else:
            wait_until(first.done, timeout=timeout, what="a service")
        return first.result()

    def parameters(self, node="forward_dynamics"):
        client = AsyncParameterClient(self.node, node)
        assert client.wait_for_services(30.0)
        return client

    def set(self, client, **values):
        """Sets them one after the other, once: the call that may get lost sets nothing."""
        if client not in self.answered:
            self.call(lambda: client.set_parameters([]))
            self.answered.add(client)
        parameters = [Parameter(name, value=value) for name, value in values.items()]
        return self.call(lambda: client.set_parameters(parameters), twice=False).results

    def get(self, client, name):
        value = self.call(lambda: client.get_parameters([name])).values[0]
        return rclpy.parameter.parameter_value_to_python(value)

    def close(self):
        # The thread ends by itself first: an executor that is shut down destroys what its thread still waits for.
        self.closing.set_result(None)
        self.thread.join(30)
        self.executor.shutdown()
        self.node.destroy_node()
        rclpy.shutdown(context=self.context)


class Bench:
    """A simulator and a probe in a domain of their own, with the streams that most tests look at."""

    def __init__(self, *arguments, topic="joint_states", **options):
        self.domain = free_domain()
        self.probe = Probe(self.domain)
        self.states = self.probe.listen(JointState, topic)
        self.diagnostics = self.probe.listen(DiagnosticArray, "/diagnostics")
        self.log = self.probe.listen(Log, "/rosout", ROSOUT)
        self.simulator = Simulator(*arguments, domain=self.domain, **options)

    def wait_for_first_sample(self):
        done = lambda: self.states or self.simulator.process.poll() is not None
        wait_until(done, what="the first JointState")
        assert self.states, self.simulator.process.communicate()[1]
        return self

    def axis(self, name):
        """Latest (position, velocity, effort) of an axis."""
        state = self.states[-1]
        i = state.name.index(name)
        return state.position[i], state.velocity[i], state.effort[i]

    def count(self, part, key):
        """A figure of the latest diagnostics, as text; None before the first."""
        if not self.diagnostics:
            return None
        for status in self.diagnostics[-1].status:
            if status.name.endswith(part):
                return {v.key: v.value for v in status.values}[key]
        raise KeyError(part)

    def settled(self):
        """Waits until no more states come: the node has ended, or the probe has got through what had piled up."""
        def unchanged():
            seen = len(self.states)
            time.sleep(0.5)
            return len(self.states) == seen

        wait_until(unchanged, what="the last state")

    def stands(self):
        """The time of a world that stands, ns: what was published before it stood has been heard."""
        latest = lambda: {nanoseconds(s.header.stamp) for s in self.states[-5:]}
        wait_until(lambda: len(self.states) >= 5 and len(latest()) == 1, what="repeated states")
        return latest().pop()

    def logged(self, text):
        return [m.msg for m in self.log if m.name.endswith("forward_dynamics") and text in m.msg]

    def close(self):
        try:
            return self.simulator.stop()
        finally:
            self.simulator.process.kill()
            self.probe.close()


@pytest.fixture
def start():
    """Starts benches; each is stopped by SIGINT at the end, and must exit with 0."""
    with contextlib.ExitStack() as benches:

        def starter(*arguments, **options):
            bench = Bench(*arguments, **options)
            benches.callback(bench.close)
            return bench.wait_for_first_sample()

        yield starter


@pytest.fixture
def bench(start):
    """The arm with default parameters."""
    return start()
