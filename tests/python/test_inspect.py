"""`realnoid inspect`: the values of links, as people and programs read them."""

import json
import re
import subprocess

import numpy
import pytest
from conftest import BINARY
from simulation import ORIGIN

EXPONENT = r"-?\d\.\d{15}E[+-]\d+"

ARM = """<robot name="arm">
  <link name="base"/>
  <link name="upper"><realnoid><body specific_gravity="2"><shape><box size="0.1 0.2 0.3"/></shape></body></realnoid></link>
  <link name="cover">
    <collision><geometry><sphere radius="0.1"/></geometry></collision>
    <realnoid>
      <body specific_gravity="1" l_scale="2" zero_exponent="-4">
        <shape><origin xyz="0 0 0.1" rpy="0.3 0 0"/><cylinder radius="0.05" length="0.2"/></shape>
        <shape specific_gravity="8" dimension="2d" thickness="0.002"><sphere radius="0.04"/></shape>
      </body>
      {proxy}
    </realnoid>
  </link>
  <link name="stated"><inertial><mass value="3"/><inertia ixx="1" ixy="0" ixz="0" iyy="1" iyz="0" izz="1"/></inertial></link>
  <joint name="shoulder" type="continuous"><parent link="base"/><child link="upper"/><axis xyz="0 1 0"/></joint>
  <joint name="glue" type="fixed"><parent link="upper"/><child link="cover"/><origin xyz="0 0 0.5" rpy="0 0.4 0"/></joint>
  <joint name="elbow" type="continuous"><parent link="cover"/><child link="stated"/><axis xyz="0 1 0"/></joint>
</robot>"""


@pytest.fixture
def arm(tmp_path):
    path = tmp_path / "arm.urdf"
    path.write_text(ARM.format(proxy=""))
    return path


def inspect(*arguments):
    done = subprocess.run([BINARY, "inspect", *map(str, arguments)], capture_output=True, text=True)
    assert done.returncode == 0, done.stderr
    return done.stdout


def as_json(path):
    return json.loads(inspect(path, "--json"))


def links(path):
    return {link["name"]: link for link in as_json(path)["links"]}


def matrix(t):
    return numpy.array([[t["ixx"], t["ixy"], t["ixz"]], [t["ixy"], t["iyy"], t["iyz"]], [t["ixz"], t["iyz"], t["izz"]]])


def shifted(inertia, mass, arm):
    """Parallel axis, from the centre of mass."""
    arm = numpy.array(arm)
    return inertia + mass * (arm @ arm * numpy.eye(3) - numpy.outer(arm, arm))


def turn(axis, angle):
    c, s = numpy.cos(angle), numpy.sin(angle)
    return numpy.array([[1, 0, 0], [0, c, -s], [0, s, c]] if axis == "x" else [[c, 0, s], [0, 1, 0], [-s, 0, c]])


def test_bodies_of_a_link_add_up_by_their_own_masses(arm):
    """J-6 and X-3, by a second computation; then rounding. The L scale is told beside the true values."""
    cover = links(arm)["cover"]
    radius, length = 0.05, 0.2
    tube = 1000 * numpy.pi * radius**2 * length
    across = tube * (radius**2 / 4 + length**2 / 12)
    r = turn("x", 0.3)
    tube_inertia = r @ numpy.diag([across, across, tube * radius**2 / 2]) @ r.T
    ball = 8000 * 4 * numpy.pi * 0.04**2 * 0.002
    ball_inertia = numpy.eye(3) * 2 / 3 * ball * 0.04**2
    mass, center = tube + ball, numpy.array([0, 0, 0.1]) * tube / (tube + ball)
    inertia = shifted(tube_inertia, tube, numpy.array([0, 0, 0.1]) - center) + shifted(ball_inertia, ball, center)
    inertia[abs(inertia) < 1e-4] = 0
    assert cover["mass"] == pytest.approx(mass, rel=1e-14)
    assert cover["volume"] == pytest.approx(tube / 1000 + ball / 8000, rel=1e-14)
    numpy.testing.assert_allclose(cover["center_of_mass"], center, atol=1e-15)
    numpy.testing.assert_allclose(matrix(cover["inertia"]), inertia, rtol=1e-12, atol=1e-16)
    assert cover["inertia"]["iyz"] != 0 and cover["inertia"]["ixy"] == 0
    assert cover["l_scale"] == 2


def test_what_a_joint_moves_is_one_body(arm):
    whole = {v["axis"]: v for v in as_json(arm)["joint_links"]}
    assert set(whole) == {"shoulder", "elbow"}, "the base has no mass"
    assert whole["elbow"]["volume"] is None and whole["elbow"]["mass"] == 3
    upper, cover = (links(arm)[name] for name in ("upper", "cover"))
    both = whole["shoulder"]
    assert both["links"] == ["upper", "cover"] and both["frame"] == "upper"
    assert both["volume"] == pytest.approx(upper["volume"] + cover["volume"], rel=1e-15)
    r = turn("y", 0.4)
    place = numpy.array([0, 0, 0.5]) + r @ cover["center_of_mass"]
    mass = upper["mass"] + cover["mass"]
    center = (upper["mass"] * numpy.array(upper["center_of_mass"]) + cover["mass"] * place) / mass
    inertia = shifted(matrix(upper["inertia"]), upper["mass"], center) + shifted(
        r @ matrix(cover["inertia"]) @ r.T, cover["mass"], place - center
    )
    numpy.testing.assert_allclose(both["center_of_mass"], center, atol=1e-15)
    numpy.testing.assert_allclose(matrix(both["inertia"]), inertia, atol=1e-14)
    at_origin = shifted(inertia, mass, center)
    at_origin[abs(at_origin) < 1e-4] = 0
    numpy.testing.assert_allclose(matrix(both["inertia_at_origin"]), at_origin, atol=1e-14)
    numpy.testing.assert_allclose(both["principal_moments"], numpy.linalg.eigvalsh(inertia), rtol=1e-12)
    axes = numpy.array(both["principal_axes"]).T
    numpy.testing.assert_allclose(axes @ numpy.diag(both["principal_moments"]) @ axes.T, inertia, atol=1e-14)
    assert both["l_scale"] == 1, "that of the body nearest the root"


def test_every_body_knows_the_joint_whose_link_it_belongs_to(arm):
    """B-7."""
    member = {name: link["member_of"] for name, link in links(arm).items()}
    assert member["base"] is None
    assert member["upper"] == {"joint": "shoulder", "axis": "shoulder", "root": True}
    assert member["cover"] == {"joint": "shoulder", "axis": "shoulder", "root": False}
    hip = {name: link["member_of"] for name, link in links(ORIGIN).items()}["left_thigh"]
    assert hip == {"joint": "left_hip", "axis": "left_hip_roll", "root": True}, "a group moves it"


def test_the_l_scale_of_the_body_nearest_the_root_holds_for_all_that_the_joint_moves(tmp_path):
    """B-18: what is simulated has L² times the inertia about the centre of mass of the whole; what is shown has not."""

    def angular_acceleration(upper, cover):
        path = tmp_path / "scaled.urdf"
        text = ARM.format(proxy="").replace('zero_exponent="-4"', "").replace('l_scale="2"', f'l_scale="{cover}"')
        text = text.replace('<body specific_gravity="2">', f'<body specific_gravity="2" l_scale="{upper}">')
        # Without the forearm, one hinge is left.
        text = text.replace('name="elbow" type="continuous"', 'name="elbow" type="fixed"').replace('mass value="3"', 'mass value="0"')
        path.write_text(text.replace('ixx="1"', 'ixx="0"').replace('iyy="1"', 'iyy="0"').replace('izz="1"', 'izz="0"'))
        state = json.dumps({"position": [0], "velocity": [0], "effort": [1]})
        command = [BINARY, "evaluate", path, "--gravity", "0,0,0"]
        done = subprocess.run(command, input=state, capture_output=True, text=True, check=True)
        return json.loads(done.stdout)["acceleration"][0], as_json(path)["joint_links"][0]

    plain, values = angular_acceleration(1, 1)
    about_center, at_origin = values["inertia"]["iyy"], values["inertia_at_origin"]["iyy"]
    assert plain == pytest.approx(1 / at_origin, rel=1e-12)
    scaled, same = angular_acceleration(3, 1)
    assert scaled == pytest.approx(1 / (at_origin + 8 * about_center), rel=1e-12)
    assert {k: v for k, v in same.items() if k != "l_scale"} == {k: v for k, v in values.items() if k != "l_scale"}
    assert (values["l_scale"], same["l_scale"]) == (1, 3)
    assert angular_acceleration(1, 5)[0] == plain, "only the body nearest the root counts"
    report = subprocess.run([BINARY, "check", tmp_path / "scaled.urdf"], capture_output=True, text=True).stdout
    assert "l-scale-ignored" in report and "'cover'" in report


def test_collision_shapes_stand_in_the_frame_of_the_joints_link(arm):
    """J-8."""
    [box, ball] = as_json(arm)["joint_links"][0]["collision"]
    assert (box["kind"], box["position"], box["orientation"]) == ("box", [0, 0, 0], [0, 0, 0, 1])
    assert ball["kind"] == "sphere" and ball["position"] == pytest.approx([0, 0, 0.5])
    assert ball["orientation"] == pytest.approx([0, numpy.sin(0.2), 0, numpy.cos(0.2)])


def test_proxies_stand_for_collision_and_collision_for_the_body(tmp_path, arm):
    """B-6, J-8."""
    told = {name: link["collision"] for name, link in links(arm).items()}
    assert told["upper"] == {"from": "body", "shapes": 1}
    assert told["cover"] == {"from": "collision", "shapes": 1}
    assert told["stated"] == {"from": "none", "shapes": 0}
    path = tmp_path / "proxy.urdf"
    proxies = '<proxy scale="1 1 2"><sphere radius="0.1"/></proxy><proxy><capsule radius="0.1" length="0.1"/></proxy>'
    path.write_text(ARM.format(proxy=proxies))
    assert links(path)["cover"]["collision"] == {"from": "proxy", "shapes": 2}


def blocks(text):
    return {block.split("\n", 1)[0]: block for block in text.strip().split("\n\n")}


def test_full_values_have_the_form_of_the_source(arm):
    """Table 6-9: one digit and 15 decimals with a signed exponent; m and cm, kg and g; the centre in the system unit."""
    told = blocks(inspect(arm, "--full"))
    assert list(told) == ["joint shoulder: link upper, with cover", "part upper", "part cover", "joint elbow: link stated"]
    text, values = told["joint shoulder: link upper, with cover"], as_json(arm)["joint_links"][0]
    rows = {line[2:22].strip(): line[23:].split() for line in text.split("\n")[1:]}
    assert re.search(rf"volume +{EXPONENT} m³   {EXPONENT} cm³", text) and re.search(rf"mass +{EXPONENT} kg   {EXPONENT} g", text)
    digits = 1e-15  # what 15 decimals keep
    assert [float(rows["volume"][0]), float(rows["mass"][0])] == pytest.approx([values["volume"], values["mass"]], rel=digits)
    assert float(rows["volume"][2]) == pytest.approx(values["volume"] * 1e6, rel=digits)
    assert float(rows["mass"][2]) == pytest.approx(values["mass"] * 1e3, rel=digits)
    assert [float(x) for x in rows["centre of mass"][:3]] == pytest.approx(values["center_of_mass"], abs=1e-9)
    assert [float(x) for x in rows["principal moments"][:3]] == pytest.approx(values["principal_moments"], rel=digits)
    first = values["inertia_at_origin"]
    assert [float(x) for x in rows["inertia at origin"][:3]] == pytest.approx([first["ixx"], first["ixy"], first["ixz"]], rel=digits)
    assert rows["L scale"] == ["1"]
    assert len(re.findall(EXPONENT, text)) == 4 + 9 + 9 + 3
    assert "unknown" in told["joint elbow: link stated"]


@pytest.mark.parametrize("unit, factor", [("m", 1), ("cm", 100), ("mm", 1000)])
def test_lengths_are_shown_in_the_system_unit(arm, unit, factor):
    values = as_json(arm)["joint_links"][0]
    row = re.search(r"centre of mass +(\S+) (\S+) (\S+) (\S+)", inspect(arm, "--full", "--unit", unit))
    assert row[4] == unit and float(row[3]) == pytest.approx(values["center_of_mass"][2] * factor, abs=1e-9 * factor)
    table = inspect(arm, "--unit", unit)
    assert f"centre of mass {unit}" in table and f"volume {unit}³" in table
    volume = next(line.split()[2] for line in table.split("\n") if line.startswith("upper "))
    assert float(volume) == pytest.approx(links(arm)["upper"]["volume"] * factor**3, rel=1e-4)


def test_the_parts_of_the_humanoid_add_up():
    told = as_json(ORIGIN)
    parts = sum(v["mass"] for v in told["joint_links"])
    assert parts == pytest.approx(told["mass"], rel=1e-14)
    assert sum(link["mass"] for link in told["links"]) == pytest.approx(told["mass"], rel=1e-14)


def test_a_rounding_that_takes_all_inertia_away_is_refused(tmp_path):
    path = tmp_path / "rounded.urdf"
    path.write_text(ARM.format(proxy="").replace('zero_exponent="-4"', 'zero_exponent="1"'))
    done = subprocess.run([BINARY, "inspect", path], capture_output=True, text=True)
    assert done.returncode == 1 and "inertia-rounded-away" in done.stderr and "rounded.urdf:7:" in done.stderr
