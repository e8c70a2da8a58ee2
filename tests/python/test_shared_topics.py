"""A simulation must never be taken for the robot: who else publishes our topics."""

import signal

import pytest
from conftest import LATCHED, Probe, Simulator, free_domain, wait_until
from rosgraph_msgs.msg import Clock
from sensor_msgs.msg import JointState
from std_msgs.msg import String


@pytest.fixture
def probe():
    domain = free_domain()
    probe = Probe(domain)
    probe.domain = domain
    yield probe
    probe.close()


@pytest.fixture
def simulators():
    started = []
    yield started
    for simulator in started:
        simulator.stop()


def refused(domain, *arguments):
    """What the node says when it does not start."""
    simulator = Simulator(*arguments, domain=domain)
    output, errors = simulator.process.communicate(timeout=30)
    assert simulator.process.returncode == 1, errors
    assert not output, "it did not start"
    return errors


def runs(probe, simulators, *arguments, topic="joint_states"):
    states = probe.listen(JointState, topic)
    simulators.append(Simulator(*arguments, domain=probe.domain))
    wait_until(lambda: states or simulators[-1].process.poll() is not None, what="the first state")
    assert states, simulators[-1].process.communicate()[1]
    return simulators[-1]


def topics(bench):
    """Level and values of the latest diagnostics of topics."""
    for status in bench.diagnostics[-1].status if bench.diagnostics else ():
        if status.name.endswith("topics"):
            return int.from_bytes(status.level), {v.key: v.value for v in status.values}
    return None


def test_the_node_does_not_start_where_somebody_publishes_joint_states(probe):
    probe.node.create_publisher(JointState, "joint_states", 10)
    errors = refused(probe.domain)
    assert "/joint_states is published by /probe already" in errors
    assert "allow_shared_topics" in errors and "ROS_DOMAIN_ID" in errors


def test_nor_where_another_simulation_does(probe, simulators):
    runs(probe, simulators)
    assert "published by /forward_dynamics already" in refused(probe.domain)


def test_it_starts_where_that_is_allowed(start):
    bench = start("-p", "allow_shared_topics:=true")
    bench.probe.node.create_publisher(JointState, "joint_states", 10)
    other = Simulator("-p", "allow_shared_topics:=true", "-r", "__node:=other", domain=bench.domain)
    wait_until(lambda: any(d.status[0].name.startswith("/other") for d in bench.diagnostics), what="the other one")
    assert all(status.level == b"\0" for d in bench.diagnostics for status in d.status if status.name.endswith("topics"))
    other.stop()


def test_a_description_and_a_clock_of_others_do_not_keep_it_from_starting(probe, simulators):
    probe.node.create_publisher(String, "robot_description", LATCHED)
    probe.node.create_publisher(Clock, "/clock", 10)
    runs(probe, simulators)


def test_two_namespaces_live_in_one_domain_and_are_told_of_the_clock(start):
    left = start("-r", "__ns:=/left", topic="/left/joint_states")
    right = Simulator("-r", "__ns:=/right", domain=left.domain)
    states = left.probe.listen(JointState, "/right/joint_states")
    wait_until(lambda: states, what="the other one")
    for own, other in (("left", "right"), ("right", "left")):
        told = lambda: [
            {v.key: v.value for v in s.values}
            for d in left.diagnostics
            for s in d.status
            if s.name == f"/{own}/forward_dynamics: topics" and s.level == b"\x01"
        ]
        wait_until(told, what="the warning")
        assert told()[-1] == {"/clock": f"/{other}/forward_dynamics"}, "nothing else is shared"
    right.stop()


def test_if_it_happens_later_it_is_said_with_the_name(bench):
    wait_until(lambda: topics(bench) == (0, {}), what="diagnostics")
    publisher = bench.probe.node.create_publisher(JointState, "joint_states", 10)
    wait_until(lambda: topics(bench) == (1, {"/joint_states": "/probe"}), what="the warning")
    wait_until(lambda: bench.logged("/probe publishes /joint_states"), what="the log")
    diagnostics = len(bench.diagnostics)
    wait_until(lambda: len(bench.diagnostics) > diagnostics + 2, what="more diagnostics")
    assert len(bench.logged("/probe publishes /joint_states")) == 1, "said once"
    client = bench.probe.parameters()
    assert not bench.probe.set(client, allow_shared_topics="yes")[0].successful
    assert bench.probe.set(client, allow_shared_topics=True)[0].successful
    wait_until(lambda: topics(bench) == (0, {}), what="no warning")
    assert bench.probe.set(client, allow_shared_topics=False)[0].successful
    bench.probe.node.destroy_publisher(publisher)
    wait_until(lambda: topics(bench) == (0, {}), what="the end of the warning")


@pytest.mark.parametrize("end", [signal.SIGINT, signal.SIGKILL])
def test_a_node_starts_again_after_its_predecessor_has_ended(probe, simulators, end):
    for _ in range(2):
        simulator = runs(probe, simulators)
        simulators.remove(simulator)
        simulator.process.send_signal(end)
        simulator.process.communicate(timeout=30)
    runs(probe, simulators)
