"""Services of our own: angles set as by a hand, and poses remembered."""

import math

import pytest
from conftest import wait_until
from realnoid.srv import SetJointAngles
from services import Services
from simulation_interfaces.srv import GetEntityState, ResetSimulation
from std_srvs.srv import Trigger

TIP, ROOT = SetJointAngles.Request.TIP, SetJointAngles.Request.ROOT


@pytest.fixture
def still(start):
    bench = start("-p", "start:=paused")
    return bench, Services(bench)


def angles(bench):
    return dict(zip(bench.states[-1].name, bench.states[-1].position))


def position(services, link):
    p = services(GetEntityState, entity=link).state.pose.position
    return [p.x, p.y, p.z]


def test_angles_are_set_from_the_tip_side(still):
    bench, services = still
    answer = services(SetJointAngles, name=["knee", "hip"], position=[0.5, -0.25], side=TIP)
    assert answer.success, answer.message
    wait_until(lambda: angles(bench) == {"hip": -0.25, "knee": 0.5, "ankle": 0}, what="the angles")
    assert math.dist(position(services, "thigh"), (0, 0, 1)) < 1e-12
    assert math.dist(position(services, "shank"), (0.2 * math.cos(-0.25), 0.2 * math.sin(-0.25), 1)) < 1e-12


def test_from_the_root_side_what_hangs_on_the_joint_stays(still):
    bench, services = still
    before = position(services, "foot-sole")
    assert services(SetJointAngles, name=["knee"], position=[math.pi / 2], side=ROOT).success
    wait_until(lambda: abs(angles(bench)["knee"] - math.pi / 2) < 1e-12, what="the angle")
    assert math.dist(position(services, "foot-sole"), before) < 1e-12
    assert math.dist(position(services, "base")[:2], (0.2, 0.2)) < 1e-12, "the base has gone round the knee"


BAD = [
    (dict(name=["elbow"], position=[0.0]), "there is no axis 'elbow'"),
    (dict(name=["hip", "knee"], position=[0.1]), "1 positions for 2 names"),
    (dict(name=["hip", "hip"], position=[0.1, 0.2]), "named twice"),
    (dict(name=[], position=[]), "no axis"),
    (dict(name=["hip", "knee"], position=[0.1, 2.5]), "its range is -2 to 2"),
    (dict(name=["hip"], position=[math.nan]), "NaN"),
    (dict(name=["hip"], position=[0.1], side=2), "TIP (0) or ROOT (1)"),
]


def test_angles_that_cannot_be_set_change_nothing(still):
    bench, services = still
    for fields, reason in BAD:
        answer = services(SetJointAngles, **fields)
        assert not answer.success and reason in answer.message, answer.message
    bench.states.clear()
    wait_until(lambda: len(bench.states) > 2, what="states")
    assert set(angles(bench).values()) == {0.0}


def test_a_remembered_pose_is_the_one_after_a_reset(still):
    bench, services = still
    assert services(SetJointAngles, name=["knee"], position=[0.5]).success
    assert services(Trigger, "remember_pose").success
    assert services(SetJointAngles, name=["knee"], position=[-0.5]).success
    wait_until(lambda: angles(bench)["knee"] == -0.5, what="the angle")
    services(ResetSimulation, scope=ResetSimulation.Request.SCOPE_STATE)
    wait_until(lambda: angles(bench)["knee"] == 0.5, what="the remembered angle")


BREAKING = """<robot name="chain"><link name="a"/>
  <link name="b"><inertial><mass value="1"/><inertia ixx="1" ixy="0" ixz="0" iyy="1" iyz="0" izz="1"/></inertial></link>
  <joint name="j" type="continuous"><parent link="a"/><child link="b"/><axis xyz="0 0 1"/>
    <realnoid><constraint break_threshold="1"/></realnoid></joint></robot>"""


def test_a_pose_is_not_remembered_while_a_joint_is_apart(start, tmp_path):
    urdf = tmp_path / "chain.urdf"
    urdf.write_text(BREAKING)
    bench = start(urdf=urdf)
    services = Services(bench)
    wait_until(lambda: bench.count("simulation", "broken joints") == "1", what="the joint to break")
    answer = services(Trigger, "remember_pose")
    assert not answer.success and "come apart" in answer.message
