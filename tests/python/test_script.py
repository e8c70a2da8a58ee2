"""`simulate --script`, and commands with applied speed: what may change while the simulation runs, and what is refused."""

import pytest
from simulation import columns, refused, rows, simulate
from test_simulate import PENDULUM

FREE = ["--off", "gravity", "--duration", 0.5]


@pytest.fixture
def pendulum(tmp_path):
    path = tmp_path / "pendulum.urdf"
    path.write_text(PENDULUM.replace("DYNAMICS", ""))
    return path


@pytest.fixture
def script(tmp_path):
    def written(text):
        path = tmp_path / "commands.yaml"
        path.write_text(text)
        return ["--script", path]

    return written


def test_commands_at_zero_are_those_of_the_flags(pendulum, script, tmp_path):
    for flags, entry in [
        (["--effort", "swing=2"], "mode: torque, torque: 2"),
        (["--effort", "swing=2,3"], "mode: torque, torque: 2, speed: 3"),
        (["--servo", "swing=0.4"], "mode: servo, target: 0.4"),
        (["--servo", "swing=0.4,3"], "mode: servo, target: 0.4, torque: 3"),
        (["--servo", "swing=0.4,-3,-0.5"], "mode: servo, target: 0.4, torque: 3, speed: 0.5"),
    ]:
        by_flag = rows(pendulum, tmp_path, *FREE, *flags)
        assert by_flag["swing.position"][-1] != 0
        assert by_flag == rows(pendulum, tmp_path, *FREE, *script(f"- {{at: 0, axis: swing, {entry}}}")), "signs do not count"


def test_an_entry_changes_what_it_names(pendulum, script, tmp_path):
    flags = script(
        """
        - {at: 0.1, axis: swing, mode: torque, torque: 2}
        - {at: 0.2, axis: swing, torque: 3}
        - {at: 0.3, axis: swing, max_torque: 1}
        - {at: 0.4, axis: swing, mode: idle}
        """
    )
    efforts = rows(pendulum, tmp_path, *FREE, *flags)["swing.effort"]
    # A row shows the torque of the interval that ended there.
    assert [efforts[i] for i in (100, 101, 200, 201, 300, 301, 400, 401, 500)] == [0, 2, 2, 3, 3, 1, 1, 0, 0]


def test_a_servo_follows_the_script(pendulum, script, tmp_path):
    flags = script(
        """
        - {at: 0, axis: swing, mode: servo, target: 0.5}
        - {at: 1, axis: swing, target: -0.3, speed: 1}
        """
    )
    table = rows(pendulum, tmp_path, "--duration", 3, *flags)
    assert table["swing.position"][1000] == pytest.approx(0.5, abs=1e-6)
    assert table["swing.position"][-1] == pytest.approx(-0.3, abs=1e-6)
    assert min(table["swing.velocity"][1001:]) >= -1 - 1e-9


def test_times_between_intervals_are_rounded_up_and_said(pendulum, script, tmp_path):
    path = tmp_path / "rows.csv"
    flags = script("- {at: 0.10025, axis: swing, mode: torque, torque: 2}\n- {at: 9, axis: swing, mode: idle}\n")
    warnings = simulate(pendulum, *FREE, *flags, "--out", path)["warnings"]
    efforts = columns(path)["swing.effort"]
    assert (efforts[101], efforts[102]) == (0, 2)
    late, after = [w.split("commands.yaml:")[1] for w in warnings]
    assert late == "1: at 0.10025 s is inside a control interval: it takes effect with the next one, at 0.101 s"
    assert after == "2: at 9 s is not before the end of the run: without effect"
    on_time = simulate(pendulum, *FREE, *script("- {at: 0.3, axis: swing, mode: torque, torque: 2}"))
    assert on_time["warnings"] == [], "0.3 is 300 intervals, whatever its binary digits are"


def test_the_summary_has_the_peaks(pendulum, script, tmp_path):
    path = tmp_path / "rows.csv"
    flags = script("- {at: 0.1, axis: swing, mode: torque, torque: -2}\n- {at: 0.3, axis: swing, mode: torque, torque: 1}\n")
    peaks = simulate(pendulum, *FREE, *flags, "--every", 0.1, "--out", path)["peaks"]
    table = rows(pendulum, tmp_path, *FREE, *flags)
    assert peaks == {"swing": {"torque": 2.0, "speed": max(map(abs, table["swing.velocity"]))}}, "also between the rows"


@pytest.mark.parametrize(
    "text, said",
    [
        ("- {at: 0, axis: swng}", [":1", "'swng'", "the axes are: swing"]),
        ("- {at: 0, axis: swing}\n- {at: 0, axis: swing, tork: 1}", ["line 2", "tork", "torque"]),
        ("- {at: 0.2, axis: swing}\n\n- {at: 0.1, axis: swing}", [":3", "0.1 s comes after 0.2 s"]),
        ("- {at: -1, axis: swing}", [":1", "at is -1"]),
        ("- {at: .inf, axis: swing}", [":1", "at is inf"]),
        ("- {axis: swing}", ["line 1", "at"]),
        ("- {at: 0, axis: swing, mode: on}", [":1", "mode 'on'", "idle, torque, servo"]),
        ("- {at: 0, axis: swing, mode: servo}", [":1", "target"]),
        ("- {at: 0, axis: swing, mode: torque, target: 1}", [":1", "mode: servo"]),
        ("- {at: 0, axis: swing, torque: 1}", [":1", "idle"]),
        ("- {at: 0, axis: swing, mode: torque, torque: .nan}", [":1", "torque is NaN"]),
        ("- {at: 0, axis: swing, mode: torque, torque: 1, speed: -2}", [":1", "applied torque 1 with applied speed -2", "same sign"]),
        ("- {at: 0, axis: swing, mode: torque, torque: 1}\n- {at: 1, axis: swing, speed: 0}", [":2", "applied speed 0"]),
        ("- {at: 0, axis: swing, max_torque: -1}", [":1", "max_torque is -1"]),
        ("- {at: 0, axis: swing, no_load_speed: 0}", [":1", "no_load_speed is 0"]),
        ("- {at: 0, axis: swing, static_resistance: -1}", [":1", "static_resistance is -1"]),
        ("- {at: 0, axis: swing, rotor_inertia: .inf}", [":1", "rotor_inertia is inf"]),
        ("{at: 0}", ["sequence"]),
        ("- [", []),
    ],
)
def test_a_wrong_script_is_refused_with_its_line(pendulum, script, tmp_path, text, said):
    out = tmp_path / "rows.csv"
    message = refused(pendulum, *FREE, "--out", out, *script(text))
    for part in ["commands.yaml", *said]:
        assert part in message
    assert not out.exists(), "nothing has run"


@pytest.mark.parametrize("value", ["1,-2", "-1,2", "1,0"])
def test_torque_against_speed_has_no_meaning(pendulum, value):
    """X-8, from the flag."""
    message = refused(pendulum, *FREE, "--effort", f"swing={value}")
    assert f"--effort swing={value}" in message and "same sign" in message
    assert simulate(pendulum, *FREE, "--effort", "swing=0,0")["finite"]


def test_a_script_does_not_switch_what_must_not_switch(script):
    from conftest import ARM

    message = refused(ARM, "--duration", 1, *script("- {at: 0, axis: ankle, mode: servo, target: 0}"))
    assert "commands.yaml:1" in message and "switchable" in message


def test_a_missing_script_is_named(pendulum):
    assert "nowhere.yaml" in refused(pendulum, *FREE, "--script", "nowhere.yaml")
