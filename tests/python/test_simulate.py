"""The contract of `realnoid simulate`: columns, digits, summary, exit codes, messages, and physics in closed form."""

import math
import subprocess

import pytest
from conftest import ARM, BINARY
from simulation import ORIGIN, columns, refused, rows, run, simulate, texts

G = 9.80665
MASS, LENGTH, INERTIA = 1.7, 0.4, 0.03

PENDULUM = f"""<robot name="pendulum">
  <link name="stand"/>
  <link name="bob"><inertial>
    <origin xyz="0 0 {-LENGTH}"/><mass value="{MASS}"/>
    <inertia ixx="0.05" ixy="0" ixz="0" iyy="{INERTIA}" iyz="0" izz="0.04"/>
  </inertial></link>
  <joint name="swing" type="continuous">
    <parent link="stand"/><child link="bob"/><origin xyz="0 0 1"/><axis xyz="0 1 0"/>
    <limit effort="20" velocity="50"/>DYNAMICS
  </joint>
</robot>"""
INERTIA_AT_PIVOT = INERTIA + MASS * LENGTH**2

BRICK = """<robot name="brick"><link name="brick"><inertial>
  <origin xyz="0.1 -0.05 0.2"/><mass value="3"/>
  <inertia ixx="0.02" ixy="0" ixz="0" iyy="0.05" iyz="0" izz="0.06"/>
</inertial></link></robot>"""
BRICK_MASS, BRICK_CENTRE = 3.0, (0.1, -0.05, 0.2)


@pytest.fixture
def pendulum(tmp_path):
    path = tmp_path / "pendulum.urdf"
    path.write_text(PENDULUM.replace("DYNAMICS", ""))
    return path


@pytest.fixture
def damped(tmp_path):
    path = tmp_path / "damped.urdf"
    path.write_text(PENDULUM.replace("DYNAMICS", '<dynamics damping="0.6" friction="0.1"/>'))
    return path


@pytest.fixture
def brick(tmp_path):
    path = tmp_path / "brick.urdf"
    path.write_text(BRICK)
    return path


# Columns, digits, summary


@pytest.mark.parametrize("base", ["fixed", "free"])
def test_columns_come_in_the_order_of_the_contract(tmp_path, base):
    table = rows(ORIGIN, tmp_path, "--duration", 0.002, "--base", base)
    document = ORIGIN.read_text()
    axes = sorted({c.split(".")[0] for c in table if c.endswith(".position")}, key=lambda a: document.index(f'<joint name="{a}"'))
    assert len(axes) >= 30
    expected = ["time", *(f"{a}.{part}" for a in axes for part in ("position", "velocity", "effort"))]
    if base == "free":
        expected += [f"base.{c}" for c in "x y z qx qy qz qw wx wy wz vx vy vz".split()]
    expected += ["energy.kinetic", "energy.potential", *(f"momentum.{c}" for c in "lx ly lz px py pz".split())]
    assert list(table) == expected


def test_numbers_are_the_17_significant_digits_of_their_doubles(tmp_path):
    """17 digits name one double only; that they name the right one, the bags tell (test_bags.py)."""
    path = tmp_path / "rows.csv"
    moving = ["--base", "free", "--base-twist", "1,2,3,4,5,6", "--servo", "left_elbow=0.5", "--effort", "waist_yaw=3"]
    simulate(ORIGIN, "--duration", 0.05, *moving, "--out", path)
    numbers = {x for column in texts(path).values() for x in column}
    assert len(numbers) > 3000
    for text in numbers:
        mantissa, exponent = text.split("e")
        digits, power = f"{float(text):.16e}".split("e")
        assert (mantissa, int(exponent)) == (digits, int(power)) and len(mantissa.lstrip("-")) == 18


def test_given_values_stand_in_the_first_row(tmp_path):
    given = {"left_elbow": (1 / 3, -2 / 7), "left_hip_yaw": (0.1, 0.7), "left_hip_pitch": (-0.3, 1.1), "waist_roll": (0.05, 0)}
    flags = [f for name, (q, v) in given.items() for f in ("--set", f"{name}={q!r},{v!r}")]
    pose, twist = (1.5, -2.5, 3.5, 0.5, -0.5, 0.5, 0.5), (1.1, 1.2, 1.3, 1.4, 1.5, 1.6)
    flags += ["--base-pose", ",".join(map(repr, pose)), "--base-twist", ",".join(map(repr, twist))]
    table = rows(ORIGIN, tmp_path, "--duration", 0, "--base", "free", *flags)
    for name, (position, velocity) in given.items():
        assert table[f"{name}.position"] == [position]
        assert table[f"{name}.velocity"][0] == pytest.approx(velocity, abs=1e-15)
    assert [table[f"base.{c}"][0] for c in "x y z qx qy qz qw".split()] == list(pose)
    assert [table[f"base.{c}"][0] for c in "wx wy wz vx vy vz".split()] == list(twist)


def test_set_without_a_velocity_is_at_rest(pendulum, tmp_path):
    table = rows(pendulum, tmp_path, "--duration", 0, "--set", "swing=-0.5")
    assert (table["swing.position"], table["swing.velocity"]) == ([-0.5], [0.0])


def test_the_summary_has_what_the_contract_names(pendulum, tmp_path):
    path = tmp_path / "rows.csv"
    s = simulate(pendulum, "--duration", 0.5, "--steps", 4, "--every", 0.01, "--out", path)
    assert (s["steps"], s["rows"], s["simulated_seconds"]) == (2000, 51, 0.5)
    assert s["cpu_seconds"] > 0 and s["us_per_step"] == pytest.approx(s["cpu_seconds"] * 1e6 / s["steps"])
    assert (s["worst_penetration"], s["finite"], s["stopped"], s["warnings"]) == (0, True, False, [])
    assert s["output"] == [str(path)]


def test_without_out_nothing_is_written(pendulum, tmp_path):
    s = simulate(pendulum, "--duration", 0.01)
    assert (s["rows"], s["output"]) == (0, [])
    assert [p.name for p in tmp_path.iterdir()] == ["pendulum.urdf"]


def test_findings_of_the_file_become_warnings(tmp_path):
    warnings = simulate(ARM, "--duration", 0)["warnings"]
    assert any(w.startswith(f"{ARM}:13: link 'foot-sole'") for w in warnings)


def test_a_closed_pipe_is_no_panic(pendulum):
    command = f"'{BINARY}' simulate '{pendulum}' --duration 0.01 | true; exit ${{PIPESTATUS[0]}}"
    done = subprocess.run(["bash", "-c", command], capture_output=True, text=True)
    assert (done.returncode, done.stderr) == (0, "")


# Rows in time


def test_rows_are_every_apart_and_the_first_is_at_zero(pendulum, tmp_path):
    assert rows(pendulum, tmp_path, "--duration", 0.2, "--every", 0.05)["time"] == [k * 50_000_000 * 1e-9 for k in range(5)]
    assert rows(pendulum, tmp_path, "--duration", 0.003)["time"] == [k * 1_000_000 * 1e-9 for k in range(4)]


def test_every_changes_what_is_written_not_what_is_computed(pendulum, tmp_path):
    fine = rows(pendulum, tmp_path, "--duration", 0.4, "--set", "swing=1")
    coarse = rows(pendulum, tmp_path, "--duration", 0.4, "--set", "swing=1", "--every", 0.1)
    assert coarse == {name: column[::100] for name, column in fine.items()}


def test_time_scale_stretches_the_interval(pendulum, tmp_path):
    start = ["--set", "swing=1", "--steps", 4]
    scaled = rows(pendulum, tmp_path, "--duration", 0.4, *start, "--time-scale", 2)
    assert scaled["time"] == [k * 2_000_000 * 1e-9 for k in range(201)]
    assert scaled == rows(pendulum, tmp_path, "--duration", 0.4, *start, "--control-interval", 0.002)
    assert "stops time" in refused(pendulum, "--duration", 1, "--time-scale", 0)


@pytest.mark.parametrize("integrator, order", [("implicit_midpoint", 2), ("semi_implicit_euler", 1)])
def test_more_steps_are_more_accurate(pendulum, tmp_path, integrator, order):
    end = ["--duration", 0.5, "--set", "swing=1", "--control-interval", 0.01]
    exact = rows(pendulum, tmp_path, *end, "--integrator", "rk4", "--steps", 200)["swing.position"][-1]
    errors = []
    for steps in (10, 20, 40):
        flags = [*end, "--steps", steps, "--integrator", integrator]
        assert simulate(pendulum, *flags)["steps"] == 50 * steps
        errors.append(abs(rows(pendulum, tmp_path, *flags)["swing.position"][-1] - exact))
    assert all(0.9 < a / b / 2**order < 1.1 for a, b in zip(errors, errors[1:])), errors


# Physics in closed form


def test_accuracy_chooses_integrator_and_steps(pendulum, tmp_path):
    flags = ["--duration", 0.5, "--control-interval", 0.01, "--set", "swing=2"]
    named = simulate(pendulum, *flags, "--accuracy", 1e-10, "--out", tmp_path / "a.csv")
    same = [*flags, "--integrator", "extrapolation", "--steps", 1]
    same += ["--scene", scene(tmp_path, "version: 1\nworld: {accuracy: 1.0e-10}\n")]
    simulate(pendulum, *same, "--out", tmp_path / "b.csv")
    assert (tmp_path / "a.csv").read_bytes() == (tmp_path / "b.csv").read_bytes()
    assert named["steps"] == 50 and named["fallback_steps"] == 0
    # What of the energy is not accounted for is the error: speeds of 8 rad/s, at 0.3 kg m^2.
    assert abs(named["energy"]["unaccounted"]) < 1e-10 * 0.5 * 0.3 * 8 * 9
    assert simulate(pendulum, *flags, "--accuracy", 1e-10, "--steps", 3)["steps"] == 150


def test_the_error_of_a_run_is_estimated_on_request(pendulum, tmp_path):
    flags = ["--duration", 1, "--set", "swing=2"]
    exact = rows(pendulum, tmp_path, *flags, "--accuracy", 1e-12)["swing.position"][-1]
    flags += ["--steps", 1]
    off = rows(pendulum, tmp_path, *flags)["swing.position"][-1] - exact
    told = simulate(pendulum, *flags, "--estimate-error")["error_estimate"]
    assert told["order"] == 2 and told["at_end"]["position"]["of"] == "swing" and told["cpu_seconds"] > 0
    assert told["at_end"]["position"]["size"] == pytest.approx(abs(off), rel=0.01)
    assert told["at_most"]["position"]["size"] >= told["at_end"]["position"]["size"] > told["worst_interval"]["position"]["size"] > 0
    assert "error_estimate" not in simulate(pendulum, *flags)


def complete_elliptic_integral(k):
    """K(k) by the arithmetic-geometric mean."""
    a, b = 1.0, math.sqrt(1 - k * k)
    while abs(a - b) > 1e-15 * a:
        a, b = (a + b) / 2, math.sqrt(a * b)
    return math.pi / (a + b)


def upward_crossings(table):
    """When the pendulum passes 0 with rising angle: cubic Hermite between rows, error far below 1e-10 s."""
    t, q, v = table["time"], table["swing.position"], table["swing.velocity"]
    found = []
    for i in range(len(t) - 1):
        if q[i] < 0 <= q[i + 1]:
            h, low, high = t[i + 1] - t[i], 0.0, 1.0
            for _ in range(60):
                s = (low + high) / 2
                value = (2 * s**3 - 3 * s**2 + 1) * q[i] + (s**3 - 2 * s**2 + s) * h * v[i]
                value += (3 * s**2 - 2 * s**3) * q[i + 1] + (s**3 - s**2) * h * v[i + 1]
                low, high = (s, high) if value < 0 else (low, s)
            found.append(t[i] + low * h)
    return found


@pytest.mark.parametrize("amplitude", [0.3, 1.5, 3.0])
def test_the_period_of_a_pendulum_is_an_elliptic_integral(pendulum, tmp_path, amplitude):
    table = rows(pendulum, tmp_path, "--duration", 8, "--integrator", "rk4", "--set", f"swing={amplitude}")
    crossings = upward_crossings(table)
    slow = math.sqrt(INERTIA_AT_PIVOT / (MASS * G * LENGTH))
    period = 4 * slow * complete_elliptic_integral(math.sin(amplitude / 2))
    assert len(crossings) >= 2
    assert crossings[0] == pytest.approx(0.75 * period, abs=1e-8)
    assert crossings[1] - crossings[0] == pytest.approx(period, abs=1e-8)


def test_energy_of_a_pendulum_is_that_of_the_book_and_stays(pendulum, tmp_path):
    table = rows(pendulum, tmp_path, "--duration", 3, "--integrator", "rk4", "--set", "swing=1.2,0.7")
    height = [1 - LENGTH * math.cos(q) for q in table["swing.position"]]
    for i in range(0, 3001, 100):
        assert table["energy.potential"][i] == pytest.approx(MASS * G * height[i], abs=1e-12)
        assert table["energy.kinetic"][i] == pytest.approx(INERTIA_AT_PIVOT * table["swing.velocity"][i] ** 2 / 2, abs=1e-12)
    total = [a + b for a, b in zip(table["energy.kinetic"], table["energy.potential"], strict=True)]
    assert max(total) - min(total) < 1e-9 * total[0]


@pytest.mark.parametrize("gravity", [(0, 0, -G), (1.5, -2.5, 3.5)])
def test_free_fall(brick, tmp_path, gravity):
    """Without spin every point falls as one: p = p0 + v t + g t²/2, which RK4 integrates without error."""
    flags = ["--gravity", ",".join(map(str, gravity)), "--integrator", "rk4", "--base", "free"]
    flags += ["--base-pose", "1,2,3,0,0,0,1", "--base-twist", "0,0,0,0.4,-0.5,0.6"]
    table = rows(brick, tmp_path, "--duration", 2, *flags)
    for axis, p0, v0, g in zip("xyz", (1, 2, 3), (0.4, -0.5, 0.6), gravity, strict=True):
        for t, p, v, momentum in zip(*(table[c] for c in ("time", f"base.{axis}", f"base.v{axis}", f"momentum.p{axis}"))):
            assert p == pytest.approx(p0 + v0 * t + g * t * t / 2, abs=1e-10)
            assert v == pytest.approx(v0 + g * t, abs=1e-10)
            assert momentum == pytest.approx(BRICK_MASS * (v0 + g * t), abs=1e-10)
    assert max(abs(w) for c in "xyz" for w in table[f"base.w{c}"]) < 1e-12


def rotated(q, v):
    """v turned by the unit quaternion q = (x, y, z, w)."""
    (x, y, z, w), cross = q, lambda a, b: [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
    t = [2 * c for c in cross((x, y, z), v)]
    u = cross((x, y, z), t)
    return [v[i] + w * t[i] + u[i] for i in range(3)]


def test_a_tumbling_brick_keeps_its_momenta_and_its_centre_follows_a_parabola(brick, tmp_path):
    flags = ["--integrator", "rk4", "--base", "free", "--base-twist", "3,0.1,-2,1,0,4"]
    table = rows(brick, tmp_path, "--duration", 1, *flags)

    def centre(i):
        q = [table[f"base.q{c}"][i] for c in ("x", "y", "z", "w")]
        assert math.hypot(*q) == pytest.approx(1, abs=1e-14)
        return [table[f"base.{c}"][i] + d for c, d in zip("xyz", rotated(q, BRICK_CENTRE), strict=True)]

    v0 = [table[f"momentum.p{c}"][0] / BRICK_MASS for c in "xyz"]
    for i in range(0, 1001, 50):
        t = table["time"][i]
        for k, g in enumerate((0, 0, -G)):
            assert centre(i)[k] == pytest.approx(BRICK_CENTRE[k] + v0[k] * t + g * t * t / 2, abs=1e-9)
    for c in ("lx", "ly", "lz", "px", "py"):
        assert table[f"momentum.{c}"] == pytest.approx([table[f"momentum.{c}"][0]] * 1001, abs=1e-9)
    spin = [table["momentum.l" + c][0] for c in "xyz"]
    assert spin == pytest.approx([0.02 * 3, 0.05 * 0.1, 0.06 * -2], abs=1e-15), "about the centre of mass"


def test_base_twist_is_in_the_base_frame(brick, tmp_path):
    """Pitched by 90°, forward is down."""
    r = math.sqrt(0.5)
    flags = ["--base", "free", "--off", "gravity", "--base-pose", f"0,0,0,0,{r},0,{r}", "--base-twist", "0,0,0,2,0,0"]
    table = rows(brick, tmp_path, "--duration", 0.5, *flags)
    assert [table[f"base.{c}"][-1] for c in "xyz"] == pytest.approx([0, 0, -1], abs=1e-12)
    assert [table[f"base.v{c}"][-1] for c in "xyz"] == pytest.approx([2, 0, 0], abs=1e-12)
    assert table["momentum.pz"][-1] == pytest.approx(-2 * BRICK_MASS, abs=1e-12)


def test_base_pose_places_a_fixed_base(pendulum, tmp_path):
    """Upside down, the pendulum hangs at π; 2 m up, its energy is higher."""
    table = rows(pendulum, tmp_path, "--duration", 0.5, "--base-pose", "0,0,2,1,0,0,0", "--set", f"swing={math.pi!r}")
    assert table["swing.position"] == pytest.approx([math.pi] * 501, abs=1e-12)
    assert table["energy.potential"][0] == pytest.approx(MASS * G * (2 - 1 - LENGTH), abs=1e-12)


# Effects, commands


def test_gravity_off_leaves_the_pendulum_where_it_is(pendulum, tmp_path):
    table = rows(pendulum, tmp_path, "--duration", 0.5, "--off", "gravity", "--set", "swing=1")
    assert set(table["swing.position"]) == {1.0} and set(table["energy.potential"]) == {0.0}
    fallen = rows(pendulum, tmp_path, "--duration", 0.5, "--set", "swing=1")["swing.position"][-1]
    assert fallen < 0.5, "the same run with gravity swings"
    again = rows(pendulum, tmp_path, "--duration", 0.5, "--gravity", "0,0,0", "--set", "swing=1")
    assert again["swing.position"] == table["swing.position"]


def test_damping_and_friction_can_be_switched_off(damped, pendulum, tmp_path):
    start = ["--duration", 0.5, "--integrator", "rk4", "--set", "swing=0,3"]
    free = rows(pendulum, tmp_path, *start)
    off = rows(damped, tmp_path, *start, "--off", "damping", "--off", "friction")
    assert off["swing.position"] == free["swing.position"]
    for one in ("damping", "friction"):
        assert max(rows(damped, tmp_path, *start, "--off", one)["swing.position"]) < max(free["swing.position"]) - 0.01
    decay = rows(damped, tmp_path, *start, "--off", "friction", "--off", "gravity")
    expected = [3 * math.exp(-0.6 / INERTIA_AT_PIVOT * t) for t in decay["time"]]
    assert decay["swing.velocity"] == pytest.approx(expected, abs=1e-9)


@pytest.mark.parametrize("torque, applied", [(2.5, 2.5), (-2.5, -2.5), (500, 20), (-500, -20)])
def test_effort_turns_the_axis_up_to_its_limit(pendulum, tmp_path, torque, applied):
    flags = ["--off", "gravity", "--integrator", "rk4", "--effort", f"swing={torque}"]
    table = rows(pendulum, tmp_path, "--duration", 0.2, *flags)
    assert table["swing.effort"][1:] == [applied] * 200, "the torque really applied"
    expected = [applied / INERTIA_AT_PIVOT * t * t / 2 for t in table["time"]]
    assert table["swing.position"] == pytest.approx(expected, abs=1e-10)


def test_drives_off_ignores_efforts(pendulum, tmp_path):
    table = rows(pendulum, tmp_path, "--duration", 0.2, "--off", "drives", "--effort", "swing=5")
    assert set(table["swing.position"]) == set(table["swing.effort"]) == {0.0}


@pytest.mark.parametrize("integrator", ["implicit_midpoint", "semi_implicit_euler", "rk4", "extrapolation"])
def test_a_servo_reaches_its_target_and_holds_it_against_gravity(pendulum, tmp_path, integrator):
    flags = ["--duration", 2, "--servo", "swing=0.8", "--integrator", integrator]
    table = rows(pendulum, tmp_path, *flags)
    assert table["swing.position"][-1] == pytest.approx(0.8, abs=1e-6)
    assert table["swing.velocity"][-1] == pytest.approx(0, abs=1e-6)
    assert table["swing.effort"][-1] == pytest.approx(MASS * G * LENGTH * math.sin(0.8), abs=1e-5)
    assert max(abs(x) for x in table["swing.effort"]) <= 20


# Exit codes and messages


@pytest.mark.parametrize(
    "arguments, said",
    [
        (["--set", "swng=1"], ["--set", "'swng'", "the axes are: swing"]),
        (["--set", "swing"], ["--set swing", "AXIS=POSITION[,VELOCITY]"]),
        (["--set", "swing=1,2,3"], ["--set swing=1,2,3", "AXIS=POSITION[,VELOCITY]"]),
        (["--set", "swing=nan"], ["--set swing=nan", "finite"]),
        (["--effort", "swng=1"], ["--effort", "'swng'", "swing"]),
        (["--effort", "swing=1,2,3"], ["--effort swing=1,2,3", "AXIS=TORQUE[,SPEED]"]),
        (["--effort", "swing=inf"], ["--effort swing=inf", "finite"]),
        (["--servo", "swing=up"], ["--servo swing=up", "AXIS=POSITION"]),
        (["--effort", "swing=1", "--servo", "swing=1"], ["--servo swing=1", "already has a command"]),
        (["--gravity", "0,0"], ["--gravity 0,0", "3 finite numbers"]),
        (["--gravity", "0,0,nan"], ["--gravity 0,0,nan", "3 finite numbers"]),
        (["--gravity", "0,0,-1e6"], ["gravity z is -1000000", "from -1000 to 1000"]),
        (["--engine", "bulet"], ["engine 'bulet'", "choose one of: rbx"]),
        (["--integrator", "euler"], ["integrator 'euler'", "implicit_midpoint, semi_implicit_euler, rk4, extrapolation"]),
        (["--accuracy", "1e-9", "--integrator", "rk4"], ["--accuracy", "--integrator extrapolation", "not rk4"]),
        (["--accuracy", "0.1"], ["accuracy is 1e-1", "from 1e-14 to 1e-2"]),
        (["--off", "gravty"], ["--off gravty", "gravity, damping, friction, joint_friction, static"]),
        (["--on", "gravty"], ["--on gravty", "gravity, damping, friction, joint_friction, static"]),
        (["--on", "gravity", "--off", "gravity"], ["--off gravity", "contradict"]),
        (["--base-twist", "0,0,0,0,0,0"], ["--base-twist needs --base free"]),
        (["--base-pose", "0,0,0,0,0,0,2"], ["--base-pose 0,0,0,0,0,0,2", "length is 2"]),
        (["--base-pose", "0,0,0"], ["--base-pose 0,0,0", "7 finite numbers"]),
        (["--control-interval", "0"], ["control_interval", "0.000001 to 1 s"]),
        (["--control-interval", "-1"], ["control_interval", "0.000001 to 1 s"]),
        (["--control-interval", "2"], ["control_interval", "from 0.000001 to 1 s"]),
        (["--steps", "0"], ["steps_per_interval is 0", "from 1 to 1000"]),
        (["--steps", "1001"], ["steps_per_interval is 1001", "from 1 to 1000"]),
        (["--iterations", "0"], ["solver_iterations is 0", "from 1 to 10000"]),
        (["--time-scale", "101"], ["time_scale is 101", "from 0 to 100"]),
        (["--time-scale", "-1"], ["time_scale is -1", "from 0 to 100"]),
        (["--every", "0.0025"], ["--every 0.0025", "whole multiple", "0.001 s"]),
        (["--every", "0.0001"], ["--every 0.0001", "whole multiple", "0.001 s"]),
        (["--every", "-1"], ["--every -1", "whole multiple"]),
        (["--every", "inf"], ["--every inf", "whole multiple"]),
    ],
    ids=" ".join,
)
def test_wrong_arguments_are_refused_with_code_2(pendulum, tmp_path, arguments, said):
    message = refused(pendulum, "--duration", 1, "--out", tmp_path / "rows.csv", *arguments)
    for text in said:
        assert text in message
    assert not (tmp_path / "rows.csv").exists(), "nothing is written"


@pytest.mark.parametrize("duration", ["-1", "inf", "nan"])
def test_a_duration_is_finite_and_not_negative(pendulum, duration):
    assert f"--duration {duration.replace('nan', 'NaN')}" in refused(pendulum, "--duration", duration)


@pytest.mark.parametrize(
    "arguments, said",
    [([], "--duration"), (["--duration", "x"], "'x'"), (["--duration", "1", "--base", "loose"], "fixed, free"), (["--duraton", "1"], "--duration")],
)
def test_what_clap_refuses_has_code_2_as_well(pendulum, arguments, said):
    done = run(pendulum, *arguments)
    assert done.returncode == 2 and said in done.stderr and done.stdout == ""


def test_a_drive_that_must_not_switch_is_not_switched():
    assert simulate(ARM, "--duration", 0.01, "--effort", "ankle=1")["finite"]
    message = refused(ARM, "--duration", 0.01, "--servo", "ankle=1")
    assert "axis 'ankle'" in message and "switchable" in message


def test_files_that_cannot_be_loaded_give_code_1(tmp_path):
    assert "nowhere.urdf" in refused(tmp_path / "nowhere.urdf", "--duration", 1, code=1)
    assert "is a folder" in refused(tmp_path, "--duration", 1, code=1)
    broken = tmp_path / "broken.urdf"
    broken.write_text('<robot name="r">\n  <link name="a"/>\n  <link name="a"/>\n</robot>\n')
    message = refused(broken, "--duration", 1, code=1)
    assert "broken.urdf:3" in message and "'a'" in message


@pytest.mark.parametrize("axis", ["left_hip_yaw", "left_elbow"])
def test_values_that_are_not_finite_give_code_1(tmp_path, axis):
    path = tmp_path / "rows.csv"
    summary = simulate(ORIGIN, "--duration", 0.01, "--set", f"{axis}=0,1e200", "--out", path, code=1)
    assert summary["finite"] is False and summary["rows"] == 11
    assert any("not finite" in w for w in summary["warnings"])
    assert len(columns(path)["time"]) == 11, "the file is complete all the same"


def test_an_energy_that_is_not_finite_gives_code_1_too(brick, tmp_path):
    """The speed can be represented, its square cannot."""
    path = tmp_path / "rows.csv"
    fast = ["--base", "free", "--off", "gravity", "--base-twist", "0,0,0,1e160,0,0"]
    summary = simulate(brick, "--duration", 0.002, *fast, "--out", path, code=1)
    assert columns(path)["energy.kinetic"] == [math.inf] * 3
    assert summary["finite"] is False and "energy" in " ".join(summary["warnings"])
    assert simulate(brick, "--duration", 0.002, *fast, code=1)["finite"] is False, "without a file just the same"


# Scenes


def scene(tmp_path, text):
    path = tmp_path / "scene.yaml"
    path.write_text(text)
    return path


FULL = """version: 1
world:
  control_interval: 0.002
  steps_per_interval: 3
  time_scale: 2
  solver_iterations: 20
  integrator: rk4
  gravity: [0, 0, -1.62]
  effects: {damping: false, friction: false}
robot: {base: fixed, pose: [0, 0, 5, 0, 0, 0, 1]}
"""


def test_a_scene_says_what_the_flags_would(damped, tmp_path):
    start = ["--duration", 0.4, "--set", "swing=0.4"]
    flags = ["--control-interval", 0.002, "--steps", 3, "--time-scale", 2, "--integrator", "rk4", "--gravity", "0,0,-1.62"]
    flags += ["--off", "damping", "--off", "friction", "--base-pose", "0,0,5,0,0,0,1"]
    by_scene = rows(damped, tmp_path, *start, "--scene", scene(tmp_path, FULL))
    assert by_scene == rows(damped, tmp_path, *start, *flags)
    assert by_scene != rows(damped, tmp_path, *start)


def test_flags_win_over_the_scene(damped, tmp_path):
    back = ["--control-interval", 0.001, "--steps", 5, "--time-scale", 1, "--integrator", "implicit_midpoint"]
    back += ["--gravity", f"0,0,{-G}", "--on", "damping", "--on", "friction", "--base-pose", "0,0,0,0,0,0,1", "--iterations", 10]
    start = ["--duration", 0.4, "--set", "swing=0.4"]
    assert rows(damped, tmp_path, *start, "--scene", scene(tmp_path, FULL), *back) == rows(damped, tmp_path, *start)


def test_a_scene_can_free_the_base(brick, tmp_path):
    free = scene(tmp_path, "version: 1\nrobot: {base: free}\n")
    assert "base.x" in rows(brick, tmp_path, "--duration", 0.01, "--scene", free)
    assert "base.x" not in rows(brick, tmp_path, "--duration", 0.01, "--scene", free, "--base", "fixed")


@pytest.mark.parametrize(
    "text, said",
    [
        ("version: 1\nworld:\n  gravty: [0, 0, 0]\n", ["line 3", "gravty", "gravity"]),
        ("version: 1\nwrld: {}\n", ["line 2", "wrld", "world"]),
        ("version: 1\nworld:\n  steps_per_interval: many\n", ["line 3"]),
        ("version: 1\nworld:\n  gravity: [0, 0]\n", ["line 3"]),
        ("version: 2\n", ["version is 2"]),
        ("world: {}\n", ["version"]),
        ("version: 1\nworld: {integrator: euler}\n", ["integrator 'euler'", "rk4"]),
        ("version: 1\nworld: {steps_per_interval: 0}\n", ["steps_per_interval is 0", "from 1 to 1000"]),
        ("version: 1\nworld: {effects: {gravty: false}}\n", ["effect 'gravty'", "gravity, damping"]),
        ("version: 1\nrobot: {base: loose}\n", ["base 'loose'", "fixed, free"]),
        ("version: 1\nrobot: {pose: [0, 0, 0, 0, 0, 0, 0]}\n", ["pose", "length is 0"]),
        ("version: 1\nrobot: {pose: [.nan, 0, 0, 0, 0, 0, 1]}\n", ["pose", "finite"]),
        ("version: [\n", []),
    ],
)
def test_a_wrong_scene_gives_code_2_and_names_file_and_line(pendulum, tmp_path, text, said):
    path = scene(tmp_path, text)
    message = refused(pendulum, "--duration", 1, "--scene", path)
    for part in [str(path), *said]:
        assert part in message


def test_a_missing_scene_gives_code_2(pendulum, tmp_path):
    assert "nowhere.yaml" in refused(pendulum, "--duration", 1, "--scene", tmp_path / "nowhere.yaml")


def test_an_empty_list_of_bodies_and_a_plain_ground_change_nothing_far_away(pendulum, tmp_path):
    start = ["--duration", 0.1, "--set", "swing=0.4"]
    path = scene(tmp_path, "version: 1\nground: {height: -100}\nbodies: []\n")
    assert rows(pendulum, tmp_path, *start, "--scene", path) == rows(pendulum, tmp_path, *start)
