"""Names, domains, signals and wrong arguments."""

import os
import signal
import subprocess

import pytest
from conftest import ARM, BINARY, LATCHED, Probe, Simulator, free_domain, wait_until
from geometry_msgs.msg import TwistStamped
from rosgraph_msgs.msg import Clock
from sensor_msgs.msg import JointState
from std_msgs.msg import Float64MultiArray, String


def wait_for_node(probe, name, namespace):
    wait_until(lambda: (name, namespace) in probe.node.get_node_names_and_namespaces(), what=f"node {name}")


def test_a_namespace_moves_all_but_what_ros_has_absolute(start):
    bench = start("-r", "__ns:=/bench", topic="/bench/joint_states")
    probe = bench.probe
    wait_for_node(probe, "forward_dynamics", "/bench")
    for kind, topic in [(TwistStamped, "/bench/twist/thigh"), (Clock, "/clock")]:
        messages = probe.listen(kind, topic)
        wait_until(lambda: messages, what=topic)
    texts = probe.listen(String, "/bench/robot_description", LATCHED)
    wait_until(lambda: texts, what="robot_description")
    names = lambda: {name for name, _ in probe.node.get_topic_names_and_types()}
    wanted = {"/tf", "/tf_static", "/rosout", "/diagnostics", "/bench/effort_command"}
    wait_until(lambda: wanted <= names(), what="all topics to be found")
    assert not {"/joint_states", "/effort_command", "/bench/clock", "/bench/tf"} & names()
    assert probe.get(probe.parameters("/bench/forward_dynamics"), "engine") == "rbx"


def test_node_and_topic_remaps(start):
    bench = start("-r", "__node:=stand_in", "-r", "joint_states:=robot/joints", topic="robot/joints")
    wait_for_node(bench.probe, "stand_in", "/")
    wait_until(lambda: "/robot/joints" in dict(bench.probe.node.get_topic_names_and_types()), what="the topic to be found")
    assert bench.probe.node.count_publishers("/joint_states") == 0
    assert bench.probe.get(bench.probe.parameters("stand_in"), "engine") == "rbx"


def test_sigterm_ends_cleanly_and_the_summary_is_printed(start):
    bench = start()
    output = bench.simulator.stop(by=signal.SIGTERM)
    assert "real-time factor" in output and "lateness" in output
    assert "ERROR" not in bench.simulator.errors, "harmless errors of the DDS library are not shown"


def test_what_is_simulated_is_printed_at_start(start):
    output = start().simulator.stop()
    for text in ["'arm'", str(ARM), "3 axes", "2.500 kg", "base fixed", "discovery range localhost", "-> /joint_states"]:
        assert text in output, text


def test_domains_are_apart(start):
    bench = start()
    other = Probe(free_domain())
    try:
        states = other.listen(JointState, "joint_states")
        here = len(bench.states)
        wait_until(lambda: len(bench.states) > here + 1500, what="states in the node's own domain")
        assert not states
    finally:
        other.close()


def test_discovery_range_off_hides_the_node():
    domain = free_domain()
    simulator = Simulator(domain=domain, environment={"ROS_AUTOMATIC_DISCOVERY_RANGE": "OFF"})
    probe = Probe(domain)
    try:
        states = probe.listen(JointState, "joint_states")
        # It runs, and can be told to stop, when it has said what it does.
        assert any("discovery range off" in line for line in simulator.process.stdout)
        with pytest.raises(AssertionError):
            wait_until(lambda: states, timeout=2.5)
        simulator.stop()
    finally:
        simulator.process.kill()
        probe.close()


@pytest.mark.parametrize(
    "variables, arguments, message",
    [
        ({"ROS_DOMAIN_ID": "300"}, [], "ROS_DOMAIN_ID='300' is not a whole number from 0 to 232"),
        ({"ROS_AUTOMATIC_DISCOVERY_RANGE": "MOON"}, [], "ROS_AUTOMATIC_DISCOVERY_RANGE='MOON'"),
        ({}, ["-p", "speed:=1"], "-p speed:=1: there is no parameter 'speed'"),
        ({}, ["-p", "steps_per_interval:=0"], "out of range: 1 … 1000"),
        ({}, ["-p", "steps_per_interval"], "expected name:=value"),
        ({}, ["--params-file", "/nowhere.yaml"], "cannot read /nowhere.yaml"),
        ({}, ["-r", "__ns:=bench"], "must start with /"),
        ({}, ["-r", "__node:=2nd"], "is no ROS name"),
        ({}, ["--log-level", "loud"], "expected debug, info, warn, error or fatal"),
        ({}, ["--what"], "unknown ROS argument '--what'"),
    ],
)
def test_wrong_arguments_are_told_and_end_with_2(variables, arguments, message):
    environment = {**os.environ, "ROS_DOMAIN_ID": "0", **variables}
    command = [BINARY, "run", ARM, "--ros-args", *arguments]
    result = subprocess.run(command, env=environment, capture_output=True, text=True, timeout=60)
    assert result.returncode == 2, result.stderr
    assert message in result.stderr


def test_a_reader_that_goes_away_does_not_stop_the_node(start):
    bench = start()
    bench.simulator.process.stdout.close()
    bench.simulator.process.stderr.close()
    # A refused command is logged to the closed standard error.
    publisher = bench.probe.publisher(Float64MultiArray, "effort_command")
    publisher.publish(Float64MultiArray(data=[1.0]))
    wait_until(lambda: bench.logged("wrong size"), what="the log on /rosout")
    seen = len(bench.states)
    wait_until(lambda: len(bench.states) > seen + 500, what="500 more states")
    bench.simulator.process.send_signal(signal.SIGINT)
    assert bench.simulator.process.wait(30) == 0
