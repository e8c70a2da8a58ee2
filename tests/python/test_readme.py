"""What the documents say is so: commands are run, clients are tried, tables and links are compared."""

import json
import os
import re
import shlex
import signal
import subprocess
import sys
from pathlib import Path

import pytest
import yaml
from conftest import BINARY, Simulator, free_domain, wait_until
from launched import Launched

ROOT = Path(__file__).resolve().parents[2]
README = (ROOT / "README.md").read_text()
SCRIPTS = ROOT / "launch-scripts"


def blocks(language):
    return re.findall(rf"^```{language}\n(.*?)^```$", README, re.S | re.M)


def rows(heading):
    """Cells of the first table under a heading."""
    table = README.split(f"\n{heading}\n", 1)[1].split("\n|---")[1].split("\n\n")[0]
    return [[cell.strip() for cell in line.strip("|").split("|")] for line in table.split("\n")[1:]]


# Commands and their output


CONSOLE = [tuple(block.split("\n", 1)) for block in blocks("console")]


def ended(arguments, folder, pipe):
    """Output of the program; links in `folder` make the paths of the documents good."""
    for name in ("urdf", "tests", "config"):
        (folder / name).symlink_to(ROOT / name)
    result = subprocess.run([BINARY, *arguments], input=pipe, cwd=folder, capture_output=True, text=True, timeout=120)
    return result.stdout + result.stderr


def node_output():
    """What the node prints from start to SIGINT."""
    simulator = Simulator(domain=free_domain(), urdf=None)
    output = simulator.process.stdout
    first = list(until_last_topic(output))
    simulator.process.send_signal(signal.SIGINT)
    rest = output.read()
    assert simulator.process.wait(30) == 0
    return "".join(first) + rest


def until_last_topic(output):
    for line in iter(output.readline, ""):
        yield line
        if "joint_command" in line:
            return


def without_measurements(line, command):
    """Figures that differ from run to run are left out of the comparison, and the last digits of long ones."""
    measured = re.search(r"realnoid( (bench|compare).*)?$", command) or re.search("cpu_seconds|us_per_step", line)
    line = re.sub(r"\d+(\.\d+)?", "#", line) if measured and "axes" not in line else line
    line = re.sub(r"-?\d+\.\d{9,}", lambda number: f"{float(number[0]):.9g}", line)
    return re.sub(r"\s+", " ", line).rstrip()


def assert_shown(shown, output, command):
    """Every line shown is in the output, in order; without `…` between two lines, nothing else is between them."""
    lines = [without_measurements(line, command) for line in output.rstrip("\n").split("\n")]
    at, gap = 0, False
    for line in shown.rstrip("\n").split("\n"):
        if line == "…":
            gap = True
            continue
        expected = without_measurements(line, command)
        found = next((i for i in range(at, len(lines)) if lines[i] == expected), None)
        assert found is not None, f"{command}: the line\n{line}\nis not in what is left of the output:\n" + "\n".join(lines[at:])
        assert gap or found == at, f"{command}: before\n{line}\nthe output has more:\n" + "\n".join(lines[at:found])
        at, gap = found + 1, False


@pytest.mark.parametrize("command, shown", CONSOLE, ids=[c for c, _ in CONSOLE])
def test_commands_print_what_is_shown(command, shown, tmp_path):
    pipe = re.match(r"\$ echo '(.*)' \| realnoid", command)
    arguments = shlex.split(command.split("realnoid", 1)[1])
    output = ended(arguments, tmp_path, pipe and pipe[1]) if arguments else node_output()
    assert_shown(shown, output, command)


def test_the_comparison_of_outputs_can_fail():
    for shown in ("a\nc", "c", "a\n…\nd", "b\na"):
        with pytest.raises(AssertionError):
            assert_shown(shown, "a\nb\nc\n", "$ realnoid check")
    assert_shown("a\n…\nc", "a\nb\nc\n", "$ realnoid check")
    with pytest.raises(AssertionError):
        assert_shown("mass 2", "mass 3", "$ realnoid inspect")


def test_the_scene_of_the_readme_is_accepted(tmp_path):
    scene, script, _ = blocks("yaml")
    (tmp_path / "scene.yaml").write_text(scene)
    (tmp_path / "commands.yaml").write_text(script)
    command = [BINARY, "simulate", ROOT / "urdf/origin.urdf", "--scene", tmp_path / "scene.yaml", "--duration", "1"]
    result = subprocess.run([*command, "--script", tmp_path / "commands.yaml"], capture_output=True, text=True)
    assert result.returncode == 0, result.stderr
    assert not any("commands.yaml" in warning for warning in json.loads(result.stdout)["warnings"])


def test_the_world_of_the_readme_runs(tmp_path):
    world = blocks("yaml")[2].replace("urdf/leg.urdf", f"{ROOT}/urdf/leg.urdf")
    (tmp_path / "scene.yaml").write_text(world)
    command = [BINARY, "simulate", ROOT / "urdf/origin.urdf", "--scene", tmp_path / "scene.yaml", "--duration", "0.2"]
    result = subprocess.run(command, capture_output=True, text=True)
    assert result.returncode == 0, result.stderr
    assert json.loads(result.stdout)["contacts"] > 0


def test_every_program_and_script_in_shell_blocks_is_there():
    commands = [line.split("#")[0].split() for block in blocks("sh") for line in block.splitlines()]
    assert ["tests/run"] in commands and ["cargo", "run", "--release"] in commands
    for words in commands:
        if words[0] == "realnoid":
            assert subprocess.run([BINARY, words[1], "--help"], capture_output=True).returncode == 0, words
        elif "/" in words[0]:
            assert os.access(ROOT / words[0], os.X_OK), words


# Clients


def script(bench, *command, cwd=None):
    variables = {**os.environ, "ROS_DOMAIN_ID": str(bench.domain)}
    return subprocess.Popen(
        [sys.executable, *map(str, command)], env=variables, cwd=cwd, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True
    )


def test_the_client_of_the_readme_moves_the_elbow(start, tmp_path):
    [code] = blocks("python")
    assert len(code.splitlines()) == 10
    (tmp_path / "client.py").write_text(code)
    bench = start(urdf=None)
    assert abs(bench.axis("left_elbow")[0]) < 1e-3
    client = script(bench, tmp_path / "client.py")
    try:
        wait_until(lambda: abs(bench.axis("left_elbow")[0] + 1.0) < 0.01, what="the elbow to reach -1 rad")
    finally:
        client.terminate()
        said = client.communicate(timeout=30)[0]
    assert re.search(r"left_elbow [+-]\d\.\d{3} rad", said), said


def test_listen_and_push_pushes_the_first_axis(start):
    bench = start(urdf=None)
    client = script(bench, SCRIPTS / "listen_and_push.py")
    try:
        wait_until(lambda: bench.axis("waist_yaw")[0] > 0.05, what="the waist to turn")
    finally:
        client.terminate()
        said = client.communicate(timeout=30)[0]
    assert "waist_yaw" in said, said


def test_swing_leg_swings_the_leg_and_writes_the_twist(start, tmp_path):
    bench = start(urdf=None)
    client = script(bench, SCRIPTS / "swing_leg.py", "swing", cwd=tmp_path)
    said = client.communicate(timeout=120)[0]
    assert client.returncode == 0, said
    [written] = tmp_path.iterdir()
    assert written.stem == "swing" and written.stat().st_size > 10_000 and written.name in said

    def swung():
        hip = [s.position[s.name.index("left_hip_pitch")] for s in list(bench.states)]
        forward = next((i for i, q in enumerate(hip) if q < -0.5), len(hip))
        return max(hip[forward:], default=-1.0) > 0.0

    wait_until(swung, what="the leg to swing forward, and back behind the trunk")


# Launch files, with an imitation of what they use of `launch`


@pytest.mark.parametrize("name, facts", [("bench", ["base fixed", "-9.80665]"]), ("free", ["base free", "gravity [0.0, 0.0, 0.0]"])])
def test_launch_files_make_a_command_that_starts_the_node(name, facts, monkeypatch):
    monkeypatch.setenv("REALNOID_BIN", str(BINARY))
    [command] = Launched(monkeypatch, SCRIPTS / f"{name}.launch.py", namespace="/stand").commands
    variables = {**os.environ, "ROS_DOMAIN_ID": str(free_domain())}
    node = subprocess.Popen(command, env=variables, stdout=subprocess.PIPE, text=True)
    report = "".join(until_last_topic(node.stdout))
    node.terminate()
    node.stdout.read()
    assert node.wait(30) == 0
    for fact in ["/stand/forward_dynamics", "-> /stand/joint_states", *facts]:
        assert fact in report, report


# Tables, links, invariants


def test_the_parameter_table_is_the_default_file():
    defaults = yaml.safe_load((ROOT / "config/default.yaml").read_text())["/**"]["ros__parameters"]
    shown = {name.strip("`"): yaml.safe_load(default) for name, default, *_ in rows("## Parameters")}
    assert shown.pop("axes") is None
    effects = {name: defaults.pop(name) for name in list(defaults) if name.startswith("effects.")}
    assert effects and set(effects.values()) == {shown.pop("effects.NAME")}
    assert shown == defaults
    help_text = subprocess.check_output([BINARY, "run", "--help"], text=True)
    for name, _, accepted, _ in rows("## Parameters"):
        bounds = re.match(r"(\S+ … [0-9.]+)", accepted)
        entry = re.search(rf"  {name.strip('`').replace('NAME', 'gravity')} .*?\n.*?\[(.*)\]\n", help_text)[1]
        assert not bounds or bounds[1] in entry, name
        assert ("at start only" in accepted) == ("at start only" in entry), name


def test_the_topic_table_is_what_the_node_has():
    found = re.findall(r"(->|<-) /(\S+)  (\S+)", node_output())
    found = {(arrow, re.sub(r"twist/.*", "twist/<link>", topic), kind) for arrow, topic, kind in found}
    shown = {
        ("->" if direction == "out" else "<-", topic.strip("`").lstrip("/"), kind)
        for direction, topic, kind, *_ in rows("## Topics")
    }
    assert shown - {("->", "rosout", "rcl_interfaces/Log")} == found


DOCUMENTS = [*ROOT.glob("*.md"), *ROOT.glob("docs/**/*.md"), *ROOT.glob("msg/*.md"), *ROOT.glob("srv/*.md"), SCRIPTS / "README.md"]


@pytest.mark.parametrize("document", DOCUMENTS, ids=lambda p: str(p.relative_to(ROOT)))
def test_links_lead_somewhere(document):
    text = document.read_text()
    for target in re.findall(r"\]\(([^)#\s]+)[^)]*\)", text) + re.findall(r'src="([^"]+)"', text):
        assert target.startswith("https://") or (document.parent / target).exists(), target


def test_architecture_names_every_room_in_order_and_tests_that_exist():
    text = (ROOT / "ARCHITECTURE.md").read_text()
    rooms = re.findall(r"^pub mod (\w+);", (ROOT / "src/lib.rs").read_text(), re.M)
    assert re.findall(r"^\| `(\w+)` \|", text, re.M) == rooms
    invariants = re.findall(r"^- invariant: .*?(?=^- |^$)", text, re.M | re.S)
    assert len(invariants) >= 10
    for invariant in invariants:
        named = re.findall(r"`((?:tests|src)/\S+?)::(\w+)`", invariant)
        assert named, f"no test is named: {invariant}"
        for path, test in named:
            assert re.search(rf"\b(?:fn|def) {test}\b", (ROOT / path).read_text()), f"{path}::{test}"


def test_the_picture_of_the_humanoid_is_drawn_from_the_present_urdf():
    drawn = subprocess.check_output([sys.executable, ROOT / "docs/images/draw_humanoid.py"], text=True)
    assert drawn == (ROOT / "docs/images/humanoid.svg").read_text(), "docs/images/draw_humanoid.py > docs/images/humanoid.svg"


@pytest.mark.parametrize("urdf, picture", [("urdf/origin.urdf", "origin.svg"), ("urdf/shapes.urdf", "shapes.svg")])
def test_the_drawings_are_those_of_inspect(urdf, picture, tmp_path):
    drawn = tmp_path / picture
    subprocess.run([BINARY, "inspect", urdf, "--svg", drawn], cwd=ROOT, check=True, stdout=subprocess.DEVNULL)
    told = f"realnoid inspect {urdf} --svg docs/images/{picture}"
    assert drawn.read_text() == (ROOT / "docs/images" / picture).read_text(), f"draw it anew: {told}"
