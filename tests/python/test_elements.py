"""What the world consists of, what it warns of, and building it again, over services."""

import pytest
from conftest import nanoseconds, wait_until
from geometry_msgs.msg import TwistStamped
from realnoid.srv import ListElements, Warnings
from services import Services
from simulation_interfaces.msg import Result
from simulation_interfaces.srv import DeleteEntity, GetEntities, GetEntityState, ResetSimulation
from std_srvs.srv import Trigger

PILE = """version: 1
bodies:
  - {name: low, mass: 1, shape: {box: {size: [0.4, 0.4, 0.2]}}, pose: [0, 1, 0.1, 0, 0, 0, 1]}
  - {name: high, mass: 2, shape: {box: {size: [0.2, 0.2, 0.2]}}, pose: [0, 1, 0.3, 0, 0, 0, 1], monitor: world}
  - {name: shelf, static: true, shape: {box: {size: [0.4, 0.4, 0.2]}}, pose: [2, 0, 0.1, 0, 0, 0, 1]}
ground: true
"""


def call(bench, kind, name, **fields):
    client = bench.probe.node.create_client(kind, name)
    assert client.wait_for_service(30.0), name
    return bench.probe.call(lambda: client.call_async(kind.Request(**fields)))


@pytest.mark.parametrize("engine", ["rbx", "rapier"])
def test_elements_are_listed_as_the_engine_has_them(start, tmp_path, engine):
    scene = tmp_path / "pile.yaml"
    scene.write_text(PILE)
    bench = start("-p", f"scene:={scene}", "-p", f"engine:={engine}")
    reply = call(bench, ListElements, "list_elements")
    assert (reply.engine, reply.state) == (engine, "normal")
    by_name = {e.name: e for e in reply.elements}
    kinds = {name: by_name[name].kind for name in ("low", "shelf", "ground", "hip")}
    E = type(reply.elements[0])
    assert kinds == {"low": E.DYNAMIC_BODY, "shelf": E.STATIC_BODY, "ground": E.STATIC_BODY, "hip": E.JOINT}
    assert by_name["high"].mass == pytest.approx(2.0, abs=1e-12) and by_name["shelf"].mass == 0.0
    assert by_name["high"].initial_pose.position.z == pytest.approx(0.3, abs=1e-12)
    assert len(by_name["low"].shapes) == 1 and by_name["hip"].constraint
    # Three axes of the arm.
    assert sum(e.kind == E.JOINT for e in reply.elements) == 3


def test_the_whole_humanoid_is_listed(start):
    """A reply of some 10 kB, in many fragments: docs/decisions/0032."""
    bench = start(urdf=None)
    reply = call(bench, ListElements, "list_elements")
    names = set(bench.states[-1].name)
    assert {e.name for e in reply.elements if e.kind == e.JOINT} == names
    assert sum(e.mass for e in reply.elements) == pytest.approx(sum(e.mass for e in reply.elements if e.kind == e.LINK))
    assert all(e.shapes == [] and e.constraint for e in reply.elements if e.kind == e.JOINT)


def test_warnings_come_with_their_history(start, tmp_path):
    from conftest import ARM

    bench = start()
    reply = call(bench, Warnings, "warnings")
    assert (list(reply.warnings), reply.omitted) == ([], 0)
    frozen = ARM.read_text()
    begin = frozen.index("<limit", frozen.index('name="knee"'))
    end = frozen.index("/>", begin)
    urdf = tmp_path / "frozen.urdf"
    urdf.write_text(frozen[:begin] + '<limit lower="0.3" upper="0.3" effort="10" velocity="2"' + frozen[end:])
    bench = start(urdf=urdf)
    [warning] = call(bench, Warnings, "warnings").warnings
    assert (warning.element, warning.kind, warning.stamp.sec) == ("knee", "frozen-transform", 0)
    assert "0.3" in warning.text


def test_rebuild_goes_back_to_the_start_and_time_goes_on(start, tmp_path):
    scene = tmp_path / "pile.yaml"
    scene.write_text(PILE.replace("0.3, 0, 0, 0, 1]", "0.9, 0, 0, 0, 1]"))
    bench = start("-p", f"scene:={scene}", "-p", "paused:=true")
    twists = bench.probe.listen(TwistStamped, "twist/high")
    wait_until(lambda: twists, what="the body that is to fall")
    assert bench.probe.set(bench.probe.parameters(), paused=False)[0].successful

    def falls():
        """How often it has come to fall fast after it was slow."""
        fast = [t.twist.linear.z < -1.0 for t in twists if t.twist.linear.z < -1.0 or abs(t.twist.linear.z) < 0.1]
        return sum(b and not a for a, b in zip(fast, fast[1:]))

    wait_until(lambda: falls() == 1, what="the fall")
    assert call(bench, Trigger, "rebuild").success
    wait_until(lambda: falls() == 2, what="another fall")
    stamps = [nanoseconds(t.header.stamp) for t in twists]
    assert stamps == sorted(stamps) and stamps[-1] > 0, "time goes on"


def test_remember_pose_makes_the_present_pose_the_one_at_start(bench):
    reply = call(bench, Trigger, "remember_pose")
    assert reply.success and reply.message == ""


def height(services, name):
    return services(GetEntityState, entity=name).state.pose.position.z


def test_a_deleted_body_carries_nothing_and_comes_back_with_all(start, tmp_path):
    scene = tmp_path / "pile.yaml"
    scene.write_text(PILE)
    services = Services(start("-p", f"scene:={scene}"))
    assert services(DeleteEntity, entity="low").result.result == Result.RESULT_OK
    assert "low" not in services(GetEntities).entities
    wait_until(lambda: height(services, "high") < 0.11, what="the body above to lie on the ground")
    for name, kind in (("low", Result.RESULT_NOT_FOUND), ("nobody", Result.RESULT_NOT_FOUND), ("base", Result.RESULT_OPERATION_FAILED)):
        result = services(DeleteEntity, entity=name).result
        assert result.result == kind and name in result.error_message
    assert services(ResetSimulation, scope=ResetSimulation.Request.SCOPE_STATE).result.result == Result.RESULT_OK
    assert "low" not in services(GetEntities).entities, "a reset of the state does not bring it back"
    assert services(ResetSimulation, scope=ResetSimulation.Request.SCOPE_ALL).result.result == Result.RESULT_OK
    assert "low" in services(GetEntities).entities
    assert height(services, "high") > 0.29


def test_without_a_link_the_robot_stands_until_it_is_rebuilt(bench):
    services = Services(bench)
    wait_until(lambda: len(bench.states) > 10, what="states")
    assert services(DeleteEntity, entity="shank").result.result == Result.RESULT_OK
    assert services(ListElements).state == "joint_configuration_fault"
    [warning] = services(Warnings).warnings
    assert warning.kind == "joint-configuration-fault"
    assert services(Trigger, "rebuild").success
    assert services(ListElements).state == "normal"
    first = len(bench.states)
    wait_until(lambda: len(bench.states) > first + 50, what="states of what is left")
    assert bench.states[-1].name == bench.states[0].name, "axes keep their places"
