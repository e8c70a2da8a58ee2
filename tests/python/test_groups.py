"""Groups, chains and rigs as programs see them: `inspect --json`, findings, and /tf of the node."""

import json
import math
import subprocess

import numpy as np
import pytest
from conftest import BINARY, nanoseconds, wait_until
from cyclone import listen as cyclone_listen
from limbs import limb
from sensor_msgs.msg import JointState
from simulation import columns, refused, rows, simulate

CHAIN = "<chain root='hip' anchor='base' self_collision='false'/>"
RIG = f"{CHAIN}<separate_rig name='ik_hip' of='hip'/>"


@pytest.fixture
def file(tmp_path):
    def written(*arguments, **options):
        path = tmp_path / "limb.urdf"
        path.write_text(limb(*arguments, **options))
        return path

    return written


def as_json(path):
    return json.loads(subprocess.check_output([BINARY, "inspect", path, "--json"]))


def check(path):
    done = subprocess.run([BINARY, "check", path], capture_output=True, text=True)
    return done.returncode, done.stdout


def test_inspect_tells_groups_chains_and_rigs(file):
    """J-2, J-4, J-5, J-7, J-9."""
    seen = as_json(file("3dof", more=RIG))
    assert seen["groups"] == [
        {"name": "hip", "type": "3dof", "h": "h", "p": "p", "b": "b", "e": "e", "valid": True, "faults": []}
    ]
    [chain] = seen["chains"]
    assert (chain["root"], chain["joint"], chain["anchor"], chain["self_collision"]) == ("hip", "h", "base", False)
    assert chain["links"] == ["l1", "l2", "limb", "shaft", "shin"]
    assert {link["name"]: link["chain"] for link in seen["links"]} == {"base": None} | {n: "hip" for n in chain["links"]}
    [rig] = seen["rigs"]
    assert rig == {"name": "ik_hip", "group": "hip", "axes": ["h", "p", "b"], "parent": "base", "anchored": False, "reference": "l2"}
    assert all(axis["valid"] and axis["faults"] == [] for axis in seen["axes"])


def test_an_inner_chain_takes_its_links(file):
    chains = f"{CHAIN}<chain root='knee' anchor='shaft'/>"
    outer, inner = as_json(file("cardan", more=chains))["chains"]
    assert outer["links"] == ["l1", "l2", "limb", "shaft"] and inner["links"] == ["shin"]
    assert inner["self_collision"] is True


def test_an_invalid_setting_says_why(file):
    """J-5: it loads, and cannot work."""
    weak = "<realnoid><drive mode='servo' max_torque='5' static_resistance='6'/></realnoid>"
    path = file("cardan", drive=weak)
    path.write_text(path.read_text().replace("lower='-1.5' upper='1.5'", "lower='0.2' upper='0.2'", 1))
    seen = as_json(path)
    axes = {axis["name"]: axis for axis in seen["axes"]}
    assert axes["h"]["faults"] == ["the range is 0.2 to 0.2: the axis cannot move"] and not axes["h"]["valid"]
    assert "static resistance 6, maximum torque 5" in axes["e"]["faults"][0]
    assert axes["p"]["valid"]
    [group] = seen["groups"]
    assert not group["valid"] and group["faults"][0].startswith("h: the range") and group["faults"][1].startswith("e: the drive")
    assert "frozen-transform" in check(path)[1]


def test_a_chain_on_the_world_needs_a_fixed_base(file):
    path = file("3dof", more="<chain root='hip' anchor='world'/>")
    assert check(path)[0] == 0
    assert simulate(path, "--duration", 0)["finite"]
    message = refused(path, "--duration", 0, "--base", "free", code=1)
    assert "chain of 'hip'" in message and "world" in message and "free" in message


def test_what_the_engine_does_not_honour_is_told(file):
    """E-2: engine, joint, item."""
    path = file("3dof")
    path.write_text(path.read_text().replace("velocity='200'/>", "velocity='200' acceleration='3'/>").replace("<robot ", "<robot version='1.2' "))
    code, told = check(path)
    assert code == 0 and "not-honoured" in told
    assert "the engine rbx does not honour <limit acceleration> of joint 'h', nor of 3 others" in told
    assert any("acceleration" in warning for warning in simulate(path, "--duration", 0)["warnings"])


def rotation(x, y, z, w):
    return np.array(
        [
            [1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)],
            [2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)],
            [2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)],
        ]
    )


def turn(axis, a):
    c, s = math.cos(a), math.sin(a)
    return np.array({"x": [[1, 0, 0], [0, c, -s], [0, s, c]], "y": [[c, 0, s], [0, 1, 0], [-s, 0, c]], "z": [[c, -s, 0], [s, c, 0], [0, 0, 1]]}[axis])


def test_the_node_publishes_a_rig_on_tf(start, file):
    """J-4: Rz(h) Ry(p) Rx(b) in the frame of the group, at the origin of the link of p."""
    bench = start(urdf=file("3dof", more=RIG))
    tf = cyclone_listen("tf", bench.domain)
    command = bench.probe.publisher(JointState, "joint_command")
    target = {"h": 0.4, "p": -0.6, "b": 0.7}
    command.publish(JointState(name=[*target], position=[*target.values()]))

    def arrived():
        return all(abs(bench.axis(name)[0] - angle) < 1e-9 for name, angle in target.items())

    wait_until(arrived, what="the servos")
    since = nanoseconds(bench.states[-1].header.stamp)
    later = lambda: [m for m in tf.take_all() if nanoseconds(m.transforms[0].header.stamp) > since]
    frames = {t.child_frame_id: t for t in wait_until(later, what="/tf")[-1].transforms}
    rig, l1 = frames["ik_hip"], frames["l1"]
    assert rig.header.frame_id == "base"
    q = rig.transform.rotation
    group = turn("z", 0.4) @ turn("y", -0.1) @ turn("x", 0.2)  # the rpy of h: 0.2 -0.1 0.4
    expected = group @ turn("z", 0.4) @ turn("y", -0.6) @ turn("x", 0.7)
    np.testing.assert_allclose(rotation(q.x, q.y, q.z, q.w), expected, atol=1e-8)
    p, origin = rig.transform.translation, l1.transform.translation
    np.testing.assert_allclose([p.x, p.y, p.z], [origin.x, origin.y, origin.z], atol=1e-12)


@pytest.mark.parametrize("base", ["fixed", "free"])
def test_turn_moves_the_root_side(file, tmp_path, base):
    """J-12: the potential energy of what hangs on the axis stays; a free base stands elsewhere."""
    path = file("cardan")
    still = ["--duration", 0, "--base", base]
    if base == "free":
        path.write_text(path.read_text().replace("<link name='base'>", "<link name='base'><inertial><mass value='5'/><inertia ixx='1' ixy='0' ixz='0' iyy='1' iyz='0' izz='1'/></inertial>"))
    plain, tip = rows(path, tmp_path, *still), rows(path, tmp_path, *still, "--set", "knee=0.5")
    root = rows(path, tmp_path, *still, "--turn", "knee=0.5")
    assert root["knee.position"] == tip["knee.position"] == [0.5]
    assert root["energy.potential"] != tip["energy.potential"]
    if base == "free":
        assert [plain[f"base.{c}"] for c in "xyz"] != [root[f"base.{c}"] for c in "xyz"]
        assert [plain[f"base.{c}"] for c in "xyz"] == [tip[f"base.{c}"] for c in "xyz"]
    assert "its range is -1.5 to 1.5" in refused(path, *still, "--turn", "knee=2")
    assert "AXIS=POSITION" in refused(path, *still, "--turn", "knee=1,2")
    assert "there is no axis" in refused(path, *still, "--turn", "kne=1")


def test_a_linear_axis_takes_forces_and_targets(file, tmp_path):
    """J-14 from the command line."""
    path = file("3dof")
    hold = [f for a in ("h", "p", "b", "knee") for f in ("--servo", f"{a}=0")]
    out = tmp_path / "rows.csv"
    summary = simulate(path, "--duration", 2, *hold, "--servo", "e=0.2,4000,0.3", "--out", out)
    table = columns(out)
    assert table["e.position"][-1] == pytest.approx(0.2, abs=1e-9)
    assert max(map(abs, table["e.velocity"])) <= 0.3 * (1 + 1e-9)
    assert summary["peaks"]["e"]["speed"] == max(map(abs, table["e.velocity"]))
    assert summary["peaks"]["e"]["torque"] == max(map(abs, table["e.effort"]))
