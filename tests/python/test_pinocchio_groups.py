"""Joint groups against Pinocchio, which sees the same joints as a plain chain: accelerations, and a second of motion."""

import json
import subprocess

import numpy as np
import pinocchio as pin
import pytest
from conftest import BINARY
from limbs import limb
from simulation import rows

GRAVITY = np.array([0.0, 0.0, -9.80665])
AXES = ["h", "p", "b", "e", "knee"]
KINDS = ["3dof", "cardan", "combined_hinge"]


@pytest.fixture
def group(request, tmp_path):
    """Our file with the tag, Pinocchio's model of the same without."""
    path = tmp_path / "limb.urdf"
    path.write_text(limb(request.param))
    model = pin.buildModelFromXML(limb(request.param, tagged=False))
    model.gravity.linear = GRAVITY
    assert [*model.names][1:] == AXES
    return path, model


def states(seed):
    """Away from the pole of a 3dof, where no chain of three hinges is regular."""
    rng = np.random.default_rng(seed)
    scale = np.array([1.2, 1.2, 1.2, 0.4, 1.2])
    for _ in range(200):
        yield rng.uniform(-1, 1, 5) * scale, rng.uniform(-3, 3, 5), rng.uniform(-20, 20, 5)


@pytest.mark.parametrize("group", KINDS, indirect=True)
def test_accelerations_of_groups_agree_with_pinocchio(group):
    """Tolerance as for whole robots (test_pinocchio.py)."""
    path, model = group
    data = model.createData()
    names = ("position", "velocity", "effort")
    lines = [json.dumps({n: x.tolist() for n, x in zip(names, state)}) for state in states(3)]
    done = subprocess.run([BINARY, "evaluate", path], input="\n".join(lines), text=True, capture_output=True, check=True)
    worst = 0.0
    for line, state in zip(done.stdout.splitlines(), states(3), strict=True):
        expected = pin.aba(model, data, *state)
        worst = max(worst, np.abs(json.loads(line)["acceleration"] - expected).max() / np.abs(expected).max())
    print(f"worst relative difference {worst:.1e}")
    assert worst <= 1e-10


def trajectory(model, q, v, tau, step, count):
    """Classical fourth-order Runge-Kutta on the angles."""
    data = model.createData()

    def rates(q, v):
        return v, pin.aba(model, data, q, v, tau)

    for _ in range(count):
        a = rates(q, v)
        b = rates(q + step / 2 * a[0], v + step / 2 * a[1])
        c = rates(q + step / 2 * b[0], v + step / 2 * b[1])
        d = rates(q + step * c[0], v + step * c[1])
        q = q + step / 6 * (a[0] + 2 * b[0] + 2 * c[0] + d[0])
        v = v + step / 6 * (a[1] + 2 * b[1] + 2 * c[1] + d[1])
    return q, v


@pytest.mark.parametrize("group", KINDS, indirect=True)
def test_a_second_of_motion_agrees_with_pinocchio(group, tmp_path):
    """Both by RK4. With the same coordinates (cardan, combined hinge) the two make the same steps: rounding alone, which a
    chain of this kind makes grow some thousandfold in a second. With a quaternion the truncation differs: it is of fourth
    order, so the difference falls 16 times with half the step; a quarter of that is left as margin."""
    path, model = group
    q, v = np.array([0.3, -0.5, 0.2, 0.05, -0.4]), np.array([0.7, 0.5, -0.9, 0.1, 1.1])
    tau = np.array([2.0, -9.0, 1.0, -12.0, 3.0])
    flags = ["--integrator", "rk4", "--off", "limits", "--duration", 1, "--every", 1]
    for axis, *value in zip(AXES, q, v, strict=True):
        flags += ["--set", f"{axis}={value[0]!r},{value[1]!r}".replace("np.float64(", "").replace(")", "")]
    for axis, torque in zip(AXES, tau, strict=True):
        flags += ["--effort", f"{axis}={torque}"]
    differences = []
    for step in (0.001, 0.0005):
        table = rows(path, tmp_path, *flags, "--control-interval", step, "--steps", 1)
        expected_q, expected_v = trajectory(model, q, v, tau, step, round(1 / step))
        pitch = abs(expected_q[1])
        ours_q = np.array([table[f"{a}.position"][-1] for a in AXES])
        ours_v = np.array([table[f"{a}.velocity"][-1] for a in AXES])
        assert np.abs(ours_q - q).max() > 0.5 and pitch < 1.4, "it has moved, and not through the pole"
        differences.append(max(np.abs(ours_q - expected_q).max(), np.abs(ours_v - expected_v).max()))
    print(f"differences {differences}")
    if "3dof" in path.read_text():
        assert differences[1] <= max(differences[0] / 12, 1e-12)
        assert differences[1] <= 1e-6
    else:
        assert max(differences) <= 1e-10
